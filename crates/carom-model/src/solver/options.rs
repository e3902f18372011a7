//! Options that every backend understands.

use std::path::{Path, PathBuf};

use web_time::Duration;

use super::heuristics::Heuristics;
use super::relaxation_method::RelaxationMethod;
use super::rules::BranchingRule;
use crate::error::Error;
use crate::setters;
use crate::tolerance;

/// Options that every backend understands.
///
/// Made by `Options::default()` (the same as [`balanced`](Options::balanced)),
/// [`fast`](Options::fast) or [`precise`](Options::precise), and changed by the `with_...` methods
/// or the public fields.
///
/// | option | unit, range | default | `fast` | `precise` | evidence for the default |
/// | --- | --- | --- | --- | --- | --- |
/// | `relative_gap` | none, `>= 0` | 1e-6 | 1e-3 | 1e-7 | decisions, *Presets* |
/// | `absolute_gap` | objective's, `>= 0` | 1e-7 | 1e-7 | 1e-7 | decisions, *Presets* |
/// | `feasibility` | none, `1e-9..=1e-3` | 1e-6 | 1e-6 | 1e-6 | [`tolerance::FEASIBILITY`] |
/// | `integrality` | none, `1e-9..=1e-2` | 1e-6 | 1e-6 | 1e-6 | [`tolerance::INTEGRALITY`] |
/// | `time_limit` | wall-clock time | none | none | none | |
/// | `node_limit` | nodes | none | none | none | |
/// | `memory_limit` | bytes of the tree | none | none | none | decisions, *Nodes share their ancestors* |
/// | `threads` | threads, `1..=256` | 1 | all | 1 | decisions, *One queue for all threads* |
/// | `deterministic` | on or off | off | off | on | decisions, *Deterministic rounds* |
/// | `pool` | points, `1..=100_000` | 1 | 1 | 1 | |
/// | `pool_mode` | [`PoolMode`] | `Found` | `Found` | `Found` | `Best` visits more nodes |
/// | `pool_gap` | none, `>= 0`, or none | none | none | none | |
/// | `branching` | [`BranchingRule`] | `Automatic` | `Automatic` | `Automatic` | decisions, *The latest step first* |
/// | `relaxation` | [`RelaxationMethod`] | `Automatic` | `Automatic` | `Automatic` | benchmarks, *Relaxations by either method* |
/// | `cuts` | on or off | on | on | on | decisions, *Cuts at the root* |
/// | `heuristics` | [`Heuristics`] | all | all | all | decisions, *Heuristics are paid from allowances* |
///
/// "Decisions" is `docs/decisions.md` in the repository, "benchmarks" is `docs/benchmarks.md`.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default))]
pub struct Options {
    /// Relative gap at which to stop (no unit, `>= 0`); default
    /// [`tolerance::RELATIVE_GAP`]. The search stops when this or the absolute gap is met. It is
    /// relative to the objective with or without its constant, whichever is smaller.
    pub relative_gap: f64,
    /// Absolute gap at which to stop (objective's unit, `>= 0`); default
    /// [`tolerance::ABSOLUTE_GAP`].
    pub absolute_gap: f64,
    /// Absolute feasibility tolerance of rows and bounds, in their units (`1e-9..=1e-3`); default
    /// [`tolerance::FEASIBILITY`].
    pub feasibility: f64,
    /// Integrality tolerance of relaxations (`1e-9..=1e-2`); default
    /// [`tolerance::INTEGRALITY`].
    pub integrality: f64,
    /// Wall-clock limit of one solve; default none. What solves many programs, such as a search for
    /// the shortest horizon, has a limit for all of them, `ShortestOptions::time_limit`; this one
    /// then holds for each.
    pub time_limit: Option<Duration>,
    /// Limit on the nodes of one solve; default none.
    pub node_limit: Option<u64>,
    /// Limit on the bytes of the tree; default none. It covers what grows with the search: open
    /// nodes, the bound changes that they share, and the best points. It does not
    /// cover the model, its matrices and the factors of relaxations. From half of the limit on, the
    /// search (except in deterministic mode) goes depth-first to keep few nodes open.
    pub memory_limit: Option<u64>,
    /// Threads of the tree search (`1..=256`); default 1. With one thread a solve is deterministic,
    /// unless a time limit or an interrupt ends it. Helpers start only if there are nodes for them.
    /// Backends and targets without threads use one.
    pub threads: usize,
    /// Whether to search in rounds, so that nodes, counts and answer are the same for any number of
    /// threads, unless a time limit or an interrupt ends the search. Default off: threads exchange
    /// results at once. Rounds use at most 8 threads.
    pub deterministic: bool,
    /// How many points with distinct values of the integers to keep in
    /// [`Solution::pool`](crate::solution::Solution::pool) (`1..=100_000`); default 1.
    pub pool: usize,
    /// Which points those are; default [`PoolMode::Found`].
    pub pool_mode: PoolMode,
    /// How much worse than the best point a point of the pool may be, relative to the magnitude of
    /// the best objective (no unit, `>= 0`). Default none, which allows any point.
    pub pool_gap: Option<f64>,
    /// How nodes are split; default [`BranchingRule::Automatic`].
    pub branching: BranchingRule,
    /// Which method solves the relaxations of the search; default
    /// [`RelaxationMethod::Automatic`]. The linear programs behind Ms are solved by the default.
    pub relaxation: RelaxationMethod,
    /// Whether the root relaxation is made tighter if that improves its bound: by cuts, and by
    /// perspectives of squares that binaries switch off; default on. Left out if
    /// leaves are kept.
    pub cuts: bool,
    /// The primal heuristics; default [`Heuristics::default`].
    pub heuristics: Heuristics,
    /// Where a solve writes its proof; default none, which writes none. See
    /// [`with_proof`](Options::with_proof).
    pub proof: Option<PathBuf>,
    /// Parts of a solve beside the search, for tests and ablations.
    #[cfg_attr(feature = "serde", serde(flatten))]
    pub(crate) parts: SearchParts,
}

/// Parts of a solve beside the search, each done or left out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default))]
pub struct SearchParts {
    /// Whether to keep the leaves of the tree in
    /// [`Solution::leaves`](crate::solution::Solution::leaves): boxes that cover all assignments of
    /// the integers, with a proved bound each; default off.
    pub keep_leaves: bool,
    /// Whether presolve reduces the program before the search: its rules remove rows and columns,
    /// tighten bounds and shrink coefficients; default on. Not used if leaves are kept, because
    /// these refer to the original columns. For the best points, with a MIP start and with lazy
    /// constraints, only rules are used that keep all assignments of the integers. MIP starts are
    /// mapped through it.
    pub reductions: bool,
    /// Whether presolve tightens bounds by propagating every case of a covering row
    /// `z_1 + ... + z_k >= 1` (constructive disjunction); default on. Left
    /// out if leaves are kept.
    pub disjunctive_tightening: bool,
    /// Whether presolve shrinks big-Ms to what other rows over the same columns allow; default on.
    /// Left out if leaves are kept.
    pub big_m_tightening: bool,
    /// Whether binaries are probed: tried at both values by propagation alone, at the root and at
    /// the nodes, to exclude values before a relaxation is solved; default on.
    pub probing: bool,
    /// Whether parts of the program without a common row are searched one after the other; default
    /// on. Not used without presolve, for pools and leaves, or with a MIP start.
    pub blocks: bool,
    /// Nodes after which a search looks for facets of unions for the first time, to begin again if
    /// these lift its root above the bound of its tree; default 500. With 0 it begins again with
    /// all facets that are found, and with `u64::MAX` it never looks. Not used without cuts.
    pub facet_nodes: u64,
}

impl Default for SearchParts {
    fn default() -> Self {
        SearchParts {
            keep_leaves: false,
            reductions: true,
            disjunctive_tightening: true,
            big_m_tightening: true,
            probing: true,
            blocks: true,
            facet_nodes: 500,
        }
    }
}

/// Which points a pool holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum PoolMode {
    /// The best points that the search for the optimum finds, without further search.
    #[default]
    Found,
    /// The best points of the model: the search continues until no other assignment of the integers
    /// is better than the worst point of the pool by more than the gap.
    Best,
}

impl Default for Options {
    fn default() -> Self {
        Options {
            relative_gap: tolerance::RELATIVE_GAP,
            absolute_gap: tolerance::ABSOLUTE_GAP,
            feasibility: tolerance::FEASIBILITY,
            integrality: tolerance::INTEGRALITY,
            time_limit: None,
            node_limit: None,
            memory_limit: None,
            threads: 1,
            deterministic: false,
            pool: 1,
            pool_mode: PoolMode::Found,
            pool_gap: None,
            branching: BranchingRule::Automatic,
            relaxation: RelaxationMethod::Automatic,
            cuts: true,
            heuristics: Heuristics::default(),
            proof: None,
            parts: SearchParts::default(),
        }
    }
}

impl Options {
    /// A good point soon: a relative gap of 0.1 %, and one thread per processor.
    #[inline]
    pub fn fast() -> Self {
        let threads = std::thread::available_parallelism().map_or(1, usize::from).min(256);
        Options { relative_gap: 1e-3, threads, ..Options::default() }
    }

    /// The default.
    #[inline]
    pub fn balanced() -> Self {
        Options::default()
    }

    /// A smaller gap, and reproducible: a relative gap of 1e-7, and the same search on any number
    /// of threads. Relaxations are accurate to about 1e-8, so much smaller gaps cannot be proved.
    #[inline]
    pub fn precise() -> Self {
        Options { relative_gap: 1e-7, deterministic: true, ..Options::default() }
    }

    /// The options of a nested search: one thread, one point, no leaves.
    #[doc(hidden)]
    pub fn nested(&self) -> Self {
        Options {
            threads: 1,
            deterministic: false,
            memory_limit: None,
            pool: 1,
            pool_mode: PoolMode::Found,
            pool_gap: None,
            parts: SearchParts { keep_leaves: false, ..self.parts },
            heuristics: self.heuristics.nested(),
            proof: None,
            ..self.clone()
        }
    }

    setters! {
        /// Sets the relative gap.
        #[doc(alias("MIP gap", "optimality gap"))]
        with_relative_gap(gap: f64) => relative_gap = gap;
        /// Sets the absolute gap.
        with_absolute_gap(gap: f64) => absolute_gap = gap;
        /// Sets the time limit of a solve.
        #[doc(alias("time limit", "timeout"))]
        with_time_limit(limit: Duration) => time_limit = Some(limit);
        /// Sets the node limit.
        with_node_limit(limit: u64) => node_limit = Some(limit);
        /// Sets the number of threads.
        with_threads(threads: usize) => threads = threads;
        /// Sets the memory limit, in bytes.
        with_memory_limit(bytes: u64) => memory_limit = Some(bytes);
        /// Sets whether to search in rounds, the same for any number of threads.
        with_deterministic(deterministic: bool) => deterministic = deterministic;
    }

    /// The parts of a solve beside the search.
    #[doc(hidden)]
    #[inline]
    pub fn parts(&self) -> &SearchParts {
        &self.parts
    }

    /// The parts of a solve beside the search, for changes.
    #[doc(hidden)]
    #[inline]
    pub fn parts_mut(&mut self) -> &mut SearchParts {
        &mut self.parts
    }

    /// Whether a solve may be stopped by a limit of time or nodes.
    #[doc(hidden)]
    #[inline]
    pub fn may_stop(&self) -> bool {
        self.time_limit.is_some() || self.node_limit.is_some()
    }

    /// Sets how many points to keep, and which.
    #[must_use]
    pub fn with_pool(mut self, points: usize, mode: PoolMode) -> Self {
        (self.pool, self.pool_mode) = (points, mode);
        self
    }

    setters! {
        /// Keeps only points within a relative gap of the best one.
        with_pool_gap(gap: f64) => pool_gap = Some(gap);
        #[doc(hidden)]
        with_leaves(keep: bool) => parts.keep_leaves = keep;
        /// Sets the branching rule.
        with_branching(rule: BranchingRule) => branching = rule;
        /// Sets the method that solves the relaxations.
        with_relaxation(method: RelaxationMethod) => relaxation = method;
        #[doc(hidden)]
        with_reductions(reductions: bool) => parts.reductions = reductions;
        #[doc(hidden)]
        with_disjunctive_tightening(tightening: bool) => parts.disjunctive_tightening = tightening;
        #[doc(hidden)]
        with_big_m_tightening(tightening: bool) => parts.big_m_tightening = tightening;
        #[doc(hidden)]
        with_probing(probing: bool) => parts.probing = probing;
        #[doc(hidden)]
        with_blocks(blocks: bool) => parts.blocks = blocks;
        #[doc(hidden)]
        with_facet_nodes(nodes: u64) => parts.facet_nodes = nodes;
        /// Sets whether cuts are added to the root relaxation.
        with_cuts(cuts: bool) => cuts = cuts;
        /// Sets the primal heuristics.
        with_heuristics(heuristics: Heuristics) => heuristics = heuristics;
    }

    /// Has each solve write a proof of its bound, or of its infeasibility, that another program can
    /// check: to this file, or, if the path is a folder, to a new file in it. What a proof says,
    /// and who checks it, is on the guide's page on proofs.
    /// [`Solution::proof`](crate::solution::Solution::proof) reports on it, and is `None` where
    /// none was written: of an answer without a bound, by other backends than `BranchAndBound`, and
    /// on WebAssembly.
    ///
    /// A search for a shortest horizon takes the path as a folder, makes it if it is missing, and
    /// writes a log for each horizon instead, see `ShortestHorizon::proofs`. Plans over a fixed
    /// horizon take nothing from reach sets then, except in the bounds of a program that was
    /// tightened by them already.
    ///
    /// The search is the same, except that it does not fall into blocks where the objective has
    /// squares or presolve has made the blocks, and that a prepared model is solved as if it were
    /// not prepared. The proof comes after it, and may take as long again: a time limit holds for
    /// each of the two. Lazy constraints and user cuts that were found are rows of the program in
    /// the proof. Of a pool, the proof is about the best point.
    #[must_use]
    pub fn with_proof(mut self, path: impl Into<PathBuf>) -> Self {
        self.proof = Some(path.into());
        self
    }

    /// Sets whether the program is presolved before the search; default on. Presolve removes rows
    /// and columns, tightens bounds and makes big-Ms smaller. It is left out if leaves are kept,
    /// because these refer to the original columns. For a pool of the best points, with a MIP start
    /// and with lazy constraints it is left to rules that keep all assignments of the integers.
    #[must_use]
    pub fn with_presolve(mut self, presolve: bool) -> Self {
        self.parts.reductions = presolve;
        self.parts.disjunctive_tightening = presolve;
        self.parts.big_m_tightening = presolve;
        self
    }

    /// Sets whether a search that has closed little of the gap after 500 nodes looks for facets of
    /// the unions in its program, such as the modes of a step, and begins again if these lift the
    /// relaxed root above all that its nodes have proved; default on. It is left out without cuts,
    /// for pools and kept leaves, with lazy constraints, and without an objective. A prepared model
    /// keeps the facets for its next solve. How many there are, and what they lift, is in
    /// [`Statistics::facets`](crate::solution::Statistics::facets).
    #[must_use]
    pub fn with_facets(mut self, facets: bool) -> Self {
        self.parts.facet_nodes = if facets { SearchParts::default().facet_nodes } else { u64::MAX };
        self
    }

    /// Where to write proofs; none on WebAssembly, which has no files.
    #[doc(hidden)]
    #[inline]
    pub fn proof_path(&self) -> Option<&Path> {
        self.proof.as_deref().filter(|_| cfg!(not(target_family = "wasm")))
    }

    /// How far the bound may be from an objective, in the objective's unit.
    ///
    /// # Arguments
    ///
    /// * `constant`: the constant of the objective.
    #[doc(hidden)]
    #[inline]
    pub fn allowed_gap(&self, objective: f64, constant: f64) -> f64 {
        self.absolute_gap.max(self.relative_gap * tolerance::gap_scale(objective, constant))
    }

    /// Refuses values outside their ranges; every backend calls it first.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::OutOfRange`](crate::error::ErrorKind::OutOfRange), naming the option.
    pub fn check(&self) -> Result<(), Error> {
        let named = |what: &str| format!("option `{what}`");
        let gap = |what: &str, value: f64| match 0.0..f64::INFINITY {
            range if range.contains(&value) => Ok(()),
            range => {
                let words = "finite and not negative";
                Err(Error::out_of_range_in_words(named(what), value, range, words))
            }
        };
        let range = |what: &str, value: f64, low: f64, high: f64| match low..=high {
            range if range.contains(&value) => Ok(()),
            range => Err(Error::out_of_range(named(what), value, range)),
        };
        gap("relative_gap", self.relative_gap)?;
        gap("absolute_gap", self.absolute_gap)?;
        range("feasibility", self.feasibility, 1e-9, 1e-3)?;
        range("integrality", self.integrality, 1e-9, 1e-2)?;
        range("threads", self.threads as f64, 1.0, 256.0)?;
        range("pool", self.pool as f64, 1.0, 1e5)?;
        gap("pool_gap", self.pool_gap.unwrap_or(0.0))
    }
}
