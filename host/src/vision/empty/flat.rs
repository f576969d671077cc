//! A photo as it would be over an evenly grey floor.
//!
//! Where nothing has changed and in shadow, a pixel's light is divided by that of the empty picture; on what
//! was put there, by the mean colour of the floor, since the pattern beneath it is not seen. Symbols, all
//! logarithms of linear light for each channel: p photo, e empty picture, q illumination between them, s the
//! floor without its pattern, w how surely a pixel has changed (0 to 1), g the grey of the even floor.
//!
//! `ln result = g + c + w (e − s)` with the change `c = p − e − q`
//!
//! In dark places of the empty picture a code more or less is much of the light, and beside its edges a tenth
//! of a pixel is: changes are brought nearer to none by as much. What remains is no change unless its
//! neighbours changed too, and small regions of it are swept away.

use super::illumination::{DARK_LIGHT, Illumination};
use crate::geometry::{Arena, Point};
use crate::vision::appearance::turned;
use crate::vision::camera::PlanMap;
use crate::vision::image::{Photo, Raster, runs, srgb_code};

/// The even floor is as light as the true one, but within these bounds: shadow on a darker one would be noise,
/// and what is brighter than a lighter one would be burnt out.
const GREY: [f32; 2] = [0.35, 0.85];
/// Logarithms of light from here on in steps are brought to codes by a table.
const DARKEST: f32 = -6.0;
const STEPS: f32 = 256.0;
/// Codes that noise and compression may make of a light, and the change that they make of most.
const NOISE_CODES: usize = 3;
const USUAL_NOISE: f32 = 0.03;
/// Light falls a little beside where it did, by blur, compression and the lens: pixels.
const STRAY: f32 = 0.15;
/// Shadow leaves at least this share of the light, a logarithm.
const DEEPEST: f32 = -1.4;
/// Light that leaves so much chroma as it was may be shadow; with twice as much it is none. Deeper shadow is
/// tinted more, by this share of its depth.
const NEUTRAL: f32 = 0.05;
const TINT: f32 = 0.12;
/// What is brighter than the empty floor by so much has changed; by half as much it may be noise.
const BRIGHTER: f32 = 0.2;

/// A channel whose light changed by less is that of the floor.
const LEAST_CHANGE: f32 = 0.1;
/// What is smaller than this is no thing: square metres, and pixels.
const LEAST_AREA: f64 = 1e-4;
const LEAST_PIXELS: f64 = 6.0;

/// The changes along a row of pixels.
type Line = Vec<[f32; 3]>;

/// The photo over an even floor; `None` if nothing of the two pictures can be compared.
pub(crate) fn over_even_floor(
    photo: &Photo,
    empty: &Photo,
    map: &PlanMap,
    arena: Arena,
) -> Option<Photo> {
    let light = Illumination::between(photo, empty, map, arena)?;
    let difference = Comparison::of(photo, empty, light);
    let (width, height) = (photo.width(), photo.height());
    let codes = codes(difference.light.brightness().clamp(GREY[0], GREY[1]));
    let mut lines: [Line; 3] = [0, 0, 1].map(|y| difference.line(y));
    let mut patterns = vec![[0.0; 3]; width];
    let mut pixels = Vec::with_capacity(width * height);
    let mut differs = Vec::with_capacity(width * height);
    for y in 0..height {
        difference.patterns(y, &mut patterns);
        for x in 0..width {
            let own = lines[1][x];
            differs.push(own.into_iter().any(|part| part.abs() > LEAST_CHANGE));
            let w = match changed(own) {
                w if w > 0.0 => w.min(changed(around(&lines, x))),
                w => w,
            };
            pixels.push(std::array::from_fn(|part| {
                let log = own[part] + w * patterns[x][part];
                let index = ((log - DARKEST) * STEPS).max(0.0) as usize;
                codes[index.min(codes.len() - 1)]
            }));
        }
        lines.rotate_left(1);
        lines[2] = difference.line((y + 2).min(height - 1));
    }
    let middle = Point::new(arena.width / 2.0, arena.height / 2.0);
    let least = (LEAST_AREA * map.scale_at(middle).powi(2)).max(LEAST_PIXELS);
    let even = codes[((-DARKEST * STEPS) as usize).min(codes.len() - 1)];
    sweep(&mut pixels, &Raster::from_cells(width, differs), least, [even; 3]);
    Some(photo.with_pixels(pixels))
}

/// Makes regions floor that differ from it and are smaller than `least` pixels: nothing to drive into.
fn sweep(pixels: &mut [[u8; 3]], differs: &Raster<bool>, least: f64, floor: [u8; 3]) {
    let (runs, count) = runs(differs, true);
    let mut areas = vec![0; count + 1];
    runs.iter().for_each(|run| areas[run.region as usize] += run.end - run.start);
    for run in runs.iter().filter(|run| (areas[run.region as usize] as f64) < least) {
        let row = run.row * differs.width();
        pixels[row + run.start..row + run.end].fill(floor);
    }
}

/// Two pictures and the light between them.
struct Comparison<'a> {
    photo: &'a Photo,
    empty: &'a Photo,
    light: Illumination,
    /// The logarithm of every code's light, and how much of it noise may be.
    logs: [f32; 256],
    noise: [f32; 256],
}

impl<'a> Comparison<'a> {
    fn of(photo: &'a Photo, empty: &'a Photo, light: Illumination) -> Self {
        let logs = photo.code_lights().map(|value| (value + DARK_LIGHT).ln());
        let noise = std::array::from_fn(|code: usize| {
            let above = logs[(code + NOISE_CODES).min(255)];
            (above - logs[code] - USUAL_NOISE).max(0.0)
        });
        Self { photo, empty, light, logs, noise }
    }

    /// The changes along row `y`.
    fn line(&self, y: usize) -> Line {
        let width = self.photo.width();
        let mut line = vec![[0.0; 3]; width];
        self.light.ratio.row(y, &mut line);
        let row =
            |photo: &'a Photo, y: usize| photo.pixels().chunks_exact(width).nth(y).unwrap_or(&[]);
        let (seen, before) = (row(self.photo, y), row(self.empty, y));
        let last = self.photo.height() - 1;
        let beside = [row(self.empty, y.saturating_sub(1)), row(self.empty, (y + 1).min(last))];
        for (x, change) in line.iter_mut().enumerate() {
            let (left, right) = (before[x.saturating_sub(1)], before[(x + 1).min(width - 1)]);
            *change = std::array::from_fn(|part| {
                let step =
                    |a: u8, b: u8| (self.logs[usize::from(a)] - self.logs[usize::from(b)]).abs();
                let slope =
                    step(left[part], right[part]) + step(beside[0][x][part], beside[1][x][part]);
                self.change(seen[x][part], before[x][part], change[part], STRAY * slope)
            });
        }
        line
    }

    /// The change of a channel from code `e` to code `p` at a ratio of light `q`, less what light that strays
    /// may make of it.
    fn change(&self, p: u8, e: u8, q: f32, stray: f32) -> f32 {
        let change = self.logs[usize::from(p)] - self.logs[usize::from(e)] - q;
        // Of light beyond white nobody knows how much it is.
        if p == u8::MAX && change < 0.0 || e == u8::MAX && change > 0.0 {
            return 0.0;
        }
        let noise = self.noise[usize::from(e)] + stray;
        change - change.clamp(-noise, noise)
    }

    /// How the empty picture differs along row `y` from the floor without its pattern.
    fn patterns(&self, y: usize, line: &mut [[f32; 3]]) {
        self.light.floor.row(y, line);
        let row = self.empty.pixels().chunks_exact(line.len()).nth(y).unwrap_or(&[]);
        for (pattern, codes) in line.iter_mut().zip(row) {
            *pattern =
                std::array::from_fn(|part| self.logs[usize::from(codes[part])] - pattern[part]);
        }
    }
}

/// The mean change of a pixel of the middle line and its neighbours.
fn around(lines: &[Line; 3], x: usize) -> [f32; 3] {
    let (first, last) = (x.saturating_sub(1), (x + 1).min(lines[1].len() - 1));
    let mut sum = [0f32; 3];
    for change in lines.iter().flat_map(|line| &line[first..=last]) {
        sum.iter_mut().zip(change).for_each(|(sum, value)| *sum += value);
    }
    sum.map(|sum| sum / (lines.len() * (last - first + 1)) as f32)
}

/// How surely something stands at a pixel whose light has changed so: it is neither floor nor shadow.
fn changed(change: [f32; 3]) -> f32 {
    let [b, c, d] = turned(change);
    let allowed = NEUTRAL + TINT * (-b).clamp(0.0, -DEEPEST);
    let tint = c.abs().max(d.abs()) / allowed;
    let bright = 2.0 * b / BRIGHTER;
    let dark = 1.0 + (DEEPEST - b) / NEUTRAL;
    (tint.max(bright).max(dark) - 1.0).clamp(0.0, 1.0)
}

/// The codes of logarithms of light relative to that of a floor of the light `grey`.
fn codes(grey: f32) -> Vec<u8> {
    let count = ((-grey.ln() - DARKEST) * STEPS) as usize + 1;
    (0..count).map(|index| srgb_code(grey * (DARKEST + index as f32 / STEPS).exp())).collect()
}
