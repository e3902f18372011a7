//! The arrays of a look-up, and what is rounded in them.

use std::collections::HashMap;
use std::hash::Hash;

use carom_embedded::{LookupLeaf, LookupNode, LookupNumber, LookupProgram, LookupTable};
use carom_model::Error;
use carom_model::model::{Affine, Model};

use crate::build::CellLaw;
use crate::device_cells::{DeviceCell, DeviceCells};
use crate::followed_program::DeviceProgram;
use crate::form::ParametricForm;
use crate::relaxed::{CornerRelaxation, PLAN_TOLERANCE};

/// The arrays of a look-up in `f64` or `f32`, as they are written for devices.
#[derive(Debug, Clone, PartialEq)]
pub struct LookupArrays<T> {
    pub(crate) lower: Vec<T>,
    pub(crate) upper: Vec<T>,
    pub(crate) scale: Vec<T>,
    pub(crate) roots: Vec<u32>,
    pub(crate) nodes: Vec<LookupNode>,
    pub(crate) leaves: Vec<LookupLeaf<T>>,
    pub(crate) laws: Vec<u32>,
    pub(crate) values: Vec<T>,
    pub(crate) programs: Vec<LookupProgram<T>>,
    pub(crate) numbers: Vec<T>,
    pub(crate) inputs: usize,
    pub(crate) depth: u32,
    pub(crate) remarks: Vec<String>,
    pub(crate) state_rounding: Vec<f64>,
    pub(crate) input_rounding: f64,
    pub(crate) row_rounding: f64,
    /// The most that rounding in a program adds to the loss.
    pub(crate) loss_rounding: f64,
    /// The largest sum of magnitudes behind an input, and its number of terms and two more.
    largest: [f64; 2],
}

/// An input of a law, as an affine expression of the columns of a plan.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct LawOutput {
    pub(crate) offset: f64,
    pub(crate) terms: Vec<(usize, f64)>,
}

impl LawOutput {
    pub(crate) fn of(model: &Model, expression: Affine) -> Result<Self, Error> {
        let mut own = LawOutput { offset: expression.offset(), terms: Vec::new() };
        for (variable, a) in expression.terms() {
            own.terms.push((model.variable_ref(variable)?.id().index(), a));
        }
        Ok(own)
    }

    /// Its value, without a zero of its own sign.
    fn value(&self, x: &[f64]) -> f64 {
        let sum = self.terms.iter().fold(self.offset, |sum, &(j, a)| sum + a * x[j]);
        sum + 0.0
    }

    /// The sum of the magnitudes of its terms.
    fn size(&self, x: &[f64]) -> f64 {
        self.terms.iter().fold(self.offset.abs(), |sum, &(j, a)| sum + (a * x[j]).abs())
    }

    pub(crate) fn text(&self, form: &ParametricForm) -> String {
        match self.terms[..] {
            [(j, 1.0)] if self.offset == 0.0 => form.names[j].clone(),
            _ => {
                let terms = self.terms.iter().map(|&(j, a)| format!("{a} {}", form.names[j]));
                let terms = terms.chain((self.offset != 0.0).then(|| self.offset.to_string()));
                terms.collect::<Vec<_>>().join(" + ")
            }
        }
    }
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

/// The relative error of an operation.
const DOUBLE_UNIT: f64 = f64::EPSILON / 2.0;
pub(crate) const SINGLE_UNIT: f64 = f32::EPSILON as f64 / 2.0;

/// The relative error of a program's numbers, with 64 bits: equations are eliminated, and a Hessian
/// is divided by, which rounds more than one operation.
pub(crate) const CONDENSED_ROUNDING: f64 = 1e-12;

/// By how much the state of a look-up may differ from the one that was asked for, in units of the
/// box: rounding to whole units, four roundings of numbers up to all units, and what the lower end
/// and the scale of the device are off.
fn units_off(ends: [f64; 2], device: [f64; 3], units: f64, rounding: f64) -> f64 {
    let [lower, upper] = ends;
    let [own_lower, own_upper, own_scale] = device;
    let exact = |x: f64| (x - lower) * (units / (upper - lower));
    let off = |x: f64| ((x - own_lower) * own_scale - exact(x)).abs();
    let ends = off(own_lower.min(lower)).max(off(own_upper.max(upper)));
    0.5 + 4.0 * rounding * (1.0 + units) * (1.0 + 1e-6) + ends * (1.0 + 1e-6) + 1e-6
}

impl LookupArrays<f64> {
    pub(crate) fn new(
        form: &ParametricForm,
        device: &DeviceCells<'_>,
        outputs: &[LawOutput],
    ) -> Self {
        let side = |of: &[f64]| form.axes.iter().map(|&j| of[j]).collect::<Vec<f64>>();
        let (lower, upper) = (side(&form.lower), side(&form.upper));
        let widths = upper.iter().zip(&lower);
        let mut arrays = LookupArrays {
            scale: widths.map(|(u, l)| f64::from(f64::UNITS) / (u - l)).collect(),
            lower,
            upper,
            roots: Vec::new(),
            nodes: Vec::new(),
            leaves: Vec::new(),
            laws: Vec::new(),
            values: Vec::new(),
            programs: Vec::new(),
            numbers: Vec::new(),
            inputs: outputs.len(),
            depth: device.depth as u32,
            remarks: Vec::new(),
            state_rounding: Vec::new(),
            input_rounding: 0.0,
            row_rounding: 0.0,
            loss_rounding: 0.0,
            largest: [0.0; 2],
        };
        let mut values = Numbered { known: HashMap::new() };
        let mut laws = Numbered { known: HashMap::new() };
        let mut leaves = Numbered { known: HashMap::new() };
        let mut codes = Vec::with_capacity(device.cells.len());
        let mut cuts = 0;
        for cell in &device.cells {
            let leaf = match cell {
                DeviceCell::Cut { .. } => {
                    codes.push(cuts);
                    cuts += 1;
                    continue;
                }
                DeviceCell::Open => LookupLeaf::Open,
                DeviceCell::NoPlan => LookupLeaf::NoPlan,
                &DeviceCell::Solve { program, loss } => {
                    LookupLeaf::Solve { program: program as u32, loss }
                }
                DeviceCell::Law(law) => {
                    let law_number = arrays.add_law(law, outputs, &mut values, &mut laws);
                    LookupLeaf::Plan { law: law_number, loss: law.loss }
                }
            };
            let key = match leaf {
                LookupLeaf::Plan { law, loss } => (0, law, loss.to_bits()),
                LookupLeaf::Solve { program, loss } => (1, program, loss.to_bits()),
                LookupLeaf::NoPlan => (2, 0, 0),
                LookupLeaf::Open => (3, 0, 0),
            };
            let (number, is_new) = leaves.number(key);
            if is_new {
                arrays.leaves.push(leaf);
            }
            codes.push(number | LookupTable::<f64>::LEAF);
        }
        for cell in &device.cells {
            if let DeviceCell::Cut { edge, next } = cell {
                let edge = edge.map(|corner| corner as u8);
                arrays.nodes.push(LookupNode { edge, next: next.map(|number| codes[number]) });
            }
        }
        arrays.roots = codes[..device.orders].to_vec();
        arrays.add_programs(&device.programs);
        arrays.note_roundings(device);
        arrays
    }

    /// The number of a law.
    fn add_law(
        &mut self,
        law: &CellLaw,
        outputs: &[LawOutput],
        values: &mut Numbered<Vec<u64>>,
        laws: &mut Numbered<Vec<u32>>,
    ) -> u32 {
        let mut corners = Vec::with_capacity(law.plans.len());
        for plan in &law.plans {
            let CornerRelaxation::Solved { x, .. } = &**plan else { continue };
            let own: Vec<f64> = outputs.iter().map(|out| out.value(x)).collect();
            let bits: Vec<u64> = own.iter().map(|value| value.to_bits()).collect();
            let (number, is_new) = values.number(bits);
            if is_new {
                self.values.extend(own);
            }
            // Also of those with the same sum of other terms.
            outputs.iter().for_each(|output| self.measure(output, x));
            corners.push(number);
        }
        let (number, is_new) = laws.number(corners.clone());
        if is_new {
            self.laws.append(&mut corners);
        }
        number
    }

    fn add_programs(&mut self, programs: &[DeviceProgram]) {
        for program in programs {
            self.programs.push(LookupProgram {
                rows: program.rows as u32,
                first: self.numbers.len() as u32,
                exchanges: program.exchanges as u32,
                negative: program.negative,
                positive: program.positive,
            });
            self.numbers.extend(&program.numbers);
        }
    }

    fn note_roundings(&mut self, device: &DeviceCells<'_>) {
        let ends = self.lower.iter().zip(&self.upper).zip(&self.scale);
        let off = ends.map(|((&l, &u), &scale)| {
            let units = f64::from(f64::UNITS);
            units_off([l, u], [l, u, scale], units, DOUBLE_UNIT) * (u - l) / units
        });
        self.state_rounding = off.collect();
        self.input_rounding = self.largest_sum_error(DOUBLE_UNIT).max(device.errors.input);
        self.row_rounding = PLAN_TOLERANCE + device.errors.missed;
        self.loss_rounding = device.errors.loss;
    }

    /// The same in 32 bits.
    pub(crate) fn single(&self) -> LookupArrays<f32> {
        let narrow = |of: &[f64]| of.iter().map(|&value| value as f32).collect::<Vec<f32>>();
        let loss_above = |loss: f64| {
            let near = loss as f32;
            if f64::from(near) < loss { near.next_up() } else { near }
        };
        let leaf = |leaf: &LookupLeaf<f64>| match *leaf {
            LookupLeaf::Plan { law, loss } => LookupLeaf::Plan { law, loss: loss_above(loss) },
            LookupLeaf::Solve { program, loss } => {
                LookupLeaf::Solve { program, loss: loss_above(loss) }
            }
            LookupLeaf::NoPlan => LookupLeaf::NoPlan,
            LookupLeaf::Open => LookupLeaf::Open,
        };
        let program = |program: &LookupProgram<f64>| LookupProgram {
            rows: program.rows,
            first: program.first,
            exchanges: program.exchanges,
            negative: program.negative as f32,
            positive: program.positive as f32,
        };
        let (lower, upper) = (narrow(&self.lower), narrow(&self.upper));
        let units = f64::from(f32::UNITS);
        let widths = self.upper.iter().zip(&self.lower);
        let scale: Vec<f32> = widths.map(|(u, l)| (units / (u - l)) as f32).collect();
        let off = (0..lower.len()).map(|a| {
            let ends = [self.lower[a], self.upper[a]];
            let device = [lower[a], upper[a], scale[a]].map(f64::from);
            units_off(ends, device, units, SINGLE_UNIT) * (ends[1] - ends[0]) / units
        });
        LookupArrays {
            state_rounding: off.collect(),
            // That of the programs is the larger one, if they were made for 32 bits.
            input_rounding: self.largest_sum_error(SINGLE_UNIT).max(self.input_rounding),
            row_rounding: self.row_rounding,
            loss_rounding: self.loss_rounding,
            lower,
            upper,
            scale,
            roots: self.roots.clone(),
            nodes: self.nodes.clone(),
            leaves: self.leaves.iter().map(leaf).collect(),
            laws: self.laws.clone(),
            values: narrow(&self.values),
            programs: self.programs.iter().map(program).collect(),
            numbers: narrow(&self.numbers),
            inputs: self.inputs,
            depth: self.depth,
            remarks: self.remarks.clone(),
            largest: self.largest,
        }
    }

    /// Counts an input among the largest ones.
    fn measure(&mut self, output: &LawOutput, x: &[f64]) {
        let [size, terms] = &mut self.largest;
        *size = size.max(output.size(x));
        *terms = terms.max(output.terms.len() as f64 + 2.0);
    }

    /// The most by which an input may be off: where it is computed from a plan, where it is stored,
    /// in the product with each weight, and in each sum.
    fn largest_sum_error(&self, rounding: f64) -> f64 {
        let [size, terms] = self.largest;
        let corners = self.lower.len() as f64 + 1.0;
        ((corners + 3.0) * rounding + terms * DOUBLE_UNIT) * size * (1.0 + 1e-9)
    }
}

impl<T> LookupArrays<T> {
    /// The look-up.
    #[must_use]
    pub fn view(&self) -> LookupTable<'_, T> {
        LookupTable {
            lower: &self.lower,
            upper: &self.upper,
            scale: &self.scale,
            roots: &self.roots,
            nodes: &self.nodes,
            leaves: &self.leaves,
            laws: &self.laws,
            values: &self.values,
            programs: &self.programs,
            numbers: &self.numbers,
            inputs: self.inputs,
            depth: self.depth,
        }
    }

    /// The number of inputs that a look-up writes.
    #[must_use]
    pub fn inputs(&self) -> usize {
        self.inputs
    }

    /// By how much the state of a look-up may differ from the one that was asked for, an entry an
    /// axis, in its unit: the law is that of a state so near.
    #[must_use]
    pub fn state_rounding(&self) -> &[f64] {
        &self.state_rounding
    }

    /// By how much inputs may differ from those of the plan, in the unit of the largest one.
    #[must_use]
    pub fn input_rounding(&self) -> f64 {
        self.input_rounding
    }

    /// By how much the plan of a look-up misses rows, at most, in the unit of each.
    #[must_use]
    pub fn row_rounding(&self) -> f64 {
        self.row_rounding
    }

    /// The numbers of work space that programs take, see [`LookupTable::work`].
    #[must_use]
    pub fn work(&self) -> usize {
        self.view().work()
    }

    /// The memory that the arrays take as Rust constants, in bytes.
    #[must_use]
    pub fn bytes(&self) -> usize {
        let numbers = [&self.lower, &self.upper, &self.scale, &self.values, &self.numbers];
        let whole = [&self.roots, &self.laws];
        numbers.map(|of| size_of_val(&of[..])).iter().sum::<usize>()
            + whole.map(|of| size_of_val(&of[..])).iter().sum::<usize>()
            + size_of_val(&self.nodes[..])
            + size_of_val(&self.leaves[..])
            + size_of_val(&self.programs[..])
    }
}
