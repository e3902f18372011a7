//! A local search for a point of linear rows, without any relaxation.
//!
//! Columns jump one at a time to the value at which their rows are violated least, those first
//! whose jump lessens the weighted violation most. Where no jump does, the rows that are violated
//! become heavier (Luteberget and Sartor 2022, "Feasibility Jump"). Costs are not looked at. Once
//! the rows over integers alone hold, the integers are fixed and the rest is solved for.
//!
//! Many timetables and assignments have a point that is found so long before their first relaxation
//! is solved. Where there is no objective, or one of few columns, which then stay where they cost
//! least, it is an optimum. Where time presses, it is a point in case that no other is found. After
//! a relaxation, the search begins with its rounded point, and mends what rounding has violated.

use super::jump_value::Kinks;
use crate::program::Program;
use crate::random::SplitMix;
use crate::search::context::Context;
use crate::search::leaf::{offer_point, try_assignment};
use crate::tolerance;

/// Fewest binaries for which the search is worth its while: relaxations of fewer are quick.
const FEWEST_BINARIES: usize = 200;

/// One in so many binaries may have a cost.
const BINARIES_PER_COST: usize = 10;

/// Entries of the matrix that are visited at most, which takes some tenths of a second: for a point
/// that may be the answer, and for others.
const MOST_ENTRY_VISITS: [usize; 2] = [30_000_000, 80_000_000];

/// Entries that are visited at most for other points since the fewest rows were violated, by entry
/// of the matrix.
const IDLE_VISITS_PER_ENTRY: usize = 200;

/// Fewest columns of a program whose rounded point is mended: nodes of smaller ones are quick.
const FEWEST_MENDED_COLUMNS: usize = 1000;

/// Entries that are visited at most to mend a rounded point, by entry of the matrix.
const MENDING_VISITS_PER_ENTRY: usize = 200;

/// A search that has less time by entry of the matrix may not come to its first relaxed point (s).
const PRESSING_SECONDS: f64 = 1e-4;

/// Jumps that are compared where many lessen the violation.
const COMPARED_JUMPS: usize = 25;

/// The least change of the weighted violation that counts.
const LEAST_SCORE: f64 = 1e-9;

/// Jumps between two looks at the clock.
const JUMPS_PER_LOOK: usize = 256;

/// How often the continuous columns are solved for while their rows are violated, each time after
/// twice as many jumps.
const MOST_COMPLETIONS: u32 = 4;

/// Whether the first point that is found is likely to be an answer: a program is one of binaries
/// alone, has few costs or none, and is not small.
pub(in crate::search) fn suits(program: &Program) -> bool {
    let is_binary = |j: usize| program.integral[j] && program.upper[j] - program.lower[j] <= 1.0;
    let costs = program.linear.iter().filter(|cost| **cost != 0.0).count();
    program.quadratic.compute_nnz() == 0
        && program.cones.is_empty()
        && program.column_count() >= FEWEST_BINARIES
        && BINARIES_PER_COST * costs <= program.column_count()
        && (0..program.column_count()).all(is_binary)
}

/// Looks for a point if it may be the answer, or if time presses, and offers it. Returns whether
/// one was accepted.
pub(super) fn jump_to_feasibility(ctx: &mut Context<'_>) -> bool {
    let program = ctx.program();
    let is_answer = suits(program);
    let entries: usize = (0..program.row_count()).map(|row| program.row(row).0.len()).sum();
    let pressing = PRESSING_SECONDS * entries as f64;
    let presses = || ctx.token.left().is_some_and(|left| left.as_secs_f64() < pressing);
    if !program.cones.is_empty() || !(is_answer || presses()) {
        return false;
    }
    let [for_answers, for_others] = MOST_ENTRY_VISITS;
    let (most, idle) = match is_answer {
        true => (for_answers, for_answers),
        false => (for_others, IDLE_VISITS_PER_ENTRY * entries),
    };
    let bounds = bounds_of(ctx);
    let begin = |([lower, upper], cost): (&[f64; 2], &f64)| {
        let ends = if *cost < 0.0 { [upper, lower] } else { [lower, upper] };
        ends.into_iter().find(|end| end.is_finite()).copied().unwrap_or(0.0)
    };
    let x = bounds.iter().zip(&program.linear).map(begin).collect();
    let search = LocalSearch::new(program, bounds, x, is_answer);
    jump_until(ctx, search, [most, idle])
}

/// Rounds a relaxed point of the domain, and looks for a point from there. Returns whether one was
/// accepted.
pub(super) fn mend_rounded(ctx: &mut Context<'_>, point: &[f64]) -> bool {
    let program = ctx.program();
    if !program.cones.is_empty() || program.column_count() < FEWEST_MENDED_COLUMNS {
        return false;
    }
    let bounds = bounds_of(ctx);
    let round = |(j, [lower, upper]): (usize, &[f64; 2])| {
        let value = if program.integral[j] { point[j].round() } else { point[j] };
        value.max(*lower).min(*upper)
    };
    let x = bounds.iter().enumerate().map(round).collect();
    let entries: usize = (0..program.row_count()).map(|row| program.row(row).0.len()).sum();
    let search = LocalSearch::new(program, bounds, x, false);
    jump_until(ctx, search, [MENDING_VISITS_PER_ENTRY, IDLE_VISITS_PER_ENTRY].map(|v| v * entries))
}

/// The bounds of all columns in the domain.
fn bounds_of(ctx: &Context<'_>) -> Vec<[f64; 2]> {
    (0..ctx.program().column_count()).map(|j| ctx.node.domain.bounds(j)).collect()
}

/// Lets columns jump until a point is accepted, which is the result, or there are too many visits
/// of entries: in all, and since the fewest rows were violated.
fn jump_until(
    ctx: &mut Context<'_>,
    mut search: LocalSearch<'_>,
    [most, idle]: [usize; 2],
) -> bool {
    let (mut completions, mut next) = (0, 0);
    let (mut fewest, mut since) = (usize::MAX, 0);
    for jumps in 1.. {
        if search.violated.members.is_empty() {
            // What is solved for costs less, and may take longer than there is time.
            return try_assignment(ctx, &search.x) || offer_point(ctx, &search.x);
        }
        if search.violated_whole == 0 && jumps >= next && completions < MOST_COMPLETIONS {
            if try_assignment(ctx, &search.x) {
                return true;
            }
            (completions, next) = (completions + 1, 2 * jumps + JUMPS_PER_LOOK);
        }
        let is_over = jumps % JUMPS_PER_LOOK == 0 && ctx.token.is_over();
        if search.violated.members.len() < fewest {
            (fewest, since) = (search.violated.members.len(), search.visits);
        }
        let is_idle = search.visits - since > idle;
        if is_over || is_idle || search.visits > most {
            break;
        }
        let Some(j) = search.choose() else { break };
        search.jump(j);
    }
    false
}

/// A set of some of the numbers below another one, in no order.
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

    /// Adds or removes a number; returns whether that changes the set.
    fn set(&mut self, k: usize, is_member: bool) -> bool {
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
        } else {
            return false;
        }
        true
    }
}

struct LocalSearch<'a> {
    program: &'a Program,
    bounds: Vec<[f64; 2]>,
    x: Vec<f64>,
    /// By column, whether it has two values, between which it jumps.
    is_switch: Vec<bool>,
    /// By column, what its jump adds to it; 0 for those that stay.
    step: Vec<f64>,
    /// By row, whether all its columns are integral.
    is_whole: Vec<bool>,
    activity: Vec<f64>,
    weight: Vec<f64>,
    violated: MemberSet,
    /// How many of the rows that are violated have integral columns alone.
    violated_whole: usize,
    /// By column, by how much its jump lessens the weighted violation.
    score: Vec<f64>,
    /// The columns whose jump lessens it.
    good: MemberSet,
    /// The columns with more than two values whose rows have changed.
    stale: MemberSet,
    kinks: Kinks,
    /// The state of the random numbers.
    random: SplitMix,
    visits: usize,
}

impl<'a> LocalSearch<'a> {
    /// # Arguments
    ///
    /// * `x`: the first point, within the bounds.
    /// * `holds_costs`: columns with costs stay where they are.
    fn new(program: &'a Program, bounds: Vec<[f64; 2]>, x: Vec<f64>, holds_costs: bool) -> Self {
        let (m, n) = (program.row_count(), program.column_count());
        let is_switch =
            |(j, [lower, upper]): (usize, &[f64; 2])| program.integral[j] && upper - lower <= 1.0;
        let is_switch: Vec<bool> = bounds.iter().enumerate().map(is_switch).collect();
        let step = |j: usize| match bounds[j] {
            [lower, upper] if is_switch[j] && !(holds_costs && program.linear[j] != 0.0) => {
                lower + upper - 2.0 * x[j]
            }
            _ => 0.0,
        };
        let is_whole = |i: usize| program.row(i).0.iter().all(|&j| program.integral[j]);
        let mut search = LocalSearch {
            program,
            step: (0..n).map(step).collect(),
            is_whole: (0..m).map(is_whole).collect(),
            bounds,
            x,
            is_switch,
            activity: vec![0.0; m],
            weight: vec![1.0; m],
            violated: MemberSet::of_none(m),
            violated_whole: 0,
            score: vec![0.0; n],
            good: MemberSet::of_none(n),
            stale: MemberSet::of_none(n),
            kinks: Kinks::default(),
            random: SplitMix(0x9e37_79b9_7f4a_7c15),
            visits: 0,
        };
        for i in 0..m {
            let (columns, values) = program.row(i);
            let terms = columns.iter().zip(values).map(|(&j, a)| a * search.x[j]);
            search.activity[i] = terms.sum();
            search.note_violation(i);
            search.add_scores(i, 1.0);
        }
        search.aim();
        search
    }

    /// By how much an activity misses the limits of a row, beyond the tolerance.
    fn violation(&self, row: usize, activity: f64) -> f64 {
        let (lower, upper) = (self.program.row_lower[row], self.program.row_upper[row]);
        let miss = (lower - activity).max(activity - upper);
        if miss > tolerance::FEASIBILITY { miss } else { 0.0 }
    }

    fn note_violation(&mut self, row: usize) {
        let is_violated = self.violation(row, self.activity[row]) > 0.0;
        if self.violated.set(row, is_violated) && self.is_whole[row] {
            let before = self.violated_whole;
            self.violated_whole = if is_violated { before + 1 } else { before - 1 };
        }
    }

    /// Adds what a row says about jumps between two values, times a factor, to the scores. Other
    /// columns have to look for a new value.
    fn add_scores(&mut self, row: usize, factor: f64) {
        let (columns, values) = self.program.row(row);
        let activity = self.activity[row];
        let before = self.violation(row, activity);
        for (&k, &b) in columns.iter().zip(values) {
            if !self.is_switch[k] {
                self.stale.set(k, true);
            } else if self.step[k] != 0.0 {
                let after = self.violation(row, activity + self.step[k] * b);
                self.score[k] += factor * (before - after);
                self.good.set(k, self.score[k] > LEAST_SCORE);
            }
        }
        self.visits += columns.len();
    }

    /// Finds the best values of the columns whose rows have changed, and their scores.
    fn aim(&mut self) {
        while let Some(&j) = self.stale.members.last() {
            self.stale.set(j, false);
            let (x, [lower, upper]) = (self.x[j], self.bounds[j]);
            let row = |i: usize| (self.weight[i], self.activity[i]);
            let mut best = self.kinks.least(self.program, j, x, [lower, upper], row);
            let mut score = self.gain(j, best);
            if self.program.integral[j] && best != best.round() {
                let ends = [best.floor().max(lower), best.ceil().min(upper)];
                let [below, above] = ends.map(|end| self.gain(j, end));
                (best, score) = if below > above { (ends[0], below) } else { (ends[1], above) };
            }
            (self.step[j], self.score[j]) = (best - x, score);
            self.good.set(j, best != x && score > LEAST_SCORE);
            self.visits += 4 * self.program.column(j).0.len();
        }
    }

    /// By how much a value of a column lessens the weighted violation.
    fn gain(&self, j: usize, value: f64) -> f64 {
        let (rows, values) = self.program.column(j);
        let of_row = |(&i, a): (&usize, &f64)| {
            let (activity, step) = (self.activity[i], a * (value - self.x[j]));
            self.weight[i] * (self.violation(i, activity) - self.violation(i, activity + step))
        };
        rows.iter().zip(values).map(of_row).sum()
    }

    /// The next column to jump; `None` if violated rows have none.
    fn choose(&mut self) -> Option<usize> {
        let mut best = None;
        let mut most = f64::NEG_INFINITY;
        let count = self.good.members.len();
        for k in 0..count.min(COMPARED_JUMPS) {
            let k = if count > COMPARED_JUMPS { self.random_below(count) } else { k };
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
        self.aim();
        let first = self.random_below(self.violated.members.len());
        let rows = self.violated.members.iter().cycle().skip(first).take(COMPARED_JUMPS);
        let mut open = rows.map(|&row| {
            let columns = self.program.row(row).0.iter().copied();
            let open = columns.filter(|&j| self.step[j] != 0.0);
            open.max_by(|&a, &b| self.score[a].total_cmp(&self.score[b]))
        });
        open.find_map(|column| column)
    }

    /// A random number below another one.
    fn random_below(&mut self, count: usize) -> usize {
        (self.random.draw() % count as u64) as usize
    }

    fn jump(&mut self, j: usize) {
        let (rows, values) = self.program.column(j);
        let step = self.step[j];
        for &row in rows {
            self.add_scores(row, -self.weight[row]);
        }
        self.x[j] += step;
        self.step[j] = -step;
        for (&row, &a) in rows.iter().zip(values) {
            self.activity[row] += step * a;
            self.note_violation(row);
            self.add_scores(row, self.weight[row]);
        }
        self.aim();
    }
}
