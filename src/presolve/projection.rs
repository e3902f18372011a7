//! Projection: removing binaries that a relaxation does not need.
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

use super::coefficients::is_binary;
use super::reduced::{Compressed, Reduced};

/// Excess of a side over what the bounds imply up to which it counts as implied; a side dropped
/// too much only loosens the relaxation (no unit, relative).
const NEGLIGIBLE: f64 = 1e-8;

/// Distance to a whole value, or of a row to its limit, that counts as none (no unit).
const WHOLE: f64 = 1e-6;

/// A reduced program without the binaries that only link two rows.
#[derive(Debug, Clone)]
pub struct Projection {
    /// What is left.
    pub reduced: Reduced,
    members: Vec<Member>,
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
struct Member {
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
    /// The program's row that it makes bind, and by what the multiplier of the sum is multiplied there.
    hurt_row: (usize, f64),
}

impl Member {
    /// The value that helps the covering row, and the other one.
    fn values(&self) -> (f64, f64) {
        if self.help < 0.0 { (1.0, 0.0) } else { (0.0, 1.0) }
    }
}

impl Projection {
    /// Takes nothing out.
    fn none(reduced: Reduced) -> Projection {
        let terms = Terms::default();
        Projection {
            reduced,
            members: Vec::new(),
            covers: Vec::new(),
            cover_rows: Vec::new(),
            terms,
        }
    }

    /// The program's point that belongs to a point of what is left.
    pub fn lift(&self, x: &[f64]) -> Vec<f64> {
        let mut point = self.reduced.lift(x);
        let sum = |row: &Inequality| -> f64 {
            let terms = self.terms.of(row).iter().filter(|t| t.0 != NONE);
            terms.map(|&(k, a)| a * x[k]).sum()
        };
        let mut covered: Vec<f64> = self.covers.iter().map(sum).collect();
        let mut values = Vec::with_capacity(self.members.len());
        for member in &self.members {
            let best = (member.hurt.limit - sum(&member.hurt)) / member.coefficient;
            let (on, idle) = member.values();
            let best = if best.is_finite() { best.clamp(0.0, 1.0) } else { idle };
            let value = if (best - on).abs() <= WHOLE { on } else { best };
            covered[member.cover] += member.help * if value == on { on } else { idle };
            values.push(value);
        }
        for (member, value) in self.members.iter().zip(values) {
            let limit = self.covers[member.cover].limit;
            let satisfied = covered[member.cover] <= limit + WHOLE * limit.abs().max(1.0);
            let (on, idle) = member.values();
            point[member.column] = if satisfied && value != on { idle } else { value };
        }
        point
    }

    /// Multipliers in the rows of the program, from those of what is left.
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
        let sums: Vec<f64> = self
            .cover_rows
            .iter()
            .map(|&(row, sign)| {
                let Some(place) = all.get_mut(row) else { return 0.0 };
                let y = place.max(0.0);
                *place = sign * y;
                y
            })
            .collect();
        for member in &self.members {
            let (row, factor) = member.hurt_row;
            if let Some(place) = all.get_mut(row) {
                *place = factor * sums[member.cover];
            }
        }
        all
    }
}

/// Takes binaries out of a reduced program; `integral` is by program column.
pub fn project(reduced: Reduced, integral: &[bool]) -> Projection {
    let Some(mut work) = Work::new(&reduced, integral) else { return Projection::none(reduced) };
    // What is taken out closes others.
    let candidates: Vec<usize> = (0..reduced.columns.len()).filter(|&k| work.open[k]).collect();
    candidates.into_iter().for_each(|k| work.take_out(k));
    if work.members.is_empty() {
        return Projection::none(reduced);
    }
    let Work { members, covers, cover_rows, terms, replaced, dropped, .. } = work;
    finish(reduced, members, (covers, cover_rows, terms), (replaced, dropped))
}

struct Work<'a> {
    reduced: &'a Reduced,
    /// Columns that may be taken out.
    open: Vec<bool>,
    /// The first two rows of each open column, and how many there are.
    uses: Vec<([(usize, f64); 2], u32)>,
    members: Vec<Member>,
    covers: Vec<Inequality>,
    cover_rows: Vec<(usize, f64)>,
    terms: Terms,
    /// By row: the cover it is, after members were taken out of it.
    cover_of: Vec<usize>,
    replaced: Vec<Option<Inequality>>,
    dropped: Vec<bool>,
}

const NONE: usize = usize::MAX;

impl<'a> Work<'a> {
    /// `None` if no column may be taken out.
    fn new(reduced: &'a Reduced, integral: &[bool]) -> Option<Self> {
        let (n, m) = (reduced.columns.len(), reduced.rows.len());
        let mut open: Vec<bool> =
            (0..n).map(|k| reduced.linear[k] == 0.0 && is_binary(reduced, k, integral)).collect();
        for j in 0..n {
            for &i in reduced.quadratic.vector(j).0 {
                (open[i], open[j]) = (false, false);
            }
        }
        if !open.contains(&true) {
            return None;
        }
        let mut uses = vec![([(NONE, 0.0); 2], 0); n];
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
            return None;
        }
        Some(Work {
            reduced,
            open,
            uses,
            members: Vec::new(),
            covers: Vec::new(),
            cover_rows: Vec::new(),
            terms: Terms::default(),
            cover_of: vec![NONE; m],
            replaced: vec![None; m],
            dropped: vec![false; m],
        })
    }

    /// A one-sided row in the form `terms <= limit`, its terms put at the end of all.
    fn inequality(&mut self, row: usize) -> Option<Inequality> {
        let begin = self.terms.0.len();
        let limit = if let Some(replaced) = self.replaced[row] {
            self.terms.0.extend_from_within(replaced.range[0]..replaced.range[1]);
            replaced.limit
        } else {
            let (lower, upper) = (self.reduced.row_lower[row], self.reduced.row_upper[row]);
            let (sign, limit) = match (lower.is_finite(), upper.is_finite()) {
                (true, false) => (-1.0, -lower),
                (false, true) => (1.0, upper),
                _ => return None,
            };
            let (columns, values) = self.reduced.rows.vector(row);
            self.terms.0.extend(columns.iter().zip(values).map(|(&k, &a)| (k, sign * a)));
            limit
        };
        Some(Inequality { range: [begin, self.terms.0.len()], limit })
    }

    /// Takes one column out where its two rows allow it.
    fn take_out(&mut self, k: usize) {
        let before = self.terms.0.len();
        if self.try_to_take_out(k).is_none() {
            self.terms.0.truncate(before);
        }
    }

    fn try_to_take_out(&mut self, k: usize) -> Option<()> {
        let rows = self.uses[k].0.map(|(row, _)| row);
        if !self.open[k] || rows[0] == rows[1] || rows.iter().any(|&r| self.dropped[r]) {
            return None;
        }
        // The row that the binary makes bind is the one with fewer candidates in it.
        let length = |row: usize| {
            let columns = self.reduced.rows.vector(row).0;
            (columns.iter().filter(|k| self.open[**k]).count(), columns.len())
        };
        let [hurt, cover] =
            if length(rows[0]) <= length(rows[1]) { rows } else { [rows[1], rows[0]] };
        if self.cover_of[hurt] != NONE {
            return None;
        }
        let (mut h, mut sum) = (self.inequality(hurt)?, self.inequality(cover)?);
        let c = sum;
        if self.cover_of[cover] == NONE {
            // The covering row as it was is kept, and taken apart behind itself.
            sum.range = [c.range[1], self.terms.0.len() + c.range[1] - c.range[0]];
            self.terms.0.extend_from_within(c.range[0]..c.range[1]);
        }
        let m = self.take(&mut h, k)?;
        let help = self.take(&mut sum, k)?;
        if m * help >= 0.0 {
            return None;
        }
        // Alone, neither row may say anything at the binary's better value for it.
        let implied = |row: &Inequality, coefficient: f64| {
            let most: f64 = self.terms.of(row).iter().map(|&(k, a)| self.most(k, a)).sum();
            let limit = row.limit - coefficient.min(0.0);
            most <= limit + NEGLIGIBLE * limit.abs().max(1.0)
        };
        if !implied(&h, m) || !implied(&sum, help) {
            return None;
        }
        let factor = -help / m;
        self.terms.0.truncate(sum.range[1]);
        for position in h.range[0]..h.range[1] {
            let (k, a) = self.terms.0[position];
            self.terms.0.push((k, factor * a));
        }
        sum.range[1] = sum.range[0] + merge(&mut self.terms.0[sum.range[0]..]);
        self.terms.0.truncate(sum.range[1]);
        let size: f64 = self.terms.of(&sum).iter().map(|t| self.size(t.0, t.1)).sum();
        let limit = c.limit + factor * h.limit;
        let limit = limit + 16.0 * f64::EPSILON * (size + c.limit.abs() + (factor * h.limit).abs());
        if !limit.is_finite() {
            return None;
        }
        // What the members' rows are about must stay, and a row is used up once.
        self.terms.of(&h).iter().for_each(|t| self.open[t.0] = false);
        self.open[k] = false;
        self.dropped[hurt] = true;
        if self.cover_of[cover] == NONE {
            self.cover_of[cover] = self.covers.len();
            self.covers.push(c);
            self.cover_rows.push((self.origin(cover), self.sign(cover)));
        }
        self.replaced[cover] = Some(Inequality { limit, ..sum });
        self.members.push(Member {
            column: self.reduced.columns[k],
            position: k,
            hurt: h,
            coefficient: m,
            help,
            cover: self.cover_of[cover],
            hurt_row: (self.origin(hurt), factor * self.sign(hurt)),
        });
        Some(())
    }

    /// The program's row behind a row.
    fn origin(&self, row: usize) -> usize {
        self.reduced.origin.get(row).copied().unwrap_or(NONE)
    }

    /// The sign of a one-sided row in the form `terms <= limit`.
    fn sign(&self, row: usize) -> f64 {
        if self.reduced.row_upper[row].is_finite() { 1.0 } else { -1.0 }
    }

    /// Takes the term of a column out of a row: its coefficient.
    fn take(&mut self, row: &mut Inequality, k: usize) -> Option<f64> {
        let terms = &mut self.terms.0[row.range[0]..row.range[1]];
        let at = terms.iter().position(|t| t.0 == k)?;
        let coefficient = terms[at].1;
        terms.copy_within(at + 1.., at);
        row.range[1] -= 1;
        Some(coefficient)
    }

    /// The largest value of a term.
    fn most(&self, k: usize, a: f64) -> f64 {
        (a * self.reduced.lower[k]).max(a * self.reduced.upper[k])
    }

    /// The largest magnitude of a term.
    fn size(&self, k: usize, a: f64) -> f64 {
        self.most(k, a.abs()).max(self.most(k, -a.abs()))
    }
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

/// Rebuilds the program over what is left.
fn finish(
    reduced: Reduced,
    members: Vec<Member>,
    (covers, cover_rows, mut terms): (Vec<Inequality>, Vec<(usize, f64)>, Terms),
    (replaced, dropped): (Vec<Option<Inequality>>, Vec<bool>),
) -> Projection {
    let n = reduced.columns.len();
    let mut gone = vec![false; n];
    members.iter().for_each(|member| gone[member.position] = true);
    let kept: Vec<usize> = (0..n).filter(|&k| !gone[k]).collect();
    let mut position = vec![NONE; n];
    kept.iter().enumerate().for_each(|(new, &k)| position[k] = new);
    let of = |values: &[f64]| kept.iter().map(|&k| values[k]).collect();

    let mut rows = Compressed { start: vec![0], ..Compressed::default() };
    rows.start.reserve(reduced.rows.len());
    rows.index.reserve(reduced.rows.index.len());
    rows.value.reserve(reduced.rows.index.len());
    let mut origin = Vec::with_capacity(reduced.rows.len());
    let (mut row_lower, mut row_upper) =
        (Vec::with_capacity(reduced.rows.len()), Vec::with_capacity(reduced.rows.len()));
    for (row, replaced) in replaced.iter().enumerate().filter(|(row, _)| !dropped[*row]) {
        match replaced {
            Some(inequality) if terms.of(inequality).iter().all(|t| t.1 == 0.0) => continue,
            Some(inequality) => {
                for &(k, a) in terms.of(inequality).iter().filter(|t| t.1 != 0.0) {
                    rows.index.push(position[k]);
                    rows.value.push(a);
                }
                row_lower.push(f64::NEG_INFINITY);
                row_upper.push(inequality.limit);
            }
            None => {
                let (columns, values) = reduced.rows.vector(row);
                rows.index.extend(columns.iter().map(|&k| position[k]));
                rows.value.extend(values);
                row_lower.push(reduced.row_lower[row]);
                row_upper.push(reduced.row_upper[row]);
            }
        }
        rows.start.push(rows.index.len());
        origin.push(reduced.origin.get(row).copied().unwrap_or(NONE));
    }
    let mut quadratic = Compressed { start: vec![0], ..Compressed::default() };
    quadratic.start.reserve(kept.len());
    quadratic.index.reserve(reduced.quadratic.index.len());
    quadratic.value.reserve(reduced.quadratic.index.len());
    for &k in &kept {
        let (columns, values) = reduced.quadratic.vector(k);
        quadratic.index.extend(columns.iter().map(|&i| position[i]));
        quadratic.value.extend(values);
        quadratic.start.push(quadratic.index.len());
    }
    // Columns that are gone have no position.
    terms.0.iter_mut().for_each(|t| t.0 = position[t.0]);
    let reduced = Reduced {
        linear: of(&reduced.linear),
        lower: of(&reduced.lower),
        upper: of(&reduced.upper),
        columns: kept.iter().map(|&k| reduced.columns[k]).collect(),
        values: reduced.values,
        offset: reduced.offset,
        rows,
        origin,
        row_lower,
        row_upper,
        quadratic,
        spread: reduced.spread,
        steepness: kept.iter().filter_map(|&k| reduced.steepness.get(k).copied()).collect(),
    };
    Projection { reduced, members, covers, cover_rows, terms }
}
