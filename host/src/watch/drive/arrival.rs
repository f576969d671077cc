//! The end of a drive, and its new beginning: the last look at where the robot stands, and other legs from rest.

use super::{Course, WatchError, WatchedDrive};
use crate::geometry::{Pose, wrap_angle};
use crate::legs::to_wire;
use crate::link::LinkClient;
use crate::link::drive::{Driver, TimedPort};
use crate::link::mission::Mission;
use crate::track::pose::Verdict;
use crate::watch::event::WatchEvent;
use crate::watch::route::Route;
use std::time::Duration;

/// At the end so many frames are waited for, or so long.
const LAST_SIGHTS: u32 = 4;
const LAST_WAIT: Duration = Duration::from_millis(1500);
/// A robot that ends further from its goal, m and rad, drives there, so often at most.
const TOUCH_UP: (f64, f64) = (0.004, 0.01);
const MOST_TOUCH_UPS: u32 = 3;

impl WatchedDrive {
    /// Gives the robot, which rests, other legs that begin where it stands.
    pub(super) fn restart<P: TimedPort>(
        &mut self,
        client: &mut LinkClient<P>,
        pose: Pose,
        (route, slow): (Route, bool),
    ) {
        if self.ended.take().is_none() {
            client.stop();
        }
        let (legs, length) = (route.legs.len(), route.length);
        self.start = pose;
        self.mission = Mission::new(route.legs, to_wire(pose));
        self.driver = Driver::default();
        (self.hold, self.next_course) = (None, None);
        let obstacles = self.floor.standing();
        self.course = Course { obstacles, margin: route.margin, slow };
        self.statistics.replans += 1;
        self.events.push(WatchEvent::Rerouted { legs, length, at_rest: true, slow });
    }

    /// Where the robot has ended, once the camera has said so too; a robot that missed its goal drives on.
    pub(super) fn finish<P: TimedPort>(
        &mut self,
        client: &mut LinkClient<P>,
        now: Duration,
    ) -> Result<Option<Pose>, WatchError> {
        let Some((since, sights)) = self.ended else { return Ok(None) };
        let last = client.telemetry().map_or(self.start, |last| crate::legs::from_wire(last.pose));
        let waits = sights < LAST_SIGHTS && now < since + LAST_WAIT;
        if waits && self.ending.is_none() {
            return Ok(None);
        }
        let Some(pose) = self.estimate(now).map(|estimate| estimate.pose) else {
            return Ok(Some(last));
        };
        let goal = self.options.router.goal;
        let distance = pose.position.distance(goal.position);
        let turn = goal.heading.map_or(0.0, |heading| wrap_angle(heading - pose.heading));
        let missed = distance > TOUCH_UP.0 || turn.abs() > TOUCH_UP.1;
        let knows = sights > 0 && self.filter.growth(now).verdict == Verdict::OnPath;
        if missed
            && knows
            && !self.is_paused
            && self.touch_ups < MOST_TOUCH_UPS
            && let Ok(route) = self.route(pose, (0.0, false))
            && !route.legs.is_empty()
            && now < since + self.options.patience
        {
            // It rests, and may wait for what passes.
            if !self.is_open(now, &route) {
                return Ok(None);
            }
            self.touch_ups += 1;
            self.events.push(WatchEvent::TouchUp { distance, turn });
            self.restart(client, pose, (route, false));
            return Ok(None);
        }
        Ok(Some(pose))
    }
}
