//! Pixels and light, without metres: the photo, rasters of cells, their connected components, rectangles and
//! edge profiles.

mod components;
mod cover;
mod edge_profile;
mod faults;
mod photo;
mod raster;
mod rectangles;

pub(crate) use components::{Run, runs};
pub(crate) use cover::{LEAST_CELLS, around, cut, greatest, marked, regions};
pub(crate) use edge_profile::step;
pub(crate) use faults::check_overview;
pub use faults::check_picture;
pub(crate) use photo::{FRACTION, Place};
pub use photo::{MAX_PIXELS, Photo, decode, srgb_code};
pub use raster::Raster;
pub use rectangles::{CellRect, rectangles};
