//! What a robot may do with the pose it has: uncertainty as a margin, and as a verdict.
//!
//! Without the camera two things get worse. The pose drifts with every metre driven, so obstacles must be
//! passed at a wider margin; and nobody sees what is set down in the way, however well the pose is known.
//! So the verdict asks both how wide the margin has become and how long ago the camera saw the robot.

use std::time::Duration;

/// Standard deviations of the position that a margin covers; on a line, 99.7 %.
const COVERED: f64 = 3.0;

/// With a margin above these the robot goes more slowly, or stops, m.
const SLOW_MARGIN: f64 = 0.02;
const STOP_MARGIN: f64 = 0.05;

/// The camera may be dark for so long before the robot goes more slowly: a few frames may be lost.
const SLOW_AGE: Duration = Duration::from_millis(1500);
/// And so long before it stops: at the slower pace it has driven about half a metre.
const STOP_AGE: Duration = Duration::from_secs(5);

/// So many poses in a row that agree with each other and not with the filter stop the robot: it may have
/// been lifted.
const DOUBTS: u32 = 2;

/// What a robot may do.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Verdict {
    /// It may follow its path at full speed.
    OnPath,
    /// It may follow its path at a lower speed.
    Slow,
    /// It is to stop on its path.
    Stop,
}

/// Why a robot may not do all it could.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum Caution {
    /// Nothing has said yet where the robot is.
    #[error("nothing has said yet where the robot is")]
    Unplaced,
    /// The camera has not seen the robot for a while.
    #[error("the camera has not seen the robot for {:.1} s; is it covered, or its cable loose?", .0.as_secs_f64())]
    Dark(Duration),
    /// The pose is not known well enough.
    #[error("the robot's position is only known to {:.0} mm", 1000.0 * .margin)]
    Unsure {
        /// The extra margin, metres.
        margin: f64,
    },
    /// The camera sees the robot elsewhere, again and again.
    #[error("the camera sees the robot {:.0} mm from where its wheels have brought it, {frames} frames in a row; was it lifted?", 1000.0 * .distance)]
    Disputed {
        /// How far from the estimate, metres.
        distance: f64,
        /// How many frames agree.
        frames: u32,
    },
}

/// How much wider margins have to be, and what the robot may do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Growth {
    /// What to add to the margin of every obstacle, metres: three standard deviations of the position.
    pub margin: f64,
    /// What the robot may do.
    pub verdict: Verdict,
    /// Why it may not do all; `None` on the path.
    pub because: Option<Caution>,
}

impl Growth {
    /// Of a robot that nobody has placed.
    pub(super) const UNPLACED: Self =
        Self { margin: f64::INFINITY, verdict: Verdict::Stop, because: Some(Caution::Unplaced) };

    /// Of a robot whose position has the standard deviation `sigma`, m, that was seen `age` ago, and of
    /// which `doubts` poses in a row lie `distance` away.
    pub(super) fn new(sigma: f64, age: Duration, (doubts, distance): (u32, f64)) -> Self {
        let margin = COVERED * sigma;
        let by_margin = graded(margin, SLOW_MARGIN, STOP_MARGIN);
        let by_age = graded(age, SLOW_AGE, STOP_AGE);
        let by_doubt = if doubts >= DOUBTS { Verdict::Stop } else { Verdict::OnPath };
        let verdict = by_margin.max(by_age).max(by_doubt);
        let because = match verdict {
            Verdict::OnPath => None,
            worst if worst == by_doubt => Some(Caution::Disputed { distance, frames: doubts }),
            worst if worst == by_age => Some(Caution::Dark(age)),
            _ => Some(Caution::Unsure { margin }),
        };
        Self { margin, verdict, because }
    }
}

fn graded<T: PartialOrd>(value: T, slow: T, stop: T) -> Verdict {
    if value > stop {
        Verdict::Stop
    } else if value > slow {
        Verdict::Slow
    } else {
        Verdict::OnPath
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn dark(seconds: u64, sigma: f64) -> Growth {
        Growth::new(sigma, Duration::from_secs(seconds), (0, 0.0))
    }

    #[test]
    fn a_dark_camera_slows_and_then_stops_the_robot() {
        assert_eq!(dark(1, 0.002).verdict, Verdict::OnPath);
        assert_eq!(dark(3, 0.004).verdict, Verdict::Slow);
        let stopped = dark(10, 0.006);
        assert_eq!(stopped.verdict, Verdict::Stop);
        assert_eq!(stopped.because, Some(Caution::Dark(Duration::from_secs(10))));
        assert!((stopped.margin - 0.018).abs() < 1e-12);
    }

    #[test]
    fn the_worst_reason_is_the_one_named() {
        let unsure = dark(3, 0.02);
        assert_eq!(unsure.verdict, Verdict::Stop);
        assert_eq!(unsure.because, Some(Caution::Unsure { margin: 0.06 }));
        let lifted = Growth::new(0.002, Duration::ZERO, (DOUBTS, 0.3));
        assert_eq!(lifted.because, Some(Caution::Disputed { distance: 0.3, frames: 2 }));
        assert_eq!(Growth::new(0.002, Duration::ZERO, (1, 0.3)).verdict, Verdict::OnPath);
    }
}
