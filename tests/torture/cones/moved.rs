//! The same program in other coordinates: continuous columns are shifted, scaled and turned, by
//! numbers that do not round.

use super::case::{ConicCase, Form, Shape};
use crate::common::case::{Column, Line};
use crate::torture::generator::Random;
use carom::prelude::VariableKind;

/// `x = turn y + shift`, with one row a column.
struct Motion {
    turn: Vec<Vec<f64>>,
    shift: Vec<f64>,
}

impl Motion {
    fn form(&self, form: &mut Form) {
        let (coefficients, constant) = self.moved(&form.coefficients);
        form.coefficients = coefficients;
        form.constant += constant;
    }

    fn moved(&self, a: &[f64]) -> (Vec<f64>, f64) {
        let of = |k: usize| a.iter().zip(&self.turn).map(|(a, row)| a * row[k]).sum();
        let constant = a.iter().zip(&self.shift).map(|(a, t)| a * t).sum();
        ((0..a.len()).map(of).collect(), constant)
    }

    fn line(&self, line: &mut Line) {
        let (coefficients, constant) = self.moved(&line.coefficients);
        line.coefficients = coefficients;
        (line.lower, line.upper) = (line.lower - constant, line.upper - constant);
    }
}

impl ConicCase {
    /// The program in coordinates that a seed tells. It has the same optimum.
    pub(crate) fn moved(&self, seed: u64) -> ConicCase {
        let r = &mut Random::new(seed ^ 0x70_0d);
        let n = self.base.columns.len();
        let is_free = |j: &usize| {
            self.base.columns[*j].kind == VariableKind::Continuous && !self.parameters.contains(j)
        };
        let free: Vec<usize> = (0..n).filter(is_free).collect();
        let mut moved = self.clone();
        let mut turn = vec![vec![0.0; n]; n];
        let mut shift = vec![0.0; n];
        (0..n).for_each(|j| turn[j][j] = 1.0);
        let size = 2.0_f64.powi(r.within(-3, 3));
        for &j in &free {
            let unit = self.units[j];
            let scale = size * 2.0_f64.powi(r.within(-1, 1));
            turn[j][j] = scale;
            shift[j] = f64::from(r.within(-8, 8)) * 0.25 * unit;
            let column = &mut moved.base.columns[j];
            column.lower = (column.lower - shift[j]) / scale;
            column.upper = (column.upper - shift[j]) / scale;
            moved.units[j] = unit / scale;
        }
        moved.turn(&free, &mut turn, r);
        let motion = Motion { turn, shift };
        let ConicCase { base, cones, choices, norms, .. } = &mut moved;
        let lines = base.lines.len() - base.columns.len();
        for line in &mut base.lines[..lines] {
            motion.line(line);
        }
        base.switches.iter_mut().for_each(|switch| motion.line(&mut switch.line));
        for square in &mut base.squares {
            let (coefficients, constant) = motion.moved(&square.coefficients);
            square.coefficients = coefficients;
            square.constant += constant;
        }
        let (linear, constant) = motion.moved(&base.linear);
        (base.linear, base.constant) = (linear, base.constant + constant);
        let shape = |shape: &mut Shape| shape.forms().into_iter().for_each(|f| motion.form(f));
        for cone in cones.iter_mut() {
            shape(&mut cone.shape);
            cone.big_m = None;
        }
        for (lines, shapes) in choices.iter_mut().flat_map(|choice| &mut choice.terms) {
            lines.iter_mut().for_each(|line| motion.line(line));
            shapes.iter_mut().for_each(shape);
        }
        norms.iter_mut().flat_map(|norm| &mut norm.1).for_each(|form| motion.form(form));
        // Rows that stand for bounds of turned columns are given in the new columns.
        moved.base.lines.retain(|line| line.coefficients.iter().any(|a| *a != 0.0));
        moved.witness = None;
        moved
    }

    /// Turns two columns whose signs no cone needs, if there are two; adds a row for each column,
    /// one without terms where its bounds stay bounds.
    fn turn(&mut self, free: &[usize], turn: &mut [Vec<f64>], r: &mut Random) {
        let n = self.base.columns.len();
        let mut is_needed = vec![false; n];
        let choices = self.choices.iter().flat_map(|choice| &choice.terms);
        let shapes = choices.flat_map(|(_, shapes)| shapes);
        for shape in shapes.chain(self.cones.iter().map(|cone| &cone.shape)) {
            let heads = match shape {
                Shape::Norm { head, is_squared: true, .. } => vec![head],
                Shape::Product { first, second, .. } => vec![first, second],
                _ => Vec::new(),
            };
            for head in heads {
                head.coefficients.iter().enumerate().for_each(|(j, a)| is_needed[j] |= *a != 0.0);
            }
        }
        let mut none = Line { coefficients: vec![0.0; n], lower: 0.0, upper: 0.0, scale: 1.0 };
        let mut rows = vec![none.clone(); n];
        let usual = free.iter().copied().filter(|&j| !is_needed[j]);
        let is_bounded = |j: usize| {
            let column = self.base.columns[j];
            column.lower.is_finite() && column.upper.is_finite()
        };
        // Conditions have big-Ms, so columns with bounds keep some.
        let with_bounds = r.chance(0.7);
        let usual: Vec<usize> = usual.filter(|&j| is_bounded(j) == with_bounds).collect();
        if let &[i, j, ..] = &usual[..]
            && r.chance(0.7)
        {
            // Five times a rotation, of columns as they are after the change of scale.
            let (p, q) = (turn[i][i], turn[j][j]);
            let bounds = [self.base.columns[i], self.base.columns[j]];
            let factors = [[3.0, -4.0], [4.0, 3.0]];
            (turn[i][i], turn[i][j]) = (3.0 * p, -4.0 * p);
            (turn[j][i], turn[j][j]) = (4.0 * q, 3.0 * q);
            for ((k, bound), [a, b]) in [i, j].into_iter().zip(bounds).zip(factors) {
                none.coefficients = vec![0.0; n];
                (none.coefficients[i], none.coefficients[j]) = (a, b);
                if bound.lower.is_finite() || bound.upper.is_finite() {
                    rows[k] = Line { lower: bound.lower, upper: bound.upper, ..none.clone() };
                }
                // The turned column is `(a x_i + b x_j) / 25`, with the signs of the inverse.
                let [c, d] = if k == i { [3.0, 4.0] } else { [-4.0, 3.0] };
                let ends = |f: f64, of: Column| match f > 0.0 {
                    true => [f * of.lower, f * of.upper],
                    false => [f * of.upper, f * of.lower],
                };
                let (one, two) = (ends(c, bounds[0]), ends(d, bounds[1]));
                let (lower, upper) = ((one[0] + two[0]) / 25.0, (one[1] + two[1]) / 25.0);
                let wider = 1e-9 * (lower.abs().max(upper.abs()) + 1e-30);
                let wider = if wider.is_finite() { wider } else { 0.0 };
                let column = Column { lower: lower - wider, upper: upper + wider, ..bounds[0] };
                self.base.columns[k] = column;
            }
            for k in [i, j] {
                self.units[k] /= 5.0;
            }
        }
        self.base.lines.extend(rows);
    }
}
