//! The active-set method against Clarabel, from nothing and from a parent's multipliers.

use crate::common::config;
use carom::solver::StopToken;
use carom_solver::internals::presolve::{Compressed, Reduced};
use carom_solver::internals::relaxation::{
    ActiveSet, ClarabelRelaxation, Effort, Prover, Relaxation, RelaxationClaim, RelaxationResult,
    WarmState,
};
use proptest::prelude::*;

const INF: f64 = f64::INFINITY;

#[derive(Debug, Clone)]
struct Case {
    /// A lower bound and a width; a width of 0 stands for no bounds.
    columns: Vec<(i32, i32)>,
    /// Coefficients, a lower limit and a width; a width of 0 stands for an equality, 7 for no upper
    /// limit.
    rows: Vec<(Vec<i32>, i32, i32)>,
    /// The objective's squares.
    squares: Vec<Vec<i32>>,
    linear: Vec<i32>,
    /// What the child fixes: a column, and the part of the way between its bounds.
    fixed: (usize, i32),
    /// Whether there are directions without curvature, within bounds.
    is_flat: bool,
}

fn case() -> impl Strategy<Value = Case> {
    (2usize..10).prop_flat_map(|n| {
        let vector = move || prop::collection::vec(-4..=4, n);
        (
            prop::collection::vec((-5..=5, 0..=6), n),
            prop::collection::vec((vector(), -9..=9, 0..=7), 0..8),
            prop::collection::vec(vector(), n..n + 3),
            vector(),
            (0..n, 0..=2),
            any::<bool>(),
        )
            .prop_map(|(columns, rows, squares, linear, fixed, is_flat)| Case {
                columns,
                rows,
                squares,
                linear,
                fixed,
                is_flat,
            })
    })
}

impl Case {
    fn program(&self) -> Reduced {
        let n = self.columns.len();
        let mut reduced = Reduced {
            columns: (0..n).collect(),
            values: vec![0.0; n],
            linear: self.linear.iter().map(|&q| f64::from(q)).collect(),
            rows: Compressed { start: vec![0], ..Compressed::default() },
            quadratic: Compressed { start: vec![0], ..Compressed::default() },
            origin: (0..self.rows.len()).collect(),
            ..Reduced::default()
        };
        for &(lower, width) in &self.columns {
            let width = if self.is_flat { width.max(1) } else { width };
            let bounds = [f64::from(lower), f64::from(lower + width)];
            let [lower, upper] = if width == 0 { [-INF, INF] } else { bounds };
            reduced.lower.push(lower);
            reduced.upper.push(upper);
        }
        for j in 0..n {
            for i in 0..=j {
                let squares =
                    if self.is_flat { &self.squares[..n.div_ceil(2)] } else { &self.squares };
                let sum: i32 = squares.iter().map(|s| s[i] * s[j]).sum();
                let has_ridge = i == j && (i == 0 || !self.is_flat);
                let ridge = if has_ridge { 0.5 } else { 0.0 };
                reduced.quadratic.index.push(i);
                reduced.quadratic.value.push(f64::from(sum) + ridge);
            }
            reduced.quadratic.start.push(reduced.quadratic.index.len());
        }
        for (coefficients, lower, width) in &self.rows {
            for (j, &a) in coefficients.iter().enumerate().filter(|(_, a)| **a != 0) {
                reduced.rows.index.push(j);
                reduced.rows.value.push(f64::from(a));
            }
            reduced.rows.start.push(reduced.rows.index.len());
            reduced.row_lower.push(f64::from(*lower));
            reduced.row_upper.push(if *width == 7 { INF } else { f64::from(lower + width) });
        }
        reduced
    }

    /// The program with one column held.
    fn child(&self) -> Reduced {
        let mut child = self.program();
        let (j, part) = self.fixed;
        let value = match child.lower[j].is_finite() {
            true => child.lower[j] + 0.5 * f64::from(part) * (child.upper[j] - child.lower[j]),
            false => f64::from(part),
        };
        (child.lower[j], child.upper[j]) = (value, value);
        child
    }
}

fn solve(program: &Reduced, cutoff: f64, warm: Option<&WarmState>) -> RelaxationResult {
    let token = StopToken::default();
    let effort =
        Effort { iterations: 500, tolerance: 1e-9, refinements: 1, cutoff, token: &token, warm };
    ActiveSet::new().solve(program, &effort)
}

/// The claim holds, and Clarabel says the same.
fn check(program: &Reduced, answer: &RelaxationResult) -> Result<(), TestCaseError> {
    let token = StopToken::default();
    let effort = Effort {
        iterations: 200,
        tolerance: 1e-9,
        refinements: 10,
        cutoff: INF,
        token: &token,
        warm: None,
    };
    let other = ClarabelRelaxation::new().solve(program, &effort);
    match answer.claim {
        RelaxationClaim::Solved => {
            let value = program.objective(&answer.x);
            let bound = Prover::default().lower_bound(program, &answer.x, &answer.y);
            let scale = value.abs().max(1.0);
            prop_assert!(value - bound <= 1e-7 * scale, "{} to {}: {:?}", bound, value, answer);
            prop_assert!(other.claim != RelaxationClaim::Infeasible, "{:?}", answer);
            if other.claim == RelaxationClaim::Solved {
                let theirs = program.objective(&other.x);
                prop_assert!((value - theirs).abs() <= 1e-6 * scale, "{} and {}", value, theirs);
            }
        }
        RelaxationClaim::Infeasible => {
            prop_assert!(Prover::default().proves_infeasible(program, &answer.y), "{:?}", answer);
            prop_assert!(other.claim != RelaxationClaim::Solved, "{:?}", answer);
        }
        _ => prop_assert!(false, "{:?}", answer),
    }
    Ok(())
}

proptest! {
    #![proptest_config(config(64, "tests/regressions/active_set.txt"))]

    #[test]
    fn the_optimum_is_found_from_any_start(case in case(), below in 0.01..3.0_f64) {
        let (parent, child) = (case.program(), case.child());
        let above = solve(&parent, INF, None);
        check(&parent, &above)?;
        let cold = solve(&child, INF, None);
        check(&child, &cold)?;
        let warm = solve(&child, INF, above.warm.as_ref());
        check(&child, &warm)?;
        prop_assert_eq!(cold.claim, warm.claim);
        if warm.claim == RelaxationClaim::Solved {
            let again = solve(&child, INF, warm.warm.as_ref());
            prop_assert!(again.iterations <= 2, "{:?}", again);
            let value = child.objective(&cold.x);
            let cutoff = value - below * (1e-5 * value.abs()).max(1.0);
            let stopped = solve(&child, cutoff, above.warm.as_ref());
            prop_assert_eq!(stopped.claim, RelaxationClaim::Beyond);
            prop_assert!(Prover::default().lower_bound(&child, &stopped.x, &stopped.y) >= cutoff, "{:?}", stopped);
        }
    }
}

/// `1/2 (x + y)^2 + x + 2 y` on a line on which the squares are constant.
#[test]
fn directions_without_curvature_end_at_a_bound() {
    let case = Case {
        columns: vec![(0, 1), (0, 1)],
        rows: vec![(vec![1, 1], 1, 0)],
        squares: Vec::new(),
        linear: vec![1, 2],
        fixed: (0, 0),
        is_flat: false,
    };
    let mut program = case.program();
    program.quadratic.value = vec![1.0, 1.0, 1.0];
    let answer = solve(&program, INF, None);
    assert_eq!(answer.claim, RelaxationClaim::Solved);
    assert!((program.objective(&answer.x) - 1.5).abs() < 1e-9, "{answer:?}");
    program.quadratic = Compressed { start: vec![0; 3], ..Compressed::default() };
    assert!(!ActiveSet::suits(&program));
}
