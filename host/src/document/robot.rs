//! What a robot says of itself: `wmr ports`, `info`, `stop`, `params`, `monitor`, `check base` and
//! `calibrate base`.

use crate::geometry::Pose;
use protocol::message::{Fault, ResetCause};
use protocol::parameters::Wiring;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// `wmr ports --json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct PortsDocument {
    /// The serial ports of this computer.
    pub ports: Vec<PortDocument>,
}

/// A serial port.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct PortDocument {
    /// What `--port` takes.
    pub name: String,
    /// Whether it says that it is a wmr robot.
    pub robot: bool,
    /// The vendor's number, of a USB device.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub vid: Option<u16>,
    /// The product's number, of a USB device.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pid: Option<u16>,
    /// The product's name, of a USB device that has one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub product: Option<String>,
    /// The serial number, of a USB device that has one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub serial: Option<String>,
}

/// `wmr info --json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct RobotDocument {
    /// The board.
    pub board: String,
    /// The firmware's version.
    pub firmware: String,
    /// The protocol's version.
    pub protocol: u16,
    /// Why it last started.
    #[cfg_attr(test, schemars(with = "String"))]
    pub reset: ResetCause,
    /// What it may do.
    pub limits: LimitsDocument,
    /// The most legs of a plan.
    pub max_legs: u16,
}

/// A robot's limits.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct LimitsDocument {
    /// m/s.
    pub speed: f64,
    /// m/s².
    pub acceleration: f64,
    /// From wheel to wheel, metres.
    pub track: f64,
}

/// `wmr stop --json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct StopDocument {
    /// What the robot does now.
    pub state: String,
    /// Where it believes to be, if it was asked directly.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pose: Option<Pose>,
    /// Who stopped it, if it was another program.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub by: Option<String>,
}

/// `wmr params --json`, and what `wmr params --from` reads.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct ParametersDocument {
    /// The robot's numbers by their names.
    pub parameters: BTreeMap<String, f64>,
    /// How often it was calibrated; 0 if never.
    #[serde(default)]
    pub calibration: u32,
    /// Whether a change was kept in the robot.
    #[serde(default)]
    pub saved: bool,
}

/// A line of `wmr monitor --json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct MonitorLine {
    /// Seconds of the robot's clock.
    pub t: f64,
    /// What the robot does.
    pub state: String,
    /// Why it stopped by itself, if it did.
    #[cfg_attr(test, schemars(with = "Option<String>"))]
    pub fault: Option<Fault>,
    /// Where it believes to be.
    pub pose: Pose,
    /// How fast its left and right wheel turn, rad/s.
    pub wheels: [f32; 2],
    /// The leg it drives, from 0.
    pub leg: u16,
    /// What its encoders have counted, left and right.
    pub counts: [i32; 2],
    /// In how many ticks each of them lost counts.
    pub skipped: [u16; 2],
    /// Its battery, volts, if it measures it.
    pub battery: Option<f32>,
}

/// `wmr check base --json`.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct WiringDocument {
    /// How motors and encoders are connected.
    pub wiring: WiringBits,
    /// Whether the robot keeps that.
    pub saved: bool,
}

/// How motors and encoders are connected, against the guide's drawing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct WiringBits {
    /// The motors are on each other's outputs.
    pub motors_swapped: bool,
    /// The encoders are on each other's inputs.
    pub encoders_swapped: bool,
    /// The motor on the left, the right outputs runs backwards.
    pub motor_reversed: [bool; 2],
    /// The encoder on the left, the right inputs counts backwards.
    pub encoder_reversed: [bool; 2],
}

impl From<Wiring> for WiringBits {
    fn from(wiring: Wiring) -> Self {
        Self {
            motors_swapped: wiring.has(Wiring::MOTORS_SWAPPED),
            encoders_swapped: wiring.has(Wiring::ENCODERS_SWAPPED),
            motor_reversed: [Wiring::LEFT_MOTOR_REVERSED, Wiring::RIGHT_MOTOR_REVERSED]
                .map(|bit| wiring.has(bit)),
            encoder_reversed: [Wiring::LEFT_ENCODER_REVERSED, Wiring::RIGHT_ENCODER_REVERSED]
                .map(|bit| wiring.has(bit)),
        }
    }
}

/// `wmr calibrate base --json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct BaseCalibrationDocument {
    /// The lengths that the robot had.
    pub before: BaseCalibrationState,
    /// Those that it has now.
    pub after: BaseCalibrationState,
    /// How often it was calibrated.
    pub calibration: u32,
    /// Whether it keeps them.
    pub saved: bool,
}

/// A base's lengths, and how well they explain what was measured.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct BaseCalibrationState {
    /// The wheels' mean radius, metres.
    pub wheel_radius: f64,
    /// The right wheel's radius over the left one's.
    pub wheel_ratio: f64,
    /// From wheel to wheel, metres.
    pub track: f64,
    /// How far from its start the robot ended after a square, at most, metres.
    pub return_error: f64,
    /// How far its ends were from where the lengths say, root mean square, metres.
    pub rms: f64,
}
