//! Proofs that solves write, judged by a checker that shares no code with the crate.

mod damaged;
mod past_slips;
mod ways_of_solving;

use std::fs;
use std::path::PathBuf;

use carom::internals::proof::write_proof_of;
use carom::model::Model;
use carom::prelude::*;
use carom_proof::{Claim, check};

use crate::torture::generator;
use crate::torture::oracle::{Truth, truth};

/// A file of its own for a test.
fn file(name: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("proofs");
    fs::create_dir_all(&folder).expect("a folder");
    folder.join(name)
}

/// Solves a model with a proof. Returns the solution, with the log.
fn solved(model: &Model, name: &str) -> (Solution, Vec<u8>) {
    let path = file(name);
    let options = Options::default().with_proof(&path);
    let solution = BranchAndBound::new(options).solve(model).expect("a solvable model");
    let log = fs::read(&path).unwrap_or_default();
    (solution, log)
}

/// Checks that the log of a solve is accepted, and claims what the solution says, up to the gap.
fn is_proved(model: &Model, name: &str) -> Solution {
    let (solution, log) = solved(model, name);
    let report = solution.proof().expect("a proof");
    assert!(report.is_complete, "{name}: {report:?}");
    assert_eq!(report.bytes, log.len() as u64);
    let proved = check(&log[..]).unwrap_or_else(|failure| panic!("{name}: {failure}"));
    let sign = model.sense().sign();
    match proved.claim {
        Claim::Infeasible => assert!(solution.is_infeasible(), "{name}"),
        Claim::Bound(bound) => {
            let own = sign * solution.bound();
            let gap = 1e-5 * own.abs().max(1.0);
            assert!((own - bound).abs() <= gap, "{name}: {bound} proved of {own}");
        }
    }
    solution
}

/// Random programs with exact answers: each complete log is accepted and true, each other one is rejected,
/// and hardly any is incomplete.
#[test]
fn logs_of_random_programs_are_accepted() {
    let (mut logs, mut incomplete) = (0, 0);
    for seed in 0..60 {
        let case = generator::program(seed);
        let (model, _) = case.build();
        let name = format!("random_{seed}");
        let (solution, log) = solved(&model, &name);
        let Some(report) = solution.proof() else { continue };
        logs += 1;
        let checked = check(&log[..]);
        assert_eq!(report.is_complete, checked.is_ok(), "{name}: {checked:?}");
        incomplete += u32::from(!report.is_complete);
        let Ok(proved) = checked else { continue };
        match (proved.claim, truth(&case)) {
            (Claim::Infeasible, Truth::Infeasible) => {}
            (Claim::Bound(bound), Truth::Least { value, .. }) => {
                assert!(bound <= value + 1e-9 * value.abs().max(1.0), "{name}: {bound}");
            }
            (claim, truth) => panic!("{name}: {claim:?} of {truth:?}"),
        }
    }
    assert!(logs > 50 && 10 * incomplete <= logs, "{incomplete} of {logs} are incomplete");
}

/// A program with an integer that rounding decides about, one with a quadratic cost without bounds, one with
/// a cone, one without a point, one that is maximised.
#[test]
fn logs_of_each_kind_of_program_are_accepted() -> Result<(), Error> {
    let mut model = Model::new("knapsack");
    let x: Vec<Variable> =
        (0..8).map(|k| model.binary(format!("x[{k}]"))).collect::<Result<_, _>>()?;
    let weights = [5.0, 7.0, 4.0, 3.0, 6.0, 5.0, 9.0, 2.0];
    let values = [8.0, 11.0, 6.0, 4.0, 9.0, 7.0, 13.0, 3.0];
    let sum = |of: &[f64]| x.iter().zip(of).map(|(x, a)| *x * *a).sum::<Affine>();
    model.add("weight", sum(&weights).le(17.0))?;
    model.maximize(sum(&values))?;
    let solution = is_proved(&model, "knapsack");
    assert!(
        (solution.objective().unwrap_or(0.0) - 26.0).abs() < 1e-6,
        "{:?}",
        solution.objective()
    );

    let mut model = Model::new("open squares");
    let (x, y) = (
        model.continuous("x", f64::NEG_INFINITY, f64::INFINITY)?,
        model.continuous("y", f64::NEG_INFINITY, f64::INFINITY)?,
    );
    let z = model.binary("z")?;
    model.add("either", z.on().implies((x + y).ge(3.0)))?;
    model.add("or", z.off().implies((x - y).ge(4.0)))?;
    model.add("x", x.le(50.0))?;
    model.add("y", y.ge(-50.0))?;
    model.add("also x", x.ge(-50.0))?;
    model.add("also y", y.le(50.0))?;
    model.minimize((x - 1.0).square() + (y + 1.0).square() + z * 0.25)?;
    assert!(is_proved(&model, "open squares").is_optimal());

    let mut model = Model::new("length");
    let (x, y) = (model.continuous("x", -3.0, 3.0)?, model.continuous("y", -3.0, 3.0)?);
    let n = model.integer("n", 0.0, 5.0)?;
    model.add("far", (x + y).ge(3.0))?;
    model.add("reach", norm([x, y]).le(n))?;
    model.minimize(n + x * 0.1)?;
    assert!(is_proved(&model, "length").is_optimal());

    let mut model = Model::new("parity");
    let (a, b) = (model.integer("a", 0.0, 9.0)?, model.integer("b", 0.0, 9.0)?);
    model.add("even", (a * 2.0 + b * 4.0).equals(7.0))?;
    let solution = is_proved(&model, "parity");
    assert!(solution.is_infeasible());
    Ok(())
}

/// A claim that is a little too good has no proof: the log ends, and the checker rejects a step of it.
#[test]
fn false_claims_have_no_proof() {
    for seed in 0..60 {
        let case = generator::program(seed);
        let (model, _) = case.build();
        // The truth is that of the minimised program.
        let claim = match truth(&case) {
            Truth::Least { value, .. } => Some(value + 1e-4 * value.abs().max(1.0)),
            _ => continue,
        };
        for claim in [claim, None] {
            let mut log = Vec::new();
            let report = write_proof_of(&model, claim, &mut log).expect("a log");
            assert!(!report.is_complete, "{seed}: {claim:?}");
            let checked = check(&log[..]);
            assert!(checked.is_err(), "{seed}: {claim:?} is accepted");
        }
    }
}
