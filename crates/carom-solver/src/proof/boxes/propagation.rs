//! Bounds from functions: ranges of values from those of arguments, and the reverse, in turns with
//! the facts.
//!
//! A checker encloses functions by itself, with a rounding of its own. So bounds are loosened by
//! more than that.

use super::BoxProver;
use crate::elementary::Elementary;
use crate::interval::Interval;
use crate::proof::bounds::Clash;
use crate::proof::facts::BoundSource;
use crate::spatial::{Shape, SpatialProgram};

/// Most turns between functions and facts.
const MOST_SWEEPS_OF_A_BOX: usize = 12;

/// By how much values of functions are loosened: relative to them, and beside (no unit).
const LOOSE_VALUE: f64 = 1e-12;
const LOOSE_BESIDE: f64 = 1e-14;

/// By how much arguments are loosened, relative to them (no unit).
const LOOSE_ARGUMENT: f64 = 1e-9;

/// The columns of the functions of a program: results first.
pub(super) fn function_columns(program: &SpatialProgram) -> Vec<Vec<usize>> {
    let columns = program.terms.iter().map(|term| {
        let arguments = term.arguments().iter().copied();
        std::iter::once(term.result).chain(arguments).collect()
    });
    columns.collect()
}

impl BoxProver<'_, '_> {
    /// Tightens all bounds until little moves.
    pub(super) fn propagate(&mut self) -> Result<(), Clash> {
        for _ in 0..MOST_SWEEPS_OF_A_BOX {
            self.bounds.propagate(&self.facts)?;
            let mark = self.bounds.mark();
            let count = self.of.terms.len();
            for term in (0..count).chain((0..count).rev()) {
                self.contract(term)?;
            }
            if self.bounds.mark() == mark {
                break;
            }
        }
        Ok(())
    }

    fn range(&self, column: usize) -> Interval {
        let [lower, upper] = self.bounds.of(column);
        Interval::new(lower, upper)
    }

    /// Tightens the bounds of a function's columns.
    fn contract(&mut self, term: usize) -> Result<(), Clash> {
        let own = &self.of.terms[term];
        let result = own.result;
        match own.shape.clone() {
            Shape::Elementary { function, of } => {
                let values = function.range(self.range(of));
                let is_exact = matches!(function, Elementary::Power(_));
                let values = Interval::new(
                    loosened(values.lower, -1.0, is_exact),
                    loosened(values.upper, 1.0, is_exact),
                );
                self.offer((term, 0, result), values)?;
                self.contract_argument(term, &function, result, of)
            }
            Shape::Bilinear([a, b]) => {
                self.offer((term, 0, result), self.range(a) * self.range(b))?;
                if a != b {
                    self.contract_factor((term, 1, a), result, b, false)?;
                    self.contract_factor((term, 2, b), result, a, false)?;
                }
                Ok(())
            }
            Shape::Quotient([a, b]) => {
                self.offer((term, 1, a), self.range(result) * self.range(b))?;
                self.contract_factor((term, 0, result), a, b, true)?;
                self.contract_factor((term, 2, b), a, result, false)
            }
        }
    }

    /// Tightens the range of a factor of a product whose other factor has one sign.
    fn contract_factor(
        &mut self,
        place: (usize, usize, usize),
        product: usize,
        other: usize,
        divides: bool,
    ) -> Result<(), Clash> {
        let (product, other) = (self.range(product), self.range(other));
        let has_sign = match divides {
            true => other.lower >= 0.0 || other.upper <= 0.0,
            false => other.lower > 0.0 || other.upper < 0.0,
        };
        if !has_sign || (other.lower == 0.0 && other.upper == 0.0) {
            return Ok(());
        }
        self.offer(place, product / other)
    }

    /// Tightens the range of the only argument of a function.
    fn contract_argument(
        &mut self,
        term: usize,
        function: &Elementary,
        result: usize,
        of: usize,
    ) -> Result<(), Clash> {
        let (values, own) = (self.range(result), self.range(of));
        let inverse = function.inverse(values, own);
        let domain = function.domain();
        let is_own = matches!(function, Elementary::Own(_));
        let misses = |rest: Interval| {
            let range = function.range(rest.intersection(domain));
            let spare = |limit: f64| 1e-13 * limit.abs() + LOOSE_BESIDE;
            is_own
                || range.lower > values.upper + spare(values.upper)
                || range.upper < values.lower - spare(values.lower)
        };
        let loose = |end: f64| LOOSE_ARGUMENT * end.abs() + f64::MIN_POSITIVE;
        let lower = inverse.lower - loose(inverse.lower);
        if own.lower < domain.lower {
            self.offer((term, 1, of), Interval::new(domain.lower, f64::INFINITY))?;
        } else if lower > own.lower && misses(Interval::new(own.lower, lower.min(own.upper))) {
            self.offer((term, 1, of), Interval::new(lower, f64::INFINITY))?;
        }
        let upper = inverse.upper + loose(inverse.upper);
        if own.upper > domain.upper {
            self.offer((term, 1, of), Interval::new(f64::NEG_INFINITY, domain.upper))?;
        } else if upper < own.upper && misses(Interval::new(upper.max(own.lower), own.upper)) {
            self.offer((term, 1, of), Interval::new(f64::NEG_INFINITY, upper))?;
        }
        Ok(())
    }

    fn offer(
        &mut self,
        (term, place, column): (usize, usize, usize),
        range: Interval,
    ) -> Result<(), Clash> {
        let source = BoundSource::Function(term, place);
        for (is_upper, value) in [(false, range.lower), (true, range.upper)] {
            if value.is_finite() {
                self.bounds.offer(&self.facts, (column, is_upper), value, source)?;
            }
        }
        Ok(())
    }
}

/// An end of a range of values, moved outward; a power that is 0 is so exactly.
fn loosened(end: f64, outward: f64, is_exact: bool) -> f64 {
    if is_exact && end == 0.0 {
        return end;
    }
    end + outward * (LOOSE_VALUE * end.abs() + if is_exact { 0.0 } else { LOOSE_BESIDE })
}
