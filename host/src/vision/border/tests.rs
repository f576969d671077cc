//! Borders as people have them, drawn: sheets on any ground, tape of any tone, turned and tilted, printed grids.

use super::{PictureCorner, find};
use crate::geometry::{Arena, Point};
use crate::vision::camera::PlanMap;
use crate::vision::error::VisionError;
use crate::vision::image::Photo;

const ARENA: Arena = Arena { width: 1.6, height: 1.2 };
/// Upright, clear of the picture's edge.
const UPRIGHT: Corners = [[80.0, 420.0], [560.0, 420.0], [560.0, 60.0], [80.0, 60.0]];
/// Corners of a sharp drawn border are found this near, pixels.
const CORNER_TOLERANCE: f64 = 0.5;

type Corners = [[f64; 2]; 4];

/// A picture of 640 x 480 whose colour at a floor point is `colour`, 4 x 4 samples a pixel, with grain.
fn drawn(corners: Corners, colour: impl Fn(Point) -> f64) -> Photo {
    let blank = Photo::from_rgb(640, 480, vec![[0; 3]; 640 * 480]).unwrap();
    let map = PlanMap::from_seen_corners(&blank, ARENA, corners, 0.0).unwrap();
    let pixel = |i: usize| {
        let at = |s: usize| {
            let (dx, dy) = ((s % 4) as f64 / 4.0 - 0.375, (s / 4) as f64 / 4.0 - 0.375);
            colour(map.to_floor([(i % 640) as f64 + dx, (i / 640) as f64 + dy]))
        };
        let grain = 3.0 * ((i * 7919 % 1013) as f64 / 1013.0 - 0.5);
        [((0..16).map(at).sum::<f64>() / 16.0 + grain).round() as u8; 3]
    };
    Photo::from_rgb(640, 480, (0..640 * 480).map(pixel).collect()).unwrap()
}

/// How far inside the arena's border a point lies, metres; negative outside.
fn depth(p: Point) -> f64 {
    p.x.min(p.y).min(ARENA.width - p.x).min(ARENA.height - p.y)
}

/// A sheet with a dark box on it, on other ground.
fn sheet(floor: f64, ground: f64) -> impl Fn(Point) -> f64 {
    move |p| match depth(p) {
        d if d < 0.0 => ground,
        _ if (p.x - 0.9).abs() < 0.2 && (p.y - 0.5).abs() < 0.15 => 30.0,
        _ => floor,
    }
}

fn search(photo: &Photo, arena: Arena) -> Result<Corners, VisionError> {
    find(photo, photo, arena, None).map(|border| border.map.seen_corners(arena))
}

/// How far the farthest corner is from where it was drawn; corner 0 may be any of them.
fn error(found: Corners, drawn: Corners) -> f64 {
    let turned = |turn: usize| {
        let far = |i: usize| {
            let (a, b) = (found[(i + turn) % 4], drawn[i]);
            (a[0] - b[0]).hypot(a[1] - b[1])
        };
        (0..4).map(far).fold(0.0, f64::max)
    };
    (0..4).map(turned).fold(f64::INFINITY, f64::min)
}

/// The corners turned about the picture's centre and made smaller to stay in it.
fn turned(angle: f64, size: f64) -> Corners {
    let (sin, cos) = angle.sin_cos();
    UPRIGHT.map(|[x, y]| {
        let (x, y) = (size * (x - 320.0), size * (y - 240.0));
        [320.0 + cos * x - sin * y, 240.0 + sin * x + cos * y]
    })
}

/// A dark card with the arena's ratio on a white floor that fills the picture.
#[test]
fn a_small_card_is_no_arena_and_a_sheet_of_a_quarter_of_the_picture_is() {
    let card = drawn(turned(0.3, 0.5), sheet(60.0, 220.0));
    let refused = search(&card, ARENA).unwrap_err();
    // 480 x 360 pixels by a half, of 640 x 480.
    let share = 0.25 * 480.0 * 360.0 / (640.0 * 480.0);
    assert!(
        matches!(refused, VisionError::SmallBorder { share: told, .. } if (told - share).abs() < 0.01),
        "{refused:?}"
    );
    let quarter = turned(0.3, 0.68);
    let found = search(&drawn(quarter, sheet(60.0, 220.0)), ARENA).unwrap();
    assert!(error(found, quarter) < CORNER_TOLERANCE);
}

#[test]
fn sheets_are_found_on_lighter_and_darker_ground() {
    for (floor, ground) in
        [(225.0, 135.0), (225.0, 205.0), (225.0, 213.0), (180.0, 220.0), (60.0, 150.0)]
    {
        let found = search(&drawn(UPRIGHT, sheet(floor, ground)), ARENA);
        let found = found.unwrap_or_else(|error| panic!("{floor} on {ground}: {error}"));
        let error = error(found, UPRIGHT);
        assert!(error < CORNER_TOLERANCE, "{floor} on {ground}: {error} px");
    }
}

#[test]
fn a_tapes_inner_edge_is_the_border_whatever_its_tone() {
    for tape in [30.0, 150.0, 190.0, 245.0] {
        let colour = move |p: Point| match depth(p) {
            d if d < -0.04 => 200.0,
            d if d < 0.0 => tape,
            _ => 215.0,
        };
        let error = error(search(&drawn(UPRIGHT, colour), ARENA).unwrap(), UPRIGHT);
        assert!(error < CORNER_TOLERANCE, "tape {tape}: {error} px");
    }
}

#[test]
fn a_sheet_is_found_turned_by_any_angle() {
    for degrees in [0.0, 20.0, 38.0, 45.0, 61.0, 90.0, 117.0] {
        let corners = turned(f64::to_radians(degrees), 0.72);
        let found = search(&drawn(corners, sheet(225.0, 140.0)), ARENA);
        let found = found.unwrap_or_else(|error| panic!("{degrees} degrees: {error}"));
        let error = error(found, corners);
        assert!(error < CORNER_TOLERANCE, "{degrees} degrees: {error} px");
    }
}

#[test]
fn the_corner_at_the_lower_left_is_the_origin() {
    let found = search(&drawn(UPRIGHT, sheet(225.0, 140.0)), ARENA).unwrap();
    assert!((found[0][0] - 80.0).abs() < 1.0 && (found[0][1] - 420.0).abs() < 1.0, "{found:?}");
    // The width runs up in the picture: counter-clockwise from the lower right corner.
    let upwards = Arena { width: ARENA.height, height: ARENA.width };
    let found = search(&drawn(UPRIGHT, sheet(225.0, 140.0)), upwards).unwrap();
    assert!((found[0][0] - 560.0).abs() < 1.0 && (found[0][1] - 420.0).abs() < 1.0, "{found:?}");
}

#[test]
fn the_origin_is_the_corner_of_the_picture_that_is_asked_for() {
    for degrees in [0.0, -30.0, 38.0] {
        let corners = turned(f64::to_radians(degrees), 0.8);
        let photo = drawn(corners, sheet(225.0, 140.0));
        for origin in PictureCorner::ALL {
            let (width, height) = (ARENA.width, ARENA.height);
            let upwards = Arena { width: height, height: width };
            let fitting = if origin.is_upwards() { upwards } else { ARENA };
            let border = find(&photo, &photo, fitting, Some(origin)).unwrap();
            for (i, found) in border.map.seen_corners(fitting).into_iter().enumerate() {
                let drawn = corners[(i + origin.index()) % 4];
                let error = (found[0] - drawn[0]).hypot(found[1] - drawn[1]);
                assert!(error < CORNER_TOLERANCE, "{degrees} degrees, {origin}: {error} px");
            }
            let other = if origin.is_upwards() { ARENA } else { upwards };
            let error = find(&photo, &photo, other, Some(origin)).unwrap_err();
            assert_eq!(error, VisionError::Origin { origin, arena: other });
        }
    }
}

/// White paper on dark ground, printed with lines every 0.2 m.
fn printed(p: Point) -> f64 {
    let line = |value: f64| (value / 0.2 - (value / 0.2).round()).abs() < 0.02;
    match depth(p) {
        d if d < 0.0 => 70.0,
        _ if line(p.x) || line(p.y) => 60.0,
        _ => 225.0,
    }
}

#[test]
fn printed_lines_are_no_border_where_the_sheet_fits() {
    let error = error(search(&drawn(UPRIGHT, printed), ARENA).unwrap(), UPRIGHT);
    // The sheet's last line lies along its edge.
    assert!(error < 3.0, "{error} px");
}

#[test]
fn where_printed_lines_fit_and_the_sheet_does_not_the_sheets_ratio_is_told() {
    // Six by four and a half of the printed squares, and the sheet has eight by six.
    for arena in [Arena { width: 1.6, height: 1.1 }, Arena { width: 1.4, height: 1.2 }] {
        match search(&drawn(UPRIGHT, printed), arena) {
            Err(VisionError::OddBorder { ratio: Some(ratio), .. }) => {
                let seen = ratio * arena.width / arena.height;
                assert!((seen - 4.0 / 3.0).abs() < 0.02, "{seen}");
            }
            other => panic!("{other:?}"),
        }
    }
}

#[test]
fn an_arena_that_fills_the_picture_is_refused() {
    let rim = [[1.0, 478.0], [638.0, 478.0], [638.0, 2.0], [1.0, 2.0]];
    let found = search(&drawn(rim, sheet(225.0, 120.0)), ARENA);
    assert!(found.is_err(), "{found:?}");
}
