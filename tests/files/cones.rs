//! Random programs with norms, rotated cones and quadratic rows through every format: the same optimum.

use carom::model::{cbf, lp, mps, norm};
use carom::prelude::*;
use proptest::prelude::*;

use crate::common::config;
use crate::there_and_back::through_files;

/// A small program with cones, as numbers: integers `n` within 0 to 3, continuous `x` within -2 to 2.
#[derive(Debug, Clone)]
struct Conic {
    /// Whether it is rotated, coefficients of two tails, and of the head.
    cones: Vec<(bool, [i32; 4], [i32; 4], [i32; 3])>,
    /// Of a convex quadratic row.
    squares: [[i32; 4]; 2],
    cost: [i32; 4],
}

fn conic() -> impl Strategy<Value = Conic> {
    let small = || prop::array::uniform4(-2..=2_i32);
    let head = prop::array::uniform3(0..=3_i32);
    let cones = prop::collection::vec((any::<bool>(), small(), small(), head), 1..4);
    (cones, prop::array::uniform2(small()), small()).prop_map(|(cones, squares, cost)| Conic {
        cones,
        squares,
        cost,
    })
}

fn build(plan: &Conic) -> Model {
    let mut model = Model::new("conic");
    let n = model.integer_family("n", 2, 0.0, 3.0).unwrap();
    let x = model.continuous_family("x", 2, -2.0, 2.0).unwrap();
    let all = [n[0], n[1], x[0], x[1]];
    let sum = |a: &[i32]| all.iter().zip(a).map(|(&x, &a)| f64::from(a) * x).sum::<Affine>();
    for (k, (rotated, first, second, [a, b, c])) in plan.cones.iter().enumerate() {
        let head = f64::from(*a) * n[0] + 0.5 * f64::from(*b) * n[1] + f64::from(*c);
        let added = match rotated {
            false => model.add(("cone", k), norm([sum(first) + 0.3, sum(second)]).le(head)),
            true => {
                let name = ("part", k);
                let part = model.continuous(name, f64::NEG_INFINITY, f64::INFINITY).unwrap();
                model.add(name, sum(first).equals(part)).unwrap();
                let product = f64::from(*a + 1) * n[0] * n[1];
                model.add(("cone", k), part.square().le(product))
            }
        };
        // A head of 0 and the like.
        drop(added);
    }
    let [first, second] = plan.squares.map(|a| sum(&a));
    let sum_of_squares = (first - 0.25).square() + 0.3 * second.clone().square();
    // Without a variable it is no row.
    drop(model.add("squares", sum_of_squares.le(second + 6.0)));
    model.minimize(sum(&plan.cost) - 0.5 * x[0]).unwrap();
    model
}

proptest! {
    #![proptest_config(config(48, "tests/regressions/files.txt"))]

    #[test]
    fn what_is_written_has_the_same_optimum(plan in conic()) {
        let model = build(&plan);
        through_files(&model);
        let mut solver = BranchAndBound::default();
        let meant = solver.solve(&model).unwrap();
        let through = [
            mps::read(&mps::write(&model).unwrap()).unwrap(),
            lp::read(&lp::write(&model).unwrap()).unwrap(),
            cbf::read(&cbf::write(&model).unwrap()).unwrap(),
        ];
        for again in through.map(|read| read.model) {
            let found = solver.solve(&again).unwrap();
            prop_assert_eq!(meant.termination(), found.termination(), "{}\n{}", model, again);
            if let (Some(meant), Some(found)) = (meant.objective(), found.objective()) {
                let near = 1e-5 * meant.abs().max(1.0);
                prop_assert!((meant - found).abs() <= near, "{meant} {found}\n{model}\n{again}");
            }
        }
    }
}
