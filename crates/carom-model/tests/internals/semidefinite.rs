//! Proofs of convexity against exact `LDL'` in fractions: what is accepted is convex up to units in
//! the last place and what is allowed, and what is refused has the direction that is named.

use carom_model::internals::semidefinite::{Product, negative_direction};
use num_rational::BigRational;
use num_traits::{Signed, Zero};
use proptest::prelude::*;
use proptest::sample::select;

use crate::common::config;

const REGRESSIONS: &str = "tests/regressions/semidefinite.txt";

/// What each square may lack at most, in units in the last place per entry of the longest row.
const UNITS: f64 = 128.0;

fn exact(value: f64) -> BigRational {
    BigRational::from_float(value).expect("a finite number")
}

/// Twice the symmetric matrix of a form.
fn matrix(n: usize, form: &[Product]) -> Vec<Vec<BigRational>> {
    let mut matrix = vec![vec![BigRational::zero(); n]; n];
    for &(i, j, q) in form {
        matrix[i][j] += exact(q);
        matrix[j][i] += exact(q);
    }
    matrix
}

/// Whether a symmetric matrix is positive semidefinite, by elimination.
fn is_semidefinite(mut matrix: Vec<Vec<BigRational>>) -> bool {
    let n = matrix.len();
    for k in 0..n {
        let pivot = matrix[k][k].clone();
        if pivot.is_negative() {
            return false;
        }
        if pivot.is_zero() {
            if matrix[k][k..].iter().any(|entry| !entry.is_zero()) {
                return false;
            }
            continue;
        }
        let own = matrix[k].clone();
        for row in &mut matrix[k + 1..] {
            let factor = &row[k] / &pivot;
            for (entry, own) in row.iter_mut().zip(&own).skip(k + 1) {
                *entry -= &factor * own;
            }
        }
    }
    true
}

/// The form of a symmetric matrix.
fn form(matrix: &[Vec<f64>]) -> Vec<Product> {
    let n = matrix.len();
    let entry = |i: usize, j: usize| if i == j { matrix[i][i] } else { 2.0 * matrix[i][j] };
    let all = (0..n).flat_map(|i| (i..n).map(move |j| (i, j)));
    all.map(|(i, j)| (i, j, entry(i, j))).filter(|(.., q)| *q != 0.0).collect()
}

/// `F F'`, in floats.
fn square(rows: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum();
    rows.iter().map(|a| rows.iter().map(|b| product(a, b)).collect()).collect()
}

/// Checks a verdict exactly. Returns whether the form was accepted.
fn check(n: usize, form: &[Product], allowed: &[f64]) -> Result<bool, TestCaseError> {
    let doubled = matrix(n, form);
    let two = exact(2.0);
    match negative_direction(form, &|j| allowed[j]) {
        None => {
            let mut raised = doubled;
            let units = exact(UNITS * f64::EPSILON * (n + 2) as f64);
            for (j, allowed) in allowed.iter().enumerate() {
                let entry = raised[j][j].clone();
                raised[j][j] += entry.abs() * &units + &two * exact(*allowed);
            }
            prop_assert!(is_semidefinite(raised), "accepted: {:?}", form);
            Ok(true)
        }
        Some(direction) => {
            let (mut value, mut length) = (BigRational::zero(), BigRational::zero());
            for &(i, step) in &direction.steps {
                length += exact(step) * exact(step);
                for &(j, other) in &direction.steps {
                    value += &doubled[i][j] * exact(step) * exact(other);
                }
            }
            prop_assert!(value.is_negative(), "{:?} does not refute {:?}", direction, form);
            let claimed = exact(direction.curvature);
            let off = (&claimed * &length - &value).abs();
            prop_assert!(off <= value.abs() * exact(1e-9), "{:?}: not {}", direction, value);
            Ok(false)
        }
    }
}

/// Rows of a factor with entries of a few digits, each in a unit of its own.
fn factor() -> impl Strategy<Value = Vec<Vec<f64>>> {
    let unit = select(vec![1.0, 1.0, 1.0, 0.1, 1e-3, 1e4, 1e-9, 1e9]);
    let tenths = select(vec![1.0, 0.1, 1.0 / 3.0]);
    (2..=6_usize, 1..=4_usize, tenths).prop_flat_map(move |(n, rank, tenths)| {
        let row = (prop::collection::vec(-9..=9_i32, rank), unit.clone());
        let row = row.prop_map(move |(row, unit)| {
            row.into_iter().map(|entry| f64::from(entry) * tenths * unit).collect()
        });
        prop::collection::vec(row, n)
    })
}

proptest! {
    #![proptest_config(config(200, REGRESSIONS))]

    /// Sums of squares are accepted, whatever their rank and units and however they were rounded.
    #[test]
    fn sums_of_squares_are_convex(rows in factor()) {
        let form = form(&square(&rows));
        prop_assert!(check(rows.len(), &form, &vec![0.0; rows.len()])?, "{:?}", form);
    }

    /// Forms that are a little less, or more, than a sum of squares.
    #[test]
    fn what_is_missing_decides(
        rows in factor(),
        at in 0..6_usize,
        magnitude in -17.0..-5.0,
        less in any::<bool>(),
    ) {
        let (n, mut matrix) = (rows.len(), square(&rows));
        let j = at % n;
        let part = 10.0_f64.powf(magnitude);
        matrix[j][j] *= if less { 1.0 - part } else { 1.0 + part };
        let form = form(&matrix);
        let accepted = check(n, &form, &vec![0.0; n])?;
        prop_assert!(less || accepted, "{:?}", form);
        // What was taken away is allowed, or a tenth of it.
        let mut allowed = vec![0.0; n];
        allowed[j] = 1.1 * part * matrix[j][j];
        prop_assert!(check(n, &form, &allowed)?, "{:?}", form);
        allowed[j] *= 0.1;
        check(n, &form, &allowed)?;
    }

    /// Any symmetric matrix, with entries over many orders of magnitude.
    #[test]
    fn any_form(
        entries in prop::collection::vec((-9..=9_i32, -12..=12_i32), 15),
        n in 1..=5_usize,
        heavy in any::<bool>(),
        far in select(vec![0, 0, 0, 140, -150]),
    ) {
        let mut entries = entries.into_iter().map(|(m, e)| f64::from(m) * 10.0_f64.powi(e + far));
        let mut matrix = vec![vec![0.0; n]; n];
        for (i, j) in (0..n).flat_map(|i| (i..n).map(move |j| (i, j))) {
            matrix[i][j] = entries.next().unwrap_or(0.0);
            matrix[j][i] = matrix[i][j];
        }
        if heavy {
            for (i, row) in matrix.iter_mut().enumerate() {
                row[i] = row.iter().map(|entry| entry.abs()).sum();
            }
        }
        let accepted = check(n, &form(&matrix), &vec![0.0; n])?;
        prop_assert!(!heavy || accepted);
    }
}

/// A unit of a variable, and of the objective, decides nothing.
#[test]
fn units_do_not_matter() {
    for (a, b) in [(1.0, 1.0), (1e-150, 1e140), (1e6, 1e-6), (3e-100, 7e-100)] {
        let form =
            |missing: f64| [(0, 0, a * a), (0, 1, 2.0 * a * b), (1, 1, (1.0 - missing) * b * b)];
        let refused = |missing: f64| negative_direction(&form(missing), &|_| 0.0).is_some();
        assert!(refused(1e-9) && refused(1e-12) && !refused(0.0) && !refused(1e-16), "{a} {b}");
    }
}

/// A curvature of -1 beside one of 2e9 is no rounding of its own coefficient.
#[test]
fn a_small_curvature_beside_a_large_one() {
    let direction = negative_direction(&[(0, 0, 1e9), (0, 1, 1.0), (1, 1, -0.5)], &|_| 0.0);
    let direction = direction.expect("refused");
    assert_eq!((direction.steps, direction.curvature), (vec![(1, 1.0)], -1.0));
    // Where the large one hides it.
    let form = [(0, 0, 2e9), (0, 1, 4.0), (1, 1, 1e-9), (2, 2, 1.0), (1, 2, 1e-9)];
    assert!(negative_direction(&form, &|_| 0.0).is_some());
}

/// What a variable can do within its bounds may be missing, in its own unit.
#[test]
fn what_is_allowed_may_be_missing() {
    let form = [(0, 0, 1.0), (0, 1, 2.0), (1, 1, 1.0 - 1e-9)];
    assert!(negative_direction(&form, &|_| 1e-10).is_some());
    assert!(negative_direction(&form, &|_| 1e-9).is_none());
    assert!(negative_direction(&form, &|j| if j == 1 { 1.1e-9 } else { 0.0 }).is_none());
    assert!(negative_direction(&[(0, 0, -1e-9)], &|_| 1e-10).is_some());
    assert!(negative_direction(&[(0, 0, -1e-9)], &|_| 1e-9).is_none());
    // Fixed variables may lack anything.
    assert!(negative_direction(&[(0, 0, -5.0), (0, 1, 3.0), (1, 1, 2.0)], &|_| f64::MAX).is_none());
}

#[test]
fn products_without_squares() {
    let direction = negative_direction(&[(0, 1, 1.0)], &|_| 0.0).expect("refused");
    assert_eq!((direction.steps, direction.curvature), (vec![(0, 1.0), (1, -1.0)], -1.0));
    assert!(negative_direction(&[(0, 0, 5.0), (0, 1, 1e-9)], &|_| 0.0).is_some());
    assert!(negative_direction(&[(0, 0, 1e300), (0, 1, -1e-300)], &|_| 0.0).is_some());
    assert!(negative_direction(&[], &|_| 0.0).is_none());
    assert!(negative_direction(&[(3, 3, 0.0)], &|_| 0.0).is_none());
}

/// Long chains and grids of differences stay sparse; their matrices are singular.
#[test]
fn differences_of_many_variables() {
    let n = 20_000;
    let chain = |last: f64, weight: &dyn Fn(usize) -> f64| {
        let mut form = Vec::new();
        let mut squares = vec![0.0; n];
        for j in 0..n - 1 {
            // w (x - 1.1 y)^2, so that no row is dominated by its diagonal entry.
            let w = weight(j);
            squares[j] += w;
            squares[j + 1] += w * 1.1 * 1.1;
            form.push((j, j + 1, -2.2 * w));
        }
        squares[n - 1] *= last;
        form.extend(squares.into_iter().enumerate().map(|(j, q)| (j, j, q)));
        form
    };
    let tenths = |j: usize| 0.1 + 0.3 * (j % 7) as f64;
    assert!(negative_direction(&chain(1.0, &tenths), &|_| 0.0).is_none());
    let direction = negative_direction(&chain(0.8, &tenths), &|_| 0.0).expect("refused");
    assert!(direction.curvature < 0.0);
    // A grid: each node four times its value less those of its neighbours, squared.
    let side = 24;
    let mut matrix = vec![vec![0.0; side * side]; side * side];
    for k in 0..side * side {
        let mut row = vec![(k, 4.0)];
        let (i, j) = (k / side, k % side);
        row.extend((i > 0).then(|| (k - side, -1.0)));
        row.extend((i + 1 < side).then(|| (k + side, -1.0)));
        row.extend((j > 0).then(|| (k - 1, -1.0)));
        row.extend((j + 1 < side).then(|| (k + 1, -1.0)));
        for &(a, p) in &row {
            row.iter().for_each(|&(b, q)| matrix[a][b] += p * q);
        }
    }
    assert!(negative_direction(&form(&matrix), &|_| 0.0).is_none());
    matrix[300][300] -= 1.0;
    assert!(negative_direction(&form(&matrix), &|_| 0.0).is_some());
}

/// Dense blocks: low rank, and a little less than that.
#[test]
fn dense_blocks() {
    for (n, rank) in [(40, 3), (500, 5)] {
        let entry = |i: usize, k: usize| ((i * 7 + k * 13) % 101) as f64 / 97.0 - 0.5;
        let rows: Vec<Vec<f64>> =
            (0..n).map(|i| (0..rank).map(|k| entry(i, k * k + 1)).collect()).collect();
        let mut matrix = square(&rows);
        assert!(negative_direction(&form(&matrix), &|_| 0.0).is_none(), "{n}");
        matrix[n / 2][n / 2] *= 1.0 - 1e-9;
        let direction = negative_direction(&form(&matrix), &|_| 0.0).expect("refused");
        assert!(direction.curvature < 0.0 && direction.curvature > -1e-6, "{direction:?}");
        (0..n).for_each(|j| matrix[j][j] *= 1.0 + 1e-6);
        assert!(negative_direction(&form(&matrix), &|_| 0.0).is_none(), "{n}");
    }
}

/// A form takes time and memory for its own variables, not for those before them.
#[test]
fn few_variables_of_many() {
    let far = usize::MAX - 4;
    assert!(
        negative_direction(
            &[(far, far, 1.0), (far, far + 2, 1.0), (far + 2, far + 2, 1.0)],
            &|_| 0.0
        )
        .is_none()
    );
    let Some(direction) = negative_direction(&[(3, far, 1.0), (far, far, 2.0)], &|_| 0.0) else {
        panic!("it is convex")
    };
    let mut names: Vec<usize> = direction.steps.iter().map(|step| step.0).collect();
    names.sort_unstable();
    assert_eq!(names, [3, far]);
}
