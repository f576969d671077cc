//! What the fuzz targets in `fuzz/` run: the decoder alone, and host, wires and robot together.
//!
//! Both take any bytes and panic where a promise is broken. `cargo test` runs them on the corpus and
//! on random bytes; `fuzz/README.md` says how to run them for an hour.

use crate::POLL;
use crate::link::{Client, ORIGIN, STUCK, straight_legs, wired};
use hil_sim::in_process::InProcess;
use hil_sim::wire::{Faults, FrameFault, Pace};
use protocol::frame::{Decoder, MAX_FRAME, encode};
use protocol::message::{Command, Report, State};
use std::io::Write;
use wmr::link::LinkClient;
use wmr::link::mission::{Mission, MissionEvent, Progress};

/// Reads `data` as the robot does and as the host does: whatever is read can be written, and is then
/// read as the same.
///
/// # Panics
/// If that is not so.
pub fn decoder(data: &[u8]) {
    let mut commands = Decoder::default();
    let mut reports = Decoder::default();
    for byte in data {
        if let Some(Ok((header, command))) = commands.push::<Command>(*byte) {
            let mut frame = [0; MAX_FRAME];
            let Ok(length) = encode(&header, &command, &mut frame) else {
                panic!("{command:?} was read, but does not fit")
            };
            let mut again = Decoder::default();
            let read = frame[..length].iter().find_map(|byte| again.push::<Command>(*byte));
            // As text, in which what is not a number equals itself.
            assert_eq!(format!("{read:?}"), format!("{:?}", Some(Ok::<_, ()>((header, command)))));
        }
        let _ = reports.push::<Report>(*byte);
    }
}

/// Drives missions over two wires, while `data` decides what the wires, the user and fault do, two
/// bytes a step. Afterwards the wires are perfect and the mission under way must end.
///
/// # Panics
/// If a leg ends twice or out of order, a stop that was heard does not hold, or a mission lasts
/// [`STUCK`].
pub fn whole_stack(data: &[u8]) {
    let mut stack = Stack::new();
    for step in data.chunks(2) {
        stack.disturb(step[0], step.get(1).copied().unwrap_or(0));
        stack.run(5);
    }
    let rounds = STUCK.as_millis() / POLL.as_millis();
    for _ in 0..rounds {
        if stack.run(1) {
            return;
        }
    }
    panic!("no end within {STUCK:?}");
}

/// Host, wires and robot.
struct Stack {
    client: Client,
    mission: Option<Mission>,
    next: Option<u16>,
    paused: bool,
    number: u32,
}

const LEGS: u16 = 5;

impl Stack {
    fn new() -> Self {
        let client = wired(Faults::default(), Pace::default(), 1);
        let mut stack = Self { client, mission: None, next: None, paused: false, number: 1 };
        stack.begin();
        stack
    }

    fn begin(&mut self) {
        self.number += 1;
        self.mission = Some(Mission::new(straight_legs(self.number, LEGS, 0.0), ORIGIN));
        self.next = Some(0);
    }

    /// A host that starts again, behind the same wires.
    fn reconnect(&mut self, resume: bool) {
        self.number += 1;
        let nowhere = wired(Faults::default(), Pace::default(), 0);
        let port = std::mem::replace(&mut self.client, nowhere).into_port();
        self.client = LinkClient::new(port, self.number);
        self.paused = false;
        let progress = self.mission.as_ref().map(Mission::progress);
        match progress.filter(|_| resume) {
            None => self.begin(),
            Some(progress) => self.resume(progress),
        }
    }

    fn resume(&mut self, progress: Progress) {
        let plan = self.number - 1;
        self.mission = Some(Mission::resume_from(straight_legs(plan, LEGS, 0.0), progress));
        // The robot may have come further than the host has heard.
        self.next = None;
    }

    fn disturb(&mut self, action: u8, value: u8) {
        let port = self.client.port_mut();
        let way = usize::from(action & 1);
        let fault = match value % 4 {
            0 => FrameFault::Lost,
            1 => FrameFault::Duplicated,
            2 => FrameFault::Delayed(usize::from(value / 4 % 8) + 1),
            _ => FrameFault::None,
        };
        match action / 2 % 16 {
            0..=5 => port.wires()[way].script([fault]),
            6 => {
                let now = port.now();
                port.wires()[way].write(&[value, action, 0], now);
            }
            7 => {
                let _ = port.write(&[value; 3]);
            }
            8 => *port.firmware_mut() = InProcess::new(Default::default(), 1000 + u32::from(value)),
            9 => self.reconnect(way == 1),
            10 => self.client.stop(),
            11 => {
                self.paused |= self.client.send(Command::Pause);
            }
            12 => {
                self.paused &= !self.client.send(Command::Resume);
            }
            13 => {
                self.client.send(Command::PlanCancel { plan: u32::from(value) });
            }
            14 => {
                self.client.clear();
            }
            _ => self.run_on(value),
        }
    }

    fn run_on(&mut self, value: u8) {
        self.run(u32::from(value));
    }

    /// Lets `polls` pass; true once no mission is under way, or it waits because the user says so.
    fn run(&mut self, polls: u32) -> bool {
        for _ in 0..polls {
            let now = self.client.port_mut().now();
            if let Some(mission) = &mut self.mission {
                match mission.step(&mut self.client, now) {
                    Ok(events) => self.check(&events),
                    // An error is an end, and names itself.
                    Err(_) => self.mission = None,
                }
            }
            let waited = self.client.port_mut().wait(POLL);
            assert!(waited.is_ok(), "{waited:?}");
        }
        self.mission.is_none() || self.paused
    }

    fn check(&mut self, events: &[MissionEvent]) {
        for event in events {
            match event {
                MissionEvent::LegDone(result) => {
                    let expected = *self.next.get_or_insert(result.index);
                    assert_eq!(result.index, expected, "a leg ended twice, or out of order");
                    self.next = Some(expected + 1);
                }
                MissionEvent::Done(_) => {
                    assert!(self.next.is_none_or(|next| next == LEGS), "{:?}", self.next);
                    let state = self.client.port_mut().firmware_mut().robot().state();
                    assert!(state != State::Driving, "it drives after the end");
                    self.mission = None;
                    return;
                }
                _ => {}
            }
        }
    }
}
