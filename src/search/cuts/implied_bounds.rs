//! Implied bounds: the effect of a binary's value on the bounds of other columns.
//!
//! If `z = 0` implies `x <= u0` and `z = 1` implies `x <= u1`, every integral point satisfies
//! `x <= u0 + (u1 - u0) z`. The bounds come from propagating both values, so a chain of rows, such
//! as a step of the dynamics with its big-Ms, becomes one row.

use std::collections::BTreeMap;

use super::cut::Cut;
use crate::presolve::{Domain, Propagator};
use crate::program::Program;

/// Most binaries that are propagated, the most fractional first.
const BINARIES: usize = 200;

/// Distance of a value from a whole one up to which it counts as whole (no unit).
const WHOLE: f64 = 1e-3;

/// The cuts of the open binaries that are fractional at a point, violated there. `propagator` and
/// `domain` are those of the root, propagated; both are left as they were.
pub fn implied_bound_cuts(
    program: &Program,
    domain: &mut Domain,
    propagator: &mut Propagator,
    x: &[f64],
) -> Vec<Cut> {
    let distance = |j: usize| (x[j] - x[j].round()).abs();
    let is_binary = |j: usize| domain.bounds(j) == [0.0, 1.0];
    let mut fractional: Vec<usize> = program.integers.clone();
    fractional.retain(|&j| is_binary(j) && distance(j) > WHOLE);
    fractional.sort_by(|&a, &b| distance(b).total_cmp(&distance(a)).then(a.cmp(&b)));
    fractional.truncate(BINARIES);
    let mut cuts = Vec::new();
    for z in fractional {
        // A value that cannot be taken is left to probing.
        let sides = [0.0, 1.0].map(|value| bounds_at(program, domain, propagator, z, value));
        if let [Some(off), Some(on)] = sides {
            cuts.extend(cuts_between(domain, z, &off, &on, x));
        }
    }
    cuts
}

/// The bounds that change when a binary takes a value; `None` if it cannot.
fn bounds_at(
    program: &Program,
    domain: &mut Domain,
    propagator: &mut Propagator,
    z: usize,
    value: f64,
) -> Option<BTreeMap<usize, [f64; 2]>> {
    let mark = domain.mark();
    domain.apply(z, value == 0.0, value);
    let possible = propagator.propagate_since(program, domain, mark).is_ok();
    let bounds = domain.changed_since(mark).map(|(j, _)| (j, domain.bounds(j))).collect();
    domain.undo_to(mark);
    possible.then_some(bounds)
}

/// The violated ones of the cuts that two sets of bounds make; a bound that neither changes is no cut.
fn cuts_between(
    domain: &Domain,
    z: usize,
    off: &BTreeMap<usize, [f64; 2]>,
    on: &BTreeMap<usize, [f64; 2]>,
    x: &[f64],
) -> Vec<Cut> {
    let columns = off.keys().chain(on.keys().filter(|j| !off.contains_key(j)));
    let mut cuts = Vec::new();
    for &j in columns.filter(|j| **j != z) {
        let bounds = |side: &BTreeMap<usize, [f64; 2]>| {
            side.get(&j).copied().unwrap_or_else(|| domain.bounds(j))
        };
        let ([l0, u0], [l1, u1]) = (bounds(off), bounds(on));
        // As `sign * x <= at0 + (at1 - at0) z`.
        for (sign, at0, at1) in [(1.0, u0, u1), (-1.0, -l0, -l1)] {
            if at0.is_finite() && at1.is_finite() && sign * x[j] > at0 + (at1 - at0) * x[z] {
                let terms = BTreeMap::from([(j, sign), (z, at0 - at1)]);
                cuts.extend(Cut::new(terms, at0, at0.abs().max(at1.abs()), domain, x));
            }
        }
    }
    cuts
}
