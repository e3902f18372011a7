//! Proofs that solves write, judged by a checker that shares no code with the crate.

mod blocks;
mod bounded_cones;
mod compared;
mod cuts;
mod damaged;
mod declarations;
mod facets;
mod functions;
mod lemmas;
mod open_integers;
mod past_mutations;
mod switched;
mod texts;
mod unwritable;
mod ways_of_solving;

use std::fs;
use std::path::PathBuf;

use carom::model::Model;
use carom::prelude::*;
use carom_proof::{Claim, check};
use carom_solver::internals::proof::write_proof_of;

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

/// Random programs with exact answers: each complete log is accepted and true, each other one is
/// rejected, and hardly any is incomplete.
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

/// A program with an integer that rounding decides about, one with a quadratic cost without bounds,
/// one with a cone, one without a point, one that is maximised.
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

/// A linear program whose multipliers cancel exactly where a column has no bound, although those of
/// its relaxation leave rounding there.
#[test]
fn sums_without_bounds_cancel_exactly() -> Result<(), Error> {
    let mut model = Model::new("without bounds");
    let x: Vec<Variable> = (1..8)
        .map(|k| match k {
            3 => model.continuous("x[3]", 1.0, 2.0),
            k => model.continuous(format!("x[{k}]"), 0.0, f64::INFINITY),
        })
        .collect::<Result<_, _>>()?;
    model.add("r1", (x[4] * 1.0).ge(1.0))?;
    model.add("r2", (x[4] * 1.0).le(3.0))?;
    model.add("r3", (x[2] * 2.0 + x[6]).within(4.0, 10.0))?;
    model.add("r4", (x[0] + x[1] * 2.0 - x[2] * 2.0 - x[3] * 2.0 + x[5]).ge(1.5))?;
    model.add("r5", (-x[2] - x[3]).le(1.0))?;
    model.add("r6", (x[0] + x[5]).equals(1.0))?;
    model.add("r7", (x[1] - x[2] + x[3]).ge(1.0))?;
    model.minimize(x[0] + x[1] - x[3] + x[4] + x[5] * 3.0 - x[6])?;
    let solution = is_proved(&model, "without bounds");
    assert!((solution.objective().unwrap_or(0.0) + 4.75).abs() < 1e-6);
    Ok(())
}

/// Linear programs over columns without upper bounds, most of which have no point: each log is
/// complete, although the multipliers of a relaxation are rounded and no bound makes up for a
/// coefficient of the wrong sign.
#[test]
fn signs_that_rounding_has_turned_are_turned_back() -> Result<(), Error> {
    let mut state = 7_u64;
    let mut number = |most: u64| {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((state >> 33) % most) as f64
    };
    let mut refuted = 0;
    for case in 0..250 {
        let (columns, rows) = (4 + number(11) as usize, 3 + number(10) as usize);
        let mut model = Model::new("columns without upper bounds");
        let x = model.continuous_family("x", columns, 0.0, f64::INFINITY)?;
        let place: Vec<f64> = x.iter().map(|_| 0.01 * number(500)).collect();
        let mut sums = vec![0.0; columns];
        for row in 0..rows {
            let weight = 0.2 + 0.001 * number(1800);
            let (mut form, mut at) = (Affine::from(0.0), 0.0);
            for j in 0..columns {
                if j == row % columns || number(5) < 3.0 {
                    let a = 0.01 * number(1200) - 2.995;
                    form += a * x[j];
                    at += a * place[j];
                    sums[j] += weight * a;
                }
            }
            let room = 0.01 * number(200);
            let row = ("row", row);
            match number(2) < 1.0 {
                true => model.add(row, form.ge(at - room))?,
                false => model.add(row, form.le(at + room))?,
            };
        }
        let sum: Affine = x.iter().zip(&sums).map(|(x, a)| (1e3 * a).round() / 1e3 * x).sum();
        model.add("sum", sum.le(-0.5 - 0.01 * number(450)))?;
        model.minimize(x.iter().map(|x| (0.1 + 0.01 * number(390)) * x).sum::<Affine>())?;
        refuted += u32::from(is_proved(&model, &format!("unbounded_{case}")).is_infeasible());
    }
    assert!(refuted > 100, "{refuted}");
    Ok(())
}

/// A temporal formula in which a few binaries decide about many continuous truth values: always
/// beside a box, and at some time in one of two others. The search splits truth values, and the
/// proof the binaries behind them, so that it is not larger than the tree by much.
#[test]
fn truth_values_are_split_by_the_binaries_behind_them() -> Result<(), Error> {
    for (k, goals) in [[(8, 5), (5, 0)], [(5, -6), (5, 3)], [(6, 1), (5, 4)]].iter().enumerate() {
        let model = Formula::of(goals, 13);
        let solution = is_proved(&model, &format!("formula_{k}"));
        let commands = solution.proof().map_or(0, |proof| proof.commands);
        assert!(commands < 2000, "{k}: {commands} commands");
    }
    Ok(())
}

/// The text of a program of a temporal formula.
#[derive(Default)]
struct Formula {
    rows: Vec<String>,
    truths: Vec<String>,
    bits: Vec<String>,
}

impl Formula {
    /// A point that moves by at most 3 a step, and comes into a unit square at the corner of one of
    /// `goals`, around a square.
    fn of(goals: &[(i32, i32)], steps: usize) -> Model {
        let mut formula = Formula::default();
        let top = formula.truth();
        let mut either = Vec::new();
        for &(x, y) in goals {
            let goal = formula.truth();
            let mut times = Vec::new();
            for t in 3..=steps {
                let time = formula.truth();
                formula.all_hold(
                    &time,
                    [
                        (format!("x{t}"), x),
                        (format!("- x{t}"), -x - 1),
                        (format!("y{t}"), y),
                        (format!("- y{t}"), -y - 1),
                    ],
                );
                times.push(time);
            }
            formula.one_holds(&goal, &times);
            either.push(goal);
        }
        formula.one_holds(&top, &either);
        formula.rows.push(format!("{top} = 1"));
        for t in 1..=steps {
            let around = formula.truth();
            let sides = [("x", 4), ("- x", -2), ("y", 2), ("- y", 2)].map(|(side, from)| {
                let beside = formula.truth();
                formula.all_hold(&beside, [(format!("{side}{t}"), from)]);
                beside
            });
            formula.rows.push(format!("{around} = 1"));
            formula.one_holds(&around, &sides);
        }
        formula.model(steps)
    }

    fn truth(&mut self) -> String {
        let name = format!("z{}", self.truths.len());
        self.truths.push(name.clone());
        name
    }

    /// A truth value for which terms are at least some numbers.
    fn all_hold(&mut self, truth: &str, least: impl IntoIterator<Item = (String, i32)>) {
        for (terms, least) in least {
            let own = self.truth();
            self.rows.push(format!("{terms} - 1000 {own} >= {}", least - 1000));
            self.rows.push(format!("{truth} - {own} <= 0"));
        }
    }

    /// A truth value of which one part holds if it does; binaries are the code of the part, 0 for
    /// none.
    fn one_holds(&mut self, truth: &str, parts: &[String]) {
        self.rows.push(format!("{} - {truth} = 0", parts.join(" + ")));
        let bits = usize::BITS - parts.len().leading_zeros();
        for bit in 0..bits {
            let name = format!("b{}", self.bits.len());
            let (one, zero): (Vec<_>, Vec<_>) =
                parts.iter().cloned().enumerate().partition(|(k, _)| ((k + 1) >> bit) & 1 == 1);
            let sum = |of: Vec<(usize, String)>| {
                of.into_iter().map(|(_, part)| format!(" + {part}")).collect::<String>()
            };
            self.rows.push(format!("- {name}{} <= 0", sum(one)));
            self.rows.push(format!("{name}{} - {truth} <= 0", sum(zero)));
            self.bits.push(name);
        }
    }

    fn model(mut self, steps: usize) -> Model {
        let (mut costs, mut bounds) = (Vec::new(), Vec::new());
        for axis in ["x", "y"] {
            self.rows.push(format!("{axis}0 = 0"));
            bounds.extend((0..=steps).map(|t| format!("-10 <= {axis}{t} <= 10")));
            for t in 0..steps {
                let next = t + 1;
                self.rows.push(format!("{axis}{next} - {axis}{t} - u{axis}{t} = 0"));
                self.rows.push(format!("u{axis}{t} - a{axis}{t} <= 0"));
                self.rows.push(format!("- u{axis}{t} - a{axis}{t} <= 0"));
                bounds.push(format!("-3 <= u{axis}{t} <= 3"));
                bounds.push(format!("0 <= a{axis}{t} <= 3"));
                costs.push(format!("a{axis}{t}"));
            }
        }
        bounds.extend(self.truths.iter().map(|truth| format!("0 <= {truth} <= 1")));
        let (costs, rows) = (costs.join(" + "), self.rows.join("\n"));
        let (bounds, bits) = (bounds.join("\n"), self.bits.join(" "));
        let text =
            format!("min\n{costs}\nsubject to\n{rows}\nbounds\n{bounds}\nbinaries\n{bits}\nend\n");
        carom::model::lp::read(&text).expect("a program").model
    }
}

/// A claim that is a little too good has no proof: the log ends, and the checker rejects a step of
/// it.
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
