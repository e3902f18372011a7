//! Indifferent binaries: integral values where the relaxed point leaves a choice.
//!
//! An interior-point method ends in the middle of the optimal face: a binary without a cost is near
//! one half wherever its rows leave room, although 0 or 1 would be feasible with the same dynamics.
//! Branching on it would change nothing. Here such binaries get integral values, group after group
//! ("exactly one mode", "at least one side"), while all of their rows still hold. What stays
//! fractional is what the point really violates. It moves as far as the rows allow, as at a vertex:
//! up for the likeliest binary of a group that needs one, otherwise towards the nearest integer.

use crate::presolve::Domain;
use crate::program::Program;

/// By how much, relative to its largest term, a row may be missed (no unit). The point only guides
/// the search, nothing is concluded from it; points of trials are known to 1e-5.
const ROW_MISS: f64 = 1e-5;

/// The choice of no column of a group.
const NO_COLUMN: usize = usize::MAX;

/// Most columns of a group.
const LARGEST_GROUP: usize = 8;

/// Binaries of which at most, at least, or exactly one is to be 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BinaryGroup {
    /// Its columns, and how many they are.
    all: [usize; LARGEST_GROUP],
    count: usize,
    /// Whether one of them must be 1.
    wants_one: bool,
}

impl BinaryGroup {
    fn columns(&self) -> &[usize] {
        &self.all[..self.count]
    }
}

/// The groups of a program: rows over a few binaries with equal coefficients.
pub fn groups(program: &Program) -> Vec<BinaryGroup> {
    let group = |row: usize| {
        let (columns, values) = program.row(row);
        let first = *values.first()?;
        let alike =
            values.iter().all(|&a| a == first) && columns.iter().all(|&j| is_binary(program, j));
        let limits = [program.row_lower[row], program.row_upper[row]];
        let found =
            (2..=LARGEST_GROUP).contains(&columns.len()) && alike && limits.contains(&first);
        let wants_one = limits[usize::from(first < 0.0)] == first;
        found.then(|| {
            let mut all = [NO_COLUMN; LARGEST_GROUP];
            all[..columns.len()].copy_from_slice(columns);
            BinaryGroup { all, count: columns.len(), wants_one }
        })
    };
    (0..program.row_count()).filter_map(group).collect()
}

/// The binaries without a cost that are in no group and in no cone.
pub fn ungrouped_binaries(program: &Program, groups: &[BinaryGroup]) -> Vec<usize> {
    let mut ungrouped: Vec<bool> =
        (0..program.column_count()).map(|j| is_binary(program, j) && is_free(program, j)).collect();
    groups.iter().flat_map(BinaryGroup::columns).for_each(|&j| ungrouped[j] = false);
    program.integers.iter().copied().filter(|&j| ungrouped[j]).collect()
}

fn is_binary(program: &Program, j: usize) -> bool {
    program.integral[j] && program.lower[j] >= 0.0 && program.upper[j] <= 1.0
}

/// Whether a column has no cost and is in no cone, so that only its rows speak of it.
fn is_free(program: &Program, j: usize) -> bool {
    program.linear[j] == 0.0 && program.quadratic_column(j).0.is_empty() && !program.is_in_cone(j)
}

/// Gives binaries of groups whole values where the rows allow it at the rest of the point.
pub fn round_groups(
    program: &Program,
    domain: &Domain,
    groups: &[BinaryGroup],
    integrality: f64,
    point: &mut [f64],
) {
    let fractional = |j: usize, point: &[f64]| is_fractional(point[j], integrality);
    for group in groups {
        let columns = group.columns();
        let open = columns.iter().any(|&j| fractional(j, point));
        if !open || !columns.iter().all(|&j| is_free(program, j)) {
            continue;
        }
        if !choose_one(program, domain, columns, point) {
            for &j in columns.iter().filter(|&&j| !domain.is_fixed(j)) {
                if fractional(j, point) {
                    round(program, domain, j, point);
                }
            }
        }
        if columns.iter().any(|&j| fractional(j, point)) {
            if group.wants_one {
                raise_one(program, domain, columns, point);
            } else {
                shift_to_integers(program, domain, columns, integrality, point);
            }
        }
    }
}

/// Moves binaries to the end that is nearest to a whole value, one after the other.
pub fn shift_to_integers(
    program: &Program,
    domain: &Domain,
    columns: &[usize],
    integrality: f64,
    point: &mut [f64],
) {
    for &j in columns {
        if domain.is_fixed(j) || !is_fractional(point[j], integrality) {
            continue;
        }
        let down = point[j] - room(program, domain, &[(j, -1.0)], point);
        let up = point[j] + room(program, domain, &[(j, 1.0)], point);
        let away = |value: f64| (value - value.round()).abs();
        point[j] = if away(down) <= away(up) { down } else { up };
    }
}

fn is_fractional(value: f64, integrality: f64) -> bool {
    (value - value.round()).abs() > integrality
}

/// Sets one column of a group to 1 and the others to 0, or all to 0; `false`, and nothing changed,
/// where the rows allow none of that.
fn choose_one(program: &Program, domain: &Domain, group: &[usize], point: &mut [f64]) -> bool {
    let (old, order) = ranked(group, point);
    let fits = order[..group.len()].iter().chain([&NO_COLUMN]).any(|&chosen| {
        for (k, &j) in group.iter().enumerate() {
            point[j] = f64::from(u8::from(k == chosen));
        }
        let inside =
            group.iter().all(|&j| domain.lower(j) <= point[j] && point[j] <= domain.upper(j));
        inside && group.iter().all(|&j| holds(program, j, point))
    });
    if !fits {
        group.iter().zip(old).for_each(|(&j, value)| point[j] = value);
    }
    fits
}

/// The values of the columns of a group.
fn values_of(group: &[usize], point: &[f64]) -> [f64; LARGEST_GROUP] {
    let mut values = [0.0; LARGEST_GROUP];
    values.iter_mut().zip(group).for_each(|(value, &j)| *value = point[j]);
    values
}

/// The values of the columns of a group, and their places by value, the largest first.
fn ranked(group: &[usize], point: &[f64]) -> ([f64; LARGEST_GROUP], [usize; LARGEST_GROUP]) {
    let (values, mut order) = (values_of(group, point), std::array::from_fn(|k| k));
    order[..group.len()]
        .sort_unstable_by(|&a: &usize, &b: &usize| values[b].total_cmp(&values[a]).then(a.cmp(&b)));
    (values, order)
}

/// Sets a column to the whole value below or above it, where the rows allow that.
fn round(program: &Program, domain: &Domain, j: usize, point: &mut [f64]) {
    let old = point[j];
    let near = old.round();
    let other = if near > old { near - 1.0 } else { near + 1.0 };
    let fits = [near, other].into_iter().any(|value| {
        point[j] = value;
        domain.lower(j) <= value && value <= domain.upper(j) && holds(program, j, point)
    });
    if !fits {
        point[j] = old;
    }
}

/// Raises the column of a group that can be raised most. The others go down as far as they can.
fn raise_one(program: &Program, domain: &Domain, group: &[usize], point: &mut [f64]) {
    let (old, order) = ranked(group, point);
    let order = &order[..group.len()];
    let mut best: Option<(f64, [f64; LARGEST_GROUP])> = None;
    for &k in order {
        let j = group[k];
        point[j] += room(program, domain, &[(j, 1.0)], point);
        let others = || order.iter().rev().map(|&k| group[k]).filter(|&other| other != j);
        for other in others() {
            let step = room(program, domain, &[(j, 1.0), (other, -1.0)], point);
            point[j] += step;
            point[other] -= step;
        }
        for other in others() {
            point[other] -= room(program, domain, &[(other, -1.0)], point);
        }
        if best.as_ref().is_none_or(|(most, _)| point[j] > *most + ROW_MISS) {
            best = Some((point[j], values_of(group, point)));
        }
        group.iter().zip(&old).for_each(|(&j, &value)| point[j] = value);
    }
    if let Some((_, values)) = best {
        group.iter().zip(values).for_each(|(&j, value)| point[j] = value);
    }
}

/// The distance that a point can go in a direction until a bound or a row of its columns binds.
fn room(program: &Program, domain: &Domain, direction: &[(usize, f64)], point: &[f64]) -> f64 {
    let mut most = f64::INFINITY;
    for &(j, sign) in direction {
        let bound =
            if sign > 0.0 { domain.upper(j) - point[j] } else { point[j] - domain.lower(j) };
        most = most.min(bound);
    }
    for &row in direction.iter().flat_map(|&(j, _)| program.column(j).0) {
        let (columns, values) = program.row(row);
        let (mut sum, mut slope) = (0.0, 0.0);
        for (&k, &a) in columns.iter().zip(values) {
            sum += a * point[k];
            slope += direction.iter().filter(|d| d.0 == k).map(|d| a * d.1).sum::<f64>();
        }
        let limit = if slope > 0.0 { program.row_upper[row] } else { program.row_lower[row] };
        if slope != 0.0 {
            most = most.min((limit - sum) / slope);
        }
    }
    if most.is_finite() { most.max(0.0) } else { 0.0 }
}

/// Whether all rows of a column hold.
fn holds(program: &Program, j: usize, point: &[f64]) -> bool {
    program.column(j).0.iter().all(|&row| {
        let (columns, values) = program.row(row);
        let (mut sum, mut scale) = (0.0, 1.0_f64);
        for (&k, &a) in columns.iter().zip(values) {
            sum += a * point[k];
            scale = scale.max((a * point[k]).abs());
        }
        let miss = ROW_MISS * scale;
        sum >= program.row_lower[row] - miss && sum <= program.row_upper[row] + miss
    })
}
