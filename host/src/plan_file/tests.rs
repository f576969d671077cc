//! Plans that are written, read back, changed by hand, and driven by other robots.

use super::*;
use crate::plan::{PlanOptions, plan};
use crate::scene::Goal;
use proptest::prelude::*;
use protocol::motion;
use protocol::units::{Metres, Radians};

const LIMITED: LegOptions = LegOptions { timing: Timing::Limits, reverse: true };

/// A way around one box, begun at `heading`, with the arena's corner at `origin` in the frame of a map.
fn planned(heading: f64, origin: Option<Point>, options: &LegOptions) -> PlanFile {
    let (start, goal) = (Pose::new(0.3, 0.4, heading), Point::new(1.7, 0.45));
    let mut scene = Scene::new(2.0, 1.0);
    scene.obstacles.push(crate::geometry::Rect::new(0.9, 0.2, 1.1, 1.0).into());
    scene.origin = origin;
    scene.start = Some(start);
    scene.goal = Some(Goal { position: goal, heading: Some(1.0) });
    let plan = plan(&scene, start.position, goal, &PlanOptions::default()).unwrap();
    let made_for = MadeFor::new(options, &DEFAULT_LIMITS);
    PlanFile::new(&plan, &scene, made_for, PlanTiming::default())
}

fn legs_anew(file: &PlanFile, options: &LegOptions, limits: &Limits) -> Vec<Leg> {
    to_legs(&file.waypoints, file.start_heading(), file.goal_heading(), options, limits)
}

proptest! {
    /// What is driven is what the file holds, to the last bit and under the same name, in a map's frame too.
    #[test]
    fn legs_come_back_from_a_file_as_they_were_made(
        heading in -3.1..3.1,
        origin in prop::option::of((-30.0..30.0, -30.0..30.0)),
        paper in prop::option::of(1u32..2000),
    ) {
        let options = LegOptions {
            timing: paper.map_or(Timing::Limits, |ticks| Timing::Paper { interval_ticks: ticks }),
            reverse: paper.is_none(),
        };
        let file = planned(heading, origin.map(|(x, y)| Point::new(x, y)), &options);
        let legs = legs_anew(&file, &options, &DEFAULT_LIMITS);
        let read = PlanFile::from_json(&serde_json::to_string(&file).unwrap()).unwrap();
        prop_assert_eq!(read.planned_legs(), Some(legs.clone()));
        prop_assert_eq!(read.made_for.unwrap().options(), options);
        prop_assert_eq!(read.made_for.unwrap().limits(), DEFAULT_LIMITS);
        let sum: f64 = read.legs.iter().filter_map(|leg| leg.duration).sum();
        prop_assert!((sum - read.duration).abs() < 1e-9);
        prop_assert_eq!(read.duration, duration(&legs, &DEFAULT_LIMITS));
    }
}

#[test]
fn another_robot_gets_legs_of_its_own() {
    let file = planned(3.0, None, &LIMITED);
    // It spins slowly, and so rather drives backwards.
    let wide = Limits { track: Metres(1.2), ..DEFAULT_LIMITS };
    let legs = file.legs_for(&LIMITED, &wide);
    assert_eq!(legs, legs_anew(&file, &LIMITED, &wide));
    assert!(duration(&legs, &wide) > file.duration);
    let forward = LegOptions { reverse: false, ..LIMITED };
    let legs = file.legs_for(&forward, &DEFAULT_LIMITS);
    assert!(legs.iter().all(|leg| leg.direction == motion::Direction::Forward));
    assert_ne!(Some(legs), file.planned_legs());
}

#[test]
fn the_legs_of_a_file_are_driven_as_they_stand_in_it() {
    let mut file = planned(0.0, None, &LIMITED);
    let last = file.legs.len() - 1;
    file.legs[last].goal.2 = Some(-2.0);
    file.check().unwrap();
    let legs = file.legs_for(&LIMITED, &DEFAULT_LIMITS);
    assert_eq!(legs[last].goal_heading, Some(Radians(-2.0)));
}

#[test]
fn legs_that_do_not_follow_each_other_are_refused() {
    let whole = planned(0.0, None, &LIMITED);
    let turned = |change: fn(&mut PlanFile)| {
        let mut file = whole.clone();
        change(&mut file);
        matches!(file.check(), Err(PlanFileError::Torn { .. }))
    };
    assert!(whole.legs.len() > 1 && whole.check().is_ok());
    assert!(turned(|file| file.legs[1].start.heading += 0.1));
    assert!(
        turned(|file| file.legs[1].direction = match file.legs[1].direction {
            PlannedDirection::Forward => PlannedDirection::Reverse,
            PlannedDirection::Reverse => PlannedDirection::Forward,
        }) == (whole.legs.len() > 2)
    );
    assert!(turned(|file| file.legs[0].goal.2 = Some(f64::NAN)));
    assert!(turned(|file| file.legs[0].duration = Some(-1.0)));
    assert!(turned(|file| file.made_for.as_mut().unwrap().track = 0.0));
}
