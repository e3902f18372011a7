//! Proofs that another program can check: a log of why no point is better than a bound, or why
//! there is none, in terms of the lowered program alone.
//!
//! The search rewrites its program and trusts what has rewritten it. A proof trusts nothing: it
//! takes from the search where it split, and proves every end of that tree again from the rows of
//! the lowered program, with bounds, sums of facts, tangents and splits. Where the search knew more
//! (cuts, tighter rows), the proof begins with lemmas, or splits further. So a false answer of the
//! search has no proof.
//!
//! * `facts` - rows of the program, and those derived from them
//! * `bounds` - bounds with the facts that they follow from
//! * `aggregated_row` - weighted sums of facts with bounds on their rounding
//! * `convexity` - the proof that the objective is convex
//! * `relaxed`, `cones` - multipliers of relaxations as sums of facts
//! * `reduced_costs` - bounds from multipliers that leave a point
//! * `tightened` - rows with smaller big-Ms, as lemmas
//! * `conjugate_gradients` - equations that need few digits
//! * `root`, `curvature_bounds` - what holds everywhere
//! * `case_bounds` - bounds that hold in all cases of a disjunction
//! * `lemma` - rows with proofs of a few splits
//! * `strengthened`, `presolved_cuts` - smaller big-Ms, bounds and cuts of the root, as lemmas
//! * `declarations`, `implied_integers` - columns that may be taken as whole, or as 0
//! * `block_lemmas` - independent blocks one by one
//! * `switched`, `zero_products` - products that make squares tighter, and are 0 at every point
//! * `simple_sums` - sums whose terms cancel exactly
//! * `repaired_sums`, `pivoted_solution` - sums with signs that rounding has turned
//! * `tree`, `guide`, `guided_splits`, `split_places`, `whole_splits`, `search` - the splits, those
//!   of the search first
//! * `boxes` - programs with functions, box by box
//! * `log` - the text

mod aggregated_row;
mod block_lemmas;
mod bounds;
#[cfg(feature = "nonlinear")]
mod boxes;
mod case_bounds;
mod claim;
mod cones;
mod conjugate_gradients;
mod convexity;
mod curvature_bounds;
mod declarations;
mod facts;
mod guide;
mod guided_splits;
mod implied_integers;
mod lemma;
mod log;
mod pivoted_solution;
mod presolved_cuts;
mod reduced_costs;
mod relaxed;
mod repaired_sums;
mod root;
mod search;
mod simple_sums;
mod split_places;
mod strengthened;
mod switched;
mod tightened;
mod tree;
mod whole_splits;
mod zero_products;

use std::io::{self, Write};
use std::rc::Rc;

use crate::program::Program;
use crate::relaxation::CascadePool;
use crate::solution::ProofReport;
use crate::solver::{Options, StopToken};
pub(crate) use block_lemmas::count_blocks;
use bounds::Bounds;
#[cfg(feature = "nonlinear")]
pub(crate) use boxes::BoxProofRequest;
pub(crate) use claim::Claim;
use facts::Facts;
pub(crate) use guide::Guide;
use log::{Names, ProofLog};
use relaxed::Relaxer;
use tree::ProofWriter;

/// A proof that is asked for.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ProofRequest<'a> {
    /// The lowered program.
    pub(crate) program: &'a Program,
    /// Multiples of `z^2 - z`, of columns between 0 and 1, that make an objective convex which is
    /// not; `None` if none do.
    pub(crate) squares: Option<&'a [(usize, f64)]>,
    /// The names of its columns and of its rows, as far as there are any.
    pub(crate) names: [&'a [String]; 2],
    pub(crate) claim: Claim,
    pub(crate) options: &'a Options,
    /// Ends the proof when it is over.
    pub(crate) token: &'a StopToken,
    /// Splits besides those of the search.
    pub(crate) most_splits: u64,
    pub(crate) cascades: &'a CascadePool,
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
        let bound = match self.claim {
            Claim::Bound(bound) => Some(self.program.sign * bound + 0.0),
            Claim::Infeasible => None,
        };
        let mut report = self.prove_claim(guide, point, out)?;
        report.bound = bound;
        Ok(report)
    }

    fn prove_claim(
        self,
        guide: Guide,
        point: Option<&[f64]>,
        out: &mut dyn Write,
    ) -> io::Result<ProofReport> {
        let ProofRequest {
            program,
            squares,
            names: [columns, rows],
            claim,
            options,
            token,
            most_splits,
            cascades,
        } = self;
        let mut log = ProofLog::new(out, program, &Names { columns, rows, functions: &[] }, claim);
        if let Some(point) = point {
            log.point(point);
        }
        let squares = if claim == Claim::Infeasible { Some(&[][..]) } else { squares };
        let Some(squares) = squares else {
            log.remark("the objective is not convex, and no products that are 0 make it so");
            let (commands, bytes) = log.abandon()?;
            return Ok(ProofReport::new(false, commands, bytes));
        };
        let facts = Facts::new(program);
        let bounds = Bounds::new(program);
        let mut program = program.clone();
        if claim == Claim::Infeasible {
            program.make_feasibility_problem();
        }
        let relaxer = Relaxer::new(program, claim, (options, token), cascades);
        let mut writer = ProofWriter {
            log: &mut log,
            facts,
            bounds,
            relaxer,
            squares,
            splits_left: most_splits,
            trial_left: None,
            lemma_splits: 0,
            lemma_fact: 0,
            lemma_cases: Vec::new(),
            guide: Rc::new(guide),
            gaps: 0,
        };
        let result = writer.run(point);
        let gaps = writer.gaps;
        cascades.give_back(writer.relaxer.cascade);
        if result.is_err() {
            log.remark("a limit came before the end of the proof");
            let (commands, bytes) = log.abandon()?;
            return Ok(ProofReport::new(false, commands, bytes));
        }
        let (commands, bytes) = log.finish()?;
        Ok(ProofReport::new(gaps == 0, commands, bytes))
    }
}
