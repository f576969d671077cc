//! The floor seen straight from above: frame, colours, brightness, and the places of the photo that each cell
//! is drawn from.

mod brightness;
mod frame;
mod sampling;
mod view;

pub use brightness::brightness_view;
pub use frame::PlanFrame;
pub use view::plan_view;
pub(crate) use view::{cell_light, view_of};
