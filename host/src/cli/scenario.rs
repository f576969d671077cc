//! `wmr sim --scenario`: one scenario played to its end, with a picture that moves.

use super::args::SimArgs;
use super::error::{CliError, Exit};
use super::folder::write_named;
use super::output::Output;
use super::sim::{read_text, refused};
use super::sim_camera::{self, Outlets};
use hil_sim::camera::Frame;
use hil_sim::emulator::EmulatedPico;
use hil_sim::scenario::{self, Camera, Scenario, Watch};
use hil_sim::simulation::{Firmware, Simulation};
use hil_sim::world::{Shape, World};
use protocol::motion;
use std::io::{self, Read, Write};
use std::path::Path;
use std::time::Duration;
use wmr::document::{PoseError, ScenarioDocument};
use wmr::geometry::{Arena, Point, Pose};
use wmr::legs::to_wire;
use wmr::link::drive::TimedPort;
use wmr::link::rehearsal::{Director, Ending, Moment, Sight, Task, rehearse};
use wmr::picture::replay::{Body, Replay, replay_svg};
use wmr::simulated::Onlooker;

/// The true pose is drawn so often.
const FRAME: Duration = Duration::from_millis(50);

/// Plays the scenario in the file of that name.
pub(super) fn play(path: &Path, args: &SimArgs, output: Output) -> Result<(), CliError> {
    let text = read_text(path)?;
    let scenario = Scenario::parse(&text);
    let scenario = scenario.map_err(|error| refused(&path.display().to_string(), &error))?;
    match &args.elf {
        Some(elf) => {
            finish(&scenario, scenario.with(EmulatedPico::spawn(elf)?), path, args, output)
        }
        None => finish(&scenario, scenario.in_process(), path, args, output),
    }
}

fn finish<B: Firmware>(
    scenario: &Scenario,
    simulation: Simulation<B>,
    path: &Path,
    args: &SimArgs,
    output: Output,
) -> Result<(), CliError> {
    // A scenario that is seen in pictures has a camera of its own.
    let own = scenario.pictures();
    let camera = match own {
        Some(_) => own,
        None => sim_camera::stream(&args.camera, scenario.world.size, scenario.seed),
    };
    let outlets = Outlets::open(&args.camera, camera.as_ref(), output)?;
    let simulation = match camera {
        Some(camera) => simulation.with_camera(camera),
        None => simulation,
    };
    let stage = Stage { simulation, film: Film::default(), outlets, saved: Ok(()), newest: None };
    let (mut stage, ending) = act(scenario, stage, args.moment);
    std::mem::replace(&mut stage.saved, Ok(()))?;
    let seconds = stage.simulation.now().as_secs_f64();
    let moves = scenario::still_moves(&mut stage.simulation).map_err(failed)?;
    let sight = sight(scenario, &stage, moves);
    let end = ending.verdict(&sight);
    let expected = scenario.expect.iter().find(|(moment, _)| *moment == args.moment);
    let expected = expected.map(|(_, end)| end.as_str());
    if let Some(out) = &args.out {
        let drawing = draw(scenario, &stage.film, end);
        write_named(out, drawing.as_bytes(), "drawing", |older| older.starts_with(b"<svg"))?;
    }
    let pose = stage.simulation.truth().pose;
    let document = ScenarioDocument {
        title: scenario.title.clone(),
        end: end.into(),
        expected: expected.map(str::to_owned),
        duration: seconds,
        true_pose: pose.into(),
        error: PoseError::new(sight.position_error, sight.heading_error),
        collided: sight.collided,
    };
    let said = match &ending {
        Ending::Failed(error) => format!("\n{error}"),
        Ending::Arrived(_) | Ending::Endless => String::new(),
    };
    let text = format!("{}: {end} after {seconds:.2} s{said}\n", scenario.title);
    output.result(&document, &text)?;
    match expected {
        Some(expected) if expected != end => {
            let message = format!("it should have ended as {expected}, and ended as {end}");
            let help = format!("compare [expect] in {} with the picture of --out", path.display());
            let error = CliError::new(Exit::Robot, "scenario.other_end", message, help);
            Err(CliError { after_result: true, ..error })
        }
        _ => Ok(()),
    }
}

fn failed(error: io::Error) -> CliError {
    CliError::new(Exit::Port, "port.failed", error, "start it again")
}

fn act<B: Firmware>(
    scenario: &Scenario,
    stage: Stage<B>,
    moment: scenario::Moment,
) -> (Stage<B>, Ending) {
    let start = scenario.start;
    let task = Task {
        start: motion::Pose::new(start.x as f32, start.y as f32, start.heading as f32),
        way: scenario.way.iter().map(|[x, y]| Point::new(*x, *y)).collect(),
        goal_heading: scenario.goal_heading,
        limits: scenario.parameters().limits(),
    };
    let World { size, robot_radius, .. } = scenario.world;
    let onlooker = Onlooker::new(size, robot_radius);
    let mut director = Troublemaker { scenario, camera: Camera::of(scenario), onlooker };
    rehearse(stage, &task, rehearsed(moment), &mut director)
}

fn rehearsed(moment: scenario::Moment) -> Moment {
    match moment {
        scenario::Moment::Idle => Moment::Idle,
        scenario::Moment::FirstTurn => Moment::FirstTurn,
        scenario::Moment::Drive => Moment::Drive,
        scenario::Moment::LastTurn => Moment::LastTurn,
        scenario::Moment::Paused => Moment::Paused,
        scenario::Moment::Stopped => Moment::Stopped,
    }
}

fn sight<B: Firmware>(scenario: &Scenario, stage: &Stage<B>, moves: bool) -> Sight {
    let truth = stage.simulation.truth();
    let [x, y] = scenario.way.last().copied().unwrap_or([truth.pose.x, truth.pose.y]);
    let turned = |goal: f64| wmr::geometry::wrap_angle(truth.pose.heading - goal);
    Sight {
        position_error: (truth.pose.x - x).hypot(truth.pose.y - y),
        heading_error: scenario.goal_heading.map_or(0.0, turned),
        collided: truth.collision_log.is_some_and(|log| log.collisions > 0),
        moves,
    }
}

fn draw(scenario: &Scenario, film: &Film, end: &str) -> String {
    let [width, height] = scenario.world.size;
    let start = Point::new(scenario.start.x, scenario.start.y);
    let way = scenario.way.iter().map(|[x, y]| Point::new(*x, *y));
    let bodies: Vec<Body> = film.bodies.iter().map(|(_, body)| body.clone()).collect();
    replay_svg(&Replay {
        arena: Arena { width, height },
        radius: scenario.world.robot_radius,
        bodies: &bodies,
        way: &std::iter::once(start).chain(way).collect::<Vec<_>>(),
        trail: &film.trail,
        frame: FRAME,
        title: &format!("{}: {end}", scenario.title),
    })
}

/// Where everything was, frame by frame.
#[derive(Default)]
struct Film {
    trail: Vec<Pose>,
    /// With each body where it stood at first and since when, which tells it from others.
    bodies: Vec<((Shape, Duration), Body)>,
}

impl Film {
    fn add<B: Firmware>(&mut self, simulation: &Simulation<B>) {
        let pose = simulation.truth().pose;
        for (_, body) in &mut self.bodies {
            body.shifts.push(None);
        }
        if let Some(world) = simulation.world() {
            for shape in &world.shapes {
                self.see((shape, Duration::ZERO), [0.0; 2]);
            }
            for mover in &world.movers {
                self.see(mover.origin(), mover.shift(simulation.now()));
            }
        }
        self.trail.push(pose.into());
    }

    fn see(&mut self, (shape, began): (&Shape, Duration), shift: [f64; 2]) {
        let known = self.bodies.iter_mut().find(|((is, since), _)| is == shape && *since == began);
        if let Some(last) = known.and_then(|(_, body)| body.shifts.last_mut()) {
            *last = Some(shift);
            return;
        }
        let mut shifts = vec![None; self.trail.len()];
        shifts.push(Some(shift));
        let body = Body { corners: shape.outline(), shifts };
        self.bodies.push(((shape.clone(), began), body));
    }
}

/// A simulated robot on its own time, and where it has been.
struct Stage<B> {
    simulation: Simulation<B>,
    film: Film,
    outlets: Outlets,
    /// Whether all frames so far could be saved.
    saved: Result<(), CliError>,
    /// The newest frame that nobody has looked at.
    newest: Option<Frame>,
}

impl<B> Read for Stage<B> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        self.simulation.read(buffer)
    }
}

impl<B> Write for Stage<B> {
    fn write(&mut self, buffer: &[u8]) -> io::Result<usize> {
        self.simulation.write(buffer)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.simulation.flush()
    }
}

impl<B: Firmware> TimedPort for Stage<B> {
    fn now(&self) -> Duration {
        self.simulation.now()
    }

    fn wait(&mut self, duration: Duration) -> io::Result<()> {
        self.simulation.wait(duration)?;
        if self.saved.is_ok() {
            match self.outlets.take(&mut self.simulation) {
                Ok(frame) => self.newest = frame.or(self.newest.take()),
                Err(error) => self.saved = Err(error),
            }
        }
        while FRAME * self.film.trail.len() as u32 <= self.simulation.now() {
            self.film.add(&self.simulation);
        }
        Ok(())
    }
}

struct Troublemaker<'a> {
    scenario: &'a Scenario,
    camera: Camera,
    onlooker: Onlooker,
}

impl<B: Firmware> Director<Stage<B>> for Troublemaker<'_> {
    fn disturb(&mut self, stage: &mut Stage<B>) -> io::Result<()> {
        stage.simulation.run_script(self.scenario.script.clone());
        Ok(())
    }

    fn look(&mut self, stage: &mut Stage<B>) -> Option<(Duration, motion::Pose)> {
        if self.scenario.watch == Watch::Pictures {
            let frame = stage.newest.take()?;
            let camera = stage.simulation.camera_mut()?.camera();
            let robot = self.onlooker.look(&frame, camera)?;
            return Some((frame.exposed, to_wire(robot)));
        }
        let pose = stage.simulation.truth().pose;
        let [x, y, heading] = self.camera.sees(pose)?;
        let seen = motion::Pose::new(x as f32, y as f32, heading as f32);
        Some((stage.simulation.now(), seen))
    }
}
