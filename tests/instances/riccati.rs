//! Terminal costs of linear-quadratic control.

/// Rows of numbers.
pub(crate) type Matrix = Vec<Vec<f64>>;

fn product(p: &Matrix, q: &Matrix) -> Matrix {
    let entry = |row: &[f64], j: usize| row.iter().zip(q).map(|(a, b)| a * b[j]).sum();
    p.iter().map(|row| (0..q[0].len()).map(|j| entry(row, j)).collect()).collect()
}

fn transposed(p: &Matrix) -> Matrix {
    (0..p[0].len()).map(|j| p.iter().map(|row| row[j]).collect()).collect()
}

/// `p + sign * q`.
fn sum(p: &Matrix, sign: f64, q: &Matrix) -> Matrix {
    let row = |(p, q): (&Vec<f64>, &Vec<f64>)| p.iter().zip(q).map(|(a, b)| a + sign * b).collect();
    p.iter().zip(q).map(row).collect()
}

/// `X` with `p X = q` for a positive definite `p`, by elimination.
fn solved(mut p: Matrix, mut q: Matrix) -> Matrix {
    let n = p.len();
    for k in 0..n {
        for i in (0..n).filter(|&i| i != k) {
            let factor = p[i][k] / p[k][k];
            for j in 0..n {
                p[i][j] -= factor * p[k][j];
            }
            for j in 0..q[0].len() {
                q[i][j] -= factor * q[k][j];
            }
        }
    }
    let row = |(k, row): (usize, &Vec<f64>)| row.iter().map(|entry| entry / p[k][k]).collect();
    q.iter().enumerate().map(row).collect()
}

/// The solution of the discrete algebraic Riccati equation, by iteration.
pub(crate) fn riccati(a: &Matrix, b: &Matrix, q: &Matrix, r: &Matrix) -> Matrix {
    let (at, bt) = (transposed(a), transposed(b));
    // Symmetric but for rounding, which would grow.
    let symmetric = |p: Matrix| -> Matrix {
        let half = |row: Vec<f64>| row.into_iter().map(|entry| 0.5 * entry).collect();
        sum(&p, 1.0, &transposed(&p)).into_iter().map(half).collect()
    };
    let mut p = q.clone();
    for _ in 0..20_000 {
        let pa = product(&p, a);
        let weight = sum(r, 1.0, &product(&bt, &product(&p, b)));
        let gain = solved(weight, product(&bt, &pa));
        let next = sum(q, 1.0, &product(&at, &pa));
        p = symmetric(sum(&next, -1.0, &product(&transposed(&product(&bt, &pa)), &gain)));
    }
    p
}
