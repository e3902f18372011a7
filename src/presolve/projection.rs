//! Binaries that a relaxation does not need.
//!
//! A disjunction "one of these rows must hold" is written with a binary a row: `z = 1` makes its
//! row bind, and a covering row `z_1 + ... + z_k >= 1` wants one of them. As far as the relaxation
//! goes, such a binary only links two rows, and a Fourier-Motzkin step takes it out: the two rows
//! are added up so that it cancels. A disjunction of four sides loses four columns and four of its
//! five rows, and the relaxed set over the other columns stays the same.
//!
//! The way back picks whole values where there are any: a binary whose row holds at the relaxed
//! point is on, the others of a satisfied disjunction are idle, and only those of a violated one
//! stay fractional, the larger the nearer their row is to holding. That is what branching and
//! heuristics want to see.

use super::coefficients::is_binary;
use super::reduce::{Compressed, Reduced};

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
    covers: Vec<Cover>,
}

/// A row in the form `terms <= limit`.
#[derive(Debug, Clone, Default)]
struct Inequality {
    terms: Vec<(usize, f64)>,
    limit: f64,
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
}

/// A covering row before the projection, over the columns that stay.
#[derive(Debug, Clone)]
struct Cover {
    rest: Inequality,
}

impl Member {
    /// The value that helps the covering row, and the other one.
    fn values(&self) -> (f64, f64) {
        if self.help < 0.0 { (1.0, 0.0) } else { (0.0, 1.0) }
    }
}

impl Projection {
    /// The program's point that belongs to a point of what is left.
    pub fn lift(&self, x: &[f64]) -> Vec<f64> {
        let mut point = self.reduced.lift(x);
        let sum = |terms: &[(usize, f64)]| -> f64 { terms.iter().map(|&(k, a)| a * x[k]).sum() };
        let mut covered: Vec<f64> = self.covers.iter().map(|c| sum(&c.rest.terms)).collect();
        let mut values = Vec::with_capacity(self.members.len());
        for member in &self.members {
            let best = (member.hurt.limit - sum(&member.hurt.terms)) / member.coefficient;
            let (on, idle) = member.values();
            let best = if best.is_finite() { best.clamp(0.0, 1.0) } else { idle };
            let value = if (best - on).abs() <= WHOLE { on } else { best };
            covered[member.cover] += member.help * if value == on { on } else { idle };
            values.push(value);
        }
        for (member, value) in self.members.iter().zip(values) {
            let limit = self.covers[member.cover].rest.limit;
            let satisfied = covered[member.cover] <= limit + WHOLE * limit.abs().max(1.0);
            let (on, idle) = member.values();
            point[member.column] = if satisfied && value != on { idle } else { value };
        }
        point
    }
}

/// Takes binaries out of a reduced program; `integral` is by program column.
pub fn project(reduced: Reduced, integral: &[bool]) -> Projection {
    let mut work = Work::new(&reduced, integral);
    let candidates: Vec<usize> = (0..reduced.columns.len()).filter(|&k| work.open[k]).collect();
    candidates.into_iter().for_each(|k| work.take_out(k));
    if work.members.is_empty() {
        return Projection { reduced, members: Vec::new(), covers: Vec::new() };
    }
    let Work { members, covers, replaced, dropped, .. } = work;
    finish(reduced, members, covers, (replaced, dropped))
}

struct Work<'a> {
    reduced: &'a Reduced,
    /// Columns that may be taken out.
    open: Vec<bool>,
    /// The first two rows of each open column, and how many there are.
    uses: Vec<([(usize, f64); 2], u32)>,
    members: Vec<Member>,
    covers: Vec<Cover>,
    /// By row: the cover it is, after members were taken out of it.
    cover_of: Vec<usize>,
    replaced: Vec<Option<Inequality>>,
    dropped: Vec<bool>,
}

const NONE: usize = usize::MAX;

impl<'a> Work<'a> {
    fn new(reduced: &'a Reduced, integral: &[bool]) -> Self {
        let (n, m) = (reduced.columns.len(), reduced.rows.len());
        let mut open: Vec<bool> =
            (0..n).map(|k| reduced.linear[k] == 0.0 && is_binary(reduced, k, integral)).collect();
        for j in 0..n {
            for &i in reduced.quadratic.vector(j).0 {
                (open[i], open[j]) = (false, false);
            }
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
        Work {
            reduced,
            open,
            uses,
            members: Vec::new(),
            covers: Vec::new(),
            cover_of: vec![NONE; m],
            replaced: vec![None; m],
            dropped: vec![false; m],
        }
    }

    /// A one-sided row in the form `terms <= limit`.
    fn inequality(&self, row: usize) -> Option<Inequality> {
        if let Some(replaced) = &self.replaced[row] {
            return Some(replaced.clone());
        }
        let (lower, upper) = (self.reduced.row_lower[row], self.reduced.row_upper[row]);
        let (sign, limit) = match (lower.is_finite(), upper.is_finite()) {
            (true, false) => (-1.0, -lower),
            (false, true) => (1.0, upper),
            _ => return None,
        };
        let (columns, values) = self.reduced.rows.vector(row);
        let terms = columns.iter().zip(values).map(|(&k, &a)| (k, sign * a)).collect();
        Some(Inequality { terms, limit })
    }

    /// Takes one column out where its two rows allow it.
    fn take_out(&mut self, k: usize) {
        let rows = self.uses[k].0.map(|(row, _)| row);
        if !self.open[k] || rows[0] == rows[1] || rows.iter().any(|&r| self.dropped[r]) {
            return;
        }
        // The row that the binary makes bind is the one with fewer candidates in it.
        let length = |row: usize| {
            let columns = self.reduced.rows.vector(row).0;
            (columns.iter().filter(|k| self.open[**k]).count(), columns.len())
        };
        let [hurt, cover] =
            if length(rows[0]) <= length(rows[1]) { rows } else { [rows[1], rows[0]] };
        if self.cover_of[hurt] != NONE {
            return;
        }
        let (Some(mut h), Some(mut c)) = (self.inequality(hurt), self.inequality(cover)) else {
            return;
        };
        let take = |row: &mut Inequality| {
            let at = row.terms.iter().position(|t| t.0 == k)?;
            Some(row.terms.remove(at).1)
        };
        let (Some(m), Some(help)) = (take(&mut h), take(&mut c)) else { return };
        if m * help >= 0.0 {
            return;
        }
        // Alone, neither row may say anything at the binary's better value for it.
        let implied = |row: &Inequality, coefficient: f64| {
            let most: f64 = row.terms.iter().map(|&(k, a)| self.most(k, a)).sum();
            let limit = row.limit - coefficient.min(0.0);
            most <= limit + NEGLIGIBLE * limit.abs().max(1.0)
        };
        if !implied(&h, m) || !implied(&c, help) {
            return;
        }
        let factor = -help / m;
        let mut sum = c.terms.clone();
        sum.extend(h.terms.iter().map(|&(k, a)| (k, factor * a)));
        sum.sort_by_key(|t| t.0);
        sum.dedup_by(|later, first| {
            let same = later.0 == first.0;
            if same {
                first.1 += later.1;
            }
            same
        });
        let size: f64 =
            sum.iter().map(|&(k, a)| self.most(k, a.abs()).max(self.most(k, -a.abs()))).sum();
        let limit = c.limit + factor * h.limit;
        let limit = limit + 16.0 * f64::EPSILON * (size + c.limit.abs() + (factor * h.limit).abs());
        if !limit.is_finite() {
            return;
        }
        // What the members' rows are about must stay, and a row is used up once.
        h.terms.iter().for_each(|t| self.open[t.0] = false);
        self.open[k] = false;
        self.dropped[hurt] = true;
        if self.cover_of[cover] == NONE {
            self.cover_of[cover] = self.covers.len();
            let rest = self.inequality(cover).unwrap_or_default();
            self.covers.push(Cover { rest });
        }
        self.replaced[cover] = Some(Inequality { terms: sum, limit });
        self.members.push(Member {
            column: self.reduced.columns[k],
            position: k,
            hurt: h,
            coefficient: m,
            help,
            cover: self.cover_of[cover],
        });
    }

    /// The largest value of a term.
    fn most(&self, k: usize, a: f64) -> f64 {
        (a * self.reduced.lower[k]).max(a * self.reduced.upper[k])
    }
}

/// Rebuilds the program over what is left.
fn finish(
    reduced: Reduced,
    mut members: Vec<Member>,
    mut covers: Vec<Cover>,
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
    let (mut row_lower, mut row_upper) = (Vec::new(), Vec::new());
    for (row, replaced) in replaced.iter().enumerate().filter(|(row, _)| !dropped[*row]) {
        match replaced {
            Some(inequality) if inequality.terms.iter().all(|t| t.1 == 0.0) => continue,
            Some(inequality) => {
                for &(k, a) in inequality.terms.iter().filter(|t| t.1 != 0.0) {
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
    }
    let mut quadratic = Compressed { start: vec![0], ..Compressed::default() };
    for &k in &kept {
        let (columns, values) = reduced.quadratic.vector(k);
        quadratic.index.extend(columns.iter().map(|&i| position[i]));
        quadratic.value.extend(values);
        quadratic.start.push(quadratic.index.len());
    }
    let renumber = |terms: &mut Vec<(usize, f64)>| {
        terms.retain(|t| position[t.0] != NONE);
        terms.iter_mut().for_each(|t| t.0 = position[t.0]);
    };
    members.iter_mut().for_each(|member| renumber(&mut member.hurt.terms));
    covers.iter_mut().for_each(|cover| renumber(&mut cover.rest.terms));
    let reduced = Reduced {
        linear: of(&reduced.linear),
        lower: of(&reduced.lower),
        upper: of(&reduced.upper),
        columns: kept.iter().map(|&k| reduced.columns[k]).collect(),
        values: reduced.values,
        offset: reduced.offset,
        rows,
        row_lower,
        row_upper,
        quadratic,
    };
    Projection { reduced, members, covers }
}
