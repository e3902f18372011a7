//! The rules for what holds without loss of optimality, and for columns that are whole because
//! others are.
//!
//! Let S be the points that context 0 assumes, with all that was declared so far. Its bounds and
//! facts hold at every point of S. A declaration narrows S: from any point of S, a move leads to
//! one that has what is declared. That point is in S again if it satisfies the program, its
//! objective is no larger, and it keeps what was declared before; bounds and facts then hold at it,
//! so none of them has to be looked at.

use crate::bounds::Side;
use crate::cases::Kind;
use crate::checker::{Checker, side};
use crate::exact::{Number, Sum};
use crate::program::{Claim, Program};
use crate::quadratic_rules::value_at;
use crate::text::{Refusal, Words, rejected};
use std::cmp::Ordering;
use std::collections::HashSet;

/// The facts that decide whether columns may be moved.
#[derive(Debug)]
pub(crate) struct Moves {
    /// Columns that take whole numbers at every point of S.
    pub(crate) whole: HashSet<usize>,
    /// Columns in a cone, in a quadratic term or in a function, and those that were declared to be 0:
    /// they must not move.
    held: HashSet<usize>,
    /// By column, the rows of the program that it is in.
    rows: Vec<Vec<usize>>,
}

impl Moves {
    pub(crate) fn new(program: &Program) -> Self {
        let mut rows = vec![Vec::new(); program.columns.len()];
        for (index, row) in program.rows.iter().enumerate() {
            for (column, _) in row.entries() {
                rows.get_mut(column as usize).into_iter().for_each(|own| own.push(index));
            }
        }
        let columns = program.columns.iter().enumerate();
        let whole = columns.filter(|(_, own)| own.is_integral).map(|(column, _)| column).collect();
        let conic =
            program.cones.iter().flat_map(|c| c.tail.iter().chain([&c.head]).chain(&c.second));
        let has_costs = program.claim != Claim::Infeasible;
        let curved = program.objective.triangle.iter().filter(|_| has_costs);
        let curved = curved.flat_map(|(row, column, _)| [row, column]);
        let functions = program.terms.iter().flat_map(|term| term.columns());
        let held = conic.chain(curved).copied().chain(functions);
        let held = held.map(|column| column as usize).collect();
        Moves { whole, held, rows }
    }
}

impl Checker {
    /// Declares that a column takes whole numbers: it may move to the next one on a side.
    ///
    /// Its bound there is whole, so the bound is not passed. A row that keeps the column from
    /// moving on is, divided by the column's coefficient, one of whole numbers: the value at which
    /// it holds the column is whole, so this is not passed either.
    pub(crate) fn round(&mut self, words: &mut Words<'_>) -> Result<(), Refusal> {
        let column = words.index("column", self.bounds.len())?;
        let side = side(words)?;
        let is_upper = side == Side::Upper;
        let no = |why: &str| rejected(format!("column {} {why}", self.name(column)));
        if !self.is_root() || self.moves.held.contains(&column) {
            return no("must not be moved, or not here");
        }
        let cost = value_at(&self.program.objective.linear, column as u32);
        if self.has_costs() && (if is_upper { cost > 0.0 } else { cost < 0.0 }) {
            return no("costs more there");
        }
        let Some(own) = self.program.columns.get(column) else { return Ok(()) };
        let bound = if is_upper { own.upper } else { own.lower };
        if bound.is_finite() && bound.fract() != 0.0 {
            return no("has a bound that is not whole");
        }
        let sum = &mut self.sums.column;
        for &index in self.moves.rows.get(column).into_iter().flatten() {
            let Some(row) = self.facts.get(index) else { continue };
            let Some(own) = row.coefficient(column) else { continue };
            let is_above = is_upper == (own.sign() == Ordering::Greater);
            let Some(limit) = (if is_above { &row.upper } else { &row.lower }) else { continue };
            let mut is_fit = is_multiple(Number::Exact(limit), own, sum)?;
            for (other, value) in row.entries().filter(|entry| entry.0 as usize != column) {
                let is_whole = self.moves.whole.contains(&(other as usize));
                is_fit = is_fit && is_whole && is_multiple(value, own, sum)?;
            }
            if !is_fit {
                return rejected(format!(
                    "row {index} may hold column {column} between whole numbers"
                ));
            }
        }
        self.moves.whole.insert(column);
        Ok(())
    }

    /// Declares that a column is 0: all points may be moved along a direction, once the program has
    /// forgotten the bounds of its columns and the rows that it changes. Nothing may be derived
    /// from these before. The objective does not change. Where there are integral columns, the
    /// steps are whole.
    pub(crate) fn shift(&mut self, words: &mut Words<'_>) -> Result<(), Refusal> {
        let first = words.index("column", self.bounds.len())?;
        let direction = words.entries(self.bounds.len())?;
        if !self.is_plain {
            return rejected("`v` must stand before all that is derived");
        }
        if direction.iter().any(|entry| self.moves.held.contains(&(entry.0 as usize))) {
            return rejected("a column of the direction must not be moved");
        }
        let step = value_at(&direction, first as u32);
        let mut whole = direction.iter().filter(|entry| self.is_integral(entry.0 as usize));
        let is_fit = match whole.clone().next() {
            None => step != 0.0,
            Some(_) => self.is_integral(first) && step.abs() == 1.0,
        };
        if !is_fit || !whole.all(|entry| entry.1.fract() == 0.0) {
            return rejected(format!("the steps to where column {first} is 0 are not fit"));
        }
        let sum = &mut self.sums.total;
        for &(column, cost) in &self.program.objective.linear {
            sum.add(cost, value_at(&direction, column));
        }
        if sum.take_sign()? != Ordering::Equal && self.has_costs() {
            return rejected("the objective changes along the direction");
        }
        for &(column, _) in &direction {
            if let Some(own) = self.program.columns.get_mut(column as usize) {
                (own.lower, own.upper) = (f64::NEG_INFINITY, f64::INFINITY);
                self.bounds.forget(column as usize);
            }
            for &index in self.moves.rows.get(column as usize).into_iter().flatten() {
                let Some(row) = self.facts.get_mut(index) else { continue };
                for (column, value) in row.entries() {
                    self.sums.total.add(value, value_at(&direction, column));
                }
                if self.sums.total.take_sign()? != Ordering::Equal {
                    (row.lower, row.upper) = (None, None);
                }
            }
        }
        self.moves.held.insert(first);
        self.tighten(first, Side::Lower, 0.0);
        self.tighten(first, Side::Upper, 0.0);
        self.has_forgotten = true;
        Ok(())
    }

    /// Opens a context in which a column is at no whole number; when it is closed, the column is
    /// integral.
    pub(crate) fn imply(&mut self, words: &mut Words<'_>) -> Result<(), Refusal> {
        let column = words.index("column", self.bounds.len())?;
        if !self.is_root() {
            return rejected("`i` must stand in context 0");
        }
        self.open(Kind::Whole(column));
        Ok(())
    }

    /// Whether the present context assumes that a column is not at the only value that it has left.
    pub(crate) fn is_implied(&self, column: usize) -> bool {
        let (lower, upper) = self.bounds.of(column);
        let assumed = self.contexts.get(1).map(|context| &context.kind);
        let is_assumed = matches!(assumed, Some(Kind::Whole(own)) if *own == column);
        is_assumed && lower == upper && lower.fract() == 0.0
    }

    /// Whether a point must not have a larger objective than another one.
    fn has_costs(&self) -> bool {
        self.program.claim != Claim::Infeasible
    }
}

/// Whether a number is a whole multiple of another one, which is not 0.
fn is_multiple(value: Number<'_>, of: Number<'_>, sum: &mut Sum) -> Result<bool, Refusal> {
    let near = |number: Number<'_>| match number {
        Number::Float(float) => float,
        Number::Exact(exact) => exact.nearest(),
    };
    sum.add((near(value) / near(of)).round(), of);
    sum.subtract(value, 1.0);
    Ok(sum.take_sign()? == Ordering::Equal)
}
