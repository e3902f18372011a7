//! What a prepared model keeps from solve to solve: the integers of the best point, and what closed
//! the nodes of the tree.
//!
//! The integers are a start for the next solve: fixed, completed and verified like any other point.
//! The multipliers that closed nodes are tried before relaxations, and their bounds are proved anew.
//! Nothing is trusted, so all may be moved in time by no more than the names of variables and rows.

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::model::Name;
use crate::search::{Found, Proof, Proofs, Seed, Shift};

/// Solves for which cuts rest after they did not pay.
const REST: u32 = 15;

/// What is kept of the last solve of a prepared model; columns and rows are those of the program.
#[derive(Debug, Default)]
pub(super) struct History {
    /// Values of integral columns, the earliest steps first.
    guess: Vec<(usize, f64)>,
    proofs: Vec<Proof>,
    /// One step.
    step: Shift,
    /// By how much the next solve begins later than the last one.
    shift: Option<Shift>,
    /// Solves until cuts are tried again.
    rest: u32,
}

impl History {
    /// For a program whose columns and rows have these names.
    pub(super) fn new(columns: &[&Name], rows: &[&Name]) -> Self {
        let step = Shift { columns: next_of(columns), rows: next_of(rows) };
        History { step, ..History::default() }
    }

    /// What the last solve proposes for the next one.
    pub(super) fn seed(&mut self) -> Seed {
        let proofs = Proofs::new(std::mem::take(&mut self.proofs), self.shift.take());
        Seed { guess: self.guess.clone(), proofs: Some(Arc::new(proofs)), ..Seed::default() }
    }

    /// Whether cuts are to be tried.
    pub(super) fn tries_cuts(&self) -> bool {
        self.rest == 0
    }

    /// Takes in the result of a solve.
    ///
    /// # Arguments
    ///
    /// * `integers`: the integral columns, the earliest steps first.
    pub(super) fn take_in(&mut self, found: &mut Found, integers: &[usize]) {
        self.shift = None;
        self.proofs = std::mem::take(&mut found.proofs);
        self.rest = match found.strengthened {
            Some(true) => 0,
            Some(false) => REST,
            None => self.rest.saturating_sub(1),
        };
        self.guess.clear();
        if let Some(point) = found.points.first() {
            self.guess.extend(integers.iter().map(|&j| (j, point[j].round())));
        }
    }

    /// Moves everything one step ahead; the last step is kept for what comes behind it.
    pub(super) fn shift(&mut self) {
        let values: BTreeMap<usize, f64> = self.guess.iter().copied().collect();
        for (j, value) in &mut self.guess {
            *value = values.get(&self.step.columns[*j]).copied().unwrap_or(*value);
        }
        self.shift = Some(match &self.shift {
            Some(before) => before.then(&self.step),
            None => self.step.clone(),
        });
    }
}

/// By name, where the same name of the next step is, or the name itself if there is none.
fn next_of(names: &[&Name]) -> Vec<usize> {
    let place = |(k, name): (usize, &&Name)| Some(((name.family().to_owned(), name.step()?), k));
    let places: BTreeMap<(String, usize), usize> =
        names.iter().enumerate().filter_map(place).collect();
    let next = |name: &Name| places.get(&(name.family().to_owned(), name.step()? + 1)).copied();
    names.iter().enumerate().map(|(k, name)| next(name).unwrap_or(k)).collect()
}
