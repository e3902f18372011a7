//! Indicators: "if this holds, then that row does", as first-class statements of a model.
//!
//! `reformulate` turns indicators into big-M rows at each solve.
//! [`Verification`](crate::solution::Verification) checks them as implications, not through these
//! rows.

use super::checks::limits;
use super::conic::ConicRow;
use super::ids::{Indicator, Variable};
use super::literal::Literal;
use super::logic::Logic;
use super::name::Name;
use super::nonlinear::NonlinearRow;
use super::reformulation::BigM;
use super::row::Row;
use super::statement::{SealedStatement, Statement, stored};
use super::store::{IndicatorData, Model, StatementKind};
use super::stored::StoredRow;
use crate::error::{Error, ErrorKind, FINITE_POSITIVE};
use crate::tolerance;

/// The consequence of a condition: a [`Row`], a [`ConicRow`], a [`NonlinearRow`] or logic. Sealed.
pub trait Consequent: sealed::SealedConsequent {
    /// The type of the implication: [`Implication`] or [`Logic`].
    type Output;

    #[doc(hidden)]
    fn after(self, condition: Logic) -> Self::Output;
}

mod sealed {
    use super::{ConicRow, Literal, Logic, NonlinearRow, Row, Variable};

    pub trait SealedConsequent {}
    impl SealedConsequent for Row {}
    impl SealedConsequent for ConicRow {}
    impl SealedConsequent for NonlinearRow {}
    impl SealedConsequent for Logic {}
    impl SealedConsequent for Literal {}
    impl SealedConsequent for Variable {}
}

impl Consequent for Row {
    type Output = Implication;

    fn after(self, condition: Logic) -> Implication {
        Implication { condition, row: self, big_m: BigM::Automatic }
    }
}

impl Consequent for ConicRow {
    type Output = Implication<ConicRow>;

    fn after(self, condition: Logic) -> Implication<ConicRow> {
        Implication { condition, row: self, big_m: BigM::Automatic }
    }
}

impl Consequent for NonlinearRow {
    type Output = Implication<NonlinearRow>;

    fn after(self, condition: Logic) -> Implication<NonlinearRow> {
        Implication { condition, row: self, big_m: BigM::Automatic }
    }
}

macro_rules! consequents {
    ($($type:ty),+) => {$(
        impl Consequent for $type {
            type Output = Logic;

            fn after(self, condition: Logic) -> Logic {
                Logic::implication(condition, self.into())
            }
        }
    )+};
}

consequents!(Logic, Literal, Variable);

/// An implication of a [`Row`], a [`ConicRow`] or a [`NonlinearRow`], not yet added to a model;
/// made by [`Literal::implies`] and [`Logic::implies`].
#[derive(Debug, Clone, PartialEq)]
#[must_use = "an implication does nothing until it is given to `Model::add`"]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Implication<R = Row> {
    pub(crate) condition: Logic,
    pub(crate) row: R,
    pub(crate) big_m: BigM,
}

/// One condition and several rows, or several conic rows, not yet added to a model; made by
/// [`Literal::implies_all`] and [`Logic::implies_all`].
#[derive(Debug, Clone, PartialEq)]
#[must_use = "implications do nothing until they are given to `Model::add`"]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Implications<R = Row> {
    pub(crate) condition: Logic,
    pub(crate) rows: Vec<R>,
}

/// "This holds exactly when the row does", not yet added to a model; made by [`Literal::reify`] and
/// [`Logic::reify`].
#[derive(Debug, Clone, PartialEq)]
#[must_use = "a reification does nothing until it is given to `Model::add`"]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Reification {
    pub(crate) condition: Logic,
    pub(crate) row: Row,
    pub(crate) margin: f64,
}

/// The parts of a reified row in its model.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Reified {
    /// The condition implies the row.
    pub when: Indicator,
    /// The negated condition implies that the row fails by the margin: above its upper limit or
    /// below its lower one. A two-sided row has both indicators, in this order.
    pub otherwise: Vec<Indicator>,
    /// For a two-sided row, the binary that is 1 if the row fails above its upper limit, and 0
    /// otherwise.
    pub above: Option<Variable>,
}

impl SealedStatement for Implication {}
impl Statement for Implication {
    type Handle = Indicator;

    fn add_to(self, model: &mut Model, name: Name) -> Result<Indicator, Error> {
        let row = stored(self.row, model, &name)?;
        model.push_indicator(name, self.condition, row, self.big_m)
    }
}

impl SealedStatement for Implications {}
impl Statement for Implications {
    type Handle = Vec<Indicator>;

    fn add_to(self, model: &mut Model, name: Name) -> Result<Vec<Indicator>, Error> {
        if self.rows.is_empty() {
            return Err(ErrorKind::EmptyRow { name: name.to_string() }.into());
        }
        model.all_or_nothing(|model| {
            let rows = self.rows.into_iter().enumerate();
            rows.map(|(k, row)| {
                let name = one_of_several(&name, k);
                let row = stored(row, model, &name)?;
                model.push_indicator(name, self.condition.clone(), row, BigM::Automatic)
            })
            .collect()
        })
    }
}

/// `name`, `name_2`, `name_3`, ...
pub(super) fn one_of_several(name: &Name, k: usize) -> Name {
    if k == 0 { name.clone() } else { name.suffixed(&format!("_{}", k + 1)) }
}

impl SealedStatement for Reification {}
impl Statement for Reification {
    type Handle = Reified;

    fn add_to(self, model: &mut Model, name: Name) -> Result<Reified, Error> {
        let Reification { condition, row, margin } = self;
        if !(margin > 0.0 && margin < tolerance::INFINITE) {
            return Err(Error::out_of_range_in_words(
                format!("the margin of `{name}`"),
                margin,
                FINITE_POSITIVE,
                "finite and greater than 0",
            ));
        }
        let row = stored(row, model, &name)?;
        let side = |lower: f64, upper: f64| {
            let mut side = row.clone();
            (side.lower, side.upper) = (lower, upper);
            side
        };
        let above = side(row.upper + margin, f64::INFINITY);
        let below = side(f64::NEG_INFINITY, row.lower - margin);
        // A margin that is lost in the limit would be none.
        for (side, finite) in [(&above, row.upper), (&below, row.lower)] {
            if finite.is_finite() {
                limits(side.lower, side.upper, &name)?;
            }
        }
        let lost = row.upper.is_finite() && above.lower <= row.upper
            || row.lower.is_finite() && below.upper >= row.lower;
        if lost {
            return Err(Error::out_of_range_in_words(
                format!("the margin of `{name}`"),
                margin,
                ..,
                "large enough to tell apart from the row's limit in double precision",
            ));
        }
        let fails = !condition.clone();
        let add = |model: &mut Model, name: Name, condition: Logic, row: StoredRow| {
            model.push_indicator(name, condition, row, BigM::Automatic)
        };
        model.all_or_nothing(|model| {
            let when = add(model, name.clone(), condition.clone(), row.clone())?;
            if row.lower.is_infinite() || row.upper.is_infinite() {
                let row = if row.lower.is_infinite() { above } else { below };
                let otherwise = vec![add(model, name.suffixed("_else"), fails, row)?];
                return Ok(Reified { when, otherwise, above: None });
            }
            let side = model.binary(name.suffixed("_above"))?;
            let otherwise = vec![
                add(model, name.suffixed("_else_above"), side.into(), above)?,
                add(model, name.suffixed("_else_below"), fails & !side, below)?,
            ];
            // "Above" means that the row fails, so it is 0 if the row holds.
            model.push_logical(name.suffixed("_above"), side.implies(!condition))?;
            Ok(Reified { when, otherwise, above: Some(side) })
        })
    }
}

impl<R> Implication<R> {
    /// Uses this big-M (in the row's unit, for each side that needs one) instead of the automatic
    /// one. Lowering refuses it unless the bounds prove it.
    pub fn big_m(mut self, value: f64) -> Self {
        self.big_m = BigM::Given(value);
        self
    }

    /// Uses the given big-M without proof. The report lists it. This has no effect without a given
    /// value.
    ///
    /// An M that is too small cuts off feasible points, and no check of the solution can detect
    /// that.
    pub fn assume_valid(mut self) -> Self {
        if let BigM::Given(value) = self.big_m {
            self.big_m = BigM::Assumed(value);
        }
        self
    }
}

impl Model {
    /// Adds an indicator after checking its condition and its big-M.
    #[doc(hidden)]
    pub fn push_indicator(
        &mut self,
        name: Name,
        condition: impl Into<Logic>,
        row: StoredRow,
        big_m: BigM,
    ) -> Result<Indicator, Error> {
        let condition = condition.into();
        condition.check(self, &name)?;
        big_m.check(&name)?;
        let id = Indicator::new(self.stored.indicators.len(), self.stored.tag);
        self.claim_statement(&name, (StatementKind::Indicator, id.index))?;
        self.stored.indicators.push(IndicatorData { name, condition, row, big_m });
        Ok(id)
    }
}

impl BigM {
    /// Checks a value of the user's.
    pub(super) fn check(self, name: &Name) -> Result<(), Error> {
        match self {
            BigM::Given(value) | BigM::Assumed(value)
                if !(0.0..tolerance::INFINITE).contains(&value) =>
            {
                Err(Error::out_of_range_in_words(
                    format!("the big-M of `{name}`"),
                    value,
                    0.0..f64::INFINITY,
                    "finite and not negative",
                ))
            }
            _ => Ok(()),
        }
    }
}
