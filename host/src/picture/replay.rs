//! A drive that moves: arena, shapes, the planned way and the robot on its true way, as an animated SVG.
//! Metres, drawn y up.

use super::svg::{Svg, listed};
use crate::geometry::{Arena, Point, Pose};
use std::time::Duration;

/// SVG units in a metre.
const SCALE: f64 = 400.0;
/// Room for the title, SVG units.
const TITLE: f64 = 30.0;

/// Something on the floor beside the robot, frame by frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Body {
    /// Its corners where it stood at first, m.
    pub corners: Vec<[f64; 2]>,
    /// How far from there it is in each frame, m; `None` where it is not there. Empty where it never moves.
    pub shifts: Vec<Option<[f64; 2]>>,
}

/// What is drawn.
#[derive(Clone, Copy, Debug)]
pub struct Replay<'a> {
    /// The floor.
    pub arena: Arena,
    /// Of the robot's disc, m.
    pub radius: f64,
    /// What stands on the floor, moves over it, comes and goes.
    pub bodies: &'a [Body],
    /// Start and the points to drive to.
    pub way: &'a [Point],
    /// Where the robot was, one pose a frame.
    pub trail: &'a [Pose],
    /// How long a frame lasts.
    pub frame: Duration,
    /// What it is called.
    pub title: &'a str,
}

/// Draws a drive; the robot moves as fast as it did, again and again.
///
/// ```
/// use wmr::geometry::{Arena, Point, Pose};
/// use wmr::picture::replay::{Body, Replay, replay_svg};
/// let corners = vec![[1.0, 0.0], [1.2, 0.0], [1.2, 0.5]];
/// let svg = replay_svg(&Replay {
///     arena: Arena { width: 2.0, height: 1.0 },
///     radius: 0.1,
///     bodies: &[Body { corners, shifts: vec![Some([0.0, 0.0]), Some([0.1, 0.0])] }],
///     way: &[Point::new(0.5, 0.5), Point::new(1.5, 0.5)],
///     trail: &[Pose::new(0.5, 0.5, 0.0), Pose::new(1.5, 0.5, 0.0)],
///     frame: std::time::Duration::from_secs(1),
///     title: "there & back",
/// });
/// assert!(svg.contains("there &amp; back") && svg.contains("type=\"translate\" dur=\"2.00s\""));
/// ```
pub fn replay_svg(replay: &Replay<'_>) -> String {
    let Arena { width, height } = replay.arena;
    let (w, h) = (width * SCALE, height * SCALE);
    let mut svg = Svg::scalable([0.0, -TITLE, w, h + TITLE], replay.title);
    svg.rect((0.0, 0.0), (w, h), "ground");
    svg.text((8.0, -9.0), "caption", "start", 17.0, replay.title);
    for shape in replay.bodies {
        body(&mut svg, replay, shape);
    }
    svg.polyline(&points(replay.arena, replay.way.iter().copied()), "film-planned");
    let driven = replay.trail.iter().map(|pose| pose.position);
    svg.polyline(&points(replay.arena, driven), "measured");
    robot(&mut svg, replay);
    svg.finish(&[])
}

fn length(replay: &Replay<'_>) -> f64 {
    replay.frame.as_secs_f64() * replay.trail.len().max(1) as f64
}

/// A shape; one that never moves nor goes is drawn without an animation.
fn body(svg: &mut Svg, replay: &Replay<'_>, Body { corners, shifts }: &Body) {
    let corners = corners.iter().map(|[x, y]| Point::new(*x, *y));
    let points = points(replay.arena, corners);
    if shifts.iter().all(|shift| *shift == Some([0.0; 2])) {
        return svg.polygon(&points, "obstacle");
    }
    // While it is away it keeps its place: a slide back would be seen in the frame in which it comes.
    let mut last = [0.0; 2];
    let places = shifts.iter().map(|shift| {
        last = shift.unwrap_or(last);
        format!("{:.1},{:.1}", last[0] * SCALE, -last[1] * SCALE)
    });
    let places: Vec<String> = places.collect();
    let seen = shifts.iter().map(|shift| if shift.is_some() { "visible" } else { "hidden" });
    let seen: Vec<&str> = seen.collect();
    let seconds = length(replay);
    svg.add(format_args!(
        "<polygon points=\"{}\" class=\"obstacle\">\n\
         <animateTransform attributeName=\"transform\" type=\"translate\" dur=\"{seconds:.2}s\" repeatCount=\"indefinite\" values=\"{}\"/>\n\
         <animate attributeName=\"visibility\" calcMode=\"discrete\" dur=\"{seconds:.2}s\" repeatCount=\"indefinite\" values=\"{}\"/>\n\
         </polygon>",
        listed(&points),
        places.join(";"),
        seen.join(";"),
    ));
}

/// The robot's disc with a line ahead; place and heading move each on its own.
fn robot(svg: &mut Svg, replay: &Replay<'_>) {
    let radius = replay.radius * SCALE;
    let seconds = length(replay);
    let places = points(replay.arena, replay.trail.iter().map(|pose| pose.position));
    let places = listed(&places).replace(' ', ";");
    let mut turned = 0.0;
    let mut last = None;
    let headings: Vec<String> = replay
        .trail
        .iter()
        .map(|pose| {
            // Across half a turn a picture would spin the long way round.
            turned += crate::geometry::wrap_angle(pose.heading - last.unwrap_or(0.0));
            last = Some(pose.heading);
            format!("{:.1}", -turned.to_degrees())
        })
        .collect();
    svg.add(format_args!(
        "<g><animateTransform attributeName=\"transform\" type=\"translate\" dur=\"{seconds:.2}s\" repeatCount=\"indefinite\" values=\"{places}\"/>\n\
         <g><animateTransform attributeName=\"transform\" type=\"rotate\" dur=\"{seconds:.2}s\" repeatCount=\"indefinite\" values=\"{}\"/>\n\
         <circle r=\"{radius:.1}\" class=\"film-robot\"/>\n\
         <line x2=\"{radius:.1}\" class=\"film-heading\"/></g>\n</g>",
        headings.join(";"),
    ));
}

fn points(arena: Arena, points: impl Iterator<Item = Point>) -> Vec<(f64, f64)> {
    points.map(|at| (at.x * SCALE, (arena.height - at.y) * SCALE)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_comes_later_is_hidden_before_and_what_moves_is_moved_y_down() {
        let corners = vec![[0.0, 0.0], [0.5, 0.0], [0.5, 0.5]];
        let shifts = vec![None, Some([0.0, 0.0]), Some([0.1, 0.2])];
        let still = Body { corners: corners.clone(), shifts: vec![Some([0.0; 2]); 3] };
        let moving = Body { corners, shifts };
        let svg = replay_svg(&Replay {
            arena: Arena { width: 2.0, height: 1.0 },
            radius: 0.1,
            bodies: &[still, moving],
            way: &[],
            trail: &[Pose::new(1.0, 0.5, 0.0); 3],
            frame: Duration::from_millis(50),
            title: "moving",
        });
        assert!(svg.contains("values=\"hidden;visible;visible\""), "{svg}");
        assert!(svg.contains("values=\"0.0,-0.0;0.0,-0.0;40.0,-80.0\""), "{svg}");
        assert_eq!(svg.matches("<animate attributeName=\"visibility\"").count(), 1);
    }
}
