//! What a robot said on a drive, as a file of lines: read back and turned into a table.
//!
//! It stands after the link: `wmr drive --log` writes a line of JSON for every word of the robot, `t` in
//! seconds since the plan began, `pose` in metres and radians in the frame of the scene's map, `wheels` in
//! rad/s, the index of the leg, and the robot's state.

pub use crate::document::RunLine;
use crate::geometry::{Point, Pose};
use std::fmt::Write;

/// No drive is longer, seconds.
const LONGEST: f64 = 86_400.0;

/// Why a file is no log of a run.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum RunLogError {
    /// A line is something else.
    #[error("line {line} is no word of a robot: {cause}")]
    #[diagnostic(help("take run.jsonl as wmr drive --log writes it"))]
    Line {
        /// Counted from 1.
        line: usize,
        /// What is wrong with it.
        cause: String,
    },
    /// The robot never said a word.
    #[error("the log has no line, so the robot never began")]
    #[diagnostic(help("drive again with --log"))]
    Empty,
}

/// A drive as the robot told it.
#[derive(Clone, Debug, PartialEq)]
pub struct RunLog {
    /// In the order of time.
    pub lines: Vec<RunLine>,
}

impl RunLog {
    /// Reads the text of a `run.jsonl`. A last line without its end is left out: a program that was
    /// killed leaves one.
    ///
    /// # Errors
    /// [`RunLogError`] with the line that is none, or whose time goes backwards.
    ///
    /// ```
    /// let text = r#"{"t":0.1,"pose":[1,2,0],"wheels":[3,4],"leg":0,"state":"driving"}"#.to_owned() + "\n";
    /// let log = wmr::run_log::RunLog::from_jsonl(&text)?;
    /// assert_eq!(log.lines[0].wheels, [3.0, 4.0]);
    /// # Ok::<(), wmr::run_log::RunLogError>(())
    /// ```
    pub fn from_jsonl(text: &str) -> Result<Self, RunLogError> {
        let mut lines: Vec<RunLine> = Vec::new();
        for (index, line) in text.split_inclusive('\n').enumerate() {
            let wrong = |cause: String| RunLogError::Line { line: index + 1, cause };
            let parsed = match serde_json::from_str::<RunLine>(line) {
                Ok(parsed) => parsed,
                Err(_) if !line.ends_with('\n') => break,
                Err(error) => return Err(wrong(error.to_string())),
            };
            let before = lines.last().map_or(0.0, |last| last.t);
            if !(before..=LONGEST).contains(&parsed.t) {
                return Err(wrong(format!("{} s is not between {before} s and a day", parsed.t)));
            }
            lines.push(parsed);
        }
        if lines.is_empty() { Err(RunLogError::Empty) } else { Ok(Self { lines }) }
    }

    /// The same drive in the arena frame, whose origin lies at `origin` in the frame of the map.
    pub fn in_arena_frame(mut self, origin: Point) -> Self {
        for line in &mut self.lines {
            let Point { x, y } = line.pose.position;
            line.pose.position = Point::new(x - origin.x, y - origin.y);
        }
        self
    }

    /// From the first word to the last, seconds.
    pub fn duration(&self) -> f64 {
        match (self.lines.first(), self.lines.last()) {
            (Some(first), Some(last)) => last.t - first.t,
            _ => 0.0,
        }
    }

    /// Poses at equal distances of time, `frame` seconds, as a film needs them: the last one known at each.
    pub fn frames(&self, frame: f64) -> Vec<Pose> {
        let Some(first) = self.lines.first() else { return Vec::new() };
        let count = (self.duration() / frame).ceil() as usize + 1;
        let mut at = 0;
        let pose_at = |index: usize| {
            let time = first.t + frame * index as f64;
            while self.lines.get(at + 1).is_some_and(|next| next.t <= time + 1e-9) {
                at += 1;
            }
            self.lines.get(at).map(|line| line.pose)
        };
        (0..count).map_while(pose_at).collect()
    }

    /// A table for other programs, with units in its head; lines end as RFC 4180 wants them.
    ///
    /// ```
    /// # let text = r#"{"t":0.1,"pose":[1,2,0.5],"wheels":[3,4],"leg":0,"state":"driving"}"#.to_owned() + "\n";
    /// # let log = wmr::run_log::RunLog::from_jsonl(&text).unwrap();
    /// assert!(log.to_csv().ends_with("\r\n0.1,1,2,0.5,3,4,0,driving\r\n"));
    /// ```
    pub fn to_csv(&self) -> String {
        let mut text =
            "t_s,x_m,y_m,heading_rad,left_rad_per_s,right_rad_per_s,leg,state\r\n".to_owned();
        for RunLine { t, pose, wheels: [left, right], leg, state } in &self.lines {
            let Point { x, y } = pose.position;
            // Writing into a string cannot fail.
            let _ = write!(text, "{t},{x},{y},{},{left},{right},{leg},{state}\r\n", pose.heading);
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(t: f64, x: f64) -> String {
        format!(r#"{{"t":{t},"pose":[{x},0,0],"wheels":[1,1],"leg":0,"state":"driving"}}"#)
    }

    #[test]
    fn a_line_cut_short_at_the_end_is_left_out_and_no_other() {
        let text = format!("{}\n{}\n{{\"t\":", line(0.0, 0.0), line(0.1, 0.5));
        assert_eq!(RunLog::from_jsonl(&text).unwrap().lines.len(), 2);
        let text = format!("{}\nnonsense\n", line(0.0, 0.0));
        assert!(matches!(RunLog::from_jsonl(&text), Err(RunLogError::Line { line: 2, .. })));
        let text = format!("{}\n{}\n", line(1.0, 0.0), line(0.5, 0.0));
        assert!(matches!(RunLog::from_jsonl(&text), Err(RunLogError::Line { line: 2, .. })));
        assert!(matches!(RunLog::from_jsonl(""), Err(RunLogError::Empty)));
    }

    #[test]
    fn frames_hold_the_last_pose_known() {
        let text = [line(1.0, 0.0), line(1.1, 1.0), line(1.4, 2.0)].join("\n") + "\n";
        let log = RunLog::from_jsonl(&text).unwrap();
        let places: Vec<f64> = log.frames(0.1).iter().map(|pose| pose.position.x).collect();
        assert_eq!(places, [0.0, 1.0, 1.0, 1.0, 2.0]);
        assert!((log.duration() - 0.4).abs() < 1e-12);
    }

    #[test]
    fn a_map_s_frame_is_left_behind() {
        let log = RunLog::from_jsonl(&(line(0.0, 3.0) + "\n")).unwrap();
        let moved = log.in_arena_frame(Point::new(1.0, -1.0));
        assert_eq!(moved.lines[0].pose.position, Point::new(2.0, 1.0));
    }
}
