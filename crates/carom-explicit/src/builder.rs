//! A table that is asked for: its program, its limits, and its build.

use std::fmt;
use std::io::BufRead;
use std::ops::RangeInclusive;

use carom_model::Error;
#[cfg(doc)]
use carom_model::ErrorKind;
use carom_model::internals::solver::StopToken;
use carom_model::model::{Affine, Model, Variable};
use carom_model::solver::Interrupt;
use carom_solver::reformulate;
use web_time::{Duration, Instant};

use crate::arrays::{LawOutput, LookupArrays};
use crate::build::{BuildGoal, CellLaw, PartitionCell};
use crate::device_cells::DeviceCells;
use crate::expected_cells::CellCounts;
use crate::form::{ParametricForm, refused};
use crate::partition::{Partition, PartitionBuild};
use crate::saved_table::read_partition;
use crate::table::{ExplicitTable, LoopStatement, TableReport, counts_line};

/// How far a build has come.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct TableProgress {
    /// The cells that are finished.
    pub cells: usize,
    /// The share of the set that they are, from 0 to 1.
    pub share: f64,
    /// The number of cells to expect in the end: a forecast, from how many cells of each size were
    /// cut so far. It means little before some hundred cells.
    pub expected_cells: usize,
    /// The time since the build began.
    pub elapsed: Duration,
}

type Watch<'a> = Box<dyn FnMut(&TableProgress) + 'a>;

/// A model of which a table of laws is to be built: some of its parameters range over a box.
///
/// ```
/// use carom::explicit::{LookupAnswer, ExplicitProgram};
/// use carom::prelude::*;
///
/// // Move x to 0 by a step of at least 1, or not at all.
/// let mut model = Model::new("step");
/// let x = model.parameter("x", 0.0, -3.0, 3.0)?;
/// let u = model.continuous("u", -2.0, 2.0)?;
/// let up = model.binary("up")?;
/// let down = model.binary("down")?;
/// model.add("least_up", u.ge(1.0 * up - 2.0 * down))?;
/// model.add("least_down", u.le(2.0 * up - 1.0 * down))?;
/// model.add("one", (up + down).le(1.0))?;
/// let rest = model.continuous("rest", -9.0, 9.0)?;
/// model.add("move", rest.equals(x + u))?;
/// model.minimize(rest.square() + 0.1 * (up + down))?;
///
/// let table = ExplicitProgram::new(&model, [x], [u])?.with_loss(0.05, 0.0)?.build();
/// let (answer, input) = table.evaluate(&[2.0]);
/// assert!(matches!(answer, LookupAnswer::Plan { loss } if loss <= 0.05));
/// assert!((input[0] + 2.0).abs() < 0.3);
/// assert_eq!(table.evaluate(&[4.0]).0, LookupAnswer::Outside);
/// # Ok::<(), carom::Error>(())
/// ```
#[must_use]
pub struct ExplicitProgram<'a> {
    form: ParametricForm,
    first_axis: Variable,
    outputs: Vec<LawOutput>,
    closed: Option<LoopStatement>,
    goal: BuildGoal,
    time_limit: Option<Duration>,
    interrupt: Interrupt,
    threads: usize,
    watch: Option<Watch<'a>>,
    begun: Option<Partition>,
}

impl fmt::Debug for ExplicitProgram<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("ExplicitProgram").field("goal", &self.goal).finish_non_exhaustive()
    }
}

impl<'a> ExplicitProgram<'a> {
    /// A table of a model for all values of some parameters.
    ///
    /// # Arguments
    ///
    /// * `axes`: the parameters that range over the box of their declared ranges, at most six.
    ///   Other parameters have their current values.
    /// * `outputs`: what a look-up returns, such as the first inputs of a plan: variables or affine
    ///   expressions, without axes.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::NotParameter`] for an axis that is none; [`ErrorKind::OutOfRange`] for no axes
    /// or too many, and for no outputs; [`ErrorKind::Unsupported`] for norms, for costs that are
    /// not convex at fixed values of the axes, and for variables without bounds; the errors of
    /// [`reformulate::lower`].
    pub fn new(
        model: &Model,
        axes: impl IntoIterator<Item = Variable>,
        outputs: impl IntoIterator<Item = impl Into<Affine>>,
    ) -> Result<Self, Error> {
        let axes: Vec<Variable> = axes.into_iter().collect();
        let lowered = reformulate::lower(model)?;
        let form = ParametricForm::of(lowered.model(), &axes)?;
        let mut columns = Vec::new();
        for output in outputs {
            let own = LawOutput::of(model, output.into())?;
            if let Some(&(j, _)) = own.terms.iter().find(|(j, _)| form.is_axis[*j]) {
                let what = format!("the axis `{}` in an output", form.names[j]);
                return Err(refused(what, "add it to the inputs behind the look-up"));
            }
            columns.push(own);
        }
        if columns.is_empty() {
            return Err(Error::out_of_range("the number of outputs of a table", 0.0, 1.0..));
        }
        let goal =
            BuildGoal { absolute: 1e-3, relative: 1e-2, finest: 1.0 / 256.0, cells: 1_000_000 };
        Ok(ExplicitProgram {
            form,
            first_axis: axes[0],
            outputs: columns,
            closed: None,
            goal,
            time_limit: None,
            interrupt: Interrupt::new(),
            threads: std::thread::available_parallelism().map_or(1, usize::from),
            watch: None,
            begun: None,
        })
    }

    /// How much a law may lose, ε: at most `absolute + relative |f|`, where f is the least cost
    /// from a state. The default is 0.001 and 0.01.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::OutOfRange`] for negative or infinite numbers, and if both are 0.
    pub fn with_loss(mut self, absolute: f64, relative: f64) -> Result<Self, Error> {
        let is_one = |value: f64| value.is_finite() && value >= 0.0;
        if !is_one(absolute) || !is_one(relative) || absolute + relative == 0.0 {
            let value = if is_one(absolute) { relative } else { absolute };
            let range = "finite, not negative, and not 0 both absolutely and relatively";
            return Err(Error::out_of_range_in_words("the loss of a table", value, 0.0.., range));
        }
        (self.goal.absolute, self.goal.relative) = (absolute, relative);
        Ok(self)
    }

    /// The finest edge, as a share of the side of the box. A cell is not cut through a shorter one,
    /// and not if it is as small as if all of its edges were so short. Cells across the border of
    /// what has a plan are cut as far as that. The default is 1/256.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::OutOfRange`] for numbers that are not between 1e-6 and 1.
    pub fn with_finest(mut self, share: f64) -> Result<Self, Error> {
        if !(1e-6..=1.0).contains(&share) {
            return Err(Error::out_of_range("the finest edge of a table", share, 1e-6..=1.0));
        }
        self.goal.finest = share;
        Ok(self)
    }

    /// The most cells. When there are as many, cells that would be cut become leaves with whatever
    /// is proved of them. The default is a million.
    pub fn with_cell_limit(mut self, cells: usize) -> Self {
        // Numbers of cells have 31 bits.
        self.goal.cells = cells.min(1 << 30);
        self
    }

    /// The time after which the rest of the set is left open. There is no limit by default.
    pub fn with_time_limit(mut self, limit: Duration) -> Self {
        self.time_limit = Some(limit);
        self
    }

    /// A handle that ends the build; what is not decided then is left open.
    pub fn with_interrupt(mut self, interrupt: &Interrupt) -> Self {
        self.interrupt = interrupt.clone();
        self
    }

    /// The number of threads; default: one a processor. The table is the same for any number,
    /// unless a limit of time or an interrupt ends the build.
    pub fn with_threads(mut self, threads: usize) -> Self {
        self.threads = threads.clamp(1, 256);
        self
    }

    /// Says where the axes are at the next sample, so that `carom-proof table` proves from which
    /// states the loop that the table closes stays among states with a plan.
    ///
    /// # Arguments
    ///
    /// * `model`: that of [`new`](Self::new).
    /// * `next`: for each axis, in their order, an affine expression of the plan, such as the state
    ///   after the first step, and by how much it may be disturbed to either side, in the unit of
    ///   the axis. An axis that may have any value of its range is its middle, disturbed by half of
    ///   the range.
    /// * `finest`: for this proof, cells are cut into pieces whose edges are at most so long, as a
    ///   share of the side of the box. Shorter ones prove more, and take more time and memory of
    ///   the checker: their number grows with the power of the axes.
    ///
    /// ```
    /// use carom::explicit::ExplicitProgram;
    /// use carom::prelude::*;
    ///
    /// let mut cart = HybridSystem::new(1.0);
    /// let x = cart.state("x", -4.0, 4.0)?; // m
    /// let u = cart.input("u", -1.0, 1.0)?; // m/s
    /// cart.mode("roll")?.next([(x, x + u)])?;
    /// let mut program = cart.program(2)?;
    /// program.minimize(program.sum(x.square() + 0.1 * u.square())?)?;
    /// let start = program.open_start([(x, -2.0..=2.0)])?;
    /// let (input, after) = (program.at(u, 0)?, program.at(x, 1)?);
    /// let explicit = ExplicitProgram::new(program.model(), start, [input])?;
    /// let table = explicit.with_next(program.model(), [(after, 0.1)], 0.1)?.build();
    /// let mut text = Vec::new();
    /// table.write_certificate(&mut text)?;
    /// assert!(String::from_utf8(text)?.contains("\nnext 1 0.1\nn 0.1 "));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`ErrorKind::OutOfRange`] if there are not as many as axes, for disturbances that are
    /// negative or infinite, and for edges that are not between 1e-6 and 1; the errors of handles,
    /// also for another model.
    pub fn with_next(
        mut self,
        model: &Model,
        next: impl IntoIterator<Item = (impl Into<Affine>, f64)>,
        finest: f64,
    ) -> Result<Self, Error> {
        model.variable_ref(self.first_axis)?;
        if !(1e-6..=1.0).contains(&finest) {
            return Err(Error::out_of_range("the edges of a loop's pieces", finest, 1e-6..=1.0));
        }
        let mut all = Vec::new();
        for (expression, disturbance) in next {
            if !disturbance.is_finite() || disturbance < 0.0 {
                return Err(Error::out_of_range("a disturbance of a loop", disturbance, 0.0..));
            }
            all.push((disturbance, LawOutput::of(model, expression.into())?));
        }
        let axes = self.form.axes.len();
        if all.len() != axes {
            let (what, value) = ("the number of axes at the next sample", all.len() as f64);
            return Err(Error::out_of_range(what, value, axes as f64..=axes as f64));
        }
        self.closed = Some(LoopStatement { next: all, finest, goal: Vec::new() });
        Ok(self)
    }

    /// Sets a goal of the loop: `carom-proof table` proves from which states the loop that
    /// [`with_next`](Self::with_next) states is there after how many steps, at most. The goal is a
    /// range of each axis, in their order and units. To be proved, it must be so large that
    /// disturbances and pieces are small beside it.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::OutOfRange`] if there are not as many ranges as axes, and for infinite ends;
    /// [`ErrorKind::Unsupported`] before `with_next`.
    pub fn with_goal(
        mut self,
        goal: impl IntoIterator<Item = RangeInclusive<f64>>,
    ) -> Result<Self, Error> {
        let goal: Vec<[f64; 2]> =
            goal.into_iter().map(|range| [*range.start(), *range.end()]).collect();
        if let Some(end) = goal.iter().flatten().find(|end| !end.is_finite()) {
            return Err(Error::out_of_range_in_words("an end of a goal", *end, .., "finite"));
        }
        let Some(closed) = &mut self.closed else {
            return Err(refused("a goal of no loop".to_owned(), "call `with_next` before"));
        };
        let axes = closed.next.len();
        if goal.len() != axes {
            let (what, value) = ("the number of ranges of a goal", goal.len() as f64);
            return Err(Error::out_of_range(what, value, axes as f64..=axes as f64));
        }
        closed.goal = goal;
        Ok(self)
    }

    /// Goes on with a table of this program: cells that are open, or lose more than is asked for
    /// now, are built anew, and the others are kept. So a table that a limit ended grows further,
    /// and ε can become smaller.
    ///
    /// ```
    /// use carom::explicit::ExplicitProgram;
    /// use carom::prelude::*;
    ///
    /// let mut model = Model::new("near");
    /// let x = model.parameter("x", 0.0, 0.0, 8.0)?;
    /// let n = model.integer("n", 0.0, 8.0)?;
    /// let rest = model.continuous("rest", -9.0, 9.0)?;
    /// model.add("apart", rest.equals(x - n))?;
    /// model.minimize(rest.square())?;
    /// let new = || ExplicitProgram::new(&model, [x], [n]);
    /// let few = new()?.with_cell_limit(4).build();
    /// let more = new()?.resume(few)?.build();
    /// assert!(more.report().open + more.report().unproved < 0.1);
    /// # Ok::<(), carom::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`ErrorKind::Unsupported`] for a table of another program, or with other outputs.
    pub fn resume(mut self, table: ExplicitTable) -> Result<Self, Error> {
        if table.form != self.form || table.outputs != self.outputs {
            let what = "a table of another program".to_owned();
            return Err(refused(what, "go on with a table of the same model, axes and outputs"));
        }
        self.begun = Some(table.partition);
        Ok(self)
    }

    /// As [`resume`](Self::resume), with a table that
    /// [`write_certificate`](ExplicitTable::write_certificate) has written, of the same model and
    /// axes. Its plans and proofs are computed again, and what does not hold is built anew.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::Unsupported`] for a table of another program; [`ErrorKind::Parse`] and
    /// [`ErrorKind::Io`] for a text that cannot be read.
    pub fn resume_from(mut self, certificate: impl BufRead) -> Result<Self, Error> {
        self.begun = Some(read_partition(&self.form, certificate)?);
        Ok(self)
    }

    /// Calls a function after each cell, on the thread that called [`build`](Self::build).
    pub fn with_progress(mut self, watch: impl FnMut(&TableProgress) + 'a) -> Self {
        self.watch = Some(Box::new(watch));
        self
    }

    /// Builds the table.
    ///
    /// A limit is no error: [`TableReport`] says which share of the set is proved, and the look-up
    /// answers [`LookupAnswer::Open`](crate::LookupAnswer::Open) for states that are not decided.
    #[must_use]
    pub fn build(self) -> ExplicitTable {
        let ExplicitProgram { form, outputs, closed, goal, mut watch, .. } = self;
        let began = Instant::now();
        let token = StopToken::new(self.time_limit, &self.interrupt);
        let mut tell = |counts: &CellCounts| {
            if let Some(watch) = &mut watch {
                watch(&TableProgress {
                    cells: counts.leaves,
                    share: counts.share,
                    expected_cells: counts.expected(),
                    elapsed: began.elapsed(),
                });
            }
        };
        let mut build = PartitionBuild {
            form: &form,
            goal,
            token: &token,
            threads: self.threads,
            watch: &mut tell,
            relaxations: 0,
        };
        let partition = build.run(self.begun);
        let relaxations = build.relaxations;
        let mut arrays = LookupArrays::new(&form, &DeviceCells::explicit(&partition), &outputs);
        let mut report = report(&partition);
        report.laws = arrays.laws.len() / (arrays.lower.len() + 1);
        (report.relaxations, report.duration) = (relaxations, began.elapsed());
        let goal = [goal.absolute, goal.relative];
        arrays.remarks = remarks(&form, &report, goal, &outputs);
        ExplicitTable { form, partition, outputs, closed, goal, report, arrays }
    }
}

/// Lines that the sources of a table say of it.
fn remarks(
    form: &ParametricForm,
    report: &TableReport,
    [absolute, relative]: [f64; 2],
    outputs: &[LawOutput],
) -> Vec<String> {
    let mut remarks = Vec::new();
    for &j in &form.axes {
        let (name, lower, upper) = (&form.names[j], form.lower[j], form.upper[j]);
        remarks.push(format!("state `{name}` from {lower} to {upper}"));
    }
    for output in outputs {
        remarks.push(format!("input `{}`", output.text(form)));
    }
    remarks.push(counts_line(report.cells, report.laws));
    remarks.push(format!("loss at most {absolute} + {relative} |least cost|"));
    let percent = |share: f64| 100.0 * share;
    remarks.push(format!(
        "of the set, in percent: {:.3} within that loss, {:.3} with a larger one, {:.3} without a \
         plan, {:.3} open",
        percent(report.proved),
        percent(report.unproved),
        percent(report.refuted),
        percent(report.open)
    ));
    remarks
}

/// The proved shares of a partition; laws, relaxations and time are left out.
fn report(partition: &Partition) -> TableReport {
    let mut report = TableReport {
        cells: 0,
        laws: 0,
        depth: partition.depth,
        proved: 0.0,
        unproved: 0.0,
        refuted: 0.0,
        open: 0.0,
        loss: 0.0,
        most_nodes: 0,
        relaxations: 0,
        duration: Duration::ZERO,
    };
    let mut shares = vec![1.0 / partition.orders as f64; partition.cells.len()];
    for (number, cell) in partition.cells.iter().enumerate() {
        let share = shares[number];
        if let PartitionCell::Plan(CellLaw { proof, .. }) | PartitionCell::NoPlan(proof) = cell {
            report.most_nodes = report.most_nodes.max(proof.steps.len());
        }
        match cell {
            PartitionCell::Cut { next, .. } => {
                next.iter().for_each(|&half| shares[half] = 0.5 * share);
                continue;
            }
            PartitionCell::Plan(law) if law.loss <= law.allowed => {
                report.proved += share;
                report.loss = report.loss.max(law.loss);
            }
            PartitionCell::Plan(_) => report.unproved += share,
            PartitionCell::NoPlan(_) => report.refuted += share,
            PartitionCell::Open => report.open += share,
        }
        report.cells += 1;
    }
    report
}
