//! The simulated robot as a port: it takes the place of a real one at the end of the flow, on a clock of
//! its own that runs as fast as the computer can.
//!
//! It joins two crates that know nothing of each other: this one, which plans and talks to robots, and
//! [`hil_sim`], which has the physics and a camera over them. Metres and radians in the arena frame.

use crate::geometry::{Arena, Pose};
use crate::link::drive::TimedPort;
use crate::scene::Scene;
use crate::shape::Shape;
use crate::vision::{self, DetectOptions, Photo, VisionError};
use hil_sim::base::{BaseParameters, TruePose, WheeledBase};
use hil_sim::camera::{self, Frame, Lens};
use hil_sim::in_process::InProcess;
use hil_sim::simulation::{Firmware, Simulation};
use hil_sim::world::{self, World};
use std::io;
use std::time::Duration;

impl<B: Firmware> TimedPort for Simulation<B> {
    fn now(&self) -> Duration {
        self.now()
    }

    fn wait(&mut self, duration: Duration) -> io::Result<()> {
        self.wait(duration)
    }
}

impl From<Pose> for TruePose {
    fn from(Pose { position, heading }: Pose) -> Self {
        Self { x: position.x, y: position.y, heading }
    }
}

impl From<TruePose> for Pose {
    fn from(TruePose { x, y, heading }: TruePose) -> Self {
        Self::new(x, y, heading)
    }
}

impl From<&Scene> for World {
    /// The scene's arena and obstacles, without their margins: what really stands there.
    fn from(scene: &Scene) -> Self {
        let shapes = scene.obstacles.iter().map(|obstacle| true_shape(&obstacle.footprint));
        Self {
            size: [scene.arena.width, scene.arena.height],
            shapes: shapes.collect(),
            movers: Vec::new(),
            robot_radius: scene.robot_radius,
        }
    }
}

fn true_shape(shape: &Shape) -> world::Shape {
    match shape {
        Shape::Rect(rect) => world::Shape::Rect((*rect).into()),
        Shape::Circle(circle) => world::Shape::Circle((*circle).into()),
        Shape::Polygon(polygon) => {
            world::Shape::Polygon(polygon.corners().iter().map(|&at| at.into()).collect())
        }
    }
}

impl From<&Lens> for vision::Camera {
    /// The lens as a camera file has it.
    fn from(lens: &Lens) -> Self {
        Self {
            model: vision::CameraModel::Perspective,
            image_size: lens.image_size,
            matrix: lens.matrix,
            k1: lens.k1,
            rotation: lens.rotation,
            translation: lens.translation,
            spread: None,
        }
    }
}

impl TryFrom<&Frame> for Photo {
    type Error = VisionError;

    fn try_from(frame: &Frame) -> Result<Self, VisionError> {
        let pixels = frame.rgb.as_chunks::<3>().0.to_vec();
        Self::from_rgb(frame.width, frame.height, pixels)
    }
}

/// Who looks for the robot in the pictures of a camera.
///
/// No two pictures of a camera are alike, for their noise differs: one that comes twice is an old one, whatever
/// time it bears, and shows nobody where the robot is.
///
/// ```
/// use wmr::simulated::Onlooker;
/// use hil_sim::{base::TruePose, camera, world::World};
/// let world = World { size: [1.6, 1.2], shapes: vec![], movers: vec![], robot_radius: 0.075 };
/// let mut stream = camera::Stream::new(
///     camera::Camera::above(world.size, [640, 480]),
///     camera::Timing { latency: std::time::Duration::ZERO, ..camera::Timing::default() },
/// );
/// let pose = TruePose { x: 0.5, y: 0.4, heading: 1.0 };
/// let now = std::time::Duration::from_secs(1);
/// stream.expose(now, |camera| camera.look().stage(&world, pose));
/// let frame = stream.take(now).unwrap();
/// let mut onlooker = Onlooker::new(world.size, world.robot_radius);
/// let seen = onlooker.look(&frame, stream.camera()).unwrap();
/// assert!((seen.position.x - 0.5).hypot(seen.position.y - 0.4) < 0.005);
/// assert_eq!(onlooker.look(&frame, stream.camera()), None);
/// ```
#[derive(Clone, Debug)]
pub struct Onlooker {
    arena: Arena,
    robot_radius: f64,
    last: Vec<u8>,
}

impl Onlooker {
    /// Over a floor of this size, for a robot of this radius, m.
    pub fn new([width, height]: [f64; 2], robot_radius: f64) -> Self {
        Self { arena: Arena { width, height }, robot_radius, last: Vec::new() }
    }

    /// Where the robot is in a frame by a camera that stands where `camera` says; `None` if the frame is an
    /// old one, or shows no robot, or nothing at all.
    pub fn look(&mut self, frame: &Frame, camera: &camera::Camera) -> Option<Pose> {
        if frame.rgb == self.last {
            return None;
        }
        self.last.clone_from(&frame.rgb);
        let photo = Photo::try_from(frame).ok()?;
        let options = DetectOptions {
            camera: Some(camera.lens().into()),
            robot_radius: self.robot_radius,
            robot_height: camera.look().robot_height,
            ..DetectOptions::default()
        };
        vision::detect(&photo, self.arena, &options).ok()?.robot
    }
}

/// The default robot at rest at `start` in the world of `scene`; `seed` draws its encoders' jitter.
pub fn robot_in(scene: &Scene, start: Pose, seed: u64) -> Simulation<InProcess> {
    let base = WheeledBase::new(BaseParameters::seeded(seed), start.into());
    Simulation::new(InProcess::default(), base, Some(scene.into()))
}
