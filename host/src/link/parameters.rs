//! Questions to a robot over the link: its numbers (read them, change them, have them kept in its flash),
//! who it is, and what happens when one of its wheels is turned.
//!
//! ```text
//! request ─► command ═link═ report ─► answer
//! ```
//! One request at a time, over a [`LinkClient`]; the robot takes changes only at rest. What it refuses it
//! refuses as a whole, and nothing has changed then.

use super::{LinkClient, LinkError};
use protocol::message::{Command, Identity, Measurement, Report, Wheel};
use protocol::parameters::{FIELDS, ParameterRefusal, Parameters};
use std::io::{Read, Write};
use std::time::Duration;

/// A robot that is heard answers within this long; a flash page takes 0.4 s at worst.
const ANSWER_TIMEOUT: Duration = Duration::from_secs(3);

/// What is asked of the robot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Request {
    /// Its numbers.
    Read,
    /// To take other numbers, until it loses power.
    Change(Parameters),
    /// To keep its numbers when it loses power.
    Keep,
    /// Which robot it is.
    Identify,
    /// To turn one wheel a little.
    Turn(Wheel),
    /// What it measures.
    Measure,
}

/// What the robot answers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Answer {
    /// Its numbers, after a change the new ones.
    Parameters(Parameters),
    /// They are in its flash.
    Kept,
    /// Which robot it is.
    Identity(Identity),
    /// A wheel has turned; how far each encoder went on.
    Turned([i32; 2]),
    /// What it measures.
    Measured(Measurement),
}

/// Why there is no answer.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum ParameterError {
    /// The link failed.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Link(#[from] LinkError),
    /// The robot refused.
    #[error("the robot keeps its numbers: {}", describe(.0))]
    #[diagnostic(help("{}", remedy(.0)))]
    Refused(ParameterRefusal),
}

/// One request on its way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Exchange {
    request: Request,
    /// For how long the robot had been heard when the request was sent.
    sent: Option<Duration>,
}

impl Exchange {
    /// Begins `request`.
    pub fn new(request: Request) -> Self {
        Self { request, sent: None }
    }

    /// One step at `now`, to be called every few milliseconds: polls `client`; the answer once it is
    /// there.
    ///
    /// # Errors
    /// [`ParameterError`]; nothing has changed if the robot refused.
    pub fn step<P: Read + Write>(
        &mut self,
        client: &mut LinkClient<P>,
        now: Duration,
    ) -> Result<Option<Answer>, ParameterError> {
        let reports = client.poll(now)?;
        client.check_protocol()?;
        let mut answers = reports.iter().filter_map(|report| self.answer(report));
        if let Some(answer) = answers.next() {
            return answer.map(Some).map_err(ParameterError::Refused);
        }
        let heard = client.heard();
        match self.sent {
            Some(sent) if heard.saturating_sub(sent) > ANSWER_TIMEOUT => {
                return Err(LinkError::NoAnswer(ANSWER_TIMEOUT).into());
            }
            Some(_) => {}
            None => self.sent = client.send(self.command()).then_some(heard),
        }
        Ok(None)
    }

    fn command(&self) -> Command {
        match self.request {
            Request::Read => Command::GetParameters,
            Request::Change(parameters) => Command::SetParameters(parameters),
            Request::Keep => Command::SaveParameters,
            Request::Identify => Command::Identify,
            Request::Turn(wheel) => Command::TurnWheel { wheel },
            Request::Measure => Command::Measure,
        }
    }

    fn answer(&self, report: &Report) -> Option<Result<Answer, ParameterRefusal>> {
        match (self.request, report) {
            _ if self.sent.is_none() => None,
            (Request::Read | Request::Change(_), Report::Parameters(parameters)) => {
                Some(Ok(Answer::Parameters(*parameters)))
            }
            (Request::Keep, Report::ParametersSaved { .. }) => Some(Ok(Answer::Kept)),
            (Request::Identify, Report::Identity(identity)) => {
                Some(Ok(Answer::Identity(*identity)))
            }
            (Request::Turn(_), Report::WheelTurned { counts }) => Some(Ok(Answer::Turned(*counts))),
            (Request::Measure, Report::Measured(measurement)) => {
                Some(Ok(Answer::Measured(*measurement)))
            }
            (
                Request::Read | Request::Change(_) | Request::Keep,
                Report::ParametersRefused(refusal),
            ) => Some(Err(*refusal)),
            _ => None,
        }
    }
}

/// A refusal in words.
pub fn describe(refusal: &ParameterRefusal) -> String {
    match refusal {
        ParameterRefusal::OutOfRange { field, value } => {
            FIELDS.get(usize::from(*field)).map_or_else(
                || format!("{value} is out of range"),
                |field| {
                    let (name, least, most) = (field.name, field.least, field.most);
                    format!("{name} is {value}, and must be from {least} to {most} {}", field.unit)
                },
            )
        }
        ParameterRefusal::TooFast => {
            "the motors cannot turn the wheels that fast"
                .into()
        }
        ParameterRefusal::BatteryLevels => {
            "the battery's levels must fall from battery-warn over battery-derate to battery-stop"
                .into()
        }
        ParameterRefusal::UnstableWheels => {
            "the wheels would swing by themselves: lower velocity-gain or angle-gain, or see that no-load-speed and time-constant are this motor's".into()
        }
        ParameterRefusal::UnstableTracker => {
            "the robot would swing about its path: lower across-gain or speed, or raise heading-gain (heading-gain > 0.6 * speed * square root of across-gain, across-gain * speed^2 <= 400)".into()
        }
        ParameterRefusal::NotAtRest => "it drives, or waits on its way".into(),
        ParameterRefusal::NotOwner => "another link drives it".into(),
        ParameterRefusal::NotStored => "its flash does not hold what was written".into(),
    }
}

/// What to do about a refusal.
fn remedy(refusal: &ParameterRefusal) -> &'static str {
    match refusal {
        ParameterRefusal::TooFast => "lower speed, or raise no-load-speed",
        ParameterRefusal::NotAtRest => "stop it with wmr stop",
        ParameterRefusal::NotOwner => "disconnect that one",
        ParameterRefusal::NotStored => "try again, or replace the board",
        ParameterRefusal::OutOfRange { .. }
        | ParameterRefusal::BatteryLevels
        | ParameterRefusal::UnstableWheels
        | ParameterRefusal::UnstableTracker => {
            "nothing has changed; wmr params shows all numbers and their ranges"
        }
    }
}
