//! An arena drawn as a camera above it would see it: any floor, boxes, shadows, light, noise, and a camera
//! that may have moved a little.

use wmr::geometry::{Arena, Point, Rect};
use wmr::vision::{Photo, srgb_code};

pub(crate) const ARENA: Arena = Arena { width: 1.4, height: 1.0 };
pub(crate) const WIDTH: usize = 480;
pub(crate) const HEIGHT: usize = 360;
/// Pixels a metre.
const SCALE: f64 = 300.0;
/// Half the size of the tape along the border, metres.
const TAPE: f64 = 0.03;
/// Places along each side of the square that a pixel sees, and its side, pixels: lenses blur.
const PLACES: usize = 5;
const BLUR: f64 = 2.0;

#[derive(Clone, Copy, Debug)]
pub(crate) enum Floor {
    Tiles,
    Wood,
    Plain,
}

/// What the camera sees and how.
#[derive(Clone, Debug)]
pub(crate) struct Drawing<'a> {
    pub(crate) floor: Floor,
    /// Boxes with their linear light.
    pub(crate) boxes: &'a [(Rect, [f32; 3])],
    /// Floor that gets this share of the light.
    pub(crate) shadows: &'a [(Rect, f32)],
    /// Of red, green and blue.
    pub(crate) gain: [f32; 3],
    /// How much brighter the right side is than the left one.
    pub(crate) slope: f32,
    /// Of the camera: pixels to the right and down, and radians.
    pub(crate) shift: [f64; 2],
    pub(crate) turn: f64,
    pub(crate) seed: u64,
}

impl Drawing<'_> {
    pub(crate) fn empty(floor: Floor, seed: u64) -> Self {
        let (boxes, shadows): (&[_], &[_]) = (&[], &[]);
        let (gain, slope) = ([1.0; 3], 0.0);
        Drawing { floor, boxes, shadows, gain, slope, shift: [0.0; 2], turn: 0.0, seed }
    }

    pub(crate) fn photo(&self) -> Photo {
        let mut noise = fastrand::Rng::with_seed(self.seed);
        let pixels = (0..WIDTH * HEIGHT).map(|i| {
            let mut sum = [0f32; 3];
            for place in 0..PLACES * PLACES {
                let within = |index: usize| BLUR * ((index as f64 + 0.5) / PLACES as f64 - 0.5);
                let x = (i % WIDTH) as f64 + within(place % PLACES);
                let y = (i / WIDTH) as f64 + within(place / PLACES);
                let light = self.light(self.floor_point([x, y]));
                sum.iter_mut().zip(light).for_each(|(sum, light)| *sum += light);
            }
            let across = 1.0 + self.slope * ((i % WIDTH) as f32 / WIDTH as f32 - 0.5);
            std::array::from_fn(|part| {
                let light = self.gain[part] * across * sum[part] / (PLACES * PLACES) as f32;
                let code = i16::from(srgb_code(light)) + noise.i16(-1..=1) + noise.i16(-1..=1);
                code.clamp(0, 255) as u8
            })
        });
        Photo::from_rgb(WIDTH, HEIGHT, pixels.collect()).unwrap()
    }

    /// The floor point that the moved camera sees at a pixel.
    fn floor_point(&self, [x, y]: [f64; 2]) -> Point {
        let (cx, cy) = (WIDTH as f64 / 2.0 - 0.5, HEIGHT as f64 / 2.0 - 0.5);
        let (x, y) = (x - cx - self.shift[0], y - cy - self.shift[1]);
        let (sin, cos) = self.turn.sin_cos();
        let (x, y) = (cos * x + sin * y, cos * y - sin * x);
        Point::new(ARENA.width / 2.0 + x / SCALE, ARENA.height / 2.0 - y / SCALE)
    }

    fn light(&self, point: Point) -> [f32; 3] {
        if let Some((_, light)) = self.boxes.iter().find(|(rect, _)| rect.contains(point)) {
            return *light;
        }
        let out = (-point.x).max(-point.y).max(point.x - ARENA.width).max(point.y - ARENA.height);
        if out > TAPE {
            return [0.22, 0.2, 0.18];
        }
        if out > 0.0 {
            return [0.02; 3];
        }
        let shade = self.shadows.iter().find(|(rect, _)| rect.contains(point));
        self.floor.light(point).map(|light| light * shade.map_or(1.0, |(_, share)| *share))
    }
}

impl Floor {
    fn light(self, point: Point) -> [f32; 3] {
        match self {
            // Black and white tiles of 16 cm.
            Self::Tiles => {
                let odd = ((point.x / 0.16).floor() + (point.y / 0.16).floor()) as i64 % 2 != 0;
                if odd { [0.07, 0.07, 0.08] } else { [0.42, 0.41, 0.38] }
            }
            // Boards of 9 cm with grain, each a little lighter or darker.
            Self::Wood => {
                let board = (point.y / 0.09).floor();
                let tone = 0.85 + 0.3 * (board * 0.618).fract() as f32;
                let seam = if (point.y / 0.09).fract() < 0.04 { 0.45 } else { 1.0 };
                let grain = 1.0
                    + 0.12 * ((point.y * 700.0 + 5.0 * (point.x * 9.0 + board).sin()).sin()) as f32;
                [0.36, 0.21, 0.1].map(|light| light * tone * seam * grain)
            }
            Self::Plain => [0.45; 3],
        }
    }
}
