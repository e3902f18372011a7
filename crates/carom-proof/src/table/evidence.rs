//! Bounds of costs over a simplex, from multipliers at its corners.
//!
//! At a state t, for any z and any multipliers y of rows, the program without integrality is at
//! least
//!
//! `c(t) - 1/2 z'Pz - sum max(y u, y l) + t'A_t'y + min over the box (Pz + q + P_xt t + A_x'y)'x`
//!
//! with `c(t) = 1/2 t'P_tt t + q_t't + offset`, because a convex function is above its tangents,
//! up to what `statement` finds it to lack of being convex. For rays, z, P, q and the offset are left out, and a positive bound says that there is
//! no point. With t, z and y interpolated between corners, this is at least a quadratic form of the
//! weights: the least sum over the box and the limits are concave in what they depend on. The
//! coefficient of a pair of corners is half of [`twice_bound`].

use super::statement::Statement;
use crate::exact::{Dyadic, Sum};
use crate::text::Refusal;
use std::cmp::Ordering;

/// Multipliers, with the point at which the cost is linearised if it is for a bound.
#[derive(Debug)]
pub(super) struct Evidence {
    pub(super) is_ray: bool,
    /// By column; none for axes.
    pub(super) z: Vec<(u32, f64)>,
    /// By row.
    pub(super) y: Vec<(u32, f64)>,
}

/// The parts of a bound at a corner.
#[derive(Debug)]
pub(super) struct Part {
    /// The affine part without the axes.
    base: Dyadic,
    /// `A_t'y`, an entry an axis.
    along: Vec<Dyadic>,
}

/// The values of a sparse vector.
pub(super) fn dense(entries: &[(u32, f64)], length: usize) -> Vec<f64> {
    let mut all = vec![0.0; length];
    entries.iter().for_each(|&(k, value)| all[k as usize] = value);
    all
}

impl Evidence {
    /// The parts of the bound at a state, within bounds of columns.
    pub(super) fn part(
        &self,
        statement: &Statement,
        state: &[Dyadic],
        sides: &[(f64, f64)],
    ) -> Result<Part, Refusal> {
        let y = dense(&self.y, statement.rows.len());
        let z = dense(&self.z, statement.columns.len());
        let (mut sum, mut base) = (Sum::default(), Sum::default());
        let mut along = vec![Dyadic::zero(); state.len()];
        for (i, &y) in y.iter().enumerate().filter(|(_, y)| **y != 0.0) {
            let (lower, upper, _) = statement.rows[i];
            // An infinite limit makes the sum fail.
            base.subtract(y, if y > 0.0 { upper } else { lower });
        }
        for (column, &(lower, upper)) in statement.columns.iter().zip(sides) {
            for &(i, a) in column.terms.iter().filter(|(i, _)| y[*i] != 0.0) {
                sum.add(a, y[i]);
            }
            if let Some(axis) = column.axis {
                along[axis] = sum.take()?;
                continue;
            }
            if !self.is_ray {
                sum.add(column.linear, 1.0);
                for &(k, p) in &column.squares {
                    match statement.columns[k].axis {
                        Some(axis) => sum.add(p, &state[axis]),
                        None => sum.add(p, z[k]),
                    }
                }
            }
            let slope = sum.take()?;
            match slope.sign() {
                Ordering::Greater => base.add(&slope, lower),
                Ordering::Less => base.add(&slope, upper),
                Ordering::Equal => {}
            }
        }
        Ok(Part { base: base.take()?, along })
    }
}

/// Adds twice the coefficient of a pair of corners to a sum, times `sign`.
///
/// # Arguments
///
/// * `pair`: for each of the two corners, the evidence, its part and the state.
pub(super) fn twice_bound(
    statement: &Statement,
    pair: [(&Evidence, &Part, &[Dyadic]); 2],
) -> Result<Dyadic, Refusal> {
    let [(first, own, here), (second, other, there)] = pair;
    let mut sum = Sum::default();
    sum.add(&own.base, 1.0);
    sum.add(&other.base, 1.0);
    own.along.iter().zip(there).for_each(|(y, t)| sum.add(y, t));
    other.along.iter().zip(here).for_each(|(y, t)| sum.add(y, t));
    if first.is_ray {
        return Ok(sum.take()?);
    }
    let n = statement.columns.len();
    let (z, w) = (dense(&first.z, n), dense(&second.z, n));
    for (j, column) in statement.columns.iter().enumerate() {
        if let Some(axis) = column.axis {
            sum.add(column.linear, &here[axis]);
            sum.add(column.linear, &there[axis]);
            for &(k, p) in &column.squares {
                if let Some(second) = statement.columns[k].axis {
                    sum.add(p, &product(&here[axis], &there[second])?);
                }
            }
        } else if z[j] != 0.0 {
            for &(k, p) in column.squares.iter().filter(|(k, _)| w[*k] != 0.0) {
                let value = Dyadic::from_f64(w[k]);
                sum.subtract(&product(&Dyadic::from_f64(z[j]), &value)?, p);
            }
        }
    }
    sum.add(2.0, statement.offset);
    sum.subtract(2.0, &statement.lack);
    Ok(sum.take()?)
}

/// The product of two numbers.
pub(super) fn product(a: &Dyadic, b: &Dyadic) -> Result<Dyadic, Refusal> {
    let mut sum = Sum::default();
    sum.add(a, b);
    Ok(sum.take()?)
}
