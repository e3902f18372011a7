//! Semi-continuous variables as rows.
//!
//! Takes a variable that is 0 or within limits; leaves bounds, and rows with a binary if bounds do
//! not suffice.
//!
//! `x = 0 or l <= x <= u` with `0 < l` becomes `l z <= x <= u z` with a binary `z`, which is the
//! convex hull; the mirror image holds for `u < 0`. Current bounds narrow `l` and `u` first. No
//! binary is needed if they exclude 0 or all other values, or if every whole number of a
//! semi-integer variable is allowed. Without a finite `u` the set cannot be written with rows and
//! binaries at all, because `x` can grow without limit in one case only.

use super::big_m::{Implied, apply_unless};
use super::lowering::Lowering;
use crate::error::Error;
use crate::interval::Interval;
use crate::model::{BigM, Literal, Variable, VariableKind, VariableRef};

/// Adds the rows of a variable that is 0 or within `values`.
pub(super) fn apply(
    variable: &VariableRef<'_>,
    values: Interval,
    lowering: &mut Lowering<'_>,
) -> Result<(), Error> {
    let (x, own) = (variable.id(), variable.bounds());
    lowering.begin(variable.name());
    let hull = values.hull(Interval::point(0.0));
    let (zero, inside) = (own.contains(0.0), own.intersection(values));
    if inside.lower > inside.upper {
        // Only 0 is left, or nothing.
        return match zero {
            true => lowering.model.set_bounds(x, 0.0, 0.0),
            false => lowering.row(vec![(x, 1.0)], values.lower, values.upper),
        };
    }
    let range = if zero { own.intersection(hull) } else { inside };
    lowering.model.set_bounds(x, range.lower, range.upper)?;
    let near = if inside.lower > 0.0 { inside.lower } else { -inside.upper };
    let dense = variable.kind().is_integral() && near <= 1.0;
    if !zero || near <= 0.0 || dense {
        return Ok(());
    }
    lowering.finite_bounds(x)?;
    let nonzero = lowering.nonzero(x)?;
    let (name, terms) = (variable.name(), &[(x, 1.0)]);
    let row = Implied { name, terms, limits: inside, big_m: BigM::Automatic };
    apply_unless(&[!nonzero], &row, lowering)
}

impl Lowering<'_> {
    /// A condition that holds if a variable is other than 0, with its rows. It may hold if the
    /// variable is 0. All statements share it.
    pub(super) fn nonzero(&mut self, variable: Variable) -> Result<Literal, Error> {
        if self.model.variable_ref(variable)?.kind() == VariableKind::Binary {
            return Ok(variable.on());
        }
        if let Some(&known) = self.nonzero.get(&variable) {
            return Ok(known);
        }
        let name = self.model.variable_ref(variable)?.name().clone();
        self.begin(&name);
        let switch = self.column("nonzero", VariableKind::Binary, 0.0, 1.0)?.on();
        let (terms, limits) = (&[(variable, 1.0)], Interval::point(0.0));
        let row = Implied { name: &name, terms, limits, big_m: BigM::Automatic };
        apply_unless(&[switch], &row, self)?;
        self.nonzero.insert(variable, switch);
        Ok(switch)
    }
}
