//! Statements and costs times a flow: their perspectives.
//!
//! A convex statement over a point `x` becomes one over a flow `y` in `[0, 1]` and a copy `z = y x`
//! that holds for `y = 1` as the statement does and for `y = 0` where `z = 0`: constants are
//! multiplied by `y`. Norms are positively homogeneous, so they stay; squares become
//! `|w|^2 <= t y`.

use super::handles::{ConvexCost, ConvexStatement};
use crate::error::{Error, ErrorKind};
use crate::model::{Affine, Model, Name, Norm, Quadratic, Row, StoredConic, Variable, norm};

/// The copies of the points that a place speaks of, times a flow.
pub(super) struct Copies<'a> {
    pub(super) flow: Variable,
    /// The copy of a variable of the frame.
    pub(super) of: &'a dyn Fn(Variable) -> Affine,
}

impl Copies<'_> {
    /// An expression times the flow.
    pub(super) fn times_flow(&self, expression: &Affine) -> Affine {
        let mut product = expression.offset() * self.flow;
        for (variable, coefficient) in expression.terms() {
            product += coefficient * (self.of)(variable);
        }
        product
    }

    /// The rows of a statement; its first name is `name`.
    pub(super) fn add_statement(
        &self,
        model: &mut Model,
        frame: &Model,
        name: &Name,
        statement: &ConvexStatement,
    ) -> Result<(), Error> {
        match statement {
            ConvexStatement::Row(row) => {
                let product = self.times_flow(row.expression());
                let (lower, upper) = (row.lower(), row.upper());
                if lower == upper {
                    return add_row(model, name, (product - lower * self.flow).equals(0.0));
                }
                if lower.is_finite() {
                    let row = (&product - lower * self.flow).ge(0.0);
                    add_row(model, name, row)?;
                }
                if upper.is_finite() {
                    let name = name.suffixed(" upper");
                    add_row(model, &name, (product - upper * self.flow).le(0.0))?;
                }
                Ok(())
            }
            ConvexStatement::Conic(row) => {
                let cone = frame.standard_cone(row.stored(), name)?;
                let head: Vec<Affine> = cone.head.iter().map(|e| self.times_flow(e)).collect();
                let tail = cone.tail.iter().map(|e| self.times_flow(e)).collect();
                match &head[..] {
                    [head] => add_norm(model, name, tail, head.clone()),
                    [first, second] => add_rotated(model, name, tail, first, second),
                    _ => Ok(()),
                }
            }
        }
    }

    /// The cost times the flow, as an affine expression with variables of its own where it is not
    /// affine.
    pub(super) fn add_cost(
        &self,
        model: &mut Model,
        frame: &Model,
        name: &Name,
        cost: &ConvexCost,
    ) -> Result<Affine, Error> {
        match cost {
            ConvexCost::Norm(norm) => {
                let entries = norm_entries(norm);
                let mut square = 0.0;
                for entry in &entries {
                    square += frame.range(entry)?.magnitude().powi(2);
                }
                let length = model.continuous(name.clone(), 0.0, 2.0 * square.sqrt())?;
                let tail = entries.iter().map(|e| self.times_flow(e)).collect();
                add_norm(model, name, tail, length.into())?;
                Ok(length.into())
            }
            ConvexCost::Quadratic(expression) => {
                let rest = self.times_flow(expression.affine());
                let Some((tail, square)) = checked_cone(frame, expression, name)? else {
                    return Ok(rest);
                };
                let mut most = 0.0;
                for entry in &tail {
                    most += frame.range(entry)?.magnitude().powi(2);
                }
                let value = model.continuous(name.clone(), 0.0, 2.0 * most / square)?;
                let tail = tail.iter().map(|e| self.times_flow(e)).collect();
                add_rotated(model, name, tail, &value.into(), &(square * self.flow))?;
                Ok(rest + value)
            }
        }
    }
}

/// The squares of a convex quadratic expression, `products = |tail|^2 / square`; `None` if it is
/// affine.
///
/// # Errors
///
/// [`ErrorKind::NotConvex`].
pub(super) fn checked_cone(
    frame: &Model,
    expression: &Quadratic,
    name: &Name,
) -> Result<Option<(Vec<Affine>, f64)>, Error> {
    let products = expression.products();
    if products.is_empty() {
        return Ok(None);
    }
    let mut pure = Quadratic::from(-1.0);
    products.into_iter().for_each(|(a, b, q)| pure.add_product(q, a, b));
    let cone = frame.standard_cone(&StoredConic::Quadratic { expression: pure }, name)?;
    let heads: Vec<f64> = cone.head.iter().map(Affine::offset).collect();
    let is_constant = cone.head.iter().all(|head| head.terms().is_empty());
    match heads[..] {
        [head] if is_constant => Ok(Some((cone.tail, head * head))),
        [first, second] if is_constant => Ok(Some((cone.tail, first * second))),
        _ => Err(ErrorKind::NotFinite {
            name: name.to_string(),
            what: "a coefficient of the cost",
            value: f64::NAN,
        }
        .into()),
    }
}

/// The entries of a norm.
pub(super) fn norm_entries(norm: &Norm) -> Vec<Affine> {
    match norm.le(0.0).into_stored() {
        StoredConic::Norm { entries, .. } => entries,
        StoredConic::Quadratic { .. } => Vec::new(),
    }
}

/// Adds a row, unless it has no variable, which it then need not have: it is `0 <= 0`.
fn add_row(model: &mut Model, name: &Name, row: Row) -> Result<(), Error> {
    if !row.is_constant_and_holds() {
        model.add(name.clone(), row)?;
    }
    Ok(())
}

/// Adds `|tail| <= head`.
fn add_norm(model: &mut Model, name: &Name, tail: Vec<Affine>, head: Affine) -> Result<(), Error> {
    let tail: Vec<Affine> = tail.into_iter().filter(|e| !e.terms().is_empty()).collect();
    if tail.is_empty() {
        return add_row(model, name, head.ge(0.0));
    }
    model.add(name.clone(), norm(tail).le(head)).map(|_| ())
}

/// Adds `|tail|^2 <= first second`, both at least 0.
fn add_rotated(
    model: &mut Model,
    name: &Name,
    tail: Vec<Affine>,
    first: &Affine,
    second: &Affine,
) -> Result<(), Error> {
    let mut tail: Vec<Affine> = tail.into_iter().map(|entry| 2.0 * entry).collect();
    tail.push(first - second);
    add_norm(model, name, tail, first + second)
}
