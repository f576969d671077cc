//! Whether a robot that talks also gets on.
//!
//! A link that is silent or deaf ends by itself. A robot that is heard, acknowledges and yet never
//! reports is found out here, by what it says of itself in telemetry: it rests though it has a plan,
//! a leg takes far longer than planned, an answer does not come, its clock stands still.
//!
//! Time is the robot's own, control ticks, so that a simulation slower than the clock on the wall is
//! not taken for a robot that has given up. Only for the robot's clock itself the host's time counts,
//! and of that only the part in which the robot was heard.

use super::{LinkError, MissionError};
use protocol::message::{State, Telemetry};
use protocol::motion::{Limits, TICK_MILLISECONDS};
use std::time::Duration;

/// A robot that has a plan and says that it rests is believed after this long, 2 s in ticks: on a bad
/// wire the report that explains it may have to be sent many times.
const REST_TICKS: u32 = 400;
/// A pause that nobody asked for ends by a word of the host, within this long, 3 s in ticks.
const PAUSE_TICKS: u32 = 600;
/// All rest and pauses on one leg together may take so long, 30 s in ticks: a robot that drives a little now
/// and then does not get on either.
const HELD_TICKS: u32 = 6000;
/// What is acknowledged is answered within this long, 3 s in ticks.
const ANSWER_TICKS: u32 = 600;
/// Beyond what braking takes, a robot comes to rest within this long, 3 s in ticks.
const HALT_TICKS: u32 = 600;
/// A leg may take so much longer than planned: a weak battery drives at 0.6 of the pace.
const LATE_FACTOR: f32 = 1.7;
/// And this much more, 2 s in ticks, for what a leg begins and ends with.
const LATE_TICKS: u32 = 400;
/// Between two words of a robot nobody knows what it did, so no more than this counts, 0.5 s in ticks.
const LONGEST_STEP: u32 = 100;
/// The robot's clock is looked at this often, in time in which the robot is heard.
const CLOCK_WINDOW: Duration = Duration::from_secs(3);
/// It must have gone on by this much: a twentieth of real time, slower than any simulation of use.
const LEAST_TICKS: u32 = CLOCK_WINDOW.as_millis() as u32 / TICK_MILLISECONDS / 20;

/// What a mission waits for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Awaited {
    /// An answer to what was sent last, counted from when it was acknowledged.
    Answer,
    /// That the robot comes to rest, which may take `braking` ticks.
    Rest { braking: u32 },
    /// That a leg of so many ticks ends.
    Leg { next: u16, planned: u32 },
    /// That telemetry agrees with the end that was reported.
    Agreement,
}

/// The watch over one mission.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Watch {
    awaited: Option<Awaited>,
    ticks: Option<u32>,
    waited: u32,
    resting: u32,
    paused: u32,
    driven: u32,
    held: u32,
    window: Option<(Duration, Option<u32>)>,
}

impl Watch {
    /// Takes in the robot's last word, after `heard` of being heard; `busy` says that the wire still
    /// carries what the robot would have to answer, `pause_wanted` that the host holds it.
    ///
    /// # Errors
    /// [`MissionError`] if the robot does not get on.
    pub(super) fn observe(
        &mut self,
        awaited: Awaited,
        telemetry: Option<&Telemetry>,
        heard: Duration,
        (busy, pause_wanted): (bool, bool),
    ) -> Result<(), MissionError> {
        self.watch_clock(telemetry.map(|last| last.ticks), heard)?;
        if self.awaited != Some(awaited) {
            *self = Self {
                awaited: Some(awaited),
                ticks: self.ticks,
                window: self.window,
                ..Self::default()
            };
        }
        let Some(telemetry) = telemetry else { return Ok(()) };
        let since = self.ticks.replace(telemetry.ticks).unwrap_or(telemetry.ticks);
        let step = telemetry.ticks.wrapping_sub(since).min(LONGEST_STEP);
        // A camera's poses keep the wire busy again and again: that must not restart the wait.
        self.waited += if busy { 0 } else { step };
        match awaited {
            Awaited::Answer if self.waited > ANSWER_TICKS => {
                Err(LinkError::NoAnswer(duration(self.waited)).into())
            }
            Awaited::Rest { braking } if self.waited > braking + HALT_TICKS => {
                Err(MissionError::NeverRests(duration(self.waited)))
            }
            Awaited::Leg { next, planned } => {
                self.count(telemetry.state, step, busy, pause_wanted);
                self.judge_leg(telemetry.state, next, planned)
            }
            Awaited::Agreement if self.waited > REST_TICKS => {
                Err(MissionError::Disagrees { pose: telemetry.pose, state: telemetry.state })
            }
            Awaited::Answer | Awaited::Rest { .. } | Awaited::Agreement => Ok(()),
        }
    }

    fn count(&mut self, state: State, step: u32, busy: bool, pause_wanted: bool) {
        let [mut resting, mut paused] = [0, 0];
        match state {
            State::Driving => self.driven += step,
            State::Paused(_) if pause_wanted => {}
            State::Paused(_) => {
                paused = self.paused + step;
                self.held += step;
            }
            State::Idle | State::Stopped | State::Faulted(_) if busy => resting = self.resting,
            State::Idle | State::Stopped | State::Faulted(_) => {
                resting = self.resting + step;
                self.held += step;
            }
        }
        (self.resting, self.paused) = (resting, paused);
    }

    fn judge_leg(&self, state: State, leg: u16, planned: u32) -> Result<(), MissionError> {
        if self.resting > REST_TICKS {
            return Err(match state {
                State::Faulted(fault) => MissionError::Fault { fault, wheel: None },
                State::Stopped => MissionError::Stopped,
                state => MissionError::NotDriving { state, since: duration(self.resting) },
            });
        }
        if self.paused > PAUSE_TICKS {
            return Err(MissionError::NotDriving { state, since: duration(self.paused) });
        }
        if self.held > HELD_TICKS {
            return Err(MissionError::NotDriving { state, since: duration(self.held) });
        }
        let most = (planned as f32 * LATE_FACTOR) as u32 + LATE_TICKS;
        if self.driven > most {
            let [planned, driven] = [planned, self.driven].map(duration);
            return Err(MissionError::Late { leg, planned, driven });
        }
        Ok(())
    }

    fn watch_clock(&mut self, ticks: Option<u32>, heard: Duration) -> Result<(), LinkError> {
        let (since, before) = *self.window.get_or_insert((heard, ticks));
        if heard.saturating_sub(since) < CLOCK_WINDOW {
            return Ok(());
        }
        self.window = Some((heard, ticks));
        match (before, ticks) {
            (_, None) => Err(LinkError::NoTelemetry(CLOCK_WINDOW)),
            (Some(before), Some(ticks)) if ticks.wrapping_sub(before) < LEAST_TICKS => {
                Err(LinkError::ClockStopped(CLOCK_WINDOW))
            }
            _ => Ok(()),
        }
    }
}

/// How long braking from full speed takes, ticks.
pub(super) fn braking_ticks(limits: &Limits) -> u32 {
    (limits.speed.0 / limits.acceleration.0 * 1000.0) as u32 / TICK_MILLISECONDS
}

fn duration(ticks: u32) -> Duration {
    Duration::from_millis(u64::from(ticks) * u64::from(TICK_MILLISECONDS))
}

#[cfg(test)]
mod tests {
    use super::*;
    use protocol::message::{Fault, PauseReason};
    use protocol::motion::{Pose, WheelSpeeds};

    const LEG: Awaited = Awaited::Leg { next: 1, planned: 1000 };
    const STEP: u32 = 4;

    fn said(ticks: u32, state: State) -> Telemetry {
        Telemetry { ticks, pose: Pose::default(), wheels: WheelSpeeds::default(), state, leg: 1 }
    }

    /// After how many ticks of `state` a watch over `awaited` gives up, and why; at most a minute.
    fn patience(
        awaited: Awaited,
        state: State,
        flags: (bool, bool),
    ) -> Option<(u32, MissionError)> {
        let mut watch = Watch::default();
        (0..12_000 / STEP).find_map(|n| {
            let ticks = u32::MAX - 100;
            let telemetry = said(ticks.wrapping_add(n * STEP), state);
            let heard = duration(n * STEP);
            watch
                .observe(awaited, Some(&telemetry), heard, flags)
                .err()
                .map(|error| (n * STEP, error))
        })
    }

    #[test]
    fn a_leg_may_take_its_time_and_not_for_ever() {
        let (ticks, error) = patience(LEG, State::Driving, (false, false)).unwrap();
        assert_eq!(ticks, 1700 + 400 + STEP);
        assert!(matches!(error, MissionError::Late { leg: 1, .. }), "{error}");
        let busy = patience(LEG, State::Driving, (true, false)).unwrap();
        assert_eq!(busy.0, ticks, "what else is on the wire does not matter to a leg");
    }

    #[test]
    fn a_robot_that_says_that_it_does_not_drive_is_believed() {
        let end = |state| patience(LEG, state, (false, false)).unwrap();
        let (ticks, error) = end(State::Idle);
        assert_eq!(ticks, REST_TICKS + STEP);
        assert!(matches!(error, MissionError::NotDriving { state: State::Idle, .. }), "{error}");
        assert!(matches!(end(State::Stopped).1, MissionError::Stopped));
        let fault = end(State::Faulted(Fault::Stall)).1;
        assert!(matches!(fault, MissionError::Fault { fault: Fault::Stall, .. }), "{fault}");
        let (ticks, _) = end(State::Paused(PauseReason::Silence));
        assert_eq!(ticks, PAUSE_TICKS + STEP);
    }

    #[test]
    fn what_the_host_waits_for_itself_is_no_fault_of_the_robot() {
        let held = State::Paused(PauseReason::Command);
        assert!(patience(LEG, held, (false, true)).is_none(), "the user holds it");
        assert!(patience(LEG, State::Idle, (true, false)).is_none(), "legs are on their way");
        assert!(patience(Awaited::Answer, State::Idle, (true, false)).is_none());
    }

    #[test]
    fn a_robot_that_drives_now_and_then_is_not_waited_for_for_ever() {
        let mut watch = Watch::default();
        let end = (0..100_000).find_map(|n| {
            let state =
                if n % 100 == 0 { State::Driving } else { State::Paused(PauseReason::Silence) };
            let telemetry = said(n * STEP, state);
            watch.observe(LEG, Some(&telemetry), duration(n * STEP), (false, false)).err()
        });
        let Some(MissionError::NotDriving { since, .. }) = end else { panic!("{end:?}") };
        assert_eq!(since, duration(HELD_TICKS + STEP));
    }

    #[test]
    fn answers_rest_and_agreement_are_waited_for_so_long() {
        let end = |awaited| patience(awaited, State::Stopped, (false, false)).unwrap();
        assert_eq!(end(Awaited::Answer).0, ANSWER_TICKS + STEP);
        assert_eq!(end(Awaited::Rest { braking: 100 }).0, 100 + HALT_TICKS + STEP);
        let (ticks, error) = end(Awaited::Agreement);
        assert_eq!(ticks, REST_TICKS + STEP);
        assert!(matches!(error, MissionError::Disagrees { .. }), "{error}");
    }

    #[test]
    fn a_clock_that_stands_still_is_noticed_while_the_robot_is_heard() {
        let mut watch = Watch::default();
        let mut at = |heard, ticks| {
            let telemetry = said(ticks, State::Driving);
            watch.observe(LEG, Some(&telemetry), Duration::from_secs(heard), (false, false))
        };
        assert!(at(0, 7).is_ok() && at(2, 7).is_ok());
        assert!(at(3, 7 + LEAST_TICKS).is_ok(), "slow, but it goes");
        let error = at(6, 8 + LEAST_TICKS).unwrap_err();
        assert!(matches!(error, MissionError::Link(LinkError::ClockStopped(_))), "{error}");
        let mut silent = Watch::default();
        assert!(silent.observe(LEG, None, Duration::ZERO, (false, false)).is_ok());
        let error = silent.observe(LEG, None, CLOCK_WINDOW, (false, false)).unwrap_err();
        assert!(matches!(error, MissionError::Link(LinkError::NoTelemetry(_))), "{error}");
    }

    #[test]
    fn a_robot_that_gets_on_is_given_its_time_anew() {
        let mut watch = Watch::default();
        for n in 0..3000 {
            let awaited = Awaited::Leg { next: (n / 500) as u16, planned: 1000 };
            let telemetry = said(n * STEP, State::Driving);
            let heard = duration(n * STEP);
            watch.observe(awaited, Some(&telemetry), heard, (false, false)).unwrap();
        }
    }
}
