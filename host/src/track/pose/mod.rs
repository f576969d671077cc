//! Where the robot is: the camera's poses joined with odometry by an extended Kalman filter.
//!
//! ```text
//! telemetry ─► steps since the last frame ────────┐
//!                                                 ├─► pose and covariance at any time
//! frame, late ─► state at its exposure ─► gate ─► corrected, then the steps are replayed
//! ```
//! The state is the pose and, as slow states, what the robot believes wrongly of its own base: the size
//! of both wheels, the ratio of right to left, the track. A camera over an ordinary drive teaches them, so
//! that the robot keeps its path when the camera is dark, and can be offered better parameters at the end.
//!
//! The filter lives on the host: the robot's processor has no floating point unit to spare, and the camera
//! is here. The robot takes single poses ([`protocol::message::Command::SetPose`]) that
//! [`PoseFilter::correction`] keeps small.
//!
//! A pose that lies too far from the estimate for its covariance is an outlier. Outliers that agree with
//! each other along the robot's own way are the truth after a while: the robot was lifted, and the filter
//! begins again there. Metres, radians, arena frame.

mod answer;
mod driven;
mod growth;
mod state;

pub use answer::{Accepted, Rejected};
pub use growth::{Caution, Growth, Verdict};

use crate::geometry::{Pose, wrap_angle};
use driven::{Driven, KEPT};
use nalgebra::{Matrix3, Vector3};
use protocol::motion::Limits;
use state::{State, largest};
use std::time::Duration;

/// A squared Mahalanobis distance of three degrees of freedom that 99.9 % of good poses keep below.
pub const GATE: f64 = 16.27;

/// So many outliers in a row that agree with each other are believed.
const AGREEING: u32 = 5;

/// The most that one correction moves and turns the robot: at ten a second its wheels take that up
/// within their limits beside driving. The robot itself admits 50 mm and 0.2 rad at least.
const LARGEST_CORRECTION: (f64, f64) = (0.01, 0.05);

/// Smaller differences are not worth a frame on the wire, m and rad.
const SMALLEST_CORRECTION: (f64, f64) = (0.001, 0.004);

/// Exposures so long before the last telemetry can still be named to the robot, which remembers 1 s.
const NAMEABLE: Duration = Duration::from_millis(800);

/// How well a pose is known: standard deviations of its coordinates, metres, and its heading, radians.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PoseSigma {
    /// Of x and of y, metres.
    pub position: f64,
    /// Of the heading, radians; π or more where it is not known.
    pub heading: f64,
}

impl PoseSigma {
    /// Of a robot with a tag, in one frame.
    pub const TAGGED: Self = Self { position: 0.003, heading: 0.012 };
    /// Of a robot with a mark or of a colour of its own.
    pub const MARKED: Self = Self { position: 0.006, heading: 0.04 };

    fn covariance(self) -> Matrix3<f64> {
        let position = self.position * self.position;
        Matrix3::from_diagonal(&Vector3::new(position, position, self.heading * self.heading))
    }
}

/// Where the robot is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// The pose.
    pub pose: Pose,
    /// The covariance of x, y and heading: m², m rad, rad².
    pub covariance: [[f64; 3]; 3],
}

impl Estimate {
    /// The standard deviation of the position in its worst direction, metres.
    pub fn position_sigma(&self) -> f64 {
        let [[a, b, _], [_, c, _], _] = self.covariance;
        largest(a, b, c).sqrt()
    }

    /// The standard deviation of the heading, radians.
    pub fn heading_sigma(&self) -> f64 {
        self.covariance[2][2].sqrt()
    }
}

/// What to tell the robot about where it was.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Correction {
    /// The moment that the pose is for.
    pub at: Duration,
    /// The pose to send.
    pub pose: Pose,
    /// How far it moves the robot's own estimate, metres.
    pub distance: f64,
    /// By how much it turns the robot's own estimate, radians.
    pub turn: f64,
    /// The share of the whole difference that this is; the rest is left to the next corrections.
    pub share: f64,
}

/// A number with its standard deviation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// The number.
    pub value: f64,
    /// Its standard deviation.
    pub sigma: f64,
}

/// What the camera has taught of the base, as factors on what the robot believes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Calibration {
    /// Both wheels are so many times as large.
    pub scale: Measured,
    /// The right wheel is so many times as large in proportion to the left one.
    pub ratio: Measured,
    /// The track is so many times as wide.
    pub track: Measured,
}

/// Outliers that agree with each other.
#[derive(Clone, Copy, Debug)]
struct Doubt {
    /// The last of them, at the filter's moment.
    pose: Pose,
    frames: u32,
    distance: f64,
}

/// The filter.
#[derive(Clone, Debug)]
pub struct PoseFilter {
    /// b, m.
    track: f64,
    /// V, m/s, and 2V/b, rad/s.
    fastest: (f64, f64),
    /// The state at the first moment that `driven` keeps; `None` until something says where the robot is.
    state: Option<State>,
    driven: Option<Driven>,
    /// When the camera last agreed.
    seen: Duration,
    doubt: Option<Doubt>,
}

impl PoseFilter {
    /// The filter of a robot with these limits, of which nobody has said yet where it is.
    pub fn new(limits: &Limits) -> Self {
        let (track, speed) = (f64::from(limits.track.0), f64::from(limits.speed.0));
        let fastest = (speed, 2.0 * speed / track);
        Self { track, fastest, state: None, driven: None, seen: Duration::ZERO, doubt: None }
    }

    /// Takes in the robot's own pose at `time`, as its telemetry has it, corrections included. An older
    /// one than the last is passed over.
    pub fn odometry(&mut self, time: Duration, pose: Pose) {
        match &mut self.driven {
            None => self.driven = Some(Driven::new(time, pose, self.fastest)),
            Some(driven) => driven.push(time, pose),
        }
        self.advance(time.saturating_sub(KEPT));
    }

    /// Puts the robot at `pose`, where somebody knows it to be at the time of the last telemetry: a
    /// start measured by hand.
    pub fn place(&mut self, pose: Pose, sigma: PoseSigma) {
        let Some(driven) = &self.driven else { return };
        let (time, _) = driven.last();
        self.advance(time);
        self.put(time, pose, sigma);
    }

    /// Takes in where a camera saw the robot at the time of the exposure. What odometry has seen since
    /// then is replayed.
    ///
    /// # Errors
    /// [`Rejected`] if the pose is an outlier, or no steps of odometry reach to its exposure.
    ///
    /// ```
    /// use std::time::Duration;
    /// use wmr::{geometry::Pose, legs::DEFAULT_LIMITS, track::pose::{Accepted, PoseFilter, PoseSigma}};
    /// let at = Duration::from_millis;
    /// let mut filter = PoseFilter::new(&DEFAULT_LIMITS);
    /// filter.odometry(at(0), Pose::new(1.0, 1.0, 0.0));
    /// filter.odometry(at(200), Pose::new(1.04, 1.0, 0.0));
    /// let sigma = PoseSigma { position: 0.002, heading: 0.005 };
    /// // Exposed half way: the other half is replayed.
    /// assert_eq!(filter.observe(at(100), Pose::new(2.0, 1.0, 0.0), sigma), Ok(Accepted::Placed));
    /// let now = filter.estimate(at(200)).map(|estimate| estimate.pose);
    /// assert!(now.is_some_and(|pose| (pose.position.x - 2.02).abs() < 1e-9));
    /// ```
    pub fn observe(
        &mut self,
        exposed: Duration,
        pose: Pose,
        sigma: PoseSigma,
    ) -> Result<Accepted, Rejected> {
        let numbers: [f64; 3] = pose.into();
        let is_sane = numbers.iter().all(|number| number.is_finite())
            && [sigma.position, sigma.heading].iter().all(|s| s.is_finite() && *s > 0.0);
        if !is_sane {
            return Err(Rejected::NotSane(pose));
        }
        let driven = self.driven.as_ref().ok_or(Rejected::NoTelemetry)?;
        let (first, (last, _)) = (driven.since(), driven.last());
        if exposed < first {
            return Err(Rejected::TooOld { by: first - exposed });
        }
        if exposed > last {
            return Err(Rejected::AheadOfTelemetry { by: exposed - last });
        }
        self.advance(exposed);
        let Some(state) = &mut self.state else {
            self.put(exposed, pose, sigma);
            return Ok(Accepted::Placed);
        };
        let innovation = state.innovation(pose, sigma).ok_or(Rejected::NotSane(pose))?;
        let squared = innovation.squared();
        let (distance, turn) = innovation.parts();
        if squared <= GATE {
            state.correct(&innovation, sigma);
            (self.seen, self.doubt) = (exposed, None);
            return Ok(Accepted::Fused { squared, distance, turn });
        }
        let frames = self.doubted(pose, sigma, distance);
        if frames >= AGREEING {
            self.put(exposed, pose, sigma);
            return Ok(Accepted::Kidnapped { distance, turn, frames });
        }
        let expected = innovation.expected();
        Err(Rejected::Outlier { squared, distance, turn, expected, frames })
    }

    /// The robot was told that it was at `pose` at the time `at`: by a correction, or by the first pose
    /// of a plan. The filter expects its telemetry to jump.
    pub fn told(&mut self, at: Duration, pose: Pose) {
        if let Some(driven) = &mut self.driven {
            driven.told(at, pose);
        }
    }

    /// The robot has refused what it was told last.
    pub fn refused(&mut self) {
        if let Some(driven) = &mut self.driven {
            driven.refused();
        }
    }

    /// Where the robot is at `time`, which may lie a little ahead of the last telemetry; `None` until
    /// something has said where it is. A time before the last corrected moment gives that moment's pose.
    pub fn estimate(&self, time: Duration) -> Option<Estimate> {
        let covariance: [[f64; 3]; 3] = self.state_at(time)?.pose_covariance().into();
        Some(Estimate { pose: self.state_at(time)?.pose(), covariance })
    }

    /// What to tell the robot about where it was at `time`, best the exposure of the last frame: `None` if
    /// its own estimate is good enough, if it has not yet answered to the last correction, or if the
    /// time is not among those that it remembers.
    ///
    /// One correction moves the robot by 10 mm and 0.05 rad at most, larger differences take several: the
    /// robot drives on, and its wheels must be able to follow.
    pub fn correction(&self, time: Duration) -> Option<Correction> {
        let driven = self.driven.as_ref()?;
        if driven.is_waiting() || driven.last().0.saturating_sub(time) > NAMEABLE {
            return None;
        }
        let believed = driven.believed(time)?;
        let pose = self.state_at(time)?.pose();
        let (x, y) = (pose.position.x - believed.position.x, pose.position.y - believed.position.y);
        let (distance, turn) = (x.hypot(y), wrap_angle(pose.heading - believed.heading));
        if distance < SMALLEST_CORRECTION.0 && turn.abs() < SMALLEST_CORRECTION.1 {
            return None;
        }
        let most = (LARGEST_CORRECTION.0 / distance).min(LARGEST_CORRECTION.1 / turn.abs());
        let share = most.min(1.0);
        let pose = Pose::new(
            believed.position.x + share * x,
            believed.position.y + share * y,
            wrap_angle(believed.heading + share * turn),
        );
        Some(Correction { at: time, pose, distance: share * distance, turn: share * turn, share })
    }

    /// How much wider margins have to be at `time`, and what the robot may do.
    pub fn growth(&self, time: Duration) -> Growth {
        let Some(estimate) = self.estimate(time) else { return Growth::UNPLACED };
        let doubt = self.doubt.map_or((0, 0.0), |doubt| (doubt.frames, doubt.distance));
        Growth::new(estimate.position_sigma(), time.saturating_sub(self.seen), doubt)
    }

    /// What the camera has taught of the base; `None` until something has said where the robot is.
    pub fn calibration(&self) -> Option<Calibration> {
        let state = self.state?;
        let measured = |index: usize| Measured {
            value: 1.0 + state.mean[index],
            sigma: state.covariance[(index, index)].sqrt(),
        };
        Some(Calibration { scale: measured(3), ratio: measured(4), track: measured(5) })
    }

    fn state_at(&self, time: Duration) -> Option<State> {
        let mut state = self.state?;
        for step in self.driven.as_ref()?.steps_to(time) {
            state.predict(step, self.track);
        }
        Some(state)
    }

    /// Folds the steps before `time` into the state.
    fn advance(&mut self, time: Duration) {
        let Some(driven) = &mut self.driven else { return };
        if time <= driven.since() {
            return;
        }
        for step in driven.steps_to(time) {
            if let Some(state) = &mut self.state {
                state.predict(step, self.track);
            }
            if let Some(doubt) = &mut self.doubt {
                doubt.pose = doubt.pose.then(step.as_pose());
            }
        }
        driven.forget(time);
    }

    fn put(&mut self, time: Duration, pose: Pose, sigma: PoseSigma) {
        match &mut self.state {
            Some(state) => state.place(pose, sigma),
            None => self.state = Some(State::new(pose, sigma)),
        }
        (self.seen, self.doubt) = (time, None);
    }

    /// How many outliers in a row agree with this one, itself included.
    fn doubted(&mut self, pose: Pose, sigma: PoseSigma, distance: f64) -> u32 {
        let agreeing = self.doubt.filter(|doubt| {
            let from = State::new(doubt.pose, sigma);
            from.innovation(pose, sigma).is_some_and(|difference| difference.squared() <= GATE)
        });
        let frames = agreeing.map_or(1, |doubt| doubt.frames + 1);
        self.doubt = Some(Doubt { pose, frames, distance });
        frames
    }
}

#[cfg(test)]
mod tests;
