//! From the entries of a file to a model.

use std::collections::HashSet;

use super::defined;
use super::names;
use super::read::{LpColumn, LpFile};
use super::rows::LpRow;
use crate::error::{Error, ErrorKind};
use crate::model::affine::{Affine, merge};
use crate::model::checks::finite;
use crate::model::ids::Variable;
use crate::model::name::Name;
use crate::model::quadratic::Quadratic;
use crate::model::reformulation::BigM;
use crate::model::store::Model;
use crate::model::stored::StoredRow;
use crate::model::text::ends;
use crate::model::text::quadratic_rows::add_quadratic_row;
use crate::model::text::read::{Read, Warning};
use crate::model::text::token::Token;
use crate::model::variable::VariableKind;
use crate::number::Exact;

/// Makes the model that a file describes.
pub(super) fn model(mut file: LpFile<'_>) -> Result<Read, Error> {
    file.take_constant();
    let mut model = Model::new(file.name);
    let mut warnings = std::mem::take(&mut file.warnings);
    let (variables, is_defined) = variables(&file, &mut model, &mut warnings)?;
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
                    let condition = |row: &LpRow<'_>| row.condition.map(|c| (c.column, c.on));
                    let is_linear = row.products.is_empty() && other.products.is_empty();
                    (is_linear && condition(other) == condition(row) && are_halves(&stored, half))
                        .then_some((name, half.upper))
                });
                match other {
                    Some((name, upper)) => {
                        rows.next();
                        stored.upper = upper;
                        name
                    }
                    None => {
                        let wanted = names::read(label.text);
                        let free = unused(&model, &wanted, &taken);
                        if free != wanted {
                            let message =
                                format!("a second row `{wanted}`; it is called `{free}` here");
                            warnings.push(label.warning(message));
                        }
                        free
                    }
                }
            }
        };
        if stored.lower.is_infinite() && stored.upper.is_infinite() {
            continue; // has no finite limit
        }
        let products = with_products(Quadratic::zero(), &row.products, &variables);
        if !products.products().is_empty() {
            add_quadratic(&mut model, row, name, (products, &stored), &variables)?;
            continue;
        }
        add(&mut model, row, name, stored, &variables)?;
    }
    for (set, position) in file.sets.iter().zip(1..) {
        set.add(&mut model, &variables, position, names::read, &mut warnings)?;
    }
    for (k, function) in file.functions.iter().enumerate().filter(|(k, _)| !is_defined[*k]) {
        defined::add(&mut model, function, k + 1, &variables)?;
    }
    model.set_objective(file.sense, objective(&file, &variables))?;
    Ok(Read { model, warnings, start: Vec::new() })
}

fn add(
    model: &mut Model,
    row: &LpRow<'_>,
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
            let literal = condition.literal(variables);
            let added = model.push_indicator(name, literal, stored, BigM::Automatic);
            added.map_err(|error| {
                let known = matches!(error.kind(), ErrorKind::DuplicateName { .. });
                at(if known { row.place } else { condition.place }, &error)
            })?;
        }
    }
    Ok(())
}

/// Adds a row with products.
fn add_quadratic(
    model: &mut Model,
    row: &LpRow<'_>,
    name: Name,
    (mut expression, stored): (Quadratic, &StoredRow),
    variables: &[Variable],
) -> Result<(), Error> {
    let StoredRow { terms, lower, upper } = stored;
    if lower.is_finite() && upper.is_finite() {
        return Err(row.place.error(
            "a row with products needs one limit, `<=` or `>=`; with two or as an equation it is not \
             convex",
        ));
    }
    for &(variable, coefficient) in terms {
        expression += coefficient * variable;
    }
    let expression = match upper.is_finite() {
        true => expression - *upper,
        false => *lower - expression,
    };
    let condition = row.condition.map(|condition| condition.literal(variables).into());
    add_quadratic_row(model, name, expression, condition).map_err(|error| at(row.place, &error))
}

pub(super) fn at(place: Token<'_>, error: &Error) -> Error {
    place.error(error.to_string())
}

/// The variables in the order of the columns, and which functions define one of them.
fn variables(
    file: &LpFile<'_>,
    model: &mut Model,
    warnings: &mut Vec<Warning>,
) -> Result<(Vec<Variable>, Vec<bool>), Error> {
    let mut switches = vec![None; file.columns.len()];
    for condition in file.rows.iter().filter_map(|row| row.condition) {
        switches[condition.column].get_or_insert(condition.place);
    }
    let is_plain = |column: &LpColumn<'_>, j: usize| {
        !column.binary && !column.integer && !column.semicontinuous && switches[j].is_none()
    };
    let definitions = match file.functions.is_empty() {
        true => Vec::new(),
        false => defined::definitions(file, is_plain),
    };
    let definition = |j: usize| definitions.get(j).copied().flatten();
    let mut variables = vec![None; file.columns.len()];
    for (j, column) in file.columns.iter().enumerate() {
        if definition(j).is_none() {
            variables[j] = Some(variable(column, switches[j], model, warnings)?);
        }
    }
    // Functions follow their arguments.
    let mut is_defined = vec![false; file.functions.len()];
    while variables.iter().any(Option::is_none) {
        for (k, function) in file.functions.iter().enumerate() {
            let j = function.result;
            let is_own = definition(j).is_some_and(|own| std::ptr::eq(own, function));
            let is_ready = defined::columns(function).all(|argument| variables[argument].is_some());
            if !is_own || variables[j].is_some() || !is_ready {
                continue;
            }
            let column = &file.columns[j];
            let name = names::read(column.name.text);
            let known = |argument: usize| variables[argument].unwrap_or_else(|| unreachable!());
            let own = defined::define(model, name, function, known)?;
            let (lower, upper) = bounds(column, false, warnings)?;
            model.set_bounds(own, lower, upper).map_err(|error| at(column.name, &error))?;
            (variables[j], is_defined[k]) = (Some(own), true);
        }
    }
    Ok((variables.into_iter().flatten().collect(), is_defined))
}

/// Adds a variable; it is the condition of an indicator if `switch` is its place there.
fn variable(
    column: &LpColumn<'_>,
    switch: Option<Token<'_>>,
    model: &mut Model,
    warnings: &mut Vec<Warning>,
) -> Result<Variable, Error> {
    let mut binary = column.binary;
    if let (Some(place), false) = (switch, binary || column.integer) {
        let name = column.name.text;
        let message = format!("`{name}` is a condition, so it is taken as a binary");
        warnings.push(place.warning(message));
        binary = true;
    }
    let name = names::read(column.name.text);
    if column.semicontinuous {
        let added = semicontinuous(column, binary, name, model, warnings);
        return added.map_err(|error| at(column.name, &error));
    }
    let (lower, upper) = bounds(column, binary, warnings)?;
    let added = match (column.integer, binary) {
        (_, true) => model.variable(name, VariableKind::Binary, lower, upper),
        // Only a binary can be the condition of an indicator.
        (true, _) if switch.is_some() && lower >= 0.0 && upper <= 1.0 => {
            model.variable(name, VariableKind::Binary, lower, upper)
        }
        (true, _) => model.integer(name, lower, upper),
        (false, false) => model.continuous(name, lower, upper),
    };
    added.map_err(|error| at(column.name, &error))
}

/// Adds a semi-continuous or semi-integer variable, or a binary that is listed as such.
fn semicontinuous(
    column: &LpColumn<'_>,
    binary: bool,
    name: Name,
    model: &mut Model,
    warnings: &mut Vec<Warning>,
) -> Result<Variable, Error> {
    let place = column.ends.last.unwrap_or(column.name);
    let (lower, upper) = column.ends.or(0.0, if binary { 1.0 } else { f64::INFINITY });
    let kind = match (column.integer, binary) {
        (_, true) => VariableKind::Binary,
        (true, false) => VariableKind::Integer,
        (false, false) => VariableKind::Continuous,
    };
    if lower > upper {
        warnings.push(place.warning(ends::only_zero(column.name.text, (lower, upper))));
        return model.variable(name, kind, 0.0, 0.0);
    }
    if binary {
        // 0 is among the values of a binary.
        warnings.push(place.warning(format!(
            "`{name}` is both semi-continuous and a binary, so it is 0, or 1 if its bounds allow it"
        )));
        let one = if lower <= 1.0 && upper >= 1.0 { 1.0 } else { 0.0 };
        return model.variable(name, kind, 0.0, one);
    }
    if lower < 0.0 {
        warnings.push(place.warning(ends::negative(column.name.text, (lower, upper))));
    }
    match column.integer {
        true => model.semiinteger(name, lower, upper),
        false => model.semicontinuous(name, lower, upper),
    }
}

/// The bounds of a column, defaults filled in.
fn bounds(
    column: &LpColumn<'_>,
    binary: bool,
    warnings: &mut Vec<Warning>,
) -> Result<(f64, f64), Error> {
    let default = if binary { 1.0 } else { f64::INFINITY };
    let (lower, upper) = column.ends.or(0.0, default);
    let (place, name) = (column.ends.last.unwrap_or(column.name), column.name.text);
    let cut = (
        if binary && lower < 0.0 { 0.0 } else { lower },
        if binary && upper > 1.0 { 1.0 } else { upper },
    );
    if lower > upper || cut.0 > cut.1 {
        let help = match column.ends.lower {
            None => " (where none is given, the lower bound is 0; write `-inf <=` for none)",
            Some(_) if lower <= upper => " (it is a binary)",
            Some(_) => "",
        };
        let message =
            format!("bounds of `{name}` are crossed: {} > {}{help}", Exact(cut.0), Exact(cut.1));
        return Err(place.error(message));
    }
    if cut != (lower, upper) {
        warnings.push(place.warning(format!(
            "`{name}` is binary, so its bounds {} and {} are cut to {} and {}",
            Exact(lower),
            Exact(upper),
            cut.0,
            cut.1
        )));
    }
    Ok(cut)
}

fn objective(file: &LpFile<'_>, variables: &[Variable]) -> Quadratic {
    let constant = file.objective.constant.map_or(0.0, |(value, _)| value);
    let mut affine = Affine::constant(constant);
    for &(column, value) in &file.objective.terms {
        affine.add_term(value, variables[column]);
    }
    with_products(affine.into(), &file.objective.products, variables)
}

fn with_products(
    mut sum: Quadratic,
    products: &[(usize, usize, f64)],
    variables: &[Variable],
) -> Quadratic {
    for &(first, second, value) in products {
        sum.add_product(value, variables[first], variables[second]);
    }
    sum
}

/// The name of a row without a label: `c` and its position, and underscores if that is taken.
fn automatic_name(position: usize, taken: &HashSet<Name>) -> Name {
    Name::from(format!("c{position}")).free(|name| taken.contains(name))
}

/// The name, with underscores if a row of the model has it.
fn unused(model: &Model, name: &Name, taken: &HashSet<Name>) -> Name {
    name.free(|free| model.has_statement(free) || free != name && taken.contains(free))
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
