//! The shortest horizon of a family of programs: the search, and behind it the logs, if they are
//! asked for.

use super::HorizonModel;
use super::options::ShortestOptions;
use super::outcome::{ShortestHorizon, SolvedHorizon};
use super::proofs::{HorizonLogs, without_logs};
use super::search::find;
use crate::error::Error;
use crate::solver::Solver;

/// Finds the smallest feasible horizon and refutes the smaller ones.
///
/// # Errors
///
/// [`ErrorKind::OutOfRange`](crate::error::ErrorKind::OutOfRange) for a bad `max_steps`; errors of
/// building and of the solver.
pub fn shortest_horizon<B: HorizonModel + ?Sized>(
    builder: &B,
    options: &ShortestOptions,
    solver: &mut dyn Solver,
) -> Result<ShortestHorizon<SolvedHorizon<B::Program>>, Error> {
    without_logs(solver, |solver, folder| {
        let mut found = find(builder, options, solver)?;
        let Some(folder) = folder else { return Ok(found) };
        let mut logs = HorizonLogs::new(folder, options, solver);
        if let (Some(steps), Some(plan)) = (found.steps, &mut found.plan) {
            logs.repeat(builder, steps, plan)?;
        }
        found.proofs = logs.refute(builder, found.refuted_steps.unwrap_or(0))?;
        Ok(found)
    })
}
