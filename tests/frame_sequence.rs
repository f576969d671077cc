//! Pictures read one after the other show what they show alone.
#![allow(clippy::unwrap_used, reason = "helpers of tests fail as tests do")]

use wmr_tests::frame_sequence::{Course, Read, read};

/// Pictures that are read, and how many of them may be read as a whole: the first, one when a thing has come and one
/// when it has gone, and where something hides a part of a thing for some moments.
const PICTURES: usize = 30;
const MOST_WHOLE: usize = 9;
/// The robot is seen where it is seen alone, m and rad: to a hundredth of a pixel where it is its tag.
const ROBOT: (f64, f64) = (0.0005, 0.005);
/// Edges lie where they are seen alone: in most pictures to a pixel, and elsewhere as near as two readings of the far
/// edges of a tall box lie together, which its margins span.
const MOSTLY: f64 = 0.005;
const AT_MOST: f64 = 0.035;
/// The truth may stick out of what is seen by no more than it does alone, but for a pixel.
const PIXEL: f64 = 0.004;

fn check(all: &[Read]) {
    let mut offs = Vec::new();
    for (number, one) in all.iter().enumerate() {
        let robot = one.robot_off().unwrap();
        assert!(robot.0 < ROBOT.0 && robot.1 < ROBOT.1, "{number}: {robot:?}");
        let off = one.things_off();
        assert!(off.is_some_and(|off| off < AT_MOST), "{number}: {off:?} {one:?}");
        offs.extend(off);
        let out = one.uncovered();
        assert!(out <= PIXEL.max(one.uncovered_alone()), "{number}: {out} {one:?}");
    }
    offs.sort_by(f64::total_cmp);
    assert!(offs[3 * offs.len() / 4] < MOSTLY, "{offs:?}");
    let whole = all.iter().filter(|one| one.is_whole).count();
    assert!(whole <= MOST_WHOLE, "{whole} of {}", all.len());
}

/// The number of things seen in each picture.
fn counts(all: &[Read]) -> Vec<usize> {
    all.iter().map(|one| one.seen.obstacles.len()).collect()
}

/// Beside three boxes and one that moves, a fifth stands there in the pictures from 8 to 19.
#[test]
fn what_moves_comes_and_goes_is_seen_as_in_each_picture_alone() {
    let all = read(&Course::usual(), PICTURES);
    check(&all);
    let counts = counts(&all);
    assert!(counts[9..20].iter().all(|count| *count == 5), "{counts:?}");
    assert!(counts[21..].iter().all(|count| *count == 4), "{counts:?}");
}

#[test]
fn a_robot_with_a_triangle_is_followed_too() {
    let all = read(&Course { has_tag: false, ..Course::usual() }, PICTURES / 2);
    check(&all);
}

/// A fifth more light within two seconds, and a lamp that somebody moves.
#[test]
fn light_that_changes_changes_nothing() {
    let course = Course {
        exposure: |picture| 0.75 + 0.015 * (picture / 2) as f64,
        guest: None,
        ..Course::usual()
    };
    check(&read(&course, 20));
    let lamp = |picture: usize| match picture {
        0..5 => Course::light(),
        _ => hil_sim::camera::Light { lamp: [2.6, 1.9, 2.6], ..Course::light() },
    };
    let all = read(&Course { lamp, guest: None, ..Course::usual() }, 8);
    check(&all);
    assert!(all[5].is_whole);
}
