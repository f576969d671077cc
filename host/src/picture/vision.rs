//! Pictures of the steps of vision: PNG where a step is an image, SVG where it is drawn over one.
//!
//! Every picture is in the plan view, x to the right and y up, so that they can be laid side by side.

use crate::geometry::{Arena, Point, Pose};
use crate::scene::Obstacle;
use crate::vision::{Detection, Raster, Steps};
use image::{ExtendedColorType, ImageEncoder, codecs::png::PngEncoder};
use std::fmt::Write;

/// Pixels per metre of the drawn pictures.
pub(super) const DRAWN_SCALE: f64 = 400.0;
/// The colours of the drawn pictures.
const OBSTACLE: &str = "#d1495b";
const MARGIN: &str = "#edae49";
const ROBOT: &str = "#00798c";
const BORDER: &str = "#ff69b4";

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
    for obstacle in &detection.obstacles {
        outlined(&mut svg, obstacle, DRAWN_SCALE, |point| drawn(arena, point));
    }
    if let Some(pose) = detection.robot {
        robot(&mut svg, |point| drawn(arena, point), pose, robot_radius * DRAWN_SCALE);
    }
    svg + "</svg>\n"
}

/// One obstacle over a picture: a light tint with a clear outline, so that what lies under it can be
/// checked, and a dashed line as far out as its edges may lie.
pub(super) fn outlined(
    svg: &mut String,
    obstacle: &Obstacle,
    scale: f64,
    drawn: impl Fn(Point) -> (f64, f64),
) {
    let mut polygon = |corners: &[Point], style: &str| {
        let _ = write!(svg, "<polygon points=\"");
        for (x, y) in corners.iter().map(|&corner| drawn(corner)) {
            let _ = write!(svg, "{x:.1},{y:.1} ");
        }
        let _ = writeln!(svg, "\" {style}/>");
    };
    match obstacle.footprint.as_rect() {
        Some(rect) => polygon(
            &rect.widened(obstacle.margin).corners(),
            &format!(
                "fill=\"none\" stroke=\"{MARGIN}\" stroke-width=\"2\" stroke-dasharray=\"6 4\""
            ),
        ),
        None => polygon(
            &obstacle.footprint.outline(),
            &format!(
                "fill=\"none\" stroke=\"{MARGIN}\" stroke-opacity=\"0.5\" stroke-linejoin=\"round\" stroke-width=\"{:.1}\"",
                2.0 * obstacle.largest_margin() * scale
            ),
        ),
    }
    polygon(
        &obstacle.footprint.outline(),
        &format!(
            "fill=\"{OBSTACLE}\" fill-opacity=\"0.2\" stroke=\"{OBSTACLE}\" stroke-width=\"2.5\""
        ),
    );
}

/// The borders of the enlarged obstacles over the plan view, in the paper's pink, as SVG.
pub fn borders_picture(steps: &Steps) -> String {
    let arena = steps.frame.arena;
    let mut svg = opened(arena, &plan_view_picture(steps));
    let borders = &steps.paper.borders;
    let cell = DRAWN_SCALE / steps.frame.scale;
    let _ = write!(svg, "<path fill=\"{BORDER}\" d=\"");
    for row in 0..borders.height() {
        for segment in crate::vision::segments(borders.row(row).iter().copied()) {
            let (x, y, length) = (
                cell * segment.start as f64,
                cell * row as f64,
                cell * (segment.end - segment.start) as f64,
            );
            let _ = write!(svg, "M{x:.1} {y:.1}h{length:.1}v{cell:.1}h{:.1}z", -length);
        }
    }
    svg + "\"/></svg>\n"
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

pub(super) fn opened(arena: Arena, png: &[u8]) -> String {
    embedded((arena.width * DRAWN_SCALE, arena.height * DRAWN_SCALE), png)
}

/// The beginning of an SVG picture of a size in pixels that a PNG fills.
pub(super) fn embedded((width, height): (f64, f64), png: &[u8]) -> String {
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width:.1} {height:.1}\" width=\"{width:.0}\" height=\"{height:.0}\">\n\
        <image width=\"{width:.1}\" height=\"{height:.1}\" href=\"data:image/png;base64,{}\"/>\n",
        base64(png)
    )
}

/// A rectangle by its upper left corner and size, pixels.
pub(super) fn shape(
    svg: &mut String,
    (x, y): (f64, f64),
    (width, height): (f64, f64),
    style: &str,
) {
    let _ = writeln!(
        svg,
        "<rect x=\"{x:.1}\" y=\"{y:.1}\" width=\"{width:.1}\" height=\"{height:.1}\" {style}/>"
    );
}

/// The robot's disc of a radius in pixels and its heading, on a picture on which `drawn` places points.
pub(super) fn robot(
    svg: &mut String,
    drawn: impl Fn(Point) -> (f64, f64),
    pose: Pose,
    radius: f64,
) {
    let (x, y) = drawn(pose.position);
    let (sin, cos) = pose.heading.sin_cos();
    let (tip_x, tip_y) = (x + 1.8 * radius * cos, y - 1.8 * radius * sin);
    let _ = writeln!(
        svg,
        "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{radius:.1}\" fill=\"{ROBOT}\" fill-opacity=\"0.45\" stroke=\"{ROBOT}\" stroke-width=\"3\"/>"
    );
    let _ = writeln!(
        svg,
        "<line x1=\"{x:.1}\" y1=\"{y:.1}\" x2=\"{tip_x:.1}\" y2=\"{tip_y:.1}\" stroke=\"{ROBOT}\" stroke-width=\"5\" stroke-linecap=\"round\"/>"
    );
}

/// Where a floor point is drawn.
pub(super) fn drawn(arena: Arena, point: Point) -> (f64, f64) {
    (point.x * DRAWN_SCALE, (arena.height - point.y) * DRAWN_SCALE)
}

/// The bytes in base 64 (RFC 4648), as a data address wants them.
fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for group in bytes.chunks(3) {
        let bits =
            (0..3).fold(0u32, |bits, i| bits << 8 | u32::from(group.get(i).copied().unwrap_or(0)));
        for digit in 0..4 {
            let index = (bits >> (18 - 6 * digit) & 63) as usize;
            text.push(if digit <= group.len() { char::from(DIGITS[index]) } else { '=' });
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_pads_as_the_standard_shows() {
        assert_eq!(
            ["", "f", "fo", "foo", "foobar"].map(|text| base64(text.as_bytes())),
            ["", "Zg==", "Zm8=", "Zm9v", "Zm9vYmFy"]
        );
    }

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
