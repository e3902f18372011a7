//! Tableaus of the programs that a device solves, with bounds of what the device rounds.
//!
//! Slacks of rows are `s = M l + b` at multipliers l; what follows the rows are functions of them,
//! such as the inputs. The device keeps the same numbers in its own precision. The bound of an
//! entry's error grows with each exchange: of a quotient and a product by what the errors of their
//! factors make of it, and by a rounding each.

use crate::condensed::CondensedProgram;

/// The share for errors of the second order and for rounding in the bounds themselves.
const SECOND_ORDER: f64 = 1.05;

/// The largest error of a divisor, relative, with which errors of the second order are so small.
const LARGEST_RELATIVE_ERROR: f64 = 0.01;

/// An entry, and how far the device may be from it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RoundedEntry {
    pub(crate) value: f64,
    pub(crate) error: f64,
}

/// The tableau of a program: rows, and functions that are never exchanged.
#[derive(Debug, Clone)]
pub(crate) struct ExchangeTableau {
    pub(crate) rows: usize,
    /// Functions behind the rows: inputs, then rows that are not among them, then columns.
    pub(crate) outputs: usize,
    pub(crate) unknown: usize,
    pub(crate) entries: Vec<Vec<RoundedEntry>>,
    /// A constant, and factors of states as shares.
    pub(crate) right: Vec<Vec<f64>>,
    /// The error of the right side on the device, wherever the state is.
    pub(crate) right_error: Vec<f64>,
    /// The relative error of an operation.
    unit: f64,
    /// The range of each state, as shares of the sides.
    reach: Vec<[f64; 2]>,
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// The largest magnitude of a function of the states.
fn size(of: &[f64], reach: &[[f64; 2]]) -> f64 {
    let (mut middle, mut radius) = (of[0], 0.0);
    for (factor, [least, most]) in of[1..].iter().zip(reach) {
        middle += factor * 0.5 * (least + most);
        radius += factor.abs() * 0.5 * (most - least);
    }
    middle.abs() + radius
}

impl ExchangeTableau {
    /// The tableau of all rows and outputs of a program, without errors, and the units in which its
    /// slacks are counted, a row.
    pub(crate) fn new(program: &CondensedProgram) -> Option<(Self, Vec<f64>)> {
        let gradients: Vec<Vec<f64>> = program.rows.iter().map(|row| row.columns.clone()).collect();
        let moves = program.solved(&gradients)?;
        let scales: Vec<f64> =
            gradients.iter().zip(&moves).map(|(g, m)| dot(g, m).sqrt()).collect();
        if scales.iter().any(|scale| scale.is_nan() || *scale <= 0.0) {
            return None;
        }
        let states = program.outputs.first()?.states.len();
        let of_state = |a: usize| program.tilt.iter().map(|tilt| tilt[a]).collect::<Vec<f64>>();
        let pulls = program.solved(&(0..states).map(of_state).collect::<Vec<_>>())?;
        let functions = program.rows.iter().zip(scales.iter().copied());
        let plain = program.outputs.iter().chain(&program.columns).map(|of| (of, 1.0));
        let functions = functions.chain(plain);
        let (mut entries, mut right) = (Vec::new(), Vec::new());
        for (of, own) in functions {
            let entry = |(m, scale): (&Vec<f64>, &f64)| RoundedEntry {
                value: dot(&of.columns, m) / (own * scale),
                error: 0.0,
            };
            entries.push(moves.iter().zip(&scales).map(entry).collect());
            let along = |a: usize| (of.states[a] - dot(&of.columns, &pulls[a])) / own;
            right.push((0..states).map(along).collect());
        }
        let right_error = vec![0.0; right.len()];
        let reach = vec![[0.0, 1.0]; states - 1];
        let (rows, outputs, unknown) = (program.rows.len(), program.outputs.len(), 0);
        Some((
            ExchangeTableau {
                rows,
                outputs,
                unknown,
                entries,
                right,
                right_error,
                unit: 0.0,
                reach,
            },
            scales,
        ))
    }

    /// The same with some rows alone, in this order, the outputs, and then the other rows as
    /// functions.
    pub(crate) fn with_rows(&self, chosen: &[usize]) -> Self {
        let others = (0..self.rows).filter(|row| !chosen.contains(row));
        let columns = self.rows + self.outputs..self.entries.len();
        let order = chosen.iter().copied().chain(self.rows..columns.start);
        let order: Vec<usize> = order.chain(others).chain(columns).collect();
        let of = |&row: &usize| chosen.iter().map(|&j| self.entries[row][j]).collect();
        ExchangeTableau {
            rows: chosen.len(),
            outputs: self.outputs,
            unknown: self.rows - chosen.len(),
            entries: order.iter().map(of).collect(),
            right: order.iter().map(|&row| self.right[row].clone()).collect(),
            right_error: order.iter().map(|&row| self.right_error[row]).collect(),
            unit: self.unit,
            reach: self.reach.clone(),
        }
    }

    /// The tableau as a device of this precision keeps it, in the beginning, for states in these
    /// ranges.
    pub(crate) fn stored(mut self, unit: f64, reach: Vec<[f64; 2]>) -> Self {
        self.unit = unit;
        for entry in self.entries.iter_mut().flatten() {
            entry.error = unit * entry.value.abs();
        }
        for (right, error) in self.right.iter().zip(&mut self.right_error) {
            let factors = right[1..].iter().zip(&reach).map(|(factor, [_, most])| factor * most);
            let sum: f64 = right[0].abs() + factors.map(f64::abs).sum::<f64>();
            *error = (right.len() as f64 + 2.0) * unit * sum * SECOND_ORDER;
        }
        self.reach = reach;
        self
    }

    /// The right side of a row at a state.
    pub(crate) fn right_at(&self, row: usize, shares: &[f64]) -> f64 {
        self.right[row][0] + dot(&self.right[row][1..], shares)
    }

    /// Exchanges a pair. `None` if the errors are too large for that.
    pub(crate) fn exchange(&mut self, p: usize) -> Option<()> {
        let own = self.entries[p].clone();
        let (own_right, own_error) = (self.right[p].clone(), self.right_error[p]);
        let own_size = size(&own_right, &self.reach);
        let RoundedEntry { value: diagonal, error } = own[p];
        if diagonal.is_nan() || error > LARGEST_RELATIVE_ERROR * diagonal.abs() || diagonal == 0.0 {
            return None;
        }
        let relative = error / diagonal.abs() + self.unit;
        for i in (0..self.entries.len()).filter(|i| *i != p) {
            let before = self.entries[i][p];
            let value = before.value / diagonal;
            let error = SECOND_ORDER * (before.error / diagonal.abs() + value.abs() * relative);
            let ratio = RoundedEntry { value, error };
            // Of a difference of an entry and a product.
            let unit = self.unit;
            let rounded = |old_error: f64, factor: f64, factor_error: f64, size: f64| {
                let product =
                    ratio.value.abs() * factor_error + ratio.error * (factor + factor_error);
                SECOND_ORDER * (old_error + product + 2.0 * unit * size)
            };
            for (entry, own) in self.entries[i].iter_mut().zip(&own) {
                let value = entry.value - ratio.value * own.value;
                let size = entry.value.abs() + (ratio.value * own.value).abs();
                entry.error = rounded(entry.error, own.value.abs(), own.error, size);
                entry.value = value;
            }
            self.entries[i][p] = ratio;
            let size_here = size(&self.right[i], &self.reach) + ratio.value.abs() * own_size;
            self.right_error[i] = rounded(self.right_error[i], own_size, own_error, size_here);
            for (right, own) in self.right[i].iter_mut().zip(&own_right) {
                *right -= ratio.value * own;
            }
        }
        let divided = |of: RoundedEntry| RoundedEntry {
            value: -of.value / diagonal,
            error: SECOND_ORDER * (of.error + of.value.abs() * relative) / diagonal.abs(),
        };
        for (j, own) in own.into_iter().enumerate() {
            self.entries[p][j] = divided(own);
        }
        let one = divided(RoundedEntry { value: -1.0, error: 0.0 });
        self.entries[p][p] = one;
        let right = divided(RoundedEntry { value: own_size, error: own_error });
        self.right_error[p] = right.error;
        self.right[p] = own_right.iter().map(|value| -value / diagonal).collect();
        Some(())
    }

    /// The rows that are active at a state, by the method of the device; `None` if it does not end.
    pub(crate) fn active_rows(mut self, shares: &[f64]) -> Option<Vec<bool>> {
        let mut active = vec![false; self.rows];
        for _ in 0..4 * self.rows + 20 {
            let is_negative = |row: &usize| self.right_at(*row, shares) < -1e-10;
            let Some(k) = (0..self.rows).find(is_negative) else { return Some(active) };
            let mut pairs = vec![k];
            if self.entries[k][k].value <= 1e-7 {
                pairs.insert(0, self.entries[k].iter().position(|entry| entry.value > 1e-7)?);
            }
            for p in pairs {
                self.exchange(p)?;
                active[p] = !active[p];
            }
        }
        None
    }
}
