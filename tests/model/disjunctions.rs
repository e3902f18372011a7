//! Disjunctions: by every method they have exactly the points of their terms, nested ones as
//! well; optima agree with the enumeration of all choices; what a solution selects is checked by
//! its meaning; the table of methods shows what each costs.

use crate::common::case::{Case, Column, Line, Square};
use crate::common::config;
use crate::common::enumeration::optimum;
use crate::common::quadratic_program::Minimum;
use carom::model::{Method, Reformulation, Term};
use carom::prelude::*;
use carom::reformulate::{self, BigMSource};
use carom::solution::{Point, ViolationKind};
use proptest::prelude::*;
use proptest::sample::select;

const INF: f64 = f64::INFINITY;

/// A term as data: rows `lower <= a'x <= upper` over three columns, and what is inside.
#[derive(Debug, Clone)]
struct Way {
    rows: Vec<([i32; 3], i32, Option<i32>)>,
    inner: Vec<Vec<Way>>,
}

impl Way {
    fn term(&self, x: &[Variable]) -> Term {
        let rows = self.rows.iter().map(|(a, start, width)| {
            let sum: Affine = a.iter().zip(x).map(|(&a, &v)| f64::from(a) * v).sum();
            let start = 0.5 * f64::from(*start);
            match width {
                Some(width) => sum.within(start, start + 0.5 * f64::from(*width)),
                None => sum.within(f64::NEG_INFINITY, start),
            }
        });
        let term = Term::from(rows.collect::<Vec<Row>>());
        self.inner.iter().fold(term, |term, ways| term.and_either(disjunction(ways, x)))
    }

    fn lines(&self) -> Vec<Line> {
        let line = |(a, start, width): &([i32; 3], i32, Option<i32>)| {
            let start = 0.5 * f64::from(*start);
            let (lower, upper) = match width {
                Some(width) => (start, start + 0.5 * f64::from(*width)),
                None => (f64::NEG_INFINITY, start),
            };
            Line { coefficients: a.map(f64::from).to_vec(), lower, upper, scale: 1.0 }
        };
        self.rows.iter().map(line).collect()
    }

    /// The rows of every complete choice in which this way is taken.
    fn choices(&self) -> Vec<Vec<Line>> {
        let mut all = vec![self.lines()];
        for ways in &self.inner {
            let inner: Vec<Vec<Line>> = ways.iter().flat_map(Way::choices).collect();
            let pairs = all.iter().flat_map(|a| inner.iter().map(move |b| [&a[..], b].concat()));
            all = pairs.collect();
        }
        all
    }
}

fn disjunction(ways: &[Way], x: &[Variable]) -> Either {
    Either::of(ways.iter().map(|way| way.term(x)))
}

fn row() -> impl Strategy<Value = ([i32; 3], i32, Option<i32>)> {
    let a = prop::array::uniform3(select(vec![0, 0, 1, -1, 1, -1, 2, -2, 3]));
    let row = (a, -6..=6_i32, prop::option::weighted(0.6, 0..=4_i32));
    row.prop_filter("a row needs a variable", |(a, ..)| a.iter().any(|&a| a != 0))
}

fn way() -> impl Strategy<Value = Way> {
    let leaf = prop::collection::vec(row(), 0..=2).prop_map(|rows| Way { rows, inner: vec![] });
    leaf.prop_recursive(2, 8, 2, |inner| {
        let inside = prop::collection::vec(inner, 1..=3);
        (prop::collection::vec(row(), 0..=2), prop::collection::vec(inside, 0..=1))
            .prop_map(|(rows, inner)| Way { rows, inner })
    })
}

/// A cost: a direction, and possibly the squared distance from a point.
fn cost() -> impl Strategy<Value = (Vec<f64>, Option<[i32; 3]>)> {
    let direction = prop::collection::vec((-3..=3_i32).prop_map(f64::from), 3);
    (direction, prop::option::of(prop::array::uniform3(-6..=6_i32)))
}

fn columns() -> [Column; 3] {
    let column = |kind, lower, upper| Column { kind, lower, upper };
    [
        column(VariableKind::Continuous, -3.0, 4.0),
        column(VariableKind::Continuous, 0.0, 2.5),
        column(VariableKind::Integer, -1.0, 2.0),
    ]
}

fn case(lines: Vec<Line>, cost: &(Vec<f64>, Option<[i32; 3]>)) -> Case {
    let square = |center: [i32; 3]| {
        (0..3).map(move |j| {
            let mut coefficients = vec![0.0; 3];
            coefficients[j] = 1.0;
            Square { weight: 1.0, coefficients, constant: -0.5 * f64::from(center[j]) }
        })
    };
    Case {
        columns: columns().to_vec(),
        lines,
        switches: Vec::new(),
        squares: cost.1.into_iter().flat_map(square).collect(),
        linear: cost.0.clone(),
        constant: 0.0,
        maximize: false,
    }
}

proptest! {
    #![proptest_config(config(40, "tests/regressions/disjunctions.txt"))]

    /// Support directions and nearest points over random unions, flat and nested, by every
    /// method, with and without linear programs.
    #[test]
    fn every_method_has_the_optimum_of_the_best_choice(
        ways in prop::collection::vec(way(), 1..=3),
        common_row in prop::option::weighted(0.4, row()),
        cost in cost(),
    ) {
        let common = Way { rows: common_row.into_iter().collect(), inner: vec![] };
        let mut best = INF;
        for choice in ways.iter().flat_map(Way::choices) {
            let lines = [common.lines(), choice].concat();
            if let Minimum::Attained { value, .. } = optimum(&case(lines, &cost)) {
                best = best.min(value);
            }
        }
        let (mut model, x) = case(common.lines(), &cost).build();
        let chosen = model.add("way", disjunction(&ways, &x)).unwrap();
        for method in Method::ALL {
            for programs in [false, true] {
                let reformulation =
                    Reformulation::default().with_method(method).with_linear_programs(programs);
                model.set_reformulation(reformulation);
                let solution = BranchAndBound::default().solve(&model).unwrap();
                if best == INF {
                    prop_assert!(solution.is_infeasible(), "{method:?}: {solution:?}");
                    continue;
                }
                prop_assert!(solution.is_optimal(), "{method:?}: {solution:?}");
                let found = solution.objective().unwrap();
                let error = (found - best).abs() / best.abs().max(1.0);
                prop_assert!(error < 1e-5, "{method:?}: {found} instead of {best}");
                let point = solution.point().unwrap();
                prop_assert!(point.selected(&chosen).unwrap().is_some());
            }
        }
        // No relaxation is weaker than the one before it, where all start from the same bounds.
        model.set_reformulation(Reformulation::default());
        let table = reformulate::compare_methods(&model, &mut BranchAndBound::default()).unwrap();
        let bounds: Vec<f64> = table.entries().iter().map(|entry| entry.root_bound).collect();
        for pair in bounds.windows(2) {
            prop_assert!(not_above(pair[0], pair[1]), "{table}");
        }
        prop_assert!(not_above(bounds[2], best), "{table} {best}");
    }
}

/// Relaxations with nearly parallel rows are solved to a few digits less than whole answers.
fn not_above(a: f64, b: f64) -> bool {
    a <= b || a - b <= 1e-4 * b.abs().max(1.0)
}

fn boxes(method: Method) -> (Model, Variable, Variable, carom::model::Selected) {
    let mut model = Model::new("boxes");
    let x = model.continuous("x", 0.0, 10.0).unwrap();
    let y = model.continuous("y", 0.0, 10.0).unwrap();
    let ways = either([x.le(2.0), y.le(1.0)]).or([x.ge(7.0), y.ge(6.0)]).or(y.within(3.0, 4.0));
    let chosen = model.add(("box", 3), ways.by(method)).unwrap();
    (model, x, y, chosen)
}

#[test]
fn the_text_form_names_selectors_and_rows() {
    let (model, ..) = boxes(Method::Hull);
    let text = model.to_string();
    let line = "  box[3]: (box_is1[3] = 1: x <= 2, y <= 1) or (box_is2[3] = 1: x >= 7, y >= 6) or \
                (box_is3[3] = 1: 3 <= y <= 4)\n";
    assert!(text.contains(line), "{text}");
}

#[test]
fn sizes_are_those_of_the_formulas() {
    let (model, ..) = boxes(Method::BigM);
    let mut solver = BranchAndBound::default();
    let table = reformulate::compare_methods(&model, &mut solver).unwrap();
    let sizes: Vec<_> = table.entries().iter().map(|e| (e.method, e.rows, e.columns)).collect();
    // One row selects; six sides; in the hull two rows a copy for the bounds, and a sum each.
    assert_eq!(
        sizes,
        [(Method::BigM, 7, 5), (Method::MultiM, 7, 5), (Method::Hull, 1 + 2 + 12 + 6, 5 + 6)]
    );
    let heading = "method     rows  columns  non-zeros  root bound  facets  with facets\n";
    assert!(table.to_string().starts_with(heading), "{table}");
}

#[test]
fn multi_ms_come_from_the_other_terms() {
    let (model, ..) = boxes(Method::MultiM);
    let lowered = reformulate::lower(&model).unwrap();
    let entry = lowered.report().entries().iter().find(|e| e.indicator == "box_1_row2[3]").unwrap();
    assert_eq!(entry.source, BigMSource::LinearProgram);
    // y <= 1 is missed by 9 in the second term and by 3 in the third.
    let row = lowered
        .model()
        .constraints()
        .find(|row| Some(row.name().to_string()) == entry.row)
        .unwrap();
    let mut ms: Vec<f64> = row.terms().iter().skip(1).map(|(_, a)| (a * 1e3).round()).collect();
    ms.sort_by(f64::total_cmp);
    assert_eq!(ms, [-9000.0, -3000.0]);
}

#[test]
fn selectors_may_be_given_and_used_in_logic() {
    let mut model = Model::new("m");
    let x = model.continuous("x", 0.0, 10.0).unwrap();
    let right = model.binary("right").unwrap();
    let lamp = model.binary("lamp").unwrap();
    let ways = either(x.le(2.0)).or(x.ge(6.0)).selected_by([right.off(), right.on()]);
    model.add("side", ways).unwrap();
    model.add("lit", right.on().implies(lamp)).unwrap();
    model.minimize((x - 5.0).square() + 3.0 * lamp).unwrap();
    let solution = BranchAndBound::default().solve(&model).unwrap();
    assert!((solution.objective().unwrap() - 4.0).abs() < 1e-6);
    assert_eq!(solution.value(right).unwrap(), 1.0);
    assert_eq!(model.variable_count(), 3);
}

#[test]
fn a_point_is_judged_by_the_rows_of_the_selected_term() {
    let (model, ..) = boxes(Method::BigM);
    let check = |values: [f64; 5]| {
        let point = Point::new(&model, values.to_vec()).unwrap();
        Verification::of(&model, &point, 1e-6)
    };
    assert!(check([1.0, 1.0, 1.0, 0.0, 0.0]).holds());
    // Another term holds, but it is not the selected one.
    let wrong = check([1.0, 1.0, 0.0, 1.0, 0.0]);
    assert!(wrong.violations().iter().all(|v| v.kind == ViolationKind::Disjunction));
    assert_eq!(wrong.violations().iter().map(|v| v.amount).fold(0.0, f64::max), 6.0);
    // None selected, and two.
    assert!(!check([1.0, 1.0, 0.0, 0.0, 0.0]).holds());
    assert!(!check([1.0, 1.0, 1.0, 0.0, 1.0]).holds());
}

#[test]
fn bad_disjunctions_are_refused_by_name_and_leave_nothing_behind() {
    let mut model = Model::new("m");
    let x = model.continuous("x", 0.0, INF).unwrap();
    let n = model.integer("n", 0.0, 3.0).unwrap();
    let before = model.to_string();
    let none: [Row; 0] = [];
    let cases: Vec<(Either, &str)> = vec![
        (Either::of(none), "the number of terms of `bad` is 0; it must be at least 1"),
        (
            either(x.le(1.0)).or(x.ge(2.0)).selected_by([n.on()]),
            "the number of selectors of `bad` is 1; it must be 2, one for each term",
        ),
        (
            either(x.le(1.0)).or(x.ge(2.0)).selected_by([n.on(), n.off()]),
            "`n` is not binary; conditions and logic, as in `bad_1`, take binary variables only",
        ),
        (
            either(x.le(1.0)).or(x.ge(f64::NAN)),
            "the constant of `bad_2` is NaN; give a finite number",
        ),
    ];
    for (bad, message) in cases {
        assert_eq!(model.add("bad", bad).unwrap_err().to_string(), message);
        assert_eq!(model.to_string(), before);
    }
    let deep = (0..100_000).fold(either(x.le(1.0)), |inner, _| either(inner));
    let message = model.add("bad", deep).unwrap_err().to_string();
    assert!(message.starts_with("the number of levels of `bad` is"), "{message}");
    assert_eq!(model.to_string(), before);

    model.add("side", either(x.le(1.0)).or(x.ge(2.0))).unwrap();
    for method in Method::ALL {
        model.set_reformulation(Reformulation::default().with_method(method));
        let message = reformulate::lower(&model).unwrap_err().to_string();
        assert!(message.contains("`x` has no upper bound"), "{method:?}: {message}");
    }
}
