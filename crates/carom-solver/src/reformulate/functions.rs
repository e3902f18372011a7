//! Functions of variables as rows.
//!
//! Takes a function; leaves the bounds that it gives its variable, and rows. Each kind of function
//! has its own file for the rows.

use super::direction::{self, Tie};
use super::lowering::Lowering;
use super::{extremum, piecewise, product};
use crate::error::Error;
use crate::interval::Interval;
use crate::model::{Affine, Function, FunctionRef, Variable};

/// Adds the rows of one function and the bounds that follow for its variable.
pub(super) fn apply(
    function: &FunctionRef<'_>,
    tie: Tie,
    lowering: &mut Lowering<'_>,
) -> Result<(), Error> {
    lowering.begin(function.name());
    let result = function.result();
    let range = direction::range(&lowering.model, function.function())?;
    lowering.tighten(result, range)?;
    match function.function() {
        Function::Product { factor, of } => product::apply(result, *factor, of, lowering),
        Function::Absolute(of) => extremum::apply(result, &[of.clone(), -of], 1.0, tie, lowering),
        Function::Maximum(of) => extremum::apply(result, of, 1.0, tie, lowering),
        Function::Minimum(of) => extremum::apply(result, of, -1.0, tie, lowering),
        Function::Piecewise { of, graph } => piecewise::apply(result, of, graph, tie, lowering),
        // No rows equal them: a search in space encloses them.
        Function::Elementary { .. } | Function::Bilinear(_) | Function::Quotient(_) => Ok(()),
    }
}

impl Lowering<'_> {
    /// Intersects a variable's bounds with a function's range. If the intersection is empty, only
    /// the bound nearest to the range stays, and the rows are infeasible.
    fn tighten(&mut self, variable: Variable, range: Interval) -> Result<(), Error> {
        let own = self.model.variable_ref(variable)?.bounds();
        let common = own.intersection(range);
        let (lower, upper) = match () {
            () if common.lower <= common.upper => (common.lower, common.upper),
            () if own.lower > range.upper => (own.lower, own.lower),
            () => (own.upper, own.upper),
        };
        self.model.set_bounds(variable, lower, upper)
    }

    /// Adds the row `lower <= expression <= upper`.
    pub(super) fn affine_row(
        &mut self,
        expression: Affine,
        lower: f64,
        upper: f64,
    ) -> Result<(), Error> {
        let (terms, constant) = expression.into_parts();
        if lower == upper {
            return self.row(terms, lower - constant, upper - constant);
        }
        // Outward, so that rounding the constant never cuts.
        let lower = crate::interval::add_down(lower, -constant);
        let upper = crate::interval::add_up(upper, -constant);
        self.row(terms, lower, upper)
    }
}
