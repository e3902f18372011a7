//! Rows with the largest value of their left side in each transition.
//!
//! A row `d'(z, w) <= b` of one transition is stated as `d'(z, w) <= Σ h_i t_i`: h_i is the support
//! function of transition i's own polytope in the direction d, and t_i its binary. Exactly one of
//! these is on, and where it is that of the row, `h_i <= b`. So there is a big-M for each of the
//! other transitions (Trespalacios and Grossmann, Improved Big-M reformulation for generalized
//! disjunctive programs, Computers & Chemical Engineering 76, 2015), and rows of several
//! transitions in one direction are one row.
//!
//! Guards that are limits stay statements with conditions, because an explanation may drop each of
//! them. So does a row for which a single M is as tight: presolve reads conditions.

use super::change::{Changes, Part, RATIO, ratio};
use super::largest::largest;
use super::switch::{Analysis, Label, Region, SupportRow, Switch, SwitchRow};
use crate::hybrid::step::{AffineForm, Dynamics};
use crate::interval::Interval;
use crate::tolerance;

/// A row is stated by its support function if that lowers one M to this share or less (no unit). Of
/// two transitions, presolve tightens the single M, too.
const SHARES: [f64; 2] = [0.5, 0.95];

/// The rounding of an M from ranges, relative to it (no unit).
const ROUNDING: f64 = 1e-12;

/// Takes the rows that are stated by support functions out of those of the transitions.
pub(super) fn state_by_support(
    switch: &mut Switch,
    analysis: &Analysis<'_>,
    step: &[Dynamics],
    changes: &Changes,
) {
    let found = &mut switch.supports;
    let share = SHARES[usize::from(step.len() > 2)];
    for (j, rows) in switch.own.iter_mut().enumerate() {
        rows.retain(|row| {
            let is_stated_here = match row.label {
                // Spans state a change of one value.
                Label::Change { group, .. } => !analysis.is_span(group, j),
                Label::Guard { is_limit, .. } => !is_limit,
                Label::Range { .. } => true,
            };
            if !is_stated_here {
                return true;
            }
            if let Some(known) = found.iter().find_map(|known| known.takes(row, j)) {
                return !known;
            }
            let big_m = big_m(analysis, &step[j], changes, row);
            let most = in_each(analysis, j, row, row.limit + big_m);
            let is_tighter = |h: &f64| h - row.limit <= share * big_m;
            let mut others = most.iter().enumerate().filter(|(i, _)| *i != j).map(|(_, h)| h);
            let is_bounded = most.iter().all(|h| *h < tolerance::INFINITE);
            let is_stated = is_bounded && others.any(is_tighter);
            if is_stated {
                found.push(SupportRow { from: j, row: row.clone(), most });
            }
            !is_stated
        });
    }
}

fn is_range(row: &SwitchRow) -> bool {
    matches!(row.label, Label::Range { .. })
}

impl SupportRow {
    /// Whether it states a row of a transition as well; `None` if it is about something else.
    fn takes(&self, row: &SwitchRow, transition: usize) -> Option<bool> {
        if is_range(&self.row) != is_range(row) {
            return None;
        }
        let [own, other] = [&self.row, row].map(|row| row.form().factors);
        let ratio = ratio(&other, &own).filter(|ratio| *ratio > 0.0)?;
        Some(ratio * self.most[transition] <= row.limit + 1e-12 * row.limit.abs())
    }
}

/// The support function of each transition in the direction of a row of one of them; the end of a
/// range in each, because an explanation may drop a range but no guard.
///
/// # Arguments
///
/// * `limit`: no value of the left side is larger.
fn in_each(analysis: &Analysis<'_>, transition: usize, row: &SwitchRow, limit: f64) -> Vec<f64> {
    let form = SwitchRow { limit: 0.0, ..row.clone() };
    let in_one = |(i, Region { domain, rows }): (usize, &Region)| {
        let (map, _) = analysis.within(&analysis.changes, i, &form);
        let most = largest(&map, domain, if is_range(row) { &[] } else { rows });
        most.min(if i == transition { row.limit } else { limit })
    };
    analysis.regions.iter().enumerate().map(in_one).collect()
}

/// The M of a row whose condition does not hold, from ranges: by the group's variable, or by one of
/// the next states.
fn big_m(analysis: &Analysis<'_>, own: &Dynamics, changes: &Changes, row: &SwitchRow) -> f64 {
    let excess = |form: &AffineForm, domain: &[Interval]| form.over(domain).upper;
    let mut least = excess(&row.form(), &analysis.domain);
    let Label::Change { group, upper } = row.label else { return least };
    let states = analysis.domain.iter().zip(&own.next).zip(&changes.parts);
    for ((domain, next), part) in states.filter(|_| analysis.alone) {
        match *part {
            Part::Shared { group: of, ratio } if of == group && ratio.abs() >= RATIO => {
                let next = next.over(&analysis.domain);
                let above = if upper == (ratio > 0.0) {
                    domain.upper - next.lower
                } else {
                    next.upper - domain.lower
                };
                least = least.min(above / ratio.abs() * (1.0 + ROUNDING));
            }
            _ => {}
        }
    }
    least
}
