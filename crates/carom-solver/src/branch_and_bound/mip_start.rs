//! MIP starts: from variables of the model to columns of the program, and the report on them.

use crate::model::{Model, Variable};
use crate::search::{Completion, SearchResult, Start};
use crate::solution::{StartReport, StartStatus};
use crate::solver::MipStart;

/// A MIP start in columns of the lowered model.
pub(super) struct GivenStart {
    pub(super) start: Start,
    /// Number of its values that are ignored: not finite, or not of an integral variable of the
    /// model.
    ignored: usize,
}

impl GivenStart {
    pub(super) fn new(model: &Model, given: &MipStart) -> Self {
        let column = |&(variable, value): &(Variable, f64)| {
            let is_integral =
                model.variable_ref(variable).is_ok_and(|variable| variable.kind().is_integral());
            (is_integral && value.is_finite()).then(|| (variable.index(), value))
        };
        let integers: Vec<(usize, f64)> = given.values.iter().filter_map(column).collect();
        let ignored = given.values.len() - integers.len();
        GivenStart { start: Start { integers, ..Start::default() }, ignored }
    }

    /// The report on the outcome of the start; columns and points are the model's.
    pub(super) fn report(&self, model: &Model, found: &SearchResult) -> StartReport {
        let status = match &found.completion {
            _ if self.start.integers.is_empty() => None,
            None => None,
            Some(Completion::Point(point)) => {
                let changed = self.changed(model, point);
                Some(match changed.is_empty() {
                    true => StartStatus::Accepted,
                    false => StartStatus::Repaired { changed },
                })
            }
            Some(Completion::Contradiction(column)) => {
                let name = match model.variables().nth(*column) {
                    Some(variable) => variable.name().to_string(),
                    None => format!("column {column}"),
                };
                rejected(&format!(
                    "the value of `{name}` contradicts the model or values before it, and no point \
                     was found with the others"
                ))
            }
            Some(Completion::Nothing) => rejected(
                "no point was found with these values of the integers, or with the first half of \
                 them",
            ),
            Some(Completion::Stopped) => {
                rejected("a limit was reached before the start led to a point")
            }
        };
        let mut report = StartReport::default();
        (report.status, report.ignored) = (status, self.ignored);
        report
    }

    /// The variables whose values at a point are not those of the start.
    fn changed(&self, model: &Model, point: &[f64]) -> Vec<Variable> {
        let variables: Vec<Variable> = model.variables().map(|variable| variable.id()).collect();
        let differs = |&&(j, value): &&(usize, f64)| point.get(j) != Some(&value.round());
        let columns = self.start.integers.iter().filter(differs);
        columns.filter_map(|&(j, _)| variables.get(j).copied()).collect()
    }
}

fn rejected(reason: &str) -> Option<StartStatus> {
    Some(StartStatus::Rejected { reason: reason.to_owned() })
}
