//! Roll-outs: the inputs of a relaxed point, and what follows from them step by step.
//!
//! A relaxed point is not a motion: with big-M rows, its states are in no mode or in two. But its
//! inputs can be simulated: the first input is fixed, propagation gives the next state and its
//! mode, the second input is fixed, and so on. The result is a consistent sequence of modes; the
//! rest is solved as a leaf.
//!
//! The inputs and their order follow from rows and domain. A column is known if propagation has
//! left it almost no width. Among the rows with several unknown columns, the one with the smallest
//! share of them is next. Of its unknown columns, integers are fixed first, and then the column
//! that occurs in the fewest unknown rows: an input occurs only in the rows of its step, a state
//! also in those of the next step.

use super::parameters::HEURISTICS;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

use crate::presolve::Domain;
use crate::program::Program;
use crate::search::context::Context;
use crate::search::leaf::try_assignment;
use crate::search::local_bounds::{fix_near, propagate_since};

/// Shares of unknown columns in a row are compared in so many steps.
const SHARE_STEPS: usize = 1 << 20;

/// Tries the modes that follow from the inputs of a relaxed point. The domain is left as it was.
pub(super) fn roll_out(ctx: &mut Context<'_>, point: &[f64]) {
    let program = ctx.program();
    // Without columns that can follow there is nothing to roll out.
    if program.integers.len() == program.column_count() {
        return;
    }
    let start = ctx.node.domain.mark();
    if let Some(modes) = modes_of(ctx, program, point) {
        ctx.node.domain.undo_to(start);
        try_assignment(ctx, &modes);
    }
    ctx.node.domain.undo_to(start);
}

/// A point with the integers that follow from the inputs of another point; `None` if a
/// contradiction follows. The changes of the domain stay.
fn modes_of(ctx: &mut Context<'_>, program: &Program, point: &[f64]) -> Option<Vec<f64>> {
    let mut frontier = Frontier::new(program, &ctx.node.domain);
    while let Some(j) = frontier.next_column() {
        let mark = ctx.node.domain.mark();
        if program.integral[j] {
            if !fix_near(ctx, j, point[j]) {
                return None;
            }
        } else {
            let [lower, upper] = ctx.node.domain.bounds(j);
            let value = point[j].clamp(lower, upper);
            ctx.node.fix(j, value);
            if propagate_since(ctx, mark).is_err() {
                ctx.node.domain.undo_to(mark);
            }
        }
        frontier.learn(j);
        for (k, _) in ctx.node.domain.changed_since(mark) {
            frontier.look_at(k, &ctx.node.domain);
        }
        if ctx.is_late() {
            return None;
        }
    }
    let mut modes = point.to_vec();
    for &j in &ctx.program().integers {
        if !fix_near(ctx, j, point[j]) || ctx.is_late() {
            return None;
        }
        modes[j] = ctx.node.domain.lower(j);
    }
    Some(modes)
}

/// The columns that are known, and the rows in which the roll-out goes on.
#[derive(Debug)]
pub struct Frontier<'a> {
    program: &'a Program,
    /// Width of every column at which it is known.
    narrow: Vec<f64>,
    known: Vec<bool>,
    unknown: Vec<usize>,
    /// Which rows have continuous columns.
    moves: Vec<bool>,
    /// Rows by the share of their columns that is unknown, the smallest first; old entries stay.
    rows: BinaryHeap<Reverse<(usize, usize)>>,
}

impl<'a> Frontier<'a> {
    /// Begins with the columns that the domain has fixed as the known ones.
    pub fn new(program: &'a Program, domain: &Domain) -> Self {
        let (m, n) = (program.row_count(), program.column_count());
        let narrow = |j: usize| match domain.upper(j) - domain.lower(j) {
            _ if program.integral[j] => 0.0,
            width if width.is_finite() => HEURISTICS.known_width * width,
            _ => HEURISTICS.known_width,
        };
        let moves = |row: usize| program.row(row).0.iter().any(|&j| !program.integral[j]);
        let mut frontier = Frontier {
            program,
            narrow: (0..n).map(narrow).collect(),
            known: (0..n).map(|j| domain.is_fixed(j)).collect(),
            unknown: vec![0; m],
            moves: (0..m).map(moves).collect(),
            rows: BinaryHeap::new(),
        };
        for row in 0..m {
            let unknown = program.row(row).0.iter().filter(|&&j| !frontier.known[j]).count();
            frontier.unknown[row] = unknown;
            frontier.file(row);
        }
        frontier
    }

    fn share(&self, row: usize) -> usize {
        self.unknown[row] * SHARE_STEPS / self.program.row(row).0.len()
    }

    fn file(&mut self, row: usize) {
        if self.unknown[row] > 1 && self.moves[row] {
            self.rows.push(Reverse((self.share(row), row)));
        }
    }

    /// Marks a column as known if the domain has left it almost no width.
    fn look_at(&mut self, j: usize, domain: &Domain) {
        if j < self.known.len() && domain.upper(j) - domain.lower(j) <= self.narrow[j] {
            self.learn(j);
        }
    }

    /// Marks a column as known.
    pub fn learn(&mut self, j: usize) {
        if std::mem::replace(&mut self.known[j], true) {
            return;
        }
        for &row in self.program.column(j).0 {
            self.unknown[row] -= 1;
            self.file(row);
        }
    }

    /// The column to choose next; `None` if no row has two unknown ones.
    pub fn next_column(&mut self) -> Option<usize> {
        while let Some(&Reverse((share, row))) = self.rows.peek() {
            if self.unknown[row] < 2 || share != self.share(row) {
                self.rows.pop();
                continue;
            }
            let columns = self.program.row(row).0.iter().copied();
            let rank = |&j: &usize| {
                let rows = self.program.column(j).0;
                let farthest = rows.iter().map(|&row| self.share(row)).max();
                (!self.program.integral[j], farthest, Reverse(rows.len()), j)
            };
            return columns.filter(|&j| !self.known[j]).min_by_key(rank);
        }
        None
    }
}
