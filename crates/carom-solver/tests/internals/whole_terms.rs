//! Terms of whole numbers are exact, however large: rows over them are missed or not.

use carom::prelude::*;
use carom_solver::internals::presolve::{Domain, Propagator, reduce};
use carom_solver::internals::program::Program;

/// The domain of a model after propagation; nothing if that refutes it.
fn propagated(model: &Model) -> Option<(Program, Domain)> {
    let program = Program::assemble(model).unwrap();
    let mut domain = Domain::new(&program);
    Propagator::new(&program).propagate_all(&program, &mut domain).ok()?;
    Some((program, domain))
}

/// A value within the integrality tolerance of 0 leaves 1, if 0 misses the row.
#[test]
fn rows_bound_whole_columns_exactly() {
    for (big, right, least) in [
        (1e8, 20.0, 1.0),
        (1e8, 0.01, 1.0),
        (1e8 - 0.5, 0.2, 1.0),
        (1e8, 5e-7, 0.0),
        (1.0, 5e-7, 0.0),
    ] {
        let mut model = Model::new("m");
        let z = model.binary("z").unwrap();
        let x = model.continuous("x", 0.0, 10.0).unwrap();
        model.add("r", (big * z - x).ge(right)).unwrap();
        let (_, domain) = propagated(&model).unwrap();
        assert_eq!(domain.lower(0), least, "{big} z >= {right}");
    }
}

/// Rows of terms of 1e10 that are missed by less than a billionth of these, or by less than plain
/// sums can tell.
#[test]
fn rows_over_wide_integers_are_refuted() {
    let mut model = Model::new("m");
    let x = model.integer("x", 1e10, 1e10).unwrap();
    let y = model.integer("y", 875e7, 875e7).unwrap();
    let row = model.add("r", (7.0 * x - 8.0 * y).within(1.0, 3.0)).unwrap();
    assert!(propagated(&model).is_none());
    // The same row at a leaf of the tree.
    let program = Program::assemble(&model).unwrap();
    let domain = Domain::new(&program);
    assert!(reduce(&program, &domain).is_none());
    model.set_limits(row, 0.0, 3.0).unwrap();
    let program = Program::assemble(&model).unwrap();
    assert!(propagated(&model).is_some() && reduce(&program, &domain).is_some());

    let mut model = Model::new("m");
    let z = model.integer("z", 0.0, 1e9).unwrap();
    let u = model.integer("u", 0.0, 2.0).unwrap();
    let y = model.integer("y", 1e9, 2e9).unwrap();
    let row = model.add("r", (1e8 * z + 1.0 * u - 1e8 * y).ge(3.0)).unwrap();
    assert!(propagated(&model).is_none());
    model.set_limits(row, 2.0, f64::INFINITY).unwrap();
    let (_, domain) = propagated(&model).unwrap();
    assert_eq!(
        [domain.bounds(0), domain.bounds(1), domain.bounds(2)],
        [[1e9; 2], [2.0; 2], [1e9; 2]]
    );
}

/// A fraction with few binary digits is as exact as a whole number.
#[test]
fn short_fractions_are_exact() {
    let mut model = Model::new("m");
    let z = model.integer("z", 1.0, 1.0).unwrap();
    model.add("r", (99_999_999.75 * z).le(99_999_999.744_140_63)).unwrap();
    assert!(propagated(&model).is_none());
    let program = Program::assemble(&model).unwrap();
    assert!(reduce(&program, &Domain::new(&program)).is_none());
}

/// A column that presolve put in terms of large ones keeps its bounds.
#[test]
fn substituted_columns_keep_their_bounds() {
    use carom_solver::internals::presolve::root::{Presolve, PresolveRule, presolve};
    let mut model = Model::new("m");
    let s = model.continuous("s", 0.0, 1.0).unwrap();
    let t = model.continuous("t", 0.0, 10_000.0).unwrap();
    let x = model.integer("x", -1e9, 1e9 + 6.0).unwrap();
    let y = model.integer("y", -1e9, 1e9 + 2.0).unwrap();
    model.add("r", (-7.0 * x - 8.0 * y + 1.0 * s + 6.0 * t).equals(-752.0)).unwrap();
    model.maximize(4.0 * x + 5.0 * y + 1.0 * s).unwrap();
    let program = Program::assemble(&model).unwrap();
    let Ok(Presolve::Presolved(presolved)) =
        presolve(&program, &[PresolveRule::SlackColumns], &Default::default())
    else {
        panic!("it has points")
    };
    assert_eq!(presolved.program.column_count(), 3);
    for k in 0..200 {
        // 7 x + 8 y is between 752 and 60752, far out.
        let y = 1e9 - f64::from(k);
        let x = ((60_000.0 - 8.0 * y) / 7.0).floor();
        let rest = 7.0 * x + 8.0 * y - 752.0;
        for s in [0.0, 0.3, 1.0] {
            let t = (rest - s) / 6.0;
            let point = presolved.postsolve.point(&[t, x, y]);
            assert!((0.0..=1.0).contains(&point[0]), "{point:?}");
            assert!((point[0] - s).abs() < 1e-9, "{point:?}");
        }
    }
}
