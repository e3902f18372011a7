//! Nodes whose integers are whole are solved, not split: softened boxes, whose slacks the root's
//! cuts and tightened rows price a little below their true cost.

use carom::prelude::*;
use proptest::prelude::*;

/// Obstacles: left, right, lower, upper side (m).
const BOXES: [[f64; 4]; 3] =
    [[1.15, 1.95, -0.05, 2.25], [2.75, 3.45, 1.35, 4.05], [4.25, 4.95, 0.55, 2.65]];

/// Largest thrust in each of eight directions (m/s²).
const MOST_THRUST: f64 = 1.8477590650225735;

/// A controller over some steps of 0.2 s: a mass in the plane goes to (5.5, 3.5), stays outside
/// boxes at both ends of each step, or pays 500 a metre.
fn controller(steps: usize, [px, py, pvx, pvy]: [f64; 4]) -> Model {
    let mut model = Model::new("soft boxes");
    let [x, y] = [("x", 7.0), ("y", 5.0)]
        .map(|(name, most)| model.continuous_family(name, steps + 1, -1.0, most).unwrap());
    let [vx, vy] =
        ["vx", "vy"].map(|name| model.continuous_family(name, steps + 1, -3.0, 3.0).unwrap());
    let [ux, uy] =
        ["ux", "uy"].map(|name| model.continuous_family(name, steps, -2.0, 2.0).unwrap());
    let slack = model.continuous_family("s", steps + 1, 0.0, 3.0).unwrap();
    let states = [(x[0], px), (y[0], py), (vx[0], pvx), (vy[0], pvy)];
    for (k, (variable, value)) in states.into_iter().enumerate() {
        model.add(("start", k), variable.equals(value)).unwrap();
    }
    let mut cost = Quadratic::default();
    for k in 0..steps {
        for (axis, (x, v, u)) in [(&x, &vx, &ux), (&y, &vy, &uy)].into_iter().enumerate() {
            let step = 2 * k + axis;
            let next = x[k] + 0.2 * v[k] + 0.02 * u[k];
            model.add(("position", step), (x[k + 1] - next).equals(0.0)).unwrap();
            model.add(("speed", step), (v[k + 1] - v[k] - 0.2 * u[k]).equals(0.0)).unwrap();
            let weight = if k + 1 == steps { 10.0 } else { 1.0 };
            let goal = [5.5, 3.5][axis];
            cost += weight * (x[k + 1] - goal).square() + 0.1 * weight * v[k + 1].square();
            cost += 0.1 * u[k].square();
        }
        model.add(("room_x", k), x[k + 1].within(0.0, 6.0)).unwrap();
        model.add(("room_y", k), y[k + 1].within(0.0, 4.0)).unwrap();
        for side in 0..8_u8 {
            let (sin, cos) = (f64::from(side) * std::f64::consts::FRAC_PI_4).sin_cos();
            let row = (cos * ux[k] + sin * uy[k]).le(MOST_THRUST);
            model.add(("thrust", 8 * k + usize::from(side)), row).unwrap();
            let row = (cos * vx[k + 1] + sin * vy[k + 1]).le(1.38581929876693);
            model.add(("most", 8 * k + usize::from(side)), row).unwrap();
        }
        for (b, [left, right, low, high]) in BOXES.into_iter().enumerate() {
            let s = slack[k + 1];
            let is = model.binary_family(&format!("box{b}_{k}"), 4).unwrap();
            model
                .add(("one", 3 * k + b), is.iter().map(|i| 1.0 * i).sum::<Affine>().equals(1.0))
                .unwrap();
            for (end, at) in [k, k + 1].into_iter().enumerate() {
                let rows = [
                    (x[at] - s).le(left),
                    (x[at] + s).ge(right),
                    (y[at] - s).le(low),
                    (y[at] + s).ge(high),
                ];
                for (side, row) in rows.into_iter().enumerate() {
                    let name = format!("out{b}_{side}_{end}");
                    model.add((name.as_str(), k), is[side].on().implies(row)).unwrap();
                }
            }
        }
        cost += Quadratic::from(500.0 * slack[k + 1]);
    }
    model.minimize(cost).unwrap();
    model
}

#[test]
fn a_controller_with_softened_boxes_ends() {
    let start = [2.7509375765883672, 3.5151816500746977, 0.03680799780434503, 0.01853674109158569];
    let model = controller(10, start);
    let options = Options::default().with_node_limit(500);
    let solution = BranchAndBound::new(options).solve(&model).unwrap();
    assert!(solution.is_optimal(), "{}", solution.termination());
    // The optimum as two other solvers found it.
    assert!((solution.objective().unwrap() - 144.20202263).abs() < 1e-5);
}

/// The largest position (m) of a full brake along x, which is the smallest over all plans. The
/// other starts of the property below leave room enough on all other sides, whatever that brake
/// leaves of the thrust.
fn farthest_of_a_full_brake(steps: usize, mut x: f64, mut vx: f64) -> f64 {
    let mut farthest = x;
    for _ in 0..steps {
        x += 0.2 * vx - 0.02 * MOST_THRUST;
        vx -= 0.2 * MOST_THRUST;
        farthest = farthest.max(x);
    }
    farthest
}

#[test]
fn a_controller_that_cannot_brake_before_the_wall_has_no_plan() {
    let [x, y, vx, vy] = [5.7789, 0.2, 0.9428, 0.0];
    assert!(farthest_of_a_full_brake(5, x, vx) > 6.008);
    let model = controller(5, [x, y, vx, vy]);
    for cuts in [true, false] {
        let options = Options::default().with_cuts(cuts).with_big_m_tightening(cuts);
        let solution = BranchAndBound::new(options).solve(&model).unwrap();
        assert_eq!(solution.termination(), Termination::Infeasible);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(16))]

    /// With cuts and tightened rows, and without any, in few nodes.
    #[test]
    fn controllers_with_softened_boxes_end(
        x in 0.2..5.8, y in 0.2..3.8, vx in -0.5..1.0, vy in -0.5..0.5,
    ) {
        let model = controller(5, [x, y, vx, vy]);
        let options = Options::default().with_node_limit(3000);
        let plain = options.clone().with_cuts(false).with_big_m_tightening(false);
        let [one, other] = [options, plain].map(|o| BranchAndBound::new(o).solve(&model).unwrap());
        let farthest = farthest_of_a_full_brake(5, x, vx);
        prop_assume!((farthest - 6.0).abs() > 1e-5);
        if farthest > 6.0 {
            for solution in [&one, &other] {
                prop_assert_eq!(solution.termination(), Termination::Infeasible);
            }
            return Ok(());
        }
        for solution in [&one, &other] {
            prop_assert!(solution.is_optimal(), "{}", solution.termination());
        }
        let [a, b] = [&one, &other].map(|s| s.objective().unwrap());
        prop_assert!((a - b).abs() <= 1e-5 * a.abs().max(1.0), "{a} {b}");
    }
}
