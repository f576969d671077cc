//! The tag's corners from all its edges at once: the picture of the known pattern is fitted to the photo.
//!
//! A blurred pattern of cells c_ij shows t(u, v) = Σ c_ij W_i(u) W_j(v), W_i(u) = Φ((i + 1 − u)/σ_u) − Φ((i − u)/σ_u),
//! at the place (u, v) in cells, with σ_u the blur across an edge of constant u. The photo's brightness is
//! b + d (t + k t (1 − t)): black, the step to white, and a bend k that stands for a camera's tone curve and for
//! ink that spreads. Eight numbers of the map from photo to cells, the blur, b, d and k are found by
//! Gauss-Newton. Since black and white edges alternate, k is no matter of the tag's size.

use super::dark::Grey;
use super::decode::cells_to_photo;
use nalgebra::{Matrix3, SMatrix, SVector, Vector3};

/// Numbers that are fitted: the map's eight, logarithm of the blur, b, d and d k.
const NUMBERS: usize = 12;
/// Around the tag's ring so many cells of the white rim are looked at.
const RIM: f64 = 0.5;
/// Pixels looked at for one tag, about.
const SAMPLES: f64 = 900.0;
const MOST_STEPS: usize = 8;
/// Steps end when corners move less, pixels.
const SETTLED: f64 = 0.004;
/// The blur of most pictures and the range that is believed, pixels.
const USUAL_BLUR: f64 = 0.8;
const BLURS: std::ops::RangeInclusive<f64> = 0.35..=4.0;
/// Corners move by at most this from where the outline had them: pixels, and cells.
const FARTHEST: [f64; 2] = [0.6, 0.6];

/// Corners and the share of the photo's variance that the pattern explains.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fitted {
    pub(super) corners: [[f64; 2]; 4],
    pub(super) explained: f64,
}

/// A pattern with its ring, and the photo to which it is fitted.
struct Problem<'a> {
    cells: &'a [bool],
    width: usize,
    centre: [f64; 2],
    unit: f64,
    samples: Vec<[f64; 3]>,
}

struct State {
    /// From pixels about the centre in units to cells.
    map: Matrix3<f64>,
    /// The map at the beginning of a step, by which blur is measured in cells: slopes hold it fixed.
    steepness: Matrix3<f64>,
    blur: f64,
    tone: [f64; 3],
}

/// Fits the pattern whose top left corner is `corners[0]`; `None` if it runs away.
pub(super) fn fit(grey: &Grey, corners: [[f64; 2]; 4], cells: &[bool]) -> Option<Fitted> {
    let width = cells.len().isqrt();
    let problem = Problem::new(grey, corners, cells, width)?;
    let mut state = problem.start(corners)?;
    let mut seen = corners;
    let mut explained = 0.0;
    for _ in 0..MOST_STEPS {
        explained = problem.step(&mut state)?;
        let next = problem.corners(&state)?;
        let moved = (0..4).map(|i| distance(next[i], seen[i])).fold(0.0, f64::max);
        seen = next;
        if moved < SETTLED {
            break;
        }
    }
    let shortest =
        (0..4).map(|i| distance(corners[i], corners[(i + 1) % 4])).fold(f64::MAX, f64::min);
    let farthest = FARTHEST[0] + FARTHEST[1] * shortest / width as f64;
    let near = (0..4).all(|i| distance(seen[i], corners[i]) <= farthest);
    near.then_some(Fitted { corners: seen, explained })
}

fn distance([a, b]: [f64; 2], [c, d]: [f64; 2]) -> f64 {
    (c - a).hypot(d - b)
}

impl<'a> Problem<'a> {
    fn new(grey: &Grey, corners: [[f64; 2]; 4], cells: &'a [bool], width: usize) -> Option<Self> {
        let centre = [0, 1].map(|axis| corners.iter().map(|c| c[axis]).sum::<f64>() / 4.0);
        let unit = corners.iter().map(|&c| distance(c, centre)).fold(1.0, f64::max);
        let mut problem = Self { cells, width, centre, unit, samples: Vec::new() };
        let map = cells_to_photo(corners, width)?.try_inverse()?;
        let reach = 1.0 + 2.0 * RIM / width as f64;
        let bound = |axis: usize, most: usize| {
            let ends = corners.iter().map(|c| centre[axis] + reach * (c[axis] - centre[axis]));
            let (low, high) = ends.fold((f64::MAX, 0.0f64), |(l, h), v| (l.min(v), h.max(v)));
            (low.max(0.0) as usize, (high.max(0.0) as usize).min(most - 1))
        };
        let ((x0, x1), (y0, y1)) = (bound(0, grey.width), bound(1, grey.height));
        let area = (x1.saturating_sub(x0) * y1.saturating_sub(y0)) as f64;
        let step = ((area / SAMPLES).sqrt() as usize).max(1);
        let inside = -RIM..=width as f64 + RIM;
        for y in (y0..=y1).step_by(step) {
            for x in (x0..=x1).step_by(step) {
                let cell = map * Vector3::new(x as f64, y as f64, 1.0);
                let (u, v) = (cell.x / cell.z, cell.y / cell.z);
                if inside.contains(&u) && inside.contains(&v) {
                    let code = f64::from(grey.codes[y * grey.width + x]);
                    let place = [(x as f64 - centre[0]) / unit, (y as f64 - centre[1]) / unit];
                    problem.samples.push([place[0], place[1], code]);
                }
            }
        }
        (problem.samples.len() > 3 * NUMBERS).then_some(problem)
    }

    fn start(&self, corners: [[f64; 2]; 4]) -> Option<State> {
        let local = corners.map(|c| [0, 1].map(|axis| (c[axis] - self.centre[axis]) / self.unit));
        let map = cells_to_photo(local, self.width)?.try_inverse()?;
        let map = map / map[(2, 2)];
        let mut codes: Vec<f64> = self.samples.iter().map(|sample| sample[2]).collect();
        codes.sort_by(f64::total_cmp);
        let (black, white) = (codes[codes.len() / 20], codes[codes.len() - 1 - codes.len() / 20]);
        Some(State { map, steepness: map, blur: USUAL_BLUR, tone: [black, white - black, 0.0] })
    }

    fn corners(&self, state: &State) -> Option<[[f64; 2]; 4]> {
        let back = state.map.try_inverse()?;
        let n = self.width as f64;
        let corners = [[0.0, 0.0], [n, 0.0], [n, n], [0.0, n]].map(|[u, v]| {
            let p = back * Vector3::new(u, v, 1.0);
            [self.centre[0] + self.unit * p.x / p.z, self.centre[1] + self.unit * p.y / p.z]
        });
        corners.iter().flatten().all(|value| value.is_finite()).then_some(corners)
    }

    /// One step of Gauss-Newton; the share of variance that was explained before it.
    fn step(&self, state: &mut State) -> Option<f64> {
        let mut normal = SMatrix::<f64, NUMBERS, NUMBERS>::zeros();
        let mut right = SVector::<f64, NUMBERS>::zeros();
        let (mut misfit, mut sum, mut squares) = (0.0, 0.0, 0.0);
        for &[x, y, code] in &self.samples {
            let (shown, slope) = self.shown(state, x, y);
            let error = code - shown;
            for (i, a) in slope.iter().enumerate() {
                right[i] += a * error;
                for (j, b) in slope[..=i].iter().enumerate() {
                    normal[(i, j)] += a * b;
                }
            }
            misfit += error * error;
            (sum, squares) = (sum + code, squares + code * code);
        }
        for i in 0..NUMBERS {
            // A little of each number's own weight keeps what the picture does not tell from running away.
            normal[(i, i)] += 1e-3 * normal[(i, i)] + 1e-9;
        }
        let change = normal.cholesky()?.solve(&right);
        for (index, value) in change.iter().take(8).enumerate() {
            state.map[(index / 3, index % 3)] += value;
        }
        state.steepness = state.map;
        state.blur *= change[8].clamp(-0.5, 0.5).exp();
        state.blur = state.blur.clamp(*BLURS.start(), *BLURS.end());
        (0..3).for_each(|i| state.tone[i] += change[9 + i]);
        let count = self.samples.len() as f64;
        Some(1.0 - misfit / (squares - sum * sum / count).max(1.0))
    }

    /// What the pattern shows at a place, and how that changes with each number.
    fn shown(&self, state: &State, x: f64, y: f64) -> (f64, [f64; NUMBERS]) {
        let m = &state.map;
        let w = 1.0 / (m[(2, 0)] * x + m[(2, 1)] * y + m[(2, 2)]);
        let u = (m[(0, 0)] * x + m[(0, 1)] * y + m[(0, 2)]) * w;
        let v = (m[(1, 0)] * x + m[(1, 1)] * y + m[(1, 2)]) * w;
        let held = &state.steepness;
        let scale = 1.0 / (held[(2, 0)] * x + held[(2, 1)] * y + held[(2, 2)]);
        let steep = |row: usize| {
            let value = (held[(row, 0)] * x + held[(row, 1)] * y + held[(row, 2)]) * scale;
            let dx = (held[(row, 0)] - value * held[(2, 0)]) * scale;
            let dy = (held[(row, 1)] - value * held[(2, 1)]) * scale;
            dx.hypot(dy) * state.blur / self.unit
        };
        let (columns, rows) = (Weights::at(u, steep(0)), Weights::at(v, steep(1)));
        let (mut t, mut du, mut dv, mut ds) = (0.0, 0.0, 0.0, 0.0);
        for j in 0..Weights::CELLS {
            for i in 0..Weights::CELLS {
                if self.white(columns.first + i as isize, rows.first + j as isize) {
                    t += columns.share[i] * rows.share[j];
                    du += columns.slope[i] * rows.share[j];
                    dv += columns.share[i] * rows.slope[j];
                    ds += columns.widening[i] * rows.share[j] + columns.share[i] * rows.widening[j];
                }
            }
        }
        let [black, step, bent] = state.tone;
        let gain = step + bent * (1.0 - 2.0 * t);
        let (du, dv) = (gain * du * w, gain * dv * w);
        let common = -(du * u + dv * v);
        let slope = [
            du * x,
            du * y,
            du,
            dv * x,
            dv * y,
            dv,
            common * x,
            common * y,
            gain * ds,
            1.0,
            t,
            t * (1.0 - t),
        ];
        (black + step * t + bent * t * (1.0 - t), slope)
    }

    fn white(&self, column: isize, row: isize) -> bool {
        let inside = |value: isize| (0..self.width as isize).contains(&value);
        let known = inside(column) && inside(row);
        !known || self.cells[row as usize * self.width + column as usize]
    }
}

/// The shares of the cells around a place along one axis, and how they change with the place and with the
/// logarithm of the blur.
struct Weights {
    first: isize,
    share: [f64; Self::CELLS],
    slope: [f64; Self::CELLS],
    widening: [f64; Self::CELLS],
}

impl Weights {
    const CELLS: usize = 5;

    fn at(place: f64, blur: f64) -> Self {
        let first = place.floor() as isize - 2;
        let mut edges = [(0.0, 0.0, 0.0); Self::CELLS + 1];
        for (index, edge) in edges.iter_mut().enumerate() {
            let z = ((first + index as isize) as f64 - place) / blur;
            let density = (-0.5 * z * z).exp() * 0.398_942_280_401_432_7;
            *edge = (normal_share(z, density), -density / blur, -density * z);
        }
        edges[0] = (0.0, 0.0, 0.0);
        edges[Self::CELLS] = (1.0, 0.0, 0.0);
        Self {
            first,
            share: std::array::from_fn(|i| edges[i + 1].0 - edges[i].0),
            slope: std::array::from_fn(|i| edges[i + 1].1 - edges[i].1),
            widening: std::array::from_fn(|i| edges[i + 1].2 - edges[i].2),
        }
    }
}

/// Φ(z) to 1e-5 with φ(z) at hand (Abramowitz and Stegun 26.2.16).
fn normal_share(z: f64, density: f64) -> f64 {
    let t = 1.0 / (1.0 + 0.332_67 * z.abs());
    let beyond = density * t * (0.436_183_6 + t * (-0.120_167_6 + t * 0.937_298_0));
    if z < 0.0 { beyond } else { 1.0 - beyond }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_normal_distribution_is_that_of_the_tables() {
        for (z, share) in [(0.0, 0.5), (1.0, 0.841_345), (-1.0, 0.158_655), (2.0, 0.977_250)] {
            let density = (-0.5f64 * z * z).exp() * 0.398_942_3;
            assert!((normal_share(z, density) - share).abs() < 2e-5, "{z}");
        }
    }

    /// The slopes are those of small differences.
    #[test]
    fn slopes_agree_with_differences() {
        let codes = (0..64 * 64).map(|i| (i * 7 % 256) as u8).collect();
        let grey = Grey { width: 64, height: 64, codes };
        let cells: Vec<bool> =
            (0..36).map(|i| (7..29).contains(&i) && i % 6 % 5 != 0 && i % 3 == 1).collect();
        let corners = [[10.0, 12.0], [45.0, 9.0], [50.0, 42.0], [14.0, 44.0]];
        let problem = Problem::new(&grey, corners, &cells, 6).unwrap();
        let state = |number: usize, change: f64| {
            let mut state = problem.start(corners).unwrap();
            state.tone = [20.0, 200.0, 30.0];
            match number {
                0..8 => state.map[(number / 3, number % 3)] += change,
                8 => state.blur *= change.exp(),
                _ => state.tone[number - 9] += change,
            }
            state
        };
        for (x, y) in [(0.1, -0.2), (0.4, 0.3), (-0.35, 0.1)] {
            let (_, slope) = problem.shown(&state(0, 0.0), x, y);
            for (number, slope) in slope.iter().enumerate() {
                let at = |change| problem.shown(&state(number, change), x, y).0;
                let difference = (at(1e-4) - at(-1e-4)) / 2e-4;
                // A place shows five cells across and five down: what lies beyond counts as the last of them.
                let allowed = 0.02 * difference.abs() + 0.05;
                assert!((difference - slope).abs() < allowed, "{number}: {difference} {slope}");
            }
        }
    }
}
