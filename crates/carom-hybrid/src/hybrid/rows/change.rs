//! Changes of the next state by the transitions of a choice, and the number of independent ones.
//!
//! Every next state and every output is that of one transition, the *reference*, plus a change,
//! which is 0 in the reference. Changes that do not depend on state and input are sums of
//! binaries. Changes that are proportional to each other in all transitions share one variable.

use super::bound;
use super::switch::Region;
use crate::hybrid::step::{AffineForm, Dynamics};
use crate::hybrid::system::Transition;
use crate::tolerance::largest_magnitude;

/// Two lists of numbers that differ by at most this fraction are proportional (no unit).
const PROPORTIONAL: f64 = 1e-12;

/// The least factor with which a change may be stated by the next state, because the error of the
/// state is divided by it (no unit).
pub(super) const RATIO: f64 = 0.5;

/// An output represents its group if no other change of the group is this many times larger.
const LARGER: f64 = 4.0;

/// How a next state or an output changes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Part {
    /// Not at all.
    Same,
    /// By a constant in each transition.
    Constant,
    /// By a multiple of a group's variable.
    Shared { group: usize, ratio: f64 },
}

/// The changes of a choice. Quantities are the next states, and then the outputs.
#[derive(Debug, Clone)]
pub(super) struct Changes {
    /// The transition that changes nothing.
    pub(super) reference: usize,
    /// One per quantity.
    pub(super) parts: Vec<Part>,
    /// The quantity whose change is the variable of each group.
    pub(super) groups: Vec<usize>,
}

/// A quantity of a transition: a next state or an output.
pub(super) fn quantity(dynamics: &Dynamics, number: usize) -> &AffineForm {
    let states = dynamics.next.len();
    if number < states { &dynamics.next[number] } else { &dynamics.outputs[number - states] }
}

impl Changes {
    /// The changes of a choice.
    ///
    /// # Arguments
    ///
    /// * `steps`: the transitions at every step that differs from others.
    /// * `regions`: where the transitions are possible, at the last of these steps.
    pub(super) fn new(
        transitions: &[Transition],
        steps: &[&[Dynamics]],
        regions: &[Region],
    ) -> Self {
        let last = steps.last().copied().unwrap_or_default();
        let reference = reference(transitions, last, regions);
        let quantities = last.first().map_or(0, |first| first.next.len() + first.outputs.len());
        let states = last.first().map_or(0, |first| first.next.len());
        let mut parts = vec![Part::Same; quantities];
        let mut groups: Vec<Vec<(usize, Vec<f64>)>> = Vec::new();
        for (q, part) in parts.iter_mut().enumerate() {
            let change = |step: &&[Dynamics]| -> Vec<AffineForm> {
                let common = quantity(&step[reference], q);
                step.iter().map(|own| quantity(own, q).minus(common)).collect()
            };
            let maps: Vec<AffineForm> = steps.iter().flat_map(change).collect();
            if maps.iter().all(AffineForm::is_zero) {
                continue;
            }
            if maps.iter().all(AffineForm::is_constant) {
                *part = Part::Constant;
                continue;
            }
            let numbers: Vec<f64> = maps.iter().flat_map(AffineForm::numbers).collect();
            match groups.iter_mut().find(|group| ratio(&numbers, &group[0].1).is_some()) {
                Some(group) => group.push((q, numbers)),
                None => groups.push(vec![(q, numbers)]),
            }
        }
        let mut own = Vec::with_capacity(groups.len());
        for (g, group) in groups.iter().enumerate() {
            let size = |numbers: &Vec<f64>| largest_magnitude(numbers);
            let largest = group.iter().map(|(_, numbers)| size(numbers)).fold(0.0, f64::max);
            // An error of the variable must not grow in the others, so it is the largest of its
            // group; outputs are preferred, because users read them.
            let output = group.iter().find(|(q, a)| *q >= states && LARGER * size(a) >= largest);
            let own_change = output.or_else(|| group.iter().find(|(_, a)| size(a) == largest));
            let Some((chosen, numbers)) = own_change else { continue };
            for (q, others) in group {
                let ratio = if q == chosen { Some(1.0) } else { ratio(others, numbers) };
                parts[*q] = Part::Shared { group: g, ratio: ratio.unwrap_or(0.0) };
            }
            own.push(*chosen);
        }
        Changes { reference, parts, groups: own }
    }

    /// The change that a transition makes to a quantity.
    pub(super) fn of(&self, step: &[Dynamics], transition: usize, number: usize) -> AffineForm {
        quantity(&step[transition], number).minus(quantity(&step[self.reference], number))
    }

    /// The values of a group's variable, by transition.
    pub(super) fn group(&self, step: &[Dynamics], group: usize) -> Vec<AffineForm> {
        (0..step.len()).map(|j| self.of(step, j, self.groups[group])).collect()
    }
}

/// The factor between two lists of numbers, if there is one: `numbers = ratio * others`.
pub(super) fn ratio(numbers: &[f64], others: &[f64]) -> Option<f64> {
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let ratio = dot(numbers, others) / dot(others, others);
    let largest = largest_magnitude(numbers);
    let close = |(a, b): (&f64, &f64)| (a - ratio * b).abs() <= PROPORTIONAL * largest;
    (ratio != 0.0 && ratio.is_finite() && numbers.iter().zip(others).all(close)).then_some(ratio)
}

/// The transition from which the others differ least: the sum of the ranges of the changes, in
/// parts of the states' ranges. An event only if there is nothing else.
fn reference(transitions: &[Transition], step: &[Dynamics], regions: &[Region]) -> usize {
    let only_events = transitions.iter().all(|transition| transition.is_event);
    let lasting = transitions.iter().enumerate().filter(|(_, t)| only_events || !t.is_event);
    let mut best = (f64::INFINITY, 0);
    for (r, _) in lasting {
        let mut sum = 0.0;
        for i in 0..step[r].next.len() {
            let mut hull = crate::interval::Interval::point(0.0);
            for (own, region) in step.iter().zip(regions) {
                let AffineForm { factors, constant } = own.next[i].minus(&step[r].next[i]);
                hull = hull.hull(bound::range(&factors, constant, &region.domain, &region.rows));
            }
            let domain = regions[r].domain[i];
            let width = domain.upper - domain.lower;
            sum += (hull.upper - hull.lower) / if width > 0.0 { width } else { 1.0 };
        }
        if sum < best.0 * (1.0 - 1e-9) - 1e-12 || best.0 == f64::INFINITY {
            best = (sum, r);
        }
    }
    best.1
}
