//! Linear rows, and combinations of them.

use crate::exact::{Dyadic, Number, OutOfRange, Sum};

/// `lower <= a x <= upper`, where a side may be missing. No column is in it twice.
#[derive(Debug, Clone, Default)]
pub(crate) struct Row {
    /// The entries of `a` that are floats.
    floats: Vec<(u32, f64)>,
    /// The other ones.
    exact: Vec<(u32, Dyadic)>,
    pub(crate) lower: Option<Dyadic>,
    pub(crate) upper: Option<Dyadic>,
}

/// `factor * coefficient` times a column: what a combination is the sum of.
pub(crate) type Term<'a> = (u32, f64, Number<'a>);

impl Row {
    pub(crate) fn new(
        mut floats: Vec<(u32, f64)>,
        lower: Option<Dyadic>,
        upper: Option<Dyadic>,
    ) -> Self {
        floats.retain(|entry| entry.1 != 0.0);
        Row { floats, exact: Vec::new(), lower, upper }
    }

    /// The sum of terms, with neither side; zeros are left out.
    pub(crate) fn combination(terms: &mut [Term<'_>], sum: &mut Sum) -> Result<Self, OutOfRange> {
        let mut row = Row::default();
        terms.sort_by_key(|term| term.0);
        for same in terms.chunk_by(|a, b| a.0 == b.0) {
            for (_, factor, coefficient) in same {
                sum.add(*factor, *coefficient);
            }
            let (Some((column, ..)), value) = (same.first(), sum.take()?) else { continue };
            match value.as_float() {
                Some(0.0) => {}
                Some(float) => row.floats.push((*column, float)),
                None => row.exact.push((*column, value)),
            }
        }
        Ok(row)
    }

    pub(crate) fn entries(&self) -> impl Iterator<Item = (u32, Number<'_>)> {
        let floats = self.floats.iter().map(|&(column, value)| (column, Number::Float(value)));
        floats.chain(self.exact.iter().map(|(column, value)| (*column, Number::Exact(value))))
    }

    /// The coefficient of a column, if it is not 0.
    pub(crate) fn coefficient(&self, column: usize) -> Option<Number<'_>> {
        self.entries().find(|entry| entry.0 as usize == column).map(|entry| entry.1)
    }
}
