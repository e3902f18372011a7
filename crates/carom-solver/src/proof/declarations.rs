//! Declarations without loss of optimality, at the beginning of a proof, so that the splits of a
//! search which has used it are splits of the proof: columns that may be rounded, and columns that
//! may be 0 because all points can be shifted. See the rules `u` and `v` of the checker, which
//! judges each of them again.

use super::aggregated_row::SMALLEST_EXACT;
use super::bounds::Bounds;
use super::facts::Facts;
use super::tree::{Limit, ProofWriter};
use crate::presolve::root::shifts;
use crate::program::Program;
use crate::sum::{exact_product, exact_sum};

/// The longest row that is looked at for whether a column may be rounded.
const LONGEST_ROUNDING_ROW: usize = 1000;

impl ProofWriter<'_, '_> {
    /// Declares all that the search may have used.
    pub(super) fn declare(&mut self) -> Result<(), Limit> {
        if self.relaxer.program.integers.is_empty() {
            return Ok(());
        }
        self.declare_zeros();
        self.declare_binaries();
        self.imply_codes()?;
        self.declare_binaries();
        Ok(())
    }

    /// Takes a column as integral from here on, and rounds its bounds. The log has these at once:
    /// it takes none that is not whole any more.
    pub(super) fn take_as_integral(&mut self, column: usize) {
        for program in [&mut self.relaxer.program, &mut self.relaxer.within] {
            program.integral[column] = true;
            let place = program.integers.partition_point(|j| *j < column);
            program.integers.insert(place, column);
        }
        if self.bounds.take_as_integral(&self.facts, column) {
            self.write_bounds([(column, false), (column, true)].into_iter());
        }
    }

    /// Declares columns to be 0, and forgets the bounds and rows that the directions there change:
    /// those that the search leaves aside until it shifts its point.
    fn declare_zeros(&mut self) {
        let relaxer = &mut self.relaxer;
        for direction in shifts(&relaxer.program, relaxer.token) {
            let Some(&(first, _)) = direction.first() else { continue };
            let Some(changed) = changed_rows(&relaxer.program, &self.facts, &direction) else {
                continue;
            };
            self.log.shift(first, direction.iter().copied());
            for program in [&mut relaxer.program, &mut relaxer.within] {
                for &(j, _) in &direction {
                    let end = if j == first { 0.0 } else { f64::INFINITY };
                    (program.lower[j], program.upper[j]) = (-end, end);
                }
                for &row in &changed {
                    program.row_lower[row] = f64::NEG_INFINITY;
                    program.row_upper[row] = f64::INFINITY;
                }
            }
            let nothing = [f64::NEG_INFINITY, f64::INFINITY];
            changed.into_iter().for_each(|row| self.facts.set_limits(row, nothing));
        }
        self.bounds = Bounds::new(&relaxer.program);
    }

    /// Declares columns between 0 and 1 that may be rounded to be integral.
    fn declare_binaries(&mut self) {
        let program = &self.relaxer.program;
        let mut open: Vec<usize> = (0..program.column_count())
            .filter(|&j| !program.integral[j] && !program.is_in_cone(j))
            .filter(|&j| program.quadratic_column(j).0.is_empty())
            .filter(|&j| is_truth_value(program, &self.facts, j))
            .collect();
        // What is declared is integral in the rows of others.
        loop {
            let before = open.len();
            open.retain(|&j| {
                let (program, facts) = (&self.relaxer.program, &self.facts);
                let cost = program.linear[j];
                let may_move = |is_upper: &bool| {
                    (if *is_upper { cost <= 0.0 } else { cost >= 0.0 })
                        && ends_whole(program, facts, j, *is_upper)
                };
                let side = [true, false].into_iter().find(may_move);
                if let Some(is_upper) = side {
                    self.log.round(j, is_upper);
                    self.take_as_integral(j);
                }
                side.is_none()
            });
            if open.len() == before {
                break;
            }
        }
    }
}

/// Whether a column is between 0 and 1, or between 0 and less than 2 by a row.
fn is_truth_value(program: &Program, facts: &Facts, column: usize) -> bool {
    let upper = program.upper[column];
    let is_bounded = |&fact: &u32| {
        if facts.terms(fact as usize).len() > LONGEST_ROUNDING_ROW {
            return false;
        }
        let [lower, upper] = facts.limits(fact as usize);
        let own = facts.terms(fact as usize).find(|(j, _)| *j == column);
        let Some((_, own)) = own else { return false };
        let others = facts.terms(fact as usize).filter(|(j, _)| *j != column);
        // The others at their best, seen from a positive coefficient.
        let best = others.map(|(j, a)| {
            let a = a * own.signum();
            a * if a > 0.0 { program.lower[j] } else { program.upper[j] }
        });
        let limit = if own > 0.0 { upper } else { -lower };
        (limit - best.sum::<f64>()) / own.abs() < 2.0
    };
    let is_whole = upper.is_infinite() || upper == upper.round();
    program.lower[column] == 0.0
        && (upper == 1.0
            || (upper > 1.0 && is_whole && facts.of_column(column).iter().any(is_bounded)))
}

/// Whether all rows that keep a column from moving to a side hold it at whole numbers.
fn ends_whole(program: &Program, facts: &Facts, column: usize, is_upper: bool) -> bool {
    let uses = facts.of_column(column);
    !uses.is_empty()
        && uses.iter().all(|&fact| {
            let mut terms = facts.terms(fact as usize);
            if terms.len() > LONGEST_ROUNDING_ROW {
                return false;
            }
            let own = facts.terms(fact as usize).find(|(j, _)| *j == column);
            let Some((_, own)) = own else { return false };
            let limit = facts.limits(fact as usize)[usize::from((own > 0.0) == is_upper)];
            limit.is_infinite()
                || (is_multiple(limit, own)
                    && terms
                        .all(|(j, a)| j == column || (program.integral[j] && is_multiple(a, own))))
        })
}

/// Whether a number is exactly a whole multiple of another one.
fn is_multiple(value: f64, of: f64) -> bool {
    let times = (value / of).round();
    times.is_finite() && product(times, of) == Some(value)
}

/// A product that is not rounded.
fn product(a: f64, b: f64) -> Option<f64> {
    let (product, lost) = exact_product(a, b);
    // Errors of tiny products are lost.
    let is_exact = a == 0.0 || b == 0.0 || (lost == 0.0 && product.abs() > SMALLEST_EXACT);
    is_exact.then_some(product)
}

/// The rows that a direction changes, unless it changes the objective, or may not lead integral
/// columns from whole numbers to whole numbers. In exact arithmetic: what is rounded counts as a
/// change.
fn changed_rows(
    program: &Program,
    facts: &Facts,
    direction: &[(usize, f64)],
) -> Option<Vec<usize>> {
    let mut steps = direction.to_vec();
    steps.sort_unstable_by_key(|entry| entry.0);
    let step = |j: usize| {
        steps.binary_search_by_key(&j, |entry| entry.0).map_or(0.0, |place| steps[place].1)
    };
    let (first, unit) = *direction.first()?;
    let mut whole = steps.iter().filter(|(j, _)| program.integral[*j]).peekable();
    let is_whole = whole.peek().is_none() || (program.integral[first] && unit.abs() == 1.0);
    let is_fit = is_whole
        && whole.all(|(_, d)| *d == d.round())
        && steps.iter().all(|(j, _)| program.quadratic_column(*j).0.is_empty())
        && vanishes(steps.iter().map(|(j, d)| (program.linear[*j], *d)));
    let mut rows: Vec<usize> =
        steps.iter().flat_map(|(j, _)| facts.of_column(*j)).map(|row| *row as usize).collect();
    rows.sort_unstable();
    rows.dedup();
    rows.retain(|row| !vanishes(facts.terms(*row).map(|(j, a)| (a, step(j)))));
    is_fit.then_some(rows)
}

/// Whether a sum of products is 0, without rounding.
fn vanishes(mut products: impl Iterator<Item = (f64, f64)>) -> bool {
    let sum = products.try_fold(0.0, |sum, (a, b)| {
        let (sum, rest) = exact_sum(sum, product(a, b)?);
        (rest == 0.0).then_some(sum)
    });
    sum == Some(0.0)
}
