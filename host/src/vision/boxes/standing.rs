//! Where the boxes of an explanation stand: footprints to a fraction of a pixel, with margins.
//!
//! A camera sees the outline of a box that leans; where it stands is an inference from its sides and its shadow.
//! Where the camera's height is only a guess, margins therefore reach over the whole outline: what anybody sees
//! in the photo is never passed through, be it the top of a box or a lid that overhangs. A camera that is known
//! (`--camera`) keeps them as narrow as edges and lean are sure. Metres in the arena frame.

use super::evidence::coarse_scale;
use super::find::{Picture, Scene, Trace};
use super::footprint::without_floor;
use super::implausible::{fades_into_floor, is_faint_floor, is_part_of_robot, is_part_of_wall};
use super::light::Lamp;
use super::projection::LeaningBox;
use super::refine::{Bounded, Sharpener};
use super::widening::reaching_over;
use crate::geometry::{Arena, Point, Rect};

/// A footprint of which more than this share is plain floor is wrong.
const MOST_FLOOR: f64 = 0.5;

/// A box that stands there: its outline, its footprint with margins, and where it is seen.
#[derive(Clone, Copy)]
pub(super) struct Standing {
    pub(super) outline: LeaningBox,
    pub(super) bounded: Bounded,
    pub(super) trace: Trace,
}

impl Picture<'_> {
    /// The boxes of an explanation that can be some, each with where it is seen.
    pub(super) fn all_standing(&self, Scene { boxes, foot, lamp, .. }: Scene) -> Vec<Standing> {
        let tools = self.sharpener(foot, lamp.is_some());
        let arena = self.look.frame.arena;
        let middle = Point::new(arena.width / 2.0, arena.height / 2.0);
        let is_floor = |seen: &LeaningBox| {
            let outline = seen.bounds(foot.unwrap_or(middle));
            fades_into_floor(outline, self.look) || is_faint_floor(outline, self.look)
        };
        let is_guessed = self.viewpoint.is_some_and(|view| !view.knows_height);
        let extent = |seen: &LeaningBox| Self::extent(seen, foot, lamp);
        let standing = |searched: LeaningBox| {
            let (outline, bounded) = self.standing(&tools, searched)?;
            let bounded = match foot.filter(|_| is_guessed) {
                Some(foot) => reaching_over(inside(arena, outline.bounds(foot)), bounded),
                None => bounded,
            };
            let extent = extent(&outline).union(extent(&searched));
            let trace = Trace { extent, searched: Some(searched) };
            let is_kept = !is_part_of_wall(bounded.rect, arena)
                && !is_part_of_robot(bounded.rect, self.robot);
            is_kept.then_some(Standing { outline, bounded, trace })
        };
        boxes.into_iter().filter(|seen| !is_floor(seen)).filter_map(standing).collect()
    }

    /// A box with its edges to a fraction of a pixel and without the floor that is seen in its footprint.
    /// One that was mostly floor, or of which no side is seen without it, does not lean: it is what remains of
    /// its outline without floor, if anything.
    fn standing(&self, tools: &Sharpener<'_>, seen: LeaningBox) -> Option<(LeaningBox, Bounded)> {
        let (measured, bounded) = tools.sharpen(seen);
        // What two measures do not agree on explains nothing that is seen beside the footprint.
        let seen = LeaningBox { lean: measured.lean.min(seen.lean), ..measured };
        let stands = without_floor(bounded.rect, self.look);
        let large = |rect: &Rect| rect.area() > MOST_FLOOR * bounded.rect.area();
        match stands.filter(large) {
            Some(rect) if rect == bounded.rect => return Some((seen, bounded)),
            Some(rect) if tools.shown_lean(LeaningBox { base: rect, ..seen }).is_some() => {
                return Some((LeaningBox { base: rect, ..seen }, Bounded { rect, ..bounded }));
            }
            _ => {}
        }
        let outline = tools.foot.map_or(seen.base, |foot| seen.bounds(foot));
        let flat = LeaningBox { base: without_floor(outline, self.look)?, lean: 1.0 };
        Some(Sharpener { foot: None, lit: false, ..*tools }.sharpen(flat))
    }

    /// The tools for the edges of boxes that lean away from `foot`, `lit` by a known lamp.
    pub(super) fn sharpener(&self, foot: Option<Point>, lit: bool) -> Sharpener<'_> {
        let foot_error = self.viewpoint.map_or(0.0, |view| view.spread);
        let (photo, map, look) = (self.photo, self.map, self.look);
        Sharpener { photo, map, look, foot, foot_error, coarse: coarse_scale(look), lit }
    }

    /// The bounds of the outline and of the shadow of a box.
    fn extent(seen: &LeaningBox, foot: Option<Point>, lamp: Option<Lamp>) -> Rect {
        let outline = foot.map_or(seen.base, |foot| seen.bounds(foot));
        let shadow = lamp.and_then(|lamp| Some(lamp.shadow(*seen)?.bounds(lamp.foot)));
        shadow.map_or(outline, |shadow| outline.union(shadow))
    }
}

/// The part of an outline that lies inside the arena: a gap beyond leads nowhere.
fn inside(Arena { width, height }: Arena, Rect { x0, y0, x1, y1 }: Rect) -> Rect {
    Rect::new(x0.max(0.0), y0.max(0.0), x1.min(width), y1.min(height))
}
