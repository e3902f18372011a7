//! Projection: removing binaries that a relaxation does not need.
//!
//! Takes two rows of a relaxation and a binary that is in no other; leaves the sum of the rows,
//! without the binary (Dantzig and Eaves, Fourier-Motzkin elimination and its dual, Journal of
//! Combinatorial Theory A 14, 1973).
//!
//! A disjunction "one of these rows must hold" has one binary per row: `z = 1` enforces its row,
//! and a covering row `z_1 + ... + z_k >= 1` requires one of them. In the relaxation, such a binary
//! only links two rows, and a Fourier-Motzkin step removes it: the two rows are added so that it
//! cancels. A disjunction of four sides loses four columns and four of its five rows, and the
//! relaxed set over the other columns stays the same.
//!
//! The way back chooses integral values if possible: a binary whose row holds at the relaxed point
//! is 1, and the others of a satisfied disjunction are 0. Only the binaries of a violated
//! disjunction stay fractional, and the closer their row is to holding, the larger they are. This
//! is what branching and heuristics need.

use super::reduced::{Reduced, refill};
use crate::activity::term_ends;

/// The excess of the largest activity over a limit up to which the limit counts as implied,
/// relative. A limit dropped in error only loosens the relaxation.
const IMPLIED_EXCESS: f64 = 1e-8;

/// The distance to a whole value, or of a row to its limit, that counts as zero (no unit).
const BINARY_TOLERANCE: f64 = 1e-6;

/// A reduced program without the binaries that only link two rows.
#[derive(Debug, Clone)]
pub struct Projection {
    /// The program without these binaries.
    pub reduced: Reduced,
    taken: Removed,
}

/// The binaries and rows that were taken out.
#[derive(Debug, Clone, Default)]
struct Removed {
    members: Vec<RemovedBinary>,
    /// The covering rows before the projection, over the columns that stay.
    covers: Vec<Inequality>,
    /// The program's rows of these, and their signs.
    cover_rows: Vec<(usize, f64)>,
    terms: Terms,
}

/// A row in the form `terms <= limit`.
#[derive(Debug, Clone, Copy, Default)]
struct Inequality {
    /// Where its terms begin and end.
    range: [usize; 2],
    limit: f64,
}

/// The terms of rows, one row after the other: column and coefficient.
#[derive(Debug, Clone, Default)]
struct Terms(Vec<(usize, f64)>);

impl Terms {
    fn of(&self, row: &Inequality) -> &[(usize, f64)] {
        &self.0[row.range[0]..row.range[1]]
    }
}

/// A binary that was taken out.
#[derive(Debug, Clone)]
struct RemovedBinary {
    /// Its column in the program.
    column: usize,
    /// Its column before the projection.
    position: usize,
    /// The row that it makes bind, without it, and its coefficient there.
    hurt: Inequality,
    coefficient: f64,
    /// Its coefficient in the covering row, of the other sign.
    help: f64,
    cover: usize,
    /// The program's row that it makes bind, and the factor from the multiplier of the sum to its
    /// own.
    hurt_row: (usize, f64),
}

impl RemovedBinary {
    /// The value that helps the covering row, and the other one.
    fn values(&self) -> (f64, f64) {
        if self.help < 0.0 { (1.0, 0.0) } else { (0.0, 1.0) }
    }
}

impl Removed {
    fn clear(&mut self) {
        self.members.clear();
        self.covers.clear();
        self.cover_rows.clear();
        self.terms.0.clear();
    }
}

impl Projection {
    /// The program's point that belongs to a point of the projected program.
    pub fn lift(&self, x: &[f64]) -> Vec<f64> {
        let mut point = self.reduced.lift(x);
        let Removed { members, covers, terms, .. } = &self.taken;
        let sum = |row: &Inequality| -> f64 {
            let terms = terms.of(row).iter().filter(|t| t.0 != REMOVED);
            terms.map(|&(k, a)| a * x[k]).sum()
        };
        let mut covered: Vec<f64> = covers.iter().map(sum).collect();
        for member in members {
            let best = (member.hurt.limit - sum(&member.hurt)) / member.coefficient;
            let (on, idle) = member.values();
            let best = if best.is_finite() { best.clamp(0.0, 1.0) } else { idle };
            let value = if (best - on).abs() <= BINARY_TOLERANCE { on } else { best };
            covered[member.cover] += member.help * if value == on { on } else { idle };
            point[member.column] = value;
        }
        for member in members {
            let limit = covers[member.cover].limit;
            let satisfied =
                covered[member.cover] <= limit + BINARY_TOLERANCE * limit.abs().max(1.0);
            let (on, idle) = member.values();
            if satisfied && point[member.column] != on {
                point[member.column] = idle;
            }
        }
        point
    }

    /// Multipliers of the program's rows, from those of the projected program.
    ///
    /// # Arguments
    ///
    /// * `rows`: the number of rows of the program.
    pub(crate) fn multipliers(&self, y: &[f64], rows: usize) -> Vec<f64> {
        let mut all = vec![0.0; rows];
        for (&row, &y) in self.reduced.origin.iter().zip(y) {
            if let Some(place) = all.get_mut(row) {
                *place = y;
            }
        }
        // Sums of rows were written as upper limits.
        for &(row, sign) in &self.taken.cover_rows {
            if let Some(place) = all.get_mut(row) {
                *place = sign * place.max(0.0);
            }
        }
        for member in &self.taken.members {
            let (cover, sign) = self.taken.cover_rows[member.cover];
            let sum = all.get(cover).map_or(0.0, |y| sign * y);
            let (row, factor) = member.hurt_row;
            if let Some(place) = all.get_mut(row) {
                *place = factor * sum;
            }
        }
        all
    }
}

/// Takes binaries out of a reduced program; `integral` is by program column.
pub fn project(reduced: Reduced, integral: &[bool]) -> Projection {
    Projector::default().project(reduced, integral, &mut Vec::new())
}

/// Projects one program after the other, in the same memory.
#[derive(Debug, Clone, Default)]
pub(super) struct Projector {
    /// Columns that may be taken out.
    open: Vec<bool>,
    /// The first two rows of each open column, and how many there are.
    uses: Vec<([(usize, f64); 2], u32)>,
    taken: Removed,
    /// By row: its number among the covering rows from which binaries were taken out.
    cover_of: Vec<usize>,
    replaced: Vec<Option<Inequality>>,
    dropped: Vec<bool>,
    /// By column: its position in what is left.
    position: Vec<usize>,
    /// Memory of projections that are no longer needed.
    spare: Vec<Removed>,
}

const REMOVED: usize = usize::MAX;

impl Projector {
    /// As [`project`].
    ///
    /// # Arguments
    ///
    /// * `spare`: programs that are no longer needed, for their memory.
    pub(super) fn project(
        &mut self,
        reduced: Reduced,
        integral: &[bool],
        spare: &mut Vec<Reduced>,
    ) -> Projection {
        self.taken.clear();
        if self.start(&reduced, integral) {
            // Taking out a column may make others ineligible.
            for k in 0..reduced.columns.len() {
                if self.open[k] {
                    self.take_out(&reduced, k);
                }
            }
        }
        if self.taken.members.is_empty() {
            return Projection { reduced, taken: Removed::default() };
        }
        let mut rest = spare.pop().unwrap_or_default();
        self.write(&reduced, &mut rest);
        spare.push(reduced);
        let taken = std::mem::replace(&mut self.taken, self.spare.pop().unwrap_or_default());
        Projection { reduced: rest, taken }
    }

    /// Takes back a projection that is no longer needed. Returns its reduced program.
    pub(super) fn reuse(&mut self, projection: Projection) -> Reduced {
        let Projection { reduced, taken } = projection;
        if !taken.members.is_empty() {
            self.spare.push(taken);
        }
        reduced
    }

    /// Finds the columns that may be taken out; `false` if there are none.
    fn start(&mut self, reduced: &Reduced, integral: &[bool]) -> bool {
        let (n, m) = (reduced.columns.len(), reduced.rows.len());
        let Projector { open, uses, cover_of, replaced, dropped, .. } = self;
        let may_go = |k: usize| {
            let is_binary = reduced.lower[k] == 0.0 && reduced.upper[k] == 1.0;
            is_binary && reduced.linear[k] == 0.0 && integral[reduced.columns[k]]
        };
        open.clear();
        open.extend((0..n).map(may_go));
        for j in 0..n {
            for &i in reduced.quadratic.vector(j).0 {
                (open[i], open[j]) = (false, false);
            }
        }
        for entry in reduced.cones.iter().flat_map(|cone| &cone.entries) {
            if !entry.is_fixed() {
                open[entry.place] = false;
            }
        }
        if !open.contains(&true) {
            return false;
        }
        refill(uses, n, ([(REMOVED, 0.0); 2], 0));
        for row in 0..m {
            let (columns, values) = reduced.rows.vector(row);
            for (&k, &a) in columns.iter().zip(values).filter(|(k, _)| open[**k]) {
                let (rows, count) = &mut uses[k];
                if let Some(slot) = rows.get_mut(*count as usize) {
                    *slot = (row, a);
                }
                *count += 1;
            }
        }
        (0..n).for_each(|k| open[k] &= uses[k].1 == 2);
        if !open.contains(&true) {
            return false;
        }
        refill(cover_of, m, REMOVED);
        refill(replaced, m, None);
        refill(dropped, m, false);
        true
    }

    /// A one-sided row in the form `terms <= limit`, its terms put at the end of all.
    fn inequality(&mut self, reduced: &Reduced, row: usize) -> Option<Inequality> {
        let terms = &mut self.taken.terms;
        let begin = terms.0.len();
        let limit = if let Some(replaced) = self.replaced[row] {
            terms.0.extend_from_within(replaced.range[0]..replaced.range[1]);
            replaced.limit
        } else {
            let (lower, upper) = (reduced.row_lower[row], reduced.row_upper[row]);
            let (sign, limit) = match (lower.is_finite(), upper.is_finite()) {
                (true, false) => (-1.0, -lower),
                (false, true) => (1.0, upper),
                _ => return None,
            };
            let (columns, values) = reduced.rows.vector(row);
            terms.0.extend(columns.iter().zip(values).map(|(&k, &a)| (k, sign * a)));
            limit
        };
        Some(Inequality { range: [begin, terms.0.len()], limit })
    }

    /// Takes one column out where its two rows allow it.
    fn take_out(&mut self, reduced: &Reduced, k: usize) {
        let before = self.taken.terms.0.len();
        if self.try_to_take_out(reduced, k).is_none() {
            self.taken.terms.0.truncate(before);
        }
    }

    fn try_to_take_out(&mut self, reduced: &Reduced, k: usize) -> Option<()> {
        let rows = self.uses[k].0.map(|(row, _)| row);
        if !self.open[k] || rows[0] == rows[1] || rows.iter().any(|&r| self.dropped[r]) {
            return None;
        }
        // The row that the binary makes bind is the one with fewer candidates in it.
        let length = |row: usize| {
            let columns = reduced.rows.vector(row).0;
            (columns.iter().filter(|k| self.open[**k]).count(), columns.len())
        };
        let [hurt, cover] =
            if length(rows[0]) <= length(rows[1]) { rows } else { [rows[1], rows[0]] };
        if self.cover_of[hurt] != REMOVED {
            return None;
        }
        let (mut h, mut sum) = (self.inequality(reduced, hurt)?, self.inequality(reduced, cover)?);
        let c = sum;
        if self.cover_of[cover] == REMOVED {
            // The original covering row is kept; its terms are copied and the copy is reduced.
            let terms = &mut self.taken.terms.0;
            sum.range = [c.range[1], terms.len() + c.range[1] - c.range[0]];
            terms.extend_from_within(c.range[0]..c.range[1]);
        }
        let m = self.take(&mut h, k)?;
        let help = self.take(&mut sum, k)?;
        if m * help >= 0.0 {
            return None;
        }
        // At the value of the binary that relaxes a row, the bounds must imply the row.
        let implied = |row: &Inequality, coefficient: f64| {
            let terms = self.taken.terms.of(row);
            let most: f64 = terms.iter().map(|&(k, a)| term_upper_bound(reduced, k, a)).sum();
            let limit = row.limit - coefficient.min(0.0);
            most <= limit + IMPLIED_EXCESS * limit.abs().max(1.0)
        };
        if !implied(&h, m) || !implied(&sum, help) {
            return None;
        }
        let factor = -help / m;
        let terms = &mut self.taken.terms;
        terms.0.truncate(sum.range[1]);
        for position in h.range[0]..h.range[1] {
            let (k, a) = terms.0[position];
            terms.0.push((k, factor * a));
        }
        sum.range[1] = sum.range[0] + merge(&mut terms.0[sum.range[0]..]);
        terms.0.truncate(sum.range[1]);
        // The largest magnitude of a term.
        let reach = |&(k, a): &(usize, f64)| {
            term_upper_bound(reduced, k, a).max(term_upper_bound(reduced, k, -a))
        };
        let size: f64 = terms.of(&sum).iter().map(reach).sum();
        let limit = c.limit + factor * h.limit;
        let limit = limit + 16.0 * f64::EPSILON * (size + c.limit.abs() + (factor * h.limit).abs());
        if !limit.is_finite() {
            return None;
        }
        // The columns of a removed binary's row must stay, and a row is combined once.
        terms.of(&h).iter().for_each(|t| self.open[t.0] = false);
        self.open[k] = false;
        self.dropped[hurt] = true;
        if self.cover_of[cover] == REMOVED {
            self.cover_of[cover] = self.taken.covers.len();
            self.taken.covers.push(c);
            self.taken.cover_rows.push((origin(reduced, cover), sign(reduced, cover)));
        }
        self.replaced[cover] = Some(Inequality { limit, ..sum });
        self.taken.members.push(RemovedBinary {
            column: reduced.columns[k],
            position: k,
            hurt: h,
            coefficient: m,
            help,
            cover: self.cover_of[cover],
            hurt_row: (origin(reduced, hurt), factor * sign(reduced, hurt)),
        });
        Some(())
    }

    /// Takes the term of a column out of a row: its coefficient.
    fn take(&mut self, row: &mut Inequality, k: usize) -> Option<f64> {
        let terms = &mut self.taken.terms.0[row.range[0]..row.range[1]];
        let at = terms.iter().position(|t| t.0 == k)?;
        let coefficient = terms[at].1;
        terms.copy_within(at + 1.., at);
        row.range[1] -= 1;
        Some(coefficient)
    }

    /// Writes the program over the remaining columns and rows.
    fn write(&mut self, reduced: &Reduced, rest: &mut Reduced) {
        let Projector { taken: Removed { members, terms, .. }, position, .. } = self;
        refill(position, reduced.columns.len(), 0);
        members.iter().for_each(|member| position[member.position] = REMOVED);
        rest.columns.clear();
        for (position, &column) in position.iter_mut().zip(&reduced.columns) {
            if *position != REMOVED {
                *position = rest.columns.len();
                rest.columns.push(column);
            }
        }
        let write = |to: &mut Vec<f64>, from: &[f64]| {
            let kept = from.iter().zip(&*position).filter(|(_, position)| **position != REMOVED);
            to.clear();
            to.extend(kept.map(|(value, _)| value));
        };
        write(&mut rest.linear, &reduced.linear);
        write(&mut rest.lower, &reduced.lower);
        write(&mut rest.upper, &reduced.upper);
        write(&mut rest.steepness, &reduced.steepness);
        rest.values.clone_from(&reduced.values);
        rest.slack.clone_from(&reduced.slack);
        (rest.offset, rest.spread) = (reduced.offset, reduced.spread);
        rest.is_cut_off = reduced.is_cut_off;
        rest.wants_vertex = reduced.wants_vertex;
        rest.cones.clone_from(&reduced.cones);
        let entries = rest.cones.iter_mut().flat_map(|cone| &mut cone.entries);
        entries
            .filter(|entry| !entry.is_fixed())
            .for_each(|entry| entry.place = position[entry.place]);
        let Reduced { rows, quadratic, .. } = rest;
        rows.clear(reduced.rows.len(), reduced.rows.index.len());
        for limits in [&mut rest.row_lower, &mut rest.row_upper] {
            limits.clear();
        }
        rest.origin.clear();
        for row in (0..reduced.rows.len()).filter(|&row| !self.dropped[row]) {
            match &self.replaced[row] {
                Some(inequality) if terms.of(inequality).iter().all(|t| t.1 == 0.0) => continue,
                Some(inequality) => {
                    for &(k, a) in terms.of(inequality).iter().filter(|t| t.1 != 0.0) {
                        rows.index.push(position[k]);
                        rows.value.push(a);
                    }
                    rest.row_lower.push(f64::NEG_INFINITY);
                    rest.row_upper.push(inequality.limit);
                }
                None => {
                    let (columns, values) = reduced.rows.vector(row);
                    rows.index.extend(columns.iter().map(|&k| position[k]));
                    rows.value.extend(values);
                    rest.row_lower.push(reduced.row_lower[row]);
                    rest.row_upper.push(reduced.row_upper[row]);
                }
            }
            rows.start.push(rows.index.len());
            rest.origin.push(origin(reduced, row));
        }
        quadratic.clear(rest.columns.len(), reduced.quadratic.index.len());
        for k in (0..reduced.columns.len()).filter(|&k| position[k] != REMOVED) {
            let (columns, values) = reduced.quadratic.vector(k);
            quadratic.index.extend(columns.iter().map(|&i| position[i]));
            quadratic.value.extend(values);
            quadratic.start.push(quadratic.index.len());
        }
        // Columns that are gone have no position.
        terms.0.iter_mut().for_each(|t| t.0 = position[t.0]);
    }
}

/// The program's row behind a row.
fn origin(reduced: &Reduced, row: usize) -> usize {
    reduced.origin.get(row).copied().unwrap_or(REMOVED)
}

/// The sign of a one-sided row in the form `terms <= limit`.
fn sign(reduced: &Reduced, row: usize) -> f64 {
    if reduced.row_upper[row].is_finite() { 1.0 } else { -1.0 }
}

/// The largest value of a term.
fn term_upper_bound(reduced: &Reduced, k: usize, a: f64) -> f64 {
    term_ends(a, [reduced.lower[k], reduced.upper[k]])[1]
}

/// Sorts terms by column and adds up those of the same one; how many are left.
fn merge(terms: &mut [(usize, f64)]) -> usize {
    terms.sort_by_key(|t| t.0);
    let mut left = 0;
    for k in 0..terms.len() {
        if left > 0 && terms[left - 1].0 == terms[k].0 {
            terms[left - 1].1 += terms[k].1;
        } else {
            terms[left] = terms[k];
            left += 1;
        }
    }
    left
}
