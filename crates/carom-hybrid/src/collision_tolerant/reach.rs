//! A scenario as a hybrid system, and as a family of programs over the horizon.

use std::sync::Arc;

use super::program::{Objective, PlanningProgram};
use super::scenario::{Collisions, Scenario};
use crate::error::Error;
use crate::hybrid::horizon::Horizon;
use crate::hybrid::reach::{HorizonVariables, ReachSets, SetOptions, Words};
use crate::hybrid::scene::line::half_line;
use crate::hybrid::scene::{Body, DamageRule, Scene, Surface};
use crate::hybrid::system::Transition;
use crate::hybrid::{
    ContactLaw, HorizonModel, HybridProgram, HybridSystem, ImpactEstimate, LinearSystem,
    Monotonicity, Region,
};
use crate::interval::Interval;
use crate::solution::Solution;
use crate::solver::Solver;
use crate::tolerance;

/// How many times longer the steps of the coarser grid are, and the number of steps from which it
/// pays.
const COARSER: (f64, usize) = (8.0, 160);

impl Scenario {
    /// The scenario as a hybrid system with the states `x` (m) and `v` (m/s), the input `a` (m/s²)
    /// and the transitions 0, the flight, and 1, the contact, if collisions are tolerated.
    ///
    /// A limit on the cumulative damage acts as a limit on each contact.
    ///
    /// # Errors
    ///
    /// Those of [`Scenario::check`].
    pub fn hybrid_system(&self) -> Result<HybridSystem, Error> {
        self.check()?;
        let longest = Horizon::new(tolerance::MAX_STEPS, self.time_step)?;
        let most = [self.damage.per_hit, self.damage.total].into_iter().flatten();
        let mut rule = self.damage.clone();
        rule.per_hit = most.reduce(f64::min);
        self.system(&longest, &rule)
    }

    /// The system over a horizon, of a scenario that has been checked, with the limit of a rule on
    /// each contact.
    pub(super) fn system(
        &self,
        horizon: &Horizon,
        rule: &DamageRule,
    ) -> Result<HybridSystem, Error> {
        let system = HybridSystem::new(self.time_step)
            .with_state("x", self.positions(horizon))
            .with_state("v", Interval::new(-self.max_speed, self.max_speed))
            .with_input("a", self.acceleration);
        let system = match self.pushes.magnitude() > 0.0 {
            true => system.with_disturbance([Interval::point(0.0), self.pushes]),
            false => system,
        };
        let [flight, contact] = match self.contact.law {
            ContactLaw::Literal => {
                self.contact.transitions(self.time_step, self.contact.most_speed(rule))?
            }
            _ => self.contact.reflecting(self.time_step, self.estimate, Some(rule.clone()))?,
        };
        Ok(match (self.collisions, self.contact.law) {
            (Collisions::Forbidden, _) => {
                let flow = LinearSystem::double_integrator(self.time_step)?;
                system.with_transition(Transition::new("flight", flow))
            }
            (Collisions::Tolerated, ContactLaw::Literal) => {
                // The forced acceleration exceeds the vehicle's own limits, (10) and (11).
                let e = self.contact.restitution.value();
                let forced = (1.0 + e) * self.max_speed / self.time_step;
                let forced = self.acceleration.hull(Interval::new(-forced, forced));
                let contact = contact.with_input_range("a", forced);
                system.with_transition(flight).with_transition(contact)
            }
            (Collisions::Tolerated, _) => system.with_transition(flight).with_transition(contact),
        })
    }

    /// The scenario under the reflecting law as a [scene](crate::hybrid::scene) on a line: one
    /// body, one wall.
    pub(super) fn scene(&self, horizon: &Horizon) -> Scene {
        self.scene_within(self.positions(horizon))
    }

    /// The scene with a domain of the positions, in m.
    pub(super) fn scene_within(&self, positions: Interval) -> Scene {
        let surface = match self.collisions {
            Collisions::Tolerated => {
                Surface::bounce(self.contact.restitution).with_spread(self.contact.spread)
            }
            Collisions::Forbidden => Surface::avoid(),
        };
        let (domain, most) = ([positions], self.max_acceleration());
        let mut vehicle = Body::new("vehicle", domain, self.max_speed, most)
            .with_acceleration([self.acceleration])
            .with_start(self.start_state())
            .with_goal(self.goal_states());
        if let Some(first) = self.start.acceleration {
            vehicle = vehicle.with_first_acceleration([first]);
        }
        Scene::new(self.time_step)
            .with_body(vehicle)
            .with_obstacle(half_line(&self.contact.wall, surface))
            .with_estimate(match self.contact.law {
                // The wall pushes from the start of the step on.
                ContactLaw::Literal => ImpactEstimate::Sound,
                ContactLaw::Reflecting => self.estimate,
            })
            .with_rule(self.damage.clone())
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
        let system = self.hybrid_system()?;
        system.check()?;
        let ends = [&self.start_state(), &self.goal_states()];
        let options = SetOptions { words: Arc::new(words()), ..SetOptions::default() };
        let coordinates = self.coordinates(&self.units());
        let sets = ReachSets::in_coordinates(&system, coordinates, ends, options)?;
        match self.start.acceleration {
            Some(a) => sets.with_first_inputs(&[Interval::point(a)]),
            None => Ok(sets),
        }
    }
}

/// The names of the states in explanations.
fn words() -> Words {
    let word = |(name, words, unit): (&str, &str, _)| (name.to_owned(), words.to_owned(), unit);
    let quantities = [
        ("x", "the position", "m"),
        ("v", "the velocity", "m/s"),
        ("a", "the acceleration", "m/s²"),
    ];
    let flight = ("flight", "the vehicle cannot stop in front of the wall", Some("m"));
    Words {
        quantities: quantities.map(word).to_vec(),
        transitions: vec![(flight.0.into(), flight.1.into(), flight.2)],
        event: Some("hit"),
    }
}

/// A scenario as a family of feasibility programs over the horizon.
#[derive(Debug, Clone)]
pub(super) struct Programs {
    pub(super) scenario: Scenario,
    pub(super) upper_hint: Option<usize>,
}

impl HorizonModel for Programs {
    type Program = PlanningProgram;

    fn build(&self, steps: usize) -> Result<Self::Program, Error> {
        self.scenario.program(steps, Objective::Feasibility)
    }

    fn monotonicity(&self) -> Monotonicity {
        self.scenario.monotonicity()
    }

    fn lower_hint(&self) -> usize {
        self.scenario.lower_hint()
    }

    fn upper_hint(&self) -> Option<usize> {
        self.upper_hint
    }

    fn reach_sets(&self) -> Result<Option<ReachSets>, Error> {
        self.scenario.reach_sets().map(Some)
    }

    fn settled(
        &self,
        program: &PlanningProgram,
        solution: Solution,
        solver: &mut dyn Solver,
    ) -> Result<Solution, Error> {
        Ok(program.program().settled(&solution, Some(solver))?.into_owned())
    }

    fn time_step(&self) -> Option<f64> {
        Some(self.scenario.time_step)
    }

    fn ends(&self) -> Result<Option<(HybridSystem, Region, Region)>, Error> {
        let [first, last] = [&self.scenario.start, &self.scenario.goal].map(|end| end.acceleration);
        if first.zip(last).is_some_and(|(first, last)| first != last) {
            return Ok(None);
        }
        let system = self.scenario.hybrid_system()?;
        let own = self.scenario.restated(&system, &self.scenario.units())?;
        let ends = [self.scenario.start_state(), self.scenario.goal_states()];
        let [start, goal] = ends.map(|region| own.coordinates.region(&region));
        Ok(Some((own.system, start, goal)))
    }

    fn with_hybrid(
        &self,
        program: &mut PlanningProgram,
        statements: &mut dyn FnMut(&mut HybridProgram),
    ) {
        statements(program.program_mut());
    }

    fn variables(&self, program: &PlanningProgram) -> HorizonVariables {
        program.program().variables().horizon_variables()
    }

    fn coarser(&self) -> Option<Box<dyn HorizonModel<Program = PlanningProgram> + '_>> {
        let (factor, worth) = COARSER;
        let scenario = self.scenario.clone().with_time_step(factor * self.scenario.time_step);
        let can = scenario.collisions == Collisions::Tolerated && self.lower_hint() >= worth;
        can.then(|| Box::new(Programs { scenario, upper_hint: None }) as Box<_>)
    }
}
