//! The walk over the cells.
//!
//! The box is cut into one simplex for each order of its axes (Kuhn's), and a cell that is cut
//! becomes two, in which the middle of an edge takes the place of one of its ends: both together
//! are the cell. So the leaves of a tree in which each cell is somebody's half cover the box.
//!
//! In a leaf with a plan, the plans at the corners have the same integers. Between corners, the
//! plan is interpolated: it keeps all rows, because they are linear, and its cost is a quadratic
//! form of the weights of the corners, no larger than its largest coefficient. The same holds for
//! cost less bound, see `evidence`.

use super::ProvedTable;
use super::closed_loop::{Image, LoopCell, LoopPiece, ProvedLoop, prove};
use super::evidence::Evidence;
use super::programs::{PlannedCell, ProvedPrograms, read_programs};
use super::statement::Statement;
use crate::exact::{Dyadic, Sum};
use crate::text::{Lines, Refusal, Words, rejected};
use std::io::BufRead;
use std::rc::Rc;

/// Units along a side of the box.
pub(super) const UNITS: i64 = 1 << 30;

/// A corner of cells.
#[derive(Debug, PartialEq)]
pub(super) struct Corner {
    pub(super) units: Vec<i64>,
}

/// A plan at a corner, with what its cost needs.
#[derive(Debug)]
pub(super) struct Plan {
    pub(super) entries: Vec<(u32, f64)>,
    /// Where it is used; known from its first use.
    pub(super) used: Option<Rc<Used>>,
}

/// A plan where it is used.
#[derive(Debug)]
pub(super) struct Used {
    pub(super) units: Vec<i64>,
    /// Values of all columns.
    pub(super) x: Vec<Dyadic>,
    /// `P x` and `q'x`.
    pub(super) px: Vec<Dyadic>,
    pub(super) linear: Dyadic,
    /// The next states, if the table says where they are.
    pub(super) next: Image,
}

/// The plans and the evidence of a table.
#[derive(Debug)]
pub(super) struct Checked {
    pub(super) plans: Vec<Plan>,
    pub(super) evidence: Vec<Evidence>,
}

/// A cell that is not read yet: the share of the box, the cuts that led to it, its corners.
pub(super) struct Waiting {
    pub(super) share: f64,
    depth: u64,
    pub(super) corners: Vec<Rc<Corner>>,
}

/// The orders of the axes, in lexicographic order.
pub(super) fn orders(n: usize) -> Vec<Vec<usize>> {
    let mut orders: Vec<Vec<usize>> = vec![Vec::new()];
    for _ in 0..n {
        let mut longer = Vec::new();
        for order in &orders {
            for axis in (0..n).filter(|axis| !order.contains(axis)) {
                let mut next = order.clone();
                next.push(axis);
                longer.push(next);
            }
        }
        orders = longer;
    }
    orders
}

/// Kuhn's simplices, by the orders of the axes.
fn simplices(n: usize) -> Vec<Vec<Rc<Corner>>> {
    let of = |order: &Vec<usize>| {
        let mut units = vec![0; n];
        let mut corners = vec![Rc::new(Corner { units: units.clone() })];
        for &axis in order {
            units[axis] = UNITS;
            corners.push(Rc::new(Corner { units: units.clone() }));
        }
        corners
    };
    orders(n).iter().map(of).collect()
}

impl Corner {
    fn middle(&self, other: &Corner) -> Result<Rc<Corner>, Refusal> {
        let mut units = Vec::new();
        for (a, b) in self.units.iter().zip(&other.units) {
            if (a + b) % 2 != 0 {
                return rejected("the middle of the edge is finer than the units of the box");
            }
            units.push((a + b) / 2);
        }
        Ok(Rc::new(Corner { units }))
    }

    /// The state, exactly.
    pub(super) fn state(&self, statement: &Statement) -> Result<Vec<Dyadic>, Refusal> {
        let mut sum = Sum::default();
        let own = self.units.iter().zip(&statement.axes).map(|(&units, &j)| {
            let column = &statement.columns[j];
            let share = units as f64 / UNITS as f64;
            sum.add(column.lower, 1.0 - share);
            sum.add(column.upper, share);
            Ok(sum.take()?)
        });
        own.collect()
    }
}

impl Checked {
    /// Reads plans and evidence.
    pub(super) fn read<R: BufRead>(
        lines: &mut Lines<R>,
        statement: &Statement,
    ) -> Result<Self, Refusal> {
        let (columns, rows) = (statement.columns.len(), statement.rows.len());
        let is_axis = |entry: &(u32, f64)| statement.columns[entry.0 as usize].axis.is_some();
        let mut words = lines.expect("plans")?;
        let count = words.count("the number of plans")?;
        words.end()?;
        let mut plans = Vec::new();
        for _ in 0..count {
            let mut words = lines.expect("x")?;
            let entries = words.entries(columns)?;
            words.end()?;
            if entries.iter().any(is_axis) {
                return rejected("a plan has a value for an axis");
            }
            plans.push(Plan { entries, used: None });
        }
        let mut words = lines.expect("evidence")?;
        let count = words.count("the number of evidence")?;
        words.end()?;
        let mut evidence = Vec::new();
        for _ in 0..count {
            let (mut words, keyword) = lines.expect_any(&["b", "f"])?;
            let is_ray = keyword == "f";
            let z = if is_ray { Vec::new() } else { words.entries(columns)? };
            let y = words.entries(rows)?;
            words.end()?;
            for &(j, z) in &z {
                let column = &statement.columns[j as usize];
                if column.axis.is_some() || !(column.lower..=column.upper).contains(&z) {
                    return rejected(format!("column {j} is out of its bounds, or an axis"));
                }
            }
            evidence.push(Evidence { is_ray, z, y });
        }
        Ok(Checked { plans, evidence })
    }

    /// Reads and checks the cells.
    pub(super) fn walk<R: BufRead>(
        mut self,
        lines: &mut Lines<R>,
        statement: &Statement,
    ) -> Result<ProvedTable, Refusal> {
        let first = simplices(statement.axes.len());
        let mut words = lines.expect("cells")?;
        let count = words.count("the number of cells")?;
        words.end()?;
        let share = 1.0 / first.len() as f64;
        let whole = |corners| Some(Waiting { share, depth: 0, corners });
        let mut waiting: Vec<Option<Waiting>> = first.into_iter().map(whole).collect();
        let mut proved = ProvedTable {
            cells: 0,
            within: 0.0,
            larger: 0.0,
            unproved: 0.0,
            refuted: 0.0,
            open: 0.0,
            loss: 0.0,
            stays: None,
            reaches: None,
            depth: 0,
            programs: [ProvedPrograms::NONE; 2],
        };
        let (mut loop_cells, mut planned) = (Vec::new(), Vec::new());
        for number in 0..count {
            let (mut words, keyword) = lines.expect_any(&["cut", "plan", "none", "open"])?;
            let Some(cell) = waiting.get_mut(number).and_then(Option::take) else {
                return rejected(format!("cell {number} is no half of a cell before it"));
            };
            proved.depth = proved.depth.max(cell.depth);
            if keyword == "cut" {
                let edge = cut(&mut words, cell, &mut waiting)?;
                words.end()?;
                let halves = [waiting.len() - 2, waiting.len() - 1];
                loop_cells.push(LoopCell::Cut { edge, halves });
                planned.push(None);
                continue;
            }
            proved.cells += 1;
            match keyword {
                "plan" => {
                    let head = self.head(&mut words, cell.corners.len())?;
                    let plans = self.check_plan(head, lines, statement, &cell, &mut proved)?;
                    loop_cells.push(LoopCell::Plan(LoopPiece::new(&cell, &plans)));
                    let Waiting { share, corners, .. } = cell;
                    planned.push(Some(PlannedCell { share, corners, plans }));
                    continue;
                }
                "none" => {
                    let steps = words.count("the number of steps")?;
                    words.end()?;
                    self.steps(lines, statement, &cell, steps, None)?;
                    proved.refuted += cell.share;
                }
                _ => {
                    words.end()?;
                    proved.open += cell.share;
                }
            }
            loop_cells.push(LoopCell::NoPlan);
            planned.push(None);
        }
        if waiting.iter().any(Option::is_some) {
            return rejected("a half of a cell is not there");
        }
        for (programs, bits) in proved.programs.iter_mut().zip([53, 24]) {
            *programs = read_programs(lines, statement, &planned, bits)?;
        }
        if !statement.next.is_empty() {
            let ProvedLoop { stays, reaches } = prove(loop_cells, statement)?;
            (proved.stays, proved.reaches) = (Some(stays), reaches);
        }
        Ok(proved)
    }
}

fn cut(
    words: &mut Words<'_>,
    cell: Waiting,
    waiting: &mut Vec<Option<Waiting>>,
) -> Result<[usize; 2], Refusal> {
    let corners = cell.corners.len();
    let (i, j) = (words.index("corner", corners)?, words.index("corner", corners)?);
    if i == j {
        return rejected("an edge has two ends");
    }
    let middle = cell.corners[i].middle(&cell.corners[j])?;
    for replaced in [j, i] {
        let half = words.count("the number of a cell")?;
        if half != waiting.len() {
            return rejected(format!("the next half must be cell {}", waiting.len()));
        }
        let mut corners = cell.corners.clone();
        corners[replaced] = Rc::clone(&middle);
        waiting.push(Some(Waiting { share: 0.5 * cell.share, depth: cell.depth + 1, corners }));
    }
    Ok([i, j])
}
