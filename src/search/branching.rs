//! Which column to split, and which child to visit first.
//!
//! * A rule of the user's is asked first, and columns of a higher priority go before others.
//! * Without an objective nothing but infeasibility matters, and under big-M rows fractionality
//!   says little about it. Windows of events are halved where the program has a horizon; else
//!   columns are split latest first (by the step of their name, else by position): a late decision
//!   propagates backwards through the dynamics. Measured on a wall program, latest-first closed the
//!   tree in 71 nodes where earliest-first ran out of time.
//! * With an objective, columns are split by pseudocosts: the average growth of the bound per
//!   unit of fraction, initialised by trying both children of a column (strong branching). A child
//!   that the trial refutes is never queued. Disjunctions are split into their sides where the tree
//!   is expected to grow more slowly that way.

use super::node::{Decision, Known};
use super::pseudocosts::LEAST_GAIN;
use super::trial::{Trial, common};
use super::worker::Worker;
use crate::solver::BranchingRule;

/// Trials of new columns per node.
pub(super) const TRIALS: usize = 8;

/// The same where a disjunction could be split instead, whose sides have had theirs.
const BESIDE: usize = 2;

/// Trials in a row that may find no better column before the rest is taken at its pseudocosts.
const PATIENCE: usize = 4;

/// Halvings of the interval of a rate of growth: five digits, of rates from 1 to 1e9.
const HALVINGS: usize = 22;

/// At which rate a tree grows whose nodes all split with these gains of their children: it has
/// `exp(rate * gap)` nodes, where `sum of exp(-rate * gain) = 1` (Le Bodic and Nemhauser 2017).
pub(super) fn growth_rate(gains: &[f64]) -> f64 {
    let (least, most) =
        gains.iter().fold((f64::INFINITY, 0.0_f64), |(l, m), &g| (l.min(g), m.max(g)));
    let all = (gains.len() as f64).ln();
    let (mut low, mut high) = ((all / most).ln(), (all / least).ln());
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        let rate = middle.exp();
        let sum: f64 = gains.iter().map(|gain| (-rate * gain).exp()).sum();
        if sum > 1.0 { low = middle } else { high = middle }
    }
    (0.5 * (low + high)).exp()
}

/// A child of a split: what it decides, and what a trial has found out about it.
pub(super) struct Child {
    pub(super) decisions: Vec<Decision>,
    /// Proved bound.
    pub(super) bound: f64,
    pub(super) known: Option<Box<Known>>,
}

/// How a node is split.
pub(super) struct Split {
    /// The child to visit first is in front. No child: all of the node is closed.
    pub(super) children: Vec<Child>,
    /// Whether anything that no child has is refuted or beyond the cutoff.
    pub(super) closed: bool,
}

impl Split {
    /// No child: all of the node is refuted or beyond the cutoff.
    pub(super) fn nothing() -> Self {
        Split { children: Vec::new(), closed: true }
    }

    fn both(decisions: [Decision; 2], bound: f64) -> Self {
        let child = |d| Child { decisions: vec![d], bound, known: None };
        Split { children: decisions.map(child).into(), closed: false }
    }

    /// Both sides of a value of a column, the one of the relaxed value in front.
    pub(super) fn at(column: usize, value: f64, relaxed: f64, bound: f64) -> Self {
        let down = Decision { column, is_upper: true, value };
        let up = Decision { column, is_upper: false, value: value + 1.0 };
        Split::both(if relaxed - value > 0.5 { [up, down] } else { [down, up] }, bound)
    }

    /// One child; the other side is closed.
    fn only(decision: Decision, bound: f64) -> Self {
        Split {
            children: vec![Child { decisions: vec![decision], bound, known: None }],
            closed: true,
        }
    }

    /// The same node, with what is now known of its bounds.
    fn again(bound: f64) -> Self {
        Split { children: vec![Child { decisions: Vec::new(), bound, known: None }], closed: true }
    }
}

/// The column that a node is split at.
struct Chosen {
    /// The column, and its children where they were tried; nothing where all columns are fixed by now.
    column: Option<(usize, Option<[Trial; 2]>)>,
    /// Whether trials have closed sides of columns.
    fixed: bool,
}

impl Child {
    fn tried(decision: Decision, trial: Trial, bound: f64) -> Self {
        Child { decisions: vec![decision], bound: trial.bound.max(bound), known: trial.known }
    }
}

impl Worker<'_> {
    /// Chooses a split of the current node with bound `bound` and relaxed point `x`, which was `raw`
    /// before binaries that had a choice were settled.
    pub(super) fn choose_split(&mut self, x: &[f64], raw: &[f64], bound: f64) -> Split {
        let integrality = self.task.options.integrality;
        let program = self.program();
        let distance = |j: usize| (x[j] - x[j].round()).abs();
        let mut open: Vec<usize> =
            program.integers.iter().copied().filter(|&j| !self.domain.is_fixed(j)).collect();
        if open.iter().any(|&j| distance(j) > integrality) {
            open.retain(|&j| distance(j) > integrality);
        }
        if open.is_empty() {
            return Split::again(bound);
        }
        if let Some(split) = self.split_of_user(x, bound) {
            return split;
        }
        let guide = self.task.guide;
        if guide.has_priorities() {
            let first = open.iter().map(|&j| guide.priority(j)).max().unwrap_or(0);
            open.retain(|&j| guide.priority(j) == first);
        }
        let late = |j: &usize| (program.step[*j].unwrap_or(*j), std::cmp::Reverse(*j));
        let Some(&latest) = open.iter().max_by_key(|j| late(j)) else {
            return Split::again(bound);
        };
        if !guide.has_priorities()
            && let Some(split) = self.split_window(x, bound)
        {
            return split;
        }
        let late_first = match self.task.options.branching {
            BranchingRule::LatestFirst => true,
            BranchingRule::Pseudocosts => false,
            _ => program.is_feasibility_problem(),
        };
        if late_first || bound == f64::NEG_INFINITY {
            return Split::both(self.split(latest, x[latest]), bound);
        }
        let disjunction = match guide.has_priorities() {
            true => None,
            false => self.split_disjunction(x, bound),
        };
        if let Some((split, _)) = disjunction.as_ref()
            && split.closed
        {
            return disjunction.map_or_else(Split::nothing, |(split, _)| split);
        }
        let chosen = match self.choose_column(x, bound, &open, disjunction.is_some()) {
            Ok(chosen) => chosen,
            Err(split) => return split,
        };
        let excluded = match self.exclude_values(x, raw, bound) {
            Ok(excluded) => excluded,
            Err(split) => return split,
        };
        let fixed = chosen.fixed || excluded;
        let stands = |(j, tried): &(usize, Option<_>)| {
            !self.domain.is_fixed(*j) && (tried.is_some() || !fixed)
        };
        let Some((j, tried)) = chosen.column.filter(stands) else {
            // The same node with tighter bounds.
            return Split::again(bound);
        };
        let gains = match &tried {
            Some(trials) => trials.each_ref().map(|trial| trial.gain.max(LEAST_GAIN)),
            None => self.pseudocosts.gains(j, x[j]),
        };
        if let Some((split, rate)) = disjunction
            && !fixed
            && rate <= growth_rate(&gains)
        {
            return split;
        }
        let decisions = self.split(j, x[j]);
        match tried {
            None => Split::both(decisions, bound),
            Some(trials) => {
                let child = |(d, trial)| Child::tried(d, trial, bound);
                let children = decisions.into_iter().zip(trials).map(child).collect();
                Split { children, closed: fixed }
            }
        }
    }

    /// The best of some open columns, the most promising first; those that little is known about are
    /// tried. A split, where a trial leaves nothing or one child.
    fn choose_column(
        &mut self,
        x: &[f64],
        bound: f64,
        open: &[usize],
        beside: bool,
    ) -> Result<Chosen, Split> {
        let mut ranked: Vec<(f64, usize)> =
            open.iter().map(|&j| (self.pseudocosts.score(j, x[j]), j)).collect();
        ranked.sort_by(|a, b| {
            let distance = |j: usize| (x[j] - x[j].round()).abs();
            let fractional = || distance(b.1).total_cmp(&distance(a.1));
            b.0.total_cmp(&a.0).then_with(fractional).then(a.1.cmp(&b.1))
        });
        let (mut trials, mut idle) = (if beside { BESIDE } else { TRIALS }, 0);
        let (mut most, mut best) = (f64::NEG_INFINITY, Chosen { column: None, fixed: false });
        for (expected, j) in ranked {
            if self.domain.is_fixed(j) {
                continue;
            }
            let (mut score, mut tried) = (expected, None);
            if trials > 0 && idle < PATIENCE && !self.pseudocosts.known(j) {
                trials -= 1;
                // The far child is the likelier one to be closed; then its sibling is the node
                // itself with a tighter bound, which may wait for more of them.
                let [mut near, mut far] = self.split(j, x[j]);
                // The rise of a side was tried with its disjunction.
                let half = beside && self.pseudocosts.known_up(j);
                if half && near.is_upper {
                    (near, far) = (far, near);
                }
                let Some(b) = self.try_child(far, x[j], bound) else {
                    self.keep_only(near, bound)?;
                    (best.fixed, idle) = (true, 0);
                    continue;
                };
                if half {
                    score = self.pseudocosts.score(j, x[j]);
                } else {
                    let Some(a) = self.try_child(near, x[j], bound) else {
                        let children = vec![Child::tried(far, b, bound)];
                        return Err(Split { children, closed: true });
                    };
                    score = a.gain.max(LEAST_GAIN) * b.gain.max(LEAST_GAIN);
                    self.note_facts(&common(&a, &b))?;
                    tried = Some([a, b]);
                }
                idle = if score > most { 0 } else { idle + 1 };
            }
            if score > most && !self.domain.is_fixed(j) {
                (most, best.column) = (score, Some((j, tried)));
            }
        }
        Ok(best)
    }

    /// Goes on with one side of a column, the other one being closed. Where the ends of the tree are
    /// kept, that is a split.
    pub(super) fn keep_only(&mut self, side: Decision, bound: f64) -> Result<(), Split> {
        if self.task.options.keep_leaves {
            return Err(Split::only(side, bound));
        }
        self.note_facts(&[side])
    }

    /// Splits at the value of the relaxation: `x <= floor` or `x >= floor + 1`, nearer side first.
    pub(super) fn split(&self, column: usize, value: f64) -> [Decision; 2] {
        let (lower, upper) = (self.domain.lower(column), self.domain.upper(column));
        let value =
            if value.is_finite() { value.clamp(lower, upper) } else { lower.max(upper.min(0.0)) };
        // Integral values are split so that both sides are smaller than the whole.
        let below = value.floor().clamp(lower, (upper - 1.0).max(lower));
        let down = Decision { column, is_upper: true, value: below };
        let up = Decision { column, is_upper: false, value: below + 1.0 };
        if value - below > 0.5 { [up, down] } else { [down, up] }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rates_of_growth() {
        let close = |gains: &[f64], rate: f64| {
            let found = growth_rate(gains);
            assert!((found - rate).abs() <= 1e-4 * rate, "{gains:?}: {found}");
        };
        close(&[1.0, 1.0], 2.0_f64.ln());
        close(&[0.5, 0.5, 0.5], 2.0 * 3.0_f64.ln());
        // The golden ratio.
        close(&[1.0, 2.0], ((1.0 + 5.0_f64.sqrt()) / 2.0).ln());
        // A child that gains nothing is worse than a third one that gains something.
        assert!(growth_rate(&[1.0, 1e-9]) > growth_rate(&[1.0, 1.0, 1.0]));
    }
}
