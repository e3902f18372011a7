//! Random small programs, kept as plain numbers beside the model.

use carom::prelude::*;
use proptest::prelude::*;

/// `min 1/2 sum s_j (x_j - c_j)^2 + sum q_j x_j` over `A (x, t) <= b`, columns in [-2, 2] or
/// binary.
#[derive(Debug, Clone)]
pub(crate) struct Program {
    pub(crate) axes: usize,
    pub(crate) columns: usize,
    pub(crate) binaries: usize,
    pub(crate) squares: Vec<f64>,
    pub(crate) linear: Vec<f64>,
    /// Coefficients of continuous columns, binaries, axes; right side.
    pub(crate) rows: Vec<(Vec<f64>, f64)>,
}

pub(crate) struct Built {
    pub(crate) model: Model,
    pub(crate) axes: Vec<Variable>,
    pub(crate) outputs: Vec<Variable>,
}

pub(crate) fn programs() -> impl Strategy<Value = Program> {
    (1..=3_usize, 1..=3_usize, 1..=4_usize, 1..=5_usize, any::<bool>()).prop_flat_map(
        |(axes, columns, binaries, rows, is_curved)| {
            let n = columns + binaries;
            let digit = || (-8..=8_i32).prop_map(|k| f64::from(k) / 4.0);
            let square = (1..=4_i32).prop_map(move |k| if is_curved { f64::from(k) } else { 0.0 });
            let row = (prop::collection::vec(digit(), n + axes), (-2..=8_i32).prop_map(f64::from));
            (
                prop::collection::vec(square, columns),
                prop::collection::vec(digit(), n),
                prop::collection::vec(row, rows),
            )
                .prop_map(move |(squares, linear, rows)| Program {
                    axes,
                    columns,
                    binaries,
                    squares,
                    linear,
                    rows: rows.into_iter().map(|(a, b)| (a, b / 2.0)).collect(),
                })
        },
    )
}

impl Program {
    pub(crate) fn build(&self) -> Built {
        let mut model = Model::new("random");
        let mut axes = Vec::new();
        for a in 0..self.axes {
            axes.push(model.parameter(("t", a), 0.0, -1.0, 1.0).unwrap());
        }
        let mut outputs = Vec::new();
        for j in 0..self.columns {
            outputs.push(model.continuous(("x", j), -2.0, 2.0).unwrap());
        }
        for j in 0..self.binaries {
            outputs.push(model.binary(("b", j)).unwrap());
        }
        let all: Vec<Variable> = outputs.iter().chain(&axes).copied().collect();
        for (i, (a, b)) in self.rows.iter().enumerate() {
            let mut sum = Affine::default();
            all.iter().zip(a).for_each(|(v, a)| sum += *a * *v);
            model.add(("row", i), sum.le(*b)).unwrap();
        }
        let mut cost = Quadratic::default();
        for (j, s) in self.squares.iter().enumerate() {
            // Towards the first axis.
            let apart: Affine = outputs[j] - 0.5 * axes[0];
            cost += 0.5 * *s * apart.square();
        }
        outputs.iter().zip(&self.linear).for_each(|(v, q)| cost += *q * *v);
        model.minimize(cost).unwrap();
        Built { model, axes, outputs }
    }

    /// The cost of a point, and the largest violation of a row.
    pub(crate) fn judge(&self, x: &[f64], t: &[f64]) -> (f64, f64) {
        let all: Vec<f64> = x.iter().chain(t).copied().collect();
        let dot = |a: &[f64]| a.iter().zip(&all).map(|(a, x)| a * x).sum::<f64>();
        let missed = self.rows.iter().map(|(a, b)| dot(a) - b).fold(0.0, f64::max);
        let square = |(s, x): (&f64, &f64)| 0.5 * s * (x - 0.5 * t[0]).powi(2);
        let squares: f64 = self.squares.iter().zip(x).map(square).sum();
        (squares + dot(&self.linear), missed)
    }
}
