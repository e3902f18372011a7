//! The same program in other units: a change of units changes nothing.

use carom::prelude::*;
use carom::solution::{Note, Point};

/// A store of goods that is filled by batches and drained by orders, with lengths of `unit`.
///
/// # Arguments
///
/// * `unit`: the factor of amounts; `weight`: the factor of rows.
fn storage(unit: f64, weight: f64) -> Result<(f64, Vec<f64>), Error> {
    let mut model = Model::new("storage");
    let orders = [3.0, 1.0, 4.0, 1.0, 5.0, 2.0];
    let mut stock = model.continuous("s0", 2.0 * unit, 2.0 * unit)?;
    let (mut cost, mut batches) = (Affine::default(), Vec::new());
    for (k, order) in orders.into_iter().enumerate() {
        let on = model.binary(format!("on{k}"))?;
        let batch = model.continuous(format!("b{k}"), 0.0, 6.0 * unit)?;
        let next = model.continuous(format!("s{}", k + 1), 0.0, 7.0 * unit)?;
        let balance = weight * next - weight * stock - weight * batch;
        model.add(format!("balance{k}"), balance.equals(-weight * order * unit))?;
        let most = weight * batch - 6.0 * weight * unit * on;
        model.add(format!("most{k}"), most.le(0.0))?;
        cost += 5.0 * on + 0.7 / unit * next + 1.1 / unit * batch;
        (stock, batches) = (next, [batches, vec![on]].concat());
    }
    model.minimize(cost)?;
    let solution = BranchAndBound::default().solve(&model)?;
    assert!(solution.is_optimal(), "{unit:e} {weight:e}: {solution:?}");
    let point = solution.point().expect("a point");
    let on = batches.iter().map(|&on| point.value(on)).collect::<Result<Vec<f64>, Error>>()?;
    Ok((solution.objective().expect("a value"), on))
}

#[test]
fn units_of_amounts_and_rows_change_nothing() -> Result<(), Error> {
    let (right, on) = storage(1.0, 1.0)?;
    for unit in [1e-9, 1e-7, 1e-5, 1e-3, 1e3, 1e5] {
        for weight in [1.0, 1e-9, 1e-6, 1e3] {
            let (value, own) = storage(unit, weight)?;
            assert!((value - right).abs() <= 1e-5 * right, "{unit:e} {weight:e}: {value} {right}");
            assert_eq!(own, on, "{unit:e} {weight:e}");
        }
    }
    Ok(())
}

/// A point that misses a row by all that its terms can be does not satisfy it.
#[test]
fn a_row_of_tiny_terms_is_not_satisfied_by_the_absolute_tolerance() -> Result<(), Error> {
    for unit in [1.0, 1e-4, 1e-9, 1e-12] {
        let mut model = Model::new("tiny");
        let x = model.continuous("x", 0.0, unit)?;
        let y = model.continuous("y", 0.0, unit)?;
        model.add("enough", (x + y).ge(1.5 * unit))?;
        for (values, holds) in [([0.0, 0.0], false), ([1.0, 1.5], false), ([1.0, 0.5], true)] {
            let point = Point::new(&model, values.map(|value| value * unit).to_vec())?;
            assert_eq!(
                Verification::of(&model, &point, 1e-6).holds(),
                holds,
                "{unit:e} {values:?}"
            );
        }
        model.minimize(x + 2.0 * y)?;
        let solution = BranchAndBound::default().solve(&model)?;
        let objective = solution.objective().expect("a point");
        assert!(solution.is_optimal() && (objective / unit - 2.0).abs() < 1e-5, "{unit:e}");
        model.add("more", (x + y).ge(2.5 * unit))?;
        assert!(BranchAndBound::default().solve(&model)?.is_infeasible(), "{unit:e}");
    }
    Ok(())
}

/// What lies below the tolerance beside larger numbers is said.
#[test]
fn a_range_below_the_tolerance_is_noted() -> Result<(), Error> {
    let mut model = Model::new("narrow");
    let x = model.continuous("x", 5.0, 5.0 + 1e-8)?;
    let y = model.continuous("y", 0.0, 1e-8)?;
    model.minimize(x + y)?;
    let solution = BranchAndBound::default().solve(&model)?;
    assert_eq!(solution.notes(), [Note::BelowTolerance { variables: 1 }]);
    let text = "the whole range of 1 variable is below the tolerance; measure them from one of their \
                bounds, or in smaller units [below-tolerance]";
    assert_eq!(solution.notes()[0].to_string(), text);
    Ok(())
}
