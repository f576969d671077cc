//! Whether motor and encoder of a wheel fit together: what the wheel was given against what its motion takes.
//!
//! A wheel that follows, by its own encoder, has been given about the duty that the motor's model asks for.
//! One that counts ten times too much follows with a tenth of it; one that loses every other count takes
//! nearly twice as much, while odometry believes that it drives straight. Both wheels share battery and floor,
//! so they are compared with each other, where battery and motor may differ from the model in any way; and
//! each with the model, for counts that are far too many on both.
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | d, f | duty given and fed forward, along the wanted speed, summed over a window | – |
//! | q = d/f | effort: 1 for the motor of the model | – |

use protocol::message::Wheel;

/// The window, ticks on end in which the wheel should turn: 200 ms.
const WINDOW: u8 = 40;
/// Slower wheels are not judged: friction decides there, rad/s.
const SLOWEST: f32 = 2.0;
/// A wheel has followed whose mean speed is that near to what was wanted, as a share of it.
const NEAR: f32 = 0.25;
/// Less than this mean duty says little.
const LEAST_DUTY: f32 = 0.15;
/// Efforts that differ by more than this factor are of different counts: two motors of a kind differ by a
/// fifth, wheels that drag by a third.
const LARGEST_RATIO: f32 = 1.6;
/// A smaller effort than this is of too many counts: motors of twice the speed that the robot was told.
const LEAST_EFFORT: f32 = 0.5;

/// d and f of one wheel, over the ticks of its window so far.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Effort {
    /// What the wheel should have turned and did not, and what it should have, rad/s.
    missing: f32,
    wanted: f32,
    given: f32,
    due: f32,
    ticks: u8,
}

impl Effort {
    /// Takes in a tick in which a wheel that should turn with `wanted` turned with `speed`, rad/s, while it
    /// was given `given` and its model asks for `due`, all along the wanted direction.
    pub(crate) fn update(&mut self, wanted: f32, speed: f32, given: f32, due: f32) {
        if wanted <= SLOWEST {
            *self = Self::default();
        } else if self.ticks < WINDOW {
            self.missing += wanted - speed;
            self.wanted += wanted;
            self.given += given;
            self.due += due;
            self.ticks += 1;
        }
    }

    fn is_judged(&self) -> bool {
        let follows = self.missing.abs() < NEAR * self.wanted;
        self.ticks == WINDOW && follows && self.due > LEAST_DUTY * f32::from(WINDOW)
    }
}

/// The wheel, left or right, whose encoder counts what its motor cannot have done; full windows start again.
pub(crate) fn misfit([left, right]: [&mut Effort; 2]) -> Option<Wheel> {
    let found = judge(*left, *right);
    if left.ticks == WINDOW && right.ticks == WINDOW {
        (*left, *right) = Default::default();
    }
    found
}

fn judge(left: Effort, right: Effort) -> Option<Wheel> {
    for (wheel, effort) in [(Wheel::Left, left), (Wheel::Right, right)] {
        if effort.is_judged() && effort.given < LEAST_EFFORT * effort.due {
            return Some(wheel);
        }
    }
    if !(left.is_judged() && right.is_judged()) {
        return None;
    }
    let [q_left, q_right] = [left.given * right.due, right.given * left.due];
    // Of two that differ, the odd one is further from the model: above it or below.
    let above = left.given * right.given > left.due * right.due;
    if q_left > LARGEST_RATIO * q_right {
        Some(if above { Wheel::Left } else { Wheel::Right })
    } else if q_right > LARGEST_RATIO * q_left {
        Some(if above { Wheel::Right } else { Wheel::Left })
    } else {
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is found after a window at 5 rad/s, for which the model asks 0.3, with these efforts.
    fn found(left: f32, right: f32) -> Option<Wheel> {
        let mut efforts = [Effort::default(); 2];
        for _ in 0..WINDOW {
            for (effort, q) in efforts.iter_mut().zip([left, right]) {
                effort.update(5.0, 5.1, 0.3 * q, 0.3);
            }
        }
        let [left, right] = &mut efforts;
        misfit([left, right])
    }

    #[test]
    fn efforts_by_hand() {
        assert_eq!(found(1.0, 1.0), None);
        // A weak battery, and a motor that drags.
        assert_eq!((found(1.4, 1.4), found(1.2, 1.5)), (None, None));
        // Half the counts on one side, also on a weak battery.
        assert_eq!((found(1.9, 1.0), found(1.3, 2.4)), (Some(Wheel::Left), Some(Wheel::Right)));
        // Ten times the counts on one side, and on both.
        assert_eq!((found(1.0, 0.2), found(0.2, 0.2)), (Some(Wheel::Right), Some(Wheel::Left)));
    }

    #[test]
    fn a_wheel_that_does_not_follow_or_hardly_turns_is_not_judged() {
        for (wanted, speed) in [(5.0, 3.0), (1.5, 1.5)] {
            let mut efforts = [Effort::default(); 2];
            for _ in 0..10 * u32::from(WINDOW) {
                let [left, right] = &mut efforts;
                left.update(wanted, speed, 1.0, 0.3);
                right.update(5.0, 5.0, 0.3, 0.3);
                assert_eq!(misfit([left, right]), None);
            }
        }
    }
}
