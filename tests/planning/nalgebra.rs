//! Vectors and matrices of `nalgebra`, of fixed and dynamic sizes, there and back.

use carom::ErrorKind;
use carom::hybrid::{LinearSystem, Lqr, Matrix, Region};
use carom::prelude::*;
use nalgebra::{DMatrix, DVector, Matrix2, Matrix2x3, RowVector3, SMatrix, Vector2, Vector4};
use proptest::prelude::*;

use crate::common::config;

fn rows(matrix: &Matrix) -> Vec<Vec<f64>> {
    matrix.to_rows()
}

#[test]
fn all_shapes_go_there_and_back() {
    let fixed = Matrix2x3::new(1.0, 2.0, 3.0, 4.0, 5.0, 6.0);
    let matrix = Matrix::from(fixed);
    assert_eq!(rows(&matrix), [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]);
    assert_eq!(Matrix2x3::try_from(&matrix), Ok(fixed));
    assert_eq!(Matrix2x3::try_from(matrix.clone()), Ok(fixed));
    let dynamic = DMatrix::from_row_slice(2, 3, fixed.transpose().as_slice());
    assert_eq!(DMatrix::from(&matrix), dynamic);
    assert_eq!(DMatrix::from(matrix), dynamic);
    assert_eq!(rows(&Matrix::from(&dynamic)), rows(&Matrix::from(&fixed)));
    // Views, also those that skip entries.
    let columns = Matrix::from(dynamic.columns_with_step(0, 2, 1));
    assert_eq!(rows(&columns), [[1.0, 3.0], [4.0, 6.0]]);
    assert_eq!(rows(&Matrix::from(dynamic.row(1))), [[4.0, 5.0, 6.0]]);
    // Vectors are columns, and rows are rows.
    assert_eq!(rows(&Matrix::from(Vector2::new(7.0, 8.0))), [[7.0], [8.0]]);
    assert_eq!(rows(&Matrix::from(RowVector3::new(7.0, 8.0, 9.0))), [[7.0, 8.0, 9.0]]);
    assert_eq!(DVector::try_from(Matrix::from([[7.0], [8.0]])), Ok(DVector::from(vec![7.0, 8.0])));
    assert_eq!(Vector2::try_from(&Matrix::from([[7.0], [8.0]])), Ok(Vector2::new(7.0, 8.0)));
    // Nothing at all.
    assert_eq!(DMatrix::from(Matrix::zeros(0, 3)).shape(), (0, 3));
    assert_eq!(Matrix::from(DMatrix::<f64>::zeros(2, 0)).ncols(), 0);
    assert_eq!(DVector::try_from(Matrix::zeros(0, 1)).unwrap().len(), 0);
}

#[test]
fn another_shape_is_an_error_that_names_both() {
    let matrix = Matrix::from([[1.0, 2.0], [3.0, 4.0]]);
    let error = SMatrix::<f64, 2, 3>::try_from(&matrix).unwrap_err();
    assert!(matches!(error.kind(), ErrorKind::Shape { rows: 2, columns: 2, .. }));
    let text = error.to_string();
    assert!(text.contains("2 x 3") && text.contains("nalgebra"), "{text}");
    assert!(DVector::try_from(&matrix).unwrap_err().to_string().contains("2 x 1"));
    assert!(Vector4::try_from(matrix).is_err());
}

#[test]
fn systems_regulators_and_regions_take_them() {
    let (a, b) = (Matrix2::new(1.0, 0.1, 0.0, 1.0), Vector2::new(0.005, 0.1));
    let same = LinearSystem::new([[1.0, 0.1], [0.0, 1.0]], [[0.005], [0.1]], [0.0; 2]).unwrap();
    let system = LinearSystem::new(a, b, Vector2::zeros().as_slice()).unwrap();
    assert_eq!((system.a(), system.b()), (same.a(), same.b()));
    let lqr = Lqr::new(&system, Matrix2::identity(), DMatrix::identity(1, 1)).unwrap();
    let gain = SMatrix::<f64, 1, 2>::try_from(&lqr.gain).unwrap();
    let closed = a + b * gain;
    let radius = closed.complex_eigenvalues().iter().map(|e| e.norm()).fold(0.0, f64::max);
    assert!((radius - lqr.spectral_radius).abs() < 1e-9);
    for region in
        [Region::from(Vector2::new(1.0, -2.0)), Region::from(&DVector::from(vec![1.0, -2.0]))]
    {
        assert_eq!(region, Region::point([1.0, -2.0]));
    }
    let goal = DVector::from(vec![1.0, 0.5, 0.0, 0.0]);
    let room = [0.0..=2.0, 0.0..=1.0];
    let body = Body::new("p", &room, 1.0, 1.0).with_start(Vector4::zeros()).with_goal(&goal);
    let same = Body::new("p", &room, 1.0, 1.0).with_start([0.0; 4]).with_goal([1.0, 0.5, 0.0, 0.0]);
    assert_eq!(body, same);
}

proptest! {
    #![proptest_config(config(64, "tests/regressions/nalgebra.txt"))]

    /// No entry is lost or moved, whatever it is.
    #[test]
    fn random_matrices_come_back(rows in 0_usize..6, columns in 0_usize..6, seed in any::<u64>()) {
        let entry = |i: usize, j: usize| f64::from_bits(seed.rotate_left((7 * i + 11 * j) as u32));
        let there = Matrix::from(DMatrix::from_fn(rows, columns, entry));
        let back = DMatrix::from(&there);
        prop_assert_eq!(back.shape(), (rows, columns));
        for (i, j) in (0..rows).flat_map(|i| (0..columns).map(move |j| (i, j))) {
            prop_assert_eq!(back[(i, j)].to_bits(), entry(i, j).to_bits());
        }
    }
}
