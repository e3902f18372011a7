//! The outcome of a search for the shortest horizon.

use std::fmt;
use std::path::PathBuf;

use web_time::Duration;

use super::Monotonicity;
use crate::error::{Error, RunError};
use crate::hybrid::reach::{ReachSets, Tube};
use crate::hybrid::system::Discretization;
use crate::number::counted;
use crate::solution::{ProofReport, Solution, Statistics, Termination};

/// How a horizon was refuted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum HorizonRefutation {
    /// By reach sets, without a solve.
    Sets,
    /// By bound propagation alone, without a relaxation.
    Propagation,
    /// With relaxations.
    Relaxation,
}

/// The verdict on one horizon.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum HorizonVerdict {
    /// A verified point exists.
    Feasible,
    /// The solver proved infeasibility.
    Refuted(HorizonRefutation),
    /// The solver stopped without a point and without a proof.
    Undecided(Termination),
    /// The program that was restricted to the modes of a plan on a coarser grid has no plan, or
    /// none was found in time. Nothing is said about the horizon: it is solved without the
    /// restriction next.
    NotAsGuessed,
}

/// In words: "refuted by reach sets".
impl fmt::Display for HorizonVerdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            HorizonVerdict::Feasible => f.write_str("a plan"),
            HorizonVerdict::Refuted(HorizonRefutation::Sets) => {
                f.write_str("refuted by reach sets")
            }
            HorizonVerdict::Refuted(HorizonRefutation::Propagation) => {
                f.write_str("refuted by propagation")
            }
            HorizonVerdict::Refuted(HorizonRefutation::Relaxation) => {
                f.write_str("refuted by relaxations")
            }
            HorizonVerdict::Undecided(why) => write!(f, "open ({why} of this solve)"),
            HorizonVerdict::NotAsGuessed => f.write_str(
                "no plan with the modes of a coarser one, which says nothing about others",
            ),
        }
    }
}

/// A decision about one horizon, by reach sets or by a solve.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct HorizonAttempt {
    /// The horizon, in steps.
    pub steps: usize,
    /// The verdict.
    pub verdict: HorizonVerdict,
    /// Counts and time of the solve; all 0 if nothing was solved.
    pub statistics: Statistics,
    /// Whether the program was restricted to the mode sequence of a coarser plan. A restricted
    /// program can prove only feasibility.
    pub restricted: bool,
}

/// In words: "17 steps: refuted by relaxations, 4711 nodes in 9.80 s".
impl fmt::Display for HorizonAttempt {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", counted(self.steps, "step"), self.verdict)?;
        if !self.is_solve() {
            return Ok(());
        }
        let nodes = self.statistics.nodes;
        let seconds = self.statistics.time.as_secs_f64();
        write!(f, ", {} in {seconds:.2} s", counted(nodes, "node"))
    }
}

impl HorizonAttempt {
    /// A horizon that reach sets refuted.
    pub(super) fn by_sets(steps: usize) -> Self {
        let (verdict, statistics) =
            (HorizonVerdict::Refuted(HorizonRefutation::Sets), Statistics::default());
        HorizonAttempt { steps, verdict, statistics, restricted: false }
    }

    /// Whether a program was solved.
    pub fn is_solve(&self) -> bool {
        self.verdict != HorizonVerdict::Refuted(HorizonRefutation::Sets)
    }

    /// Interprets a solution. A point or a proof decides, whatever the reason for stopping.
    pub(super) fn of(steps: usize, solution: &Solution) -> Self {
        let statistics = *solution.statistics();
        let verdict = if solution.point().is_some() {
            HorizonVerdict::Feasible
        } else if solution.is_infeasible() {
            HorizonVerdict::Refuted(match statistics.relaxations {
                0 => HorizonRefutation::Propagation,
                _ => HorizonRefutation::Relaxation,
            })
        } else {
            HorizonVerdict::Undecided(solution.termination())
        };
        HorizonAttempt { steps, verdict, statistics, restricted: false }
    }
}

/// The log of a horizon that [`Options::with_proof`](crate::solver::Options::with_proof) has asked
/// for, with a report if there is one.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct HorizonProof {
    /// The horizon, in steps.
    pub steps: usize,
    /// The file of its log: `steps_000007.proof` in the folder of the option for 7 steps.
    pub path: PathBuf,
    /// The report on the log, which also says why it could not be written, if it could not. `None`
    /// if there is none: a limit, an interrupt or a log that could not be written came first, the
    /// solver writes none, or the solve of the horizon's own program came to another answer than
    /// the search.
    pub report: Option<ProofReport>,
}

impl HorizonProof {
    /// Whether there is a log that covers the whole claim.
    pub fn is_complete(&self) -> bool {
        self.report.as_ref().is_some_and(|report| report.is_complete)
    }
}

/// How a search ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum ShortestStatus {
    /// The shortest horizon was found, and every smaller one is refuted.
    Found,
    /// Every horizon up to the largest allowed one is refuted.
    NoneWithin {
        /// The largest horizon allowed, in steps.
        max_steps: usize,
    },
    /// The search stopped before a proof; the other fields have what is known so far.
    Stopped(Termination),
}

impl fmt::Display for ShortestStatus {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            ShortestStatus::Found => f.write_str("found"),
            ShortestStatus::NoneWithin { max_steps } => {
                write!(
                    f,
                    "no feasible horizon up to {} of the time-stepped law",
                    counted(*max_steps, "step")
                )
            }
            ShortestStatus::Stopped(termination) => write!(f, "stopped ({termination})"),
        }
    }
}

/// The length of a horizon, without the digits that only rounding makes.
fn seconds(steps: usize, time_step: f64) -> String {
    let text = format!("{:.6}", steps as f64 * time_step);
    format!("{} s", text.trim_end_matches('0').trim_end_matches('.'))
}

/// The outcome of a search for the shortest horizon: of a system, of a scene, of the paper's
/// vehicle, or of any [`HorizonModel`](super::HorizonModel).
///
/// `{}` prints what is proved, with the law and the time step that it is about.
#[derive(Debug, Clone)]
#[non_exhaustive]
#[must_use]
pub struct ShortestHorizon<P> {
    /// How the search ended.
    pub status: ShortestStatus,
    /// The smallest horizon found feasible, in steps. It is the shortest one if the status is
    /// [`Found`](ShortestStatus::Found).
    pub steps: Option<usize>,
    /// A plan of so many steps.
    pub plan: Option<P>,
    /// The largest horizon, in steps, that is proved infeasible together with every smaller one: by
    /// reach sets or by a solver, each separately or (if waiting is free) by monotonicity.
    pub refuted_steps: Option<usize>,
    /// Δt of the time-stepped law, in s: what is found and what is refuted is said of it. `None` if
    /// the search does not know it.
    pub time_step: Option<f64>,
    /// The method that makes steps of nonlinear rates; `None` without such rates.
    pub discretization: Option<Discretization>,
    /// Whether waiting is free, and why: whether smaller horizons were refuted by monotonicity or
    /// each separately.
    pub monotonicity: Monotonicity,
    /// The reach sets that were used, for further questions.
    pub sets: Option<ReachSets>,
    /// The tube of `steps`, if reach sets were used.
    pub tube: Option<Tube>,
    /// Every refuted horizon and every solve, in order. Restricted programs without a point are
    /// undecided.
    pub attempts: Vec<HorizonAttempt>,
    /// The horizons that are open because the solver's plan is not the run of its inputs and could
    /// not be corrected, with why. Their verdict is undecided.
    pub drifts: Vec<(usize, RunError)>,
    /// The logs that [`Options::with_proof`](crate::solver::Options::with_proof) of the solver has
    /// asked for, in ascending order: one for each horizon up to `refuted_steps`, and one for
    /// `steps`, each about the program as the model states it. The plan is then the point in its
    /// log. Empty without that option.
    pub proofs: Vec<HorizonProof>,
    /// Wall-clock time of the search, building included and logs not.
    pub time: Duration,
    /// Whether the start is in the goal, so that no step is needed. A plan has at least one step;
    /// `steps` and `plan` are then the shortest one that ends in the goal again. Known of systems,
    /// scenes and the paper's vehicle, for starts of which one in the goal is easily found, and
    /// with missions if they hold after no step; `false` with windows and rows, of which nothing is
    /// known.
    pub starts_in_goal: bool,
    /// Whether the limit of the whole search has stopped it.
    pub(super) is_time_up: bool,
    /// Hints if there is no plan, in words.
    pub(super) hints: Vec<String>,
}

/// The program of a horizon and its solution.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct SolvedHorizon<P> {
    /// The program, with the bounds that reach sets tightened.
    pub program: P,
    /// Its solution.
    pub solution: Solution,
}

impl<P> fmt::Display for ShortestHorizon<P> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let law = match self.time_step {
            Some(time_step) => {
                let method = self.discretization.map_or(String::new(), |own| format!(" by {own}"));
                format!("the time-stepped law{method} with Δt = {time_step} s")
            }
            None => "the programs of the search".to_owned(),
        };
        let horizon = |steps: usize| {
            let count = counted(steps, "step");
            match self.time_step {
                Some(time_step) => format!("{count}, {}", seconds(steps, time_step)),
                None => count,
            }
        };
        if self.starts_in_goal {
            f.write_str("the start is in the goal, so that no step is needed; with steps: ")?;
        }
        match (self.status, self.steps) {
            (ShortestStatus::Found, Some(found)) => {
                write!(f, "{}", horizon(found).replacen(',', " at least,", 1))?;
                match found {
                    1 => write!(f, ", under {law}"),
                    _ => write!(f, ": fewer are refuted for {law}"),
                }
            }
            (ShortestStatus::NoneWithin { max_steps }, _) => {
                write!(f, "no plan of up to {}, under {law}; longer ones", horizon(max_steps))?;
                f.write_str(" were not looked for")?;
                self.hints.iter().try_for_each(|hint| write!(f, "; {hint}"))
            }
            (ShortestStatus::Stopped(reason), found) => {
                let of = match reason {
                    Termination::TimeLimit if self.is_time_up => " of the whole search",
                    Termination::TimeLimit | Termination::NodeLimit => " of each solve",
                    _ => "",
                };
                write!(f, "stopped ({reason}{of}), under {law}")?;
                match found {
                    Some(1) => f.write_str(": 1 step is enough")?,
                    Some(found) => write!(f, ": {found} steps are enough")?,
                    None => f.write_str(": no plan was found")?,
                }
                if let Some((steps, drift)) = self.drifts.first() {
                    write!(f, "; {} are open: {drift}", horizon(*steps))?;
                }
                match self.refuted_steps {
                    None => Ok(()),
                    Some(1) => f.write_str(", 1 step is refuted"),
                    Some(refuted) => write!(f, ", up to {refuted} steps are refuted"),
                }
            }
            (status, None) => write!(f, "{status}, under {law}"),
        }
    }
}

impl<P> ShortestHorizon<P> {
    /// The same with a plan that is made of this one's, such as the plan of a planner's own type
    /// that is read from a [`SolvedHorizon`].
    ///
    /// # Errors
    ///
    /// Those of `plan`.
    pub fn try_map<Q>(
        self,
        plan: impl FnOnce(P) -> Result<Q, Error>,
    ) -> Result<ShortestHorizon<Q>, Error> {
        Ok(ShortestHorizon {
            status: self.status,
            steps: self.steps,
            plan: self.plan.map(plan).transpose()?,
            refuted_steps: self.refuted_steps,
            time_step: self.time_step,
            discretization: self.discretization,
            monotonicity: self.monotonicity,
            sets: self.sets,
            tube: self.tube,
            attempts: self.attempts,
            drifts: self.drifts,
            proofs: self.proofs,
            time: self.time,
            starts_in_goal: self.starts_in_goal,
            is_time_up: self.is_time_up,
            hints: self.hints,
        })
    }

    /// Whether the shortest horizon was found and proved.
    pub fn is_found(&self) -> bool {
        self.status == ShortestStatus::Found
    }

    /// The refuted horizons, in the order in which they were refuted.
    pub fn refutations(&self) -> impl Iterator<Item = &HorizonAttempt> {
        self.attempts.iter().filter(|attempt| matches!(attempt.verdict, HorizonVerdict::Refuted(_)))
    }

    /// The horizons whose claim is to be believed without a complete log: all of them if none was
    /// asked for.
    pub fn unlogged(&self) -> impl Iterator<Item = usize> + '_ {
        let is_logged = |steps: &usize| {
            let at = self.proofs.binary_search_by_key(steps, |proof| proof.steps);
            at.is_ok_and(|at| self.proofs[at].is_complete())
        };
        let said = (1..=self.refuted_steps.unwrap_or(0)).chain(self.steps);
        said.filter(move |steps| !is_logged(steps))
    }

    /// How many programs were solved.
    pub fn solves(&self) -> usize {
        self.attempts.iter().filter(|attempt| attempt.is_solve()).count()
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
