//! Plans of hybrid programs: replayed when they are read.

use std::fmt;
use std::sync::Arc;

use super::{AtSample, ProgramSystems};
use crate::error::Error;
#[cfg(doc)]
use crate::error::ErrorKind;
use crate::hybrid::rows::HybridRun;
use crate::hybrid::simulate::RunCertificate;
use crate::hybrid::system::HybridSystem;
use crate::model::{Affine, Variable};
use crate::solution::Solution;

/// A plan of a [`HybridProgram`](super::HybridProgram), which has been
/// [certified](crate::hybrid::HybridSystem::certify).
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct HybridPlan {
    /// The run of the program's system, in numbers and names; of the first one if there are
    /// several.
    pub run: HybridRun,
    /// How it agrees with the system as it is stated, replayed without the program's rows.
    pub certificate: RunCertificate,
    /// The solution from which it comes, with its objective, bound and counts.
    pub solution: Solution,
    systems: Arc<ProgramSystems>,
    /// Runs and certificates of the further systems, in the order in which they joined.
    others: Vec<(HybridRun, RunCertificate)>,
}

/// A table of comma-separated values with a line per sample, after a comment that says the
/// objective. Further systems have tables of their own, each after a comment with its name. Where
/// the system states disturbances, a comment says that the plan is nominal. Comments begin with
/// `#`.
impl fmt::Display for HybridPlan {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.system().is_disturbed() {
            let text =
                "# nominal: it is a plan without disturbance, and promises nothing under one";
            writeln!(f, "{text}")?;
        }
        if let Some(objective) = self.solution.objective() {
            writeln!(f, "# objective {objective}, {}", self.solution.termination())?;
        }
        self.systems.all.iter().zip(self.runs()).try_for_each(|((name, _), run)| {
            if !name.is_empty() {
                writeln!(f, "# {}", name.escape_debug())?;
            }
            f.write_str(&run.to_csv())
        })
    }
}

impl HybridPlan {
    pub(super) fn of(systems: &Arc<ProgramSystems>, solution: &Solution) -> Result<Self, Error> {
        let (run, certificate) = systems.first().certified(solution)?;
        systems.check_missions(solution)?;
        let others = systems.iter().skip(1).map(|own| own.certified(solution));
        let others = others.collect::<Result<_, Error>>()?;
        let (systems, solution) = (systems.clone(), solution.clone());
        Ok(HybridPlan { run, certificate, solution, systems, others })
    }

    pub(crate) fn systems(&self) -> &ProgramSystems {
        &self.systems
    }

    /// The system of the plan, the first one if there are several.
    pub(crate) fn system(&self) -> &HybridSystem {
        self.systems.first().system()
    }

    /// The number of steps.
    pub fn steps(&self) -> usize {
        self.systems.steps
    }

    /// The runs of all systems.
    pub(super) fn runs(&self) -> impl Iterator<Item = &HybridRun> {
        std::iter::once(&self.run).chain(self.others.iter().map(|(run, _)| run))
    }

    /// The run and the certificate of a system that has [joined](super::HybridProgram::join).
    ///
    /// # Errors
    ///
    /// [`ErrorKind::UnknownName`].
    pub fn joined(&self, name: &str) -> Result<(&HybridRun, &RunCertificate), Error> {
        let names = self.systems.all.iter().skip(1).map(|(own, _)| own);
        let mut found = names.zip(&self.others).filter(|(own, _)| *own == name);
        let found = found.next().map(|(_, (run, certificate))| (run, certificate));
        let kind = "system that has joined the program";
        found.ok_or_else(|| Error::unknown_name(name, kind))
    }

    /// The value of an expression of handles, or of variables of the model, at a sample.
    ///
    /// # Errors
    ///
    /// Those of [`HybridProgram::at`](super::HybridProgram::at).
    pub fn value(&self, expression: impl Into<Affine>, sample: usize) -> Result<f64, Error> {
        self.solution.value(expression.into().at_sample(&self.systems, sample)?)
    }

    /// The values of a state or mode at the samples 0, ..., τ, or of an input, a transition or an
    /// output in the steps 0, ..., τ-1.
    ///
    /// # Errors
    ///
    /// Those of [`HybridProgram::at`](super::HybridProgram::at).
    pub fn values(&self, of: impl Into<Variable>) -> Result<Vec<f64>, Error> {
        self.systems.values(of.into(), &self.solution)
    }

    /// Whether a mode or a transition is on at a sample.
    ///
    /// # Errors
    ///
    /// Those of [`HybridProgram::at`](super::HybridProgram::at).
    pub fn is_on(&self, of: Variable, sample: usize) -> Result<bool, Error> {
        Ok(self.value(of, sample)? > 0.5)
    }

    /// At how many samples, or in how many steps, a mode or a transition is on.
    ///
    /// # Errors
    ///
    /// Those of [`HybridProgram::at`](super::HybridProgram::at).
    pub fn count(&self, of: Variable) -> Result<usize, Error> {
        Ok(self.values(of)?.iter().filter(|value| **value > 0.5).count())
    }
}
