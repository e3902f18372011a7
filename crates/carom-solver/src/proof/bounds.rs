//! Bounds of columns, each with the fact that it follows from.
//!
//! A bound is derived from one fact and the bounds of its other columns, rounded outwards, so that
//! the exact check of the log accepts it. What closes a context needs few of them:
//! [`Bounds::reasons`] finds these, and only they are written.

use std::collections::BinaryHeap;

use super::facts::{BoundSource, Facts, LARGEST_EXACT};
use crate::activity::RowActivity;
use crate::program::Program;

/// The mark of a bound that was there from the start, and of a change without a fact.
const NOTHING: u32 = u32::MAX;

/// Least change of a bound of a continuous column that is worth a step, relative to the width of
/// its bounds, and to its size where it had none (no unit).
const LEAST_CHANGE: f64 = 1e-3;

/// The part of that which is still worth a step where nothing else closes a context.
const FINE: f64 = 1e-4;

/// The largest bound that is derived for a column without one.
const LARGEST: f64 = 1e15;

/// Visits of facts in one propagation, for each fact.
const MOST_VISITS: usize = 30;

/// A change of a bound.
#[derive(Debug, Clone, Copy)]
pub(super) struct BoundChange {
    pub(super) column: u32,
    pub(super) is_upper: bool,
    pub(super) value: f64,
    before: f64,
    /// The change that was in force before it.
    earlier: u32,
    /// The fact that it follows from; [`NOTHING`] if the log has it already.
    fact: u32,
}

/// One side of a column.
pub(super) type Side = (usize, bool);

/// A contradiction that propagation has found.
#[derive(Debug, Clone, Copy)]
pub(super) enum Clash {
    /// The bounds of a column are crossed.
    Column(usize),
    /// The bounds keep the terms of a fact above its upper limit (`true`), or below its lower one.
    Fact(usize, bool),
}

/// The bounds of a context.
#[derive(Debug)]
pub(super) struct Bounds {
    now: Vec<[f64; 2]>,
    /// By column and side, the last change.
    last: Vec<[u32; 2]>,
    trail: Vec<BoundChange>,
    integral: Vec<bool>,
    queue: Vec<u32>,
    is_queued: Vec<bool>,
    /// The least change that counts, as a multiple of the usual one.
    fineness: f64,
}

/// The least and the largest sum of the terms of a fact, and the possible error of both.
#[derive(Debug, Clone, Copy, Default)]
struct FactActivity {
    ends: [RowActivity; 2],
    error: f64,
    /// The widest range of a term.
    widest: f64,
    /// Whether the finite part, and its difference with any of its terms, is whole and not rounded.
    is_exact: [bool; 2],
}

impl Bounds {
    /// The bounds of a program.
    pub(super) fn new(program: &Program) -> Self {
        let sides = program.lower.iter().zip(&program.upper);
        let now: Vec<[f64; 2]> = sides.map(|(&lower, &upper)| [lower, upper]).collect();
        let last = vec![[NOTHING; 2]; now.len()];
        let integral = program.integral.clone();
        let (trail, queue, is_queued) = Default::default();
        Bounds { now, last, trail, integral, queue, is_queued, fineness: 1.0 }
    }

    /// Rounds the bounds of a column to whole numbers from here on, as far as they follow from
    /// facts: the log has the others as they are. Returns whether one of them was rounded.
    pub(super) fn take_as_integral(&mut self, facts: &Facts, column: usize) -> bool {
        self.integral[column] = true;
        let [lower, upper] = self.now[column];
        let mut is_rounded = false;
        for (is_upper, before, after) in
            [(false, lower, lower.ceil()), (true, upper, upper.floor())]
        {
            let reason =
                self.in_force((column, is_upper), NOTHING).map(|at| self.trail[at as usize]);
            let has_fact = |change: &BoundChange| before != after && change.fact != NOTHING;
            if let Some(change) = reason.filter(has_fact) {
                self.apply(facts, (column, is_upper), after + 0.0, change.fact);
                is_rounded = true;
            }
        }
        is_rounded
    }

    /// The bounds of a column.
    pub(super) fn of(&self, column: usize) -> [f64; 2] {
        self.now[column]
    }

    /// A mark to return to.
    pub(super) fn mark(&self) -> usize {
        self.trail.len()
    }

    /// Undoes all changes since a mark.
    pub(super) fn undo_to(&mut self, mark: usize) {
        for change in self.trail.drain(mark..).rev() {
            let (j, side) = (change.column as usize, usize::from(change.is_upper));
            self.now[j][side] = change.before;
            self.last[j][side] = change.earlier;
        }
    }

    /// Applies a bound that the log knows: a side of a split, or a bound that was written before.
    pub(super) fn decide(&mut self, facts: &Facts, column: usize, is_upper: bool, value: f64) {
        self.apply(facts, (column, is_upper), value, NOTHING);
    }

    fn apply(&mut self, facts: &Facts, (column, is_upper): Side, value: f64, fact: u32) {
        let side = usize::from(is_upper);
        let before = std::mem::replace(&mut self.now[column][side], value);
        let at = self.trail.len() as u32;
        let earlier = std::mem::replace(&mut self.last[column][side], at);
        let column = column as u32;
        self.trail.push(BoundChange { column, is_upper, value, before, earlier, fact });
        for &other in facts.of_column(column as usize) {
            self.enqueue(other);
        }
    }

    /// Has a fact looked at by the next propagation.
    pub(super) fn enqueue(&mut self, fact: u32) {
        let place = fact as usize;
        if self.is_queued.len() <= place {
            self.is_queued.resize(place + 1, false);
        }
        if !std::mem::replace(&mut self.is_queued[place], true) {
            self.queue.push(fact);
        }
    }

    /// Derives bounds from the facts whose columns have changed.
    pub(super) fn propagate(&mut self, facts: &Facts) -> Result<(), Clash> {
        let most = MOST_VISITS * facts.len();
        let (mut at, mut result) = (0, Ok(()));
        while at < self.queue.len() && at < most && result.is_ok() {
            let fact = self.queue[at] as usize;
            self.is_queued[fact] = false;
            // A fact may have gone with its context since it was queued.
            if fact < facts.len() {
                result = self.visit(facts, fact);
            }
            at += 1;
        }
        self.queue.iter().for_each(|&fact| self.is_queued[fact as usize] = false);
        self.queue.clear();
        result
    }

    /// Derives bounds from all facts, also slight changes.
    pub(super) fn propagate_finely(&mut self, facts: &Facts) -> Result<(), Clash> {
        for fact in 0..facts.len() as u32 {
            self.enqueue(fact);
        }
        self.fineness = FINE;
        let result = self.propagate(facts);
        self.fineness = 1.0;
        result
    }

    fn activity(&self, facts: &Facts, fact: usize) -> FactActivity {
        let (mut activity, mut size, mut count) = (FactActivity::default(), 0.0, 0.0);
        activity.is_exact = [facts.is_whole(fact); 2];
        for (j, a) in facts.terms(fact) {
            let [lower, upper] = self.now[j];
            let ends = if a > 0.0 { [lower, upper] } else { [upper, lower] };
            for (k, own) in ends.into_iter().enumerate() {
                let end = a * own;
                activity.ends[k].add(end);
                if end.is_finite() {
                    activity.is_exact[k] &= is_whole(own);
                    size += end.abs();
                }
            }
            let range = a.abs() * (upper - lower);
            if range > activity.widest {
                activity.widest = range;
            }
            count += 1.0;
        }
        // Twice what the sums, and the difference with one of their terms, can be off.
        activity.error = (count + 6.0) * f64::EPSILON * size;
        if size >= LARGEST_EXACT {
            activity.is_exact = [false; 2];
        }
        activity
    }

    fn visit(&mut self, facts: &Facts, fact: usize) -> Result<(), Clash> {
        let limits = facts.limits(fact);
        let activity = self.activity(facts, fact);
        for (k, is_upper) in [(0, true), (1, false)] {
            // The least sum against the upper limit, the largest one against the lower.
            let limit = limits[usize::from(is_upper)];
            let sign = if is_upper { 1.0 } else { -1.0 };
            let is_exact = activity.is_exact[k];
            let error = match is_exact {
                true => 0.0,
                false => activity.error + 4.0 * f64::EPSILON * limit.abs(),
            };
            let end = activity.ends[k];
            if limit.is_infinite() || end.infinite > 1 {
                continue;
            }
            if end.infinite == 0 && sign * (end.finite - limit) > error {
                return Err(Clash::Fact(fact, is_upper));
            }
            // No column can use up what the least sum leaves.
            let left = sign * (limit - end.finite);
            if end.infinite == 0 && left >= activity.widest {
                continue;
            }
            for (j, a) in facts.terms(fact) {
                let [lower, upper] = self.now[j];
                let own = a * if (a > 0.0) == is_upper { lower } else { upper };
                let Some(rest) = end.without(own) else { continue };
                let side = (a > 0.0) == is_upper;
                let value = (limit - rest + sign * error) / a;
                let spare = match is_exact && is_whole(value) && value * a == limit - rest {
                    true => 0.0,
                    false => 4.0 * f64::EPSILON * value.abs() + f64::MIN_POSITIVE,
                };
                let value = if side { value + spare } else { value - spare };
                self.offer(facts, (j, side), value, BoundSource::Fact(fact))?;
            }
        }
        Ok(())
    }

    /// Takes a bound if it is enough of a change.
    pub(super) fn offer(
        &mut self,
        facts: &Facts,
        (column, is_upper): Side,
        value: f64,
        source: BoundSource,
    ) -> Result<(), Clash> {
        let [lower, upper] = self.now[column];
        let (old, other) = if is_upper { (upper, lower) } else { (lower, upper) };
        let value = match (self.integral[column], is_upper) {
            (true, true) => value.floor(),
            (true, false) => value.ceil(),
            _ => value,
        };
        let gain = if is_upper { old - value } else { value - old };
        let crosses = if is_upper { value < other } else { value > other };
        let least = match () {
            () if old.is_infinite() => 0.0,
            () if self.integral[column] => 0.5,
            () if other.is_infinite() => self.fineness * LEAST_CHANGE * old.abs().max(1.0),
            () => self.fineness * LEAST_CHANGE * (upper - lower).abs(),
        };
        if value.is_nan() || value.abs() > LARGEST || !(gain > least || (crosses && gain > 0.0)) {
            return Ok(());
        }
        self.apply(facts, (column, is_upper), value + 0.0, source.code());
        if crosses { Err(Clash::Column(column)) } else { Ok(()) }
    }

    /// The sides that have changed since a mark, with their values.
    pub(super) fn changed_since(&self, mark: usize) -> impl Iterator<Item = (Side, f64)> + '_ {
        // Later changes of a side replace earlier ones.
        self.trail[mark..]
            .iter()
            .map(|change| ((change.column as usize, change.is_upper), change.value))
    }

    /// Marks the present bounds as known to the log, after [`reasons`](Self::reasons) of all sides
    /// were written.
    pub(super) fn set_written(&mut self) {
        self.trail.iter_mut().for_each(|change| change.fact = NOTHING);
    }

    /// The change that was in force for a side before some place of the trail.
    fn in_force(&self, (column, is_upper): Side, before: u32) -> Option<u32> {
        let mut at = self.last[column][usize::from(is_upper)];
        while at != NOTHING && at >= before {
            at = self.trail[at as usize].earlier;
        }
        (at != NOTHING).then_some(at)
    }

    /// The sides that a fact needs of its other columns to bound one, or to contradict all.
    pub(super) fn sides_of(
        facts: &Facts,
        fact: usize,
        is_upper: bool,
        but: Option<usize>,
    ) -> impl Iterator<Item = Side> + '_ {
        let terms = facts.terms(fact).filter(move |(j, _)| Some(*j) != but);
        terms.map(move |(j, a)| (j, (a > 0.0) != is_upper))
    }

    /// The changes that some sides rest on, and that the log does not have yet, in their order,
    /// each with its fact.
    pub(super) fn reasons(
        &self,
        facts: &Facts,
        sides: impl Iterator<Item = Side>,
    ) -> Vec<(BoundChange, u32)> {
        let mut open = BinaryHeap::new();
        open.extend(sides.filter_map(|side| self.in_force(side, NOTHING)));
        let mut found = Vec::new();
        while let Some(at) = open.pop() {
            while open.peek() == Some(&at) {
                open.pop();
            }
            let change = self.trail[at as usize];
            if change.fact == NOTHING {
                continue;
            }
            let column = change.column as usize;
            match BoundSource::from_code(change.fact) {
                BoundSource::Fact(fact) => {
                    let a = facts.terms(fact).find(|(j, _)| *j == column).map_or(1.0, |(_, a)| a);
                    let is_upper = (a > 0.0) == change.is_upper;
                    let needed = Bounds::sides_of(facts, fact, is_upper, Some(column));
                    open.extend(needed.filter_map(|side| self.in_force(side, at)));
                }
                BoundSource::Function(function, place) => {
                    let columns = facts.function_needs(function, place);
                    let needed = columns.into_iter().flat_map(|j| [(j, false), (j, true)]);
                    open.extend(needed.filter_map(|side| self.in_force(side, at)));
                }
            }
            found.push((change, change.fact));
        }
        found.reverse();
        found
    }
}

/// Whether a number is whole, and a float can count to it.
fn is_whole(value: f64) -> bool {
    value as i64 as f64 == value
}
