//! Whole values where the relaxed point leaves a choice.
//!
//! An interior-point method ends in the middle of the best points: a binary without a cost comes
//! out near one half wherever its rows leave it any room, although 0 or 1 would do at the same
//! point of the dynamics. Branching on it would change nothing. Here such binaries get whole
//! values, group after group ("exactly one mode", "at least one side"), while all of their rows still
//! hold; what stays fractional is what the point really violates. In violated groups, single columns
//! get whole values where they can.

use crate::presolve::Domain;
use crate::program::Program;

/// By how much, relative to its largest term, a row may be missed (no unit). The point only guides
/// the search, nothing is concluded from it.
const MISS: f64 = 1e-6;

/// The choice of no column of a group.
const NONE: usize = usize::MAX;

/// Most columns of a group.
const LARGEST: usize = 8;

/// The groups of a program: rows over a few binaries with equal coefficients that want one of them.
pub(super) fn groups(program: &Program) -> Vec<Vec<usize>> {
    let binary =
        |j: usize| program.integral[j] && program.lower[j] >= 0.0 && program.upper[j] <= 1.0;
    let group = |row: usize| {
        let (columns, values) = program.row(row);
        let first = *values.first()?;
        let equal = values.iter().all(|&a| a == first) && columns.iter().all(|&j| binary(j));
        let wants_one = program.row_lower[row] == first || program.row_upper[row] == first;
        ((2..=LARGEST).contains(&columns.len()) && equal && wants_one).then(|| columns.to_vec())
    };
    (0..program.row_count()).filter_map(group).collect()
}

/// Gives binaries whole values where the rows allow it at the rest of the point.
pub(super) fn purify(
    program: &Program,
    domain: &Domain,
    groups: &[Vec<usize>],
    integrality: f64,
    point: &mut [f64],
) {
    let fractional = |j: usize, point: &[f64]| (point[j] - point[j].round()).abs() > integrality;
    let free = |j: usize| program.linear[j] == 0.0 && program.quadratic_column(j).0.is_empty();
    for group in groups {
        if !group.iter().any(|&j| fractional(j, point)) || !group.iter().all(|&j| free(j)) {
            continue;
        }
        let old: Vec<f64> = group.iter().map(|&j| point[j]).collect();
        let mut order: Vec<usize> = (0..group.len()).collect();
        order.sort_by(|&a, &b| old[b].total_cmp(&old[a]).then(a.cmp(&b)));
        // One of them, or none where that is enough.
        let fits = order.into_iter().chain([NONE]).any(|chosen| {
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
    }
    for &j in groups.iter().flatten() {
        if domain.is_fixed(j) || !free(j) || !fractional(j, point) {
            continue;
        }
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
        let miss = MISS * scale;
        sum >= program.row_lower[row] - miss && sum <= program.row_upper[row] + miss
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Model;

    /// Two modes, left of 4 and right of 3; both rows leave the binaries room between.
    #[test]
    fn only_what_is_violated_stays_fractional() {
        let mut model = Model::new("modes");
        let x = model.continuous("x", 0.0, 10.0).unwrap();
        let (left, right) = (model.binary("left").unwrap(), model.binary("right").unwrap());
        model.add("l", (x + 8.0 * left).le(10.0)).unwrap();
        model.add("r", (x - 7.0 * right).ge(0.0)).unwrap();
        model.add("one", (left + right).equals(1.0)).unwrap();
        let program = Program::assemble(&model).unwrap();
        let (domain, groups) = (Domain::new(&program), groups(&program));
        let purified = |x: f64| {
            let mut point = vec![x, 0.5, 0.5];
            purify(&program, &domain, &groups, 1e-6, &mut point);
            point
        };
        assert_eq!(purified(1.0), [1.0, 1.0, 0.0]);
        assert_eq!(purified(8.0), [8.0, 0.0, 1.0]);
        assert_eq!(purified(5.0), [5.0, 0.5, 0.5]);
    }
}
