//! A local search for a point of a program of binaries, without any relaxation. There is no
//! objective, or one of few columns, which stay where they cost least: then a point is an optimum.
//!
//! Binaries are flipped one at a time, those first whose flip lessens the weighted violation of the
//! rows most. Where no flip does, the rows that are violated become heavier (Luteberget and Sartor
//! 2022, "Feasibility Jump"). Many timetables and assignments have a point that is found so long
//! before their first relaxation is solved.

use crate::program::Program;
use crate::search::context::Context;
use crate::search::leaf::try_assignment;
use crate::tolerance;

/// Fewest binaries for which the search is worth its while: relaxations of fewer are quick.
const FEWEST_BINARIES: usize = 200;

/// One in so many binaries may have a cost.
const BINARIES_PER_COST: usize = 10;

/// Entries of the matrix that are visited at most; each takes about ten nanoseconds.
const MOST_ENTRY_VISITS: usize = 30_000_000;

/// Flips that are compared where many lessen the violation.
const COMPARED_FLIPS: usize = 25;

/// The least change of the weighted violation that counts.
const LEAST_SCORE: f64 = 1e-9;

/// Flips between two looks at the clock.
const FLIPS_PER_LOOK: usize = 256;

/// Whether a program is one of binaries alone, has few costs or none, and is not small.
pub(in crate::search) fn suits(program: &Program) -> bool {
    let is_binary = |j: usize| program.integral[j] && program.upper[j] - program.lower[j] <= 1.0;
    let costs = program.linear.iter().filter(|cost| **cost != 0.0).count();
    program.quadratic.compute_nnz() == 0
        && program.cones.is_empty()
        && program.column_count() >= FEWEST_BINARIES
        && BINARIES_PER_COST * costs <= program.column_count()
        && (0..program.column_count()).all(is_binary)
}

/// Looks for a point, and offers it. Returns whether one was accepted.
pub(super) fn jump_to_feasibility(ctx: &mut Context<'_>) -> bool {
    let program = ctx.program();
    let bounds: Vec<[f64; 2]> =
        (0..program.column_count()).map(|j| ctx.node.domain.bounds(j)).collect();
    let mut search = LocalSearch::new(program, &bounds);
    for flips in 1.. {
        if search.violated.members.is_empty() {
            return try_assignment(ctx, &search.x);
        }
        let is_over = flips % FLIPS_PER_LOOK == 0 && ctx.token.is_over();
        if is_over || search.visits > MOST_ENTRY_VISITS {
            break;
        }
        let Some(j) = search.choose() else { break };
        search.flip(j);
    }
    false
}

/// MemberSet of a range of numbers, in no order.
#[derive(Debug, Default)]
struct MemberSet {
    members: Vec<usize>,
    /// By number, its place among the members; `usize::MAX` for none.
    place: Vec<usize>,
}

impl MemberSet {
    fn of_none(count: usize) -> Self {
        MemberSet { members: Vec::new(), place: vec![usize::MAX; count] }
    }

    fn set(&mut self, k: usize, is_member: bool) {
        let at = self.place[k];
        if is_member && at == usize::MAX {
            self.place[k] = self.members.len();
            self.members.push(k);
        } else if !is_member && at != usize::MAX {
            self.members.swap_remove(at);
            if let Some(&moved) = self.members.get(at) {
                self.place[moved] = at;
            }
            self.place[k] = usize::MAX;
        }
    }
}

struct LocalSearch<'a> {
    program: &'a Program,
    x: Vec<f64>,
    /// By column, what a flip adds to it; 0 for fixed ones.
    step: Vec<f64>,
    activity: Vec<f64>,
    weight: Vec<f64>,
    violated: MemberSet,
    /// By column, by how much its flip lessens the weighted violation.
    score: Vec<f64>,
    /// The columns whose flip lessens it.
    good: MemberSet,
    /// The state of the random numbers.
    random: u64,
    visits: usize,
}

impl<'a> LocalSearch<'a> {
    fn new(program: &'a Program, bounds: &[[f64; 2]]) -> Self {
        let (m, n) = (program.row_count(), program.column_count());
        let begin = |([lower, upper], cost): (&[f64; 2], &f64)| match *cost {
            0.0 => (*lower, upper - lower),
            cost => (if cost > 0.0 { *lower } else { *upper }, 0.0),
        };
        let (x, step): (Vec<f64>, Vec<f64>) = bounds.iter().zip(&program.linear).map(begin).unzip();
        let mut search = LocalSearch {
            program,
            step,
            x,
            activity: vec![0.0; m],
            weight: vec![1.0; m],
            violated: MemberSet::of_none(m),
            score: vec![0.0; n],
            good: MemberSet::of_none(n),
            random: 0x9e37_79b9_7f4a_7c15,
            visits: 0,
        };
        for i in 0..m {
            let (columns, values) = program.row(i);
            let terms = columns.iter().zip(values).map(|(&j, a)| a * search.x[j]);
            search.activity[i] = terms.sum();
            search.violated.set(i, search.violation(i, search.activity[i]) > 0.0);
            search.add_scores(i, 1.0);
        }
        search
    }

    /// By how much an activity misses the limits of a row, beyond the tolerance.
    fn violation(&self, row: usize, activity: f64) -> f64 {
        let (lower, upper) = (self.program.row_lower[row], self.program.row_upper[row]);
        let miss = (lower - activity).max(activity - upper);
        if miss > tolerance::FEASIBILITY { miss } else { 0.0 }
    }

    /// Adds what a row says about flips, times a factor, to the scores.
    fn add_scores(&mut self, row: usize, factor: f64) {
        let (columns, values) = self.program.row(row);
        let activity = self.activity[row];
        let before = self.violation(row, activity);
        for (&k, &b) in columns.iter().zip(values) {
            if self.step[k] != 0.0 {
                let after = self.violation(row, activity + self.step[k] * b);
                self.score[k] += factor * (before - after);
                self.good.set(k, self.score[k] > LEAST_SCORE);
            }
        }
        self.visits += columns.len();
    }

    /// The next column to flip; `None` if a violated row has none.
    fn choose(&mut self) -> Option<usize> {
        let mut best = None;
        let mut most = f64::NEG_INFINITY;
        let count = self.good.members.len();
        for k in 0..count.min(COMPARED_FLIPS) {
            let k = if count > COMPARED_FLIPS { self.random_below(count) } else { k };
            let j = self.good.members[k];
            if self.score[j] > most {
                (most, best) = (self.score[j], Some(j));
            }
        }
        if best.is_some() {
            return best;
        }
        for k in 0..self.violated.members.len() {
            let row = self.violated.members[k];
            self.weight[row] += 1.0;
            self.add_scores(row, 1.0);
        }
        let k = self.random_below(self.violated.members.len());
        let row = self.violated.members[k];
        let columns = self.program.row(row).0;
        let open = columns.iter().copied().filter(|&j| self.step[j] != 0.0);
        open.max_by(|&a, &b| self.score[a].total_cmp(&self.score[b]))
    }

    /// A random number below another one (SplitMix64).
    fn random_below(&mut self, count: usize) -> usize {
        self.random = self.random.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.random;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) % count as u64) as usize
    }

    fn flip(&mut self, j: usize) {
        let (rows, values) = self.program.column(j);
        let step = self.step[j];
        for &row in rows {
            self.add_scores(row, -self.weight[row]);
        }
        self.x[j] += step;
        self.step[j] = -step;
        for (&row, &a) in rows.iter().zip(values) {
            self.activity[row] += step * a;
            self.violated.set(row, self.violation(row, self.activity[row]) > 0.0);
            self.add_scores(row, self.weight[row]);
        }
    }
}
