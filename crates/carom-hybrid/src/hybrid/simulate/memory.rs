//! Conditions of the next step that follow from the memory of a run.

use super::condition::Slack;
use crate::error::Condition;
use crate::hybrid::memory::Memory;
use crate::hybrid::system::{Choice, HybridSystem, Transition};

/// The conditions that the memory puts on a transition of a choice.
pub(super) fn conditions(
    memory: &Memory,
    system: &HybridSystem,
    choice: &Choice,
    transition: &Transition,
) -> Vec<Slack> {
    let mut slacks = Vec::new();
    if let (Some(most), true) = (system.most_events, transition.is_event) {
        slacks.push(events(most, memory.events + 1));
    }
    let Some((from, to)) = &transition.modes else { return slacks };
    if memory.mode(&choice.name).is_some_and(|mode| mode != from) {
        let condition = Condition::Mode { mode: from.clone() };
        slacks.push(Slack::counted(condition, f64::NEG_INFINITY));
        return slacks;
    }
    let (samples, at_least) = memory.lasted(&choice.name);
    slacks.extend(dwell(choice, from, to, samples, at_least));
    slacks
}

/// The limit on the number of events, if there will be so many.
pub(super) fn events(most: usize, count: usize) -> Slack {
    Slack::counted(Condition::MostEvents, most as f64 - count as f64)
}

/// The dwell times that a transition has to respect.
fn dwell<'a>(
    choice: &'a Choice,
    from: &'a String,
    to: &'a String,
    samples: usize,
    at_least: bool,
) -> impl Iterator<Item = Slack> + 'a {
    let own = choice.dwells.iter().filter(move |dwell| dwell.mode == *from);
    own.filter_map(move |dwell| {
        let mode = from.clone();
        if from != to {
            let slack = samples as f64 - dwell.least as f64;
            let condition = Condition::LeastDwell { mode };
            return (!at_least).then(|| Slack::counted(condition, slack));
        }
        let slack = dwell.most? as f64 - (samples + 1) as f64;
        Some(Slack::counted(Condition::MostDwell { mode }, slack))
    })
}
