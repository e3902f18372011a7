//! Bounds of the columns, with a trail by which a context that is closed takes its own ones back.

use crate::exact::Number;
use std::cmp::Ordering;

/// A side of a column, or of a row.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Side {
    Lower,
    Upper,
}

#[derive(Debug, Default)]
pub(crate) struct Bounds {
    limits: Vec<(f64, f64)>,
    trail: Vec<(usize, (f64, f64))>,
}

impl Bounds {
    pub(crate) fn len(&self) -> usize {
        self.limits.len()
    }

    /// A further column.
    pub(crate) fn push(&mut self, lower: f64, upper: f64) {
        self.limits.push((lower, upper));
    }

    pub(crate) fn of(&self, column: usize) -> (f64, f64) {
        self.limits.get(column).copied().unwrap_or((f64::NEG_INFINITY, f64::INFINITY))
    }

    /// The bound at which `coefficient * column` is largest.
    pub(crate) fn largest(&self, column: u32, coefficient: Number<'_>) -> f64 {
        let (lower, upper) = self.of(column as usize);
        if coefficient.sign() == Ordering::Less { lower } else { upper }
    }

    /// The bound at which `coefficient * column` is smallest.
    pub(crate) fn smallest(&self, column: u32, coefficient: Number<'_>) -> f64 {
        let (lower, upper) = self.of(column as usize);
        if coefficient.sign() == Ordering::Less { upper } else { lower }
    }

    pub(crate) fn is_tighter(&self, column: usize, side: Side, value: f64) -> bool {
        let (lower, upper) = self.of(column);
        match side {
            Side::Lower => value > lower,
            Side::Upper => value < upper,
        }
    }

    /// Sets a bound if it is tighter; `is_lasting` where no context can take it back.
    pub(crate) fn tighten(&mut self, column: usize, side: Side, value: f64, is_lasting: bool) {
        if !self.is_tighter(column, side, value) {
            return;
        }
        let Some(limits) = self.limits.get_mut(column) else { return };
        if !is_lasting {
            self.trail.push((column, *limits));
        }
        match side {
            Side::Lower => limits.0 = value,
            Side::Upper => limits.1 = value,
        }
    }

    /// Takes both bounds away from a column.
    pub(crate) fn forget(&mut self, column: usize) {
        let limits = self.limits.get_mut(column);
        limits.into_iter().for_each(|own| *own = (f64::NEG_INFINITY, f64::INFINITY));
    }

    /// How many changes can be taken back.
    pub(crate) fn mark(&self) -> usize {
        self.trail.len()
    }

    /// Takes back all changes after `mark`.
    pub(crate) fn undo(&mut self, mark: usize) {
        while self.trail.len() > mark {
            let Some((column, before)) = self.trail.pop() else { return };
            if let Some(limits) = self.limits.get_mut(column) {
                *limits = before;
            }
        }
    }
}
