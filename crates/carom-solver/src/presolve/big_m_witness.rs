//! Points by which no pair of rows makes a big-M smaller.
//!
//! Dense programs have rows with many binaries, none of which switches its row off, and each row is
//! linked to each other. A pair of rows bounds the rest of one of them by what is at least its
//! largest value at all points of both. So a point at which the one reaches its limit, and which
//! satisfies the other, spares the work. It is one interior point, moved along the continuous terms
//! of the row, and of both rows where the first move violates the other.
//!
//! Only the work depends on the point: without it the result is the same.

use super::domain::Domain;
use crate::program::Program;

/// The least number of integral columns of a row for which points are looked for. The rows of most
/// hybrid systems have fewer.
const MANY_INTEGERS: usize = 3;

/// How often the interior point is moved to the inner side of each row.
const ROUNDS_TO_ROWS: usize = 4;

/// The least part of the steepness of a row that is left beside another (no unit).
const MIN_INDEPENDENT_PART: f64 = 1e-6;

/// The coefficients of a program while they change.
#[derive(Debug, Clone, Copy)]
pub(super) struct CurrentRows<'a> {
    pub(super) program: &'a Program,
    pub(super) values: &'a [f64],
    /// By column, whether the point can move along it: continuous columns that are not fixed.
    pub(super) moves: &'a [bool],
}

impl<'a> CurrentRows<'a> {
    fn terms(self, row: usize) -> impl Iterator<Item = (usize, f64)> + Clone + 'a {
        let values = &self.values[self.program.rows.symbolic().row_range(row)];
        self.program.row(row).0.iter().copied().zip(values.iter().copied())
    }

    /// The terms along which the point can move.
    fn moving(self, row: usize) -> impl Iterator<Item = (usize, f64)> + Clone + 'a {
        self.terms(row).filter(move |(j, _)| self.moves[*j])
    }

    fn steepness(self, row: usize) -> f64 {
        self.moving(row).map(|(_, a)| a * a).sum()
    }
}

/// A row with many integral columns, whose continuous terms do not change.
#[derive(Debug)]
struct DenseRow {
    /// The rows that are linked to it.
    linked: Vec<usize>,
    /// How fast each of them grows along the continuous terms of this row.
    slopes: Vec<f64>,
}

/// The interior point, and the values of rows at it.
#[derive(Debug)]
pub(super) struct Witness {
    /// Empty, as what follows, if no row has many integral columns.
    point: Vec<f64>,
    rows: Vec<Option<DenseRow>>,
    /// By row, how fast it grows along its own continuous terms.
    steepness: Vec<f64>,
    /// By row, its value at the point that is moved into the domain at hand, and for which domain.
    sums: Vec<(usize, f64)>,
    domain: usize,
    terms: Vec<f64>,
}

/// A row that is to reach its limit: `sign * row = limit`.
#[derive(Debug, Clone, Copy)]
pub(super) struct SoughtLimit {
    pub(super) row: usize,
    pub(super) sign: f64,
    pub(super) limit: f64,
}

impl Witness {
    pub(super) fn new(rows: CurrentRows<'_>, domain: &Domain) -> Self {
        let program = rows.program;
        let mut witness = Witness {
            point: Vec::new(),
            rows: Vec::new(),
            steepness: Vec::new(),
            sums: Vec::new(),
            domain: 1,
            terms: Vec::new(),
        };
        let m = program.row_count();
        if (0..m).any(|row| is_dense(program, row)) {
            witness.point = interior_point(rows, domain);
            witness.rows.resize_with(m, || None);
            witness.steepness = (0..m).map(|row| rows.steepness(row)).collect();
            witness.sums = vec![(0, 0.0); m];
            witness.terms = vec![0.0; program.column_count()];
        }
        witness
    }

    /// The rows that are linked to a row, if they are known.
    pub(super) fn linked(&self, row: usize) -> Option<&[usize]> {
        self.rows.get(row)?.as_ref().map(|row| row.linked.as_slice())
    }

    /// Keeps the rows that are linked to a row, if it has many integral columns.
    pub(super) fn keep_linked(&mut self, rows: CurrentRows<'_>, row: usize, linked: &[usize]) {
        if self.point.is_empty() || !is_dense(rows.program, row) {
            return;
        }
        rows.moving(row).for_each(|(j, a)| self.terms[j] = a);
        let slope = |row: &usize| rows.terms(*row).map(|(j, a)| a * self.terms[j]).sum();
        let slopes = linked.iter().map(slope).collect();
        rows.moving(row).for_each(|(j, _)| self.terms[j] = 0.0);
        self.rows[row] = Some(DenseRow { linked: linked.to_vec(), slopes });
    }

    /// Forgets the values of rows, because the domain or a row has changed.
    pub(super) fn forget_sums(&mut self) {
        self.domain += 1;
    }

    /// How far the point has to move along the terms of a row with many integral columns until that
    /// is at its limit; `None` if the domain ends before.
    pub(super) fn step(
        &mut self,
        rows: CurrentRows<'_>,
        domain: &Domain,
        sought: SoughtLimit,
    ) -> Option<f64> {
        let SoughtLimit { row, sign, limit } = sought;
        self.rows.get(row)?.as_ref()?;
        let missing = limit - sign * self.sum(rows, domain, row);
        let step = sign * missing.max(0.0) / self.steepness[row];
        let stays = |(j, a)| self.is_within(domain, j, step * a);
        (step.is_finite() && rows.moving(row).all(stays)).then_some(step)
    }

    /// Whether a point of the domain satisfies a row and is where another one has its limit.
    ///
    /// # Arguments
    ///
    /// * `step`: that of the other one.
    /// * `k`: the place of the row among those that are linked to the other one.
    /// * `limits`: those of the row.
    pub(super) fn satisfies(
        &mut self,
        rows: CurrentRows<'_>,
        domain: &Domain,
        (sought, step): (SoughtLimit, f64),
        k: usize,
        limits: [f64; 2],
    ) -> bool {
        let Some(dense) = &self.rows[sought.row] else { return false };
        let (row, slope) = (dense.linked[k], dense.slopes[k]);
        let sum = self.sum(rows, domain, row);
        let after = sum + step * slope;
        let target = after.max(limits[0]).min(limits[1]);
        if after == target {
            return true;
        }
        // The shortest move along the terms of both that reaches the limits of both.
        let (own, other) = (self.steepness[sought.row], self.steepness[row]);
        let independent = own * other - slope * slope;
        if independent.is_nan() || independent <= MIN_INDEPENDENT_PART * own * other {
            return false;
        }
        let along = own * (target - after) / independent;
        let step = step - along * slope / own;
        let mut first = rows.moving(sought.row).peekable();
        let mut second = rows.moving(row).peekable();
        loop {
            let [i, j] = [first.peek(), second.peek()].map(|next| next.map_or(usize::MAX, |n| n.0));
            if i == usize::MAX && j == usize::MAX {
                return true;
            }
            let a = first.next_if(|_| i <= j).map_or(0.0, |term| term.1);
            let b = second.next_if(|_| j <= i).map_or(0.0, |term| term.1);
            if !self.is_within(domain, i.min(j), step * a + along * b) {
                return false;
            }
        }
    }

    fn is_within(&self, domain: &Domain, j: usize, move_by: f64) -> bool {
        let [lower, upper] = domain.bounds(j);
        let moved = self.point[j].clamp(lower, upper) + move_by;
        lower <= moved && moved <= upper
    }

    /// The value of a row at the point in the domain.
    fn sum(&mut self, rows: CurrentRows<'_>, domain: &Domain, row: usize) -> f64 {
        let (of, sum) = self.sums[row];
        if of == self.domain {
            return sum;
        }
        let term = |(j, a): (usize, f64)| {
            let [lower, upper] = domain.bounds(j);
            a * self.point[j].clamp(lower, upper)
        };
        let sum = rows.terms(row).map(term).sum();
        self.sums[row] = (self.domain, sum);
        sum
    }
}

fn is_dense(program: &Program, row: usize) -> bool {
    program.row(row).0.iter().filter(|j| program.integral[**j]).count() >= MANY_INTEGERS
}

/// A point within the bounds, moved to the inner side of one row after the other, so far that one
/// integral column may go to its bound.
fn interior_point(rows: CurrentRows<'_>, domain: &Domain) -> Vec<f64> {
    let program = rows.program;
    let start = |j: usize| {
        let [lower, upper] = domain.bounds(j);
        if lower.is_finite() && upper.is_finite() { 0.5 * (lower + upper) } else { 0.0 }
    };
    let clamped = |j: usize, x: f64| x.clamp(domain.lower(j), domain.upper(j));
    let mut point: Vec<f64> = (0..program.column_count()).map(|j| clamped(j, start(j))).collect();
    for _ in 0..ROUNDS_TO_ROWS {
        for row in 0..program.row_count() {
            let [lower, upper] = [program.row_lower[row], program.row_upper[row]];
            let integral = rows.terms(row).filter(|(j, _)| program.integral[*j]);
            let steepest = integral.map(|(_, a)| a.abs()).fold(0.0, f64::max);
            let margin = steepest.min(0.5 * (upper - lower));
            let sum: f64 = rows.terms(row).map(|(j, a)| a * point[j]).sum();
            let missing = sum.max(lower + margin).min(upper - margin) - sum;
            let length = rows.steepness(row);
            if missing == 0.0 || length == 0.0 {
                continue;
            }
            for (j, a) in rows.moving(row) {
                point[j] = clamped(j, point[j] + missing / length * a);
            }
        }
    }
    point
}
