//! Norm limits of systems: plans between polygons, modes one by one, replays, sets, refusals.

use std::f64::consts::TAU;

use carom::Error;
use carom::hybrid::reach::{ReachSets, SetOptions};
use carom::hybrid::{
    HybridProgram, HybridRun, HybridSystem, LinearSystem, Lqr, Matrix, State, TerminalOptions,
    TerminalSet,
};
use carom::model::{Method, Reformulation, norm};
use carom::prelude::*;
use proptest::prelude::*;

use crate::common::config;

/// A body in the plane: positions (m), velocities (m/s), thrusts (m/s²).
struct Puck {
    system: HybridSystem,
    x: [State; 2],
    v: [State; 2],
    u: [Input; 2],
}

fn puck(time_step: f64) -> Puck {
    let mut system = HybridSystem::new(time_step);
    let x = ["x", "y"].map(|name| system.state(name, -20.0, 20.0).unwrap());
    let v = ["vx", "vy"].map(|name| system.state(name, -4.0, 4.0).unwrap());
    let u = ["ux", "uy"].map(|name| system.input(name, -3.0, 3.0).unwrap());
    system.rates([x[0].is(v[0]), x[1].is(v[1]), v[0].is(u[0]), v[1].is(u[1])]).unwrap();
    Puck { system, x, v, u }
}

/// The rows `cos e1 + sin e2 <= radius` of a polygon around a disc.
fn octagon<T: Into<Affine> + Copy>([e, f]: [T; 2], radius: f64) -> Vec<Row> {
    let side = |k: usize| {
        let (sin, cos) = (TAU * k as f64 / 8.0).sin_cos();
        let (e, f): (Affine, Affine) = (e.into(), f.into());
        (cos * e + sin * f).le(radius)
    };
    (0..8).map(side).collect()
}

fn ends(puck: &Puck, program: &mut HybridProgram, angle: f64) {
    let (sin, cos) = angle.sin_cos();
    let at = |along: f64, across: f64| [cos * along - sin * across, sin * along + cos * across];
    let state = |at: [f64; 2]| {
        let [x, v] = [puck.x, puck.v];
        [x[0].equals(at[0]), x[1].equals(at[1]), v[0].equals(0.0), v[1].equals(0.0)]
    };
    program.start(state([0.0, 0.0])).unwrap();
    program.goal(state(at(5.0, 1.0))).unwrap();
}

/// The least sum of lengths of thrusts, with discs, or octagons of this share of them.
fn fuel(angle: f64, octagons: Option<f64>) -> f64 {
    let mut own = puck(0.5);
    let (v, u) = (own.v, own.u);
    match octagons {
        None => {
            own.system.limit("speed", norm(v).le(1.5)).unwrap();
            own.system.limit("thrust", norm(u).le(1.0)).unwrap();
        }
        Some(share) => {
            for (k, row) in octagon(v, share * 1.5).into_iter().enumerate() {
                own.system.limit(&format!("speed {k}"), row).unwrap();
            }
            for (k, row) in octagon(u, share * 1.0).into_iter().enumerate() {
                own.system.limit(&format!("thrust {k}"), row).unwrap();
            }
        }
    }
    own.system.mode("slide").unwrap();
    let mut program = own.system.program(12).unwrap();
    ends(&own, &mut program, angle);
    let fuel = program.sum_norm("fuel", u).unwrap();
    program.minimize(fuel).unwrap();
    let plan = program.solve(&mut BranchAndBound::default()).unwrap();
    assert!(plan.solution.is_optimal());
    assert!(plan.certificate.largest_violation < 2e-6);
    plan.solution.objective().unwrap()
}

#[test]
fn discs_are_between_octagons_and_turn_with_the_plan() {
    let inside = (TAU / 16.0).cos();
    let straight = fuel(0.0, None);
    for angle in [0.0, 0.3, 0.7, 1.1] {
        let disc = fuel(angle, None);
        assert!((disc - straight).abs() < 1e-5 * straight, "{angle}: {disc}, {straight}");
        let (outer, inner) = (fuel(angle, Some(1.0)), fuel(angle, Some(inside)));
        assert!(outer <= disc + 1e-5 && disc <= inner + 1e-5, "{outer}, {disc}, {inner}");
    }
}

/// A puck with a lane in which it may go fast, and a yard around a post in which it may not.
fn yard(modes: usize) -> Puck {
    let mut own = puck(1.0);
    let (x, v, u) = (own.x, own.v, own.u);
    let slow = own.system.mode("yard").unwrap().guard(norm(v).le(1.0)).unwrap();
    slow.guard(norm(u).le(0.8)).unwrap();
    let fast = own.system.mode("lane").unwrap().guard(norm([x[0] - 4.0, x[1] - 2.0]).le(2.5));
    fast.unwrap().guard(norm(u).le(2.0)).unwrap();
    if modes > 2 {
        let far = own.system.mode("far").unwrap().guard(x[0].ge(2.0)).unwrap();
        far.guard(norm([v[0].predicted(), v[1].predicted()]).le(0.6)).unwrap();
    }
    own
}

fn yard_program(own: &Puck, steps: usize) -> HybridProgram {
    let mut program = own.system.program(steps).unwrap();
    let (x, v) = (own.x, own.v);
    program
        .start([x[0].equals(0.0), x[1].equals(0.0), v[0].equals(0.0), v[1].equals(0.0)])
        .unwrap();
    let away = norm([v[0], v[1]]).le(2.0);
    program.goal(([x[0].ge(0.5)], [away])).unwrap();
    let end = [program.end(x[0]).unwrap(), program.end(x[1]).unwrap()];
    let fuel = program.sum_norm("fuel", own.u).unwrap();
    let [ex, ey] = end;
    program.minimize(0.3 * fuel - ex - 0.5 * ey).unwrap();
    program
}

#[test]
fn modes_are_as_each_sequence_by_itself() {
    for modes in [2, 3] {
        let own = yard(modes);
        let steps = 4;
        let names = ["yard", "lane", "far"];
        let taken: Vec<Variable> = names[..modes]
            .iter()
            .map(|name| own.system.transition_named("mode", name).unwrap())
            .collect();
        let mut best = f64::INFINITY;
        for code in 0..modes.pow(steps as u32) {
            let mut program = yard_program(&own, steps);
            for t in 0..steps {
                let one = taken[code / modes.pow(t as u32) % modes];
                let row = program.at(Affine::from(one).equals(1.0), t).unwrap();
                program.add(("as told", t), row).unwrap();
            }
            let solution = BranchAndBound::default().solve(program.model()).unwrap();
            best = best.min(solution.objective().unwrap_or(f64::INFINITY));
        }
        assert!(best.is_finite());
        for method in Method::ALL {
            let mut program = yard_program(&own, steps);
            let reformulation = Reformulation::default().with_method(method);
            program.model_mut().set_reformulation(reformulation);
            let plan = program.solve(&mut BranchAndBound::default()).unwrap();
            let found = plan.solution.objective().unwrap();
            assert!(
                (found - best).abs() < 2e-4 * (1.0 + best.abs()),
                "{method:?}: {found}, {best}"
            );
        }
    }
}

#[test]
fn replays_name_the_limit_and_the_step() {
    let mut own = puck(1.0);
    own.system.limit("speed", norm(own.v).le(1.5)).unwrap();
    own.system.mode("slide").unwrap().limit("thrust", norm(own.u).le(1.0)).unwrap();
    let run = |thrusts: &[[f64; 2]]| -> HybridRun {
        let mut free = puck(1.0);
        free.system.mode("slide").unwrap();
        free.system.simulate(&[0.0; 4], thrusts).unwrap().to_run()
    };
    let text = |thrusts: &[[f64; 2]]| own.system.certify(&run(thrusts)).unwrap_err().to_string();
    // Within the box of each entry, and within the octagon of some of them.
    own.system.certify(&run(&[[0.6, 0.8], [0.3, 0.4]])).unwrap();
    assert_eq!(
        text(&[[0.6, 0.8], [0.6, 0.81]]),
        "the run is not certified: the transition `slide` of `mode` in step 1 violates the guard \
         `thrust` by 8.018e-3; tighten the solver's feasibility tolerance",
    );
    assert_eq!(
        text(&[[0.6, 0.8], [0.6, 0.8]]),
        "the run is not certified: sample 2 violates the limit `speed` by 5.000e-1; tighten the \
         solver's feasibility tolerance",
    );
    // The simulator stops there, too.
    let ended = own.system.simulate(&[0.0; 4], &[[0.6, 0.8], [0.6, 0.8]]).unwrap();
    assert_eq!(ended.steps.len(), 1);
    let text = ended.end().unwrap_err().to_string();
    assert!(text.contains("`speed`"), "{text}");
}

#[test]
fn squares_are_the_norms_that_they_are() {
    let mut by_norm = puck(1.0);
    by_norm.system.limit("speed", norm(by_norm.v).le(1.5)).unwrap();
    by_norm.system.mode("slide").unwrap();
    let mut by_squares = puck(1.0);
    let [vx, vy] = by_squares.v;
    by_squares.system.limit("speed", (vx.square() + vy.square()).le(2.25)).unwrap();
    by_squares.system.mode("slide").unwrap();
    assert_eq!(by_norm.system, by_squares.system);
    let text = by_norm.system.to_string();
    assert!(text.contains("\nalways |(vx, vy)| <= 1.5 (speed; a limit)\n"), "{text}");

    // Within a parabola: 2 y >= x^2.
    let mut bowl = puck(1.0);
    let [x, y] = bowl.x;
    let slide = bowl.system.mode("slide").unwrap();
    slide.guard(x.square().le(2.0 * y)).unwrap();
    let limits = |x: f64, y: f64| {
        let ended = bowl.system.simulate(&[x, y, 0.0, 0.0], &[[0.0, 0.0]]).unwrap();
        ended.steps.len() == 1
    };
    assert!(limits(2.0, 2.0) && limits(-1.0, 0.6) && !limits(2.0, 1.9) && !limits(1.0, 0.4));
}

#[test]
fn limits_of_series_follow_the_steps() {
    let mut own = puck(1.0);
    let most = own.system.series("most", [1.0, 0.5]).unwrap();
    own.system.limit("thrust", norm(own.u).le(most)).unwrap();
    own.system.mode("slide").unwrap();
    assert!(own.system.to_string().contains("|(ux, uy)| <= 1 until step 0, 0.5 from then on"));
    let mut program = own.system.program(2).unwrap();
    program.start(own.x.map(|x| x.equals(0.0))).unwrap();
    program.require("still", own.v.map(|v| v.equals(0.0)), When::At(0)).unwrap();
    let [vx, vy] = own.v;
    program.maximize(program.end(3.0 * vx + 4.0 * vy).unwrap()).unwrap();
    let plan = program.solve(&mut BranchAndBound::default()).unwrap();
    assert!((plan.solution.objective().unwrap() - 7.5).abs() < 1e-4);
    let later = own.system.from_step(1);
    assert!(later.to_string().contains("|(ux, uy)| <= 0.5 (thrust; a limit)"));
}

#[test]
fn regions_are_discs() {
    let mut own = puck(1.0);
    own.system.limit("thrust", norm(own.u).le(1.0)).unwrap();
    own.system.mode("slide").unwrap();
    let disc = norm([own.x[0] - 3.0, own.x[1] - 0.0]).le(1.0);
    let region = own.system.region([disc.clone()]).unwrap();
    assert!(region.contains(&[3.7, 0.7, 0.0, 0.0], 0.0).unwrap());
    assert!(!region.contains(&[3.8, 0.7, 0.0, 0.0], 0.0).unwrap());
    let mut program = own.system.program(4).unwrap();
    program.start([own.x[0].equals(0.0), own.x[1].equals(0.0)]).unwrap();
    program.require("still", own.v.map(|v| v.equals(0.0)), When::At(0)).unwrap();
    program.require("pass", disc, When::OnceIn(2..=3)).unwrap();
    program.goal(region).unwrap();
    program.maximize(program.end(own.x[1]).unwrap()).unwrap();
    let plan = program.solve(&mut BranchAndBound::default()).unwrap();
    assert!((plan.value(own.x[1], 4).unwrap() - 1.0).abs() < 1e-3);
    let far = |t: usize| {
        let at = own.x.map(|x| plan.value(x, t).unwrap());
        (at[0] - 3.0).hypot(at[1])
    };
    assert!(far(2).min(far(3)) <= 1.0 + 1e-5 && far(4) <= 1.0 + 1e-5);
}

proptest! {
    #![proptest_config(config(40, "tests/regressions/norm_sets.txt"))]

    /// Runs within true discs are in the sets, which have polygons around them.
    #[test]
    fn runs_within_discs_are_in_the_sets(
        turns in prop::collection::vec((0.0..TAU, 0.0..1.0_f64), 1..5),
        from in (0.0..TAU, 0.9..1.0_f64),
    ) {
        let mut own = puck(0.5);
        own.system.limit("speed", norm(own.v).le(1.5)).unwrap();
        own.system.limit("thrust", norm(own.u).le(2.0)).unwrap();
        own.system.mode("slide").unwrap();
        let start = ([own.v[0].equals(0.0), own.v[1].equals(0.0)], [norm(own.x).le(1.0)]);
        let goal = own.system.region([own.x[0].ge(-20.0)]).unwrap();
        let mut sets = ReachSets::new(&own.system, start, goal, SetOptions::default()).unwrap();
        prop_assert!((sets.norm_excess() - (1.0 / (TAU / 32.0).cos() - 1.0)).abs() < 1e-12);
        let mut state = vec![from.1 * from.0.cos(), from.1 * from.0.sin(), 0.0, 0.0];
        for (t, (angle, share)) in turns.iter().enumerate() {
            let held = sets.forward(t).unwrap();
            prop_assert!(held.iter().flatten().any(|set| set.contains(&state).unwrap()));
            let thrust = [2.0 * share.sqrt() * angle.cos(), 2.0 * share.sqrt() * angle.sin()];
            let run = own.system.simulate(&state, &[thrust]).unwrap();
            match run.end() {
                Ok(end) => state = end.to_vec(),
                Err(_) => break,
            }
        }
    }
}

#[test]
fn explanations_flaws_and_terminal_sets_know_lengths() {
    // Too slow, in the plane but not along an axis.
    let mut own = puck(1.0);
    own.system.limit("speed", norm(own.v).le(1.0)).unwrap();
    own.system.mode("slide").unwrap();
    let at = |at: f64| [own.x[0].equals(at), own.x[1].equals(at)];
    let options = SetOptions::default().with_direction([1.0, 1.0, -0.5, -0.5]);
    let mut sets = ReachSets::new(&own.system, at(0.0), at(5.0), options).unwrap();
    assert!(sets.explain(8).unwrap().is_none());
    let explanation = sets.explain(6).unwrap().unwrap();
    assert!(explanation.remedies.contains(&"without speed".to_owned()), "{explanation}");
    let program = |steps: usize| {
        let mut program = own.system.program(steps).unwrap();
        program.start(at(0.0)).unwrap();
        program.goal(at(5.0)).unwrap();
        program.solve(&mut BranchAndBound::default())
    };
    assert!(program(7).is_err() && program(8).is_ok());

    // Nothing is said beyond the disc.
    let mut gap = puck(1.0);
    gap.system.mode("slow").unwrap().guard(norm(gap.v).le(2.0)).unwrap();
    let flaws = gap.system.well_posedness(&mut BranchAndBound::default()).unwrap();
    assert!(flaws.iter().any(|flaw| flaw.to_string().starts_with("gap in `mode`")), "{flaws:?}");

    // A feedback that brakes within its disc for ever.
    let mut brake = puck(0.5);
    brake.system.limit("thrust", norm(brake.u).le(1.0)).unwrap();
    brake.system.limit("speed", norm(brake.v).le(2.0)).unwrap();
    brake.system.mode("slide").unwrap();
    let flow = LinearSystem::new(
        Matrix::from_fn(4, 4, |i, j| {
            if i == j {
                1.0
            } else if j == i + 2 {
                0.5
            } else {
                0.0
            }
        }),
        Matrix::from_fn(4, 2, |i, j| {
            if i == j {
                0.125
            } else if i == j + 2 {
                0.5
            } else {
                0.0
            }
        }),
        [0.0; 4],
    )
    .unwrap();
    let weight = |size: usize| Matrix::from_fn(size, size, |i, j| f64::from(i == j));
    let lqr = Lqr::new(&flow, weight(4), weight(2)).unwrap();
    let (options, solver) = (TerminalOptions::default(), &mut BranchAndBound::default());
    let set = TerminalSet::new(&brake.system, &["slide"], &lqr, &[0.0; 4], &options, solver);
    let set = set.unwrap();
    assert!(set.region.contains(&[0.3, 0.3, 0.0, 0.0], 0.0).unwrap());
    for k in 0..40 {
        // On the boundary along a ray.
        let (sin, cos) = (TAU * f64::from(k) / 40.0).sin_cos();
        let ray = |length: f64| vec![length * cos, length * sin, -0.5 * length * sin, 0.3 * length];
        let mut length = 4.0;
        while !set.region.contains(&ray(length), 0.0).unwrap() {
            length -= 0.01;
        }
        let mut state = ray(length);
        for _ in 0..30 {
            let u = set.feedback(&state).unwrap();
            assert!(u[0].hypot(u[1]) <= 1.0 + 1e-9 && state[2].hypot(state[3]) <= 2.0 + 1e-9);
            state = flow.step(&state, &u).unwrap();
        }
    }
}

#[test]
fn soft_limits_of_lengths_cost_what_is_beyond() {
    let mut own = puck(1.0);
    own.system.mode("slide").unwrap();
    let mut program = own.system.program(3).unwrap();
    program.start(own.v.map(|v| v.equals(0.0))).unwrap();
    program.require("fast", [own.v[0].equals(1.8), own.v[1].equals(2.4)], When::At(3)).unwrap();
    let soft = program.soften("speed", norm(own.v).le(2.0), 10.0, 0.0).unwrap();
    program.minimize(soft.cost).unwrap();
    let plan = program.solve(&mut BranchAndBound::default()).unwrap();
    assert!((plan.value(soft.excess, 0).unwrap() - 1.0).abs() < 1e-5);
    let squares = (own.v[0].square() + own.v[1].square()).le(4.0);
    assert_eq!(
        program.soften("squares", squares, 1.0, 0.0).unwrap_err().to_string(),
        "the row `squares` of squares cannot stand in a soft limit; state it as a norm, so that the \
         excess is a length",
    );
    let far = program.soften("far", norm(own.v).ge(4.0), 1.0, 0.0).unwrap_err().to_string();
    assert!(far.starts_with("the row `far[0]` says that a norm is at least"), "{far}");
}

#[test]
fn constant_lengths_hold_always_or_never() {
    let mut own = HybridSystem::new(1.0);
    let x = own.state("x", -9.0, 9.0).unwrap();
    let u = own.input("u", -1.0, 1.0).unwrap();
    // A jump to 3 is never within 2 of the origin, and one to 1 always is.
    for (name, to) in [("far", 3.0), ("near", 1.0)] {
        let jump = own.event(name).unwrap().next([x.is(Affine::constant(to))]).unwrap();
        jump.guard(norm([x.predicted()]).le(2.0)).unwrap();
    }
    own.mode("roll").unwrap().next([x.is(x + u)]).unwrap();
    let mut program = own.program(1).unwrap();
    program.start([x.equals(0.0)]).unwrap();
    program.maximize(program.end(x).unwrap()).unwrap();
    let plan = program.solve(&mut BranchAndBound::default()).unwrap();
    assert!((plan.solution.objective().unwrap() - 1.0).abs() < 1e-6);
    let first = SimulationOptions::default().with_first_possible(true);
    let run = own.simulate_with(&[5.0], &[[0.5]], &first).unwrap();
    assert_eq!(run.steps[0].taken, ["near"]);
}

#[test]
fn balls_of_one_and_three_entries_are_inside_their_polygons() {
    let mut own = HybridSystem::new(1.0);
    let v = ["a", "b", "c"].map(|name| own.state(name, -9.0, 9.0).unwrap());
    own.limit("ball", norm(v).le(1.0)).unwrap();
    own.limit("slab", norm([v[0]]).le(0.9)).unwrap();
    own.mode("stay").unwrap().next([v[0].is(v[0])]).unwrap();
    let all = own.region([v[0].ge(-9.0)]).unwrap();
    let mut sets = ReachSets::new(&own, &all, &all, SetOptions::default()).unwrap();
    let excess = 1.5_f64.sqrt() / (TAU / 32.0).cos() - 1.0;
    assert!((sets.norm_excess() - excess).abs() < 1e-12);
    let held = sets.forward(0).unwrap();
    let is_in = |state: &[f64]| held.iter().flatten().any(|set| set.contains(state).unwrap());
    for k in 0..200 {
        let (height, turn) = (f64::from(k) / 100.0 - 1.0, 2.4 * f64::from(k));
        let radius = (1.0 - height * height).max(0.0).sqrt();
        let point = [0.9 * height, radius * turn.cos(), radius * turn.sin()];
        assert!(is_in(&point), "{point:?}");
    }
    assert!(!is_in(&[0.0, 0.9, 0.9]) && !is_in(&[0.95, 0.0, 0.0]));
    let mut program = own.program(1).unwrap();
    program.maximize(program.end(v[0] + v[1] + v[2]).unwrap()).unwrap();
    let plan = program.solve(&mut BranchAndBound::default()).unwrap();
    assert!((plan.solution.objective().unwrap() - 3.0_f64.sqrt()).abs() < 1e-4);
}

#[test]
fn refusals_name_the_row_and_the_way_out() {
    fn text<T>(result: Result<T, Error>) -> String {
        match result {
            Ok(_) => "nothing is refused".to_owned(),
            Err(error) => error.to_string(),
        }
    }
    let mut own = puck(1.0);
    let (x, v, u) = (own.x, own.v, own.u);
    let predicted = v.map(|v| v.predicted());
    let system = &mut own.system;
    assert_eq!(
        text(system.limit("far", norm(x).ge(3.0))),
        "the row `far` says that a norm is at least something, which is not convex; write a \
         disjunction of sides, such as `either(x.ge(r)).or(x.le(-r)).or(y.ge(r)).or(y.le(-r))`",
    );
    let saddle = text(system.limit("saddle", (x[0].square() - x[1].square()).le(1.0)));
    assert!(saddle.starts_with("the quadratic row `saddle` is not convex: its left"), "{saddle}");
    assert!(saddle.contains("along the direction `y` 1;"), "{saddle}");
    assert_eq!(
        text(system.limit("next", norm(predicted).le(1.0))),
        "the prediction in `next` cannot stand in a limit of the system; limits hold at every \
         sample; use the state itself",
    );
    assert_eq!(
        text(system.limit("none", norm([1.0, 2.0]).le(3.0))),
        "statement `none` has no variable left (all coefficients are zero); drop it, or check the \
         expression it was built from",
    );
    assert_eq!(
        text(system.mode("a").unwrap().invariant(norm(u).le(1.0))),
        "the row `|(ux, uy)| <= 1` cannot stand in an invariant of `a`; an invariant is about \
         states; use `guard` for inputs",
    );
    let mixed = norm([Affine::from(predicted[0]), v[1].into()]).le(1.0);
    assert_eq!(
        text(system.mode("b").unwrap().guard(mixed)),
        "the row `|(vx', vy)| <= 1` cannot stand in a guard of `b`; state it of the start of the \
         step alone or of the prediction alone",
    );
    assert_eq!(
        text(system.region([norm(u).le(1.0)])),
        "the row `|(ux, uy)| <= 1` cannot stand in a region of states; a region is stated with \
         states and modes",
    );
    let other = puck(1.0);
    let foreign = text(system.limit("foreign", norm(other.x).le(1.0)));
    assert!(foreign.contains("belongs to another model or system"), "{foreign}");
}
