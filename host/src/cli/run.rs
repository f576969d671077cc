//! What happened on a drive, for files, programs and people: metres and radians, seconds of the robot's
//! clock.

use super::error::CliError;
use protocol::message::{LegResult, State, Telemetry};
use protocol::motion::{self, Leg, Limits};
use wmr::document::{DriveDocument, LegDocument, PoseError, RunLine, WatchDocument};
use wmr::geometry::{Point, Pose, wrap_angle};
use wmr::legs::{from_wire, planned_end};
use wmr::link::LinkStatistics;
use wmr::link::mission::MissionEvent;

/// What happened on the way.
#[derive(Clone, Debug)]
pub(crate) struct Run {
    pub(crate) legs: Vec<Leg>,
    /// The first of them that was driven: others before it were driven earlier.
    pub(crate) first: u16,
    pub(crate) limits: Limits,
    pub(crate) samples: Vec<Sample>,
    pub(crate) results: Vec<LegResult>,
    pub(crate) end: Pose,
    /// Where the way leads. The legs may lead less far: one of a millimetre moves no wheel.
    pub(crate) goal: Option<Point>,
    /// Where the arena's lower left corner lies in the frame of the map, metres; documents give poses
    /// in that frame.
    pub(crate) origin: Point,
    pub(crate) truth: Option<hil_sim::simulation::Truth>,
    pub(crate) link: LinkStatistics,
    /// What was counted, if a camera watched.
    pub(crate) watch: Option<WatchDocument>,
}

/// A run that came to its end, or was cut short by an error: what is known of it is worth keeping then.
#[derive(Debug)]
pub(crate) struct Driven {
    pub(crate) run: Run,
    pub(crate) error: Option<CliError>,
}

/// What the robot said at one moment.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sample {
    /// Since the plan began, seconds.
    pub(crate) time: f64,
    pub(crate) telemetry: Telemetry,
}

#[derive(Debug, Default)]
pub(crate) struct RunClock {
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
    pub(crate) fn new(legs: Vec<Leg>, limits: Limits, start: Pose) -> Self {
        Self {
            legs,
            first: 0,
            limits,
            samples: Vec::new(),
            results: Vec::new(),
            end: start,
            goal: None,
            origin: Point::new(0.0, 0.0),
            truth: None,
            link: LinkStatistics::default(),
            watch: None,
        }
    }

    /// The legs that were to be driven.
    pub(crate) fn rest(&self) -> &[Leg] {
        self.legs.get(usize::from(self.first)..).unwrap_or_default()
    }

    /// Records an event.
    pub(crate) fn record(&mut self, event: MissionEvent, clock: &mut RunClock) {
        match event {
            MissionEvent::Telemetry(telemetry) if telemetry.state != State::Idle => {
                self.samples.push(Sample { time: clock.seconds(telemetry.ticks), telemetry });
            }
            MissionEvent::LegDone(result) => self.results.push(result),
            MissionEvent::Done(pose) => self.end = from_wire(pose),
            MissionEvent::Connected(_)
            | MissionEvent::Accepted { .. }
            | MissionEvent::Replaced { .. }
            | MissionEvent::NotReplaced(_)
            | MissionEvent::PoseRefused(_)
            | MissionEvent::Telemetry(_) => {}
        }
    }

    /// How long the legs took, seconds of the robot's clock; of a watched drive, with all that was cut short
    /// and waited for.
    pub(crate) fn duration(&self) -> f64 {
        if let (Some(_), Some(last)) = (&self.watch, self.samples.last()) {
            return last.time;
        }
        let ticks: f64 = self.results.iter().map(|result| f64::from(result.ticks)).sum();
        ticks * f64::from(motion::TICK_MILLISECONDS) / 1000.0
    }

    /// Where the robot really is if somebody knows, else where it believes to be.
    pub(crate) fn best_pose(&self) -> Pose {
        self.truth.map_or(self.end, |truth| truth.pose.into())
    }

    /// A pose of the arena frame as a person with the map reads it.
    pub(crate) fn in_map_frame(&self, pose: Pose) -> Pose {
        let Point { x, y } = pose.position;
        Pose { position: Point::new(x + self.origin.x, y + self.origin.y), ..pose }
    }

    /// How far it is from the goal: metres and radians.
    pub(crate) fn error(&self) -> (f64, f64) {
        let planned = planned_end(&self.legs, &self.limits).unwrap_or(self.end);
        let position = self.goal.unwrap_or(planned.position);
        difference(Pose { position, ..planned }, self.best_pose())
    }

    /// Whether it ended at the goal.
    pub(crate) fn reached(&self) -> bool {
        let (position, heading) = self.error();
        position < REACHED_POSITION && heading < REACHED_HEADING
    }

    /// The document of `wmr drive --json`.
    pub(crate) fn document(&self) -> DriveDocument {
        let (position, heading) = self.error();
        let truth = self.truth.map(|truth| truth.pose);
        let log = self.truth.and_then(|truth| truth.collision_log);
        DriveDocument {
            reached: self.reached(),
            pose: self.in_map_frame(self.end),
            true_pose: truth.map(|pose| self.in_map_frame(pose.into())),
            error: PoseError { position, heading },
            duration: self.duration(),
            legs: self.leg_documents(),
            collisions: log.map(|log| log.collisions),
            min_clearance: log.map(|log| log.min_clearance),
            link: self.link.into(),
            watch: self.watch.clone(),
        }
    }

    fn leg_documents(&self) -> Vec<LegDocument> {
        let document = |(result, leg): (&LegResult, &Leg)| {
            let goal = from_wire(leg.intervals(&self.limits)[2].end());
            let (position, heading) = difference(goal, from_wire(result.pose));
            LegDocument {
                index: result.index,
                duration: f64::from(result.ticks) * f64::from(motion::TICK_MILLISECONDS) / 1000.0,
                error: PoseError { position, heading },
            }
        };
        self.results.iter().zip(self.rest()).map(document).collect()
    }

    /// The lines of `run.jsonl`.
    pub(crate) fn lines(&self) -> String {
        let line = |Sample { time, telemetry }: &Sample| {
            let line = RunLine {
                t: *time,
                pose: self.in_map_frame(from_wire(telemetry.pose)),
                wheels: [telemetry.wheels.left.0, telemetry.wheels.right.0],
                leg: telemetry.leg,
                state: state_name(telemetry.state).into(),
            };
            format!("{}\n", serde_json::json!(line))
        };
        self.samples.iter().map(line).collect()
    }
}

/// Nearer than this the goal counts as reached: a tenth of the default robot's radius, metres.
const REACHED_POSITION: f64 = 0.0075;
/// And looking as wanted to this, radians: 2°.
const REACHED_HEADING: f64 = 0.035;

fn difference(goal: Pose, pose: Pose) -> (f64, f64) {
    (goal.position.distance(pose.position), wrap_angle(pose.heading - goal.heading).abs())
}

/// `1 leg` or `3 legs`.
pub(crate) fn count_of_legs(count: usize) -> String {
    format!("{count} leg{}", if count == 1 { "" } else { "s" })
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
