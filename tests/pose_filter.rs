//! The pose filter beside a robot that drives on a base with other lengths than it believes in: the firmware
//! in the loop, the truth from the simulated base's own kinematics.
#![allow(clippy::unwrap_used, reason = "helpers of tests fail as tests do")]

use hil_sim::base::{BaseParameters, TruePose, WheeledBase};
use hil_sim::in_process::InProcess;
use hil_sim::simulation::Simulation;
use protocol::message::{CameraPose, Command};
use protocol::motion::{Pose, Timing};
use std::collections::VecDeque;
use std::time::Duration;
use wmr::geometry::{self, Point, wrap_angle};
use wmr::legs::{DEFAULT_LIMITS, LegOptions, from_wire, to_legs};
use wmr::link::LinkClient;
use wmr::link::mission::{Mission, MissionEvent};
use wmr::track::pose::{PoseFilter, PoseSigma};
use wmr_tests::POLL;

const LATE: Duration = Duration::from_millis(100);
const SIGMA: PoseSigma = PoseSigma { position: 0.002, heading: 0.3 / 180.0 * std::f64::consts::PI };

/// Scale, ratio and track of the true base over the believed one.
const WRONG: [f64; 3] = [1.01, 1.0, 1.02];

struct Watched {
    client: LinkClient<Simulation<InProcess>>,
    filter: Option<PoseFilter>,
    frames: VecDeque<(Duration, TruePose)>,
    random: fastrand::Rng,
    /// Up to which tick telemetry has been taken in.
    ticks: Option<u32>,
}

struct End {
    /// How far the robot ended from the goal, m, and from the planned heading, rad.
    error: (f64, f64),
    /// How far the estimate was from the truth: m, rad.
    estimated: (f64, f64),
    filter: Option<PoseFilter>,
}

fn twenty_legs(random: &mut fastrand::Rng) -> Vec<Point> {
    let mut way = vec![Point::new(1.0, 1.0)];
    while way.len() < 21 {
        let next = Point::new(0.2 + 1.6 * random.f64(), 0.2 + 1.6 * random.f64());
        if next.distance(way[way.len() - 1]) > 0.4 {
            way.push(next);
        }
    }
    way
}

/// Twenty legs, with or without the camera.
fn drive(seed: u64, watched: bool) -> End {
    let mut random = fastrand::Rng::with_seed(seed);
    let way = twenty_legs(&mut random);
    let start = TruePose { x: 1.0, y: 1.0, heading: 0.0 };
    let base = WheeledBase::new(BaseParameters::seeded(seed).with_wrong_lengths(WRONG), start);
    let simulation = Simulation::new(InProcess::default(), base, None);
    let options = LegOptions { timing: Timing::Limits, reverse: false };
    let legs = to_legs(&way, 0.0, None, &options, &DEFAULT_LIMITS);
    let mut mission = Mission::new(legs, Pose::new(1.0, 1.0, 0.0));
    let mut run = Watched {
        client: LinkClient::new(simulation, seed as u32 + 1),
        filter: watched.then(|| PoseFilter::new(&DEFAULT_LIMITS)),
        frames: VecDeque::new(),
        random,
        ticks: None,
    };
    loop {
        let now = run.client.port_mut().now();
        let events = mission.step(&mut run.client, now).unwrap();
        if events.iter().any(|event| matches!(event, MissionEvent::Done(_))) {
            return run.end(&way, now);
        }
        run.step(now);
        run.client.port_mut().wait(POLL).unwrap();
    }
}

impl Watched {
    fn step(&mut self, now: Duration) {
        if now.as_millis().is_multiple_of(100) {
            self.frames.push_back((now, self.client.port_mut().truth().pose));
        }
        let Some(filter) = &mut self.filter else { return };
        if let Some(telemetry) =
            self.client.telemetry().filter(|last| Some(last.ticks) != self.ticks)
        {
            self.ticks = Some(telemetry.ticks);
            // The simulation ticks every 5 ms from the start, so its clock is the robot's.
            let time = Duration::from_millis(u64::from(telemetry.ticks) * 5);
            filter.odometry(time, from_wire(telemetry.pose));
        }
        let Some((exposed, truth)) = self.frames.pop_front_if(|(at, _)| now >= *at + LATE) else {
            return;
        };
        let mut noise =
            |sigma: f64| sigma * ((0..12).map(|_| self.random.f64()).sum::<f64>() - 6.0);
        let seen = geometry::Pose::new(
            truth.x + noise(SIGMA.position),
            truth.y + noise(SIGMA.position),
            wrap_angle(truth.heading + noise(SIGMA.heading)),
        );
        let _ = filter.observe(exposed, seen, SIGMA);
        if let Some(correction) = filter.correction(exposed) {
            let [x, y, heading]: [f64; 3] = correction.pose.into();
            let ticks = (correction.at.as_millis() / 5) as u32;
            let pose = Pose::new(x as f32, y as f32, heading as f32);
            if self.client.send(Command::SetPose(CameraPose { ticks, pose })) {
                filter.told(correction.at, correction.pose);
            }
        }
    }

    fn end(mut self, way: &[Point], now: Duration) -> End {
        let truth = self.client.port_mut().truth().pose;
        let (before, goal) = (way[way.len() - 2], way[way.len() - 1]);
        let heading = (goal.y - before.y).atan2(goal.x - before.x);
        let apart = |x: f64, y: f64, heading: f64| {
            ((truth.x - x).hypot(truth.y - y), wrap_angle(truth.heading - heading).abs())
        };
        let estimate = self.filter.as_ref().and_then(|filter| filter.estimate(now));
        let estimated = estimate.map_or((f64::NAN, f64::NAN), |estimate| {
            apart(estimate.pose.position.x, estimate.pose.position.y, estimate.pose.heading)
        });
        End { error: apart(goal.x, goal.y, heading), estimated, filter: self.filter }
    }
}

#[test]
fn twenty_legs_on_a_wrong_base_end_at_the_goal() {
    let runs: Vec<(End, End)> =
        (0..6).map(|seed| (drive(seed, true), drive(seed, false))).collect();
    for (with, without) in &runs {
        println!(
            "camera {:.1} mm {:.2}°, its estimate {:.1} mm {:.2}°; odometry alone {:.0} mm {:.1}°",
            1000.0 * with.error.0,
            with.error.1.to_degrees(),
            1000.0 * with.estimated.0,
            with.estimated.1.to_degrees(),
            1000.0 * without.error.0,
            without.error.1.to_degrees(),
        );
        println!("{:?}", with.filter.as_ref().and_then(PoseFilter::calibration));
    }
    for (with, without) in &runs {
        assert!(with.error.0 <= 0.005 && with.error.1 <= 1f64.to_radians(), "{:?}", with.error);
        assert!(with.estimated.0 <= 0.003, "{:?}", with.estimated);
        assert!(without.error.0 > 5.0 * with.error.0, "{:?}", without.error);
        let base = with.filter.as_ref().and_then(PoseFilter::calibration).unwrap();
        for (measured, truth) in [(base.scale, 1.01), (base.ratio, 1.0), (base.track, 1.02)] {
            assert!(measured.sigma < 0.004, "{base:?}");
            assert!((measured.value - truth).abs() <= 4.0 * measured.sigma, "{base:?}");
        }
    }
}
