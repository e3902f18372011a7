//! Short looks at horizons: most are decided by them, and where one is not, they find a longer plan
//! before the long search begins, so that whatever interrupts that leaves a plan.

use super::HorizonModel;
use super::search::Search;
use crate::error::Error;
use crate::solver::StopToken;

/// Nodes of a look.
const NODES: u64 = 200;

/// The share of the remaining time that a look may take.
const SHARE: u32 = 8;

/// How many times longer than an open horizon the longest is that is looked at, and how many steps
/// more.
const LONGER: (usize, usize) = (4, 16);

/// The time of a look.
pub(super) fn look_token(token: &StopToken) -> StopToken {
    token.child(token.left().map(|left| left / SHARE))
}

impl<B: HorizonModel + ?Sized> Search<'_, B> {
    /// Decides a horizon by a look. `false` if that is not enough; the horizon is then open for a
    /// full search.
    pub(super) fn look(&mut self, steps: usize) -> Result<bool, Error> {
        let open = self.undecided.len();
        self.attempt(steps, Some(NODES))?;
        let is_decided = self.undecided.len() == open;
        self.undecided.truncate(open);
        Ok(is_decided)
    }

    /// Looks for a plan of more steps than an open horizon has: one more, two, four, ...; and then
    /// in the middle between the open horizon and the plan, as long as that finds a shorter one.
    pub(super) fn look_above(&mut self, open: usize) -> Result<(), Error> {
        let (mut below, mut more) = (open, 1);
        let longest = (LONGER.0 * open + LONGER.1).min(self.options.max_steps);
        while self.best.is_none() && below < longest && !self.token.is_over() {
            let steps = (open + more).min(longest);
            self.look(steps)?;
            if self.best.is_none() {
                (below, more) = (steps, 2 * more);
            }
        }
        while let Some(best) = self.best.as_ref().map(|best| best.steps)
            && best > below + 1
            && !self.token.is_over()
        {
            let middle = below + (best - below) / 2;
            self.look(middle)?;
            if self.best.as_ref().is_some_and(|found| found.steps == best) {
                below = middle;
            }
        }
        // What follows is the search proper.
        self.ascended = self.attempts.len();
        Ok(())
    }
}
