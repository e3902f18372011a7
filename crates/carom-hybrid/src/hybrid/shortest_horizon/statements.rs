//! Statements that the programs of a search get besides the rows of their system.

use std::fmt;
use std::ops::RangeInclusive;
use std::sync::Arc;

use super::Monotonicity;
use super::options::ShortestOptions;
use crate::error::Error;
use crate::hybrid::mission::Mission;
use crate::hybrid::program::{HybridProgram, When};
use crate::hybrid::system::{HybridSystem, IntoRegion, Region, StatedRegion};
use crate::model::{Model, Reformulation};

/// Writes statements into the program of a horizon.
type Write = dyn Fn(&mut HybridProgram) -> Result<(), Error> + Send + Sync;

/// Windows, rows, and how all of it is lowered.
#[derive(Clone, Default)]
pub(super) struct Statements {
    windows: Vec<(String, StatedRegion, When)>,
    rows: Vec<Arc<Write>>,
    missions: Vec<(String, Mission)>,
    reformulation: Option<Reformulation>,
}

impl fmt::Debug for Statements {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Statements")
            .field("windows", &self.windows)
            .field("rows", &self.rows.len())
            .field("missions", &self.missions)
            .field("reformulation", &self.reformulation)
            .finish()
    }
}

impl ShortestOptions {
    /// Requires every run to be in a region at given samples, as [`HybridProgram::require`] does.
    ///
    /// A window may reach beyond the end of a run; what is left of it counts. A run that ends
    /// before the first sample of a window does not meet it, so the shortest run may be longer.
    /// Since windows depend on the step, waiting is not free, and every smaller horizon is refuted
    /// separately.
    ///
    /// ```
    /// use carom::prelude::*;
    ///
    /// let mut cart = HybridSystem::new(1.0); // s
    /// let x = cart.state("x", -9.0, 9.0)?;
    /// let v = cart.input("v", -1.0, 1.0)?;
    /// cart.mode("roll")?.next([x.is(x + v)])?;
    /// // At the depot at one of the samples 2 to 5, then to the goal.
    /// let depot = [x.within(-2.0, -1.0)];
    /// let options = ShortestOptions::default().with_window("depot", depot, When::OnceIn(2..=5));
    /// let (start, goal) = ([x.equals(0.0)], [x.equals(3.0)]);
    /// let found = cart.shortest_with(start, goal, &options, &mut BranchAndBound::default())?;
    /// assert_eq!(found.steps, Some(6));
    /// # Ok::<(), carom::Error>(())
    /// ```
    #[must_use]
    pub fn with_window(mut self, name: &str, region: impl IntoRegion, when: When) -> Self {
        self.statements.windows.push((name.to_owned(), region.stated(), when));
        self
    }

    /// Adds statements of your own to the program of every horizon: rows, indicators, disjunctions,
    /// logic over the states, inputs and transitions of the system.
    ///
    /// The callback is called for each horizon that is solved. Nothing is known of what it adds, so
    /// waiting is not free, and every smaller horizon is refuted separately. Sets still refute what
    /// the system alone cannot do.
    ///
    /// ```
    /// use carom::prelude::*;
    ///
    /// let mut cart = HybridSystem::new(1.0); // s
    /// let x = cart.state("x", -9.0, 9.0)?;
    /// let v = cart.input("v", -2.0, 2.0)?;
    /// cart.mode("roll")?.next([x.is(x + v)])?;
    /// // Every second step at walking pace.
    /// let options = ShortestOptions::default().with_rows(move |program| {
    ///     for t in (0..program.steps()).step_by(2) {
    ///         program.add(("slow", t), program.at(v.le(0.5), t)?)?;
    ///     }
    ///     Ok(())
    /// });
    /// let (start, goal) = ([x.equals(0.0)], [x.equals(6.0)]);
    /// let found = cart.shortest_with(start, goal, &options, &mut BranchAndBound::default())?;
    /// assert_eq!(found.steps, Some(6));
    /// # Ok::<(), carom::Error>(())
    /// ```
    #[must_use]
    pub fn with_rows(
        mut self,
        rows: impl Fn(&mut HybridProgram) -> Result<(), Error> + Send + Sync + 'static,
    ) -> Self {
        self.statements.rows.push(Arc::new(rows));
        self
    }

    /// Requires every run to do what a mission says, as
    /// [`require_mission`](HybridProgram::require_mission) does: the shortest horizon is that at
    /// which the mission is true.
    ///
    /// Samples beyond the end of a run make nothing true, so a horizon for which windows are too
    /// long is refuted: an *eventually* must be true in time, and an *always* holds when its window
    /// is over, or at once if that is open, as in `always(0..)`. Waiting is not free, and every
    /// smaller horizon is refuted separately.
    ///
    /// ```
    /// use carom::hybrid::Mission;
    /// use carom::prelude::*;
    ///
    /// let mut cart = HybridSystem::new(1.0); // s
    /// let x = cart.state("x", -9.0, 9.0)?;
    /// let v = cart.input("v", -1.0, 1.0)?;
    /// cart.mode("roll")?.next([x.is(x + v)])?;
    /// // Two seconds at the depot, then far away.
    /// let depot = Mission::holds("at the depot", [x.within(-2.0, -1.0)]);
    /// let far = Mission::holds("far", [x.ge(3.0)]);
    /// let mission = (depot.always(0..=2) & far.eventually(3..)).eventually(0..);
    /// let options = ShortestOptions::default().with_mission("mission", &mission);
    /// let (start, goal) = ([x.equals(0.0)], [x.ge(-9.0)]);
    /// let found = cart.shortest_with(start, goal, &options, &mut BranchAndBound::default())?;
    /// assert_eq!(found.steps, Some(7));
    /// # Ok::<(), carom::Error>(())
    /// ```
    #[must_use]
    pub fn with_mission(mut self, name: &str, mission: &Mission) -> Self {
        self.statements.missions.push((name.to_owned(), mission.clone()));
        self
    }

    /// Sets how the programs of all horizons are lowered: their conditions, disjunctions and
    /// choices.
    #[must_use]
    pub fn with_reformulation(mut self, reformulation: Reformulation) -> Self {
        self.statements.reformulation = Some(reformulation);
        self
    }

    /// Whether programs get windows or rows besides those of their system.
    pub(crate) fn has_statements(&self) -> bool {
        let Statements { windows, rows, missions, .. } = &self.statements;
        !windows.is_empty() || !rows.is_empty() || !missions.is_empty()
    }

    /// Whether a start is in the goal, and missions hold after no step. Nothing is known with
    /// windows and rows.
    pub(crate) fn start_in_goal(
        &self,
        system: &HybridSystem,
        start: &Region,
        goal: &Region,
    ) -> Result<bool, Error> {
        let Statements { windows, rows, missions, .. } = &self.statements;
        if !windows.is_empty() || !rows.is_empty() {
            return Ok(false);
        }
        let Some(run) = system.common_sample(start, goal)? else { return Ok(false) };
        for (_, mission) in missions {
            // It may be about more samples than there are.
            if !system.robustness(mission, &run).is_ok_and(|value| value >= 0.0) {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// The same for a grid on which the samples of windows mean nothing.
    pub(crate) fn without_statements(&self) -> Self {
        let reformulation = self.statements.reformulation;
        let statements = Statements { reformulation, ..Statements::default() };
        ShortestOptions { statements, ..self.clone() }
    }

    /// The same for steps of half the length.
    pub(crate) fn halved(&self) -> Self {
        let mut halved = self.clone();
        halved.upper_hint = self.upper_hint.map(|steps| steps.saturating_mul(2));
        for (_, mission) in &mut halved.statements.missions {
            *mission = mission.halved();
        }
        for (_, _, when) in &mut halved.statements.windows {
            let twice = |window: &RangeInclusive<usize>| {
                window.start().saturating_mul(2)..=window.end().saturating_mul(2)
            };
            *when = match when {
                When::At(sample) => When::At(sample.saturating_mul(2)),
                When::Throughout(window) => When::Throughout(twice(window)),
                When::OnceIn(window) => When::OnceIn(twice(window)),
            };
        }
        halved
    }

    /// Whether waiting is free, where it is without windows and rows.
    pub(crate) fn monotonicity(&self, own: Monotonicity) -> Monotonicity {
        match own {
            Monotonicity::Monotone(_) if self.has_statements() => {
                Monotonicity::NotMonotone("windows and rows may depend on the step".into())
            }
            own => own,
        }
    }

    /// Sets how a program is lowered.
    pub(super) fn prepare(&self, model: &mut Model) {
        if let Some(reformulation) = self.statements.reformulation {
            model.set_reformulation(reformulation);
        }
    }

    /// Adds what these options state to a program: windows, missions and rows, and how it is
    /// lowered. A search does this with the program of every horizon; a planner that solves the
    /// program of the shortest horizon once more, such as for the least effort, does it as well.
    ///
    /// ```
    /// use carom::prelude::*;
    ///
    /// let mut cart = HybridSystem::new(1.0); // s
    /// let x = cart.state("x", -9.0, 9.0)?;
    /// let v = cart.input("v", -2.0, 2.0)?;
    /// cart.mode("roll")?.next([x.is(x + v)])?;
    /// let when = When::OnceIn(1..=3);
    /// let options = ShortestOptions::default().with_window("depot", [x.le(-1.0)], when);
    /// let (start, goal) = ([x.equals(0.0)], [x.ge(3.0)]);
    /// let mut solver = BranchAndBound::default();
    /// let found = cart.shortest_with(start.clone(), goal.clone(), &options, &mut solver)?;
    /// // The least way in as many steps.
    /// let mut program = cart.program(found.steps.unwrap_or(1))?;
    /// program.start(start)?;
    /// program.goal(goal)?;
    /// options.complete(&mut program)?;
    /// let way = program.sum_abs("way", v)?;
    /// program.minimize(way)?;
    /// let plan = program.solve(&mut solver)?;
    /// assert!((plan.solution.objective().unwrap_or(0.0) - 5.0).abs() < 1e-6);
    /// # Ok::<(), carom::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// Those of [`HybridProgram::require`] and [`HybridProgram::require_mission`], and of the
    /// callbacks.
    pub fn complete(&self, program: &mut HybridProgram) -> Result<(), Error> {
        self.prepare(&mut program.model);
        for (name, region, when) in &self.statements.windows {
            match within(when, program.steps()) {
                Some(when) => program.require_stated(name, region, when)?,
                None => {
                    let system = program.systems.first().system();
                    region.of(system)?.check(system, "the region")?;
                    let late =
                        program.model.continuous(format!("{name} after the end"), 0.0, 0.0)?;
                    program.model.add(name.as_str(), late.ge(1.0))?;
                }
            }
        }
        for (name, mission) in &self.statements.missions {
            program.require_mission_if_in_time(name, mission)?;
        }
        self.statements.rows.iter().try_for_each(|rows| rows(program))
    }
}

/// The part of a window in a run of some steps; `None` if it begins after the end. An empty window
/// is returned as it is.
fn within(when: &When, steps: usize) -> Option<When> {
    let clipped = |window: &RangeInclusive<usize>| match window.is_empty() {
        // It is refused as it is.
        true => *window.start()..=*window.end(),
        false => *window.start()..=*window.end().min(&steps),
    };
    match when {
        When::At(sample) => (*sample <= steps).then_some(When::At(*sample)),
        When::Throughout(window) | When::OnceIn(window) if *window.start() > steps => {
            window.is_empty().then(|| when.clone())
        }
        When::Throughout(window) => Some(When::Throughout(clipped(window))),
        When::OnceIn(window) => Some(When::OnceIn(clipped(window))),
    }
}
