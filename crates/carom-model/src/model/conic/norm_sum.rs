//! Sums of norms and a quadratic expression, for objectives and rows.

use std::iter::Sum;
use std::ops::{Add, AddAssign, Mul, MulAssign, Neg, Sub, SubAssign};

use super::norm::Norm;
use crate::error::{Error, ErrorKind};
use crate::model::affine::Affine;
use crate::model::checks::finite;
use crate::model::ids::{Constraint, Variable};
use crate::model::literal::Literal;
use crate::model::name::Name;
use crate::model::nonlinear::Nonlinear;
use crate::model::operators::assigning;
use crate::model::quadratic::Quadratic;
use crate::model::sense::Sense;
use crate::model::statement::{SealedStatement, Statement};
use crate::model::store::Model;
use crate::{scaling, sums};

/// A quadratic or nonlinear expression plus multiples of norms, such as
/// `norm([ux, uy]) + 0.5 * t`.
///
/// An objective may be one, and a row may say that one is at most something. Each norm becomes a
/// variable that is [at least the norm](Model::norm), so norms are added where a sum is pressed
/// down, and subtracted where it is pressed up.
///
/// ```
/// use carom::prelude::*;
///
/// // Cables from a pole at the road to two houses, and 0.5 for each metre from the depot at 0.
/// let mut model = Model::new("pole");
/// let x = model.continuous("x", 0.0, 6.0)?; // m
/// let cable = norm([x - 1.0, Affine::constant(3.0)]) + norm([x - 6.0, Affine::constant(1.0)]);
/// model.minimize(cable + 0.5 * x)?;
/// let solution = BranchAndBound::default().solve(&model)?;
/// assert!((solution.value(x)? - 2.5557).abs() < 1e-3);
/// # Ok::<(), carom::Error>(())
/// ```
#[derive(Debug, Clone, Default)]
#[must_use = "a sum does nothing until it is minimised or compared"]
pub struct NormSum {
    norms: Vec<(f64, Norm)>,
    rest: Quadratic,
    nonlinear: Nonlinear,
}

/// The statement that a sum of norms is at most something, made by [`NormSum::le`].
#[derive(Debug, Clone)]
#[must_use = "a row does nothing until it is given to `Model::add`"]
pub struct NormSumRow {
    /// At most 0.
    sum: NormSum,
}

impl NormSum {
    /// The expression 0.
    pub fn zero() -> Self {
        NormSum::default()
    }

    /// The statement that the sum is at most an affine expression. Norms in it have weights of at
    /// least 0, and there are no squares beside them.
    pub fn le(&self, bound: impl Into<Affine>) -> NormSumRow {
        NormSumRow { sum: self.clone() - bound.into() }
    }

    fn append(&mut self, other: &NormSum, factor: f64) {
        self.norms.extend(other.norms.iter().map(|(weight, norm)| (factor * weight, norm.clone())));
        self.rest.append(&other.rest, factor);
        self.nonlinear.append(&other.nonlinear, factor);
    }

    fn scale(&mut self, factor: f64) {
        self.norms.iter_mut().for_each(|(weight, _)| *weight *= factor);
        self.rest.scale(factor);
        self.nonlinear.scale(factor);
    }

    /// The sum with other expressions in its norms and beside them.
    #[doc(hidden)]
    pub fn try_map(
        &self,
        mut entry: impl FnMut(&Affine) -> Result<Affine, Error>,
        rest: impl FnOnce(&Quadratic) -> Result<Quadratic, Error>,
    ) -> Result<NormSum, Error> {
        let norms =
            self.norms.iter().map(|(weight, norm)| Ok((*weight, norm.try_map(&mut entry)?)));
        let norms = norms.collect::<Result<_, Error>>()?;
        let nonlinear = self.nonlinear.try_map(&mut entry)?;
        Ok(NormSum { norms, rest: rest(&self.rest)?, nonlinear })
    }

    /// Takes the nonlinear part out.
    pub(in crate::model) fn take_nonlinear(&mut self) -> Nonlinear {
        std::mem::take(&mut self.nonlinear)
    }

    /// The expression with a variable `name[k]` in the place of each norm, without its nonlinear
    /// part.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::NotConicRow`] for a norm that is pushed away from its value; those of
    /// [`Model::norm`].
    pub(in crate::model) fn with_variables(
        self,
        model: &mut Model,
        sense: Sense,
        name: &Name,
    ) -> Result<Quadratic, Error> {
        let NormSum { norms, mut rest, .. } = self;
        for (k, (weight, norm)) in norms.into_iter().enumerate() {
            finite(weight, "the factor of a norm", name)?;
            if sense.sign() * weight < 0.0 {
                let comparison = "has a norm that is to be large";
                let help = "a norm has a factor of at least 0 where it is minimised or limited from \
                            above, and of at most 0 where it is maximised";
                return Err(
                    ErrorKind::NotConicRow { row: name.to_string(), comparison, help }.into()
                );
            }
            match norm.constant() {
                Some(length) => rest += weight * length,
                None => rest += weight * model.norm((name.family(), k), norm.into_entries())?,
            }
        }
        Ok(rest)
    }
}

impl SealedStatement for NormSumRow {}
impl Statement for NormSumRow {
    type Handle = Constraint;

    fn add_to(self, model: &mut Model, name: Name) -> Result<Constraint, Error> {
        model.all_or_nothing(|model| {
            let norms = name.suffixed("_norm");
            let mut sum = self.sum;
            let nonlinear = sum.take_nonlinear().define(model, &name)?;
            let mut sum = sum.with_variables(model, Sense::Minimize, &norms)?;
            sum.append(&nonlinear.into(), 1.0);
            if !sum.products().is_empty() {
                let (row, comparison) = (name.to_string(), "has squares or products beside norms");
                let help = "state what they are at most as a row of its own, with a variable";
                return Err(ErrorKind::NotConicRow { row, comparison, help }.into());
            }
            model.add(name, sum.affine().le(0.0))
        })
    }
}

impl<T: Into<Quadratic>> From<T> for NormSum {
    fn from(rest: T) -> Self {
        NormSum { rest: rest.into(), ..NormSum::default() }
    }
}

impl From<Nonlinear> for NormSum {
    fn from(nonlinear: Nonlinear) -> Self {
        NormSum { nonlinear, ..NormSum::default() }
    }
}

impl From<&Nonlinear> for NormSum {
    fn from(nonlinear: &Nonlinear) -> Self {
        NormSum::from(nonlinear.clone())
    }
}

impl From<Norm> for NormSum {
    fn from(norm: Norm) -> Self {
        NormSum { norms: vec![(1.0, norm)], ..NormSum::default() }
    }
}

sums!(NormSum:
    Norm, Norm; Norm, NormSum; NormSum, Norm; NormSum, NormSum;
    Norm, f64; f64, Norm; Norm, Variable; Variable, Norm; Norm, Literal; Literal, Norm;
    Norm, Affine; Affine, Norm; Norm, Quadratic; Quadratic, Norm;
    NormSum, f64; f64, NormSum; NormSum, Variable; Variable, NormSum; NormSum, Literal; Literal, NormSum;
    NormSum, Affine; Affine, NormSum; NormSum, Quadratic; Quadratic, NormSum;
);
scaling!(Norm => NormSum; NormSum => NormSum);
assigning!(NormSum);
