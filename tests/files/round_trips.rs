//! Every construct through every file format: lowered by each method, written, read back, the model
//! is the same to the last bit, and its optimum is that of the model as it was meant, for random
//! models that mix rows, indicators both ways, logic, functions, disjunctions and parameters.

use crate::common::config;
use carom::model::{Method, PiecewiseAffine, Reformulation, Term, lp, mps};
use carom::prelude::*;
use carom::reformulate;
use proptest::prelude::*;

/// One statement, as numbers.
#[derive(Debug, Clone)]
struct Said {
    kind: u8,
    pick: [usize; 3],
    slope: [i32; 3],
    limit: i32,
    flip: bool,
}

fn said() -> impl Strategy<Value = Said> {
    let slope = prop::array::uniform3(-3..=3_i32);
    (0..10_u8, prop::array::uniform3(0..3_usize), slope, -6..=6_i32, any::<bool>())
        .prop_map(|(kind, pick, slope, limit, flip)| Said { kind, pick, slope, limit, flip })
}

fn build(statements: &[Said], cost: [i32; 3]) -> Result<Model, Error> {
    let mut model = Model::new("mixed");
    let z = model.binary_family("z", 3)?;
    let x = model.continuous_family("x", 2, -2.5, 3.0)?;
    let n = model.integer("n", -1.0, 3.0)?;
    let p = model.parameter("p", 0.75, -1.0, 2.0)?;
    let mut total = f64::from(cost[0]) * x[0] + f64::from(cost[1]) * x[1] + f64::from(cost[2]) * n;
    for (k, Said { kind, pick, slope, limit, flip }) in statements.iter().enumerate() {
        let [a, b, c] = slope.map(f64::from);
        // An expression with a variable in it, whatever the slopes are.
        let e = (a + 0.1) * x[0] + b * x[1] + c * n + 0.3 * p;
        let limit = 0.5 * f64::from(*limit);
        let [u, v, w] = pick.map(|j| z[j]);
        let condition: Logic = if *flip { u & !v } else { u | v.xor(w) };
        let row = if *flip { e.le(limit + 4.0) } else { e.within(limit - 4.0, limit + 4.0) };
        let name = ("s", k);
        match kind {
            0 => _ = model.add(name, row)?,
            1 => _ = model.add(name, u.on().implies(row))?,
            2 => _ = model.add(name, condition.implies(row))?,
            3 => _ = model.add(name, u.on().reify(row, 0.125))?,
            // Formulas that never hold are refused, and have their own tests.
            4 => _ = model.add(name, condition.implies(at_most(1, &z) | w)),
            5 => total += 0.5 * model.absolute(name, e)?,
            6 => total -= 0.25 * model.maximum(name, [e, x[0] - x[1], Affine::constant(0.5)])?,
            7 => total += model.product(name, if *flip { n } else { u }, x[1] + 1.0)?,
            8 => {
                let law = PiecewiseAffine::new([(-1.0, 0.0), (0.0, 2.0), (1.5, -1.0)])?;
                total += model.piecewise(name, e, &law.extended(-60.0, 60.0)?)?;
            }
            _ => {
                let inner = either(x[1].le(limit)).or(x[1].ge(limit + 1.0));
                let ways = either(row).or(Term::from([x[0].le(1.0)]).and_either(inner));
                model.add(name, ways.or(n.ge(2.0)))?;
            }
        }
    }
    model.minimize(total)?;
    Ok(model)
}

proptest! {
    #![proptest_config(config(40, "tests/regressions/round_trips.txt"))]

    #[test]
    fn files_carry_what_is_meant(
        statements in prop::collection::vec(said(), 1..=5),
        cost in prop::array::uniform3(-3..=3_i32),
        programs in any::<bool>(),
    ) {
        let mut model = build(&statements, cost).unwrap();
        let mut solver = BranchAndBound::default();
        let meant = solver.solve(&model).unwrap();
        prop_assert!(meant.is_optimal() || meant.is_infeasible(), "{meant:?}");
        for method in Method::ALL {
            let reformulation = Reformulation::default();
            model.set_reformulation(reformulation.with_method(method).with_linear_programs(programs));
            let lowered = reformulate::lower(&model).unwrap();
            // The parameter is written as what it is now.
            let text = lowered.model().to_string().replace("p = 0.75, a parameter in [-1, 2]", "p = 0.75");
            let through_mps = mps::read(&mps::write(lowered.model()).unwrap()).unwrap().model;
            prop_assert_eq!(through_mps.to_string(), &text[..]);
            let through_lp = lp::read(&lp::write(lowered.model()).unwrap()).unwrap().model;
            prop_assert_eq!(through_lp.to_string(), &text[..]);
            let again = solver.solve(&through_lp).unwrap();
            prop_assert_eq!(again.termination(), meant.termination(), "{:?}", method);
            if let (Some(again), Some(meant)) = (again.objective(), meant.objective()) {
                prop_assert!((again - meant).abs() < 1e-5 * meant.abs().max(1.0), "{again} {meant}");
            }
        }
    }
}
