//! Values of parameters that belong to a step of the loop: forecasts, and values from the state.

#[cfg(doc)]
use crate::error::ErrorKind;
use crate::error::{Error, check_finite};
use crate::model::{Model, Variable};

/// The values of parameters other than the measured state in each step of the loop.
#[derive(Default)]
pub(super) struct Forecasts<'a> {
    known: Vec<(Vec<Variable>, Vec<f64>)>,
    given: Option<Box<Values<'a>>>,
}

/// Values of parameters, from a step of the loop and its measured state.
pub(super) type Values<'a> = dyn FnMut(usize, &[f64]) -> Vec<(Variable, f64)> + 'a;

impl<'a> Forecasts<'a> {
    /// Adds the values that parameters of the horizon's steps 0, 1, ... take, by step of the loop.
    ///
    /// # Errors
    ///
    /// Those of [`Model::set_parameter`] for one of the values; [`ErrorKind::OutOfRange`] without
    /// any.
    pub(super) fn add(
        &mut self,
        model: &Model,
        parameters: Vec<Variable>,
        values: Vec<f64>,
    ) -> Result<(), Error> {
        let name = match parameters.first() {
            Some(&first) => model.variable_ref(first)?.name().family().to_owned(),
            None => return Ok(()),
        };
        if values.is_empty() {
            let what = format!("the number of values of the forecast of `{name}`");
            return Err(Error::out_of_range(what, 0.0, 1.0..));
        }
        check_finite(&name, "a value of the forecast", values.iter().copied())?;
        for (t, &parameter) in parameters.iter().enumerate() {
            // The values that this parameter will ever have.
            for &value in values.iter().skip(t.min(values.len() - 1)) {
                model.check_parameter(parameter, value)?;
            }
        }
        self.known.push((parameters, values));
        Ok(())
    }

    pub(super) fn give(&mut self, values: impl FnMut(usize, &[f64]) -> Vec<(Variable, f64)> + 'a) {
        self.given = Some(Box::new(values));
    }

    /// Whether there are none.
    pub(super) fn is_empty(&self) -> bool {
        self.known.is_empty() && self.given.is_none()
    }

    /// The values for the program that begins with a step of the loop.
    ///
    /// # Errors
    ///
    /// Those of [`Model::set_parameter`] for values that the user's function gives.
    pub(super) fn at(
        &mut self,
        model: &Model,
        step: usize,
        state: &[f64],
    ) -> Result<Vec<(Variable, f64)>, Error> {
        let mut all = Vec::new();
        for (parameters, values) in &self.known {
            let value = |t: usize| values.get(step + t).or(values.last()).copied();
            all.extend(parameters.iter().enumerate().filter_map(|(t, &p)| Some((p, value(t)?))));
        }
        if let Some(given) = &mut self.given {
            for (parameter, value) in given(step, state) {
                model.check_parameter(parameter, value)?;
                all.push((parameter, value));
            }
        }
        Ok(all)
    }
}
