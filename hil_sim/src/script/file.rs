//! Fault scripts as TOML files.
//!
//! ```toml
//! [[fault]]
//! kind = "loss"          # every_kind.toml has one of each
//! share = 0.5            # what the kind needs
//! at = 2.0               # or: place = [x, y, radius], or: event = "turn", nth = 2
//! after = 0.1            # so long after that
//! for = 1.5              # without it: for ever
//! ```

use super::{Event, Fault, Script, Scripted, Trigger, Wheels, WireFault};
use crate::base::{EncoderFault, TruePose};
use crate::camera::CameraFaults;
use crate::motion::{Motion, Mover};
use crate::toml_file::{FileError, Section, must_be, parse};
use crate::wire::{Faults, Pace};
use crate::world::Shape;
use std::time::Duration;

/// A day: nothing is simulated for longer, s.
const LONGEST: f64 = 86_400.0;
/// No shape is faster, m/s: in a tick it moves by less than a robot is wide.
const FASTEST: f64 = 5.0;
/// Beyond this nothing lies, m.
const FARTHEST: f64 = 1000.0;

const EVENTS: [(&str, Event); 4] =
    [("turn", Event::Turn), ("drive", Event::Drive), ("rest", Event::Rest), ("bump", Event::Bump)];

const WHEELS: [(&str, Wheels); 3] =
    [("left", Wheels([true, false])), ("right", Wheels([false, true])), ("both", Wheels::BOTH)];

const DIRECTIONS: [(&str, [bool; 2]); 3] =
    [("to-robot", [true, false]), ("to-host", [false, true]), ("both", [true; 2])];

type Build = fn(&Section<'_>) -> Result<Fault, FileError>;

/// What a fault may be called, and what its table is read by; `every_kind.toml` holds one of each.
const KINDS: [(&str, Build); 28] = [
    ("loss", |s| wires(s, |share| Faults { loss: share, ..Faults::default() })),
    ("corruption", |s| wires(s, |share| Faults { corruption: share, ..Faults::default() })),
    ("duplication", |s| wires(s, |share| Faults { duplication: share, ..Faults::default() })),
    ("truncation", |s| wires(s, |share| Faults { truncation: share, ..Faults::default() })),
    ("reordering", |s| {
        wires(s, |share| Faults { reordering: share, depth: 8, ..Faults::default() })
    }),
    ("delay", delay),
    ("cut", |s| {
        let faults = Faults { loss: 1.0, ..Faults::default() };
        Ok(Fault::Wires(WireFault { directions: directions(s)?, faults, pace: Pace::default() }))
    }),
    ("reset", |_| Ok(Fault::Reset)),
    ("brown-out", |_| Ok(Fault::BrownOut)),
    ("battery", |s| Ok(Fault::Battery(s.needed("volts", 0.0..=60.0)?))),
    ("encoder-stuck", |s| Ok(Fault::Encoder(wheels(s)?, EncoderFault::Stuck))),
    ("encoder-reversed", |s| Ok(Fault::Encoder(wheels(s)?, EncoderFault::Reversed))),
    ("encoder-noisy", |s| {
        let counts = s.needed("counts", 1.0..=10_000.0)? as u32;
        Ok(Fault::Encoder(wheels(s)?, EncoderFault::Noisy(counts)))
    }),
    ("encoder-scaled", |s| {
        Ok(Fault::Encoder(wheels(s)?, EncoderFault::Scaled(s.needed("factor", -10.0..=10.0)?)))
    }),
    ("encoder-missing", |s| {
        Ok(Fault::Encoder(wheels(s)?, EncoderFault::Missing(s.needed("share", 0.0..=1.0)?)))
    }),
    ("encoders-swapped", |_| Ok(Fault::EncodersSwapped)),
    ("blocked", |s| Ok(Fault::Blocked(wheels(s)?))),
    ("slip", |s| Ok(Fault::Slip(wheels(s)?, s.needed("share", 0.0..=1.0)?))),
    ("weak", |s| Ok(Fault::Weak(wheels(s)?, s.needed("share", 0.0..=2.0)?))),
    ("lifted", |_| Ok(Fault::Lifted)),
    ("bump", |s| {
        let push = s.numbers("push")?.ok_or_else(|| s.wrong("push", "[ahead, left, turn]"))?;
        Ok(Fault::Bump(push))
    }),
    ("kidnapped", |s| {
        let to = s.numbers("to")?.ok_or_else(|| s.wrong("to", "[x, y, heading]"))?;
        let [x, y, heading] = to;
        Ok(Fault::Kidnapped(TruePose { x, y, heading }))
    }),
    ("shape", |s| Ok(Fault::Shape(shape(s)?, motion(s)?))),
    ("camera-dark", |_| Ok(Fault::Camera(CameraFaults { dark: true, ..CameraFaults::default() }))),
    ("camera-frozen", |_| {
        Ok(Fault::Camera(CameraFaults { frozen: true, ..CameraFaults::default() }))
    }),
    ("camera-late", |s| {
        let late = Duration::from_secs_f64(s.needed("seconds", 0.0..=60.0)?);
        Ok(Fault::Camera(CameraFaults { late, ..CameraFaults::default() }))
    }),
    ("camera-lost", |s| {
        let lost = s.needed("share", 0.0..=1.0)?;
        Ok(Fault::Camera(CameraFaults { lost, ..CameraFaults::default() }))
    }),
    ("camera-moved", camera_moved),
];

impl Script {
    /// Reads a script: tables `[[fault]]` and nothing else.
    ///
    /// ```
    /// use wmr_sim::script::{Fault, Script};
    /// let script = Script::parse("[[fault]]\nkind = \"reset\"\nat = 2.0\n").unwrap();
    /// assert_eq!(script.faults[0].fault, Fault::Reset);
    /// let error = Script::parse("[[fault]]\nkind = \"loss\"\nshare = 2.0\n").unwrap_err();
    /// assert_eq!(error.to_string(), "line 3: share = 2.0 must be a number from 0 to 1");
    /// ```
    ///
    /// # Errors
    /// [`FileError`]
    pub fn parse(text: &str) -> Result<Self, FileError> {
        let table = parse(text)?;
        let file = Section::new(text, table.get_ref(), 0);
        let script = Self::read(&file)?;
        file.finish()?;
        Ok(script)
    }

    /// The tables `[[fault]]` of a file that holds more.
    pub(crate) fn read(file: &Section<'_>) -> Result<Self, FileError> {
        let faults = file.sections("fault")?.iter().map(scripted).collect::<Result<_, _>>()?;
        Ok(Self { faults })
    }

    /// Reads one fault as a command line has it: its kind, then fields, by commas, such as
    /// `loss,share=0.5,at=2,for=1`.
    ///
    /// # Errors
    /// [`FileError`]
    pub fn parse_short(text: &str) -> Result<Self, FileError> {
        let mut fields = split_outside_brackets(text).into_iter();
        let kind = fields.next().unwrap_or_default();
        let quoted = |field: &str| match field.split_once('=') {
            Some((name, value)) => format!("{name} = {}\n", in_quotes_if_a_word(value)),
            None => format!("{field}\n"),
        };
        let fields: String = fields.map(quoted).collect();
        Self::parse(&format!("[[fault]]\nkind = {kind:?}\n{fields}"))
    }
}

fn split_outside_brackets(text: &str) -> Vec<&str> {
    let mut depth = 0;
    text.split(|letter| {
        depth += i32::from(letter == '[') - i32::from(letter == ']');
        letter == ',' && depth == 0
    })
    .map(str::trim)
    .collect()
}

fn in_quotes_if_a_word(value: &str) -> String {
    let is_word = value.starts_with(|letter: char| letter.is_ascii_alphabetic());
    if is_word { format!("{value:?}") } else { value.to_owned() }
}

fn scripted(section: &Section<'_>) -> Result<Scripted, FileError> {
    let build = section.choice("kind", &KINDS)?;
    let build = build.ok_or_else(|| section.wrong("kind", must_be(&KINDS)))?;
    let scripted = Scripted {
        fault: build(section)?,
        trigger: trigger(section)?,
        delay: seconds(section, "after")?.unwrap_or_default()
            + seconds(section, "at")?.unwrap_or_default(),
        lasts: seconds(section, "for")?,
    };
    section.finish()?;
    Ok(scripted)
}

fn trigger(section: &Section<'_>) -> Result<Trigger, FileError> {
    let given = ["at", "place", "event"].into_iter().filter(|field| section.has(field)).count();
    if given > 1 {
        let field = if section.has("event") { "event" } else { "place" };
        return Err(section.wrong(field, "cannot stand beside another of at, place and event"));
    }
    if let Some([x, y, radius]) = section.numbers("place")? {
        if radius <= 0.0 {
            return Err(section.wrong("place", "must be [x, y, radius] with a radius above 0"));
        }
        return Ok(Trigger::Place { at: [x, y], radius });
    }
    let nth = section.number("nth", 1.0..=1000.0)?;
    match section.choice("event", &EVENTS)? {
        Some(event) => Ok(Trigger::Event { event, nth: nth.unwrap_or(1.0) as u32 }),
        None if nth.is_some() => Err(section.wrong("nth", "belongs to an event")),
        None => Ok(Trigger::Start),
    }
}

fn seconds(section: &Section<'_>, field: &'static str) -> Result<Option<Duration>, FileError> {
    Ok(section.number(field, 0.0..=LONGEST)?.map(Duration::from_secs_f64))
}

fn wheels(section: &Section<'_>) -> Result<Wheels, FileError> {
    let wheels = section.choice("wheel", &WHEELS)?;
    wheels.ok_or_else(|| section.wrong("wheel", must_be(&WHEELS)))
}

fn directions(section: &Section<'_>) -> Result<[bool; 2], FileError> {
    Ok(section.choice("direction", &DIRECTIONS)?.unwrap_or([true; 2]))
}

fn wires(section: &Section<'_>, faults: fn(f64) -> Faults) -> Result<Fault, FileError> {
    let faults = faults(section.needed("share", 0.0..=1.0)?);
    let directions = directions(section)?;
    Ok(Fault::Wires(WireFault { directions, faults, pace: Pace::default() }))
}

fn delay(section: &Section<'_>) -> Result<Fault, FileError> {
    let latency = Duration::from_secs_f64(section.needed("seconds", 0.0..=60.0)?);
    let jitter = seconds(section, "jitter")?.unwrap_or_default();
    let pace = Pace { latency, jitter, baud: None };
    let directions = directions(section)?;
    Ok(Fault::Wires(WireFault { directions, faults: Faults::default(), pace }))
}

fn camera_moved(section: &Section<'_>) -> Result<Fault, FileError> {
    let (by, turn) = (section.numbers("by")?, section.numbers("turn")?);
    if by.is_none() && turn.is_none() {
        return Err(section.wrong("by", "a camera moves by [x, y, z] or turns by [x, y, z]"));
    }
    let moved = Some([by.unwrap_or_default(), turn.unwrap_or_default()]);
    Ok(Fault::Camera(CameraFaults { moved, ..CameraFaults::default() }))
}

/// The shape that a table describes by `rect`, `circle` or `polygon`.
pub(super) fn shape(section: &Section<'_>) -> Result<Shape, FileError> {
    let within = |numbers: &[f64]| numbers.iter().all(|number| number.abs() <= FARTHEST);
    if let Some(rect @ [x0, y0, x1, y1]) = section.numbers("rect")? {
        let sound = within(&rect) && x0 < x1 && y0 < y1;
        let why = "must be [x0, y0, x1, y1] with x0 < x1 and y0 < y1";
        return if sound { Ok(Shape::Rect(rect)) } else { Err(section.wrong("rect", why)) };
    }
    if let Some(circle @ [_, _, radius]) = section.numbers("circle")? {
        let sound = within(&circle) && radius > 0.0;
        let why = "must be [x, y, radius] with a radius above 0";
        return if sound { Ok(Shape::Circle(circle)) } else { Err(section.wrong("circle", why)) };
    }
    match section.points("polygon")? {
        Some(corners) if corners.len() >= 3 => Ok(Shape::Polygon(corners)),
        Some(_) => Err(section.wrong("polygon", "must have at least three corners")),
        None => Err(section.wrong("rect", "a shape is a rect, a circle or a polygon")),
    }
}

/// How the shape of a table moves: by `velocity`, or by `way` with `speed`; without either it stays.
fn motion(section: &Section<'_>) -> Result<Motion, FileError> {
    if let Some(velocity) = section.numbers::<2>("velocity")? {
        let sound = velocity.iter().all(|speed| speed.abs() <= FASTEST);
        let why = format!("must be [x, y] of at most {FASTEST} m/s");
        return if sound {
            Ok(Motion::Velocity(velocity))
        } else {
            Err(section.wrong("velocity", why))
        };
    }
    let Some(shifts) = section.points("way")? else { return Ok(Motion::Still) };
    let speed = section.needed("speed", 0.0..=FASTEST)?;
    let again = section.choice("again", &[("yes", true), ("no", false)])?.unwrap_or(false);
    Ok(Motion::Way { shifts, speed, again })
}

/// The tables of a field that holds shapes that move.
pub(crate) fn movers(section: &Section<'_>, field: &'static str) -> Result<Vec<Mover>, FileError> {
    let read = |section: &Section<'_>| {
        let mover = Mover::new(shape(section)?, motion(section)?, Duration::ZERO);
        section.finish()?;
        Ok(mover)
    };
    section.sections(field)?.iter().map(read).collect()
}

/// The tables of a field that holds shapes.
pub(crate) fn shapes(section: &Section<'_>, field: &'static str) -> Result<Vec<Shape>, FileError> {
    let read = |section: &Section<'_>| {
        let shape = shape(section)?;
        section.finish()?;
        Ok(shape)
    };
    section.sections(field)?.iter().map(read).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One of each kind, with all that it may hold.
    const ALL: &str = include_str!("every_kind.toml");

    #[test]
    fn every_kind_is_read() {
        let script = Script::parse(ALL).unwrap();
        // Shapes come twice: one stays, one moves.
        assert_eq!(script.faults.len(), KINDS.len() + 1);
        for (kind, _) in KINDS {
            assert!(ALL.contains(&format!("kind = \"{kind}\"")), "{kind}");
        }
        let cut = &script.faults[6];
        assert_eq!(cut.trigger, Trigger::Event { event: Event::Turn, nth: 2 });
        assert_eq!(
            (cut.delay, cut.lasts),
            (Duration::from_millis(100), Some(Duration::from_secs(1)))
        );
    }

    #[test]
    fn what_is_wrong_is_refused_with_its_line_and_value() {
        for (text, message) in [
            ("[[fault]]\nkind = \"los\"", "line 2: kind = \"los\" must be \"loss\", "),
            ("[[fault]]\n\nshare = 1", "line 1: kind is missing: must be \"loss\""),
            ("[[fault]]\nkind = \"loss\"\nshare = -0.1", "line 3: share = -0.1 must be a number"),
            ("[[fault]]\nkind = \"loss\"\nshare = nan", "line 3: share = nan must be a number"),
            ("[[fault]]\nkind = \"loss\"", "line 1: share is missing: a number from 0 to 1"),
            (
                "[[fault]]\nkind = \"reset\"\nshare = 1",
                "line 3: there is no share here; there are ",
            ),
            ("[[fault]]\nkind = \"slip\"\nwheel = 3", "line 3: wheel = 3 must be text in quotes"),
            ("[[fault]]\nkind = \"reset\"\nat = \"two\"", "line 3: at = \"two\" must be a number"),
            ("[[fault]]\nkind = \"reset\"\nnth = 2", "line 3: nth = 2 belongs to an event"),
            (
                "[[fault]]\nkind = \"reset\"\nat = 1\nevent = \"turn\"",
                "line 4: event = \"turn\" cannot stand beside",
            ),
            (
                "[[fault]]\nkind = \"shape\"\nrect = [1, 0, 0, 1]",
                "line 3: rect = [1, 0, 0, 1] must be [x0, y0, x1, y1] with x0 < x1",
            ),
            ("[[fault]]\nkind = \"bump\"\npush = [1]", "line 3: push = [1] must be 3 numbers"),
            ("[[fault]\nkind", "line 1: "),
            ("[faults]\n", "line 1: there is no faults here; there are fault"),
        ] {
            let error = Script::parse(text).unwrap_err().to_string();
            assert!(error.starts_with(message), "{text:?}: {error}");
        }
    }

    #[test]
    fn a_short_form_is_the_same_fault() {
        let short = Script::parse_short("slip,wheel=left,share=0.2,place=[1, 2, 0.1],for=0.5");
        let long = "[[fault]]\nkind = \"slip\"\nwheel = \"left\"\nshare = 0.2\n\
                    place = [1, 2, 0.1]\nfor = 0.5";
        assert_eq!(short, Script::parse(long));
        assert!(short.is_ok());
        assert!(Script::parse_short("").is_err());
        assert!(Script::parse_short("reset,at").is_err());
    }
}
