//! `wmr calibrate base`: what a robot's lengths really are.
//!
//! ```text
//! for each course: put on its mark ─► drives ─► its end is measured ─► lengths ─► two squares more
//! ```
//! A person measures on a real robot; on the simulated one, whose true pose is known, nobody has to.

use super::args::CalibrateBaseArgs;
use super::endpoint::{self, Endpoint, SimulatedRobot, SimulatedWorld};
use super::error::{CliError, Exit};
use super::mission::{self, interrupted_error};
use super::output::Output;
use super::{params, quantity};
use hil_sim::base::BaseParameters;
use hil_sim::in_process::InProcess;
use protocol::motion;
use protocol::parameters::Parameters;
use wmr::calibration::{BaseLengths, Calibration, Course, Run, calibrate, seen_from};
use wmr::document::{BaseCalibrationDocument, BaseCalibrationState};
use wmr::geometry::Pose;
use wmr::legs::from_wire;
use wmr::link::drive::POLL_INTERVAL;
use wmr::link::mission::{Mission, MissionError, MissionEvent};
use wmr::link::{LinkClient, LinkError};

const INSTRUCTIONS: &str = "\
The robot drives six courses on free floor; after each you measure where it ended.
Mark where it stands now: a line under its axle, and one along its middle. From that mark x is ahead,
y to the left, and the angle counts to the left, in degrees. Write them as x,y,angle: 12mm,-8mm,1.5";

/// `wmr calibrate base`.
pub(crate) fn base(args: &CalibrateBaseArgs, output: Output) -> Result<(), CliError> {
    mission::catch_interrupts();
    let endpoint = open(args)?;
    let nonce = endpoint.nonce();
    let mut floor = Floor { client: LinkClient::new(endpoint, nonce), output };
    let result = floor.calibrate(args);
    mission::finish(&mut floor.client, result)
}

fn worse(before: f64, after: f64) -> CliError {
    let message = format!(
        "with the lengths found the robot misses its start by {:.0} mm, before by {:.0} mm",
        after * 1000.0,
        before * 1000.0
    );
    let help = "it has its old lengths again; look for slipping wheels, and measure once more";
    CliError::new(Exit::Robot, "calibrate.worse", message, help)
}

fn open(args: &CalibrateBaseArgs) -> Result<Box<dyn Endpoint>, CliError> {
    let seed = args.sim_seed;
    let nowhere = SimulatedWorld::nowhere(seed);
    if args.port == "sim" {
        let wrong = args.sim_errors.map(|percent| 1.0 + percent / 100.0);
        let base = BaseParameters::seeded(seed).with_wrong_lengths(wrong);
        return Ok(Box::new(nowhere.with(InProcess::default(), base)));
    }
    endpoint::open(&args.port, nowhere, SimulatedRobot::Default)
}

/// How far from its start the robot ended after a square, at most, m.
fn return_error(runs: &[Run]) -> f64 {
    let squares = runs.iter().filter(|run| matches!(run.course, Course::Square { .. }));
    squares.map(|run| run.measured.position.x.hypot(run.measured.position.y)).fold(0.0, f64::max)
}

/// The robot, and whoever measures.
struct Floor {
    client: LinkClient<Box<dyn Endpoint>>,
    output: Output,
}

impl Floor {
    fn calibrate(&mut self, args: &CalibrateBaseArgs) -> Result<(), CliError> {
        mission::connect(&mut self.client)?;
        let old = params::read(&mut self.client)?;
        if self.truth().is_none() {
            self.output.ask(&format!("{INSTRUCTIONS}\n"));
        }
        let courses = Course::all(args.side);
        let runs = self.drive_all(&courses)?;
        let found = calibrate(BaseLengths::of(&old), &runs)?;
        let new = found.lengths.applied_to(&old, old.calibration.wrapping_add(1));
        params::set(&mut self.client, new)?;
        self.output.say("with the lengths found, a square each way:");
        let checks = [true, false].map(|left| Course::Square { side: args.side, left });
        // The old lengths come back whatever goes wrong from here on.
        let checked = self.drive_all(&checks).map(|runs| return_error(&runs));
        let after = match checked {
            Ok(after) if after <= return_error(&runs) => after,
            other => {
                params::restore(&mut self.client, old);
                let was = return_error(&runs);
                return Err(other.map_or_else(|error| error, |after| worse(was, after)));
            }
        };
        if !args.no_save {
            params::keep(&mut self.client)?;
        }
        let result = Outcome { old, new, found, before: return_error(&runs), after };
        self.output.result(&result.document(!args.no_save), &result.text(args))
    }

    fn drive_all(&mut self, courses: &[Course]) -> Result<Vec<Run>, CliError> {
        let numbered = (1..).zip(courses);
        numbered.map(|(number, course)| self.run(number, courses.len(), *course)).collect()
    }

    fn run(&mut self, number: usize, of: usize, course: Course) -> Result<Run, CliError> {
        let before = self.truth();
        let title = format!("{number} of {of}: {}", describe(course));
        match before {
            Some(_) => self.output.say(&title),
            None => {
                self.output.ask(&format!("{title}\nPut the robot on its mark, then press Enter:"));
                self.line()?;
            }
        }
        let believed = self.drive(course)?;
        let measured = match (before, self.truth()) {
            (Some(before), Some(after)) => seen_from(before, after),
            _ => self.measure()?,
        };
        Ok(Run { course, believed, measured })
    }

    /// Drives a course; where the robot believes it ended.
    fn drive(&mut self, course: Course) -> Result<Pose, CliError> {
        let mut mission = Mission::new(course.legs(), motion::Pose::default());
        loop {
            if mission::stop_wanted() {
                self.client.stop();
            }
            let now = self.client.port_mut().now();
            let events = mission.step(&mut self.client, now).map_err(|error| match error {
                MissionError::Stopped if mission::stop_wanted() => {
                    interrupted_error("the robot has stopped; its lengths are the old ones")
                }
                error => error.into(),
            })?;
            let end = events.into_iter().find_map(|event| match event {
                MissionEvent::Done(pose) => Some(from_wire(pose)),
                _ => None,
            });
            if let Some(end) = end {
                return Ok(end);
            }
            self.client.port_mut().wait(POLL_INTERVAL).map_err(LinkError::from)?;
        }
    }

    fn truth(&mut self) -> Option<Pose> {
        let truth = self.client.port_mut().truth()?;
        Some(truth.pose.into())
    }

    /// What a person has measured, asked for until it is a pose.
    fn measure(&mut self) -> Result<Pose, CliError> {
        loop {
            self.output.ask("Where did it end? x,y,angle:");
            match quantity::place(&self.line()?) {
                Ok(wmr::scene::Goal { position, heading: Some(heading) }) => {
                    return Ok(Pose { position, heading });
                }
                Ok(_) => self.output.ask("the angle is missing, such as 12mm,-8mm,1.5\n"),
                Err(why) => self.output.ask(&format!("{why}\n")),
            }
        }
    }

    /// A line from the person; the robot rests meanwhile.
    fn line(&self) -> Result<String, CliError> {
        mission::line_of_person(
            "the input ended before all courses were measured",
            "calibrate in a terminal, or give an answer a line: an empty one to start, then x,y,angle",
        )
    }
}

fn describe(course: Course) -> String {
    match course {
        Course::Straight { length } => format!("straight ahead for {length} m"),
        Course::Spin { turns } => format!("{turns} turns on the spot"),
        Course::Square { side, left: true } => format!("a square of {side} m to the left"),
        Course::Square { side, left: false } => format!("a square of {side} m to the right"),
    }
}

struct Outcome {
    old: Parameters,
    new: Parameters,
    found: Calibration,
    before: f64,
    after: f64,
}

impl Outcome {
    fn document(&self, saved: bool) -> BaseCalibrationDocument {
        let state = |parameters: &Parameters, return_error: f64, rms: f64| {
            let BaseLengths { wheel_radius, wheel_ratio, track } = BaseLengths::of(parameters);
            BaseCalibrationState { wheel_radius, wheel_ratio, track, return_error, rms }
        };
        BaseCalibrationDocument {
            before: state(&self.old, self.before, self.found.before),
            after: state(&self.new, self.after, self.found.after),
            calibration: self.new.calibration,
            saved,
        }
    }

    fn text(&self, args: &CalibrateBaseArgs) -> String {
        let (old, new) = (BaseLengths::of(&self.old), BaseLengths::of(&self.new));
        let millimetres = |name: &str, before: f64, after: f64| {
            format!("{name:22} {:9.3} {:9.3} mm\n", before * 1000.0, after * 1000.0)
        };
        let mut text = format!("{:22} {:>9} {:>9}\n", "", "before", "after");
        text += &millimetres("wheel radius", old.wheel_radius, new.wheel_radius);
        text += &format!("{:22} {:9.5} {:9.5}\n", "wheel ratio", old.wheel_ratio, new.wheel_ratio);
        text += &millimetres("track", old.track, new.track);
        text += &millimetres("back from the square", self.before, self.after);
        text += match (args.port.as_str(), args.no_save) {
            ("sim", _) => "the simulated robot is gone with this program, and its lengths with it",
            (_, true) => "the robot forgets these lengths when it loses power",
            (_, false) => "saved in the robot; wmr params shows them",
        };
        text
    }
}
