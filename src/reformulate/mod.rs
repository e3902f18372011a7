//! From what is meant to plain rows: a model with indicators becomes one without.
//!
//! Each reformulation is a file of its own. It takes a [`Model`] and returns an equivalent model
//! over the same variables (or more), so handles and solutions carry over; text forms before and
//! after can be compared, and the lowered model can be written as MPS for any other solver.
//!
//! ```
//! use carom::prelude::*;
//! use carom::reformulate;
//!
//! let mut model = Model::new("m");
//! let x = model.continuous("x", -2.0, 10.0)?;
//! let hit = model.binary("hit")?;
//! model.add("contact", hit.on().implies(x.le(0.0)))?;
//! let lowered = reformulate::lower(&model)?;
//! assert!(lowered.model().to_string().contains("contact_upper: x + 10"));
//! assert_eq!(lowered.report().entries()[0].largest.as_deref(), Some("x"));
//! # Ok::<(), carom::Error>(())
//! ```

mod big_m;
mod report;

pub use report::{BigMEntry, BigMReport, BigMSource, Side};

use crate::error::Error;
use crate::model::Model;

/// A model without indicators, and where its big-Ms come from.
#[derive(Debug, Clone)]
#[must_use]
pub struct Lowered {
    model: Model,
    report: BigMReport,
}

impl Lowered {
    /// The lowered model. Handles of the original are valid in it.
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// Every big-M with its source.
    pub fn report(&self) -> &BigMReport {
        &self.report
    }
}

/// Replaces every indicator by big-M rows, with each M from the *current* bounds.
///
/// # Errors
///
/// [`Error::UnboundedIndicator`] naming the variable whose bound is missing,
/// [`Error::UnsafeBigM`] for a user's M that the bounds do not prove.
pub fn lower(model: &Model) -> Result<Lowered, Error> {
    let mut lowered = model.without_indicators();
    let mut report = BigMReport::default();
    for indicator in model.indicators() {
        big_m::apply(&indicator, &mut lowered, &mut report)?;
    }
    Ok(Lowered { model: lowered, report })
}
