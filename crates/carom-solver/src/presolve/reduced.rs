//! A continuous program over the free columns of a node, in compressed form.

use super::reduced_cone::ReducedCone;
use crate::program::Program;

/// A convex quadratic program `min 1/2 x'Px + q'x + offset` over rows and a box, in compressed
/// form, over the free columns of a node.
#[derive(Debug, Clone, Default)]
pub struct Reduced {
    /// Program column of each reduced column.
    pub columns: Vec<usize>,
    /// Values of all program columns; those of the kept columns are placeholders.
    pub values: Vec<f64>,
    /// By how much each program column may differ from its value, if it is fixed in the middle of
    /// narrow bounds; 0 for the others.
    pub slack: Vec<f64>,
    /// Upper triangle of `P` by columns: starts, row indices, values.
    pub quadratic: Compressed,
    /// `q`.
    pub linear: Vec<f64>,
    /// The constant of the objective.
    pub offset: f64,
    /// Rows: starts, column indices, values.
    pub rows: Compressed,
    /// The program's row behind each row, `usize::MAX` for rows of other origins: a name by which
    /// the same row is known at other nodes. Empty if it is not needed.
    pub origin: Vec<usize>,
    /// Parallel rows that were merged: the row that was kept, the program's row that is not there,
    /// and that row as a multiple of the kept one.
    pub merged: Vec<(usize, usize, f64)>,
    /// Lower limits of the rows.
    pub row_lower: Vec<f64>,
    /// Upper limits of the rows.
    pub row_upper: Vec<f64>,
    /// Lower bounds of the columns.
    pub lower: Vec<f64>,
    /// Upper bounds of the columns.
    pub upper: Vec<f64>,
    /// By column, a lower bound on the curvature of the objective along it, for any values of the
    /// others (see `Program::steepness`); empty if none is known, or if all columns with curvature
    /// have bounds.
    pub steepness: Vec<f64>,
    /// The cones with a free column, and those that fixed columns may miss; without those that the
    /// bounds of their entries say.
    pub cones: Vec<ReducedCone>,
    /// Whether cones are cut off (see [`Program::cone_cuts`](crate::program::Program)).
    pub is_cut_off: bool,
    /// Whether a vertex is wanted, with multipliers that are as exact as its basis.
    pub wants_vertex: bool,
    /// As in the program; less than 1 counts as 1.
    pub spread: f64,
}

/// Compressed vectors (columns or rows) of a sparse matrix.
#[derive(Debug, Clone, Default)]
pub struct Compressed {
    /// Start of each vector in `index` and `value`; one more entry than vectors.
    pub start: Vec<usize>,
    /// Positions of the entries inside their vector.
    pub index: Vec<usize>,
    /// The entries.
    pub value: Vec<f64>,
}

impl Compressed {
    /// Number of vectors.
    pub fn len(&self) -> usize {
        self.start.len().saturating_sub(1)
    }

    /// Whether there is no vector.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Drops all vectors, and has memory for so many vectors and entries.
    pub(crate) fn clear(&mut self, vectors: usize, entries: usize) {
        self.start.clear();
        self.start.reserve(vectors + 1);
        self.start.push(0);
        self.index.clear();
        self.index.reserve(entries);
        self.value.clear();
        self.value.reserve(entries);
    }

    /// Becomes a copy of another one, in the memory that it has.
    pub(crate) fn copy_from(&mut self, other: &Compressed) {
        self.start.clone_from(&other.start);
        self.index.clone_from(&other.index);
        self.value.clone_from(&other.value);
    }

    /// No vectors yet, with memory for so many, and for their entries.
    pub(crate) fn with_capacity(vectors: usize, entries: usize) -> Self {
        let mut none = Compressed::default();
        none.clear(vectors, entries);
        none
    }

    /// Appends a vector.
    pub(crate) fn push(&mut self, entries: impl Iterator<Item = (usize, f64)>) {
        for (k, a) in entries {
            self.index.push(k);
            self.value.push(a);
        }
        self.start.push(self.index.len());
    }

    /// Pairs of position and entry of a vector.
    pub(crate) fn entries(&self, k: usize) -> impl ExactSizeIterator<Item = (usize, f64)> {
        let range = self.start[k]..self.start[k + 1];
        self.index[range.clone()].iter().copied().zip(self.value[range].iter().copied())
    }

    /// The transposed matrix: one vector for each position.
    pub(crate) fn transposed(&self, positions: usize) -> Compressed {
        let mut start = vec![0; positions + 1];
        self.index.iter().for_each(|&k| start[k + 1] += 1);
        (0..positions).for_each(|k| start[k + 1] += start[k]);
        let mut next = start.clone();
        let (mut index, mut value) = (vec![0; self.index.len()], vec![0.0; self.index.len()]);
        for vector in 0..self.len() {
            for (k, a) in self.entries(vector) {
                (index[next[k]], value[next[k]]) = (vector, a);
                next[k] += 1;
            }
        }
        Compressed { start, index, value }
    }

    /// Positions and entries of a vector.
    pub fn vector(&self, k: usize) -> (&[usize], &[f64]) {
        let range = self.start[k]..self.start[k + 1];
        (&self.index[range.clone()], &self.value[range])
    }
}

impl Reduced {
    /// All columns and rows of a program, integrality aside.
    pub fn whole(program: &Program) -> Reduced {
        let n = program.column_count();
        let vectors = |starts: &[usize], index: &[usize], value: &[f64]| Compressed {
            start: starts.to_vec(),
            index: index.to_vec(),
            value: value.to_vec(),
        };
        let mut quadratic = Compressed { start: vec![0], ..Compressed::default() };
        for j in 0..n {
            let (rows, values) = program.quadratic_column(j);
            for (&i, &p) in rows.iter().zip(values).filter(|(i, _)| **i <= j) {
                quadratic.index.push(i);
                quadratic.value.push(p);
            }
            quadratic.start.push(quadratic.index.len());
        }
        let rows = program.rows.symbolic();
        Reduced {
            columns: (0..n).collect(),
            values: program.lower.clone(),
            slack: vec![0.0; n],
            quadratic,
            linear: program.linear.clone(),
            offset: program.offset,
            rows: vectors(rows.row_ptr(), rows.col_idx(), program.rows.val()),
            origin: (0..program.row_count()).collect(),
            merged: Vec::new(),
            row_lower: program.row_lower.clone(),
            row_upper: program.row_upper.clone(),
            lower: program.lower.clone(),
            upper: program.upper.clone(),
            steepness: Vec::new(),
            cones: {
                let place: Vec<usize> = (0..n).collect();
                let cones = program.cones.iter();
                cones.map(|cone| ReducedCone::new(cone, &place, &program.lower)).collect()
            },
            is_cut_off: program.cone_cuts.is_some(),
            wants_vertex: false,
            spread: program.spread,
        }
    }

    /// Looks up how steep the objective is, if a column with curvature lacks a bound.
    pub(crate) fn find_steepness(&mut self, program: &Program) {
        self.steepness.clear();
        let is_open = |k: usize| {
            let curved = !self.quadratic.vector(k).0.is_empty();
            curved && (self.lower[k].is_infinite() || self.upper[k].is_infinite())
        };
        if (0..self.columns.len()).any(is_open) {
            let steepness = program.steepness();
            self.steepness.extend(self.columns.iter().map(|&j| steepness[j]));
        }
    }

    /// Whether the objective is constant.
    pub fn is_feasibility_problem(&self) -> bool {
        self.quadratic.index.is_empty() && self.linear.iter().all(|&q| q == 0.0)
    }

    /// Objective at a reduced point, the constant included.
    pub fn objective(&self, x: &[f64]) -> f64 {
        let mut value = self.offset;
        for j in 0..x.len() {
            let (rows, entries) = self.quadratic.vector(j);
            let product: f64 = rows
                .iter()
                .zip(entries)
                .map(|(&i, p)| if i == j { 0.5 * p * x[i] } else { p * x[i] })
                .sum();
            value += x[j] * (self.linear[j] + product);
        }
        value
    }

    /// Whether a column of the program is kept.
    pub(crate) fn keeps(&self, column: usize) -> bool {
        self.columns.binary_search(&column).is_ok()
    }

    /// The program's point that belongs to a reduced point.
    pub fn lift(&self, x: &[f64]) -> Vec<f64> {
        let mut values = self.values.clone();
        self.columns.iter().zip(x).for_each(|(&j, &v)| values[j] = v);
        values
    }
}

/// Makes a vector so many times a value, in the memory that it has.
pub(crate) fn refill<T: Copy>(vector: &mut Vec<T>, length: usize, value: T) {
    vector.clear();
    vector.resize(length, value);
}
