//! Proofs of programs with functions: boxes are closed by sums of facts and of rows that enclose
//! the functions, tightened and split.
//!
//! The search is not followed: with the bound known from the beginning, a tree of its own is as
//! small.
//!
//! * `propagation` - bounds from functions
//! * `relaxation` - sums of facts and enclosures that close a box
//! * `tightening` - bounds of columns as lemmas
//! * `text` - functions and sums as the log has them
//! * this file - the tree

mod propagation;
mod relaxation;
mod text;
mod tightening;

use std::io::{self, Write};
use std::rc::Rc;

use super::bounds::{Bounds, Clash};
use super::claim::Claim;
use super::cones::ConeRow;
use super::facts::Facts;
use super::log::{Names, ProofLog};
use super::relaxed::Relaxer;
use super::simple_sums::ObjectiveFact;
use super::tree::Limit;
use crate::interval::add_up;
use crate::presolve::Domain;
use crate::relaxation::{CascadePool, WarmState};
use crate::solution::ProofReport;
use crate::solver::{Options, StopToken};
use crate::spatial::{BoxSplit, SpatialProgram, SplitHistory, choose, middle};
use relaxation::BoxOutcome;

/// The largest value at which a column is split.
const MOST_SPLIT: f64 = 1e12;

/// A proof that is asked for, of a program with functions.
#[derive(Clone, Copy)]
pub(crate) struct BoxProofRequest<'a> {
    pub(crate) program: &'a SpatialProgram,
    pub(crate) claim: Claim,
    pub(crate) options: &'a Options,
    /// Ends the proof when it is over.
    pub(crate) token: &'a StopToken,
    pub(crate) most_splits: u64,
    pub(crate) cascades: &'a CascadePool,
}

impl BoxProofRequest<'_> {
    /// Writes the proof, with a point of the program if one is known.
    ///
    /// # Errors
    ///
    /// Those of `out`.
    pub(crate) fn prove(
        self,
        point: Option<&[f64]>,
        out: &mut dyn Write,
    ) -> io::Result<ProofReport> {
        let BoxProofRequest { program: of, claim, options, token, most_splits, cascades, .. } =
            self;
        let bound = match claim {
            Claim::Bound(bound) => Some(of.program.sign * bound + 0.0),
            Claim::Infeasible => None,
        };
        let functions = text::functions(of);
        let [columns, rows] = of.names();
        let names = Names { columns, rows, functions: &functions };
        let mut log = ProofLog::new(out, &of.program, &names, claim);
        if let Some(point) = point.filter(|point| text::is_near(of, point)) {
            log.point(point);
        }
        let mut facts = Facts::new(&of.program);
        facts.set_functions(propagation::function_columns(of));
        let mut program = of.program.clone();
        if claim == Claim::Infeasible {
            program.make_feasibility_problem();
        }
        let bounds = Bounds::new(&program);
        let history = SplitHistory::new(program.column_count());
        let relaxer = Relaxer::new(program, claim, (options, token), cascades);
        let (log_of, splits_left, cone_rows) = (&mut log, most_splits, Vec::new());
        let mut prover =
            BoxProver { log: log_of, of, facts, bounds, relaxer, history, splits_left, cone_rows };
        let result = prover.run();
        cascades.give_back(prover.relaxer.cascade);
        let (commands, bytes) = match result {
            Ok(()) => log.finish()?,
            Err(Limit) => {
                log.remark("a limit came before the end of the proof");
                log.abandon()?
            }
        };
        let mut report = ProofReport::new(result.is_ok(), commands, bytes);
        report.bound = bound;
        Ok(report)
    }
}

/// A box that is still to be closed.
#[derive(Debug, Clone)]
struct BoxNode {
    is_root: bool,
    /// A bound and the relaxed point of the parent.
    bound: f64,
    x: Option<Rc<Vec<f64>>>,
    warm: Option<WarmState>,
    /// The column of the split, and how much of its range is gone.
    split: Option<(usize, f64)>,
}

/// The second side of a split: marks of bounds and facts, the bound, the box.
#[derive(Debug)]
struct SecondSide {
    mark: usize,
    facts: usize,
    column: usize,
    lower: f64,
    node: BoxNode,
}

/// The state of a proof.
struct BoxProver<'a, 'b> {
    log: &'a mut ProofLog<'b>,
    of: &'a SpatialProgram,
    facts: Facts,
    bounds: Bounds,
    relaxer: Relaxer<'a>,
    history: SplitHistory,
    splits_left: u64,
    /// Rows of cones, which hold in all boxes.
    cone_rows: Vec<ConeRow>,
}

impl BoxProver<'_, '_> {
    fn run(&mut self) -> Result<(), Limit> {
        if let Claim::Bound(bound) = self.relaxer.claim {
            let program = &self.relaxer.program;
            let costs = program.linear.iter().copied().enumerate().filter(|(_, c)| *c != 0.0);
            let limit = add_up(bound, -program.offset);
            let fact = self.facts.push(costs, [f64::NEG_INFINITY, limit]);
            self.log.tangent(std::iter::empty());
            self.relaxer.objective.push(ObjectiveFact { fact, ratio: 1.0, most: bound });
        }
        (0..self.facts.len()).for_each(|fact| self.bounds.enqueue(fact as u32));
        let (bound, is_root) = (f64::NEG_INFINITY, true);
        let mut next = Some(BoxNode { is_root, bound, x: None, warm: None, split: None });
        let mut open: Vec<SecondSide> = Vec::new();
        loop {
            if self.relaxer.token.is_over() || self.log.has_failed() {
                return Err(Limit);
            }
            if let Some(node) = next.take()
                && let Some((split, first, second)) = self.process(node)?
            {
                self.splits_left = self.splits_left.checked_sub(1).ok_or(Limit)?;
                let BoxSplit { column, at } = split;
                let (mark, facts) = (self.bounds.mark(), self.facts.len());
                let is_whole = self.of.program.integral[column];
                let [upper, lower] =
                    if is_whole { [at.floor(), at.floor() + 1.0] } else { [at; 2] };
                match is_whole {
                    true => self.log.split(column, upper),
                    false => self.log.split_range(column, at),
                }
                open.push(SecondSide { mark, facts, column, lower, node: second });
                self.bounds.decide(&self.facts, column, true, upper);
                next = Some(first);
                continue;
            }
            let Some(SecondSide { mark, facts, column, lower, node }) = open.pop() else {
                return Ok(());
            };
            self.bounds.undo_to(mark);
            self.facts.truncate(facts);
            self.bounds.decide(&self.facts, column, false, lower);
            next = Some(node);
        }
    }

    /// Closes a box, or returns how it is split, with both sides.
    fn process(&mut self, node: BoxNode) -> Result<Option<(BoxSplit, BoxNode, BoxNode)>, Limit> {
        if let Err(what) = self.propagate() {
            self.write_conflict(what);
            return Ok(None);
        }
        let mut outcome = self.relax(&node)?;
        if let BoxOutcome::Open(found) = &outcome {
            let moves = match node.is_root {
                true => self.tighten_by_relaxations(found)?,
                false => Ok(self.tighten_by_multipliers(found)),
            };
            let moves = moves.and_then(|moves| self.propagate().map(|()| moves));
            if let Err(what) = moves {
                self.write_conflict(what);
                return Ok(None);
            }
            if moves.is_ok_and(|moves| moves) {
                outcome = self.relax(&node)?;
            }
        }
        let found = match outcome {
            BoxOutcome::Closed(closing) => {
                self.write_closing(&closing);
                return Ok(None);
            }
            BoxOutcome::Open(found) => found,
        };
        let bound = found.bound.max(node.bound);
        if let (Some((column, distance)), true) = (node.split, node.bound.is_finite()) {
            self.history.note(column, bound - node.bound, distance);
        }
        let domain = self.domain();
        let x = found.x.map(Rc::new).or(node.x);
        let guess = x.as_ref().map_or_else(|| middle(&domain), |x| x.to_vec());
        let integrality = self.relaxer.options.integrality;
        let split = choose(self.of, &self.history, &domain, &guess, integrality);
        let Some(BoxSplit { column, at }) = split else { return Err(Limit) };
        let [lower, upper] = domain.bounds(column);
        if at.is_nan() || at.abs() > MOST_SPLIT {
            // Columns without bounds are halved without end.
            return Err(Limit);
        }
        let at = if self.of.program.integral[column] {
            at.floor().max(lower).min(upper - 1.0)
        } else {
            at
        };
        let child = |distance: f64| BoxNode {
            is_root: false,
            bound,
            x: x.clone(),
            warm: found.warm.clone(),
            split: Some((column, distance.clamp(1e-9, 1e6))),
        };
        let split = BoxSplit { column, at };
        Ok(Some((split, child(upper - at), child(at - lower))))
    }

    /// The present bounds.
    fn domain(&self) -> Domain {
        let mut domain = Domain::new(&self.of.program);
        for j in 0..domain.column_count() {
            let [lower, upper] = self.bounds.of(j);
            domain.apply(j, false, lower);
            domain.apply(j, true, upper);
        }
        domain
    }

    fn write_conflict(&mut self, what: Clash) {
        let sides = match what {
            Clash::Column(j) => vec![(j, false), (j, true)],
            Clash::Fact(fact, is_upper) => {
                Bounds::sides_of(&self.facts, fact, is_upper, None).collect()
            }
        };
        self.write_bounds(sides.into_iter());
        self.log.conflict(what);
    }

    /// Writes the bounds that some sides rest on.
    fn write_bounds(&mut self, sides: impl Iterator<Item = (usize, bool)>) {
        for (change, source) in self.bounds.reasons(&self.facts, sides) {
            self.log.bound(&change, source);
        }
    }
}
