//! Pictures by a camera that hangs still, one after the other: only what has changed is read again.
//!
//! ```text
//! picture ─► robot near where it is expected ─► windows: its surroundings, what has changed, a slice in turn
//!    │                                             │
//!    └── blocks that differ from the last reading ─┘     each window: evidence ─► boxes ─► refined edges
//! ```
//! A whole reading tells what floor, shadow, light and border look like. Until the light changes that holds for
//! windows of later pictures, in each of which the whole things are looked for as in a whole picture; elsewhere things
//! are where they were. What a window cannot settle is read as a whole picture at once: another number of things than
//! before, a thing that its edge cuts, a robot that is not where it is expected, light that has changed, more changes
//! than a few windows hold. Blocks are held against the last reading of their place and not against the last picture,
//! so that nothing that changes slowly is missed; slices bring every place in turn, changed or not.
//!
//! Whether the camera still hangs where it did is the caller's to check. Metres and radians in the arena frame.

mod blocks;
mod nearby;
mod reading;
mod windows;

use super::camera::PlanMap;
use super::detect::{Detection, detect_whole};
use super::error::VisionError;
use super::image::Photo;
use super::options::DetectOptions;
use crate::geometry::{Arena, Pose};
use reading::Reading;

/// Pictures of an arena by a camera that hangs still.
#[derive(Clone, Debug)]
pub struct Sequence {
    arena: Arena,
    options: DetectOptions,
    last: Option<Reading>,
}

impl Sequence {
    /// Pictures that are looked at with `options`.
    pub fn new(arena: Arena, options: DetectOptions) -> Self {
        Self { arena, options, last: None }
    }

    /// Reads the whole of a picture, in which the robot is expected at `robot_at` and the floor is where `map` says
    /// or, without one, where the options tell.
    ///
    /// # Errors
    /// As [`detect`](super::detect()).
    pub fn read_whole(
        &mut self,
        photo: &Photo,
        map: Option<PlanMap>,
        robot_at: Option<Pose>,
    ) -> Result<Detection, VisionError> {
        self.last = None;
        let options = DetectOptions { map, robot_at, ..self.options.clone() };
        let (detection, whole, known) = detect_whole(photo, self.arena, &options)?;
        self.last =
            known.map(|known| Reading::new(photo, self.arena, detection.clone(), whole, known));
        Ok(detection)
    }

    /// Reads what has changed in a picture since those before, in which the robot is expected at `robot_at`; `None`
    /// if that does not settle what it shows, and it is to be read as a whole.
    pub fn read_changes(&mut self, photo: &Photo, robot_at: Option<Pose>) -> Option<Detection> {
        self.last.as_mut()?.next(photo, robot_at?, &self.options)
    }
}
