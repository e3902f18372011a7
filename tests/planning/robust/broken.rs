//! Attempts to break tubes: other kinds of systems, with the statements of the programs checked on
//! each run.

use carom::ErrorKind;
use carom::hybrid::{Feedback, RobustError};
use carom::model::sos1;
use carom::prelude::*;
use std::collections::BTreeSet;

use super::promises::{MISS, runs, value};
use super::{Draw, random_systems};

#[test]
fn no_disturbed_run_of_any_kind_leaves_its_plan() -> Result<(), Error> {
    let mut found = BTreeSet::new();
    let mut count = 0;
    for case in 0..2 * random_systems::KINDS {
        for factor in [1.0, 0.4] {
            let (program, feedback, miss) = random_systems::kind(case, factor)?;
            let robust = program.robust(&feedback)?;
            let plan = match robust.solve(&mut BranchAndBound::default()) {
                Ok(plan) => plan,
                Err(error) if matches!(error.kind(), ErrorKind::NoPlan { .. }) => continue,
                Err(error) => return Err(error),
            };
            found.insert(case % random_systems::KINDS);
            count += 1;
            for run in 0..runs() {
                let mut draw = Draw::new(7919 * case + run);
                let flown = plan.simulate(&mut |range| value(&mut draw, run, range))?;
                assert!(flown.kept, "case {case} at {factor}, run {run}: {:?}", flown.deviation);
                let miss = miss(&flown.run).max(flown.largest_violation);
                assert!(miss <= MISS, "case {case} at {factor}, run {run}: {miss}");
            }
            break;
        }
    }
    assert_eq!(found.len() as u64, random_systems::KINDS, "{found:?}");
    assert!(count >= 16, "{count}");
    Ok(())
}

/// A certificate fails as soon as ranges grow beyond what the plan has room for, and never later
/// than a run.
#[test]
fn certificates_fail_before_runs_do() -> Result<(), Error> {
    let mut failed = 0;
    for case in 0..2 * random_systems::KINDS {
        let (program, feedback, miss) = random_systems::kind(case, 0.4)?;
        let Ok(plan) = program.robust(&feedback)?.solve(&mut BranchAndBound::default()) else {
            continue;
        };
        for scale in [0.0, 0.5, 1.0, 1.5, 3.0, 8.0, 30.0, 1e3] {
            let is_certified = plan.certify(scale).is_ok();
            assert!(is_certified || scale > 1.0, "case {case} at {scale}");
            failed += usize::from(!is_certified);
            if !is_certified {
                continue;
            }
            for run in 0..30 {
                let mut draw = Draw::new(31 * case + run);
                let flown = plan.simulate(&mut |range| scale * value(&mut draw, run, range))?;
                assert!(flown.kept, "case {case} at {scale}: {:?}", flown.deviation);
                assert!(miss(&flown.run) <= MISS, "case {case} at {scale}");
            }
        }
        assert!(plan.certify(1e3).is_err(), "case {case}");
    }
    assert!(failed > 10, "{failed}");
    Ok(())
}

/// A magnitude of what a row defines differs between runs as the states do.
#[test]
fn functions_of_defined_variables_are_tightened() -> Result<(), Error> {
    let mut cart = HybridSystem::new(1.0);
    let x = cart.state("x", -9.0, 9.0)?;
    let u = cart.input("u", -1.0, 1.0)?;
    cart.disturbance(x, -0.1, 0.1)?;
    cart.mode("roll")?.next([x.is(x + u)])?;
    let mut program = cart.program(3)?;
    program.start([x.equals(0.0)])?;
    let copy = program.model_mut().continuous("copy", -9.0, 9.0)?;
    let size = program.model_mut().absolute("size", copy)?;
    program.add("copy is", copy.equals(program.end(x)?))?;
    program.add("at most", size.le(2.0))?;
    program.maximize(program.end(x)?)?;
    let plan = program.robust(&Feedback::none(&cart)?)?.solve(&mut BranchAndBound::default())?;
    assert!((plan.plan.value(x, 3)? - 1.7).abs() < 1e-5, "{}", plan.plan.value(x, 3)?);
    // An equation with a function is no definition of it.
    let mut program = cart.program(3)?;
    program.start([x.equals(0.0)])?;
    let free = program.model_mut().continuous("free", 0.0, 9.0)?;
    let size = program.model_mut().absolute("size", free)?;
    program.add("size is", size.equals(program.end(x)?))?;
    let error = program.robust(&Feedback::none(&cart)?);
    let Err(error) = error else { panic!("not refused") };
    assert!(matches!(error.kind(), ErrorKind::Robust(RobustError::OneValue { .. })), "{error}");
    Ok(())
}

#[test]
fn ordered_sets_and_products_of_states_are_refused() -> Result<(), Error> {
    let mut cart = HybridSystem::new(1.0);
    let x = cart.state("x", 0.0, 9.0)?;
    let y = cart.state("y", 0.0, 9.0)?;
    let u = cart.input("u", -1.0, 1.0)?;
    cart.disturbance(x, -0.1, 0.1)?;
    cart.mode("roll")?.next([x.is(x + u), y.is(y + u)])?;
    let mut program = cart.program(3)?;
    let members = [(program.variable(x, 2)?, 1.0), (program.variable(y, 2)?, 2.0)];
    program.add("one of them", sos1(members))?;
    let error = program.robust(&Feedback::none(&cart)?);
    let Err(error) = error else { panic!("not refused") };
    let ErrorKind::Robust(RobustError::Statement { statement, kind, .. }) = error.kind() else {
        panic!("{error}")
    };
    assert_eq!((statement.as_str(), *kind), ("one of them", "an ordered set of states or inputs"));
    Ok(())
}
