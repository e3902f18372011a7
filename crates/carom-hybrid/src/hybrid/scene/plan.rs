//! Plans of a scene, read from solutions and replayed.

use std::collections::BTreeMap;

use super::axes::AXES;
use super::contact::Mode;
use super::program::SceneProgram;
use super::replay::SceneCertificate;
use super::statement::Scene;
use crate::error::{Error, ErrorKind, SceneError, check_length};
use crate::hybrid::rows::HybridRun;
use crate::solution::Solution;
use crate::solver::{Control, Solver};

/// The path of a body.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct BodyPath {
    /// Its name.
    pub name: String,
    /// Position at each sample, in m.
    pub position: Vec<Vec<f64>>,
    /// Velocity at each sample, in m/s.
    pub velocity: Vec<Vec<f64>>,
    /// Input of each step, in m/s²; forward and to the left for a body with a heading.
    pub acceleration: Vec<Vec<f64>>,
    /// [Spin](super::Body::with_spin) at each sample, in rad/s; empty without one.
    #[cfg_attr(feature = "serde", serde(default, skip_serializing_if = "Vec::is_empty"))]
    pub spin: Vec<f64>,
    /// Torque of each step, in N m; empty without spin.
    #[cfg_attr(feature = "serde", serde(default, skip_serializing_if = "Vec::is_empty"))]
    pub torque: Vec<f64>,
    /// [Heading](super::Body::with_heading) at each sample, in rad; empty without one.
    #[cfg_attr(feature = "serde", serde(default, skip_serializing_if = "Vec::is_empty"))]
    pub heading: Vec<f64>,
}

/// A hit of a plan.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SceneHit {
    /// The step in which it happens.
    pub step: usize,
    /// The contact: `puck at wall`, or `a and b`.
    pub contact: String,
    /// The body.
    pub body: String,
    /// The number of the face.
    pub face: usize,
    /// Approach at the start of the step, in m/s.
    pub start_speed: f64,
    /// Approach at the end of the step, had there been no hit, in m/s.
    pub end_speed: f64,
    /// The impact speed that counts as damage, in m/s.
    pub damage: f64,
    /// When the impact is located, in s.
    pub time: f64,
    /// The speed of the located impact, in m/s.
    pub speed: f64,
    /// Where the body is then, in m.
    pub place: Vec<f64>,
    /// The impulse on the body, in N s.
    pub impulse: Vec<f64>,
    /// The kinetic energy that the hit takes, with that of spins, in J.
    pub energy: f64,
}

impl SceneHit {
    /// A hit before its replay, which completes it.
    pub(super) fn new(step: usize, contact: String, body: &str, face: usize) -> Self {
        SceneHit {
            step,
            contact,
            body: body.to_owned(),
            face,
            start_speed: 0.0,
            end_speed: 0.0,
            damage: 0.0,
            time: 0.0,
            speed: 0.0,
            place: Vec::new(),
            impulse: Vec::new(),
            energy: 0.0,
        }
    }
}

/// A plan of a scene, replayed. It is nominal: [pushes](super::Body::with_pushes) and
/// [spreads](super::Surface::with_spread) of the scene are left out; plans that hold under them are
/// made by [`HybridProgram::robust`](crate::hybrid::HybridProgram::robust).
#[derive(Debug, Clone)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ScenePlan {
    /// Δt, in s.
    pub time_step: f64,
    /// The bodies, in the order of the scene.
    pub bodies: Vec<BodyPath>,
    /// The hits, by step.
    pub hits: Vec<SceneHit>,
    /// The run of the scene's hybrid system.
    pub run: HybridRun,
    /// The result of the replay.
    pub certificate: SceneCertificate,
    /// The solution from which it comes, with its objective, bound and counts; that of the whole
    /// program for a case. A plan that was stored without one has no answer and no bound.
    #[cfg_attr(feature = "serde", serde(default = "Solution::unknown"))]
    pub solution: Solution,
    /// The plans of the [cases](SceneProgram::add_case), by name, each replayed in its own scene.
    #[cfg_attr(feature = "serde", serde(default, skip_serializing_if = "BTreeMap::is_empty"))]
    pub cases: BTreeMap<String, ScenePlan>,
}

/// Plans are equal if they do the same, however they were found.
impl PartialEq for ScenePlan {
    fn eq(&self, other: &Self) -> bool {
        let ScenePlan { time_step, bodies, hits, run, certificate, solution: _, cases } = self;
        *time_step == other.time_step
            && *bodies == other.bodies
            && *hits == other.hits
            && *run == other.run
            && *certificate == other.certificate
            && *cases == other.cases
    }
}

impl ScenePlan {
    /// The number of steps.
    pub fn steps(&self) -> usize {
        self.bodies.first().map_or(0, |body| body.acceleration.len())
    }

    /// Its duration, in s.
    pub fn duration(&self) -> f64 {
        self.steps() as f64 * self.time_step
    }

    /// The largest damage of a hit, in m/s; 0 without hits.
    pub fn largest_damage(&self) -> f64 {
        self.hits.iter().map(|hit| hit.damage).fold(0.0, f64::max)
    }

    /// A plan with the same hits and steps whose inputs are
    /// [extreme](crate::hybrid::HybridProgram::extreme), at the least price of the scene's rules.
    /// The plan itself if there is nothing to choose.
    ///
    /// # Errors
    ///
    /// Those of [`Scene::program`] and of [`SceneProgram::plan`].
    pub fn extreme(&self, scene: &Scene, solver: &mut dyn Solver) -> Result<ScenePlan, Error> {
        let program = scene.plain_program(self.steps())?;
        match program.program().variables().extreme(program.model(), &self.run, solver)? {
            None => Ok(self.clone()),
            Some(solution) => program.plan_by(&solution, solver),
        }
    }

    /// A body's path by its name.
    pub fn body(&self, name: &str) -> Option<&BodyPath> {
        self.bodies.iter().find(|body| body.name == name)
    }
}

impl Scene {
    /// Replays a plan, such as one that was stored, or one of a scene with other rules. Returns it
    /// with the hits and the certificate that it has in this scene. What is read of the plan are
    /// its samples and inputs, and which faces its hits are at. Cases are left out, because they
    /// are plans of other scenes.
    ///
    /// ```
    /// use carom::hybrid::scene::{Body, DamageMeasure, DamageRule, Scene, Solid, Surface};
    /// use carom::hybrid::Restitution;
    /// use carom::prelude::*;
    ///
    /// // A crash at about 4 m/s, in a scene without rules.
    /// let car = Body::new("car", [0.0..=9.0], 9.0, 1.0)
    ///     .with_start([1.0, -4.0]);
    /// let wall = Surface::bounce(Restitution::new(0.2)?);
    /// let scene = Scene::new(0.1)
    ///     .with_body(car)
    ///     .with_obstacle(Solid::halfspace("wall", [1.0], 0.0, wall));
    /// let plan = scene.mitigate(8, &mut BranchAndBound::default())?.plan.expect("there is one");
    /// assert_eq!(scene.replay(&plan)?.certificate, plan.certificate);
    /// let gently = DamageRule::new("gently", DamageMeasure::ImpactSpeed).with_per_hit(1.0);
    /// assert!(scene.with_rule(gently).replay(&plan).is_err());
    /// # Ok::<(), carom::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`SceneError`] for a scene that contradicts itself, and [`SceneError::Replay`] for a plan
    /// that is not what the scene does or that breaks one of its rules; [`ErrorKind::UnknownName`]
    /// and [`ErrorKind::Length`] for a plan of other bodies.
    pub fn replay(&self, plan: &ScenePlan) -> Result<ScenePlan, Error> {
        let (scene, units) = self.in_units()?;
        let mut plan = plan.clone();
        scene.check_paths(&plan.bodies)?;
        plan.time_step = self.time_step;
        plan.cases.clear();
        let paths = match units.is_plain() {
            true => plan.bodies.clone(),
            false => plan.bodies.iter().map(|path| units.path(path)).collect(),
        };
        plan.certificate = units.replayed(&scene, &paths, &mut plan.hits)?;
        Ok(plan)
    }

    /// Refuses paths of other bodies, of lengths that do not fit, and beyond the end of a course.
    pub(super) fn check_paths(&self, paths: &[BodyPath]) -> Result<(), Error> {
        let steps = paths.first().map_or(0, |path| path.acceleration.len());
        check_length("the bodies of the plan", paths.len(), self.bodies.len())?;
        for (own, path) in self.bodies.iter().zip(paths) {
            if own.name != path.name {
                let kind = "body of the scene at this place";
                return Err(ErrorKind::UnknownName { name: path.name.clone(), kind }.into());
            }
            for (what, values, count) in [
                ("the positions of a body", &path.position, steps + 1),
                ("the velocities of a body", &path.velocity, steps + 1),
                ("the accelerations of a body", &path.acceleration, steps),
            ] {
                check_length(what, values.len(), count)?;
                values.iter().try_for_each(|row| check_length(what, row.len(), self.axes()))?;
            }
            let turns = usize::from(own.spin.is_some());
            check_length("the spins of a body", path.spin.len(), turns * (steps + 1))?;
            check_length("the torques on a body", path.torque.len(), turns * steps)?;
            let headings = usize::from(own.heading.is_some()) * (steps + 1);
            check_length("the headings of a body", path.heading.len(), headings)?;
        }
        if let Some((obstacle, last)) = self.longest().filter(|(_, last)| *last < steps) {
            let obstacle = obstacle.name.clone();
            return Err(SceneError::Course { obstacle, last, needed: steps }.into());
        }
        Ok(())
    }
}

impl SceneProgram {
    /// Fixes the modes of all contacts to those of a plan.
    pub(super) fn fix_contacts(&mut self, plan: &ScenePlan) -> Result<(), Error> {
        for contact in &self.contacts {
            for (step, name) in plan.run.transitions(&contact.name)?.iter().enumerate() {
                if let Some(taken) = self.program().variables().taken(&contact.name, name, step)? {
                    self.program.model.fix(taken.variable(), f64::from(u8::from(taken.is_on())))?;
                }
            }
        }
        Ok(())
    }

    /// Solves the program. The plan is certified: replayed through the [scene](Scene::replay) by
    /// code that reads neither the program nor its system.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::NoPlan`] if the solver ends without a plan, because there is none or because
    /// it was stopped; [`SceneError::Replay`] for a plan that is not what the scene does; errors of
    /// the solver.
    pub fn solve(&self, solver: &mut dyn Solver) -> Result<ScenePlan, Error> {
        self.solve_with(&mut Control::default(), solver)
    }

    /// Solves the program with events, warm starts and limits, as [`solve`](SceneProgram::solve).
    ///
    /// # Errors
    ///
    /// Those of [`solve`](SceneProgram::solve).
    pub fn solve_with(
        &self,
        control: &mut Control<'_>,
        solver: &mut dyn Solver,
    ) -> Result<ScenePlan, Error> {
        let solution = solver.solve_with(self.model(), control)?;
        self.plan_by(&solution, solver)
    }

    /// As [`plan`](SceneProgram::plan), with a solver for what a corrected plan may need.
    pub(super) fn plan_by(
        &self,
        solution: &Solution,
        solver: &mut dyn Solver,
    ) -> Result<ScenePlan, Error> {
        self.read(&*self.program.settled(solution, Some(solver))?)
    }

    /// The certified plan of a solution of the [model](crate::hybrid::HybridProgram::model), for
    /// those who solve it themselves.
    ///
    /// # Errors
    ///
    /// Those of [`solve`](SceneProgram::solve) that do not come from the solver;
    /// [`ErrorKind::ForeignHandle`] for a solution of another model.
    pub fn plan(&self, solution: &Solution) -> Result<ScenePlan, Error> {
        self.read(&*self.program.settled(solution, None)?)
    }

    /// The plan of a solution whose states are the run of its inputs.
    fn read(&self, solution: &Solution) -> Result<ScenePlan, Error> {
        let (run, _) = self.program().variables().certified(solution)?;
        self.program.systems.check_missions(solution)?;
        let bodies = self.paths(&run)?;
        let paths = match solution.point().filter(|_| !self.units.is_plain()) {
            Some(point) => self.paths(&self.program().variables().read_own(point)?)?,
            None => bodies.clone(),
        };
        let mut hits = Vec::new();
        for contact in &self.contacts {
            for (step, name) in run.transitions(&contact.name)?.iter().enumerate() {
                let mode = contact.modes.iter().find(|mode| mode.is_hit && mode.name == *name);
                let body = &self.scene.bodies[contact.body].name;
                let hit = |mode: &Mode| SceneHit::new(step, contact.name.clone(), body, mode.face);
                hits.extend(mode.map(hit));
            }
        }
        hits.sort_by_key(|hit| hit.step);
        let certificate = self.units.replayed(&self.scene, &paths, &mut hits)?;
        let time_step = run.time_step;
        let cases = self.cases.iter().map(|(name, case)| Ok((name.clone(), case.read(solution)?)));
        let cases = cases.collect::<Result<_, Error>>()?;
        let solution = solution.clone();
        Ok(ScenePlan { time_step, bodies, hits, run, certificate, solution, cases })
    }

    /// The paths of the bodies in a run.
    fn paths(&self, run: &HybridRun) -> Result<Vec<BodyPath>, Error> {
        let mut bodies = Vec::new();
        for body in &self.scene.bodies {
            let axes = &AXES[..self.scene.axes()];
            let series = |what: &str| -> Result<Vec<Vec<f64>>, Error> {
                let names = axes.iter().map(|axis| format!("{} {what}{axis}", body.name));
                let columns = names.map(|name| match what {
                    "a" => run.input(&name).map(<[f64]>::to_vec),
                    _ => run.state(&name).map(<[f64]>::to_vec),
                });
                let columns: Vec<Vec<f64>> = columns.collect::<Result<_, _>>()?;
                let count = columns.first().map_or(0, Vec::len);
                Ok((0..count).map(|t| columns.iter().map(|c| c[t]).collect()).collect())
            };
            let (mut spin, mut torque) = (Vec::new(), Vec::new());
            if body.spin.is_some() {
                spin = run.state(&format!("{} spin", body.name))?.to_vec();
                torque = run.input(&format!("{} torque", body.name))?.to_vec();
            }
            let heading = match body.heading {
                Some(_) => run.state(&format!("{} heading", body.name))?.to_vec(),
                None => Vec::new(),
            };
            bodies.push(BodyPath {
                name: body.name.clone(),
                position: series("")?,
                velocity: series("v")?,
                acceleration: series("a")?,
                spin,
                torque,
                heading,
            });
        }
        Ok(bodies)
    }
}
