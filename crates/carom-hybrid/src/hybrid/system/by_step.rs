//! Systems that depend on the step, as they are seen from a later step.

use super::{Choice, Halfspace, HybridSystem, MODE, Schedule, Transition};
use crate::interval::Interval;

impl<T: Clone + PartialEq> Schedule<T> {
    /// The values from a step on: what is the value at that step becomes the value at step 0.
    ///
    /// ```
    /// use carom::hybrid::Schedule;
    ///
    /// let falling: Schedule<f64> = vec![3.0, 2.0, 1.0].into();
    /// assert_eq!(falling.from_step(1), vec![2.0, 1.0].into());
    /// assert_eq!(falling.from_step(9), vec![1.0].into());
    /// # Ok::<(), carom::Error>(())
    /// ```
    #[must_use]
    pub fn from_step(&self, step: usize) -> Self {
        let values: Vec<T> = self.values().skip(step.min(self.settles())).cloned().collect();
        Schedule::from(values)
    }

    /// Whether there are two different values.
    pub(crate) fn varies(&self) -> bool {
        self.values().any(|value| Some(value) != self.get(0))
    }
}

impl Halfspace {
    /// The half-space with its limit from a step on.
    #[must_use]
    pub fn from_step(&self, step: usize) -> Self {
        Halfspace { limit: self.limit.from_step(step), ..self.clone() }
    }
}

impl HybridSystem {
    /// The system as it is from a step on: ranges of inputs, limits, guards, resets and outputs
    /// that depend on the step are those of that step at step 0. For the programs of a [moving
    /// horizon](crate::hybrid::RecedingHorizon::moving).
    ///
    /// ```
    /// use carom::prelude::*;
    ///
    /// // A door that closes after step 2.
    /// let mut cart = HybridSystem::new(0.5); // s
    /// let x = cart.state("x", 0.0, 9.0)?;
    /// let u = cart.input("u", -1.0, 1.0)?;
    /// let door = cart.series("door", [9.0, 9.0, 9.0, 4.0])?;
    /// cart.limit("behind the door", x.le(door))?;
    /// cart.mode("roll")?.next([x.is(x + u)])?;
    /// assert!(cart.to_string().contains("x <= 9 until step 2, 4 from then on"));
    /// assert!(cart.from_step(2).to_string().contains("x <= 9 until step 0, 4 from then on"));
    /// # Ok::<(), carom::Error>(())
    /// ```
    #[must_use]
    pub fn from_step(&self, step: usize) -> Self {
        let mut system = self.clone();
        system.handles.begin_at(step);
        system.inputs.iter_mut().for_each(|(_, range)| *range = range.from_step(step));
        system.limits.iter_mut().for_each(|limit| *limit = limit.from_step(step));
        system.norms.iter_mut().for_each(|limit| *limit = limit.since_step(step));
        let choices = system.choices.iter_mut();
        choices.flat_map(|choice| &mut choice.transitions).for_each(|t| t.begin_at(step));
        system
    }

    /// A part that depends on the step, in words; `None` if there is none.
    pub(crate) fn by_step(&self) -> Option<String> {
        let range = |(name, range): &(String, Schedule<Interval>)| {
            range.varies().then(|| format!("the range of the input `{name}`"))
        };
        let mut limits = self.conditions().filter(|own| own.set.varies());
        let limit = || limits.next().map(|own| format!("the limit `{}`", own.name()));
        let transition = |(choice, t): (&Choice, &Transition)| {
            let guard = t.conditions().find(|own| own.set.varies());
            let what = match (guard, t.by_step()) {
                (Some(guard), _) => format!("the guard `{}`", guard.name()),
                (None, Some(what)) => what,
                (None, None) => return None,
            };
            Some(match choice.name == MODE {
                true => format!("{what} of the transition `{}`", t.name),
                false => format!("{what} of the transition `{}` of `{}`", t.name, choice.name),
            })
        };
        let mut transitions =
            self.choices.iter().flat_map(|own| own.transitions.iter().map(move |t| (own, t)));
        let mut series = self.handles.series().filter(|(_, values)| values.varies());
        let series = series.next().map(|(name, _)| format!("the series `{name}`"));
        let own = self.inputs.iter().find_map(range).or(series);
        own.or_else(limit).or_else(|| transitions.find_map(transition))
    }
}

impl Transition {
    /// Moves its values by step to a later beginning.
    fn begin_at(&mut self, step: usize) {
        let guards = self.guards.iter_mut().chain(&mut self.prediction_guards);
        guards.for_each(|guard| *guard = guard.from_step(step));
        let norms = self.norms.iter_mut().chain(&mut self.prediction_norms);
        norms.for_each(|norm| *norm = norm.since_step(step));
        self.inputs.iter_mut().for_each(|(_, range)| *range = range.from_step(step));
        if let Some(reset) = &mut self.reset {
            reset.offset = reset.offset.from_step(step);
        }
        for own in &mut self.uncertain {
            own.effect.offset = own.effect.offset.from_step(step);
        }
        for output in &mut self.outputs {
            output.constant = output.constant.from_step(step);
        }
    }

    /// A part other than a guard that depends on the step, in words; `None` if there is none.
    fn by_step(&self) -> Option<String> {
        if let Some((name, _)) = self.inputs.iter().find(|(_, range)| range.varies()) {
            return Some(format!("the range of the input `{name}`"));
        }
        if self.reset.as_ref().is_some_and(|reset| reset.offset.varies()) {
            return Some("the reset".to_owned());
        }
        if self.uncertain.iter().any(|own| own.effect.offset.varies()) {
            return Some("the uncertain part".to_owned());
        }
        let output = self.outputs.iter().find(|output| output.constant.varies());
        output.map(|output| format!("the output `{}`", output.name))
    }
}
