//! Why a photo was refused: what was measured, what is needed and what to do.

use crate::geometry::{Arena, Side};
use crate::vision::border::{PictureCorner, SeenBorder};
use miette::Diagnostic;
use thiserror::Error;

/// A photo that cannot be used, or a request that makes no sense.
#[derive(Clone, Debug, PartialEq, Error, Diagnostic)]
pub enum VisionError {
    /// The bytes are no complete picture of a format that is read.
    #[error("the photo cannot be decoded ({reason})")]
    #[diagnostic(help("give a complete PNG or JPEG file (WebP, BMP, TIFF and GIF are read too)"))]
    Decode {
        /// What the decoder met.
        reason: String,
    },
    /// A format that phones write.
    #[error("the photo is {format}, which is not read")]
    #[diagnostic(help(
        "save it as JPEG: on an iPhone choose Settings > Camera > Formats > Most Compatible, on a computer export it, or type: heif-convert photo photo.jpg"
    ))]
    Format {
        /// Its name.
        format: &'static str,
    },
    /// More pixels than the bound on memory allows.
    #[error("the photo has {width} x {height} pixels, at most {limit} are read")]
    #[diagnostic(help("scale it down"))]
    TooLarge {
        /// Pixels in a row.
        width: u32,
        /// Rows.
        height: u32,
        /// The greatest number of pixels.
        limit: u64,
    },
    /// Too few pixels to find anything.
    #[error("the photo has {width} x {height} pixels, at least {least} x {least} are needed")]
    #[diagnostic(help("take a larger one"))]
    TooSmall {
        /// Pixels in a row.
        width: usize,
        /// Rows.
        height: usize,
        /// The least width and height.
        least: usize,
    },
    /// The stated floor cannot be one.
    #[error("an arena of {} x {} m is not possible", .0.width, .0.height)]
    #[diagnostic(help("give its inner width and height in metres, 0.1 to 100 each, at most 10 to 1{}", meant(.0)))]
    ArenaSize(Arena),
    /// The robot's radius cannot be one.
    #[error("a robot radius of {0} m is not possible")]
    #[diagnostic(help("give it in metres, more than 0 and less than half the arena"))]
    RobotRadius(f64),
    /// The given corners do not enclose a floor.
    #[error("the corners given enclose no floor")]
    #[diagnostic(help("list lower left, lower right, upper right, upper left, in pixels"))]
    Corners,
    /// The given corners run clockwise, or their sides cross.
    #[error("the corners given do not run counter-clockwise around the floor")]
    #[diagnostic(help("give them as --corners \"{}\"", pixels(.order)))]
    CornerOrder {
        /// The same corners in the order that encloses a floor, from the first one on.
        order: [[f64; 2]; 4],
    },
    /// The given corners are not those of the stated arena, however a camera may see it.
    #[error("the corners given are no arena of {} x {} m seen by any camera{}", .arena.width, .arena.height, odd_sides(.arena, .seen))]
    #[diagnostic(help("{}", corners_cure(.order)))]
    CornerShape {
        /// The arena that was stated.
        arena: Arena,
        /// The ratio of width to height that they show, if they show a rectangle.
        seen: Option<f64>,
        /// The order in which they fit.
        order: Option<[[f64; 2]; 4]>,
    },
    /// The tags in the arena's corners are not four.
    #[error("{} found in the arena's corners: four are needed, or of one size and along its sides three, or two that are far apart", tags_seen(.seen))]
    #[diagnostic(help(
        "show all four flat, sharp and with a white rim, print them larger, or give --corners"
    ))]
    CornerTags {
        /// The numbers of the tags that are seen, without those of robot and goal.
        seen: Vec<usize>,
    },
    /// The given camera cannot be one.
    #[error("the camera given makes no sense ({reason})")]
    #[diagnostic(help("check the camera file"))]
    Camera {
        /// Which part is wrong.
        reason: String,
    },
    /// Hardly any light.
    #[error(
        "the photo is black: 99 of 100 pixels are below {measured} of 255, at least {needed} is needed"
    )]
    #[diagnostic(help("light the arena or expose longer"))]
    Dark {
        /// The 99th percentile of brightness, 0 to 255.
        measured: u8,
        /// The least.
        needed: u8,
    },
    /// Too much light.
    #[error("the photo is overexposed: {:.0} % of it is burnt out, at most {:.0} % may be", 100.0 * .measured, 100.0 * .allowed)]
    #[diagnostic(help("expose shorter or dim the lamp"))]
    Overexposed {
        /// The share of pixels with all channels at their end.
        measured: f64,
        /// The greatest share.
        allowed: f64,
    },
    /// Edges are ramps.
    #[error("the photo is blurred: its edges rise by {:.0} % of their height within 2 pixels, at least {:.0} % is needed", 100.0 * .measured, 100.0 * .needed)]
    #[diagnostic(help("focus the camera and hold it still"))]
    Blurred {
        /// The height of the strongest steps across 2 pixels over that across 8.
        measured: f64,
        /// The least ratio.
        needed: f64,
    },
    /// Dark and bright hardly differ.
    #[error(
        "the photo has no contrast: its strongest edges step by {measured:.1} of 255, at least {needed:.1} is needed"
    )]
    #[diagnostic(help("mark the border with dark tape, use better light"))]
    NoContrast {
        /// The 99.5th percentile of the edges' height, 0 to 255.
        measured: f64,
        /// The least.
        needed: f64,
    },
    /// No quadrilateral looks like the arena's border.
    #[error("no border of an arena of {} x {} m is seen: the best candidate scores {measured:.2}, {needed:.2} is needed{}", .arena.width, .arena.height, other_ratio(.arena, .seen))]
    #[diagnostic(help("{}have all four sides in view, check the size, or give --corners", contrast(.seen)))]
    NoBorder {
        /// The arena that was looked for.
        arena: Arena,
        /// The best candidate's score, 0 to 1.
        measured: f64,
        /// The least score.
        needed: f64,
        /// What is seen at that candidate.
        seen: Option<SeenBorder>,
    },
    /// What looks like the border is not a rectangle of the stated size seen by any camera, or it is the
    /// top of a wall whose faces line the arena.
    #[error("what looks like the border is no rectangle of {} x {} m seen by any camera{}: the size is wrong, or a box, shadow or wall top hides part of it", .arena.width, .arena.height, seen_ratio(.arena, .ratio))]
    #[diagnostic(help("check --arena, clear the border, or give --corners"))]
    OddBorder {
        /// The arena that was looked for.
        arena: Arena,
        /// How much longer its width is seen against its height than was stated, if that is known.
        ratio: Option<f64>,
    },
    /// The arena lies the other way round than its origin says.
    #[error(
        "with (0, 0) at the {origin} of the picture the arena lies the other way: its longer side is seen along the other direction"
    )]
    #[diagnostic(help("give --arena {}x{}, or another --origin", .arena.height, .arena.width))]
    Origin {
        /// The corner that was to be the origin.
        origin: PictureCorner,
        /// The arena that was stated.
        arena: Arena,
    },
    /// The camera looks along the floor rather than down on it.
    #[error("this is no overhead view: the camera is tilted by {:.0}° from straight down, at most {:.0}° is allowed", .tilt.to_degrees(), .allowed.to_degrees())]
    #[diagnostic(help("hang it higher above the arena's middle"))]
    Tilted {
        /// The angle between the camera's axis and straight down, radians.
        tilt: f64,
        /// The greatest.
        allowed: f64,
    },
    /// A corner of the arena lies outside the photo.
    #[error("the arena is partly out of view: corner {corner} lies at pixel ({:.0}, {:.0})", .pixel[0], .pixel[1])]
    #[diagnostic(help("move the camera so that all four corners are seen"))]
    OutOfView {
        /// 0 lower left, 1 lower right, 2 upper right, 3 upper left.
        corner: usize,
        /// Where the corner would be.
        pixel: [f64; 2],
    },
    /// The arena fills the photo: whether its border is in view cannot be told.
    #[error(
        "the arena's {side} side lies at the edge of the photo, so that its border cannot be told from where the photo ends"
    )]
    #[diagnostic(help("show some of the ground around it, or give --corners"))]
    AtTheEdge {
        /// Which side.
        side: Side,
    },
    /// What looks like the arena is so small in the photo that it may be a box or a card.
    #[error(
        "what looks like the border encloses only {:.0} % of the photo, less than {:.0} %: it may be a box or a card",
        100.0 * .share,
        100.0 * .needed
    )]
    #[diagnostic(help("cut the photo closer to the arena, or give --corners"))]
    SmallBorder {
        /// The share of the photo that lies inside.
        share: f64,
        /// The share that is needed.
        needed: f64,
    },
    /// One side of the border is mostly hidden, so that where it runs is a guess.
    #[error(
        "the arena's {side} side is seen on only {:.0} % of its length, {:.0} % is needed",
        100.0 * .share,
        100.0 * .needed
    )]
    #[diagnostic(help("clear that side, or give --corners"))]
    HiddenSide {
        /// The side.
        side: Side,
        /// The share of it that shows the border.
        share: f64,
        /// The share that is needed.
        needed: f64,
    },
    /// Pictures by one camera have one size.
    #[error("photo {photo} has {} x {} pixels, the first has {} x {}", .other[0], .other[1], .first[0], .first[1])]
    #[diagnostic(help("calibrate with photos by one camera at one setting"))]
    Sizes {
        /// Width and height of the first photo.
        first: [usize; 2],
        /// Which photo differs, counted from 1.
        photo: usize,
        /// Its width and height.
        other: [usize; 2],
    },
    /// Pictures from one place that do not show the arena at one place.
    #[error("the camera moved between photos {} and {}, or the border was mistaken in one: they show corner {corner} {shift:.1} pixels apart, at most {allowed:.1} is expected", .photos[0], .photos[1])]
    #[diagnostic(help("leave one out, or take them again with the camera fixed"))]
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
    #[error("the picture of the empty arena has {} x {} pixels, the photo has {} x {}", .empty[0], .empty[1], .photo[0], .photo[1])]
    #[diagnostic(help("take both with the same camera at the same setting"))]
    EmptySize {
        /// Width and height of the photo.
        photo: [usize; 2],
        /// Width and height of the empty picture.
        empty: [usize; 2],
    },
    /// The camera does not stand where it stood.
    #[error("the camera moved since the picture of the empty arena was taken: this photo is shifted by {shift:.1} pixels and turned by {:.2}°, at most 0.4 pixels and 0.035° are allowed", .turn.to_degrees())]
    #[diagnostic(help("clear the arena and take a new picture, or leave --empty out"))]
    EmptyMoved {
        /// How far the photo is shifted, pixels.
        shift: f64,
        /// How far it is turned, radians, clockwise as it is seen.
        turn: f64,
    },
    /// A picture of the empty arena that shows something else, or from elsewhere.
    #[error("the picture of the empty arena shows something else: {:.0} % of its edges are where the photo has them, {:.0} % is needed", 100.0 * .measured, 100.0 * .needed)]
    #[diagnostic(help(
        "the camera was moved far, or the picture is of another arena: take a new one, or leave --empty out"
    ))]
    EmptyUnlike {
        /// The share of edges that agree.
        measured: f64,
        /// The least share.
        needed: f64,
    },
    /// A height of the camera at which no picture looks like this one.
    #[error(
        "from {given} m above the floor the border would look otherwise: it shows a camera {measured:.2} ± {spread:.2} m above"
    )]
    #[diagnostic(help(
        "measure straight up from the floor to the lens, check --arena, or tell by --corners where the border is"
    ))]
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
        "with a focal length of {given:.0} pixels the border would look otherwise: it shows {measured:.0} ± {spread:.0}"
    )]
    #[diagnostic(help(
        "give the focal length in pixels of these photos, or tell by --corners where the border is"
    ))]
    KnownFocal {
        /// The focal length given, pixels.
        given: f64,
        /// The focal length without it, pixels.
        measured: f64,
        /// Its standard deviation, pixels.
        spread: f64,
    },
    /// A focal length that no lens has.
    #[error("such a camera would have a focal length of {sides:.2} longer sides of the photo, lenses have {} to {}", .range[0], .range[1])]
    #[diagnostic(help("check --height, --focal and --arena"))]
    OddFocal {
        /// The focal length, longer sides of the photo.
        sides: f64,
        /// What lenses have.
        range: [f64; 2],
    },
    /// Two pictures from which no heights can be told.
    #[error("the two photos show no heights ({reason})")]
    #[diagnostic(help("give two photos of one arena by two cameras apart, and their camera file"))]
    Pair {
        /// What is wrong.
        reason: String,
    },
}

/// What was perhaps meant by an arena of hundreds of metres.
fn meant(arena: &Arena) -> String {
    let unit = match arena.width.max(arena.height) {
        size if size >= 1000.0 => "mm",
        size if size > 100.0 => "cm",
        _ => return String::new(),
    };
    format!("; did you mean {}{unit}x{}{unit}?", arena.width, arena.height)
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

/// What a candidate shows that the stated arena does not have.
fn other_ratio(arena: &Arena, seen: &Option<SeenBorder>) -> String {
    let ratio = seen.and_then(|seen| seen.other_ratio(*arena));
    ratio.map_or(String::new(), |words| format!(" ({words})"))
}

fn contrast(seen: &Option<SeenBorder>) -> String {
    let advice = seen.and_then(|seen| seen.contrast_advice());
    advice.map_or(String::new(), |words| words + "; ")
}

fn odd_sides(arena: &Arena, seen: &Option<f64>) -> String {
    let stated = arena.width / arena.height;
    seen.map_or(String::new(), |seen| {
        format!(" (its sides are as {seen:.2} to 1, {stated:.2} to 1 was stated)")
    })
}

fn corners_cure(order: &Option<[[f64; 2]; 4]>) -> String {
    match order {
        Some(order) => format!(
            "begun at another corner they are: give --corners \"{}\", or turn --arena",
            pixels(order)
        ),
        None => "check the corners and --arena".into(),
    }
}

/// Corners as `--corners` takes them.
fn pixels(corners: &[[f64; 2]; 4]) -> String {
    let rounded = |value: f64| (10.0 * value).round() / 10.0;
    corners.map(|[x, y]| format!("{},{}", rounded(x), rounded(y))).join(" ")
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
