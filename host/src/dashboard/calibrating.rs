//! Calibration of the base as a page walks a person through it: courses driven one by one, their ends
//! measured, and the lengths that explain them.

use super::error::Failure;
use super::robot::RobotThread;
use crate::cli::error::CliError;
use crate::cli::run::Run as DriveRun;
use serde::Deserialize;
use serde_json::{Value, json};
use tokio::sync::oneshot;
use wmr::calibration::{BaseLengths, Course, Run, calibrate, seen_from};
use wmr::document::shortest;
use wmr::geometry::Pose;
use wmr::link::parameters::Request;

/// Sides of the squares, metres: shorter ones measure nothing, longer ones have no room.
const SIDES: std::ops::RangeInclusive<f64> = 0.3..=5.0;

/// `POST /api/course`.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct CourseRequest {
    index: usize,
    side: f64,
}

/// `POST /api/calibrate`.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct CalibrateRequest {
    side: f64,
    /// An end for each course.
    ends: Vec<End>,
    /// Whether the robot is to keep the lengths when it loses power.
    #[serde(default)]
    pub(super) keep: bool,
}

/// Where a course has ended, from where it began.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct End {
    believed: Pose,
    measured: Pose,
}

/// Runs to calibrate with, and where the answer goes.
#[derive(Debug)]
pub(super) struct CalibrateTask {
    pub(super) runs: Vec<Run>,
    pub(super) keep: bool,
    pub(super) reply: oneshot::Sender<Result<Value, CliError>>,
}

fn courses(side: f64) -> Result<[Course; 6], Failure> {
    if !SIDES.contains(&side) {
        let (least, most) = (SIDES.start(), SIDES.end());
        return Err(Failure::bad_request(format!(
            "a side of {side} m is not possible; {least} to {most} m"
        )));
    }
    Ok(Course::all(side))
}

impl CourseRequest {
    pub(super) fn course(&self) -> Result<Course, Failure> {
        let all = courses(self.side)?;
        all.get(self.index).copied().ok_or_else(|| {
            Failure::bad_request(format!("there is no course {}; 0 to 5", self.index))
        })
    }
}

impl CalibrateRequest {
    pub(super) fn runs(&self) -> Result<Vec<Run>, Failure> {
        let all = courses(self.side)?;
        if self.ends.len() != all.len() {
            let message = format!("{} ends were measured; six are needed", self.ends.len());
            return Err(Failure::bad_request(message));
        }
        let run = |(course, End { believed, measured }): (Course, &End)| Run {
            course,
            believed: *believed,
            measured: *measured,
        };
        Ok(all.into_iter().zip(&self.ends).map(run).collect())
    }
}

impl RobotThread {
    /// Drives one course, from wherever the robot stands.
    pub(super) fn drive_course(&mut self, course: Course, stops: u64) -> Result<(), CliError> {
        let limits = self.greet(stops)?;
        let origin = Pose::new(0.0, 0.0, 0.0);
        let before = self.truth();
        let mut run = DriveRun::new(course.legs(), limits, origin);
        self.follow(&mut run, origin, stops)?;
        let measured = before.zip(self.truth()).map(|(before, after)| seen_from(before, after));
        self.note_course(json!({"believed": run.end, "measured": measured}));
        Ok(())
    }

    fn truth(&mut self) -> Option<Pose> {
        let pose = self.client.as_mut()?.port_mut().truth()?.pose;
        Some(pose.into())
    }

    /// Finds the lengths that explain the runs, and gives them to the robot.
    pub(super) fn serve_calibration(&mut self, task: CalibrateTask) {
        let answer = self.calibrate_with(&task.runs, task.keep);
        // A page that has gone needs no answer.
        let _ = task.reply.send(answer);
    }

    fn calibrate_with(&mut self, runs: &[Run], keep: bool) -> Result<Value, CliError> {
        self.greet(self.controls.stops())?;
        let old = self.ask_parameters(Request::Read)?;
        let found = calibrate(BaseLengths::of(&old), runs)?;
        let new = found.lengths.applied_to(&old, old.calibration.wrapping_add(1));
        let new = self.ask_parameters(Request::Change(new))?;
        self.own_parameters = Some(new);
        if keep {
            self.ask(Request::Keep)?;
        }
        let lengths = |parameters: &protocol::parameters::Parameters, rms: f64| {
            json!({
                "wheel_radius": shortest(parameters.wheel_radius.0),
                "wheel_ratio": shortest(parameters.wheel_ratio),
                "track": shortest(parameters.track.0), "rms": rms,
            })
        };
        let (before, after) = (lengths(&old, found.before), lengths(&new, found.after));
        Ok(json!({"before": before, "after": after, "calibration": new.calibration, "saved": keep}))
    }

    fn note_course(&self, end: Value) {
        super::lock(&self.live).run.course = Some(end);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_courses_and_ends_that_are_there_are_taken() {
        let course = |text: &str| serde_json::from_str::<CourseRequest>(text).unwrap().course();
        assert!(matches!(course(r#"{"index":2,"side":1}"#), Ok(Course::Square { left: true, .. })));
        assert!(course(r#"{"index":6,"side":1}"#).is_err());
        assert!(course(r#"{"index":0,"side":100}"#).is_err());
        let ends = |count: usize| {
            let end = json!({"believed": [0, 0, 0], "measured": [0, 0, 0]});
            let request = json!({"side": 1, "ends": vec![end; count]});
            serde_json::from_value::<CalibrateRequest>(request).unwrap().runs()
        };
        assert_eq!(ends(6).unwrap().len(), 6);
        assert!(ends(5).is_err());
    }
}
