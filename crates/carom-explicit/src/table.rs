//! The finished table.

use carom_embedded::LookupAnswer;
use web_time::Duration;

use crate::arrays::{CONDENSED_ROUNDING, LawOutput, LookupArrays, SINGLE_UNIT};
use crate::build::PartitionCell;
use crate::device_cells::DeviceCells;
use crate::form::ParametricForm;
use crate::partition::Partition;
use crate::relaxed::CornerRelaxation;
use crate::simplex_cell::{kuhn, midpoint, orders};

/// The size of a table, and what is proved of it.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct TableReport {
    /// The cells that are not cut.
    pub cells: usize,
    /// The different laws.
    pub laws: usize,
    /// The most comparisons of a look-up.
    pub depth: usize,
    /// The share of the set with a plan whose loss is within ε, from 0 to 1.
    pub proved: f64,
    /// The share with a plan whose loss is larger, or not proved.
    pub unproved: f64,
    /// The share of the set that is proved to have no plan.
    pub refuted: f64,
    /// The share without an answer: cells across the border of what has a plan, and those that the
    /// build did not reach.
    pub open: f64,
    /// The largest proved loss of a plan within ε, in the unit of the objective.
    pub loss: f64,
    /// The most nodes of a tree that proves a cell. At each state of a cell, a search that begins
    /// with its plan, cuts the integers as the proof does, and closes what cannot be better by more
    /// than the loss, ends after at most so many nodes.
    pub most_nodes: usize,
    /// The relaxations that were needed, the same for any number of threads.
    pub relaxations: u64,
    /// The time that the build took.
    pub duration: Duration,
}

/// A cell of a table: a simplex of the box.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct TableCell {
    /// Its corners, one more than axes, an entry an axis, in their units.
    pub corners: Vec<Vec<f64>>,
    /// The answer of a look-up inside.
    pub answer: LookupAnswer<f64>,
    /// The integers of the plan, in the order of the lowered model's variables; empty without a
    /// plan.
    pub integers: Vec<f64>,
}

/// A statement about the loop that a table closes.
#[derive(Debug)]
pub(crate) struct LoopStatement {
    /// For each axis, its largest disturbance, and where it is at the next sample.
    pub(crate) next: Vec<(f64, LawOutput)>,
    /// The longest edge of the pieces into which cells are cut, as a share of the side.
    pub(crate) finest: f64,
    /// A range of each axis; empty without a goal.
    pub(crate) goal: Vec<[f64; 2]>,
}

/// A table of laws for a box of parameters, made by
/// [`ExplicitProgram::build`](crate::ExplicitProgram::build).
#[derive(Debug)]
pub struct ExplicitTable {
    pub(crate) form: ParametricForm,
    pub(crate) partition: Partition,
    pub(crate) outputs: Vec<LawOutput>,
    pub(crate) closed: Option<LoopStatement>,
    /// The absolute and the relative loss that was asked for.
    pub(crate) goal: [f64; 2],
    pub(crate) report: TableReport,
    pub(crate) arrays: LookupArrays<f64>,
}

/// The words of sources about the cells and the laws of a device.
pub(crate) fn counts_line(cells: usize, laws: usize) -> String {
    format!("{cells} cells, {laws} laws")
}

impl ExplicitTable {
    /// The size of the table, and what is proved of it.
    #[must_use]
    pub fn report(&self) -> &TableReport {
        &self.report
    }

    /// The table as a device has it, in 64 bits.
    #[must_use]
    pub fn double(&self) -> &LookupArrays<f64> {
        &self.arrays
    }

    /// The table as a device has it, in 32 bits.
    ///
    /// Cells, integers and losses are the same; what is rounded is in
    /// [`state_rounding`](LookupArrays::state_rounding) and
    /// [`input_rounding`](LookupArrays::input_rounding).
    #[must_use]
    pub fn single(&self) -> LookupArrays<f32> {
        self.arrays.single()
    }

    /// The table for a device with little memory, in 64 bits: a cell gives the integers, and where
    /// that takes fewer bytes, the device solves a quadratic program for the inputs.
    ///
    /// The law is the optimum with the integers of the cell, which costs no more than what
    /// [`double`](Self::double) interpolates. Cells with the same program are joined, so that the
    /// loss of a look-up is the largest one of all cells of the program.
    ///
    /// No state takes more exchanges than
    /// [`LookupProgram::exchanges`](carom_embedded::LookupProgram::exchanges). Cells of which that
    /// cannot be proved, and those whose program is not strictly convex in the columns that
    /// equations leave, keep their explicit laws. The programs are made at each call, on one
    /// thread.
    ///
    /// ```
    /// use carom::explicit::{ExplicitProgram, LookupAnswer};
    /// use carom::prelude::*;
    ///
    /// let mut cart = HybridSystem::new(0.5);
    /// let x = cart.state("x", -4.0, 4.0)?; // m
    /// let v = cart.state("v", -2.0, 2.0)?; // m/s
    /// let u = cart.input("u", -1.0, 1.0)?; // m/s²
    /// cart.mode("roll")?.next([(x, x + 0.5 * v), (v, v + 0.5 * u)])?;
    /// let mut program = cart.program(3)?;
    /// program.minimize(program.sum(x.square() + v.square() + u.square())?)?;
    /// let start = program.open_start([(x, -2.0..=2.0), (v, -0.5..=0.5)])?;
    /// let input = program.at(u, 0)?;
    /// let explicit = ExplicitProgram::new(program.model(), start, [input])?;
    /// let table = explicit.with_loss(0.01, 0.01)?.build();
    ///
    /// let (time, memory) = (table.single(), table.single_solving());
    /// assert!(memory.bytes() < time.bytes());
    /// let mut work = vec![0.0; memory.view().work()];
    /// let (mut first, mut second) = ([0.0], [0.0]);
    /// assert!(time.view().evaluate(&[1.5, -0.2], &mut first).has_inputs());
    /// assert!(memory.view().solve(&[1.5, -0.2], &mut second, &mut work).has_inputs());
    /// assert!((first[0] - second[0]).abs() < 0.2);
    /// # Ok::<(), carom::Error>(())
    /// ```
    #[must_use]
    pub fn double_solving(&self) -> LookupArrays<f64> {
        self.solving((size_of::<f64>(), CONDENSED_ROUNDING))
    }

    /// As [`double_solving`](Self::double_solving), in 32 bits.
    #[must_use]
    pub fn single_solving(&self) -> LookupArrays<f32> {
        self.solving((size_of::<f32>(), SINGLE_UNIT)).single()
    }

    fn solving(&self, numbers: (usize, f64)) -> LookupArrays<f64> {
        let cells = DeviceCells::solving(&self.form, &self.partition, &self.outputs, numbers);
        let mut arrays = LookupArrays::new(&self.form, &cells, &self.outputs);
        let before = counts_line(self.report.cells, self.report.laws);
        let laws = arrays.laws.len() / (arrays.lower.len() + 1);
        let own = counts_line(arrays.nodes.len() + arrays.roots.len(), laws);
        let line = |line: &String| if *line == before { own.clone() } else { line.clone() };
        arrays.remarks = self.arrays.remarks.iter().map(line).collect();
        arrays
    }

    /// Looks up the inputs of a state.
    ///
    /// # Arguments
    ///
    /// * `state`: an entry for each axis, in its unit.
    ///
    /// Returns the answer and the inputs, which are zeros if the answer has none.
    pub fn evaluate(&self, state: &[f64]) -> (LookupAnswer<f64>, Vec<f64>) {
        let mut inputs = vec![0.0; self.arrays.inputs()];
        let answer = self.arrays.view().evaluate(state, &mut inputs);
        (answer, inputs)
    }

    /// The cells, for pictures and statistics.
    pub fn cells(&self) -> impl Iterator<Item = TableCell> + '_ {
        let orders = orders(self.form.axes.len());
        let mut corners: Vec<Vec<Vec<i64>>> = orders.iter().map(|order| kuhn(order)).collect();
        self.partition.cells.iter().enumerate().filter_map(move |(number, cell)| {
            let own = std::mem::take(corners.get_mut(number)?);
            let state = |units: &Vec<i64>| self.form.state(units);
            let leaf = |answer, integers| {
                Some(TableCell { corners: own.iter().map(state).collect(), answer, integers })
            };
            match cell {
                PartitionCell::Cut { edge: [i, j], .. } => {
                    let middle = midpoint(&own[*i], &own[*j])?;
                    for replaced in [*j, *i] {
                        let mut half = own.clone();
                        half[replaced].clone_from(&middle);
                        corners.push(half);
                    }
                    None
                }
                PartitionCell::Open => leaf(LookupAnswer::Open, Vec::new()),
                PartitionCell::NoPlan(_) => leaf(LookupAnswer::NoPlan, Vec::new()),
                PartitionCell::Plan(law) => {
                    let first = law.plans.first().map(|plan| &**plan);
                    let Some(CornerRelaxation::Solved { x, .. }) = first else { return None };
                    let whole = x.iter().zip(&self.form.integral).filter(|(_, whole)| **whole);
                    let integers = whole.map(|(x, _)| *x).collect();
                    leaf(LookupAnswer::Plan { loss: law.loss }, integers)
                }
            }
        })
    }
}
