//! The matrix exponential against closed forms.

use carom::hybrid::Matrix;
use carom_hybrid::internals::exponential;

fn assert_close(found: &Matrix, wanted: &Matrix, relative: f64) {
    let column = |j| (0..wanted.nrows()).map(|i| f64::abs(wanted[(i, j)])).sum::<f64>();
    let scale = (0..wanted.ncols()).map(column).fold(0.0, f64::max);
    for i in 0..wanted.nrows() {
        for j in 0..wanted.ncols() {
            let miss = (found[(i, j)] - wanted[(i, j)]).abs();
            assert!(miss <= relative * scale, "entry ({i}, {j}) misses by {miss:e}");
        }
    }
}

#[test]
fn nilpotent_matrices_are_exact() {
    let shift = Matrix::from([[0.0, 3.0, 0.0], [0.0, 0.0, 3.0], [0.0, 0.0, 0.0]]);
    let wanted = Matrix::from([[1.0, 3.0, 4.5], [0.0, 1.0, 3.0], [0.0, 0.0, 1.0]]);
    assert_close(&exponential(&shift), &wanted, 1e-15);
}

#[test]
fn rotations_and_poles_match_their_closed_forms() {
    for angle in [1e-6, 0.1, 1.0, 6.0, 30.0] {
        let (sin, cos) = f64::sin_cos(angle);
        let found = exponential(&Matrix::from([[0.0, angle], [-angle, 0.0]]));
        assert_close(&found, &Matrix::from([[cos, sin], [-sin, cos]]), 3e-14);
    }
    for pole in [-30.0, -2.5, 0.0, 1e-9, 4.0, 20.0_f64] {
        assert_close(&exponential(&Matrix::from([[pole]])), &Matrix::from([[pole.exp()]]), 3e-14);
    }
}

#[test]
fn an_empty_matrix_is_its_own_exponential() {
    assert_eq!(exponential(&Matrix::from_fn(0, 0, |_, _| 0.0)).nrows(), 0);
}
