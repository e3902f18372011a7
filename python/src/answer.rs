//! What came of a solve.

use std::sync::Arc;

use carom::solution::{PrimalStatus, Solution, StartStatus, Termination};
use pyo3::prelude::*;
use pyo3::types::{PyByteArray, PyDict};

use crate::build::Layout;
use crate::numbers::bytes;
use crate::session::Solved;

/// A solution, in the columns and rows of the arrays.
#[pyclass(frozen, module = "carom._carom")]
pub(crate) struct Answer {
    solution: Solution,
    layout: Arc<Layout>,
    seconds: f64,
}

/// The multipliers of the rows and of the columns, as bytes.
type Duals<'py> = (Bound<'py, PyByteArray>, Bound<'py, PyByteArray>);

impl Answer {
    pub(crate) fn new(solved: Solved, layout: &Arc<Layout>) -> Self {
        let Solved { solution, seconds } = solved;
        Answer { solution, layout: Arc::clone(layout), seconds }
    }
}

/// Statistics of a solve: names, and the fields of which they are the values.
macro_rules! counts {
    ($into:ident, $from:ident, $($name:ident),*) => {
        $($into.set_item(stringify!($name), $from.$name)?;)*
    };
}

#[pymethods]
impl Answer {
    /// Why the search ended.
    #[getter]
    fn status(&self) -> &'static str {
        match self.solution.termination() {
            Termination::Optimal => "optimal",
            Termination::Infeasible => "infeasible",
            Termination::Unbounded => "unbounded",
            Termination::TimeLimit => "time_limit",
            Termination::NodeLimit => "node_limit",
            Termination::MemoryLimit => "memory_limit",
            Termination::Interrupted => "interrupted",
            _ => "stalled",
        }
    }

    /// Whether there is a point.
    #[getter]
    fn has_point(&self) -> bool {
        self.solution.primal_status() == PrimalStatus::Feasible
    }

    /// The best point, as bytes.
    fn x<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyByteArray>> {
        let values = self.solution.point()?.as_slice();
        Some(bytes(py, values.get(..self.layout.variables.len()).unwrap_or(values)))
    }

    #[getter]
    fn objective(&self) -> Option<f64> {
        self.solution.objective()
    }

    #[getter]
    fn bound(&self) -> f64 {
        self.solution.bound()
    }

    #[getter]
    fn gap(&self) -> f64 {
        self.solution.relative_gap()
    }

    /// How long the call of the solver took, without Python (s).
    #[getter]
    fn seconds(&self) -> f64 {
        self.seconds
    }

    fn statistics<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let counts = self.solution.statistics();
        let all = PyDict::new(py);
        all.set_item("seconds", self.seconds)?;
        counts!(all, counts, nodes, iterations, relaxations, incumbents, depth, max_open);
        counts!(all, counts, leaves, cut_off, refuted_by_propagation, refuted_by_relaxation);
        counts!(all, counts, tree_bytes, blocks, threads);
        Ok(all)
    }

    /// The largest residual of the statements at the point that was checked.
    #[getter]
    fn largest_residual(&self) -> Option<f64> {
        self.solution.verification().map(|check| check.largest_residual())
    }

    /// What the nearest point violates that was refused, in words.
    fn refused(&self) -> Vec<String> {
        let refused = self.solution.refused().map(|check| check.violations());
        refused.unwrap_or_default().iter().map(ToString::to_string).collect()
    }

    /// Shadow prices of the rows and reduced costs of the columns, as bytes.
    fn duals<'py>(&self, py: Python<'py>) -> Option<Duals<'py>> {
        let multipliers = self.solution.multipliers()?;
        let price = |row| multipliers.shadow_price(row).unwrap_or(0.0);
        let layout = &self.layout;
        let of_row = |row: &[Option<_>; 2]| row.iter().flatten().map(|row| price(*row)).sum();
        let rows: Vec<f64> = layout.rows.iter().map(of_row).collect();
        let cost = |variable| multipliers.reduced_cost(variable).unwrap_or(0.0);
        let mut columns: Vec<f64> = layout.variables.iter().copied().map(cost).collect();
        for &(column, row) in &layout.bounds {
            columns[column] += price(row);
        }
        Some((bytes(py, &rows), bytes(py, &columns)))
    }

    /// What became of the start.
    fn start(&self) -> Option<&'static str> {
        let report = self.solution.start_report()?;
        Some(match report.status.as_ref()? {
            StartStatus::Accepted => "accepted",
            StartStatus::Repaired { .. } => "repaired",
            _ => "rejected",
        })
    }

    /// The report on the proof.
    fn proof<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyDict>>> {
        let Some(report) = self.solution.proof() else { return Ok(None) };
        let all = PyDict::new(py);
        counts!(all, report, is_complete, commands, bytes, bound);
        all.set_item("failure", report.failure.as_deref())?;
        Ok(Some(all))
    }
}
