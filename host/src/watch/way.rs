//! Whether the way still to drive is free of what is seen now.
//!
//! The way is the polyline from where the robot is along the goals of its legs. A thing is in the way where a leg
//! comes nearer to it than the robot's radius and what is to be kept. A robot that is too near to something already
//! may leave it, but not come nearer. What moves is a matter of time as well ([`dynamic`](crate::dynamic)). Metres.

use super::floor::Hazard;
use crate::geometry::Point;
use crate::shape::Shape;

/// A leg along something comes no nearer to it if it does so by less than this, m.
const NEARER: f64 = 0.001;
/// Halvings of a leg until the place of contact is known to a millimetre.
const HALVINGS: u32 = 12;

/// What is in the way, and where.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// Which of the hazards.
    pub hazard: usize,
    /// In which leg, counted from the one under way.
    pub leg: usize,
    /// How far along the way, m.
    pub distance: f64,
    /// Where the robot would touch it.
    pub at: Point,
}

/// The first contact with what stands on the way from `from` along `goals`, which is to keep so far from
/// everything, m: the robot's radius, and what is to be kept beyond.
pub fn first_contact(
    from: Point,
    goals: &[Point],
    hazards: &[Hazard],
    keep: f64,
) -> Option<Contact> {
    let standing = hazards.iter().enumerate().filter(|(_, thing)| !thing.may_move);
    let found = standing.filter_map(|(hazard, thing)| {
        let found = standing_contact(from, goals, &thing.obstacle.footprint, keep)?;
        Some(Contact { hazard, ..found })
    });
    found.min_by(|a, b| a.distance.total_cmp(&b.distance))
}

fn standing_contact(from: Point, goals: &[Point], shape: &Shape, keep: f64) -> Option<Contact> {
    // What is too near already may be left.
    let keep = keep.min(shape.distance(from) - NEARER);
    let (mut a, mut before) = (from, 0.0);
    for (leg, &b) in goals.iter().enumerate() {
        if shape.leg_distance(a, b) < keep {
            let (mut free, mut hit) = (0.0, 1.0);
            for _ in 0..HALVINGS {
                let middle = (free + hit) / 2.0;
                if shape.leg_distance(a, between(a, b, middle)) < keep {
                    hit = middle;
                } else {
                    free = middle;
                }
            }
            let (distance, at) = (before + free * a.distance(b), between(a, b, free));
            return Some(Contact { hazard: 0, leg, distance, at });
        }
        before += a.distance(b);
        a = b;
    }
    None
}

fn between(a: Point, b: Point, share: f64) -> Point {
    Point::new(a.x + share * (b.x - a.x), a.y + share * (b.y - a.y))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Rect;

    const KEEP: f64 = 0.08;
    const START: Point = Point::new(0.0, 0.0);

    fn thing(rect: [f64; 4], velocity: [f64; 2]) -> Hazard {
        let [x0, y0, x1, y1] = rect;
        let may_move = velocity != [0.0; 2];
        Hazard { obstacle: Rect::new(x0, y0, x1, y1).into(), velocity, may_move, is_known: true }
    }

    #[test]
    fn the_place_of_contact_by_hand() {
        let goals = [Point::new(1.0, 0.0), Point::new(1.0, 1.0)];
        let contact = |rect| first_contact(START, &goals, &[thing(rect, [0.0; 2])], KEEP);
        // A box whose lower edge is 0.08 m above the leg is touched, not entered.
        assert_eq!(contact([0.3, 0.081, 0.5, 0.3]), None);
        let found = contact([0.4, -0.1, 0.5, 0.1]).unwrap();
        assert!((found.distance - 0.32).abs() < 1e-3 && found.leg == 0, "{found:?}");
        let found = contact([0.9, 0.5, 1.1, 0.6]).unwrap();
        assert!((found.distance - 1.42).abs() < 1e-3 && found.leg == 1, "{found:?}");
    }

    #[test]
    fn what_is_too_near_may_be_left_but_not_approached() {
        let near = [thing([-0.2, -0.1, -0.05, 0.1], [0.0; 2])];
        assert_eq!(first_contact(START, &[Point::new(1.0, 0.0)], &near, KEEP), None);
        assert!(first_contact(START, &[Point::new(-0.5, 0.0)], &near, KEEP).is_some());
    }

    #[test]
    fn what_moves_is_no_matter_of_the_way_alone() {
        let goals = [Point::new(1.0, 0.0)];
        assert_eq!(
            first_contact(START, &goals, &[thing([0.4, -0.1, 0.5, 0.1], [0.0, -0.5])], KEEP),
            None
        );
    }
}
