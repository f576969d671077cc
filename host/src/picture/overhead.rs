//! A scene drawn as a camera straight above would see it: the way back from boxes to a photo.
//!
//! White floor, dark tape along its border, dark boxes, and the robot as a disc with a triangle that
//! points ahead. It lets a scene be used where a photo is wanted, and vision be tried on a known truth.

use crate::geometry::{Point, Pose};
use crate::scene::Scene;
use image::{GrayImage, ImageError, ImageFormat, Luma};
use std::io::Cursor;

const FLOOR: u8 = 238;
const OUTSIDE: u8 = 190;
const TAPE: u8 = 30;
const BOX: u8 = 45;
const ROBOT: u8 = 30;
const TRIANGLE: u8 = 220;

/// Width of the tape, metres.
const TAPE_WIDTH: f64 = 0.04;
/// What is seen beyond the tape, metres.
const BEYOND: f64 = 0.1;
/// Samples along each side of a pixel: edges between pixels become shades.
const SAMPLES: u32 = 4;

/// Draws `scene`, with the robot at its start if it has one, as a PNG file.
///
/// # Errors
/// [`ImageError`] if the picture cannot be written, as when it is too large.
///
/// ```
/// let scene = wmr::scene::Scene::new(1.0, 0.5);
/// let png = wmr::picture::overhead::overhead_png(&scene, 100.0)?;
/// let photo = wmr::vision::decode(&png).unwrap();
/// assert_eq!((photo.width(), photo.height()), (128, 78)); // 0.14 m more on each side
/// # Ok::<(), image::ImageError>(())
/// ```
pub fn overhead_png(scene: &Scene, pixels_per_metre: f64) -> Result<Vec<u8>, ImageError> {
    let size =
        |metres: f64| ((metres + 2.0 * (TAPE_WIDTH + BEYOND)) * pixels_per_metre).round() as u32;
    let (width, height) = (size(scene.arena.width), size(scene.arena.height));
    let picture = GrayImage::from_fn(width, height, |column, row| {
        let shades = (0..SAMPLES * SAMPLES).map(|sample| {
            let across =
                f64::from(column) + (f64::from(sample % SAMPLES) + 0.5) / f64::from(SAMPLES);
            let down = f64::from(row) + (f64::from(sample / SAMPLES) + 0.5) / f64::from(SAMPLES);
            let x = across / pixels_per_metre - TAPE_WIDTH - BEYOND;
            let y = scene.arena.height + TAPE_WIDTH + BEYOND - down / pixels_per_metre;
            u32::from(shade(scene, Point::new(x, y)))
        });
        Luma([(shades.sum::<u32>() / (SAMPLES * SAMPLES)) as u8])
    });
    let mut bytes = Cursor::new(Vec::new());
    picture.write_to(&mut bytes, ImageFormat::Png)?;
    Ok(bytes.into_inner())
}

fn shade(scene: &Scene, point: Point) -> u8 {
    let (width, height) = (scene.arena.width, scene.arena.height);
    let out = (-point.x).max(point.x - width).max(-point.y).max(point.y - height);
    if out > TAPE_WIDTH {
        return OUTSIDE;
    }
    if out > 0.0 {
        return TAPE;
    }
    if scene.obstacles.iter().any(|obstacle| obstacle.footprint.contains(point)) {
        return BOX;
    }
    match scene.start {
        Some(pose) if pose.position.distance(point) < scene.robot_radius => {
            if in_triangle(pose, scene.robot_radius, point) { TRIANGLE } else { ROBOT }
        }
        _ => FLOOR,
    }
}

/// The triangle on the robot's top: its apex 0.8 of the radius ahead of the centre, its base 0.53 behind
/// and 0.75 wide.
fn in_triangle(pose: Pose, radius: f64, point: Point) -> bool {
    let (sin, cos) = pose.heading.sin_cos();
    let (dx, dy) = (point.x - pose.position.x, point.y - pose.position.y);
    let (ahead, left) = ((dx * cos + dy * sin) / radius, (dy * cos - dx * sin) / radius);
    ahead > -0.53 && left.abs() < 0.375 * (0.8 - ahead) / 1.33
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Rect;

    #[test]
    fn an_edge_between_two_pixels_is_a_shade() {
        let mut scene = Scene::new(1.0, 1.0);
        // 0.14 m of surroundings are 14 pixels; the box ends half-way through pixel 64.
        scene.obstacles.push(Rect::new(0.2, 0.2, 0.505, 0.8).into());
        let picture =
            image::load_from_memory(&overhead_png(&scene, 100.0).unwrap()).unwrap().into_luma8();
        let middle = (u32::from(BOX) + u32::from(FLOOR)) / 2;
        assert!(u32::from(picture.get_pixel(64, 64).0[0]).abs_diff(middle) <= 1);
        assert_eq!(picture.get_pixel(63, 64).0[0], BOX);
        assert_eq!(picture.get_pixel(65, 64).0[0], FLOOR);
        assert_eq!(picture.get_pixel(12, 64).0[0], TAPE);
        assert_eq!(picture.get_pixel(5, 64).0[0], OUTSIDE);
    }
}
