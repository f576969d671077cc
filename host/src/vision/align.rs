//! Fitting the map from floor to photo to the border's edges, to a fraction of a pixel.
//!
//! Along each side of the arena short profiles of linear light are taken across the border; the
//! step in each is one observation. Homography and radial coefficient are then fitted together by
//! re-weighted least squares (Gauss-Newton, Tukey's weights), so that boxes on the border, which
//! shift or hide the step in places, do not pull.

use super::photo::Photo;
use super::plan_map::PlanMap;
use super::profile::step;
use crate::geometry::{Arena, Point};
use nalgebra::{SMatrix, SVector};

/// Profiles on each side of the arena.
pub(crate) const PLACES: usize = 80;
/// A step this close to the map, as a share of the picture's width, shows that the map is right.
const FITTING_SHARE: f64 = 0.0015;
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

/// A place on a side of the arena: sides 0..3 are lower, right, upper, left.
///
/// `along` runs from 0 to 1 counter-clockwise, `inward` is the distance from the side, metres.
pub(crate) fn side_point(arena: Arena, side: usize, along: f64, inward: f64) -> Point {
    let Arena { width, height } = arena;
    match side {
        0 => Point::new(along * width, inward),
        1 => Point::new(width - inward, along * height),
        2 => Point::new((1.0 - along) * width, height - inward),
        _ => Point::new(inward, (1.0 - along) * height),
    }
}

/// How far a point lies inward from a side, metres.
pub(crate) fn inward(arena: Arena, side: usize, point: Point) -> f64 {
    match side {
        0 => point.y,
        1 => arena.width - point.x,
        2 => arena.height - point.y,
        _ => point.x,
    }
}

/// The place along a side of profile number `place`, 0 to 1.
pub(crate) fn along(place: usize) -> f64 {
    CORNER_SHARE + (1.0 - 2.0 * CORNER_SHARE) * (place as f64 + 0.5) / PLACES as f64
}

/// Where the step of a profile is sought, and which step counts.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Search {
    /// How far from the map's sides a step may be, pixels.
    pub(crate) reach: f64,
    /// The change of linear light from inside to outside on each side; `None` takes the greatest step
    /// of any colour.
    pub(crate) change: Option<[[f32; 3]; 4]>,
}

/// A step of brightness seen at one place of a side.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Step {
    pub(crate) side: usize,
    pub(crate) pixel: [f64; 2],
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
    let count = (2.0 * search.reach / SAMPLE_STEP) as usize + 4;
    let mut lights = Vec::with_capacity(count);
    for side in 0..4 {
        let scale = map.scale_at(side_point(arena, side, 0.5, 0.0)).max(1e-6);
        let change = search.change.map(|changes| changes[side]);
        let first = (search.reach + 2.0 * SAMPLE_STEP) / scale;
        let last = first - (count - 1) as f64 * SAMPLE_STEP / scale;
        for place in (stride / 2..PLACES).step_by(stride) {
            let pixel = |inward: f64| map.to_photo(side_point(arena, side, along(place), inward));
            // So few pixels of a side's normal are straight in the photo.
            let (from, to) = (pixel(first), pixel(last));
            let at = |index: f64| {
                let share = index / (count - 1) as f64;
                [from[0] + share * (to[0] - from[0]), from[1] + share * (to[1] - from[1])]
            };
            lights.clear();
            lights.extend((0..count).map(|index| photo.light(at(index as f64))));
            let pixel = step(&lights, change).map(at).filter(|&pixel| photo.holds(pixel));
            steps.extend(pixel.map(|pixel| Step { side, pixel }));
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
    pub(crate) shares: [f64; 4],
}

/// Fits the map to steps; steps farther than `width` pixels do not count.
///
/// With `lens` the radial coefficient is fitted too, else it stays. `None` if the steps do not
/// determine the map. `stride` is that of the steps.
pub(crate) fn fit(
    photo: &Photo,
    arena: Arena,
    map: &PlanMap,
    steps: &[Step],
    width: f64,
    lens: bool,
    stride: usize,
) -> Option<Fit> {
    let mut map = map.clone();
    for _ in 0..MOST_ROUNDS {
        let (next, change) = gauss_newton(photo, arena, &map, steps, width, lens)?;
        map = next;
        if change < SETTLED {
            break;
        }
    }
    let (mut sum, mut count, mut shares) = (0.0, 0usize, [0.0; 4]);
    for step in steps {
        let point = map.to_floor(step.pixel);
        let distance = inward(arena, step.side, point) * map.scale_at(point);
        if distance.abs() < width {
            sum += distance * distance;
            count += 1;
        }
        if distance.abs() < FITTING_SHARE * photo.width() as f64 {
            shares[step.side] += stride as f64 / PLACES as f64;
        }
    }
    Some(Fit { map, residual: (sum / count.max(1) as f64).sqrt(), shares })
}

/// One step of the fit: the next map, and how far its parameters moved, pixels.
///
/// The parameters are the corners' ideal pixels and the radial coefficient in hundredths; a residual is
/// the distance of an observed step from its side. Its derivatives are differences; pixels per metre
/// hardly change with the parameters and are taken from the present map.
fn gauss_newton(
    photo: &Photo,
    arena: Arena,
    map: &PlanMap,
    steps: &[Step],
    width: f64,
    lens: bool,
) -> Option<(PlanMap, f64)> {
    const NUDGE: f64 = 1e-3;
    let corners = map.ideal_corners(arena);
    let with = |change: &SVector<f64, 9>| {
        let moved = [0, 1, 2, 3]
            .map(|i| [corners[i][0] + change[2 * i], corners[i][1] + change[2 * i + 1]]);
        PlanMap::from_corners(photo, arena, moved, map.radial() + change[8] / 100.0)
    };
    let mut nudged = Vec::with_capacity(9);
    for parameter in 0..9 {
        let mut change = SVector::<f64, 9>::zeros();
        change[parameter] = NUDGE;
        nudged.push(with(&change)?);
    }
    let mut normal = SMatrix::<f64, 9, 9>::identity() * DAMPING;
    let mut right = SVector::<f64, 9>::zeros();
    for step in steps {
        let ideal = map.unbend(step.pixel);
        let scale = map.scale_at(map.ideal_to_floor(ideal));
        let outward =
            |map: &PlanMap, ideal| -inward(arena, step.side, map.ideal_to_floor(ideal)) * scale;
        let now = outward(map, ideal);
        let ratio = now / width;
        if ratio.abs() >= 1.0 {
            continue;
        }
        let weight = (1.0 - ratio * ratio).powi(2) / (STEP_NOISE * STEP_NOISE);
        // Moved corners leave the lens as it is; only the last parameter is the lens itself.
        let other_lens = if lens { nudged[8].unbend(step.pixel) } else { ideal };
        let row = SVector::<f64, 9>::from_fn(|i, _| {
            (outward(&nudged[i], if i < 8 { ideal } else { other_lens }) - now) / NUDGE
        });
        normal += weight * row * row.transpose();
        right -= weight * now * row;
    }
    // The lens is measured in hundredths, like a pixel in size; its usual value is 0.
    let prior = if lens { 1.0 / (100.0 * RADIAL_SPREAD).powi(2) } else { 1e12 };
    normal[(8, 8)] += prior;
    right[8] -= if lens { prior * map.radial() * 100.0 } else { 0.0 };
    let change = normal.cholesky()?.solve(&right);
    Some((with(&change)?, change.amax()))
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
            [super::super::photo::srgb_code(0.1 + 0.6 * bright.count() as f32 / 25.0); 3]
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
            map = fit(&photo, ARENA, &map, &found, reach, true, 1).unwrap().map;
        }
        for (found, true_corner) in map.seen_corners(ARENA).into_iter().zip(truth) {
            let error = (found[0] - true_corner[0]).hypot(found[1] - true_corner[1]);
            assert!(error < 0.2, "{error} px");
        }
        assert!((map.radial() + 0.05).abs() < 0.01, "{}", map.radial());
    }

    #[test]
    fn sides_run_counter_clockwise() {
        assert_eq!(side_point(ARENA, 1, 0.25, 0.1), Point::new(1.4, 0.25));
        assert_eq!(
            inward(ARENA, 2, side_point(ARENA, 2, 0.3, 0.2)),
            ARENA.height - (ARENA.height - 0.2)
        );
    }
}
