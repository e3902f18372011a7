//! Answers to NL files: the values of columns, and why the solver stopped.

use std::fmt::{self, Write as _};

use super::cursor::Cursor;
use super::header::NlHeader;
use super::order::Order;
use super::write::rows;
use crate::error::Error;
use crate::model::Model;
use crate::model::ids::Variable;
use crate::model::text::lines::number;
use crate::model::text::quadratic_rows::with_quadratic_rows;

/// The contents of a SOL file, the answer of a solver to an NL file.
///
/// ```
/// use carom::model::nl::{self, SolFile};
/// use carom::prelude::*;
///
/// let mut model = Model::new("bag");
/// let x = model.continuous("x", 0.0, 4.0)?;
/// let n = model.integer("n", 0.0, 9.0)?;
/// model.add("room", (2.0 * n + x).le(7.5))?;
/// model.maximize((n + 0.25 * x) - 0.125 * x.square())?;
///
/// let file = nl::write(&model)?; // what another solver gets
/// let mut answer = SolFile::to(&file)?;
/// answer.values = vec![1.5, 3.0]; // what it sends
/// let again = SolFile::read(&answer.to_string())?;
/// assert_eq!(again.values_of(&model)?, [(x, 1.5), (n, 3.0)]);
/// # Ok::<(), carom::Error>(())
/// ```
#[derive(Debug, Clone, Default, PartialEq)]
#[non_exhaustive]
pub struct SolFile {
    /// The message of the solver to people.
    pub message: String,
    /// The options of the first line of the NL file, which come back as they were sent.
    pub options: Vec<i64>,
    /// The tolerance behind them, if there is one.
    pub tolerance: Option<f64>,
    /// The number of constraints of the NL file.
    pub rows: usize,
    /// Their multipliers, the change of the objective per unit of their limits; or empty.
    pub multipliers: Vec<f64>,
    /// The number of columns of the NL file.
    pub columns: usize,
    /// Their values; empty if there is no point.
    pub values: Vec<f64>,
    /// The objective that was solved, from 0.
    pub objective: i64,
    /// Why the solver stopped: from 0 solved, from 100 solved perhaps, from 200 infeasible, from
    /// 300 unbounded, from 400 a limit, from 500 a failure.
    pub code: i64,
    /// The proved bound of the objective, in the suffix `bestbound`.
    pub bound: Option<f64>,
}

impl SolFile {
    /// An answer to an NL file, of its sizes, in which nothing is said yet.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::Parse`](crate::error::ErrorKind::Parse) if the file does not begin with the
    /// header of an NL file.
    pub fn to(file: impl AsRef<[u8]>) -> Result<SolFile, Error> {
        let header = NlHeader::read(&mut Cursor::new(file.as_ref()))?;
        Ok(SolFile {
            options: header.options,
            tolerance: header.tolerance,
            rows: header.rows,
            columns: header.columns,
            ..SolFile::default()
        })
    }

    /// Reads a SOL file that is text.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::Parse`](crate::error::ErrorKind::Parse) with the line and column of what is
    /// damaged.
    pub fn read(text: &str) -> Result<SolFile, Error> {
        let mut cursor = Cursor::new(text.as_bytes());
        let mut file = SolFile::default();
        let mut message = Vec::new();
        let mut lines = text.lines();
        let has_options = loop {
            match lines.next() {
                Some(line) if line.trim() == "Options" => break true,
                Some(line) => message.push(line.trim_end()),
                None => break false,
            }
            cursor.end_line();
        };
        if !has_options {
            return Err(cursor.error(text.len(), "the file ends before the line `Options`"));
        }
        cursor.end_line();
        file.message = message.join("\n").trim().to_owned();
        let count = cursor.count("the number of options")?;
        // Two more than there are, if a tolerance comes behind the sizes.
        let has_tolerance = count > 4;
        for _ in 0..if has_tolerance { count - 2 } else { count } {
            file.options.push(cursor.integer("an option")?);
        }
        let mut sizes = [0; 4];
        for size in &mut sizes {
            *size = cursor.below(1 << 31, "a size")?;
        }
        let [rows, multipliers, columns, values] = sizes;
        (file.rows, file.columns) = (rows, columns);
        if has_tolerance {
            file.tolerance = Some(cursor.number("a tolerance")?);
        }
        let mut numbers = |count: usize, what: &str| -> Result<Vec<f64>, Error> {
            if count > text.len() {
                let place = cursor.place();
                let more = format!("{count} numbers are more than the file has bytes");
                return Err(cursor.error(place, more));
            }
            (0..count).map(|_| cursor.number(what)).collect()
        };
        file.multipliers = numbers(multipliers, "a multiplier")?;
        file.values = numbers(values, "a value")?;
        file.ending(cursor)?;
        Ok(file)
    }

    /// The line `objno`, and suffixes, of which `bestbound` is taken.
    fn ending(&mut self, mut cursor: Cursor<'_>) -> Result<(), Error> {
        loop {
            let place = cursor.place();
            let line = String::from_utf8_lossy(cursor.rest_of_line());
            cursor.end_line();
            let words: Vec<&str> = line.split_ascii_whitespace().collect();
            let number = |at: usize| words.get(at)?.parse::<i64>().ok();
            match words.first().copied() {
                Some("objno") => {
                    let (Some(objective), Some(code)) = (number(1), number(2)) else {
                        let what = "expected the objective and the code behind `objno`";
                        return Err(cursor.error(place, what));
                    };
                    (self.objective, self.code) = (objective, code);
                }
                Some("suffix") => {
                    let count = number(2).and_then(|count| usize::try_from(count).ok());
                    let table = number(5).unwrap_or(0);
                    let Some(count) = count else {
                        return Err(cursor.error(place, "expected a number of values"));
                    };
                    let name = cursor.rest_of_line().trim_ascii().to_owned();
                    cursor.end_line();
                    (0..table.clamp(0, 1 << 16)).for_each(|_| cursor.end_line());
                    for _ in 0..count.min(1 << 30) {
                        cursor.count("an index")?;
                        let value = cursor.number("a value")?;
                        if name == b"bestbound" {
                            self.bound = Some(value);
                        }
                    }
                }
                // What other solvers add behind that is theirs.
                _ => return Ok(()),
            }
        }
    }

    /// The values of a model's variables, if this answers the file that [`write`](super::write())
    /// makes of the model.
    ///
    /// # Errors
    ///
    /// As for [`write`](super::write()); [`ErrorKind::Length`](crate::error::ErrorKind::Length)
    /// if there are not as many values as the file has columns.
    pub fn values_of(&self, model: &Model) -> Result<Vec<(Variable, f64)>, Error> {
        let whole = &*with_quadratic_rows(model)?;
        let order = Order::new(whole, &rows(whole)?);
        let what = "the values of a SOL file";
        crate::error::check_length(what, self.values.len(), order.columns.len())?;
        let at = |variable: Variable| (variable, self.values[order.position(variable)]);
        Ok(model.variables().map(|variable| at(variable.id())).collect())
    }
}

impl fmt::Display for SolFile {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // A line of the message must not be taken for what comes behind it.
        for line in self.message.lines() {
            writeln!(f, "{}{line}", if line.trim() == "Options" { "> " } else { "" })?;
        }
        let count = self.options.len() + if self.tolerance.is_some() { 2 } else { 0 };
        writeln!(f, "\nOptions\n{count}")?;
        self.options.iter().try_for_each(|option| writeln!(f, "{option}"))?;
        let sizes = [self.rows, self.multipliers.len(), self.columns, self.values.len()];
        sizes.iter().try_for_each(|size| writeln!(f, "{size}"))?;
        let mut numbers = String::new();
        for value in self.tolerance.iter().chain(&self.multipliers).chain(&self.values) {
            let _ = writeln!(numbers, "{}", number(*value));
        }
        f.write_str(&numbers)?;
        writeln!(f, "objno {} {}", self.objective, self.code)?;
        if let Some(bound) = self.bound.filter(|bound| bound.is_finite()) {
            writeln!(f, "suffix 6 1 10 0 0\nbestbound\n0 {}", number(bound))?;
        }
        Ok(())
    }
}
