//! Costs in the three norms against plain sums and hand-written epigraphs.

use carom::ErrorKind;
use carom::hybrid::{HybridSystem, LinearSystem, Mat, Region, When};
use carom::internals::hybrid::{SystemVariables, Transition};
use carom::interval::Interval;
use carom::prelude::*;
use proptest::prelude::*;

use crate::common::config;

/// Two states and two inputs; both transitions do the same but for their name.
fn system(entries: &[f64]) -> (HybridSystem, LinearSystem) {
    let a = Mat::from_fn(2, 2, |i, j| entries[2 * i + j]);
    let b = Mat::from_fn(2, 2, |i, j| entries[4 + 2 * i + j]);
    let flow = LinearSystem::new(a, b, [0.1, -0.2]).unwrap();
    let system = HybridSystem::new(1.0)
        .with_state("x", Interval::new(-40.0, 40.0))
        .with_state("v", Interval::new(-40.0, 40.0))
        .with_input("a", Interval::new(-1.0, 1.0))
        .with_input("b", Interval::new(-1.0, 1.0))
        .with_transition(Transition::new("go", flow.clone()));
    (system, flow)
}

fn program(system: &HybridSystem, steps: usize, start: &[f64]) -> (Model, SystemVariables) {
    let mut model = Model::new("m");
    let program = system.write(&mut model, "", steps).unwrap();
    program.require(&mut model, "start", &Region::point(start), When::At(0)).unwrap();
    (model, program)
}

fn solved(model: &Model) -> Solution {
    let solution = BranchAndBound::default().solve(model).unwrap();
    assert!(solution.is_optimal(), "{}", solution.termination());
    solution
}

/// `W e` for the 2 x 2 matrix of four numbers.
fn times(weight: &[f64], e: [f64; 2]) -> [f64; 2] {
    [weight[0] * e[0] + weight[1] * e[1], weight[2] * e[0] + weight[3] * e[1]]
}

fn matrix(weight: &[f64]) -> Mat<f64> {
    Mat::from_fn(2, 2, |i, j| weight[2 * i + j])
}

proptest! {
    #![proptest_config(config(30, "tests/regressions/costs.txt"))]

    /// With all inputs fixed, the cost is a plain sum over the run.
    #[test]
    fn the_cost_of_a_run_is_the_plain_sum(
        norm in 0..3_usize,
        entries in prop::collection::vec(-0.9..0.9_f64, 8),
        inputs in prop::collection::vec(-1.0..1.0_f64, 8),
        weights in prop::collection::vec(-2.0..2.0_f64, 12),
        references in prop::collection::vec(-1.0..1.0_f64, 8),
        start in prop::collection::vec(-3.0..3.0_f64, 2),
        has_end in any::<bool>(),
    ) {
        let (system, flow) = system(&entries);
        let (mut model, program) = program(&system, 4, &start);
        for (k, family) in program.inputs().iter().enumerate() {
            for t in 0..4 {
                model.fix(family[t], inputs[2 * t + k]).unwrap();
            }
        }
        // W'W is positive semidefinite.
        let gram = |w: &[f64]| {
            let w = matrix(w);
            w.transpose() * &w
        };
        let [q, r, p] = [&weights[..4], &weights[4..8], &weights[8..]];
        let mut cost = match norm {
            0 => Cost::quadratic(gram(q), gram(r)),
            1 => Cost::one_norm(matrix(q), matrix(r)),
            _ => Cost::infinity_norm(matrix(q), matrix(r)),
        };
        if has_end {
            cost = if norm == 0 { cost.with_terminal(gram(p)) } else { cost.with_terminal(matrix(p)) };
        }
        // The reference of the states changes once, that of the inputs is constant.
        let state_reference = vec![references[..2].to_vec(), references[2..4].to_vec()];
        let cost = cost
            .with_state_reference(state_reference.clone())
            .with_input_reference(references[4..6].to_vec());
        let size = |e: [f64; 2]| match norm {
            0 => e[0] * e[0] + e[1] * e[1],
            1 => e[0].abs() + e[1].abs(),
            _ => e[0].abs().max(e[1].abs()),
        };
        let (mut x, mut sum) = (start.clone(), 0.0);
        for t in 0..=4 {
            let at = &state_reference[t.min(1)];
            let e = [x[0] - at[0], x[1] - at[1]];
            if t == 4 {
                sum += if has_end { size(times(p, e)) } else { 0.0 };
                break;
            }
            let u = &inputs[2 * t..2 * t + 2];
            sum += size(times(q, e));
            sum += size(times(r, [u[0] - references[4], u[1] - references[5]]));
            x = flow.step(&x, u).unwrap();
        }
        let expression = program.add_cost(&mut model, "cost", &cost).unwrap();
        model.minimize(expression.clone()).unwrap();
        let solution = solved(&model);
        let objective = solution.objective().unwrap();
        prop_assert!((objective - sum).abs() <= 1e-5 * sum.max(1.0), "{objective} {sum}");
        if norm > 0 {
            // The variables have these values also where the cost is maximised.
            let affine = expression.affine().clone();
            model.maximize(affine).unwrap();
            let objective = solved(&model).objective().unwrap();
            prop_assert!((objective - sum).abs() <= 1e-5 * sum.max(1.0), "{objective} {sum}");
        }
    }

    /// The optimum is that of a program whose epigraphs are written by hand.
    #[test]
    fn optima_are_those_of_epigraphs_by_hand(
        largest in any::<bool>(),
        entries in prop::collection::vec(-0.9..0.9_f64, 8),
        weights in prop::collection::vec(-2.0..2.0_f64, 8),
        start in prop::collection::vec(-3.0..3.0_f64, 2),
    ) {
        let (system, _) = system(&entries);
        let (mut model, by_library) = program(&system, 5, &start);
        let (q, r) = (&weights[..4], &weights[4..]);
        let cost = match largest {
            true => Cost::infinity_norm(matrix(q), matrix(r)),
            false => Cost::one_norm(matrix(q), matrix(r)),
        };
        let expression =
            by_library.add_cost(&mut model, "cost", &cost.with_terminal(matrix(q))).unwrap();
        model.minimize(expression).unwrap();
        let objective = solved(&model).objective().unwrap();
        prop_assert_eq!(solved(&model).statistics().nodes, 1);

        let (mut model, by_hand) = program(&system, 5, &start);
        let mut sum = Affine::zero();
        let (states, inputs) = (by_hand.states().to_vec(), by_hand.inputs().to_vec());
        for (name, weight, of, samples) in [("e", q, &states, 0..6), ("g", r, &inputs, 0..5)] {
            for t in samples {
                let most: Vec<Variable> = (0..2)
                    .map(|i| model.continuous((format!("{name}{i}"), t), 0.0, 1e3).unwrap())
                    .collect();
                for i in 0..2 {
                    let row = weight[2 * i] * of[0][t] + weight[2 * i + 1] * of[1][t];
                    let above = if largest { most[0] } else { most[i] };
                    model.add((format!("{name}{i}_up"), t), (row.clone() - above).le(0.0)).unwrap();
                    model.add((format!("{name}{i}_down"), t), (row + above).ge(0.0)).unwrap();
                }
                sum += if largest { most[0].into() } else { most[0] + most[1] };
            }
        }
        model.minimize(sum).unwrap();
        let expected = solved(&model).objective().unwrap();
        prop_assert!((objective - expected).abs() <= 1e-5 * expected.max(1.0));
    }
}

#[test]
fn transitions_cost_what_is_said() {
    // Three steps of 1 cost nothing each, a step of 2 costs 5.
    let drive = |by: f64| LinearSystem::new([[1.0]], [[]], [by]).unwrap();
    let system = HybridSystem::new(1.0)
        .with_state("x", Interval::new(0.0, 9.0))
        .with_transition(Transition::new("slow", drive(1.0)))
        .with_transition(Transition::new("fast", drive(2.0)))
        .with_transition(Transition::new("stop", drive(0.0)));
    let (mut model, program) = program(&system, 3, &[0.0]);
    program.require(&mut model, "goal", &Region::point([5.0]), When::At(3)).unwrap();
    let cost = Cost::one_norm([[0.0]], Mat::zeros(0, 0))
        .with_transition_cost("mode", "fast", 5.0)
        .with_transition_cost("mode", "slow", 0.25);
    let expression = program.add_cost(&mut model, "cost", &cost).unwrap();
    model.minimize(expression).unwrap();
    assert!((solved(&model).objective().unwrap() - 10.25).abs() < 1e-6);
}

#[test]
fn costs_that_do_not_fit_are_refused_and_change_nothing() {
    let (system, _) = system(&[0.5; 8]);
    let (mut model, program) = program(&system, 2, &[0.0, 0.0]);
    let one = Mat::<f64>::identity(2, 2);
    let before = model.to_string();
    let mut refused = |cost: Cost| {
        let error = program.add_cost(&mut model, "cost", &cost).unwrap_err();
        assert_eq!(model.to_string(), before);
        error
    };
    let error = refused(Cost::quadratic([[1.0]], &one));
    assert_eq!(error.to_string(), "the weight of the states has shape 1x1; expected 2x2");
    let error = refused(Cost::one_norm(&one, [[1.0]]));
    assert_eq!(error.to_string(), "the weight of the inputs has shape 1x1; expected 2 columns");
    let error = refused(Cost::quadratic(&one, &one).with_terminal([[1.0, 0.0]]));
    assert_eq!(error.to_string(), "the weight of the last sample has shape 1x2; expected 2x2");
    let error = refused(Cost::quadratic(&one, &one).with_state_reference(vec![1.0]));
    assert!(matches!(error.kind(), ErrorKind::Length { found: 1, expected: 2, .. }));
    let error = refused(Cost::quadratic(&one, &one).with_input_reference(Vec::<Vec<f64>>::new()));
    assert!(matches!(error.kind(), ErrorKind::OutOfRange { .. }));
    let error = refused(Cost::quadratic([[f64::NAN, 0.0], [0.0, 1.0]], &one));
    assert!(matches!(error.kind(), ErrorKind::NotFinite { .. }));
    // The norms' variables are taken back when a later part fails.
    let error = refused(Cost::one_norm(&one, &one).with_transition_cost("mode", "fly", 1.0));
    assert!(matches!(error.kind(), ErrorKind::UnknownName { name, .. } if name == "fly"));

    let cost = Cost::infinity_norm(&one, &one);
    program.add_cost(&mut model, "cost", &cost).unwrap();
    let before = model.to_string();
    let error = program.add_cost(&mut model, "cost", &cost).unwrap_err();
    assert!(matches!(error.kind(), ErrorKind::DuplicateName { .. }));
    assert_eq!(model.to_string(), before);
    program.add_cost(&mut model, "other", &cost).unwrap();

    // A quadratic cost that is not convex is refused by the model.
    let cost = Cost::quadratic([[1.0, 0.0], [0.0, -1.0]], &one);
    let expression = program.add_cost(&mut model, "concave", &cost).unwrap();
    let error = model.minimize(expression).unwrap_err();
    assert!(matches!(error.kind(), ErrorKind::NotConvex { .. }));
}
