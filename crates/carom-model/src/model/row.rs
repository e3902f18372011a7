//! Comparisons of affine expressions: `lower <= expression <= upper`.

use super::affine::Affine;
use super::checks;
use super::ids::Variable;
use super::literal::Literal;
use super::name::Name;
use crate::error::Error;

/// A comparison, not yet added to a model: `lower <= expression <= upper`.
///
/// Made by [`le`](Affine::le), [`ge`](Affine::ge), [`equals`](Affine::equals) and
/// [`within`](Affine::within).
#[derive(Debug, Clone, PartialEq)]
#[must_use = "a row does nothing until it is given to `Model::add`"]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Row {
    pub(super) expression: Affine,
    #[cfg_attr(feature = "serde", serde(with = "crate::serde_numbers"))]
    pub(crate) lower: f64,
    #[cfg_attr(feature = "serde", serde(with = "crate::serde_numbers"))]
    pub(crate) upper: f64,
}

impl Row {
    #[doc(hidden)]
    #[inline]
    pub fn new(expression: Affine, lower: f64, upper: f64) -> Self {
        Row { expression, lower, upper }
    }

    /// The compared expression.
    #[inline]
    pub fn expression(&self) -> &Affine {
        &self.expression
    }

    /// The lower limit, or `-inf`.
    #[inline]
    pub fn lower(&self) -> f64 {
        self.lower
    }

    /// The upper limit, or `+inf`.
    #[inline]
    pub fn upper(&self) -> f64 {
        self.upper
    }

    /// The limits as a model takes them; magnitudes that count as infinite are.
    ///
    /// # Errors
    ///
    /// As for [`Model::add`](super::Model::add), but for handles and empty rows.
    #[doc(hidden)]
    pub fn limits(&self, name: &str) -> Result<(f64, f64), Error> {
        let name = Name::from(name);
        for (_, coefficient) in self.expression.terms() {
            checks::finite(coefficient, "a coefficient", &name)?;
        }
        checks::finite(self.expression.offset(), "the constant", &name)?;
        checks::limits(self.lower, self.upper, &name)
    }

    /// Whether the row has no variable and holds.
    #[doc(hidden)]
    #[inline]
    pub fn is_constant_and_holds(&self) -> bool {
        let value = self.expression.offset();
        self.expression.terms().is_empty() && self.lower <= value && value <= self.upper
    }
}

#[doc(hidden)]
#[macro_export]
macro_rules! comparisons {
    ($operand:ty) => {
        impl $operand {
            /// The row `self <= right`.
            #[inline]
            pub fn le(&self, right: impl Into<Affine>) -> Row {
                let expression = Affine::from(self) - right.into();
                Row::new(expression, f64::NEG_INFINITY, 0.0)
            }

            /// The row `self >= right`.
            #[inline]
            pub fn ge(&self, right: impl Into<Affine>) -> Row {
                let expression = Affine::from(self) - right.into();
                Row::new(expression, 0.0, f64::INFINITY)
            }

            /// The row `self = right`.
            #[inline]
            pub fn equals(&self, right: impl Into<Affine>) -> Row {
                Row::new(Affine::from(self) - right.into(), 0.0, 0.0)
            }

            /// The row `lower <= self <= upper`; one limit may be infinite.
            #[inline]
            pub fn within(&self, lower: f64, upper: f64) -> Row {
                Row::new(Affine::from(self), lower, upper)
            }
        }
    };
}

comparisons!(Affine);
comparisons!(Variable);
comparisons!(Literal);
