//! How a solve is watched and stopped.

use std::fmt;
use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use super::mip_start::MipStart;
use super::progress::{Event, Incumbent};
use super::tree_exchange::TreeExchange;
use crate::error::{Error, ErrorKind};
use crate::model::Row;
use crate::solution::Point;

/// A handle that stops a running solve from another thread or from a progress callback.
///
/// Clones share one flag. A triggered interrupt stays triggered until [`reset`](Self::reset).
#[derive(Debug, Clone, Default)]
pub struct Interrupt {
    flag: Arc<AtomicBool>,
}

impl Interrupt {
    /// A new, untriggered handle.
    pub fn new() -> Self {
        Interrupt::default()
    }

    /// Asks every solve that holds a clone of this handle to stop.
    pub fn trigger(&self) {
        self.flag.store(true, Ordering::Relaxed);
    }

    /// Whether it was triggered.
    pub fn is_triggered(&self) -> bool {
        self.flag.load(Ordering::Relaxed)
    }

    /// Makes the handle usable for the next solve.
    pub fn reset(&self) {
        self.flag.store(false, Ordering::Relaxed);
    }
}

/// How a solve is watched and stopped, and what is told to it while it runs.
///
/// ```
/// use carom::prelude::*;
///
/// let mut model = Model::new("m");
/// let x = model.binary("x")?;
/// model.maximize(x)?;
///
/// let mut seen = 0;
/// let mut count = |_: &Event| seen += 1;
/// let interrupt = Interrupt::new(); // clones may be triggered from other threads
/// let mut control = Control::default().with_progress(&mut count).with_interrupt(&interrupt);
/// let solution = BranchAndBound::default().solve_with(&model, &mut control)?;
/// assert!(solution.is_optimal());
/// assert!(seen > 0);
/// # Ok::<(), carom::Error>(())
/// ```
#[derive(Default)]
#[must_use]
pub struct Control<'a> {
    progress: Option<&'a mut dyn FnMut(&Event)>,
    incumbent: Option<&'a mut OnIncumbent<'a>>,
    start: Option<&'a MipStart>,
    lazy_constraints: Option<&'a RowSource<'a>>,
    user_cuts: Option<&'a RowSource<'a>>,
    exchange: Option<&'a mut dyn TreeExchange>,
    interrupt: Interrupt,
    steps_passed: usize,
}

/// A callback that is shown a point of a model and returns rows over the model's variables.
pub type RowSource<'a> = dyn Fn(&Point) -> Result<Vec<Row>, Error> + Sync + 'a;

/// The callback for new best points.
type OnIncumbent<'a> = dyn FnMut(&Incumbent<'_>) -> ControlFlow<()> + 'a;

impl<'a> Control<'a> {
    /// Calls back on every [`Event`], on the thread that called the solver.
    #[doc(alias("callback", "log"))]
    pub fn with_progress(mut self, callback: &'a mut dyn FnMut(&Event)) -> Self {
        self.progress = Some(callback);
        self
    }

    /// Calls back with every new best point, on the thread that called the solver. Other threads of
    /// the search continue meanwhile. [`ControlFlow::Break`] ends the search, like an interrupt.
    ///
    /// ```
    /// use carom::prelude::*;
    /// use std::ops::ControlFlow;
    ///
    /// let mut model = Model::new("m");
    /// let x = model.integer("x", 0.0, 10.0)?;
    /// model.add("odd", (2.0 * x).within(3.0, 9.0))?;
    /// model.maximize(x)?;
    ///
    /// let mut seen = Vec::new();
    /// let mut note = |best: &Incumbent<'_>| {
    ///     seen.extend(best.point.value(x));
    ///     ControlFlow::Continue(())
    /// };
    /// let mut control = Control::default().with_incumbent(&mut note);
    /// let solution = BranchAndBound::default().solve_with(&model, &mut control)?;
    /// assert_eq!(seen.last().copied(), Some(solution.value(x)?));
    /// # Ok::<(), carom::Error>(())
    /// ```
    pub fn with_incumbent(mut self, callback: &'a mut OnIncumbent<'a>) -> Self {
        self.incumbent = Some(callback);
        self
    }

    /// Begins the search with values of integers: see [`MipStart`].
    #[doc(alias = "warm start")]
    pub fn with_start(mut self, start: &'a MipStart) -> Self {
        self.start = Some(start);
        self
    }

    /// Tells a [prepared](super::Prepared) model that the solve begins some steps later than the
    /// last one: the start that the last point proposes moves ahead, by the names of variables
    /// (after one step, the value of `z[3]` goes to `z[2]`). It is never trusted, so a wrong number
    /// costs time only. Other solves ignore it.
    pub fn with_steps_passed(mut self, steps: usize) -> Self {
        self.steps_passed = steps;
        self
    }

    /// Adds rows to the model that are found while it is solved: lazy constraints, of which there
    /// are too many to write down, such as the subtours of a tour.
    ///
    /// The callback sees every point that could become the best one, after it has passed the
    /// verification against the model and the rows found before. It returns rows that *every*
    /// solution must satisfy, and at least one that the point violates, by more than the
    /// feasibility tolerance, unless the point is a solution. A point that violates a returned row
    /// is never an incumbent, and the row is part of the model for the rest of the solve, in all
    /// threads. Bounds, infeasibility and the pool are proved for the model with these rows, and
    /// every point of the answer satisfies all of them. [`Statistics`](crate::solution::Statistics)
    /// counts the rows and the points that they excluded.
    ///
    /// A search that finds rows ends soon and begins again with them and with the best point, so a
    /// callback that returns all violated rows that it can find takes fewer searches.
    ///
    /// Rows are checked as [`Model::add`](crate::model::Model::add) checks them; errors call them
    /// `lazy_constraint[0]` and so on. Backends that cannot use lazy constraints return
    /// [`ErrorKind::Unsupported`](crate::error::ErrorKind::Unsupported).
    ///
    /// ```
    /// use carom::prelude::*;
    /// use carom::solution::Point;
    ///
    /// // At least one of every two neighbours on a ring, found as it is needed.
    /// let mut model = Model::new("ring");
    /// let v = model.binary_family("v", 7)?;
    /// model.minimize(v.iter().map(|v| 1.0 * v).sum::<Affine>())?;
    ///
    /// let neighbours = |point: &Point| -> Result<Vec<Row>, Error> {
    ///     let mut rows = Vec::new();
    ///     for k in 0..7 {
    ///         let pair = v[k] + v[(k + 1) % 7];
    ///         if point.value(&pair)? < 0.5 {
    ///             rows.push(pair.ge(1.0));
    ///         }
    ///     }
    ///     Ok(rows)
    /// };
    /// let mut control = Control::default().with_lazy_constraints(&neighbours);
    /// let solution = BranchAndBound::default().solve_with(&model, &mut control)?;
    /// assert_eq!(solution.objective(), Some(4.0));
    /// # Ok::<(), carom::Error>(())
    /// ```
    #[doc(alias("callback", "lazy cuts"))]
    pub fn with_lazy_constraints(mut self, callback: &'a RowSource<'a>) -> Self {
        self.lazy_constraints = Some(callback);
        self
    }

    /// Adds rows that make the relaxation tighter: user cuts, which every solution satisfies
    /// anyway.
    ///
    /// The callback sees the relaxed point of the root, in which integers may be fractional, and
    /// returns rows that cut it off, if it knows any. With them the root is relaxed and shown
    /// again, until none is returned that the point violates, or until they no longer help. The
    /// cuts hold in the whole tree.
    ///
    /// Bounds rest on the cuts. A short search without cuts comes first, and every point that is
    /// found is compared with every cut: a cut that a verified point violates is wrong, and the
    /// solve returns [`ErrorKind::WrongCut`](crate::error::ErrorKind::WrongCut). Where cuts leave
    /// no point, there is a search of twice as many nodes without them. A wrong cut that excludes
    /// only points that are never found is not noticed.
    ///
    /// Rows are checked as [`Model::add`](crate::model::Model::add) checks them; errors call them
    /// `user_cut[0]` and so on. Backends that cannot use cuts ignore them.
    ///
    /// ```
    /// use carom::prelude::*;
    /// use carom::solution::Point;
    ///
    /// // No two of three: half of each is allowed by the pairs, and not by the triangle.
    /// let mut model = Model::new("triangle");
    /// let v = model.binary_family("v", 3)?;
    /// for k in 0..3 {
    ///     model.add(("pair", k), (v[k] + v[(k + 1) % 3]).le(1.0))?;
    /// }
    /// model.maximize(v[0] + v[1] + v[2])?;
    ///
    /// let triangle = |_: &Point| Ok(vec![(v[0] + v[1] + v[2]).le(1.0)]);
    /// let mut control = Control::default().with_user_cuts(&triangle);
    /// let solution = BranchAndBound::default().solve_with(&model, &mut control)?;
    /// assert_eq!(solution.objective(), Some(1.0));
    /// # Ok::<(), carom::Error>(())
    /// ```
    #[doc(alias("callback", "cutting plane"))]
    pub fn with_user_cuts(mut self, callback: &'a RowSource<'a>) -> Self {
        self.user_cuts = Some(callback);
        self
    }

    /// Searches a tree together with other processes: on one thread, and by one way of branching.
    /// The blocks of a program are trees of their own, one after the other.
    #[doc(hidden)]
    pub fn with_exchange(mut self, exchange: &'a mut dyn TreeExchange) -> Self {
        self.exchange = Some(exchange);
        self
    }

    /// Whether the tree is searched together with other processes.
    #[doc(hidden)]
    pub fn has_exchange(&self) -> bool {
        self.exchange.is_some()
    }

    /// The exchange with other processes, for one search or for those of all blocks.
    #[doc(hidden)]
    pub fn take_exchange(&mut self) -> Option<&'a mut dyn TreeExchange> {
        self.exchange.take()
    }

    /// Stops the solve when the handle is triggered.
    pub fn with_interrupt(mut self, interrupt: &Interrupt) -> Self {
        self.interrupt = interrupt.clone();
        self
    }

    /// The interrupt in force, for backends.
    pub fn interrupt(&self) -> &Interrupt {
        &self.interrupt
    }

    /// The MIP start, for backends.
    pub fn start(&self) -> Option<&'a MipStart> {
        self.start
    }

    /// How many steps have passed since the last solve, for backends.
    pub fn steps_passed(&self) -> usize {
        self.steps_passed
    }

    /// The source of lazy constraints, for backends.
    pub fn lazy_constraints(&self) -> Option<&'a RowSource<'a>> {
        self.lazy_constraints
    }

    /// The source of user cuts, for backends.
    pub fn user_cuts(&self) -> Option<&'a RowSource<'a>> {
        self.user_cuts
    }

    /// Refuses lazy constraints, for backends that cannot use them: without them they would solve
    /// another model.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::Unsupported`], if there are any.
    pub fn refuse_lazy_constraints(&self, solver: &str) -> Result<(), Error> {
        if self.lazy_constraints.is_none() {
            return Ok(());
        }
        Err(ErrorKind::Unsupported {
            solver: solver.to_owned(),
            what: "lazy constraints".into(),
            help: "solve it with `BranchAndBound`, or add all rows to the model".into(),
        }
        .into())
    }

    /// Whether anything is reported.
    #[doc(hidden)]
    pub fn is_watched(&self) -> bool {
        self.progress.is_some() || self.incumbent.is_some()
    }

    /// Whether new best points are to be reported, for backends.
    pub fn watches_incumbents(&self) -> bool {
        self.incumbent.is_some()
    }

    /// Reports a new best point, for backends; [`ControlFlow::Break`] asks them to stop.
    pub fn report_incumbent(&mut self, incumbent: &Incumbent<'_>) -> ControlFlow<()> {
        match &mut self.incumbent {
            Some(callback) => callback(incumbent),
            None => ControlFlow::Continue(()),
        }
    }

    /// Reports an event, for backends.
    pub fn report(&mut self, event: &Event) {
        if let Some(callback) = &mut self.progress {
            callback(event);
        }
    }
}

impl fmt::Debug for Control<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Control")
            .field("progress", &self.progress.is_some())
            .field("incumbent", &self.incumbent.is_some())
            .field("start", &self.start)
            .field("lazy_constraints", &self.lazy_constraints.is_some())
            .field("user_cuts", &self.user_cuts.is_some())
            .field("exchange", &self.exchange.is_some())
            .field("interrupt", &self.interrupt)
            .finish()
    }
}
