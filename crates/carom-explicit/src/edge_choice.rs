//! The edge through which a cell is cut: one that leads from states with some integers to states
//! with others, or else the longest one.
//!
//! A surface on which integers change is thin. Where only the edges across it are halved, cells
//! become thin beside it and stay long along it, so that far fewer of them reach the finest edge
//! than if all edges became short.

use std::rc::Rc;

use crate::build::BuildGoal;
use crate::corner::{Corner, CornerOptimum, Workshop};
use crate::relaxed::CornerRelaxation;
use crate::simplex_cell::{BOX_UNITS, squared_length};

/// An edge, by its corners.
pub(crate) type CellEdge = [usize; 2];

fn length(corners: &[Rc<Corner>], [i, j]: CellEdge) -> f64 {
    squared_length(corners[i].units(), corners[j].units()) as f64
}

/// The longest edge of those that are asked for, the first one if there are several.
fn longest(corners: &[Rc<Corner>], mut is_asked: impl FnMut(CellEdge) -> bool) -> Option<CellEdge> {
    let mut best: Option<(f64, CellEdge)> = None;
    for i in 0..corners.len() {
        for j in i + 1..corners.len() {
            let own = length(corners, [i, j]);
            if best.is_none_or(|(most, _)| own > most) && is_asked([i, j]) {
                best = Some((own, [i, j]));
            }
        }
    }
    best.map(|(_, edge)| edge)
}

impl Workshop<'_> {
    /// The edge to cut; `None` if it is short enough, or the cell small enough. `numbers` are
    /// integers that may be good in parts of the cell.
    pub(crate) fn edge(
        &mut self,
        corners: &[Rc<Corner>],
        numbers: &[usize],
        goal: BuildGoal,
        depth: usize,
    ) -> Option<CellEdge> {
        if depth >= goal.deepest(self.form.axes.len()) {
            return None;
        }
        // For each corner, which of the integers are good there.
        let mut good = Vec::with_capacity(corners.len());
        for corner in corners {
            let mut own = vec![false; numbers.len() + 1];
            match self.optimum(corner) {
                CornerOptimum::NoPlan => own[numbers.len()] = true,
                CornerOptimum::Unknown => own.fill(true),
                CornerOptimum::Best(best) => {
                    let least = self.cost(corner, best).unwrap_or(f64::INFINITY);
                    let most = least + goal.absolute + goal.relative * least.abs();
                    for (own, &number) in own.iter_mut().zip(numbers) {
                        *own = self.cost(corner, number).is_some_and(|cost| cost <= most);
                    }
                }
            }
            good.push(own);
        }
        let is_apart = |[i, j]: CellEdge| !good[i].iter().zip(&good[j]).any(|(a, b)| *a && *b);
        let edge = longest(corners, is_apart).or_else(|| longest(corners, |_| true))?;
        (length(corners, edge).sqrt() / BOX_UNITS as f64 > goal.finest).then_some(edge)
    }

    fn cost(&mut self, corner: &Corner, number: usize) -> Option<f64> {
        match &*self.relaxed(corner, number) {
            CornerRelaxation::Solved { cost, .. } => Some(*cost),
            _ => None,
        }
    }
}
