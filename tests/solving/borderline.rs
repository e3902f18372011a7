//! Programs whose points are points up to rounding only, and systems that amplify rounding: the
//! answer is the same in every way of solving.

use crate::torture::families::Path;
use carom::model::lp;
use carom::prelude::*;
use carom::solver::RelaxationMethod;

/// Solves an LP file in all ways, and compares objective and bound with the right value.
fn assert_right(text: &str, value: f64) {
    Path::ALL.into_iter().for_each(|path| assert_right_with(path.options(), text, value));
}

fn assert_right_with(options: Options, text: &str, value: f64) {
    let model = lp::read(text).expect("a readable file").model;
    let mut solver = BranchAndBound::new(options);
    let solution = solver.solve(&model).expect("an answer");
    assert!(solution.is_optimal(), "{:?}: {solution:?}", solver.options());
    let objective = solution.objective().expect("a point");
    let margin = 2e-6 * value.abs().max(1.0);
    assert!((objective - value).abs() <= margin, "{:?}: {objective}", solver.options());
    let bound = solution.bound();
    assert!((bound - value).abs() <= margin, "{:?}: {bound}", solver.options());
    assert_eq!(solution.statistics().contradictions, 0);
}

const CORNER: &str = "Maximize
            obj: - 4 x0 + 3 x1 - 3 x2 + 4 x3 + 1 x4 - 4 x5 - 5 x6
        Subject To
            r0a: 9e-06 x0 + 42 x2 - 0.4 x3 >= 101.0800243
        Bounds
            -1.3 <= x0 <= 2.7
            -2.6 <= x1 <= 1.1999999999999997
            -1.1 <= x2 <= 2.4
            -0.7 <= x3 <= 3
            0 <= x4 <= 1
            0 <= x5 <= 1
            0 <= x6 <= 100000
        End";

/// Without the dual simplex method, which ends at the corner, wider limits show that the bound is
/// one of an empty set.
#[test]
fn an_interior_point_method_finds_the_corner_by_wider_limits() {
    let mut options = Options::default().with_presolve(false);
    options.relaxation = RelaxationMethod::InteriorPoint;
    assert_right_with(options, CORNER, -16.2);
}

/// The only corner misses the row by 1e-15 in doubles. Multipliers of 1e20 proved -115978.4 of the
/// empty set, and `x6`, which no row holds, stayed where it was.
#[test]
fn a_corner_that_is_missed_by_the_last_digit_is_a_point() {
    assert_right(CORNER, -16.2);
    assert_right(
        "Maximize
            obj: - 4 x0 + 1 x1 + 3 x2 - 3 x3 + 5 x4 - 2 x5
        Subject To
            r0b: 4e-06 x0 - 2.8 x1 <= -11.4799976
        Bounds
            0.6 <= x0 <= 1.7000000000000002
            0.2 <= x1 <= 4.1
            0 <= x2 <= 1
            0 <= x3 <= 10
            0 <= x4 <= 100000
            0 <= x5 <= 1
        Generals
            x2 x5
        End",
        500_004.7,
    );
}

/// Ten steps of `x+ = 10 x + u` with `x0 >= 0` make 10 of what is missed by 1e-9 at the start.
#[test]
fn what_is_missed_at_the_start_gains_nothing_at_the_end() {
    let mut model = Model::new("chain");
    let steps = 10;
    let x: Vec<Variable> = (0..=steps)
        .map(|k| {
            let lower = if k % 2 == 0 { f64::NEG_INFINITY } else { -1e6 };
            let upper = if k == 0 { f64::INFINITY } else { 1e6 };
            model.continuous(format!("x{k}"), lower, upper).unwrap()
        })
        .collect();
    model.add("start", x[0].ge(0.0)).unwrap();
    model.add("near", x[0].le(2.0)).unwrap();
    model.add("end", x[steps].le(0.0)).unwrap();
    let mut cost = Affine::from(x[steps]);
    for k in 0..steps {
        let u = if k % 3 == 0 {
            model.integer(format!("u{k}"), 0.0, 2.0).unwrap()
        } else {
            model.continuous(format!("u{k}"), 0.0, 3.0).unwrap()
        };
        model.add(format!("step{k}"), (x[k + 1] - 10.0 * x[k] - 2.0 * u).equals(0.0)).unwrap();
        cost += 0.5 * u;
    }
    model.minimize(cost).unwrap();
    assert_right(&lp::write(&model).unwrap(), 0.0);
}
