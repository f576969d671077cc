//! The robot in the picture: a disc with a triangle on its top that points ahead.
//!
//! Colours are not known. Discs of the robot's size are looked at; the triangle's heading is the one that splits the disc's colours best
//! into triangle and rest. Lengths are those of the robot's top as the floor's map shows it: raised by the
//! robot's height it looks larger and farther from the camera's foot point, by the same factor.

use super::disc::{DIRECTIONS, Size, centres, circle, contrast, on_circle};
use super::triangle;
use crate::geometry::{Point, square_to_leg};
use crate::vision::appearance::Look;
use crate::vision::camera::PlanMap;
use crate::vision::image::Photo;

/// The share of the disc's variance that triangle and rest explain. A triangle that points elsewhere still explains up
/// to a half of one that is there: what is no more may be any two colours, and its heading any at all.
const LEAST_EXPLAINED: f64 = 0.6;
/// The robot's top leans by at most this; leans that are tried.
const LEAN_RANGE: f64 = 0.05;
const LEAN_STEPS: usize = 50;
/// The arc of the base that faces the camera, radians to each side, and the width of its edge, pixels.
const BASE_ARC: f64 = 0.9;
const BASE_BLUR: f64 = 0.8;
/// The least step at the base's edge: the square root of a difference of features.
const LEAST_CLARITY: f32 = 0.4;
/// The least radius in cells at which a triangle can be made out.
const LEAST_RADIUS_CELLS: f64 = 5.0;

/// The robot's top as it appears on the floor's plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct RobotTop {
    pub(crate) centre: Point,
    pub(crate) radius: f64,
    /// Counter-clockwise from +x, radians.
    pub(crate) heading: f64,
    /// How surely this is a robot, 0 to 1.
    pub(crate) certainty: f64,
    /// The floor point under it as far as is known, else its centre.
    pub(crate) base: Point,
}

impl RobotTop {
    /// The same over a place of the floor.
    pub(crate) fn above(self, base: Point) -> Self {
        Self { base, ..self }
    }

    /// How far a point is from the line between base and top, radii of the top: the robot hides what is nearer than 1.
    pub(crate) fn radii_from(&self, point: Point) -> f64 {
        square_to_leg(point, self.base, self.centre).sqrt() / self.radius
    }
}

/// Finds the robot whose top appears in such a size; `None` if there is none.
pub(crate) fn find(photo: &Photo, map: &PlanMap, look: &Look, size: Size) -> Option<RobotTop> {
    let cells = size.likely * look.view.scale;
    if cells < LEAST_RADIUS_CELLS {
        return None;
    }
    let mut best: Option<RobotTop> = None;
    for (column, row, directions) in centres(look, cells) {
        let rough = look.view.point(column, row);
        let Some((centre, radius)) = circle(photo, map, look, rough, size) else { continue };
        let (centre, heading, explained) = triangle::read(photo, map, look, (centre, radius));
        let certainty = explained * f64::from(directions) / f64::from(DIRECTIONS);
        if explained > LEAST_EXPLAINED && best.is_none_or(|best| certainty > best.certainty) {
            best = Some(RobotTop { centre, radius, heading, certainty, base: centre });
        }
    }
    best
}

/// The lean of the robot's top, from the edge of its base that faces the camera's foot point, if that
/// is seen apart from the top's.
pub(crate) fn shown_lean(
    photo: &Photo,
    map: &PlanMap,
    top: RobotTop,
    foot: Point,
    radius: f64,
) -> Option<f64> {
    const RAYS: usize = 31;
    let (dx, dy) = (foot.x - top.centre.x, foot.y - top.centre.y);
    let (distance, towards) = (dx.hypot(dy), dy.atan2(dx));
    let half = BASE_BLUR / map.scale_at(top.centre).max(1.0);
    let clarity = |lean: f64| {
        let base = on_circle(top.centre, distance * (1.0 - 1.0 / lean), towards);
        let ray = |ray: usize| {
            let angle = towards + BASE_ARC * (2.0 * ray as f64 / (RAYS - 1) as f64 - 1.0);
            // Where the base shows less than this much of itself beside the top, their edges blur together.
            let apart = on_circle(base, radius, angle).distance(top.centre) - lean * radius;
            let edge = [radius - half, radius + half].map(|r| on_circle(base, r, angle));
            (apart > 2.0 * half).then(|| contrast(photo, map, edge))
        };
        let seen: Vec<f32> = (0..RAYS).filter_map(ray).collect();
        let enough = seen.len() > RAYS / 3;
        enough.then(|| seen.iter().sum::<f32>() / seen.len() as f32)
    };
    let tried = (0..LEAN_STEPS).filter_map(|i| {
        let lean = 1.0 + LEAN_RANGE * (i + 1) as f64 / LEAN_STEPS as f64;
        clarity(lean).map(|clear| (lean, clear))
    });
    let (lean, clear) = tried.max_by(|a, b| a.1.total_cmp(&b.1))?;
    (clear > LEAST_CLARITY).then_some(lean)
}

#[cfg(test)]
mod tests {
    use super::super::triangle::{APEX, BASE, HALF_BASE};
    use super::*;
    use crate::geometry::Arena;

    const ARENA: Arena = Arena { width: 1.5, height: 1.2 };

    /// A white floor with a grey robot and a dark box.
    fn drawn(pose: Option<(Point, f64)>) -> (Photo, PlanMap) {
        picture(|p: Point| {
            if p.x < 0.3 && p.y > 0.8 {
                return 20.0;
            }
            let Some((centre, heading)) = pose else { return 230.0 };
            let (dx, dy) = ((p.x - centre.x) / 0.075, (p.y - centre.y) / 0.075);
            let (ahead, aside) =
                (dx * heading.cos() + dy * heading.sin(), dy * heading.cos() - dx * heading.sin());
            let half = HALF_BASE * (APEX - ahead) / (APEX - BASE);
            match dx.hypot(dy) < 1.0 {
                true if ahead > BASE && aside.abs() < half => 60.0,
                true => 190.0,
                false => 230.0,
            }
        })
    }

    /// What has these greys, at 200 pixels a metre, drawn with 4 × 4 samples.
    fn picture(colour: impl Fn(Point) -> f64) -> (Photo, PlanMap) {
        let pixel = |i: usize| {
            let sum: f64 = (0..16)
                .map(|s| {
                    colour(Point::new(
                        ((i % 300) as f64 + (s % 4) as f64 / 4.0) / 200.0,
                        1.2 - ((i / 300) as f64 + (s / 4) as f64 / 4.0) / 200.0,
                    ))
                })
                .sum();
            [(sum / 16.0) as u8; 3]
        };
        let photo = Photo::from_rgb(300, 240, (0..300 * 240).map(pixel).collect()).unwrap();
        let corners = [[-0.375, 239.625], [299.625, 239.625], [299.625, -0.375], [-0.375, -0.375]];
        let map = PlanMap::from_corners(&photo, ARENA, corners, 0.0).unwrap();
        (photo, map)
    }

    #[test]
    fn a_robot_hides_the_floor_between_its_base_and_its_top() {
        let centre = Point::new(1.0, 1.0);
        let top = RobotTop { centre, radius: 0.1, heading: 0.0, certainty: 1.0, base: centre };
        assert!((top.radii_from(Point::new(1.3, 1.4)) - 5.0).abs() < 1e-12);
        let swept = top.above(Point::new(0.6, 1.0));
        for (x, y, radii) in [(0.8, 1.2, 2.0), (0.5, 1.0, 1.0), (1.0, 0.9, 1.0), (1.3, 1.4, 5.0)] {
            assert!((swept.radii_from(Point::new(x, y)) - radii).abs() < 1e-12, "{x} {y}");
        }
    }

    #[test]
    fn the_pose_is_found_to_a_millimetre_and_a_degree() {
        let (photo, map) = drawn(Some((Point::new(0.7, 0.5), 2.1)));
        let look = Look::at(&photo, &map, ARENA).unwrap();
        let robot = find(&photo, &map, &look, Size::guessed(0.075)).unwrap();
        assert!(robot.centre.distance(Point::new(0.7, 0.5)) < 1e-3, "{robot:?}");
        assert!(
            (robot.heading - 2.1).abs() < 0.02 && (robot.radius - 0.075).abs() < 1e-3,
            "{robot:?}"
        );
    }

    #[test]
    fn a_box_is_no_robot() {
        let (photo, map) = drawn(None);
        let look = Look::at(&photo, &map, ARENA).unwrap();
        assert_eq!(find(&photo, &map, &look, Size::guessed(0.075)), None);
    }

    #[test]
    fn a_disc_of_two_halves_tells_no_heading() {
        // Each half is all one colour, so a triangle explains a part of the disc, and points anywhere.
        let halves = |at: Point| match at.distance(Point::new(0.7, 0.5)) < 0.075 {
            true if at.x < 0.7 => 60.0,
            true => 190.0,
            false => 230.0,
        };
        let (photo, map) = picture(halves);
        let look = Look::at(&photo, &map, ARENA).unwrap();
        assert_eq!(find(&photo, &map, &look, Size::guessed(0.075)), None);
    }

    #[test]
    fn the_base_beside_the_top_shows_how_the_top_leans() {
        const LEAN: f64 = 1.03;
        let (foot, base) = (Point::new(0.2, 0.3), Point::new(1.2, 0.8));
        let top = Point::new(foot.x + LEAN * (base.x - foot.x), foot.y + LEAN * (base.y - foot.y));
        let pixels = (0..450 * 360).map(|i| {
            let point = Point::new((i % 450) as f64 / 300.0, 1.2 - (i / 450) as f64 / 300.0);
            // The side is what the disc sweeps on its way from the base to the top.
            let swept = (0..=10).any(|step| {
                let share = f64::from(step) / 10.0;
                let x = base.x + share * (top.x - base.x);
                let y = base.y + share * (top.y - base.y);
                point.distance(Point::new(x, y)) < 0.075 * (1.0 + share * (LEAN - 1.0))
            });
            match point.distance(top) < LEAN * 0.075 {
                true => [200, 90, 40],
                false if swept => [90, 40, 20],
                false => [225; 3],
            }
        });
        let photo = Photo::from_rgb(450, 360, pixels.collect()).unwrap();
        let corners = [[0.0, 360.0], [450.0, 360.0], [450.0, 0.0], [0.0, 0.0]];
        let map = PlanMap::from_corners(&photo, ARENA, corners, 0.0).unwrap();
        let top =
            RobotTop { centre: top, radius: LEAN * 0.075, heading: 0.0, certainty: 1.0, base: top };
        let lean = shown_lean(&photo, &map, top, foot, 0.075).unwrap();
        // A pixel is 3 mm on 1.1 m.
        assert!((lean - LEAN).abs() < 0.003, "{lean}");
    }
}
