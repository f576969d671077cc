//! Times of vision, for `host/benches/vision_peer.py`: reads lines `PHOTO W H x0 y0 x1 y1 x2 y2 x3 y3`
//! (size of the arena in metres, corners 0..3 in pixels) and prints a line of JSON for each.
//!
//! `paper_ms` is the paper's method from the decoded photo and its corners to rectangles, at 300 cells a
//! metre; `detect_paper_ms` and `detect_robust_ms` are whole detections. Each is the least of several.
//! With `--sizes` it draws an arena at growing sizes instead and adds the peak of memory above the photo.

use std::alloc::{GlobalAlloc, Layout, System};
use std::hint::black_box;
use std::io::BufRead;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
use std::time::Instant;
use wmr::geometry::{Arena, Rect};
use wmr::vision::{
    DetectOptions, Method, Photo, PlanFrame, PlanMap, brightness_view, decode, detect,
    paper_obstacles, rectangles,
};

const REPEATS: usize = 7;
const SCALE: f64 = 300.0;

/// Counts what is allocated, and the most at one time.
struct Counting;

static NOW: AtomicUsize = AtomicUsize::new(0);
static PEAK: AtomicUsize = AtomicUsize::new(0);

#[expect(unsafe_code, reason = "an allocator is unsafe by its trait; this one only counts")]
// SAFETY: every call is passed on to the system's allocator unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        PEAK.fetch_max(NOW.fetch_add(layout.size(), Relaxed) + layout.size(), Relaxed);
        // SAFETY: the caller's promises are those of this trait.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        NOW.fetch_sub(layout.size(), Relaxed);
        // SAFETY: the caller's promises are those of this trait.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// The least time of several runs, milliseconds.
fn least_ms<T>(repeats: usize, mut run: impl FnMut() -> T) -> f64 {
    let one = |_| {
        let started = Instant::now();
        black_box(run());
        started.elapsed().as_secs_f64() * 1000.0
    };
    (0..repeats).map(one).fold(f64::INFINITY, f64::min)
}

/// The bytes that a run needs at most beyond what is there before it.
fn peak_bytes<T>(run: impl FnOnce() -> T) -> usize {
    let before = NOW.load(Relaxed);
    PEAK.store(before, Relaxed);
    black_box(run());
    PEAK.load(Relaxed) - before
}

fn paper(photo: &Photo, arena: Arena, corners: [[f64; 2]; 4]) -> usize {
    let Some(map) = PlanMap::from_seen_corners(photo, arena, corners, 0.0) else { return 0 };
    let frame = PlanFrame::new(arena, SCALE, 0.0);
    let brightness = brightness_view(photo, &map, &frame);
    rectangles(&paper_obstacles(&brightness), 36.0).len()
}

fn options(method: Method) -> DetectOptions {
    DetectOptions { method, ..DetectOptions::default() }
}

fn line(text: &str) -> Option<String> {
    let mut words = text.split_whitespace();
    let bytes = std::fs::read(words.next()?).ok()?;
    let numbers: Vec<f64> = words.filter_map(|word| word.parse().ok()).collect();
    let &[width, height, ref corners @ ..] = &numbers[..] else { return None };
    let mut pairs = corners.chunks_exact(2).map(|pair| [pair[0], pair[1]]);
    let corners = [pairs.next()?, pairs.next()?, pairs.next()?, pairs.next()?];
    let (photo, arena) = (decode(&bytes).ok()?, Arena { width, height });
    let whole = |method| least_ms(3, || detect(&photo, arena, &options(method)).is_ok());
    Some(format!(
        "{{\"width\":{},\"height\":{},\"paper_ms\":{:.3},\"detect_paper_ms\":{:.3},\"detect_robust_ms\":{:.3}}}",
        photo.width(),
        photo.height(),
        least_ms(REPEATS, || paper(&photo, arena, corners)),
        whole(Method::Paper),
        least_ms(2, || detect(&photo, arena, &options(Method::Robust)).is_ok()),
    ))
}

/// A white floor of 2 × 1.5 m in a dark frame with six boxes, `width` pixels wide.
fn drawn(width: usize) -> Option<Photo> {
    let height = width * 3 / 4;
    let metre = width as f64 / 2.4;
    let boxes: Vec<Rect> = (0..6)
        .map(|i| (0.2 + 0.6 * f64::from(i % 3), 0.2 + 0.7 * f64::from(i / 3)))
        .map(|(x, y)| Rect::new(x, y, x + 0.3, y + 0.25))
        .collect();
    let pixels = (0..width * height).map(|index| {
        let (x, y) = ((index % width) as f64 / metre - 0.2, (index / width) as f64 / metre - 0.15);
        let point = wmr::geometry::Point::new(x, y);
        let floor = Rect::new(0.0, 0.0, 2.0, 1.5).distance(point) == 0.0;
        let frame = Rect::new(-0.05, -0.05, 2.05, 1.55).distance(point) == 0.0 && !floor;
        let dark = frame || boxes.iter().any(|rect| rect.distance(point) == 0.0);
        let grain = (index.wrapping_mul(2_654_435_761) >> 7) as u8 % 8;
        [if dark { 40 } else { 220 } + grain; 3]
    });
    Photo::from_rgb(width, height, pixels.collect()).ok()
}

fn sizes() {
    let arena = Arena { width: 2.0, height: 1.5 };
    for width in [640, 1280, 2560, 5120, 7300] {
        let Some(photo) = drawn(width) else { continue };
        let pixels = (photo.width() * photo.height()) as f64;
        for (name, method) in [("paper", Method::Paper), ("robust", Method::Robust)] {
            let run = || detect(&photo, arena, &options(method)).is_ok();
            let (ms, peak) = (least_ms(2, run), peak_bytes(run) as f64);
            println!(
                "{{\"method\":\"{name}\",\"megapixels\":{:.2},\"ms\":{ms:.1},\"ns_per_pixel\":{:.2},\"peak_bytes_per_pixel\":{:.2}}}",
                pixels / 1e6,
                ms * 1e6 / pixels,
                peak / pixels
            );
        }
    }
}

fn main() {
    if std::env::args().any(|word| word == "--sizes") {
        return sizes();
    }
    for text in std::io::stdin().lock().lines().map_while(Result::ok) {
        match line(&text) {
            Some(result) => println!("{result}"),
            None => eprintln!("cannot be read: {text}"),
        }
    }
}
