//! Big-M tightening by pairs of rows.
//!
//! Takes rows that a binary switches off, and rows that share columns with them; leaves smaller
//! coefficients of the binary, and tighter limits.
//!
//! If a binary switches a row off, the bounds of the row's columns alone give a weak big-M. In a
//! piecewise-affine system, `x+ - A x - B u` has one value in one mode and another in the other,
//! over the same columns: while the first mode is off, the second is on, and its rows bound the
//! first mode's. So each value of a binary is propagated, and the rest of each of its rows is
//! bounded by a multiple of a linked row, which shares columns with it, plus the bounds of the
//! columns that they do not share. The binary's coefficient and the row's limit are tightened
//! accordingly. With two modes the result is often the convex hull of a step, without the hull's
//! extra columns.

use std::ops::Range;

use super::big_m_witness::{CurrentRows, SoughtLimit, Witness};
use super::domain::Domain;
use super::propagation::Propagator;
use crate::activity::term_ends;
use crate::program::Program;
use crate::solver::StopToken;
use crate::tolerance::{self, finite_size};

/// The largest number of binaries that are propagated at both values.
const MAX_PROBED_BINARIES: usize = 4000;

/// The largest number of terms of a row that is tightened or linked.
const MAX_BIG_M_TERMS: usize = 24;

/// A column links its rows only if it is in at most this many.
const MAX_LINKING_ROWS: usize = 40;

/// The smallest number of continuous columns that linked rows share.
const MIN_SHARED_COLUMNS: usize = 2;

/// The largest number of multiples of a linked row that are tried.
const MAX_MULTIPLIERS: usize = 4;

/// The amount by which a limit stays looser than the bound that was computed, relative to the terms
/// of that bound (no unit), so that rounding cuts off no whole point.
const REACH_MARGIN: f64 = 1e-12;

/// The smallest gain that is used, as a fraction of the coefficient.
const MIN_BIG_M_GAIN: f64 = 1e-3;

/// The smallest gain that is used, in the row's unit.
const MIN_BIG_M_REDUCTION: f64 = 0.1 * tolerance::FEASIBILITY;

/// The largest gain that is used, as a multiple of coefficient and limit. Larger ones come from
/// impossible values.
const MAX_BIG_M_GAIN: f64 = 1e6;

/// The smallest part of a coefficient that remains (no unit).
const MIN_BIG_M_REMAINDER: f64 = 1e-4;

/// A new coefficient below this fraction of the old one and the limit is dropped, which loosens the
/// row by as much. Bounds from propagation are loose by a tenth of it.
const DROPPED_BIG_M: f64 = 1e-8;

/// Shrinks big-Ms to what linked rows allow; returns `None` if none shrinks.
///
/// Columns and rows keep their numbers, and no point with whole integral columns is lost.
pub fn tighten_big_ms(program: &Program, token: &StopToken) -> Option<Program> {
    let mut domain = Domain::new(program);
    let mut propagator = Propagator::new(program);
    propagator.set_stop_token(token);
    // If the bounds contradict each other, the search reports it.
    propagator.propagate_all(program, &mut domain).ok()?;
    let is_open = |j: &usize| domain.bounds(*j) == [0.0, 1.0];
    let open: Vec<usize> =
        program.integers.iter().copied().filter(is_open).take(MAX_PROBED_BINARIES).collect();
    let mut rows = TightenedRows::new(program, &domain);
    let (mut lines, mut linked): (Vec<SwitchedRow>, Vec<usize>) = (Vec::new(), Vec::new());
    for z in open {
        if token.is_over() {
            return None;
        }
        lines.clear();
        linked.clear();
        for &row in program.column(z).0 {
            if rows.is_big_m(row) {
                let begin = linked.len();
                rows.append_linked(row, &mut linked);
                lines.push(SwitchedRow { row, linked: begin..linked.len(), reach: [0.0; 2] });
            }
        }
        if lines.is_empty() {
            continue;
        }
        let mut possible = [false; 2];
        for (value, possible) in possible.iter_mut().enumerate() {
            let mark = domain.mark();
            domain.apply(z, value == 0, value as f64);
            *possible = propagator.propagate_since(program, &mut domain, mark).is_ok();
            rows.witness.forget_sums();
            for line in lines.iter_mut().filter(|_| *possible) {
                line.reach[value] = rows.reach(&domain, line.row, z, &linked[line.linked.clone()]);
            }
            domain.undo_to(mark);
        }
        // A value that cannot be taken is left to probing.
        if possible == [true; 2] {
            lines.iter().for_each(|line| rows.tighten(line.row, z, line.reach));
        }
    }
    let mut tight = rows.into_program()?;
    // The rows are tight for the propagated bounds of binaries, which the program keeps.
    for &j in &program.integers {
        [tight.lower[j], tight.upper[j]] = domain.bounds(j);
    }
    Some(tight)
}

/// A row of the binary in hand.
struct SwitchedRow {
    row: usize,
    /// Where the rows linked to it are.
    linked: Range<usize>,
    /// The largest value of its other terms, by value of the binary.
    reach: [f64; 2],
}

/// The rows while they change.
struct TightenedRows<'a> {
    program: &'a Program,
    /// Coefficients, in the order of the program's.
    values: Vec<f64>,
    limits: Vec<[f64; 2]>,
    changed: bool,
    /// By column, the coefficients of the current row and of the row linked to it.
    line: Vec<f64>,
    linked: Vec<f64>,
    /// By column, whether it is continuous and not fixed.
    moves: Vec<bool>,
    witness: Witness,
    /// Rows that are known to be linked already.
    seen: Vec<bool>,
    /// Memory for the terms of the current row and of the row linked to it.
    terms: Vec<(usize, f64)>,
    linked_terms: Vec<(usize, f64)>,
}

/// A bound that is being added up, with the size of what went into it.
#[derive(Clone, Copy, Default)]
struct Reach {
    sum: f64,
    size: f64,
}

impl Reach {
    fn add(&mut self, term: f64) {
        self.sum += term;
        self.size += term.abs();
    }

    /// Adds the largest value of a term.
    fn add_term(&mut self, a: f64, bounds: [f64; 2]) {
        if a != 0.0 {
            self.add(term_ends(a, bounds)[1]);
        }
    }

    /// The bound with its margin; infinite if there is none.
    fn value(self) -> f64 {
        let value = self.sum + REACH_MARGIN * self.size;
        if value.is_nan() { f64::INFINITY } else { value }
    }
}

impl<'a> TightenedRows<'a> {
    fn new(program: &'a Program, domain: &Domain) -> Self {
        let (n, m) = (program.column_count(), program.row_count());
        let limits = program.row_lower.iter().zip(&program.row_upper);
        let moves: Vec<bool> =
            (0..n).map(|j| !program.integral[j] && !domain.is_fixed(j)).collect();
        let values = program.rows.val().to_vec();
        let rows = CurrentRows { program, values: &values, moves: &moves };
        let witness = Witness::new(rows, domain);
        TightenedRows {
            program,
            values,
            limits: limits.map(|(&lower, &upper)| [lower, upper]).collect(),
            changed: false,
            line: vec![0.0; n],
            linked: vec![0.0; n],
            moves,
            witness,
            seen: vec![false; m],
            terms: Vec::new(),
            linked_terms: Vec::new(),
        }
    }

    /// The terms of a row that are left.
    fn terms(&self, row: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let range = self.program.rows.symbolic().row_range(row);
        let columns = self.program.row(row).0.iter().copied();
        columns.zip(self.values[range].iter().copied()).filter(|(_, a)| *a != 0.0)
    }

    fn len(&self, row: usize) -> usize {
        self.program.row(row).0.len()
    }

    /// Whether a row is short and has one limit.
    fn is_big_m(&self, row: usize) -> bool {
        let [lower, upper] = self.limits[row];
        self.len(row) <= MAX_BIG_M_TERMS && lower.is_finite() != upper.is_finite()
    }

    /// The form `sign * row <= limit` of a row with one limit.
    fn one_side(&self, row: usize) -> (f64, f64) {
        let [lower, upper] = self.limits[row];
        if upper.is_finite() { (1.0, upper) } else { (-1.0, -lower) }
    }

    /// Appends the short rows that share enough continuous columns with a row.
    fn append_linked(&mut self, row: usize, linked: &mut Vec<usize>) {
        let program = self.program;
        if let Some(known) = self.witness.linked(row) {
            return linked.extend_from_slice(known);
        }
        let continuous =
            |row: usize| program.row(row).0.iter().copied().filter(|&j| !program.integral[j]);
        continuous(row).for_each(|j| self.line[j] = 1.0);
        self.seen[row] = true;
        let begin = linked.len();
        for j in continuous(row) {
            let others = program.column(j).0;
            for &other in others.iter().filter(|_| others.len() <= MAX_LINKING_ROWS) {
                if !std::mem::replace(&mut self.seen[other], true) {
                    linked.push(other);
                }
            }
        }
        linked[begin..].iter().chain([&row]).for_each(|&row| self.seen[row] = false);
        let mut kept = begin;
        for k in begin..linked.len() {
            let other = linked[k];
            let shared = continuous(other).filter(|&j| self.line[j] != 0.0).count();
            if shared >= MIN_SHARED_COLUMNS && self.len(other) <= MAX_BIG_M_TERMS {
                linked[kept] = other;
                kept += 1;
            }
        }
        linked.truncate(kept);
        continuous(row).for_each(|j| self.line[j] = 0.0);
        let rows = CurrentRows { program, values: &self.values, moves: &self.moves };
        self.witness.keep_linked(rows, row, &linked[begin..]);
    }

    /// The largest value in a domain of a row without one of its columns, as `<=`.
    fn reach(&mut self, domain: &Domain, row: usize, except: usize, linked: &[usize]) -> f64 {
        let (sign, limit) = self.one_side(row);
        let mut terms = std::mem::take(&mut self.terms);
        terms.clear();
        terms.extend(self.terms(row).filter(|(j, _)| *j != except).map(|(j, a)| (j, sign * a)));
        let mut alone = Reach::default();
        for &(j, a) in &terms {
            alone.add_term(a, domain.bounds(j));
            self.line[j] = a;
        }
        let mut best = alone.value();
        let sought = SoughtLimit { row, sign, limit };
        let rows = CurrentRows { program: self.program, values: &self.values, moves: &self.moves };
        let step = self.witness.step(rows, domain, sought);
        for (k, &other) in linked.iter().enumerate() {
            let limits = self.limits[other];
            let rows =
                CurrentRows { program: self.program, values: &self.values, moves: &self.moves };
            let has_point = step.is_some_and(|step| {
                self.witness.satisfies(rows, domain, (sought, step), k, limits)
            });
            if !has_point {
                best = best.min(self.reach_with(domain, &terms, other));
            }
        }
        terms.iter().for_each(|&(j, _)| self.line[j] = 0.0);
        self.terms = terms;
        best
    }

    /// The same, by multiples of a linked row that cancel one of the shared columns.
    fn reach_with(&mut self, domain: &Domain, terms: &[(usize, f64)], other: usize) -> f64 {
        let mut beside = std::mem::take(&mut self.linked_terms);
        beside.clear();
        beside.extend(self.terms(other));
        beside.iter().for_each(|&(j, c)| self.linked[j] = c);
        let [lower, upper] = self.limits[other];
        let (mut best, mut tried, mut count) = (f64::INFINITY, [0.0; MAX_MULTIPLIERS], 0);
        for &(j, c) in beside.iter().filter(|(j, _)| !self.program.integral[*j]) {
            // `factor * linked <= factor * limit`.
            let factor = self.line[j] / c;
            let limit = if factor > 0.0 { upper } else { lower };
            if factor == 0.0 || !limit.is_finite() || tried.contains(&factor) {
                continue;
            }
            let Some(place) = tried.get_mut(count) else { break };
            *place = factor;
            count += 1;
            let mut reach = Reach::default();
            reach.add(factor * limit);
            for &(k, a) in terms.iter().filter(|(k, _)| self.linked[*k] == 0.0) {
                reach.add_term(a, domain.bounds(k));
            }
            for &(k, c) in &beside {
                // Terms that cancel leave rounding of their size.
                // Infinite bounds make every sum infinite unless they cancel.
                let [lower, upper] = domain.bounds(k);
                let most = finite_size(lower.abs().max(upper.abs()));
                reach.size += (factor * c * most).abs();
                reach.add_term(self.line[k] - factor * c, domain.bounds(k));
            }
            best = best.min(reach.value());
        }
        beside.iter().for_each(|&(j, _)| self.linked[j] = 0.0);
        self.linked_terms = beside;
        best
    }

    /// Sets a row's coefficient of a binary, and its limit, from the largest value of the other
    /// terms at both values.
    fn tighten(&mut self, row: usize, z: usize, reach: [f64; 2]) {
        let (sign, limit) = self.one_side(row);
        let columns = self.program.row(row).0;
        let Some(place) = columns.iter().position(|&j| j == z) else { return };
        let place = self.program.rows.symbolic().row_range(row).start + place;
        let old = sign * self.values[place];
        let room = [limit, limit - old];
        let [mut off, mut on] = [room[0].min(reach[0]), room[1].min(reach[1])];
        let size = old.abs() + limit.abs();
        let drops = (off - on).abs() <= (DROPPED_BIG_M * size).min(MIN_BIG_M_REDUCTION);
        if !drops {
            // The coefficient keeps a part of its size, so that rounding does not decide the
            // binary. It never grows, as it would if a value were impossible; one side then stays
            // looser.
            let (least, most) = (MIN_BIG_M_REMAINDER * old.abs(), old.abs());
            (off, on) = (off.max(on - most), on.max(off - most));
            if (off - on).abs() < least {
                (off, on) =
                    if old > 0.0 { (off.max(on + least), on) } else { (off, on.max(off + least)) };
            }
        }
        let gain = (room[0] - off) + (room[1] - on);
        if !(gain > MIN_BIG_M_REDUCTION.max(MIN_BIG_M_GAIN * old.abs())
            && gain <= MAX_BIG_M_GAIN * size)
        {
            return;
        }
        let (coefficient, limit) = if drops { (0.0, off.max(on)) } else { (off - on, off) };
        self.values[place] = sign * coefficient;
        self.limits[row][usize::from(sign > 0.0)] = sign * limit;
        self.changed = true;
        self.witness.forget_sums();
    }

    fn into_program(self) -> Option<Program> {
        if !self.changed {
            return None;
        }
        let mut tight = self.program.clone();
        let terms = |row: usize| self.terms(row).map(move |(j, a)| (row, j, a));
        tight.replace_rows((0..self.limits.len()).flat_map(terms), &self.limits)?;
        Some(tight)
    }
}
