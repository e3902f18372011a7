//! Products with binary and integer variables as rows.
//!
//! Takes a variable that is the product of a binary or integer variable and an expression; leaves
//! rows, and binaries for the bits of an integer (Glover, Improved linear integer programming
//! formulations of nonlinear integer problems, Management Science 22, 1975).
//!
//! For a binary `b` and `l <= e <= u`, `w = b e` is
//! `l b <= w <= u b` and `e - u (1 - b) <= w <= e - l (1 - b)`: the convex hull of both cases.
//! An integer `n` in `[p, q]` is split into bits, `n = p + b0 + 2 b1 + 4 b2 + ...`, and
//! `w = p e + b0 e + 2 b1 e + ...`.

use super::lowering::Lowering;
use crate::error::Error;
use crate::interval::Interval;
use crate::model::{Affine, Variable, VariableKind};

/// The largest range of an integer factor.
const MAX_FACTOR_RANGE: f64 = 1000.0;

/// Adds the rows of `result = factor * of`.
pub(super) fn apply(
    result: Variable,
    factor: Variable,
    of: &Affine,
    lowering: &mut Lowering<'_>,
) -> Result<(), Error> {
    if of.terms().is_empty() {
        return lowering.affine_row(result - of.offset() * factor, 0.0, 0.0);
    }
    let bounds = lowering.finite_bounds(factor)?;
    let (low, high) = (bounds.lower.ceil(), bounds.upper.floor());
    let own = lowering.model.variable_ref(factor)?.bounds();
    if own.lower.ceil() < low || high < own.upper.floor() {
        // Implied bounds may come from this very function.
        lowering.affine_row(factor.into(), low, high)?;
    }
    if low == high {
        return lowering.affine_row(result - low * of, 0.0, 0.0);
    }
    if (low, high) == (0.0, 1.0) {
        return binary(result, factor, of, lowering);
    }
    let width = high - low;
    if width > MAX_FACTOR_RANGE {
        return Err(Error::out_of_range_with(
            format!(
                "the range of the integer `{}` in the product `{}`",
                lowering.model.name_of(factor),
                lowering.statement()
            ),
            width,
            ..=MAX_FACTOR_RANGE,
            "; tighten its bounds",
        ));
    }
    let range = lowering.bounded_range(of)?.hull(Interval::point(0.0));
    let (mut number, mut sum) = (Affine::constant(low), low * of);
    let mut weight = 1.0;
    // An empty range (no integer between the bounds) makes the rows infeasible.
    while weight <= width {
        let bit = lowering.column("bit", VariableKind::Binary, 0.0, 1.0)?;
        let part = lowering.column("part", VariableKind::Continuous, range.lower, range.upper)?;
        binary(part, bit, of, lowering)?;
        number += weight * bit;
        sum += weight * part;
        weight *= 2.0;
    }
    lowering.affine_row(factor - number, 0.0, 0.0)?;
    lowering.affine_row(result - sum, 0.0, 0.0)
}

/// Adds the four rows of `result = factor * of` for a binary factor.
fn binary(
    result: Variable,
    factor: Variable,
    of: &Affine,
    lowering: &mut Lowering<'_>,
) -> Result<(), Error> {
    // If the factor is 1, it is 1 in the expression as well; if it is 0, the expression does not
    // matter.
    let (terms, constant) = of.clone().into_parts();
    let mut expression = Affine::constant(constant);
    for (variable, coefficient) in terms {
        match variable == factor {
            true => expression += Affine::constant(coefficient),
            false => expression.add_term(coefficient, variable),
        }
    }
    let Interval { lower, upper } = lowering.bounded_range(&expression)?;
    if expression.terms().is_empty() {
        return lowering.affine_row(result - expression.offset() * factor, 0.0, 0.0);
    }
    let (none, any) = (f64::NEG_INFINITY, f64::INFINITY);
    lowering.affine_row(result - lower * factor, 0.0, any)?;
    lowering.affine_row(result - upper * factor, none, 0.0)?;
    let rest = result - expression;
    lowering.affine_row(&rest - lower * factor, none, -lower)?;
    lowering.affine_row(rest - upper * factor, -upper, any)
}
