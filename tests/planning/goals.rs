//! Goals that are regions, and programs that their user extends: the plans are certified all the
//! same.

use crate::common::config;
use carom::ErrorKind;
use carom::collision_tolerant::{
    ContactLaw, Endpoint, Objective, Plan, PlanningProgram, Scenario, Trajectory, Wall,
};
use carom::explain::{ExplainOptions, infeasibility};
use carom::hybrid::scene::SceneError;
use carom::hybrid::{
    Region, RunError, ShortestHorizon, ShortestOptions, SolvedHorizon, shortest_horizon,
};
use carom::interval::Interval;
use carom::prelude::*;
use carom_hybrid::internals::Halfspace;
use proptest::prelude::*;

fn solver() -> BranchAndBound {
    BranchAndBound::default()
}

fn coarse() -> Scenario {
    Scenario::paper().with_time_step(0.1)
}

fn search(scenario: &Scenario, sets: bool) -> ShortestHorizon<Plan> {
    let search = ShortestOptions::default().with_max_steps(60).with_reach_sets(sets);
    let found = shortest_horizon(scenario, &search, &mut solver()).unwrap();
    let plan = |of: SolvedHorizon<PlanningProgram>| of.program.plan(&of.solution);
    found.try_map(plan).unwrap()
}

/// Whether it is proved that there is no plan.
fn is_infeasible(planned: Result<Plan, Error>) -> bool {
    let infeasible = Termination::Infeasible.to_string();
    matches!(planned.unwrap_err().kind(), ErrorKind::NoPlan { termination, .. } if *termination == infeasible)
}

fn steps(scenario: &Scenario) -> usize {
    let found = search(scenario, true);
    assert!(found.is_found(), "{}", found.status);
    found.steps.unwrap()
}

fn last(trajectory: &Trajectory) -> [f64; 2] {
    let t = trajectory.steps();
    [trajectory.position[t], trajectory.velocity[t]]
}

#[test]
fn a_point_as_a_region_is_the_point() {
    for scenario in [coarse(), coarse().collision_free(), coarse().with_law(ContactLaw::Literal)] {
        let region = scenario.clone().with_goal_region(Region::point([0.3, 0.0]));
        assert_eq!(region.monotonicity(), scenario.monotonicity());
        assert_eq!(steps(&region), steps(&scenario));
    }
    // The next goal replaces the region.
    let moved = coarse().with_goal_region(Region::point([9.0, 1.0])).with_goal_position(0.3);
    assert_eq!(moved, coarse());
}

proptest! {
    #![proptest_config(config(16, "tests/regressions/goals.txt"))]

    /// A region is reached as soon as the first of its points, and sets do not change that.
    #[test]
    fn a_region_is_as_near_as_its_nearest_point(
        above in any::<bool>(),
        e in prop_oneof![Just(0.0), 0.0..1.0_f64],
        corner in (0.0..2.0_f64, -2.0..1.0_f64),
        size in (0.1..1.0_f64, 0.0..1.0_f64),
        cut in (-1.0..1.0_f64, -1.0..1.0_f64, 0.0..1.0_f64),
    ) {
        let wall = if above { Wall::above(1.0) } else { Wall::below(1.0) }.unwrap();
        let n = wall.normal();
        let ends = |one: f64, other: f64| Interval::new(one.min(other), one.max(other));
        let positions = ends(wall.at_gap(corner.0), wall.at_gap(corner.0 + size.0));
        let velocities = ends(n * corner.1, n * (corner.1 + size.1));
        // A half-space through the box.
        let at = |share: f64| [
            positions.lower + share * (positions.upper - positions.lower),
            velocities.lower + share * (velocities.upper - velocities.lower),
        ];
        let middle = at(cut.2);
        let halfspace =
            Halfspace::new("cut", [cut.0, cut.1], cut.0 * middle[0] + cut.1 * middle[1]);
        let region = Region::from([positions, velocities]).with_halfspace(halfspace);
        let scenario = coarse()
            .with_time_step(0.2)
            .with_wall(wall)
            .with_start(Endpoint::at_rest(wall.at_gap(4.0)))
            .with_restitution(e)
            .unwrap();
        let task = scenario.clone().with_goal_region(region.clone());
        let (found, blind) = (search(&task, true), search(&task, false));
        prop_assert_eq!((found.steps, found.refuted_steps), (blind.steps, blind.refuted_steps));
        prop_assert!(found.is_found());
        let found_end = last(&found.plan.unwrap().trajectory);
        prop_assert!(region.contains(&found_end, 3e-6).unwrap(), "{:?}", found_end);
        // The point where it ends is not nearer, and no point of a grid is.
        let steps = found.steps.unwrap();
        let grid = (0..9).map(|k| [f64::from(k / 3) / 2.0, f64::from(k % 3) / 2.0]);
        for [a, b] in grid {
            let state = [at(a)[0], at(b)[1]];
            if region.contains(&state, 0.0).unwrap() {
                let goal = Endpoint::at_rest(state[0]).with_velocity(state[1]);
                let own = scenario.clone().with_goal(goal).plan(steps - 1, Objective::Feasibility, &mut solver());
                prop_assert!(steps == 1 || is_infeasible(own), "{state:?}");
            }
        }
    }
}

#[test]
fn waiting_at_a_region_needs_rest_in_all_of_it() {
    let moving = coarse().with_start(Endpoint::at_rest(10.0).with_velocity(-1.0));
    let anywhere = [Interval::new(0.2, 0.4), Interval::point(0.0)];
    assert!(moving.clone().with_goal_region(anywhere).monotonicity().is_monotone());
    let slow = [Interval::point(0.3), Interval::new(-0.1, 0.1)];
    assert!(!moving.with_goal_region(slow).monotonicity().is_monotone());
    assert!(coarse().with_goal_region(slow).monotonicity().is_monotone());
}

#[test]
fn regions_without_ends_reach_as_far_as_the_vehicle() {
    // Away from the wall at 3 m/s and more, anywhere.
    let away = [Interval::REALS, Interval::new(3.0, f64::INFINITY)];
    let scenario = coarse().with_goal_region(away);
    // a(0) = 0, and then 6 m/s² for 0.5 s.
    assert_eq!(steps(&scenario), 6);
    assert_eq!(steps(&scenario.with_wall(Wall::below(12.0).unwrap())), 6);
}

#[test]
fn regions_are_named_in_explanations() {
    let slow = Halfspace::new("slower than the distance", [-1.0, -1.0], 0.0);
    let box_of = [Interval::new(0.1, 0.5), Interval::new(-1.0, 0.0)];
    let scenario = coarse().with_goal_region(Region::from(box_of).with_halfspace(slow));
    let shortest = steps(&scenario);
    let text = scenario.reach_sets().unwrap().explain(shortest - 1).unwrap().unwrap().to_string();
    assert!(text.starts_with(&format!("no plan has {} steps", shortest - 1)), "{text}");
    let program = scenario.explainable_program(shortest - 4).unwrap();
    let text = program.model().to_string();
    assert!(text.contains("goal_limit[19]: -vehicle_x["), "{text}");
    let why = infeasibility(program.model(), &ExplainOptions::default(), &mut solver()).unwrap();
    assert!(why.groups().iter().any(|group| group.name() == "goal_position"), "{why}");
}

#[test]
fn regions_that_cannot_be_ends_are_refused() {
    let text = |region: Region| coarse().with_goal_region(region).check().unwrap_err().to_string();
    let all = Interval::REALS;
    assert_eq!(
        text(vec![all].into()),
        "`the goal of vehicle` has 1 entries and the scene needs 2; give one per axis, and in starts \
         and goals one per position, one per velocity, one for a spin, and one for a heading"
    );
    assert_eq!(
        text([Interval::new(1.0, 0.0), all].into()),
        "bounds of `x` are crossed: 1 > 0; swap or relax them"
    );
    assert_eq!(
        text([Interval::new(-2.0, -1.0), all].into()),
        "`vehicle` ends inside `wall`; move one of them"
    );
    assert_eq!(
        text([all, Interval::new(-30.0, -16.0)].into()),
        "`vehicle` ends with vx from -30 to -16, outside its largest speed, -15 to 15 m/s; move it, \
         or widen the limit"
    );
    let far = coarse().with_domain(0.0..=11.0).with_goal_region([Interval::new(12.0, 13.0), all]);
    assert_eq!(
        far.check().unwrap_err().to_string(),
        "`vehicle` ends with x from 12 to 13, outside its domain, 0 to 11 m; move it, or widen the \
         limit"
    );
    let named = Region::point([0.3, 0.0]).with_mode("mode", "flying");
    assert_eq!(text(named), "the model has no choice of the system named `mode`");
}

// -- extended programs --------------------------------------------------------------------------

#[test]
fn extended_programs_are_certified() {
    let scenario = coarse();
    let mut program = scenario.program(30, Objective::Effort).unwrap();
    let plain = solver().solve(program.model()).unwrap();
    // Never faster than 5 m/s, and no push in step 7.
    for t in 0..=30 {
        program.add(("slow", t), program.velocity[t].within(-5.0, 5.0)).unwrap();
    }
    program.add("idle", program.acceleration[7].equals(0.0)).unwrap();
    let solution = solver().solve(program.model()).unwrap();
    let plan = program.plan(&solution).unwrap();
    assert!(plan.solution.objective().unwrap() > plain.objective().unwrap());
    assert!(plan.trajectory.velocity.iter().all(|v| v.abs() <= 5.0 + 1e-6));
    assert!(plan.trajectory.acceleration[7].abs() <= 1e-6);
    let system = scenario.hybrid_system().unwrap();
    assert!(system.certify(&plan.run).unwrap().largest_violation <= 2e-6);
}

#[test]
fn plans_of_other_scenarios_are_no_plans() {
    let scenario = coarse();
    let program = scenario.program(30, Objective::Effort).unwrap();
    let solution = solver().solve(program.model()).unwrap();
    let refused = |scenario: &Scenario| {
        let mut of_other = program.clone();
        of_other.scenario = scenario.clone();
        of_other.plan(&solution).unwrap_err()
    };
    let error = refused(&scenario.clone().with_goal_position(0.4));
    assert!(matches!(error.kind(), ErrorKind::Scene(SceneError::Replay { .. })), "{error}");
    let error =
        refused(&scenario.clone().with_start(Endpoint::at_rest(10.0).with_acceleration(1.0)));
    assert!(matches!(error.kind(), ErrorKind::Scene(SceneError::Replay { .. })), "{error}");
    let error = refused(&scenario.clone().with_acceleration(-1.0..=1.0));
    assert!(matches!(error.kind(), ErrorKind::Scene(SceneError::Replay { .. })), "{error}");
    // A solution of another program.
    let other = scenario.program(30, Objective::Effort).unwrap();
    let error = other.plan(&solution).unwrap_err();
    assert!(matches!(error.kind(), ErrorKind::ForeignHandle { .. }), "{error}");
}

#[test]
fn extensions_that_bend_the_scenario_are_found() {
    let scenario = coarse();
    let mut program = scenario.program(24, Objective::Effort).unwrap();
    // Stronger than the vehicle is.
    for a in program.acceleration.clone().iter().skip(1).take(23) {
        program.model_mut().set_bounds(a.terms()[0].0, -20.0, 20.0).unwrap();
    }
    let solution = solver().solve(program.model()).unwrap();
    let error = program.plan(&solution).unwrap_err();
    assert!(matches!(error.kind(), ErrorKind::Run(RunError::Transition { .. })), "{error}");
    // Elsewhere than the goal.
    let is_goal =
        |row: &carom::model::ConstraintRef| row.name().to_string() == "goal_vehicle_x[24]";
    let goal = program.model().constraints().find(is_goal).unwrap().id();
    program.model_mut().set_limits(goal, 0.0, 9.0).unwrap();
    let solution = solver().solve(program.model()).unwrap();
    let error = program.plan(&solution).unwrap_err();
    assert!(matches!(error.kind(), ErrorKind::Scene(SceneError::Replay { .. })), "{error}");
}
