//! The judgement of points by rows that callbacks return while a search runs.

use std::sync::{Mutex, MutexGuard, PoisonError};

use super::rows::{LAZY, is_violated, row_name, wrong_cut};
use crate::error::Error;
use crate::model::{Model, StoredRow};
use crate::solution::Point;
use crate::solver::{Options, RowSource, StopToken};

/// Most accepted points that are kept for comparison with later cuts.
const MOST_POINTS: usize = 1000;

/// Judges the points of one search, which are points of the model.
pub(super) struct RowJudge<'a> {
    /// The model with the lazy constraints that were found before, and without cuts.
    model: &'a Model,
    lazy: Option<&'a RowSource<'a>>,
    /// The number of lazy constraints of the model.
    known: usize,
    cuts: &'a [StoredRow],
    feasibility: f64,
    /// Over once there is an error.
    token: &'a StopToken,
    noted: Mutex<Noted>,
}

/// The rows and points noted while the points of a search are judged.
#[derive(Default)]
pub(super) struct Noted {
    /// Lazy constraints, some of them perhaps twice.
    pub(super) rows: Vec<StoredRow>,
    /// Accepted points.
    pub(super) points: Vec<Point>,
    pub(super) error: Option<Error>,
}

impl<'a> RowJudge<'a> {
    pub(super) fn new(
        model: &'a Model,
        lazy: Option<&'a RowSource<'a>>,
        known: usize,
        cuts: &'a [StoredRow],
        options: &Options,
        token: &'a StopToken,
    ) -> Self {
        let (noted, feasibility) = (Mutex::default(), options.feasibility);
        RowJudge { model, lazy, known, cuts, feasibility, token, noted }
    }

    /// The model that points are verified against.
    pub(super) fn model(&self) -> &'a Model {
        self.model
    }

    /// Whether rows may be found that the model lacks.
    pub(super) fn expects_rows(&self) -> bool {
        self.lazy.is_some()
    }

    pub(super) fn has_new_rows(&self) -> bool {
        !self.lock().rows.is_empty()
    }

    pub(super) fn into_noted(self) -> Noted {
        self.noted.into_inner().unwrap_or_else(PoisonError::into_inner)
    }

    fn lock(&self) -> MutexGuard<'_, Noted> {
        self.noted.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Whether the rows that the callback returns for a verified point exclude it. A point that
    /// none excludes is compared with all cuts.
    pub(super) fn excludes(&self, point: &Point) -> bool {
        if self.lock().error.is_some() {
            return true;
        }
        let excluded = self.is_excluded(point).and_then(|excluded| match excluded {
            true => Ok(true),
            false => wrong_cut(self.model, self.cuts, point).map_or(Ok(false), Err),
        });
        match excluded {
            Ok(true) => true,
            Ok(false) => {
                let points = &mut self.lock().points;
                if points.len() < MOST_POINTS {
                    points.push(point.clone());
                }
                false
            }
            Err(error) => {
                self.lock().error.get_or_insert(error);
                self.token.stop();
                true
            }
        }
    }

    /// Whether the callback returns a row that the point violates. Takes note of all that it
    /// returns.
    fn is_excluded(&self, point: &Point) -> Result<bool, Error> {
        let Some(lazy) = self.lazy else { return Ok(false) };
        let (mut excluded, rows) = (false, lazy(point)?);
        if rows.is_empty() {
            return Ok(false);
        }
        let first = self.known + self.lock().rows.len();
        let mut stored = Vec::with_capacity(rows.len());
        for (k, row) in rows.into_iter().enumerate() {
            let row = self.model.stored_row(row, &row_name(LAZY, first + k))?;
            excluded |= is_violated(self.model, &row, point, self.feasibility);
            stored.push(row);
        }
        self.lock().rows.append(&mut stored);
        Ok(excluded)
    }
}
