//! Whether the end that a robot reports is the end that it shows.
//!
//! A mission has arrived where three witnesses agree: each leg has ended in its turn, the plan's end
//! was reported behind the last of them, and the robot's next words show it idle, at rest, at the place
//! reported. The robot's own odometry is behind all three, so they do not prove where it is; what they
//! exclude is an end that was never driven. Metres, radians and control ticks.

use super::MissionError;
use super::error::Impossible;
use protocol::message::{State, Telemetry};
use protocol::motion::{Pose, TICK_MILLISECONDS};
use protocol::units::Radians;
use std::time::Duration;

/// Between the report and the telemetry a robot at rest moves less than this: 10 mm of coasting, and as
/// much again for a camera that corrects it then.
const SAME_PLACE: f32 = 0.02;
/// And turns less than this: 3 deg.
const SAME_HEADING: f32 = 0.05;
/// A wheel slower than this rests: the speed of a resting encoder that flickers, rad/s.
const REST_SPEED: f32 = 0.1;
/// The robot's clock is read from telemetry, which may be older than a report by so many ticks: 0.5 s.
const CLOCK_SLACK: u64 = 100;

/// The ends of legs that were reported.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Arrival {
    ticks: u64,
    end: Option<Pose>,
}

impl Arrival {
    /// Takes in that leg `leg` of `of` took `ticks`; false if that is known already. Of a plan that was
    /// `taken_up`, ends may have been reported to the host before.
    ///
    /// # Errors
    /// [`Impossible::Leg`] if it is not the turn of that leg.
    pub(super) fn end_leg(
        &mut self,
        leg: u16,
        (next, of): (u16, usize),
        ticks: u32,
        taken_up: bool,
    ) -> Result<bool, Impossible> {
        if leg < next {
            return Ok(false);
        }
        if (leg > next && !taken_up) || usize::from(leg) >= of {
            return Err(Impossible::Leg { leg, next, of });
        }
        self.ticks += u64::from(ticks);
        Ok(true)
    }

    /// Takes in that the plan has ended at `pose`.
    pub(super) fn end_plan(&mut self, pose: Pose) {
        self.end = Some(pose);
    }

    /// The end that was reported and not yet seen.
    pub(super) fn awaited(&self) -> Option<Pose> {
        self.end
    }

    /// The end, once `telemetry` shows it; `since` is the robot's clock when it took the plan, if it took
    /// it from this mission.
    ///
    /// # Errors
    /// If the legs took longer than there was time.
    pub(super) fn confirm(
        &mut self,
        telemetry: &Telemetry,
        since: Option<u32>,
    ) -> Result<Option<Pose>, MissionError> {
        let Some(end) = self.end.filter(|end| shows(telemetry, *end)) else { return Ok(None) };
        if let Some(since) = since {
            let passed = u64::from(telemetry.ticks.wrapping_sub(since));
            if self.ticks > passed + CLOCK_SLACK {
                let [legs, since] = [self.ticks, passed]
                    .map(|ticks| Duration::from_millis(ticks * u64::from(TICK_MILLISECONDS)));
                return Err(MissionError::Impossible(Impossible::Time { legs, since }));
            }
        }
        self.end = None;
        Ok(Some(end))
    }
}

/// Whether the robot says that it rests at `end`.
fn shows(telemetry: &Telemetry, end: Pose) -> bool {
    let pose = telemetry.pose;
    let distance = (pose.x.0 - end.x.0).hypot(pose.y.0 - end.y.0);
    let rest = [telemetry.wheels.left, telemetry.wheels.right];
    // What is not a number is no place: every comparison with it is false.
    telemetry.state == State::Idle
        && rest.iter().all(|speed| speed.0.abs() < REST_SPEED)
        && distance < SAME_PLACE
        && Radians(pose.heading.0 - end.heading.0).wrapped().0.abs() < SAME_HEADING
}

#[cfg(test)]
mod tests {
    use super::*;
    use protocol::motion::WheelSpeeds;
    use protocol::units::RadiansPerSecond;

    const END: Pose = Pose::new(1.4, 1.75, 3.1);

    fn seen(pose: Pose, state: State, speed: f32) -> Telemetry {
        let [left, right] = [0.0, speed].map(RadiansPerSecond);
        Telemetry { ticks: 2100, pose, wheels: WheelSpeeds { left, right }, state, leg: 2 }
    }

    fn confirmed(telemetry: &Telemetry) -> bool {
        let mut arrival = Arrival::default();
        arrival.end_plan(END);
        arrival.confirm(telemetry, Some(100)).unwrap().is_some()
    }

    #[test]
    fn only_a_robot_that_rests_where_it_said_has_arrived() {
        let near = Pose::new(1.405, 1.745, -3.16);
        assert!(confirmed(&seen(near, State::Idle, 0.05)));
        assert!(!confirmed(&seen(near, State::Driving, 0.0)));
        assert!(!confirmed(&seen(near, State::Idle, 0.5)), "it rolls");
        assert!(!confirmed(&seen(Pose::new(1.4, 0.35, 3.1), State::Idle, 0.0)), "it is elsewhere");
        assert!(
            !confirmed(&seen(Pose::new(1.4, 1.75, 2.9), State::Idle, 0.0)),
            "it looks elsewhere"
        );
        let nowhere = Pose::new(f32::NAN, 0.0, 0.0);
        let mut arrival = Arrival::default();
        arrival.end_plan(nowhere);
        assert!(matches!(arrival.confirm(&seen(nowhere, State::Idle, 0.0), None), Ok(None)));
    }

    #[test]
    fn legs_end_one_after_the_other() {
        let mut arrival = Arrival::default();
        assert_eq!(arrival.end_leg(0, (0, 3), 400, false), Ok(true));
        assert_eq!(arrival.end_leg(0, (1, 3), 400, false), Ok(false), "said again");
        assert_eq!(
            arrival.end_leg(2, (1, 3), 400, false),
            Err(Impossible::Leg { leg: 2, next: 1, of: 3 })
        );
        assert_eq!(arrival.end_leg(2, (1, 3), 400, true), Ok(true), "leg 1 was reported before");
        let last = arrival.end_leg(u16::MAX, (u16::MAX, 3), 400, false);
        assert!(matches!(last, Err(Impossible::Leg { leg: u16::MAX, .. })), "{last:?}");
    }

    #[test]
    fn legs_take_no_longer_than_the_robots_clock_went_on() {
        let at_end = seen(END, State::Idle, 0.0);
        for (ticks, possible) in [(2000, true), (2200, false), (u32::MAX, false)] {
            let mut arrival = Arrival::default();
            arrival.end_leg(0, (0, 2), ticks, false).unwrap();
            arrival.end_leg(1, (1, 2), 0, false).unwrap();
            arrival.end_plan(END);
            assert_eq!(arrival.confirm(&at_end, Some(100)).is_ok(), possible, "{ticks}");
            assert!(arrival.confirm(&at_end, None).is_ok(), "begun before this mission");
        }
    }
}
