//! Two wheel encoders: counts from angles, with what real ones do to them.
//!
//! A count is an edge of the two phases. Edges of a cheap disc are not evenly spaced, an edge may be
//! missed, and a loose wire adds counts that nothing turned. Angles in rad, shares 0..=1.

use std::f64::consts::TAU;

/// What an encoder is like.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Encoder {
    /// Edges in one turn of a wheel, of both phases.
    pub counts_per_turn: u32,
    /// Where inside a count each encoder starts, 0..1; left and right.
    pub phase: [f64; 2],
    /// By how much of a count each of four edges on end comes late, 0..1.
    pub late: [f64; 4],
    /// Share of the edges that are missed.
    pub missed: f64,
    /// Whether it sits before the gear, so that it does not see the gear's play.
    pub before_gear: bool,
}

impl Encoder {
    /// Even edges, none missed.
    pub const fn even(counts_per_turn: u32, phase: [f64; 2]) -> Self {
        Self { counts_per_turn, phase, late: [0.0; 4], missed: 0.0, before_gear: false }
    }
}

/// What an encoder may do instead of counting.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum EncoderFault {
    /// Nothing: it counts.
    #[default]
    None,
    /// Its wire is off: it stands still.
    Stuck,
    /// Its wires are swapped: it counts backwards.
    Reversed,
    /// It counts this many times what it should.
    Scaled(f64),
    /// Each reading is off by up to so many counts.
    Noisy(u32),
    /// It misses this share of the edges.
    Missing(f64),
}

/// Both encoders of a base, left and right.
#[derive(Clone, Debug)]
pub(crate) struct Encoders {
    encoder: Encoder,
    counted: [f64; 2],
    missed: [i32; 2],
    noise: [i32; 2],
    random: fastrand::Rng,
}

impl Encoders {
    /// Encoders that have not turned yet; what they miss is drawn from a seed of their own.
    pub(crate) fn new(encoder: Encoder) -> Self {
        Self {
            encoder,
            counted: [0.0; 2],
            missed: [0; 2],
            noise: [0; 2],
            random: fastrand::Rng::with_seed(1),
        }
    }

    pub(crate) fn design(&self) -> &Encoder {
        &self.encoder
    }

    /// Takes in how far each turned.
    pub(crate) fn turn(&mut self, mut angles: [f64; 2], faults: [EncoderFault; 2], swapped: bool) {
        if swapped {
            angles.swap(0, 1);
        }
        for wheel in 0..2 {
            let (angle, missed) = match faults[wheel] {
                EncoderFault::None | EncoderFault::Noisy(_) => (angles[wheel], self.encoder.missed),
                EncoderFault::Stuck => (0.0, 0.0),
                EncoderFault::Reversed => (-angles[wheel], self.encoder.missed),
                EncoderFault::Scaled(factor) => (factor * angles[wheel], self.encoder.missed),
                EncoderFault::Missing(share) => (angles[wheel], share),
            };
            let before = self.edge(wheel);
            self.counted[wheel] += angle;
            if missed > 0.0 {
                let edges = self.edge(wheel).wrapping_sub(before);
                let lost = (0..edges.unsigned_abs()).filter(|_| self.random.f64() < missed).count();
                self.missed[wheel] += edges.signum() * lost as i32;
            }
        }
    }

    /// Draws what a loose wire adds to the next reading.
    pub(crate) fn shake(&mut self, faults: [EncoderFault; 2]) {
        for (noise, fault) in self.noise.iter_mut().zip(faults) {
            *noise = match fault {
                EncoderFault::Noisy(counts) => {
                    let most = i32::try_from(counts).unwrap_or(i32::MAX);
                    self.random.i32(-most..=most)
                }
                _ => 0,
            };
        }
    }

    /// What is read, left and right.
    pub(crate) fn counts(&self) -> [i32; 2] {
        [0, 1].map(|wheel| {
            self.edge(wheel).wrapping_sub(self.missed[wheel]).wrapping_add(self.noise[wheel])
        })
    }

    /// How far each has turned, as far as it noticed, rad.
    #[cfg(test)]
    pub(crate) fn angles(&self) -> [f64; 2] {
        self.counted
    }

    /// The edge that was passed last.
    fn edge(&self, wheel: usize) -> i32 {
        let per_radian = f64::from(self.encoder.counts_per_turn) / TAU;
        let place = self.counted[wheel] * per_radian + self.encoder.phase[wheel];
        let edge = place.floor();
        let [a, b, c, d] = self.encoder.late;
        let late = match (edge as i64).rem_euclid(4) {
            0 => a,
            1 => b,
            2 => c,
            _ => d,
        };
        edge as i32 - i32::from(place - edge < late)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FAULTS: [EncoderFault; 2] = [EncoderFault::None; 2];

    #[test]
    fn late_edges_come_late_and_none_is_lost() {
        let late = [0.0, 0.25, 0.0, 0.5];
        let mut encoders = Encoders::new(Encoder { late, ..Encoder::even(360, [0.0; 2]) });
        let degree = TAU / 360.0;
        encoders.turn([1.2 * degree, 3.4 * degree], FAULTS, false);
        assert_eq!(encoders.counts(), [0, 2]);
        encoders.turn([0.1 * degree, 0.2 * degree], FAULTS, false);
        assert_eq!(encoders.counts(), [1, 3]);
        encoders.turn([358.9 * degree, 356.5 * degree], FAULTS, false);
        assert_eq!(encoders.counts(), [360, 360]);
    }

    #[test]
    fn missed_edges_are_the_share_that_was_asked_for() {
        let mut encoders = Encoders::new(Encoder::even(1440, [0.5; 2]));
        let faults = [EncoderFault::Missing(0.1), EncoderFault::Scaled(0.5)];
        (0..20_000).for_each(|_| encoders.turn([0.01; 2], faults, false));
        let all = 200.0 / TAU * 1440.0;
        let [missing, half] = encoders.counts().map(f64::from);
        assert!((missing / all - 0.9).abs() < 0.005, "{missing} of {all}");
        assert!((half / all - 0.5).abs() < 1e-3, "{half} of {all}");
    }

    #[test]
    fn swapped_encoders_count_the_other_wheel_and_noise_is_bounded() {
        let mut encoders = Encoders::new(Encoder::even(360, [0.5; 2]));
        encoders.turn([1.0, 0.0], FAULTS, true);
        assert_eq!(encoders.counts(), [0, 57]);
        let noisy = [EncoderFault::Noisy(3); 2];
        let mut seen = [false; 7];
        for _ in 0..200 {
            encoders.shake(noisy);
            let [left, _] = encoders.counts();
            seen[usize::try_from(left + 3).unwrap()] = true;
        }
        assert_eq!(seen, [true; 7]);
    }
}
