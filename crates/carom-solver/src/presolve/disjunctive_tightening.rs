//! Disjunctive bound tightening (constructive disjunction) over covering rows.
//!
//! Takes covering rows; leaves the bounds that hold in all of their cases, and coefficients to
//! match (Van Hentenryck, Saraswat and Deville, Design, implementation, and evaluation of the
//! constraint language cc(FD), Journal of Logic Programming 37, 1998).
//!
//! A row `z_1 + ... + z_k >= 1` over binaries means that at least one of `k` cases applies. Each
//! case is propagated on trial. Infeasible cases are excluded, and the hull of the bounds in the
//! other cases is valid. In a piecewise-affine system these hulls are boxes around the states that
//! each step can reach, whereas plain propagation sees only rows that may be switched off. The
//! big-Ms shrink with the boxes.

use std::ops::RangeInclusive;

use super::coefficients::{Columns, round_limits, tighten_terms};
use super::domain::Domain;
use super::implication_probing::{ColumnBounds, write_changes};
use super::propagation::{Conflict, Propagator};
use crate::mutations::{self, Mutation};
use crate::program::Program;
use crate::solver::StopToken;
use crate::tolerance::largest_magnitude;

/// The largest number of trials. A trial propagates the rows that it reaches.
pub(crate) const MAX_CASE_TRIALS: usize = 4000;

/// The largest number of rounds over all disjunctions.
const MAX_CASE_ROUNDS: usize = 4;

/// The numbers of cases of the disjunctions that are tried.
pub(crate) const CASE_COUNTS: RangeInclusive<usize> = 2..=12;

/// The largest number of passes that tighten a row.
const MAX_ROW_PASSES: usize = 30;

/// The smallest move of a bound that is used, as a fraction of the width between the bounds.
const MIN_HULL_GAIN: f64 = 0.01;

/// Tightens bounds by covering rows, and big-Ms to match; returns `None` if no bound moves, or if
/// there is no point.
///
/// Columns and rows keep their numbers, and no point with whole integral columns is lost.
pub fn tighten_by_disjunctions(program: &Program, token: &StopToken) -> Option<Program> {
    let disjunctions = covering_rows(program, &CASE_COUNTS);
    if disjunctions.is_empty() {
        return None;
    }
    let mut domain = Domain::new(program);
    let mut propagator = Propagator::new(program);
    propagator.set_stop_token(token);
    // If the bounds contradict each other, the search reports it.
    propagator.propagate_all(program, &mut domain).ok()?;
    let gained = gain(program, &mut domain, &mut propagator, &disjunctions, token).ok()?;
    if gained == 0 {
        return None;
    }
    let mut tight = program.clone();
    for j in 0..program.column_count() {
        [tight.lower[j], tight.upper[j]] = domain.bounds(j);
    }
    tighten_rows(&mut tight)?;
    Some(tight)
}

/// Tightens the rows of a program to its bounds; `None` if no whole point satisfies one of them, or
/// if they cannot be allocated.
pub(crate) fn tighten_rows(program: &mut Program) -> Option<()> {
    let columns =
        Columns { lower: &program.lower, upper: &program.upper, integral: &program.integral };
    let mut limits = Vec::with_capacity(program.row_count());
    let mut entries = Vec::with_capacity(program.rows.compute_nnz());
    let mut terms = Vec::new();
    let mut moved = false;
    for row in 0..program.row_count() {
        let (index, values) = program.row(row);
        let mut own = [program.row_lower[row], program.row_upper[row]];
        terms.clear();
        terms.extend(index.iter().copied().zip(values.iter().copied()));
        let finite = own.iter().filter(|limit| limit.is_finite());
        let noise = f64::EPSILON * largest_magnitude(finite);
        for _ in 0..MAX_ROW_PASSES {
            if terms.len() < 2 {
                break;
            }
            let tight = tighten_terms(&mut terms, own, columns, noise);
            own = tight.unwrap_or(own);
            terms.retain(|(_, a)| *a != 0.0);
            let mut moves = tight.is_some();
            if let Some((limits, news)) = round_limits(&terms, own, columns, noise) {
                if limits[0] > limits[1] {
                    return None;
                }
                own = limits;
                moves |= news;
            }
            if !moves {
                break;
            }
            moved = true;
        }
        limits.push(own);
        entries.extend(terms.iter().map(|&(j, a)| (row, j, a)));
    }
    if moved { program.replace_rows(entries.into_iter(), &limits) } else { Some(()) }
}

/// The covering rows, which ask for at least one of their binaries; `sizes` says how many columns a
/// row may have.
pub(crate) fn covering_rows(program: &Program, sizes: &RangeInclusive<usize>) -> Vec<usize> {
    let is_binary =
        |j: usize| program.integral[j] && program.lower[j] >= 0.0 && program.upper[j] <= 1.0;
    let covers = |&row: &usize| {
        let (columns, values) = program.row(row);
        let Some(&first) = values.first() else { return false };
        let alike = values.iter().all(|&a| a == first) && columns.iter().all(|&j| is_binary(j));
        let limit = if first > 0.0 { program.row_lower[row] } else { program.row_upper[row] };
        sizes.contains(&columns.len()) && alike && limit == first
    };
    (0..program.row_count()).filter(covers).collect()
}

/// Tries the cases of all disjunctions until no bound moves; returns how many moved.
fn gain(
    program: &Program,
    domain: &mut Domain,
    propagator: &mut Propagator,
    disjunctions: &[usize],
    token: &StopToken,
) -> Result<usize, Conflict> {
    let (mut gained, mut trials) = (0, 0);
    let (mut shared, mut changed): (Vec<ColumnBounds>, Vec<ColumnBounds>) =
        (Vec::new(), Vec::new());
    for _ in 0..MAX_CASE_ROUNDS {
        let before = gained;
        for &row in disjunctions {
            let columns = program.row(row).0;
            if columns.iter().any(|&j| domain.lower(j) == 1.0) {
                continue;
            }
            let mut has_case = false;
            shared.clear();
            for &j in columns.iter() {
                if domain.lower(j) == 1.0 && !mutations::has(Mutation::ExcludedCase) {
                    // Excluding the others has selected this case, so the hull of the others is
                    // void.
                    shared.clear();
                    break;
                }
                if domain.is_fixed(j) {
                    continue;
                }
                trials += 1;
                if trials > MAX_CASE_TRIALS || token.is_over() {
                    return Ok(gained);
                }
                let mark = domain.mark();
                domain.apply(j, false, 1.0);
                let case = propagator.propagate_since(program, domain, mark);
                if case.is_ok() {
                    let sides = domain.changed_since(mark);
                    write_changes(sides, |j| domain.bounds(j), &mut changed);
                }
                domain.undo_to(mark);
                if case.is_err() {
                    domain.apply(j, true, 0.0);
                    gained += 1;
                    propagator.propagate_since(program, domain, mark)?;
                } else if std::mem::replace(&mut has_case, true) {
                    narrow_to_hull(&mut shared, &changed);
                } else {
                    std::mem::swap(&mut shared, &mut changed);
                }
            }
            let mark = domain.mark();
            for ColumnBounds { column, bounds } in shared.drain(..) {
                gained += apply(domain, column, bounds);
            }
            propagator.propagate_since(program, domain, mark)?;
        }
        if gained == before {
            break;
        }
    }
    Ok(gained)
}

/// Becomes the hull of the bounds in two cases, for the columns that changed in both.
pub(crate) fn narrow_to_hull(shared: &mut Vec<ColumnBounds>, other: &[ColumnBounds]) {
    let mut other = other.iter().peekable();
    shared.retain_mut(|a| {
        while other.next_if(|b| b.column < a.column).is_some() {}
        let Some(b) = other.next_if(|b| b.column == a.column) else { return false };
        a.bounds = [a.bounds[0].min(b.bounds[0]), a.bounds[1].max(b.bounds[1])];
        true
    });
}

/// Moves the bounds of a column that gain enough; returns how many.
fn apply(domain: &mut Domain, column: usize, [lower, upper]: [f64; 2]) -> usize {
    let [old_lower, old_upper] = domain.bounds(column);
    let width = old_upper - old_lower;
    let worth = |moved: f64| moved > 0.0 && (!width.is_finite() || moved > MIN_HULL_GAIN * width);
    let mut moved = 0;
    if worth(lower - old_lower) {
        domain.apply(column, false, lower);
        moved += 1;
    }
    if worth(old_upper - upper) {
        domain.apply(column, true, upper);
        moved += 1;
    }
    moved
}
