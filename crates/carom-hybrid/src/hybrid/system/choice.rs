//! A choice among transitions, with or without memory.

use super::transition::Transition;
use crate::error::Error;
use crate::setters::setters;

/// How long a mode lasts once it is entered, in steps.
#[derive(Debug, Clone, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Dwell {
    /// The mode.
    pub(crate) mode: String,
    /// At least this many samples in a row; at least 1.
    pub(crate) least: usize,
    /// At most this many samples in a row.
    pub(crate) most: Option<usize>,
}

impl Dwell {
    /// Refuses times below 1 sample, and a longest time below the shortest one.
    pub(super) fn check(&self) -> Result<(), Error> {
        let (least, most) = (self.least, self.most.unwrap_or(usize::MAX));
        if least == 0 || most < least {
            let what = match least {
                0 => format!("the least dwell time of `{}`", self.mode),
                _ => format!("the longest dwell time of `{}`", self.mode),
            };
            let value = if least == 0 { least } else { most };
            let range = least.max(1) as f64..;
            return Err(Error::out_of_range_with(what, value as f64, range, " samples"));
        }
        Ok(())
    }
}

/// One of the independent choices of a step, such as a wall or a thruster: exactly one of its
/// transitions is taken.
#[derive(Debug, Clone, PartialEq)]
#[doc(hidden)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Choice {
    pub name: String,
    pub transitions: Vec<Transition>,
    pub(crate) dwells: Vec<Dwell>,
    /// Whether overlaps are meant; see [`HybridSystem::expect`](super::HybridSystem::expect).
    pub is_free: bool,
    /// Whether gaps and dead ends are meant; see
    /// [`HybridSystem::expect`](super::HybridSystem::expect).
    pub may_end: bool,
}

impl Choice {
    pub fn new(name: impl Into<String>) -> Self {
        Choice {
            name: name.into(),
            transitions: Vec::new(),
            dwells: Vec::new(),
            is_free: false,
            may_end: false,
        }
    }

    setters! {
        with_free_choice(is_free: bool) => is_free = is_free;
        with_dead_ends(may_end: bool) => may_end = may_end;
    }

    #[must_use]
    pub fn with_transition(mut self, transition: Transition) -> Self {
        self.transitions.push(transition);
        self
    }

    /// Limits how long a mode lasts once it is entered, in samples.
    #[must_use]
    pub fn with_dwell(
        mut self,
        mode: impl Into<String>,
        least: usize,
        most: impl Into<Option<usize>>,
    ) -> Self {
        self.dwells.push(Dwell { mode: mode.into(), least, most: most.into() });
        self
    }

    /// Whether one of its transitions sets a range of an input.
    pub(crate) fn sets(&self, input: &str) -> bool {
        self.transitions.iter().any(|transition| transition.input_range(input).is_some())
    }

    /// The names of its modes, in the order in which the transitions name them; empty without
    /// memory.
    pub fn modes(&self) -> Vec<&str> {
        let mut modes: Vec<&str> = Vec::new();
        for (from, to) in self.transitions.iter().filter_map(|t| t.modes.as_ref()) {
            for mode in [from, to] {
                if !modes.contains(&mode.as_str()) {
                    modes.push(mode);
                }
            }
        }
        modes
    }
}
