//! The proof of an answer about a model with smooth functions.

use std::io::BufWriter;
use std::path::Path;

use super::proof::{cannot_write, create};
use crate::proof::{BoxProofRequest, Claim};
use crate::relaxation::CascadePool;
use crate::solution::{ProofReport, Termination};
use crate::solver::{Control, Event, Options, Progress, StopToken};
use crate::spatial::{SpatialProgram, SpatialResult};

/// Splits of a proof: the least limit, and as a multiple of the nodes of the search.
const LEAST_SPLITS: u64 = 20_000;
const SPLITS: u64 = 20;

/// Writes the proof of an answer; `None` if it claims nothing. A failure to write is part of the
/// report, because it makes the answer no worse.
pub(super) fn write_box_proof(
    path: &Path,
    (program, found): (&SpatialProgram, &SpatialResult),
    (options, search): (&Options, &StopToken),
    control: &mut Control<'_>,
) -> Option<ProofReport> {
    let stated = &program.program;
    let claim = match (found.termination, &found.best) {
        (Termination::Infeasible, _) => Claim::Infeasible,
        (_, best) if found.bound.is_finite() => {
            let best = best.as_ref().map_or(found.bound, |(_, value)| *value);
            let gap = options.allowed_gap(best, stated.constant);
            Claim::Bound(found.bound.min(best) - gap)
        }
        _ => return None,
    };
    let (sign, counts) = (stated.sign, &found.statistics);
    let best = found.best.as_ref().map(|(_, value)| sign * value);
    let (bound, elapsed) = (sign * found.bound, search.elapsed());
    let mut figures = Progress::new(counts.nodes, 0, counts.relaxations, best, bound, elapsed);
    (figures.iterations, figures.constant) = (counts.iterations, sign * stated.constant);
    control.report(&Event::Proving(figures));
    let token = &StopToken::new(options.time_limit, control.interrupt());
    let cascades = &CascadePool::new(options);
    let most_splits = LEAST_SPLITS.max(SPLITS * counts.nodes);
    let asked = BoxProofRequest { program, claim, options, token, most_splits, cascades };
    let point = found.best.as_ref().map(|(x, _)| {
        let mut x = x.clone();
        program.settle(&mut x);
        x
    });
    let written =
        create(path).and_then(|file| asked.prove(point.as_deref(), &mut BufWriter::new(file)));
    let failed = |error| ProofReport::failed(format!("{}: {error}", cannot_write(path)));
    Some(written.unwrap_or_else(failed))
}
