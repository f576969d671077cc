//! The request that must get through: a stop, said again and again until the robot echoes its number.

use protocol::message::{Command, HEARTBEAT_MILLISECONDS};
use protocol::units::Milliseconds;

/// The host's last stop.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct StopRequest {
    number: u8,
    manner: Manner,
    pending: bool,
    /// When it was first said, and when last.
    said: Option<(Milliseconds, Milliseconds)>,
}

/// How the robot is to stop; the later is the stronger.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Manner {
    /// On its path, within its limits.
    #[default]
    OnPath,
    /// At once, by cutting the drive.
    Cut,
}

impl StopRequest {
    /// Asks for a stop, unless one at least as strong is being asked for.
    pub(super) fn ask(&mut self, manner: Manner) {
        if !self.pending || self.manner < manner {
            self.number = self.number.wrapping_add(1);
            *self = Self { number: self.number, manner, pending: true, said: None };
        }
    }

    /// The number of the last stop, 0 for none.
    pub(super) fn number(&self) -> u8 {
        self.number
    }

    /// Whether the robot has heard of the last stop, if there was one.
    pub(super) fn is_heard(&self) -> bool {
        !self.pending
    }

    /// Takes in which stop the robot has heard of.
    pub(super) fn hear(&mut self, number: u8) {
        self.pending &= number != self.number;
    }

    /// How long the robot has not echoed a stop, milliseconds.
    pub(super) fn wait(&self, now: Milliseconds) -> u32 {
        self.said.filter(|_| self.pending).map_or(0, |(first, _)| now.since(first))
    }

    /// What is to be said `now`, if it is time to say it.
    pub(super) fn due(&mut self, now: Milliseconds) -> Option<Command> {
        let first = self.said.map_or(now, |(first, _)| first);
        let rests = |(_, last)| now.since(last) < HEARTBEAT_MILLISECONDS;
        if !self.pending || self.said.is_some_and(rests) {
            return None;
        }
        self.said = Some((first, now));
        let number = self.number;
        Some(match self.manner {
            Manner::OnPath => Command::Stop { number },
            Manner::Cut => Command::EmergencyStop { number },
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stop_is_said_every_20_ms_until_its_echo() {
        let mut stop = StopRequest::default();
        assert_eq!(stop.due(Milliseconds(0)), None);
        stop.ask(Manner::OnPath);
        assert_eq!(stop.due(Milliseconds(5)), Some(Command::Stop { number: 1 }));
        assert_eq!(stop.due(Milliseconds(24)), None);
        assert_eq!(stop.due(Milliseconds(25)), Some(Command::Stop { number: 1 }));
        assert_eq!(stop.wait(Milliseconds(30)), 25);
        stop.hear(0);
        assert!(!stop.is_heard());
        stop.hear(1);
        assert_eq!((stop.is_heard(), stop.due(Milliseconds(99)), stop.number()), (true, None, 1));
    }

    #[test]
    fn only_a_stronger_stop_takes_the_place_of_one() {
        let mut stop = StopRequest::default();
        stop.ask(Manner::OnPath);
        stop.ask(Manner::OnPath);
        assert_eq!(stop.due(Milliseconds(0)), Some(Command::Stop { number: 1 }));
        stop.ask(Manner::Cut);
        assert_eq!(stop.due(Milliseconds(1)), Some(Command::EmergencyStop { number: 2 }));
        stop.ask(Manner::OnPath);
        stop.hear(1);
        assert_eq!(stop.due(Milliseconds(30)), Some(Command::EmergencyStop { number: 2 }));
    }
}
