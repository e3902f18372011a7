//! The input and the output of a solve.

use super::lower::LoweredProgram;
use super::multipliers::Derivatives;
use super::refusals::Refusals;
use super::row_judge::RowJudge;
use super::tighten::Tightened;
use crate::model::Model;
use crate::presolve::root::Origins;
use crate::relaxation::{CascadePool, ConeCut};
use crate::search::cuts::KeptFacets;
use crate::search::{SearchResult, Start};
use crate::solution::ProofReport;
use crate::solver::{Options, StopToken};

/// The model of a solve, with the data that its phases share.
#[derive(Clone, Copy)]
pub(super) struct Solve<'a> {
    pub(super) model: &'a Model,
    pub(super) options: &'a Options,
    pub(super) token: &'a StopToken,
    pub(super) cascades: &'a CascadePool,
    pub(super) refusals: &'a Refusals,
    /// The judge of points by rows that are found while the program is searched.
    pub(super) rows: Option<&'a RowJudge<'a>>,
}

/// The results of earlier phases and solves, from which a solve can go on.
#[derive(Clone, Copy, Default)]
pub(super) struct EarlierResults<'a> {
    /// The lowered program, with the values of the parameters.
    pub(super) lowered: Option<&'a LoweredProgram>,
    /// Whether that program is presolved.
    pub(super) is_presolved: bool,
    /// The tightened program and its root, within the bounds of the program.
    pub(super) tightened: Option<&'a Tightened<'a>>,
    /// The start of the search, in columns of the program at hand.
    pub(super) start: Option<&'a Start>,
    /// The cuts of cones that an earlier solve began with, in columns of the program at hand.
    pub(super) cone_cuts: &'a [ConeCut],
    /// Whether cuts are not worth their time.
    pub(super) skips_cuts: bool,
    /// The facets that an earlier solve has begun again with, in columns and rows of the program at
    /// hand.
    pub(super) facets: Option<&'a KeptFacets>,
}

/// The result of a solve.
pub(super) struct SolveResult {
    /// The result of the search; its points are values of the model's variables.
    pub(super) found: SearchResult,
    /// Multipliers of the lowered model, if it has no integers.
    pub(super) derivatives: Option<Derivatives>,
    /// The best point in columns of the presolved program.
    pub(super) point: Option<Vec<f64>>,
    /// The best point in columns of the lowered program, if a proof is asked for.
    pub(super) lowered_point: Option<Vec<f64>>,
    /// The proof that was written.
    pub(super) proof: Option<ProofReport>,
    /// Where the presolved program comes from in the lowered one, if a proof is asked for and there
    /// was presolve.
    pub(super) origins: Option<Origins>,
}

impl SolveResult {
    /// A result without a point.
    pub(super) fn without_point(found: SearchResult) -> Self {
        SolveResult {
            found,
            derivatives: None,
            point: None,
            lowered_point: None,
            proof: None,
            origins: None,
        }
    }
}
