//! The robustness of a run, from its values alone.
//!
//! This is the definition, and what plans are checked by. It shares nothing with the rows.

use super::formula::{Mission, MissionNode, Predicate};
use super::values::handles_of;
use super::window::Window;
use crate::error::{Error, ErrorKind};
use crate::hybrid::system::SystemRow;
use crate::model::{Affine, StoredConic, Variable};
use crate::sum::Sum;
use crate::tolerance::{FEASIBILITY, INFINITE};

/// Values of handles over the samples of a run.
pub(crate) trait ValueSource {
    /// The value at a sample; `None` if it has none there.
    fn value(&self, handle: Variable, sample: usize) -> Result<Option<f64>, Error>;

    /// Whether it is 0 or 1 only, such as a mode.
    fn is_binary(&self, handle: Variable) -> bool;
}

/// A run on which a mission is read.
pub(super) struct Reading<'a> {
    pub(super) trajectory: &'a dyn ValueSource,
    /// The number of samples.
    pub(super) samples: usize,
    pub(super) time_step: f64,
}

/// Beyond the end of the run nothing is known, so nothing counts as true there.
fn at(values: &[f64], sample: usize) -> f64 {
    values.get(sample).copied().unwrap_or(f64::NEG_INFINITY)
}

impl Reading<'_> {
    /// The robustness of a mission, or of its negation, at each sample.
    pub(super) fn values(&self, mission: &Mission, positive: bool) -> Result<Vec<f64>, Error> {
        let fold = |parts: Vec<Vec<f64>>, all: bool| {
            let one = |k: usize| {
                let values = parts.iter().map(|part| at(part, k));
                match all {
                    true => values.fold(f64::INFINITY, f64::min),
                    false => values.fold(f64::NEG_INFINITY, f64::max),
                }
            };
            (0..self.samples).map(one).collect::<Vec<f64>>()
        };
        let parts = |of: &[Mission]| {
            of.iter().map(|part| self.values(part, positive)).collect::<Result<Vec<_>, Error>>()
        };
        match &mission.node {
            MissionNode::Holds(predicate) => {
                (0..self.samples).map(|k| self.predicate(predicate, positive, k)).collect()
            }
            MissionNode::Not(of) => self.values(of, !positive),
            MissionNode::And(of) => Ok(fold(parts(of)?, positive)),
            MissionNode::Or(of) => Ok(fold(parts(of)?, !positive)),
            MissionNode::Always(window, of) => self.window(mission, window, of, positive, positive),
            MissionNode::Eventually(window, of) => {
                self.window(mission, window, of, positive, !positive)
            }
            MissionNode::Until(window, a, b) => self.until(mission, window, [a, b], positive, true),
            MissionNode::Release(window, a, b) => {
                self.until(mission, window, [a, b], positive, false)
            }
            MissionNode::TooDeep => Err(too_deep()),
        }
    }

    /// The least or the greatest value in the window of each sample.
    fn window(
        &self,
        mission: &Mission,
        window: &Window,
        of: &Mission,
        positive: bool,
        all: bool,
    ) -> Result<Vec<f64>, Error> {
        let (end, values) = (self.end(mission)?, self.values(of, positive)?);
        let one = |k: usize| {
            let (samples, is_cut) = window.samples(self.time_step, k, end)?;
            let inside = samples.map(|j| at(&values, j));
            Ok(match all {
                true if is_cut => f64::NEG_INFINITY,
                true => inside.fold(f64::INFINITY, f64::min),
                false => inside.fold(f64::NEG_INFINITY, f64::max),
            })
        };
        (0..self.samples).map(one).collect()
    }

    /// Until and release; the negation of one is the other of the negations.
    fn until(
        &self,
        mission: &Mission,
        window: &Window,
        [a, b]: [&Mission; 2],
        positive: bool,
        is_until: bool,
    ) -> Result<Vec<f64>, Error> {
        let end = self.end(mission)?;
        let (a, b) = (self.values(a, positive)?, self.values(b, positive)?);
        // The negation of an until is a release, and the other way round.
        let is_until = is_until == positive;
        let mut values = Vec::with_capacity(self.samples);
        for k in 0..self.samples {
            let (samples, is_cut) = window.samples(self.time_step, k, end)?;
            let (mut value, mut so_far) = (f64::INFINITY, f64::NEG_INFINITY);
            if is_until {
                std::mem::swap(&mut value, &mut so_far);
            }
            let mut next = k;
            for j in samples {
                while next < j {
                    let before = at(&a, next);
                    so_far = if is_until { so_far.min(before) } else { so_far.max(before) };
                    next += 1;
                }
                let here = at(&b, j);
                value = match is_until {
                    true => value.max(here.min(so_far)),
                    false => value.min(here.max(so_far)),
                };
            }
            if !is_until && is_cut {
                // What comes after the end does not matter where the first one was true before it.
                let all = (k..self.samples).map(|i| at(&a, i));
                value = value.min(all.fold(f64::NEG_INFINITY, f64::max));
            }
            values.push(value);
        }
        Ok(values)
    }

    /// The last sample of the run or, for a window that is open, at which all predicates inside
    /// have values.
    fn end(&self, mission: &Mission) -> Result<Option<usize>, Error> {
        let mut end = self.samples.checked_sub(1);
        if mission.window().is_some_and(|window| !window.is_open()) {
            return Ok(end);
        }
        let mut result = Ok(());
        mission.visit(&mut |part| {
            let MissionNode::Holds(predicate) = &part.node else { return };
            while let (Some(last), true) = (end, result.is_ok()) {
                match self.has_values(predicate, last) {
                    Ok(true) => break,
                    Ok(false) => end = last.checked_sub(1),
                    Err(error) => result = Err(error),
                }
            }
        });
        result.map(|()| end)
    }

    fn has_values(&self, predicate: &Predicate, sample: usize) -> Result<bool, Error> {
        let Some(rows) = predicate.rows(sample) else { return Ok(false) };
        for row in rows {
            for handle in handles_of(row) {
                if self.trajectory.value(handle, sample)?.is_none() {
                    return Ok(false);
                }
            }
        }
        Ok(true)
    }

    fn predicate(&self, of: &Predicate, positive: bool, sample: usize) -> Result<f64, Error> {
        if !self.has_values(of, sample)? {
            return Ok(f64::NEG_INFINITY);
        }
        let mut least = f64::INFINITY;
        for row in of.rows(sample).unwrap_or_default() {
            least = least.min(self.slack(row, sample, of, positive)?);
        }
        Ok(if positive { least } else { -least })
    }

    /// By how much a row holds.
    fn slack(
        &self,
        row: &SystemRow,
        sample: usize,
        of: &Predicate,
        positive: bool,
    ) -> Result<f64, Error> {
        let value = |handle: Variable| {
            self.trajectory.value(handle, sample).map(|value| value.unwrap_or(f64::NAN))
        };
        let affine = |expression: &Affine| {
            let mut sum = Sum::new(expression.offset());
            for (handle, factor) in expression.terms() {
                sum.add_product(factor, value(handle)?);
            }
            Ok::<f64, Error>(sum.value())
        };
        match row {
            SystemRow::Row(row) => {
                let x = affine(row.expression())?;
                let side = |limit: f64, slack: f64| match limit.abs() < INFINITE {
                    true => slack,
                    false => f64::INFINITY,
                };
                let slack =
                    side(row.upper(), row.upper() - x).min(side(row.lower(), x - row.lower()));
                let terms = row.expression().terms();
                let is_logical = terms.iter().all(|term| self.trajectory.is_binary(term.0));
                Ok(match is_logical {
                    true if slack >= -FEASIBILITY => f64::INFINITY,
                    true => f64::NEG_INFINITY,
                    false => slack,
                })
            }
            SystemRow::Nonlinear(row) => Ok(row.slack(|own| value(own).unwrap_or(f64::NAN))),
            SystemRow::Conic(_) if !positive => Err(negated_norm(&of.name)),
            SystemRow::Conic(row) => match row.stored() {
                StoredConic::Norm { entries, bound } => {
                    let mut length = 0.0_f64;
                    for entry in entries {
                        length = length.hypot(affine(entry)?);
                    }
                    Ok(affine(bound)? - length)
                }
                StoredConic::Quadratic { expression } => {
                    let mut sum = Sum::new(affine(expression.affine())?);
                    for (first, second, factor) in expression.products() {
                        sum.add_product_of_three(factor, value(first)?, value(second)?);
                    }
                    Ok(-sum.value())
                }
            },
        }
    }
}

/// Refuses the outside of a disc.
pub(super) fn negated_norm(name: &str) -> Error {
    let comparison = "is negated by the mission";
    let help = "the outside of a disc has no rows: write a polygon inside or around the disc as rows, \
                or the length as `(x.square() + y.square()).sqrt()`; both can be negated";
    ErrorKind::NotConicRow { row: name.to_owned(), comparison, help }.into()
}

pub(super) fn too_deep() -> Error {
    let (what, most) =
        ("the number of levels of the mission", f64::from(super::formula::MAX_DEPTH));
    Error::out_of_range_with(what, 1.0 + most, ..=most, "; require its parts one by one")
}

/// A run given by a function of handle and sample.
struct ValueFunction<F>(F);

impl<F: Fn(Variable, usize) -> Option<f64>> ValueSource for ValueFunction<F> {
    fn value(&self, handle: Variable, sample: usize) -> Result<Option<f64>, Error> {
        Ok((self.0)(handle, sample))
    }

    fn is_binary(&self, _: Variable) -> bool {
        false
    }
}

impl Mission {
    /// The robustness of a run: by how much it does what the mission says, in the unit of the rows.
    /// It is at least 0 if the mission is true, and then the values may change by less than it
    /// before a row fails.
    ///
    /// That of a predicate is the least slack of its rows; `&` and `always` are the least of
    /// theirs, `|` and `eventually` the greatest, `!` the opposite. Beyond the last sample nothing
    /// counts as true.
    ///
    /// # Arguments
    ///
    /// * `samples`: the number of samples of the run.
    /// * `time_step`: in s, for windows in seconds.
    /// * `value`: the value of a handle at a sample; `None` where it has none, as an input at the
    ///   last sample.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::NotConicRow`] for a norm that is negated, [`ErrorKind::OutOfRange`] for a
    /// window without samples.
    pub fn robustness(
        &self,
        samples: usize,
        time_step: f64,
        value: impl Fn(Variable, usize) -> Option<f64>,
    ) -> Result<f64, Error> {
        self.robustness_of(&ValueFunction(value), samples, time_step)
    }

    pub(crate) fn robustness_of(
        &self,
        trajectory: &dyn ValueSource,
        samples: usize,
        time_step: f64,
    ) -> Result<f64, Error> {
        let reading = Reading { trajectory, samples, time_step };
        Ok(at(&reading.values(self, true)?, 0))
    }
}
