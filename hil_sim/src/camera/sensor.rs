//! From light to the numbers of a picture: blur, exposure, the curve of sRGB, and noise.
//!
//! Between light and picture stand *codes*: the curve's values in sixteenths. Noise is added to them: the
//! curve is near enough to a square root, under which the noise of photons is as large in bright places as
//! in dark ones.

use crate::noise::normal;

/// Parts of one step of an 8-bit value.
const PARTS: f32 = 16.0;
/// Steps of the table from light to codes.
const TABLE: usize = 1 << 14;
/// Noise is drawn once, and each row of a picture begins somewhere else in it.
const NOISE: usize = 1 << 16;
/// Beyond so many σ a blur is cut off.
const BLUR_REACH: f64 = 3.0;

/// How light becomes a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sensor {
    /// Light is taken times this; at 1 white paper in the middle of the floor is just white.
    pub exposure: f64,
    /// σ of the lens's and the sensor's blur, pixels.
    pub blur: f64,
    /// σ of the noise, steps of an 8-bit value.
    pub noise: f64,
    /// Which noise.
    pub seed: u64,
}

impl Default for Sensor {
    fn default() -> Self {
        Self { exposure: 1.0, blur: 0.6, noise: 1.5, seed: 1 }
    }
}

/// A sensor, ready for light.
#[derive(Clone, Debug)]
pub(super) struct Chip {
    exposure: f32,
    codes: Vec<i16>,
    /// Half of the blur's weights, the middle first.
    weights: Vec<f32>,
    noise: Vec<i16>,
    seed: u64,
}

impl Chip {
    pub(super) fn new(sensor: Sensor) -> Self {
        let code = |index: usize| {
            let light = index as f32 / (TABLE - 1) as f32;
            (PARTS * 255.0 * encoded(light)).round() as i16
        };
        let reach = (BLUR_REACH * sensor.blur).ceil().max(0.0) as usize;
        let weight = |place: usize| {
            let share = place as f64 / sensor.blur.max(1e-9);
            (-0.5 * share * share).exp() as f32
        };
        let mut weights: Vec<f32> = (0..=reach).map(weight).collect();
        let sum = 2.0 * weights.iter().sum::<f32>() - 1.0;
        weights.iter_mut().for_each(|weight| *weight /= sum);
        let mut random = fastrand::Rng::with_seed(sensor.seed);
        let mut noise = || (f64::from(PARTS) * sensor.noise * normal(&mut random)) as i16;
        Self {
            exposure: sensor.exposure as f32,
            codes: (0..TABLE).map(code).collect(),
            weights,
            noise: (0..NOISE).map(|_| noise()).collect(),
            seed: sensor.seed,
        }
    }

    /// How far light spreads, pixels.
    pub(super) fn reach(&self) -> usize {
        self.weights.len() - 1
    }

    /// Blurs rows of `width` pixels in place.
    pub(super) fn blur(&self, light: &mut [[f32; 3]], width: usize) {
        let height = light.len() / width.max(1);
        if self.reach() == 0 || height == 0 {
            return;
        }
        for (stride, count) in [(1, width), (width, height)] {
            let source = light.to_owned();
            for (index, place) in light.iter_mut().enumerate() {
                let at = index / stride % count;
                let mut sum = source[index].map(|part| part * self.weights[0]);
                for (step, weight) in self.weights.iter().enumerate().skip(1) {
                    let before = source[index - stride * step.min(at)];
                    let after = source[index + stride * step.min(count - 1 - at)];
                    for (part, sum) in sum.iter_mut().enumerate() {
                        *sum += weight * (before[part] + after[part]);
                    }
                }
                *place = sum;
            }
        }
    }

    pub(super) fn code(&self, light: f32) -> i16 {
        let index = (light * self.exposure * (TABLE - 1) as f32 + 0.5) as usize;
        self.codes[index.min(TABLE - 1)]
    }

    /// The picture of `codes`, three a pixel; `number` tells its noise from that of other pictures.
    pub(super) fn picture(&self, codes: &[i16], width: usize, number: u64) -> Vec<u8> {
        let mut random = fastrand::Rng::with_seed(self.seed ^ number.rotate_left(32));
        let mut picture = vec![0; codes.len()];
        let length = (3 * width).clamp(1, NOISE);
        for (codes, values) in codes.chunks(length).zip(picture.chunks_mut(length)) {
            let noise = &self.noise[random.usize(0..=NOISE - length)..];
            for ((code, noise), value) in codes.iter().zip(noise).zip(values) {
                *value = ((code + noise + PARTS as i16 / 2) >> 4).clamp(0, 255) as u8;
            }
        }
        picture
    }
}

/// Linear light as sRGB writes it, 0..=1.
fn encoded(light: f32) -> f32 {
    if light <= 0.003_130_8 { 12.92 * light } else { 1.055 * light.powf(1.0 / 2.4) - 0.055 }
}

/// The linear light of an sRGB value.
pub(super) fn linear(value: u8) -> f32 {
    let share = f32::from(value) / 255.0;
    if share <= 0.040_45 { share / 12.92 } else { ((share + 0.055) / 1.055).powf(2.4) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn quiet() -> Sensor {
        Sensor { noise: 0.0, blur: 0.0, ..Sensor::default() }
    }

    #[test]
    fn every_value_comes_back_from_its_light() {
        let chip = Chip::new(quiet());
        let codes: Vec<i16> = (0..=255).map(|value| chip.code(linear(value))).collect();
        assert_eq!(chip.picture(&codes, 1, 0), (0..=255).collect::<Vec<u8>>());
        let brighter = Chip::new(Sensor { exposure: 2.0, ..quiet() });
        assert_eq!(brighter.picture(&[brighter.code(linear(220))], 1, 0), [255]);
    }

    #[test]
    fn noise_is_as_strong_as_asked_and_the_same_for_the_same_number() {
        let chip = Chip::new(Sensor { noise: 2.0, ..quiet() });
        let codes = vec![128 * 16; 3 * 200 * 100];
        let picture = chip.picture(&codes, 200, 5);
        let deviation = |value: &u8| (f64::from(*value) - 128.0).powi(2);
        let variance = picture.iter().map(deviation).sum::<f64>() / picture.len() as f64;
        // Rounding adds 1/12.
        assert!((variance - 4.0 - 1.0 / 12.0).abs() < 0.2, "{variance}");
        assert_eq!(picture, chip.picture(&codes, 200, 5));
        assert_ne!(picture, chip.picture(&codes, 200, 6));
    }

    #[test]
    fn blur_spreads_a_point_by_its_sigma_and_keeps_its_light() {
        let chip = Chip::new(Sensor { blur: 1.2, ..quiet() });
        let (width, middle) = (31, 15);
        let mut light = vec![[0.0; 3]; width * width];
        light[middle * width + middle] = [1.0; 3];
        chip.blur(&mut light, width);
        let sum: f32 = light.iter().map(|light| light[0]).sum();
        let second = light
            .iter()
            .enumerate()
            .map(|(index, light)| { (index % width) as f32 - middle as f32 }.powi(2) * light[0])
            .sum::<f32>();
        assert!((sum - 1.0).abs() < 1e-5 && (second.sqrt() - 1.2).abs() < 0.03, "{second}");
        // At the picture's rim nothing is lost either.
        let mut even = vec![[0.5; 3]; 20];
        chip.blur(&mut even, 4);
        assert!(even.iter().all(|light| (light[1] - 0.5).abs() < 1e-6));
    }
}
