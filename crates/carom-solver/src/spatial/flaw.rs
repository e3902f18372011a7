//! Reasons why a program cannot be searched.

use crate::interval::Interval;

/// A reason why a program cannot be searched.
#[derive(Debug, Clone, Copy)]
pub(crate) enum SearchFlaw {
    /// A column without a bound, and no bound of the objective because of it.
    OpenColumn(usize),
    /// The function of a column is infinite within the range of an argument.
    Pole { result: usize, range: Interval },
}
