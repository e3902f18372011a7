//! Seeds and leaves: from variables of the model to columns of the program, and back.

use std::collections::BTreeMap;

use crate::model::{Model, Variable};
use crate::search::{ClosedNode, Found, GuessEnd, Seed, SeedBox};
use crate::solution::{GuessStatus, LeafBound, LeafBox, LeafReport, SeedReport};
use crate::solver::TreeSeed;

/// A seed in columns, and how many of its entries mean nothing to the model.
pub(super) fn seed_of(model: &Model, given: &TreeSeed) -> (Seed, usize) {
    let mut ignored = 0;
    let mut column = |variable: Variable, is_number: bool| {
        let known = model.variable_ref(variable).is_ok_and(|v| v.kind().is_integral());
        ignored += usize::from(!(known && is_number));
        (known && is_number).then(|| variable.index())
    };
    let guess = given.guess.iter();
    let guess = guess.filter_map(|&(v, value)| Some((column(v, value.is_finite())?, value)));
    let guess = guess.collect();
    let sign = model.sense().sign();
    let mut leaf = |leaf: &LeafBox| {
        let bounds = leaf.bounds.iter().filter_map(|bound| {
            let numbers = !bound.lower.is_nan() && !bound.upper.is_nan();
            Some((column(bound.variable, numbers)?, bound.lower, bound.upper))
        });
        SeedBox { bounds: bounds.collect(), order: sign * leaf.bound }
    };
    let leaves = given.leaves.iter().map(&mut leaf).collect();
    (Seed { guess, leaves, ..Seed::default() }, ignored)
}

/// The report on the outcome of a seed, in variables of the model; columns and points are the model's.
pub(super) fn report(model: &Model, found: &Found, seed: &Seed, ignored: usize) -> SeedReport {
    let variables: Vec<Variable> = model.variables().map(|variable| variable.id()).collect();
    let name = |column: usize| match model.variables().nth(column) {
        Some(variable) => variable.name().to_string(),
        None => format!("column {column}"),
    };
    let changed = |point: &[f64]| -> Vec<Variable> {
        let differs = |&&(j, value): &&(usize, f64)| point.get(j) != Some(&value.round());
        let columns = seed.guess.iter().filter(differs);
        columns.filter_map(|&(j, _)| variables.get(j).copied()).collect()
    };
    let guess = found.guess.as_ref().map(|end| match end {
        GuessEnd::Point(point) if changed(point).is_empty() => GuessStatus::Accepted,
        GuessEnd::Point(point) => GuessStatus::Repaired { changed: changed(point) },
        GuessEnd::Contradiction(column) => GuessStatus::Rejected {
            reason: format!(
                "the value of `{}` contradicts the model or values before it, and no point was \
                 found with the others",
                name(*column)
            ),
        },
        GuessEnd::Nothing => GuessStatus::Rejected {
            reason: "no point was found with these values of the integers, or with the first \
                     half of them"
                .to_owned(),
        },
        GuessEnd::Stopped => GuessStatus::Rejected {
            reason: "a limit was reached before the guess led to a point".to_owned(),
        },
    });
    let leaves = found.seeded.as_ref().map(|seeded| {
        let mut report = LeafReport::default();
        report.used.clone_from(&seeded.used);
        (report.inside, report.added) = (seeded.inside, seeded.outside);
        report
    });
    let mut report = SeedReport::default();
    (report.guess, report.leaves, report.ignored) = (guess, leaves, ignored);
    report
}

/// An end of the tree over the variables of the model; what it says about auxiliary columns is left
/// out, which makes it larger.
pub(super) fn leaf_of(model: &Model, closed: &ClosedNode, sign: f64) -> LeafBox {
    let variables: Vec<Variable> = model.variables().map(|variable| variable.id()).collect();
    let mut bounds: BTreeMap<usize, [f64; 2]> = BTreeMap::new();
    for &(column, is_upper, value) in &closed.decisions {
        let [lower, upper] = bounds.entry(column).or_insert([f64::NEG_INFINITY, f64::INFINITY]);
        if is_upper {
            *upper = upper.min(value);
        } else {
            *lower = lower.max(value);
        }
    }
    let bounds = bounds.into_iter().filter_map(|(column, [lower, upper])| {
        Some(LeafBound { variable: *variables.get(column)?, lower, upper })
    });
    LeafBox { bounds: bounds.collect(), bound: sign * closed.bound }
}
