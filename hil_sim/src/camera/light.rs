//! Light: a round lamp that throws soft shadows, and what comes from everywhere.
//!
//! In linear light, where 1 is an unshaded floor in the middle of the arena.

use super::solid::Body;
use std::f64::consts::PI;

/// Places on the lamp from which a point is looked at: so many grades of half-shadow.
const PLACES: usize = 24;
/// A side sees half of the room above, and a little of what the floor throws back.
const ROOM_LIGHT_OF_SIDES: f64 = 0.6;
/// Rays start so far off a face, m, that they do not meet it again.
const OFF_THE_FACE: f64 = 1e-6;

/// A lamp over the arena and the light of the room.
#[derive(Clone, Debug, PartialEq)]
pub struct Light {
    /// Where the lamp is, m.
    pub lamp: [f64; 3],
    /// Its radius, m: the larger, the softer the shadows; 0 for hard ones.
    pub radius: f64,
    /// The lamp's share of the light in the middle of the floor; the rest comes from everywhere.
    pub share: f64,
}

impl Light {
    /// A ceiling lamp of 0.15 m beside a floor of this size, m.
    pub fn beside([width, depth]: [f64; 2]) -> Self {
        Self { lamp: [-0.3 * width, 1.3 * depth, 2.6], radius: 0.15, share: 0.4 }
    }
}

/// A lamp, ready for points.
#[derive(Clone, Debug)]
pub(super) struct Lamp {
    light: Light,
    places: Vec<[f64; 3]>,
    /// cos θ / d² in the middle of the floor.
    at_middle: f64,
}

impl Lamp {
    pub(super) fn new(light: Light, [width, depth]: [f64; 2]) -> Self {
        let [x, y, z] = light.lamp;
        // Points of a sunflower are spread evenly over the lamp.
        let golden = PI * (3.0 - 5f64.sqrt());
        let count = if light.radius > 0.0 { PLACES } else { 1 };
        let places = (0..count).map(|place| {
            let reach = light.radius * ((place as f64 + 0.5) / count as f64).sqrt();
            let (sin, cos) = (golden * place as f64).sin_cos();
            [x + reach * cos, y + reach * sin, z]
        });
        let places = places.collect();
        let at_middle = falloff(light.lamp, [width / 2.0, depth / 2.0, 0.0], [0.0, 0.0, 1.0]);
        Self { light, places, at_middle }
    }

    /// The shares of the lamp that `bodies` leave at a point of a face, 0..=1, and the light there.
    pub(super) fn on<'a>(
        &self,
        point: [f64; 3],
        normal: [f64; 3],
        bodies: impl Iterator<Item = &'a Body>,
    ) -> (f64, f64) {
        let room = if normal[2] > 0.5 { 1.0 } else { ROOM_LIGHT_OF_SIDES };
        let room = room * (1.0 - self.light.share);
        let full = falloff(self.light.lamp, point, normal) / self.at_middle;
        if full <= 0.0 || self.light.share <= 0.0 {
            return (0.0, room);
        }
        let start = [0, 1, 2].map(|axis| point[axis] + OFF_THE_FACE * normal[axis]);
        let mut blocking: [Option<&Body>; 4] = [None; 4];
        let mut more = Vec::new();
        let near = bodies.filter(|body| body.may_block(start, self.light.lamp, self.light.radius));
        for (number, body) in near.enumerate() {
            match blocking.get_mut(number) {
                Some(place) => *place = Some(body),
                None => more.push(body),
            }
        }
        let visible = self.visible(start, blocking.iter().flatten().chain(&more).copied());
        (visible, room + self.light.share * full * visible)
    }

    fn visible<'a>(
        &self,
        start: [f64; 3],
        blocking: impl Iterator<Item = &'a Body> + Clone,
    ) -> f64 {
        if blocking.clone().next().is_none() {
            return 1.0;
        }
        let free = |place: &&[f64; 3]| !blocking.clone().any(|body| body.blocks(start, **place));
        self.places.iter().filter(free).count() as f64 / self.places.len() as f64
    }

    /// The floor points to which the shadow of a point reaches at most; `None` if that is endless.
    pub(super) fn shadow_of(&self, [x, y, z]: [f64; 3]) -> Option<[[f64; 2]; 4]> {
        let [lx, ly, lz] = self.light.lamp;
        if lz <= 1.05 * z {
            return None;
        }
        let stretch = lz / (lz - z);
        let reach = self.light.radius;
        let corners = [[-reach, -reach], [reach, -reach], [reach, reach], [-reach, reach]];
        Some(corners.map(|[dx, dy]| {
            let (fx, fy) = (lx + dx, ly + dy);
            [fx + stretch * (x - fx), fy + stretch * (y - fy)]
        }))
    }
}

/// cos θ / d² of a lamp at a point of a face.
fn falloff(lamp: [f64; 3], point: [f64; 3], normal: [f64; 3]) -> f64 {
    let way = [0, 1, 2].map(|axis| lamp[axis] - point[axis]);
    let square = way[0] * way[0] + way[1] * way[1] + way[2] * way[2];
    let along = way[0] * normal[0] + way[1] * normal[1] + way[2] * normal[2];
    along / (square * square.sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::world::Shape;

    const UP: [f64; 3] = [0.0, 0.0, 1.0];

    #[test]
    fn the_middle_of_the_floor_has_light_one_and_a_shadow_what_the_room_gives() {
        let light = Light { lamp: [1.0, 1.0, 2.0], radius: 0.0, share: 0.7 };
        let lamp = Lamp::new(light, [2.0, 2.0]);
        let nothing = || std::iter::empty();
        assert!((lamp.on([1.0, 1.0, 0.0], UP, nothing()).1 - 1.0).abs() < 1e-12);
        let wall = Body::new(&Shape::Rect([0.9, 0.9, 1.1, 1.1]), 0.5);
        let (visible, light) = lamp.on([1.0, 1.0, 0.0], UP, std::iter::once(&wall));
        assert!(visible == 0.0 && (light - 0.3).abs() < 1e-12);
        // 2 m aside of a lamp 2 m up: twice the square of the distance, and cos 45°.
        let (_, aside) = lamp.on([3.0, 1.0, 0.0], UP, nothing());
        assert!((aside - (0.3 + 0.7 * 0.5 * 0.5f64.sqrt())).abs() < 1e-12);
    }

    #[test]
    fn a_shadow_grows_dark_over_the_width_that_the_lamp_gives() {
        // The far edge of a wall 1 m high at x = 1, a lamp of radius 0.1 m 2 m up at x = 0: half-shadow
        // from x = 1.9 to 2.1.
        let wall = Body::new(&Shape::Rect([0.8, -5.0, 1.0, 5.0]), 1.0);
        let lamp = Lamp::new(Light { lamp: [0.0, 0.0, 2.0], radius: 0.1, share: 1.0 }, [2.0, 2.0]);
        let visible = |x: f64| lamp.on([x, 0.0, 0.0], UP, std::iter::once(&wall)).0;
        assert_eq!((visible(1.89), visible(2.11)), (0.0, 1.0));
        assert!((visible(2.0) - 0.5).abs() < 0.1, "{}", visible(2.0));
        assert!(visible(1.95) < visible(2.0) && visible(2.0) < visible(2.05));
        let reach = lamp.shadow_of([1.0, 0.0, 1.0]).unwrap();
        assert!(reach.iter().any(|[x, _]| (x - 2.1).abs() < 1e-12));
    }
}
