//! Solutions whose states are the runs of their inputs.
//!
//! A solution satisfies rows within a tolerance, which an unstable system multiplies. Where the
//! plan of a solution leaves the run from its start, inputs are corrected with its transitions, and
//! the solution becomes that of the corrected run: its objective is computed anew, and it is
//! optimal no more if it is not within the gap.

use std::borrow::Cow;

use super::{HybridProgram, ProgramSystems};
use crate::error::{Error, ErrorKind, RunError};
use crate::hybrid::rows::{HybridRun, SystemVariables};
use crate::hybrid::simulate::Followed;
use crate::interval::Interval;
use crate::model::{Model, Variable};
use crate::solution::{Outcome, Point, Solution, Termination};
use crate::solver::Solver;
use crate::tolerance::{ABSOLUTE_GAP, FEASIBILITY, RELATIVE_GAP};

/// The share of its range that an input leaves free at each end where a plan is looked for that can
/// be corrected (no unit).
const INPUT_ROOM: f64 = 1e-4;

/// The drift for which an error refuses a plan, if it does.
pub(crate) fn as_drift(error: &Error) -> Option<&RunError> {
    match error.kind() {
        ErrorKind::Run(own @ RunError::Drift { .. }) => Some(own),
        _ => None,
    }
}

impl HybridProgram {
    /// The solution whose states are the runs of its inputs: itself, or a corrected one.
    ///
    /// # Arguments
    ///
    /// * `solver`: for values of variables beside the systems, and for another plan with the same
    ///   transitions.
    ///
    /// # Errors
    ///
    /// [`RunError::Drift`] if there is none; errors of the solver.
    pub(crate) fn settled<'s>(
        &self,
        solution: &'s Solution,
        solver: Option<&mut dyn Solver>,
    ) -> Result<Cow<'s, Solution>, Error> {
        self.systems.settled(&self.model, solution, solver)
    }
}

impl ProgramSystems {
    /// As [`HybridProgram::settled`], for the program's model.
    pub(crate) fn settled<'s>(
        &self,
        model: &Model,
        solution: &'s Solution,
        mut solver: Option<&mut dyn Solver>,
    ) -> Result<Cow<'s, Solution>, Error> {
        let Some(point) = solution.point() else { return Ok(Cow::Borrowed(solution)) };
        if self.integer_steps.is_some() {
            return Ok(Cow::Borrowed(solution));
        }
        let Some((corrections, drift)) = self.corrected(model, point)? else {
            return Ok(Cow::Borrowed(solution));
        };
        for runs in corrections {
            let solver: Option<&mut dyn Solver> = match &mut solver {
                Some(own) => Some(&mut **own),
                None => None,
            };
            if let Some(found) = self.with_runs(model, solution, &runs, point, solver)? {
                return Ok(Cow::Owned(found));
            }
        }
        let Some(drift) = drift else { return Ok(Cow::Borrowed(solution)) };
        let Some(solver) = solver else { return Err(drift.into()) };
        // Another plan with the same transitions, whose inputs can be corrected.
        let another = self.with_room(model, point, solver)?;
        let Some(another) = another.as_ref().and_then(Solution::point) else {
            return Err(drift.into());
        };
        let Some((corrections, _)) = self.corrected(model, another)? else {
            let feasibility = solver.options().feasibility;
            let found = with_values(model, solution, another.as_slice().to_vec(), feasibility)?;
            return found.point().is_some().then_some(Cow::Owned(found)).ok_or(drift.into());
        };
        for runs in corrections {
            if let Some(found) = self.with_runs(model, solution, &runs, another, Some(solver))? {
                return Ok(Cow::Owned(found));
            }
        }
        Err(drift.into())
    }

    /// Follows the runs of a point from their starts: `None` if all are as planned, and otherwise
    /// corrections of all runs together, and the drift for which they are made, if they must be.
    fn corrected(&self, model: &Model, point: &Point) -> Result<Option<Corrections>, Error> {
        let (mut all, mut drift): (Vec<Vec<HybridRun>>, _) = (Vec::new(), None);
        let mut is_corrected = false;
        for own in self.iter() {
            let run = own.read_point(point)?;
            let start = stated_start(own, model, point)?;
            match own.system().follow(&run, &start)? {
                Followed::AsPlanned => all.push(vec![run]),
                Followed::Leaves(runs, error) => {
                    all.push(runs);
                    is_corrected = true;
                    drift = drift.or(error);
                }
            }
        }
        let most = all.iter().map(Vec::len).max().unwrap_or(0);
        let together =
            |k: usize| all.iter().map(|own| own.get(k).or(own.last()).cloned()).collect();
        Ok(is_corrected.then(|| ((0..most).filter_map(together).collect(), drift)))
    }

    /// The solution with these runs in the place of its own, if the model and the systems accept
    /// it. Other variables keep their values in `point` if they can, and the solver chooses them
    /// otherwise.
    fn with_runs(
        &self,
        model: &Model,
        solution: &Solution,
        runs: &[HybridRun],
        point: &Point,
        solver: Option<&mut dyn Solver>,
    ) -> Result<Option<Solution>, Error> {
        if !self.iter().zip(runs).all(|(own, run)| own.system().certify(run).is_ok()) {
            return Ok(None);
        }
        let mut values = point.as_slice().to_vec();
        let mut known = vec![false; values.len()];
        for (own, run) in self.iter().zip(runs) {
            for (variable, value) in own.values(run)? {
                values[variable.index()] = value;
                known[variable.index()] = true;
            }
        }
        let feasibility = solver.as_ref().map_or(FEASIBILITY, |own| own.options().feasibility);
        let accepted = |values: Vec<f64>| -> Result<Option<Solution>, Error> {
            let found = with_values(model, solution, values, feasibility)?;
            Ok(found.point().is_some().then_some(found))
        };
        if let Some(found) = accepted(values.clone())? {
            return Ok(Some(found));
        }
        let Some(solver) = solver else { return Ok(None) };
        let mut rest = model.clone();
        for (variable, value) in model.variables().zip(&values) {
            let is_parameter = variable.parameter_range().is_some();
            let is_decided = known[variable.id().index()] || variable.kind().is_integral();
            if is_decided && !is_parameter {
                rest.fix(variable.id(), *value)?;
            }
        }
        let completed = solve(solver, &rest)?;
        match completed.point() {
            Some(point) => accepted(point.as_slice().to_vec()),
            None => Ok(None),
        }
    }

    /// A solution with the transitions of a point and inputs that leave some of their ranges free.
    fn with_room(
        &self,
        model: &Model,
        point: &Point,
        solver: &mut dyn Solver,
    ) -> Result<Option<Solution>, Error> {
        let (mut narrow, mut has_room) = (model.clone(), false);
        for own in self.iter() {
            own.fix_transitions(&mut narrow, &own.read_point(point)?)?;
            for variable in own.inputs().iter().flatten() {
                let range = narrow.variable_ref(variable)?.bounds();
                let room = INPUT_ROOM * (range.upper - range.lower);
                if room.is_finite() && room > 0.0 {
                    has_room = true;
                    narrow.set_bounds(variable, range.lower + room, range.upper - room)?;
                }
            }
        }
        if !has_room {
            return Ok(None);
        }
        let found = solve(solver, &narrow)?;
        Ok(found.point().is_some().then_some(found))
    }
}

/// Ways to correct all runs, and the drift for which they must be corrected, if they must.
type Corrections = (Vec<Vec<HybridRun>>, Option<RunError>);

/// Solves without a log, which would replace that of the search.
fn solve(solver: &mut dyn Solver, model: &Model) -> Result<Solution, Error> {
    let proof = solver.options_mut().proof.take();
    let found = solver.solve(model);
    solver.options_mut().proof = proof;
    found
}

/// A solution with other values, as far as it is optimal with them.
fn with_values(
    model: &Model,
    solution: &Solution,
    values: Vec<f64>,
    feasibility: f64,
) -> Result<Solution, Error> {
    let outcome = |termination| {
        let (bound, statistics) = (solution.bound(), *solution.statistics());
        Outcome::new(termination, Some(values.clone()), bound, statistics)
    };
    let found = Solution::new(model, outcome(solution.termination()), feasibility)?;
    let is_within = found.gap() <= solution.gap().max(ABSOLUTE_GAP)
        || found.relative_gap() <= solution.relative_gap().max(RELATIVE_GAP);
    let found = match found.is_optimal() && !is_within {
        true => Solution::new(model, outcome(Termination::Stalled), feasibility)?,
        false => found,
    };
    let proof = solution.proof().cloned().filter(|_| found.is_optimal());
    Ok(found.with_start_report(solution.start_report().cloned()).with_proof(proof))
}

/// The first sample of a system as bounds and rows about one of its states state it; the point's
/// values satisfy them within a tolerance only. Rows come last, because bounds may be those of
/// sets, which have margins.
fn stated_start(own: &SystemVariables, model: &Model, point: &Point) -> Result<Vec<f64>, Error> {
    let first: Vec<Variable> = own.states().iter().filter_map(|family| family.get(0)).collect();
    let mut start = Vec::with_capacity(first.len());
    for &variable in &first {
        let bounds = model.variable_ref(variable)?.bounds();
        start.push(bounds.nearest(point.value(variable)?));
    }
    for row in model.constraints() {
        let (mut state, mut rest, mut is_of_one) = (None, 0.0, true);
        for &(variable, factor) in row.terms() {
            if let Some(own) = first.iter().position(|first| *first == variable) {
                is_of_one &= state.replace((own, factor)).is_none();
            } else if model.variable_ref(variable)?.parameter_range().is_some() {
                rest += factor * point.value(variable)?;
            } else {
                is_of_one = false;
                break;
            }
        }
        if let (Some((state, factor)), true) = (state, is_of_one) {
            let limits = row.limits();
            let ends = [limits.lower, limits.upper].map(|limit| (limit - rest) / factor);
            let range = Interval::new(ends[0].min(ends[1]), ends[0].max(ends[1]));
            start[state] = range.nearest(start[state]);
        }
    }
    let coordinates = own.coordinates();
    let outward = |(i, value): (usize, &f64)| coordinates.state(i).outward(*value);
    Ok(start.iter().enumerate().map(outward).collect())
}
