//! Programs whose plans hold for every disturbance.

use std::collections::BTreeSet;

use super::feedback::Feedback;
use super::plan::RobustPlan;
use super::tighten::{StatementTightening, TightStatement};
use super::tube::ErrorTube;
use super::words::meetings;
use crate::error::{Error, ErrorKind, RobustError};
use crate::hybrid::program::HybridProgram;
use crate::hybrid::system::{Coordinates, HybridSystem, Meaning, Measure, State};
use crate::interval::Interval;
use crate::model::{Family, Model};
use crate::solution::Solution;
use crate::solver::{Control, Solver};

/// The program of plans that hold for every disturbance within the ranges that its system states,
/// made by [`HybridProgram::robust`].
#[derive(Debug, Clone)]
pub struct RobustProgram {
    pub(super) program: HybridProgram,
    pub(super) feedback: Feedback,
    /// For the system in the coordinates of the program.
    pub(super) own_feedback: Feedback,
    /// By how much each state may be off at the first sample.
    pub(super) start: Vec<Interval>,
    pub(super) radius: Vec<Family>,
    pub(super) tightened: Vec<TightStatement>,
}

impl HybridProgram {
    /// The program whose plans hold for every disturbance and every uncertain parameter within the
    /// ranges of its system, if the feedback corrects the inputs: a plan with a *tube* around it.
    ///
    /// The tube is known at the start, and its half widths are variables: they grow by
    /// [disturbances](crate::hybrid::HybridSystem::disturbance) and [uncertain
    /// parameters](crate::hybrid::TransitionMut::uncertain), and shrink or grow by the feedback and
    /// by the transitions that the plan takes. Domains, limits, guards, ranges of inputs, and
    /// everything that the program requires of states, inputs and outputs, are tightened by what
    /// the tube takes; so all runs take the transitions of the plan. The objective is that of the
    /// plan without disturbance.
    ///
    /// A tube never ends a step in one value, so none goes between modes whose invariants meet in
    /// one: see [`RobustError::NoCrossing`].
    ///
    /// In a step, at most one choice changes how an error continues; two of them at once are left
    /// out.
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
    /// [`ErrorKind::Robust`] for a program of several systems, for a statement that cannot be
    /// tightened, and for one that requires a single value where runs differ;
    /// [`ErrorKind::DuplicateName`] for names that begin with `tube`.
    #[doc(alias("tube", "robust optimisation", "constraint tightening"))]
    pub fn robust(&self, feedback: &Feedback) -> Result<RobustProgram, Error> {
        let none: [(State, Interval); 0] = [];
        self.robust_from(feedback, none)
    }

    /// As [`robust`](HybridProgram::robust), if the start is not known exactly either: the first
    /// state of a run may differ from that of the plan by ranges, such as those of a sensor. The
    /// tube begins with the box of these ranges, and the feedback and the conditions of the first
    /// step have to bear it.
    ///
    /// Equations of states at the first sample say where the plan starts. Everything else that is
    /// required there is required of all starts.
    ///
    /// ```
    /// use carom::hybrid::Feedback;
    /// use carom::prelude::*;
    ///
    /// let mut cart = HybridSystem::new(1.0); // s
    /// let x = cart.state("x", 0.0, 9.0)?; // m
    /// let u = cart.input("u", -1.0, 1.0)?; // m
    /// cart.mode("roll")?.next([x.is(x + u)])?;
    /// let mut program = cart.program(4)?;
    /// program.start([x.equals(1.0)])?;
    /// program.goal([x.within(2.9, 3.1)])?;
    /// // Half of an error is left after each step.
    /// let feedback = Feedback::new(&cart, [[-0.5]])?;
    /// let program = program.robust_from(&feedback, [(x, -0.4..=0.4)])?;
    /// let plan = program.solve(&mut BranchAndBound::default())?;
    /// let run = plan.simulate(&mut |range| range.upper)?;
    /// assert!((run.run.state("x")?[0] - 1.4).abs() < 1e-6);
    /// assert!(run.kept && run.run.state("x")?[4] < 3.1 + 1e-6);
    /// # Ok::<(), carom::Error>(())
    /// ```
    ///
    /// # Arguments
    ///
    /// * `start`: by how much a state may be off at the first sample, in its unit; 0 for those that
    ///   are not named.
    ///
    /// # Errors
    ///
    /// Those of [`robust`](HybridProgram::robust); [`ErrorKind::ForeignHandle`] and
    /// [`ErrorKind::Misplaced`] for what is no state of the system; [`ErrorKind::DuplicateName`]
    /// for one that is named twice; [`ErrorKind::NotFinite`] and [`ErrorKind::CrossedBounds`] for a
    /// range.
    pub fn robust_from<R: Into<Interval>>(
        &self,
        feedback: &Feedback,
        start: impl IntoIterator<Item = (State, R)>,
    ) -> Result<RobustProgram, Error> {
        let Some(own) = self.systems.only() else {
            return Err(RobustError::SeveralSystems { count: self.systems.iter().count() }.into());
        };
        let (found, expected) = (feedback.gain().ncols(), own.system().states.len());
        if found != expected || feedback.gain().nrows() != own.system().inputs.len() {
            return Err(RobustError::OtherSystem { found, expected }.into());
        }
        for (u, (name, _)) in own.system().inputs.iter().enumerate() {
            let corrects = (0..expected).any(|i| feedback.gain()[(u, i)] != 0.0);
            if corrects && own.system().values_of_input(u).is_some() {
                return Err(RobustError::FiniteInput { input: name.clone() }.into());
            }
        }
        let mut robust = RobustProgram {
            program: self.clone(),
            feedback: feedback.clone(),
            own_feedback: feedback.restated(own.coordinates()),
            start: start_errors(own.system(), start)?,
            radius: Vec::new(),
            tightened: Vec::new(),
        };
        let is_exact = robust.start.iter().all(|range| range.magnitude() == 0.0);
        if is_exact && !own.system().is_disturbed() {
            return Ok(robust);
        }
        let model = robust.program.model_mut();
        let start = own_start(own.coordinates(), &robust.start);
        let start = start.iter().map(|range| range.magnitude()).collect::<Vec<_>>();
        let tube =
            ErrorTube::write(model, own, &robust.own_feedback, (!is_exact).then_some(&start))?;
        robust.tightened = StatementTightening::write(model, self, &tube)?;
        robust.radius = tube.radius;
        Ok(robust)
    }
}

/// The ranges by which states may be off at the first sample, in coordinates.
pub(super) fn own_start(coordinates: &Coordinates, start: &[Interval]) -> Vec<Interval> {
    let own = |(i, range): (usize, &Interval)| {
        Measure::unit(coordinates.state(i).scale).inward_range(*range)
    };
    start.iter().enumerate().map(own).collect()
}

/// The ranges by which states may be off at the first sample.
fn start_errors<R: Into<Interval>>(
    system: &HybridSystem,
    start: impl IntoIterator<Item = (State, R)>,
) -> Result<Vec<Interval>, Error> {
    let place = "the error of the start";
    let mut errors = vec![Interval::point(0.0); system.states.len()];
    let mut named = BTreeSet::new();
    for (state, range) in start {
        let (handle, range) = (state.into(), range.into());
        let Meaning::State(i) = *system.meaning(handle, place)? else {
            return Err(system.misplaced(handle, place, "name a state"));
        };
        let name = &system.states[i].0;
        if !named.insert(i) {
            return Err(Error::duplicate_name(name, "state of the error of the start"));
        }
        range.check(&format!("the error of the start of `{name}`"))?;
        errors[i] = range;
    }
    Ok(errors)
}

impl RobustProgram {
    /// The program with its tube; its plans by [`HybridProgram::solve`] are the same without the
    /// feedback and the promise.
    pub fn program(&self) -> &HybridProgram {
        &self.program
    }

    /// Solves the program. Plans come with a [certificate](super::RobustCertificate) by interval
    /// simulation.
    ///
    /// # Errors
    ///
    /// Those of [`HybridProgram::solve`]; [`ErrorKind::Robust`] for a plan that is not certified.
    /// If there is no plan, and modes of the system meet in one value, so that no tube goes between
    /// them, the source of [`ErrorKind::NoPlan`] is [`RobustError::NoCrossing`].
    pub fn solve(&self, solver: &mut dyn Solver) -> Result<RobustPlan, Error> {
        self.solve_with(&mut Control::default(), solver)
    }

    /// Solves the program with events, warm starts and limits, as [`solve`](RobustProgram::solve).
    ///
    /// # Errors
    ///
    /// Those of [`solve`](RobustProgram::solve).
    pub fn solve_with(
        &self,
        control: &mut Control<'_>,
        solver: &mut dyn Solver,
    ) -> Result<RobustPlan, Error> {
        let solution = solver.solve_with(self.program.model(), control)?;
        self.check_crossings(&solution)?;
        RobustPlan::of(self, self.program.plan_by(&solution, solver)?)
    }

    /// The certified plan of a solution of the program's model.
    ///
    /// # Errors
    ///
    /// Those of [`solve`](RobustProgram::solve) that do not come from the solver.
    pub fn plan(&self, solution: &Solution) -> Result<RobustPlan, Error> {
        self.check_crossings(solution)?;
        RobustPlan::of(self, self.program.plan(solution)?)
    }

    /// Refuses a program without a plan whose modes meet in one value.
    fn check_crossings(&self, solution: &Solution) -> Result<(), Error> {
        // Without a tube there is nothing that cannot cross.
        if solution.is_infeasible()
            && !self.radius.is_empty()
            && let Some(meeting) = meetings(self.program.system()).first()
        {
            let termination = solution.termination().to_string();
            let help = "no tube goes between two of the modes, see the source of this error; \
                        `carom::explain::infeasibility` says which statements contradict each other";
            let kind = ErrorKind::NoPlan { termination, help };
            return Err(Error::with_source(kind, meeting.error()));
        }
        Ok(())
    }
}

impl From<RobustProgram> for HybridProgram {
    /// The program with its tube, for controllers.
    fn from(program: RobustProgram) -> Self {
        program.program
    }
}

impl AsRef<Model> for RobustProgram {
    fn as_ref(&self) -> &Model {
        self.program.model()
    }
}

impl AsMut<Model> for RobustProgram {
    fn as_mut(&mut self) -> &mut Model {
        self.program.model_mut()
    }
}
