//! A simulated robot in step with the clock on the wall, for people who watch it; a real one as it is.

use super::camera::{Arranged, Lookout};
use super::faults::FaultWish;
use super::frames::{FrameLog, FrameTap};
use crate::cli::endpoint::Endpoint;
use hil_sim::simulation::Truth;
use std::io::{self, Read, Write};
use std::time::{Duration, Instant};
use wmr::link::drive::TimedPort;

/// A computer that was busy or asleep for longer does not catch up, as in [`hil_sim::realtime`].
const LONGEST_GAP: Duration = Duration::from_millis(100);

/// An endpoint whose time passes `speed` times as fast as the wall clock's.
pub(super) struct Paced {
    endpoint: Box<dyn Endpoint>,
    speed: f64,
    last: Instant,
    tap: FrameTap,
    faults: FaultWish,
    faults_known: u64,
    camera: Lookout,
    /// The floor as it is arranged for the camera.
    arranged: Arranged,
}

impl Paced {
    /// `endpoint`, if simulated at `speed`, from now on.
    pub(super) fn new(
        endpoint: Box<dyn Endpoint>,
        speed: f64,
        frames: FrameLog,
        (faults, camera): (FaultWish, Lookout),
    ) -> Self {
        let (last, tap) = (Instant::now(), FrameTap::new(frames));
        let arranged = Arranged::default();
        Self { endpoint, speed, last, tap, faults, faults_known: 0, camera, arranged }
    }

    /// Makes the floor of a simulated robot as it is wanted under the camera.
    pub(super) fn arrange(&mut self) {
        let Some(stage) = self.endpoint.stage() else { return };
        if self.camera.bring_floor(stage, &mut self.arranged) {
            // The new camera has no faults yet.
            self.faults.bring_again(stage);
        }
    }

    pub(super) fn nonce(&self) -> u32 {
        self.endpoint.nonce()
    }

    pub(super) fn truth(&self) -> Option<Truth> {
        self.endpoint.truth()
    }
}

impl Read for Paced {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let length = self.endpoint.read(buffer)?;
        let now = self.endpoint.now();
        self.tap.received(buffer.get(..length).unwrap_or_default(), now);
        Ok(length)
    }
}

impl Write for Paced {
    fn write(&mut self, buffer: &[u8]) -> io::Result<usize> {
        let length = self.endpoint.write(buffer)?;
        let now = self.endpoint.now();
        self.tap.sent(buffer.get(..length).unwrap_or_default(), now);
        Ok(length)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.endpoint.flush()
    }
}

impl TimedPort for Paced {
    fn now(&self) -> Duration {
        self.endpoint.now()
    }

    fn wait(&mut self, duration: Duration) -> io::Result<()> {
        if self.endpoint.truth().is_none() {
            return self.endpoint.wait(duration);
        }
        if let Some(stage) = self.endpoint.stage() {
            self.faults.bring(stage, &mut self.faults_known);
            self.camera.bring_things(stage, &mut self.arranged);
        }
        std::thread::sleep(duration.div_f64(self.speed));
        let gap = self.last.elapsed();
        self.last += gap;
        if self.camera.is_behind() {
            return Ok(());
        }
        self.endpoint.wait(gap.mul_f64(self.speed).min(LONGEST_GAP))?;
        let exposure = self.endpoint.stage().and_then(|stage| stage.take_exposure());
        if let Some(exposure) = exposure {
            self.camera.offer(exposure, self.arranged);
        }
        Ok(())
    }

    fn is_open(&self) -> bool {
        self.endpoint.is_open()
    }
}
