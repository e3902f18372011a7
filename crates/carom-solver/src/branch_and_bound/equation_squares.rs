//! Squares of equations over columns with two values, which are 0 at every point.
//!
//! A form that is concave only along directions that leave such equations is convex with multiples
//! of their squares, and needs less of what makes its relaxation weak (Billionnet, Elloumi and
//! Plateau, Discrete Applied Mathematics 157, 2009).

use std::collections::BTreeMap;

use super::curvature_dual::BinaryRow;
use crate::semidefinite::Product;

/// The coefficient of a square beside the largest of the form (no unit). More would leave fewer
/// digits to the objective, and lifts relaxations by little.
const SQUARE_OF_EQUATION: f64 = 10.0;

/// The bits of such a coefficient behind the first.
const FACTOR_BITS: f64 = 5.0;

/// How many times as many products the squares may have as the form, and how many in any case.
const MOST_FILL: usize = 4;
const FREE_FILL: usize = 2000;

/// `factor * (sum of terms - limit)^2`; columns by their numbers.
#[derive(Debug, Clone)]
pub(super) struct EquationSquare {
    pub(super) terms: Vec<(usize, f64)>,
    pub(super) limit: f64,
    pub(super) factor: f64,
}

impl EquationSquare {
    /// The products of the square, with their coefficients.
    pub(super) fn products(&self) -> impl Iterator<Item = Product> + '_ {
        self.terms.iter().enumerate().flat_map(move |(k, &(i, a))| {
            let own = std::iter::once((i, i, self.factor * a * a));
            let later = self.terms[k + 1..].iter();
            own.chain(later.map(move |&(j, b)| (i, j, 2.0 * self.factor * a * b)))
        })
    }

    /// The linear coefficients of the square.
    pub(super) fn linear(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        self.terms.iter().map(|&(j, a)| (j, -2.0 * self.factor * self.limit * a))
    }
}

/// The squares that a form gets, of the shortest equations first.
///
/// # Arguments
///
/// * `form`: products of columns by their numbers.
/// * `rows`: rows over some of these columns, with the columns by their numbers.
pub(super) fn squares_of_equations(form: &[Product], rows: &[BinaryRow]) -> Vec<EquationSquare> {
    let largest = form.iter().map(|(.., q)| q.abs()).fold(0.0, f64::max);
    let mut equations: Vec<&BinaryRow> = rows.iter().filter(|row| row.is_equation).collect();
    equations.sort_by_key(|row| row.terms.len());
    let mut room = FREE_FILL + MOST_FILL * form.len();
    let mut squares = Vec::new();
    for row in equations {
        let fill = row.terms.len() * (row.terms.len() + 1) / 2;
        let steepest = row.terms.iter().map(|(_, a)| a.abs()).fold(0.0, f64::max);
        let factor = SQUARE_OF_EQUATION * largest / (steepest * steepest);
        if fill > room {
            break;
        }
        if !factor.is_normal() {
            continue;
        }
        room -= fill;
        // Of few digits, so that no digit of the terms is lost, which cancel where the limit is
        // large.
        let unit = (factor.log2().floor() - FACTOR_BITS).exp2();
        let factor = (factor / unit).ceil() * unit;
        squares.push(EquationSquare { terms: row.terms.clone(), limit: row.limit, factor });
    }
    squares
}

/// A form with squares; its products are in order.
pub(super) fn with_equations(form: &[Product], squares: &[EquationSquare]) -> Vec<Product> {
    let mut sum: BTreeMap<(usize, usize), f64> =
        form.iter().map(|&(a, b, q)| ((a, b), q)).collect();
    for (a, b, q) in squares.iter().flat_map(EquationSquare::products) {
        *sum.entry((a, b)).or_default() += q;
    }
    sum.into_iter().map(|((a, b), q)| (a, b, q)).collect()
}
