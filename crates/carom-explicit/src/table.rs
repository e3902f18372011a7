//! The finished table.

use std::collections::HashMap;
use std::hash::Hash;

use carom_embedded::{Answer, LookupLeaf, LookupNode, LookupTable, Real};
use web_time::Duration;

use crate::build::{Partition, PartitionCell};
use crate::form::ParametricForm;
use crate::relaxed::CornerRelaxation;

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
    /// The relaxations that were solved.
    pub relaxations: u64,
    /// The time that the build took.
    pub duration: Duration,
}

/// A table of laws for a box of parameters, made by
/// [`ExplicitProgram::build`](crate::ExplicitProgram::build).
#[derive(Debug)]
pub struct ExplicitTable {
    pub(crate) form: ParametricForm,
    pub(crate) partition: Partition,
    pub(crate) outputs: Vec<usize>,
    /// The absolute and the relative loss that was asked for.
    pub(crate) goal: [f64; 2],
    pub(crate) report: TableReport,
    pub(crate) arrays: Arrays,
}

/// The arrays of a look-up table, in 64 bits.
#[derive(Debug, Clone, Default)]
pub(crate) struct Arrays {
    pub(crate) lower: Vec<f64>,
    pub(crate) upper: Vec<f64>,
    pub(crate) scale: Vec<f64>,
    pub(crate) roots: Vec<u32>,
    pub(crate) nodes: Vec<LookupNode>,
    pub(crate) leaves: Vec<LookupLeaf<f64>>,
    pub(crate) laws: Vec<u32>,
    pub(crate) values: Vec<f64>,
    pub(crate) inputs: usize,
    pub(crate) depth: u32,
}

/// Numbers things that are the same alike.
struct Numbered<K> {
    known: HashMap<K, u32>,
}

impl<K: Hash + Eq> Numbered<K> {
    /// The number of a thing, and whether it is new.
    fn number(&mut self, thing: K) -> (u32, bool) {
        let next = self.known.len() as u32;
        let number = *self.known.entry(thing).or_insert(next);
        (number, number == next)
    }
}

impl Arrays {
    pub(crate) fn new(form: &ParametricForm, partition: &Partition, outputs: &[usize]) -> Self {
        let side = |of: &[f64]| form.axes.iter().map(|&j| of[j]).collect::<Vec<f64>>();
        let mut arrays = Arrays {
            lower: side(&form.lower),
            upper: side(&form.upper),
            inputs: outputs.len(),
            depth: partition.depth as u32,
            ..Arrays::default()
        };
        let widths = arrays.upper.iter().zip(&arrays.lower);
        arrays.scale = widths.map(|(u, l)| f64::from(f64::UNITS) / (u - l)).collect();
        let mut values = Numbered { known: HashMap::new() };
        let mut laws = Numbered { known: HashMap::new() };
        let mut leaves = Numbered { known: HashMap::new() };
        let mut codes = Vec::with_capacity(partition.cells.len());
        let mut cuts = 0;
        for cell in &partition.cells {
            let leaf = match cell {
                PartitionCell::Cut { .. } => {
                    codes.push(cuts);
                    cuts += 1;
                    continue;
                }
                PartitionCell::Open => LookupLeaf::Open,
                PartitionCell::NoPlan(_) => LookupLeaf::NoPlan,
                PartitionCell::Plan(law) => {
                    let mut corners = Vec::with_capacity(law.plans.len());
                    for plan in &law.plans {
                        let CornerRelaxation::Solved { x, .. } = &**plan else { continue };
                        let bits = outputs.iter().map(|&j| (x[j] + 0.0).to_bits());
                        let (number, is_new) = values.number(bits.collect::<Vec<u64>>());
                        if is_new {
                            arrays.values.extend(outputs.iter().map(|&j| x[j] + 0.0));
                        }
                        corners.push(number);
                    }
                    let (number, is_new) = laws.number(corners.clone());
                    if is_new {
                        arrays.laws.append(&mut corners);
                    }
                    LookupLeaf::Plan { law: number, loss: law.loss }
                }
            };
            let key = match leaf {
                LookupLeaf::Plan { law, loss } => (law, loss.to_bits()),
                LookupLeaf::NoPlan => (u32::MAX, 0),
                LookupLeaf::Open => (u32::MAX, 1),
            };
            let (number, is_new) = leaves.number(key);
            if is_new {
                arrays.leaves.push(leaf);
            }
            codes.push(number | LookupTable::<f64>::LEAF);
        }
        for cell in &partition.cells {
            if let PartitionCell::Cut { edge, next } = cell {
                let edge = edge.map(|corner| corner as u8);
                arrays.nodes.push(LookupNode { edge, next: next.map(|number| codes[number]) });
            }
        }
        arrays.roots = codes[..partition.orders].to_vec();
        arrays
    }

    fn view(&self) -> LookupTable<'_, f64> {
        LookupTable {
            lower: &self.lower,
            upper: &self.upper,
            scale: &self.scale,
            roots: &self.roots,
            nodes: &self.nodes,
            leaves: &self.leaves,
            laws: &self.laws,
            values: &self.values,
            inputs: self.inputs,
            depth: self.depth,
        }
    }
}

impl ExplicitTable {
    /// The size of the table, and what is proved of it.
    #[must_use]
    pub fn report(&self) -> &TableReport {
        &self.report
    }

    /// The look-up as a device has it, in 64 bits.
    #[must_use]
    pub fn lookup(&self) -> LookupTable<'_, f64> {
        self.arrays.view()
    }

    /// Looks up the inputs of a state.
    ///
    /// # Arguments
    ///
    /// * `state`: an entry for each axis, in its unit.
    ///
    /// Returns the answer and the inputs, which are zeros if the answer has none.
    pub fn evaluate(&self, state: &[f64]) -> (Answer<f64>, Vec<f64>) {
        let mut inputs = vec![0.0; self.arrays.inputs];
        let answer = self.arrays.view().evaluate(state, &mut inputs);
        (answer, inputs)
    }
}
