//! Products that are 0 at every point, and the objective with them, without rounding.

use crate::program::Program;

/// `factor (x_column - value) z`, or with `1 - z` if it is off at 0.
#[derive(Debug, Clone)]
pub(super) struct ZeroProduct {
    pub(super) column: usize,
    pub(super) value: f64,
    pub(super) binary: usize,
    pub(super) is_off_at_one: bool,
    pub(super) factor: f64,
    /// The facts that bound the column by the value while the binary is off, and the sides.
    pub(super) facts: Vec<(bool, usize)>,
}

/// The linear part of an objective and its constant, as sums of products of two numbers.
#[derive(Debug, Default)]
pub(super) struct ObjectiveTerms {
    pub(super) linear: Vec<(usize, f64, f64)>,
    pub(super) constant: Vec<(f64, f64)>,
}

impl ObjectiveTerms {
    /// Those of a program.
    pub(super) fn of(program: &Program) -> Self {
        let costs = program.linear.iter().enumerate().filter(|(_, cost)| **cost != 0.0);
        let linear = costs.map(|(j, &cost)| (j, cost, 1.0)).collect();
        ObjectiveTerms { linear, constant: vec![(program.offset, 1.0)] }
    }

    /// The magnitudes of the terms, by column and of the constant.
    pub(super) fn sizes(&self, columns: usize) -> (Vec<f64>, f64) {
        let mut sizes = vec![0.0; columns];
        self.linear.iter().for_each(|&(j, a, b)| sizes[j] += (a * b).abs());
        (sizes, self.constant.iter().map(|(a, b)| (a * b).abs()).sum())
    }

    /// Adds the terms of a product, and returns the factor of `x_column z`.
    pub(super) fn add(&mut self, product: &ZeroProduct) -> f64 {
        let &ZeroProduct { column, value, binary, is_off_at_one, factor, .. } = product;
        if is_off_at_one {
            self.linear.push((binary, -factor, value));
            return factor;
        }
        self.linear.push((binary, factor, value));
        self.linear.push((column, factor, 1.0));
        self.constant.push((-factor, value));
        -factor
    }
}
