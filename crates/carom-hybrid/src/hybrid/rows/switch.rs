//! Which rows a choice needs at a step, and when they hold.
//!
//! A row of one transition (a guard, or half of "the change is the one of this transition") that
//! holds in every transition is stated without a condition. Rows that others imply are left out.
//! So the reflecting wall gets the rows that one would write by hand.
//!
//! Half-spaces that are limits are never left out because of others and never used to leave others
//! out, so that an explanation can drop them.

use super::bound::{size, upper_bound};
use super::change::{Changes, ratio};
use super::largest;
use crate::hybrid::step::{AffineForm, Dynamics};
use crate::interval::Interval;

/// How much a row that holds everywhere may be violated by rounding, relative to its terms (no
/// unit). It is loosened by as much.
const ROUNDING: f64 = 1e-12;

/// The largest sum of multipliers with which a row is left out, because the violations of the rows
/// that imply it grow by as much (no unit).
const WEIGHT: f64 = 2.0;

/// Where a transition is possible, as far as is known.
#[derive(Debug, Clone)]
pub(super) struct Region {
    /// Ranges of the states and the inputs.
    pub(super) domain: Vec<Interval>,
    /// Forms that are at most 0.
    pub(super) rows: Vec<AffineForm>,
}

impl Region {
    /// The region of a transition at a step; the box alone if nothing is left of it.
    ///
    /// # Arguments
    ///
    /// * `domains`: of the states.
    /// * `known`: what holds at the start of the step, besides half-spaces of the transition.
    /// * `alone`: whether the choice decides on the next state alone.
    pub(super) fn new(
        dynamics: &Dynamics,
        domains: &[Interval],
        known: &[AffineForm],
        alone: bool,
    ) -> Self {
        let domain = [domains, &dynamics.inputs].concat();
        let mut rows = known.to_vec();
        let guards = dynamics.guards.iter().filter(|guard| !guard.is_limit);
        rows.extend(guards.map(|guard| guard.map.clone()));
        if alone {
            for (next, range) in dynamics.next.iter().zip(domains) {
                rows.push(next.above(range.upper));
                rows.push(next.scaled(-1.0).above(-range.lower));
            }
        }
        let (nothing, none) = (vec![0.0; domain.len()], f64::NEG_INFINITY);
        if upper_bound(&nothing, 0.0, &domain, &rows, none).value == none {
            rows.clear();
        }
        Region { domain, rows }
    }
}

/// The coefficient and the limit with which a variable of this range satisfies no row.
pub(super) fn infeasible_row(range: Interval) -> (f64, f64) {
    (1.0, range.lower - 1.0)
}

/// The meaning of a row.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Label {
    /// A group's variable is at most (or at least) the transition's change.
    Change { group: usize, upper: bool },
    /// The transition's guard, by its number.
    Guard { number: usize, is_limit: bool },
    /// One end of the transition's range of an input.
    Range { input: usize, upper: bool },
}

/// A row `state . z + changes . w <= limit`, in states and inputs z and variables w.
#[derive(Debug, Clone)]
pub(super) struct SwitchRow {
    pub(super) label: Label,
    pub(super) z: Vec<f64>,
    pub(super) w: Vec<f64>,
    pub(super) limit: f64,
}

impl SwitchRow {
    /// It as a form in z and w that is at most 0.
    pub(super) fn form(&self) -> AffineForm {
        AffineForm { factors: [&self.z[..], &self.w].concat(), constant: -self.limit }
    }
}

/// A row of one transition that is stated in all of them.
#[derive(Debug, Clone)]
pub(super) struct SupportRow {
    /// The transition of the row.
    pub(super) from: usize,
    pub(super) row: SwitchRow,
    /// The largest value of the left side in each transition.
    pub(super) most: Vec<f64>,
}

/// The rows of a choice at a step.
#[derive(Debug, Clone)]
pub(super) struct Switch {
    /// The bounds of the groups' variables.
    pub(super) bounds: Vec<Interval>,
    /// Their ranges in each transition, by group.
    pub(super) spans: Vec<Vec<Interval>>,
    /// Rows that hold in every transition, with the transition from which they come.
    pub(super) common: Vec<(usize, SwitchRow)>,
    /// Rows with the largest value of their left side in each transition.
    pub(super) supports: Vec<SupportRow>,
    /// The other rows of each transition.
    pub(super) own: Vec<Vec<SwitchRow>>,
}

/// The facts about the transitions of a choice at a step.
pub(super) struct Analysis<'a> {
    pub(super) regions: &'a [Region],
    /// The values of the groups' variables, by group and transition.
    pub(super) changes: Vec<Vec<AffineForm>>,
    /// The same as the rows state them: only their range, where that is a point.
    stated: Vec<Vec<AffineForm>>,
    /// Ranges of states and inputs in any transition, and then of the groups' variables.
    pub(super) domain: Vec<Interval>,
    /// Forms in these variables that are at most 0 in any transition.
    known: Vec<AffineForm>,
    width: usize,
    /// Whether the choice decides on the next state alone.
    pub(super) alone: bool,
}

/// The facts about a step in every transition of a choice.
pub(super) struct Setting<'a> {
    /// The ranges of the states and of the inputs.
    pub(super) ranges: &'a [Interval],
    /// Forms that are at most 0 at the start of the step.
    pub(super) known: &'a [AffineForm],
    /// Whether the choice decides on the next state alone.
    pub(super) alone: bool,
}

/// The rows of a choice at a step, and what is known of it.
pub(super) fn switch<'a>(
    step: &[Dynamics],
    changes: &Changes,
    regions: &'a [Region],
    setting: &Setting<'_>,
) -> (Switch, Analysis<'a>) {
    let Setting { ranges, known, .. } = *setting;
    let groups = changes.groups.len();
    let maps: Vec<Vec<AffineForm>> = (0..groups).map(|g| changes.group(step, g)).collect();
    let of = |maps: &Vec<AffineForm>| -> Vec<Interval> {
        let each = maps.iter().zip(regions);
        let range = |(map, region): (&AffineForm, &Region)| {
            largest::range(map, &region.domain, &region.rows)
        };
        each.map(range).collect()
    };
    let spans: Vec<Vec<Interval>> = maps.iter().map(of).collect();
    let hull = |spans: &Vec<Interval>| spans.iter().copied().reduce(|a, b| a.hull(b));
    let bounds = spans.iter().map(|spans| hull(spans).unwrap_or(Interval::point(0.0)));
    let bounds: Vec<Interval> = bounds.collect();
    let wide = |row: &AffineForm| {
        let mut row = row.clone();
        row.factors.resize(ranges.len() + groups, 0.0);
        row
    };
    // More than two transitions state the ranges of changes for all at once. A change of one value
    // is not stated besides, so that guards and ranges from which the value follows must not follow
    // from it.
    let is_range = |span: &Interval| regions.len() > 2 && span.width() == 0.0;
    let stated = maps.iter().zip(&spans).map(|(maps, spans)| {
        let each = maps.iter().zip(spans);
        let map = |(map, span): (&AffineForm, &Interval)| match is_range(span) {
            true => AffineForm::constant(map.factors.len(), span.lower),
            false => map.clone(),
        };
        each.map(map).collect()
    });
    let mut analysis = Analysis {
        regions,
        stated: stated.collect(),
        changes: maps,
        domain: [ranges, &bounds].concat(),
        known: known.iter().map(wide).collect(),
        width: ranges.len(),
        alone: setting.alone,
    };
    let mut rows: Vec<Vec<SwitchRow>> =
        step.iter().enumerate().map(|(j, own)| analysis.rows(j, own, ranges)).collect();
    let mut common = Vec::new();
    for (j, rows) in rows.iter_mut().enumerate() {
        rows.retain(|row| {
            let found = analysis.everywhere(j, row);
            if let Some(row) = &found {
                analysis.state(j, row.clone(), &mut common);
            }
            found.is_none()
        });
    }
    for (j, rows) in rows.iter_mut().enumerate() {
        let given = analysis.given(j);
        rows.retain(|row| !analysis.is_implied(row, &given));
    }
    (Switch { bounds, spans, common, supports: Vec::new(), own: rows }, analysis)
}

impl Analysis<'_> {
    /// Whether a change has one value in a transition, and its span states that.
    pub(super) fn is_span(&self, group: usize, transition: usize) -> bool {
        self.regions.len() > 2 && self.stated[group][transition].is_constant()
    }

    /// Everything that a transition demands.
    fn rows(&self, transition: usize, own: &Dynamics, ranges: &[Interval]) -> Vec<SwitchRow> {
        let groups = self.changes.len();
        let mut rows = Vec::new();
        for (group, maps) in self.changes.iter().enumerate() {
            for (upper, sign) in [(false, -1.0), (true, 1.0)] {
                let map = maps[transition].scaled(-sign);
                let mut w = vec![0.0; groups];
                w[group] = sign;
                let label = Label::Change { group, upper };
                rows.push(SwitchRow { label, z: map.factors, w, limit: -map.constant });
            }
        }
        let none = || vec![0.0; groups];
        for guard in &own.guards {
            let (mut z, mut limit) = (guard.map.factors.clone(), -guard.map.constant);
            if guard.map.is_constant() {
                if guard.map.constant <= 0.0 {
                    continue;
                }
                // A row needs a variable.
                (z[0], limit) = infeasible_row(ranges[0]);
            }
            let label = Label::Guard { number: guard.number, is_limit: guard.is_limit };
            rows.push(SwitchRow { label, z, w: none(), limit });
        }
        let states = own.next.len();
        for (input, (range, all)) in own.inputs.iter().zip(&ranges[states..]).enumerate() {
            let ends = [(1.0, range.upper, all.upper), (-1.0, -range.lower, -all.lower)];
            for (sign, limit, _) in ends.into_iter().filter(|(_, limit, all)| limit < all) {
                let mut z = vec![0.0; self.width];
                z[states + input] = sign;
                let label = Label::Range { input, upper: sign > 0.0 };
                rows.push(SwitchRow { label, z, w: none(), limit });
            }
        }
        rows
    }

    /// A row in states and inputs alone, where the changes are those of a transition; and the sum
    /// of the magnitudes of its terms.
    pub(super) fn within(
        &self,
        changes: &[Vec<AffineForm>],
        transition: usize,
        row: &SwitchRow,
    ) -> (AffineForm, f64) {
        let mut map = AffineForm { factors: row.z.clone(), constant: -row.limit };
        let domain = &self.regions[transition].domain;
        let size = |map: &AffineForm| -> f64 {
            let terms = map.factors.iter().zip(domain);
            terms.map(|(a, range)| (a * range.magnitude()).abs()).sum::<f64>() + map.constant.abs()
        };
        let mut magnitude = size(&map);
        for (w, maps) in row.w.iter().zip(changes).filter(|(w, _)| **w != 0.0) {
            map.add(*w, &maps[transition]);
            magnitude += size(&maps[transition]) * w.abs();
        }
        (map, magnitude)
    }

    /// The form of a transition's row that holds in every transition, if there is one. A guard that
    /// a group's variable expresses is stated by it.
    fn everywhere(&self, transition: usize, row: &SwitchRow) -> Option<SwitchRow> {
        let holds = |row: &SwitchRow| -> Option<SwitchRow> {
            let mut loose = row.clone();
            for (other, region) in self.regions.iter().enumerate() {
                if other == transition {
                    continue;
                }
                let (map, magnitude) = self.within(&self.changes, other, row);
                let allowed = ROUNDING * magnitude;
                let Region { domain, rows } = region;
                let miss = upper_bound(&map.factors, map.constant, domain, rows, allowed).value;
                if miss > allowed {
                    return None;
                }
                loose.limit = loose.limit.max(row.limit + miss.max(0.0));
            }
            Some(loose)
        };
        holds(row).or_else(|| {
            let is_plain = row.w.iter().all(|&w| w == 0.0);
            let forms = (0..self.changes.len()).filter(|_| is_plain);
            forms.filter_map(|group| self.by_change(transition, row, group)).find_map(|r| holds(&r))
        })
    }

    /// A guard whose normal is a multiple of a group's change, as a row in that group's variable.
    fn by_change(&self, transition: usize, row: &SwitchRow, group: usize) -> Option<SwitchRow> {
        let change = &self.stated[group][transition];
        let ratio = ratio(&row.z, &change.factors)?;
        // A large ratio would enlarge the error of the variable.
        (ratio.abs() <= WEIGHT).then(|| {
            let mut w = row.w.clone();
            w[group] = ratio;
            let z = vec![0.0; row.z.len()];
            SwitchRow { label: row.label, z, w, limit: row.limit + ratio * change.constant }
        })
    }

    /// Keeps a row that holds everywhere, unless what is known implies it.
    fn state(&mut self, from: usize, row: SwitchRow, common: &mut Vec<(usize, SwitchRow)>) {
        let form = row.form();
        let allowed = ROUNDING * (row.limit.abs() + size(&form.factors, &self.domain));
        let found = upper_bound(&form.factors, form.constant, &self.domain, &self.known, allowed);
        if found.value <= allowed && found.weight <= WEIGHT {
            return;
        }
        if !is_limit(row.label) {
            self.known.push(form);
        }
        common.push((from, row));
    }

    /// The rows that hold in a transition besides its own, in states and inputs alone: the rows
    /// that hold everywhere, and the bounds of the changes.
    fn given(&self, transition: usize) -> Vec<AffineForm> {
        let split = |row: &AffineForm| {
            let (z, w) = row.factors.split_at(self.width);
            let label = Label::Change { group: 0, upper: true };
            let row = SwitchRow { label, z: z.to_vec(), w: w.to_vec(), limit: -row.constant };
            self.within(&self.stated, transition, &row).0
        };
        let bounds =
            self.stated.iter().zip(&self.domain[self.width..]).flat_map(|(maps, range)| {
                let map = &maps[transition];
                [map.above(range.upper), map.scaled(-1.0).above(-range.lower)]
            });
        let rows = self.known.iter().map(split).chain(bounds);
        rows.filter(|row| row.factors.iter().any(|&a| a != 0.0)).collect()
    }

    /// Whether a transition's guard or range follows from what holds anyway.
    fn is_implied(&self, row: &SwitchRow, given: &[AffineForm]) -> bool {
        if let Label::Change { .. } | Label::Guard { is_limit: true, .. } = row.label {
            return false;
        }
        let domain = &self.domain[..self.width];
        let allowed = ROUNDING * (row.limit.abs() + size(&row.z, domain));
        let found = upper_bound(&row.z, -row.limit, domain, given, allowed);
        found.value <= allowed && found.weight <= WEIGHT
    }
}

fn is_limit(label: Label) -> bool {
    matches!(label, Label::Guard { is_limit: true, .. })
}
