//! Values of handles in programs and runs.

use crate::error::Error;
use crate::hybrid::program::ProgramSystems;
use crate::hybrid::rows::HybridRun;
use crate::hybrid::system::{HybridSystem, Meaning, SystemRow};
use crate::model::{Affine, Variable};

/// The handles in a row.
pub(super) fn handles_of(row: &SystemRow) -> Vec<Variable> {
    let mut handles = Vec::new();
    let mut all = |own: &Affine| handles.extend(own.terms().iter().map(|term| term.0));
    match row {
        SystemRow::Row(row) => all(row.expression()),
        SystemRow::Conic(row) => row.stored().for_each_variable(&mut |own| handles.push(own)),
        SystemRow::Nonlinear(row) => {
            let _never = row.expression().visit(&mut |own| {
                all(own);
                Ok(())
            });
        }
    }
    handles
}

impl ProgramSystems {
    /// Whether all handles of a row have values at a sample.
    pub(super) fn row_has_values(&self, row: &SystemRow, sample: usize) -> Result<bool, Error> {
        for handle in handles_of(row) {
            if !self.has_value(handle, sample)? {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// Whether a handle has a value at a sample of the horizon.
    pub(super) fn has_value(&self, handle: Variable, sample: usize) -> Result<bool, Error> {
        Ok(sample < self.samples(&handle.into()))
    }

    /// Whether a handle is 0 or 1 only.
    pub(super) fn is_binary(&self, handle: Variable) -> bool {
        self.iter().any(|own| own.system().is_binary(handle))
    }
}

impl HybridSystem {
    /// Whether a handle is 0 or 1 only: a mode or a transition.
    pub(super) fn is_binary(&self, handle: Variable) -> bool {
        let meaning = self.handles.meaning(handle);
        matches!(meaning, Some(Meaning::InMode(..) | Meaning::Acting(..) | Meaning::Taken(..)))
    }

    /// The value of a handle in a run; `None` beyond those that it has.
    pub(super) fn value_in(
        &self,
        run: &HybridRun,
        handle: Variable,
        sample: usize,
    ) -> Result<Option<f64>, Error> {
        let place = "a mission of a run";
        let name_of = |choice: usize| self.choices.get(choice).map_or("", |own| own.name.as_str());
        let truth = |is_true: bool| f64::from(u8::from(is_true));
        let mode = |choice: usize, mode: &str, sample: usize| -> Result<Option<f64>, Error> {
            let modes = run.modes(name_of(choice))?;
            Ok(modes.get(sample).map(|own| truth(own == mode)))
        };
        Ok(match self.meaning(handle, place)? {
            Meaning::State(i) => {
                let name = self.states.get(*i).map_or("", |(name, _)| name.as_str());
                run.state(name)?.get(sample).copied()
            }
            Meaning::Input(u) => {
                let name = self.inputs.get(*u).map_or("", |(name, _)| name.as_str());
                run.input(name)?.get(sample).copied()
            }
            Meaning::Series(_, values) => values.get(sample).copied(),
            Meaning::InMode(choice, name) => mode(*choice, name, sample)?,
            Meaning::Acting(choice, name) => mode(*choice, name, sample + 1)?,
            Meaning::Taken(choice, number) => {
                let transitions = self.choices.get(*choice).map(|own| &own.transitions);
                let taken = transitions.and_then(|all| all.get(*number));
                let taken = taken.map_or("", |transition| transition.name.as_str());
                run.transitions(name_of(*choice))?.get(sample).map(|own| truth(own == taken))
            }
            Meaning::Output(name) => run.output(name)?.get(sample).copied(),
            Meaning::Prediction(_) => {
                let (name, place) = (format!("`{}`", self.handle_name(handle)), place.to_owned());
                let help = "use the state at the next sample, or state the prediction as an output";
                return Err(crate::error::ErrorKind::Misplaced { name, place, help }.into());
            }
        })
    }
}
