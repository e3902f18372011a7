//! Stating choices: modes with and without memory, events, switches, dwell times.

use super::check::check_name;
use super::choice::Dwell;
use super::handles::Meaning;
use super::transition::Transition;
use super::transition_mut::TransitionMut;
use super::{HybridSystem, MODE};
use crate::error::{Error, ErrorKind};
use crate::model::Variable;

impl HybridSystem {
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
    /// ball.rates([h.is(v), v.is(-9.81)])?;
    /// ball.mode("fall")?.guard(h.predicted().ge(0.0))?;
    /// ball.event("bounce")?
    ///     .guard(h.predicted().le(0.0))?
    ///     .guard(v.predicted().le(0.0))?
    ///     .reset([h.is(-0.5 * h.predicted()), v.is(-0.5 * v.predicted())])?
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
    /// [`stay`](HybridSystem::stay) what holds in each, and by [`switch`](HybridSystem::switch)
    /// which switches there are.
    ///
    /// ```
    /// use carom::prelude::*;
    ///
    /// // A heater that starts below 19 °C and stops above 21 °C.
    /// let mut room = HybridSystem::new(60.0); // s
    /// let t = room.state("temperature", 5.0, 40.0)?; // °C
    /// let [off, on] = room.modes("heater", ["off", "on"])?;
    /// let towards = |end: f64| (end - t) * (1.0 / 1800.0); // °C/s
    /// room.stay(off)?.rates([t.is(towards(5.0))])?.guard(t.ge(19.0))?;
    /// room.stay(on)?.rates([t.is(towards(40.0))])?.guard(t.le(21.0))?;
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
            check_name(name)?;
            if names[..k].contains(name) {
                return Err(Error::duplicate_name(name, "mode of the choice"));
            }
        }
        check_name(choice)?;
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

    /// A transition from a mode to another one of the same choice; it counts as an event. In the
    /// step that takes it, the flow is that of the mode that it enters, unless it states its own.
    /// Its name is `off to on`; see [`TransitionMut::named`].
    ///
    /// # Errors
    ///
    /// As for [`stay`](HybridSystem::stay).
    pub fn switch(&mut self, from: Variable, to: Variable) -> Result<TransitionMut<'_>, Error> {
        let (choice, from_mode) = self.mode_handle(from, "`switch`")?;
        let (other, to_mode) = self.mode_handle(to, "`switch`")?;
        if choice != other || from_mode == to_mode {
            return Err(self.misplaced(to, "`switch`", "name two different modes of one choice"));
        }
        let (choice, name) =
            (self.choices[choice].name.clone(), format!("{from_mode} to {to_mode}"));
        self.transition(&choice, &name, Some((from_mode, to_mode)), true)
    }

    /// The handle of a mode that acts: 1 in the steps that enter the mode or stay in it, whose flow
    /// is the mode's, and 0 in the others. The mode itself is 1 at the samples *before* the steps
    /// that stay in it or leave it. What a mode costs in a step is written with this handle.
    ///
    /// ```
    /// use carom::prelude::*;
    ///
    /// let mut room = HybridSystem::new(900.0); // s
    /// let t = room.state("temperature", 5.0, 30.0)?; // °C
    /// let [off, on] = room.modes("heater", ["off", "on"])?;
    /// room.stay(off)?.rates([t.is(0.0)])?;
    /// room.stay(on)?.rates([t.is(0.001)])?;
    /// room.switch(off, on)?;
    /// let heats = room.acting(on)?;
    /// let mut program = room.program(1)?;
    /// program.start([t.equals(20.0), off.equals(1.0)])?;
    /// program.goal([t.ge(20.8)])?;
    /// program.minimize(program.sum(heats)?)?;
    /// let plan = program.solve(&mut BranchAndBound::default())?;
    /// assert_eq!((plan.count(heats)?, plan.is_on(on, 0)?, plan.is_on(on, 1)?), (1, false, true));
    /// # Ok::<(), carom::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// As for [`stay`](HybridSystem::stay).
    pub fn acting(&mut self, mode: Variable) -> Result<Variable, Error> {
        let (choice, mode) = self.mode_handle(mode, "`acting`")?;
        Ok(self.handles.of(Meaning::Acting(choice, mode)))
    }

    /// Limits how long a mode lasts once it is entered: at least `least` samples in a row, and at
    /// most `most`. A plan may begin anywhere in that time and end before it is over.
    ///
    /// # Errors
    ///
    /// As for [`stay`](HybridSystem::stay); [`ErrorKind::OutOfRange`] for a time below 1 sample,
    /// and for a `most` below `least`.
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

    /// Says which findings of [`well_posedness`](HybridSystem::well_posedness) are meant, in a
    /// choice (`mode` if there is only one). It changes no program and no simulation.
    ///
    /// ```
    /// use carom::prelude::*;
    ///
    /// // Both gears are possible above 1 m/s, and at the ends of the road the car cannot stop.
    /// let mut car = HybridSystem::new(0.1); // s
    /// let x = car.state("x", 0.0, 9.0)?; // m
    /// let v = car.state("v", -3.0, 3.0)?; // m/s
    /// let u = car.input("u", -1.0, 1.0)?;
    /// car.mode("first gear")?.rates([x.is(v), v.is(u)])?;
    /// car.mode("second gear")?.rates([x.is(v), v.is(2.0 * u)])?.guard(v.ge(1.0))?;
    /// let mut solver = BranchAndBound::default();
    /// assert_eq!(car.well_posedness(&mut solver)?.len(), 2);
    /// car.expect("mode", true, true)?;
    /// assert_eq!(car.well_posedness(&mut solver)?.len(), 0);
    /// # Ok::<(), carom::Error>(())
    /// ```
    ///
    /// # Arguments
    ///
    /// * `overlaps`: whether several transitions may be possible at once, because the planner
    ///   chooses among them, as among gears.
    /// * `dead_ends`: whether there may be states and inputs at which no transition is possible,
    ///   and states that no input keeps in the domain.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::UnknownName`].
    pub fn expect(&mut self, choice: &str, overlaps: bool, dead_ends: bool) -> Result<(), Error> {
        let found = self.choices.iter_mut().find(|own| own.name == choice);
        let found = found.ok_or_else(|| Error::unknown_name(choice, "choice of the system"))?;
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
        check_name(choice)?;
        check_name(name)?;
        let known = self.choices.iter().find(|own| own.name == choice);
        let transitions = known.map_or(&[][..], |known| &known.transitions);
        if transitions.iter().any(|own| own.name == name) {
            return Err(Error::duplicate_name(name, "transition of the choice"));
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
}
