//! Draws a stage as the camera sees it: one ray a pixel, and 4 × 4 where something ends inside it.
//!
//! What stands still is drawn once; of each picture only the regions that moving bodies and their shadows
//! reach are drawn again. Metres in the arena frame, pixels in the picture.

use super::lens::{Lens, Ray};
use super::light::{Lamp, Light};
use super::region::{Region, regions_of};
use super::sensor::{Chip, Sensor, linear};
use super::solid::{Body, Colour, Mark, Solid};
use crate::base::TruePose;

/// Rays along each side of a pixel in which something ends.
const FINE: usize = 4;
/// Neighbours whose shares of the lamp differ by more are the edge of a shadow.
const SHADOW_EDGE: f64 = 0.3;

/// The floor and what is around it.
#[derive(Clone, Debug, PartialEq)]
pub struct Ground {
    /// Inside the arena.
    pub floor: Colour,
    /// Of the tape around it, whose inner edge is the arena's border.
    pub tape: Colour,
    /// The tape's width, m.
    pub tape_width: f64,
    /// Beyond the tape.
    pub surround: Colour,
}

impl Default for Ground {
    /// A light floor with dark tape around it.
    fn default() -> Self {
        Self {
            floor: [226, 224, 216],
            tape: [30, 30, 34],
            tape_width: 0.04,
            surround: [138, 132, 122],
        }
    }
}

/// What is seen at a moment.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Stage {
    /// Width and height of the floor, m.
    pub size: [f64; 2],
    /// Bodies that seldom change.
    pub still: Vec<Solid>,
    /// Bodies that are elsewhere in the next picture.
    pub moving: Vec<Solid>,
}

impl Stage {
    /// Where the robot is, the body with a mark.
    pub fn robot(&self) -> Option<TruePose> {
        self.moving.iter().find_map(|body| body.mark.as_ref().map(|(pose, _)| *pose))
    }

    /// What moves beside the robot.
    pub fn movers(&self) -> impl Iterator<Item = &Solid> {
        self.moving.iter().filter(|body| body.mark.is_none())
    }
}

/// A camera over a floor, ready to draw.
#[derive(Clone, Debug)]
pub(super) struct Renderer {
    lens: Lens,
    light: Light,
    ground: Ground,
    chip: Chip,
    background: Option<Background>,
}

/// The picture of all that stands still, as codes.
#[derive(Clone, Debug)]
struct Background {
    size: [f64; 2],
    still: Vec<Solid>,
    codes: Vec<i16>,
}

/// All that rays may meet.
struct Set<'a> {
    lens: &'a Lens,
    lamp: Lamp,
    ground: [[f32; 3]; 3],
    tape_width: f64,
    size: [f64; 2],
    bodies: Vec<Prop<'a>>,
}

struct Prop<'a> {
    body: Body,
    colour: [f32; 3],
    mark: Option<(TruePose, f64, &'a Mark)>,
}

/// What one ray shows: which surface, how much of the lamp reaches it, and its light.
#[derive(Clone, Copy, Debug, Default)]
struct Sample {
    surface: u32,
    visible: f64,
    light: [f32; 3],
}

impl Sample {
    fn is_apart_from(&self, other: &Self) -> bool {
        self.surface != other.surface || (self.visible - other.visible).abs() > SHADOW_EDGE
    }
}

impl Renderer {
    /// A camera that sees `ground` through `lens` in this light.
    pub(super) fn new(lens: Lens, light: Light, ground: Ground, sensor: Sensor) -> Self {
        Self { lens, light, ground, chip: Chip::new(sensor), background: None }
    }

    /// Moves the camera, or gives it another lens.
    pub(super) fn set_lens(&mut self, lens: Lens) {
        if lens != self.lens {
            self.lens = lens;
            self.background = None;
        }
    }

    /// The picture of `stage`, row by row, red, green and blue of each pixel; `number` tells its noise from
    /// that of other pictures.
    pub(super) fn picture(&mut self, stage: &Stage, number: u64) -> Vec<u8> {
        let [width, _] = self.lens.image_size;
        self.draw_background(stage);
        let still = self.background.as_ref().map(|background| background.codes.as_slice());
        let mut codes = still.unwrap_or_default().to_vec();
        let set = self.set(stage, stage.still.iter().chain(&stage.moving));
        for region in self.moving_regions(stage, &set) {
            self.draw(&set, region, &mut codes);
        }
        self.chip.picture(&codes, width, number)
    }

    /// The picture of a sensor that no light reaches.
    pub(super) fn dark_picture(&self, number: u64) -> Vec<u8> {
        let [width, height] = self.lens.image_size;
        self.chip.picture(&vec![0; 3 * width * height], width, number)
    }

    fn set<'a>(&'a self, stage: &'a Stage, solids: impl Iterator<Item = &'a Solid>) -> Set<'a> {
        let Ground { floor, tape, surround, tape_width } = &self.ground;
        Set {
            lens: &self.lens,
            lamp: Lamp::new(self.light.clone(), stage.size),
            ground: [floor, tape, surround].map(|colour| colour.map(linear)),
            tape_width: *tape_width,
            size: stage.size,
            bodies: solids.map(Prop::new).collect(),
        }
    }

    fn draw_background(&mut self, stage: &Stage) {
        let is_same = |old: &Background| old.size == stage.size && old.still == stage.still;
        if self.background.as_ref().is_some_and(is_same) {
            return;
        }
        let [width, height] = self.lens.image_size;
        let mut codes = vec![0; 3 * width * height];
        let set = self.set(stage, stage.still.iter());
        self.draw(&set, Region::whole(self.lens.image_size), &mut codes);
        self.background = Some(Background { size: stage.size, still: stage.still.clone(), codes });
    }

    /// Where moving bodies and their shadows may be, none of them overlapping another.
    fn moving_regions(&self, stage: &Stage, set: &Set<'_>) -> Vec<Region> {
        let bodies = set.bodies.iter().skip(stage.still.len()).map(|prop| &prop.body);
        regions_of(bodies, set.lens, &set.lamp, self.chip.reach() + 1)
    }

    /// Draws a region of the picture into `codes`; blur reaches into it from around.
    fn draw(&self, set: &Set<'_>, region: Region, codes: &mut [i16]) {
        let [width, _] = self.lens.image_size;
        let around = region.grown(self.chip.reach(), self.lens.image_size);
        let mut light = set.light(&around);
        self.chip.blur(&mut light, around.width());
        for row in region.rows.clone() {
            let from = (row - around.rows.start) * around.width() + region.columns.start
                - around.columns.start;
            let lights = light[from..from + region.width()].iter().flatten();
            let to = 3 * (row * width + region.columns.start);
            for (code, light) in codes[to..to + 3 * region.width()].iter_mut().zip(lights) {
                *code = self.chip.code(*light);
            }
        }
    }
}

impl<'a> Prop<'a> {
    fn new(solid: &'a Solid) -> Self {
        let body = Body::new(&solid.shape, solid.height);
        let mark = solid.mark.as_ref().map(|(pose, mark)| (*pose, body.radius(), mark));
        Self { body, colour: solid.colour.map(linear), mark }
    }

    /// The colour of its top, and which part of it that is.
    fn top(&self, point: [f64; 3]) -> (u32, [f32; 3]) {
        let [x, y, _] = point;
        let mark = self.mark.and_then(|(pose, radius, mark)| mark.colour(pose, radius, [x, y]));
        match mark {
            None => (0, self.colour),
            Some(colour) => (1 + u32::from(colour[0]), colour.map(linear)),
        }
    }
}

impl Set<'_> {
    /// The light that reaches the pixels of a region.
    fn light(&self, region: &Region) -> Vec<[f32; 3]> {
        let seen = region.grown(1, self.lens.image_size);
        let width = seen.width();
        let at =
            |index: usize| [seen.columns.start + index % width, seen.rows.start + index / width];
        let samples: Vec<Sample> = (0..width * seen.rows.len())
            .map(|index| self.sample(at(index).map(|place| place as f64)))
            .collect();
        let mut lights = Vec::with_capacity(region.width() * region.rows.len());
        for row in region.rows.clone() {
            for column in region.columns.clone() {
                let index = (row - seen.rows.start) * width + column - seen.columns.start;
                let sample = samples[index];
                let (left, right) = (column > seen.columns.start, column + 1 < seen.columns.end);
                let (up, down) = (row > seen.rows.start, row + 1 < seen.rows.end);
                let ends =
                    [(left, -1), (right, 1), (up, -(width as isize)), (down, width as isize)]
                        .into_iter()
                        .filter(|(is_there, _)| *is_there)
                        .filter_map(|(_, step)| samples.get(index.checked_add_signed(step)?))
                        .any(|neighbour| neighbour.is_apart_from(&sample));
                lights.push(if ends { self.fine(column, row) } else { sample.light });
            }
        }
        lights
    }

    /// The mean light of a pixel.
    fn fine(&self, column: usize, row: usize) -> [f32; 3] {
        let mut sum = [0.0; 3];
        let within = |part: usize| (part as f64 + 0.5) / FINE as f64 - 0.5;
        for part in 0..FINE * FINE {
            let (dx, dy) = (within(part % FINE), within(part / FINE));
            let light = self.sample([column as f64 + dx, row as f64 + dy]).light;
            sum.iter_mut().zip(light).for_each(|(sum, light)| *sum += light);
        }
        sum.map(|sum| sum / (FINE * FINE) as f32)
    }

    /// What is seen at a place of the picture.
    fn sample(&self, pixel: [f64; 2]) -> Sample {
        let [floor, tape, surround] = self.ground;
        let Some(ray) = self.lens.ray(pixel) else {
            return Sample { surface: 2, visible: 1.0, light: surround };
        };
        if let Some((number, prop, hit)) = self.first_hit(&ray) {
            let (part, colour) = if hit.face == 0 { prop.top(hit.point) } else { (0, prop.colour) };
            // Numbers of surfaces: at most 256 parts of a top, then the sides of its footprint.
            let face = if hit.face == 0 { part } else { 256 + hit.face };
            return self.lit(3 + number * 4096 + face, colour, hit.point, hit.normal);
        }
        let [x, y] = ray.at(0.0);
        let [width, depth] = self.size;
        let outside = (-x).max(x - width).max(-y).max(y - depth);
        let (surface, colour) = match outside {
            outside if outside <= 0.0 => (0, floor),
            outside if outside <= self.tape_width => (1, tape),
            _ => (2, surround),
        };
        self.lit(surface, colour, [x, y, 0.0], [0.0, 0.0, 1.0])
    }

    fn first_hit(&self, ray: &Ray) -> Option<(u32, &Prop<'_>, super::solid::Hit)> {
        let hits = (0..)
            .zip(&self.bodies)
            .filter_map(|(number, prop)| prop.body.hit(ray).map(|hit| (number, prop, hit)));
        hits.max_by(|a, b| a.2.point[2].total_cmp(&b.2.point[2]))
    }

    fn lit(&self, surface: u32, colour: [f32; 3], point: [f64; 3], normal: [f64; 3]) -> Sample {
        let (visible, light) =
            self.lamp.on(point, normal, self.bodies.iter().map(|prop| &prop.body));
        Sample { surface, visible, light: colour.map(|part| part * light as f32) }
    }
}
