//! Models of which some integers are relaxed: their bounds are bounds on the whole model, and their
//! optima those of the model with continuous variables in the place of these integers.

use crate::common::case::Case;
use crate::common::config;
use crate::common::enumeration::optimum;
use crate::common::generate::{Shape, case};
use crate::common::quadratic_program::Minimum;
use carom::prelude::*;
use carom::reformulate::{lower, relaxed};
use proptest::prelude::*;

/// Agreement of objectives, relative and absolute.
const AGREEMENT: f64 = 1e-6;

/// The model of a case in which the integers of a mask are relaxed.
fn relaxed_by(case: &Case, mask: &[bool]) -> (Model, Vec<Variable>) {
    let (mut model, variables) = case.build();
    for (&variable, _) in variables.iter().zip(mask).filter(|(_, is_relaxed)| **is_relaxed) {
        model.relax_integer(variable).unwrap();
    }
    (model, variables)
}

fn solve(model: &Model) -> Solution {
    BranchAndBound::default().solve(model).unwrap()
}

fn assert_alike(one: &Solution, other: &Solution, what: &str) -> Result<(), TestCaseError> {
    prop_assert_eq!(one.termination(), other.termination(), "{}", what);
    if let (Some(a), Some(b)) = (one.objective(), other.objective()) {
        prop_assert!((a - b).abs() <= AGREEMENT * a.abs().max(1.0), "{what}: {a} and {b}");
    }
    Ok(())
}

/// An objective that is convex at whole values only is refused, or has a bound that holds, once they
/// are relaxed.
#[test]
fn objectives_that_need_whole_values_get_no_wrong_bound() {
    for (rows, best) in [(0.0, -1.0), (1.0, -0.25), (0.6, -0.09)] {
        let mut model = Model::new("apart");
        let (a, b) = (model.binary("a").unwrap(), model.binary("b").unwrap());
        model.minimize(-1.0 * (a - b).square() + 0.3 * a * b).unwrap();
        if rows > 0.0 {
            model.add("row", (2.0 * a).equals(rows)).unwrap();
            model.add("off", (1.0 * b).equals(0.0)).unwrap();
        }
        model.relax_integer(a).unwrap();
        match BranchAndBound::default().solve(&model) {
            Ok(found) => assert!(found.bound() <= best + 1e-6, "{found:?}"),
            Err(error) => assert!(error.to_string().contains("convex"), "{error}"),
        }
    }
}

#[cfg(feature = "serde")]
#[test]
fn what_is_relaxed_is_written() {
    let mut model = Model::new("apart");
    let (a, b) = (model.binary("a").unwrap(), model.binary("b").unwrap());
    model.minimize(-1.0 * (a - b).square()).unwrap();
    model.relax_integer(b).unwrap();
    assert!(model.to_string().contains("b binary, relaxed\n"), "{model}");
    let text = serde_json::to_string(&model).unwrap();
    let read: Model = serde_json::from_str(&text).unwrap();
    assert_eq!(read.relaxed_integers().collect::<Vec<_>>().len(), 1);
    assert_eq!(read.to_string(), model.to_string());
}

proptest! {
    #![proptest_config(config(120, "tests/regressions/relaxed_integers.txt"))]

    #[test]
    fn bounds_are_bounds_on_the_whole_model(
        case in case(Shape::BOUNDED),
        mask in prop::collection::vec(any::<bool>(), 8),
    ) {
        let (model, variables) = relaxed_by(&case, &mask);
        let found = solve(&model);
        let kinds: Vec<VariableKind> = model.variables().map(|v| v.kind()).collect();
        let told: Vec<Variable> = (0..kinds.len())
            .filter(|&j| mask[j] && kinds[j].is_integral())
            .map(|j| variables[j])
            .collect();
        prop_assert_eq!(found.relaxed(), &told[..]);
        let sign = case.sign();
        if let Minimum::Attained { value, .. } = optimum(&case) {
            prop_assert!(!found.is_infeasible(), "the whole model has a point\n{model}");
            let bound = sign * found.bound();
            prop_assert!(bound <= value + AGREEMENT * value.abs().max(1.0), "{bound} {value}\n{model}");
        }
        if found.point().is_some() {
            for (j, &variable) in variables.iter().enumerate() {
                let value = found.value(variable).unwrap();
                let is_whole = (value - value.round()).abs() <= 1e-9;
                prop_assert!(!kinds[j].is_integral() || mask[j] || is_whole, "{value}\n{model}");
            }
            prop_assert!(found.verification().is_some_and(|check| check.holds()));
        }
        // A prepared model finds the same.
        let (mut solver, control) = (BranchAndBound::default(), &mut Control::default());
        let prepared = solver.prepare(&model).unwrap().solve(&[], control).unwrap();
        assert_alike(&prepared, &found, "prepared")?;
        // So does the lowered one, which every other use of the model begins with.
        let lowered = lower(&model).unwrap();
        let is_whole = |v: &Variable| lowered.model().variable_ref(*v).unwrap().kind().is_integral();
        prop_assert!(told.iter().all(|variable| !is_whole(variable)));
        let own = lowered.solve(&model, &mut BranchAndBound::default()).unwrap();
        assert_alike(&own, &found, "lowered")?;
    }

    /// Of a model of rows, by enumeration of the integers that are left.
    #[test]
    fn optima_are_those_of_mixed_models(case in case(Shape::BOUNDED), which in 0..8_usize) {
        let rows = Case { switches: Vec::new(), ..case };
        let integers: Vec<usize> = (0..rows.columns.len())
            .filter(|&j| rows.columns[j].kind.is_integral())
            .collect();
        prop_assume!(!integers.is_empty());
        let j = integers[which % integers.len()];
        let mask: Vec<bool> = (0..rows.columns.len()).map(|k| k == j).collect();
        let (model, _) = relaxed_by(&rows, &mask);
        let mut mixed = rows.clone();
        mixed.columns[j].kind = VariableKind::Continuous;
        let found = solve(&model);
        match optimum(&mixed) {
            Minimum::Attained { value, .. } => {
                prop_assert!(found.is_optimal(), "{}\n{}", found.termination(), model);
                let own = rows.sign() * found.objective().unwrap();
                prop_assert!((own - value).abs() <= AGREEMENT * value.abs().max(1.0), "{own} {value}\n{model}");
            }
            Minimum::Infeasible => prop_assert!(found.is_infeasible(), "{model}"),
            Minimum::Unbounded => prop_assert_eq!(found.termination(), Termination::Unbounded),
        }
    }

    #[test]
    fn none_and_all_are_the_model_and_its_relaxation(case in case(Shape::BOUNDED)) {
        let (model, variables) = relaxed_by(&case, &[]);
        let (all, _) = relaxed_by(&case, &vec![true; variables.len()]);
        assert_alike(&solve(&all), &solve(&relaxed(&model).unwrap()), "all")?;
        prop_assert!(solve(&model).relaxed().is_empty());
    }
}
