//! Explanations of plans beside a wall: 40 steps that are too few.

use carom::collision_tolerant::{ContactLaw, Endpoint, Objective, Scenario};
use carom::explain::{ExplainOptions, Explanation, infeasibility, violations};
use carom::hybrid::ImpactEstimate;
use carom::hybrid::scene::{DamageMeasure, DamageRule};
use carom::prelude::*;
use carom::solution::Point;

const STEPS: usize = 40;

/// A vehicle beside a plastic wall: wide domains, limits as statements.
fn wall_plan(time_step: f64, damage_limit: f64) -> Model {
    let mut system = HybridSystem::new(time_step);
    let x = system.state("x", 0.0, 40.0).unwrap();
    let v = system.state("v", -20.0, 20.0).unwrap();
    let a = system.input("a", -15.0, 15.0).unwrap();
    let speed = system.output("impact speed").unwrap();
    system.rates([x.is(v), v.is(a)]).unwrap();
    system.mode("flight").unwrap().guard(x.predicted().ge(0.0)).unwrap();
    let impact = system.event("impact").unwrap().guard(x.predicted().le(0.0)).unwrap();
    let impact = impact.guard(v.predicted().le(0.0)).unwrap();
    let impact = impact.reset([x.is(0.0), v.is(0.0)]).unwrap();
    impact.output(speed, -v.predicted()).unwrap();
    let mut model = Model::new("wall_plan");
    let program = system.write(&mut model, "", STEPS).unwrap();
    let (x, v, a) = (&program.states()[0], &program.states()[1], &program.inputs()[0]);
    let hit = |t| program.taken("mode", "impact", t).unwrap().unwrap().variable();
    let hit: Family = (0..STEPS).map(hit).collect();
    for t in 0..STEPS {
        model.add(("acceleration", t), a[t].within(-6.0, 6.0)).unwrap();
        model.add(("speed", t), v[t].within(-15.0, 15.0)).unwrap();
        model.add(("ceiling", t), x[t].le(30.0)).unwrap();
    }
    for (t, speed) in program.output("impact speed").unwrap().iter().enumerate() {
        model.add(("damage_limit", t), speed.clone().le(damage_limit)).unwrap();
    }
    model.add("few_hits", hit.iter().sum::<Affine>().le(3.0)).unwrap();
    model.add("start_position", x[0].equals(10.0)).unwrap();
    model.add("start_velocity", v[0].equals(0.0)).unwrap();
    model.add("goal_position", x[STEPS].equals(0.3)).unwrap();
    model.add("goal_velocity", v[STEPS].equals(0.0)).unwrap();
    model
}

fn explain(model: &Model) -> Explanation {
    let clock = std::time::Instant::now();
    let options = ExplainOptions::default();
    let why = infeasibility(model, &options, &mut BranchAndBound::default()).unwrap();
    println!("{why} [{:.1} s]", clock.elapsed().as_secs_f64());
    why
}

fn names(why: &Explanation) -> Vec<&str> {
    why.groups().iter().map(|group| group.name()).collect()
}

/// The model with only the statements of the explanation and the background, made from a copy by
/// opening the limits of all others, solved: without any one group there is a solution, with all
/// of them there is none.
fn check_by_solves(model: &Model, why: &Explanation) {
    assert!(why.is_irreducible() && why.solves() <= 20);
    let kept: Vec<Name> = why.groups().iter().flat_map(|g| g.statements().to_vec()).collect();
    let solve = |without: Option<&str>| {
        let mut part = model.clone();
        let rows: Vec<(Constraint, Name)> =
            model.constraints().map(|row| (row.id(), row.name().clone())).collect();
        for (row, name) in rows {
            let stays = model.is_background(name.clone())
                || kept.contains(&name) && without != Some(name.family());
            if !stays {
                part.set_limits(row, -1e6, 1e6).unwrap();
            }
        }
        BranchAndBound::default().solve(&part).unwrap()
    };
    assert!(solve(None).is_infeasible(), "the statements named do not contradict each other");
    for group in why.groups() {
        let solution = solve(Some(group.name()));
        assert!(solution.point().is_some(), "`{}` is not needed", group.name());
    }
}

#[test]
fn too_little_time_is_blamed_on_ends_and_acceleration() {
    // 2 s; braking against the wall takes 2.3 s.
    let model = wall_plan(0.05, 20.0);
    let why = explain(&model);
    assert_eq!(
        names(&why),
        ["acceleration", "start_position", "start_velocity", "goal_position", "goal_velocity"]
    );
    check_by_solves(&model, &why);
}

#[test]
fn a_damage_limit_is_named_with_its_steps() {
    // 2.32 s are enough with an impact of 10 m/s, and not without.
    let model = wall_plan(0.058, 3.0);
    let why = explain(&model);
    assert_eq!(
        names(&why),
        [
            "acceleration",
            "damage_limit",
            "start_position",
            "start_velocity",
            "goal_position",
            "goal_velocity"
        ]
    );
    check_by_solves(&model, &why);
    let damage = &why.groups()[1];
    assert!(damage.statements().len() <= 6, "{damage}");
    assert!(why.to_string().contains("damage_limit at step"));
    // Without the limit the point hits the wall hard.
    let harmless = wall_plan(0.058, 3.0);
    let without: &Point = damage.without().unwrap();
    let found = violations(&harmless, without.as_slice(), 1e-6).unwrap();
    assert!(found.iter().all(|v| !v.name.starts_with("goal")));
    assert!(found.iter().any(|v| v.name.starts_with("damage_limit")));
}

#[test]
fn the_papers_own_program_is_explained() {
    let scenario = Scenario::paper().with_time_step(0.05);
    let program = scenario.explainable_program(STEPS).unwrap();
    let why = explain(program.model());
    assert!(why.is_irreducible() && why.solves() <= 20);
    assert_eq!(
        names(&why),
        ["start_position", "start_velocity", "goal_position", "goal_velocity", "acceleration"]
    );

    let limits = DamageRule::default().with_per_hit(3.0);
    let scenario = Scenario::paper().with_time_step(0.06).with_damage(limits);
    let program = scenario.explainable_program(STEPS).unwrap();
    let why = explain(program.model());
    assert!(why.is_irreducible() && why.solves() <= 20);
    assert!(names(&why).contains(&"damage_limit") && names(&why).contains(&"goal_position"));

    // Too short for braking in time, and flying through the wall would not help.
    let careful = Scenario::paper().with_time_step(0.06).collision_free();
    let program = careful.explainable_program(STEPS).unwrap();
    let why = explain(program.model());
    assert!(why.is_irreducible() && why.solves() <= 20);
    assert!(!names(&why).contains(&"wall"));

    // Long enough, but too fast to stop before the wall.
    let start = Endpoint::at_rest(2.0).with_velocity(-8.0);
    let careful = careful.with_start(start).with_time_step(0.1);
    let program = careful.explainable_program(STEPS).unwrap();
    let why = explain(program.model());
    assert!(why.is_irreducible() && why.solves() <= 20);
    assert_eq!(names(&why), ["start_position", "start_velocity", "acceleration", "wall"]);
}

/// In the program for planning, limits are domains: they are named beside the start and the goal.
#[test]
fn a_program_for_planning_blames_its_ends_and_domains() {
    let scenario = Scenario::paper().with_time_step(0.05);
    let program = scenario.program(STEPS, Objective::Feasibility).unwrap();
    let why = explain(program.model());
    assert!(why.is_irreducible());
    assert_eq!(
        names(&why),
        ["start_vehicle_x", "start_vehicle_vx", "goal_vehicle_x", "goal_vehicle_vx"]
    );
    assert!(why.domains().iter().any(|name| name.to_string() == "vehicle_ax[39]"), "{why}");
}

/// The program for questions has the plans of the other one.
#[test]
fn explainable_programs_agree_with_the_fast_ones() {
    for (law, e) in [(ContactLaw::Reflecting, 0.5), (ContactLaw::Literal, 0.0)] {
        let scenario = Scenario::paper().with_time_step(0.2).with_law(law);
        let scenario = scenario.with_restitution(e).unwrap();
        for steps in 10..15 {
            let fast = scenario.program(steps, Objective::Feasibility);
            let stated = scenario.explainable_program(steps).unwrap();
            let solve = |model: &Model| BranchAndBound::default().solve(model).unwrap();
            let (fast, stated) = (solve(fast.unwrap().model()), solve(stated.model()));
            assert_eq!(fast.is_infeasible(), stated.is_infeasible(), "{law:?}, {steps} steps");
        }
    }
}

/// So do those with rules about damage, whatever they measure and sum.
#[test]
fn explainable_programs_have_the_rules_of_the_fast_ones() {
    let rule = |measure| DamageRule::new("rule", measure);
    let energy = || rule(DamageMeasure::DissipatedEnergy);
    let speed = || rule(DamageMeasure::ImpactSpeed);
    let never = DamageMeasure::Convex(vec![(0.0, 2.0), (1.0, 0.0)]);
    let rules = [
        speed().with_per_hit(4.0),
        speed().with_total(5.0),
        speed().with_total(2.0).with_window(3),
        speed().with_count(0),
        rule(DamageMeasure::NormalImpulse).with_per_hit(5.0),
        energy().with_per_hit(3.0),
        rule(DamageMeasure::NormalImpulse).with_per_hit(6.0).with_total(6.0),
        rule(never).with_per_hit(1.0),
    ];
    let mut verdicts = [0, 0];
    for (law, estimate) in [
        (ContactLaw::Reflecting, ImpactEstimate::EndOfStep),
        (ContactLaw::Reflecting, ImpactEstimate::Sound),
        (ContactLaw::Literal, ImpactEstimate::EndOfStep),
    ] {
        for rule in &rules {
            let scenario = Scenario::paper().with_time_step(0.2).with_law(law);
            let scenario = scenario.with_estimate(estimate).with_restitution(0.3).unwrap();
            let scenario = scenario.with_damage(rule.clone());
            for steps in 11..16 {
                let fast = scenario.program(steps, Objective::Feasibility);
                let stated = scenario.explainable_program(steps).unwrap();
                let solve = |model: &Model| BranchAndBound::default().solve(model).unwrap();
                let (fast, stated) = (solve(fast.unwrap().model()), solve(stated.model()));
                let is_none = fast.is_infeasible();
                assert_eq!(is_none, stated.is_infeasible(), "{law:?}, {rule:?}, {steps} steps");
                verdicts[usize::from(is_none)] += 1;
            }
        }
    }
    assert!(verdicts.iter().all(|&count| count > 10), "{verdicts:?}");
}
