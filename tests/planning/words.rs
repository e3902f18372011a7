//! What is said: of starts outside a domain, tubes, searches, outputs, predictions and ends, word
//! by word.

use std::sync::{Arc, Mutex};
use std::time::Duration;

use carom::ErrorKind;
use carom::explain::{ExplainOptions, infeasibility};
use carom::hybrid::scene::ScenePlan;
use carom::hybrid::{Feedback, HorizonRefutation, HorizonVerdict, Mission, RobustError};
use carom::model::Nonlinear;
use carom::prelude::*;

fn solver() -> BranchAndBound {
    BranchAndBound::default()
}

/// A cart on a line: the system, position, speed, acceleration.
fn cart() -> (HybridSystem, State, State, Input) {
    let mut cart = HybridSystem::new(0.5); // s
    let x = cart.state("p", 0.0, 9.0).unwrap(); // m
    let v = cart.state("v", -2.0, 2.0).unwrap(); // m/s
    let a = cart.input("a", -1.0, 1.0).unwrap(); // m/s²
    cart.mode("go").unwrap().rates([x.is(v), v.is(a)]).unwrap();
    (cart, x, v, a)
}

/// Every way to state a start beyond a domain is refused as `shortest` refuses it.
#[test]
fn a_start_outside_its_domain_is_named() {
    let (cart, p, v, _) = cart();
    let text =
        |value: &str| format!("the start of `p` is {value}; it must be within its domain, 0 to 9");
    let refused = |rows: Vec<Row>| {
        let mut program = cart.program(5).unwrap();
        let before = program.model().to_string();
        let error = program.start(rows).unwrap_err();
        assert!(matches!(error.kind(), ErrorKind::OutOfRange { .. }));
        assert_eq!(program.model().to_string(), before);
        error.to_string()
    };
    assert_eq!(refused(vec![p.equals(12.0), v.equals(0.0)]), text("12"));
    assert_eq!(refused(vec![v.equals(0.0), (2.0 * p - 1.0).equals(-5.0)]), text("-2"));
    let mut program = cart.program(5).unwrap();
    let error = program.start([12.0, 0.0]).unwrap_err();
    assert_eq!(error.to_string(), text("12"));
    let goal = [p.equals(1.0), v.equals(0.0)];
    let error = cart.shortest([p.equals(12.0), v.equals(0.0)], goal, &mut solver()).unwrap_err();
    assert_eq!(error.to_string(), text("12"));
    // Rounding at an end of the domain is no error.
    program.start([p.equals(-1e-12), v.equals(0.0)]).unwrap();
    assert!(program.solve(&mut solver()).is_ok());
}

/// Where the start is a region, the explanation names the domain at step 0.
#[test]
fn the_domain_at_the_start_is_what_plays_a_part() {
    let (cart, p, v, _) = cart();
    for start in [vec![p.ge(12.0), v.equals(0.0)], vec![(p + v).ge(11.5)]] {
        let two = start.len() == 1;
        let mut program = cart.program(5).unwrap();
        program.start(start).unwrap();
        let why =
            infeasibility(program.model(), &ExplainOptions::default(), &mut solver()).unwrap();
        let names: Vec<String> = why.domains().iter().map(ToString::to_string).collect();
        match two {
            true => assert_eq!(names, ["p[0]", "v[0]"], "{why}"),
            false => assert_eq!(names, ["p[0]"], "{why}"),
        }
    }
}

/// Modes that meet at 6 m, by invariants or by guards on the start of steps.
fn road_and_mud(by_invariant: bool) -> (HybridProgram, HybridSystem) {
    let mut cart = HybridSystem::new(0.5); // s
    let x = cart.state("x", 0.0, 10.0).unwrap();
    let v = cart.state("v", -4.0, 4.0).unwrap();
    let a = cart.input("a", -2.0, 2.0).unwrap();
    cart.disturbance(v, -0.01, 0.01).unwrap();
    let road = cart.mode("road").unwrap().rates([x.is(v), v.is(a)]).unwrap();
    let row = x.le(6.0);
    if by_invariant {
        road.invariant(row).unwrap()
    } else {
        road.guard(row).unwrap()
    };
    let mud = cart.mode("mud").unwrap().rates([x.is(v), v.is(a - 0.5 * v)]).unwrap();
    let row = x.ge(6.0);
    if by_invariant {
        mud.invariant(row).unwrap()
    } else {
        mud.guard(row).unwrap()
    };
    let mut program = cart.program(12).unwrap();
    program.start([x.equals(2.0), v.equals(0.0)]).unwrap();
    program.goal([x.within(8.0, 9.0), v.within(-0.5, 0.5)]).unwrap();
    (program, cart)
}

#[test]
fn tubes_are_explained_in_the_names_of_the_system() {
    let (program, cart) = road_and_mud(true);
    assert!(program.solve(&mut solver()).is_ok());
    let robust = program.robust(&Feedback::regulator(&cart).unwrap()).unwrap();
    let error = robust.solve(&mut solver()).unwrap_err();
    assert!(
        matches!(error.kind(), ErrorKind::NoPlan { termination, .. } if termination == "infeasible")
    );
    let source = std::error::Error::source(&error).unwrap();
    let known = source.downcast_ref::<RobustError>().unwrap();
    assert!(
        matches!(known, RobustError::NoCrossing { from, to, .. } if from == "road" && to == "mud")
    );
    assert_eq!(
        known.to_string(),
        "no tube goes from `road` to `mud`, because disturbed runs do not all end a step where `x' <= 6` \
         and `x >= 6` meet; use `guard` in place of `invariant`, so that a step may cross it, or let the \
         two overlap by more than the tube is wide"
    );
    let model = robust.program().model();
    let why = infeasibility(model, &ExplainOptions::default(), &mut solver()).unwrap();
    let text = why.to_string();
    assert!(!text.contains("tube_"), "{text}");
    assert!(text.contains("the goal of `x` for every disturbance at step 12"), "{text}");
    assert!(text.contains("no tube comes from `road`: it ends at `x' <= 6`"), "{text}");
    // The way out.
    let (program, cart) = road_and_mud(false);
    let robust = program.robust(&Feedback::regulator(&cart).unwrap()).unwrap();
    assert!(robust.solve(&mut solver()).is_ok());
}

/// A `Write` that several hold.
#[derive(Clone, Default)]
struct Shared(Arc<Mutex<Vec<u8>>>);

impl std::io::Write for Shared {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.0.lock().unwrap().extend(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

impl Shared {
    fn text(&self) -> String {
        String::from_utf8(self.0.lock().unwrap().clone()).unwrap()
    }

    fn options(&self) -> ShortestOptions {
        let mut log = Log::new(self.clone());
        ShortestOptions::default().with_progress(move |event| event.record(&mut log))
    }
}

/// The lines of a log without their seconds and nodes.
fn lines(text: &str) -> Vec<String> {
    let line = |line: &str| line.split([',', '(']).next().unwrap_or_default().trim_end().to_owned();
    text.lines().map(line).collect()
}

#[test]
fn searches_tell_what_they_do() {
    let (mut cart, p, v, _) = cart();
    let (start, goal) = ([p.equals(0.0), v.equals(0.0)], [p.equals(4.0), v.equals(0.0)]);
    let log = Shared::default();
    let found = cart.shortest_with(start.clone(), goal, &log.options(), &mut solver()).unwrap();
    let steps = found.steps.unwrap();
    let said = lines(&log.text());
    assert_eq!(said.last().unwrap(), &format!("{steps} steps: a plan"), "{}", log.text());
    assert_eq!(
        said[0],
        format!("1 to {} steps: refuted by reach sets", steps - 1),
        "{}",
        log.text()
    );
    // Without sets, every refutation is a solve.
    let log = Shared::default();
    let options = log.options().with_reach_sets(false);
    let goal = [p.equals(4.0), v.equals(0.0)];
    let found = cart.shortest_with(start.clone(), goal, &options, &mut solver()).unwrap();
    assert_eq!(found.steps, Some(steps));
    let solves = found.attempts.iter().map(|attempt| lines(&attempt.to_string()).remove(0));
    assert_eq!(lines(&log.text()), solves.collect::<Vec<_>>(), "{}", log.text());
    assert!(log.text().contains("refuted by"), "{}", log.text());
    // Robust searches.
    cart.disturbance(v, -0.01, 0.01).unwrap();
    let goal = [p.within(3.0, 5.0), v.within(-1.0, 1.0)];
    let (log, feedback) = (Shared::default(), Feedback::regulator(&cart).unwrap());
    let found =
        cart.shortest_robust(start, goal, &feedback, &log.options(), &mut solver()).unwrap();
    let last = format!("{} steps: a plan", found.steps.unwrap());
    assert!(lines(&log.text()).contains(&last), "{}", log.text());
    // Scenes.
    let log = Shared::default();
    let scene = Scene::new(0.5).with_body(puck([0.4, 0.4, 0.0, 0.0]));
    let found = scene.shortest_with(&log.options(), &mut solver()).unwrap();
    let last = format!("{} steps: a plan", found.steps.unwrap());
    assert!(lines(&log.text()).contains(&last), "{}", log.text());
    // The paper's vehicle.
    use carom::collision_tolerant::Scenario;
    let log = Shared::default();
    let options = log.options();
    let scenario = Scenario::paper().with_time_step(0.05);
    let found = scenario.shortest_with(&options, &mut solver()).unwrap();
    let last = format!("{} steps: a plan", found.steps.unwrap());
    assert!(lines(&log.text()).contains(&last), "{}", log.text());
}

#[test]
fn verdicts_and_limits_are_words() {
    let words = |verdict: HorizonVerdict| verdict.to_string();
    assert_eq!(words(HorizonVerdict::Refuted(HorizonRefutation::Sets)), "refuted by reach sets");
    assert_eq!(
        words(HorizonVerdict::Undecided(Termination::TimeLimit)),
        "open (time limit of this solve)"
    );
    assert_eq!(
        words(HorizonVerdict::NotAsGuessed),
        "no plan with the modes of a coarser one, which says nothing about others"
    );
    let (cart, p, v, _) = cart();
    let at = |x: f64| [p.equals(x), v.equals(0.0)];
    // A limit of each solve, and one of the whole search.
    let mut hasty = BranchAndBound::new(Options::default().with_time_limit(Duration::ZERO));
    let options = ShortestOptions::default().with_reach_sets(false).with_max_steps(30);
    let found = cart.shortest_with(at(0.0), at(4.0), &options, &mut hasty).unwrap();
    let text = found.to_string();
    assert!(
        text.starts_with(
            "stopped (time limit of each solve), under the time-stepped law with Δt = 0.5 s"
        ),
        "{text}"
    );
    let options = options.with_time_limit(Duration::ZERO);
    let found = cart.shortest_with(at(0.0), at(4.0), &options, &mut solver()).unwrap();
    assert_eq!(
        found.to_string(),
        "stopped (time limit of the whole search), under the time-stepped law with Δt = 0.5 s: no plan \
         was found"
    );
}

/// The restriction to the modes of a coarser plan may fail; that is no verdict of infeasibility.
#[test]
fn no_attempt_is_undecided_because_it_is_infeasible() {
    use carom::collision_tolerant::Scenario;
    let scenario = Scenario::paper().with_time_step(0.05);
    let found = scenario.shortest(&mut solver()).unwrap();
    for attempt in &found.attempts {
        assert_ne!(attempt.verdict, HorizonVerdict::Undecided(Termination::Infeasible));
        assert!(!attempt.restricted || !matches!(attempt.verdict, HorizonVerdict::Undecided(_)));
    }
}

/// An output that no transition states is 0: in programs, missions, runs and their tables.
#[test]
fn an_output_that_nobody_states_is_zero() {
    let mut cart = HybridSystem::new(1.0); // s
    let x = cart.state("x", 0.0, 9.0).unwrap();
    let u = cart.input("u", -1.0, 1.0).unwrap();
    let noise = cart.output("noise").unwrap();
    cart.mode("roll").unwrap().next([x.is(x + u)]).unwrap();
    let program = |row: Row, when: When| {
        let mut program = cart.program(3).unwrap();
        program.start([x.equals(1.0)]).unwrap();
        program.require("quiet", [row], when).unwrap();
        program
    };
    for when in [When::At(1), When::Throughout(0..=2), When::OnceIn(0..=2)] {
        let plan = program(noise.le(0.5), when.clone()).solve(&mut solver()).unwrap();
        assert_eq!(plan.values(noise).unwrap(), [0.0; 3]);
        assert_eq!(plan.run.output("noise").unwrap(), [0.0; 3]);
        assert!(plan.run.to_csv().starts_with("time,x,u,noise"), "{}", plan.run.to_csv());
        let never = program(noise.ge(0.5), when).solve(&mut solver()).unwrap_err();
        assert!(
            matches!(never.kind(), ErrorKind::NoPlan { termination, .. } if termination == "infeasible")
        );
    }
    let run = cart.simulate(&[1.0], &[[1.0], [0.0]]).unwrap().to_run();
    assert_eq!(run.output("noise").unwrap(), [0.0; 2]);
    assert_eq!(cart.output_named("noise").unwrap(), noise);
    let quiet = Mission::holds("quiet", [noise.le(0.5)]);
    assert_eq!(cart.robustness(&quiet, &run).unwrap(), 0.5);
}

/// Two choices about one state: `gear` has a guard on what it predicts, and `brake` changes the
/// same speed.
fn two_choices(
    of_brake: impl Fn(State, State) -> Vec<(State, Nonlinear)>,
) -> Result<HybridSystem, Error> {
    let mut car = HybridSystem::new(1.0); // s
    let x = car.state("x", -9.0, 9.0)?;
    let v = car.state("v", -9.0, 9.0)?;
    let w = car.state("w", -9.0, 9.0)?;
    let u = car.input("u", -1.0, 1.0)?;
    car.rates([x.is(1.0 * v), v.is(1.0 * u), w.is(Affine::constant(0.0))])?;
    car.mode_of("gear", "slow")?.guard(x.predicted().le(5.0))?;
    car.mode_of("gear", "fast")?.rates([v.is(2.0 * u)])?;
    car.mode_of("brake", "off")?;
    car.mode_of("brake", "on")?.rates(of_brake(v, w))?;
    Ok(car)
}

#[test]
fn a_guard_on_a_part_of_the_step_is_refused() {
    let error = two_choices(|v, _| vec![v.is(-1.0 * v)]).unwrap().program(3).unwrap_err();
    assert_eq!(
        error.to_string(),
        "the guard `x' <= 5` of `slow` cannot stand in the choice `gear` while `brake` changes the flow of \
         `x` as well; a choice predicts by its own flow alone; state the guard of the start of the step, \
         limit the state itself by `invariant` or `limit` of the system, or state both choices as one"
    );
    // A choice that changes another state is no obstacle, also where both flows are computed.
    assert!(two_choices(|_, w| vec![w.is(1.0 - w)]).unwrap().program(3).is_ok());
    // Lengths are guards too.
    let mut car = HybridSystem::new(1.0); // s
    let x = car.state("x", -9.0, 9.0).unwrap();
    let y = car.state("y", -9.0, 9.0).unwrap();
    car.next([x.is(1.0 * x), y.is(1.0 * y)]).unwrap();
    car.mode_of("gear", "slow")
        .unwrap()
        .guard(norm([x.predicted(), y.predicted()]).le(5.0))
        .unwrap();
    car.mode_of("brake", "on").unwrap().next([y.is(y + 1.0)]).unwrap();
    let error = car.simulate(&[0.0, 0.0], &[[0.0; 0]]).unwrap_err();
    assert!(error.to_string().contains("changes the flow of `y` as well"), "{error}");
}

#[test]
fn a_reset_with_an_input_names_the_input() {
    let (mut cart, p, v, a) = cart();
    let hit = cart.event("hit").unwrap();
    let error = hit.reset([v.is(-0.5 * v.predicted() + a)]).unwrap_err();
    assert_eq!(
        error.to_string(),
        "the input `a` cannot stand in a reset of `hit`; state it by predictions, such as \
         `v.predicted()`, and by series; what an input does belongs in the flow"
    );
    let error = cart.event("kick").unwrap().reset([p.is(-p)]).unwrap_err();
    assert!(error.to_string().starts_with("the new value of `p` cannot stand"), "{error}");
}

#[test]
fn goals_and_bare_handles_are_named() {
    let (mut cart, p, _, a) = cart();
    let loud = cart.output("loud").unwrap();
    let mut program = cart.program(5).unwrap();
    for (row, what) in [(a.le(0.5), "input `a`"), ((p + loud).le(0.5), "output `loud`")] {
        assert_eq!(
            program.goal([row]).unwrap_err().to_string(),
            format!(
                "the {what} cannot stand in a goal; goals are rows of states and modes at the last sample, \
                 at which no step begins; require it of steps by `require`, such as \
                 `When::Throughout(0..=steps - 1)`"
            )
        );
    }
    program.require("gentle", [a.le(0.5)], When::Throughout(0..=4)).unwrap();
    let text = "`p`, used in `bare`, is a handle of a system and no variable of the model; take handles \
                of a system at a sample with `at`, such as `program.at(p, 0)?`";
    let error = program.add("bare", p.le(3.0)).unwrap_err();
    assert_eq!(error.to_string(), text);
    assert!(
        matches!(error.kind(), ErrorKind::ForeignHandle { name: Some(name), .. } if name == "p")
    );
    assert_eq!(program.add("bare", norm([p, p]).le(3.0)).unwrap_err().to_string(), text);
    let error = program.minimize(a.square()).unwrap_err();
    assert!(error.to_string().starts_with("`a`, used in"), "{error}");
    let stranger = Model::new("other").continuous("y", 0.0, 1.0).unwrap();
    let error = program.add("bare", stranger.le(3.0)).unwrap_err();
    assert!(
        error.to_string().starts_with("variable number 0 used in `bare` belongs to"),
        "{error}"
    );
}

/// A puck on a table of 2 m x 2 m with its goal in the middle.
fn puck(start: [f64; 4]) -> Body {
    let goal = |x: &[State], _: &[State]| [x[0].within(0.9, 1.1), x[1].within(0.9, 1.1)];
    let puck = Body::new("puck", [0.0..=2.0, 0.0..=2.0], 9.0, 1.0).with_start(start);
    puck.with_goal_where(goal).unwrap()
}

#[test]
fn a_corner_that_is_not_planned_is_named() {
    let cushion = Surface::bounce(Restitution::new(0.8).unwrap());
    let table = [0.0..=2.0, 0.0..=2.0];
    let scene = Scene::new(0.5)
        .with_body(puck([0.4, 0.4, -4.0, -4.0]))
        .with_room("cushion", &table, cushion);
    let options = ShortestOptions::default().with_max_steps(12);
    let plan = |scene: &Scene| -> ShortestHorizon<ScenePlan> {
        scene.shortest_with(&options, &mut solver()).unwrap()
    };
    let found = plan(&scene);
    let text = found.to_string();
    let (begin, end) = (
        "no plan of up to 12 steps, 6 s, under the time-stepped law with Δt = 0.5 s; longer ones were not \
         looked for; `puck` cannot but hit several things in step 0 (`puck at ",
        "and a body hits at most one in a step unless `Scene::with_corners(true)` allows corners",
    );
    assert!(text.starts_with(begin) && text.ends_with(end), "{text}");
    assert!(plan(&scene.clone().with_corners(true)).is_found());
    // Who can brake in front of one of them does not move into the corner, and opposite walls make
    // none.
    let mut slow = scene.clone();
    slow.bodies = vec![puck([1.9, 0.4, -0.5, -4.0])];
    let found = slow.shortest_with(&options.clone().with_max_steps(1), &mut solver()).unwrap();
    assert!(found.to_string().ends_with("longer ones were not looked for"), "{found}");
    let cushion = Surface::bounce(Restitution::new(0.8).unwrap());
    let walls = Scene::new(0.5)
        .with_body(puck([0.4, 0.4, 0.0, 9.0]))
        .with_obstacle(Solid::halfspace("left", [1.0, 0.0], 0.0, cushion))
        .with_obstacle(Solid::halfspace("right", [-1.0, 0.0], -2.0, cushion));
    let found = plan(&walls);
    assert!(found.to_string().ends_with("longer ones were not looked for"), "{found}");
}

#[test]
fn a_start_in_the_goal_is_named() {
    let (mut cart, p, v, a) = cart();
    let at = |x: f64| [p.equals(x), v.equals(0.0)];
    let said = "the start is in the goal, so that no step is needed; with steps: 1 step at least, 0.5 s, \
                under the time-stepped law with Δt = 0.5 s";
    let found = cart.shortest(at(1.0), at(1.0), &mut solver()).unwrap();
    assert!(found.starts_in_goal && found.steps == Some(1));
    assert_eq!(found.to_string(), said);
    let found = cart.shortest(at(1.0), [p.within(0.5, 2.0)], &mut solver()).unwrap();
    assert_eq!(found.to_string(), said);
    let found = cart.shortest(at(1.0), at(1.5), &mut solver()).unwrap();
    assert!(!found.starts_in_goal && found.to_string().starts_with("3 steps at least"), "{found}");
    // Missions count, and of windows nothing is known.
    let near = Mission::holds("near", [p.le(2.0)]);
    let far = Mission::holds("far", [p.ge(2.0)]).eventually(0..);
    for (mission, is_met) in [(near, true), (far, false)] {
        let options = ShortestOptions::default().with_mission("mission", &mission);
        let all = [p.ge(0.0)];
        let found = cart.shortest_with(at(1.0), all, &options, &mut solver()).unwrap();
        assert_eq!(found.starts_in_goal, is_met, "{mission}");
    }
    let gentle = ShortestOptions::default().with_window("gentle", [a.le(0.5)], When::At(0));
    let found = cart.shortest_with(at(1.0), at(1.0), &gentle, &mut solver()).unwrap();
    assert!(!found.starts_in_goal);
    // Limits hold at the start too.
    cart.limit("not here", (p + v).ge(1.5)).unwrap();
    let found = cart.shortest([p.ge(0.0)], [p.le(2.5)], &mut solver()).unwrap();
    assert!(!found.starts_in_goal);
    // Robust searches and scenes.
    let (mut cart, p, v, _) = self::cart();
    cart.disturbance(v, -0.01, 0.01).unwrap();
    let feedback = Feedback::regulator(&cart).unwrap();
    let (start, goal) = ([p.equals(1.0), v.equals(0.0)], [p.within(0.5, 1.5), v.within(-0.5, 0.5)]);
    let options = ShortestOptions::default();
    let found = cart.shortest_robust(start, goal, &feedback, &options, &mut solver()).unwrap();
    assert!(found.starts_in_goal && found.to_string().starts_with("the start is in the goal"));
    for (start, is_met) in [([1.0, 1.0, 0.0, 0.0], true), ([0.5, 1.0, 0.0, 0.0], false)] {
        let scene = Scene::new(0.5).with_body(puck(start));
        let found = scene.shortest_with(&options, &mut solver()).unwrap();
        assert_eq!(found.starts_in_goal, is_met, "{found}");
    }
}
