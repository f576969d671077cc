//! What a camera and its place predict for the border, and the least squares over both.
//!
//! Symbols: f focal length, c principal point (pixels), k radial coefficient, R rotation and p position of the
//! camera in the arena frame, P a point of the floor (metres), n the ideal and d the bent ray, u the pixel:
//!
//! ```text
//! X = R (P − p)    n = (X₁/X₃, X₂/X₃)    d = n (1 + k |n|²)    u = f d + c
//! ```
//! A step of light at the pixel u₀ on a side of the arena is one observation, of the distance across that
//! side only: `N·(u₀ − u(P)) = 0`, N the side's normal in the picture. What shifts a whole side (a
//! wall's shadow, tape that is not quite straight, a tape measure) shifts all its steps alike. So each side has a
//! shift and a slant of its own, pixels, that are usually small: many steps do not make a side surer than that.
//!
//! Unknowns: ln f, c, k, and for each place of the camera a turn, p and the sides' shifts and slants.

use super::observe::{ObservedBorder, Sighting};
use crate::geometry::{Arena, PerSide, Side};
use crate::vision::camera::{PlanMap, columns, side_point};
use crate::vision::least_squares::tukey;
use nalgebra::{DMatrix, DVector, Matrix3, Rotation3, SVector, Vector3};

/// Unknowns of the lens: ln f, c, k.
pub(super) const LENS: usize = 4;
/// Unknowns of a place of the camera that move its picture: turn and position.
const MOVES: usize = 6;
/// All unknowns of a place: with the shifts and slants of four sides.
pub(super) const STAND: usize = MOVES + 8;
/// The step of numeric derivatives: unknowns are of the size of 1, but for c in pixels.
const NUDGE: f64 = 1e-5;

/// What stays the same wherever the camera stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Lens {
    pub(super) focal: f64,
    pub(super) centre: [f64; 2],
    pub(super) radial: f64,
}

/// Where the camera stands, and by how much the border's sides are off there.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Stand {
    pub(super) rotation: Rotation3<f64>,
    pub(super) position: Vector3<f64>,
    /// For sides 0..3: the shift of their middle, and by how much more their last end is shifted, pixels
    /// along the normal.
    pub(super) offsets: PerSide<[f64; 2]>,
}

/// All unknowns.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct State {
    pub(super) lens: Lens,
    pub(super) stands: Vec<Stand>,
}

/// An unknown that is known to be near a value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Prior {
    pub(super) unknown: Unknown,
    pub(super) value: f64,
    pub(super) spread: f64,
}

/// The unknowns that something may be known of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Unknown {
    /// ln f.
    LogFocal,
    /// The principal point's x (0) or y (1).
    Centre(usize),
    Radial,
    /// The camera's place in the arena frame, the first one.
    X,
    Y,
    Height,
    /// The shift (0) or slant (1) of a side.
    Offset {
        stand: usize,
        side: Side,
        which: usize,
    },
}

impl Lens {
    fn moved(self, change: [f64; LENS]) -> Self {
        let [log_focal, x, y, radial] = change;
        Self {
            focal: self.focal * log_focal.exp(),
            centre: [self.centre[0] + x, self.centre[1] + y],
            radial: self.radial + radial,
        }
    }
}

impl Stand {
    /// The place from which a camera of that focal length sees the floor by `map`.
    pub(super) fn of(map: &PlanMap, focal: f64) -> Option<Self> {
        let [a, b, t] = columns(&map.centred_homography(), focal);
        // The floor lies before the camera.
        let scale = (2.0 / (a.norm() + b.norm())).copysign(t.z);
        let x = (a * scale).try_normalize(1e-12)?;
        let b = b * scale;
        let y = (b - x * x.dot(&b)).try_normalize(1e-12)?;
        let rotation = Matrix3::from_columns(&[x, y, x.cross(&y)]);
        let position = -(rotation.transpose() * t * scale);
        let rotation = Rotation3::from_matrix_unchecked(rotation);
        Some(Self { rotation, position, offsets: PerSide::all([0.0; 2]) })
    }

    fn moved(&self, change: [f64; MOVES]) -> Self {
        let [a, b, c, x, y, z] = change;
        Self {
            rotation: Rotation3::new(Vector3::new(a, b, c)) * self.rotation,
            position: self.position + Vector3::new(x, y, z),
            offsets: self.offsets,
        }
    }

    /// The pixel of a floor point.
    pub(super) fn pixel(&self, lens: &Lens, x: f64, y: f64) -> [f64; 2] {
        let seen = self.rotation * (Vector3::new(x, y, 0.0) - self.position);
        let ideal = [seen.x / seen.z, seen.y / seen.z];
        let bend = 1.0 + lens.radial * (ideal[0] * ideal[0] + ideal[1] * ideal[1]);
        [0, 1].map(|axis| lens.focal * bend * ideal[axis] + lens.centre[axis])
    }

    /// Where along the normal of its side a sighting is expected, pixels.
    fn expected(&self, lens: &Lens, arena: Arena, sighting: &Sighting) -> f64 {
        let point = side_point(arena, sighting.side, sighting.along, 0.0);
        let pixel = self.pixel(lens, point.x, point.y);
        let [shift, slant] = self.offsets[sighting.side];
        let [by_shift, by_slant] = sighting.shares();
        let offset = shift * by_shift + slant * by_slant;
        sighting.normal[0] * pixel[0] + sighting.normal[1] * pixel[1] + offset
    }
}

impl State {
    pub(super) fn unknowns(&self) -> usize {
        LENS + STAND * self.stands.len()
    }

    /// The state that a change of all unknowns leads to.
    pub(super) fn moved(&self, change: &DVector<f64>) -> Self {
        let lens = self.lens.moved([0, 1, 2, 3].map(|i| change[i]));
        let stands = (0..).zip(&self.stands).map(|(index, stand): (usize, _)| {
            let first = LENS + STAND * index;
            let mut moved = stand.moved([0, 1, 2, 3, 4, 5].map(|i| change[first + i]));
            for side in Side::ALL {
                for which in 0..2 {
                    moved.offsets[side][which] += change[offset_index(index, side, which)];
                }
            }
            moved
        });
        Self { lens, stands: stands.collect() }
    }

    /// The value of an unknown.
    pub(super) fn value(&self, unknown: Unknown) -> f64 {
        match unknown {
            Unknown::LogFocal => self.lens.focal.ln(),
            Unknown::Centre(axis) => self.lens.centre[axis],
            Unknown::Radial => self.lens.radial,
            Unknown::X => self.stands[0].position.x,
            Unknown::Y => self.stands[0].position.y,
            Unknown::Height => self.stands[0].position.z,
            Unknown::Offset { stand, side, which } => self.stands[stand].offsets[side][which],
        }
    }
}

impl Unknown {
    pub(super) fn index(self) -> usize {
        match self {
            Self::LogFocal => 0,
            Self::Centre(axis) => 1 + axis,
            Self::Radial => 3,
            Self::X => LENS + 3,
            Self::Y => LENS + 4,
            Self::Height => LENS + 5,
            Self::Offset { stand, side, which } => offset_index(stand, side, which),
        }
    }
}

/// Where among the unknowns the shift (0) or slant (1) of a side is.
fn offset_index(stand: usize, side: Side, which: usize) -> usize {
    LENS + STAND * stand + MOVES + 2 * side as usize + which
}

/// The observations and what is known beforehand.
pub(super) struct Problem<'a> {
    pub(super) arena: Arena,
    /// For each place of the camera what was seen from there.
    pub(super) views: &'a [Vec<&'a ObservedBorder>],
    pub(super) priors: Vec<Prior>,
}

impl Problem<'_> {
    pub(super) fn sightings(&self) -> impl Iterator<Item = (usize, &Sighting)> {
        let borders = self.views.iter().enumerate();
        borders.flat_map(|(stand, seen)| {
            seen.iter().flat_map(move |border| border.sightings.iter().map(move |one| (stand, one)))
        })
    }

    /// The distances of all sightings across their sides, pixels.
    pub(super) fn distances(&self, state: &State) -> Vec<f64> {
        let distance = |(stand, sighting): (usize, &Sighting)| {
            sighting.place() - state.stands[stand].expected(&state.lens, self.arena, sighting)
        };
        self.sightings().map(distance).collect()
    }

    /// The weights of all sightings, 0 for those off by `reach` times their noise.
    pub(super) fn weights(&self, state: &State, reach: f64) -> Vec<f64> {
        let seen = self.distances(state).into_iter().zip(self.sightings());
        seen.map(|(far, (_, of))| tukey(far / (reach * of.noise)) / (of.noise * of.noise)).collect()
    }

    /// The sum of squares of the sightings, by their weights, and of the priors, in standard deviations.
    pub(super) fn cost(&self, state: &State, weights: &[f64]) -> f64 {
        let seen = self.distances(state).into_iter().zip(weights);
        seen.map(|(far, weight)| weight * far * far).sum::<f64>() + self.strain(state, |_| true)
    }

    /// The same with the priors for which `counts`, and sightings whose square stops growing at `reach`
    /// times their noise: to compare states that leave out different ones.
    pub(super) fn misfit(
        &self,
        state: &State,
        reach: f64,
        counts: impl Fn(Unknown) -> bool,
    ) -> f64 {
        let seen = self.distances(state).into_iter().zip(self.sightings());
        let square = |(far, (_, of)): (f64, (usize, &Sighting))| {
            let kept = 1.0 - (far / (reach * of.noise)).powi(2).min(1.0);
            reach * reach / 3.0 * (1.0 - kept.powi(3))
        };
        seen.map(square).sum::<f64>() + self.strain(state, counts)
    }

    /// The sum of squares, in standard deviations, of the priors for which `counts`.
    pub(super) fn strain(&self, state: &State, counts: impl Fn(Unknown) -> bool) -> f64 {
        let known = self.priors.iter().filter(|prior| counts(prior.unknown));
        known.map(|prior| ((state.value(prior.unknown) - prior.value) / prior.spread).powi(2)).sum()
    }

    /// The normal equations around a state: the matrix, which is the inverse covariance, and the right side.
    pub(super) fn normal_equations(
        &self,
        state: &State,
        weights: &[f64],
    ) -> (DMatrix<f64>, DVector<f64>) {
        let unknowns = state.unknowns();
        let mut matrix = DMatrix::zeros(unknowns, unknowns);
        let mut right = DVector::zeros(unknowns);
        for prior in &self.priors {
            let (index, square) = (prior.unknown.index(), prior.spread * prior.spread);
            matrix[(index, index)] += 1.0 / square;
            right[index] += (prior.value - state.value(prior.unknown)) / square;
        }
        let nudged: Vec<_> = state.stands.iter().map(|stand| nudged(&state.lens, stand)).collect();
        for ((stand, sighting), &weight) in self.sightings().zip(weights) {
            let expected = |of: &(Lens, Stand)| of.1.expected(&of.0, self.arena, sighting);
            let far = sighting.place() - expected(&(state.lens, state.stands[stand].clone()));
            let mut row = SVector::<f64, { LENS + STAND }>::zeros();
            for (slope, [less, more]) in row.iter_mut().zip(&nudged[stand]) {
                *slope = (expected(more) - expected(less)) / (2.0 * NUDGE);
            }
            let [by_shift, by_slant] = sighting.shares();
            row[LENS + MOVES + 2 * sighting.side as usize] = by_shift;
            row[LENS + MOVES + 2 * sighting.side as usize + 1] = by_slant;
            // The lens comes first, then the unknowns of all places.
            let place = |i: usize| if i < LENS { i } else { i + STAND * stand };
            for i in 0..LENS + STAND {
                right[place(i)] += weight * far * row[i];
                for j in 0..LENS + STAND {
                    matrix[(place(i), place(j))] += weight * row[i] * row[j];
                }
            }
        }
        (matrix, right)
    }
}

/// Lens and place with each of their moving unknowns a little less and a little more.
fn nudged(lens: &Lens, stand: &Stand) -> Vec<[(Lens, Stand); 2]> {
    let moved = |index: usize, by: f64| {
        let mut of_lens = [0.0; LENS];
        let mut of_stand = [0.0; MOVES];
        match index.checked_sub(LENS) {
            None => of_lens[index] = by,
            Some(index) => of_stand[index] = by,
        }
        (lens.moved(of_lens), stand.moved(of_stand))
    };
    (0..LENS + MOVES).map(|index| [moved(index, -NUDGE), moved(index, NUDGE)]).collect()
}
