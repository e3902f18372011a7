//! The operations that a look-up takes at most.

use crate::arrays::LookupArrays;

/// The operations of a look-up, at most.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub struct LookupOperations {
    /// Comparisons of numbers, whole or not.
    pub comparisons: usize,
    /// Multiplications, and as many sums.
    pub products: usize,
    /// Divisions.
    pub divisions: usize,
}

impl<T> LookupArrays<T> {
    /// The most operations of a look-up with its law.
    #[must_use]
    pub fn operations(&self) -> LookupOperations {
        let (states, inputs) = (self.lower.len(), self.inputs);
        let mut most = LookupOperations {
            comparisons: 0,
            // Those of an explicit law.
            products: if self.laws.is_empty() { 0 } else { (states + 1) * (inputs + 1) },
            divisions: 0,
        };
        for program in &self.programs {
            let (rows, exchanges) = (program.rows as usize, program.exchanges as usize);
            // An exchange is that of two pairs at most.
            let products = 2 * exchanges * (rows + inputs) * (rows + 1);
            let own = states + (rows + inputs) * states + products;
            most.products = most.products.max(own);
            let comparisons = (exchanges + 1) * rows + exchanges * (rows + 1);
            most.comparisons = most.comparisons.max(comparisons);
            most.divisions = most.divisions.max(2 * exchanges * (2 * rows + inputs + 1));
        }
        most.comparisons += self.depth as usize + states * (states - 1) / 2;
        most.products += states;
        most
    }
}
