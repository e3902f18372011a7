//! Norms as quadratic rows, for formats that know no others.

use std::borrow::Cow;

use crate::error::Error;
use crate::interval::Interval;
use crate::model::affine::Affine;
use crate::model::checks::finite;
use crate::model::conic::StoredConic;
use crate::model::ids::Variable;
use crate::model::logic::Logic;
use crate::model::name::Name;
use crate::model::quadratic::Quadratic;
use crate::model::reformulation::BigM;
use crate::model::store::{ConicData, Model};
use crate::model::stored::StoredRow;
use crate::model::text::token::or_infinite;

/// The model with a quadratic row for every norm: the sum of the squares of its entries is at most
/// the square of its bound.
///
/// Further variables stand for entries that are no single variables and for bounds whose sign their
/// own bounds do not show, and wherever squaring a factor would round it.
pub fn with_quadratic_rows(model: &Model) -> Result<Cow<'_, Model>, Error> {
    let is_norm = |conic: &StoredConic| matches!(conic, StoredConic::Norm { .. });
    if !model.conic_constraints().any(|conic| is_norm(conic.conic())) {
        return Ok(Cow::Borrowed(model));
    }
    let mut rewritten = model.clone();
    for at in 0..rewritten.stored.conic.len() {
        let ConicData { name, condition, conic, .. } = rewritten.stored.conic[at].clone();
        if let StoredConic::Norm { entries, bound } = conic {
            let mut squares = NormSquares { model: &mut rewritten, name, condition };
            let expression = squares.row(&entries, &bound)?;
            rewritten.stored.conic[at].conic = StoredConic::Quadratic { expression };
        }
    }
    Ok(Cow::Owned(rewritten))
}

/// One norm, and the model that gets what it needs.
struct NormSquares<'m> {
    model: &'m mut Model,
    name: Name,
    condition: Option<Logic>,
}

impl NormSquares<'_> {
    /// The sum of the squares of the entries minus that of the bound.
    fn row(&mut self, entries: &[Affine], bound: &Affine) -> Result<Quadratic, Error> {
        let mut sum = Quadratic::zero();
        for (position, entry) in entries.iter().enumerate() {
            match square(entry) {
                Some(square) => sum += square,
                None => {
                    let x = self.variable(&format!("_entry{position}"), entry, false)?;
                    self.row_of(x, entry, false)?;
                    sum.add_product(1.0, x, x);
                }
            }
        }
        let is_positive = match bound.terms()[..] {
            [] => bound.offset() >= 0.0,
            [(x, factor)] => factor > 0.0 && self.model.variable_ref(x)?.bounds().lower >= 0.0,
            _ => false,
        };
        match square(bound).filter(|_| is_positive) {
            Some(square) => sum += square * -1.0,
            None => {
                let x = self.variable("_bound", bound, true)?;
                self.row_of(x, bound, true)?;
                sum.add_product(-1.0, x, x);
            }
        }
        Ok(sum.compacted())
    }

    /// A variable for an entry or for the bound. Under a condition it gets the bounds of what it
    /// stands for, because a row that may be switched off needs them.
    fn variable(
        &mut self,
        suffix: &str,
        expression: &Affine,
        is_bound: bool,
    ) -> Result<Variable, Error> {
        let wanted = self.name.suffixed(suffix);
        let model = &self.model;
        let name = wanted
            .free(|name| model.variable_by_name(name.clone()).is_ok() || model.has_statement(name));
        let range = match self.condition {
            Some(_) => model.range(expression)?,
            None => Interval::new(f64::NEG_INFINITY, f64::INFINITY),
        };
        let (lower, upper) = (or_infinite(range.lower), or_infinite(range.upper));
        match is_bound {
            true => self.model.continuous(name, 0.0, upper.max(0.0)),
            false => self.model.continuous(name, lower, upper),
        }
    }

    /// The row that a variable is an expression. Under a condition, the bound of a norm may be
    /// negative where the condition does not hold, so there the variable is only at most the bound,
    /// and only if it holds.
    fn row_of(&mut self, x: Variable, expression: &Affine, is_bound: bool) -> Result<(), Error> {
        let name = self.model.variable_ref(x)?.name().clone();
        let (mut terms, offset) = (expression.clone() - x).into_parts();
        terms.retain(|&(_, a)| a != 0.0);
        let limit = 0.0 - offset;
        match &self.condition {
            Some(condition) if is_bound => {
                let row = StoredRow { terms, lower: limit, upper: f64::INFINITY };
                let condition = condition.clone();
                self.model.push_indicator(name, condition, row, BigM::Automatic)?;
            }
            _ => {
                let row = StoredRow { terms, lower: limit, upper: limit };
                self.model.push_constraint(name, row)?;
            }
        }
        Ok(())
    }
}

/// The square of a variable times a number or of a constant, if no factor is rounded.
fn square(entry: &Affine) -> Option<Quadratic> {
    let exact = |a: f64| {
        let square = a * a;
        (square == 0.0 && a == 0.0
            || square.is_normal() && square < 1e20 && a.mul_add(a, -square) == 0.0)
            .then_some(square)
    };
    match (&entry.terms()[..], entry.offset()) {
        ([], constant) => exact(constant).map(Quadratic::from),
        (&[(x, factor)], 0.0) => {
            let mut square = Quadratic::zero();
            square.add_product(exact(factor)?, x, x);
            Some(square)
        }
        _ => None,
    }
}

/// Adds the row of a file that a quadratic expression is at most 0, under a condition if it has
/// one.
pub(crate) fn add_quadratic_row(
    model: &mut Model,
    name: Name,
    expression: Quadratic,
    condition: Option<Logic>,
) -> Result<(), Error> {
    name.check()?;
    let factors = expression.affine().raw_terms().iter().map(|&(_, a)| a);
    for coefficient in factors.chain(expression.products().into_iter().map(|(.., q)| q)) {
        finite(coefficient, "a coefficient", &name)?;
    }
    let row = expression.le(0.0);
    match condition {
        None => model.add(name, row).map(|_| ()),
        Some(condition) => model.add(name, condition.implies(row)).map(|_| ()),
    }
}
