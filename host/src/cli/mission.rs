//! Drives a plan on an endpoint, to the end or to rest, and writes down what happened.

use super::endpoint::Endpoint;
use super::error::{CliError, Exit};
use super::output::Output;
use host::geometry::{Point, Pose};
use host::legs::{from_wire, planned_end};
use host::link::mission::{Mission, MissionError, MissionEvent};
use host::link::{LinkClient, LinkStatistics};
use protocol::message::{LegResult, RobotHello, State, Telemetry};
use protocol::motion::{self, Leg, Limits};
use serde_json::{Value, json};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// How often the link is looked at.
pub(crate) const POLL: Duration = Duration::from_millis(2);
/// After Ctrl-C the robot is given this long to come to rest.
const STOP_PATIENCE: Duration = Duration::from_secs(3);

static INTERRUPTED: AtomicBool = AtomicBool::new(false);

/// From now on Ctrl-C asks for a stop instead of ending the program.
pub(crate) fn catch_interrupts() {
    // A second call finds the handler in place.
    let _ = ctrlc::set_handler(|| INTERRUPTED.store(true, Ordering::Relaxed));
}

/// Whether Ctrl-C was pressed.
pub(crate) fn interrupted() -> bool {
    INTERRUPTED.load(Ordering::Relaxed)
}

/// What happened on the way.
#[derive(Clone, Debug)]
pub(crate) struct Run {
    pub(crate) legs: Vec<Leg>,
    pub(crate) limits: Limits,
    pub(crate) samples: Vec<Sample>,
    pub(crate) results: Vec<LegResult>,
    pub(crate) end: Pose,
    pub(crate) truth: Option<hil_sim::simulation::Truth>,
    pub(crate) link: LinkStatistics,
}

/// What the robot said at one moment.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sample {
    /// Since the plan began, seconds.
    pub(crate) time: f64,
    pub(crate) telemetry: Telemetry,
}

/// Drives on `endpoint` the legs that `legs` makes for the robot's limits, beginning at `start`.
pub(crate) fn drive(
    endpoint: Box<dyn Endpoint>,
    start: Pose,
    legs: impl Fn(&Limits) -> Vec<Leg>,
    output: Output,
) -> Result<Run, CliError> {
    catch_interrupts();
    let nonce = endpoint.nonce();
    let mut client = LinkClient::new(endpoint, nonce);
    let robot = connect(&mut client)?;
    let limits = robot.limits;
    let legs = legs(&limits);
    let plural = if legs.len() == 1 { "" } else { "s" };
    output.say(&format!("robot: {}; {} leg{plural}", describe_robot(&robot), legs.len()));
    let progress = output.progress(legs.len() as u64);
    let wire_start =
        motion::Pose::new(start.position.x as f32, start.position.y as f32, start.heading as f32);
    let mut mission = Mission::new(legs.clone(), wire_start);
    let mut run = Run {
        legs,
        limits,
        samples: Vec::new(),
        results: Vec::new(),
        end: start,
        truth: None,
        link: LinkStatistics::default(),
    };
    if run.legs.is_empty() {
        run.truth = client.port_mut().truth();
        return Ok(run);
    }
    let mut clock = RunClock::default();
    let mut stop_by = None;
    loop {
        let now = client.port_mut().now();
        if interrupted() {
            client.stop();
            if now > *stop_by.get_or_insert(now + STOP_PATIENCE) {
                return Err(interrupted_error(
                    "the robot did not say that it rests; it stops by itself after 0.3 s of silence",
                ));
            }
        }
        let events = mission.step(&mut client, now).map_err(|error| match error {
            MissionError::Stopped if interrupted() => {
                interrupted_error("the robot has stopped and rests")
            }
            error => error.into(),
        })?;
        for event in events {
            if let MissionEvent::LegDone(_) = event {
                progress.inc(1);
            }
            if run.note(event, &mut clock) {
                progress.finish_and_clear();
                run.truth = client.port_mut().truth();
                run.link = client.statistics();
                return Ok(run);
            }
        }
        client.port_mut().wait(POLL).map_err(host::link::LinkError::from)?;
    }
}

/// Says hello until the robot answers; who it is.
pub(crate) fn connect(client: &mut LinkClient<Box<dyn Endpoint>>) -> Result<RobotHello, CliError> {
    loop {
        let now = client.port_mut().now();
        client.poll(now)?;
        if let Some(robot) = client.robot() {
            return Ok(*robot);
        }
        if interrupted() {
            return Err(interrupted_error("nothing has moved"));
        }
        client.port_mut().wait(POLL).map_err(host::link::LinkError::from)?;
    }
}

pub(crate) fn interrupted_error(message: &str) -> CliError {
    CliError::new(Exit::Interrupted, "interrupted", message, "drive again when ready")
}

#[derive(Debug, Default)]
struct RunClock {
    accepted: Option<u32>,
}

impl RunClock {
    /// Seconds of the robot's clock since the first word after the plan was accepted.
    fn seconds(&mut self, ticks: u32) -> f64 {
        let accepted = *self.accepted.get_or_insert(ticks);
        f64::from(ticks.wrapping_sub(accepted)) * f64::from(motion::TICK_MILLISECONDS) / 1000.0
    }
}

impl Run {
    /// Notes an event; true if it is the last.
    fn note(&mut self, event: MissionEvent, clock: &mut RunClock) -> bool {
        match event {
            MissionEvent::Telemetry(telemetry) if telemetry.state != State::Idle => {
                self.samples.push(Sample { time: clock.seconds(telemetry.ticks), telemetry });
            }
            MissionEvent::LegDone(result) => self.results.push(result),
            MissionEvent::Done(pose) => {
                self.end = from_wire(pose);
                return true;
            }
            MissionEvent::Connected(_)
            | MissionEvent::Accepted { .. }
            | MissionEvent::Telemetry(_) => {}
        }
        false
    }

    /// How long the legs took, seconds of the robot's clock.
    pub(crate) fn duration(&self) -> f64 {
        let ticks: u32 = self.results.iter().map(|result| result.ticks).sum();
        f64::from(ticks) * f64::from(motion::TICK_MILLISECONDS) / 1000.0
    }

    /// Where the robot really is if somebody knows, else where it believes to be.
    pub(crate) fn best_pose(&self) -> Pose {
        self.truth
            .map_or(self.end, |truth| Pose::new(truth.pose.x, truth.pose.y, truth.pose.heading))
    }

    /// How far it is from the goal: metres and radians.
    pub(crate) fn error(&self) -> (f64, f64) {
        let goal = planned_end(&self.legs, &self.limits).unwrap_or(self.end);
        difference(goal, self.best_pose())
    }

    /// Whether it ended at the goal.
    pub(crate) fn reached(&self) -> bool {
        let (position, heading) = self.error();
        position < REACHED_POSITION && heading < REACHED_HEADING
    }

    /// The document of `wmr drive --json`.
    pub(crate) fn document(&self) -> Value {
        let (position, heading) = self.error();
        let mut document = json!({
            "reached": self.reached(),
            "pose": self.end,
            "error": {"position": position, "heading": heading},
            "duration": self.duration(),
            "legs": self.leg_documents(),
            "link": {"frames": self.link.frames, "retransmitted": self.link.retransmitted, "lost": self.link.lost},
        });
        if let (Some(truth), Some(document)) = (self.truth, document.as_object_mut()) {
            document.insert(
                "true_pose".into(),
                json!([truth.pose.x, truth.pose.y, truth.pose.heading]),
            );
            if let Some(encounters) = truth.encounters {
                document.insert("collisions".into(), json!(encounters.collisions));
                document.insert("min_clearance".into(), json!(encounters.min_clearance));
            }
        }
        document
    }

    fn leg_documents(&self) -> Vec<Value> {
        self.results.iter().zip(&self.legs).map(|(result, leg)| {
            let goal = from_wire(leg.intervals(&self.limits)[2].end());
            let (position, heading) = difference(goal, from_wire(result.pose));
            let seconds = f64::from(result.ticks) * f64::from(motion::TICK_MILLISECONDS) / 1000.0;
            json!({"index": result.index, "duration": seconds, "error": {"position": position, "heading": heading}})
        }).collect()
    }

    /// The lines of `run.jsonl`.
    pub(crate) fn lines(&self) -> String {
        self.samples
            .iter()
            .map(|Sample { time, telemetry }| {
                let line = json!({
                    "t": time,
                    "pose": from_wire(telemetry.pose),
                    "wheels": [telemetry.wheels.left, telemetry.wheels.right],
                    "leg": telemetry.leg,
                    "state": state_name(telemetry.state),
                });
                format!("{line}\n")
            })
            .collect()
    }
}

/// Nearer than this the goal counts as reached: a tenth of the default robot's radius, metres.
const REACHED_POSITION: f64 = 0.0075;
/// And looking as wanted to this, radians: 2°.
const REACHED_HEADING: f64 = 0.035;

fn difference(goal: Pose, pose: Pose) -> (f64, f64) {
    let turn =
        (pose.heading - goal.heading + std::f64::consts::PI).rem_euclid(std::f64::consts::TAU);
    (Point::distance(goal.position, pose.position), (turn - std::f64::consts::PI).abs())
}

/// The name of a state in files.
pub(crate) fn state_name(state: State) -> &'static str {
    match state {
        State::Idle => "idle",
        State::Driving => "driving",
        State::Paused(_) => "paused",
        State::Stopped => "stopped",
        State::Faulted(_) => "faulted",
    }
}

/// A pose, for people.
pub(crate) fn place(pose: Pose) -> String {
    format!("({:.3}, {:.3}) m, {:.1}°", pose.position.x, pose.position.y, pose.heading.to_degrees())
}

/// A robot, for people.
pub(crate) fn describe_robot(robot: &RobotHello) -> String {
    let ([major, minor, patch], limits) = (robot.firmware, robot.limits);
    format!(
        "{:?}, firmware {major}.{minor}.{patch}, up to {} m/s and {} m/s²",
        robot.board, limits.speed.0, limits.acceleration.0
    )
}
