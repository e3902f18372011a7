//! Implications of a binary's values beyond propagation.
//!
//! Probing a binary at both values shows what follows from each. What follows from both for an
//! integral column always holds. If `a` implies `b` by propagation, "not `b`" implies "not `a`",
//! which propagation often does not find; a table keeps these implications.

use super::domain::Domain;
use super::implications::Implications;
use super::propagation::{Conflict, Propagator};
use crate::program::Program;
use crate::solver::StopToken;

/// Most implied literals that are noted while the table is made.
const NOTED: usize = 2_000_000;

/// Probes columns in the given order at both values; `domain` keeps what follows from both
/// for integral columns.
///
/// # Arguments
///
/// * `trials`: most values that are tried.
/// * `token`: asked before every trial; what is known when it is over is kept.
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
) -> Result<Implications, Conflict> {
    let mut noted: Vec<Option<Vec<usize>>> = vec![None; 2 * program.column_count()];
    let mut size = 0;
    for &j in columns {
        if trials < 2 || size > NOTED || token.is_over() {
            break;
        }
        if !is_open(program, domain, j) {
            continue;
        }
        trials -= 2;
        let mut sides: [Option<Vec<Bounds>>; 2] = [None, None];
        for (value, side) in sides.iter_mut().enumerate() {
            let mark = domain.mark();
            domain.apply(j, value == 0, value as f64);
            if propagator.propagate_since(program, domain, mark).is_ok() {
                *side = Some(changes(domain, mark));
            }
            domain.undo_to(mark);
        }
        let mark = domain.mark();
        match sides {
            [None, None] => return Err(Conflict::Column(j)),
            [Some(_), None] => domain.apply(j, true, 0.0),
            [None, Some(_)] => domain.apply(j, false, 1.0),
            [Some(off), Some(on)] => {
                join(program, domain, &off, &on);
                for (value, side) in [off, on].into_iter().enumerate() {
                    let fixed = side.iter().filter(|b| {
                        b.column != j
                            && b.bounds[0] == b.bounds[1]
                            && is_open(program, domain, b.column)
                    });
                    let mut literals: Vec<usize> =
                        fixed.map(|b| 2 * b.column + usize::from(b.bounds[0] == 1.0)).collect();
                    literals.sort_unstable();
                    size += literals.len();
                    noted[2 * j + value] = Some(literals);
                }
            }
        }
        propagator.propagate_since(program, domain, mark)?;
    }
    Ok(Implications::contraposed(&noted, token))
}

/// Bounds of a column in one branch.
pub(super) struct Bounds {
    pub(super) column: usize,
    pub(super) bounds: [f64; 2],
}

fn is_open(program: &Program, domain: &Domain, j: usize) -> bool {
    program.integral[j] && domain.bounds(j) == [0.0, 1.0]
}

/// The columns that changed since a mark, sorted, with their bounds.
pub(super) fn changes(domain: &Domain, mark: usize) -> Vec<Bounds> {
    let mut columns: Vec<usize> = domain.changed_since(mark).map(|(j, _)| j).collect();
    columns.sort_unstable();
    columns.dedup();
    columns.into_iter().map(|column| Bounds { column, bounds: domain.bounds(column) }).collect()
}

/// Keeps what holds of integral columns in both branches.
fn join(program: &Program, domain: &mut Domain, off: &[Bounds], on: &[Bounds]) {
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
