//! Special ordered sets as rows.
//!
//! Takes a special ordered set (Beale and Tomlin, Special facilities in a general mathematical
//! programming system for non-convex problems using ordered sets of variables, Proceedings of the
//! Fifth International Conference on Operational Research, 1970); leaves rows and binaries.
//!
//! *First kind*: a binary `z` per member with `l z <= x <= u z`, and `z1 + ... + zn <= 1`. A member
//! that is a binary is its own `z`, and a variable has one `z` for all sets and for being
//! semi-continuous. *Second kind*: a binary per pair of neighbours, one of which is chosen,
//! `y1 + ... + y(n-1) = 1`, and `l (y(k-1) + yk) <= xk <= u (y(k-1) + yk)`. Every coefficient is a
//! bound of a member, so members need finite ones.

use super::big_m::{Implied, apply_unless};
use super::disjunction::value;
use super::lowering::Lowering;
use crate::error::Error;
use crate::interval::Interval;
use crate::model::{Affine, BigM, Literal, SpecialOrderedSetRef, Variable, VariableKind};

/// Adds the rows of one set.
pub(super) fn apply(
    set: &SpecialOrderedSetRef<'_>,
    lowering: &mut Lowering<'_>,
) -> Result<(), Error> {
    lowering.begin(set.name());
    for &(member, _) in set.members() {
        lowering.finite_bounds(member)?;
    }
    match set.most() {
        1 => first_kind(set, lowering),
        _ => second_kind(set, lowering),
    }
}

fn first_kind(set: &SpecialOrderedSetRef<'_>, lowering: &mut Lowering<'_>) -> Result<(), Error> {
    let mut open = Vec::with_capacity(set.members().len());
    for &(member, _) in set.members() {
        if lowering.model.variable_ref(member)?.bounds() != Interval::point(0.0) {
            open.push(member);
        }
    }
    if open.len() < 2 {
        return Ok(());
    }
    let mut sum = Affine::zero();
    for member in open {
        sum += value(lowering.nonzero(member)?);
    }
    lowering.begin(set.name());
    lowering.affine_row(sum, f64::NEG_INFINITY, 1.0)
}

fn second_kind(set: &SpecialOrderedSetRef<'_>, lowering: &mut Lowering<'_>) -> Result<(), Error> {
    let members: Vec<Variable> = set.members().iter().map(|&(member, _)| member).collect();
    if members.len() < 3 {
        return Ok(());
    }
    let mut pairs: Vec<Literal> = Vec::with_capacity(members.len() - 1);
    for _ in 1..members.len() {
        pairs.push(lowering.column("pair", VariableKind::Binary, 0.0, 1.0)?.on());
    }
    lowering.affine_row(pairs.iter().map(|&pair| value(pair)).sum(), 1.0, 1.0)?;
    for (k, &member) in members.iter().enumerate() {
        let name = set.name().suffixed(&format!("_{}", k + 1));
        lowering.begin(&name);
        let near = &pairs[k.saturating_sub(1)..pairs.len().min(k + 1)];
        let (terms, limits) = (&[(member, 1.0)], Interval::point(0.0));
        let row = Implied { name: &name, terms, limits, big_m: BigM::Automatic };
        apply_unless(near, &row, lowering)?;
    }
    Ok(())
}
