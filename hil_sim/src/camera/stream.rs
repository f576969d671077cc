//! A camera's frames over time: when each is exposed and delivered, and what goes wrong with them.
//!
//! Time is whatever the caller says; a frame that is lost or never fetched is never drawn.

use super::{Camera, Stage};
use std::collections::VecDeque;
use std::time::Duration;

/// Frames that nobody fetches are kept so long, then the oldest is forgotten.
const KEPT: usize = 8;

/// How frames come.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Timing {
    /// Frames a second.
    pub rate: f64,
    /// From a frame's exposure to its delivery.
    pub latency: Duration,
    /// The share of frames that are lost.
    pub lost: f64,
    /// Which of them.
    pub seed: u64,
}

impl Default for Timing {
    /// A web camera: 15 frames a second, 80 ms late, none lost.
    fn default() -> Self {
        Self { rate: 15.0, latency: Duration::from_millis(80), lost: 0.0, seed: 1 }
    }
}

/// What goes wrong with a camera; nothing by default.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CameraFaults {
    /// No light reaches it.
    pub dark: bool,
    /// It sends the same picture again and again.
    pub frozen: bool,
    /// Its frames are later than usual by this.
    pub late: Duration,
    /// This share of frames is lost, if more than usual.
    pub lost: f64,
    /// Somebody has shifted it, m, and turned it about its own axes, rad.
    pub moved: Option<[[f64; 3]; 2]>,
}

/// A picture with its times, and what it shows.
#[derive(Clone, Debug, PartialEq)]
pub struct Frame {
    /// When it was exposed.
    pub exposed: Duration,
    /// When the computer has it.
    pub delivered: Duration,
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Row by row, red, green and blue of each pixel.
    pub rgb: Vec<u8>,
    /// What stood before the camera at the exposure, even if the picture does not show it.
    pub stage: Stage,
}

/// A camera that takes a picture again and again.
#[derive(Clone, Debug)]
pub struct Stream {
    camera: Camera,
    timing: Timing,
    faults: CameraFaults,
    random: fastrand::Rng,
    /// Frames exposed so far.
    count: u64,
    waiting: VecDeque<Exposure>,
    last: Vec<u8>,
}

/// A frame that is not drawn yet: what a camera would show, and when.
#[derive(Clone, Debug)]
pub struct Exposure {
    number: u64,
    exposed: Duration,
    delivered: Duration,
    faults: CameraFaults,
    stage: Stage,
}

impl Exposure {
    /// When it was exposed.
    pub fn exposed(&self) -> Duration {
        self.exposed
    }
}

impl Stream {
    /// Pictures by `camera`, the first at time 0.
    pub fn new(camera: Camera, timing: Timing) -> Self {
        let random = fastrand::Rng::with_seed(timing.seed);
        let faults = CameraFaults::default();
        let (waiting, last) = (VecDeque::new(), Vec::new());
        Self { camera, timing, faults, random, count: 0, waiting, last }
    }

    /// The camera.
    pub fn camera(&self) -> &Camera {
        &self.camera
    }

    /// What goes wrong from now on.
    pub fn set_faults(&mut self, faults: CameraFaults) {
        self.faults = faults;
    }

    /// When the next frame is exposed.
    pub fn next_exposure(&self) -> Duration {
        Duration::from_secs_f64(self.count as f64 / self.timing.rate.max(1e-3))
    }

    /// Exposes a frame if it is time for one; `stage` says what is seen `now`.
    pub fn expose(&mut self, now: Duration, stage: impl FnOnce(&Camera) -> Stage) {
        if now < self.next_exposure() {
            return;
        }
        while self.next_exposure() <= now {
            self.count += 1;
        }
        let (number, faults) = (self.count, self.faults);
        if self.random.f64() < self.timing.lost.max(faults.lost) {
            return;
        }
        let before = self.waiting.back().map_or(Duration::ZERO, |frame| frame.delivered);
        let delivered = (now + self.timing.latency + faults.late).max(before);
        let stage = stage(&self.camera);
        self.waiting.push_back(Exposure { number, exposed: now, delivered, faults, stage });
        if self.waiting.len() > KEPT && self.waiting[1].delivered <= now {
            self.waiting.pop_front();
        }
    }

    /// The next frame that has been delivered by `now`. Frames never overtake each other.
    pub fn take(&mut self, now: Duration) -> Option<Frame> {
        let exposure = self.take_exposure(now)?;
        Some(self.draw(exposure))
    }

    /// The same before it is drawn: whoever must not wait for that lets a copy of this [draw](Self::draw) it.
    pub fn take_exposure(&mut self, now: Duration) -> Option<Exposure> {
        self.waiting.front().filter(|exposure| exposure.delivered <= now)?;
        self.waiting.pop_front()
    }

    /// Draws a frame.
    pub fn draw(&mut self, exposure: Exposure) -> Frame {
        if !exposure.faults.frozen || self.last.is_empty() {
            self.last = self.camera.picture(&exposure.stage, &exposure.faults, exposure.number);
        }
        let [width, height] = self.camera.lens().image_size;
        let Exposure { exposed, delivered, stage, .. } = exposure;
        Frame { exposed, delivered, width, height, rgb: self.last.clone(), stage }
    }
}
