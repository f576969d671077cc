//! How long a picture takes to be read with what is known from the pictures before, and how long alone; and how far
//! the two readings lie apart.
//!
//! `cargo run --release -p wmr-tests --example frame_sequence [-- --each]`

use std::time::Duration;
use wmr_tests::frame_sequence::{Course, Read, read};

const PICTURES: usize = 120;

fn main() {
    let each = std::env::args().any(|argument| argument == "--each");
    println!(
        "{:<34}{:>8}{:>8}{:>8}{:>8}{:>8}{:>7}{:>7}{:>7}",
        "ms a picture", "median", "95 %", "mean", "alone", "ratio", "whole", "mm", "robot"
    );
    let tagged = Course::usual();
    let disc = Course { has_tag: false, ..tagged.clone() };
    let still = Course { movers: Vec::new(), guest: None, ..tagged.clone() };
    let bare = Course { shapes: Vec::new(), ..still.clone() };
    let emptied = Course { knows_empty: true, ..tagged.clone() };
    let drifting =
        Course { exposure: |picture| 0.8 + 0.002 * (picture / 10 * 10) as f64, ..tagged.clone() };
    for (name, course) in [
        ("empty floor, tag", bare),
        ("three boxes, tag", still),
        ("… one moves, one comes and goes", tagged),
        ("… by the robot's disc", disc),
        ("… in light that drifts", drifting),
        ("… with the empty floor known", emptied),
    ] {
        let all = read(&course, PICTURES);
        row(name, &all);
        if each {
            all.iter().enumerate().for_each(|(number, one)| line(number, one));
        }
    }
}

fn row(name: &str, all: &[Read]) {
    let [with, alone] = [0, 1].map(|which| {
        let mut times: Vec<Duration> = all.iter().map(|one| one.times[which]).collect();
        times.sort_unstable();
        times.into_iter().map(|time| 1000.0 * time.as_secs_f64()).collect::<Vec<f64>>()
    });
    let at = |times: &[f64], share: f64| times[(share * times.len() as f64) as usize];
    let mean = |times: &[f64]| times.iter().sum::<f64>() / times.len() as f64;
    let whole = all.iter().filter(|one| one.is_whole).count();
    let off = all.iter().map(|one| one.things_off().unwrap_or(9.0)).fold(0.0, f64::max);
    let robot = all.iter().filter_map(Read::robot_off).map(|off| off.0).fold(0.0, f64::max);
    println!(
        "{name:<34}{:>8.1}{:>8.1}{:>8.1}{:>8.1}{:>8.1}{whole:>7}{:>7.1}{:>7.1}",
        at(&with, 0.5),
        at(&with, 0.95),
        mean(&with),
        at(&alone, 0.5),
        at(&alone, 0.5) / at(&with, 0.5),
        1000.0 * off,
        1000.0 * robot,
    );
}

fn line(number: usize, one: &Read) {
    let [with, alone] = one.times.map(|time| 1000.0 * time.as_secs_f64());
    println!(
        "{number:>5}{:>7}{with:>8.1}{alone:>8.1}  things {} {} off {:?} uncovered {:.1} robot {:?}",
        if one.is_whole { "whole" } else { "" },
        one.seen.obstacles.len(),
        one.alone.obstacles.len(),
        one.things_off().map(|off| (10_000.0 * off).round() / 10.0),
        1000.0 * one.uncovered(),
        one.robot_off().map(|off| (10_000.0 * off.0).round() / 10.0),
    );
}
