//! The filter against hand-computed cases, drawn truths and a robot that is lifted.

use super::state::Step;
use super::*;
use crate::legs::DEFAULT_LIMITS;
use nalgebra::Vector6;
use proptest::prelude::*;

const SIGMA: PoseSigma = PoseSigma { position: 0.002, heading: 0.005 };

fn at(milliseconds: u64) -> Duration {
    Duration::from_millis(milliseconds)
}

fn normal(random: &mut fastrand::Rng, sigma: f64) -> f64 {
    sigma * ((0..12).map(|_| random.f64()).sum::<f64>() - 6.0)
}

/// A filter whose robot stands at the origin, placed there.
fn placed() -> PoseFilter {
    let mut filter = PoseFilter::new(&DEFAULT_LIMITS);
    filter.odometry(at(0), Pose::new(0.0, 0.0, 0.0));
    filter.place(Pose::new(0.0, 0.0, 0.0), SIGMA);
    filter
}

#[test]
fn two_equal_witnesses_meet_half_way_and_the_drive_since_is_kept() {
    let mut filter = placed();
    filter.odometry(at(100), Pose::new(0.0, 0.0, 0.0));
    filter.odometry(at(200), Pose::new(0.04, 0.0, 0.0));
    let seen = filter.observe(at(100), Pose::new(0.002, 0.0, 0.0), SIGMA);
    // The difference is one σ, its variance two: 1/2.
    let Ok(Accepted::Fused { squared, distance, .. }) = seen else { panic!("{seen:?}") };
    assert!((squared - 0.5).abs() < 1e-9 && (distance - 0.002).abs() < 1e-12);
    let then = filter.estimate(at(100)).unwrap();
    assert!((then.pose.position.x - 0.001).abs() < 1e-12);
    assert!((then.position_sigma() - 0.002 / 2f64.sqrt()).abs() < 1e-9);
    let now = filter.estimate(at(200)).unwrap();
    assert!((now.pose.position.x - 0.041).abs() < 1e-12, "{now:?}");
    assert!(now.position_sigma() > then.position_sigma());
}

#[test]
fn a_turn_seen_too_short_widens_the_track_and_a_path_seen_longer_the_wheels() {
    let mut filter = placed();
    // Odometry: 1 m straight on, while the camera sees 1.01 m.
    for step in 1..=200 {
        filter.odometry(at(20 * step), Pose::new(0.005 * step as f64, 0.0, 0.0));
    }
    filter.observe(at(4000), Pose::new(1.01, 0.0, 0.0), SIGMA).unwrap();
    let scale = filter.calibration().unwrap().scale;
    assert!((scale.value - 1.0095).abs() < 0.001 && scale.sigma < 0.005, "{scale:?}");
    // A turn by 2 rad as odometry has it, of which the camera sees 1.98.
    for step in 1..=50 {
        filter.odometry(at(4000 + 20 * step), Pose::new(1.0, 0.0, 0.04 * step as f64));
    }
    filter.observe(at(5000), Pose::new(1.01, 0.0, 1.98), SIGMA).unwrap();
    let Calibration { scale, track, ratio } = filter.calibration().unwrap();
    let turned = scale.value / track.value * 2.0;
    assert!((turned - 1.98).abs() < 0.01 && track.value > 1.01, "{scale:?} {track:?}");
    assert!((ratio.value - 1.0).abs() < 0.002, "{ratio:?}");
}

#[test]
fn one_reflection_is_an_outlier_and_a_lifted_robot_is_found_again() {
    let mut filter = placed();
    let far = Pose::new(0.5, 0.3, 1.0);
    let mut outcome = Vec::new();
    for frame in 1..=6 {
        filter.odometry(at(100 * frame), Pose::new(0.0, 0.0, 0.0));
        outcome.push(filter.observe(at(100 * frame), far, SIGMA));
    }
    let Err(Rejected::Outlier { squared, distance, frames: 1, .. }) = outcome[0] else {
        panic!("{outcome:?}")
    };
    assert!(squared > 1e4 && (distance - 0.34f64.sqrt()).abs() < 1e-9);
    assert!(outcome[..4].iter().all(Result::is_err), "{outcome:?}");
    assert!(matches!(outcome[4], Ok(Accepted::Kidnapped { frames: 5, .. })), "{outcome:?}");
    assert!(matches!(outcome[5], Ok(Accepted::Fused { .. })), "{outcome:?}");
}

#[test]
fn outliers_that_disagree_are_never_believed() {
    let mut filter = placed();
    for frame in 1..=40 {
        filter.odometry(at(100 * frame), Pose::new(0.0, 0.0, 0.0));
        let side = if frame % 2 == 0 { 0.5 } else { -0.5 };
        let seen = filter.observe(at(100 * frame), Pose::new(side, 0.0, 0.0), SIGMA);
        assert!(matches!(seen, Err(Rejected::Outlier { frames: 1, .. })), "{seen:?}");
    }
    let growth = filter.growth(at(4000));
    assert_eq!(growth.because, Some(Caution::Dark(at(4000))));
}

#[test]
fn doubt_stops_the_robot_before_it_is_settled() {
    let mut filter = placed();
    for frame in 1..=2 {
        filter.odometry(at(100 * frame), Pose::new(0.0, 0.0, 0.0));
        let _ = filter.observe(at(100 * frame), Pose::new(0.5, 0.0, 0.0), SIGMA);
    }
    let growth = filter.growth(at(200));
    assert_eq!(growth.verdict, Verdict::Stop);
    assert_eq!(growth.because, Some(Caution::Disputed { distance: 0.5, frames: 2 }));
}

#[test]
fn the_verdict_of_a_robot_that_drives_on_in_the_dark() {
    let mut filter = placed();
    let mut x = 0.0;
    let mut verdicts = Vec::new();
    for tick in 1..=500 {
        x += 0.2 * 0.02;
        filter.odometry(at(20 * tick), Pose::new(x, 0.0, 0.0));
        if [50, 150, 500].contains(&tick) {
            let growth = filter.growth(at(20 * tick));
            verdicts.push((growth.verdict, growth.margin));
        }
    }
    let (names, margins): (Vec<_>, Vec<_>) = verdicts.into_iter().unzip();
    assert_eq!(names, [Verdict::OnPath, Verdict::Slow, Verdict::Stop]);
    assert!(margins.is_sorted() && margins[2] > 2.0 * margins[0], "{margins:?}");
}

#[test]
fn frames_that_come_too_late_or_too_early_say_so() {
    let mut filter = PoseFilter::new(&DEFAULT_LIMITS);
    let origin = Pose::new(0.0, 0.0, 0.0);
    assert_eq!(filter.observe(at(0), origin, SIGMA), Err(Rejected::NoTelemetry));
    assert!(filter.estimate(at(0)).is_none() && filter.calibration().is_none());
    assert_eq!(filter.growth(at(0)).verdict, Verdict::Stop);
    for tick in 0..=150 {
        filter.odometry(at(20 * tick), origin);
    }
    let seen = |filter: &mut PoseFilter, time| filter.observe(at(time), origin, SIGMA);
    assert_eq!(seen(&mut filter, 900), Err(Rejected::TooOld { by: at(100) }));
    assert_eq!(seen(&mut filter, 3040), Err(Rejected::AheadOfTelemetry { by: at(40) }));
    let no_number = Pose::new(f64::NAN, 0.0, 0.0);
    assert!(matches!(filter.observe(at(2900), no_number, SIGMA), Err(Rejected::NotSane(_))));
    assert_eq!(seen(&mut filter, 2900), Ok(Accepted::Placed));
    // Frames that have overtaken each other.
    assert_eq!(seen(&mut filter, 2800), Err(Rejected::TooOld { by: at(100) }));
}

/// A robot on a circle that is told of corrections `lag` milliseconds before it takes them: its true
/// pose, and the filter's estimate of it.
fn corrected(lag: u64) -> (Pose, PoseFilter) {
    let mut filter = PoseFilter::new(&DEFAULT_LIMITS);
    let mut truth = Pose::new(1.0, 1.0, 0.0);
    // The robot believes to be elsewhere.
    let mut frame = Pose::new(0.02, -0.015, 0.06);
    let mut sent: Option<(u64, Pose)> = None;
    let mut history = Vec::new();
    for time in (0..6000u64).step_by(20) {
        if let Some((when, change)) = sent
            && time >= when
        {
            frame = change.then(frame);
            sent = None;
        }
        filter.odometry(at(time), frame.then(truth));
        history.push(truth);
        if time % 100 == 0 && time >= 100 {
            let exposed = time - 100;
            let then = history[(exposed / 20) as usize];
            filter.observe(at(exposed), then, SIGMA).unwrap();
            if let Some(correction) = filter.correction(at(exposed)) {
                assert!(correction.distance <= 0.01 + 1e-12 && correction.turn.abs() <= 0.05);
                filter.told(correction.at, correction.pose);
                let change = correction.pose.then(frame.then(then).inverse());
                sent = Some((time + lag, change));
            }
        }
        truth = truth.then(Step { seconds: 0.02, path: 0.004, turn: 0.02 }.as_pose());
    }
    (truth, filter)
}

#[test]
fn the_robots_jumps_are_not_motion_and_it_ends_where_it_is() {
    for lag in [10, 50, 130] {
        let (truth, filter) = corrected(lag);
        let estimate = filter.estimate(at(6000)).unwrap().pose;
        assert!(estimate.position.distance(truth.position) < 1e-3, "{estimate:?} {truth:?}");
        let (time, believed) = filter.driven.as_ref().unwrap().last();
        let there = filter.estimate(time).unwrap().pose;
        assert!(believed.position.distance(there.position) < 0.0015, "{believed:?} {there:?}");
        assert!((believed.heading - there.heading).abs() < 0.005);
    }
}

#[test]
fn a_plan_that_begins_elsewhere_moves_the_robots_frame_only() {
    let mut filter = placed();
    filter.odometry(at(100), Pose::new(0.0, 0.0, 0.0));
    filter.odometry(at(120), Pose::new(1.0, 2.0, 3.0));
    filter.odometry(at(140), Pose::new(1.0, 2.0, 3.0));
    let pose = filter.estimate(at(140)).unwrap().pose;
    assert!(pose.position.distance(crate::geometry::Point::new(0.0, 0.0)) < 1e-9, "{pose:?}");
}

/// The normalised estimation error squared of all six states, over runs whose truth and noise are drawn as
/// the filter believes them to be.
fn nees(seed: u64) -> f64 {
    let mut random = fastrand::Rng::with_seed(seed);
    let b = 0.12;
    let mut state = State::new(Pose::new(0.0, 0.0, 0.0), SIGMA);
    let mut truth = state;
    for index in 0..6 {
        truth.mean[index] += normal(&mut random, state.covariance[(index, index)].sqrt());
    }
    for tick in 0..500 {
        let turning = (tick / 50) % 2 == 0;
        let (path, turn) = if turning { (0.0, 0.03) } else { (0.006, 0.0) };
        let step = Step { seconds: 0.02, path, turn };
        state.predict(step, b);
        truth.predict(step, b);
        // The truth's covariance is that of one step, drawn and forgotten.
        let added = draw(&mut random, truth.covariance);
        truth.mean += added;
        truth.covariance.fill(0.0);
        if tick % 5 == 4 {
            let seen = Pose::new(
                truth.mean[0] + normal(&mut random, SIGMA.position),
                truth.mean[1] + normal(&mut random, SIGMA.position),
                wrap_angle(truth.mean[2] + normal(&mut random, SIGMA.heading)),
            );
            let innovation = state.innovation(seen, SIGMA).unwrap();
            state.correct(&innovation, SIGMA);
        }
    }
    let mut error = truth.mean - state.mean;
    error[2] = wrap_angle(error[2]);
    (error.transpose() * state.covariance.try_inverse().unwrap() * error)[0]
}

fn draw(random: &mut fastrand::Rng, covariance: nalgebra::Matrix6<f64>) -> Vector6<f64> {
    let eigen = covariance.symmetric_eigen();
    let noise = eigen.eigenvalues.map(|value| normal(random, value.max(0.0).sqrt()));
    eigen.eigenvectors * noise
}

#[test]
fn errors_are_as_large_as_the_covariance_says() {
    const RUNS: u64 = 200;
    let mean = (0..RUNS).map(nees).sum::<f64>() / RUNS as f64;
    // χ² of six degrees of freedom: mean 6, the mean of 200 within ± 3 · √(12/200) = 0.73.
    assert!((mean - 6.0).abs() < 0.73, "{mean}");
}

proptest! {
    #[test]
    fn a_covariance_stays_positive_whatever_is_driven_and_seen(
        moves in proptest::collection::vec((-0.008..0.008f64, -0.1..0.1f64, 0u8..5), 1..200),
    ) {
        let mut filter = placed();
        let mut pose = Pose::new(0.0, 0.0, 0.0);
        for (tick, (path, turn, look)) in moves.into_iter().enumerate() {
            pose = pose.then(Step { seconds: 0.02, path, turn }.as_pose());
            let time = at(20 * (tick as u64 + 1));
            filter.odometry(time, pose);
            if look == 0 {
                let _ = filter.observe(time, pose, SIGMA);
            }
            let matrix = filter.state.unwrap().covariance;
            prop_assert!(matrix.symmetric_eigen().eigenvalues.min() > 0.0);
        }
    }
}
