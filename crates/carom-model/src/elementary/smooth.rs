//! Functions that users add.

use std::fmt;
use std::sync::Arc;

use crate::interval::Interval;

/// A smooth function of one variable, for [`Nonlinear::own`](crate::model::Nonlinear::own).
///
/// Bounds and proofs rest on the ranges: where one of them is too small, plans are lost and answers
/// are wrong. Arguments and values are in the units of the user.
///
/// ```
/// use carom::interval::Interval;
/// use carom::model::SmoothFunction;
/// use carom::prelude::*;
///
/// /// The logistic function.
/// #[derive(Debug)]
/// struct Logistic;
///
/// impl SmoothFunction for Logistic {
///     fn name(&self) -> &str {
///         "logistic"
///     }
///     fn value(&self, x: f64) -> f64 {
///         1.0 / (1.0 + (-x).exp())
///     }
///     fn derivative(&self, x: f64) -> f64 {
///         self.value(x) * self.value(-x)
///     }
///     fn range(&self, x: Interval) -> Interval {
///         // Wider than what rounding can change.
///         Interval::new(self.value(x.lower) - 1e-14, self.value(x.upper) + 1e-14)
///     }
///     fn slope_range(&self, x: Interval) -> Interval {
///         let ends = [self.derivative(x.lower), self.derivative(x.upper)];
///         let most = if x.contains(0.0) { 0.25 } else { ends[0].max(ends[1]) };
///         Interval::new(ends[0].min(ends[1]) - 1e-14, most + 1e-14)
///     }
///     fn curvature_range(&self, x: Interval) -> Interval {
///         // Convex below 0 and concave above.
///         let limit = |outside: bool| if outside { 0.0 } else { 0.1 };
///         Interval::new(-limit(x.upper <= 0.0), limit(x.lower >= 0.0))
///     }
/// }
///
/// let mut model = Model::new("dose");
/// let x = model.continuous("x", -2.0, 6.0)?;
/// model.minimize(x - 8.0 * x.own(Logistic))?;
/// let solution = BranchAndBound::default().solve(&model)?;
/// // Where the slope of the function is 1/8.
/// assert!((solution.value(x)? - 1.7627).abs() < 1e-2);
/// # Ok::<(), carom::Error>(())
/// ```
pub trait SmoothFunction: fmt::Debug + Send + Sync {
    /// The name in texts.
    fn name(&self) -> &str;

    /// The arguments at which it has a value; all, if it does not say otherwise.
    fn domain(&self) -> Interval {
        Interval::REALS
    }

    /// The value at an argument of the domain.
    fn value(&self, x: f64) -> f64;

    /// The derivative at an argument of the domain.
    fn derivative(&self, x: f64) -> f64;

    /// An interval that contains the value at each argument of a range, which may be infinite, and
    /// what [`value`](Self::value) returns for it.
    fn range(&self, x: Interval) -> Interval;

    /// An interval that contains the derivative at each argument of a range.
    fn slope_range(&self, x: Interval) -> Interval;

    /// An interval that contains the second derivative at each argument of a range. Only its signs
    /// are used.
    fn curvature_range(&self, x: Interval) -> Interval;
}

/// A function of one's own in a model.
#[derive(Debug, Clone)]
pub struct OwnFunction(Arc<dyn SmoothFunction>);

impl OwnFunction {
    pub(crate) fn new(function: impl SmoothFunction + 'static) -> Self {
        OwnFunction(Arc::new(function))
    }

    pub(super) fn function(&self) -> &dyn SmoothFunction {
        &*self.0
    }

    pub(super) fn value(&self, x: f64) -> f64 {
        self.0.value(x)
    }

    pub(super) fn derivative(&self, x: f64) -> f64 {
        self.0.derivative(x)
    }
}

impl PartialEq for OwnFunction {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}

#[cfg(feature = "serde")]
impl serde::Serialize for OwnFunction {
    fn serialize<S: serde::Serializer>(&self, _: S) -> Result<S::Ok, S::Error> {
        Err(serde::ser::Error::custom(format!(
            "`{}` is code, which no file can hold; write the model without it",
            self.0.name()
        )))
    }
}

#[cfg(feature = "serde")]
impl<'de> serde::Deserialize<'de> for OwnFunction {
    fn deserialize<D: serde::Deserializer<'de>>(_: D) -> Result<Self, D::Error> {
        Err(serde::de::Error::custom("a function of one's own is code, which no file can hold"))
    }
}
