//! Rows and terms as a model stores them.

use super::conic::StoredConic;
use super::ids::Variable;
use super::literal::Literal;

/// A row as a model stores it: merged terms, the constant moved into the limits.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct StoredRow {
    /// Variables and coefficients, each variable once, in order.
    pub terms: Vec<(Variable, f64)>,
    /// The lower limit, or `-inf`.
    #[cfg_attr(feature = "serde", serde(with = "crate::serde_numbers"))]
    pub lower: f64,
    /// The upper limit, or `inf`.
    #[cfg_attr(feature = "serde", serde(with = "crate::serde_numbers"))]
    pub upper: f64,
}

/// A term as a model stores it.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct StoredTerm {
    /// On where the term is selected.
    pub selector: Literal,
    /// Linear rows that hold where it is.
    pub rows: Vec<StoredRow>,
    /// Conic rows that hold where it is.
    #[cfg_attr(feature = "serde", serde(default))]
    pub conic: Vec<StoredConic>,
    /// The terms of each nested disjunction. One of them is selected if and only if this term is.
    pub nested: Vec<Vec<StoredTerm>>,
}

impl StoredTerm {
    /// A term without rows.
    #[doc(hidden)]
    #[inline]
    pub fn always(selector: Literal) -> Self {
        StoredTerm { selector, rows: Vec::new(), conic: Vec::new(), nested: Vec::new() }
    }

    /// Calls `visit` with every row of the term and of the terms inside it.
    #[doc(hidden)]
    #[inline]
    pub fn for_each_row(&self, visit: &mut dyn FnMut(&StoredRow)) {
        self.rows.iter().for_each(&mut *visit);
        self.nested.iter().flatten().for_each(|term| term.for_each_row(visit));
    }

    /// Calls `visit` with every conic row of the term and of the terms inside it.
    #[doc(hidden)]
    #[inline]
    pub fn for_each_conic(&self, visit: &mut dyn FnMut(&StoredConic)) {
        self.conic.iter().for_each(&mut *visit);
        self.nested.iter().flatten().for_each(|term| term.for_each_conic(visit));
    }
}
