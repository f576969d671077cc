//! How a drive is watched: the eye between two looks, and the looks that nobody has fetched yet.

use crate::dashboard::corrections::Corrections;
use std::collections::VecDeque;
use std::time::{Duration, Instant};
use wmr::geometry::{Arena, Pose};
use wmr::watch::source::SourceError;
use wmr::watch::{Expected, Eye, Look};

/// Looks that wait for the robot's thread, which fetches far more often than a camera sends.
const WAITING: usize = 8;

/// How a drive is watched.
#[derive(Debug)]
pub(super) struct Watch {
    pub(super) number: u64,
    /// Gone while it looks.
    eye: Option<Box<Eye>>,
    pub(super) arena: Arena,
    corrections: Corrections,
    expected: Expected,
    /// A time of the wall's clock, and of the port's at that moment.
    anchor: Option<(Instant, Duration)>,
    /// Seconds of the port's clock in one of the wall's.
    speed: f64,
    looks: VecDeque<Result<Look, SourceError>>,
    /// The robot is to stop, and no world waits for a frame.
    hurries: bool,
}

impl Watch {
    pub(super) fn new(
        number: u64,
        eye: Eye,
        arena: Arena,
        corrections: Corrections,
        speed: f64,
    ) -> Self {
        Self {
            number,
            eye: Some(Box::new(eye)),
            arena,
            corrections,
            expected: Expected::default(),
            anchor: None,
            speed,
            looks: VecDeque::new(),
            hurries: false,
        }
    }

    /// Whether a simulated world waits for its frames.
    pub(super) fn waits(&self) -> bool {
        !self.hurries
    }

    pub(super) fn hurry(&mut self) {
        self.hurries = true;
    }

    pub(super) fn expect(&mut self, at: Duration, pose: Pose) {
        self.anchor = Some((Instant::now(), at));
        self.expected.push(at, pose);
    }

    /// The next look, if there is one.
    pub(super) fn next(&mut self) -> Result<Look, SourceError> {
        self.looks.pop_front().unwrap_or(Ok(Look::Nothing))
    }

    /// Where the robot is expected to be in a picture of that time.
    pub(super) fn expected_at(&self, exposed: Duration) -> Option<Pose> {
        self.expected.at(exposed)
    }

    /// The eye, to look with it.
    pub(super) fn take_eye(&mut self) -> Option<Box<Eye>> {
        self.eye.take()
    }

    /// Takes the eye back; what it has seen, as a person has corrected it.
    pub(super) fn give_back(&mut self, eye: Box<Eye>, look: Look) -> Look {
        self.eye = Some(eye);
        match look {
            Look::Seen(mut sight) => {
                sight.obstacles = self.corrections.applied_to(&sight.obstacles);
                Look::Seen(sight)
            }
            look => look,
        }
    }

    pub(super) fn push(&mut self, look: Result<Look, SourceError>) {
        if self.looks.len() >= WAITING {
            self.looks.pop_front();
        }
        self.looks.push_back(look);
    }

    /// The port's time of an exposure; `None` before the port has told one.
    pub(super) fn port_time(&self, exposed: Exposed) -> Option<Duration> {
        match exposed {
            Exposed::Port(at) => Some(at),
            Exposed::Wall(at) => {
                let (moment, time) = self.anchor?;
                let ago = moment.saturating_duration_since(at).mul_f64(self.speed);
                let since = at.saturating_duration_since(moment).mul_f64(self.speed);
                Some((time + since).saturating_sub(ago))
            }
        }
    }
}

/// When a picture was exposed.
#[derive(Clone, Copy, Debug)]
pub(super) enum Exposed {
    /// By the clock of a simulated robot's port.
    Port(Duration),
    /// By the clock on the wall.
    Wall(Instant),
}

#[cfg(test)]
mod tests {
    use super::*;
    use wmr::vision::{DetectOptions, Photo, detect};

    fn watch(speed: f64) -> Watch {
        let pixels = (0..240 * 160).map(|i| {
            let (x, y) = (i % 240, i / 240);
            let floor = (20..220).contains(&x) && (20..140).contains(&y);
            let frame = (16..224).contains(&x) && (16..144).contains(&y) && !floor;
            if frame { [30; 3] } else { [230; 3] }
        });
        let photo = Photo::from_rgb(240, 160, pixels.collect()).unwrap();
        let arena = Arena { width: 2.0, height: 1.2 };
        let seen = detect(&photo, arena, &DetectOptions::default()).unwrap();
        let eye = Eye::new(photo, arena, DetectOptions::default(), &seen);
        Watch::new(1, eye, arena, Corrections::default(), speed)
    }

    /// A frame that was exposed 0.2 s before the port said 10 s is of 9.8 s; of a robot on twice the pace, of 9.6 s.
    #[test]
    fn exposures_are_told_in_the_port_s_time() {
        let now = Instant::now();
        for (speed, wanted) in [(1.0, 9.8), (2.0, 9.6)] {
            let mut watch = watch(speed);
            assert_eq!(watch.port_time(Exposed::Wall(now)), None);
            watch.anchor = Some((now, Duration::from_secs(10)));
            let exposed = now.checked_sub(Duration::from_millis(200)).unwrap();
            let at = watch.port_time(Exposed::Wall(exposed)).unwrap();
            assert!((at.as_secs_f64() - wanted).abs() < 1e-9, "{at:?}");
            let later = watch.port_time(Exposed::Wall(now + Duration::from_millis(100))).unwrap();
            assert!((later.as_secs_f64() - 10.0 - 0.1 * speed).abs() < 1e-9, "{later:?}");
        }
    }

    #[test]
    fn of_looks_that_nobody_fetches_the_newest_are_kept() {
        let mut watch = watch(1.0);
        for number in 0..20 {
            watch.push(Ok(Look::Failed(number.to_string())));
        }
        assert_eq!(watch.looks.len(), WAITING);
        assert!(matches!(watch.next(), Ok(Look::Failed(why)) if why == "12"));
    }
}
