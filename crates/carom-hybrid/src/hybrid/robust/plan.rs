//! Plans that hold for every disturbance, and their promise in words.

use std::fmt;

use super::certificate::{MISS, RobustCertificate, certify};
use super::feedback::Feedback;
use super::program::{RobustProgram, own_start};
use super::tighten::{TightRow, TightStatement};
#[cfg(doc)]
use crate::error::ErrorKind;
use crate::error::{Error, RobustError};
use crate::hybrid::program::HybridPlan;
use crate::hybrid::simulate::DisturbedRun;
#[cfg(doc)]
use crate::hybrid::system::HybridSystem;
use crate::hybrid::system::Measure;
use crate::interval::Interval;
use crate::model::{Family, Sense, Variable};
use crate::number::{DIGITS, rounded};
use crate::tolerance::margin_scale;

/// A plan that holds for every disturbance within the ranges of its system, which has been
/// certified by interval simulation.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct RobustPlan {
    /// The plan without disturbance, around which the feedback keeps the runs.
    pub plan: HybridPlan,
    /// The findings of interval simulation about all disturbed runs.
    pub certificate: RobustCertificate,
    feedback: Feedback,
    /// For the system in the coordinates of the program.
    own_feedback: Feedback,
    start: Vec<Interval>,
    sense: Sense,
    radius: Vec<Family>,
    tightened: Vec<TightStatement>,
}

/// The promise, the price if it is known, and the plan with the width of each state.
impl fmt::Display for RobustPlan {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let system = self.plan.system();
        let mut ranges = Vec::new();
        for ((name, _), range) in system.states.iter().zip(&self.start) {
            if range.magnitude() > 0.0 {
                ranges.push(format!("{name} at the start by [{}, {}]", range.lower, range.upper));
            }
        }
        for ((name, _), range) in system.states.iter().zip(&system.disturbance) {
            if range.magnitude() > 0.0 {
                ranges.push(format!("{name} by [{}, {}]", range.lower, range.upper));
            }
        }
        for own in system.transitions() {
            let parameters = own.uncertain.iter().filter(|p| p.range.magnitude() > 0.0);
            ranges.extend(parameters.map(|parameter| {
                let Interval { lower, upper } = parameter.range;
                format!("the parameter of `{}` by [{lower}, {upper}]", own.name)
            }));
        }
        match ranges.is_empty() {
            true => writeln!(f, "nothing disturbs the system: the plan is the nominal one")?,
            false => writeln!(
                f,
                "for every disturbance in these ranges, in every step anew, the run takes these \
                 transitions and keeps every limit: {}",
                ranges.join(", ")
            )?,
        }
        for (i, (name, _)) in system.states.iter().enumerate() {
            let widths = self.certificate.states.iter().map(|sample| sample[i].magnitude());
            let most = rounded(widths.fold(0.0, f64::max), DIGITS.min(4));
            writeln!(f, "{name} stays within {most} of the plan")?;
        }
        if let Some(objective) = self.plan.solution.objective() {
            writeln!(f, "objective {objective}, {}", self.plan.solution.termination())?;
        }
        f.write_str(&self.plan.run.to_csv())
    }
}

/// The certificate of a plan, found in the coordinates of its program and with the errors of states
/// in the user's units.
fn certified(
    plan: &HybridPlan,
    feedback: &Feedback,
    start: &[Interval],
    scale: f64,
) -> Result<RobustCertificate, Error> {
    let own = plan.systems().first();
    let coordinates = own.coordinates();
    let run = match plan.solution.point().filter(|_| !coordinates.is_plain()) {
        Some(point) => &own.read_own(point)?,
        None => &plan.run,
    };
    let start = own_start(coordinates, start);
    let mut certificate = certify(own.computed(), run, feedback, &start, scale)?;
    for errors in &mut certificate.states {
        for (i, error) in errors.iter_mut().enumerate() {
            *error = Measure::unit(coordinates.state(i).scale).outward_range(*error);
        }
    }
    Ok(certificate)
}

impl RobustPlan {
    /// Of a plan of the program with the tube.
    pub(super) fn of(program: &RobustProgram, plan: HybridPlan) -> Result<Self, Error> {
        let start = &program.start;
        let certificate = certified(&plan, &program.own_feedback, start, 1.0)?;
        let robust = RobustPlan {
            plan,
            certificate,
            feedback: program.feedback.clone(),
            own_feedback: program.own_feedback.clone(),
            start: start.clone(),
            sense: program.program.model().sense(),
            radius: program.radius.clone(),
            tightened: program.tightened.clone(),
        };
        robust.check_statements(&robust.certificate)?;
        Ok(robust)
    }

    /// The feedback by which the plan is flown: `u = v + K (x - z)`.
    pub fn feedback(&self) -> &Feedback {
        &self.feedback
    }

    /// Certifies the plan again, for ranges that are `scale` times those of the system and of the
    /// start.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::Robust`] with the condition that some disturbance may violate.
    pub fn certify(&self, scale: f64) -> Result<RobustCertificate, Error> {
        let certificate = certified(&self.plan, &self.own_feedback, &self.start, scale)?;
        self.check_statements(&certificate)?;
        Ok(certificate)
    }

    /// By how much the objective is worse than that of a nominal plan: the price of the promise, in
    /// the objective's unit. `None` if a plan has no objective.
    pub fn price(&self, nominal: &HybridPlan) -> Option<f64> {
        let own = self.plan.solution.objective()?;
        let worse = own - nominal.solution.objective()?;
        Some(self.sense.sign() * worse)
    }

    /// Flies the plan in a disturbed world, with its feedback; see [`HybridSystem::fly`]. `draw` is
    /// asked for the errors of the start first.
    ///
    /// # Errors
    ///
    /// None for the plan's own system.
    pub fn simulate(&self, draw: &mut dyn FnMut(Interval) -> f64) -> Result<DisturbedRun, Error> {
        let by =
            self.start.iter().map(|range| if range.magnitude() > 0.0 { draw(*range) } else { 0.0 });
        let by = by.collect::<Vec<_>>();
        self.plan.system().fly_from(&by, &self.plan.run, self.feedback.gain(), draw)
    }

    /// Checks the statements of the program over the boxes of a certificate.
    fn check_statements(&self, certificate: &RobustCertificate) -> Result<(), Error> {
        let Some(point) = self.plan.solution.point() else { return Ok(()) };
        let value = |variable: Variable| -> f64 {
            let own = self.radius.iter().enumerate().find_map(|(k, family)| {
                let sample = family.iter().position(|own| own == variable)?;
                Some(certificate.errors.get(sample)?.get(k)?.magnitude())
            });
            own.unwrap_or_else(|| point.value(variable).unwrap_or(f64::NAN))
        };
        for TightStatement { statement, condition, row, width } in &self.tightened {
            let is_on = |variable: Variable| value(variable) > 0.5;
            if condition.as_ref().is_some_and(|condition| !condition.is_true(is_on)) {
                continue;
            }
            let half = width.evaluate(value);
            let (violation, size) = match row {
                TightRow::Linear(row) => {
                    let sum: f64 = row.terms.iter().map(|&(v, a)| a * value(v)).sum();
                    let sizes = row.terms.iter().map(|&(v, a)| (a * value(v)).abs());
                    let miss = (sum + half - row.upper).max(row.lower - sum + half);
                    (miss, sizes.fold(0.0, f64::max))
                }
                TightRow::Norm { entries, bound } => {
                    let length = entries
                        .iter()
                        .fold(0.0_f64, |length, entry| length.hypot(entry.evaluate(value)));
                    (length + half - bound.evaluate(value), length)
                }
            };
            // NaN fails as well.
            if violation.is_nan() || violation > MISS * margin_scale(size, 0.0) {
                let statement = statement.clone();
                return Err(RobustError::Violated { statement, violation }.into());
            }
        }
        Ok(())
    }
}
