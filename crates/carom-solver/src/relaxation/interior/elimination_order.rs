//! The order in which the unknowns of a system are eliminated, with little fill.

use super::parameters::{MAX_EXTRA_UNKNOWNS, MAX_FILL_RATIO, MAX_KEPT_ORDERS, MIN_REUSED_PART};
use faer::dyn_stack::{MemBuffer, MemStack, StackReq};
use faer::sparse::SymbolicSparseColMatRef;
use faer::sparse::linalg::amd;

use crate::presolve::{Reduced, refill};

/// The name of an unknown that has none, and the place of one that is not ordered.
const UNNAMED: usize = usize::MAX;

/// The unknowns of a system by the names that they have in the program: its columns, then rows,
/// then entries of cones.
#[derive(Debug, Clone, Default)]
struct Unknowns {
    columns: Vec<usize>,
    rows: Vec<usize>,
    entries: Vec<usize>,
}

impl Unknowns {
    fn len(&self) -> usize {
        self.columns.len() + self.rows.len() + self.entries.len()
    }
}

/// The orders that were used last, the last one first. Further down in the tree, a system is mostly
/// a part of an earlier one, but for a few rows, and the same part of its order leaves no more fill
/// than the whole.
#[derive(Default)]
pub(super) struct KeptOrders {
    kept: Vec<KeptOrder>,
    /// The unknowns of the current system.
    unknowns: Unknowns,
    /// By place in a kept order, or as an order is computed, which of them is there.
    at: Vec<usize>,
    memory: Option<MemBuffer>,
}

#[derive(Debug, Clone, Default)]
struct KeptOrder {
    /// By column, by row and by entry of a cone of the program, when its unknown is eliminated.
    columns: Vec<usize>,
    rows: Vec<usize>,
    entries: Vec<usize>,
    size: usize,
    /// Entries of the factor for each of the system's.
    fill: f64,
}

impl KeptOrders {
    /// Notes the unknowns of a system: the columns of a reduced program, and some of its rows and
    /// entries. If a kept order has most of them and few others, writes by unknown when it is
    /// eliminated, and returns the largest fill that is acceptable: with other rows, such as cuts,
    /// a kept order may be bad.
    pub(super) fn write_part(
        &mut self,
        program: &Reduced,
        (rows, entries): (impl Iterator<Item = usize>, impl Iterator<Item = usize>),
        order: &mut Vec<usize>,
    ) -> Option<f64> {
        let KeptOrders { kept, unknowns, at, .. } = self;
        unknowns.columns.clone_from(&program.columns);
        let name = |row: usize| program.origin.get(row).copied().unwrap_or(UNNAMED);
        unknowns.rows.clear();
        unknowns.rows.extend(rows.map(name));
        unknowns.entries.clear();
        unknowns.entries.extend(entries);
        let k = kept.iter().position(|kept| kept.write_part(unknowns, at, order).is_some())?;
        kept[..=k].rotate_right(1);
        Some(MAX_FILL_RATIO * kept[0].fill)
    }

    /// Writes the order of approximate minimum degree, from an upper triangle by columns: by
    /// unknown, when it is eliminated. `None` if there is none.
    pub(super) fn write_minimum_degree(
        &mut self,
        size: usize,
        (start, index): (&[usize], &[usize]),
        order: &mut Vec<usize>,
    ) -> Option<()> {
        let KeptOrders { at: eliminated, memory, .. } = self;
        let pattern = SymbolicSparseColMatRef::new_checked(size, size, start, None, index);
        let stack = stack(memory, amd::order_maybe_unsorted_scratch::<usize>(size, index.len()))?;
        refill(eliminated, size, 0);
        refill(order, size, 0);
        let control = amd::Control::default();
        amd::order_maybe_unsorted(eliminated, order, pattern, control, stack).ok().map(|_| ())
    }

    /// Keeps an order of these unknowns, and the fill that it leaves.
    pub(super) fn keep(&mut self, order: &[usize], fill: f64) {
        let KeptOrders { kept: all, unknowns, .. } = self;
        let mut kept =
            if all.len() < MAX_KEPT_ORDERS { None } else { all.pop() }.unwrap_or_default();
        let (of_columns, others) = order.split_at(unknowns.columns.len());
        let (of_rows, of_entries) = others.split_at(unknowns.rows.len());
        place(&mut kept.columns, &unknowns.columns, of_columns);
        place(&mut kept.rows, &unknowns.rows, of_rows);
        place(&mut kept.entries, &unknowns.entries, of_entries);
        (kept.size, kept.fill) = (order.len(), fill);
        all.insert(0, kept);
    }
}

impl KeptOrder {
    fn write_part(
        &self,
        unknowns: &Unknowns,
        at: &mut Vec<usize>,
        order: &mut Vec<usize>,
    ) -> Option<()> {
        let (size, whole) = (unknowns.len(), self.size);
        if size > whole + MAX_EXTRA_UNKNOWNS || (size as f64) < MIN_REUSED_PART * whole as f64 {
            return None;
        }
        refill(at, self.size, UNNAMED);
        let columns = unknowns.columns.iter().map(|&name| self.columns.get(name));
        let rows = unknowns.rows.iter().map(|&name| self.rows.get(name));
        let entries = unknowns.entries.iter().map(|&name| self.entries.get(name));
        for (unknown, place) in columns.chain(rows).chain(entries).enumerate() {
            match place.copied().filter(|&place| place < whole) {
                Some(place) if at[place] == UNNAMED => at[place] = unknown,
                None if at.len() < whole + MAX_EXTRA_UNKNOWNS => at.push(unknown),
                _ => return None,
            }
        }
        refill(order, size, 0);
        let eliminated = at.iter().filter(|unknown| **unknown != UNNAMED);
        eliminated.enumerate().for_each(|(when, &unknown)| order[unknown] = when);
        Some(())
    }
}

/// Writes when the unknowns of some names are eliminated.
fn place(by_name: &mut Vec<usize>, names: &[usize], order: &[usize]) {
    let named = || names.iter().zip(order).filter(|(name, _)| **name != UNNAMED);
    refill(by_name, named().map(|(name, _)| name + 1).max().unwrap_or(0), UNNAMED);
    named().for_each(|(&name, &when)| by_name[name] = when);
}

/// Working memory as large as needed, the old one if that is enough; `None` if there is none.
pub(super) fn stack(memory: &mut Option<MemBuffer>, need: StackReq) -> Option<&mut MemStack> {
    if !memory.as_mut().is_some_and(|memory| MemStack::new(memory).can_hold(need)) {
        *memory = Some(MemBuffer::try_new(need).ok()?);
    }
    memory.as_mut().map(|memory| MemStack::new(memory))
}
