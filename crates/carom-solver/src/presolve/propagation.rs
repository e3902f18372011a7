//! Activity-based bound propagation.
//!
//! Takes rows, cones and bounds; leaves tighter bounds, or a contradiction (Davis, Constraint
//! propagation with interval labels, Artificial Intelligence 32, 1987).
//!
//! For a row `l <= a'x <= u` the smallest and the largest activity over the current bounds limit
//! every column in it. A second-order cone bounds its columns likewise. The rows of tightened
//! columns go back on a worklist until no bound moves enough. Its order is in `worklist`, the
//! arithmetic of one row in `tightening`, that of one cone in `conic_tightening`.

use super::change_log::{ChangeLog, RowBlockSet};
use super::congruence::{is_whole_equality, tighten_residues};
use super::conic_tightening::{BoundedColumns, tighten_cone};
use super::domain::Domain;
use super::implications::ImplicationGraph;
use super::tightening::{Entry, PropagatedRow, RowState, Tightening, tighten};
use super::worklist::Worklist;
use crate::program::{Cone, Program};
use crate::solver::StopToken;
use crate::tolerance;

/// Proof of infeasibility by propagation: the row or column at which it surfaced.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Conflict {
    /// A row cannot be satisfied within the bounds; the row count stands for the objective's limit.
    Row(usize),
    /// A cone cannot be satisfied within the bounds.
    Cone(usize),
    /// A column's bounds crossed, or contradict what is known of it.
    Column(usize),
}

/// The worklist of propagation; one per program and thread, reused over all nodes.
///
/// Rows and columns are copied in a compact form: propagation is bound by memory, and most visits
/// of a row end after one pass over its entries.
#[derive(Debug, Clone)]
pub struct Propagator {
    queue: Worklist,
    status: Vec<Status>,
    /// Rows that cannot bind, and the trail position from which on that is so.
    asleep: Vec<(usize, usize)>,
    /// The program's rows, then the linear objective, limited by the cutoff.
    pub(super) rows: Vec<PropagatedRow>,
    pub(super) entries: Vec<Entry>,
    uses: Uses,
    found: Vec<Tightening>,
    /// Columns whose implications are still to be followed, the next one last.
    unfollowed: Vec<usize>,
    pub(super) implications: ImplicationGraph,
    token: StopToken,
    pub(super) change_log: ChangeLog,
    /// The least gain of a bound of a continuous column, as a part of its width, that is followed.
    pub(super) least_gain: f64,
}

/// The status of a row in the worklist.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Status {
    Idle,
    Queued,
    /// It cannot bind, whatever else is tightened.
    Asleep,
}

/// By column: the rows to which its bounds can matter.
#[derive(Debug, Clone, Default)]
struct Uses {
    /// By column and bound, the lower one first: where its rows begin, and the end of all.
    start: Vec<usize>,
    rows: Vec<u32>,
    /// By column: the blocks of all its rows.
    blocks: Vec<RowBlockSet>,
}

impl Uses {
    /// The uses of columns in lines, the last of which is the objective, whose upper limit comes
    /// later, and in cones, whose numbers follow.
    fn new(
        columns: usize,
        lines: &[PropagatedRow],
        entries: &[Entry],
        cones: &[Cone],
        change_log: &ChangeLog,
    ) -> Self {
        let mut blocks = vec![0; columns];
        for (row, line) in lines.iter().enumerate() {
            for entry in &entries[line.range[0]..line.range[1]] {
                blocks[entry.column()] |= change_log.blocks_of(row);
            }
        }
        for (number, cone) in (lines.len()..).zip(cones) {
            cone.columns.iter().for_each(|&j| blocks[j] |= change_log.blocks_of(number));
        }
        let mut start = vec![0; 2 * columns + 1];
        each_use(lines, entries, |k, _| start[k + 1] += 1);
        each_conic_use(lines.len(), cones, |k, _| start[k + 1] += 1);
        (0..2 * columns).for_each(|k| start[k + 1] += start[k]);
        let mut rows = vec![0; start[2 * columns]];
        // Every beginning moves to its end, which is where the next one began.
        let mut place = |k: usize, row: usize| {
            rows[start[k]] = row as u32;
            start[k] += 1;
        };
        each_use(lines, entries, &mut place);
        each_conic_use(lines.len(), cones, &mut place);
        start.rotate_right(1);
        start[0] = 0;
        Uses { start, rows, blocks }
    }

    /// The rows to which a bound of a column matters.
    fn of(&self, column: usize, is_upper: bool) -> &[u32] {
        let k = 2 * column + usize::from(is_upper);
        &self.rows[self.start[k]..self.start[k + 1]]
    }
}

/// Each bound (twice the column, and 1 for the upper one) with each row to which it can matter.
fn each_use(lines: &[PropagatedRow], entries: &[Entry], mut note: impl FnMut(usize, usize)) {
    for (row, line) in lines.iter().enumerate() {
        let is_objective = row + 1 == lines.len();
        // The least activity meets the upper limit, the largest one the lower limit.
        let least = is_objective || line.limits[1].is_finite();
        let most = line.limits[0].is_finite();
        for entry in &entries[line.range[0]..line.range[1]] {
            let positive = entry.coefficient > 0.0;
            let matters = if positive { [least, most] } else { [most, least] };
            for side in [0, 1].into_iter().filter(|&side| matters[side]) {
                note(2 * entry.column() + side, row);
            }
        }
    }
}

/// Each bound of a column with each cone to which it can matter; the first cone has the number
/// `first`.
fn each_conic_use(first: usize, cones: &[Cone], mut note: impl FnMut(usize, usize)) {
    for (number, cone) in (first..).zip(cones) {
        cone.head().iter().for_each(|&j| note(2 * j + 1, number));
        for &j in cone.tail() {
            note(2 * j, number);
            note(2 * j + 1, number);
        }
    }
}

impl Propagator {
    /// For a program.
    pub fn new(program: &Program) -> Self {
        let numbers = program.row_count() + 1 + program.cones.len();
        let mut propagator = Propagator {
            queue: Worklist::new(numbers),
            status: vec![Status::Idle; numbers],
            asleep: Vec::new(),
            rows: Vec::with_capacity(program.row_count() + 1),
            entries: Vec::new(),
            uses: Uses::default(),
            found: Vec::new(),
            unfollowed: Vec::new(),
            implications: ImplicationGraph::default(),
            token: StopToken::default(),
            change_log: ChangeLog::new(program.row_count() + program.cones.len()),
            least_gain: tolerance::PROPAGATION_GAIN,
        };
        for row in 0..program.row_count() {
            let limits = [program.row_lower[row], program.row_upper[row]];
            let (columns, coefficients) = program.row(row);
            let terms = columns.iter().copied().zip(coefficients.iter().copied());
            propagator.add(terms, limits, &program.integral);
        }
        // A quadratic objective is no row; its line stays empty.
        let linear = program.quadratic.compute_nnz() == 0;
        let costs = program.linear.iter().copied().enumerate().filter(|_| linear);
        propagator.add(costs, [f64::NEG_INFINITY, f64::INFINITY], &program.integral);
        let Propagator { rows, entries, change_log, .. } = &propagator;
        propagator.uses =
            Uses::new(program.column_count(), rows, entries, &program.cones, change_log);
        propagator
    }

    fn add(
        &mut self,
        terms: impl Iterator<Item = (usize, f64)>,
        limits: [f64; 2],
        integral: &[bool],
    ) {
        let start = self.entries.len();
        let entries = terms.filter(|(_, a)| *a != 0.0);
        self.entries.extend(entries.map(|(column, a)| Entry::new(column, a, integral[column])));
        let range = [start, self.entries.len()];
        let mut line = PropagatedRow { range, limits, whole_equality: false };
        line.whole_equality = is_whole_equality(&line, &self.entries[start..]);
        self.rows.push(line);
    }

    /// The table of implications that propagation follows.
    pub fn implications(&self) -> &ImplicationGraph {
        &self.implications
    }

    /// Makes every later propagation follow a table of implications as well.
    pub fn set_implications(&mut self, implications: ImplicationGraph) {
        self.implications = implications;
    }

    /// Makes every later propagation end when the token is over. What is concluded until then
    /// holds; what is not may be missing.
    pub fn set_stop_token(&mut self, token: &StopToken) {
        self.token = token.clone();
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
        self.wake(domain);
        (0..program.row_count()).for_each(|row| self.enqueue(row));
        (self.rows.len()..self.status.len()).for_each(|cone| self.enqueue(cone));
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
        self.wake(domain);
        for (column, is_upper) in domain.changed_since(mark) {
            if domain.lower(column) > domain.upper(column) {
                self.clear();
                return Err(Conflict::Column(column));
            }
            self.enqueue_uses(column, is_upper, usize::MAX);
        }
        if !self.implications.is_empty() {
            self.unfollowed.extend(domain.changed_since(mark).map(|(j, _)| j));
            self.unfollowed.reverse();
            self.follow(program, domain).inspect_err(|_| self.clear())?;
        }
        let objective = self.objective();
        if self.rows[objective].limits[1] < f64::INFINITY {
            self.enqueue(objective);
        }
        self.run(program, domain)
    }

    /// Sets whether changes from here on are on trial and will be undone.
    pub fn set_on_trial(&mut self, on_trial: bool) {
        self.change_log.set_on_trial(on_trial);
    }

    /// Notes that the bounds of these columns have changed.
    pub fn touch(&mut self, columns: impl Iterator<Item = (usize, bool)>) {
        columns.for_each(|(column, _)| self.change_log.touch(self.uses.blocks[column]));
    }

    /// The number of the objective's line: the last one.
    fn objective(&self) -> usize {
        self.rows.len() - 1
    }

    fn enqueue(&mut self, row: usize) {
        if self.status[row] == Status::Idle {
            self.status[row] = Status::Queued;
            self.queue.insert(row);
        }
    }

    /// Puts the rows on the list to which a changed bound can matter, but for the one that changed
    /// it.
    fn enqueue_uses(&mut self, column: usize, is_upper: bool, changed_by: usize) {
        self.change_log.touch(self.uses.blocks[column]);
        for &row in self.uses.of(column, is_upper) {
            let row = row as usize;
            if row != changed_by && self.status[row] == Status::Idle {
                self.status[row] = Status::Queued;
                self.queue.insert(row);
            }
        }
    }

    fn clear(&mut self) {
        self.unfollowed.clear();
        let status = &mut self.status;
        self.queue.drain(|row| status[row] = Status::Idle);
    }

    /// Makes rows idle that were put to sleep by bounds that have been undone since the last
    /// propagation.
    fn wake(&mut self, domain: &mut Domain) {
        let undone = domain.undone_to();
        while let Some(&(row, since)) = self.asleep.last() {
            if undone.is_some_and(|mark| since <= mark) {
                break;
            }
            self.status[row] = Status::Idle;
            self.asleep.pop();
        }
    }

    /// Fixes what binaries that have become fixed imply, and what that implies.
    fn follow(&mut self, program: &Program, domain: &mut Domain) -> Result<(), Conflict> {
        while let Some(j) = self.unfollowed.pop() {
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
                    self.unfollowed.push(column);
                }
            }
        }
        Ok(())
    }

    /// Propagates the rows on the list.
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
        let objective = self.objective();
        let mut budget = 50 * (self.status.len() + 99);
        while let Some(row) = self.queue.pop() {
            self.status[row] = Status::Idle;
            if row > objective {
                if budget == 0 || !self.visit_cone(program, domain, found, row)? {
                    self.clear();
                    break;
                }
                budget -= 1;
                continue;
            }
            let PropagatedRow { range: [start, end], limits, whole_equality } = self.rows[row];
            if budget == 0 || self.token.spend(1 + end - start) {
                self.clear();
                break;
            }
            budget -= 1;
            self.change_log.visit(row);
            let entries = &self.entries[start..end];
            match tighten(&program.integral, domain.all(), entries, limits, self.least_gain, found)
            {
                RowState::Violated => return Err(Conflict::Row(row)),
                RowState::Implied if row != objective => {
                    self.status[row] = Status::Asleep;
                    self.asleep.push((row, domain.mark()));
                }
                RowState::Implied | RowState::Open => {}
            }
            self.apply(program, domain, found, row)?;
            if whole_equality {
                let entries = &self.entries[start..end];
                if !tighten_residues(domain.all(), entries, limits[0], found) {
                    return Err(Conflict::Row(row));
                }
                // The row itself may say more then.
                self.apply(program, domain, found, usize::MAX)?;
            }
        }
        Ok(())
    }

    /// Propagates a cone, unless the token is over.
    #[cold]
    fn visit_cone(
        &mut self,
        program: &Program,
        domain: &mut Domain,
        found: &mut Vec<Tightening>,
        number: usize,
    ) -> Result<bool, Conflict> {
        let index = number - self.rows.len();
        let Some(cone) = program.cones.get(index) else { return Ok(true) };
        if self.token.spend(1 + cone.columns.len()) {
            return Ok(false);
        }
        self.change_log.visit(number);
        let columns = BoundedColumns { integral: &program.integral, bounds: domain.all() };
        match tighten_cone(columns, cone, self.least_gain, found) {
            RowState::Violated => return Err(Conflict::Cone(index)),
            RowState::Implied => {
                self.status[number] = Status::Asleep;
                self.asleep.push((number, domain.mark()));
            }
            RowState::Open => {}
        }
        self.apply(program, domain, found, number)?;
        Ok(true)
    }

    /// Applies what was found of a row, and what follows from implications.
    fn apply(
        &mut self,
        program: &Program,
        domain: &mut Domain,
        found: &mut Vec<Tightening>,
        changed_by: usize,
    ) -> Result<(), Conflict> {
        for Tightening { column, is_upper, value } in found.drain(..) {
            domain.apply(column, is_upper, value);
            let settled = settle(program, domain, column)?;
            self.enqueue_uses(column, is_upper, changed_by);
            if settled {
                self.enqueue_uses(column, !is_upper, changed_by);
            }
            if program.integral[column] && !self.implications.is_empty() {
                self.unfollowed.push(column);
                self.follow(program, domain)?;
            }
        }
        Ok(())
    }
}

/// Brings slightly crossed bounds of a column back together (`true` when it did), or reports the
/// conflict.
pub(super) fn settle(
    program: &Program,
    domain: &mut Domain,
    column: usize,
) -> Result<bool, Conflict> {
    let [lower, upper] = domain.bounds(column);
    if lower <= upper {
        return Ok(false);
    }
    let scale = lower.abs().max(upper.abs()).max(1.0);
    if program.integral[column] || lower - upper > tolerance::PROPAGATION_INFEASIBLE * scale {
        return Err(Conflict::Column(column));
    }
    let middle = 0.5 * (lower + upper);
    domain.apply(column, false, middle);
    domain.apply(column, true, middle);
    Ok(true)
}
