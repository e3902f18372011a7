//! A move of a controller.

use std::fmt;

use web_time::Duration;

use crate::solution::Solution;

/// By how much softened limits may be exceeded together without a word.
const SOFTENED: f64 = 1e-6;

/// Where a move comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum MoveSource {
    /// A plan that is proved optimal.
    Optimal,
    /// The best plan when a limit was reached.
    BestSoFar,
    /// A plan, optimal or not, that exceeds softened limits.
    Softened,
    /// The rest of the last plan, simulated from the measured state where there is a system.
    LastPlan,
    /// The feedback of the terminal set.
    TerminalFeedback,
    /// The input of the fallback that the user gave.
    Given,
    /// Nothing is known to be admissible: the next input of the last plan, or no input (0), within
    /// the ranges of the inputs.
    Emergency,
}

impl fmt::Display for MoveSource {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            MoveSource::Optimal => "optimal",
            MoveSource::BestSoFar => "best so far",
            MoveSource::Softened => "softened",
            MoveSource::LastPlan => "last plan",
            MoveSource::TerminalFeedback => "terminal feedback",
            MoveSource::Given => "given",
            MoveSource::Emergency => "emergency",
        })
    }
}

/// A move of a [`RecedingHorizon`](super::RecedingHorizon): what to do now, and what is known of it.
///
/// Its plan is nominal: it promises nothing under disturbances, unless the controller's program is a
/// [robust](crate::hybrid::HybridProgram::robust) one, whose plans leave room for them.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Move {
    /// The number of the step, from 0 on.
    pub step: usize,
    /// The measured state, an entry per state in its unit.
    pub state: Vec<f64>,
    /// The input to apply, an entry per input in its unit.
    pub input: Vec<f64>,
    /// Where it comes from.
    pub source: MoveSource,
    /// Whether a simulation says that the system allows the input here; always so for a plan, and
    /// `None` where nothing was simulated.
    pub is_admissible: Option<bool>,
    /// The planned state at each sample, the measured one first; empty without a plan.
    pub states: Vec<Vec<f64>>,
    /// The planned input of each step.
    pub inputs: Vec<Vec<f64>>,
    /// The cost of the plan.
    pub objective: Option<f64>,
    /// The proved bound on the cost of any plan, in the model's own sense; NaN if nothing was solved.
    #[cfg_attr(feature = "serde", serde(with = "crate::wire"))]
    pub bound: f64,
    /// By how much softened limits are exceeded, if that is reported.
    pub excess: Option<f64>,
    /// Why there is no plan, if there is none.
    pub reason: Option<String>,
    /// Nodes of the search.
    pub nodes: u64,
    /// Relaxations solved.
    pub relaxations: u64,
    /// Wall-clock time of the step.
    pub time: Duration,
}

impl Move {
    /// From a plan.
    pub(super) fn planned(
        solution: &Solution,
        states: Vec<Vec<f64>>,
        inputs: Vec<Vec<f64>>,
        excess: Option<f64>,
    ) -> Self {
        let source = match excess {
            Some(excess) if excess > SOFTENED => MoveSource::Softened,
            _ if solution.is_optimal() => MoveSource::Optimal,
            _ => MoveSource::BestSoFar,
        };
        let input = inputs.first().cloned().unwrap_or_default();
        let mut next = Move::without_plan((input, source, Some(true)));
        (next.states, next.inputs, next.excess) = (states, inputs, excess);
        next.objective = solution.objective();
        next.count(solution);
        next
    }

    /// From an input, where it comes from, and whether it is admissible.
    pub(super) fn without_plan(
        (input, source, is_admissible): (Vec<f64>, MoveSource, Option<bool>),
    ) -> Self {
        Move {
            step: 0,
            state: Vec::new(),
            input,
            source,
            is_admissible,
            states: Vec::new(),
            inputs: Vec::new(),
            objective: None,
            bound: f64::NAN,
            excess: None,
            reason: None,
            nodes: 0,
            relaxations: 0,
            time: Duration::ZERO,
        }
    }

    /// Takes in the figures of a solve.
    pub(super) fn count(&mut self, solution: &Solution) {
        let statistics = solution.statistics();
        self.bound = solution.bound();
        self.nodes = statistics.nodes;
        self.relaxations = statistics.relaxations;
    }
}
