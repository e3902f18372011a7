//! Cuts by the user: rows that tighten the root.

use super::pipeline::Pipeline;
use super::refusals::Refusals;
use super::rows::{CUT, is_violated, row_name, with_rows, wrong_cut};
use crate::error::Error;
use crate::model::{Model, StoredRow};
use crate::relaxation::LadderPool;
use crate::search::{ColumnGuidance, Found};
use crate::solution::{Point, Statistics, Termination};
use crate::solver::{Control, Guidance, Options, RowSource, StopToken};

/// Most times that the root is relaxed and shown.
const PASSES: usize = 200;

/// A pass that lifts the bound by less than this, relative, is idle; so many idle ones in a row are the
/// last.
const LIFT: f64 = 1e-4;
const IDLE: usize = 5;

/// The options and methods for relaxing the root.
#[derive(Clone, Copy)]
pub(super) struct Relaxing<'a> {
    pub(super) options: &'a Options,
    pub(super) token: &'a StopToken,
    pub(super) ladders: &'a LadderPool,
}

impl Relaxing<'_> {
    /// Relaxes the root of a model, shows it, and adds the cuts that are returned and violated, until
    /// there are none. Every cut is compared with points that are known.
    pub(super) fn separate(
        &self,
        model: &Model,
        source: &RowSource<'_>,
        cuts: &mut Vec<StoredRow>,
        points: &[Point],
        statistics: &mut Statistics,
    ) -> Result<(), Error> {
        let (mut best, mut idle) = (f64::NEG_INFINITY, 0);
        for _ in 0..PASSES {
            let found = self.relax(&with_rows(model, CUT, cuts)?.relaxed()?)?;
            statistics.add_nested(&found.statistics);
            let values = found.points.into_iter().next();
            let Some(values) = values.filter(|_| found.termination == Termination::Optimal) else {
                break;
            };
            let lifted = found.bound - best > LIFT * best.abs().max(1.0);
            idle = if lifted { 0 } else { idle + 1 };
            best = best.max(found.bound);
            if idle >= IDLE {
                break;
            }
            let own = values.into_iter().take(model.variable_count()).collect();
            let point = Point::new(model, own)?;
            let before = cuts.len();
            for row in source(&point)? {
                let row = model.stored_row(row, &row_name(CUT, cuts.len()))?;
                let is_new = !cuts[before..].contains(&row);
                if is_new && is_violated(model, &row, &point, self.options.feasibility) {
                    cuts.push(row);
                }
            }
            if cuts.len() == before {
                break;
            }
            statistics.user_cuts += (cuts.len() - before) as u64;
            let wrong = points.iter().find_map(|point| wrong_cut(model, cuts, point));
            wrong.map_or(Ok(()), Err)?;
        }
        Ok(())
    }

    /// Solves a model without integers.
    fn relax(&self, model: &Model) -> Result<Found, Error> {
        let guidance = &ColumnGuidance::new(model, &Guidance::default())?;
        let options = &Options { node_limit: None, ..self.options.nested() };
        let Relaxing { token, ladders, .. } = *self;
        let (refusals, judge, seed) = (&Refusals::default(), None, None);
        let pipeline = Pipeline { model, options, token, guidance, ladders, refusals, judge, seed };
        Ok(pipeline.run(&mut Control::default())?.0)
    }
}
