//! Files that are not whole, and files that must not be written over.
#![allow(clippy::unwrap_used, reason = "helpers of tests fail as tests do")]

mod program;

use image::{ExtendedColorType, codecs::jpeg::JpegEncoder};
use program::{PAPER, PHOTO, wmr};
use std::path::Path;
use std::process::Output;

/// The demo's photo as a JPEG.
fn jpeg() -> Vec<u8> {
    let picture = image::open(PHOTO).unwrap().into_rgb8();
    let mut bytes = Vec::new();
    let mut encoder = JpegEncoder::new_with_quality(&mut bytes, 92);
    encoder
        .encode(picture.as_raw(), picture.width(), picture.height(), ExtendedColorType::Rgb8)
        .unwrap();
    bytes
}

fn detect(photo: &Path) -> Output {
    wmr(&["detect", photo.to_str().unwrap(), "--arena", "1.3x1.55", "--json"])
}

#[test]
fn a_jpeg_that_was_cut_short_is_refused_however_little_is_missing() {
    let folder = tempfile::tempdir().unwrap();
    let photo = folder.path().join("photo.jpg");
    let whole = jpeg();
    std::fs::write(&photo, &whole).unwrap();
    assert!(detect(&photo).status.success());
    for share in [0.2, 0.6, 0.95, 0.999] {
        std::fs::write(&photo, &whole[..(share * whole.len() as f64) as usize]).unwrap();
        let output = detect(&photo);
        assert_eq!(output.status.code(), Some(3), "{share}");
        let text = String::from_utf8(output.stdout).unwrap();
        assert!(text.contains("complete PNG or JPEG"), "{share}: {text}");
    }
}

#[test]
fn no_result_is_written_over_its_input_or_another_kind_of_file() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("scene.json");
    std::fs::copy(PAPER, &scene).unwrap();
    let name = scene.to_str().unwrap();
    for arguments in [["plan", name, "-o", name], ["tags", "--out", name, "--json"]] {
        let output = wmr(&arguments);
        assert_eq!(output.status.code(), Some(2), "{output:?}");
        assert_eq!(std::fs::read(&scene).unwrap(), std::fs::read(PAPER).unwrap());
    }
    // An older plan may be written over.
    let plan = folder.path().join("plan.json");
    for _ in 0..2 {
        assert!(wmr(&["plan", name, "-o", plan.to_str().unwrap()]).status.success());
    }
}
