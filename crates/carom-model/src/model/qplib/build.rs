//! From the parts of a file to a model.

use super::read::{Product, QplibFile, QplibRow};
use crate::error::Error;
use crate::model::affine::Affine;
use crate::model::ids::Variable;
use crate::model::name::Name;
use crate::model::quadratic::Quadratic;
use crate::model::store::Model;
use crate::model::stored::StoredRow;
use crate::model::text::quadratic_rows::add_quadratic_row;
use crate::model::text::read::Read;
use crate::model::variable::VariableKind;

/// Makes the model that a file describes.
pub(super) fn model(file: QplibFile<'_>) -> Result<Read, Error> {
    let mut model = Model::new(file.name);
    let mut variables = Vec::with_capacity(file.variables.len());
    for (column, k) in file.variables.iter().zip(1..) {
        let kind = match column.is_integer {
            false => VariableKind::Continuous,
            true if column.lower >= 0.0 && column.upper <= 1.0 => VariableKind::Binary,
            true => VariableKind::Integer,
        };
        let name = column.name.map_or_else(|| ("x", k).into(), Name::from);
        variables.push(model.variable(name, kind, column.lower, column.upper)?);
    }
    for (row, k) in file.rows.iter().zip(1..) {
        if row.lower.is_infinite() && row.upper.is_infinite() {
            continue; // It limits nothing.
        }
        let name = row.name.map_or_else(|| ("c", k).into(), Name::from);
        match row.products.first() {
            Some(first) => add_quadratic(&mut model, row, name, first, &variables)?,
            None => {
                let terms = row.terms.iter().map(|&(column, value)| (variables[column], value));
                let (lower, upper) = (row.lower, row.upper);
                model.push_constraint(name, StoredRow { terms: terms.collect(), lower, upper })?;
            }
        }
    }
    let mut linear = Affine::constant(file.constant);
    let terms = file.linear.iter().zip(&variables).filter(|(factor, _)| **factor != 0.0);
    terms.for_each(|(factor, variable)| linear.add_term(*factor, *variable));
    let objective = form(&file.objective, linear, &variables);
    model.set_objective(file.sense, objective)?;
    Ok(Read { model, warnings: Vec::new(), start: Vec::new() })
}

/// `1/2 x'Hx + a'x`.
fn form(products: &[Product<'_>], linear: Affine, variables: &[Variable]) -> Quadratic {
    let mut sum = Quadratic::from(linear);
    for &Product { pair: (i, j), factor, .. } in products {
        sum.add_product(factor, variables[i], variables[j]);
    }
    sum
}

fn add_quadratic(
    model: &mut Model,
    row: &QplibRow<'_>,
    name: Name,
    first: &Product<'_>,
    variables: &[Variable],
) -> Result<(), Error> {
    if row.lower.is_finite() && row.upper.is_finite() {
        return Err(first.place.error(format!(
            "constraint `{name}` has products, so it needs one limit; with two it is not convex"
        )));
    }
    let mut linear = Affine::zero();
    row.terms.iter().for_each(|&(column, value)| linear.add_term(value, variables[column]));
    let left = form(&row.products, linear, variables);
    let expression = match row.upper.is_finite() {
        true => left - row.upper,
        false => row.lower - left,
    };
    add_quadratic_row(model, name, expression, None)
        .map_err(|error| first.place.error(error.to_string()))
}
