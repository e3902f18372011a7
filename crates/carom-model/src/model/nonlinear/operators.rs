//! Arithmetic with nonlinear expressions, and division.

use std::iter::Sum;
use std::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign};

use super::Nonlinear;
use crate::model::affine::Affine;
use crate::model::ids::Variable;
use crate::model::literal::Literal;
use crate::model::operators::assigning;
use crate::model::quadratic::Quadratic;
use crate::{scaling, sums};

macro_rules! conversions {
    ($($operand:ty),+) => {$(
        impl From<$operand> for Nonlinear {
            fn from(rest: $operand) -> Self {
                Quadratic::from(rest).into()
            }
        }
    )+};
}

conversions!(f64, Variable, &Variable, Literal, Affine, &Affine, &Quadratic);

impl From<&Nonlinear> for Nonlinear {
    fn from(expression: &Nonlinear) -> Self {
        expression.clone()
    }
}

sums!(Nonlinear:
    Nonlinear, Nonlinear; Nonlinear, &Nonlinear; &Nonlinear, Nonlinear; &Nonlinear, &Nonlinear;
    Nonlinear, Quadratic; Quadratic, Nonlinear; &Nonlinear, Quadratic; Quadratic, &Nonlinear;
    Nonlinear, Affine; Affine, Nonlinear; &Nonlinear, Affine; Affine, &Nonlinear;
    Nonlinear, &Affine; &Affine, Nonlinear;
    Nonlinear, Variable; Variable, Nonlinear; &Nonlinear, Variable; Variable, &Nonlinear;
    Nonlinear, Literal; Literal, Nonlinear;
    Nonlinear, f64; f64, Nonlinear; &Nonlinear, f64; f64, &Nonlinear;
);
scaling!(Nonlinear => Nonlinear; &Nonlinear => Nonlinear);
assigning!(Nonlinear);

/// Products of expressions that are not affine.
#[doc(hidden)]
#[macro_export]
macro_rules! nonlinear_products {
    ($($left:ty, $right:ty);+ $(;)?) => {$(
        impl Mul<$right> for $left {
            type Output = Nonlinear;

            fn mul(self, right: $right) -> Nonlinear {
                Nonlinear::product(self.into(), right.into())
            }
        }
    )+};
}

nonlinear_products!(
    Nonlinear, Nonlinear; Nonlinear, &Nonlinear; &Nonlinear, Nonlinear; &Nonlinear, &Nonlinear;
    Nonlinear, Quadratic; Quadratic, Nonlinear; &Nonlinear, Quadratic; Quadratic, &Nonlinear;
    Nonlinear, Affine; Affine, Nonlinear; &Nonlinear, Affine; Affine, &Nonlinear;
    Nonlinear, &Affine; &Affine, Nonlinear;
    Nonlinear, Variable; Variable, Nonlinear; &Nonlinear, Variable; Variable, &Nonlinear;
    Quadratic, Quadratic; Quadratic, &Quadratic; &Quadratic, Quadratic; &Quadratic, &Quadratic;
    Quadratic, Affine; Affine, Quadratic; &Quadratic, Affine; Affine, &Quadratic;
    Quadratic, Variable; Variable, Quadratic; &Quadratic, Variable; Variable, &Quadratic;
);

/// Quotients of expressions.
#[doc(hidden)]
#[macro_export]
macro_rules! quotients {
    ($($left:ty: $($right:ty),+);+ $(;)?) => {$($(
        impl Div<$right> for $left {
            type Output = Nonlinear;

            fn div(self, right: $right) -> Nonlinear {
                Nonlinear::quotient(self.into(), right.into())
            }
        }
    )+)+};
}

quotients!(
    f64: Variable, Affine, &Affine, Quadratic, &Quadratic, Nonlinear, &Nonlinear;
    Variable: Variable, Affine, &Affine, Quadratic, &Quadratic, Nonlinear, &Nonlinear;
    Affine: Variable, Affine, &Affine, Quadratic, &Quadratic, Nonlinear, &Nonlinear;
    &Affine: Variable, Affine, &Affine, Quadratic, &Quadratic, Nonlinear, &Nonlinear;
    Quadratic: Variable, Affine, &Affine, Quadratic, &Quadratic, Nonlinear, &Nonlinear;
    &Quadratic: Variable, Affine, &Affine, Quadratic, &Quadratic, Nonlinear, &Nonlinear;
    Nonlinear: f64, Variable, Affine, &Affine, Quadratic, &Quadratic, Nonlinear, &Nonlinear;
    &Nonlinear: f64, Variable, Affine, &Affine, Quadratic, &Quadratic, Nonlinear, &Nonlinear;
);

macro_rules! numbers_below {
    ($($operand:ty => $via:ty);+ $(;)?) => {$(
        impl Div<f64> for $operand {
            type Output = $via;

            fn div(self, divisor: f64) -> $via {
                let mut quotient = <$via>::from(self);
                quotient.divide(divisor);
                quotient
            }
        }
    )+};
}

numbers_below!(
    Variable => Affine; Affine => Affine; &Affine => Affine;
    Quadratic => Quadratic; &Quadratic => Quadratic;
);
