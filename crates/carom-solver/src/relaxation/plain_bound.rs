//! Bounds in plain floats, where those lose little.
//!
//! The possible rounding error of every sum is subtracted, and the bound is taken if that is
//! slight. A column without the bound that its gradient `g` points to is bounded by its steepness
//! `s`: with `f(x) >= .. + g (x - x̂) + s (x - x̂)^2 / 2`, it adds at least `g x̂ - g^2 / 2 s`.

use crate::presolve::{Reduced, refill};

/// The largest rounding error that may be subtracted from a bound, relative (no unit).
const MAX_CHARGED_ROUNDING: f64 = 1e-10;

/// A sum in plain floats, and what bounds its rounding error.
#[derive(Debug, Clone, Copy, Default)]
struct RoundedSum {
    value: f64,
    /// The sum of the terms' magnitudes, and their number.
    size: f64,
    terms: f64,
}

impl RoundedSum {
    fn add(&mut self, term: f64) {
        self.value += term;
        self.size += term.abs();
        self.terms += 1.0;
    }

    /// Twice what the rounding error can be if the terms are products.
    fn rounding(&self) -> f64 {
        f64::EPSILON * (self.terms + 2.0) * self.size
    }
}

/// The sums of a pair, in memory that the next one uses again.
#[derive(Debug, Default)]
pub(super) struct PlainSums {
    /// By column.
    gradient: Vec<RoundedSum>,
    /// The bound without the terms of the gradient.
    constant: RoundedSum,
    /// The possible error of the bound's terms.
    error: f64,
    /// By column, the least growth of the objective per unit by which the column leaves a bound:
    /// the lower one if the entry is positive, the upper one if it is negative. 0 if no growth is
    /// proved.
    pub(super) slopes: Vec<f64>,
}

impl PlainSums {
    /// The bound that a pair proves; `None` if rounding costs more than a slight part of it, or if
    /// a column has no bound where one is needed.
    ///
    /// # Arguments
    ///
    /// * `y`: without multipliers of missing limits.
    pub(super) fn bound(&mut self, program: &Reduced, x: &[f64], y: &[f64]) -> Option<f64> {
        self.clear(program);
        self.add_objective(program, x);
        self.add_rows(program, y);
        let bound = self.add_columns(program, x, &program.steepness)?;
        // Added last: among the sums, a large offset would enlarge the bound on their rounding.
        let offset = program.offset;
        Some(if offset == 0.0 { bound } else { (offset + bound).next_down() })
    }

    /// The bound that row multipliers prove if the objective is zero: the program has no feasible
    /// point if it is positive. `None` as for [`bound`](Self::bound).
    pub(super) fn certificate(&mut self, program: &Reduced, y: &[f64]) -> Option<f64> {
        self.clear(program);
        self.add_rows(program, y);
        self.add_columns(program, &[], &[])
    }

    fn clear(&mut self, program: &Reduced) {
        refill(&mut self.gradient, program.columns.len(), RoundedSum::default());
        (self.constant, self.error) = (RoundedSum::default(), 0.0);
    }

    /// `q + Px̂` and `-x̂'Px̂ / 2`.
    fn add_objective(&mut self, program: &Reduced, x: &[f64]) {
        let PlainSums { gradient, constant, error, .. } = self;
        for j in 0..x.len() {
            let (rows, entries) = program.quadratic.vector(j);
            for (&i, &p) in rows.iter().zip(entries) {
                gradient[i].add(p * x[j]);
                if i != j {
                    gradient[j].add(p * x[i]);
                }
            }
        }
        for ((g, &x), &q) in gradient.iter_mut().zip(x).zip(&program.linear) {
            if g.terms > 0.0 {
                constant.add(-0.5 * x * g.value);
                *error += 0.5 * x.abs() * g.rounding();
            }
            g.add(q);
        }
    }

    fn add_rows(&mut self, program: &Reduced, y: &[f64]) {
        for (i, &y) in y.iter().enumerate().filter(|(_, y)| **y != 0.0) {
            let (columns, entries) = program.rows.vector(i);
            columns.iter().zip(entries).for_each(|(&j, &a)| self.gradient[j].add(a * y));
            let limit = if y > 0.0 { program.row_upper[i] } else { program.row_lower[i] };
            self.constant.add(-y * limit);
        }
    }

    /// Adds the terms of the gradient and returns the bound.
    ///
    /// # Arguments
    ///
    /// * `x`: the claimed point, for the columns that are steep.
    fn add_columns(&mut self, program: &Reduced, x: &[f64], steepness: &[f64]) -> Option<f64> {
        let PlainSums { gradient, constant, slopes, .. } = self;
        let mut error = self.error;
        refill(slopes, gradient.len(), 0.0);
        for (j, sum) in gradient.iter().enumerate() {
            let (g, slack) = (sum.value, sum.rounding());
            let (lower, upper) = (program.lower[j], program.upper[j]);
            let corner = if g > 0.0 { lower } else { upper };
            let reach = if g.abs() > slack { corner.abs() } else { lower.abs().max(upper.abs()) };
            let steepness = steepness.get(j).copied().unwrap_or(0.0);
            if reach.is_infinite() && slack + g.abs() > 0.0 && steepness > 0.0 {
                constant.add(g * x[j]);
                constant.add(-(g.abs() + slack).powi(2) / (2.0 * steepness));
                error += slack * x[j].abs();
                continue;
            }
            if slack > 0.0 {
                error += 2.0 * slack * reach;
            }
            if g.abs() > slack {
                constant.add(g * corner);
                slopes[j] = (g.abs() - slack).copysign(g);
            }
        }
        // The errors of the terms are as many, and their sum is rounded too.
        let error = error * (1.0 + f64::EPSILON * (constant.terms + 2.0)) + constant.rounding();
        let bound = constant.value - error;
        let is_slight = bound.is_finite() && error <= MAX_CHARGED_ROUNDING * bound.abs().max(1.0);
        is_slight.then(|| bound.next_down())
    }
}
