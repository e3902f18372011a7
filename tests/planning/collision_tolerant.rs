//! The paper's figures, the scenario's checks, and what a plan promises.

use carom::ErrorKind;
use carom::collision_tolerant::{ContactLaw, Endpoint, Objective, Plan, Scenario, Wall};
use carom::hybrid::scene::{DamageLimitOptions, DamageMeasure, DamageRule};
use carom::hybrid::{HorizonVerdict, ImpactEstimate, ShortestStatus};
use carom::interval::Interval;
use carom::prelude::*;

fn solver() -> BranchAndBound {
    BranchAndBound::default()
}

/// How a solve without a plan ended.
fn ending(planned: Result<Plan, Error>) -> String {
    match planned.unwrap_err().kind() {
        ErrorKind::NoPlan { termination, .. } => termination.clone(),
        other => panic!("{other:?}"),
    }
}

fn objective(plan: &Plan) -> f64 {
    plan.solution.objective().unwrap()
}

/// Shortest horizon with the next smaller one refuted, plan certified.
fn shortest(scenario: &Scenario) -> (usize, usize) {
    let found = scenario.shortest(&mut solver()).unwrap();
    assert_eq!(found.status, ShortestStatus::Found);
    let steps = found.steps.unwrap();
    assert_eq!(found.refuted_steps, Some(steps - 1));
    let neighbour = found.attempts.iter().find(|attempt| attempt.steps == steps - 1);
    assert!(
        matches!(neighbour.unwrap().verdict, HorizonVerdict::Refuted(_)),
        "refuted, not assumed"
    );
    let plan = found.plan.expect("a found horizon has a plan");
    assert!(plan.solution.verification().is_some_and(Verification::holds));
    assert!(plan.certificate.drift <= 1e-6);
    assert!(plan.fewest_impacts);
    (steps, plan.trajectory.impacts.len())
}

// -- the paper's figures ------------------------------------------------------------------------

#[test]
fn table_3_is_reproduced() {
    let paper = Scenario::paper();
    assert_eq!(shortest(&paper.clone().collision_free()), (510, 0)); // 2.55 s
    assert_eq!(shortest(&paper), (457, 1)); // plastic: 2.285 s
    let nearly_plastic = paper.with_restitution(0.025).unwrap();
    assert_eq!(shortest(&nearly_plastic), (449, 1)); // the printed 2.245 s
}

#[test]
fn bouncier_walls_on_coarser_grids() {
    let bouncy = Scenario::paper().with_restitution(0.5).unwrap();
    assert_eq!(shortest(&bouncy.clone().with_time_step(0.02)).0, 123);
    assert_eq!(shortest(&bouncy.with_time_step(0.0125)).0, 195);
}

#[test]
fn the_literal_law_never_pays_off() {
    for e in [0.0, 0.5] {
        let scenario = Scenario::paper().with_time_step(0.05).with_restitution(e).unwrap();
        let literal = scenario.clone().with_law(ContactLaw::Literal);
        let both = literal.compare(&ShortestOptions::default(), &mut solver()).unwrap();
        assert!(both.free.is_found() && both.tolerant.is_found());
        assert_eq!(both.tolerant.steps, both.free.steps);
        assert_eq!(both.hitting_pays(), Some(false));
        // The reflecting law does pay off here.
        let both = scenario.compare(&ShortestOptions::default(), &mut solver()).unwrap();
        assert_eq!(both.hitting_pays(), Some(true));
    }
}

#[test]
fn the_damage_limit_of_table_4_is_an_interval() {
    let interval = Scenario::paper()
        .damage_limit_range(478, &DamageLimitOptions::default(), &mut solver())
        .unwrap();
    assert_eq!(interval.stopped, None);
    assert!(interval.lower.resolution() <= 1.01e-3 && interval.upper.resolution() <= 1.01e-3);
    assert!((interval.lower.attained - 6.1709).abs() < 2e-3, "{interval:?}");
    assert!((interval.upper.attained - 6.2704).abs() < 2e-3, "{interval:?}");

    let limit = interval.middle().unwrap();
    let limited = Scenario::paper().with_damage(DamageRule::default().with_per_hit(limit));
    let found = limited.shortest(&mut solver()).unwrap();
    assert_eq!((found.steps, found.refuted_steps), (Some(478), Some(477))); // 2.39 s
    let plan = found.plan.unwrap();
    assert!(plan.trajectory.largest_damage() <= limit + 1e-6);
}

#[test]
fn minimising_the_largest_damage_agrees_with_the_interval() {
    let scenario = Scenario::paper().with_time_step(0.05);
    let options = DamageLimitOptions::default();
    let interval = scenario.damage_limit_range(49, &options, &mut solver()).unwrap();
    for (steps, end) in [(49, interval.lower), (48, interval.upper)] {
        let plan = scenario.plan(steps, Objective::LargestDamage, &mut solver()).unwrap();
        assert_eq!(plan.solution.termination(), Termination::Optimal);
        assert!(end.bound <= objective(&plan) + 1e-6 && objective(&plan) <= end.attained + 1e-6);
        assert!((plan.trajectory.largest_damage() - objective(&plan)).abs() < 1e-6);
    }
}

#[test]
fn hitting_stops_paying_for_far_goals() {
    // In continuous time a plastic stop pays for goals nearer than about 0.67 m.
    for (goal, pays) in [(0.3, true), (0.5, true), (1.0, false)] {
        let scenario = Scenario::paper().with_time_step(0.025).with_goal_position(goal);
        let both = scenario.compare(&ShortestOptions::default(), &mut solver()).unwrap();
        assert_eq!(both.hitting_pays(), Some(pays), "goal at {goal} m");
        // Where it does not pay, the plan does not hit without need.
        let impacts = both.tolerant.plan.unwrap().trajectory.impacts.len();
        assert_eq!(impacts, usize::from(pays));
    }
}

// -- invariances --------------------------------------------------------------------------------

#[test]
fn walls_elsewhere_and_facing_the_other_way_change_nothing() {
    let (start, goal) = (Endpoint::at_rest(10.0), Endpoint::at_rest(0.3));
    for e in [0.0, 0.5] {
        let plain = Scenario::paper().with_time_step(0.05).with_restitution(e).unwrap();
        let (wanted, impacts) = shortest(&plain);
        // Erratum 1: the printed row is wrong for walls that are not at 0.
        let moved = |position: f64, sign: f64| {
            let place = |end: Endpoint| {
                Endpoint::at_rest(position + sign * end.position).with_acceleration(0.0)
            };
            let wall = if sign > 0.0 { Wall::above(position) } else { Wall::below(position) };
            plain.clone().with_start(place(start)).with_goal(place(goal)).with_wall(wall.unwrap())
        };
        for scenario in [moved(-4.0, 1.0), moved(7.0, 1.0), moved(0.0, -1.0), moved(3.0, -1.0)] {
            assert_eq!(shortest(&scenario), (wanted, impacts));
            let literal = scenario.with_law(ContactLaw::Literal);
            let both = literal.compare(&ShortestOptions::default(), &mut solver()).unwrap();
            assert_eq!(both.hitting_pays(), Some(false));
        }
    }
}

#[test]
fn a_domain_that_no_plan_leaves_changes_nothing() {
    let plain = Scenario::paper().with_time_step(0.05);
    assert_eq!(shortest(&plain.clone().with_domain(0.0..=10.0)), shortest(&plain));
    assert_eq!(shortest(&plain.clone().with_domain(-5.0..=500.0)), shortest(&plain));
    // One that keeps the vehicle off the wall forbids the hit.
    let clear = shortest(&plain.clone().with_domain(0.1..=10.0));
    assert_eq!(clear, shortest(&plain.collision_free()));
}

// -- waiting ------------------------------------------------------------------------------------

#[test]
fn waiting_is_free_only_where_the_vehicle_can_rest() {
    let paper = Scenario::paper();
    assert!(paper.monotonicity().is_monotone());
    let rest = Endpoint::at_rest(5.0);
    let moving = rest.with_velocity(-1.0);
    let pushed = rest.with_acceleration(1.0);
    assert!(paper.clone().with_start(rest).with_goal(moving).monotonicity().is_monotone());
    assert!(paper.clone().with_start(moving).with_goal(rest).monotonicity().is_monotone());
    // a(0) applies: a start with a push is no equilibrium. a(τ) does not.
    let no = paper.clone().with_start(pushed).with_goal(moving).monotonicity();
    assert!(!no.is_monotone());
    assert_eq!(no.reason(), "the vehicle can rest neither at its start nor at its goal");
    assert!(paper.clone().with_start(moving).with_goal(pushed).monotonicity().is_monotone());
    let thrust = paper.with_acceleration(1.0..=6.0).monotonicity();
    assert_eq!(thrust.reason(), "zero acceleration is not admissible");
}

#[test]
fn without_waiting_every_smaller_horizon_is_refuted() {
    let start = Endpoint::at_rest(3.0).with_velocity(-2.0);
    let goal = Endpoint::at_rest(1.0).with_velocity(2.0);
    let scenario = Scenario::paper()
        .with_time_step(0.1)
        .with_start(start)
        .with_goal(goal)
        .with_restitution(0.8)
        .unwrap();
    assert!(!scenario.monotonicity().is_monotone());
    let found = scenario.shortest(&mut solver()).unwrap();
    let steps = found.steps.unwrap();
    assert!(found.is_found());
    let tried: Vec<usize> = found.attempts.iter().map(|attempt| attempt.steps).collect();
    assert_eq!(tried, (1..=steps).collect::<Vec<_>>());

    let error = scenario.damage_limit_range(steps, &DamageLimitOptions::default(), &mut solver());
    let text = error.unwrap_err().to_string();
    assert!(text.starts_with("the scene has no damage interval: its shortest horizon"), "{text}");
}

// -- fixed horizons -----------------------------------------------------------------------------

#[test]
fn a_cumulative_budget_and_a_weight_soften_the_plan() {
    let scenario = Scenario::paper().with_time_step(0.1);
    let steps = 27;
    let effort = |scenario: &Scenario| {
        let plan = scenario.plan(steps, Objective::Effort, &mut solver()).unwrap();
        assert_eq!(plan.solution.termination(), Termination::Optimal);
        plan
    };
    let free = effort(&scenario);
    assert!((free.trajectory.effort() - objective(&free)).abs() < 1e-3);
    let hard = free.trajectory.total_damage();
    assert!(hard > 2.0);

    let budget = effort(&scenario.clone().with_damage(DamageRule::default().with_total(2.0)));
    assert!(budget.trajectory.total_damage() <= 2.0 + 1e-6);
    assert!(objective(&budget) > objective(&free));

    let charged = effort(&scenario.with_damage(DamageRule::default().with_price(5.0)));
    let damage = charged.trajectory.total_damage();
    assert!(damage < hard);
    assert!((charged.trajectory.effort() + 5.0 * damage - objective(&charged)).abs() < 1e-3);
}

#[test]
fn impacts_are_reported_with_their_physics() {
    let e = 0.5;
    let scenario = Scenario::paper().with_time_step(0.05).with_restitution(e).unwrap();
    let plan = scenario.plan(52, Objective::Impacts, &mut solver()).unwrap();
    assert_eq!(plan.trajectory.impacts.len(), 0); // 52 steps need none
    let found = scenario.shortest(&mut solver()).unwrap();
    let trajectory = found.plan.unwrap().trajectory;
    let impact = trajectory.impacts[0];
    let t = impact.step;
    assert!(trajectory.contact[t]);
    assert!((trajectory.damage[t] - impact.speed_before).abs() < 1e-9);
    assert!((trajectory.velocity[t + 1] - impact.speed_after).abs() < 1e-6);
    assert!((impact.impulse - (1.0 + e) * impact.speed_before).abs() < 1e-9);
    assert!((impact.energy_lost - 0.375 * impact.speed_before.powi(2)).abs() < 1e-9);
    assert!(trajectory.time[t] <= impact.time && impact.time <= trajectory.time[t + 1]);

    let csv = trajectory.to_csv();
    assert!(csv.starts_with("time,position,velocity,acceleration,contact,damage\n0,10,0,"));
    assert_eq!(csv.lines().count(), trajectory.steps() + 2);
    let mut cells = csv.lines().skip(1).flat_map(|line| line.split(','));
    assert!(cells.all(|cell| cell != "-0" && cell.len() <= 19), "{csv}");
}

#[test]
fn end_conditions_pin_the_first_and_the_last_acceleration() {
    let program = Scenario::paper().program(3, Objective::Feasibility).unwrap();
    let bounds = |value: &Affine| program.model().range(value).unwrap();
    let fixed = |own: &Affine, value: f64| {
        let found = bounds(own);
        (found.lower, found.upper) == (value, value)
    };
    assert!(fixed(&program.acceleration[0], 0.0) && fixed(&program.acceleration[3], 0.0));
    assert_eq!(bounds(&program.acceleration[2]).upper, 6.0);
    let stated = |name: &str| {
        let mut rows = program.model().constraints();
        let row = rows.find(|row| row.name().to_string() == name).expect(name);
        assert!(row.terms().iter().all(|(_, factor)| *factor == 1.0));
        let limits = row.limits();
        (row.terms()[0].0, limits.lower, limits.upper)
    };
    let position = |t: usize| program.position[t].terms()[0].0;
    assert_eq!(stated("start_vehicle_x[0]"), (position(0), 10.0, 10.0));
    assert_eq!(stated("goal_vehicle_x[3]"), (position(3), 0.3, 0.3));
    // a(τ) is in no row.
    let last = program.acceleration[3].terms()[0].0;
    let rows = program.model().constraints().flat_map(|row| row.terms());
    let switched = program.model().indicators().flat_map(|indicator| indicator.terms());
    assert!(rows.chain(switched).all(|&(variable, _)| variable != last));
}

#[test]
fn limits_that_exclude_zero_acceleration_hold() {
    // Nothing here hovers: at 1 m/s² and more it leaves, and comes back never.
    let rest = Endpoint::at_rest(0.5);
    let scenario = Scenario::paper().with_start(rest).with_goal(rest).with_time_step(0.1);
    let pushed = scenario.with_acceleration(1.0..=2.0);
    for scenario in [pushed.clone().collision_free(), pushed] {
        let program = scenario.program(3, Objective::Feasibility).unwrap();
        for a in &program.acceleration {
            let bounds = program.model().range(a).unwrap();
            assert_eq!((bounds.lower, bounds.upper), (1.0, 2.0));
        }
        assert_eq!(ending(scenario.plan(3, Objective::Effort, &mut solver())), "infeasible");
    }
}

#[test]
fn too_short_a_horizon_is_infeasible() {
    for scenario in [Scenario::paper(), Scenario::paper().collision_free()] {
        assert_eq!(ending(scenario.plan(1, Objective::Effort, &mut solver())), "infeasible");
    }
}

#[test]
fn interrupts_and_limits_are_answers() {
    let interrupt = Interrupt::new();
    interrupt.trigger();
    let options = ShortestOptions::default().with_interrupt(&interrupt);
    let found = Scenario::paper().shortest_with(&options, &mut solver()).unwrap();
    assert_eq!(found.status, ShortestStatus::Stopped(Termination::Interrupted));
    assert!(found.plan.is_none() && found.refuted_steps.is_none());

    let options = DamageLimitOptions::default().with_interrupt(&interrupt);
    let interval = Scenario::paper().damage_limit_range(478, &options, &mut solver()).unwrap();
    assert_eq!(interval.stopped, Some(Termination::Interrupted));
    assert_eq!(interval.middle(), None);

    let mut control = Control::default().with_interrupt(&interrupt);
    let program = Scenario::paper().program(457, Objective::Effort).unwrap();
    let interrupted = Termination::Interrupted.to_string();
    assert_eq!(ending(program.solve_with(&mut control, &mut solver())), interrupted);

    let options = ShortestOptions::default().with_max_steps(400);
    let found = Scenario::paper().shortest_with(&options, &mut solver()).unwrap();
    assert_eq!(found.status, ShortestStatus::NoneWithin { max_steps: 400 });
    assert_eq!(found.refuted_steps, Some(400));
}

#[test]
fn damage_states_are_what_the_paper_says() {
    // (14)-(18): D(t) is F_d at a contact and 0 otherwise, and costs what its price says.
    for law in [ContactLaw::Reflecting, ContactLaw::Literal] {
        for estimate in [ImpactEstimate::EndOfStep, ImpactEstimate::Sound] {
            let scenario = Scenario::paper().with_time_step(0.1).with_law(law);
            let priced = DamageRule::default().with_price(0.5).with_total(4.0);
            let scenario = scenario.with_estimate(estimate).with_damage(priced);
            let program = scenario.program(27, Objective::Effort).unwrap();
            assert_eq!(program.damage.len(), 27);
            let solution = solver().solve(program.model()).unwrap();
            let plan = program.plan(&solution).unwrap();
            for (t, damage) in program.damage.iter().enumerate() {
                let value = solution.value(damage).unwrap();
                assert!((value - plan.trajectory.damage[t]).abs() < 1e-5, "{law:?}, {t}");
            }
            let total = plan.trajectory.total_damage();
            assert!(total <= 4.0 + 1e-6);
            let cost = plan.trajectory.effort() + 0.5 * total;
            assert!((cost - objective(&plan)).abs() < 1e-3);
        }
    }
    // Rules that need no variables have none.
    let limited = Scenario::paper().with_damage(DamageRule::default().with_per_hit(2.0));
    let program = limited.program(10, Objective::Feasibility).unwrap();
    assert!(program.damage.is_empty());
}

#[test]
fn numbers_of_impacts_and_other_measures_are_limited_as_in_scenes() {
    let scenario = Scenario::paper().with_time_step(0.05).with_restitution(0.5).unwrap();
    let steps = |rule: DamageRule| shortest(&scenario.clone().with_damage(rule)).0;
    let (free, careful) =
        (steps(DamageRule::default()), shortest(&scenario.clone().collision_free()).0);
    assert!(free < careful);
    assert_eq!(steps(DamageRule::default().with_count(0)), careful);
    // An impulse of (1 + e) f per unit of mass.
    let speed = steps(DamageRule::default().with_per_hit(2.0));
    let impulse = DamageRule::new("impulse", DamageMeasure::NormalImpulse);
    assert_eq!(steps(impulse.clone().with_per_hit(3.0)), speed);
    assert_eq!(steps(impulse.with_total(3.0)), steps(DamageRule::default().with_total(2.0)));
}

// -- bad input ----------------------------------------------------------------------------------

#[test]
fn scenarios_that_contradict_themselves_are_refused() {
    let paper = Scenario::paper();
    let rest = Endpoint::at_rest;
    let cases = [
        (
            paper.clone().with_start(rest(f64::NAN)),
            "the position of `start` is NaN; give a finite number",
        ),
        (
            paper.clone().with_goal(rest(1.0).with_acceleration(f64::INFINITY)),
            "the acceleration of `goal` is inf; give a finite number",
        ),
        (
            paper.clone().with_acceleration(Interval::new(6.0, -6.0)),
            "bounds of `acceleration` are crossed: 6 > -6; swap or relax them",
        ),
        (
            paper.clone().with_acceleration(Interval::new(f64::NEG_INFINITY, 6.0)),
            "the lower limit of `acceleration` is -inf; give a finite number",
        ),
        (
            paper.clone().with_max_speed(0.0),
            "the largest speed (m/s) of `vehicle` is 0; it must be finite and positive",
        ),
        (
            paper.clone().with_time_step(-0.1),
            "the time step (s) is -0.1; it must be finite and positive",
        ),
        (paper.clone().with_start(rest(-0.5)), "`vehicle` starts inside `wall`; move one of them"),
        (
            paper.clone().with_goal(rest(0.5)).with_wall(Wall::below(0.2).unwrap()),
            "`vehicle` starts inside `wall`; move one of them",
        ),
        (
            paper.clone().with_start(rest(10.0).with_velocity(-16.0)),
            "`vehicle` starts with vx -16, outside its largest speed, -15 to 15 m/s; move it, or \
             widen the limit",
        ),
        (
            paper.clone().with_start(rest(10.0).with_acceleration(7.0)),
            "the first acceleration of `vehicle` is 7; it must be within -6 and 6",
        ),
        (
            paper.clone().with_goal(rest(0.3).with_acceleration(7.0)),
            "the goal's acceleration is 7; it must be within -6 and 6",
        ),
        (
            paper.clone().with_domain(0.0..=5.0),
            "`vehicle` starts with x 10, outside its domain, 0 to 5 m; move it, or widen the limit",
        ),
        (
            paper.clone().with_damage(DamageRule::default().with_per_hit(-1.0)),
            "the limit of a hit of the rule `damage` is -1; it must be finite and not negative",
        ),
        (
            paper.clone().with_damage(DamageRule::default().with_total(f64::NAN)),
            "the total of the rule `damage` is NaN; it must be finite and not negative",
        ),
        (
            paper.clone().with_damage(DamageRule::default().with_price(f64::INFINITY)),
            "the price of the rule `damage` is inf; it must be finite and not negative",
        ),
    ];
    for (scenario, text) in cases {
        assert_eq!(scenario.check().unwrap_err().to_string(), text);
        // Every entry checks.
        assert!(scenario.plan(10, Objective::Effort, &mut solver()).is_err());
        let options = ShortestOptions::default();
        assert!(scenario.shortest_with(&options, &mut solver()).is_err());
        let options = DamageLimitOptions::default();
        assert!(scenario.damage_limit_range(10, &options, &mut solver()).is_err());
    }
}

#[test]
fn horizons_and_resolutions_out_of_range_are_refused() {
    let paper = Scenario::paper();
    for steps in [0, 1_000_000] {
        let error = paper.plan(steps, Objective::Effort, &mut solver()).unwrap_err();
        assert_eq!(
            error.to_string(),
            format!("the number of steps is {steps}; it must be from 1 to 100000")
        );
    }
    let free = paper.clone().collision_free();
    assert_eq!(free.law, ContactLaw::Forbidden);
    let options = DamageLimitOptions::default();
    assert!(free.damage_limit_range(478, &options, &mut solver()).is_err());
    let fine = options.with_resolution(1e-9);
    assert_eq!(
        paper.damage_limit_range(478, &fine, &mut solver()).unwrap_err().to_string(),
        "the resolution (m/s) is 1e-9; it must be within [1e-5, 1e3]"
    );
}

#[cfg(feature = "serde")]
#[test]
fn scenarios_and_plans_survive_a_file() {
    let scenario = Scenario::paper().with_time_step(0.1);
    let text = serde_json::to_string(&scenario).unwrap();
    assert_eq!(serde_json::from_str::<Scenario>(&text).unwrap(), scenario);
    let bad = text.replace("\"restitution\":0.0", "\"restitution\":2.0");
    assert_ne!(bad, text);
    assert!(serde_json::from_str::<Scenario>(&bad).is_err());

    let plan = scenario.plan(27, Objective::Effort, &mut solver()).unwrap();
    let text = serde_json::to_string(&plan).unwrap();
    let read: carom::collision_tolerant::Plan = serde_json::from_str(&text).unwrap();
    assert_eq!(read.trajectory, plan.trajectory);
    assert_eq!(read.certificate, plan.certificate);
}
