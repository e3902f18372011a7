//! HiGHS as a library: the public suite, agreement with enumeration, what it refuses.
//! `cargo test --features highs --test highs`; it compiles C++ for some minutes.

mod common;

use std::time::Duration;

use carom::ErrorKind;
use carom::conformance::{Capability, Suite};
use carom::highs::HighsSolver;
use carom::prelude::*;
use common::config;
use common::enumeration::optimum;
use common::generate::{Shape, case};
use common::quadratic_program::Minimum;
use proptest::prelude::*;

#[test]
fn it_passes_the_suite() {
    let lacking = [
        Capability::Quadratic,
        Capability::MixedIntegerQuadratic,
        Capability::Cones,
        Capability::InterruptWhileRunning,
        Capability::Events,
    ];
    let suite = Suite::default().without(lacking);
    suite.run(&mut HighsSolver::default()).assert_passed();
    suite.run(&mut HighsSolver::new(Options::default().with_threads(2))).assert_passed();
}

#[test]
fn quadratic_objectives_and_rows_are_refused_in_words() {
    let mut model = Model::new("m");
    let k = model.integer("k", 0.0, 3.0).unwrap();
    model.minimize((k - 1.5).square()).unwrap();
    let error = HighsSolver::default().solve(&model).unwrap_err();
    assert!(matches!(error.kind(), ErrorKind::Unsupported { .. }));
    assert_eq!(
        error.to_string(),
        "HiGHS does not take a quadratic objective; solve it with `BranchAndBound`, or give it a \
         linear one"
    );
    let mut model = Model::new("m");
    let x = model.continuous("x", 0.0, 3.0).unwrap();
    model.add("disc", x.square().le(4.0)).unwrap();
    let error = HighsSolver::default().solve(&model).unwrap_err();
    assert_eq!(
        error.to_string(),
        "HiGHS does not take norms and quadratic rows such as `disc`; solve it with `BranchAndBound`, or \
         write linear rows in their place"
    );
}

/// HiGHS takes 1e-6 for 0, and x trickles through the wall by 1; the certificate moves it back.
#[test]
fn a_point_is_certified_not_believed() {
    let mut model = Model::new("wall");
    let x = model.continuous("x", -1e6, 10.0).unwrap();
    let open = model.binary("open").unwrap();
    model.add("wall", open.off().implies(x.ge(0.0))).unwrap();
    model.minimize(x + 1e9 * open).unwrap();
    let solution = HighsSolver::default().solve(&model).unwrap();
    assert!(solution.verification().is_none_or(|v| v.holds()));
    assert!(solution.value(x).is_ok_and(|x| x.abs() < 1e-6), "{solution:?}");
    assert!(solution.bound() <= solution.objective().unwrap());
}

/// A market split: every row halves weights that have nothing in common, so that rounding, cuts and
/// propagation are of no help and the search is long.
fn long() -> Model {
    let mut model = Model::new("long");
    let n = 50;
    let x = model.binary_family("x", n).unwrap();
    let mut state = 1_u64;
    let mut number = || {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((state >> 33) % 100) as f64
    };
    for k in 0..6 {
        let weights: Vec<f64> = (0..n).map(|_| number()).collect();
        let half = (weights.iter().sum::<f64>() / 2.0).floor();
        let sum = weights.iter().zip(&x).map(|(&weight, x)| weight * x).sum::<Affine>();
        model.add(("split", k), sum.equals(half)).unwrap();
    }
    model.maximize(x.iter().map(|x| number() * x).sum::<Affine>()).unwrap();
    model
}

#[test]
fn limits_leave_a_valid_answer_and_a_usable_solver() {
    let model = long();
    for options in [
        Options::default().with_time_limit(Duration::from_millis(300)),
        Options::default().with_node_limit(1),
    ] {
        let mut solver = HighsSolver::new(options);
        let solution = solver.solve(&model).unwrap();
        assert!(solution.termination().is_limit(), "{:?}", solution.termination());
        assert!(solution.objective().is_none_or(|objective| objective <= solution.bound()));
        *solver.options_mut() = Options::default();
        let mut small = Model::new("small");
        let k = small.integer("k", 0.0, 3.5).unwrap();
        small.maximize(k).unwrap();
        assert_eq!(solver.solve(&small).unwrap().objective(), Some(3.0));
    }
    let interrupt = Interrupt::new();
    interrupt.trigger();
    let mut control = Control::default().with_interrupt(&interrupt);
    let solution = HighsSolver::default().solve_with(&model, &mut control).unwrap();
    assert_eq!(solution.termination(), Termination::Interrupted);
}

proptest! {
    #![proptest_config(config(200, "tests/regressions/highs.txt"))]

    /// Random linear programs with integers and indicators, unbounded ones among them.
    #[test]
    fn it_agrees_with_enumeration(case in case(Shape { quadratic: false, ..Shape::LINEAR })) {
        let (model, _) = case.build();
        let solution = HighsSolver::default().solve(&model).unwrap();
        match optimum(&case) {
            Minimum::Attained { value, .. } => {
                prop_assert!(solution.is_optimal(), "{solution:?}\n{model}");
                let found = case.sign() * solution.objective().unwrap();
                prop_assert!((found - value).abs() < 1e-5 * value.abs().max(1.0), "{found}, {value}");
                let bound = case.sign() * solution.bound();
                prop_assert!(bound <= value + 1e-6 * value.abs().max(1.0), "{bound}, {value}");
                prop_assert_eq!(case.violation(solution.point().unwrap().as_slice(), 1e-6), None);
            }
            Minimum::Infeasible => prop_assert!(solution.is_infeasible(), "{solution:?}\n{model}"),
            Minimum::Unbounded => {
                prop_assert_eq!(solution.termination(), Termination::Unbounded, "{}", model);
            }
        }
    }
}
