//! What the fuzz target `hostile_robot` runs: the host's link against a robot that says whatever the bytes
//! say, in virtual time.
//!
//! The robot keeps a session, so that its reports reach the mission and not only the decoder; besides it
//! writes raw bytes, greets as another, falls silent and lets its clock run as it likes. Promised are: no
//! panic, an end within the budget, and no arrival that the robot has not reported leg by leg and then shown.

use fuzzed::Fuzzed;
use protocol::message::State;
use protocol::motion::Pose;
use std::time::Duration;
use wmr::link::LinkClient;
use wmr::link::drive::{TimedPort, drive};
use wmr::link::mission::Mission;

mod fuzzed;

use crate::link::straight_legs;

/// Two legs of 0.5 m, each with 30 s of waiting at most, by a robot's clock that runs at a twentieth of the
/// host's: slower ones are refused.
const BUDGET: Duration = Duration::from_secs(2000);
const LEGS: u16 = 2;
const PLAN: u32 = 3;
const ORIGIN: Pose = Pose::new(0.0, 0.0, 0.0);

/// Drives two legs on a robot that does what `data` says, over and over.
///
/// # Panics
/// If a promise is broken.
pub fn hostile_robot(data: &[u8]) {
    let [stop, data @ ..] = data else { return };
    // The user may lose patience.
    let stop_at = (*stop < 128).then(|| Duration::from_millis(u64::from(*stop) * 100));
    let mut client = LinkClient::new(Fuzzed::new(data, BUDGET), 42);
    let mut mission = Mission::new(straight_legs(PLAN, LEGS, 0.5), ORIGIN);
    let clock = client.port_mut().clock();
    let stop_asked = || stop_at.is_some_and(|at| clock.get() >= at);
    let end = drive(&mut client, &mut mission, stop_asked, |_, _| {});
    let port = client.port_mut();
    if let (Some(at), true) = (stop_at, end.is_err()) {
        assert!(
            port.now() < at + Duration::from_secs(5),
            "{:?} after a stop at {at:?}",
            port.now()
        );
    }
    let Ok(pose) = end else { return };
    assert_eq!(port.reported, LEGS, "an arrival without its legs");
    let Some(shown) = port.shown else { panic!("an arrival that was not shown") };
    let off = (shown.pose.x.0 - pose.x.0).hypot(shown.pose.y.0 - pose.y.0);
    let speed = shown.wheels.left.0.abs().max(shown.wheels.right.0.abs());
    assert!(shown.state == State::Idle && speed < 0.11 && off < 0.021, "{shown:?} {pose:?}");
}
