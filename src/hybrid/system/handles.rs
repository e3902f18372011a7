//! Handles of a hybrid system: its expressions and rows are written with them.
//!
//! | handle | type | in an expression |
//! | --- | --- | --- |
//! | state | [`State`] | its value at the start of the step, or at the sample |
//! | prediction of a state | [`Variable`] | the result of the flow, before a reset |
//! | input | [`Variable`] | its value in the step |
//! | series | [`Variable`] | a number that is known for each step |
//! | mode | [`Variable`] | 1 at the samples in the mode, 0 at the others |
//! | transition | [`Variable`] | 1 in the steps that take it, 0 in the others |
//! | output | [`Variable`] | its value in the step |

use std::ops::{Add, Mul, Neg, Sub};

use super::HybridSystem;
use super::schedule::Schedule;
use crate::error::{Error, ErrorKind};
use crate::model::{
    Affine, Literal, ModelTag, Quadratic, Row, Variable, comparisons, products, scaling, sums,
};

/// A state of a [`HybridSystem`](crate::hybrid::HybridSystem), made by
/// [`state`](crate::hybrid::HybridSystem::state).
///
/// In an expression it stands for its value at the start of a step, or at the sample at which the
/// expression is taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct State {
    variable: Variable,
}

impl State {
    /// The value at the end of the step that the flow predicts, before a reset, in the state's unit.
    /// For guards, resets and outputs.
    pub fn predicted(self) -> Variable {
        // The prediction is declared right after its state.
        Variable { index: self.variable.index + 1, tag: self.variable.tag }
    }

    /// The square of the state.
    pub fn square(self) -> Quadratic {
        self.variable.square()
    }
}

impl From<State> for Variable {
    fn from(state: State) -> Self {
        state.variable
    }
}

impl From<State> for Affine {
    fn from(state: State) -> Self {
        state.variable.into()
    }
}

impl From<&State> for Affine {
    fn from(state: &State) -> Self {
        state.variable.into()
    }
}

impl From<State> for Quadratic {
    fn from(state: State) -> Self {
        state.variable.into()
    }
}

comparisons!(State);
sums!(Affine:
    State, State; State, f64; f64, State; &State, f64; f64, &State;
    State, Variable; Variable, State; State, Literal; Literal, State;
    State, Affine; State, &Affine; Affine, State; &Affine, State;
);
sums!(Quadratic:
    Quadratic, State; &Quadratic, State; State, Quadratic; State, &Quadratic;
);
scaling!(State => Affine; &State => Affine);
products!(
    State, State; State, Variable; Variable, State;
    State, Affine; State, &Affine; Affine, State; &Affine, State;
);

/// The thing that a handle stands for.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Meaning {
    /// A state at the start of the step, by its number.
    State(usize),
    /// The prediction of a state, by the state's number.
    Prediction(usize),
    /// An input, by its number.
    Input(usize),
    /// A number by step, with its name.
    Series(String, Schedule<f64>),
    /// Whether a choice, by its number, is in a mode.
    InMode(usize, String),
    /// Whether a choice, by its number, takes a transition, by its number in the choice.
    Taken(usize, usize),
    /// An output, by its name.
    Output(String),
}

/// The handles of a system, by their index.
#[derive(Debug, Clone)]
pub(crate) struct Handles {
    pub(crate) tag: ModelTag,
    meanings: Vec<Meaning>,
}

impl Default for Handles {
    fn default() -> Self {
        Handles { tag: ModelTag::fresh(), meanings: Vec::new() }
    }
}

impl Handles {
    /// The handle of a thing, which is declared if it is new.
    pub(crate) fn of(&mut self, meaning: Meaning) -> Variable {
        let index = self.meanings.iter().position(|known| *known == meaning);
        let index = index.unwrap_or_else(|| {
            self.meanings.push(meaning);
            self.meanings.len() - 1
        });
        Variable::new(index, self.tag)
    }

    /// The handle of a state and, right after it, of its prediction.
    pub(crate) fn state(&mut self, number: usize) -> State {
        let variable = self.of(Meaning::State(number));
        self.of(Meaning::Prediction(number));
        State { variable }
    }

    /// What a handle stands for; `None` if it is of another system.
    pub(crate) fn meaning(&self, variable: Variable) -> Option<&Meaning> {
        self.meanings.get(variable.index()).filter(|_| variable.tag == self.tag)
    }

    /// Whether there is a handle of a kind.
    pub(super) fn is_any(&self, wanted: impl Fn(&Meaning) -> bool) -> bool {
        self.meanings.iter().any(wanted)
    }

    /// Whether the name of a series is taken.
    pub(super) fn has_series(&self, name: &str) -> bool {
        self.series().any(|(own, _)| own == name)
    }

    pub(super) fn series(&self) -> impl Iterator<Item = (&str, &Schedule<f64>)> {
        self.meanings.iter().filter_map(|meaning| match meaning {
            Meaning::Series(name, values) => Some((name.as_str(), values)),
            _ => None,
        })
    }

    /// Moves all series to a later beginning.
    pub(super) fn begin_at(&mut self, step: usize) {
        for meaning in &mut self.meanings {
            if let Meaning::Series(_, values) = meaning {
                *values = values.from_step(step);
            }
        }
    }
}

impl HybridSystem {
    /// What a handle stands for.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::ForeignHandle`].
    pub(crate) fn meaning(&self, variable: Variable, place: &str) -> Result<&Meaning, Error> {
        self.handles.meaning(variable).ok_or_else(|| {
            let (kind, index, place) = ("variable", variable.index(), place.to_owned());
            ErrorKind::ForeignHandle { kind, index, place }.into()
        })
    }

    /// A handle in words.
    pub(crate) fn handle_name(&self, variable: Variable) -> String {
        let state = |i: &usize| self.states.get(*i).map_or("", |(name, _)| name);
        match self.handles.meaning(variable) {
            Some(Meaning::State(i)) => state(i).to_owned(),
            Some(Meaning::Prediction(i)) => format!("{}'", state(i)),
            Some(Meaning::Input(u)) => self.inputs.get(*u).map_or("", |(name, _)| name).to_owned(),
            Some(Meaning::Series(name, _) | Meaning::Output(name)) => name.clone(),
            Some(Meaning::InMode(choice, mode)) => {
                let choice = self.choices.get(*choice).map_or("", |choice| &choice.name);
                format!("{choice} is {mode}")
            }
            Some(Meaning::Taken(choice, number)) => {
                let choice = self.choices.get(*choice);
                let taken = choice.and_then(|choice| choice.transitions.get(*number));
                taken.map_or(String::new(), |transition| transition.name.clone())
            }
            None => format!("#{}", variable.index()),
        }
    }

    /// The handle of a state, by its name: for a system that was read or made from matrices.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::UnknownName`].
    pub fn state_named(&self, name: &str) -> Result<State, Error> {
        let number = self.states.iter().position(|(own, _)| own == name);
        let number = number.ok_or_else(|| unknown(name, "state of the system"))?;
        self.find(&Meaning::State(number)).map(|variable| State { variable })
    }

    /// The handle of an input, by its name.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::UnknownName`].
    pub fn input_named(&self, name: &str) -> Result<Variable, Error> {
        let number = self.inputs.iter().position(|(own, _)| own == name);
        let number = number.ok_or_else(|| unknown(name, "input of the system"))?;
        self.find(&Meaning::Input(number))
    }

    /// The handle of a transition, by the names of its choice (`mode` if there is only one) and its
    /// own: 1 in the steps that take it, 0 in the others.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::UnknownName`].
    pub fn transition_named(&self, choice: &str, name: &str) -> Result<Variable, Error> {
        let number = self.choices.iter().position(|own| own.name == choice);
        let number = number.ok_or_else(|| unknown(choice, "choice of the system"))?;
        let taken = self.choices[number].transitions.iter().position(|own| own.name == name);
        let taken = taken.ok_or_else(|| unknown(name, "transition of the choice"))?;
        self.find(&Meaning::Taken(number, taken))
    }

    /// The handle of a mode with memory, by the names of its choice and its own: 1 at the samples in the
    /// mode, 0 at the others.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::UnknownName`].
    pub fn mode_named(&self, choice: &str, name: &str) -> Result<Variable, Error> {
        let number = self.choices.iter().position(|own| own.name == choice);
        let number = number.ok_or_else(|| unknown(choice, "choice of the system"))?;
        if !self.choices[number].modes().contains(&name) {
            return Err(unknown(name, "mode of the choice"));
        }
        self.find(&Meaning::InMode(number, name.to_owned()))
    }

    /// The handle of an output, by its name.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::UnknownName`].
    pub fn output_named(&self, name: &str) -> Result<Variable, Error> {
        let mut outputs = self.transitions().flat_map(|transition| &transition.outputs);
        if !outputs.any(|own| own.name == name) {
            return Err(unknown(name, "output of the system"));
        }
        self.find(&Meaning::Output(name.to_owned()))
    }

    fn find(&self, meaning: &Meaning) -> Result<Variable, Error> {
        let index = self.handles.meanings.iter().position(|known| known == meaning);
        let found = index.map(|index| Variable::new(index, self.handles.tag));
        found.ok_or_else(|| Error::out_of_range("the handles of the system", 0.0, "complete"))
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

pub(super) fn unknown(name: &str, kind: &'static str) -> Error {
    ErrorKind::UnknownName { name: name.to_owned(), kind }.into()
}
