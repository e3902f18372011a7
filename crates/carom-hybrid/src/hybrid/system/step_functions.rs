//! The nonlinear functions of a step: each is an input of the system that has one value.
//!
//! Flows are linear in states and inputs. A flow with functions is linear in them, too, so that
//! each function of a step becomes an input whose range is that of the function over the domains.
//! All that knows inputs then knows it: rows say what the input equals, simulators compute it, and
//! reach sets let it be anything in its range, which loses no run.

use super::discretization::Discretization;
use super::schedule::Schedule;
use crate::elementary::IntervalSeries;
use crate::error::{Error, ErrorKind};
use crate::hybrid::linear::LinearSystem;
use crate::interval::Interval;
use crate::model::{Affine, Elementary, Function, Model, Nonlinear, Variable, VariableKind};

/// The part of a step that an argument of a function names.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) enum StepSlot {
    /// A state at the start of the step, by its number.
    State(usize),
    /// The prediction of a state, by the state's number.
    Prediction(usize),
    /// An input in the step, by its number.
    Input(usize),
}

/// The functions of a step, in an order in which each is one of states, inputs and those before.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct StepFunctions {
    /// States, predictions, inputs and functions as variables.
    pub(super) model: Model,
    /// The part of a step that each variable stands for.
    pub(super) slots: Vec<StepSlot>,
    /// How rates with functions become steps.
    pub(super) method: Discretization,
    /// The rates of flows with functions, over the variables of the model.
    pub(super) rates: Vec<(LinearSystem, Vec<Nonlinear>)>,
}

impl Default for StepFunctions {
    fn default() -> Self {
        StepFunctions {
            model: Model::new("step"),
            slots: Vec::new(),
            method: Discretization::default(),
            rates: Vec::new(),
        }
    }
}

impl PartialEq for StepFunctions {
    fn eq(&self, other: &Self) -> bool {
        let functions = |own: &StepFunctions| -> Vec<String> {
            own.model.functions().map(|own_function| own.text(own_function.function())).collect()
        };
        self.slots == other.slots && functions(self) == functions(other)
    }
}

impl StepFunctions {
    /// Whether there is none.
    pub(crate) fn is_empty(&self) -> bool {
        !cfg!(feature = "nonlinear") || self.model.function_count() == 0
    }

    /// The variable of a part of a step, if it is known.
    pub(super) fn variable(&self, slot: StepSlot) -> Option<Variable> {
        let index = self.slots.iter().position(|own| *own == slot)?;
        Some(Variable::new(index, self.model.tag()))
    }

    /// The part of a step that a variable stands for.
    pub(super) fn slot(&self, variable: Variable) -> Option<StepSlot> {
        self.slots.get(variable.index()).copied()
    }

    /// The functions with the numbers of their inputs.
    pub(crate) fn iter(&self) -> impl Iterator<Item = (usize, &Function)> {
        self.model.functions().filter_map(|own| match self.slot(own.result())? {
            StepSlot::Input(number) => Some((number, own.function())),
            _ => None,
        })
    }

    /// Whether an input is the value of a function.
    pub(crate) fn is_function(&self, input: usize) -> bool {
        !self.is_empty() && self.iter().any(|(number, _)| number == input)
    }

    /// A function with names in the place of its variables.
    pub(crate) fn text(&self, function: &Function) -> String {
        function.text(&|variable| {
            let name = self.model.variable_ref(variable).map(|own| own.name().to_string());
            name.unwrap_or_default()
        })
    }

    /// Whether a function depends on predictions, as in implicit methods.
    pub(crate) fn use_predictions(&self) -> bool {
        if self.is_empty() {
            return false;
        }
        let arguments = self.iter().flat_map(|(_, function)| function.expressions());
        let mut variables = arguments.flat_map(|own| own.terms()).map(|(variable, _)| variable);
        variables.any(|variable| matches!(self.slot(variable), Some(StepSlot::Prediction(_))))
    }

    /// A function with the parts of its arguments as expressions of something else.
    pub(crate) fn over(
        &self,
        function: &Function,
        mut part: impl FnMut(StepSlot) -> Result<Affine, Error>,
    ) -> Result<Option<Function>, Error> {
        function.try_map(|argument| {
            let mut sum = Affine::constant(argument.offset());
            for (variable, factor) in argument.terms() {
                if let Some(slot) = self.slot(variable) {
                    sum += factor * part(slot)?;
                }
            }
            Ok(sum)
        })
    }

    /// Puts the values of the functions into the inputs of a step.
    pub(crate) fn fill(&self, state: &[f64], prediction: &[f64], input: &mut [f64]) {
        for (number, function) in self.iter() {
            let value = function.evaluate(|variable| match self.slot(variable) {
                Some(StepSlot::State(i)) => state.get(i).copied().unwrap_or(f64::NAN),
                Some(StepSlot::Prediction(i)) => prediction.get(i).copied().unwrap_or(f64::NAN),
                Some(StepSlot::Input(u)) => input.get(u).copied().unwrap_or(f64::NAN),
                None => f64::NAN,
            });
            if let Some(own) = input.get_mut(number) {
                *own = value;
            }
        }
    }

    /// The derivatives of the states that a flow was stated with, in their units per second;
    /// `None` for a flow without functions, and for one by next values.
    pub(crate) fn rates(
        &self,
        flow: &LinearSystem,
        state: &[f64],
        input: &[f64],
    ) -> Option<Vec<f64>> {
        let (_, rates) = self.rates.iter().find(|(own, _)| own == flow)?;
        let value = |variable| match self.slot(variable) {
            Some(StepSlot::State(i)) => state.get(i).copied().unwrap_or(f64::NAN),
            Some(StepSlot::Input(u)) => input.get(u).copied().unwrap_or(f64::NAN),
            Some(StepSlot::Prediction(_)) | None => f64::NAN,
        };
        Some(rates.iter().map(|own| own.evaluate(value)).collect())
    }

    /// Whether a flow was stated by nonlinear rates.
    pub(crate) fn is_stated_by_rates(&self, flow: &LinearSystem) -> bool {
        self.rates.iter().any(|(own, _)| own == flow)
    }

    /// The derivatives of the states of such a flow as series, for series of states; `None` where
    /// they have no value or are not smooth enough.
    pub(crate) fn rate_series(
        &self,
        flow: &LinearSystem,
        states: &[IntervalSeries],
        inputs: &[IntervalSeries],
        count: usize,
    ) -> Option<Vec<IntervalSeries>> {
        let (_, rates) = self.rates.iter().find(|(own, _)| own == flow)?;
        let of = |variable: Variable| match self.slot(variable) {
            Some(StepSlot::State(i)) if i < states.len() => states[i].clone(),
            Some(StepSlot::Input(u)) if u < inputs.len() => inputs[u].clone(),
            _ => IntervalSeries::constant(Interval::REALS, count),
        };
        rates.iter().map(|own| own.series(&of, count)).collect()
    }

    /// The ranges of all inputs, where those that are no functions have these.
    pub(crate) fn ranges(&self, states: &[Interval], inputs: &[Interval]) -> Vec<Interval> {
        let mut open = inputs.to_vec();
        for (number, _) in self.iter() {
            open.iter_mut().skip(number).take(1).for_each(|own| *own = Interval::REALS);
        }
        self.narrowed(states, &[], &open)
    }

    /// The ranges of all inputs, where those of functions are no wider than their values over
    /// states and predictions.
    pub(crate) fn narrowed(
        &self,
        states: &[Interval],
        predictions: &[Interval],
        inputs: &[Interval],
    ) -> Vec<Interval> {
        let mut inputs = inputs.to_vec();
        for (number, function) in self.iter() {
            let range = function.range(|variable| match self.slot(variable) {
                Some(StepSlot::State(i)) => states.get(i).copied().unwrap_or(Interval::REALS),
                Some(StepSlot::Prediction(i)) => {
                    predictions.get(i).copied().unwrap_or(Interval::REALS)
                }
                Some(StepSlot::Input(u)) => inputs.get(u).copied().unwrap_or(Interval::REALS),
                None => Interval::REALS,
            });
            if let Some(own) = inputs.get_mut(number) {
                let both = own.intersection(range);
                if both.lower <= both.upper {
                    *own = both;
                }
            }
        }
        inputs
    }

    /// Whether a flow uses a function.
    pub(crate) fn uses(&self, flow: &LinearSystem) -> bool {
        let is_used = |u: usize| (0..flow.states()).any(|i| flow.b()[(i, u)] != 0.0);
        self.iter().any(|(number, _)| number < flow.inputs() && is_used(number))
    }

    /// Whether a flow is stated by nonlinear rates.
    pub(super) fn has_rates(&self) -> bool {
        !self.rates.is_empty()
    }

    /// Gives all flows an input that changes nothing.
    pub(super) fn add_idle_input(&mut self) {
        self.rates.iter_mut().for_each(|(flow, _)| *flow = flow.with_idle_input());
    }
}

impl StepFunctions {
    /// Declares the states and inputs that are not known yet.
    pub(super) fn declare(
        &mut self,
        states: &[(String, Interval)],
        inputs: &[(String, Schedule<Interval>)],
    ) -> Result<(), Error> {
        for (i, (name, domain)) in states.iter().enumerate() {
            if self.variable(StepSlot::State(i)).is_none() {
                self.add(name, *domain, StepSlot::State(i))?;
                self.add(&format!("{name}_next"), *domain, StepSlot::Prediction(i))?;
            }
        }
        for (u, (name, range)) in inputs.iter().enumerate() {
            if self.variable(StepSlot::Input(u)).is_none() {
                let hull = range.values().copied().reduce(|a, b| a.hull(b));
                self.add(name, hull.unwrap_or(Interval::REALS), StepSlot::Input(u))?;
            }
        }
        Ok(())
    }

    /// The error for a function without a finite range: it has a pole, or overflows.
    pub(super) fn infinite(
        &self,
        function: &Function,
        ranges: &[Interval],
        range: Interval,
    ) -> Error {
        let text = self.text(function);
        let has_pole = match function {
            Function::Quotient(_) => true,
            Function::Elementary { function, .. } => match function {
                Elementary::Tan | Elementary::Ln => true,
                Elementary::Power(p) => *p < 0.0,
                _ => false,
            },
            _ => false,
        };
        if !has_pole {
            return Error::out_of_range_in_words(
                format!("the value of `{text}` over the domains"),
                if range.upper.is_finite() { range.lower } else { range.upper },
                ..,
                "finite; narrow the domains, shorten the time step or choose another method",
            );
        }
        let of = function.expressions().last().map_or(Interval::REALS, |own| {
            let terms = own.terms().into_iter().map(|(v, a)| (a, ranges[v.index()]));
            crate::activity::range(own.offset(), terms)
        });
        ErrorKind::Pole { function: text, range: (of.lower, of.upper) }.into()
    }

    fn add(&mut self, name: &str, range: Interval, slot: StepSlot) -> Result<(), Error> {
        let kind = VariableKind::Continuous;
        self.model.variable(name, kind, range.lower, range.upper)?;
        self.slots.push(slot);
        Ok(())
    }

    /// Next values, solved for the predictions in them.
    pub(super) fn linear(
        &self,
        next: &[Affine],
        n: usize,
        m: usize,
    ) -> Result<LinearSystem, Error> {
        let mut start = faer::Mat::<f64>::zeros(n, n + m + 1);
        let mut implicit = faer::Mat::<f64>::identity(n, n);
        let mut is_implicit = false;
        for (i, own) in next.iter().enumerate() {
            start[(i, n + m)] = own.offset();
            for (variable, factor) in own.terms() {
                match self.slot(variable) {
                    Some(StepSlot::State(j)) => start[(i, j)] += factor,
                    Some(StepSlot::Input(u)) => start[(i, n + u)] += factor,
                    Some(StepSlot::Prediction(j)) => {
                        implicit[(i, j)] -= factor;
                        is_implicit = true;
                    }
                    None => {}
                }
            }
        }
        if is_implicit {
            use faer::linalg::solvers::Solve;
            start = implicit.partial_piv_lu().solve(&start);
        }
        let a = faer::Mat::from_fn(n, n, |i, j| start[(i, j)]);
        let b = faer::Mat::from_fn(n, m, |i, j| start[(i, n + j)]);
        let c: Vec<f64> = (0..n).map(|i| start[(i, n + m)]).collect();
        LinearSystem::new(a, b, c)
    }
}
