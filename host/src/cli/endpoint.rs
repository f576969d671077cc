//! Where a robot is: behind a port, or simulated. One loop drives them all, each on its own time.

use super::error::CliError;
use super::stop_desk::StopDesk;
use hil_sim::base::{self, BaseParameters, TruePose, WheeledBase};
use hil_sim::camera::{CameraFaults, Exposure, Frame, Stream};
use hil_sim::emulator::EmulatedPico;
use hil_sim::in_process::InProcess;
use hil_sim::motion::Motion;
use hil_sim::presets::paper_robot;
use hil_sim::script::Script;
use hil_sim::simulation::{Firmware, Simulation, Truth};
use hil_sim::wire;
use hil_sim::world::{Shape, World};
use protocol::motion::Timing;
use std::io::{self, Read, Write};
use std::path::Path;
use std::time::{Duration, Instant};
use wmr::geometry::Pose;
use wmr::link::drive::TimedPort;
use wmr::link::reopening::Reopening;
use wmr::scene::Scene;

/// A port to a robot, real or simulated.
pub(crate) trait Endpoint: TimedPort {
    /// What really happened, if anybody knows.
    fn truth(&self) -> Option<Truth>;
    /// A number that tells this connection from others.
    fn nonce(&self) -> u32;

    /// The port's name, if other programs may want it too.
    fn name(&self) -> Option<&str> {
        None
    }

    /// The world that a simulated robot stands in, if it is one.
    fn stage(&mut self) -> Option<&mut dyn Stage> {
        None
    }

    /// When its time 0 was, if it is the clock on the wall that goes on.
    fn epoch(&self) -> Option<Instant> {
        None
    }

    /// The next frame of the simulated camera over it, if there is one.
    fn take_frame(&mut self) -> Option<Frame> {
        None
    }

    /// Whether the other side closes every connection before it has said a word.
    fn is_turned_away(&self) -> bool {
        false
    }

    /// Whether the robot is still there when this program has ended.
    fn outlives_the_program(&self) -> bool {
        false
    }
}

/// What can be done to the world of a simulated robot while it runs.
pub(crate) trait Stage {
    /// Lets these things go wrong from now on.
    fn inject(
        &mut self,
        base: base::Faults,
        wires: (wire::Faults, wire::Pace),
        camera: CameraFaults,
    );
    /// Puts the robot down at `pose`, in another world if one is given, with this camera over it.
    fn arrange(&mut self, world: Option<World>, pose: TruePose, camera: Stream);
    /// A shape that comes into the world, and moves or stays.
    fn set_down(&mut self, shape: Shape, motion: Motion);
    /// The next frame of the camera, to be drawn elsewhere.
    fn take_exposure(&mut self) -> Option<Exposure>;
}

impl<B: Firmware> Stage for Simulation<B> {
    fn inject(
        &mut self,
        base: base::Faults,
        (faults, pace): (wire::Faults, wire::Pace),
        camera: CameraFaults,
    ) {
        self.base_mut().set_faults(base);
        self.wires().into_iter().for_each(|wire| wire.change(faults, pace));
        self.camera_mut().into_iter().for_each(|stream| stream.set_faults(camera));
    }

    fn arrange(&mut self, world: Option<World>, pose: TruePose, camera: Stream) {
        Self::arrange(self, world, pose, camera);
    }

    fn set_down(&mut self, shape: Shape, motion: Motion) {
        Self::set_down(self, shape, motion);
    }

    fn take_exposure(&mut self) -> Option<Exposure> {
        Self::take_exposure(self)
    }
}

impl<B: Firmware> Endpoint for Simulation<B> {
    fn truth(&self) -> Option<Truth> {
        Some(self.truth())
    }

    fn stage(&mut self) -> Option<&mut dyn Stage> {
        Some(self)
    }

    fn take_frame(&mut self) -> Option<Frame> {
        Self::take_frame(self)
    }

    /// Always the same, so that a simulated run is the same every time.
    fn nonce(&self) -> u32 {
        1
    }
}

/// A real port and the clock on the wall.
#[derive(Debug)]
struct RealPort {
    name: String,
    wire: Reopening,
    opened: Instant,
    /// Where other programs, which cannot open the port, may ask for a stop.
    _desk: StopDesk,
}

impl Read for RealPort {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        self.wire.read(buffer)
    }
}

impl Write for RealPort {
    fn write(&mut self, buffer: &[u8]) -> io::Result<usize> {
        self.wire.write(buffer)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.wire.flush()
    }
}

impl TimedPort for RealPort {
    fn now(&self) -> Duration {
        self.opened.elapsed()
    }

    fn wait(&mut self, duration: Duration) -> io::Result<()> {
        std::thread::sleep(duration);
        Ok(())
    }

    fn is_open(&self) -> bool {
        self.wire.is_open()
    }
}

impl Endpoint for RealPort {
    fn truth(&self) -> Option<Truth> {
        None
    }

    fn nonce(&self) -> u32 {
        // The system's random seed of hash maps: differs from process to process, without a crate for it.
        use std::hash::{BuildHasher, RandomState};
        RandomState::new().hash_one(0) as u32
    }

    fn name(&self) -> Option<&str> {
        Some(&self.name)
    }

    fn epoch(&self) -> Option<Instant> {
        Some(self.opened)
    }

    fn is_turned_away(&self) -> bool {
        self.wire.is_turned_away()
    }

    fn outlives_the_program(&self) -> bool {
        true
    }
}

/// A simulated robot that keeps to the clock on the wall, for a camera that does.
pub(crate) struct Paced {
    inner: Box<dyn Endpoint>,
    began: Instant,
}

impl Paced {
    pub(crate) fn new(inner: Box<dyn Endpoint>) -> Self {
        let began = Instant::now();
        Self { began: began.checked_sub(inner.now()).unwrap_or(began), inner }
    }
}

impl Read for Paced {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        self.inner.read(buffer)
    }
}

impl Write for Paced {
    fn write(&mut self, buffer: &[u8]) -> io::Result<usize> {
        self.inner.write(buffer)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.inner.flush()
    }
}

impl TimedPort for Paced {
    fn now(&self) -> Duration {
        self.inner.now()
    }

    fn wait(&mut self, duration: Duration) -> io::Result<()> {
        std::thread::sleep((self.now() + duration).saturating_sub(self.began.elapsed()));
        // What passed meanwhile passes here too.
        self.inner.wait(self.began.elapsed().saturating_sub(self.now()).max(duration))
    }
}

impl Endpoint for Paced {
    fn truth(&self) -> Option<Truth> {
        self.inner.truth()
    }

    fn nonce(&self) -> u32 {
        self.inner.nonce()
    }

    fn epoch(&self) -> Option<Instant> {
        Some(self.began)
    }
}

/// Which robot `sim` is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum SimulatedRobot {
    Default,
    /// The paper's, which is faster; for `--timing paper`.
    Paper,
}

impl SimulatedRobot {
    /// The one that can keep to a timing.
    pub(crate) fn for_timing(timing: Timing) -> Self {
        match timing {
            Timing::Limits => Self::Default,
            Timing::Paper { .. } => Self::Paper,
        }
    }
}

/// What a simulated robot stands in.
#[derive(Clone, Debug)]
pub(crate) struct SimulatedWorld {
    pub(crate) world: Option<World>,
    pub(crate) start: TruePose,
    pub(crate) seed: u64,
    /// The camera over it.
    pub(crate) camera: Option<Stream>,
    /// What goes wrong.
    pub(crate) script: Option<Script>,
}

impl SimulatedWorld {
    /// An endless, empty floor.
    pub(crate) fn nowhere(seed: u64) -> Self {
        Self { world: None, start: TruePose::default(), seed, camera: None, script: None }
    }

    /// The world of `scene`, with the robot at `start`.
    pub(crate) fn new(scene: &Scene, start: Pose, seed: u64) -> Self {
        Self { world: Some(scene.into()), start: start.into(), seed, camera: None, script: None }
    }

    /// `firmware` on `base` in this world.
    pub(crate) fn with<B: Firmware>(self, firmware: B, base: BaseParameters) -> Simulation<B> {
        let base = WheeledBase::new(base, self.start);
        let mut simulation = Simulation::new(firmware, base, self.world);
        if let Some(camera) = self.camera {
            simulation = simulation.with_camera(camera);
        }
        if let Some(script) = self.script {
            simulation.run_script(script);
        }
        simulation
    }

    fn robot(self, robot: SimulatedRobot) -> Simulation<InProcess> {
        let seed = self.seed;
        match robot {
            SimulatedRobot::Default => {
                self.with(InProcess::default(), BaseParameters::seeded(seed))
            }
            SimulatedRobot::Paper => {
                self.with(InProcess::new(paper_robot(), 1), BaseParameters::paper(seed))
            }
        }
    }
}

/// Opens the port of that name; `simulated` is the world for `sim` and `elf:FILE`, `robot` the robot
/// for `sim`.
pub(crate) fn open(
    name: &str,
    simulated: SimulatedWorld,
    robot: SimulatedRobot,
) -> Result<Box<dyn Endpoint>, CliError> {
    if name == "sim" {
        return Ok(Box::new(simulated.robot(robot)));
    }
    if let Some(elf) = name.strip_prefix("elf:") {
        let base = BaseParameters::seeded(simulated.seed);
        return Ok(Box::new(simulated.with(EmulatedPico::spawn(Path::new(elf))?, base)));
    }
    let wire = Reopening::open(name)?;
    let desk = StopDesk::open(name);
    Ok(Box::new(RealPort { name: name.to_owned(), wire, opened: Instant::now(), _desk: desk }))
}
