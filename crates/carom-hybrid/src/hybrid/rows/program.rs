//! The variables of a hybrid system in a model, by name and step.

use std::ops::Range;
use std::sync::Arc;

use super::change::Changes;
use super::levels::Levels;
use crate::error::Error;
use crate::hybrid::horizon::Horizon;
use crate::hybrid::reach::HorizonVariables;
use crate::hybrid::step::{self, AffineForm, Dynamics};
use crate::hybrid::system::{Coordinates, HybridSystem, Measure};
use crate::model::{Affine, Family, Literal, Variable};

/// Which one of several things holds at a step or sample.
#[derive(Debug, Clone)]
pub(super) enum OneOf {
    /// There is only one.
    Only,
    /// Two that share a binary, which is on for the one with this number.
    Pair(Family, usize),
    /// A binary each.
    Each(Vec<Family>),
}

impl OneOf {
    /// The condition that one of them holds; `None` if it is the only one.
    pub(super) fn literal(&self, number: usize, step: usize) -> Option<Literal> {
        match self {
            OneOf::Only => None,
            OneOf::Pair(family, on) => {
                let variable = family.get(step)?;
                Some(if number == *on { variable.on() } else { variable.off() })
            }
            OneOf::Each(families) => Some(families.get(number)?.get(step)?.on()),
        }
    }

    /// The families of binaries, with the number of the thing for which each is on.
    pub(super) fn families(&self) -> impl Iterator<Item = (usize, &Family)> {
        let (first, families) = match self {
            OneOf::Only => (0, &[][..]),
            OneOf::Pair(family, on) => (*on, std::slice::from_ref(family)),
            OneOf::Each(families) => (0, &families[..]),
        };
        (first..).zip(families)
    }

    /// 1 if it holds, and 0 otherwise.
    pub(super) fn value(&self, number: usize, step: usize) -> Affine {
        match self.literal(number, step) {
            None => Affine::constant(1.0),
            Some(literal) if literal.is_on() => literal.variable().into(),
            Some(literal) => 1.0 - literal.variable(),
        }
    }
}

/// The variables of a choice.
#[derive(Debug, Clone)]
pub(super) struct ChoiceProgram {
    pub(super) changes: Changes,
    /// Which transition is taken, over the steps.
    pub(super) taken: OneOf,
    /// Which mode holds, over the samples.
    pub(super) modes: OneOf,
    /// The variables of the changes, over the steps.
    pub(super) groups: Vec<Family>,
}

/// A hybrid system in a model: its variables by name and step.
#[doc(hidden)]
#[derive(Debug, Clone)]
pub struct SystemVariables {
    /// As it is computed.
    pub(super) system: HybridSystem,
    /// As it is stated, if that is not the same.
    pub(super) stated: Option<Arc<HybridSystem>>,
    /// In which the variables of states and inputs are.
    pub(super) coordinates: Coordinates,
    pub(super) horizon: Horizon,
    pub(super) states: Vec<Family>,
    pub(super) inputs: Vec<Family>,
    /// How the values of each input are counted, if it takes some only.
    pub(super) levels: Vec<Option<Levels>>,
    pub(super) choices: Vec<ChoiceProgram>,
    /// Names and values over the steps.
    pub(super) outputs: Vec<(String, Vec<Affine>)>,
    /// The same for each choice.
    pub(super) own_outputs: Vec<Vec<(String, Vec<Affine>)>>,
    /// Which statements of the model it has written, by kind; see
    /// [`wrote`](SystemVariables::wrote).
    pub(super) written: [Range<usize>; 4],
}

impl SystemVariables {
    /// The variables that say which transitions, modes and listed values of inputs are taken from a
    /// step on.
    pub(crate) fn decisions_from(&self, step: usize) -> Vec<Variable> {
        let mut families: Vec<&Family> = Vec::new();
        for choice in &self.choices {
            let own = [&choice.taken, &choice.modes];
            families.extend(own.iter().flat_map(|of| of.families()).map(|(_, family)| family));
        }
        for (input, levels) in self.inputs.iter().zip(&self.levels) {
            match levels {
                None => {}
                Some(Levels::Whole) => families.push(input),
                Some(Levels::Even { numbers, .. }) => families.push(numbers),
                Some(Levels::Each { chosen, .. }) => families.extend(chosen),
            }
        }
        families.into_iter().flat_map(|family| family.iter().skip(step)).collect()
    }

    /// The system as it is stated.
    pub fn system(&self) -> &HybridSystem {
        self.stated.as_deref().unwrap_or(&self.system)
    }

    /// The system in the coordinates of the variables.
    pub(crate) fn computed(&self) -> &HybridSystem {
        &self.system
    }

    /// The coordinates of the variables.
    pub(crate) fn coordinates(&self) -> &Coordinates {
        &self.coordinates
    }

    /// The variables of a system that is stated so, in these coordinates.
    pub(super) fn stated_as(mut self, stated: &HybridSystem, coordinates: &Coordinates) -> Self {
        (self.stated, self.coordinates) = (Some(Arc::new(stated.clone())), coordinates.clone());
        self
    }

    /// The measure of an input, by its name.
    pub(crate) fn input_measure(&self, name: &str) -> Measure {
        let number = self.system.inputs.iter().position(|(own, _)| own == name);
        number.map_or(Measure::PLAIN, |number| self.coordinates.input(number))
    }

    /// The value of a state's or an input's variable in the user's unit.
    pub(crate) fn in_units(&self, measure: Measure, variable: Variable) -> Affine {
        match measure.is_plain() {
            true => variable.into(),
            false => measure.scale * variable + measure.origin,
        }
    }

    /// The horizon.
    pub fn horizon(&self) -> Horizon {
        self.horizon
    }

    /// A state at the samples 0, ..., τ.
    pub fn state(&self, name: &str) -> Result<&Family, Error> {
        let names = self.system.states.iter().map(|(name, _)| name.as_str());
        find(names, name, "state of the system").map(|i| &self.states[i])
    }

    /// An input in the steps 0, ..., τ-1.
    pub fn input(&self, name: &str) -> Result<&Family, Error> {
        let names = self.system.inputs.iter().map(|(name, _)| name.as_str());
        find(names, name, "input of the system").map(|u| &self.inputs[u])
    }

    /// All states, in the system's order, each at the samples 0, ..., τ.
    pub fn states(&self) -> &[Family] {
        &self.states
    }

    /// All inputs, in the system's order, each in the steps 0, ..., τ-1.
    pub fn inputs(&self) -> &[Family] {
        &self.inputs
    }

    /// The condition that a transition of a choice is taken in a step; `None` if the choice has no
    /// other transition.
    pub fn taken(
        &self,
        choice: &str,
        transition: &str,
        step: usize,
    ) -> Result<Option<Literal>, Error> {
        let c = self.choice(choice)?;
        let names = self.system.choices[c].transitions.iter().map(|t| t.name.as_str());
        let j = find(names, transition, "transition of the choice")?;
        self.check_step("the step", step, self.horizon.steps())?;
        Ok(self.choices[c].taken.literal(j, step))
    }

    /// The condition that a choice is in a mode at a sample; `None` if it has no other mode.
    pub fn mode(&self, choice: &str, mode: &str, sample: usize) -> Result<Option<Literal>, Error> {
        let c = self.choice(choice)?;
        let modes = self.system.choices[c].modes();
        let k = find(modes.into_iter(), mode, "mode of the choice")?;
        self.check_step("the sample", sample, self.horizon.steps() + 1)?;
        Ok(self.choices[c].modes.literal(k, sample))
    }

    /// An output in the steps 0, ..., τ-1. If several choices have an output of this name, it is
    /// the sum of theirs.
    pub fn output(&self, name: &str) -> Result<&[Affine], Error> {
        let names = self.outputs.iter().map(|(name, _)| name.as_str());
        find(names, name, "output of the system").map(|o| &self.outputs[o].1[..])
    }

    /// An output of one choice; `None` if it has none of this name.
    pub(crate) fn output_of(&self, choice: &str, name: &str) -> Result<Option<&[Affine]>, Error> {
        let own = &self.own_outputs[self.choice(choice)?];
        Ok(own.iter().find(|(own, _)| own == name).map(|(_, values)| &values[..]))
    }

    /// 1 if a choice is in a mode at a sample, and 0 otherwise.
    pub(crate) fn mode_value(
        &self,
        choice: usize,
        mode: &str,
        sample: usize,
    ) -> Result<Affine, Error> {
        let modes = self.system.choices[choice].modes();
        let k = find(modes.into_iter(), mode, "mode of the choice")?;
        Ok(self.choices[choice].modes.value(k, sample))
    }

    /// 1 if a choice takes a transition in a step, and 0 otherwise.
    pub(crate) fn taken_value(&self, choice: usize, transition: usize, step: usize) -> Affine {
        self.choices[choice].taken.value(transition, step)
    }

    /// The condition that a choice takes a transition in a step; `None` if it has no other.
    pub(crate) fn literal(&self, choice: usize, transition: usize, step: usize) -> Option<Literal> {
        self.choices[choice].taken.literal(transition, step)
    }

    /// The variables of what a choice changes in a step, each as a function of the start by
    /// transition.
    pub(crate) fn change_maps(
        &self,
        choice: usize,
        step: usize,
    ) -> Vec<(Variable, Vec<AffineForm>)> {
        let (own, program) = (self.dynamics(choice, step), &self.choices[choice]);
        let of = |(group, family): (usize, &Family)| {
            Some((family.get(step)?, program.changes.group(&own, group)))
        };
        program.groups.iter().enumerate().filter_map(of).collect()
    }

    /// Whether the system wrote the statement with this position among those of its kind: rows,
    /// indicators, conic rows, disjunctions.
    pub(crate) fn wrote(&self, kind: usize, position: usize) -> bool {
        self.written[kind].contains(&position)
    }

    /// The number of events in a step, over all choices.
    pub fn events(&self, step: usize) -> Result<Affine, Error> {
        self.check_step("the step", step, self.horizon.steps())?;
        Ok(self.count_events(step))
    }

    pub(super) fn count_events(&self, step: usize) -> Affine {
        let choices = self.system.choices.iter().zip(&self.choices);
        let events = choices.flat_map(|(choice, program)| {
            let events = choice.transitions.iter().enumerate().filter(|(_, t)| t.is_event);
            events.map(|(j, _)| program.taken.value(j, step))
        });
        events.sum()
    }

    /// The variables by which a tube tightens the program.
    pub fn horizon_variables(&self) -> HorizonVariables {
        let mut variables = HorizonVariables::new(self.states.clone());
        variables.coordinates = self.coordinates.clone();
        for (c, (program, choice)) in self.choices.iter().zip(&self.system.choices).enumerate() {
            let first = self.system.first_transition(c);
            let taken = program.taken.families();
            variables.transitions.extend(taken.map(|(j, family)| (first + j, family.clone())));
            let modes = choice.modes();
            for (k, family) in program.modes.families() {
                let (choice, mode) = (choice.name.clone(), modes[k].to_owned());
                variables.modes.push((choice, mode, family.clone()));
            }
            for (group, family) in program.groups.iter().enumerate() {
                if let Some(values) = self.by_prediction(c, group) {
                    variables = variables.with_quantity(family.clone(), first, values);
                }
            }
        }
        variables
    }

    /// A group's variable as a function of the prediction, by transition. `None` if it depends on
    /// more than that.
    fn by_prediction(&self, choice: usize, group: usize) -> Option<Vec<(Vec<f64>, f64)>> {
        let (program, choice) = (&self.choices[choice], &self.system.choices[choice]);
        let n = self.system.states.len();
        let reference = &choice.transitions[program.changes.reference];
        let own = program.changes.groups[group];
        let outputs = step::output_names(&choice.transitions);
        let value = |transition: &crate::hybrid::system::Transition| -> Option<(Vec<f64>, f64)> {
            if own >= n {
                let name = outputs.get(own - n)?;
                let output = transition.outputs.iter().find(|output| output.name == **name);
                let Some(output) = output else { return Some((vec![0.0; n], 0.0)) };
                let is_known = output.constant.is_constant() && !output.is_at_start;
                let constant = is_known.then(|| output.constant.get(0)).flatten()?;
                return Some((output.factors.clone(), *constant));
            }
            let unit = |j: usize| if j == own { 1.0 } else { 0.0 };
            let Some(reset) = &transition.reset else {
                return Some(((0..n).map(unit).collect(), 0.0));
            };
            let offset = reset.offset.is_constant().then(|| reset.offset.get(0)).flatten()?;
            let factors = (0..n).map(|j| reset.matrix[(own, j)]).collect();
            Some((factors, offset.get(own).copied()?))
        };
        let (common, constant) = value(reference)?;
        let difference = |transition: &crate::hybrid::system::Transition| {
            let (factors, own) = value(transition)?;
            let factors = factors.iter().zip(&common).map(|(a, b)| a - b).collect();
            (transition.flow == reference.flow).then_some((factors, own - constant))
        };
        choice.transitions.iter().map(difference).collect()
    }

    /// The transitions of a choice at a step, without the ranges of the inputs.
    pub(crate) fn dynamics(&self, choice: usize, step: usize) -> Vec<Dynamics> {
        let transitions = &self.system.choices[choice].transitions;
        let outputs = step::output_names(transitions);
        let dynamics = |t| step::dynamics(&self.system, t, &outputs, Vec::new(), step);
        transitions.iter().map(dynamics).collect()
    }

    pub(super) fn choice(&self, name: &str) -> Result<usize, Error> {
        let names = self.system.choices.iter().map(|choice| choice.name.as_str());
        find(names, name, "choice of the system")
    }

    fn check_step(&self, what: &str, step: usize, count: usize) -> Result<(), Error> {
        if step < count {
            return Ok(());
        }
        Err(Error::out_of_range(what, step as f64, ..count as f64))
    }
}

/// The position of a name.
pub(super) fn find<'a>(
    mut names: impl Iterator<Item = &'a str>,
    name: &str,
    kind: &'static str,
) -> Result<usize, Error> {
    names.position(|own| own == name).ok_or_else(|| Error::unknown_name(name, kind))
}
