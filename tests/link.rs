//! No leg lost, none driven twice, whatever the wire does; figures by the million with
//! `cargo run --release -p wmr-tests --example link_figures -- --legs 1000000`.

use hil_sim::wire::{Faults, Pace};
use std::time::Duration;
use wmr::link::mission::{Mission, MissionEvent};
use wmr_tests::POLL;
use wmr_tests::damage::{Verdicts, damage_frames};
use wmr_tests::link::{ORIGIN, Tally, drive_many, straight_legs, wired};

const LEGS: u32 = 100_000;

/// What must hold of every tally: every leg once, in order, without a stop.
fn assert_flawless(tally: &Tally, legs: u32) {
    let Tally { driven, lost, doubled, out_of_order, stuck, silent, .. } = *tally;
    assert_eq!(
        [driven, lost, doubled, out_of_order, stuck, silent],
        [legs, 0, 0, 0, 0, 0],
        "{tally:?}"
    );
}

#[test]
fn every_leg_is_driven_once_over_a_harsh_wire() {
    let pace = Pace { latency: Duration::from_millis(5), ..Pace::default() };
    let tally = drive_many(LEGS, Faults::HARSH, pace, 1).unwrap();
    assert_flawless(&tally, LEGS);
    // The faults were there: about 7 % of all frames arrive cut, damaged or run together.
    assert!(tally.retransmitted > LEGS / 10, "{tally:?}");
    assert!(tally.damaged > LEGS / 100, "{tally:?}");
}

#[test]
fn every_leg_is_driven_once_whatever_the_seed() {
    for seed in 2..42 {
        let pace = Pace {
            latency: Duration::from_millis(seed % 5 * 10),
            jitter: Duration::from_millis(seed % 3 * 5),
            baud: (seed % 2 == 0).then_some(115_200),
        };
        let tally = drive_many(500, Faults::HARSH, pace, seed).unwrap();
        assert_flawless(&tally, 500);
    }
}

#[test]
fn short_legs_flow_over_a_slow_and_lossy_wire() {
    // π/2 · 0.4²/0.8 m would reach V; √(2π · 0.0115/0.8) = 0.3 s.
    const STEP: f32 = 0.0115;
    let seconds = |faults, pace| {
        let mut client = wired(faults, pace, 1);
        let mut mission = Mission::new(straight_legs(1, 200, STEP), ORIGIN);
        loop {
            let now = client.port_mut().now();
            assert!(now < Duration::from_secs(120));
            let events = mission.step(&mut client, now).unwrap();
            if events.iter().any(|event| matches!(event, MissionEvent::Done(_))) {
                return now.as_secs_f64();
            }
            client.port_mut().wait(POLL).unwrap();
        }
    };
    let perfect = seconds(Faults::default(), Pace::default());
    assert!((60.0..64.0).contains(&perfect), "200 legs of 0.3 s: {perfect}");
    let latency = Duration::from_millis(25);
    let slow =
        seconds(Faults { loss: 0.1, ..Faults::default() }, Pace { latency, ..Pace::default() });
    assert!(slow < perfect / 0.9, "{slow} {perfect}");
}

#[test]
fn no_damaged_frame_is_taken_for_another() {
    let Verdicts { refused, unharmed, misread } = damage_frames(1_000_000, 1);
    assert_eq!(misread, 0);
    assert!(refused > 900_000 && unharmed < 20_000, "{refused} {unharmed}");
}

#[test]
fn a_perfect_wire_needs_nothing_twice() {
    let tally = drive_many(2_000, Faults::default(), Pace::default(), 1).unwrap();
    assert_flawless(&tally, 2_000);
    assert_eq!((tally.retransmitted, tally.damaged), (0, 0));
    // A leg that takes a tick of 5 ms each makes 10 s; to meet and to begin the plan takes less than one.
    assert!((10_000..11_000).contains(&tally.milliseconds), "{} ms", tally.milliseconds);
}
