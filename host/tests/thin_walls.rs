//! Thin walls that enclose floor stay walls: the floor between them is free, whatever the maze's plan.
#![allow(clippy::unwrap_used, clippy::panic, reason = "helpers of tests fail as tests do")]

use wmr::geometry::{Arena, Point};
use wmr::vision::{DetectOptions, Photo, detect};

const ARENA: Arena = Arena { width: 1.2, height: 0.9 };
/// Pixels per metre, and pixels around the arena.
const SCALE: f64 = 400.0;
const PAD: f64 = 20.0;
/// Parts of a pixel's side that are looked at.
const PARTS: u32 = 4;
/// What is drawn is found to a pixel, and to another one where edges are blurred over two, metres.
const OUTSIDE: f64 = 2.0 / SCALE;
/// Floor further from every wall than this is free, metres: six pixels.
const BESIDE: f64 = 6.0 / SCALE;

type Wall = ([f64; 2], [f64; 2]);

/// A maze's plan: a name and the middle lines of its walls.
fn plans() -> Vec<(&'static str, Vec<Wall>)> {
    let path = |corners: &[[f64; 2]]| corners.windows(2).map(|w| (w[0], w[1])).collect::<Vec<_>>();
    let comb = || {
        let teeth = (0..4).map(|i| 0.2 + 0.25 * f64::from(i)).map(|x| ([x, 0.25], [x, 0.65]));
        [([0.2, 0.25], [0.95, 0.25])].into_iter().chain(teeth)
    };
    vec![
        ("ell from the border", path(&[[0.4, 0.0], [0.4, 0.6], [0.6, 0.6]])),
        (
            "spiral",
            path(&[[0.2, 0.15], [1.0, 0.15], [1.0, 0.75], [0.4, 0.75], [0.4, 0.35], [0.8, 0.35]]),
        ),
        ("crossing", vec![([0.6, 0.2], [0.6, 0.7]), ([0.3, 0.5], [0.9, 0.5])]),
        ("comb", comb().collect()),
        ("turned ell", path(&[[0.35, 0.2], [0.5, 0.7], [0.85, 0.6]])),
    ]
}

fn distance(walls: &[Wall], point: Point) -> f64 {
    let of = |&([ax, ay], [bx, by]): &Wall| {
        let (dx, dy, px, py) = (bx - ax, by - ay, point.x - ax, point.y - ay);
        let along = ((px * dx + py * dy) / (dx * dx + dy * dy)).clamp(0.0, 1.0);
        (px - along * dx).hypot(py - along * dy)
    };
    walls.iter().map(of).fold(f64::INFINITY, f64::min)
}

/// A floor of code 220 with walls of a width, metres, and of a code of their own, in a black frame.
fn picture(walls: &[Wall], width: f64, code: f64) -> Photo {
    let (columns, rows) =
        ((ARENA.width * SCALE + 2.0 * PAD) as u32, (ARENA.height * SCALE + 2.0 * PAD) as u32);
    let mut noise = fastrand::Rng::with_seed(5);
    let seen = |x: f64, y: f64| {
        let point = Point::new((x - PAD) / SCALE, ARENA.height - (y - PAD) / SCALE);
        let on_floor =
            (0.0..ARENA.width).contains(&point.x) && (0.0..ARENA.height).contains(&point.y);
        let is_wall = on_floor && distance(walls, point) < width / 2.0;
        if is_wall { code } else { f64::from(u8::from(on_floor)) * 180.0 + 40.0 }
    };
    let pixel = |index: u32| {
        let (x, y) = (f64::from(index % columns), f64::from(index / columns));
        let part = |i: u32| (f64::from(i) + 0.5) / f64::from(PARTS);
        let parts = (0..PARTS * PARTS).map(|i| seen(x + part(i % PARTS), y + part(i / PARTS)));
        let mean = parts.sum::<f64>() / f64::from(PARTS * PARTS);
        [mean as u8 + noise.u8(0..6); 3]
    };
    let pixels = (0..columns * rows).map(pixel).collect();
    Photo::from_rgb(columns as usize, rows as usize, pixels).unwrap()
}

#[test]
fn walls_lie_inside_what_is_reported_and_the_floor_that_they_enclose_is_free() {
    let (left, low) = (PAD - 0.5, PAD - 0.5 + ARENA.height * SCALE);
    let (right, high) = (left + ARENA.width * SCALE, PAD - 0.5);
    let corners = Some([[left, low], [right, low], [right, high], [left, high]]);
    let options = DetectOptions { corners, ..DetectOptions::default() };
    for (name, walls) in plans() {
        for (width, code) in [(0.004, 40.0), (0.006, 120.0), (0.010, 40.0)] {
            let seen = detect(&picture(&walls, width, code), ARENA, &options).unwrap();
            let nearest = |point| {
                seen.obstacles.iter().map(|of| of.distance(point)).fold(f64::INFINITY, f64::min)
            };
            let case = format!("{name}, {width} m, code {code}: {:?}", seen.obstacles);
            for index in 0..240 * 180 {
                let place = |i: u32| (f64::from(i) + 0.5) * 0.005;
                let point = Point::new(place(index % 240), place(index / 240));
                let (off, away) = (distance(&walls, point) - width / 2.0, nearest(point));
                assert!(off > 0.0 || away < OUTSIDE, "{point:?} sticks out by {away}: {case}");
                assert!(off < BESIDE || away > 0.0, "{point:?} is floor: {case}");
            }
        }
    }
}
