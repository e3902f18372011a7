//! Elastic relaxation: which statements would have to give, and by how much.

use std::ops::Bound;

use std::fmt;

use web_time::Duration;

use super::elastic::ElasticModel;
use super::groups::selected;
use crate::error::Error;
#[cfg(doc)]
use crate::error::ErrorKind;
use crate::model::{Model, Name, statements};
use crate::number::rounded;
use crate::reformulate::{self, Side};
use crate::setters::setters;
use crate::solution::{Point, Termination, Verification};
use crate::solver::{Interrupt, Solver, StopToken};
use crate::tolerance;

/// Options of [`elastic_relaxation`].
///
/// Names stand for statements as in [`ExplainOptions`](super::ExplainOptions).
#[derive(Debug, Clone, Default)]
#[non_exhaustive]
pub struct ElasticOptions {
    /// Statements that never give, in addition to those that the model declares as background.
    pub background: Vec<Name>,
    /// The cost if a statement gives by one of its own units; greater than 0, default 1. The last
    /// entry for a statement counts. A statement with an infinite weight (1e20 or more) never
    /// gives.
    pub weights: Vec<(Name, f64)>,
    /// Wall-clock limit; default none.
    pub time_limit: Option<Duration>,
    /// Stops the solve.
    pub interrupt: Interrupt,
}

impl ElasticOptions {
    /// Adds statements to the background.
    #[must_use]
    pub fn with_background<N: Into<Name>>(mut self, names: impl IntoIterator<Item = N>) -> Self {
        self.background.extend(names.into_iter().map(N::into));
        self
    }

    /// Sets the weight of a statement or family.
    #[must_use]
    pub fn with_weight(mut self, name: impl Into<Name>, weight: f64) -> Self {
        self.weights.push((name.into(), weight));
        self
    }

    setters! {
        /// Sets the wall-clock limit.
        with_time_limit(limit: Duration) => time_limit = Some(limit);
        /// Stops the solve when the handle is triggered.
        with_interrupt(interrupt: &Interrupt) => interrupt = interrupt.clone();
    }

    /// The weights of all statements; infinite for the background.
    fn resolve(&self, model: &Model) -> Result<Vec<f64>, Error> {
        let names: Vec<Name> = statements(model).map(|s| s.name().clone()).collect();
        let mut weights = vec![1.0; names.len()];
        for (name, weight) in &self.weights {
            if weight.is_nan() || *weight <= 0.0 {
                return Err(Error::out_of_range_in_words(
                    format!("the weight of `{name}`"),
                    *weight,
                    (Bound::Excluded(0.0), Bound::Unbounded),
                    "greater than 0; infinite for a statement that never gives",
                ));
            }
            let weight = if *weight < tolerance::INFINITE { *weight } else { f64::INFINITY };
            selected(&names, name)?.into_iter().for_each(|position| weights[position] = weight);
        }
        for name in &self.background {
            selected(&names, name)?.into_iter().for_each(|k| weights[k] = f64::INFINITY);
        }
        for (name, weight) in names.into_iter().zip(&mut weights) {
            if model.is_background(name) {
                *weight = f64::INFINITY;
            }
        }
        Ok(weights)
    }
}

/// Which statements would have to give, and by how much; made by [`elastic_relaxation`].
#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[must_use]
pub struct ElasticRelaxation {
    termination: Termination,
    stretches: Vec<Stretch>,
    point: Option<Point>,
    cost: Option<f64>,
    #[cfg_attr(feature = "serde", serde(with = "crate::serde_numbers"))]
    bound: f64,
}

/// A statement that gives.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Stretch {
    /// The statement.
    pub name: Name,
    /// Which of its limits has to move outward; `None` for a logic statement, a disjunction or an
    /// ordered set, which is dropped.
    pub side: Option<Side>,
    /// By how much, in the statement's own unit; 1 for a dropped statement.
    pub amount: f64,
}

impl ElasticRelaxation {
    /// Why the solver stopped: `Optimal` if no cheaper way exists, `Infeasible` if the statements
    /// that never give contradict each other.
    pub fn termination(&self) -> Termination {
        self.termination
    }

    /// Whether no cheaper way exists.
    pub fn is_optimal(&self) -> bool {
        self.termination == Termination::Optimal
    }

    /// The statements that give, in the order of the model; empty if the model has a solution, or
    /// if the solver found no way.
    pub fn stretches(&self) -> &[Stretch] {
        &self.stretches
    }

    /// A point that satisfies the model once these statements have given.
    pub fn point(&self) -> Option<&Point> {
        self.point.as_ref()
    }

    /// The weighted sum of the amounts.
    pub fn cost(&self) -> Option<f64> {
        self.cost
    }

    /// The proved lower bound on the cost of any way.
    pub fn bound(&self) -> f64 {
        self.bound
    }
}

/// Finds the cheapest way to make a model feasible: which statements have to give, and by how much.
///
/// The cost is the sum of all amounts, each times the weight of its statement. Because the price is
/// linear, a few statements tend to give much rather than many a little. Rows give on either side,
/// and so does the implied row of an indicator. Norms and convex quadratic rows give above their
/// limit; other quadratic rows as the norms that they are, in the unit of the root. A logic
/// statement, a disjunction or an ordered set is dropped as a whole, at the cost of its weight.
/// Bounds and kinds of variables, functions and background never give, and the model's own
/// objective plays no role.
///
/// ```
/// use carom::explain::{ElasticOptions, elastic_relaxation};
/// use carom::prelude::*;
///
/// let mut model = Model::new("m");
/// let x = model.continuous("x", 0.0, 10.0)?;
/// model.add("want", x.ge(7.0))?;
/// model.add("have", x.le(4.0))?;
/// let mut solver = BranchAndBound::default();
/// let options = ElasticOptions::default().with_weight("want", 10.0);
/// let relaxed = elastic_relaxation(&model, &options, &mut solver)?;
/// assert!(relaxed.is_optimal());
/// assert_eq!(relaxed.stretches().len(), 1);
/// let stretch = &relaxed.stretches()[0];
/// assert_eq!(stretch.name.to_string(), "have");
/// assert!((stretch.amount - 3.0).abs() < 1e-6);
/// # Ok::<(), carom::Error>(())
/// ```
///
/// # Errors
///
/// [`ErrorKind::UnknownName`] for a name that the model does not have, [`ErrorKind::OutOfRange`]
/// for a weight that is not greater than 0, and the errors of [`Solver::solve_with`]; among them
/// [`ErrorKind::UnboundedIndicator`] if an indicator has no finite big-M.
pub fn elastic_relaxation(
    model: &Model,
    options: &ElasticOptions,
    solver: &mut dyn Solver,
) -> Result<ElasticRelaxation, Error> {
    let weights = options.resolve(model)?;
    let mut elastic = ElasticModel::of(model, &weights)?;
    let token = StopToken::new(options.time_limit, &options.interrupt);
    let solution = match token.solve(solver, &elastic.model, &mut |_| {}) {
        // Rows that may give bound nothing.
        Err(error) if reformulate::is_missing_bound(&error) => {
            match reformulate::wide_bounds(model, &token)? {
                Some(wide) => elastic.within(&wide)?,
                None => return Err(error),
            }
            token.solve(solver, &elastic.model, &mut |_| {})?
        }
        other => other?,
    };
    let mut relaxed = ElasticRelaxation {
        termination: solution.termination(),
        stretches: Vec::new(),
        point: None,
        cost: solution.objective(),
        bound: solution.bound(),
    };
    let Some(found) = solution.point() else { return Ok(relaxed) };
    let values = found.as_slice()[..model.variable_count()].to_vec();
    let point = Point::new(model, values)?;
    let verification = Verification::of(model, &point, solver.options().feasibility);
    let names: Vec<&Name> = statements(model).map(|s| s.name()).collect();
    for slack in &elastic.slacks {
        let name = names[slack.statement];
        let text = name.to_string();
        // Less than the tolerance is no violation.
        if !verification.violations().iter().any(|violation| violation.name == text) {
            continue;
        }
        // They come first.
        let rows =
            model.constraint_count() + model.indicator_count() + model.conic_constraint_count();
        let is_row = slack.statement < rows;
        for (slack, side) in [(slack.below, Side::Lower), (slack.above, Side::Upper)] {
            let amount = slack.map_or(Ok(0.0), |slack| found.value(slack))?;
            if amount > solver.options().feasibility {
                let side = is_row.then_some(side);
                relaxed.stretches.push(Stretch { name: name.clone(), side, amount });
            }
        }
    }
    relaxed.point = Some(point);
    Ok(relaxed)
}

impl fmt::Display for Stretch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.side {
            Some(Side::Lower) => write!(f, "lower `{}` by {}", self.name, rounded(self.amount, 6)),
            Some(Side::Upper) => write!(f, "raise `{}` by {}", self.name, rounded(self.amount, 6)),
            None => write!(f, "drop `{}`", self.name),
        }
    }
}

impl fmt::Display for ElasticRelaxation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (&self.point, self.termination) {
            (None, Termination::Infeasible) => {
                f.write_str("nothing helps: what may not give contradicts itself")
            }
            (None, reason) => write!(f, "nothing was found: {reason}"),
            (Some(_), _) if self.stretches.is_empty() => f.write_str("nothing has to give"),
            (Some(_), _) => {
                let texts: Vec<String> = self.stretches.iter().map(Stretch::to_string).collect();
                f.write_str(&texts.join("; "))
            }
        }
    }
}
