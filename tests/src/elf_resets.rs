//! The flashed ELF, reset again and again in the middle of its legs, and its mission resumed each time.

use crate::POLL;
use crate::link::{ORIGIN, straight_legs};
use hil_sim::base::{BaseParameters, TruePose, WheeledBase};
use hil_sim::emulator::{EmulatedPico, Fault};
use hil_sim::simulation::Simulation;
use protocol::message::ResetCause;
use protocol::motion::{Leg, Pose};
use std::path::Path;
use std::time::Duration;
use wmr::link::mission::{Mission, MissionError, MissionEvent, Progress};
use wmr::link::{LinkClient, LinkError};

/// A leg of 0.2 m takes 1.25 s.
const STEP: f32 = 0.2;
/// How long after the plan is accepted the reset comes, milliseconds.
const MOMENTS: std::ops::Range<u32> = 200..1100;
/// A robot whose motors are off has come to rest after this.
const COASTING: Duration = Duration::from_secs(1);
const LONGEST_LEG: Duration = Duration::from_secs(5);

/// What became of the resets.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Resets {
    /// Resets in the middle of a leg, of which the host said so and named the cause.
    pub noticed: u32,
    /// Of these, how often the robot stood still a second later.
    pub at_rest: u32,
    /// Of these, how often the robot took the rest of the plan and went on.
    pub resumed: u32,
    /// Legs whose end was reported, each once and in order.
    pub legs: u16,
}

/// Drives `resets` legs with the ELF, and resets it as often: by its power, by a panic, by a hard fault.
/// Where it came to rest a camera might see.
///
/// # Panics
/// If the emulator cannot be run, a mission fails in another way than by a restart, or a leg ends twice
/// or out of order.
pub fn reset_often(elf: &Path, resets: u32, seed: u64) -> Resets {
    let pico = EmulatedPico::spawn(elf);
    let Ok(pico) = pico else { panic!("{pico:?}") };
    let base = WheeledBase::new(BaseParameters::seeded(seed), TruePose::default());
    let mut port = Simulation::new(pico, base, None);
    let mut random = fastrand::Rng::with_seed(seed);
    let legs = straight_legs(1, resets.max(2) as u16, STEP);
    let (mut tally, mut progress) = (Resets::default(), Progress { next: 0, pose: ORIGIN });
    let causes = [ResetCause::PowerOn, ResetCause::Panic, ResetCause::HardFault];
    for (number, cause) in (0..resets).zip(causes.into_iter().cycle()) {
        let moment = random.u32(MOMENTS) * Duration::from_millis(1);
        let mut drive = Drive::new(port, number, &legs, progress);
        assert!(drive.until_after_acceptance(moment), "the plan ended before reset {number}");
        tally.resumed += u32::from(number > 0);
        let end = drive.reset(cause);
        tally.noticed += u32::from(
            matches!(end, MissionError::Link(LinkError::Restarted(named)) if named == cause),
        );
        progress.next = drive.mission.progress().next;
        port = drive.client.into_port();
        progress.pose = come_to_rest(&mut port, &mut tally);
    }
    let mut last = Drive::new(port, resets, &legs, progress);
    assert!(!last.until_after_acceptance(legs.len() as u32 * LONGEST_LEG));
    tally.resumed += 1;
    tally.legs = last.mission.progress().next;
    tally
}

/// Where it is once its motors have been off for a while, if they are.
fn come_to_rest(port: &mut Simulation<EmulatedPico>, tally: &mut Resets) -> Pose {
    let mut pass = |duration| {
        let passed = port.wait(duration);
        assert!(passed.is_ok(), "{passed:?}");
        port.truth().pose
    };
    pass(COASTING);
    let (before, after) = (pass(POLL), pass(20 * POLL));
    tally.at_rest += u32::from(before == after);
    Pose::new(after.x as f32, after.y as f32, after.heading as f32)
}

/// One session and the mission in it.
struct Drive {
    client: LinkClient<Simulation<EmulatedPico>>,
    mission: Mission,
    next: u16,
}

impl Drive {
    fn new(port: Simulation<EmulatedPico>, number: u32, legs: &[Leg], progress: Progress) -> Self {
        Self {
            client: LinkClient::new(port, number + 1),
            mission: Mission::resume_from(legs.to_vec(), progress),
            next: progress.next,
        }
    }

    /// Drives until so long after the plan was accepted, or to its end; true if it has not ended.
    fn until_after_acceptance(&mut self, moment: Duration) -> bool {
        let mut accepted = None;
        loop {
            let events = self.step();
            let Ok(events) = events else { panic!("{events:?}") };
            let now = self.client.port_mut().now();
            if events.iter().any(|event| matches!(event, MissionEvent::Done(_))) {
                return false;
            }
            if self.mission.has_begun() && now > *accepted.get_or_insert(now) + moment {
                return true;
            }
        }
    }

    /// Resets the chip; how the mission ends.
    fn reset(&mut self, cause: ResetCause) -> MissionError {
        let pico = self.client.port_mut().firmware_mut();
        let done = match cause {
            ResetCause::Panic => pico.inject(Fault::Panic),
            ResetCause::HardFault => pico.inject(Fault::HardFault),
            _ => pico.reset(),
        };
        assert!(done.is_ok(), "{done:?}");
        loop {
            if let Err(error) = self.step() {
                return error;
            }
        }
    }

    fn step(&mut self) -> Result<Vec<MissionEvent>, MissionError> {
        let now = self.client.port_mut().now();
        let events = self.mission.step(&mut self.client, now)?;
        for event in &events {
            if let MissionEvent::LegDone(result) = event {
                assert_eq!(result.index, self.next, "a leg ended twice, or out of order");
                self.next += 1;
            }
        }
        self.client.port_mut().wait(POLL).map_err(LinkError::from)?;
        Ok(events)
    }
}
