//! Finding handles, and what they stand for.

use super::HybridSystem;
use super::handles::{Input, Meaning, State};
use super::transition_mut::TransitionMut;
use crate::error::{Error, ErrorKind};
use crate::model::Variable;

impl HybridSystem {
    /// The meaning of a handle.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::ForeignHandle`].
    pub(crate) fn meaning(&self, variable: Variable, place: &str) -> Result<&Meaning, Error> {
        self.handles.meaning(variable).ok_or_else(|| {
            let (kind, index, place) = ("variable", variable.index(), place.to_owned());
            ErrorKind::ForeignHandle { kind, index, place, name: None }.into()
        })
    }

    /// A handle in words.
    pub(crate) fn handle_name(&self, variable: Variable) -> String {
        let state = |i: &usize| self.states.get(*i).map_or("", |(name, _)| name);
        let name_of = |choice: &usize| self.choices.get(*choice).map_or("", |own| &own.name);
        match self.handles.meaning(variable) {
            Some(Meaning::State(i)) => state(i).to_owned(),
            Some(Meaning::Prediction(i)) => format!("{}'", state(i)),
            Some(Meaning::Input(u)) => self.inputs.get(*u).map_or("", |(name, _)| name).to_owned(),
            Some(Meaning::Series(name, _) | Meaning::Output(name)) => name.clone(),
            Some(Meaning::InMode(choice, mode)) => format!("{} is {mode}", name_of(choice)),
            Some(Meaning::Acting(choice, mode)) => format!("{} acts as {mode}", name_of(choice)),
            Some(Meaning::Taken(choice, number)) => {
                let choice = self.choices.get(*choice);
                let taken = choice.and_then(|choice| choice.transitions.get(*number));
                taken.map_or(String::new(), |transition| transition.name.clone())
            }
            None => format!("#{}", variable.index()),
        }
    }

    /// The names of all handles, by their index.
    pub(crate) fn handle_names(&self) -> Vec<String> {
        self.handles.all().map(|handle| self.handle_name(handle)).collect()
    }

    /// The handle of a state, by its name: for a system that was read or made from matrices.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::UnknownName`].
    pub fn state_named(&self, name: &str) -> Result<State, Error> {
        let number = self.states.iter().position(|(own, _)| own == name);
        let number = number.ok_or_else(|| Error::unknown_name(name, "state of the system"))?;
        self.handles
            .find_state(number)
            .ok_or_else(|| Error::unknown_name(name, "state of the system"))
    }

    /// The handle of an input, by its name.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::UnknownName`].
    pub fn input_named(&self, name: &str) -> Result<Input, Error> {
        let number = self.inputs.iter().position(|(own, _)| own == name);
        let number = number.ok_or_else(|| Error::unknown_name(name, "input of the system"))?;
        let found = self.handles.find(&Meaning::Input(number));
        let found = found.ok_or_else(|| Error::unknown_name(name, "input of the system"))?;
        Ok(Input::of(found))
    }

    /// The handle of a transition, by the names of its choice (`mode` if there is only one) and its
    /// own: 1 in the steps that take it, 0 in the others.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::UnknownName`].
    pub fn transition_named(&self, choice: &str, name: &str) -> Result<Variable, Error> {
        let number = self.choices.iter().position(|own| own.name == choice);
        let number = number.ok_or_else(|| Error::unknown_name(choice, "choice of the system"))?;
        let taken = self.choices[number].transitions.iter().position(|own| own.name == name);
        let taken = taken.ok_or_else(|| Error::unknown_name(name, "transition of the choice"))?;
        let found = self.handles.find(&Meaning::Taken(number, taken));
        found.ok_or_else(|| Error::unknown_name(name, "transition of the choice"))
    }

    /// A transition that was stated before, by its handle, to say more about it. Its flow must not
    /// be stated twice.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::ForeignHandle`] for a handle of another system; [`ErrorKind::Misplaced`] for
    /// one that is no transition's.
    pub fn transition_mut(&mut self, taken: Variable) -> Result<TransitionMut<'_>, Error> {
        match self.meaning(taken, "`transition_mut`")? {
            &Meaning::Taken(choice, number) => Ok(TransitionMut::new(self, choice, number)),
            _ => {
                let help = "give the handle of a transition, which `taken` returns";
                Err(self.misplaced(taken, "`transition_mut`", help))
            }
        }
    }

    /// The handle of a mode with memory, by the names of its choice and its own: 1 at the samples
    /// in the mode, 0 at the others.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::UnknownName`].
    pub fn mode_named(&self, choice: &str, name: &str) -> Result<Variable, Error> {
        let number = self.choices.iter().position(|own| own.name == choice);
        let number = number.ok_or_else(|| Error::unknown_name(choice, "choice of the system"))?;
        let is_named = self.choices[number].modes().contains(&name);
        let found = self.handles.find(&Meaning::InMode(number, name.to_owned()));
        found.filter(|_| is_named).ok_or_else(|| Error::unknown_name(name, "mode of the choice"))
    }

    /// The handle of an output, by its name.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::UnknownName`].
    pub fn output_named(&self, name: &str) -> Result<Variable, Error> {
        let found = self.handles.find(&Meaning::Output(name.to_owned()));
        found.ok_or_else(|| Error::unknown_name(name, "output of the system"))
    }

    /// The names of the outputs: those that transitions state, in their order, and then those that
    /// none states.
    pub(crate) fn output_names(&self) -> Vec<String> {
        let stated = self.transitions().flat_map(|transition| &transition.outputs);
        let stated = stated.map(|output| output.name.as_str());
        let mut names: Vec<String> = Vec::new();
        for name in stated.chain(self.handles.outputs()) {
            if names.iter().all(|own| own != name) {
                names.push(name.to_owned());
            }
        }
        names
    }

    /// Declares the handles of a choice: of its modes, transitions and outputs.
    pub(super) fn declare_choice(&mut self, number: usize) {
        let choice = &self.choices[number];
        for mode in choice.modes() {
            self.handles.of(Meaning::InMode(number, mode.to_owned()));
        }
        for (j, transition) in choice.transitions.iter().enumerate() {
            self.handles.of(Meaning::Taken(number, j));
            for output in &transition.outputs {
                self.handles.of(Meaning::Output(output.name.clone()));
            }
        }
    }
}
