//! Handles of a hybrid system: its expressions and rows are written with them.
//!
//! | handle | type | in an expression |
//! | --- | --- | --- |
//! | state | [`State`] | its value at the start of the step, or at the sample |
//! | prediction of a state | [`Variable`] | the result of the flow, before a reset |
//! | input | [`Input`] | its value in the step |
//! | series | [`Variable`] | a number that is known for each step |
//! | mode | [`Variable`] | 1 at the samples in the mode, 0 at the others |
//! | acting mode | [`Variable`] | 1 in the steps after which the mode holds, 0 in the others |
//! | transition | [`Variable`] | 1 in the steps that take it, 0 in the others |
//! | output | [`Variable`] | its value in the step |

use std::ops::{Add, Div, Mul, Neg, Sub};

use super::schedule::Schedule;
use crate::model::{
    Affine, Literal, ModelTag, Nonlinear, Quadratic, Row, Variable, comparisons, functions,
    nonlinear_products, products, quotients, scaling, sums,
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
    /// The state with a handle.
    pub(crate) fn of(variable: Variable) -> Self {
        State { variable }
    }

    /// The value at the end of the step that the flow predicts, before a reset, in the state's
    /// unit. For guards, resets and outputs.
    ///
    /// With several choices, each predicts by its own flow: the common one with what the choice
    /// changes about it, without what the others do. So a guard on the prediction of a state whose
    /// flow another choice changes as well is [refused](crate::hybrid::HybridSystem::check); resets
    /// and outputs are functions of what their own choice predicts, and resets of other choices
    /// come after it.
    pub fn predicted(self) -> Variable {
        // The prediction is declared right after its state.
        self.variable.successor()
    }

    /// An entry of [`rates`](crate::hybrid::HybridSystem::rates),
    /// [`next`](crate::hybrid::HybridSystem::next) or
    /// [`reset`](crate::hybrid::TransitionMut::reset): the state with its derivative, its next
    /// value or its value after the reset.
    pub fn is(self, value: impl Into<Nonlinear>) -> (State, Nonlinear) {
        (self, value.into())
    }
}

/// An input of a [`HybridSystem`](crate::hybrid::HybridSystem), made by
/// [`input`](crate::hybrid::HybridSystem::input).
///
/// In an expression it stands for its value in the step that begins at the sample at which the
/// expression is taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Input {
    variable: Variable,
}

impl Input {
    /// The input with a handle.
    pub(crate) fn of(variable: Variable) -> Self {
        Input { variable }
    }
}

/// The operators of a handle in expressions.
macro_rules! handle {
    ($($type:ident),+) => {$(
        impl $type {
            /// The square.
            pub fn square(self) -> Quadratic {
                self.variable.square()
            }
        }

        impl From<$type> for Variable {
            fn from(handle: $type) -> Self {
                handle.variable
            }
        }

        impl From<$type> for Affine {
            fn from(handle: $type) -> Self {
                handle.variable.into()
            }
        }

        impl From<&$type> for Affine {
            fn from(handle: &$type) -> Self {
                handle.variable.into()
            }
        }

        impl From<$type> for Quadratic {
            fn from(handle: $type) -> Self {
                handle.variable.into()
            }
        }

        impl From<$type> for Nonlinear {
            fn from(handle: $type) -> Self {
                handle.variable.into()
            }
        }

        impl From<&$type> for Nonlinear {
            fn from(handle: &$type) -> Self {
                handle.variable.into()
            }
        }

        comparisons!($type);
        functions!($type);
        nonlinear_products!(
            $type, Nonlinear; Nonlinear, $type; $type, &Nonlinear; &Nonlinear, $type;
            $type, Quadratic; Quadratic, $type; $type, &Quadratic; &Quadratic, $type;
        );
        sums!(Nonlinear:
            Nonlinear, $type; $type, Nonlinear; &Nonlinear, $type; $type, &Nonlinear;
        );
        quotients!(
            $type: f64, Variable, Affine, &Affine, Quadratic, Nonlinear, &Nonlinear;
            f64: $type; Variable: $type; Affine: $type; &Affine: $type; Quadratic: $type;
            Nonlinear: $type; &Nonlinear: $type;
        );
        sums!(Affine:
            $type, f64; f64, $type; &$type, f64; f64, &$type;
            $type, Variable; Variable, $type; $type, Literal; Literal, $type;
            $type, Affine; $type, &Affine; Affine, $type; &Affine, $type;
        );
        sums!(Quadratic:
            Quadratic, $type; &Quadratic, $type; $type, Quadratic; $type, &Quadratic;
        );
        scaling!($type => Affine; &$type => Affine);
        products!(
            $type, Variable; Variable, $type;
            $type, Affine; $type, &Affine; Affine, $type; &Affine, $type;
        );
    )+};
}

handle!(State, Input);
sums!(Affine: State, State; State, Input; Input, State; Input, Input);
products!(State, State; State, Input; Input, State; Input, Input);
quotients!(State: State, Input; Input: State, Input);

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
    /// Whether the mode of a choice, by its number, acts in a step: it is the one that is entered
    /// or kept.
    Acting(usize, String),
    /// Whether a choice, by its number, takes a transition, by its number in the choice.
    Taken(usize, usize),
    /// An output, by its name.
    Output(String),
}

/// The handles of a system, by their index.
#[derive(Debug, Clone)]
pub(crate) struct Handles {
    pub(crate) tag: ModelTag,
    /// `None` for those that stand for nothing.
    meanings: Vec<Option<Meaning>>,
}

impl Default for Handles {
    fn default() -> Self {
        Handles { tag: ModelTag::fresh(), meanings: Vec::new() }
    }
}

impl Handles {
    /// Handles with a tag, none of which is declared yet.
    pub(crate) fn with_tag(tag: ModelTag) -> Self {
        Handles { tag, meanings: Vec::new() }
    }

    /// Gives the handles another tag, so that those of before are foreign to it.
    pub(crate) fn renew(&mut self) {
        self.tag = ModelTag::fresh();
    }

    /// The handle of a thing, which is declared if it is new.
    pub(crate) fn of(&mut self, meaning: Meaning) -> Variable {
        let index = self.meanings.iter().position(|known| known.as_ref() == Some(&meaning));
        let index = index.unwrap_or_else(|| {
            self.meanings.push(Some(meaning));
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

    /// Takes back the handle that was declared last.
    pub(super) fn take_back(&mut self) {
        self.meanings.pop();
    }

    /// Declares handles that stand for nothing.
    pub(crate) fn skip(&mut self, count: usize) {
        self.meanings.extend((0..count).map(|_| None));
    }

    /// The meaning of a handle; `None` if it has none, or is of another system.
    pub(crate) fn meaning(&self, variable: Variable) -> Option<&Meaning> {
        self.meanings.get(variable.index())?.as_ref().filter(|_| variable.tag() == self.tag)
    }

    /// The handle of a thing, if it is declared.
    pub(super) fn find(&self, meaning: &Meaning) -> Option<Variable> {
        let index = self.meanings.iter().position(|known| known.as_ref() == Some(meaning))?;
        Some(Variable::new(index, self.tag))
    }

    /// The handle of a state, if it is declared.
    pub(super) fn find_state(&self, number: usize) -> Option<State> {
        self.find(&Meaning::State(number)).map(|variable| State { variable })
    }

    /// All handles, in the order of their index.
    pub(super) fn all(&self) -> impl Iterator<Item = Variable> + '_ {
        (0..self.meanings.len()).map(|index| Variable::new(index, self.tag))
    }

    /// The names of the outputs, in the order of their declaration.
    pub(super) fn outputs(&self) -> impl Iterator<Item = &str> {
        self.meanings.iter().flatten().filter_map(|meaning| match meaning {
            Meaning::Output(name) => Some(name.as_str()),
            _ => None,
        })
    }

    /// Whether there is a handle of a kind.
    pub(super) fn is_any(&self, wanted: impl Fn(&Meaning) -> bool) -> bool {
        self.meanings.iter().flatten().any(wanted)
    }

    /// Whether the name of a series is taken.
    pub(super) fn has_series(&self, name: &str) -> bool {
        self.series().any(|(own, _)| own == name)
    }

    pub(super) fn series(&self) -> impl Iterator<Item = (&str, &Schedule<f64>)> {
        self.meanings.iter().flatten().filter_map(|meaning| match meaning {
            Meaning::Series(name, values) => Some((name.as_str(), values)),
            _ => None,
        })
    }

    /// Moves all series to a later beginning.
    pub(super) fn begin_at(&mut self, step: usize) {
        for meaning in self.meanings.iter_mut().flatten() {
            if let Meaning::Series(_, values) = meaning {
                *values = values.from_step(step);
            }
        }
    }
}
