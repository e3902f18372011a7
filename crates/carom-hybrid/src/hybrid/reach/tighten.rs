//! Tightening of planning programs: bounds and binaries from a tube.

use std::fmt;

use super::tube::Tube;
use crate::activity;
use crate::error::{Error, ErrorKind, check_length};
use crate::hybrid::system::Coordinates;
use crate::interval::Interval;
use crate::model::{Affine, Family, Model, Name, Variable};
use crate::number::counted;
use crate::tolerance;

/// The variables of a program that represent the states and transitions of the hybrid system;
/// without states, nothing is tightened.
#[doc(hidden)]
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct HorizonVariables {
    /// One family per state, in the system's order, each over the samples 0, ..., τ.
    pub states: Vec<Family>,
    /// Transitions by number, with binaries over the steps that are 1 exactly in those that take
    /// them.
    pub transitions: Vec<(usize, Family)>,
    /// Modes: the name of the choice, the mode's own, and variables over the samples, which are 1
    /// exactly where the run is in the mode.
    pub modes: Vec<(String, String, Family)>,
    /// Variables that are affine functions of the predictions.
    pub quantities: Vec<Quantity>,
    /// Whether a row on the number of events may be added (default yes).
    pub event_row: bool,
    /// The coordinates of the variables; by default they are in the units of the system.
    pub(crate) coordinates: Coordinates,
}

/// Variables over the steps that are, in each transition, an affine function of the prediction:
/// an impact speed, a penetration, a damage.
#[doc(hidden)]
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Quantity {
    /// The variables over the steps.
    pub family: Family,
    /// Number of the transition of the first value; 0 unless the values are those of one of several
    /// choices.
    pub first: usize,
    /// Per transition of the system or of the choice, one coefficient per state and a constant.
    pub values: Vec<(Vec<f64>, f64)>,
}

impl Default for HorizonVariables {
    fn default() -> Self {
        let (states, transitions) = (Vec::new(), Vec::new());
        let (modes, quantities) = (Vec::new(), Vec::new());
        let coordinates = Coordinates::default();
        HorizonVariables { states, transitions, modes, quantities, event_row: true, coordinates }
    }
}

impl HorizonVariables {
    /// The states' families, in the system's order.
    pub fn new(states: impl Into<Vec<Family>>) -> Self {
        HorizonVariables { states: states.into(), ..HorizonVariables::default() }
    }

    /// Adds the binaries that are 1 in the steps that take a transition (by its number).
    #[must_use]
    pub fn with_transition(mut self, transition: usize, binaries: Family) -> Self {
        self.transitions.push((transition, binaries));
        self
    }

    /// Adds variables with values for the transitions from the number `first` on; see [`Quantity`].
    #[must_use]
    pub fn with_quantity(
        mut self,
        family: Family,
        first: usize,
        values: impl Into<Vec<(Vec<f64>, f64)>>,
    ) -> Self {
        self.quantities.push(Quantity { family, first, values: values.into() });
        self
    }

    /// Sets whether a row on the number of events may be added.
    #[must_use]
    pub fn with_event_row(mut self, wanted: bool) -> Self {
        self.event_row = wanted;
        self
    }

    /// The steps' binaries, all families.
    pub(crate) fn binaries(&self) -> impl Iterator<Item = &Family> {
        self.transitions.iter().map(|(_, family)| family)
    }
}

/// Why a variable was fixed or its bounds were tightened.
#[doc(hidden)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Reason {
    /// No plan takes the transition (by its number) in this step.
    Impossible(usize),
    /// Every plan takes the transition in this step.
    OnlyWay(usize),
    /// No plan is in the mode at this sample, or every plan is.
    Modes,
    /// The states of every plan at this sample are bounded by the tube.
    Tube,
    /// The quantity is bounded by the predictions.
    Predictions,
}

/// One change that reach sets made to a program.
#[doc(hidden)]
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Change {
    pub variable: Variable,
    pub name: Name,
    /// The step or sample.
    pub step: usize,
    /// Its bounds before and after.
    pub from: Interval,
    pub to: Interval,
    pub reason: Reason,
}

/// The changes that reach sets made to a program, in words by `{}`.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
#[must_use]
pub struct TighteningReport {
    /// The horizon, in steps.
    pub steps: usize,
    /// Whether the program is proved infeasible; the model is then unchanged.
    pub infeasible: bool,
    /// Fixed binaries.
    pub(crate) fixed: Vec<Change>,
    /// Tightened bounds of other variables.
    pub(crate) tightened: Vec<Change>,
    /// Binaries of transitions that are still open.
    pub open: usize,
    /// Names of added rows.
    pub rows: Vec<Name>,
}

impl fmt::Display for TighteningReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.infeasible {
            return write!(f, "{}: no plan", counted(self.steps, "step"));
        }
        write!(
            f,
            "{}: {} binaries fixed, {} open, {} tightened, {} added",
            counted(self.steps, "step"),
            self.fixed.len(),
            self.open,
            counted(self.tightened.len(), "bound"),
            counted(self.rows.len(), "row")
        )
    }
}

impl Tube {
    /// Tightens a program over the same horizon: fixes binaries, tightens bounds (so that each step
    /// gets smaller big-Ms), and, if the number of events is limited, adds the row `events`. No
    /// solution is lost. The model stays unchanged if the tube is empty.
    #[doc(hidden)]
    pub fn tighten(
        &self,
        model: &mut Model,
        variables: &HorizonVariables,
    ) -> Result<TighteningReport, Error> {
        self.check_variables(model, variables)?;
        let mut report = TighteningReport {
            steps: self.steps(),
            infeasible: self.is_empty(),
            fixed: Vec::new(),
            tightened: Vec::new(),
            open: 0,
            rows: Vec::new(),
        };
        if report.infeasible {
            return Ok(report);
        }
        let changes = self.changes(model, variables)?;
        let Some(changes) = changes else {
            report.infeasible = true;
            return Ok(report);
        };
        for change in changes {
            model.set_bounds(change.variable, change.to.lower, change.to.upper)?;
            match change.reason {
                Reason::Impossible(_) | Reason::OnlyWay(_) | Reason::Modes => {
                    report.fixed.push(change);
                }
                Reason::Tube | Reason::Predictions => report.tightened.push(change),
            }
        }
        for family in variables.binaries() {
            for variable in family {
                let bounds = model.variable_ref(variable)?.bounds();
                report.open += usize::from(bounds.lower < bounds.upper);
            }
        }
        report.rows.extend(self.limit_events(model, variables, report.open)?);
        Ok(report)
    }

    fn check_variables(&self, model: &Model, variables: &HorizonVariables) -> Result<(), Error> {
        let states = self.system.states.len();
        if !variables.states.is_empty() {
            check_length("the list of state families", variables.states.len(), states)?;
        }
        for family in &variables.states {
            check_length("a state family of the horizon", family.len(), self.steps() + 1)?;
        }
        let count = self.system.transitions.len();
        for (number, family) in &variables.transitions {
            if *number >= count {
                let (what, value) = ("the number of a transition", *number as f64);
                return Err(Error::out_of_range(what, value, ..count as f64));
            }
            check_length("a transition family of the horizon", family.len(), self.steps())?;
        }
        for (choice, mode, family) in &variables.modes {
            let known = |kind, name: &str, found: bool| match found {
                true => Ok(()),
                false => Err(Error::unknown_name(name, kind)),
            };
            let mut modes = self.graph.modes_of(choice).peekable();
            known("choice with memory", choice, modes.peek().is_some())?;
            known("mode of the choice", mode, modes.any(|own| own == mode))?;
            check_length("a mode family of the horizon", family.len(), self.steps() + 1)?;
        }
        for quantity in &variables.quantities {
            check_length("a quantity family of the horizon", quantity.family.len(), self.steps())?;
            let of_choice = self.system.choices.iter().find(|own| own.start == quantity.first);
            let expected = match (of_choice, quantity.first) {
                (Some(own), _) if own.len() == quantity.values.len() => own.len(),
                (_, first) => count - first.min(count),
            };
            check_length("the values of a quantity", quantity.values.len(), expected)?;
            for (factors, _) in &quantity.values {
                check_length("the factors of a quantity", factors.len(), states)?;
            }
        }
        let quantities = variables.quantities.iter().map(|quantity| &quantity.family);
        let families = variables.states.iter().chain(variables.binaries()).chain(quantities);
        let families = families.chain(variables.modes.iter().map(|(_, _, family)| family));
        for variable in families.flatten() {
            model.variable_ref(variable)?;
        }
        Ok(())
    }

    /// All changes, or `None` if one of them leaves a variable no value.
    fn changes(
        &self,
        model: &Model,
        variables: &HorizonVariables,
    ) -> Result<Option<Vec<Change>>, Error> {
        let mut changes = Vec::new();
        for t in 0..self.steps() {
            for (m, family) in &variables.transitions {
                let of_choice = self.system.choices.iter().find(|own| own.contains(m));
                let mut others = of_choice.into_iter().flat_map(|own| own.clone());
                let is_open = others.any(|other| other != *m && self.is_possible(t, other));
                let (value, reason) = match (self.is_possible(t, *m), is_open) {
                    (false, _) => (0.0, Reason::Impossible(*m)),
                    (true, false) => (1.0, Reason::OnlyWay(*m)),
                    (true, true) => continue,
                };
                let to = Interval::point(value);
                if !offer(model, &mut changes, family[t], t, to, reason)? {
                    return Ok(None);
                }
            }
            for quantity in &variables.quantities {
                let Some(range) = self.quantity(t, quantity, variables) else { continue };
                let reason = Reason::Predictions;
                if !offer(model, &mut changes, quantity.family[t], t, range, reason)? {
                    return Ok(None);
                }
            }
        }
        for t in 0..=self.steps() {
            for (choice, mode, family) in &variables.modes {
                let mut others = self.graph.modes_of(choice).filter(|other| other != mode);
                let is_open = others.any(|other| self.is_mode_possible(t, choice, other));
                let value = match (self.is_mode_possible(t, choice, mode), is_open) {
                    (false, _) => 0.0,
                    (true, false) => 1.0,
                    (true, true) => continue,
                };
                let to = Interval::point(value);
                if !offer(model, &mut changes, family[t], t, to, Reason::Modes)? {
                    return Ok(None);
                }
            }
            let Some(bounds) = self.own_bounds(t) else { continue };
            let bounds = self.in_coordinates_of(variables, bounds);
            for (family, range) in variables.states.iter().zip(bounds) {
                if !offer(model, &mut changes, family[t], t, range, Reason::Tube)? {
                    return Ok(None);
                }
            }
        }
        Ok(Some(changes))
    }

    /// Ranges of the states in the coordinates of some variables.
    fn in_coordinates_of(&self, variables: &HorizonVariables, own: &[Interval]) -> Vec<Interval> {
        let (from, to) = (&self.system.coordinates, &variables.coordinates);
        let ranges = own.iter().enumerate().map(|(i, range)| {
            let (from, to) = (from.state(i), to.state(i));
            if from == to { *range } else { to.inverse().outward_range(from.outward_range(*range)) }
        });
        ranges.collect()
    }

    /// The range of a quantity in a step, over the possible transitions.
    fn quantity(
        &self,
        step: usize,
        quantity: &Quantity,
        variables: &HorizonVariables,
    ) -> Option<Interval> {
        let one = |(m, (factors, constant)): (usize, &(Vec<f64>, f64))| {
            let predictions = self.own_predictions(step, quantity.first + m)?;
            let predictions = self.in_coordinates_of(variables, predictions);
            Some(activity::range(*constant, factors.iter().copied().zip(predictions)))
        };
        quantity.values.iter().enumerate().filter_map(one).reduce(|a, b| a.hull(b))
    }

    /// Limits the number of events, if every event has a binary and more than one is open.
    fn limit_events(
        &self,
        model: &mut Model,
        variables: &HorizonVariables,
        open: usize,
    ) -> Result<Option<Name>, Error> {
        let events =
            || (0..self.system.transitions.len()).filter(|&m| self.system.transitions[m].1);
        let families: Vec<&Family> = events()
            .filter_map(|m| variables.transitions.iter().find(|(k, _)| *k == m))
            .map(|(_, family)| family)
            .collect();
        let fewest = self.fewest_events().unwrap_or(0);
        let says_nothing = fewest == 0 && self.most_events().is_none();
        let incomplete = families.is_empty() || families.len() < events().count();
        if !variables.event_row || open < 2 || incomplete || says_nothing {
            return Ok(None);
        }
        let total: Affine = families.into_iter().flatten().sum();
        let most = self.most_events().map_or(f64::INFINITY, |most| most as f64);
        let name: Name = "events".into();
        match model.add(name.clone(), total.within(fewest as f64, most)) {
            Ok(_) => Ok(Some(name)),
            // The user has a statement with this name, and the row is not essential.
            Err(error) if matches!(error.kind(), ErrorKind::DuplicateName { .. }) => Ok(None),
            Err(error) => Err(error),
        }
    }
}

/// Records the part of a range that is new; `false` if it leaves the variable no value.
fn offer(
    model: &Model,
    changes: &mut Vec<Change>,
    variable: Variable,
    step: usize,
    range: Interval,
    reason: Reason,
) -> Result<bool, Error> {
    let reference = model.variable_ref(variable)?;
    let from = reference.bounds();
    let to = from.intersection(range);
    if to.lower > to.upper {
        // Ranges include the margin of the sets, so this is not a matter of rounding.
        return Ok(false);
    }
    // As in propagation, tiny gains are ignored.
    let width = if from.is_bounded() { from.upper - from.lower } else { 0.0 };
    let worth = tolerance::PROPAGATION_GAIN * width;
    if to.lower - from.lower > worth || from.upper - to.upper > worth {
        let name = reference.name().clone();
        changes.push(Change { variable, name, step, from, to, reason });
    }
    Ok(true)
}
