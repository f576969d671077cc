//! `wmr check base`: how a robot's motors and encoders are connected, before its first drive.
//!
//! ```text
//! wheels off the ground ─► each motor a quarter turn ─► what was seen, what was counted ─► wiring ─► again
//! ```
//! A person looks, the robot counts; what follows is kept as parameters. A second turn of each wheel shows
//! that it is right.

use super::args::CheckBaseArgs;
use super::endpoint::Endpoint;
use super::error::{CliError, Exit};
use super::mission::{self, interrupted_error};
use super::output::Output;
use super::params;
use protocol::message::Wheel;
use protocol::parameters::{Parameters, Wiring};
use wmr::document::WiringDocument;
use wmr::link::drive::wait_for;
use wmr::link::parameters::{Answer, Request};
use wmr::link::{LinkClient, LinkError};
use wmr::wiring_check::{Turn, WiringFault, name, wiring};

const INSTRUCTIONS: &str = "\
Put the robot on a block, so that both wheels hang free, and look at it from behind: left is then its left.
Each motor is turned by a quarter turn. Answer what you saw:
  lf  the left wheel, forward      lb  the left wheel, backward
  rf  the right wheel, forward     rb  the right wheel, backward     n  none";

/// What each bit of the wiring means, for people.
const BITS: [(Wiring, &str); 6] = [
    (Wiring::MOTORS_SWAPPED, "the motors are on each other's outputs"),
    (Wiring::ENCODERS_SWAPPED, "the encoders are on each other's inputs"),
    (Wiring::LEFT_MOTOR_REVERSED, "the motor on the left outputs is reversed"),
    (Wiring::RIGHT_MOTOR_REVERSED, "the motor on the right outputs is reversed"),
    (Wiring::LEFT_ENCODER_REVERSED, "the encoder on the left inputs is reversed"),
    (Wiring::RIGHT_ENCODER_REVERSED, "the encoder on the right inputs is reversed"),
];

/// `wmr check base`.
pub(crate) fn base(args: &CheckBaseArgs, output: Output) -> Result<(), CliError> {
    mission::with_robot(&args.port, |client| {
        mission::connect(client)?;
        client.check_protocol()?;
        let old = params::read(client)?;
        output.ask(&format!("{INSTRUCTIONS}\n"));
        let mut bench = Bench { client, output };
        // The old wiring comes back whatever goes wrong.
        let found = match bench.find(&old) {
            Ok(found) => found,
            Err(error) => {
                params::restore(bench.client, old);
                return Err(error);
            }
        };
        if !args.no_save {
            params::keep(bench.client)?;
        }
        let document = WiringDocument { wiring: found.wiring.into(), saved: !args.no_save };
        output.result(&document, &described(found.wiring, !args.no_save))
    })
}

/// The robot on its block, and whoever looks at it.
struct Bench<'a> {
    client: &'a mut LinkClient<Box<dyn Endpoint>>,
    output: Output,
}

impl Bench<'_> {
    /// The robot's parameters with the wiring found, which it has already taken.
    fn find(&mut self, old: &Parameters) -> Result<Parameters, CliError> {
        self.release()?;
        params::set(self.client, Parameters { wiring: Wiring::default(), ..*old })?;
        let mut turns = [Turn { seen: None, counts: [0; 2] }; 2];
        for (turn, outputs) in turns.iter_mut().zip([Wheel::Left, Wheel::Right]) {
            let side = name(outputs);
            self.output.ask(&format!("Press Enter, and the motor on the {side} outputs turns:"));
            self.line()?;
            turn.counts = self.turn(outputs)?;
            turn.seen = self.seen()?;
        }
        let found = Parameters { wiring: wiring(turns)?, ..*old };
        params::set(self.client, found)?;
        self.output.ask("Press Enter, and both wheels turn forward, the left one first:");
        self.line()?;
        for wheel in [Wheel::Left, Wheel::Right] {
            self.confirm(wheel)?;
        }
        Ok(found)
    }

    /// A robot that is stopped turns nothing.
    fn release(&mut self) -> Result<(), CliError> {
        let sent = wait_for(self.client, mission::stop_wanted, |client, now| {
            client.poll(now)?;
            Ok::<_, LinkError>(client.clear().then_some(()))
        })?;
        sent.ok_or_else(|| interrupted_error("nothing has moved"))
    }

    /// Turns a wheel; what was counted.
    fn turn(&mut self, wheel: Wheel) -> Result<[i32; 2], CliError> {
        match params::ask(self.client, Request::Turn(wheel))? {
            Answer::Turned(counts) => Ok(counts),
            _ => Err(CliError::new(Exit::Bug, "bug", "an answer to no question", "report it")),
        }
    }

    /// With the wiring found a wheel must count forward, and only that one.
    fn confirm(&mut self, wheel: Wheel) -> Result<(), CliError> {
        let counts = self.turn(wheel)?;
        let [own, other] = match wheel {
            Wheel::Left => counts,
            Wheel::Right => [counts[1], counts[0]],
        };
        if own > 4 * other.abs() && own > 0 {
            return Ok(());
        }
        let message = format!(
            "with the wiring found the {} wheel counts {own}, and the other one {other}",
            name(wheel)
        );
        let help = "the robot has its old wiring again; hold it still and check once more";
        Err(CliError::new(Exit::Robot, "check.unclear", message, help))
    }

    /// What the person saw, asked for until it is understood.
    fn seen(&mut self) -> Result<Option<(Wheel, bool)>, CliError> {
        loop {
            self.output.ask("Which wheel turned, and which way? lf, lb, rf, rb or n:");
            match self.line()?.to_lowercase().as_str() {
                "lf" => return Ok(Some((Wheel::Left, true))),
                "lb" => return Ok(Some((Wheel::Left, false))),
                "rf" => return Ok(Some((Wheel::Right, true))),
                "rb" => return Ok(Some((Wheel::Right, false))),
                "n" => return Ok(None),
                other => self.output.ask(&format!("{other:?} is not one of them\n")),
            }
        }
    }

    /// A line from the person; the robot rests meanwhile.
    fn line(&self) -> Result<String, CliError> {
        mission::line_of_person(
            "the input ended before both wheels were seen",
            "check in a terminal, or give an answer a line: empty, lf, empty, rf, empty",
        )
    }
}

impl From<WiringFault> for CliError {
    fn from(error: WiringFault) -> Self {
        Self::of(Exit::Robot, "check.wiring", &error)
    }
}

fn described(wiring: Wiring, saved: bool) -> String {
    let notes: Vec<&str> =
        BITS.iter().filter(|(bit, _)| wiring.has(*bit)).map(|(_, note)| *note).collect();
    let notes =
        if notes.is_empty() { "all is connected as drawn".into() } else { notes.join("\n") };
    let kept = if saved { "the robot keeps that" } else { "the robot forgets that without power" };
    format!("{notes}\nboth wheels turn and count forward; {kept}")
}
