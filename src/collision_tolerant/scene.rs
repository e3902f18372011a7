//! A scenario as a scene on a line, as a hybrid system, and as a family of programs over the
//! horizon.

use super::law::ContactLaw;
use super::program::{Objective, PlanningProgram};
use super::scenario::Scenario;
use crate::error::{Error, ErrorKind};
use crate::hybrid::reach::{ReachSets, SetOptions};
use crate::hybrid::scene::{
    Body, DamageLimitOptions, DamageLimitRange, DamageRule, Scene, SceneError, Solid, Surface,
};
use crate::hybrid::{
    Feedback, HorizonModel, HybridProgram, HybridSystem, Monotonicity, Region, RobustPlan,
    ShortestHorizon, ShortestOptions,
};
use crate::interval::Interval;
use crate::solver::Solver;
use crate::tolerance::MAX_STEPS;

/// How many times longer the steps of the coarser grid are, and the number of steps from which it
/// pays.
const COARSER: (f64, usize) = (8.0, 160);

impl Scenario {
    /// The scenario under the reflecting law as a scene on a line: one body, one wall.
    ///
    /// # Arguments
    ///
    /// * `positions`: the domain, in m.
    pub(super) fn scene(
        &self,
        positions: Interval,
        rules: impl IntoIterator<Item = DamageRule>,
    ) -> Scene {
        let surface = match self.law {
            ContactLaw::Forbidden => Surface::avoid(),
            _ => Surface::bounce(self.restitution).with_spread(self.spread),
        };
        let mut vehicle =
            Body::new("vehicle", [positions], self.max_speed, self.acceleration.magnitude())
                .with_acceleration([self.acceleration])
                .with_start(self.start_state())
                .with_goal(self.goal_states());
        if let Some(first) = self.start.acceleration {
            vehicle = vehicle.with_first_acceleration([first]);
        }
        if self.pushes != Interval::point(0.0) {
            vehicle = vehicle.with_pushes([self.pushes]);
        }
        let n = self.wall.normal();
        let scene = Scene::new(self.time_step)
            .with_body(vehicle)
            .with_obstacle(Solid::halfspace("wall", [n], n * self.wall.position(), surface))
            .with_estimate(self.estimate);
        rules.into_iter().fold(scene, Scene::with_rule)
    }

    /// The scene over a horizon, with the rule of the scenario.
    pub(super) fn scene_over(&self, steps: usize) -> Scene {
        self.scene(self.positions(steps), [self.damage.clone()])
    }

    /// The scenario as a hybrid system with the states `vehicle x` (m) and `vehicle vx` (m/s), the
    /// input `vehicle ax` (m/s²) and the transitions 0, the flight, and 1, the contact, if
    /// collisions are tolerated: the [system of its scene](Scene::hybrid_system), or the paper's
    /// own under the literal law.
    ///
    /// A limit on the cumulative damage acts as a limit on each contact.
    ///
    /// # Errors
    ///
    /// Those of [`Scenario::check`].
    pub fn hybrid_system(&self) -> Result<HybridSystem, Error> {
        self.check()?;
        self.widest().system(MAX_STEPS)
    }

    /// The system over a horizon, of a scenario that has been checked.
    pub(super) fn system(&self, steps: usize) -> Result<HybridSystem, Error> {
        match self.law {
            ContactLaw::Literal => self.literal_system(self.positions(steps)),
            _ => self.scene_over(steps).hybrid_system(),
        }
    }

    /// The limits of one step that all plans have in common: what may be damaged in all steps
    /// together is the most in each of them.
    fn widest(&self) -> Scenario {
        let mut widest = self.clone();
        let most = [self.damage.per_hit, self.damage.total].into_iter().flatten();
        widest.damage.per_hit = most.reduce(f64::min);
        // As explanations name it.
        widest.damage.name = "the limit on the impact speed".to_owned();
        widest
    }

    /// The state in which a plan starts.
    pub(super) fn start_state(&self) -> Region {
        Region::point([self.start.position, self.start.velocity])
    }

    /// Reach sets of the scenario: forward from its start, backward from its goal.
    ///
    /// ```
    /// use carom::collision_tolerant::Scenario;
    ///
    /// // The paper's scenario at e = 0.5: 484 steps are refuted without solving anything.
    /// let mut sets = Scenario::paper().with_restitution(0.5)?.reach_sets()?;
    /// assert!(sets.tube(484)?.is_empty());
    /// let tube = sets.tube(485)?;
    /// assert_eq!((0..485).filter(|&t| tube.is_possible(t, 1)).count(), 1);
    /// # Ok::<(), carom::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// Those of [`Scenario::check`].
    pub fn reach_sets(&self) -> Result<ReachSets, Error> {
        self.check()?;
        let widest = self.widest();
        if self.law != ContactLaw::Literal {
            return widest.scene_over(MAX_STEPS).reach_sets();
        }
        let (system, options) = (widest.system(MAX_STEPS)?, SetOptions::default());
        let sets = ReachSets::new(&system, self.start_state(), self.goal_states(), options)?;
        match self.start.acceleration {
            Some(a) => sets.with_first_inputs(&[Interval::point(a)]),
            None => Ok(sets),
        }
    }

    /// Finds the limits `D_max` for which a horizon is the shortest, as
    /// [`Scene::damage_limit_range`] does; equation (19).
    ///
    /// ```
    /// use carom::collision_tolerant::Scenario;
    /// use carom::hybrid::scene::DamageLimitOptions;
    /// use carom::prelude::*;
    ///
    /// let scenario = Scenario::paper().with_time_step(0.05);
    /// let (options, mut solver) = (DamageLimitOptions::default(), BranchAndBound::default());
    /// let interval = scenario.damage_limit_range(49, &options, &mut solver)?;
    /// assert!((interval.lower.attained - 5.895).abs() < 2e-3);
    /// assert!((interval.upper.attained - 6.947).abs() < 2e-3);
    /// # Ok::<(), carom::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// As for [`Scene::damage_limit_range`], and [`SceneError::NoDamageLimitRange`] under the
    /// literal law.
    pub fn damage_limit_range(
        &self,
        steps: usize,
        options: &DamageLimitOptions,
        solver: &mut dyn Solver,
    ) -> Result<DamageLimitRange, Error> {
        self.check()?;
        if self.law == ContactLaw::Literal {
            let reason = "scenes do not have the literal law; choose the reflecting one".into();
            return Err(SceneError::NoDamageLimitRange { reason }.into());
        }
        self.scene_over(steps).damage_limit_range(steps, options, solver)
    }

    /// The smallest number of steps for which a plan brings all disturbed runs to the goal, if the
    /// feedback corrects the accelerations: as [`Scene::shortest_robust`]. The number of impacts is
    /// not minimised. The goal has to be a [region](Scenario::with_goal_region).
    ///
    /// # Errors
    ///
    /// Those of [`shortest`](Scenario::shortest) and of [`robust`](HybridProgram::robust);
    /// [`ErrorKind::Unsupported`] under the literal law, whose contact fixes the acceleration that
    /// a feedback would correct.
    pub fn shortest_robust(
        &self,
        feedback: &Feedback,
        options: &ShortestOptions,
        solver: &mut dyn Solver,
    ) -> Result<ShortestHorizon<RobustPlan>, Error> {
        self.check()?;
        if self.law == ContactLaw::Literal {
            return Err(ErrorKind::Unsupported {
                solver: "the literal law".into(),
                what: "feedback on the acceleration".into(),
                help: "choose the reflecting law".into(),
            }
            .into());
        }
        self.scene_over(options.max_steps).shortest_robust(feedback, options, solver)
    }
}

/// The programs of the scenario over all horizons, each of which takes any plan.
///
/// ```
/// use carom::collision_tolerant::Scenario;
/// use carom::hybrid::shortest_horizon;
/// use carom::prelude::*;
///
/// // A plan of the shortest horizon, with as many impacts as it happens to have.
/// let scenario = Scenario::paper().with_time_step(0.05);
/// let options = ShortestOptions::default();
/// let found = shortest_horizon(&scenario, &options, &mut BranchAndBound::default())?;
/// let found = found.try_map(|solved| solved.program.plan(&solved.solution))?;
/// assert!(found.plan.is_some_and(|plan| plan.trajectory.steps() == found.steps.unwrap_or(0)));
/// # Ok::<(), carom::Error>(())
/// ```
impl HorizonModel for Scenario {
    type Program = PlanningProgram;

    fn build(&self, steps: usize) -> Result<PlanningProgram, Error> {
        self.program(steps, Objective::Feasibility)
    }

    fn monotonicity(&self) -> Monotonicity {
        Scenario::monotonicity(self)
    }

    /// Full acceleration from the start without stopping. A guess, not a bound.
    fn lower_hint(&self) -> usize {
        let distance = self.distance();
        let (speed, acceleration) = (self.start.velocity.abs(), self.max_acceleration());
        let sprint = if acceleration > 0.0 {
            ((speed * speed + 2.0 * acceleration * distance).sqrt() - speed) / acceleration
        } else {
            0.0
        };
        let time = sprint.max(distance / self.max_speed);
        ((time / self.time_step) as usize).max(1)
    }

    fn reach_sets(&self) -> Result<Option<ReachSets>, Error> {
        Scenario::reach_sets(self).map(Some)
    }

    fn time_step(&self) -> Option<f64> {
        Some(self.time_step)
    }

    fn ends(&self) -> Result<Option<(HybridSystem, Region, Region)>, Error> {
        let [first, last] = [&self.start, &self.goal].map(|end| end.acceleration);
        if first.zip(last).is_some_and(|(first, last)| first != last) {
            return Ok(None);
        }
        Ok(Some((self.system(1)?, self.start_state(), self.goal_states())))
    }

    fn with_hybrid(
        &self,
        program: &mut PlanningProgram,
        statements: &mut dyn FnMut(&mut HybridProgram),
    ) {
        statements(program.program_mut());
    }

    fn coarser(&self) -> Option<Box<dyn HorizonModel<Program = PlanningProgram> + '_>> {
        let (factor, worth) = COARSER;
        let can = self.law != ContactLaw::Forbidden && self.lower_hint() >= worth;
        let coarse = self.clone().with_time_step(factor * self.time_step);
        can.then(|| Box::new(coarse) as Box<_>)
    }
}
