//! Obstacles over time: which shape of one frame is which of the next, how it moves, and where it may be
//! soon.
//!
//! ```text
//! shapes of a frame ─► nearest tracks, gated ─► velocity, outline ─► predicted sets
//!                      born, lost               Kalman    held
//! ```
//! A predicted set is the outline, moved on at its velocity and inflated by a disc that holds the
//! truth in 99 % of cases. How wide that disc has to be is learned: each track's predictions are held against
//! what then happened, and all sets grow where they have missed and shrink slowly where they have not.
//!
//! An obstacle exists from the first frame that shows it on, and is forgotten after the second in a row
//! that does not. Metres, radians, arena frame.

mod motion;
mod outline;
mod track;

pub use track::{PredictedSet, Track, TrackId};

use crate::scene::Obstacle;
use std::time::Duration;

/// The standard deviation of the centre and of each edge of a shape, metres, where nobody knows better.
pub const DEFAULT_SIGMA: f64 = 0.005;

/// A shape belongs to a track if its centre is within so many standard deviations of the prediction.
const GATE_SIGMAS: f64 = 5.0;

/// Shapes whose outlines overlap are near each other as long as their centres are within this share of
/// the smaller one's half width.
const OVERLAP: f64 = 0.5;

/// An obstacle that so many frames in a row do not show is gone.
const MISSES: u32 = 2;

/// What one frame changed.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FrameChanges {
    /// Obstacles seen for the first time.
    pub born: Vec<TrackId>,
    /// Obstacles that are gone.
    pub lost: Vec<TrackId>,
    /// Obstacles whose outline is another now.
    pub reshaped: Vec<TrackId>,
}

/// All obstacles in view.
#[derive(Clone, Debug)]
pub struct Tracker {
    tracks: Vec<Track>,
    time: Duration,
    next: u32,
    sigma: f64,
    /// By how much predicted sets are wider than the model says, from what was missed.
    widening: f64,
}

impl Default for Tracker {
    fn default() -> Self {
        Self::new(DEFAULT_SIGMA)
    }
}

impl Tracker {
    /// A tracker that has seen nothing yet; `sigma` is the standard deviation of the centre and of each
    /// edge of a shape, metres.
    pub fn new(sigma: f64) -> Self {
        Self { tracks: Vec::new(), time: Duration::ZERO, next: 1, sigma, widening: 1.0 }
    }

    /// Takes in what the frame shows that was exposed at `time`; a frame exposed before the last one is
    /// passed over.
    ///
    /// ```
    /// use std::time::Duration;
    /// use wmr::{geometry::Rect, track::obstacles::Tracker};
    /// let mut tracker = Tracker::default();
    /// for frame in 0..20 {
    ///     let x = 0.02 * f64::from(frame); // 0.2 m/s
    ///     tracker.update(Duration::from_millis(100 * u64::from(frame as u32)), &[Rect::new(x, 1.0, x + 0.1, 1.1).into()]);
    /// }
    /// let [vx, vy] = tracker.tracks()[0].velocity();
    /// assert!((vx - 0.2).abs() < 0.01 && vy.abs() < 1e-9);
    /// // One second later it is 0.2 m further.
    /// let there = tracker.tracks()[0].predicted(Duration::from_secs(1)).footprint.bounds();
    /// assert!((there.x0 - 0.58).abs() < 0.01);
    /// ```
    pub fn update(&mut self, time: Duration, seen: &[Obstacle]) -> FrameChanges {
        let mut changes = FrameChanges::default();
        if time <= self.time && self.next > 1 {
            return changes;
        }
        self.time = time;
        let owners = self.associate(time, seen);
        for (index, track) in self.tracks.iter_mut().enumerate() {
            let own = owners.iter().position(|&owner| owner == Some(index));
            match own.and_then(|own| seen.get(own)) {
                Some(seen) => {
                    if track.see(time, seen, &mut self.widening) {
                        changes.reshaped.push(track.id());
                    }
                }
                None => track.miss(time),
            }
        }
        changes.lost.extend(self.tracks.iter().filter(|t| t.misses() >= MISSES).map(Track::id));
        self.tracks.retain(|track| track.misses() < MISSES);
        for (seen, _) in seen.iter().zip(&owners).filter(|(_, owner)| owner.is_none()) {
            let id = TrackId(self.next);
            self.next += 1;
            self.tracks.push(Track::new(id, time, seen, self.sigma));
            changes.born.push(id);
        }
        for track in &mut self.tracks {
            track.set_widening(self.widening);
        }
        changes
    }

    /// The obstacles in view, as of the last frame.
    pub fn tracks(&self) -> &[Track] {
        &self.tracks
    }

    /// When the last frame was exposed.
    pub fn time(&self) -> Duration {
        self.time
    }

    /// The track of every obstacle that is seen, the nearest pairs first; each track takes one at most.
    fn associate(&self, time: Duration, seen: &[Obstacle]) -> Vec<Option<usize>> {
        let mut pairs = Vec::new();
        for (number, Obstacle { footprint, .. }) in seen.iter().enumerate() {
            let (centre, bounds) = (outline::centre(footprint), footprint.bounds());
            let half = (bounds.x1 - bounds.x0).min(bounds.y1 - bounds.y0) / 2.0;
            for (index, track) in self.tracks.iter().enumerate() {
                let distance = centre.distance(track.centre_at(time));
                let near = OVERLAP * half.min(track.half_width());
                let gate = track.gate(time, GATE_SIGMAS).max(near);
                if distance <= gate {
                    pairs.push((distance, index, number));
                }
            }
        }
        pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut owners = vec![None; seen.len()];
        let mut is_taken = vec![false; self.tracks.len()];
        for (_, track, number) in pairs {
            if owners[number].is_none() && !is_taken[track] {
                owners[number] = Some(track);
                is_taken[track] = true;
            }
        }
        owners
    }
}

#[cfg(test)]
mod tests;
