//! Pictures of tags, drawn apart from the detector: tilted squares with 4 × 4 samples a pixel, blurred, noisy.

#![allow(clippy::unwrap_used, reason = "helpers of tests fail as tests do")]

use wmr::vision::{Photo, TagDictionary, homography};

/// A tag where it was drawn: corners clockwise from its own top left, pixels.
#[derive(Clone, Debug)]
pub(crate) struct DrawnTag {
    pub(crate) dictionary: TagDictionary,
    pub(crate) id: usize,
    pub(crate) corners: [[f64; 2]; 4],
}

impl DrawnTag {
    /// A square of `side` pixels, seen from straight above, turned by `turn` and tilted by `tilt` about the
    /// picture's axis in the direction `axis`, around `centre`.
    pub(crate) fn tilted(
        (dictionary, id): (TagDictionary, usize),
        centre: [f64; 2],
        side: f64,
        [turn, tilt, axis]: [f64; 3],
    ) -> Self {
        const FOCAL: f64 = 1200.0;
        let corners =
            [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|[x, y]: [f64; 2]| {
                let (x, y) = (x * side / 2.0, y * side / 2.0);
                let (x, y) = (x * turn.cos() - y * turn.sin(), x * turn.sin() + y * turn.cos());
                let along = x * axis.cos() + y * axis.sin();
                let across = y * axis.cos() - x * axis.sin();
                let scale = FOCAL / (FOCAL + across * tilt.sin());
                let (along, across) = (along * scale, across * tilt.cos() * scale);
                [
                    centre[0] + along * axis.cos() - across * axis.sin(),
                    centre[1] + along * axis.sin() + across * axis.cos(),
                ]
            });
        Self { dictionary, id, corners }
    }

    /// The shortest projected side, pixels.
    pub(crate) fn shortest_side(&self) -> f64 {
        let side = |i: usize| {
            let [a, b] = [self.corners[i], self.corners[(i + 1) % 4]];
            (b[0] - a[0]).hypot(b[1] - a[1])
        };
        (0..4).map(side).fold(f64::MAX, f64::min)
    }
}

/// A picture's brightness, row by row.
pub(crate) struct Canvas {
    pub(crate) width: usize,
    pub(crate) height: usize,
    pub(crate) codes: Vec<f32>,
}

impl Canvas {
    /// A floor with smooth stains and a few hard-edged patches.
    pub(crate) fn floor(width: usize, height: usize, random: &mut fastrand::Rng) -> Self {
        let waves: Vec<[f64; 4]> = (0..8)
            .map(|_| {
                let mut wave = || random.f64() - 0.5;
                [wave() * 0.3, wave() * 0.3, wave() * 6.3, wave() * 12.0]
            })
            .collect();
        let code = |i: usize| {
            let (x, y) = ((i % width) as f64, (i / width) as f64);
            let stain: f64 = waves.iter().map(|w| w[3] * (w[0] * x + w[1] * y + w[2]).sin()).sum();
            170.0 + stain as f32
        };
        let mut canvas = Self { width, height, codes: (0..width * height).map(code).collect() };
        for _ in 0..30 {
            let corner = [random.f64() * width as f64, random.f64() * height as f64];
            let (side, code) = (5.0 + 60.0 * random.f64(), 40.0 + 180.0 * random.f32());
            let at = [[0.0, 0.0], [1.0, 0.1], [0.8, 0.9], [-0.1, 0.7]]
                .map(|[x, y]| [corner[0] + side * x, corner[1] + side * y]);
            canvas.fill(at, |_| Some(code));
        }
        canvas
    }

    /// Fills a quad with what `shade` says of places in the unit square, which reaches to `corners`.
    pub(crate) fn fill(&mut self, corners: [[f64; 2]; 4], shade: impl Fn([f64; 2]) -> Option<f32>) {
        let unit = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let map = homography(corners, unit).unwrap();
        let bound = |axis: usize, most: usize| {
            let values = corners.map(|corner| corner[axis]);
            let low = values.iter().copied().fold(f64::MAX, f64::min) - 1.0;
            let high = values.iter().copied().fold(0.0, f64::max) + 2.0;
            low.max(0.0) as usize..(high.max(0.0) as usize).min(most)
        };
        for y in bound(1, self.height) {
            for x in bound(0, self.width) {
                let old = self.codes[y * self.width + x];
                let sample = |index: usize| {
                    let offset = |part: usize| (part as f64 + 0.5) / 4.0 - 0.5;
                    let place = [x as f64 + offset(index % 4), y as f64 + offset(index / 4)];
                    let image = map * nalgebra::Vector3::new(place[0], place[1], 1.0);
                    let [u, v] = [image.x / image.z, image.y / image.z];
                    let inside = (0.0..1.0).contains(&u) && (0.0..1.0).contains(&v);
                    inside.then(|| shade([u, v])).flatten().unwrap_or(old)
                };
                self.codes[y * self.width + x] = (0..16).map(sample).sum::<f32>() / 16.0;
            }
        }
    }

    /// Draws a tag with a white rim of one cell.
    pub(crate) fn tag(&mut self, tag: &DrawnTag) {
        let cells = tag.dictionary.cells(tag.id).unwrap();
        let ring = tag.dictionary.side() + 2;
        let wide = 1.0 / ring as f64;
        let unit = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let map = homography(unit, tag.corners).unwrap();
        let rim =
            [[-wide, -wide], [1.0 + wide, -wide], [1.0 + wide, 1.0 + wide], [-wide, 1.0 + wide]];
        let card = rim.map(|[x, y]| {
            let image = map * nalgebra::Vector3::new(x, y, 1.0);
            [image.x / image.z, image.y / image.z]
        });
        let count = ring + 2;
        self.fill(card, |[u, v]| {
            let (column, row) = ((u * count as f64) as usize, (v * count as f64) as usize);
            let inside = (1..=ring).contains(&column) && (1..=ring).contains(&row);
            let white = !inside || cells[(row - 1) * ring + column - 1];
            Some(if white { 235.0 } else { 25.0 })
        });
    }

    /// Smears along the columns as a motion of `length` pixels does during the exposure.
    pub(crate) fn smear(&mut self, length: usize) {
        for row in self.codes.chunks_exact_mut(self.width) {
            let old = row.to_vec();
            for (x, code) in row.iter_mut().enumerate() {
                let at = |k: usize| old[(x + k).saturating_sub(length / 2).min(old.len() - 1)];
                *code = (0..length).map(at).sum::<f32>() / length as f32;
            }
        }
    }

    /// The photo, blurred by a Gaussian and with noise, both standard deviations.
    pub(crate) fn photo(&self, blur: f32, noise: f64, random: &mut fastrand::Rng) -> Photo {
        const REACH: usize = 4;
        let weight = |k: usize| (-0.5 * ((k as f32 - REACH as f32) / blur).powi(2)).exp();
        let total: f32 = (0..=2 * REACH).map(weight).sum();
        let weights: Vec<f32> = (0..=2 * REACH).map(|k| weight(k) / total).collect();
        let at = |codes: &[f32], x: usize, y: usize| {
            let inside = |value: usize, most: usize| value.saturating_sub(REACH).min(most - 1);
            codes[inside(y, self.height) * self.width + inside(x, self.width)]
        };
        let mixed = |codes: &[f32], (right, down): (usize, usize)| -> Vec<f32> {
            let pixel = |i: usize| {
                let (x, y) = (i % self.width + REACH, i / self.width + REACH);
                let parts = weights.iter().enumerate().map(|(k, weight)| {
                    let x = if right == 1 { x + k - REACH } else { x };
                    let y = if down == 1 { y + k - REACH } else { y };
                    weight * at(codes, x, y)
                });
                parts.sum()
            };
            (0..codes.len()).map(pixel).collect()
        };
        let blurred = mixed(&mixed(&self.codes, (1, 0)), (0, 1));
        let pixels = blurred.into_iter().map(|code| {
            // Box and Muller: two even numbers make a normal one.
            let radius = (-2.0 * (1.0 - random.f64()).ln()).sqrt();
            let normal = radius * (std::f64::consts::TAU * random.f64()).cos();
            [(f64::from(code) + noise * normal).round().clamp(0.0, 255.0) as u8; 3]
        });
        Photo::from_rgb(self.width, self.height, pixels.collect()).unwrap()
    }
}
