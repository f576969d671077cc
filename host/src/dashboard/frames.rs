//! The last frames on the link as they were on the wire, for people who want to see what is said.

use super::lock;
use protocol::frame::{Decoder, FrameError, Header};
use protocol::message::{Command, Report};
use serde_json::{Value, json};
use std::collections::VecDeque;
use std::fmt::Debug;
use std::sync::{Arc, Mutex};
use std::time::Duration;

/// So many are kept: a few seconds of a drive.
const MOST_FRAMES: usize = 300;

/// What was said last, in both directions.
#[derive(Clone, Debug, Default)]
pub(super) struct FrameLog(Arc<Mutex<VecDeque<Frame>>>);

#[derive(Clone, Debug)]
struct Frame {
    /// Since the port was opened, seconds of its clock.
    time: f64,
    to_robot: bool,
    bytes: Vec<u8>,
    /// What the frame means, or why it means nothing.
    said: String,
}

impl FrameLog {
    /// The frames, the oldest first.
    pub(super) fn document(&self) -> Value {
        let frames = lock(&self.0).clone();
        let frame = |frame: &Frame| {
            let hex: Vec<String> = frame.bytes.iter().map(|byte| format!("{byte:02x}")).collect();
            json!({"t": frame.time, "to_robot": frame.to_robot, "bytes": hex.join(" "), "said": frame.said})
        };
        json!({"frames": frames.iter().map(frame).collect::<Vec<_>>()})
    }

    fn push(&self, frame: Frame) {
        let mut frames = lock(&self.0);
        if frames.len() >= MOST_FRAMES {
            frames.pop_front();
        }
        frames.push_back(frame);
    }
}

/// What listens on one port.
#[derive(Debug, Default)]
pub(super) struct FrameTap {
    log: FrameLog,
    to_robot: Line,
    to_host: Line,
}

#[derive(Debug, Default)]
struct Line {
    decoder: Decoder,
    open: Vec<u8>,
}

impl FrameTap {
    pub(super) fn new(log: FrameLog) -> Self {
        Self { log, ..Self::default() }
    }

    /// Bytes that went to the robot.
    pub(super) fn sent(&mut self, bytes: &[u8], now: Duration) {
        for &byte in bytes {
            self.to_robot.open.push(byte);
            if let Some(frame) = self.to_robot.decoder.push::<Command>(byte) {
                self.log.push(self.to_robot.close(said(frame), true, now));
            }
        }
    }

    /// Bytes that came from the robot.
    pub(super) fn received(&mut self, bytes: &[u8], now: Duration) {
        for &byte in bytes {
            self.to_host.open.push(byte);
            if let Some(frame) = self.to_host.decoder.push::<Report>(byte) {
                self.log.push(self.to_host.close(said(frame), false, now));
            }
        }
    }
}

impl Line {
    fn close(&mut self, said: String, to_robot: bool, now: Duration) -> Frame {
        let mut bytes = std::mem::take(&mut self.open);
        // Noise on a line may be longer than any frame.
        bytes.truncate(protocol::frame::MAX_FRAME);
        Frame { time: now.as_secs_f64(), to_robot, bytes, said }
    }
}

fn said<T: Debug>(frame: Result<(Header, T), FrameError>) -> String {
    match frame {
        Ok((_, message)) => format!("{message:?}"),
        Err(error) => format!("no frame: {error:?}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use protocol::frame::{MAX_FRAME, encode};

    #[test]
    fn a_frame_is_kept_with_its_bytes_and_what_it_says_however_it_arrives() {
        let log = FrameLog::default();
        let mut tap = FrameTap::new(log.clone());
        let mut wire = [0; MAX_FRAME];
        let length = encode(&Header::default(), &Command::Pause, &mut wire).unwrap();
        for byte in &wire[..length] {
            tap.sent(&[*byte], Duration::from_secs(2));
        }
        tap.received(&[3, 1, 0], Duration::from_secs(3));
        let document = log.document();
        let frames = document["frames"].as_array().unwrap();
        assert_eq!((&frames[0]["said"], &frames[0]["to_robot"]), (&json!("Pause"), &json!(true)));
        assert_eq!(frames[0]["bytes"].as_str().unwrap().split(' ').count(), length);
        assert!(frames[1]["said"].as_str().unwrap().starts_with("no frame"), "{document}");
    }

    #[test]
    fn only_the_last_are_kept() {
        let log = FrameLog::default();
        let mut tap = FrameTap::new(log.clone());
        for _ in 0..2 * MOST_FRAMES {
            tap.received(&[9, 0], Duration::ZERO);
        }
        assert_eq!(log.document()["frames"].as_array().unwrap().len(), MOST_FRAMES);
    }
}
