//! The statements that can be added to a model: their trait, and rows.

use super::checks::{finite, limits};
use super::ids::Constraint;
use super::name::Name;
use super::row::Row;
use super::store::Model;
use super::stored::StoredRow;
use crate::error::{Error, ErrorKind};

/// Something [`Model::add`] accepts: a [`Row`], a [`ConicRow`](super::ConicRow), an
/// [`Implication`](super::Implication) or several, a [`Reification`](super::Reification), a
/// disjunction ([`Either`](super::Either)), a [`Logic`](super::Logic) formula, a
/// [`Literal`](super::Literal) or a special ordered set ([`Sos`](super::Sos)). Sealed.
#[diagnostic::on_unimplemented(
    message = "`{Self}` is no statement that a model can hold",
    label = "not a row, an implication, a disjunction, a formula or an ordered set",
    note = "an expression becomes a row by a comparison: `.le(1.0)`, `.ge(1.0)`, `.equals(1.0)`, \
            `.within(0.0, 1.0)`",
    note = "`<=` and `==` of Rust give a `bool` at once, so they are no rows"
)]
pub trait Statement: SealedStatement {
    /// The handle that adding returns.
    type Handle;

    #[doc(hidden)]
    fn add_to(self, model: &mut Model, name: Name) -> Result<Self::Handle, Error>;
}

/// Keeps [`Statement`] to the types of this crate.
pub trait SealedStatement {}

impl SealedStatement for Row {}
impl Statement for Row {
    type Handle = Constraint;

    fn add_to(self, model: &mut Model, name: Name) -> Result<Constraint, Error> {
        let row = stored(self, model, &name)?;
        model.push_constraint(name, row)
    }
}

impl Model {
    /// Checks a row against this model and brings it into stored form, without adding it.
    #[doc(hidden)]
    pub fn stored_row(&self, row: Row, name: &Name) -> Result<StoredRow, Error> {
        stored(row, self, name)
    }
}

/// Checks a row against the model and brings it into stored form.
pub(super) fn stored(row: Row, model: &Model, name: &Name) -> Result<StoredRow, Error> {
    let (terms, constant) = row.expression.into_parts();
    for &(variable, coefficient) in &terms {
        model.check_variable(variable, name)?;
        finite(coefficient, "a coefficient", name)?;
    }
    finite(constant, "the constant", name)?;
    let (lower, upper) = limits(row.lower, row.upper, name)?;
    // A sum over nothing, as at the first index of a family, may well hold.
    if terms.is_empty() && !(lower <= constant && constant <= upper) {
        return Err(
            ErrorKind::FalseRow { name: name.to_string(), value: constant, lower, upper }.into()
        );
    }
    let moved = |limit: f64| if limit.is_finite() { limit - constant } else { limit };
    // They may count as infinite only now.
    let (lower, upper) = limits(moved(lower), moved(upper), name)?;
    Ok(StoredRow { terms, lower, upper })
}
