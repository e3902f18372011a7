//! What a gap is relative to, and how gaps and small numbers are written.

use carom::prelude::*;
use carom::solver::PoolMode;
use proptest::prelude::*;

/// How a program is given its constant.
#[derive(Debug, Clone, Copy)]
enum Constant {
    Stated,
    Fixed,
    FixedSquare,
    TwoThatCancel,
}

/// Covers of a ring or a path: `x_i + x_{i+1} >= 1`. Costs are sevenths, which nothing rounds up.
fn cover(costs: &[u8], ring: bool, maximize: bool, constant: Option<(Constant, f64)>) -> Model {
    let mut model = Model::new("cover");
    let x = model.binary_family("x", costs.len()).unwrap();
    for i in 0..costs.len() {
        let next = (i + 1) % costs.len();
        if ring || (i != 0 && next != 0) {
            model.add(("pair", i), (x[i] + x[next]).ge(1.0)).unwrap();
        }
    }
    let sign = if maximize { -1.0 } else { 1.0 };
    let cost: Affine = x.iter().zip(costs).map(|(x, &c)| sign / 7.0 * f64::from(c) * x).sum();
    let mut cost = Quadratic::from(cost);
    if let Some((kind, size)) = constant {
        let mut one = |value: f64, name: &str| model.continuous(name, value, value).unwrap();
        cost += match kind {
            Constant::Stated => Quadratic::from(size),
            Constant::Fixed => Quadratic::from(size * one(1.0, "one")),
            Constant::FixedSquare => sign * one(size.abs().sqrt().round(), "root").square(),
            Constant::TwoThatCancel => Quadratic::from(3.0 * size * one(1.0, "one") - 2.0 * size),
        };
    }
    if maximize {
        model.maximize(cost).unwrap()
    } else {
        model.minimize(cost).unwrap()
    }
    model
}

fn objective(model: &Model, options: Options) -> f64 {
    let solution = BranchAndBound::new(options).solve(model).unwrap();
    assert!(solution.is_optimal(), "{}\n{model}", solution.termination());
    assert!(solution.relative_gap() <= 1e-6, "{}", solution.relative_gap());
    solution.objective().unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Costs in the last digits of a large constant decide as they do without it.
    #[test]
    fn no_constant_hides_what_a_program_is_about(
        costs in prop::collection::vec(1_u8..20, 3..9),
        ring in any::<bool>(),
        maximize in any::<bool>(),
        kind in prop::sample::select(vec![
            Constant::Stated, Constant::Fixed, Constant::FixedSquare, Constant::TwoThatCancel,
        ]),
        size in prop::sample::select(vec![1e4, -1e6, 1e8, -1e8, 1e10, 1e12]),
        presolve in any::<bool>(),
        pool in 1_usize..3,
    ) {
        let options = Options::default().with_presolve(presolve).with_pool(pool, PoolMode::Best);
        let plain = objective(&cover(&costs, ring, maximize, None), options.clone());
        let with = cover(&costs, ring, maximize, Some((kind, size)));
        let constant = match kind {
            Constant::FixedSquare => size.abs().sqrt().round().powi(2).copysign(plain),
            _ => size,
        };
        let found = objective(&with, options);
        prop_assert!((found - constant - plain).abs() < 0.01, "{} {} {}", found, constant, plain);
    }
}

/// The constant of squares is no reason to stop early: the gap is relative to what is smaller.
#[test]
fn squares_are_as_exact_as_their_sum() {
    let mut model = Model::new("track");
    let x = model.integer_family("x", 4, -50.0, 50.0).unwrap();
    let error = |k: usize| (x[k] + 0.25 * x[(k + 1) % 4] - 30.1).square();
    model.minimize((0..4).map(error).sum::<Quadratic>()).unwrap();
    let solution = BranchAndBound::default().solve(&model).unwrap();
    let all_alike = 4.0 * (1.25_f64 * 24.0 - 30.1).powi(2);
    assert!((solution.objective().unwrap() - all_alike).abs() < 1e-7);
    assert!(solution.gap() <= 1e-7);
}

#[test]
fn gaps_beside_zero_are_small_numbers() {
    let mut model = Model::new("zero");
    let x = model.continuous_family("x", 3, -1.0, 1.0).unwrap();
    let n = model.integer("n", 0.0, 3.0).unwrap();
    model.add("sum", (x[0] + x[1] - 0.3 * n).equals(0.1)).unwrap();
    model.add("same", (x[1] - x[2] + n).ge(0.7)).unwrap();
    let error = (x[0] - 0.4 * n + 0.1).square() + (x[1] + x[2] - 0.2).square();
    model.minimize(error + 1e-9 * x[2]).unwrap();
    let mut log = Log::new(Vec::new());
    let mut lines = |event: &Event| log.record(event);
    let mut control = Control::default().with_progress(&mut lines);
    let solution = BranchAndBound::default().solve_with(&model, &mut control).unwrap();
    log.finish(&solution);
    assert!(solution.is_optimal() && solution.relative_gap() <= 1e-6);
    let text = String::from_utf8(log.into_inner().unwrap()).unwrap();
    for line in text.lines() {
        assert!(line.len() < 160 && !line.contains("0.0000000"), "{text}");
    }
}

#[test]
fn small_numbers_have_exponents() {
    let mut model = Model::new("m");
    let x = model.continuous("x", -0.0, 2e-7).unwrap();
    let y = model.continuous("y", -5e-324, 1.0).unwrap();
    model.add("row", (1e-9 * x + 0.25 * y).le(3.5e-12)).unwrap();
    model.minimize(1.5e-8 * y - 1e-7).unwrap();
    let text = "minimize 1.5e-8 y - 1e-7\nsubject to\n  row: 1e-9 x + 0.25 y <= 3.5e-12\nwhere\n  \
                0 <= x <= 2e-7\n  -5e-324 <= y <= 1\n";
    assert_eq!(model.to_string(), text);
    let error = model.continuous("z", 1e-7, -1e-300).unwrap_err();
    assert_eq!(error.to_string(), "bounds of `z` are crossed: 1e-7 > -1e-300; swap or relax them");
}

/// Proofs over many columns add a large constant last: its rounding is not charged to each of them.
#[test]
fn large_constants_do_not_loosen_proofs() {
    let costs: Vec<u8> = (0..400).map(|k| 1 + (k * 7 % 19) as u8).collect();
    let plain = objective(&cover(&costs, false, false, None), Options::default());
    for kind in [Constant::Stated, Constant::Fixed] {
        let with = cover(&costs, false, false, Some((kind, 1e12)));
        let found = objective(&with, Options::default());
        assert!((found - 1e12 - plain).abs() < 0.01, "{found} {plain}");
    }
}
