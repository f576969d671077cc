//! A camera that watches the drive and closes the loop: where the robot is, and what stands in its way.
//!
//! ```text
//! source ─► eye ─► sights ─► track::pose ──► corrections ─────────────► robot
//! frames   vision    │                                                    ▲
//!                    └────► floor ─► way free? ─► hold, other legs, go on ─┘
//!                           hazards      (route: plan, legs)
//! ```
//! A plan is only as good as the floor it was made for. While the robot drives, each frame is looked at: the
//! robot's pose goes to the filter and from there, in small steps, to the robot ([`track::pose`](crate::track::pose));
//! obstacles are held against the way still to drive ([`way`]). The answer is the mildest one that is safe:
//!
//! | what the frame says | answer |
//! |---|---|
//! | the way is free | drives on; if a much shorter way has opened, takes it |
//! | something stands in a later leg | other legs from where the leg under way ends, while driving |
//! | something stands in the leg under way | brakes on the path at once, then plans from there |
//! | something that moves will be in the way | brakes as late as it may; waits, or takes another way if that is quicker ([`dynamic`](crate::dynamic)) |
//! | no way | waits at rest, says why, and goes on when there is one |
//! | the camera is dark, or disagrees with the wheels | wider margins, slower legs, then waits at rest |
//!
//! What the camera says never moves a wheel by itself: legs do, and each was planned around all that is seen.
//! Sources ([`source`]) read on threads of their own; the loop ([`WatchedDrive`]) waits for none of them. All else
//! has no clock: times are the port's. Metres, radians, arena frame.

mod drive;
mod event;
mod eye;
mod floor;
mod live;
mod route;
pub mod source;
pub mod way;

pub use drive::{Happening, WatchError, WatchOptions, WatchStatistics, WatchedDrive};
pub use event::{Reason, WatchEvent};
pub use eye::{Eye, EyeError, Sight};
pub use floor::{Floor, Hazard};
pub use live::LiveWatcher;
pub use route::{Route, Router};

use crate::geometry::Pose;
use miette::Diagnostic;
use source::SourceError;
use std::time::Duration;

/// What became of the next frame.
#[derive(Debug)]
pub enum Look {
    /// There is none.
    Nothing,
    /// It was seen.
    Seen(Sight),
    /// It could not be used, or the source has trouble that may pass.
    Failed(String),
}

impl Look {
    /// Why a frame could not be used, and what to do.
    pub fn failed(error: &impl Diagnostic) -> Self {
        let help = error.help().map_or(String::new(), |help| format!("; {help}"));
        Self::Failed(format!("{error}{help}"))
    }
}

/// Somebody who looks at frames.
pub trait Watcher<P> {
    /// Is told where the robot is expected to be, again and again: later times only.
    fn expect(&mut self, at: Duration, pose: Pose);

    /// What is new by `now`, the port's time. Does not wait.
    ///
    /// # Errors
    /// [`SourceError`] if nothing more will come.
    fn look(&mut self, port: &mut P, now: Duration) -> Result<Look, SourceError>;
}

/// Where the robot was expected to be during the last two seconds.
#[derive(Clone, Debug, Default)]
pub struct Expected {
    poses: std::collections::VecDeque<(Duration, Pose)>,
}

impl Expected {
    /// How long a pose is remembered.
    const KEPT: Duration = Duration::from_secs(2);

    /// Remembers a pose.
    pub fn push(&mut self, at: Duration, pose: Pose) {
        self.poses.push_back((at, pose));
        while self.poses.front().is_some_and(|(old, _)| *old + Self::KEPT < at) {
            self.poses.pop_front();
        }
    }

    /// The pose that is nearest to that time.
    pub fn at(&self, time: Duration) -> Option<Pose> {
        let nearest = self.poses.iter().min_by_key(|(at, _)| at.abs_diff(time))?;
        Some(nearest.1)
    }
}
