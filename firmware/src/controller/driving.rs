//! What the controller does in a tick: it goes on with its leg, its probe or its settling, and brings the
//! wheels to what is wanted of them.

use super::{Activity, Controller};
use crate::leg_runner::LegRunner;
use crate::signals::Event;
use crate::tracker;
use protocol::message::{BatteryLevel, Fault, State, Wheel};
use protocol::motion::{Leg, Pose, Twist};

/// After the last leg the robot holds its goal for this long, ticks, so that the wheels come to rest
/// where they should.
const SETTLE_TICKS: u32 = 60;

/// The pace at which a weak battery drives: the motors then need well under its voltage.
const DERATED_PACE: f32 = 0.6;

/// A wheel is turned with this duty to see how it is wired: enough for any motor that can drive a robot,
/// too little to throw one off its block.
const PROBE_DUTY: f32 = 0.35;
/// And for at most so long, 1 s, of which in the end it coasts for 0.2 s so that the counts are final.
pub(super) const PROBE_TICKS: u16 = 240;
const PROBE_REST_TICKS: u16 = 40;

impl Controller {
    pub(super) fn advance(&mut self) -> Option<Event> {
        let pose = self.odometry.pose();
        match &mut self.activity {
            Activity::Resting => None,
            Activity::Leg(_) => self.advance_leg(pose),
            Activity::Probing { .. } => self.advance_probe(),
            Activity::Settling { ticks, .. } if *ticks > 0 => {
                *ticks -= 1;
                None
            }
            // The wheels are being brought to rest within the limits.
            Activity::Settling { .. } if !self.wheels.are_to_stand() => None,
            Activity::Settling { ended, .. } => {
                let ended = *ended;
                if self.is_halted() {
                    self.rest();
                } else {
                    // What was driven is kept: a later batch may go on behind it.
                    self.state = State::Idle;
                    self.activity = Activity::Resting;
                }
                ended.map(|plan| Event::PlanDone { plan, pose })
            }
        }
    }

    /// Ends after a quarter turn of any wheel either way, in time, and when the robot may not move on.
    fn advance_probe(&mut self) -> Option<Event> {
        let Activity::Probing { from, ticks, .. } = &mut self.activity else { return None };
        *ticks = ticks.saturating_sub(1);
        let [now, before] = [self.counts, *from];
        let turned = [now[0].wrapping_sub(before[0]), now[1].wrapping_sub(before[1])];
        let quarter = u32::from(self.parameters.counts_per_turn / 4);
        let far = turned.iter().any(|counts| counts.unsigned_abs() >= quarter);
        if *ticks > PROBE_REST_TICKS && (far || self.state != State::Idle) {
            *ticks = PROBE_REST_TICKS;
        }
        if *ticks > 0 {
            return None;
        }
        self.rest();
        Some(Event::WheelTurned(turned))
    }

    fn advance_leg(&mut self, pose: Pose) -> Option<Event> {
        let limits = self.parameters.limits();
        let Activity::Leg(mut runner) = self.activity else { return None };
        let target = self.target_pace();
        if self.pace.value() != target {
            let planned = runner.rim_motion(&limits);
            self.pace = self.pace.towards(target, planned, limits.acceleration.0);
        }
        let phases = self.pace.phases(self.wheels.share());
        if phases == 0 {
            if self.is_halted() {
                self.settle(runner.reference(), None);
            }
            return None;
        }
        let runs = runner.advance(phases, pose, &limits);
        self.activity = Activity::Leg(runner);
        if runs {
            return None;
        }
        self.queue.finish_leg(runner.leg().index);
        match self.queue.next_leg() {
            Some(leg) if !self.is_halted() => self.begin(leg),
            left => {
                let ended = left.is_none().then_some(runner.leg().plan);
                self.settle(runner.reference(), ended);
            }
        }
        Some(Event::LegDone(runner.result(pose)))
    }

    fn target_pace(&self) -> f32 {
        match (self.state, self.battery.level()) {
            (State::Driving, BatteryLevel::Good | BatteryLevel::Low) => 1.0,
            (State::Driving, BatteryLevel::Weak | BatteryLevel::Empty) => DERATED_PACE,
            _ => 0.0,
        }
    }

    pub(super) fn begin(&mut self, leg: Leg) {
        self.leg = leg.index;
        let runner = LegRunner::new(leg, self.odometry.pose(), &self.parameters.limits());
        self.activity = Activity::Leg(runner);
    }

    fn settle(&mut self, goal: Pose, ended: Option<u32>) {
        self.activity = Activity::Settling { goal, ended, ticks: SETTLE_TICKS };
    }

    pub(super) fn rest(&mut self) {
        self.queue.clear();
        self.activity = Activity::Resting;
        self.wheels.rest(self.counts);
    }

    fn wanted_twist(&self) -> Twist {
        let pose = self.odometry.pose();
        let gains = &self.parameters.tracker;
        match &self.activity {
            Activity::Resting | Activity::Probing { .. } | Activity::Settling { ticks: 0, .. } => {
                Twist::default()
            }
            Activity::Settling { goal, .. } => {
                tracker::correct(Twist::default(), *goal, pose, gains)
            }
            // Held on its path the robot stands: what a camera corrects meanwhile is made up for when it goes on.
            Activity::Leg(_) if self.pace.value() == 0.0 && self.target_pace() == 0.0 => {
                Twist::default()
            }
            Activity::Leg(runner) => {
                let planned = self.pace.scale(runner.twist());
                tracker::correct(planned, runner.reference(), pose, gains)
            }
        }
    }

    /// Brings the wheels to what is wanted of them, and watches that they go there.
    pub(super) fn drive(&mut self) -> [f32; 2] {
        if self.is_at_rest() {
            self.wheels.rest(self.counts);
            return [0.0, 0.0];
        }
        if let Activity::Probing { wheel, ticks, .. } = self.activity {
            self.wheels.rest(self.counts);
            let duty = if ticks > PROBE_REST_TICKS { PROBE_DUTY } else { 0.0 };
            return match wheel {
                Wheel::Left => [duty, 0.0],
                Wheel::Right => [0.0, duty],
            };
        }
        let duty = self.wheels.tick(self.wanted_twist(), self.counts);
        let (commanded, pose) = (self.wheels.commanded_twist(), self.odometry.pose());
        let gets_on = self.progress.update(commanded, pose, self.parameters.track);
        if let Some((fault, wheel)) = self.wheels.fault() {
            self.cut_for(fault, Some(wheel));
        } else if !gets_on {
            self.cut(Fault::NoProgress);
        } else {
            return duty;
        }
        [0.0, 0.0]
    }
}
