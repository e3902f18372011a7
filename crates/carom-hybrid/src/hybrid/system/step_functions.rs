//! The nonlinear functions of a step: each is an input of the system that has one value.
//!
//! Flows are linear in states and inputs. A flow with functions is linear in them, too, so that
//! each function of a step becomes an input whose range is that of the function over the domains.
//! All that knows inputs then knows it: rows say what the input equals, simulators compute it, and
//! reach sets let it be anything in its range, which loses no run.

use super::HybridSystem;
use super::discretization::Discretization;
use super::handles::Meaning;
use super::schedule::Schedule;
use super::state_row::StateRow;
use crate::elementary::IntervalSeries;
use crate::error::{Error, ErrorKind, check_finite};
use crate::hybrid::linear::LinearSystem;
use crate::interval::Interval;
use crate::model::{
    Affine, Elementary, Function, Model, Nonlinear, NonlinearRow, Row, Variable, VariableKind,
};

/// The part of a step that an argument of a function names.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) enum Slot {
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
    model: Model,
    /// What each variable stands for.
    slots: Vec<Slot>,
    /// How rates with functions become steps.
    pub(super) method: Discretization,
    /// The rates of flows with functions, over the variables of the model.
    rates: Vec<(LinearSystem, Vec<Nonlinear>)>,
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
        self.model.function_count() == 0
    }

    /// The variable of a part of a step, if it is known.
    fn variable(&self, slot: Slot) -> Option<Variable> {
        let index = self.slots.iter().position(|own| *own == slot)?;
        Some(Variable::new(index, self.model.tag()))
    }

    /// The part of a step that a variable stands for.
    fn slot(&self, variable: Variable) -> Option<Slot> {
        self.slots.get(variable.index()).copied()
    }

    /// The functions with the numbers of their inputs.
    pub(crate) fn iter(&self) -> impl Iterator<Item = (usize, &Function)> {
        self.model.functions().filter_map(|own| match self.slot(own.result())? {
            Slot::Input(number) => Some((number, own.function())),
            _ => None,
        })
    }

    /// Whether an input is the value of a function.
    pub(crate) fn is_function(&self, input: usize) -> bool {
        self.iter().any(|(number, _)| number == input)
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
        let arguments = self.iter().flat_map(|(_, function)| function.expressions());
        let mut variables = arguments.flat_map(|own| own.terms()).map(|(variable, _)| variable);
        variables.any(|variable| matches!(self.slot(variable), Some(Slot::Prediction(_))))
    }

    /// A function with the parts of its arguments as expressions of something else.
    pub(crate) fn over(
        &self,
        function: &Function,
        mut part: impl FnMut(Slot) -> Result<Affine, Error>,
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
                Some(Slot::State(i)) => state.get(i).copied().unwrap_or(f64::NAN),
                Some(Slot::Prediction(i)) => prediction.get(i).copied().unwrap_or(f64::NAN),
                Some(Slot::Input(u)) => input.get(u).copied().unwrap_or(f64::NAN),
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
            Some(Slot::State(i)) => state.get(i).copied().unwrap_or(f64::NAN),
            Some(Slot::Input(u)) => input.get(u).copied().unwrap_or(f64::NAN),
            Some(Slot::Prediction(_)) | None => f64::NAN,
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
            Some(Slot::State(i)) if i < states.len() => states[i].clone(),
            Some(Slot::Input(u)) if u < inputs.len() => inputs[u].clone(),
            _ => IntervalSeries::constant(Interval::REALS, count),
        };
        rates.iter().map(|own| own.series(&of, count)).collect()
    }

    /// The ranges of all inputs, where those that are no functions have these.
    pub(crate) fn ranges(&self, states: &[Interval], inputs: &[Interval]) -> Vec<Interval> {
        let mut inputs = inputs.to_vec();
        for (number, function) in self.iter() {
            let range = function.range(|variable| match self.slot(variable) {
                Some(Slot::State(i)) => states.get(i).copied().unwrap_or(Interval::REALS),
                Some(Slot::Input(u)) => inputs.get(u).copied().unwrap_or(Interval::REALS),
                Some(Slot::Prediction(_)) | None => Interval::REALS,
            });
            if let Some(own) = inputs.get_mut(number) {
                *own = range;
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

/// The functions while a flow is added to them.
pub(super) struct FlowFunctions<'a> {
    functions: &'a mut StepFunctions,
    /// The variables of the states at the start of the step, and those of the predictions.
    pub(super) start: Vec<Affine>,
    pub(super) end: Vec<Affine>,
    /// The rows of the flow, over the variables.
    rows: Vec<Nonlinear>,
    /// The names of the states.
    names: Vec<String>,
}

impl FlowFunctions<'_> {
    /// The rows at other states than those at the start, as expressions of the variables.
    pub(super) fn at(&mut self, states: &[Affine]) -> Result<Vec<Affine>, Error> {
        let functions = &mut *self.functions;
        let slots = &functions.slots;
        let mut values = Vec::with_capacity(self.rows.len());
        for (row, name) in self.rows.iter().zip(&self.names) {
            let moved = row.try_map(&mut |own: &Affine| {
                let mut sum = Affine::constant(own.offset());
                for (variable, factor) in own.terms() {
                    match slots.get(variable.index()) {
                        Some(Slot::State(i)) => sum += factor * &states[*i],
                        _ => sum.add_term(factor, variable),
                    }
                }
                Ok(sum)
            })?;
            values.push(functions.model.nonlinear(name.as_str(), moved)?);
        }
        Ok(values)
    }
}

impl HybridSystem {
    /// Whether a flow has functions.
    pub(crate) fn is_nonlinear(&self) -> bool {
        !self.functions.is_empty()
    }

    /// Refuses nonlinear flows.
    ///
    /// # Arguments
    ///
    /// * `place`: what cannot have them.
    pub(crate) fn check_is_linear(&self, place: &str) -> Result<(), Error> {
        let Some((number, function)) = self.functions.iter().next() else { return Ok(()) };
        let function = self.functions.text(function);
        let name = format!("the function `{}` = `{function}`", self.inputs[number].0);
        let help =
            "it knows linear flows only; state a linear one, or plan by `program` and `shortest`";
        Err(ErrorKind::Misplaced { name, place: place.to_owned(), help }.into())
    }

    /// The input of a step with the values of the functions in it.
    ///
    /// # Arguments
    ///
    /// * `prediction`: of the states; read only by implicit methods.
    pub(crate) fn with_function_values(
        &self,
        state: &[f64],
        prediction: &[f64],
        input: &[f64],
    ) -> Vec<f64> {
        let mut input = input.to_vec();
        self.functions.fill(state, prediction, &mut input);
        input
    }

    /// A flow by rows with functions: linear in states, inputs and functions, each of which becomes
    /// an input.
    ///
    /// # Arguments
    ///
    /// * `rows`: over states and inputs.
    /// * `step`: the next values of the states, from the functions.
    pub(super) fn flow_of_functions(
        &mut self,
        rows: &[Nonlinear],
        are_rates: bool,
        step: impl FnOnce(&mut FlowFunctions<'_>) -> Result<Vec<Affine>, Error>,
    ) -> Result<LinearSystem, Error> {
        let (next, rows) = self.define_functions(rows, "a flow", step)?;
        let functions = &mut self.functions;
        let flow = functions.linear(&next, self.states.len(), self.inputs.len())?;
        if are_rates && functions.rates.iter().all(|(own, _)| *own != flow) {
            functions.rates.push((flow.clone(), rows));
        }
        Ok(flow)
    }

    /// An expression of states and inputs as an affine one of states, inputs and the inputs of its
    /// functions.
    pub(super) fn affine_of(
        &mut self,
        expression: &Nonlinear,
        place: &str,
    ) -> Result<Affine, Error> {
        if let Some(own) = expression.as_affine() {
            return Ok(own.clone());
        }
        let rows = vec![self.with_series_as_inputs(expression, place)?];
        let (values, _) = self.define_functions(&rows, place, |own| {
            let start = own.start.clone();
            own.at(&start)
        })?;
        let mut sum = Affine::zero();
        for value in values {
            sum += value.offset();
            for (variable, factor) in value.terms() {
                let handle = match self.functions.slot(variable) {
                    Some(Slot::State(i)) => self.handles.find_state(i).map(Variable::from),
                    Some(Slot::Input(u)) => Some(self.handles.of(Meaning::Input(u))),
                    Some(Slot::Prediction(_)) | None => None,
                };
                if let Some(handle) = handle {
                    sum.add_term(factor, handle);
                }
            }
        }
        Ok(sum)
    }

    /// A nonlinear row as one of the inputs of its functions.
    pub(super) fn with_functions_as_inputs(
        &mut self,
        row: &NonlinearRow,
        place: &str,
    ) -> Result<Row, Error> {
        let left = self.affine_of(row.expression(), place)?;
        Ok(left.within(row.lower(), row.upper()))
    }

    /// Whether a row is one of states alone.
    pub(super) fn is_of_states(&self, row: &NonlinearRow) -> bool {
        let mut is_of_states = true;
        let visited = row.try_map(&mut |own: &Affine| {
            let is_state = |(handle, _): (Variable, f64)| {
                matches!(self.handles.meaning(handle), Some(Meaning::State(_)))
            };
            is_of_states &= own.terms().into_iter().all(is_state);
            Ok(own.clone())
        });
        visited.is_ok() && is_of_states
    }

    /// A nonlinear row with the names of its handles.
    pub(super) fn nonlinear_text(&self, row: &NonlinearRow) -> String {
        row.text(&|variable| self.handle_name(variable))
    }

    /// A nonlinear row of states.
    pub(super) fn state_row(
        &self,
        name: Option<(&str, bool)>,
        row: &NonlinearRow,
        place: &str,
        help: &'static str,
    ) -> Result<StateRow, Error> {
        let mut states: Vec<(Variable, usize)> = Vec::new();
        let _visited = row.try_map(&mut |own: &Affine| {
            let numbers = own.raw_terms().iter().map(|&(_, factor)| factor);
            check_finite(place, "a number", numbers.chain([own.offset()]))?;
            for (handle, _) in own.terms() {
                match self.meaning(handle, place)? {
                    Meaning::State(i) if !states.contains(&(handle, *i)) => {
                        states.push((handle, *i));
                    }
                    Meaning::State(_) => {}
                    _ => return Err(self.misplaced(handle, place, help)),
                }
            }
            Ok(own.clone())
        })?;
        let text = name.map_or_else(|| self.nonlinear_text(row), |(name, _)| name.to_owned());
        let is_limit = name.is_some_and(|(_, is_limit)| is_limit);
        Ok(StateRow::new(text, is_limit, row.clone(), states))
    }

    /// Defines what functions of rows need.
    ///
    /// # Returns
    ///
    /// The values, and the rows, over the variables of the functions.
    fn define_functions(
        &mut self,
        rows: &[Nonlinear],
        place: &str,
        step: impl FnOnce(&mut FlowFunctions<'_>) -> Result<Vec<Affine>, Error>,
    ) -> Result<(Vec<Affine>, Vec<Nonlinear>), Error> {
        let mut functions = self.functions.clone();
        functions.declare(self)?;
        let known = functions.model.function_count();
        let part = |variable: Variable| match self.handles.meaning(variable) {
            Some(Meaning::State(i)) => functions.variable(Slot::State(*i)),
            Some(Meaning::Input(u)) => functions.variable(Slot::Input(*u)),
            _ => None,
        };
        let over = |own: &Affine| {
            let mut sum = Affine::constant(own.offset());
            for (handle, factor) in own.terms() {
                self.meaning(handle, place)?;
                let variable = part(handle);
                let variable =
                    variable.ok_or_else(|| self.misplaced(handle, place, FUNCTION_HELP))?;
                sum.add_term(factor, variable);
            }
            Ok(sum)
        };
        let rows: Result<Vec<Nonlinear>, Error> =
            rows.iter().map(|row| row.try_map(&mut |own: &Affine| over(own))).collect();
        let rows = rows?;
        let n = self.states.len();
        let variables = |slot: fn(usize) -> Slot| -> Vec<Affine> {
            (0..n).filter_map(|i| functions.variable(slot(i))).map(Affine::from).collect()
        };
        let (start, end) = (variables(Slot::State), variables(Slot::Prediction));
        let names = self.states.iter().map(|(name, _)| name.clone()).collect();
        let mut own =
            FlowFunctions { functions: &mut functions, start, end, rows: rows.clone(), names };
        let values = step(&mut own)?;
        self.declare_functions(&mut functions, known)?;
        self.functions = functions;
        Ok((values, rows))
    }

    /// Makes inputs of functions that are new.
    fn declare_functions(
        &mut self,
        functions: &mut StepFunctions,
        known: usize,
    ) -> Result<(), Error> {
        let mut ranges: Vec<Interval> =
            functions.model.variables().map(|own| own.bounds()).collect();
        let all: Vec<(Variable, String)> =
            functions.model.functions().map(|own| (own.result(), own.name().to_string())).collect();
        for (k, (variable, name)) in all.into_iter().enumerate() {
            let function = functions.model.functions().nth(k).map(|own| own.function().clone());
            let Some(function) = function else { continue };
            let range = function.range(|v| ranges[v.index()]);
            if range.is_empty() {
                let text = functions.text(&function);
                let name = format!("{text}, which has no value over the domains");
                let Interval { lower, upper } = range;
                return Err(ErrorKind::CrossedBounds { name, lower, upper }.into());
            }
            if !range.lower.is_finite() || !range.upper.is_finite() {
                return Err(functions.infinite(&function, &ranges, range));
            }
            ranges[variable.index()] = range;
            if k < known {
                continue;
            }
            self.check_name(&name)?;
            functions.add_idle_input();
            self.add_idle_input();
            self.inputs.push((name, Schedule::from(range)));
            functions.slots.push(Slot::Input(self.inputs.len() - 1));
            self.handles.of(Meaning::Input(self.inputs.len() - 1));
        }
        Ok(())
    }
}

/// Where functions can stand.
const FUNCTION_HELP: &str = "functions are of states, inputs and series at the start of the step";

impl StepFunctions {
    /// Declares the states and inputs that are not known yet.
    fn declare(&mut self, system: &HybridSystem) -> Result<(), Error> {
        for (i, (name, domain)) in system.states.iter().enumerate() {
            if self.variable(Slot::State(i)).is_none() {
                self.add(name, *domain, Slot::State(i))?;
                self.add(&format!("{name}_next"), *domain, Slot::Prediction(i))?;
            }
        }
        for (u, (name, range)) in system.inputs.iter().enumerate() {
            if self.variable(Slot::Input(u)).is_none() {
                let hull = range.values().copied().reduce(|a, b| a.hull(b));
                self.add(name, hull.unwrap_or(Interval::REALS), Slot::Input(u))?;
            }
        }
        Ok(())
    }

    /// The error for a function without a finite range: it has a pole, or overflows.
    fn infinite(&self, function: &Function, ranges: &[Interval], range: Interval) -> Error {
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

    fn add(&mut self, name: &str, range: Interval, slot: Slot) -> Result<(), Error> {
        let kind = VariableKind::Continuous;
        self.model.variable(name, kind, range.lower, range.upper)?;
        self.slots.push(slot);
        Ok(())
    }

    /// Next values, solved for the predictions in them.
    fn linear(&self, next: &[Affine], n: usize, m: usize) -> Result<LinearSystem, Error> {
        let mut start = faer::Mat::<f64>::zeros(n, n + m + 1);
        let mut implicit = faer::Mat::<f64>::identity(n, n);
        let mut is_implicit = false;
        for (i, own) in next.iter().enumerate() {
            start[(i, n + m)] = own.offset();
            for (variable, factor) in own.terms() {
                match self.slot(variable) {
                    Some(Slot::State(j)) => start[(i, j)] += factor,
                    Some(Slot::Input(u)) => start[(i, n + u)] += factor,
                    Some(Slot::Prediction(j)) => {
                        implicit[(i, j)] -= factor;
                        is_implicit = true;
                    }
                    None => {}
                }
            }
        }
        if is_implicit {
            use faer::linalg::solvers::Solve;
            implicit.full_piv_lu().solve_in_place(start.as_mut());
        }
        let a = faer::Mat::from_fn(n, n, |i, j| start[(i, j)]);
        let b = faer::Mat::from_fn(n, m, |i, j| start[(i, n + j)]);
        let c: Vec<f64> = (0..n).map(|i| start[(i, n + m)]).collect();
        LinearSystem::new(a, b, c)
    }
}
