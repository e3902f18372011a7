//! Checks that refuse hybrid systems whose parts do not fit together.

use std::ops::Bound;

use faer::Mat;

use super::halfspace::Halfspace;
use super::norm_limit::NormLimit;
use super::transition::{Reset, Transition};
use super::{Choice, HybridSystem};
use crate::error::{Error, ErrorKind, check_finite, check_length};
use crate::hybrid::linear::{LinearSystem, check_time_step};
use crate::hybrid::step::{ConditionSet, Moment, StepCondition};
use crate::interval::Interval;
use crate::model::is_name;
use crate::tolerance::INFINITE;

/// By how much a number of two flows may differ by rounding alone, relative to it and to 1.
const FLOW_ROUNDING: f64 = 1e-12;

impl HybridSystem {
    /// Refuses systems whose parts do not fit together.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::Shape`], [`ErrorKind::Length`], [`ErrorKind::NotFinite`],
    /// [`ErrorKind::CrossedBounds`], [`ErrorKind::DuplicateName`], [`ErrorKind::UnknownName`];
    /// [`ErrorKind::OutOfRange`] for a system without states or transitions, for several choices
    /// without a common flow, for numbers of 1e20 and more in magnitude, and for a domain or a
    /// range so far from 0 that the digits of a float do not tell its points apart;
    /// [`ErrorKind::Misplaced`] for a guard on the prediction of a state whose flow another choice
    /// changes as well.
    pub fn check(&self) -> Result<(), Error> {
        check_time_step(self.time_step)?;
        at_least_one("states", self.states.len())?;
        if self.transitions().count() == 0 {
            let what = "the number of transitions of the hybrid system";
            return Err(Error::out_of_range_with(
                what,
                0.0,
                1.0..,
                ", stated by `mode` or `event`",
            ));
        }
        // Switches without a flow of the mode that they enter have the common one.
        if let Some(&(choice, number)) = self.unstated.first().filter(|_| self.flow.is_none()) {
            let name = format!("`{}`", self.choices[choice].transitions[number].name);
            let place = "the system without a flow".to_owned();
            let help = "state it by `rates` or by `next`, or state a common flow first";
            return Err(ErrorKind::Misplaced { name, place, help }.into());
        }
        for (name, domain) in &self.states {
            check_ends(name, *domain)?;
        }
        let names = self.states.iter().map(|(name, _)| name);
        check_names("state or input", names.chain(self.inputs.iter().map(|(name, _)| name)))?;
        for (name, range) in &self.inputs {
            range.check(&format!("the range of `{name}`"))?;
            range.values().try_for_each(|range| check_ends(name, *range))?;
        }
        self.check_digits()?;
        for (input, values) in &self.input_values {
            let known = self.inputs.iter().find(|(name, _)| name == input);
            let known = known.ok_or_else(|| Error::unknown_name(input, "input of the system"))?;
            values.check(input, &known.1)?;
        }
        let (n, m) = (self.states.len(), self.inputs.len());
        self.conditions().try_for_each(|own| check_condition(own, n, m))?;
        if !self.disturbance.is_empty() {
            check_length("the list of disturbances", self.disturbance.len(), n)?;
            let named = self.states.iter().zip(&self.disturbance);
            named.into_iter().try_for_each(|((name, _), range)| check_ends(name, *range))?;
        }
        match &self.flow {
            Some(flow) => check_flow("the common flow", flow, n, m)?,
            None if self.choices.len() > 1 => {
                let (what, count) = ("the number of choices", self.choices.len() as f64);
                let more = " without a common flow; state one by `rates` or `next` of the system";
                return Err(Error::out_of_range_with(what, count, ..=1.0, more));
            }
            None => {}
        }
        check_names("choice", self.choices.iter().map(|choice| &choice.name))?;
        self.choices.iter().try_for_each(|choice| self.check_choice(choice))?;
        self.check_implicit()?;
        self.check_predictions()
    }

    /// Refuses functions of the next state where a flow does not lead there.
    fn check_implicit(&self) -> Result<(), Error> {
        if !self.functions.use_predictions() {
            return Ok(());
        }
        let resets =
            self.transitions().find(|own| own.reset.is_some() && self.functions.uses(&own.flow));
        let changes = |own: &&Transition| self.flow.as_ref().is_some_and(|flow| own.flow != *flow);
        let changed = self.transitions().find(changes).filter(|_| self.choices.len() > 1);
        let place = match (resets, changed) {
            (None, None) => return Ok(()),
            (Some(own), _) => format!("the transition `{}` with a reset", own.name),
            (None, Some(own)) => {
                format!(
                    "the transition `{}`, which changes the flow beside another choice",
                    own.name
                )
            }
        };
        let name = self.functions.method.to_string();
        let help = "state an explicit method first, such as \
                    `discretization(Discretization::RungeKutta4)`";
        Err(ErrorKind::Misplaced { name, place, help }.into())
    }

    /// Refuses guards on predictions that another choice makes wrong: each choice predicts by the
    /// common flow and what it changes itself, and the step adds what the others change.
    fn check_predictions(&self) -> Result<(), Error> {
        let Some(common) = self.flow.as_ref().filter(|_| self.choices.len() > 1) else {
            return Ok(());
        };
        if self.predicting.is_empty() {
            return Ok(());
        }
        let changes = |choice: &Choice| -> Vec<bool> {
            let changed = |state: usize| {
                choice.transitions.iter().any(|own| changes_row(&own.flow, common, state))
            };
            (0..self.states.len()).map(changed).collect()
        };
        let changes: Vec<Vec<bool>> = self.choices.iter().map(changes).collect();
        for &(c, j) in &self.predicting {
            let Some(choice) = self.choices.get(c) else { continue };
            let Some(transition) = choice.transitions.get(j) else { continue };
            for own in transition.conditions().filter(|own| own.moment == Moment::Prediction) {
                let (name, factors) = (own.name(), own.set.factors());
                let uses = |i: usize| factors.iter().any(|own| own[i] != 0.0);
                let beside = (0..self.choices.len()).filter(|&other| other != c);
                let mut pairs = beside.flat_map(|k| (0..self.states.len()).map(move |i| (k, i)));
                let Some((k, i)) = pairs.find(|&(k, i)| changes[k][i] && uses(i)) else { continue };
                let (other, state) = (&self.choices[k].name, &self.states[i].0);
                let name = format!("the guard `{name}` of `{}`", transition.name);
                let own = &choice.name;
                let place = format!(
                    "the choice `{own}` while `{other}` changes the flow of `{state}` as well"
                );
                let help = "a choice predicts by its own flow alone; state the guard of the start of \
                            the step, limit the state itself by `invariant` or `limit` of the system, \
                            or state both choices as one";
                return Err(ErrorKind::Misplaced { name, place, help }.into());
            }
        }
        Ok(())
    }

    fn check_choice(&self, choice: &Choice) -> Result<(), Error> {
        let Choice { name, transitions, dwells, .. } = choice;
        at_least_one(&format!("transitions of `{name}`"), transitions.len())?;
        check_names("transition", transitions.iter().map(|transition| &transition.name))?;
        for transition in transitions {
            self.check_transition(transition)?;
        }
        let with_modes = transitions.iter().filter(|t| t.modes.is_some()).count();
        if with_modes != 0 && with_modes != transitions.len() {
            return Err(Error::out_of_range_in_words(
                format!("the number of transitions of `{name}` that name modes"),
                with_modes as f64,
                ..,
                "none or all of them; use `stay` and `switch` for all",
            ));
        }
        let modes = choice.modes();
        for dwell in dwells {
            if !modes.contains(&dwell.mode.as_str()) {
                return Err(Error::unknown_name(&dwell.mode, "mode of the system"));
            }
            dwell.check()?;
        }
        Ok(())
    }

    fn check_transition(&self, transition: &Transition) -> Result<(), Error> {
        let (n, m) = (self.states.len(), self.inputs.len());
        check_flow(&transition.name, &transition.flow, n, m)?;
        transition.conditions().try_for_each(|own| check_condition(own, n, m))?;
        for (input, range) in &transition.inputs {
            if self.inputs.iter().all(|(name, _)| name != input) {
                return Err(Error::unknown_name(input, "input of the system"));
            }
            range.check(&format!("the range of `{input}`"))?;
            range.values().try_for_each(|range| check_ends(input, *range))?;
        }
        check_names("output", transition.outputs.iter().map(|output| &output.name))?;
        for output in &transition.outputs {
            if !(output.is_at_start && output.factors.len() == n + m) {
                check_length("the factors of an output", output.factors.len(), n)?;
            }
            output.constant.check(&format!("the constant of `{}`", output.name))?;
            let numbers = output.factors.iter().chain(output.constant.values());
            check_numbers(&output.name, "a number", numbers.copied())?;
        }
        for Reset { matrix, offset } in transition.resets() {
            let (rows, columns) = (matrix.nrows(), matrix.ncols());
            if rows != n || columns != n {
                return shape("the matrix of a reset", rows, columns, format!("{n}x{n}"));
            }
            offset.check(&format!("the offset of the reset of `{}`", transition.name))?;
            let entries = (0..rows).flat_map(|i| (0..columns).map(move |j| matrix[(i, j)]));
            check_numbers(&transition.name, "an entry of the reset", entries)?;
            for offset in offset.values() {
                check_length("the offset of a reset", offset.len(), n)?;
                let entries = offset.iter().copied();
                check_numbers(&transition.name, "an entry of the reset", entries)?;
            }
        }
        for own in &transition.uncertain {
            check_ends(&transition.name, own.range)?;
        }
        Ok(())
    }
}

/// Whether two flows differ in the next value of a state by more than rounding.
fn changes_row(own: &LinearSystem, common: &LinearSystem, state: usize) -> bool {
    let numbers = |flow: &LinearSystem| -> Vec<f64> {
        let from_states = (0..flow.states()).map(|j| flow.a()[(state, j)]);
        let from_inputs = (0..flow.inputs()).map(|u| flow.b()[(state, u)]);
        from_states.chain(from_inputs).chain([flow.c()[state]]).collect()
    };
    let (own, common) = (numbers(own), numbers(common));
    let pairs = own.iter().zip(&common);
    pairs.into_iter().any(|(a, b)| (a - b).abs() > FLOW_ROUNDING * a.abs().max(b.abs()).max(1.0))
}

pub(super) fn at_least_one(what: &str, count: usize) -> Result<(), Error> {
    if count == 0 {
        let what = format!("the number of {what} of the hybrid system");
        return Err(Error::out_of_range(what, 0.0, 1.0..));
    }
    Ok(())
}

/// Refuses what cannot be a name.
pub(super) fn check_name(name: &str) -> Result<(), Error> {
    match is_name(name) {
        true => Ok(()),
        false => Err(ErrorKind::InvalidName { name: name.to_owned() }.into()),
    }
}

/// Refuses names that are used twice, and what cannot be a name.
fn check_names<'a>(
    kind: &'static str,
    names: impl Iterator<Item = &'a String>,
) -> Result<(), Error> {
    let mut seen: Vec<&String> = Vec::new();
    for name in names {
        check_name(name)?;
        if seen.contains(&name) {
            return Err(Error::duplicate_name(name, kind));
        }
        seen.push(name);
    }
    Ok(())
}

fn shape<T>(what: &'static str, rows: usize, columns: usize, expected: String) -> Result<T, Error> {
    Err(ErrorKind::Shape { what, rows, columns, expected }.into())
}

/// Refuses matrices of another shape, and entries that are not finite or too large.
pub(super) fn check_matrix(
    what: &'static str,
    matrix: &Mat<f64>,
    rows: usize,
    columns: usize,
) -> Result<(), Error> {
    if matrix.nrows() != rows || matrix.ncols() != columns {
        return shape(what, matrix.nrows(), matrix.ncols(), format!("{rows}x{columns}"));
    }
    let entries = (0..rows).flat_map(|i| (0..columns).map(move |j| matrix[(i, j)]));
    check_numbers(what, "an entry", entries)
}

fn check_flow(name: &str, flow: &LinearSystem, states: usize, inputs: usize) -> Result<(), Error> {
    let (n, m) = (flow.states(), flow.inputs());
    if n != states || m != inputs {
        let expected = format!("{states} states and {inputs} inputs");
        return shape("the flow of a transition", n, m, expected);
    }
    let (a, b, c) = (flow.a(), flow.b(), flow.c());
    let entries = (0..n).flat_map(|i| {
        let row = (0..n).map(move |j| a[(i, j)]).chain((0..m).map(move |j| b[(i, j)]));
        row.chain([c[i]])
    });
    check_numbers(name, "an entry of the flow", entries)
}

/// Factors are as many as states, or, at the start of a step, as states and inputs.
fn check_condition(own: StepCondition<'_>, states: usize, inputs: usize) -> Result<(), Error> {
    let inputs = if own.moment == Moment::Start { inputs } else { 0 };
    match own.set {
        ConditionSet::HalfSpace(own) => check_halfspace(own, states, inputs),
        ConditionSet::Norm(own) => check_norm(own, states, inputs),
    }
}

/// The normal has an entry per state, or one per state and input.
pub(crate) fn check_halfspace(
    halfspace: &Halfspace,
    states: usize,
    inputs: usize,
) -> Result<(), Error> {
    let name = &halfspace.name;
    let what = || format!("the length of the normal of the half-space `{name}`");
    check_length_of(what, halfspace.normal.len(), states, inputs)?;
    check_numbers(name, "a number", halfspace.normal.iter().copied())?;
    halfspace.limit.check(&format!("the limit of `{name}`"))?;
    let limits = halfspace.limit.values().copied();
    check_numbers(name, "a number", limits.filter(|&limit| limit != f64::INFINITY))
}

/// Each part of the norm has a factor per state, or one per state and input.
pub(super) fn check_norm(norm: &NormLimit, states: usize, inputs: usize) -> Result<(), Error> {
    let name = &norm.name;
    if norm.entries.is_empty() {
        return Err(ErrorKind::EmptyRow { name: name.clone() }.into());
    }
    for part in norm.parts() {
        let what = || format!("the number of factors of the norm `{name}`");
        check_length_of(what, part.factors.len(), states, inputs)?;
        part.constant.check(&format!("a constant of `{name}`"))?;
        let numbers = part.factors.iter().chain(part.constant.values());
        check_numbers(name, "a number", numbers.copied())?;
    }
    Ok(())
}

/// Refuses another length than one entry per state, or one per state and input.
fn check_length_of(
    what: impl Fn() -> String,
    length: usize,
    states: usize,
    inputs: usize,
) -> Result<(), Error> {
    if length == states || length == states + inputs {
        return Ok(());
    }
    let range = match inputs {
        0 => format!("{states}, one entry per state"),
        _ => format!("{states}, one entry per state, or {}, with the inputs", states + inputs),
    };
    let (least, most) = (states as f64, (states + inputs) as f64);
    Err(Error::out_of_range_in_words(what(), length as f64, least..=most, range))
}

/// Refuses ranges whose ends are not finite, crossed, or too large.
pub(crate) fn check_ends(name: &str, range: Interval) -> Result<(), Error> {
    range.check(name)?;
    check_numbers(name, "a limit", [range.lower, range.upper].into_iter())
}

/// Refuses numbers that are not finite or are 1e20 and more in magnitude, because products of them
/// could overflow.
pub(super) fn check_numbers(
    name: &str,
    what: &'static str,
    numbers: impl Iterator<Item = f64>,
) -> Result<(), Error> {
    for value in numbers {
        check_finite(name, what, [value])?;
        if value.abs() >= INFINITE {
            let what = format!("{what} of `{name}`");
            return Err(too_large(what, value));
        }
    }
    Ok(())
}

/// The error for a number of 1e20 and more in magnitude.
pub(super) fn too_large(what: String, value: f64) -> Error {
    let range = (Bound::Excluded(-INFINITE), Bound::Excluded(INFINITE));
    Error::out_of_range_in_words(what, value, range, "below 1e20 in magnitude")
}
