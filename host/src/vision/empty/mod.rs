//! The floor known from one picture of the empty arena by the same camera.
//!
//! ```text
//! photo, empty picture ─► moved? ─► illumination between them ─► the photo over an even floor ─► appearance
//! ```
//! What differs from the empty picture is there; everything else is floor, whatever is painted on it. So the
//! photo is divided by the empty picture, pixel by pixel: tiles, wood grain and printed grids vanish, and
//! what comes after works on a photo of an evenly grey floor as on any other ([`flat`]). Exposure, white
//! balance, the lamp's brightness and slow differences of light are a smooth factor per channel
//! ([`illumination`]). All this only holds for a camera that stands still ([`motion`]).

mod flat;
mod illumination;
mod motion;

pub(crate) use flat::over_even_floor;
pub use motion::check_still;
