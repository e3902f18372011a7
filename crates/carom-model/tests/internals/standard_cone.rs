//! Quadratic rows as cones: the cone holds where the row does, and what is no cone is refused.

use carom::ErrorKind;
use carom::model::{Affine, ConicRow, Quadratic};
use carom::prelude::*;
use carom_model::internals::model::standard_cone;
use proptest::prelude::*;

use crate::common::config;

const REGRESSIONS: &str = "tests/regressions/standard_cone.txt";

/// Most variables of a row.
const MOST: usize = 5;

/// An affine form by its coefficients, the last of which is the constant.
type Form = Vec<i32>;

#[derive(Debug, Clone)]
enum Right {
    Affine(Form),
    Square(Form),
    Product(Form, Form),
}

#[derive(Debug, Clone)]
struct Case {
    squares: Vec<Form>,
    right: Right,
    scale: f64,
}

fn form(low: i32) -> impl Strategy<Value = Form> {
    proptest::collection::vec(low..=3, MOST + 1)
}

fn case() -> impl Strategy<Value = Case> {
    let right = prop_oneof![
        form(-3).prop_map(Right::Affine),
        form(0).prop_map(Right::Square),
        (form(0), form(0)).prop_map(|(a, b)| Right::Product(a, b)),
    ];
    let scale = prop_oneof![Just(1.0), Just(0.1), Just(1e-4), Just(1e5)];
    (proptest::collection::vec(form(-3), 0..4), right, scale)
        .prop_map(|(squares, right, scale)| Case { squares, right, scale })
}

fn affine(form: &Form, x: &[Variable], scale: f64) -> Affine {
    let mut affine = Affine::constant(scale * f64::from(form[MOST]));
    x.iter().zip(form).for_each(|(&v, &a)| affine.add_term(scale * f64::from(a), v));
    affine
}

/// The row, and its left side minus its right side.
fn row(case: &Case, x: &[Variable]) -> (ConicRow, Quadratic) {
    let mut left = Quadratic::zero();
    for square in &case.squares {
        left += affine(square, x, case.scale).square();
    }
    let right = match &case.right {
        Right::Affine(form) => Quadratic::from(affine(form, x, case.scale * case.scale)),
        Right::Square(form) => affine(form, x, case.scale).square(),
        Right::Product(a, b) => affine(a, x, case.scale) * affine(b, x, case.scale),
    };
    (left.le(&right), &left - &right)
}

/// By how much a cone is missed, and the largest number in it, both squared.
fn miss((head, tail): &(Vec<Affine>, Vec<Affine>), at: &dyn Fn(Variable) -> f64) -> (f64, f64) {
    let value = |e: &Affine| e.evaluate(at);
    let size = |e: &Affine| {
        e.terms().iter().map(|&(v, a)| (a * at(v)).abs()).fold(e.offset().abs(), f64::max)
    };
    let squares: f64 = tail.iter().map(|e| value(e).powi(2)).sum();
    let largest = head.iter().chain(tail).map(size).fold(0.0, f64::max);
    let head: Vec<f64> = head.iter().map(value).collect();
    let product = head[0] * head.last().unwrap();
    let least = head.iter().copied().fold(f64::INFINITY, f64::min);
    let miss = if least < 0.0 { (squares - product).max(least * least) } else { squares - product };
    (miss, largest * largest)
}

proptest! {
    #![proptest_config(config(400, REGRESSIONS))]

    #[test]
    fn the_cone_holds_where_the_row_does(
        case in case(),
        points in proptest::collection::vec(proptest::collection::vec(0.0..4.0_f64, MOST), 20),
    ) {
        let mut model = Model::new("m");
        let x = model.continuous_family("x", MOST, 0.0, 4.0).unwrap();
        let x: Vec<Variable> = x.iter().collect();
        let (row, difference) = row(&case, &x);
        let cone = match standard_cone(&model, row.clone()) {
            Ok(cone) => cone,
            // Bounds of single variables may not tell the sign.
            Err(error)
                if matches!(
                    error.kind(),
                    ErrorKind::EmptyRow { .. } | ErrorKind::UnknownSign { .. }
                ) =>
            {
                return Ok(());
            }
            Err(error) => return Err(TestCaseError::fail(format!("{error}"))),
        };
        for point in points {
            let at = |v: Variable| point[v.index()];
            let by = difference.evaluate(at);
            let (miss, size) = miss(&cone, &at);
            let size = size.max(case.scale * case.scale * 1e3);
            if by.abs() > 1e-9 * size {
                prop_assert_eq!(by > 0.0, miss > 0.0, "{} {} {:?}", by, miss, cone);
            }
        }
    }

    /// `a x^2 + b y^2 - m x <= c`: with a large slope `m`, completing the square of `x` would take
    /// the digits of `c`.
    #[test]
    fn steep_slopes_leave_the_constant(
        curvatures in proptest::array::uniform2(-9..=0),
        slope in -3..=3,
        (constant, digits) in (-9..=9, -9..=0),
        points in proptest::collection::vec(proptest::array::uniform2(0.0..1.0_f64), 20),
    ) {
        let mut model = Model::new("m");
        let x = model.continuous_family("x", 2, 0.0, 1.0).unwrap();
        let power = |exponent: i32| 10.0_f64.powi(exponent);
        let [a, b] = curvatures.map(power);
        let (m, c) = (power(slope), f64::from(constant) * power(digits));
        let difference = a * x[0].square() + b * x[1].square() - m * x[0] - c;
        let cone = standard_cone(&model, difference.clone().le(0.0)).unwrap();
        for [first, second] in points.into_iter().chain([[0.0, 0.0], [1.0, 0.0]]) {
            let at = |v: Variable| if v == x[0] { first } else { second };
            let by = difference.evaluate(at);
            let size = a * first * first + b * second * second + m * first + c.abs();
            if by.abs() > 1e-8 * size {
                let (miss, _) = miss(&cone, &at);
                prop_assert_eq!(by > 0.0, miss > 0.0, "{} {} {:?}", by, miss, cone);
            }
        }
    }

    #[test]
    fn two_negative_squares_are_refused(left in form(-3), first in form(1), second in form(1)) {
        let mut model = Model::new("m");
        let x = model.continuous_family("x", MOST + 2, 0.0, 4.0).unwrap();
        let x: Vec<Variable> = x.iter().collect();
        let square = |form: &Form, further: usize| (affine(form, &x, 1.0) + x[further]).square();
        let right = square(&first, MOST) + square(&second, MOST + 1) + x[MOST].square();
        let row = (affine(&left, &x, 1.0) * 0.1).square().le(right);
        let error = standard_cone(&model, row).unwrap_err();
        prop_assert!(matches!(error.kind(), ErrorKind::NotCone { .. }), "{}", error);
    }
}

#[test]
fn rounded_products_are_no_curvature() {
    let mut model = Model::new("m");
    let x = model.continuous_family("x", 3, -1.0, 1.0).unwrap();
    let e = x[0] - 2.0 * x[1] + 0.1 * x[2];
    let (head, tail) = standard_cone(&model, e.square().le(2.0)).unwrap();
    assert_eq!((head.len(), tail.len()), (1, 1));
    let e = 0.1 * x[0] - 0.7 * x[1] + 0.3 * x[2] - 0.9;
    let (head, tail) = standard_cone(&model, e.square().le(2.0)).unwrap();
    assert_eq!((head.len(), tail.len()), (1, 1), "{tail:?}");
    // A plane pair that touches: no room but for the plane.
    let (head, tail) = standard_cone(&model, e.square().le(0.0)).unwrap();
    assert_eq!((head[0].offset(), tail.len()), (0.0, 1), "{head:?}");
}

#[test]
fn many_squares_take_linear_time() {
    let mut model = Model::new("m");
    let x = model.continuous_family("x", 50_000, -1.0, 1.0).unwrap();
    let mut sum = Quadratic::zero();
    x.iter().for_each(|v| sum += v.square());
    let (head, tail) = standard_cone(&model, sum.le(4.0)).unwrap();
    assert_eq!((head[0].offset(), tail.len()), (2.0, 50_000));
    // A chain of differences.
    let mut sum = Quadratic::zero();
    for k in 1..2000 {
        sum += (x[k] - x[k - 1]).square();
    }
    let (head, tail) = standard_cone(&model, sum.le(x[0])).unwrap();
    assert_eq!((head.len(), tail.len()), (2, 1999));
}

#[test]
fn signs_follow_from_any_bounds() {
    let mut model = Model::new("m");
    let x = model.continuous("x", 0.0, 9.0).unwrap();
    let y = model.continuous("y", 0.0, 9.0).unwrap();
    let z = model.continuous("z", -9.0, 9.0).unwrap();
    let low = model.continuous("low", -9.0, -1.0).unwrap();
    let is_cone = |row: ConicRow| standard_cone(&model, row).is_ok();
    assert!(is_cone((x + y - z).square().le(x * y)));
    assert!(is_cone(z.square().le(x * y)));
    assert!(is_cone((x * z).ge(1.0)));
    assert!(is_cone((low * z).ge(1.0)));
    assert!(is_cone(z.square().le(low.square())));
    assert!(is_cone((low * z + x.square() + y.square()).le(-1.0)));
    assert!(!is_cone(x.square().le(z.square())));
    assert!(!is_cone(y.square().le(x * z)));
    assert!(!is_cone(low.square().le(z * x)));
    // Only `x = 0` is left, which a cone says, too.
    assert!(is_cone(z.square().le(low * x)));
}

#[test]
fn cancelling_squares_leave_no_constant() {
    let mut model = Model::new("m");
    let x = model.continuous_family("x", MOST, 0.0, 4.0).unwrap();
    let x: Vec<Variable> = x.iter().collect();
    let case = Case {
        squares: vec![vec![3, 3, 3, 3, 1, 3], vec![-2, 1, -1, -2, 3, -1]],
        right: Right::Product(vec![2, 1, 3, 3, 0, 0], vec![3, 3, 0, 2, 0, 0]),
        scale: 1.0,
    };
    let (row, difference) = row(&case, &x);
    let cone = standard_cone(&model, row).unwrap();
    for value in [0.0, 1.0, 4.0] {
        let by = difference.evaluate(|_| value);
        assert_eq!(by > 0.0, miss(&cone, &|_| value).0 > 0.0, "{by} {cone:?}");
    }
}
