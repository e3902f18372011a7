//! The cones of the program in even units: `G x + h` lies in second-order cones `|tail| <= head`.

use crate::presolve::Compressed;
use crate::relaxation::conic_form::ConeRows;

/// The cones, with the entries of one after the other.
#[derive(Debug, Default)]
pub(super) struct ScaledCones {
    /// By cone, its first entry; one more number than cones.
    first: Vec<usize>,
    /// `G`, by entry.
    pub(super) rows: Compressed,
    /// `h`, by entry.
    pub(super) constant: Vec<f64>,
    /// By cone, the factor of its entries.
    factor: Vec<f64>,
    /// By entry, its number among the entries of the program.
    names: Vec<usize>,
}

impl ScaledCones {
    /// Becomes the cones of a program whose columns have these units, in the memory that it has.
    pub(super) fn load(&mut self, cones: &ConeRows, column: &[f64]) {
        self.first.clone_from(&cones.first);
        self.rows.copy_from(&cones.rows);
        self.constant.clone_from(&cones.constant);
        self.names.clone_from(&cones.names);
        self.factor.clear();
        for cone in 0..cones.len() {
            let entries = self.entries(cone);
            let terms = self.rows.start[entries.start]..self.rows.start[entries.end];
            for k in terms.clone() {
                self.rows.value[k] *= column[self.rows.index[k]];
            }
            let sizes = self.rows.value[terms.clone()].iter().map(|g| g.abs());
            let largest = sizes.fold(0.0, f64::max);
            let unit = if largest > 0.0 { 1.0 / largest } else { 1.0 };
            self.rows.value[terms].iter_mut().for_each(|g| *g *= unit);
            self.constant[entries].iter_mut().for_each(|h| *h *= unit);
            self.factor.push(unit);
        }
    }

    /// The number of cones.
    pub(super) fn len(&self) -> usize {
        self.factor.len()
    }

    /// The number of entries.
    pub(super) fn entry_count(&self) -> usize {
        self.constant.len()
    }

    /// The entries of a cone.
    pub(super) fn entries(&self, cone: usize) -> std::ops::Range<usize> {
        self.first[cone]..self.first[cone + 1]
    }

    /// By entry, its number among the entries of the program.
    pub(super) fn names(&self) -> impl Iterator<Item = usize> {
        self.names.iter().copied()
    }

    /// `G x`.
    pub(super) fn activities(&self, x: &[f64], out: &mut [f64]) {
        for (e, activity) in out.iter_mut().enumerate() {
            let (index, value) = self.rows.vector(e);
            *activity = index.iter().zip(value).map(|(&j, g)| g * x[j]).sum();
        }
    }

    /// Subtracts `G'z` from `out`.
    pub(super) fn subtract_transposed(&self, z: &[f64], out: &mut [f64]) {
        for (e, &z) in z.iter().enumerate() {
            let (index, value) = self.rows.vector(e);
            index.iter().zip(value).for_each(|(&j, g)| out[j] -= g * z);
        }
    }

    /// Multipliers of all entries in units of the objective by that of the program's rows.
    pub(super) fn multipliers(&self, z: &[f64], objective: f64) -> Vec<f64> {
        let of = |cone: usize| z[self.entries(cone)].iter().map(move |z| z * self.factor[cone]);
        (0..self.len()).flat_map(|cone| of(cone).map(|z| z / objective)).collect()
    }
}
