//! What tubes write into programs: no plan is ever lost.

use crate::common::config;
use carom::collision_tolerant::{ContactLaw, Endpoint, Objective, PlanningProgram, Scenario, Wall};
use carom::hybrid::reach::{HorizonVariables, ReachSets, Reason, SetOptions, TighteningReport};
use carom::hybrid::scene::DamageRule;
use carom::hybrid::{HybridSystem, LinearSystem, Matrix};
use carom::interval::Interval;
use carom::prelude::*;
use carom_hybrid::internals::HasParts;
use carom_hybrid::internals::Transition;
use proptest::prelude::*;

/// A plan in plain numbers.
struct Plan {
    scenario: Scenario,
    position: Vec<f64>,
    velocity: Vec<f64>,
    contact: Vec<bool>,
}

/// Follows accelerations through a scenario's law, from its start; the goal is where that ends.
fn roll_out(mut scenario: Scenario, accelerations: &[f64]) -> Plan {
    let (wall, dt) = (scenario.wall, scenario.time_step);
    let (n, at, e) = (wall.normal(), wall.position(), scenario.restitution.value());
    let (mut x, mut v) = (scenario.start.position, scenario.start.velocity);
    let mut plan = Plan {
        scenario: scenario.clone(),
        position: vec![x],
        velocity: vec![v],
        contact: Vec::new(),
    };
    let literal = scenario.law == ContactLaw::Literal;
    for &a in accelerations {
        let inside = literal && n * (x - at) < 0.0;
        let a = if inside { -(1.0 + e) * v / dt } else { a };
        let (p, w) = (x + dt * v + 0.5 * dt * dt * a, v + dt * a);
        let hit = inside || (!literal && n * (p - at) < 0.0);
        let (next, speed) = match (hit, literal) {
            (true, false) => ((at - e * (p - at), -e * w), -n * w),
            (true, true) => ((p, w), -n * v),
            (false, _) => ((p, w), 0.0),
        };
        let limit = scenario.damage.per_hit.unwrap_or(f64::INFINITY);
        if next.1.abs() > scenario.max_speed || (hit && (speed > limit || speed < 0.0)) {
            break;
        }
        (x, v) = next;
        plan.position.push(x);
        plan.velocity.push(v);
        plan.contact.push(hit);
    }
    scenario.goal = Endpoint::at_rest(x).with_velocity(v);
    plan.scenario = scenario;
    plan
}

/// ζ(t), which is 1 where there is a contact.
fn variables_of(program: &PlanningProgram) -> Vec<Variable> {
    assert!(program.contact.iter().all(|zeta| zeta.is_on()));
    program.contact.iter().map(|zeta| zeta.variable()).collect()
}

/// Writes the tube into the plan's program and checks that the plan still fits.
fn check(plan: &Plan) -> Result<TighteningReport, TestCaseError> {
    let steps = plan.contact.len();
    let mut program = plan.scenario.program(steps, Objective::Feasibility).unwrap();
    let tube = plan.scenario.reach_sets().unwrap().tube(steps).unwrap();
    let variables = program.program().variables().horizon_variables();
    let report = tube.tighten(program.model_mut(), &variables).unwrap();
    prop_assert!(!report.infeasible, "there is a plan");
    let bounds = |variable| program.model().variable_ref(variable).unwrap().bounds();
    for t in 0..=steps {
        for (family, values) in
            [(&program.position, &plan.position), (&program.velocity, &plan.velocity)]
        {
            let (range, value) = (program.model().range(&family[t]).unwrap(), values[t]);
            prop_assert!(
                range.lower - 1e-9 <= value && value <= range.upper + 1e-9,
                "{value} outside {range:?} at {t}"
            );
        }
    }
    let zeta = variables_of(&program);
    for (t, &hit) in plan.contact.iter().enumerate() {
        let value = f64::from(u8::from(hit));
        prop_assert!(bounds(zeta[t]).contains(value), "contact {hit} was excluded at {t}");
    }
    Ok(report)
}

fn scenario() -> impl Strategy<Value = Scenario> {
    let numbers = (0.0..3.0_f64, -4.0..4.0_f64, 0.02..0.3_f64, -50.0..50.0_f64);
    let restitution = prop_oneof![Just(0.0), Just(1.0), 0.0..1.0_f64];
    let limit = prop::option::of(0.5..4.0_f64);
    (numbers, restitution, any::<bool>(), prop::bool::weighted(0.2), limit).prop_map(
        |((gap, speed, dt, at), e, above, literal, limit)| {
            let wall = if above { Wall::above(at) } else { Wall::below(at) }.unwrap();
            let mut damage = DamageRule::default();
            damage.per_hit = limit;
            Scenario::paper()
                .with_wall(wall)
                .with_law(if literal { ContactLaw::Literal } else { ContactLaw::Reflecting })
                .with_start(Endpoint::at_rest(wall.at_gap(gap)).with_velocity(speed))
                .with_goal(Endpoint::at_rest(wall.at_gap(gap)))
                .with_time_step(dt)
                .with_max_speed(6.0)
                .with_damage(damage)
                .with_restitution(e)
                .unwrap()
        },
    )
}

proptest! {
    #![proptest_config(config(200, "tests/regressions/reach.txt"))]

    #[test]
    fn no_plan_is_lost(
        scenario in scenario(),
        pushes in prop::collection::vec(
            (prop_oneof![Just(-6.0), Just(6.0), -6.0..6.0_f64], 1..8_usize), 1..8),
    ) {
        let accelerations: Vec<f64> =
            pushes.iter().flat_map(|&(a, count)| std::iter::repeat_n(a, count)).collect();
        let plan = roll_out(scenario, &accelerations);
        let inside = plan.scenario.check().is_err();
        prop_assume!(!plan.contact.is_empty() && !inside);
        let _report = check(&plan)?;
    }
}

#[test]
fn the_report_says_what_was_done_and_why() {
    let scenario = Scenario::paper().with_time_step(0.05);
    let mut program = scenario.program(48, Objective::Feasibility).unwrap();
    let variables = program.program().variables().horizon_variables();
    let tube = scenario.reach_sets().unwrap().tube(48).unwrap();
    let report = tube.tighten(program.model_mut(), &variables).unwrap();

    let zeta = variables_of(&program);
    let open: Vec<usize> = (0..48).filter(|&t| tube.is_possible(t, 1)).collect();
    assert_eq!(report.open, open.len());
    assert_eq!(report.parts().fixed.len(), 48 - open.len());
    for change in report.parts().fixed {
        assert_eq!((change.variable, change.to.upper), (zeta[change.step], 0.0));
        assert_eq!(change.reason, Reason::Impossible(1));
    }
    assert!(report.parts().tightened.iter().any(|change| change.reason == Reason::Tube));
    assert!(report.parts().tightened.iter().any(|change| change.name.family() == "impact_speed"));
    assert_eq!(report.rows.len(), 1);
    assert_eq!((tube.fewest_events(), tube.most_events()), (Some(1), Some(2)));
    let text = format!(
        "48 steps: {} binaries fixed, {} open, {} bounds tightened, 1 row added",
        report.parts().fixed.len(),
        open.len(),
        report.parts().tightened.len()
    );
    assert_eq!(report.to_string(), text);

    // The row is optional.
    let mut plain = scenario.program(48, Objective::Feasibility).unwrap();
    let variables = plain.program().variables().horizon_variables().with_event_row(false);
    let without = tube.tighten(plain.model_mut(), &variables).unwrap();
    assert_eq!((without.rows.len(), without.parts().fixed.len()), (0, report.parts().fixed.len()));

    // The tightened program has a plan, and its automatic big-Ms are those of its steps.
    let solution = BranchAndBound::default().solve(program.model()).unwrap();
    assert!(solution.is_optimal());
    let hits: f64 = zeta.iter().map(|z| solution.value(z).unwrap()).sum();
    assert!(hits >= 1.0);
}

#[test]
fn modes_that_are_no_events_need_no_row() {
    // Two gears, none of them an event: the number of events says nothing.
    let mut model = Model::new("gears");
    let x = model.continuous_family("x", 6, -9.0, 9.0).unwrap();
    let second = model.binary_family("second", 5).unwrap();
    let gear = |gain: f64| {
        let (a, b) = (Matrix::from_fn(1, 1, |_, _| 1.0), Matrix::from_fn(1, 1, |_, _| gain));
        LinearSystem::new(a, b, vec![0.0]).unwrap()
    };
    let system = HybridSystem::new(1.0)
        .with_state("x", Interval::new(-9.0, 9.0))
        .with_input("u", Interval::new(-1.0, 1.0))
        .with_transition(Transition::new("first", gear(0.5)))
        .with_transition(Transition::new("second", gear(1.0)));
    let at = |x| [Interval::point(x)];
    let mut sets = ReachSets::new(&system, at(0.0), at(4.0), SetOptions::default()).unwrap();
    let tube = sets.tube(5).unwrap();
    let variables = HorizonVariables::new([x]).with_transition(1, second);
    let report = tube.tighten(&mut model, &variables).unwrap();
    assert_eq!((report.open, report.rows.len(), tube.fewest_events()), (5, 0, Some(0)));
    assert!(!report.parts().tightened.is_empty());
}

#[test]
fn a_user_may_exclude_what_the_sets_need() {
    // Every plan of 47 steps hits the wall; a program that forbids it has none.
    let scenario = Scenario::paper().with_time_step(0.05);
    let mut program = scenario.program(47, Objective::Feasibility).unwrap();
    let variables = program.program().variables().horizon_variables();
    let tube = scenario.reach_sets().unwrap().tube(47).unwrap();
    assert_eq!(tube.fewest_events(), Some(1));
    let only: Vec<usize> = (0..47).filter(|&t| !tube.is_possible(t, 0)).collect();
    let zeta = variables_of(&program);
    for z in &zeta {
        program.model_mut().fix(*z, 0.0).unwrap();
    }
    let before = program.model().clone();
    let report = tube.tighten(program.model_mut(), &variables).unwrap();
    // Where the impact has only one step, its binary is contradicted.
    assert_eq!(report.infeasible, !only.is_empty());
    if report.infeasible {
        assert_eq!(report.to_string(), "47 steps: no plan");
        assert_eq!(program.model().to_string(), before.to_string());
    }
    let solution = BranchAndBound::default().solve(program.model()).unwrap();
    assert!(solution.is_infeasible());
}
