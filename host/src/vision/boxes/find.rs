//! Obstacles by the floor's colour: boxes that may lean, to a fraction of a pixel.
//!
//! Deviation: the paper takes what is not near white as obstacle and its outline as footprint
//! [Alghannam, Sec. II]. Here what is neither floor nor shadow is explained by boxes, and footprints
//! are told from outlines wherever visible sides show that boxes lean.

use super::balance::shaded_area;
use super::border_colours::BorderColours;
use super::evidence::Evidence;
use super::light::Lamp;
use super::projection::LeaningBox;
use super::proposals::proposals;
use super::refine::Bounded;
use super::search::Search;
use super::shaped::Shaped;
use super::standing::Standing;
use super::tighten::Tightener;
use super::uncovered::Explained;
use crate::geometry::{Point, Rect};
use crate::scene::Obstacle;
use crate::shape::Shape;
use crate::vision::appearance::{Feature, FloorModel, Look, Shadow};
use crate::vision::camera::{PlanMap, Viewpoint};
use crate::vision::image::Photo;
use crate::vision::plan_view::PlanFrame;
use crate::vision::robot::RobotTop;

/// Boxes lean if that explains this share more. From where they are seen nothing leans if it explains no more than
/// the least, where sides that are plainly seen count as so much.
const LEAN_GAIN: f32 = 0.035;
const LEAST_LEAN_GAIN: f32 = 0.012;
const SHOWN_WEIGHT: f32 = 0.03;
/// Shadow of this many square metres matters.
const LEAST_SHADE: f64 = 0.002;
/// The share of all shadow that a lamp may leave unexplained.
const MOST_LEFT: f32 = 0.25;
/// Shadow that leaves less light than two fifths (natural logarithm) is more likely the colour of things: a lamp must
/// explain nearly all of it.
const DEEP_SHADOW: f32 = 0.92;
/// The share of it that may be left.
const MOST_DEEP_LEFT: f32 = 0.15;
/// Another reading of shadow is taken if it leaves less than this share unexplained.
const CLEARLY: f32 = 0.9;

/// The boxes of a picture.
pub(crate) struct Found {
    pub(crate) boxes: Vec<Bounded>,
    /// What is no upright box.
    pub(crate) shapes: Vec<Obstacle>,
    /// Whether they lean; unknown without boxes, and of what may as well be cut from card.
    pub(crate) leans: Option<bool>,
    /// Whether thin lines from side to side were taken for lines on the floor.
    pub(crate) has_lines: bool,
    /// Where each of the boxes and then of the shapes is seen.
    pub(crate) traces: Vec<Trace>,
    /// What the picture has told of floor and light; nothing if the method does without.
    pub(crate) known: Option<Known>,
}

/// Where a thing is seen.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Trace {
    /// The bounds of its outline and shadow, metres.
    pub(crate) extent: Rect,
    /// The box that the search has found there, if it has.
    pub(crate) searched: Option<LeaningBox>,
}

impl Trace {
    fn plain(extent: Rect) -> Self {
        Self { extent, searched: None }
    }
}

impl Found {
    /// Boxes that were found without a model of the floor.
    pub(crate) fn plain(boxes: Vec<Bounded>) -> Self {
        let traces = boxes.iter().map(|seen| Trace::plain(seen.rect)).collect();
        Self { boxes, shapes: vec![], leans: None, has_lines: false, traces, known: None }
    }
}

/// Finds the boxes.
///
/// They are searched for twice, upright and leaning away from the camera's foot point. From far away no lean
/// can be seen, and a free lean only fits noise or what is no upright box; so leaning boxes must explain more than
/// upright ones do, and than outlines of one colour where no shadow tells of heights.
///
/// Shadow that no lamp explains may be boxes as dark as shadow, which must not be lost. Then all that is
/// dark is taken for boxes. If the shadows of these tell the lamp after all, and the lamp leaves little
/// shadow unexplained, its boxes are taken; else what is dark stays an obstacle.
pub(crate) fn find(
    photo: &Photo,
    map: &PlanMap,
    mut look: Look,
    robot: Option<RobotTop>,
    viewpoint: Option<Viewpoint>,
) -> Found {
    let mut best: Option<Reading> = None;
    for shadow in look.readings() {
        look.floor.shadow = shadow;
        let evidence = match &best {
            None => Evidence::of(photo, map, &look, robot, true),
            Some(best) => best.evidence.judged_again(&look, robot, true),
        };
        let picture = Picture { photo, map, look: &look, robot, viewpoint };
        let scene = picture.explain(&evidence);
        let left = scene.search(&evidence).left_over(&scene.boxes);
        let clearly = |best: &Reading| scene.lamp.is_some() && left < CLEARLY * best.left;
        if best.as_ref().is_none_or(clearly) {
            best = Some(Reading { shadow, evidence, scene, left });
        }
    }
    let Some(Reading { shadow, evidence, scene: first, .. }) = best else {
        return Found::plain(Vec::new());
    };
    look.floor.shadow = shadow;
    let picture = Picture { photo, map, look: &look, robot, viewpoint };
    let is_deep = shadow.is_some_and(|shadow| shadow.offset[0] < -DEEP_SHADOW);
    let is_cast = !is_deep || first.shade_left(&evidence) < MOST_DEEP_LEFT;
    if first.lamp.is_some() && is_cast || shaded_area(&evidence) < LEAST_SHADE {
        return picture.settle(first, &evidence, true);
    }
    let dark = picture.explain(&evidence.judged_again(&look, robot, false));
    let lit = dark.lamp.and_then(|lamp| picture.lit(&evidence, lamp, &dark.boxes));
    let has_shadows = lit.is_some();
    picture.settle(lit.unwrap_or(dark), &evidence, has_shadows)
}

/// Finds the boxes in a window of a later picture of the same floor in the same light, where `before` were
/// found by the search before.
pub(crate) fn find_within(
    (photo, map): (&Photo, &PlanMap),
    known: &Known,
    (window, left_out): (Rect, &[Shape]),
    (robot, viewpoint): (Option<RobotTop>, Option<Viewpoint>),
    before: &[LeaningBox],
) -> Found {
    let mut look = Look::within(photo, map, &known.floor, known.frames, window);
    look.leave_out(left_out.to_vec());
    let of_floor = (known.spread, &known.borders, known.has_shadows);
    let part = (known.coarse, window);
    let evidence = Evidence::within(photo, map, &look, robot, part, of_floor);
    let Known { foot, lamp, leans, .. } = *known;
    let rects = with(&proposals(&evidence), before);
    let boxes = Search { evidence: &evidence, foot, lamp }.run_from(&rects, before);
    let picture = Picture { photo, map, look: &look, robot, viewpoint };
    picture.finish(Scene { boxes, foot, lamp, leans })
}

/// What a picture has told of floor and light: it holds for others of the same floor in the same light.
#[derive(Clone, Debug)]
pub(crate) struct Known {
    floor: FloorModel,
    /// The frames of the look, and of the evidence.
    frames: [PlanFrame; 2],
    coarse: PlanFrame,
    spread: Feature,
    borders: BorderColours,
    /// Whether what is as dark as shadow may be shadow.
    has_shadows: bool,
    foot: Option<Point>,
    lamp: Option<Lamp>,
    /// Whether boxes lean, if that is known.
    pub(crate) leans: Option<bool>,
}

impl Known {
    /// The floor in its light, with the shadow on it.
    pub(crate) fn floor(&self) -> &FloorModel {
        &self.floor
    }

    /// The frames of a look at the whole picture.
    pub(crate) fn frames(&self) -> [PlanFrame; 2] {
        self.frames
    }
}

/// A reading of shadow, what it makes of the picture, and how much it leaves unexplained, cells.
struct Reading {
    shadow: Option<Shadow>,
    evidence: Evidence,
    scene: Scene,
    left: f32,
}

/// The explanation of a picture.
pub(super) struct Scene {
    pub(super) boxes: Vec<LeaningBox>,
    pub(super) foot: Option<Point>,
    pub(super) lamp: Option<Lamp>,
    leans: Option<bool>,
}

impl Scene {
    fn search<'a>(&self, evidence: &'a Evidence) -> Search<'a> {
        Search { evidence, foot: self.foot, lamp: self.lamp }
    }

    /// The share of the shadow that it leaves unexplained.
    fn shade_left(&self, evidence: &Evidence) -> f32 {
        self.search(evidence).unexplained_shade(&self.boxes)
    }
}

/// A picture and what is known of it before boxes are searched for.
pub(super) struct Picture<'a> {
    pub(super) photo: &'a Photo,
    pub(super) map: &'a PlanMap,
    pub(super) look: &'a Look,
    pub(super) robot: Option<RobotTop>,
    pub(super) viewpoint: Option<Viewpoint>,
}

impl Picture<'_> {
    /// Seeks boxes upright, leaning, and once more with the lamp if the shadows of those tell it.
    fn explain(&self, evidence: &Evidence) -> Scene {
        let rects = proposals(evidence);
        let upright = Search { evidence, foot: None, lamp: None };
        let flat = upright.run(&rects);
        let foot = self.viewpoint.map(|view| view.foot);
        let search = Search { evidence, foot, lamp: None };
        let leaning = search.run(&with(&rects, &flat));
        let sharpener = self.sharpener(foot, false);
        let lamp = self.viewpoint.and_then(|view| {
            let leans: Vec<_> = leaning.iter().map(|&seen| sharpener.shown_lean(seen)).collect();
            Lamp::of(evidence, &leaning, &leans, view.foot, view.height)
        });
        let search = Search { lamp, ..search };
        let leaning = if lamp.is_some() { search.run(&with(&rects, &leaning)) } else { leaning };
        // Without a shadow that tells of heights an outline of one colour is as likely cut from card.
        let cut = if lamp.is_none() { upright.explained_by_outlines(&flat) } else { 0.0 };
        let (explained, by_flat) = (search.explained(&leaning), upright.explained(&flat));
        let leans = explained / (by_flat + cut).max(1.0) - 1.0 > LEAN_GAIN;
        let shown = leaning.iter().filter(|&&seen| sharpener.shown_lean(seen).is_some()).count();
        let shown = SHOWN_WEIGHT * shown as f32 / leaning.len().max(1) as f32;
        let any = !(flat.is_empty() && leaning.is_empty());
        let is_flat = any && explained / by_flat.max(1.0) - 1.0 + shown < LEAST_LEAN_GAIN;
        let (boxes, foot) = if leans { (leaning, foot) } else { (flat, None) };
        Scene { boxes, foot, lamp, leans: (leans || is_flat).then_some(leans) }
    }

    /// Seeks boxes under a lamp; `None` if they leave more shadow unexplained than they explain.
    fn lit(&self, evidence: &Evidence, lamp: Lamp, dark: &[LeaningBox]) -> Option<Scene> {
        let foot = self.viewpoint.map(|view| view.foot);
        let search = Search { evidence, foot, lamp: Some(lamp) };
        let boxes = search.run(&with(&proposals(evidence), dark));
        let scene = Scene { boxes, foot, lamp: Some(lamp), leans: Some(true) };
        (scene.shade_left(evidence) < MOST_LEFT).then_some(scene)
    }

    /// The boxes of an explanation of the whole picture, with what it tells of floor and light.
    fn settle(&self, scene: Scene, evidence: &Evidence, has_shadows: bool) -> Found {
        let known = Known {
            floor: self.look.floor.clone(),
            frames: [self.look.frame, self.look.view],
            coarse: evidence.frame,
            spread: evidence.spread,
            borders: evidence.borders.clone(),
            has_shadows,
            foot: scene.foot,
            lamp: scene.lamp,
            leans: scene.leans,
        };
        Found { known: Some(known), ..self.finish(scene) }
    }

    /// The boxes brought to a fraction of a pixel, without what cannot be one, and what else is seen.
    fn finish(&self, scene: Scene) -> Found {
        let Scene { foot, lamp, leans, .. } = scene;
        let (look, robot) = (self.look, self.robot);
        let standing = self.all_standing(scene);
        let outlines: Vec<LeaningBox> = standing.iter().map(|of| of.outline).collect();
        let explained = Explained { look, boxes: &outlines, foot, lamp, robot };
        let foreign = explained.foreign();
        let shaped = explained.shapes(&foreign);
        let of_shape = |of: &Shaped| {
            let replaced = of.replaces.iter().map(|&index| standing[index].trace.extent);
            Trace::plain(replaced.fold(of.obstacle.footprint.bounds(), Rect::union))
        };
        let of_shapes: Vec<Trace> = shaped.iter().map(of_shape).collect();
        let is_kept = |index: &usize| !shaped.iter().any(|of| of.replaces.contains(index));
        let kept: Vec<Standing> =
            (0..standing.len()).filter(is_kept).map(|index| standing[index]).collect();
        let outlines: Vec<LeaningBox> = kept.iter().map(|of| of.outline).collect();
        let (mut boxes, mut traces): (Vec<Bounded>, Vec<Trace>) =
            kept.into_iter().map(|of| (of.bounded, of.trace)).unzip();
        let mut shapes: Vec<Obstacle> = shaped.into_iter().map(|of| of.obstacle).collect();
        let explained = Explained { look, boxes: &outlines, foot, lamp, robot };
        let added = explained.complete(&foreign, &shapes, &mut boxes);
        boxes.extend(explained.unseen_casters());
        let tightener = Tightener { photo: self.photo, map: self.map, look };
        for added in boxes.iter_mut().skip(outlines.len()) {
            *added = tightener.tighten(*added);
        }
        traces.extend(boxes.iter().skip(outlines.len()).map(|added| Trace::plain(added.rect)));
        traces.extend(of_shapes);
        traces.extend(added.iter().map(|added| Trace::plain(added.footprint.bounds())));
        shapes.extend(added);
        Found { boxes, shapes, leans, has_lines: foreign.has_lines, traces, known: None }
    }
}

/// Rectangles and the footprints of boxes that were found before.
fn with(rects: &[Rect], found: &[LeaningBox]) -> Vec<Rect> {
    rects.iter().copied().chain(found.iter().map(|seen| seen.base)).collect()
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
        let found = find(&photo, &map, look, None, Viewpoint::of(&photo, &map));
        assert_eq!((found.boxes.len(), found.leans), (1, Some(false)));
        let Rect { x0, y0, x1, y1 } = found.boxes[0].rect;
        for (edge, drawn) in [(x0, 0.6), (y0, 0.6), (x1, 0.9), (y1, 1.0)] {
            assert!((edge - drawn).abs() < 0.003, "{edge} {drawn}");
        }
    }
}
