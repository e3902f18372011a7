//! The cones of a program at a node, and cuts of cones as rows of the reduced program.

use super::reduced::Reduced;
use crate::program::{Cone, ConeRole, ConeShape};

/// The place of a column that is fixed.
pub(crate) const FIXED: usize = usize::MAX;

/// A cone of a program over the free columns of a node and the values of the fixed ones.
#[derive(Debug, Clone)]
pub struct ReducedCone {
    /// The shape.
    pub shape: ConeShape,
    /// The part that it plays beside other cones.
    pub role: ConeRole,
    /// The entries: those of the head, then the tail.
    pub entries: Vec<ConeEntry>,
}

/// An entry of a cone at a node.
#[derive(Debug, Clone, Copy)]
pub struct ConeEntry {
    /// Its column in the program.
    pub column: usize,
    /// Its column in the reduced program, or `usize::MAX` if it is fixed.
    pub place: usize,
    /// Its value, if it is fixed.
    pub value: f64,
}

impl ConeEntry {
    /// Its value at a point of the reduced program.
    pub fn at(&self, x: &[f64]) -> f64 {
        if self.place == FIXED { self.value } else { x[self.place] }
    }

    /// Whether it is fixed.
    pub fn is_fixed(&self) -> bool {
        self.place == FIXED
    }
}

impl ReducedCone {
    pub(crate) fn new(cone: &Cone, position: &[usize], values: &[f64]) -> Self {
        let entry = |&column: &usize| {
            let place = position[column];
            ConeEntry { column, place, value: if place == FIXED { values[column] } else { 0.0 } }
        };
        let entries = cone.columns.iter().map(entry).collect();
        ReducedCone { shape: cone.shape, role: cone.role, entries }
    }

    /// The entries of the head.
    pub fn head(&self) -> &[ConeEntry] {
        &self.entries[..self.shape.head()]
    }

    /// The entries of the tail.
    pub fn tail(&self) -> &[ConeEntry] {
        &self.entries[self.shape.head()..]
    }

    /// By how much a point misses the cone, as [`Cone::miss`].
    pub fn miss(&self, x: &[f64]) -> f64 {
        self.length(x) - self.reach(x)
    }

    /// The value that the head allows: of a rotated cone, half the sum of its factors.
    pub fn reach(&self, x: &[f64]) -> f64 {
        let sum: f64 = self.head().iter().map(|entry| entry.at(x)).sum();
        if self.shape == ConeShape::Rotated { 0.5 * sum } else { sum }
    }

    /// The value that [`reach`](Self::reach) must have at least.
    fn length(&self, x: &[f64]) -> f64 {
        let largest = self.entries.iter().fold(0.0_f64, |most, entry| most.max(entry.at(x).abs()));
        if largest == 0.0 || !largest.is_finite() {
            return largest;
        }
        let scaled = |value: f64| (value / largest).powi(2);
        let tail: f64 = self.tail().iter().map(|entry| scaled(entry.at(x))).sum();
        let rest = match self.head() {
            [first, second] => scaled(0.5 * (first.at(x) - second.at(x))),
            _ => 0.0,
        };
        largest * (tail + rest).sqrt()
    }

    /// The terms of an entry of the cone as `|tail| <= head`: a rotated one is
    /// `|(first - second, 2 tail)| <= first + second`.
    pub fn conic_row(&self, entry: usize) -> impl Iterator<Item = (ConeEntry, f64)> {
        let e = &self.entries;
        let terms = match (self.shape, entry) {
            (ConeShape::Norm, _) => [Some((e[entry], 1.0)), None],
            (ConeShape::Rotated, 0) => [Some((e[0], 1.0)), Some((e[1], 1.0))],
            (ConeShape::Rotated, 1) => [Some((e[0], 1.0)), Some((e[1], -1.0))],
            (ConeShape::Rotated, _) => [Some((e[entry], 2.0)), None],
        };
        terms.into_iter().flatten()
    }

    /// Whether all entries are fixed.
    pub fn is_fixed(&self) -> bool {
        self.entries.iter().all(ConeEntry::is_fixed)
    }
}

impl Reduced {
    /// Appends the row `terms <= 0` over columns of the program, with the values of fixed ones.
    ///
    /// # Arguments
    ///
    /// * `place`: by column of the program, its column here; `usize::MAX` for fixed ones.
    /// * `name`: the name of the row (see [`origin`](Self::origin)).
    pub(crate) fn append_row(&mut self, terms: &[(usize, f64)], place: &[usize], name: usize) {
        let mut constant = crate::sum::Sum::default();
        let mut slack = 0.0;
        for &(column, a) in terms {
            match place[column] {
                FIXED => {
                    let value = self.values[column];
                    constant.add_product(a, value);
                    slack += a.abs() * (self.slack[column] + 8.0 * f64::EPSILON * value.abs());
                }
                k => {
                    self.rows.index.push(k);
                    self.rows.value.push(a);
                }
            }
        }
        self.rows.start.push(self.rows.index.len());
        self.row_lower.push(f64::NEG_INFINITY);
        self.row_upper.push(slack - constant.value());
        if self.origin.len() + 1 == self.rows.len() {
            self.origin.push(name);
        }
    }

    /// Drops all rows from one on.
    pub(crate) fn truncate_rows(&mut self, rows: usize) {
        if rows < self.rows.len() {
            self.rows.start.truncate(rows + 1);
            self.rows.index.truncate(self.rows.start[rows]);
            self.rows.value.truncate(self.rows.start[rows]);
            self.row_lower.truncate(rows);
            self.row_upper.truncate(rows);
            self.origin.truncate(rows);
        }
    }

    /// Drops the rows with certain names.
    pub(crate) fn drop_rows(&mut self, names: &std::ops::Range<usize>) {
        let (mut kept, mut end) = (0, 0);
        for row in 0..self.rows.len() {
            let entries = self.rows.start[row]..self.rows.start[row + 1];
            if self.origin.get(row).is_some_and(|name| names.contains(name)) {
                continue;
            }
            for entry in entries {
                self.rows.index[end] = self.rows.index[entry];
                self.rows.value[end] = self.rows.value[entry];
                end += 1;
            }
            (self.row_lower[kept], self.row_upper[kept]) =
                (self.row_lower[row], self.row_upper[row]);
            if row < self.origin.len() {
                self.origin[kept] = self.origin[row];
            }
            kept += 1;
            self.rows.start[kept] = end;
        }
        self.truncate_rows(kept);
    }

    /// By column of the program, its column here; `usize::MAX` for those that are not there.
    pub(crate) fn places(&self) -> Vec<usize> {
        let mut place = vec![FIXED; self.values.len()];
        self.columns.iter().enumerate().for_each(|(k, &j)| place[j] = k);
        place
    }

    /// Whether cones are to be solved as they are, and not through cuts.
    pub(crate) fn is_conic(&self) -> bool {
        !self.cones.is_empty() && !self.is_cut_off
    }
}
