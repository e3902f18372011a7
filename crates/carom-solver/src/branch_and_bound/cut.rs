//! The phase before the tree: costs and cuts make the relaxation of the root tighter.
//!
//! A pilot search of one node tells whether cuts are wanted. The search takes over its results.

use super::start::start_point;
use crate::program::Program;
use crate::search::cuts::strengthen;
use crate::search::{
    PilotResult, Root, RootCuts, SearchResult, SolveTask, Start, StartPoint, search,
    with_perspective,
};
use crate::solution::{Heuristic, Statistics, Termination};
use crate::solver::{BranchingRule, Control, Event, Heuristics, Progress};

/// The result of the phase of cuts.
#[derive(Default)]
pub(super) struct CutOutcome {
    /// The strengthened program; `None` if it is as it was.
    pub(super) program: Option<Program>,
    /// The value of the relaxed root before the phase and after it, if anything was strengthened.
    values: Option<[f64; 2]>,
    /// Whether the root has cuts that the pilot search has not seen.
    has_cuts: bool,
    /// Its cuts, if a proof wants to know them.
    pub(super) cuts: Option<Box<RootCuts>>,
    pilot: Pilot,
}

/// The results that the pilot search leaves to the search.
#[derive(Default)]
struct Pilot {
    point: Option<StartPoint>,
    /// Whether it ran from the root without cuts.
    ran: bool,
    /// Whether the value of a point is due to limits that presolve has widened, as in
    /// [`SearchResult`].
    is_widened: bool,
    statistics: Statistics,
}

/// Strengthens the program of a task, and carries its root over. Kept leaves are about the program
/// as it is.
pub(super) fn cut(
    task: SolveTask<'_>,
    root: &mut Root,
    start: Option<&Start>,
    control: &mut Control<'_>,
) -> CutOutcome {
    let SolveTask { options, token, .. } = task;
    let mut cascade = task.cascades.take();
    let bent = with_perspective(task.program, root, options, token, &mut cascade);
    let program = bent.as_ref().map_or(task.program, |bent| &bent.program);
    let (task, sign) = (SolveTask { program, ..task }, program.sign);
    let mut pilot = Pilot::default();
    let mut cut = strengthen(program, root, options, token, &mut cascade, &mut |root| {
        if let Some(bound) = root.relaxed_bound() {
            let mut progress = Progress::new(0, 0, 1, None, sign * bound, token.elapsed());
            progress.iterations = root.relaxed_iterations();
            progress.constant = sign * program.constant;
            control.report(&Event::Relaxed(progress));
        }
        pilot.search(SolveTask { root: Some(root), ..task }, start)
    });
    let wanted = cut.as_mut().filter(|_| options.proof_path().is_some());
    let cuts = wanted.map(|cut| Box::new(RootCuts::new(program, root, cut)));
    if bent.is_some() || cut.is_some() {
        root.carry_over(cut.as_ref().map_or(program, |cut| &cut.program), token);
    }
    cascade.take_spent().count(&mut pilot.statistics);
    task.cascades.give_back(cascade);
    let first = bent.as_ref().or(cut.as_ref()).map(|first| first.values[0]);
    let last = cut.as_ref().or(bent.as_ref()).map(|last| last.values[1]);
    CutOutcome {
        values: first.zip(last).map(|(first, last)| [first, last]),
        has_cuts: cut.is_some(),
        cuts,
        program: cut.or(bent).map(|strengthened| strengthened.program),
        pilot,
    }
}

impl CutOutcome {
    /// The start of the search: the given one, with the point of the pilot search if it has none.
    pub(super) fn start(&self, given: Option<&Start>) -> Option<Start> {
        let given = given.cloned();
        if !self.pilot.ran || given.as_ref().is_some_and(|given| given.point.is_some()) {
            return given;
        }
        let (point, is_rounded) = (self.pilot.point.clone(), Some(!self.has_cuts));
        Some(Start { point, is_rounded, ..given.unwrap_or_default() })
    }

    /// Adds the results of this phase to those of the search.
    pub(super) fn add_to(&self, found: &mut SearchResult) {
        found.statistics.add(&self.pilot.statistics);
        found.is_widened |= self.pilot.is_widened;
    }

    /// The part of the gap between the relaxed root and the best value that the phase has closed.
    pub(super) fn closed(&self, best: f64) -> f64 {
        self.values.map_or(0.0, |[first, last]| (last - first) / (best - first))
    }
}

impl Pilot {
    /// Searches the root of a task, with rounding and a roll-out there. Returns `None` if that is
    /// not wanted.
    fn search(&mut self, task: SolveTask<'_>, start: Option<&Start>) -> Option<PilotResult> {
        let SolveTask { program, options, .. } = task;
        if let Some(point) = start.and_then(|start| start.point.as_ref()) {
            let value = Some(program.objective(&point.values));
            return Some(PilotResult { value, bound: f64::NEG_INFINITY, is_closed: false });
        }
        if !options.heuristics.rounding || options.node_limit == Some(0) {
            return None;
        }
        let mut heuristics = Heuristics::none();
        heuristics.rounding = true;
        heuristics.roll_out = options.heuristics.roll_out;
        let options = options.nested().with_heuristics(heuristics);
        let options = &options.with_branching(BranchingRule::LatestFirst).with_node_limit(1);
        #[cfg(feature = "tracing")]
        let _span = tracing::debug_span!("pilot").entered();
        let found = search(SolveTask { options, ..task }, &mut Control::default(), None);
        (self.ran, self.is_widened) = (true, found.is_widened);
        let is_closed = matches!(found.termination, Termination::Optimal | Termination::Infeasible);
        let mut counts = found.statistics;
        counts.forget_incumbents();
        if is_closed {
            self.statistics.add(&counts);
        } else {
            // The root is the search's own.
            counts.nodes -= counts.nodes.min(1);
            self.statistics.heuristics.add(&counts.heuristics);
            self.statistics.add_nested(&counts);
        }
        let value = found.points.first().map(|values| program.objective(values));
        self.point = start_point(&found, Heuristic::Rounding);
        Some(PilotResult { value, bound: found.bound, is_closed })
    }
}
