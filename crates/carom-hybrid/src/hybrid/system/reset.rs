//! The end of a transition, after its flow: the reset, and parts of it that are not known.

use std::collections::BTreeSet;

use faer::Mat;

use super::handles::{Meaning, State};
use super::schedule::Schedule;
use super::transition::{Reset, Uncertain};
use super::transition_mut::TransitionMut;
use crate::error::{Error, ErrorKind};
use crate::interval::Interval;
use crate::model::Nonlinear;

/// The most uncertain parameters of a transition: rows are written for all their signs.
const MOST_PARAMETERS: usize = 4;

impl TransitionMut<'_> {
    /// Resets states after the flow, as functions of the [predictions](State::predicted) and
    /// series. States that are not named keep their prediction.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::Misplaced`] for a value that is not a function of predictions and series, such
    /// as one with an input, and for a second reset; [`ErrorKind::ForeignHandle`],
    /// [`ErrorKind::DuplicateName`].
    pub fn reset<E: Into<Nonlinear>>(
        mut self,
        values: impl IntoIterator<Item = (State, E)>,
    ) -> Result<Self, Error> {
        if self.own().reset.is_some() {
            return Err(self.second("reset", "name all states of the reset at once"));
        }
        let n = self.system.states.len();
        let reset = self.by_predictions(Mat::identity(n, n), values, "a reset")?;
        self.own().reset = Some(reset);
        Ok(self)
    }

    /// Adds what is not known about the next state: a parameter δ within a range that contains 0,
    /// times functions of the [predictions](State::predicted) and series. The parameter may differ
    /// at every step that takes the transition. With constants, it is a disturbance of this
    /// transition alone.
    ///
    /// [Robust programs](crate::hybrid::HybridProgram::robust) plan for all its values and
    /// [robust sets](crate::hybrid::reach::SetOptions::disturbance) hold them; other programs and
    /// certificates are about δ = 0.
    ///
    /// ```
    /// use carom::prelude::*;
    ///
    /// let mut ball = HybridSystem::new(0.1); // s
    /// let height = ball.state("height", 0.0, 5.0)?; // m
    /// let speed = ball.state("speed", -9.0, 9.0)?; // m/s
    /// ball.rates([height.is(speed), speed.is(-9.81)])?;
    /// ball.mode("flight")?.guard(height.predicted().ge(0.0))?;
    /// // A restitution from 0.2 to 0.4.
    /// ball.event("bounce")?
    ///     .guard(height.predicted().le(0.0))?
    ///     .guard(speed.predicted().le(0.0))?
    ///     .reset([height.is(0.0), speed.is(-0.3 * speed.predicted())])?
    ///     .uncertain(-0.1, 0.1, [speed.is(speed.predicted())])?;
    /// # Ok::<(), carom::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`ErrorKind::OutOfRange`] for a range without 0 and for a fifth parameter of the transition;
    /// [`ErrorKind::NotFinite`], [`ErrorKind::CrossedBounds`]; those of
    /// [`reset`](TransitionMut::reset) for a value.
    #[doc(alias("restitution range", "parametric uncertainty"))]
    pub fn uncertain<E: Into<Nonlinear>>(
        mut self,
        lower: f64,
        upper: f64,
        values: impl IntoIterator<Item = (State, E)>,
    ) -> Result<Self, Error> {
        let what = self.place("the uncertain parameter");
        let range = Interval::new(lower, upper);
        range.check(&what)?;
        if !range.contains(0.0) {
            let help = "a range that contains 0, the value of plans that are not robust";
            return Err(match lower > 0.0 {
                true => Error::out_of_range_in_words(what, lower, ..=0.0, help),
                false => Error::out_of_range_in_words(what, upper, 0.0.., help),
            });
        }
        if self.own().uncertain.len() == MOST_PARAMETERS {
            let what = self.place("the number of uncertain parameters");
            let count = MOST_PARAMETERS as f64 + 1.0;
            return Err(Error::out_of_range(what, count, ..=MOST_PARAMETERS as f64));
        }
        let n = self.system.states.len();
        let effect = self.by_predictions(Mat::zeros(n, n), values, "an uncertain part")?;
        self.own().uncertain.push(Uncertain { range, effect });
        Ok(self)
    }

    /// Functions of predictions and series for some states; the others keep their row of the
    /// matrix.
    fn by_predictions<E: Into<Nonlinear>>(
        &mut self,
        mut matrix: Mat<f64>,
        values: impl IntoIterator<Item = (State, E)>,
        part: &str,
    ) -> Result<Reset, Error> {
        let place = self.place(part);
        let n = self.system.states.len();
        let mut offsets: Vec<Schedule<f64>> = vec![0.0.into(); n];
        let mut named = BTreeSet::new();
        for (state, value) in values {
            let Meaning::State(i) = *self.system.meaning(state.into(), &place)? else {
                return Err(self.system.misplaced(state.into(), &place, "name a state"));
            };
            if !named.insert(i) {
                let name = self.system.states[i].0.clone();
                return Err(Error::duplicate_name(&name, "state of the reset"));
            }
            let value = value.into();
            let Some(value) = value.as_affine() else {
                let name = format!("the new value of `{}`", self.system.states[i].0);
                let help = "a reset is affine; state an event with the nonlinear map as its flow by \
                            `next`";
                return Err(ErrorKind::Misplaced { name, place, help }.into());
            };
            let all = self.system.plain_coefficients(value, &place)?;
            if all.uses_inputs() {
                let help = "state it by predictions, such as `v.predicted()`, and by series; what an \
                            input does belongs in the flow";
                return Err(self.system.misplaced_input(&all, &place, help));
            }
            if all.uses_start() {
                let name = format!("the new value of `{}`", self.system.states[i].0);
                let help = "state it by predictions, such as `v.predicted()`, and by series";
                return Err(ErrorKind::Misplaced { name, place, help }.into());
            }
            (0..n).for_each(|j| matrix[(i, j)] = all.predictions[j]);
            offsets[i] = all.constant;
        }
        let last = offsets.iter().map(Schedule::settles).max().unwrap_or(0);
        let at = |step| offsets.iter().filter_map(|own| own.get(step).copied()).collect();
        let offset = (0..=last).map(at).collect::<Vec<Vec<f64>>>().into();
        Ok(Reset { matrix, offset })
    }
}
