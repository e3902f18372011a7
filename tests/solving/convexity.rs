//! Objectives that are convex, nearly, or not: what is refused, when, and with which direction.

use carom::ErrorKind;
use carom::model::lp;
use carom::prelude::*;

fn refused(result: Result<impl std::fmt::Debug, Error>) -> String {
    let error = result.expect_err("not convex");
    assert!(matches!(error.kind(), ErrorKind::NotConvex { .. }), "{error}");
    error.to_string()
}

const HELP: &str = "within the bounds, a convex form of it loses more than the gap that is asked for; write \
                    squares, give closer bounds or allow a larger gap";

/// A solve of a model that is prepared, which knows the gap.
fn prepared(solver: &mut BranchAndBound, model: &Model) -> Result<Solution, Error> {
    solver.prepare(model)?.solve(&[], &mut Control::default())
}

/// The solve of a model that is read.
fn solved(text: &str) -> Result<Solution, Error> {
    BranchAndBound::default().solve(&lp::read(text)?.model)
}

/// `[ 2 x^2 + 4 x y + 1.999999998 y^2 ] / 2` is -1000 at `(1e6, -1e6)`, and a curvature of -1
/// beside one of 2e9 is no rounding.
#[test]
fn a_slight_negative_curvature_is_refused() {
    let scaled = "Minimize\n obj: [ 2 x ^2 + 4 x * y + 1.999999998 y ^2 ] / 2\nSubject To\n \
                  c: x + y >= -10\nBounds\n -1000000 <= x <= 1000000\n -1000000 <= y <= 1000000\n\
                  Generals\n x y\nEnd\n";
    assert_eq!(
        refused(solved(scaled)),
        format!(
            "the objective is not convex: in the minimize direction its quadratic part has \
             curvature -1.000e-9 along the direction `x` 1, `y` -1; {HELP}"
        )
    );
    let mixed = "Minimize\n obj: [ 2000000000 z ^2 + 2 z * x - 1 x ^2 ] / 2\nSubject To\n \
                 c: x + z >= -20\nBounds\n -10 <= x <= 12\n -1 <= z <= 1\nEnd\n";
    assert!(refused(lp::read(mixed)).contains("curvature -1.000e0 along the direction `x` 1;"));
    // The same where no square says it.
    let hidden = "Minimize\n obj: [ 2000000000 z ^2 + 100000 z * x + x ^2 ] / 2\nBounds\n \
                  -10 <= x <= 12\n -1 <= z <= 1\nEnd\n";
    let hidden = refused(lp::read(hidden));
    assert!(hidden.contains("along the direction `x` 1, `z` -"), "{hidden}");
    let mut model = Model::new("m");
    let x = model.continuous("x", -1e6, 1e6).unwrap();
    let y = model.continuous("y", -1e6, 1e6).unwrap();
    let worse = -1.0 * (x + y).square() + 1e-9 * y.square();
    model.maximize(worse).unwrap();
    let worse = refused(BranchAndBound::default().solve(&model));
    assert!(worse.contains("in the maximize direction"), "{worse}");
}

/// Rounded coefficients of squares, over variables that nothing bounds.
#[test]
fn sums_of_squares_are_accepted_without_bounds() {
    let mut model = Model::new("m");
    let free = |name: &str, model: &mut Model| {
        model.continuous(name, f64::NEG_INFINITY, f64::INFINITY).unwrap()
    };
    let [x, y, z] = ["x", "y", "z"].map(|name| free(name, &mut model));
    let mut seed = 1_u64;
    for _ in 0..300 {
        let mut digit = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            f64::from((seed >> 33) as u32 % 2001) / 100.0 - 10.0
        };
        let one = digit() * x + digit() * y + digit() * z;
        let other = digit() * x - digit() * y + 0.1 * z;
        model.minimize(one.square()).unwrap();
        model.minimize(one.square() + 1e-3 * other.square()).unwrap();
        model.maximize(-0.1 * one.square() - other.square()).unwrap();
    }
    model.add("held", (x + y + z).ge(1.0)).unwrap();
    model.minimize((x - 2.0 * y + 0.1 * z).square() + x).unwrap();
    // Along `(2, 1, 0)` the cost of `x` decides, and nothing limits it.
    let solution = BranchAndBound::default().solve(&model).unwrap();
    assert_eq!(solution.termination(), Termination::Unbounded);
    let one = (x - 2.0 * y + 0.1 * z).square();
    model.minimize(one + (x + 0.7 * z - 3.0).square() + 5.0).unwrap();
    let solution = BranchAndBound::default().solve(&model).unwrap();
    assert!(solution.is_optimal());
    assert!((solution.objective().unwrap() - 5.0).abs() < 1e-5);
}

/// The weights of a portfolio lie between 0 and 1 because they sum up to 1, and the covariances are
/// known to twelve digits.
#[test]
fn bounds_that_rows_imply_decide() {
    let portfolio = |budget: &str| {
        let text = format!(
            "Minimize\n obj: x + [ 0.333333333333 x^2 + 0.666666666667 x * y + 0.333333333333 y^2 ] \
             / 2\nSubject To\n c: x + y {budget} 1\nEnd\n"
        );
        let model = lp::read(&text).expect("a rounded square").model;
        BranchAndBound::default().solve(&model)
    };
    let solution = portfolio("=").unwrap();
    assert!(solution.is_optimal());
    assert!((solution.objective().unwrap() - 1.0 / 6.0).abs() < 1e-6);
    assert!(refused(portfolio(">=")).contains("along the direction `x` 1, `y` -1;"));
}

/// Bounds are those of the solve.
#[test]
fn bounds_may_change() {
    let mut model = Model::new("m");
    let x = model.continuous("x", -0.1, 0.1).unwrap();
    let y = model.continuous("y", -0.1, 0.1).unwrap();
    let form = |x: Variable, y: Variable| (x + y).square() - 1e-9 * y.square();
    model.minimize(form(x, y)).unwrap();
    let mut solver = BranchAndBound::default();
    let solution = solver.solve(&model).unwrap();
    assert!(solution.is_optimal() && solution.objective().unwrap().abs() < 1e-7);
    let copy = model.clone();
    model.set_bounds(x, -1e6, 1e6).unwrap();
    model.set_bounds(y, -1e6, 1e6).unwrap();
    refused(solver.solve(&model));
    refused(prepared(&mut solver, &model));
    assert!(solver.solve(&copy).unwrap().is_optimal());
    // With indicators, which are lowered first.
    let on = model.binary("on").unwrap();
    model.add("i", on.on().implies((x + y).ge(1.0))).unwrap();
    refused(solver.solve(&model));
    // Another objective is another matter.
    model.minimize((x + y).square()).unwrap();
    assert!(solver.solve(&model).unwrap().is_optimal());
}

/// A parameter may take any value of its range.
#[test]
fn parameters_count_with_their_range() {
    let mut model = Model::new("m");
    let x = model.continuous("x", -0.1, 0.1).unwrap();
    let p = model.parameter("p", 0.0, -1e6, 1e6).unwrap();
    let q = model.parameter("q", 0.0, -1e6, 1e6).unwrap();
    refused(model.minimize((p + q).square() - 1e-9 * p.square()));
    // Where `x` cannot follow, nothing is seen of it.
    model.minimize((x + p).square() - 1e-9 * p.square()).unwrap();
    assert!(BranchAndBound::default().solve(&model).unwrap().is_optimal());

    // Rows put the others in terms of one: nothing is seen at its value, and much within its range.
    let mut model = Model::new("m");
    let free = f64::NEG_INFINITY..f64::INFINITY;
    let y = model.continuous("y", free.start, free.end).unwrap();
    let z = model.continuous("z", free.start, free.end).unwrap();
    let p = model.parameter("p", 0.0, -1.0, 1.0).unwrap();
    model.add("y", (y - 1e6 * p).equals(0.0)).unwrap();
    model.add("z", (y + z).equals(0.0)).unwrap();
    model.minimize((y + z).square() - 1e-10 * y.square()).unwrap();
    let mut solver = BranchAndBound::default();
    assert!(solver.solve(&model).unwrap().is_optimal());
    refused(prepared(&mut solver, &model));
}
