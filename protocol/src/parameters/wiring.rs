//! How motors and encoders are connected, and what follows from that for counts and duty.

use serde::{Deserialize, Serialize};

/// Which way round motors and encoders are connected: one bit each, none of them on a robot that is
/// wired as the drawing has it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Wiring(pub u8);

impl Wiring {
    /// The motor on the left outputs rolls its wheel backward on a positive duty.
    pub const LEFT_MOTOR_REVERSED: Self = Self(1);
    /// The same on the right outputs.
    pub const RIGHT_MOTOR_REVERSED: Self = Self(2);
    /// The encoder on the left inputs counts down as its wheel rolls forward.
    pub const LEFT_ENCODER_REVERSED: Self = Self(4);
    /// The same on the right inputs.
    pub const RIGHT_ENCODER_REVERSED: Self = Self(8);
    /// The right motor is on the left outputs, and the left one on the right.
    pub const MOTORS_SWAPPED: Self = Self(16);
    /// The right encoder is on the left inputs, and the left one on the right.
    pub const ENCODERS_SWAPPED: Self = Self(32);
    /// A person has seen that all this is right.
    pub const CHECKED: Self = Self(64);

    /// Whether `bit` is set.
    pub fn has(self, bit: Self) -> bool {
        self.0 & bit.0 != 0
    }

    /// The same with `bit` set or not.
    pub fn with(self, bit: Self, set: bool) -> Self {
        Self(if set { self.0 | bit.0 } else { self.0 & !bit.0 })
    }

    /// What the inputs count as counts of the left and the right wheel.
    pub fn wheels(self, inputs: [i32; 2]) -> [i32; 2] {
        let [left, right] = inputs;
        let counts = [
            if self.has(Self::LEFT_ENCODER_REVERSED) { left.wrapping_neg() } else { left },
            if self.has(Self::RIGHT_ENCODER_REVERSED) { right.wrapping_neg() } else { right },
        ];
        swapped_if(self.has(Self::ENCODERS_SWAPPED), counts)
    }

    /// The inputs behind what [`wheels`](Self::wheels) made of them.
    pub fn inputs(self, wheels: [i32; 2]) -> [i32; 2] {
        let swap = Self::ENCODERS_SWAPPED;
        self.with(swap, false).wheels(swapped_if(self.has(swap), wheels))
    }

    /// The duty of the left and the right outputs that turns the wheels with `duty`.
    pub fn outputs(self, duty: [f32; 2]) -> [f32; 2] {
        let [left, right] = swapped_if(self.has(Self::MOTORS_SWAPPED), duty);
        [
            if self.has(Self::LEFT_MOTOR_REVERSED) { -left } else { left },
            if self.has(Self::RIGHT_MOTOR_REVERSED) { -right } else { right },
        ]
    }
}

fn swapped_if<T>(swap: bool, [left, right]: [T; 2]) -> [T; 2] {
    if swap { [right, left] } else { [left, right] }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn wiring_by_hand() {
        let built = Wiring::default();
        assert_eq!((built.wheels([3, 5]), built.outputs([0.3, 0.5])), ([3, 5], [0.3, 0.5]));
        let mirrored = built
            .with(Wiring::RIGHT_MOTOR_REVERSED, true)
            .with(Wiring::RIGHT_ENCODER_REVERSED, true);
        assert_eq!((mirrored.wheels([3, 5]), mirrored.outputs([0.3, 0.5])), ([3, -5], [0.3, -0.5]));
        // The right wheel's encoder is on the left inputs, and counts backward there.
        let swapped =
            built.with(Wiring::ENCODERS_SWAPPED, true).with(Wiring::LEFT_ENCODER_REVERSED, true);
        assert_eq!(swapped.wheels([-5, 3]), [3, 5]);
        // The same for its motor.
        let swapped =
            built.with(Wiring::MOTORS_SWAPPED, true).with(Wiring::LEFT_MOTOR_REVERSED, true);
        assert_eq!(swapped.outputs([0.3, 0.5]), [-0.5, 0.3]);
    }

    proptest! {
        #[test]
        fn inputs_are_what_the_wheels_were_made_of(bits in 0u8..128, left: i32, right: i32) {
            let wiring = Wiring(bits);
            prop_assert_eq!(wiring.inputs(wiring.wheels([left, right])), [left, right]);
        }
    }
}
