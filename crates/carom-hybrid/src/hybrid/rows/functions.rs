//! The nonlinear functions of a step as variables that equal them.

use super::names::Names;
use super::program::SystemVariables;
use crate::error::{Error, ErrorKind};
use crate::hybrid::system::{Restated, StepSlot};
use crate::model::{Affine, Family, Model, Variable};

/// Adds the functions of all steps, in the user's numbers.
pub(super) fn add(
    restated: &Restated,
    model: &mut Model,
    names: &mut Names,
    program: &mut SystemVariables,
) -> Result<(), Error> {
    let Restated { system, coordinates } = restated;
    if !system.is_nonlinear() {
        return Ok(());
    }
    for (number, function) in system.functions.iter() {
        let name = names.family(&[&system.inputs[number].0]);
        let mut members = Vec::with_capacity(program.horizon.steps());
        for step in 0..program.horizon.steps() {
            let member = |family: &Family, at: usize| -> Result<Variable, Error> {
                let place = name.clone();
                let foreign =
                    ErrorKind::ForeignHandle { kind: "variable", index: at, place, name: None };
                family.get(at).ok_or_else(|| foreign.into())
            };
            let part = |slot: StepSlot| -> Result<Affine, Error> {
                let (measure, variable) = match slot {
                    StepSlot::State(i) => (coordinates.state(i), member(&program.states[i], step)?),
                    StepSlot::Prediction(i) => {
                        (coordinates.state(i), member(&program.states[i], step + 1)?)
                    }
                    StepSlot::Input(u) => (coordinates.input(u), member(&program.inputs[u], step)?),
                };
                Ok(program.in_units(measure, variable))
            };
            let Some(own) = system.functions.over(function, part)? else { continue };
            let variable = model.define((name.as_str(), step).into(), own)?;
            if let Some(range) = system.inputs[number].1.get(step) {
                model.set_bounds(variable, range.lower, range.upper)?;
            }
            members.push(variable);
        }
        program.inputs[number] = members.into_iter().collect();
    }
    Ok(())
}
