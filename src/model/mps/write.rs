//! Writing: sections in the usual order, every number in its shortest exact form.

use std::fmt::Write as _;

use super::decimal::Decimal;
use crate::error::Error;
use crate::interval::Interval;
use crate::model::ids::Variable;
use crate::model::indicator::Literal;
use crate::model::name::Name;
use crate::model::objective::Sense;
use crate::model::variable::VariableKind;
use crate::model::{Model, VariableRef};

/// A row of the file: a linear row or the row of an indicator.
struct Line<'a> {
    name: String,
    terms: &'a [(Variable, f64)],
    form: Form,
    condition: Option<Literal>,
}

/// How MPS says `lower <= a'x <= upper`.
struct Form {
    kind: char,
    right: f64,
    range: Option<String>,
}

/// The text of a model as free MPS.
pub(super) fn text(model: &Model) -> Result<String, Error> {
    if model.name().chars().any(|c| c.is_control() && c != '\t') {
        return Err(Error::InvalidName { name: model.name().to_owned() });
    }
    let lines = lines(model)?;
    let columns = names(model)?;
    let objective = objective_name(&lines);
    let mut text = String::new();
    write_rows(&mut text, model, &lines, &objective);
    write_columns(&mut text, model, &lines, &columns, &objective);
    write_limits(&mut text, model, &lines, &objective);
    write_bounds(&mut text, model, &columns);
    write_products(&mut text, model, &columns);
    let conditions = lines.iter().filter_map(|line| Some((line, line.condition?)));
    for (k, (line, condition)) in conditions.enumerate() {
        section(&mut text, k, "INDICATORS");
        let (column, on) = (&columns[condition.variable().index()], u8::from(condition.is_on()));
        put(&mut text, format_args!(" IF {} {column} {on}\n", line.name));
    }
    text.push_str("ENDATA\n");
    Ok(text)
}

fn lines(model: &Model) -> Result<Vec<Line<'_>>, Error> {
    let rows = model.constraints().map(|row| (row.name(), row.terms(), row.limits(), None));
    let rows = rows.map(Ok);
    let switched = model.indicators().map(|row| match row.condition().as_literal() {
        Some(literal) => Ok((row.name(), row.terms(), row.limits(), Some(literal))),
        None => Err(not_in_file("the compound condition of", row.name())),
    });
    if let Some(disjunction) = model.disjunctions().next() {
        return Err(not_in_file("the disjunction", disjunction.name()));
    }
    if let Some(logical) = model.logical_constraints().next() {
        return Err(not_in_file("the logic of", logical.name()));
    }
    if let Some(function) = model.functions().next() {
        return Err(not_in_file("the function", function.name()));
    }
    rows.chain(switched)
        .map(|line| {
            let (name, terms, limits, condition) = line?;
            Ok(Line { name: checked(name)?, terms, form: form(limits, name)?, condition })
        })
        .collect()
}

fn not_in_file(what: &'static str, name: &Name) -> Error {
    Error::NotInFile { format: "MPS", what, name: name.to_string() }
}

fn names(model: &Model) -> Result<Vec<String>, Error> {
    model.variables().map(|variable| checked(variable.name())).collect()
}

/// Names are checked once more here: a model read from elsewhere may hold any.
fn checked(name: &Name) -> Result<String, Error> {
    name.check()?;
    Ok(name.to_string())
}

/// A name for the objective row that no other row has.
fn objective_name(lines: &[Line<'_>]) -> String {
    let mut name = "obj".to_owned();
    while lines.iter().any(|line| line.name == name) {
        name.push('_');
    }
    name
}

fn write_rows(text: &mut String, model: &Model, lines: &[Line<'_>], objective: &str) {
    put(text, format_args!("NAME {}\n", model.name()));
    if model.sense() == Sense::Maximize {
        text.push_str("OBJSENSE\n MAX\n");
    }
    put(text, format_args!("ROWS\n N {objective}\n"));
    for line in lines {
        put(text, format_args!(" {} {}\n", line.form.kind, line.name));
    }
}

fn write_columns(
    text: &mut String,
    model: &Model,
    lines: &[Line<'_>],
    columns: &[String],
    objective: &str,
) {
    let mut entries: Vec<Vec<(&str, f64)>> = vec![Vec::new(); columns.len()];
    for (variable, value) in model.objective().affine().terms() {
        entries[variable.index()].push((objective, value));
    }
    for line in lines {
        for &(variable, value) in line.terms {
            entries[variable.index()].push((&line.name, value));
        }
    }
    text.push_str("COLUMNS\n");
    let mut markers = 0;
    let mut open = false;
    let mut mark = |text: &mut String, integer: bool| {
        if integer != open {
            let word = if integer { "INTORG" } else { "INTEND" };
            put(text, format_args!(" MARKER{markers} 'MARKER' '{word}'\n"));
            (open, markers) = (integer, markers + 1);
        }
    };
    for (variable, entries) in model.variables().zip(&mut entries) {
        mark(text, variable.kind().is_integral());
        if entries.is_empty() {
            entries.push((objective, 0.0));
        }
        let column = &columns[variable.id().index()];
        for &(row, value) in &*entries {
            put(text, format_args!(" {column} {row} {}\n", number(value)));
        }
    }
    mark(text, false);
}

fn write_limits(text: &mut String, model: &Model, lines: &[Line<'_>], objective: &str) {
    text.push_str("RHS\n");
    // A right-hand side of the objective row is the negative of its constant.
    let constant = model.objective().affine().offset();
    if constant.to_bits() != 0 {
        put(text, format_args!(" RHS {objective} {}\n", number(-constant)));
    }
    for line in lines.iter().filter(|line| line.form.right.to_bits() != 0) {
        put(text, format_args!(" RHS {} {}\n", line.name, number(line.form.right)));
    }
    let ranges = lines.iter().filter_map(|line| Some((line, line.form.range.as_ref()?)));
    for (k, (line, range)) in ranges.enumerate() {
        section(text, k, "RANGES");
        put(text, format_args!(" RANGE {} {range}\n", line.name));
    }
}

fn write_bounds(text: &mut String, model: &Model, columns: &[String]) {
    text.push_str("BOUNDS\n");
    for (variable, column) in model.variables().zip(columns) {
        for (kind, value) in bound_entries(&variable) {
            match value {
                Some(value) => {
                    put(text, format_args!(" {kind} BOUND {column} {}\n", number(value)));
                }
                None => put(text, format_args!(" {kind} BOUND {column}\n")),
            }
        }
    }
}

/// The entries of one variable; nothing is left to the defaults that readers differ in.
fn bound_entries(variable: &VariableRef<'_>) -> Vec<(&'static str, Option<f64>)> {
    let Interval { lower, upper } = variable.bounds();
    let integer = variable.kind().is_integral();
    if variable.kind() == VariableKind::Binary && lower.to_bits() == 0 && upper == 1.0 {
        return vec![("BV", None)];
    }
    if lower.to_bits() == upper.to_bits() {
        return vec![("FX", Some(lower))];
    }
    let mut entries = Vec::new();
    match (lower.is_finite(), upper.is_finite()) {
        (false, false) => entries.push(("FR", None)),
        (false, true) => entries.push(("MI", None)),
        _ if lower.to_bits() != 0 => entries.push(("LO", Some(lower))),
        _ => {}
    }
    match (lower.is_finite(), upper.is_finite()) {
        (_, true) => entries.push(("UP", Some(upper))),
        (true, false) if integer => entries.push(("PL", None)),
        _ => {}
    }
    entries
}

fn write_products(text: &mut String, model: &Model, columns: &[String]) {
    for (k, (first, second, value)) in model.objective().products().into_iter().enumerate() {
        section(text, k, "QUADOBJ");
        // The file holds Q of 1/2 x'Qx, each pair once.
        let value = if first == second { 2.0 * value } else { value };
        let (first, second) = (&columns[first.index()], &columns[second.index()]);
        put(text, format_args!(" {first} {second} {}\n", number(value)));
    }
}

/// Chooses kind, right-hand side and range of a row.
fn form(limits: Interval, name: &Name) -> Result<Form, Error> {
    let Interval { lower, upper } = limits;
    Ok(match (lower.is_finite(), upper.is_finite()) {
        (false, false) => return Err(Error::UnlimitedRow { name: name.to_string() }),
        (false, true) => Form { kind: 'L', right: upper, range: None },
        (true, false) => Form { kind: 'G', right: lower, range: None },
        _ if lower.to_bits() == upper.to_bits() => Form { kind: 'E', right: lower, range: None },
        _ => two_sided(lower, upper),
    })
}

/// Ranges longer than this are written through the limit of smaller magnitude.
const LONG_RANGE: usize = 40;

/// A row with two finite limits: one as the right-hand side, the other through the range.
///
/// The range is the difference of the two decimals, without rounding, so that reading leads back
/// to the other limit exactly. Where the magnitudes are so far apart that this takes very many
/// digits, the smaller one is lost in the larger one, and the larger one itself is the range.
fn two_sided(lower: f64, upper: f64) -> Form {
    let downward = |range| Form { kind: 'L', right: upper, range: Some(range) };
    let upward = |range| Form { kind: 'G', right: lower, range: Some(range) };
    let (Some(low), Some(high)) = (Decimal::of(lower), Decimal::of(upper)) else {
        return downward(number(upper - lower)); // both are finite
    };
    let Some(width) = high.plus(&low.clone().negated()) else {
        return downward(number(upper - lower)); // no two doubles are that far apart
    };
    if width.significant() > LONG_RANGE
        && low.plus(&high).is_some_and(|sum| {
            sum.to_f64().to_bits()
                == if lower.abs() < upper.abs() { upper } else { lower }.to_bits()
        })
    {
        return if lower.abs() < upper.abs() {
            upward(high.to_string())
        } else {
            downward(low.negated().to_string())
        };
    }
    // A zero keeps its sign only as a right-hand side.
    let negative_zero = lower.to_bits() == (-0.0_f64).to_bits();
    if negative_zero { upward(width.to_string()) } else { downward(width.to_string()) }
}

/// The shortest text that reads back as the same double.
fn number(value: f64) -> String {
    let mut text = format!("{value:?}");
    if text.ends_with(".0") {
        text.truncate(text.len() - 2);
    }
    text
}

/// Writes a section's name before its first entry.
fn section(text: &mut String, entry: usize, name: &str) {
    if entry == 0 {
        text.push_str(name);
        text.push('\n');
    }
}

fn put(text: &mut String, arguments: std::fmt::Arguments<'_>) {
    // Writing into a string cannot fail.
    let _ = text.write_fmt(arguments);
}
