//! Bounds of columns as lemmas: the range of a column over the relaxation of the root, and what the
//! multipliers of a box leave.

use super::BoxProver;
use super::relaxation::{BoxClosing, OpenBox, RelaxedProgram};
use crate::proof::bounds::Clash;
use crate::proof::relaxed::FactRefutation;
use crate::proof::tree::Limit;
use crate::relaxation::{Purpose, RelaxationQuestion, RelaxationVerdict, WarmState};

/// Most passes over all columns at the root.
const ROOT_PASSES: usize = 3;

/// The part of its range that a column has to lose for a lemma.
const LEAST_ROOT_GAIN: f64 = 0.02;
const LEAST_LEMMA_GAIN: f64 = 0.1;

/// The part of a range by which a lemma is looser than the relaxation says.
const LOOSE_LEMMA: f64 = 1e-7;

/// Pivots that all passes may take.
const MOST_PIVOTS: u64 = 20_000;

impl BoxProver<'_, '_> {
    /// Minimises and maximises each column that enclosures depend on over the relaxation of the
    /// present box. Whether something moved.
    pub(super) fn tighten_by_relaxations(
        &mut self,
        found: &OpenBox,
    ) -> Result<Result<bool, Clash>, Limit> {
        let columns = match &found.x {
            Some(x) => {
                let off = self.of.misses(x);
                let mut columns: Vec<usize> = (0..off.len()).filter(|&j| off[j] > 1e-7).collect();
                columns.sort_by(|&a, &b| off[b].total_cmp(&off[a]).then(a.cmp(&b)));
                columns
            }
            None => self.of.spatial.clone(),
        };
        let most = self.relaxer.cascade.iterations() + MOST_PIVOTS;
        let (mut moves, mut warm) = (false, None);
        for _ in 0..ROOT_PASSES {
            let mut gains = false;
            for (&column, is_upper) in columns.iter().flat_map(|j| [(j, false), (j, true)]) {
                if self.relaxer.token.is_over() {
                    return Err(Limit);
                }
                if self.relaxer.cascade.iterations() > most {
                    return Ok(Ok(moves));
                }
                let [lower, upper] = self.bounds.of(column);
                if upper - lower <= 1e-6 * lower.abs().max(1.0) {
                    continue;
                }
                if self.tighten_side(column, is_upper, &mut warm) {
                    (moves, gains) = (true, true);
                    if let Err(clash) = self.propagate() {
                        return Ok(Err(clash));
                    }
                }
            }
            if !gains {
                break;
            }
        }
        Ok(Ok(moves))
    }

    /// A bound of a column over the relaxation of the present box, as a lemma. Whether there is
    /// one.
    fn tighten_side(
        &mut self,
        column: usize,
        is_upper: bool,
        warm: &mut Option<WarmState>,
    ) -> bool {
        let domain = self.domain();
        let RelaxedProgram { mut reduced, rows, .. } = self.relaxation(&domain, None);
        let mut last = None;
        if let Some(objective) = self.relaxer.objective.first() {
            last = Some(rows.len());
            reduced.rows.push(self.facts.terms(objective.fact));
            let [lower, upper] = self.facts.limits(objective.fact);
            reduced.row_lower.push(lower);
            reduced.row_upper.push(upper);
            reduced.origin.push(usize::MAX);
        }
        reduced.linear.fill(0.0);
        reduced.linear[column] = if is_upper { -1.0 } else { 1.0 };
        reduced.offset = 0.0;
        let question = RelaxationQuestion {
            purpose: if warm.is_some() { Purpose::Node } else { Purpose::Root },
            cutoff: f64::INFINITY,
            options: self.relaxer.options,
            constant: 0.0,
            look_for_descent: false,
            token: self.relaxer.token,
            warm: warm.as_ref(),
        };
        let verdict = self.relaxer.cascade.solve(&mut reduced, &question);
        let RelaxationVerdict::Relaxed { bound, y, warm: state, .. } = verdict else {
            return false;
        };
        *warm = state.or(warm.take());
        let value = if is_upper { -bound } else { bound };
        if !value.is_finite() || value.abs() > 1e15 {
            return false;
        }
        let found = self.gather(&y, last);
        let closing = BoxClosing { rows, found };
        self.lemma(closing, (column, is_upper, value), LEAST_ROOT_GAIN)
    }

    /// Bounds from the multipliers of a box. Whether something moved.
    pub(super) fn tighten_by_multipliers(&mut self, open: &OpenBox) -> bool {
        let (Some(sum), Some(objective)) = (&open.sum, self.relaxer.objective.first()) else {
            return false;
        };
        let objective = (objective.fact, -1.0);
        let known = self.facts.len();
        self.lend(&sum.rows);
        let facts = sum.found.facts.iter().copied().chain([objective]).collect();
        let mut found = FactRefutation { facts, ..FactRefutation::default() };
        self.keep_sides(&mut found);
        let is_closed = self.relaxer.check(&self.facts, &self.bounds, &mut found).is_some();
        self.facts.truncate(known);
        if is_closed {
            return false;
        }
        let row = &self.relaxer.sum;
        let mut room = -row.limit();
        for &j in row.columns() {
            let (a, [lower, upper]) = (row.coefficient(j), self.bounds.of(j));
            room += if a > 0.0 { a * upper } else { a * lower };
        }
        if !(room.is_finite() && room >= 0.0) {
            return false;
        }
        let mut wanted = Vec::new();
        for &column in row.columns() {
            let (a, [lower, upper]) = (row.coefficient(column), self.bounds.of(column));
            let reach = room / a.abs();
            // The sum is largest at this end, and asks the column to be near it.
            let value = if a > 0.0 { upper - reach } else { lower + reach };
            let is_spatial = self.of.spatial.binary_search(&column).is_ok();
            let is_whole = self.of.program.integral[column];
            if (is_spatial || is_whole) && reach < (1.0 - LEAST_LEMMA_GAIN) * (upper - lower) {
                wanted.push((column, a < 0.0, value));
            }
        }
        let mut moves = false;
        for goal in wanted {
            let own = FactRefutation { facts: found.facts.clone(), ..FactRefutation::default() };
            moves |= self.lemma(
                BoxClosing { rows: sum.rows.clone(), found: own },
                goal,
                LEAST_LEMMA_GAIN,
            );
        }
        moves
    }

    /// Writes that a column is at most, or at least, a value, because a sum of facts contradicts
    /// the reverse. Whether it was written.
    fn lemma(
        &mut self,
        mut closing: BoxClosing,
        (column, is_upper, value): (usize, bool, f64),
        least: f64,
    ) -> bool {
        let [lower, upper] = self.bounds.of(column);
        let width = (upper - lower).min(1e20);
        let is_whole = self.of.program.integral[column];
        let outward = if is_upper { 1.0 } else { -1.0 };
        let loose = value + outward * (LOOSE_LEMMA * width + 1e-9 * value.abs());
        // The bound, and where its negation begins.
        let (value, beyond) = match (is_whole, is_upper) {
            (true, true) => (loose.floor(), loose.floor() + 1.0),
            (true, false) => (loose.ceil(), loose.ceil() - 1.0),
            _ => (loose, loose),
        };
        let gain = if is_upper { upper - value } else { value - lower };
        if gain.is_nan() || gain <= least * width || value < lower || value > upper {
            return false;
        }
        let (known, mark) = (self.facts.len(), self.bounds.mark());
        self.bounds.decide(&self.facts, column, !is_upper, beyond);
        self.lend(&closing.rows);
        self.keep_sides(&mut closing.found);
        let found = &mut closing.found;
        let is_proved = self.relaxer.check(&self.facts, &self.bounds, found).is_some();
        self.facts.truncate(known);
        if is_proved {
            self.log.lemma(is_upper, value, [(column, 1.0)].into_iter());
            self.log.decided(column, !is_upper, beyond, known);
            self.write_sum(&closing.rows, &closing.found, 1);
        }
        self.bounds.undo_to(mark);
        if is_proved {
            let limits = match is_upper {
                true => [f64::NEG_INFINITY, value],
                false => [value, f64::INFINITY],
            };
            let fact = self.facts.push([(column, 1.0)].into_iter(), limits);
            self.bounds.enqueue(fact as u32);
        }
        is_proved
    }
}
