//! The data that a prepared model keeps from solve to solve: the integers of the best point, and
//! the tree with the multipliers that closed its ends, and the cuts of cones and the facets that it
//! began with.
//!
//! The integers are a start for the next solve: fixed, completed and verified like any other point.
//! The tree is gone through again, and the bounds of the multipliers are proved anew. Nothing is
//! trusted, so the integers may be moved in time by no more than the names of variables.

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::model::Name;
use crate::relaxation::ConeCut;
use crate::search::cuts::KeptFacets;
use crate::search::{SavedDuals, SavedSplit, SavedTree, SearchResult, Start};
use crate::solution::Termination;

/// Least part of the gap between the root and the best point that cuts and tighter costs must
/// close: else the tree of the last solve, which is gone through again, saves more than they do (no
/// unit).
const LEAST_CLOSED: f64 = 0.5;

/// Solves without cuts after the first one in which they closed less; twice as many after each
/// further one in a row, as often as the second number says.
const SOLVES_WITHOUT_CUTS: u32 = 15;
const MOST_DOUBLINGS: u32 = 6;

/// Fewest nodes of the last solve after which the program is tightened for the values of the
/// parameters, as without preparation; that costs as much as a few nodes.
const FEW_NODES: u64 = 3;

/// The data kept from the last solves of a prepared model; columns and rows are those of the
/// program.
#[derive(Debug, Default)]
pub(super) struct LastSolve {
    /// Values of integral columns at the last point that was found, the earliest steps first.
    integers: Vec<(usize, f64)>,
    duals: Vec<SavedDuals>,
    splits: Vec<SavedSplit>,
    /// The cuts of cones that the search began with: they hold for all values of the parameters.
    cone_cuts: Vec<ConeCut>,
    /// The facets that a search has begun again with: their limits are proved anew.
    facets: Option<KeptFacets>,
    /// By column, where the same variable of the next step is, or the column itself.
    next: Vec<usize>,
    /// Solves until cuts are tried again.
    without_cuts: u32,
    /// Solves in a row in which cuts were tried and closed too little.
    idle_cuts: u32,
    /// Nodes of the last solve.
    nodes: Option<u64>,
    /// Whether a limit ended the last solve: then the time for nodes and points is short.
    stopped: bool,
}

impl LastSolve {
    /// For a program whose columns have these names.
    pub(super) fn new(columns: &[&Name]) -> Self {
        LastSolve { next: next_of(columns), ..LastSolve::default() }
    }

    /// The start that the last solve leaves for the next one.
    pub(super) fn start(&self) -> Start {
        let saved_tree = Some(Arc::new(SavedTree::new(&self.duals, &self.splits)));
        Start { integers: self.integers.clone(), saved_tree, ..Start::default() }
    }

    /// The cuts of cones to begin with.
    pub(super) fn cone_cuts(&self) -> &[ConeCut] {
        &self.cone_cuts
    }

    /// The facets to begin with.
    pub(super) fn facets(&self) -> Option<&KeptFacets> {
        self.facets.as_ref()
    }

    /// Whether cuts are not worth their time.
    pub(super) fn skips_cuts(&self) -> bool {
        self.without_cuts > 0 || self.stopped
    }

    /// Whether tightening for all values of the parameters is enough, because the next tree is
    /// likely to be small or because there is no time for more.
    pub(super) fn expects_few_nodes(&self) -> bool {
        self.stopped || self.nodes.is_some_and(|nodes| nodes < FEW_NODES)
    }

    /// Takes in the result of a solve.
    ///
    /// # Arguments
    ///
    /// * `point`: the best point in columns of the program, if there is one.
    /// * `order`: the integral columns, the earliest steps first.
    pub(super) fn take_in(
        &mut self,
        found: &mut SearchResult,
        point: Option<&[f64]>,
        order: &[usize],
    ) {
        // A search that was stopped before its first split has nothing new to say.
        let ended = matches!(found.termination, Termination::Optimal | Termination::Infeasible);
        let nodes = found.statistics.nodes;
        if ended || !found.splits.is_empty() {
            self.duals = std::mem::take(&mut found.duals);
            self.splits = std::mem::take(&mut found.splits);
        }
        if !found.cone_cuts.is_empty() {
            self.cone_cuts = std::mem::take(&mut found.cone_cuts);
        }
        if found.facets.is_some() {
            self.facets = found.facets.take();
        }
        match found.strengthened {
            Some(closed) if closed >= LEAST_CLOSED => (self.without_cuts, self.idle_cuts) = (0, 0),
            Some(_) => {
                self.without_cuts = SOLVES_WITHOUT_CUTS << self.idle_cuts.min(MOST_DOUBLINGS);
                self.idle_cuts += 1;
            }
            None => self.without_cuts = self.without_cuts.saturating_sub(1),
        }
        self.nodes = Some(nodes);
        self.stopped = found.termination.is_limit();
        // A search without a point has nothing better to say than the last point.
        if let Some(point) = point {
            self.integers.clear();
            self.integers.extend(order.iter().map(|&j| (j, point[j].round())));
        }
    }

    /// Moves the integers one step ahead; the last step keeps its values. The tree stays: a step
    /// later most programs differ by little more than their parameters.
    pub(super) fn shift(&mut self) {
        let values: BTreeMap<usize, f64> = self.integers.iter().copied().collect();
        for (j, value) in &mut self.integers {
            *value = values.get(&self.next[*j]).copied().unwrap_or(*value);
        }
    }
}

/// For each name, the place of the same name in the next step, or its own place if there is none.
pub(super) fn next_of(names: &[&Name]) -> Vec<usize> {
    let place = |(k, name): (usize, &&Name)| Some(((name.family().to_owned(), name.step()?), k));
    let places: BTreeMap<(String, usize), usize> =
        names.iter().enumerate().filter_map(place).collect();
    let next = |name: &Name| places.get(&(name.family().to_owned(), name.step()? + 1)).copied();
    names.iter().enumerate().map(|(k, name)| next(name).unwrap_or(k)).collect()
}
