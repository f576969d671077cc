//! What the robot has to say and could not yet hand over: answers, ends of legs in their order, and the
//! end of the plan behind them.

use heapless::Deque;
use protocol::message::{LegResult, MAX_LEGS, Report};

/// Answers that wait for room in the session; no command is taken while they are this many.
const ANSWERS: usize = 4;

/// Reports that wait for room in the owner's session.
#[derive(Clone, Debug, Default)]
pub(crate) struct Outbox {
    answers: Deque<Report, ANSWERS>,
    results: Deque<LegResult, { MAX_LEGS + 1 }>,
    plan_end: Option<Report>,
}

impl Outbox {
    /// Whether what a command may give rise to finds no room.
    pub(crate) fn is_full(&self) -> bool {
        self.answers.is_full() || self.plan_end.is_some()
    }

    /// For how many more legs there would be room to report their ends.
    pub(crate) fn room_for_legs(&self) -> usize {
        MAX_LEGS.saturating_sub(self.results.len())
    }

    /// An answer, which is dropped where there is no room for it.
    pub(crate) fn answer(&mut self, report: Report) {
        let _ = self.answers.push_back(report);
    }

    /// The end of a leg; a plan never has more legs than [`room_for_legs`](Self::room_for_legs) said.
    pub(crate) fn leg_done(&mut self, result: LegResult) {
        let _ = self.results.push_back(result);
    }

    /// The end of the plan.
    pub(crate) fn plan_ended(&mut self, report: Report) {
        self.plan_end = Some(report);
    }

    /// What is to be said next.
    pub(crate) fn next(&self) -> Option<Report> {
        let result = || self.results.front().map(|result| Report::LegDone(*result));
        self.answers.front().copied().or_else(result).or(self.plan_end)
    }

    /// Forgets what [`next`](Self::next) gave.
    pub(crate) fn advance(&mut self) {
        if self.answers.pop_front().is_none() && self.results.pop_front().is_none() {
            self.plan_end = None;
        }
    }
}
