//! Modes with memory: how transitions link the modes of neighbouring samples, and dwell times.

use super::constant_rows::constant;
use super::names::Names;
use super::program::{ChoiceProgram, OneOf, SystemVariables};
use super::switch::infeasible_row;
use crate::error::Error;
use crate::hybrid::system::Choice;
use crate::interval::Interval;
use crate::model::{Affine, Model, Row};

/// The rows of a choice's modes over all steps, by family.
pub(super) fn rows(choice: &Choice, program: &ChoiceProgram, steps: usize) -> Vec<ModeRow> {
    let modes = choice.modes();
    let mut rows = Vec::new();
    let sum = |t: usize, wanted: &dyn Fn(&str, &str) -> bool| -> Affine {
        let pairs = choice.transitions.iter().map(|t| t.modes.as_ref()).enumerate();
        let taken = pairs.filter(|(_, pair)| pair.is_some_and(|(from, to)| wanted(from, to)));
        taken.map(|(j, _)| program.taken.value(j, t)).sum()
    };
    let linked = match program.modes {
        OneOf::Only => 0..0,
        // The other mode follows.
        OneOf::Pair(..) => 1..2,
        OneOf::Each(_) => 0..modes.len(),
    };
    for k in linked {
        let mode = modes[k];
        for t in 0..steps {
            let leaving = sum(t, &|from, _| from == mode).equals(program.modes.value(k, t));
            rows.push(ModeRow { kind: "leaves", mode: k, dwell: 0, step: t, row: leaving });
            let entering = sum(t, &|_, to| to == mode).equals(program.modes.value(k, t + 1));
            rows.push(ModeRow { kind: "enters", mode: k, dwell: 0, step: t, row: entering });
        }
    }
    for (dwell, limit) in choice.dwells.iter().enumerate() {
        let Some(k) = modes.iter().position(|mode| *mode == limit.mode) else { continue };
        // The entries of the samples in a window, of which sample 0 is none.
        let entries = |window: std::ops::RangeInclusive<usize>| -> Affine {
            let entry = |s: usize| sum(s - 1, &|from, to| to == limit.mode && from != limit.mode);
            window.filter(|&s| s >= 1).map(entry).sum()
        };
        for s in 1..=steps {
            let is_in = program.modes.value(k, s);
            if limit.least > 1 {
                let row = entries(s.saturating_sub(limit.least - 1)..=s).le(is_in.clone());
                rows.push(ModeRow { kind: "at_least", mode: k, dwell, step: s, row });
            }
            if let Some(most) = limit.most.filter(|&most| most <= s) {
                let row = entries(s - most + 1..=s).ge(is_in);
                rows.push(ModeRow { kind: "at_most", mode: k, dwell, step: s, row });
            }
        }
    }
    rows
}

/// A row about the modes of a choice.
pub(super) struct ModeRow {
    kind: &'static str,
    mode: usize,
    dwell: usize,
    step: usize,
    row: Row,
}

/// Adds the rows; returns their families.
pub(super) fn add(
    model: &mut Model,
    names: &mut Names,
    program: &SystemVariables,
    number: usize,
) -> Result<Vec<String>, Error> {
    let (choice, steps) = (&program.system.choices[number], program.horizon.steps());
    let modes = choice.modes();
    let mut families: Vec<(&str, usize, usize, String)> = Vec::new();
    for ModeRow { kind, mode, dwell, step, row } in rows(choice, &program.choices[number], steps) {
        // A choice with one transition may leave a row without variables.
        let row = match constant(&row) {
            None => row,
            Some(true) => continue,
            Some(false) => program.infeasible_row_at(step),
        };
        let known = families.iter().position(|(k, m, d, _)| (*k, *m, *d) == (kind, mode, dwell));
        let at = known.unwrap_or_else(|| {
            let family = names.family(&[&choice.name, kind, modes[mode]]);
            families.push((kind, mode, dwell, family));
            families.len() - 1
        });
        model.add((families[at].3.as_str(), step), row)?;
    }
    Ok(families.into_iter().map(|(.., family)| family).collect())
}

impl SystemVariables {
    /// A row that no state at a sample satisfies, for what has no variables of its own.
    pub(crate) fn infeasible_row_at(&self, sample: usize) -> Row {
        let first = self.states.first().and_then(|family| family.get(sample));
        let domain = self.system.states.first().map_or(Interval::REALS, |(_, domain)| *domain);
        let (factor, limit) = infeasible_row(domain);
        first.map_or(Affine::zero(), |variable| factor * variable).le(limit)
    }
}
