//! Pictures of the steps of vision: PNG where a step is an image, SVG where it is drawn over one.
//!
//! Every picture is in the plan view, x to the right and y up, so that they can be laid side by side.

use super::svg::Svg;
use crate::geometry::{Arena, Point, Pose};
use crate::scene::Obstacle;
use crate::vision::{BorderCandidates, Detection, Photo, Raster, Steps};
use image::{ExtendedColorType, ImageEncoder, codecs::png::PngEncoder};
use std::fmt::Write;

/// Pixels per metre of the drawn pictures.
pub(super) const DRAWN_SCALE: f64 = 400.0;
/// A photo is drawn with at most so many pixels a side.
const PHOTO_SIDE: usize = 1400;

/// A picture with the name that its file should have.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedPicture {
    /// The file name, numbered in the order of the steps.
    pub name: &'static str,
    /// The file's bytes.
    pub bytes: Vec<u8>,
}

/// All pictures of vision's steps, in the order of the flow; none if the steps were not kept.
pub fn vision_pictures(detection: &Detection, robot_radius: f64) -> Vec<NamedPicture> {
    let Some(steps) = &detection.steps else { return Vec::new() };
    let named = |name, bytes| NamedPicture { name, bytes };
    vec![
        named("1_plan_view.png", plan_view_picture(steps)),
        named("2_edges.png", grey_picture(&stretched(&steps.paper.magnitude))),
        named("3_averaged.png", grey_picture(&stretched(&steps.paper.averaged))),
        named(
            "4_threshold.png",
            grey_picture(&steps.paper.edges.map(|edge| if edge { 255 } else { 0 })),
        ),
        named(
            "5_inverted.png",
            grey_picture(&steps.paper.inverted.map(|area| if area { 255 } else { 0 })),
        ),
        named(
            "6_mask.png",
            grey_picture(
                &steps.paper.obstacles.cells.map(|obstacle| if obstacle { 0 } else { 255 }),
            ),
        ),
        named("7_obstacles.svg", obstacles_picture(detection, steps, robot_radius).into_bytes()),
        named(
            "8_enlarged.png",
            grey_picture(
                &steps.paper.enlarged.cells.map(|obstacle| if obstacle { 0 } else { 255 }),
            ),
        ),
        named("9_borders.svg", borders_picture(steps).into_bytes()),
    ]
}

/// The candidates for the arena's border over the photo, so that a person sees what it was chosen from.
pub fn border_picture(photo: &Photo, seen: &BorderCandidates) -> NamedPicture {
    let factor = photo.width().max(photo.height()).div_ceil(PHOTO_SIDE).max(1);
    let small = photo.reduced(factor);
    let codes = Raster::from_cells(small.width(), small.pixels().to_vec());
    let mut svg = Svg::over((small.width() as f64, small.height() as f64), &colour_picture(&codes));
    // Pixels are squares about their centres.
    let place = |value: f64| (value + 0.5) / factor as f64;
    let mut quad = |corners: &[[f64; 2]; 4], name: &str, class: &str| {
        let points = corners.map(|[x, y]| (place(x), place(y)));
        svg.polygon(&points, class);
        svg.text(points[0], "candidate-name", "start", 14.0, name);
    };
    for (index, corners) in seen.odd.iter().enumerate() {
        quad(corners, &format!("odd {}", index + 1), "margin");
    }
    for (index, corners) in seen.fitting.iter().enumerate() {
        quad(corners, &(index + 1).to_string(), "candidate");
    }
    NamedPicture { name: "0_border.svg", bytes: svg.finish(&[]).into_bytes() }
}

/// The plan view as a colour PNG.
pub fn plan_view_picture(steps: &Steps) -> Vec<u8> {
    colour_picture(&steps.view.map(|light| light.map(crate::vision::srgb_code)))
}

/// A raster of sRGB codes as a colour PNG.
pub fn colour_picture(codes: &Raster<[u8; 3]>) -> Vec<u8> {
    png(codes.cells().as_flattened(), codes, ExtendedColorType::Rgb8)
}

/// A raster of brightness codes as a grey PNG.
pub fn grey_picture(codes: &Raster<u8>) -> Vec<u8> {
    png(codes.cells(), codes, ExtendedColorType::L8)
}

/// The obstacles with their margins and the robot, drawn over the plan view, as SVG.
pub fn obstacles_picture(detection: &Detection, steps: &Steps, robot_radius: f64) -> String {
    let arena = steps.frame.arena;
    let mut svg = opened(arena, &plan_view_picture(steps));
    for (index, obstacle) in detection.obstacles.iter().enumerate() {
        outlined(&mut svg, obstacle, DRAWN_SCALE, |point| drawn(arena, point));
        let (x, y) = drawn(arena, obstacle.footprint.bounds().centre());
        svg.text((x, y + 8.0), "seen-number", "middle", 22.0, &(index + 1).to_string());
    }
    if let Some(pose) = detection.robot {
        robot(&mut svg, |point| drawn(arena, point), pose, robot_radius * DRAWN_SCALE);
    }
    svg.finish(&[])
}

/// One obstacle over a picture: a light tint with a clear outline, so that what lies under it can be
/// checked, and a dashed line as far out as its edges may lie.
pub(super) fn outlined(
    svg: &mut Svg,
    obstacle: &Obstacle,
    scale: f64,
    drawn: impl Fn(Point) -> (f64, f64),
) {
    let placed =
        |corners: &[Point]| corners.iter().map(|&corner| drawn(corner)).collect::<Vec<_>>();
    let outline = placed(&obstacle.footprint.outline());
    match obstacle.footprint.as_rect() {
        Some(rect) => svg.polygon(&placed(&rect.widened(obstacle.margin).corners()), "margin"),
        None => svg.band(&outline, 2.0 * obstacle.largest_margin() * scale, "margin-band"),
    }
    svg.polygon(&outline, "seen");
}

/// The borders of the enlarged obstacles over the plan view, in the paper's pink, as SVG.
pub fn borders_picture(steps: &Steps) -> String {
    let arena = steps.frame.arena;
    let mut svg = opened(arena, &plan_view_picture(steps));
    let borders = &steps.paper.borders;
    let cell = DRAWN_SCALE / steps.frame.scale;
    let mut cells = String::new();
    for row in 0..borders.height() {
        for segment in crate::vision::segments(borders.row(row).iter().copied()) {
            let (x, y, length) = (
                cell * segment.start as f64,
                cell * row as f64,
                cell * (segment.end - segment.start) as f64,
            );
            // Writing into a string cannot fail.
            let _ = write!(cells, "M{x:.1} {y:.1}h{length:.1}v{cell:.1}h{:.1}z", -length);
        }
    }
    svg.path(&cells, "seen-borders");
    svg.finish(&[])
}

/// Magnitudes as brightness codes, the 99.5th percentile white.
fn stretched(values: &Raster<u16>) -> Raster<u8> {
    let mut sorted: Vec<u16> = values.cells().to_vec();
    let index = (sorted.len() * 995 / 1000).min(sorted.len().saturating_sub(1));
    let white = if sorted.is_empty() { 1 } else { (*sorted.select_nth_unstable(index).1).max(1) };
    values.map(|value| (u32::from(value) * 255 / u32::from(white)).min(255) as u8)
}

fn png<T: Copy>(codes: &[u8], of: &Raster<T>, kind: ExtendedColorType) -> Vec<u8> {
    let mut bytes = Vec::new();
    // Writing to memory fails only if the sizes disagree, and they come from one raster.
    let written =
        PngEncoder::new(&mut bytes).write_image(codes, of.width() as u32, of.height() as u32, kind);
    if written.is_ok() { bytes } else { Vec::new() }
}

/// A picture of an arena over its plan view.
pub(super) fn opened(arena: Arena, png: &[u8]) -> Svg {
    Svg::over((arena.width * DRAWN_SCALE, arena.height * DRAWN_SCALE), png)
}

/// The robot's disc of a radius in pixels and its heading, on a picture on which `drawn` places points.
pub(super) fn robot(svg: &mut Svg, drawn: impl Fn(Point) -> (f64, f64), pose: Pose, radius: f64) {
    let (x, y) = drawn(pose.position);
    let (sin, cos) = pose.heading.sin_cos();
    let tip = (x + 1.8 * radius * cos, y - 1.8 * radius * sin);
    svg.circle((x, y), radius, "seen-robot");
    svg.polyline(&[(x, y), tip], "seen-heading");
}

/// Where a floor point is drawn.
pub(super) fn drawn(arena: Arena, point: Point) -> (f64, f64) {
    (point.x * DRAWN_SCALE, (arena.height - point.y) * DRAWN_SCALE)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_grey_picture_can_be_decoded_to_the_same_codes() {
        let codes = Raster::from_fn(70, 64, |x, y| (x + y) as u8);
        let photo = crate::vision::decode(&grey_picture(&codes)).unwrap();
        assert!(photo.pixels().iter().zip(codes.cells()).all(|(pixel, code)| pixel == &[*code; 3]));
    }

    #[test]
    fn drawn_points_have_y_up() {
        let arena = Arena { width: 2.0, height: 1.0 };
        assert_eq!(drawn(arena, Point::new(0.5, 0.25)), (0.5 * DRAWN_SCALE, 0.75 * DRAWN_SCALE));
    }
}
