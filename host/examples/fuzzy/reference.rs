//! A slow second opinion on the fuzzy planner: fast marching of second order with an exact queue on a
//! regular grid of points, and the cost of a way by fine sampling. It shares nothing with the planner but
//! the distance to a shape. Metres.

use std::cmp::Reverse;
use std::collections::BinaryHeap;
use wmr::geometry::Point;
use wmr::scene::Scene;

/// The risk at `at`: 1 where the robot would touch a footprint or the border, less over a margin; the
/// margins of every obstacle are equal on all sides.
pub(crate) fn risk(scene: &Scene, at: Point) -> f64 {
    let room = at.x.min(at.y).min(scene.arena.width - at.x).min(scene.arena.height - at.y);
    if room < scene.robot_radius {
        return 1.0;
    }
    let each = scene.obstacles.iter().map(|obstacle| {
        let room = obstacle.footprint.distance(at) - scene.robot_radius;
        match obstacle.margin[0] {
            _ if room < 0.0 => 1.0,
            0.0 => 0.0,
            margin => (1.0 - room / margin).max(0.0),
        }
    });
    each.fold(0.0, f64::max)
}

/// The integral of 1 + weight · risk along a way, and the greatest risk on it.
pub(crate) fn cost_along(scene: &Scene, way: &[Point], weight: f64) -> (f64, f64) {
    const STEP: f64 = 2e-4;
    let (mut cost, mut greatest) = (0.0, 0.0_f64);
    for leg in way.windows(2) {
        let length = leg[0].distance(leg[1]);
        let count = (length / STEP).ceil().max(1.0);
        for index in 0..count as u32 {
            let share = (f64::from(index) + 0.5) / count;
            let at = Point::new(
                leg[0].x + share * (leg[1].x - leg[0].x),
                leg[0].y + share * (leg[1].y - leg[0].y),
            );
            let here = risk(scene, at);
            greatest = greatest.max(here);
            cost += (1.0 + weight * here) * length / count;
        }
    }
    (cost, greatest)
}

/// The least cost of a way from `start` to `goal`, both on the grid of points `side` apart.
pub(crate) fn least_cost(
    scene: &Scene,
    (start, goal): (Point, Point),
    side: f64,
    weight: f64,
) -> Option<f64> {
    const SEEDED: f64 = 6.0;
    let columns = (scene.arena.width / side).round() as usize + 1;
    let rows = (scene.arena.height / side).round() as usize + 1;
    let at =
        |index: usize| Point::new((index % columns) as f64 * side, (index / columns) as f64 * side);
    let number = |point: Point| {
        (point.y / side).round() as usize * columns + (point.x / side).round() as usize
    };
    let slowness: Vec<f64> = (0..columns * rows)
        .map(|index| match risk(scene, at(index)) {
            1.0.. => f64::INFINITY,
            risk => side * (1.0 + weight * risk),
        })
        .collect();
    let mut cost = vec![f64::INFINITY; slowness.len()];
    let mut is_known = vec![false; slowness.len()];
    let mut queue = BinaryHeap::new();
    for index in 0..slowness.len() {
        if at(index).distance(start) <= SEEDED * side && slowness[index].is_finite() {
            cost[index] = cost_along(scene, &[start, at(index)], weight).0;
            queue.push((Reverse(cost[index].to_bits()), index));
        }
    }
    let goal = number(goal);
    while let Some((_, index)) = queue.pop() {
        if std::mem::replace(&mut is_known[index], true) {
            continue;
        }
        if index == goal {
            return Some(cost[goal]);
        }
        let (column, row) = (index % columns, index / columns);
        let around = [
            (column > 0).then(|| index - 1),
            (column + 1 < columns).then_some(index + 1),
            (row > 0).then(|| index - columns),
            (row + 1 < rows).then_some(index + columns),
        ];
        for next in around.into_iter().flatten() {
            if !is_known[next] && slowness[next].is_finite() {
                let arriving = arriving((columns, rows), &cost, &is_known, slowness[next], next);
                if arriving < cost[next] {
                    cost[next] = arriving;
                    queue.push((Reverse(arriving.to_bits()), next));
                }
            }
        }
    }
    None
}

/// The root of the quadratic that the known neighbours make, tried with and without second order.
fn arriving(
    (columns, rows): (usize, usize),
    cost: &[f64],
    is_known: &[bool],
    slowness: f64,
    index: usize,
) -> f64 {
    let known = |column: isize, row: isize| {
        let is_in = (0..columns as isize).contains(&column) && (0..rows as isize).contains(&row);
        let at = row * columns as isize + column;
        (is_in && is_known[at as usize]).then(|| cost[at as usize])
    };
    let (column, row) = ((index % columns) as isize, (index / columns) as isize);
    let terms: Vec<(f64, f64, f64)> = [(1, 0), (0, 1)]
        .into_iter()
        .filter_map(|(dx, dy)| {
            let side = |sign: isize| {
                let near = known(column + sign * dx, row + sign * dy)?;
                Some((near, known(column + 2 * sign * dx, row + 2 * sign * dy)))
            };
            let sides = [side(-1), side(1)];
            let (near, far) = sides.into_iter().flatten().min_by(|a, b| a.0.total_cmp(&b.0))?;
            Some(match far.filter(|&far| far <= near) {
                Some(far) => (2.25, (4.0 * near - far) / 3.0, near),
                None => (1.0, near, near),
            })
        })
        .collect();
    let solved = |terms: &[(f64, f64, f64)]| {
        let a: f64 = terms.iter().map(|term| term.0).sum();
        let b: f64 = terms.iter().map(|term| term.0 * term.1).sum();
        let c: f64 =
            terms.iter().map(|term| term.0 * term.1 * term.1).sum::<f64>() - slowness * slowness;
        let root = b * b - a * c;
        (root >= 0.0).then(|| (b + root.sqrt()) / a)
    };
    let is_upwind = |value: &f64| terms.iter().all(|term| *value >= term.2);
    let both = solved(&terms).filter(is_upwind);
    both.unwrap_or_else(|| {
        terms.iter().filter_map(|&term| solved(&[term])).fold(f64::INFINITY, f64::min)
    })
}
