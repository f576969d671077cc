//! Frames for a watched drive: of a simulated camera in simulated time, or of a real one.

use crate::cli::args::DriveArgs;
use crate::cli::endpoint::{self, Endpoint, SimulatedRobot, SimulatedWorld};
use crate::cli::error::CliError;
use crate::cli::output::Output;
use crate::cli::sim_camera::png;
use hil_sim::camera::{self, Lens, Light, Look, Mark, Sensor, Stream, Timing};
use std::time::{Duration, Instant};
use wmr::geometry::Pose;
use wmr::vision::{Camera, Photo, TagDictionary};
use wmr::watch::source::{self, Background, SourceError};
use wmr::watch::{Expected, Eye, LiveWatcher, Watcher};

/// The first frame is waited for so long.
const FIRST: Duration = Duration::from_secs(10);
/// An older first frame is worth a word.
const OLD: Duration = Duration::from_secs(5);
/// How high a simulated camera hangs over the floor, m, and how large its frames are; over a floor that is deeper
/// than wide it hangs turned.
const HEIGHT: f64 = 2.5;
const FRAME: [usize; 2] = [640, 480];
/// How many of them it sends a second.
const RATE: f64 = 10.0;
/// The side of the tag on a simulated robot, as a share of its radius.
const TAG_SIDE: f64 = 1.2;

/// The first frame, and where the others come from.
pub(super) struct First {
    /// A picture file.
    pub(super) bytes: Vec<u8>,
    /// The camera that took it, if it is simulated.
    pub(super) camera: Option<Camera>,
    pub(super) frames: Frames,
}

/// Where frames come from.
pub(super) enum Frames {
    /// With a simulated robot.
    Simulated(Box<dyn Endpoint>),
    Live(Background),
}

/// The first frame of a simulated camera over that world.
pub(super) fn simulated(
    world: SimulatedWorld,
    robot: SimulatedRobot,
    args: &DriveArgs,
) -> Result<First, CliError> {
    let size = world.world.as_ref().map_or([1.0; 2], |world| world.size);
    let radius = world.world.as_ref().map_or(0.075, |world| world.robot_radius);
    let stream = camera_over(size, robot_look(args.vision.robot_tag, radius)?);
    let camera = Some(Camera::from(stream.camera().lens()));
    let world = SimulatedWorld { camera: Some(stream), ..world };
    let mut endpoint = endpoint::open(&args.port, world, robot)?;
    let frame = loop {
        if let Some(frame) = endpoint.take_frame() {
            break frame;
        }
        if endpoint.now() > FIRST {
            return Err(SourceError::Silent(FIRST).into());
        }
        endpoint.wait(Duration::from_millis(5)).map_err(wmr::link::LinkError::from)?;
    };
    let bytes = png(&frame)?;
    Ok(First { bytes, camera, frames: Frames::Simulated(endpoint) })
}

/// A simulated camera over a floor of this size, m, on which robot and things look like that.
pub(crate) fn camera_over(size: [f64; 2], look: Look) -> Stream {
    let [longer, shorter] = FRAME;
    let frame = if size[1] > size[0] { [shorter, longer] } else { [longer, shorter] };
    let lens = Lens::above(size, HEIGHT, frame);
    let camera = camera::Camera::new(lens, Light::beside(size), look, Sensor::default());
    Stream::new(camera, Timing { rate: RATE, ..Timing::default() })
}

/// A robot with a tag, if it is to be known by one.
fn robot_look(tag: Option<usize>, radius: f64) -> Result<Look, CliError> {
    let Some(id) = tag else { return Ok(Look::default()) };
    let cells =
        TagDictionary::named("4X4_50").and_then(|tags| tags.cells(id)).ok_or_else(|| {
            CliError::usage(format!("there is no tag {id} of 4X4_50"), "give --robot-tag 0 to 49")
        })?;
    let mark = Mark::Tag { side: TAG_SIDE * radius, cells };
    Ok(Look { mark, robot: [240; 3], ..Look::default() })
}

/// The first frame of a real camera.
pub(super) fn live(name: &str, output: Output) -> Result<First, CliError> {
    let source = Background::start(source::open(name)?);
    let frame = source.first(FIRST)?;
    let age = frame.delivered.saturating_duration_since(frame.exposed);
    if age > OLD {
        output.say(&format!(
            "the first frame is {:.0} s old; the robot waits if no newer ones come",
            age.as_secs_f64()
        ));
    }
    Ok(First { bytes: frame.bytes, camera: None, frames: Frames::Live(source) })
}

/// Who looks at the frames during the drive.
pub(super) enum Watching {
    Simulated { eye: Box<Eye>, expected: Expected },
    Live(LiveWatcher),
}

impl Watching {
    pub(super) fn simulated(eye: Eye) -> Self {
        Self::Simulated { eye: Box::new(eye), expected: Expected::default() }
    }

    /// Frames are exposed `delay` earlier than their source says, by the clock of `endpoint`.
    pub(super) fn live(
        source: Background,
        eye: Eye,
        endpoint: &dyn Endpoint,
        delay: Duration,
    ) -> Self {
        let epoch = endpoint.epoch().unwrap_or_else(Instant::now);
        Self::Live(LiveWatcher::start(source, eye, epoch, delay))
    }
}

impl Watcher<Box<dyn Endpoint>> for Watching {
    fn expect(&mut self, at: Duration, pose: Pose) {
        match self {
            Self::Simulated { expected, .. } => expected.push(at, pose),
            Self::Live(live) => Watcher::<Box<dyn Endpoint>>::expect(live, at, pose),
        }
    }

    fn look(
        &mut self,
        port: &mut Box<dyn Endpoint>,
        now: Duration,
    ) -> Result<wmr::watch::Look, SourceError> {
        let (eye, expected) = match self {
            Self::Live(live) => return live.look(port, now),
            Self::Simulated { eye, expected } => (eye, expected),
        };
        let Some(frame) = port.take_frame() else { return Ok(wmr::watch::Look::Nothing) };
        let photo = match Photo::try_from(&frame) {
            Ok(photo) => photo,
            Err(error) => return Ok(wmr::watch::Look::failed(&error)),
        };
        Ok(match eye.look(&photo, frame.exposed, expected.at(frame.exposed)) {
            Ok(sight) => wmr::watch::Look::Seen(sight),
            Err(error) => wmr::watch::Look::failed(&error),
        })
    }
}
