//! The coordinates in which a system is computed, so that units and origins change nothing.
//!
//! Rows, sets, tubes and terminal sets have absolute tolerances, which mean something for numbers
//! of an ordinary size only. So a system is restated, once, with each state and input measured from
//! the middle of its domain in a power of two of the domain's width, and each condition in the unit
//! of its terms. Domains of an ordinary size and place keep the user's numbers. Certificates and
//! simulations read the system as it is stated; of all this they know the measures alone, which
//! scale their tolerances.

use faer::Mat;

use super::input_values::InputValues;
use super::measure::{Measure, power_of_two};
use super::transition::{Reset, TransitionOutput, Uncertain};
use super::{Halfspace, HybridSystem, NormEntry, NormLimit, Region, Schedule, Transition};
use crate::error::Error;
use crate::hybrid::linear::LinearSystem;
use crate::hybrid::matrix::Matrix;
use crate::interval::Interval;
use crate::sum::Sum;

/// The measures of a system's states, inputs and outputs.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Coordinates {
    /// Of the states and then the inputs.
    pub(crate) measures: Vec<Measure>,
    /// The number of states.
    pub(crate) states: usize,
    /// The units of outputs, by name; the others are 1.
    pub(crate) outputs: Vec<(String, f64)>,
}

impl Coordinates {
    /// The coordinates of a checked system.
    pub(crate) fn of(system: &HybridSystem) -> Self {
        let states = system.states.iter().map(|(_, domain)| Measure::of(*domain));
        let inputs = system.inputs.iter().enumerate().map(|(number, (name, range))| {
            // What functions are of is stated in the user's numbers.
            if system.functions.is_function(number) {
                return Measure::PLAIN;
            }
            if system.input_values.get(name) == Some(&InputValues::Whole) {
                return Measure::PLAIN;
            }
            let own = system.transitions().filter_map(|transition| transition.input_range(name));
            let all = own.chain([range]).flat_map(Schedule::values).copied();
            all.reduce(|a, b| a.hull(b)).map_or(Measure::PLAIN, Measure::of)
        });
        let measures: Vec<Measure> = states.chain(inputs).collect();
        let mut own = Coordinates { measures, states: system.states.len(), outputs: Vec::new() };
        for output in system.transitions().flat_map(|transition| &transition.outputs) {
            let unit = own.weight([&output.factors[..]]).recip();
            match own.outputs.iter_mut().find(|(name, _)| *name == output.name) {
                Some((_, most)) => *most = most.max(unit),
                None => own.outputs.push((output.name.clone(), unit)),
            }
        }
        own.outputs.retain(|(_, unit)| *unit != 1.0);
        own
    }

    /// Whether all numbers are the user's.
    pub(crate) fn is_plain(&self) -> bool {
        self.measures.iter().all(|measure| measure.is_plain())
    }

    /// The coordinates in which a system that is stated in these is as the user stated it.
    pub(crate) fn inverse(&self) -> Self {
        let measures = self.measures.iter().map(|measure| measure.inverse()).collect();
        let outputs = self.outputs.iter().map(|(name, unit)| (name.clone(), 1.0 / unit));
        Coordinates { measures, states: self.states, outputs: outputs.collect() }
    }

    /// The measure of a state.
    pub(crate) fn state(&self, number: usize) -> Measure {
        self.measures.get(number).copied().unwrap_or(Measure::PLAIN)
    }

    /// The measure of an input.
    pub(crate) fn input(&self, number: usize) -> Measure {
        self.state(self.states + number)
    }

    /// The unit of an output.
    pub(crate) fn output(&self, name: &str) -> f64 {
        self.outputs.iter().find(|(own, _)| own == name).map_or(1.0, |(_, unit)| *unit)
    }

    /// Values of states, or of states and then inputs, in these coordinates.
    pub(crate) fn inward(&self, values: &[f64]) -> Vec<f64> {
        values.iter().enumerate().map(|(k, value)| self.state(k).inward(*value)).collect()
    }

    /// Factors of states, or of states and then inputs, as factors of these coordinates.
    pub(crate) fn factors(&self, factors: &[f64]) -> Vec<f64> {
        factors.iter().enumerate().map(|(k, factor)| factor * self.state(k).scale).collect()
    }

    /// A constant and what factors make of the origins.
    pub(crate) fn shifted(&self, factors: &[f64], constant: f64) -> f64 {
        if !constant.is_finite() {
            return constant;
        }
        let mut sum = Sum::new(constant);
        for (k, &factor) in factors.iter().enumerate().filter(|(_, factor)| **factor != 0.0) {
            sum.add_product(factor, self.state(k).origin);
        }
        sum.value()
    }

    /// The power of two by which a condition with these factors is multiplied, so that its largest
    /// factor in these coordinates is near 1: 1 where nothing in it has a unit of its own.
    pub(crate) fn weight<'a>(&self, parts: impl IntoIterator<Item = &'a [f64]>) -> f64 {
        let (mut largest, mut is_plain) = (0.0_f64, true);
        for part in parts {
            for (k, factor) in part.iter().enumerate().filter(|(_, factor)| **factor != 0.0) {
                let scale = self.state(k).scale;
                largest = largest.max((factor * scale).abs());
                is_plain &= scale == 1.0;
            }
        }
        if is_plain || largest == 0.0 { 1.0 } else { 1.0 / power_of_two(largest) }
    }

    /// A flow in these coordinates.
    pub(crate) fn flow(&self, flow: &LinearSystem) -> Result<LinearSystem, Error> {
        let (n, m) = (flow.states(), flow.inputs());
        let own = |i: usize| self.state(i).scale;
        let a = Matrix::from_fn(n, n, |i, j| flow.a()[(i, j)] * own(j) / own(i));
        let b = Matrix::from_fn(n, m, |i, j| flow.b()[(i, j)] * self.input(j).scale / own(i));
        let constant = |i: usize| {
            let row: Vec<f64> =
                (0..n).map(|j| flow.a()[(i, j)]).chain((0..m).map(|j| flow.b()[(i, j)])).collect();
            self.kept(i, &row, flow.c()[i], true)
        };
        LinearSystem::new(a, b, (0..n).map(constant).collect::<Vec<f64>>())
    }

    /// The constant of a row of a map from states, or states and inputs, to states:
    /// `(row . origins + constant - origin of the state) / scale`, without the last origin for a
    /// part that is added to a state.
    fn kept(&self, state: usize, row: &[f64], constant: f64, is_whole: bool) -> f64 {
        let mut sum = Sum::new(constant);
        for (k, &factor) in row.iter().enumerate().filter(|(_, factor)| **factor != 0.0) {
            sum.add_product(factor, self.state(k).origin);
        }
        if is_whole {
            sum.add(-self.state(state).origin);
        }
        sum.value() / self.state(state).scale
    }

    /// A reset in these coordinates, or a part that is added to the next state.
    fn reset(&self, reset: &Reset, is_whole: bool) -> Reset {
        let n = reset.matrix.nrows();
        let scale = |i: usize| self.state(i).scale;
        let entry = |i: usize, j: usize| reset.matrix[(i, j)] * scale(j) / scale(i);
        let row = |i: usize| (0..n).map(|j| reset.matrix[(i, j)]).collect::<Vec<f64>>();
        let rows: Vec<Vec<f64>> = (0..n).map(row).collect();
        let at = |offset: &Vec<f64>| {
            let one = |(i, r): (usize, &f64)| self.kept(i, &rows[i], *r, is_whole);
            offset.iter().enumerate().map(one).collect()
        };
        Reset { matrix: Mat::from_fn(n, n, entry), offset: reset.offset.map(at) }
    }

    /// A half-space in these coordinates.
    pub(crate) fn halfspace(&self, own: &Halfspace) -> Halfspace {
        let weight = self.weight([&own.normal[..]]);
        let normal = self.factors(&own.normal).into_iter().map(|n| weight * n).collect();
        let back: Vec<f64> = own.normal.iter().map(|n| -n).collect();
        let limit = own.limit.map(|limit| weight * self.shifted(&back, *limit));
        Halfspace { normal, limit, ..own.clone() }
    }

    /// A norm limit in these coordinates.
    pub(crate) fn norm(&self, own: &NormLimit) -> NormLimit {
        let weight = self.weight(own.parts().map(|part| &part.factors[..]));
        let part = |part: &NormEntry| NormEntry {
            factors: self.factors(&part.factors).into_iter().map(|f| weight * f).collect(),
            constant: part.constant.map(|constant| weight * self.shifted(&part.factors, *constant)),
        };
        let entries = own.entries.iter().map(part).collect();
        NormLimit { entries, bound: part(&own.bound), ..own.clone() }
    }

    fn output_in(&self, own: &TransitionOutput) -> TransitionOutput {
        let unit = self.output(&own.name);
        let factors = self.factors(&own.factors).into_iter().map(|factor| factor / unit).collect();
        let constant = own.constant.map(|constant| self.shifted(&own.factors, *constant) / unit);
        TransitionOutput { factors, constant, ..own.clone() }
    }

    fn transition(&self, system: &HybridSystem, own: &Transition) -> Result<Transition, Error> {
        let halfspaces = |list: &[Halfspace]| list.iter().map(|h| self.halfspace(h)).collect();
        let norms = |list: &[NormLimit]| list.iter().map(|norm| self.norm(norm)).collect();
        let input = |(name, range): &(String, Schedule<Interval>)| {
            let number = system.inputs.iter().position(|(own, _)| own == name);
            let measure = number.map_or(Measure::PLAIN, |number| self.input(number));
            (name.clone(), range.map(|range| measure.inward_range(*range)))
        };
        let uncertain = |own: &Uncertain| Uncertain {
            range: own.range,
            effect: self.reset(&own.effect, false),
        };
        Ok(Transition {
            flow: self.flow(&own.flow)?,
            guards: halfspaces(&own.guards),
            prediction_guards: halfspaces(&own.prediction_guards),
            norms: norms(&own.norms),
            prediction_norms: norms(&own.prediction_norms),
            inputs: own.inputs.iter().map(input).collect(),
            reset: own.reset.as_ref().map(|reset| self.reset(reset, true)),
            uncertain: own.uncertain.iter().map(uncertain).collect(),
            outputs: own.outputs.iter().map(|output| self.output_in(output)).collect(),
            ..own.clone()
        })
    }

    /// A checked system in these coordinates, with the same handles.
    pub(crate) fn system(&self, own: &HybridSystem) -> Result<HybridSystem, Error> {
        if self.is_plain() {
            return Ok(own.clone());
        }
        let mut system = own.clone();
        for (k, (_, domain)) in system.states.iter_mut().enumerate() {
            *domain = self.state(k).inward_range(*domain);
        }
        for (k, (_, range)) in system.inputs.iter_mut().enumerate() {
            *range = range.map(|range| self.input(k).inward_range(*range));
        }
        for (k, (name, _)) in own.inputs.iter().enumerate() {
            if let Some(InputValues::Listed(list)) = system.input_values.get_mut(name) {
                list.iter_mut().for_each(|value| *value = self.input(k).inward(*value));
            }
        }
        for (k, range) in system.disturbance.iter_mut().enumerate() {
            *range = Measure::unit(self.state(k).scale).inward_range(*range);
        }
        system.limits = own.limits.iter().map(|limit| self.halfspace(limit)).collect();
        system.norms = own.norms.iter().map(|limit| self.norm(limit)).collect();
        system.flow = own.flow.as_ref().map(|flow| self.flow(flow)).transpose()?;
        for (choice, stated) in system.choices.iter_mut().zip(&own.choices) {
            let transitions = stated.transitions.iter().map(|t| self.transition(own, t));
            choice.transitions = transitions.collect::<Result<_, Error>>()?;
        }
        Ok(system)
    }

    /// A checked region in these coordinates.
    pub(crate) fn region(&self, own: &Region) -> Region {
        if self.is_plain() {
            return own.clone();
        }
        let ranges = own.ranges.iter().enumerate();
        Region {
            ranges: ranges.map(|(k, range)| self.state(k).inward_range(*range)).collect(),
            halfspaces: own.halfspaces.iter().map(|h| self.halfspace(h)).collect(),
            norms: own.norms.iter().map(|norm| self.norm(norm)).collect(),
            nonlinear: own.nonlinear.clone(),
            modes: own.modes.clone(),
        }
    }
}

/// A system as it is stated, and as it is computed.
#[derive(Debug, Clone)]
pub(crate) struct Restated {
    pub(crate) system: HybridSystem,
    pub(crate) coordinates: Coordinates,
}

impl HybridSystem {
    /// A checked system in the coordinates of its domains.
    pub(crate) fn restated(&self) -> Result<Restated, Error> {
        let coordinates = Coordinates::of(self);
        Ok(Restated { system: coordinates.system(self)?, coordinates })
    }
}
