//! Footprints and heights from two pictures at known poses [Alghannam, Sec. VI: a second camera for tall
//! obstacles and their shadows].
//!
//! ```text
//! photo A, camera A ─► sight ─┐
//!                             ├─► pair (where do they disagree?) ─► search ─► refine ─► footprints, heights
//! photo B, camera B ─► sight ─┘
//! ```
//! A point of the floor looks the same in both pictures, in light and in shadow; what is raised does
//! not lie where the floor's map says. Metres in the arena frame.
//!
//! Deviation: the paper only names the second camera; the method is ours.

mod disagreement;
mod exposure;
mod gain;
mod pair;
mod raised;
mod refine;
mod search;

#[cfg(test)]
mod tests;

use crate::geometry::{Arena, Point, Pose, wrap_angle};
use crate::scene::Obstacle;
use crate::vision::appearance::Look;
use crate::vision::camera::Camera;
use crate::vision::detect::{Detection, check, upright};
use crate::vision::error::VisionError;
use crate::vision::image::{Photo, Raster, check_picture};
use crate::vision::options::DetectOptions;
use crate::vision::plan_view::{PlanFrame, plan_view};
use crate::vision::robot::{self, RobotTop, Size};
use crate::vision::warning::Warning;
use pair::{Pair, Sight};
pub use raised::RaisedBox;
use refine::{Refined, refine};

/// Cameras nearer to each other than this share of their height see no heights.
const LEAST_BASELINE: f64 = 0.05;
/// Pictures that disagree on more of the floor than this are not of the same arena, or the cameras moved.
const MOST_DISAGREEMENT: f64 = 0.6;
/// More floor than this, square metres, without an explanation is worth a warning.
const MOST_UNEXPLAINED: f64 = 0.008;
/// Two sightings of the robot farther apart than this, metres, are not of the same thing.
const SAME_ROBOT: f64 = 0.03;

/// What was seen in two pictures.
#[derive(Clone, Debug, PartialEq)]
pub struct PairDetection {
    /// Obstacles with their heights, robot and warnings; corners are those of the first picture.
    pub detection: Detection,
    /// The pictures of the steps, if they were asked for.
    pub steps: Option<PairSteps>,
}

/// The pictures of the steps, in the plan view.
#[derive(Clone, Debug, PartialEq)]
pub struct PairSteps {
    /// Where the plan view's cells lie.
    pub frame: PlanFrame,
    /// Both plan views in linear light.
    pub views: [Raster<[f32; 3]>; 2],
    /// How surely the pictures disagree about a cell of the floor, 0 to 1.
    pub disagreement: Raster<f32>,
    /// Where the cameras stand over the floor.
    pub feet: [Point; 2],
    /// The boxes, and for each where its top appears in each view.
    pub boxes: Vec<(RaisedBox, [crate::geometry::Rect; 2])>,
}

/// Finds obstacles and robot in two photos of one arena by two calibrated cameras.
///
/// # Errors
/// [`VisionError::Camera`] if a camera does not belong to its photo, [`VisionError::Pair`] if two pictures
/// cannot show heights: parallel rays, cameras side by side, or pictures of two arenas.
///
/// ```
/// use wmr::geometry::{Arena, Point, Rect};
/// use wmr::vision::{Camera, CameraModel, DetectOptions, Photo, VisionError, detect_pair};
/// // Two cameras 2.5 m above a floor of 1.6 × 1.2 m, a box of 0.3 × 0.2 m on it, 0.3 m tall.
/// let camera = |x: f64| Camera {
///     model: CameraModel::Perspective,
///     image_size: [480, 360],
///     matrix: [[560.0, 0.0, 239.5], [0.0, 560.0, 179.5], [0.0, 0.0, 1.0]],
///     k1: 0.0,
///     rotation: [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]],
///     translation: [-x, 0.6, 2.5],
///     spread: None,
/// };
/// let (floor, raised) = (Rect::new(0.0, 0.0, 1.6, 1.2), Rect::new(0.6, 0.7, 0.9, 0.9));
/// let photo = |x: f64| {
///     let pixels = (0..480 * 360).map(|i| {
///         let (column, row) = (f64::from(i % 480), f64::from(i / 480));
///         let at = |height: f64| {
///             let share = (2.5 - height) / 560.0;
///             Point::new(x + share * (column - 239.5), 0.6 - share * (row - 179.5))
///         };
///         let on_box = |step: i32| raised.contains(at(0.01 * f64::from(step)));
///         match (0..=30).rev().find(|&step| on_box(step)) {
///             Some(30) => [90; 3],
///             Some(_) => [60; 3],
///             None if floor.contains(at(0.0)) => [200; 3],
///             None => [40; 3],
///         }
///     });
///     Photo::from_rgb(480, 360, pixels.collect())
/// };
/// let (a, b) = (photo(0.45)?, photo(1.15)?);
/// let arena = Arena { width: 1.6, height: 1.2 };
/// let seen = detect_pair([&a, &b], [&camera(0.45), &camera(1.15)], arena, &DetectOptions::default())?;
/// let [found] = seen.detection.obstacles.as_slice() else { panic!("one box") };
/// let rect = found.footprint.bounds();
/// assert!((rect.x0 - 0.6).abs() < 0.01 && (rect.y1 - 0.9).abs() < 0.01);
/// assert!(found.height.is_some_and(|height| (height - 0.3).abs() < 0.03));
/// # Ok::<(), VisionError>(())
/// ```
pub fn detect_pair(
    photos: [&Photo; 2],
    cameras: [&Camera; 2],
    arena: Arena,
    options: &DetectOptions,
) -> Result<PairDetection, VisionError> {
    check(arena, options.robot_radius)?;
    photos.into_iter().try_for_each(check_picture)?;
    let [a, b] = [0, 1].map(|eye| sight(photos[eye], cameras[eye], arena, options));
    let sights = [a?, b?];
    check_views(&sights)?;
    let pair = Pair::of(arena, &sights);
    let share = pair.disagreeing_share();
    if share > MOST_DISAGREEMENT {
        let percent = 100.0 * share;
        return Err(VisionError::Pair {
            reason: format!("the pictures disagree on {percent:.0} % of the floor"),
        });
    }
    let boxes = search::find(&pair);
    let refined: Vec<_> =
        boxes.iter().map(|&raised| refine(&sights, arena, &boxes, raised)).collect();
    let steps = options.keep_steps.then(|| steps(&sights, &pair, &refined));
    Ok(PairDetection {
        detection: Detection {
            obstacles: refined.iter().map(obstacle).collect(),
            corners_px: sights[0].map.seen_corners(arena),
            map: sights[0].map.clone(),
            robot: robot_pose(&sights, options),
            goal: None,
            confidence: 1.0 - share,
            warnings: unexplained(gain::Canvas::with(&pair, &boxes).unexplained()),
            steps: None,
        },
        steps,
    })
}

fn obstacle(seen: &Refined) -> Obstacle {
    Obstacle {
        height: Some(seen.raised.height),
        margin: seen.margin,
        ..upright(seen.raised.base).into()
    }
}

/// What to say of floor in square metres on which the pictures disagree without a box that explains it.
fn unexplained(area: f64) -> Vec<Warning> {
    (area > MOST_UNEXPLAINED).then_some(Warning::Unexplained { area }).into_iter().collect()
}

fn sight<'a>(
    photo: &'a Photo,
    camera: &Camera,
    arena: Arena,
    options: &DetectOptions,
) -> Result<Sight<'a>, VisionError> {
    let map = camera.plan_map(photo)?;
    let view = camera.viewpoint().ok_or_else(|| VisionError::Pair {
        reason: "an orthographic camera sees no heights".into(),
    })?;
    let look = Look::at(photo, &map, arena).ok_or(VisionError::Corners)?;
    let robot = robot::find(
        photo,
        &map,
        &look,
        Size::known(options.robot_radius, view.enlargement(options.robot_height)),
    );
    Ok(Sight { photo, map, view, look, robot })
}

fn check_views(sights: &[Sight; 2]) -> Result<(), VisionError> {
    let [a, b] = sights.each_ref().map(|sight| sight.view);
    let (apart, height) = (a.foot.distance(b.foot), a.height.min(b.height));
    if height <= 0.0 {
        return Err(VisionError::Pair {
            reason: format!("a camera stands {height:.2} m above the floor"),
        });
    }
    if apart < LEAST_BASELINE * height {
        let least = LEAST_BASELINE * height;
        return Err(VisionError::Pair {
            reason: format!(
                "the cameras stand {apart:.2} m apart, at least {least:.2} m are needed"
            ),
        });
    }
    Ok(())
}

/// The robot, by the sightings that agree, or else by the surer one.
fn robot_pose(sights: &[Sight; 2], options: &DetectOptions) -> Option<Pose> {
    let seen = |sight: &Sight| {
        let RobotTop { centre, heading, certainty, .. } = sight.robot?;
        let (foot, lean) = (sight.view.foot, raised::lean(sight.view, options.robot_height));
        let position =
            Point::new(foot.x + (centre.x - foot.x) / lean, foot.y + (centre.y - foot.y) / lean);
        Some((certainty, Pose { position, heading }))
    };
    let mut poses: Vec<(f64, Pose)> = sights.iter().filter_map(seen).collect();
    poses.sort_by(|a, b| b.0.total_cmp(&a.0));
    let (_, first) = *poses.first()?;
    match poses.get(1) {
        Some((_, second)) if second.position.distance(first.position) < SAME_ROBOT => {
            let (p, q) = (first.position, second.position);
            let half_turn = 0.5 * (second.heading - first.heading).sin();
            let position = Point::new((p.x + q.x) / 2.0, (p.y + q.y) / 2.0);
            Some(Pose { position, heading: wrap_angle(first.heading + half_turn) })
        }
        _ => Some(first),
    }
}

fn steps(sights: &[Sight; 2], pair: &Pair, found: &[refine::Refined]) -> PairSteps {
    let tops = |raised: RaisedBox| pair.views.map(|view| raised.seen(view).top(view.foot));
    PairSteps {
        frame: pair.frame,
        views: sights.each_ref().map(|sight| plan_view(sight.photo, &sight.map, &pair.frame)),
        disagreement: pair.disagreement.clone(),
        feet: pair.views.map(|view| view.foot),
        boxes: found.iter().map(|seen| (seen.raised, tops(seen.raised))).collect(),
    }
}
