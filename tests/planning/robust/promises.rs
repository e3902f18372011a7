//! Disturbed runs keep what robust plans promise.

use std::collections::BTreeSet;

use carom::ErrorKind;
use carom::hybrid::{Feedback, RobustPlan};
use carom::interval::Interval;
use carom::prelude::*;

use super::{Draw, cases};

/// How many cases have a robust plan.
const CASES: u64 = 20;

/// By how much a statement may be missed.
pub(super) const MISS: f64 = 2e-6;

/// Disturbed runs of each case; `ROBUST_RUNS=100000` for more.
pub(super) fn runs() -> u64 {
    std::env::var("ROBUST_RUNS").ok().and_then(|runs| runs.parse().ok()).unwrap_or(300)
}

/// The robust plan of a case, with the largest disturbances for which there is one.
fn planned(case: u64) -> Result<Option<(f64, RobustPlan)>, Error> {
    for factor in [1.0, 0.5, 0.2] {
        let program = cases::program(case, factor)?;
        let feedback = Feedback::regulator(program.system())?;
        match program.robust(&feedback)?.solve(&mut BranchAndBound::default()) {
            Ok(plan) => return Ok(Some((factor, plan))),
            Err(error) if matches!(error.kind(), ErrorKind::NoPlan { .. }) => {}
            Err(error) => return Err(error),
        }
    }
    Ok(None)
}

/// Ends of ranges in some runs, all of one sign in others, and numbers within them.
pub(super) fn value(draw: &mut Draw, run: u64, range: Interval) -> f64 {
    match run {
        0 => range.lower,
        1 => range.upper,
        _ if run.is_multiple_of(3) => draw.within(range.lower, range.upper),
        _ if draw.unit() < 0.5 => range.lower,
        _ => range.upper,
    }
}

#[test]
fn no_disturbed_run_leaves_its_plan() -> Result<(), Error> {
    let (mut found, mut events, mut kinds) = (0, 0, BTreeSet::new());
    for case in 0..40 {
        if found == CASES {
            break;
        }
        let Some((factor, robust)) = planned(case)? else { continue };
        found += 1;
        kinds.insert(case % 6);
        let plan = &robust.plan;
        events += plan.certificate.events;
        for run in 0..runs() {
            let mut draw = Draw::new(1000 * case + run);
            let flown = robust.simulate(&mut |range| value(&mut draw, run, range))?;
            assert!(flown.kept, "case {case} with {factor}: run {run} {:?}", flown.deviation);
            assert!(flown.largest_violation <= MISS, "case {case}: {}", flown.largest_violation);
            // Every state lies in the certified box.
            for (i, (name, values)) in flown.run.states.iter().enumerate() {
                assert_eq!(values.len(), plan.steps() + 1);
                let planned = plan.run.state(name)?;
                for (t, (x, z)) in values.iter().zip(planned).enumerate() {
                    let Interval { lower, upper } = robust.certificate.states[t][i];
                    let off = x - z;
                    assert!(lower - 1e-9 <= off && off <= upper + 1e-9, "case {case}: {off}");
                }
            }
        }
    }
    assert_eq!(found, CASES);
    assert_eq!(kinds.len(), 6);
    assert!(events > 0);
    Ok(())
}
