//! Perspectives: the same cost at whole points, never above the hull, convex, and right answers.

use carom::prelude::*;
use carom::solver::StopToken;
use carom_solver::internals::program::Program;
use carom_solver::internals::search::perspective::{Switched, switched_squares, with_slopes};
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
}
