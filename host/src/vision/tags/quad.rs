//! Four straight sides in an outline.
//!
//! The farthest point from an outline's centre is a corner of a convex quad, the farthest from that one is
//! the corner across, the farthest on either side of their diagonal are the other two. Between the corners
//! lines are fitted by least squares of distances; where they cross lie the quad's corners.

/// A tag's shortest side is longer, pixels.
const LEAST_SIDE: f64 = 8.0;
/// The share of a side's points at each end that the blurred corner rounds off.
const ROUNDED: f64 = 0.15;
/// Outline points lie this near to a side: root mean square, pixels and share of its length.
const STRAIGHT: f64 = 0.45;
const STRAIGHT_SHARE: f64 = 0.012;
/// Fitted corners lie this near to the outline's own, share of the shortest side.
const NEAR_CORNER: f64 = 0.3;

/// The corners of an outline with four straight sides, clockwise as seen.
pub(super) fn of_outline(points: &[[f64; 2]]) -> Option<[[f64; 2]; 4]> {
    let rough = rough_corners(points)?;
    let corners = rough.map(|index| points[index]);
    let shortest =
        (0..4).map(|i| distance(corners[i], corners[(i + 1) % 4])).fold(f64::MAX, f64::min);
    if shortest < LEAST_SIDE - 2.0 || !fills(points, corners) {
        return None;
    }
    let mut lines = [([0.0; 2], [0.0; 2]); 4];
    for (side, line) in lines.iter_mut().enumerate() {
        *line = line_between(points, rough[side], rough[(side + 1) % 4])?;
    }
    let mut fitted = [[0.0; 2]; 4];
    for (index, corner) in fitted.iter_mut().enumerate() {
        *corner = crossing(lines[(index + 3) % 4], lines[index])?;
        if distance(*corner, corners[index]) > NEAR_CORNER * shortest + 1.0 {
            return None;
        }
    }
    is_convex(fitted).then_some(fitted)
}

fn distance([a, b]: [f64; 2], [c, d]: [f64; 2]) -> f64 {
    (c - a).hypot(d - b)
}

fn farthest(points: &[[f64; 2]], value: impl Fn([f64; 2]) -> f64) -> (usize, f64) {
    points.iter().enumerate().fold((0, f64::MIN), |best, (index, &point)| {
        let this = value(point);
        if this > best.1 { (index, this) } else { best }
    })
}

/// The indices of the four corners in the order of the outline.
fn rough_corners(points: &[[f64; 2]]) -> Option<[usize; 4]> {
    if points.len() < 16 {
        return None;
    }
    let count = points.len() as f64;
    let sum = points.iter().fold([0.0; 2], |sum, p| [sum[0] + p[0], sum[1] + p[1]]);
    let centre = sum.map(|value| value / count);
    let (first, _) = farthest(points, |p| distance(p, centre));
    let a = points[first];
    let (across, length) = farthest(points, |p| distance(p, a));
    let c = points[across];
    let aside = |p: [f64; 2]| (c[0] - a[0]) * (p[1] - a[1]) - (c[1] - a[1]) * (p[0] - a[0]);
    let (left, most) = farthest(points, aside);
    let (right, least) = farthest(points, |p| -aside(p));
    if most.min(least) < 2.0 * length {
        return None;
    }
    let mut corners = [first, across, left, right];
    corners.sort_unstable();
    let apart = (1..4).all(|i| corners[i] - corners[i - 1] >= 4);
    apart.then_some(corners)
}

/// Whether an outline encloses about as much as the quad between its corners.
fn fills(points: &[[f64; 2]], corners: [[f64; 2]; 4]) -> bool {
    let area = |ring: &[[f64; 2]]| {
        let next = ring.iter().cycle().skip(1);
        ring.iter().zip(next).map(|(a, b)| a[0] * b[1] - a[1] * b[0]).sum::<f64>() / 2.0
    };
    let (seen, quad) = (area(points), area(&corners));
    quad > 0.0 && (0.85..1.25).contains(&(seen / quad))
}

/// A point of a side and its direction.
fn line_between(points: &[[f64; 2]], from: usize, to: usize) -> Option<([f64; 2], [f64; 2])> {
    let count = (to + points.len() - from) % points.len();
    let left_out = 1 + (count as f64 * ROUNDED) as usize;
    let kept = left_out..count.saturating_sub(left_out) + 1;
    let number = kept.len() as f64;
    if kept.len() < 3 {
        return None;
    }
    let chosen = || kept.clone().map(|index| points[(from + index) % points.len()]);
    let sum = chosen().fold([0.0; 2], |sum, p| [sum[0] + p[0], sum[1] + p[1]]);
    let mean = sum.map(|value| value / number);
    let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
    for p in chosen() {
        let (x, y) = (p[0] - mean[0], p[1] - mean[1]);
        (xx, xy, yy) = (xx + x * x, xy + x * y, yy + y * y);
    }
    let angle = 0.5 * (2.0 * xy).atan2(xx - yy);
    let (sin, cos) = angle.sin_cos();
    let off = (xx * sin * sin - 2.0 * xy * sin * cos + yy * cos * cos) / number;
    let length = distance(points[from], points[to]);
    (off.max(0.0).sqrt() < STRAIGHT + STRAIGHT_SHARE * length).then_some((mean, [cos, sin]))
}

fn crossing((p, d): ([f64; 2], [f64; 2]), (q, e): ([f64; 2], [f64; 2])) -> Option<[f64; 2]> {
    let cross = d[0] * e[1] - d[1] * e[0];
    let along = ((q[0] - p[0]) * e[1] - (q[1] - p[1]) * e[0]) / cross;
    (cross.abs() > 0.05).then(|| [p[0] + along * d[0], p[1] + along * d[1]])
}

fn is_convex(corners: [[f64; 2]; 4]) -> bool {
    (0..4).all(|i| {
        let [a, b, c] = [corners[i], corners[(i + 1) % 4], corners[(i + 2) % 4]];
        let turn = (b[0] - a[0]) * (c[1] - b[1]) - (b[1] - a[1]) * (c[0] - b[0]);
        turn > 0.1 * distance(a, b) * distance(b, c) && distance(a, b) >= LEAST_SIDE
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ring(corners: &[[f64; 2]]) -> Vec<[f64; 2]> {
        let next = corners.iter().cycle().skip(1);
        let side = |(a, b): (&[f64; 2], &[f64; 2])| {
            let (a, b) = (*a, *b);
            (0..30).map(move |i| {
                let share = f64::from(i) / 30.0;
                [a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])]
            })
        };
        corners.iter().zip(next).flat_map(side).collect()
    }

    #[test]
    fn the_corners_of_a_slanted_quad_are_found() {
        let corners = [[10.0, 12.0], [45.0, 5.0], [50.0, 40.0], [18.0, 44.0]];
        let found = of_outline(&ring(&corners)).unwrap();
        for corner in corners {
            assert!(found.iter().any(|&p| distance(p, corner) < 1e-6), "{corner:?} {found:?}");
        }
    }

    #[test]
    fn triangles_and_circles_are_no_quads() {
        assert_eq!(of_outline(&ring(&[[10.0, 10.0], [60.0, 12.0], [30.0, 50.0]])), None);
        let circle: Vec<[f64; 2]> = (0..200)
            .map(|i| (f64::from(i) * 0.0314).sin_cos())
            .map(|(s, c)| [50.0 + 30.0 * c, 50.0 + 30.0 * s])
            .collect();
        assert_eq!(of_outline(&circle), None);
    }
}
