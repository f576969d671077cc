//! Faults of the picture itself, found before anything is looked for in it: too dark, overexposed, blurred.
//!
//! Brightness is the strongest channel's sRGB code. Blur shows in how steps grow with distance: across
//! two pixels a sharp edge has most of its height over eight, a ramp a quarter.
//!
//! Measured on a picture reduced to about 700 pixels, as the arena's border is sought in one. Pictures
//! without contrast are refused where the border is sought; a picture may show too little of it here too.

use super::photo::Photo;
use crate::vision::error::VisionError;

/// The 99th percentile of brightness is at least this.
const LEAST_LIGHT: u8 = 25;
/// A pixel is burnt out if all channels are at least this.
const BURNT: u8 = 253;
/// At most this share is burnt out, unless nearly nothing is nearly so: drawings have a white floor.
const MOST_BURNT: f64 = 0.25;
const NEARLY_BURNT: u8 = 200;
const LEAST_NEARLY: f64 = 0.03;
/// The strongest steps across 2 pixels are at least this share of those across 8; a ramp has 0.25, the
/// softest useful picture about 0.45.
const LEAST_SHARPNESS: f64 = 0.33;
const NEAR: usize = 2;
const FAR: usize = 8;
/// Steps are counted in about so many rows.
const ROWS: usize = 160;
/// Steps of fewer codes tell nothing of sharpness.
const LEAST_STEP: usize = 8;
/// The strongest steps are those above this share of all.
const STRONGEST: f64 = 0.995;

/// Refuses a photo that is too dark, overexposed or blurred.
///
/// # Errors
/// [`VisionError::Dark`], [`VisionError::Overexposed`] or [`VisionError::Blurred`], with what was measured.
///
/// ```
/// use wmr::vision::{Photo, VisionError, check_picture};
/// let night = Photo::from_rgb(64, 64, vec![[5; 3]; 64 * 64])?;
/// assert_eq!(check_picture(&night), Err(VisionError::Dark { measured: 5, needed: 25 }));
/// # Ok::<(), VisionError>(())
/// ```
pub fn check_picture(photo: &Photo) -> Result<(), VisionError> {
    check_overview(&photo.reduced(photo.overview_factor()))
}

/// The same for a photo that is reduced already.
pub(crate) fn check_overview(small: &Photo) -> Result<(), VisionError> {
    check_light(small)?;
    check_sharpness(small)
}

fn check_light(photo: &Photo) -> Result<(), VisionError> {
    let count = photo.pixels().len().max(1) as f64;
    let mut brightest = [0usize; 256];
    let (mut burnt, mut nearly) = (0usize, 0usize);
    for &[r, g, b] in photo.pixels() {
        brightest[usize::from(r.max(g).max(b))] += 1;
        let darkest = r.min(g).min(b);
        burnt += usize::from(darkest >= BURNT);
        nearly += usize::from((NEARLY_BURNT..BURNT).contains(&darkest));
    }
    let measured = level(&brightest, 0.99) as u8;
    if measured < LEAST_LIGHT {
        return Err(VisionError::Dark { measured, needed: LEAST_LIGHT });
    }
    let share = burnt as f64 / count;
    if share > MOST_BURNT && nearly as f64 / count > LEAST_NEARLY {
        return Err(VisionError::Overexposed { measured: share, allowed: MOST_BURNT });
    }
    Ok(())
}

fn check_sharpness(photo: &Photo) -> Result<(), VisionError> {
    let far = strongest_step(photo, FAR);
    if far < LEAST_STEP {
        return Ok(());
    }
    let measured = strongest_step(photo, NEAR) as f64 / far as f64;
    if measured < LEAST_SHARPNESS {
        return Err(VisionError::Blurred { measured, needed: LEAST_SHARPNESS });
    }
    Ok(())
}

/// The height that few steps across so many pixels exceed, codes.
fn strongest_step(photo: &Photo, distance: usize) -> usize {
    let (width, height) = (photo.width(), photo.height());
    let mut counts = [0usize; 256];
    let code = |pixel: [u8; 3]| pixel[0].max(pixel[1]).max(pixel[2]);
    for y in (0..height.saturating_sub(distance)).step_by((height / ROWS).max(1)) {
        let row = &photo.pixels()[y * width..(y + 1) * width];
        let below = &photo.pixels()[(y + distance) * width..(y + distance + 1) * width];
        for ((&here, &right), &down) in row.iter().zip(row.iter().skip(distance)).zip(below) {
            let here = code(here);
            let step = here.abs_diff(code(right)).max(here.abs_diff(code(down)));
            counts[usize::from(step)] += 1;
        }
    }
    level(&counts, STRONGEST)
}

/// The value that `share` of what is counted does not exceed.
fn level(counts: &[usize; 256], share: f64) -> usize {
    let wanted = (share * counts.iter().sum::<usize>() as f64) as usize;
    let mut seen = 0;
    let found = counts.iter().position(|count| {
        seen += count;
        seen > wanted
    });
    found.unwrap_or(255)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A bright floor in a dark frame; edges are ramps of `blur` pixels, light is scaled by `gain`.
    fn drawn(blur: f64, gain: f64) -> Photo {
        let pixel = |i: usize| {
            let (x, y) = ((i % 300) as f64, (i / 300) as f64);
            let depth = (x - 40.0).min(260.0 - x).min(y - 30.0).min(190.0 - y);
            let share = (depth / blur + 0.5).clamp(0.0, 1.0);
            let grain = 4.0 * ((i * 7919 % 101) as f64 / 101.0 - 0.5);
            [(gain * (40.0 + 160.0 * share + grain)).clamp(0.0, 255.0) as u8; 3]
        };
        Photo::from_rgb(300, 220, (0..300 * 220).map(pixel).collect()).unwrap()
    }

    #[test]
    fn each_fault_is_named_and_a_good_picture_passes() {
        assert_eq!(check_picture(&drawn(1.0, 1.0)), Ok(()));
        assert_eq!(check_picture(&drawn(4.0, 1.0)), Ok(()));
        assert!(matches!(check_picture(&drawn(1.0, 0.1)), Err(VisionError::Dark { .. })));
        let bright = check_picture(&drawn(1.0, 1.27));
        assert!(
            matches!(bright, Err(VisionError::Overexposed { measured, .. }) if measured > 0.25),
            "{bright:?}"
        );
        assert!(matches!(check_picture(&drawn(24.0, 1.0)), Err(VisionError::Blurred { .. })));
    }

    #[test]
    fn a_drawing_may_have_a_white_floor() {
        let pixels = (0..100 * 100).map(|i| if i % 100 < 20 { [0; 3] } else { [255; 3] });
        let drawing = Photo::from_rgb(100, 100, pixels.collect()).unwrap();
        assert_eq!(check_picture(&drawing), Ok(()));
    }
}
