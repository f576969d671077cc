//! What a person lets go wrong with a simulated robot, also while it drives.

use super::error::Failure;
use super::lock;
use crate::cli::endpoint::Stage;
use hil_sim::base::{self, EncoderFault};
use hil_sim::camera::CameraFaults;
use hil_sim::wire;
use serde::{Deserialize, Serialize};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex};
use std::time::Duration;

/// Faults of the base, of both wires and of the camera; nothing by default. Left and right.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields, default)]
pub(super) struct SimulatedFaults {
    /// The share of each rim's travel that slips, 0..=0.9.
    slip: [f64; 2],
    blocked: [bool; 2],
    encoders: [EncoderName; 2],
    /// Probability that a frame is lost, 0..=1.
    loss: f64,
    /// Probability that a frame is damaged, 0..=1.
    corruption: f64,
    /// How long a frame takes, seconds, 0..=1.
    latency: f64,
    camera: CameraName,
}

/// What is wrong with the simulated camera.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "lowercase")]
enum CameraName {
    #[default]
    Sees,
    Dark,
    Frozen,
    Moved,
    Silent,
}

/// Somebody has bumped against the camera: metres in the arena, radians about its axes.
const BUMPED: [[f64; 3]; 2] = [[0.04, 0.02, 0.0], [0.0, 0.03, 0.02]];

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "lowercase")]
enum EncoderName {
    #[default]
    Counts,
    Stuck,
    Reversed,
}

impl SimulatedFaults {
    /// Checks what a page has sent.
    pub(super) fn check(&self) -> Result<(), Failure> {
        let ranges = [
            ("slip", self.slip[0], 0.9),
            ("slip", self.slip[1], 0.9),
            ("loss", self.loss, 1.0),
            ("corruption", self.corruption, 1.0),
            ("latency", self.latency, 1.0),
        ];
        match ranges.iter().find(|(_, value, most)| !(0.0..=*most).contains(value)) {
            Some((name, value, most)) => Err(Failure::bad_request(format!(
                "a {name} of {value} is not possible; 0 to {most}"
            ))),
            None => Ok(()),
        }
    }

    fn base(&self) -> base::Faults {
        let encoder = |name: EncoderName| match name {
            EncoderName::Counts => EncoderFault::None,
            EncoderName::Stuck => EncoderFault::Stuck,
            EncoderName::Reversed => EncoderFault::Reversed,
        };
        let encoders = self.encoders.map(encoder);
        base::Faults { slip: self.slip, blocked: self.blocked, encoders, ..base::Faults::default() }
    }

    fn camera(&self) -> CameraFaults {
        let none = CameraFaults::default();
        match self.camera {
            CameraName::Sees => none,
            CameraName::Dark => CameraFaults { dark: true, ..none },
            CameraName::Frozen => CameraFaults { frozen: true, ..none },
            CameraName::Moved => CameraFaults { moved: Some(BUMPED), ..none },
            CameraName::Silent => CameraFaults { lost: 1.0, ..none },
        }
    }

    fn wire(&self) -> (wire::Faults, wire::Pace) {
        let latency = Duration::from_secs_f64(self.latency);
        let faults =
            wire::Faults { loss: self.loss, corruption: self.corruption, ..Default::default() };
        (faults, wire::Pace { latency, ..Default::default() })
    }
}

/// The faults that are wished for, shared with whoever has the simulated robot.
#[derive(Clone, Debug, Default)]
pub(super) struct FaultWish(Arc<(Mutex<SimulatedFaults>, AtomicU64)>);

impl FaultWish {
    pub(super) fn set(&self, faults: SimulatedFaults) {
        *lock(&self.0.0) = faults;
        self.0.1.fetch_add(1, Ordering::SeqCst);
    }

    pub(super) fn get(&self) -> SimulatedFaults {
        *lock(&self.0.0)
    }

    /// Lets the robot on `stage` have them, unless it has them since `known`.
    pub(super) fn bring(&self, stage: &mut dyn Stage, known: &mut u64) {
        let revision = self.0.1.load(Ordering::SeqCst);
        if *known != revision {
            *known = revision;
            self.bring_again(stage);
        }
    }

    /// The same, whatever it has.
    pub(super) fn bring_again(&self, stage: &mut dyn Stage) {
        let faults = self.get();
        stage.inject(faults.base(), faults.wire(), faults.camera());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_cannot_go_wrong_like_that_is_refused() {
        for text in [r#"{"slip":[0.95,0]}"#, r#"{"loss":-0.1}"#, r#"{"latency":2}"#] {
            let faults: SimulatedFaults = serde_json::from_str(text).unwrap();
            assert!(faults.check().is_err(), "{text}");
        }
        assert!(serde_json::from_str::<SimulatedFaults>(r#"{"lost":1}"#).is_err());
        let faults: SimulatedFaults =
            serde_json::from_str(r#"{"encoders":["stuck","counts"],"blocked":[false,true]}"#)
                .unwrap();
        assert!(faults.check().is_ok());
        assert_eq!(faults.base().encoders, [EncoderFault::Stuck, EncoderFault::None]);
    }
}
