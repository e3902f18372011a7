//! Rows whose big-Ms are as small as the bounds of a context allow.
//!
//! A row `a x + m z <= u` that has room at one value of the binary `z` is tightened there. The log
//! states the tightened row as a lemma: at each value of its binaries it follows from the row that
//! it was, or from the bounds alone.

use super::aggregated_row::AggregatedRow;
use super::bounds::Side;
use super::facts::Facts;
use crate::presolve::Reduced;

/// Most binaries of a row whose coefficients are changed at once.
const MOST_BINARIES: usize = 8;

/// By how much a lemma is looser than what it was found as, relative to its terms (no unit): what
/// contradicts it must do so by more than nothing.
pub(super) const LOOSENING: f64 = 1e-11;

/// The rows of a program before they are tightened.
#[derive(Debug, Clone, Default)]
pub(super) struct RowsBefore {
    value: Vec<f64>,
    lower: Vec<f64>,
    upper: Vec<f64>,
}

impl RowsBefore {
    pub(super) fn of(reduced: &Reduced) -> Self {
        let (lower, upper) = (reduced.row_lower.clone(), reduced.row_upper.clone());
        RowsBefore { value: reduced.rows.value.clone(), lower, upper }
    }

    /// The row of a tightened program if it has changed.
    ///
    /// # Arguments
    ///
    /// * `sources`: the facts behind the row, each with the row as a multiple of it.
    pub(super) fn changed(
        &self,
        reduced: &Reduced,
        row: usize,
        sources: Vec<(usize, f64)>,
    ) -> Option<TightRowLemma> {
        let range = reduced.rows.start[row]..reduced.rows.start[row + 1];
        let limits = [reduced.row_lower[row], reduced.row_upper[row]];
        let is_same = self.value[range.clone()] == reduced.rows.value[range.clone()]
            && [self.lower[row], self.upper[row]] == limits;
        if is_same {
            return None;
        }
        let mut binaries = Vec::new();
        let mut terms = Vec::new();
        for k in range {
            let (column, value) = (reduced.columns[reduced.rows.index[k]], reduced.rows.value[k]);
            if value != self.value[k] {
                binaries.push(column);
            }
            terms.push((column, value));
        }
        let is_upper = limits[1].is_finite();
        let limit = limits[usize::from(is_upper)];
        Some(TightRowLemma { terms, is_upper, limit, binaries, sources, steps: Vec::new() })
    }
}

/// A tightened row, and its proof.
#[derive(Debug, Clone)]
pub(super) struct TightRowLemma {
    pub(super) terms: Vec<(usize, f64)>,
    pub(super) is_upper: bool,
    pub(super) limit: f64,
    binaries: Vec<usize>,
    sources: Vec<(usize, f64)>,
    pub(super) steps: Vec<TightStep>,
}

/// A step of the proof of a tightened row.
#[derive(Debug, Clone)]
pub(super) enum TightStep {
    /// A binary is 0, and then 1.
    Split(usize),
    /// The negation, times the number, and a fact contradict the bounds.
    Close(f64, Option<(usize, f64)>),
}

impl TightRowLemma {
    /// Finds the proof. Returns the sides that it needs; `None` if there is none.
    ///
    /// # Arguments
    ///
    /// * `bounds`: the bounds of the context.
    pub(super) fn prove(
        &mut self,
        facts: &Facts,
        bounds: &dyn Fn(usize) -> [f64; 2],
        sum: &mut AggregatedRow,
        columns: usize,
    ) -> Option<Vec<Side>> {
        if self.binaries.len() > MOST_BINARIES {
            return None;
        }
        let reach = |&(j, a): &(usize, f64)| {
            let [lower, upper] = bounds(j);
            a.abs() * lower.abs().max(upper.abs())
        };
        let size: f64 = self.terms.iter().map(reach).filter(|size| size.is_finite()).sum();
        let spare = LOOSENING * (size + self.limit.abs());
        self.limit += if self.is_upper { spare } else { -spare };
        let mut sides = Vec::new();
        let mut values = Vec::new();
        self.cases(facts, bounds, &mut values, (sum, columns), &mut sides).then_some(sides)
    }

    fn cases(
        &mut self,
        facts: &Facts,
        bounds: &dyn Fn(usize) -> [f64; 2],
        values: &mut Vec<(usize, f64)>,
        (sum, columns): (&mut AggregatedRow, usize),
        sides: &mut Vec<Side>,
    ) -> bool {
        let within = |j: usize| match values.iter().find(|(column, _)| *column == j) {
            Some(&(_, value)) => [value, value],
            None => bounds(j),
        };
        // The negation of an upper row is a lower one, and is used with a positive multiplier.
        let sign = if self.is_upper { 1.0 } else { -1.0 };
        let others = self.sources.iter().map(|&source| Some(source));
        for source in std::iter::once(None).chain(others) {
            sum.clear(columns);
            sum.add_to_limit(sign, self.limit);
            self.terms.iter().for_each(|&(j, a)| sum.add(j, sign, a));
            let mut used = None;
            if let Some((fact, ratio)) = source {
                let y = -sign / ratio;
                let [lower, upper] = facts.limits(fact);
                let limit = if y > 0.0 { lower } else { upper };
                if limit.is_infinite() {
                    continue;
                }
                sum.add_to_limit(y, limit);
                facts.terms(fact).for_each(|(j, a)| sum.add(j, a, y));
                used = Some((fact, y));
            }
            if let Some(needed) = sum.contradiction(&within) {
                let is_own = |side: &Side| values.iter().any(|(column, _)| *column == side.0);
                sides.extend(needed.into_iter().filter(|side| !is_own(side)));
                self.steps.push(TightStep::Close(sign, used));
                return true;
            }
        }
        let Some(&binary) = self.binaries.get(values.len()) else { return false };
        self.steps.push(TightStep::Split(binary));
        // A column may be binary by the bounds of the context only, which the log must have.
        sides.extend([(binary, false), (binary, true)]);
        for value in [0.0, 1.0] {
            values.push((binary, value));
            let is_closed = self.cases(facts, bounds, values, (sum, columns), sides);
            values.pop();
            if !is_closed {
                return false;
            }
        }
        true
    }
}
