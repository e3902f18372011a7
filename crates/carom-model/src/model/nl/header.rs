//! The ten lines of numbers with which a file begins.

use std::ops::Range;

use super::cursor::{Cursor, Encoding};
use crate::error::Error;

/// The sizes of a program, and how its columns are ordered.
#[derive(Debug)]
pub(super) struct NlHeader {
    pub(super) name: String,
    /// Options that a solver sends back as they came.
    pub(super) options: Vec<i64>,
    pub(super) tolerance: Option<f64>,
    pub(super) columns: usize,
    pub(super) rows: usize,
    pub(super) objectives: usize,
    pub(super) functions: usize,
    /// Columns that are integers, in four ranges.
    pub(super) integers: [Range<usize>; 4],
    pub(super) definitions: usize,
    /// How many linear terms the constraints and the objectives have.
    pub(super) nonzeros: [usize; 2],
}

/// The numbers of a line.
fn line(cursor: &mut Cursor<'_>, what: &str, least: usize) -> Result<(usize, Vec<usize>), Error> {
    let start = cursor.place();
    let text = cursor.rest_of_line();
    cursor.end_line();
    let text = String::from_utf8_lossy(text);
    let numbers = text.split('#').next().unwrap_or_default().split_ascii_whitespace();
    let numbers = numbers.map(|word| word.parse::<u32>().map(|number| number as usize));
    let numbers: Result<Vec<usize>, _> = numbers.collect();
    match numbers {
        Ok(numbers) if numbers.len() >= least => Ok((start, numbers)),
        _ => Err(cursor.error(
            start,
            format!("expected the line of the header with {what}, at least {least} integers"),
        )),
    }
}

impl NlHeader {
    /// Reads the header. The cursor stands behind it afterwards, and knows how the rest is written.
    pub(super) fn read(cursor: &mut Cursor<'_>) -> Result<Self, Error> {
        let (name, options, tolerance, is_binary) = first_line(cursor)?;
        let (at, sizes) = line(cursor, "numbers of variables, constraints and objectives", 3)?;
        if let Some(&logical) = sizes.get(5)
            && logical > 0
        {
            return Err(cursor.error(
                at,
                format!(
                    "the program has {logical} logical constraints, which are not read; state them with \
                     binaries and linear rows"
                ),
            ));
        }
        line(cursor, "numbers of nonlinear constraints and objectives", 2)?;
        line(cursor, "numbers of network constraints", 2)?;
        let (at, nonlinear) = line(cursor, "numbers of nonlinear variables", 3)?;
        let (flags_at, flags) = line(cursor, "numbers of network variables and functions", 2)?;
        let (_, whole) = line(cursor, "numbers of discrete variables", 5)?;
        let (_, nonzeros) = line(cursor, "numbers of nonzeros", 2)?;
        line(cursor, "lengths of names", 2)?;
        let (_, common) = line(cursor, "numbers of common expressions", 5)?;
        if is_binary {
            cursor.encoding = match flags.get(2) {
                Some(2) => Encoding::Big,
                Some(0 | 1) | None => Encoding::Little,
                Some(other) => {
                    return Err(cursor.error(
                        flags_at,
                        format!(
                            "the binary form {other} is not read; write the file as text (in AMPL, \
                             `write gNAME;`)"
                        ),
                    ));
                }
            };
        }
        let columns = sizes[0];
        let integers = integers(columns, &nonlinear, &whole).ok_or_else(|| {
            cursor
                .error(at, "the numbers of nonlinear and discrete variables contradict each other")
        })?;
        let definitions = common.iter().take(5).fold(0, |sum: usize, n| sum.saturating_add(*n));
        let functions = flags[1];
        Ok(NlHeader {
            name,
            options,
            tolerance,
            columns,
            rows: sizes[1],
            objectives: sizes[2],
            functions,
            integers,
            nonzeros: [nonzeros[0], nonzeros[1]],
            definitions,
        })
    }
}

/// The form, the options, and the name behind the comment sign.
fn first_line(cursor: &mut Cursor<'_>) -> Result<(String, Vec<i64>, Option<f64>, bool), Error> {
    let start = cursor.place();
    let text = String::from_utf8_lossy(cursor.rest_of_line());
    cursor.end_line();
    let damaged = || {
        let what = "expected `g` or `b` and the options of AMPL, as in `g3 1 1 0`: the first line of a \
                    file of AMPL";
        cursor.error(start, what)
    };
    let (numbers, comment) = text.split_once('#').unwrap_or((&text, ""));
    let is_binary = match numbers.chars().next() {
        Some('g') => false,
        Some('b') => true,
        _ => return Err(damaged()),
    };
    let mut words = numbers[1..].split_ascii_whitespace();
    let count: usize = match words.next().map(str::parse) {
        Some(Ok(count)) if count <= 9 => count,
        None => 0,
        Some(_) => return Err(damaged()),
    };
    let options: Result<Vec<i64>, _> = words.by_ref().take(count).map(str::parse).collect();
    let options = options.map_err(|_| damaged())?;
    let has_tolerance = options.get(1) == Some(&3);
    let tolerance = words.next().filter(|_| has_tolerance).and_then(|word| word.parse().ok());
    let name = comment.trim().strip_prefix("problem ").map_or("", str::trim);
    let name = if name == "unknown" { "" } else { name };
    Ok((name.to_owned(), options, tolerance, is_binary))
}

/// The integers among the columns. These come in the order: nonlinear in constraints and
/// objectives, in constraints alone, in objectives alone, then those of networks, other linear
/// ones, binaries and integers; in each of the first three, integers are the last ones (D. M. Gay,
/// "Hooking your solver to AMPL", 1997, table 3).
fn integers(columns: usize, nonlinear: &[usize], whole: &[usize]) -> Option<[Range<usize>; 4]> {
    let [in_constraints, in_objectives, in_both] = nonlinear[..3].try_into().ok()?;
    let [binaries, integers, both, constraints, objectives] = whole[..5].try_into().ok()?;
    let last = |end: usize, count: usize| Some(end.checked_sub(count)?..end);
    let ends = in_objectives.max(in_constraints);
    let linear = last(columns, usize::checked_add(binaries, integers)?)?;
    let ranges =
        [last(in_both, both)?, last(in_constraints, constraints)?, last(ends, objectives)?, linear];
    let starts = [0, in_both, in_constraints, ends];
    let fit = ranges.iter().zip(starts).all(|(range, start)| range.start >= start);
    fit.then_some(ranges)
}
