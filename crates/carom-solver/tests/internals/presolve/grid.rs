//! Small programs all of whose points on a grid can be listed: binaries, then an integer, then two
//! continuous columns in steps of a half.

use carom::prelude::*;
use proptest::prelude::*;

/// The upper bound of all columns that are not binary.
pub(crate) const TOP: f64 = 3.0;

/// A row: coefficients, lower and upper limit.
pub(crate) type GridRow = (Vec<i8>, Option<i8>, Option<i8>);

#[derive(Debug, Clone)]
pub(crate) struct Grid {
    pub(crate) binaries: usize,
    pub(crate) rows: Vec<GridRow>,
    pub(crate) cost: Vec<i8>,
}

/// Columns of a grid with so many binaries.
pub(crate) const fn columns(binaries: usize) -> usize {
    binaries + 3
}

/// A row of any kind.
pub(crate) fn general(binaries: usize) -> impl Strategy<Value = GridRow> {
    let parts = (prop::collection::vec(-4i8..=5, columns(binaries)), -3i8..=9, any::<bool>());
    parts.prop_map(
        |(row, limit, below)| {
            if below { (row, None, Some(limit)) } else { (row, Some(limit - 6), None) }
        },
    )
}

/// An equality.
pub(crate) fn balance(binaries: usize) -> impl Strategy<Value = GridRow> {
    (prop::collection::vec(-1i8..=1, columns(binaries)), -1i8..=2)
        .prop_map(|(row, at)| (row, Some(at), Some(at)))
}

/// Some of the binaries, without limits.
pub(crate) fn some_binaries(binaries: usize) -> impl Strategy<Value = Vec<i8>> {
    prop::collection::vec(0i8..=1, binaries).prop_map(move |mut row| {
        row.resize(columns(binaries), 0);
        row
    })
}

/// A grid of these rows, but for empty ones.
pub(crate) fn grid(
    binaries: usize,
    rows: impl Strategy<Value = Vec<GridRow>>,
) -> impl Strategy<Value = Grid> {
    let cost = prop::collection::vec(-3i8..=3, columns(binaries));
    (rows, cost).prop_map(move |(rows, cost)| {
        let rows = rows.into_iter().filter(|(row, ..)| row.iter().any(|a| *a != 0)).collect();
        Grid { binaries, rows, cost }
    })
}

impl Grid {
    pub(crate) fn columns(&self) -> usize {
        columns(self.binaries)
    }

    pub(crate) fn model(&self) -> Model {
        let mut model = Model::new("grid");
        let mut variables = Vec::new();
        for j in 0..self.columns() {
            let name = format!("v{j}");
            variables.push(match j {
                j if j < self.binaries => model.binary(name).unwrap(),
                j if j == self.binaries => model.integer(name, 0.0, TOP).unwrap(),
                _ => model.continuous(name, 0.0, TOP).unwrap(),
            });
        }
        let sum = |row: &[i8]| -> Affine {
            variables.iter().zip(row).map(|(&v, &a)| f64::from(a) * v).sum()
        };
        for (i, (row, lower, upper)) in self.rows.iter().enumerate() {
            let lower = lower.map_or(f64::NEG_INFINITY, f64::from);
            let upper = upper.map_or(f64::INFINITY, f64::from);
            model.add(format!("r{i}"), sum(row).within(lower, upper)).unwrap();
        }
        model.minimize(sum(&self.cost)).unwrap();
        model
    }

    /// The grid points that satisfy the rows.
    pub(crate) fn points(&self) -> Vec<Vec<f64>> {
        let mut points = vec![Vec::new()];
        for j in 0..self.columns() {
            let (top, step) = match j {
                j if j < self.binaries => (1.0, 1.0),
                j if j == self.binaries => (TOP, 1.0),
                _ => (TOP, 0.5),
            };
            let values: Vec<f64> = (0..=(top / step) as u32).map(|k| f64::from(k) * step).collect();
            points = points
                .into_iter()
                .flat_map(|p| values.iter().map(move |&v| [&p[..], &[v]].concat()))
                .collect();
        }
        points.retain(|p| {
            self.rows.iter().all(|(row, lower, upper)| {
                let sum = sum(row, p);
                lower.is_none_or(|l| f64::from(l) <= sum)
                    && upper.is_none_or(|u| sum <= f64::from(u))
            })
        });
        points
    }
}

fn sum(row: &[i8], point: &[f64]) -> f64 {
    row.iter().zip(point).map(|(&a, v)| f64::from(a) * v).sum()
}
