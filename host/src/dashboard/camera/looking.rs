//! The camera's thread: from exposures and frames to pictures, shots and looks.

use super::shot::{Shot, content_type, jpeg};
use super::{Arranged, Due, Shared, State};
use crate::dashboard::corrections::Corrections;
use crate::dashboard::lock;
use axum::body::Bytes;
use hil_sim::camera::Stream;
use std::collections::VecDeque;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, PoisonError};
use std::time::{Duration, Instant};
use wmr::geometry::{Arena, Pose};
use wmr::vision::{Photo, check_picture, decode};
use wmr::watch::source::{Background, SourceError};
use wmr::watch::{Expected, Eye, Look};

/// The thread looks this often whether its camera is still on.
const PATIENCE: Duration = Duration::from_millis(100);
/// Pages get frames so far apart at least.
const SHOW_INTERVAL: Duration = Duration::from_millis(90);
/// Looks that wait for the robot's thread, which fetches far more often than a camera sends.
const WAITING: usize = 8;

/// How a drive is watched.
#[derive(Debug)]
pub(super) struct Watch {
    pub(super) number: u64,
    /// Gone while it looks.
    eye: Option<Box<Eye>>,
    arena: Arena,
    corrections: Corrections,
    expected: Expected,
    /// A time of the wall's clock, and of the port's at that moment.
    anchor: Option<(Instant, Duration)>,
    /// Seconds of the port's clock in one of the wall's.
    speed: f64,
    looks: VecDeque<Result<Look, SourceError>>,
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
        }
    }

    pub(super) fn expect(&mut self, at: Duration, pose: Pose) {
        self.anchor = Some((Instant::now(), at));
        self.expected.push(at, pose);
    }

    /// The next look, if there is one.
    pub(super) fn next(&mut self) -> Result<Look, SourceError> {
        self.looks.pop_front().unwrap_or(Ok(Look::Nothing))
    }

    fn push(&mut self, look: Result<Look, SourceError>) {
        if self.looks.len() >= WAITING {
            self.looks.pop_front();
        }
        self.looks.push_back(look);
    }

    /// The port's time of an exposure; `None` before the port has told one.
    fn port_time(&self, exposed: Exposed) -> Option<Duration> {
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
enum Exposed {
    /// By the clock of a simulated robot's port.
    Port(Duration),
    /// By the clock on the wall.
    Wall(Instant),
}

/// A picture that can be looked at, and the file that a page shows.
struct Picture {
    photo: Arc<Photo>,
    bytes: Vec<u8>,
    content_type: &'static str,
    exposed: Exposed,
    arranged: Option<Arranged>,
}

/// What has come.
enum Came {
    /// Nothing yet.
    Nothing,
    Picture(Picture),
    /// Something that cannot be used.
    Trouble(String),
    /// Nothing more will come.
    Ended(SourceError),
}

/// Takes in pictures as long as the camera of that turn is on: those of `source`, each older than it says, or
/// those that are to be drawn.
pub(super) fn look_on(shared: &Shared, turn: u64, source: Option<&(Background, Duration)>) {
    let mut thread = Looking { shared, turn, drawer: None, shown: None };
    loop {
        // A picture on which the thread fails is one of no use.
        let went = catch_unwind(AssertUnwindSafe(|| thread.step(source)));
        match went {
            Ok(true) => {}
            Ok(false) => return,
            Err(_) => {
                let failed = "a picture could not be looked at; please report this".to_owned();
                thread.say(Came::Trouble(failed));
            }
        }
    }
}

struct Looking<'a> {
    shared: &'a Shared,
    turn: u64,
    /// What draws the simulated floor, and which.
    drawer: Option<(u64, Stream)>,
    /// When the last frame was shown.
    shown: Option<Instant>,
}

impl Looking<'_> {
    /// One picture, or a little time without one; false once the camera is off.
    fn step(&mut self, source: Option<&(Background, Duration)>) -> bool {
        let came = match source {
            Some((source, delay)) => fetch(source, *delay),
            None => self.draw(),
        };
        if lock(&self.shared.state).turn != self.turn {
            return false;
        }
        match came {
            Came::Nothing => {}
            Came::Picture(picture) => {
                self.show(&picture);
                self.look(&picture);
            }
            Came::Trouble(_) => self.say(came),
            Came::Ended(_) => {
                self.say(came);
                return false;
            }
        }
        true
    }

    /// The next frame of the simulated camera.
    fn draw(&mut self) -> Came {
        let Some((Due { exposure, arranged }, stream)) = self.due() else { return Came::Nothing };
        let floor = arranged.floor();
        if self.drawer.as_ref().is_none_or(|(known, _)| *known != floor) {
            self.drawer = stream.map(|stream| (floor, stream));
        }
        let Some((_, drawer)) = &mut self.drawer else { return Came::Nothing };
        let frame = drawer.draw(exposure);
        let (Ok(photo), Some(bytes)) = (Photo::try_from(&frame), jpeg(&frame)) else {
            return Came::Trouble("a frame of the simulated camera cannot be shown".into());
        };
        Came::Picture(Picture {
            photo: Arc::new(photo),
            bytes,
            content_type: "image/jpeg",
            exposed: Exposed::Port(frame.exposed),
            arranged: Some(arranged),
        })
    }

    /// What is to be drawn, waited for a little, with what draws its floor.
    fn due(&self) -> Option<(Due, Option<Stream>)> {
        let state = lock(&self.shared.state);
        let nothing = |state: &mut State| state.due.is_none() && state.turn == self.turn;
        let waited = self.shared.wake.wait_timeout_while(state, PATIENCE, nothing);
        let (mut state, _) = waited.unwrap_or_else(PoisonError::into_inner);
        let (due, _) = state.due.take()?;
        Some((due, state.floor.stream()))
    }

    /// Shows a picture from now on, unless the last one is too new.
    fn show(&mut self, picture: &Picture) {
        if self.shown.is_some_and(|last| last.elapsed() < SHOW_INTERVAL) {
            return;
        }
        self.shown = Some(Instant::now());
        let photo = Arc::clone(&picture.photo);
        let size = [photo.width(), photo.height()];
        let mut state = lock(&self.shared.state);
        if state.turn != self.turn {
            return;
        }
        state.shots += 1;
        let shot = Shot {
            number: state.shots,
            bytes: Bytes::from(picture.bytes.clone()),
            content_type: picture.content_type,
            size,
            taken: Instant::now(),
            photo,
            arranged: picture.arranged,
        };
        state.newest = Some(Arc::new(shot));
    }

    /// Looks at a picture: for the drive that is watched, else only whether it could be of use.
    fn look(&self, picture: &Picture) {
        let Some(job) = self.begin_look(picture) else {
            let fault =
                check_picture(&picture.photo).err().map(|fault| words(Look::failed(&fault)));
            return self.tell(fault.flatten());
        };
        let Job { number, mut eye, exposed, expected, arena } = job;
        let look = match eye.look(&picture.photo, exposed, expected) {
            Ok(sight) => Look::Seen(sight),
            Err(error) => Look::failed(&error),
        };
        let corners = eye.corners(arena);
        let mut state = lock(&self.shared.state);
        if state.turn != self.turn {
            return;
        }
        state.corners = Some(corners);
        let Some(watch) = state.watch.as_mut().filter(|watch| watch.number == number) else {
            return;
        };
        watch.eye = Some(eye);
        let look = match look {
            Look::Seen(mut sight) => {
                sight.obstacles = watch.corrections.applied_to(&sight.obstacles);
                Look::Seen(sight)
            }
            look => look,
        };
        let problem = match &look {
            Look::Failed(why) => Some(why.clone()),
            Look::Seen(_) | Look::Nothing => None,
        };
        watch.push(Ok(look));
        state.problem = problem;
    }

    fn begin_look(&self, picture: &Picture) -> Option<Job> {
        let mut state = lock(&self.shared.state);
        let watch = state.watch.as_mut()?;
        let exposed = watch.port_time(picture.exposed)?;
        let expected = watch.expected.at(exposed);
        let (number, arena) = (watch.number, watch.arena);
        Some(Job { number, eye: watch.eye.take()?, exposed, expected, arena })
    }

    fn tell(&self, problem: Option<String>) {
        let mut state = lock(&self.shared.state);
        if state.turn == self.turn {
            state.problem = problem;
        }
    }

    /// Says what is wrong, to pages and to a drive that is watched.
    fn say(&self, came: Came) {
        let look = match came {
            Came::Nothing | Came::Picture(_) => return,
            Came::Trouble(why) => Ok(Look::Failed(why)),
            Came::Ended(error) => Err(error),
        };
        let mut state = lock(&self.shared.state);
        if state.turn != self.turn {
            return;
        }
        state.problem = Some(match &look {
            Ok(Look::Failed(why)) => why.clone(),
            Ok(_) => return,
            Err(error) => words(Look::failed(error)).unwrap_or_default(),
        });
        if let Some(watch) = &mut state.watch {
            watch.push(look);
        }
    }
}

/// A look that is under way.
struct Job {
    number: u64,
    eye: Box<Eye>,
    exposed: Duration,
    expected: Option<Pose>,
    arena: Arena,
}

fn words(look: Look) -> Option<String> {
    match look {
        Look::Failed(why) => Some(why),
        Look::Nothing | Look::Seen(_) => None,
    }
}

/// The next frame of a real camera.
fn fetch(source: &Background, delay: Duration) -> Came {
    let frame = match source.newest(PATIENCE) {
        Ok(None) => return Came::Nothing,
        Ok(Some(frame)) => frame,
        Err(error) if error.is_lasting() => return Came::Ended(error),
        Err(error) => return words(Look::failed(&error)).map_or(Came::Nothing, Came::Trouble),
    };
    let photo = match decode(&frame.bytes) {
        Ok(photo) => photo,
        Err(error) => return words(Look::failed(&error)).map_or(Came::Nothing, Came::Trouble),
    };
    let Some(content_type) = content_type(&frame.bytes) else {
        return Came::Trouble("the camera sends neither JPEG nor PNG, which a page shows".into());
    };
    let exposed = frame.exposed.checked_sub(delay).unwrap_or(frame.exposed);
    Came::Picture(Picture {
        photo: Arc::new(photo),
        bytes: frame.bytes,
        content_type,
        exposed: Exposed::Wall(exposed),
        arranged: None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;
    use std::time::{Duration, Instant};
    use wmr::vision::{DetectOptions, detect};

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

    #[test]
    fn a_camera_that_is_switched_off_takes_nothing_more() {
        let shared = Arc::new(Shared::default());
        lock(&shared.state).change(None);
        let mut thread = Looking { shared: &shared, turn: 0, drawer: None, shown: None };
        assert!(!thread.step(None), "its turn is over");
    }
}
