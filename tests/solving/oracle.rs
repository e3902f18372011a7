//! The solver agrees with brute force.
//!
//! Random small programs (binaries, integers, continuous and free variables, equalities, ranges,
//! duplicate rows, indicators of both polarities; linear and convex quadratic objectives, to
//! minimise and to maximise) are answered exactly by trying every assignment of the integers and
//! solving what is left through its optimality conditions. Status and optimum must agree, the
//! returned bound must never exceed the true optimum, and the returned point must satisfy every
//! statement by this file's own arithmetic.

use crate::common::case::Case;
use crate::common::config;
use crate::common::enumeration::{optimum, relaxed_optimum};
use crate::common::generate::{Shape, case};
use crate::common::quadratic_program::Minimum;
use carom::prelude::*;
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
    #![proptest_config(config(500, "tests/regressions/oracle.txt"))]

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

/// Programs that some state of the solver answered wrongly or not at all, in their smallest form.
mod regressions {
    use super::*;

    const NONE: f64 = f64::INFINITY;

    /// Solves a model of continuous variables with the given bounds; statements and objective are
    /// added by `write`.
    fn solve(
        bounds: &[(f64, f64)],
        write: impl FnOnce(&mut Model, &[Variable]) -> Result<(), Error>,
    ) -> Solution {
        let mut model = Model::new("regression");
        let variable = |(j, &(lower, upper)): (usize, &(f64, f64))| {
            model.continuous(format!("v{j}"), lower, upper).expect("a variable")
        };
        let variables: Vec<Variable> = bounds.iter().enumerate().map(variable).collect();
        write(&mut model, &variables).expect("a model");
        BranchAndBound::default().solve(&model).expect("a solvable model")
    }

    fn assert_optimal(solution: &Solution, value: f64) {
        assert_eq!(solution.termination(), Termination::Optimal, "{solution:?}");
        let objective = solution.objective().expect("a point");
        assert!((objective - value).abs() <= 1e-6 * value.abs().max(1.0), "{objective}");
        let gap = 1e-7_f64.max(1e-6 * value.abs());
        assert!((solution.bound() - value).abs() <= 2.0 * gap, "{}", solution.bound());
    }

    /// Rounding of the gradient was charged over the free radius, also where the gradient is
    /// plainly positive.
    #[test]
    fn bound_over_a_half_line() {
        let linear = solve(&[(0.5, NONE)], |m, v| m.minimize(3.0 * v[0]));
        assert_optimal(&linear, 1.5);
        let curved = solve(&[(-NONE, 0.5)], |m, v| m.minimize(0.5 * (v[0] + 2.0).square()));
        assert_optimal(&curved, 0.0);
    }

    /// Free columns with and without curvature could not be corrected together.
    #[test]
    fn curved_and_flat_free_columns() {
        let solution = solve(&[(-NONE, NONE), (-NONE, 0.0), (-NONE, NONE)], |m, v| {
            m.minimize(0.5 * (v[0] - 3.5).square())
        });
        assert_optimal(&solution, 0.0);
    }

    /// Tiny multipliers of rows that do not press blocked the correction.
    #[test]
    fn multipliers_that_should_be_zero() {
        let solution = solve(&[(-NONE, NONE), (-NONE, NONE)], |m, v| {
            m.add("r", (v[0] + v[1]).le(0.0))?;
            m.minimize(0.5 * v[0].square())
        });
        assert_optimal(&solution, 0.0);
        let solution = solve(&[(-NONE, 0.0), (0.0, NONE), (-NONE, 0.5)], |m, v| {
            m.add("r0", (2.0 * v[0] + 3.0 * v[1]).equals(0.0))?;
            m.add("r1", (0.5 * v[2] - v[0]).ge(0.0))?;
            m.minimize(-v[0] - 1.5 * v[1])
        });
        assert_optimal(&solution, 0.0);
    }

    /// Rows in very different units next to half-lines.
    #[test]
    fn corrections_across_units() {
        let solution = solve(&[(-NONE, 0.0), (0.0, NONE)], |m, v| {
            m.add("large", (512.0 * v[0] + 1024.0 * v[1]).equals(0.0))?;
            m.add("small", (0.0009765625 * v[0] + 0.0009765625 * v[1]).ge(-0.0009765625))?;
            m.minimize(-1.0 * v[1])
        });
        assert_optimal(&solution, -1.0);
    }

    /// The backend names no ray where curvature and a free column meet.
    #[test]
    fn unbounded_beside_curvature() {
        let solution = solve(&[(-NONE, NONE)], |m, v| {
            m.integer("idle", 0.0, 4.0)?;
            m.binary("idle_too")?;
            let curved = m.integer("curved", 1.0, 3.0)?;
            m.minimize(v[0] + 2.0 * curved.square() - 5.0 * curved)
        });
        assert_eq!(solution.termination(), Termination::Unbounded);
        assert_eq!(solution.bound(), -NONE);
    }

    /// The backend "solved" this unbounded program at 1e14, outside the radius of all bounds.
    #[test]
    fn unbounded_along_a_valley() {
        let solution = solve(&[(-NONE, 0.0), (-NONE, NONE), (-NONE, 0.0)], |m, v| {
            let slopes = -14.0 * v[0] + 6.0 * v[1] - 17.5 * v[2];
            m.minimize(4.0 * v[0].square() + (v[1] - 3.0 * v[2]).square() + slopes)
        });
        assert_eq!(solution.termination(), Termination::Unbounded);
    }

    /// Small coefficients and curvatures are not zero: these optima are far away, but finite.
    #[test]
    fn far_optima_are_not_rays() {
        let solution = solve(&[(-NONE, NONE), (-NONE, NONE)], |m, v| {
            m.add("r", (1e-8 * v[0] - 1e-8 * v[1]).le(1.0))?;
            m.maximize(v[0] - v[1])
        });
        assert_optimal(&solution, 1e8);
        let solution = solve(&[(-NONE, NONE)], |m, v| m.minimize(1e-8 * v[0].square() - v[0]));
        assert_optimal(&solution, -2.5e7);
    }

    /// The objective's large constant hid that the leaf was solved to 1e-7 only.
    #[test]
    fn leaf_with_a_large_constant() {
        let solution = solve(&[(1.0, 1.5), (-1.0, 0.5), (7.0, 7.0), (0.0, NONE)], |m, v| {
            let inner = v[0] + 2.0 * v[1] - 3.0 * v[2] + v[3] + 3.75;
            let rest = 4.5 * v[0].square() + 4.0 * v[1] - 3.0 * v[2] + 10.0 * v[0];
            m.minimize(2.0 * inner.square() + rest + 10.375)
        });
        assert_optimal(&solution, -0.125);
    }

    /// A row side implied "up to 1e-9 of the big-M" was dropped and then missed.
    #[test]
    fn equality_behind_a_large_big_m() {
        let mut model = Model::new("margin");
        let on = model.binary("on").expect("a name");
        let v = model.continuous("v", 2.0, 4.5).expect("bounds");
        model.add("is_on", (-3.0 * on).equals(-3.0)).expect("a row");
        model.add("same", on.on().implies((512.0 * v).equals(1024.0))).expect("an indicator");
        model.minimize(4.5 * v.square()).expect("convex");
        let solution = BranchAndBound::default().solve(&model).expect("solvable");
        assert_optimal(&solution, 18.0);
    }

    /// The backend gave up after three iterations: a row of 1e5 beside a curvature of 1.
    #[test]
    fn large_row_beside_curvature() {
        let bounds = [(-NONE, 2.0), (-NONE, NONE), (-1.0, 0.5)];
        let solution = solve(&bounds, |m, v| {
            m.add("r", (131072.0 * v[0] - 65536.0 * v[2]).equals(196608.0))?;
            let inner = v[0] - 3.0 * v[1] - v[2];
            m.minimize(0.5 * inner.square() + 2.0 * v[1].square() - 5.0 * v[1] + 3.125)
        });
        // By hand: v0 = 1.5 + v2 / 2, so v2 >= -1 makes v0 = 1 at best for v1 = 11/13.
        assert_optimal(&solution, 2.0 - 121.0 / 26.0 + 3.125);
    }

    /// Points of an interior-point method miss rows with large coefficients by too much.
    #[test]
    fn vertices_of_large_rows() {
        let solution = solve(&[(0.0, NONE), (-NONE, 0.0), (0.0, NONE)], |m, v| {
            m.add("r0", (0.5 * v[2] - v[1]).le(0.5))?;
            m.add("r1", (1024.0 * v[2] - 1536.0 * v[1]).ge(1024.0))?;
            m.minimize(v[1])
        });
        assert_optimal(&solution, 0.0);
        let solution = solve(&[(-NONE, NONE), (-NONE, 1.5)], |m, v| {
            m.add("r0", (0.5 * v[0] - v[1]).ge(-2.5))?;
            m.add("r1", (-512.0 * v[1]).within(-768.0, -640.0))?;
            m.minimize(3.0 * v[0])
        });
        assert_optimal(&solution, -7.5);
        let solution = solve(&[(-NONE, 1.5), (0.0, 0.5)], |m, v| {
            m.add("r0", (v[0] - v[1]).equals(0.0))?;
            m.add("r1", (-3072.0 * v[1]).le(1.0))?;
            m.minimize(0.125 * v[0].square() + 1.25 * v[0] + 2.0 * v[1] + 3.125)
        });
        assert_optimal(&solution, 3.125);
    }

    /// Three rows lost all their columns in the last sweep of the reduction: a panic.
    #[test]
    fn chain_written_backwards() {
        let solution = solve(&[(-10.0, 10.0); 4], |m, v| {
            m.add("r0", (v[2] + v[3]).equals(4.0))?;
            m.add("r1", (v[2] - v[3]).equals(0.0))?;
            m.add("r2", (2.0 * v[2] + v[3]).equals(6.0))?;
            m.add("r3", (v[3] - v[1]).equals(0.0))?;
            m.add("r4", (v[2] - v[1]).equals(0.0))?;
            m.add("r5", (v[1] - v[0]).equals(0.0))?;
            m.add("r6", v[0].equals(2.0))?;
            m.minimize(v[2])
        });
        assert_optimal(&solution, 2.0);
    }

    /// Bounds that are finite but meant as none.
    #[test]
    fn far_bounds() {
        for far in [1e6, 1e9, 1e12] {
            let solution = solve(&[(-far, far), (-far, far)], |m, v| {
                m.add("r0", (v[0] - v[1]).ge(1.0))?;
                m.add("r1", (v[0] + v[1]).ge(2.0))?;
                m.minimize((2.0 * v[0] + 0.5).square())
            });
            assert_optimal(&solution, 12.25);
        }
    }
}
