//! What goes into the robot at its start and at each control tick, and what comes out.

use crate::parameter_store::Step;
use protocol::message::{BatteryReport, Board, LegResult, Reboot, ResetCause};
use protocol::motion::Pose;

/// What the robot measures.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sensors {
    /// The encoders' counts since the start, left and right; they may wrap around.
    pub counts: [i32; 2],
    /// Whether both channels of the left and the right input changed at once since the last tick, so that a
    /// count was lost.
    pub skipped: [bool; 2],
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
    /// A wheel that was turned to see how it is wired: what the encoders counted, left and right.
    WheelTurned([i32; 2]),
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

/// What the board gives the robot at its start.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Boot {
    /// A number that differs from start to start.
    pub nonce: u32,
    /// What the robot runs on.
    pub board: Board,
    /// Why it starts.
    pub reset: ResetCause,
    /// The number of its chip; 0 if it has none.
    pub chip: u64,
}

/// What the robot does with its motors, and with itself.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Actuation {
    /// The motors' duty, left and right, -1..=1; positive drives forward.
    pub duty: [f32; 2],
    /// The light on the board is on.
    pub light: bool,
    /// Restart now; only requested at rest.
    pub reboot: Option<Reboot>,
    /// Do this to the flash with [`Robot::parameter_record`](crate::robot::Robot::parameter_record), and then call
    /// [`Robot::parameters_written`](crate::robot::Robot::parameters_written) with what the slot holds; only requested at rest.
    pub save: Option<[Step; 2]>,
}
