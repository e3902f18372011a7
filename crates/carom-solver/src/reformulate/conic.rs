//! Norms and quadratic rows under a condition.
//!
//! Takes a norm or a quadratic row under a condition; leaves it with an M times a binary in its
//! bound.
//!
//! For `z = 1 => |e| <= b` and any `M >= max |e| - min b` over the bounds, the norm
//! `|e| <= b + M (1 - z)` is equivalent for `z` in {0, 1}. For a convex quadratic row `q <= 0` it
//! is `q <= M (1 - z)`. A row that only the signs of its variables make a cone, `|e|^2 <= b c`,
//! becomes `|(2 e, b - c)| <= b + c` (Lobo, Vandenberghe, Boyd and Lebret, Applications of
//! second-order cone programming, Linear Algebra and its Applications 284, 1998), and so does a row
//! with a constant limit, because a norm is tighter between 0 and 1. M is rounded outward.

use super::big_m::{Need, choose, open_guard};
use super::linear_program::tidy_up;
use super::lowering::Lowering;
use super::report::{BigMEntry, BigMSource, Side};
use crate::error::Error;
use crate::interval::{Interval, add_up};
use crate::model::{
    Affine, BigM, ConicRef, Literal, Model, Name, Quadratic, StandardCone, StoredConic, Variable,
};
use crate::tolerance;

/// How much larger than its rounded value a length may be, for each of its entries (no unit).
const LENGTH_ROUNDING: f64 = 2.0 * f64::EPSILON;

/// A conic row that must hold if its condition does.
pub(super) struct ImpliedConic<'a> {
    /// Its name in the report.
    pub(super) name: &'a Name,
    pub(super) conic: &'a StoredConic,
    pub(super) big_m: BigM,
}

/// A conic row of which something is the limit that a multiple of a binary raises.
pub(super) enum Raised {
    /// `|entries| <= bound`.
    Norm { entries: Vec<Affine>, bound: Affine },
    /// `expression = |tail|^2 - head <= 0`.
    Square { expression: Quadratic, tail: Vec<Affine>, head: Affine },
}

/// A conic row that gives by `slack`, in its unit if it is a norm or convex and in that of its root
/// if not.
pub(crate) fn with_slack(
    conic: &StoredConic,
    name: &Name,
    slack: Variable,
    model: &Model,
) -> Result<StoredConic, Error> {
    Ok(Raised::of(conic, name, true, model)?.by(slack.into()))
}

/// Adds a conic row of the model, with its condition as an M.
pub(super) fn apply(conic: &ConicRef<'_>, lowering: &mut Lowering<'_>) -> Result<(), Error> {
    lowering.begin(conic.name());
    let Some(condition) = conic.condition() else {
        return lowering.conic(conic.conic().clone());
    };
    let row = ImpliedConic { name: conic.name(), conic: conic.conic(), big_m: conic.big_m() };
    for clause in lowering.unless(condition)? {
        apply_unless(&clause, &row, lowering)?;
    }
    Ok(())
}

/// Adds a row for "the conic row holds, or one of `guard`".
pub(super) fn apply_unless(
    guard: &[Literal],
    row: &ImpliedConic<'_>,
    lowering: &mut Lowering<'_>,
) -> Result<(), Error> {
    let (open, fails) = open_guard(guard, lowering)?;
    let is_given = !matches!(row.big_m, BigM::Automatic);
    let raised = Raised::of(row.conic, row.name, is_given, &lowering.model)?;
    let mut entry = BigMEntry::new(row.name, Side::Upper, BigMSource::Bounds);
    let mut need = raised.need(lowering, &mut |e, sign, lowering| lowering.largest(e, sign))?;
    entry.needed = need.value.max(0.0);
    let terms = raised.terms(lowering)?;
    entry.note_shares(lowering, &terms, Side::Upper)?;
    if need.value <= 0.0 && !need.by_rows {
        entry.source = BigMSource::Implied;
    } else if fails {
        entry.source = BigMSource::ConditionFails;
    } else if open.is_empty() {
        entry.source = BigMSource::ConditionHolds;
        lowering.conic(row.conic.clone())?;
        entry.row = lowering.newest_conic();
    } else {
        if lowering.maximizer.is_some() && need.unbounded.is_none() {
            let when: &[Literal] = match &open[..] {
                [only] if only.variable().index() < lowering.original => &open,
                _ => &[],
            };
            let tighter = raised.need(lowering, &mut |e, sign, lowering| {
                let proved = lowering.largest_by_program(e, sign, when);
                Ok(proved.min(lowering.largest(e, sign)?))
            })?;
            if tighter.value < need.value {
                (need.value, need.by_program) = (tighter.value, true);
            }
        }
        need.value = tidy_up(need.value).max(0.0);
        need.largest = match &entry.largest {
            Some(name) => Some(lowering.model.variable_by_name(name.clone())?),
            None => None,
        };
        (entry.value, entry.source) = choose((row.name, row.big_m), lowering, Side::Upper, &need)?;
        let literals: Affine = open.iter().map(|&literal| Affine::from(literal)).sum();
        lowering.conic(raised.by(entry.value * literals))?;
        entry.row = lowering.newest_conic();
    }
    lowering.report.entries.push(entry);
    Ok(())
}

impl Raised {
    /// The form of a conic row.
    ///
    /// # Arguments
    ///
    /// * `in_its_unit`: whether the M is in the unit of a convex quadratic row, because the user
    ///   gave it.
    pub(super) fn of(
        conic: &StoredConic,
        name: &Name,
        in_its_unit: bool,
        model: &Model,
    ) -> Result<Self, Error> {
        let StandardCone { head, tail } = model.standard_cone(conic, name)?;
        let one = |head: &Affine| head.terms().is_empty() && head.offset() == 1.0;
        Ok(match (conic, &head[..]) {
            (StoredConic::Quadratic { expression }, [first, second]) if one(second) => {
                Raised::Square { expression: expression.clone(), tail, head: first.clone() }
            }
            (StoredConic::Quadratic { expression }, [first])
                if in_its_unit && first.terms().is_empty() =>
            {
                let limit = first.offset();
                let head = Affine::constant(limit * limit.abs());
                Raised::Square { expression: expression.clone(), tail, head }
            }
            _ => {
                let (entries, bound) = as_norm(&head, tail);
                Raised::Norm { entries, bound }
            }
        })
    }

    /// The row with its limit raised by an expression.
    pub(super) fn by(self, raise: Affine) -> StoredConic {
        match self {
            Raised::Norm { entries, bound } => StoredConic::Norm { entries, bound: bound + raise },
            Raised::Square { expression, .. } => {
                StoredConic::Quadratic { expression: (expression - raise).compacted() }
            }
        }
    }

    /// By how much the row is missed at most.
    ///
    /// # Arguments
    ///
    /// * `most`: the largest value of an expression times a sign, rounded up.
    pub(super) fn need(
        &self,
        lowering: &mut Lowering<'_>,
        most: &mut dyn FnMut(&Affine, f64, &mut Lowering<'_>) -> Result<f64, Error>,
    ) -> Result<Need, Error> {
        let mut need = Need::default();
        let mut end = |e: &Affine, sign: f64| -> Result<f64, Error> {
            let value = most(e, sign, lowering)?;
            let own = lowering.model.range(e)? * sign;
            need.by_rows |= value < own.upper;
            if value >= tolerance::INFINITE && need.unbounded.is_none() {
                need.unbounded = lowering.unbounded_variable(e, sign)?;
            }
            Ok(value)
        };
        let (tail, limit) = self.parts();
        let mut ends = Vec::with_capacity(tail.len());
        for e in tail {
            let (above, below) = (end(e, 1.0)?, end(e, -1.0)?);
            if above == f64::NEG_INFINITY || below == f64::NEG_INFINITY {
                // Nothing is left to be missed.
                return Ok(Need { value: f64::NEG_INFINITY, ..need });
            }
            ends.push(above.max(below).max(0.0));
        }
        let least = end(limit, -1.0)?;
        need.value = match self {
            Raised::Norm { .. } => add_up(length(&ends), least),
            Raised::Square { .. } => {
                let length = length(&ends);
                let square = length * length;
                let is_exact = tail.iter().all(is_whole) && length.mul_add(length, -square) == 0.0;
                // Roots of coefficients were rounded.
                let rounding = if is_exact { 0.0 } else { LENGTH_ROUNDING * 4.0 * square };
                add_up(square + rounding, least)
            }
        };
        if need.value.is_nan() {
            need.value = f64::INFINITY;
        }
        Ok(need)
    }

    fn parts(&self) -> (&[Affine], &Affine) {
        match self {
            Raised::Norm { entries, bound } => (entries, bound),
            Raised::Square { tail, head, .. } => (tail, head),
        }
    }

    /// The terms whose bounds an M comes from, with the signs that make the row miss its limit.
    pub(super) fn terms(&self, lowering: &Lowering<'_>) -> Result<Vec<(Variable, f64)>, Error> {
        let (tail, limit) = self.parts();
        let mut terms = Vec::new();
        for e in tail {
            let Interval { lower, upper } = lowering.range(e)?;
            let sign = if upper >= -lower { 1.0 } else { -1.0 };
            terms.extend(e.terms().into_iter().map(|(v, a)| (v, sign * a)));
        }
        terms.extend(limit.terms().into_iter().map(|(v, a)| (v, -a)));
        Ok(terms)
    }
}

/// The length of a vector, rounded up unless it is exact.
fn length(entries: &[f64]) -> f64 {
    if let [only] = entries {
        return *only;
    }
    let (mut sum, mut is_exact) = (0.0_f64, true);
    for &entry in entries {
        let (square, before) = (entry * entry, sum);
        sum += square;
        is_exact &= entry.mul_add(entry, -square) == 0.0;
        is_exact &= sum - before == square && sum - square == before;
    }
    let root = sum.sqrt();
    if is_exact && root.mul_add(root, -sum) == 0.0 {
        return root;
    }
    let length = entries.iter().fold(0.0_f64, |length, entry| length.hypot(*entry));
    length * (1.0 + LENGTH_ROUNDING * (entries.len() + 2) as f64)
}

fn is_whole(e: &Affine) -> bool {
    e.terms().iter().map(|term| term.1).chain([e.offset()]).all(|a| a == a.round())
}

/// A cone as a norm, exactly but for rounding.
pub(super) fn as_norm(head: &[Affine], tail: Vec<Affine>) -> (Vec<Affine>, Affine) {
    match head {
        [first, second] => {
            let mut entries: Vec<Affine> = tail.into_iter().map(|e| 2.0 * e).collect();
            entries.push(first - second);
            (entries, first + second)
        }
        _ => (tail, head.iter().sum()),
    }
}
