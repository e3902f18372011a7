//! The dual simplex method against Clarabel, from nothing and from a parent's basis.

use crate::common::config;
use carom::solver::StopToken;
use carom_solver::internals::presolve::{Compressed, Reduced};
use carom_solver::internals::relaxation::{
    ClarabelRelaxation, DualSimplex, Effort, Prover, Relaxation, RelaxationClaim, RelaxationResult,
    WarmState,
};
use proptest::prelude::*;

const INF: f64 = f64::INFINITY;

/// Columns and coefficients of a row.
type Entries = Vec<(usize, i32)>;

#[derive(Debug, Clone)]
struct Case {
    /// A lower bound and a width; a width of 7 stands for no upper bound.
    columns: Vec<(i32, i32)>,
    /// Entries, a lower limit and a width; a width of 0 stands for an equality, 7 for no upper
    /// limit.
    rows: Vec<(Entries, i32, i32)>,
    cost: Vec<i32>,
    /// The column that the child holds, and the part of the way to its upper bound.
    held: (usize, i32),
    /// The row that the child has not.
    dropped: usize,
}

fn case() -> impl Strategy<Value = Case> {
    (3usize..12).prop_flat_map(|n| {
        let entries = prop::collection::vec((0..n, -4..=4), 2..5);
        (
            prop::collection::vec((-5..=5, 1..=7), n),
            prop::collection::vec((entries, -9..=9, 0..=7), 1..9),
            prop::collection::vec(-5..=5, n),
            (0..n, 0..=2),
            0..9usize,
        )
            .prop_map(|(columns, rows, cost, held, dropped)| Case {
                columns,
                rows,
                cost,
                held,
                dropped,
            })
    })
}

impl Case {
    /// The program; the child lacks a column and a row.
    fn program(&self, is_child: bool) -> Reduced {
        let held = is_child.then_some(self.held.0);
        let columns: Vec<usize> = (0..self.columns.len()).filter(|j| Some(*j) != held).collect();
        let mut position = vec![usize::MAX; self.columns.len()];
        columns.iter().enumerate().for_each(|(k, &j)| position[j] = k);
        let bounds = |j: usize| {
            let (lower, width) = self.columns[j];
            let upper = if width == 7 { INF } else { f64::from(lower + width) };
            [f64::from(lower), upper]
        };
        let value = f64::from(self.columns[self.held.0].0 + self.held.1);
        let cost = |j: usize| f64::from(self.cost[j]);
        let mut reduced = Reduced {
            values: vec![0.0; self.columns.len()],
            linear: columns.iter().map(|&j| cost(j)).collect(),
            offset: held.map_or(0.0, |j| value * cost(j)),
            lower: columns.iter().map(|&j| bounds(j)[0]).collect(),
            upper: columns.iter().map(|&j| bounds(j)[1]).collect(),
            rows: Compressed { start: vec![0], ..Compressed::default() },
            quadratic: Compressed { start: vec![0; columns.len() + 1], ..Compressed::default() },
            columns,
            ..Reduced::default()
        };
        for (name, (entries, lower, width)) in self.rows.iter().enumerate() {
            if is_child && name == self.dropped {
                continue;
            }
            let mut dense = vec![0; self.columns.len()];
            entries.iter().for_each(|&(j, a)| dense[j] += a);
            let constant = held.map_or(0.0, |j| value * f64::from(dense[j]));
            for (j, &a) in dense.iter().enumerate().filter(|(j, a)| **a != 0 && Some(*j) != held) {
                reduced.rows.index.push(position[j]);
                reduced.rows.value.push(f64::from(a));
            }
            reduced.rows.start.push(reduced.rows.index.len());
            reduced.origin.push(name);
            reduced.row_lower.push(f64::from(*lower) - constant);
            let upper = if *width == 7 { INF } else { f64::from(lower + width) - constant };
            reduced.row_upper.push(upper);
        }
        reduced
    }
}

fn solve(program: &Reduced, cutoff: f64, warm: Option<&WarmState>) -> RelaxationResult {
    let token = StopToken::default();
    let effort =
        Effort { iterations: 500, tolerance: 1e-9, refinements: 1, cutoff, token: &token, warm };
    DualSimplex::new().solve(program, &effort)
}

/// Whether the objective falls along a ray that no bound and no row ends.
fn falls_without_end(program: &Reduced, ray: &[f64]) -> bool {
    let is_kept = |step: f64, lower: f64, upper: f64| {
        (step >= -1e-9 || lower == -INF) && (step <= 1e-9 || upper == INF)
    };
    let columns = ray.iter().zip(&program.lower).zip(&program.upper);
    let rows = (0..program.row_lower.len()).map(|i| {
        let (index, value) = program.rows.vector(i);
        let step = index.iter().zip(value).map(|(&j, a)| a * ray[j]).sum();
        (step, program.row_lower[i], program.row_upper[i])
    });
    let falls = program.linear.iter().zip(ray).map(|(q, step)| q * step).sum::<f64>() < 0.0;
    falls
        && columns
            .map(|((step, l), u)| (*step, *l, *u))
            .chain(rows)
            .all(|(s, l, u)| is_kept(s, l, u))
}

/// What is claimed holds, and Clarabel does not say otherwise. Returns whether there is a claim.
fn check(program: &Reduced, answer: &RelaxationResult) -> Result<bool, TestCaseError> {
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
        RelaxationClaim::Unbounded => {
            prop_assert!(falls_without_end(program, &answer.x), "{:?}", answer);
            prop_assert!(other.claim != RelaxationClaim::Solved, "{:?}", answer);
        }
        RelaxationClaim::Unknown => return Ok(false),
        RelaxationClaim::Beyond => prop_assert!(false, "{:?}", answer),
    }
    Ok(true)
}

proptest! {
    #![proptest_config(config(64, "tests/regressions/simplex.txt"))]

    #[test]
    fn claims_hold_from_any_start(case in case(), below in 0.01..3.0_f64) {
        let (parent, child) = (case.program(false), case.program(true));
        prop_assume!(DualSimplex::suits(&parent) && DualSimplex::suits(&child));
        let above = solve(&parent, INF, None);
        check(&parent, &above)?;
        let warm = solve(&child, INF, above.warm.as_ref());
        check(&child, &warm)?;
        if warm.claim == RelaxationClaim::Solved {
            let again = solve(&child, INF, warm.warm.as_ref());
            prop_assert_eq!(again.claim, RelaxationClaim::Solved);
            prop_assert_eq!(again.iterations, 0);
            let cutoff = child.objective(&warm.x) - below;
            let stopped = solve(&child, cutoff, above.warm.as_ref());
            prop_assert_eq!(stopped.claim, RelaxationClaim::Beyond);
            prop_assert!(Prover::default().lower_bound(&child, &stopped.x, &stopped.y) >= cutoff, "{:?}", stopped);
        }
    }
}

/// It gives up on few programs, because another method costs more.
#[test]
fn most_programs_are_settled() {
    use proptest::strategy::ValueTree;
    let mut runner = proptest::test_runner::TestRunner::deterministic();
    let (mut all, mut settled) = (0, 0);
    for _ in 0..200 {
        let Ok(case) = case().new_tree(&mut runner).map(|tree| tree.current()) else { continue };
        let (parent, child) = (case.program(false), case.program(true));
        if !DualSimplex::suits(&child) || case.columns.iter().any(|c| c.1 == 7) {
            continue;
        }
        let above = solve(&parent, INF, None);
        all += 1;
        let answer = solve(&child, INF, above.warm.as_ref());
        settled += usize::from(answer.claim != RelaxationClaim::Unknown);
    }
    assert!(all > 50 && settled + 3 >= all, "{settled} of {all}");
}

/// Two rows that say the same up to rounding have a point, however exact a leaf is wanted.
#[test]
fn what_rounding_refutes_is_solved() {
    let off = 1.0 + 1e-12;
    let program = Reduced {
        columns: vec![0, 1],
        values: vec![0.0; 2],
        linear: vec![1.0, 2.0],
        lower: vec![0.0; 2],
        upper: vec![5.0; 2],
        rows: Compressed { start: vec![0, 2, 4], index: vec![0, 1, 0, 1], value: vec![1.0; 4] },
        row_lower: vec![1.0, off],
        row_upper: vec![1.0, off],
        quadratic: Compressed { start: vec![0; 3], ..Compressed::default() },
        ..Reduced::default()
    };
    let token = StopToken::default();
    let effort = Effort {
        iterations: u32::MAX,
        tolerance: 1e-14,
        refinements: 1,
        cutoff: INF,
        token: &token,
        warm: None,
    };
    let answer = DualSimplex::new().solve(&program, &effort);
    assert_eq!(answer.claim, RelaxationClaim::Solved);
    assert!((answer.x[0] - 1.0).abs() < 1e-9 && answer.x[1].abs() < 1e-9, "{:?}", answer.x);
}
