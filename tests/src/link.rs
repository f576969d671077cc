//! Many legs over bad wires, and what became of them.

use crate::{POLL, simulated_robot};
use hil_sim::in_process::InProcess;
use hil_sim::simulation::Simulation;
use hil_sim::wire::{Faults, Pace, Wire};
use protocol::message::{PauseReason, State};
use protocol::motion::{Direction, Leg, Pose, Position, Timing};
use std::time::Duration;
use wmr::link::mission::{Mission, MissionEvent};
use wmr::link::{LinkClient, LinkError};

/// A host on a wire to a simulated robot.
pub type Client = LinkClient<Simulation<InProcess>>;

/// Where the robots of these tests begin.
pub const ORIGIN: Pose = Pose::new(0.0, 0.0, 0.0);

/// Legs of one plan of these tests; more than the robot keeps, so that most are appended.
const LEGS_PER_PLAN: u32 = 5_000;

/// Nothing may take longer than this without progress or error.
pub const STUCK: Duration = Duration::from_secs(5);

/// What became of many legs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tally {
    /// Legs whose end was reported when it was due.
    pub driven: u32,
    /// Legs whose end was never reported.
    pub lost: u32,
    /// Legs whose end was reported again.
    pub doubled: u32,
    /// Legs whose end was reported before that of an earlier one.
    pub out_of_order: u32,
    /// Missions that got nowhere for [`STUCK`].
    pub stuck: u32,
    /// Telemetry frames that told of a stop because the host was silent.
    pub silent: u32,
    /// Frames sent again by the host.
    pub retransmitted: u32,
    /// Frames that arrived damaged at the host.
    pub damaged: u32,
    /// Virtual time, milliseconds.
    pub milliseconds: u64,
}

/// A client of a robot at the origin behind two wires of this kind, each with faults of its own.
pub fn wired(faults: Faults, pace: Pace, seed: u64) -> Client {
    let simulation = simulated_robot(ORIGIN, seed)
        .with_wires(Wire::new(faults, pace, 2 * seed), Wire::new(faults, pace, 2 * seed + 1));
    LinkClient::new(simulation, seed as u32 + 1)
}

/// `count` legs of `plan`, each `step` metres further along the x axis; with no step they take a tick each.
pub fn straight_legs(plan: u32, count: u16, step: f32) -> Vec<Leg> {
    let leg = |index| Leg {
        plan,
        index,
        start: Pose::new(step * f32::from(index), 0.0, 0.0),
        goal: Position::new(step * f32::from(index + 1), 0.0),
        goal_heading: None,
        direction: Direction::Forward,
        timing: Timing::Limits,
    };
    (0..count).map(leg).collect()
}

/// Drives `legs` legs that take a tick each, plan after plan in one session, over two such wires.
///
/// # Errors
/// [`LinkError`] if the simulation fails.
///
/// # Panics
/// If a mission ends with an error.
pub fn drive_many(legs: u32, faults: Faults, pace: Pace, seed: u64) -> Result<Tally, LinkError> {
    let mut client = wired(faults, pace, seed);
    let mut tally = Tally::default();
    let plans = legs.div_ceil(LEGS_PER_PLAN);
    for plan in 0..plans {
        let count = LEGS_PER_PLAN.min(legs - plan * LEGS_PER_PLAN) as u16;
        drive_plan(&mut client, straight_legs(plan + 1, count, 0.0), &mut tally)?;
    }
    let statistics = client.statistics();
    tally.retransmitted = statistics.retransmitted;
    tally.damaged = statistics.lost;
    tally.milliseconds = client.port_mut().now().as_millis() as u64;
    Ok(tally)
}

fn drive_plan(client: &mut Client, legs: Vec<Leg>, tally: &mut Tally) -> Result<(), LinkError> {
    let count = legs.len() as u16;
    let mut seen = vec![false; legs.len()];
    let mut next = 0;
    let mut progress = client.port_mut().now();
    let mut mission = Mission::new(legs, ORIGIN);
    loop {
        let now = client.port_mut().now();
        let events = match mission.step(client, now) {
            Ok(events) => events,
            Err(error) => panic!("leg {next} of {count} at {now:?}: {error}"),
        };
        for event in &events {
            match event {
                MissionEvent::LegDone(result) => {
                    let again = std::mem::replace(&mut seen[usize::from(result.index)], true);
                    tally.doubled += u32::from(again);
                    tally.out_of_order += u32::from(result.index != next);
                    tally.driven += u32::from(!again);
                    next = result.index + 1;
                    progress = now;
                }
                MissionEvent::Telemetry(telemetry) => {
                    let silent = telemetry.state == State::Paused(PauseReason::Silence);
                    tally.silent += u32::from(silent);
                }
                MissionEvent::Done(_) => {
                    tally.lost += seen.iter().filter(|seen| !**seen).count() as u32;
                    return Ok(());
                }
                MissionEvent::Connected(_)
                | MissionEvent::Accepted { .. }
                | MissionEvent::Replaced { .. } => progress = now,
                MissionEvent::NotReplaced(_) | MissionEvent::PoseRefused(_) => {}
            }
        }
        if now - progress > STUCK {
            tally.stuck += 1;
            return Ok(());
        }
        client.port_mut().wait(POLL)?;
    }
}
