//! What stands under the simulated camera: the scene on the desk, and what a person sets down in it.

use super::super::lock;
use super::Lookout;
use crate::cli::endpoint::Stage;
use crate::cli::watch::camera_over;
use hil_sim::base::TruePose;
use hil_sim::camera::{Look, Stream};
use hil_sim::motion::Motion;
use hil_sim::world::{Shape, World};
use std::collections::VecDeque;
use std::sync::Arc;
use wmr::geometry::Pose;
use wmr::scene::Scene;

/// So many things at most are set down on one floor.
const MOST_THINGS: usize = 32;

/// Which floor, and how often the robot was put down on it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(in crate::dashboard) struct Arranged {
    floor: u64,
    place: u64,
    /// How many things were set down.
    things: usize,
}

impl Arranged {
    /// Which floor.
    pub(super) fn floor(self) -> u64 {
        self.floor
    }

    /// Whether the same scene is meant; what moves in it may have come later.
    fn is_same(self, other: Self) -> bool {
        (self.floor, self.place) == (other.floor, other.place)
    }
}

/// Something that a person sets down: a shape that stays, or rolls.
#[derive(Clone, Debug)]
pub(in crate::dashboard) struct Thing {
    pub(in crate::dashboard) shape: Shape,
    pub(in crate::dashboard) motion: Motion,
}

/// The floor as it is wanted.
#[derive(Debug, Default)]
pub(super) struct Floor {
    wanted: Option<Arc<Wanted>>,
    arranged: Arranged,
    things: VecDeque<Thing>,
}

#[derive(Debug)]
struct Wanted {
    world: World,
    start: TruePose,
    stream: Stream,
}

impl Floor {
    /// Another camera begins with another floor.
    pub(super) fn forget(&mut self) {
        self.wanted = None;
        self.things.clear();
    }

    /// Which floor is wanted, if one is.
    pub(super) fn wanted(&self) -> Option<Arranged> {
        self.wanted.as_ref().map(|_| self.arranged)
    }

    /// What draws the floor that is wanted.
    pub(super) fn stream(&self) -> Option<Stream> {
        self.wanted.as_ref().map(|wanted| wanted.stream.clone())
    }

    /// Where the arena's corners are seen, pixels.
    pub(super) fn corners(&self) -> Option<[[f64; 2]; 4]> {
        let wanted = self.wanted.as_ref()?;
        let [width, height] = wanted.world.size;
        let corners = [[0.0, 0.0], [width, 0.0], [width, height], [0.0, height]];
        let lens = wanted.stream.camera().lens();
        let seen = corners.map(|[x, y]| lens.project([x, y, 0.0]));
        Some([seen[0]?, seen[1]?, seen[2]?, seen[3]?])
    }
}

impl Lookout {
    /// Under the simulated camera stands `scene`, with the robot at `start`; the robot is only put there again if
    /// something of that is new, or if that is `wished`.
    pub(in crate::dashboard) fn arrange(&self, scene: &Scene, start: Pose, wished: bool) {
        let (world, start) = (World::from(scene), TruePose::from(start));
        let mut state = lock(&self.0.state);
        let floor = &mut state.floor;
        let known = floor.wanted.as_ref();
        let same_world = known.is_some_and(|known| known.world == world);
        if same_world && known.is_some_and(|known| known.start == start) && !wished {
            return;
        }
        let stream = match known.filter(|_| same_world) {
            Some(known) => known.stream.clone(),
            None => camera_over(world.size, Look::default()),
        };
        floor.wanted = Some(Arc::new(Wanted { world, start, stream }));
        floor.arranged.place += 1;
        if !same_world {
            floor.arranged.floor += 1;
            floor.arranged.things = 0;
            floor.things.clear();
        }
    }

    /// Sets something down from now on; false if the floor is full, or there is none.
    pub(in crate::dashboard) fn set_down(&self, thing: Thing) -> bool {
        let mut state = lock(&self.0.state);
        let floor = &mut state.floor;
        let has_room = floor.wanted.is_some() && floor.arranged.things < MOST_THINGS;
        if has_room {
            floor.things.push_back(thing);
            floor.arranged.things += 1;
        }
        has_room
    }

    /// Makes the simulated floor as it is wanted, where it is not so since `known`; whether anything was moved.
    pub(in crate::dashboard) fn bring_floor(
        &self,
        stage: &mut dyn Stage,
        known: &mut Arranged,
    ) -> bool {
        let (wanted, arranged) = {
            let state = lock(&self.0.state);
            let Some(wanted) = state.floor.wanted.clone() else { return false };
            (wanted, state.floor.arranged)
        };
        if known.is_same(arranged) {
            return false;
        }
        let world = (known.floor != arranged.floor).then(|| wanted.world.clone());
        // A new copy of the camera has exposed nothing yet of what was before.
        stage.arrange(world, wanted.start, wanted.stream.clone());
        *known = Arranged { things: known.things, ..arranged };
        true
    }

    /// Sets down what waits for that.
    pub(in crate::dashboard) fn bring_things(&self, stage: &mut dyn Stage, known: &mut Arranged) {
        let (things, arranged) = {
            let mut state = lock(&self.0.state);
            if state.floor.arranged.floor != known.floor || state.floor.things.is_empty() {
                return;
            }
            (std::mem::take(&mut state.floor.things), state.floor.arranged)
        };
        things.into_iter().for_each(|thing| stage.set_down(thing.shape, thing.motion));
        known.things = arranged.things;
    }
}
