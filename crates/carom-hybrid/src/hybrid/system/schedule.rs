//! Values that may depend on the step.

use crate::error::Error;

/// A value for every step: the same for all, or a list by step whose last entry goes on for ever.
///
/// ```
/// use carom::hybrid::Schedule;
///
/// let constant: Schedule<f64> = 2.0.into();
/// assert_eq!(constant.get(7), Some(&2.0));
/// // 3 in step 0, and 1 from step 1 on.
/// let falling: Schedule<f64> = vec![3.0, 1.0].into();
/// assert_eq!((falling.get(0), falling.get(9)), (Some(&3.0), Some(&1.0)));
/// # Ok::<(), carom::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Schedule<T> {
    values: Vec<T>,
}

impl<T> From<T> for Schedule<T> {
    fn from(value: T) -> Self {
        Schedule { values: vec![value] }
    }
}

impl<T> From<Vec<T>> for Schedule<T> {
    fn from(values: Vec<T>) -> Self {
        Schedule { values }
    }
}

impl<T, const N: usize> From<[T; N]> for Schedule<T> {
    fn from(values: [T; N]) -> Self {
        Schedule { values: values.into() }
    }
}

impl<T: Clone> From<&[T]> for Schedule<T> {
    fn from(values: &[T]) -> Self {
        Schedule { values: values.to_vec() }
    }
}

impl<T> Schedule<T> {
    /// The value at a step. `None` only if the list is empty, which systems refuse.
    pub fn get(&self, step: usize) -> Option<&T> {
        self.values.get(step).or(self.values.last())
    }

    /// Whether the value is the same at every step.
    pub fn is_constant(&self) -> bool {
        self.values.len() <= 1
    }

    /// The step from which on the value is constant.
    pub fn settles(&self) -> usize {
        self.values.len().saturating_sub(1)
    }

    /// The values changed by a function.
    pub(crate) fn map(&self, f: impl FnMut(&T) -> T) -> Self {
        Schedule { values: self.values.iter().map(f).collect() }
    }

    /// All different entries, in the order of the steps.
    pub(crate) fn values(&self) -> impl Iterator<Item = &T> {
        self.values.iter()
    }

    /// Refuses an empty list. The error names `what`.
    pub(crate) fn check(&self, what: &str) -> Result<(), Error> {
        if self.values.is_empty() {
            let what = format!("the number of values of {what}");
            return Err(Error::out_of_range(what, 0.0, 1.0..));
        }
        Ok(())
    }
}
