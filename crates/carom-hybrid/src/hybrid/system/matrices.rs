//! Building a system from matrices and half-spaces. The statements of scenes and of the paper are
//! made this way, and those of users' expressions end up as the same.

use super::handles::Meaning;
use super::{Choice, Halfspace, HybridSystem, MODE, Schedule, Transition};
use crate::hybrid::linear::LinearSystem;
use crate::interval::Interval;

#[doc(hidden)]
impl HybridSystem {
    #[must_use]
    pub fn with_state(mut self, name: impl Into<String>, domain: Interval) -> Self {
        self.handles.state(self.states.len());
        self.states.push((name.into(), domain));
        self
    }

    #[must_use]
    pub fn with_input(
        mut self,
        name: impl Into<String>,
        range: impl Into<Schedule<Interval>>,
    ) -> Self {
        self.handles.of(Meaning::Input(self.inputs.len()));
        self.inputs.push((name.into(), range.into()));
        self
    }

    #[must_use]
    pub fn with_limit(mut self, limit: Halfspace) -> Self {
        self.limits.push(limit);
        self
    }

    #[must_use]
    pub fn with_flow(mut self, flow: LinearSystem) -> Self {
        self.flow = Some(flow);
        self
    }

    /// Adds a transition to the choice named `mode`, which is made if there is none.
    #[must_use]
    pub fn with_transition(mut self, transition: Transition) -> Self {
        let choice = self.choice_numbered(MODE);
        self.choices[choice].transitions.push(transition);
        self.declare_choice(choice);
        self
    }

    #[must_use]
    pub fn with_choice(mut self, choice: Choice) -> Self {
        self.choices.push(choice);
        self.declare_choice(self.choices.len() - 1);
        self
    }

    #[must_use]
    pub fn with_most_events(mut self, most: usize) -> Self {
        self.most_events = Some(most);
        self
    }

    #[must_use]
    pub fn with_disturbance(mut self, ranges: impl Into<Vec<Interval>>) -> Self {
        self.disturbance = ranges.into();
        self
    }
}

impl HybridSystem {
    /// The number of a choice, which is made if there is none of this name.
    pub(super) fn choice_numbered(&mut self, name: &str) -> usize {
        self.choices.iter().position(|choice| choice.name == name).unwrap_or_else(|| {
            self.choices.push(Choice::new(name));
            self.choices.len() - 1
        })
    }
}
