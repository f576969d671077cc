//! What the light on the board shows.
//!
//! | robot | light |
//! |---|---|
//! | ready, or drives | on |
//! | the same, battery low or weak | on, dark for a tenth of a second each second |
//! | paused or stopped | on and off, half a second each |
//! | battery empty | a short flash every two seconds |
//! | any other fault | flickers five times a second |

use protocol::message::{BatteryLevel, Fault, State};
use protocol::motion::TICKS_PER_SECOND;

const SECOND: u32 = TICKS_PER_SECOND;
/// A tenth of a second.
const SHORT: u32 = SECOND / 10;

/// Whether the light is on at this tick since the start.
pub(crate) fn is_on(state: State, battery: BatteryLevel, ticks: u32) -> bool {
    match (state, battery) {
        (State::Faulted(Fault::Battery), _) | (State::Idle, BatteryLevel::Empty) => {
            ticks % (2 * SECOND) < SHORT
        }
        (State::Faulted(_), _) => ticks % (2 * SHORT) < SHORT,
        (State::Paused(_) | State::Stopped, _) => ticks % SECOND < SECOND / 2,
        (State::Idle | State::Driving, BatteryLevel::Good) => true,
        (State::Idle | State::Driving, _) => ticks % SECOND >= SHORT,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use protocol::message::PauseReason;

    /// For how many of ten seconds it is on, in tenths, and how often it goes on.
    fn seen(state: State, battery: BatteryLevel) -> (u32, usize) {
        let lit: std::vec::Vec<bool> =
            (0..10 * SECOND).map(|ticks| is_on(state, battery, ticks)).collect();
        let on = lit.iter().filter(|on| **on).count() as u32 / SHORT;
        (on, lit.windows(2).filter(|pair| !pair[0] && pair[1]).count())
    }

    #[test]
    fn patterns_by_hand() {
        let good = BatteryLevel::Good;
        assert_eq!(seen(State::Idle, good), (100, 0));
        assert_eq!(seen(State::Driving, BatteryLevel::Weak), (90, 10));
        assert_eq!(seen(State::Stopped, good), (50, 9));
        assert_eq!(seen(State::Paused(PauseReason::Silence), good), (50, 9));
        assert_eq!(seen(State::Faulted(Fault::Stall), good), (50, 49));
        assert_eq!(seen(State::Faulted(Fault::Battery), BatteryLevel::Empty), (5, 4));
    }
}
