//! End-to-end tests of wmr; this library holds what they share.
#![allow(
    clippy::panic,
    clippy::expect_used,
    clippy::unwrap_used,
    reason = "a library of tests fails as tests do"
)]

pub mod damage;
pub mod elf_file;
pub mod elf_resets;
pub mod figures;
pub mod frame_sequence;
pub mod fuzzing;
pub mod fuzzing_host;
pub mod fuzzing_vision;
pub mod hostile;
pub mod link;
pub mod lockstep;
pub mod model;
pub mod monte_carlo;
pub mod occupied;
#[cfg(unix)]
pub mod replug;
pub mod scenarios;
pub mod spun;
pub mod vehicles;
pub mod vision_scores;
pub mod watched;

use hil_sim::base::{BaseParameters, TruePose, WheeledBase};
use hil_sim::in_process::InProcess;
use hil_sim::simulation::{Firmware, Simulation};
use protocol::motion::{Leg, Pose};
use protocol::parameters::Parameters;
use std::time::Duration;
use wmr::link::LinkClient;
use wmr::link::mission::{Mission, MissionError, MissionEvent};

/// How often the host looks at its link.
pub const POLL: Duration = Duration::from_millis(5);

/// The default robot in this process, resting at `start` on an endless floor.
pub fn simulated_robot(start: Pose, seed: u64) -> Simulation<InProcess> {
    let pose =
        TruePose { x: start.x.0.into(), y: start.y.0.into(), heading: start.heading.0.into() };
    let base = WheeledBase::new(BaseParameters::seeded(seed), pose);
    Simulation::new(InProcess::new(Parameters::default(), 1), base, None)
}

/// Drives `legs` on `simulation` for at most `seconds`, and lets `disturb` act at each poll.
///
/// # Errors
/// [`MissionError`] if the mission ended so.
///
/// # Panics
/// If it did not end in time.
pub fn drive<B: Firmware>(
    simulation: Simulation<B>,
    legs: Vec<Leg>,
    start: Pose,
    seconds: u64,
    mut disturb: impl FnMut(&mut LinkClient<Simulation<B>>, &[MissionEvent]),
) -> Result<(Vec<MissionEvent>, Simulation<B>), MissionError> {
    let mut client = LinkClient::new(simulation, 42);
    let mut mission = Mission::new(legs, start);
    let mut events = Vec::new();
    while client.port_mut().now() < Duration::from_secs(seconds) {
        let now = client.port_mut().now();
        let news = mission.step(&mut client, now)?;
        disturb(&mut client, &news);
        events.extend(news);
        if events.iter().any(|event| matches!(event, MissionEvent::Done(_))) {
            return Ok((events, client.into_port()));
        }
        client.port_mut().wait(POLL).map_err(wmr::link::LinkError::from)?;
    }
    panic!("the mission did not end within {seconds} s: {:?}", events.last())
}
