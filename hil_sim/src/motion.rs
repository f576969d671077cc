//! Shapes that move over the floor, and where they are at a time. Metres and seconds.
//!
//! A mover never turns and never stops for anything: whoever stands in its way is pushed.

use crate::world::Shape;
use std::time::Duration;

/// How a shape moves.
#[derive(Clone, Debug, PartialEq)]
pub enum Motion {
    /// It stays where it is.
    Still,
    /// Always on, m/s along x and y.
    Velocity([f64; 2]),
    /// From where it stands by the way that these shifts make, m, at one speed.
    Way {
        /// Shifts from where it stood at first, one after the other.
        shifts: Vec<[f64; 2]>,
        /// m/s.
        speed: f64,
        /// Whether it goes back to its place and begins again; else it stays at the last.
        again: bool,
    },
}

impl Motion {
    /// How far from its first place a shape is after `seconds`.
    ///
    /// ```
    /// use wmr_sim::motion::Motion;
    /// let motion = Motion::Way { shifts: vec![[1.0, 0.0], [1.0, 2.0]], speed: 0.5, again: false };
    /// assert_eq!(motion.shift(1.0), [0.5, 0.0]);
    /// assert_eq!(motion.shift(4.0), [1.0, 1.0]);
    /// assert_eq!(motion.shift(60.0), [1.0, 2.0]);
    /// ```
    pub fn shift(&self, seconds: f64) -> [f64; 2] {
        match self {
            Self::Still => [0.0; 2],
            Self::Velocity(velocity) => velocity.map(|speed| speed * seconds),
            Self::Way { shifts, speed, again } => along(shifts, speed * seconds, *again),
        }
    }
}

fn along(shifts: &[[f64; 2]], mut length: f64, again: bool) -> [f64; 2] {
    let stops: Vec<[f64; 2]> = [[0.0; 2]]
        .into_iter()
        .chain(shifts.iter().copied())
        .chain(again.then_some([0.0; 2]))
        .collect();
    let legs = || stops.iter().zip(stops.iter().skip(1));
    let long = |a: &[f64; 2], b: &[f64; 2]| (b[0] - a[0]).hypot(b[1] - a[1]);
    let whole: f64 = legs().map(|(a, b)| long(a, b)).sum();
    if again && whole > 0.0 {
        length %= whole;
    }
    for (a, b) in legs() {
        let leg = long(a, b);
        if length < leg {
            return [0, 1].map(|axis| a[axis] + length / leg * (b[axis] - a[axis]));
        }
        length -= leg;
    }
    stops.last().copied().unwrap_or_default()
}

/// A shape on its way.
#[derive(Clone, Debug, PartialEq)]
pub struct Mover {
    first: Shape,
    motion: Motion,
    began: Duration,
    shape: Shape,
}

impl Mover {
    /// A shape that stands there at `began` and moves from then on.
    pub fn new(shape: Shape, motion: Motion, began: Duration) -> Self {
        Self { first: shape.clone(), motion, began, shape }
    }

    /// The shape where it is now.
    pub fn shape(&self) -> &Shape {
        &self.shape
    }

    /// Where it stood at first, and since when it moves.
    pub fn origin(&self) -> (&Shape, Duration) {
        (&self.first, self.began)
    }

    /// How far from its first place it is at `now`, m.
    pub fn shift(&self, now: Duration) -> [f64; 2] {
        self.motion.shift(now.saturating_sub(self.began).as_secs_f64())
    }

    /// Whether it is the mover that this shape and motion made.
    pub(crate) fn is_made_of(&self, shape: &Shape, motion: &Motion) -> bool {
        self.first == *shape && self.motion == *motion
    }

    /// Lets it be where it is at `now`.
    pub fn advance(&mut self, now: Duration) {
        self.shape = self.first.shifted(self.shift(now));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_round_trip_comes_back_and_begins_again() {
        let shifts = vec![[3.0, 0.0], [3.0, 4.0]];
        let motion = Motion::Way { shifts, speed: 1.0, again: true };
        for (seconds, expected) in
            [(0.0, [0.0, 0.0]), (5.0, [3.0, 2.0]), (9.5, [1.5, 2.0]), (17.0, [3.0, 2.0])]
        {
            let [x, y] = motion.shift(seconds);
            assert!((x - expected[0]).hypot(y - expected[1]) < 1e-12, "{seconds}: {x} {y}");
        }
    }

    #[test]
    fn a_mover_starts_when_it_begins() {
        let shape = Shape::Circle([1.0, 1.0, 0.1]);
        let second = Duration::from_secs(1);
        let mut mover = Mover::new(shape.clone(), Motion::Velocity([0.2, -0.1]), second);
        mover.advance(Duration::ZERO);
        assert_eq!(mover.shape(), &shape);
        mover.advance(3 * second);
        assert_eq!(mover.shape(), &Shape::Circle([1.4, 0.8, 0.1]));
    }
}
