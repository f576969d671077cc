//! What else the robot's thread does for people: another port, the robot's numbers, moving while held.

use super::live::Hold;
use super::robot::{RobotThread, stopped};
use super::{lock, robot};
use crate::cli::error::{CliError, Exit};
use crate::cli::params::{self, Change};
use protocol::parameters::{FIELDS, Parameters};
use serde_json::{Value, json};
use tokio::sync::oneshot;
use wmr::document::shortest;
use wmr::legs::from_wire;
use wmr::link::drive::wait_for;
use wmr::link::parameters::{Answer, Exchange, Request};

/// Numbers to change, and where their answer goes.
#[derive(Debug)]
pub(super) struct ParameterTask {
    pub(super) changes: Vec<Change>,
    /// Whether the robot is to keep them when it loses power.
    pub(super) keep: bool,
    pub(super) reply: oneshot::Sender<Result<Value, CliError>>,
}

/// A segment of a held move, metres and radians: the next one follows while it is held.
const HELD_DISTANCE: f64 = 0.2;
const HELD_TURN: f64 = 0.8;

impl RobotThread {
    /// Another robot from now on.
    pub(super) fn connect(&mut self, port: String) {
        self.client = None;
        self.own_parameters = None;
        self.next_try = std::time::Instant::now();
        lock(&self.live).connect_to(&port);
        self.settings.port = port;
    }

    /// Reads or changes the robot's numbers.
    pub(super) fn serve_parameters(&mut self, task: ParameterTask) {
        let answer = self.exchange_parameters(&task.changes, task.keep);
        // A page that has gone needs no answer.
        let _ = task.reply.send(answer.map(|parameters| document(&parameters)));
    }

    fn exchange_parameters(
        &mut self,
        changes: &[Change],
        keep: bool,
    ) -> Result<Parameters, CliError> {
        self.greet(self.controls.stops())?;
        let mut parameters = self.ask_parameters(Request::Read)?;
        if !changes.is_empty() {
            let wanted = params::changed(parameters, changes);
            parameters = self.ask_parameters(Request::Change(wanted))?;
            // A simulated robot is another one for each drive.
            self.own_parameters = Some(parameters);
            if keep {
                self.ask(Request::Keep)?;
            }
        }
        Ok(parameters)
    }

    pub(super) fn ask_parameters(&mut self, request: Request) -> Result<Parameters, CliError> {
        match self.ask(request)? {
            Answer::Parameters(parameters) => Ok(parameters),
            Answer::Kept | Answer::Identity(_) | Answer::Turned(_) | Answer::Measured(_) => {
                Err(CliError::new(Exit::Bug, "bug", "an answer to no question", "report it"))
            }
        }
    }

    pub(super) fn ask(&mut self, request: Request) -> Result<Answer, CliError> {
        let (controls, stops) = (&self.controls, self.controls.stops());
        let Some(client) = &mut self.client else { return Err(robot::no_link()) };
        let mut exchange = Exchange::new(request);
        let answer = wait_for(
            client,
            || controls.stops() != stops || controls.has_ended(),
            |client, now| exchange.step(client, now),
        )?;
        answer.ok_or_else(stopped)
    }

    /// Moves from where the robot stands for as long as somebody holds a button, and stops then.
    pub(super) fn move_held(&mut self, hold: Hold, stops: u64) -> Result<(), CliError> {
        let (distance, turn) = match hold {
            Hold::Ahead => (HELD_DISTANCE, 0.0),
            Hold::Back => (-HELD_DISTANCE, 0.0),
            Hold::Left => (0.0, HELD_TURN),
            Hold::Right => (0.0, -HELD_TURN),
        };
        self.deadman = Some(hold);
        let mut result = Ok(());
        while result.is_ok() && self.controls.is_held(hold) {
            result = self.move_by(distance, turn, stops);
        }
        self.deadman = None;
        let is_let_go = !self.controls.is_held(hold) && self.controls.stops() == stops;
        match result {
            Err(error) if error.code == "robot.stopped" && is_let_go => Ok(()),
            other => other,
        }
    }

    /// The robot's place as it believes it, for a move from there.
    pub(super) fn place(&self) -> Option<wmr::geometry::Pose> {
        lock(&self.live).telemetry.map(|telemetry| from_wire(telemetry.pose))
    }
}

/// The robot's numbers with their units and ranges.
fn document(parameters: &Parameters) -> Value {
    let number = |(field, value): (&protocol::parameters::Field, f32)| {
        json!({
            "name": field.name, "unit": field.unit, "value": shortest(value),
            "least": shortest(field.least), "most": shortest(field.most),
        })
    };
    let numbers: Vec<Value> = FIELDS.iter().zip(parameters.values()).map(number).collect();
    json!({"parameters": numbers, "calibration": parameters.calibration})
}
