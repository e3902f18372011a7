//! From the entries of a file to a model.

use super::cone_kind::ConeKind;
use super::cones::{CbfCone, Cones};
use super::read::{CbfBlocks, CbfFile};
use super::rows::{self, CbfEntry, CbfRow, VARIABLE, check_each};
use crate::error::Error;
use crate::model::affine::Affine;
use crate::model::ids::Variable;
use crate::model::sense::Sense;
use crate::model::store::Model;
use crate::model::stored::StoredRow;
use crate::model::text::read::{Read, Warning};
use crate::model::text::token::UNMENTIONED;
use crate::model::variable::VariableKind;

/// The bounds of the variables, and which of them are integers.
struct CbfColumns {
    bounds: Vec<(f64, f64)>,
    integer: Vec<bool>,
}

/// Makes the model that a file describes. `length` is that of its text.
pub(super) fn model(mut file: CbfFile<'_>, length: usize) -> Result<Read, Error> {
    let mut warnings = std::mem::take(&mut file.warnings);
    check_count(file.variables.as_ref(), "variables", length)?;
    check_count(file.rows.as_ref(), "rows", length)?;
    let rows = rows::rows(&file)?;
    let mut columns = columns(&file)?;
    let linear = take_bounds(&file, &rows, &mut columns);
    let cones = cones(&file, &rows);
    cones.iter().for_each(|cone| take_heads(cone, &mut columns));
    let mut model = Model::new("");
    let variables = variables(&columns, &mut model)?;
    add_rows(&mut model, &rows, &linear, &variables)?;
    let mut conic = Cones { model: &mut model, variables: &variables };
    cones.iter().try_for_each(|cone| conic.add(cone))?;
    let objective = objective(&file, &variables)?;
    model.set_objective(sense(&file, &mut warnings), objective)?;
    Ok(Read { model, warnings, start: Vec::new() })
}

/// Refuses numbers of variables or rows that nobody means.
fn check_count(blocks: Option<&CbfBlocks<'_>>, what: &str, length: usize) -> Result<(), Error> {
    match blocks {
        Some(blocks) if blocks.count > length.max(UNMENTIONED) => Err(blocks.place.error(format!(
            "{} {what} are more than a file of this length can be about; correct the number",
            blocks.count
        ))),
        _ => Ok(()),
    }
}

/// The bounds that the blocks of VAR are.
fn columns(file: &CbfFile<'_>) -> Result<CbfColumns, Error> {
    let count = rows::count(file.variables.as_ref());
    check_each(&file.integers, file.variables.as_ref(), VARIABLE)?;
    let mut columns =
        CbfColumns { bounds: vec![ConeKind::Free.limits(); count], integer: vec![false; count] };
    for (first, block) in rows::blocks(file.variables.as_ref()) {
        let bounded = block.kind.heads().unwrap_or(block.size);
        columns.bounds[first..first + bounded].fill(block.kind.limits());
    }
    file.integers.iter().for_each(|integer| columns.integer[integer.index] = true);
    Ok(columns)
}

/// Takes the rows that are bounds as such, and returns the other linear ones with their kind. A
/// bound that contradicts those before it stays a row.
fn take_bounds(
    file: &CbfFile<'_>,
    rows: &[CbfRow],
    columns: &mut CbfColumns,
) -> Vec<(usize, ConeKind)> {
    let mut linear = Vec::new();
    for (first, block) in rows::blocks(file.rows.as_ref()) {
        if block.kind == ConeKind::Free || block.kind.heads().is_some() {
            continue;
        }
        for (at, row) in rows.iter().enumerate().skip(first).take(block.size) {
            let bounds = row.root().and_then(|(variable, factor, root)| {
                let (mut lower, mut upper) = columns.bounds[variable];
                let (at_least, at_most) = match (block.kind, factor > 0.0) {
                    (ConeKind::Zero, _) => (true, true),
                    (ConeKind::AtLeast, up) => (up, !up),
                    (_, up) => (!up, up),
                };
                if at_least {
                    lower = lower.max(root);
                }
                if at_most {
                    upper = upper.min(root);
                }
                (lower <= upper).then_some((variable, (lower, upper)))
            });
            match bounds {
                Some((variable, bounds)) => columns.bounds[variable] = bounds,
                None => linear.push((at, block.kind)),
            }
        }
    }
    linear
}

/// The cones of VAR, then those of CON.
fn cones<'f>(file: &CbfFile<'f>, rows: &'f [CbfRow]) -> Vec<CbfCone<'f>> {
    let mut cones: Vec<CbfCone<'f>> = Vec::new();
    for (first, block) in rows::blocks(file.variables.as_ref()) {
        if block.kind.heads().is_some() {
            let entries =
                (first..first + block.size).map(|x| (x, CbfEntry::Scaled(x, 1.0))).collect();
            cones.push(CbfCone {
                kind: block.kind,
                entries,
                place: block.place,
                position: cones.len(),
            });
        }
    }
    for (first, block) in rows::blocks(file.rows.as_ref()) {
        if block.kind.heads().is_some() {
            let entries = rows.iter().enumerate().skip(first).take(block.size);
            let entries = entries.map(|(at, row)| (at, row.entry())).collect();
            cones.push(CbfCone {
                kind: block.kind,
                entries,
                place: block.place,
                position: cones.len(),
            });
        }
    }
    cones
}

/// Raises the lower bounds of variables that are heads to 0, unless that contradicts their upper
/// ones.
fn take_heads(cone: &CbfCone<'_>, columns: &mut CbfColumns) {
    for (_, entry) in cone.heads() {
        if let CbfEntry::Scaled(variable, factor) = *entry
            && factor > 0.0
            && let (lower, upper) = &mut columns.bounds[variable]
            && *upper >= 0.0
        {
            *lower = lower.max(0.0);
        }
    }
}

fn variables(columns: &CbfColumns, model: &mut Model) -> Result<Vec<Variable>, Error> {
    let columns = columns.bounds.iter().zip(&columns.integer).enumerate();
    let added = columns.map(|(position, (&(lower, upper), integer))| {
        let kind = match integer {
            false => VariableKind::Continuous,
            true if lower >= 0.0 && upper <= 1.0 => VariableKind::Binary,
            true => VariableKind::Integer,
        };
        model.variable(("x", position), kind, lower, upper)
    });
    added.collect()
}

/// Adds linear rows. Two consecutive ones that are the halves of one become one.
fn add_rows(
    model: &mut Model,
    rows: &[CbfRow],
    linear: &[(usize, ConeKind)],
    variables: &[Variable],
) -> Result<(), Error> {
    let mut linear = linear.iter().peekable();
    while let Some(&(at, kind)) = linear.next() {
        let mut stored = stored(&rows[at], kind, variables);
        let half = linear.next_if(|&&(next, other)| {
            (kind, other) == (ConeKind::AtLeast, ConeKind::AtMost)
                && next == at + 1
                && !rows[at].terms.is_empty()
                && rows[next].terms == rows[at].terms
                && -rows[next].offset >= stored.lower
        });
        if let Some(&(next, _)) = half {
            stored.upper = 0.0 - rows[next].offset;
        }
        model.push_constraint(("c", at).into(), stored)?;
    }
    Ok(())
}

/// A row of a linear cone.
pub(super) fn stored(row: &CbfRow, kind: ConeKind, variables: &[Variable]) -> StoredRow {
    let terms = row.terms.iter().map(|&(variable, value)| (variables[variable], value)).collect();
    let (lower, upper) = kind.limits();
    // Not -0.
    StoredRow { terms, lower: lower - row.offset, upper: upper - row.offset }
}

fn objective(file: &CbfFile<'_>, variables: &[Variable]) -> Result<Affine, Error> {
    let indices: Vec<_> = file.objective.iter().map(|(variable, _)| *variable).collect();
    check_each(&indices, file.variables.as_ref(), VARIABLE)?;
    let mut objective = Affine::constant(file.constant);
    file.objective.iter().for_each(|(at, value)| objective.add_term(*value, variables[at.index]));
    Ok(objective)
}

fn sense(file: &CbfFile<'_>, warnings: &mut Vec<Warning>) -> Sense {
    file.sense.unwrap_or_else(|| {
        let message = "there is no OBJSENSE, so the objective is minimised";
        warnings.push(Warning { line: 1, column: 1, message: message.into() });
        Sense::Minimize
    })
}
