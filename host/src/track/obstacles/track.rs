//! One obstacle over time, and the sets in which it will be.

use super::motion::Motion;
use super::outline::{Outline, Place, centre};
use crate::geometry::Point;
use crate::scene::Obstacle;
use crate::shape::Shape;
use std::collections::VecDeque;
use std::time::Duration;

/// Standard deviations of a coordinate that the radius of a predicted set spans: 3.03 hold 99 % of a normal
/// distribution in the plane; those of things that walk have wider tails.
pub(super) const SPANNED: f64 = 3.4;

/// An obstacle seen in fewer frames may be anything.
const KNOWN: u32 = 5;

/// Recent centres that are held against the first ones.
const RECENT: usize = 5;

/// An obstacle has moved if recent centres lie so many standard deviations of their mean from the first,
/// beyond what is in doubt.
const MOVED_SIGMAS: f64 = 5.0;

/// What has moved and then kept its place for so many frames stands: five seconds at ten a second.
const STANDS_AGAIN: u32 = 50;

/// The share of sets that may miss.
const MISSING: f64 = 0.01;

/// How fast sets grow with each that has missed.
const LEARNING: f64 = 0.15;

/// How much narrower and wider than the model sets may become.
const WIDENING: (f64, f64) = (0.75, 3.0);

/// Predictions are held against the truth after this time, a frame more or less.
const JUDGED_AFTER: Duration = Duration::from_millis(990);

/// Names an obstacle for as long as it is in view; counted from 1 and never used again.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct TrackId(pub u32);

impl std::fmt::Display for TrackId {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}", self.0)
    }
}

/// Where an obstacle may be at some moment.
#[derive(Clone, Debug, PartialEq)]
pub struct PredictedSet {
    /// Where it most likely is.
    pub footprint: Shape,
    /// How far the truth may be from that, metres.
    pub reach: f64,
}

impl PredictedSet {
    /// The distance from `point` to the set, metres; 0 inside.
    pub fn distance(&self, point: Point) -> f64 {
        (self.footprint.distance(point) - self.reach).max(0.0)
    }

    /// The set as an obstacle with an unsure edge.
    pub fn as_obstacle(&self) -> Obstacle {
        Obstacle { margin: [self.reach; 4], ..Obstacle::from(self.footprint.clone()) }
    }
}

/// A prediction that waits to be judged.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Prediction {
    made: Duration,
    motion: Motion,
}

/// One obstacle over time.
#[derive(Clone, Debug, PartialEq)]
pub struct Track {
    id: TrackId,
    time: Duration,
    motion: Motion,
    outline: Outline,
    frames: u32,
    misses: u32,
    has_moved: bool,
    /// The mean of the first centres since it last moved, and how many they are.
    anchor: (Point, u32),
    recent: VecDeque<Point>,
    /// For how many frames it has kept its place.
    still: u32,
    predictions: VecDeque<Prediction>,
    widening: f64,
    sigma: f64,
}

impl Track {
    pub(super) fn new(id: TrackId, time: Duration, seen: &Obstacle, sigma: f64) -> Self {
        let centre = centre(&seen.footprint);
        Self {
            id,
            time,
            motion: Motion::new(time, centre, sigma),
            outline: Outline::new(seen, centre, sigma),
            frames: 1,
            misses: 0,
            has_moved: false,
            anchor: (centre, 1),
            recent: VecDeque::from([centre]),
            still: 0,
            predictions: VecDeque::new(),
            widening: 1.0,
            sigma,
        }
    }

    /// Its name.
    pub fn id(&self) -> TrackId {
        self.id
    }

    /// The velocity of its centre, m/s; 0 while it stands.
    pub fn velocity(&self) -> [f64; 2] {
        if self.stands() { [0.0; 2] } else { self.motion.velocity() }
    }

    /// The standard deviation of either part of the velocity, m/s.
    pub fn velocity_sigma(&self) -> f64 {
        if self.stands() { 0.0 } else { self.motion.velocity_sigma() }
    }

    /// The outline as of the last frame.
    pub fn footprint(&self) -> Shape {
        self.predicted(Duration::ZERO).footprint
    }

    /// Whether it has been seen often enough, and not to move, or not for long: its outline then keeps still.
    pub fn stands(&self) -> bool {
        !self.has_moved && self.frames >= KNOWN
    }

    /// Whether it was seen to move, and has not kept its place for long since.
    pub fn has_moved(&self) -> bool {
        self.has_moved
    }

    /// How many frames have shown it.
    pub fn frames(&self) -> u32 {
        self.frames
    }

    /// How many frames in a row have not shown it.
    pub fn misses(&self) -> u32 {
        self.misses
    }

    /// Where it may be `after` the last frame's exposure: holds the truth in 99 % of cases up to two
    /// seconds ahead.
    pub fn predicted(&self, after: Duration) -> PredictedSet {
        let h = after.as_secs_f64();
        if self.stands() {
            let footprint = self.outline.at(self.anchor.0);
            return PredictedSet { footprint, reach: self.outline.beyond() };
        }
        let footprint = self.outline.at(self.motion.ahead(h));
        let spread = SPANNED * self.widening * self.motion.sigma_ahead(h);
        // Of an outline the noise is one more reason to be further out, not one added to the others.
        let beyond = self.outline.beyond();
        PredictedSet { footprint, reach: spread.hypot(beyond) }
    }

    /// Takes in what a frame shows of it; whether its outline is another now.
    pub(super) fn see(&mut self, time: Duration, seen: &Obstacle, widening: &mut f64) -> bool {
        let place = self.outline.place(seen);
        self.motion.advance(time);
        self.motion.correct(place.at, self.sigma.hypot(place.doubt));
        self.time = time;
        self.frames += 1;
        self.misses = 0;
        self.judge_motion(place);
        self.judge_predictions(time, widening);
        self.outline.see(seen, place.at)
    }

    /// A frame does not show it.
    pub(super) fn miss(&mut self, time: Duration) {
        self.motion.advance(time);
        self.time = time;
        self.misses += 1;
    }

    pub(super) fn set_widening(&mut self, widening: f64) {
        self.widening = widening;
    }

    pub(super) fn centre_at(&self, time: Duration) -> Point {
        centre(&self.outline.at(self.motion.at(time)))
    }

    pub(super) fn gate(&self, time: Duration, sigmas: f64) -> f64 {
        self.motion.gate(time, sigmas)
    }

    /// Half of the smaller side of what is around it.
    pub(super) fn half_width(&self) -> f64 {
        let bounds = self.outline.at(Point::new(0.0, 0.0)).bounds();
        (bounds.x1 - bounds.x0).min(bounds.y1 - bounds.y0) / 2.0
    }

    /// Whether recent centres lie apart from the first ones, or the velocity is none that noise makes. What has
    /// moved stands again when it has kept its place for long.
    fn judge_motion(&mut self, Place { at: seen, doubt }: Place) {
        self.recent.push_back(seen);
        if self.recent.len() > RECENT {
            self.recent.pop_front();
        }
        let count = self.recent.len() as f64;
        let sum = self.recent.iter().fold((0.0, 0.0), |(x, y), p| (x + p.x, y + p.y));
        let recent = Point::new(sum.0 / count, sum.1 / count);
        let (first, frames) = self.anchor;
        let noise = self.sigma * (1.0 / count + 1.0 / f64::from(frames)).sqrt();
        let [vx, vy] = self.motion.velocity();
        let is_fast = vx.hypot(vy) > MOVED_SIGMAS * self.motion.velocity_sigma();
        if is_fast || recent.distance(first) > MOVED_SIGMAS * noise + doubt {
            self.has_moved = true;
            (self.anchor, self.still) = ((seen, 1), 0);
        } else {
            self.still += 1;
            self.has_moved &= self.still < STANDS_AGAIN;
            if frames < KNOWN {
                let share = 1.0 / f64::from(frames + 1);
                let between = |a: f64, b: f64| a + share * (b - a);
                let mean = Point::new(between(first.x, seen.x), between(first.y, seen.y));
                self.anchor = (mean, frames + 1);
            }
        }
    }

    /// Holds what was predicted a second ago against where it is.
    fn judge_predictions(&mut self, now: Duration, widening: &mut f64) {
        let mut judged = None;
        while let Some(prediction) =
            self.predictions.pop_front_if(|prediction| now >= prediction.made + JUDGED_AFTER)
        {
            judged = Some(prediction);
        }
        if let Some(Prediction { made, motion }) = judged
            && self.has_moved
        {
            let error = motion.at(now).distance(self.motion.position());
            let radius = SPANNED * *widening * motion.sigma_ahead((now - made).as_secs_f64());
            let missed = if error > radius { 1.0 } else { 0.0 };
            let grown = *widening * (LEARNING * (missed - MISSING)).exp();
            *widening = grown.clamp(WIDENING.0, WIDENING.1);
        }
        if self.frames >= KNOWN {
            self.predictions.push_back(Prediction { made: now, motion: self.motion });
        }
    }
}
