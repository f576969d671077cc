//! How long the link takes: acknowledgements, stops, recovery after a loss, and noticing a reset.
#![allow(clippy::unwrap_used, clippy::panic, reason = "what helps a test fails as a test does")]

use hil_sim::in_process::InProcess;
use hil_sim::wire::{Faults, FrameFault, Pace, Wire};
use protocol::frame::{Decoder, MAX_FRAME};
use protocol::message::{Command, MAX_LEGS, State};
use protocol::session::Session;
use protocol::units::Milliseconds;
use std::time::Duration;
use wmr::link::mission::{Mission, MissionError, MissionEvent, Progress};
use wmr::link::{LinkClient, LinkError};
use wmr_tests::link::{Client, ORIGIN, straight_legs, wired};

const MILLISECOND: Duration = Duration::from_millis(1);
const UART: Pace = Pace { latency: Duration::ZERO, jitter: Duration::ZERO, baud: Some(115_200) };

/// A reset is noticed this soon after bytes flow again.
const NOTICED: Duration = Duration::from_millis(150);

/// Two encoder counts on a wheel and what is left of a coasting stop.
const POSITION_TOLERANCE: f64 = 0.005;

/// Steps `mission` every millisecond until `until` says so, or it ends with an error.
fn step_until(
    client: &mut Client,
    mission: &mut Mission,
    seconds: u64,
    mut until: impl FnMut(&mut Client, &[MissionEvent]) -> bool,
) -> Result<Vec<MissionEvent>, MissionError> {
    let mut all = Vec::new();
    let end = client.port_mut().now() + Duration::from_secs(seconds);
    while client.port_mut().now() < end {
        let now = client.port_mut().now();
        let events = mission.step(client, now)?;
        all.extend_from_slice(&events);
        if until(client, &events) {
            return Ok(all);
        }
        client.port_mut().wait(MILLISECOND).unwrap();
    }
    panic!("not within {seconds} s: {:?}", all.last());
}

fn is_done(_: &mut Client, events: &[MissionEvent]) -> bool {
    events.iter().any(|event| matches!(event, MissionEvent::Done(_)))
}

fn ended(events: &[MissionEvent]) -> Vec<u16> {
    let index = |event: &MissionEvent| match event {
        MissionEvent::LegDone(result) => Some(result.index),
        _ => None,
    };
    events.iter().filter_map(index).collect()
}

/// Lets `mission` drive until its third leg is well under way.
fn drive_into_third_leg(client: &mut Client, mission: &mut Mission) -> Vec<MissionEvent> {
    let mut second_done = None;
    step_until(client, mission, 30, |client, events| {
        let now = client.port_mut().now();
        if ended(events).contains(&1) {
            second_done = Some(now);
        }
        second_done.is_some_and(|done| now > done + Duration::from_millis(500))
    })
    .unwrap()
}

#[test]
fn a_leg_is_acknowledged_within_15_ms_beside_telemetry() {
    let mut client = wired(Faults::default(), UART, 1);
    let mut mission = Mission::new(straight_legs(1, MAX_LEGS as u16, 0.4), ORIGIN);
    step_until(&mut client, &mut mission, 5, |client, _| {
        client.telemetry().is_some_and(|telemetry| telemetry.state == State::Driving)
    })
    .unwrap();
    let bytes_before = client.port_mut().wires()[1].carried();
    let began = client.port_mut().now();
    let leg = straight_legs(2, 1, 0.1)[0];
    let mut random = fastrand::Rng::with_seed(1);
    let mut latencies = Vec::new();
    for _ in 0..1000 {
        let pause = random.u32(1..30) * MILLISECOND;
        let resume = client.port_mut().now() + pause;
        step_until(&mut client, &mut mission, 5, |client, _| client.port_mut().now() >= resume)
            .unwrap();
        assert_eq!(client.unacknowledged(), 0);
        let sent = client.port_mut().now();
        assert!(client.send(Command::PlanLeg(leg)));
        step_until(&mut client, &mut mission, 5, |client, _| client.unacknowledged() == 0).unwrap();
        latencies.push(client.port_mut().now() - sent);
    }
    latencies.sort();
    assert!(latencies[989] <= 15 * MILLISECOND, "p99 {:?}", latencies[989]);
    let seconds = (client.port_mut().now() - began).as_secs_f64();
    let bytes = client.port_mut().wires()[1].carried() - bytes_before;
    let acks = 1000.0 * 15.0;
    let share = (bytes as f64 - acks) / seconds / 11_520.0;
    assert!(share < 0.15, "telemetry takes {share} of the wire");
}

#[test]
fn a_stop_overtakes_everything() {
    for seed in 0..50 {
        let mut client = wired(Faults::default(), UART, seed);
        let mut mission = Mission::new(straight_legs(1, 1000, 0.0115), ORIGIN);
        let moment = 2 * Duration::from_secs(1) + seed as u32 * MILLISECOND;
        step_until(&mut client, &mut mission, 9, |client, _| client.port_mut().now() > moment)
            .unwrap();
        while client.send(Command::PlanLeg(straight_legs(1, 1, 0.1)[0])) {}
        client.stop();
        let now = client.port_mut().now();
        client.poll(now).unwrap();
        let arrival = client.port_mut().wires()[0].last_arrival();
        while client.port_mut().firmware_mut().robot().state() != State::Stopped {
            client.port_mut().wait(MILLISECOND).unwrap();
            let now = client.port_mut().now();
            assert!(now <= arrival + 5 * MILLISECOND, "{now:?} {arrival:?}");
        }
    }
}

/// How long each of a stream of messages takes, ms, when the frame of the one numbered `lost` vanishes.
fn delays(round_trip: u32, lost: u32, messages: u32) -> Vec<u32> {
    let pace =
        Pace { latency: Duration::from_millis(u64::from(round_trip) / 2), ..Pace::default() };
    let wire = Wire::new(Faults::default(), pace, 0);
    let (mut there, mut back) = (wire.clone(), wire);
    let mut ends: [Session<u32, u32>; 2] = [0, 1].map(|_| Session::new(1, Milliseconds(0)));
    let mut decoders = [Decoder::default(), Decoder::default()];
    let (mut delays, mut frame) = (Vec::new(), [0; MAX_FRAME]);
    // The window is not to be what holds them up.
    let interval = 10 + round_trip / 2;
    for millisecond in 0..messages * interval + 2000 {
        let (now, clock) = (Duration::from_millis(millisecond.into()), Milliseconds(millisecond));
        let [host, robot] = &mut ends;
        if millisecond % interval == 0 && millisecond / interval < messages {
            host.send(millisecond).unwrap();
            if millisecond / interval == lost {
                there.script([FrameFault::Lost]);
            }
        }
        let length = host.poll(clock, &mut frame);
        there.write(&frame[..length], now);
        for (end, wire, decoder) in [(&mut *robot, &mut there, 0), (&mut *host, &mut back, 1)] {
            while let Some(bytes) = wire.read(now) {
                let decoder = &mut decoders[decoder];
                for (header, message) in
                    bytes.iter().filter_map(|byte| decoder.push::<u32>(*byte)).flatten()
                {
                    end.accept(&header, message, clock);
                }
            }
        }
        while let Some(sent) = robot.next_message() {
            delays.push(millisecond - sent);
        }
        if robot.ack_due() {
            let length = robot.write_unreliable(&0, &mut frame);
            back.write(&frame[..length], now);
        }
    }
    delays
}

#[test]
fn a_lost_frame_costs_two_round_trips_and_20_ms() {
    for round_trip in [0, 2, 10, 30, 50] {
        // In the middle of a stream, where later frames tell of the gap, and at its end.
        for lost in [30, 59] {
            let delays = delays(round_trip, lost, 60);
            assert_eq!(delays.len(), 60);
            let most = delays.iter().max().unwrap();
            assert!(*most <= 2 * round_trip + 20, "{most} ms at {round_trip} ms");
        }
    }
}

#[test]
fn a_robot_that_was_reset_is_noticed_and_the_mission_resumed() {
    let legs = straight_legs(7, 5, 0.4);
    let mut client = wired(Faults::default(), UART, 3);
    let mut mission = Mission::new(legs.clone(), ORIGIN);
    let before = drive_into_third_leg(&mut client, &mut mission);
    let reset = client.port_mut().now();
    *client.port_mut().firmware_mut() = InProcess::new(Default::default(), 99);
    let error = step_until(&mut client, &mut mission, 5, |_, _| false).unwrap_err();
    assert!(matches!(error, MissionError::Link(LinkError::Restarted(_))), "{error}");
    assert!(client.port_mut().now() - reset < NOTICED);
    let Progress { next, pose } = mission.progress();
    assert_eq!(next, 2);
    let mut port = client.into_port();
    port.wait(Duration::from_secs(1)).unwrap();
    assert_eq!(port.firmware_mut().robot().state(), State::Idle);
    // The base has coasted to rest; somebody puts it where the host last saw it.
    let mut client = LinkClient::new(port, 100);
    let mut mission = Mission::resume_from(legs, Progress { next, pose });
    let after = step_until(&mut client, &mut mission, 30, is_done).unwrap();
    assert_eq!([ended(&before), ended(&after)].concat(), [0, 1, 2, 3, 4]);
}

#[test]
fn a_host_that_was_restarted_goes_on_where_the_robot_waits() {
    let legs = straight_legs(7, 5, 0.4);
    let mut client = wired(Faults::default(), UART, 3);
    let mut mission = Mission::new(legs.clone(), ORIGIN);
    let before = drive_into_third_leg(&mut client, &mut mission);
    let mut client = LinkClient::new(client.into_port(), 100);
    let restart = client.port_mut().now();
    let mut mission = Mission::resume_from(legs, Progress { next: 0, pose: ORIGIN });
    let mut waited = None;
    let after = step_until(&mut client, &mut mission, 30, |client, events| {
        if matches!(client.port_mut().firmware_mut().robot().state(), State::Paused(_)) {
            waited.get_or_insert(client.port_mut().now());
        }
        is_done(client, events)
    })
    .unwrap();
    assert!(waited.unwrap() - restart < NOTICED);
    assert_eq!([ended(&before), ended(&after)].concat(), [0, 1, 2, 3, 4]);
    let truth = client.port_mut().truth().pose;
    assert!((truth.x - 2.0).hypot(truth.y) < POSITION_TOLERANCE, "{truth:?}");
}

#[test]
fn a_cable_that_is_plugged_in_again_does_not_end_the_mission() {
    let legs = straight_legs(7, 5, 0.4);
    let mut client = wired(Faults::default(), UART, 4).with_patience(Duration::from_secs(10));
    let mut mission = Mission::new(legs, ORIGIN);
    let before = drive_into_third_leg(&mut client, &mut mission);
    let cut = Faults { loss: 1.0, ..Faults::default() };
    client.port_mut().wires().into_iter().for_each(|wire| wire.change(cut, UART));
    let back = client.port_mut().now() + Duration::from_secs(4);
    let mut during =
        step_until(&mut client, &mut mission, 9, |client, _| client.port_mut().now() > back)
            .unwrap();
    assert!(matches!(client.port_mut().firmware_mut().robot().state(), State::Paused(_)));
    let whole = Faults::default();
    client.port_mut().wires().into_iter().for_each(|wire| wire.change(whole, UART));
    let mut resumed = None;
    during.extend(
        step_until(&mut client, &mut mission, 30, |client, events| {
            if client.port_mut().firmware_mut().robot().state() == State::Driving {
                resumed.get_or_insert(client.port_mut().now());
            }
            is_done(client, events)
        })
        .unwrap(),
    );
    assert!(resumed.unwrap() - back < Duration::from_secs(1));
    assert_eq!([ended(&before), ended(&during)].concat(), [0, 1, 2, 3, 4]);
}

#[test]
fn a_computer_that_was_away_does_not_blame_the_robot() {
    let mut client = wired(Faults::default(), UART, 6);
    // The client's clock is ahead of the robot's by as long as the computer was away.
    let poll = |client: &mut Client, away: Duration, polls: u32| {
        for _ in 0..polls {
            client.port_mut().wait(MILLISECOND).unwrap();
            let now = client.port_mut().now() + away;
            client.poll(now)?;
        }
        Ok::<_, LinkError>(())
    };
    poll(&mut client, Duration::ZERO, 500).unwrap();
    let away = Duration::from_secs(20);
    client.stop();
    assert!(client.send(Command::GetParameters));
    poll(&mut client, away, 500).unwrap();
    assert_eq!((client.unacknowledged(), client.last_stop()), (0, (1, true)));
    // A robot that is silent while the computer looks is lost after 3 s as ever.
    let cut = Faults { loss: 1.0, ..Faults::default() };
    client.port_mut().wires()[1].change(cut, UART);
    poll(&mut client, away, 2_900).unwrap();
    assert!(matches!(poll(&mut client, away, 200), Err(LinkError::Lost(_))));
}

#[test]
fn ticks_of_the_robot_are_known_to_a_millisecond_on_usb() {
    let usb = Pace { latency: Duration::from_micros(200), jitter: MILLISECOND, baud: None };
    let mut client = wired(Faults::default(), usb, 5);
    let mut errors = Vec::new();
    for _ in 0..60_000 {
        let now = client.port_mut().now();
        client.poll(now).unwrap();
        if let Some(telemetry) = client.telemetry() {
            // The simulation's clock is the robot's: no drift, which the unit test has.
            let truth = f64::from(telemetry.ticks) * 0.005;
            let told = client.clock().host_time(telemetry.ticks).unwrap().as_secs_f64();
            errors.push((told - truth).abs());
        }
        client.port_mut().wait(MILLISECOND / 4).unwrap();
    }
    errors.sort_by(f64::total_cmp);
    let p99 = errors[errors.len() * 99 / 100];
    assert!(p99 < 0.001, "{p99}");
}
