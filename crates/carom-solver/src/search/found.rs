//! The result of a search.

use super::comparison::Contradiction;
use super::cuts::KeptFacets;
use super::node::{Decision, Path};
use super::root_point::RootCuts;
use super::saved_tree::{SavedDuals, SavedSplit};
use super::start::Completion;
use crate::relaxation::ConeCut;
use crate::solution::{Heuristic, Statistics, Termination};

/// The result of a search. Objective values are those of the minimised program.
#[derive(Debug, Clone)]
pub struct SearchResult {
    /// Why it stopped.
    pub termination: Termination,
    /// The best accepted points, best first.
    pub points: Vec<Vec<f64>>,
    /// The heuristic that found the best one.
    pub(crate) found_by: Option<Heuristic>,
    /// Whether a visible part of the value of a point is due to limits that presolve has widened
    /// for rounding.
    pub is_widened: bool,
    /// The part of the strengthened program that an accepted point contradicts, if there is one.
    /// Then no bound is known.
    pub contradiction: Option<Contradiction>,
    /// Whether these are proved to be the best ones.
    pub pool_complete: bool,
    /// Proved lower bound; `+inf` when infeasible.
    pub bound: f64,
    /// Counters; the caller sets the time.
    pub statistics: Statistics,
    /// The ends of the tree, if they were asked for.
    pub leaves: Vec<ClosedNode>,
    /// The multipliers that closed nodes, if they are to be kept.
    pub(crate) duals: Vec<SavedDuals>,
    /// The splits of nodes, if they are to be kept.
    pub(crate) splits: Vec<SavedSplit>,
    /// The part of the gap between the relaxed root and the best point that cuts and tighter costs
    /// have closed, if they were tried.
    pub(crate) strengthened: Option<f64>,
    /// The cuts of the root, if a proof wants to know them.
    pub(crate) root_cuts: Option<Box<RootCuts>>,
    /// The cuts of cones that the program began with.
    pub(crate) cone_cuts: Vec<ConeCut>,
    /// The facets that the search has begun again with.
    pub(crate) facets: Option<KeptFacets>,
    /// The outcome of completing the integers of a start, if that was tried.
    pub completion: Option<Completion>,
}

/// An end of the tree: refuted, cut off, solved, or still open.
#[derive(Debug, Clone)]
pub struct ClosedNode {
    /// The decisions on the way from the root, in any order.
    pub decisions: Vec<Decision>,
    /// The bound proved for it.
    pub bound: f64,
}

impl ClosedNode {
    pub(super) fn new(path: &Path, bound: f64) -> Self {
        ClosedNode { decisions: path.backwards().collect(), bound }
    }
}

impl SearchResult {
    /// The answer if a limit came before the search.
    pub fn stopped(reason: Termination) -> Self {
        SearchResult {
            termination: reason,
            pool_complete: false,
            bound: f64::NEG_INFINITY,
            ..SearchResult::infeasible()
        }
    }

    /// The answer if infeasibility was proved without a search.
    pub fn infeasible() -> Self {
        SearchResult {
            termination: Termination::Infeasible,
            points: Vec::new(),
            found_by: None,
            contradiction: None,
            is_widened: false,
            pool_complete: true,
            bound: f64::INFINITY,
            statistics: Statistics::default(),
            leaves: Vec::new(),
            duals: Vec::new(),
            splits: Vec::new(),
            strengthened: None,
            root_cuts: None,
            cone_cuts: Vec::new(),
            facets: None,
            completion: None,
        }
    }
}
