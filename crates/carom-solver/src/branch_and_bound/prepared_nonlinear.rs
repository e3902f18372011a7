//! A model with smooth functions that is solved again and again: each solve begins with a local
//! search from the point of the last one, moved ahead.

use super::last_solve::next_of;
use super::nonlinear::solve_nonlinear;
use crate::error::Error;
use crate::model::{Model, Name, Variable};
use crate::solution::Solution;
use crate::solver::{Control, Options, Prepared};

/// A prepared model with smooth functions.
#[derive(Debug)]
pub(super) struct PreparedNonlinear<'a> {
    options: &'a mut Options,
    model: Model,
    /// The point of the last solve that had one, by variable.
    last: Option<Vec<f64>>,
    /// By variable, where the same variable of the next step is, or the variable itself.
    next: Vec<usize>,
}

impl<'a> PreparedNonlinear<'a> {
    pub(super) fn new(options: &'a mut Options, model: &Model) -> Self {
        let names: Vec<&Name> = model.variables().map(|own| own.name()).collect();
        PreparedNonlinear { options, model: model.clone(), last: None, next: next_of(&names) }
    }
}

impl Prepared for PreparedNonlinear<'_> {
    fn model(&self) -> &Model {
        &self.model
    }

    fn options_mut(&mut self) -> &mut Options {
        self.options
    }

    fn solve(
        &mut self,
        parameters: &[(Variable, f64)],
        control: &mut Control<'_>,
    ) -> Result<Solution, Error> {
        self.model.set_parameters(parameters)?;
        self.options.check()?;
        if let Some(last) = &mut self.last {
            for _ in 0..control.steps_passed() {
                *last = self.next.iter().map(|&k| last[k]).collect();
            }
            for own in self.model.variables().filter(|own| own.parameter_range().is_some()) {
                last[own.id().index()] = own.bounds().lower;
            }
        }
        let solution = solve_nonlinear(&self.model, self.options, control, self.last.as_deref())?;
        if let Some(point) = solution.point() {
            self.last = Some(point.as_slice().to_vec());
        }
        Ok(solution)
    }
}
