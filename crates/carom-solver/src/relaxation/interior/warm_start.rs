//! Starts of the interior-point method from an iterate of the parent.
//!
//! An iterate at the optimum is a bad start, because it is close to limits that no longer hold at
//! the child. What a relaxation leaves is an iterate on the way there, and the child moves it well
//! inside.

use super::iterate::Iterate;
use super::parameters::{MIN_KEPT_COMPLEMENTARITY, MIN_START_COMPLEMENTARITY, MIN_START_DISTANCE};
use super::scaled::{OneSidedLimit, ScaledProgram};
use crate::presolve::{Reduced, refill};

/// The last iterate whose complementarity was not yet small.
#[derive(Debug, Default)]
pub(super) struct KeptIterate {
    x: Vec<f64>,
    multipliers: Vec<f64>,
    dual: Vec<f64>,
}

impl KeptIterate {
    /// Forgets the iterate, not its memory.
    pub(super) fn clear(&mut self) {
        self.x.clear();
    }

    /// Keeps an iterate as long as it is not too far.
    pub(super) fn update(&mut self, at: &Iterate) {
        if self.x.is_empty() || at.barrier >= MIN_KEPT_COMPLEMENTARITY * at.dual.len() as f64 {
            self.x.clone_from(&at.x);
            self.multipliers.clone_from(&at.multipliers);
            self.dual.clone_from(&at.dual);
        }
    }

    /// Writes the iterate as the children can read it.
    pub(super) fn write(
        &self,
        program: &Reduced,
        scaled: &ScaledProgram,
        state: &mut ParentIterate,
    ) {
        let ParentIterate { columns, rows } = state;
        columns.name(&program.columns, scaled.column.len());
        rows.name(&program.origin, scaled.row.len());
        for (j, (x, unit)) in self.x.iter().zip(&scaled.column).enumerate() {
            columns.set(j, 0, x * unit);
        }
        for (side, z) in scaled.sides.iter().zip(&self.dual).skip(scaled.row_sides) {
            columns.set(side.of, place(side), z / (scaled.column[side.of] * scaled.objective));
        }
        for (side, z) in scaled.split_sides().0.iter().zip(&self.dual) {
            rows.set(side.of, place(side), z * scaled.row[side.of] / scaled.objective);
        }
        for &(i, _) in &scaled.equalities {
            rows.set(i, 0, self.multipliers[i] * scaled.row[i] / scaled.objective);
        }
    }
}

/// An iterate in the units of the program, by its columns and rows before it was reduced.
#[derive(Debug, Default)]
pub(super) struct ParentIterate {
    /// The value, and the multipliers of the lower and the upper bound.
    columns: ValuesByName,
    /// The multiplier of an equality, or those of the lower and the upper limit.
    rows: ValuesByName,
}

/// Where a side's multiplier is.
fn place(side: &OneSidedLimit) -> usize {
    if side.sign > 0.0 { 1 } else { 2 }
}

/// Three numbers for each of some columns or rows.
#[derive(Debug, Default)]
struct ValuesByName {
    /// With the name of each; `usize::MAX` for those that have none.
    values: Vec<(usize, [f64; 3])>,
}

impl ValuesByName {
    /// Becomes so many zeros; those beyond the names have none.
    fn name(&mut self, names: &[usize], count: usize) {
        let name = |k: usize| names.get(k).copied().unwrap_or(usize::MAX);
        self.values.clear();
        self.values.extend((0..count).map(|k| (name(k), [0.0; 3])));
    }

    fn set(&mut self, k: usize, place: usize, value: f64) {
        self.values[k].1[place] = value;
    }

    /// Writes the numbers under so many other names, where they are known.
    fn write_under(&self, names: &[usize], count: usize, found: &mut ResumedValues) {
        let ResumedValues { by_name, known } = found;
        let named = || self.values.iter().filter(|(name, _)| *name != usize::MAX);
        let most = named().map(|(name, _)| name + 1).max().unwrap_or(0);
        refill(by_name, most, None);
        named().for_each(|&(name, values)| by_name[name] = Some(values));
        known.clear();
        known.extend((0..count).map(|k| by_name.get(*names.get(k)?).copied().flatten()));
    }
}

/// Memory for what is known of columns and rows.
#[derive(Debug, Default)]
pub(super) struct Resumed {
    columns: ResumedValues,
    rows: ResumedValues,
}

/// Numbers by the names of a parent, and in the order of a child.
#[derive(Debug, Default)]
struct ResumedValues {
    by_name: Vec<Option<[f64; 3]>>,
    known: Vec<Option<[f64; 3]>>,
}

impl Iterate {
    /// Goes to an iterate of the parent, moved inside.
    pub(super) fn resume(
        &mut self,
        program: &Reduced,
        scaled: &ScaledProgram,
        parent: &ParentIterate,
        resumed: &mut Resumed,
    ) {
        let Resumed { columns, rows } = resumed;
        parent.columns.write_under(&program.columns, scaled.column.len(), columns);
        parent.rows.write_under(&program.origin, scaled.row.len(), rows);
        let (columns, rows) = (&columns.known, &rows.known);
        for (j, known) in columns.iter().enumerate() {
            if let Some([x, ..]) = known {
                let (lower, upper) = (scaled.lower[j], scaled.upper[j]);
                let room = (0.5 * (upper - lower)).min(MIN_START_DISTANCE);
                self.x[j] = (x / scaled.column[j]).max(lower + room).min(upper - room);
            }
        }
        scaled.activities(&self.x, &mut self.activity);
        for (k, side) in scaled.sides.iter().enumerate() {
            let of_row = k < scaled.row_sides;
            let (values, known) = if of_row { (&self.activity, rows) } else { (&self.x, columns) };
            let unit = if of_row { 1.0 / scaled.row[side.of] } else { scaled.column[side.of] };
            let least = if of_row { MIN_START_DISTANCE } else { 1e-10 };
            let z = known[side.of].map_or(0.0, |known| known[place(side)]);
            self.slack[k] = (side.sign * (values[side.of] - side.limit)).max(least);
            self.dual[k] =
                (z * unit * scaled.objective).max(MIN_START_COMPLEMENTARITY / self.slack[k]);
        }
        for &(i, _) in &scaled.equalities {
            let y = rows[i].map_or(0.0, |known| known[0]);
            self.multipliers[i] = y / scaled.row[i] * scaled.objective;
        }
    }
}
