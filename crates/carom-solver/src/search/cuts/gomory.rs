//! Gomory's mixed-integer cuts.
//!
//! Takes a vertex, the rows of the inverse of its basis at whole columns with fractions, and the
//! rows of the program; leaves cuts that the vertex violates (Gomory, An algorithm for the mixed
//! integer problem, RAND Corporation, 1960).
//!
//! The sum of rows in which one whole column of the basis is left besides columns at bounds is
//! rounded like any other aggregate (`rounding`), so a basis that is wrong makes no wrong cut.

use super::cut::Cut;
use super::mixed_integer_rounding::best_rounding;
use super::parameters::CUTS;
use super::rounding::{Aggregate, Rounder};
use super::separated_point::SeparatedPoint;
use crate::presolve::Domain;
use crate::program::Program;
use crate::solver::StopToken;

/// Cuts by rounding rows of the tableau of a vertex: sums of the program's rows, by row and
/// multiplier.
pub fn gomory_cuts(
    program: &Program,
    domain: &Domain,
    x: &[f64],
    inverse: &[Vec<(usize, f64)>],
    token: &StopToken,
) -> Vec<Cut> {
    if inverse.is_empty() {
        return Vec::new();
    }
    let point = &SeparatedPoint::new(program, domain, x);
    let (mut cuts, mut rounder) = (Vec::new(), Rounder::default());
    let mut sum = RowSum::new(program.column_count() + program.row_count());
    for multipliers in inverse {
        let Some(aggregate) = sum.of(point, multipliers) else { continue };
        if token.spend(100 * aggregate.terms.len()) {
            break;
        }
        cuts.extend(best_rounding(point, &aggregate, &mut rounder));
    }
    cuts
}

/// Adds multiples of rows up.
struct RowSum {
    /// By column and slack, the sum of the terms and that of their magnitudes.
    terms: Vec<[f64; 2]>,
    used: Vec<usize>,
    row: Aggregate,
}

impl RowSum {
    fn new(keys: usize) -> Self {
        RowSum { terms: vec![[0.0; 2]; keys], used: Vec::new(), row: Aggregate::default() }
    }

    /// The sum of rows with multipliers; `None` if it has too many entries, or a row has no limit.
    fn of(
        &mut self,
        point: &SeparatedPoint<'_>,
        multipliers: &[(usize, f64)],
    ) -> Option<Aggregate> {
        let mut sum = Aggregate::default();
        let mut is_whole = true;
        for &(row, multiplier) in multipliers {
            is_whole = row < point.program.row_count() && self.row.set_to_row(point, row);
            if !is_whole {
                break;
            }
            let factor = multiplier * point.slack_sign(row);
            for &(key, a) in &self.row.terms {
                let term = factor * a;
                let [value, size] = &mut self.terms[key];
                if *size == 0.0 {
                    self.used.push(key);
                }
                *value += term;
                *size += term.abs();
            }
            sum.right += factor * self.row.right;
            sum.noise += factor.abs() * self.row.noise;
            sum.size += factor.abs() * self.row.size;
            sum.rows.push((row, factor));
        }
        self.used.sort_unstable();
        for key in self.used.drain(..) {
            let [value, size] = std::mem::take(&mut self.terms[key]);
            // What is left of terms that cancel is rounding.
            if value.abs() > CUTS.cancelled * size {
                sum.terms.push((key, value));
            }
        }
        (is_whole && sum.terms.len() <= CUTS.tableau_entries).then_some(sum)
    }
}
