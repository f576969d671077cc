//! What a robot says and measures, sighting by sighting, without moving it.
//!
//! ```text
//! telemetry (pose, wheels, state) ┐
//! measurement (counts, battery) ──┴─► sighting
//! ```
//! Telemetry comes by itself; the rest is asked for, at most [`INTERVAL`] apart. Any link may ask, also one
//! that does not own the robot's motion.

use super::parameters::{Answer, Exchange, ParameterError, Request};
use super::{LinkClient, LinkError};
use protocol::message::{Measurement, Telemetry};
use std::io::{Read, Write};
use std::time::Duration;

/// Between two sightings.
pub const INTERVAL: Duration = Duration::from_millis(100);

/// What was seen of a robot at one moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sighting {
    /// What it says.
    pub telemetry: Telemetry,
    /// What it measures.
    pub measurement: Measurement,
}

/// The watch over one robot.
#[derive(Clone, Copy, Debug, Default)]
pub struct Monitor {
    exchange: Option<Exchange>,
    asked: Option<Duration>,
}

impl Monitor {
    /// One step at `now`, to be called every few milliseconds: polls `client`; the next sighting once it is
    /// there.
    ///
    /// # Errors
    /// [`LinkError`] if the link is lost, or the robot does not answer.
    pub fn step<P: Read + Write>(
        &mut self,
        client: &mut LinkClient<P>,
        now: Duration,
    ) -> Result<Option<Sighting>, LinkError> {
        let Some(mut exchange) = self.exchange else {
            client.poll(now)?;
            let due = self.asked.is_none_or(|asked| now.saturating_sub(asked) >= INTERVAL);
            if due && client.telemetry().is_some() {
                self.asked = Some(now);
                self.exchange = Some(Exchange::new(Request::Measure));
            }
            return Ok(None);
        };
        let answer = exchange.step(client, now).map_err(|error| match error {
            ParameterError::Link(error) => error,
            // Nothing was asked of its parameters.
            ParameterError::Refused(_) => LinkError::NoAnswer(INTERVAL),
        })?;
        self.exchange = Some(exchange).filter(|_| answer.is_none());
        Ok(match (answer, client.telemetry()) {
            (Some(Answer::Measured(measurement)), Some(telemetry)) => {
                Some(Sighting { telemetry: *telemetry, measurement })
            }
            _ => None,
        })
    }
}
