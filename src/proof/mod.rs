//! Proofs that another program can check: a log of why no point is better than a bound, or why there is
//! none, in terms of the lowered program alone.
//!
//! The search rewrites its program and trusts what has rewritten it. A proof trusts nothing: it takes from
//! the search where it split, and proves every end of that tree again from the rows of the lowered program,
//! with bounds, sums of facts, tangents and splits. Where the search knew more (cuts, tighter rows), the
//! proof splits further. So a false answer of the search has no proof.
//!
//! * `facts` - rows of the program, and those derived from them
//! * `bounds` - bounds with the facts that they follow from
//! * `combination` - sums of facts with bounds on their rounding
//! * `convexity` - the proof that the objective is convex
//! * `relaxed`, `cones` - multipliers of relaxations as sums of facts
//! * `tree` - the splits
//! * `log` - the text

mod bounds;
mod combination;
mod cones;
mod convexity;
mod curvature_bounds;
mod facts;
mod log;
mod relaxed;
mod search;
mod tightened;
mod tree;

use std::io::{self, Write};
use std::rc::Rc;

use crate::interval::add_up;
use crate::program::Program;
use crate::relaxation::LadderPool;
use crate::search::{Decision, Fork};
use crate::solution::ProofReport;
use crate::solver::{Options, StopToken};
use bounds::Bounds;
use combination::Combination;
use cones::ConeRow;
use convexity::Convexity;
use facts::Facts;
use log::{Log, Names};
use relaxed::Relaxer;
use tree::{Forks, Limit, Part, Probing, ProofWriter};

/// What is to be proved.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Claim {
    /// The (minimised) objective of every point is at least this.
    Bound(f64),
    /// There is no point.
    Infeasible,
}

/// The tree of a search, as a hint where to split.
#[derive(Debug, Default)]
pub(crate) struct Guide {
    forks: Forks,
    /// The column of the lowered program behind each column of the search.
    columns: Option<Vec<usize>>,
    /// Whether the search was one of the lowered program as it is.
    is_plain: bool,
}

impl Guide {
    /// The splits of a search.
    pub(crate) fn new(forks: Vec<Fork>, columns: Option<Vec<usize>>) -> Self {
        Guide {
            forks: forks.into_iter().map(|fork| (fork.id(), fork)).collect(),
            columns,
            is_plain: false,
        }
    }

    fn fork(&self, node: u32) -> Option<&Fork> {
        self.forks.get(&node)
    }

    /// Where a child goes on; without a name it is an end.
    fn part(self: Rc<Self>, child: Option<u32>) -> Part {
        match child {
            Some(node) => Part::Node(self, node),
            None => Part::End(self),
        }
    }

    /// The decision at a place of a node's splits, and the node inside of it; `None` behind the last one. The
    /// decision is `None` if it is about no column of the lowered program.
    fn split(&self, fork: &Fork, place: usize) -> Option<(Option<Decision>, Option<u32>)> {
        let (decision, child) = fork.decision(place)?;
        let column = match &self.columns {
            Some(columns) => columns.get(decision.column).copied(),
            None => Some(decision.column),
        };
        Some((column.map(|column| Decision { column, ..decision }), child))
    }
}

/// A proof that is asked for.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ProofRequest<'a> {
    /// The lowered program.
    pub(crate) program: &'a Program,
    /// The names of its columns and of its rows, as far as there are any.
    pub(crate) names: [&'a [String]; 2],
    pub(crate) claim: Claim,
    pub(crate) options: &'a Options,
    /// Ends the proof when it is over.
    pub(crate) token: &'a StopToken,
    /// Splits besides those of the search.
    pub(crate) most_splits: u64,
    pub(crate) ladders: &'a LadderPool,
}

impl ProofRequest<'_> {
    /// Writes the proof.
    ///
    /// # Arguments
    ///
    /// * `guide`: where to split.
    /// * `point`: the best point that is known.
    ///
    /// # Errors
    ///
    /// Those of `out`.
    pub(crate) fn prove(
        self,
        guide: Guide,
        point: Option<&[f64]>,
        out: &mut dyn Write,
    ) -> io::Result<ProofReport> {
        let ProofRequest {
            program,
            names: [columns, rows],
            claim,
            options,
            token,
            most_splits,
            ladders,
        } = self;
        let mut log = Log::new(out, program, &Names { columns, rows }, claim);
        if let Some(point) = point {
            log.point(point);
        }
        let facts = Facts::new(program);
        let bounds = Bounds::new(program);
        let mut program = program.clone();
        if claim == Claim::Infeasible {
            program.make_feasibility_problem();
        }
        let relaxer = Relaxer {
            within: program.clone(),
            program,
            claim,
            options,
            token,
            ladder: ladders.take(),
            ladders,
            combination: Combination::default(),
            deficits: Vec::new(),
            relaxations: 0,
        };
        let mut writer = ProofWriter {
            log: &mut log,
            facts,
            bounds,
            relaxer,
            splits_left: most_splits,
            gaps: 0,
        };
        let result = writer.run(Rc::new(guide));
        let gaps = writer.gaps;
        if result.is_err() {
            log.remark("a limit came before the end of the proof");
            let (commands, bytes) = log.abandon()?;
            return Ok(ProofReport { is_complete: false, commands, bytes });
        }
        let (commands, bytes) = log.finish()?;
        Ok(ProofReport { is_complete: gaps == 0, commands, bytes })
    }
}

impl ProofWriter<'_, '_> {
    /// Derives what holds everywhere, and closes the whole program.
    fn run(&mut self, guide: Rc<Guide>) -> Result<(), Limit> {
        for fact in 0..self.facts.len() as u32 {
            self.bounds.enqueue(fact);
        }
        self.add_objective();
        self.add_cones();
        if let Err(what) = self.bounds.propagate(&self.facts) {
            self.write_conflict(what);
            return Ok(());
        }
        if self.relaxer.program.quadratic.compute_nnz() > 0 {
            let Convexity { factor, deficits } = Convexity::of(&self.relaxer.program);
            let lacking = deficits.iter().copied().enumerate().filter(|(_, lack)| *lack != 0.0);
            self.log.convexity(lacking, &factor);
            self.relaxer.deficits = deficits;
            self.bound_by_curvature();
        }
        let order: Vec<usize> = self.relaxer.program.integers.iter().rev().copied().collect();
        let begin = Probing::new(order, Part::Node(guide, 0), None);
        self.close(Part::Probing(Box::new(begin)))
    }

    /// Adds the rows by which the head of a cone bounds each entry of its tail: `|entry| <= head`, or twice an
    /// entry at most the sum of both heads.
    fn add_cones(&mut self) {
        for cone in 0..self.relaxer.program.cones.len() {
            let own = &self.relaxer.program.cones[cone];
            let (heads, entries) = (own.head().len(), own.tail().len());
            for (entry, weight) in (0..entries).flat_map(|entry| [(entry, 1.0), (entry, -1.0)]) {
                let mut tail = vec![0.0; entries];
                tail[entry] = weight;
                let row = ConeRow { cone, head: vec![1.0; heads], tail };
                self.log.cone_row(cone, &row.head, &row.tail);
                let terms: Vec<(usize, f64)> = row.terms(&self.relaxer.program).collect();
                let fact = self.facts.push(terms.into_iter(), [0.0, f64::INFINITY]);
                self.bounds.enqueue(fact as u32);
            }
        }
    }

    /// Adds the facts that a linear objective is: it is below the bound, and a multiple of what its whole
    /// coefficients have in common.
    fn add_objective(&mut self) {
        let Claim::Bound(bound) = self.relaxer.claim else { return };
        let program = &self.relaxer.program;
        if program.quadratic.compute_nnz() > 0 {
            return;
        }
        let costs = program.linear.iter().copied().enumerate().filter(|(_, cost)| *cost != 0.0);
        let costs: Vec<(usize, f64)> = costs.collect();
        self.log.tangent(std::iter::empty());
        let limit = add_up(bound, -program.offset);
        let unit = if costs.iter().all(|(j, _)| program.integral[*j]) {
            common_divisor(costs.iter().map(|(_, cost)| *cost))
        } else {
            0.0
        };
        let fact = self.facts.push(costs.iter().copied(), [f64::NEG_INFINITY, limit]);
        self.bounds.enqueue(fact as u32);
        let least = (limit / unit).floor();
        if unit > 0.0 && least.abs() < LARGEST_WHOLE && (least + 1.0) * unit > limit {
            // Not at most `least` units would be at least one more, and that is beyond the limit.
            let terms = costs.iter().map(|(j, cost)| (*j, cost / unit));
            self.log.lemma(true, least, terms.clone());
            let next = self.facts.len();
            self.log.contradiction([(fact, -1.0), (next, unit)].into_iter());
            let lemma = self.facts.push(terms, [f64::NEG_INFINITY, least]);
            self.bounds.enqueue(lemma as u32);
        }
    }
}

/// The largest whole numbers that are counted in (no unit).
const LARGEST_WHOLE: f64 = 1e9;

/// The common divisor of whole numbers; 0 if one is not whole, or large.
fn common_divisor(numbers: impl Iterator<Item = f64>) -> f64 {
    let mut divisor = 0.0_f64;
    for number in numbers {
        if number != number.round() || number.abs() > LARGEST_WHOLE {
            return 0.0;
        }
        let (mut a, mut b) = (divisor, number.abs());
        while b > 0.0 {
            (a, b) = (b, a % b);
        }
        divisor = a;
    }
    divisor
}
