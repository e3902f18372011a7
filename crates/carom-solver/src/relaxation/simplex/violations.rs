//! The slots whose columns violate their bounds.

use super::tableau::Tableau;

/// By slot, by how much its column violates a bound, squared; and a list of those that do.
#[derive(Debug, Default)]
pub(super) struct Violations {
    square: Vec<f64>,
    is_listed: Vec<bool>,
    list: Vec<u32>,
}

/// By how much the column of a slot violates a bound: negative below the lower one, 0 if by less
/// than is allowed, relative to the bound.
pub(super) fn violation(tableau: &Tableau, slot: usize, allowed: f64) -> f64 {
    let (x, [lower, upper]) = (tableau.value[slot], tableau.bounds[slot]);
    if x < lower - allowed * lower.abs().max(1.0) {
        x - lower
    } else if x > upper + allowed * upper.abs().max(1.0) {
        x - upper
    } else {
        0.0
    }
}

impl Violations {
    /// Finds all of them.
    pub(super) fn find(&mut self, tableau: &Tableau, allowed: f64) {
        let m = tableau.head.len();
        self.square.clear();
        self.square.resize(m, 0.0);
        self.is_listed.clear();
        self.is_listed.resize(m, false);
        self.list.clear();
        (0..m).for_each(|slot| self.note(tableau, slot, allowed));
    }

    /// Notes the new value of a slot's column.
    pub(super) fn note(&mut self, tableau: &Tableau, slot: usize, allowed: f64) {
        let by = violation(tableau, slot, allowed);
        self.square[slot] = by * by;
        if by != 0.0 && !self.is_listed[slot] {
            self.is_listed[slot] = true;
            self.list.push(slot as u32);
        }
    }

    /// The slot with the largest violation, measured by the weights of its edges.
    pub(super) fn largest(&mut self, weight: &[f64]) -> Option<usize> {
        let (mut most, mut found) = (0.0, None);
        let mut at = 0;
        while at < self.list.len() {
            let slot = self.list[at] as usize;
            let square = self.square[slot];
            if square == 0.0 {
                self.is_listed[slot] = false;
                self.list.swap_remove(at);
                continue;
            }
            // Products instead of quotients.
            if square > most * weight[slot] {
                (most, found) = (square / weight[slot], Some(slot));
            }
            at += 1;
        }
        found
    }
}
