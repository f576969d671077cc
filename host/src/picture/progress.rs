//! How far a robot was beside its planned way, and how fast its wheels turned, over time. Seconds across;
//! millimetres and rad/s up.

use super::motion::Chart;
use super::svg::{Svg, Swatch, TITLE_HEIGHT};
use crate::document::RunLine;
use crate::geometry::Point;

/// Draws the deviation from `way` and the wheels' speeds of a drive, in the arena frame.
///
/// ```
/// use wmr::geometry::{Point, Pose};
/// use wmr::run_log::RunLine;
/// let at = |t, y| RunLine { t, pose: Pose::new(t, y, 0.0), wheels: [1.0; 2], leg: 0, state: "driving".into() };
/// let way = [Point::new(0.0, 0.0), Point::new(2.0, 0.0)];
/// let svg = wmr::picture::progress::progress_svg(&way, &[at(0.0, 0.0), at(1.0, 0.003)]);
/// assert!(svg.contains("3.0 mm at most"), "{svg}");
/// ```
pub fn progress_svg(way: &[Point], lines: &[RunLine]) -> String {
    let end = lines.iter().map(|line| line.t).fold(1.0, f64::max);
    let series = |value: &dyn Fn(&RunLine) -> f64| -> Vec<(f64, f64)> {
        lines.iter().map(|line| (line.t, value(line))).collect()
    };
    let beside = series(&|line| beside(way, line.pose.position) * 1000.0);
    let [left, right] = [0, 1].map(|wheel| series(&|line| line.wheels[wheel].into()));
    let most = beside.iter().map(|(_, value)| *value).fold(0.0, f64::max);
    let mut svg = Svg::new(
        Chart::WIDTH,
        2.0 * Chart::HEIGHT,
        "How exactly the way was driven",
        &format!("as the robot measured it: {most:.1} mm at most beside the planned way"),
    );
    let chart = Chart::new(TITLE_HEIGHT, end, &[&beside]);
    chart.frame(&mut svg, "Distance from the planned way, mm");
    svg.polyline(&chart.points(&beside), "measured");
    let chart = Chart::new(TITLE_HEIGHT + Chart::HEIGHT, end, &[&left, &right]);
    chart.frame(&mut svg, "Wheel speeds, rad/s");
    svg.polyline(&chart.points(&left), "measured");
    svg.polyline(&chart.points(&right), "planned");
    svg.finish(&[
        (Swatch::Line("measured"), "measured; below: the left wheel"),
        (Swatch::Line("planned"), "below: the right wheel"),
    ])
}

/// The distance of `point` from the nearest point of `way`.
fn beside(way: &[Point], point: Point) -> f64 {
    let to_segment = |pair: &[Point]| {
        let (from, to) = (pair[0], pair[1]);
        let (dx, dy) = (to.x - from.x, to.y - from.y);
        let squared = dx * dx + dy * dy;
        let along = ((point.x - from.x) * dx + (point.y - from.y) * dy) / squared;
        let share = if squared > 0.0 { along.clamp(0.0, 1.0) } else { 0.0 };
        point.distance(Point::new(from.x + share * dx, from.y + share * dy))
    };
    let nearest = way.windows(2).map(to_segment).fold(f64::INFINITY, f64::min);
    if nearest.is_finite() { nearest } else { way.first().map_or(0.0, |at| point.distance(*at)) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn beside_a_corner_the_nearer_side_counts() {
        let way = [Point::new(0.0, 0.0), Point::new(1.0, 0.0), Point::new(1.0, 1.0)];
        for (x, y, distance) in
            [(0.5, 0.2, 0.2), (0.9, 0.5, 0.1), (-3.0, 4.0, 5.0), (1.0, 2.0, 1.0)]
        {
            assert!((beside(&way, Point::new(x, y)) - distance).abs() < 1e-12, "{x} {y}");
        }
        assert_eq!(beside(&way[..1], Point::new(0.0, 2.0)), 2.0);
        assert_eq!(beside(&[way[0], way[0]], Point::new(0.0, 2.0)), 2.0);
    }
}
