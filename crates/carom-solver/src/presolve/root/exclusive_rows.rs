//! Exclusive rows.
//!
//! Takes rows that differ only in binaries of which at most one is 1; leaves one row with all of
//! these binaries.
//!
//! `rest + a x <= b` and `rest + c y <= b` with `x + y <= 1` and positive `a` and `c` say together
//! that `rest + a x + c y <= b`, which fractions of `x` and `y` keep less easily. They come from
//! times that a choice between routes determines, where each route has a row of its own.

use super::postsolve::{Restored, Undo};
use super::working_program::{Sparse, WorkingProgram};
use crate::presolve::parameters::FEW_ROUNDINGS;
use crate::tolerance;
use std::hash::{DefaultHasher, Hash, Hasher};

/// The longest rows that say that at most one of some binaries is 1, and the longest that become
/// one.
const MAX_CLIQUE_TERMS: usize = 100;
const MAX_ROW_TERMS: usize = 8;

/// A row, and one of its binaries that is in a set of exclusive ones.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct ExclusiveCandidate {
    /// Of the rest of the row and its limit.
    hash: u64,
    row: usize,
    column: usize,
}

/// Rows that became one, in the place of the first.
#[derive(Debug)]
struct ExclusiveRows {
    /// Row, binary and coefficient.
    members: Vec<(usize, usize, f64)>,
}

pub(super) fn apply(work: &mut WorkingProgram) -> usize {
    // Under curvature, points lie within faces, so that a tighter row is met in fractions all the
    // same.
    if work.quadratic.iter().any(|products| !products.is_empty()) {
        return 0;
    }
    let (cliques, places) = exclusive_binaries(work);
    if cliques.is_empty() {
        return 0;
    }
    let mut candidates = Vec::new();
    for row in work.live_rows() {
        if work.rows[row].len() > MAX_ROW_TERMS || sign(work, row).is_none() {
            continue;
        }
        if work.is_late(work.rows[row].len()) {
            return 0;
        }
        let columns = work.rows[row].iter().map(|&(j, _)| j).filter(|&j| !places[j].is_empty());
        candidates.extend(columns.filter_map(|j| candidate(work, row, j)));
    }
    candidates.sort_unstable();
    let mut is_used = vec![false; work.rows.len()];
    let mut changes = 0;
    for alike in candidates.chunk_by(|a, b| a.hash == b.hash).filter(|alike| alike.len() > 1) {
        for &first in alike {
            if is_used[first.row] {
                continue;
            }
            let others = alike.iter().filter(|other| {
                other.row > first.row && !is_used[other.row] && differ_in_one(work, first, **other)
            });
            let others: Vec<ExclusiveCandidate> = others.copied().collect();
            // The set that most of them are in.
            let beside = |clique: &usize| {
                let is_there = |j: usize| cliques[*clique].binary_search(&j).is_ok();
                let mut found: Vec<ExclusiveCandidate> = vec![first];
                for &other in others.iter().filter(|other| is_there(other.column)) {
                    if found.iter().all(|k| k.row != other.row && k.column != other.column) {
                        found.push(other);
                    }
                }
                found
            };
            let best = places[first.column].iter().map(beside).max_by_key(Vec::len);
            if let Some(rows) = best.filter(|rows| rows.len() > 1) {
                rows.iter().for_each(|k| is_used[k.row] = true);
                merge(work, &rows);
                changes += 1;
            }
        }
    }
    changes
}

/// Sets of binaries of which at most one is 1, each sorted, and by column the sets that it is in.
fn exclusive_binaries(work: &mut WorkingProgram) -> (Vec<Vec<usize>>, Vec<Vec<usize>>) {
    let (mut cliques, mut places) = (Vec::new(), vec![Vec::new(); work.uses.len()]);
    for row in work.live_rows() {
        let terms = &work.rows[row];
        let fits = (2..=MAX_CLIQUE_TERMS).contains(&terms.len())
            && terms.iter().all(|&(j, _)| work.is_binary(j));
        if !fits {
            continue;
        }
        if work.is_late(work.rows[row].len()) {
            break;
        }
        for (sign, limit) in [(1.0, work.row_upper[row]), (-1.0, -work.row_lower[row])] {
            if let Some(clique) = clique(&work.rows[row], sign, limit) {
                clique.iter().for_each(|&j| places[j].push(cliques.len()));
                cliques.push(clique);
            }
        }
    }
    (cliques, places)
}

/// The binaries of `sign * terms <= limit` no two of which can be 1.
fn clique(terms: &Sparse, sign: f64, limit: f64) -> Option<Vec<usize>> {
    if limit.is_infinite() {
        return None;
    }
    let scale: f64 = terms.iter().map(|(_, a)| a.abs()).sum();
    let least: f64 = terms.iter().map(|(_, a)| (sign * a).min(0.0)).sum();
    let room = limit - least + tolerance::FEASIBILITY + FEW_ROUNDINGS * (scale + limit.abs());
    let positive = terms.iter().map(|&(j, a)| (j, sign * a)).filter(|(_, a)| *a > 0.0);
    let mut positive: Vec<(usize, f64)> = positive.collect();
    positive.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
    let pairs = positive.windows(2).take_while(|pair| pair[0].1 + pair[1].1 > room).count();
    if pairs == 0 {
        return None;
    }
    let mut clique: Vec<usize> = positive[..=pairs].iter().map(|&(j, _)| j).collect();
    clique.sort_unstable();
    Some(clique)
}

/// The sign with which a row has only an upper limit.
fn sign(work: &WorkingProgram, row: usize) -> Option<f64> {
    match (work.row_lower[row].is_finite(), work.row_upper[row].is_finite()) {
        (false, true) => Some(1.0),
        (true, false) => Some(-1.0),
        _ => None,
    }
}

fn candidate(work: &WorkingProgram, row: usize, column: usize) -> Option<ExclusiveCandidate> {
    let sign = sign(work, row)?;
    let is_harder = sign * work.coefficient(row, column) > 0.0;
    if !is_harder || !work.is_binary(column) {
        return None;
    }
    let mut hasher = DefaultHasher::new();
    for &(j, a) in work.rows[row].iter().filter(|(j, _)| *j != column) {
        (j, a.to_bits()).hash(&mut hasher);
    }
    let limit = if sign > 0.0 { work.row_upper[row] } else { work.row_lower[row] };
    (limit.to_bits(), sign > 0.0).hash(&mut hasher);
    Some(ExclusiveCandidate { hash: hasher.finish(), row, column })
}

/// Whether two rows are the same but for their binaries.
fn differ_in_one(
    work: &WorkingProgram,
    one: ExclusiveCandidate,
    other: ExclusiveCandidate,
) -> bool {
    fn rest(work: &WorkingProgram, of: ExclusiveCandidate) -> impl Iterator<Item = &(usize, f64)> {
        work.rows[of.row].iter().filter(move |(j, _)| *j != of.column)
    }
    let limits = |of: ExclusiveCandidate| [work.row_lower[of.row], work.row_upper[of.row]];
    limits(one) == limits(other) && rest(work, one).eq(rest(work, other))
}

/// Makes the first of some rows all of them.
fn merge(work: &mut WorkingProgram, rows: &[ExclusiveCandidate]) {
    let kept = rows[0].row;
    let member = |k: &ExclusiveCandidate| (k.row, k.column, work.coefficient(k.row, k.column));
    let members: Vec<(usize, usize, f64)> = rows.iter().map(member).collect();
    let mut entries = work.rows[kept].clone();
    entries.extend(members[1..].iter().map(|&(_, j, a)| (j, a)));
    entries.sort_unstable_by_key(|entry| entry.0);
    for &(row, _, _) in &members[1..] {
        work.row_noise[kept] = work.row_noise[kept].max(work.row_noise[row]);
        work.drop_row(row);
    }
    work.set_row(kept, entries);
    work.push(ExclusiveRows { members });
}

impl Undo for ExclusiveRows {
    /// The multiplier belongs to the row whose binary is 1.
    fn dual(&self, all: &mut Restored) {
        let kept = self.members[0].0;
        let y = std::mem::take(&mut all.y[kept]);
        let is_on = |member: &&(usize, usize, f64)| all.x[member.1] > 0.5;
        let chosen = self.members.iter().find(is_on).unwrap_or(&self.members[0]).0;
        all.y[chosen] = y;
        for &(row, column, a) in &self.members {
            all.d[column] -= if row == chosen { 0.0 } else { a * y };
        }
    }
}
