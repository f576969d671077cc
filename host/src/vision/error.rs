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
    /// The tags in the arena's corners are not four.
    #[error(
        "{} found where four tags in the arena's corners are needed; show all four flat, sharp and with a white rim, print them larger, or give --corners",
        tags_seen(.seen)
    )]
    CornerTags {
        /// The numbers of the tags that are seen, without those of robot and goal.
        seen: Vec<usize>,
    },
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
    /// What looks like the border is not a rectangle of the stated size seen by any camera, or it is the
    /// top of a wall whose faces line the arena.
    #[error("what looks like the border is no rectangle of {} x {} m seen by any camera{}: the size is wrong, or a box, shadow or wall top hides part of it; check --arena, clear the border, or give --corners", .arena.width, .arena.height, seen_ratio(.arena, .ratio))]
    OddBorder {
        /// The arena that was looked for.
        arena: Arena,
        /// How much longer its width is seen against its height than was stated, if that is known.
        ratio: Option<f64>,
    },
    /// A corner of the arena lies outside the photo.
    #[error("the arena is partly out of view: corner {corner} lies at pixel ({:.0}, {:.0}); move the camera so that all four corners are seen", .pixel[0], .pixel[1])]
    OutOfView {
        /// 0 lower left, 1 lower right, 2 upper right, 3 upper left.
        corner: usize,
        /// Where the corner would be.
        pixel: [f64; 2],
    },
    /// The arena fills the photo: whether its border is in view cannot be told.
    #[error(
        "the arena's {side} side lies at the edge of the photo, so that its border cannot be told from where the photo ends; show some of the ground around it, or give --corners"
    )]
    AtTheEdge {
        /// Which side.
        side: &'static str,
    },
    /// Pictures by one camera have one size.
    #[error("photo {photo} has {} x {} pixels, the first has {} x {}; calibrate with photos by one camera at one setting", .other[0], .other[1], .first[0], .first[1])]
    Sizes {
        /// Width and height of the first photo.
        first: [usize; 2],
        /// Which photo differs, counted from 1.
        photo: usize,
        /// Its width and height.
        other: [usize; 2],
    },
    /// Pictures from one place that do not show the arena at one place.
    #[error("the camera moved between photos {} and {}, or the border was mistaken in one: they show corner {corner} {shift:.1} pixels apart, at most {allowed:.1} is expected; leave one out, or take them anew with the camera fixed", .photos[0], .photos[1])]
    Moved {
        /// The photos that differ most, counted from 1.
        photos: [usize; 2],
        /// 0 lower left, 1 lower right, 2 upper right, 3 upper left.
        corner: usize,
        /// How far apart the corner appears, pixels.
        shift: f64,
        /// The greatest distance, pixels.
        allowed: f64,
    },
    /// A photo and a picture of the empty arena that differ in size.
    #[error("the picture of the empty arena has {} x {} pixels, the photo has {} x {}; take both with the same camera at the same setting", .empty[0], .empty[1], .photo[0], .photo[1])]
    EmptySize {
        /// Width and height of the photo.
        photo: [usize; 2],
        /// Width and height of the empty picture.
        empty: [usize; 2],
    },
    /// The camera does not stand where it stood.
    #[error("the camera moved since the picture of the empty arena was taken: this photo is shifted by {shift:.1} pixels and turned by {:.2}°, at most 0.4 pixels and 0.035° are allowed; clear the arena and take a new picture, or leave --empty out", .turn.to_degrees())]
    EmptyMoved {
        /// How far the photo is shifted, pixels.
        shift: f64,
        /// How far it is turned, radians, clockwise as it is seen.
        turn: f64,
    },
    /// A picture of the empty arena that shows something else, or from elsewhere.
    #[error("the picture of the empty arena shows something else: {:.0} % of its edges are where the photo has them, {:.0} % is needed; the camera was moved far, or the picture is of another arena: take a new one, or leave --empty out", 100.0 * .measured, 100.0 * .needed)]
    EmptyUnlike {
        /// The share of edges that agree.
        measured: f64,
        /// The least share.
        needed: f64,
    },
    /// A height of the camera at which no picture looks like this one.
    #[error(
        "from {given} m above the floor the border would look otherwise: it shows a camera {measured:.2} m above, give or take {spread:.2} m; measure straight up from the floor to the lens, check --arena, or tell by --corners where the border is"
    )]
    KnownHeight {
        /// The height given, metres.
        given: f64,
        /// The height without it, metres.
        measured: f64,
        /// Its standard deviation, metres.
        spread: f64,
    },
    /// A focal length with which no picture looks like this one.
    #[error(
        "with a focal length of {given:.0} pixels the border would look otherwise: it shows {measured:.0}, give or take {spread:.0}; give the focal length in pixels of these photos, or tell by --corners where the border is"
    )]
    KnownFocal {
        /// The focal length given, pixels.
        given: f64,
        /// The focal length without it, pixels.
        measured: f64,
        /// Its standard deviation, pixels.
        spread: f64,
    },
    /// A focal length that no lens has.
    #[error("such a camera would have a focal length of {widths:.2} widths of the photo, lenses have {} to {}; check --height, --focal and --arena", .range[0], .range[1])]
    OddFocal {
        /// The focal length, widths of the photo.
        widths: f64,
        /// What lenses have.
        range: [f64; 2],
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

/// What is to be said about the ratio of sides that is seen.
fn seen_ratio(arena: &Arena, ratio: &Option<f64>) -> String {
    let stated = arena.width / arena.height;
    match ratio.map(|ratio| ratio * stated) {
        Some(seen) if (seen / stated).ln().abs() > 0.005 => {
            format!(" (its sides are as {seen:.2} to 1, {stated:.2} to 1 was stated)")
        }
        _ => String::new(),
    }
}

fn tags_seen(seen: &[usize]) -> String {
    match seen {
        [] => "no tag was".to_owned(),
        [only] => format!("one tag ({only}) was"),
        many => {
            let numbers: Vec<String> = many.iter().map(usize::to_string).collect();
            format!("{} tags ({}) were", many.len(), numbers.join(", "))
        }
    }
}
