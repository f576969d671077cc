//! Rendered pictures of a floor on which things move, come and go, read one after the other and each as a whole.
//!
//! Arena, robot and camera are those of [`crate::watched`]. Metres, seconds, radians, arena frame.

use crate::watched::{ARENA, HEIGHT, RADIUS, SIZE, TAG};
use hil_sim::base::TruePose;
use hil_sim::camera::{Camera, CameraFaults, Lens, Light, Look, Mark, Sensor, Stage};
use hil_sim::motion::{Motion, Mover};
use hil_sim::world::{Shape, World};
use std::time::{Duration, Instant};
use wmr::geometry::{Pose, wrap_angle};
use wmr::scene::Obstacle;
use wmr::vision::{DetectOptions, Detection, Photo, Sequence, TagDictionary, detect};

/// Seconds between pictures.
const STEP: f64 = 0.1;
/// How far beside the truth the robot is expected.
const EXPECTED_OFF: f64 = 0.01;

/// What happens on the floor.
#[derive(Clone, Debug)]
pub struct Course {
    /// What stands there from the beginning.
    pub shapes: Vec<Shape>,
    /// What moves, and how.
    pub movers: Vec<(Shape, Motion)>,
    /// What is set down at the first picture and taken away at the second.
    pub guest: Option<(Shape, [usize; 2])>,
    /// Where the robot is in a picture.
    pub robot: fn(usize) -> TruePose,
    /// Whether it has a tag on its top; else a triangle.
    pub has_tag: bool,
    /// Whether a picture of the empty floor is known.
    pub knows_empty: bool,
    /// How much light there is in a picture.
    pub exposure: fn(usize) -> f64,
    /// The lamp over a picture.
    pub lamp: fn(usize) -> Light,
}

impl Course {
    /// Three boxes, a box that crosses the floor, a box that is set down and taken away, and a robot on its way.
    pub fn usual() -> Self {
        let shapes = [[0.9, 0.3, 1.15, 0.55], [1.45, 1.05, 1.75, 1.3], [0.3, 1.05, 0.65, 1.25]];
        let crossing = Motion::Way { shifts: vec![[0.0, 0.7]], speed: 0.25, again: true };
        Self {
            shapes: shapes.map(Shape::Rect).to_vec(),
            movers: vec![(Shape::Rect([1.6, 0.1, 1.75, 0.22]), crossing)],
            guest: Some((Shape::Rect([0.75, 0.95, 0.95, 1.1]), [8, 20])),
            robot: |picture| {
                let angle = 0.06 * picture as f64;
                let (sin, cos) = angle.sin_cos();
                TruePose { x: 0.45 + 0.2 * cos, y: 0.55 + 0.25 * sin, heading: angle + 1.5 }
            },
            has_tag: true,
            knows_empty: false,
            exposure: |_| 0.8,
            lamp: |_| Self::light(),
        }
    }

    /// The usual lamp.
    pub fn light() -> Light {
        Light::beside(SIZE)
    }
}

/// A picture, read with what is known from those before and as a whole.
#[derive(Debug)]
pub struct Read {
    /// What stands there in truth.
    pub truth: (TruePose, Vec<Shape>),
    /// What was seen with the pictures before.
    pub seen: Detection,
    /// What was seen in it alone.
    pub alone: Detection,
    /// Whether the pictures before did not help.
    pub is_whole: bool,
    /// How long both took, on this computer.
    pub times: [Duration; 2],
}

/// A picture that a camera takes.
fn taken(camera: &mut Camera, stage: &Stage, number: u64) -> Photo {
    let [width, height] = camera.lens().image_size;
    let rgb = camera.picture(stage, &CameraFaults::default(), number);
    Photo::from_rgb(width, height, rgb.as_chunks::<3>().0.to_vec()).unwrap()
}

/// Reads some pictures of a course.
pub fn read(course: &Course, pictures: usize) -> Vec<Read> {
    let lens = Lens::above(SIZE, HEIGHT, [640, 480]);
    let options = DetectOptions {
        robot_radius: RADIUS,
        robot_tag: course.has_tag.then_some(TAG),
        camera: Some((&lens).into()),
        empty: course.knows_empty.then(|| course.empty(&lens)),
        ..DetectOptions::default()
    };
    let mut sequence = Sequence::new(ARENA, options.clone());
    let mut camera: Option<(f64, Light, Camera)> = None;
    let mut map = None;
    (0..pictures)
        .map(|number| {
            let (world, pose) = course.at(number);
            let (exposure, light) = ((course.exposure)(number), (course.lamp)(number));
            if camera.as_ref().is_none_or(|(e, l, _)| (*e, l) != (exposure, &light)) {
                let sensor = Sensor { exposure, ..Sensor::default() };
                let hung = Camera::new(lens.clone(), light.clone(), course.look(), sensor);
                camera = Some((exposure, light, hung));
            }
            let (_, _, camera) = camera.as_mut().unwrap();
            let stage = camera.look().stage(&world, pose);
            let photo = taken(camera, &stage, number as u64);
            let mut expected = Pose::from(pose);
            expected.position.x += EXPECTED_OFF;
            let began = Instant::now();
            let changes = sequence.read_changes(&photo, Some(expected));
            let is_whole = changes.is_none();
            let seen = changes.unwrap_or_else(|| {
                sequence.read_whole(&photo, map.clone(), Some(expected)).unwrap()
            });
            let took = began.elapsed();
            let known =
                DetectOptions { map: map.clone(), robot_at: Some(expected), ..options.clone() };
            let began = Instant::now();
            let alone = detect(&photo, ARENA, &known).unwrap();
            let times = [took, began.elapsed()];
            map.get_or_insert_with(|| seen.map.clone());
            let moving = world.movers.iter().map(|mover| mover.shape().clone());
            let truth = (pose, world.shapes.iter().cloned().chain(moving).collect());
            Read { truth, seen, alone, is_whole, times }
        })
        .collect()
}

impl Course {
    /// The world and the robot in it in a picture.
    fn at(&self, number: usize) -> (World, TruePose) {
        let now = Duration::from_secs_f64(STEP * number as f64);
        let mut shapes = self.shapes.clone();
        if let Some((shape, [from, to])) = &self.guest
            && (*from..*to).contains(&number)
        {
            shapes.push(shape.clone());
        }
        let mover = |(shape, motion): &(Shape, Motion)| {
            Mover::new(shape.clone(), motion.clone(), Duration::ZERO)
        };
        let movers = self.movers.iter().map(mover).collect();
        let mut world = World { size: SIZE, shapes, movers, robot_radius: RADIUS };
        world.advance(now);
        (world, (self.robot)(number))
    }

    /// A picture of the floor without anything on it.
    fn empty(&self, lens: &Lens) -> Photo {
        let sensor = Sensor { exposure: (self.exposure)(0), ..Sensor::default() };
        let mut camera = Camera::new(lens.clone(), (self.lamp)(0), self.look(), sensor);
        let stage = Stage { size: SIZE, ..Stage::default() };
        taken(&mut camera, &stage, u64::MAX)
    }

    fn look(&self) -> Look {
        if !self.has_tag {
            return Look::default();
        }
        let cells = TagDictionary::named("4X4_50").unwrap().cells(TAG).unwrap();
        Look { mark: Mark::Tag { side: 1.2 * RADIUS, cells }, robot: [240; 3], ..Look::default() }
    }
}

impl Read {
    /// How far the robot is seen beside where it is seen in the picture alone, m and rad.
    pub fn robot_off(&self) -> Option<(f64, f64)> {
        let (a, b) = self.seen.robot.zip(self.alone.robot)?;
        Some((a.position.distance(b.position), wrap_angle(a.heading - b.heading).abs()))
    }

    /// The most that an edge of a thing lies beside that of the same thing seen in the picture alone, with margins; none if not the
    /// same things are seen.
    pub fn things_off(&self) -> Option<f64> {
        let (seen, alone) = (&self.seen.obstacles, &self.alone.obstacles);
        if seen.len() != alone.len() {
            return None;
        }
        let nearest =
            |one: &Obstacle| alone.iter().map(|other| apart(one, other)).fold(9.0, f64::min);
        Some(seen.iter().map(nearest).fold(0.0, f64::max))
    }

    /// How far the truth sticks out of what is seen with its margins, m.
    pub fn uncovered(&self) -> f64 {
        self.out_of(&self.seen)
    }

    /// The same of what is seen in the picture alone.
    pub fn uncovered_alone(&self) -> f64 {
        self.out_of(&self.alone)
    }

    fn out_of(&self, seen: &Detection) -> f64 {
        let out = |point: [f64; 2]| {
            let distances = seen.obstacles.iter().map(|thing| thing.distance(point.into()));
            distances.fold(f64::INFINITY, f64::min)
        };
        self.truth.1.iter().flat_map(Shape::outline).map(out).fold(0.0, f64::max)
    }
}

/// The most that an edge of one lies beside that of the other, margins included.
fn apart(one: &Obstacle, other: &Obstacle) -> f64 {
    let [a, b] = [one, other].map(|thing| thing.footprint.bounds().widened(thing.margin));
    let offs = [a.x0 - b.x0, a.y0 - b.y0, a.x1 - b.x1, a.y1 - b.y1];
    offs.into_iter().map(f64::abs).fold(0.0, f64::max)
}
