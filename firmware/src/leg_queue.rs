//! The plan that is being received, and the plan that is being driven.
//!
//! A plan is collected leg by leg beside the one that runs and takes its place only as a whole: the
//! number of legs and their digest must be those announced, and every leg must be drivable.

use heapless::Vec;
use protocol::message::{MAX_LEGS, PlanHeader, PlanRefusal, plan_digest};
use protocol::motion::{Leg, Limits};

type Legs = Vec<Leg, MAX_LEGS>;

/// Legs announced, legs collected, legs to drive.
#[derive(Clone, Debug, Default)]
pub struct LegQueue {
    header: Option<PlanHeader>,
    collected: Legs,
    overflow: bool,
    driven: Legs,
    next: usize,
}

impl LegQueue {
    /// Announces a plan; forgets what was collected before.
    pub fn begin(&mut self, header: PlanHeader) {
        self.header = Some(header);
        self.collected.clear();
        self.overflow = false;
    }

    /// Collects a leg. One of another plan or out of order makes the digest differ at the commit.
    pub fn collect(&mut self, leg: Leg) {
        self.overflow |= self.collected.push(leg).is_err();
    }

    /// Makes the collected plan the one to drive, and returns what was announced of it.
    ///
    /// # Errors
    /// [`PlanRefusal`] if it is not complete, or a leg cannot be driven; the queue is unchanged.
    pub fn commit(&mut self, plan: u32, limits: &Limits) -> Result<PlanHeader, PlanRefusal> {
        let header =
            self.header.filter(|header| header.plan == plan).ok_or(PlanRefusal::Incomplete)?;
        if self.overflow || usize::from(header.count) > MAX_LEGS {
            return Err(PlanRefusal::TooManyLegs);
        }
        if header.count == 0 {
            return Err(PlanRefusal::Empty);
        }
        if !header.start.is_sane() {
            return Err(PlanRefusal::Start);
        }
        self.check_complete(&header)?;
        for leg in &self.collected {
            let index = leg.index;
            leg.check(limits).map_err(|refusal| PlanRefusal::Leg { index, refusal })?;
        }
        self.driven = core::mem::take(&mut self.collected);
        self.next = 0;
        self.header = None;
        Ok(header)
    }

    /// The next leg to drive, once each.
    pub fn next_leg(&mut self) -> Option<Leg> {
        let leg = self.driven.get(self.next).copied()?;
        self.next += 1;
        Some(leg)
    }

    /// Forgets the plan that is driven.
    pub fn clear(&mut self) {
        self.driven.clear();
        self.next = 0;
    }

    fn check_complete(&self, header: &PlanHeader) -> Result<(), PlanRefusal> {
        let in_order = self
            .collected
            .iter()
            .enumerate()
            .all(|(index, leg)| leg.plan == header.plan && usize::from(leg.index) == index);
        let complete = self.collected.len() == usize::from(header.count)
            && plan_digest(&self.collected) == header.digest;
        if in_order && complete { Ok(()) } else { Err(PlanRefusal::Incomplete) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parameters::Parameters;
    use protocol::motion::{Direction, Pose, Position, Refusal, Timing};

    fn leg(index: u16) -> Leg {
        Leg {
            plan: 9,
            index,
            start: Pose::default(),
            goal: Position::new(1.0, 0.0),
            goal_heading: None,
            direction: Direction::Forward,
            timing: Timing::Limits,
        }
    }

    fn collect(legs: &[Leg], announced: &[Leg]) -> Result<PlanHeader, PlanRefusal> {
        let mut queue = LegQueue::default();
        let (count, digest) = (announced.len() as u16, plan_digest(announced));
        queue.begin(PlanHeader { plan: 9, count, digest, start: Pose::default() });
        legs.iter().for_each(|leg| queue.collect(*leg));
        queue.commit(9, &Parameters::default().limits())
    }

    #[test]
    fn only_the_announced_legs_in_their_order_are_a_plan() {
        let two = [leg(0), leg(1)];
        assert!(collect(&two, &two).is_ok());
        assert_eq!(collect(&two[..1], &two), Err(PlanRefusal::Incomplete));
        assert_eq!(collect(&[leg(1), leg(0)], &two), Err(PlanRefusal::Incomplete));
        let mut other = two;
        other[1].goal = Position::new(1.0, 0.1);
        assert_eq!(collect(&other, &two), Err(PlanRefusal::Incomplete));
        assert_eq!(collect(&[], &[]), Err(PlanRefusal::Empty));
    }

    #[test]
    fn a_leg_that_cannot_be_driven_is_named() {
        let mut bad = leg(1);
        bad.goal = Position::new(f32::INFINITY, 0.0);
        let refusal = collect(&[leg(0), bad], &[leg(0), bad]);
        assert_eq!(refusal, Err(PlanRefusal::Leg { index: 1, refusal: Refusal::NotSane }));
    }
}
