//! The arena's corners where one or two of its four tags are not seen.
//!
//! Tags of one size lie along the arena's sides, so the arena's size says where in metres each of their corners is,
//! but for the tags' own side s. Eight corners or more then determine the eight numbers of the map from floor to
//! photo and s by least squares, and leave enough over to tell which tag lies in which corner. That the map is one of a
//! camera, [`Viewpoint::conditions`], steadies what two tags leave loose.

use super::{Tag, TagPoint};
use crate::geometry::{Arena, Point};
use crate::vision::border::{PictureCorner, is_convex, lowest_left};
use crate::vision::camera::{COLUMN_NOISE, PlanMap, STATED_NOISE, Viewpoint, homography};
use crate::vision::image::Photo;
use crate::vision::least_squares::NormalEquations;
use nalgebra::SVector;

/// Corners of tags are read to this, pixels.
const CORNER_NOISE: f64 = 0.15;
/// Tags whose corners fit worse than this, pixels, do not lie so.
const MOST_RESIDUAL: f64 = 1.5;
/// What is bridged is good to this share of the arena's longest side in the photo, or it is no use.
const MOST_SPREAD: f64 = 0.01;
/// Another reading that fits up to so many times as badly leaves it open which one is true.
const CLEARLY: f64 = 3.0;
/// A corner may lie outside the picture by this share of its width.
const OUTSIDE: f64 = 0.1;
/// By one tag alone the direction to another is seen within 30 degrees: the cosine.
const SAME_WAY: f64 = 0.86;
/// Rounds of the fit.
const ROUNDS: usize = 12;
/// Derivatives are differences over this.
const NUDGE: f64 = 1e-3;

/// The parameters of the fit: the corners' pixels, hundredths of the logarithm of the tags' side, and that of the
/// camera's focal length.
const PARAMETERS: usize = 10;
const SIDE: usize = 8;
const FOCAL: usize = 9;

/// Corners that some tags tell.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Bridged {
    /// The arena's corners, counter-clockwise from the one at the lower left of the picture, pixels.
    pub(crate) corners: [[f64; 2]; 4],
    /// Those that have no tag.
    pub(crate) missing: Vec<PictureCorner>,
    /// How far those may be off (one standard deviation), pixels.
    pub(crate) spread: f64,
}

/// The arena's corners by two or three tags, if these leave no doubt; (0, 0) is at `origin` or, where nobody says, at
/// the lower left of the picture, unless the size shows that the width runs up.
pub(crate) fn bridged(
    photo: &Photo,
    arena: Arena,
    tags: &[&Tag],
    (point, origin): (TagPoint, Option<PictureCorner>),
) -> Option<Bridged> {
    if !(2..=3).contains(&tags.len()) {
        return None;
    }
    let mut readings: Vec<Reading> = placements(tags.len())
        .into_iter()
        .flat_map(|places| (0..4).map(move |turn| (places.clone(), turn)))
        .filter_map(|(places, turn)| Layout { arena, point, places }.read(photo, tags, turn))
        .collect();
    let starts_at = |start: PictureCorner| {
        move |reading: &Reading| (lowest_left(reading.corners) + start.index()).is_multiple_of(4)
    };
    let usual = starts_at(PictureCorner::LowerLeft);
    let start = match origin {
        Some(origin) => origin,
        None if readings.iter().any(usual) => PictureCorner::LowerLeft,
        None => PictureCorner::LowerRight,
    };
    readings.retain(starts_at(start));
    readings.sort_by(|a, b| a.residual.total_cmp(&b.residual));
    let (best, others) = readings.split_first()?;
    let rival = |other: &Reading| other.residual < CLEARLY * best.residual.max(CORNER_NOISE);
    let longest = (0..4).map(|i| apart(best.corners[i], best.corners[(i + 1) % 4]));
    let usable = best.spread < MOST_SPREAD * longest.fold(0.0, f64::max);
    if !usable || others.iter().any(rival) {
        return None;
    }
    let missing = (0..4).filter(|corner| !best.places.contains(corner));
    let mut corners = best.corners;
    let first = lowest_left(corners);
    corners.rotate_left(first);
    Some(Bridged {
        corners,
        missing: missing.map(|corner| PictureCorner::ALL[(corner + start.index()) % 4]).collect(),
        spread: best.spread,
    })
}

fn apart(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

/// All ways to lay so many tags into different corners 0..3.
fn placements(count: usize) -> Vec<Vec<usize>> {
    let longer = |places: Vec<usize>| {
        let free: Vec<usize> = (0..4).filter(|corner| !places.contains(corner)).collect();
        free.into_iter().map(move |corner| [places.clone(), vec![corner]].concat())
    };
    (0..count).fold(vec![Vec::new()], |all, _| all.into_iter().flat_map(longer).collect())
}

/// A way in which the tags may lie, and how well it fits.
struct Reading {
    corners: [[f64; 2]; 4],
    places: Vec<usize>,
    /// The root mean square distance of the tags' corners, pixels.
    residual: f64,
    spread: f64,
}

/// In which corners of the arena tags lie.
struct Layout {
    arena: Arena,
    point: TagPoint,
    places: Vec<usize>,
}

impl Layout {
    /// The corners of the tag in a corner of the arena, clockwise from the lower left, metres.
    fn tag(&self, place: usize, side: f64) -> [Point; 4] {
        let Arena { width, height } = self.arena;
        let (right, upper) = ([false, true, true, false][place], place > 1);
        let at = Point::new(if right { width } else { 0.0 }, if upper { height } else { 0.0 });
        // How far the tag's middle lies inward from the corner, sides.
        let inward = match self.point {
            TagPoint::Outer => 0.5,
            TagPoint::Centre => 0.0,
            TagPoint::Inner => -0.5,
        };
        let towards = |far: bool| if far { -inward * side } else { inward * side };
        let middle = Point::new(at.x + towards(right), at.y + towards(upper));
        [(-0.5, -0.5), (-0.5, 0.5), (0.5, 0.5), (0.5, -0.5)]
            .map(|(x, y)| Point::new(middle.x + side * x, middle.y + side * y))
    }

    /// The side of the tags and how each is turned, if the first one is turned by `turn` quarters.
    fn roughly(&self, tags: &[&Tag], turn: usize) -> Option<(f64, Vec<usize>)> {
        let turned = |tag: &Tag, turn: usize| -> [[f64; 2]; 4] {
            std::array::from_fn(|i| tag.corners_px[(i + turn) % 4])
        };
        let unit = [[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0]];
        let to_sides = homography(turned(tags.first()?, turn), unit)?;
        let in_sides = |[x, y]: [f64; 2]| {
            let at = to_sides * nalgebra::Vector3::new(x, y, 1.0);
            [at.x / at.z, at.y / at.z]
        };
        let last = tags.last()?;
        let seen = in_sides(last.centre_px()).map(|sides| sides - 0.5);
        let ends = [*self.places.first()?, *self.places.last()?];
        let way = |side: f64| {
            let [a, b] = ends.map(|place| self.tag(place, side)[0]);
            [b.x - a.x, b.y - a.y]
        };
        let distance = seen[0].hypot(seen[1]);
        let side = (0..ROUNDS).fold(0.0, |side, _| apart(way(side), [0.0; 2]) / distance);
        let [x, y] = way(side);
        if (x * seen[0] + y * seen[1]) < SAME_WAY * x.hypot(y) * distance {
            return None;
        }
        // Each further tag is turned so that its corners lie in the first one's frame as they should.
        let turns = tags.iter().map(|tag| {
            let off = |turn: &usize| {
                let seen = turned(tag, *turn).map(in_sides);
                apart(seen[0], seen[2]) - (seen[2][0] - seen[0][0]) - (seen[2][1] - seen[0][1])
            };
            (0..4).min_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or(0)
        });
        Some((side, turns.collect()))
    }

    /// Fits the map to the tags' corners; `None` if they do not lie so.
    fn read(self, photo: &Photo, tags: &[&Tag], turn: usize) -> Option<Reading> {
        let (side, turns) = self.roughly(tags, turn)?;
        let seen: Vec<[[f64; 2]; 4]> = tags
            .iter()
            .zip(&turns)
            .map(|(tag, turn)| std::array::from_fn(|i| tag.corners_px[(i + turn) % 4]))
            .collect();
        let mut at = Unknown { map: self.start(photo, &seen, side)?, side };
        for _ in 0..ROUNDS {
            let change = self.sums(photo, &at, &seen)?.solve()?;
            at = at.moved(photo, self.arena, &change)?;
        }
        let count = 8.0 * seen.len() as f64;
        let square: f64 = self.residuals(&at, &seen).iter().map(|value| value * value).sum();
        let residual = (square / count).sqrt();
        let corners = at.map.seen_corners(self.arena);
        let slack = OUTSIDE * photo.width() as f64;
        let is_seen = corners.iter().all(|&corner| photo.holds_within(corner, slack));
        if residual > MOST_RESIDUAL || !is_seen || !is_convex(corners) {
            return None;
        }
        let covariance = self.sums(photo, &at, &seen)?.covariance()?;
        let spread = |i: usize| covariance[(2 * i, 2 * i)] + covariance[(2 * i + 1, 2 * i + 1)];
        let missing = (0..4).filter(|corner| !self.places.contains(corner));
        let worst = missing.map(spread).fold(0.0, f64::max);
        let spread = worst.sqrt() * (residual / CORNER_NOISE).max(1.0);
        Some(Reading { corners, places: self.places, residual, spread })
    }

    /// A map to begin with.
    fn start(&self, photo: &Photo, seen: &[[[f64; 2]; 4]], side: f64) -> Option<PlanMap> {
        let mut points: Vec<(Point, [f64; 2])> = Vec::new();
        for (place, seen) in self.places.iter().zip(seen) {
            points.extend(self.tag(*place, side).into_iter().zip(*seen));
        }
        PlanMap::through(photo, &points)
    }

    /// How far each seen corner is from where the map has it, pixels: columns and rows.
    fn residuals(&self, at: &Unknown, seen: &[[[f64; 2]; 4]]) -> Vec<f64> {
        let tags = self.places.iter().zip(seen);
        tags.flat_map(|(&place, seen)| {
            let expected = self.tag(place, at.side).map(|point| at.map.to_photo(point));
            (0..8).map(move |i| expected[i / 2][i % 2] - seen[i / 2][i % 2])
        })
        .collect()
    }

    /// The normal equations around a map.
    fn sums(
        &self,
        photo: &Photo,
        at: &Unknown,
        seen: &[[[f64; 2]; 4]],
    ) -> Option<NormalEquations<PARAMETERS>> {
        let nudged = |i: usize| {
            let change = SVector::<f64, PARAMETERS>::ith(i, NUDGE);
            at.moved(photo, self.arena, &change)
        };
        let nudged: Vec<Unknown> = (0..FOCAL).map(nudged).collect::<Option<_>>()?;
        let residuals = |at: &Unknown, focal: f64| {
            let mut all = self.residuals(at, seen);
            all.iter_mut().for_each(|value| *value /= CORNER_NOISE);
            let [angle, ratio, usual] = Viewpoint::conditions(photo, &at.map, focal);
            let stated = COLUMN_NOISE / STATED_NOISE;
            all.extend([angle * stated, ratio * stated, usual]);
            all
        };
        let focal = Viewpoint::likeliest_focal(photo, &at.map);
        let now = residuals(at, focal);
        let mut moved: Vec<_> = nudged.iter().map(|at| residuals(at, focal)).collect();
        moved.push(residuals(at, focal * NUDGE.exp()));
        let mut sums = NormalEquations::new(0.0);
        for (index, &residual) in now.iter().enumerate() {
            let row =
                SVector::<f64, PARAMETERS>::from_fn(|i, _| (moved[i][index] - residual) / NUDGE);
            sums.add(row, -residual, 1.0);
        }
        Some(sums)
    }
}

/// The map and the tags' side, metres.
struct Unknown {
    map: PlanMap,
    side: f64,
}

impl Unknown {
    fn moved(
        &self,
        photo: &Photo,
        arena: Arena,
        change: &SVector<f64, PARAMETERS>,
    ) -> Option<Self> {
        let mut corners = self.map.seen_corners(arena);
        for (i, value) in corners.as_flattened_mut().iter_mut().enumerate() {
            *value += change[i];
        }
        let map = PlanMap::from_seen_corners(photo, arena, corners, 0.0)?;
        Some(Self { map, side: self.side * (change[SIDE] / 100.0).exp() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tags_are_laid_into_corners_in_every_way() {
        assert_eq!(placements(2).len(), 12);
        assert_eq!(placements(3).len(), 24);
        assert!(
            placements(3).iter().all(|places| places[0] != places[1] && places[1] != places[2])
        );
    }

    #[test]
    fn a_tag_lies_inside_its_corner_or_around_it_or_outside() {
        let arena = Arena { width: 2.0, height: 1.0 };
        let lower_left = |point: TagPoint| {
            let layout = Layout { arena, point, places: vec![] };
            // In the corner at the upper right, with a side of 0.1 m.
            layout.tag(2, 0.1)[0]
        };
        assert!(lower_left(TagPoint::Outer).distance(Point::new(1.9, 0.9)) < 1e-12);
        assert!(lower_left(TagPoint::Centre).distance(Point::new(1.95, 0.95)) < 1e-12);
        assert!(lower_left(TagPoint::Inner).distance(Point::new(2.0, 1.0)) < 1e-12);
    }
}
