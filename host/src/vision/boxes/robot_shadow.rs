//! Whether a dark patch beside the robot is its shadow, by its form alone.
//!
//! A lamp makes of the robot's disc one disc beside the other: a strip as wide as the robot with a round end. A box
//! beside the robot is narrower, or its far corners stick out. Metres in the arena frame.
//!
//! Deviation: the paper knows no shadows; it leaves them to a second camera [Alghannam, Sec. VI].

use crate::geometry::Point;
use crate::vision::robot::RobotTop;

/// The longest shadow, radii of the robot.
const LONGEST: f64 = 1.2;
/// How much wider than the robot its shadow may be, and the share of its cells that lie within.
const WIDENED: f64 = 1.1;
const MOSTLY: f64 = 0.97;
/// A shadow fills at least this share of the strip beyond what is hidden with the robot.
const LEAST_FILL: f64 = 0.5;
/// Cells at its rim are blurred.
const BLUR: f64 = 1.5;

/// Whether a patch beside the robot has the form of its shadow: cells at `points`, each `cell` wide, none of which is
/// nearer to the robot than `rim` radii.
pub(super) fn is_robot_shadow(points: &[Point], cell: f64, robot: RobotTop, rim: f64) -> bool {
    let RobotTop { base, radius, .. } = robot;
    let count = points.len().max(1) as f64;
    let sum = points.iter().fold([0.0; 2], |[x, y], p| [x + p.x - base.x, y + p.y - base.y]);
    let away = f64::hypot(sum[0], sum[1]);
    if away < f64::MIN_POSITIVE {
        return false;
    }
    let [dx, dy] = sum.map(|part| part / away);
    let along = |p: &Point| (p.x - base.x) * dx + (p.y - base.y) * dy;
    let farthest = points.iter().map(along).fold(0.0, f64::max);
    let length = farthest - radius;
    if length > LONGEST * radius || farthest < rim * radius {
        return false;
    }
    let end = Point::new(base.x + length * dx, base.y + length * dy);
    let strip = RobotTop { centre: end, ..robot };
    let widened = WIDENED + BLUR * cell / radius;
    let within = points.iter().filter(|&&point| strip.radii_from(point) < widened).count();
    let seen = strip_beyond(length / radius, rim) * radius.powi(2);
    within as f64 > MOSTLY * count && count * cell * cell > LEAST_FILL * seen
}

/// The area of a strip about a line of this length that begins at the centre of a disc of the radius `rim`, and lies
/// beyond that disc; the strip is two wide. All in radii of the robot.
fn strip_beyond(length: f64, rim: f64) -> f64 {
    const STEPS: usize = 64;
    let depth = |index: usize| {
        let across: f64 = 2.0 * (index as f64 + 0.5) / STEPS as f64 - 1.0;
        let end = length + (1.0 - across * across).sqrt();
        (end - (rim * rim - across * across).max(0.0).sqrt()).max(0.0)
    };
    (0..STEPS).map(depth).sum::<f64>() * 2.0 / STEPS as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_4;

    const RIM: f64 = 1.35;
    const CELL: f64 = 0.004;

    fn robot() -> RobotTop {
        let centre = Point::new(0.5, 0.5);
        RobotTop { centre, radius: 0.075, heading: 0.0, certainty: 1.0, base: centre }
    }

    /// The cells beyond the robot's rim that `is_dark` marks.
    fn patch(is_dark: impl Fn(Point) -> bool) -> Vec<Point> {
        let place = |i: usize| Point::new((i % 250) as f64 * CELL, (i / 250) as f64 * CELL);
        let is_seen = |point: &Point| robot().radii_from(*point) >= RIM && is_dark(*point);
        (0..250 * 250).map(place).filter(is_seen).collect()
    }

    #[test]
    fn a_disc_beside_the_robot_is_its_shadow() {
        for turn in 0..8 {
            let (sin, cos) = (f64::from(turn) * FRAC_PI_4).sin_cos();
            for length in [0.04, 0.06, 0.08] {
                let end = Point::new(0.5 + length * cos, 0.5 + length * sin);
                let shadow = RobotTop { centre: end, ..robot() };
                let points = patch(|point| shadow.radii_from(point) < 1.0);
                assert!(is_robot_shadow(&points, CELL, robot(), RIM), "{turn} {length}");
            }
        }
    }

    #[test]
    fn a_box_beside_the_robot_is_none() {
        for (half, depth) in [(0.02, 0.05), (0.03, 0.04), (0.05, 0.06), (0.075, 0.05), (0.1, 0.03)]
        {
            let is_dark = |point: Point| {
                (point.y - 0.5).abs() < half && point.x > 0.58 && point.x < 0.6 + depth
            };
            let points = patch(is_dark);
            assert!(!points.is_empty());
            assert!(!is_robot_shadow(&points, CELL, robot(), RIM), "{half} {depth}");
        }
    }

    #[test]
    fn a_strip_beyond_its_own_disc_is_as_long_as_it_is_wide() {
        // Two wide and one long: the moved half disc covers what it left.
        assert!((strip_beyond(1.0, 1.0) - 2.0).abs() < 1e-9);
    }
}
