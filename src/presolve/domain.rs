//! Current bounds of all columns, with a trail to undo changes, and the reason of each.

use crate::program::Program;

/// Why a bound changed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reason {
    /// Decided, or known from elsewhere: no row explains it.
    Given,
    /// It follows from all that was given before, in a way that was not kept.
    Path,
    /// Propagation of a row; the number of rows stands for the objective's limit.
    Row(u32),
    /// The table of implications, for this binary is fixed.
    Implied(u32),
    /// The no-good of this number: all its other literals hold.
    NoGood(u32),
    /// Bounds that had crossed by a hair were brought together; this loosens them.
    Settled,
}

/// Bounds of all columns at a node. Changes are recorded, so that a node is left by undoing
/// exactly what was done inside it.
#[derive(Debug, Clone)]
pub struct Domain {
    /// Lower and upper bound side by side: propagation nearly always reads both.
    bounds: Vec<[f64; 2]>,
    trail: Vec<Change>,
    /// The shortest that the trail has been since somebody last asked; nothing where nobody has.
    shortest: Option<usize>,
}

/// One entry of the trail.
#[derive(Debug, Clone, Copy)]
pub struct Change {
    pub(super) old: f64,
    /// Twice the column, plus one for an upper bound.
    bound: u32,
    /// Why the bound changed.
    pub reason: Reason,
}

impl Change {
    pub(super) fn column(&self) -> usize {
        self.bound as usize / 2
    }

    pub(super) fn is_upper(&self) -> bool {
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

    /// Sets one bound, recording the old one; as given, without a reason.
    pub fn apply(&mut self, column: usize, is_upper: bool, value: f64) {
        self.apply_because(column, is_upper, value, Reason::Given);
    }

    /// Sets one bound for a reason, recording both the old bound and the reason.
    pub fn apply_because(&mut self, column: usize, is_upper: bool, value: f64, reason: Reason) {
        let old = std::mem::replace(&mut self.bounds[column][usize::from(is_upper)], value);
        let bound = 2 * column as u32 + u32::from(is_upper);
        self.trail.push(Change { old, bound, reason });
    }

    /// An entry of the trail.
    pub fn change(&self, position: usize) -> Change {
        self.trail[position]
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

    /// The earliest mark to which changes were undone since this was last asked; nothing where it was
    /// never asked.
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
