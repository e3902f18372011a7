//! Event windows: branching on "no event in these steps, or at least one".
//!
//! Most binaries over a horizon are events, of which a plan has few, so it is better to bisect the
//! time of an event than to branch step by step. The open binaries get a balanced tree of integer
//! columns that count the events of a window; every count is the sum of two narrower ones. A window
//! is split like any other column, and propagation works in both directions. Relaxations do not
//! contain these columns; a window that must have an event adds a covering row.

use crate::presolve::{Domain, Reduced};
use crate::program::Program;

/// Fewest open binaries for which windows are made.
const FEWEST: usize = 4;

/// A program with columns that count the events of windows, behind its own columns.
#[derive(Debug)]
pub(super) struct EventWindows<'a> {
    /// The program without them.
    base: &'a Program,
    program: Program,
    /// The halves of each window, earlier one first: binaries of the program or younger windows.
    halves: Vec<[usize; 2]>,
}

impl<'a> EventWindows<'a> {
    /// Windows over the binaries in `order` that are open in `domain`; `None` if there are few.
    pub(super) fn new(base: &'a Program, domain: &Domain, order: &[usize]) -> Option<Self> {
        let open: Vec<usize> = order.iter().copied().filter(|&j| !domain.is_fixed(j)).collect();
        if open.len() < FEWEST {
            return None;
        }
        let mut windows = EventWindows { base, program: base.clone(), halves: Vec::new() };
        windows.cover(&open);
        let sizes = windows.sizes();
        let count = |k: usize| (base.column_count() + k, -1.0);
        let row =
            |(k, &[a, b]): (usize, &[usize; 2])| (vec![(a, 1.0), (b, 1.0), count(k)], [0.0; 2]);
        let rows: Vec<_> = windows.halves.iter().enumerate().map(row).collect();
        windows.program.append(&sizes, &rows)?;
        Some(windows)
    }

    pub(super) fn program(&self) -> &Program {
        &self.program
    }

    /// The program without them: what is relaxed.
    pub(super) fn base(&self) -> &'a Program {
        self.base
    }

    /// A window over the given columns, and those inside it; its column.
    fn cover(&mut self, columns: &[usize]) -> usize {
        if let [only] = columns {
            return *only;
        }
        let (early, late) = columns.split_at(columns.len() / 2);
        let halves = [self.cover(early), self.cover(late)];
        self.halves.push(halves);
        self.base.column_count() + self.halves.len() - 1
    }

    /// How many binaries each window has.
    fn sizes(&self) -> Vec<f64> {
        let first = self.base.column_count();
        let mut sizes: Vec<f64> = Vec::with_capacity(self.halves.len());
        for halves in &self.halves {
            let size = |&j: &usize| if j < first { 1.0 } else { sizes[j - first] };
            sizes.push(halves.iter().map(size).sum());
        }
        sizes
    }

    /// Adds the counts of all windows to a point of the program without them.
    pub(super) fn complete(&self, point: &mut Vec<f64>) {
        let counted = point.len().saturating_sub(self.base.column_count());
        for &[a, b] in self.halves.iter().skip(counted) {
            point.push(point[a] + point[b]);
        }
    }

    fn halves_of(&self, column: usize) -> Option<[usize; 2]> {
        column.checked_sub(self.base.column_count()).and_then(|k| self.halves.get(k).copied())
    }

    /// The window to split: the late half of the narrowest one that must have an event which is not
    /// yet decided; or else the widest one that is open, the latest of these.
    pub(super) fn next(&self, domain: &Domain) -> Option<usize> {
        let top = self.base.column_count() + self.halves.len() - 1;
        self.forced(domain, top).or_else(|| self.open(domain, top))
    }

    /// Inside a window that must have an event: where it may be.
    fn forced(&self, domain: &Domain, window: usize) -> Option<usize> {
        let [early, late] = self.halves_of(window)?;
        for half in [late, early] {
            if domain.lower(half) >= 1.0
                && let Some(found) = self.forced(domain, half)
            {
                return Some(found);
            }
        }
        let decided = domain.lower(late) >= 1.0 || domain.lower(early) >= 1.0;
        (!decided && domain.lower(window) >= 1.0).then_some(late)
    }

    /// The widest open window, the latest of these.
    fn open(&self, domain: &Domain, window: usize) -> Option<usize> {
        let mut level = vec![window];
        while !level.is_empty() {
            let undecided = |j: &usize| domain.lower(*j) == 0.0 && domain.upper(*j) >= 1.0;
            if let Some(found) = level.iter().rev().copied().find(undecided) {
                return Some(found);
            }
            level = level.iter().filter_map(|&j| self.halves_of(j)).flatten().collect();
        }
        None
    }

    /// Adds a covering row to a relaxation for each narrowest window that must have an event.
    pub(super) fn add_rows(&self, domain: &Domain, reduced: &mut Reduced) {
        for (k, halves) in self.halves.iter().enumerate() {
            let narrowest = halves.iter().all(|&j| domain.lower(j) < 1.0);
            if !narrowest || domain.lower(self.base.column_count() + k) < 1.0 {
                continue;
            }
            let mut columns = Vec::new();
            let mut waiting = halves.to_vec();
            while let Some(j) = waiting.pop() {
                match self.halves_of(j) {
                    Some(halves) => waiting.extend(halves),
                    None => columns.extend(reduced.columns.binary_search(&j)),
                }
            }
            columns.sort_unstable();
            if columns.len() > 1 {
                reduced.rows.value.extend(columns.iter().map(|_| 1.0));
                reduced.rows.index.extend(columns);
                reduced.rows.start.push(reduced.rows.index.len());
                reduced.origin.push(usize::MAX);
                reduced.row_lower.push(1.0);
                reduced.row_upper.push(f64::INFINITY);
            }
        }
    }
}
