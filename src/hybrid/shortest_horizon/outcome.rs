//! What a shortest-horizon search found, and how it knows.

use std::fmt;

use web_time::Duration;

use crate::hybrid::reach::{ReachSets, Tube};
use crate::solution::{Solution, Statistics, Termination};

/// How a horizon was refuted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Refutation {
    /// By reach sets: nothing was solved.
    Sets,
    /// By bound propagation alone: no relaxation was solved.
    Propagation,
    /// With the help of relaxations.
    Relaxation,
}

/// What one solve said about its horizon.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Verdict {
    /// A verified point exists.
    Feasible,
    /// The solver proved that there is none.
    Refuted(Refutation),
    /// Neither: the solver stopped without a point and without a proof.
    Undecided(Termination),
}

/// What the search learned about one horizon: by reach sets, or by one solve.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Attempt {
    /// The horizon, in steps.
    pub steps: usize,
    /// What was found.
    pub verdict: Verdict,
    /// The solve's counts and time; all 0 when nothing was solved.
    pub statistics: Statistics,
    /// Whether the program was restricted to the mode sequence of a coarser plan. A restricted
    /// program proves only feasibility.
    pub restricted: bool,
}

impl Attempt {
    /// A horizon that reach sets refuted.
    pub(super) fn by_sets(steps: usize) -> Self {
        let (verdict, statistics) = (Verdict::Refuted(Refutation::Sets), Statistics::default());
        Attempt { steps, verdict, statistics, restricted: false }
    }

    /// Whether a program was solved.
    pub fn is_solve(&self) -> bool {
        self.verdict != Verdict::Refuted(Refutation::Sets)
    }

    /// Reads a solve's answer. A point decides whatever stopped the solver; so does a proof.
    pub(super) fn of(steps: usize, solution: &Solution) -> Self {
        let statistics = *solution.statistics();
        let verdict = if solution.point().is_some() {
            Verdict::Feasible
        } else if solution.is_infeasible() {
            Verdict::Refuted(match statistics.relaxations {
                0 => Refutation::Propagation,
                _ => Refutation::Relaxation,
            })
        } else {
            Verdict::Undecided(solution.termination())
        };
        Attempt { steps, verdict, statistics, restricted: false }
    }
}

/// How a search ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum ShortestStatus {
    /// The shortest horizon, every smaller one refuted.
    Found,
    /// Every horizon up to the largest allowed one is refuted.
    NoneWithin {
        /// The largest horizon allowed, in steps.
        max_steps: usize,
    },
    /// Stopped before a proof; what is known so far is in the other fields.
    Stopped(Termination),
}

impl fmt::Display for ShortestStatus {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            ShortestStatus::Found => f.write_str("found"),
            ShortestStatus::NoneWithin { max_steps } => {
                write!(f, "no feasible horizon up to {max_steps} steps")
            }
            ShortestStatus::Stopped(termination) => write!(f, "stopped ({termination})"),
        }
    }
}

/// The outcome of a shortest-horizon search.
#[derive(Debug, Clone)]
#[non_exhaustive]
#[must_use]
pub struct ShortestHorizon<P> {
    /// How the search ended.
    pub status: ShortestStatus,
    /// The smallest horizon found feasible, in steps; the shortest one when the status is
    /// [`Found`](ShortestStatus::Found).
    pub steps: Option<usize>,
    /// The largest horizon, in steps, that is proved infeasible together with every smaller one:
    /// by reach sets or by a solver, the smaller ones one by one or (where waiting is free) by
    /// monotonicity.
    pub refuted_steps: Option<usize>,
    /// The program of `steps`, with the bounds that reach sets tightened.
    pub program: Option<P>,
    /// Its solution.
    pub solution: Option<Solution>,
    /// The reach sets that were used, for asking further.
    pub sets: Option<ReachSets>,
    /// The tube of `steps`, where reach sets were used.
    pub tube: Option<Tube>,
    /// What was learned, in order: every refuted horizon with how, and every solve; those of
    /// restricted programs that found nothing are undecided.
    pub attempts: Vec<Attempt>,
    /// Wall-clock time of the search, building included.
    pub time: Duration,
}

impl<P> ShortestHorizon<P> {
    /// Whether the shortest horizon is found and proved.
    pub fn is_found(&self) -> bool {
        self.status == ShortestStatus::Found
    }

    /// The refuted horizons, in the order in which they were refuted.
    pub fn refutations(&self) -> impl Iterator<Item = &Attempt> {
        self.attempts.iter().filter(|attempt| matches!(attempt.verdict, Verdict::Refuted(_)))
    }

    /// Nodes over all solves.
    pub fn nodes(&self) -> u64 {
        self.attempts.iter().map(|attempt| attempt.statistics.nodes).sum()
    }

    /// Relaxations over all solves.
    pub fn relaxations(&self) -> u64 {
        self.attempts.iter().map(|attempt| attempt.statistics.relaxations).sum()
    }
}
