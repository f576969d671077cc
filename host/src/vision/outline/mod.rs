//! The outline of what stands out from the floor, whatever its form: a contour between cells, and the
//! simplest shape that fits it.

mod contour;
mod fit;

pub(crate) use contour::contour;
pub(crate) use fit::{FittedShape, fit};
