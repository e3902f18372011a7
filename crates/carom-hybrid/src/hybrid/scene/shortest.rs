//! The shortest plan of a scene.

use std::sync::Arc;

use super::body::Body;
use super::contact::{ContactFace, ContactPair};
use super::decoupled_relaxation::decoupled_relaxation;
use super::plan::ScenePlan;
use super::program::{SceneProgram, exclusive};
use super::rule::DamageRule;
use super::statement::Scene;
use super::system::Stated;
use crate::activity;
use crate::error::Error;
use crate::hybrid::program::HybridProgram;
use crate::hybrid::reach::{ReachSets, SetOptions};
use crate::hybrid::robust::{Feedback, RobustPlan, shortest_robust};
use crate::hybrid::shortest_horizon::{
    HorizonModel, Monotonicity, ShortestHorizon, ShortestOptions, SolvedHorizon, shortest_horizon,
};
use crate::hybrid::system::{HybridSystem, Region, Restated};
use crate::interval::Interval;
use crate::model::Affine;
use crate::solver::{Solver, StopToken};

/// How many times longer the steps of the coarser grid are.
const COARSER: f64 = 8.0;

/// The most combinations of modes of a step for which sets of coupled axes are kept: they are
/// templates of all states, each image of which costs many times a polygon's.
const MOST_MODE_COMBINATIONS: usize = 8;

/// The number of first steps in which a corner is looked for.
const FIRST_STEPS: usize = 64;

impl Scene {
    /// Finds the smallest number of steps in which all bodies get from their starts to their goals,
    /// and refutes all smaller numbers.
    ///
    /// [Sets](Scene::reach_sets) are kept for each axis of each body, and refute most horizons.
    /// With many convex obstacles, the last of them are left to the search. Where slanted faces or
    /// pairs of bodies avoid each other, sets know only what that says about each axis. Where hits
    /// couple axes, by friction, slanted faces or pairs, there are sets of the coupled axes
    /// together if a step has up to 8 combinations of modes; otherwise all of it is left to the
    /// search.
    ///
    /// # Errors
    ///
    /// Those of [`Scene::program`]; those of [`shortest_horizon`] and of the solver; those of
    /// [`SceneProgram::plan`] for a plan that is not what the scene does.
    pub fn shortest(&self, solver: &mut dyn Solver) -> Result<ShortestHorizon<ScenePlan>, Error> {
        self.shortest_with(&ShortestOptions::default(), solver)
    }

    /// As [`shortest`](Scene::shortest), with limits, windows and rows of your own.
    ///
    /// # Errors
    ///
    /// As for [`shortest`](Scene::shortest); `ErrorKind::OutOfRange` for a bad `max_steps`.
    pub fn shortest_with(
        &self,
        options: &ShortestOptions,
        solver: &mut dyn Solver,
    ) -> Result<ShortestHorizon<ScenePlan>, Error> {
        let (task, options) = self.task(options)?;
        let found = shortest_horizon(&task, &options, solver)?;
        found.try_map(|SolvedHorizon { program, solution }| program.plan(&solution))
    }

    /// The smallest number of steps for which a plan brings all disturbed bodies from their starts
    /// to their goals, if the feedback corrects the inputs: as [`HybridSystem::shortest_robust`],
    /// with the rules of the scene.
    ///
    /// # Errors
    ///
    /// Those of [`shortest`](Scene::shortest) and of [`robust`](HybridProgram::robust).
    pub fn shortest_robust(
        &self,
        feedback: &Feedback,
        options: &ShortestOptions,
        solver: &mut dyn Solver,
    ) -> Result<ShortestHorizon<RobustPlan>, Error> {
        let (task, options) = self.task(options)?;
        shortest_robust(&task, &task.stated.system, feedback, &options, solver)
    }

    /// The programs of the scene, and options with steps for which its courses last.
    fn task(&self, options: &ShortestOptions) -> Result<(ScenePrograms, ShortestOptions), Error> {
        let stated = self.stated()?;
        let monotonicity = options.monotonicity(stated.monotonicity()?);
        let mut options = options.clone();
        if let Some((_, longest)) = stated.scene.longest() {
            options.max_steps = options.max_steps.min(longest);
        }
        Ok((ScenePrograms { stated, monotonicity }, options))
    }

    /// Reach sets of the scene, from its starts to its goals. They refute horizons, say why in
    /// words, and [tighten](crate::hybrid::HybridProgram::tighten) programs. Bodies whose axes are
    /// independent have sets for each axis.
    ///
    /// # Errors
    ///
    /// [`SceneError`](super::SceneError) and others for a scene that contradicts itself.
    pub fn reach_sets(&self) -> Result<ReachSets, Error> {
        self.stated()?.sets()
    }
}

impl SceneProgram {
    /// Fixes transitions and narrows bounds by [quick sets](Stated::quick_sets). `false` if they
    /// prove that there is no plan.
    pub(super) fn tighten_by_sets(&mut self, stated: &Stated) -> Result<bool, Error> {
        self.tighten_until(stated, &StopToken::default())
    }

    /// As [`tighten_by_sets`](Self::tighten_by_sets); if the token is over first, the program stays
    /// as it is.
    pub(super) fn tighten_until(
        &mut self,
        stated: &Stated,
        token: &StopToken,
    ) -> Result<bool, Error> {
        let Some(mut sets) = stated.quick_sets()? else { return Ok(true) };
        let Some(tube) = sets.tube_until(self.steps(), token)? else { return Ok(true) };
        if tube.is_empty() {
            return Ok(false);
        }
        // A row over all hits would link axes that are independent.
        let is_line = self.scene.axes() == 1 && self.scene.bodies.len() == 1;
        let variables = self.program().variables().horizon_variables().with_event_row(is_line);
        Ok(!self.program.tighten_by(&tube, &variables)?.infeasible)
    }
}

impl Stated {
    pub(super) fn sets(&self) -> Result<ReachSets, Error> {
        self.sets_of(&self.system)
    }

    fn sets_of(&self, system: &HybridSystem) -> Result<ReachSets, Error> {
        let (start, goal) = (self.ends(true), self.ends(false));
        system.check()?;
        start.check(system, "the start")?;
        goal.check(system, "the goal")?;
        let exclusive = exclusive(&self.scene, &self.contacts);
        let words = Arc::new(self.words());
        let options = SetOptions { exclusive, words, ..SetOptions::default() };
        let coordinates = self.coordinates.clone();
        let user = match coordinates.is_plain() {
            true => None,
            false => Some(Arc::new(coordinates.inverse().system(system)?)),
        };
        let own = Restated { system: system.clone(), coordinates };
        let mut sets = ReachSets::restated(user, own, start, goal, options);
        let bodies = &self.scene.bodies;
        if bodies.iter().all(|body| body.first.is_none()) {
            return Ok(sets);
        }
        let first = bodies.iter().flat_map(|body| match &body.first {
            Some(first) => first.iter().map(|&a| Interval::point(a)).collect(),
            None => body.acceleration.clone(),
        });
        let first = first.chain(self.scene.spins().map(|(_, spin)| spin.torques()));
        let known: Vec<Interval> = first.collect();
        let functions =
            system.inputs.iter().skip(known.len()).filter_map(|(_, range)| range.get(0));
        sets.begin_with(known.iter().chain(functions).copied().collect());
        Ok(sets)
    }

    /// Sets that take no longer than a few nodes of a search: of the scene where few combinations
    /// of modes couple its axes or none does, and otherwise of its
    /// [decoupled relaxation](decoupled_relaxation), if hits keep axes apart.
    pub(super) fn quick_sets(&self) -> Result<Option<ReachSets>, Error> {
        let is_aligned = |contact: &ContactPair| {
            let along_axis = |face: &ContactFace| face.normal.iter().any(|n| n.abs() == 1.0);
            contact.other.is_none() && contact.faces.iter().all(along_axis)
        };
        let hits_apart = |contact: &ContactPair| {
            !contact.bounces()
                || is_aligned(contact)
                    && contact.faces.iter().all(|face| face.surface.is_frictionless())
        };
        let combinations = self.contacts.iter().map(|contact| contact.modes.len());
        let few = combinations.fold(1, usize::saturating_mul) <= MOST_MODE_COMBINATIONS;
        let apart =
            self.contacts.iter().all(hits_apart) && self.scene.bodies.iter().all(Body::is_apart);
        // Lengths couple axes.
        let apart_or_few = few || apart && self.contacts.iter().all(is_aligned);
        let has_ball = self.scene.bodies.iter().any(Body::has_ball);
        let mut system = match (apart_or_few && !(has_ball && apart), apart) {
            (true, _) => self.system.clone(),
            (false, true) => decoupled_relaxation(self),
            (false, false) => return Ok(None),
        };
        system.most_events = self.most_hits();
        self.sets_of(&system).map(Some)
    }

    /// That corners are not planned, if every run of a body moves into one: if it ends the same
    /// step behind two faces, whatever its input is.
    fn corner_hint(&self) -> Option<String> {
        if self.scene.corners {
            return None;
        }
        let walls: Vec<(usize, usize)> = (0..self.contacts.len())
            .filter_map(|c| Some((c, self.certain_hit(&self.contacts[c])?)))
            .collect();
        let (a, b, step) = walls.iter().enumerate().find_map(|(k, &(a, step))| {
            let same = |b: usize| self.contacts[b].body == self.contacts[a].body;
            let other = walls[k + 1..].iter().find(|&&(b, own)| same(b) && own == step)?;
            Some((a, other.0, step))
        })?;
        let body = &self.scene.bodies[self.contacts[a].body].name;
        let [a, b] = [a, b].map(|c| &self.contacts[c].name);
        Some(format!(
            "`{body}` cannot but hit several things in step {step} (`{a}` and `{b}`), and a body hits at most \
             one in a step unless `Scene::with_corners(true)` allows corners"
        ))
    }

    /// The step in which a body first ends behind a wall, if that is the same for all inputs; the
    /// body starts at one state, and nothing but its input moves it.
    fn certain_hit(&self, contact: &ContactPair) -> Option<usize> {
        let body = &self.scene.bodies[contact.body];
        let start = &body.start.as_ref()?.ranges;
        let is_free = body.dynamics.is_none() && !body.is_nonlinear();
        let is_plain = is_free && body.gravity.iter().all(|g| *g == 0.0);
        let is_point = start.iter().all(|range| range.lower == range.upper);
        let [face] = &contact.faces[..] else { return None };
        if !is_plain || !is_point || contact.other.is_some() || !contact.bounces() {
            return None;
        }
        let axes = self.scene.axes();
        let along = |of: &[Interval]| {
            activity::range(0.0, face.normal.iter().copied().zip(of.iter().copied()))
        };
        let (place, speed) = (along(&start[..axes]), along(&start[axes..]));
        let input = along(&body.acceleration);
        let first = |farthest: bool| {
            (1..=FIRST_STEPS).find(|&steps| {
                let time = steps as f64 * self.scene.time_step;
                let end = place + speed * time + input * (0.5 * time * time);
                let end = if farthest { end.upper } else { end.lower };
                end < face.limit_at(steps)
            })
        };
        let (soonest, latest) = (first(false)?, first(true)?);
        (soonest == latest).then(|| soonest - 1)
    }

    /// The most hits of a plan, if a rule says so of all hits together.
    fn most_hits(&self) -> Option<usize> {
        let rules = self.scene.rules.iter().filter(|rule| rule.window.is_none());
        let all = |contact: &ContactPair, rule: &DamageRule| {
            let hits = contact.modes.iter().filter(|mode| mode.is_hit);
            hits.into_iter().all(|mode| rule.applies(contact, mode.face))
        };
        let rules = rules.filter(|rule| self.contacts.iter().all(|contact| all(contact, rule)));
        rules.filter_map(|rule| rule.count).min()
    }

    fn ends(&self, is_start: bool) -> Region {
        self.scene.ends(&self.system, is_start)
    }

    fn domains(&self) -> Vec<Interval> {
        self.system.states.iter().map(|(_, domain)| *domain).collect()
    }

    pub(super) fn monotonicity(&self) -> Result<Monotonicity, Error> {
        let (start, goal) = (self.ends(true), self.ends(false));
        // Who waits hits nothing.
        let mut system = self.system.clone();
        for choice in &mut system.choices {
            choice.transitions.retain(|transition| !transition.is_event);
        }
        let moves = |body: &super::Body| {
            body.first.as_ref().is_some_and(|first| first.iter().any(|&a| a != 0.0))
        };
        match self.scene.bodies.iter().any(moves) {
            // The first inputs are given, so that nobody can wait at the start.
            true => system.waits(&self.coordinates, &Region::from(self.domains()), &goal),
            false => system.waits(&self.coordinates, &start, &goal),
        }
    }
}

/// From starts to goals, in any number of steps.
pub(super) struct ScenePrograms {
    pub(super) stated: Stated,
    pub(super) monotonicity: Monotonicity,
}

impl HorizonModel for ScenePrograms {
    type Program = SceneProgram;

    fn build(&self, steps: usize) -> Result<SceneProgram, Error> {
        let mut program = self.stated.program(steps)?;
        // Any plan will do, but where hits couple bodies, a search for few hits refutes sooner.
        let hits = if self.takes_any_point() { program.hits() } else { Affine::zero() };
        program.minimize(hits)?;
        Ok(program)
    }

    fn takes_any_point(&self) -> bool {
        self.stated.contacts.iter().any(|contact| contact.other.is_some() && contact.bounces())
    }

    fn monotonicity(&self) -> Monotonicity {
        self.monotonicity.clone()
    }

    fn reach_sets(&self) -> Result<Option<ReachSets>, Error> {
        self.stated.quick_sets()
    }

    fn time_step(&self) -> Option<f64> {
        Some(self.stated.source.time_step)
    }

    fn ends(&self) -> Result<Option<(HybridSystem, Region, Region)>, Error> {
        let (start, goal) = (self.stated.ends(true), self.stated.ends(false));
        Ok(Some((self.stated.system.clone(), start, goal)))
    }

    fn hints(&self) -> Vec<String> {
        self.stated.corner_hint().into_iter().collect()
    }

    fn with_hybrid(
        &self,
        program: &mut SceneProgram,
        statements: &mut dyn FnMut(&mut HybridProgram),
    ) {
        statements(program.program_mut());
    }

    fn coarser(&self) -> Option<Box<dyn HorizonModel<Program = SceneProgram> + '_>> {
        let scene = &self.stated.scene;
        let still = scene.obstacles.iter().all(|obstacle| obstacle.course.is_empty());
        let coarse = Scene { time_step: COARSER * scene.time_step, ..scene.clone() };
        let stated = coarse.stated().ok().filter(|_| still)?;
        let monotonicity = stated.monotonicity().ok()?;
        Some(Box::new(ScenePrograms { stated, monotonicity }))
    }
}
