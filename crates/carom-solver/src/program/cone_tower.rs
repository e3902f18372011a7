//! Long norms as towers of short ones.
//!
//! Takes `|tail| <= head`; leaves a balanced binary tree of norms of two entries: each further
//! column is at least the norm of two entries of the level below, and the head that of the last two
//! (Ben-Tal and Nemirovski, On polyhedral approximations of the second-order cone, Mathematics of
//! Operations Research 26, 2001; Vielma, Dunning, Huchette and Lubin, Extended formulations in
//! mixed integer conic quadratic programming, Mathematical Programming Computation 9, 2017). If
//! each further column is the norm of its two entries, all of these cones are met wherever the
//! whole is met, and together they imply the whole. A cut of a short norm bounds many directions
//! of the whole.
//!
//! Where the head is a constant, parts by single entries say as much with fewer pivots, and a
//! binary may switch each of them off. Where all cones are long and few, relaxations take them as
//! they are. So towers are for heads that are open, in programs with other cones.

use super::assemble::Entries;
use super::cone::{Cone, ConeRole, ConeShape, LONGEST_TAIL};
use crate::model::Affine;

/// Fewest entries of the tail of a long norm.
pub(crate) const LONG_TAIL: usize = 8;

/// Most cones of a program whose long norms stay whole: relaxations solve such programs as a
/// sequence of quadratic ones, if all of their cones are long.
pub(crate) const FEW_LONG_CONES: usize = 4;

/// Whether a cone of a program with integers becomes a tower.
///
/// # Arguments
///
/// * `tail`: the expressions of its tail. Multiples of integers stay together for the cuts of norms
///   of binaries.
pub(super) fn suits_tower(
    shape: ConeShape,
    columns: &[usize],
    tail: &[Affine],
    entries: &Entries,
) -> bool {
    let head = columns[0];
    let is_of_integer = |e: &Affine| match e.terms()[..] {
        [(v, _)] => entries.is_integral(v.index()),
        _ => false,
    };
    shape == ConeShape::Norm
        && tail.len() >= LONG_TAIL
        && entries.has_integers()
        && entries.bounds(head)[0] < entries.bounds(head)[1]
        && !tail.iter().any(is_of_integer)
}

/// Adds a norm as a tower, with columns for the heads of its inner norms.
pub(super) fn add_tower(columns: &[usize], entries: &mut Entries, cones: &mut Vec<Cone>) {
    let (shape, role) = (ConeShape::Norm, ConeRole::Single);
    let mut level = columns[1..].to_vec();
    while level.len() > LONGEST_TAIL {
        let mut next = Vec::with_capacity(level.len().div_ceil(LONGEST_TAIL));
        for entries_of in level.chunks(LONGEST_TAIL) {
            let &[one, other] = entries_of else {
                next.extend_from_slice(entries_of);
                continue;
            };
            let head = entries.column(0.0, f64::INFINITY);
            cones.push(Cone { shape, columns: vec![head, one, other], role });
            next.push(head);
        }
        level = next;
    }
    level.insert(0, columns[0]);
    cones.push(Cone { shape, columns: level, role });
}
