//! Coarse to fine: the mode sequence of a plan on a coarser grid as a MIP start.

use super::HorizonModel;
use super::options::ShortestOptions;
use super::outcome::SolvedHorizon;
use super::search::find;
use crate::error::Error;
use crate::hybrid::reach::HorizonVariables;
use crate::interval::Interval;
use crate::model::{Model, Variable};
use crate::solver::{Solver, StopToken};

/// The share of the remaining time that the coarser search may take.
const SHARE: u32 = 4;

/// How many times longer than the horizon a plan on the coarser grid may be.
const AS_LONG: f64 = 2.0;

/// The result on the coarser grid.
pub(super) enum Guess {
    NotAsked,
    /// There is no coarser grid, or no plan was found on it for horizons of up to so many steps.
    Nothing {
        up_to: usize,
    },
    /// Per family of binaries, their values over the coarser plan's steps.
    Modes(Vec<Vec<bool>>),
}

impl Guess {
    /// Whether to ask for a horizon: if that was never done, or for much shorter ones alone.
    pub(super) fn is_due(&self, steps: usize) -> bool {
        match self {
            Guess::NotAsked => true,
            Guess::Nothing { up_to } => steps >= up_to.saturating_mul(2),
            Guess::Modes(_) => false,
        }
    }

    /// Searches the coarser grid, if there is one, for a plan that takes about as long as some
    /// steps, with a share of the remaining time.
    pub(super) fn ask<B: HorizonModel + ?Sized>(
        builder: &B,
        steps: usize,
        options: &ShortestOptions,
        solver: &mut dyn Solver,
        token: &StopToken,
    ) -> Result<Guess, Error> {
        let nothing = Guess::Nothing { up_to: steps };
        let Some(coarser) = builder.coarser() else { return Ok(nothing) };
        let mut options = options.without_statements().unwatched();
        options.upper_hint = None;
        options.time_limit = token.left().map(|left| left / SHARE);
        if let (Some(own), Some(coarse)) = (builder.time_step(), coarser.time_step()) {
            let most = (AS_LONG * steps as f64 * own / coarse).ceil() as usize + 1;
            // A search that is as long as the one it helps does not help, nor one on ever coarser
            // grids.
            if most >= steps {
                return Ok(nothing);
            }
            options.max_steps = options.max_steps.min(most);
        }
        // Nobody has asked for the coarser grid: what is wrong there is no error.
        let mut found = find(&*coarser, &options, solver).ok();
        let Some(SolvedHorizon { program, solution }) =
            found.as_mut().and_then(|f| f.plan.as_mut())
        else {
            return Ok(nothing);
        };
        let mut modes = Vec::new();
        for family in coarser.variables(program).binaries() {
            let values = family.iter().map(|z| Ok(solution.value(z)? > 0.5));
            modes.push(values.collect::<Result<Vec<bool>, Error>>()?);
        }
        let fits = !modes.is_empty() && modes.iter().all(|values| !values.is_empty());
        Ok(if fits { Guess::Modes(modes) } else { nothing })
    }
}

/// Fixes the binaries at the coarser plan's values, except around its changes. Returns the bounds
/// to restore, or `None` if the guess does not fit the program.
pub(super) fn restricted(
    modes: &[Vec<bool>],
    model: &mut Model,
    variables: &HorizonVariables,
) -> Result<Option<Vec<(Variable, Interval)>>, Error> {
    let mut fixings = Vec::new();
    if variables.binaries().count() != modes.len() {
        return Ok(None);
    }
    for (family, coarse) in variables.binaries().zip(modes) {
        for (t, variable) in family.iter().enumerate() {
            let at = t * coarse.len() / family.len();
            let near = at.saturating_sub(1)..=(at + 1).min(coarse.len() - 1);
            if near.clone().any(|s| coarse[s] != coarse[at]) {
                continue;
            }
            let (value, bounds) = (f64::from(u8::from(coarse[at])), model.variable_ref(variable)?);
            let bounds = bounds.bounds();
            if !bounds.contains(value) {
                return Ok(None);
            }
            if bounds.lower < bounds.upper {
                fixings.push((variable, bounds, value));
            }
        }
    }
    for &(variable, _, value) in &fixings {
        model.fix(variable, value)?;
    }
    Ok(Some(fixings.into_iter().map(|(variable, bounds, _)| (variable, bounds)).collect()))
}
