//! Vision's score on small ray-traced pictures whose truth is known (`tests/fixtures/scenes`).
//!
//! Truth comes from the renderer, not from vision. A score that gets better is never a fault; each may be worse than
//! today by the slack of its measure alone.
//!
//! ```text
//! cargo run --release -p wmr-tests --example vision_scores
//! ```

use crate::figures::Figure;
use crate::occupied::{inside, invented, missed, overlap, partners, strips, uncovered};
use serde_json::Value;
use std::path::PathBuf;
use wmr::geometry::{Arena, Pose, Rect};
use wmr::scene::Obstacle;
use wmr::vision::{Camera, DetectOptions, Photo, VisionError, decode, detect, detect_pair};

/// A measure: its name, its unit, and how much worse than today it may be. The slack is for other compilers
/// and processors, which change the last digits of sums over thousands of pixels and with them where a search ends.
const MEASURES: [(&str, &str, f64); 8] = [
    ("1 - IoU", "", 0.015),
    ("missed", "boxes", 0.0),
    ("invented", "boxes", 0.0),
    ("sticks out", "mm", 1.5),
    ("corners", "px", 0.1),
    ("robot", "mm", 1.0),
    ("heading", "deg", 1.0),
    ("height", "mm", 5.0),
];

/// What a picture's measures are today; see [`MEASURES`]. The last three are 0 where there is nothing to measure:
/// no robot, one camera.
type Scores = [f64; MEASURES.len()];

///
/// In hard light the outline of a small box with a rest of its shadow passes for a shape of its own
/// (L3_d03_robot, L3_d04_robot): the price of turned boxes and cut card that are taken as they are;
/// a rest of shadow beside a known lamp may pass for that of a box not seen (L3_d02_robot).
const TODAY: [(&str, Scores); 12] = [
    ("L1_d07_robot", [0.023, 0.0, 0.0, 0.0, 0.252, 1.259, 0.283, 0.0]),
    ("L2_d04_robot", [0.103, 0.0, 0.0, 8.293, 0.222, 4.436, 0.420, 0.0]),
    ("L2_d05", [0.134, 0.0, 1.0, 3.115, 0.126, 0.0, 0.0, 0.0]),
    ("L2_d07_robot", [0.0, 0.0, 0.0, 0.0, 0.112, 3.299, 0.209, 0.0]),
    ("two_lamps", [0.59, 1.0, 18.0, 83.517, 0.239, 0.0, 0.0, 0.0]),
    ("L3_d01", [0.306, 0.0, 1.0, 20.355, 2.118, 0.0, 0.0, 0.0]),
    ("L3_d02_robot", [0.314, 1.0, 5.0, 122.709, 0.225, UNSEEN, UNSEEN, 0.0]),
    ("L3_d03_robot", [0.263, 0.0, 2.0, 8.006, 1.179, 9.791, 2.221, 0.0]),
    ("L3_d04_robot", [0.213, 0.0, 0.0, 4.191, 0.199, 8.117, 0.430, 0.0]),
    ("L3_d05", [0.0, 0.0, 0.0, 0.0, 5.226, 0.0, 0.0, 0.0]),
    ("L3_d06_robot", [0.178, 1.0, 0.0, 343.591, 0.134, 0.295, 0.275, 0.0]),
    ("stereo_d02", [0.099, 1.0, 1.0, 268.891, 0.0, 4.188, 0.042, 20.702]),
];

/// In place of a pose error where the robot is not seen though it stands there, or seen where none is.
const UNSEEN: f64 = 999.0;

/// Whether a refusal gives the right reason.
type IsRight = fn(&VisionError) -> bool;

/// Pictures that are to be refused, and the refusal.
const REFUSED: [(&str, IsRight); 2] = [
    ("L4_d01", |error| {
        matches!(error, VisionError::NoContrast { .. } | VisionError::NoBorder { .. })
    }),
    ("L4_d03_robot", |error| {
        matches!(error, VisionError::OutOfView { .. } | VisionError::NoBorder { .. })
    }),
];

/// A picture, or a pair, and its truth.
struct Scene(Value);

impl Scene {
    fn folder() -> PathBuf {
        PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("fixtures/scenes")
    }

    fn read(name: &str) -> Self {
        let text = std::fs::read_to_string(Self::folder().join(format!("{name}.json"))).unwrap();
        let document: Value = serde_json::from_str(&text).unwrap();
        assert_eq!(document["format"], "arena-pictures/1");
        Self(document)
    }

    fn arena(&self) -> Arena {
        let [width, height] = numbers(&self.0["given"]["arena_size_m"]);
        Arena { width, height }
    }

    fn photos(&self) -> Vec<(Photo, &str)> {
        let one = |picture: &Value| {
            let file = Self::folder().join(picture["file"].as_str().unwrap());
            decode(&std::fs::read(file).unwrap()).unwrap()
        };
        let pictures = self.0["pictures"].as_array().unwrap();
        pictures.iter().map(|picture| (one(picture), picture["camera"].as_str().unwrap())).collect()
    }

    fn camera(&self, name: &str) -> Camera {
        serde_json::from_value(self.0["cameras"][name].clone()).unwrap()
    }

    fn boxes(&self) -> Vec<(Rect, f64)> {
        let boxes = self.0["truth"]["obstacles"].as_array().unwrap();
        let one = |of: &Value| {
            let [x0, y0, x1, y1] = numbers(&of["rect"]);
            (Rect { x0, y0, x1, y1 }, of["height"].as_f64().unwrap())
        };
        boxes.iter().map(one).collect()
    }

    fn scores(&self) -> Scores {
        let (arena, photos) = (self.arena(), self.photos());
        let options = DetectOptions::default();
        let seen = match &photos[..] {
            [(photo, _)] => detect(photo, arena, &options).unwrap(),
            [(a, first), (b, second)] => {
                let cameras = [self.camera(first), self.camera(second)];
                detect_pair([a, b], cameras.each_ref(), arena, &options).unwrap().detection
            }
            _ => panic!("one picture or two"),
        };
        let (truth, true_heights): (Vec<_>, Vec<_>) = self.boxes().into_iter().unzip();
        let corners: [[f64; 2]; 4] = std::array::from_fn(|corner| {
            numbers(&self.0["truth"]["corners_px"][photos[0].1][corner])
        });
        let apart =
            seen.corners_px.iter().zip(corners).map(|(a, b)| (a[0] - b[0]).hypot(a[1] - b[1]));
        let things: Vec<Vec<Rect>> =
            seen.obstacles.iter().map(|of| inside(&strips(&of.footprint), arena)).collect();
        let on_arena: Vec<Vec<Rect>> =
            things.iter().filter(|thing| !thing.is_empty()).cloned().collect();
        let found = on_arena.concat();
        let widened = |of: &Obstacle| {
            strips(&of.footprint)
                .into_iter()
                .map(|rect| rect.widened(of.margin))
                .collect::<Vec<_>>()
        };
        let covered: Vec<Rect> = seen.obstacles.iter().flat_map(widened).collect();
        let [place, turn] = self.robot_error(seen.robot);
        [
            1.0 - overlap(&truth, &found),
            missed(&truth, &found) as f64,
            invented(&truth, &on_arena) as f64,
            1000.0 * uncovered(&truth, &inside(&covered, arena)),
            apart.fold(0.0, f64::max),
            place,
            turn,
            {
                let pairs = partners(&truth, &things).into_iter().zip(true_heights);
                let off = pairs
                    .filter_map(|(at, height)| Some((seen.obstacles[at?].height? - height).abs()));
                1000.0 * off.fold(0.0, f64::max)
            },
        ]
    }

    /// Millimetres and degrees; [`UNSEEN`] if the robot is not seen where it stands, or seen where none is.
    fn robot_error(&self, seen: Option<Pose>) -> [f64; 2] {
        let truth = &self.0["truth"]["robot_pose"];
        match (seen, truth.is_null()) {
            (None, true) => [0.0; 2],
            (Some(seen), false) => {
                let [x, y, heading] = numbers(truth);
                let turn = (seen.heading - heading).to_degrees();
                let apart = (seen.position.x - x).hypot(seen.position.y - y);
                [1000.0 * apart, ((turn + 180.0).rem_euclid(360.0) - 180.0).abs()]
            }
            _ => [UNSEEN; 2],
        }
    }
}

fn numbers<const N: usize>(value: &Value) -> [f64; N] {
    std::array::from_fn(|index| value[index].as_f64().unwrap())
}

/// Every picture's name, what it shows, its scores of today and its scores now.
fn measured() -> Vec<(&'static str, String, Scores, Scores)> {
    let measure = |(name, today): (&'static str, Scores)| {
        let scene = Scene::read(name);
        let shows = scene.0["shows"].as_str().unwrap().to_owned();
        (name, shows, today, scene.scores())
    };
    std::thread::scope(|scope| {
        let threads = TODAY.map(|row| scope.spawn(move || measure(row)));
        threads.into_iter().map(|thread| thread.join().unwrap()).collect()
    })
}

/// The score table as figures, picture by picture.
pub fn measure() -> Vec<Figure> {
    let figures = measured().into_iter().flat_map(|(name, _, today, now)| {
        let each = MEASURES.into_iter().zip(today).zip(now);
        each.map(move |(((what, unit, slack), today), now)| {
            Figure::bounded(format!("{name}: {what}"), now, today + slack, unit)
        })
    });
    figures.collect()
}

/// The score table, a line for each picture.
pub fn table() -> String {
    let head: String = MEASURES.iter().map(|(what, ..)| format!("{what:>11}")).collect();
    let units: String = MEASURES.iter().map(|(_, unit, _)| format!("{unit:>11}")).collect();
    let lines = measured().into_iter().map(|(name, shows, _, now)| {
        let now: String = now.iter().map(|value| format!("{value:>11.3}")).collect();
        format!("{name:<14}{now}  {shows}\n")
    });
    format!("{:<14}{head}\n{:<14}{units}\n{}", "", "", lines.collect::<String>())
}

/// Whether every picture that is to be refused is refused for its own reason; else what happened.
///
/// # Errors
/// Names the first picture that was answered, or refused for another reason.
pub fn refusals() -> Result<(), String> {
    for (name, is_right) in REFUSED {
        let scene = Scene::read(name);
        match detect(&scene.photos()[0].0, scene.arena(), &DetectOptions::default()) {
            Err(error) if is_right(&error) => {}
            other => return Err(format!("{name}: {other:?}")),
        }
    }
    Ok(())
}
