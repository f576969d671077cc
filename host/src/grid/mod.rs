//! Cuts the arena into rectangular areas along the borders of the enlarged obstacles
//! [Alghannam, Sec. II-B and III].
//!
//! ```text
//! scene ─► enlarge ─► BorderLines ─► MiniMatrix::from_borders ─► close_traps ─► plan
//! metres   robot is   lines through  one element per area:       0 where only
//!          a point    what is seen   0 dead, 1 free, 2 terminal  a trap was
//! ```
//! From here on the arena is integers of 0.1 mm ([`LatticePoint`]); metres come back in the plan.

mod border_lines;
mod enlarge;
mod lattice;
mod mini_matrix;
mod traps;

pub use border_lines::{AREA_LIMIT, BorderLines};
pub use enlarge::{EnlargedArena, enlarge};
pub use lattice::{COORDINATE_LIMIT, LatticePoint, LatticeRect, UNITS_PER_METRE, turn};
pub use mini_matrix::{Area, AreaKind, MiniMatrix};
pub use traps::close_traps;

use crate::geometry::{Arena, Rect};

/// Why the arena cannot be cut into areas.
#[derive(Clone, Debug, PartialEq, thiserror::Error, miette::Diagnostic)]
pub enum GridError {
    /// A rectangle lies beyond [`COORDINATE_LIMIT`].
    #[error("the rectangle [{}, {}, {}, {}] m lies beyond the planner's {} km", .rect.x0, .rect.y0, .rect.x1, .rect.y1, f64::from(COORDINATE_LIMIT) / UNITS_PER_METRE / 1000.0)]
    #[diagnostic(help("are its units metres?"))]
    TooLarge {
        /// The obstacle or the arena, metres.
        rect: Rect,
    },
    /// A margin is negative or no number.
    #[error("a margin is {metres} m")]
    #[diagnostic(help("give a distance of 0 or more"))]
    Margin {
        /// What was given, metres.
        metres: f64,
    },
    /// The robot with its margin is wider than the arena.
    #[error("the arena is {:.1} × {:.1} cm, the robot with its margin {:.1} cm wide: it has no room to move", .arena.width * 100.0, .arena.height * 100.0, .need * 100.0)]
    #[diagnostic(help(
        "check arena size, radius and margin, which are metres unless they say otherwise, such as 75mm"
    ))]
    ArenaTooSmall {
        /// The floor's size.
        arena: Arena,
        /// The robot's width with its margin, metres.
        need: f64,
    },
    /// The grid of the paper would have too many areas to keep.
    #[error("the grid has {areas} areas, more than {limit}")]
    #[diagnostic(help("use the exact planner, which merges them"))]
    TooManyAreas {
        /// How many there would be.
        areas: usize,
        /// How many there may be.
        limit: usize,
    },
}
