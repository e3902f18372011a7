//! Conflict analysis: which bounds made propagation fail.
//!
//! Backwards along the trail from the contradiction, each required bound is replaced by the bounds
//! that it was derived from, until only bounds of integral columns remain. Bounds are weakened as
//! far as the next step allows: the spare of a row drops bounds entirely if possible, and otherwise
//! weakens them.
//!
//! Every step is checked again with the remaining bounds, at the tolerances of propagation, and a
//! row gives back only what exceeds its feasibility tolerance. So a no-good is as certain as the
//! propagation that it repeats.

use super::domain::{Domain, Reason};
use super::implications::Implications;
use super::no_goods::{Literal, NoGoods};
use super::tightening::{Entry, Line};
use crate::tolerance;

/// Most entries of rows that are looked at for one conflict.
const WORK: usize = 50_000;

/// Where propagation failed.
#[derive(Debug, Clone, Copy)]
pub(super) enum Clash {
    /// A row's activity cannot meet its limits.
    Row(usize),
    /// A column's bounds crossed.
    Crossed(usize),
    /// A fixed binary implies what the bounds of another one exclude.
    Implied { from: usize, to: usize },
    /// All literals of a no-good hold.
    NoGood(u32),
}

/// How far a conflict is resolved.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Resolution {
    /// To the last bound through which all that was decided last leads to the conflict.
    FirstImplicationPoint,
    /// To what was decided last.
    Decision,
}

/// What the steps of propagation were made of.
pub(super) struct Sources<'a> {
    pub(super) integral: &'a [bool],
    /// The program's rows, the objective's limit last.
    pub(super) rows: &'a [Line],
    pub(super) entries: &'a [Entry],
    pub(super) implications: &'a Implications,
    pub(super) no_goods: &'a NoGoods,
    pub(super) cutoff: f64,
}

/// A conflict, explained: literals that cannot all hold, in the order in which undoing would
/// loosen them, up to a cutoff.
pub(super) struct Explanation {
    pub(super) literals: Vec<Literal>,
    pub(super) cutoff: f64,
}

/// A bound that a row gave, or is to have given: column, whether it is the upper one, value.
type Target = (usize, usize, f64);

/// A bound that a row uses.
struct Use {
    /// What the row loses without it.
    cost: f64,
    column: usize,
    side: usize,
    /// The slope, positive where a larger value presses.
    slope: f64,
}

/// The buffers of the analysis; one per propagator.
#[derive(Debug, Clone)]
pub(super) struct Analysis {
    /// What holds everywhere, and the length of the trail that led to it.
    root: Vec<[f64; 2]>,
    root_mark: usize,
    /// The bounds at the point of the trail that is looked at.
    view: Vec<[f64; 2]>,
    /// The bounds before what was decided last.
    before: Vec<[f64; 2]>,
    /// What is needed of the bounds; infinite where nothing is.
    needs: Vec<[f64; 2]>,
    /// The bounds that something is or was needed of.
    touched: Vec<[usize; 2]>,
    /// Needs that did not hold before what was decided last.
    current: usize,
    /// Needs of columns that are not integral.
    continuous: usize,
    /// Whether all that was given from here backwards is needed.
    path: bool,
    cutoff: f64,
    work: usize,
}

const NOTHING: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];

/// Whether a bound is at least as tight as a value.
fn meets(side: usize, bound: f64, value: f64) -> bool {
    if side == 1 { bound <= value } else { bound >= value }
}

impl Analysis {
    /// What `domain` holds now holds everywhere.
    pub(super) fn new(domain: &Domain) -> Self {
        let root = domain.all().to_vec();
        Analysis {
            root_mark: domain.mark(),
            view: Vec::new(),
            before: Vec::new(),
            needs: vec![NOTHING; root.len()],
            touched: Vec::new(),
            root,
            current: 0,
            continuous: 0,
            path: false,
            cutoff: f64::INFINITY,
            work: 0,
        }
    }

    /// Explains a conflict by bounds of integral columns; what was decided last came after `mark`.
    /// Nothing where a step cannot be explained.
    pub(super) fn explain(
        &mut self,
        sources: &Sources<'_>,
        domain: &Domain,
        mark: usize,
        clash: Clash,
        resolution: Resolution,
    ) -> Option<Explanation> {
        if mark < self.root_mark {
            return None;
        }
        self.view.clear();
        self.view.extend_from_slice(domain.all());
        self.before.clear();
        self.before.extend_from_slice(domain.all());
        for position in (mark..domain.mark()).rev() {
            let change = domain.change(position);
            self.before[change.column()][usize::from(change.is_upper())] = change.old;
        }
        for [column, side] in self.touched.drain(..) {
            self.needs[column][side] = NOTHING[side];
        }
        (self.current, self.continuous, self.path) = (0, 0, false);
        (self.cutoff, self.work) = (f64::INFINITY, 0);
        if !self.require_clash(sources, clash) {
            return None;
        }
        let mut literals = Vec::new();
        let mut first_point = false;
        let mut position = domain.mark();
        while position > self.root_mark {
            let above = first_point || position <= mark;
            if above && self.continuous == 0 && !self.path {
                break;
            }
            position -= 1;
            let change = domain.change(position);
            let (column, side) = (change.column(), usize::from(change.is_upper()));
            let new = std::mem::replace(&mut self.view[column][side], change.old);
            if self.path && change.reason == Reason::Given {
                self.require(sources, column, side, new);
            }
            let need = self.needs[column][side];
            if need.is_infinite() || meets(side, change.old, need) || !meets(side, new, need) {
                continue;
            }
            let integral = sources.integral[column];
            let kept = if position < mark {
                integral
            } else {
                first_point |= resolution == Resolution::FirstImplicationPoint
                    && integral
                    && self.current == 1;
                first_point || (change.reason == Reason::Given && integral)
            };
            if kept {
                literals.push(literal(column, side, need));
                continue;
            }
            self.forget(sources, column, side);
            if !self.resolve(sources, change.reason, (column, side, need)) || self.work > WORK {
                return None;
            }
        }
        if self.continuous > 0 {
            return None;
        }
        for &[column, side] in &self.touched {
            let need = self.needs[column][side];
            let known = |l: &Literal| (l.column, usize::from(l.is_upper)) == (column, side);
            if need.is_finite() && !literals.iter().any(known) {
                literals.push(literal(column, side, need));
            }
        }
        Some(Explanation { literals, cutoff: self.cutoff })
    }

    fn require_clash(&mut self, sources: &Sources<'_>, clash: Clash) -> bool {
        match clash {
            Clash::Row(row) => self.require_row(sources, row, None),
            Clash::Crossed(column) => {
                let [lower, upper] = self.view[column];
                let scale = lower.abs().max(upper.abs()).max(1.0);
                let (apart, enough) = if sources.integral[column] {
                    (lower.ceil() - 1.0, lower > upper)
                } else {
                    (upper, lower - upper > tolerance::PROPAGATION_INFEASIBLE * scale)
                };
                self.require(sources, column, 0, lower);
                self.require(sources, column, 1, apart);
                enough && meets(1, upper, apart)
            }
            Clash::Implied { from, to } => {
                let Some(literal) = self.fixed(from) else { return false };
                self.require(sources, from, usize::from(literal == 0), literal as f64);
                let implied = sources.implications.of(2 * from + literal);
                let excluded = [0, 1].into_iter().find(|&value| {
                    let [lower, upper] = self.view[to];
                    implied.contains(&(2 * to + value))
                        && (lower > value as f64 || upper < value as f64)
                });
                match excluded {
                    Some(0) => self.require(sources, to, 0, 1.0),
                    Some(_) => self.require(sources, to, 1, 0.0),
                    None => return false,
                }
                true
            }
            Clash::NoGood(number) => self.require_others(sources, number, None),
        }
    }

    /// Replaces a bound by those that it was derived from; `false` where that is not known.
    fn resolve(&mut self, sources: &Sources<'_>, reason: Reason, target: Target) -> bool {
        match reason {
            Reason::Given | Reason::Settled => false,
            Reason::Path => {
                self.path = true;
                self.cutoff = self.cutoff.min(sources.cutoff);
                true
            }
            Reason::Row(row) => self.require_row(sources, row as usize, Some(target)),
            Reason::Implied(from) => {
                let from = from as usize;
                let Some(literal) = self.fixed(from) else { return false };
                self.require(sources, from, usize::from(literal == 0), literal as f64);
                true
            }
            Reason::NoGood(number) => self.require_others(sources, number, Some(target)),
        }
    }

    /// The value of a binary that is fixed.
    fn fixed(&self, column: usize) -> Option<usize> {
        match self.view[column] {
            [0.0, 0.0] => Some(0),
            [1.0, 1.0] => Some(1),
            _ => None,
        }
    }

    /// Needs all literals of a no-good but the one that it denied.
    fn require_others(
        &mut self,
        sources: &Sources<'_>,
        number: u32,
        denied: Option<Target>,
    ) -> bool {
        let Some(no_good) = sources.no_goods.get(number) else { return false };
        self.cutoff = self.cutoff.min(no_good.cutoff);
        self.work += no_good.literals.len();
        let mut found = denied.is_none();
        for literal in &no_good.literals {
            let side = usize::from(literal.is_upper);
            if denied.is_some_and(|(column, s, _)| (column, 1 - s) == (literal.column, side)) {
                found = true;
            } else if literal.holds(self.view[literal.column]) {
                self.require(sources, literal.column, side, literal.value);
            } else {
                return false;
            }
        }
        found
    }

    /// Needs what a row requires to give a bound, or to be violated.
    fn require_row(&mut self, sources: &Sources<'_>, row: usize, target: Option<Target>) -> bool {
        let Line { range: [start, end], limits } = sources.rows[row];
        let entries = &sources.entries[start..end];
        self.work += entries.len();
        if row + 1 == sources.rows.len() {
            self.cutoff = self.cutoff.min(sources.cutoff);
        }
        match target {
            Some(target) => {
                let mut own = entries.iter().filter(|e| e.column() == target.0);
                let (Some(own), None) = (own.next(), own.next()) else { return false };
                let own = own.coefficient;
                let sign = if (own > 0.0) == (target.1 == 1) { 1.0 } else { -1.0 };
                self.require_side(sources, entries, limits, sign, Some((target, sign * own)))
            }
            None => [1.0, -1.0]
                .into_iter()
                .any(|sign| self.require_side(sources, entries, limits, sign, None)),
        }
    }

    /// As [`require_row`](Self::require_row), for the upper limit (`sign` 1) or the lower one (-1).
    /// A target comes with its coefficient times the sign.
    fn require_side(
        &mut self,
        sources: &Sources<'_>,
        entries: &[Entry],
        limits: [f64; 2],
        sign: f64,
        target: Option<(Target, f64)>,
    ) -> bool {
        let limit = if sign > 0.0 { limits[1] } else { -limits[0] };
        if !limit.is_finite() {
            return false;
        }
        let (mut rest, mut size, mut scale) = (0.0, 0.0, 0.0_f64);
        let mut uses: Vec<Use> = Vec::new();
        for entry in entries {
            let column = entry.column();
            if target.is_some_and(|(target, _)| target.0 == column) {
                continue;
            }
            let slope = sign * entry.coefficient;
            let side = usize::from(slope < 0.0);
            let (low, high) =
                (slope * self.view[column][side], slope * self.view[column][1 - side]);
            if !low.is_finite() {
                return false;
            }
            rest += low;
            size += low.abs();
            scale += low.abs().max(if high.is_finite() { high.abs() } else { 0.0 });
            let cost = low - slope * self.root[column][side];
            if cost > 0.0 {
                uses.push(Use { cost, column, side, slope });
            }
        }
        let required = match target {
            None => {
                let scale = scale.max(limit.abs()).max(1.0);
                limit + tolerance::PROPAGATION_INFEASIBLE * scale
            }
            Some(((column, side, value), own)) => {
                let outwards = if side == 1 { 1.0 } else { -1.0 };
                // The row must give the bound before it is rounded, or loosened.
                let given = if sources.integral[column] {
                    value + outwards * (1.0 - tolerance::INTEGRALITY)
                } else {
                    value - outwards * 0.5 * tolerance::PROPAGATION_SLACK * value.abs().max(1.0)
                };
                let size = size + limit.abs() + (own * given).abs();
                limit - own * given + 1e-15 * size * entries.len() as f64
            }
        };
        let surplus = rest - required;
        if surplus.is_nan() || surplus < 0.0 {
            return false;
        }
        let tolerance = tolerance::allowed_miss(tolerance::FEASIBILITY, size + limit.abs());
        self.give_back(sources, uses, surplus - tolerance);
        true
    }

    /// Needs the bounds that a row uses, as far as it cannot spare them.
    fn give_back(&mut self, sources: &Sources<'_>, mut uses: Vec<Use>, mut spare: f64) {
        // What is needed anyway need not be spared; else the cheapest go first, to drop many.
        let needed =
            |u: &Use| meets(u.side, self.needs[u.column][u.side], self.view[u.column][u.side]);
        uses.retain(|u| !needed(u));
        uses.sort_by(|a, b| a.cost.total_cmp(&b.cost).then(a.column.cmp(&b.column)));
        for Use { cost, column, side, slope } in uses {
            let bound = self.view[column][side];
            let far = slope * self.root[column][side];
            let charge = cost + 1e-12 * (cost + far.abs());
            if charge <= spare {
                spare -= charge;
                continue;
            }
            let mut step = 0.0;
            if spare > 0.0 {
                step = (0.999 * spare / slope.abs()).max(0.0);
                if sources.integral[column] {
                    step = step.floor();
                }
                spare -= step * slope.abs() * (1.0 + 1e-12);
            }
            let weaker = if side == 1 { bound + step } else { bound - step };
            // A step may be lost to rounding, never go beyond it.
            let value = if meets(side, bound, weaker) { weaker } else { bound };
            self.require(sources, column, side, value);
        }
    }

    /// Needs a bound.
    fn require(&mut self, sources: &Sources<'_>, column: usize, side: usize, value: f64) {
        let old = self.needs[column][side];
        if meets(side, self.root[column][side], value) || meets(side, old, value) {
            return;
        }
        if old.is_infinite() {
            self.touched.push([column, side]);
            self.continuous += usize::from(!sources.integral[column]);
        }
        let news = |value: f64| !meets(side, self.before[column][side], value);
        self.current += usize::from(news(value));
        self.current -= usize::from(old.is_finite() && news(old));
        self.needs[column][side] = value;
    }

    /// A bound is not needed any more.
    fn forget(&mut self, sources: &Sources<'_>, column: usize, side: usize) {
        let old = std::mem::replace(&mut self.needs[column][side], NOTHING[side]);
        self.current -= usize::from(!meets(side, self.before[column][side], old));
        self.continuous -= usize::from(!sources.integral[column]);
    }
}

fn literal(column: usize, side: usize, need: f64) -> Literal {
    let value = if side == 1 { need.floor() } else { need.ceil() };
    Literal { column, is_upper: side == 1, value }
}
