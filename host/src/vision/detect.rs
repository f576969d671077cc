//! From a photo to obstacles in metres: the flow of vision in one function.

use crate::geometry::{Arena, Point, Pose, Rect};
use crate::scene::Obstacle;
use crate::shape::Circle;
use crate::vision::appearance::Look;
use crate::vision::border::{self, check_arena, given};
use crate::vision::boxes::{self, Bounded, Found, lined_sides};
use crate::vision::camera::{Camera, PlanMap, Viewpoint};
use crate::vision::empty::{check_still, over_even_floor};
use crate::vision::error::VisionError;
use crate::vision::image::{Photo, check_overview};
use crate::vision::marks::{Marks, known_top};
use crate::vision::paper::{Steps, paper_rectangles, steps};
use crate::vision::robot::{self, RobotTop};
use crate::vision::tags::{self, TagPoint};

/// The robot radius of the paper's experiment, metres [Alghannam, Sec. V].
const PAPER_RADIUS: f64 = 0.075;
/// The paper's obstacles need no plan view in colour; to find the robot its radius has so many cells.
const ROBOT_CELLS: f64 = 10.0;
/// Shadow deeper than this looks like dark boxes, a floor that varies more hides boxes (logarithms).
const DEEP_SHADOW: f32 = -0.75;
const UNEVEN_FLOOR: f32 = 0.04;
/// Without boxes, the robot's top this much larger than its disc tells that things lean.
const LEANING_ROBOT: f64 = 1.03;
/// The height of the robot's top above the floor, metres, if nobody says.
const USUAL_ROBOT_HEIGHT: f64 = 0.07;
/// Nothing is thinner, metres.
const LEAST_WIDTH: f64 = 0.002;
/// Of light's greatest change near the border, the least share at the place where a camera has it. Where low walls hide
/// or shade the border it falls to 0.28; 12 pixels beside it is mostly below 0.1.
const LEAST_SEEN: f64 = 0.25;
/// With strips along so many sides the border that was found is not the floor's.
const LINED_SIDES: usize = 3;
/// A border that fits worse than this many pixels is worth a warning.
const ROUGH_BORDER: f64 = 0.8;

/// What to say of lines that were taken for floor.
const FLOOR_LINES: &str = "thin lines from one side of the arena to the other are taken for lines on the floor: if they are walls, the plan goes through them";

/// How obstacles are told from the floor.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Method {
    /// By a model of the floor's colour.
    #[default]
    Robust,
    /// By the paper's edges and near-white floor [Alghannam, Sec. II].
    Paper,
}

/// What the caller knows and wants.
#[derive(Clone, Debug, PartialEq)]
pub struct DetectOptions {
    /// How obstacles are told from the floor.
    pub method: Method,
    /// The arena's corners in the photo, pixels: lower left, lower right, upper right, upper left.
    /// They are sought if not given.
    pub corners: Option<[[f64; 2]; 4]>,
    /// The camera, if it is calibrated; corners are then not looked for.
    pub camera: Option<Camera>,
    /// Which point of the tags in the arena's corners is its corner, if there are such tags.
    pub tags: Option<TagPoint>,
    /// The number of the tag on the robot's top, if it has one: its right edge points ahead.
    pub robot_tag: Option<usize>,
    /// The number of a tag that lies where the robot is to go.
    pub goal_tag: Option<usize>,
    /// Where the robot stands if it has no mark: what is seen there is the robot.
    pub robot_at: Option<Pose>,
    /// Places where nothing is an obstacle.
    pub ignored: Vec<Circle>,
    /// The radius of the robot's disc, metres.
    pub robot_radius: f64,
    /// The height of the robot's top above the floor, metres.
    pub robot_height: f64,
    /// Whether the pictures of the steps are kept.
    pub keep_steps: bool,
    /// A picture of the empty arena by the same camera, which has not moved since: the floor is then what it
    /// shows. The paper's method does without.
    pub empty: Option<Photo>,
}

impl Default for DetectOptions {
    fn default() -> Self {
        Self {
            method: Method::Robust,
            corners: None,
            camera: None,
            tags: None,
            robot_tag: None,
            goal_tag: None,
            robot_at: None,
            ignored: Vec::new(),
            robot_radius: PAPER_RADIUS,
            robot_height: USUAL_ROBOT_HEIGHT,
            keep_steps: false,
            empty: None,
        }
    }
}

/// What was seen in a photo. Metres and radians in the arena frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Detection {
    /// The obstacles, each with how much further out its edges may lie.
    pub obstacles: Vec<Obstacle>,
    /// The arena's corners 0..3 in the photo, pixels.
    pub corners_px: [[f64; 2]; 4],
    /// The robot, if it is in the picture.
    pub robot: Option<Pose>,
    /// Where a tag marks the goal.
    pub goal: Option<Point>,
    /// How surely the arena was found, 0 to 1.
    pub confidence: f64,
    /// What the user should know about this answer.
    pub warnings: Vec<String>,
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
    check(arena, options.robot_radius)?;
    let mut warnings = Vec::new();
    if let Some(empty) = &options.empty {
        check_still(photo, empty)?;
    }
    let marks = Marks::of(photo, options);
    let (map, confidence) = locate(photo, arena, options, &marks, &mut warnings)?;
    let empty = options.empty.as_ref().filter(|_| options.method == Method::Robust);
    let even = empty.and_then(|empty| over_even_floor(photo, empty, &map, arena));
    let taken = photo;
    let photo = even.as_ref().unwrap_or(taken);
    let look = match options.method {
        Method::Robust => Look::at(photo, &map, arena),
        Method::Paper => Look::no_finer(photo, &map, arena, ROBOT_CELLS / options.robot_radius),
    };
    let mut look = look.ok_or(VisionError::Corners)?;
    let left_out = marks.left_out(&map, &options.ignored);
    look.leave_out(left_out.clone());
    warnings
        .extend(hard_floor(look.floor.spread[0], look.floor.shadow.map(|shadow| shadow.offset[0])));
    let tagged = marks.robot.as_ref().map(|tag| tags::pose(tag, &map));
    let radius = options.robot_radius;
    let marked = match tagged {
        Some(pose) => Some(known_top(pose, radius)),
        None => robot::find(photo, &map, &look, radius).or_else(|| {
            even.as_ref()?;
            let rough = Look::no_finer(taken, &map, arena, ROBOT_CELLS / radius)?;
            robot::find(taken, &map, &rough, radius)
        }),
    };
    let top = marked.or(options.robot_at.map(|pose| known_top(pose, radius)));
    warnings.extend(marks.missing(options));
    let steps = options.keep_steps.then(|| steps(photo, &map, arena, options.robot_radius));
    let viewpoint = match &options.camera {
        Some(camera) => camera.viewpoint(),
        None => Viewpoint::of(photo, &map),
    };
    let found = match options.method {
        Method::Paper => {
            let boxes = paper_rectangles(photo, &map, arena, top, &left_out);
            Found { boxes, shapes: Vec::new(), leans: None, has_lines: false }
        }
        Method::Robust => boxes::find(photo, &map, look, top, viewpoint),
    };
    let robot = top.map(|top| {
        let viewpoint = viewpoint.filter(|_| leans(&found, top, options));
        match (tagged, options.robot_at) {
            (Some(seen), _) => tag_pose(seen, options, viewpoint),
            (None, Some(pose)) if marked.is_none() => pose,
            (None, _) => robot_pose(photo, &map, options, viewpoint, top),
        }
    });
    let rects: Vec<Rect> = found.boxes.iter().map(|seen| seen.rect).collect();
    warnings.extend(found.has_lines.then(|| FLOOR_LINES.into()));
    let sought = options.camera.is_none() && options.corners.is_none() && options.tags.is_none();
    if sought && lined_sides(&rects, arena) >= LINED_SIDES {
        return Err(VisionError::OddBorder { arena, ratio: None });
    }
    let boxes: Vec<Bounded> =
        found.boxes.into_iter().map(|seen| Bounded { rect: upright(seen.rect), ..seen }).collect();
    Ok(Detection {
        obstacles: boxes.iter().map(Bounded::obstacle).chain(found.shapes).collect(),
        goal: marks.goal.as_ref().map(|tag| map.to_floor(tag.centre_px())),
        corners_px: map.seen_corners(arena),
        robot,
        confidence,
        warnings,
        steps: steps.filter(|_| options.keep_steps),
    })
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

/// The map from floor to photo, by camera, by corners or by the border, and how sure it is.
///
/// A photo with faults is refused here, where a small copy of it is at hand.
fn locate(
    photo: &Photo,
    arena: Arena,
    options: &DetectOptions,
    marks: &Marks,
    warnings: &mut Vec<String>,
) -> Result<(PlanMap, f64), VisionError> {
    let small = photo.reduced(photo.overview_factor());
    check_overview(&small)?;
    if let Some(camera) = &options.camera {
        let map = camera.plan_map(photo)?;
        let seen = border_seen(photo, &map, arena);
        warnings.extend(moved_camera(seen));
        return Ok((map, if seen < LEAST_SEEN { seen } else { 1.0 }));
    }
    if let Some(corners) = options.corners {
        return Ok((given(photo, arena, corners)?, 1.0));
    }
    if let Some(point) = options.tags {
        return Ok((given(photo, arena, tags::corners(&marks.corners(), point)?)?, 1.0));
    }
    let border = match &options.empty {
        // Nothing stands before its border.
        Some(empty) => border::find(empty, &empty.reduced(empty.overview_factor()), arena)?,
        None => border::find(photo, &small, arena)?,
    };
    warnings.extend(rough_border(border.residual));
    Ok((border.map, border.score))
}

/// Whether what stands on the floor leans: boxes tell, and without any the size of the robot's top.
fn leans(found: &Found, top: RobotTop, options: &DetectOptions) -> bool {
    found.leans.unwrap_or(top.radius / options.robot_radius > LEANING_ROBOT)
}

/// The pose of the robot whose top is seen; with a viewpoint the top appears beside its foot.
fn robot_pose(
    photo: &Photo,
    map: &PlanMap,
    options: &DetectOptions,
    viewpoint: Option<Viewpoint>,
    top: RobotTop,
) -> Pose {
    let lean = viewpoint.map(|view| {
        let guess = robot_lean(view, options, top.radius / options.robot_radius);
        let shown = || robot::shown_lean(photo, map, top, view.foot, options.robot_radius);
        let lean = if knows_height(options) { None } else { shown() };
        (view.foot, lean.unwrap_or(guess))
    });
    Pose {
        position: lean.map_or(top.centre, |(foot, lean)| lowered(top.centre, foot, lean)),
        heading: top.heading,
    }
}

/// The pose of the robot whose tag is seen at a pose on the floor's plane: it lies as high as the top.
fn tag_pose(seen: Pose, options: &DetectOptions, viewpoint: Option<Viewpoint>) -> Pose {
    let position = viewpoint.map_or(seen.position, |view| {
        let lean = view.height / (view.height - options.robot_height).max(1e-3);
        lowered(seen.position, view.foot, lean)
    });
    Pose { position, ..seen }
}

/// How much larger the robot's top looks than its base: by the camera's height if that is known, else
/// by that guess and by the disc's size together.
fn robot_lean(view: Viewpoint, options: &DetectOptions, seen: f64) -> f64 {
    let by_height = view.height / (view.height - options.robot_height).max(1e-3);
    if knows_height(options) { by_height } else { (by_height + seen.clamp(1.0, 1.06)) / 2.0 }
}

fn knows_height(options: &DetectOptions) -> bool {
    options.camera.as_ref().is_some_and(Camera::knows_height)
}

/// The floor point under what appears at `point` on the robot's top.
fn lowered(point: Point, foot: Point, lean: f64) -> Point {
    Point::new(foot.x + (point.x - foot.x) / lean, foot.y + (point.y - foot.y) / lean)
}

/// What to say about a floor on which boxes may hide: `spread` of its brightness and depth of shadow
/// on it, natural logarithms.
fn hard_floor(spread: f32, shadow: Option<f32>) -> Option<String> {
    let deep = shadow.is_some_and(|depth| depth < DEEP_SHADOW);
    let advice =
        "boxes that look like floor or shadow may be missed or misplaced; check the obstacles";
    (deep || spread > UNEVEN_FLOOR).then(|| {
        let depth = f64::from(shadow.unwrap_or(0.0)).exp();
        format!(
            "the floor's brightness varies by {:.0} %, shadow leaves {:.0} % of it: {advice}",
            100.0 * spread,
            100.0 * depth
        )
    })
}

/// How clearly the border is seen where a map has it, 0 to 1: on all sides but the least clear one.
fn border_seen(photo: &Photo, map: &PlanMap, arena: Arena) -> f64 {
    let mut shown = border::shown(photo, map, arena);
    shown.sort_by(f64::total_cmp);
    shown[1]
}

/// What to say about a border that is seen so clearly where the camera has it.
fn moved_camera(seen: f64) -> Option<String> {
    let warning = "the border is not seen where the camera file has it: the camera may have moved; calibrate it again";
    (seen < LEAST_SEEN).then(|| warning.into())
}

/// What to say about a border that fits badly.
fn rough_border(residual: f64) -> Option<String> {
    let advice = "straighten the tape or give --corners";
    (residual > ROUGH_BORDER)
        .then(|| format!("the border fits a rectangle only to {residual:.1} pixels; {advice}"))
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
