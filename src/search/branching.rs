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

/// Gains below this count as this much (objective's unit), so that products stay comparable.
pub(super) const LEAST_GAIN: f64 = 1e-9;

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

/// Average growth of the bound per unit of fraction, downwards and upwards, by column.
#[derive(Debug, Clone)]
pub(super) struct Pseudocosts {
    sum: Vec<[f64; 2]>,
    count: Vec<[u32; 2]>,
    /// Over all columns, by direction.
    total: [(f64, u32); 2],
    /// What was learned and not yet told to others, where there are any.
    fresh: Option<Vec<Lesson>>,
}

/// What one child taught about a column.
#[derive(Debug, Clone, Copy)]
struct Lesson {
    column: usize,
    side: usize,
    gain: f64,
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

impl Child {
    fn tried(decision: Decision, trial: Trial, bound: f64) -> Self {
        Child { decisions: vec![decision], bound: trial.bound.max(bound), known: trial.known }
    }
}

impl Pseudocosts {
    pub(super) fn new(columns: usize) -> Self {
        Pseudocosts {
            sum: vec![[0.0; 2]; columns],
            count: vec![[0; 2]; columns],
            total: [(0.0, 0); 2],
            fresh: None,
        }
    }

    /// Learns from a child: `gain` of the bound after moving a column by `fraction`.
    pub(super) fn learn(&mut self, column: usize, up: bool, gain: f64, fraction: f64) {
        if gain.is_finite() && fraction > 1e-6 {
            let lesson = Lesson { column, side: usize::from(up), gain: gain.max(0.0) / fraction };
            self.take_in(lesson);
            self.fresh.iter_mut().for_each(|fresh| fresh.push(lesson));
        }
    }

    fn take_in(&mut self, Lesson { column, side, gain }: Lesson) {
        self.sum[column][side] += gain;
        self.count[column][side] += 1;
        self.total[side].0 += gain;
        self.total[side].1 += 1;
    }

    /// Keeps what is learned from here on, to tell it.
    pub(super) fn record(&mut self) {
        self.fresh = Some(Vec::new());
    }

    /// Tells what was learned since the last time.
    pub(super) fn tell(&mut self, shared: &mut Pseudocosts) {
        self.fresh.iter_mut().for_each(|fresh| fresh.drain(..).for_each(|l| shared.take_in(l)));
    }

    /// Knows from here on what all together learned.
    pub(super) fn learn_all(&mut self, shared: &Pseudocosts) {
        self.sum.copy_from_slice(&shared.sum);
        self.count.copy_from_slice(&shared.count);
        self.total = shared.total;
    }

    fn known(&self, column: usize) -> bool {
        self.count[column].iter().all(|&c| c > 0)
    }

    pub(super) fn known_up(&self, column: usize) -> bool {
        self.count[column][1] > 0
    }

    /// Expected gain of raising a column by `fraction`, if anything is known.
    pub(super) fn gain_up(&self, column: usize, fraction: f64) -> Option<f64> {
        let count = self.count[column][1];
        (count > 0).then(|| self.sum[column][1] / f64::from(count) * fraction)
    }

    /// Expected gains of lowering and of raising a column to the next whole value; those of
    /// columns that nothing is known about are the average ones.
    pub(super) fn gains(&self, column: usize, value: f64) -> [f64; 2] {
        let expected = |side: usize, fraction: f64| {
            let (sum, count) = match self.count[column][side] {
                0 => self.total[side],
                count => (self.sum[column][side], count),
            };
            (sum / f64::from(count.max(1)) * fraction).max(LEAST_GAIN)
        };
        let fraction = value - value.floor();
        [expected(0, fraction), expected(1, 1.0 - fraction)]
    }

    /// Product of the expected gains of both children.
    fn score(&self, column: usize, value: f64) -> f64 {
        let [down, up] = self.gains(column, value);
        down * up
    }
}

impl Worker<'_> {
    /// Chooses a split of the current node with relaxed point `x` and bound `bound`.
    pub(super) fn choose_split(&mut self, x: &[f64], bound: f64) -> Split {
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
        // By the expected gain, the most promising first; those that little is known about are tried.
        let mut ranked: Vec<(f64, usize)> =
            open.iter().map(|&j| (self.pseudocosts.score(j, x[j]), j)).collect();
        ranked.sort_by(|a, b| {
            let fractional = || distance(b.1).total_cmp(&distance(a.1));
            b.0.total_cmp(&a.0).then_with(fractional).then(a.1.cmp(&b.1))
        });
        let most = if disjunction.is_some() { BESIDE } else { TRIALS };
        let (mut trials, mut idle, mut fixed) = (most, 0, false);
        let mut best: (f64, usize, Option<[Trial; 2]>) = (f64::NEG_INFINITY, latest, None);
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
                let half = disjunction.is_some() && self.pseudocosts.known_up(j);
                if half && near.is_upper {
                    (near, far) = (far, near);
                }
                let Some(b) = self.try_child(far, x[j], bound) else {
                    if self.task.options.keep_leaves {
                        return Split::only(near, bound);
                    }
                    if let Err(split) = self.note_facts(&[near]) {
                        return split;
                    }
                    (fixed, idle) = (true, 0);
                    continue;
                };
                if half {
                    score = self.pseudocosts.score(j, x[j]);
                    idle = if score > best.0 { 0 } else { idle + 1 };
                    if score > best.0 {
                        best = (score, j, None);
                    }
                    continue;
                }
                let Some(a) = self.try_child(near, x[j], bound) else {
                    return Split { children: vec![Child::tried(far, b, bound)], closed: true };
                };
                score = a.gain.max(LEAST_GAIN) * b.gain.max(LEAST_GAIN);
                if let Err(split) = self.note_facts(&common(&a, &b)) {
                    return split;
                }
                tried = Some([a, b]);
                idle = if score > best.0 { 0 } else { idle + 1 };
            }
            if score > best.0 && !self.domain.is_fixed(j) {
                best = (score, j, tried);
            }
        }
        let (_, j, tried) = best;
        if fixed && (tried.is_none() || self.domain.is_fixed(j)) {
            // The same node with tighter bounds.
            return Split::again(bound);
        }
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

    /// Splits at the value of the relaxation: `x <= floor` or `x >= floor + 1`, nearer side first.
    fn split(&self, column: usize, value: f64) -> [Decision; 2] {
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
