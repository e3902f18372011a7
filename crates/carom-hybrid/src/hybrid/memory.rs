//! The memory of a run, carried from sample to sample beside its state: modes, how long they have
//! lasted, events.

use std::collections::BTreeMap;

use super::system::{Choice, HybridSystem, Transition};
use crate::error::Error;
#[cfg(doc)]
use crate::error::ErrorKind;

/// The memory of a run at a sample: the modes of the choices with memory, how long they have
/// lasted, and the number of events so far.
///
/// It is part of what a step begins with, as the state is: dwell times and the limit on events
/// depend on it. A simulation [ends](crate::hybrid::Simulation::memory) with one, a program
/// [starts](crate::hybrid::HybridProgram::start_from) from one, and a
/// [controller](crate::hybrid::RecedingHorizon::set_memory) carries one along. What is not named is
/// not known: the mode of the choice is open, and a mode without a number of samples may have
/// lasted for any time.
///
/// ```
/// use carom::hybrid::Memory;
/// use carom::prelude::*;
///
/// // A heater that stays on for 3 samples or more.
/// let mut room = HybridSystem::new(600.0); // s
/// let t = room.state("temperature", 5.0, 30.0)?; // °C
/// let [off, on] = room.modes("heater", ["off", "on"])?;
/// room.stay(off)?.next([t.is(t - 1.0)])?;
/// room.stay(on)?.next([t.is(t + 1.0)])?;
/// room.switch(off, on)?;
/// room.switch(on, off)?;
/// room.dwell(on, 3, None)?;
/// // It was switched on a step ago, so it cannot be switched off yet.
/// let memory = Memory::default().with_mode("heater", "on", 1);
/// let mut program = room.program(4)?;
/// program.start([t.equals(20.0)])?;
/// program.start_from(&memory)?;
/// program.minimize(program.sum((t - 20.0).square())?)?;
/// let plan = program.solve(&mut BranchAndBound::default())?;
/// assert_eq!(plan.run.modes("heater")?[..4], ["on", "on", "on", "off"]);
/// # Ok::<(), carom::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Eq, Default)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Memory {
    /// The number of events so far.
    pub events: usize,
    /// By choice.
    held: BTreeMap<String, Held>,
}

/// A mode that lasts.
#[derive(Debug, Clone, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct Held {
    mode: String,
    /// Samples in a row, this one included.
    samples: usize,
    /// Whether it may have lasted longer, because nobody saw how it was entered.
    at_least: bool,
}

impl Memory {
    /// Sets the mode of a choice, and for how many samples in a row it has lasted, this one
    /// included: 1 at the sample after the step that entered it. Without a number it may have
    /// lasted for any time, so that it can be left at once.
    #[must_use]
    pub fn with_mode(
        mut self,
        choice: impl Into<String>,
        mode: impl Into<String>,
        samples: impl Into<Option<usize>>,
    ) -> Self {
        let samples = samples.into();
        let (mode, at_least) = (mode.into(), samples.is_none());
        let held = Held { mode, samples: samples.unwrap_or(1).max(1), at_least };
        self.held.insert(choice.into(), held);
        self
    }

    /// Sets the number of events so far.
    #[must_use]
    pub fn with_events(mut self, events: usize) -> Self {
        self.events = events;
        self
    }

    /// The mode of a choice; `None` if it has no memory, and if its mode is open.
    pub fn mode(&self, choice: &str) -> Option<&str> {
        self.held(choice).map(|held| held.mode.as_str())
    }

    /// For how many samples in a row the mode of a choice has lasted, this one included; `None` if
    /// its mode is open, and if it may have lasted longer than it is known.
    pub fn samples(&self, choice: &str) -> Option<usize> {
        self.held(choice).filter(|held| !held.at_least).map(|held| held.samples)
    }

    /// For how many samples a mode of a choice must still hold, and for how many more it may; this
    /// one is not counted.
    pub(crate) fn left(
        &self,
        choice: &str,
        mode: &str,
        least: usize,
        most: Option<usize>,
    ) -> (usize, Option<usize>) {
        let Some(held) = self.held(choice).filter(|held| held.mode == mode) else {
            return (0, None);
        };
        let least = if held.at_least { 0 } else { least.saturating_sub(held.samples) };
        (least, most.map(|most| most.saturating_sub(held.samples)))
    }

    /// The samples that a mode has lasted, and whether it may have been longer; of a mode that is
    /// open as of one in which the run begins.
    pub(crate) fn lasted(&self, choice: &str) -> (usize, bool) {
        self.held(choice).map_or((1, true), |held| (held.samples, held.at_least))
    }

    /// Sets that the mode of a choice, which was open, is one that may have lasted for any time.
    pub(crate) fn decide(&mut self, choice: &str, mode: &str) {
        let open = || Held { mode: mode.to_owned(), samples: 1, at_least: true };
        self.held.entry(choice.to_owned()).or_insert_with(open);
    }

    /// Forgets the mode of a choice.
    pub(crate) fn forget(&mut self, choice: &str) {
        self.held.remove(choice);
    }

    /// The memory at the next sample of a run that takes a transition of a choice of this name.
    pub(crate) fn advance(&mut self, choice: &str, transition: &Transition) {
        self.events += usize::from(transition.is_event);
        let Some((from, to)) = &transition.modes else { return };
        let (samples, at_least) = match self.held(choice) {
            _ if from != to => (1, false),
            Some(held) => (held.samples + 1, held.at_least),
            None => (2, true),
        };
        self.held.insert(choice.to_owned(), Held { mode: to.clone(), samples, at_least });
    }

    /// Refuses modes that a system does not have.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::UnknownName`].
    pub(crate) fn check(&self, system: &HybridSystem) -> Result<(), Error> {
        let named = system.choices.iter().map(|choice| (choice.name.clone(), choice));
        self.check_choices(&named.collect::<Vec<_>>())
    }

    /// Refuses modes that none of some choices has; these are known by a name.
    pub(crate) fn check_choices(&self, choices: &[(String, &Choice)]) -> Result<(), Error> {
        for (choice, Held { mode, .. }) in &self.held {
            let mut named = choices.iter().filter(|(name, _)| name == choice).peekable();
            if named.peek().is_none() {
                return Err(Error::unknown_name(choice, "choice of the system"));
            }
            if !named.any(|(_, own)| own.modes().contains(&mode.as_str())) {
                return Err(Error::unknown_name(mode, "mode of the choice"));
            }
        }
        Ok(())
    }

    fn held(&self, choice: &str) -> Option<&Held> {
        self.held.get(choice)
    }
}
