//! Activity-based bound propagation.
//!
//! For a row `l <= a'x <= u` the smallest and the largest activity over the current bounds limit
//! every column in it. Tightened columns put their rows back on a worklist until nothing moves
//! enough; the arithmetic of one row is in `tightening`.

use std::collections::VecDeque;

use super::domain::Domain;
use super::implications::Implications;
use super::tightening::{Entry, Line, Tightening, tighten};
use crate::program::Program;
use crate::solver::Deadline;
use crate::tolerance;

/// Proof of infeasibility by propagation: the row or column at which it surfaced.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Conflict {
    /// A row cannot be satisfied within the bounds; the row count stands for the objective's limit.
    Row(usize),
    /// A column's bounds crossed.
    Column(usize),
}

/// The worklist of propagation; one per program and thread, reused over all nodes.
///
/// Rows and columns are copied in a compact form: propagation is bound by memory, and most visits
/// of a row end after one pass over its entries.
#[derive(Debug, Clone)]
pub struct Propagator {
    queue: VecDeque<usize>,
    queued: Vec<bool>,
    /// The program's rows, then the linear objective, limited by the cutoff.
    rows: Vec<Line>,
    entries: Vec<Entry>,
    /// By column: the rows it is in, the objective last.
    uses: Vec<Vec<Use>>,
    found: Vec<Tightening>,
    implications: Implications,
    deadline: Deadline,
}

/// A row that a column is in, and which changes of the column's bounds can matter to the row.
#[derive(Debug, Clone, Copy)]
struct Use {
    row: u32,
    /// By bound changed: lower, upper.
    matters: [bool; 2],
}

impl Propagator {
    /// For a program.
    pub fn new(program: &Program) -> Self {
        let mut propagator = Propagator {
            queue: VecDeque::new(),
            queued: vec![false; program.row_count() + 1],
            rows: Vec::with_capacity(program.row_count() + 1),
            entries: Vec::new(),
            uses: vec![Vec::new(); program.column_count()],
            found: Vec::new(),
            implications: Implications::default(),
            deadline: Deadline::default(),
        };
        for row in 0..program.row_count() {
            let limits = [program.row_lower[row], program.row_upper[row]];
            let (columns, coefficients) = program.row(row);
            propagator.add(columns.iter().copied().zip(coefficients.iter().copied()), limits);
        }
        // A quadratic objective is no row; its line stays empty.
        let linear = program.quadratic.compute_nnz() == 0;
        let costs = program.linear.iter().copied().enumerate().filter(|_| linear);
        propagator.add(costs, [f64::NEG_INFINITY, f64::INFINITY]);
        propagator
    }

    fn add(&mut self, terms: impl Iterator<Item = (usize, f64)>, limits: [f64; 2]) {
        let (row, start) = (self.rows.len(), self.entries.len());
        let is_objective = row + 1 == self.queued.len();
        for (column, coefficient) in terms.filter(|(_, a)| *a != 0.0) {
            self.entries.push(Entry { column, coefficient });
            // The least activity meets the upper limit, the largest one the lower limit.
            let (least, most) = (is_objective || limits[1].is_finite(), limits[0].is_finite());
            let matters = if coefficient > 0.0 { [least, most] } else { [most, least] };
            self.uses[column].push(Use { row: row as u32, matters });
        }
        self.rows.push(Line { range: [start, self.entries.len()], limits });
    }

    /// The table of implications that propagation follows.
    pub fn implications(&self) -> &Implications {
        &self.implications
    }

    /// Makes every later propagation follow a table of implications as well.
    pub fn set_implications(&mut self, implications: Implications) {
        self.implications = implications;
    }

    /// Makes every later propagation end at a deadline. What is concluded until then holds; what
    /// is not may be missing.
    pub fn set_deadline(&mut self, deadline: &Deadline) {
        self.deadline = deadline.clone();
    }

    /// Makes every later propagation look only for points whose (minimised) objective is at most
    /// `cutoff`, where the objective is linear. What is then refuted is refuted *up to the
    /// cutoff*. Returns the cutoff in force: infinite for other objectives.
    pub fn set_cutoff(&mut self, program: &Program, cutoff: f64) -> f64 {
        let last = self.objective();
        let objective = &mut self.rows[last];
        if objective.range[0] == objective.range[1] {
            return f64::INFINITY;
        }
        objective.limits[1] = cutoff - program.offset;
        cutoff
    }

    /// Propagates all rows.
    ///
    /// # Errors
    ///
    /// The [`Conflict`] that proves the domain empty.
    pub fn propagate_all(
        &mut self,
        program: &Program,
        domain: &mut Domain,
    ) -> Result<(), Conflict> {
        if let Some(crossed) =
            (0..program.column_count()).find(|&j| domain.lower(j) > domain.upper(j))
        {
            return Err(Conflict::Column(crossed));
        }
        (0..program.row_count()).for_each(|row| self.enqueue(row));
        self.run(program, domain)
    }

    /// Propagates the rows of columns that changed since `mark`.
    ///
    /// # Errors
    ///
    /// The [`Conflict`] that proves the domain empty.
    pub fn propagate_since(
        &mut self,
        program: &Program,
        domain: &mut Domain,
        mark: usize,
    ) -> Result<(), Conflict> {
        for (column, is_upper) in domain.changed_since(mark) {
            if domain.lower(column) > domain.upper(column) {
                self.clear();
                return Err(Conflict::Column(column));
            }
            self.enqueue_uses(column, is_upper, usize::MAX);
        }
        if !self.implications.is_empty() {
            let changed: Vec<usize> = domain.changed_since(mark).map(|(j, _)| j).collect();
            for column in changed {
                self.imply(program, domain, column).inspect_err(|_| self.clear())?;
            }
        }
        let objective = self.objective();
        if self.rows[objective].limits[1] < f64::INFINITY {
            self.enqueue(objective);
        }
        self.run(program, domain)
    }

    /// The number of the objective's line: the last one.
    fn objective(&self) -> usize {
        self.rows.len() - 1
    }

    fn enqueue(&mut self, row: usize) {
        if !self.queued[row] {
            self.queued[row] = true;
            self.queue.push_back(row);
        }
    }

    /// Puts the rows on the list to which a changed bound can matter, but for the one that changed
    /// it.
    fn enqueue_uses(&mut self, column: usize, is_upper: bool, changed_by: usize) {
        for &Use { row, matters } in &self.uses[column] {
            let row = row as usize;
            if matters[usize::from(is_upper)] && row != changed_by && !self.queued[row] {
                self.queued[row] = true;
                self.queue.push_back(row);
            }
        }
    }

    fn clear(&mut self) {
        for row in self.queue.drain(..) {
            self.queued[row] = false;
        }
    }

    /// Fixes what a binary that has become fixed implies, and what that implies.
    fn imply(
        &mut self,
        program: &Program,
        domain: &mut Domain,
        column: usize,
    ) -> Result<(), Conflict> {
        let mut fixed = vec![column];
        while let Some(j) = fixed.pop() {
            let [lower, upper] = domain.bounds(j);
            if !program.integral[j] || lower != upper || !(0.0..=1.0).contains(&lower) {
                continue;
            }
            let literal = 2 * j + usize::from(lower == 1.0);
            for k in 0..self.implications.of(literal).len() {
                let other = self.implications.of(literal)[k];
                let (column, value) = (other / 2, (other % 2) as f64);
                let is_upper = value == 0.0;
                let [lower, upper] = domain.bounds(column);
                if lower > value || upper < value {
                    return Err(Conflict::Column(column));
                }
                if lower < upper {
                    domain.apply(column, is_upper, value);
                    self.enqueue_uses(column, is_upper, usize::MAX);
                    fixed.push(column);
                }
            }
        }
        Ok(())
    }

    fn run(&mut self, program: &Program, domain: &mut Domain) -> Result<(), Conflict> {
        let mut found = std::mem::take(&mut self.found);
        let result = self.run_into(program, domain, &mut found);
        found.clear();
        self.found = found;
        if result.is_err() {
            self.clear();
        }
        result
    }

    fn run_into(
        &mut self,
        program: &Program,
        domain: &mut Domain,
        found: &mut Vec<Tightening>,
    ) -> Result<(), Conflict> {
        // A cap on the work: long chains of shrinking gains add nothing that a relaxation lacks.
        let mut budget = 50 * (program.row_count() + 100);
        while let Some(row) = self.queue.pop_front() {
            self.queued[row] = false;
            let Line { range: [start, end], limits } = self.rows[row];
            if budget == 0 || self.deadline.spend(1 + end - start) {
                self.clear();
                break;
            }
            budget -= 1;
            let entries = &self.entries[start..end];
            if !tighten(&program.integral, domain, entries, limits, found) {
                return Err(Conflict::Row(row));
            }
            for Tightening { column, is_upper, value } in found.drain(..) {
                domain.apply(column, is_upper, value);
                let settled = settle(program, domain, column)?;
                self.enqueue_uses(column, is_upper, row);
                if settled {
                    self.enqueue_uses(column, !is_upper, row);
                }
                if program.integral[column] && !self.implications.is_empty() {
                    self.imply(program, domain, column)?;
                }
            }
        }
        Ok(())
    }
}

/// Brings slightly crossed bounds of a column back together (`true` when it did), or reports the
/// conflict.
fn settle(program: &Program, domain: &mut Domain, column: usize) -> Result<bool, Conflict> {
    let [lower, upper] = domain.bounds(column);
    if lower <= upper {
        return Ok(false);
    }
    let scale = lower.abs().max(upper.abs()).max(1.0);
    if program.integral[column] || lower - upper > tolerance::PROPAGATION_INFEASIBLE * scale {
        return Err(Conflict::Column(column));
    }
    let middle = 0.5 * (lower + upper);
    domain.set_lower(column, middle);
    domain.set_upper(column, middle);
    Ok(true)
}
