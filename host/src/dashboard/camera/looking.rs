//! The camera's thread: from exposures and frames to pictures, shots and looks.

use super::shot::{Shot, content_type, jpeg};
use super::watch::Exposed;
use super::{Arranged, Due, Shared, State};
use crate::dashboard::lock;
use axum::body::Bytes;
use hil_sim::camera::Stream;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, PoisonError};
use std::time::{Duration, Instant};
use wmr::geometry::{Arena, Pose};
use wmr::vision::{Photo, check_picture, decode};
use wmr::watch::source::{Background, SourceError};
use wmr::watch::{Eye, Look};

/// The thread looks this often whether its camera is still on.
const PATIENCE: Duration = Duration::from_millis(100);
/// Pages get frames so far apart at least.
const SHOW_INTERVAL: Duration = Duration::from_millis(90);

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
        let look = watch.give_back(eye, look);
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
        let expected = watch.expected_at(exposed);
        let (number, arena) = (watch.number, watch.arena);
        Some(Job { number, eye: watch.take_eye()?, exposed, expected, arena })
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

    #[test]
    fn a_camera_that_is_switched_off_takes_nothing_more() {
        let shared = Arc::new(Shared::default());
        lock(&shared.state).change(None);
        let mut thread = Looking { shared: &shared, turn: 0, drawer: None, shown: None };
        assert!(!thread.step(None), "its turn is over");
    }
}
