//! The inequalities of a mixed logical dynamical system, for each combination of its binaries.

use crate::activity;
use crate::error::Error;
use crate::interval::Interval;
use crate::tolerance::largest_magnitude;

/// Relative difference up to which two limits are equal.
const EQUAL: f64 = 1e-9;

/// Rounds of bound tightening after each fixing.
const ROUNDS: usize = 8;

/// Inequalities `row . (x, u, z, δ) <= limit`.
pub(super) struct Rows {
    pub(super) rows: Vec<Vec<f64>>,
    pub(super) limits: Vec<f64>,
    /// Ranges of x, u and z.
    pub(super) ranges: Vec<Interval>,
    pub(super) binaries: usize,
}

/// The inequalities over (x, u, z) that are left if the binaries are fixed.
pub(super) struct Leaf {
    rows: Vec<(Vec<f64>, f64)>,
    ranges: Vec<Interval>,
}

/// A guard: the number of its inequality from 0 on, or one past the last for the range of an
/// auxiliary, its normal and its limit.
type Guard = (usize, Vec<f64>, f64);

fn dot(factors: &[f64], values: &[f64]) -> f64 {
    factors.iter().zip(values).map(|(a, b)| a * b).sum()
}

/// The range of a linear function over a box.
fn range(factors: &[f64], ranges: &[Interval]) -> Interval {
    activity::range(0.0, factors.iter().copied().zip(ranges.iter().copied()))
}

impl Rows {
    /// The combinations of binaries that propagation of bounds does not exclude.
    pub(super) fn combinations(&self, most: usize) -> Result<Vec<Vec<bool>>, Error> {
        let mut found = Vec::new();
        let unit = Interval::new(0.0, 1.0);
        let all = [self.ranges.clone(), vec![unit; self.binaries]].concat();
        let mut open = vec![all];
        while let Some(mut ranges) = open.pop() {
            if !self.tighten(&mut ranges) {
                continue;
            }
            let binaries = &ranges[self.ranges.len()..];
            match binaries.iter().position(|range| range.lower < range.upper) {
                None => {
                    found.push(binaries.iter().map(|range| range.lower > 0.5).collect());
                    if found.len() > most {
                        let what = "the number of combinations of the binaries";
                        let (count, range) = (found.len() as f64, ..=most as f64);
                        let more = "; split the system into choices";
                        return Err(Error::out_of_range_with(what, count, range, more));
                    }
                }
                Some(k) => {
                    for value in [1.0, 0.0] {
                        let mut child = ranges.clone();
                        child[self.ranges.len() + k] = Interval::point(value);
                        open.push(child);
                    }
                }
            }
        }
        if found.is_empty() {
            let what = "the number of combinations of the binaries";
            let more = "; the inequalities contradict each other";
            return Err(Error::out_of_range_with(what, 0.0, 1.0.., more));
        }
        Ok(found)
    }

    /// Tightens ranges by the rows. Returns whether a point may be left.
    fn tighten(&self, ranges: &mut [Interval]) -> bool {
        for _ in 0..ROUNDS {
            let mut is_changed = false;
            for (row, &limit) in self.rows.iter().zip(&self.limits) {
                let least = range(row, ranges).lower;
                let slack = EQUAL * limit.abs().max(least.abs()).max(1.0);
                if least > limit + slack {
                    return false;
                }
                for (k, &factor) in row.iter().enumerate().filter(|(_, factor)| **factor != 0.0) {
                    let own = ranges[k];
                    // What the others leave to this one, above its least contribution.
                    let room = (limit + slack - least) / factor.abs();
                    let (mut lower, mut upper) = (own.lower, own.upper);
                    if factor > 0.0 {
                        upper = upper.min(own.lower + room);
                    } else {
                        lower = lower.max(own.upper - room);
                    }
                    if k >= self.ranges.len() {
                        (lower, upper) = ((lower - 1e-6).ceil(), (upper + 1e-6).floor());
                    }
                    if lower > upper {
                        return false;
                    }
                    let gain = (own.width() - (upper - lower)) > 1e-3 * own.width();
                    if gain {
                        ranges[k] = Interval::new(lower, upper);
                        is_changed = true;
                        break;
                    }
                }
            }
            if !is_changed {
                break;
            }
        }
        true
    }

    /// The inequalities that are left for values of the binaries.
    pub(super) fn leaf(&self, binaries: &[bool]) -> Leaf {
        let count = self.ranges.len();
        let values: Vec<f64> = binaries.iter().map(|&b| f64::from(u8::from(b))).collect();
        let rows = self
            .rows
            .iter()
            .zip(&self.limits)
            .map(|(row, limit)| (row[..count].to_vec(), limit - dot(&row[count..], &values)));
        Leaf { rows: rows.collect(), ranges: self.ranges.clone() }
    }
}

impl Leaf {
    /// The auxiliaries as affine functions of states and inputs, constants last, if opposite
    /// inequalities determine all of them. `known` is the number of states and inputs.
    pub(super) fn auxiliaries(&self, known: usize) -> Option<Vec<Vec<f64>>> {
        let count = self.ranges.len() - known;
        let mut equations: Vec<Vec<f64>> = self.equalities();
        for k in 0..count {
            // Gauss and Jordan, with the largest pivot among the rows that are left.
            let pivot = (k..equations.len()).max_by(|&a, &b| {
                equations[a][known + k].abs().total_cmp(&equations[b][known + k].abs())
            })?;
            let largest = largest_magnitude(&equations[pivot]);
            if equations[pivot][known + k].abs() <= EQUAL * largest {
                return None;
            }
            equations.swap(k, pivot);
            let factor = equations[k][known + k];
            equations[k].iter_mut().for_each(|entry| *entry /= factor);
            let own = equations[k].clone();
            for (_, row) in equations.iter_mut().enumerate().filter(|(other, _)| *other != k) {
                let factor = row[known + k];
                row.iter_mut().zip(&own).for_each(|(entry, own)| *entry -= factor * own);
            }
        }
        let solved = equations.iter().take(count).map(|row| {
            // row . (x, u) + z_k = limit.
            let mut function: Vec<f64> = row[..known].iter().map(|entry| -entry).collect();
            function.push(row.last().copied().unwrap_or(0.0));
            function
        });
        Some(solved.collect())
    }

    /// Rows that hold with equality, limits last: pairs of opposite rows.
    fn equalities(&self) -> Vec<Vec<f64>> {
        let mut found = Vec::new();
        for (k, (row, limit)) in self.rows.iter().enumerate() {
            let is_opposite = |(other, end): &(Vec<f64>, f64)| {
                let gap = (limit + end).abs();
                gap <= EQUAL * limit.abs().max(1.0)
                    && row.iter().zip(other).all(|(a, b)| (a + b).abs() <= EQUAL * a.abs())
            };
            if row.iter().any(|&entry| entry != 0.0) && self.rows[k + 1..].iter().any(is_opposite) {
                found.push(row.iter().chain([limit]).copied().collect());
            }
        }
        found
    }

    /// The guards over (x, u, z) that do not hold everywhere.
    pub(super) fn needed(&self, all: &Rows) -> Vec<Guard> {
        let rows = self.rows.iter().enumerate().map(|(k, (row, limit))| (k, row.clone(), *limit));
        rows.filter(|(_, row, limit)| is_needed(row, *limit, &all.ranges)).collect()
    }

    /// The guards over (x, u) that do not hold everywhere, with the auxiliaries put in.
    pub(super) fn without_auxiliaries(
        &self,
        all: &Rows,
        solution: &[Vec<f64>],
        known: usize,
    ) -> Vec<Guard> {
        let mut guards: Vec<Guard> = Vec::new();
        let mut add = |number: usize, row: &[f64], limit: f64| {
            let mut normal = row[..known].to_vec();
            let mut limit = limit;
            let mut largest = row.iter().fold(limit.abs(), |a, b| a.max(b.abs()));
            for (factor, function) in row[known..].iter().zip(solution) {
                for (entry, own) in normal.iter_mut().zip(function) {
                    *entry += factor * own;
                    largest = largest.max((factor * own).abs());
                }
                limit -= factor * function.last().copied().unwrap_or(0.0);
            }
            // What cancels, but for rounding.
            for entry in normal.iter_mut().filter(|entry| entry.abs() <= 1e-13 * largest) {
                *entry = 0.0;
            }
            let known_ranges = &all.ranges[..known];
            let is_new = !guards.iter().any(|(_, own, end)| *own == normal && *end <= limit);
            if is_new && is_needed(&normal, limit, known_ranges) {
                guards.push((number, normal, limit));
            }
        };
        for (k, (row, limit)) in self.rows.iter().enumerate() {
            add(k, row, *limit);
        }
        for (k, range) in self.ranges.iter().enumerate().skip(known) {
            for (sign, end) in [(1.0, range.upper), (-1.0, -range.lower)] {
                let row: Vec<f64> =
                    (0..self.ranges.len()).map(|j| if j == k { sign } else { 0.0 }).collect();
                add(self.rows.len(), &row, end);
            }
        }
        guards
    }
}

/// Whether an inequality does not hold in the whole box.
fn is_needed(row: &[f64], limit: f64, ranges: &[Interval]) -> bool {
    let most = range(row, ranges).upper;
    most > limit + EQUAL * limit.abs().max(1.0)
}
