//! Linear programs that are hard for a simplex method: degenerate, with dependent rows, columns
//! without bounds, and entries of many magnitudes; compared with the enumeration of vertices, and
//! with Clarabel.

use crate::common::config;
use carom::solver::StopToken;
use carom_solver::internals::presolve::{Compressed, Reduced};
use carom_solver::internals::relaxation::{
    ClarabelRelaxation, DualSimplex, Effort, Prover, Relaxation, RelaxationClaim, RelaxationResult,
    WarmState,
};
use proptest::prelude::*;

const INF: f64 = f64::INFINITY;

/// A row: coefficients, the kind of its sides, and its distance from the point inside.
#[derive(Debug, Clone)]
struct RandomRow {
    entries: Vec<(usize, i32)>,
    /// 0: an equality, 1: an upper limit, 2: a lower limit, 3: both.
    kind: u8,
    room: i32,
    /// The sum of this row and another one, if any, takes its place.
    plus: Option<usize>,
}

#[derive(Debug, Clone)]
struct RandomProgram {
    /// A value, the room below and above it; 9 stands for no bound.
    columns: Vec<(i32, i32, i32)>,
    rows: Vec<RandomRow>,
    cost: Vec<i32>,
    /// Exponents of ten of the units of columns and rows.
    column_units: Vec<i32>,
    row_units: Vec<i32>,
    /// How far the rows are moved away from the point inside.
    shift: i32,
}

fn random_row(columns: usize) -> impl Strategy<Value = RandomRow> {
    let entries = prop::collection::vec((0..columns, -4..=4), 1..5);
    let plus = prop_oneof![2 => Just(None), 1 => (0..8usize).prop_map(Some)];
    (entries, 0..4u8, 0..=2, plus).prop_map(|(entries, kind, room, plus)| RandomRow {
        entries,
        kind,
        room,
        plus,
    })
}

fn random_program(
    columns: std::ops::Range<usize>,
    rows: std::ops::Range<usize>,
    rooms: i32,
) -> impl Strategy<Value = RandomProgram> {
    (columns, 0..=3, prop_oneof![3 => Just(0), 1 => -3..=3]).prop_flat_map(
        move |(n, decades, shift): (usize, i32, i32)| {
            (
                prop::collection::vec((-3..=3, 0..=rooms, 0..=rooms), n),
                prop::collection::vec(random_row(n), rows.clone()),
                prop::collection::vec(-3..=3, n),
                prop::collection::vec(-decades..=decades, n),
                prop::collection::vec(-decades..=decades, rows.end),
            )
                .prop_map(move |(columns, rows, cost, column_units, row_units)| {
                    RandomProgram { columns, rows, cost, column_units, row_units, shift }
                })
        },
    )
}

impl RandomProgram {
    /// The program; units are left out if it is to be enumerated.
    fn program(&self, has_units: bool) -> Reduced {
        let n = self.columns.len();
        let unit = |k: i32| if has_units { 10f64.powi(k) } else { 1.0 };
        let side = |value: i32, room: i32, sign: i32| match room {
            9 => f64::from(sign) * INF,
            _ => f64::from(value + sign * room),
        };
        let bound = |j: usize, sign: i32| {
            let (value, below, above) = self.columns[j];
            let room = if sign < 0 { below } else { above };
            side(value, room, sign) / unit(self.column_units[j])
        };
        let mut reduced = Reduced {
            columns: (0..n).collect(),
            values: vec![0.0; n],
            linear: (0..n).map(|j| f64::from(self.cost[j]) * unit(self.column_units[j])).collect(),
            lower: (0..n).map(|j| bound(j, -1)).collect(),
            upper: (0..n).map(|j| bound(j, 1)).collect(),
            rows: Compressed { start: vec![0], ..Compressed::default() },
            quadratic: Compressed { start: vec![0; n + 1], ..Compressed::default() },
            origin: (0..self.rows.len()).collect(),
            ..Reduced::default()
        };
        let mut dense: Vec<Vec<i32>> = Vec::new();
        for (i, row) in self.rows.iter().enumerate() {
            let mut entries = vec![0; n];
            row.entries.iter().for_each(|&(j, a)| entries[j] += a);
            if let Some(other) = row.plus.and_then(|k| dense.get(k)) {
                entries.iter_mut().zip(other).for_each(|(a, b)| *a += b);
            }
            let value: i32 = entries.iter().zip(&self.columns).map(|(a, c)| a * c.0).sum();
            let (value, scale) = (f64::from(value + self.shift), unit(self.row_units[i]));
            for (j, &a) in entries.iter().enumerate().filter(|e| *e.1 != 0) {
                reduced.rows.index.push(j);
                reduced.rows.value.push(f64::from(a) * scale * unit(self.column_units[j]));
            }
            reduced.rows.start.push(reduced.rows.index.len());
            let room = f64::from(row.room);
            let [lower, upper] = match row.kind {
                0 => [value, value],
                1 => [-INF, value + room],
                2 => [value - room, INF],
                _ => [value - room, value + room],
            };
            reduced.row_lower.push(lower * scale);
            reduced.row_upper.push(upper * scale);
            dense.push(entries);
        }
        reduced
    }
}

fn solve(
    method: &mut dyn Relaxation,
    program: &Reduced,
    warm: Option<&WarmState>,
) -> RelaxationResult {
    let token = StopToken::default();
    let effort = Effort {
        iterations: 100_000,
        tolerance: 1e-9,
        refinements: 10,
        cutoff: INF,
        token: &token,
        warm,
    };
    method.solve(program, &effort)
}

/// The least objective of a vertex of a program whose columns all have bounds: as many bounds and
/// limits as columns hold there with equality.
fn best_vertex(program: &Reduced) -> Option<f64> {
    let n = program.columns.len();
    let mut planes: Vec<Plane> = Vec::new();
    for j in 0..n {
        let unit: Vec<f64> = (0..n).map(|k| f64::from(u8::from(k == j))).collect();
        planes.push((unit.clone(), program.lower[j]));
        planes.push((unit, program.upper[j]));
    }
    let rows: Vec<Vec<f64>> = (0..program.rows.len())
        .map(|i| {
            let mut dense = vec![0.0; n];
            let (index, value) = program.rows.vector(i);
            index.iter().zip(value).for_each(|(&j, a)| dense[j] += a);
            dense
        })
        .collect();
    for (i, row) in rows.iter().enumerate() {
        let sides = [program.row_lower[i], program.row_upper[i]];
        planes.extend(sides.into_iter().filter(|v| v.is_finite()).map(|v| (row.clone(), v)));
    }
    let holds = |x: &[f64]| {
        let inside = |v: f64, lower: f64, upper: f64| v >= lower - 1e-9 && v <= upper + 1e-9;
        (0..n).all(|j| inside(x[j], program.lower[j], program.upper[j]))
            && rows.iter().enumerate().all(|(i, row)| {
                let value: f64 = row.iter().zip(x).map(|(a, x)| a * x).sum();
                inside(value, program.row_lower[i], program.row_upper[i])
            })
    };
    let mut best: Option<f64> = None;
    let mut chosen = Vec::new();
    choose(&planes, n, 0, &mut chosen, &mut |active| {
        if let Some(x) = intersection(active).filter(|x| holds(x)) {
            let value = program.objective(&x);
            best = Some(best.map_or(value, |b| b.min(value)));
        }
    });
    best
}

/// A normal, and the value of its product with the points of the plane.
type Plane = (Vec<f64>, f64);

/// Calls `f` with all choices of so many planes.
fn choose(
    planes: &[Plane],
    count: usize,
    from: usize,
    chosen: &mut Vec<Plane>,
    f: &mut dyn FnMut(&[Plane]),
) {
    if chosen.len() == count {
        return f(chosen);
    }
    for k in from..planes.len() {
        chosen.push(planes[k].clone());
        choose(planes, count, k + 1, chosen, f);
        chosen.pop();
    }
}

/// The common point of planes, if there is just one.
fn intersection(planes: &[Plane]) -> Option<Vec<f64>> {
    let n = planes.len();
    let mut a: Vec<Vec<f64>> =
        planes.iter().map(|(row, v)| row.iter().copied().chain([*v]).collect()).collect();
    for c in 0..n {
        let best = (c..n).max_by(|&i, &k| a[i][c].abs().total_cmp(&a[k][c].abs()))?;
        if a[best][c].abs() < 1e-9 {
            return None;
        }
        a.swap(c, best);
        for i in (0..n).filter(|&i| i != c) {
            let factor = a[i][c] / a[c][c];
            let pivot = a[c].clone();
            a[i].iter_mut().zip(&pivot).for_each(|(v, p)| *v -= factor * p);
        }
    }
    Some((0..n).map(|i| a[i][n] / a[i][i]).collect())
}

proptest! {
    #![proptest_config(config(96, "tests/regressions/linear_programs.txt"))]

    /// All columns have bounds, so that there is a best vertex, or no point.
    #[test]
    fn small_programs_end_at_the_best_vertex(case in random_program(1..5, 1..6, 3)) {
        let program = case.program(false);
        let answer = solve(&mut DualSimplex::new(), &program, None);
        if !DualSimplex::suits(&program) {
            return Ok(());
        }
        match best_vertex(&program) {
            Some(best) => {
                prop_assert_eq!(answer.claim, RelaxationClaim::Solved);
                let value = program.objective(&answer.x);
                prop_assert!((value - best).abs() <= 1e-7 * best.abs().max(1.0), "{value}, {best}");
                let bound = Prover::default().lower_bound(&program, &answer.x, &answer.y);
                prop_assert!(best - bound <= 1e-7 * best.abs().max(1.0), "{bound}, {best}");
            }
            None => {
                prop_assert_eq!(answer.claim, RelaxationClaim::Infeasible);
                prop_assert!(Prover::default().proves_infeasible(&program, &answer.y));
            }
        }
    }

    /// Columns may lack bounds, and units differ: where both methods make a claim, it is the same.
    #[test]
    fn large_programs_agree_with_clarabel(case in random_program(5..40, 5..30, 9)) {
        let program = case.program(true);
        if !DualSimplex::suits(&program) {
            return Ok(());
        }
        let answer = solve(&mut DualSimplex::new(), &program, None);
        let other = solve(&mut ClarabelRelaxation::new(), &case.program(false), None);
        let firm =
            [RelaxationClaim::Solved, RelaxationClaim::Infeasible, RelaxationClaim::Unbounded];
        prop_assert!(firm.contains(&answer.claim), "{:?}", answer.claim);
        if !firm.contains(&other.claim) {
            return Ok(());
        }
        // A program without points may have rays.
        if answer.claim != RelaxationClaim::Solved && other.claim != RelaxationClaim::Solved {
            return Ok(());
        }
        prop_assert_eq!(answer.claim, other.claim);
        let value = program.objective(&answer.x);
        let theirs = case.program(false).objective(&other.x);
        prop_assert!((value - theirs).abs() <= 1e-5 * theirs.abs().max(1.0), "{value}, {theirs}");
    }

    /// A basis of other bounds leads to the same answer.
    #[test]
    fn warm_starts_agree_with_cold_ones(
        case in random_program(5..40, 5..30, 9),
        moves in prop::collection::vec((0..40usize, 0..2usize, 0.0..1.0_f64), 1..8),
    ) {
        let mut program = case.program(true);
        if !DualSimplex::suits(&program) {
            return Ok(());
        }
        let mut warm = solve(&mut DualSimplex::new(), &program, None).warm;
        for (column, side, part) in moves {
            let j = column % program.columns.len();
            let width = program.upper[j] - program.lower[j];
            if width.is_finite() && side == 0 {
                program.lower[j] += part * width;
            } else if width.is_finite() {
                program.upper[j] -= part * width;
            }
            let cold = solve(&mut DualSimplex::new(), &program, None);
            let next = solve(&mut DualSimplex::new(), &program, warm.as_ref());
            let ends = [cold.claim, next.claim];
            if ends.contains(&RelaxationClaim::Solved) {
                prop_assert_eq!(cold.claim, next.claim);
                let (a, b) = (program.objective(&cold.x), program.objective(&next.x));
                prop_assert!((a - b).abs() <= 1e-6 * a.abs().max(1.0), "{a}, {b}");
            }
            warm = next.warm;
        }
    }
}
