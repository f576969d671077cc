//! Whether the way still to drive is free of what is seen now.
//!
//! The way is the polyline from where the robot is along the goals of its legs. A thing that stands is in the way
//! where a leg comes nearer to it than the robot's radius and what is to be kept. A thing that moves is in the way
//! if the robot may meet it within the next moments: at each moment t the robot is somewhere on the stretch
//! between where it is if it is held and where it is at full speed, and the thing has moved by its velocity times
//! t. A robot that is too near to something already may leave it, but not come nearer. Metres, seconds.

use super::floor::Hazard;
use crate::geometry::Point;
use crate::shape::Shape;

/// A leg along something comes no nearer to it if it does so by less than this, m.
const NEARER: f64 = 0.001;
/// Halvings of a leg until the place of contact is known to a millimetre.
const HALVINGS: u32 = 12;
/// Steps in time for things that move, s.
const STEP: f64 = 0.05;
/// How much less sure the place of a thing that moves is, m for each second.
const DRIFT: f64 = 0.03;

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

/// What is asked of a way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Demand {
    /// The least distance of the robot's centre to anything: its radius, and what is to be kept, m.
    pub keep: f64,
    /// The robot's top speed, m/s.
    pub speed: f64,
    /// For how long things that move are looked ahead, s.
    pub horizon: f64,
}

/// The first contact on the way from `from` along `goals`.
pub fn first_contact(
    from: Point,
    goals: &[Point],
    hazards: &[Hazard],
    demand: Demand,
) -> Option<Contact> {
    let nearest = |a: &Contact, b: &Contact| a.distance.total_cmp(&b.distance);
    hazards
        .iter()
        .enumerate()
        .filter_map(|(hazard, thing)| {
            let standing = standing_contact(from, goals, &thing.obstacle.footprint, demand);
            let moving = thing.moves().then(|| moving_contact(from, goals, thing, demand));
            let found = [standing, moving.flatten()].into_iter().flatten().min_by(nearest)?;
            Some(Contact { hazard, ..found })
        })
        .min_by(nearest)
}

fn standing_contact(
    from: Point,
    goals: &[Point],
    shape: &Shape,
    demand: Demand,
) -> Option<Contact> {
    // What is too near already may be left.
    let keep = demand.keep.min(shape.distance(from) - NEARER);
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

fn moving_contact(from: Point, goals: &[Point], thing: &Hazard, demand: Demand) -> Option<Contact> {
    let [vx, vy] = thing.velocity;
    let start = thing.obstacle.footprint.distance(from);
    let steps = (demand.horizon / STEP) as u32;
    for time in (1..=steps).map(|step| f64::from(step) * STEP) {
        let shape = thing.obstacle.footprint.moved_by(vx * time, vy * time);
        // What drives at a robot that is held is not avoided by holding it.
        let keep = (demand.keep + DRIFT * time).min(shape.distance(from)).min(start);
        let reach = demand.speed * time;
        let (mut a, mut before) = (from, 0.0);
        for (leg, &b) in goals.iter().enumerate() {
            let length = a.distance(b);
            let end = if before + length > reach && length > 0.0 {
                between(a, b, (reach - before) / length)
            } else {
                b
            };
            if shape.leg_distance(a, end) < keep - NEARER {
                return Some(Contact { hazard: 0, leg, distance: before, at: end });
            }
            before += length;
            if before > reach {
                break;
            }
            a = b;
        }
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

    const DEMAND: Demand = Demand { keep: 0.08, speed: 0.4, horizon: 1.5 };
    const START: Point = Point::new(0.0, 0.0);

    fn thing(rect: [f64; 4], velocity: [f64; 2]) -> Hazard {
        let [x0, y0, x1, y1] = rect;
        Hazard { obstacle: Rect::new(x0, y0, x1, y1).into(), velocity }
    }

    #[test]
    fn the_place_of_contact_by_hand() {
        let goals = [Point::new(1.0, 0.0), Point::new(1.0, 1.0)];
        let contact = |rect| first_contact(START, &goals, &[thing(rect, [0.0; 2])], DEMAND);
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
        assert_eq!(first_contact(START, &[Point::new(1.0, 0.0)], &near, DEMAND), None);
        assert!(first_contact(START, &[Point::new(-0.5, 0.0)], &near, DEMAND).is_some());
    }

    /// A box 0.3 m beside the way comes at 0.5 m/s: after 0.44 s it is as near as 0.08 m.
    #[test]
    fn what_moves_into_the_way_is_in_it() {
        let goals = [Point::new(1.0, 0.0)];
        let rect = [0.1, 0.3, 0.2, 0.4];
        let meets = |velocity| first_contact(START, &goals, &[thing(rect, velocity)], DEMAND);
        assert!(meets([0.0, -0.5]).is_some());
        assert_eq!(meets([0.0, 0.5]), None, "it moves away");
        assert_eq!(meets([0.0, -0.1]), None, "it takes longer than the horizon");
    }
}
