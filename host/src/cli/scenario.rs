//! `wmr sim --scenario`: one scenario played to its end, with a picture that moves.

use super::args::SimArgs;
use super::error::{CliError, Exit};
use super::folder::write_file;
use super::output::Output;
use super::sim::{read_text, refused};
use hil_sim::emulator::EmulatedPico;
use hil_sim::scenario::{self, Camera, Scenario};
use hil_sim::simulation::{Firmware, Simulation};
use protocol::motion;
use serde_json::json;
use std::io::{self, Read, Write};
use std::path::Path;
use std::time::Duration;
use wmr::geometry::{Arena, Point, Pose};
use wmr::link::drive::TimedPort;
use wmr::link::rehearsal::{Director, Ending, Moment, Sight, Task, rehearse};
use wmr::picture::replay::{Replay, replay_svg};

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
    let (mut stage, ending) = act(scenario, simulation, args.moment);
    let seconds = stage.simulation.now().as_secs_f64();
    let moves = scenario::still_moves(&mut stage.simulation).map_err(failed)?;
    let sight = sight(scenario, &stage, moves);
    let end = ending.verdict(&sight);
    let expected = scenario.expect.iter().find(|(moment, _)| *moment == args.moment);
    let expected = expected.map(|(_, end)| end.as_str());
    if let Some(out) = &args.out {
        write_file(out, draw(scenario, &stage.trail, end).as_bytes())?;
    }
    let pose = stage.simulation.truth().pose;
    let document = json!({
        "title": scenario.title,
        "end": end,
        "expected": expected,
        "duration": seconds,
        "true_pose": Pose::new(pose.x, pose.y, pose.heading),
        "error": {"position": sight.position_error, "heading": sight.heading_error.abs()},
        "collided": sight.collided,
    });
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
    simulation: Simulation<B>,
    moment: scenario::Moment,
) -> (Stage<B>, Ending) {
    let start = scenario.start;
    let task = Task {
        start: motion::Pose::new(start.x as f32, start.y as f32, start.heading as f32),
        way: scenario.way.iter().map(|[x, y]| Point::new(*x, *y)).collect(),
        goal_heading: scenario.goal_heading,
        limits: scenario.parameters().limits(),
    };
    let mut director = Troublemaker { scenario, camera: Camera::of(scenario) };
    let stage = Stage { simulation, trail: Vec::new() };
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

fn draw(scenario: &Scenario, trail: &[Pose], end: &str) -> String {
    let [width, height] = scenario.world.size;
    let start = Point::new(scenario.start.x, scenario.start.y);
    let way = scenario.way.iter().map(|[x, y]| Point::new(*x, *y));
    let outlines: Vec<_> = scenario.world.shapes.iter().map(|shape| shape.outline()).collect();
    replay_svg(&Replay {
        arena: Arena { width, height },
        radius: scenario.world.robot_radius,
        outlines: &outlines,
        way: &std::iter::once(start).chain(way).collect::<Vec<_>>(),
        trail,
        frame: FRAME,
        title: &format!("{}: {end}", scenario.title),
    })
}

/// A simulated robot on its own time, and where it has been.
struct Stage<B> {
    simulation: Simulation<B>,
    trail: Vec<Pose>,
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
        while FRAME * self.trail.len() as u32 <= self.simulation.now() {
            let pose = self.simulation.truth().pose;
            self.trail.push(Pose::new(pose.x, pose.y, pose.heading));
        }
        Ok(())
    }
}

struct Troublemaker<'a> {
    scenario: &'a Scenario,
    camera: Camera,
}

impl<B: Firmware> Director<Stage<B>> for Troublemaker<'_> {
    fn disturb(&mut self, stage: &mut Stage<B>) -> io::Result<()> {
        stage.simulation.run_script(self.scenario.script.clone());
        Ok(())
    }

    fn look(&mut self, stage: &Stage<B>) -> Option<motion::Pose> {
        let pose = stage.simulation.truth().pose;
        let [x, y, heading] = self.camera.sees(pose)?;
        Some(motion::Pose::new(x as f32, y as f32, heading as f32))
    }
}
