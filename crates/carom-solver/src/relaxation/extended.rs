//! Sums of two floats: about 32 digits, for residuals that are multiplied by huge radii.

use std::ops::Neg;

use crate::sum::{exact_product, exact_sum};

/// The unevaluated sum `high + low`, with `low` below half a unit in the last place of `high`.
///
/// Sums and products of a few hundred terms are exact to about 1e-30 of the terms' magnitude.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Extended {
    /// The sum, rounded.
    pub high: f64,
    /// The rest.
    pub low: f64,
}

impl Extended {
    /// `self + a b`.
    #[must_use]
    pub fn plus_product(self, a: Extended, b: Extended) -> Extended {
        let (product, error) = exact_product(a.high, b.high);
        let error = error + (a.high * b.low + a.low * b.high);
        let (sum, rest) = exact_sum(self.high, product);
        // The low parts are far below the last digit of `sum`, which makes this exact enough.
        let (high, low) = exact_sum(sum, rest + (self.low + error));
        Extended { high, low }
    }

    /// `self + a`.
    #[must_use]
    pub fn plus(self, a: f64) -> Extended {
        self.plus_product(a.into(), 1.0.into())
    }
}

impl From<f64> for Extended {
    fn from(value: f64) -> Self {
        Extended { high: value, low: 0.0 }
    }
}

impl Neg for Extended {
    type Output = Extended;

    fn neg(self) -> Extended {
        Extended { high: -self.high, low: -self.low }
    }
}
