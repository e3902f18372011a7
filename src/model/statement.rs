//! What can be added to a model: rows, implications, logic.

use super::Model;
#[cfg(feature = "serde")]
use super::affine::merge;
use super::disjunction::Either;
use super::ids::{Constraint, Indicator, LogicalConstraint, Variable};
use super::indicator::{Implication, Implications, Literal, Reification, Reified};
use super::logic::Logic;
use super::name::Name;
use super::row::Row;
use crate::error::{Error, ErrorKind};

/// Something [`Model::add`] accepts: a [`Row`], an [`Implication`] or several, a [`Reification`],
/// a disjunction ([`Either`]), a [`Logic`] formula or a [`Literal`]. Sealed.
pub trait Statement: sealed::Sealed {
    /// The handle that adding returns.
    type Handle;

    #[doc(hidden)]
    fn add_to(self, model: &mut Model, name: Name) -> Result<Self::Handle, Error>;
}

mod sealed {
    pub trait Sealed {}
    impl Sealed for super::Row {}
    impl Sealed for super::Implication {}
    impl Sealed for super::Implications {}
    impl Sealed for super::Reification {}
    impl Sealed for super::Logic {}
    impl Sealed for super::Literal {}
    impl Sealed for super::Either {}
}

/// A row as a model stores it: merged terms, the constant moved into the limits.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct StoredRow {
    pub(crate) terms: Vec<(Variable, f64)>,
    #[cfg_attr(feature = "serde", serde(with = "crate::wire"))]
    pub(crate) lower: f64,
    #[cfg_attr(feature = "serde", serde(with = "crate::wire"))]
    pub(crate) upper: f64,
}

#[cfg(feature = "serde")]
impl StoredRow {
    /// Checks a row from a file; unlike a new one it may be empty.
    pub(crate) fn checked(mut self, model: &Model, name: &Name) -> Result<Self, Error> {
        name.check()?;
        for &(variable, _) in &self.terms {
            model.check_variable(variable, name)?;
        }
        merge(&mut self.terms);
        for &(_, coefficient) in &self.terms {
            finite(coefficient, "a coefficient", name)?;
        }
        (self.lower, self.upper) = limits(self.lower, self.upper, name)?;
        Ok(self)
    }
}

impl Statement for Row {
    type Handle = Constraint;

    fn add_to(self, model: &mut Model, name: Name) -> Result<Constraint, Error> {
        let row = stored(self, model, &name)?;
        model.push_constraint(name, row)
    }
}

impl Statement for Implication {
    type Handle = Indicator;

    fn add_to(self, model: &mut Model, name: Name) -> Result<Indicator, Error> {
        let row = stored(self.row, model, &name)?;
        model.push_indicator(name, self.condition, row, self.big_m)
    }
}

impl Statement for Implications {
    type Handle = Vec<Indicator>;

    fn add_to(self, model: &mut Model, name: Name) -> Result<Vec<Indicator>, Error> {
        self.add_to(model, name)
    }
}

impl Statement for Reification {
    type Handle = Reified;

    fn add_to(self, model: &mut Model, name: Name) -> Result<Reified, Error> {
        self.add_to(model, name)
    }
}

impl Statement for Logic {
    type Handle = LogicalConstraint;

    fn add_to(self, model: &mut Model, name: Name) -> Result<LogicalConstraint, Error> {
        self.add_to(model, name)
    }
}

impl Statement for Literal {
    type Handle = LogicalConstraint;

    fn add_to(self, model: &mut Model, name: Name) -> Result<LogicalConstraint, Error> {
        Logic::from(self).add_to(model, name)
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
    if terms.is_empty() {
        return Err(ErrorKind::EmptyRow { name: name.to_string() }.into());
    }
    let (lower, upper) = limits(row.lower, row.upper, name)?;
    let moved = |limit: f64| if limit.is_finite() { limit - constant } else { limit };
    Ok(StoredRow { terms, lower: moved(lower), upper: moved(upper) })
}

/// Checks a pair of row limits; magnitudes from [`tolerance::INFINITE`](crate::tolerance::INFINITE)
/// on become infinite.
pub(crate) fn limits(lower: f64, upper: f64, name: &Name) -> Result<(f64, f64), Error> {
    let (lower, upper) = bounds(lower, upper, name)?;
    if lower.is_infinite() && upper.is_infinite() {
        return Err(ErrorKind::UnlimitedRow { name: name.to_string() }.into());
    }
    Ok((lower, upper))
}

/// Checks a pair of bounds; one or both may be infinite.
pub(crate) fn bounds(lower: f64, upper: f64, name: &Name) -> Result<(f64, f64), Error> {
    let not_finite =
        |what, value| Err(ErrorKind::NotFinite { name: name.to_string(), what, value }.into());
    if lower.is_nan() || lower >= crate::tolerance::INFINITE {
        return not_finite("the lower limit", lower);
    }
    if upper.is_nan() || upper <= -crate::tolerance::INFINITE {
        return not_finite("the upper limit", upper);
    }
    if lower > upper {
        return Err(ErrorKind::CrossedBounds { name: name.to_string(), lower, upper }.into());
    }
    let lower = if lower <= -crate::tolerance::INFINITE { f64::NEG_INFINITY } else { lower };
    let upper = if upper >= crate::tolerance::INFINITE { f64::INFINITY } else { upper };
    Ok((lower, upper))
}

/// Refuses NaN, infinities and magnitudes that are treated as infinite.
pub(crate) fn finite(value: f64, what: &'static str, name: &Name) -> Result<(), Error> {
    if value.abs() < crate::tolerance::INFINITE {
        Ok(())
    } else {
        Err(ErrorKind::NotFinite { name: name.to_string(), what, value }.into())
    }
}
