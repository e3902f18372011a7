//! Options that every backend understands.

use web_time::Duration;

use super::heuristics::Heuristics;
use super::rules::BranchingRule;
use crate::error::{Error, ErrorKind};
use crate::tolerance;

/// Options that every backend understands.
///
/// Made by `Options::default()` (the same as [`balanced`](Options::balanced)), [`fast`](Options::fast)
/// or [`proof`](Options::proof), and changed by the `with_...` methods or the public fields.
///
/// | option | unit, range | default | `fast` | `proof` | evidence for the default |
/// | --- | --- | --- | --- | --- | --- |
/// | `relative_gap` | none, `>= 0` | 1e-6 | 1e-3 | 1e-7 | decisions, *Presets* |
/// | `absolute_gap` | objective's, `>= 0` | 1e-7 | 1e-7 | 1e-7 | decisions, *Presets* |
/// | `feasibility` | none, `1e-9..=1e-3` | 1e-6 | 1e-6 | 1e-6 | [`tolerance::FEASIBILITY`] |
/// | `integrality` | none, `1e-9..=1e-2` | 1e-6 | 1e-6 | 1e-6 | [`tolerance::INTEGRALITY`] |
/// | `time_limit` | wall-clock time | none | none | none | |
/// | `node_limit` | nodes | none | none | none | |
/// | `memory_limit` | bytes of the tree | none | none | none | decisions, *Nodes share their ancestors* |
/// | `threads` | threads, `1..=256` | 1 | all | 1 | decisions, *Work-stealing deques and one queue* |
/// | `deterministic` | on or off | off | off | on | decisions, *Deterministic rounds* |
/// | `pool` | points, `1..=100_000` | 1 | 1 | 1 | |
/// | `pool_mode` | [`PoolMode`] | `Found` | `Found` | `Found` | `Best` visits more nodes |
/// | `pool_gap` | none, `>= 0`, or none | none | none | none | |
/// | `keep_leaves` | on or off | off | off | off | costs memory |
/// | `branching` | [`BranchingRule`] | `Automatic` | `Automatic` | `Automatic` | decisions, *Event windows* |
/// | `symmetry` | on or off | off | off | off | decisions, *Symmetry* |
/// | `conflicts` | on or off | off | off | off | decisions, *Conflicts* |
/// | `presolve` | on or off | on | on | on | decisions, *Presolve is a list of rules* |
/// | `probing` | on or off | on | on | on | decisions, *Probing at every node* |
/// | `blocks` | on or off | on | on | on | decisions, *Blocks are searched one after the other* |
/// | `cuts` | on or off | on | on | on | decisions, *Cuts at the root* |
/// | `heuristics` | [`Heuristics`] | all but local branching | all | as default | decisions, *Heuristics are paid from allowances* |
///
/// "Decisions" is `docs/decisions.md` in the repository.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default))]
pub struct Options {
    /// Relative gap at which to stop (no unit, `>= 0`); default
    /// [`tolerance::RELATIVE_GAP`]. The search stops when this or the absolute gap is met.
    pub relative_gap: f64,
    /// Absolute gap at which to stop (objective's unit, `>= 0`); default
    /// [`tolerance::ABSOLUTE_GAP`].
    pub absolute_gap: f64,
    /// Feasibility tolerance of rows and bounds (`1e-9..=1e-3`); default
    /// [`tolerance::FEASIBILITY`].
    pub feasibility: f64,
    /// Integrality tolerance of relaxations (`1e-9..=1e-2`); default
    /// [`tolerance::INTEGRALITY`].
    pub integrality: f64,
    /// Wall-clock limit; default none.
    pub time_limit: Option<Duration>,
    /// Limit on nodes; default none.
    pub node_limit: Option<u64>,
    /// Limit on the bytes of the tree; default none. What counts is what grows with the search:
    /// open nodes, the changes of bounds that they share, kept leaves, and the best points. The model,
    /// its matrices and the factors of relaxations have a size of their own and do not count. From
    /// half of the limit on, the search (but the deterministic one) goes into the depth to leave few
    /// nodes open.
    pub memory_limit: Option<u64>,
    /// Threads of the tree search (`1..=256`); default 1. With one thread a solve is
    /// deterministic, unless a time limit or an interrupt ends it. Helpers start only when there
    /// are nodes for them. Backends that have no threads, and targets without them, use one.
    pub threads: usize,
    /// Search in rounds, so that nodes, counts and answer are the same for any number of threads
    /// (unless a time limit or an interrupt ends the search); default off: threads exchange what
    /// they find at once. More than 8 threads are of no use to rounds.
    pub deterministic: bool,
    /// How many points with distinct values of the integers to keep in
    /// [`Solution::pool`](crate::solution::Solution::pool) (`1..=100_000`); default 1.
    pub pool: usize,
    /// Which points those are; default [`PoolMode::Found`].
    pub pool_mode: PoolMode,
    /// How much worse than the best point a point of the pool may be, relative to the magnitude of
    /// the best objective (no unit, `>= 0`); default none: any point.
    pub pool_gap: Option<f64>,
    /// Keep the ends of the tree in [`Solution::leaves`](crate::solution::Solution::leaves), for a
    /// [`TreeSeed`](crate::solver::TreeSeed); default off.
    pub keep_leaves: bool,
    /// Which column a node is split on; default [`BranchingRule::Automatic`].
    pub branching: BranchingRule,
    /// Whether interchangeable columns are asked for falling values; default off. It is left out where
    /// a pool or leaves are kept, or points come from a seed or from guidance.
    pub symmetry: bool,
    /// Whether the search learns from nodes and trials that propagation refutes: which bounds of
    /// integers cannot hold together; default off. Each thread learns for itself.
    pub conflicts: bool,
    /// Whether the program is presolved before the search; default on. It is left out where a pool or
    /// leaves are kept, the leaves of a seed are given, or splits come from guidance: these speak of
    /// the columns as they are. Guesses, proposed points and priorities go through it.
    pub presolve: bool,
    /// Whether binaries are tried at both values by propagation alone, at the root and at the nodes, so
    /// that values that cannot be are left out before a relaxation is solved; default on.
    pub probing: bool,
    /// Whether parts of the program without a common row are searched one after the other; default
    /// on. Left out where presolve is, and where there is a seed or guidance.
    pub blocks: bool,
    /// Whether cuts are added to the root relaxation where they lift its bound; default on. Left out
    /// where presolve is.
    pub cuts: bool,
    /// Which heuristics may look for points; default [`Heuristics::default`].
    pub heuristics: Heuristics,
}

/// Which points a pool holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum PoolMode {
    /// The best ones that the search for the optimum met; nothing is searched for their sake.
    #[default]
    Found,
    /// The best ones there are: the search goes on until no other assignment of the integers is
    /// better than the last of the pool by more than the gap.
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
            keep_leaves: false,
            branching: BranchingRule::Automatic,
            symmetry: false,
            conflicts: false,
            presolve: true,
            probing: true,
            blocks: true,
            cuts: true,
            heuristics: Heuristics::default(),
        }
    }
}

impl Options {
    /// A good point soon: a gap of a tenth of a percent, every heuristic, and a thread for every
    /// processor.
    pub fn fast() -> Self {
        let threads = std::thread::available_parallelism().map_or(1, usize::from).min(256);
        Options { relative_gap: 1e-3, threads, heuristics: Heuristics::all(), ..Options::default() }
    }

    /// The default.
    pub fn balanced() -> Self {
        Options::default()
    }

    /// A closer proof that can be repeated: a gap of 1e-7, and the same search on any number of
    /// threads. Bounds are recomputed from relaxations that are known to about 1e-8, so much smaller
    /// gaps cannot be proved.
    pub fn proof() -> Self {
        Options { relative_gap: 1e-7, deterministic: true, ..Options::default() }
    }

    /// The options of a search inside a search: one thread, one point, nothing kept.
    pub(crate) fn nested(&self) -> Self {
        Options {
            threads: 1,
            deterministic: false,
            memory_limit: None,
            pool: 1,
            pool_mode: PoolMode::Found,
            pool_gap: None,
            keep_leaves: false,
            heuristics: self.heuristics.nested(),
            ..self.clone()
        }
    }

    /// Sets the relative gap.
    #[must_use]
    pub fn with_relative_gap(mut self, gap: f64) -> Self {
        self.relative_gap = gap;
        self
    }

    /// Sets the absolute gap.
    #[must_use]
    pub fn with_absolute_gap(mut self, gap: f64) -> Self {
        self.absolute_gap = gap;
        self
    }

    /// Sets the time limit.
    #[must_use]
    pub fn with_time_limit(mut self, limit: Duration) -> Self {
        self.time_limit = Some(limit);
        self
    }

    /// Sets the node limit.
    #[must_use]
    pub fn with_node_limit(mut self, limit: u64) -> Self {
        self.node_limit = Some(limit);
        self
    }

    /// Sets the number of threads.
    #[must_use]
    pub fn with_threads(mut self, threads: usize) -> Self {
        self.threads = threads;
        self
    }

    /// Sets the memory limit, in bytes.
    #[must_use]
    pub fn with_memory_limit(mut self, bytes: u64) -> Self {
        self.memory_limit = Some(bytes);
        self
    }

    /// Searches in rounds, the same for any number of threads, or not.
    #[must_use]
    pub fn with_deterministic(mut self, deterministic: bool) -> Self {
        self.deterministic = deterministic;
        self
    }

    /// Keeps so many points, of the given kind.
    #[must_use]
    pub fn with_pool(mut self, points: usize, mode: PoolMode) -> Self {
        (self.pool, self.pool_mode) = (points, mode);
        self
    }

    /// Keeps only points within a relative gap of the best one.
    #[must_use]
    pub fn with_pool_gap(mut self, gap: f64) -> Self {
        self.pool_gap = Some(gap);
        self
    }

    /// Keeps the ends of the tree.
    #[must_use]
    pub fn with_leaves(mut self, keep: bool) -> Self {
        self.keep_leaves = keep;
        self
    }

    /// Sets the branching rule.
    #[must_use]
    pub fn with_branching(mut self, rule: BranchingRule) -> Self {
        self.branching = rule;
        self
    }

    /// Orders interchangeable columns, or not.
    #[must_use]
    pub fn with_symmetry(mut self, symmetry: bool) -> Self {
        self.symmetry = symmetry;
        self
    }

    /// Learns from conflicts, or not.
    #[must_use]
    pub fn with_conflicts(mut self, conflicts: bool) -> Self {
        self.conflicts = conflicts;
        self
    }

    /// Sets whether the program is presolved before the search.
    #[must_use]
    pub fn with_presolve(mut self, presolve: bool) -> Self {
        self.presolve = presolve;
        self
    }

    /// Sets whether binaries are tried at both values by propagation.
    #[must_use]
    pub fn with_probing(mut self, probing: bool) -> Self {
        self.probing = probing;
        self
    }

    /// Sets whether parts without a common row are searched one after the other.
    #[must_use]
    pub fn with_blocks(mut self, blocks: bool) -> Self {
        self.blocks = blocks;
        self
    }

    /// Sets whether cuts are added to the root relaxation.
    #[must_use]
    pub fn with_cuts(mut self, cuts: bool) -> Self {
        self.cuts = cuts;
        self
    }

    /// Sets which heuristics may look for points.
    #[must_use]
    pub fn with_heuristics(mut self, heuristics: Heuristics) -> Self {
        self.heuristics = heuristics;
        self
    }

    /// Refuses values outside their ranges; every backend calls it first.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::OutOfRange`], naming the option.
    pub fn check(&self) -> Result<(), Error> {
        let check = |what: &str, value: f64, holds: bool, range: String| {
            let error = || {
                Error::from(ErrorKind::OutOfRange {
                    what: format!("option `{what}`"),
                    value,
                    range,
                })
            };
            if holds { Ok(()) } else { Err(error()) }
        };
        let gap = |what: &str, value: f64| {
            check(what, value, value.is_finite() && value >= 0.0, "finite and not negative".into())
        };
        let range = |what: &str, value: f64, low: f64, high: f64| {
            check(what, value, (low..=high).contains(&value), format!("within [{low}, {high}]"))
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
