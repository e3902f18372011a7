//! The solver agrees with brute force.
//!
//! Random small programs (binaries, integers, continuous and free variables, equalities, ranges,
//! duplicate rows, indicators of both polarities; linear and convex quadratic objectives, to
//! minimise and to maximise) are answered exactly by trying every assignment of the integers and
//! solving what is left through its optimality conditions. Status and optimum must agree, the
//! returned bound must never exceed the true optimum, and the returned point must satisfy every
//! statement by this file's own arithmetic.

mod common;

use carom::prelude::*;
use common::case::Case;
use common::config;
use common::enumeration::{optimum, relaxed_optimum};
use common::generate::{Shape, case};
use common::quadratic_program::Minimum;
use proptest::prelude::*;

/// Agreement of objectives, relative and absolute.
const AGREEMENT: f64 = 1e-6;

/// Feasibility tolerance that points are promised to keep, in the row's unit.
const FEASIBILITY: f64 = 1e-6;

fn compare(case: &Case) -> Result<(), TestCaseError> {
    let (model, variables) = case.build();
    let solution = BranchAndBound::default().solve(&model).expect("a solvable model");
    let (sign, termination) = (case.sign(), solution.termination());
    let worst = sign * f64::INFINITY;
    // The point first: whatever the status, it must be what the solution says it is.
    if let Some(point) = solution.point() {
        let x: Vec<f64> = variables.iter().map(|&v| point.value(v).expect("a value")).collect();
        let violation = case.violation(&x, FEASIBILITY);
        prop_assert!(violation.is_none(), "{}\n{model}", violation.unwrap_or_default());
        let (own, theirs) = (sign * case.cost(&x), solution.objective().expect("an objective"));
        prop_assert!(
            (own - theirs).abs() <= 1e-9 * own.abs().max(1.0),
            "{own} or {theirs}\n{model}"
        );
    }
    match optimum(case) {
        Minimum::Infeasible => {
            let relaxed = scaled_down(case)
                && relaxed_optimum(case, 2.0 * FEASIBILITY) != Minimum::Infeasible;
            if !relaxed {
                prop_assert_eq!(termination, Termination::Infeasible, "infeasible\n{}", model);
                prop_assert_eq!(solution.bound(), worst);
                prop_assert!(solution.point().is_none());
            }
        }
        Minimum::Unbounded => {
            prop_assert_eq!(termination, Termination::Unbounded, "unbounded\n{}", model);
            prop_assert_eq!(solution.bound(), -worst);
        }
        Minimum::Attained { value, .. } => {
            prop_assert_eq!(termination, Termination::Optimal, "optimum {}\n{}", value, model);
            let cost = sign * solution.objective().expect("an objective");
            let tolerance = AGREEMENT * value.abs().max(1.0);
            prop_assert!(cost <= value + tolerance, "{cost} instead of {value}\n{model}");
            let bound = sign * solution.bound();
            prop_assert!(
                bound <= value + 1e-9 * value.abs().max(1.0),
                "bound {bound} above {value}\n{model}"
            );
            if cost < value - tolerance {
                let least = match relaxed_optimum(case, FEASIBILITY) {
                    Minimum::Attained { value, .. } if scaled_down(case) => value,
                    _ => value,
                };
                prop_assert!(
                    cost >= least - tolerance,
                    "{cost} is below {value} ({least})\n{model}"
                );
            }
        }
    }
    Ok(())
}

/// Whether a tolerance in a row's unit is more than the same tolerance in the variables' units.
fn scaled_down(case: &Case) -> bool {
    let lines = case.lines.iter().chain(case.switches.iter().map(|s| &s.line));
    lines.into_iter().any(|line| line.scale < 1.0)
}

proptest! {
    #![proptest_config(config(250, "tests/regressions/oracle.txt"))]

    #[test]
    fn linear_programs(case in case(Shape::LINEAR)) {
        compare(&case)?;
    }

    #[test]
    fn quadratic_programs(case in case(Shape::QUADRATIC)) {
        compare(&case)?;
    }

    #[test]
    fn rows_in_other_units(case in case(Shape::SCALED)) {
        compare(&case)?;
    }

    #[test]
    fn feasibility_problems(case in case(Shape::FEASIBILITY)) {
        compare(&case)?;
    }
}
