//! Stating a system: its states, inputs and series, its limits, its choices.

#[cfg(doc)]
use super::TransitionMut;
use super::check::check_name;
use super::flow_rows::FlowKind;
use super::handles::{Input, Meaning, State};
use super::system_row::SystemRow;
use super::{HybridSystem, Schedule};
use crate::error::{Error, ErrorKind, check_finite};
use crate::hybrid::step::Moment;
use crate::interval::Interval;
use crate::model::{Nonlinear, Variable};

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
    /// cart.mode("roll")?.next([x.is(x + 0.5 * u)])?;
    /// let mut solver = BranchAndBound::default();
    /// let found = cart.shortest([x.equals(0.0)], [x.equals(1.0)], &mut solver)?;
    /// assert_eq!(found.steps, Some(5));
    /// # Ok::<(), carom::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`ErrorKind::DuplicateName`], [`ErrorKind::InvalidName`], [`ErrorKind::NotFinite`],
    /// [`ErrorKind::CrossedBounds`]; [`ErrorKind::OutOfRange`] for an empty list.
    pub fn input(
        &mut self,
        name: &str,
        lower: impl Into<Schedule<f64>>,
        upper: impl Into<Schedule<f64>>,
    ) -> Result<Input, Error> {
        self.check_name(name)?;
        let (lower, upper) = (lower.into(), upper.into());
        lower.check(&format!("the lower end of `{name}`"))?;
        upper.check(&format!("the upper end of `{name}`"))?;
        let last = lower.settles().max(upper.settles());
        let at = |step| Some(Interval::new(*lower.get(step)?, *upper.get(step)?));
        let ranges: Vec<Interval> = (0..=last).filter_map(at).collect();
        ranges.iter().try_for_each(|range| super::check_ends(name, *range))?;
        // What was stated before does not depend on it.
        self.add_idle_input();
        self.inputs.push((name.to_owned(), ranges.into()));
        Ok(Input::of(self.handles.of(Meaning::Input(self.inputs.len() - 1))))
    }

    /// Declares a series: a number that is known for each step, such as a price, a reference or the
    /// place of a moving wall. The last value goes on for ever. A series can stand wherever a
    /// constant can, and as a factor in the costs of a [program](HybridSystem::program). In a flow
    /// it becomes an input of its name that has one value in each step: plans have it among their
    /// inputs, and simulations are given it with them.
    ///
    /// ```
    /// use carom::prelude::*;
    ///
    /// // A store that can buy up to 3 units an hour, and needs 1, at a price by hour.
    /// let mut store = HybridSystem::new(3600.0); // s
    /// let full = store.state("full", 0.0, 9.0)?;
    /// let buy = store.input("buy", 0.0, 3.0)?;
    /// let price = store.series("price", [5.0, 2.0, 8.0, 8.0])?;
    /// store.mode("use")?.next([full.is(full + buy - 1.0)])?;
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
    /// [`TransitionMut::output`]. With several choices it is the sum of theirs, and 0 in
    /// transitions that do not say it.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::InvalidName`].
    pub fn output(&mut self, name: &str) -> Result<Variable, Error> {
        check_name(name)?;
        Ok(self.handles.of(Meaning::Output(name.to_owned())))
    }

    /// Adds a limit on the states at every sample, or on states and inputs in every step. It could
    /// be dropped: explanations name it, and say whether dropping it would help. The row may limit
    /// a length:
    ///
    /// ```
    /// use carom::model::norm;
    /// use carom::prelude::*;
    ///
    /// let mut puck = HybridSystem::new(1.0); // s
    /// let x = puck.state("x", 0.0, 9.0)?; // m
    /// let y = puck.state("y", 0.0, 9.0)?; // m
    /// let vx = puck.input("vx", -9.0, 9.0)?; // m/s
    /// let vy = puck.input("vy", -9.0, 9.0)?; // m/s
    /// puck.limit("speed", norm([vx, vy]).le(2.5))?;
    /// puck.mode("slide")?.next([x.is(x + vx), y.is(y + vy)])?;
    /// // 3 m and 4 m away: 5 m at 2.5 m/s.
    /// let (start, goal) = ([x.equals(0.0), y.equals(0.0)], [x.equals(3.0), y.equals(4.0)]);
    /// let found = puck.shortest(start, goal, &mut BranchAndBound::default())?;
    /// assert_eq!(found.steps, Some(2));
    /// # Ok::<(), carom::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`ErrorKind::Misplaced`] for a row that is not of states, inputs and series;
    /// [`ErrorKind::ForeignHandle`], [`ErrorKind::EmptyRow`], [`ErrorKind::UnlimitedRow`],
    /// [`ErrorKind::InvalidName`]. For norms and squares also those of
    /// [`Model::add`](crate::model::Model::add).
    pub fn limit(&mut self, name: &str, row: impl Into<SystemRow>) -> Result<(), Error> {
        check_name(name)?;
        self.add_limit(Some((name, true)), &row.into())
    }

    /// Adds a row that holds at every sample, or in every step, by the nature of the system:
    /// explanations take it for granted.
    ///
    /// # Errors
    ///
    /// As for [`limit`](HybridSystem::limit).
    pub fn invariant(&mut self, row: impl Into<SystemRow>) -> Result<(), Error> {
        self.add_limit(None, &row.into())
    }

    fn add_limit(&mut self, name: Option<(&str, bool)>, row: &SystemRow) -> Result<(), Error> {
        const PLACE: &str = "a limit of the system";
        let (moment, text) = match row {
            SystemRow::Row(row) => {
                let (moment, halves) = self.halfspaces(name, row, PLACE)?;
                if moment == Moment::Start {
                    self.limits.extend(halves);
                }
                (moment, self.row_text(row))
            }
            SystemRow::Conic(row) => {
                let (moment, limit) = self.norm_limit(name, row, PLACE)?;
                let text = limit.name.clone();
                if moment == Moment::Start {
                    self.norms.push(limit);
                }
                (moment, text)
            }
            SystemRow::Nonlinear(row) => {
                let text = self.nonlinear_text(row);
                if self.is_of_states(row) {
                    self.state_rows.push(self.state_row(name, row, PLACE, "")?);
                    return Ok(());
                }
                let row = self.with_functions_as_inputs(row, PLACE)?;
                let (text, is_limit) = name.unwrap_or((&text, false));
                let (moment, halves) = self.halfspaces(Some((text, is_limit)), &row, PLACE)?;
                self.limits.extend(halves);
                (moment, String::new())
            }
        };
        if moment == Moment::Prediction {
            let name = format!("the prediction in `{text}`");
            let help = "limits hold at every sample; use the state itself";
            return Err(ErrorKind::Misplaced { name, place: PLACE.to_owned(), help }.into());
        }
        Ok(())
    }

    /// States the flow that all transitions share by the derivatives of the states, in their units
    /// per second. States that are not named are constant. The flow over a step is exact for inputs
    /// that are held over it (zero-order hold). Transitions can change some of the derivatives by
    /// [`TransitionMut::rates`].
    ///
    /// # Errors
    ///
    /// [`ErrorKind::Misplaced`] for derivatives that are not functions of states and inputs, and
    /// after the first transition; [`ErrorKind::ForeignHandle`], [`ErrorKind::DuplicateName`];
    /// [`ErrorKind::OutOfRange`] for a time step that is not finite and positive.
    pub fn rates<E: Into<Nonlinear>>(
        &mut self,
        rates: impl IntoIterator<Item = (State, E)>,
    ) -> Result<(), Error> {
        self.set_common(FlowKind::Rates, rates)
    }

    /// States the flow that all transitions share by the next values of the states. States that are
    /// not named stay as they are.
    ///
    /// # Errors
    ///
    /// As for [`rates`](HybridSystem::rates).
    pub fn next<E: Into<Nonlinear>>(
        &mut self,
        values: impl IntoIterator<Item = (State, E)>,
    ) -> Result<(), Error> {
        self.set_common(FlowKind::NextValues, values)
    }

    fn set_common<E: Into<Nonlinear>>(
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
        self.flow = Some(self.flow_of(&rows)?);
        self.common = Some(rows);
        Ok(())
    }

    /// Limits the number of events of a run, over all choices.
    pub fn most_events(&mut self, most: usize) {
        self.most_events = Some(most);
    }

    /// Says what a disturbance may add to the next value of a state, in its unit. Simulations and
    /// robust sets see it, and [robust programs](crate::hybrid::HybridProgram::robust); other
    /// programs, refutations and certificates do not.
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

    /// Refuses names that are taken, and declarations of states when flows say nothing of them.
    fn check_declaration(&self, name: &str) -> Result<(), Error> {
        let is_limited = !self.limits.is_empty() || !self.norms.is_empty();
        if self.flow.is_some() || is_limited || !self.choices.is_empty() {
            let (name, place) =
                (format!("`{name}`"), "a statement after a limit, a mode or a flow".into());
            let help = "declare all states first";
            return Err(ErrorKind::Misplaced { name, place, help }.into());
        }
        self.check_name(name)
    }

    pub(super) fn check_name(&self, name: &str) -> Result<(), Error> {
        check_name(name)?;
        let states = self.states.iter().map(|(own, _)| own);
        let mut names = states.chain(self.inputs.iter().map(|(own, _)| own));
        if names.any(|own| own == name) || self.handles.has_series(name) {
            let kind = "state, input or series";
            return Err(Error::duplicate_name(name, kind));
        }
        Ok(())
    }
}
