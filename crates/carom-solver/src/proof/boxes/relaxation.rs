//! Sums of facts, and of rows that enclose functions, that close a box.

use super::{BoxNode, BoxProver};
use crate::presolve::{Domain, Reduced};
use crate::proof::bounds::Side;
use crate::proof::claim::Claim;
use crate::proof::cones::ConeRow;
use crate::proof::relaxed::FactRefutation;
use crate::proof::tree::Limit;
use crate::relaxation::{ConeCut, Purpose, RelaxationQuestion, RelaxationVerdict, WarmState};
use crate::spatial::{CONE_MISS, EnclosureRow, ROW_NAMES, Shape, rows, separate};
use crate::tolerance::largest_magnitude;

/// Most rounds of rows at the root, and at other boxes.
const ROUNDS: [usize; 2] = [20, 5];

/// The lift of the bound by a round, as a part of the gap, below which no other one follows.
const LEAST_ROW_LIFT: f64 = 0.01;

/// By how much a row of a function is loosened, relative to its terms (no unit): a checker encloses
/// the function with a rounding of its own.
const LOOSE_ROW: f64 = 1e-11;

/// Most rows of cones that all relaxations begin with.
const MOST_CONE_ROWS: usize = 300;

/// A row of a relaxation that is no fact of the context.
#[derive(Debug, Clone)]
pub(super) enum BoxRow {
    /// A row about a function over the present box.
    Function(usize, EnclosureRow),
    /// A row that holds in a cone.
    Cone(ConeRow),
}

/// A sum of facts that closes a box. The rows of functions are the facts behind those of the
/// context.
#[derive(Debug)]
pub(super) struct BoxClosing {
    pub(super) rows: Vec<BoxRow>,
    pub(super) found: FactRefutation,
}

/// A box that its relaxation does not close.
#[derive(Debug)]
pub(super) struct OpenBox {
    pub(super) bound: f64,
    pub(super) x: Option<Vec<f64>>,
    pub(super) warm: Option<WarmState>,
    /// The sum that proves the bound, as far as there is one.
    pub(super) sum: Option<BoxClosing>,
}

#[derive(Debug)]
pub(super) enum BoxOutcome {
    Closed(BoxClosing),
    Open(OpenBox),
}

/// The relaxation of a box: its program, and the rows of functions in it.
pub(super) struct RelaxedProgram {
    pub(super) reduced: Reduced,
    pub(super) rows: Vec<BoxRow>,
    counts: Vec<usize>,
}

impl BoxProver<'_, '_> {
    /// The relaxation of the present box, with rows that are tight at a point.
    pub(super) fn relaxation(&self, domain: &Domain, at: Option<&[f64]>) -> RelaxedProgram {
        let mut reduced = self.of.base.clone();
        for j in 0..domain.column_count() {
            [reduced.lower[j], reduced.upper[j]] = domain.bounds(j);
        }
        if self.relaxer.claim == Claim::Infeasible {
            reduced.linear.fill(0.0);
        }
        reduced.wants_vertex = true;
        let counts = vec![0; self.of.terms.len()];
        let mut relaxed = RelaxedProgram { reduced, rows: Vec::new(), counts };
        for row in &self.cone_rows {
            self.push_cone_row(&mut relaxed, row.clone());
        }
        for (function, term) in self.of.terms.iter().enumerate() {
            for row in rows(term, domain, at) {
                self.push(&mut relaxed, domain, function, row);
            }
        }
        relaxed
    }

    fn push(
        &self,
        relaxed: &mut RelaxedProgram,
        domain: &Domain,
        function: usize,
        mut row: EnclosureRow,
    ) {
        let term = &self.of.terms[function];
        match &term.shape {
            Shape::Elementary { of, .. } => {
                if term.result == *of {
                    return;
                }
                let [lower, upper] = domain.bounds(*of);
                let reach = [lower, upper].into_iter().filter(|end| end.is_finite());
                let reach = reach.fold(0.0, |most: f64, end| most.max(end.abs()));
                let limit = if row.lower.is_finite() { row.lower } else { row.upper };
                let size = limit.abs() + row.slopes[0].abs() * reach;
                let spare = LOOSE_ROW * size + f64::MIN_POSITIVE;
                row.lower -= spare;
                row.upper += spare;
            }
            // Sums of coefficients of one column are rounded.
            Shape::Bilinear([a, b]) | Shape::Quotient([a, b]) => {
                if a == b || term.result == *a || term.result == *b {
                    return;
                }
            }
        }
        let reduced = &mut relaxed.reduced;
        reduced.rows.push(row.entries.iter().copied());
        reduced.row_lower.push(row.lower);
        reduced.row_upper.push(row.upper);
        let count = &mut relaxed.counts[function];
        let first = self.of.program.row_count() + function * ROW_NAMES;
        reduced.origin.push(first + (*count).min(ROW_NAMES - 1));
        *count += 1;
        relaxed.rows.push(BoxRow::Function(function, row));
    }

    fn push_cone_row(&self, relaxed: &mut RelaxedProgram, row: ConeRow) {
        let reduced = &mut relaxed.reduced;
        reduced.rows.push(row.terms(&self.of.program));
        reduced.row_lower.push(0.0);
        reduced.row_upper.push(f64::INFINITY);
        reduced.origin.push(usize::MAX);
        relaxed.rows.push(BoxRow::Cone(row));
    }

    /// Cuts off the cones that a point is outside of. Whether there is one.
    fn cut_cones(&mut self, relaxed: &mut RelaxedProgram, x: &[f64]) -> bool {
        let mut is_new = false;
        for (k, cone) in self.of.cones.iter().enumerate() {
            let Some(cut) = ConeCut::at(cone, x) else { continue };
            if cut.violation(x) <= CONE_MISS * largest_magnitude(x).max(1.0) {
                continue;
            }
            if let Some(row) = ConeRow::of(&cut, k, &self.of.program) {
                if self.cone_rows.len() < MOST_CONE_ROWS {
                    self.cone_rows.push(row.clone());
                }
                self.push_cone_row(relaxed, row);
                is_new = true;
            }
        }
        is_new
    }

    /// The facts behind the rows of a relaxation, with their multipliers in the log.
    pub(super) fn gather(&self, y: &[f64], last: Option<usize>) -> FactRefutation {
        let (rows, first) = (self.of.program.row_count(), self.facts.len());
        let mut found = FactRefutation::default();
        for (k, &multiplier) in y.iter().enumerate().filter(|(_, y)| **y != 0.0) {
            let (fact, multiplier) = match k.checked_sub(rows) {
                None => (k, -multiplier),
                Some(own) if last == Some(own) => (self.relaxer.objective[0].fact, -multiplier),
                Some(own) => (first + own, -multiplier),
            };
            found.facts.push((fact, multiplier));
        }
        found
    }

    /// Adds the rows of functions to the facts, for sums of them.
    pub(super) fn lend(&mut self, rows: &[BoxRow]) {
        for row in rows {
            match row {
                BoxRow::Function(_, row) => {
                    self.facts.push(row.entries.iter().copied(), [row.lower, row.upper]);
                }
                BoxRow::Cone(row) => {
                    self.facts.push(row.terms(&self.of.program), [0.0, f64::INFINITY]);
                }
            }
        }
    }

    /// Removes multipliers of sides that facts do not have.
    pub(super) fn keep_sides(&self, found: &mut FactRefutation) {
        found.facts.retain(|&(fact, y)| {
            let [lower, upper] = self.facts.limits(fact);
            let side = if y > 0.0 { lower } else { upper };
            side.is_finite()
        });
    }

    /// Relaxes the present box, in rounds.
    pub(super) fn relax(&mut self, node: &BoxNode) -> Result<BoxOutcome, Limit> {
        let domain = self.domain();
        let at = node.x.as_ref().map(|x| x.as_slice());
        let mut relaxed = self.relaxation(&domain, at);
        let cutoff = match self.relaxer.claim {
            Claim::Bound(bound) => bound,
            Claim::Infeasible => f64::INFINITY,
        };
        let rounds = ROUNDS[usize::from(!node.is_root)];
        let bound = f64::NEG_INFINITY;
        let mut open = OpenBox { bound, x: None, warm: node.warm.clone(), sum: None };
        let known = self.facts.len();
        for round in 0..=rounds {
            let question = RelaxationQuestion {
                purpose: if open.warm.is_some() { Purpose::Node } else { Purpose::Root },
                cutoff,
                options: self.relaxer.options,
                constant: self.of.program.constant,
                look_for_descent: false,
                token: self.relaxer.token,
                warm: open.warm.as_ref(),
            };
            let verdict = self.relaxer.cascade.solve(&mut relaxed.reduced, &question);
            let (bound, x, y, converged, state) = match verdict {
                RelaxationVerdict::Refuted(y) => {
                    let mut found = self.gather(&y, None);
                    self.lend(&relaxed.rows);
                    self.keep_sides(&mut found);
                    let is_closed = self.relaxer.closes(&self.facts, &self.bounds, &mut found);
                    self.facts.truncate(known);
                    if is_closed {
                        return Ok(BoxOutcome::Closed(BoxClosing { rows: relaxed.rows, found }));
                    }
                    break;
                }
                RelaxationVerdict::Stopped if self.relaxer.token.is_over() => return Err(Limit),
                RelaxationVerdict::Stopped | RelaxationVerdict::Descent => break,
                RelaxationVerdict::Relaxed { bound, x, y, converged, warm } => {
                    (bound, x, y, converged, warm)
                }
            };
            let last = open.bound;
            open.warm = state.or(open.warm.take());
            let point = converged.then(|| relaxed.reduced.lift(&x));
            open.x = point.clone().or(open.x.take());
            if bound >= last && !y.is_empty() {
                open.bound = bound;
                let mut found = self.gather(&y, None);
                self.lend(&relaxed.rows);
                self.keep_sides(&mut found);
                let is_closed = bound > cutoff
                    && self
                        .relaxer
                        .check_objective(&self.facts, &self.bounds, &mut found)
                        .is_some();
                self.facts.truncate(known);
                let closing = BoxClosing { rows: relaxed.rows.clone(), found };
                if is_closed {
                    return Ok(BoxOutcome::Closed(closing));
                }
                open.sum = Some(closing);
            }
            let room = if cutoff.is_finite() { cutoff - last } else { last.abs().max(1.0) };
            let is_enough = round > 1 && bound - last < LEAST_ROW_LIFT * room;
            let Some(point) = point.filter(|_| !is_enough) else { break };
            let mut is_new = self.cut_cones(&mut relaxed, &point);
            for (function, term) in self.of.terms.iter().enumerate() {
                let size = point[term.result].abs().max(1.0);
                if term.violation(&point) > 1e-7 * size
                    && let Some(row) = separate(term, &domain, &point)
                {
                    self.push(&mut relaxed, &domain, function, row);
                    is_new = true;
                }
            }
            if !is_new {
                break;
            }
        }
        Ok(BoxOutcome::Open(open))
    }

    /// Writes a sum that closes the context, with the bounds and rows that it needs.
    pub(super) fn write_closing(&mut self, closing: &BoxClosing) {
        self.write_sum(&closing.rows, &closing.found, 0);
    }

    /// Writes a sum, behind so many further facts of the context.
    pub(super) fn write_sum(&mut self, rows: &[BoxRow], found: &FactRefutation, further: usize) {
        let known = self.facts.len();
        let mut used: Vec<usize> =
            found.facts.iter().filter_map(|(fact, _)| fact.checked_sub(known)).collect();
        used.sort_unstable();
        let mut sides: Vec<Side> = found.sides.clone();
        for &k in &used {
            let BoxRow::Function(function, _) = &rows[k] else { continue };
            let term = &self.of.terms[*function];
            let columns = match &term.shape {
                Shape::Elementary { of, .. } => vec![*of],
                Shape::Bilinear([a, b]) => vec![*a, *b],
                Shape::Quotient([_, b]) => vec![term.result, *b],
            };
            sides.extend(columns.into_iter().flat_map(|j| [(j, false), (j, true)]));
        }
        self.write_bounds(sides.into_iter());
        for &k in &used {
            let (function, row) = match &rows[k] {
                BoxRow::Function(function, row) => (function, row),
                BoxRow::Cone(row) => {
                    self.log.cone_row(row.cone, &row.head, &row.tail);
                    continue;
                }
            };
            let is_upper = row.upper.is_finite();
            let value = if is_upper { row.upper } else { row.lower };
            let count = match &self.of.terms[*function].shape {
                Shape::Elementary { .. } => 1,
                _ => 2,
            };
            self.log.enclosure(*function, is_upper, value, &row.slopes[..count]);
        }
        let number = |fact: usize| match fact.checked_sub(known) {
            None => fact,
            Some(own) => known + further + used.partition_point(|k| *k < own),
        };
        let sum: Vec<(usize, f64)> =
            found.facts.iter().map(|&(fact, y)| (number(fact), y)).collect();
        self.log.contradiction(sum.into_iter());
    }
}
