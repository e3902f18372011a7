//! Norms and quadratic rows as statements: text, look-up, checks, files of `serde`, explanations,
//! and solves.

use carom::ErrorKind;
use carom::explain::{self, ExplainOptions};
use carom::model::Method;
use carom::prelude::*;
use carom::reformulate;
use carom::solution::{Point, ViolationKind};

/// The text of an error.
fn text<T>(result: Result<T, Error>) -> String {
    match result {
        Ok(_) => panic!("no error"),
        Err(error) => error.to_string(),
    }
}

fn plane() -> (Model, Variable, Variable) {
    let mut model = Model::new("plane");
    let x = model.continuous("x", -5.0, 5.0).unwrap();
    let y = model.continuous("y", -5.0, 5.0).unwrap();
    (model, x, y)
}

#[test]
fn rows_read_as_they_are_written() {
    let (mut model, x, y) = plane();
    let z = model.binary("z").unwrap();
    let speed = model.add("speed", norm([x - 1.0, 2.0 * y]).le(3.0 - x)).unwrap();
    model.add("disc", (x.square() + y.square()).le(16.0)).unwrap();
    model.add("far", z.off().implies(norm([x, y]).le(2.0))).unwrap();
    model.add("either", carom::model::either(x.le(-1.0)).or(norm([x, y]).le(1.0))).unwrap();
    let length = model.norm("length", [x, y]).unwrap();
    model.minimize(length).unwrap();
    assert_eq!(
        model.to_string(),
        "minimize length\nsubject to\n  \
         speed: |(x - 1, 2 y)| <= -x + 3\n  \
         disc: x^2 + y^2 <= 16\n  \
         far: z = 0 implies |(x, y)| <= 2\n  \
         length: |(x, y)| <= length\n  \
         either: (either_first = 1: x <= -1) or (either_first = 0: |(x, y)| <= 1)\n\
         where\n  -5 <= x <= 5\n  -5 <= y <= 5\n  z binary\n  either_first binary\n  length >= 0\n"
    );
    assert_eq!(model.conic_constraint_by_name("speed").unwrap(), speed);
    assert!(matches!(
        model.conic_constraint_by_name("either").unwrap_err().kind(),
        ErrorKind::UnknownName { .. }
    ));
    assert_eq!(model.conic_constraint_count(), 4);
}

#[test]
fn what_is_no_cone_is_refused_with_the_way_out() {
    let (mut model, x, y) = plane();
    assert_eq!(
        text(model.add("out", norm([x, y]).ge(1.0))),
        "the row `out` says that a norm is at least something, which is not convex; write a disjunction of \
         sides, such as `either(x.ge(r)).or(x.le(-r)).or(y.ge(r)).or(y.le(-r))`"
    );
    assert_eq!(
        text(model.add("on", norm([x, y]).equals(1.0))),
        "the row `on` says that a norm is equal to something, which is not convex; write `le`, which holds \
         with equality where the objective or other rows press on it"
    );
    assert_eq!(
        text(model.add("on", x.square().equals(1.0))),
        "the row `on` is an equation of a quadratic expression, which is not convex; write `le`, which holds \
         with equality where the objective or other rows press on it"
    );
    assert_eq!(
        text(model.add("ring", (x.square() + y.square()).within(1.0, 4.0))),
        "the row `ring` gives a quadratic expression two limits, which is not convex; add `le` and the \
         other side, each as a row"
    );
    assert_eq!(
        text(model.add("out", (x.square() + y.square()).ge(1.0))),
        "the quadratic row `out` is not convex: its left side minus its right side has curvature -2.000e0 \
         along the direction `x` 1; write convex expressions on the smaller side, a square or a product of \
         expressions that are at least 0 on the larger one, or a disjunction of rows (`either`)"
    );
    assert_eq!(
        text(model.add("between", y.square().le(x.square()))),
        "the quadratic row `between` is a cone only where `x` cannot be negative, and the bounds of its \
         variables do not show that; give them bounds, or make it equal to a variable with the lower bound 0"
    );
    let none: [Variable; 0] = [];
    assert!(matches!(
        model.add("none", norm(none).le(x)).unwrap_err().kind(),
        ErrorKind::EmptyRow { .. }
    ));
    assert!(matches!(model.norm("none", none).unwrap_err().kind(), ErrorKind::EmptyRow { .. }));
    assert!(model.variable_by_name("none").is_err());
    assert!(matches!(
        model.add("nan", norm([f64::NAN * x]).le(1.0)).unwrap_err().kind(),
        ErrorKind::NotFinite { .. }
    ));
    assert!(matches!(
        model.add("inf", x.square().le(f64::INFINITY)).unwrap_err().kind(),
        ErrorKind::NotFinite { .. }
    ));
    let foreign = Model::new("other").continuous("a", 0.0, 1.0).unwrap();
    assert!(matches!(
        model.add("foreign", norm([x, foreign]).le(1.0)).unwrap_err().kind(),
        ErrorKind::ForeignHandle { .. }
    ));
    assert!(matches!(
        model.add("foreign", x.square().le(foreign)).unwrap_err().kind(),
        ErrorKind::ForeignHandle { .. }
    ));
    assert_eq!(model.conic_constraint_count(), 0);
    model.add("row", norm([x, y]).le(1.0)).unwrap();
    assert!(matches!(
        model.add("row", norm([x, y]).le(1.0)).unwrap_err().kind(),
        ErrorKind::DuplicateName { .. }
    ));
}

#[test]
fn conditions_and_disjunctions_are_solved() {
    for method in Method::ALL {
        let (mut model, x, y) = plane();
        let z = model.binary("z").unwrap();
        model.add("near", z.on().implies(norm([x, y]).le(1.0))).unwrap();
        let islands = norm([x - 3.0, y - 3.0]).le(1.0);
        model
            .add("land", either(islands).or((x.square() + (y + 1.0).square()).le(0.25)).by(method))
            .unwrap();
        model.maximize(x + y + 5.0 * z).unwrap();
        let solution = BranchAndBound::default().solve(&model).unwrap();
        // z = 1: in the second disc, both within the unit disc; 5 + (0.5 sqrt 2 - 1).
        // z = 0: 6 + sqrt 2.
        let best = (5.0 - 1.0 + 0.5_f64.sqrt()).max(6.0 + 2.0_f64.sqrt());
        assert!((solution.objective().unwrap() - best).abs() < 1e-5, "{method:?} {solution:?}");
        model.maximize(x + y + 9.0 * z).unwrap();
        let solution = BranchAndBound::default().solve(&model).unwrap();
        let best = 9.0 - 1.0 + 0.5_f64.sqrt();
        assert!((solution.objective().unwrap() - best).abs() < 1e-5, "{method:?} {solution:?}");
    }
    let (mut model, x, y) = plane();
    model
        .add("land", either(norm([x - 3.0, 1.0 * y]).le(1.0)).or(norm([x + 3.0, 1.0 * y]).le(1.0)))
        .unwrap();
    model.minimize((x - 0.5).square() + y).unwrap();
    let table = reformulate::compare_methods(&model, &mut BranchAndBound::default()).unwrap();
    let bounds: Vec<f64> = table.entries().iter().map(|entry| entry.root_bound).collect();
    assert!(bounds[0] <= bounds[1] + 1e-6 && bounds[1] <= bounds[2] + 1e-6, "{bounds:?}");
}

#[test]
fn violations_are_in_the_unit_of_the_row() {
    let (mut model, x, y) = plane();
    let z = model.binary("z").unwrap();
    model.add("speed", norm([x, y]).le(1.0)).unwrap();
    model.add("disc", (x.square() + y.square()).le(1.0)).unwrap();
    model.add("far", z.on().implies(norm([x, y]).le(2.0))).unwrap();
    let check = |values: [f64; 3]| {
        let point = Point::new(&model, values.to_vec()).unwrap();
        carom::solution::Verification::of(&model, &point, 1e-6)
    };
    assert!(check([0.6, 0.8, 0.0]).holds());
    let bad = check([3.0, 4.0, 0.0]);
    let amounts: Vec<_> = bad.violations().iter().map(|v| (v.name.as_str(), v.amount)).collect();
    assert_eq!(amounts, [("speed", 4.0), ("disc", 24.0)]);
    assert!(bad.violations().iter().all(|v| v.kind == ViolationKind::Cone));
    assert_eq!(bad.violations()[0].to_string(), "the cone `speed` by 4");
    assert_eq!(bad.checked().cones, 3);
    assert_eq!(check([3.0, 4.0, 1.0]).violations().len(), 3);
}

#[test]
fn a_norm_in_a_contradiction_is_explained() {
    let (mut model, x, y) = plane();
    model.add("speed", norm([x, y]).le(1.0)).unwrap();
    model.add("goal", (x + y).ge(2.0)).unwrap();
    model.add("road", y.le(4.0)).unwrap();
    let mut solver = BranchAndBound::default();
    let why = explain::infeasibility(&model, &ExplainOptions::default(), &mut solver).unwrap();
    let names: Vec<_> = why.groups().iter().map(|group| group.name()).collect();
    assert_eq!(names, ["goal", "speed"]);
    assert!(why.is_irreducible());
    // In the background, the norm is not questioned.
    model.set_background("speed").unwrap();
    let why = explain::infeasibility(&model, &ExplainOptions::default(), &mut solver).unwrap();
    let names: Vec<_> = why.groups().iter().map(|group| group.name()).collect();
    assert_eq!(names, ["goal"]);
}

#[test]
fn parameters_may_stand_in_affine_parts() {
    let (mut model, x, y) = plane();
    let radius = model.parameter("radius", 1.0, 0.5, 4.0).unwrap();
    let center = model.parameter("center", 0.0, -1.0, 1.0).unwrap();
    model.add("disc", norm([x - center, y.into()]).le(radius)).unwrap();
    model.add("ball", (x.square() + y.square()).le(radius.square())).unwrap();
    model.maximize(x + y).unwrap();
    let mut solver = BranchAndBound::default();
    for (r, c) in [(1.0, 0.0), (2.0, 0.5), (0.5, -1.0)] {
        model.set_parameter(radius, r).unwrap();
        model.set_parameter(center, c).unwrap();
        let solution = solver.solve(&model).unwrap();
        let mut fixed = Model::new("fixed");
        let u = fixed.continuous("x", -5.0, 5.0).unwrap();
        let v = fixed.continuous("y", -5.0, 5.0).unwrap();
        fixed.add("disc", norm([u - c, v.into()]).le(r)).unwrap();
        fixed.add("ball", norm([u, v]).le(r)).unwrap();
        fixed.maximize(u + v).unwrap();
        let expected = solver.solve(&fixed).unwrap().objective().unwrap();
        assert!((solution.objective().unwrap() - expected).abs() < 1e-5, "{r} {c}");
    }
}

#[test]
fn a_norm_gives_in_its_unit() {
    use carom::explain::{ElasticOptions, elastic_relaxation};
    let (mut model, x, y) = plane();
    let z = model.binary("z").unwrap();
    model.add("goal", x.ge(4.0)).unwrap();
    model.add("sure", z.equals(1.0)).unwrap();
    model.add("speed", z.on().implies(norm([x, y]).le(1.0))).unwrap();
    let options = ElasticOptions::default().with_weight("goal", 2.0).with_background(["sure"]);
    let mut solver = BranchAndBound::default();
    let relaxed = elastic_relaxation(&model, &options, &mut solver).unwrap();
    assert!(relaxed.is_optimal());
    assert_eq!(relaxed.stretches().len(), 1);
    assert_eq!(relaxed.to_string(), "raise `speed` by 3");
    let (mut model, x, y) = plane();
    model.add("goal", x.ge(3.0)).unwrap();
    model.add("disc", (x.square() + y.square()).le(4.0)).unwrap();
    let options = ElasticOptions::default().with_weight("goal", 20.0);
    let relaxed = elastic_relaxation(&model, &options, &mut solver).unwrap();
    assert_eq!(relaxed.to_string(), "raise `disc` by 5");
}

/// A model with parameters in every affine part: as variables of a model, or by their values.
fn with_parameters(values: Option<[f64; 3]>) -> (Model, Vec<Variable>) {
    let (mut model, x, y) = plane();
    let z = model.binary("z").unwrap();
    let mut parameters = Vec::new();
    let [center, radius, slope] = match values {
        Some(values) => values.map(Affine::constant),
        None => ["center", "radius", "slope"].map(|name| {
            let parameter = model.parameter(name, 1.0, 0.5, 3.0).unwrap();
            parameters.push(parameter);
            parameter.into()
        }),
    };
    let h = model.continuous("h", 0.0, 9.0).unwrap();
    model.add("disc", norm([x - &center, y + &center]).le(&radius)).unwrap();
    model.add("ball", (x.square() + (y - &slope).square()).le(16.0 + 3.0 * &radius)).unwrap();
    model.add("below", (y + &slope).square().le(&slope * h)).unwrap();
    model.add("calm", z.off().implies(norm([x, y]).le(&center + 0.1))).unwrap();
    let left = norm([x + &radius, 1.0 * y]).le(1.0 + &slope);
    model.add("or", either(left).or((x - &slope).square().le(&center - y))).unwrap();
    model.maximize(x - 0.5 * y - z - 0.1 * h).unwrap();
    (model, parameters)
}

#[test]
fn prepared_solves_are_solves_from_nothing() {
    for method in Method::ALL {
        let (mut model, parameters) = with_parameters(None);
        let reformulation = carom::model::Reformulation::default().with_method(method);
        model.set_reformulation(reformulation);
        let mut solver = BranchAndBound::default();
        let mut prepared = solver.prepare(&model).unwrap();
        for k in 0..12 {
            let value = |s: usize| 0.5 + 2.5 * ((k * s % 7) as f64) / 6.0;
            let values = [value(1), value(3), value(5)];
            let given: Vec<_> = parameters.iter().copied().zip(values).collect();
            let found = prepared.solve(&given, &mut Control::default()).unwrap();
            let (mut fixed, _) = with_parameters(Some(values));
            fixed.set_reformulation(reformulation);
            let expected = BranchAndBound::default().solve(&fixed).unwrap();
            assert_eq!(found.termination(), expected.termination(), "{values:?}");
            let (found, expected) = (found.objective(), expected.objective());
            assert_eq!(found.is_some(), expected.is_some(), "{values:?}");
            if let (Some(found), Some(expected)) = (found, expected) {
                assert!((found - expected).abs() < 1e-4, "{values:?} {found} {expected}");
            }
        }
    }
}
