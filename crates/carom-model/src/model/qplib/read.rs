//! Reading: from lines to the parts of a program as the file lists them.

use std::collections::HashSet;

use crate::error::{Error, ErrorKind};
use crate::model::sense::Sense;
use crate::model::text::token::{self, Token, UNMENTIONED};

/// The contents of a file, from which [`build`](super::build) makes a model. Indices count from 0.
#[derive(Debug)]
pub(super) struct QplibFile<'a> {
    pub(super) name: &'a str,
    pub(super) sense: Sense,
    /// Entries of a triangle of the objective's matrix H, of 1/2 x'Hx.
    pub(super) objective: Vec<Product<'a>>,
    pub(super) linear: Vec<f64>,
    pub(super) constant: f64,
    pub(super) variables: Vec<Column<'a>>,
    pub(super) rows: Vec<QplibRow<'a>>,
}

/// A product in `1/2 x'Hx`, from an entry of H and the one across the diagonal.
#[derive(Debug, Clone, Copy)]
pub(super) struct Product<'a> {
    pub(super) pair: (usize, usize),
    pub(super) factor: f64,
    pub(super) place: Token<'a>,
}

#[derive(Debug, Clone, Copy)]
pub(super) struct Column<'a> {
    pub(super) lower: f64,
    pub(super) upper: f64,
    pub(super) is_integer: bool,
    pub(super) name: Option<&'a str>,
}

/// `lower <= 1/2 x'Hx + a'x <= upper`.
#[derive(Debug, Default)]
pub(super) struct QplibRow<'a> {
    pub(super) products: Vec<Product<'a>>,
    pub(super) terms: Vec<(usize, f64)>,
    pub(super) lower: f64,
    pub(super) upper: f64,
    pub(super) name: Option<&'a str>,
}

/// The kind of program, from the three letters of the second line.
struct ProblemType {
    has_products: bool,
    variables: u8,
    has_rows: bool,
    has_quadratic_rows: bool,
}

impl ProblemType {
    fn read(word: &Token<'_>) -> Result<Self, Error> {
        let letters = word.text.to_ascii_uppercase();
        let known = |at: usize, of: &[u8]| letters.as_bytes().get(at).filter(|c| of.contains(c));
        let all = (letters.len() == 3)
            .then(|| Some((known(0, b"LDCQ")?, known(1, b"CBMIG")?, known(2, b"NBLDCQ")?)));
        let Some((&objective, &variables, &rows)) = all.flatten() else {
            return Err(word.error(format!(
                "expected the type of the problem, three letters for objective (L, D, C, Q), variables (C, B, \
                 M, I, G) and constraints (N, B, L, D, C, Q), found `{}`",
                word.text
            )));
        };
        Ok(ProblemType {
            has_products: objective != b'L',
            variables,
            has_rows: !b"NB".contains(&rows),
            has_quadratic_rows: b"DCQ".contains(&rows),
        })
    }
}

/// The lines of a text that hold something; what follows the expected words of a line is a comment.
struct QplibLines<'a> {
    lines: std::iter::Zip<std::str::Lines<'a>, std::ops::RangeFrom<usize>>,
    /// The number of the last line.
    last: usize,
    tokens: Vec<Token<'a>>,
}

impl<'a> QplibLines<'a> {
    /// The first words of the next line.
    fn words<const N: usize>(&mut self, what: &str) -> Result<[Token<'a>; N], Error> {
        loop {
            let Some((text, number)) = self.lines.next() else {
                let message = format!("the file ends before {what}");
                return Err(ErrorKind::Parse { line: self.last + 1, column: 1, message }.into());
            };
            self.last = number;
            token::split(text, number, &mut self.tokens);
            match self.tokens.first() {
                None => continue,
                Some(first) if first.text.starts_with(['#', '!', '%']) => continue,
                Some(first) => {
                    let found = self.tokens.get(..N).and_then(|words| words.try_into().ok());
                    return found.ok_or_else(|| first.error(format!("expected {what}")));
                }
            }
        }
    }

    fn number(&mut self, what: &str) -> Result<f64, Error> {
        let [word] = self.words(what)?;
        word.raw()
    }

    /// A number of entries, which is at most `most`.
    fn count(&mut self, what: &str, most: usize) -> Result<usize, Error> {
        let [word] = self.words(what)?;
        match word.text.parse() {
            Ok(count) if count <= most => Ok(count),
            Ok(count) => Err(word.error(format!(
                "{count} are more than a file of this length can be about; correct {what}"
            ))),
            Err(_) => Err(word.error(format!("expected {what}, found `{}`", word.text))),
        }
    }

    /// A number of entries, and the entries.
    fn list<const N: usize>(
        &mut self,
        what: &str,
        most: usize,
    ) -> Result<Vec<[Token<'a>; N]>, Error> {
        let count = self.count(&format!("the number of {what}"), most)?;
        (0..count).map(|_| self.words(&format!("an entry of the {what}"))).collect()
    }

    /// A value for all of `size` places, and those of some that differ.
    fn vector(&mut self, what: &str, size: usize) -> Result<Vec<f64>, Error> {
        let default = self.number(&format!("the default of the {what}"))?;
        let mut values = vec![default; size];
        let mut known = HashSet::new();
        for [at, value] in self.list(what, size)? {
            let place = index(&at, size)?;
            once(&mut known, place, &at)?;
            values[place] = value.raw()?;
        }
        Ok(values)
    }
}

/// An index, which files count from 1.
fn index(word: &Token<'_>, count: usize) -> Result<usize, Error> {
    match word.text.parse::<usize>() {
        Ok(index) if (1..=count).contains(&index) => Ok(index - 1),
        _ => Err(word.error(format!("expected an index from 1 to {count}, found `{}`", word.text))),
    }
}

fn once<T: Eq + std::hash::Hash>(
    known: &mut HashSet<T>,
    entry: T,
    word: &Token<'_>,
) -> Result<(), Error> {
    match known.insert(entry) {
        true => Ok(()),
        false => Err(word.error("this entry is given twice; keep one of them")),
    }
}

/// The entry of a triangle: of the lower one, as the format's paper has it, it stands for itself
/// and its mirror image; files with the upper one, converted from LP files, have the sum of both.
fn product<'a>(words: [Token<'a>; 3], count: usize) -> Result<Product<'a>, Error> {
    let [row, column, value] = words;
    let (i, j) = (index(&row, count)?, index(&column, count)?);
    let factor = if i > j { value.finite()? } else { 0.5 * value.finite()? };
    Ok(Product { pair: (i.max(j), i.min(j)), factor, place: row })
}

impl<'a> QplibFile<'a> {
    /// Goes through all lines.
    pub(super) fn scan(text: &'a str) -> Result<QplibFile<'a>, Error> {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let mut lines = QplibLines { lines: text.lines().zip(1..), last: 0, tokens: Vec::new() };
        let most = text.len();
        let [name] = lines.words("the name of the problem")?;
        let [letters] = lines.words("the type of the problem")?;
        let kind = ProblemType::read(&letters)?;
        let [word] = lines.words("`minimize` or `maximize`")?;
        let sense = match word.text.to_ascii_lowercase().as_str() {
            "minimize" => Sense::Minimize,
            "maximize" => Sense::Maximize,
            other => {
                return Err(
                    word.error(format!("expected `minimize` or `maximize`, found `{other}`"))
                );
            }
        };
        let n = lines.count("the number of variables", most.max(UNMENTIONED))?;
        let m = match kind.has_rows {
            true => lines.count("the number of constraints", most.max(UNMENTIONED))?,
            false => 0,
        };
        let mut rows: Vec<QplibRow<'a>> = (0..m).map(|_| QplibRow::default()).collect();
        let mut objective = Vec::new();
        if kind.has_products {
            let mut known = HashSet::new();
            for words in lines.list("entries of the objective's matrix", most)? {
                let entry = product(words, n)?;
                once(&mut known, entry.pair, &entry.place)?;
                objective.push(entry);
            }
        }
        let linear = lines.vector("coefficients of the objective", n)?;
        let constant = lines.number("the constant of the objective")?;
        if kind.has_quadratic_rows {
            let mut known = HashSet::new();
            for [k, i, j, value] in lines.list("entries of the constraints' matrices", most)? {
                let (row, entry) = (index(&k, m)?, product([i, j, value], n)?);
                once(&mut known, (row, entry.pair), &k)?;
                rows[row].products.push(Product { place: k, ..entry });
            }
        }
        if kind.has_rows {
            let mut known = HashSet::new();
            for [k, i, value] in lines.list("coefficients of the constraints", most)? {
                let (row, column) = (index(&k, m)?, index(&i, n)?);
                once(&mut known, (row, column), &k)?;
                rows[row].terms.push((column, value.finite()?));
            }
        }
        let infinity = lines.number("the value of infinite bounds")?.abs();
        let end = |value: f64| match value.abs() >= infinity {
            true => f64::INFINITY.copysign(value),
            false => token::or_infinite(value),
        };
        if kind.has_rows {
            let lower = lines.vector("lower limits of the constraints", m)?;
            let upper = lines.vector("upper limits of the constraints", m)?;
            for (row, limits) in rows.iter_mut().zip(lower.into_iter().zip(upper)) {
                (row.lower, row.upper) = (end(limits.0), end(limits.1));
            }
        }
        let mut variables = columns(&mut lines, &kind, n, &end)?;
        lines.vector("start values of the variables", n)?;
        if kind.has_rows {
            lines.vector("start values of the multipliers of the constraints", m)?;
        }
        lines.vector("start values of the multipliers of the bounds", n)?;
        for [at, name] in lines.list("names of variables", n)? {
            variables[index(&at, n)?].name = Some(name.text);
        }
        if kind.has_rows {
            for [at, name] in lines.list("names of constraints", m)? {
                rows[index(&at, m)?].name = Some(name.text);
            }
        }
        Ok(QplibFile { name: name.text, sense, objective, linear, constant, variables, rows })
    }
}

/// The bounds and the kinds of the variables.
fn columns<'a>(
    lines: &mut QplibLines<'a>,
    kind: &ProblemType,
    n: usize,
    end: &impl Fn(f64) -> f64,
) -> Result<Vec<Column<'a>>, Error> {
    let is_integer = b"BI".contains(&kind.variables);
    let mut variables = vec![Column { lower: 0.0, upper: 1.0, is_integer, name: None }; n];
    if kind.variables != b'B' {
        let lower = lines.vector("lower bounds of the variables", n)?;
        let upper = lines.vector("upper bounds of the variables", n)?;
        for (column, bounds) in variables.iter_mut().zip(lower.into_iter().zip(upper)) {
            (column.lower, column.upper) = (end(bounds.0), end(bounds.1));
        }
    }
    if b"MG".contains(&kind.variables) {
        let kinds = lines.vector("kinds of the variables", n)?;
        for (column, kind) in variables.iter_mut().zip(kinds) {
            column.is_integer = kind != 0.0;
            if kind == 2.0 {
                (column.lower, column.upper) = (column.lower.max(0.0), column.upper.min(1.0));
            }
        }
    }
    Ok(variables)
}
