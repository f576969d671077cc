//! Where one thing may be over time: its outline, moved on, and how far the truth may be from that.
//!
//! Samples every [`LAYER`]; between two of them it moves straight on, and after the last it stays. Metres,
//! seconds.

use crate::geometry::Point;
use crate::shape::Shape;
use crate::track::obstacles::Track;
use std::time::Duration;

/// The time from one sample to the next, s.
pub(super) const LAYER: f64 = 0.1;

/// How far ahead predictions are made, s.
pub(super) const HORIZON: f64 = 15.0;

/// Of a prediction the outline at one moment.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Sample {
    shift: [f64; 2],
    reach: f64,
}

/// Where one thing may be over time.
#[derive(Clone, Debug, PartialEq)]
pub struct Future {
    footprint: Shape,
    centre: Point,
    /// Of a circle around the footprint.
    radius: f64,
    samples: Vec<Sample>,
    speed: f64,
}

impl Future {
    /// The thing `footprint` that is moved by these shifts, one every `LAYER` seconds from now on, and at
    /// each moment may be as far off as the number beside it.
    pub fn new(footprint: Shape, moves: impl IntoIterator<Item = ([f64; 2], f64)>) -> Self {
        let samples: Vec<Sample> =
            moves.into_iter().map(|(shift, reach)| Sample { shift, reach }).collect();
        let pace = |pair: &[Sample]| {
            let [a, b] = [pair[0], pair[1]];
            let moved = (b.shift[0] - a.shift[0]).hypot(b.shift[1] - a.shift[1]);
            (moved + (b.reach - a.reach).abs()) / LAYER
        };
        let speed = samples.windows(2).map(pace).fold(0.0, f64::max);
        let bounds = footprint.bounds();
        let centre = bounds.centre();
        let radius = centre.distance(Point::new(bounds.x1, bounds.y1));
        Self { footprint, centre, radius, samples, speed }
    }

    /// A thing that stands, and may be `reach` further out.
    pub fn standing(footprint: Shape, reach: f64) -> Self {
        Self::new(footprint, [([0.0; 2], reach)])
    }

    /// The same thing if it stops now.
    pub fn stopped(&self) -> Self {
        Self::standing(self.footprint.clone(), self.reach(0.0))
    }

    /// A thing by its track, which was last seen `lag` ago.
    pub fn of(track: &Track, lag: Duration) -> Self {
        let now = track.predicted(lag).footprint;
        let first = now.bounds().centre();
        let layers = (HORIZON / LAYER) as u32;
        let moves = (0..=layers).map(|layer| {
            let set = track.predicted(lag + Duration::from_secs_f64(LAYER) * layer);
            let centre = set.footprint.bounds().centre();
            ([centre.x - first.x, centre.y - first.y], set.reach)
        });
        Self::new(now.clone(), moves)
    }

    /// Its outline now.
    pub fn footprint(&self) -> &Shape {
        &self.footprint
    }

    /// Where its middle most likely is.
    pub fn centre(&self, time: f64) -> Point {
        let [x, y] = self.at(time).shift;
        Point::new(self.centre.x + x, self.centre.y + y)
    }

    /// How far it may be from there, m.
    pub fn reach(&self, time: f64) -> f64 {
        self.at(time).reach
    }

    /// The distance from a point to where it most likely is, m; 0 inside. Of what is more than `enough` away
    /// it may tell less, but no less than that.
    pub fn distance(&self, point: Point, time: f64, enough: f64) -> f64 {
        let [x, y] = self.at(time).shift;
        let there = Point::new(point.x - x, point.y - y);
        let around = there.distance(self.centre) - self.radius;
        if around > enough { around } else { self.footprint.distance(there) }
    }

    /// The fastest that its outline or its edge ever comes nearer, m/s.
    pub fn speed(&self) -> f64 {
        self.speed
    }

    fn at(&self, time: f64) -> Sample {
        let place = (time / LAYER).max(0.0);
        let before = place as usize;
        let last = Sample { shift: [0.0; 2], reach: 0.0 };
        match (self.samples.get(before), self.samples.get(before + 1)) {
            (Some(a), Some(b)) => {
                let share = place - before as f64;
                let between = |a: f64, b: f64| a + share * (b - a);
                Sample {
                    shift: [0, 1].map(|axis| between(a.shift[axis], b.shift[axis])),
                    reach: between(a.reach, b.reach),
                }
            }
            _ => self.samples.last().copied().unwrap_or(last),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shape::Circle;
    use crate::track::obstacles::Tracker;

    fn disc(x: f64) -> Shape {
        Circle { centre: Point::new(x, 0.0), radius: 0.1 }.into()
    }

    #[test]
    fn between_samples_by_hand() {
        let moves = [([0.0, 0.0], 0.0), ([0.02, 0.0], 0.01), ([0.04, 0.0], 0.02)];
        let future = Future::new(disc(1.0), moves);
        assert!((future.centre(0.15).x - 1.03).abs() < 1e-12);
        assert!((future.reach(0.15) - 0.015).abs() < 1e-12);
        assert!((future.centre(9.0).x - 1.04).abs() < 1e-12, "it stays at its last place");
        let distance = future.distance(Point::new(0.5, 0.0), 0.15, 1.0);
        assert!((distance - 0.43).abs() < 1e-12, "{distance}");
        assert!((future.speed() - 0.3).abs() < 1e-9, "0.2 m/s, and its edge grows by 0.1 m/s");
        let stopped = future.stopped();
        assert_eq!((stopped.centre(1.0), stopped.reach(1.0)), (Point::new(1.0, 0.0), 0.0));
    }

    #[test]
    fn a_track_goes_on_as_it_went() {
        let mut tracker = Tracker::default();
        for frame in 0..20u32 {
            tracker.update(
                100 * Duration::from_millis(frame.into()),
                &[disc(0.02 * f64::from(frame)).into()],
            );
        }
        // Seen last at 0.38 m, 0.1 s ago, at 0.2 m/s.
        let future = Future::of(&tracker.tracks()[0], Duration::from_millis(100));
        assert!((future.centre(0.0).x - 0.4).abs() < 0.003);
        assert!((future.centre(2.0).x - 0.8).abs() < 0.02);
        assert!(future.reach(2.0) > future.reach(0.5));
    }
}
