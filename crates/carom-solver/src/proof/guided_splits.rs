//! The splits of the search as splits of a proof: about integral columns of the lowered program, or
//! about others that are whole because of these.

use super::split_places::{is_counted, place_of};
use super::tree::{FRACTIONAL, ProofWriter};
use crate::search::Decision;

/// The longest row along which an integral column is looked for, and most columns on the way to it.
const LONGEST_LINK: usize = 64;
const MOST_LINKED: usize = 64;

/// The relation of a decision to the bounds of a context.
pub(super) enum SideRelation {
    Holds,
    Fails,
    Open(Decision),
}

impl ProofWriter<'_, '_> {
    /// The relation of a decision to the bounds; `None` if it is open, and its column cannot be
    /// split there.
    pub(super) fn usable(&self, decision: Decision) -> Option<SideRelation> {
        let Decision { column, is_upper, value } = decision;
        let program = &self.relaxer.program;
        if column >= program.column_count() || !is_counted(place_of(decision)) {
            return None;
        }
        let is_integral = program.integral[column];
        let [lower, upper] = self.bounds.of(column);
        let spare = if is_integral { 0.0 } else { FRACTIONAL };
        let (holds, fails) = match is_upper {
            true => (upper <= value + spare, lower > value + spare),
            false => (lower >= value - spare, upper < value - spare),
        };
        match (holds, fails) {
            (true, _) => Some(SideRelation::Holds),
            (_, true) => Some(SideRelation::Fails),
            _ => is_integral.then_some(SideRelation::Open(decision)),
        }
    }

    /// A split of the integral column that is the nearest to a continuous one, along rows and
    /// columns between 0 and 1: such columns are whole in the search because of others.
    pub(super) fn deciding_split(&self, column: usize) -> Option<Decision> {
        let mut near = vec![column];
        let mut place = 0;
        while let Some(&from) = near.get(place).filter(|_| place < MOST_LINKED) {
            place += 1;
            for &fact in self.facts.of_column(from) {
                if self.facts.terms(fact as usize).len() > LONGEST_LINK {
                    continue;
                }
                for (j, _) in self.facts.terms(fact as usize) {
                    let [lower, upper] = self.bounds.of(j);
                    if lower == upper || lower < 0.0 || upper > 1.0 {
                        continue;
                    }
                    if self.relaxer.program.integral[j] {
                        return Some(Decision { column: j, is_upper: true, value: 0.0 });
                    }
                    if near.len() < MOST_LINKED && !near.contains(&j) {
                        near.push(j);
                    }
                }
            }
        }
        None
    }
}
