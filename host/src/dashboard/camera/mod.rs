//! The camera over the arena, if one is on: its newest frame for the pages, and what is seen in it for a drive.
//!
//! ```text
//! simulation ─► exposure ─┐                      ┌─► shot ─► pages
//!                         ├─► thread: a picture ─┤
//! folder, URL ─► frame ───┘                      └─► eye ─► looks ─► robot's thread
//! ```
//! The camera's thread draws or decodes, and looks; nobody waits for it. Of what it cannot keep up with only the
//! newest is kept. The world of a watched simulated robot stands still while its camera is behind, so that
//! however slow the computer is, a picture is as old as its times say; a robot that is to stop waits for nothing.
//! Seconds of the port's clock where nothing else is said; pixels only for frames and corners.

mod floor;
mod looking;
mod shot;
mod watch;

pub(super) use floor::{Arranged, Thing};
pub(super) use shot::Shot;

use super::corrections::Corrections;
use super::lock;
use floor::Floor;
use hil_sim::camera::Exposure;
use looking::look_on;
use serde_json::{Value, json};
use std::sync::{Arc, Condvar, Mutex};
use std::time::{Duration, Instant};
use watch::Watch;
use wmr::geometry::{Arena, Pose};
use wmr::vision::Camera;
use wmr::watch::source::{self, Background, SourceError};
use wmr::watch::{Eye, Look, Watcher};

/// The name of the simulated camera over the simulated robot.
pub(super) const SIMULATED: &str = "sim";
/// A simulated world waits so long for its camera at most.
const LONGEST_WAIT: Duration = Duration::from_secs(10);

/// The camera, shared by the requests, its own thread and the robot's.
#[derive(Clone, Debug, Default)]
pub(super) struct Lookout(Arc<Shared>);

#[derive(Debug, Default)]
struct Shared {
    state: Mutex<State>,
    /// Something has come for the camera's thread.
    wake: Condvar,
}

#[derive(Debug, Default)]
struct State {
    /// What is on.
    source: Option<Arc<str>>,
    /// Counts how often that has changed: the thread of an older camera ends.
    turn: u64,
    newest: Option<Arc<Shot>>,
    /// Counts the frames that were shown.
    shots: u64,
    /// Why the last picture was of no use, or none came.
    problem: Option<String>,
    /// Where the arena's corners were seen last, pixels.
    corners: Option<[[f64; 2]; 4]>,
    floor: Floor,
    /// What the simulated camera is to draw next, and since when that waits.
    due: Option<(Due, Instant)>,
    watch: Option<Watch>,
    /// Counts the drives that were watched.
    watched: u64,
}

/// A frame of the simulated camera that is to be drawn.
#[derive(Debug)]
struct Due {
    exposure: Exposure,
    arranged: Arranged,
}

impl Lookout {
    /// Switches a camera on, in place of any other: the simulated one, or a source by its name, whose pictures
    /// are older by `delay` than it says.
    pub(super) fn switch_on(&self, name: &str, delay: Duration) -> Result<(), SourceError> {
        let feed = match name {
            SIMULATED => None,
            name => Some((Background::start(source::open(name)?), delay)),
        };
        let mut state = lock(&self.0.state);
        state.change(Some(name.into()));
        let (shared, turn) = (Arc::clone(&self.0), state.turn);
        std::thread::spawn(move || look_on(&shared, turn, feed.as_ref()));
        Ok(())
    }

    pub(super) fn switch_off(&self) {
        lock(&self.0.state).change(None);
        self.0.wake.notify_all();
    }

    /// The name of the camera that is on.
    pub(super) fn source(&self) -> Option<Arc<str>> {
        lock(&self.0.state).source.clone()
    }

    pub(super) fn is_simulated(&self) -> bool {
        lock(&self.0.state).is_simulated()
    }

    /// The lens of the simulated camera, if that is on and hangs over a floor.
    pub(super) fn lens(&self) -> Option<Camera> {
        lock(&self.0.state).floor.stream().map(|stream| Camera::from(stream.camera().lens()))
    }

    /// The newest frame; of a simulated camera only one of the floor as it is arranged now.
    pub(super) fn newest(&self) -> Option<Arc<Shot>> {
        let state = lock(&self.0.state);
        let wanted = state.floor.wanted();
        let is_current =
            |shot: &&Arc<Shot>| shot.arranged.is_none_or(|arranged| Some(arranged) == wanted);
        state.newest.as_ref().filter(is_current).cloned()
    }

    /// The newest frame, whatever it shows.
    pub(super) fn shown(&self) -> Option<Arc<Shot>> {
        lock(&self.0.state).newest.clone()
    }

    /// The camera as a page shows it; `sources` are those that it may switch on.
    pub(super) fn document(&self, sources: &[&str]) -> Value {
        let state = lock(&self.0.state);
        let shot = state.newest.as_ref();
        json!({
            "source": state.source.as_deref(),
            "sources": sources,
            "frame": shot.map(|shot| shot.number),
            "size": shot.map(|shot| shot.size),
            "age": shot.map(|shot| shot.taken.elapsed().as_secs_f64()),
            "corners_px": state.corners.or_else(|| state.floor.corners()),
            "problem": state.problem,
        })
    }

    /// A frame of the simulated camera, exposed over the floor as it was arranged then.
    pub(super) fn offer(&self, exposure: Exposure, arranged: Arranged) {
        let mut state = lock(&self.0.state);
        if state.is_simulated() {
            let since = state.due.take().map_or_else(Instant::now, |(_, since)| since);
            state.due = Some((Due { exposure, arranged }, since));
            self.0.wake.notify_all();
        }
    }

    /// Whether the world of a simulated robot is to wait: a drive is watched, and a frame of it is not drawn yet.
    pub(super) fn is_behind(&self) -> bool {
        let state = lock(&self.0.state);
        let waits = state.watch.as_ref().is_some_and(Watch::waits);
        waits && state.due.as_ref().is_some_and(|(_, since)| since.elapsed() < LONGEST_WAIT)
    }

    /// From now on pictures are looked at with `eye`, corrected as a person has said; `speed` is how many of the
    /// port's seconds pass in one. Who has the answer gets what is seen, until it is dropped.
    pub(super) fn watch(
        &self,
        eye: Eye,
        arena: Arena,
        corrections: Corrections,
        speed: f64,
    ) -> LookoutWatcher {
        let mut state = lock(&self.0.state);
        state.watched += 1;
        let number = state.watched;
        state.watch = Some(Watch::new(number, eye, arena, corrections, speed));
        LookoutWatcher { lookout: self.clone(), number, turn: state.turn }
    }
}

impl State {
    fn is_simulated(&self) -> bool {
        self.source.as_deref() == Some(SIMULATED)
    }

    fn change(&mut self, source: Option<Arc<str>>) {
        self.source = source;
        self.turn += 1;
        (self.newest, self.problem, self.corners) = (None, None, None);
        (self.due, self.watch) = (None, None);
        self.floor.forget();
    }
}

/// What a watched drive sees by the camera.
#[derive(Debug)]
pub(super) struct LookoutWatcher {
    lookout: Lookout,
    number: u64,
    /// The camera that was on when the drive began.
    turn: u64,
}

impl LookoutWatcher {
    /// No world waits for a frame any more: a robot that is to stop does so at once.
    pub(super) fn hurry(&self) {
        if let Some(watch) = &mut lock(&self.lookout.0.state).watch {
            watch.hurry();
        }
    }
}

impl Drop for LookoutWatcher {
    fn drop(&mut self) {
        let mut state = lock(&self.lookout.0.state);
        if state.watch.as_ref().is_some_and(|watch| watch.number == self.number) {
            state.watch = None;
        }
    }
}

impl<P> Watcher<P> for LookoutWatcher {
    fn expect(&mut self, at: Duration, pose: Pose) {
        if let Some(watch) = &mut lock(&self.lookout.0.state).watch {
            watch.expect(at, pose);
        }
    }

    fn look(&mut self, _: &mut P, _: Duration) -> Result<Look, SourceError> {
        let mut state = lock(&self.lookout.0.state);
        if state.turn != self.turn {
            // Somebody has switched it off; the drive waits in the end, and says why.
            return Ok(Look::Nothing);
        }
        state.watch.as_mut().map_or(Ok(Look::Nothing), Watch::next)
    }
}
