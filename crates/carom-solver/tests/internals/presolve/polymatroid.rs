//! Polymatroid cuts of norms of binaries hold at every whole point, and say more than the cone.

use carom::model::norm;
use carom::prelude::*;
use carom::solver::StopToken;
use carom_solver::internals::presolve::Domain;
use carom_solver::internals::program::{Cone, ConeRole, ConeShape, Program};
use carom_solver::internals::search::cuts::polymatroid_cuts;
use proptest::prelude::*;

use crate::common::config;

const REGRESSIONS: &str = "tests/regressions/polymatroid.txt";

/// The entries of a tail by binary and factor, a constant entry, and whether the cone is rotated,
/// and by what its heads differ.
#[derive(Debug, Clone)]
struct Case {
    entries: Vec<(usize, f64)>,
    constant: f64,
    rotated: Option<f64>,
    point: Vec<f64>,
}

fn case() -> impl Strategy<Value = Case> {
    let factor = prop_oneof![1 => Just(1.0), 2 => -3.0..3.0, 1 => Just(1e3), 1 => Just(1e-3)];
    (
        prop::collection::vec((0..5_usize, factor), 2..=6),
        prop_oneof![Just(0.0), 0.1..5.0],
        prop::option::of(0.1..10.0),
        prop::collection::vec(0.0..=1.0, 5),
    )
        .prop_map(|(entries, constant, rotated, point)| Case {
            entries,
            constant,
            rotated,
            point,
        })
}

/// The program: five binaries, then the heads.
fn build(case: &Case) -> Program {
    let mut model = Model::new("polymatroid");
    let on = model.binary_family("on", 5).unwrap();
    let heads = [0, 1].map(|k| model.continuous(("head", k), 0.0, f64::INFINITY).unwrap());
    let tail = case.entries.iter().map(|&(b, factor)| factor * on[b]);
    let tail: Vec<Affine> = tail.chain([Affine::constant(case.constant)]).collect();
    match case.rotated {
        None => {
            model.add("length", norm(tail).le(heads[0])).unwrap();
            Program::assemble(&model).unwrap()
        }
        Some(_) => {
            let mut columns: Vec<usize> = heads.iter().map(|head| head.index()).collect();
            for (k, entry) in tail.into_iter().enumerate() {
                let column =
                    model.continuous(("tail", k), f64::NEG_INFINITY, f64::INFINITY).unwrap();
                model.add(("is", k), column.equals(entry)).unwrap();
                columns.push(column.index());
            }
            // Presolve would make the row of the constant a bound.
            let last = *columns.last().unwrap();
            let mut program = Program::assemble(&model).unwrap();
            (program.lower[last], program.upper[last]) = (case.constant, case.constant);
            program.cones.push(Cone { shape: ConeShape::Rotated, columns, role: ConeRole::Single });
            program
        }
    }
}

/// The length of the tail at values of the binaries.
fn length(case: &Case, on: &[f64]) -> f64 {
    let squares = case.entries.iter().map(|&(b, factor)| (factor * on[b]).powi(2));
    (squares.sum::<f64>() + case.constant * case.constant).sqrt()
}

/// A point of the cone with these binaries, on its boundary.
fn point(case: &Case, program: &Program, on: &[f64]) -> Vec<f64> {
    let mut x = vec![0.0; program.column_count()];
    x[..5].copy_from_slice(on);
    let ratio = case.rotated.unwrap_or(1.0);
    (x[5], x[6]) = (length(case, on) * ratio, length(case, on) / ratio);
    x
}

proptest! {
    #![proptest_config(config(500, REGRESSIONS))]

    #[test]
    fn every_whole_point_satisfies_the_cuts(case in case()) {
        let program = build(&case);
        let x = point(&case, &program, &case.point);
        let cuts = polymatroid_cuts(&program, &Domain::new(&program), &x, &StopToken::default());
        for cut in &cuts {
            prop_assert!(cut.room(&x) < 0.0);
            for code in 0..32 {
                let on: Vec<f64> = (0..5).map(|k| f64::from(code >> k & 1)).collect();
                let whole = point(&case, &program, &on);
                prop_assert!(cut.room(&whole) >= 0.0, "{:?} cuts off {:?}", cut, whole);
            }
        }
    }
}

/// Between `(1, 0)` and `(1, 1)` the length grows as on a line.
#[test]
fn the_length_is_its_convex_hull() {
    let case = Case {
        entries: vec![(0, 3.0), (1, 4.0)],
        constant: 0.0,
        rotated: None,
        point: vec![1.0, 0.5, 0.0, 0.0, 0.0],
    };
    let program = build(&case);
    let x = point(&case, &program, &case.point);
    let cuts = polymatroid_cuts(&program, &Domain::new(&program), &x, &StopToken::default());
    assert_eq!(cuts.len(), 1);
    // `3 b + 2 c <= head` holds with 4 at the point, where the cone says 3.606.
    let scaled: Vec<f64> = cuts[0].terms.iter().map(|(_, a)| 3.0 * a).collect();
    assert!((scaled[0] - 3.0).abs() < 1e-9 && (scaled[1] - 2.0).abs() < 1e-9, "{scaled:?}");
}

/// A tail with a continuous entry has no such cut.
#[test]
fn continuous_entries_have_none() {
    let mut model = Model::new("mixed");
    let on = model.binary_family("on", 2).unwrap();
    let x = model.continuous("x", 0.0, 1.0).unwrap();
    let head = model.continuous("head", 0.0, 9.0).unwrap();
    model.add("length", norm([Affine::from(on[0]), on[1].into(), x.into()]).le(head)).unwrap();
    let program = Program::assemble(&model).unwrap();
    let point = vec![0.5; program.column_count()];
    let cuts = polymatroid_cuts(&program, &Domain::new(&program), &point, &StopToken::default());
    assert!(cuts.is_empty());
}
