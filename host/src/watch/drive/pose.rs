//! Where the robot is: telemetry and sights to the filter, corrections to the robot.

use super::{Hold, WatchedDrive};
use crate::legs::{from_wire, to_wire};
use crate::link::LinkClient;
use crate::link::drive::TimedPort;
use crate::track::pose::{Accepted, Rejected};
use crate::watch::event::{Reason, WatchEvent};
use protocol::message::{CameraPose, Command, State, Telemetry};
use protocol::motion::TICK;
use std::time::Duration;

impl WatchedDrive {
    /// Gives the filter what wheels say.
    pub(super) fn hear_telemetry<P: TimedPort>(
        &mut self,
        telemetry: &Telemetry,
        client: &LinkClient<P>,
    ) {
        let Some(time) = client.clock().host_time(telemetry.ticks) else { return };
        // Before the first plan the robot may believe to be anywhere; between two plans it rests, and where it
        // believes to be is about to change.
        let rests = self.ended.is_some() && telemetry.state == State::Idle;
        if !self.mission.has_begun() || (telemetry.state == State::Idle && !rests) {
            return;
        }
        self.filter.odometry(time, from_wire(telemetry.pose));
        self.filter_time = time;
        if !self.is_placed {
            self.filter.place(self.start, self.options.sigma);
            self.legs_since = time;
            self.is_placed = true;
        }
    }

    /// The robot has taken legs that begin where it stands.
    pub(super) fn begin_legs<P: TimedPort>(&mut self, client: &LinkClient<P>) {
        self.leg_began = client.telemetry().map_or(0, |last| last.ticks);
        let now = client.telemetry().and_then(|last| client.clock().host_time(last.ticks));
        self.legs_since = now.unwrap_or(self.legs_since);
        if self.is_placed {
            self.filter.told(self.filter_time, self.start);
        }
    }

    /// Joins the last sight of the robot with odometry, and tells the robot.
    pub(super) fn take_pose<P: TimedPort>(&mut self, client: &mut LinkClient<P>) {
        let Some((exposed, pose)) = self.pending.filter(|_| self.is_placed) else { return };
        match self.filter.observe(exposed, pose, self.options.sigma) {
            Err(Rejected::AheadOfTelemetry { .. } | Rejected::NoTelemetry) => return,
            Ok(Accepted::Kidnapped { distance, .. }) => {
                let reason = Reason::Lifted(distance);
                self.events.push(WatchEvent::Held(reason.clone()));
                let since = self.hold.as_ref().map_or(exposed, |hold| hold.since);
                self.hold = Some(Hold { since, reason, replans: true });
            }
            Ok(_) => self.count_last(exposed),
            Err(Rejected::Outlier { .. }) => self.statistics.refused += 1,
            // A frame from before the filter began, or a pose that is none.
            Err(Rejected::TooOld { .. } | Rejected::NotSane(_)) => {}
        }
        self.pending = None;
        // Of what was before its plan the robot takes nothing.
        if exposed <= self.legs_since {
            return;
        }
        let Some(correction) = self.filter.correction(exposed) else { return };
        let Some(ticks) = ticks_at(client, correction.at) else { return };
        let seen = CameraPose { ticks, pose: to_wire(correction.pose) };
        if client.send(Command::SetPose(seen)) {
            self.filter.told(correction.at, correction.pose);
            self.statistics.corrections += 1;
        }
    }

    /// Counts the sights of a robot that has arrived.
    fn count_last(&mut self, exposed: Duration) {
        if let Some((since, sights)) = &mut self.ended {
            *sights += u32::from(exposed > *since);
        }
    }
}

/// The robot's clock at a time of the host's.
fn ticks_at<P: TimedPort>(client: &LinkClient<P>, time: Duration) -> Option<u32> {
    let last = client.telemetry()?;
    let at = client.clock().host_time(last.ticks)?;
    let ago = (at.as_secs_f64() - time.as_secs_f64()) / f64::from(TICK.0);
    Some(last.ticks.wrapping_sub(ago.round() as i64 as u32))
}
