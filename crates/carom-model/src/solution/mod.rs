//! The result of a solve: values by handle, statuses, bound, and an independent check.
//!
//! Why the solver stopped ([`Termination`]) and what it holds ([`PrimalStatus`]) are separate
//! answers: a search stopped by its time limit may hold a very good plan. Every [`Solution`] with
//! a point carries a [`Verification`] made from the *model*, not from the solver's rows: bounds,
//! integrality and rows, and the meaning of indicators, disjunctions, logic, functions and
//! ordered sets.

mod evaluation;
mod leaves;
mod multipliers;
mod note;
mod point;
mod pool;
mod proof_report;
mod start_report;
mod statistics;
mod status;
mod verification;

pub use leaves::{LeafBound, LeafBox};
pub use multipliers::Multipliers;
pub use note::Note;
pub use point::{Evaluate, Point};
#[doc(alias = "solution pool")]
pub use pool::Pool;
pub use pool::PoolPoint;
pub use proof_report::ProofReport;
pub use start_report::{StartReport, StartStatus};
pub use statistics::{
    FacetCounts, Heuristic, HeuristicCount, HeuristicCounts, RelaxationCounts, Statistics, Times,
};
pub use status::{PrimalStatus, Termination};
pub use verification::{Checked, Verification, Violation, ViolationKind};

use crate::error::{Error, ErrorKind};
use crate::interval::Interval;
use crate::model::{Constraint, Model, Sense, Variable};
use crate::tolerance;

/// The answer of a [`Solver`](crate::solver::Solver).
#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[must_use]
pub struct Solution {
    termination: Termination,
    point: Option<Point>,
    objective: Option<f64>,
    #[cfg_attr(feature = "serde", serde(with = "crate::serde_numbers"))]
    bound: f64,
    #[cfg_attr(feature = "serde", serde(default))]
    constant: f64,
    /// The sum of the magnitudes of the terms of the objective at the point.
    #[cfg_attr(feature = "serde", serde(default))]
    magnitude: f64,
    sense: Sense,
    verification: Option<Verification>,
    rounding: f64,
    statistics: Statistics,
    #[cfg_attr(feature = "serde", serde(default))]
    pool: Pool,
    #[cfg_attr(feature = "serde", serde(default))]
    leaves: Vec<LeafBox>,
    #[cfg_attr(feature = "serde", serde(default))]
    start: Option<StartReport>,
    #[cfg_attr(feature = "serde", serde(default))]
    multipliers: Option<Multipliers>,
    #[cfg_attr(feature = "serde", serde(default))]
    refused: Option<Verification>,
    #[cfg_attr(feature = "serde", serde(default))]
    proof: Option<ProofReport>,
    /// Variables whose whole range is below the tolerance.
    #[cfg_attr(feature = "serde", serde(default))]
    narrow: usize,
    #[cfg_attr(feature = "serde", serde(default))]
    relaxed: Vec<Variable>,
}

/// The result that a backend reports; [`Solution::new`] checks it against the model.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Outcome {
    /// Why the backend stopped.
    pub termination: Termination,
    /// The best point, one value per variable in the order of creation.
    pub values: Option<Vec<f64>>,
    /// The proved bound on the objective, in the model's own sense: no point is better. Infinite
    /// if nothing is proved.
    pub bound: f64,
    /// Counts and time.
    pub statistics: Statistics,
}

/// Whether a range is below the tolerance, and not that of a small unit, in which tolerances are
/// relative.
fn is_narrow(bounds: Interval, feasibility: f64) -> bool {
    let width = bounds.upper - bounds.lower;
    width > 0.0 && width < feasibility && bounds.magnitude() >= tolerance::SMALL_UNIT
}

/// Objectives below this part of the magnitudes of their terms are what rounding has left of 0 (no
/// unit): beyond the digits that are shown.
const LEFT_BY_ROUNDING: f64 = 1e-12;

/// The sum of the magnitudes of the terms of the objective at a point.
fn magnitude(model: &Model, point: &Point) -> f64 {
    let objective = model.objective();
    let at = |variable: Variable| point.as_slice().get(variable.index()).copied().unwrap_or(0.0);
    let linear = objective.affine().terms().into_iter().map(|(v, c)| c * at(v));
    let products = objective.products().into_iter().map(|(v, w, q)| q * at(v) * at(w));
    linear.chain(products).chain([objective.affine().offset()]).map(f64::abs).sum()
}

impl Outcome {
    /// The result that a backend reports; the fields say what each part means.
    pub fn new(
        termination: Termination,
        values: Option<Vec<f64>>,
        bound: f64,
        statistics: Statistics,
    ) -> Self {
        Outcome { termination, values, bound, statistics }
    }
}

impl Solution {
    /// Builds a solution from a backend's report.
    ///
    /// The objective and the verification are computed here from the model, so no backend can vouch
    /// for itself. Integers within [`tolerance::INTEGRALITY`] of a whole number are rounded, then
    /// the meaning of every statement is checked. A point that fails is dropped, and `Optimal` then
    /// becomes [`Termination::Stalled`]. If the points of a backend fail because of rounding, it
    /// can solve them again with [`certify`](crate::solver::certify).
    ///
    /// # Arguments
    ///
    /// * `feasibility`: the feasibility tolerance, see
    ///   [`tolerance::FEASIBILITY`].
    ///
    /// # Errors
    ///
    /// [`ErrorKind::Length`] when the number of values is not the number of variables.
    pub fn new(model: &Model, outcome: Outcome, feasibility: f64) -> Result<Self, Error> {
        let Outcome { mut termination, values, bound, statistics } = outcome;
        let mut rounding = 0.0_f64;
        let whole = |mut values: Vec<f64>| {
            for (variable, value) in model.variables().zip(&mut values) {
                let distance = (*value - value.round()).abs();
                if variable.kind().is_integral() && distance <= tolerance::INTEGRALITY {
                    *value = value.round();
                    rounding = rounding.max(distance);
                }
            }
            Point::new(model, values)
        };
        let mut point = values.map(whole).transpose()?;
        let verification = point.as_ref().map(|p| Verification::of(model, p, feasibility));
        if verification.as_ref().is_some_and(|v| !v.holds()) {
            point = None;
        }
        if point.is_none() && termination == Termination::Optimal {
            termination = Termination::Stalled;
        }
        let objective = point.as_ref().map(|p| p.value(model.objective())).transpose()?;
        let sense = model.sense();
        let pool = Pool::of_best(point.as_ref(), objective, verification.as_ref());
        let magnitude = point.as_ref().map_or(0.0, |point| magnitude(model, point));
        Ok(Solution {
            termination,
            point,
            objective,
            bound,
            constant: model.objective_constant(),
            magnitude,
            sense,
            verification,
            rounding,
            statistics,
            pool,
            leaves: Vec::new(),
            start: None,
            multipliers: None,
            refused: None,
            proof: None,
            narrow: model.variables().filter(|v| is_narrow(v.bounds(), feasibility)).count(),
            relaxed: model.relaxed_integers().collect(),
        })
    }

    /// No answer: of what was stored without a solution.
    #[cfg(feature = "serde")]
    #[doc(hidden)]
    pub fn unknown() -> Self {
        Solution {
            termination: Termination::Stalled,
            point: None,
            objective: None,
            bound: f64::NEG_INFINITY,
            constant: 0.0,
            magnitude: 0.0,
            sense: Sense::Minimize,
            verification: None,
            rounding: 0.0,
            statistics: Statistics::default(),
            pool: Pool::default(),
            leaves: Vec::new(),
            start: None,
            multipliers: None,
            refused: None,
            proof: None,
            narrow: 0,
            relaxed: Vec::new(),
        }
    }

    /// Adds points to the pool. Each has one value per variable, in the order of creation. Points
    /// that fail the verification are dropped; of points with the same integers, the best is kept.
    ///
    /// # Arguments
    ///
    /// * `complete`: whether the points are proved to be the best ones.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::Length`] when a number of values is not the number of variables.
    pub fn with_pool(
        mut self,
        model: &Model,
        points: impl IntoIterator<Item = Vec<f64>>,
        complete: bool,
        feasibility: f64,
    ) -> Result<Self, Error> {
        self.pool.complete = complete;
        for values in points {
            let point = Point::new(model, values)?;
            self.pool.offer(model, point, feasibility)?;
        }
        Ok(self)
    }

    #[doc(hidden)]
    pub fn with_leaves(mut self, leaves: Vec<LeafBox>) -> Self {
        self.leaves = leaves;
        self
    }

    /// Sets the report on the MIP start.
    pub fn with_start_report(mut self, report: Option<StartReport>) -> Self {
        self.start = report;
        self
    }

    /// Notes shadow prices and reduced costs; they are dropped unless the solution is optimal.
    #[doc(hidden)]
    pub fn with_multipliers(mut self, multipliers: Option<Multipliers>) -> Self {
        self.multipliers = multipliers.filter(|_| self.is_optimal());
        self
    }

    /// Notes the proof that was written.
    #[doc(hidden)]
    pub fn with_proof(mut self, proof: Option<ProofReport>) -> Self {
        self.proof = proof;
        self
    }

    /// The proof that [`Options::with_proof`](crate::solver::Options::with_proof) has asked for;
    /// `None` if none was written.
    pub fn proof(&self) -> Option<&ProofReport> {
        self.proof.as_ref()
    }

    /// Notes the check of a refused point; it is dropped unless the search stalled.
    #[doc(hidden)]
    pub fn with_refused(mut self, refused: Option<Verification>) -> Self {
        self.refused = refused.filter(|_| self.termination == Termination::Stalled);
        self
    }

    /// Why a search [stalled](Termination::Stalled), where points were found and refused: what the
    /// one violates that violates the model least. Its values keep the rows of the lowered program
    /// up to rounding, and the statements named here not within the tolerance, so these have
    /// coefficients that are too large, or too far apart, for the tolerance.
    ///
    /// `None` if the search did not stall, or stalled at what could be neither refuted nor split.
    pub fn refused(&self) -> Option<&Verification> {
        self.refused.as_ref()
    }

    /// Shadow prices of rows and reduced costs of variables.
    ///
    /// `None` unless the backend is `BranchAndBound`, the solution is optimal, and neither the
    /// model nor its lowered form has integers. It is also `None` if the multipliers do not pass
    /// their [check](Multipliers).
    ///
    /// ```
    /// use carom::prelude::*;
    ///
    /// let mut model = Model::new("diet");
    /// let bread = model.continuous("bread", 0.0, 10.0)?;
    /// let cheese = model.continuous("cheese", 0.0, 10.0)?;
    /// let energy = model.add("energy", (2.0 * bread + 4.0 * cheese).ge(12.0))?;
    /// model.minimize(1.0 * bread + 3.0 * cheese)?;
    ///
    /// let solution = BranchAndBound::default().solve(&model)?;
    /// let multipliers = solution.multipliers().expect("a linear program");
    /// // One more unit of energy costs half a loaf; cheese is dearer than its energy by 1.
    /// assert!((multipliers.shadow_price(energy)? - 0.5).abs() < 1e-6);
    /// assert!((multipliers.reduced_cost(cheese)? - 1.0).abs() < 1e-6);
    /// assert_eq!(multipliers.reduced_cost(bread)?, 0.0);
    /// # Ok::<(), carom::Error>(())
    /// ```
    pub fn multipliers(&self) -> Option<&Multipliers> {
        self.multipliers.as_ref()
    }

    /// The [shadow price](Multipliers::shadow_price) of a row: the change of the objective per unit
    /// by which its limits move up.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::NoMultipliers`] if the solution has no [multipliers](Self::multipliers),
    /// [`ErrorKind::ForeignHandle`] for a row of another model.
    #[doc(alias("dual value", "Lagrange multiplier"))]
    pub fn shadow_price(&self, of: Constraint) -> Result<f64, Error> {
        self.known_multipliers()?.shadow_price(of)
    }

    /// The [reduced cost](Multipliers::reduced_cost) of a variable: the change of the objective per
    /// unit by which its bounds move up.
    ///
    /// # Errors
    ///
    /// As for [`shadow_price`](Self::shadow_price).
    pub fn reduced_cost(&self, of: Variable) -> Result<f64, Error> {
        self.known_multipliers()?.reduced_cost(of)
    }

    fn known_multipliers(&self) -> Result<&Multipliers, Error> {
        let none = || ErrorKind::NoMultipliers { termination: self.termination.to_string() };
        self.multipliers.as_ref().ok_or_else(|| none().into())
    }

    /// The best points found, with distinct values of the integer variables, best first. There are
    /// at most as many as [`Options::pool`](crate::solver::Options::pool) asks for. The first one
    /// is [`point`](Self::point).
    pub fn pool(&self) -> &Pool {
        &self.pool
    }

    /// The leaves of the tree, if `Options::keep_leaves` is on.
    #[doc(hidden)]
    pub fn leaves(&self) -> &[LeafBox] {
        &self.leaves
    }

    /// The report on the MIP start of the solve; `None` if it had none.
    pub fn start_report(&self) -> Option<&StartReport> {
        self.start.as_ref()
    }

    /// The integers that were [relaxed](crate::model::Model::relax_integer) and may have fractions:
    /// if there are any, the [bound](Self::bound) is one on the model with all integers whole, and
    /// the point need not be a point of that model.
    pub fn relaxed(&self) -> &[Variable] {
        &self.relaxed
    }

    /// Why the solver stopped.
    pub fn termination(&self) -> Termination {
        self.termination
    }

    /// Whether the solution holds a point.
    pub fn primal_status(&self) -> PrimalStatus {
        if self.point.is_some() { PrimalStatus::Feasible } else { PrimalStatus::None }
    }

    /// Whether the point is proved optimal within the gap.
    pub fn is_optimal(&self) -> bool {
        self.termination == Termination::Optimal
    }

    /// Whether the model is proved infeasible.
    pub fn is_infeasible(&self) -> bool {
        self.termination == Termination::Infeasible
    }

    /// The best point found.
    pub fn point(&self) -> Option<&Point> {
        self.point.as_ref()
    }

    /// Whether a binary, or a condition, is on at the best point.
    ///
    /// # Errors
    ///
    /// As for [`value`](Solution::value).
    pub fn is_on(&self, of: impl Evaluate) -> Result<bool, Error> {
        Ok(self.value(of)? > 0.5)
    }

    /// Value of a variable or an expression at the best point.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::NoPoint`] if there is no point, [`ErrorKind::ForeignHandle`] for a handle of
    /// another model.
    pub fn value(&self, of: impl Evaluate) -> Result<f64, Error> {
        match &self.point {
            Some(point) => point.value(of),
            None => Err(ErrorKind::NoPoint { termination: self.termination.to_string() }.into()),
        }
    }

    /// Objective of the best point, in the model's own sense.
    pub fn objective(&self) -> Option<f64> {
        self.objective
    }

    /// An objective or a bound as people are shown it: 0 where it is less than 1e-12 of the
    /// magnitudes of the objective's terms at the best point, because that is what rounding leaves
    /// of them.
    ///
    /// ```
    /// use carom::prelude::*;
    ///
    /// let mut model = Model::new("m");
    /// let x = model.binary_family("x", 3)?;
    /// model.minimize(0.1 * x[0] + 0.2 * x[1] - 0.3 * x[2])?;
    /// model.add("all", (x[0] + x[1] + x[2]).ge(3.0))?;
    /// let solution = BranchAndBound::default().solve(&model)?;
    /// assert_eq!(solution.cleaned(5.5e-17), 0.0);
    /// assert_eq!(solution.cleaned(5.5e-7), 5.5e-7);
    /// # Ok::<(), carom::Error>(())
    /// ```
    pub fn cleaned(&self, value: f64) -> f64 {
        if value.abs() < LEFT_BY_ROUNDING * self.magnitude { 0.0 } else { value }
    }

    /// Proved bound: no feasible point has a better objective. Infinite if nothing is proved
    /// (`-inf` when minimising), and `+inf` if a minimisation is infeasible.
    pub fn bound(&self) -> f64 {
        self.bound
    }

    /// Absolute gap between objective and bound, in the objective's unit; infinite if
    /// there is no point.
    pub fn gap(&self) -> f64 {
        let gap = |objective| self.sense.sign() * (objective - self.bound);
        self.objective.map_or(f64::INFINITY, |objective| gap(objective).max(0.0))
    }

    /// Gap relative to the objective's magnitude (no unit); infinite if there is no point.
    ///
    /// If the objective is smaller without its constant (with what variables of equal bounds add),
    /// the gap is relative to that, so that no constant hides what the program is about. Below 0.1
    /// it is relative to 0.1: an absolute gap of 1e-7 is a relative one of 1e-6 there.
    pub fn relative_gap(&self) -> f64 {
        let gap = |objective| tolerance::relative_gap(self.gap(), objective, self.constant);
        self.objective.map_or(f64::INFINITY, gap)
    }

    /// The independent check of the point, made from the model. It is also
    /// present if the point failed it and was dropped.
    pub fn verification(&self) -> Option<&Verification> {
        self.verification.as_ref()
    }

    /// The largest distance by which the integers of the backend were rounded before the check (no
    /// unit). It is 0 for the crate's own search, which fixes the integers and then solves the
    /// rest.
    pub fn rounding(&self) -> f64 {
        self.rounding
    }

    /// Counts and time.
    pub fn statistics(&self) -> &Statistics {
        &self.statistics
    }
}
