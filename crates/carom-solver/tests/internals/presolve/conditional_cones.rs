//! Cones with room while a binary has one of its values: the same whole points, and a tighter
//! relaxation.

use carom::model::norm;
use carom::prelude::*;
use carom::solver::StopToken;
use carom_solver::internals::presolve::tighten_conditional_cones;
use carom_solver::internals::program::{Cone, ConeRole, ConeShape, Program};
use proptest::prelude::*;

use crate::common::config;

const REGRESSIONS: &str = "tests/regressions/conditional_cones.txt";

/// Values of the columns between their bounds.
const GRID: [f64; 6] = [0.0, 0.2, 0.5, 0.9, 1.0, 1.7];

#[derive(Debug, Clone)]
enum Case {
    /// `|(a x + b y + c, x)| <= r + m (1 - on) + d x`, with `|x| <= u` and perhaps `|y| <= u on`.
    Norm {
        coefficients: [f64; 4],
        radius: f64,
        room: f64,
        reach: f64,
        switched: bool,
        off_at_one: bool,
    },
    /// `(t y)^2 <= (a + p y) (q y - r w)`, with `w <= on`, and perhaps another binary that excludes
    /// it.
    Rotated { constant: f64, factors: [f64; 4], excluded: bool, shifted: bool },
}

fn case() -> impl Strategy<Value = Case> {
    let value = || prop_oneof![1 => Just(0.0), 3 => -1.5..1.5, 2 => Just(1.0)];
    let norms =
        (
            prop::array::uniform4(value()),
            0.5..3.0,
            prop_oneof![Just(0.0), Just(3.0), Just(9.0)],
            prop_oneof![Just(0.5), Just(1.0), Just(2.0)],
            any::<bool>(),
            any::<bool>(),
        )
            .prop_map(|(coefficients, radius, room, reach, switched, off_at_one)| {
                Case::Norm { coefficients, radius, room, reach, switched, off_at_one }
            });
    let factor = || prop_oneof![3 => Just(1.0), 1 => Just(2.0), 1 => Just(0.5), 1 => 0.3..3.0];
    let rotated = (
        prop_oneof![Just(0.0), Just(1.0), 0.3..2.0],
        prop::array::uniform4(factor()),
        any::<bool>(),
        any::<bool>(),
    )
        .prop_map(|(constant, factors, excluded, shifted)| Case::Rotated {
            constant,
            factors,
            excluded,
            shifted,
        });
    prop_oneof![norms, rotated]
}

/// The program of a case: its first columns are two binaries and two others, which decide all.
fn build(case: &Case) -> Program {
    let mut model = Model::new("conditional");
    let on = model.binary_family("on", 2).unwrap();
    match *case {
        Case::Norm { coefficients: [a, b, c, d], radius, room, reach, switched, off_at_one } => {
            let x = model.continuous("x", -reach, reach).unwrap();
            let y = model.continuous("y", -reach, reach).unwrap();
            if switched {
                model.add("least", y.ge(-reach * on[0])).unwrap();
                model.add("most", y.le(reach * on[0])).unwrap();
            }
            let off = if off_at_one { Affine::from(on[0]) } else { 1.0 - on[0] };
            let entries = [a * x + b * y + c, Affine::from(x)];
            model.add("length", norm(entries).le(radius + room * off + d * x)).unwrap();
            Program::assemble(&model).unwrap()
        }
        Case::Rotated { constant, factors: [t, p, q, r], excluded, shifted } => {
            let y = model.continuous("y", 0.0, f64::INFINITY).unwrap();
            let w = model.continuous("w", 0.0, 1.0).unwrap();
            model.add("only_on", w.le(on[0])).unwrap();
            if excluded {
                model.add("one_of", (on[0] + on[1]).le(1.0)).unwrap();
            }
            // `y` itself may be nowhere but in a sum.
            let base = if shifted {
                let sum = model.continuous("sum", 1.0, f64::INFINITY).unwrap();
                model.add("shift", sum.equals(y + 1.0)).unwrap();
                sum - 1.0
            } else {
                Affine::from(y)
            };
            let mut column = |name: &str, value: Affine, least: f64| {
                let column = model.continuous(name, least, f64::INFINITY).unwrap();
                model.add(format!("{name}_is"), column.equals(value)).unwrap();
                column.index()
            };
            let columns = vec![
                column("first", constant + p * base.clone(), 0.0),
                column("second", q * base.clone() - r * w, 0.0),
                column("tail", t * base, f64::NEG_INFINITY),
            ];
            let mut program = Program::assemble(&model).unwrap();
            program.cones.push(Cone { shape: ConeShape::Rotated, columns, role: ConeRole::Single });
            program
        }
    }
}

/// Computes the columns from the fourth on from the equalities that define them, in turn.
fn complete(program: &Program, x: &mut Vec<f64>) {
    let mut known: Vec<bool> = (0..program.column_count()).map(|j| j < x.len()).collect();
    x.resize(program.column_count(), 0.0);
    for _ in 0..x.len() {
        for row in 0..program.row_count() {
            let (columns, values) = program.row(row);
            let mut open = columns.iter().zip(values).filter(|(j, _)| !known[**j]);
            let (Some((&j, &a)), None) = (open.next(), open.next()) else { continue };
            if program.row_lower[row] == program.row_upper[row] {
                let others: f64 = columns
                    .iter()
                    .zip(values)
                    .filter(|(i, _)| **i != j)
                    .map(|(&i, a)| a * x[i])
                    .sum();
                (x[j], known[j]) = ((program.row_upper[row] - others) / a, true);
            }
        }
    }
}

/// By how much a point misses bounds, rows and cones.
fn miss(program: &Program, x: &[f64]) -> f64 {
    let bounds = (0..x.len()).map(|j| (program.lower[j] - x[j]).max(x[j] - program.upper[j]));
    let rows = (0..program.row_count()).map(|row| {
        let (columns, values) = program.row(row);
        let sum: f64 = columns.iter().zip(values).map(|(&j, a)| a * x[j]).sum();
        (program.row_lower[row] - sum).max(sum - program.row_upper[row])
    });
    let cones = program.cones.iter().map(|cone| cone.miss(x));
    bounds.chain(rows).chain(cones).fold(0.0, f64::max)
}

proptest! {
    #![proptest_config(config(1000, REGRESSIONS))]

    #[test]
    fn whole_points_stay(case in case()) {
        let program = build(&case);
        let Some(tight) = tighten_conditional_cones(&program, &StopToken::default()) else { return Ok(()) };
        prop_assert!(tight.column_count() > program.column_count());
        let values = || GRID.iter().flat_map(|v| [*v, -*v]);
        for code in 0..4 {
            for (y, w) in values().flat_map(|y| values().map(move |w| (y, w))) {
                let mut x = vec![f64::from(code % 2), f64::from(code / 2), y, w];
                let mut point = x.clone();
                complete(&program, &mut point);
                complete(&tight, &mut x);
                let misses = [miss(&program, &point), miss(&tight, &x)];
                let is_clear = misses.iter().all(|miss| *miss < 1e-7 || *miss > 1e-5);
                let same = (misses[0] < 1e-7) == (misses[1] < 1e-7);
                prop_assert!(same || !is_clear, "{:?} at {:?} in {:?}", misses, x, tight.cones);
            }
        }
    }
}

/// `w <= y / (1 + y)` with `w <= on` gets `on` in the place of 1.
#[test]
fn a_hyperbola_becomes_its_perspective() {
    for shifted in [false, true] {
        let factors = [1.0; 4];
        let program = build(&Case::Rotated { constant: 1.0, factors, excluded: true, shifted });
        let tight = tighten_conditional_cones(&program, &StopToken::default()).unwrap();
        let head = tight.cones[0].columns[0];
        assert_eq!(head, program.column_count());
        // `head = first - (1 - on)`: the binary itself, not the one that excludes it.
        let row = tight.row_count() - 1;
        assert_eq!(tight.row(row).0[0], 0);
        let room = tight.row_upper[row];
        assert!((room + 1.0).abs() < 1e-6, "{room}");
    }
}

/// The M of a norm is as large as it has to be, and no larger.
#[test]
fn big_ms_of_norms_become_smaller() {
    let mut model = Model::new("big M");
    let on = model.binary("on").unwrap();
    let x = model.continuous_family("x", 2, -3.0, 3.0).unwrap();
    model.add("near", norm(x.iter()).le(1.0 + 100.0 * (1.0 - on))).unwrap();
    let program = Program::assemble(&model).unwrap();
    let tight = tighten_conditional_cones(&program, &StopToken::default()).unwrap();
    let room = -tight.row_upper[tight.row_count() - 1];
    assert!((room - (101.0 - 18.0_f64.sqrt())).abs() < 1e-6, "{room}");
}

/// A tight M stays, and so do cones that no binary has to do with.
#[test]
fn other_cones_stay() {
    let mut model = Model::new("stays");
    let on = model.binary("on").unwrap();
    let x = model.continuous_family("x", 2, -3.0, 3.0).unwrap();
    model.add("near", norm(x.iter()).le(1.0 + (18.0_f64.sqrt() - 1.0) * (1.0 - on))).unwrap();
    model.add("always", norm([x[0], x[1]]).le(4.0)).unwrap();
    let program = Program::assemble(&model).unwrap();
    assert!(tighten_conditional_cones(&program, &StopToken::default()).is_none());
}
