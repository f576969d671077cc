//! Tracks of drawn walkers and of boxes that come, go and stand.

use super::*;
use crate::geometry::{Point, Rect};
use crate::shape::Circle;
use std::f64::consts::TAU;

fn at(frame: u64) -> Duration {
    Duration::from_millis(100 * frame)
}

fn normal(random: &mut fastrand::Rng, sigma: f64) -> f64 {
    sigma * ((0..12).map(|_| random.f64()).sum::<f64>() - 6.0)
}

fn disc(centre: Point) -> Obstacle {
    Circle { centre, radius: 0.05 }.into()
}

/// A walker with a goal of its own from which it strays for a second or so at a time, now and then far. Ten
/// positions a second.
fn walk(random: &mut fastrand::Rng, frames: usize) -> Vec<Point> {
    let (heading, speed) = (TAU * random.f64(), 0.08 + 0.14 * random.f64());
    let (sin, cos) = heading.sin_cos();
    let mut position = Point::new(0.0, 0.0);
    let mut strays = [0.0; 2];
    let steps = (0..frames).map(|_| {
        let scale = if random.f64() < 0.05 { 0.05 } else { 0.012 };
        for stray in &mut strays {
            *stray += normal(random, scale) - 0.07 * *stray;
        }
        position.x += 0.1 * (speed * cos + strays[0]);
        position.y += 0.1 * (speed * sin + strays[1]);
        position
    });
    steps.collect()
}

#[test]
fn predicted_sets_hold_walkers_and_are_not_much_larger_than_they_must_be() {
    const AHEAD: usize = 20;
    let mut random = fastrand::Rng::with_seed(7);
    let (mut held, mut errors, mut areas) = (0, Vec::new(), 0.0);
    for _ in 0..200 {
        let truth = walk(&mut random, 120);
        let mut tracker = Tracker::default();
        for (frame, &there) in truth.iter().enumerate() {
            let seen = Point::new(
                there.x + normal(&mut random, 0.005),
                there.y + normal(&mut random, 0.005),
            );
            tracker.update(at(frame as u64), &[disc(seen)]);
            assert_eq!(tracker.tracks().len(), 1);
            let Some(later) = truth.get(frame + AHEAD).filter(|_| frame >= 8) else { continue };
            let set = tracker.tracks()[0].predicted(at(AHEAD as u64));
            let error = super::outline::centre(&set.footprint).distance(*later);
            held += u32::from(error <= set.reach);
            areas += set.reach * set.reach;
            errors.push(error);
        }
    }
    errors.sort_by(f64::total_cmp);
    let (count, p99) = (errors.len() as f64, errors[errors.len() * 99 / 100]);
    let (held, area) = (f64::from(held) / count, areas / count / (p99 * p99));
    assert!(held >= 0.99, "{held}, area {area}");
    assert!(area <= 1.5, "{area}, held {held}");
}

#[test]
fn a_box_that_stands_keeps_still_and_its_set_is_narrow() {
    let mut random = fastrand::Rng::with_seed(5);
    let mut tracker = Tracker::default();
    let mut last = None;
    let mut changes = 0;
    for frame in 0..200 {
        let mut edge = |at: f64| at + normal(&mut random, 0.005);
        let seen = Rect::new(edge(1.0), edge(0.5), edge(1.3), edge(0.7));
        tracker.update(at(frame), &[seen.into()]);
        let track = &tracker.tracks()[0];
        if frame > 5 {
            assert!(track.stands() && track.velocity() == [0.0; 2], "frame {frame}");
            let set = track.predicted(at(20));
            assert!(set.reach <= 0.02, "{}", set.reach);
            changes += u32::from(last.replace(set.footprint.clone()) != Some(set.footprint));
        }
    }
    assert!(changes <= 4, "{changes} outlines in 200 frames");
    let bounds = tracker.tracks()[0].footprint().bounds();
    assert!((bounds.x0 - 1.0).abs() < 0.015 && (bounds.y1 - 0.7).abs() < 0.015, "{bounds:?}");
}

/// A box as a camera sees it that leans: its left and its upper edge are inferred anew in each frame, up
/// to 30 mm off, and from the fortieth on to the other side.
fn leaning(x: f64, frame: u64) -> Obstacle {
    let off = [0.0, 0.03, 0.01, 0.025, -0.005][(frame % 5) as usize]
        * if frame < 40 { 1.0 } else { -1.0 };
    let margin = [0.035, 0.004, 0.004, 0.03];
    Obstacle { margin, ..Rect::new(x + off, 0.5, x + 0.3, 0.7 - off).into() }
}

#[test]
fn a_box_whose_far_edges_jump_stands_and_one_that_is_pushed_moves() {
    let mut tracker = Tracker::default();
    for frame in 0..80 {
        tracker.update(at(frame), &[leaning(1.0, frame)]);
        let [track] = tracker.tracks() else { panic!("{} tracks", tracker.tracks().len()) };
        assert!(frame < 5 || track.stands(), "frame {frame}");
    }
    // Pushed at 0.1 m/s: told within half a second.
    for frame in 80..85 {
        tracker.update(at(frame), &[leaning(1.0 + 0.01 * (frame - 79) as f64, frame)]);
    }
    assert!(tracker.tracks()[0].has_moved());
}

#[test]
fn an_obstacle_exists_at_once_and_is_gone_after_two_frames() {
    let mut tracker = Tracker::default();
    let there = disc(Point::new(1.0, 1.0));
    let first = tracker.update(at(0), std::slice::from_ref(&there));
    assert_eq!(first.born, [TrackId(1)]);
    tracker.update(at(1), std::slice::from_ref(&there));
    assert_eq!(tracker.update(at(2), &[]), FrameChanges::default());
    assert_eq!(tracker.tracks().len(), 1, "one frame may miss it");
    assert_eq!(tracker.update(at(3), &[]).lost, [TrackId(1)]);
    assert!(tracker.tracks().is_empty());
    assert_eq!(tracker.update(at(4), &[there]).born, [TrackId(2)], "names are never used again");
}

#[test]
fn walkers_that_cross_keep_their_names() {
    let mut tracker = Tracker::default();
    for frame in 0..40 {
        let along = 0.02 * frame as f64;
        // They pass 40 mm beside each other, at 0.2 m/s, one from the left and one from the right.
        let shapes = [disc(Point::new(along, 0.0)), disc(Point::new(0.8 - along, 0.04))];
        let shapes = if frame % 2 == 0 {
            shapes
        } else {
            let [a, b] = shapes;
            [b, a]
        };
        tracker.update(at(frame), &shapes);
    }
    let names: Vec<(u32, bool)> =
        tracker.tracks().iter().map(|track| (track.id().0, track.velocity()[0] > 0.0)).collect();
    assert_eq!(names, [(1, true), (2, false)]);
}

#[test]
fn a_new_obstacle_may_be_anywhere_soon_and_a_late_frame_changes_nothing() {
    let mut tracker = Tracker::default();
    tracker.update(at(10), &[disc(Point::new(1.0, 1.0))]);
    let first = tracker.tracks()[0].predicted(at(10)).reach;
    assert!(first > 0.5, "{first}");
    let before = tracker.tracks().to_vec();
    assert_eq!(tracker.update(at(9), &[]), FrameChanges::default());
    assert_eq!(tracker.tracks(), before);
}

#[test]
fn sets_grow_where_they_have_missed() {
    let mut tracker = Tracker::default();
    for frame in 0..100 {
        // A zigzag with a turn by 120° every second: no velocity lasts.
        let leg = frame / 10;
        let rest = 0.02 * (frame % 10) as f64;
        let up = if leg % 2 == 0 { rest } else { 0.2 - rest };
        tracker.update(at(frame), &[disc(Point::new(0.1 * leg as f64 + rest / 2.0, up))]);
    }
    assert!(tracker.widening > 1.5, "{}", tracker.widening);
}

/// The axes of the arena are nothing to a thing that moves: turned by a quarter, all is turned by a quarter.
#[test]
fn tracks_turn_and_move_with_what_is_seen() {
    let mut random = fastrand::Rng::with_seed(11);
    for _ in 0..20 {
        let [dx, dy] = [0; 2].map(|_| 4.0 * random.f64());
        let turned = |at: Point| Point::new(dx - at.y, dy + at.x);
        let (mut plain, mut other) = (Tracker::default(), Tracker::default());
        for (frame, &there) in walk(&mut random, 60).iter().enumerate() {
            plain.update(at(frame as u64), &[disc(there)]);
            other.update(at(frame as u64), &[disc(turned(there))]);
        }
        let sets = [&plain, &other].map(|tracker| tracker.tracks()[0].predicted(at(10)));
        let [here, there] = [&sets[0], &sets[1]].map(|set| outline::centre(&set.footprint));
        assert!(turned(here).distance(there) < 1e-9, "{here:?} {there:?}");
        assert!((sets[0].reach - sets[1].reach).abs() < 1e-9);
        let [vx, vy] = plain.tracks()[0].velocity();
        let [ux, uy] = other.tracks()[0].velocity();
        assert!((ux + vy).abs() < 1e-9 && (uy - vx).abs() < 1e-9);
    }
}

/// Lost frames make sets wider and forget nothing.
#[test]
fn a_lost_frame_costs_sureness_alone() {
    let mut tracker = Tracker::default();
    for frame in (0..40).filter(|frame| frame % 7 != 3) {
        tracker.update(at(frame), &[disc(Point::new(0.016 * frame as f64, 0.3))]);
    }
    let before = tracker.tracks()[0].predicted(at(10));
    tracker.update(at(40), &[]);
    let after = tracker.tracks()[0].predicted(at(9));
    assert_eq!((tracker.tracks()[0].id(), tracker.tracks()[0].misses()), (TrackId(1), 1));
    let [here, there] = [&before, &after].map(|set| outline::centre(&set.footprint));
    assert!(here.distance(there) < 1e-9, "{here:?} {there:?}");
    assert!(after.reach >= before.reach - 1e-9);
}
