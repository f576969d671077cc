//! What goes into a control tick, and what comes out of it.

use protocol::message::{BatteryReport, LegResult};
use protocol::motion::Pose;

/// What the robot measures.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sensors {
    /// The encoders' counts since the start, left and right; they may wrap around.
    pub counts: [i32; 2],
    /// The battery's voltage, if the board measures it, volts.
    pub battery: Option<f32>,
    /// Control periods that passed without a tick since the last one.
    pub missed_ticks: u8,
}

/// What a tick brought to an end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Event {
    /// A leg.
    LegDone(LegResult),
    /// The whole plan; the robot rests.
    PlanDone {
        /// The plan driven.
        plan: u32,
        /// Where the robot believes it stands.
        pose: Pose,
    },
}

/// What a tick gives.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Outcome {
    /// The motors' duty, left and right, -1..=1.
    pub duty: [f32; 2],
    /// What came to an end.
    pub event: Option<Event>,
    /// The battery, if it has reached another level.
    pub battery: Option<BatteryReport>,
}
