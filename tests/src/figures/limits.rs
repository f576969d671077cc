//! Random legs with disturbed feedback: the commanded rims never pass V and A.
//!
//! The base here is a follower that lags behind its command and is kicked now and then, so that the
//! tracker has much to correct; it is cheap enough for a million legs.

use super::bench::{TICK, commit, random_legs, rim_speeds};
use super::{Figure, Size};
use firmware::controller::Controller;
use firmware::signals::Sensors;
use protocol::message::{Placement, State};
use protocol::motion::Pose;
use protocol::parameters::Parameters;
use protocol::units::Metres;
use std::f64::consts::TAU;

/// Legs of a plan.
const LEGS: usize = 10;

/// The largest commanded speed and acceleration of a rim, as shares of V and A.
pub fn measure(size: Size) -> Vec<Figure> {
    let plans = size.pick(60, 100_000);
    let mut worst = [0.0f64; 2];
    for plan in 0..plans as u64 {
        let [speed, acceleration] = drive(plan);
        worst = [worst[0].max(speed), worst[1].max(acceleration)];
    }
    let what = format!("{} random disturbed legs: largest commanded rim", plans * LEGS);
    vec![
        Figure::bounded(format!("{what} speed / V"), worst[0], 1.01, ""),
        Figure::bounded(format!("{what} acceleration / A"), worst[1], 1.01, ""),
    ]
}

fn drive(seed: u64) -> [f64; 2] {
    let mut random = fastrand::Rng::with_seed(seed);
    let parameters = Parameters {
        track: Metres(0.08 + 0.1 * random.f32()),
        wheel_ratio: 0.98 + 0.04 * random.f32(),
        ..Parameters::default()
    };
    let mut controller = Controller::new(parameters);
    let start = Pose::new(0.0, 0.0, random.f32() * 6.0 - 3.0);
    commit(
        &mut controller,
        &random_legs(start, LEGS, 0.05..1.05, &mut random),
        Placement::Start(start),
    );
    let mut follower = Follower::default();
    let mut last = [0.0; 2];
    let mut worst = [0.0f64; 2];
    while !controller.is_at_rest() {
        let sensors = Sensors { counts: follower.counts(), ..Sensors::default() };
        controller.tick(&sensors);
        let rims = rim_speeds(&controller);
        // A fault cuts the drive: no limit holds then, and none is meant to.
        if !matches!(controller.state(), State::Faulted(_)) {
            for (rim, last) in rims.into_iter().zip(last) {
                worst[0] = worst[0].max(rim.abs() / 0.4);
                worst[1] = worst[1].max((rim - last).abs() / TICK / 0.8);
            }
        }
        last = rims;
        let wheels = controller.commanded_speeds();
        follower.step([wheels.left.0.into(), wheels.right.0.into()], &mut random);
        disturb(&mut controller, &mut random);
    }
    worst
}

/// Now and then a camera's pose that differs, a pause, or its end.
fn disturb(controller: &mut Controller, random: &mut fastrand::Rng) {
    match random.u16(..2000) {
        0..=2 => {
            let mut near = |value: f32, by: f32| value + by * (random.f32() - 0.5);
            let pose = controller.pose();
            let seen =
                Pose::new(near(pose.x.0, 0.05), near(pose.y.0, 0.05), near(pose.heading.0, 0.2));
            let _ = controller.set_pose(seen, 20);
        }
        3 => controller.pause(protocol::message::PauseReason::Command),
        _ if random.u8(..100) == 0 => controller.resume(),
        _ => {}
    }
}

/// Wheels that follow their command with a lag and are kicked.
#[derive(Default)]
struct Follower {
    speeds: [f64; 2],
    angles: [f64; 2],
}

impl Follower {
    fn step(&mut self, commanded: [f64; 2], random: &mut fastrand::Rng) {
        for ((speed, angle), commanded) in
            self.speeds.iter_mut().zip(&mut self.angles).zip(commanded)
        {
            *speed += (commanded - *speed) * 0.2;
            // One tick in 500, up to 30 counts to either side: 4 mm of rim.
            let kick = if random.u16(..500) == 0 { 0.26 * (random.f64() - 0.5) } else { 0.0 };
            *angle += *speed * TICK + kick;
        }
    }

    fn counts(&self) -> [i32; 2] {
        self.angles.map(|angle| (angle / TAU * 1440.0).floor() as i32)
    }
}
