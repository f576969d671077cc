//! What the fuzz target `vision` runs: broken files and random pictures, seen by both methods.
//!
//! The first byte chooses between a file and a picture that the rest describes: its size, the arena,
//! what the caller says, and rectangles of any colour under noise.

use wmr::geometry::Arena;
use wmr::vision::{DetectOptions, Detection, Method, Photo, decode, detect};

/// A picture has at most so many pixels a side: larger ones are slow and find nothing else.
const MOST_SIDE: usize = 192;
/// Files that decode to more pixels are not looked at further.
const MOST_PIXELS: usize = 1 << 18;

/// Decodes or draws what `data` says and detects in it.
///
/// # Panics
/// If an answer is no answer: rectangles that are inside out or not finite, or margins that are missing.
pub fn vision(data: &[u8]) {
    let mut bytes = Bytes(data);
    let choice = bytes.next();
    if choice & 1 == 0 {
        let options = options(&mut bytes, choice);
        if let Ok(photo) = decode(bytes.0)
            && photo.width() * photo.height() <= MOST_PIXELS
        {
            look(&photo, Arena { width: 1.5, height: 1.0 }, &options);
        }
        return;
    }
    let arena = Arena { width: bytes.length(), height: bytes.length() };
    let options = options(&mut bytes, choice);
    if let Some(photo) = picture(&mut bytes) {
        look(&photo, arena, &options);
    }
}

fn look(photo: &Photo, arena: Arena, options: &DetectOptions) {
    if let Ok(seen) = detect(photo, arena, options) {
        check(&seen);
    }
}

fn check(seen: &Detection) {
    for obstacle in &seen.obstacles {
        assert_eq!(obstacle.footprint.check(), Ok(()));
        assert!(obstacle.margin.iter().all(|margin| margin.is_finite() && *margin >= 0.0));
    }
    assert!((0.0..=1.0).contains(&seen.confidence));
}

fn options(bytes: &mut Bytes, choice: u8) -> DetectOptions {
    let method = if choice & 2 == 0 { Method::Robust } else { Method::Paper };
    let corners = (choice & 4 != 0).then(|| {
        [(0, 1), (1, 1), (1, 0), (0, 0)].map(|(right, down)| {
            let near = |side: u8, value: u8| 100.0 * f64::from(side) + 0.3 * f64::from(value);
            [near(right, bytes.next()), near(down, bytes.next())]
        })
    });
    DetectOptions { method, corners, keep_steps: choice & 8 != 0, ..DetectOptions::default() }
}

/// Rectangles on a floor, one after the other, and noise.
fn picture(bytes: &mut Bytes) -> Option<Photo> {
    let side = |byte: u8| 60 + usize::from(byte) * (MOST_SIDE - 60) / 255;
    let (width, height) = (side(bytes.next()), side(bytes.next()));
    let mut pixels = vec![bytes.colour(); width * height];
    let (noise, mut random) = (bytes.next() % 64, fastrand::Rng::with_seed(bytes.next().into()));
    while !bytes.0.is_empty() {
        let mut span = |length: usize| {
            let (a, b) = (bytes.next(), bytes.next());
            usize::from(a.min(b)) * length / 255..usize::from(a.max(b)) * length / 255
        };
        let (columns, rows) = (span(width), span(height));
        let colour = bytes.colour();
        for y in rows {
            pixels[y * width..][columns.clone()].fill(colour);
        }
    }
    if noise > 0 {
        for pixel in &mut pixels {
            *pixel = pixel.map(|code| code.saturating_sub(random.u8(..noise)));
        }
    }
    Photo::from_rgb(width, height, pixels).ok()
}

/// Bytes that are read one after the other, then zeros.
struct Bytes<'a>(&'a [u8]);

impl Bytes<'_> {
    fn next(&mut self) -> u8 {
        match self.0 {
            [first, rest @ ..] => {
                self.0 = rest;
                *first
            }
            [] => 0,
        }
    }

    fn colour(&mut self) -> [u8; 3] {
        [self.next(), self.next(), self.next()]
    }

    /// A length in metres, rarely an impossible one.
    fn length(&mut self) -> f64 {
        match self.next() {
            255 => f64::NAN,
            byte => f64::from(byte) / 64.0,
        }
    }
}
