//! How an obstacle's centre moves: a Kalman filter of constant velocity, and how far off it may be.
//!
//! Both axes have the same covariance, because nothing in the model tells them apart.
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | p, v | position and velocity of the centre | m, m/s |
//! | q | density of the acceleration's white noise | m²/s³ |
//! | R | variance of a measured coordinate | m² |
//! | ν²/S | squared innovation over its variance; 2 on average where the model is right | – |
//!
//! Things that walk do not accelerate like white noise: they sway, and then turn for good. The sway is
//! what q and the innovations measure; the turn is allowed for by [`WANDERING`], which grows with the
//! time ahead as the spread of a velocity does.

use crate::geometry::Point;
use std::time::Duration;

/// q, m²/s³: a speed of 0.1 m/s is forgotten after half a minute.
const NOISE: f64 = 3e-4;

/// A new obstacle may move this fast, one standard deviation, m/s.
const FIRST_SPEED: f64 = 0.2;

/// What a thing that moves changes of its velocity soon, one standard deviation, m/s.
const WANDERING: f64 = 0.03;

/// By how much a velocity may be another in the next frame, m/s.
const TURNED_ABOUT: f64 = 0.5;

/// The variance of what sways within a few frames, in variances of a measured coordinate: no filter of
/// a steady velocity sees that it sways, only that it seems to be measured badly.
const SWAYING: f64 = 2.0;

/// An innovation of which ν²/S is greater is no noise, which reaches it once in a thousand frames: the thing has
/// stopped or turned. It is where it was seen then, but for this share of the measured variance; how fast it
/// will be is as unsure as ever of things that sway, and is left to the next frames.
const STARTLING: f64 = 14.0;
const SEEN: f64 = 0.8;

/// Innovations are averaged over so many frames.
const AVERAGED: f64 = 20.0;

/// How much less and more than expected the innovations may make the covariance.
const TUNING: (f64, f64) = (0.3, 5.0);

/// Position and velocity of a centre, with their covariance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Motion {
    time: Duration,
    /// When it was last seen.
    seen: Duration,
    position: Point,
    velocity: [f64; 2],
    /// Var p, Cov(p, v), Var v, of either axis.
    covariance: [f64; 3],
    /// The mean of ν²/S.
    surprise: f64,
    /// Of a coordinate as it was last measured.
    variance: f64,
}

impl Motion {
    /// A centre seen for the first time; `sigma` is the standard deviation of a measured coordinate.
    pub(super) fn new(time: Duration, position: Point, sigma: f64) -> Self {
        let variance = sigma * sigma;
        Self {
            time,
            seen: time,
            position,
            velocity: [0.0; 2],
            covariance: [variance, 0.0, FIRST_SPEED * FIRST_SPEED],
            surprise: 2.0,
            variance,
        }
    }

    pub(super) fn position(&self) -> Point {
        self.position
    }

    pub(super) fn velocity(&self) -> [f64; 2] {
        self.velocity
    }

    pub(super) fn velocity_sigma(&self) -> f64 {
        self.covariance[2].sqrt()
    }

    /// Moves on to `time`.
    pub(super) fn advance(&mut self, time: Duration) {
        let h = time.saturating_sub(self.time).as_secs_f64();
        self.position = self.ahead(h);
        self.covariance = self.covariance_ahead(h);
        self.time = time;
    }

    /// Takes in where the centre was seen at the filter's time; `sigma` is the standard deviation of a coordinate.
    pub(super) fn correct(&mut self, seen: Point, sigma: f64) {
        self.seen = self.time;
        self.variance = sigma * sigma;
        let [p, c, v] = self.covariance;
        let s = p + self.variance;
        let mut gain = [p / s, c / s];
        let difference = [seen.x - self.position.x, seen.y - self.position.y];
        let squared = (difference[0].powi(2) + difference[1].powi(2)) / s;
        if squared > STARTLING {
            gain[0] = gain[0].max(SEEN);
        }
        self.surprise += (squared - self.surprise) / AVERAGED;
        self.position.x += gain[0] * difference[0];
        self.position.y += gain[0] * difference[1];
        self.velocity[0] += gain[1] * difference[0];
        self.velocity[1] += gain[1] * difference[1];
        // What it is for any gain of the position.
        let (left, r) = (1.0 - gain[0], self.variance);
        self.covariance = [
            left * left * p + gain[0] * gain[0] * r,
            left * (c - gain[1] * p) + gain[0] * gain[1] * r,
            v - gain[1] * c,
        ];
    }

    /// The centre after `h` seconds.
    pub(super) fn ahead(&self, h: f64) -> Point {
        let [vx, vy] = self.velocity;
        Point::new(self.position.x + h * vx, self.position.y + h * vy)
    }

    fn covariance_ahead(&self, h: f64) -> [f64; 3] {
        let [p, c, v] = self.covariance;
        [
            p + 2.0 * h * c + h * h * v + NOISE * h.powi(3) / 3.0,
            c + h * v + NOISE * h * h / 2.0,
            v + NOISE * h,
        ]
    }

    /// The standard deviation of a coordinate of the centre after `h` seconds, m.
    pub(super) fn sigma_ahead(&self, h: f64) -> f64 {
        let tuned = (self.surprise / 2.0).clamp(TUNING.0, TUNING.1);
        let sway = SWAYING * self.variance;
        let unseen = self.time.saturating_sub(self.seen).as_secs_f64() + h;
        (tuned * self.covariance_ahead(h)[0] + sway + (WANDERING * unseen).powi(2)).sqrt()
    }

    /// How far from the prediction for `time` the centre may be seen, m: `sigmas` standard deviations, and
    /// what a thing that turns about from one frame to the next is off.
    pub(super) fn gate(&self, time: Duration, sigmas: f64) -> f64 {
        let h = time.saturating_sub(self.time).as_secs_f64();
        sigmas * (self.sigma_ahead(h).powi(2) + self.variance).sqrt() + TURNED_ABOUT * h
    }

    /// The centre at `time`.
    pub(super) fn at(&self, time: Duration) -> Point {
        self.ahead(time.saturating_sub(self.time).as_secs_f64())
    }
}

#[cfg(test)]
mod tests {
    use super::super::track::SPANNED;
    use super::*;

    #[test]
    fn two_sightings_by_hand() {
        let mut motion = Motion::new(Duration::ZERO, Point::new(0.0, 0.0), 0.005);
        motion.advance(Duration::from_secs(1));
        // Var p = 25e-6 + 0.04 + q/3, Cov = 0.04 + q/2, S = Var p + 25e-6.
        let s = 25e-6 + 0.04 + NOISE / 3.0 + 25e-6;
        motion.correct(Point::new(0.1, 0.0), 0.005);
        assert!((motion.position().x - 0.1 * (s - 25e-6) / s).abs() < 1e-12);
        assert!((motion.velocity()[0] - 0.1 * (0.04 + NOISE / 2.0) / s).abs() < 1e-12);
        assert_eq!(motion.velocity()[1], 0.0);
    }

    /// It goes at 0.2 m/s, and its velocity takes a second to follow; its place does not: it is never further off
    /// than a predicted set spans, in standard deviations.
    #[test]
    fn what_stops_at_once_stays_in_its_set() {
        let mut motion = Motion::new(Duration::ZERO, Point::new(0.0, 0.0), 0.005);
        for frame in 1..=35u64 {
            motion.advance(Duration::from_millis(100 * frame));
            let there = Point::new(0.02 * frame.min(30) as f64, 0.0);
            motion.correct(there, 0.005);
            if frame > 5 {
                let off = motion.position().distance(there);
                assert!(off < SPANNED * motion.sigma_ahead(0.0), "{off} in frame {frame}");
            }
        }
    }

    #[test]
    fn the_spread_grows_with_the_time_ahead_and_shrinks_with_sightings() {
        let mut motion = Motion::new(Duration::ZERO, Point::new(0.0, 0.0), 0.005);
        let first = motion.sigma_ahead(2.0);
        for frame in 1..=20u64 {
            motion.advance(Duration::from_millis(100 * frame));
            motion.correct(Point::new(0.016 * frame as f64, 0.0), 0.005);
        }
        let settled = [0.0, 0.5, 1.0, 2.0].map(|h| motion.sigma_ahead(h));
        assert!(settled.is_sorted() && settled[3] < first / 4.0, "{first} {settled:?}");
        assert!((motion.velocity()[0] - 0.16).abs() < 0.005 && motion.velocity_sigma() < 0.03);
    }
}
