//! Whether the program of a log is that of a model file, by readers that share nothing with carom.
//!
//! The checker proves something of the program in the log's header. This part says that the header
//! is the file: the same columns, by name or else by order, with the same bounds; the same rows, in
//! any order; the same objective. Two rows with the same coefficients count as one, rows of a
//! single column as bounds, and bounds of integral columns as the whole numbers within. All else is
//! compared as floats, to the last bit. What statements that are no rows have become is looked for
//! in the log, see `further`; anything else that only the log has makes it another program.

mod canonical;
mod cbf;
mod decimal;
mod further;
mod lp;
mod lp_words;
mod model;
mod mps;
mod polynomial;
mod sets;

use crate::program::Program;
use crate::text::{Failure, Lines};
use canonical::Canonical;
use further::{Found, Further};
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
        /// Statements that were compared up to rounding: quadratic rows, and cones of expressions.
        rounded: Vec<String>,
        /// Statements that were not compared.
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
            Comparison::Same { columns, rows, rounded, left_out } => {
                let ending = |many: usize| if many == 1 { "" } else { "s" };
                let (a, b) = (ending(*columns), ending(*rows));
                write!(f, "the same program: {columns} column{a}, {rows} row{b}")?;
                write_kinds(f, "compared up to rounding", rounded)?;
                write_kinds(f, "not compared", left_out)
            }
            Comparison::Different(what) => write!(f, "another program: {what}"),
        }
    }
}

/// Some statements of each kind.
fn write_kinds(f: &mut fmt::Formatter<'_>, what: &str, statements: &[String]) -> fmt::Result {
    let mut kinds: Vec<(&str, usize)> = Vec::new();
    for statement in statements {
        match kinds.iter_mut().find(|kind| kind.0 == statement) {
            Some(kind) => kind.1 += 1,
            None => kinds.push((statement, 1)),
        }
    }
    for (k, (statement, times)) in kinds.iter().take(MOST_NAMED).enumerate() {
        match k {
            0 => write!(f, "; {what}: {statement}")?,
            _ => write!(f, ", {statement}")?,
        }
        if *times > 1 {
            write!(f, " ({times} times)")?;
        }
    }
    match kinds.len().saturating_sub(MOST_NAMED) {
        0 => Ok(()),
        more => write!(f, " and {more} more"),
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
    if !program.terms.is_empty() {
        let what = "the log has functions, which no format that is compared has";
        return Ok(Comparison::Different(what.to_string()));
    }
    let program = Model::from_program(program);
    let mut left_out = model.left_out.clone();
    let (columns, rows) = (model.columns.len(), model.rows.len());
    Ok(match difference(model, program) {
        Ok(Found { rounded, taken, .. }) => {
            left_out.extend(taken);
            Comparison::Same { columns, rows, rounded, left_out }
        }
        Err(what) => Comparison::Different(what),
    })
}

/// Findings about statements that are no rows, or the first difference.
fn difference(mut model: Model, mut log: Model) -> Result<Found, String> {
    if model.is_maximisation != log.is_maximisation {
        return Err("the sense of the objective".to_string());
    }
    model.fold_constants(&log);
    log.fold_parts();
    let (many, there) = (model.columns.len(), log.columns.len());
    if many > there || (many < there && model.statements.is_empty()) {
        return Err(format!("the model has {many} columns, the log {there}"));
    }
    let order = model.order_in(&log);
    let found = match model.statements.is_empty() {
        true => Found::default(),
        false => Further::take_out(&model, &mut log, &order)?,
    };
    model.widen_semicontinuous();
    let model = Canonical::new(model, &order);
    let log = Canonical::new(log, &(0..).take(there).collect::<Vec<u32>>());
    let mut columns = order.iter().map(|&place| (place, found.heads.contains(&place)));
    let first = columns.find_map(|(place, is_head)| model.other_column(&log, place, is_head));
    let first = first
        .or_else(|| model.other_row(&log, "the log"))
        .or_else(|| log.other_row(&model, "the model"))
        .or_else(|| model.other_objective(&log))
        .or_else(|| model.other_cone(&log));
    first.map_or(Ok(found), Err)
}
