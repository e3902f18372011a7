//! A transition that is being stated: flow, guards, outputs.

use super::HybridSystem;
use super::check::check_name;
use super::flow_rows::FlowKind;
use super::handles::{Meaning, State};
use super::schedule::Schedule;
use super::system_row::SystemRow;
use super::transition::{Transition, TransitionOutput};
use crate::error::{Error, ErrorKind};
use crate::hybrid::linear::LinearSystem;
use crate::hybrid::step::Moment;
use crate::interval::Interval;
use crate::model::{Affine, ConicRow, Nonlinear, Row, Variable};

/// A transition of a [`HybridSystem`] that is being stated, made by
/// [`mode`](HybridSystem::mode), [`event`](HybridSystem::event), [`stay`](HybridSystem::stay) and
/// [`switch`](HybridSystem::switch).
///
/// A step in a transition starts in a state and with an input that satisfy its guards, follows the
/// flow to a prediction that satisfies the guards on the prediction, and is then reset.
#[derive(Debug)]
pub struct TransitionMut<'a> {
    pub(super) system: &'a mut HybridSystem,
    choice: usize,
    number: usize,
    /// Whether it has stated its flow.
    has_flow: bool,
}

impl<'a> TransitionMut<'a> {
    pub(super) fn new(system: &'a mut HybridSystem, choice: usize, number: usize) -> Self {
        TransitionMut { system, choice, number, has_flow: false }
    }

    pub(super) fn own(&mut self) -> &mut Transition {
        &mut self.system.choices[self.choice].transitions[self.number]
    }

    /// The transition in words, for errors.
    pub(super) fn place(&self, part: &str) -> String {
        let name = &self.system.choices[self.choice].transitions[self.number].name;
        format!("{part} of `{name}`")
    }

    /// The handle of the transition: 1 in the steps that take it, 0 in the others.
    pub fn taken(self) -> Variable {
        self.system.handles.of(Meaning::Taken(self.choice, self.number))
    }

    /// Sets another name, for variables and reports.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::InvalidName`], [`ErrorKind::DuplicateName`].
    pub fn named(mut self, name: &str) -> Result<Self, Error> {
        check_name(name)?;
        let mut others = self.system.choices[self.choice].transitions.iter().enumerate();
        if others.any(|(j, other)| j != self.number && other.name == name) {
            return Err(Error::duplicate_name(name, "transition of the choice"));
        }
        self.own().name = name.to_owned();
        Ok(self)
    }

    /// States the flow by the derivatives of the states, in their units per second. States that are
    /// not named have those of the [common flow](HybridSystem::rates), or are constant. The flow
    /// over a step is exact for inputs that are held over it (zero-order hold).
    ///
    /// # Errors
    ///
    /// [`ErrorKind::Misplaced`] for derivatives that are not functions of states and inputs, next
    /// to a common flow by next values, and for a second flow; [`ErrorKind::ForeignHandle`],
    /// [`ErrorKind::DuplicateName`]; [`ErrorKind::OutOfRange`] for a time step that is not finite
    /// and positive.
    pub fn rates<E: Into<Nonlinear>>(
        self,
        rates: impl IntoIterator<Item = (State, E)>,
    ) -> Result<Self, Error> {
        self.flow_by(FlowKind::Rates, rates)
    }

    /// States the flow by the next values of the states. States that are not named have those of
    /// the [common flow](HybridSystem::next), or stay as they are.
    ///
    /// # Errors
    ///
    /// As for [`rates`](TransitionMut::rates).
    pub fn next<E: Into<Nonlinear>>(
        self,
        values: impl IntoIterator<Item = (State, E)>,
    ) -> Result<Self, Error> {
        self.flow_by(FlowKind::NextValues, values)
    }

    /// States the flow by matrices, for those who have them: `A x + B u + c` with a row for each
    /// state and a column of B for each input, in the order of their declaration.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::Shape`] if the numbers of states and inputs differ; [`ErrorKind::Misplaced`]
    /// for a second flow.
    pub fn flow(mut self, flow: LinearSystem) -> Result<Self, Error> {
        self.state_flow()?;
        let (n, m) = (self.system.states.len(), self.system.inputs.len());
        if (flow.states(), flow.inputs()) != (n, m) {
            return Err(ErrorKind::Shape {
                what: "the flow of a transition",
                rows: flow.states(),
                columns: flow.inputs(),
                expected: format!("{n} states and {m} inputs"),
            }
            .into());
        }
        self.system.set_flow(self.choice, self.number, flow);
        Ok(self)
    }

    /// Refuses a second flow.
    fn state_flow(&mut self) -> Result<(), Error> {
        match std::mem::replace(&mut self.has_flow, true) {
            true => Err(self.second("flow", "state all rows of the flow at once")),
            false => Ok(()),
        }
    }

    /// The error for a part that is stated twice.
    pub(super) fn second(&self, part: &str, help: &'static str) -> Error {
        let (name, place) = (format!("a second {part}"), self.place("the statement"));
        ErrorKind::Misplaced { name, place, help }.into()
    }

    fn flow_by<E: Into<Nonlinear>>(
        mut self,
        kind: FlowKind,
        rows: impl IntoIterator<Item = (State, E)>,
    ) -> Result<Self, Error> {
        self.state_flow()?;
        let rows = self.system.flow_rows(kind, rows, &self.place("the flow"))?;
        let flow = self.system.flow_of(&rows)?;
        self.system.set_flow(self.choice, self.number, flow);
        Ok(self)
    }

    /// Adds a guard: a row on the start of the step, of states, inputs and series, or a row on
    /// [predictions](State::predicted) and series. A guard on one input alone is its range in this
    /// transition. The row may limit a length, such as a thrust within a disc,
    /// `norm([ux, uy]).le(2.0)`, or where the transition is possible.
    ///
    /// With several choices, predictions are those of the transition's own choice; a guard on the
    /// prediction of a state whose flow another choice changes as well is refused when the system
    /// is [checked](HybridSystem::check).
    ///
    /// # Errors
    ///
    /// [`ErrorKind::Misplaced`] for a row of both, or of anything else;
    /// [`ErrorKind::ForeignHandle`], [`ErrorKind::EmptyRow`], [`ErrorKind::UnlimitedRow`].
    pub fn guard(self, row: impl Into<SystemRow>) -> Result<Self, Error> {
        self.add(None, &row.into())
    }

    /// Adds a row of states and series that holds at both ends of the step: a guard on the start
    /// and the same guard on the [prediction](State::predicted), such as the range of speeds of a
    /// gear. Two modes whose invariants meet in one value, `x.le(6.0)` and `x.ge(6.0)`, are left
    /// and entered exactly there: a planner finds that step, but no run that is disturbed does.
    /// With `guard` in place of `invariant`, a step may cross the value. With several choices, the
    /// prediction is as for [`guard`](TransitionMut::guard).
    ///
    /// # Errors
    ///
    /// As for [`guard`](TransitionMut::guard); [`ErrorKind::Misplaced`] for inputs and predictions.
    pub fn invariant(mut self, row: impl Into<SystemRow>) -> Result<Self, Error> {
        let place = self.place("an invariant");
        let row = match row.into() {
            SystemRow::Row(row) => row,
            SystemRow::Conic(row) => {
                let (moment, norm) = self.system.norm_limit(None, &row, &place)?;
                let states = self.system.states.len();
                if moment == Moment::Prediction || norm.bound.factors.len() != states {
                    let name = format!("the row `{}`", norm.name);
                    let help = "an invariant is about states; use `guard` for inputs";
                    return Err(ErrorKind::Misplaced { name, place, help }.into());
                }
                self.own().norms.push(norm.clone());
                self.own().prediction_norms.push(norm);
                self.note_prediction();
                return Ok(self);
            }
            SystemRow::Nonlinear(row) => {
                let name = format!("the row `{}`", self.system.nonlinear_text(&row));
                let help = "an invariant of a mode is affine; use `guard` for the start of the step, or \
                            `limit` of the system";
                return Err(ErrorKind::Misplaced { name, place, help }.into());
            }
        };
        let mut predicted = Affine::constant(row.expression().offset());
        for (variable, factor) in row.expression().terms() {
            match *self.system.meaning(variable, &place)? {
                Meaning::State(i) => {
                    let prediction = self.system.handles.of(Meaning::Prediction(i));
                    predicted.add_term(factor, prediction);
                }
                Meaning::Series(..) => predicted.add_term(factor, variable),
                _ => {
                    let help = "an invariant is about states; use `guard` for inputs";
                    return Err(self.system.misplaced(variable, &place, help));
                }
            }
        }
        let predicted = predicted.within(row.lower(), row.upper());
        self.guard(row)?.guard(predicted)
    }

    /// Adds a guard that could be dropped, such as a rule of the user: explanations name it, and
    /// say whether dropping it would help. It is never a range of an input.
    ///
    /// # Errors
    ///
    /// As for [`guard`](TransitionMut::guard); [`ErrorKind::InvalidName`].
    pub fn limit(self, name: &str, row: impl Into<SystemRow>) -> Result<Self, Error> {
        check_name(name)?;
        self.add(Some((name, true)), &row.into())
    }

    /// Notes that the transition has a guard on the prediction, for the check of the whole system.
    fn note_prediction(&mut self) {
        let own = (self.choice, self.number);
        if !self.system.predicting.contains(&own) {
            self.system.predicting.push(own);
        }
    }

    fn add(self, name: Option<(&str, bool)>, row: &SystemRow) -> Result<Self, Error> {
        match row {
            SystemRow::Row(row) => self.add_row(name, row),
            SystemRow::Conic(row) => self.add_norm(name, row),
            SystemRow::Nonlinear(row) => {
                let place = self.place("a guard");
                let text = self.system.nonlinear_text(row);
                let row = self.system.with_functions_as_inputs(row, &place)?;
                let (text, is_limit) = name.unwrap_or((&text, false));
                let (_, halves) = self.system.halfspaces(Some((text, is_limit)), &row, &place)?;
                let mut own = self;
                own.own().guards.extend(halves);
                Ok(own)
            }
        }
    }

    fn add_norm(mut self, name: Option<(&str, bool)>, row: &ConicRow) -> Result<Self, Error> {
        let place = self.place("a guard");
        let (moment, norm) = self.system.norm_limit(name, row, &place)?;
        match moment {
            Moment::Start => self.own().norms.push(norm),
            Moment::Prediction => {
                self.own().prediction_norms.push(norm);
                self.note_prediction();
            }
        }
        Ok(self)
    }

    fn add_row(mut self, name: Option<(&str, bool)>, row: &Row) -> Result<Self, Error> {
        let place = self.place("a guard");
        let (moment, halves) = self.system.halfspaces(name, row, &place)?;
        // A range has no name by which it could be dropped.
        if name.is_none()
            && let Some((input, range)) = self.system.input_limits(row, &place)?
        {
            return self.narrow(input, &range, row);
        }
        match moment {
            Moment::Start => self.own().guards.extend(halves),
            Moment::Prediction => {
                self.own().prediction_guards.extend(halves);
                self.note_prediction();
            }
        }
        Ok(self)
    }

    /// As [`guard`](TransitionMut::guard), for a row that may leave no value of an input: the
    /// transition is then never possible.
    pub(super) fn guard_or_never(mut self, row: Row) -> Result<Self, Error> {
        let place = self.place("a guard");
        if let Some((input, range)) = self.system.input_limits(&row, &place)? {
            let (name, common) = self.system.inputs[input].clone();
            let known = self.own().input_range(&name).cloned().unwrap_or(common);
            let apart = |step: usize| {
                let both = known.get(step).zip(range.get(step));
                both.is_some_and(|(known, own)| known.intersection(*own).is_empty())
            };
            if (0..=known.settles().max(range.settles())).any(apart) {
                let (_, halves) = self.system.halfspaces(None, &row, &place)?;
                self.own().guards.extend(halves);
                return Ok(self);
            }
        }
        self.guard(row)
    }

    /// Narrows the range of an input in the transition.
    fn narrow(
        mut self,
        input: usize,
        range: &Schedule<Interval>,
        row: &Row,
    ) -> Result<Self, Error> {
        let (name, common) = self.system.inputs[input].clone();
        let own = self.own().inputs.iter().position(|(own, _)| *own == name);
        let known = own.map_or(&common, |own| &self.own().inputs[own].1).clone();
        let last = known.settles().max(range.settles());
        let at = |step: usize| Some(known.get(step)?.intersection(*range.get(step)?));
        let ranges: Vec<Interval> = (0..=last).filter_map(at).collect();
        if let Some(Interval { lower, upper }) = ranges.iter().find(|range| range.is_empty()) {
            let name = format!("{name} where {}", self.system.row_text(row));
            return Err(ErrorKind::CrossedBounds { name, lower: *lower, upper: *upper }.into());
        }
        match own {
            Some(own) => self.own().inputs[own].1 = ranges.into(),
            None => self.own().inputs.push((name, ranges.into())),
        }
        Ok(self)
    }

    /// Says what an [output](HybridSystem::output) is in this transition: a function of predictions
    /// and series, or of states, inputs and series at the start of the step.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::Misplaced`] for a function of both; [`ErrorKind::ForeignHandle`];
    /// [`ErrorKind::DuplicateName`] at the second call.
    pub fn output(mut self, output: Variable, value: impl Into<Nonlinear>) -> Result<Self, Error> {
        let place = self.place("an output");
        let Meaning::Output(name) = self.system.meaning(output, &place)?.clone() else {
            return Err(self.system.misplaced(output, &place, "name an output of the system"));
        };
        if self.own().outputs.iter().any(|own| own.name == name) {
            return Err(Error::duplicate_name(&name, "output of the transition"));
        }
        let value = self.system.affine_of(&value.into(), &place)?;
        let all = self.system.plain_coefficients(&value, &place)?;
        let is_at_start = all.uses_start();
        if is_at_start && all.uses_predictions() {
            let name = format!("`{name}`");
            let help = "state it of the start of the step alone or of the prediction alone";
            return Err(ErrorKind::Misplaced { name, place, help }.into());
        }
        let factors = if is_at_start { all.start() } else { all.predictions };
        let output = TransitionOutput { name, factors, constant: all.constant, is_at_start };
        self.own().outputs.push(output);
        Ok(self)
    }
}
