//! Polyhedra around the origin in a box, and the largest value of a row over them.

use crate::error::Error;
use crate::interval::Interval;
use crate::model::{Affine, Constraint, Model, Variable};
use crate::solver::Solver;

/// A polyhedron `row . z <= 1` for all rows, in a box.
pub(super) struct Polyhedron {
    model: Model,
    point: Vec<Variable>,
    rows: Vec<(Constraint, f64)>,
}

impl Polyhedron {
    /// The box.
    pub(super) fn of_box(ranges: &[Interval]) -> Result<Self, Error> {
        let mut model = Model::new("polyhedron");
        let mut point = Vec::with_capacity(ranges.len());
        for (i, range) in ranges.iter().enumerate() {
            point.push(model.continuous(("z", i), range.lower, range.upper)?);
        }
        Ok(Polyhedron { model, point, rows: Vec::new() })
    }

    fn expression(&self, row: &[f64]) -> Affine {
        let mut sum = Affine::zero();
        let terms = row.iter().zip(&self.point).filter(|(a, _)| **a != 0.0);
        terms.for_each(|(a, z)| sum.add_term(*a, *z));
        sum
    }

    /// Cuts with `row . z <= 1`. The row has an entry other than 0.
    pub(super) fn cut(&mut self, row: &[f64]) -> Result<(), Error> {
        let expression = self.expression(row);
        let loose = self.model.range(&expression)?.upper.max(1.0) + 1.0;
        let id = self.model.add(("row", self.rows.len()), expression.le(1.0))?;
        self.rows.push((id, loose));
        Ok(())
    }

    /// A proved bound on the largest `row . z`; infinite if the solver proves none.
    pub(super) fn largest(&mut self, row: &[f64], solver: &mut dyn Solver) -> Result<f64, Error> {
        let expression = self.expression(row);
        if expression.terms().is_empty() {
            return Ok(0.0);
        }
        // Where the box alone decides, nothing is solved.
        let range = self.model.range(&expression)?;
        if range.upper <= 1.0 || self.rows.is_empty() {
            return Ok(range.upper);
        }
        self.model.maximize(expression)?;
        let solution = solver.solve(&self.model)?;
        Ok(if solution.bound().is_nan() { f64::INFINITY } else { solution.bound() })
    }

    /// Whether the other rows and the box imply row `k` up to `slack`. If so, the row is dropped.
    pub(super) fn drop_if_implied(
        &mut self,
        k: usize,
        row: &[f64],
        slack: f64,
        solver: &mut dyn Solver,
    ) -> Result<bool, Error> {
        let Some(&(id, loose)) = self.rows.get(k) else { return Ok(false) };
        self.model.set_limits(id, f64::NEG_INFINITY, loose)?;
        let implied = self.largest(row, solver)? <= 1.0 + slack;
        if !implied {
            self.model.set_limits(id, f64::NEG_INFINITY, 1.0)?;
        }
        Ok(implied)
    }
}
