//! Activity-based bound propagation.
//!
//! For a row `l <= a'x <= u` the smallest and the largest activity over the current bounds limit
//! every column in it. Tightened columns put their rows back on a worklist until nothing moves
//! enough. Bounds of continuous columns are loosened by a hair
//! ([`tolerance::PROPAGATION_SLACK`]), so rounding never cuts a feasible point off.

use std::collections::VecDeque;

use super::domain::Domain;
use crate::interval::Interval;
use crate::program::Program;
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
#[derive(Debug, Clone)]
pub struct Propagator {
    queue: VecDeque<usize>,
    queued: Vec<bool>,
    /// The linear objective as a row, limited by the cutoff; its number is the row count.
    objective: Objective,
}

/// The row `q'x <= limit` of a linear objective; empty for a quadratic or constant one.
#[derive(Debug, Clone)]
struct Objective {
    columns: Vec<usize>,
    coefficients: Vec<f64>,
    limit: f64,
}

/// Smallest or largest activity of a row: the finite part, and how many terms are infinite.
#[derive(Clone, Copy, Default)]
struct Activity {
    finite: f64,
    infinite: usize,
}

impl Activity {
    fn add(&mut self, term: f64) {
        if term.is_finite() {
            self.finite += term;
        } else {
            self.infinite += 1;
        }
    }

    /// The activity without one of its terms; `None` when it is infinite.
    fn without(&self, term: f64) -> Option<f64> {
        match (self.infinite, term.is_finite()) {
            (0, true) => Some(self.finite - term),
            (1, false) => Some(self.finite),
            _ => None,
        }
    }
}

/// One tightened bound of a row.
struct Tightening {
    column: usize,
    is_upper: bool,
    value: f64,
}

impl Propagator {
    /// For a program.
    pub fn new(program: &Program) -> Self {
        let linear = program.quadratic.compute_nnz() == 0;
        let cost = |j: &usize| linear && program.linear[*j] != 0.0;
        let columns: Vec<usize> = (0..program.column_count()).filter(cost).collect();
        let coefficients = columns.iter().map(|&j| program.linear[j]).collect();
        Propagator {
            queue: VecDeque::new(),
            queued: vec![false; program.row_count() + 1],
            objective: Objective { columns, coefficients, limit: f64::INFINITY },
        }
    }

    /// Makes every later propagation look only for points whose (minimised) objective is at most
    /// `cutoff`, where the objective is linear. What is then refuted is refuted *up to the
    /// cutoff*. Returns the cutoff in force: infinite for other objectives.
    pub fn set_cutoff(&mut self, program: &Program, cutoff: f64) -> f64 {
        if self.objective.columns.is_empty() {
            return f64::INFINITY;
        }
        self.objective.limit = cutoff - program.offset;
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
        for column in domain.changed_since(mark) {
            if domain.lower(column) > domain.upper(column) {
                self.clear();
                return Err(Conflict::Column(column));
            }
            for &row in program.column(column).0 {
                self.enqueue(row);
            }
        }
        if self.objective.limit < f64::INFINITY {
            self.enqueue(program.row_count());
        }
        self.run(program, domain)
    }

    fn enqueue(&mut self, row: usize) {
        if !self.queued[row] {
            self.queued[row] = true;
            self.queue.push_back(row);
        }
    }

    fn clear(&mut self) {
        for row in self.queue.drain(..) {
            self.queued[row] = false;
        }
    }

    fn run(&mut self, program: &Program, domain: &mut Domain) -> Result<(), Conflict> {
        let mut found = Vec::new();
        // A cap on the work: long chains of shrinking gains add nothing that a relaxation lacks.
        let mut budget = 50 * (program.row_count() + 100);
        while let Some(row) = self.queue.pop_front() {
            self.queued[row] = false;
            if budget == 0 {
                self.clear();
                break;
            }
            budget -= 1;
            let tightened = if row < program.row_count() {
                let (columns, coefficients) = program.row(row);
                let limits = Interval::new(program.row_lower[row], program.row_upper[row]);
                tighten(program, domain, row, (columns, coefficients), limits, &mut found)
            } else {
                let terms = (&self.objective.columns[..], &self.objective.coefficients[..]);
                let limits = Interval::new(f64::NEG_INFINITY, self.objective.limit);
                tighten(program, domain, row, terms, limits, &mut found)
            };
            if let Err(conflict) = tightened {
                self.clear();
                return Err(conflict);
            }
            for Tightening { column, is_upper, value } in found.drain(..) {
                if is_upper {
                    domain.set_upper(column, value);
                } else {
                    domain.set_lower(column, value);
                }
                if let Err(conflict) = settle(program, domain, column) {
                    self.clear();
                    return Err(conflict);
                }
                for &other in program.column(column).0 {
                    if other != row {
                        self.enqueue(other);
                    }
                }
                let objective = program.row_count();
                let limited = self.objective.limit < f64::INFINITY && row != objective;
                if limited && program.linear[column] != 0.0 {
                    self.enqueue(objective);
                }
            }
        }
        Ok(())
    }
}

/// Brings slightly crossed bounds of a column back together, or reports the conflict.
fn settle(program: &Program, domain: &mut Domain, column: usize) -> Result<(), Conflict> {
    let (lower, upper) = (domain.lower(column), domain.upper(column));
    if lower <= upper {
        return Ok(());
    }
    let scale = lower.abs().max(upper.abs()).max(1.0);
    if program.integral[column] || lower - upper > tolerance::PROPAGATION_INFEASIBLE * scale {
        return Err(Conflict::Column(column));
    }
    let middle = 0.5 * (lower + upper);
    domain.set_lower(column, middle);
    domain.set_upper(column, middle);
    Ok(())
}

/// Finds the bounds that one row tightens.
fn tighten(
    program: &Program,
    domain: &Domain,
    row: usize,
    (columns, coefficients): (&[usize], &[f64]),
    limits: Interval,
    found: &mut Vec<Tightening>,
) -> Result<(), Conflict> {
    let (row_lower, row_upper) = (limits.lower, limits.upper);
    let (mut least, mut most, mut scale) = (Activity::default(), Activity::default(), 0.0_f64);
    for (&j, &a) in columns.iter().zip(coefficients) {
        let (low, high) = ends(domain, j, a);
        least.add(low);
        most.add(high);
        let size = if low.is_finite() { low.abs() } else { 0.0 };
        scale += size.max(if high.is_finite() { high.abs() } else { 0.0 });
    }
    let size = |limit: f64| if limit.is_finite() { limit.abs() } else { 0.0 };
    let scale = scale.max(size(row_lower)).max(size(row_upper)).max(1.0);
    let excess = tolerance::PROPAGATION_INFEASIBLE * scale;
    if (least.infinite == 0 && least.finite > row_upper + excess)
        || (most.infinite == 0 && most.finite < row_lower - excess)
    {
        return Err(Conflict::Row(row));
    }
    let upper_binds = row_upper.is_finite() && (most.infinite > 0 || most.finite > row_upper);
    let lower_binds = row_lower.is_finite() && (least.infinite > 0 || least.finite < row_lower);
    if !upper_binds && !lower_binds {
        return Ok(());
    }
    // Accumulated rounding of the activity, in the row's unit.
    let rounding = 1e-15 * scale * (columns.len() as f64);
    for (&j, &a) in columns.iter().zip(coefficients) {
        if domain.is_fixed(j) {
            continue;
        }
        let (low, high) = ends(domain, j, a);
        if upper_binds && let Some(rest) = least.without(low) {
            offer(program, domain, j, a > 0.0, (row_upper - rest + rounding) / a, found);
        }
        if lower_binds && let Some(rest) = most.without(high) {
            offer(program, domain, j, a < 0.0, (row_lower - rest - rounding) / a, found);
        }
    }
    Ok(())
}

/// Smallest and largest value of `a * x_j`.
fn ends(domain: &Domain, j: usize, a: f64) -> (f64, f64) {
    let (p, q) = (a * domain.lower(j), a * domain.upper(j));
    if a > 0.0 { (p, q) } else { (q, p) }
}

/// Notes a candidate bound when it is worth it.
fn offer(
    program: &Program,
    domain: &Domain,
    column: usize,
    is_upper: bool,
    value: f64,
    found: &mut Vec<Tightening>,
) {
    if !value.is_finite() || value.abs() >= tolerance::INFINITE {
        return;
    }
    let (lower, upper) = (domain.lower(column), domain.upper(column));
    let value = if program.integral[column] {
        let value = if is_upper {
            (value + tolerance::INTEGRALITY).floor()
        } else {
            (value - tolerance::INTEGRALITY).ceil()
        };
        if if is_upper { value >= upper } else { value <= lower } {
            return;
        }
        value
    } else {
        let slack = tolerance::PROPAGATION_SLACK * value.abs().max(1.0);
        let value = if is_upper { value + slack } else { value - slack };
        let gain = if is_upper { upper - value } else { value - lower };
        let width = upper - lower;
        let worth = if width.is_finite() {
            (tolerance::PROPAGATION_GAIN * width).max(10.0 * slack)
        } else {
            1e-3 * value.abs().max(1.0)
        };
        if gain.is_nan() || gain <= worth {
            return;
        }
        value
    };
    found.push(Tightening { column, is_upper, value });
}
