//! Statements that the programs of a search get besides the rows of their system.

use std::fmt;
use std::ops::RangeInclusive;
use std::sync::Arc;

use super::Waiting;
use super::options::ShortestOptions;
use crate::error::Error;
use crate::hybrid::costs::When;
use crate::hybrid::rows::HybridProgram;
use crate::hybrid::system::Region;
use crate::model::{Model, Reformulation};

/// Writes statements into the program of a horizon.
type Write = dyn Fn(&mut Model, &HybridProgram) -> Result<(), Error> + Send + Sync;

/// Windows, rows, and how all of it is lowered.
#[derive(Clone, Default)]
pub(super) struct Statements {
    windows: Vec<(String, Region, When)>,
    rows: Vec<Arc<Write>>,
    reformulation: Option<Reformulation>,
}

impl fmt::Debug for Statements {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Statements")
            .field("windows", &self.windows)
            .field("rows", &self.rows.len())
            .field("reformulation", &self.reformulation)
            .finish()
    }
}

impl ShortestOptions {
    /// Requires every run to be in a region, in one of its modes, at given samples, as
    /// [`HybridProgram::require`] does.
    ///
    /// A window may reach beyond the end of a run; what is left of it counts. A run that ends before
    /// the first sample of a window does not meet it, so the shortest run may be longer. Since
    /// windows depend on the step, waiting is not free, and every smaller horizon is refuted separately.
    ///
    /// ```
    /// use carom::hybrid::{HybridSystem, LinearSystem, Region, ShortestOptions, Transition, When};
    /// use carom::interval::Interval;
    /// use carom::prelude::*;
    ///
    /// let cart = HybridSystem::new()
    ///     .with_state("x", Interval::new(-9.0, 9.0))
    ///     .with_input("v", Interval::new(-1.0, 1.0))
    ///     .with_transition(Transition::new("roll", LinearSystem::new([[1.0]], [[1.0]], [0.0])?));
    /// let (start, goal) = (Region::point([0.0]), Region::point([3.0]));
    /// let depot = Region::from([Interval::new(-2.0, -1.0)]);
    /// // At the depot at one of the samples 2 to 5, then to the goal.
    /// let options = ShortestOptions::default().with_window("depot", depot, When::OnceIn(2..=5));
    /// let mut solver = BranchAndBound::default();
    /// let found = cart.shortest_run(&start, &goal, 1.0, &options, &mut solver)?;
    /// assert_eq!(found.search.steps, Some(6));
    /// # Ok::<(), carom::Error>(())
    /// ```
    #[must_use]
    pub fn with_window(mut self, name: &str, region: impl Into<Region>, when: When) -> Self {
        self.statements.windows.push((name.to_owned(), region.into(), when));
        self
    }

    /// Adds statements of your own to the program of every horizon: rows, indicators, disjunctions,
    /// logic over the states, inputs and transitions of the system.
    ///
    /// The callback gets the model, and the system's variables in it with the
    /// [horizon](HybridProgram::horizon). It is called for each horizon that is solved. Nothing is known of
    /// what it adds, so waiting is not free, and every smaller horizon is refuted separately. Sets still
    /// refute what the system alone cannot do.
    ///
    /// ```
    /// use carom::hybrid::{HybridSystem, LinearSystem, Region, ShortestOptions, Transition};
    /// use carom::interval::Interval;
    /// use carom::prelude::*;
    ///
    /// let cart = HybridSystem::new()
    ///     .with_state("x", Interval::new(-9.0, 9.0))
    ///     .with_input("v", Interval::new(-2.0, 2.0))
    ///     .with_transition(Transition::new("roll", LinearSystem::new([[1.0]], [[1.0]], [0.0])?));
    /// let (start, goal) = (Region::point([0.0]), Region::point([6.0]));
    /// // Every second step at walking pace.
    /// let options = ShortestOptions::default().with_rows(|model, program| {
    ///     for (t, v) in program.input("v")?.iter().enumerate().filter(|(t, _)| t % 2 == 0) {
    ///         model.add(("slow", t), v.le(0.5))?;
    ///     }
    ///     Ok(())
    /// });
    /// let mut solver = BranchAndBound::default();
    /// let found = cart.shortest_run(&start, &goal, 1.0, &options, &mut solver)?;
    /// assert_eq!(found.search.steps, Some(6));
    /// # Ok::<(), carom::Error>(())
    /// ```
    #[must_use]
    pub fn with_rows(
        mut self,
        rows: impl Fn(&mut Model, &HybridProgram) -> Result<(), Error> + Send + Sync + 'static,
    ) -> Self {
        self.statements.rows.push(Arc::new(rows));
        self
    }

    /// Sets how the programs of all horizons are lowered: their conditions, disjunctions and choices.
    #[must_use]
    pub fn with_reformulation(mut self, reformulation: Reformulation) -> Self {
        self.statements.reformulation = Some(reformulation);
        self
    }

    /// Whether programs get windows or rows besides those of their system.
    pub(crate) fn has_statements(&self) -> bool {
        !self.statements.windows.is_empty() || !self.statements.rows.is_empty()
    }

    /// The same for a grid on which the samples of windows mean nothing.
    pub(super) fn without_statements(&self) -> Self {
        let reformulation = self.statements.reformulation;
        let statements = Statements { reformulation, ..Statements::default() };
        ShortestOptions { statements, ..self.clone() }
    }

    /// The same for steps of half the length.
    pub(crate) fn halved(&self) -> Self {
        let mut halved = self.clone();
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
    pub(crate) fn waiting(&self, own: Waiting) -> Waiting {
        match own {
            Waiting::Free(_) if self.has_statements() => {
                Waiting::NotFree("windows and rows may depend on the step".into())
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

    /// Completes the program of a horizon.
    pub(crate) fn complete(&self, model: &mut Model, program: &HybridProgram) -> Result<(), Error> {
        self.prepare(model);
        for (name, region, when) in &self.statements.windows {
            match within(when, program.horizon().steps()) {
                Some(when) => program.require(model, name, region, when)?,
                None => {
                    region.check(program.system(), "the region")?;
                    let late = model.continuous(format!("{name} after the end"), 0.0, 0.0)?;
                    model.add(name.as_str(), late.ge(1.0))?;
                }
            }
        }
        self.statements.rows.iter().try_for_each(|rows| rows(model, program))
    }
}

/// The part of a window in a run of some steps; `None` if it begins after the end. An empty window is
/// returned as it is.
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
