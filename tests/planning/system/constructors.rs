//! Systems from what people have: polyhedra, matrices, a ball, a thermostat.

use carom::ErrorKind;
use carom::hybrid::{
    HybridSystem, IllPosedness, LinearSystem, Matrix, MixedLogicalDynamical, Restitution,
    SimulationOptions,
};
use carom::interval::Interval;
use carom::prelude::*;
use carom_hybrid::internals::HasParts;
use proptest::prelude::*;

use crate::common::config;

/// x⁺ = 0.8 x + u for x >= 0 and -0.8 x + u for x <= 0, by the product z = δ x.
fn folded() -> MixedLogicalDynamical {
    let range = Interval::new(-10.0, 10.0);
    MixedLogicalDynamical::new([0.0], [10.0, 0.0, 0.0, 0.0, 10.0, 10.0])
        .with_states([("x", range)], [[-0.8]], [[1.0], [-1.0], [0.0], [0.0], [1.0], [-1.0]])
        .with_inputs([("u", Interval::new(-1.0, 1.0))], [[1.0]], [[0.0]; 6])
        .with_binaries(1, [[0.0]], [[10.0], [-10.0], [-10.0], [-10.0], [10.0], [10.0]])
        .with_auxiliaries([range], [[1.6]], [[0.0], [0.0], [1.0], [-1.0], [1.0], [-1.0]])
}

#[test]
fn products_are_eliminated() {
    let system = HybridSystem::mixed_logical_dynamical(1.0, &folded()).unwrap();
    assert_eq!((system.parts().inputs.len(), system.parts().choices[0].transitions.len()), (1, 2));
    for transition in &system.parts().choices[0].transitions {
        let sign = if transition.name == "1" { 1.0 } else { -1.0 };
        assert!((transition.flow.a()[(0, 0)] - 0.8 * sign).abs() < 1e-12);
        assert_eq!(transition.guards.len(), 1);
        assert_eq!(transition.guards[0].normal, [-sign, 0.0]);
    }
    assert_eq!(system.well_posedness(&mut BranchAndBound::default()).unwrap(), []);
    for x in [-7.0, -0.5, 0.5, 8.0_f64] {
        let run = system.simulate(&[x], &[[0.25]]).unwrap();
        assert!((run.last()[0] - 0.8 * x.abs() - 0.25).abs() < 1e-12);
        assert_eq!(run.steps[0].moves, 1);
    }
}

#[test]
fn free_auxiliaries_become_inputs() {
    // x⁺ = 0.5 x + z with z between 0 and 2 δ, and δ free: z is not determined.
    let range = Interval::new(-4.0, 4.0);
    let mld = MixedLogicalDynamical::new([0.0], [0.0, 0.0])
        .with_states([("x", range)], [[0.5]], [[0.0]; 2])
        .with_binaries(1, [[0.0]], [[-2.0], [0.0]])
        .with_auxiliaries([Interval::new(0.0, 3.0)], [[1.0]], [[1.0], [-1.0]]);
    let system = HybridSystem::mixed_logical_dynamical(1.0, &mld).unwrap();
    assert_eq!(system.parts().inputs[0].0, "z0");
    let run = system.simulate(&[1.0], &[[2.0]]).unwrap();
    assert_eq!((run.taken(), run.last()), (vec![vec!["1".to_owned()]], &[2.5][..]));
    assert!(!system.simulate(&[1.0], &[[2.5]]).unwrap().is_complete());
}

#[test]
fn outputs_have_names() {
    // y = 2 x + u + 3 δ - z + 1 with z = x where δ, and a second output that is the same
    // everywhere.
    let outputs = |mld: MixedLogicalDynamical| {
        let d = [[1.0, 3.0, -1.0], [0.5, 0.0, 0.0]];
        mld.with_outputs(["y", "twice"], [[2.0], [2.0]], d, [1.0, 0.0])
    };
    let system = HybridSystem::mixed_logical_dynamical(1.0, &outputs(folded())).unwrap();
    let y = |x: f64, u: f64| 2.0 * x + u + if x > 0.0 { 4.0 - x } else { 1.0 };
    for (x, u) in [(5.0, -1.0), (-3.0, 0.25)] {
        let run = system.simulate(&[x], &[[u]]).unwrap();
        let outputs = &run.steps[0].outputs;
        assert_eq!(
            outputs.iter().map(|(name, _)| name.as_str()).collect::<Vec<_>>(),
            ["y", "twice"]
        );
        assert!((outputs[0].1 - y(x, u)).abs() < 1e-12 && outputs[1].1 == 2.0 * x + 0.5 * u);
    }
    // As rows: the least y over three steps.
    let mut model = Model::new("outputs");
    let program = system.write(&mut model, "", 3).unwrap();
    model.fix(program.states()[0][0], -4.0).unwrap();
    let total: Affine = program.output("y").unwrap().iter().sum();
    model.minimize(total).unwrap();
    let solution = BranchAndBound::default().solve(&model).unwrap();
    let (run, _) = program.certified(&solution).unwrap();
    let (x, u) = (run.state("x").unwrap(), run.input("u").unwrap());
    let expected = |t: usize| y(x[t], u[t]);
    for (t, value) in run.output("y").unwrap().iter().enumerate() {
        assert!((value - expected(t)).abs() < 1e-6, "step {t}");
    }
    let mut wrong = run.clone();
    wrong.outputs[0].1[1] += 1e-3;
    assert!(system.certify(&wrong).unwrap_err().to_string().contains("the output `y` in step 1"));

    // An output of an auxiliary that stays an input.
    let range = Interval::new(-4.0, 4.0);
    let mld = MixedLogicalDynamical::new([0.0], [0.0])
        .with_states([("x", range)], [[0.5]], [[0.0]])
        .with_auxiliaries([Interval::new(0.0, 3.0)], [[1.0]], [[-1.0]])
        .with_outputs(["y"], [[1.0]], [[2.0]], [0.0]);
    let system = HybridSystem::mixed_logical_dynamical(1.0, &mld).unwrap();
    let run = system.simulate(&[1.0], &[[2.0]]).unwrap();
    assert_eq!(run.steps[0].outputs, [("y".to_owned(), 5.0)]);
    let narrow = mld.with_outputs(["y"], [[1.0]], [[2.0, 1.0]], [0.0]);
    let error = HybridSystem::mixed_logical_dynamical(1.0, &narrow).unwrap_err();
    assert!(error.to_string().starts_with("the matrices D1, D2 and D3 has shape 1x2"), "{error}");
}

#[test]
fn combinations_that_contradict_are_left_out() {
    // Three binaries of which exactly one holds, and a fourth that follows from the first.
    let e2 = [
        [1.0, 1.0, 1.0, 0.0],
        [-1.0, -1.0, -1.0, 0.0],
        [1.0, 0.0, 0.0, -1.0],
        [-1.0, 0.0, 0.0, 1.0],
    ];
    let system = |e5: [f64; 4]| {
        let mld = MixedLogicalDynamical::new([0.0], e5)
            .with_states([("x", Interval::new(0.0, 9.0))], [[1.0]], [[0.0]; 4])
            .with_binaries(4, [[1.0, 2.0, 3.0, 0.5]], e2);
        HybridSystem::mixed_logical_dynamical(1.0, &mld)
    };
    let one = system([1.0, -1.0, 0.0, 0.0]).unwrap();
    let mut names: Vec<&str> =
        one.parts().choices[0].transitions.iter().map(|t| t.name.as_str()).collect();
    names.sort_unstable();
    assert_eq!(names, ["0010", "0100", "1001"]);
    assert!(one.parts().choices[0].transitions.iter().all(|t| t.guards.is_empty()));
    let error = system([1.0, -2.0, 0.0, 0.0]).unwrap_err();
    assert!(error.to_string().contains("the inequalities contradict each other"), "{error}");

    let many = MixedLogicalDynamical::new([0.0], [])
        .with_states([("x", Interval::new(0.0, 9.0))], [[1.0]], Matrix::zeros(0, 1))
        .with_binaries(13, Matrix::zeros(1, 13), Matrix::zeros(0, 13));
    let error = HybridSystem::mixed_logical_dynamical(1.0, &many).unwrap_err();
    assert!(error.to_string().contains("at most 4096"), "{error}");
    let wrong = folded().with_binaries(2, [[0.0]], [[0.0]; 6]);
    let error = HybridSystem::mixed_logical_dynamical(1.0, &wrong).unwrap_err();
    assert!(matches!(error.kind(), ErrorKind::Shape { what: "the matrix B2", .. }), "{error}");
}

proptest! {
    #![proptest_config(config(200, "tests/regressions/mixed_logical.txt"))]

    /// A random piecewise-affine function of one state with two thresholds, once as a
    /// piecewise-affine system, once with a product per threshold.
    #[test]
    fn both_statements_run_alike(
        slopes in prop::array::uniform3(-1.0..1.0_f64),
        thresholds in (-6.0..0.0_f64, 0.5..6.0_f64),
        start in -8.0..8.0_f64,
        inputs in prop::collection::vec(-1.0..1.0_f64, 1..6),
    ) {
        let range = Interval::new(-10.0, 10.0);
        let (low, high) = thresholds;
        let states = || [("x", range)];
        let input = || [("u", Interval::new(-1.0, 1.0))];
        // Continuous: the slope changes at the thresholds.
        let (c1, c2) = ((slopes[0] - slopes[1]) * low, (slopes[1] - slopes[2]) * high);
        let flow = |slope: f64, c: f64| LinearSystem::new([[slope]], [[1.0]], [c]).unwrap();
        let pieces = HybridSystem::piecewise_affine(1.0,
            states(),
            input(),
            [
                ("0", flow(slopes[0], 0.0), [[1.0], [1.0]], [low, 10.0]),
                ("1", flow(slopes[1], c1), [[-1.0], [1.0]], [-low, high]),
                ("2", flow(slopes[2], c1 + c2), [[-1.0], [-1.0]], [-high, 10.0]),
            ],
        ).unwrap();
        // δ_k = 1 where x >= threshold_k; z_k = δ_k (x - threshold_k) adds the change of slope.
        let m = 20.0;
        let mut rows: Vec<([f64; 2], [f64; 2], f64, f64)> = Vec::new(); // δ, z, x, constant
        for (k, &t) in [low, high].iter().enumerate() {
            let at = |value: f64| if k == 0 { [value, 0.0] } else { [0.0, value] };
            rows.push((at(m), at(0.0), 1.0, m - t)); // x >= t if δ
            rows.push((at(-m), at(0.0), -1.0, t)); // x <= t if not δ
            rows.push((at(-m), at(1.0), 0.0, 0.0));
            rows.push((at(-m), at(-1.0), 0.0, 0.0));
            rows.push((at(m), at(1.0), 1.0, m - t));
            rows.push((at(m), at(-1.0), -1.0, m + t));
        }
        let column = |f: &dyn Fn(usize, usize) -> f64, n| Matrix::from_fn(rows.len(), n, f);
        let constants: Vec<f64> = rows.iter().map(|row| row.3).collect();
        let mld = MixedLogicalDynamical::new([0.0], constants)
            .with_states(states(), [[slopes[0]]], column(&|i, _| rows[i].2, 1))
            .with_inputs(input(), [[1.0]], column(&|_, _| 0.0, 1))
            .with_binaries(2, [[0.0, 0.0]], column(&|i, j| rows[i].0[j], 2))
            .with_auxiliaries(
                [Interval::new(-20.0, 20.0); 2],
                [[slopes[1] - slopes[0], slopes[2] - slopes[1]]],
                column(&|i, j| rows[i].1[j], 2),
            );
        let mld = HybridSystem::mixed_logical_dynamical(1.0, &mld).unwrap();
        prop_assert_eq!((mld.parts().choices[0].transitions.len(), mld.parts().inputs.len()), (3, 1));
        let inputs: Vec<[f64; 1]> = inputs.into_iter().map(|u| [u]).collect();
        let (a, b) = (pieces.simulate(&[start], &inputs), mld.simulate(&[start], &inputs));
        let (a, b) = (a.unwrap().states, b.unwrap().states);
        prop_assert_eq!(a.len(), b.len());
        for (x, y) in a.iter().flatten().zip(b.iter().flatten()) {
            prop_assert!((x - y).abs() < 1e-9, "{} {}", x, y);
        }
    }
}

#[test]
fn a_ball_loses_energy_at_the_floor_only() {
    let e = 0.7;
    let ball = HybridSystem::bouncing_ball(0.002, Restitution::new(e).unwrap(), 3.0, 10.0).unwrap();
    let run = ball.simulate(&[2.0, 0.0], &[[]; 1000]).unwrap();
    assert!(run.is_complete() && run.events() >= 2);
    let energy = |x: &[f64]| 9.81 * x[0] + 0.5 * x[1] * x[1];
    for (t, step) in run.steps.iter().enumerate() {
        let (before, after) = (energy(&run.states[t]), energy(&run.states[t + 1]));
        match step.taken[0].as_str() {
            "fall" => assert!((before - after).abs() < 1e-9),
            _ => assert!(after < before && (step.outputs[0].1 > 0.0)),
        }
    }
    // The first rebound: e² of the height.
    let hit = run.steps.iter().position(|step| step.events == 1).unwrap();
    let top = run.state("height").unwrap()[hit + 1..].iter().copied().fold(0.0, f64::max);
    assert!((top - e * e * 2.0).abs() < 0.02, "{top}");
    let flaws = ball.well_posedness(&mut BranchAndBound::default()).unwrap();
    // It may fall out of the range of speeds.
    let [IllPosedness::Stuck { witness, .. }] = &flaws[..] else { panic!("{flaws:?}") };
    assert!(witness.states()[1].abs() > 9.9, "{witness}");
    assert!(HybridSystem::bouncing_ball(0.0, Restitution::PLASTIC, 3.0, 10.0).is_err());
    assert!(HybridSystem::bouncing_ball(0.1, Restitution::PLASTIC, f64::NAN, 10.0).is_err());
}

#[test]
fn a_thermostat_keeps_its_band() {
    let room = |band| HybridSystem::thermostat(60.0, 1800.0, 5.0, 40.0, band);
    let system = room(Interval::new(19.0, 21.0)).unwrap();
    assert_eq!(system.well_posedness(&mut BranchAndBound::default()).unwrap(), []);
    let off = SimulationOptions::default().with_mode("heater", "off");
    let run = system.simulate_with(&[20.0], &[[]; 600], &off).unwrap();
    assert!(run.is_complete() && run.ambiguous_steps().is_empty());
    let temperature = run.state("temperature").unwrap();
    assert!(temperature.iter().all(|t| (18.4..21.8).contains(t)));
    assert!((100..180).contains(&run.events()), "{}", run.events());
    assert!(room(Interval::new(21.0, 19.0)).is_err());
    assert!(HybridSystem::thermostat(60.0, -1.0, 5.0, 40.0, Interval::new(1.0, 2.0)).is_err());
}

#[test]
fn a_polyhedron_has_a_limit_per_row() {
    let flow = LinearSystem::new([[1.0]], [[]; 1], [0.0]).unwrap();
    let inputs: [(&str, Interval); 0] = [];
    let modes = [("only", flow, [[1.0], [-1.0]], vec![1.0])];
    let error =
        HybridSystem::piecewise_affine(1.0, [("x", Interval::new(0.0, 1.0))], inputs, modes);
    assert!(matches!(error.unwrap_err().kind(), ErrorKind::Length { found: 1, expected: 2, .. }));
}
