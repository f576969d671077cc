//! Scenarios from files, run to their named end: the matrix of faults and moments.
//!
//! An end that a robot reports is judged by the truth: an arrival is `reached` only if the robot really
//! stands there, and any end is `moving` if it still moves two seconds later.

use hil_sim::scenario::{self, Camera, Scenario, Watch};
use hil_sim::simulation::{Firmware, Simulation, Truth};
use hil_sim::world::World;
use protocol::motion::{Limits, Pose};
use std::fmt::Write as _;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::time::Duration;
use wmr::geometry::Point;
use wmr::legs::to_wire;
use wmr::link::rehearsal::{Director, Moment, Sight, Task, rehearse};
use wmr::simulated::Onlooker;

struct Troublemaker<'a> {
    scenario: &'a Scenario,
    camera: Camera,
    onlooker: Onlooker,
}

impl<B: Firmware> Director<Simulation<B>> for Troublemaker<'_> {
    fn disturb(&mut self, simulation: &mut Simulation<B>) -> io::Result<()> {
        simulation.run_script(self.scenario.script.clone());
        Ok(())
    }

    fn look(&mut self, simulation: &mut Simulation<B>) -> Option<(Duration, Pose)> {
        if self.scenario.watch == Watch::Pictures {
            let frame = std::iter::from_fn(|| simulation.take_frame()).last()?;
            let camera = simulation.camera_mut()?.camera();
            let robot = self.onlooker.look(&frame, camera)?;
            return Some((frame.exposed, to_wire(robot)));
        }
        let [x, y, heading] = self.camera.sees(simulation.truth().pose)?;
        Some((simulation.now(), Pose::new(x as f32, y as f32, heading as f32)))
    }
}

/// What became of one cell.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    /// The name of the end.
    pub code: String,
    /// What really happened.
    pub truth: Truth,
    /// Simulated time until the end.
    pub duration: Duration,
}

/// Runs `scenario`, disturbed at `moment`, on `simulation`.
pub fn run<B: Firmware>(
    scenario: &Scenario,
    moment: scenario::Moment,
    simulation: Simulation<B>,
    limits: Limits,
) -> Outcome {
    let start = scenario.start;
    let task = Task {
        start: Pose::new(start.x as f32, start.y as f32, start.heading as f32),
        way: scenario.way.iter().map(|[x, y]| Point::new(*x, *y)).collect(),
        goal_heading: scenario.goal_heading,
        limits,
    };
    let World { size, robot_radius, .. } = scenario.world;
    let onlooker = Onlooker::new(size, robot_radius);
    let mut director = Troublemaker { scenario, camera: Camera::of(scenario), onlooker };
    let (mut simulation, ending) = rehearse(simulation, &task, in_words(moment), &mut director);
    let duration = simulation.now();
    let moves = scenario::still_moves(&mut simulation).unwrap();
    let truth = simulation.truth();
    let code = ending.verdict(&sight(scenario, truth, moves)).into();
    Outcome { code, truth, duration }
}

fn in_words(moment: scenario::Moment) -> Moment {
    match moment {
        scenario::Moment::Idle => Moment::Idle,
        scenario::Moment::FirstTurn => Moment::FirstTurn,
        scenario::Moment::Drive => Moment::Drive,
        scenario::Moment::LastTurn => Moment::LastTurn,
        scenario::Moment::Paused => Moment::Paused,
        scenario::Moment::Stopped => Moment::Stopped,
    }
}

fn sight(scenario: &Scenario, truth: Truth, moves: bool) -> Sight {
    let ([x, y], pose) = (*scenario.way.last().unwrap(), truth.pose);
    Sight {
        position_error: (pose.x - x).hypot(pose.y - y),
        heading_error: scenario.goal_heading.map_or(0.0, |goal| (pose.heading - goal).sin()),
        collided: truth.collision_log.is_some_and(|log| log.collisions > 0),
        moves,
    }
}

/// The scenarios of the suite, by file name.
pub fn all() -> Vec<(String, Scenario)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios");
    let mut files: Vec<PathBuf> =
        fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.retain(|file| file.extension().is_some_and(|extension| extension == "toml"));
    files.sort();
    files
        .into_iter()
        .map(|file| {
            let text = fs::read_to_string(&file).unwrap();
            let name = file.file_stem().unwrap().to_string_lossy().into_owned();
            let scenario = Scenario::parse(&text).unwrap_or_else(|error| panic!("{name}: {error}"));
            (name, scenario)
        })
        .collect()
}

/// All cells of the suite on the logic in this process: a line a fault, a column a moment.
pub fn table(outcomes: &[(String, Vec<Outcome>)]) -> String {
    let mut text = format!("{:24}", "fault");
    for (name, _) in scenario::Moment::ALL {
        let _ = write!(text, " {name:17}");
    }
    text.truncate(text.trim_end().len());
    text.push('\n');
    for (name, row) in outcomes {
        let mut line = format!("{name:24}");
        row.iter().for_each(|outcome| {
            let _ = write!(line, " {:17}", outcome.code);
        });
        text += line.trim_end();
        text.push('\n');
    }
    text
}

/// Runs every cell in this process.
pub fn run_all() -> Vec<(String, Vec<Outcome>)> {
    let row = |(name, scenario): (String, Scenario)| {
        let limits = scenario.parameters().limits();
        let cells = scenario::Moment::ALL.iter();
        let outcomes =
            cells.map(|(_, moment)| run(&scenario, *moment, scenario.in_process(), limits));
        (name, outcomes.collect())
    };
    all().into_iter().map(row).collect()
}
