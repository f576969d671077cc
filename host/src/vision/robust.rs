//! Obstacles by the floor's colour: boxes that may lean, to a fraction of a pixel.
//!
//! Deviation: the paper takes what is not near white as obstacle and its outline as footprint
//! [Alghannam, Sec. II]. Here what is neither floor nor shadow is explained by boxes, and footprints
//! are told from outlines wherever visible sides show that boxes lean.

use super::boxes::Search;
use super::evidence::Evidence;
use super::look::Look;
use super::photo::Photo;
use super::plan_map::PlanMap;
use super::proposals::proposals;
use super::robot::RobotTop;
use super::sharpen::{Bounded, Sharpener};
use super::viewpoint::Viewpoint;
use crate::geometry::Rect;

/// Boxes lean if that explains this share more, where sides that are plainly seen count as so much.
const LEAN_GAIN: f32 = 0.012;
const SHOWN_WEIGHT: f32 = 0.03;

/// The boxes of a picture.
pub(crate) struct Found {
    pub(crate) boxes: Vec<Bounded>,
    /// Whether they lean; unknown without boxes.
    pub(crate) leans: Option<bool>,
}

/// Finds the boxes.
///
/// They are sought twice, upright and leaning away from the camera's foot point. From far away no lean
/// can be seen, and a free lean only fits noise; so leaning boxes must explain more or show sides.
pub(crate) fn find(
    photo: &Photo,
    map: &PlanMap,
    look: &Look,
    robot: Option<RobotTop>,
    viewpoint: Option<Viewpoint>,
) -> Found {
    let evidence = Evidence::of(photo, map, look, robot);
    let rects = proposals(&evidence);
    let upright = Search { evidence: &evidence, foot: None };
    let flat = upright.run(&rects);
    let foot = viewpoint.map(|view| view.foot);
    let search = Search { evidence: &evidence, foot };
    let rects: Vec<Rect> = rects.into_iter().chain(flat.iter().map(|seen| seen.base)).collect();
    let leaning = search.run(&rects);
    let sharpener = Sharpener { photo, map, look, foot };
    let shown = leaning.iter().filter(|&&seen| sharpener.shows_lean(seen)).count();
    let gain = search.explained(&leaning) / upright.explained(&flat).max(1.0) - 1.0;
    let leans = gain + SHOWN_WEIGHT * shown as f32 / leaning.len().max(1) as f32 > LEAN_GAIN;
    let any = !(flat.is_empty() && leaning.is_empty());
    let (boxes, foot) = if leans { (leaning, foot) } else { (flat, None) };
    let tools = Sharpener { foot, ..sharpener };
    let boxes = boxes.into_iter().map(|seen| tools.sharpen(seen)).collect();
    Found { boxes, leans: any.then_some(leans) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Arena;

    #[test]
    fn a_dark_square_seen_from_far_away_stands_where_it_appears() {
        let pixels = (0..200 * 150).map(|i| {
            let (x, y) = (i % 200, i / 200);
            if (60..90).contains(&x) && (50..90).contains(&y) { [40; 3] } else { [220; 3] }
        });
        let photo = Photo::from_rgb(200, 150, pixels.collect()).unwrap();
        let arena = Arena { width: 2.0, height: 1.5 };
        let corners = [[-0.5, 149.5], [199.5, 149.5], [199.5, -0.5], [-0.5, -0.5]];
        let map = PlanMap::from_corners(&photo, arena, corners, 0.0).unwrap();
        let look = Look::at(&photo, &map, arena).unwrap();
        let found = find(&photo, &map, &look, None, Viewpoint::of(&photo, &map));
        assert_eq!((found.boxes.len(), found.leans), (1, Some(false)));
        let Rect { x0, y0, x1, y1 } = found.boxes[0].rect;
        for (edge, drawn) in [(x0, 0.6), (y0, 0.6), (x1, 0.9), (y1, 1.0)] {
            assert!((edge - drawn).abs() < 0.003, "{edge} {drawn}");
        }
    }
}
