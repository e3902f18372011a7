//! Lagrange's completion of squares: a quadratic expression as a sum of squares and products of
//! affine ones.
//!
//! Symmetric elimination on the matrix of the products, block by block of the variables that
//! products link, with the linear part as a further column. A positive square is completed first,
//! then a negative one, and where all squares are gone, a product of two variables. What
//! elimination leaves of a coefficient counts as 0 if it is a few units in the last place of what
//! was subtracted, measured by the squares of the variables: `(x - 2 y + 0.1 z)^2` has one square.

use crate::model::affine::Affine;
use crate::model::ids::Variable;
use crate::model::quadratic::Quadratic;
use crate::semidefinite::blocks;

/// How many times the bound of its rounding error a coefficient must be to count (no unit), as the
/// coefficients of the expression were rounded before.
pub(super) const ROUNDED_AWAY: f64 = 64.0;

/// The largest share of what was subtracted that counts as rounding (no unit).
const MOST_ROUNDED_AWAY: f64 = 1e-9;

/// The share of `q_ij^2` above which `q_ii q_jj` is of its size (no unit).
const AGREES: f64 = 1e-6;

/// A square that kept less of its coefficient is completed last (no unit).
const SMALL_PIVOT: f64 = 1e-2;

/// The place of the constant among the columns of a block.
const OF_CONSTANT: usize = usize::MAX;

/// A square or a product that was completed.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Completed {
    /// `coefficient * root^2`.
    Square { coefficient: f64, root: Affine, lead: Variable },
    /// `coefficient * factors[0] * factors[1]`.
    Product { coefficient: f64, factors: [Affine; 2], leads: [Variable; 2] },
}

/// The blocks of completed squares of an expression, and what is left of it.
#[derive(Debug, Clone, Default)]
pub(super) struct SumOfSquares {
    /// In each block, in the order of elimination: none holds the leads of those before it.
    pub(super) blocks: Vec<Vec<Completed>>,
    /// The terms of variables that are in no square.
    pub(super) linear: Affine,
    /// The constant that is left; 0 if it is rounding.
    pub(super) constant: f64,
}

impl SumOfSquares {
    /// Completes the squares of an expression.
    ///
    /// # Arguments
    ///
    /// * `is_convex`: whether squares that elimination leaves with a negative coefficient are
    ///   rounding.
    pub(super) fn of(expression: &Quadratic, is_convex: bool) -> Self {
        let products = expression.products();
        let variables = by_place(&products, expression.affine());
        let place = |v: Variable| variables.binary_search(&v).unwrap_or_default();
        let products: Vec<(usize, usize, f64)> =
            products.into_iter().map(|(a, b, q)| (place(a), place(b), q)).collect();
        let mut linear: Vec<f64> = vec![0.0; variables.len()];
        expression.affine().terms().iter().for_each(|&(v, a)| linear[place(v)] = a);
        let mut sum = SumOfSquares::default();
        let mut constant = Remainder::new(expression.affine().offset());
        for (names, products) in blocks(&products) {
            let mut block = SquareElimination::new(&names, &products, &linear, constant, is_convex);
            let mut completed = Vec::new();
            while let Some(next) = block.next(&names, &variables) {
                completed.push(next);
            }
            constant = block.constant;
            for (k, &name) in names.iter().enumerate() {
                linear[name] = block.left_linear(k);
            }
            sum.blocks.push(completed);
        }
        for (&v, &a) in variables.iter().zip(&linear) {
            if a != 0.0 {
                sum.linear.add_term(a, v);
            }
        }
        sum.constant = if constant.is_rounding(constant.size) { 0.0 } else { constant.value };
        sum
    }

    /// The squares and products.
    pub(super) fn completed(&self) -> impl Iterator<Item = &Completed> {
        self.blocks.iter().flatten()
    }
}

/// The variables of an expression, sorted.
fn by_place(products: &[(Variable, Variable, f64)], affine: &Affine) -> Vec<Variable> {
    let of_products = products.iter().flat_map(|&(a, b, _)| [a, b]);
    let mut variables: Vec<Variable> =
        of_products.chain(affine.terms().iter().map(|term| term.0)).collect();
    variables.sort_unstable();
    variables.dedup();
    variables
}

/// A coefficient, the largest number that it was computed from, and a bound of its rounding error.
#[derive(Debug, Clone, Copy)]
struct Remainder {
    value: f64,
    size: f64,
    error: f64,
}

impl Remainder {
    fn new(value: f64) -> Self {
        Remainder { value, size: value.abs(), error: f64::EPSILON * value.abs() }
    }

    /// Subtracts `left right / divisor`.
    fn subtract(&mut self, left: Remainder, right: Remainder, divisor: Remainder) {
        let (scale, of_divisor) = (1.0 / divisor.value.abs(), divisor.error / divisor.value.abs());
        let amount = left.value * right.value / divisor.value;
        self.value -= amount;
        self.size = self.size.max(amount.abs());
        let of_factors = left.error * right.value.abs() + right.error * left.value.abs();
        self.error += of_factors * scale
            + amount.abs() * (of_divisor + 2.0 * f64::EPSILON)
            + self.value.abs() * f64::EPSILON;
    }

    /// Whether it may be 0 but for rounding.
    fn is_rounding(self, size: f64) -> bool {
        self.value.abs() <= (ROUNDED_AWAY * self.error).min(MOST_ROUNDED_AWAY * size)
    }
}

/// The symmetric matrix of a block, with half of the linear part as a further column.
struct SquareElimination {
    diagonal: Vec<Remainder>,
    /// By row, the other entries, sorted by column.
    rows: Vec<Vec<(usize, Remainder)>>,
    constant: Remainder,
    is_done: Vec<bool>,
    is_convex: bool,
}

impl SquareElimination {
    fn new(
        names: &[usize],
        products: &[(usize, usize, f64)],
        linear: &[f64],
        constant: Remainder,
        is_convex: bool,
    ) -> Self {
        let n = names.len();
        let mut diagonal = vec![Remainder::new(0.0); n];
        let mut rows: Vec<Vec<(usize, Remainder)>> = vec![Vec::new(); n];
        for &(i, j, q) in products {
            if i == j {
                diagonal[i] = Remainder::new(q);
            } else {
                rows[i].push((j, Remainder::new(0.5 * q)));
                rows[j].push((i, Remainder::new(0.5 * q)));
            }
        }
        for (row, &name) in rows.iter_mut().zip(names) {
            row.sort_unstable_by_key(|entry| entry.0);
            if linear[name] != 0.0 {
                row.push((OF_CONSTANT, Remainder::new(0.5 * linear[name])));
            }
        }
        forget_cancelled(&mut diagonal, &rows);
        // The products of several squares may have cancelled each other.
        for (i, row) in rows.iter_mut().enumerate() {
            row.retain_mut(|(j, entry)| {
                let other = diagonal.get(*j).map_or(constant.size, |of| of.size);
                let squares = (diagonal[i].size * other).sqrt();
                entry.error = entry.error.max(f64::EPSILON * squares);
                !entry.is_rounding(squares)
            });
        }
        SquareElimination { diagonal, rows, constant, is_done: vec![false; n], is_convex }
    }

    /// Completes the next square or product; `None` if there is none.
    fn next(&mut self, names: &[usize], variables: &[Variable]) -> Option<Completed> {
        let variable = |k: usize| variables[names[k]];
        let affine = |lead: Option<usize>, row: &[(usize, Remainder)], divisor: f64| {
            let mut affine = Affine::zero();
            if let Some(k) = lead {
                affine.add_term(1.0, variable(k));
            }
            for &(j, entry) in row {
                match j {
                    OF_CONSTANT => affine.append(&Affine::constant(entry.value / divisor), 1.0),
                    _ => affine.add_term(entry.value / divisor, variable(j)),
                }
            }
            affine
        };
        if let Some(k) = self.next_square() {
            let (coefficient, row) = (self.diagonal[k].value, self.take(k));
            self.subtract(&row, &row, self.diagonal[k]);
            let root = affine(Some(k), &row, coefficient);
            return Some(Completed::Square { coefficient, root, lead: variable(k) });
        }
        let (k, l, half) = self.next_product()?;
        let (mut of_first, mut of_second) = (self.take(k), self.take(l));
        of_first.retain(|entry| entry.0 != l);
        of_second.retain(|entry| entry.0 != k);
        self.subtract(&of_first, &of_second, half);
        self.subtract(&of_second, &of_first, half);
        let factors = [&of_second, &of_first];
        let leads = [k, l];
        let factors = [0, 1].map(|at| affine(Some(leads[at]), factors[at], half.value));
        Some(Completed::Product {
            coefficient: 2.0 * half.value,
            factors,
            leads: leads.map(variable),
        })
    }

    /// The variable whose square comes next: a positive one in a short row, else a negative one.
    fn next_square(&self) -> Option<usize> {
        let places = (0..self.diagonal.len()).filter(|&k| !self.is_done[k]);
        let candidates = places.filter(|&k| {
            let value = self.diagonal[k].value;
            value > 0.0 || value < 0.0 && !self.is_convex
        });
        candidates.min_by_key(|&k| {
            let Remainder { value, size, .. } = self.diagonal[k];
            (value < 0.0, value.abs() < SMALL_PIVOT * size, self.rows[k].len(), k)
        })
    }

    fn next_product(&self) -> Option<(usize, usize, Remainder)> {
        let open = (0..self.rows.len()).filter(|&k| !self.is_done[k] && !self.is_convex);
        open.into_iter().find_map(|k| {
            let of_variables = self.rows[k].iter().filter(|entry| entry.0 != OF_CONSTANT);
            let largest =
                of_variables.max_by(|a, b| a.1.value.abs().total_cmp(&b.1.value.abs()))?;
            Some((k, largest.0, largest.1))
        })
    }

    /// Takes a row out of the matrix.
    fn take(&mut self, k: usize) -> Vec<(usize, Remainder)> {
        self.is_done[k] = true;
        let row = std::mem::take(&mut self.rows[k]);
        for &(i, _) in row.iter().filter(|entry| entry.0 != OF_CONSTANT) {
            if let Ok(at) = self.rows[i].binary_search_by_key(&k, |entry| entry.0) {
                self.rows[i].remove(at);
            }
        }
        row
    }

    /// Subtracts `left right' / divisor`, which is symmetric or half of a symmetric sum, from the
    /// other rows.
    fn subtract(
        &mut self,
        left: &[(usize, Remainder)],
        right: &[(usize, Remainder)],
        divisor: Remainder,
    ) {
        for &(i, a) in left {
            if i == OF_CONSTANT {
                if let Some(&(OF_CONSTANT, b)) = right.last() {
                    self.constant.subtract(a, b, divisor);
                }
                continue;
            }
            let old = std::mem::take(&mut self.rows[i]);
            self.rows[i] = self.merged(i, old, right, (a, divisor));
        }
    }

    /// A row without a multiple of another one. Its diagonal entry is changed in place.
    fn merged(
        &mut self,
        i: usize,
        old: Vec<(usize, Remainder)>,
        other: &[(usize, Remainder)],
        (factor, divisor): (Remainder, Remainder),
    ) -> Vec<(usize, Remainder)> {
        let mut row = Vec::with_capacity(old.len() + other.len());
        let mut old = old.into_iter().peekable();
        for &(j, b) in other {
            while let Some(entry) = old.next_if(|entry| entry.0 < j) {
                row.push(entry);
            }
            if j == i {
                let entry = &mut self.diagonal[i];
                entry.subtract(factor, b, divisor);
                if entry.is_rounding(entry.size) {
                    entry.value = 0.0;
                }
                continue;
            }
            let mut entry = old.next_if(|entry| entry.0 == j).map_or(Remainder::new(0.0), |e| e.1);
            entry.subtract(factor, b, divisor);
            let squares = self.diagonal.get(j).map_or(0.0, |of| of.size * self.diagonal[i].size);
            if !entry.is_rounding(entry.size.max(squares.sqrt())) {
                row.push((j, entry));
            }
        }
        row.extend(old);
        row
    }

    /// Twice what is left of the linear part of a variable.
    fn left_linear(&self, k: usize) -> f64 {
        match self.rows[k].last() {
            Some(&(OF_CONSTANT, entry)) => 2.0 * entry.value,
            _ => 0.0,
        }
    }
}

/// Takes squares for rounding that are nothing beside the products of their variables.
///
/// `q_ii q_jj < q_ij^2` is common in rows that are no sums of squares, but where it is by rounding,
/// one of both squares has cancelled; that of `i`, if `q_jj` agrees with other products.
fn forget_cancelled(diagonal: &mut [Remainder], rows: &[Vec<(usize, Remainder)>]) {
    let square = |k: usize| diagonal[k].size;
    let of_variables = |k: usize| rows[k].iter().filter(|entry| entry.0 != OF_CONSTANT);
    let ratio =
        |k: usize, (j, q): &(usize, Remainder)| square(k) * square(*j) / (q.value * q.value);
    let agrees = |k: usize| of_variables(k).any(|entry| ratio(k, entry) > AGREES);
    let agrees: Vec<bool> = (0..rows.len()).map(agrees).collect();
    let is_cancelled = |k: usize| {
        !agrees[k]
            && of_variables(k)
                .any(|entry| agrees[entry.0] && ratio(k, entry) <= ROUNDED_AWAY * f64::EPSILON)
    };
    let cancelled: Vec<usize> = (0..rows.len()).filter(|&k| is_cancelled(k)).collect();
    cancelled.into_iter().for_each(|k| diagonal[k] = Remainder::new(0.0));
}
