//! A source on a thread of its own: it may wait for its camera, and only its newest frame is kept.

use super::{FrameSource, RawFrame, SourceError};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

/// After a failure that may pass, the source is asked again after this long.
const RETRY: Duration = Duration::from_millis(200);
/// More frames, or more bytes, within a second are a flood: no camera of use sends so much.
const MOST_FRAMES: u32 = 500;
const MOST_BYTES: u64 = 400_000_000;

/// A source that is read on a thread of its own, until this value is dropped.
#[derive(Debug)]
pub struct Background {
    shared: Arc<Shared>,
}

#[derive(Debug, Default)]
struct Shared {
    state: Mutex<State>,
    arrived: Condvar,
}

#[derive(Debug, Default)]
struct State {
    newest: Option<RawFrame>,
    /// Why nothing came last time.
    trouble: Option<SourceError>,
    /// The source will deliver nothing more.
    has_ended: bool,
    is_dropped: bool,
}

impl Shared {
    fn lock(&self) -> MutexGuard<'_, State> {
        // A thread that panicked left the state as it was.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Background {
    /// Begins to read `source`.
    pub fn start(mut source: Box<dyn FrameSource>) -> Self {
        let shared = Arc::new(Shared::default());
        let theirs = Arc::clone(&shared);
        thread::spawn(move || {
            let mut budget = Budget::new();
            loop {
                let result = source.next();
                if theirs.lock().is_dropped {
                    return;
                }
                let result = result.and_then(|frame| budget.spend(frame));
                match result {
                    Ok(None) => {}
                    Ok(Some(frame)) => {
                        let mut state = theirs.lock();
                        (state.newest, state.trouble) = (Some(frame), None);
                        theirs.arrived.notify_all();
                    }
                    Err(error) => {
                        let has_ended = error.is_lasting();
                        let mut state = theirs.lock();
                        (state.trouble, state.has_ended) = (Some(error), has_ended);
                        theirs.arrived.notify_all();
                        drop(state);
                        if has_ended {
                            return;
                        }
                        thread::sleep(RETRY);
                    }
                }
            }
        });
        Self { shared }
    }

    /// The newest frame that nobody has had yet; waits for it for `patience`.
    ///
    /// # Errors
    /// The [`SourceError`] that has ended the source; without a frame, the last that may pass, once each.
    pub fn newest(&self, patience: Duration) -> Result<Option<RawFrame>, SourceError> {
        let until = Instant::now() + patience;
        let mut state = self.shared.lock();
        loop {
            if let Some(frame) = state.newest.take() {
                return Ok(Some(frame));
            }
            let left = until.saturating_duration_since(Instant::now());
            if state.has_ended || left.is_zero() {
                return state.trouble.take().map_or(Ok(None), Err);
            }
            let waited = self.shared.arrived.wait_timeout(state, left);
            state = waited.unwrap_or_else(PoisonError::into_inner).0;
        }
    }

    /// The first frame, waited for `patience`.
    ///
    /// # Errors
    /// Why there is none.
    pub fn first(&self, patience: Duration) -> Result<RawFrame, SourceError> {
        self.newest(patience)?.ok_or(SourceError::Silent(patience))
    }
}

impl Drop for Background {
    fn drop(&mut self) {
        self.shared.lock().is_dropped = true;
    }
}

/// What came within the current second.
struct Budget {
    since: Instant,
    frames: u32,
    bytes: u64,
}

impl Budget {
    fn new() -> Self {
        Self { since: Instant::now(), frames: 0, bytes: 0 }
    }

    fn spend(&mut self, frame: Option<RawFrame>) -> Result<Option<RawFrame>, SourceError> {
        let Some(frame) = frame else { return Ok(None) };
        if frame.delivered.saturating_duration_since(self.since) >= Duration::from_secs(1) {
            *self = Self { since: frame.delivered, frames: 0, bytes: 0 };
        }
        self.frames += 1;
        self.bytes += frame.bytes.len() as u64;
        if self.frames > MOST_FRAMES || self.bytes > MOST_BYTES {
            return Err(SourceError::Flood {
                frames: self.frames,
                megabytes: self.bytes / 1_000_000,
            });
        }
        Ok(Some(frame))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io;

    /// Delivers frames of one byte, counted from 0, as fast as it can; then an error each time.
    struct Counting(u32, u32);

    impl FrameSource for Counting {
        fn next(&mut self) -> Result<Option<RawFrame>, SourceError> {
            if self.0 == self.1 {
                let error = io::ErrorKind::ConnectionReset.into();
                return Err(SourceError::Io { name: "test".into(), error });
            }
            let now = Instant::now();
            self.0 += 1;
            Ok(Some(RawFrame { exposed: now, delivered: now, bytes: vec![(self.0 - 1) as u8] }))
        }
    }

    #[test]
    fn the_newest_frame_wins_and_trouble_is_told() {
        let background = Background::start(Box::new(Counting(0, 100)));
        let (mut last, long) = (None, Duration::from_secs(20));
        let trouble = loop {
            match background.newest(long) {
                Ok(Some(frame)) => {
                    assert!(last < Some(frame.bytes[0]), "never an older one, never twice");
                    last = Some(frame.bytes[0]);
                }
                Ok(None) => panic!("the error of the source is told"),
                Err(error) => break error,
            }
        };
        assert_eq!(last, Some(99));
        assert!(matches!(trouble, SourceError::Io { .. }) && !trouble.is_lasting(), "{trouble}");
    }

    #[test]
    fn a_flood_ends_the_source() {
        let background = Background::start(Box::new(Counting(0, u32::MAX)));
        let flood = loop {
            if let Err(error) = background.newest(Duration::from_secs(20)) {
                break error;
            }
        };
        assert!(matches!(flood, SourceError::Flood { frames: 501, .. }), "{flood}");
    }
}
