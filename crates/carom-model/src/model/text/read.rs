//! The result of reading a file: the model, and where the reader had to decide.

use std::fmt;

use crate::model::{Model, Variable};

/// A model from a file, and where the file was not plain.
///
/// ```
/// use carom::model::lp;
///
/// let read = lp::read("min x + y st x + y >= 1 bounds x <= 3 x <= 2 end")?;
/// assert_eq!(read.model.variable_count(), 2);
/// assert_eq!(
///     read.warnings[0].to_string(),
///     "line 1, column 39: the upper bound of `x` was 3 before and is 2 now; the last one counts"
/// );
/// # Ok::<(), carom::Error>(())
/// ```
#[derive(Debug, Clone)]
#[non_exhaustive]
#[must_use]
pub struct Read {
    /// The model.
    pub model: Model,
    /// Where the file repeats or omits something and was read as most readers do, in the order of
    /// discovery. Empty for a plain file.
    pub warnings: Vec<Warning>,
    /// Values of some variables to begin with, as NL files give them. Nobody has checked them;
    /// those of integers can be a [MIP start](crate::solver::MipStart).
    pub start: Vec<(Variable, f64)>,
}

/// A place of a file where the reader had to decide.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub struct Warning {
    /// Line, from 1.
    pub line: usize,
    /// Column, from 1.
    pub column: usize,
    /// The finding in words, and how the reader took it.
    pub message: String,
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "line {}, column {}: {}", self.line, self.column, self.message)
    }
}
