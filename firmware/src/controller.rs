//! The control tick: from encoder counts to motor duty.
//!
//! ```text
//! counts ─► odometry ─► leg runner ─► tracker ─► kinematics ─► limits ─► wheel loops ─► duty
//! ```
//! What the robot may do is a [`State`]; a pause, a stop and the host's silence slow the leg's own
//! time down, so that the robot comes to rest *on its path* within the limits: while σ is the pace,
//! v the planned rim speed and a its planned acceleration, dσ/dt = (±A - σ² a)/v.

use crate::kinematics::BaseGeometry;
use crate::leg_queue::LegQueue;
use crate::leg_runner::LegRunner;
use crate::odometry::Odometry;
use crate::parameters::Parameters;
use crate::tracker;
use crate::wheel_loop::WheelLoop;
use protocol::message::{Fault, LegResult, PauseReason, Placement, PlanRefusal, State};
use protocol::motion::{Leg, PHASES_PER_TICK, Pose, TICK, Twist, WheelSpeeds};
use protocol::units::{MetresPerSecond, RadiansPerSecond};

/// A wheel that lags as far as it may for this long is blocked, ticks: with the lag's own 0.4 rad
/// that is noticed within 300 ms at any but a creeping speed.
const BLOCKED_TICKS: u32 = 20;

/// After the last leg the robot holds its goal for this long, ticks, so that the wheels come to rest
/// where they should.
const SETTLE_TICKS: u32 = 60;

/// Below this planned rim speed the pace may change as it likes: nothing moves, m/s.
const CREEP: f32 = 0.005;

/// What a tick brought to an end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Event {
    /// A leg.
    LegDone(LegResult),
    /// The whole plan; the robot rests.
    PlanDone {
        /// The plan driven.
        plan: u32,
        /// Where the robot believes it stands.
        pose: Pose,
    },
}

#[derive(Clone, Copy, Debug)]
enum Activity {
    Resting,
    Leg(LegRunner),
    Settling { goal: Pose, plan: u32, ticks: u32 },
}

/// Odometry, legs, wheels and state of one robot.
#[derive(Clone, Debug)]
pub struct Controller {
    parameters: Parameters,
    queue: LegQueue,
    state: State,
    activity: Activity,
    pace: f32,
    odometry: Odometry,
    counts: [i32; 2],
    wheels: [WheelLoop; 2],
    commanded: WheelSpeeds,
    leg: u16,
}

impl Controller {
    /// A robot at rest at the origin, with the encoders at 0.
    pub fn new(parameters: Parameters) -> Self {
        let counts = [0, 0];
        Self {
            parameters,
            queue: LegQueue::default(),
            state: State::Idle,
            activity: Activity::Resting,
            pace: 0.0,
            odometry: Odometry::new(Pose::default(), counts),
            counts,
            wheels: counts.map(WheelLoop::new),
            commanded: WheelSpeeds::default(),
            leg: 0,
        }
    }

    /// What the robot does.
    pub fn state(&self) -> State {
        self.state
    }

    /// Where the robot believes it stands.
    pub fn pose(&self) -> Pose {
        self.odometry.pose()
    }

    /// The leg that it drives, or drove last.
    pub fn leg(&self) -> u16 {
        self.leg
    }

    /// How fast the wheels turn, measured.
    pub fn wheel_speeds(&self) -> WheelSpeeds {
        let [left, right] =
            self.wheels.map(|wheel| wheel.speed(self.parameters.radians_per_count()));
        WheelSpeeds { left: RadiansPerSecond(left), right: RadiansPerSecond(right) }
    }

    /// The numbers of this robot.
    pub fn parameters(&self) -> &Parameters {
        &self.parameters
    }

    /// Whether nothing moves and nothing is to move.
    pub fn is_at_rest(&self) -> bool {
        matches!(self.activity, Activity::Resting)
    }

    /// The plan that is being received.
    pub fn queue(&mut self) -> &mut LegQueue {
        &mut self.queue
    }

    /// Takes the collected batch of legs over; a robot that has nothing else to drive begins it.
    ///
    /// `room` is how many legs the robot may have, the one under way included.
    ///
    /// # Errors
    /// [`PlanRefusal`]; then nothing has changed.
    pub fn commit(&mut self, plan: u32, room: usize) -> Result<(), PlanRefusal> {
        if matches!(self.state, State::Stopped | State::Faulted(_)) {
            return Err(PlanRefusal::NotCleared);
        }
        let starts = self.queue.announced().is_some_and(|placement| placement.is_start());
        if starts && !(self.state == State::Idle && self.is_at_rest()) {
            return Err(PlanRefusal::NotAtRest);
        }
        let under_way = matches!(self.activity, Activity::Leg(_));
        let room = room.saturating_sub(usize::from(under_way));
        let header = self.queue.commit(plan, &self.parameters.limits(), room)?;
        if let Placement::Start(pose) = header.placement {
            self.odometry = Odometry::new(pose, self.counts);
        }
        if self.is_at_rest() {
            self.wheels = self.counts.map(WheelLoop::new);
            self.state = State::Driving;
            self.pace = 1.0;
        }
        if !under_way && let Some(leg) = self.queue.next_leg() {
            self.begin(leg);
        }
        Ok(())
    }

    /// Stops on the path and waits.
    pub fn pause(&mut self, reason: PauseReason) {
        if self.state == State::Driving {
            self.state = State::Paused(reason);
        }
    }

    /// Goes on after a pause.
    pub fn resume(&mut self) {
        if matches!(self.state, State::Paused(_)) {
            self.state = State::Driving;
        }
    }

    /// Stops on the path and forgets the plan.
    pub fn stop(&mut self) {
        if !matches!(self.state, State::Faulted(_)) {
            self.state = State::Stopped;
        }
        if self.is_at_rest() {
            self.queue.clear();
        }
    }

    /// Ends the effect of a stop or fault, once at rest.
    pub fn clear(&mut self) {
        if self.is_at_rest() {
            self.state = State::Idle;
        }
    }

    /// One tick of 5 ms: takes in the encoders' counts (left, right); gives the motors' duty
    /// (left, right) in -1..=1, and what came to an end.
    pub fn tick(&mut self, counts: [i32; 2]) -> ([f32; 2], Option<Event>) {
        self.counts = counts;
        self.odometry.update(counts, &self.parameters);
        let event = self.advance();
        let wanted = self.wanted_twist();
        if self.is_at_rest() {
            self.commanded = WheelSpeeds::default();
            self.wheels = counts.map(WheelLoop::new);
            return ([0.0, 0.0], event);
        }
        self.commanded = self.limited(wanted);
        let duty = self.drive_wheels(counts);
        if self.wheels.iter().any(|wheel| wheel.blocked_ticks() >= BLOCKED_TICKS) {
            self.state = State::Faulted(Fault::Stall);
            self.rest();
            return ([0.0, 0.0], event);
        }
        (duty, event)
    }

    fn advance(&mut self) -> Option<Event> {
        let pose = self.odometry.pose();
        match &mut self.activity {
            Activity::Resting => None,
            Activity::Leg(_) => self.advance_leg(pose),
            Activity::Settling { ticks, .. } if *ticks > 0 => {
                *ticks -= 1;
                None
            }
            Activity::Settling { plan, .. } => {
                let plan = *plan;
                self.activity = Activity::Resting;
                if self.state == State::Stopped {
                    self.queue.clear();
                } else {
                    self.state = State::Idle;
                }
                Some(Event::PlanDone { plan, pose })
            }
        }
    }

    fn advance_leg(&mut self, pose: Pose) -> Option<Event> {
        let limits = self.parameters.limits();
        let Activity::Leg(mut runner) = self.activity else { return None };
        self.update_pace(&runner);
        let phases = (self.pace * PHASES_PER_TICK as f32) as u32;
        if phases == 0 && self.state == State::Stopped {
            self.rest();
            return None;
        }
        if phases == 0 {
            return None;
        }
        let runs = runner.advance(phases, pose, &limits);
        self.activity = Activity::Leg(runner);
        if runs {
            return None;
        }
        match self.queue.next_leg() {
            Some(leg) if self.state != State::Stopped => self.begin(leg),
            _ => {
                let (goal, plan) = (runner.reference(), runner.leg().plan);
                self.activity = Activity::Settling { goal, plan, ticks: SETTLE_TICKS };
            }
        }
        Some(Event::LegDone(runner.result(pose)))
    }

    fn begin(&mut self, leg: Leg) {
        self.leg = leg.index;
        let runner = LegRunner::new(leg, self.odometry.pose(), &self.parameters.limits());
        self.activity = Activity::Leg(runner);
    }

    fn rest(&mut self) {
        self.queue.clear();
        self.activity = Activity::Resting;
    }

    fn update_pace(&mut self, runner: &LegRunner) {
        let target = if self.state == State::Driving { 1.0 } else { 0.0 };
        if self.pace == target {
            return;
        }
        let (speed, acceleration) = runner.rim_motion(&self.parameters.limits());
        if speed < CREEP {
            self.pace = target;
            return;
        }
        let limit = self.parameters.acceleration.0.copysign(target - self.pace);
        let step = (limit - self.pace * self.pace * acceleration) / speed * TICK.0;
        self.pace = if target > self.pace {
            (self.pace + step.max(0.0)).min(target)
        } else {
            (self.pace + step.min(0.0)).max(target)
        };
    }

    fn wanted_twist(&self) -> Twist {
        let pose = self.odometry.pose();
        let gains = &self.parameters.tracker;
        match &self.activity {
            Activity::Resting => Twist::default(),
            Activity::Settling { goal, .. } => {
                tracker::correct(Twist::default(), *goal, pose, gains)
            }
            Activity::Leg(runner) => {
                let Twist { linear, angular } = runner.twist();
                let planned = Twist {
                    linear: MetresPerSecond(linear.0 * self.pace),
                    angular: RadiansPerSecond(angular.0 * self.pace),
                };
                tracker::correct(planned, runner.reference(), pose, gains)
            }
        }
    }

    /// Wheel speeds for `wanted` within the limits: both slowed alike where one would be too fast,
    /// so that the curve stays; then each no further from the last tick's than A allows.
    fn limited(&self, wanted: Twist) -> WheelSpeeds {
        let BaseGeometry { wheel_radius, .. } = self.parameters.geometry;
        let fastest = self.parameters.speed.0 / wheel_radius.0;
        let change = self.parameters.acceleration.0 / wheel_radius.0 * TICK.0;
        let WheelSpeeds { left, right } = self.parameters.geometry.wheel_speeds(wanted);
        let scale = (fastest / left.0.abs().max(right.0.abs()).max(fastest)).min(1.0);
        let step = |wanted: f32, last: f32| last + (wanted * scale - last).clamp(-change, change);
        WheelSpeeds {
            left: RadiansPerSecond(step(left.0, self.commanded.left.0)),
            right: RadiansPerSecond(step(right.0, self.commanded.right.0)),
        }
    }

    fn drive_wheels(&mut self, [left, right]: [i32; 2]) -> [f32; 2] {
        let scale = self.parameters.radians_per_count();
        let gains = &self.parameters.wheel_loop;
        let [left_wheel, right_wheel] = &mut self.wheels;
        [
            left_wheel.tick(self.commanded.left.0, left, scale, gains),
            right_wheel.tick(self.commanded.right.0, right, scale, gains),
        ]
    }
}
