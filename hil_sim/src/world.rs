//! The arena around the base: true boxes and walls, and whether the robot touched one. Metres.

use crate::base::TruePose;

/// Overlaps up to this depth are contact, not collision, m.
const CONTACT: f64 = 0.0001;

/// A true arena.
#[derive(Clone, Debug, PartialEq)]
pub struct World {
    /// Width and height of the floor, m.
    pub size: [f64; 2],
    /// True boxes: x0, y0, x1, y1, m.
    pub boxes: Vec<[f64; 4]>,
    /// Radius of the robot's disc, m.
    pub robot_radius: f64,
}

impl World {
    /// The gap between the robot's disc at `pose` and the nearest box or wall, m; negative where it overlaps.
    ///
    /// ```
    /// use wmr_sim::{base::TruePose, world::World};
    /// let world = World { size: [2.0, 1.0], boxes: vec![[1.0, 0.0, 1.2, 1.0]], robot_radius: 0.1 };
    /// let gap = world.clearance(TruePose { x: 0.5, y: 0.5, heading: 0.0 });
    /// assert!((gap - 0.4).abs() < 1e-12);
    /// ```
    pub fn clearance(&self, pose: TruePose) -> f64 {
        let TruePose { x, y, .. } = pose;
        let [width, height] = self.size;
        let wall = x.min(y).min(width - x).min(height - y);
        let nearest = self.boxes.iter().map(|&[x0, y0, x1, y1]| {
            let (outside_x, outside_y) = ((x0 - x).max(x - x1), (y0 - y).max(y - y1));
            if outside_x <= 0.0 && outside_y <= 0.0 {
                outside_x.max(outside_y)
            } else {
                outside_x.max(0.0).hypot(outside_y.max(0.0))
            }
        });
        nearest.fold(wall, f64::min) - self.robot_radius
    }
}

/// What has happened to the robot in its world so far.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CollisionLog {
    /// How often the robot ran into a box or wall.
    pub collisions: u32,
    /// The smallest gap so far, m; infinite before the first look.
    pub min_clearance: f64,
    touching: bool,
}

impl Default for CollisionLog {
    fn default() -> Self {
        Self { collisions: 0, min_clearance: f64::INFINITY, touching: false }
    }
}

impl CollisionLog {
    /// Takes in the gap at one moment.
    pub fn observe(&mut self, clearance: f64) {
        let touching = clearance < -CONTACT;
        self.collisions += u32::from(touching && !self.touching);
        self.touching = touching;
        self.min_clearance = self.min_clearance.min(clearance);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(x: f64, y: f64) -> TruePose {
        TruePose { x, y, heading: 0.0 }
    }

    #[test]
    fn clearance_to_walls_edges_corners_and_insides() {
        let world =
            World { size: [4.0, 4.0], boxes: vec![[1.0, 1.0, 2.0, 2.0]], robot_radius: 0.1 };
        assert!((world.clearance(at(0.3, 3.0)) - 0.2).abs() < 1e-12);
        assert!((world.clearance(at(2.5, 1.5)) - 0.4).abs() < 1e-12);
        assert!((world.clearance(at(2.3, 2.4)) - 0.4).abs() < 1e-12);
        assert!((world.clearance(at(1.5, 1.2)) + 0.3).abs() < 1e-12);
    }

    #[test]
    fn one_long_touch_is_one_collision() {
        let mut collision_log = CollisionLog::default();
        for clearance in [0.1, -0.00005, -0.01, -0.02, 0.05, -0.001] {
            collision_log.observe(clearance);
        }
        assert_eq!(collision_log.collisions, 2);
        assert_eq!(collision_log.min_clearance, -0.02);
    }
}
