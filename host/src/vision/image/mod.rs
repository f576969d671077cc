//! Pixels and light, without metres: the photo, rasters of cells, their connected components, rectangles and
//! edge profiles.

mod components;
mod cover;
mod decode;
mod edge_profile;
mod faults;
mod photo;
mod raster;
mod rectangles;
mod sobel;

pub(crate) use components::{Run, runs};
pub(crate) use cover::{LEAST_CELLS, around, cut, greatest, marked, regions};
pub use decode::{MAX_PIXELS, decode};
pub(crate) use edge_profile::{step, steps_like};
pub(crate) use faults::check_overview;
pub use faults::check_picture;
pub(crate) use photo::{FRACTION, Place, zoom};
pub use photo::{Photo, srgb_code};
pub use raster::Raster;
pub use rectangles::{CellRect, rectangles};
pub(crate) use sobel::{magnitude, sobel};
