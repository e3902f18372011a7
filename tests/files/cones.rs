//! Random programs with norms, rotated cones and quadratic rows through every format: the same
//! optimum.

use carom::model::{cbf, lp, mps, norm};
use carom::prelude::*;
use carom::reformulate;
use proptest::prelude::*;

use crate::common::config;
use crate::there_and_back::through_files;

/// Whether it is rotated, coefficients of two entries and of the head, and the value of the binary
/// under which it holds.
type ConePlan = (bool, [i32; 4], [i32; 4], [i32; 3], Option<bool>);

/// A small program with cones, as numbers: integers `n` within 1 to 4 (cones whose heads
/// are 0 would leave tails the root of the tolerance), continuous `x` within -2 to 2.
#[derive(Debug, Clone)]
struct Conic {
    cones: Vec<ConePlan>,
    /// Of a convex quadratic row.
    squares: [[i32; 4]; 2],
    cost: [i32; 4],
}

fn conic() -> impl Strategy<Value = Conic> {
    let small = || prop::array::uniform4(-2..=2_i32);
    let head = prop::array::uniform3(0..=3_i32);
    let condition = prop_oneof![2 => Just(None), 1 => any::<bool>().prop_map(Some)];
    let cones = prop::collection::vec((any::<bool>(), small(), small(), head, condition), 1..4);
    (cones, prop::array::uniform2(small()), small()).prop_map(|(cones, squares, cost)| Conic {
        cones,
        squares,
        cost,
    })
}

fn build(plan: &Conic) -> Model {
    let mut model = Model::new("conic");
    let n = model.integer_family("n", 2, 1.0, 4.0).unwrap();
    let x = model.continuous_family("x", 2, -2.0, 2.0).unwrap();
    let z = model.binary("z").unwrap();
    let all = [n[0], n[1], x[0], x[1]];
    let sum = |a: &[i32]| all.iter().zip(a).map(|(&x, &a)| f64::from(a) * x).sum::<Affine>();
    for (k, (rotated, first, second, [a, b, c], condition)) in plan.cones.iter().enumerate() {
        let head = f64::from(*a) * n[0] + 0.5 * f64::from(*b) * n[1] + f64::from(*c);
        let row = match rotated {
            false => norm([sum(first) + 0.3, sum(second)]).le(head - 1.0),
            true => {
                let name = ("part", k);
                let part = model.continuous(name, -20.0, 20.0).unwrap();
                model.add(name, sum(first).equals(part)).unwrap();
                let product = f64::from(*a + 1) * n[0] * n[1];
                part.square().le(product)
            }
        };
        match condition {
            None => _ = model.add(("cone", k), row).unwrap(),
            Some(true) => _ = model.add(("cone", k), z.on().implies(row)).unwrap(),
            Some(false) => _ = model.add(("cone", k), z.off().implies(row)).unwrap(),
        }
    }
    let [first, second] = plan.squares.map(|a| sum(&a));
    let sum_of_squares = (first - 0.25).square() + 0.3 * second.clone().square();
    // Without a variable it is no row.
    drop(model.add("squares", sum_of_squares.le(second + 6.0)));
    model.minimize(sum(&plan.cost) - 0.5 * x[0] + 0.75 * z).unwrap();
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
            cbf::read(&cbf::write(reformulate::lower(&model).unwrap().model()).unwrap()).unwrap(),
        ];
        for again in through.map(|read| read.model) {
            let found = solver.solve(&again).unwrap();
            // The search may give up on either of them; what is proved has to agree.
            if [&meant, &found].iter().any(|solution| solution.termination() == Termination::Stalled) {
                continue;
            }
            prop_assert_eq!(meant.termination(), found.termination(), "{}\n{}", model, again);
            if let (Some(meant), Some(found)) = (meant.objective(), found.objective()) {
                let near = 1e-5 * meant.abs().max(1.0);
                prop_assert!((meant - found).abs() <= near, "{meant} {found}\n{model}\n{again}");
            }
        }
    }
}
