//! Rows and terms as a model stores them.

use super::ids::Variable;
use super::literal::Literal;

/// A row as a model stores it: merged terms, the constant moved into the limits.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct StoredRow {
    pub(crate) terms: Vec<(Variable, f64)>,
    #[cfg_attr(feature = "serde", serde(with = "crate::wire"))]
    pub(crate) lower: f64,
    #[cfg_attr(feature = "serde", serde(with = "crate::wire"))]
    pub(crate) upper: f64,
}

/// A term as a model stores it.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct StoredTerm {
    pub(crate) selector: Literal,
    pub(crate) rows: Vec<StoredRow>,
    /// The terms of each nested disjunction. One of them is selected if and only if this term is.
    pub(crate) nested: Vec<Vec<StoredTerm>>,
}

impl StoredTerm {
    /// Calls `visit` with every row of the term and of the terms inside it.
    pub(crate) fn for_each_row(&self, visit: &mut dyn FnMut(&StoredRow)) {
        self.rows.iter().for_each(&mut *visit);
        self.nested.iter().flatten().for_each(|term| term.for_each_row(visit));
    }
}
