//! Inputs that take some values only: whole numbers, or those of a list.

use std::ops::Bound::{Excluded, Unbounded};

use super::handles::Input;
use super::{HybridSystem, Schedule};
#[cfg(doc)]
use crate::error::ErrorKind;
use crate::error::{Error, check_finite};
use crate::interval::Interval;
use crate::tolerance::MAX_STEPS;

/// The values that an input may take within its range.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) enum InputValues {
    /// Whole numbers.
    Whole,
    /// Those of a list, in ascending order, each once.
    Listed(Vec<f64>),
}

impl InputValues {
    /// The allowed value that is the nearest to a number.
    pub(crate) fn nearest(&self, value: f64) -> f64 {
        match self {
            InputValues::Whole => value.round(),
            InputValues::Listed(list) => {
                let nearer = |a: &&f64, b: &&f64| (*a - value).abs().total_cmp(&(*b - value).abs());
                list.iter().min_by(nearer).copied().unwrap_or(value)
            }
        }
    }

    /// Whether an allowed value lies in a range.
    fn meets(&self, range: &Interval) -> bool {
        match self {
            InputValues::Whole => range.lower.ceil() <= range.upper.floor(),
            InputValues::Listed(list) => list.iter().any(|value| range.contains(*value)),
        }
    }

    /// Refuses lists that are none, and ranges without a value.
    pub(super) fn check(&self, name: &str, range: &Schedule<Interval>) -> Result<(), Error> {
        if let InputValues::Listed(list) = self {
            check_list(name, list)?;
        }
        match range.values().find(|range| !self.meets(range)) {
            None => Ok(()),
            Some(range) => {
                let what = format!("the upper end of `{name}`");
                let needed = match self {
                    InputValues::Whole => range.lower.ceil(),
                    InputValues::Listed(list) => {
                        let above = list.iter().find(|value| **value >= range.lower);
                        above.copied().unwrap_or(f64::INFINITY)
                    }
                };
                let more = ", the first value of the input in its range";
                Err(Error::out_of_range_with(what, range.upper, needed.., more))
            }
        }
    }
}

fn check_list(name: &str, list: &[f64]) -> Result<(), Error> {
    let what = format!("the number of values of `{name}`");
    if list.is_empty() || list.len() > MAX_STEPS {
        let (count, range) = (list.len() as f64, 1.0..=MAX_STEPS as f64);
        let words = format!("from 1 to {MAX_STEPS}");
        return Err(Error::out_of_range_in_words(what, count, range, words));
    }
    check_finite(name, "a value of the input", list.iter().copied())?;
    if let Some(pair) = list.windows(2).find(|pair| pair[0] >= pair[1]) {
        let what = format!("a value of `{name}`");
        let range = (Excluded(pair[0]), Unbounded);
        return Err(Error::out_of_range_with(what, pair[1], range, ", the one before"));
    }
    Ok(())
}

impl HybridSystem {
    /// Declares an input that takes one of some values in each step, in the input's unit: a gear, a
    /// valve that is open or shut (`[0.0, 1.0]`), a motor with three speeds. Everything else is as
    /// for an [`input`](HybridSystem::input) from the least to the largest of them.
    ///
    /// Programs choose among the values, and simulations and certificates refuse others. Reach
    /// sets, refutations and [flaws](HybridSystem::well_posedness) see the range. A feedback cannot
    /// correct such an input.
    ///
    /// ```
    /// use carom::prelude::*;
    ///
    /// let mut lift = HybridSystem::new(0.5); // s
    /// let x = lift.state("x", 0.0, 9.0)?; // m
    /// let v = lift.state("v", -2.0, 2.0)?; // m/s
    /// let u = lift.input_from("u", [-1.0, 0.0, 1.0])?; // m/s²
    /// lift.mode("move")?.rates([x.is(v), v.is(u)])?;
    /// let rest = |place: f64| [x.equals(place), v.equals(0.0)];
    /// let found = lift.shortest(rest(0.0), rest(1.5), &mut BranchAndBound::default())?;
    /// assert_eq!(found.steps, Some(5));
    /// let plan = found.plan.ok_or("no plan")?;
    /// assert_eq!(plan.run.input("u")?, [1.0, 1.0, 0.0, -1.0, -1.0]);
    /// assert!(!lift.simulate(&[0.0, 0.0], &[[0.5]])?.is_complete());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    ///
    /// As for [`input`](HybridSystem::input); [`ErrorKind::OutOfRange`] without a value.
    pub fn input_from(
        &mut self,
        name: &str,
        values: impl IntoIterator<Item = f64>,
    ) -> Result<Input, Error> {
        let mut list: Vec<f64> = values.into_iter().collect();
        list.sort_by(f64::total_cmp);
        list.dedup();
        check_list(name, &list)?;
        let (lower, upper) = (list[0], list[list.len() - 1]);
        self.finite_input(name, lower, upper, InputValues::Listed(list))
    }

    /// Declares an input that takes whole numbers, as [`input_from`](HybridSystem::input_from).
    /// Either end is a number or a list by step, as for [`input`](HybridSystem::input).
    ///
    /// ```
    /// use carom::prelude::*;
    ///
    /// // Parcels that are loaded one by one, up to 3 a step.
    /// let mut van = HybridSystem::new(60.0); // s
    /// let mass = van.state("mass", 0.0, 100.0)?; // kg
    /// let parcels = van.integer_input("parcels", 0.0, 3.0)?;
    /// van.mode("load")?.next([mass.is(mass + 7.0 * parcels)])?;
    /// let mut program = van.program(4)?;
    /// program.start([mass.equals(0.0)])?;
    /// program.maximize(program.end(mass)?)?;
    /// program.require("axle", [mass.le(40.0)], When::At(4))?;
    /// let plan = program.solve(&mut BranchAndBound::default())?;
    /// assert!((plan.value(mass, 4)? - 35.0).abs() < 1e-6);
    /// # Ok::<(), carom::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// As for [`input`](HybridSystem::input); [`ErrorKind::OutOfRange`] for a range without a whole
    /// number.
    pub fn integer_input(
        &mut self,
        name: &str,
        lower: impl Into<Schedule<f64>>,
        upper: impl Into<Schedule<f64>>,
    ) -> Result<Input, Error> {
        self.finite_input(name, lower, upper, InputValues::Whole)
    }

    fn finite_input(
        &mut self,
        name: &str,
        lower: impl Into<Schedule<f64>>,
        upper: impl Into<Schedule<f64>>,
        values: InputValues,
    ) -> Result<Input, Error> {
        let input = self.input(name, lower, upper)?;
        let checked = self.inputs.last().map_or(Ok(()), |(_, range)| values.check(name, range));
        if let Err(error) = checked {
            self.inputs.pop();
            self.handles.take_back();
            return Err(error);
        }
        self.input_values.insert(name.to_owned(), values);
        Ok(input)
    }

    /// The values that an input may take; `None` for all of its range.
    pub(crate) fn values_of_input(&self, input: usize) -> Option<&InputValues> {
        self.input_values.get(&self.inputs.get(input)?.0)
    }
}
