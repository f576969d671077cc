//! What the battery's voltage means, after a filter and with hysteresis.
//!
//! A motor that starts pulls the voltage down for some tens of milliseconds, so it is averaged over
//! 200 ms. A battery recovers a little once the load is off, so a level is left only 5 % above the
//! voltage at which it was entered; otherwise the robot would stop and go.

use protocol::message::{BatteryLevel, BatteryReport};
use protocol::motion::TICK;
use protocol::parameters::BatteryLevels;

/// Time constant of the filter, s.
const FILTER_SECONDS: f32 = 0.2;
/// By what factor the voltage must exceed a level to leave it.
const HYSTERESIS: f32 = 1.05;

/// The battery of one robot.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Battery {
    filtered: Option<f32>,
    level: BatteryLevel,
}

impl Battery {
    /// What the voltage means.
    pub(crate) fn level(&self) -> BatteryLevel {
        self.level
    }

    /// The filtered voltage, where it is measured.
    pub(crate) fn volts(&self) -> Option<f32> {
        self.filtered
    }

    /// The level and the voltage, where something is to be said of them.
    pub(crate) fn report(&self) -> Option<BatteryReport> {
        let (level, volts) = (self.level, self.filtered?);
        (level > BatteryLevel::Good).then_some(BatteryReport { level, volts })
    }

    /// Takes in this tick's measurement, volts; says so if the level has changed.
    pub(crate) fn update(&mut self, volts: f32, levels: &BatteryLevels) -> Option<BatteryReport> {
        let before = self.filtered.unwrap_or(volts);
        let volts = before + (volts - before) * (TICK.0 / FILTER_SECONDS);
        self.filtered = Some(volts);
        // Falling is believed at once, recovery only beyond the hysteresis.
        let level = self.level.clamp(meaning(volts, levels), meaning(volts / HYSTERESIS, levels));
        let changed = level != self.level;
        self.level = level;
        changed.then_some(BatteryReport { level, volts })
    }
}

fn meaning(volts: f32, levels: &BatteryLevels) -> BatteryLevel {
    match volts {
        _ if volts < levels.stop => BatteryLevel::Empty,
        _ if volts < levels.derate => BatteryLevel::Weak,
        _ if volts < levels.warn => BatteryLevel::Low,
        _ => BatteryLevel::Good,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LEVELS: BatteryLevels = BatteryLevels { warn: 7.0, derate: 6.8, stop: 6.4 };

    fn hold(battery: &mut Battery, volts: f32, ticks: usize) -> Vec<BatteryLevel> {
        (0..ticks)
            .filter_map(|_| battery.update(volts, &LEVELS))
            .map(|report| report.level)
            .collect()
    }

    #[test]
    fn a_battery_runs_down_and_recovers_beyond_the_hysteresis() {
        let mut battery = Battery::default();
        assert_eq!(hold(&mut battery, 7.4, 200), []);
        assert_eq!(
            hold(&mut battery, 6.0, 400),
            [BatteryLevel::Low, BatteryLevel::Weak, BatteryLevel::Empty]
        );
        // 6.4 V × 1.05 = 6.72 V.
        assert_eq!(hold(&mut battery, 6.7, 400), []);
        assert_eq!(hold(&mut battery, 6.75, 400), [BatteryLevel::Weak]);
        assert_eq!(hold(&mut battery, 8.0, 400), [BatteryLevel::Low, BatteryLevel::Good]);
    }

    #[test]
    fn a_short_dip_is_nothing() {
        let mut battery = Battery::default();
        hold(&mut battery, 7.4, 100);
        // 50 ms at 6 V: 7.4 - 1.4 (1 - e^(-1/4)) = 7.09 V.
        assert_eq!(hold(&mut battery, 6.0, 10), []);
    }
}
