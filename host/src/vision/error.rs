//! Why a photo was refused: what was measured, what is needed and what to do.

use crate::geometry::Arena;
use thiserror::Error;

/// A photo that cannot be used, or a request that makes no sense.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum VisionError {
    /// The bytes are no complete PNG or JPEG.
    #[error("the photo cannot be decoded ({reason}); give a complete PNG or JPEG file")]
    Decode {
        /// What the decoder met.
        reason: String,
    },
    /// More pixels than the bound on memory allows.
    #[error("the photo has {width} x {height} pixels, at most {limit} are read; scale it down")]
    TooLarge {
        /// Pixels in a row.
        width: u32,
        /// Rows.
        height: u32,
        /// The greatest number of pixels.
        limit: u64,
    },
    /// Too few pixels to find anything.
    #[error(
        "the photo has {width} x {height} pixels, at least {least} x {least} are needed; take a larger one"
    )]
    TooSmall {
        /// Pixels in a row.
        width: usize,
        /// Rows.
        height: usize,
        /// The least width and height.
        least: usize,
    },
    /// The stated floor cannot be one.
    #[error("an arena of {} x {} m is not possible; give its inner width and height in metres, 0.1 to 100 each, at most 10 to 1", .0.width, .0.height)]
    ArenaSize(Arena),
    /// The robot's radius cannot be one.
    #[error(
        "a robot radius of {0} m is not possible; give it in metres, more than 0 and less than half the arena"
    )]
    RobotRadius(f64),
    /// The given corners do not enclose a floor.
    #[error(
        "the corners given enclose no floor: list lower left, lower right, upper right, upper left, in pixels"
    )]
    Corners,
    /// The given camera cannot be one.
    #[error("the camera given makes no sense ({reason}); check the camera file")]
    Camera {
        /// Which part is wrong.
        reason: String,
    },
    /// Hardly any light.
    #[error(
        "the photo is black: 99 of 100 pixels are below {measured} of 255, at least {needed} is needed; light the arena or expose longer"
    )]
    Dark {
        /// The 99th percentile of brightness, 0 to 255.
        measured: u8,
        /// The least.
        needed: u8,
    },
    /// Too much light.
    #[error(
        "the photo is overexposed: {:.0} % of it is burnt out, at most {:.0} % may be; expose shorter or dim the lamp", 100.0 * .measured, 100.0 * .allowed
    )]
    Overexposed {
        /// The share of pixels with all channels at their end.
        measured: f64,
        /// The greatest share.
        allowed: f64,
    },
    /// Edges are ramps.
    #[error(
        "the photo is blurred: its edges rise by {:.0} % of their height within 2 pixels, at least {:.0} % is needed; focus the camera and hold it still", 100.0 * .measured, 100.0 * .needed
    )]
    Blurred {
        /// The height of the strongest steps across 2 pixels over that across 8.
        measured: f64,
        /// The least ratio.
        needed: f64,
    },
    /// Dark and bright hardly differ.
    #[error(
        "the photo has no contrast: its strongest edges step by {measured:.1} of 255, at least {needed:.1} is needed; mark the border with dark tape, use better light"
    )]
    NoContrast {
        /// The 99.5th percentile of the edges' height, 0 to 255.
        measured: f64,
        /// The least.
        needed: f64,
    },
    /// No quadrilateral looks like the arena's border.
    #[error("no border of an arena of {} x {} m is seen: the best candidate scores {measured:.2}, {needed:.2} is needed; have all four sides in view, check the size, or give --corners", .arena.width, .arena.height)]
    NoBorder {
        /// The arena that was looked for.
        arena: Arena,
        /// The best candidate's score, 0 to 1.
        measured: f64,
        /// The least score.
        needed: f64,
    },
    /// What looks like the border is not a rectangle of the stated size seen by any camera.
    #[error("what looks like the border is no rectangle of {} x {} m seen by any camera: a box, shadow or wall top hides part of it, or the size is wrong; clear the border, check the size, or give --corners", .arena.width, .arena.height)]
    OddBorder {
        /// The arena that was looked for.
        arena: Arena,
    },
    /// A corner of the arena lies outside the photo.
    #[error("the arena is partly out of view: corner {corner} lies at pixel ({:.0}, {:.0}); move the camera so that all four corners are seen", .pixel[0], .pixel[1])]
    OutOfView {
        /// 0 lower left, 1 lower right, 2 upper right, 3 upper left.
        corner: usize,
        /// Where the corner would be.
        pixel: [f64; 2],
    },
    /// Two pictures from which no heights can be told.
    #[error(
        "the two photos show no heights ({reason}); give two photos of one arena by two cameras apart, and their camera file"
    )]
    Pair {
        /// What is wrong.
        reason: String,
    },
}
