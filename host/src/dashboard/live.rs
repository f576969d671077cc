//! What the robot thread tells the requests, and what they tell it.

use super::lock;
use crate::cli::run::state_name;
use protocol::message::{BatteryReport, RobotHello, State, Telemetry};
use protocol::motion::WheelSpeeds;
use serde_json::{Value, json};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};
use wmr::document::EventDocument;
use wmr::geometry::{Point, Pose};
use wmr::legs::from_wire;

/// What people ask of the robot while it may be busy with something else.
#[derive(Debug, Default)]
pub(super) struct Controls {
    /// Counts the stops: what was asked for before one is not carried out after it.
    stops: AtomicU64,
    paused: AtomicBool,
    /// The drive goes on although nobody watches it.
    unattended: AtomicBool,
    ended: AtomicBool,
    /// The button that is held, and since when nobody has said so again.
    held: Mutex<Option<(Hold, Instant)>>,
}

/// Where a robot moves while a button is held.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum Hold {
    Ahead,
    Back,
    Left,
    Right,
}

/// So many of the last events go to the pages again and again.
const SHOWN_EVENTS: usize = 6;

/// A button that nobody says is held for so long is let go: as patient as the robot is with its host.
const HOLD_PATIENCE: Duration = Duration::from_millis(300);

impl Controls {
    pub(super) fn stop(&self) {
        self.stops.fetch_add(1, Ordering::SeqCst);
        self.let_go();
    }

    /// A button is pressed.
    pub(super) fn begin_holding(&self, hold: Hold) {
        *lock(&self.held) = Some((hold, Instant::now()));
    }

    /// It is still held; whether it was until now.
    pub(super) fn keep_holding(&self, hold: Hold) -> bool {
        let mut held = lock(&self.held);
        let is_held =
            matches!(*held, Some((last, since)) if last == hold && since.elapsed() < HOLD_PATIENCE);
        *held = is_held.then(|| (hold, Instant::now()));
        is_held
    }

    pub(super) fn let_go(&self) {
        *lock(&self.held) = None;
    }

    pub(super) fn is_held(&self, hold: Hold) -> bool {
        matches!(*lock(&self.held), Some((last, since)) if last == hold && since.elapsed() < HOLD_PATIENCE)
    }

    pub(super) fn stops(&self) -> u64 {
        self.stops.load(Ordering::SeqCst)
    }

    pub(super) fn set_paused(&self, paused: bool) {
        self.paused.store(paused, Ordering::SeqCst);
    }

    pub(super) fn is_paused(&self) -> bool {
        self.paused.load(Ordering::SeqCst)
    }

    pub(super) fn set_unattended(&self, unattended: bool) {
        self.unattended.store(unattended, Ordering::SeqCst);
    }

    pub(super) fn is_unattended(&self) -> bool {
        self.unattended.load(Ordering::SeqCst)
    }

    /// Stops the robot and ends its thread.
    pub(super) fn end(&self) {
        self.stop();
        self.ended.store(true, Ordering::SeqCst);
    }

    pub(super) fn has_ended(&self) -> bool {
        self.ended.load(Ordering::SeqCst)
    }
}

/// The robot as it was last heard.
#[derive(Clone, Debug)]
pub(super) struct Live {
    port: String,
    pub(super) robot: Option<RobotHello>,
    pub(super) telemetry: Option<Telemetry>,
    pub(super) battery: Option<BatteryReport>,
    heard: Option<Instant>,
    /// Why there is no link, if there is none.
    pub(super) problem: Option<Value>,
    pub(super) run: RunStatus,
}

/// The drive that is under way, or was last.
#[derive(Clone, Debug, Default)]
pub(super) struct RunStatus {
    /// Counts drives and their ends.
    pub(super) revision: u64,
    pub(super) active: bool,
    /// Start and end of each leg, metres.
    pub(super) legs: Vec<[Point; 2]>,
    pub(super) leg: usize,
    /// Where the plan wants the robot now.
    pub(super) reference: Option<Pose>,
    /// Seconds of the robot's clock since it began.
    pub(super) time: f64,
    /// Where the robot was, ten times a second.
    pub(super) trail: Vec<Point>,
    /// When its last point was, seconds.
    pub(super) time_of_trail: f64,
    /// The document `watch-view`, if a camera watches.
    pub(super) view: Option<Value>,
    /// What has happened under the camera.
    pub(super) told: Vec<EventDocument>,
    /// The document of `wmr drive --json`, once it has ended.
    pub(super) report: Option<Value>,
    /// Why it ended before the goal.
    pub(super) error: Option<Value>,
    /// The lines of `run.jsonl`.
    pub(super) lines: String,
    /// Where a course of a calibration has ended: believed and, if anybody knows, truly.
    pub(super) course: Option<Value>,
    /// The name under which the drive is kept, or why it is not.
    pub(super) kept: Option<Result<String, String>>,
}

impl Live {
    pub(super) fn new(port: &str) -> Self {
        Self {
            port: port.to_owned(),
            robot: None,
            telemetry: None,
            battery: None,
            heard: None,
            problem: None,
            run: RunStatus::default(),
        }
    }

    /// Whether the robot says that a stop is over and that it rests.
    pub(super) fn has_stopped(&self) -> bool {
        self.telemetry.is_some_and(|last| {
            matches!(last.state, State::Stopped | State::Faulted(_))
                && last.wheels == WheelSpeeds::default()
        })
    }

    /// Whether the robot says that it rests and drives no legs.
    pub(super) fn rests(&self) -> bool {
        self.telemetry.is_some_and(|last| {
            last.state != State::Driving && last.wheels == WheelSpeeds::default()
        })
    }

    /// Whether the robot is simulated by this program.
    pub(super) fn is_simulated(&self) -> bool {
        is_simulated(&self.port)
    }

    /// Another robot from now on, of which nothing is known.
    pub(super) fn connect_to(&mut self, port: &str) {
        let run = std::mem::take(&mut self.run);
        *self = Self { run, ..Self::new(port) };
    }

    /// Takes in what the robot said.
    pub(super) fn hear(&mut self, telemetry: Telemetry) {
        self.telemetry = Some(telemetry);
        self.heard = Some(Instant::now());
        self.problem = None;
    }

    /// What the robot said last is as new as it was then.
    pub(super) fn keep_word(&mut self) {
        self.heard = self.heard.map(|_| Instant::now());
    }

    /// The same on a drive, whose last word was at that time, seconds.
    pub(super) fn hear_on_way(&mut self, telemetry: Telemetry, time: Option<f64>) {
        self.hear(telemetry);
        if let Some(time) = time {
            self.run.follow(time, from_wire(telemetry.pose).position);
        }
    }

    /// The link is gone, and why.
    pub(super) fn lose(&mut self, problem: Value) {
        self.robot = None;
        self.problem = Some(problem);
    }

    /// The robot as the badge shows it.
    pub(super) fn base_document(&self) -> Value {
        let name = self.robot.as_ref().map(|robot| {
            let [major, minor, patch] = robot.firmware;
            format!("{:?}, firmware {major}.{minor}.{patch}", robot.board)
        });
        let telemetry = self.telemetry.as_ref();
        json!({
            "port": self.port,
            "name": name,
            "connected": self.robot.is_some(),
            "problem": self.problem,
            "age": self.heard.map(|heard| heard.elapsed().as_secs_f64()),
            "state": telemetry.map(|telemetry| state_name(telemetry.state)),
            "detail": telemetry.and_then(|telemetry| detail(telemetry.state)),
            "pose": telemetry.map(|telemetry| from_wire(telemetry.pose)),
            "wheels": telemetry.map(|telemetry| [telemetry.wheels.left, telemetry.wheels.right]),
            "battery": self.battery.map(|battery| json!({
                "volts": battery.volts,
                "level": format!("{:?}", battery.level).to_lowercase(),
            })),
        })
    }

    /// The drive as it changes; legs, trail and report are in [`run_document`](Self::run_document).
    pub(super) fn drive_document(&self, paused: bool) -> Value {
        let run = &self.run;
        let position = self.telemetry.map(|telemetry| from_wire(telemetry.pose).position);
        let beside = position.zip(run.legs.get(run.leg)).map(|(at, leg)| beside(at, *leg));
        json!({
            "revision": run.revision,
            "active": run.active,
            "pause_wanted": run.active && paused,
            "leg": run.leg,
            "legs": run.legs.len(),
            "time": run.time,
            "cross_track": beside.filter(|_| run.active),
            "reference": run.reference.filter(|_| run.active),
            "view": run.view.as_ref().filter(|_| run.active),
            "told": run.told.iter().rev().take(SHOWN_EVENTS).collect::<Vec<_>>(),
        })
    }

    /// The drive that is under way, or was last, as a whole.
    pub(super) fn run_document(&self) -> Value {
        let run = &self.run;
        json!({
            "revision": run.revision,
            "active": run.active,
            "trail": run.trail,
            "report": run.report,
            "error": run.error,
            "course": run.course,
            "kept": run.kept.as_ref().and_then(|kept| kept.as_ref().ok()),
            "not_kept": run.kept.as_ref().and_then(|kept| kept.as_ref().err()),
        })
    }
}

/// Whether the port of that name is a simulated robot in this program.
pub(super) fn is_simulated(port: &str) -> bool {
    port == "sim" || port.starts_with("elf:")
}

fn detail(state: State) -> Option<&'static str> {
    use protocol::message::PauseReason;
    match state {
        State::Faulted(fault) => Some(fault.explanation()),
        State::Paused(PauseReason::Silence) => Some("nobody was heard for 0.3 s"),
        _ => None,
    }
}

/// How far `at` is left (positive) or right of the straight line of a leg, metres; of a leg of no length,
/// how far away.
fn beside(at: Point, [from, to]: [Point; 2]) -> f64 {
    let length = from.distance(to);
    if length == 0.0 {
        return from.distance(at);
    }
    ((to.x - from.x) * (at.y - from.y) - (to.y - from.y) * (at.x - from.x)) / length
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn left_of_a_leg_is_positive() {
        let leg = [Point::new(0.0, 0.0), Point::new(3.0, 4.0)];
        assert!((beside(Point::new(3.0 - 0.8, 4.0 + 0.6), leg) - 1.0).abs() < 1e-12);
        assert!((beside(Point::new(0.4, -0.3), leg) + 0.5).abs() < 1e-12);
        assert_eq!(beside(Point::new(3.0, 4.0), [leg[0], leg[0]]), 5.0);
    }

    #[test]
    fn a_link_that_is_gone_leaves_the_last_word_and_its_age() {
        let mut live = Live::new("sim");
        assert!(live.base_document()["age"].is_null());
        live.hear(Telemetry {
            ticks: 1,
            pose: protocol::motion::Pose::new(1.0, 2.0, 0.0),
            wheels: Default::default(),
            state: State::Driving,
            leg: 0,
        });
        live.lose(json!({"code": "link.lost"}));
        let document = live.base_document();
        assert_eq!(document["connected"], false);
        assert_eq!(document["problem"]["code"], "link.lost");
        assert!(document["age"].is_number() && document["pose"].is_array());
    }
}
