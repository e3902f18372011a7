//! Writing: sections in the usual order, every number in its shortest exact form.

use std::borrow::Cow;
use std::fmt::Write as _;

use super::decimal::Decimal;
use super::names;
use crate::error::Error;
use crate::interval::Interval;
use crate::model::ids::Variable;
use crate::model::literal::Literal;
use crate::model::sense::Sense;
use crate::model::text::lines::{file_bounds, lines, number, objective_name, quadratic_lines};
use crate::model::text::quadratic_rows::with_quadratic_rows;
use crate::model::variable::VariableKind;
use crate::model::{Model, VariableRef};

struct MpsLine<'a> {
    name: String,
    terms: Cow<'a, [(Variable, f64)]>,
    products: Vec<(Variable, Variable, f64)>,
    form: Form,
    condition: Option<Literal>,
}

/// `lower <= a'x <= upper` in MPS.
struct Form {
    kind: char,
    right: f64,
    range: Option<String>,
}

/// The text of a model as free MPS.
pub(super) fn text(model: &Model) -> Result<String, Error> {
    let model = &*with_quadratic_rows(model)?;
    let mut lines = lines(model, "MPS")?;
    lines.extend(quadratic_lines(model, "MPS")?);
    let objective = objective_name(&lines);
    let lines = lines.into_iter().map(|line| MpsLine {
        name: names::write(line.name),
        terms: line.terms,
        products: line.products,
        form: form(line.limits),
        condition: line.condition,
    });
    let lines: Vec<MpsLine<'_>> = lines.collect();
    let columns: Vec<String> = model.variables().map(|v| names::write(v.name())).collect();
    let mut text = String::new();
    write_rows(&mut text, model, &lines, &objective);
    write_columns(&mut text, model, &lines, &columns, &objective);
    write_limits(&mut text, model, &lines, &objective);
    write_bounds(&mut text, model, &columns)?;
    write_sets(&mut text, model, &columns);
    write_products(&mut text, model, &columns);
    lines.iter().for_each(|line| write_row_products(&mut text, line, &columns));
    let conditions = lines.iter().filter_map(|line| Some((line, line.condition?)));
    for (k, (line, condition)) in conditions.enumerate() {
        section(&mut text, k, "INDICATORS");
        let column = &columns[condition.variable().index()];
        entry(&mut text, "IF", &line.name, column, if condition.is_on() { "1" } else { "0" });
    }
    text.push_str("ENDATA\n");
    Ok(text)
}

fn write_rows(text: &mut String, model: &Model, lines: &[MpsLine<'_>], objective: &str) {
    put(text, format_args!("{}\n", format!("NAME          {}", model.name()).trim_end()));
    if model.sense() == Sense::Maximize {
        text.push_str("OBJSENSE\n    MAX\n");
    }
    put(text, format_args!("ROWS\n N  {objective}\n"));
    for line in lines {
        put(text, format_args!(" {}  {}\n", line.form.kind, line.name));
    }
}

fn write_columns(
    text: &mut String,
    model: &Model,
    lines: &[MpsLine<'_>],
    columns: &[String],
    objective: &str,
) {
    let mut entries: Vec<Vec<(&str, f64)>> = vec![Vec::new(); columns.len()];
    for (variable, value) in model.objective().affine().terms() {
        entries[variable.index()].push((objective, value));
    }
    for line in lines {
        for &(variable, value) in &*line.terms {
            entries[variable.index()].push((&line.name, value));
        }
    }
    text.push_str("COLUMNS\n");
    let mut markers = 0;
    let mut open = false;
    let mut mark = |text: &mut String, integer: bool| {
        if integer != open {
            let word = if integer { "INTORG" } else { "INTEND" };
            let name = format!("MARKER{markers}");
            put(text, format_args!("    {name:<8}  'MARKER'                 '{word}'\n"));
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
            entry(text, "", column, row, &number(value));
        }
    }
    mark(text, false);
}

fn write_limits(text: &mut String, model: &Model, lines: &[MpsLine<'_>], objective: &str) {
    text.push_str("RHS\n");
    // A right-hand side of the objective row is the negative of its constant.
    let constant = model.objective().affine().offset();
    if constant.to_bits() != 0 {
        entry(text, "", "RHS", objective, &number(-constant));
    }
    for line in lines.iter().filter(|line| line.form.right.to_bits() != 0) {
        entry(text, "", "RHS", &line.name, &number(line.form.right));
    }
    let ranges = lines.iter().filter_map(|line| Some((line, line.form.range.as_ref()?)));
    for (k, (line, range)) in ranges.enumerate() {
        section(text, k, "RANGES");
        entry(text, "", "RANGE", &line.name, range);
    }
}

fn write_bounds(text: &mut String, model: &Model, columns: &[String]) -> Result<(), Error> {
    text.push_str("BOUNDS\n");
    for (variable, column) in model.variables().zip(columns) {
        let (bounds, semi) = file_bounds(&variable, "MPS")?;
        for (kind, value) in bound_entries(&variable, bounds, semi) {
            entry(text, kind, "BOUND", column, &value.map(number).unwrap_or_default());
        }
    }
    Ok(())
}

/// The entries of one variable. They rely on no default that readers disagree about.
fn bound_entries(
    variable: &VariableRef<'_>,
    bounds: Interval,
    semi: bool,
) -> Vec<(&'static str, Option<f64>)> {
    let Interval { lower, upper } = bounds;
    let kind = variable.kind();
    let integer = kind.is_integral();
    if semi {
        let low = if lower.is_finite() { ("LO", Some(lower)) } else { ("MI", None) };
        // As `SC` between markers a semi-integer column is semi-continuous for some readers.
        let kind = if integer { "SI" } else { "SC" };
        return vec![low, (kind, Some(if upper.is_finite() { upper } else { 1e30 }))];
    }
    if kind == VariableKind::Binary && lower.to_bits() == 0 && upper == 1.0 {
        return vec![("BV", None)];
    }
    // Other integer columns within these bounds are binaries.
    if kind == VariableKind::Integer && lower >= 0.0 && upper <= 1.0 {
        return vec![("LI", Some(lower)), ("UI", Some(upper))];
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

/// The sets. If a column has the name of a kind, the longer form of the lines is clear.
fn write_sets(text: &mut String, model: &Model, columns: &[String]) {
    let is_kind = |name: &str| ["S1", "S2", "s1", "s2"].contains(&name);
    let doubtful = columns.iter().any(|name| is_kind(name));
    for (k, set) in model.special_ordered_sets().enumerate() {
        section(text, k, "SOS");
        let (before, after) = if doubtful { ("SOS ", " 1") } else { ("", "") };
        put(text, format_args!(" S{} {before}{}{after}\n", set.most(), names::write(set.name())));
        for &(member, weight) in set.members() {
            let name = &columns[member.index()];
            let word = if is_kind(name) { "SOS" } else { "" };
            entry(text, word, name, &number(weight), "");
        }
    }
}

fn write_products(text: &mut String, model: &Model, columns: &[String]) {
    for (k, (first, second, value)) in model.objective().products().into_iter().enumerate() {
        section(text, k, "QUADOBJ");
        // The file holds Q of 1/2 x'Qx, each pair once.
        let value = if first == second { 2.0 * value } else { value };
        let (first, second) = (&columns[first.index()], &columns[second.index()]);
        entry(text, "", first, second, &number(value));
    }
}

/// Writes all of Q of `x'Qx`: a pair of two columns in either order with half its coefficient.
fn write_row_products(text: &mut String, line: &MpsLine<'_>, columns: &[String]) {
    for (k, &(first, second, value)) in line.products.iter().enumerate() {
        section(text, k, &format!("QCMATRIX   {}", line.name));
        let (a, b) = (&columns[first.index()], &columns[second.index()]);
        if first == second {
            entry(text, "", a, b, &number(value));
        } else {
            entry(text, "", a, b, &number(0.5 * value));
            entry(text, "", b, a, &number(0.5 * value));
        }
    }
}

/// Chooses kind, right-hand side and range of a row.
fn form(limits: Interval) -> Form {
    let Interval { lower, upper } = limits;
    match (lower.is_finite(), upper.is_finite()) {
        (false, _) => Form { kind: 'L', right: upper, range: None },
        (true, false) => Form { kind: 'G', right: lower, range: None },
        _ if lower.to_bits() == upper.to_bits() => Form { kind: 'E', right: lower, range: None },
        _ => two_sided(lower, upper),
    }
}

/// Ranges with more digits than this are written from the limit of smaller magnitude.
const LONG_RANGE: usize = 40;

/// A row with two finite limits: one as the right-hand side, the other through the range.
///
/// The range is the exact difference of the two decimals, so reading restores the other limit
/// exactly. If the magnitudes are so far apart that this takes very many digits, the smaller one is
/// lost in the larger one, and the larger one is the range.
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

/// Writes a section's name before its first entry.
fn section(text: &mut String, entry: usize, name: &str) {
    if entry == 0 {
        text.push_str(name);
        text.push('\n');
    }
}

/// A data line, in the columns of fixed MPS as far as names and number fit.
fn entry(text: &mut String, kind: &str, first: &str, second: &str, value: &str) {
    let line = format!(" {kind:<2} {first:<8}  {second:<8}  {value:>12}");
    put(text, format_args!("{}\n", line.trim_end()));
}

fn put(text: &mut String, arguments: std::fmt::Arguments<'_>) {
    // Writing into a string cannot fail.
    let _ = text.write_fmt(arguments);
}
