//! Three optima that an earlier version took for proved, each from a fault of its own: a tolerance
//! that grew with the terms of a row, an excluded case of a hull, a square without bounds.
//!
//! With a fault brought back, the answer is wrong and called optimal, and its log says where; or the
//! search notices by itself.

// Other builds have no mutations.
#![cfg_attr(not(debug_assertions), allow(unused_imports, dead_code))]

use carom::model::Model;
use carom::prelude::*;
use carom::solver::{Heuristics, MipStart};
use carom_model::internals::mutations::{Mutation, with_mutation};
use carom_proof::check;
use carom_solver::internals::proof::write_proof_of;

use super::{file, is_proved};
use crate::torture::generator;
use crate::torture::oracle::{Truth, truth};

/// Programs with free columns and terms of 1e6 to 1e10, of which a tolerance that grows with the
/// terms makes false optima.
const LARGE: [u64; 5] = [776, 1623, 2042, 2637, 4076];

/// Solves a program without heuristics and without rules that make it smaller. Returns the solution
/// and the log.
fn solved(model: &Model, start: Option<&MipStart>, name: &str) -> (Solution, String) {
    let path = file(name);
    let options = Options::default().with_heuristics(Heuristics::none()).with_reductions(false);
    let mut control = Control::default();
    if let Some(start) = start {
        control = control.with_start(start);
    }
    let mut solver = BranchAndBound::new(options.with_proof(&path));
    let solution = solver.solve_with(model, &mut control).expect("an answer");
    (solution, std::fs::read_to_string(&path).expect("a log"))
}

/// The place of the line at which a log is rejected, and why.
fn rejected(log: &str) -> (usize, String) {
    let failure = check(log.as_bytes()).expect_err("a log of a false answer");
    assert!(failure.is_readable, "{failure}");
    (failure.line as usize - 1, failure.reason)
}

fn is_near(solution: &Solution, value: f64) -> bool {
    let found = solution.objective().unwrap_or(f64::NAN);
    (found - value).abs() <= 1e-4 * value.abs().max(1.0)
}

/// Excluding `a` selects `c`, so that the bound of `t` in the case `b` does not hold.
fn hull() -> Result<(Model, [Variable; 3]), Error> {
    let mut model = Model::new("hull");
    let [a, b, c] = [model.binary("a")?, model.binary("b")?, model.binary("c")?];
    let [t, w] = [model.continuous("t", 0.0, 1.0)?, model.continuous("w", 0.0, 1.0)?];
    model.add("cover", (a + b + c).ge(1.0))?;
    model.add("low", (w - a).ge(0.0))?;
    model.add("high", (w + a).le(1.0))?;
    model.add("decides", (3.0 * a + 7.0 * b + 8.0 * c).ge(8.0))?;
    model.add("narrow", (t + 0.8 * b).le(1.0))?;
    model.maximize(t)?;
    Ok((model, [a, b, c]))
}

/// While `z` is 0, `x` is at least 0, and nothing bounds it from above.
fn open_square() -> Result<Model, Error> {
    let mut model = Model::new("open square");
    let (x, z) = (model.continuous("x", -5.0, f64::INFINITY)?, model.binary("z")?);
    model.add("off", (x + z * 40.0).ge(0.0))?;
    model.minimize((x + 4.0).square() + z * 20.0)?;
    Ok(model)
}

/// As they are, the programs are solved, and the proofs of their answers are accepted.
#[test]
fn the_right_optima_have_proofs() -> Result<(), Error> {
    for (model, value) in [(hull()?.0, 1.0), (open_square()?, 16.0)] {
        assert!(is_near(&is_proved(&model, model.name()), value));
        let (solution, log) = solved(&model, None, model.name());
        assert!(solution.is_optimal() && is_near(&solution, value), "{}", model.name());
        assert!(check(log.as_bytes()).is_ok(), "{}", model.name());
    }
    Ok(())
}

/// Claims that are a little too good, and that of the square without bounds, have no proof.
#[test]
fn false_claims_about_them_have_no_proof() -> Result<(), Error> {
    for (model, bounds) in [(hull()?.0, [-0.9, -0.2]), (open_square()?, [16.1, 20.0])] {
        for bound in bounds {
            let mut log = Vec::new();
            let report = write_proof_of(&model, Some(bound), &mut log)?;
            assert!(!report.is_complete && check(&log[..]).is_err(), "{} {bound}", model.name());
        }
    }
    Ok(())
}

/// The point is none of the program, and the log is rejected where it names the point.
#[test]
#[cfg(debug_assertions)]
fn a_tolerance_that_grows_with_the_terms_is_rejected_at_the_point() {
    for seed in LARGE {
        let case = generator::large(seed);
        let (model, _) = case.build();
        let Truth::Least { value, .. } = truth(&case) else { panic!("{seed}: no point") };
        let right = model.sense().sign() * value;
        let path = file(&format!("large_{seed}"));
        // Presolve measures columns from where they are, and leaves no large terms.
        let options = Options::default().with_reductions(false).with_proof(&path);
        let mut solver = BranchAndBound::new(options);
        let mut run = || {
            (
                solver.solve(&model).expect("an answer"),
                std::fs::read_to_string(&path).expect("a log"),
            )
        };

        let (solution, log) = with_mutation(Mutation::ScaledTolerance, &mut run);
        assert!(solution.is_optimal() && !is_near(&solution, right), "{seed}");
        let (at, reason) = rejected(&log);
        let line = log.lines().nth(at).expect("a line");
        assert!(
            line.starts_with("a ") && reason.starts_with("the point misses "),
            "{seed}: {reason}"
        );

        let (solution, log) = run();
        assert!(solution.is_optimal() && is_near(&solution, right), "{seed}");
        assert!(check(log.as_bytes()).is_ok(), "{seed}");
    }
}

/// The bound is false: the log comes to a place that no sum of facts closes.
#[test]
#[cfg(debug_assertions)]
fn a_case_left_out_of_a_hull_is_rejected_where_it_has_a_point() -> Result<(), Error> {
    let (model, _) = hull()?;
    let (solution, log) =
        with_mutation(Mutation::ExcludedCase, || solved(&model, None, "excluded"));
    assert!(solution.is_optimal() && is_near(&solution, 0.2));
    assert_eq!(solution.statistics().contradictions, 0);
    assert!(!solution.proof().is_some_and(|report| report.is_complete));
    let (at, reason) = rejected(&log);
    assert_eq!(log.lines().nth(at), Some("x 0"));
    assert_eq!(reason, "the combination is no contradiction: it holds with 0 to spare");
    assert_eq!(log.lines().nth(at - 1), Some("# no sum of facts closes this context"));
    Ok(())
}

/// An accepted point that a mutation excludes, or makes dearer, ends it: the answer is the right one,
/// and the contradiction is counted.
#[test]
#[cfg(debug_assertions)]
fn accepted_points_contradict_the_mutations() -> Result<(), Error> {
    let (mut hull, [a, b, c]) = hull()?;
    // A point at the best bound of every column would be the answer without a search.
    hull.set_bounds(hull.variable_by_name("t")?, 0.0, 1.5)?;
    let start = &MipStart::new().with_values([(a, 0.0), (b, 0.0), (c, 1.0)]);
    for (mutation, model, start, value) in [
        (Mutation::ExcludedCase, hull, Some(start), 1.0),
        (Mutation::OpenSquare, open_square()?, None, 16.0),
    ] {
        let (solution, log) =
            with_mutation(mutation, || solved(&model, start, &format!("{mutation:?}")));
        assert_eq!(solution.statistics().contradictions, 1, "{mutation:?}");
        assert!(solution.is_optimal() && is_near(&solution, value), "{mutation:?}");
        assert!(check(log.as_bytes()).is_ok(), "{mutation:?}");
    }
    Ok(())
}
