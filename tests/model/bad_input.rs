//! Misuse: every error with its text, and nothing changed by it.

use std::error::Error as _;
use std::time::Duration;

use carom::ErrorKind;
use carom::collision_tolerant::{Endpoint, Scenario};
use carom::hybrid::scene::{Body, Scene, SceneError, Solid, Surface};
use carom::hybrid::{Region, Restitution};
use carom::interval::Interval;
use carom::model::{BigM, mps};
use carom::prelude::*;
use carom::reformulate;

const INF: f64 = f64::INFINITY;

/// The text of an error.
fn text<T>(result: Result<T, Error>) -> String {
    match result {
        Ok(_) => panic!("no error"),
        Err(error) => error.to_string(),
    }
}

/// A model with one continuous variable within `[0, 10]` and one binary.
fn small() -> (Model, Variable, Variable) {
    let mut model = Model::new("small");
    let x = model.continuous("x", 0.0, 10.0).unwrap();
    let z = model.binary("z").unwrap();
    (model, x, z)
}

// -- variables --------------------------------------------------------------------------------

#[test]
fn bounds_that_are_not_numbers() {
    let mut model = Model::new("m");
    assert_eq!(
        text(model.continuous("x", f64::NAN, 1.0)),
        "the lower limit of `x` is NaN; give a finite number"
    );
    assert_eq!(
        text(model.continuous("x", 0.0, f64::NAN)),
        "the upper limit of `x` is NaN; give a finite number"
    );
    assert_eq!(
        text(model.integer("x", INF, INF)),
        "the lower limit of `x` is inf; give a finite number"
    );
    assert_eq!(
        text(model.continuous("x", -INF, -INF)),
        "the upper limit of `x` is -inf; give a finite number"
    );
    assert_eq!(model.variable_count(), 0);
    // Infinite in the harmless direction is a missing bound, and so is 1e20.
    let x = model.continuous("x", -1e20, INF).unwrap();
    assert_eq!(model.variable_ref(x).unwrap().bounds().lower, -INF);
}

#[test]
fn crossed_bounds() {
    let (mut model, x, z) = small();
    let crossed = "bounds of `y` are crossed: 2 > 1; swap or relax them";
    assert_eq!(text(model.continuous("y", 2.0, 1.0)), crossed);
    assert_eq!(text(model.integer("y", 2.0, 1.0)), crossed);
    assert_eq!(text(model.continuous_family("y", 3, 2.0, 1.0)), crossed.replace("`y`", "`y[0]`"));
    assert_eq!(
        text(model.set_bounds(x, 5.0, 4.5)),
        "bounds of `x` are crossed: 5 > 4.5; swap or relax them"
    );
    assert_eq!(text(model.fix(x, f64::NAN)), "the lower limit of `x` is NaN; give a finite number");
    assert_eq!(
        text(model.set_bounds(z, 0.0, 2.0)),
        "a bound of the binary `z` is 2; it must be within [0, 1]"
    );
    assert_eq!(model.variable_ref(x).unwrap().bounds().upper, 10.0);
    assert_eq!(model.variable_count(), 2);
}

#[test]
fn names_of_variables() {
    let (mut model, ..) = small();
    let taken = "the name `x` is already taken by another variable; choose another one";
    assert_eq!(text(model.binary("x")), taken);
    assert_eq!(text(model.continuous("x", 0.0, 1.0)), taken);
    model.binary("y[1]").unwrap();
    assert_eq!(
        text(model.binary_family("y", 2)),
        "the name `y[1]` is already taken by another variable; choose another one"
    );
    for name in
        ["", " ", "two  blanks", " first", "last ", "tab\t", "line\n", "bell\u{7}", "no\u{a0}break"]
    {
        assert_eq!(
            text(model.binary(name)),
            format!(
                "`{name}` cannot be a name: it must be one or several words with single blanks between them"
            )
        );
    }
    // The same rule as in systems.
    let air = model.continuous("air temperature", 0.0, 30.0).unwrap();
    model.add("too hot", air.le(25.0)).unwrap();
    assert_eq!(model.variable_by_name("air temperature"), Ok(air));
    assert_eq!(text(model.variable_by_name("nobody")), "the model has no variable named `nobody`");
}

// -- statements -------------------------------------------------------------------------------

/// Limits that count as infinite once the constant is on their side are infinite, as in files.
#[test]
fn limits_that_a_constant_makes_infinite() {
    let (mut model, x, z) = small();
    let huge = 9e19;
    let shown = "the upper limit of `r` is -180000000000000000000; give a finite number";
    assert_eq!(text(model.add("r", (x + huge).within(-INF, -huge))), shown);
    assert_eq!(text(model.add("r", z.on().implies((x + huge).within(-INF, -huge)))), shown);
    let row = (x - huge).within(0.0, huge);
    model.add("row", row.clone()).unwrap();
    model.add("on", z.on().implies(row.clone())).unwrap();
    model.add("one", either(row).or(x.le(1.0))).unwrap();
    let found = model.to_string();
    assert_eq!(found.matches("x >= 90000000000000000000").count(), 3, "{found}");
}

#[test]
fn coefficients_and_limits_that_are_not_finite() {
    let (mut model, x, z) = small();
    for value in [f64::NAN, INF, -INF, 1e20] {
        assert_eq!(
            text(model.add("r", (value * x).le(1.0))),
            format!("a coefficient of `r` is {value}; give a finite number")
        );
    }
    assert_eq!(
        text(model.add("r", (x + INF).le(1.0))),
        "the constant of `r` is inf; give a finite number"
    );
    assert_eq!(
        text(model.add("r", x.within(f64::NAN, 1.0))),
        "the lower limit of `r` is NaN; give a finite number"
    );
    assert_eq!(
        text(model.add("r", z.on().implies(x.within(0.0, -INF)))),
        "the upper limit of `r` is -inf; give a finite number"
    );
    assert_eq!(
        text(model.add("r", x.within(2.0, 1.0))),
        "bounds of `r` are crossed: 2 > 1; swap or relax them"
    );
    assert_eq!(model.constraint_count() + model.indicator_count(), 0);
}

#[test]
fn rows_that_say_nothing() {
    let (mut model, x, z) = small();
    let empty = "statement `r` has no variable left (all coefficients are zero); drop it, or check \
                 the expression it was built from";
    assert_eq!(text(model.add("r", norm([x - x]).le(1.0))), empty);
    let is_false = "statement `r` has no variable left, and its constant -1 is not within 0 and inf; \
                    check the expression it was built from";
    assert_eq!(text(model.add("r", Affine::constant(1.0).ge(2.0))), is_false);
    assert_eq!(text(model.add("r", z.on().implies((x - x).ge(1.0)))), is_false);
    let unlimited = "statement `r` has no finite limit, so it says nothing; give it one or drop it";
    assert_eq!(text(model.add("r", x.within(-INF, INF))), unlimited);
    assert_eq!(text(model.add("r", x.within(-1e20, 1e30))), unlimited);
    let row = model.add("r", x.le(3.0)).unwrap();
    assert_eq!(text(model.set_limits(row, -INF, INF)), unlimited);
    assert_eq!(
        text(model.set_limits(row, 1.0, 0.0)),
        "bounds of `r` are crossed: 1 > 0; swap or relax them"
    );
}

#[test]
fn names_of_statements() {
    let (mut model, x, z) = small();
    model.add("r", x.le(3.0)).unwrap();
    let taken = "the name `r` is already taken by another statement; choose another one";
    assert_eq!(text(model.add("r", x.le(3.0))), taken);
    assert_eq!(text(model.add("r", z.on().implies(x.le(3.0)))), taken);
    assert_eq!(
        text(model.add("", x.le(3.0))),
        "`` cannot be a name: it must be one or several words with single blanks between them"
    );
    assert_eq!(text(model.constraint_by_name("q")), "the model has no linear row named `q`");
    assert_eq!(text(model.indicator_by_name("r")), "the model has no indicator named `r`");
}

#[test]
fn conditions_that_are_not_binary() {
    let (mut model, x, _) = small();
    let k = model.integer("k", 0.0, 1.0).unwrap();
    for (condition, name) in [(x.on(), "x"), (k.off(), "k")] {
        assert_eq!(
            text(model.add("r", condition.implies(x.le(3.0)))),
            format!(
                "`{name}` is not binary; conditions and logic, as in `r`, take binary variables \
                 only"
            )
        );
    }
}

#[test]
fn big_ms_out_of_range() {
    let (mut model, x, z) = small();
    for value in [-1.0, f64::NAN, INF] {
        let statement = z.on().implies(x.le(3.0)).big_m(value);
        assert_eq!(
            text(model.add("r", statement.clone())),
            format!("the big-M of `r` is {value}; it must be finite and not negative")
        );
        assert!(model.add("r", statement.assume_valid()).is_err());
    }
}

#[test]
fn handles_of_another_model() {
    let (mut model, x, z) = small();
    let mut other = Model::new("other");
    other.continuous("unused", 0.0, 1.0).unwrap();
    let y = other.binary("y").unwrap();
    let theirs = other.add("theirs", y.le(1.0)).unwrap();
    let switch = other.add("switch", y.on().implies(y.le(1.0))).unwrap();
    let foreign = |kind: &str, index: usize, place: &str| {
        format!(
            "{kind} number {index} used in `{place}` belongs to another model or system; use a handle \
             only with the one that created it (or a clone of it), and take handles of a system at a \
             sample with `at`"
        )
    };
    assert_eq!(text(model.add("r", (x + y).le(1.0))), foreign("variable", 1, "r"));
    assert_eq!(text(model.add("r", z.on().implies(y.le(1.0)))), foreign("variable", 1, "r"));
    assert_eq!(text(model.add("r", y.on().implies(x.le(1.0)))), foreign("variable", 1, "r"));
    assert_eq!(text(model.set_bounds(y, 0.0, 1.0)), foreign("variable", 1, "set_bounds"));
    assert_eq!(text(model.fix(y, 0.0)), foreign("variable", 1, "set_bounds"));
    assert_eq!(text(model.variable_ref(y)), foreign("variable", 1, "a look-up"));
    assert_eq!(text(model.range(&(x + y))), foreign("variable", 1, "a look-up"));
    assert_eq!(text(model.minimize(x + y)), foreign("variable", 1, "objective"));
    assert_eq!(text(model.minimize(y.square())), foreign("variable", 1, "objective"));
    assert_eq!(text(model.set_limits(theirs, 0.0, 1.0)), foreign("constraint", 0, "set_limits"));
    assert_eq!(
        text(model.set_indicator_limits(switch, 0.0, 1.0)),
        foreign("indicator", 0, "set_indicator_limits")
    );

    model.minimize(x).unwrap();
    let solution = BranchAndBound::default().solve(&model).unwrap();
    assert_eq!(text(solution.value(y)), foreign("variable", 1, "a solution"));
    assert_eq!(text(solution.value(x + y)), foreign("variable", 1, "a solution"));

    // A clone takes the handles of its original, as far as both know them.
    let mut copy = model.clone();
    copy.fix(x, 1.0).unwrap();
    let later = copy.continuous("later", 0.0, 1.0).unwrap();
    assert_eq!(text(model.fix(later, 0.0)), foreign("variable", 2, "set_bounds"));
}

// -- objective --------------------------------------------------------------------------------

#[test]
fn objectives_that_are_not_convex() {
    let (mut model, x, z) = small();
    model.minimize(3.0 * x).unwrap();
    let bent = |sense: &str, curvature: &str, name: &str| {
        format!(
            "the objective is not convex: in the {sense} direction its quadratic part has \
             curvature {curvature} along the direction `{name}` 1; only convex costs to minimise \
             (concave ones to maximise) have a proof of optimality here; write squares"
        )
    };
    assert_eq!(text(model.minimize(-1.0 * x.square())), bent("minimize", "-2.000e0", "x"));
    assert_eq!(text(model.maximize(x.square())), bent("maximize", "-2.000e0", "x"));
    let y = model.continuous("y", 0.0, 1.0).unwrap();
    let product = text(model.minimize(x * y));
    assert!(product.starts_with("the objective is not convex"), "{product}");
    assert!(product.contains("curvature -1.000e0"), "{product}");
    // The objective before is still there.
    assert_eq!(model.to_string().lines().next(), Some("minimize 3 x"));
    // A product that completes a square is convex.
    model.minimize(x.square() + z.square() + 2.0 * x * z).unwrap();
}

#[test]
fn objectives_that_are_not_finite() {
    let (mut model, x, _) = small();
    assert_eq!(
        text(model.minimize(f64::NAN * x)),
        "a coefficient of `objective` is NaN; give a finite number"
    );
    assert_eq!(
        text(model.minimize(x + INF)),
        "the constant of `objective` is inf; give a finite number"
    );
    let mut square = Quadratic::zero();
    square.add_product(INF, x, x);
    assert_eq!(
        text(model.minimize(square)),
        "a quadratic coefficient of `objective` is inf; give a finite number"
    );
}

// -- lowering and solving ---------------------------------------------------------------------

#[test]
fn an_unbounded_variable_under_an_indicator() {
    let (mut model, x, z) = small();
    let free = model.continuous("free", -INF, 4.0).unwrap();
    model.add("r", z.on().implies((x + free).ge(1.0))).unwrap();
    let expected = "indicator `r` needs a big-M for its lower side, but `free` has no lower bound; \
                    give `free` a finite one";
    assert_eq!(text(reformulate::lower(&model)), expected);
    assert_eq!(text(BranchAndBound::default().solve(&model)), expected);
    // The other side alone needs only the bound that is there.
    let (mut model, x, z) = small();
    let free = model.continuous("free", -INF, 4.0).unwrap();
    model.add("r", z.on().implies((x + free).le(1.0))).unwrap();
    assert!(reformulate::lower(&model).is_ok());
}

#[test]
fn a_big_m_that_the_bounds_do_not_prove() {
    let (mut model, x, z) = small();
    let short = z.on().implies(x.le(3.0)).big_m(5.0);
    model.add("r", short.clone()).unwrap();
    assert_eq!(
        text(BranchAndBound::default().solve(&model)),
        "the big-M 5 given for the upper side of indicator `r` is too small: the bounds require \
         at least \
         7; raise it, tighten the bounds of `x`, or mark it `assume_valid`"
    );
    model.set_bounds(x, 0.0, 8.0).unwrap();
    assert!(reformulate::lower(&model).is_ok());
    // On trust, anything goes.
    model.add("trusted", short.assume_valid()).unwrap();
    assert_eq!(
        model.indicators().last().map(|indicator| indicator.big_m()),
        Some(BigM::Assumed(5.0))
    );
}

#[test]
fn options_out_of_range() {
    let (mut model, x, _) = small();
    model.minimize(x).unwrap();
    let solve = |options: Options| text(BranchAndBound::new(options).solve(&model));
    let defaults = Options::default;
    assert_eq!(
        solve(defaults().with_threads(0)),
        "option `threads` is 0; it must be within [1, 256]"
    );
    assert_eq!(
        solve(defaults().with_relative_gap(f64::NAN)),
        "option `relative_gap` is NaN; it must be finite and not negative"
    );
    assert_eq!(
        solve(defaults().with_absolute_gap(-1.0)),
        "option `absolute_gap` is -1; it must be finite and not negative"
    );
    let mut options = defaults();
    options.feasibility = 0.5;
    assert_eq!(
        solve(options),
        "option `feasibility` is 0.5; it must be within [0.000000001, 0.001]"
    );
}

#[test]
fn values_where_there_is_no_point() {
    let (mut model, x, z) = small();
    model.add("low", x.le(3.0)).unwrap();
    model.add("high", x.ge(4.0)).unwrap();
    let mut solver = BranchAndBound::default();
    let solution = solver.solve(&model).unwrap();
    assert!(solution.is_infeasible());
    assert_eq!(
        text(solution.value(z)),
        "there is no value to read: the solve ended without a point (`infeasible`)"
    );
    // No time at all is a limit, not an error.
    solver.options_mut().time_limit = Some(Duration::ZERO);
    assert!(solver.solve(&model).is_ok());
}

#[test]
fn an_m_that_counts_as_infinite_is_a_missing_bound() {
    let mut model = Model::new("m");
    let x = model.continuous("x", 0.0, 9e19).unwrap();
    let z = model.binary("z").unwrap();
    model.add("w", z.on().implies((100.0 * x).le(1.0))).unwrap();
    let error = reformulate::lower(&model).unwrap_err();
    assert!(
        matches!(error.kind(), ErrorKind::UnboundedIndicator { variable, .. } if variable == "x")
    );
}

/// The binary of an indicator may be in its row: coefficient and big-M add up there.
#[test]
fn a_coefficient_that_counts_as_infinite_with_its_big_m_is_refused() {
    let mut model = Model::new("m");
    let z = model.binary("z").unwrap();
    model.add("w", z.on().implies((9.9e19 * z).within(-INF, -9.9e19))).unwrap();
    assert_eq!(
        reformulate::lower(&model).unwrap_err().to_string(),
        "a coefficient with its big-M of `w` is 198000000000000000000; give a finite number"
    );
}

/// Bounds that a function cannot reach make a model infeasible, not a bound missing.
#[test]
fn bounds_beyond_the_range_are_infeasible() {
    for (lower, upper) in [(3.5, f64::INFINITY), (f64::NEG_INFINITY, -0.5)] {
        let mut model = Model::new("m");
        let x = model.continuous("x", -3.0, 2.0).unwrap();
        let z = model.binary("z").unwrap();
        let far = model.absolute("far", x).unwrap();
        model.set_bounds(far, lower, upper).unwrap();
        model.add("if", z.on().implies((far + x).within(-1.0, 1.0))).unwrap();
        assert!(BranchAndBound::default().solve(&model).unwrap().is_infeasible());
    }
}

// -- kinds and sources ------------------------------------------------------------------------

/// What a program that plans and solves returns from its `main`.
fn plans(scenario: &Scenario) -> Result<(), Error> {
    scenario.check()?;
    // It starts below the floor.
    let ball = Body::new("ball", [Interval::new(-2.0, 2.0)], 9.0, 9.0)
        .with_start(Region::point([-1.0, 0.0]));
    let floor = Surface::bounce(Restitution::new(0.5)?);
    let scene =
        Scene::new(1.0).with_body(ball).with_obstacle(Solid::halfspace("floor", [1.0], 0.0, floor));
    scene.program(1)?;
    Ok(())
}

#[test]
fn errors_of_planners_are_kinds() {
    let scenario = Scenario::paper();
    let inside = plans(&scenario.clone().with_start(Endpoint::at_rest(-0.5))).unwrap_err();
    let ErrorKind::Scene(own) = inside.kind() else { panic!("{inside}") };
    assert!(matches!(own, SceneError::Inside { end: "starts", .. }), "{own:?}");
    assert_eq!(own.to_string(), inside.to_string());
    // No text twice.
    assert!(inside.source().is_none());
    assert_eq!(format!("{inside:#}"), inside.to_string());

    let below = plans(&scenario).unwrap_err();
    let ErrorKind::Scene(own) = below.kind() else { panic!("{below}") };
    assert!(matches!(own, SceneError::Inside { end: "starts", .. }), "{below}");
}

#[test]
fn numbers_in_files_keep_the_error_of_reading_them() {
    let text = "NAME m\nROWS\n N cost\nCOLUMNS\n x cost 1.2.3\nENDATA\n";
    let error = mps::read(text).unwrap_err();
    assert!(matches!(error.kind(), ErrorKind::Parse { line: 5, column: 9, .. }), "{error}");
    assert_eq!(error.to_string(), "line 5, column 9: `1.2.3` is not a number");
    assert!(error.source().unwrap().is::<std::num::ParseFloatError>());
    assert_eq!(format!("{error:#}"), format!("{error}: invalid float literal"));
}

#[test]
fn errors_are_small_and_go_between_threads() {
    fn travels<T: Send + Sync + 'static>() {}
    travels::<Error>();
    assert_eq!(size_of::<Error>(), size_of::<usize>());
}
