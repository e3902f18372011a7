//! The cones of a model as cones over columns of its program.

use super::assemble::Entries;
use super::cone::{Cone, ConeRole, ConeShape, LONGEST_TAIL};
use crate::error::Error;
use crate::model::{Affine, Model};

/// Adds the cones of a model to the entries of its program. Expressions that are not single variables,
/// each once in a cone, become columns with a row.
pub(super) fn assemble_cones(model: &Model, entries: &mut Entries) -> Result<Vec<Cone>, Error> {
    let mut cones = Vec::new();
    for conic in model.conic_constraints() {
        let standard = model.standard_cone(conic.conic(), conic.name())?;
        let shape = if standard.head.len() == 1 { ConeShape::Norm } else { ConeShape::Rotated };
        let mut columns: Vec<usize> = Vec::with_capacity(standard.head.len() + standard.tail.len());
        let heads = standard.head.len();
        for (k, expression) in standard.head.iter().chain(&standard.tail).enumerate() {
            let column = column(expression, k < heads, &columns, entries);
            columns.push(column);
        }
        add(shape, columns, entries, &mut cones);
    }
    Ok(cones)
}

/// The column of an expression: that of the variable that it is, or a further one.
fn column(expression: &Affine, is_head: bool, taken: &[usize], entries: &mut Entries) -> usize {
    let terms = expression.terms();
    let least = if is_head { 0.0 } else { f64::NEG_INFINITY };
    match terms[..] {
        [] => {
            let value = expression.offset();
            entries.column(value, value)
        }
        [(v, 1.0)] if expression.offset() == 0.0 && !taken.contains(&v.index()) => {
            let j = v.index();
            entries.lower[j] = entries.lower[j].max(least);
            j
        }
        _ => {
            let j = entries.column(least, f64::INFINITY);
            let terms = terms.iter().map(|&(v, a)| (v.index(), a));
            let limit = -expression.offset();
            entries.row(terms.chain([(j, -1.0)]), limit, limit);
            j
        }
    }
}

/// Adds a cone, and its parts if its tail is long: `tail[i]^2 <= part[i] head`, `sum part <= head`.
fn add(shape: ConeShape, columns: Vec<usize>, entries: &mut Entries, cones: &mut Vec<Cone>) {
    let heads = shape.head();
    if columns.len() - heads <= LONGEST_TAIL {
        cones.push(Cone { shape, columns, role: ConeRole::Single });
        return;
    }
    // A rotated cone splits by one column of its head.
    let (sum, times) = match shape {
        ConeShape::Norm => (columns[0], columns[0]),
        ConeShape::Rotated => (columns[0], columns[1]),
    };
    let tail = columns[heads..].to_vec();
    let parts: Vec<usize> = tail.iter().map(|_| entries.column(0.0, f64::INFINITY)).collect();
    entries.row(parts.iter().map(|&part| (part, 1.0)).chain([(sum, -1.0)]), f64::NEG_INFINITY, 0.0);
    cones.push(Cone { shape, columns, role: ConeRole::Whole });
    cones.extend(parts.iter().zip(tail).map(|(&part, entry)| Cone {
        shape: ConeShape::Rotated,
        columns: vec![part, times, entry],
        role: ConeRole::Part,
    }));
}
