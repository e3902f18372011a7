//! The program of a log, stated in its header, and the claim.

use crate::exact::Dyadic;
use crate::rows::Row;
use crate::terms::FunctionTerm;
use crate::text::{Lines, Refusal, Words, unreadable};
use std::io::BufRead;

/// A minimisation over columns between bounds, some of them integral, with rows, cones and functions.
#[derive(Debug)]
pub(crate) struct Program {
    /// Whether the model maximises: then the objective below is the negated one.
    pub(crate) is_maximisation: bool,
    pub(crate) columns: Vec<Column>,
    pub(crate) rows: Vec<Row>,
    pub(crate) row_names: Vec<String>,
    pub(crate) cones: Vec<Cone>,
    pub(crate) terms: Vec<FunctionTerm>,
    pub(crate) objective: Objective,
    pub(crate) claim: Claim,
}

#[derive(Debug)]
pub(crate) struct Column {
    pub(crate) is_integral: bool,
    pub(crate) lower: f64,
    pub(crate) upper: f64,
    pub(crate) name: String,
}

/// `x_head >= |(x_j for j in tail)|`, the Euclidean norm; or, if it is rotated,
/// `x_head x_second >= |(x_j for j in tail)|^2` with both at least 0.
#[derive(Debug)]
pub(crate) struct Cone {
    pub(crate) head: u32,
    /// The second head of a rotated cone.
    pub(crate) second: Option<u32>,
    pub(crate) tail: Vec<u32>,
}

/// `1/2 x'Px + linear x + constant`.
#[derive(Debug)]
pub(crate) struct Objective {
    pub(crate) constant: f64,
    pub(crate) linear: Vec<(u32, f64)>,
    /// Row, column and value of the entries of the symmetric `P` with row <= column.
    pub(crate) triangle: Vec<(u32, u32, f64)>,
}

/// The claim of a log about all points of its program.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Claim {
    /// The objective, as a minimisation, is at least this.
    Bound(f64),
    /// There is no point.
    Infeasible,
}

impl Program {
    /// Reads the header, up to the line `proof`.
    pub(crate) fn read<R: BufRead>(lines: &mut Lines<R>) -> Result<Self, Refusal> {
        let mut words = lines.expect("carom")?;
        if (words.word("`proof`")?, words.word("the version")?) != ("proof", "1") {
            return unreadable("this is no log of version 1");
        }
        words.end()?;
        let mut words = lines.expect("sense")?;
        let is_maximisation = match words.word("the sense")? {
            "min" => false,
            "max" => true,
            _ => return unreadable("the sense is neither `min` nor `max`"),
        };
        words.end()?;
        let columns = section(lines, "columns", &["c"], |words, _| column(words))?;
        let many = columns.len();
        let (rows, row_names) =
            section(lines, "rows", &["r"], |words, _| row(words, many))?.into_iter().unzip();
        let cones =
            section(lines, "cones", &["q", "r"], |words, kind| cone(words, many, kind == "r"))?;
        let (terms, constant) = terms_and_constant(lines, many)?;
        let objective = objective(lines, constant, many)?;
        let mut words = lines.expect("claim")?;
        let claim = match words.word("the claim")? {
            "bound" => Claim::Bound(words.number("the bound")?),
            "infeasible" => Claim::Infeasible,
            _ => return unreadable("the claim is neither `bound` nor `infeasible`"),
        };
        words.end()?;
        lines.expect("proof")?.end()?;
        Ok(Program { is_maximisation, columns, rows, row_names, cones, terms, objective, claim })
    }
}

/// A line `name N` and N lines that begin with one of `keywords`.
fn section<R: BufRead, T>(
    lines: &mut Lines<R>,
    name: &str,
    keywords: &[&str],
    mut read: impl FnMut(&mut Words<'_>, &str) -> Result<T, Refusal>,
) -> Result<Vec<T>, Refusal> {
    let mut words = lines.expect(name)?;
    let count = words.count(&format!("the number of {name}"))?;
    words.end()?;
    let mut all = Vec::new();
    for _ in 0..count {
        let (mut words, keyword) = lines.expect_any(keywords)?;
        all.push(read(&mut words, keyword)?);
        words.end()?;
    }
    Ok(all)
}

fn column(words: &mut Words<'_>) -> Result<Column, Refusal> {
    let is_integral = match words.word("`i` or `c`")? {
        "i" => true,
        "c" => false,
        _ => return unreadable("a column is neither `i` nor `c`"),
    };
    let (lower, upper) = limits(words)?;
    Ok(Column { is_integral, lower, upper, name: words.name() })
}

/// A lower limit, which may be `-inf`, and an upper one, which may be `inf`.
fn limits(words: &mut Words<'_>) -> Result<(f64, f64), Refusal> {
    let (lower, upper) = (words.limit("the lower limit")?, words.limit("the upper limit")?);
    if lower == f64::INFINITY || upper == f64::NEG_INFINITY {
        return unreadable("a limit has the wrong infinity");
    }
    Ok((lower, upper))
}

fn row(words: &mut Words<'_>, many: usize) -> Result<(Row, String), Refusal> {
    let (lower, upper) = limits(words)?;
    let entries = words.entries(many)?;
    let limit = |value: f64| value.is_finite().then(|| Dyadic::from_f64(value));
    Ok((Row::new(entries, limit(lower), limit(upper)), words.name()))
}

fn cone(words: &mut Words<'_>, many: usize, is_rotated: bool) -> Result<Cone, Refusal> {
    let head = words.index("column", many)? as u32;
    let second = match is_rotated {
        true => Some(words.index("column", many)? as u32),
        false => None,
    };
    let count = words.count("the number of columns")?;
    let mut tail = Vec::new();
    for _ in 0..count {
        tail.push(words.index("column", many)? as u32);
    }
    Ok(Cone { head, second, tail })
}

/// The lines `terms N` and N terms, if there are any, and the line `objective`.
fn terms_and_constant<R: BufRead>(
    lines: &mut Lines<R>,
    many: usize,
) -> Result<(Vec<FunctionTerm>, f64), Refusal> {
    let mut terms = Vec::new();
    let (mut words, keyword) = lines.expect_any(&["objective", "terms"])?;
    if keyword == "terms" {
        let count = words.count("the number of terms")?;
        words.end()?;
        for _ in 0..count {
            let mut words = lines.expect("f")?;
            terms.push(FunctionTerm::read(&mut words, many)?);
            words.end()?;
        }
        words = lines.expect("objective")?;
    }
    let constant = words.number("the constant")?;
    words.end()?;
    Ok((terms, constant))
}

fn objective<R: BufRead>(
    lines: &mut Lines<R>,
    constant: f64,
    many: usize,
) -> Result<Objective, Refusal> {
    let mut words = lines.expect("g")?;
    let linear = words.entries(many)?;
    words.end()?;
    let mut words = lines.expect("h")?;
    let mut triangle = Vec::new();
    for _ in 0..words.count("the number of entries")? {
        let row = words.index("column", many)? as u32;
        let column = words.index("column", many)? as u32;
        if row > column {
            return unreadable(format!("entry {row} {column} is below the diagonal"));
        }
        triangle.push((row, column, words.number("a value")?));
    }
    words.end()?;
    triangle.sort_by_key(|entry| (entry.0, entry.1));
    let mut same = triangle.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1));
    if let Some([(row, column, _), ..]) = same.find(|same| same.len() > 1) {
        return unreadable(format!("entry {row} {column} is listed twice"));
    }
    Ok(Objective { constant, linear, triangle })
}
