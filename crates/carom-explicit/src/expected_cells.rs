//! A forecast of the number of cells.
//!
//! Of the cells of a depth, a share is cut, and each of them becomes two cells of the next depth.
//! Deeper than what is known, the shares are expected to go on falling as they did.

use crate::build::{BuildGoal, PartitionCell};

/// The decisions of a depth from which its share of cuts is believed.
const ENOUGH_DECISIONS: usize = 32;

/// Decisions by depth.
#[derive(Debug, Clone)]
pub(crate) struct CellCounts {
    /// Cells that were decided, and those of them that were cut.
    by_depth: Vec<[usize; 2]>,
    axes: usize,
    roots: usize,
    /// The depth at which cells are not cut.
    deepest: usize,
    limit: usize,
    pub(crate) leaves: usize,
    /// The share of the set that is decided.
    pub(crate) share: f64,
}

impl CellCounts {
    pub(crate) fn new(axes: usize, roots: usize, goal: BuildGoal) -> Self {
        let (deepest, limit) = (goal.deepest(axes), goal.cells);
        CellCounts { by_depth: Vec::new(), axes, roots, deepest, limit, leaves: 0, share: 0.0 }
    }

    /// Counts the cells that are known already.
    pub(crate) fn recount(&mut self, cells: &[Option<PartitionCell>], roots: usize) {
        let mut depths = vec![0; roots];
        for (number, cell) in cells.iter().enumerate() {
            let depth = depths.get(number).copied().unwrap_or(0);
            match cell {
                Some(PartitionCell::Cut { .. }) => {
                    depths.extend([depth + 1; 2]);
                    self.add((depth, true));
                }
                Some(_) => self.add((depth, false)),
                None => {}
            }
        }
    }

    /// Counts a decision.
    pub(crate) fn add(&mut self, (depth, is_cut): (usize, bool)) {
        if self.by_depth.len() <= depth {
            self.by_depth.resize(depth + 1, [0; 2]);
        }
        self.by_depth[depth][0] += 1;
        self.by_depth[depth][1] += usize::from(is_cut);
        if !is_cut {
            self.leaves += 1;
            self.share += 0.5_f64.powi(depth as i32) / self.roots as f64;
        }
    }

    /// The number of leaves that is expected.
    pub(crate) fn expected(&self) -> usize {
        let (mut cells, mut all) = (self.roots as f64, 0.0);
        let mut shares: Vec<f64> = Vec::new();
        let mut trend = 1.0;
        for depth in 0..=self.deepest {
            let [decided, cut] = self.by_depth.get(depth).copied().unwrap_or_default();
            let last = shares.last().copied().unwrap_or(1.0);
            if decided >= ENOUGH_DECISIONS || (decided > 0 && decided as f64 >= cells) {
                shares.push(cut as f64 / decided as f64);
                // Edges are half as long after a cut for each axis.
                let whole = shares.len().checked_sub(1 + self.axes).map(|k| shares[k]);
                let ratio = whole.filter(|whole| *whole > 0.0).map(|whole| shares[depth] / whole);
                trend = ratio.unwrap_or(1.0).min(1.0).powf(1.0 / self.axes as f64);
            } else {
                shares.push(last * trend);
            }
            all += cells * (1.0 - shares[depth]);
            cells *= 2.0 * shares[depth];
        }
        let expected = (all + cells).min(self.limit as f64);
        (expected.round() as usize).max(self.leaves)
    }
}
