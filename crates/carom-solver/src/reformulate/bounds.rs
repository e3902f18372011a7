//! The bounds that Ms are computed from: a variable's own, or implied by rows where it has none.

use super::lowering::Lowering;
use super::missing_bound::{BoundReason, reason};
use crate::activity;
use crate::error::{Error, ErrorKind};
use crate::interval::{Interval, add_down, add_up};
use crate::model::{Affine, Literal, Variable};
use crate::tolerance;

impl Lowering<'_> {
    /// The bounds of a variable, with implied ones where its own are missing.
    pub(super) fn bounds(&self, variable: Variable) -> Result<Interval, Error> {
        let own = self.model.variable_ref(variable)?.bounds();
        Ok(match &self.implied {
            // Rows say nothing of auxiliary columns.
            Some(implied) if variable.index() < self.original => implied.complete(variable, own),
            _ => own,
        })
    }

    /// The values of an expression over these bounds, rounded outward.
    pub(super) fn range(&self, of: &Affine) -> Result<Interval, Error> {
        let term = |(variable, a)| Ok((a, self.bounds(variable)?));
        activity::try_range(of.offset(), of.terms().into_iter().map(term))
    }

    /// The largest value of a sum, without its constant, that rows prove together; infinite if they
    /// prove none.
    pub(super) fn upper_bound_by_rows(&mut self, terms: &[(Variable, f64)]) -> f64 {
        let original = self.original;
        match &mut self.implied {
            Some(implied) if terms.iter().all(|(v, _)| v.index() < original) => {
                implied.upper_bound(terms)
            }
            _ => f64::INFINITY,
        }
    }

    /// The largest value of `sign * of`, by bounds and, where one is missing, by rows; rounded up.
    pub(super) fn largest(&mut self, of: &Affine, sign: f64) -> Result<f64, Error> {
        let most = (self.range(of)? * sign).upper;
        if most < tolerance::INFINITE {
            return Ok(most);
        }
        let terms: Vec<(Variable, f64)> =
            of.terms().into_iter().map(|(v, a)| (v, sign * a)).collect();
        Ok(add_up(self.upper_bound_by_rows(&terms), sign * of.offset()))
    }

    /// The largest value of `sign * of` that a linear program proves if all of `when` are true;
    /// infinite if none is wanted.
    pub(super) fn largest_by_program(&mut self, of: &Affine, sign: f64, when: &[Literal]) -> f64 {
        let terms: Vec<(Variable, f64)> =
            of.terms().into_iter().map(|(v, a)| (v, sign * a)).collect();
        match &mut self.maximizer {
            Some(maximizer) => add_up(maximizer.upper_bound(&terms, when), sign * of.offset()),
            None => f64::INFINITY,
        }
    }

    /// The range of an expression, or an error that names a variable without a bound.
    pub(super) fn bounded_range(&mut self, of: &Affine) -> Result<Interval, Error> {
        let mut range = self.range(of)?;
        let up = of.terms();
        let down: Vec<(Variable, f64)> = up.iter().map(|&(v, a)| (v, -a)).collect();
        if range.upper >= tolerance::INFINITE {
            range.upper = add_up(self.upper_bound_by_rows(&up), of.offset());
        }
        if range.lower <= -tolerance::INFINITE {
            range.lower = add_down(-self.upper_bound_by_rows(&down), of.offset());
        }
        for (missing, sign) in [(range.upper, 1.0), (range.lower, -1.0)] {
            if missing.abs() >= tolerance::INFINITE {
                return Err(self.unbounded(of, sign)?);
            }
        }
        Ok(range)
    }

    /// The finite bounds of a variable, or an error.
    pub(super) fn finite_bounds(&mut self, variable: Variable) -> Result<Interval, Error> {
        let own = self.model.variable_ref(variable)?.bounds();
        let known = self.bounds(variable)?;
        let is_missing = |end: f64| end.abs() >= tolerance::INFINITE;
        if variable.index() < self.original
            && (is_missing(known.lower) || is_missing(known.upper))
            && let Some(implied) = &mut self.implied
        {
            implied.find(variable, own);
        }
        let bounds = self.bounds(variable)?;
        for (end, bound) in [(bounds.lower, "lower"), (bounds.upper, "upper")] {
            if is_missing(end) {
                return Err(self.unbounded_function(variable, bound));
            }
        }
        Ok(bounds)
    }

    /// The error that names the variable that makes `sign * of` unbounded above.
    pub(super) fn unbounded(&self, of: &Affine, sign: f64) -> Result<Error, Error> {
        if let Some((variable, bound)) = self.unbounded_variable(of, sign)? {
            return Ok(self.unbounded_function(variable, bound));
        }
        let name = self.statement().to_string();
        Ok(Error::from(ErrorKind::NotFinite {
            name,
            what: "the range",
            value: sign * f64::INFINITY,
        }))
    }

    /// The first variable that makes `sign * of` unbounded above, and which of its bounds is
    /// missing.
    pub(super) fn unbounded_variable(
        &self,
        of: &Affine,
        sign: f64,
    ) -> Result<Option<(Variable, &'static str)>, Error> {
        for (variable, coefficient) in of.terms() {
            let bounds = self.bounds(variable)?;
            let (end, bound) = match sign * coefficient > 0.0 {
                true => (bounds.upper, "upper"),
                false => (bounds.lower, "lower"),
            };
            if end.is_infinite() {
                return Ok(Some((variable, bound)));
            }
        }
        Ok(None)
    }

    pub(super) fn unbounded_function(&self, variable: Variable, bound: &'static str) -> Error {
        let (function, variable_name) =
            (self.statement().to_string(), self.model.name_of(variable));
        let (chain, remedy) = self.missing(variable, bound);
        let variable = variable_name;
        Error::from(ErrorKind::UnboundedFunction { function, variable, bound, chain, remedy })
    }

    /// Why rows do not give a missing bound, in words, and which variables to bound.
    pub(super) fn missing(&self, variable: Variable, bound: &str) -> (String, String) {
        let own = format!("`{}`", self.model.name_of(variable));
        let reason = match &self.implied {
            Some(implied) if variable.index() < self.original => {
                reason(implied, variable, bound == "upper")
            }
            _ => BoundReason { chain: String::new(), root: None },
        };
        let remedy = match reason.root {
            Some(root) => format!("{own} or `{}`", self.model.name_of(root)),
            None => own,
        };
        (reason.chain, remedy)
    }
}
