//! Nonlinear expressions: sums of a quadratic expression and of functions of other expressions.
//!
//! A model holds no expression trees. A statement with a nonlinear expression becomes one about
//! variables, each of which is an elementary [`Function`](super::Function) of affine expressions
//! (`define.rs`), so that all else in the crate sees rows and functions.

mod define;
mod operators;
mod row;
mod series;
mod text;

use std::collections::BTreeMap;
use std::sync::Arc;

pub use row::NonlinearRow;

use super::affine::Affine;
use super::ids::Variable;
use super::piecewise::PiecewiseAffine;
use super::quadratic::Quadratic;
use crate::elementary::{Elementary, OwnFunction, SmoothFunction};
use crate::error::Error;

/// A nonlinear expression: functions, products and quotients of expressions, and sums of them.
///
/// Made by functions of variables and expressions, such as [`sin`](Self::sin), by quotients, and by
/// products of more than two. Expressions share their parts: a clone is cheap, and a part that
/// occurs twice is one variable of the model.
///
/// ```
/// use carom::prelude::*;
///
/// let mut model = Model::new("cannon");
/// let angle = model.continuous("angle", 0.0, 1.5)?; // rad
/// let speed = model.continuous("speed", 0.0, 20.0)?; // m/s
/// let g = 9.81; // m/s²
/// let width = speed * speed * (2.0 * angle).sin() / g;
/// model.add("target", width.ge(30.0))?; // m
/// model.minimize(speed)?;
/// let solution = BranchAndBound::default().solve(&model)?;
/// assert!((solution.value(speed)? - (30.0 * g).sqrt()).abs() < 1e-3);
/// # Ok::<(), carom::Error>(())
/// ```
#[derive(Debug, Clone, Default, PartialEq)]
#[must_use = "an expression does nothing until it is minimised or compared"]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(into = "StoredNonlinear", from = "StoredNonlinear"))]
pub struct Nonlinear {
    rest: Quadratic,
    parts: Vec<(f64, Arc<FunctionPart>)>,
    /// The number of functions inside each other.
    depth: u32,
}

/// The largest depth of functions inside each other. Deeper ones are dropped, so that no later code
/// walks them; the depth stays, and a model refuses the expression.
const MAX_FUNCTION_DEPTH: u32 = 200;

/// A function of expressions.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
enum FunctionPart {
    Elementary(Elementary, Nonlinear),
    Product(Nonlinear, Nonlinear),
    Quotient(Nonlinear, Nonlinear),
    Absolute(Nonlinear),
    Maximum(Nonlinear, Nonlinear),
    Piecewise(PiecewiseAffine, Nonlinear),
    /// A function that is too deep.
    Dropped,
}

impl FunctionPart {
    fn depth(&self) -> u32 {
        match self {
            FunctionPart::Elementary(_, of)
            | FunctionPart::Absolute(of)
            | FunctionPart::Piecewise(_, of) => of.depth + 1,
            FunctionPart::Product(a, b)
            | FunctionPart::Quotient(a, b)
            | FunctionPart::Maximum(a, b) => a.depth.max(b.depth) + 1,
            FunctionPart::Dropped => MAX_FUNCTION_DEPTH + 1,
        }
    }
}

/// An expression as it is written: parts that are shared occur as often as they are used.
#[cfg(feature = "serde")]
#[derive(serde::Serialize, serde::Deserialize)]
#[serde(rename = "Nonlinear")]
struct StoredNonlinear {
    rest: Quadratic,
    parts: Vec<(f64, FunctionPart)>,
}

#[cfg(feature = "serde")]
impl From<Nonlinear> for StoredNonlinear {
    fn from(Nonlinear { rest, parts, .. }: Nonlinear) -> Self {
        let own = |part: Arc<FunctionPart>| Arc::unwrap_or_clone(part);
        let parts = parts.into_iter().map(|(factor, part)| (factor, own(part))).collect();
        StoredNonlinear { rest, parts }
    }
}

#[cfg(feature = "serde")]
impl From<StoredNonlinear> for Nonlinear {
    fn from(StoredNonlinear { rest, parts }: StoredNonlinear) -> Self {
        let depth = parts.iter().map(|(_, part)| part.depth()).max().unwrap_or(0);
        let parts = parts.into_iter().map(|(factor, part)| (factor, Arc::new(part))).collect();
        Nonlinear { rest, parts, depth }
    }
}

impl Nonlinear {
    /// The expression 0.
    pub fn zero() -> Self {
        Nonlinear::default()
    }

    /// Whether it has no terms and no constant.
    pub(in crate::model) fn is_zero(&self) -> bool {
        self.parts.is_empty() && self.rest == Quadratic::zero()
    }

    fn of(part: FunctionPart) -> Self {
        let depth = part.depth();
        let part = if depth > MAX_FUNCTION_DEPTH { FunctionPart::Dropped } else { part };
        Nonlinear { rest: Quadratic::zero(), parts: vec![(1.0, Arc::new(part))], depth }
    }

    #[doc(hidden)]
    pub fn elementary(function: Elementary, of: Nonlinear) -> Self {
        Nonlinear::of(FunctionPart::Elementary(function, of))
    }

    #[doc(hidden)]
    pub fn own_function(function: impl SmoothFunction + 'static, of: Nonlinear) -> Self {
        Nonlinear::elementary(Elementary::Own(OwnFunction::new(function)), of)
    }

    /// A table of values: the piecewise-affine function through its points, at an expression. The
    /// expression must lie between the first and the last point.
    ///
    /// ```
    /// use carom::model::{Nonlinear, PiecewiseAffine};
    /// use carom::prelude::*;
    ///
    /// // A current in m/s that was measured at some places across a river.
    /// let current = PiecewiseAffine::new([(0.0, 0.2), (2.0, 1.5), (5.0, 0.4)])?;
    /// let mut model = Model::new("river");
    /// let y = model.continuous("y", 0.0, 5.0)?; // m
    /// model.add("calm", Nonlinear::table(&current, y).le(0.85))?;
    /// model.maximize(y * 1.0)?;
    /// assert!((BranchAndBound::default().solve(&model)?.value(y)? - 5.0).abs() < 1e-6);
    /// # Ok::<(), carom::Error>(())
    /// ```
    pub fn table(graph: &PiecewiseAffine, of: impl Into<Nonlinear>) -> Self {
        Nonlinear::of(FunctionPart::Piecewise(graph.clone(), of.into()))
    }

    #[doc(hidden)]
    pub fn absolute(of: Nonlinear) -> Self {
        Nonlinear::of(FunctionPart::Absolute(of))
    }

    /// The product of two expressions.
    #[doc(hidden)]
    pub fn product(left: Nonlinear, right: Nonlinear) -> Self {
        match (left.as_affine(), right.as_affine()) {
            (Some(left), Some(right)) => Quadratic::product(left, right).into(),
            (Some(factor), None) if factor.terms().is_empty() => right * factor.offset(),
            (None, Some(factor)) if factor.terms().is_empty() => left * factor.offset(),
            _ => Nonlinear::of(FunctionPart::Product(left, right)),
        }
    }

    #[doc(hidden)]
    pub fn quotient(left: Nonlinear, right: Nonlinear) -> Self {
        match right.as_affine() {
            Some(divisor) if divisor.terms().is_empty() => {
                let divisor = divisor.offset();
                let mut quotient = left;
                quotient.rest.divide(divisor);
                quotient.parts.iter_mut().for_each(|(factor, _)| *factor /= divisor);
                quotient
            }
            _ => Nonlinear::of(FunctionPart::Quotient(left, right)),
        }
    }

    /// The expression, if it is affine.
    pub fn as_affine(&self) -> Option<&Affine> {
        let is_affine = self.parts.is_empty() && self.rest.products().is_empty();
        is_affine.then(|| self.rest.affine())
    }

    #[doc(hidden)]
    pub fn scale(&mut self, factor: f64) {
        self.rest.scale(factor);
        self.parts.iter_mut().for_each(|(of, _)| *of *= factor);
    }

    #[doc(hidden)]
    pub fn append(&mut self, other: &Nonlinear, factor: f64) {
        self.depth = self.depth.max(other.depth);
        self.rest.append(&other.rest, factor);
        self.parts.extend(other.parts.iter().map(|(of, part)| (factor * of, part.clone())));
    }

    /// The expression with other expressions in the places of its affine ones.
    #[doc(hidden)]
    pub fn try_map(
        &self,
        entry: &mut dyn FnMut(&Affine) -> Result<Affine, Error>,
    ) -> Result<Nonlinear, Error> {
        let mut mapped = Nonlinear::from(entry(self.rest.affine())?);
        for (first, second, factor) in self.rest.products() {
            let (left, right) = (entry(&first.into())?, entry(&second.into())?);
            let are_variables =
                [&left, &right].iter().all(|own| own.offset() == 0.0 && own.terms().len() <= 1);
            if are_variables {
                mapped.rest.append(&Quadratic::product(&left, &right), factor);
                continue;
            }
            // Multiplied out, its range would be lost.
            let part = match first == second {
                true => FunctionPart::Elementary(Elementary::Power(2.0), left.into()),
                false => FunctionPart::Product(left.into(), right.into()),
            };
            mapped.parts.push((factor, Arc::new(part)));
        }
        for (factor, part) in &self.parts {
            let part = match &**part {
                FunctionPart::Elementary(function, of) => {
                    FunctionPart::Elementary(function.clone(), of.try_map(entry)?)
                }
                FunctionPart::Product(a, b) => {
                    FunctionPart::Product(a.try_map(entry)?, b.try_map(entry)?)
                }
                FunctionPart::Quotient(a, b) => {
                    FunctionPart::Quotient(a.try_map(entry)?, b.try_map(entry)?)
                }
                FunctionPart::Absolute(of) => FunctionPart::Absolute(of.try_map(entry)?),
                FunctionPart::Piecewise(graph, of) => {
                    FunctionPart::Piecewise(graph.clone(), of.try_map(entry)?)
                }
                FunctionPart::Dropped => FunctionPart::Dropped,
                FunctionPart::Maximum(a, b) => {
                    FunctionPart::Maximum(a.try_map(entry)?, b.try_map(entry)?)
                }
            };
            mapped.parts.push((*factor, Arc::new(part)));
        }
        let depth = mapped.parts.iter().map(|(_, part)| part.depth()).max();
        mapped.depth = depth.unwrap_or(0).max(self.depth);
        Ok(mapped)
    }

    /// Shows its affine expressions.
    #[doc(hidden)]
    pub fn visit(&self, look: &mut dyn FnMut(&Affine) -> Result<(), Error>) -> Result<(), Error> {
        self.try_map(&mut |own| look(own).map(|()| own.clone())).map(drop)
    }

    /// The value at a point that is given as a function from variables to values; NaN where the
    /// expression has none.
    pub fn evaluate(&self, value: impl Fn(Variable) -> f64) -> f64 {
        self.value_by(&value, &mut BTreeMap::new())
    }

    /// The value, with those of parts that are known already.
    fn value_by(
        &self,
        value: &dyn Fn(Variable) -> f64,
        known: &mut BTreeMap<*const FunctionPart, f64>,
    ) -> f64 {
        let mut sum = self.rest.evaluate(value);
        for (factor, part) in &self.parts {
            let key = Arc::as_ptr(part);
            let own = known.get(&key).copied().unwrap_or_else(|| {
                let own = match &**part {
                    FunctionPart::Elementary(function, of) => {
                        function.value(of.value_by(value, known))
                    }
                    FunctionPart::Product(a, b) => {
                        a.value_by(value, known) * b.value_by(value, known)
                    }
                    FunctionPart::Quotient(a, b) => {
                        a.value_by(value, known) / b.value_by(value, known)
                    }
                    FunctionPart::Absolute(of) => of.value_by(value, known).abs(),
                    FunctionPart::Maximum(a, b) => {
                        a.value_by(value, known).max(b.value_by(value, known))
                    }
                    FunctionPart::Piecewise(graph, of) => {
                        graph.value_near(of.value_by(value, known))
                    }
                    FunctionPart::Dropped => f64::NAN,
                };
                known.insert(key, own);
                own
            });
            sum += factor * own;
        }
        sum
    }

    /// The larger of two expressions, in their unit.
    pub fn max(&self, other: impl Into<Nonlinear>) -> Nonlinear {
        Nonlinear::of(FunctionPart::Maximum(self.clone(), other.into()))
    }

    /// The smaller of two expressions, in their unit.
    pub fn min(&self, other: impl Into<Nonlinear>) -> Nonlinear {
        -(-self.clone()).max(-other.into())
    }

    /// The square of the expression. Unlike that of an affine expression it is not multiplied out,
    /// because the range of the square is known, and that of a sum of products is not.
    pub fn square(&self) -> Nonlinear {
        self.pow(2.0)
    }
}

impl From<Quadratic> for Nonlinear {
    fn from(rest: Quadratic) -> Self {
        Nonlinear { rest, ..Nonlinear::default() }
    }
}

/// The functions of one expression, for an operand whose references are expressions.
#[doc(hidden)]
#[macro_export]
macro_rules! functions {
    ($operand:ty) => {
        impl $operand {
            /// The sine of an angle in rad.
            pub fn sin(&self) -> Nonlinear {
                Nonlinear::elementary($crate::model::Elementary::Sin, self.into())
            }

            /// The cosine of an angle in rad.
            pub fn cos(&self) -> Nonlinear {
                Nonlinear::elementary($crate::model::Elementary::Cos, self.into())
            }

            /// The tangent of an angle in rad. A solve refuses a range of angles with a pole.
            pub fn tan(&self) -> Nonlinear {
                Nonlinear::elementary($crate::model::Elementary::Tan, self.into())
            }

            /// The angle in rad, from -π/2 to π/2, that has this sine, which must be from -1 to 1.
            pub fn asin(&self) -> Nonlinear {
                Nonlinear::elementary($crate::model::Elementary::Asin, self.into())
            }

            /// The angle in rad, from 0 to π, that has this cosine, which must be from -1 to 1.
            pub fn acos(&self) -> Nonlinear {
                Nonlinear::elementary($crate::model::Elementary::Acos, self.into())
            }

            /// The angle in rad, between -π/2 and π/2, that has this tangent.
            pub fn atan(&self) -> Nonlinear {
                Nonlinear::elementary($crate::model::Elementary::Atan, self.into())
            }

            /// The angle in rad of the point with this second coordinate, for a first coordinate
            /// that is greater than 0 within the bounds.
            pub fn atan2(&self, x: impl Into<Nonlinear>) -> Nonlinear {
                Nonlinear::quotient(self.into(), x.into()).atan()
            }

            /// The length of the vector of this and another expression, in their unit.
            pub fn hypot(&self, other: impl Into<Nonlinear>) -> Nonlinear {
                (Nonlinear::from(self).square() + other.into().square()).sqrt()
            }

            /// The hyperbolic sine.
            pub fn sinh(&self) -> Nonlinear {
                Nonlinear::elementary($crate::model::Elementary::Sinh, self.into())
            }

            /// The hyperbolic cosine.
            pub fn cosh(&self) -> Nonlinear {
                Nonlinear::elementary($crate::model::Elementary::Cosh, self.into())
            }

            /// The hyperbolic tangent.
            pub fn tanh(&self) -> Nonlinear {
                Nonlinear::elementary($crate::model::Elementary::Tanh, self.into())
            }

            /// The exponential function.
            pub fn exp(&self) -> Nonlinear {
                Nonlinear::elementary($crate::model::Elementary::Exp, self.into())
            }

            /// The natural logarithm of an expression that must be greater than 0.
            pub fn ln(&self) -> Nonlinear {
                Nonlinear::elementary($crate::model::Elementary::Ln, self.into())
            }

            /// The square root of an expression that must be at least 0.
            pub fn sqrt(&self) -> Nonlinear {
                Nonlinear::elementary($crate::model::Elementary::Power(0.5), self.into())
            }

            /// A power. The expression must be at least 0 unless the exponent is whole, and other
            /// than 0 if it is negative.
            pub fn pow(&self, exponent: f64) -> Nonlinear {
                Nonlinear::elementary($crate::model::Elementary::Power(exponent), self.into())
            }

            /// The absolute value, in the unit of the expression.
            pub fn abs(&self) -> Nonlinear {
                Nonlinear::absolute(self.into())
            }

            /// A function of one's own.
            pub fn own(&self, function: impl $crate::model::SmoothFunction + 'static) -> Nonlinear {
                Nonlinear::own_function(function, self.into())
            }
        }
    };
}

functions!(Variable);
functions!(Affine);
functions!(Quadratic);
functions!(Nonlinear);
