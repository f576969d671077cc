//! Where the camera stands: its foot point on the floor and its height, from the floor's map alone.
//!
//! The homography of a camera with focal length f (pixels) and its axis through the picture's centre
//! has two columns that are images of orthogonal vectors of the same length; that gives f where the
//! view is tilted. Straight from above f cannot be seen, but there the foot point needs no f: it
//! lies at the picture's centre. A usual focal length is therefore taken as a weak prior.

use super::floor_map::PlanMap;
use crate::geometry::{Arena, Point};
use crate::vision::image::Photo;
use nalgebra::{Matrix3, Vector3};

/// The usual focal length in longer sides of the picture, and its standard deviation as a natural logarithm: 19 of
/// 20 lenses have 0.6 to 2 of them.
pub(crate) const USUAL_FOCAL: f64 = 1.05;
pub(crate) const FOCAL_SPREAD: f64 = 0.3;
/// How far the columns' angle (radians) and ratio of lengths may be off.
pub(crate) const COLUMN_NOISE: f64 = 0.002;
/// The same where the arena's size is stated by people, who measure its sides to about 1 %.
pub(crate) const STATED_NOISE: f64 = 0.01;
/// A rectangle's angles are off by less than this, standard deviations.
const MOST_ANGLE: f64 = 3.0;
/// Focal lengths that are tried, in steps of this factor.
const FOCAL_STEP: f64 = 1.02;
const FOCAL_RANGE: std::ops::Range<f64> = 0.4..4.0;
/// The camera is at least so far above what it sees, metres.
const LEAST_ABOVE: f64 = 1e-3;
/// A foot point is known no better than this, metres: the axis may miss the picture's centre.
const LEAST_SPREAD: f64 = 0.05;

/// The camera's place, metres in the arena frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Viewpoint {
    /// The point of the floor straight below the camera.
    pub(crate) foot: Point,
    /// The camera's height above the floor.
    pub(crate) height: f64,
    /// How far the foot point may be off (one standard deviation), metres.
    pub(crate) spread: f64,
    /// Whether the height is known, not only guessed from the border.
    pub(crate) knows_height: bool,
}

/// How four corners differ from those of the stated arena as a camera sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct StatedFit {
    /// How far the angle between its sides is off, radians.
    pub(crate) angle: f64,
    /// How much longer its width is seen against its height than was stated, a natural logarithm.
    pub(crate) ratio: f64,
}

impl StatedFit {
    /// The two together.
    pub(crate) fn off(self) -> f64 {
        self.angle.hypot(self.ratio)
    }

    /// The ratio of width to height that is seen, if what is seen is about a rectangle at all.
    pub(crate) fn seen_ratio(self, arena: Arena) -> Option<f64> {
        let rectangle = self.angle.abs() < MOST_ANGLE * STATED_NOISE;
        rectangle.then(|| self.ratio.exp() * arena.width / arena.height)
    }
}

impl Viewpoint {
    /// How many times larger, and farther from the foot point, what is `height` metres above the floor appears on
    /// the floor's plane: h / (h − height) with the camera at h.
    pub(crate) fn enlargement(self, height: f64) -> f64 {
        self.height / (self.height - height).max(LEAST_ABOVE)
    }

    /// How far a map is from that of any camera, in squared standard deviations.
    ///
    /// Four corners leave a homography free; that a camera made it, whatever its focal length, is a
    /// condition that a wrong quadrilateral hardly ever meets.
    pub(crate) fn misfit(photo: &Photo, map: &PlanMap) -> f64 {
        let homography = map.centred_homography();
        let side = photo.longer_side();
        focal_lengths().map(|focal| misfit(&homography, focal * side)).fold(f64::INFINITY, f64::min)
    }

    /// The same for an arena whose stated size is as exact as people measure.
    pub(crate) fn misfit_as_stated(photo: &Photo, map: &PlanMap) -> f64 {
        Self::misfit(photo, map) * (COLUMN_NOISE / STATED_NOISE).powi(2)
    }

    /// How a map differs from that of any camera that sees the stated arena, with whatever focal length fits best.
    pub(crate) fn stated_fit(photo: &Photo, map: &PlanMap) -> StatedFit {
        let homography = map.centred_homography();
        let side = photo.longer_side();
        let fit = |focal: f64| {
            let [angle, ratio] = of_columns(&homography, focal * side);
            StatedFit { angle: angle * COLUMN_NOISE, ratio: ratio * COLUMN_NOISE }
        };
        let fits = focal_lengths().map(fit);
        let none = StatedFit { angle: f64::INFINITY, ratio: f64::INFINITY };
        fits.min_by(|a, b| a.off().total_cmp(&b.off())).unwrap_or(none)
    }

    /// How much longer, as a ratio, the arena's width is seen against its height than was stated; `None` if
    /// no camera sees a rectangle so, whatever its ratio.
    pub(crate) fn side_ratio(photo: &Photo, map: &PlanMap) -> Option<f64> {
        let homography = map.centred_homography();
        let side = photo.longer_side();
        let off = |focal: f64| {
            let [angle, ratio] = of_columns(&homography, focal * side);
            (angle * COLUMN_NOISE / STATED_NOISE, ratio * COLUMN_NOISE)
        };
        let unusual = |focal: f64| (focal / USUAL_FOCAL).ln() / FOCAL_SPREAD;
        let cost = |focal: f64| off(focal).0.powi(2) + unusual(focal).powi(2);
        let focal = focal_lengths().min_by(|a, b| cost(*a).total_cmp(&cost(*b)))?;
        let (angle, ratio) = off(focal);
        (angle.abs() < MOST_ANGLE).then(|| ratio.exp())
    }

    /// The conditions that a camera with a focal length (longer sides of the picture) and its axis through the
    /// picture's centre puts on a map, in standard deviations: the angle and the ratio of the columns, and
    /// that the focal length is a usual one.
    pub(crate) fn conditions(photo: &Photo, map: &PlanMap, focal: f64) -> [f64; 3] {
        let [angle, ratio] = of_columns(&map.centred_homography(), focal * photo.longer_side());
        [angle, ratio, (focal / USUAL_FOCAL).ln() / FOCAL_SPREAD]
    }

    /// The focal length that meets a map's conditions best, longer sides of the picture.
    pub(crate) fn likeliest_focal(photo: &Photo, map: &PlanMap) -> f64 {
        let homography = map.centred_homography();
        let costs = focal_costs(&homography, photo.longer_side());
        costs.min_by(|a, b| a.0.total_cmp(&b.0)).map_or(USUAL_FOCAL, |(_, focal)| focal)
    }

    /// The angle between straight down and the camera's axis, radians, with the focal length that fits best.
    pub(crate) fn tilt(photo: &Photo, map: &PlanMap) -> f64 {
        let focal = Self::likeliest_focal(photo, map) * photo.longer_side();
        let [a, b, _] = columns(&map.centred_homography(), focal);
        let down = a.cross(&b);
        (down.z.abs() / down.norm().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0).acos()
    }

    /// The viewpoint that a map implies; `None` if no camera could have it.
    pub(crate) fn of(photo: &Photo, map: &PlanMap) -> Option<Self> {
        let homography = map.centred_homography();
        let side = photo.longer_side();
        let costs: Vec<(f64, f64)> = focal_costs(&homography, side).collect();
        let &(least, focal) = costs.iter().min_by(|a, b| a.0.total_cmp(&b.0))?;
        let [x, y, height] = centre(&homography, focal * side)?;
        let foot = Point::new(x, y);
        // The mean square distance of the foot points of all focal lengths, by how likely each is.
        let (mut sum, mut weights) = (0.0, 0.0);
        for (cost, focal) in costs {
            let weight = (0.5 * (least - cost)).exp();
            if let Some([x, y, _]) = centre(&homography, focal * side) {
                sum += weight * foot.distance(Point::new(x, y)).powi(2);
                weights += weight;
            }
        }
        let spread = (sum / weights).sqrt().hypot(LEAST_SPREAD);
        Some(Self { foot, height, spread, knows_height: false })
    }
}

/// Focal lengths (longer sides of the picture), each after how unlikely it is for a homography.
fn focal_costs(homography: &Matrix3<f64>, side: f64) -> impl Iterator<Item = (f64, f64)> {
    focal_lengths().map(move |focal| {
        let unusual = (focal / USUAL_FOCAL).ln() / FOCAL_SPREAD;
        (misfit(homography, focal * side) + unusual.powi(2), focal)
    })
}

/// Focal lengths that cameras have, longer sides of the picture.
fn focal_lengths() -> impl Iterator<Item = f64> {
    std::iter::successors(Some(FOCAL_RANGE.start), |focal| Some(focal * FOCAL_STEP))
        .take_while(|&focal| focal < FOCAL_RANGE.end)
}

/// The columns of the rotation (times a scale) and the translation, for a focal length.
pub(crate) fn columns(homography: &Matrix3<f64>, focal: f64) -> [Vector3<f64>; 3] {
    let to_rays = Matrix3::from_diagonal(&Vector3::new(1.0 / focal, 1.0 / focal, 1.0));
    let rays = to_rays * homography;
    [0, 1, 2].map(|column| rays.column(column).into_owned())
}

/// How far the first two columns are from orthogonal and equal, in squared standard deviations.
fn misfit(homography: &Matrix3<f64>, focal: f64) -> f64 {
    of_columns(homography, focal).iter().map(|value| value * value).sum()
}

/// The angle and the ratio of lengths of the first two columns, in standard deviations.
fn of_columns(homography: &Matrix3<f64>, focal: f64) -> [f64; 2] {
    let [a, b, _] = columns(homography, focal);
    let angle = a.dot(&b) / (a.norm() * b.norm()).max(1e-12);
    let ratio = (a.norm() / b.norm().max(1e-12)).ln();
    [angle / COLUMN_NOISE, ratio / COLUMN_NOISE]
}

/// The camera's centre in the arena frame.
fn centre(homography: &Matrix3<f64>, focal: f64) -> Option<[f64; 3]> {
    let [a, b, t] = columns(homography, focal);
    let scale = 2.0 / (a.norm() + b.norm());
    let (x, y, t) =
        (a.normalize(), (b - a * (a.dot(&b) / a.norm_squared())).normalize(), t * scale);
    let z = x.cross(&y);
    let centre = [-x.dot(&t), -y.dot(&t), -z.dot(&t)];
    let [cx, cy, height] = centre;
    (cx.is_finite() && cy.is_finite() && height.abs() > 1e-6).then_some([cx, cy, height.abs()])
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Rotation3;

    fn seen_from(position: Vector3<f64>, tilt: f64, turn: f64) -> (Photo, PlanMap) {
        let photo = Photo::from_rgb(640, 480, vec![[0; 3]; 640 * 480]).unwrap();
        let arena = Arena { width: 2.0, height: 1.5 };
        let flip = Matrix3::from_diagonal(&Vector3::new(1.0, -1.0, -1.0));
        let rotation = Rotation3::from_euler_angles(tilt, 0.0, turn).matrix() * flip;
        let corners = super::super::floor_map::corner_points(arena).map(|[x, y]| {
            let seen = rotation * (Vector3::new(x, y, 0.0) - position);
            [319.5 + 650.0 * seen.x / seen.z, 239.5 + 650.0 * seen.y / seen.z]
        });
        let map = PlanMap::from_corners(&photo, arena, corners, 0.0).unwrap();
        (photo, map)
    }

    #[test]
    fn straight_from_above_the_foot_is_at_the_centre_of_the_picture() {
        let (photo, map) = seen_from(Vector3::new(0.9, 0.8, 2.5), 0.0, 0.0);
        let view = Viewpoint::of(&photo, &map).unwrap();
        assert!(view.foot.distance(Point::new(0.9, 0.8)) < 0.005, "{view:?}");
    }

    #[test]
    fn a_tilted_camera_is_placed_within_centimetres() {
        let (photo, map) = seen_from(Vector3::new(0.6, 0.5, 2.8), 0.18, 0.3);
        let view = Viewpoint::of(&photo, &map).unwrap();
        assert!(view.foot.distance(Point::new(0.6, 0.5)) < 0.05, "{view:?}");
        assert!((view.height - 2.8).abs() < 0.2, "{view:?}");
        assert!((Viewpoint::tilt(&photo, &map) - 0.18).abs() < 0.02);
    }

    #[test]
    fn an_upright_picture_places_the_camera_where_the_turned_one_does() {
        let (photo, map) = seen_from(Vector3::new(0.9, 0.8, 2.5), 0.05, 0.1);
        let arena = Arena { width: 2.0, height: 1.5 };
        let upright = Photo::from_rgb(480, 640, vec![[0; 3]; 480 * 640]).unwrap();
        let corners = map.ideal_corners(arena).map(|[x, y]| [479.0 - y, x]);
        let turned = PlanMap::from_corners(&upright, arena, corners, 0.0).unwrap();
        let [seen, again] =
            [(&photo, &map), (&upright, &turned)].map(|(p, m)| Viewpoint::of(p, m).unwrap());
        assert!((seen.height - again.height).abs() < 1e-6, "{seen:?} {again:?}");
        assert!(seen.foot.distance(again.foot) < 1e-6, "{seen:?} {again:?}");
    }

    #[test]
    fn a_true_view_fits_a_camera_and_a_misplaced_corner_does_not() {
        let (photo, map) = seen_from(Vector3::new(0.6, 0.5, 2.8), 0.18, 0.3);
        let arena = Arena { width: 2.0, height: 1.5 };
        assert!(Viewpoint::misfit(&photo, &map) < 0.1);
        let mut corners = map.ideal_corners(arena);
        corners[1][0] += 15.0;
        let wrong = PlanMap::from_corners(&photo, arena, corners, 0.0).unwrap();
        assert!(Viewpoint::misfit(&photo, &wrong) > 16.0);
    }
}
