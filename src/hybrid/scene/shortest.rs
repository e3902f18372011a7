//! The shortest plan of a scene.

use super::body::Body;
use super::contact::{ContactFace, ContactPair};
use super::loose::loose;
use super::plan::ScenePlan;
use super::program::{SceneProgram, exclusive};
use super::statement::Scene;
use super::system::Stated;
use crate::error::Error;
use crate::hybrid::program::HybridProgram;
use crate::hybrid::reach::{HorizonVariables, ReachSets, SetOptions};
#[cfg(doc)]
use crate::hybrid::shortest_horizon::shortest_horizon;
use crate::hybrid::shortest_horizon::{
    HorizonEvent, HorizonModel, Shortest, ShortestOptions, Solved, Waiting, shortest_horizon_with,
};
use crate::hybrid::system::{HybridSystem, Region};
use crate::interval::Interval;
use crate::solver::{Solver, StopToken};

/// How many times longer the steps of the coarser grid are.
const COARSER: f64 = 8.0;

/// The most combinations of modes of a step for which sets of coupled axes are kept: they are
/// templates of all states, each image of which costs many times a polygon's.
const MOST_MOVES: usize = 8;

impl Scene {
    /// Finds the smallest number of steps in which all bodies get from their starts to their goals,
    /// and refutes all smaller numbers.
    ///
    /// [Sets](Scene::reach_sets) are kept for each axis of each body, and refute most horizons. With many
    /// convex obstacles, the last of them are left to the search. Where slanted faces or pairs of bodies
    /// avoid each other, sets know only what that says about each axis. Where hits couple axes, by
    /// friction, slanted faces or pairs, all of it is left to the search.
    ///
    /// # Errors
    ///
    /// Those of [`Scene::program`]; those of [`shortest_horizon`] and of the solver; those of
    /// [`SceneProgram::plan`] for a plan that is not what the scene does.
    pub fn shortest_plan(
        &self,
        options: &ShortestOptions,
        solver: &mut dyn Solver,
    ) -> Result<Shortest<ScenePlan>, Error> {
        self.shortest_plan_with(options, solver, &mut |_| {})
    }

    /// Same as [`shortest_plan`](Scene::shortest_plan), with progress events on the calling thread.
    ///
    /// # Errors
    ///
    /// As for [`shortest_plan`](Scene::shortest_plan).
    pub fn shortest_plan_with(
        &self,
        options: &ShortestOptions,
        solver: &mut dyn Solver,
        progress: &mut dyn FnMut(&HorizonEvent),
    ) -> Result<Shortest<ScenePlan>, Error> {
        let stated = self.stated()?;
        let waiting = options.waiting(stated.waiting()?);
        let mut options = options.clone();
        if let Some((_, longest)) = stated.scene.longest() {
            options.max_steps = options.max_steps.min(longest);
        }
        let task = ScenePrograms { stated, waiting };
        let found = shortest_horizon_with(&task, &options, solver, progress)?;
        found.try_map(|Solved { program, solution }| program.plan(&solution))
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
    /// Fixes transitions and narrows bounds by [quick sets](Stated::quick_sets). `false` if they prove
    /// that there is no plan.
    pub(super) fn tighten_by_sets(&mut self, stated: &Stated) -> Result<bool, Error> {
        self.tighten_until(stated, &StopToken::default())
    }

    /// As [`tighten_by_sets`](Self::tighten_by_sets); if the token is over first, the program stays as it is.
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
        let variables = self.variables().horizon_variables().with_event_row(is_line);
        Ok(!tube.tighten(&mut self.program.model, &variables)?.infeasible)
    }
}

impl Stated {
    pub(super) fn sets(&self) -> Result<ReachSets, Error> {
        self.sets_of(&self.system)
    }

    fn sets_of(&self, system: &HybridSystem) -> Result<ReachSets, Error> {
        let (start, goal) = (self.ends(true), self.ends(false));
        let exclusive = exclusive(&self.scene, &self.contacts);
        let options = SetOptions { exclusive, ..SetOptions::default() };
        let sets = ReachSets::new(system, start, goal, options)?;
        let bodies = &self.scene.bodies;
        if bodies.iter().all(|body| body.first.is_none()) {
            return Ok(sets);
        }
        let first = bodies.iter().flat_map(|body| match &body.first {
            Some(first) => first.iter().map(|&a| Interval::point(a)).collect(),
            None => body.acceleration.clone(),
        });
        sets.with_first_inputs(&first.collect::<Vec<_>>())
    }

    /// Sets that take no longer than a few nodes of a search: of the scene where few moves couple its
    /// axes or none does, and otherwise of the scene with [looser conditions](loose), if hits keep axes
    /// apart.
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
        let moves = self.contacts.iter().map(|contact| contact.modes.len());
        let few = moves.fold(1, usize::saturating_mul) <= MOST_MOVES;
        let apart =
            self.contacts.iter().all(hits_apart) && self.scene.bodies.iter().all(Body::is_apart);
        // Lengths couple axes.
        let apart_or_few = few || apart && self.contacts.iter().all(is_aligned);
        let has_ball = self.scene.bodies.iter().any(Body::has_ball);
        match (apart_or_few && !(has_ball && apart), apart) {
            (true, _) => self.sets_of(&self.system).map(Some),
            (false, true) => self.sets_of(&loose(self)).map(Some),
            (false, false) => Ok(None),
        }
    }

    fn ends(&self, is_start: bool) -> Region {
        self.scene.ends(&self.system, is_start)
    }

    fn domains(&self) -> Vec<Interval> {
        self.system.states.iter().map(|(_, domain)| *domain).collect()
    }

    pub(super) fn waiting(&self) -> Result<Waiting, Error> {
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
            true => system.waiting(&Region::from(self.domains()), &goal),
            false => system.waiting(&start, &goal),
        }
    }
}

/// From starts to goals, in any number of steps.
pub(super) struct ScenePrograms {
    pub(super) stated: Stated,
    pub(super) waiting: Waiting,
}

impl HorizonModel for ScenePrograms {
    type Program = SceneProgram;

    fn build(&self, steps: usize) -> Result<SceneProgram, Error> {
        let mut program = self.stated.program(steps)?;
        program.minimize(0.0)?;
        Ok(program)
    }

    fn waiting(&self) -> Waiting {
        self.waiting.clone()
    }

    fn reach_sets(&self) -> Result<Option<ReachSets>, Error> {
        self.stated.quick_sets()
    }

    fn time_step(&self) -> Option<f64> {
        Some(self.stated.scene.time_step)
    }

    fn with_hybrid(
        &self,
        program: &mut SceneProgram,
        statements: &mut dyn FnMut(&mut HybridProgram),
    ) {
        statements(program);
    }

    fn variables(&self, program: &SceneProgram) -> HorizonVariables {
        program.variables().horizon_variables()
    }

    fn coarser(&self) -> Option<Box<dyn HorizonModel<Program = SceneProgram> + '_>> {
        let scene = &self.stated.scene;
        let still = scene.obstacles.iter().all(|obstacle| obstacle.course.is_empty());
        let coarse = Scene { time_step: COARSER * scene.time_step, ..scene.clone() };
        let stated = coarse.stated().ok().filter(|_| still)?;
        let waiting = stated.waiting().ok()?;
        Some(Box::new(ScenePrograms { stated, waiting }))
    }
}
