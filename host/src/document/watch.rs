//! Drives that a camera watches: what `wmr drive --watch --json` lists, and what a page draws meanwhile.

use crate::geometry::{Point, Pose};
use crate::watch::{Hazard, Reason, WatchEvent, WatchStatistics, WatchedDrive};
use serde::{Deserialize, Serialize};
use std::time::Duration;

/// What a camera saw of a drive.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct WatchDocument {
    /// What was counted.
    #[serde(flatten)]
    pub counts: WatchStatistics,
    /// What happened, in its order.
    pub events: Vec<EventDocument>,
}

/// One thing that happened.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct EventDocument {
    /// When, seconds since the drive began.
    pub time: f64,
    /// What: `held`, `resumed`, `rerouted`, `not_taken`, `trouble`, `relocated` or `touch_up`.
    pub event: String,
    /// Why the robot is held: `blocked`, `no_way`, `unsure`, `off_path`, `lifted` or `sees_again`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
    /// The same in words.
    pub text: String,
}

impl EventDocument {
    /// The document of `event`, `since_start` after the drive began.
    pub fn new(since_start: Duration, event: &WatchEvent) -> Self {
        let reason = match event {
            WatchEvent::Held(reason) => Some(reason_name(reason).into()),
            _ => None,
        };
        let name = match event {
            WatchEvent::Held(_) => "held",
            WatchEvent::Resumed { .. } => "resumed",
            WatchEvent::Rerouted { .. } => "rerouted",
            WatchEvent::NotTaken(_) => "not_taken",
            WatchEvent::Trouble(_) => "trouble",
            WatchEvent::Relocated => "relocated",
            WatchEvent::TouchUp { .. } => "touch_up",
        };
        let (time, text) = (since_start.as_secs_f64(), event.to_string());
        Self { time, event: name.into(), reason, text }
    }
}

fn reason_name(reason: &Reason) -> &'static str {
    match reason {
        Reason::Blocked { .. } => "blocked",
        Reason::NoWay(_) => "no_way",
        Reason::Unsure(_) => "unsure",
        Reason::OffPath(_) => "off_path",
        Reason::Lifted(_) => "lifted",
        Reason::SeesAgain => "sees_again",
    }
}

/// What is known at a moment of a watched drive.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct ViewDocument {
    /// Where the robot is.
    pub pose: Pose,
    /// The covariance of x, y and heading: m², m rad, rad².
    pub covariance: [[f64; 3]; 3],
    /// Why the robot is held, in words; `null` while it drives.
    pub held: Option<String>,
    /// The way still to drive, from the robot on.
    pub way: Vec<Point>,
    /// What stands on the floor.
    pub things: Vec<ThingDocument>,
}

impl ViewDocument {
    /// What `drive` knows of `time`; `None` until something has said where the robot is.
    pub fn new(drive: &WatchedDrive, time: Duration) -> Option<Self> {
        let estimate = drive.estimate(time)?;
        Some(Self {
            pose: estimate.pose,
            covariance: estimate.covariance,
            held: drive.held().map(Reason::to_string),
            way: std::iter::once(estimate.pose.position).chain(drive.way()).collect(),
            things: drive.hazards().iter().map(ThingDocument::new).collect(),
        })
    }
}

/// Something on the floor.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct ThingDocument {
    /// The corners of a polygon that covers it.
    pub outline: Vec<Point>,
    /// How fast it moves, m/s; 0 for what stands.
    pub velocity: [f64; 2],
    /// Its middle now and each tenth of a second for two seconds as it moves now; empty for what stands.
    pub predicted: Vec<Point>,
}

/// Times of the points of a predicted path, s.
const PREDICTED: u32 = 20;
const STEP: f64 = 0.1;

impl ThingDocument {
    /// The document of a hazard.
    pub fn new(hazard: &Hazard) -> Self {
        let outline = hazard.obstacle.footprint.outline();
        let bounds = hazard.obstacle.footprint.bounds();
        let [vx, vy] = hazard.velocity;
        let (x, y) = ((bounds.x0 + bounds.x1) / 2.0, (bounds.y0 + bounds.y1) / 2.0);
        let steps = if hazard.moves() { PREDICTED + 1 } else { 0 };
        let times = (0..steps).map(|step| STEP * f64::from(step));
        let predicted = times.map(|time| Point::new(x + vx * time, y + vy * time)).collect();
        Self { outline, velocity: hazard.velocity, predicted }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Rect;

    #[test]
    fn an_event_says_what_when_and_why() {
        let held = WatchEvent::Held(Reason::OffPath(0.062));
        let document = EventDocument::new(Duration::from_millis(1500), &held);
        let expected = serde_json::json!({
            "time": 1.5, "event": "held", "reason": "off_path",
            "text": "the robot is 62 mm beside its path; the robot holds"
        });
        assert_eq!(serde_json::to_value(document).unwrap(), expected);
    }

    #[test]
    fn what_moves_has_a_path_and_what_stands_none() {
        let obstacle: crate::scene::Obstacle = Rect::new(0.4, 0.4, 0.6, 0.6).into();
        let thing = |velocity| {
            let obstacle = obstacle.clone();
            ThingDocument::new(&Hazard { obstacle, velocity, may_move: true, is_known: true })
        };
        let moving = thing([0.1, 0.0]).predicted;
        assert_eq!(moving.len(), 21);
        assert!(moving[20].distance(Point::new(0.7, 0.5)) < 1e-9);
        assert!(thing([0.0; 2]).predicted.is_empty());
    }
}
