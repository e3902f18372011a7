//! Flows, rows and expressions with nonlinear functions, as linear ones in the inputs of a system
//! that are the values of its functions.

use super::HybridSystem;
use super::discretization::{Discretization, StepRates};
use super::handles::Meaning;
use super::schedule::Schedule;
use super::state_row::StateRow;
use super::step_functions::{StepFunctions, StepSlot};
use crate::error::{Error, ErrorKind, check_finite};
use crate::hybrid::linear::LinearSystem;
use crate::interval::Interval;
use crate::model::{Affine, Nonlinear, NonlinearRow, Row, Variable};

/// Where functions can stand.
const STEP_FUNCTION_HELP: &str =
    "functions are of states, inputs and series at the start of the step";

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
                        Some(StepSlot::State(i)) => sum += factor * &states[*i],
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
    /// Sets the method that makes steps of nonlinear rates; without it, the
    /// [midpoint rule](Discretization::Midpoint). An implicit method is for flows that lead to the
    /// next state: without a reset, and, beside other choices, the common flow.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::Misplaced`] after the first nonlinear flow.
    pub fn discretization(&mut self, method: Discretization) -> Result<(), Error> {
        if self.is_nonlinear() {
            let name = "the discretization".to_owned();
            let place = "a statement after a nonlinear flow".to_owned();
            let help = "state it before the first flow";
            return Err(ErrorKind::Misplaced { name, place, help }.into());
        }
        self.functions.method = method;
        Ok(())
    }

    /// The method that makes steps of the nonlinear rates; `None` if no flow has nonlinear rates.
    pub fn discretized_by(&self) -> Option<Discretization> {
        self.functions.has_rates().then_some(self.functions.method)
    }

    /// The step of nonlinear rates.
    pub(super) fn discretized(&mut self, rates: &[Nonlinear]) -> Result<LinearSystem, Error> {
        let (method, h) = (self.functions.method, self.time_step);
        self.flow_of_functions(rates, true, |own| {
            let (start, end) = (own.start.clone(), own.end.clone());
            method.step(StepRates { start, end, at: &mut |states| own.at(states) }, h)
        })
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
        if !self.is_nonlinear() {
            return input;
        }
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
        let (next, rows) = self.define_functions(rows, self.state_names(), "a flow", step)?;
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
        self.affine_by(expression, self.state_names(), place)
    }

    fn state_names(&self) -> Vec<String> {
        self.states.iter().map(|(name, _)| name.clone()).collect()
    }

    fn affine_by(
        &mut self,
        expression: &Nonlinear,
        names: Vec<String>,
        place: &str,
    ) -> Result<Affine, Error> {
        if let Some(own) = expression.as_affine() {
            return Ok(own.clone());
        }
        let rows = vec![self.with_series_as_inputs(expression, place)?];
        let (values, _) = self.define_functions(&rows, names, place, |own| {
            let start = own.start.clone();
            own.at(&start)
        })?;
        let mut sum = Affine::zero();
        for value in values {
            sum += value.offset();
            for (variable, factor) in value.terms() {
                let handle = match self.functions.slot(variable) {
                    Some(StepSlot::State(i)) => self.handles.find_state(i).map(Variable::from),
                    Some(StepSlot::Input(u)) => Some(self.handles.of(Meaning::Input(u))),
                    Some(StepSlot::Prediction(_)) | None => None,
                };
                if let Some(handle) = handle {
                    sum.add_term(factor, handle);
                }
            }
        }
        Ok(sum)
    }

    /// The same, with functions named after this name.
    pub(crate) fn affine_named(
        &mut self,
        expression: &Nonlinear,
        name: &str,
        place: &str,
    ) -> Result<Affine, Error> {
        self.affine_by(expression, vec![name.to_owned()], place)
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
        let visited = row.expression().visit(&mut |own| {
            let is_state = |(handle, _): (Variable, f64)| {
                matches!(self.handles.meaning(handle), Some(Meaning::State(_)))
            };
            is_of_states &= own.terms().into_iter().all(is_state);
            Ok(())
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
        row.expression().visit(&mut |own| {
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
            Ok(())
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
        names: Vec<String>,
        place: &str,
        step: impl FnOnce(&mut FlowFunctions<'_>) -> Result<Vec<Affine>, Error>,
    ) -> Result<(Vec<Affine>, Vec<Nonlinear>), Error> {
        if !cfg!(feature = "nonlinear") {
            let name = "a nonlinear expression".to_owned();
            let help = "turn on the feature `nonlinear` of `carom`, which is on by default";
            return Err(ErrorKind::Misplaced { name, place: place.to_owned(), help }.into());
        }
        let mut functions = self.functions.clone();
        functions.declare(&self.states, &self.inputs)?;
        let known = functions.model.function_count();
        let part = |variable: Variable| match self.handles.meaning(variable) {
            Some(Meaning::State(i)) => functions.variable(StepSlot::State(*i)),
            Some(Meaning::Input(u)) => functions.variable(StepSlot::Input(*u)),
            _ => None,
        };
        let over = |own: &Affine| {
            let mut sum = Affine::constant(own.offset());
            for (handle, factor) in own.terms() {
                self.meaning(handle, place)?;
                let variable = part(handle);
                let variable =
                    variable.ok_or_else(|| self.misplaced(handle, place, STEP_FUNCTION_HELP))?;
                sum.add_term(factor, variable);
            }
            Ok(sum)
        };
        let rows: Result<Vec<Nonlinear>, Error> =
            rows.iter().map(|row| row.try_map(&mut |own: &Affine| over(own))).collect();
        let rows = rows?;
        let n = self.states.len();
        let variables = |slot: fn(usize) -> StepSlot| -> Vec<Affine> {
            (0..n).filter_map(|i| functions.variable(slot(i))).map(Affine::from).collect()
        };
        let (start, end) = (variables(StepSlot::State), variables(StepSlot::Prediction));
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
            functions.slots.push(StepSlot::Input(self.inputs.len() - 1));
            self.handles.of(Meaning::Input(self.inputs.len() - 1));
        }
        Ok(())
    }
}
