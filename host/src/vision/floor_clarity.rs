//! How far a floor lets boxes be told from it.
//!
//! Boxes as dark as deep shadow, and boxes that differ from the floor by less than it varies itself, are missed or
//! misplaced. Of answers on labelled pictures with such floors about half were right, of the others nearly all.

use super::appearance::FloorModel;
use super::warning::Warning;

/// Shadow deeper than this looks like dark boxes, a floor that varies more hides boxes (logarithms).
const DEEP_SHADOW: f64 = -0.75;
const UNEVEN_FLOOR: f64 = 0.04;
/// From this share of either on it begins to tell.
const BEGINS: f64 = 0.7;
/// What remains of the certainty on such a floor.
const HARD: f64 = 0.7;

/// What a floor is like: the depth of shadow on it and the spread of its brightness, natural logarithms.
#[derive(Clone, Copy, Debug)]
pub(super) struct FloorClarity {
    shadow: f64,
    spread: f64,
}

impl FloorClarity {
    pub(super) fn of(floor: &FloorModel) -> Self {
        let shadow = floor.shadow.map_or(0.0, |shadow| f64::from(shadow.offset[0]));
        Self { shadow, spread: f64::from(floor.spread[0]) }
    }

    /// How surely boxes are seen on it, 0 to 1.
    pub(super) fn certainty(self) -> f64 {
        let hardness = (self.shadow / DEEP_SHADOW).max(self.spread / UNEVEN_FLOOR);
        1.0 - (1.0 - HARD) * ((hardness - BEGINS) / (1.0 - BEGINS)).clamp(0.0, 1.0)
    }

    /// What to say about a floor on which boxes may hide.
    pub(super) fn warning(self) -> Option<Warning> {
        (self.shadow < DEEP_SHADOW || self.spread > UNEVEN_FLOOR)
            .then(|| Warning::HardFloor { spread: self.spread, in_shadow: self.shadow.exp() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_harder_the_floor_the_less_is_sure() {
        let sure = |shadow, spread| FloorClarity { shadow, spread }.certainty();
        assert_eq!((sure(0.0, 0.0), sure(-0.5, 0.027)), (1.0, 1.0));
        // Half way from where it begins to tell.
        assert!((sure(-0.6375, 0.0) - 0.85).abs() < 1e-9 && (sure(0.0, 0.034) - 0.85).abs() < 1e-9);
        assert_eq!((sure(-0.9, 0.01), sure(0.0, 0.1)), (0.7, 0.7));
        assert!(FloorClarity { shadow: -0.7, spread: 0.03 }.warning().is_none());
        let warning = FloorClarity { shadow: -0.8, spread: 0.03 }.warning();
        let in_shadow = (-0.8_f64).exp();
        assert_eq!(warning, Some(Warning::HardFloor { spread: 0.03, in_shadow }));
    }
}
