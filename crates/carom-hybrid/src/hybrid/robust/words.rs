//! The meaning of the rows of a tube, in the names of the system, for explanations; and which
//! transitions no tube can go between.

use super::tube::ErrorTube;
use crate::error::RobustError;
use crate::hybrid::system::{Halfspace, HybridSystem, Transition};
use crate::model::Model;
use crate::tolerance::largest_magnitude;

/// The words for rows by which a tube grows.
pub(super) const GROWTH: &str = "the growth of the tube";

/// Up to which relative difference two limits are the same value.
const MEETING: f64 = 1e-9;

/// Two transitions whose guards meet in one value, so that only a run that ends a step exactly
/// there takes the second after the first.
pub(super) struct Meeting<'a> {
    choice: usize,
    from: usize,
    to: usize,
    /// Guards on the prediction of the first and on the start of the second, by their number.
    guards: (usize, usize),
    names: [&'a str; 4],
}

impl Meeting<'_> {
    /// As an error.
    pub(super) fn error(&self) -> RobustError {
        let [from, to, leaves, enters] = self.names.map(str::to_owned);
        RobustError::NoCrossing { from, to, leaves, enters }
    }
}

/// The words for a statement that is tightened.
pub(super) fn for_every(what: &str) -> String {
    format!("{what} for every disturbance")
}

/// All pairs of transitions of a system that no tube goes between.
pub(super) fn meetings(system: &HybridSystem) -> Vec<Meeting<'_>> {
    let mut found = Vec::new();
    for (c, choice) in system.choices.iter().enumerate() {
        let pairs = (0..choice.transitions.len())
            .flat_map(|j| (0..choice.transitions.len()).map(move |i| (j, i)));
        for (j, i) in pairs.filter(|(j, i)| j != i) {
            let [first, second] = [j, i].map(|k| &choice.transitions[k]);
            if first.reset.is_some() || !follows(first, second) {
                continue;
            }
            for (g, leaves) in first.prediction_guards.iter().enumerate() {
                let met = second.guards.iter().enumerate().find(|(_, own)| meets(leaves, own));
                let Some((h, enters)) = met else { continue };
                let names = [&*first.name, &*second.name, &*leaves.name, &*enters.name];
                let guards = (first.guards.len() + g, h);
                found.push(Meeting { choice: c, from: j, to: i, guards, names });
            }
        }
    }
    found
}

/// Whether a transition can be taken in the step after another one.
fn follows(first: &Transition, second: &Transition) -> bool {
    match (&first.modes, &second.modes) {
        (Some((_, entered)), Some((left, _))) => entered == left,
        _ => true,
    }
}

/// Whether `a . x <= b` of a guard and `a . x >= b` of another one hold at one value only.
fn meets(first: &Halfspace, second: &Halfspace) -> bool {
    let largest = |own: &Halfspace| largest_magnitude(&own.normal);
    let (of_first, of_second) = (largest(first), largest(second));
    let is_plain = first.limit.is_constant() && second.limit.is_constant();
    let (Some(b), Some(d), true) = (first.limit.get(0), second.limit.get(0), is_plain) else {
        return false;
    };
    let entry = |own: &Halfspace, k: usize| own.normal.get(k).copied().unwrap_or(0.0);
    let count = first.normal.len().max(second.normal.len());
    let opposite = (0..count)
        .all(|k| (entry(first, k) / of_first + entry(second, k) / of_second).abs() <= MEETING);
    let (b, d) = (b / of_first, d / of_second);
    opposite && (b + d).abs() <= MEETING * b.abs().max(d.abs()).max(1.0)
}

impl ErrorTube<'_> {
    /// Says what the families of rows state.
    pub(super) fn describe(&self, model: &mut Model) {
        let system = self.own.system();
        let n = system.states.len();
        let mut say = |family: String, what: &str, more: &str| {
            if model.has_family(&family) {
                model.describe(&family, for_every(what) + more);
            }
        };
        let mut both = |family: String, what: &str| {
            say(format!("{family}_most"), what, "");
            say(format!("{family}_least"), what, "");
        };
        for (i, (name, _)) in system.states.iter().enumerate() {
            both(format!("tube_domain_{i}"), &format!("the domain of `{name}`"));
        }
        for (c, choice) in system.choices.iter().enumerate() {
            for (j, transition) in choice.transitions.iter().enumerate() {
                for (u, (input, _)) in system.inputs.iter().enumerate() {
                    let what = format!("the range of `{input}` in `{}`", transition.name);
                    both(format!("tube_input_{c}_{j}_{u}"), &what);
                }
            }
        }
        let limit = |name: &str| format!("the limit `{name}`");
        for (word, is_joint) in [("", false), ("joint_", true)] {
            for (k, own) in system.limits_of(is_joint).enumerate() {
                say(format!("tube_{word}limit_{k}"), &limit(own.name()), "");
            }
        }
        let meetings = meetings(system);
        for (c, choice) in system.choices.iter().enumerate() {
            for (j, own) in choice.transitions.iter().enumerate() {
                let of = |name: &str| format!("the limit `{name}` of `{}`", own.name);
                for guard in own.conditions() {
                    let g = guard.number;
                    let mut more = String::new();
                    for met in meetings.iter().filter(|met| met.choice == c) {
                        let [from, to, leaves, enters] = met.names;
                        if (met.from, met.guards.0) == (j, g) {
                            more = format!(" (no tube goes on to `{to}`: it begins at `{enters}`)");
                        } else if (met.to, met.guards.1) == (j, g) {
                            more = format!(" (no tube comes from `{from}`: it ends at `{leaves}`)");
                        }
                    }
                    say(format!("tube_guard_{c}_{j}_{g}"), &of(guard.name()), &more);
                }
            }
        }
        // The widths themselves.
        let is_plain = (0..n).all(|i| (0..n).all(|k| i == k || self.feedback.shape[(i, k)] == 0.0));
        for (k, (name, _)) in system.states.iter().enumerate() {
            let words = match is_plain {
                true => format!("the tube of `{name}`"),
                false => format!("direction {k} of the tube"),
            };
            model.describe(&format!("tube_{k}"), words);
        }
    }
}
