//! The cells as a device has them: all of those of the partition, each with an explicit law; or
//! fewer, whose integers a quadratic program takes, so that neighbours with the same program are
//! one cell.

use std::collections::{BTreeMap, HashMap, VecDeque};

use crate::arrays::LawOutput;
use crate::build::{CellLaw, PartitionCell, plans_cost};
use crate::followed_program::{
    DeviceProgram, FollowedCell, FollowedProgram, ShareCorners, SolveErrors,
};
use crate::form::ParametricForm;
use crate::partition::Partition;
use crate::relaxed::CornerRelaxation;
use crate::simplex_cell::{BOX_UNITS, kuhn, midpoint, orders};

/// A cell of a device.
#[derive(Debug, Clone, Copy)]
pub(crate) enum DeviceCell<'a> {
    Cut { edge: [usize; 2], next: [usize; 2] },
    Law(&'a CellLaw),
    Solve { program: usize, loss: f64 },
    NoPlan,
    Open,
}

/// The cells of the partition that solve a program, with the same integers.
#[derive(Debug)]
pub(crate) struct SolvedGroup {
    pub(crate) program: usize,
    /// Cells, and by how much the cost of the device is above that of their explicit laws, at most.
    pub(crate) cells: Vec<(usize, f64)>,
    /// The columns as functions of the program, see `FollowedProgram`.
    pub(crate) columns: Vec<f64>,
    pub(crate) errors: SolveErrors,
}

/// The cells of a device, those of the orders of the axes first, and the programs that they name.
#[derive(Debug)]
pub(crate) struct DeviceCells<'a> {
    pub(crate) cells: Vec<DeviceCell<'a>>,
    pub(crate) orders: usize,
    pub(crate) depth: usize,
    pub(crate) programs: Vec<DeviceProgram>,
    pub(crate) solved: Vec<SolvedGroup>,
    /// The largest of all programs.
    pub(crate) errors: SolveErrors,
}

/// The bytes of a leaf with an explicit law, and of a program beside its numbers.
const LEAF_BYTES: usize = 12;
const PROGRAM_BYTES: usize = 20;

/// The part added to the cost of a device, relative to the largest one in a cell, because it is
/// computed in floats.
const EXCESS_ROOM: f64 = 1e-7;

impl<'a> DeviceCells<'a> {
    /// Those of a partition.
    pub(crate) fn explicit(partition: &'a Partition) -> Self {
        let own = |cell: &'a PartitionCell| match cell {
            &PartitionCell::Cut { edge, next } => DeviceCell::Cut { edge, next },
            PartitionCell::Plan(law) => DeviceCell::Law(law),
            PartitionCell::NoPlan(_) => DeviceCell::NoPlan,
            PartitionCell::Open => DeviceCell::Open,
        };
        DeviceCells {
            cells: partition.cells.iter().map(own).collect(),
            orders: partition.orders,
            depth: partition.depth,
            programs: Vec::new(),
            solved: Vec::new(),
            errors: SolveErrors::default(),
        }
    }

    /// Those with programs where that takes fewer bytes, for numbers of so many bytes and so large
    /// roundings.
    pub(crate) fn solving(
        form: &ParametricForm,
        partition: &'a Partition,
        outputs: &[LawOutput],
        (bytes, unit): (usize, f64),
    ) -> Self {
        let mut own = Self::explicit(partition);
        let corners = corner_shares(form, partition);
        let mut groups: BTreeMap<Vec<i64>, Vec<usize>> = BTreeMap::new();
        for (number, cell) in partition.cells.iter().enumerate() {
            if let Some(x) = first_plan(cell) {
                let whole = x.iter().zip(&form.integral).filter(|(_, whole)| **whole);
                groups.entry(whole.map(|(x, _)| *x as i64).collect()).or_default().push(number);
            }
        }
        let mut known: HashMap<Vec<u64>, usize> = HashMap::new();
        for numbers in groups.values() {
            let Some(x) = numbers.first().and_then(|&number| first_plan(&partition.cells[number]))
            else {
                continue;
            };
            let followed = |&number: &usize| {
                let PartitionCell::Plan(law) = &partition.cells[number] else { return None };
                let cost = plans_cost(form, &law.plans);
                Some(FollowedCell { corners: corners[number].clone(), cost })
            };
            let cells: Vec<FollowedCell> = numbers.iter().filter_map(followed).collect();
            let found = FollowedProgram::new(form, outputs, x, &cells, unit);
            let Some(FollowedProgram { program, columns, excess, errors }) = found else {
                continue;
            };
            let count = excess.iter().flatten().count();
            let size = PROGRAM_BYTES + bytes * program.numbers.len();
            let key = program_bits(&program, bytes);
            let is_new = !known.contains_key(&key);
            if count == 0 || (is_new && size > count * (LEAF_BYTES + 4 * (form.axes.len() + 1))) {
                continue;
            }
            let number = *known.entry(key).or_insert(own.programs.len());
            match own.programs.get_mut(number) {
                Some(same) => same.exchanges = same.exchanges.max(program.exchanges),
                None => own.programs.push(program),
            }
            own.errors = own.errors.largest(errors);
            let mut group = SolvedGroup { program: number, cells: Vec::new(), columns, errors };
            for ((&cell, excess), FollowedCell { cost: cell_cost, .. }) in
                numbers.iter().zip(excess).zip(&cells)
            {
                let PartitionCell::Plan(law) = &partition.cells[cell] else { continue };
                let Some(excess) = excess else { continue };
                let largest = cell_cost.iter().fold(1.0_f64, |most, cost| most.max(cost.abs()));
                let excess = excess + errors.loss + EXCESS_ROOM * largest;
                own.cells[cell] = DeviceCell::Solve { program: number, loss: law.loss + excess };
                group.cells.push((cell, excess));
            }
            own.solved.push(group);
        }
        own.join();
        own
    }

    /// Joins halves that solve the same program, or have no answer for the same reason. Losses
    /// become the largest one of the program, of those that are proved.
    fn join(&mut self) {
        let mut losses: HashMap<usize, f64> = HashMap::new();
        for cell in &self.cells {
            if let &DeviceCell::Solve { program, loss } = cell
                && loss.is_finite()
            {
                let most = losses.entry(program).or_insert(0.0);
                *most = most.max(loss);
            }
        }
        for number in (0..self.cells.len()).rev() {
            match self.cells[number] {
                DeviceCell::Cut { next: [a, b], .. } => {
                    let is_one = match (self.cells[a], self.cells[b]) {
                        (
                            DeviceCell::Solve { program: a, loss: first },
                            DeviceCell::Solve { program: b, loss: second },
                        ) => a == b && first.is_finite() == second.is_finite(),
                        (DeviceCell::NoPlan, DeviceCell::NoPlan)
                        | (DeviceCell::Open, DeviceCell::Open) => true,
                        _ => false,
                    };
                    if is_one {
                        self.cells[number] = self.cells[a];
                    }
                }
                DeviceCell::Solve { program, loss } if loss.is_finite() => {
                    let loss = losses.get(&program).copied().unwrap_or(loss);
                    self.cells[number] = DeviceCell::Solve { program, loss };
                }
                _ => {}
            }
        }
        self.sort();
    }

    /// Leaves out what is not reached, and puts the rest in order, level by level.
    fn sort(&mut self) {
        let mut sorted = Vec::new();
        let mut queue: VecDeque<(usize, usize)> = (0..self.orders).map(|root| (root, 0)).collect();
        let (mut next, mut most) = (self.orders, 0);
        while let Some((number, depth)) = queue.pop_front() {
            most = most.max(depth);
            match self.cells[number] {
                DeviceCell::Cut { edge, next: halves } => {
                    queue.extend(halves.map(|half| (half, depth + 1)));
                    sorted.push(DeviceCell::Cut { edge, next: [next, next + 1] });
                    next += 2;
                }
                leaf => sorted.push(leaf),
            }
        }
        (self.cells, self.depth) = (sorted, most);
    }
}

impl SolveErrors {
    fn largest(self, other: SolveErrors) -> Self {
        SolveErrors {
            missed: self.missed.max(other.missed),
            loss: self.loss.max(other.loss),
            input: self.input.max(other.input),
        }
    }
}

/// The plan of a cell's first corner.
fn first_plan(cell: &PartitionCell) -> Option<&[f64]> {
    let PartitionCell::Plan(law) = cell else { return None };
    match &**law.plans.first()? {
        CornerRelaxation::Solved { x, .. } => Some(x),
        _ => None,
    }
}

/// The bits of the numbers of a program, as a device has them, without the most exchanges.
fn program_bits(program: &DeviceProgram, bytes: usize) -> Vec<u64> {
    let bits = |value: f64| match bytes {
        4 => u64::from((value as f32 + 0.0).to_bits()),
        _ => (value + 0.0).to_bits(),
    };
    let ends = [program.rows as f64, program.negative, program.positive];
    ends.iter().chain(&program.numbers).map(|&value| bits(value)).collect()
}

/// The corners of all cells, as shares of the sides of the box.
fn corner_shares(form: &ParametricForm, partition: &Partition) -> Vec<ShareCorners> {
    let mut units: Vec<Vec<Vec<i64>>> =
        orders(form.axes.len()).iter().map(|order| kuhn(order)).collect();
    for (number, cell) in partition.cells.iter().enumerate() {
        let PartitionCell::Cut { edge: [i, j], .. } = cell else { continue };
        let own = units[number].clone();
        let Some(middle) = midpoint(&own[*i], &own[*j]) else { continue };
        for replaced in [*j, *i] {
            let mut half = own.clone();
            half[replaced].clone_from(&middle);
            units.push(half);
        }
    }
    let share = |units: &i64| *units as f64 / BOX_UNITS as f64;
    let corner = |units: &Vec<i64>| units.iter().map(share).collect::<Vec<f64>>();
    units.iter().map(|corners| corners.iter().map(corner).collect()).collect()
}
