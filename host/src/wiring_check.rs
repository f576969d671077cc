//! How a base is wired, from what a person sees and the encoders count while one motor turns after the other.
//!
//! ```text
//! left outputs turn ─► which wheel, which way, which counts ┐
//! right outputs turn ─► the same ───────────────────────────┴─► wiring
//! ```
//! Two like motors face each other on most bases, so that one of them turns backward on the same wires;
//! and what its encoder counts then agrees with it. Nothing that the robot measures can tell: only
//! somebody who looks.

use protocol::message::Wheel;
use protocol::parameters::Wiring;

/// Fewer counts than this are the flicker of a resting encoder, not a wheel that turns.
const LEAST_COUNTS: u32 = 8;

/// What happened while one side's motor outputs were on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Turn {
    /// The wheel that was seen to turn, and whether it rolled forward; `None` if none did.
    pub seen: Option<(Wheel, bool)>,
    /// By how much each encoder input went on, left and right.
    pub counts: [i32; 2],
}

/// What is wrong with a base that no setting mends.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error, miette::Diagnostic)]
pub enum WiringFault {
    /// A motor did not turn.
    #[error("no wheel turned on the {outputs} motor outputs")]
    #[diagnostic(help("check that motor's wires, the driver's supply and the battery"))]
    NoMotor {
        /// Whose.
        outputs: &'static str,
    },
    /// Both outputs turn one wheel.
    #[error("the {wheel} wheel turned both times")]
    #[diagnostic(help("look again, or check the motors' wires"))]
    SameWheel {
        /// Which.
        wheel: &'static str,
    },
    /// A wheel turned and nothing was counted.
    #[error("the {wheel} wheel turned, but no encoder counted")]
    #[diagnostic(help("check its encoder's supply and both channels"))]
    NoCounts {
        /// Which.
        wheel: &'static str,
    },
    /// One channel of an encoder is dead, or two are mixed up.
    #[error("the {wheel} wheel turned, but both encoders counted ({left} and {right})")]
    #[diagnostic(help("check that no channel of one is on the other's pins"))]
    BothCount {
        /// Which.
        wheel: &'static str,
        /// Counts of the left input.
        left: i32,
        /// Counts of the right input.
        right: i32,
    },
    /// Both wheels are counted by one input.
    #[error("both wheels were counted on the {input} encoder input")]
    #[diagnostic(help("check the encoders' wires"))]
    SameEncoder {
        /// Which.
        input: &'static str,
    },
}

/// `left` or `right`.
pub fn name(wheel: Wheel) -> &'static str {
    match wheel {
        Wheel::Left => "left",
        Wheel::Right => "right",
    }
}

/// The wiring of a base of which the left and then the right outputs were turned, as if it were wired as
/// drawn.
///
/// ```
/// use protocol::{message::Wheel, parameters::Wiring};
/// use wmr::wiring_check::{Turn, wiring};
/// let left = Turn { seen: Some((Wheel::Left, true)), counts: [360, 0] };
/// let mirrored = Turn { seen: Some((Wheel::Right, false)), counts: [0, 360] };
/// let found = wiring([left, mirrored])?;
/// assert!(found.has(Wiring::RIGHT_MOTOR_REVERSED) && found.has(Wiring::RIGHT_ENCODER_REVERSED));
/// # Ok::<(), wmr::wiring_check::WiringFault>(())
/// ```
///
/// # Errors
/// [`WiringFault`] where a wire is loose or in the wrong place.
pub fn wiring(turns: [Turn; 2]) -> Result<Wiring, WiringFault> {
    let outputs = [Wheel::Left, Wheel::Right];
    let motors = [Wiring::LEFT_MOTOR_REVERSED, Wiring::RIGHT_MOTOR_REVERSED];
    let mut found = Wiring::CHECKED;
    let mut wheels = [Wheel::Left; 2];
    let mut inputs = [Wheel::Left; 2];
    for (place, turn) in turns.into_iter().enumerate() {
        let no_motor = WiringFault::NoMotor { outputs: name(outputs[place]) };
        let (wheel, forward) = turn.seen.ok_or(no_motor)?;
        let (input, up) = counting(turn.counts, wheel)?;
        let encoder = match input {
            Wheel::Left => Wiring::LEFT_ENCODER_REVERSED,
            Wheel::Right => Wiring::RIGHT_ENCODER_REVERSED,
        };
        found = found
            .with(motors[place], !forward)
            .with(encoder, forward != up)
            .with(Wiring::MOTORS_SWAPPED, wheel != outputs[place])
            .with(Wiring::ENCODERS_SWAPPED, wheel != input);
        (wheels[place], inputs[place]) = (wheel, input);
    }
    if wheels[0] == wheels[1] {
        return Err(WiringFault::SameWheel { wheel: name(wheels[0]) });
    }
    if inputs[0] == inputs[1] {
        return Err(WiringFault::SameEncoder { input: name(inputs[0]) });
    }
    Ok(found)
}

/// The input that counted `wheel`, and whether upward.
fn counting(counts: [i32; 2], wheel: Wheel) -> Result<(Wheel, bool), WiringFault> {
    let wheel = name(wheel);
    let [left, right] = counts;
    match counts.map(|count| count.unsigned_abs() >= LEAST_COUNTS) {
        [true, false] => Ok((Wheel::Left, left > 0)),
        [false, true] => Ok((Wheel::Right, right > 0)),
        [false, false] => Err(WiringFault::NoCounts { wheel }),
        [true, true] => Err(WiringFault::BothCount { wheel, left, right }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const AS_DRAWN: [Turn; 2] = [
        Turn { seen: Some((Wheel::Left, true)), counts: [360, 1] },
        Turn { seen: Some((Wheel::Right, true)), counts: [0, 360] },
    ];

    #[test]
    fn a_base_wired_as_drawn_needs_no_bit() {
        assert_eq!(wiring(AS_DRAWN), Ok(Wiring::CHECKED));
    }

    #[test]
    fn swapped_sides_are_told_by_hand() {
        let turns = [
            Turn { seen: Some((Wheel::Right, true)), counts: [0, -360] },
            Turn { seen: Some((Wheel::Left, false)), counts: [-360, 0] },
        ];
        let expected = Wiring::CHECKED
            .with(Wiring::MOTORS_SWAPPED, true)
            .with(Wiring::RIGHT_MOTOR_REVERSED, true)
            .with(Wiring::RIGHT_ENCODER_REVERSED, true);
        assert_eq!(wiring(turns), Ok(expected));
    }

    #[test]
    fn what_no_setting_mends_is_said() {
        let [left, right] = AS_DRAWN;
        let dead = wiring([Turn { seen: None, ..left }, right]);
        assert_eq!(dead, Err(WiringFault::NoMotor { outputs: "left" }));
        let silent = wiring([left, Turn { counts: [0, 3], ..right }]);
        assert_eq!(silent, Err(WiringFault::NoCounts { wheel: "right" }));
        let mixed = wiring([Turn { counts: [200, -180], ..left }, right]);
        assert!(matches!(mixed, Err(WiringFault::BothCount { wheel: "left", .. })), "{mixed:?}");
        assert_eq!(wiring([left, left]), Err(WiringFault::SameWheel { wheel: "left" }));
        let one = wiring([left, Turn { counts: [360, 0], ..right }]);
        assert_eq!(one, Err(WiringFault::SameEncoder { input: "left" }));
    }
}
