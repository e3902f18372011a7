//! Rows whose variables have cancelled: those that hold are accepted wherever rows are, and mean
//! nothing.

use carom::model::{Method, Reformulation, lp, mps};
use carom::prelude::*;

fn optimum(model: &Model) -> Option<f64> {
    let solution = BranchAndBound::default().solve(model).unwrap();
    assert!(matches!(solution.termination(), Termination::Optimal | Termination::Infeasible));
    solution.objective()
}

/// `0 x + constant` and its comparisons with a number.
fn constant(x: Variable) -> Affine {
    0.0 * x + 1.0
}

#[test]
fn sums_over_nothing_hold() {
    let mut model = Model::new("m");
    let y = model.continuous_family("y", 3, 0.0, 1.0).unwrap();
    for k in 0..3 {
        let before: Affine = (0..k).map(|j| y[j]).sum();
        model.add(("after", k), before.le(1.0)).unwrap();
    }
    model.add("equation", constant(y[0]).equals(1.0)).unwrap();
    model.add("range", constant(y[0]).within(0.5, 1.5)).unwrap();
    model.maximize(y[0] + y[1] + 0.5 * y[2]).unwrap();
    assert!((optimum(&model).unwrap() - 1.5).abs() < 1e-6);
    let without = Options::default().with_presolve(false);
    let plain = BranchAndBound::new(without).solve(&model).unwrap();
    assert!((plain.objective().unwrap() - 1.5).abs() < 1e-6);
    // In files and back.
    for read in [
        lp::read(&lp::write(&model).unwrap()).unwrap().model,
        mps::read(&mps::write(&model).unwrap()).unwrap().model,
    ] {
        assert_eq!(read.constraint_count(), 5);
        assert!((optimum(&read).unwrap() - 1.5).abs() < 1e-6);
    }
}

/// Under conditions, reified and in disjunctions, by each method: all points of the binaries.
#[test]
fn conditions_of_rows_that_hold() {
    for method in Method::ALL {
        for (target, expected) in [(0.0, Some(0.0)), (1.0, Some(1.0))] {
            let mut model = Model::new("m");
            let (x, z) = (model.continuous("x", 0.0, 4.0).unwrap(), model.binary("z").unwrap());
            model.add("when", z.on().implies(constant(x).le(1.0))).unwrap();
            model.add("all", z.off().implies_all([constant(x).ge(0.0), x.ge(0.0)])).unwrap();
            model.add("either", either(constant(x).ge(1.0)).or(x.ge(5.0))).unwrap();
            model.set_reformulation(Reformulation::default().with_method(method));
            model.add("pin", z.equals(target)).unwrap();
            model.minimize(x + z).unwrap();
            assert_eq!(optimum(&model).map(f64::round), expected, "{method:?}");
        }
        // The row holds always, so the condition does, too; and it cannot fail.
        for (target, is_possible) in [(1.0, true), (0.0, false)] {
            let mut model = Model::new("m");
            let (x, z) = (model.continuous("x", 0.0, 4.0).unwrap(), model.binary("z").unwrap());
            model.add("is", z.on().reify(constant(x).le(1.5), 0.1)).unwrap();
            model.add("pin", z.equals(target)).unwrap();
            model.minimize(x).unwrap();
            assert_eq!(optimum(&model).is_some(), is_possible);
        }
    }
}
