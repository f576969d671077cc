//! The robot's clock on the host's: when was that tick?
//!
//! Each telemetry frame names the tick that it describes and arrives some delay after it. Delays
//! only ever add, so the earliest arrival of each second is the best witness; a line through those of
//! the last half minute follows the drift between the two crystals.
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | t | robot time since its start, 5 ms a tick | s |
//! | h | host time of arrival | s |
//! | h - t | offset and delay | s |
//!
//! What remains is the least delay of the wire itself, which nothing here can tell from the offset.

use protocol::motion::TICK_MILLISECONDS;
use std::collections::VecDeque;
use std::time::Duration;

/// One witness a second.
const SECOND: f64 = 1.0;
/// So many witnesses tell a drift of 100 ppm from a jitter of some milliseconds.
const WITNESSES: usize = 30;
/// Quartz crystals differ by less than this; a steeper line is jitter.
const GREATEST_DRIFT: f64 = 200e-6;

/// Maps ticks of the robot to times of the host.
#[derive(Clone, Debug, Default)]
pub struct RobotClock {
    witnesses: VecDeque<(f64, f64)>,
    last_tick: u32,
    wraps: u64,
}

impl RobotClock {
    /// Takes in that a frame that describes `ticks` arrived at `arrival`, host time.
    pub fn observe(&mut self, ticks: u32, arrival: Duration) {
        self.wraps += u64::from(ticks < self.last_tick && self.last_tick - ticks > u32::MAX / 2);
        self.last_tick = ticks;
        let t = self.seconds(ticks);
        let offset = arrival.as_secs_f64() - t;
        match self.witnesses.back_mut() {
            Some((since, least)) if t - *since < SECOND => {
                *least = least.min(offset);
            }
            _ => {
                if self.witnesses.len() == WITNESSES {
                    self.witnesses.pop_front();
                }
                self.witnesses.push_back((t, offset));
            }
        }
    }

    /// The host's time at the robot's tick; `None` before any frame.
    pub fn host_time(&self, ticks: u32) -> Option<Duration> {
        let t = self.seconds(ticks);
        let count = self.witnesses.len() as f64;
        let mean_t = self.witnesses.iter().map(|(t, _)| t).sum::<f64>() / count;
        let mean_offset = self.witnesses.iter().map(|(_, offset)| offset).sum::<f64>() / count;
        let spread: f64 = self.witnesses.iter().map(|(t, _)| (t - mean_t).powi(2)).sum();
        let slope = if spread > 0.0 {
            let product: f64 = self
                .witnesses
                .iter()
                .map(|(t, offset)| (t - mean_t) * (offset - mean_offset))
                .sum();
            (product / spread).clamp(-GREATEST_DRIFT, GREATEST_DRIFT)
        } else {
            0.0
        };
        Duration::try_from_secs_f64(t + mean_offset + slope * (t - mean_t)).ok()
    }

    fn seconds(&self, ticks: u32) -> f64 {
        let ticks = self.wraps as f64 * 2f64.powi(32) + f64::from(ticks);
        ticks * f64::from(TICK_MILLISECONDS) / 1000.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Half an hour at 50 frames a second over USB: 0.1 ms at least, mostly below 1 ms, sometimes far
    /// more; the robot's crystal is 100 ppm fast.
    fn errors(seed: u64) -> Vec<f64> {
        let mut random = fastrand::Rng::with_seed(seed);
        let mut clock = RobotClock::default();
        let mut errors = Vec::new();
        for frame in 0..90_000u32 {
            let ticks = frame * 4;
            let truth = 7.0 + f64::from(ticks) * 0.005 * (1.0 - 100e-6);
            let rare = if random.f64() < 0.01 { 0.020 * random.f64() } else { 0.0 };
            let delay = 0.0001 + 0.001 * random.f64() + rare;
            clock.observe(ticks, Duration::from_secs_f64(truth + delay));
            let told = clock.host_time(ticks).unwrap().as_secs_f64();
            errors.push((told - truth).abs());
        }
        errors
    }

    #[test]
    fn robot_time_is_known_to_a_millisecond() {
        let mut errors = errors(1);
        errors.sort_by(f64::total_cmp);
        let p99 = errors[errors.len() * 99 / 100];
        assert!(p99 < 0.001, "{p99}");
    }

    #[test]
    fn two_frames_by_hand() {
        let mut clock = RobotClock::default();
        assert_eq!(clock.host_time(0), None);
        clock.observe(200, Duration::from_millis(5004));
        clock.observe(204, Duration::from_millis(5021));
        // The second is the better witness of the two: tick 204 is 1.02 s, so the offset is 4.001 s.
        assert_eq!(clock.host_time(400), Some(Duration::from_millis(6001)));
    }

    #[test]
    fn the_count_of_ticks_may_wrap_around() {
        let mut clock = RobotClock::default();
        clock.observe(u32::MAX, Duration::from_secs(30_000_000));
        clock.observe(199, Duration::from_secs(30_000_001));
        let later = clock.host_time(399).unwrap();
        assert!(later.abs_diff(Duration::from_secs(30_000_002)) < Duration::from_millis(1));
    }
}
