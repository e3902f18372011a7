//! A move of a controller.

use std::fmt;

use web_time::Duration;

use super::fallback::{Substitute, TOLERANCE};
use super::loop_plan::{LoopPlan, by_step};
use crate::hybrid::memory::Memory;
use crate::hybrid::simulate::{Decided, Decisions};
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
    /// The first steps of a program whose later steps are
    /// [relaxed](crate::hybrid::HybridProgram::set_integer_horizon), simulated. It has no
    /// objective; its bound is one on the cost of every plan.
    IntegerHorizon,
    /// A plan, optimal or not, that exceeds softened limits.
    Softened,
    /// The rest of the last plan, simulated from the measured state where there is a system.
    LastPlan,
    /// The feedback of the terminal set.
    TerminalFeedback,
    /// The input of the fallback that the user gave.
    Given,
    /// A plan from another state than the measured one, from which there is none: from the nearest
    /// state within the domains, or from one on the way to the state that the last plan foresaw.
    Recovery,
    /// The next input of the last plan, or no input (0), within the ranges of the inputs, because
    /// no input is known to be admissible.
    Emergency,
}

impl fmt::Display for MoveSource {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            MoveSource::Optimal => "optimal",
            MoveSource::BestSoFar => "best so far",
            MoveSource::IntegerHorizon => "integer horizon",
            MoveSource::Softened => "softened",
            MoveSource::LastPlan => "last plan",
            MoveSource::TerminalFeedback => "terminal feedback",
            MoveSource::Given => "given",
            MoveSource::Recovery => "recovery",
            MoveSource::Emergency => "emergency",
        })
    }
}

/// A move of a [`RecedingHorizon`](super::RecedingHorizon): what to do now, and what is known of
/// it.
///
/// Where the plan has chosen among transitions, a move is more than its input: a plant that is told
/// the input alone runs another plan.
/// [`HybridSystem::simulate`](crate::hybrid::HybridSystem::simulate) takes the whole move; a plant
/// of another kind asks for the [`transition`](ControlMove::transition) or the
/// [`mode`](ControlMove::mode) of a choice.
///
/// ```
/// use carom::prelude::*;
///
/// // A tank that a valve empties; the plan says when it is open.
/// let mut tank = HybridSystem::new(1.0); // s
/// let h = tank.state("h", 0.0, 10.0)?; // m
/// tank.mode_of("valve", "shut")?.next([h.is(h)])?;
/// tank.mode_of("valve", "open")?.next([h.is(h - 1.0)])?.guard(h.ge(1.0))?;
/// let mut program = tank.program(4)?;
/// program.minimize(program.sum((h - 2.0).square())?)?;
/// let mut solver = BranchAndBound::default();
/// let mut controller = RecedingHorizon::new(program, &mut solver)?;
/// let run = controller.run(&[5.0], 5, |state: &[f64], next: &ControlMove| {
///     tank.simulate(state, next)?.end()
/// })?;
/// assert_eq!(run.states.concat(), [5.0, 4.0, 3.0, 2.0, 2.0, 2.0]);
/// assert_eq!(run.moves[2].transition("valve"), Some("open"));
/// assert_eq!(run.moves[3].transition("valve"), Some("shut"));
/// // With the input alone, nothing says whether the valve opens.
/// assert!(tank.simulate(&[5.0], &[&run.moves[0].input]).is_err());
/// # Ok::<(), carom::Error>(())
/// ```
///
/// Its plan is nominal: it promises nothing under disturbances, unless the controller's program is
/// a [robust](crate::hybrid::HybridProgram::robust) one, whose plans leave room for them.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ControlMove {
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
    /// The planned state at each sample, the measured one first; empty without a plan. A recovery
    /// begins in another state.
    pub states: Vec<Vec<f64>>,
    /// The planned input of each step.
    pub inputs: Vec<Vec<f64>>,
    /// For each choice, its name and the planned transition of each step; without a plan that of
    /// this step, as far as it is known. The choices of a
    /// [joined](crate::hybrid::HybridProgram::join) system are named after its name and a blank.
    #[cfg_attr(feature = "serde", serde(default))]
    pub transitions: Vec<(String, Vec<String>)>,
    /// For each choice with memory, its name and the planned mode at each sample.
    #[cfg_attr(feature = "serde", serde(default))]
    pub modes: Vec<(String, Vec<String>)>,
    /// The number of planned events in each step.
    #[cfg_attr(feature = "serde", serde(default))]
    pub events: Vec<usize>,
    /// The memory of the run at the measured state: modes, how long they have lasted, events.
    #[cfg_attr(feature = "serde", serde(default))]
    pub memory: Memory,
    /// The cost of the plan.
    pub objective: Option<f64>,
    /// The proved bound on the cost of any plan, in the model's own sense; `None` if nothing is
    /// proved.
    pub bound: Option<f64>,
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

impl ControlMove {
    /// The transition that a choice (`mode` if there is only one) takes in this step; `None` if
    /// nothing says which.
    pub fn transition(&self, choice: &str) -> Option<&str> {
        let own = self.transitions.iter().find(|(name, _)| name == choice);
        own.and_then(|(_, taken)| taken.first()).map(String::as_str)
    }

    /// The mode with memory that a choice enters or stays in in this step, whose flow acts; `None`
    /// without memory, and if nothing says which.
    pub fn mode(&self, choice: &str) -> Option<&str> {
        let own = self.modes.iter().find(|(name, _)| name == choice);
        own.and_then(|(_, modes)| modes.get(1)).map(String::as_str)
    }

    /// From a plan.
    pub(super) fn planned(solution: &Solution, plan: LoopPlan, excess: Option<f64>) -> Self {
        let is_whole = solution.relaxed().is_empty();
        let source = match excess {
            Some(excess) if excess > SOFTENED => MoveSource::Softened,
            _ if !is_whole => MoveSource::IntegerHorizon,
            _ if solution.is_optimal() => MoveSource::Optimal,
            _ => MoveSource::BestSoFar,
        };
        let mut next = ControlMove::of(Substitute { plan, source, is_admissible: Some(true) });
        next.excess = excess;
        next.objective = solution.objective().filter(|_| is_whole);
        next.count(solution);
        next
    }

    /// From steps, where they come from, and whether they are admissible.
    pub(super) fn of(own: Substitute) -> Self {
        let Substitute { plan, source, is_admissible } = own;
        let mut next = ControlMove {
            step: 0,
            state: Vec::new(),
            input: plan.inputs.first().cloned().unwrap_or_default(),
            source,
            is_admissible,
            states: plan.states,
            inputs: plan.inputs,
            transitions: plan.transitions,
            modes: plan.modes,
            events: plan.events,
            memory: Memory::default(),
            objective: None,
            bound: None,
            excess: None,
            reason: None,
            nodes: 0,
            relaxations: 0,
            time: Duration::ZERO,
        };
        if matches!(
            source,
            MoveSource::TerminalFeedback | MoveSource::Given | MoveSource::Emergency
        ) {
            // An input is no plan.
            (next.states, next.inputs) = (Vec::new(), Vec::new());
        }
        next
    }

    /// Takes in the figures of a solve.
    pub(super) fn count(&mut self, solution: &Solution) {
        let statistics = solution.statistics();
        self.bound = Some(solution.bound()).filter(|bound| bound.is_finite());
        self.nodes = statistics.nodes;
        self.relaxations = statistics.relaxations;
    }
}

impl Decisions for ControlMove {
    #[expect(private_interfaces, reason = "as the trait")]
    fn decided(&self) -> Decided<'_> {
        Decided {
            inputs: vec![&self.input],
            transitions: by_step(&self.transitions, 1),
            memory: Some(&self.memory),
            tolerance: TOLERANCE,
            is_beyond_limits: self.is_admissible == Some(false),
        }
    }
}
