//! A camera over the arena: pictures of a world and its robot, as `wmr detect` takes them.
//!
//! ```text
//! world, true pose ─► stage ─► rays through the lens ─► colour × light ─► blur, exposure, noise ─► frame
//!                     (bodies)      (region by region)                        (sensor)              (stream)
//! ```
//! A pinhole with radial distortion looks at a floor with tape around it, at boxes and pillars that lean as
//! they do in perspective, and at a robot with a triangle or a tag on its top, by the light of one round lamp
//! and of the room. Metres and radians in the arena frame, pixels in pictures; nothing here reads a clock.

mod lens;
mod light;
mod region;
mod render;
mod sensor;
mod solid;
mod stream;

pub use lens::Lens;
pub use light::Light;
pub use render::{Ground, Stage};
pub use sensor::Sensor;
pub use solid::{Colour, Mark, Solid};
pub use stream::{CameraFaults, Exposure, Frame, Stream, Timing};

use crate::base::TruePose;
use crate::motion::Mover;
use crate::world::{Shape, World};
use render::Renderer;

/// What bodies look like.
#[derive(Clone, Debug, PartialEq)]
pub struct Look {
    /// The floor and what is around it.
    pub ground: Ground,
    /// Colours of shapes, one after the other and again from the first.
    pub shapes: Vec<Colour>,
    /// How tall shapes are, m.
    pub shape_height: f64,
    /// The robot's colour.
    pub robot: Colour,
    /// How tall the robot is, m.
    pub robot_height: f64,
    /// What the robot carries on its top.
    pub mark: Mark,
}

impl Default for Look {
    fn default() -> Self {
        Self {
            ground: Ground::default(),
            shapes: vec![[44, 62, 116], [122, 40, 40], [36, 88, 58], [74, 60, 50], [60, 60, 66]],
            shape_height: 0.1,
            robot: [235, 120, 30],
            robot_height: 0.07,
            mark: Mark::Triangle([28, 28, 30]),
        }
    }
}

impl Look {
    /// The robot of this radius, m, at `pose`.
    pub fn robot_at(&self, pose: TruePose, radius: f64) -> Solid {
        Solid {
            shape: Shape::Circle([pose.x, pose.y, radius]),
            height: self.robot_height,
            colour: self.robot,
            mark: Some((pose, self.mark.clone())),
        }
    }

    /// The bodies of a world with its robot at `pose`.
    pub fn stage(&self, world: &World, pose: TruePose) -> Stage {
        let colours = || self.shapes.iter().cycle();
        let solid = |(shape, colour): (&Shape, &Colour)| Solid {
            shape: shape.clone(),
            height: self.shape_height,
            colour: *colour,
            mark: None,
        };
        Stage {
            size: world.size,
            still: world.shapes.iter().zip(colours()).map(solid).collect(),
            moving: std::iter::once(self.robot_at(pose, world.robot_radius))
                .chain(world.movers.iter().map(Mover::shape).zip(colours()).map(solid))
                .collect(),
        }
    }
}

/// A camera over an arena.
///
/// ```
/// use wmr_sim::base::TruePose;
/// use wmr_sim::camera::{Camera, CameraFaults};
/// use wmr_sim::world::World;
/// let (shapes, movers) = (Vec::new(), Vec::new());
/// let world = World { size: [2.0, 1.5], shapes, movers, robot_radius: 0.075 };
/// let mut camera = Camera::above(world.size, [160, 120]);
/// let stage = camera.look().stage(&world, TruePose { x: 1.0, y: 0.75, heading: 0.0 });
/// let rgb = camera.picture(&stage, &CameraFaults::default(), 1);
/// assert_eq!(rgb.len(), 160 * 120 * 3);
/// ```
#[derive(Clone, Debug)]
pub struct Camera {
    lens: Lens,
    look: Look,
    renderer: Renderer,
}

impl Camera {
    /// A camera with this lens over things of this look, in this light.
    pub fn new(lens: Lens, light: Light, look: Look, sensor: Sensor) -> Self {
        let renderer = Renderer::new(lens.clone(), light, look.ground.clone(), sensor);
        Self { lens, look, renderer }
    }

    /// A usual camera 2.5 m above the middle of a floor of this size, m.
    pub fn above(size: [f64; 2], image_size: [usize; 2]) -> Self {
        let lens = Lens::above(size, 2.5, image_size);
        Self::new(lens, Light::beside(size), Look::default(), Sensor::default())
    }

    /// The camera's lens, and where it is as long as nobody moves it.
    pub fn lens(&self) -> &Lens {
        &self.lens
    }

    /// What bodies look like.
    pub fn look(&self) -> &Look {
        &self.look
    }

    /// The picture of `stage` with these faults, row by row, red, green and blue of each pixel; `number`
    /// tells its noise from that of other pictures.
    pub fn picture(&mut self, stage: &Stage, faults: &CameraFaults, number: u64) -> Vec<u8> {
        if faults.dark {
            return self.renderer.dark_picture(number);
        }
        let lens = match faults.moved {
            None => self.lens.clone(),
            Some([by, turn]) => self.lens.moved(by, turn),
        };
        self.renderer.set_lens(lens);
        self.renderer.picture(stage, number)
    }
}
