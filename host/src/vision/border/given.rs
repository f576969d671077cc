//! The map of corners that a person or tags give, held against the arena's size.
//!
//! Four corners leave a homography free: any quadrilateral may be any rectangle. That a camera saw the arena of
//! the stated size is a condition that a wrong order or a wrong size does not meet.

use super::origin::{PictureCorner, lowest_left};
use crate::geometry::{Arena, Point};
use crate::vision::camera::{PlanMap, StatedFit, Viewpoint};
use crate::vision::error::VisionError;
use crate::vision::image::Photo;
use crate::vision::warning::Warning;

/// A person points at corners and measures an arena to about this much of its sides: the ratio of sides (a natural
/// logarithm) and the angle between them (radians) are off by no more.
const EXACT: f64 = 0.03;
/// What is off by more is another arena, or other corners.
const ROUGH: f64 = 0.1;
/// A corner may lie outside the picture by this share of its width.
const OUTSIDE: f64 = 0.1;
/// Places along each side of the floor at which it is asked whether the photo shows it.
const LATTICE: usize = 50;

/// Who says where the corners are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum By {
    /// A person, counter-clockwise from the origin.
    Hand,
    /// Tags: counter-clockwise as the picture shows them, from its lower left.
    Tags,
}

/// A map from given corners, and what is odd about them.
#[derive(Clone, Debug)]
pub(crate) struct Given {
    pub(crate) map: PlanMap,
    pub(crate) warnings: Vec<Warning>,
}

/// The map of four given corners, pixels; with `origin` they begin at that corner, wherever they did.
///
/// # Errors
/// [`VisionError::Corners`] for corners that enclose no floor, [`VisionError::CornerOrder`] and
/// [`VisionError::CornerShape`] with the order that fits the arena, [`VisionError::OutOfView`].
pub(crate) fn given(
    photo: &Photo,
    arena: Arena,
    corners: [[f64; 2]; 4],
    (by, origin): (By, Option<PictureCorner>),
) -> Result<Given, VisionError> {
    check_order(corners)?;
    let slack = OUTSIDE * photo.width() as f64;
    if let Some(corner) = corners.iter().position(|&pixel| !photo.holds_within(pixel, slack)) {
        return Err(VisionError::OutOfView { corner, pixel: corners[corner] });
    }
    let from = |first: usize| begun_at(corners, first);
    let first = origin.map_or(0, |origin| (lowest_left(corners) + origin.index()) % 4);
    let fit = |first: usize| {
        let map = PlanMap::from_seen_corners(photo, arena, from(first), 0.0)?;
        Some((Viewpoint::stated_fit(photo, &map).off(), map))
    };
    let (off, map) = fit(first).ok_or(VisionError::Corners)?;
    let turned = fit(first + 1).filter(|(turned, _)| off > EXACT && *turned <= EXACT);
    let mut warnings = Vec::new();
    let map = match turned {
        Some((_, map)) if by == By::Tags && origin.is_none() => {
            warnings.push(Warning::WidthRunsUp);
            map
        }
        turned => {
            let shape = Viewpoint::stated_fit(photo, &map);
            if turned.is_some() || off > ROUGH {
                let order = turned.map(|_| from(first + 1));
                return Err(odd_shape(arena, shape, order));
            }
            warnings.extend(
                (off > EXACT)
                    .then(|| Warning::RoughCorners { arena, seen: shape.seen_ratio(arena) }),
            );
            map
        }
    };
    warnings.extend((by == By::Hand && origin.is_none()).then(|| other_start(corners)).flatten());
    warnings.extend(out_of_sight(photo, &map, arena));
    Ok(Given { map, warnings })
}

/// Refuses corners that do not run counter-clockwise around a floor.
fn check_order(corners: [[f64; 2]; 4]) -> Result<(), VisionError> {
    if is_convex(corners) {
        return Ok(());
    }
    let middle = [0, 1].map(|axis| corners.iter().map(|corner| corner[axis]).sum::<f64>() / 4.0);
    let angle = |corner: &[f64; 2]| (middle[1] - corner[1]).atan2(corner[0] - middle[0]);
    let mut order = corners;
    order.sort_by(|a, b| angle(a).total_cmp(&angle(b)));
    let first = order.iter().position(|corner| *corner == corners[0]).unwrap_or(0);
    order.rotate_left(first);
    Err(if is_convex(order) { VisionError::CornerOrder { order } } else { VisionError::Corners })
}

/// Whether corners run counter-clockwise around a floor. With rows running down that is clockwise in numbers.
pub(crate) fn is_convex(corners: [[f64; 2]; 4]) -> bool {
    (0..4).all(|i| {
        let [a, b, c] = [corners[i], corners[(i + 1) % 4], corners[(i + 2) % 4]];
        (b[0] - a[0]) * (c[1] - b[1]) - (b[1] - a[1]) * (c[0] - b[0]) < 0.0
    })
}

/// The same corners from another of them on.
fn begun_at(mut corners: [[f64; 2]; 4], first: usize) -> [[f64; 2]; 4] {
    corners.rotate_left(first % 4);
    corners
}

fn odd_shape(arena: Arena, shape: StatedFit, order: Option<[[f64; 2]; 4]>) -> VisionError {
    VisionError::CornerShape { arena, seen: shape.seen_ratio(arena), order }
}

/// What to say of corners that begin elsewhere than at the lower left of the picture.
fn other_start(corners: [[f64; 2]; 4]) -> Option<Warning> {
    let first = PictureCorner::ALL[(4 - lowest_left(corners)) % 4];
    (first != PictureCorner::LowerLeft).then_some(Warning::FirstCorner(first))
}

/// What to say of floor that the photo does not show.
fn out_of_sight(photo: &Photo, map: &PlanMap, arena: Arena) -> Option<Warning> {
    let share = |index: usize| (index as f64 + 0.5) / LATTICE as f64;
    let place = |index: usize| {
        let (x, y) = (share(index % LATTICE), share(index / LATTICE));
        Point::new(x * arena.width, y * arena.height)
    };
    let unseen: Vec<Point> = (0..LATTICE * LATTICE)
        .map(place)
        .filter(|&point| !photo.holds(map.to_photo(point)))
        .collect();
    let range = |value: fn(&Point) -> f64| {
        let values = unseen.iter().map(value);
        values.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], v| [a.min(v), b.max(v)])
    };
    (!unseen.is_empty()).then(|| Warning::FloorOutOfView {
        share: unseen.len() as f64 / (LATTICE * LATTICE) as f64,
        x: range(|point| point.x),
        y: range(|point| point.y),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use miette::Diagnostic;

    const ARENA: Arena = Arena { width: 1.6, height: 1.2 };
    /// 200 pixels a metre, straight from above.
    const UPRIGHT: [[f64; 2]; 4] = [[100.0, 300.0], [420.0, 300.0], [420.0, 60.0], [100.0, 60.0]];

    fn photo() -> Photo {
        Photo::from_rgb(520, 360, vec![[120; 3]; 520 * 360]).unwrap()
    }

    fn by_hand(arena: Arena, corners: [[f64; 2]; 4]) -> Result<Given, VisionError> {
        given(&photo(), arena, corners, (By::Hand, None))
    }

    #[test]
    fn corners_that_fit_are_taken_without_a_word() {
        let seen = by_hand(ARENA, UPRIGHT).unwrap();
        assert_eq!(seen.warnings, []);
        for (found, given) in seen.map.seen_corners(ARENA).into_iter().zip(UPRIGHT) {
            assert!((found[0] - given[0]).hypot(found[1] - given[1]) < 1e-6);
        }
    }

    #[test]
    fn a_wrong_order_is_refused_with_the_right_one() {
        let [a, b, c, d] = UPRIGHT;
        for wrong in [[a, d, c, b], [a, c, b, d], [a, b, d, c]] {
            match by_hand(ARENA, wrong) {
                Err(error @ VisionError::CornerOrder { .. }) => {
                    let text = "\"100,300 420,300 420,60 100,60\"";
                    assert!(error.help().unwrap().to_string().contains(text), "{error:?}");
                }
                other => panic!("{other:?}"),
            }
        }
        let inside = [a, b, [200.0, 250.0], d];
        assert_eq!(by_hand(ARENA, inside).unwrap_err(), VisionError::Corners);
        assert_eq!(by_hand(ARENA, [a, a, c, d]).unwrap_err(), VisionError::Corners);
    }

    #[test]
    fn a_start_at_the_wrong_side_is_refused_with_the_order_that_fits() {
        let [a, b, c, d] = UPRIGHT;
        match by_hand(ARENA, [b, c, d, a]) {
            Err(VisionError::CornerShape { order: Some(order), seen: Some(seen), .. }) => {
                assert_eq!(order, [c, d, a, b]);
                assert!((seen - 0.75).abs() < 1e-3, "{seen}");
            }
            other => panic!("{other:?}"),
        }
        // Half a turn on, they fit as well; that (0, 0) is at the upper right is said, or asked for.
        let half = [c, d, a, b];
        let seen = by_hand(ARENA, half).unwrap();
        assert_eq!(seen.warnings, [Warning::FirstCorner(PictureCorner::UpperRight)]);
        let origin = Some(PictureCorner::UpperRight);
        let asked = given(&photo(), ARENA, UPRIGHT, (By::Hand, origin)).unwrap();
        assert_eq!(asked.warnings, []);
        let first = asked.map.to_photo(Point::new(0.0, 0.0));
        assert!((first[0] - c[0]).hypot(first[1] - c[1]) < 1e-6, "{first:?}");
    }

    #[test]
    fn another_size_is_said_up_to_a_tenth_and_refused_beyond() {
        let of = |width: f64| by_hand(Arena { width, height: 1.2 }, UPRIGHT);
        assert!(of(1.63).unwrap().warnings.is_empty());
        let rough = of(1.7).unwrap().warnings;
        assert!(rough[0].to_string().contains("1.33 to 1, 1.42 to 1 was stated"), "{rough:?}");
        assert!(matches!(of(2.2), Err(VisionError::CornerShape { order: None, .. })));
        // No camera sees a rectangle as a slanted parallelogram.
        let [a, b, [cx, cy], [dx, dy]] = UPRIGHT;
        let slanted = [a, b, [cx + 80.0, cy], [dx + 80.0, dy]];
        assert!(matches!(by_hand(ARENA, slanted), Err(VisionError::CornerShape { .. })));
    }

    #[test]
    fn a_corner_may_lie_a_tenth_of_the_width_outside() {
        let moved = |by: f64| UPRIGHT.map(|[x, y]| [x - 100.0 - by, y]);
        let seen = by_hand(ARENA, moved(50.0)).unwrap();
        // 50 of 320 columns, and half a pixel that the picture's rim shows.
        let [Warning::FloorOutOfView { share, .. }] = seen.warnings[..] else { panic!("{seen:?}") };
        assert!((share - 0.16).abs() < 1e-9, "{share}");
        assert!(matches!(by_hand(ARENA, moved(53.0)), Err(VisionError::OutOfView { .. })));
    }

    #[test]
    fn tags_begin_where_the_size_fits() {
        let upwards = Arena { width: 1.2, height: 1.6 };
        let seen = given(&photo(), upwards, UPRIGHT, (By::Tags, None)).unwrap();
        let first = seen.map.to_photo(Point::new(0.0, 0.0));
        assert!((first[0] - 420.0).hypot(first[1] - 300.0) < 1e-6, "{first:?}");
        assert_eq!(seen.warnings, [Warning::WidthRunsUp]);
        let origin = Some(PictureCorner::LowerLeft);
        assert!(given(&photo(), upwards, UPRIGHT, (By::Tags, origin)).is_err());
    }
}
