//! From the entries of a file to a model.

use super::decimal::Decimal;
use super::names;
use super::read::{MpsColumn, MpsFile, MpsRow, MpsRowKind};
use crate::error::Error;
use crate::model::affine::Affine;
use crate::model::ids::Variable;
use crate::model::quadratic::Quadratic;
use crate::model::reformulation::BigM;
use crate::model::sense::Sense;
use crate::model::store::Model;
use crate::model::stored::StoredRow;
use crate::model::text::ends;
use crate::model::text::quadratic_rows::add_quadratic_row;
use crate::model::text::read::{Read, Warning};
use crate::model::text::token::{self, Token};
use crate::model::variable::VariableKind;

/// Makes the model that a file describes.
pub(super) fn model(mut file: MpsFile<'_>) -> Result<Read, Error> {
    let mut model = Model::new(file.name);
    let mut warnings = std::mem::take(&mut file.warnings);
    let variables = variables(&file, &mut model, &mut warnings)?;
    for row in &file.rows {
        if matches!(row.kind, MpsRowKind::Objective | MpsRowKind::Ignored) {
            continue;
        }
        let (lower, upper) = limits(row)?;
        if lower.is_infinite() && upper.is_infinite() {
            continue; // has no finite limit, like an N row
        }
        let name = names::read(row.name.text);
        if let Some(matrix) = &row.matrix {
            let mut expression = Quadratic::zero();
            file.add_products(matrix, &variables, &mut expression, &mut warnings)?;
            if !expression.products().is_empty() {
                add_quadratic(
                    &mut model,
                    row,
                    matrix.place,
                    (expression, lower, upper),
                    &variables,
                )?;
                continue;
            }
        }
        let terms = row.terms.iter().map(|&(column, value)| (variables[column], value)).collect();
        let stored = StoredRow { terms, lower, upper };
        match &row.condition {
            None => {
                model.push_constraint(name, stored)?;
            }
            Some(condition) => {
                let literal = condition.literal(&variables);
                model
                    .push_indicator(name, literal, stored, BigM::Automatic)
                    .map_err(|error| condition.place.error(error.to_string()))?;
            }
        }
    }
    for (set, position) in file.sets.iter().zip(1..) {
        set.add(&mut model, &variables, position, names::read, &mut warnings)?;
    }
    let objective = objective(&file, &variables, &mut warnings)?;
    model.set_objective(file.sense.unwrap_or(Sense::Minimize), objective)?;
    Ok(Read { model, warnings, start: Vec::new() })
}

/// Adds a row with products.
fn add_quadratic(
    model: &mut Model,
    row: &MpsRow<'_>,
    place: Token<'_>,
    (mut expression, lower, upper): (Quadratic, f64, f64),
    variables: &[Variable],
) -> Result<(), Error> {
    let name = row.name.text;
    if lower.is_finite() && upper.is_finite() {
        return Err(place.error(format!(
            "row `{name}` has products, so it needs one limit (a row of kind L or G without a range); \
             with two it is not convex"
        )));
    }
    row.terms.iter().for_each(|&(column, value)| expression += value * variables[column]);
    let expression = match upper.is_finite() {
        true => expression - upper,
        false => lower - expression,
    };
    let condition = row.condition.map(|condition| condition.literal(variables).into());
    add_quadratic_row(model, names::read(name), expression, condition)
        .map_err(|error| place.error(error.to_string()))
}

fn variables(
    file: &MpsFile<'_>,
    model: &mut Model,
    warnings: &mut Vec<Warning>,
) -> Result<Vec<Variable>, Error> {
    let mut switches = vec![false; file.columns.len()];
    for condition in file.rows.iter().filter_map(|row| row.condition) {
        switches[condition.column] = true;
    }
    let mut variables = Vec::with_capacity(file.columns.len());
    for (column, switch) in file.columns.iter().zip(switches) {
        let said = column.bounds.kind;
        let integer = column.integer || said.is_some();
        if column.bounds.semicontinuous {
            variables.push(semicontinuous(column, integer, model, warnings)?);
            continue;
        }
        let (lower, upper) = column.bounds.resolve(integer, warnings)?;
        let within = lower >= 0.0 && upper <= 1.0;
        let kind = match said {
            _ if !integer => VariableKind::Continuous,
            // LI and UI mean an integer, unless a binary is needed.
            Some(VariableKind::Integer) if !(switch && within) => VariableKind::Integer,
            _ if within => VariableKind::Binary,
            _ => VariableKind::Integer,
        };
        variables.push(model.variable(names::read(column.name.text), kind, lower, upper)?);
    }
    Ok(variables)
}

/// Adds a semi-continuous or semi-integer column.
fn semicontinuous(
    column: &MpsColumn<'_>,
    integer: bool,
    model: &mut Model,
    warnings: &mut Vec<Warning>,
) -> Result<Variable, Error> {
    let (place, name) = (column.name, column.name.text);
    if let Some((place, crossed)) = column.bounds.crossed() {
        warnings.push(place.warning(ends::only_zero(name, crossed)));
        let kind = if integer { VariableKind::Integer } else { VariableKind::Continuous };
        return model.variable(names::read(name), kind, 0.0, 0.0);
    }
    let (lower, upper) = column.bounds.resolve(integer, warnings)?;
    if lower < 0.0 {
        warnings.push(place.warning(ends::negative(name, (lower, upper))));
    }
    match integer {
        true => model.semiinteger(names::read(name), lower, upper),
        false => model.semicontinuous(names::read(name), lower, upper),
    }
}

/// The limits of a row from its kind, right-hand side and range.
fn limits(row: &MpsRow<'_>) -> Result<(f64, f64), Error> {
    let (lowest, highest) = (f64::NEG_INFINITY, f64::INFINITY);
    let right = row.right.map_or(Ok(0.0), |token| token.number())?;
    let Some(range) = row.range else {
        let impossible = match row.kind {
            MpsRowKind::AtMost => right == lowest,
            MpsRowKind::AtLeast => right == highest,
            _ => right.is_infinite(),
        };
        if let (true, Some(token)) = (impossible, row.right) {
            return Err(token.error(format!("no point can satisfy row `{}`", row.name.text)));
        }
        return Ok(match row.kind {
            MpsRowKind::AtMost => (lowest, right),
            MpsRowKind::AtLeast => (right, highest),
            _ => (right, right),
        });
    };
    if let (true, Some(token)) = (right.is_infinite(), row.right) {
        return Err(token.error(format!(
            "row `{}` has a range, so its right-hand side must be finite",
            row.name.text
        )));
    }
    let downward = match row.kind {
        MpsRowKind::AtMost => true,
        MpsRowKind::AtLeast => false,
        _ => range.raw()? < 0.0,
    };
    let other = other_limit(right, row.right, &range, downward)?;
    Ok(if downward { (other, right) } else { (right, other) })
}

/// `right - |range|` or `right + |range|`, formed on the decimals of the file and rounded once.
fn other_limit(
    right: f64,
    right_text: Option<Token<'_>>,
    range: &Token<'_>,
    downward: bool,
) -> Result<f64, Error> {
    // Two limits below 1e20 may be further apart than that, so the range is not made infinite.
    let width = range.raw()?.abs();
    let rounded = if downward { right - width } else { right + width };
    let exact = || {
        let right = Decimal::parse(right_text.map_or("0", |token| token.text))?;
        let width = Decimal::parse(range.text)?.magnitude();
        Some(right.plus(&if downward { width.negated() } else { width })?.to_f64())
    };
    let other = if width.is_finite() { exact().unwrap_or(rounded) } else { rounded };
    Ok(token::or_infinite(other))
}

fn objective(
    file: &MpsFile<'_>,
    variables: &[Variable],
    warnings: &mut Vec<Warning>,
) -> Result<Quadratic, Error> {
    let mut objective = Quadratic::zero();
    if let Some(index) = file.objective {
        let row = &file.rows[index];
        if let Some(range) = row.range {
            warnings.push(range.warning("the range of the objective row is ignored"));
        }
        let mut affine = Affine::zero();
        if let Some(right) = row.right {
            affine = Affine::constant(-right.finite()?);
        }
        row.terms.iter().for_each(|&(column, value)| affine.add_term(value, variables[column]));
        objective = Quadratic::from(affine);
    }
    if let Some(matrix) = &file.matrix {
        file.add_products(matrix, variables, &mut objective, warnings)?;
    }
    Ok(objective)
}
