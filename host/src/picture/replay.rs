//! A drive that moves: arena, shapes, the planned way and the robot on its true way, as an animated SVG.
//! Metres, drawn y up.

use crate::geometry::{Arena, Point, Pose};
use std::fmt::Write;
use std::time::Duration;

/// SVG units in a metre.
const SCALE: f64 = 400.0;
/// Room for the title, SVG units.
const TITLE: f64 = 30.0;

/// What is drawn.
#[derive(Clone, Copy, Debug)]
pub struct Replay<'a> {
    /// The floor.
    pub arena: Arena,
    /// Of the robot's disc, m.
    pub radius: f64,
    /// Corners of each shape.
    pub outlines: &'a [Vec<[f64; 2]>],
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
/// use wmr::picture::replay::{Replay, replay_svg};
/// let svg = replay_svg(&Replay {
///     arena: Arena { width: 2.0, height: 1.0 },
///     radius: 0.1,
///     outlines: &[vec![[1.0, 0.0], [1.2, 0.0], [1.2, 0.5]]],
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
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 {:.0} {w:.0} {:.0}\">\n\
         <title>{title}</title>\n\
         <rect width=\"{w:.0}\" height=\"{h:.0}\" fill=\"#f2f0ea\" stroke=\"#333\" stroke-width=\"4\"/>\n\
         <text x=\"8\" y=\"-9\" font-family=\"sans-serif\" font-size=\"17\">{title}</text>\n",
        -TITLE,
        h + TITLE,
        title = escaped(replay.title),
    );
    for outline in replay.outlines {
        let corners = outline.iter().map(|[x, y]| Point::new(*x, *y));
        let points = points(replay.arena, corners);
        let _ = writeln!(svg, "<polygon points=\"{points}\" fill=\"#8a6d5a\"/>");
    }
    let planned = points(replay.arena, replay.way.iter().copied());
    let _ = writeln!(
        svg,
        "<polyline points=\"{planned}\" fill=\"none\" stroke=\"#999\" stroke-width=\"3\" stroke-dasharray=\"8 6\"/>"
    );
    let driven = points(replay.arena, replay.trail.iter().map(|pose| pose.position));
    let _ = writeln!(
        svg,
        "<polyline points=\"{driven}\" fill=\"none\" stroke=\"#1f6fd6\" stroke-width=\"2\"/>"
    );
    svg.push_str(&robot(replay));
    svg + "</svg>\n"
}

/// The robot's disc with a line ahead; place and heading move each on its own.
fn robot(replay: &Replay<'_>) -> String {
    let radius = replay.radius * SCALE;
    let seconds = replay.frame.as_secs_f64() * replay.trail.len().max(1) as f64;
    let places = points(replay.arena, replay.trail.iter().map(|pose| pose.position));
    let places = places.replace(' ', ";");
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
    format!(
        "<g><animateTransform attributeName=\"transform\" type=\"translate\" dur=\"{seconds:.2}s\" repeatCount=\"indefinite\" values=\"{places}\"/>\n\
         <g><animateTransform attributeName=\"transform\" type=\"rotate\" dur=\"{seconds:.2}s\" repeatCount=\"indefinite\" values=\"{}\"/>\n\
         <circle r=\"{radius:.1}\" fill=\"#1f6fd6\" fill-opacity=\"0.35\" stroke=\"#1f6fd6\" stroke-width=\"2\"/>\n\
         <line x2=\"{radius:.1}\" stroke=\"#0b3a78\" stroke-width=\"4\"/></g>\n</g>\n",
        headings.join(";"),
    )
}

fn points(arena: Arena, points: impl Iterator<Item = Point>) -> String {
    let texts: Vec<String> = points
        .map(|at| format!("{:.1},{:.1}", at.x * SCALE, (arena.height - at.y) * SCALE))
        .collect();
    texts.join(" ")
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;")
}
