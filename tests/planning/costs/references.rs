//! Optima that other solvers found (CPLEX 22.2) for the same systems and costs.

use carom::hybrid::{HybridSystem, IntoMatrix, LinearSystem, Mat, Region, When};
use carom::internals::hybrid::Transition;
use carom::interval::Interval;
use carom::prelude::*;

fn optimum(system: &HybridSystem, steps: usize, start: &[f64], cost: &Cost) -> f64 {
    let mut model = Model::new("m");
    let program = system.write(&mut model, "", steps).unwrap();
    program.require(&mut model, "start", &Region::point(start), When::At(0)).unwrap();
    let cost = program.add_cost(&mut model, "cost", cost).unwrap();
    model.minimize(cost).unwrap();
    let solution = BranchAndBound::default().solve(&model).unwrap();
    assert!(solution.is_optimal());
    program.certified(&solution).unwrap();
    solution.objective().unwrap()
}

fn is_close(value: f64, expected: f64) -> bool {
    (value - expected).abs() <= 2e-6 * expected
}

/// The switched rotation of Bemporad and Morari, Automatica 35, 1999.
fn rotation() -> HybridSystem {
    let turn = |angle: f64| {
        let (s, c) = angle.sin_cos();
        let a = [[0.8 * c, -0.8 * s], [0.8 * s, 0.8 * c]];
        LinearSystem::new(a, [[0.0], [1.0]], [0.0, 0.0]).unwrap()
    };
    let domain = Interval::new(-10.0, 10.0);
    let third = std::f64::consts::FRAC_PI_3;
    HybridSystem::piecewise_affine(
        1.0,
        [("x1", domain), ("x2", domain)],
        [("u", Interval::new(-1.0, 1.0))],
        [("left", turn(-third), [[1.0, 0.0]], [0.0]), ("right", turn(third), [[-1.0, 0.0]], [0.0])],
    )
    .unwrap()
}

#[test]
fn the_rotation_costs_what_it_costs_elsewhere() {
    let identity = Mat::<f64>::identity(2, 2);
    let squares = Cost::quadratic(&identity, [[1.0]]).with_terminal(&identity);
    let largest = Cost::infinity_norm(&identity, [[1.0]]).with_terminal(&identity);
    for (steps, by_squares, by_largest) in
        [(2, 83.597746702, 13.264101616), (10, 88.281616798, 18.407929007)]
    {
        let found = optimum(&rotation(), steps, &[5.0, 5.0], &squares);
        assert!(is_close(found, by_squares), "{steps} steps: {found}, not {by_squares}");
        let found = optimum(&rotation(), steps, &[5.0, 5.0], &largest);
        assert!(is_close(found, by_largest), "{steps} steps: {found}, not {by_largest}");
    }
}

/// The figures of github.com/A-Safi/ThreeTank-HYSDEL-MPC, flows in 1e-5 m³/s.
#[test]
fn three_tanks_cost_what_they_cost_elsewhere() {
    let (k, s) = (0.0300751081, 0.000478701215);
    let (p, c, o, g) = (0.969343693, 0.0305476709, 8.00415048e-3, 8.1300813e-3);
    let flow =
        |a: [[f64; 3]; 3], b: [[f64; 2]; 3], d: [f64; 3]| LinearSystem::new(a, b, d).unwrap();
    let both = flow(
        [[0.969338678, s, k], [s, 0.969338678, k], [k, k, 0.933058914]],
        [[8.00414018e-3, 1.31175326e-6], [1.31175326e-6, 8.00414018e-3], [1.24335545e-4; 2]],
        [-0.00819687799, -0.0126948813, 0.0204578679],
    );
    let first = flow(
        [[p, 0.0, c], [0.0, 1.0, 0.0], [c, 0.0, 0.962555322]],
        [[o, 0.0], [0.0, g], [1.25634698e-4, 0.0]],
        [-0.0116548403, 0.0, 0.0114937126],
    );
    let second = flow(
        [[1.0, 0.0, 0.0], [0.0, p, c], [0.0, c, 0.962555322]],
        [[g, 0.0], [0.0, o], [0.0, 1.25634698e-4]],
        [0.0, -0.0061816552, 0.00580026915],
    );
    let closed = flow(
        [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 0.992994613]],
        [[g, 0.0], [0.0, g], [0.0, 0.0]],
        [0.0, 0.0, -1.19828989e-4],
    );
    let mut system = HybridSystem::new(1.0);
    for name in ["h1", "h2", "h3"] {
        system = system.with_state(name, Interval::new(0.0, 0.66));
    }
    for name in ["q1", "q2"] {
        system = system.with_input(name, Interval::new(0.0, 2.0));
    }
    for (name, flow) in [("both", both), ("first", first), ("second", second), ("closed", closed)] {
        system = system.with_transition(Transition::new(name, flow));
    }
    let levels = Mat::<f64>::identity(3, 3);
    let reference = [0.444, 0.35, 0.2];
    let cost = Cost::one_norm(&levels, [[1e-5, 0.0], [0.0, 1e-5]].into_matrix())
        .with_terminal(&levels)
        .with_state_reference(reference.to_vec())
        .with_transition_cost("mode", "both", 0.002)
        .with_transition_cost("mode", "first", 0.001)
        .with_transition_cost("mode", "second", 0.001);
    // The other program does not count the first sample.
    let first_sample: f64 = reference.iter().sum();
    let (found, listed) = (optimum(&system, 2, &[0.0; 3], &cost), 1.8920445713 + first_sample);
    assert!(is_close(found, listed), "{found}, not {listed}");
}
