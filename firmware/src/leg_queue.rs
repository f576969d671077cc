//! The batch of legs that is being received, and the plan that is being driven.
//!
//! ```text
//! begin ─► collect ─► commit ─► legs not begun ─► next_leg
//! ```
//! A batch is collected leg by leg beside the plan that runs and joins it only as a whole: the number
//! of legs and their digest must be those announced, and every leg must be drivable. Legs have a
//! place in their plan, so a batch that comes twice, late or with a gap is recognised.
//!
//! Solving a leg to see whether it can be driven takes 20 000 cycles on an RP2040, a third of what a
//! control tick may take, so each is solved as it comes and not all of them at the end.

use heapless::{Deque, Vec};
use protocol::message::{Driven, MAX_LEGS, Placement, PlanHeader, PlanRefusal, plan_digest};
use protocol::motion::{Leg, Limits, Position};
use protocol::units::Metres;

/// Legs announced, legs collected, legs to drive.
#[derive(Clone, Debug, Default)]
pub(crate) struct LegQueue {
    header: Option<PlanHeader>,
    collected: Vec<Leg, MAX_LEGS>,
    overflow: bool,
    refusal: Option<PlanRefusal>,
    plan: Option<u32>,
    waiting: Deque<Leg, MAX_LEGS>,
    end: u16,
    done: u16,
    /// Where the last leg that was begun ends.
    goal: Position,
}

impl LegQueue {
    /// Announces a batch; forgets what was collected before.
    pub(crate) fn begin(&mut self, header: PlanHeader) {
        self.forget_batch();
        self.header = Some(header);
    }

    /// Collects a leg. One of another plan or out of order makes the batch incomplete; one that cannot
    /// be driven within `limits`, or begins elsewhere than the one before it ends, makes it refused.
    pub(crate) fn collect(&mut self, leg: Leg, limits: &Limits) {
        let before = self.collected.last().map(|before| before.goal);
        if self.collected.push(leg).is_err() {
            self.overflow = true;
        } else if self.refusal.is_none() {
            let index = leg.index;
            let undrivable =
                leg.check(limits).map_err(|refusal| PlanRefusal::Leg { index, refusal });
            let joins = before.map_or(Ok(()), |end| leg.follows(end)).map_err(apart(index));
            self.refusal = undrivable.and(joins).err();
        }
    }

    /// Forgets what was announced and collected.
    pub(crate) fn forget_batch(&mut self) {
        self.header = None;
        self.collected.clear();
        self.overflow = false;
        self.refusal = None;
    }

    /// Where the announced batch goes, if one is announced.
    pub(crate) fn announced(&self) -> Option<Placement> {
        self.header.map(|header| header.placement)
    }

    /// Makes the collected batch part of the plan to drive, and returns what was announced of it.
    ///
    /// `room` is how many legs may wait in all.
    ///
    /// # Errors
    /// [`PlanRefusal`] if it is not complete, does not fit, or a leg cannot be driven; the plan is
    /// then as before.
    pub(crate) fn commit(&mut self, plan: u32, room: usize) -> Result<PlanHeader, PlanRefusal> {
        let header =
            self.header.filter(|header| header.plan == plan).ok_or(PlanRefusal::Incomplete)?;
        let kept = self.check_place(&header)?;
        let room = room.saturating_sub(kept);
        if self.overflow || usize::from(header.count) > room {
            return Err(PlanRefusal::TooManyLegs { room: room as u16 });
        }
        if header.count == 0 {
            return Err(PlanRefusal::Empty);
        }
        let end = self.check_complete(&header)?;
        if let Some(refusal) = self.refusal {
            return Err(refusal);
        }
        self.check_first(&header, kept)?;
        self.take_over(&header, kept, end);
        Ok(header)
    }

    /// The next leg to drive, once each.
    pub(crate) fn next_leg(&mut self) -> Option<Leg> {
        let leg = self.waiting.pop_front()?;
        self.goal = leg.goal;
        Some(leg)
    }

    /// Records that a leg has ended.
    pub(crate) fn finish_leg(&mut self, index: u16) {
        self.done = index.wrapping_add(1);
    }

    /// The plan and how far it has been driven; `None` after a start or stop.
    pub(crate) fn driven(&self) -> Option<Driven> {
        self.plan.map(|plan| Driven { plan, next: self.done, end: self.end })
    }

    /// Forgets the legs of `plan` that have not begun.
    pub(crate) fn cancel(&mut self, plan: u32) {
        if self.plan == Some(plan) {
            self.end = self.begun();
            self.waiting.clear();
        }
    }

    /// Forgets the plan that is driven.
    pub(crate) fn clear(&mut self) {
        self.plan = None;
        self.waiting.clear();
    }

    /// The first leg that has not begun.
    fn begun(&self) -> u16 {
        self.end.wrapping_sub(self.waiting.len() as u16)
    }

    /// How many of the waiting legs stay in front of the announced batch.
    fn check_place(&self, header: &PlanHeader) -> Result<usize, PlanRefusal> {
        if let Placement::Start(pose) = header.placement {
            return if pose.is_sane() { Ok(0) } else { Err(PlanRefusal::Start) };
        }
        if self.plan != Some(header.plan) {
            return Err(PlanRefusal::OtherPlan);
        }
        let (begun, end) = (self.begun(), self.end);
        let fits = match header.placement {
            Placement::Replace => (begun..=end).contains(&header.first),
            Placement::Append | Placement::Start(_) => header.first == end,
        };
        if !fits {
            return Err(PlanRefusal::OutOfPlace { begun, end });
        }
        Ok(usize::from(header.first - begun))
    }

    /// The index after the batch's last leg, if the legs are those announced.
    fn check_complete(&self, header: &PlanHeader) -> Result<u16, PlanRefusal> {
        let end = header.first.checked_add(header.count).ok_or(PlanRefusal::Incomplete)?;
        let in_order = self
            .collected
            .iter()
            .zip(header.first..)
            .all(|(leg, index)| leg.plan == header.plan && leg.index == index);
        let complete = self.collected.len() == usize::from(header.count)
            && plan_digest(&self.collected) == header.digest;
        if in_order && complete { Ok(end) } else { Err(PlanRefusal::Incomplete) }
    }

    /// Whether the batch begins where the robot stands, or where the legs before it end.
    fn check_first(&self, header: &PlanHeader, kept: usize) -> Result<(), PlanRefusal> {
        let Some(first) = self.collected.first() else { return Ok(()) };
        let joins = match header.placement {
            Placement::Start(pose) => first.passes(Position { x: pose.x, y: pose.y }),
            Placement::Append | Placement::Replace => {
                let before = kept.checked_sub(1).and_then(|last| self.waiting.iter().nth(last));
                first.follows(before.map_or(self.goal, |leg| leg.goal))
            }
        };
        joins.map_err(apart(first.index))
    }

    fn take_over(&mut self, header: &PlanHeader, kept: usize, end: u16) {
        while self.waiting.len() > kept {
            self.waiting.pop_back();
        }
        for leg in &self.collected {
            // `commit` has checked that there is room.
            let _ = self.waiting.push_back(*leg);
        }
        if matches!(header.placement, Placement::Start(_)) {
            self.plan = Some(header.plan);
            self.done = header.first;
        }
        self.end = end;
        self.forget_batch();
    }
}

fn apart(index: u16) -> impl Fn(Metres) -> PlanRefusal {
    move |gap| PlanRefusal::Apart { index, gap: gap.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use protocol::motion::{Direction, Pose, Position, Refusal, Timing};
    use protocol::parameters::Parameters;
    use std::vec::Vec;

    fn leg(index: u16) -> Leg {
        Leg {
            plan: 9,
            index,
            start: Pose::new(index.into(), 0.0, 0.0),
            goal: Position::new(f32::from(index) + 1.0, 0.0),
            goal_heading: None,
            direction: Direction::Forward,
            timing: Timing::Limits,
        }
    }

    fn commit(
        queue: &mut LegQueue,
        placement: Placement,
        legs: &[Leg],
        announced: &[Leg],
    ) -> Result<PlanHeader, PlanRefusal> {
        let first = announced.first().map_or(0, |leg| leg.index);
        let (count, digest) = (announced.len() as u16, plan_digest(announced));
        queue.begin(PlanHeader { plan: 9, first, count, digest, placement });
        let limits = Parameters::default().limits();
        legs.iter().for_each(|leg| queue.collect(*leg, &limits));
        queue.commit(9, MAX_LEGS)
    }

    const START: Placement = Placement::Start(Pose::new(0.0, 0.0, 0.0));

    fn indices(mut queue: LegQueue) -> Vec<u16> {
        std::iter::from_fn(|| queue.next_leg()).map(|leg| leg.index).collect()
    }

    #[test]
    fn only_the_announced_legs_in_their_order_are_a_batch() {
        fn collect(legs: &[Leg], announced: &[Leg]) -> Result<PlanHeader, PlanRefusal> {
            commit(&mut LegQueue::default(), START, legs, announced)
        }
        let two = [leg(0), leg(1)];
        assert!(collect(&two, &two).is_ok());
        assert_eq!(collect(&two[..1], &two), Err(PlanRefusal::Incomplete));
        assert_eq!(collect(&[leg(1), leg(0)], &two), Err(PlanRefusal::Incomplete));
        let mut other = two;
        other[1].goal = Position::new(2.0, 0.1);
        assert_eq!(collect(&other, &two), Err(PlanRefusal::Incomplete));
        assert_eq!(collect(&[], &[]), Err(PlanRefusal::Empty));
    }

    #[test]
    fn a_leg_that_cannot_be_driven_is_named() {
        let mut bad = leg(1);
        bad.goal = Position::new(f32::INFINITY, 0.0);
        let batch = [leg(0), bad];
        let refusal = commit(&mut LegQueue::default(), START, &batch, &batch);
        assert_eq!(refusal, Err(PlanRefusal::Leg { index: 1, refusal: Refusal::NotSane }));
    }

    #[test]
    fn a_batch_goes_on_only_where_the_last_ended() {
        let mut queue = LegQueue::default();
        let (one, two) = ([leg(0), leg(1)], [leg(2), leg(3)]);
        assert_eq!(commit(&mut queue, Placement::Append, &one, &one), Err(PlanRefusal::OtherPlan));
        commit(&mut queue, START, &one, &one).unwrap();
        commit(&mut queue, Placement::Append, &two, &two).unwrap();
        let again = commit(&mut queue, Placement::Append, &two, &two);
        assert_eq!(again, Err(PlanRefusal::OutOfPlace { begun: 0, end: 4 }));
        assert_eq!(indices(queue), [0, 1, 2, 3]);
    }

    #[test]
    fn only_legs_not_begun_can_be_replaced_or_cancelled() {
        let mut queue = LegQueue::default();
        let batch = [leg(0), leg(1), leg(2)];
        commit(&mut queue, START, &batch, &batch).unwrap();
        assert_eq!(queue.next_leg(), Some(leg(0)));
        let late = commit(&mut queue, Placement::Replace, &batch, &batch);
        assert_eq!(late, Err(PlanRefusal::OutOfPlace { begun: 1, end: 3 }));
        let mut other = leg(2);
        other.goal = Position::new(0.5, 0.5);
        commit(&mut queue, Placement::Replace, &[other], &[other]).unwrap();
        assert_eq!(queue.clone().waiting.back(), Some(&other));
        assert_eq!(indices(queue.clone()), [1, 2]);
        queue.cancel(9);
        assert_eq!(queue.driven(), Some(Driven { plan: 9, next: 0, end: 1 }));
        assert_eq!(indices(queue), []);
    }

    #[test]
    fn legs_that_do_not_join_are_refused() {
        let apart = |index, gap| Err(PlanRefusal::Apart { index, gap });
        let mut far = leg(1);
        far.start = Pose::new(1.0, 0.5, 0.0);
        let batch = [leg(0), far];
        let mut queue = LegQueue::default();
        assert_eq!(commit(&mut queue, START, &batch, &batch), apart(1, 0.5));
        let elsewhere = Placement::Start(Pose::new(0.5, 2.0, 0.0));
        assert_eq!(commit(&mut queue, elsewhere, &[leg(0)], &[leg(0)]), apart(0, 2.0));
        // Resumed in the middle of a leg.
        let within = Placement::Start(Pose::new(0.5, 0.1, 0.0));
        commit(&mut queue, within, &[leg(0)], &[leg(0)]).unwrap();
        assert_eq!(commit(&mut queue, Placement::Append, &[far], &[far]), apart(1, 0.5));
        // The same once the leg before it is under way.
        queue.next_leg();
        assert_eq!(commit(&mut queue, Placement::Append, &[far], &[far]), apart(1, 0.5));
        commit(&mut queue, Placement::Append, &[leg(1)], &[leg(1)]).unwrap();
    }

    #[test]
    fn a_batch_for_which_there_is_no_room_changes_nothing() {
        let mut queue = LegQueue::default();
        let full: Vec<_> = (0..MAX_LEGS as u16).map(leg).collect();
        commit(&mut queue, START, &full, &full).unwrap();
        let more = [leg(MAX_LEGS as u16)];
        let refusal = commit(&mut queue, Placement::Append, &more, &more);
        assert_eq!(refusal, Err(PlanRefusal::TooManyLegs { room: 0 }));
        assert_eq!(indices(queue).len(), MAX_LEGS);
    }
}
