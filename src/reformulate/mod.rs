//! From what is meant to plain rows: a model with indicators and logic becomes one without.
//!
//! Each reformulation is a file of its own. Together they make an equivalent model over the same
//! variables, and auxiliary ones after them, so handles carry over; text forms before and after
//! can be compared, and the lowered model can be written as MPS for any other solver.
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
mod clauses;
mod logic;
mod lowering;
mod report;

pub use report::{BigMEntry, BigMReport, BigMSource, Side};

use crate::error::Error;
use crate::model::Model;
use lowering::Lowering;

/// A model of rows only, and where its big-Ms come from.
#[derive(Debug, Clone)]
#[must_use]
pub struct Lowered {
    model: Model,
    report: BigMReport,
    original: usize,
}

impl Lowered {
    /// The lowered model. Handles of the original are valid in it; auxiliary variables come after
    /// the original ones.
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// Every big-M with its source.
    pub fn report(&self) -> &BigMReport {
        &self.report
    }

    /// From a point of the lowered model, one value per variable, to the point of the original
    /// that it stands for.
    pub fn restore(&self, values: &[f64]) -> Vec<f64> {
        values.iter().take(self.original).copied().collect()
    }
}

/// Replaces every indicator by big-M rows, with each M from the *current* bounds, and every logic
/// statement by its rows.
///
/// # Errors
///
/// [`Error::UnboundedIndicator`] naming the variable whose bound is missing,
/// [`Error::UnsafeBigM`] for a user's M that the bounds do not prove.
pub fn lower(model: &Model) -> Result<Lowered, Error> {
    let mut lowering = Lowering::new(model);
    for indicator in model.indicators() {
        big_m::apply(&indicator, &mut lowering)?;
    }
    for statement in model.logical_constraints() {
        logic::apply(&statement, &mut lowering)?;
    }
    let Lowering { model: lowered, report, .. } = lowering;
    Ok(Lowered { model: lowered, report, original: model.variable_count() })
}
