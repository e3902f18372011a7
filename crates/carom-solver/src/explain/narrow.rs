//! From families to steps: which part of a family still contradicts the rest.
//!
//! For each family we keep a range of steps that is known to suffice, and narrow it at both ends.
//! A known point that satisfies everything else violates some steps of the range, and one of those
//! must stay. If such points agree on a few steps, these are tried alone and then with their
//! neighbours. Otherwise the ends are found by bisection.

use super::groups::Groups;
use super::oracle::{Feasibility, Oracle};
use crate::error::Error;

/// The range of one family's members that is kept, and what is known about its ends.
struct StepSpan<'a> {
    members: &'a [usize],
    /// First and last member that is kept; they suffice to contradict the rest.
    first: usize,
    last: usize,
    /// The first one cannot be later than this, the last one not earlier.
    from: usize,
    to: usize,
    /// By how many members the next guess is wider than what the points require.
    wider: usize,
    stuck: bool,
}

impl<'a> StepSpan<'a> {
    fn new(members: &'a [usize]) -> Self {
        let last = members.len() - 1;
        StepSpan { members, first: 0, last, from: last, to: 0, wider: 0, stuck: false }
    }

    fn kept(&self) -> &'a [usize] {
        &self.members[self.first..=self.last]
    }

    /// Takes from the points that satisfy everything else which members the ends must keep.
    fn read(&mut self, oracle: &Oracle<'_>, others: &[bool]) {
        (self.from, self.to) = (self.last, self.first);
        for known in oracle.known.iter().filter(|known| known.satisfies(others)) {
            let violated = |k: &usize| known.violated.iter().any(|v| v.0 == self.members[*k]);
            let mut inside = (self.first..=self.last).filter(violated);
            if let Some(earliest) = inside.next() {
                self.from = self.from.min(inside.next_back().unwrap_or(earliest));
                self.to = self.to.max(earliest);
            }
        }
    }

    fn is_done(&self) -> bool {
        self.stuck || (self.first == self.from && self.last == self.to)
    }

    /// Whether the points leave only a few members to begin with.
    fn is_pointed(&self) -> bool {
        self.from <= self.to && self.to - self.from < (self.last - self.first) / 2
    }

    /// The range to try next.
    fn next(&self) -> (usize, usize) {
        let guess = (
            self.from.saturating_sub(self.wider).max(self.first),
            (self.to + self.wider).min(self.last),
        );
        if self.is_pointed() && guess != (self.first, self.last) {
            return guess;
        }
        let (before, after) = (self.from - self.first, self.last - self.to);
        match before >= after {
            true => (self.first + before.div_ceil(2), self.last),
            false => (self.first, self.last - after.div_ceil(2)),
        }
    }
}

/// Narrows the kept families until `solves` solves were made; returns the remaining members of
/// each.
pub(super) fn narrow(
    groups: &Groups,
    kept: &[usize],
    solves: usize,
    oracle: &mut Oracle<'_>,
) -> Result<Vec<Vec<usize>>, Error> {
    let families = kept.iter().map(|&place| &groups.families[place].members[..]);
    let mut spans: Vec<StepSpan<'_>> = families.map(StepSpan::new).collect();
    let mask = |spans: &[StepSpan<'_>], but: usize, range: (usize, usize)| {
        groups.mask(spans.iter().enumerate().filter_map(|(k, span)| match (k == but, range) {
            (false, _) => Some(span.kept()),
            (true, (first, last)) => span.members.get(first..=last),
        }))
    };
    while oracle.solves < solves && !oracle.is_exhausted() {
        for k in 0..spans.len() {
            // An empty range: all the others, and nothing of this one.
            let others = mask(&spans, k, (1, 0));
            spans[k].read(oracle, &others);
        }
        let open = (0..spans.len()).filter(|&k| !spans[k].is_done());
        let gap = |span: &StepSpan<'_>| (span.from - span.first).max(span.last - span.to);
        // First spans that points narrow down well, then those with the most to gain.
        let Some(k) = open.max_by_key(|&k| (spans[k].is_pointed(), gap(&spans[k]))) else { break };
        let range = spans[k].next();
        match oracle.ask(&mask(&spans, k, range))? {
            Feasibility::Infeasible => (spans[k].first, spans[k].last) = range,
            Feasibility::Feasible(_) => {
                spans[k].wider = (2 * spans[k].wider).max(1);
                // A point within the tolerances of what was refuted teaches nothing.
                let others = mask(&spans, k, (1, 0));
                spans[k].read(oracle, &others);
                spans[k].stuck = spans[k].next() == range;
            }
            Feasibility::Open => spans[k].stuck = true,
        }
    }
    Ok(spans.iter().map(|span| span.kept().to_vec()).collect())
}
