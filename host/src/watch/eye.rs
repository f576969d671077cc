//! From a frame to a sight: the robot's pose and the obstacles, with what the first frame has told of the arena.
//!
//! The border is looked for once. Later frames are held against the first: a camera that has not moved shows the
//! floor where it was. If it has, the border is looked for again where nothing but the picture had told where it
//! is; else the frame is of no use. A robot whose mark is not found is expected where odometry has it, so that it
//! is not taken for an obstacle. What has not changed since the frames before is not read again ([`Sequence`]); whether
//! the camera stands still is asked whenever a whole frame is read, and every few frames. A picture that stays the
//! same to the last pixel while the robot drives is a camera that hangs, and is not believed: no two real pictures
//! have the same noise.

use crate::geometry::{Arena, Pose, wrap_angle};
use crate::scene::Obstacle;
use crate::vision::{
    DetectOptions, Detection, Photo, PlanMap, Sequence, VisionError, check_picture, check_still,
};
use std::time::Duration;

/// A robot that moved or turned by more than this, m and rad, looks different.
const MOVED: (f64, f64) = (0.01, 0.05);

/// Every so many-th frame is held against the first one, even if little has changed.
const STILL_EVERY: u32 = 10;

/// What one frame shows.
#[derive(Clone, Debug, PartialEq)]
pub struct Sight {
    /// When the frame was exposed.
    pub exposed: Duration,
    /// The robot, if its mark or tag was seen.
    pub robot: Option<Pose>,
    /// All that stands on the floor but the robot.
    pub obstacles: Vec<Obstacle>,
    /// The arena was found again, as the camera has moved.
    pub relocated: bool,
}

/// Why a frame is of no use.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum EyeError {
    /// The camera moved, and what was said of it does not hold any more.
    #[error("the camera has moved since the first frame, or something covers it")]
    #[diagnostic(help("put it back, or start the drive again"))]
    Moved(#[source] VisionError),
    /// The camera hangs.
    #[error("the picture stays the same though the robot moves")]
    #[diagnostic(help("restart the camera"))]
    Frozen,
    /// Nothing was found.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Vision(#[from] VisionError),
}

/// What looks at frames.
#[derive(Clone, Debug)]
pub struct Eye {
    sequence: Sequence,
    /// Where floor points are in the frames.
    map: PlanMap,
    first: Photo,
    /// Frames since the camera was last found to stand still.
    unchecked: u32,
    /// The last picture that differed from the one before, and where the robot was expected in it.
    last: Option<(Photo, Option<Pose>)>,
    /// Whether somebody else than the picture has said where the arena is.
    is_fixed: bool,
}

impl Eye {
    /// An eye for frames like `first`, in which `detection` was found with `options`.
    pub fn new(first: Photo, arena: Arena, options: DetectOptions, detection: &Detection) -> Self {
        let is_fixed =
            options.corners.is_some() || options.camera.is_some() || options.empty.is_some();
        let map = detection.map.clone();
        let sequence = Sequence::new(arena, options);
        Self { sequence, map, first, unchecked: 0, last: None, is_fixed }
    }

    /// Where the frames show the corners 0..3 of the arena, pixels.
    pub fn corners(&self, arena: Arena) -> [[f64; 2]; 4] {
        self.map.seen_corners(arena)
    }

    /// What a photo that was exposed at `exposed` shows; the robot is `expected` there.
    ///
    /// # Errors
    /// [`EyeError`] if it cannot be used.
    pub fn look(
        &mut self,
        photo: &Photo,
        exposed: Duration,
        expected: Option<Pose>,
    ) -> Result<Sight, EyeError> {
        if self.is_frozen(photo, expected) {
            return Err(EyeError::Frozen);
        }
        let changes = self.changes(photo, expected);
        let (seen, relocated) = match changes {
            Some(seen) => (seen, false),
            None => self.whole(photo, expected)?,
        };
        // Where no mark was found, the expected pose comes back as it is.
        let robot = seen.robot.filter(|pose| Some(*pose) != expected);
        Ok(Sight { exposed, robot, obstacles: seen.obstacles, relocated })
    }

    /// What a photo shows that is much like the one before; `None` if all of it must be read.
    fn changes(&mut self, photo: &Photo, expected: Option<Pose>) -> Option<Detection> {
        self.unchecked += 1;
        if self.unchecked >= STILL_EVERY {
            check_still(photo, &self.first).ok()?;
            self.unchecked = 0;
        }
        self.sequence.read_changes(photo, expected)
    }

    /// What the whole of a photo shows, and whether the arena was found again.
    fn whole(
        &mut self,
        photo: &Photo,
        expected: Option<Pose>,
    ) -> Result<(Detection, bool), EyeError> {
        check_picture(photo)?;
        let still = check_still(photo, &self.first);
        let relocated = still.is_err();
        if let Err(why) = still
            && self.is_fixed
        {
            return Err(EyeError::Moved(why));
        }
        let map = (!relocated).then(|| self.map.clone());
        let seen = self.sequence.read_whole(photo, map, expected)?;
        self.unchecked = 0;
        if relocated {
            self.map = seen.map.clone();
            self.first = photo.clone();
        }
        Ok((seen, relocated))
    }

    /// Whether the picture is the last one again, while the robot was expected to move on.
    fn is_frozen(&mut self, photo: &Photo, expected: Option<Pose>) -> bool {
        match &self.last {
            Some((last, then)) if last == photo => {
                then.zip(expected).is_some_and(|(then, now)| has_moved(then, now))
            }
            _ => {
                self.last = Some((photo.clone(), expected));
                false
            }
        }
    }
}

fn has_moved(from: Pose, to: Pose) -> bool {
    from.position.distance(to.position) > MOVED.0
        || wrap_angle(to.heading - from.heading).abs() > MOVED.1
}
