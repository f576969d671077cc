//! Displacement and heading over time, measured against planned, as in the paper's figures
//! [Alghannam, Sec. V]. Seconds across; metres and degrees up.

use super::svg::{Svg, Swatch, TITLE_HEIGHT};
use crate::geometry::{Pose, wrap_angle};

/// Where the robot was, or was to be, at one moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimedPose {
    /// Since the mission began, seconds.
    pub time: f64,
    /// Where.
    pub pose: Pose,
}

const LEFT: f64 = 70.0;
const RIGHT: f64 = 20.0;
const ABOVE: f64 = 30.0;
const BELOW: f64 = 45.0;

/// Draws the way covered and the heading over time, `planned` and `measured`, as one SVG.
///
/// ```
/// use wmr::{geometry::Pose, picture::motion::{TimedPose, motion_svg}};
/// let at = |time, x| TimedPose { time, pose: Pose::new(x, 0.0, 0.0) };
/// let svg = motion_svg(&[at(0.0, 0.0), at(1.0, 0.5)], &[at(0.0, 0.0), at(1.0, 0.49)]);
/// assert!(svg.starts_with("<svg") && svg.contains("Displacement"));
/// ```
pub fn motion_svg(planned: &[TimedPose], measured: &[TimedPose]) -> String {
    let end = planned.iter().chain(measured).map(|at| at.time).fold(1.0, f64::max);
    let mut svg = Svg::new(
        Chart::WIDTH,
        2.0 * Chart::HEIGHT,
        "The driven mission",
        "planned against measured by the robot",
    );
    let charts = [
        ("Displacement along the way, m", displacement(planned), displacement(measured)),
        ("Heading, degrees", headings(planned), headings(measured)),
    ];
    for (row, (title, planned, measured)) in charts.iter().enumerate() {
        let chart =
            Chart::new(TITLE_HEIGHT + row as f64 * Chart::HEIGHT, end, &[planned, measured]);
        chart.frame(&mut svg, title);
        svg.polyline(&chart.points(planned), "planned");
        svg.polyline(&chart.points(measured), "measured");
    }
    svg.finish(&[(Swatch::Line("planned"), "planned"), (Swatch::Line("measured"), "measured")])
}

pub(super) type Series = Vec<(f64, f64)>;

fn displacement(poses: &[TimedPose]) -> Series {
    let mut covered = 0.0;
    let steps = poses.windows(2).map(|pair| {
        covered += pair[0].pose.position.distance(pair[1].pose.position);
        (pair[1].time, covered)
    });
    poses.first().map(|first| (first.time, 0.0)).into_iter().chain(steps).collect()
}

/// Headings without the jump at a half turn, degrees.
fn headings(poses: &[TimedPose]) -> Series {
    let mut last = poses.first().map_or(0.0, |first| first.pose.heading);
    poses
        .iter()
        .map(|TimedPose { time, pose }| {
            last += wrap_angle(pose.heading - last);
            (*time, last.to_degrees())
        })
        .collect()
}

/// A chart over time, one of several below each other.
pub(super) struct Chart {
    top: f64,
    end: f64,
    low: f64,
    step: f64,
    high: f64,
}

impl Chart {
    pub(super) const WIDTH: f64 = 880.0;
    pub(super) const HEIGHT: f64 = 270.0;

    pub(super) fn new(top: f64, end: f64, series: &[&Series]) -> Self {
        let values = || series.iter().flat_map(|series| series.iter().map(|(_, value)| *value));
        let (low, high) = (values().fold(0.0, f64::min), values().fold(0.0, f64::max));
        let step = round_step((high - low).max(1e-3) / 5.0);
        Self { top, end, low: (low / step).floor() * step, step, high: (high / step).ceil() * step }
    }

    fn x(&self, time: f64) -> f64 {
        LEFT + time / self.end * (Chart::WIDTH - LEFT - RIGHT)
    }

    fn y(&self, value: f64) -> f64 {
        let height = Chart::HEIGHT - ABOVE - BELOW;
        self.top
            + ABOVE
            + height * (1.0 - (value - self.low) / (self.high - self.low).max(self.step))
    }

    pub(super) fn points(&self, series: &Series) -> Vec<(f64, f64)> {
        series.iter().map(|(time, value)| (self.x(*time), self.y(*value))).collect()
    }

    pub(super) fn frame(&self, svg: &mut Svg, title: &str) {
        let right = Chart::WIDTH - RIGHT;
        svg.text((LEFT, self.top + ABOVE - 12.0), "element", "start", 13.0, title);
        let lines = ((self.high - self.low) / self.step).round().max(1.0) as u32;
        for value in (0..=lines).map(|line| self.low + f64::from(line) * self.step) {
            let y = self.y(value);
            svg.polyline(&[(LEFT, y), (right, y)], "scale");
            svg.text((LEFT - 8.0, y + 4.0), "number", "end", 12.0, &number(value, self.step));
        }
        let step = round_step(self.end / 10.0);
        let low = self.y(self.low);
        for time in (0..=(self.end / step) as u32).map(|mark| f64::from(mark) * step) {
            svg.polyline(&[(self.x(time), low), (self.x(time), low + 5.0)], "scale");
            svg.text((self.x(time), low + 19.0), "number", "middle", 12.0, &number(time, step));
        }
        svg.text((right, low + 36.0), "number", "end", 12.0, "time, s");
    }
}

/// The nearest of 1, 2 and 5 times a power of ten that is not below `step`.
fn round_step(step: f64) -> f64 {
    let power = 10f64.powf(step.log10().floor());
    [1.0, 2.0, 5.0, 10.0]
        .into_iter()
        .map(|factor| factor * power)
        .find(|round| *round >= step * 0.999)
        .unwrap_or(10.0 * power)
}

fn number(value: f64, step: f64) -> String {
    let decimals = (-step.log10().floor()).max(0.0) as usize;
    format!("{value:.decimals$}")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(time: f64, x: f64, heading: f64) -> TimedPose {
        TimedPose { time, pose: Pose::new(x, 0.0, heading) }
    }

    #[test]
    fn displacement_adds_up_whichever_way_the_robot_goes() {
        let series = displacement(&[at(0.0, 0.0, 0.0), at(1.0, 2.0, 0.0), at(2.0, 1.0, 0.0)]);
        assert_eq!(series, [(0.0, 0.0), (1.0, 2.0), (2.0, 3.0)]);
    }

    #[test]
    fn a_turn_through_the_half_turn_is_drawn_without_a_jump() {
        let series = headings(&[at(0.0, 0.0, 3.0), at(1.0, 0.0, -3.0)]);
        assert!((series[1].1 - (std::f64::consts::TAU - 3.0).to_degrees()).abs() < 1e-9);
    }

    #[test]
    fn steps_are_round() {
        assert_eq!(round_step(0.3), 0.5);
        assert_eq!(round_step(2.0), 2.0);
        assert_eq!(round_step(6.0), 10.0);
    }
}
