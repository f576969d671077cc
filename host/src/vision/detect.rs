//! From a photo to obstacles in metres: the flow of vision in one function.

use crate::geometry::{Arena, Point, Pose, Rect};
use crate::scene::Obstacle;
use crate::shape::Shape;
use crate::vision::appearance::Look;
use crate::vision::border::check_arena;
use crate::vision::boxes::{self, Bounded, Found, Known, Trace, lined_sides};
use crate::vision::camera::{PlanMap, Viewpoint};
use crate::vision::empty::{check_still, over_even_floor};
use crate::vision::error::VisionError;
use crate::vision::floor_clarity::FloorClarity;
use crate::vision::image::Photo;
use crate::vision::locate::{Located, locate};
use crate::vision::marks::Marks;
use crate::vision::options::{DetectOptions, Method};
use crate::vision::paper::{Steps, paper_rectangles, steps};
use crate::vision::robot::{self, RobotTop, SeenRobot};
use crate::vision::tags;
use crate::vision::warning::Warning;

/// The paper's obstacles need no plan view in colour; to find the robot its radius has so many cells.
const ROBOT_CELLS: f64 = 10.0;
/// Nothing is thinner, metres.
const LEAST_WIDTH: f64 = 0.002;
/// A robot whose place is less sure than this is worth a warning, metres.
const MUCH_DOUBT: f64 = 0.005;
/// With strips along so many sides the border that was found is not the floor's.
const LINED_SIDES: usize = 3;

/// What was seen in a photo. Metres and radians in the arena frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Detection {
    /// The obstacles, each with how much further out its edges may lie.
    pub obstacles: Vec<Obstacle>,
    /// The arena's corners 0..3 in the photo, pixels.
    pub corners_px: [[f64; 2]; 4],
    /// Where floor points are in the photo.
    pub map: PlanMap,
    /// The robot, if it is in the picture.
    pub robot: Option<Pose>,
    /// Where a tag marks the goal.
    pub goal: Option<Point>,
    /// How surely the arena was found and its floor lets boxes be told from it, 0 to 1.
    pub confidence: f64,
    /// What the user should know about this answer.
    pub warnings: Vec<Warning>,
    /// The pictures of the steps, if they were asked for.
    pub steps: Option<Steps>,
}

/// Finds the arena, the obstacles and the robot in a photo.
///
/// # Errors
/// A refusal that says what was measured, what is needed and what to do: see [`VisionError`].
///
/// ```
/// use wmr::geometry::{Arena, Rect};
/// use wmr::vision::{DetectOptions, Photo, detect};
/// // 100 pixels a metre: a dark frame around 2.0 × 1.2 m of floor with one box.
/// let pixels = (0..240 * 160).map(|i| {
///     let (x, y) = (i % 240, i / 240);
///     let floor = (20..220).contains(&x) && (20..140).contains(&y);
///     let frame = (16..224).contains(&x) && (16..144).contains(&y) && !floor;
///     let dark = frame || (60..100).contains(&x) && (40..80).contains(&y);
///     if dark { [30; 3] } else { [230; 3] }
/// });
/// let photo = Photo::from_rgb(240, 160, pixels.collect())?;
/// let seen = detect(&photo, Arena { width: 2.0, height: 1.2 }, &DetectOptions::default())?;
/// let [seen_box] = seen.obstacles.as_slice() else { panic!("one box") };
/// let Rect { x0, y0, x1, y1 } = seen_box.footprint.bounds();
/// for (found, drawn) in [(x0, 0.4), (y0, 0.6), (x1, 0.8), (y1, 1.0)] {
///     assert!((found - drawn).abs() < 0.005);
/// }
/// # Ok::<(), wmr::vision::VisionError>(())
/// ```
pub fn detect(
    photo: &Photo,
    arena: Arena,
    options: &DetectOptions,
) -> Result<Detection, VisionError> {
    detect_whole(photo, arena, options).map(|(detection, ..)| detection)
}

/// What was found in a photo and helps with the next one by the same camera.
#[derive(Clone, Debug)]
pub(super) struct Whole {
    /// What stands on the floor, in the order of the obstacles.
    pub(super) things: Vec<Thing>,
    /// Where nothing is an obstacle, but for the robot's tag.
    pub(super) left_out: Vec<Shape>,
    pub(super) viewpoint: Option<Viewpoint>,
    /// Whether the robot shows its tag or disc.
    pub(super) is_marked: bool,
    /// The photo's width and height, pixels.
    pub(super) size: [usize; 2],
}

/// An obstacle and where it is seen.
#[derive(Clone, Debug)]
pub(super) struct Thing {
    pub(super) obstacle: Obstacle,
    pub(super) trace: Trace,
}

/// The things that were found, boxes first.
pub(super) fn things(found: Found) -> Vec<Thing> {
    let upright = |seen: Bounded| Bounded { rect: upright(seen.rect), ..seen }.obstacle();
    let obstacles = found.boxes.into_iter().map(upright).chain(found.shapes);
    let whole = obstacles.zip(found.traces);
    whole.map(|(obstacle, trace)| Thing { obstacle, trace }).collect()
}

/// The same as [`detect`], with what helps with the next photo and what is known of floor and light.
pub(super) fn detect_whole(
    photo: &Photo,
    arena: Arena,
    options: &DetectOptions,
) -> Result<(Detection, Whole, Option<Known>), VisionError> {
    check(arena, options.robot_radius)?;
    if let Some(empty) = &options.empty {
        check_still(photo, empty)?;
    }
    let marks = Marks::of(photo, options);
    let Located { map, confidence, mut warnings } = locate(photo, arena, options, &marks)?;
    let empty = options.empty.as_ref().filter(|_| options.method == Method::Robust);
    let even = empty.and_then(|empty| over_even_floor(photo, empty, &map, arena));
    let picture = Picture { taken: photo, even: even.as_ref(), map: &map, arena, options };
    let left_out = marks.left_out(&map, &options.ignored);
    let mut look = picture.look()?;
    look.leave_out(left_out.clone());
    let clarity = FloorClarity::of(&look.floor);
    warnings.extend(clarity.warning());
    warnings.extend(marks.missing(options));
    let marked = picture.marked_robot(&marks, &look);
    let seen = marked.or(options.robot_at.map(SeenRobot::Told));
    let steps =
        options.keep_steps.then(|| steps(picture.photo(), &map, arena, options.robot_radius));
    let viewpoint = picture.viewpoint();
    let mut found = picture.obstacles(look, seen, viewpoint, &left_out);
    // Boxes that stand upright in the picture tell that the camera is far away.
    let from = viewpoint.filter(|view| view.knows_height || found.leans.unwrap_or(true));
    let robot = seen.map(|seen| picture.stands(seen, from));
    warnings.extend(found.leans.is_none().then(|| picture.doubt(seen, from)).flatten());
    warnings.extend(found.has_lines.then_some(Warning::FloorLines));
    picture.check_border(&found)?;
    let known = found.known.take();
    let things = things(found);
    let detection = Detection {
        obstacles: things.iter().map(|thing| thing.obstacle.clone()).collect(),
        goal: marks.goal.as_ref().map(|tag| map.to_floor(tag.centre_px())),
        corners_px: map.seen_corners(arena),
        robot,
        confidence: confidence * clarity.certainty(),
        warnings,
        steps,
        map,
    };
    let left_out = marks.left_out_at_rest(&detection.map, &options.ignored);
    let size = [photo.width(), photo.height()];
    let is_marked = marked.is_some();
    let whole = Whole { things, left_out, viewpoint, is_marked, size };
    Ok((detection, whole, known))
}

/// A photo in which the floor has been found.
#[derive(Clone, Copy)]
struct Picture<'a> {
    /// As it was taken.
    taken: &'a Photo,
    /// As it would be over an even floor, if a picture of the empty arena tells.
    even: Option<&'a Photo>,
    map: &'a PlanMap,
    arena: Arena,
    options: &'a DetectOptions,
}

impl Picture<'_> {
    /// What obstacles are looked for in.
    fn photo(&self) -> &Photo {
        self.even.unwrap_or(self.taken)
    }

    /// What the floor looks like.
    fn look(&self) -> Result<Look, VisionError> {
        let (photo, map, arena) = (self.photo(), self.map, self.arena);
        let look = match self.options.method {
            Method::Robust if self.even.is_some() => Look::at_even_floor(photo, map, arena),
            Method::Robust => Look::at(photo, map, arena),
            Method::Paper => Look::no_finer(photo, map, arena, self.robot_cells()),
        };
        look.ok_or(VisionError::Corners)
    }

    fn robot_cells(&self) -> f64 {
        ROBOT_CELLS / self.options.robot_radius
    }

    /// The robot by its tag or disc.
    fn marked_robot(&self, marks: &Marks, look: &Look) -> Option<SeenRobot> {
        match &marks.robot {
            Some(tag) => Some(SeenRobot::Tag(tags::pose(tag, self.map))),
            None => self.top(look).map(SeenRobot::Disc),
        }
    }

    /// The robot whose disc is seen; over an evened floor also in the photo as it was taken, by fewer cells.
    fn top(&self, look: &Look) -> Option<RobotTop> {
        let size = self.options.robot_body().top_size(self.options.camera.as_ref());
        robot::find(self.photo(), self.map, look, size).or_else(|| {
            self.even?;
            let rough = Look::no_finer(self.taken, self.map, self.arena, self.robot_cells())?;
            robot::find(self.taken, self.map, &rough, size)
        })
    }

    /// Where the camera is, as its file says or the border shows.
    fn viewpoint(&self) -> Option<Viewpoint> {
        match &self.options.camera {
            Some(camera) => camera.viewpoint(),
            None => Viewpoint::of(self.photo(), self.map),
        }
    }

    fn obstacles(
        &self,
        look: Look,
        robot: Option<SeenRobot>,
        viewpoint: Option<Viewpoint>,
        left_out: &[Shape],
    ) -> Found {
        let (photo, map) = (self.photo(), self.map);
        let top = robot.map(|seen| {
            let top = seen.top(self.options.robot_body(), self.options.robot_tag_mount);
            top.above(self.stands(seen, viewpoint).position)
        });
        match self.options.method {
            Method::Paper => Found::plain(paper_rectangles(photo, map, self.arena, top, left_out)),
            Method::Robust => boxes::find(photo, map, look, top, viewpoint),
        }
    }

    /// Where a robot stands.
    fn stands(&self, seen: SeenRobot, from: Option<Viewpoint>) -> Pose {
        let mount = self.options.robot_tag_mount;
        seen.stands((self.photo(), self.map), self.options.robot_body(), mount, from)
    }

    /// What to say of a robot whose place is a guess.
    fn doubt(&self, seen: Option<SeenRobot>, from: Option<Viewpoint>) -> Option<Warning> {
        let (Some(SeenRobot::Disc(top)), Some(view)) =
            (seen, from.filter(|view| !view.knows_height))
        else {
            return None;
        };
        let doubt = self.options.robot_body().doubt(self.photo(), self.map, top, view);
        (doubt > MUCH_DOUBT).then_some(Warning::RobotPlace { doubt })
    }

    /// Refuses a border that was searched for and along which nothing but strips were found.
    fn check_border(&self, found: &Found) -> Result<(), VisionError> {
        let DetectOptions { map, camera, corners, tags, .. } = self.options;
        let is_told = map.is_some() || camera.is_some() || corners.is_some() || tags.is_some();
        let rects: Vec<Rect> = found.boxes.iter().map(|seen| seen.rect).collect();
        let is_odd = !is_told && lined_sides(&rects, self.arena) >= LINED_SIDES;
        let odd = VisionError::OddBorder { arena: self.arena, ratio: None };
        if is_odd { Err(odd) } else { Ok(()) }
    }
}

/// The same rectangle with its edges in order: edges of a sliver may be measured past each other, and
/// what was seen stays an obstacle.
pub(crate) fn upright(Rect { x0, y0, x1, y1 }: Rect) -> Rect {
    let ordered = |a: f64, b: f64| {
        let grown = if (b - a).abs() < LEAST_WIDTH { LEAST_WIDTH / 2.0 } else { 0.0 };
        (a.min(b) - grown, a.max(b) + grown)
    };
    let ((x0, x1), (y0, y1)) = (ordered(x0, x1), ordered(y0, y1));
    Rect::new(x0, y0, x1, y1)
}

/// Whether arena and robot are possible.
pub(crate) fn check(arena: Arena, radius: f64) -> Result<(), VisionError> {
    check_arena(arena)?;
    let fits = radius > 0.0 && radius < arena.width.min(arena.height) / 2.0;
    if fits { Ok(()) } else { Err(VisionError::RobotRadius(radius)) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_that_passed_each_other_are_put_in_order() {
        let Rect { x0, y0, x1, y1 } = upright(Rect::new(1.2, 0.5, 1.1, 0.5));
        assert_eq!((x0, x1), (1.1, 1.2));
        assert!((y0 - 0.499).abs() < 1e-12 && (y1 - 0.501).abs() < 1e-12);
    }

    #[test]
    fn impossible_requests_are_refused() {
        let photo = Photo::from_rgb(64, 64, vec![[9; 3]; 4096]).unwrap();
        let detect = |width, radius| {
            let options = DetectOptions { robot_radius: radius, ..DetectOptions::default() };
            super::detect(&photo, Arena { width, height: 1.0 }, &options)
        };
        for width in [0.0, -1.0, f64::NAN, f64::INFINITY, 50.0] {
            assert!(matches!(detect(width, 0.075), Err(VisionError::ArenaSize(_))), "{width}");
        }
        assert!(matches!(detect(1.0, f64::NAN), Err(VisionError::RobotRadius(_))));
        let corners = Some([[f64::NAN; 2]; 4]);
        let options = DetectOptions { corners, ..DetectOptions::default() };
        assert!(super::detect(&photo, Arena { width: 1.0, height: 1.0 }, &options).is_err());
    }
}
