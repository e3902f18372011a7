//! Perspectives: the same cost at whole points, never above the hull, convex, and right answers.

use carom::prelude::*;
use carom::solver::StopToken;
use carom_solver::internals::branch_and_bound::search_tightened;
use carom_solver::internals::program::Program;
use carom_solver::internals::relaxation::CascadePool;
use carom_solver::internals::search::SolveTask;
use carom_solver::internals::search::perspective::{
    Switched, squares_as_cones, switched_squares, with_slopes,
};
use proptest::prelude::*;

use crate::common::case::{Case, Column, Line, Square};
use crate::common::config;
use crate::common::judge::is_right;

const REGRESSIONS: &str = "tests/regressions/perspective.txt";

const UNITS: usize = 3;

/// Units: their powers come first, then their binaries.
fn units() -> impl Strategy<Value = Case> {
    let unit = (1u8..=8, 0u8..=3, 1u8..=4, any::<bool>(), -2i8..=2, -6i8..=12);
    let units = prop::collection::vec(unit, UNITS);
    (units, 0u8..=12, any::<bool>()).prop_map(|(units, demand, maximize)| {
        let (mut columns, mut lines) = (Vec::new(), Vec::new());
        let (mut squares, mut linear) = (Vec::new(), vec![0.0; 2 * UNITS]);
        for (j, &(most, least, weight, inverted, cost, start)) in units.iter().enumerate() {
            let (most, least) = (f64::from(most), f64::from(least.min(most - 1)));
            columns.push(Column { kind: VariableKind::Continuous, lower: 0.0, upper: most });
            // `p <= most w` and `p >= least w`, where `w` is the binary or its opposite.
            let limit = |a: f64, sign: f64| {
                let mut coefficients = vec![0.0; 2 * UNITS];
                coefficients[j] = sign;
                coefficients[UNITS + j] = if inverted { sign * a } else { -sign * a };
                let upper = if inverted { sign * a } else { 0.0 };
                Line { coefficients, lower: f64::NEG_INFINITY, upper, scale: 1.0 }
            };
            lines.push(limit(most, 1.0));
            lines.push(limit(least, -1.0));
            let mut coefficients = vec![0.0; 2 * UNITS];
            coefficients[j] = 1.0;
            let weight = 0.25 * f64::from(weight);
            squares.push(Square { weight, coefficients, constant: 0.0 });
            (linear[j], linear[UNITS + j]) = (f64::from(cost), f64::from(start));
        }
        columns.extend((0..UNITS).map(|_| Column {
            kind: VariableKind::Binary,
            lower: 0.0,
            upper: 1.0,
        }));
        let mut coefficients = vec![0.0; 2 * UNITS];
        coefficients[..UNITS].fill(1.0);
        let lower = f64::from(demand);
        lines.push(Line { coefficients, lower, upper: f64::INFINITY, scale: 1.0 });
        Case { columns, lines, switches: Vec::new(), squares, linear, constant: 2.0, maximize }
    })
}

fn program_of(case: &Case) -> Program {
    Program::assemble(&case.build().0).unwrap()
}

/// How far a square is on.
fn on(square: &Switched, x: &[f64]) -> f64 {
    if square.off_at_one { 1.0 - x[square.binary] } else { x[square.binary] }
}

proptest! {
    #![proptest_config(config(150, REGRESSIONS))]

    #[test]
    fn functions_lie_between_the_square_and_its_hull(
        case in units(),
        slopes in prop::collection::vec(-3.0..10.0f64, UNITS),
        parts in prop::collection::vec((0.0..=1.0f64, 0.0..=1.0f64), UNITS),
        way in prop::collection::vec(-1.0..=1.0f64, 2 * UNITS),
    ) {
        let program = program_of(&case);
        let squares = switched_squares(&program, &StopToken::default());
        prop_assert_eq!(squares.len(), UNITS);
        let tighter = with_slopes(&program, &squares, &slopes).unwrap();
        // Whole points cost the same; others at most what the perspective says.
        for whole in [true, false] {
            let mut x = vec![0.0; 2 * UNITS];
            let mut hull = 0.0;
            for (square, &(w, d)) in squares.iter().zip(&parts) {
                let w = if whole { w.round() } else { w };
                let d = d * w * program.upper[square.column];
                x[square.column] = d;
                x[square.binary] = if square.off_at_one { 1.0 - w } else { w };
                if w > 0.0 {
                    hull += 0.5 * square.curvature * d * d * (1.0 / w - 1.0);
                }
                prop_assert!((on(square, &x) - w).abs() < 1e-12);
            }
            let (plain, tight) = (program.objective(&x), tighter.objective(&x));
            prop_assert!(tight <= plain + hull + 1e-9, "{tight} above {plain} + {hull}");
            prop_assert!(!whole || (tight - plain).abs() <= 1e-9, "{tight} instead of {plain}");
        }
        let zero = vec![0.0; 2 * UNITS];
        let opposite: Vec<f64> = way.iter().map(|v| -v).collect();
        let curvature = tighter.objective(&way) + tighter.objective(&opposite);
        prop_assert!(curvature >= 2.0 * tighter.objective(&zero) - 1e-9);
    }

    #[test]
    fn answers_are_right(case in units()) {
        prop_assume!(!case.maximize);
        let solution = BranchAndBound::default().solve(&case.build().0).unwrap();
        is_right(&case, &solution)?;
    }

    #[test]
    fn cones_cost_what_the_hull_says(
        case in units(),
        parts in prop::collection::vec((0.0..=1.0f64, 0.0..=1.0f64), UNITS),
    ) {
        let program = program_of(&case);
        let squares = switched_squares(&program, &StopToken::default());
        // A demand that all units have to meet leaves nothing to switch.
        let stated = squares_as_cones(&program, &StopToken::default());
        prop_assume!(stated.is_some());
        let stated = stated.unwrap();
        prop_assert_eq!(stated.cones.len(), UNITS);
        let is_switched = |column: usize| {
            let cone = stated.cones.iter().find(|cone| cone.columns[2] == column).unwrap();
            stated.lower[cone.columns[1]] == 0.0
        };
        for whole in [true, false] {
            let mut x: Vec<f64> = stated.upper.clone();
            let mut hull = 0.0;
            for (square, &(w, d)) in squares.iter().zip(&parts) {
                let w = if whole { w.round() } else { w.max(1e-3) };
                let d = d * w * program.upper[square.column];
                x[square.column] = d;
                x[square.binary] = if square.off_at_one { 1.0 - w } else { w };
                hull += if w > 0.0 && is_switched(square.column) { 0.5 * square.curvature * d * d * (1.0 / w - 1.0) } else { 0.0 };
            }
            // Further columns: those between binaries and cones first, then the heads.
            for row in program.row_count()..stated.row_count() {
                let (columns, values) = stated.row(row);
                let (&new, &a) = columns.iter().zip(values).next_back().unwrap();
                let others = columns.iter().zip(values).filter(|(j, _)| **j != new);
                let others: f64 = others.map(|(&j, a)| a * x[j]).sum();
                x[new] = (stated.row_upper[row] - others) / a;
            }
            for cone in &stated.cones {
                let [head, times, entry] = cone.columns[..] else { panic!("{cone:?}") };
                x[head] = if x[entry] == 0.0 { 0.0 } else { x[entry] * x[entry] / x[times] };
                prop_assert!(x[head] <= stated.upper[head] + 1e-9);
                prop_assert!(cone.miss(&x) <= 1e-9);
            }
            let plain = program.objective(&x[..program.column_count()]);
            let says = stated.objective(&x);
            prop_assert!((says - plain - hull).abs() <= 1e-6, "{says}, not {plain} + {hull}");
        }
    }

    #[test]
    fn cones_lead_to_the_same_answers(case in units()) {
        prop_assume!(!case.maximize);
        let (program, options, token) = (program_of(&case), Options::default(), StopToken::default());
        let stated = squares_as_cones(&program, &token);
        prop_assume!(stated.is_some());
        let stated = stated.unwrap();
        let (cascades, accept) = (CascadePool::new(&options), |_: &[f64]| true);
        let find = |program: &Program| {
            let found =
                search_tightened(SolveTask::new(program, &accept, &cascades, &options, &token));
            (found.termination, found.points.first().map(|x| program.objective(x)), found.bound)
        };
        let (before, after) = (find(&program), find(&stated));
        prop_assert_eq!(before.0, after.0);
        if let (Some(before), Some(value)) = (before.1, after.1) {
            prop_assert!((before - value).abs() <= 1e-5 * before.abs().max(1.0), "{before} {value}");
            prop_assert!(after.2 <= value + 1e-6 * value.abs().max(1.0));
        }
    }
}
