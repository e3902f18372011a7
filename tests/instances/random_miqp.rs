//! Random dense quadratic programs over a few binaries and free columns, of the kind on which an
//! operator-splitting branch and bound was published. Seeds and numbers are our own.

use carom::prelude::*;

/// Numbers from a seed (SplitMix64).
pub(crate) struct Random(pub(crate) u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ z >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ z >> 31
    }

    /// Within [0, 1).
    pub(crate) fn uniform(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Nearly normal, and the same to the last bit everywhere: twelve uniform numbers less 6.
    pub(crate) fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.uniform()).sum::<f64>() - 6.0
    }

    fn matrix(&mut self, rows: usize, columns: usize, density: f64) -> Vec<Vec<f64>> {
        let mut entry = |_| if self.uniform() < density { self.normal() } else { 0.0 };
        (0..rows).map(|_| (0..columns).map(&mut entry).collect()).collect()
    }
}

/// `columns` columns and rows, `binaries` of the columns binary and the others free.
pub(crate) fn random_miqp(columns: usize, binaries: usize, seed: u64) -> Model {
    let (n, random) = (columns, &mut Random(seed));
    let factor = random.matrix(n, n, 0.4);
    let rows = random.matrix(n, n, 0.4);
    let mut order: Vec<usize> = (0..n).collect();
    for i in (1..n).rev() {
        order.swap(i, random.next() as usize % (i + 1));
    }
    let mut model = Model::new("miqp");
    let mut x = Vec::new();
    for j in 0..n {
        let binary = order[..binaries].contains(&j);
        let (kind, lower, upper) = if binary {
            (VariableKind::Binary, 0.0, 1.0)
        } else {
            (VariableKind::Continuous, f64::NEG_INFINITY, f64::INFINITY)
        };
        x.push(model.variable(("x", j), kind, lower, upper).unwrap());
    }
    let affine = |coefficients: &[f64]| -> Affine {
        let terms = coefficients.iter().zip(&x).filter(|(a, _)| **a != 0.0);
        terms.map(|(&a, &x)| a * x).sum()
    };
    for (i, row) in rows.iter().enumerate() {
        let (lower, upper) = (random.uniform() - 2.0, random.uniform() + 2.0);
        model.add(("row", i), affine(row).within(lower, upper)).unwrap();
    }
    let linear: Vec<f64> = (0..n).map(|_| random.normal()).collect();
    let mut cost = Quadratic::from(affine(&linear));
    for i in 0..n {
        for j in 0..=i {
            let entry: f64 = factor[i].iter().zip(&factor[j]).map(|(a, b)| a * b).sum();
            cost.add_product(if i == j { 0.5 * entry } else { entry }, x[i], x[j]);
        }
    }
    model.minimize(cost).unwrap();
    model
}
