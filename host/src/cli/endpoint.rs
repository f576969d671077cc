//! Where a robot is: behind a port, or simulated. One loop drives them all, each on its own time.

use super::error::CliError;
use hil_sim::base::{self, BaseParameters, TruePose, WheeledBase};
use hil_sim::emulator::EmulatedPico;
use hil_sim::in_process::InProcess;
use hil_sim::presets::paper_robot;
use hil_sim::simulation::{Firmware, Simulation, Truth};
use hil_sim::wire;
use hil_sim::world::{self, World};
use std::io::{self, Read, Write};
use std::path::Path;
use std::time::{Duration, Instant};
use wmr::geometry::Pose;
use wmr::link::drive::TimedPort;
use wmr::link::reopening::Reopening;
use wmr::scene::Scene;
use wmr::shape::Shape;

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

    /// Lets these things go wrong from now on, if the robot is simulated.
    fn inject(&mut self, _base: base::Faults, _wires: (wire::Faults, wire::Pace)) {}

    /// Whether the other side closes every connection before it has said a word.
    fn is_turned_away(&self) -> bool {
        false
    }

    /// Whether the robot is still there when this program has ended.
    fn outlives_the_program(&self) -> bool {
        false
    }
}

/// A simulated robot on its own time.
#[derive(Debug)]
pub(crate) struct Simulated<B: Firmware>(pub(crate) Simulation<B>);

impl<B: Firmware> Read for Simulated<B> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        self.0.read(buffer)
    }
}

impl<B: Firmware> Write for Simulated<B> {
    fn write(&mut self, buffer: &[u8]) -> io::Result<usize> {
        self.0.write(buffer)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.0.flush()
    }
}

impl<B: Firmware> TimedPort for Simulated<B> {
    fn now(&self) -> Duration {
        self.0.now()
    }

    fn wait(&mut self, duration: Duration) -> io::Result<()> {
        self.0.wait(duration)
    }
}

impl<B: Firmware> Endpoint for Simulated<B> {
    fn truth(&self) -> Option<Truth> {
        Some(self.0.truth())
    }

    fn inject(&mut self, base: base::Faults, (faults, pace): (wire::Faults, wire::Pace)) {
        self.0.base_mut().set_faults(base);
        self.0.wires().into_iter().for_each(|wire| wire.change(faults, pace));
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

    fn is_turned_away(&self) -> bool {
        self.wire.is_turned_away()
    }

    fn outlives_the_program(&self) -> bool {
        true
    }
}

/// Which robot `sim` is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum SimulatedRobot {
    Default,
    /// The paper's, which is faster; for `--timing paper`.
    Paper,
}

/// What a simulated robot stands in.
/// A shape as the simulation knows it.
fn true_shape(shape: &Shape) -> world::Shape {
    match shape {
        Shape::Rect(rect) => world::Shape::Rect((*rect).into()),
        Shape::Circle(circle) => world::Shape::Circle((*circle).into()),
        Shape::Polygon(polygon) => {
            world::Shape::Polygon(polygon.corners().iter().map(|&at| at.into()).collect())
        }
    }
}

#[derive(Clone, Debug)]
pub(crate) struct SimulatedWorld {
    pub(crate) world: Option<World>,
    pub(crate) start: TruePose,
    pub(crate) seed: u64,
}

impl SimulatedWorld {
    /// The world of `scene`, with the robot at `start`.
    pub(crate) fn new(scene: &Scene, start: Pose, seed: u64) -> Self {
        let world = World {
            size: [scene.arena.width, scene.arena.height],
            shapes: scene
                .obstacles
                .iter()
                .map(|obstacle| true_shape(&obstacle.footprint))
                .collect(),
            robot_radius: scene.robot_radius,
        };
        let start = TruePose { x: start.position.x, y: start.position.y, heading: start.heading };
        Self { world: Some(world), start, seed }
    }

    /// `firmware` on `base` in this world.
    pub(crate) fn with<B: Firmware>(self, firmware: B, base: BaseParameters) -> Simulation<B> {
        Simulation::new(firmware, WheeledBase::new(base, self.start), self.world)
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
        return Ok(Box::new(Simulated(simulated.robot(robot))));
    }
    if let Some(elf) = name.strip_prefix("elf:") {
        let base = BaseParameters::seeded(simulated.seed);
        return Ok(Box::new(Simulated(simulated.with(EmulatedPico::spawn(Path::new(elf))?, base))));
    }
    let wire = Reopening::open(name)?;
    Ok(Box::new(RealPort { name: name.to_owned(), wire, opened: Instant::now() }))
}
