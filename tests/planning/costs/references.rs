//! Optima that other solvers found (CPLEX 22.2) for the same systems and costs.

use carom::hybrid::{HybridProgram, HybridSystem, LinearSystem};
use carom::interval::Interval;
use carom::prelude::*;

/// The least cost, of a plan that is certified.
fn optimum(mut program: HybridProgram, cost: impl Into<Quadratic>) -> f64 {
    program.minimize(cost).unwrap();
    let plan = program.solve(&mut BranchAndBound::default()).unwrap();
    assert!(plan.solution.is_optimal());
    plan.solution.objective().unwrap()
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
    let system = rotation();
    let [x1, x2] = ["x1", "x2"].map(|name| system.state_named(name).unwrap());
    let u = system.input_named("u").unwrap();
    let from = |steps: usize| {
        let mut program = system.program(steps).unwrap();
        program.start([x1.equals(5.0), x2.equals(5.0)]).unwrap();
        program
    };
    for (steps, by_squares, by_largest) in
        [(2, 83.597746702, 13.264101616), (10, 88.281616798, 18.407929007)]
    {
        let program = from(steps);
        let squares = x1.square() + x2.square();
        let end = program.end(&squares).unwrap();
        let cost = program.sum(squares + u.square()).unwrap() + end;
        let found = optimum(program, cost);
        assert!(is_close(found, by_squares), "{steps} steps: {found}, not {by_squares}");
        let mut program = from(steps);
        let mut cost = program.sum_largest("states", [x1, x2]).unwrap();
        cost += program.sum_abs("push", u).unwrap();
        let end = [x1, x2].map(|x| program.end(x).unwrap());
        let sides = end.iter().flat_map(|x| [x.clone(), -x]);
        cost += program.model_mut().maximum("end", sides).unwrap();
        let found = optimum(program, cost);
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
    let levels = ["h1", "h2", "h3"].map(|name| system.state(name, 0.0, 0.66).unwrap());
    let pumps = ["q1", "q2"].map(|name| system.input(name, 0.0, 2.0).unwrap());
    let valves =
        [both, first, second, closed].into_iter().zip(["both", "first", "second", "closed"]);
    let mut taken = Vec::new();
    for (flow, name) in valves {
        taken.push(system.mode(name).unwrap().flow(flow).unwrap().taken());
    }
    let reference = [0.444, 0.35, 0.2];
    let mut program = system.program(2).unwrap();
    program.start(levels.map(|level| level.equals(0.0))).unwrap();
    let mut cost = program.sum(0.002 * taken[0] + 0.001 * taken[1] + 0.001 * taken[2]).unwrap();
    for (k, (level, wanted)) in levels.into_iter().zip(reference).enumerate() {
        cost += program.sum_abs(&format!("off {k}"), level - wanted).unwrap();
        let end = program.end(level - wanted).unwrap();
        cost += program.model_mut().absolute(("end", k), end).unwrap();
    }
    for (k, pump) in pumps.into_iter().enumerate() {
        cost += program.sum_abs(&format!("pump {k}"), 1e-5 * pump).unwrap();
    }
    // The other program does not count the first sample.
    let first_sample: f64 = reference.iter().sum();
    let (found, listed) = (optimum(program, cost), 1.8920445713 + first_sample);
    assert!(is_close(found, listed), "{found}, not {listed}");
}
