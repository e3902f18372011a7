//! The rules for the objective and for cones: convexity, tangents.

use crate::bounds::Bounds;
use crate::exact::{Dyadic, Number, OutOfRange, Sum};
use crate::linear_rules::Sums;
use crate::program::{Cone, Objective};
use crate::rows::{Row, Term};
use crate::text::{Refusal, rejected};
use std::cmp::Ordering;

/// Entries of a column of a matrix.
pub(crate) type Entries = Vec<(u32, f64)>;

/// The objective `1/2 x'Px + linear x + constant`.
#[derive(Debug)]
pub(crate) struct Quadratic {
    constant: Dyadic,
    linear: Row,
    /// The rows of `P`. Entries of the same column are added.
    rows: Vec<Entries>,
    /// `d` with `P + diag(d)` positive semidefinite, once that is proved.
    deficits: Option<Entries>,
}

/// `factor (x_column - value) z`, or `factor (x_column - value) (1 - z)` if it is off at 0: a
/// product that is 0 at every point, because the binary `z` is either off, with `x_column = value`,
/// or not.
#[derive(Debug)]
pub(crate) struct ZeroProduct {
    pub(crate) column: u32,
    pub(crate) value: f64,
    pub(crate) binary: u32,
    pub(crate) is_off_at_one: bool,
    pub(crate) factor: f64,
}

const ONE: Number<'static> = Number::Float(1.0);

impl Quadratic {
    pub(crate) fn new(objective: &Objective, columns: usize) -> Self {
        let mut rows = vec![Vec::new(); columns];
        for &(row, column, value) in &objective.triangle {
            push(&mut rows, row, (column, value));
            if row != column {
                push(&mut rows, column, (row, value));
            }
        }
        let constant = Dyadic::from_f64(objective.constant);
        let linear = Row::new(objective.linear.clone(), None, None);
        Quadratic { constant, linear, rows, deficits: None }
    }

    /// Adds products that are 0 at every point.
    pub(crate) fn add_zero(
        &mut self,
        products: &[ZeroProduct],
        sums: &mut Sums,
    ) -> Result<(), Refusal> {
        let mut terms = linear_terms(&self.linear);
        sums.total.add(&self.constant, 1.0);
        for &ZeroProduct { column, value, binary, is_off_at_one, factor } in products {
            // factor (x - value) (1 - z) is -factor (x - value) z + factor (x - value).
            let of_binary = if is_off_at_one { factor } else { -factor };
            push(&mut self.rows, column, (binary, of_binary));
            push(&mut self.rows, binary, (column, of_binary));
            terms.push((binary, -of_binary, Number::Float(value)));
            if !is_off_at_one {
                terms.push((column, factor, ONE));
                sums.total.subtract(factor, value);
            }
        }
        let linear = Row::combination(&mut terms, &mut sums.column)?;
        (self.linear, self.constant) = (linear, sums.total.take()?);
        Ok(())
    }

    /// Accepts deficits `d`: `P + diag(d) - LL'` must be diagonally dominant.
    ///
    /// A diagonally dominant matrix with a diagonal that is not negative is positive semidefinite,
    /// and so is `LL'`.
    pub(crate) fn prove(
        &mut self,
        deficits: Entries,
        factor: &[Entries],
        sums: &mut Sums,
    ) -> Result<(), Refusal> {
        let mut factor_rows = vec![Vec::new(); self.rows.len()];
        for (entries, k) in factor.iter().zip(0_u32..) {
            for &(row, value) in entries {
                push(&mut factor_rows, row, (k, value));
            }
        }
        let mut diagonal = deficits.iter().copied().peekable();
        for ((own, factor_row), index) in self.rows.iter().zip(&factor_rows).zip(0_u32..) {
            let mut terms: Vec<Term<'_>> = as_terms(own).collect();
            if let Some((column, value)) = diagonal.next_if(|entry| entry.0 == index) {
                terms.push((column, value, ONE));
            }
            for &(k, value) in factor_row {
                for &(column, other) in factor.get(k as usize).into_iter().flatten() {
                    terms.push((column, -value, Number::Float(other)));
                }
            }
            let row = Row::combination(&mut terms, &mut sums.column)?;
            for (column, value) in row.entries() {
                if column == index || value.sign() == Ordering::Less {
                    sums.total.add(value, 1.0);
                } else {
                    sums.total.subtract(value, 1.0);
                }
            }
            let dominance = sums.total.take()?;
            if dominance.sign() == Ordering::Less {
                let missing = dominance.negated();
                return rejected(format!("row {index} is not diagonally dominant, by {missing}"));
            }
        }
        self.deficits = Some(deficits);
        Ok(())
    }

    fn has_squares(&self, sum: &mut Sum) -> Result<bool, Refusal> {
        for row in self.rows.iter().filter(|row| !row.is_empty()) {
            let mut terms: Vec<Term<'_>> = as_terms(row).collect();
            if Row::combination(&mut terms, sum)?.entries().next().is_some() {
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// `d`, if convexity is proved.
    pub(crate) fn deficits(&self) -> Option<&Entries> {
        self.deficits.as_ref()
    }

    /// The gradient at a point, as a row without limits.
    pub(crate) fn gradient(&self, point: &[(u32, f64)], sums: &mut Sums) -> Result<Row, Refusal> {
        let mut terms = linear_terms(&self.linear);
        for &(column, value) in point.iter().filter(|entry| entry.1 != 0.0) {
            for &(other, entry) in self.rows.get(column as usize).into_iter().flatten() {
                terms.push((other, entry, Number::Float(value)));
            }
        }
        Ok(Row::combination(&mut terms, &mut sums.column)?)
    }

    /// Adds `point'P point` to the total.
    fn add_curvature(&self, gradient: &Row, point: &[(u32, f64)], sums: &mut Sums) {
        for (column, coefficient) in gradient.entries() {
            sums.total.add(coefficient, value_at(point, column));
        }
        for (column, coefficient) in self.linear.entries() {
            sums.total.subtract(coefficient, value_at(point, column));
        }
    }

    /// The objective at a point.
    pub(crate) fn value(&self, point: &[(u32, f64)], sums: &mut Sums) -> Result<Dyadic, Refusal> {
        let gradient = self.gradient(point, sums)?;
        self.add_value(&gradient, point, sums)?;
        Ok(sums.total.take()?)
    }

    /// Adds the objective at a point to the total, which is 0 before.
    pub(crate) fn add_value(
        &self,
        gradient: &Row,
        point: &[(u32, f64)],
        sums: &mut Sums,
    ) -> Result<(), Refusal> {
        self.add_curvature(gradient, point, sums);
        let half = sums.total.take()?.half();
        sums.total.add(&half, 1.0);
        sums.total.add(&self.constant, 1.0);
        for (column, coefficient) in self.linear.entries() {
            sums.total.add(coefficient, value_at(point, column));
        }
        Ok(())
    }

    /// The row that `objective <= limit` implies at every point, by the tangent of the objective at
    /// `point`:
    ///
    /// `gradient x <= limit - objective(point) + gradient point + slack`,
    /// `slack = 1/2 sum d_j max(|lower_j - point_j|, |upper_j - point_j|)^2`.
    ///
    /// Because `1/2 (x - point)'P(x - point) >= -1/2 sum d_j (x_j - point_j)^2 >= -slack`.
    pub(crate) fn tangent(
        &self,
        point: &[(u32, f64)],
        limit: f64,
        bounds: &Bounds,
        sums: &mut Sums,
    ) -> Result<Row, Refusal> {
        if self.deficits.is_none() && self.has_squares(&mut sums.column)? {
            return rejected("the objective has squares, and `p` has not proved that it is convex");
        }
        let at = |column: u32| value_at(point, column);
        let mut row = self.gradient(point, sums)?;
        // `gradient point - objective(point)` is `1/2 point'P point - constant`.
        self.add_curvature(&row, point, sums);
        for &(column, deficit) in self.deficits.iter().flatten().filter(|entry| entry.1 > 0.0) {
            let (lower, upper) = bounds.of(column as usize);
            if !lower.is_finite() || !upper.is_finite() {
                return rejected(format!("column {column} has a deficit and is not bounded"));
            }
            let square = farthest_square(lower, upper, at(column), &mut sums.column)?;
            sums.total.add(&square, deficit);
        }
        let half = sums.total.take()?.half();
        sums.total.add(&half, 1.0);
        sums.total.subtract(&self.constant, 1.0);
        sums.total.add(limit, 1.0);
        row.upper = Some(sums.total.take()?);
        Ok(row)
    }
}

pub(crate) fn value_at(point: &[(u32, f64)], column: u32) -> f64 {
    let place = point.binary_search_by_key(&column, |entry| entry.0);
    place.ok().and_then(|k| point.get(k)).map_or(0.0, |entry| entry.1)
}

/// The square of the distance from a value to the farther of two bounds.
pub(crate) fn farthest_square(
    lower: f64,
    upper: f64,
    value: f64,
    sum: &mut Sum,
) -> Result<Dyadic, OutOfRange> {
    let mut farthest = Dyadic::zero();
    for bound in [lower, upper] {
        sum.add(bound, 1.0);
        sum.subtract(value, 1.0);
        let distance = sum.take()?;
        sum.add(&distance, &distance);
        let square = sum.take()?;
        sum.add(&square, 1.0);
        sum.subtract(&farthest, 1.0);
        if sum.take_sign()? == Ordering::Greater {
            farthest = square;
        }
    }
    Ok(farthest)
}

/// `p head - w tail >= 0`, which holds in a cone if `|w| <= p`; of a rotated one
/// `p head + q second - 2 w tail >= 0`, which holds if `|w|^2 <= p q`.
///
/// Because `w tail <= |w| |tail|`, and
/// `2 |w| |tail| <= 2 sqrt(p q head second) <= p head + q second`.
pub(crate) fn cone_tangent(
    cone: &Cone,
    (p, q): (f64, f64),
    w: &[f64],
    sum: &mut Sum,
) -> Result<Row, Refusal> {
    if !(p >= 0.0 && q >= 0.0) {
        return rejected("the weight of a head is negative");
    }
    for &value in w {
        sum.add(value, value);
    }
    sum.subtract(p, q);
    let excess = sum.take()?;
    if excess.sign() == Ordering::Greater {
        return rejected(format!(
            "the weights of the tail are too long: their square, by {excess}"
        ));
    }
    let mut terms: Vec<Term<'_>> = vec![(cone.head, p, ONE)];
    terms.extend(cone.second.map(|second| (second, q, ONE)));
    let factor = Number::Float(if cone.second.is_some() { -2.0 } else { -1.0 });
    terms.extend(cone.tail.iter().zip(w).map(|(&column, &value)| (column, value, factor)));
    let mut row = Row::combination(&mut terms, sum)?;
    row.lower = Some(Dyadic::zero());
    Ok(row)
}

fn as_terms(entries: &Entries) -> impl Iterator<Item = Term<'_>> {
    entries.iter().map(|&(column, value)| (column, value, ONE))
}

fn linear_terms(linear: &Row) -> Vec<Term<'_>> {
    linear.entries().map(|(column, value)| (column, 1.0, value)).collect()
}

fn push(rows: &mut [Entries], row: u32, entry: (u32, f64)) {
    if let Some(entries) = rows.get_mut(row as usize) {
        entries.push(entry);
    }
}
