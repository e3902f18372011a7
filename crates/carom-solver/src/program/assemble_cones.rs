//! The cones of a model as cones over columns of its program.

use super::assemble::Entries;
use super::cone::{Cone, ConeRole, ConeShape, LONGEST_TAIL};
use super::cone_tower::{FEW_LONG_CONES, LONG_TAIL, add_tower, suits_tower};
use crate::error::Error;
use crate::model::{Affine, ConicRef, Model};

/// The factors of a rotated cone may differ by this factor, squared; as a power of two.
const MOST_UNBALANCED: f64 = 3.0;

/// The form of long norms.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum LongNorms {
    /// Wholes with their parts, which a reader of a proof finds again.
    Parts,
    /// Towers where these suit, or else parts.
    Towers,
}

/// Adds the cones of a model to the entries of its program. Expressions that are not single
/// variables, each once in a cone, become columns with a row.
pub(super) fn assemble_cones(
    model: &Model,
    norms: LongNorms,
    entries: &mut Entries,
) -> Result<Vec<Cone>, Error> {
    let mut cones = Vec::new();
    let standard = |conic: ConicRef<'_>| model.standard_cone(conic.conic(), conic.name());
    let all: Vec<_> = model.conic_constraints().map(standard).collect::<Result<_, _>>()?;
    let are_few = all.len() <= FEW_LONG_CONES && all.iter().all(|c| c.tail.len() >= LONG_TAIL);
    for standard in all {
        let shape = if standard.head.len() == 1 { ConeShape::Norm } else { ConeShape::Rotated };
        let mut columns: Vec<usize> = Vec::with_capacity(standard.head.len() + standard.tail.len());
        let heads = standard.head.len();
        let head = balanced(standard.head, entries);
        for (k, expression) in head.iter().chain(&standard.tail).enumerate() {
            let column = column(expression, k < heads, &columns, entries);
            columns.push(column);
        }
        let may_be_tower = norms == LongNorms::Towers && !are_few;
        match may_be_tower && suits_tower(shape, &columns, &standard.tail, entries) {
            true => add_tower(&columns, entries, &mut cones),
            false => add(shape, columns, entries, &mut cones),
        }
    }
    Ok(cones)
}

/// The factors of a rotated cone with the same product, about equally large if one of them is far
/// larger: methods measure what they miss by the sum of both. Powers of two do not round.
fn balanced(mut head: Vec<Affine>, entries: &Entries) -> Vec<Affine> {
    let is_column = |e: &Affine| e.offset() == 0.0 && matches!(e.terms()[..], [(_, 1.0)]);
    if let [first, second] = &mut head[..]
        && !is_column(first)
        && !is_column(second)
    {
        let power = 0.5 * (size(first, entries) / size(second, entries)).log2();
        if power.abs() > MOST_UNBALANCED && power.is_finite() {
            let factor = power.round().exp2();
            first.scale(1.0 / factor);
            second.scale(factor);
        }
    }
    head
}

/// The largest number of an expression, with columns between narrow bounds for no more than these.
fn size(expression: &Affine, entries: &Entries) -> f64 {
    let terms = expression.terms().into_iter().map(|(v, a)| {
        let [lower, upper] = entries.bounds(v.index());
        a.abs() * lower.abs().max(upper.abs()).min(1.0)
    });
    terms.fold(expression.offset().abs(), f64::max)
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
            let terms: Vec<_> = terms.iter().map(|&(v, a)| (v.index(), a)).collect();
            entries.expression(&terms, expression.offset(), least)
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
