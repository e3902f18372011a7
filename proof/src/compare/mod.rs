//! Whether the program of a log is that of a model file, by readers that share nothing with carom.
//!
//! The checker proves something of the program in the log's header. This part says that the header is
//! the file: the same columns, by name or else by order, with the same bounds; the same rows, in any
//! order; the same objective. Two rows with the same coefficients count as one, rows of a single column
//! as bounds, and bounds of integral columns as the whole numbers within. All else is compared as floats,
//! to the last bit. Statements that carom lowers to rows of other columns are listed, not compared.

mod canonical;
mod cbf;
mod lp;
mod lp_words;
mod model;
mod mps;

use crate::program::Program;
use crate::text::{Failure, Lines};
use canonical::Canonical;
use model::Model;
use std::fmt;
use std::io::BufRead;

/// The format of a model file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// Fixed or free MPS, names without blanks.
    Mps,
    /// The LP format of CPLEX.
    Lp,
    /// The conic benchmark format.
    Cbf,
}

/// How many statements that were not compared a text names.
const MOST_NAMED: usize = 5;

/// The result of a comparison.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Comparison {
    /// All that was compared agrees.
    Same {
        /// The number of columns of the model.
        columns: usize,
        /// The number of rows that were compared.
        rows: usize,
        /// Statements that were not.
        left_out: Vec<String>,
    },
    /// The first difference, in words.
    Different(String),
}

/// Why there is no comparison.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Unreadable {
    /// The model, and why.
    Model(String),
    /// The header of the log.
    Log(Failure),
}

impl fmt::Display for Comparison {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Comparison::Same { columns, rows, left_out } => {
                let ending = |many: usize| if many == 1 { "" } else { "s" };
                let (a, b) = (ending(*columns), ending(*rows));
                write!(f, "the same program: {columns} column{a}, {rows} row{b}")?;
                let mut kinds: Vec<(&str, usize)> = Vec::new();
                for statement in left_out {
                    match kinds.iter_mut().find(|kind| kind.0 == statement) {
                        Some(kind) => kind.1 += 1,
                        None => kinds.push((statement, 1)),
                    }
                }
                for (k, (statement, times)) in kinds.iter().take(MOST_NAMED).enumerate() {
                    write!(f, "{}{statement}", if k == 0 { "; not compared: " } else { ", " })?;
                    if *times > 1 {
                        write!(f, " ({times} times)")?;
                    }
                }
                match kinds.len().saturating_sub(MOST_NAMED) {
                    0 => Ok(()),
                    more => write!(f, " and {more} more"),
                }
            }
            Comparison::Different(what) => write!(f, "another program: {what}"),
        }
    }
}

impl fmt::Display for Unreadable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Unreadable::Model(why) => write!(f, "the model cannot be read: {why}"),
            Unreadable::Log(failure) => write!(f, "the log is {failure}"),
        }
    }
}

impl std::error::Error for Unreadable {}

/// Compares a model with the program in the header of a log.
///
/// # Errors
///
/// [`Unreadable`] says which of the two cannot be read, and why.
pub fn compare(text: &str, format: Format, log: impl BufRead) -> Result<Comparison, Unreadable> {
    let model = match format {
        Format::Mps => mps::read(text),
        Format::Lp => lp::read(text),
        Format::Cbf => cbf::read(text),
    }
    .map_err(Unreadable::Model)?;
    let mut lines = Lines::new(log);
    let program =
        Program::read(&mut lines).map_err(|refusal| Unreadable::Log(lines.at_line(refusal)))?;
    let program = Model::from_program(program);
    let left_out = model.left_out.clone();
    let (columns, rows) = (model.columns.len(), model.rows.len());
    match difference(model, program) {
        Some(what) => Ok(Comparison::Different(what)),
        None => Ok(Comparison::Same { columns, rows, left_out }),
    }
}

/// The first difference.
fn difference(mut model: Model, mut log: Model) -> Option<String> {
    if model.is_maximisation != log.is_maximisation {
        return Some("the sense of the objective".to_string());
    }
    model.fold_constants(&log);
    log.fold_parts();
    let (many, there) = (model.columns.len(), log.columns.len());
    if many > there || (many < there && model.left_out.is_empty()) {
        return Some(format!("the model has {many} columns, the log {there}"));
    }
    let order = model.order_in(&log);
    let has_further = !model.left_out.is_empty();
    let unequal = model.unequal_columns.clone();
    let model = Canonical::new(model, &order);
    let log = Canonical::new(log, &(0..).take(there).collect::<Vec<u32>>());
    let compared = order.iter().zip(&unequal).filter(|(_, skipped)| !**skipped);
    for (&place, _) in compared {
        if let Some(what) = model.other_column(&log, place, has_further) {
            return Some(what);
        }
    }
    model
        .other_row(&log, "the log")
        .or_else(|| if has_further { None } else { log.other_row(&model, "the model") })
        .or_else(|| model.other_objective(&log))
        .or_else(|| model.other_cone(&log, has_further))
}
