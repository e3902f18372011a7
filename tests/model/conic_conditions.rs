//! Norms and quadratic rows under conditions and in disjunctions: the lowered model has exactly the
//! points at which the statements hold, by each method; the report, texts and errors are what the
//! documentation says.

use crate::common::config;
use carom::ErrorKind;
use carom::model::{ConicRow, Method, Reformulation, Term, norm};
use carom::prelude::*;
use carom::reformulate::{self, BigMSource};
use carom::solution::{Point, Verification};
use proptest::prelude::*;

const REGRESSIONS: &str = "tests/regressions/conic_conditions.txt";

/// Continuous variables, each between 0 and 4.
const SPACE: usize = 3;

/// Binaries.
const BINARIES: usize = 3;

/// An affine form by its coefficients, the last of which is the constant.
type Form = Vec<i32>;

#[derive(Debug, Clone)]
enum Shape {
    Norm(Vec<Form>, Form),
    Disc(Vec<Form>, i32),
    Convex(Vec<Form>, Form),
    Product(Form, usize, usize),
    Square(Vec<Form>, Form),
}

#[derive(Debug, Clone)]
struct Case {
    /// In each term, rows and shapes.
    terms: Vec<(Vec<Form>, Vec<Shape>)>,
    condition: u8,
}

fn form(low: i32) -> impl Strategy<Value = Form> {
    prop::collection::vec(low..=2, SPACE + 1)
}

fn shape() -> impl Strategy<Value = Shape> {
    let tail = || prop::collection::vec(form(-2), 1..3);
    prop_oneof![
        (tail(), form(-1)).prop_map(|(tail, bound)| Shape::Norm(tail, bound)),
        (tail(), 0..20).prop_map(|(tail, limit)| Shape::Disc(tail, limit)),
        (tail(), form(-2)).prop_map(|(tail, limit)| Shape::Convex(tail, limit)),
        (form(-2), 0..SPACE, 0..SPACE).prop_map(|(entry, a, b)| Shape::Product(entry, a, b)),
        (tail(), form(0)).prop_map(|(tail, head)| Shape::Square(tail, head)),
    ]
}

fn case() -> impl Strategy<Value = Case> {
    let term = (prop::collection::vec(form(-2), 0..2), prop::collection::vec(shape(), 1..3));
    (prop::collection::vec(term, 2..=BINARIES), 0..4_u8)
        .prop_map(|(terms, condition)| Case { terms, condition })
}

fn affine(form: &Form, x: &[Variable]) -> Affine {
    let mut affine = Affine::constant(f64::from(form[SPACE]));
    // The first one is in all of them, so that none is empty.
    x.iter().zip(form).for_each(|(&v, &a)| affine.add_term(f64::from(a), v));
    affine + 0.5 * x[0]
}

fn squares(tail: &[Form], x: &[Variable]) -> carom::model::Quadratic {
    tail.iter().map(|form| affine(form, x).square()).sum()
}

fn row(shape: &Shape, x: &[Variable]) -> ConicRow {
    match shape {
        Shape::Norm(tail, bound) => {
            norm(tail.iter().map(|form| affine(form, x))).le(affine(bound, x))
        }
        Shape::Disc(tail, limit) => squares(tail, x).le(f64::from(*limit)),
        Shape::Convex(tail, limit) => squares(tail, x).le(affine(limit, x)),
        Shape::Product(entry, a, b) if a == b => affine(entry, x).square().le(x[*a].square()),
        Shape::Product(entry, a, b) => affine(entry, x).square().le(x[*a] * x[*b]),
        Shape::Square(tail, head) => squares(tail, x).le(affine(head, x).square()),
    }
}

/// Whether a random row may be refused like that.
fn is_known(error: &Error) -> bool {
    matches!(error.kind(), ErrorKind::UnknownSign { .. } | ErrorKind::EmptyRow { .. })
}

/// The model without a statement.
fn space() -> (Model, Vec<Variable>, Vec<Variable>) {
    let mut model = Model::new("m");
    let x = model.continuous_family("x", SPACE, 0.0, 4.0).unwrap().iter().collect();
    let z = (0..BINARIES).map(|k| model.binary(("z", k)).unwrap()).collect();
    (model, x, z)
}

/// Whether a model holds at a point; `None` if that is a matter of rounding.
fn holds(model: &Model, values: Vec<f64>) -> Option<bool> {
    let point = Point::new(model, values).unwrap();
    if Verification::of(model, &point, 1e-9).holds() {
        return Some(true);
    }
    (!Verification::of(model, &point, 1e-3).holds()).then_some(false)
}

fn points() -> impl Strategy<Value = Vec<(Vec<u8>, u8)>> {
    prop::collection::vec((prop::collection::vec(0..=8_u8, SPACE), 0..8_u8), 24)
}

fn values((x, z): &(Vec<u8>, u8)) -> Vec<f64> {
    let binaries = (0..BINARIES).map(|k| f64::from(z >> k & 1));
    x.iter().map(|&x| f64::from(x) / 2.0).chain(binaries).collect()
}

/// Compares a model with its lowered one, whose further variables `further` tells.
fn compare(
    model: &Model,
    points: &[(Vec<u8>, u8)],
    further: &dyn Fn(&[f64]) -> Vec<f64>,
) -> Result<(), TestCaseError> {
    let lowered = reformulate::lower(model).unwrap();
    let plain = lowered.model();
    for point in points {
        let mut values = values(point);
        let Some(holds) = holds(model, values.clone()) else { continue };
        values.extend(further(&values));
        let at = Point::new(plain, values.clone()).unwrap();
        let check = Verification::of(plain, &at, 1e-6);
        prop_assert_eq!(
            holds,
            check.holds(),
            "{:?}\n{}\n{}{:?}",
            values,
            model,
            plain,
            check.violations()
        );
    }
    Ok(())
}

proptest! {
    #![proptest_config(config(300, REGRESSIONS))]

    #[test]
    fn conditions_are_lowered_to_what_they_say(case in case(), points in points()) {
        for linear_programs in [false, true] {
            let (mut model, x, z) = space();
            let (rows, shapes) = &case.terms[0];
            for (k, form) in rows.iter().enumerate() {
                model.add(("row", k), affine(form, &x).le(0.0)).unwrap();
            }
            for (k, shape) in shapes.iter().enumerate() {
                let condition = match case.condition {
                    0 => z[0].on().into(),
                    1 => z[0].off().into(),
                    2 => z[0] & !z[1],
                    _ => Logic::from(z[0]) | (z[1] & z[2]),
                };
                let row = row(shape, &x);
                match model.add(("c", k), condition.implies(row)) {
                    Ok(_) => {}
                    Err(error) => {
                        prop_assert!(is_known(&error), "{}", error);
                    }
                }
            }
            model.set_reformulation(
                Reformulation::default().with_linear_programs(linear_programs),
            );
            // Binaries of formulas would be further ones.
            let further = reformulate::lower(&model).unwrap().model().variable_count();
            if further == model.variable_count() {
                compare(&model, &points, &|_| Vec::new())?;
            }
        }
    }

    #[test]
    fn disjunctions_are_lowered_to_what_they_say(case in case(), points in points()) {
        for method in Method::ALL {
            let (mut model, x, z) = space();
            let terms = case.terms.iter().map(|(rows, shapes)| {
                let rows: Vec<Row> = rows.iter().map(|form| affine(form, &x).le(1.0)).collect();
                let conic: Vec<ConicRow> = shapes.iter().map(|shape| row(shape, &x)).collect();
                Term::from(rows).and(conic)
            });
            let count = case.terms.len();
            let selectors = z[..count].iter().map(|z| z.on());
            let either = Either::of(terms).selected_by(selectors).by(method);
            if let Err(error) = model.add("either", either) {
                prop_assert!(is_known(&error), "{}", error);
                return Ok(());
            }
            // Each variable that occurs has a copy for each term.
            let copied: Vec<usize> = {
                let lowered = reformulate::lower(&model).unwrap();
                let copies = lowered.model().variable_count() - model.variable_count();
                prop_assert_eq!(copies % count, 0);
                match copies / count {
                    SPACE => (0..SPACE).collect(),
                    0 => Vec::new(),
                    // Which ones occur is not worth the trouble.
                    _ => return Ok(()),
                }
            };
            let further = |values: &[f64]| {
                let of = |j: &usize| {
                    let j = *j;
                    (0..count).map(move |k| (j, k))
                };
                let copy = |(j, k): (usize, usize)| values[j] * values[SPACE + k];
                copied.iter().flat_map(of).map(copy).collect()
            };
            compare(&model, &points, &further)?;
        }
    }
}

/// The largest value of an objective over rows and conic rows; `None` if nothing is feasible.
fn best(term: Option<&(Vec<Form>, Vec<Shape>)>, weights: &Form) -> Option<f64> {
    let (mut model, x, _) = space();
    let (rows, shapes) = term?;
    for (k, form) in rows.iter().enumerate() {
        model.add(("row", k), affine(form, &x).le(1.0)).unwrap();
    }
    for (k, shape) in shapes.iter().enumerate() {
        model.add(("c", k), row(shape, &x)).unwrap();
    }
    model.maximize(affine(weights, &x)).unwrap();
    BranchAndBound::default().solve(&model).unwrap().objective()
}

proptest! {
    #![proptest_config(config(40, REGRESSIONS))]

    #[test]
    fn the_best_term_is_the_optimum_by_each_method(case in case(), weights in form(-2)) {
        let mut known = Vec::new();
        let (mut model, x, z) = space();
        let mut by_indicators = model.clone();
        let terms = case.terms.iter().map(|(rows, shapes)| {
            let rows: Vec<Row> = rows.iter().map(|form| affine(form, &x).le(1.0)).collect();
            Term::from(rows).and(shapes.iter().map(|shape| row(shape, &x)).collect::<Vec<_>>())
        });
        let selectors = z[..case.terms.len()].iter().map(|z| z.on());
        let either = Either::of(terms).selected_by(selectors);
        if let Err(error) = model.add("either", either) {
            prop_assert!(is_known(&error), "{}", error);
            return Ok(());
        }
        model.maximize(affine(&weights, &x)).unwrap();
        by_indicators.add("one", exactly(1, &z[..case.terms.len()])).unwrap();
        for (k, (rows, shapes)) in case.terms.iter().enumerate() {
            known.extend(best(Some(&(rows.clone(), shapes.clone())), &weights));
            for (r, form) in rows.iter().enumerate() {
                let row = affine(form, &x).le(1.0);
                by_indicators.add((format!("row{k}"), r), z[k].on().implies(row)).unwrap();
            }
            for (r, shape) in shapes.iter().enumerate() {
                let row = z[k].on().implies(row(shape, &x));
                by_indicators.add((format!("c{k}"), r), row).unwrap();
            }
        }
        by_indicators.maximize(affine(&weights, &x)).unwrap();
        let expected = known.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let mut models = vec![by_indicators];
        for method in Method::ALL {
            model.set_reformulation(Reformulation::default().with_method(method));
            models.push(model.clone());
        }
        for model in models {
            let found = BranchAndBound::default().solve(&model).unwrap().objective();
            match found {
                None => prop_assert!(known.is_empty(), "{:?} {}", known, model),
                Some(found) => {
                    let close = (found - expected).abs() <= 1e-4 * expected.abs().max(1.0);
                    prop_assert!(close, "{} {}\n{}", found, expected, model);
                }
            }
        }
    }
}

#[test]
fn the_m_of_a_norm_comes_from_the_bounds() {
    let mut model = Model::new("m");
    let x = model.continuous("x", -3.0, 2.0).unwrap();
    let y = model.continuous("y", 0.0, 4.0).unwrap();
    let far = model.binary("far").unwrap();
    model.add("near", far.off().implies(norm([x, y]).le(1.0))).unwrap();
    assert!(model.to_string().contains("  near: far = 0 implies |(x, y)| <= 1\n"), "{model}");
    let lowered = reformulate::lower(&model).unwrap();
    let text = lowered.model().to_string();
    assert!(text.contains("  near: |(x, y)| <= 4 far + 1\n"), "{text}");
    let report = lowered.report();
    assert_eq!(report.to_string(), "near upper: M = 4 from bounds (largest share: x)\n");
    assert_eq!(report.entries()[0].row.as_deref(), Some("near"));
    // A disc is a norm, and so is a product; a paraboloid keeps its unit.
    let mut model = Model::new("m");
    let x = model.continuous("x", 0.0, 3.0).unwrap();
    let y = model.continuous("y", 0.0, 4.0).unwrap();
    let z = model.binary("z").unwrap();
    model.add("disc", z.on().implies((x.square() + y.square()).le(4.0))).unwrap();
    model.add("paraboloid", z.on().implies(x.square().le(y))).unwrap();
    model.add("product", z.on().implies((x * y).ge(1.0))).unwrap();
    let text = reformulate::lower(&model).unwrap().model().to_string();
    assert!(text.contains("  disc: |(x, y)| <= -3 z + 5\n"), "{text}");
    assert!(text.contains("  paraboloid: x^2 - y + 9 z <= 9\n"), "{text}");
    assert!(text.contains("  product: |(2, x - y)| <= "), "{text}");
}

#[test]
fn a_given_m_is_checked() {
    let mut model = Model::new("m");
    let x = model.continuous("x", -3.0, 3.0).unwrap();
    let y = model.continuous("y", -4.0, 4.0).unwrap();
    let z = model.binary("z").unwrap();
    let near = || z.on().implies(norm([x, y]).le(1.0));
    let lower = |statement: Implication<ConicRow>| {
        let mut model = model.clone();
        model.add("near", statement)?;
        reformulate::lower(&model)
    };
    let lowered = lower(near().big_m(6.0)).unwrap();
    assert_eq!(lowered.report().entries()[0].source, BigMSource::Given);
    assert!(lowered.model().to_string().contains("near: |(x, y)| <= -6 z + 7\n"));
    let error = lower(near().big_m(3.5)).unwrap_err();
    assert!(matches!(error.kind(), ErrorKind::UnsafeBigM { .. }), "{error}");
    let lowered = lower(near().big_m(3.5).assume_valid()).unwrap();
    assert_eq!(lowered.report().entries()[0].source, BigMSource::Assumed);
    let error = lower(near().big_m(-1.0)).unwrap_err();
    assert!(matches!(error.kind(), ErrorKind::OutOfRange { .. }), "{error}");
}

#[test]
fn a_missing_bound_is_named_unless_rows_imply_it() {
    let mut model = Model::new("m");
    let x = model.continuous("x", -3.0, 3.0).unwrap();
    let y = model.continuous("y", f64::NEG_INFINITY, f64::INFINITY).unwrap();
    let z = model.binary("z").unwrap();
    model.add("near", z.on().implies(norm([x, y]).le(1.0))).unwrap();
    let error = reformulate::lower(&model).unwrap_err();
    assert!(matches!(error.kind(), ErrorKind::UnboundedIndicator { .. }), "{error}");
    assert!(error.to_string().contains("`near` needs a big-M"), "{error}");
    assert!(error.to_string().contains("`y` has no"), "{error}");
    // A row, or a norm that always holds.
    let mut by_row = model.clone();
    by_row.add("sum", (x + y).within(-1.0, 1.0)).unwrap();
    assert!(reformulate::lower(&by_row).is_ok());
    let mut by_norm = model.clone();
    by_norm.add("always", norm([x, y]).le(9.0)).unwrap();
    let lowered = reformulate::lower(&by_norm).unwrap();
    assert_eq!(lowered.report().entries()[0].source, BigMSource::ImpliedBounds);
    // A norm in either case.
    model.add("far", z.off().implies(norm([x, y]).le(7.0))).unwrap();
    let lowered = reformulate::lower(&model).unwrap();
    assert_eq!(lowered.report().entries()[0].source, BigMSource::ImpliedBounds);
}

#[test]
fn fixed_conditions_need_no_m() {
    let mut model = Model::new("m");
    let x = model.continuous("x", f64::NEG_INFINITY, f64::INFINITY).unwrap();
    let z = model.binary("z").unwrap();
    model.add("near", z.on().implies(norm([x]).le(1.0))).unwrap();
    model.set_bounds(z, 1.0, 1.0).unwrap();
    let lowered = reformulate::lower(&model).unwrap();
    assert_eq!(lowered.report().entries()[0].source, BigMSource::ConditionHolds);
    assert_eq!(lowered.model().conic_constraint_count(), 1);
    model.set_bounds(z, 0.0, 0.0).unwrap();
    let lowered = reformulate::lower(&model).unwrap();
    assert_eq!(lowered.report().entries()[0].source, BigMSource::ConditionFails);
    assert_eq!(lowered.model().conic_constraint_count(), 0);
}

#[test]
fn several_norms_and_a_function_under_a_norm() {
    let mut model = Model::new("m");
    let v = model.continuous_family("v", 4, -2.0, 2.0).unwrap();
    let z = model.binary("z").unwrap();
    let pairs = [norm([v[0], v[1]]).le(1.0), norm([v[2], v[3]]).le(1.0)];
    let added = model.add("slow", z.on().implies_all(pairs)).unwrap();
    assert_eq!(added.len(), 2);
    assert_eq!(model.conic_constraint_by_name("slow_2").unwrap(), added[1]);
}

#[test]
fn a_function_under_a_norm_is_exact() {
    let mut model = Model::new("m");
    let x = model.continuous("x", -2.0, 2.0).unwrap();
    let y = model.continuous("y", -2.0, 2.0).unwrap();
    let a = model.absolute("a", x).unwrap();
    model.minimize(a - 2.0 * y).unwrap();
    let further = |model: &Model| {
        let lowered = reformulate::lower(model).unwrap();
        lowered.model().variable_count() - model.variable_count()
    };
    assert_eq!(further(&model), 0);
    // The norm keeps `a` from being lowered.
    let mut under = model.clone();
    under.add("beside", norm([y]).le(a)).unwrap();
    assert_eq!(further(&under), 1);
    let solution = BranchAndBound::default().solve(&under).unwrap();
    assert!((solution.value(x).unwrap().abs() - 2.0).abs() < 1e-6);
    let z = model.binary("z").unwrap();
    model.add("either", either((y + z).le(0.0)).or(y.square().le(a))).unwrap();
    assert_eq!(further(&model), 1);
}
