//! What goes wrong in a simulation, and when: faults that begin at a time, a place or an event.
//!
//! ```text
//! file ─► script ─► timeline ─(time, pose, motion)─► faults of wires, firmware, base, world and camera
//! ```
//! Times are since the script began to run. Metres, radians, volts, shares 0..=1.

mod file;
mod timeline;

pub use crate::toml_file::FileError;
pub(crate) use file::{movers, shapes};
pub(crate) use timeline::{Change, Condition, Glance, Timeline};

use crate::base::{EncoderFault, TruePose};
use crate::camera::CameraFaults;
use crate::motion::Motion;
use crate::wire::{Faults, Pace};
use crate::world::Shape;
use std::time::Duration;

/// Faults, each with its time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Script {
    /// In the file's order.
    pub faults: Vec<Scripted>,
}

impl Script {
    /// Whether it asks for a camera, without which such faults would change nothing.
    pub fn needs_camera(&self) -> bool {
        self.faults.iter().any(|scripted| matches!(scripted.fault, Fault::Camera(_)))
    }
}

/// One fault and its time.
#[derive(Clone, Debug, PartialEq)]
pub struct Scripted {
    /// What goes wrong.
    pub fault: Fault,
    /// What it begins with.
    pub trigger: Trigger,
    /// So long after that.
    pub delay: Duration,
    /// For how long; `None` for ever. What happens in a moment lasts no time anyway.
    pub lasts: Option<Duration>,
}

/// What a fault begins with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Trigger {
    /// The script's begin.
    Start,
    /// The robot is for the first time within `radius` of a place, m.
    Place {
        /// The place.
        at: [f64; 2],
        /// How near.
        radius: f64,
    },
    /// The base does this for the `nth` time, counted from 1.
    Event {
        /// What.
        event: Event,
        /// For which time.
        nth: u32,
    },
}

/// What a base may begin to do, as seen from outside.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Event {
    /// To turn on the spot.
    Turn,
    /// To drive.
    Drive,
    /// To rest after it moved.
    Rest,
    /// To touch a shape or wall.
    Bump,
}

/// Something that goes wrong.
#[derive(Clone, Debug, PartialEq)]
pub enum Fault {
    /// The wires fail, towards robot and host.
    Wires(WireFault),
    /// The robot restarts.
    Reset,
    /// The robot has no power, and starts when it is back.
    BrownOut,
    /// The battery has this voltage.
    Battery(f64),
    /// A wheel's encoder does this.
    Encoder(Wheels, EncoderFault),
    /// Each encoder counts the other wheel.
    EncodersSwapped,
    /// Wheels are held fast.
    Blocked(Wheels),
    /// This share of the rim's travel slips.
    Slip(Wheels, f64),
    /// This share of the motor's duty is lost; at 2 it turns the other way.
    Weak(Wheels, f64),
    /// The wheels turn in the air.
    Lifted,
    /// Somebody pushes the robot: metres ahead and to the left, and radians.
    Bump([f64; 3]),
    /// Somebody puts the robot down elsewhere.
    Kidnapped(TruePose),
    /// A shape comes into the world, moves or stays, and goes away after the fault.
    Shape(Shape, Motion),
    /// The camera over the world fails.
    Camera(CameraFaults),
}

/// Which wheels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Wheels(pub [bool; 2]);

impl Wheels {
    /// Both of them.
    pub const BOTH: Self = Self([true; 2]);

    pub(crate) fn apply<T: Copy>(self, values: &mut [T; 2], value: T) {
        for (place, _) in values.iter_mut().zip(self.0).filter(|(_, is)| *is) {
            *place = value;
        }
    }
}

/// How wires fail, to the robot and to the host.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WireFault {
    /// Which of the two.
    pub directions: [bool; 2],
    /// How often frames are damaged.
    pub faults: Faults,
    /// How late they are.
    pub pace: Pace,
}
