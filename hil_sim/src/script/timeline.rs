//! Which faults of a script hold at a moment.

use super::{Event, Fault, Script, Scripted, Trigger};
use crate::base::{Faults, TruePose};
use crate::camera::CameraFaults;
use crate::motion::Motion;
use crate::wire::{self, Pace};
use crate::world::Shape;
use std::time::Duration;

/// Wheels slower than this rest, rad/s.
const RESTING: f64 = 0.05;

/// What is seen of the base at a moment.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Glance {
    pub(crate) pose: TruePose,
    pub(crate) wheel_speeds: [f64; 2],
    pub(crate) touches: bool,
}

/// What a fault that begins or ends asks for at once.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Change {
    Reset,
    PowerOff,
    PowerOn,
    Battery(f64),
    Push([f64; 3]),
    Place(TruePose),
    Add(Shape, Motion),
    Remove(Shape, Motion),
}

/// What all faults that hold add up to.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Condition {
    pub(crate) base: Faults,
    /// To the robot and to the host; `None` where a wire is as it was before the script.
    pub(crate) wires: [Option<(wire::Faults, Pace)>; 2],
    pub(crate) camera: CameraFaults,
}

/// A script that runs.
#[derive(Clone, Debug)]
pub(crate) struct Timeline {
    entries: Vec<Entry>,
    began: Duration,
    motion: Option<Event>,
    touched: bool,
}

#[derive(Clone, Debug)]
struct Entry {
    scripted: Scripted,
    /// How often its event was seen.
    seen: u32,
    due: Option<Duration>,
    stage: Stage,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stage {
    Waiting,
    Holding,
    Over,
}

impl Timeline {
    /// The script begins `now`.
    pub(crate) fn new(script: Script, now: Duration) -> Self {
        let entry = |scripted: Scripted| {
            let due = (scripted.trigger == Trigger::Start).then_some(now + scripted.delay);
            Entry { scripted, seen: 0, due, stage: Stage::Waiting }
        };
        let entries = script.faults.into_iter().map(entry).collect();
        Self { entries, began: now, motion: None, touched: false }
    }

    /// Since when it runs.
    pub(crate) fn began(&self) -> Duration {
        self.began
    }

    /// What changes `now`, at this sight of the base; and all that holds, if that has changed.
    pub(crate) fn step(
        &mut self,
        now: Duration,
        glance: Glance,
    ) -> (Vec<Change>, Option<Condition>) {
        let events = self.events(glance);
        let mut changes = Vec::new();
        let mut changed = false;
        for entry in &mut self.entries {
            entry.notice(now, &events, glance.pose);
            let before = entry.stage;
            changes.extend(entry.advance(now));
            changed |= entry.stage != before;
        }
        (changes, changed.then(|| self.condition()))
    }

    fn events(&mut self, glance: Glance) -> Vec<Event> {
        let [left, right] = glance.wheel_speeds;
        let motion = if left.abs().max(right.abs()) < RESTING {
            self.motion.and(Some(Event::Rest))
        } else if left * right < 0.0 {
            Some(Event::Turn)
        } else {
            Some(Event::Drive)
        };
        // At a crawl one wheel may stand for a moment: only what is clear is an event.
        let clear = left.abs().min(right.abs()) > 10.0 * RESTING || motion == Some(Event::Rest);
        let mut events = Vec::new();
        if clear && motion != self.motion {
            self.motion = motion;
            events.extend(motion);
        }
        if glance.touches && !self.touched {
            events.push(Event::Bump);
        }
        self.touched = glance.touches;
        events
    }

    fn condition(&self) -> Condition {
        let mut condition = Condition::default();
        let holds = self.entries.iter().filter(|entry| entry.stage == Stage::Holding);
        holds.for_each(|entry| condition.add(&entry.scripted.fault));
        condition
    }
}

impl Entry {
    fn notice(&mut self, now: Duration, events: &[Event], pose: TruePose) {
        if self.due.is_some() {
            return;
        }
        let met = match self.scripted.trigger {
            Trigger::Start => true,
            Trigger::Place { at: [x, y], radius } => (pose.x - x).hypot(pose.y - y) <= radius,
            Trigger::Event { event, nth } => {
                self.seen += u32::from(events.contains(&event));
                self.seen >= nth
            }
        };
        self.due = met.then_some(now + self.scripted.delay);
    }

    fn advance(&mut self, now: Duration) -> Option<Change> {
        let due = self.due.filter(|due| *due <= now)?;
        match self.stage {
            Stage::Waiting => {
                self.stage = Stage::Holding;
                begins(&self.scripted.fault)
            }
            Stage::Holding => {
                self.scripted.lasts.filter(|lasts| due + *lasts <= now)?;
                self.stage = Stage::Over;
                ends(&self.scripted.fault)
            }
            Stage::Over => None,
        }
    }
}

fn begins(fault: &Fault) -> Option<Change> {
    Some(match fault {
        Fault::Reset => Change::Reset,
        Fault::BrownOut => Change::PowerOff,
        Fault::Battery(volts) => Change::Battery(*volts),
        Fault::Bump(push) => Change::Push(*push),
        Fault::Kidnapped(pose) => Change::Place(*pose),
        Fault::Shape(shape, motion) => Change::Add(shape.clone(), motion.clone()),
        _ => return None,
    })
}

/// A full battery of the parts list, V.
const CHARGED: f64 = 5.2;

fn ends(fault: &Fault) -> Option<Change> {
    Some(match fault {
        Fault::BrownOut => Change::PowerOn,
        Fault::Battery(_) => Change::Battery(CHARGED),
        Fault::Shape(shape, motion) => Change::Remove(shape.clone(), motion.clone()),
        _ => return None,
    })
}

impl Condition {
    fn add(&mut self, fault: &Fault) {
        let base = &mut self.base;
        match fault {
            Fault::Wires(wires) => {
                for (wire, _) in self.wires.iter_mut().zip(wires.directions).filter(|(_, is)| *is) {
                    let (faults, pace) = wire.unwrap_or_default();
                    *wire = Some((worse(faults, wires.faults), slower(pace, wires.pace)));
                }
            }
            Fault::Encoder(wheels, fault) => wheels.apply(&mut base.encoders, *fault),
            Fault::EncodersSwapped => base.encoders_swapped = true,
            Fault::Blocked(wheels) => wheels.apply(&mut base.blocked, true),
            Fault::Slip(wheels, share) => wheels.apply(&mut base.slip, *share),
            Fault::Weak(wheels, share) => wheels.apply(&mut base.weak, *share),
            Fault::Lifted => base.lifted = true,
            Fault::Camera(fault) => self.camera = fails_more(self.camera, *fault),
            Fault::Reset
            | Fault::BrownOut
            | Fault::Battery(_)
            | Fault::Bump(_)
            | Fault::Kidnapped(_)
            | Fault::Shape(..) => {}
        }
    }
}

fn worse(a: wire::Faults, b: wire::Faults) -> wire::Faults {
    wire::Faults {
        loss: a.loss.max(b.loss),
        corruption: a.corruption.max(b.corruption),
        duplication: a.duplication.max(b.duplication),
        truncation: a.truncation.max(b.truncation),
        reordering: a.reordering.max(b.reordering),
        depth: a.depth.max(b.depth),
    }
}

fn fails_more(a: CameraFaults, b: CameraFaults) -> CameraFaults {
    CameraFaults {
        dark: a.dark || b.dark,
        frozen: a.frozen || b.frozen,
        late: a.late.max(b.late),
        lost: a.lost.max(b.lost),
        moved: b.moved.or(a.moved),
    }
}

fn slower(a: Pace, b: Pace) -> Pace {
    Pace {
        latency: a.latency.max(b.latency),
        jitter: a.jitter.max(b.jitter),
        baud: a.baud.or(b.baud),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const REST: Glance = Glance {
        pose: TruePose { x: 0.0, y: 0.0, heading: 0.0 },
        wheel_speeds: [0.0; 2],
        touches: false,
    };

    fn timeline(text: &str) -> Timeline {
        Timeline::new(Script::parse(text).unwrap(), Duration::from_secs(1))
    }

    /// Tenths of a second at which what holds has changed, with the loss towards the robot then.
    fn losses(timeline: &mut Timeline, glance: impl Fn(u64) -> Glance) -> Vec<(u64, f64)> {
        let mut found = Vec::new();
        for tenth in 10..60 {
            let (_, condition) = timeline.step(Duration::from_millis(100 * tenth), glance(tenth));
            let loss = condition.map(|all| all.wires[0].map_or(0.0, |(faults, _)| faults.loss));
            found.extend(loss.map(|loss| (tenth, loss)));
        }
        found
    }

    #[test]
    fn faults_begin_and_end_on_time_and_the_worst_counts() {
        let text = "[[fault]]\nkind = \"loss\"\nshare = 0.2\nat = 0.5\nfor = 1\n\
                    [[fault]]\nkind = \"cut\"\nat = 1\nfor = 1";
        let seen = losses(&mut timeline(text), |_| REST);
        assert_eq!(seen, [(15, 0.2), (20, 1.0), (25, 1.0), (30, 0.0)]);
    }

    #[test]
    fn the_second_turn_and_a_place_are_waited_for() {
        let text =
            "[[fault]]\nkind = \"loss\"\nshare = 0.2\nevent = \"turn\"\nnth = 2\nafter = 0.2";
        let driven = |tenth| {
            let wheel_speeds = match tenth {
                15..20 | 35..40 => [-2.0, 2.0],
                20..35 => [3.0, 3.0],
                _ => [0.0; 2],
            };
            let pose = TruePose { x: tenth as f64 / 10.0, ..REST.pose };
            Glance { wheel_speeds, pose, ..REST }
        };
        assert_eq!(losses(&mut timeline(text), driven), [(37, 0.2)]);
        let text = "[[fault]]\nkind = \"loss\"\nshare = 0.2\nplace = [3, 0, 0.15]";
        assert_eq!(losses(&mut timeline(text), driven), [(29, 0.2)]);
    }

    #[test]
    fn power_goes_and_comes_back() {
        let mut timeline = timeline("[[fault]]\nkind = \"brown-out\"\nat = 1\nfor = 0.2");
        let changes: Vec<_> = (10..40)
            .flat_map(|tenth| {
                let (changes, _) = timeline.step(Duration::from_millis(100 * tenth), REST);
                changes.into_iter().map(move |change| (tenth, change))
            })
            .collect();
        assert_eq!(changes, [(20, Change::PowerOff), (22, Change::PowerOn)]);
    }
}
