//! The last phase, which begins with the first point: every point is checked by the model itself.

use super::presolve::Presolution;
use super::refusals::Refusals;
use super::row_judge::RowJudge;
use super::solve::Solve;
use crate::model::Model;
use crate::search::PointJudge;
use crate::solution::{Point, Verification};

/// Judges points of a presolved program by the model's own verification.
pub(super) struct ModelJudge<'a> {
    presolved: &'a Presolution<'a>,
    model: &'a Model,
    rows: Option<&'a RowJudge<'a>>,
    refusals: &'a Refusals,
    feasibility: f64,
    /// By variable of the model: whether it is an integer.
    integral: Vec<bool>,
    /// If a pool is kept, by column of the program: whether an integer of the model follows from
    /// it.
    tells_apart: Vec<bool>,
}

impl<'a> ModelJudge<'a> {
    pub(super) fn new(solve: &Solve<'a>, presolved: &'a Presolution<'a>) -> Self {
        let Solve { model, options, rows, refusals, .. } = *solve;
        let integral: Vec<bool> =
            model.variables().map(|variable| variable.kind().is_integral()).collect();
        let feasibility = options.feasibility;
        let tells_apart = match options.pool {
            1 => Vec::new(),
            _ => presolved.decides((0..integral.len()).filter(|&j| integral[j])),
        };
        ModelJudge { presolved, model, rows, refusals, feasibility, integral, tells_apart }
    }
}

impl PointJudge for ModelJudge<'_> {
    fn accepts(&self, x: &[f64]) -> bool {
        let Some(point) = self.point(x) else { return false };
        let model = self.rows.map_or(self.model, RowJudge::model);
        let check = Verification::of(model, &point, self.feasibility);
        let holds = check.holds();
        if !holds {
            self.refusals.note(check);
        }
        holds
    }

    fn excludes(&self, x: &[f64]) -> bool {
        self.rows.is_some_and(|rows| self.point(x).is_none_or(|point| rows.excludes(&point)))
    }

    fn finds_rows(&self) -> bool {
        self.rows.is_some()
    }

    fn point(&self, x: &[f64]) -> Option<Point> {
        Point::new(self.model, self.presolved.restore(x)).ok()
    }

    fn key(&self, x: &[f64]) -> Vec<i64> {
        let values = self.presolved.restore(x);
        let integers = values.iter().zip(&self.integral).filter(|(_, integral)| **integral);
        integers.map(|(value, _)| value.round() as i64).collect()
    }

    fn tells_apart(&self, column: usize) -> bool {
        self.tells_apart.get(column) == Some(&true)
    }
}
