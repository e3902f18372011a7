//! Linear complementarity systems: plans against the two lines of their definition, and the
//! statement by matrices against that by handles.

use crate::common::config;
use carom::hybrid::{LinearComplementarity, Matrix};
use carom::prelude::*;
use proptest::prelude::*;

/// Numbers of a system with two states, an input and two forces.
#[derive(Debug, Clone)]
struct Numbers {
    a: [[f64; 2]; 2],
    b: [[f64; 1]; 2],
    d: [[f64; 2]; 2],
    e: [[f64; 2]; 2],
    f: [[f64; 2]; 2],
    h: [[f64; 1]; 2],
    shift: [f64; 2],
    gap: [f64; 2],
}

fn numbers() -> impl Strategy<Value = Numbers> {
    let small = || (-4..=4_i32).prop_map(|k| 0.25 * f64::from(k));
    let pair = move || [small(), small()];
    let compliance = (1..=4_i32).prop_map(|k| 0.5 * f64::from(k));
    let gap = (-2..=3_i32).prop_map(f64::from);
    (
        [pair(), pair()],
        [[small()], [small()]],
        [pair(), pair()],
        [pair(), pair()],
        [compliance.clone(), compliance],
        [[small()], [small()]],
        pair(),
        [gap.clone(), gap],
    )
        .prop_map(|(a, b, d, e, [f1, f2], h, shift, gap)| {
            let f = [[f1, 0.0], [0.0, f2]];
            Numbers { a, b, d, e, f, h, shift, gap }
        })
}

const STATES: [(&str, f64, f64); 2] = [("x", -8.0, 8.0), ("y", -8.0, 8.0)];
const MOST: f64 = 20.0;
const REGRESSIONS: &str = "tests/regressions/complementarity.txt";

fn by_matrices(n: &Numbers) -> HybridSystem {
    let states = STATES.map(|(name, lower, upper)| (name, lower..=upper));
    let stated = LinearComplementarity::new(n.shift, n.gap)
        .with_states(states, n.a, n.e)
        .with_inputs([("u", -1.0..=1.0)], n.b, n.h)
        .with_forces([("left", MOST), ("right", MOST)], n.d, n.f);
    HybridSystem::linear_complementarity(0.5, &stated).unwrap()
}

fn by_handles(n: &Numbers) -> HybridSystem {
    let mut system = HybridSystem::new(0.5);
    let x = STATES.map(|(name, lower, upper)| system.state(name, lower, upper).unwrap());
    let u = system.input("u", -1.0, 1.0).unwrap();
    let forces = ["left", "right"].map(|name| system.input(name, 0.0, MOST).unwrap());
    let line = |i: usize, [a, d]: [&[[f64; 2]; 2]; 2], b: &[[f64; 1]; 2], constant: f64| {
        a[i][0] * x[0]
            + a[i][1] * x[1]
            + b[i][0] * u
            + d[i][0] * forces[0]
            + d[i][1] * forces[1]
            + constant
    };
    system.next([0, 1].map(|i| x[i].is(line(i, [&n.a, &n.d], &n.b, n.shift[i])))).unwrap();
    for (i, name) in ["left", "right"].into_iter().enumerate() {
        let gap = line(i, [&n.e, &n.f], &n.h, n.gap[i]);
        system.complementarity(name, forces[i], gap).unwrap();
    }
    system
}

proptest! {
    #![proptest_config(config(60, REGRESSIONS))]

    #[test]
    fn plans_keep_both_lines(n in numbers(), steps in 1..=4_usize, sign in prop::bool::ANY) {
        let system = by_matrices(&n);
        prop_assert_eq!(&system, &by_handles(&n));
        let [x, y] = ["x", "y"].map(|name| system.state_named(name).unwrap());
        let inputs = ["u", "left", "right"].map(|name| system.input_named(name).unwrap());
        let mut program = system.program(steps).unwrap();
        program.start([x.equals(1.0), y.equals(-1.0)]).unwrap();
        let goal = if sign { program.end(x + 0.5 * y) } else { program.end(y - x) };
        program.maximize(goal.unwrap()).unwrap();
        let plan = match program.solve(&mut BranchAndBound::default()) {
            Ok(plan) => plan,
            // Domains may leave no plan.
            Err(error) => {
                prop_assert!(error.to_string().contains("`infeasible`"), "{}", error);
                return Ok(());
            }
        };
        let states = [x, y].map(|state| plan.values(state).unwrap());
        let inputs = inputs.map(|input| plan.values(input).unwrap());
        for t in 0..steps {
            let (z, u) = ([states[0][t], states[1][t]], inputs[0][t]);
            let force = [inputs[1][t], inputs[2][t]];
            for i in 0..2 {
                let dot = |row: [f64; 2], by: [f64; 2]| row[0] * by[0] + row[1] * by[1];
                let next = dot(n.a[i], z) + n.b[i][0] * u + dot(n.d[i], force) + n.shift[i];
                prop_assert!((states[i][t + 1] - next).abs() < 1e-5);
                let gap = dot(n.e[i], z) + dot(n.f[i], force) + n.h[i][0] * u + n.gap[i];
                prop_assert!(gap > -1e-5 && force[i] > -1e-6, "gap {gap}, force {}", force[i]);
                prop_assert!(gap.min(force[i]) < 1e-5, "gap {gap}, force {}", force[i]);
            }
        }
    }
}

#[test]
fn matrices_of_other_shapes_are_refused() {
    let stated = |e: Matrix| {
        let stated = LinearComplementarity::new([0.0], [1.0])
            .with_states([("x", -1.0..=1.0)], [[1.0]], e)
            .with_forces([("f", 1.0)], [[1.0]], [[1.0]]);
        HybridSystem::linear_complementarity(0.1, &stated).map_err(|error| error.to_string())
    };
    assert!(stated([[1.0]].into()).is_ok());
    assert_eq!(
        stated(Matrix::zeros(2, 1)).unwrap_err(),
        "the matrix E has shape 2x1; expected 1x1"
    );
    // A force needs a flow in which it acts.
    let mut system = HybridSystem::new(0.1);
    let x = system.state("x", -1.0, 1.0).unwrap();
    let force = system.input("f", 0.0, 1.0).unwrap();
    assert_eq!(
        system.complementarity("wall", force, 1.0 - x).unwrap_err().to_string(),
        "`wall` cannot stand in a system without a common flow; state the flow, with the force in it, by \
         `rates` or `next` of the system first"
    );
}
