//! The scene: arena, obstacles, robot radius, start and goal, and its file format.
//!
//! It stands between vision, which makes one, and the grid method, which plans on it; it can be
//! edited by hand and used instead of the photo. Metres and radians in the arena frame.

mod file;

use crate::geometry::{Arena, Point, Pose, Rect};
use crate::shape::{Shape, ShapeError};
use crate::vision::Detection;
use file::SceneFile;
pub use file::SceneWithMargins;
use serde::{Deserialize, Serialize};

/// The robot radius of the paper's experiment, metres [Alghannam, Sec. V]; used where no input names one.
pub const DEFAULT_ROBOT_RADIUS: f64 = 0.075;

/// An arena with its obstacles: what the planner knows of the world.
///
/// In memory all points are in the arena frame. In a file with an `origin` they are in the frame of the
/// map that the scene comes from: reading and writing move them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(try_from = "SceneFile", into = "SceneFile")]
pub struct Scene {
    /// Names the format in which the scene is written.
    pub format: SceneFormat,
    /// The floor's size.
    pub arena: Arena,
    /// Where the arena's lower left corner lies in the frame of the map that the scene comes from,
    /// metres; `None` where the arena frame is the only one.
    pub origin: Option<Point>,
    /// The radius of the disc that covers the robot, metres.
    pub robot_radius: f64,
    /// The obstacles; errors and pictures count them from 1.
    pub obstacles: Vec<Obstacle>,
    /// Where the robot stands, if known.
    pub start: Option<Pose>,
    /// Where the robot is to go, if known.
    pub goal: Option<Goal>,
    /// Start and goal pairs of a benchmark arena.
    pub queries: Vec<Query>,
}

/// Something that the robot must not touch.
#[derive(Clone, Debug, PartialEq)]
pub struct Obstacle {
    /// What it covers of the floor.
    pub footprint: Shape,
    /// How much further out its left, lower, right and upper edge may lie, metres; for shapes other than
    /// upright rectangles all four are the same.
    pub margin: [f64; 4],
    /// How high it is, metres, if known.
    pub height: Option<f64>,
}

impl Obstacle {
    /// The margin as one number, metres: the largest of the four.
    pub fn largest_margin(&self) -> f64 {
        self.margin.into_iter().fold(0.0, f64::max)
    }

    /// How far a point is from all that it may cover, footprint and margins, metres; 0 inside.
    ///
    /// ```
    /// use wmr::{geometry::{Point, Rect}, scene::Obstacle};
    /// let seen = Obstacle { margin: [0.01; 4], ..Rect::new(0.2, 0.2, 0.4, 0.6).into() };
    /// assert!((seen.distance(Point::new(0.5, 0.3)) - 0.09).abs() < 1e-12);
    /// ```
    pub fn distance(&self, point: Point) -> f64 {
        match self.footprint.as_rect() {
            Some(rect) => rect.widened(self.margin).distance(point),
            None => (self.footprint.distance(point) - self.largest_margin()).max(0.0),
        }
    }
}

impl<T: Into<Shape>> From<T> for Obstacle {
    /// An obstacle whose edges are known exactly.
    fn from(footprint: T) -> Self {
        Self { footprint: footprint.into(), margin: [0.0; 4], height: None }
    }
}

/// The tag at the head of a scene file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SceneFormat {
    /// One arena with at most one start and one goal.
    Scene,
    /// One arena with many queries.
    Arena,
}

/// Where the robot is to go, and which way it shall look there, if that matters.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(try_from = "Vec<f64>", into = "Vec<f64>")]
pub struct Goal {
    /// The goal's position, metres.
    pub position: Point,
    /// The heading on arrival, radians; `None` leaves it to the last leg.
    pub heading: Option<f64>,
}

/// One start and goal of a benchmark arena, with the exact length where known.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Query {
    /// Where the way begins, metres.
    pub start: Point,
    /// Where the way ends, metres.
    pub goal: Point,
    /// The exact shortest length among the box-enlarged obstacles, metres.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub length: Option<f64>,
}

/// Why a scene cannot be used.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum SceneError {
    /// The text is not JSON of the scene format.
    #[error("this is no scene: {0}")]
    #[diagnostic(help("see the README for the scene format"))]
    Format(#[from] serde_json::Error),
    /// A number is not finite, or not in its range.
    #[error("{what} is {value}")]
    #[diagnostic(help("{need}"))]
    Value {
        /// The field.
        what: &'static str,
        /// What it holds.
        value: f64,
        /// What it must hold.
        need: &'static str,
    },
    /// An obstacle is no shape.
    #[error("obstacle {number}: {why}")]
    #[diagnostic(forward(why))]
    Shape {
        /// The obstacle, counted from 1.
        number: usize,
        /// What is wrong with it.
        why: ShapeError,
    },
    /// A polygon or disc has no part in the arena.
    #[error(
        "obstacle {number} lies outside the arena: it reaches from ({:.3}, {:.3}) to ({:.3}, {:.3}) m",
        .bounds.x0, .bounds.y0, .bounds.x1, .bounds.y1
    )]
    #[diagnostic(help("move it into the arena, or leave it out"))]
    Outside {
        /// The obstacle, counted from 1.
        number: usize,
        /// The rectangle around it.
        bounds: Rect,
    },
    /// A margin is no distance, or one of four where the shape takes a single one.
    #[error("the margin of obstacle {number} is {value} m")]
    #[diagnostic(help("it must be finite and at least 0"))]
    Margin {
        /// The obstacle, counted from 1.
        number: usize,
        /// What was given, metres.
        value: f64,
    },
    /// Four margins for a shape that has no left, lower, right and upper edge.
    #[error("obstacle {number} is no upright rectangle, so its margin is one number, not four")]
    #[diagnostic(help("give one number, the distance by which its outline may lie farther out"))]
    FourMargins {
        /// The obstacle, counted from 1.
        number: usize,
    },
    /// There are more margins than obstacles, or fewer.
    #[error("there are {margins} margins for {obstacles} obstacles")]
    #[diagnostic(help("give one for each, or none at all"))]
    MarginCount {
        /// How many margins there are.
        margins: usize,
        /// How many obstacles there are.
        obstacles: usize,
    },
}

impl Scene {
    /// An empty arena of `width` × `height` metres with the paper's robot.
    pub fn new(width: f64, height: f64) -> Self {
        Self {
            format: SceneFormat::Scene,
            arena: Arena { width, height },
            origin: None,
            robot_radius: DEFAULT_ROBOT_RADIUS,
            obstacles: Vec::new(),
            start: None,
            goal: None,
            queries: Vec::new(),
        }
    }

    /// The scene that was seen in a photo of an `arena`, for a robot of `robot_radius` metres: it starts
    /// where the robot was seen, and goes to the tag that marks the goal.
    pub fn from_detection(detection: &Detection, arena: Arena, robot_radius: f64) -> Self {
        let obstacles = detection.obstacles.clone();
        let start = detection.robot;
        let goal = detection.goal.map(|position| Goal { position, heading: None });
        Self { robot_radius, obstacles, start, goal, ..Self::new(arena.width, arena.height) }
    }

    /// Reads a scene from the text of a `wmr-scene/2`, `wmr-scene/1` or `wmr-arena/1` file.
    ///
    /// # Errors
    /// [`SceneError`] if the text is not of the format or a number in it makes no sense.
    ///
    /// ```
    /// let scene = wmr::scene::Scene::from_json(
    ///     r#"{"format": "wmr-scene/2", "arena": {"width": 2, "height": 1}, "obstacles": [
    ///         [0.5, 0, 1, 0.5], {"circle": [1.4, 0.5, 0.1]}, {"polygon": [[0, 0], [0.3, 0], [0, 0.3]]}
    ///     ]}"#,
    /// )?;
    /// assert_eq!(scene.obstacles.len(), 3);
    /// # Ok::<(), wmr::scene::SceneError>(())
    /// ```
    pub fn from_json(text: &str) -> Result<Self, SceneError> {
        serde_json::from_str::<SceneFile>(text)?.try_into()
    }

    /// Makes sure that every number makes sense; [`from_json`](Self::from_json) has done so.
    ///
    /// # Errors
    /// [`SceneError`] with the first that does not.
    pub fn check(&self) -> Result<(), SceneError> {
        positive("arena.width", self.arena.width)?;
        positive("arena.height", self.arena.height)?;
        if !(self.robot_radius >= 0.0 && self.robot_radius.is_finite()) {
            return Err(SceneError::Value {
                what: "robot_radius",
                value: self.robot_radius,
                need: "it must be at least 0 and finite",
            });
        }
        let start = self.start.map(|pose| [pose.position.x, pose.position.y, pose.heading]);
        let goal =
            self.goal.map(|goal| [goal.position.x, goal.position.y, goal.heading.unwrap_or(0.0)]);
        for (what, numbers) in [("start", start), ("goal", goal)] {
            if let Some(&value) = numbers.iter().flatten().find(|value| !value.is_finite()) {
                return Err(SceneError::Value { what, value, need: "it must be finite" });
            }
        }
        let floor = Rect::new(0.0, 0.0, self.arena.width, self.arena.height);
        let numbered = self.obstacles.iter().enumerate();
        numbered
            .map(|(index, obstacle)| (index + 1, obstacle))
            .try_for_each(|(number, obstacle)| check_obstacle(obstacle, floor, number))
    }
}

fn check_obstacle(obstacle: &Obstacle, floor: Rect, number: usize) -> Result<(), SceneError> {
    let Obstacle { footprint, margin, .. } = obstacle;
    footprint.check().map_err(|why| SceneError::Shape { number, why })?;
    if let Some(&value) = margin.iter().find(|metres| !(metres.is_finite() && **metres >= 0.0)) {
        return Err(SceneError::Margin { number, value });
    }
    // Rectangles outside have always been allowed: map tools and older files leave some behind.
    if footprint.as_rect().is_none() {
        let bounds = footprint.bounds();
        if !bounds.overlaps(floor) {
            return Err(SceneError::Outside { number, bounds });
        }
        if margin.iter().any(|&edge| edge != margin[0]) {
            return Err(SceneError::FourMargins { number });
        }
    }
    Ok(())
}

impl Scene {
    /// The same scene with all points `x` and `y` metres further.
    fn moved_by(&self, x: f64, y: f64) -> Self {
        let point = |at: Point| Point::new(at.x + x, at.y + y);
        let pose = |at: Pose| Pose { position: point(at.position), ..at };
        let goal = |at: Goal| Goal { position: point(at.position), ..at };
        let obstacle =
            |of: &Obstacle| Obstacle { footprint: of.footprint.moved_by(x, y), ..of.clone() };
        let query = |of: &Query| Query { start: point(of.start), goal: point(of.goal), ..*of };
        Self {
            obstacles: self.obstacles.iter().map(obstacle).collect(),
            start: self.start.map(pose),
            goal: self.goal.map(goal),
            queries: self.queries.iter().map(query).collect(),
            ..self.clone()
        }
    }
}

fn positive(what: &'static str, value: f64) -> Result<(), SceneError> {
    if value > 0.0 && value.is_finite() {
        Ok(())
    } else {
        Err(SceneError::Value { what, value, need: "it must be above 0 and finite" })
    }
}

impl TryFrom<Vec<f64>> for Goal {
    type Error = String;

    fn try_from(numbers: Vec<f64>) -> Result<Self, String> {
        match *numbers.as_slice() {
            [x, y] => Ok(Self { position: Point::new(x, y), heading: None }),
            [x, y, heading] => Ok(Self { position: Point::new(x, y), heading: Some(heading) }),
            _ => Err(format!("a goal has 2 or 3 numbers, not {}", numbers.len())),
        }
    }
}

impl From<Goal> for Vec<f64> {
    fn from(goal: Goal) -> Self {
        let mut numbers = vec![goal.position.x, goal.position.y];
        numbers.extend(goal.heading);
        numbers
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_written_scene_reads_back_equal() {
        let mut scene = Scene::new(1.6, 2.0);
        scene.obstacles.push(Rect::new(0.1, 0.2, 0.3, 0.4).into());
        scene.start = Some(Pose::new(0.2, 0.3, 1.0));
        scene.goal = Some(Goal { position: Point::new(1.0, 1.5), heading: None });
        let text = serde_json::to_string(&scene).unwrap();
        assert_eq!(Scene::from_json(&text).unwrap(), scene);
    }

    #[test]
    fn a_scene_of_a_map_is_written_in_the_frame_of_the_map() {
        let mut scene = Scene::new(2.0, 1.0);
        scene.origin = Some(Point::new(-1.0, -0.5));
        scene.obstacles.push(Rect::new(0.25, 0.5, 0.75, 1.0).into());
        scene.start = Some(Pose::new(0.5, 0.25, 1.0));
        let text = serde_json::to_string(&scene).unwrap();
        assert!(text.contains(r#""origin":[-1.0,-0.5]"#), "{text}");
        assert!(text.contains(r#""obstacles":[[-0.75,0.0,-0.25,0.5]]"#), "{text}");
        assert!(text.contains(r#""start":[-0.5,-0.25,1.0]"#), "{text}");
        assert_eq!(Scene::from_json(&text).unwrap(), scene);
    }

    #[test]
    fn a_rectangle_turned_inside_out_is_refused_with_its_value() {
        let text = r#"{"format":"wmr-scene/1","arena":{"width":2,"height":1},"obstacles":[[1,0,0.5,0.5]]}"#;
        let error = Scene::from_json(text).unwrap_err();
        assert!(error.to_string().contains("0.5"), "{error}");
    }

    #[test]
    fn an_arena_without_size_is_refused() {
        let text = r#"{"format":"wmr-scene/1","arena":{"width":0,"height":1},"obstacles":[]}"#;
        assert!(matches!(
            Scene::from_json(text),
            Err(SceneError::Value { what: "arena.width", .. })
        ));
    }
}
