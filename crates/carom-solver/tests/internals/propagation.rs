//! What presolve and the bound computation conclude is true: propagation and probing never remove
//! a feasible point, a reduced program has the feasible points and the objective of its node, and
//! a dual bound never exceeds the objective at a known feasible point, whatever point and
//! multipliers it is computed from.
//!
//! Programs have small whole numbers for data, and feasible points are found by trying all halves
//! of a box (and a few points far away), with sums in whole numbers: nothing here is rounded unless
//! the crate rounds it.

use crate::common::config;
use carom::prelude::*;
use carom::solver::StopToken;
use carom_solver::internals::presolve::{Compressed, Domain, Propagator, Reduced, probe, reduce};
use carom_solver::internals::program::Program;
use carom_solver::internals::relaxation::{
    ClarabelRelaxation, Effort, Prover, Relaxation, RelaxationClaim, polish,
};
use proptest::prelude::*;
use proptest::sample::{Index, select};

const INF: f64 = f64::INFINITY;
const REGRESSIONS: &str = "tests/propagation.proptest-regressions";

/// What bounds and rows may be missed by: presolve fixes narrow columns at their middle.
const SLACK: f64 = 1e-7;

// -- random programs --------------------------------------------------------------------------

/// A program in whole numbers. Points are in units of a half.
#[derive(Debug, Clone)]
struct Case {
    columns: Vec<Column>,
    rows: Vec<Line>,
    cost: Vec<i64>,
    offset: i64,
    /// The objective has the square of each of these forms.
    squares: Vec<Vec<i64>>,
    maximize: bool,
}

#[derive(Debug, Clone, Copy)]
struct Column {
    lower: Option<i64>,
    upper: Option<i64>,
    integral: bool,
}

#[derive(Debug, Clone)]
struct Line {
    coefficients: Vec<i64>,
    lower: Option<i64>,
    upper: Option<i64>,
}

fn column() -> impl Strategy<Value = Column> {
    (0..8, -3..=2_i64, 0..=4_i64).prop_map(|(kind, low, width)| {
        let (lower, upper) = (Some(low), Some(low + width));
        match kind {
            0 | 1 => Column { lower, upper, integral: false },
            2 => Column { lower, upper: None, integral: false },
            3 => Column { lower: None, upper, integral: false },
            4 => Column { lower: None, upper: None, integral: false },
            5 => Column { lower, upper, integral: true },
            6 => Column { lower, upper: None, integral: true },
            _ => Column { lower: Some(0), upper: Some(1), integral: true },
        }
    })
}

fn case() -> impl Strategy<Value = Case> {
    let coefficient = || select(vec![0, 0, 0, 1, 1, -1, -1, 2, -2, 3, -3, 7]);
    let line = (prop::collection::vec(coefficient(), 4), 0..5, -1..=4_i64, 0..=3_i64);
    let squares = prop_oneof![
        Just(Vec::new()),
        prop::collection::vec(prop::collection::vec(-2..=2_i64, 4), 1..=4)
    ];
    (
        prop::collection::vec(column(), 1..=4),
        prop::collection::vec(line, 0..=4),
        prop::collection::vec(0..=4_i64, 4),
        prop::collection::vec(-3..=3_i64, 4),
        (squares, -5..=5_i64, any::<bool>()),
    )
        .prop_map(|(columns, lines, anchor, mut cost, (mut squares, offset, maximize))| {
            let n = columns.len();
            cost.truncate(n);
            squares.iter_mut().for_each(|s| s.truncate(n));
            // Rows have their limits close to a point of the box, inside or just outside.
            let inside = |(column, step): (&Column, &i64)| match (column.lower, column.upper) {
                (Some(l), Some(u)) => (l + step).min(u),
                (Some(l), None) => l + step,
                (None, Some(u)) => u - step,
                (None, None) => step - 2,
            };
            let anchor: Vec<i64> = columns.iter().zip(&anchor).map(inside).collect();
            let rows = lines
                .into_iter()
                .filter_map(|(mut coefficients, sides, slack, width)| {
                    coefficients.truncate(n);
                    let at = dot(&coefficients, &anchor);
                    let (lower, upper) = match sides {
                        0 => (None, Some(at + slack)),
                        1 => (Some(at - slack), None),
                        2 => (Some(at + slack - width - 1), Some(at + slack)),
                        3 => (Some(at), Some(at)),
                        _ => (Some(at - slack), Some(at + width)),
                    };
                    let crossed = lower.zip(upper).is_some_and(|(l, u)| l > u);
                    let empty = coefficients.iter().all(|&a| a == 0);
                    (!empty && !crossed).then_some(Line { coefficients, lower, upper })
                })
                .collect();
            Case { columns, rows, cost, offset, squares, maximize }
        })
}

fn dot(a: &[i64], x: &[i64]) -> i64 {
    a.iter().zip(x).map(|(a, x)| a * x).sum()
}

fn float(limit: Option<i64>, missing: f64) -> f64 {
    limit.map_or(missing, |v| v as f64)
}

/// A point in units of a half, as floats.
fn floats(point: &[i64]) -> Vec<f64> {
    point.iter().map(|&v| 0.5 * v as f64).collect()
}

impl Case {
    fn program(&self) -> Program {
        let mut model = Model::new("m");
        let mut x = Vec::new();
        for (j, column) in self.columns.iter().enumerate() {
            let (lower, upper) = (float(column.lower, -INF), float(column.upper, INF));
            let name = ("x", j);
            x.push(if column.integral {
                model.integer(name, lower, upper).unwrap()
            } else {
                model.continuous(name, lower, upper).unwrap()
            });
        }
        let form = |a: &[i64]| -> Affine { a.iter().zip(&x).map(|(&a, &x)| a as f64 * x).sum() };
        for (i, row) in self.rows.iter().enumerate() {
            let limits = (float(row.lower, -INF), float(row.upper, INF));
            model.add(("r", i), form(&row.coefficients).within(limits.0, limits.1)).unwrap();
        }
        let mut objective: Quadratic = self.squares.iter().map(|s| form(s).square()).sum();
        objective += form(&self.cost) + self.offset as f64;
        if self.maximize {
            model.maximize(-objective).unwrap();
        } else {
            model.minimize(objective).unwrap();
        }
        Program::assemble(&model).unwrap()
    }

    /// The continuous relaxation as it stands: no row or column is touched.
    fn relaxation(&self) -> Reduced {
        let n = self.columns.len();
        let mut reduced = Reduced {
            columns: (0..n).collect(),
            values: vec![0.0; n],
            linear: self.cost.iter().map(|&q| q as f64).collect(),
            offset: self.offset as f64,
            lower: self.columns.iter().map(|c| float(c.lower, -INF)).collect(),
            upper: self.columns.iter().map(|c| float(c.upper, INF)).collect(),
            row_lower: self.rows.iter().map(|r| float(r.lower, -INF)).collect(),
            row_upper: self.rows.iter().map(|r| float(r.upper, INF)).collect(),
            rows: Compressed { start: vec![0], ..Compressed::default() },
            quadratic: Compressed { start: vec![0], ..Compressed::default() },
            steepness: self.program().steepness().to_vec(),
            ..Reduced::default()
        };
        let push = |to: &mut Compressed, entries: &mut dyn Iterator<Item = (usize, i64)>| {
            for (index, value) in entries.filter(|e| e.1 != 0) {
                to.index.push(index);
                to.value.push(value as f64);
            }
            to.start.push(to.index.len());
        };
        for row in &self.rows {
            push(&mut reduced.rows, &mut row.coefficients.iter().copied().enumerate());
        }
        for j in 0..n {
            let entry = |i: usize| 2 * self.squares.iter().map(|s| s[i] * s[j]).sum::<i64>();
            push(&mut reduced.quadratic, &mut (0..=j).map(|i| (i, entry(i))));
        }
        reduced
    }

    fn is_feasible(&self, point: &[i64]) -> bool {
        self.rows.iter().all(|row| {
            let twice = dot(&row.coefficients, point);
            row.lower.is_none_or(|l| 2 * l <= twice) && row.upper.is_none_or(|u| twice <= 2 * u)
        })
    }

    /// Feasible points near the bounds; with `far`, also some about 5e8 away where bounds are
    /// missing (inside [`carom::tolerance::FREE_RADIUS`]).
    fn feasible_points(&self, far: bool) -> Vec<Vec<i64>> {
        let mut points = vec![Vec::new()];
        for column in &self.columns {
            let (low, high) = match (column.lower, column.upper) {
                (Some(l), Some(u)) => (l, u),
                (Some(l), None) => (l, l + 4),
                (None, Some(u)) => (u - 4, u),
                (None, None) => (-2, 2),
            };
            let step = if column.integral { 2 } else { 1 };
            let mut values: Vec<i64> = (2 * low..=2 * high).step_by(step).collect();
            if far && column.lower.is_none() {
                values.push(-(1 << 30));
            }
            if far && column.upper.is_none() {
                values.push(1 << 30);
            }
            points = values
                .into_iter()
                .flat_map(|v| points.iter().map(move |p| [&p[..], &[v]].concat()))
                .collect();
        }
        points.retain(|p| self.is_feasible(p));
        points
    }

    /// Four times the minimised objective, exactly.
    fn four_costs(&self, point: &[i64]) -> i128 {
        let squares = self.squares.iter().map(|s| i128::from(dot(s, point)).pow(2));
        squares.sum::<i128>() + 2 * i128::from(dot(&self.cost, point)) + 4 * i128::from(self.offset)
    }

    fn cost(&self, point: &[i64]) -> f64 {
        self.four_costs(point) as f64 / 4.0
    }
}

fn contains(domain: &Domain, point: &[i64]) -> bool {
    floats(point)
        .iter()
        .enumerate()
        .all(|(j, &v)| domain.lower(j) - SLACK <= v && v <= domain.upper(j) + SLACK)
}

fn bits(domain: &Domain, columns: usize) -> Vec<(u64, u64)> {
    (0..columns).map(|j| (domain.lower(j).to_bits(), domain.upper(j).to_bits())).collect()
}

/// Propagates and probes all columns, and checks that no point is lost.
fn tightened(
    program: &Program,
    propagator: &mut Propagator,
    points: &[Vec<i64>],
) -> Result<Option<Domain>, TestCaseError> {
    let mut domain = Domain::new(program);
    let result = propagator.propagate_all(program, &mut domain);
    prop_assert!(result.is_ok() || points.is_empty(), "{:?} in spite of {:?}", result, points[0]);
    for point in points {
        prop_assert!(contains(&domain, point), "propagation lost {:?}: {:?}", point, domain);
    }
    if result.is_err() {
        return Ok(None);
    }
    let columns: Vec<usize> = (0..program.column_count()).collect();
    let result = probe(program, &mut domain, propagator, &columns, 1000, &StopToken::default());
    prop_assert!(result.is_ok() || points.is_empty(), "{:?} in spite of {:?}", result, points[0]);
    for point in points {
        prop_assert!(contains(&domain, point), "probing lost {:?}: {:?}", point, domain);
    }
    Ok(result.is_ok().then_some(domain))
}

// -- propagation ------------------------------------------------------------------------------

proptest! {
    #![proptest_config(config(250, REGRESSIONS))]

    #[test]
    fn propagation_and_probing_keep_feasible_points(case in case()) {
        let program = case.program();
        let points = case.feasible_points(true);
        tightened(&program, &mut Propagator::new(&program), &points)?;
    }

    #[test]
    fn a_cutoff_keeps_what_is_as_good(case in case(), which in any::<Index>()) {
        let program = case.program();
        let mut points = case.feasible_points(false);
        prop_assume!(!points.is_empty());
        // Just the cost of one of the points: ties must survive.
        let limit = case.four_costs(&points[which.index(points.len())]);
        points.retain(|p| case.four_costs(p) <= limit);
        let mut propagator = Propagator::new(&program);
        let cutoff = limit as f64 / 4.0;
        let in_force = propagator.set_cutoff(&program, cutoff);
        let curved = program.quadratic.compute_nnz() > 0;
        let constant = case.cost.iter().all(|&q| q == 0);
        prop_assert_eq!(in_force, if curved || constant { INF } else { cutoff });
        tightened(&program, &mut propagator, &points)?;
        // The same after a branch that some of the points are in.
        let mut domain = Domain::new(&program);
        let j = which.index(case.columns.len());
        let value = points[which.index(points.len())][j];
        let mark = domain.mark();
        domain.set_lower(j, domain.lower(j).max(0.5 * value as f64));
        points.retain(|p| p[j] >= value);
        let result = propagator.propagate_since(&program, &mut domain, mark);
        prop_assert!(result.is_ok(), "{:?} in spite of {:?}", result, points[0]);
        for point in points {
            prop_assert!(contains(&domain, &point), "lost {:?}: {:?}", point, domain);
        }
    }

    #[test]
    fn undoing_restores_bounds_exactly(
        case in case(),
        moves in prop::collection::vec((any::<Index>(), any::<bool>(), -4..=4, 0..4), 1..12),
    ) {
        let program = case.program();
        let n = program.column_count();
        let mut propagator = Propagator::new(&program);
        let mut domain = Domain::new(&program);
        let mut stack = vec![(domain.mark(), bits(&domain, n))];
        for (column, is_upper, value, action) in moves {
            let mark = domain.mark();
            match action {
                0 if stack.len() > 1 => {
                    // Out of the innermost node, or out of several at once.
                    let keep = column.index(stack.len());
                    let (mark, before) = stack[keep].clone();
                    stack.truncate(keep.max(1));
                    domain.undo_to(mark);
                    prop_assert_eq!(bits(&domain, n), before);
                }
                1 => {
                    stack.push((mark, bits(&domain, n)));
                    let _ = propagator.propagate_all(&program, &mut domain);
                }
                2 => {
                    stack.push((mark, bits(&domain, n)));
                    let columns: Vec<usize> = (0..n).collect();
                    let _ = probe(&program, &mut domain, &mut propagator, &columns, 50, &StopToken::default());
                }
                _ => {
                    stack.push((mark, bits(&domain, n)));
                    domain.apply(column.index(n), is_upper, 0.5 * f64::from(value));
                    let _ = propagator.propagate_since(&program, &mut domain, mark);
                }
            }
        }
        for (mark, before) in stack.into_iter().rev() {
            domain.undo_to(mark);
            prop_assert_eq!(bits(&domain, n), before);
        }
        prop_assert_eq!(domain.changed_since(0).count(), 0);
        // And the propagator carries nothing over from what was undone.
        let mut again = Domain::new(&program);
        let fresh = Propagator::new(&program).propagate_all(&program, &mut again);
        prop_assert_eq!(propagator.propagate_all(&program, &mut domain), fresh);
        prop_assert_eq!(bits(&domain, n), bits(&again, n));
    }
}

/// Only a column that must be whole has just two values in a box of width 1: here `x = 0` and
/// `x = 1` both contradict the row, and `x = 1/2` does not.
#[test]
fn probing_passes_over_continuous_columns() {
    let mut model = Model::new("m");
    let x = model.continuous("x", 0.0, 1.0).unwrap();
    let y = model.continuous("y", 0.0, 1.0).unwrap();
    model.add("sum", (x + y).equals(0.5)).unwrap();
    model.add("difference", (x - y).equals(0.5)).unwrap();
    let program = Program::assemble(&model).unwrap();
    let mut domain = Domain::new(&program);
    let mut propagator = Propagator::new(&program);
    assert_eq!(
        probe(&program, &mut domain, &mut propagator, &[0, 1], 100, &StopToken::default()),
        Ok(())
    );
    assert!(domain.lower(0) <= 0.5 && domain.upper(0) >= 0.5, "{domain:?}");
}

// -- reduction --------------------------------------------------------------------------------

/// Checks that the points of a domain are points of the reduced program, at the same objective.
fn check_reduction(
    case: &Case,
    program: &Program,
    domain: &Domain,
    points: &[Vec<i64>],
) -> Result<(), TestCaseError> {
    let reduced = match reduce(program, domain) {
        Some(reduced) => reduced,
        None => {
            prop_assert!(points.is_empty(), "refuted in spite of {:?}", points[0]);
            return Ok(());
        }
    };
    for point in points {
        let full = floats(point);
        let x: Vec<f64> = reduced.columns.iter().map(|&j| full[j]).collect();
        for (k, &v) in x.iter().enumerate() {
            let inside = reduced.lower[k] - SLACK <= v && v <= reduced.upper[k] + SLACK;
            prop_assert!(inside, "column {} of {:?}: {:?}", reduced.columns[k], point, reduced);
        }
        for i in 0..reduced.rows.len() {
            let (columns, values) = reduced.rows.vector(i);
            let sum: f64 = columns.iter().zip(values).map(|(&k, a)| a * x[k]).sum();
            let inside = reduced.row_lower[i] - SLACK <= sum && sum <= reduced.row_upper[i] + SLACK;
            prop_assert!(inside, "row {} at {:?}: {:?}", i, point, reduced);
        }
        let lifted = reduced.lift(&x);
        for (j, (a, b)) in lifted.iter().zip(&full).enumerate() {
            prop_assert!((a - b).abs() <= SLACK, "column {} of {:?} became {}", j, point, a);
        }
        let (cost, wanted) = (reduced.objective(&x), case.cost(point));
        let allowed = SLACK * wanted.abs().max(1.0);
        prop_assert!((cost - wanted).abs() <= allowed, "{} instead of {}", cost, wanted);
        prop_assert!((program.objective(&full) - wanted).abs() <= allowed);
    }
    Ok(())
}

proptest! {
    #![proptest_config(config(250, REGRESSIONS))]

    #[test]
    fn reduction_keeps_feasible_points(case in case(), which in any::<Index>()) {
        let program = case.program();
        let mut points = case.feasible_points(false);
        check_reduction(&case, &program, &Domain::new(&program), &points)?;
        let Some(mut domain) = tightened(&program, &mut Propagator::new(&program), &points)? else {
            return Ok(());
        };
        check_reduction(&case, &program, &domain, &points)?;
        // Then column after column is fixed to what one point has.
        if points.is_empty() {
            return Ok(());
        }
        let chosen = points[which.index(points.len())].clone();
        let mut propagator = Propagator::new(&program);
        for (j, &value) in chosen.iter().enumerate() {
            let mark = domain.mark();
            domain.set_lower(j, 0.5 * value as f64);
            domain.set_upper(j, 0.5 * value as f64);
            points.retain(|p| p[j] == value);
            check_reduction(&case, &program, &domain, &points)?;
            prop_assert!(propagator.propagate_since(&program, &mut domain, mark).is_ok());
            check_reduction(&case, &program, &domain, &points)?;
        }
    }
}

/// Bounds that a caller crossed are a contradiction like any other.
#[test]
fn reduction_sees_crossed_bounds() {
    let mut model = Model::new("m");
    model.continuous("x", 0.0, 4.0).unwrap();
    model.integer("k", 0.0, 4.0).unwrap();
    let program = Program::assemble(&model).unwrap();
    for column in 0..2 {
        let mut domain = Domain::new(&program);
        domain.set_lower(column, 3.0);
        domain.set_upper(column, 1.0);
        assert!(reduce(&program, &domain).is_none(), "column {column}");
    }
}

// -- dual bounds ------------------------------------------------------------------------------

/// Numbers of all sizes, zero and small whole ones often.
fn number() -> impl Strategy<Value = f64> {
    prop_oneof![
        3 => Just(0.0),
        3 => (-4..=4).prop_map(f64::from),
        4 => -10.0..10.0,
        3 => (-1.0..1.0, -12..=12).prop_map(|(m, e): (f64, i32)| m * 10.0_f64.powi(e)),
        1 => (-1.0..1.0, -300..=300).prop_map(|(m, e): (f64, i32)| m * 10.0_f64.powi(e)),
        1 => select(vec![f64::MAX, -f64::MAX, f64::MIN_POSITIVE, -0.0, 1e160, -1e160]),
    ]
}

/// Whether a claimed bound is at most the objective at a point, by exact arithmetic.
fn is_bound(case: &Case, bound: f64, point: &[i64]) -> bool {
    let four = 4.0 * bound;
    !four.is_nan() && (four.ceil() as i128) <= case.four_costs(point)
}

fn effort(token: &StopToken) -> Effort<'_> {
    Effort { iterations: 100, tolerance: 1e-8, refinements: 10, cutoff: INF, token, warm: None }
}

/// Four times `d'Pd` of a displacement in units of a half, exactly.
fn four_curvatures(case: &Case, displacement: &[i64]) -> i128 {
    let square = |s: &Vec<i64>| i128::from(dot(s, displacement)).pow(2);
    2 * case.squares.iter().map(square).sum::<i128>()
}

proptest! {
    #![proptest_config(config(400, REGRESSIONS))]

    /// What is left of the curvature without the steepness is convex, and single squares are steep.
    #[test]
    fn steepness_is_no_more_than_the_curvature(
        case in case(),
        displacements in prop::collection::vec(prop::collection::vec(-9..=9_i64, 4), 8),
    ) {
        let program = case.program();
        let steepness = program.steepness();
        for displacement in displacements.iter().map(|d| &d[..case.columns.len()]) {
            let squares = displacement.iter().map(|&d| (d * d) as f64);
            let steep: f64 = squares.zip(steepness).map(|(d, s)| d * s).sum();
            let curvature = four_curvatures(&case, displacement) as f64;
            prop_assert!(steep <= curvature, "{:?}: {} > {}", steepness, steep, curvature);
        }
        let diagonal = |j: usize| 2 * case.squares.iter().map(|s| s[j] * s[j]).sum::<i64>();
        if let [_] = case.columns.as_slice() {
            prop_assert_eq!(steepness[0], diagonal(0) as f64);
        }
    }

    #[test]
    fn no_pair_proves_too_much(
        case in case(),
        pairs in prop::collection::vec(prop::collection::vec(number(), 8), 12),
    ) {
        let program = case.relaxation();
        let points = case.feasible_points(true);
        let (n, m) = (case.columns.len(), case.rows.len());
        for pair in pairs {
            let (x, y) = (&pair[..n], &pair[4..4 + m]);
            let bound = Prover::default().lower_bound(&program, x, y);
            prop_assert!(!bound.is_nan());
            for point in &points {
                prop_assert!(
                    is_bound(&case, bound, point),
                    "x = {:?}, y = {:?}: bound {} at {:?}, cost {}",
                    x, y, bound, point, case.cost(point)
                );
            }
            let refuted = Prover::default().proves_infeasible(&program, y);
            prop_assert!(!refuted || points.is_empty(), "{:?} refutes {:?}", y, points[0]);
        }
    }

    /// Answers of an interior-point solver, as they are and disturbed: nearly right pairs are where
    /// the correction of free columns works. The bound of an answer also has to be good.
    #[test]
    fn nearly_right_pairs_prove_no_more(
        case in case(),
        noise in prop::collection::vec((-1.0..1.0, -14..=0), 8),
    ) {
        let program = case.relaxation();
        let points = case.feasible_points(true);
        let answer = ClarabelRelaxation::new().solve(&program, &effort(&StopToken::default()));
        let noise: Vec<f64> =
            noise.into_iter().map(|(m, e): (f64, i32)| m * 10.0_f64.powi(e)).collect();
        let disturbed = |v: &[f64], from: usize| -> Vec<f64> {
            v.iter().zip(&noise[from..]).map(|(a, b)| a + b).collect()
        };
        let (x, y) = (disturbed(&answer.x, 0), disturbed(&answer.y, 4));
        for (x, y) in [(&answer.x, &answer.y), (&x, &answer.y), (&answer.x, &y), (&x, &y)] {
            let bound = Prover::default().lower_bound(&program, x, y);
            for point in &points {
                prop_assert!(
                    is_bound(&case, bound, point),
                    "x = {:?}, y = {:?}: bound {} at {:?}, cost {}",
                    x, y, bound, point, case.cost(point)
                );
            }
            let refuted = Prover::default().proves_infeasible(&program, y);
            prop_assert!(!refuted || points.is_empty(), "{:?} refutes {:?}", y, points[0]);
        }
        if answer.claim == RelaxationClaim::Solved {
            let (bound, cost) =
                (Prover::default().lower_bound(&program, &answer.x, &answer.y), program.objective(&answer.x));
            prop_assert!(
                bound >= cost - 1e-4 * cost.abs().max(1.0),
                "{} is far below {}: {:?}", bound, cost, answer
            );
        }
    }
}

/// Multipliers of an objective of 0 are noise: what they fall by within the radius hides nothing.
#[test]
fn noise_does_not_weaken_the_bound_of_an_objective_of_zero() {
    let column = |lower, upper| Column { lower: Some(lower), upper, integral: false };
    let case = Case {
        columns: vec![column(0, Some(1)), column(0, None)],
        rows: vec![Line { coefficients: vec![0, 1], lower: Some(1), upper: Some(1) }],
        cost: vec![0, 0],
        offset: -1,
        squares: Vec::new(),
        maximize: false,
    };
    for noise in [1e-10, -1.6e-10, -1e-14] {
        let bound = Prover::default().lower_bound(&case.relaxation(), &[0.5, 1.0], &[noise]);
        assert!((-1.0 - 1e-9..=-1.0).contains(&bound), "{bound} with {noise}");
    }
}

// -- polishing --------------------------------------------------------------------------------

/// The largest violation of rows and bounds.
fn violation(program: &Reduced, x: &[f64]) -> f64 {
    let outside = |v: f64, lower: f64, upper: f64| (lower - v).max(v - upper).max(0.0);
    let mut largest = 0.0_f64;
    for (j, &v) in x.iter().enumerate() {
        largest = largest.max(outside(v, program.lower[j], program.upper[j]));
    }
    for i in 0..program.rows.len() {
        let (columns, values) = program.rows.vector(i);
        let sum: f64 = columns.iter().zip(values).map(|(&j, a)| a * x[j]).sum();
        largest = largest.max(outside(sum, program.row_lower[i], program.row_upper[i]));
    }
    largest
}

proptest! {
    #![proptest_config(config(400, REGRESSIONS))]

    #[test]
    fn polishing_leaves_feasible_points_alone(case in case(), which in any::<Index>()) {
        let program = case.relaxation();
        let points = case.feasible_points(false);
        prop_assume!(!points.is_empty());
        let x = floats(&points[which.index(points.len())]);
        let mut polished = x.clone();
        polish(&program, &mut polished, &StopToken::default());
        prop_assert_eq!(polished, x);
    }

    /// The points that polishing is for: close to a feasible one, as an interior-point solver
    /// leaves them, and inside the box.
    #[test]
    fn polishing_does_no_harm(
        case in case(),
        which in any::<Index>(),
        digits in 3..=10_i32,
        noise in prop::collection::vec(-1.0..1.0_f64, 4),
    ) {
        let program = case.relaxation();
        let points = case.feasible_points(false);
        prop_assume!(!points.is_empty());
        let mut x = floats(&points[which.index(points.len())]);
        for (j, v) in x.iter_mut().enumerate() {
            let moved: f64 = *v + noise[j] * 0.1_f64.powi(digits);
            *v = moved.clamp(program.lower[j], program.upper[j]);
        }
        let mut polished = x.clone();
        polish(&program, &mut polished, &StopToken::default());
        let (before, after) = (violation(&program, &x), violation(&program, &polished));
        prop_assert!(after <= before + 1e-9, "{} became {}: {:?}, {:?}", before, after, x, polished);
    }
}

#[test]
fn narrow_columns_contradict_nothing_that_their_width_allows() {
    // x is nearly fixed; its middle would ask v = 5e-7, which is more than v may be.
    for at in [250.0, 1e3, 1e4] {
        let mut model = Model::new("narrow");
        let x = model.continuous("x", at, at + 2.475e-7).unwrap();
        let v = model.continuous("v", 0.0, 1e-8).unwrap();
        let y = model.continuous("y", -1.0, 1.0).unwrap();
        model.add("tied", (x - 0.25 * v).equals(at)).unwrap();
        model.add("cap", (y + v).le(0.5)).unwrap();
        model.maximize(y).unwrap();
        let solution = BranchAndBound::default().solve(&model).unwrap();
        assert!(solution.is_optimal(), "{} at {at}", solution.termination());
        assert!((solution.value(y).unwrap() - 0.5).abs() < 1e-6);
    }
}

/// A bound is found where there was none, on one side and on both.
#[test]
fn missing_bounds_are_found() {
    let mut model = Model::new("open");
    let inf = f64::INFINITY;
    let x = model.continuous_family("x", 3, -inf, inf).unwrap();
    model.add("start", (2.0 * x[0]).within(-1.0, 3.0)).unwrap();
    model.add("up", (x[1] - x[0]).le(0.5)).unwrap();
    model.add("down", (x[2] + x[1]).ge(1.0)).unwrap();
    let program = Program::assemble(&model).unwrap();
    let mut domain = Domain::new(&program);
    Propagator::new(&program).propagate_all(&program, &mut domain).unwrap();
    let near = |found: f64, wanted: f64| found == wanted || (found - wanted).abs() < 1e-6;
    for (column, lower, upper) in [(0, -0.5, 1.5), (1, -inf, 2.0), (2, -1.0, inf)] {
        let bounds = domain.bounds(column);
        assert!(near(bounds[0], lower) && near(bounds[1], upper), "{column}: {bounds:?}");
    }
}
