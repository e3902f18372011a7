//! Solves that begin again with facets, and their proofs.

use super::*;
use crate::common::mode_steps::{ModeSteps, Numbers};

/// Facets that are taken whether or not they pay change no optimum, and each log is accepted.
#[test]
fn facets_change_no_optimum_and_are_proved() -> Result<(), Error> {
    let numbers = &mut Numbers(17);
    let mut fewer = 0;
    for case in 0..36 {
        let system = ModeSteps::random(numbers, 1 + case % 6);
        let model = system.model(false)?;
        let solve = |options: Options| BranchAndBound::new(options).solve(&model);
        let without = solve(Options::default().with_facet_nodes(u64::MAX))?;
        let path = file(&format!("facets_{case}"));
        let with = solve(Options::default().with_facet_nodes(0).with_proof(&path))?;
        assert_eq!(with.termination(), without.termination(), "{case}");
        let value = |solution: &Solution| solution.objective().unwrap_or(0.0);
        let size = value(&without).abs().max(1.0);
        assert!((value(&with) - value(&without)).abs() <= 1e-5 * size, "{case}");
        let report = with.proof().expect("a proof");
        assert!(report.is_complete, "{case}: {report:?}");
        let log = fs::read(&path).expect("a log");
        let proved = check(&log[..]).unwrap_or_else(|failure| panic!("{case}: {failure}"));
        if let Claim::Bound(bound) = proved.claim {
            assert!((bound - value(&without)).abs() <= 1e-4 * size, "{case}: {bound}");
        }
        let plain = solve(Options::default().with_facet_nodes(0))?;
        assert!((value(&plain) - value(&without)).abs() <= 1e-5 * size, "{case}");
        fewer += u32::from(plain.statistics().nodes != without.statistics().nodes);
    }
    assert!(fewer > 3, "{fewer} trees were begun again");
    Ok(())
}
