//! What stands on the floor by the last frames, and how it moves.
//!
//! What a frame shows counts at once and as the frame shows it; what it does not show any more counts for one frame
//! longer, so that a thing that flickers stays. Which thing is which, and how fast it moves, is what its track says
//! ([`track::obstacles`](crate::track::obstacles)). What lies under the robot's own disc is the robot. Metres,
//! seconds.

use crate::dynamic::Future;
use crate::geometry::Point;
use crate::scene::Obstacle;
use crate::track::obstacles::{Track, TrackId, Tracker};
use std::time::Duration;

/// What lies within the robot's disc and this much around it is the robot, m.
const AROUND_ROBOT: f64 = 0.012;
/// From one frame to the next a thing that moves goes no further, m.
const CAME: f64 = 0.08;
/// A thing moves if its speed is so many standard deviations, and more than by what edges flicker, m/s.
const SURE: f64 = 3.0;
const STANDS: f64 = 0.04;
/// Things differ if an edge lies so far off, m.
const DIFFERS: f64 = 0.015;

/// Something that the robot must not touch, and how it moves.
#[derive(Clone, Debug, PartialEq)]
pub struct Hazard {
    /// What it is.
    pub obstacle: Obstacle,
    /// Its velocity, m/s; 0 while it stands.
    pub velocity: [f64; 2],
    /// Whether it was seen to move: what has stopped may set out again at any moment, until it has kept its place
    /// for long. What has come so near that it may touch the robot goes on to count: no way leads past it.
    pub may_move: bool,
    /// Whether it was seen often enough to tell whether it moves.
    pub is_known: bool,
}

impl Hazard {
    /// Whether it moves now.
    pub fn moves(&self) -> bool {
        self.velocity != [0.0; 2]
    }
}

/// What stands on the floor.
#[derive(Clone, Debug, Default)]
pub struct Floor {
    tracker: Tracker,
    things: Vec<(TrackId, Hazard)>,
    /// Whether all things are taken to stand where they were last seen.
    is_still: bool,
}

impl Floor {
    /// A floor on which all things are taken to stand where they were last seen.
    pub fn still() -> Self {
        Self { is_still: true, ..Self::default() }
    }

    /// Takes in what a frame shows that was exposed at that time, when the disc of `radius` at `robot` was the
    /// robot's.
    pub fn update(
        &mut self,
        exposed: Duration,
        seen: &[Obstacle],
        (robot, radius): (Option<Point>, f64),
    ) {
        let reach = radius + AROUND_ROBOT;
        let is_robot = |obstacle: &Obstacle| {
            robot.is_some_and(|at| {
                obstacle.footprint.outline().iter().all(|corner| corner.distance(at) < reach)
            })
        };
        // What was seen to come runs into the robot; it is no part of it.
        let moving = self.things.iter().filter(|(_, hazard)| hazard.moves());
        let moving: Vec<Point> =
            moving.map(|(_, hazard)| hazard.obstacle.footprint.bounds().centre()).collect();
        let came = |obstacle: &Obstacle| {
            let at = obstacle.footprint.bounds().centre();
            moving.iter().any(|before| before.distance(at) < CAME)
        };
        let is_robot = |obstacle: &Obstacle| is_robot(obstacle) && !came(obstacle);
        let seen: Vec<Obstacle> =
            seen.iter().filter(|obstacle| !is_robot(obstacle)).cloned().collect();
        self.tracker.update(exposed, &seen);
        let before = std::mem::take(&mut self.things);
        for track in self.tracker.tracks() {
            let last = before.iter().find(|(id, _)| *id == track.id()).map(|(_, last)| last);
            let obstacle = shown(track, &seen, last);
            if !is_robot(&obstacle) {
                let velocity = if self.is_still { [0.0; 2] } else { velocity(track) };
                let touches = || robot.is_some_and(|at| track.footprint().distance(at) < reach);
                let has_come = last.is_some_and(|last| last.may_move) && touches();
                let moved = track.has_moved() || velocity != [0.0; 2] || has_come;
                let may_move = !self.is_still && moved;
                let is_known = self.is_still || may_move || track.stands();
                self.things.push((track.id(), Hazard { obstacle, velocity, may_move, is_known }));
            }
        }
    }

    /// All that must not be touched.
    pub fn hazards(&self) -> Vec<Hazard> {
        self.things.iter().map(|(_, hazard)| hazard.clone()).collect()
    }

    /// The same without how it moves.
    pub fn obstacles(&self) -> Vec<Obstacle> {
        self.things.iter().map(|(_, hazard)| hazard.obstacle.clone()).collect()
    }

    /// What stands and will stand: what a plan goes round.
    pub fn standing(&self) -> Vec<Obstacle> {
        let stands = self.things.iter().filter(|(_, hazard)| !hazard.may_move);
        stands.map(|(_, hazard)| hazard.obstacle.clone()).collect()
    }

    /// What may move, with where each may be from `now` on; the hazards' indices beside them.
    pub fn futures(&self, now: Duration) -> (Vec<usize>, Vec<Future>) {
        self.futures_of(now, |hazard| hazard.may_move)
    }

    /// The same of what was not seen often enough to tell whether it moves: it may be anywhere that things go.
    pub fn newcomers(&self, now: Duration) -> (Vec<usize>, Vec<Future>) {
        self.futures_of(now, |hazard| !hazard.is_known)
    }

    fn futures_of(
        &self,
        now: Duration,
        counts: impl Fn(&Hazard) -> bool,
    ) -> (Vec<usize>, Vec<Future>) {
        let lag = now.saturating_sub(self.tracker.time());
        let these = self.things.iter().enumerate().filter(|(_, (_, hazard))| counts(hazard));
        let found = these.filter_map(|(index, (id, _))| {
            let track = self.tracker.tracks().iter().find(|track| track.id() == *id)?;
            Some((index, Future::of(track, lag)))
        });
        found.unzip()
    }

    /// Whether something that stands has come or gone compared with `others`.
    pub fn differs_from(&self, others: &[Obstacle]) -> bool {
        let alike = |a: &Obstacle, b: &Obstacle| {
            let (a, b) = (a.footprint.bounds(), b.footprint.bounds());
            [a.x0 - b.x0, a.y0 - b.y0, a.x1 - b.x1, a.y1 - b.y1]
                .iter()
                .all(|off| off.abs() < DIFFERS)
        };
        let has = |all: &[Obstacle], one: &Obstacle| all.iter().any(|other| alike(one, other));
        let now = self.standing();
        now.iter().any(|one| !has(others, one)) || others.iter().any(|one| !has(&now, one))
    }
}

/// What the frame shows of a track, or what was last shown of it.
fn shown(track: &Track, seen: &[Obstacle], last: Option<&Hazard>) -> Obstacle {
    let there = track.footprint().bounds().centre();
    let off = |obstacle: &Obstacle| obstacle.footprint.bounds().centre().distance(there);
    let nearest = seen.iter().min_by(|a, b| off(a).total_cmp(&off(b)));
    match (nearest.filter(|_| track.misses() == 0), last) {
        (Some(shown), _) => shown.clone(),
        (None, Some(last)) => last.obstacle.clone(),
        (None, None) => track.footprint().into(),
    }
}

/// A track's velocity, if it is no noise.
fn velocity(track: &Track) -> [f64; 2] {
    let [vx, vy] = track.velocity();
    let least = (SURE * track.velocity_sigma()).max(STANDS);
    if vx.hypot(vy) > least { [vx, vy] } else { [0.0; 2] }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Rect;

    fn thing(x: f64, y: f64) -> Obstacle {
        Rect::new(x - 0.1, y - 0.1, x + 0.1, y + 0.1).into()
    }

    fn at(frame: u64) -> Duration {
        Duration::from_millis(100 * frame)
    }

    #[test]
    fn a_box_at_a_quarter_of_a_metre_a_second() {
        let mut floor = Floor::default();
        for frame in 0..8 {
            let boxes = [thing(0.5 + 0.025 * frame as f64, 0.5), thing(1.5, 0.5)];
            floor.update(at(frame), &boxes, (None, 0.075));
        }
        let hazards = floor.hazards();
        assert_eq!(hazards.len(), 2);
        assert!((hazards[0].velocity[0] - 0.25).abs() < 0.02 && hazards[0].moves());
        assert!(!hazards[1].moves());
    }

    #[test]
    fn what_moves_has_a_future_and_what_stands_is_planned_round() {
        let mut floor = Floor::default();
        (0..8).for_each(|frame| {
            let boxes = [thing(0.5 + 0.025 * frame as f64, 0.5), thing(1.5, 0.5)];
            floor.update(at(frame), &boxes, (None, 0.075));
        });
        assert_eq!(floor.standing(), [thing(1.5, 0.5)]);
        // 0.1 s after the last frame, and 0.8 s later, at a quarter of a metre a second.
        let (indices, futures) = floor.futures(at(8));
        assert_eq!(indices, [0]);
        assert!((futures[0].centre(0.0).x - 0.7).abs() < 0.01, "{:?}", futures[0].centre(0.0));
        assert!((futures[0].centre(0.8).x - 0.9).abs() < 0.02);
    }

    #[test]
    fn a_newcomer_may_come_from_anywhere_until_it_is_known() {
        let mut floor = Floor::default();
        for frame in 0..5 {
            floor.update(at(frame), &[thing(0.5, 0.5)], (None, 0.075));
            let (indices, newcomers) = floor.newcomers(at(frame));
            // After one frame it may go at 0.2 m/s, one standard deviation; 3.4 of them hold 99 %.
            if frame == 0 {
                assert_eq!(indices, [0]);
                assert!(
                    (newcomers[0].reach(1.0) - 0.68).abs() < 0.02,
                    "{}",
                    newcomers[0].reach(1.0)
                );
            }
            assert_eq!(newcomers.is_empty(), frame == 4, "frame {frame}");
        }
        assert_eq!(floor.futures(at(4)).1, []);
    }

    #[test]
    fn what_has_stopped_may_set_out_again_until_it_has_kept_its_place_for_long() {
        let mut floor = Floor::default();
        // It comes at 0.2 m/s and stops after a second.
        let mut reaches = Vec::new();
        for frame in 0..120u64 {
            let boxes = [thing(0.5 + 0.02 * frame.min(10) as f64, 0.5), thing(1.5, 0.5)];
            floor.update(at(frame), &boxes, (None, 0.075));
            let (_, futures) = floor.futures(at(frame));
            reaches.extend(futures.first().map(|future| future.reach(1.0)));
        }
        let hazards = floor.hazards();
        // Within five seconds it may go far; then it is taken to stay.
        assert!(reaches.len() > 60 && reaches.iter().all(|reach| *reach > 0.08), "{reaches:?}");
        assert!(hazards.iter().all(|hazard| !hazard.moves() && !hazard.may_move));
        assert_eq!(floor.standing(), [thing(0.7, 0.5), thing(1.5, 0.5)]);
    }

    #[test]
    fn what_has_come_to_touch_the_robot_never_counts_as_standing() {
        // It comes at 0.2 m/s, and stops when 30 mm of it lie under the robot's disc, or 30 mm beside it.
        let standing = |robot: f64| {
            let mut floor = Floor::default();
            for frame in 0..120u64 {
                let boxes = [thing(0.5 + 0.02 * frame.min(10) as f64, 0.5)];
                floor.update(at(frame), &boxes, (Some(Point::new(robot, 0.5)), 0.075));
            }
            floor.standing().len()
        };
        assert_eq!([0.845, 0.905].map(standing), [0, 1]);
    }

    #[test]
    fn a_thing_that_is_gone_counts_for_one_frame_longer() {
        let mut floor = Floor::default();
        floor.update(at(0), &[thing(0.5, 0.5)], (None, 0.075));
        floor.update(at(1), &[], (None, 0.075));
        assert_eq!(floor.hazards().len(), 1);
        floor.update(at(2), &[], (None, 0.075));
        assert_eq!(floor.hazards().len(), 0);
    }

    #[test]
    fn the_robot_is_no_hazard_to_itself() {
        let mut floor = Floor::default();
        let part = Rect::new(0.45, 0.45, 0.55, 0.55).into();
        floor.update(at(0), &[part, thing(0.6, 0.5)], (Some(Point::new(0.5, 0.5)), 0.075));
        assert_eq!(floor.obstacles(), [thing(0.6, 0.5)], "what reaches out of its disc is one");
    }

    #[test]
    fn millimetres_make_no_difference() {
        let mut floor = Floor::default();
        floor.update(at(0), &[thing(0.5, 0.5)], (None, 0.075));
        assert!(!floor.differs_from(&[thing(0.51, 0.5)]));
        assert!(floor.differs_from(&[thing(0.52, 0.5)]) && floor.differs_from(&[]));
        assert!(floor.differs_from(&[thing(0.5, 0.5), thing(1.5, 0.5)]));
    }
}
