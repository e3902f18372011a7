//! Systems of others, stated once. Their optima are those of the same programs, written by hand as
//! rows by an independent script and solved by another solver (CPLEX 22.2).

use carom::hybrid::{HybridSystem, LinearSystem, Matrix, MixedLogicalDynamical};
use carom::interval::Interval;
use carom::prelude::*;
use carom_hybrid::internals::HasParts;
use carom_hybrid::internals::SystemVariables;

/// The least cost, of a plan that is certified.
fn least_cost(
    system: &HybridSystem,
    start: &[f64],
    steps: usize,
    cost: impl Fn(&mut Model, &SystemVariables) -> Quadratic,
) -> f64 {
    let mut model = Model::new("m");
    let program = system.write(&mut model, "", steps).unwrap();
    for (family, value) in program.states().iter().zip(start) {
        model.fix(family[0], *value).unwrap();
    }
    let cost = cost(&mut model, &program);
    model.minimize(cost).unwrap();
    let solution = BranchAndBound::default().solve(&model).unwrap();
    program.certified(&solution).unwrap();
    solution.objective().unwrap()
}

fn is_close(found: f64, optimum: f64) -> bool {
    (found - optimum).abs() <= 1e-5 * optimum
}

/// A. Bemporad, M. Morari, Automatica 35 (1999): a rotation whose sense depends on x1.
fn rotation() -> HybridSystem {
    let turn = |angle: f64| {
        let (s, c) = angle.sin_cos();
        let a = [[0.8 * c, -0.8 * s], [0.8 * s, 0.8 * c]];
        LinearSystem::new(a, [[0.0], [1.0]], [0.0, 0.0]).unwrap()
    };
    let (third, range) = (std::f64::consts::FRAC_PI_3, Interval::new(-10.0, 10.0));
    let modes =
        [("left", turn(-third), [[1.0, 0.0]], [0.0]), ("right", turn(third), [[-1.0, 0.0]], [0.0])];
    let inputs = [("u", Interval::new(-1.0, 1.0))];
    HybridSystem::piecewise_affine(1.0, [("x1", range), ("x2", range)], inputs, modes).unwrap()
}

fn squares(program: &SystemVariables) -> Quadratic {
    let all = program.states().iter().chain(program.inputs());
    all.flat_map(|family| family.iter()).map(|variable| variable.square()).sum()
}

/// The sum over the samples of the largest magnitude among some families.
fn largest(model: &mut Model, name: &str, families: &[Family]) -> Quadratic {
    let count = families[0].len();
    let bounds = model.continuous_family(name, count, 0.0, 20.0).unwrap();
    for (k, family) in families.iter().enumerate() {
        for t in 0..count {
            model.add((format!("{name}_over{k}"), t), bounds[t].ge(family[t])).unwrap();
            model.add((format!("{name}_under{k}"), t), bounds[t].ge(-1.0 * family[t])).unwrap();
        }
    }
    let sum: Affine = bounds.iter().map(Affine::from).sum();
    sum.into()
}

#[test]
fn the_rotation_of_bemporad_and_morari() {
    let optima =
        [(2, 83.597_746_702_348_15), (10, 88.281_616_797_576_8), (20, 88.281_631_963_164_83)];
    for (steps, optimum) in optima {
        let found = least_cost(&rotation(), &[5.0, 5.0], steps, |_, program| squares(program));
        assert!(is_close(found, optimum), "{steps} steps: {found}, not {optimum}");
    }
    for (steps, optimum) in
        [(2, 13.264_101_615_137_754), (10, 18.407_929_006_813_39), (20, 18.407_929_006_813_39)]
    {
        let cost = |model: &mut Model, program: &SystemVariables| {
            largest(model, "e", program.states()) + largest(model, "g", program.inputs())
        };
        let found = least_cost(&rotation(), &[5.0, 5.0], steps, cost);
        assert!(is_close(found, optimum), "{steps} steps: {found}, not {optimum}");
    }
}

/// A ball that flows above the ground and jumps at or below it, where an impulse acts
/// (aldma/HybridMPC-MLDBouncingBall).
#[test]
fn a_ball_with_impulses() {
    let (dt, gravity, rebound, impulse) = (0.01, 9.8, 0.7, 0.01);
    let flow = LinearSystem::new(
        [[1.0, dt], [0.0, 1.0]],
        [[0.0], [0.0]],
        [-dt * dt * gravity, -dt * gravity],
    );
    let jump = LinearSystem::new([[1.0, -dt], [0.0, -rebound]], [[0.0], [1.0]], [0.0, 0.0]);
    let range = Interval::new(-10.0, 10.0);
    let ball = HybridSystem::piecewise_affine(
        1.0,
        [("height", range), ("speed", range)],
        [("impulse", Interval::new(-impulse, impulse))],
        [
            ("flow", flow.unwrap(), [[-1.0, 0.0]], [0.0]),
            ("jump", jump.unwrap(), [[1.0, 0.0]], [0.0]),
        ],
    )
    .unwrap();
    let cost = |_: &mut Model, program: &SystemVariables| -> Quadratic {
        let states = program.states().iter().flat_map(|family| family.iter().skip(1));
        let impulses = program.inputs().iter().flat_map(|family| family.iter());
        let squares: Quadratic = states.map(|x| 0.2 * x.square()).sum();
        squares + impulses.map(|u| 0.01 * u.square()).sum::<Quadratic>()
    };
    for (steps, optimum) in [(4, 3.241_972_043_680_014_3), (40, 66.637_772_021_440_03)] {
        let found = least_cost(&ball, &[2.0, 0.0], steps, cost);
        assert!(is_close(found, optimum), "{steps} steps: {found}, not {optimum}");
    }
}

/// A row `E2 δ + E3 z <= E1 u + E4 v + E5`: its δ, z, u, v and constant.
type DynamicsRow = ([f64; 3], [f64; 3], f64, f64, f64);

/// Speed of a car with three gears and a drag in two pieces, as mixed logical dynamics
/// (astroquest/hybrid-mpc-for-adaptive-cruise-control): binaries `v >= 15`, `v >= alpha`,
/// `v >= 30`, auxiliaries u δ1, v δ2, u δ3.
fn car() -> HybridSystem {
    let (mass, drag, b, g, time) = (800.0, 0.4, 3700.0, 0.87, 0.125);
    let (most, comfort, shifts, alpha, beta) =
        (1.3_f64, 2.5, [15.0, 28.8575, 30.0], 28.8575, 249.8266);
    let top = (b / drag / (1.0 + 3.0 * g) * most).sqrt();
    let a1 = beta / alpha;
    let b2 = (beta / alpha * top - drag * top * top) / (top / alpha - 1.0);
    let a2 = (beta - b2) / alpha;
    let gear = |k: f64| b / (1.0 + k * g);
    let s = time / mass;
    // v⁺ = a v + b1 u + b2 δ + b3 z.
    let (a, b1) = (1.0 - s * a1, s * gear(1.0));
    let b2 = [0.0, -s * b2, 0.0];
    let b3 = [s * (gear(2.0) - gear(1.0)), s * (a1 - a2), s * (gear(3.0) - gear(2.0))];
    // Rows: δ, z, u, v and the constant, as E2 δ + E3 z <= E1 u + E4 v + E5.
    let mut rows: Vec<DynamicsRow> = Vec::new();
    let at = |k: usize, value: f64| std::array::from_fn(|j| if j == k { value } else { 0.0 });
    for (k, threshold) in shifts.into_iter().enumerate() {
        rows.push((at(k, threshold - top), at(k, 0.0), 0.0, -1.0, threshold));
        rows.push((at(k, threshold), at(k, 0.0), 0.0, 1.0, 0.0));
    }
    for (k, low, of_speed) in [(0, -most, 0.0), (1, 0.0, 1.0), (2, -most, 0.0)] {
        let high = if of_speed == 1.0 { top } else { most };
        let of_input = 1.0 - of_speed;
        rows.push((at(k, -high), at(k, 1.0), 0.0, 0.0, 0.0));
        rows.push((at(k, low), at(k, -1.0), 0.0, 0.0, 0.0));
        rows.push((at(k, -low), at(k, 1.0), of_input, of_speed, -low));
        rows.push((at(k, high), at(k, -1.0), -of_input, -of_speed, high));
    }
    for sign in [1.0, -1.0] {
        rows.push((
            b2.map(|x| sign * x),
            b3.map(|x| sign * x),
            -sign * b1,
            -sign * (a - 1.0),
            time * comfort,
        ));
    }
    let count = rows.len();
    let column = |f: &dyn Fn(usize, usize) -> f64, n| Matrix::from_fn(count, n, f);
    let constants: Vec<f64> = rows.iter().map(|row| row.4).collect();
    let mld = MixedLogicalDynamical::new([0.0], constants)
        .with_states([("v", Interval::new(0.0, top))], [[a]], column(&|i, _| rows[i].3, 1))
        .with_inputs([("u", Interval::new(-most, most))], [[b1]], column(&|i, _| rows[i].2, 1))
        .with_binaries(3, [b2], column(&|i, j| rows[i].0[j], 3))
        .with_auxiliaries(
            [Interval::new(-most, most), Interval::new(0.0, top), Interval::new(-most, most)],
            [b3],
            column(&|i, j| rows[i].1[j], 3),
        );
    HybridSystem::mixed_logical_dynamical(1.0, &mld).unwrap()
}

#[test]
fn a_car_with_three_gears() {
    let car = car();
    let mut names: Vec<&str> =
        car.parts().choices[0].transitions.iter().map(|t| t.name.as_str()).collect();
    names.sort_unstable();
    assert_eq!((names, car.parts().inputs.len()), (vec!["000", "100", "110", "111"], 1));
    let cost = |model: &mut Model, program: &SystemVariables| -> Quadratic {
        let (v, u) = (&program.states()[0], &program.inputs()[0]);
        let reference = 1.2 * 28.8575;
        let mut sum = Affine::zero();
        for t in 0..u.len() {
            let e = model.continuous(("e", t), 0.0, 200.0).unwrap();
            let w = model.continuous(("w", t), 0.0, 1.3).unwrap();
            model.add(("e_over", t), e.ge(v[t + 1] - reference)).unwrap();
            model.add(("e_under", t), e.ge(reference - v[t + 1])).unwrap();
            model.add(("w_over", t), w.ge(u[t])).unwrap();
            model.add(("w_under", t), w.ge(-1.0 * u[t])).unwrap();
            sum += e + 0.1 * w;
        }
        sum.into()
    };
    for (start, steps, optimum) in [
        (10.0, 5, 118.986_149_829_936_68),
        (26.0, 5, 40.214_620_587_389_16),
        (10.0, 20, 429.511_249_263_637_8),
        (26.0, 20, 125.715_219_856_112_1),
    ] {
        let found = least_cost(&car, &[start], steps, cost);
        assert!(is_close(found, optimum), "{steps} steps from {start}: {found}, not {optimum}");
    }
}
