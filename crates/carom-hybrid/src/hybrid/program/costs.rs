//! Sums over the steps of a program, magnitudes, and limits that may be exceeded at a price.

use std::iter::Sum;

use super::{AtSample, HybridProgram, ProgramSystems};
use crate::error::{Error, ErrorKind, check_finite};
use crate::hybrid::system::SystemRow;
use crate::model::{Affine, ConicRow, Model, Quadratic, StoredConic};

/// A limit that a plan may exceed, made by [`HybridProgram::soften`].
#[derive(Debug, Clone)]
#[non_exhaustive]
#[must_use = "the cost does nothing until it is minimised"]
pub struct SoftLimit {
    /// The cost of the excess.
    pub cost: Quadratic,
    /// The sum of the excesses of all samples, in the unit of the limit.
    pub excess: Affine,
}

impl HybridProgram {
    /// The sum of an expression over the steps 0, ..., τ-1. The last sample is not among them; see
    /// [`end`](HybridProgram::end).
    ///
    /// # Errors
    ///
    /// Those of [`at`](HybridProgram::at).
    pub fn sum<E>(&self, expression: E) -> Result<E::Output, Error>
    where
        E: AtSample,
        E::Output: Sum,
    {
        let steps = 0..self.steps();
        steps.map(|step| expression.at_sample(&self.systems, step)).sum()
    }

    /// The sum of the magnitudes of an expression over the steps 0, ..., τ-1. Each of them is a
    /// variable `name[t]` of the model, an [absolute value](crate::model::Model::absolute).
    ///
    /// ```
    /// use carom::prelude::*;
    ///
    /// let mut cart = HybridSystem::new(1.0); // s
    /// let x = cart.state("x", 0.0, 9.0)?;
    /// let u = cart.input("u", -2.0, 2.0)?;
    /// cart.mode("roll")?.next([x.is(x + u)])?;
    /// let mut program = cart.program(5)?;
    /// program.start([x.equals(0.0)])?;
    /// // At the depot at one of the samples 2, 3 and 4, and back in the end.
    /// program.require("depot", [x.within(4.0, 5.0)], When::OnceIn(2..=4))?;
    /// program.goal([x.equals(0.0)])?;
    /// let fuel = program.sum_abs("fuel", u)?;
    /// program.minimize(fuel)?;
    /// let plan = program.solve(&mut BranchAndBound::default())?;
    /// assert!((plan.solution.objective().unwrap_or(0.0) - 8.0).abs() < 1e-5);
    /// # Ok::<(), carom::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// Those of [`at`](HybridProgram::at); [`ErrorKind::DuplicateName`]. The model then stays as it
    /// was.
    pub fn sum_abs(&mut self, name: &str, expression: impl Into<Affine>) -> Result<Affine, Error> {
        let (systems, expression) = (self.systems.clone(), expression.into());
        self.model.all_or_nothing(|model| {
            let steps = 0..systems.steps;
            steps.map(|step| magnitude(model, &systems, (name, step), &expression)).sum()
        })
    }

    /// The magnitude of an expression at a sample: a variable `name[t]` of the model, an
    /// [absolute value](crate::model::Model::absolute).
    ///
    /// # Errors
    ///
    /// As for [`sum_abs`](HybridProgram::sum_abs).
    pub fn abs(
        &mut self,
        name: &str,
        expression: impl Into<Affine>,
        sample: usize,
    ) -> Result<Affine, Error> {
        magnitude(&mut self.model, &self.systems, (name, sample), &expression.into())
    }

    /// The sum of the Euclidean norm of some expressions over the steps 0, ..., τ-1, such as the
    /// fuel of a thrust. Each of them is a variable `name[t]` of the model that is [at least the
    /// norm](crate::model::Model::norm), and equal to it where the cost presses it down.
    ///
    /// ```
    /// use carom::prelude::*;
    ///
    /// let mut puck = HybridSystem::new(1.0); // s
    /// let x = puck.state("x", 0.0, 9.0)?; // m
    /// let y = puck.state("y", 0.0, 9.0)?; // m
    /// let [u, w] = [puck.input("u", -2.0, 2.0)?, puck.input("w", -2.0, 2.0)?]; // m/s
    /// puck.mode("slide")?.next([x.is(x + u), y.is(y + w)])?;
    /// let mut program = puck.program(4)?;
    /// program.start([x.equals(0.0), y.equals(0.0)])?;
    /// program.goal([x.equals(3.0), y.equals(4.0)])?;
    /// let way = program.sum_norm("way", [u, w])?;
    /// program.minimize(way)?;
    /// let plan = program.solve(&mut BranchAndBound::default())?;
    /// assert!((plan.solution.objective().unwrap_or(0.0) - 5.0).abs() < 1e-5);
    /// # Ok::<(), carom::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// As for [`sum_abs`](HybridProgram::sum_abs); [`ErrorKind::EmptyRow`] without expressions.
    pub fn sum_norm<E: Into<Affine>>(
        &mut self,
        name: &str,
        entries: impl IntoIterator<Item = E>,
    ) -> Result<Affine, Error> {
        let systems = self.systems.clone();
        let entries: Vec<Affine> = entries.into_iter().map(E::into).collect();
        self.model.all_or_nothing(|model| {
            let steps = 0..systems.steps;
            steps.map(|step| length(model, &systems, (name, step), &entries)).sum()
        })
    }

    /// The Euclidean norm of some expressions at a sample: a variable `name[t]` of the model that
    /// is [at least the norm](crate::model::Model::norm).
    ///
    /// # Errors
    ///
    /// As for [`sum_norm`](HybridProgram::sum_norm).
    pub fn norm<E: Into<Affine>>(
        &mut self,
        name: &str,
        entries: impl IntoIterator<Item = E>,
        sample: usize,
    ) -> Result<Affine, Error> {
        let entries: Vec<Affine> = entries.into_iter().map(E::into).collect();
        length(&mut self.model, &self.systems, (name, sample), &entries)
    }

    /// The sum over the steps 0, ..., τ-1 of the largest magnitude among some expressions. Each of
    /// them is a variable `name[t]` of the model, a [maximum](crate::model::Model::maximum).
    ///
    /// # Errors
    ///
    /// As for [`sum_abs`](HybridProgram::sum_abs).
    pub fn sum_largest<E: Into<Affine>>(
        &mut self,
        name: &str,
        expressions: impl IntoIterator<Item = E>,
    ) -> Result<Affine, Error> {
        let systems = self.systems.clone();
        let expressions: Vec<Affine> = expressions.into_iter().map(E::into).collect();
        self.model.all_or_nothing(|model| {
            let largest = |step: usize| {
                let values = expressions.iter().map(|e| e.at_sample(&systems, step));
                let values = values.collect::<Result<Vec<Affine>, Error>>()?;
                let weight = systems.weight(&expressions);
                let values: Vec<Affine> = values.iter().map(|value| weight * value).collect();
                let sides = values.iter().flat_map(|value| [value.clone(), -value]);
                Ok(Affine::from(model.maximum((name, step), sides)?) * (1.0 / weight))
            };
            (0..systems.steps).map(largest).sum()
        })
    }

    /// Adds a limit that the plan may exceed, and returns what that costs: over all samples (or
    /// steps, if the limit depends on inputs, transitions or outputs), the sum of
    /// `linear * excess + quadratic * excess²`.
    ///
    /// The excess of a sample is the variable `name_excess[t]`. A linear price above the limit's
    /// shadow price keeps the limit wherever it can be kept; a quadratic price alone does not.
    ///
    /// ```
    /// use carom::prelude::*;
    ///
    /// let mut cart = HybridSystem::new(1.0); // s
    /// let x = cart.state("x", 0.0, 9.0)?;
    /// let u = cart.input("u", -2.0, 2.0)?;
    /// cart.mode("roll")?.next([x.is(x + u)])?;
    /// let mut program = cart.program(2)?;
    /// program.start([x.equals(4.0)])?;
    /// // At most 1: exceeded by 3 at the start, and by 1 after a step.
    /// let low = program.soften("low", x.le(1.0), 10.0, 0.0)?;
    /// program.minimize(low.cost)?;
    /// let plan = program.solve(&mut BranchAndBound::default())?;
    /// assert!((plan.value(low.excess, 0)? - 4.0).abs() < 1e-6);
    /// # Ok::<(), carom::Error>(())
    /// ```
    ///
    /// # Arguments
    ///
    /// * `row`: of states, modes, series, inputs, transitions and outputs; not a limit of the
    ///   system, which holds without exception. The row may limit a length:
    ///   `norm([vx, vy]).le(1.0)`.
    /// * `linear`, `quadratic`: cost per unit of the excess, and per unit squared; at least 0.
    ///
    /// # Errors
    ///
    /// Those of [`at`](HybridProgram::at); those of [`Model::add`](crate::model::Model::add) for
    /// the row; [`ErrorKind::NotFinite`], and [`ErrorKind::OutOfRange`] for a negative price and if
    /// both are 0; [`ErrorKind::Misplaced`] for squares. The model then stays as it was.
    #[doc(alias("soft constraint", "slack"))]
    pub fn soften(
        &mut self,
        name: &str,
        row: impl Into<SystemRow>,
        linear: f64,
        quadratic: f64,
    ) -> Result<SoftLimit, Error> {
        check_finite(name, "a price", [linear, quadratic])?;
        let lower = linear.min(quadratic);
        if lower < 0.0 || linear.max(quadratic) == 0.0 {
            let (what, more) =
                (format!("a price of `{name}`"), ", and one of the two prices above 0");
            return Err(Error::out_of_range_with(what, lower, 0.0.., more));
        }
        let row = match row.into() {
            SystemRow::Row(row) => row,
            SystemRow::Conic(row) => return self.soften_norm(name, &row, linear, quadratic),
            SystemRow::Nonlinear(_) => {
                let (name, place) = (format!("the nonlinear row `{name}`"), "`soften`".to_owned());
                let help = "state its expression as an output of the transitions, and soften a row of \
                            the output";
                return Err(ErrorKind::Misplaced { name, place, help }.into());
            }
        };
        if row.expression().terms().is_empty() {
            return Err(ErrorKind::EmptyRow { name: name.to_owned() }.into());
        }
        let (lower, upper) = row.limits(name)?;
        let systems = self.systems.clone();
        // The excess is in the unit in which the row is computed.
        let weight = systems.weight([row.expression()]);
        let row = row.expression().within(weight * lower, weight * upper);
        let (linear, quadratic) = (linear / weight, quadratic / weight / weight);
        self.model.all_or_nothing(|model| {
            let mut soft = SoftLimit { cost: Quadratic::zero(), excess: Affine::zero() };
            for sample in 0..systems.samples(row.expression()) {
                let value = weight * row.expression().at_sample(&systems, sample)?;
                let range = model.range(&value)?;
                let over = (range.upper - row.upper()).max(row.lower() - range.lower);
                if over <= 0.0 {
                    continue;
                }
                let excess = model.continuous((format!("{name}_excess"), sample), 0.0, over)?;
                match (row.lower().is_finite(), row.upper().is_finite()) {
                    (true, true) => {
                        let sides = [format!("{name}_above"), format!("{name}_below")];
                        let above = (&value - excess).le(row.upper());
                        model.add((sides[0].as_str(), sample), above)?;
                        model.add((sides[1].as_str(), sample), (value + excess).ge(row.lower()))?;
                    }
                    (true, false) => {
                        model.add((name, sample), (value + excess).ge(row.lower()))?;
                    }
                    _ => {
                        model.add((name, sample), (value - excess).le(row.upper()))?;
                    }
                }
                soft.cost += linear * excess + quadratic * excess.square();
                soft.excess += (1.0 / weight) * excess;
            }
            Ok(soft)
        })
    }
}

impl HybridProgram {
    /// A limit of a length that may be exceeded.
    fn soften_norm(
        &mut self,
        name: &str,
        row: &ConicRow,
        linear: f64,
        quadratic: f64,
    ) -> Result<SoftLimit, Error> {
        let systems = self.systems.clone();
        let StoredConic::Norm { entries, bound } = row.stored() else {
            let (name, place) = (format!("the row `{name}` of squares"), "a soft limit".to_owned());
            let help = "state it as a norm, so that the excess is a length";
            return Err(ErrorKind::Misplaced { name, place, help }.into());
        };
        let samples = entries.iter().chain([bound]).map(|part| systems.samples(part));
        let samples = samples.min().unwrap_or(0);
        let weight = systems.weight(entries.iter().chain([bound]));
        let (linear, quadratic) = (linear / weight, quadratic / weight / weight);
        self.model.all_or_nothing(|model| {
            let mut soft = SoftLimit { cost: Quadratic::zero(), excess: Affine::zero() };
            for sample in 0..samples {
                let mut row = row.at_sample(&systems, sample)?;
                let StoredConic::Norm { entries, bound } = row.stored_mut() else { continue };
                let mut longest = 0.0_f64;
                for entry in entries {
                    longest = longest.hypot(model.range(entry)?.magnitude());
                }
                let over = longest.next_up() - model.range(bound)?.lower;
                if over <= 0.0 {
                    continue;
                }
                let excess = model.continuous((format!("{name}_excess"), sample), 0.0, over)?;
                *bound += excess;
                model.add((name, sample), row)?;
                soft.cost += linear * excess + quadratic * excess.square();
                soft.excess += (1.0 / weight) * excess;
            }
            Ok(soft)
        })
    }
}

/// The length of some expressions at a sample, as a variable unless it is constant.
fn length(
    model: &mut Model,
    systems: &ProgramSystems,
    (name, sample): (&str, usize),
    entries: &[Affine],
) -> Result<Affine, Error> {
    let weight = systems.weight(entries);
    let entries = entries.iter().map(|entry| Ok(weight * entry.at_sample(systems, sample)?));
    let entries: Vec<Affine> = entries.collect::<Result<_, Error>>()?;
    if !entries.is_empty() && entries.iter().all(|entry| entry.terms().is_empty()) {
        let length = entries.iter().fold(0.0_f64, |length, entry| length.hypot(entry.offset()));
        return Ok(Affine::constant(length / weight));
    }
    Ok(Affine::from(model.norm((name, sample), entries)?) * (1.0 / weight))
}

/// The magnitude of an expression at a sample, as a variable unless it is constant.
fn magnitude(
    model: &mut Model,
    systems: &ProgramSystems,
    (name, sample): (&str, usize),
    expression: &Affine,
) -> Result<Affine, Error> {
    let value = expression.at_sample(systems, sample)?;
    match value.terms().is_empty() {
        true => Ok(Affine::constant(value.offset().abs())),
        false => {
            let weight = systems.weight([expression]);
            Ok(Affine::from(model.absolute((name, sample), weight * value)?) * (1.0 / weight))
        }
    }
}
