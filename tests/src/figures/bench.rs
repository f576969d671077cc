//! A controller on a simulated base, without a link: what most figures are measured on.

use firmware::controller::Controller;
use firmware::kinematics::BaseGeometry;
use firmware::signals::{Event, Sensors};
use hil_sim::base::{BaseParameters, TruePose, WheeledBase};
use protocol::message::{MAX_LEGS, Placement, PlanHeader, plan_digest};
use protocol::motion::{Direction, Leg, Pose, Position, Timing};
use protocol::parameters::Parameters;
use protocol::units::Radians;
use std::collections::VecDeque;
use std::f64::consts::TAU;
use std::ops::Range;

/// One control period, s.
pub const TICK: f64 = 0.005;

/// The robot and the floor under it.
#[derive(Clone, Debug)]
pub struct Bench {
    /// What drives.
    pub controller: Controller,
    /// What is driven.
    pub base: WheeledBase,
    /// Control ticks so far.
    pub ticks: u32,
    /// Legs that found no room yet.
    waiting: VecDeque<Leg>,
}

impl Bench {
    /// The default robot with the motors of `seed`, at `start`.
    pub fn new(start: Pose, seed: u64) -> Self {
        Self::with(Parameters::default(), BaseParameters::seeded(seed), start)
    }

    /// A robot that believes `parameters` on a base that really is `base`.
    pub fn with(parameters: Parameters, base: BaseParameters, start: Pose) -> Self {
        let base = WheeledBase::new(base, true_pose(start));
        let mut bench = Self {
            controller: Controller::new(parameters),
            base,
            ticks: 0,
            waiting: VecDeque::new(),
        };
        // The encoders need not start at 0.
        bench.tick();
        bench
    }

    /// Commits `legs` from `start`: as many as there is room for now, the others as room comes.
    ///
    /// # Panics
    /// If the controller refuses them.
    pub fn commit(&mut self, legs: &[Leg], start: Pose) {
        let (first, rest) = legs.split_at(legs.len().min(MAX_LEGS));
        commit(&mut self.controller, first, Placement::Start(start));
        self.waiting = rest.iter().copied().collect();
    }

    /// One control period.
    pub fn tick(&mut self) -> Option<Event> {
        let sensors = Sensors { counts: self.base.counts(), ..Sensors::default() };
        let outcome = self.controller.tick(&sensors);
        self.base.step(outcome.duty.map(f64::from), TICK);
        self.ticks += 1;
        if let (Some(Event::LegDone(_)), Some(leg)) = (outcome.event, self.waiting.pop_front()) {
            commit(&mut self.controller, &[leg], Placement::Append);
        }
        outcome.event
    }

    /// Lets `act` see every tick until the robot rests.
    ///
    /// # Panics
    /// If it has not after ten minutes.
    pub fn run(&mut self, mut act: impl FnMut(&mut Self)) -> Vec<Event> {
        let mut events = Vec::new();
        let last = self.ticks + 120_000;
        while !self.controller.is_at_rest() {
            assert!(self.ticks < last, "still driving: {:?}", self.controller.state());
            events.extend(self.tick());
            act(self);
        }
        events
    }

    /// The rims' commanded speeds, left and right, m/s.
    pub fn rim_speeds(&self) -> [f64; 2] {
        rim_speeds(&self.controller)
    }
}

/// The rims' commanded speeds, left and right, m/s.
pub fn rim_speeds(controller: &Controller) -> [f64; 2] {
    let [left, right] = BaseGeometry::from(controller.parameters()).radii();
    let wheels = controller.commanded_speeds();
    [f64::from(wheels.left.0 * left.0), f64::from(wheels.right.0 * right.0)]
}

/// Commits `legs` as one batch.
///
/// # Panics
/// If the controller refuses them.
pub fn commit(controller: &mut Controller, legs: &[Leg], placement: Placement) {
    let (plan, first, count) = (legs[0].plan, legs[0].index, legs.len() as u16);
    let digest = plan_digest(legs);
    controller.announce(PlanHeader { plan, first, count, digest, placement });
    legs.iter().for_each(|leg| controller.collect(*leg));
    controller.commit(plan, MAX_LEGS).unwrap_or_else(|refusal| panic!("refused: {refusal:?}"));
}

/// The forward legs through `points` from `start`, without wanted headings.
pub fn legs_through(start: Pose, points: &[(f64, f64)], timing: Timing) -> Vec<Leg> {
    let mut from = start;
    let legs = points.iter().enumerate().map(|(index, (x, y))| {
        let goal = Position::new(*x as f32, *y as f32);
        let leg = Leg {
            plan: 1,
            index: index as u16,
            start: from,
            goal,
            goal_heading: None,
            direction: Direction::Forward,
            timing,
        };
        let bearing = (goal.y.0 - from.y.0).atan2(goal.x.0 - from.x.0);
        from = Pose { x: goal.x, y: goal.y, heading: Radians(bearing) };
        leg
    });
    legs.collect()
}

/// `count` legs in any direction, of any length within `lengths`, in metres; every other one in reverse, every
/// fourth with a heading at its end.
pub fn random_legs(
    start: Pose,
    count: usize,
    lengths: Range<f64>,
    random: &mut fastrand::Rng,
) -> Vec<Leg> {
    let (mut x, mut y) = (0.0, 0.0);
    let points: Vec<_> = (0..count)
        .map(|_| {
            let bearing = random.f64() * TAU;
            let length = lengths.start + random.f64() * (lengths.end - lengths.start);
            (x, y) = (x + length * bearing.cos(), y + length * bearing.sin());
            (x, y)
        })
        .collect();
    let mut legs = legs_through(start, &points, Timing::Limits);
    for leg in &mut legs {
        if random.u8(..4) == 0 {
            leg.goal_heading = Some(Radians(random.f32() * 6.0 - 3.0));
        }
        if random.bool() {
            leg.direction = Direction::Reverse;
        }
    }
    legs
}

/// The same pose in the simulator's numbers.
pub fn true_pose(pose: Pose) -> TruePose {
    TruePose { x: pose.x.0.into(), y: pose.y.0.into(), heading: pose.heading.0.into() }
}

/// The same pose in the robot's numbers.
pub fn robot_pose(pose: TruePose) -> Pose {
    Pose::new(pose.x as f32, pose.y as f32, pose.heading as f32)
}

/// The distance of `pose` from the straight line through (`x0`, `y0`) and (`x1`, `y1`), m.
pub fn off_line(pose: TruePose, (x0, y0): (f64, f64), (x1, y1): (f64, f64)) -> f64 {
    let length = (x1 - x0).hypot(y1 - y0);
    (((pose.x - x0) * (y1 - y0) - (pose.y - y0) * (x1 - x0)) / length).abs()
}

/// The angle from `b` to `a` in (-π, π], rad.
pub fn angle_between(a: f64, b: f64) -> f64 {
    (a - b).sin().atan2((a - b).cos())
}
