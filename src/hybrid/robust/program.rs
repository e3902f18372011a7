//! Programs whose plans hold for every disturbance.

use std::borrow::{Borrow, BorrowMut};

use super::error::RobustError;
use super::feedback::Feedback;
use super::plan::RobustPlan;
use super::tighten::{StatementTightening, TightStatement};
use super::tube::ErrorTube;
use crate::error::Error;
#[cfg(doc)]
use crate::error::ErrorKind;
use crate::hybrid::program::HybridProgram;
use crate::model::{Family, Model};
use crate::solution::Solution;
use crate::solver::{Control, Solver};

/// The program of plans that hold for every disturbance within the ranges that its system states, made by
/// [`HybridProgram::robust`].
#[derive(Debug, Clone)]
pub struct RobustProgram {
    pub(super) program: HybridProgram,
    pub(super) feedback: Feedback,
    pub(super) radius: Vec<Family>,
    pub(super) tightened: Vec<TightStatement>,
}

impl HybridProgram {
    /// The program whose plans hold for every disturbance and every uncertain parameter within the ranges of
    /// its system, if the feedback corrects the inputs: a plan with a *tube* around it.
    ///
    /// The tube is known at the start, and its half widths are variables: they grow by
    /// [disturbances](crate::hybrid::HybridSystem::disturbance) and
    /// [uncertain parameters](crate::hybrid::TransitionMut::uncertain), and shrink or grow by the feedback and by the
    /// transitions that the plan takes. Domains, limits, guards, ranges of inputs, and everything that the
    /// program requires of states, inputs and outputs, are tightened by what the tube takes; so all runs
    /// take the transitions of the plan. The objective is that of the plan without disturbance.
    ///
    /// In a step, at most one choice changes how an error continues; two of them at once are left out.
    ///
    /// ```
    /// use carom::hybrid::Feedback;
    /// use carom::prelude::*;
    ///
    /// let mut cart = HybridSystem::new(0.5); // s
    /// let x = cart.state("x", 0.0, 9.0)?; // m
    /// let v = cart.state("v", -2.0, 2.0)?; // m/s
    /// let a = cart.input("a", -1.0, 1.0)?; // m/s²
    /// cart.disturbance(v, -0.05, 0.05)?;
    /// cart.mode("roll")?.rates([x.is(v), v.is(a)])?;
    ///
    /// let mut program = cart.program(8)?;
    /// program.start([x.equals(1.0), v.equals(0.0)])?;
    /// program.goal([x.within(3.5, 4.5), v.within(-0.3, 0.3)])?;
    /// program.minimize(program.sum(a.square())?)?;
    /// let feedback = Feedback::regulator(&cart)?;
    /// let plan = program.robust(&feedback)?.solve(&mut BranchAndBound::default())?;
    /// assert!(plan.to_string().contains("for every disturbance"));
    /// let run = plan.simulate(&mut |range| range.upper)?;
    /// assert!(run.kept && run.run.state("x")?[8] <= 4.5 + 1e-6);
    /// # Ok::<(), carom::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`ErrorKind::Other`] with a [`RobustError`] as its source for a program of several systems, for a
    /// statement that cannot be tightened, and for one that requires a single value where runs differ;
    /// [`ErrorKind::DuplicateName`] for names that begin with `tube`.
    #[doc(alias("tube", "robust optimisation", "constraint tightening"))]
    pub fn robust(&self, feedback: &Feedback) -> Result<RobustProgram, Error> {
        let Some(own) = self.members.only() else {
            return Err(RobustError::SeveralSystems { count: self.members.iter().count() }.into());
        };
        let (found, expected) = (feedback.gain().ncols(), own.system().states.len());
        if found != expected || feedback.gain().nrows() != own.system().inputs.len() {
            return Err(RobustError::OtherSystem { found, expected }.into());
        }
        let mut robust = RobustProgram {
            program: self.clone(),
            feedback: feedback.clone(),
            radius: Vec::new(),
            tightened: Vec::new(),
        };
        if !own.system().is_disturbed() {
            return Ok(robust);
        }
        let model = robust.program.model_mut();
        let tube = ErrorTube::write(model, own, feedback)?;
        robust.tightened = StatementTightening::write(model, self, &tube)?;
        robust.radius = tube.radius;
        Ok(robust)
    }
}

impl RobustProgram {
    /// The program with its tube; its plans by [`HybridProgram::solve`] are the same without the feedback and
    /// the promise.
    pub fn program(&self) -> &HybridProgram {
        &self.program
    }

    /// Solves the program. Plans come with a [certificate](super::RobustCertificate) by interval simulation.
    ///
    /// # Errors
    ///
    /// Those of [`HybridProgram::solve`]; [`ErrorKind::Other`] with a [`RobustError`] as its source for a
    /// plan that is not certified.
    pub fn solve(&self, solver: &mut dyn Solver) -> Result<RobustPlan, Error> {
        self.solve_with(solver, &mut Control::default())
    }

    /// Solves the program with events, warm starts and limits, as [`solve`](RobustProgram::solve).
    ///
    /// # Errors
    ///
    /// Those of [`solve`](RobustProgram::solve).
    pub fn solve_with(
        &self,
        solver: &mut dyn Solver,
        control: &mut Control<'_>,
    ) -> Result<RobustPlan, Error> {
        self.plan(&solver.solve_with(self.program.model(), control)?)
    }

    /// The certified plan of a solution of the program's model.
    ///
    /// # Errors
    ///
    /// Those of [`solve`](RobustProgram::solve) that do not come from the solver.
    pub fn plan(&self, solution: &Solution) -> Result<RobustPlan, Error> {
        RobustPlan::of(self, solution)
    }
}

impl From<RobustProgram> for HybridProgram {
    /// The program with its tube, for controllers.
    fn from(program: RobustProgram) -> Self {
        program.program
    }
}

impl Borrow<Model> for RobustProgram {
    fn borrow(&self) -> &Model {
        self.program.model()
    }
}

impl BorrowMut<Model> for RobustProgram {
    fn borrow_mut(&mut self) -> &mut Model {
        self.program.model_mut()
    }
}
