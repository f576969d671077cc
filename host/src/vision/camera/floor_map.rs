//! The map between the floor in metres and the photo in pixels.
//!
//! A homography (nalgebra) takes the floor to an ideal picture, one radial coefficient λ bends that
//! about the picture's centre as a lens does:
//! `u = c + (v − c)(1 + λ |v − c|² / s²)` with v the ideal pixel, c the centre, s half the width.
//! With the camera's own numbers λ = k1 (s / K00)².

use crate::geometry::{Arena, Point};
use crate::vision::image::Photo;
use crate::vision::least_squares::NormalEquations;
use nalgebra::{Matrix3, SMatrix, SVector, Vector3};

/// Steps of the fixed-point iteration that undoes the lens; each gains a factor of 2 |λ|.
const UNBEND_STEPS: usize = 12;

/// Takes floor points to pixels and back.
#[derive(Clone, Debug, PartialEq)]
pub struct PlanMap {
    to_ideal: Matrix3<f64>,
    to_floor: Matrix3<f64>,
    centre: [f64; 2],
    half_width: f64,
    radial: f64,
}

impl PlanMap {
    /// The map that takes the arena's corners 0..3 to `ideal` pixels, before a lens with the
    /// coefficient `radial`; `None` if the corners enclose no area.
    pub fn from_corners(
        photo: &Photo,
        arena: Arena,
        ideal: [[f64; 2]; 4],
        radial: f64,
    ) -> Option<Self> {
        let to_ideal = homography(corner_points(arena), ideal)?;
        let to_floor = to_ideal.try_inverse()?;
        let half_width = photo.width() as f64 / 2.0;
        let map = Self { to_ideal, to_floor, centre: photo.centre(), half_width, radial };
        let finite = to_floor.iter().chain(to_ideal.iter()).all(|value| value.is_finite());
        (finite && radial.is_finite()).then_some(map)
    }

    /// The map by a homography to ideal pixels, bent about `centre` by `radial` per `unit` pixels squared.
    pub(crate) fn with_lens(
        to_ideal: Matrix3<f64>,
        centre: [f64; 2],
        unit: f64,
        radial: f64,
    ) -> Option<Self> {
        let to_floor = to_ideal.try_inverse()?;
        let map = Self { to_ideal, to_floor, centre, half_width: unit, radial };
        let finite = to_floor.iter().chain(to_ideal.iter()).all(|value| value.is_finite());
        (finite && radial.is_finite()).then_some(map)
    }

    /// The map, before any lens, that takes floor points to about their pixels: the least squares of the linear
    /// equations of a homography.
    pub(crate) fn through(photo: &Photo, points: &[(Point, [f64; 2])]) -> Option<Self> {
        // With pixels in widths of the photo all numbers are about 1.
        let unit = photo.width() as f64;
        let mut sums = NormalEquations::<8>::new(0.0);
        for (point, pixel) in points {
            for (row, value) in equations([point.x, point.y], pixel.map(|value| value / unit)) {
                sums.add(SVector::from(row), value, 1.0);
            }
        }
        let scaled = matrix_of(&sums.solve()?)?;
        let to_ideal = Matrix3::from_diagonal(&Vector3::new(unit, unit, 1.0)) * scaled;
        Self::with_lens(to_ideal, photo.centre(), unit / 2.0, 0.0)
    }

    /// The same, from corners as the photo shows them.
    pub fn from_seen_corners(
        photo: &Photo,
        arena: Arena,
        seen: [[f64; 2]; 4],
        radial: f64,
    ) -> Option<Self> {
        let lens = Self {
            to_ideal: Matrix3::identity(),
            to_floor: Matrix3::identity(),
            centre: photo.centre(),
            half_width: photo.width() as f64 / 2.0,
            radial,
        };
        Self::from_corners(photo, arena, seen.map(|pixel| lens.unbend(pixel)), radial)
    }

    /// The pixel where the photo shows a floor point.
    #[inline]
    pub fn to_photo(&self, point: Point) -> [f64; 2] {
        self.bend(apply(&self.to_ideal, [point.x, point.y]))
    }

    /// The floor point that the photo shows at a pixel.
    pub fn to_floor(&self, pixel: [f64; 2]) -> Point {
        self.ideal_to_floor(self.unbend(pixel))
    }

    /// The floor point at an ideal pixel, before the lens.
    #[inline]
    pub(crate) fn ideal_to_floor(&self, ideal: [f64; 2]) -> Point {
        apply(&self.to_floor, ideal).into()
    }

    /// The radial coefficient λ, per half width squared.
    pub fn radial(&self) -> f64 {
        self.radial
    }

    /// The homography from the floor to ideal pixels about the picture's centre.
    pub(crate) fn centred_homography(&self) -> Matrix3<f64> {
        let [x, y] = self.centre;
        Matrix3::new(1.0, 0.0, -x, 0.0, 1.0, -y, 0.0, 0.0, 1.0) * self.to_ideal
    }

    /// Corners 0..3 of `arena` as ideal pixels, before the lens.
    pub(crate) fn ideal_corners(&self, arena: Arena) -> [[f64; 2]; 4] {
        corner_points(arena).map(|corner| apply(&self.to_ideal, corner))
    }

    /// Corners 0..3 of `arena` as the photo shows them, pixels.
    pub fn seen_corners(&self, arena: Arena) -> [[f64; 2]; 4] {
        corner_points(arena).map(|corner| self.to_photo(corner.into()))
    }

    /// Pixels per metre around a floor point: the square root of the map's area factor.
    pub fn scale_at(&self, point: Point) -> f64 {
        const STEP: f64 = 1e-3;
        let [x0, y0] = self.to_photo(point);
        let [x1, y1] = self.to_photo(Point::new(point.x + STEP, point.y));
        let [x2, y2] = self.to_photo(Point::new(point.x, point.y + STEP));
        (((x1 - x0) * (y2 - y0) - (x2 - x0) * (y1 - y0)).abs()).sqrt() / STEP
    }

    #[inline]
    fn bend(&self, ideal: [f64; 2]) -> [f64; 2] {
        let (dx, dy) = (ideal[0] - self.centre[0], ideal[1] - self.centre[1]);
        if self.radial == 0.0 {
            return [self.centre[0] + dx, self.centre[1] + dy];
        }
        let factor = 1.0 + self.radial * (dx * dx + dy * dy) / (self.half_width * self.half_width);
        [self.centre[0] + factor * dx, self.centre[1] + factor * dy]
    }

    /// The ideal pixel that the lens bends to a pixel of the photo; the same for all maps of one lens.
    pub(crate) fn unbend(&self, seen: [f64; 2]) -> [f64; 2] {
        let (dx, dy) = (seen[0] - self.centre[0], seen[1] - self.centre[1]);
        if self.radial == 0.0 {
            return seen;
        }
        let strength = self.radial / (self.half_width * self.half_width);
        let mut factor = 1.0;
        for _ in 0..UNBEND_STEPS {
            let square = (dx * dx + dy * dy) / (factor * factor);
            let next = (1.0 + strength * square).max(0.2);
            if next == factor {
                break;
            }
            factor = next;
        }
        [self.centre[0] + dx / factor, self.centre[1] + dy / factor]
    }
}

/// The arena's corners 0..3, metres.
pub(crate) fn corner_points(arena: Arena) -> [[f64; 2]; 4] {
    [[0.0, 0.0], [arena.width, 0.0], [arena.width, arena.height], [0.0, arena.height]]
}

/// The homography that takes four points to four others; `None` if three of them are in line.
///
/// ```
/// use wmr::vision::homography;
/// let unit = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
/// let moved = unit.map(|[x, y]| [2.0 * x + 5.0, 3.0 * y]);
/// let matrix = homography(unit, moved).unwrap();
/// assert!((matrix[(0, 0)] - 2.0).abs() < 1e-9 && (matrix[(0, 2)] - 5.0).abs() < 1e-9);
/// ```
pub fn homography(from: [[f64; 2]; 4], to: [[f64; 2]; 4]) -> Option<Matrix3<f64>> {
    let mut system = SMatrix::<f64, 8, 8>::zeros();
    let mut right = SVector::<f64, 8>::zeros();
    for (index, (from, to)) in from.into_iter().zip(to).enumerate() {
        for (which, (row, value)) in equations(from, to).into_iter().enumerate() {
            system.set_row(2 * index + which, &SVector::from(row).transpose());
            right[2 * index + which] = value;
        }
    }
    matrix_of(&system.lu().solve(&right)?)
}

/// The two linear equations, coefficients and value, for a homography's first eight numbers that takes one point to
/// another.
fn equations([x, y]: [f64; 2], [u, v]: [f64; 2]) -> [([f64; 8], f64); 2] {
    [
        ([x, y, 1.0, 0.0, 0.0, 0.0, -u * x, -u * y], u),
        ([0.0, 0.0, 0.0, x, y, 1.0, -v * x, -v * y], v),
    ]
}

fn matrix_of(h: &SVector<f64, 8>) -> Option<Matrix3<f64>> {
    let matrix = Matrix3::new(h[0], h[1], h[2], h[3], h[4], h[5], h[6], h[7], 1.0);
    matrix.iter().all(|value| value.is_finite()).then_some(matrix)
}

#[inline]
fn apply(matrix: &Matrix3<f64>, [x, y]: [f64; 2]) -> [f64; 2] {
    let image = matrix * Vector3::new(x, y, 1.0);
    [image.x / image.z, image.y / image.z]
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn photo() -> Photo {
        Photo::from_rgb(640, 480, vec![[0; 3]; 640 * 480]).unwrap()
    }

    const ARENA: Arena = Arena { width: 2.0, height: 1.0 };

    #[test]
    fn corners_map_to_corners_and_the_scale_is_that_of_the_sides() {
        let corners = [[100.0, 300.0], [500.0, 300.0], [500.0, 100.0], [100.0, 100.0]];
        let map = PlanMap::from_corners(&photo(), ARENA, corners, 0.0).unwrap();
        let [x, y] = map.to_photo(Point::new(1.0, 0.5));
        assert!((x - 300.0).abs() < 1e-9 && (y - 200.0).abs() < 1e-9);
        assert!((map.scale_at(Point::new(0.3, 0.4)) - 200.0).abs() < 1e-6);
    }

    #[test]
    fn corners_in_line_have_no_map() {
        let line = [[0.0, 0.0], [1.0, 1.0], [2.0, 2.0], [3.0, 3.0]];
        assert!(PlanMap::from_corners(&photo(), ARENA, line, 0.0).is_none());
    }

    proptest! {
        #[test]
        fn the_way_to_the_photo_and_back_ends_where_it_began(
            x in 0.0..2.0f64, y in 0.0..1.0f64, radial in -0.1..0.1f64, tilt in -40.0..40.0f64,
        ) {
            let corners = [[60.0, 400.0 + tilt], [600.0, 380.0], [560.0, 60.0], [90.0 + tilt, 90.0]];
            let map = PlanMap::from_corners(&photo(), ARENA, corners, radial).unwrap();
            let back = map.to_floor(map.to_photo(Point::new(x, y)));
            prop_assert!(back.distance(Point::new(x, y)) < 1e-6);
        }
    }
}
