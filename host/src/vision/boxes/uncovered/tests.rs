//! Drawn floors: what is dark on them lies inside what is reported.

use super::*;
use crate::geometry::Arena;
use crate::shape::Shape;
use crate::vision::detect::{Detection, detect};
use crate::vision::image::Photo;
use crate::vision::options::DetectOptions;
use crate::vision::warning::Warning;

const ARENA: Arena = Arena { width: 1.2, height: 0.9 };
/// Pixels per metre of the drawings: walls of 5 mm have two.
const SCALE: f64 = 400.0;
/// What is drawn may stick out of shapes and margins by two pixels, and by one more where a slightly turned
/// edge passes for the visible side of a tall box, metres.
const TOLERANCE: f64 = 3.0 / SCALE;

/// A light floor with a dark frame and with something dark on it, seen straight from above.
fn seen(is_dark: impl Fn(Point) -> bool) -> Detection {
    let code = |point: Point| if is_dark(point) { 40.0 } else { 220.0 };
    seen_with(code, DetectOptions::default())
}

/// The same with the codes that the floor shows.
fn seen_with(code: impl Fn(Point) -> f64, options: DetectOptions) -> Detection {
    let (columns, rows) = (520, 400);
    let mut noise = fastrand::Rng::with_seed(7);
    let pixels = (0..columns * rows).map(|i| {
        let x = (f64::from(i % columns) - 20.0 + 0.5) / SCALE;
        let y = ARENA.height - (f64::from(i / columns) - 20.0 + 0.5) / SCALE;
        let on_floor = x > 0.0 && y > 0.0 && x < ARENA.width && y < ARENA.height;
        let code = if on_floor { code(Point::new(x, y)) } else { 40.0 };
        [code as u8 + noise.u8(0..6); 3]
    });
    let photo = Photo::from_rgb(columns as usize, rows as usize, pixels.collect()).unwrap();
    let corners = [[19.5, 379.5], [499.5, 379.5], [499.5, 19.5], [19.5, 19.5]];
    detect(&photo, ARENA, &DetectOptions { corners: Some(corners), ..options }).unwrap()
}

/// How far a dark point sticks out of all shapes with their margins at most, metres.
fn out_by(seen: &Detection, is_dark: impl Fn(Point) -> bool) -> f64 {
    let place = |i: u32| Point::new(f64::from(i % 480) / SCALE, f64::from(i / 480) / SCALE);
    let nearest = |point: Point| {
        seen.obstacles.iter().map(|obstacle| obstacle.distance(point)).fold(9.0, f64::min)
    };
    (0..480 * 360).map(place).filter(|&p| is_dark(p)).map(nearest).fold(0.0, f64::max)
}

/// Whether a point lies in a rectangle of half sides `a` and `b` turned by `angle` about (0.6, 0.45).
fn in_turned(point: Point, angle: f64, a: f64, b: f64) -> bool {
    let (x, y) = (point.x - 0.6, point.y - 0.45);
    let (sin, cos) = angle.sin_cos();
    (x * cos + y * sin).abs() < a && (y * cos - x * sin).abs() < b
}

#[test]
fn turned_boxes_lie_inside_what_is_reported() {
    for degrees in [5.0_f64, 17.0, 30.0, 45.0] {
        let is_dark = |point: Point| in_turned(point, degrees.to_radians(), 0.15, 0.08);
        let seen = seen(is_dark);
        let out = out_by(&seen, is_dark);
        assert!(out < TOLERANCE, "{degrees}: {out} {:?}", seen.obstacles);
    }
}

/// A quarter of a pixel more or less at every edge is two per cent of the area of such a box.
#[test]
fn a_turned_box_and_a_disc_are_one_shape_each() {
    let is_dark = |point: Point| in_turned(point, 0.5, 0.15, 0.08);
    let [turned] = &seen(is_dark).obstacles[..] else { panic!("{:?}", seen(is_dark).obstacles) };
    let Shape::Polygon(polygon) = &turned.footprint else { panic!("{turned:?}") };
    assert_eq!(polygon.corners().len(), 4);
    assert!((polygon.area() - 0.048).abs() < 0.02 * 0.048, "{}", polygon.area());
    let disc = |point: Point| point.distance(Point::new(0.6, 0.45)) < 0.11;
    let [round] = &seen(disc).obstacles[..] else { panic!("{:?}", seen(disc).obstacles) };
    let Shape::Circle(circle) = round.footprint else { panic!("{round:?}") };
    assert!((circle.radius - 0.11).abs() < 0.25 / SCALE, "{circle:?}");
    assert!(circle.centre.distance(Point::new(0.6, 0.45)) < 0.001, "{circle:?}");
}

#[test]
fn discs_triangles_and_walls_lie_inside_what_is_reported() {
    let disc = |p: Point| p.distance(Point::new(0.6, 0.45)) < 0.11;
    let triangle = |p: Point| p.y > 0.3 && p.y < 0.3 + 0.8 * (p.x - 0.4) && p.x < 0.8;
    let walls = |p: Point| {
        let thick = |x: f64, width: f64| p.x > x && p.x < x + width;
        p.y > 0.2 && p.y < 0.7 && (thick(0.3, 0.02) || thick(0.5, 0.01) || thick(0.7, 0.005))
    };
    let shapes: [&dyn Fn(Point) -> bool; 3] = [&disc, &triangle, &walls];
    for (index, is_dark) in shapes.iter().enumerate() {
        let seen = seen(is_dark);
        assert!(out_by(&seen, is_dark) < TOLERANCE, "{index}: {:?}", seen.obstacles);
    }
}

#[test]
fn an_empty_floor_has_no_obstacles_and_lines_from_side_to_side_are_floor_but_said() {
    let empty = seen(|_| false);
    assert!(empty.obstacles.is_empty() && empty.warnings.is_empty(), "{empty:?}");
    let lines = seen(|p| (p.x - 0.4).abs() < 0.003 || (p.y - 0.5).abs() < 0.003);
    assert!(lines.obstacles.is_empty(), "{:?}", lines.obstacles);
    assert!(lines.warnings.contains(&Warning::FloorLines));
}

/// A robot without a mark, say: its body, its wheel and loops of cable that reach the wall.
#[test]
fn a_thing_of_no_simple_shape_beside_the_wall_lies_inside_what_is_reported() {
    let turned = |p: Point| in_turned(Point::new(p.x + 0.47, p.y + 0.25), 0.3, 0.09, 0.07);
    let ring = |p: Point, x: f64, y: f64, radius: f64| {
        (p.distance(Point::new(x, y)) - radius).abs() < 0.006
    };
    let is_dark = |p: Point| {
        turned(p)
            || ring(p, 0.05, 0.12, 0.05)
            || ring(p, 0.06, 0.26, 0.04)
            || p.distance(Point::new(0.2, 0.3)) < 0.06
    };
    let seen = seen(is_dark);
    let out = out_by(&seen, is_dark);
    assert!(out < TOLERANCE, "{out} {:?}", seen.obstacles);
}

#[test]
fn a_blurred_triangle_ends_where_half_of_the_light_is_the_floors() {
    let corners = [Point::new(0.4, 0.3), Point::new(0.8, 0.35), Point::new(0.55, 0.65)];
    // How far a point lies inside of the nearest edge, metres; the lens blurs edges over ten pixels.
    let depth = |p: Point| {
        let edges = (0..3).map(|i| (corners[i], corners[(i + 1) % 3]));
        let inside = |(a, b): (Point, Point)| {
            ((b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x)) / a.distance(b)
        };
        edges.map(inside).fold(f64::INFINITY, f64::min)
    };
    let share = |p: Point| (0.5 + depth(p) * SCALE / 10.0).clamp(0.0, 1.0);
    let seen = seen_with(|p| 220.0 - 180.0 * share(p), DetectOptions::default());
    let [shape] = &seen.obstacles[..] else { panic!("{:?}", seen.obstacles) };
    let [a, b, c] = corners;
    let area = ((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x)) / 2.0;
    // Half of the light of codes 220 and 40 is that of code 163.5, 1.86 pixels outside of the middle of the
    // blur; the edge is found to a pixel.
    let outline = a.distance(b) + b.distance(c) + c.distance(a);
    let outside = (shape.footprint.area() - area) / outline * SCALE;
    assert!((outside - 1.86).abs() < 1.0, "{outside} {shape:?}");
}

#[test]
fn a_fold_that_stands_out_in_pieces_is_floor_and_a_wall_of_that_length_is_none() {
    let line = |p: Point| (p.x - 0.5).abs() < 0.003;
    let fold = |p: Point| if line(p) { 25.0 + 20.0 * (9.0 * p.y).sin() } else { 0.0 };
    let folded = seen_with(|p| 220.0 - fold(p), DetectOptions::default());
    assert!(folded.obstacles.is_empty(), "{:?}", folded.obstacles);
    let wall = |p: Point| line(p) && p.y > 0.2 && p.y < 0.5;
    let walled = seen_with(|p| if wall(p) { 175.0 } else { 220.0 }, DetectOptions::default());
    assert!(out_by(&walled, wall) < TOLERANCE, "{:?}", walled.obstacles);
}

#[test]
fn a_turned_box_on_a_printed_grid_is_one_shape_and_the_grid_is_none() {
    let cells = |at: f64| ((at - 0.07) / 0.15).fract().abs() < 0.03;
    let is_box = |p: Point| in_turned(p, 0.3, 0.12, 0.06);
    let is_dark = |p: Point| is_box(p) || cells(p.x) || cells(p.y);
    let seen = seen(is_dark);
    let [shape] = &seen.obstacles[..] else { panic!("{:?}", seen.obstacles) };
    assert!((shape.footprint.area() / 0.0288 - 1.0).abs() < 0.08, "{shape:?}");
    assert!(out_by(&seen, is_box) < TOLERANCE, "{shape:?}");
    assert!(seen.warnings.contains(&Warning::FloorLines));
}

#[test]
fn what_is_as_dark_as_shadow_near_a_start_without_mark_stays_an_obstacle() {
    let square = |x: f64, y: f64, p: Point| (p.x - x).abs().max((p.y - y).abs()) < 0.025;
    let places = [(0.45, 0.45), (0.8, 0.7), (0.9, 0.25), (0.3, 0.75)];
    let is_grey = |p: Point| places.iter().any(|&(x, y)| square(x, y, p));
    let start = crate::geometry::Pose { position: Point::new(0.3, 0.45), heading: 0.0 };
    let options = DetectOptions { robot_at: Some(start), ..DetectOptions::default() };
    let seen = seen_with(|p| if is_grey(p) { 110.0 } else { 220.0 }, options);
    assert!(out_by(&seen, is_grey) < TOLERANCE, "{:?}", seen.obstacles);
}
