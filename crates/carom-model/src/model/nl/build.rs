//! From the parts of a file to a model.

use std::collections::BTreeMap;

use super::cursor::Cursor;
use super::read::{NlFile, NlMember};
use crate::error::Error;
use crate::model::ids::Variable;
use crate::model::store::Model;
use crate::model::stored::StoredRow;
use crate::model::text::read::Read;
use crate::model::variable::VariableKind;

/// Makes the model that a file describes.
pub(super) fn model(file: NlFile, cursor: &Cursor<'_>) -> Result<Read, Error> {
    let mut model = Model::empty(file.header.name.clone(), file.tag);
    let mut variables = Vec::with_capacity(file.header.columns);
    for (k, bounds) in file.bounds.iter().enumerate() {
        let is_integer = file.header.integers.iter().any(|range| range.contains(&k));
        let kind = match is_integer {
            false => VariableKind::Continuous,
            true if bounds.lower >= 0.0 && bounds.upper <= 1.0 => VariableKind::Binary,
            true => VariableKind::Integer,
        };
        variables.push(model.variable(("x", k), kind, bounds.lower, bounds.upper)?);
    }
    for (k, row) in file.rows.into_iter().enumerate() {
        let Some(limits) = row.limits else { continue };
        let row = row.into_polynomial();
        if limits.lower.is_infinite() && limits.upper.is_infinite() {
            continue; // It limits nothing.
        }
        if let Some(value) = row.as_constant() {
            // It holds or not, which a solve tells.
            let (lower, upper) = (limits.lower - value, limits.upper - value);
            model
                .push_constraint(("c", k).into(), StoredRow { terms: Vec::new(), lower, upper })?;
            continue;
        }
        let (name, left) = (("c", k), row.quadratic(file.tag));
        if row.functions.is_zero() && row.products.is_empty() {
            model.add(name, left.affine().within(limits.lower, limits.upper))?;
        } else if !row.functions.is_zero()
            || model.add(name, left.within(limits.lower, limits.upper)).is_err()
        {
            // Squares and products that are no cone are functions, too.
            let left = row.into_nonlinear(file.tag);
            model.add(name, left.within(limits.lower, limits.upper))?;
        }
    }
    sets(&mut model, &file.sets, &variables, cursor)?;
    let objective = file.objective.into_polynomial().into_nonlinear(file.tag);
    model.set_objective(file.sense, objective)?;
    let start = file.start.into_iter().map(|(column, value)| (variables[column], value));
    Ok(Read { model, warnings: file.warnings, start: start.collect() })
}

/// Adds the ordered sets, of which a positive number is of the first kind and a negative one of the
/// second.
fn sets(
    model: &mut Model,
    members: &[NlMember],
    variables: &[Variable],
    cursor: &Cursor<'_>,
) -> Result<(), Error> {
    let mut sets: BTreeMap<(u64, bool), Vec<(Variable, f64)>> = BTreeMap::new();
    for (member, variable) in members.iter().zip(variables).filter(|(member, _)| member.set != 0) {
        let weight = member.weight.ok_or_else(|| {
            let text = format!(
                "`{}` is in the ordered set {} and has no weight (suffix `ref`)",
                model.name_of(*variable),
                member.set
            );
            cursor.error(member.place, text)
        })?;
        let set = sets.entry((member.set.unsigned_abs(), member.set < 0)).or_default();
        set.push((*variable, weight));
    }
    for (k, ((_, is_second), members)) in sets.into_iter().enumerate() {
        model.add_set(("s", k).into(), if is_second { 2 } else { 1 }, members)?;
    }
    Ok(())
}
