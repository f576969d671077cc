//! Pictures of the steps of vision with two cameras.
//!
//! All in the plan view, x to the right and y up, with a margin around the arena into which tops lean.

use super::svg::Svg;
use super::vision::{NamedPicture, colour_picture, outlined, robot};
use crate::geometry::{Point, Rect};
use crate::vision::{PairDetection, PairSteps, PlanFrame, Raster, srgb_code};

/// Pixels per metre of the drawn pictures.
const DRAWN_SCALE: f64 = 400.0;

/// All pictures of the steps, in the order of the flow; none if the steps were not kept.
pub fn pair_pictures(seen: &PairDetection, robot_radius: f64) -> Vec<NamedPicture> {
    let Some(steps) = &seen.steps else { return Vec::new() };
    let named = |name, bytes| NamedPicture { name, bytes };
    vec![
        named("1_plan_view_a.png", plan_view(&steps.views[0])),
        named("2_plan_view_b.png", plan_view(&steps.views[1])),
        named("3_both.png", both_picture(steps)),
        named("4_disagreement.png", disagreement_picture(steps)),
        named("5_boxes_a.svg", boxes_picture(steps, 0).into_bytes()),
        named("6_boxes_b.svg", boxes_picture(steps, 1).into_bytes()),
        named("7_obstacles.svg", obstacles_picture(seen, steps, robot_radius).into_bytes()),
    ]
}

fn plan_view(view: &Raster<[f32; 3]>) -> Vec<u8> {
    colour_picture(&view.map(|light| light.map(srgb_code)))
}

/// The first view in red, the second in green and blue: floor is grey, what is raised has fringes.
pub fn both_picture(steps: &PairSteps) -> Vec<u8> {
    let [first, second] = steps.views.each_ref().map(|view| view.map(|light| light.map(srgb_code)));
    let grey = |[r, g, b]: [u8; 3]| ((u16::from(r) + 2 * u16::from(g) + u16::from(b)) / 4) as u8;
    let mut others = second.cells().iter();
    colour_picture(&first.map(|here| {
        let there = others.next().map_or(0, |&cell| grey(cell));
        [grey(here), there, there]
    }))
}

/// Where the two pictures disagree, red over the first view.
pub fn disagreement_picture(steps: &PairSteps) -> Vec<u8> {
    let mut sure = steps.disagreement.cells().iter();
    colour_picture(&steps.views[0].map(|light| {
        let share = sure.next().copied().unwrap_or(0.0);
        let [r, g, b] = light.map(|value| f32::from(srgb_code(value)) * 0.6 + 60.0);
        [r + (255.0 - r) * share, g * (1.0 - share), b * (1.0 - share)].map(|code| code as u8)
    }))
}

/// The boxes as one camera sees them: footprint, top, and the lines between their corners.
pub fn boxes_picture(steps: &PairSteps, eye: usize) -> String {
    let mut svg = opened(&steps.frame, &plan_view(&steps.views[eye]));
    for (raised, tops) in &steps.boxes {
        let lines = corners(raised.base).into_iter().zip(corners(tops[eye]));
        for (low, high) in lines {
            svg.polyline(&[drawn(&steps.frame, low), drawn(&steps.frame, high)], "upright");
        }
        rect(&mut svg, &steps.frame, tops[eye], "top");
        rect(&mut svg, &steps.frame, raised.base, "footprint");
    }
    svg.finish(&[])
}

/// The footprints with margins and heights, and the robot, over the first view.
pub fn obstacles_picture(seen: &PairDetection, steps: &PairSteps, robot_radius: f64) -> String {
    let mut svg = opened(&steps.frame, &plan_view(&steps.views[0]));
    let detection = &seen.detection;
    for obstacle in &detection.obstacles {
        outlined(&mut svg, obstacle, DRAWN_SCALE, |point| drawn(&steps.frame, point));
        let Rect { x0, y0, x1, y1 } = obstacle.footprint.bounds();
        let middle = drawn(&steps.frame, Point::new((x0 + x1) / 2.0, (y0 + y1) / 2.0));
        let height = format!("{:.0} cm", 100.0 * obstacle.height.unwrap_or_default());
        svg.text(middle, "seen-height", "middle", 16.0, &height);
    }
    if let Some(pose) = detection.robot {
        robot(&mut svg, |point| drawn(&steps.frame, point), pose, robot_radius * DRAWN_SCALE);
    }
    svg.finish(&[])
}

fn opened(frame: &PlanFrame, picture: &[u8]) -> Svg {
    let length = |length: f64| (length + 2.0 * frame.margin) * DRAWN_SCALE;
    Svg::over((length(frame.arena.width), length(frame.arena.height)), picture)
}

fn rect(svg: &mut Svg, frame: &PlanFrame, Rect { x0, y0, x1, y1 }: Rect, class: &str) {
    let size = ((x1 - x0) * DRAWN_SCALE, (y1 - y0) * DRAWN_SCALE);
    svg.rect(drawn(frame, Point::new(x0, y1)), size, class);
}

fn corners(Rect { x0, y0, x1, y1 }: Rect) -> [Point; 4] {
    [(x0, y0), (x1, y0), (x1, y1), (x0, y1)].map(|(x, y)| Point::new(x, y))
}

/// Where a floor point is drawn.
fn drawn(frame: &PlanFrame, point: Point) -> (f64, f64) {
    let (x, y) = (point.x + frame.margin, frame.arena.height + frame.margin - point.y);
    (x * DRAWN_SCALE, y * DRAWN_SCALE)
}
