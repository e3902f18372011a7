//! What is written to JSON and read back is the same: models with infinite bounds, options,
//! solutions, plans. Handles stay valid, and a damaged file is an error, never a broken model.

use crate::common::config;
use carom::ErrorKind;
use carom::collision_tolerant::{Objective, Plan, Scenario};
use carom::model::{PiecewiseAffine, VariableKind};
use carom::prelude::*;
use carom::solver::{MipStart, PoolMode, RelaxationMethod};
use proptest::prelude::*;

fn copy<T: serde::Serialize + serde::de::DeserializeOwned>(value: &T) -> T {
    let text = serde_json::to_string(value).expect("everything can be written");
    serde_json::from_str(&text).expect("what was written can be read")
}

/// A model with an infinite bound, one-sided rows, an indicator and a quadratic objective.
fn sample() -> (Model, Variable, Variable) {
    let mut model = Model::new("sample");
    let x = model.continuous(("x", 3), 0.0, f64::INFINITY).unwrap();
    let z = model.binary("z").unwrap();
    let y = model.continuous("y", -5.0, 5.0).unwrap();
    model.add("sum", (x + y).ge(1.5)).unwrap();
    model.add("switch", z.on().implies(y.within(-1.0, 0.5)).big_m(20.0)).unwrap();
    model.add("choose", z.ge(1.0)).unwrap();
    model.minimize((x - 0.25).square() + 0.5 * y + 3.0).unwrap();
    (model, x, y)
}

#[test]
fn models_survive_with_their_handles() {
    let (model, x, y) = sample();
    let mut again: Model = copy(&model);
    assert_eq!(again.to_string(), model.to_string());
    assert_eq!(again.variable_by_name("x[3]"), Ok(x));
    let solve = |model: &Model| BranchAndBound::default().solve(model).unwrap();
    let (before, after) = (solve(&model), solve(&again));
    assert!(before.is_optimal() && after.is_optimal());
    for v in [x, y] {
        assert_eq!(before.value(v), after.value(v));
    }
    // The names are known as well: a second `y` is refused.
    assert!(matches!(
        again.continuous("y", 0.0, 1.0).unwrap_err().kind(),
        ErrorKind::DuplicateName { .. }
    ));
}

/// Logic, compound conditions and functions are stored as what they are.
#[test]
fn statements_of_every_kind_survive() {
    let mut model = Model::new("kinds");
    let v = model.binary_family("v", 4).unwrap();
    let n = model.integer("n", 0.0, 3.0).unwrap();
    let x = model.continuous("x", -2.0, 2.0).unwrap();
    let a = model.absolute("a", x - 1.0).unwrap();
    let top = model.maximum("top", [a + x, Affine::constant(0.5)]).unwrap();
    let law = PiecewiseAffine::new([(-2.0, 1.0), (0.0, 0.0), (2.0, 3.0)]).unwrap();
    let f = model.piecewise("f", x, &law).unwrap();
    let p = model.product("p", n, x).unwrap();
    let low = model.minimum("low", [f, p]).unwrap();
    model.add("logic", !(v[0] & !v[1]) | at_most(1, &v).iff(v[2].xor(v[3]))).unwrap();
    model.add("early", (v[0] | v[2]).implies(top.le(1.5))).unwrap();
    model.add(("near", 2), v[3].on().reify(x.within(0.0, 1.0), 0.25)).unwrap();
    model.minimize(top - low).unwrap();
    let again: Model = copy(&model);
    assert_eq!(again.to_string(), model.to_string());
    let lowered = |model: &Model| carom::reformulate::lower(model).unwrap().model().to_string();
    assert_eq!(lowered(&again), lowered(&model));

    let text = serde_json::to_string(&model).unwrap();
    let error = |from: &str, to: &str| {
        assert!(text.contains(from), "{from} is not in {text}");
        serde_json::from_str::<Model>(&text.replacen(from, to, 1)).unwrap_err().to_string()
    };
    let points = error("[[-2.0,1.0],[0.0,0.0]", "[[-2.0,1.0],[-3.0,0.0]");
    assert!(points.contains("the x of breakpoint 1 is -3"), "{points}");
    // A function of itself, and a second one for the same variable.
    let result = format!("\"result\":{{\"index\":{}", a.index());
    let later = error(&result, &format!("\"result\":{{\"index\":{}", x.index()));
    assert!(later.contains("variable number"), "{later}");
    let twice = error(&result, &format!("\"result\":{{\"index\":{}", top.index()));
    assert!(twice.contains("variable number"), "{twice}");
}

#[test]
fn solutions_survive_with_and_without_a_point() {
    let (model, x, _) = sample();
    let solution = BranchAndBound::default().solve(&model).unwrap();
    let again: Solution = copy(&solution);
    assert_eq!(again.value(x), solution.value(x));
    assert_eq!(again.bound(), solution.bound());
    assert_eq!(again.verification(), solution.verification());
    assert_eq!(again.statistics(), solution.statistics());

    let mut model = Model::new("none");
    let x = model.continuous("x", 0.0, 1.0).unwrap();
    model.add("r", x.ge(2.0)).unwrap();
    let solution = BranchAndBound::default().solve(&model).unwrap();
    assert!(solution.is_infeasible());
    let again: Solution = copy(&solution);
    assert_eq!(again.termination(), Termination::Infeasible);
    assert_eq!(again.bound(), f64::INFINITY);
}

#[test]
fn options_survive() {
    let options = Options::default().with_relative_gap(1e-4).with_threads(2).with_node_limit(7);
    assert_eq!(copy(&options), options);
    let options = Options::precise()
        .with_pool(3, PoolMode::Best)
        .with_pool_gap(0.25)
        .with_memory_limit(1 << 20)
        .with_relaxation(RelaxationMethod::Clarabel)
        .with_leaves(true);
    assert_eq!(copy(&options), options);
    // Fields that a file does not have are at their defaults.
    let some: Options = serde_json::from_str(r#"{"threads": 2}"#).unwrap();
    assert_eq!(some, Options::default().with_threads(2));
}

/// What a solve leaves for the next one, infinite bounds included.
#[test]
fn pools_leaves_and_starts_survive() {
    let mut model = Model::new("m");
    let n = model.integer("n", 0.0, 9.0).unwrap();
    let m = model.integer("m", 0.0, 9.0).unwrap();
    model.add("r", (2.0 * n + 3.0 * m).ge(7.5)).unwrap();
    model.minimize(3.0 * n + 4.0 * m).unwrap();
    let options = Options::default().with_pool(3, PoolMode::Best).with_leaves(true);
    let solution = BranchAndBound::new(options).solve(&model).unwrap();
    assert!(solution.pool().len() == 3 && !solution.leaves().is_empty());
    let again: Solution = copy(&solution);
    assert_eq!(again.pool(), solution.pool());
    assert_eq!(again.leaves(), solution.leaves());
    let start = MipStart::of(&solution, [n, m]);
    assert_eq!(copy(&start), start);
    let mut control = Control::default().with_start(&start);
    let next = BranchAndBound::default().solve_with(&model, &mut control).unwrap();
    assert!(next.start_report().is_some());
    assert_eq!(copy(&next).start_report(), next.start_report());
}

#[test]
fn plans_survive() {
    let scenario = Scenario::paper().with_time_step(0.1);
    let plan = scenario.plan(30, Objective::Feasibility, &mut BranchAndBound::default());
    let plan = plan.expect("3 s are enough");
    let again: Plan = copy(&plan);
    assert_eq!(again.trajectory, plan.trajectory);
    assert_eq!(again.certificate, plan.certificate);
}

#[test]
fn damaged_models_are_errors() {
    let (model, ..) = sample();
    let text = serde_json::to_string(&model).unwrap();
    let read = |text: &str| serde_json::from_str::<Model>(text).map(|_| ());
    let error = |from: &str, to: &str| {
        assert!(text.contains(from), "{from} is not in {text}");
        read(&text.replacen(from, to, 1)).unwrap_err().to_string()
    };
    let index = error("{\"index\":2,", "{\"index\":9,");
    assert!(index.contains("variable number 9"), "{index}");
    let crossed = error("-5.0", "7.0");
    assert!(crossed.contains("bounds of `y` are crossed"), "{crossed}");
    let infinity = error("\"inf\"", "\"endless\"");
    assert!(infinity.contains("`endless` is not a number"), "{infinity}");
    let twice = error("\"family\":\"y\"", "\"family\":\"z\"");
    assert!(twice.contains("`z` is already taken"), "{twice}");
}

/// Each of these contradicts what a model promises; none of them becomes a model.
#[test]
fn inconsistent_models_are_errors() {
    let (model, ..) = sample();
    let whole = serde_json::to_value(&model).unwrap();
    let other = serde_json::to_value(sample().0).unwrap();
    let error = |place: &str, value: serde_json::Value| {
        let mut damaged = whole.clone();
        *damaged.pointer_mut(place).unwrap_or_else(|| panic!("no {place} in {whole}")) = value;
        serde_json::from_value::<Model>(damaged).unwrap_err().to_string()
    };
    let foreign = "belongs to another model";
    for (place, value, expected) in [
        // Handles: of another model, and beyond the end.
        ("/constraints/0/row/terms/0/0/tag", other["tag"].clone(), foreign),
        ("/indicators/0/row/terms/0/0/tag", other["tag"].clone(), foreign),
        ("/objective/affine/terms/0/0/tag", other["tag"].clone(), foreign),
        ("/objective/products/0/1/tag", other["tag"].clone(), foreign),
        ("/tag", other["tag"].clone(), foreign),
        ("/objective/products/0/0/index", 7.into(), "variable number 7"),
        (
            "/objective/affine/terms/0/0/index",
            4_294_967_295_u32.into(),
            "variable number 4294967295",
        ),
        // Numbers.
        ("/variables/0/lower", "nan".into(), "the lower limit of `x[3]` is NaN"),
        ("/variables/0/upper", "-inf".into(), "the upper limit of `x[3]` is -inf"),
        ("/variables/1/upper", 2.0.into(), "a bound of the binary `z` is 2"),
        ("/constraints/0/row/lower", "inf".into(), "the lower limit of `sum` is inf"),
        ("/constraints/0/row/lower", "-inf".into(), "`sum`"),
        ("/constraints/0/row/upper", (-9.0).into(), "`sum` are crossed"),
        ("/constraints/0/row/terms/0/1", 1e300.into(), "a coefficient of `sum`"),
        ("/indicators/0/big_m/Given", (-1.0).into(), "the big-M of `switch` is -1"),
        ("/objective/affine/constant", 1e20.into(), "the constant of `objective`"),
        ("/objective/products/0/2", (-1.0).into(), "the objective is not convex"),
        // Names.
        ("/variables/0/name/family", "".into(), "cannot be a name"),
        ("/constraints/0/name/family", "a\tb".into(), "`a\tb` cannot be a name"),
        ("/constraints/1/name/family", "sum".into(), "`sum` is already taken"),
        ("/indicators/0/name/family", "sum".into(), "`sum` is already taken"),
        ("/variables/2/name/family", "x[3]".into(), "`x[3]` is already taken"),
        // Kinds.
        ("/variables/1/kind", "Integer".into(), "`z` is not binary"),
        ("/variables/1/kind", "Complex".into(), "unknown variant"),
        ("/sense", serde_json::Value::Null, "invalid type: null"),
    ] {
        let found = error(place, value);
        assert!(found.contains(expected), "{place}: {found}");
    }
    // Two terms of one variable may be finite and their sum not.
    let mut doubled = whole.clone();
    let terms = doubled.pointer_mut("/constraints/0/row/terms").unwrap();
    terms[0][1] = 9e19.into();
    let first = terms[0].clone();
    terms.as_array_mut().unwrap().push(first);
    let found = serde_json::from_value::<Model>(doubled).unwrap_err().to_string();
    assert!(found.contains("a coefficient of `sum`"), "{found}");
}

proptest! {
    #![proptest_config(config(256, "tests/regressions/serde.txt"))]

    /// Whatever happens to the text: an error, or a model with which everything works.
    #[test]
    fn damage_never_breaks_a_model(
        edits in prop::collection::vec((any::<prop::sample::Index>(), 0..10_u8), 1..4),
    ) {
        let mut text = serde_json::to_string(&sample().0).unwrap();
        for (place, digit) in edits {
            let digits: Vec<usize> = text.match_indices(|c: char| c.is_ascii_digit() || c == '-')
                .map(|(place, _)| place)
                .collect();
            let place = digits[place.index(digits.len())];
            text.replace_range(place..=place, &digit.to_string());
        }
        if let Ok(model) = serde_json::from_str::<Model>(&text) {
            prop_assert_eq!(copy(&model).to_string(), model.to_string());
            for file in [carom::model::mps::write(&model), carom::model::lp::write(&model)] {
                prop_assert!(file.is_ok());
            }
            drop(carom::reformulate::lower(&model));
        }
    }

    /// Numbers come back to the last bit, infinities included.
    #[test]
    fn numbers_survive_to_the_last_bit(
        lower in prop_oneof![Just(f64::NEG_INFINITY), -1e19..0.0_f64],
        upper in prop_oneof![Just(f64::INFINITY), 0.0..1e19_f64],
        coefficient in prop::num::f64::NORMAL.prop_filter("finite", |v| v.abs() < 1e19),
    ) {
        let mut model = Model::new("numbers");
        let x = model.variable("x", VariableKind::Continuous, lower, upper).unwrap();
        model.add("r", (coefficient * x).le(coefficient)).unwrap();
        let again: Model = copy(&model);
        prop_assert_eq!(again.variable_ref(x).unwrap().bounds(), model.variable_ref(x).unwrap().bounds());
        let (a, b) = (again.constraints().next().unwrap(), model.constraints().next().unwrap());
        prop_assert_eq!(a.terms(), b.terms());
        prop_assert_eq!(a.limits(), b.limits());
    }
}

/// Background is part of a model; explanations can be kept.
/// A file may name the variables of a product in any order; they are one product.
#[test]
fn turned_products_are_merged() {
    let mut model = Model::new("turned");
    let x = model.continuous("x", -1.0, 1.0).unwrap();
    let y = model.continuous("y", -1.0, 1.0).unwrap();
    model.minimize(x.square() + y.square() + x * y).unwrap();
    let mut text = serde_json::to_value(&model).unwrap();
    let products = text.pointer_mut("/objective/products").unwrap().as_array_mut().unwrap();
    let mut turned = products.iter().find(|product| product[0] != product[1]).unwrap().clone();
    let (first, second) = (turned[0].clone(), turned[1].clone());
    (turned[0], turned[1]) = (second, first);
    turned[2] = 0.5.into();
    products.push(turned);
    let read: Model = serde_json::from_value(text).unwrap();
    assert!(read.to_string().starts_with("minimize x^2 + 1.5 x y + y^2\n"), "{read}");
}

#[test]
fn explanations_survive() {
    use carom::explain::{ElasticOptions, ExplainOptions, elastic_relaxation, infeasibility};

    let mut model = Model::new("m");
    let x = model.continuous_family("x", 3, 0.0, f64::INFINITY).unwrap();
    for t in 0..2 {
        model.add(("law", t), (x[t + 1] - x[t]).le(1.0)).unwrap();
    }
    model.add("start", x[0].le(0.0)).unwrap();
    model.add("goal", x[2].ge(3.0)).unwrap();
    model.set_background("law").unwrap();
    let again = copy(&model);
    assert!(again.is_background("law[1]") && !again.is_background("goal"));

    let mut solver = BranchAndBound::default();
    let why = infeasibility(&again, &ExplainOptions::default(), &mut solver).unwrap();
    assert_eq!(copy(&why).to_string(), why.to_string());
    assert_eq!(copy(&why).groups(), why.groups());
    let relaxed = elastic_relaxation(&again, &ElasticOptions::default(), &mut solver).unwrap();
    assert_eq!(copy(&relaxed).stretches(), relaxed.stretches());
    assert_eq!(copy(&relaxed).bound(), relaxed.bound());
}

/// Disjunctions, parameters and preferences are part of a model as well.
#[test]
fn disjunctions_and_parameters_survive() {
    use carom::model::{Method, Reformulation, Term};

    let mut model = Model::new("ways");
    let x = model.continuous("x", -4.0, 4.0).unwrap();
    let n = model.integer("n", 0.0, 3.0).unwrap();
    let p = model.parameter("p", 1.0, 0.0, 2.0).unwrap();
    let inner = either(n.le(1.0)).or(n.ge(3.0));
    let ways = either((x - p).le(-1.0)).or(Term::from(x.ge(p)).and_either(inner));
    model.add("way", ways.by(Method::Hull)).unwrap();
    model.set_reformulation(Reformulation::default().with_linear_programs(true));
    model.minimize(x.square() + n).unwrap();
    let mut again: Model = copy(&model);
    assert_eq!(again.to_string(), model.to_string());
    assert_eq!(again.reformulation(), model.reformulation());
    let (a, b) = (again.disjunctions().next().unwrap(), model.disjunctions().next().unwrap());
    assert_eq!((a.id(), a.method()), (b.id(), b.method()));
    assert_eq!(model.disjunction_by_name("way"), Ok(b.id()));
    again.set_parameter(p, 2.0).unwrap();
    assert!(again.set_parameter(p, 2.5).is_err());
    // A lowered form belongs to the model it was made from, not to its copy.
    let lowered = carom::reformulate::lower(&model).unwrap();
    let mut solver = BranchAndBound::default();
    assert!(lowered.solve(&model, &mut solver).is_ok());
    assert!(matches!(
        lowered.solve(&again, &mut solver).unwrap_err().kind(),
        ErrorKind::Stale { .. }
    ));

    let whole = serde_json::to_value(&model).unwrap();
    let error = |place: &str, value: serde_json::Value| {
        let mut damaged = whole.clone();
        *damaged.pointer_mut(place).unwrap_or_else(|| panic!("no {place} in {whole}")) = value;
        serde_json::from_value::<Model>(damaged).unwrap_err().to_string()
    };
    let terms = "/disjunctions/0/terms";
    for (place, value, expected) in [
        ("/variables/2/lower".into(), 1.5.into(), "`p` is not a parameter"),
        ("/variables/2/range/1".into(), 0.5.into(), "the value of the parameter `p` is 1"),
        ("/variables/2/kind".into(), "Integer".into(), "`p` is not a parameter"),
        (format!("{terms}/0/selector/variable/index"), 0.into(), "`x` is not binary"),
        (format!("{terms}/0/selector/variable/index"), 99.into(), "variable number 99"),
        (format!("{terms}/0/rows/0/upper"), "-inf".into(), "the upper limit of `way`"),
        (format!("{terms}/1/nested/0"), serde_json::json!([]), "the number of terms of `way` is 0"),
        (terms.into(), serde_json::json!([]), "the number of terms of `way` is 0"),
    ] {
        let place: String = place;
        let found = error(&place, value);
        assert!(found.contains(expected), "{place}: {found}");
    }
}

#[test]
fn conic_rows_come_back_and_are_checked() {
    let mut model = Model::new("cones");
    let x = model.continuous("x", 0.0, 5.0).unwrap();
    let y = model.continuous("y", 0.0, 5.0).unwrap();
    let z = model.binary("z").unwrap();
    model.add("disc", (x.square() + y.square()).le(9.0)).unwrap();
    model.add("near", z.on().implies(norm([x, y]).le(2.0)).big_m(9.0)).unwrap();
    model.add("below", z.off().implies(x.square().le(x * y))).unwrap();
    model.add("or", either(norm([x]).le(1.0)).or(norm([y]).le(1.0))).unwrap();
    model.norm("length", [x, y]).unwrap();
    let text = serde_json::to_string(&model).unwrap();
    let back: Model = serde_json::from_str(&text).unwrap();
    assert_eq!(back.to_string(), model.to_string());
    let big_m = back.conic_constraints().nth(1).unwrap().big_m();
    assert_eq!(big_m, model.conic_constraints().nth(1).unwrap().big_m());
    // The bounds that make the product a cone.
    let damaged = text.replacen("\"lower\":0.0", "\"lower\":-5.0", 2);
    assert_ne!(damaged, text);
    let error = serde_json::from_str::<Model>(&damaged).unwrap_err().to_string();
    assert!(error.contains("the quadratic row `below` is a cone only where"), "{error}");
    let damaged =
        text.replacen("\"entries\":[", "\"entries\":[{\"terms\":[],\"constant\":null},", 1);
    assert_ne!(damaged, text);
    assert!(serde_json::from_str::<Model>(&damaged).is_err());
    // Rows that are not yet added.
    let row = norm([x, y]).le(2.0);
    let again: ConicRow = serde_json::from_str(&serde_json::to_string(&row).unwrap()).unwrap();
    assert_eq!(again, row);
    let condition = z.on().implies(row);
    let json = serde_json::to_string(&condition).unwrap();
    assert_eq!(serde_json::from_str::<Implication<ConicRow>>(&json).unwrap(), condition);
}
