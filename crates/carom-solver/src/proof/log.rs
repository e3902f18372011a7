//! The log of a proof as text; the page *Proofs* describes it.

use std::fmt::Write as _;
use std::io::{self, Write};

use super::bounds::{BoundChange, Clash};
use super::claim::Claim;
use super::facts::BoundSource;
use super::zero_products::ZeroProduct;
use crate::program::{ConeShape, Program};

/// A number as the log has it: the shortest text that is read as the same float.
#[derive(Debug, Clone, Copy)]
pub(super) struct Number(pub(super) f64);

impl std::fmt::Display for Number {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let value = self.0 + 0.0;
        match value.abs() {
            size if size == 0.0 || (1e-5..1e15).contains(&size) => write!(f, "{value}"),
            f64::INFINITY => write!(f, "{value}"),
            _ => write!(f, "{value:e}"),
        }
    }
}

/// Writes a log as it comes; nothing of it is kept.
pub(super) struct ProofLog<'a> {
    out: &'a mut dyn Write,
    line: String,
    commands: u64,
    bytes: u64,
    trial: Option<LogTrial>,
    /// The first failure to write; nothing is written after it.
    failure: Option<io::Error>,
}

/// Lines that may be dropped again, with the counts before them.
#[derive(Debug, Default)]
struct LogTrial {
    lines: String,
    commands: u64,
    bytes: u64,
}

/// Terms of a line: how many there are, then columns and numbers.
fn write_terms(line: &mut String, terms: impl Iterator<Item = (usize, f64)>) {
    let (mut count, mut text) = (0, String::new());
    for (place, value) in terms {
        count += 1;
        // Writing to a string cannot fail.
        let _ = write!(text, " {place} {}", Number(value));
    }
    let _ = write!(line, " {count}{text}");
}

fn write_word(line: &mut String, word: impl std::fmt::Display) {
    let _ = write!(line, " {word}");
}

impl<'a> ProofLog<'a> {
    /// Restates a program and the claim.
    pub(super) fn new(
        out: &'a mut dyn Write,
        program: &Program,
        names: &Names<'_>,
        claim: Claim,
    ) -> Self {
        let (line, commands, bytes, trial, failure) = Default::default();
        let mut log = ProofLog { out, line, commands, bytes, trial, failure };
        let sense = if program.sign < 0.0 { "max" } else { "min" };
        log.put(format_args!("carom proof 1"));
        log.put(format_args!("sense {sense}"));
        log.put(format_args!("columns {}", program.column_count()));
        for j in 0..program.column_count() {
            let kind = if program.integral[j] { 'i' } else { 'c' };
            let (lower, upper) = (Number(program.lower[j]), Number(program.upper[j]));
            log.put(format_args!("c {kind} {lower} {upper} {}", names.column(j)));
        }
        log.put(format_args!("rows {}", program.row_count()));
        for i in 0..program.row_count() {
            let (lower, upper) = (Number(program.row_lower[i]), Number(program.row_upper[i]));
            let (columns, values) = program.row(i);
            let terms = columns.iter().copied().zip(values.iter().copied());
            let _ = write!(log.line, "r {lower} {upper}");
            write_terms(&mut log.line, terms);
            let _ = write!(log.line, " {}", names.row(i));
            log.end_line();
        }
        log.put(format_args!("cones {}", program.cones.len()));
        for cone in &program.cones {
            let letter = if cone.shape == ConeShape::Norm { 'q' } else { 'r' };
            let _ = write!(log.line, "{letter}");
            cone.head().iter().for_each(|j| write_word(&mut log.line, j));
            let _ = write!(log.line, " {}", cone.tail().len());
            cone.tail().iter().for_each(|j| write_word(&mut log.line, j));
            log.end_line();
        }
        if !names.functions.is_empty() {
            log.put(format_args!("terms {}", names.functions.len()));
        }
        for function in names.functions {
            log.put(format_args!("f {function}"));
        }
        log.put(format_args!("objective {}", Number(program.offset)));
        let linear = program.linear.iter().copied().enumerate().filter(|(_, c)| *c != 0.0);
        log.line.push('g');
        write_terms(&mut log.line, linear);
        log.end_line();
        let (mut count, mut text) = (0, String::new());
        for (i, j, p) in program.quadratic_entries().filter(|(i, j, _)| i <= j) {
            count += 1;
            let _ = write!(text, " {i} {j} {}", Number(p));
        }
        log.put(format_args!("h {count}{text}"));
        match claim {
            Claim::Bound(bound) => log.put(format_args!("claim bound {}", Number(bound))),
            Claim::Infeasible => log.put(format_args!("claim infeasible")),
        }
        log.put(format_args!("proof"));
        log.commands = 0;
        log
    }

    fn put(&mut self, text: std::fmt::Arguments<'_>) {
        let _ = self.line.write_fmt(text);
        self.end_line();
    }

    fn end_line(&mut self) {
        self.line.push('\n');
        self.commands += 1;
        self.bytes += self.line.len() as u64;
        match &mut self.trial {
            Some(trial) => trial.lines.push_str(&self.line),
            None if self.failure.is_none() => {
                self.failure = self.out.write_all(self.line.as_bytes()).err();
            }
            None => {}
        }
        self.line.clear();
    }

    /// Whether a line could not be written, so that nothing more is.
    pub(super) fn has_failed(&self) -> bool {
        self.failure.is_some()
    }

    /// Keeps the lines that follow until it is known whether they lead anywhere.
    pub(super) fn begin_trial(&mut self) {
        let (commands, bytes) = (self.commands, self.bytes);
        self.trial = Some(LogTrial { lines: String::new(), commands, bytes });
    }

    /// The bytes of the present trial.
    pub(super) fn trial_size(&self) -> usize {
        self.trial.as_ref().map_or(0, |trial| trial.lines.len())
    }

    /// Writes the lines of a trial.
    pub(super) fn keep_trial(&mut self) {
        if let Some(trial) = self.trial.take().filter(|_| self.failure.is_none()) {
            self.failure = self.out.write_all(trial.lines.as_bytes()).err();
        }
    }

    /// Forgets the lines of a trial.
    pub(super) fn drop_trial(&mut self) {
        if let Some(trial) = self.trial.take() {
            (self.commands, self.bytes) = (trial.commands, trial.bytes);
        }
    }

    /// A bound from a fact or a function.
    pub(super) fn bound(&mut self, change: &BoundChange, source: u32) {
        let (side, value) = (if change.is_upper { 'U' } else { 'L' }, Number(change.value));
        match BoundSource::from_code(source) {
            BoundSource::Fact(fact) => {
                self.put(format_args!("b {} {side} {value} {fact}", change.column));
            }
            BoundSource::Function(function, place) => {
                self.put(format_args!("y {function} {place} {side} {value}"));
            }
        }
    }

    /// A bound that a fact of one column is.
    #[cfg(feature = "nonlinear")]
    pub(super) fn decided(&mut self, column: usize, is_upper: bool, value: f64, fact: usize) {
        let side = if is_upper { 'U' } else { 'L' };
        self.put(format_args!("b {column} {side} {} {fact}", Number(value)));
    }

    /// A row of a function.
    #[cfg(feature = "nonlinear")]
    pub(super) fn enclosure(
        &mut self,
        function: usize,
        is_upper: bool,
        value: f64,
        slopes: &[f64],
    ) {
        let side = if is_upper { 'U' } else { 'L' };
        let _ = write!(self.line, "n {function} {side} {}", Number(value));
        slopes.iter().for_each(|slope| write_word(&mut self.line, Number(*slope)));
        self.end_line();
    }

    /// A split of the range of a column.
    #[cfg(feature = "nonlinear")]
    pub(super) fn split_range(&mut self, column: usize, value: f64) {
        self.put(format_args!("c {column} {}", Number(value)));
    }

    /// The end of a context whose bounds contradict each other or a fact.
    pub(super) fn conflict(&mut self, conflict: Clash) {
        match conflict {
            Clash::Column(j) => self.put(format_args!("d {j}")),
            Clash::Fact(fact, true) => self.put(format_args!("x 1 {fact} -1")),
            Clash::Fact(fact, false) => self.put(format_args!("x 1 {fact} 1")),
        }
    }

    /// The end of a context by a sum of facts.
    pub(super) fn contradiction(&mut self, sum: impl Iterator<Item = (usize, f64)>) {
        self.line.push('x');
        write_terms(&mut self.line, sum);
        self.end_line();
    }

    /// The tangent of the objective at a point.
    pub(super) fn tangent(&mut self, point: impl Iterator<Item = (usize, f64)>) {
        self.line.push('t');
        write_terms(&mut self.line, point);
        self.end_line();
    }

    /// A row that holds in a cone: weights of its head, and of its tail.
    pub(super) fn cone_row(&mut self, cone: usize, head: &[f64], tail: &[f64]) {
        let _ = write!(self.line, "q {cone}");
        head.iter().for_each(|p| write_word(&mut self.line, Number(*p)));
        let _ = write!(self.line, " {}", tail.len());
        tail.iter().for_each(|w| write_word(&mut self.line, Number(*w)));
        self.end_line();
    }

    /// Products that are 0 at every point, which are added to the objective.
    pub(super) fn zero_products(&mut self, products: &[ZeroProduct]) {
        self.line.push('e');
        write_word(&mut self.line, products.len());
        for product in products {
            let &ZeroProduct { column, value, binary, is_off_at_one, factor, ref facts } = product;
            let (value, factor, off) = (Number(value), Number(factor), u8::from(is_off_at_one));
            let count = facts.len();
            let _ = write!(self.line, " {column} {value} {binary} {off} {factor} {count}");
            for &(is_upper, fact) in facts {
                let side = if is_upper { 'U' } else { 'L' };
                let _ = write!(self.line, " {column} {side} {value} {fact}");
            }
        }
        self.end_line();
    }

    /// The proof that the objective is convex.
    pub(super) fn convexity(
        &mut self,
        deficits: impl Iterator<Item = (usize, f64)>,
        factor: &[Vec<(usize, f64)>],
    ) {
        self.line.push('p');
        write_terms(&mut self.line, deficits);
        self.end_line();
        for column in factor.iter().filter(|column| !column.is_empty()) {
            self.line.push('l');
            write_terms(&mut self.line, column.iter().copied());
            self.end_line();
        }
        self.put(format_args!("l 0"));
    }

    /// Bounds from the curvature of the objective around a point.
    pub(super) fn curvature_bounds(
        &mut self,
        point: impl Iterator<Item = (usize, f64)>,
        falls: impl Iterator<Item = (usize, f64)>,
        bounds: &[(usize, bool, f64)],
    ) {
        self.line.push('w');
        write_terms(&mut self.line, point);
        write_terms(&mut self.line, falls);
        write_word(&mut self.line, bounds.len());
        for &(column, is_upper, value) in bounds {
            let side = if is_upper { 'U' } else { 'L' };
            let _ = write!(self.line, " {column} {side} {}", Number(value));
        }
        self.end_line();
    }

    /// A split into two contexts.
    pub(super) fn split(&mut self, column: usize, value: f64) {
        self.put(format_args!("s {column} {}", Number(value)));
    }

    /// A split into two contexts by a form.
    pub(super) fn split_form(&mut self, value: f64, terms: impl Iterator<Item = (usize, f64)>) {
        let _ = write!(self.line, "f {}", Number(value));
        write_terms(&mut self.line, terms);
        self.end_line();
    }

    /// A column that takes whole numbers without loss of optimality, if it is rounded to a side.
    pub(super) fn round(&mut self, column: usize, is_upper: bool) {
        let side = if is_upper { 'U' } else { 'L' };
        self.put(format_args!("u {column} {side}"));
    }

    /// A column that is 0 without loss of optimality, and the direction that leads there.
    pub(super) fn shift(&mut self, column: usize, terms: impl Iterator<Item = (usize, f64)>) {
        let _ = write!(self.line, "v {column}");
        write_terms(&mut self.line, terms);
        self.end_line();
    }

    /// A column that is integral because the context behind it, in which it is not, contradicts
    /// itself.
    pub(super) fn imply(&mut self, column: usize) {
        self.put(format_args!("i {column}"));
    }

    /// A row that the context behind it proves by contradiction.
    pub(super) fn lemma(
        &mut self,
        is_upper: bool,
        value: f64,
        terms: impl Iterator<Item = (usize, f64)>,
    ) {
        let side = if is_upper { 'U' } else { 'L' };
        let _ = write!(self.line, "m {side} {}", Number(value));
        write_terms(&mut self.line, terms);
        self.end_line();
    }

    /// A point of the program.
    pub(super) fn point(&mut self, point: &[f64]) {
        self.line.push('a');
        let values = point.iter().copied().enumerate().filter(|(_, value)| *value != 0.0);
        write_terms(&mut self.line, values);
        self.end_line();
    }

    /// A remark.
    pub(super) fn remark(&mut self, text: &str) {
        self.put(format_args!("# {text}"));
        self.commands -= 1;
    }

    /// The last line. Returns how many commands there are, and how many bytes.
    pub(super) fn finish(mut self) -> io::Result<(u64, u64)> {
        let commands = self.commands;
        self.put(format_args!("end {commands}"));
        self.close(commands)
    }

    /// Ends the log without its last line, so that no checker accepts it.
    pub(super) fn abandon(self) -> io::Result<(u64, u64)> {
        let commands = self.commands;
        self.close(commands)
    }

    fn close(mut self, commands: u64) -> io::Result<(u64, u64)> {
        match self.failure.take() {
            Some(failure) => Err(failure),
            None => self.out.flush().map(|()| (commands, self.bytes)),
        }
    }
}

/// The names of columns and rows, for people.
pub(super) struct Names<'a> {
    pub(super) columns: &'a [String],
    pub(super) rows: &'a [String],
    /// The functions of the program, as the log states them.
    pub(super) functions: &'a [String],
}

impl Names<'_> {
    fn column(&self, j: usize) -> &str {
        self.columns.get(j).map_or("-", String::as_str)
    }

    fn row(&self, i: usize) -> &str {
        self.rows.get(i).map_or("-", String::as_str)
    }
}
