//! What is named, what is background, and what is asked wrongly.

use carom::ErrorKind;
use carom::explain::{ExplainOptions, ExplanationStatus, infeasibility};
use carom::prelude::*;

fn solver() -> BranchAndBound {
    BranchAndBound::default()
}

/// Rows, an indicator and logic in one contradiction, and statements that have no part in it.
fn mixed() -> Model {
    let mut model = Model::new("mixed");
    let x = model.continuous_family("x", 8, 0.0, 20.0).unwrap();
    let z = model.binary_family("z", 2).unwrap();
    for t in 0..7 {
        model.add(("grow", t), (x[t + 1] - x[t]).le(1.0)).unwrap();
        model.add(("roof", t), x[t].le(15.0)).unwrap();
    }
    model.add("start", x[0].le(0.0)).unwrap();
    model.add("high", z[0].on().implies(x[7].ge(9.0))).unwrap();
    model.add("low", z[1].on().implies(x[7].le(3.0))).unwrap();
    model.add("some", (z[0] | z[1]).implies(z[0])).unwrap();
    model.add("second", z[1].on()).unwrap();
    model
}

#[test]
fn rows_indicators_and_logic_are_named_together() {
    let why = infeasibility(&mixed(), &ExplainOptions::default(), &mut solver()).unwrap();
    assert!(why.is_irreducible());
    let names: Vec<&str> = why.groups().iter().map(|group| group.name()).collect();
    assert!(
        names == ["high", "low", "some", "second"]
            || names == ["grow", "start", "high", "some", "second"]
    );
    for group in why.groups() {
        assert!(group.without().is_some());
    }

    // Where `low` is not in question either, more than one set can be meant.
    let options = ExplainOptions::default().with_background(["some", "second", "high"]);
    let why = infeasibility(&mixed(), &options, &mut solver()).unwrap();
    assert!(why.is_irreducible());
    let background = why.background().to_vec();
    assert_eq!(background, ["high", "some", "second"]);
    assert!(why.to_string().contains("(background: high, some, second)"));
}

#[test]
fn disjunctions_are_statements_like_others() {
    let mut model = Model::new("doors");
    let x = model.continuous_family("x", 4, 0.0, 20.0).unwrap();
    for t in 0..4 {
        model.add(("door", t), either(x[t].le(2.0)).or(x[t].ge(9.0))).unwrap();
        model.add(("roof", t), x[t].le(15.0)).unwrap();
    }
    model.add("stand", x[2].within(4.0, 5.0)).unwrap();
    let why = infeasibility(&model, &ExplainOptions::default(), &mut solver()).unwrap();
    assert!(why.is_irreducible());
    assert!(why.to_string().contains("door at step 2"), "{why}");
    assert_eq!(why.groups().len(), 2);
}

#[test]
fn families_are_narrowed_to_the_steps_that_matter() {
    let mut model = Model::new("m");
    let x = model.continuous_family("x", 40, 0.0, 20.0).unwrap();
    for t in 0..40 {
        model.add(("cap", t), x[t].le(10.0)).unwrap();
        model.add(("spare", t), x[t].ge(1.0)).unwrap();
    }
    model.add("wish", (x[17] + x[18]).ge(24.0)).unwrap();
    let why = infeasibility(&model, &ExplainOptions::default(), &mut solver()).unwrap();
    assert!(why.is_irreducible());
    assert_eq!(why.groups().len(), 2);
    assert_eq!(why.groups()[0].steps(), [17..=18]);
    assert_eq!(why.groups()[0].family_size(), 40);
    assert!(
        why.to_string().starts_with("these cannot hold together: cap at steps 17 to 18; wish.")
    );

    let options = ExplainOptions::default().with_narrowing(0);
    let why = infeasibility(&model, &options, &mut solver()).unwrap();
    assert_eq!(why.groups()[0].steps(), [0..=39]);
}

/// Many statements without a family, three of which contradict each other.
#[test]
fn a_contradiction_among_many_statements_needs_few_solves() {
    let mut model = Model::new("m");
    let x = model.continuous_family("x", 30, -10.0, 10.0).unwrap();
    for t in 0..30 {
        model.add(format!("limit_{t}").as_str(), (x[t] + 0.5 * x[(t + 7) % 30]).le(8.0)).unwrap();
    }
    // Three rows without a common solution, none of which propagation can use.
    model.add("first", (x[3] + x[4] + x[5]).ge(6.0)).unwrap();
    model.add("second", (x[3] - x[4] + x[5]).le(1.0)).unwrap();
    model.add("third", (x[4] + 0.0 * x[3]).le(2.0)).unwrap();
    let why = infeasibility(&model, &ExplainOptions::default(), &mut solver()).unwrap();
    let names: Vec<&str> = why.groups().iter().map(|group| group.name()).collect();
    assert_eq!(names, ["first", "second", "third"]);
    assert!(why.is_irreducible() && why.solves() <= 12, "{} solves", why.solves());
}

#[test]
fn a_model_with_a_solution_is_an_answer() {
    let mut model = Model::new("open");
    let x = model.continuous("x", 0.0, 1.0).unwrap();
    model.add("row", x.ge(0.5)).unwrap();
    // An objective that only makes sense with all rows plays no role.
    model.maximize(x).unwrap();
    let why = infeasibility(&model, &ExplainOptions::default(), &mut solver()).unwrap();
    assert_eq!(why.status(), ExplanationStatus::Feasible);
    assert!(!why.is_infeasible() && !why.is_irreducible() && why.groups().is_empty());
    assert!(why.point().is_some_and(|point| point.value(x).unwrap() >= 0.5 - 1e-6));
    assert_eq!(
        why.to_string(),
        "`open` has a solution. 1 solve, 0 refutations by propagation alone"
    );
}

#[test]
fn a_contradiction_in_the_background_is_an_answer() {
    let mut model = Model::new("m");
    let x = model.continuous("x", 0.0, 1.0).unwrap();
    model.add("law", x.ge(3.0)).unwrap();
    model.add("wish", x.le(0.5)).unwrap();
    model.set_background("law").unwrap();
    let why = infeasibility(&model, &ExplainOptions::default(), &mut solver()).unwrap();
    assert!(why.is_irreducible() && why.groups().is_empty());
    assert!(why.to_string().starts_with(
        "the background contradicts itself or the bounds of its variables (background: law); the \
             domains that play a part: x."
    ));
}

/// Bounds are never relaxed: what they imply needs no statement.
#[test]
fn domains_are_hard() {
    let mut model = Model::new("m");
    let x = model.continuous("x", 0.0, 1.0).unwrap();
    model.add("limit", x.le(1.0)).unwrap();
    model.add("wish", x.ge(2.0)).unwrap();
    let why = infeasibility(&model, &ExplainOptions::default(), &mut solver()).unwrap();
    let names: Vec<&str> = why.groups().iter().map(|group| group.name()).collect();
    assert_eq!(names, ["wish"]);
}

/// Removing a limit leaves an objective unbounded; the explanation has none.
#[test]
fn objectives_do_not_disturb() {
    let mut model = Model::new("m");
    let x = model.continuous("x", f64::NEG_INFINITY, f64::INFINITY).unwrap();
    model.add("low", x.ge(1.0)).unwrap();
    model.add("high", x.le(0.0)).unwrap();
    model.minimize(x).unwrap();
    let why = infeasibility(&model, &ExplainOptions::default(), &mut solver()).unwrap();
    assert!(why.is_irreducible());
    assert_eq!(why.groups().len(), 2);
}

#[test]
fn families_of_parts_are_selected_by_their_common_beginning() {
    let mut model = Model::new("m");
    let x = model.continuous_family("x", 3, 0.0, 9.0).unwrap();
    for t in 0..2 {
        model.add(("flow_x", t), (x[t + 1] - x[t]).within(0.0, 1.0)).unwrap();
        model.add(("flow_y", t), (x[t + 1] + x[t]).ge(0.0)).unwrap();
    }
    model.add("start", x[0].equals(0.0)).unwrap();
    model.add("goal", x[2].ge(4.0)).unwrap();
    let options = ExplainOptions::default().with_background(["flow"]);
    let why = infeasibility(&model, &options, &mut solver()).unwrap();
    assert_eq!(why.background(), ["flow_x", "flow_y"]);
    let one = ExplainOptions::default().with_background([("flow_x", 1)]);
    let why = infeasibility(&model, &one, &mut solver()).unwrap();
    assert!(why.groups().iter().any(|g| g.name() == "flow_x" && g.steps() == [0..=0]));

    let unknown = ExplainOptions::default().with_background(["flow_x", "fl"]);
    assert_eq!(
        infeasibility(&model, &unknown, &mut solver()).unwrap_err().to_string(),
        "the model has no statement named `fl`"
    );
    assert!(matches!(
        model.set_background("flow").unwrap_err().kind(),
        ErrorKind::UnknownName { .. }
    ));
}

/// Where propagation sees the contradiction, the bounds it needs are named.
#[test]
fn domains_that_play_a_part_are_named() {
    let mut model = Model::new("m");
    let x = model.continuous_family("x", 21, -50.0, 50.0).unwrap();
    let y = model.continuous("y", 0.0, 1.0).unwrap();
    model.fix(x[0], 0.0).unwrap();
    model.fix(x[20], 15.0).unwrap();
    for t in 0..20 {
        model.add(("speed", t), (x[t + 1] - x[t]).le(0.5)).unwrap();
        model.add(("other", t), (y + x[t]).le(100.0)).unwrap();
    }
    let why = infeasibility(&model, &ExplainOptions::default(), &mut solver()).unwrap();
    assert!(why.is_irreducible());
    assert_eq!(
        why.to_string().split(". ").next().unwrap(),
        "these cannot hold together: speed at steps 0 to 19; the domains that play a part: x at \
         steps 0 and 20"
    );
    let domains: Vec<String> = why.domains().iter().map(Name::to_string).collect();
    assert_eq!(domains, ["x[0]", "x[20]"]);
}

/// Two binaries cannot be 3, whole numbers could; and the third could make up for what `x` takes.
#[test]
fn binaries_that_have_to_be_binary_are_named() {
    let mut model = Model::new("m");
    let [a, b, c] = ["a", "b", "c"].map(|name| model.binary(name).unwrap());
    let x = model.continuous("x", 0.0, 9.0).unwrap();
    model.add("many", (a + b + x).ge(3.0)).unwrap();
    model.add("few", (x + c).le(0.5)).unwrap();
    let why = infeasibility(&model, &ExplainOptions::default(), &mut solver()).unwrap();
    assert!(why.is_irreducible());
    let domains: Vec<String> = why.domains().iter().map(Name::to_string).collect();
    assert_eq!(domains, ["a", "b", "c"]);
    let mut model = Model::new("m");
    let [a, b] = ["a", "b"].map(|name| model.binary(name).unwrap());
    model.add("most", (a + 2.0 * b).le(1.5)).unwrap();
    model.add("least", (a + 2.0 * b).ge(2.5)).unwrap();
    let why = infeasibility(&model, &ExplainOptions::default(), &mut solver()).unwrap();
    assert!(why.is_irreducible() && why.domains().is_empty());
}

/// Propagation needs the bounds of `x` and `y` here, the contradiction does not.
#[test]
fn domains_that_play_no_part_are_not_named() {
    let text = |lower: f64, upper: f64, least: f64| {
        let mut model = Model::new("m");
        let x = model.continuous("x", lower, upper).unwrap();
        let y = model.continuous("y", lower, upper).unwrap();
        let n = model.integer("n", 0.0, 9.0).unwrap();
        model.add("few", (x + y).le(0.5)).unwrap();
        model.add("many", (x + y + n).ge(least)).unwrap();
        model.add("none", n.le(0.0)).unwrap();
        let why = infeasibility(&model, &ExplainOptions::default(), &mut solver()).unwrap();
        assert!(why.is_irreducible());
        why.to_string().split(". ").next().unwrap().to_owned()
    };
    let free = "these cannot hold together: few; many; none";
    assert_eq!(text(0.0, 10.0, 2.0), free);
    assert_eq!(text(-1e6, 1e6, 2.0), free);
    assert_eq!(text(f64::NEG_INFINITY, f64::INFINITY, 2.0), free);
    // Without these bounds there are points.
    let mut model = Model::new("m");
    let x = model.continuous_family("x", 3, 0.0, 1.0).unwrap();
    model.add("few", (x[0] + x[1]).le(0.5)).unwrap();
    model.add("many", (x[0] + x[2]).ge(2.0)).unwrap();
    let why = infeasibility(&model, &ExplainOptions::default(), &mut solver()).unwrap();
    let domains: Vec<String> = why.domains().iter().map(Name::to_string).collect();
    assert_eq!(domains, ["x[1]", "x[2]"]);
}

/// A row on a parameter alone narrows nothing: parameters have values, not bounds.
#[test]
fn rows_on_parameters_can_be_asked_about() {
    let mut model = Model::new("m");
    let x = model.continuous("x", 0.0, 10.0).unwrap();
    let wall = model.parameter("wall", 6.0, 0.0, 10.0).unwrap();
    model.add("near", wall.le(7.0)).unwrap();
    model.add("behind", x.ge(wall)).unwrap();
    model.add("low", x.le(3.0)).unwrap();
    let why = infeasibility(&model, &ExplainOptions::default(), &mut solver()).unwrap();
    let names: Vec<&str> = why.groups().iter().map(|group| group.name()).collect();
    assert_eq!(names, ["behind", "low"]);
}
