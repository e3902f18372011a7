//! From the entries of a file to a model.

use std::collections::HashSet;

use super::names;
use super::read::{Column, File};
use super::rows::Row;
use crate::error::{Error, ErrorKind};
use crate::model::affine::{Affine, merge};
use crate::model::checks::finite;
use crate::model::ids::Variable;
use crate::model::literal::Literal;
use crate::model::name::Name;
use crate::model::quadratic::Quadratic;
use crate::model::reformulation::BigM;
use crate::model::store::Model;
use crate::model::stored::StoredRow;
use crate::model::text::token::Token;
use crate::model::variable::VariableKind;

/// Makes the model that a file describes.
pub(super) fn model(file: &File<'_>) -> Result<Model, Error> {
    let mut model = Model::new(file.name);
    let variables = variables(file, &mut model)?;
    let mut rows = Vec::with_capacity(file.rows.len());
    for row in &file.rows {
        let terms = row.terms.iter().map(|&(column, value)| (variables[column], value));
        let mut terms: Vec<_> = terms.collect();
        merge(&mut terms);
        let (lower, upper) = (row.lower, row.upper);
        rows.push((row, StoredRow { terms, lower, upper }));
    }
    let labels = rows.iter().filter_map(|(row, _)| row.label);
    let taken: HashSet<Name> = labels.map(|label| names::read(label.text)).collect();
    let mut rows = rows.into_iter().zip(1..).peekable();
    while let Some(((row, mut stored), position)) = rows.next() {
        let name = match row.label {
            None => automatic_name(position, &taken),
            Some(label) => {
                let other = rows.peek().and_then(|((other, half), _)| {
                    let name = joined(label, other.label?)?;
                    let condition = |row: &Row<'_>| row.condition.map(|c| (c.column, c.on));
                    (condition(other) == condition(row) && are_halves(&stored, half))
                        .then_some((name, half.upper))
                });
                match other {
                    Some((name, upper)) => {
                        rows.next();
                        stored.upper = upper;
                        name
                    }
                    None => names::read(label.text),
                }
            }
        };
        if stored.lower.is_infinite() && stored.upper.is_infinite() {
            continue; // has no finite limit
        }
        add(&mut model, row, name, stored, &variables)?;
    }
    model.set_objective(file.sense, objective(file, &variables))?;
    Ok(model)
}

fn add(
    model: &mut Model,
    row: &Row<'_>,
    name: Name,
    stored: StoredRow,
    variables: &[Variable],
) -> Result<(), Error> {
    name.check().map_err(|error| at(row.place, &error))?;
    for &(_, coefficient) in &stored.terms {
        finite(coefficient, "a coefficient", &name).map_err(|error| at(row.place, &error))?;
    }
    match &row.condition {
        None => {
            model.push_constraint(name, stored).map_err(|error| at(row.place, &error))?;
        }
        Some(condition) => {
            let literal = Literal { variable: variables[condition.column], on: condition.on };
            let added = model.push_indicator(name, literal, stored, BigM::Automatic);
            added.map_err(|error| {
                let known = matches!(error.kind(), ErrorKind::DuplicateName { .. });
                at(if known { row.place } else { condition.place }, &error)
            })?;
        }
    }
    Ok(())
}

fn at(place: Token<'_>, error: &Error) -> Error {
    place.error(error.to_string())
}

fn variables(file: &File<'_>, model: &mut Model) -> Result<Vec<Variable>, Error> {
    let mut switches = vec![false; file.columns.len()];
    for condition in file.rows.iter().filter_map(|row| row.condition) {
        switches[condition.column] = true;
    }
    let mut variables = Vec::with_capacity(file.columns.len());
    for (column, switch) in file.columns.iter().zip(switches) {
        let (lower, upper) = bounds(column)?;
        let kind = match (column.integer, column.binary) {
            (_, true) => VariableKind::Binary,
            // Only a binary can be the condition of an indicator.
            (true, _) if switch && lower >= 0.0 && upper <= 1.0 => VariableKind::Binary,
            (true, _) => VariableKind::Integer,
            (false, false) => VariableKind::Continuous,
        };
        let added = model.variable(names::read(column.name.text), kind, lower, upper);
        variables.push(added.map_err(|error| at(column.name, &error))?);
    }
    Ok(variables)
}

/// The bounds of a column, defaults filled in.
fn bounds(column: &Column<'_>) -> Result<(f64, f64), Error> {
    let default = if column.binary { 1.0 } else { f64::INFINITY };
    let (lower, upper) = (column.ends.lower.unwrap_or(0.0), column.ends.upper.unwrap_or(default));
    let (place, name) = (column.ends.last.unwrap_or(column.name), column.name.text);
    if lower > upper {
        let help = match column.ends.lower {
            None => " (where none is given, the lower bound is 0; write `-inf <=` for none)",
            Some(_) => "",
        };
        let message = format!("bounds of `{name}` are crossed: {lower} > {upper}{help}");
        return Err(place.error(message));
    }
    if column.binary && (lower < 0.0 || upper > 1.0) {
        return Err(place.error(format!(
            "`{name}` is binary, so its bounds must lie within [0, 1]; they are {lower} and {upper}"
        )));
    }
    Ok((lower, upper))
}

fn objective(file: &File<'_>, variables: &[Variable]) -> Quadratic {
    let constant = file.objective.constant.map_or(0.0, |(value, _)| value);
    let mut affine = Affine::constant(constant);
    for &(column, value) in &file.objective.terms {
        affine.add_term(value, variables[column]);
    }
    let mut objective = Quadratic::from(affine);
    for &(first, second, value) in &file.objective.products {
        objective.add_product(value, variables[first], variables[second]);
    }
    objective
}

/// The name of a row without a label: `c` and its position, and underscores if that is taken.
fn automatic_name(position: usize, taken: &HashSet<Name>) -> Name {
    let mut name = Name::from(format!("c{position}"));
    while taken.contains(&name) {
        name = name.suffixed("_");
    }
    name
}

/// The name of the row that two labels form, if they are the halves of one.
fn joined(first: Token<'_>, second: Token<'_>) -> Option<Name> {
    let text = first.text.strip_suffix(names::AT_LEAST)?;
    let other = second.text.strip_suffix(names::AT_MOST)?;
    (text == other && !text.is_empty()).then(|| names::read(text))
}

/// Whether two rows are the lower and the upper half of one.
fn are_halves(low: &StoredRow, high: &StoredRow) -> bool {
    let bits = |row: &StoredRow| -> Vec<_> {
        row.terms.iter().map(|&(variable, value)| (variable, value.to_bits())).collect()
    };
    low.upper.is_infinite()
        && high.lower.is_infinite()
        && low.lower.is_finite()
        && high.upper.is_finite()
        && low.lower <= high.upper
        && bits(low) == bits(high)
}
