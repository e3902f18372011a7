//! Linear-quadratic regulators against closed forms, value iteration and programs.

use carom::hybrid::{LinearSystem, Lqr, Matrix, TerminalError};
use carom::prelude::*;
use proptest::prelude::*;

use crate::common::config;

/// The positive root of `b²p² + (r(1 - a²) - b²q) p - qr = 0`.
fn scalar(a: f64, b: f64, q: f64, r: f64) -> f64 {
    let linear = r * (1.0 - a * a) - b * b * q;
    (-linear + (linear * linear + 4.0 * b * b * q * r).sqrt()) / (2.0 * b * b)
}

fn reason(error: &carom::Error) -> TerminalError {
    let carom::ErrorKind::Terminal(own) = error.kind() else { panic!("{error}") };
    own.clone()
}

proptest! {
    #![proptest_config(config(24, "tests/regressions/lqr.txt"))]

    #[test]
    fn scalar_systems_have_the_closed_form(
        a in -3.0..3.0_f64, b in 0.1..2.0_f64, q in 0.01..10.0_f64, r in 0.01..10.0_f64,
    ) {
        let system = LinearSystem::new([[a]], [[b]], [0.7]).unwrap();
        let lqr = Lqr::new(&system, [[q]], [[r]]).unwrap();
        let p = scalar(a, b, q, r);
        prop_assert!((lqr.cost[(0, 0)] - p).abs() <= 1e-9 * p, "{} {p}", lqr.cost[(0, 0)]);
        let gain = -a * b * p / (r + b * b * p);
        prop_assert!((lqr.gain[(0, 0)] - gain).abs() <= 1e-9);
        prop_assert!((lqr.spectral_radius - (a + b * gain).abs()).abs() <= 1e-9);
    }

    /// The cost of the feedback from a state, summed step by step, is `x'Px`, and no other
    /// feedback near it is better.
    #[test]
    fn the_cost_is_that_of_the_run(
        entries in prop::collection::vec(-1.2..1.2_f64, 9),
        inputs in prop::collection::vec(-1.0..1.0_f64, 6),
        start in prop::collection::vec(-2.0..2.0_f64, 3),
        change in prop::collection::vec(-0.01..0.01_f64, 6),
    ) {
        let a = Matrix::from_fn(3, 3, |i, j| entries[3 * i + j]);
        let b = Matrix::from_fn(3, 2, |i, j| inputs[2 * i + j] + f64::from(u8::from(i == j)));
        let system = LinearSystem::new(a, b, [0.0; 3]).unwrap();
        let (q, r) = ([[1.0, 0.2, 0.0], [0.2, 0.5, 0.0], [0.0, 0.0, 2.0]], [[1.0, 0.1], [0.1, 0.4]]);
        let Ok(lqr) = Lqr::new(&system, q, r) else { return Err(TestCaseError::reject("no")) };
        let cost = |gain: &Matrix| {
            let (mut x, mut sum) = (start.clone(), 0.0);
            for _ in 0..3000 {
                let u: Vec<f64> =
                    (0..2).map(|i| (0..3).map(|j| gain[(i, j)] * x[j]).sum()).collect();
                let squares = |w: &dyn Fn(usize, usize) -> f64, v: &[f64]| -> f64 {
                    let n = v.len();
                    (0..n).map(|i| (0..n).map(|j| w(i, j) * v[i] * v[j]).sum::<f64>()).sum()
                };
                sum += squares(&|i, j| q[i][j], &x) + squares(&|i, j| r[i][j], &u);
                x = system.step(&x, &u).unwrap();
            }
            sum
        };
        prop_assume!(lqr.spectral_radius < 0.99);
        let value: f64 = (0..3)
            .map(|i| (0..3).map(|j| start[i] * lqr.cost[(i, j)] * start[j]).sum::<f64>())
            .sum();
        let run = cost(&lqr.gain);
        prop_assert!((run - value).abs() <= 1e-8 * value.max(1e-6), "{run} {value}");
        let other = Matrix::from_fn(2, 3, |i, j| lqr.gain[(i, j)] + change[3 * i + j]);
        prop_assert!(cost(&other) >= run * (1.0 - 1e-9));
    }
}

#[test]
fn long_programs_cost_what_the_equation_says() {
    let (dt, steps) = (0.2, 80);
    let line = LinearSystem::double_integrator(dt).unwrap();
    let lqr = Lqr::new(&line, [[1.0, 0.0], [0.0, 0.3]], [[0.5]]).unwrap();
    let mut model = Model::new("m");
    let x = model.continuous_family("x", steps + 1, -50.0, 50.0).unwrap();
    let v = model.continuous_family("v", steps + 1, -50.0, 50.0).unwrap();
    let a = model.continuous_family("a", steps, -50.0, 50.0).unwrap();
    for t in 0..steps {
        let predicted = line.predict(&[x[t], v[t]], &[a[t]]).unwrap();
        for ((name, next), value) in [("next x", &x), ("next v", &v)].iter().zip(predicted) {
            model.add((*name, t), next[t + 1].equals(value)).unwrap();
        }
    }
    model.fix(x[0], 3.0).unwrap();
    model.fix(v[0], -1.0).unwrap();
    let stage = |t: usize| x[t].square() + 0.3 * v[t].square() + 0.5 * a[t].square();
    model.minimize((0..steps).map(stage).sum::<Quadratic>()).unwrap();
    let solution = BranchAndBound::default().solve(&model).unwrap();
    let p = &lqr.cost;
    let value = 9.0 * p[(0, 0)] - 6.0 * p[(0, 1)] + p[(1, 1)];
    let objective = solution.objective().unwrap();
    assert!((objective - value).abs() <= 1e-5 * value, "{objective} {value}");
    let first = 3.0 * lqr.gain[(0, 0)] - lqr.gain[(0, 1)];
    assert!((solution.value(a[0]).unwrap() - first).abs() <= 1e-4);
}

#[test]
fn a_system_without_inputs_has_the_cost_of_its_decay() {
    let decay = LinearSystem::new([[0.5]], [[]], [0.0]).unwrap();
    let lqr = Lqr::new(&decay, [[3.0]], Matrix::zeros(0, 0)).unwrap();
    assert!((lqr.cost[(0, 0)] - 4.0).abs() < 1e-12);
    assert_eq!((lqr.gain.nrows(), lqr.gain.ncols()), (0, 1));
}

#[test]
fn what_has_no_regulator_is_refused() {
    let line = LinearSystem::double_integrator(0.1).unwrap();
    let identity = [[1.0, 0.0], [0.0, 1.0]];
    let refused = |system: &LinearSystem, q: [[f64; 2]; 2], r: f64| {
        reason(&Lqr::new(system, q, [[r]]).unwrap_err())
    };
    // The second state grows, and no input moves it.
    let stuck = LinearSystem::new([[0.5, 0.0], [0.0, 1.5]], [[1.0], [0.0]], [0.0; 2]).unwrap();
    let TerminalError::NotStabilisable { magnitude } = refused(&stuck, identity, 1.0) else {
        panic!("not stabilisable")
    };
    assert!((magnitude - 1.5).abs() < 1e-9);
    // A turning pair of states that no input moves.
    let (sin, cos) = 0.3_f64.sin_cos();
    let turning = [[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 0.5]];
    let turning = LinearSystem::new(turning, [[0.0], [0.0], [1.0]], [0.0; 3]).unwrap();
    let three = Matrix::identity(3);
    let error = Lqr::new(&turning, &three, [[1.0]]).unwrap_err();
    assert!(matches!(reason(&error), TerminalError::NotStabilisable { .. }));
    // The cost does not see the position, which stays where it is.
    let blind = refused(&line, [[0.0, 0.0], [0.0, 1.0]], 1.0);
    assert!(matches!(blind, TerminalError::NotDetectable { .. }));
    let skew = refused(&line, [[1.0, 0.5], [0.0, 1.0]], 1.0);
    assert_eq!(skew, TerminalError::NotSymmetric { weight: "Q" });
    let negative = refused(&line, [[1.0, 0.0], [0.0, -1.0]], 1.0);
    assert!(matches!(negative, TerminalError::Indefinite { weight: "Q", eigenvalue: -1.0 }));
    let free = refused(&line, identity, 0.0);
    assert!(matches!(free, TerminalError::Indefinite { weight: "R", .. }));
    let error = Lqr::new(&line, [[1.0]], [[1.0]]).unwrap_err();
    assert_eq!(error.to_string(), "the weight Q has shape 1x1; expected 2x2");
}
