//! Current bounds of all columns, with a trail to undo changes.

use crate::program::Program;

/// Bounds of all columns at a node. Changes are recorded, so that a node is left by undoing
/// exactly what was done inside it.
#[derive(Debug, Clone)]
pub struct Domain {
    /// Lower and upper bound side by side: propagation nearly always reads both.
    bounds: Vec<[f64; 2]>,
    trail: Vec<TrailEntry>,
    /// The smallest length of the trail since the last call of `undone_to`; `None` before the first
    /// call.
    shortest: Option<usize>,
}

/// One entry of the trail.
#[derive(Debug, Clone, Copy)]
struct TrailEntry {
    old: f64,
    /// Twice the column, plus one for an upper bound.
    bound: u32,
}

impl TrailEntry {
    fn column(&self) -> usize {
        self.bound as usize / 2
    }

    fn is_upper(&self) -> bool {
        self.bound % 2 == 1
    }
}

impl Domain {
    /// The bounds of a program.
    pub fn new(program: &Program) -> Self {
        let sides = program.lower.iter().zip(&program.upper);
        let bounds = sides.map(|(&lower, &upper)| [lower, upper]).collect();
        Domain { bounds, trail: Vec::new(), shortest: None }
    }

    /// Number of columns.
    pub fn column_count(&self) -> usize {
        self.bounds.len()
    }

    /// Lower bound of a column.
    pub fn lower(&self, column: usize) -> f64 {
        self.bounds[column][0]
    }

    /// Upper bound of a column.
    pub fn upper(&self, column: usize) -> f64 {
        self.bounds[column][1]
    }

    /// Lower and upper bound of a column.
    pub fn bounds(&self, column: usize) -> [f64; 2] {
        self.bounds[column]
    }

    /// Whether a column has one value left.
    pub fn is_fixed(&self, column: usize) -> bool {
        let [lower, upper] = self.bounds[column];
        lower == upper
    }

    /// Sets a lower bound, recording the old one.
    pub fn set_lower(&mut self, column: usize, value: f64) {
        self.apply(column, false, value);
    }

    /// Sets an upper bound, recording the old one.
    pub fn set_upper(&mut self, column: usize, value: f64) {
        self.apply(column, true, value);
    }

    /// Sets one bound, recording the old one.
    pub fn apply(&mut self, column: usize, is_upper: bool, value: f64) {
        let old = std::mem::replace(&mut self.bounds[column][usize::from(is_upper)], value);
        let bound = 2 * column as u32 + u32::from(is_upper);
        self.trail.push(TrailEntry { old, bound });
    }

    pub(super) fn all(&self) -> &[[f64; 2]] {
        &self.bounds
    }

    /// A mark to return to with [`undo_to`](Self::undo_to).
    pub fn mark(&self) -> usize {
        self.trail.len()
    }

    /// The columns changed since a mark, and whether it was the upper bound, in the order of the
    /// changes, repeats included.
    pub fn changed_since(&self, mark: usize) -> impl Iterator<Item = (usize, bool)> + '_ {
        self.trail[mark..].iter().map(|c| (c.column(), c.is_upper()))
    }

    /// The earliest mark to which changes were undone since the last call; `None` at the first
    /// call.
    pub(super) fn undone_to(&mut self) -> Option<usize> {
        self.shortest.replace(self.trail.len())
    }

    /// Undoes all changes since the mark.
    pub fn undo_to(&mut self, mark: usize) {
        self.shortest = self.shortest.map(|shortest| shortest.min(mark));
        for change in self.trail.drain(mark..).rev() {
            self.bounds[change.column()][usize::from(change.is_upper())] = change.old;
        }
    }
}
