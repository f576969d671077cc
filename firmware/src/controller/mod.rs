//! The control tick: from encoder counts to motor duty.
//!
//! ```text
//! counts ─► odometry ─► leg runner ─► tracker ─► speed limiter ─► wheel loops ─► duty
//!    ▲          ▲           ▲ pace                    │ share          │ faults
//! sensors    camera         └─────────────────────────┘                ▼
//!    └─► battery, progress, lateness ─────────────────────────────►  state
//! ```
//! What the robot may do is a [`State`]. Every way to stop ends in one that says why:
//!
//! | what | how it stops | state |
//! |---|---|---|
//! | pause, silence of the host | on the path, within the limits | `Paused`, until resumed |
//! | stop | on the path, within the limits | `Stopped`, until cleared |
//! | empty battery | on the path, within the limits | `Faulted`, until recovered and cleared |
//! | emergency stop, stall, encoder, no progress, late tick | drive cut in the same tick | `Faulted`, until cleared |

mod driving;

use crate::battery::Battery;
use crate::leg_queue::LegQueue;
use crate::leg_runner::LegRunner;
use crate::odometry::{Odometry, Rims};
use crate::pace::Pace;
use crate::pose_gate::PoseGate;
use crate::pose_history::PoseHistory;
use crate::progress::Progress;
use crate::signals::{Outcome, Sensors};
use crate::wheel_pair::WheelPair;
use driving::PROBE_TICKS;
use protocol::message::{
    BatteryLevel, BatteryReport, Driven, Fault, Measurement, PauseReason, Placement, PlanHeader,
    PlanRefusal, PoseRefusal, State, Wheel,
};
use protocol::motion::{Leg, Pose, WheelSpeeds};
use protocol::parameters::ParameterRefusal;
use protocol::parameters::Parameters;

/// Control periods that may be missed on end; in 20 ms a robot at 0.4 m/s goes 8 mm unwatched.
const LATEST_TICKS: u8 = 3;

#[derive(Clone, Copy, Debug)]
enum Activity {
    Resting,
    Leg(LegRunner),
    /// Turns one wheel without a loop, for so many more ticks, from where the encoders stood at `from`.
    Probing {
        wheel: Wheel,
        from: [i32; 2],
        ticks: u16,
    },
    /// Holds `goal`, then rests; `ended` is the plan that it completes, if none broke it off.
    Settling {
        goal: Pose,
        ended: Option<u32>,
        ticks: u32,
    },
}

/// Odometry, legs, wheels and state of one robot.
#[derive(Clone, Debug)]
pub struct Controller {
    parameters: Parameters,
    rims: Rims,
    queue: LegQueue,
    state: State,
    activity: Activity,
    pace: Pace,
    odometry: Odometry,
    history: PoseHistory,
    gate: PoseGate,
    /// What the encoders' inputs count, and what that means for the left and the right wheel.
    inputs: [i32; 2],
    counts: [i32; 2],
    wheels: WheelPair,
    /// In how many ticks each input was found to have lost a count.
    skipped: [u16; 2],
    battery: Battery,
    progress: Progress,
    /// The wheel that the last fault was about.
    faulty: Option<Wheel>,
    leg: u16,
    placed: bool,
}

impl Controller {
    /// A robot at rest at the origin, with the encoders at 0.
    pub fn new(parameters: Parameters) -> Self {
        let counts = [0, 0];
        Self {
            parameters,
            rims: Rims::from(&parameters),
            queue: LegQueue::default(),
            state: State::Idle,
            activity: Activity::Resting,
            pace: Pace::FULL,
            odometry: Odometry::new(Pose::default(), counts),
            history: PoseHistory::default(),
            gate: PoseGate::UNKNOWN,
            inputs: counts,
            counts,
            wheels: WheelPair::new(&parameters, counts),
            skipped: [0; 2],
            battery: Battery::default(),
            faulty: None,
            progress: Progress::new(Pose::default()),
            leg: 0,
            placed: false,
        }
    }

    /// Whether the robot was told where it stands, so that its pose is one in the arena.
    pub fn is_placed(&self) -> bool {
        self.placed
    }

    /// What the battery means now, if it is not good.
    pub fn battery(&self) -> Option<BatteryReport> {
        self.battery.report()
    }

    /// What the battery means now.
    pub fn battery_level(&self) -> BatteryLevel {
        self.battery.level()
    }

    /// What is measured, besides the pose and the wheels' speeds.
    pub fn measurement(&self) -> Measurement {
        let (counts, skipped) = (self.counts, self.skipped);
        Measurement { counts, skipped, battery: self.battery.volts() }
    }

    /// The wheel that the fault is about, if it is about one.
    pub fn faulty_wheel(&self) -> Option<Wheel> {
        self.faulty
    }

    /// Turns one wheel forward by a quarter turn at most, to see how it is wired; false if the robot is
    /// not idle at rest.
    pub fn turn_wheel(&mut self, wheel: Wheel) -> bool {
        let idle = self.state == State::Idle && self.is_at_rest();
        if idle {
            self.activity = Activity::Probing { wheel, from: self.counts, ticks: PROBE_TICKS };
        }
        idle
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

    /// Where the robot should be now, while it drives.
    pub fn reference(&self) -> Option<Pose> {
        match &self.activity {
            Activity::Resting | Activity::Probing { .. } => None,
            Activity::Leg(runner) => Some(runner.reference()),
            Activity::Settling { goal, .. } => Some(*goal),
        }
    }

    /// How fast the wheels turn, measured.
    pub fn wheel_speeds(&self) -> WheelSpeeds {
        self.wheels.speeds()
    }

    /// How fast the wheels are commanded to turn, feedback included.
    pub fn commanded_speeds(&self) -> WheelSpeeds {
        self.wheels.commanded()
    }

    /// The numbers of this robot.
    pub fn parameters(&self) -> &Parameters {
        &self.parameters
    }

    /// Takes other numbers, at rest.
    ///
    /// # Errors
    /// [`ParameterRefusal`]; then nothing has changed.
    pub fn set_parameters(&mut self, parameters: Parameters) -> Result<(), ParameterRefusal> {
        if !self.is_at_rest() {
            return Err(ParameterRefusal::NotAtRest);
        }
        parameters.check()?;
        self.parameters = parameters;
        self.rims = Rims::from(&parameters);
        // Other wiring makes other counts of the same inputs; the robot has not moved.
        self.counts = parameters.wiring.wheels(self.inputs);
        self.odometry.recount(self.counts);
        self.wheels = WheelPair::new(&parameters, self.counts);
        // Its legs were found drivable within the old limits.
        self.queue.forget_batch();
        Ok(())
    }

    /// Whether nothing moves and nothing is to move.
    pub fn is_at_rest(&self) -> bool {
        matches!(self.activity, Activity::Resting)
    }

    /// The plan and how far it has been driven; `None` after a start or stop.
    pub fn driven(&self) -> Option<Driven> {
        self.queue.driven()
    }

    /// Announces a batch of legs; what was collected of an earlier one is forgotten.
    pub fn announce(&mut self, header: PlanHeader) {
        self.queue.begin(header);
    }

    /// Forgets the legs of `plan` that have not begun.
    pub fn cancel(&mut self, plan: u32) {
        self.queue.cancel(plan);
    }

    /// Collects a leg of the batch that was announced.
    pub fn collect(&mut self, leg: Leg) {
        self.queue.collect(leg, &self.parameters.limits());
    }

    /// Takes the collected batch of legs over; a robot that has nothing else to drive begins it.
    ///
    /// `room` is how many legs the robot may have, the one under way included. Returns the index after
    /// the plan's last leg.
    ///
    /// # Errors
    /// [`PlanRefusal`]; then nothing has changed.
    pub fn commit(&mut self, plan: u32, room: usize) -> Result<u16, PlanRefusal> {
        if matches!(self.state, State::Stopped | State::Faulted(_)) {
            return Err(PlanRefusal::NotCleared);
        }
        let starts = self.queue.announced().is_some_and(|placement| placement.is_start());
        if starts && !(self.state == State::Idle && self.is_at_rest()) {
            return Err(PlanRefusal::NotAtRest);
        }
        let under_way = matches!(self.activity, Activity::Leg(_));
        let room = room.saturating_sub(usize::from(under_way));
        let header = self.queue.commit(plan, room)?;
        if let Placement::Start(pose) = header.placement {
            self.odometry = Odometry::new(pose, self.counts);
            self.history.clear();
            self.gate = PoseGate::known(0);
            self.placed = true;
        }
        if self.is_at_rest() {
            self.progress = Progress::new(self.odometry.pose());
            self.wheels.rest(self.counts);
            self.state = State::Driving;
            self.pace = Pace::FULL;
        }
        if !under_way && let Some(leg) = self.queue.next_leg() {
            self.begin(leg);
        }
        Ok(header.first.wrapping_add(header.count))
    }

    /// Corrects the pose by where a camera saw the robot `age` ticks ago; the estimate may jump, the
    /// wheels follow within their limits.
    ///
    /// # Errors
    /// [`PoseRefusal`]; then the estimate has not changed. A robot that drives is cut with [`Fault::Displaced`]
    /// where the camera has contradicted it several times on end.
    pub fn set_pose(&mut self, seen: Pose, age: u32) -> Result<(), PoseRefusal> {
        if !seen.is_sane() {
            return Err(PoseRefusal::NotSane);
        }
        let driven = self.history.at(age).ok_or(PoseRefusal::TooOld)?;
        let estimate = self.odometry.estimate(driven);
        if !self.gate.admits(seen, estimate, age, &self.parameters.limits()) {
            if self.gate.refuse() && self.state == State::Driving {
                self.cut(Fault::Displaced);
            }
            return Err(PoseRefusal::Implausible);
        }
        self.gate = PoseGate::known(age);
        self.placed = true;
        self.odometry.correct(seen, driven);
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

    /// Cuts the drive from this moment on, because of `fault`.
    pub fn cut(&mut self, fault: Fault) {
        self.cut_for(fault, None);
    }

    fn cut_for(&mut self, fault: Fault, wheel: Option<Wheel>) {
        self.state = State::Faulted(fault);
        self.faulty = wheel;
        self.rest();
    }

    /// Ends the effect of a stop or fault, once at rest; an empty battery goes on to count.
    pub fn clear(&mut self) {
        if self.is_at_rest() && self.battery.level() < BatteryLevel::Empty {
            self.state = State::Idle;
        }
    }

    /// One tick of 5 ms: takes in what is measured, gives the motors' duty and what came to an end.
    pub fn tick(&mut self, sensors: &Sensors) -> Outcome {
        self.inputs = sensors.counts;
        for (skipped, lost) in self.skipped.iter_mut().zip(sensors.skipped) {
            *skipped = skipped.wrapping_add(lost.into());
        }
        self.counts = self.parameters.wiring.wheels(sensors.counts);
        self.odometry.update(self.counts, &self.rims);
        self.history.push(self.odometry.driven());
        self.gate.pass(1 + u16::from(sensors.missed_ticks));
        let battery = self.update_battery(sensors.battery);
        if sensors.missed_ticks > LATEST_TICKS && !self.is_at_rest() {
            self.cut(Fault::TickOverrun);
        }
        let event = self.advance();
        let duty = self.parameters.wiring.outputs(self.drive());
        Outcome { duty, event, battery }
    }

    fn update_battery(&mut self, volts: Option<f32>) -> Option<BatteryReport> {
        let report = self.battery.update(volts?, &self.parameters.battery);
        if self.battery.level() == BatteryLevel::Empty && !self.is_halted() {
            self.state = State::Faulted(Fault::Battery);
            self.faulty = None;
        }
        report
    }

    /// Whether the plan is broken off: the robot comes to rest on its path and forgets it.
    fn is_halted(&self) -> bool {
        matches!(self.state, State::Stopped | State::Faulted(_))
    }
}
