//! Faults of the picture itself, found before anything is looked for in it: too dark, overexposed, blurred.
//!
//! Brightness is the strongest channel's sRGB code. Blur shows in how the strongest steps are spread: two of
//! the eight pixels across a sharp edge have nearly all of its height, those across a ramp a quarter.
//!
//! Measured on a picture reduced to about 700 pixels, as the arena's border is searched for in one. Pictures
//! without contrast are refused where the border is searched for; a picture may show too little of it here too.

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
/// The strongest steps have at least this share of their height within 2 of 8 pixels, in the median; a ramp has
/// 0.25, an edge blurred by 3 pixels (one standard deviation) about this.
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
    let steps = steps(photo);
    let mut counts = [0usize; 256];
    steps.iter().for_each(|step| counts[usize::from(step.far)] += 1);
    let strong = level(&counts, STRONGEST).max(LEAST_STEP);
    let strongest = steps.iter().filter(|step| usize::from(step.far) >= strong);
    let mut shares: Vec<f64> =
        strongest.map(|step| f64::from(step.near) / f64::from(step.far)).collect();
    if shares.is_empty() {
        return Ok(());
    }
    shares.sort_unstable_by(f64::total_cmp);
    let measured = shares[shares.len() / 2];
    if measured < LEAST_SHARPNESS {
        return Err(VisionError::Blurred { measured, needed: LEAST_SHARPNESS });
    }
    Ok(())
}

/// The change of brightness across [`FAR`] pixels, and the greatest across [`NEAR`] of these, codes.
struct Step {
    far: u8,
    near: u8,
}

/// The steps along a choice of rows and columns.
fn steps(photo: &Photo) -> Vec<Step> {
    let (width, height) = (photo.width(), photo.height());
    let code = |pixel: [u8; 3]| pixel[0].max(pixel[1]).max(pixel[2]);
    let apart = (height / ROWS).max(1);
    let rows = photo.pixels().chunks_exact(width).step_by(apart);
    let rows = rows.map(|row| row.iter().map(|&pixel| code(pixel)).collect::<Vec<_>>());
    let columns = (0..width)
        .step_by(apart)
        .map(|x| (0..height).map(|y| code(photo.pixels()[y * width + x])).collect::<Vec<_>>());
    rows.chain(columns)
        .flat_map(|codes| codes.windows(FAR + 1).map(step_of).collect::<Vec<_>>())
        .collect()
}

fn step_of(window: &[u8]) -> Step {
    let far = window[0].abs_diff(window[FAR]);
    let near = window.iter().skip(NEAR).zip(window).map(|(a, b)| a.abs_diff(*b)).max();
    Step { far, near: near.unwrap_or(0) }
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
    fn little_contrast_is_no_blur() {
        // A sharp sheet, 36 codes from its ground, whose edges are few, with grain.
        let pixel = |i: usize| {
            let (x, y) = (i % 300, i / 300);
            let sheet = (40..260).contains(&x) && (30..190).contains(&y);
            let grain = (i * 7919 % 101) as f64 / 101.0 * 6.0;
            [(if sheet { 184.0 } else { 220.0 } + grain) as u8; 3]
        };
        let photo = Photo::from_rgb(300, 220, (0..300 * 220).map(pixel).collect()).unwrap();
        assert_eq!(check_picture(&photo), Ok(()));
    }

    #[test]
    fn a_drawing_may_have_a_white_floor() {
        let pixels = (0..100 * 100).map(|i| if i % 100 < 20 { [0; 3] } else { [255; 3] });
        let drawing = Photo::from_rgb(100, 100, pixels.collect()).unwrap();
        assert_eq!(check_picture(&drawing), Ok(()));
    }
}
