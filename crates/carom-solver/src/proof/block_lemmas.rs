//! Independent blocks: a lemma about the costs of each one, whose tree splits columns of the block
//! only.
//!
//! The sum of the lemmas contradicts the fact of a linear objective. If there is no point, it
//! suffices that one block has none. A quadratic objective has no such lemmas: no rule tells what a
//! part of it is at least.

use std::rc::Rc;

use super::claim::Claim;
use super::guide::Guide;
use super::relaxed::FactRefutation;
use super::simple_sums::ObjectiveFact;
use super::tree::{Limit, Probing, ProofPart, ProofWriter};
use crate::presolve::root::{ProgramBlock, blocks};
use crate::program::Program;
use crate::search::{SolveTask, granularity, search};
use crate::solution::Termination;
use crate::solver::Control;

/// Most nodes of the search for a block without a point.
const MOST_BLOCK_NODES: u64 = 2000;

/// The share of the integral columns from which on a block is the program itself, and the others
/// are no help (no unit).
const MAIN_SHARE: f64 = 0.9;

/// The part of the room between the best point and the claim that the lemmas of the blocks use (no
/// unit).
const SHARED_ROOM: f64 = 0.9;

/// How far a multiple of whole costs at a point may be above a whole number by rounding (no unit).
const WHOLE_SPARE: f64 = 1e-6;

/// How many blocks the proof of a claim about a program has; 0 if it is not proved by blocks.
pub(crate) fn count_blocks(program: &Program) -> usize {
    parts_of(program, &|j| [program.lower[j], program.upper[j]]).len()
}

/// The blocks of a program within some bounds; empty if it is not proved by blocks.
fn parts_of(program: &Program, range: &dyn Fn(usize) -> [f64; 2]) -> Vec<ProgramBlock> {
    if program.quadratic.compute_nnz() > 0 {
        return Vec::new();
    }
    let parts = unlinked(program, range).map_or(Vec::new(), |program| blocks(&program));
    let sizes = || parts.iter().map(|part| part.program.integers.len());
    let (all, largest) = (sizes().sum::<usize>(), sizes().max().unwrap_or(0));
    if largest as f64 > MAIN_SHARE * all as f64 { Vec::new() } else { parts }
}

/// A program without entries that link no blocks: those of rows that cannot fail, and of columns
/// that are fixed and in no cone. Rows and columns keep their numbers, unlike in presolve, because
/// facts have these.
fn unlinked(program: &Program, range: &dyn Fn(usize) -> [f64; 2]) -> Option<Program> {
    let is_fixed = |j: usize| range(j)[0] == range(j)[1] && !program.is_in_cone(j);
    let mut own = program.clone();
    let (mut entries, mut limits) = (Vec::new(), Vec::new());
    for row in 0..program.row_count() {
        let (columns, values) = program.row(row);
        let (mut constant, mut reach) = (0.0, [0.0; 2]);
        let terms = columns.iter().copied().zip(values.iter().copied());
        for (j, a) in terms.clone() {
            let [lower, upper] = range(j);
            let ends = if a > 0.0 { [a * lower, a * upper] } else { [a * upper, a * lower] };
            (reach[0], reach[1]) = (reach[0] + ends[0], reach[1] + ends[1]);
            constant += if is_fixed(j) { a * lower } else { 0.0 };
        }
        let [lower, upper] = [program.row_lower[row], program.row_upper[row]];
        if reach[0] >= lower && reach[1] <= upper {
            limits.push([f64::NEG_INFINITY, f64::INFINITY]);
            continue;
        }
        limits.push([lower - constant, upper - constant]);
        entries.extend(terms.filter(|(j, _)| !is_fixed(*j)).map(|(j, a)| (row, j, a)));
    }
    own.replace_rows(entries.into_iter(), &limits)?;
    (0..own.column_count()).for_each(|j| [own.lower[j], own.upper[j]] = range(j));
    own.integers.retain(|&j| !is_fixed(j));
    Some(own)
}

impl ProofWriter<'_, '_> {
    /// Closes the whole program block by block; `false` if it must be closed as a whole.
    ///
    /// # Arguments
    ///
    /// * `point`: the best point that is known.
    pub(super) fn close_blocks(&mut self, point: Option<&[f64]>) -> Result<bool, Limit> {
        let parts = parts_of(&self.relaxer.program, &|j| self.bounds.of(j));
        if parts.len() < 2 {
            return Ok(false);
        }
        let whole = self.relaxer.program.clone();
        let (claim, objective) = (self.relaxer.claim, self.relaxer.objective.clone());
        let is_closed = match (claim, point) {
            (Claim::Infeasible, _) => match self.without_point(&parts) {
                Some(part) => {
                    self.relaxer.program = restricted(&whole, &part.columns, &|j| {
                        self.relaxer.is_fixed(&self.bounds, j)
                    });
                    self.relaxer.keep_only(&part.columns);
                    self.close_block().map(|()| true)
                }
                None => Ok(false),
            },
            (Claim::Bound(limit), Some(point)) => {
                self.close_by_lemmas(&whole, &parts, (limit, point)).map(|()| true)
            }
            _ => Ok(false),
        };
        self.relaxer.program = whole;
        (self.relaxer.claim, self.relaxer.objective) = (claim, objective);
        self.relaxer.keep_all();
        is_closed
    }

    /// A block that has no point.
    fn without_point<'p>(&self, parts: &'p [ProgramBlock]) -> Option<&'p ProgramBlock> {
        let options = self.relaxer.options.nested().with_node_limit(MOST_BLOCK_NODES);
        let has_none = |part: &&ProgramBlock| {
            let accepts = |_: &[f64]| true;
            let (cascades, token) = (self.relaxer.cascades, self.relaxer.token);
            let task = SolveTask::new(&part.program, &accepts, cascades, &options, token);
            let found = search(task, &mut Control::default(), None);
            found.termination == Termination::Infeasible
        };
        parts.iter().find(has_none)
    }

    /// Proves what the costs of each block are at least, and adds it up.
    fn close_by_lemmas(
        &mut self,
        whole: &Program,
        parts: &[ProgramBlock],
        (limit, point): (f64, &[f64]),
    ) -> Result<(), Limit> {
        let room = SHARED_ROOM * (whole.objective(point) - limit).max(0.0) / parts.len() as f64;
        let objective = self.relaxer.objective.last().map(|objective| objective.fact);
        let mut sum: Vec<(usize, f64)> = Vec::new();
        for part in parts {
            let costs = |j: &usize| Some((*j, whole.linear[*j])).filter(|(_, cost)| *cost != 0.0);
            let costs: Vec<(usize, f64)> = part.columns.iter().filter_map(costs).collect();
            if costs.is_empty() {
                continue;
            }
            let mut program =
                restricted(whole, &part.columns, &|j| self.relaxer.is_fixed(&self.bounds, j));
            costs.iter().for_each(|&(j, cost)| program.linear[j] = cost);
            let value = costs.iter().map(|&(j, cost)| cost * point[j]).sum::<f64>() - room;
            // Whole numbers that are not at least a whole number are at most the one before it.
            let (unit, least, before) = match granularity(&program) {
                unit if unit > 0.0 => {
                    let least = (value / unit - WHOLE_SPARE).ceil();
                    (unit, least, least - 1.0)
                }
                _ => (1.0, value, value),
            };
            let terms = costs.iter().map(|(j, cost)| (*j, cost / unit));
            self.log.lemma(false, least, terms.clone());
            let fact = self.facts.push(terms, [f64::NEG_INFINITY, before]);
            self.bounds.enqueue(fact as u32);
            let most = before * unit;
            self.relaxer.program = program;
            self.relaxer.claim = Claim::Bound(most);
            self.relaxer.objective = vec![ObjectiveFact { fact, ratio: unit, most }];
            self.relaxer.keep_only(&part.columns);
            self.close_block()?;
            self.facts.set_limits(fact, [least, f64::INFINITY]);
            sum.push((fact, unit));
        }
        self.relaxer.keep_all();
        sum.extend(objective.map(|fact| (fact, -1.0)));
        let mut found = FactRefutation { facts: sum, ..FactRefutation::default() };
        self.gaps += u64::from(self.relaxer.check(&self.facts, &self.bounds, &mut found).is_none());
        self.write(found);
        Ok(())
    }

    /// Closes the context of a block, and forgets what was derived in it.
    fn close_block(&mut self) -> Result<(), Limit> {
        let (mark, count) = (self.bounds.mark(), self.facts.len());
        let rows = self.relaxer.fact_of_row.clone();
        let closed = self.close_strengthened(self.begin_block());
        self.bounds.undo_to(mark);
        self.facts.truncate(count);
        self.relaxer.fact_of_row = rows;
        closed
    }

    fn begin_block(&self) -> ProofPart {
        let order = self.relaxer.program.integers.iter().rev().copied().collect();
        let part = ProofPart::Node(Rc::new(Guide::default()), 0);
        ProofPart::Probing(Box::new(Probing::new(order, part, None)))
    }
}

/// A program with the rows of one block alone, and without an objective.
///
/// # Arguments
///
/// * `is_fixed`: columns that may be in rows of all blocks.
fn restricted(whole: &Program, columns: &[usize], is_fixed: &dyn Fn(usize) -> bool) -> Program {
    let mut program = whole.clone();
    program.make_feasibility_problem();
    let mut is_inside = vec![false; whole.column_count()];
    columns.iter().for_each(|&j| is_inside[j] = true);
    program.integers.retain(|&j| is_inside[j]);
    for row in 0..whole.row_count() {
        if !whole.row(row).0.iter().all(|&j| is_inside[j] || is_fixed(j)) {
            (program.row_lower[row], program.row_upper[row]) = (f64::NEG_INFINITY, f64::INFINITY);
        }
    }
    program
}
