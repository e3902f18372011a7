//! Arithmetic on variables and expressions, on values and on references.
//!
//! Only `+`, `-`, unary `-`, `*` and `sum` are operators; comparisons are methods
//! ([`le`](Affine::le), [`ge`](Affine::ge), [`equals`](Affine::equals),
//! [`within`](Affine::within)), because Rust's `<=` must return a `bool`.

use std::iter::Sum;
use std::ops::{Add, AddAssign, Mul, MulAssign, Neg, Sub, SubAssign};

use super::affine::Affine;
use super::ids::Variable;
use super::literal::Literal;
use super::quadratic::Quadratic;

/// `left op right` for one pair of operand types, through the common type `$via`.
#[doc(hidden)]
#[macro_export]
macro_rules! sums {
    ($via:ty: $($left:ty, $right:ty);+ $(;)?) => {$(
        impl Add<$right> for $left {
            type Output = $via;

            fn add(self, right: $right) -> $via {
                let mut result = <$via>::from(self);
                result.append(&<$via>::from(right), 1.0);
                result
            }
        }

        impl Sub<$right> for $left {
            type Output = $via;

            fn sub(self, right: $right) -> $via {
                let mut result = <$via>::from(self);
                result.append(&<$via>::from(right), -1.0);
                result
            }
        }
    )+};
}

sums!(Affine:
    Variable, Variable; Variable, &Variable; &Variable, Variable; &Variable, &Variable;
    Variable, f64; f64, Variable; &Variable, f64; f64, &Variable;
    Variable, Affine; Variable, &Affine; &Variable, Affine; &Variable, &Affine;
    Affine, Variable; Affine, &Variable; &Affine, Variable; &Affine, &Variable;
    Affine, f64; &Affine, f64; f64, Affine; f64, &Affine;
    Affine, Affine; Affine, &Affine; &Affine, Affine; &Affine, &Affine;
    Literal, Literal; Literal, f64; f64, Literal;
    Literal, Variable; Literal, &Variable; Variable, Literal; &Variable, Literal;
    Literal, Affine; Literal, &Affine; Affine, Literal; &Affine, Literal;
);
sums!(Quadratic:
    Quadratic, Quadratic; Quadratic, &Quadratic; &Quadratic, Quadratic; &Quadratic, &Quadratic;
    Quadratic, Affine; Quadratic, &Affine; &Quadratic, Affine; &Quadratic, &Affine;
    Affine, Quadratic; Affine, &Quadratic; &Affine, Quadratic; &Affine, &Quadratic;
    Quadratic, Variable; &Quadratic, Variable; Variable, Quadratic; Variable, &Quadratic;
    Quadratic, f64; &Quadratic, f64; f64, Quadratic; f64, &Quadratic;
    Quadratic, Literal; &Quadratic, Literal; Literal, Quadratic; Literal, &Quadratic;
);

/// Negation and multiplication by a number.
#[doc(hidden)]
#[macro_export]
macro_rules! scaling {
    ($($operand:ty => $via:ty);+ $(;)?) => {$(
        impl Mul<f64> for $operand {
            type Output = $via;

            fn mul(self, factor: f64) -> $via {
                let mut result = <$via>::from(self);
                result.scale(factor);
                result
            }
        }

        impl Mul<$operand> for f64 {
            type Output = $via;

            fn mul(self, operand: $operand) -> $via {
                operand * self
            }
        }

        impl Neg for $operand {
            type Output = $via;

            fn neg(self) -> $via {
                self * -1.0
            }
        }
    )+};
}

scaling!(
    Variable => Affine; &Variable => Affine; Affine => Affine; &Affine => Affine;
    Quadratic => Quadratic; &Quadratic => Quadratic; Literal => Affine;
);

/// Products of affine operands.
#[doc(hidden)]
#[macro_export]
macro_rules! products {
    ($($left:ty, $right:ty);+ $(;)?) => {$(
        impl Mul<$right> for $left {
            type Output = Quadratic;

            fn mul(self, right: $right) -> Quadratic {
                Quadratic::product(&Affine::from(self), &Affine::from(right))
            }
        }
    )+};
}

products!(
    Variable, Variable; Variable, &Variable; &Variable, Variable; &Variable, &Variable;
    Variable, Affine; Variable, &Affine; &Variable, Affine; &Variable, &Affine;
    Affine, Variable; Affine, &Variable; &Affine, Variable; &Affine, &Variable;
    Affine, Affine; Affine, &Affine; &Affine, Affine; &Affine, &Affine;
);

/// `+=`, `-=`, `*=` and `sum`, for anything that converts.
macro_rules! assigning {
    ($via:ty) => {
        impl<T: Into<$via>> AddAssign<T> for $via {
            fn add_assign(&mut self, right: T) {
                self.append(&right.into(), 1.0);
            }
        }

        impl<T: Into<$via>> SubAssign<T> for $via {
            fn sub_assign(&mut self, right: T) {
                self.append(&right.into(), -1.0);
            }
        }

        impl<T: Into<$via>> Sum<T> for $via {
            fn sum<I: Iterator<Item = T>>(items: I) -> $via {
                let mut total = <$via>::zero();
                items.for_each(|item| total += item);
                total
            }
        }

        impl MulAssign<f64> for $via {
            fn mul_assign(&mut self, factor: f64) {
                self.scale(factor);
            }
        }
    };
}

pub(crate) use assigning;

impl From<&Variable> for Quadratic {
    fn from(variable: &Variable) -> Self {
        Quadratic::from(*variable)
    }
}

impl From<Literal> for Quadratic {
    fn from(literal: Literal) -> Self {
        Quadratic::from(Affine::from(literal))
    }
}

assigning!(Affine);
assigning!(Quadratic);
