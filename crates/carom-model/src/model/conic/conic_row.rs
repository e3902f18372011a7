//! Comparisons of norms and of quadratic expressions as statements of a model.

use super::stored_conic::StoredConic;
use crate::error::{Error, ErrorKind};
use crate::model::affine::Affine;
use crate::model::checks::finite;
use crate::model::ids::ConicConstraint;
use crate::model::logic::Logic;
use crate::model::name::Name;
use crate::model::quadratic::Quadratic;
use crate::model::reformulation::BigM;
use crate::model::statement::{SealedStatement, Statement};
use crate::model::store::{ConicData, Model, StatementKind};

/// A comparison of a norm or of a quadratic expression, not yet added to a model.
///
/// Made by [`Norm::le`](super::Norm::le) and by the comparisons of [`Quadratic`]. [`Model::add`]
/// decides whether it is a second-order cone: a convex quadratic row, or one that squares or a
/// product on the larger side make one, such as `z.square().le(x * y)` with `x` and `y` at least 0.
#[derive(Debug, Clone, PartialEq)]
#[must_use = "a conic row does nothing until it is given to `Model::add`"]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ConicRow {
    pub(crate) conic: StoredConic,
    #[cfg_attr(feature = "serde", serde(default))]
    refused: Option<Refused>,
}

/// A comparison that is never convex. It is refused when it is added.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) enum Refused {
    NormAtLeast,
    NormEquals,
    QuadraticEquals,
    QuadraticWithin,
}

impl ConicRow {
    #[inline]
    pub(crate) fn new(conic: StoredConic) -> Self {
        ConicRow { conic, refused: None }
    }

    /// The cone as it is stored.
    #[doc(hidden)]
    #[inline]
    pub fn stored(&self) -> &StoredConic {
        &self.conic
    }

    /// The cone as it is stored, to be changed.
    #[doc(hidden)]
    pub fn stored_mut(&mut self) -> &mut StoredConic {
        &mut self.conic
    }

    /// The cone as it is stored.
    #[doc(hidden)]
    #[inline]
    pub fn into_stored(self) -> StoredConic {
        self.conic
    }

    #[inline]
    pub(super) fn refused(self, why: Refused) -> Self {
        ConicRow { refused: Some(why), ..self }
    }

    /// The row with other expressions: each affine one is changed, and the products with their
    /// factors.
    #[doc(hidden)]
    pub fn try_map(
        &self,
        change: &mut dyn FnMut(&Affine) -> Result<Affine, Error>,
    ) -> Result<ConicRow, Error> {
        let conic = match &self.conic {
            StoredConic::Norm { entries, bound } => {
                let entries = entries.iter().map(&mut *change).collect::<Result<_, _>>()?;
                StoredConic::Norm { entries, bound: change(bound)? }
            }
            StoredConic::Quadratic { expression } => {
                let mut sum = Quadratic::from(change(expression.affine())?);
                for (first, second, factor) in expression.products() {
                    sum += factor * (change(&first.into())? * change(&second.into())?);
                }
                StoredConic::Quadratic { expression: sum }
            }
        };
        Ok(ConicRow { conic, refused: self.refused })
    }

    /// Checks the row against a model and brings it into stored form.
    #[doc(hidden)]
    pub fn checked(self, model: &Model, name: &Name) -> Result<StoredConic, Error> {
        match self.refused {
            Some(why) => Err(why.error(name)),
            None => model.checked_conic(self.conic, name),
        }
    }
}

impl Refused {
    fn error(self, name: &Name) -> Error {
        let sides = "write a disjunction of sides, such as \
                     `either(x.ge(r)).or(x.le(-r)).or(y.ge(r)).or(y.le(-r))`";
        let equal =
            "write `le`, which holds with equality where the objective or other rows press on it";
        let (comparison, help) = match self {
            Refused::NormAtLeast => ("says that a norm is at least something", sides),
            Refused::NormEquals => ("says that a norm is equal to something", equal),
            Refused::QuadraticEquals => ("is an equation of a quadratic expression", equal),
            Refused::QuadraticWithin => (
                "gives a quadratic expression two limits",
                "add `le` and the other side, each as a row",
            ),
        };
        ErrorKind::NotConicRow { row: name.to_string(), comparison, help }.into()
    }
}

impl SealedStatement for ConicRow {}
impl Statement for ConicRow {
    type Handle = ConicConstraint;

    fn add_to(self, model: &mut Model, name: Name) -> Result<ConicConstraint, Error> {
        let conic = self.checked(model, &name)?;
        model.push_conic(name, None, conic, BigM::Automatic)
    }
}

impl Model {
    /// Checks the handles and numbers of a conic row, merges its terms, and checks that it is a
    /// cone.
    pub(crate) fn checked_conic(
        &self,
        conic: StoredConic,
        name: &Name,
    ) -> Result<StoredConic, Error> {
        let mut foreign = Ok(());
        conic.for_each_variable(&mut |v| {
            if foreign.is_ok() {
                foreign = self.check_variable(v, name);
            }
        });
        foreign?;
        let is_empty = matches!(&conic, StoredConic::Norm { entries, .. } if entries.is_empty());
        let conic = match conic {
            StoredConic::Norm { entries, bound } => {
                let merged = |expression: Affine| {
                    let (terms, constant) = expression.into_parts();
                    finite(constant, "the constant", name)?;
                    let mut affine = Affine::constant(constant);
                    for (v, a) in terms {
                        finite(a, "a coefficient", name)?;
                        affine.add_term(a, v);
                    }
                    Ok::<Affine, Error>(affine)
                };
                let entries = entries.into_iter().map(merged).collect::<Result<_, _>>()?;
                StoredConic::Norm { entries, bound: merged(bound)? }
            }
            StoredConic::Quadratic { expression } => {
                let expression = expression.compacted();
                finite(expression.affine().offset(), "the constant", name)?;
                for &(_, a) in expression.affine().raw_terms() {
                    finite(a, "a coefficient", name)?;
                }
                for (.., q) in expression.products() {
                    finite(q, "a coefficient", name)?;
                }
                StoredConic::Quadratic { expression }
            }
        };
        let mut has_variable = false;
        conic.for_each_variable(&mut |_| has_variable = true);
        if is_empty || !has_variable {
            return Err(ErrorKind::EmptyRow { name: name.to_string() }.into());
        }
        self.standard_cone(&conic, name)?;
        Ok(conic)
    }

    /// Adds a conic row that was checked.
    #[doc(hidden)]
    pub fn push_conic(
        &mut self,
        name: Name,
        condition: Option<Logic>,
        conic: StoredConic,
        big_m: BigM,
    ) -> Result<ConicConstraint, Error> {
        if let Some(condition) = &condition {
            condition.check(self, &name)?;
        }
        big_m.check(&name)?;
        let id = ConicConstraint::new(self.stored.conic.len(), self.stored.tag);
        self.claim_statement(&name, (StatementKind::Conic, id.index))?;
        self.stored.conic.push(ConicData { name, condition, conic, big_m });
        Ok(id)
    }
}
