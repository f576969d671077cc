//! The paper's own steps from the plan view to obstacles and their borders [Alghannam, Sec. II].

mod edges;
mod mask;
mod obstacles;
mod steps;

pub use edges::{average_filter, edge_magnitude, histogram_mean, invert, threshold};
pub use mask::{ObstacleMask, Segment, enlarge, obstacle_borders, segments};
pub use obstacles::Steps;
pub(crate) use obstacles::{paper_rectangles, steps};
pub use steps::{PaperSteps, brightness, detect_obstacles, paper_obstacles, paper_steps};
