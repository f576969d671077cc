//! Where a second `wmr stop` reaches the program that has a robot's port, which it cannot open.
//!
//! ```text
//! wmr stop ─► socket in the user's state folder ─► wmr drive, calibrate, check, serve, ... ─► robot
//!          ◄──────────── how it ended ◄───────────┘
//! ```
//! Whoever has the port keeps a Unix socket whose name is drawn from the port's. Whoever connects and says
//! `stop` asks for what Ctrl-C does there, and reads one line when the robot rests.

#[cfg(unix)]
mod unix;
#[cfg(not(unix))]
mod without;

#[cfg(unix)]
pub(crate) use unix::{StopDesk, ask, asked, confirm};
#[cfg(not(unix))]
pub(crate) use without::{StopDesk, ask, asked, confirm};

use super::resume::state_folder;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::PathBuf;
use std::time::Duration;

/// How long a stop through another program may take: to brake, and for its timeouts.
const ANSWER_TIMEOUT: Duration = Duration::from_secs(8);

/// What whoever connects says.
const STOP: &[u8] = b"stop\n";

/// What stands in the answer of a program that has stopped its robot.
const RESTS: &str = "stopped";

/// What became of a stop that was asked of another program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Answer {
    /// No other program has that robot's port, as far as is known.
    Nobody,
    /// It has stopped.
    Stopped,
    /// The other program was told, and did not say that the robot rests.
    Unconfirmed,
}

/// The socket that belongs to a port, whatever it is called.
fn socket(port: &str) -> Option<PathBuf> {
    let device = wmr::link::port::resolve(port).unwrap_or_else(|_| port.to_owned());
    let device = std::fs::canonicalize(&device).unwrap_or_else(|_| device.into());
    let mut hasher = DefaultHasher::new();
    device.hash(&mut hasher);
    Some(state_folder()?.join(format!("{:016x}.sock", hasher.finish())))
}
