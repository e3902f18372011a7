//! Shortest-horizon searches with reach sets: the same answers, every refutation named.

use std::time::Duration;

use crate::common::config;
use crate::rows::wall::add_by_hand;
use carom::collision_tolerant::{Endpoint, Plan, Scenario, Wall};
use carom::hybrid::reach::{HorizonVariables, ReachSets, SetOptions};
use carom::hybrid::scene::DamageRule;
use carom::hybrid::{
    HorizonEvent, HorizonModel, HorizonRefutation, HorizonVerdict, HybridSystem, LinearSystem,
    Matrix, Monotonicity, ShortestHorizon, ShortestOptions, ShortestStatus, shortest_horizon,
};
use carom::interval::Interval;
use carom::prelude::*;
use carom::solution::Termination;
use carom_hybrid::internals::{Halfspace, Transition};
use proptest::prelude::*;

fn search(scenario: &Scenario, sets: bool, max_steps: usize) -> ShortestHorizon<Plan> {
    let options = ShortestOptions::default().with_max_steps(max_steps).with_reach_sets(sets);
    scenario.shortest_with(&options, &mut BranchAndBound::default()).unwrap()
}

fn scenario() -> impl Strategy<Value = Scenario> {
    let ends = (0.0..6.0_f64, -3.0..3.0_f64, 0.0..2.0_f64, -1.0..1.0_f64);
    let restitution = prop_oneof![Just(0.0), Just(1.0), 0.0..1.0_f64];
    let limits = (prop::option::of(0.5..4.0_f64), prop::option::of(0.5..4.0_f64));
    (ends, any::<[bool; 3]>(), restitution, limits, 0.1..0.4_f64, 2.0..8.0_f64).prop_map(
        |((from, speed, to, end_speed), [above, resting, stopping], e, limits, dt, fastest)| {
            let wall = if above { Wall::above(-3.0) } else { Wall::below(7.0) }.unwrap();
            let speed = if resting { 0.0 } else { speed.clamp(-fastest, fastest) };
            let end_speed = if stopping { 0.0 } else { end_speed };
            let mut damage = DamageRule::default();
            (damage.per_hit, damage.total) = limits;
            Scenario::paper()
                .with_wall(wall)
                .with_start(Endpoint::at_rest(wall.at_gap(from)).with_velocity(speed))
                .with_goal(Endpoint::at_rest(wall.at_gap(to)).with_velocity(end_speed))
                .with_time_step(dt)
                .with_max_speed(fastest)
                .with_damage(damage)
                .with_restitution(e)
                .unwrap()
        },
    )
}

proptest! {
    #![proptest_config(config(24, "tests/regressions/reach.txt"))]

    #[test]
    fn sets_change_nothing_but_the_time(scenario in scenario()) {
        let (with, without) = (search(&scenario, true, 25), search(&scenario, false, 25));
        prop_assert_eq!(with.status, without.status);
        prop_assert_eq!(with.steps, without.steps);
        prop_assert_eq!(with.refuted_steps, without.refuted_steps);
        let impacts = |found: &ShortestHorizon<Plan>| found.plan.as_ref().map(|p| p.trajectory.impacts.len());
        prop_assert_eq!(impacts(&with), impacts(&without));
        let fewest = |found: &ShortestHorizon<Plan>| found.plan.as_ref().map(|plan| plan.fewest_impacts);
        prop_assert_eq!(fewest(&with), fewest(&without));
        prop_assert!(with.nodes() <= without.nodes());
    }
}

#[test]
fn every_smaller_horizon_is_refuted_by_name() {
    let scenario = Scenario::paper().with_time_step(0.05);
    let found = search(&scenario, true, 10_000);
    let steps = found.steps.unwrap();
    let plan = found.plan.as_ref().unwrap();
    assert!(found.is_found() && plan.fewest_impacts);
    let refuted: Vec<usize> = found
        .attempts
        .iter()
        .filter(|attempt| attempt.verdict == HorizonVerdict::Refuted(HorizonRefutation::Sets))
        .map(|attempt| attempt.steps)
        .collect();
    assert_eq!(refuted, (1..steps).collect::<Vec<_>>());
    let solves: Vec<_> = found.attempts.iter().filter(|attempt| attempt.is_solve()).collect();
    assert_eq!(solves.len(), 1);
    assert_eq!(solves[0].statistics.nodes, 1);
    // The sets show that an impact is needed, so that nothing is left to minimise.
    assert!(plan.refinements.is_empty());
    assert_eq!(found.tube.unwrap().fewest_events(), Some(1));
}

#[test]
fn a_horizon_that_no_set_excludes_is_left_to_the_solver() {
    // One event layer, very coarse polygons and a wide margin make blunt sets.
    struct Blunt(Scenario);
    impl HorizonModel for Blunt {
        type Program = carom::collision_tolerant::PlanningProgram;
        fn build(&self, steps: usize) -> Result<Self::Program, Error> {
            let feasible = carom::collision_tolerant::Objective::Feasibility;
            self.0.program(steps, feasible)
        }
        fn monotonicity(&self) -> Monotonicity {
            self.0.monotonicity()
        }
        fn reach_sets(&self) -> Result<Option<ReachSets>, Error> {
            let system = self.0.hybrid_system()?;
            let at = |x| [Interval::point(x), Interval::point(0.0)];
            let options = SetOptions::default().with_events(0).with_vertices(8).with_margin(0.05);
            let (start, goal) = (at(self.0.start.position), at(self.0.goal.position));
            ReachSets::new(&system, start, goal, options).map(Some)
        }
        fn with_hybrid(
            &self,
            program: &mut Self::Program,
            statements: &mut dyn FnMut(&mut HybridProgram),
        ) {
            statements(program.program_mut());
        }
    }
    let scenario = Scenario::paper().with_time_step(0.05);
    let options = ShortestOptions::default();
    let mut solver = BranchAndBound::default();
    let found = shortest_horizon(&Blunt(scenario.clone()), &options, &mut solver).unwrap();
    assert_eq!(found.steps, search(&scenario, true, 10_000).steps);
    let by = |refutation| {
        found.refutations().filter(|a| a.verdict == HorizonVerdict::Refuted(refutation)).count()
    };
    let solved = by(HorizonRefutation::Propagation) + by(HorizonRefutation::Relaxation);
    assert!(
        by(HorizonRefutation::Sets) > 20 && solved > 0,
        "{} and {solved}",
        by(HorizonRefutation::Sets)
    );
}

#[test]
fn limits_and_interrupts_keep_what_the_sets_refuted() {
    let scenario = Scenario::paper();
    let interrupt = Interrupt::new();
    let trigger = interrupt.clone();
    let progress = move |event: &HorizonEvent| {
        if let HorizonEvent::Decided(attempt) = event
            && attempt.steps == 100
        {
            trigger.trigger();
        }
    };
    let options = ShortestOptions::default().with_interrupt(&interrupt).with_progress(progress);
    let mut solver = BranchAndBound::default();
    let found = scenario.shortest_with(&options, &mut solver).unwrap();
    assert_eq!(found.status, ShortestStatus::Stopped(Termination::Interrupted));
    assert_eq!((found.steps, found.refuted_steps), (None, Some(100)));

    let options = ShortestOptions::default().with_time_limit(Duration::ZERO);
    let found = scenario.shortest_with(&options, &mut solver).unwrap();
    assert_eq!(found.status, ShortestStatus::Stopped(Termination::TimeLimit));
    assert!(found.steps.is_none());
}

#[test]
fn a_task_without_any_plan_is_refuted_without_a_solve() {
    // Nothing can push it: the sets settle at once, whatever the horizon.
    let stuck = Scenario::paper().with_acceleration(0.0..=0.0);
    let found = search(&stuck, true, 20_000);
    assert_eq!(found.status, ShortestStatus::NoneWithin { max_steps: 20_000 });
    assert!(found.attempts.iter().all(|attempt| !attempt.is_solve()));
    let text = stuck.reach_sets().unwrap().explain(500).unwrap().unwrap().to_string();
    assert!(text.ends_with("x of vehicle is 10 m, and 0.3 m is needed"), "{text}");
}

#[test]
fn an_explanation_names_sets_and_ranges() {
    let scenario = Scenario::paper().with_restitution(0.5).unwrap();
    let explanation = scenario.reach_sets().unwrap().explain(484).unwrap().unwrap();
    assert_eq!((explanation.steps, explanation.sample), (484, 484));
    assert_eq!(explanation.remedies, ["with twice the range of the acceleration of vehicle"]);
    let text = explanation.to_string();
    assert_eq!(
        text,
        "no plan has 484 steps (2.42 s): at the end, without a hit, where x of vehicle is 0.3 m, the \
         velocity of vehicle is at most -0.81 m/s, and 0 m/s is needed; with 1 hit, where x of vehicle \
         is 0.3 m, the velocity of vehicle is at least 0.01 m/s, and 0 m/s is needed. It might be \
         possible with twice the range of the acceleration of vehicle"
    );
    // What limits it is named when it is a wish.
    let gentle = DamageRule::default().with_per_hit(3.0);
    let text = scenario.clone().with_damage(gentle).reach_sets().unwrap().explain(486);
    let text = text.unwrap().unwrap().to_string();
    assert!(text.ends_with("or without the limit on the impact speed (3)"), "{text}");
    assert_eq!(scenario.reach_sets().unwrap().explain(485).unwrap(), None);
    // Where all ways end, what the vehicle cannot do, and the rule that forbids the rest.
    let fast = scenario.with_start(Endpoint::at_rest(4.0).with_velocity(-10.0));
    let gentle = DamageRule::default().with_per_hit(4.0);
    let explained = fast.with_damage(gentle).reach_sets().unwrap().explain(6000);
    let text = explained.unwrap().unwrap().to_string();
    assert_eq!(
        text,
        "no plan has 6000 steps (30 s): after 93 steps (0.47 s), vehicle cannot keep clear of wall: at \
         least 0.001 m are missing; the limit on the impact speed (4) is missed by at least 3.21. It might \
         be possible with twice the range of the acceleration of vehicle, or without the limit on the \
         impact speed (4)"
    );
}

#[test]
fn a_goal_a_hair_beside_the_wall_is_on_the_wall() {
    // A plastic impact ends at 0 m; the solver cannot tell that from the goal.
    let goal = Endpoint::at_rest(6.938893903907228e-18);
    let scenario =
        Scenario::paper().with_time_step(0.1).with_start(Endpoint::at_rest(0.02)).with_goal(goal);
    for sets in [true, false] {
        let found = search(&scenario, sets, 10);
        assert_eq!((found.is_found(), found.steps), (true, Some(1)), "sets: {sets}");
    }
}

#[test]
fn a_coarser_plan_guesses_the_contacts() {
    let scenario = Scenario::paper().with_time_step(0.01);
    let find = |coarse| {
        let search = ShortestOptions::default().with_reach_sets(false).with_coarse_guess(coarse);
        let options = search.with_upper_hint(255);
        scenario.shortest_with(&options, &mut BranchAndBound::default()).unwrap()
    };
    let (guessed, blind) = (find(true), find(false));
    assert_eq!((guessed.steps, guessed.refuted_steps), (Some(229), Some(228)));
    assert_eq!((blind.steps, blind.refuted_steps), (Some(229), Some(228)));
    let helped = |found: &ShortestHorizon<Plan>| {
        let feasible = |a: &&carom::hybrid::HorizonAttempt| a.verdict == HorizonVerdict::Feasible;
        found.attempts.iter().filter(feasible).any(|attempt| attempt.restricted)
    };
    assert!(helped(&guessed) && !helped(&blind));
}

/// A vehicle in the plane that may bounce off a wall at x = 0, by a user of the library.
struct Planar {
    dt: f64,
    sets: bool,
}

impl Planar {
    const PUSH: Interval = Interval { lower: -2.0, upper: 2.0 };

    fn axes(&self) -> Result<LinearSystem, Error> {
        let line = LinearSystem::double_integrator(self.dt)?;
        let a = Matrix::from_fn(
            4,
            4,
            |i, j| if i / 2 == j / 2 { line.a()[(i % 2, j % 2)] } else { 0.0 },
        );
        let b = Matrix::from_fn(4, 2, |i, j| if i / 2 == j { line.b()[(i % 2, 0)] } else { 0.0 });
        LinearSystem::new(a, b, vec![0.0; 4])
    }
}

impl HorizonModel for Planar {
    type Program = Model;

    fn build(&self, steps: usize) -> Result<Model, Error> {
        let line = LinearSystem::double_integrator(self.dt)?;
        let mut model = Model::new("planar");
        let families = ["x", "vx", "y", "vy"];
        let states: Vec<_> = families
            .iter()
            .map(|name| {
                let low = if *name == "x" { 0.0 } else { -8.0 };
                model.continuous_family(name, steps + 1, low, 8.0)
            })
            .collect::<Result<_, _>>()?;
        let ax = model.continuous_family("ax", steps, -2.0, 2.0)?;
        let ay = model.continuous_family("ay", steps, -2.0, 2.0)?;
        let hit = model.binary_family("hit", steps)?;
        for t in 0..steps {
            let now: Vec<_> = states.iter().map(|family| family[t]).collect();
            let next: Vec<_> = states.iter().map(|family| family[t + 1]).collect();
            let free = line.predict(&now[2..], &[ay[t]])?;
            for (name, (next, value)) in
                ["free y", "free vy"].iter().zip(next[2..].iter().zip(free))
            {
                model.add((*name, t), next.equals(value))?;
            }
            let predicted = line.predict(&now[..2], &[ax[t]])?;
            let predicted = [&predicted[0], &predicted[1]];
            add_by_hand(&mut model, 0.3, t, predicted, [next[0], next[1]], hit[t]);
        }
        for (family, (from, to)) in
            states.iter().zip([(3.0, 0.2), (0.0, 0.0), (0.0, 1.0), (0.0, 0.0)])
        {
            model.fix(family[0], from)?;
            model.fix(family[steps], to)?;
        }
        Ok(model)
    }

    fn monotonicity(&self) -> Monotonicity {
        Monotonicity::Monotone("it can rest where it starts".into())
    }

    fn reach_sets(&self) -> Result<Option<ReachSets>, Error> {
        if !self.sets {
            return Ok(None);
        }
        let flow = self.axes()?;
        let outside = Halfspace::new("outside the wall", [-1.0, 0.0, 0.0, 0.0], 0.0);
        let inside = Halfspace::new("behind the wall", [1.0, 0.0, 0.0, 0.0], 0.0);
        let inward = Halfspace::new("moving inward", [0.0, 1.0, 0.0, 0.0], 0.0);
        let rebound = Matrix::from_fn(4, 4, |i, j| match (i == j, i < 2) {
            (true, true) => -0.3,
            (true, false) => 1.0,
            _ => 0.0,
        });
        let system = HybridSystem::new(1.0)
            .with_state("x", Interval::new(0.0, 8.0))
            .with_state("vx", Interval::new(-8.0, 8.0))
            .with_state("y", Interval::new(-8.0, 8.0))
            .with_state("vy", Interval::new(-8.0, 8.0))
            .with_input("ax", Planar::PUSH)
            .with_input("ay", Planar::PUSH)
            .with_transition(Transition::new("flight", flow.clone()).with_prediction_guard(outside))
            .with_transition(
                Transition::event("impact", flow)
                    .with_prediction_guard(inside)
                    .with_prediction_guard(inward)
                    .with_reset(rebound, vec![0.0; 4]),
            );
        let at = |state: [f64; 4]| state.map(Interval::point);
        let (start, goal) = (at([3.0, 0.0, 0.0, 0.0]), at([0.2, 0.0, 1.0, 0.0]));
        ReachSets::new(&system, start, goal, SetOptions::default()).map(Some)
    }

    fn variables(&self, model: &mut Model) -> HorizonVariables {
        let family = |name: &str| {
            let member = |t| model.variable_by_name((name, t)).ok();
            (0..).map_while(member).collect()
        };
        let states: Vec<_> = ["x", "vx", "y", "vy"].map(family).into();
        HorizonVariables::new(states).with_transition(1, family("hit"))
    }
}

/// The same planner, which does not say which variables its programs have.
struct Unnamed(Planar);

impl HorizonModel for Unnamed {
    type Program = Model;

    fn build(&self, steps: usize) -> Result<Model, Error> {
        self.0.build(steps)
    }

    fn monotonicity(&self) -> Monotonicity {
        self.0.monotonicity()
    }

    fn reach_sets(&self) -> Result<Option<ReachSets>, Error> {
        self.0.reach_sets()
    }
}

#[test]
fn a_users_own_planner_profits_as_well() {
    let mut solver = BranchAndBound::default();
    let options = ShortestOptions::default();
    let mut find =
        |sets| shortest_horizon(&Planar { dt: 0.1, sets }, &options, &mut solver).unwrap();
    let (with, without) = (find(true), find(false));
    // Sets refute also where nothing is said about the variables of the programs.
    let unnamed = shortest_horizon(&Unnamed(Planar { dt: 0.1, sets: true }), &options, &mut solver);
    let unnamed = unnamed.unwrap();
    assert_eq!((unnamed.steps, unnamed.refuted_steps), (without.steps, without.refuted_steps));
    assert!(
        unnamed
            .attempts
            .iter()
            .any(|own| own.verdict == HorizonVerdict::Refuted(HorizonRefutation::Sets))
    );
    assert!(with.is_found() && without.is_found());
    assert_eq!((with.steps, with.refuted_steps), (without.steps, without.refuted_steps));
    assert!(with.attempts.iter().filter(|attempt| attempt.is_solve()).count() <= 2);
    assert!(with.nodes() <= without.nodes());
    let tube = with.tube.unwrap();
    let hits = (0..tube.steps()).filter(|&t| tube.is_possible(t, 1)).count();
    assert!((1..=3).contains(&hits), "{hits} steps for the impact");
}
