//! A plan with other time steps: with half of Δt, and with the least Δt for its number of steps.

use std::fmt;

use super::plan::ScenePlan;
use super::shortest::ScenePrograms;
use super::statement::Scene;
use crate::error::Error;
use crate::hybrid::shortest_horizon::{
    HorizonVerdict, LeastTimeStep, Monotonicity, ShortestHorizon, ShortestOptions, TimeStepGrid,
    decide, least_of,
};
use crate::solver::Solver;

/// A plan beside the shortest one with half of its time step, from
/// [`ScenePlan::compare_half_steps`].
#[derive(Debug, Clone)]
#[non_exhaustive]
#[must_use]
pub struct StepComparison {
    /// The plan.
    pub plan: ScenePlan,
    /// The shortest plan with half of its Δt.
    pub halved: ShortestHorizon<ScenePlan>,
}

impl fmt::Display for StepComparison {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let line = |f: &mut fmt::Formatter<'_>, plan: &ScenePlan| {
            write!(
                f,
                "Δt = {} s: {} steps, {:.6} s, {} hits, off by up to {:.3} m in a step",
                plan.time_step,
                plan.steps(),
                plan.duration(),
                plan.hits.len(),
                plan.certificate.step_error
            )
        };
        line(f, &self.plan)?;
        f.write_str("\n")?;
        match &self.halved.plan {
            Some(halved) => line(f, halved),
            None => write!(f, "{}", self.halved),
        }
    }
}

impl Scene {
    /// The same scene with half of its time step. Courses get a place in the middle of each step,
    /// so that what moves moves as before.
    #[must_use]
    pub fn with_half_steps(&self) -> Scene {
        let mut scene = self.clone();
        scene.time_step *= 0.5;
        for obstacle in &mut scene.obstacles {
            let mut finer: Vec<Vec<f64>> = Vec::new();
            for place in std::mem::take(&mut obstacle.course) {
                if let Some(last) = finer.last() {
                    finer.push(last.iter().zip(&place).map(|(a, b)| 0.5 * (a + b)).collect());
                }
                finer.push(place);
            }
            obstacle.course = finer;
        }
        for rule in &mut scene.rules {
            rule.window = rule.window.map(|steps| 2 * steps);
        }
        scene
    }
}

impl ScenePlan {
    /// Compares the plan with the shortest one of the same scene with half of its time step: by how
    /// much what was found depends on Δt.
    ///
    /// ```
    /// use carom::hybrid::scene::{Body, Scene, Solid, Surface};
    /// use carom::hybrid::{Restitution, ShortestOptions};
    /// use carom::prelude::*;
    ///
    /// let ball = Body::new("ball", [0.0..=2.0], 10.0, 0.0)
    ///     .with_gravity([-9.81])
    ///     .with_start([0.2, 0.0])
    ///     .with_goal([0.0, 0.0]);
    /// let floor = Surface::bounce(Restitution::new(0.3)?).with_rest();
    /// let scene = Scene::new(0.05)
    ///     .with_body(ball)
    ///     .with_obstacle(Solid::halfspace("floor", [1.0], 0.0, floor));
    /// let (options, mut solver) = (ShortestOptions::default(), BranchAndBound::default());
    /// let plan = scene.shortest_with(&options, &mut solver)?.plan.expect("it comes to rest");
    /// let both = plan.compare_half_steps(&scene, &options, &mut solver)?;
    /// assert_eq!(both.halved.time_step, Some(0.025));
    /// assert!(both.to_string().starts_with("Δt = 0.05 s: "));
    /// # Ok::<(), carom::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// Those of [`Scene::shortest`].
    pub fn compare_half_steps(
        &self,
        scene: &Scene,
        options: &ShortestOptions,
        solver: &mut dyn Solver,
    ) -> Result<StepComparison, Error> {
        let mut own = scene.clone();
        own.time_step = self.time_step;
        let halved = own.with_half_steps().shortest_with(&options.halved(), solver)?;
        Ok(StepComparison { plan: self.clone(), halved })
    }

    /// The least time step of some with which the scene has a plan of as many steps as this one,
    /// and refutes all smaller ones of them.
    ///
    /// # Arguments
    ///
    /// * `time_steps`: in s, ascending. Each one below the least is refuted separately, because a
    ///   scene may have a plan with a shorter step and none with a longer one.
    /// * `options`: `max_steps` and `coarse_guess` have no effect.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::OutOfRange`](crate::error::ErrorKind::OutOfRange) for a list that is empty or
    /// not ascending, and for a scene with courses, which are stated for one time step; those of
    /// [`Scene::program`] and of the solver.
    pub fn least_time_step(
        &self,
        scene: &Scene,
        time_steps: impl Into<Vec<f64>>,
        options: &ShortestOptions,
        solver: &mut dyn Solver,
    ) -> Result<LeastTimeStep, Error> {
        if let Some((obstacle, last)) = scene.longest() {
            let what = format!("the number of places of the course of `{}`", obstacle.name);
            let more = " for other time steps, because a course is stated for one";
            return Err(Error::out_of_range_with(what, last as f64 + 1.0, 0.0..=0.0, more));
        }
        let steps = self.steps();
        let grid = TimeStepGrid::new(steps, time_steps);
        least_of(&grid, options, |time_step, token| {
            let stated = Scene { time_step, ..scene.clone() }.stated()?;
            let monotonicity = Monotonicity::NotMonotone("the number of steps is fixed".into());
            let task = ScenePrograms { stated, monotonicity };
            let (attempt, solved) = decide(&task, steps, options, token, solver)?;
            let run = match solved.filter(|_| attempt.verdict == HorizonVerdict::Feasible) {
                Some((program, solution)) => Some(program.plan(&solution)?.run),
                None => None,
            };
            Ok((attempt, run))
        })
    }
}
