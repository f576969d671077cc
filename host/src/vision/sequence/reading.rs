//! What is known from the pictures before, and how it changes with the next one.

use super::blocks::{Blocks, Changes, SIDE};
use super::nearby::{self, NearbyRobot};
use super::windows;
use crate::geometry::{Arena, Pose, Rect};
use crate::vision::boxes::{Known, LeaningBox, find_within};
use crate::vision::camera::PlanMap;
use crate::vision::detect::{Detection, Thing, Whole, things};
use crate::vision::empty::over_even_floor;
use crate::vision::image::{Photo, Raster};
use crate::vision::options::DetectOptions;

/// The floor is looked at this far beyond the arena, metres.
const BEYOND: f64 = 0.05;
/// Windows that hold more than this share of the floor are no cheaper than a whole picture.
const MOST_READ: f64 = 0.5;
/// A thing nearer than this to the edge of its window may be cut by it, metres.
const CUT: f64 = 0.02;
/// Light that has changed by more than this share of the codes changes what floor and shadow look like.
const SAME_LIGHT: f32 = 0.03;
/// Each so many-th picture one of the slices is read whatever it shows; so many of them across and up.
const SLICE_EVERY: usize = 5;
const SLICES: (usize, usize) = (4, 3);
/// A robot that shows no mark where it is expected is looked for everywhere in each so many-th picture.
const SEARCHED_EVERY: usize = 20;

/// What is known from the pictures before.
#[derive(Clone, Debug)]
pub(super) struct Reading {
    arena: Arena,
    detection: Detection,
    known: Known,
    whole: Whole,
    things: Vec<Thing>,
    /// How each block looked when its place was last read, in the light of the whole reading.
    blocks: Blocks,
    /// The floor that each block shows, if any.
    places: Vec<Option<Rect>>,
    /// Pictures since the last whole reading.
    count: usize,
}

impl Reading {
    /// What a whole picture tells.
    pub(super) fn new(
        photo: &Photo,
        arena: Arena,
        detection: Detection,
        mut whole: Whole,
        known: Known,
    ) -> Self {
        Self {
            arena,
            known,
            things: std::mem::take(&mut whole.things),
            whole,
            blocks: Blocks::of(photo),
            places: places(photo, &detection.map, arena),
            detection,
            count: 0,
        }
    }

    /// What the next picture shows, in which the robot is expected at `expected`; `None` if its changes do not settle
    /// that.
    pub(super) fn next(
        &mut self,
        taken: &Photo,
        expected: Pose,
        options: &DetectOptions,
    ) -> Option<Detection> {
        if [taken.width(), taken.height()] != self.whole.size {
            return None;
        }
        let blocks = Blocks::of(taken);
        let Changes { changed, gain } = blocks.changes(&self.blocks);
        if gain.iter().any(|gain| (gain - 1.0).abs() > SAME_LIGHT) {
            return None;
        }
        let even = match &options.empty {
            Some(empty) => Some(over_even_floor(taken, empty, &self.detection.map, self.arena)?),
            None => None,
        };
        let photo = even.as_ref().unwrap_or(taken);
        let robot = self.robot((photo, taken), expected, options)?;
        let windows = self.windows(&changed, &robot)?;
        let stands = self.stands(photo, &robot, options);
        self.things = self.read(photo, &windows, (&robot, stands))?;
        self.count += 1;
        let is_taken = self.blocks_in(&windows, changed.width());
        self.blocks.take(&blocks, gain, &is_taken);
        let obstacles = self.things.iter().map(|thing| thing.obstacle.clone()).collect();
        Some(Detection { obstacles, robot: Some(stands), ..self.detection.clone() })
    }

    /// The robot near where it is expected, or there if it has no mark; `None` if it must be looked for elsewhere.
    fn robot(
        &self,
        photos: (&Photo, &Photo),
        expected: Pose,
        options: &DetectOptions,
    ) -> Option<NearbyRobot> {
        let known = (&self.detection.map, &self.known);
        nearby::robot(photos, known, options, expected).or_else(|| {
            let may_be_elsewhere = self.whole.is_marked || self.count >= SEARCHED_EVERY;
            (!may_be_elsewhere).then(|| NearbyRobot::told(expected, options))
        })
    }

    /// Where a robot stands.
    fn stands(&self, photo: &Photo, robot: &NearbyRobot, options: &DetectOptions) -> Pose {
        let leans = self.known.leans.unwrap_or(true);
        let view = self.whole.viewpoint.filter(|view| view.knows_height || leans);
        let picture = (photo, &self.detection.map);
        robot.seen.stands(picture, options.robot_body(), options.robot_tag_mount, view)
    }

    /// The windows that are to be read; `None` if they are no cheaper than the whole.
    fn windows(&self, changed: &Raster<bool>, robot: &NearbyRobot) -> Option<Vec<Rect>> {
        let mut to_read = self.changed_places(changed);
        to_read.push(robot.surroundings);
        to_read.extend(slice(self.arena, self.count + 1));
        let extents: Vec<Rect> = self.things.iter().map(|thing| thing.trace.extent).collect();
        let windows = windows::around(&to_read, &extents);
        (share(&windows, self.arena) <= MOST_READ).then_some(windows)
    }

    /// The things in some windows, and those elsewhere as they were; `None` if they are not settled.
    fn read(
        &self,
        photo: &Photo,
        windows: &[Rect],
        (robot, stands): (&NearbyRobot, Pose),
    ) -> Option<Vec<Thing>> {
        let is_in = |thing: &&Thing, window: &Rect| window.overlaps(thing.trace.extent);
        let is_read = |thing: &&Thing| windows.iter().any(|window| is_in(thing, window));
        let mut all: Vec<Thing> =
            self.things.iter().filter(|thing| !is_read(thing)).cloned().collect();
        let mut left_out = self.whole.left_out.clone();
        left_out.extend(robot.covered.iter().cloned());
        for window in windows {
            let inside = || self.things.iter().filter(|thing| is_in(thing, window));
            let before: Vec<LeaningBox> =
                inside().filter_map(|thing| thing.trace.searched).collect();
            let picture = (photo, &self.detection.map);
            let view = (Some(robot.top.above(stands.position)), self.whole.viewpoint);
            let found = find_within(picture, &self.known, (*window, &left_out), view, &before);
            let seen = things(found);
            let is_whole = |thing: &Thing| !is_cut(thing.trace.extent, *window, self.arena);
            if seen.len() != inside().count() || !seen.iter().all(is_whole) {
                return None;
            }
            all.extend(seen);
        }
        Some(all)
    }

    /// The floor that changed blocks show, one rectangle around each patch of them.
    fn changed_places(&self, changed: &Raster<bool>) -> Vec<Rect> {
        let width = changed.width();
        let shown = Raster::from_fn(width, changed.height(), |column, row| {
            let index = row * width + column;
            changed.cells()[index] && self.places[index].is_some()
        });
        let (regions, count) = shown.regions(true);
        let mut around: Vec<Option<Rect>> = vec![None; count + 1];
        for (region, place) in regions.cells().iter().zip(&self.places) {
            if let (Some(of), Some(place), true) =
                (around.get_mut(*region as usize), place, *region > 0)
            {
                *of = Some(of.map_or(*place, |rect| rect.union(*place)));
            }
        }
        around.into_iter().flatten().collect()
    }

    /// The blocks that show nothing but floor in some windows.
    fn blocks_in(&self, windows: &[Rect], width: usize) -> Raster<bool> {
        let is_in = |place: &Option<Rect>| {
            place.is_some_and(|place| windows.iter().any(|window| window.union(place) == *window))
        };
        Raster::from_cells(width, self.places.iter().map(is_in).collect())
    }
}

/// Whether the edge of a window may cut what it shows: an edge beyond the arena cuts nothing.
fn is_cut(extent: Rect, window: Rect, arena: Arena) -> bool {
    (extent.x0 < window.x0 + CUT && window.x0 > 0.0)
        || (extent.y0 < window.y0 + CUT && window.y0 > 0.0)
        || (extent.x1 > window.x1 - CUT && window.x1 < arena.width)
        || (extent.y1 > window.y1 - CUT && window.y1 < arena.height)
}

/// The slice that is read in a picture by its number, if any.
fn slice(arena: Arena, count: usize) -> Option<Rect> {
    let number = count.is_multiple_of(SLICE_EVERY).then_some(count / SLICE_EVERY)?;
    let (column, row) = (number % SLICES.0, number / SLICES.0 % SLICES.1);
    let (width, height) = (arena.width / SLICES.0 as f64, arena.height / SLICES.1 as f64);
    let (x, y) = (column as f64 * width, row as f64 * height);
    Some(Rect::new(x, y, x + width, y + height))
}

/// How much of the floor windows hold.
fn share(windows: &[Rect], arena: Arena) -> f64 {
    let floor = Rect::new(0.0, 0.0, arena.width, arena.height).widened([BEYOND; 4]);
    let held = |window: &Rect| {
        let (x0, x1) = (window.x0.max(floor.x0), window.x1.min(floor.x1));
        let (y0, y1) = (window.y0.max(floor.y0), window.y1.min(floor.y1));
        (x1 - x0).max(0.0) * (y1 - y0).max(0.0)
    };
    windows.iter().map(held).sum::<f64>() / floor.area()
}

/// The floor that each block of a photo shows, of those that show any.
fn places(photo: &Photo, map: &PlanMap, arena: Arena) -> Vec<Option<Rect>> {
    let floor = Rect::new(0.0, 0.0, arena.width, arena.height).widened([BEYOND; 4]);
    let (columns, rows) = (photo.width() / SIDE, photo.height() / SIDE);
    let place = |index: usize| {
        let (x, y) = ((index % columns * SIDE) as f64 - 0.5, (index / columns * SIDE) as f64 - 0.5);
        let side = SIDE as f64;
        let corners = [[x, y], [x + side, y], [x + side, y + side], [x, y + side]];
        let rect = Rect::around(&corners.map(|pixel| map.to_floor(pixel)));
        rect.overlaps(floor).then_some(rect)
    };
    (0..columns * rows).map(place).collect()
}
