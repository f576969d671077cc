//! One robot's numbers, as this crate computes with them.
//!
//! They are the protocol's, since the host reads and writes them too; here they become the lengths
//! that tie wheels to body.

use crate::kinematics::BaseGeometry;
pub use protocol::parameters::Parameters;

impl From<&Parameters> for BaseGeometry {
    fn from(parameters: &Parameters) -> Self {
        Self::new(parameters.wheel_radius, parameters.wheel_ratio, parameters.track)
    }
}
