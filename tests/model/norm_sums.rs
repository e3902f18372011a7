//! Sums of norms in objectives and rows, and in the costs of programs.

use carom::ErrorKind;
use carom::model::norm;
use carom::prelude::*;
use proptest::prelude::*;

fn optimum(model: &Model) -> (f64, Solution) {
    let solution = BranchAndBound::default().solve(model).unwrap();
    (solution.objective().unwrap(), solution)
}

#[test]
fn a_norm_alone_and_beside_others() {
    let mut model = Model::new("m");
    let [x, y] =
        [model.continuous("x", 3.0, 9.0).unwrap(), model.continuous("y", 4.0, 9.0).unwrap()];
    model.minimize(norm([x, y])).unwrap();
    assert!((optimum(&model).0 - 5.0).abs() < 1e-5);
    model.minimize(norm([x, y]) + 0.5 * x - 1.0).unwrap();
    assert!((optimum(&model).0 - 5.5).abs() < 1e-5);
    model.minimize(2.0 * norm([x, y]) + (x - 3.0).square() + norm([x - 3.0])).unwrap();
    assert!((optimum(&model).0 - 10.0).abs() < 1e-4);
    model.maximize(1.0 - norm([x, y])).unwrap();
    assert!((optimum(&model).0 + 4.0).abs() < 1e-5);
    // Without variables, it is a number.
    model.minimize(norm([Affine::constant(3.0), Affine::constant(-4.0)]) + x).unwrap();
    assert!((optimum(&model).0 - 8.0).abs() < 1e-6);
}

#[test]
fn a_norm_that_is_to_be_large_is_refused() {
    let mut model = Model::new("m");
    let x = model.continuous("x", 0.0, 9.0).unwrap();
    model.minimize(x).unwrap();
    let before = model.to_string();
    let text = |result: Result<(), Error>| result.unwrap_err().to_string();
    let expected = "the row `objective_norm` has a norm that is to be large, which is not convex; a norm \
                    has a factor of at least 0 where it is minimised or limited from above, and of at \
                    most 0 where it is maximised";
    assert_eq!(text(model.minimize(-norm([x]))), expected);
    assert_eq!(text(model.maximize(norm([x]) + x)), expected);
    let squares = model.add("row", (norm([x]) + x.square()).le(1.0)).unwrap_err();
    assert!(squares.to_string().contains("squares or products beside norms"), "{squares}");
    let error = model.minimize(f64::NAN * norm([x])).unwrap_err();
    assert!(matches!(error.kind(), ErrorKind::NotFinite { .. }));
    let mut other = Model::new("other");
    let y = other.continuous("y", 0.0, 1.0).unwrap();
    assert!(matches!(
        model.minimize(norm([y]) + x).unwrap_err().kind(),
        ErrorKind::ForeignHandle { .. }
    ));
    // Nothing is left behind.
    assert_eq!(model.to_string(), before);
}

#[test]
fn sums_over_a_horizon() {
    let mut puck = HybridSystem::new(1.0);
    let [x, y] = [puck.state("x", 0.0, 9.0).unwrap(), puck.state("y", 0.0, 9.0).unwrap()];
    let [u, w] = [puck.input("u", -2.0, 2.0).unwrap(), puck.input("w", -2.0, 2.0).unwrap()];
    puck.mode("slide").unwrap().next([x.is(x + u), y.is(y + w)]).unwrap();
    let mut program = puck.program(4).unwrap();
    program.start([x.equals(0.0), y.equals(0.0)]).unwrap();
    program.goal([x.equals(3.0), y.equals(4.0)]).unwrap();
    let way = program.sum(norm([u, w]) + 0.1 * u).unwrap();
    program.minimize(way).unwrap();
    let plan = program.solve(&mut BranchAndBound::default()).unwrap();
    assert!((plan.solution.objective().unwrap() - 5.3).abs() < 1e-5);
}

/// The sum of weighted distances of a point from others, and what it costs beside it.
fn value(point: [f64; 2], places: &[([f64; 2], f64)], slope: [f64; 2]) -> f64 {
    let lengths = places.iter().map(|(p, w)| w * (point[0] - p[0]).hypot(point[1] - p[1]));
    lengths.sum::<f64>() + slope[0] * point[0] + slope[1] * point[1]
}

fn place() -> impl Strategy<Value = (i32, i32, i32)> {
    (-4..=4, -4..=4, 0..=3)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 60, ..ProptestConfig::default() })]

    /// In an objective and as a row: no point of a grid is better, and the value is that of the
    /// lengths.
    #[test]
    fn sums_of_distances_against_a_grid(
        places in proptest::collection::vec(place(), 1..4),
        slope in (-4..=4, -4..=4),
        as_row in any::<bool>(),
    ) {
        let places: Vec<([f64; 2], f64)> = places
            .into_iter()
            .map(|(x, y, w)| ([f64::from(x), f64::from(y)], 0.5 * f64::from(w)))
            .collect();
        let slope = [0.25 * f64::from(slope.0), 0.25 * f64::from(slope.1)];
        let mut model = Model::new("m");
        let v = model.continuous_family("v", 2, -5.0, 5.0).unwrap();
        let lengths = places.iter().map(|(p, w)| *w * norm([v[0] - p[0], v[1] - p[1]]));
        let sum = lengths.fold(slope[0] * v[0] + slope[1] * v[1] + norm([v[0] - v[0]]), |s, l| s + l);
        if as_row {
            let t = model.continuous("t", -1e3, 1e3).unwrap();
            model.add("sum", sum.le(t)).unwrap();
            model.minimize(t).unwrap();
        } else {
            model.minimize(sum).unwrap();
        }
        let (found, solution) = optimum(&model);
        let point = [solution.value(v[0]).unwrap(), solution.value(v[1]).unwrap()];
        prop_assert!((found - value(point, &places, slope)).abs() < 1e-4);
        for i in -20..=20 {
            for j in -20..=20 {
                let other = [0.25 * f64::from(i), 0.25 * f64::from(j)];
                prop_assert!(value(other, &places, slope) > found - 1e-4);
            }
        }
    }
}
