//! What a person should know about an answer that is given all the same: what was seen, and what to do.

use super::border::PictureCorner;
use crate::geometry::Arena;

/// A doubt about a [`Detection`](super::Detection). Metres in the arena frame, pixels of the photo.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Warning {
    /// What is taken for the border is not quite a rectangle.
    #[error(
        "the border fits a rectangle only to {residual:.1} pixels; straighten the tape or give --corners"
    )]
    RoughBorder {
        /// How far its sides lie from the rectangle's, root mean square, pixels.
        residual: f64,
    },
    /// The border is elsewhere than the camera has it.
    #[error(
        "the border is not seen where the camera file has it: the camera may have moved; calibrate it again"
    )]
    CameraMoved {
        /// How much of the border is seen there, 0 to 1.
        seen: f64,
    },
    /// Corners of the arena show no tag.
    #[error(
        "no tag is seen at the {} of the picture; the other tags say where that is to about {spread:.1} pixels",
        listed(missing)
    )]
    CornerTags {
        /// The corners that show none.
        missing: Vec<PictureCorner>,
        /// The standard deviation of their places, pixels.
        spread: f64,
    },
    /// The stated size fits only if (0, 0) is at the lower right.
    #[error(
        "by its size the arena's width runs up in the picture: (0, 0) is the corner at the lower right; --origin says otherwise"
    )]
    WidthRunsUp,
    /// The given corners are not quite those of the stated arena.
    #[error("{}", rough_corners(arena, seen))]
    RoughCorners {
        /// The arena that was stated.
        arena: Arena,
        /// The ratio of width to height that they show, if they show a rectangle.
        seen: Option<f64>,
    },
    /// The given corners begin elsewhere than at the lower left of the picture.
    #[error(
        "the corners given begin at the {} of the picture: (0, 0) lies there; --origin {} says that this is meant",
        .0, .0.option()
    )]
    FirstCorner(PictureCorner),
    /// The photo ends within the arena.
    #[error(
        "{:.1} % of the floor lies outside the photo (x {:.2} to {:.2} m, y {:.2} to {:.2} m): what stands there is not seen",
        100.0 * share, x[0], x[1], y[0], y[1]
    )]
    FloorOutOfView {
        /// The share of the floor, 0 to 1.
        share: f64,
        /// The range of x in which it lies.
        x: [f64; 2],
        /// The range of y.
        y: [f64; 2],
    },
    /// The floor looks as boxes may look.
    #[error(
        "the floor's brightness varies by {:.0} %, shadow leaves {:.0} % of it: boxes that look like floor or shadow may be missed or misplaced; check the obstacles",
        100.0 * spread, 100.0 * in_shadow
    )]
    HardFloor {
        /// The standard deviation of its brightness, as a share.
        spread: f64,
        /// The share of its brightness that shadow leaves.
        in_shadow: f64,
    },
    /// A tag that was asked for is not seen.
    #[error("tag {id} of the {of} is not seen; show it flat and sharp, with a white rim")]
    TagNotSeen {
        /// What it marks: `robot` or `goal`.
        of: &'static str,
        /// Its number.
        id: usize,
    },
    /// The robot's place depends on the height of the camera, of which nothing tells.
    #[error(
        "nothing in the photo tells how high the camera hangs, so the robot may stand up to {:.0} mm farther out than is said; calibrate the camera and give --camera",
        1000.0 * doubt
    )]
    RobotPlace {
        /// How far out, metres.
        doubt: f64,
    },
    /// Lines that were passed over.
    #[error(
        "thin lines from one side of the arena to the other are taken for lines on the floor: if they are walls, the plan goes through them"
    )]
    FloorLines,
    /// Two photos differ where no box explains it.
    #[error(
        "no box explains {:.0} cm² on which the photos disagree: a box may be missed there; look at the picture of the disagreement (--steps)",
        1e4 * area
    )]
    Unexplained {
        /// The area of the floor, square metres.
        area: f64,
    },
}

fn listed(corners: &[PictureCorner]) -> String {
    let names: Vec<String> = corners.iter().map(ToString::to_string).collect();
    names.join(" and the ")
}

fn rough_corners(arena: &Arena, seen: &Option<f64>) -> String {
    match seen {
        Some(seen) => format!(
            "the sides of the corners given are as {seen:.2} to 1, {:.2} to 1 was stated: check --arena and the corners",
            arena.width / arena.height
        ),
        None => "the corners given are those of no rectangle that a camera sees, to a few percent: check them".into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_values_are_in_the_words() {
        let missing = vec![PictureCorner::LowerRight, PictureCorner::UpperLeft];
        let words = Warning::CornerTags { missing, spread: 1.25 }.to_string();
        assert!(words.starts_with("no tag is seen at the lower right and the upper left of the"));
        let words = Warning::HardFloor { spread: 0.031, in_shadow: 0.449 }.to_string();
        assert!(words.contains("varies by 3 %, shadow leaves 45 %"), "{words}");
        let words = Warning::FirstCorner(PictureCorner::UpperRight).to_string();
        assert!(words.ends_with("--origin upper-right says that this is meant"), "{words}");
    }
}
