//! Long norms as towers of short ones say what the norms say, and searches end at the optimum.

use carom::model::norm;
use carom::prelude::*;
use carom_solver::internals::program::{Cone, Program};
use proptest::prelude::*;

use crate::common::config;

const REGRESSIONS: &str = "tests/regressions/cone_towers.txt";

/// Entries of the tails, and integers of the programs.
const ENTRIES: std::ops::RangeInclusive<usize> = 8..=13;
const INTEGERS: usize = 5;

/// The norm of `rows z + offset` at most a column between 0 and 99, over integers from -1 to 1. A
/// short norm that says nothing new has the long one become a tower; alone it stays whole.
fn with_norm(
    rows: &[[f64; INTEGERS]],
    offset: &[f64],
    costs: &[f64; INTEGERS],
    is_tower: bool,
) -> Model {
    let mut model = Model::new("tower");
    let z = model.integer_family("z", INTEGERS, -1.0, 1.0).unwrap();
    let length = model.continuous("length", 0.0, 99.0).unwrap();
    let entry = |(row, offset): (&[f64; INTEGERS], &f64)| {
        let terms = row.iter().zip(z.iter()).map(|(a, z)| *a * z);
        terms.fold(Affine::from(*offset), |sum, term| sum + term)
    };
    let tail: Vec<Affine> = rows.iter().zip(offset).map(entry).collect();
    if is_tower {
        model.add("short", norm([2.0 * z[0], z[1] - z[2]]).le(length + 9.0)).unwrap();
    }
    model.add("norm", norm(tail).le(length)).unwrap();
    let costs = costs.iter().zip(z.iter()).map(|(c, z)| *c * z);
    model.minimize(costs.fold(Affine::from(length), |sum, term| sum + term)).unwrap();
    model
}

/// The optimum by enumeration.
fn optimum(rows: &[[f64; INTEGERS]], offset: &[f64], costs: &[f64; INTEGERS]) -> f64 {
    let value = |code: usize| {
        let z: Vec<f64> =
            (0..INTEGERS).map(|k| (code / 3_usize.pow(k as u32) % 3) as f64 - 1.0).collect();
        let dot = |row: &[f64; INTEGERS]| row.iter().zip(&z).map(|(a, z)| a * z).sum::<f64>();
        let tail = rows.iter().zip(offset).map(|(row, offset)| (dot(row) + offset).powi(2));
        tail.sum::<f64>().sqrt() + dot(costs)
    };
    (0..3_usize.pow(INTEGERS as u32)).map(value).fold(f64::INFINITY, f64::min)
}

/// Fills in the heads of the inner cones by the norms of their tails, level by level; returns the
/// cone of the head that is left.
fn fill<'a>(tower: &'a [Cone], x: &mut [f64]) -> &'a Cone {
    let (whole, inner) = tower.split_last().unwrap();
    for cone in inner {
        x[cone.columns[0]] = cone.tail().iter().fold(0.0_f64, |sum, &j| sum.hypot(x[j]));
    }
    whole
}

proptest! {
    #![proptest_config(config(300, REGRESSIONS))]

    /// At the least values of the inner heads, the last cone is met exactly where the norm is.
    #[test]
    fn a_tower_is_its_norm(
        tail in prop::collection::vec(prop_oneof![1 => Just(0.0), 4 => -9.0..9.0], ENTRIES),
        room in prop_oneof![Just(0.0), -1e-6..1e-6, -1.0..1.0],
    ) {
        let rows = vec![[0.5; INTEGERS]; tail.len()];
        let program = Program::assemble_with_towers(&with_norm(&rows, &tail, &[0.0; INTEGERS], true)).unwrap();
        // The short norm comes first.
        let tower = &program.cones[1..];
        prop_assert_eq!(tower.len(), tail.len() - 1);
        prop_assert!(tower.iter().all(|cone| cone.tail().len() == 2));
        let mut x = vec![0.0; program.column_count()];
        // The columns of the entries follow those of the model and of the short norm.
        x[INTEGERS + 4..][..tail.len()].copy_from_slice(&tail);
        let length = tail.iter().map(|t| t * t).sum::<f64>().sqrt();
        x[INTEGERS] = length + room;
        let last = fill(tower, &mut x);
        prop_assert_eq!(last.columns[0], INTEGERS);
        prop_assert!((last.miss(&x) + room).abs() <= 1e-12 * length.max(1.0));
        let inner = &tower[..tail.len() - 2];
        prop_assert!(inner.iter().all(|cone| cone.miss(&x) <= 1e-12 * length.max(1.0)));
    }
}

proptest! {
    #![proptest_config(config(24, REGRESSIONS))]

    /// Whether cones are cut off at every node, or also solved as they are.
    #[test]
    fn searches_end_at_the_optimum(
        lines in prop::collection::vec((prop::array::uniform5(-3.0..3.0), -2.0..2.0), ENTRIES),
        costs in prop::array::uniform5(-4.0..4.0),
        deterministic in any::<bool>(),
        is_tower in any::<bool>(),
    ) {
        let (rows, offset): (Vec<[f64; INTEGERS]>, Vec<f64>) = lines.into_iter().unzip();
        let model = with_norm(&rows, &offset, &costs, is_tower);
        let options = Options::default().with_deterministic(deterministic);
        let solution = BranchAndBound::new(options).solve(&model).unwrap();
        let best = optimum(&rows, &offset, &costs);
        prop_assert_eq!(solution.termination(), Termination::Optimal);
        let objective = solution.objective().unwrap();
        prop_assert!((objective - best).abs() <= 1e-5 * best.abs().max(1.0), "{objective} {best}");
        prop_assert!(solution.bound() <= best + 1e-5 * best.abs().max(1.0));
    }
}

/// Constant heads, short tails, multiples of integers, continuous programs, and programs without
/// other cones keep other forms.
#[test]
fn towers_are_for_long_norms_with_open_heads() {
    let cones = |tail: usize, head: [f64; 2], has_integers: bool, has_short: bool| {
        let mut model = Model::new("forms");
        let x = model.continuous_family("x", tail, -9.0, 9.0).unwrap();
        if has_integers {
            model.binary("b").unwrap();
        }
        let length = model.continuous("length", head[0], head[1]).unwrap();
        if has_short {
            model.add("short", norm([x[0] + 1.0, x[1] + 1.0]).le(99.0)).unwrap();
        }
        model.add("norm", norm(x.iter()).le(length)).unwrap();
        let all = Program::assemble_with_towers(&model).unwrap().cones.len();
        all - usize::from(has_short)
    };
    assert_eq!(cones(8, [0.0, 9.0], true, true), 7);
    assert_eq!(cones(9, [0.0, 9.0], true, true), 8);
    assert_eq!(cones(7, [0.0, 9.0], true, true), 8);
    assert_eq!(cones(8, [9.0, 9.0], true, true), 9);
    assert_eq!(cones(8, [0.0, 9.0], false, true), 9);
    assert_eq!(cones(8, [0.0, 9.0], true, false), 9);
    let mut model = Model::new("multiples");
    let b = model.binary_family("b", 8).unwrap();
    let length = model.continuous("length", 0.0, 9.0).unwrap();
    model.add("short", norm([b[0] + 1.0, b[1] + 1.0]).le(99.0)).unwrap();
    model.add("norm", norm(b.iter().map(|b| 2.0 * b)).le(length)).unwrap();
    assert_eq!(Program::assemble_with_towers(&model).unwrap().cones.len(), 10);
}
