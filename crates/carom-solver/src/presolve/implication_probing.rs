//! Implications of a binary's values beyond propagation.
//!
//! Takes binaries; leaves bounds that hold at both of their values, and a table of implications
//! between them (Atamtürk, Nemhauser and Savelsbergh, Conflict graphs in solving integer
//! programming problems, European Journal of Operational Research 121, 2000).
//!
//! Probing a binary at both values shows what follows from each. What follows from both for an
//! integral column always holds. If `a` implies `b` by propagation, "not `b`" implies "not `a`",
//! which propagation often does not find; a table keeps these implications.

use super::domain::Domain;
use super::implications::{ImplicationGraph, NotedImplications};
use super::propagation::{Conflict, Propagator};
use crate::program::Program;
use crate::solver::StopToken;

/// The largest number of implied literals that are noted while the table is made.
const MAX_NOTED_LITERALS: usize = 2_000_000;

/// Probes columns in the given order at both values; `domain` keeps what follows from both
/// for integral columns.
///
/// # Arguments
///
/// * `trials`: most values that are tried.
/// * `token`: checked before every trial; conclusions until then are kept.
///
/// # Errors
///
/// The `Conflict` that proves the domain empty.
pub fn probe_implications(
    program: &Program,
    domain: &mut Domain,
    propagator: &mut Propagator,
    columns: &[usize],
    mut trials: usize,
    token: &StopToken,
) -> Result<ImplicationGraph, Conflict> {
    let mut noted = NotedImplications::new(2 * program.column_count());
    let mut sides = [const { Vec::new() }; 2];
    for &j in columns {
        if trials < 2 || noted.count() > MAX_NOTED_LITERALS || token.is_over() {
            break;
        }
        if !is_open(program, domain, j) {
            continue;
        }
        trials -= 2;
        let mut possible = [false; 2];
        for (value, side) in sides.iter_mut().enumerate() {
            let mark = domain.mark();
            domain.apply(j, value == 0, value as f64);
            possible[value] = propagator.propagate_since(program, domain, mark).is_ok();
            if possible[value] {
                write_changes(domain.changed_since(mark), |j| domain.bounds(j), side);
            }
            domain.undo_to(mark);
        }
        let mark = domain.mark();
        match possible {
            [false, false] => return Err(Conflict::Column(j)),
            [true, false] => domain.apply(j, true, 0.0),
            [false, true] => domain.apply(j, false, 1.0),
            [true, true] => {
                join(program, domain, &sides[0], &sides[1]);
                for (value, side) in sides.iter().enumerate() {
                    let fixed = side.iter().filter(|b| {
                        b.column != j
                            && b.bounds[0] == b.bounds[1]
                            && is_open(program, domain, b.column)
                    });
                    // By column, so by literal.
                    let literals = fixed.map(|b| 2 * b.column + usize::from(b.bounds[0] == 1.0));
                    noted.note(2 * j + value, literals);
                }
            }
        }
        propagator.propagate_since(program, domain, mark)?;
    }
    Ok(noted.contrapositions(token))
}

/// Bounds of a column in one branch.
pub(crate) struct ColumnBounds {
    pub(crate) column: usize,
    pub(crate) bounds: [f64; 2],
}

fn is_open(program: &Program, domain: &Domain, j: usize) -> bool {
    program.integral[j] && domain.bounds(j) == [0.0, 1.0]
}

/// Writes the columns whose sides have changed, sorted, with their bounds.
pub(crate) fn write_changes(
    sides: impl Iterator<Item = (usize, bool)>,
    bounds: impl Fn(usize) -> [f64; 2],
    changes: &mut Vec<ColumnBounds>,
) {
    changes.clear();
    changes.extend(sides.map(|(column, _)| ColumnBounds { column, bounds: bounds(column) }));
    changes.sort_unstable_by_key(|change| change.column);
    changes.dedup_by_key(|change| change.column);
}

/// Keeps what holds of integral columns in both branches.
fn join(program: &Program, domain: &mut Domain, off: &[ColumnBounds], on: &[ColumnBounds]) {
    let (mut p, mut q) = (0, 0);
    while let (Some(a), Some(b)) = (off.get(p), on.get(q)) {
        if a.column == b.column && program.integral[a.column] {
            let (j, [lower, upper]) = (a.column, domain.bounds(a.column));
            let joined = [a.bounds[0].min(b.bounds[0]), a.bounds[1].max(b.bounds[1])];
            if joined[0] > lower {
                domain.apply(j, false, joined[0]);
            }
            if joined[1] < upper {
                domain.apply(j, true, joined[1]);
            }
        }
        (p, q) = (p + usize::from(a.column <= b.column), q + usize::from(b.column <= a.column));
    }
}
