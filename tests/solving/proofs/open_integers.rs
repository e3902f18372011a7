//! Programs of all kinds with integers that have no bounds: a log that is called complete is
//! accepted.

use std::time::Duration;

use carom::model::{Model, lp};
use carom::prelude::*;
use carom_proof::{Claim, check};
use proptest::prelude::*;

use super::{file, is_proved, texts};
use crate::common::config;

/// Solves a model under limits, with a log.
fn solved(model: &Model, name: &str) -> Result<(Solution, Vec<u8>), Error> {
    let path = file(name);
    let options = Options::default().with_node_limit(500).with_time_limit(Duration::from_secs(5));
    let solution = BranchAndBound::new(options.with_proof(&path)).solve(model)?;
    let log = std::fs::read(&path).unwrap_or_default();
    Ok((solution, log))
}

/// Checks that a log that is called complete is accepted, and an incomplete one is not, and that no
/// point is better than what is proved. Returns whether there is a complete log.
fn is_as_it_says(model: &Model, name: &str, text: &str) -> Result<bool, TestCaseError> {
    // Refused, with a reason: an indicator without an M, squares that are not convex.
    let Ok((solution, log)) = solved(model, name) else { return Ok(false) };
    let Some(report) = solution.proof() else { return Ok(false) };
    let checked = check(&log[..]);
    prop_assert_eq!(report.is_complete, checked.is_ok(), "{:?} of\n{}", checked, text);
    let Ok(proved) = checked else { return Ok(false) };
    match proved.claim {
        Claim::Infeasible => prop_assert!(solution.is_infeasible(), "{}", text),
        Claim::Bound(bound) => {
            let found = solution.objective().map(|value| model.sense().sign() * value);
            let is_below = found.is_none_or(|value| bound <= value + 1e-6 * value.abs().max(1.0));
            prop_assert!(is_below, "{} proved, {:?} found of\n{}", bound, found, text);
        }
    }
    Ok(true)
}

proptest! {
    #![proptest_config(config(150, "tests/regressions/proofs.txt"))]

    #[test]
    fn complete_logs_of_open_integers_are_accepted(seed in any::<u64>()) {
        let text = texts::lp(seed, false);
        let model = lp::read(&text).expect("a program").model;
        is_as_it_says(&model, "open_integers", &text)?;
    }
}

/// Most logs of such programs are complete.
#[test]
fn most_logs_of_open_integers_are_complete() {
    let (mut logs, mut complete) = (0, 0);
    for seed in 0..150 {
        let model = lp::read(&texts::lp(seed, false)).expect("a program").model;
        let Ok((solution, _)) = solved(&model, "most_open_integers") else { continue };
        let Some(report) = solution.proof() else { continue };
        logs += 1;
        complete += u32::from(report.is_complete);
    }
    assert!(logs > 60 && 5 * complete >= 4 * logs, "{complete} of {logs} are complete");
}

/// A bound from curvature that is not whole: the split was at -0.33.
#[test]
fn bounds_from_curvature_are_rounded_for_integers() {
    let text = "Minimize\n obj: x + [ 6 x ^ 2 ] / 2\nSubject To\n r: y >= 0\nBounds\n -inf <= x <= 1\n \
                y <= 1\nGeneral\n x\nEnd\n";
    let model = lp::read(text).expect("a program").model;
    assert_eq!(is_proved(&model, "rounded_curvature").objective(), Some(0.0));
}

/// Bounds of integers that are not whole, and those beyond the whole numbers that floats count.
#[test]
fn bounds_of_integers_may_be_any() {
    for (name, bounds, value) in [
        ("fractional", " 0.5 <= x <= 3.5\n 0.25 <= y <= 0.75\n", None),
        ("fractions", " 0.5 <= x <= 3.5\n -1.5 <= y <= 1.5\n", Some(-5.0)),
        ("far", " -1e17 <= x <= 3\n -1e18 <= y <= 1e18\n", Some(-5.0)),
        ("very far", " -1e17 <= x <= 1e19\n -1e18 <= y <= 1e18\n", Some(-5.0)),
    ] {
        let text = format!(
            "Minimize\n obj: - x - 2 y\nSubject To\n r: 2 x + 2 y <= 9\n s: y - x <= 0\nBounds\n{bounds}General\n \
             x y\nEnd\n"
        );
        let model = lp::read(&text).expect("a program").model;
        let (solution, log) = solved(&model, name).expect("an answer");
        let report = solution.proof().expect("a log");
        assert_eq!(report.is_complete, check(&log[..]).is_ok(), "{name}");
        if let Some(value) = value {
            let found = solution.objective().unwrap_or(f64::NAN);
            assert!((found + 6.0).abs() < 1e-6 || (found - value).abs() < 1.5, "{name}: {found}");
        }
    }
}

/// An integer that is binary by derived bounds only: the log must have these before a tightened row
/// is proved by its two values.
#[test]
fn columns_that_become_binary_have_their_bounds_in_the_log() {
    let text = "Minimize\n obj: 2 x0 - x1 + [ 9 x0 ^ 2 + x1 ^ 2 ] / 2\nSubject To\n \
                r0: - 2 x0 - 4 x1 + b >= -7\n r1: 2 x0 - 4 x1 <= -4\n \
                r2: 4 x0 + 2 x1 + 3 b <= 9.5\nBounds\n -2 <= x0 <= 2\n \
                -1e16 <= x1 <= 1e17\nGeneral\n x0\nBinary\n b\nEnd\n";
    let model = lp::read(text).expect("a program").model;
    assert_eq!(is_proved(&model, "becomes_binary").objective(), Some(-0.5));
}

/// A square form that is singular, with a factor that is no float, over a column without a bound:
/// it is made steep there at the cost of the column that has bounds.
#[test]
fn singular_squares_beside_open_columns_have_proofs() {
    let two = "18 x ^ 2 - 84 x * y + 98 y ^ 2";
    let three = "10 x ^ 2 + 28 x * y + 12 x * z + 26 y ^ 2 + 4 y * z + 10 z ^ 2";
    for (form, bounds, value) in [
        (two, " -inf <= x <= 0\n y <= 4\n", 50.0),
        (two, " x free\n y <= 4\n", 1.0),
        (three, " x free\n y <= 4\n z free\n", 1.0),
    ] {
        let text = format!(
            "Minimize\n obj: [ {form} ] / 2 + y\nSubject To\n r: y >= 1\nBounds\n{bounds}End\n"
        );
        let model = lp::read(&text).expect("a program").model;
        let found = is_proved(&model, "singular").objective().unwrap_or(f64::NAN);
        assert!((found - value).abs() < 1e-5, "{found} of {text}");
    }
}
