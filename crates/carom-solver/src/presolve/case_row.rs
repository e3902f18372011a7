//! Bounds from a row that holds in some cases only, and so is none of a program's own.
//!
//! Takes a row and the bounds of its columns; leaves the bounds that the row implies.

use super::domain::Domain;
use super::propagation::{Conflict, settle};
use super::tightening::{Entry, RowState, tighten};
use crate::program::Program;
use crate::tolerance;

/// A row over a program's columns that is applied to a domain by itself.
#[derive(Debug, Clone)]
pub(crate) struct CaseRow {
    entries: Vec<Entry>,
    limits: [f64; 2],
}

impl CaseRow {
    /// From terms and limits.
    pub(crate) fn new(terms: impl Iterator<Item = (usize, f64)>, limits: [f64; 2]) -> Self {
        let entries = terms.filter(|(_, a)| *a != 0.0);
        // Its limits are loosened, so that nothing in it is exact.
        let entries = entries.map(|(column, a)| Entry::new(column, a, false)).collect();
        CaseRow { entries, limits }
    }

    /// Tightens the bounds of its columns.
    ///
    /// # Errors
    ///
    /// The column at which it contradicts the domain, or row 0 for a contradiction of the whole
    /// row.
    pub(crate) fn tighten(&self, program: &Program, domain: &mut Domain) -> Result<(), Conflict> {
        let (mut found, gain) = (Vec::new(), tolerance::PROPAGATION_GAIN);
        let CaseRow { entries, limits } = self;
        let state = tighten(&program.integral, domain.all(), entries, *limits, gain, &mut found);
        if state == RowState::Violated {
            return Err(Conflict::Row(0));
        }
        for new in found {
            domain.apply(new.column, new.is_upper, new.value);
            settle(program, domain, new.column)?;
        }
        Ok(())
    }

    /// Number of terms.
    pub(crate) fn len(&self) -> usize {
        self.entries.len()
    }
}
