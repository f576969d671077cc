//! Every history of the link with so many faults, at any moment: an exhaustive search of host, wires and
//! robot as one state machine.
//!
//! ```text
//! state ─► the host's frames: each arrives, vanishes, is doubled or late ─► the robot's frames: likewise ─► state
//!      └─► the robot restarts ─► state
//! ```
//! Time goes in steps of [`POLL`]. A fault costs one of a budget; when it is spent the wires are perfect,
//! and what then happens is certain. States that differ in nothing but what is counted for statistics
//! are one, and are followed once; they carry their time, so a history visits none twice and the search
//! is finite.

use crate::POLL;
use crate::link::{Client, ORIGIN, STUCK, straight_legs, wired};
use hil_sim::in_process::InProcess;
use hil_sim::wire::{Faults, FrameFault, Pace};
use std::collections::HashSet;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::time::Duration;
use wmr::link::LinkError;
use wmr::link::mission::{Mission, MissionError, MissionEvent};

/// What may befall a frame, for one of the budget.
const FAULTS: [FrameFault; 3] = [FrameFault::Lost, FrameFault::Duplicated, FrameFault::Delayed(2)];
/// The legs of the mission.
const LEGS: u16 = 2;
/// More frames than an end sends in one step.
const PLENTY: usize = 64;
/// Fields that say what was counted, and change nothing that happens.
const STATISTICS: [&str; 6] =
    ["frames: ", "retransmitted: ", "received: ", "bytes: ", "damaged: ", "carried: "];

/// Where a search begins.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Begin {
    /// Host and robot have not met.
    Fresh,
    /// The host has driven a plan, and drives the next in the same session.
    BetweenPlans,
}

/// What a search has found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Found {
    /// Different states in which something may yet go wrong, or has for the last time.
    pub states: usize,
    /// Ways to the end of the mission.
    pub ends: u64,
    /// Of these, with an error because the robot restarted.
    pub restarted: u64,
    /// The longest that a mission took, virtual time.
    pub longest: Duration,
}

/// Follows every history with up to `budget` faults.
///
/// # Panics
/// If a mission lasts [`STUCK`], a leg ends twice or out of order, or a mission ends otherwise than at
/// its goal, or by an error after a restart.
pub fn search(begin: Begin, budget: u32) -> Found {
    let mut found = Found::default();
    let mut visited = HashSet::new();
    let mut open = vec![(State::new(begin), budget)];
    while let Some((state, budget)) = open.pop() {
        if !visited.insert(state.key(budget)) {
            continue;
        }
        if budget == 0 {
            state.finish(&mut found);
            continue;
        }
        for (state, spent) in state.successors(budget, &mut found) {
            open.push((state, budget - spent));
        }
    }
    found.states = visited.len();
    found
}

/// Host, wires and robot between two steps.
#[derive(Clone, Debug)]
struct State {
    client: Client,
    mission: Mission,
    next: u16,
    began: Duration,
    restarted: bool,
}

impl State {
    fn new(begin: Begin) -> Self {
        let client = wired(Faults::default(), Pace::default(), 1);
        let mut state = Self::with(client, 1);
        if begin == Begin::BetweenPlans {
            while !state.host(&mut Found::default()) {
                state.robot();
            }
            state = Self::with(state.client, 2);
        }
        state
    }

    fn with(mut client: Client, plan: u32) -> Self {
        let began = client.port_mut().now();
        let mission = Mission::new(straight_legs(plan, LEGS, 0.0), ORIGIN);
        Self { client, mission, next: 0, began, restarted: false }
    }

    /// What tells this state from others.
    fn key(&self, budget: u32) -> u64 {
        let mut hasher = DefaultHasher::new();
        budget.hash(&mut hasher);
        let text = format!("{self:?}");
        let mut rest = text.as_str();
        while let Some((start, name)) =
            STATISTICS.iter().filter_map(|name| Some((rest.find(name)?, name))).min()
        {
            let (before, behind) = rest.split_at(start + name.len());
            before.hash(&mut hasher);
            rest = behind.trim_start_matches(|c: char| c.is_ascii_digit());
        }
        rest.hash(&mut hasher);
        hasher.finish()
    }

    /// All states after one step, and what each costs of the budget.
    fn successors(&self, budget: u32, found: &mut Found) -> Vec<(Self, u32)> {
        let mut all = Vec::new();
        if !self.restarted {
            let mut restarted = self.clone();
            let fresh = InProcess::new(Default::default(), 99);
            *restarted.client.port_mut().firmware_mut() = fresh;
            restarted.restarted = true;
            all.push((restarted, 1));
        }
        let frames = self.frames(0, |state| {
            state.host(&mut Found::default());
        });
        for (script, spent) in script(frames, budget) {
            let mut state = self.clone();
            state.client.port_mut().wires()[0].script(script);
            if state.host(found) {
                continue;
            }
            let frames = state.frames(1, Self::robot);
            for (script, more) in self::script(frames, budget - spent) {
                let mut state = state.clone();
                state.client.port_mut().wires()[1].script(script);
                state.robot();
                all.push((state, spent + more));
            }
        }
        all
    }

    /// How many frames `step` puts on the wire that leads `way`.
    fn frames(&self, way: usize, step: impl Fn(&mut Self)) -> usize {
        let mut state = self.clone();
        state.client.port_mut().wires()[way].script([FrameFault::None; PLENTY]);
        step(&mut state);
        PLENTY - state.client.port_mut().wires()[way].scripted()
    }

    /// Goes on without faults.
    fn finish(mut self, found: &mut Found) {
        while !self.host(found) {
            self.robot();
        }
    }

    /// The host's half of a step; true if its mission has ended.
    fn host(&mut self, found: &mut Found) -> bool {
        let now = self.client.port_mut().now();
        let age = now - self.began;
        assert!(age < STUCK, "stuck: {self:?}");
        let end = match self.mission.step(&mut self.client, now) {
            Ok(events) => events.iter().any(|event| self.check(event)),
            Err(MissionError::Link(LinkError::Restarted(_))) if self.restarted => {
                found.restarted += 1;
                true
            }
            Err(error) => panic!("{error}: {self:?}"),
        };
        if end {
            found.ends += 1;
            found.longest = found.longest.max(age);
        }
        end
    }

    /// Notes an event; true if the mission has come to its goal.
    fn check(&mut self, event: &MissionEvent) -> bool {
        match event {
            MissionEvent::LegDone(result) => {
                assert_eq!(result.index, self.next, "a leg ended twice, or out of order");
                self.next += 1;
                false
            }
            MissionEvent::Done(_) => {
                assert_eq!(self.next, LEGS, "a leg is lost: {self:?}");
                true
            }
            _ => false,
        }
    }

    /// The robot's half of a step.
    fn robot(&mut self) {
        let waited = self.client.port_mut().wait(POLL);
        assert!(waited.is_ok(), "{waited:?}");
    }
}

/// Every way to share out up to `budget` faults among so many frames, and what it costs.
fn script(frames: usize, budget: u32) -> Vec<(Vec<FrameFault>, u32)> {
    let mut all = vec![(Vec::new(), 0)];
    for _ in 0..frames {
        all = all
            .into_iter()
            .flat_map(|(script, spent)| {
                let affordable: &[FrameFault] = if spent < budget { &FAULTS } else { &[] };
                let one = move |fault: FrameFault, cost| {
                    ([script.as_slice(), &[fault]].concat(), spent + cost)
                };
                let arrives = one(FrameFault::None, 0);
                let faulty: Vec<_> = affordable.iter().map(|fault| one(*fault, 1)).collect();
                std::iter::once(arrives).chain(faulty)
            })
            .collect();
    }
    all
}
