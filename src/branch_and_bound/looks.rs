//! Short searches before the search, which tell whether cuts are wanted.

use std::cell::RefCell;

use crate::search::{Found, Looked, Root, Seed, Start, Task, search};
use crate::solution::{Heuristic, Statistics, Termination};
use crate::solver::{BranchingRule, Control, Heuristics, Options};

/// The looks at a program, and what they leave to its search.
pub(super) struct Looks<'a> {
    task: Task<'a>,
    /// The seed of the search.
    given: Option<&'a Seed>,
    left: RefCell<Left>,
}

/// The results that looks leave to the search.
#[derive(Default)]
struct Left {
    best: Option<Start>,
    /// Whether there was a look that found the search's own root.
    looked: bool,
    /// As in [`Found`].
    is_widened: bool,
    statistics: Statistics,
}

impl<'a> Looks<'a> {
    pub(super) fn new(task: Task<'a>, given: Option<&'a Seed>) -> Self {
        Looks { task, given, left: RefCell::default() }
    }

    /// Searches so many nodes from a root, with rounding and a roll-out there. Returns `None` if that is
    /// not wanted.
    pub(super) fn look(&self, root: &Root, nodes: u64) -> Option<Looked> {
        let Task { program, options, guidance, .. } = self.task;
        let further = nodes > 1;
        if let Some(start) = self.given.and_then(|seed| seed.point.as_ref()) {
            let value = Some(program.objective(&start.values));
            let looked = Looked { value, bound: f64::NEG_INFINITY, is_closed: false };
            return (!further).then_some(looked);
        }
        // What goes beyond the root is the user's to steer and to limit.
        let is_steered = further && !guidance.is_idle();
        let is_limited = options.node_limit.is_some_and(|limit| limit < nodes);
        if !options.heuristics.rounding || is_steered || is_limited {
            return None;
        }
        let roll_out = options.heuristics.roll_out;
        let heuristics = Heuristics { rounding: true, roll_out, ..Heuristics::none() };
        let branching = if further { options.branching } else { BranchingRule::LatestFirst };
        let node_limit = Some(nodes);
        let options = &Options { heuristics, branching, node_limit, ..options.nested() };
        let guidance = &guidance.idle();
        let task = Task { options, guidance, root: Some(root), ..self.task };
        let seed = self.begun(true);
        #[cfg(feature = "tracing")]
        let _span = tracing::debug_span!("look", nodes).entered();
        let found = search(task, &mut Control::default(), seed.as_ref());
        Some(self.take_in(found))
    }

    fn take_in(&self, found: Found) -> Looked {
        let mut left = self.left.borrow_mut();
        left.looked = true;
        left.is_widened |= found.is_widened;
        let is_closed = matches!(found.termination, Termination::Optimal | Termination::Infeasible);
        let mut counts = found.statistics;
        counts.forget_incumbents();
        if is_closed {
            left.statistics.add(&counts);
        } else {
            // The root is the search's own.
            counts.nodes -= counts.nodes.min(1);
            left.statistics.heuristics.add(&counts.heuristics);
            left.statistics.add_nested(&counts);
        }
        let value = found.points.first().map(|values| self.task.program.objective(values));
        if let Some(values) = found.points.into_iter().next() {
            let found_by = found.found_by.unwrap_or(Heuristic::Rounding);
            left.best = Some(Start { values, found_by });
        }
        Looked { value, bound: found.bound, is_closed }
    }

    /// The seed from the looks; `None` if there was no look. `same_root` if the search has the root that was
    /// looked at.
    fn begun(&self, same_root: bool) -> Option<Seed> {
        let Left { best, looked, .. } = &*self.left.borrow();
        let point = best.clone();
        looked.then(|| Seed { point, looked: Some(same_root), ..Seed::default() })
    }

    /// The seed from the looks together with the given one; `None` if the given one is to be used as it is,
    /// or if there is neither. `same_root` as above. A guess is judged without a point to beat.
    pub(super) fn seed(&self, same_root: bool) -> Option<Seed> {
        let own = self.begun(same_root);
        match self.given {
            Some(given) if given.point.is_none() && given.guess.is_empty() => {
                own.map(|own| Seed { point: own.point, looked: own.looked, ..given.clone() })
            }
            Some(_) => None,
            None => own,
        }
    }

    /// Adds what the looks have taken, and noted, to what the search has found.
    pub(super) fn add_to(self, found: &mut Found) {
        let left = self.left.into_inner();
        found.statistics.add(&left.statistics);
        found.is_widened |= left.is_widened;
    }
}
