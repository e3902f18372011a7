//! Norms and quadratic rows as a model stores them.

use crate::model::affine::Affine;
use crate::model::ids::Variable;
use crate::model::quadratic::Quadratic;

/// A conic row as a model stores it.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum StoredConic {
    /// `|entries| <= bound`.
    Norm {
        /// The entries of the norm.
        entries: Vec<Affine>,
        /// The larger side.
        bound: Affine,
    },
    /// `expression <= 0`.
    Quadratic {
        /// The smaller side.
        expression: Quadratic,
    },
}

impl StoredConic {
    /// Calls `visit` with every variable that occurs.
    #[doc(hidden)]
    pub fn for_each_variable(&self, visit: &mut dyn FnMut(Variable)) {
        let mut affine = |expression: &Affine| {
            expression.raw_terms().iter().for_each(|term| visit(term.0));
        };
        match self {
            StoredConic::Norm { entries, bound } => {
                entries.iter().for_each(&mut affine);
                affine(bound);
            }
            StoredConic::Quadratic { expression } => {
                affine(expression.affine());
                for (a, b, _) in expression.products() {
                    visit(a);
                    visit(b);
                }
            }
        }
    }
}
