//! Scenarios from files, run to their named end: the matrix of faults and moments.
//!
//! An end that a robot reports is judged by the truth: an arrival is `reached` only if the robot really
//! stands there, and any end is `moving` if it still moves two seconds later.

use hil_sim::scenario::{self, Scenario};
use hil_sim::simulation::{Firmware, Simulation, Truth};
use protocol::motion::{Limits, Pose};
use std::fmt::Write as _;
use std::fs;
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};
use std::time::Duration;
use wmr::geometry::Point;
use wmr::link::drive::TimedPort;
use wmr::link::rehearsal::{Director, Ending, Moment, Task, rehearse};

/// A robot farther from its goal has missed it, m.
const REACHED_POSITION: f64 = 0.01;
/// Or looking so far past it, rad.
const REACHED_HEADING: f64 = 0.05;
/// After its end a scenario is watched for so long.
const AFTERWARDS: Duration = Duration::from_secs(2);
/// In as much time again it moves by no more, m and rad: a resting encoder flickers by a count.
const STILL: f64 = 0.001;
const STILL_HEADING: f64 = 0.01;
/// A camera's error, m and rad, one σ.
const CAMERA_ERROR: [f64; 2] = [0.002, 0.005];

/// A simulation as a port with its own clock.
#[derive(Debug)]
pub struct Stage<B>(pub Simulation<B>);

impl<B> Read for Stage<B> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        self.0.read(buffer)
    }
}

impl<B> Write for Stage<B> {
    fn write(&mut self, buffer: &[u8]) -> io::Result<usize> {
        self.0.write(buffer)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl<B: Firmware> TimedPort for Stage<B> {
    fn now(&self) -> Duration {
        self.0.now()
    }

    fn wait(&mut self, duration: Duration) -> io::Result<()> {
        self.0.wait(duration)
    }
}

struct Troublemaker<'a> {
    scenario: &'a Scenario,
    random: fastrand::Rng,
}

impl<B: Firmware> Director<Stage<B>> for Troublemaker<'_> {
    fn disturb(&mut self, stage: &mut Stage<B>) -> io::Result<()> {
        stage.0.run_script(self.scenario.script.clone());
        Ok(())
    }

    fn look(&mut self, stage: &Stage<B>) -> Option<Pose> {
        let mut error = |sigma: f64| {
            // The sum of twelve is near enough to Gauss's curve.
            sigma * ((0..12).map(|_| self.random.f64()).sum::<f64>() - 6.0)
        };
        let pose = stage.0.truth().pose;
        let [position, heading] = CAMERA_ERROR;
        let seen = [error(position), error(position), error(heading)];
        self.scenario.camera.then(|| {
            let [x, y, heading] = [pose.x + seen[0], pose.y + seen[1], pose.heading + seen[2]];
            Pose::new(x as f32, y as f32, heading as f32)
        })
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
    let random = fastrand::Rng::with_seed(scenario.seed);
    let mut director = Troublemaker { scenario, random };
    let (stage, ending) = rehearse(Stage(simulation), &task, in_words(moment), &mut director);
    let mut simulation = stage.0;
    let duration = simulation.now();
    simulation.wait(AFTERWARDS).unwrap();
    let before = simulation.truth().pose;
    simulation.wait(AFTERWARDS).unwrap();
    let truth = simulation.truth();
    let way = (truth.pose.x - before.x).hypot(truth.pose.y - before.y);
    let moves = way > STILL || (truth.pose.heading - before.heading).sin().abs() > STILL_HEADING;
    let code = if moves { "moving".into() } else { judge(scenario, &ending, truth) };
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

fn judge(scenario: &Scenario, ending: &Ending, truth: Truth) -> String {
    if !matches!(ending, Ending::Arrived(_)) {
        return ending.code().into();
    }
    let [x, y] = *scenario.way.last().unwrap();
    let off = (truth.pose.x - x).hypot(truth.pose.y - y);
    let turned = scenario.goal_heading.map_or(0.0, |goal| (truth.pose.heading - goal).sin().abs());
    if truth.collision_log.is_some_and(|log| log.collisions > 0) {
        "collided".into()
    } else if off > REACHED_POSITION || turned > REACHED_HEADING {
        "missed".into()
    } else {
        "reached".into()
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
