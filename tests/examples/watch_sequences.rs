//! Sequences of overhead pictures with known truth, looked at as a watched drive does: where the robot and the box
//! that moves are seen, how fast it moves, and whether the plan of each frame is free in the next.
//!
//! `cargo run --release -p wmr-tests --example watch_sequences -- FOLDER...`; a folder holds `sequence.json`
//! (`arena-pictures/1`) and the pictures that it names. With `--camera` its camera is known to vision.

use serde_json::Value;
use std::error::Error;
use std::path::Path;
use std::time::{Duration, Instant};
use wmr::geometry::{Arena, Point, Pose, Rect, wrap_angle};
use wmr::legs::{DEFAULT_LIMITS, LegOptions, from_wire};
use wmr::plan::{DRIVE_MARGINS, PlanOptions};
use wmr::protocol::motion::Timing;
use wmr::scene::{Goal, Obstacle, Scene};
use wmr::shape::Shape;
use wmr::vision::{Camera, DetectOptions, decode, detect};
use wmr::watch::{Eye, Floor, Hazard, Route, Router, Sight};

/// What moves is avoided where it will be within so many steps of so long, s.
const AHEAD: u32 = 8;
const STEP: f64 = 0.1;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let knows_camera = arguments.iter().any(|argument| argument == "--camera");
    for folder in arguments.iter().filter(|argument| !argument.starts_with("--")) {
        println!("{folder}");
        sequence(Path::new(folder), knows_camera)?;
    }
    Ok(())
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().into_iter().flatten().filter_map(Value::as_f64).collect()
}

fn pose(value: &Value) -> Option<Pose> {
    let [x, y, heading] = numbers(value).try_into().ok()?;
    Some(Pose::new(x, y, heading))
}

fn middle(shape: &Shape) -> Point {
    let bounds = shape.bounds();
    Point::new((bounds.x0 + bounds.x1) / 2.0, (bounds.y0 + bounds.y1) / 2.0)
}

/// What is given and true of a sequence.
struct Sequence {
    arena: Arena,
    radius: f64,
    goal: Goal,
    start: Pose,
    velocity: [f64; 2],
    frames: Vec<Frame>,
    camera: Option<Camera>,
}

/// What is true of a frame.
struct Frame {
    file: String,
    time: f64,
    robot: Option<Pose>,
    boxes: Vec<Rect>,
    moving: Option<Rect>,
}

fn read(folder: &Path, knows_camera: bool) -> Result<Sequence, Box<dyn Error>> {
    let text = std::fs::read_to_string(folder.join("sequence.json"))?;
    let json: Value = serde_json::from_str(&text)?;
    let given = &json["given"];
    let [width, height] = numbers(&given["arena_size_m"]).try_into().map_err(|_| "arena")?;
    let [x, y] = numbers(&given["goal"]).try_into().map_err(|_| "goal")?;
    let [vx, vy] = numbers(&json["truth"]["moving_obstacle"]["velocity_mps"])
        .try_into()
        .map_err(|_| "velocity")?;
    let rect = |thing: &Value| -> Option<Rect> {
        let [x0, y0, x1, y1] = numbers(&thing["rect"]).try_into().ok()?;
        Some(Rect::new(x0, y0, x1, y1))
    };
    let frame = |frame: &Value| {
        let things = frame["obstacles"].as_array().cloned().unwrap_or_default();
        Frame {
            file: frame["file"].as_str().unwrap_or_default().into(),
            time: frame["time_s"].as_f64().unwrap_or_default(),
            robot: pose(&frame["robot_pose"]),
            boxes: things.iter().filter_map(rect).collect(),
            moving: things.iter().find(|thing| thing["moving"] == true).and_then(rect),
        }
    };
    let camera: Camera = serde_json::from_value(json["cameras"]["main"].clone())?;
    Ok(Sequence {
        arena: Arena { width, height },
        radius: given["robot_radius_m"].as_f64().ok_or("radius")?,
        goal: Goal { position: Point::new(x, y), heading: None },
        start: pose(&given["start"]).ok_or("start")?,
        velocity: [vx, vy],
        frames: json["truth"]["frames"].as_array().into_iter().flatten().map(frame).collect(),
        camera: knows_camera.then_some(camera),
    })
}

fn sequence(folder: &Path, knows_camera: bool) -> Result<(), Box<dyn Error>> {
    let sequence = read(folder, knows_camera)?;
    let options = DetectOptions {
        robot_radius: sequence.radius,
        robot_at: Some(sequence.start),
        camera: sequence.camera.clone(),
        ..DetectOptions::default()
    };
    let mut eye: Option<Eye> = None;
    let (mut floor, mut expected) = (Floor::default(), Some(sequence.start));
    for (index, frame) in sequence.frames.iter().enumerate() {
        let photo = decode(&std::fs::read(folder.join(&frame.file))?)?;
        let began = Instant::now();
        let exposed = Duration::from_secs_f64(frame.time);
        let sight = match &mut eye {
            Some(eye) => eye.look(&photo, exposed, expected)?,
            None => {
                let seen = detect(&photo, sequence.arena, &options)?;
                eye = Some(Eye::new(photo, sequence.arena, options.clone(), &seen));
                Sight { exposed, robot: seen.robot, obstacles: seen.obstacles, relocated: false }
            }
        };
        let robot = sight.robot.or(expected);
        let at = robot.map(|pose| pose.position);
        floor.update(exposed, &sight.obstacles, (at, sequence.radius));
        let took = began.elapsed().as_secs_f64();
        report(&sequence, index, &sight, &floor);
        println!("  looked at for {:.0} ms", 1000.0 * took);
        expected = robot;
    }
    Ok(())
}

fn report(sequence: &Sequence, index: usize, sight: &Sight, floor: &Floor) {
    let Some(frame) = sequence.frames.get(index) else { return };
    print!("{:5.1} s", frame.time);
    match sight.robot.zip(frame.robot) {
        Some((seen, truth)) => print!(
            "  robot {:4.1} mm {:4.1}°",
            1000.0 * seen.position.distance(truth.position),
            wrap_angle(seen.heading - truth.heading).abs().to_degrees()
        ),
        None => print!("  robot not seen"),
    }
    if let Some(truth) = frame.moving {
        let there = middle(&Shape::Rect(truth));
        let off = |hazard: &Hazard| middle(&hazard.obstacle.footprint).distance(there);
        let hazards = floor.hazards();
        if let Some(seen) = hazards.iter().min_by(|a, b| off(a).total_cmp(&off(b))) {
            let [vx, vy] = sequence.velocity;
            let wrong = (seen.velocity[0] - vx).hypot(seen.velocity[1] - vy);
            print!("  box {:4.1} mm {:.3} m/s", 1000.0 * off(seen), wrong);
        }
    }
    let Some(next) = sequence.frames.get(index + 1) else { return };
    match planned(sequence, sight, frame, floor) {
        Some(route) => {
            let gap = gap(&route, sight.robot.or(frame.robot), next) - sequence.radius;
            print!("  plan {:.2} m, {:4.0} mm beside the next truth", route.length, 1000.0 * gap);
        }
        None => print!("  waits"),
    }
}

fn planned(sequence: &Sequence, sight: &Sight, frame: &Frame, floor: &Floor) -> Option<Route> {
    let from = sight.robot.or(frame.robot)?;
    let Arena { width, height } = sequence.arena;
    let router = Router {
        scene: Scene { robot_radius: sequence.radius, ..Scene::new(width, height) },
        goal: sequence.goal,
        plan: PlanOptions::default(),
        margins: DRIVE_MARGINS.to_vec(),
        legs: LegOptions { timing: Timing::Limits, reverse: true },
    };
    let keep = std::f64::consts::SQRT_2 * (sequence.radius + DRIVE_MARGINS[0]);
    let avoided = to_avoid(floor, from.position, keep);
    router.route(&avoided, from, (0.0, false), &DEFAULT_LIMITS).ok()
}

/// All that is there, and what moves wherever it will be within the next moments, but not less than `keep` around
/// the robot.
fn to_avoid(floor: &Floor, from: Point, keep: f64) -> Vec<Obstacle> {
    let mut avoided = floor.obstacles();
    for hazard in floor.hazards().into_iter().filter(Hazard::moves) {
        let [vx, vy] = hazard.velocity;
        let times = (1..=AHEAD).map(|step| STEP * f64::from(step));
        let later = times.map(|time| hazard.obstacle.footprint.moved_by(vx * time, vy * time));
        let free = later.filter(|footprint| footprint.distance(from) > keep);
        avoided.extend(free.map(|footprint| Obstacle { footprint, ..hazard.obstacle.clone() }));
    }
    avoided
}

/// The least distance of the way to what stands there in truth.
fn gap(route: &Route, from: Option<Pose>, frame: &Frame) -> f64 {
    let Some(from) = from else { return f64::INFINITY };
    let goals =
        route.legs.iter().map(|leg| from_wire(leg.intervals(&DEFAULT_LIMITS)[2].end()).position);
    let mut least = f64::INFINITY;
    let mut at = from.position;
    for goal in goals {
        for shape in frame.boxes.iter().map(|rect| Shape::Rect(*rect)) {
            least = shape.leg_distance(at, goal).min(least);
        }
        at = goal;
    }
    least
}
