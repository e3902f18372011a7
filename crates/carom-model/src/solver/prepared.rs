//! Solving one model many times, for other values of its parameters.

use super::control::Control;
use super::{Options, Solver};
use crate::error::Error;
use crate::model::{Model, Variable};
use crate::solution::Solution;

/// A model that is solved again and again for other values of its parameters; made by
/// [`Solver::prepare`].
///
/// The work that is the same for all values in the declared ranges is done once, when the model is
/// prepared. The integers of the last point are tried first, unless a MIP start is given. A solve
/// has the status and, within the gaps, the objective of a solve from nothing.
///
/// ```
/// use carom::prelude::*;
/// use carom::solver::Prepared;
///
/// let mut model = Model::new("tracking");
/// let x = model.continuous("x", 0.0, 10.0)?;
/// let far = model.binary("far")?;
/// let wanted = model.parameter("wanted", 5.0, 0.0, 10.0)?;
/// model.add("far", far.on().implies(x.ge(7.0)))?;
/// model.add("near", far.off().implies(x.le(2.0)))?;
/// model.minimize((x - wanted).square())?;
///
/// let mut solver = BranchAndBound::default();
/// let mut prepared = solver.prepare(&model)?;
/// for (value, best) in [(5.0, 7.0), (4.0, 2.0), (9.0, 9.0)] {
///     let solution = prepared.solve(&[(wanted, value)], &mut Control::default())?;
///     assert!((solution.value(x)? - best).abs() < 1e-6);
/// }
/// let outside = prepared.solve(&[(wanted, 11.0)], &mut Control::default());
/// assert!(outside.is_err());
/// # Ok::<(), carom::Error>(())
/// ```
pub trait Prepared {
    /// The model with the parameters of the last solve. Solutions belong to it and to its clones.
    fn model(&self) -> &Model;

    /// The solver's options, for changes between solves, such as a time limit.
    fn options_mut(&mut self) -> &mut Options;

    /// Solves the model for these values of parameters; those that are not listed keep theirs. In a
    /// loop, [`Control::with_steps_passed`] says how many steps later than the last solve this one
    /// begins.
    ///
    /// # Errors
    ///
    /// The errors of [`Model::set_parameter`], such as
    /// [`ErrorKind::OutOfRange`](crate::error::ErrorKind::OutOfRange) for a value outside the
    /// declared range, and no parameter has changed then; those of [`Solver::solve_with`].
    fn solve(
        &mut self,
        parameters: &[(Variable, f64)],
        control: &mut Control<'_>,
    ) -> Result<Solution, Error>;
}

/// A prepared model whose every solve begins from nothing.
pub(super) fn prepared_afresh<'a, S: Solver + ?Sized>(
    solver: &'a mut S,
    model: &Model,
) -> Box<dyn Prepared + 'a> {
    Box::new(Afresh { solver, model: model.clone() })
}

/// A model whose every solve begins from nothing.
struct Afresh<'a, S: ?Sized> {
    solver: &'a mut S,
    model: Model,
}

impl<S: Solver + ?Sized> Prepared for Afresh<'_, S> {
    fn model(&self) -> &Model {
        &self.model
    }

    fn options_mut(&mut self) -> &mut Options {
        self.solver.options_mut()
    }

    fn solve(
        &mut self,
        parameters: &[(Variable, f64)],
        control: &mut Control<'_>,
    ) -> Result<Solution, Error> {
        self.model.set_parameters(parameters)?;
        self.solver.solve_with(&self.model, control)
    }
}
