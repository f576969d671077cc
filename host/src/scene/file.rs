//! How a scene is written: `wmr-scene/2`, and the older `wmr-scene/1` and `wmr-arena/1` that are read.
//!
//! Shapes and margins stand side by side in a file, as programs in many languages read them, and in one
//! [`Obstacle`] in memory. Points of a scene with an `origin` are in the frame of its map. Metres, radians.

use super::{DEFAULT_ROBOT_RADIUS, Goal, Obstacle, Query, Scene, SceneError, SceneFormat};
use crate::geometry::{Arena, Point, Pose, Rect};
use crate::shape::{Circle, Polygon, Shape};
use serde::de::{Error, MapAccess, SeqAccess, Visitor};
use serde::ser::SerializeMap;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::fmt;

/// A scene as it stands in a file.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(super) struct SceneFile {
    format: Format,
    arena: Arena,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    origin: Option<Point>,
    #[serde(default = "default_robot_radius")]
    robot_radius: f64,
    #[cfg_attr(test, schemars(with = "Vec<schema::Outline>"))]
    obstacles: Vec<Outline>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    margins: Option<Vec<MarginFile>>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    start: Option<Pose>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    goal: Option<Goal>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    queries: Vec<Query>,
}

/// The formats by their names.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
enum Format {
    #[serde(rename = "wmr-scene/2")]
    Scene,
    #[serde(rename = "wmr-scene/1")]
    SceneWithoutShapes,
    #[serde(rename = "wmr-arena/1")]
    Arena,
}

/// An obstacle's margin: four numbers for an upright rectangle, one for any other shape.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(untagged)]
enum MarginFile {
    Edges([f64; 4]),
    Around(f64),
}

/// A shape before anybody knows whether its numbers make one.
#[derive(Clone, Debug)]
struct Outline {
    numbers: Numbers,
    height: Option<f64>,
}

#[derive(Clone, Debug)]
enum Numbers {
    Rect(Rect),
    Polygon(Vec<Point>),
    Circle(Circle),
}

fn default_robot_radius() -> f64 {
    DEFAULT_ROBOT_RADIUS
}

impl TryFrom<SceneFile> for Scene {
    type Error = SceneError;

    fn try_from(file: SceneFile) -> Result<Self, SceneError> {
        let listed = file.margins.unwrap_or_default();
        let (margins, obstacles) = (listed.len(), file.obstacles.len());
        if margins != 0 && margins != obstacles {
            return Err(SceneError::MarginCount { margins, obstacles });
        }
        let margins = listed.into_iter().map(Some).chain(std::iter::repeat(None));
        let numbered = (1..).zip(file.obstacles.into_iter().zip(margins));
        let obstacles =
            numbered.map(|(number, (outline, margin))| obstacle(outline, margin, number));
        let scene = Self {
            format: match file.format {
                Format::Scene | Format::SceneWithoutShapes => SceneFormat::Scene,
                Format::Arena => SceneFormat::Arena,
            },
            arena: file.arena,
            origin: file.origin,
            robot_radius: file.robot_radius,
            obstacles: obstacles.collect::<Result<_, _>>()?,
            start: file.start,
            goal: file.goal,
            queries: file.queries,
        };
        let scene = match scene.origin {
            Some(origin) => scene.moved_by(-origin.x, -origin.y),
            None => scene,
        };
        scene.check()?;
        Ok(scene)
    }
}

fn obstacle(
    outline: Outline,
    margin: Option<MarginFile>,
    number: usize,
) -> Result<Obstacle, SceneError> {
    let footprint = match outline.numbers {
        Numbers::Rect(rect) => Shape::Rect(rect),
        Numbers::Circle(circle) => Shape::Circle(circle),
        Numbers::Polygon(corners) => {
            Polygon::new(corners).map_err(|why| SceneError::Shape { number, why })?.into()
        }
    };
    let margin = match margin {
        None => [0.0; 4],
        Some(MarginFile::Around(metres)) => [metres; 4],
        Some(MarginFile::Edges(_)) if footprint.as_rect().is_none() => {
            return Err(SceneError::FourMargins { number });
        }
        Some(MarginFile::Edges(edges)) => edges,
    };
    Ok(Obstacle { footprint, margin, height: outline.height })
}

impl From<Scene> for SceneFile {
    fn from(scene: Scene) -> Self {
        let scene = match scene.origin {
            Some(origin) => scene.moved_by(origin.x, origin.y),
            None => scene,
        };
        let has_margins = scene.obstacles.iter().any(|obstacle| obstacle.margin != [0.0; 4]);
        Self {
            format: match scene.format {
                SceneFormat::Scene => Format::Scene,
                SceneFormat::Arena => Format::Arena,
            },
            arena: scene.arena,
            origin: scene.origin,
            robot_radius: scene.robot_radius,
            margins: has_margins.then(|| margins(&scene.obstacles)),
            obstacles: scene.obstacles.into_iter().map(Outline::from).collect(),
            start: scene.start,
            goal: scene.goal,
            queries: scene.queries,
        }
    }
}

fn margins(obstacles: &[Obstacle]) -> Vec<MarginFile> {
    obstacles.iter().map(MarginFile::from).collect()
}

/// A scene that is written with a margin for every obstacle, even where all of them are 0.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(try_from = "SceneFile", into = "SceneFile")]
pub struct SceneWithMargins(
    /// The scene.
    pub Scene,
);

impl From<Scene> for SceneWithMargins {
    fn from(scene: Scene) -> Self {
        Self(scene)
    }
}

impl TryFrom<SceneFile> for SceneWithMargins {
    type Error = SceneError;

    fn try_from(file: SceneFile) -> Result<Self, SceneError> {
        Scene::try_from(file).map(Self)
    }
}

impl From<SceneWithMargins> for SceneFile {
    fn from(SceneWithMargins(scene): SceneWithMargins) -> Self {
        let margins = margins(&scene.obstacles);
        Self { margins: Some(margins), ..scene.into() }
    }
}

impl From<&Obstacle> for MarginFile {
    fn from(obstacle: &Obstacle) -> Self {
        match obstacle.footprint {
            Shape::Rect(_) => Self::Edges(obstacle.margin),
            Shape::Polygon(_) | Shape::Circle(_) => Self::Around(obstacle.largest_margin()),
        }
    }
}

impl From<Obstacle> for Outline {
    fn from(obstacle: Obstacle) -> Self {
        let numbers = match obstacle.footprint {
            Shape::Rect(rect) => Numbers::Rect(rect),
            Shape::Polygon(polygon) => Numbers::Polygon(polygon.corners().to_vec()),
            Shape::Circle(circle) => Numbers::Circle(circle),
        };
        Self { numbers, height: obstacle.height }
    }
}

impl Serialize for Outline {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        if let Numbers::Rect(rect) = self.numbers {
            return rect.serialize(serializer);
        }
        let mut map = serializer.serialize_map(None)?;
        match &self.numbers {
            Numbers::Rect(_) => {}
            Numbers::Polygon(corners) => map.serialize_entry("polygon", corners)?,
            Numbers::Circle(circle) => map.serialize_entry("circle", circle)?,
        }
        if let Some(height) = self.height {
            map.serialize_entry("height", &height)?;
        }
        map.end()
    }
}

impl<'de> Deserialize<'de> for Outline {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(OutlineVisitor)
    }
}

struct OutlineVisitor;

impl<'de> Visitor<'de> for OutlineVisitor {
    type Value = Outline;

    fn expecting(&self, out: &mut fmt::Formatter) -> fmt::Result {
        out.write_str(r#"[x0, y0, x1, y1], {"polygon": [[x, y], …]} or {"circle": [x, y, r]}"#)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut numbers: A) -> Result<Outline, A::Error> {
        let mut edges = [0.0; 4];
        for (index, edge) in edges.iter_mut().enumerate() {
            *edge = numbers.next_element()?.ok_or_else(|| Error::invalid_length(index, &self))?;
        }
        if numbers.next_element::<f64>()?.is_some() {
            return Err(Error::invalid_length(5, &self));
        }
        Ok(Outline { numbers: Numbers::Rect(edges.into()), height: None })
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Outline, A::Error> {
        let (mut numbers, mut height) = (None, None);
        while let Some(key) = map.next_key::<String>()? {
            match key.as_str() {
                "height" => height = map.next_value()?,
                "polygon" | "circle" if numbers.is_some() => {
                    return Err(Error::custom("an obstacle is one shape, this one names two"));
                }
                "polygon" => numbers = Some(Numbers::Polygon(map.next_value()?)),
                "circle" => numbers = Some(Numbers::Circle(map.next_value()?)),
                other => return Err(Error::unknown_field(other, &["polygon", "circle", "height"])),
            }
        }
        let numbers = numbers.ok_or_else(|| {
            Error::custom("an obstacle names no shape, neither a polygon nor a circle")
        })?;
        Ok(Outline { numbers, height })
    }
}

/// What an [`Outline`] looks like in a file, in the words that schemas are made from.
#[cfg(test)]
mod schema {
    #![allow(dead_code, reason = "only the schemas of these types are wanted")]

    use super::{Circle, Point, Rect};
    use schemars::JsonSchema;

    /// An obstacle: `[x0, y0, x1, y1]`, a polygon or a disc.
    #[derive(JsonSchema)]
    #[serde(untagged)]
    pub(super) enum Outline {
        Rect(Rect),
        Polygon(Polygon),
        Disc(Disc),
    }

    /// A simple polygon, its corners in either direction.
    #[derive(JsonSchema)]
    #[serde(deny_unknown_fields)]
    pub(super) struct Polygon {
        polygon: Vec<Point>,
        height: Option<f64>,
    }

    /// A disc: `[x, y, radius]`.
    #[derive(JsonSchema)]
    #[serde(deny_unknown_fields)]
    pub(super) struct Disc {
        circle: Circle,
        height: Option<f64>,
    }
}

#[cfg(test)]
mod tests {
    use crate::geometry::{Point, Rect};
    use crate::scene::{Obstacle, Scene, SceneError};
    use crate::shape::{Circle, Polygon, ShapeError};

    fn read(obstacles: &str, more: &str) -> Result<Scene, SceneError> {
        let head = r#""format":"wmr-scene/2","arena":{"width":2,"height":1}"#;
        Scene::from_json(&format!("{{{head},\"obstacles\":[{obstacles}]{more}}}"))
    }

    #[test]
    fn shapes_margins_and_heights_are_written_and_read_back() {
        let mut scene = Scene::new(2.0, 1.0);
        let triangle = [[0.0, 0.0], [0.5, 0.0], [0.0, 0.5]].map(Point::from).to_vec();
        scene.obstacles = vec![
            Obstacle { margin: [0.001, 0.0, 0.002, 0.0], ..Rect::new(1.0, 0.0, 1.5, 0.5).into() },
            Obstacle {
                margin: [0.003; 4],
                height: Some(0.1),
                ..Polygon::new(triangle).unwrap().into()
            },
            Circle { centre: Point::new(1.0, 0.75), radius: 0.125 }.into(),
        ];
        let text = serde_json::to_string(&scene).unwrap();
        assert!(text.contains(
            r#""obstacles":[[1.0,0.0,1.5,0.5],{"polygon":[[0.0,0.0],[0.5,0.0],[0.0,0.5]],"height":0.1},{"circle":[1.0,0.75,0.125]}]"#
        ), "{text}");
        assert!(text.contains(r#""margins":[[0.001,0.0,0.002,0.0],0.003,0.0]"#), "{text}");
        assert_eq!(Scene::from_json(&text).unwrap(), scene);
    }

    #[test]
    fn older_scenes_are_read_and_written_in_the_newer_format() {
        let old =
            r#"{"format":"wmr-scene/1","arena":{"width":2,"height":1},"obstacles":[[0,0,1,1]]}"#;
        let text = serde_json::to_string(&Scene::from_json(old).unwrap()).unwrap();
        assert!(text.starts_with(r#"{"format":"wmr-scene/2""#), "{text}");
        assert!(!text.contains("margins"), "{text}");
    }

    #[test]
    fn what_is_wrong_is_named_with_the_obstacle_s_number() {
        let box_and = |shape: &str| format!("[0,0,1,0.5],{shape}");
        let bow_tie = r#"{"polygon":[[0,0],[1,1],[1,0],[0,1]]}"#;
        assert!(matches!(
            read(&box_and(bow_tie), ""),
            Err(SceneError::Shape { number: 2, why: ShapeError::Crossing { edges: [0, 2] } })
        ));
        for (shape, words) in [
            (r#"{"polygon":[[0,0],[1,1]]}"#, "obstacle 2: a polygon has three corners"),
            (r#"{"circle":[1,1,0]}"#, "obstacle 2: its radius is 0 m"),
            (r#"{"circle":[5,5,1]}"#, "obstacle 2 lies outside the arena"),
            (r#"{"polygon":[[3,0],[4,0],[3,1]]}"#, "obstacle 2 lies outside the arena"),
            ("[0,0,1]", "[x0, y0, x1, y1]"),
            (r#"{"disc":[0,0,1]}"#, "unknown field `disc`"),
            (r#"{"height":1}"#, "names no shape"),
            (r#"{"circle":[1,0,1],"polygon":[]}"#, "one shape"),
        ] {
            let error = read(&box_and(shape), "").unwrap_err().to_string();
            assert!(error.contains(words), "{shape}: {error}");
        }
    }

    #[test]
    fn margins_that_make_no_sense_are_refused() {
        let disc = r#"{"circle":[1,0.5,0.1]}"#;
        for (obstacles, margins, words) in [
            ("[0,0,1,0.5]", "[[0.1,0.1,0.1,-1e9]]", "the margin of obstacle 1 is -1000000000 m"),
            ("[0,0,1,0.5]", "[0.1,0.1]", "2 margins for 1 obstacles"),
            (disc, "[[0.1,0.1,0.1,0.1]]", "one number, not four"),
        ] {
            let error =
                read(obstacles, &format!(",\"margins\":{margins}")).unwrap_err().to_string();
            assert!(error.contains(words), "{error}");
        }
        let scene = read(disc, ",\"margins\":[0.01]").unwrap();
        assert_eq!(scene.obstacles[0].margin, [0.01; 4]);
    }
}
