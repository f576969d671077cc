//! Numbers with units as a person types them: metres and degrees, or with a suffix.

use hil_sim::presets::Preset;
use hil_sim::scenario::Moment;
use std::time::Duration;
use wmr::geometry::{Arena, Point};
use wmr::scene::Goal;
use wmr::shape::Circle;

/// A suffix, and what its numbers become: divided, so that 1400mm is 1.4 and not the next number to it.
type Unit = (&'static str, fn(f64) -> f64);

const LENGTHS: [Unit; 3] = [("mm", |mm| mm / 1000.0), ("cm", |cm| cm / 100.0), ("m", |m| m)];
const ANGLES: [Unit; 2] = [("deg", f64::to_radians), ("rad", |rad| rad)];
const SPANS: [Unit; 3] = [("ms", |ms| ms / 1000.0), ("min", |min| min * 60.0), ("s", |s| s)];
const SECONDS: [Unit; 1] = [("s", |s| s)];

/// A length in metres from `0.3`, `0.3m`, `30cm` or `300mm`.
pub(crate) fn length(text: &str) -> Result<f64, String> {
    scaled(text, &LENGTHS, LENGTHS[2].1)
        .ok_or_else(|| format!("{text:?} is no length; write 0.3, 0.3m, 30cm or 300mm"))
}

/// A length that is not negative, metres.
pub(crate) fn distance(text: &str) -> Result<f64, String> {
    let metres = length(text)?;
    if metres < 0.0 {
        Err(format!("{text} is negative; a distance is 0 or more"))
    } else {
        Ok(metres)
    }
}

/// The side of an area of the fuzzy grid, metres: above 0.
pub(crate) fn area_side(text: &str) -> Result<f64, String> {
    let metres = length(text)?;
    if metres > 0.0 { Ok(metres) } else { Err(format!("{text} is no side of an area; write 10mm")) }
}

/// The weight of risk: 0 to [`wmr::plan::LARGEST_RISK_WEIGHT`].
pub(crate) fn risk_weight(text: &str) -> Result<f64, String> {
    let most = wmr::plan::LARGEST_RISK_WEIGHT;
    let value = finite(text).filter(|value| (0.0..=most).contains(value));
    value.ok_or_else(|| format!("{text:?} is no weight of risk; write 0 to {most}"))
}

/// A camera's height above the floor, metres: 0.1 to 200.
pub(crate) fn height(text: &str) -> Result<f64, String> {
    let value = length(text).ok().filter(|value| (0.1..=200.0).contains(value));
    value.ok_or_else(|| format!("{text:?} is no height of a camera; write 0.1 to 200 metres"))
}

/// A focal length in pixels: 10 to a million.
pub(crate) fn focal(text: &str) -> Result<f64, String> {
    let value = finite(text).filter(|value| (10.0..=1e6).contains(value));
    value
        .ok_or_else(|| format!("{text:?} is no focal length; write pixels of the photo, 10 to 1e6"))
}

/// How many times as fast as the clock something runs: 0.1 to 100.
pub(crate) fn speed(text: &str) -> Result<f64, String> {
    let value = finite(text).filter(|value| (0.1..=100.0).contains(value));
    value.ok_or_else(|| format!("{text:?} is no speed; write how many times as fast, 0.1 to 100"))
}

/// An angle in radians from `90`, `90deg` or `1.57rad`.
pub(crate) fn angle(text: &str) -> Result<f64, String> {
    scaled(text, &ANGLES, ANGLES[0].1)
        .ok_or_else(|| format!("{text:?} is no angle; write 90, 90deg or 1.57rad"))
}

/// The longest that a robot accepts for one leg, seconds.
const LONGEST_LEG: f64 = 900.0;

/// How long a leg takes, seconds: above 0 and at most [`LONGEST_LEG`].
pub(crate) fn leg_time(text: &str) -> Result<f64, String> {
    let value = scaled(text, &SECONDS, SECONDS[0].1);
    let value = value.filter(|value| *value > 0.0 && *value <= LONGEST_LEG);
    value.ok_or_else(|| {
        format!("{text:?} is no time for a leg; write seconds above 0 and up to {LONGEST_LEG}")
    })
}

/// A time to wait, from `10`, `10s`, `500ms` or `2min`: above 0, up to a day.
pub(crate) fn span(text: &str) -> Result<Duration, String> {
    let value = scaled(text, &SPANS, SPANS[2].1).filter(|value| *value > 0.0 && *value <= 86_400.0);
    value
        .map(Duration::from_secs_f64)
        .ok_or_else(|| format!("{text:?} is no duration; write 10s, 500ms or 2min, up to a day"))
}

/// The side of a square to calibrate in, metres: 0.3 to 5. On longer ones a robot that is far out of
/// tune ends where nothing can be told of it.
pub(crate) fn side(text: &str) -> Result<f64, String> {
    let value = length(text).ok().filter(|value| (0.3..=5.0).contains(value));
    value.ok_or_else(|| format!("{text:?} is no side; write a length from 0.3 to 5 metres"))
}

/// Three percentages from `1,0.5,-2`, each between -5 and 5.
pub(crate) fn percents(text: &str) -> Result<[f64; 3], String> {
    let numbers: Option<Vec<f64>> = text.split(',').map(finite).collect();
    let numbers = numbers.and_then(|numbers| <[f64; 3]>::try_from(numbers).ok());
    numbers
        .filter(|numbers| numbers.iter().all(|percent| percent.abs() <= 5.0))
        .ok_or_else(|| format!("{text:?}: write three percentages up to 5, such as 1,0.5,2"))
}

/// How old a camera's picture is by the time that its source gives, seconds: up to 2.
pub(crate) fn camera_delay(text: &str) -> Result<f64, String> {
    let value = scaled(text, &SECONDS, SECONDS[0].1).filter(|value| (0.0..=2.0).contains(value));
    value.ok_or_else(|| format!("{text:?} is no delay; write seconds from 0 to 2"))
}

/// How long a robot waits for a way, seconds: up to an hour.
pub(crate) fn patience(text: &str) -> Result<f64, String> {
    let value = scaled(text, &SECONDS, SECONDS[0].1).filter(|value| (1.0..=3600.0).contains(value));
    value.ok_or_else(|| format!("{text:?}: write seconds from 1 to 3600"))
}

/// A step of simulated time, seconds: 0.1 ms to 100 ms.
pub(crate) fn step(text: &str) -> Result<f64, String> {
    let value = scaled(text, &SECONDS, SECONDS[0].1).filter(|value| (1e-4..=0.1).contains(value));
    value.ok_or_else(|| format!("{text:?} is no step; write seconds from 0.0001 to 0.1"))
}

/// An arena's size from `1.6x2.0` or `160cmx200cm`.
pub(crate) fn arena(text: &str) -> Result<Arena, String> {
    let parts = text.split_once(['x', 'X', '×']).and_then(|(width, height)| {
        Some(Arena { width: length(width).ok()?, height: length(height).ok()? })
    });
    parts.filter(|arena| arena.width > 0.0 && arena.height > 0.0).ok_or_else(|| {
        format!("{text:?} is no arena size; write width x height in metres, such as 1.6x2.0")
    })
}

/// The size of a picture from `640x480`, pixels: up to 8 million, each side at least 64.
pub(crate) fn picture_size(text: &str) -> Result<[usize; 2], String> {
    let parts = text.split_once(['x', '×']).and_then(|(width, height)| {
        let side = |text: &str| text.trim().parse().ok().filter(|side| (64..=8192).contains(side));
        Some([side(width)?, side(height)?])
    });
    parts.filter(|[width, height]| width * height <= 8_000_000).ok_or_else(|| {
        format!("{text:?} is no size of a picture; write pixels from 64x64 up to 8 million, such as 640x480")
    })
}

/// Pictures a second: 0.1 to 60.
pub(crate) fn frame_rate(text: &str) -> Result<f64, String> {
    let value = finite(text).filter(|value| (0.1..=60.0).contains(value));
    value.ok_or_else(|| format!("{text:?} is no frame rate; write 0.1 to 60 pictures a second"))
}

/// How late a picture comes: 0 to 10 s.
pub(crate) fn latency(text: &str) -> Result<Duration, String> {
    let value = scaled(text, &SPANS, SPANS[2].1).filter(|value| (0.0..=10.0).contains(value));
    value
        .map(Duration::from_secs_f64)
        .ok_or_else(|| format!("{text:?} is no latency; write 0 to 10s, such as 80ms"))
}

/// A place from `x,y` or `x,y,heading`.
pub(crate) fn place(text: &str) -> Result<Goal, String> {
    let parts: Vec<_> = text.split(',').map(str::trim).collect();
    let (x, y, heading) = match *parts.as_slice() {
        [x, y] => (x, y, None),
        [x, y, heading] => (x, y, Some(angle(heading)?)),
        _ => {
            return Err(format!(
                "{text:?} is no place; write x,y or x,y,heading, such as 0.4,1.2,90"
            ));
        }
    };
    Ok(Goal { position: Point::new(length(x)?, length(y)?), heading })
}

/// A disc from `x,y,r`.
pub(crate) fn disc(text: &str) -> Result<Circle, String> {
    let parts: Vec<_> = text.split(',').map(str::trim).collect();
    let [x, y, radius] = *parts.as_slice() else {
        return Err(format!("{text:?} is no disc; write x,y,r, such as 0.4,1.2,80mm"));
    };
    Ok(Circle { centre: Point::new(length(x)?, length(y)?), radius: distance(radius)? })
}

/// A distance and an angle from `20mm,3deg`.
pub(crate) fn offset(text: &str) -> Result<(f64, f64), String> {
    let parts = text.split_once(',').and_then(|(far, turned)| {
        let far = length(far.trim()).ok().filter(|far| *far >= 0.0)?;
        Some((far, angle(turned.trim()).ok()?))
    });
    parts.ok_or_else(|| format!("{text:?}: write a distance and an angle, such as 20mm,3deg"))
}

/// Four corners from `x,y x,y x,y x,y`, pixels.
pub(crate) fn corners(text: &str) -> Result<[[f64; 2]; 4], String> {
    if let Some(shape) =
        [("square", "square"), ("round", "disc")].iter().find(|(old, _)| *old == text)
    {
        return Err(format!("--corners takes pixels of the photo; write --inflation {}", shape.1));
    }
    let corner = |pair: &str| {
        let (x, y) = pair.split_once(',')?;
        Some([finite(x)?, finite(y)?])
    };
    let corners: Option<Vec<_>> = text.split_whitespace().map(corner).collect();
    corners.and_then(|corners| corners.try_into().ok()).ok_or_else(|| {
        format!("{text:?} are no corners; write four pixels \"x,y x,y x,y x,y\" from the lower left counter-clockwise")
    })
}

fn scaled(text: &str, units: &[Unit], bare: fn(f64) -> f64) -> Option<f64> {
    let text = text.trim();
    let suffixed = units.iter().find_map(|(unit, scale)| Some((text.strip_suffix(*unit)?, *scale)));
    let (number, scale) = suffixed.unwrap_or((text, bare));
    finite(number).map(scale)
}

fn finite(text: &str) -> Option<f64> {
    text.trim().parse().ok().filter(|number: &f64| number.is_finite())
}

/// A base that can be bought.
pub(crate) fn preset(text: &str) -> Result<Preset, String> {
    let names = Preset::ALL.map(Preset::name).join(", ");
    Preset::named(text).ok_or_else(|| format!("there are {names}"))
}

/// When the fault of a scenario begins.
pub(crate) fn moment(text: &str) -> Result<Moment, String> {
    let found = Moment::ALL.iter().find(|(name, _)| *name == text).map(|(_, moment)| *moment);
    found.ok_or_else(|| format!("there are {}", Moment::ALL.map(|(name, _)| name).join(", ")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn metres_and_degrees_are_understood_bare_and_with_units() {
        assert_eq!(length("30cm"), Ok(0.3));
        assert_eq!(length("-2 m"), Ok(-2.0));
        assert_eq!(length("75mm"), Ok(0.075));
        assert_eq!(length("1400mm"), Ok(1.4));
        assert_eq!(angle("180"), Ok(std::f64::consts::PI));
        assert_eq!(angle("1.5rad"), Ok(1.5));
        assert_eq!(picture_size("640x480"), Ok([640, 480]));
        assert_eq!(latency("80ms"), Ok(Duration::from_millis(80)));
        assert_eq!(arena("160cmx2.0"), Ok(Arena { width: 1.6, height: 2.0 }));
        assert_eq!(place("0.1,20cm,90").unwrap().heading, Some(std::f64::consts::FRAC_PI_2));
        let four = [[0.0, 1.0], [2.0, 3.0], [4.0, 5.0], [6.0, 7.0]];
        assert_eq!(corners("0,1 2,3 4,5 6,7"), Ok(four));
    }

    #[test]
    fn nonsense_is_refused_with_an_example() {
        for text in ["", "NaN", "inf", "1km", "--", "1e999"] {
            assert!(length(text).is_err(), "{text}");
            assert!(place(&format!("{text},1")).is_err(), "{text}");
        }
        assert!(arena("0x1").is_err() && arena("-1x1").is_err() && arena("1").is_err());
        assert!(leg_time("0").is_err() && leg_time("1e9").is_err() && distance("-1").is_err());
        assert!(corners("0,1 2,3 4,5").is_err());
        for text in ["640", "640x", "63x480", "640x-480", "8192x8192", "1.5x480"] {
            assert!(picture_size(text).is_err(), "{text}");
        }
        assert!(frame_rate("0").is_err() && frame_rate("61").is_err());
        assert!(latency("-1ms").is_err() && latency("11").is_err());
        assert!(corners("round").unwrap_err().contains("--inflation disc"));
        assert!(corners("square").unwrap_err().contains("--inflation square"));
    }
}
