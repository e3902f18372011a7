//! Programs whose start is a parameter, for tables of laws.

use super::HybridProgram;
use crate::error::Error;
#[cfg(doc)]
use crate::error::ErrorKind;
use crate::interval::Interval;
use crate::model::Variable;

impl HybridProgram {
    /// Makes the start of some states parameters that range over intervals, such as the axes of a
    /// table of laws (`carom::explicit`), and returns them, a parameter a state, in your units. For
    /// other states there is [`start`](HybridProgram::start), and for the modes before
    /// [`start_from`](HybridProgram::start_from).
    ///
    /// The parameter of a state `x` is `measured_x`, with the value of its interval that is nearest
    /// to 0.
    ///
    /// # Errors
    ///
    /// Those of [`at`](HybridProgram::at) and of [`Model::parameter`](crate::model::Model):
    /// [`ErrorKind::NotFinite`] for an interval without an end, [`ErrorKind::DuplicateName`] for a
    /// state that was opened before. The model then stays as it was.
    pub fn open_start<S: Into<Variable>, R: Into<Interval>>(
        &mut self,
        states: impl IntoIterator<Item = (S, R)>,
    ) -> Result<Vec<Variable>, Error> {
        let mut opened = Vec::new();
        for (state, range) in states {
            let state = state.into();
            let (own, start) = (self.variable(state, 0)?, self.at(state, 0)?);
            let name = self.model.variable_ref(own)?.name().family().to_owned();
            opened.push((format!("measured_{name}"), start, range.into()));
        }
        self.model.all_or_nothing(|model| {
            let mut parameters = Vec::new();
            for (name, start, Interval { lower, upper }) in opened {
                let middle = 0.0_f64.max(lower).min(upper);
                let parameter = model.parameter(name.as_str(), middle, lower, upper)?;
                model.add(format!("{name}_row").as_str(), (start - parameter).equals(0.0))?;
                parameters.push(parameter);
            }
            Ok(parameters)
        })
    }
}
