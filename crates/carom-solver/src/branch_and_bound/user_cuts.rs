//! Cuts by the user: rows that tighten the root.

use super::refusals::Refusals;
use super::row_rounds::RowRounds;
use super::rows::{CUT, is_violated, row_name, with_rows, wrong_cut};
use super::solve::{EarlierResults, Solve};
use crate::error::Error;
use crate::model::Model;
use crate::reformulate::relaxed;
use crate::search::SearchResult;
use crate::solution::{Point, Termination};
use crate::solver::{Control, RowSource};

/// Most times that the root is relaxed and shown.
const MOST_PASSES: usize = 200;

/// Least lift of the bound by a pass that is not idle, relative, and most idle passes in a row.
const LEAST_LIFT: f64 = 1e-4;
const MOST_IDLE: usize = 5;

impl RowRounds<'_> {
    /// Relaxes the root of a model, shows it, and adds the cuts that are returned and violated,
    /// until there are none. Every cut is compared with points that are known.
    pub(super) fn separate(&mut self, model: &Model, source: &RowSource<'_>) -> Result<(), Error> {
        let (mut best, mut idle) = (f64::NEG_INFINITY, 0);
        for _ in 0..MOST_PASSES {
            let found = self.relax(&relaxed(&with_rows(model, CUT, &self.cuts)?)?)?;
            self.statistics.add_nested(&found.statistics);
            let values = found.points.into_iter().next();
            let Some(values) = values.filter(|_| found.termination == Termination::Optimal) else {
                break;
            };
            let lifted = found.bound - best > LEAST_LIFT * best.abs().max(1.0);
            idle = if lifted { 0 } else { idle + 1 };
            best = best.max(found.bound);
            if idle >= MOST_IDLE {
                break;
            }
            let own = values.into_iter().take(model.variable_count()).collect();
            let point = Point::new(model, own)?;
            let before = self.cuts.len();
            for row in source(&point)? {
                let row = model.stored_row(row, &row_name(CUT, self.cuts.len()))?;
                let is_new = !self.cuts[before..].contains(&row);
                if is_new && is_violated(model, &row, &point, self.options.feasibility) {
                    self.cuts.push(row);
                }
            }
            if self.cuts.len() == before {
                break;
            }
            self.statistics.user_cuts += (self.cuts.len() - before) as u64;
            let wrong = self.points.iter().find_map(|point| wrong_cut(model, &self.cuts, point));
            wrong.map_or(Ok(()), Err)?;
        }
        Ok(())
    }

    /// Solves a model without integers.
    fn relax(&self, model: &Model) -> Result<SearchResult, Error> {
        let mut options = self.options.nested();
        options.node_limit = None;
        let options = &options;
        let (token, cascades, refusals) = (self.token, &self.cascades, &Refusals::default());
        let solve = Solve { model, options, token, cascades, refusals, rows: None };
        Ok(solve.run(&EarlierResults::default(), &mut Control::default())?.found)
    }
}
