//! Counts and times of a solve.

use std::fmt;
use web_time::Duration;

use crate::number::counted;

/// Counts and times of a solve.
///
/// Every processed node ends in exactly one way: refuted by propagation or by its relaxation, cut
/// off by its bound, solved as a leaf, split, or left unfinished. The counts of these sum to
/// [`nodes`](Self::nodes).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default))]
pub struct Statistics {
    /// Nodes of the tree that were processed, including the root.
    pub nodes: u64,
    /// Nodes of small searches inside heuristics, which are not counted in `nodes`.
    pub nested_nodes: u64,
    /// Continuous relaxations solved, including those of heuristics and checks.
    pub relaxations: u64,
    /// Relaxations by method, and how often the first method gave up.
    pub relaxation_counts: RelaxationCounts,
    /// Iterations over all relaxations: Newton steps of interior-point methods, and pivots or steps
    /// of the others.
    pub iterations: u64,
    /// Nodes refuted without a relaxation: by bound propagation, probing or reduction.
    pub refuted_by_propagation: u64,
    /// Nodes whose relaxation is proved infeasible.
    pub refuted_by_relaxation: u64,
    /// Nodes whose proved bound is at the cutoff.
    pub cut_off: u64,
    /// Nodes with all integers fixed, solved to their best point.
    pub leaves: u64,
    /// Nodes that were split.
    pub split: u64,
    /// Nodes that were split although their relaxed points had whole integers.
    pub whole_splits: u64,
    /// Nodes returned unfinished at a limit, or that could be neither finished nor split for
    /// numerical reasons.
    pub unfinished: u64,
    /// Points that were not taken because a variable without bounds is farther than
    /// [`FREE_RADIUS`](crate::tolerance::FREE_RADIUS) from 0 there, where bounds are not proved.
    pub beyond_radius: u64,
    /// Children closed by trial branching, which never became nodes.
    pub closed_by_trials: u64,
    /// Nodes and children closed by multipliers of an earlier solve, proved again, without a
    /// relaxation; each of them is also counted as cut off, refuted or closed by trials. Only in
    /// prepared solves.
    pub closed_by_proofs: u64,
    /// Candidates that a row excluded which a callback for
    /// [lazy constraints](crate::solver::Control::with_lazy_constraints) returned for them.
    pub excluded_by_rows: u64,
    /// Lazy constraints that were added.
    pub lazy_constraints: u64,
    /// [User cuts](crate::solver::Control::with_user_cuts) that were added.
    pub user_cuts: u64,
    /// Searches that were repeated because an accepted point contradicted a rewriting of the
    /// program that makes its relaxation tighter. The rewriting was dropped, so the answer does not
    /// rest on it; anything but 0 is a fault of the crate.
    pub contradictions: u64,
    /// Improving points that were found, verified and accepted.
    pub incumbents: u64,
    /// Largest depth of a processed node, in decisions from the root.
    pub depth: u64,
    /// Largest number of open nodes at any time.
    pub max_open: u64,
    /// Largest size of the tree, in bytes, as [`Options::memory_limit`] counts it.
    ///
    /// [`Options::memory_limit`]: crate::solver::Options::memory_limit
    pub tree_bytes: u64,
    /// Facets of unions among the rows of the search; all 0 if it has none.
    pub facets: FacetCounts,
    /// Independent blocks that were searched one after the other; 0 if the program was searched as
    /// a whole.
    pub blocks: u64,
    /// Threads that took part.
    pub threads: u64,
    /// The time that the threads spent, by activity.
    pub times: Times,
    /// The calls, finds and time of each source of points.
    pub heuristics: HeuristicCounts,
    /// Wall-clock time of the solve.
    pub time: Duration,
}

/// Facets of unions, such as the modes of a step, that a search has begun again with because its
/// first nodes had closed little of the gap, or that such a search of a prepared model has left for
/// this one; see [`Options::with_facets`]. Of several blocks, the sums of those that have some.
///
/// [`Options::with_facets`]: crate::solver::Options::with_facets
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default))]
pub struct FacetCounts {
    /// Facets among the rows of the search.
    pub facets: u64,
    /// Unions that have such facets.
    pub unions: u64,
    /// Unions of the program.
    pub all_unions: u64,
    /// The value of the relaxed root before facets, in the objective's unit and sense. Other cuts
    /// are among its rows.
    pub root_before: f64,
    /// The value of the relaxed root with the facets, in the objective's unit and sense.
    pub root_after: f64,
}

impl FacetCounts {
    /// By how much the facets have moved the value of the relaxed root towards the optimum
    /// (objective's unit, `>= 0`).
    pub fn lift(&self) -> f64 {
        (self.root_after - self.root_before).abs()
    }

    /// These and further ones of the same program, which were found with these among its rows.
    #[doc(hidden)]
    #[must_use]
    pub fn with(mut self, further: &FacetCounts) -> FacetCounts {
        if further.facets > 0 {
            self.facets += further.facets;
            self.unions = self.unions.max(further.unions);
            self.root_after = further.root_after;
        }
        self
    }

    /// Adds those of another block.
    #[doc(hidden)]
    pub fn add(&mut self, other: &FacetCounts) {
        self.facets += other.facets;
        self.unions += other.unions;
        self.all_unions += other.all_unions;
        self.root_before += other.root_before;
        self.root_after += other.root_after;
    }
}

impl fmt::Display for FacetCounts {
    /// How many facets there are, and of how many unions.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let FacetCounts { facets, unions, all_unions, .. } = *self;
        let facets = counted(facets, "facet");
        write!(f, "{facets} of {unions} among {}", counted(all_unions, "union"))
    }
}

/// Relaxations by the method that was asked. Of a relaxation that two methods are asked about, both
/// are counted; [`Statistics::relaxations`] is the sum.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default))]
pub struct RelaxationCounts {
    /// By the dual simplex method.
    pub dual_simplex: u64,
    /// By the dual active-set method.
    pub active_set: u64,
    /// By the crate's own interior-point method.
    pub interior_point: u64,
    /// By Clarabel.
    pub clarabel: u64,
    /// How often the first attempt at a node was not good enough and a second one was made.
    pub given_up: u64,
}

impl RelaxationCounts {
    /// Relaxations by all methods.
    pub fn total(&self) -> u64 {
        self.dual_simplex + self.active_set + self.interior_point + self.clarabel
    }

    /// Adds other counts.
    pub fn add(&mut self, other: &RelaxationCounts) {
        self.dual_simplex += other.dual_simplex;
        self.active_set += other.active_set;
        self.interior_point += other.interior_point;
        self.clarabel += other.clarabel;
        self.given_up += other.given_up;
    }
}

/// The time that the threads of a search spent, by activity. The parts do not overlap, and are
/// summed over all threads: a relaxation inside a heuristic counts as relaxation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default))]
pub struct Times {
    /// Bound propagation.
    pub propagation: Duration,
    /// Probing.
    pub probing: Duration,
    /// Making the reduced program of a node.
    pub reduction: Duration,
    /// Solving relaxations.
    pub relaxation: Duration,
    /// Recomputing bounds, refutations and reduced costs from multipliers.
    pub proof: Duration,
    /// Heuristics, without the propagations and relaxations in them.
    pub heuristics: Duration,
    /// Polishing and verifying points.
    pub verification: Duration,
    /// Everything else: choosing splits, keeping the tree.
    pub other: Duration,
}

/// A source of points.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Heuristic {
    /// A node whose integers are all fixed.
    Leaf,
    /// A relaxed point whose integers are whole.
    Relaxation,
    /// Round and propagate.
    Rounding,
    /// A MIP start or the last plan, completed or repaired.
    Start,
    /// Rolling out: the inputs of a relaxed point, and what follows from them.
    RollOut,
    /// Diving: fix, propagate and relax in turn.
    Diving,
    /// Relaxation-induced neighbourhood search.
    Neighbourhood,
}

/// The calls, finds and time of one source of points.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default))]
pub struct HeuristicCount {
    /// How often it was called.
    pub calls: u64,
    /// How many verified points it found.
    pub points: u64,
    /// How many of these were better than all before.
    pub incumbents: u64,
    /// Relaxations solved in it, including those of its own small searches.
    pub relaxations: u64,
    /// Time spent in it, summed over all threads and including relaxations. It overlaps with the
    /// parts of [`Times`].
    pub time: Duration,
}

/// The calls, finds and time of each source of points.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default))]
pub struct HeuristicCounts {
    leaf: HeuristicCount,
    relaxation: HeuristicCount,
    rounding: HeuristicCount,
    roll_out: HeuristicCount,
    start: HeuristicCount,
    diving: HeuristicCount,
    neighbourhood: HeuristicCount,
}

impl Heuristic {
    /// All sources of points.
    pub const ALL: [Heuristic; 7] = [
        Heuristic::Leaf,
        Heuristic::Relaxation,
        Heuristic::Rounding,
        Heuristic::RollOut,
        Heuristic::Start,
        Heuristic::Diving,
        Heuristic::Neighbourhood,
    ];

    /// The letter that marks its points in a [`Log`](crate::solver::Log).
    pub fn mark(self) -> char {
        self.mark_and_name().0
    }

    fn mark_and_name(self) -> (char, &'static str) {
        match self {
            Heuristic::Leaf => ('L', "leaf"),
            Heuristic::Relaxation => ('*', "relaxation"),
            Heuristic::Rounding => ('R', "rounding"),
            Heuristic::RollOut => ('O', "roll-out"),
            Heuristic::Start => ('S', "start"),
            Heuristic::Diving => ('D', "diving"),
            Heuristic::Neighbourhood => ('N', "neighbourhood"),
        }
    }
}

impl fmt::Display for Heuristic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.mark_and_name().1)
    }
}

impl HeuristicCounts {
    /// The counts of one source.
    pub fn of(&self, heuristic: Heuristic) -> HeuristicCount {
        let mut counts = *self;
        *counts.of_mut(heuristic)
    }

    /// The sources and their counts.
    pub fn iter(&self) -> impl Iterator<Item = (Heuristic, HeuristicCount)> + '_ {
        Heuristic::ALL.into_iter().map(|heuristic| (heuristic, self.of(heuristic)))
    }

    #[doc(hidden)]
    pub fn add(&mut self, part: &HeuristicCounts) {
        for (heuristic, count) in part.iter() {
            let sum = self.of_mut(heuristic);
            sum.calls += count.calls;
            sum.points += count.points;
            sum.incumbents += count.incumbents;
            sum.relaxations += count.relaxations;
            sum.time += count.time;
        }
    }

    /// The counts of one source, mutable.
    pub fn of_mut(&mut self, heuristic: Heuristic) -> &mut HeuristicCount {
        match heuristic {
            Heuristic::Leaf => &mut self.leaf,
            Heuristic::Relaxation => &mut self.relaxation,
            Heuristic::Rounding => &mut self.rounding,
            Heuristic::RollOut => &mut self.roll_out,
            Heuristic::Start => &mut self.start,
            Heuristic::Diving => &mut self.diving,
            Heuristic::Neighbourhood => &mut self.neighbourhood,
        }
    }
}

impl Times {
    /// The names and values of the parts.
    pub fn parts(&self) -> [(&'static str, Duration); 8] {
        [
            ("propagation", self.propagation),
            ("probing", self.probing),
            ("reduction", self.reduction),
            ("relaxation", self.relaxation),
            ("proof", self.proof),
            ("heuristics", self.heuristics),
            ("verification", self.verification),
            ("other", self.other),
        ]
    }

    /// The sum of the parts, over all threads.
    pub fn total(&self) -> Duration {
        self.parts().into_iter().map(|(_, time)| time).sum()
    }

    /// Adds other times.
    pub fn add(&mut self, other: &Times) {
        self.propagation += other.propagation;
        self.probing += other.probing;
        self.reduction += other.reduction;
        self.relaxation += other.relaxation;
        self.proof += other.proof;
        self.heuristics += other.heuristics;
        self.verification += other.verification;
        self.other += other.other;
    }
}

impl Statistics {
    /// Nodes processed per second of wall-clock time; 0 before any time has passed.
    pub fn nodes_per_second(&self) -> f64 {
        let seconds = self.time.as_secs_f64();
        if seconds > 0.0 { self.nodes as f64 / seconds } else { 0.0 }
    }

    /// The same counts without times and the number of threads, which vary from run to run.
    pub fn without_times(&self) -> Statistics {
        let mut heuristics = self.heuristics;
        for heuristic in Heuristic::ALL {
            heuristics.of_mut(heuristic).time = Duration::ZERO;
        }
        let (times, time) = (Times::default(), Duration::ZERO);
        Statistics { times, time, heuristics, threads: 0, ..*self }
    }

    /// Leaves out the best points, where a search that begins with the last of them counts it
    /// again.
    #[doc(hidden)]
    pub fn forget_incumbents(&mut self) {
        self.incumbents = 0;
        Heuristic::ALL.iter().for_each(|&source| self.heuristics.of_mut(source).incumbents = 0);
    }

    /// Adds the relaxations, times and nodes (as nested ones) of a search inside a heuristic. Its
    /// points are counted when they are offered.
    #[doc(hidden)]
    pub fn add_nested(&mut self, inner: &Statistics) {
        self.relaxations += inner.relaxations;
        self.relaxation_counts.add(&inner.relaxation_counts);
        self.iterations += inner.iterations;
        self.nested_nodes += inner.nodes + inner.nested_nodes;
        self.excluded_by_rows += inner.excluded_by_rows;
        self.times.add(&inner.times);
    }

    /// Adds the counts and times of a part of the search. Maxima are merged; the wall-clock time
    /// and the number of threads do not change.
    pub fn add(&mut self, part: &Statistics) {
        macro_rules! sum {
            ($($count:ident),*) => { $(self.$count += part.$count;)* };
        }
        sum!(nodes, nested_nodes, relaxations, iterations, leaves, split, unfinished, incumbents);
        sum!(beyond_radius);
        sum!(refuted_by_propagation, refuted_by_relaxation, cut_off, closed_by_trials);
        sum!(closed_by_proofs, excluded_by_rows, lazy_constraints, user_cuts);
        sum!(whole_splits, contradictions);
        self.relaxation_counts.add(&part.relaxation_counts);
        self.facets.add(&part.facets);
        self.depth = self.depth.max(part.depth);
        self.max_open = self.max_open.max(part.max_open);
        self.tree_bytes = self.tree_bytes.max(part.tree_bytes);
        self.times.add(&part.times);
        self.heuristics.add(&part.heuristics);
    }
}
