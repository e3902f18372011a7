//! What tightens a program keeps the best value of every assignment of the integers, also where
//! continuous columns have no bounds, one, or huge ones.
//!
//! Random programs with squares of their own on such columns, in rows with binaries, are tightened
//! in each way that the search uses. Then all assignments of the integers are solved exactly,
//! before and after.

use carom::prelude::*;
use carom::solver::StopToken;
use carom_solver::internals::presolve::{tighten_big_ms, tighten_by_disjunctions};
use carom_solver::internals::program::Program;
use carom_solver::internals::search::perspective::{switched_squares, with_slopes};
use proptest::prelude::*;

use crate::common::case::{Case, Column, Line, Square};
use crate::common::config;
use crate::common::judge::is_right;
use crate::common::quadratic_program::{Minimum, QuadraticProgram};

const REGRESSIONS: &str = "tests/regressions/open_columns.txt";

/// Continuous columns come first, then binaries.
const CONTINUOUS: usize = 3;
const BINARIES: usize = 3;
const COLUMNS: usize = CONTINUOUS + BINARIES;

fn bounds() -> impl Strategy<Value = (f64, f64)> {
    let near = || (-6i8..=6).prop_map(f64::from);
    let far = || prop_oneof![Just(1e3), Just(1e5), Just(f64::INFINITY)];
    prop_oneof![
        2 => Just((f64::NEG_INFINITY, f64::INFINITY)),
        1 => (near(), far()).prop_map(|(a, b)| (a, a + b)),
        1 => (near(), far()).prop_map(|(a, b)| (a - b, a)),
        1 => (near(), 0i8..=8).prop_map(|(a, b)| (a, a + f64::from(b))),
    ]
}

/// Rows over one or two continuous columns and up to two binaries: many are big-Ms.
fn row() -> impl Strategy<Value = (Vec<i8>, i8, u8)> {
    let continuous = (0..CONTINUOUS, 0..CONTINUOUS, -2i8..=2, -2i8..=2);
    let binaries = (CONTINUOUS..COLUMNS, CONTINUOUS..COLUMNS, -9i8..=9, -9i8..=9);
    (continuous, binaries, -6i8..=12, 0u8..=3).prop_map(
        |((a, b, p, q), (c, d, r, s), limit, kind)| {
            let mut row = vec![0; COLUMNS];
            (row[a], row[b]) = (p, q);
            (row[c], row[d]) = (r, s);
            if row[..CONTINUOUS].iter().all(|&a| a == 0) {
                row[a] = 1;
            }
            (row, limit, kind)
        },
    )
}

fn case() -> impl Strategy<Value = Case> {
    let columns = prop::collection::vec(bounds(), CONTINUOUS);
    let rows = prop::collection::vec(row(), 1..5);
    let weights = prop::collection::vec(prop_oneof![1 => Just(0u8), 4 => 1u8..=8], CONTINUOUS);
    let linear = prop::collection::vec(-20i8..=20, COLUMNS);
    (columns, rows, weights, linear).prop_map(|(bounds, rows, weights, linear)| {
        let mut columns: Vec<Column> = Vec::new();
        for (lower, upper) in bounds {
            columns.push(Column { kind: VariableKind::Continuous, lower, upper });
        }
        let binary = Column { kind: VariableKind::Binary, lower: 0.0, upper: 1.0 };
        columns.extend((0..BINARIES).map(|_| binary));
        let lines = rows.into_iter().map(|(row, limit, kind)| {
            let limit = f64::from(limit);
            let (lower, upper) = match kind {
                0 => (limit, limit),
                1 => (-limit, f64::INFINITY),
                _ => (f64::NEG_INFINITY, limit),
            };
            let coefficients = row.into_iter().map(f64::from).collect();
            Line { coefficients, lower, upper, scale: 1.0 }
        });
        let squares = weights.iter().enumerate().filter(|(_, w)| **w > 0).map(|(j, &w)| {
            let mut coefficients = vec![0.0; COLUMNS];
            coefficients[j] = 1.0;
            Square { weight: f64::from(w), coefficients, constant: 0.0 }
        });
        Case {
            columns,
            lines: lines.collect(),
            switches: Vec::new(),
            squares: squares.collect(),
            linear: linear.into_iter().map(f64::from).collect(),
            constant: 0.0,
            maximize: false,
        }
    })
}

/// The best value of a program for given binaries, solved exactly.
fn best_value(program: &Program, binaries: &[f64]) -> Minimum {
    let n = CONTINUOUS;
    let mut rest = QuadraticProgram::new(n);
    let at = |j: usize| if j < n { 0.0 } else { binaries[j - n] };
    for row in 0..program.row_count() {
        let (columns, values) = program.row(row);
        let (mut a, mut constant) = (vec![0.0; n], 0.0);
        for (&j, &v) in columns.iter().zip(values) {
            if j < n { a[j] = v } else { constant += v * at(j) }
        }
        let (lower, upper) = (program.row_lower[row] - constant, program.row_upper[row] - constant);
        if a.iter().all(|&a| a == 0.0) {
            if lower > 1e-9 || upper < -1e-9 {
                return Minimum::Infeasible;
            }
            continue;
        }
        rest.add_range(&a, lower, upper);
    }
    for j in 0..n {
        let mut unit = vec![0.0; n];
        unit[j] = 1.0;
        rest.add_range(&unit, program.lower[j], program.upper[j]);
    }
    rest.linear = program.linear[..n].to_vec();
    for j in 0..COLUMNS {
        let (rows, values) = program.quadratic_column(j);
        for (&i, &p) in rows.iter().zip(values) {
            match (i < n, j < n) {
                (true, true) => rest.curvature[i][j] += p,
                (true, false) => rest.linear[i] += p * at(j),
                _ => {}
            }
        }
    }
    match rest.solve() {
        Minimum::Attained { point, .. } => {
            let x: Vec<f64> = point.iter().chain(binaries).copied().collect();
            Minimum::Attained { value: program.objective(&x), point: x }
        }
        other => other,
    }
}

/// Whether a program has the best values of another one, for all values of the binaries.
fn compare(program: &Program, tight: &Program) -> Result<(), TestCaseError> {
    for bits in 0..1 << BINARIES {
        let binaries: Vec<f64> = (0..BINARIES).map(|k| f64::from(bits >> k & 1)).collect();
        match (best_value(program, &binaries), best_value(tight, &binaries)) {
            (Minimum::Attained { value, .. }, Minimum::Attained { value: tight, .. }) => {
                let margin = 1e-6 * value.abs().max(1.0);
                prop_assert!((value - tight).abs() <= margin, "{tight} instead of {value}");
            }
            (before, after) => prop_assert_eq!(before, after),
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(config(400, REGRESSIONS))]

    #[test]
    fn tightened_programs_keep_every_value(
        case in case(),
        slopes in prop::collection::vec(-3.0..10.0f64, COLUMNS),
    ) {
        let program = Program::assemble(&case.build().0).unwrap();
        let token = StopToken::default();
        if let Some(tight) = tighten_big_ms(&program, &token) {
            compare(&program, &tight)?;
        }
        if let Some(tight) = tighten_by_disjunctions(&program, &token) {
            compare(&program, &tight)?;
        }
        // Any of the binaries that switch a square off.
        let squares = switched_squares(&program, &token);
        for (k, square) in squares.iter().enumerate() {
            let slope = slopes[k % COLUMNS];
            let bent = with_slopes(&program, &[*square], &[slope]).unwrap();
            compare(&program, &bent)?;
        }
    }

    #[test]
    fn answers_are_right(case in case()) {
        let solution = BranchAndBound::default().solve(&case.build().0).unwrap();
        prop_assert_eq!(solution.statistics().contradictions, 0);
        is_right(&case, &solution)?;
    }
}

/// Each binary seemed to fix the squared columns, because their bounds were missing.
#[test]
fn a_row_that_leaves_a_column_open_fixes_nothing() {
    let mut model = Model::new("layout");
    let [w, x, y] = ["w", "x", "y"].map(|name| model.continuous(name, 0.0, f64::INFINITY).unwrap());
    model.set_bounds(y, 0.0, 53.0).unwrap();
    let z: Vec<Variable> = (0..4).map(|k| model.binary(format!("z{k}")).unwrap()).collect();
    model.add("d2", (x - w + 53.0 * z[1]).le(53.0)).unwrap();
    model.add("d3", (y + 53.0 * z[2]).le(53.0)).unwrap();
    model.add("b", (z[0] + z[1] + z[2] + z[3]).equals(1.0)).unwrap();
    let squares = 150.0 * w.square() + 140.0 * x.square() + 140.0 * y.square();
    model.minimize(squares - 1960.0 * x).unwrap();
    let program = Program::assemble(&model).unwrap();
    let switched = switched_squares(&program, &StopToken::default());
    // Only `y` has both bounds, and `d3` fixes it at 0.
    assert!(switched.iter().all(|square| square.column == y.index()), "{switched:?}");
    let solution = BranchAndBound::default().solve(&model).unwrap();
    assert!(solution.is_optimal());
    assert!((solution.objective().unwrap() + 6860.0).abs() < 1e-2);
}
