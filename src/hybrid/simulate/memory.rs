//! The memory of a run: modes, how long they have lasted, and the number of events.

use super::condition::{Condition, Slack};
use crate::error::Error;
use crate::hybrid::system::{Choice, HybridSystem, Transition};

/// The mode of a choice.
#[derive(Debug, Clone)]
struct Held {
    mode: String,
    /// Samples in a row.
    samples: usize,
    /// Whether the run began in it, so that it may have lasted longer.
    is_first: bool,
}

/// The memory of a run at a sample.
#[derive(Debug, Clone)]
pub(super) struct Memory {
    /// By choice; `None` without memory, and if the mode of the first sample is open.
    held: Vec<Option<Held>>,
    pub(super) events: usize,
}

impl Memory {
    /// The memory of a run that begins in some modes, given as pairs of choice and mode.
    pub(super) fn new(system: &HybridSystem, modes: &[(String, String)]) -> Result<Self, Error> {
        let mut held: Vec<Option<Held>> = vec![None; system.choices.len()];
        for (choice, mode) in modes {
            let found = system.choices.iter().zip(&mut held).find(|(c, _)| c.name == *choice);
            let (choice, held) =
                found.ok_or_else(|| Error::unknown_name(choice, "choice of the system"))?;
            if !choice.modes().contains(&mode.as_str()) {
                return Err(Error::unknown_name(mode, "mode of the choice"));
            }
            *held = Some(Held { mode: mode.clone(), samples: 1, is_first: true });
        }
        Ok(Memory { held, events: 0 })
    }

    /// The mode of a choice, if it has memory and the mode is known.
    pub(super) fn mode(&self, choice: usize) -> Option<&str> {
        self.held.get(choice)?.as_ref().map(|held| held.mode.as_str())
    }

    /// The conditions that the memory puts on a transition of a choice.
    pub(super) fn conditions(
        &self,
        system: &HybridSystem,
        choice: usize,
        transition: &Transition,
    ) -> Vec<Slack> {
        let mut slacks = Vec::new();
        if let (Some(most), true) = (system.most_events, transition.is_event) {
            slacks.push(events(most, self.events + 1));
        }
        let (Some((from, to)), Some(of)) = (&transition.modes, system.choices.get(choice)) else {
            return slacks;
        };
        let (samples, is_first) = match self.held.get(choice).and_then(Option::as_ref) {
            Some(held) if held.mode != *from => {
                let condition = Condition::Mode { mode: from.clone() };
                slacks.push(Slack::counted(condition, f64::NEG_INFINITY));
                return slacks;
            }
            Some(held) => (held.samples, held.is_first),
            None => (1, true),
        };
        slacks.extend(dwell(of, from, to, samples, is_first));
        slacks
    }

    /// The memory at the next sample.
    pub(super) fn advance(&mut self, choice: usize, transition: &Transition) {
        self.events += usize::from(transition.is_event);
        let (Some((from, to)), Some(held)) = (&transition.modes, self.held.get_mut(choice)) else {
            return;
        };
        let before = held.take();
        let (samples, is_first) = match before {
            _ if from != to => (1, false),
            Some(before) => (before.samples + 1, before.is_first),
            None => (2, true),
        };
        *held = Some(Held { mode: to.clone(), samples, is_first });
    }
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
    is_first: bool,
) -> impl Iterator<Item = Slack> + 'a {
    let own = choice.dwells.iter().filter(move |dwell| dwell.mode == *from);
    own.filter_map(move |dwell| {
        let mode = from.clone();
        if from != to {
            let slack = samples as f64 - dwell.least as f64;
            let condition = Condition::LeastDwell { mode };
            return (!is_first).then(|| Slack::counted(condition, slack));
        }
        let slack = dwell.most? as f64 - (samples + 1) as f64;
        Some(Slack::counted(Condition::MostDwell { mode }, slack))
    })
}
