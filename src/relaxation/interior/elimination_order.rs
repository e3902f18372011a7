//! The order in which the unknowns of a system are eliminated, with little fill.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::SymbolicSparseColMatRef;
use faer::sparse::linalg::amd;

use crate::presolve::Reduced;

/// A kept order is used while at least this part of its unknowns is left; a smaller system has better
/// orders of its own.
const LEFT: f64 = 0.75;

/// A kept order is used if it leaves at most this many times its fill.
const WORSE: f64 = 1.1;

/// The name of an unknown that has none, and the place of one that is not ordered.
const NONE: usize = usize::MAX;

/// The unknowns of a system by the names that they have in the program: its columns, then rows.
pub(super) struct Unknowns<'a> {
    columns: &'a [usize],
    rows: Vec<usize>,
}

impl<'a> Unknowns<'a> {
    /// The columns of a reduced program, and some of its rows.
    pub(super) fn new(program: &'a Reduced, rows: impl Iterator<Item = usize>) -> Self {
        let name = |row: usize| program.origin.get(row).copied().unwrap_or(NONE);
        Unknowns { columns: &program.columns, rows: rows.map(name).collect() }
    }

    fn len(&self) -> usize {
        self.columns.len() + self.rows.len()
    }
}

/// The last order that was computed. Below in the tree, a system is mostly a part of the one before,
/// and a part of an order leaves no more fill than the whole.
#[derive(Debug, Clone, Default)]
pub(super) struct KeptOrder {
    /// By column and by row of the program, when its unknown is eliminated.
    columns: Vec<usize>,
    rows: Vec<usize>,
    size: usize,
    /// Entries of the factor for each of the system's.
    fill: f64,
}

impl KeptOrder {
    /// The part of the order that is about some unknowns, if they are all in it, and are most: by
    /// unknown, when it is eliminated.
    pub(super) fn part(&self, unknowns: &Unknowns<'_>) -> Option<Vec<usize>> {
        if (unknowns.len() as f64) < LEFT * self.size as f64 {
            return None;
        }
        let mut at = vec![NONE; self.size];
        let columns = unknowns.columns.iter().map(|&name| self.columns.get(name));
        let rows = unknowns.rows.iter().map(|&name| self.rows.get(name));
        for (unknown, place) in columns.chain(rows).enumerate() {
            let slot = at.get_mut(*place?)?;
            if *slot != NONE {
                return None;
            }
            *slot = unknown;
        }
        let mut order = vec![0; unknowns.len()];
        let eliminated = at.into_iter().filter(|&unknown| unknown != NONE);
        eliminated.enumerate().for_each(|(when, unknown)| order[unknown] = when);
        Some(order)
    }

    /// Whether a part of the order leaves about as little fill as the whole. It does not if the system
    /// has got other rows, such as cuts.
    pub(super) fn suits(&self, fill: f64) -> bool {
        fill <= WORSE * self.fill
    }

    /// Keeps an order, and the fill that it leaves.
    pub(super) fn keep(&mut self, unknowns: &Unknowns<'_>, order: &[usize], fill: f64) {
        let (of_columns, of_rows) = order.split_at(unknowns.columns.len());
        place(&mut self.columns, unknowns.columns, of_columns);
        place(&mut self.rows, &unknowns.rows, of_rows);
        (self.size, self.fill) = (order.len(), fill);
    }
}

/// Writes when the unknowns of some names are eliminated.
fn place(by_name: &mut Vec<usize>, names: &[usize], order: &[usize]) {
    by_name.clear();
    for (&name, &when) in names.iter().zip(order).filter(|(name, _)| **name != NONE) {
        if name >= by_name.len() {
            by_name.resize(name + 1, NONE);
        }
        by_name[name] = when;
    }
}

/// The order of approximate minimum degree, from an upper triangle by columns: by unknown, when it is
/// eliminated. `None` if there is none.
pub(super) fn minimum_degree(size: usize, start: &[usize], index: &[usize]) -> Option<Vec<usize>> {
    let pattern = SymbolicSparseColMatRef::new_checked(size, size, start, None, index);
    let need = amd::order_maybe_unsorted_scratch::<usize>(size, index.len());
    let mut memory = MemBuffer::try_new(need).ok()?;
    let (mut eliminated, mut order) = (vec![0; size], vec![0; size]);
    let (control, stack) = (amd::Control::default(), MemStack::new(&mut memory));
    amd::order_maybe_unsorted(&mut eliminated, &mut order, pattern, control, stack).ok()?;
    Some(order)
}
