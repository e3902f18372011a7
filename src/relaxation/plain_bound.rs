//! Bounds in plain floats, where those lose little.
//!
//! The possible rounding error of every sum is subtracted, and the bound is taken if that is slight.
//! A column without the bound that its gradient `g` points to is bounded by its steepness `s`: with
//! `f(x) >= .. + g (x - x̂) + s (x - x̂)^2 / 2`, it adds at least `g x̂ - g^2 / 2 s`.

use crate::presolve::Reduced;

/// A rounding error that a bound may be charged with, relative (no unit).
const SLIGHT: f64 = 1e-10;

/// A proved bound, and the gradient that it is proved with.
pub(super) struct PlainBound {
    pub(super) bound: f64,
    /// By column, the least growth of the objective per unit by which the column leaves the bound that
    /// its sign tells; 0 where nothing is proved.
    pub(super) slopes: Vec<f64>,
}

/// The bound that a pair proves; `None` if rounding costs more than a slight part of it, or if a column
/// has no bound where one is needed.
///
/// # Arguments
///
/// * `y`: without multipliers of missing limits.
pub(super) fn plain_bound(program: &Reduced, x: &[f64], y: &[f64]) -> Option<PlainBound> {
    let mut sums = Sums::of_objective(program, x);
    sums.add_rows(program, y);
    sums.bound(program, x)
}

/// The rounding error of a sum of so many products, relative to the sum of their magnitudes: twice what it
/// can be.
fn rounding(terms: f64) -> f64 {
    f64::EPSILON * (terms + 2.0)
}

/// A sum, that of its terms' magnitudes, the number of terms, and the error of the terms themselves.
#[derive(Debug, Clone, Copy, Default)]
struct Sum {
    value: f64,
    size: f64,
    terms: f64,
    error: f64,
}

impl Sum {
    fn add(&mut self, term: f64) {
        self.value += term;
        self.size += term.abs();
        self.terms += 1.0;
    }
}

/// The sums of a pair: the gradient by columns, and the constant part of the bound.
struct Sums {
    value: Vec<f64>,
    size: Vec<f64>,
    terms: Vec<f64>,
    constant: Sum,
}

impl Sums {
    /// `q + Px̂` and `offset - x̂'Px̂ / 2`.
    fn of_objective(program: &Reduced, x: &[f64]) -> Self {
        let n = x.len();
        let (value, size, terms) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
        let mut sums = Sums { value, size, terms, constant: Sum::default() };
        for j in 0..n {
            let (rows, entries) = program.quadratic.vector(j);
            for (&i, &p) in rows.iter().zip(entries) {
                sums.add(i, p * x[j]);
                if i != j {
                    sums.add(j, p * x[i]);
                }
            }
        }
        sums.constant.add(program.offset);
        for (j, &x) in x.iter().enumerate().filter(|(j, _)| sums.terms[*j] > 0.0) {
            sums.constant.add(-0.5 * x * sums.value[j]);
            sums.constant.error += 0.5 * x.abs() * sums.slack(j);
        }
        program.linear.iter().enumerate().for_each(|(j, &q)| sums.add(j, q));
        sums
    }

    fn add_rows(&mut self, program: &Reduced, y: &[f64]) {
        for (i, &y) in y.iter().enumerate().filter(|(_, y)| **y != 0.0) {
            let (columns, entries) = program.rows.vector(i);
            columns.iter().zip(entries).for_each(|(&j, &a)| self.add(j, a * y));
            self.constant
                .add(-y * if y > 0.0 { program.row_upper[i] } else { program.row_lower[i] });
        }
    }

    fn add(&mut self, j: usize, term: f64) {
        self.value[j] += term;
        self.size[j] += term.abs();
        self.terms[j] += 1.0;
    }

    /// The possible rounding error of an entry of the gradient.
    fn slack(&self, j: usize) -> f64 {
        rounding(self.terms[j]) * self.size[j]
    }

    fn bound(mut self, program: &Reduced, x: &[f64]) -> Option<PlainBound> {
        let mut slopes = vec![0.0; x.len()];
        for j in 0..x.len() {
            let (g, slack) = (self.value[j], self.slack(j));
            let (lower, upper) = (program.lower[j], program.upper[j]);
            let corner = if g > 0.0 { lower } else { upper };
            let reach = if g.abs() > slack { corner.abs() } else { lower.abs().max(upper.abs()) };
            let steepness = steepness(program, j);
            if reach.is_infinite() && slack + g.abs() > 0.0 && steepness > 0.0 {
                self.constant.add(g * x[j]);
                self.constant.add(-(g.abs() + slack).powi(2) / (2.0 * steepness));
                self.constant.error += slack * x[j].abs();
                continue;
            }
            if slack > 0.0 {
                self.constant.error += 2.0 * slack * reach;
            }
            if g.abs() > slack {
                self.constant.add(g * corner);
                slopes[j] = (g.abs() - slack).copysign(g);
            }
        }
        let Sum { value, size, terms, error } = self.constant;
        let error = error * (1.0 + rounding(terms)) + rounding(terms) * size;
        let bound = value - error;
        let is_slight = bound.is_finite() && error <= SLIGHT * bound.abs().max(1.0);
        is_slight.then(|| PlainBound { bound: bound.next_down(), slopes })
    }
}

fn steepness(program: &Reduced, j: usize) -> f64 {
    program.steepness.get(j).copied().unwrap_or(0.0)
}
