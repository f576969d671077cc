//! Obstacles by the floor's colour: boxes that may lean, to a fraction of a pixel.
//!
//! Deviation: the paper takes what is not near white as obstacle and its outline as footprint
//! [Alghannam, Sec. II]. Here what is neither floor nor shadow is explained by boxes, and footprints
//! are told from outlines wherever visible sides show that boxes lean.

use super::boxes::Search;
use super::evidence::Evidence;
use super::implausible::{fades_into_floor, is_part_of_robot, is_part_of_wall};
use super::lamp::Lamp;
use super::leaning::LeaningBox;
use super::look::Look;
use super::photo::Photo;
use super::plan_map::PlanMap;
use super::proposals::proposals;
use super::robot::RobotTop;
use super::sharpen::{Bounded, Sharpener};
use super::viewpoint::Viewpoint;
use crate::geometry::{Point, Rect};

/// Boxes lean if that explains this share more, where sides that are plainly seen count as so much.
const LEAN_GAIN: f32 = 0.012;
const SHOWN_WEIGHT: f32 = 0.03;
/// Shadow of this many square metres matters.
const LEAST_SHADE: f64 = 0.002;

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
    let evidence = Evidence::of(photo, map, look, robot, true);
    let first = Scene::explain(photo, map, look, viewpoint, &evidence);
    let doubtful = first.lamp.is_none() && first.unexplained_shade(&evidence);
    if doubtful {
        // Shadow that no lamp explains may be boxes as dark as shadow: they must not be lost.
        let evidence = evidence.without_shadows(look, robot);
        return Scene::explain(photo, map, look, viewpoint, &evidence)
            .finish(photo, map, look, robot);
    }
    first.finish(photo, map, look, robot)
}

/// The explanation of a picture.
struct Scene {
    boxes: Vec<LeaningBox>,
    foot: Option<Point>,
    lamp: Option<Lamp>,
    leans: Option<bool>,
}

impl Scene {
    /// Seeks boxes upright, leaning, and once more with the lamp if the shadows of those tell it.
    fn explain(
        photo: &Photo,
        map: &PlanMap,
        look: &Look,
        viewpoint: Option<Viewpoint>,
        evidence: &Evidence,
    ) -> Self {
        let rects = proposals(evidence);
        let upright = Search { evidence, foot: None, lamp: None };
        let flat = upright.run(&rects);
        let foot = viewpoint.map(|view| view.foot);
        let search = Search { evidence, foot, lamp: None };
        let with = |found: &[LeaningBox]| -> Vec<Rect> {
            rects.iter().copied().chain(found.iter().map(|seen| seen.base)).collect()
        };
        let leaning = search.run(&with(&flat));
        let sharpener = Sharpener { photo, map, look, foot, lit: false };
        let lamp = viewpoint.and_then(|view| {
            let leans: Vec<_> = leaning.iter().map(|&seen| sharpener.shown_lean(seen)).collect();
            Lamp::of(evidence, &leaning, &leans, view.foot, view.height)
        });
        let search = Search { lamp, ..search };
        let leaning = if lamp.is_some() { search.run(&with(&leaning)) } else { leaning };
        let shown = leaning.iter().filter(|&&seen| sharpener.shown_lean(seen).is_some()).count();
        let gain = search.explained(&leaning) / upright.explained(&flat).max(1.0) - 1.0;
        let leans = gain + SHOWN_WEIGHT * shown as f32 / leaning.len().max(1) as f32 > LEAN_GAIN;
        let any = !(flat.is_empty() && leaning.is_empty());
        let (boxes, foot) = if leans { (leaning, foot) } else { (flat, None) };
        Self { boxes, foot, lamp, leans: any.then_some(leans) }
    }

    /// Whether there is shadow that matters though no lamp explains it.
    fn unexplained_shade(&self, evidence: &Evidence) -> bool {
        let shaded: f32 = evidence.shade.cells().iter().map(|shade| shade.max(0.0)).sum();
        f64::from(shaded) > LEAST_SHADE * evidence.frame.scale.powi(2)
    }

    /// The boxes brought to a fraction of a pixel, without what cannot be one.
    fn finish(self, photo: &Photo, map: &PlanMap, look: &Look, robot: Option<RobotTop>) -> Found {
        let tools = Sharpener { photo, map, look, foot: self.foot, lit: self.lamp.is_some() };
        let arena = look.frame.arena;
        let middle = Point::new(arena.width / 2.0, arena.height / 2.0);
        let outline = |seen: &LeaningBox| seen.bounds(self.foot.unwrap_or(middle));
        let seen = self.boxes.into_iter().filter(|seen| !fades_into_floor(outline(seen), look));
        let boxes = seen.map(|seen| tools.sharpen(seen)).filter(|bounded| {
            !is_part_of_wall(bounded.rect, arena) && !is_part_of_robot(bounded.rect, robot)
        });
        Found { boxes: boxes.collect(), leans: self.leans }
    }
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
