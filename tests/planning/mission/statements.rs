//! What missions say: texts, windows, errors, the shortest horizon, reasons, scenes and plain
//! models.

use carom::hybrid::Mission;
use carom::prelude::*;

fn cart() -> Result<(HybridSystem, State, Input), Error> {
    let mut cart = HybridSystem::new(0.5);
    let x = cart.state("x", -9.0, 9.0)?;
    let u = cart.input("u", -1.0, 1.0)?;
    cart.mode("roll")?.next([x.is(x + u)])?;
    Ok((cart, x, u))
}

#[test]
fn texts() -> Result<(), Error> {
    let (_, x, _) = cart()?;
    let places = || [Mission::holds("in A", [x.ge(3.0)]), Mission::holds("F 1", [x.le(0.0)])];
    for (text, written) in [
        ("F[0,10s](in A) & G !(in A)", "F[0,10s] in A & G[0,] !in A"),
        ("in A -> X `F 1`", "!in A | X `F 1`"),
        ("(in A | `F 1`) & true", "(in A | `F 1`) & true"),
        ("in A U[1,2.5s] !`F 1`", "in A U[1,2.5s] !`F 1`"),
        ("G[2,](in A R[0s,] in A)", "G[2,] (in A R[0s,] in A)"),
    ] {
        let mission = Mission::parse(text, places())?;
        assert_eq!(mission.to_string(), written);
        assert_eq!(Mission::parse(written, places())?.to_string(), written);
    }
    // One part alone is written as itself.
    let [a, _] = places();
    let alone = !Mission::any([Mission::all([a])]) & Mission::all([]);
    assert_eq!(alone.to_string(), "!in A & true");
    for (text, error) in [
        ("F[0,5 in A", "line 1, column 7: found `i` in the mission, where `]` was expected"),
        (
            "in A &",
            "line 1, column 7: found the end in the mission, where a name, `(`, or one of `!`, `G`, `F`, `X` \
             was expected",
        ),
        (
            "G[0,1.5] in A",
            "line 1, column 9: found ` ` in the mission, where a window of whole steps, or of seconds as in \
             `[0,2.5s]`, was expected",
        ),
        ("in B", "the model has no predicate named `in B`"),
    ] {
        assert_eq!(Mission::parse(text, places()).unwrap_err().to_string(), error);
    }
    let deep = "(".repeat(5000) + "in A";
    assert!(Mission::parse(&deep, places()).is_err());
    assert!(Mission::parse(&("!".repeat(5000) + "in A"), places()).is_err());
    Ok(())
}

#[test]
fn what_is_refused() -> Result<(), Error> {
    let (cart, x, u) = cart()?;
    let mut program = cart.program(4)?;
    let disc = Mission::holds("disc", [norm([x - 1.0, x + 1.0]).le(2.0)]);
    let rows = Mission::holds("rows", [x.ge(1.0)]);
    let fast = Mission::holds("fast", [u.ge(0.5)]);
    let (count, variables) = (program.model().constraint_count(), program.model().variable_count());
    for (mission, error) in [
        (
            (!disc).always(0..),
            "the row `disc` is negated by the mission, which is not convex; the outside of a disc has no rows: \
             write a polygon inside or around the disc as rows, or the length as `(x.square() + y.square()).sqrt()`; \
             both can be negated",
        ),
        (
            rows.clone().always(0..=5),
            "the last sample of the run of `m` is 4; it must be late enough for its windows: what is beyond \
             the end counts as not true; give it more steps, or let windows last to the end, as in \
             `always(0..)`",
        ),
        (
            fast.clone().always(0..=4),
            "the last sample of the run of `m` is 4; it must be late enough for its windows: what is beyond \
             the end counts as not true; give it more steps, or let windows last to the end, as in \
             `always(0..)`",
        ),
        (
            rows.clone().always(0.6..=0.9),
            "the last step of the window [0.6,0.9s] is 1; it must be at least step 2, its first one with 0.5 s \
             a step; no sample is in the window",
        ),
        (
            rows.clone().eventually(-1.0..=2.0),
            "the beginning of the window [-1,2s] is -1; it must be finite and at least 0 s",
        ),
        (
            // Also where it is never read.
            rows.clone() | rows.clone().always(0.6..=0.9).eventually(7..=8),
            "the last step of the window [0.6,0.9s] is 1; it must be at least step 2, its first one with 0.5 s \
             a step; no sample is in the window",
        ),
    ] {
        assert_eq!(program.require_mission("m", &mission).unwrap_err().to_string(), error);
        assert_eq!(program.model().constraint_count(), count);
        assert_eq!(program.model().variable_count(), variables);
    }
    let nested = (0..200).fold(rows, |mission, _| mission.always(0..=0));
    assert!(program.require_mission("m", &nested).is_err());
    // An open window of inputs ends with the inputs.
    program.require_mission("m", &fast.always(0..))?;
    program.start([x.equals(0.0)])?;
    program.minimize(program.end(x)?)?;
    let plan = program.solve(&mut BranchAndBound::default())?;
    assert!((plan.value(x, 4)? - 2.0).abs() < 1e-6);
    Ok(())
}

#[test]
fn a_mission_and_its_negation_never_both_hold_where_rows_touch() -> Result<(), Error> {
    let (cart, x, _) = cart()?;
    let far = Mission::holds("far", [x.ge(2.0)]);
    for mission in [far.clone().eventually(0..=2), far.clone().always(0..=0), far] {
        let mut program = cart.program(2)?;
        program.start([x.equals(2.0)])?;
        program.require_mission("yes", &mission)?;
        program.require_mission("no", &!&mission)?;
        assert!(BranchAndBound::default().solve(program.model())?.is_infeasible());
    }
    Ok(())
}

/// The window of the release has no sample, and only what comes after the sample at which it is
/// read counts.
#[test]
fn a_release_looks_at_no_earlier_sample() -> Result<(), Error> {
    let (cart, x, _) = cart()?;
    let near = Mission::holds("near", [x.within(-9.0, 9.0)]).always(2..);
    let nothing = Mission::holds_by_sample("nothing", [] as [[Row; 1]; 0]);
    let mission = near.release(0.., nothing).eventually(2..=2);
    assert_eq!(mission.robustness(4, 0.5, |_, _| Some(0.0))?, f64::NEG_INFINITY);
    let mut program = cart.program(3)?;
    program.start([x.equals(0.0)])?;
    let error = program.require_mission("m", &mission).unwrap_err();
    assert!(error.to_string().contains("late enough"), "{error}");
    Ok(())
}

#[test]
fn shortest_horizons() -> Result<(), Error> {
    let (cart, x, _) = cart()?;
    let far = Mission::holds("far", [x.ge(2.0)]);
    let near = Mission::holds("near", [x.within(-2.0, -1.0)]);
    let solver = &mut BranchAndBound::default();
    let mut shortest = |mission: Mission| {
        let options =
            ShortestOptions::default().with_mission("mission", &mission).with_max_steps(20);
        let found = cart.shortest_with([x.equals(0.0)], [x.within(-9.0, 9.0)], &options, solver)?;
        Ok::<_, Error>(found.steps)
    };
    assert_eq!(shortest(far.clone().eventually(0..))?, Some(2));
    // A second at the place is two steps more; a window in seconds that lasts longer than the run
    // is no reason.
    assert_eq!(shortest(near.clone().always(0.0..=1.0).eventually(0.0..=9.0))?, Some(3));
    assert_eq!(shortest((far.clone().eventually(0..)) & near.clone().eventually(0..))?, Some(4));
    assert_eq!(shortest((!far.clone()).always(0..=7))?, Some(7));
    assert_eq!(shortest(far.clone().always(0..))?, None);
    Ok(())
}

#[test]
fn reasons_in_words_of_the_mission() -> Result<(), Error> {
    let (cart, x, _) = cart()?;
    let mut program = cart.program(8)?;
    program.start([x.equals(0.0)])?;
    let places = [
        Mission::holds("in A", [x.ge(2.0)]),
        Mission::holds("in B", [x.le(-2.0)]),
        Mission::holds("in D", [x.within(0.5, 3.0)]),
    ];
    let solver = &mut BranchAndBound::default();
    let mut words = |text: &str| {
        let mission = Mission::parse(text, places.clone())?;
        let parts = program.mission_conflict(&mission, solver)?;
        Ok::<_, Error>(parts.map(|parts| parts.iter().map(Mission::to_string).collect::<Vec<_>>()))
    };
    assert_eq!(words("F[0,4s] in A & F[0,4s] in B")?, None);
    assert_eq!(words("F[0,1.5s] in A & F[0,1.5s] in B")?.unwrap().len(), 2);
    assert_eq!(words("F[0,2s] in B & F[0,0.5s] in A")?.unwrap(), ["F[0,0.5s] in A"]);
    assert_eq!(words("F[0,4s] in B & G[0,8] in A")?.unwrap(), ["X in A"]);
    // What the run is too short for is a reason by itself, and a window without samples an error.
    assert_eq!(words("F[0,4s] in A & F[5s,6s] in B")?.unwrap(), ["F[5,6s] in B"]);
    assert_eq!(words("F[5s,6s] in B")?.unwrap(), ["F[5,6s] in B"]);
    assert_eq!(words("G[0,6s] !in B & F in A")?.unwrap(), ["G[0,6s] !in B"]);
    assert!(words("F in A & F[0.6s,0.9s] in B").is_err());
    program.goal([x.ge(9.0)])?;
    assert_eq!(program.mission_conflict(&places[0], solver)?.unwrap(), []);
    Ok(())
}

#[test]
fn norms_and_discs() -> Result<(), Error> {
    let mut puck = HybridSystem::new(1.0);
    let [x, y] = [puck.state("x", -9.0, 9.0)?, puck.state("y", -9.0, 9.0)?];
    let [u, w] = [puck.input("u", -1.0, 1.0)?, puck.input("w", -1.0, 1.0)?];
    puck.mode("slide")?.next([x.is(x + u), y.is(y + w)])?;
    let disc = |name: &str, a: f64, b: f64| Mission::holds(name, [norm([x - a, y - b]).le(1.0)]);
    let mission = (disc("one", 3.0, 0.0) | disc("two", 0.0, 4.0)).eventually(0..=3);
    let mut program = puck.program(3)?;
    program.start([x.equals(0.0), y.equals(0.0)])?;
    let margin = program.mission_margin("margin", &mission, 0.0)?;
    program.maximize(margin)?;
    let plan = program.solve(&mut BranchAndBound::default())?;
    assert!((plan.value(margin, 0)? - 1.0).abs() < 1e-4);
    assert!((plan.robustness(&mission)? - 1.0).abs() < 1e-4);
    Ok(())
}

#[test]
fn a_model_without_a_system() -> Result<(), Error> {
    let mut model = Model::new("storage");
    let level = model.continuous_family("level", 6, 0.0, 10.0)?;
    for k in 0..5 {
        model.add(("change", k), (level[k + 1] - level[k]).within(-2.0, 2.0))?;
    }
    model.add("start", level[0].equals(0.0))?;
    let full = Mission::holds_by_sample("full", (0..6).map(|k| [level[k].ge(4.0)]));
    let empty = Mission::holds_by_sample("empty", (0..6).map(|k| [level[k].le(1.0)]));
    let mission = (full & empty.eventually(1..=2)).eventually(0..=5);
    model.add("mission", mission.over(6, 1.0))?;
    model.maximize(level[5])?;
    let solution = BranchAndBound::default().solve(&model)?;
    assert!((solution.objective().expect("there is one") - 3.0).abs() < 1e-6);
    let value = |handle: Variable, _: usize| solution.value(handle).ok();
    assert!(mission.robustness(6, 1.0, value)? >= -1e-6);
    Ok(())
}

#[test]
fn a_scene_with_a_wall_that_may_be_hit() -> Result<(), Box<dyn std::error::Error>> {
    let mut scene = Scene::new(0.2).with_obstacle(Solid::halfspace(
        "wall",
        [1.0],
        0.5,
        Surface::bounce(Restitution::new(0.5)?),
    ));
    let puck = scene.body(Body::new("puck", [0.0..=6.0], 3.0, 1.0).with_start([2.0, 0.0]))?;
    let near = Mission::holds("near the wall", [puck.position(0).le(0.7)]);
    let far = Mission::holds("far", [puck.position(0).ge(3.0)]);
    let mission = near.eventually(0.0..=2.0) & far.eventually(2.0..=3.6);
    let mut program = scene.program(18)?;
    program.require_mission("mission", &mission)?;
    let plan = program.solve(&mut BranchAndBound::default())?;
    assert!(program.system().robustness(&mission, &plan.run)? >= -1e-6);
    Ok(())
}

#[cfg(feature = "serde")]
#[test]
fn a_mission_as_json() -> Result<(), Box<dyn std::error::Error>> {
    let (_, x, _) = cart()?;
    let mission =
        (!Mission::holds("a", [x.within(0.0, 1.0)])).until(0.0..=2.0, Mission::all([])).next();
    let text = serde_json::to_string(&mission)?;
    assert_eq!(serde_json::from_str::<Mission>(&text)?, mission);
    Ok(())
}
