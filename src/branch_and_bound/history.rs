//! What a prepared model keeps of its last solve: the integers of the best point.
//!
//! They are a start for the next solve, fixed, completed and verified like any other, so they may be
//! moved in time by nothing more than the names of variables.

use std::collections::BTreeMap;

use crate::model::{Model, Name};
use crate::search::{Found, Seed};

/// What is kept of the last solve of a prepared model.
#[derive(Debug, Default)]
pub(super) struct History {
    /// Values of integral variables, by number, the earliest steps first.
    guess: Vec<(usize, f64)>,
    /// By variable: the same of the next step.
    next: BTreeMap<usize, usize>,
}

impl History {
    /// For a model.
    pub(super) fn new(model: &Model) -> Self {
        let integers = model.variables().enumerate().filter(|(_, v)| v.kind().is_integral());
        let named: Vec<(usize, &Name)> = integers.map(|(j, v)| (j, v.name())).collect();
        let place =
            |(j, name): &(usize, &'_ Name)| Some(((name.family().to_owned(), name.step()?), *j));
        let places: BTreeMap<(String, usize), usize> = named.iter().filter_map(place).collect();
        let next = |(j, name): &(usize, &Name)| {
            let next = places.get(&(name.family().to_owned(), name.step()? + 1))?;
            Some((*j, *next))
        };
        History { next: named.iter().filter_map(next).collect(), ..History::default() }
    }

    /// The start that the last point proposes, if there is one.
    pub(super) fn seed(&self) -> Option<Seed> {
        let guess = self.guess.clone();
        (!guess.is_empty()).then(|| Seed { guess, ..Seed::default() })
    }

    /// Takes in the result of a solve; its first point has one value a variable.
    pub(super) fn take_in(&mut self, model: &Model, found: &Found) {
        self.guess.clear();
        // A program in blocks is searched block by block, which a start would prevent.
        let Some(point) = found.points.first().filter(|_| found.statistics.blocks == 0) else {
            return;
        };
        let mut integers: Vec<(Option<usize>, usize, f64)> = model
            .variables()
            .enumerate()
            .zip(point)
            .filter(|((_, variable), _)| variable.kind().is_integral())
            .map(|((j, variable), value)| (variable.name().step(), j, value.round()))
            .collect();
        integers.sort_by_key(|&(step, j, _)| (step, j));
        self.guess = integers.into_iter().map(|(_, j, value)| (j, value)).collect();
    }

    /// Moves everything one step ahead; the last step is kept for what comes behind it.
    pub(super) fn shift(&mut self) {
        let values: BTreeMap<usize, f64> = self.guess.iter().copied().collect();
        for (j, value) in &mut self.guess {
            let next = self.next.get(j).and_then(|next| values.get(next));
            *value = next.copied().unwrap_or(*value);
        }
    }
}
