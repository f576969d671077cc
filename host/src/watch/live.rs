//! Frames of a real camera, looked at on a thread of their own: the drive loop never waits for vision.

use super::eye::Eye;
use super::source::{Background, SourceError};
use super::{Expected, Look, Watcher};
use crate::geometry::Pose;
use crate::vision::decode;
use std::sync::mpsc::{Receiver, SyncSender, TryRecvError, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

/// The thread looks this often whether it is still wanted.
const PATIENCE: Duration = Duration::from_millis(100);
/// Sights that wait to be fetched; the loop fetches far more often than a camera sends.
const WAITING: usize = 8;

/// A watcher over a real camera.
#[derive(Debug)]
pub struct LiveWatcher {
    results: Receiver<Result<Look, SourceError>>,
    expected: Arc<Mutex<Expected>>,
}

impl LiveWatcher {
    /// Looks with `eye` at the frames of `source`. Time 0 is at `epoch`; frames are exposed `delay` earlier
    /// than the source says.
    pub fn start(source: Background, mut eye: Eye, epoch: Instant, delay: Duration) -> Self {
        let (sender, results) = sync_channel(WAITING);
        let expected = Arc::new(Mutex::new(Expected::default()));
        let theirs = Arc::clone(&expected);
        thread::spawn(move || {
            loop {
                let result = look(&source, &mut eye, (epoch, delay), &theirs);
                let has_ended = result.is_err();
                if !deliver(&sender, result) || has_ended {
                    return;
                }
            }
        });
        Self { results, expected }
    }
}

/// Puts a result where the loop fetches it; false if nobody will.
fn deliver(
    sender: &SyncSender<Result<Look, SourceError>>,
    result: Result<Look, SourceError>,
) -> bool {
    sender.send(result).is_ok()
}

fn look(
    source: &Background,
    eye: &mut Eye,
    (epoch, delay): (Instant, Duration),
    expected: &Mutex<Expected>,
) -> Result<Look, SourceError> {
    let frame = match source.newest(PATIENCE) {
        Ok(None) => return Ok(Look::Nothing),
        Ok(Some(frame)) => frame,
        Err(error) if error.is_lasting() => return Err(error),
        Err(error) => return Ok(Look::failed(&error)),
    };
    let exposed = frame.exposed.saturating_duration_since(epoch).saturating_sub(delay);
    let expected = expected.lock().unwrap_or_else(PoisonError::into_inner).at(exposed);
    let photo = match decode(&frame.bytes) {
        Ok(photo) => photo,
        Err(error) => return Ok(Look::failed(&error)),
    };
    Ok(match eye.look(&photo, exposed, expected) {
        Ok(sight) => Look::Seen(sight),
        Err(error) => Look::failed(&error),
    })
}

impl<P> Watcher<P> for LiveWatcher {
    fn expect(&mut self, at: Duration, pose: Pose) {
        self.expected.lock().unwrap_or_else(PoisonError::into_inner).push(at, pose);
    }

    fn look(&mut self, _: &mut P, _: Duration) -> Result<Look, SourceError> {
        match self.results.try_recv() {
            Ok(result) => result,
            Err(TryRecvError::Empty) => Ok(Look::Nothing),
            Err(TryRecvError::Disconnected) => {
                Ok(Look::Failed("the camera's thread has ended".into()))
            }
        }
    }
}
