//! Where the robot is, from encoder counts.
//!
//! Between two ticks both wheels turn evenly, so the base runs along a circular arc: its chord has
//! the direction of the heading half-way, and the length of the arc times sin(Δ/2)/(Δ/2). The
//! heading itself is computed from whole counts since the last known pose, so it does not drift by
//! rounding however long the robot drives; only what unequal wheels add is a product of large counts.
//!
//! Odometry has a frame of its own, in which the pose never jumps. Where that frame lies in the arena
//! is set when a plan begins, and again whenever a camera has seen the robot.
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | s | path of the middle of the axis in this tick | m |
//! | Δ | change of heading in this tick | rad |

use crate::kinematics::BaseGeometry;
use protocol::motion::Pose;
use protocol::parameters::Parameters;
use protocol::trigonometry::sin_cos;
use protocol::units::{Metres, Radians};

/// The pose that follows from the encoders.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Odometry {
    /// The odometry frame's origin in the arena.
    frame: Pose,
    /// Where the robot is in that frame.
    driven: Pose,
    /// Where it is in the arena: frame ∘ driven.
    pose: Pose,
    /// Heading and counts where the frame began.
    heading_origin: Radians,
    counts_origin: [i32; 2],
    counts: [i32; 2],
}

impl Odometry {
    /// Begins at `pose` with the encoders at `counts` (left, right).
    pub fn new(pose: Pose, counts: [i32; 2]) -> Self {
        Self {
            frame: Pose::default(),
            driven: pose,
            pose,
            heading_origin: pose.heading,
            counts_origin: counts,
            counts,
        }
    }

    /// Where the robot is.
    pub fn pose(&self) -> Pose {
        self.pose
    }

    /// Where the robot is in the frame of odometry alone, which no correction moves.
    pub fn driven(&self) -> Pose {
        self.driven
    }

    /// Where the estimate had the robot in the arena when odometry had it at `driven`.
    pub fn estimate(&self, driven: Pose) -> Pose {
        self.frame.then(driven)
    }

    /// Moves the frame so that the robot was at `seen` when odometry had it at `driven`:
    /// P ← P_cam ∘ (P_odo(t)⁻¹ ∘ P_odo(now)).
    pub fn correct(&mut self, seen: Pose, driven: Pose) {
        self.frame = seen.then(driven.inverse());
        self.pose = self.frame.then(self.driven);
    }

    /// Counts on from `counts`: the robot has not moved, its encoders are counted otherwise.
    pub fn recount(&mut self, counts: [i32; 2]) {
        self.heading_origin = self.driven.heading;
        self.counts_origin = counts;
        self.counts = counts;
    }

    /// Takes in the encoders' counts (left, right) of this tick; they may wrap around.
    pub fn update(&mut self, counts: [i32; 2], rims: &Rims) {
        let heading = self.heading_origin.0 + rims.turn(since(counts, self.counts_origin));
        let moved = since(counts, self.counts);
        self.counts = counts;

        let (s, delta) = (rims.path(moved), rims.turn(moved));
        // sin(Δ/2)/(Δ/2) to fourth order; one tick turns by far less than 0.1 rad.
        let chord = s * (1.0 - delta * delta * (1.0 / 24.0));
        let (sin, cos) = sin_cos(heading - delta / 2.0);
        self.driven = Pose {
            x: Metres(self.driven.x.0 + chord * cos),
            y: Metres(self.driven.y.0 + chord * sin),
            heading: Radians(heading).wrapped(),
        };
        self.pose = self.frame.then(self.driven);
    }
}

fn since([left, right]: [i32; 2], [old_left, old_right]: [i32; 2]) -> [i32; 2] {
    [left.wrapping_sub(old_left), right.wrapping_sub(old_right)]
}

/// What the wheels' counts mean on the floor: how far the rims run for the counts of one tick, and by
/// how much the base turns.
///
/// With n = left + right and m = right − left counts, of which each runs ℓL or ℓR metres:
/// s = (ℓL + ℓR) n/4 + (ℓR − ℓL) m/4, Δ = (ℓL + ℓR) m/2b + (ℓR − ℓL) n/2b.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rims {
    /// (ℓL + ℓR)/4 and (ℓR − ℓL)/4, m.
    mean: f32,
    excess: f32,
    /// 2/b, 1/m.
    per_half_track: f32,
}

impl From<&Parameters> for Rims {
    fn from(parameters: &Parameters) -> Self {
        let [left, right] = BaseGeometry::from(parameters).radii();
        let quarter = parameters.radians_per_count() / 4.0;
        Self {
            mean: (left.0 + right.0) * quarter,
            excess: (right.0 - left.0) * quarter,
            per_half_track: 2.0 / parameters.track.0,
        }
    }
}

impl Rims {
    fn path(&self, [left, right]: [i32; 2]) -> f32 {
        let (sum, spread) = (left.wrapping_add(right) as f32, right.wrapping_sub(left) as f32);
        self.mean * sum + self.excess * spread
    }

    fn turn(&self, [left, right]: [i32; 2]) -> f32 {
        let (sum, spread) = (left.wrapping_add(right) as f32, right.wrapping_sub(left) as f32);
        (self.mean * spread + self.excess * sum) * self.per_half_track
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f32::consts::{FRAC_PI_2, PI};

    #[test]
    fn a_quarter_turn_on_the_spot_by_hand() {
        let rims = Rims::from(&Parameters::default());
        // Each rim runs b/2 · π/2: 0.06 · π/2 / (0.035 · 2π / 1440) counts = 617.14.
        let mut odometry = Odometry::new(Pose::default(), [0, 0]);
        for tick in 1..=617 {
            odometry.update([-tick, tick], &rims);
        }
        assert!((odometry.pose().heading.0 - FRAC_PI_2).abs() < 1e-3);
        assert_eq!(odometry.pose().x, Metres(0.0));
    }

    #[test]
    fn what_was_driven_since_the_exposure_is_kept() {
        let parameters = Parameters::default();
        let rims = Rims::from(&parameters);
        let mut odometry = Odometry::new(Pose::new(1.0, 1.0, 0.0), [0, 0]);
        let exposure = odometry.driven();
        odometry.update([100, 100], &rims);
        // The camera saw the robot 1 m further and looking along +y; since then it drove 100 counts.
        odometry.correct(Pose::new(2.0, 1.0, FRAC_PI_2), exposure);
        let way = 100.0 * parameters.radians_per_count() * 0.035;
        let near =
            |pose: Pose, y: f32| (pose.x.0 - 2.0).abs() < 1e-6 && (pose.y.0 - y).abs() < 1e-6;
        assert!(near(odometry.pose(), 1.0 + way), "{:?}", odometry.pose());
        odometry.update([200, 200], &rims);
        assert!(near(odometry.pose(), 1.0 + 2.0 * way), "{:?}", odometry.pose());
    }

    #[test]
    fn a_full_circle_of_arcs_closes() {
        let parameters = Parameters::default();
        let rims = Rims::from(&parameters);
        let mut odometry = Odometry::new(Pose::default(), [i32::MAX - 100, i32::MAX - 100]);
        let (mut left, mut right) = (i32::MAX - 100, i32::MAX - 100);
        // Left 1, right 3 counts a tick: a circle of radius b (1 + 3)/(3 - 1)/2 = 0.12 m, through the wrap.
        let per_tick = 2.0 * parameters.radians_per_count() * 0.035 / 0.12;
        let ticks = (2.0 * PI / per_tick).round() as i32;
        for tick in 0..ticks {
            (left, right) = (left.wrapping_add(1), right.wrapping_add(3));
            odometry.update([left, right], &rims);
            if tick == ticks / 2 {
                assert!((odometry.pose().y.0 - 0.24).abs() < 1e-4);
            }
        }
        // Whole ticks miss the full circle by at most half a tick: 0.15 mm along the arc.
        assert!(libm::hypotf(odometry.pose().x.0, odometry.pose().y.0) < 2e-4);
    }
}
