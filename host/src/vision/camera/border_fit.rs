//! Fitting the map from floor to photo to the border's edges, to a fraction of a pixel.
//!
//! Along each side of the arena short profiles of linear light are taken across the border; the
//! step in each is one observation. Homography and radial coefficient are then fitted together by
//! re-weighted least squares (Gauss-Newton, Tukey's weights), so that boxes on the border, which
//! shift or hide the step in places, do not pull.

use super::floor_map::PlanMap;
use super::pose::Viewpoint;
use crate::geometry::{Arena, PerSide, Point, Side};
use crate::vision::image::{Photo, step};
use crate::vision::least_squares::{NormalEquations, tukey};
use nalgebra::SVector;

/// Profiles on each side of the arena.
pub(crate) const PLACES: usize = 80;
/// A step this close to the map, as a share of the picture's longer side, shows that the map is right.
pub(crate) const FITTING_SHARE: f64 = 0.0015;
/// Profiles keep this share of a side away from the corners.
const CORNER_SHARE: f64 = 0.02;
/// The distance of samples in a profile, pixels.
const SAMPLE_STEP: f64 = 0.4;
/// How far the radial coefficient usually lies from 0.
const RADIAL_SPREAD: f64 = 0.06;
/// Keeps a side that shows no steps where it was; an observed step weighs a thousand times as much.
const DAMPING: f64 = 0.01;
/// Rounds of the fit at most; it ends when nothing moves by more than this, pixels.
const MOST_ROUNDS: usize = 8;
const SETTLED: f64 = 0.002;
/// An observed step is good to this, pixels.
const STEP_NOISE: f64 = 0.4;

/// A place on a side of the arena.
///
/// `along` runs from 0 to 1 counter-clockwise, `inward` is the distance from the side, metres.
pub(crate) fn side_point(arena: Arena, side: Side, along: f64, inward: f64) -> Point {
    let Arena { width, height } = arena;
    match side {
        Side::Lower => Point::new(along * width, inward),
        Side::Right => Point::new(width - inward, along * height),
        Side::Upper => Point::new((1.0 - along) * width, height - inward),
        Side::Left => Point::new(inward, (1.0 - along) * height),
    }
}

/// The place along a side of profile number `place`, 0 to 1.
pub(crate) fn along(place: usize) -> f64 {
    CORNER_SHARE + (1.0 - 2.0 * CORNER_SHARE) * (place as f64 + 0.5) / PLACES as f64
}

/// Where the step of a profile is searched for, and which step counts.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Search {
    /// How far from the map's sides a step may be, pixels.
    pub(crate) reach: f64,
    /// The change of linear light from inside to outside on each side; `None` takes the greatest step
    /// of any colour.
    pub(crate) change: Option<PerSide<[f32; 3]>>,
}

/// A step of brightness seen at one place of a side.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Step {
    pub(crate) side: Side,
    pub(crate) pixel: [f64; 2],
}

/// Light along short lines across a side of a map, from inside to outside.
pub(crate) struct Profiles<'a> {
    photo: &'a Photo,
    map: &'a PlanMap,
    arena: Arena,
    side: Side,
    /// Metres inward of the first and the last sample.
    ends: [f64; 2],
    count: usize,
}

impl<'a> Profiles<'a> {
    /// The distance of samples, pixels.
    pub(crate) const STEP: f64 = SAMPLE_STEP;

    /// Lines that reach so many pixels to both sides.
    pub(crate) fn across(
        photo: &'a Photo,
        map: &'a PlanMap,
        arena: Arena,
        side: Side,
        reach: f64,
    ) -> Self {
        let count = (2.0 * reach / SAMPLE_STEP) as usize + 4;
        let scale = map.scale_at(side_point(arena, side, 0.5, 0.0)).max(1e-6);
        let first = (reach + 2.0 * SAMPLE_STEP) / scale;
        let ends = [first, first - (count - 1) as f64 * SAMPLE_STEP / scale];
        Self { photo, map, arena, side, ends, count }
    }

    /// How far a sample is inward of the side, metres.
    pub(crate) fn inward(&self, index: f64) -> f64 {
        let [first, last] = self.ends;
        first + index / (self.count - 1) as f64 * (last - first)
    }

    /// Puts the light along profile number `place` into `lights`; where its first and last sample are, pixels.
    pub(crate) fn at(&self, place: usize, lights: &mut Vec<[f32; 3]>) -> [[f64; 2]; 2] {
        let ends = self.ends.map(|inward| {
            self.map.to_photo(side_point(self.arena, self.side, along(place), inward))
        });
        let pixels = (0..self.count).map(|index| self.pixel(ends, index as f64));
        lights.clear();
        lights.extend(pixels.map(|pixel| self.photo.light(pixel)));
        ends
    }

    /// The pixel of a sample of a profile with such ends: so few pixels of a side's normal are straight in the photo.
    fn pixel(&self, [from, to]: [[f64; 2]; 2], index: f64) -> [f64; 2] {
        let share = index / (self.count - 1) as f64;
        [from[0] + share * (to[0] - from[0]), from[1] + share * (to[1] - from[1])]
    }
}

/// Finds the steps of all profiles that have one, at every `stride`-th place.
pub(crate) fn steps(
    photo: &Photo,
    map: &PlanMap,
    arena: Arena,
    search: &Search,
    stride: usize,
) -> Vec<Step> {
    let mut steps = Vec::with_capacity(4 * PLACES / stride);
    let mut lights = Vec::new();
    for side in Side::ALL {
        let profiles = Profiles::across(photo, map, arena, side, search.reach);
        let change = search.change.map(|changes| changes[side]);
        for place in (stride / 2..PLACES).step_by(stride) {
            let ends = profiles.at(place, &mut lights);
            let pixel = step(&lights, change).map(|index| profiles.pixel(ends, index));
            let seen = pixel.filter(|&pixel| photo.holds(pixel));
            steps.extend(seen.map(|pixel| Step { side, pixel }));
        }
    }
    steps
}

/// How well a map fits its steps.
#[derive(Clone, Debug)]
pub(crate) struct Fit {
    pub(crate) map: PlanMap,
    /// The root mean square of the inliers' distances, pixels.
    pub(crate) residual: f64,
    /// The share of all profiles of each side whose step fits.
    pub(crate) shares: PerSide<f64>,
}

/// What counts when a map is fitted to steps.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Terms {
    /// Steps farther than this from the map do not count, pixels.
    pub(crate) width: f64,
    /// Whether the radial coefficient is fitted too; else it stays.
    pub(crate) lens: bool,
    /// Every so many-th place was looked at for steps.
    pub(crate) stride: usize,
    /// The side whose steps do not count.
    pub(crate) without: Option<Side>,
    /// Whether the map should be one that a camera has, [`Viewpoint::conditions`]; its focal length is
    /// then fitted too.
    pub(crate) camera: bool,
}

/// Fits the map to steps; `None` if the steps do not determine it.
pub(crate) fn fit(
    photo: &Photo,
    arena: Arena,
    map: &PlanMap,
    steps: &[Step],
    terms: Terms,
) -> Option<Fit> {
    let mut map = map.clone();
    for _ in 0..MOST_ROUNDS {
        let (next, change) = gauss_newton(photo, arena, &map, steps, terms)?;
        map = next;
        if change < SETTLED {
            break;
        }
    }
    let (mut sum, mut count, mut shares) = (0.0, 0usize, PerSide::all(0.0));
    for step in steps {
        let point = map.to_floor(step.pixel);
        let distance = arena.inward(step.side, point) * map.scale_at(point);
        if distance.abs() < terms.width {
            sum += distance * distance;
            count += 1;
        }
        if distance.abs() < FITTING_SHARE * photo.longer_side() {
            shares[step.side] += terms.stride as f64 / PLACES as f64;
        }
    }
    Some(Fit { map, residual: (sum / count.max(1) as f64).sqrt(), shares })
}

/// The parameters of the fit: the corners' ideal pixels, the radial coefficient in hundredths (like a pixel
/// in size) and the logarithm of the camera's focal length.
const PARAMETERS: usize = 10;
const LENS: usize = 8;
const FOCAL: usize = 9;
/// Derivatives are differences over this.
const NUDGE: f64 = 1e-3;

/// One step of the fit: the next map, and how far its parameters moved, pixels.
///
/// A residual is the distance of an observed step from its side. Pixels per metre hardly change with the
/// parameters and are taken from the present map.
fn gauss_newton(
    photo: &Photo,
    arena: Arena,
    map: &PlanMap,
    steps: &[Step],
    terms: Terms,
) -> Option<(PlanMap, f64)> {
    let corners = map.ideal_corners(arena);
    let with = |change: &SVector<f64, PARAMETERS>| {
        let moved = [0, 1, 2, 3]
            .map(|i| [corners[i][0] + change[2 * i], corners[i][1] + change[2 * i + 1]]);
        PlanMap::from_corners(photo, arena, moved, map.radial() + change[LENS] / 100.0)
    };
    let mut nudged = Vec::with_capacity(FOCAL);
    for parameter in 0..FOCAL {
        let mut change = SVector::<f64, PARAMETERS>::zeros();
        change[parameter] = NUDGE;
        nudged.push(with(&change)?);
    }
    let mut sums = NormalEquations::new(DAMPING);
    for step in steps.iter().filter(|step| Some(step.side) != terms.without) {
        let ideal = map.unbend(step.pixel);
        let scale = map.scale_at(map.ideal_to_floor(ideal));
        let outward =
            |map: &PlanMap, ideal| -arena.inward(step.side, map.ideal_to_floor(ideal)) * scale;
        let now = outward(map, ideal);
        let ratio = now / terms.width;
        if ratio.abs() >= 1.0 {
            continue;
        }
        let weight = tukey(ratio) / (STEP_NOISE * STEP_NOISE);
        // Moved corners leave the lens as it is; only its own parameter changes it.
        let other_lens = if terms.lens { nudged[LENS].unbend(step.pixel) } else { ideal };
        let row = SVector::from_fn(|i, _| match i {
            FOCAL => 0.0,
            LENS => (outward(&nudged[LENS], other_lens) - now) / NUDGE,
            _ => (outward(&nudged[i], ideal) - now) / NUDGE,
        });
        sums.add(row, -now, weight);
    }
    let usual = if terms.lens { 1.0 / (100.0 * RADIAL_SPREAD).powi(2) } else { 1e12 };
    let stays = if terms.lens { 100.0 * map.radial() } else { 0.0 };
    sums.add_prior(LENS, -stays, usual);
    if terms.camera {
        add_camera(&mut sums, photo, map, &nudged);
    }
    let change = sums.solve()?;
    Some((with(&change)?, change.fixed_rows::<FOCAL>(0).amax()))
}

/// Adds the conditions of a camera with about the likeliest focal length.
fn add_camera(
    sums: &mut NormalEquations<PARAMETERS>,
    photo: &Photo,
    map: &PlanMap,
    nudged: &[PlanMap],
) {
    let focal = Viewpoint::likeliest_focal(photo, map);
    let now = Viewpoint::conditions(photo, map, focal);
    let longer = Viewpoint::conditions(photo, map, focal * NUDGE.exp());
    let moved: Vec<_> = nudged.iter().map(|map| Viewpoint::conditions(photo, map, focal)).collect();
    for (index, &residual) in now.iter().enumerate() {
        let row =
            SVector::from_fn(|i, _| (moved.get(i).unwrap_or(&longer)[index] - residual) / NUDGE);
        sums.add(row, -residual, 1.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ARENA: Arena = Arena { width: 1.5, height: 1.0 };

    /// A bright floor with a dark surround, drawn through a known map with 5 × 5 samples a pixel.
    fn drawn(corners: [[f64; 2]; 4], radial: f64) -> Photo {
        let blank = Photo::from_rgb(320, 240, vec![[0; 3]; 320 * 240]).unwrap();
        let map = PlanMap::from_seen_corners(&blank, ARENA, corners, radial).unwrap();
        let pixel = |i: usize| {
            let bright = (0..25).filter(|s| {
                let (dx, dy) = ((s % 5) as f64 / 5.0 - 0.4, (s / 5) as f64 / 5.0 - 0.4);
                let p = map.to_floor([(i % 320) as f64 + dx, (i / 320) as f64 + dy]);
                p.x > 0.0 && p.y > 0.0 && p.x < ARENA.width && p.y < ARENA.height
            });
            [crate::vision::image::srgb_code(0.1 + 0.6 * bright.count() as f32 / 25.0); 3]
        };
        Photo::from_rgb(320, 240, (0..320 * 240).map(pixel).collect()).unwrap()
    }

    #[test]
    fn a_rough_map_finds_its_way_to_a_fraction_of_a_pixel() {
        let truth = [[30.3, 210.6], [290.2, 200.1], [280.7, 25.4], [42.9, 31.8]];
        let photo = drawn(truth, -0.05);
        let rough = truth.map(|[x, y]| [x + 1.5, y - 1.0]);
        let mut map = PlanMap::from_seen_corners(&photo, ARENA, rough, 0.0).unwrap();
        for reach in [8.0, 4.0, 2.5] {
            let found = steps(&photo, &map, ARENA, &Search { reach, change: None }, 1);
            let terms = Terms { width: reach, lens: true, stride: 1, without: None, camera: false };
            map = fit(&photo, ARENA, &map, &found, terms).unwrap().map;
        }
        for (found, true_corner) in map.seen_corners(ARENA).into_iter().zip(truth) {
            let error = (found[0] - true_corner[0]).hypot(found[1] - true_corner[1]);
            assert!(error < 0.2, "{error} px");
        }
        assert!((map.radial() + 0.05).abs() < 0.01, "{}", map.radial());
    }

    #[test]
    fn three_sides_seen_by_a_camera_predict_the_fourth() {
        // 1.05 widths of focal length from 2.6 m above, tilted by 0.25: the usual focal length.
        let (sin, cos, focal) = (0.25f64.sin(), 0.25f64.cos(), 1.05 * 320.0);
        let truth = super::super::floor_map::corner_points(ARENA).map(|[x, y]| {
            let (x, y, z) = (x - 0.75, y - 0.0, 2.6);
            let (up, away) = (cos * y - sin * z, sin * y + cos * z);
            [159.5 + focal * x / away, 119.5 - focal * up / away]
        });
        let photo = drawn(truth, 0.0);
        let mut wrong = truth;
        (wrong[2][1], wrong[3][1]) = (wrong[2][1] - 6.0, wrong[3][1] - 6.0);
        let fitted = |camera: bool| {
            let mut map = PlanMap::from_seen_corners(&photo, ARENA, wrong, 0.0).unwrap();
            for _ in 0..4 {
                let found = steps(&photo, &map, ARENA, &Search { reach: 3.0, change: None }, 1);
                let terms = Terms {
                    width: 3.0,
                    lens: false,
                    stride: 1,
                    without: Some(Side::Upper),
                    camera,
                };
                map = fit(&photo, ARENA, &map, &found, terms).unwrap().map;
            }
            let upper = map.seen_corners(ARENA).into_iter().zip(truth).skip(2);
            upper.map(|(a, b)| (a[0] - b[0]).hypot(a[1] - b[1])).fold(0.0, f64::max)
        };
        // Without the camera nothing moves the side; with it a fraction of a pixel is left.
        let (free, seen) = (fitted(false), fitted(true));
        assert!(free > 5.0 && seen < 1.5, "{free} {seen} px");
    }

    #[test]
    fn sides_run_counter_clockwise() {
        assert_eq!(side_point(ARENA, Side::Right, 0.25, 0.1), Point::new(1.4, 0.25));
        assert_eq!(
            ARENA.inward(Side::Upper, side_point(ARENA, Side::Upper, 0.3, 0.2)),
            ARENA.height - (ARENA.height - 0.2)
        );
    }
}
