//! Why a link cannot be used: what happened, with its values.

use std::io;
use std::time::Duration;

/// Why the link cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum LinkError {
    /// The port failed.
    #[error("the port failed: {0}")]
    Port(#[from] io::Error),
    /// Nothing answered hello.
    #[error("no robot answered within {0:?}")]
    Silent(Duration),
    /// Something answered, but not in this protocol.
    #[error("{bytes} bytes arrived within {within:?}, but no frame of a robot of ours")]
    NotARobot {
        /// Bytes that arrived.
        bytes: u64,
        /// How long was waited.
        within: Duration,
    },
    /// The robot fell silent.
    #[error("nothing heard from the robot for {0:?}; it stops by itself after 0.3 s of silence")]
    Lost(Duration),
    /// The robot is heard, but does not hear.
    #[error("the robot is heard, but took no notice of this program for {0:?}")]
    Deaf(Duration),
    /// The robot speaks another version of the protocol, so it may report and stop, but not drive.
    #[error(
        "the robot's firmware {} speaks protocol {} ({:016x}), this program {} ({:016x}); it does not drive",
        dotted(.firmware), .robot.0, .robot.1, .host.0, .host.1
    )]
    Version {
        /// The firmware's version.
        firmware: [u8; 3],
        /// The robot's version and schema hash.
        robot: (u16, u64),
        /// This program's.
        host: (u16, u64),
    },
    /// The robot began anew, so it has forgotten its plan.
    #[error("the robot has restarted; it is at rest and has forgotten the plan")]
    Restarted,
}

fn dotted([major, minor, patch]: &[u8; 3]) -> String {
    format!("{major}.{minor}.{patch}")
}
