//! What floor and shadow look like, and which cells of the plan view are neither.

pub(crate) mod floor;
mod segmentation;
mod shadow;

pub(crate) use floor::{Difference, Feature, FloorModel, feature, median, turned, turned_back};
pub(crate) use segmentation::{FOREIGN, Look, SURE, samples};
pub(crate) use shadow::Shadow;
