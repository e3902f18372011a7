//! Stating a system: its states, inputs and series, its limits, its choices.

use super::choice::Dwell;
use super::flow::FlowKind;
use super::handles::{Meaning, State, unknown};
use super::transition::Transition;
use super::transition_mut::TransitionMut;
use super::{HybridSystem, MODE, Schedule};
use crate::error::{Error, ErrorKind, check_finite};
use crate::interval::Interval;
use crate::model::{Affine, Row, Variable, is_name};

impl HybridSystem {
    /// Declares a state with its domain, in the state's unit: at every sample the state lies in it.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::DuplicateName`], [`ErrorKind::InvalidName`], [`ErrorKind::NotFinite`],
    /// [`ErrorKind::CrossedBounds`]; [`ErrorKind::Misplaced`] after the first limit, mode or flow.
    pub fn state(&mut self, name: &str, lower: f64, upper: f64) -> Result<State, Error> {
        self.check_declaration(name)?;
        super::check_ends(name, Interval::new(lower, upper))?;
        self.states.push((name.to_owned(), Interval::new(lower, upper)));
        if !self.disturbance.is_empty() {
            self.disturbance.push(Interval::point(0.0));
        }
        Ok(self.handles.state(self.states.len() - 1))
    }

    /// Declares an input with its range, in the input's unit. Either end is a number or a list by
    /// step, whose last entry goes on for ever.
    ///
    /// ```
    /// use carom::prelude::*;
    ///
    /// let mut cart = HybridSystem::new(0.5); // s
    /// let x = cart.state("x", -9.0, 9.0)?; // m
    /// // The drive is off until step 3.
    /// let u = cart.input("u", 0.0, [vec![0.0; 3], vec![1.0]].concat())?; // m/s
    /// cart.mode("roll")?.next([(x, x + 0.5 * u)])?;
    /// let found = cart.shortest([x.equals(0.0)], [x.equals(1.0)], &mut BranchAndBound::default())?;
    /// assert_eq!(found.steps, Some(5));
    /// # Ok::<(), carom::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// As for [`state`](HybridSystem::state); [`ErrorKind::OutOfRange`] for an empty list.
    pub fn input(
        &mut self,
        name: &str,
        lower: impl Into<Schedule<f64>>,
        upper: impl Into<Schedule<f64>>,
    ) -> Result<Variable, Error> {
        self.check_declaration(name)?;
        let (lower, upper) = (lower.into(), upper.into());
        lower.check(&format!("the lower end of `{name}`"))?;
        upper.check(&format!("the upper end of `{name}`"))?;
        let last = lower.settles().max(upper.settles());
        let at = |step| Some(Interval::new(*lower.get(step)?, *upper.get(step)?));
        let ranges: Vec<Interval> = (0..=last).filter_map(at).collect();
        ranges.iter().try_for_each(|range| super::check_ends(name, *range))?;
        self.inputs.push((name.to_owned(), ranges.into()));
        Ok(self.handles.of(Meaning::Input(self.inputs.len() - 1)))
    }

    /// Declares a series: a number that is known for each step, such as a price, a reference or the
    /// place of a moving wall. The last value goes on for ever. A series can stand wherever a constant
    /// can, except in flows, and as a factor in the costs of a [program](HybridSystem::program).
    ///
    /// ```
    /// use carom::prelude::*;
    ///
    /// // A store that can buy up to 3 units an hour, and needs 1, at a price by hour.
    /// let mut store = HybridSystem::new(3600.0); // s
    /// let full = store.state("full", 0.0, 9.0)?;
    /// let buy = store.input("buy", 0.0, 3.0)?;
    /// let price = store.series("price", [5.0, 2.0, 8.0, 8.0])?;
    /// store.mode("use")?.next([(full, full + buy - 1.0)])?;
    /// let mut program = store.program(4)?;
    /// program.start([full.equals(1.0)])?;
    /// let cost = program.sum(price * buy)?;
    /// program.minimize(cost)?;
    /// let plan = program.solve(&mut BranchAndBound::default())?;
    /// // The three units that are missing are bought in the second hour.
    /// assert!((plan.solution.objective().unwrap_or(0.0) - 6.0).abs() < 1e-6);
    /// # Ok::<(), carom::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`ErrorKind::DuplicateName`], [`ErrorKind::InvalidName`], [`ErrorKind::NotFinite`];
    /// [`ErrorKind::OutOfRange`] for an empty list.
    pub fn series(
        &mut self,
        name: &str,
        values: impl Into<Schedule<f64>>,
    ) -> Result<Variable, Error> {
        self.check_name(name)?;
        let values = values.into();
        values.check(&format!("the series `{name}`"))?;
        check_finite(name, "a value of the series", values.values().copied())?;
        Ok(self.handles.of(Meaning::Series(name.to_owned(), values)))
    }

    /// Declares an output, such as an impact speed: transitions say what it is by
    /// [`TransitionMut::output`]. With several choices it is the sum of theirs, and 0 in transitions that
    /// do not say it.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::InvalidName`].
    pub fn output(&mut self, name: &str) -> Result<Variable, Error> {
        if !is_name(name) {
            return Err(ErrorKind::InvalidName { name: name.to_owned() }.into());
        }
        Ok(self.handles.of(Meaning::Output(name.to_owned())))
    }

    /// Adds a limit on the states at every sample, or on states and inputs in every step. It could be
    /// dropped: explanations name it, and say whether dropping it would help.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::Misplaced`] for a row that is not of states, inputs and series;
    /// [`ErrorKind::ForeignHandle`], [`ErrorKind::EmptyRow`], [`ErrorKind::UnlimitedRow`],
    /// [`ErrorKind::InvalidName`].
    pub fn limit(&mut self, name: &str, row: Row) -> Result<(), Error> {
        if !is_name(name) {
            return Err(ErrorKind::InvalidName { name: name.to_owned() }.into());
        }
        self.add_limit(Some((name, true)), &row)
    }

    /// Adds a row that holds at every sample, or in every step, by the nature of the system:
    /// explanations take it for granted.
    ///
    /// # Errors
    ///
    /// As for [`limit`](HybridSystem::limit).
    pub fn invariant(&mut self, row: Row) -> Result<(), Error> {
        self.add_limit(None, &row)
    }

    fn add_limit(&mut self, name: Option<(&str, bool)>, row: &Row) -> Result<(), Error> {
        const PLACE: &str = "a limit of the system";
        let (moment, halves) = self.halfspaces(name, row, PLACE)?;
        if moment == super::coefficients::Moment::Prediction {
            let name = format!("the prediction in `{}`", self.row_text(row));
            let help = "limits hold at every sample; use the state itself";
            return Err(ErrorKind::Misplaced { name, place: PLACE.to_owned(), help }.into());
        }
        self.limits.extend(halves);
        Ok(())
    }

    /// States the flow that all transitions share by the derivatives of the states, in their units per
    /// second. States that are not named are constant. The flow over a step is exact for inputs that are
    /// held over it (zero-order hold). Transitions can change some of the derivatives by
    /// [`TransitionMut::rates`].
    ///
    /// # Errors
    ///
    /// [`ErrorKind::Misplaced`] for derivatives that are not functions of states and inputs, and after
    /// the first transition; [`ErrorKind::ForeignHandle`], [`ErrorKind::DuplicateName`];
    /// [`ErrorKind::OutOfRange`] for a time step that is not finite and positive.
    pub fn rates<E: Into<Affine>>(
        &mut self,
        rates: impl IntoIterator<Item = (State, E)>,
    ) -> Result<(), Error> {
        self.set_common(FlowKind::Rates, rates)
    }

    /// States the flow that all transitions share by the next values of the states. States that are not
    /// named stay as they are.
    ///
    /// # Errors
    ///
    /// As for [`rates`](HybridSystem::rates).
    pub fn next<E: Into<Affine>>(
        &mut self,
        values: impl IntoIterator<Item = (State, E)>,
    ) -> Result<(), Error> {
        self.set_common(FlowKind::NextValues, values)
    }

    fn set_common<E: Into<Affine>>(
        &mut self,
        kind: FlowKind,
        rows: impl IntoIterator<Item = (State, E)>,
    ) -> Result<(), Error> {
        const PLACE: &str = "the common flow";
        if !self.choices.is_empty() || self.common.is_some() {
            let help = "state it once, before the first mode";
            let name = "the common flow".to_owned();
            let place = "a statement after a flow".to_owned();
            return Err(ErrorKind::Misplaced { name, place, help }.into());
        }
        let rows = self.flow_rows(kind, rows, PLACE)?;
        self.flow = Some(self.linear(&rows)?);
        self.common = Some(rows);
        Ok(())
    }

    /// A mode without memory: in each step, one of the system's modes and
    /// [events](HybridSystem::event) whose guards hold is taken.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::InvalidName`], [`ErrorKind::DuplicateName`]; [`ErrorKind::Misplaced`] if the
    /// choice has modes with memory.
    pub fn mode(&mut self, name: &str) -> Result<TransitionMut<'_>, Error> {
        self.mode_of(MODE, name)
    }

    /// An event without memory, such as an impact: a mode that counts as an event.
    ///
    /// ```
    /// use carom::prelude::*;
    ///
    /// // A ball above a floor, which reflects the part of a step that would end below it.
    /// let mut ball = HybridSystem::new(0.1); // s
    /// let h = ball.state("height", 0.0, 5.0)?; // m
    /// let v = ball.state("speed", -10.0, 10.0)?; // m/s, upward
    /// let impact = ball.output("impact speed")?;
    /// ball.rates([(h, v.into()), (v, Affine::constant(-9.81))])?;
    /// ball.mode("fall")?.guard(h.predicted().ge(0.0))?;
    /// ball.event("bounce")?
    ///     .guard(h.predicted().le(0.0))?
    ///     .guard(v.predicted().le(0.0))?
    ///     .reset([(h, -0.5 * h.predicted()), (v, -0.5 * v.predicted())])?
    ///     .output(impact, -v.predicted())?;
    /// let run = ball.simulate(&[1.0, 0.0], &[[]; 10])?;
    /// assert_eq!(run.events(), 1);
    /// # Ok::<(), carom::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// As for [`mode`](HybridSystem::mode).
    pub fn event(&mut self, name: &str) -> Result<TransitionMut<'_>, Error> {
        self.event_of(MODE, name)
    }

    /// A mode of a further choice, independent of the others: of a wall, a valve, a thruster. The
    /// choice is made with its first mode. Several choices need a common flow.
    ///
    /// # Errors
    ///
    /// As for [`mode`](HybridSystem::mode).
    pub fn mode_of(&mut self, choice: &str, name: &str) -> Result<TransitionMut<'_>, Error> {
        self.transition(choice, name, None, false)
    }

    /// An event of a further choice, as [`mode_of`](HybridSystem::mode_of).
    ///
    /// # Errors
    ///
    /// As for [`mode`](HybridSystem::mode).
    pub fn event_of(&mut self, choice: &str, name: &str) -> Result<TransitionMut<'_>, Error> {
        self.transition(choice, name, None, true)
    }

    /// Modes with memory: a choice that stays in a mode until it switches to another one. Say by
    /// [`stay`](HybridSystem::stay) what holds in each, and by [`switch`](HybridSystem::switch) which
    /// switches there are.
    ///
    /// ```
    /// use carom::prelude::*;
    ///
    /// // A heater that starts below 19 °C and stops above 21 °C.
    /// let mut room = HybridSystem::new(60.0); // s
    /// let t = room.state("temperature", 5.0, 40.0)?; // °C
    /// let [off, on] = room.modes("heater", ["off", "on"])?;
    /// let towards = |end: f64| (end - t) * (1.0 / 1800.0); // °C/s
    /// room.stay(off)?.rates([(t, towards(5.0))])?.guard(t.ge(19.0))?;
    /// room.stay(on)?.rates([(t, towards(40.0))])?.guard(t.le(21.0))?;
    /// room.switch(off, on)?.guard(t.le(19.0))?;
    /// room.switch(on, off)?.guard(t.ge(21.0))?;
    /// let options = SimulationOptions::default().with_mode("heater", "off");
    /// let day = room.simulate_with(&[20.0], &[[]; 1440], &options)?;
    /// assert!(day.states.iter().all(|state| (18.0..22.0).contains(&state[0])));
    /// # Ok::<(), carom::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`ErrorKind::InvalidName`], [`ErrorKind::DuplicateName`].
    pub fn modes<const N: usize>(
        &mut self,
        choice: &str,
        names: [&str; N],
    ) -> Result<[Variable; N], Error> {
        for (k, name) in names.iter().enumerate() {
            if !is_name(name) {
                return Err(ErrorKind::InvalidName { name: (*name).to_owned() }.into());
            }
            if names[..k].contains(name) {
                let name = (*name).to_owned();
                return Err(ErrorKind::DuplicateName { name, kind: "mode of the choice" }.into());
            }
        }
        self.check_choice_name(choice)?;
        let number = self.choice_numbered(choice);
        Ok(names.map(|name| self.handles.of(Meaning::InMode(number, name.to_owned()))))
    }

    /// The transition that stays in a mode of [`modes`](HybridSystem::modes).
    ///
    /// # Errors
    ///
    /// [`ErrorKind::ForeignHandle`] and [`ErrorKind::Misplaced`] for another handle,
    /// [`ErrorKind::DuplicateName`] at the second call.
    pub fn stay(&mut self, mode: Variable) -> Result<TransitionMut<'_>, Error> {
        let (choice, mode) = self.mode_handle(mode, "`stay`")?;
        let (choice, pair) = (self.choices[choice].name.clone(), (mode.clone(), mode.clone()));
        self.transition(&choice, &mode, Some(pair), false)
    }

    /// A transition from a mode to another one of the same choice; it counts as an event. In the step
    /// that takes it, the flow is that of the mode that it enters, unless it states its own. Its name is
    /// `off to on`; see [`TransitionMut::named`].
    ///
    /// # Errors
    ///
    /// As for [`stay`](HybridSystem::stay).
    pub fn switch(&mut self, from: Variable, to: Variable) -> Result<TransitionMut<'_>, Error> {
        let (choice, from_mode) = self.mode_handle(from, "`switch`")?;
        let (other, to_mode) = self.mode_handle(to, "`switch`")?;
        if choice != other {
            return Err(self.misplaced(to, "`switch`", "name two modes of one choice"));
        }
        let (choice, name) =
            (self.choices[choice].name.clone(), format!("{from_mode} to {to_mode}"));
        self.transition(&choice, &name, Some((from_mode, to_mode)), true)
    }

    /// Limits how long a mode lasts once it is entered: at least `least` samples in a row, and at most
    /// `most`. A plan may begin anywhere in that time and end before it is over.
    ///
    /// # Errors
    ///
    /// As for [`stay`](HybridSystem::stay); [`ErrorKind::OutOfRange`] for a time below 1 sample, and for
    /// a `most` below `least`.
    pub fn dwell(
        &mut self,
        mode: Variable,
        least: usize,
        most: impl Into<Option<usize>>,
    ) -> Result<(), Error> {
        let (choice, mode) = self.mode_handle(mode, "`dwell`")?;
        let dwell = Dwell { mode, least, most: most.into() };
        dwell.check()?;
        self.choices[choice].dwells.push(dwell);
        Ok(())
    }

    /// Limits the number of events of a run, over all choices.
    pub fn most_events(&mut self, most: usize) {
        self.most_events = Some(most);
    }

    /// Says what a disturbance may add to the next value of a state, in its unit. Simulations and robust
    /// sets see it; programs, refutations and certificates do not.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::ForeignHandle`], [`ErrorKind::NotFinite`], [`ErrorKind::CrossedBounds`].
    pub fn disturbance(&mut self, state: State, lower: f64, upper: f64) -> Result<(), Error> {
        let Meaning::State(i) = *self.meaning(state.into(), "a disturbance")? else {
            return Err(self.misplaced(state.into(), "a disturbance", "name a state"));
        };
        super::check_ends(&self.states[i].0, Interval::new(lower, upper))?;
        self.disturbance.resize(self.states.len(), Interval::point(0.0));
        self.disturbance[i] = Interval::new(lower, upper);
        Ok(())
    }

    /// Says that several transitions of a choice (`mode` if there is only one) are meant to be possible
    /// at once, because the planner chooses among them, as among gears; and that states without a way on
    /// are meant. Neither is then a [flaw](HybridSystem::flaws).
    ///
    /// # Errors
    ///
    /// [`ErrorKind::UnknownName`].
    pub fn expect(&mut self, choice: &str, overlaps: bool, dead_ends: bool) -> Result<(), Error> {
        let found = self.choices.iter_mut().find(|own| own.name == choice);
        let found = found.ok_or_else(|| unknown(choice, "choice of the system"))?;
        (found.is_free, found.may_end) = (overlaps, dead_ends);
        Ok(())
    }

    /// Adds a transition to a choice, with the common flow if there is one.
    fn transition(
        &mut self,
        choice: &str,
        name: &str,
        modes: Option<(String, String)>,
        is_event: bool,
    ) -> Result<TransitionMut<'_>, Error> {
        self.check_choice_name(choice)?;
        if !is_name(name) {
            return Err(ErrorKind::InvalidName { name: name.to_owned() }.into());
        }
        let known = self.choices.iter().find(|own| own.name == choice);
        let transitions = known.map_or(&[][..], |known| &known.transitions);
        if transitions.iter().any(|own| own.name == name) {
            let name = name.to_owned();
            return Err(ErrorKind::DuplicateName { name, kind: "transition of the choice" }.into());
        }
        let number = self.choices.iter().position(|own| own.name == choice);
        let has_memory = number.is_some_and(|number| self.has_modes(number));
        if has_memory && modes.is_none() {
            let (name, place) = (format!("the mode `{name}`"), format!("the choice `{choice}`"));
            let help = "the choice has modes with memory; use `stay` and `switch`";
            return Err(ErrorKind::Misplaced { name, place, help }.into());
        }
        let entered = modes.as_ref().filter(|(from, to)| from != to).map(|(_, to)| to);
        let known = match entered {
            Some(to) => number.and_then(|number| self.stated_flow(number, to)),
            None => self.flow.clone(),
        };
        let is_stated = known.is_some();
        let flow = match known.or_else(|| self.flow.clone()) {
            Some(flow) => flow,
            // A place holder: `check` refuses it.
            None => self.idle()?,
        };
        let number = self.choice_numbered(choice);
        let transitions = &mut self.choices[number].transitions;
        let transition = Transition { is_event, modes, ..Transition::new(name, flow) };
        transitions.push(transition);
        let own = transitions.len() - 1;
        if !is_stated {
            self.unstated.push((number, own));
        }
        self.declare_choice(number);
        Ok(TransitionMut::new(self, number, own))
    }

    /// Whether modes with memory are declared for a choice.
    fn has_modes(&self, choice: usize) -> bool {
        self.handles.is_any(|meaning| matches!(meaning, Meaning::InMode(own, _) if *own == choice))
    }

    fn mode_handle(&self, mode: Variable, place: &str) -> Result<(usize, String), Error> {
        match self.meaning(mode, place)? {
            Meaning::InMode(choice, mode) => Ok((*choice, mode.clone())),
            _ => Err(self.misplaced(mode, place, "name a mode that `modes` has made")),
        }
    }

    /// Refuses names that are taken, and declarations of states and inputs when the shape of flows and
    /// limits is settled.
    fn check_declaration(&self, name: &str) -> Result<(), Error> {
        if self.flow.is_some() || !self.limits.is_empty() || !self.choices.is_empty() {
            let (name, place) =
                (format!("`{name}`"), "a statement after a limit, a mode or a flow".into());
            let help = "declare all states and inputs first";
            return Err(ErrorKind::Misplaced { name, place, help }.into());
        }
        self.check_name(name)
    }

    fn check_name(&self, name: &str) -> Result<(), Error> {
        if !is_name(name) {
            return Err(ErrorKind::InvalidName { name: name.to_owned() }.into());
        }
        let states = self.states.iter().map(|(own, _)| own);
        let mut names = states.chain(self.inputs.iter().map(|(own, _)| own));
        if names.any(|own| own == name) || self.handles.has_series(name) {
            let kind = "state, input or series";
            return Err(ErrorKind::DuplicateName { name: name.to_owned(), kind }.into());
        }
        Ok(())
    }

    fn check_choice_name(&self, name: &str) -> Result<(), Error> {
        match is_name(name) {
            true => Ok(()),
            false => Err(ErrorKind::InvalidName { name: name.to_owned() }.into()),
        }
    }
}
