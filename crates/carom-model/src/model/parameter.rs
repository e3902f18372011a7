//! Parameters: numbers that change from solve to solve within a declared range.
//!
//! A parameter is used in expressions like a variable and has one value at a time. Big-Ms and the
//! ranges of functions are computed from its declared *range*, so a model is
//! lowered once and solved for
//! any value.

use super::Model;
use super::checks::{bounds, finite};
use super::ids::Variable;
use super::name::Name;
use super::variable::VariableKind;
use crate::error::{Error, ErrorKind};
use crate::interval::Interval;

impl Model {
    /// Adds a parameter: a number that can change between solves within a range.
    ///
    /// A parameter can replace a constant in an affine expression, on either side of a comparison.
    /// It cannot replace a coefficient, because a parameter times a variable is not affine.
    ///
    /// ```
    /// use carom::prelude::*;
    /// use carom::reformulate;
    ///
    /// let mut model = Model::new("m");
    /// let x = model.continuous("x", 0.0, 10.0)?;
    /// let near = model.binary("near")?;
    /// let wall = model.parameter("wall", 2.0, 1.0, 8.0)?;
    /// model.add("behind", near.on().implies(x.le(wall)))?;
    /// model.maximize(x + 5.0 * near)?;
    /// let lowered = reformulate::lower(&model)?;
    /// // From the range of `wall`, not from its value.
    /// assert_eq!(lowered.report().entries()[0].value, 9.0);
    /// let mut solver = BranchAndBound::default();
    /// for (value, best) in [(2.0, 10.0), (8.0, 13.0), (6.5, 11.5)] {
    ///     model.set_parameter(wall, value)?;
    ///     let solution = lowered.solve(&model, &mut solver)?;
    ///     assert!((solution.objective().unwrap_or(0.0) - best).abs() < 1e-6);
    /// }
    /// # Ok::<(), carom::Error>(())
    /// ```
    ///
    /// # Arguments
    ///
    /// * `value`: the current value, in the parameter's unit.
    /// * `lower`, `upper`: the range of all values that it may take, in the same unit, both finite.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::DuplicateName`], [`ErrorKind::InvalidName`], [`ErrorKind::CrossedBounds`],
    /// [`ErrorKind::NotFinite`], and [`ErrorKind::OutOfRange`] for a value outside its range.
    pub fn parameter(
        &mut self,
        name: impl Into<Name>,
        value: f64,
        lower: f64,
        upper: f64,
    ) -> Result<Variable, Error> {
        let name = name.into();
        let range = checked_range(&name, lower, upper)?;
        check_value(&name, value, range)?;
        let parameter = self.variable(name, VariableKind::Continuous, value, value)?;
        self.stored.variables[parameter.index()].range = Some((range.lower, range.upper));
        Ok(parameter)
    }

    /// Changes the value of a parameter within its range.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::ForeignHandle`]; [`ErrorKind::NotParameter`] for any other variable;
    /// [`ErrorKind::NotFinite`] and [`ErrorKind::OutOfRange`] for a value outside the declared
    /// range.
    pub fn set_parameter(&mut self, parameter: Variable, value: f64) -> Result<(), Error> {
        let range = self.declared_range(parameter)?;
        let data = &mut self.stored.variables[parameter.index()];
        check_value(&data.name, value, range)?;
        (data.lower, data.upper) = (value, value);
        Ok(())
    }

    /// Changes the values of several parameters; none if one of them is refused.
    #[doc(hidden)]
    pub fn set_parameters(&mut self, values: &[(Variable, f64)]) -> Result<(), Error> {
        for &(parameter, value) in values {
            self.check_parameter(parameter, value)?;
        }
        values.iter().try_for_each(|&(parameter, value)| self.set_parameter(parameter, value))
    }

    /// Refuses a value that a parameter may not have.
    #[doc(hidden)]
    pub fn check_parameter(&self, parameter: Variable, value: f64) -> Result<(), Error> {
        let range = self.declared_range(parameter)?;
        check_value(&self.stored.variables[parameter.index()].name, value, range)
    }

    /// Changes the declared range of a parameter. Earlier lowered forms become out of date.
    ///
    /// # Errors
    ///
    /// As for [`Model::parameter`]; [`ErrorKind::NotParameter`] for any other variable. The current
    /// value must lie in the new range.
    pub fn set_parameter_range(
        &mut self,
        parameter: Variable,
        lower: f64,
        upper: f64,
    ) -> Result<(), Error> {
        self.declared_range(parameter)?;
        let data = &mut self.stored.variables[parameter.index()];
        let range = checked_range(&data.name, lower, upper)?;
        check_value(&data.name, data.lower, range)?;
        data.range = Some((range.lower, range.upper));
        self.touch();
        Ok(())
    }

    /// The parameters in the order of creation.
    pub fn parameters(&self) -> impl Iterator<Item = Variable> + '_ {
        let data = self.stored.variables.iter().enumerate();
        data.filter(|(_, data)| data.range.is_some())
            .map(|(i, _)| Variable::new(i, self.stored.tag))
    }

    fn declared_range(&self, parameter: Variable) -> Result<Interval, Error> {
        let variable = self.variable_ref(parameter)?;
        let name = || variable.name().to_string();
        variable
            .parameter_range()
            .ok_or_else(|| Error::from(ErrorKind::NotParameter { name: name() }))
    }

    /// The parameters as ordinary variables that may take any value of their ranges.
    #[doc(hidden)]
    pub fn with_open_parameters(&self) -> Model {
        let mut model = self.clone();
        for data in &mut model.stored.variables {
            if let Some((lower, upper)) = data.range.take() {
                (data.lower, data.upper) = (lower, upper);
            }
        }
        model
    }

    /// Takes over the values, and the ranges, of another model's parameters.
    #[doc(hidden)]
    pub fn take_parameters(&mut self, from: &Model) {
        for (data, source) in self.stored.variables.iter_mut().zip(&from.stored.variables) {
            if source.range.is_some() {
                (data.lower, data.upper, data.range) = (source.lower, source.upper, source.range);
            }
        }
    }

    /// Adds a parameter from a file.
    #[cfg(feature = "serde")]
    pub(super) fn push_stored_parameter(
        &mut self,
        name: Name,
        kind: VariableKind,
        value: (f64, f64),
        range: (f64, f64),
    ) -> Result<Variable, Error> {
        if kind != VariableKind::Continuous || value.0 != value.1 {
            return Err(ErrorKind::NotParameter { name: name.to_string() }.into());
        }
        self.parameter(name, value.0, range.0, range.1)
    }
}

fn checked_range(name: &Name, lower: f64, upper: f64) -> Result<Interval, Error> {
    let (lower, upper) = bounds(lower, upper, name)?;
    finite(lower, "the lower end of the range", name)?;
    finite(upper, "the upper end of the range", name)?;
    Ok(Interval::new(lower, upper))
}

fn check_value(name: &Name, value: f64, range: Interval) -> Result<(), Error> {
    finite(value, "the value", name)?;
    if range.contains(value) {
        return Ok(());
    }
    Err(Error::out_of_range_in_words(
        format!("the value of the parameter `{name}`"),
        value,
        range.lower..=range.upper,
        format!(
            "within its declared range [{}, {}]; widen that with `set_parameter_range`",
            range.lower, range.upper
        ),
    ))
}
