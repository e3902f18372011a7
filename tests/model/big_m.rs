//! Big-M rows: the lowered rows have exactly the feasible set of the implication they replace, in
//! both values of the condition and at every point of the box; their text, the report and the
//! treatment of a user's M are what the documentation says; and an M that is taken on trust and
//! wrong never lets a point through that violates an implication.
//!
//! Data are small whole numbers and points are halves, so sums are exact and sets can be compared
//! without any tolerance.

use crate::common::config;
use carom::ErrorKind;
use carom::prelude::*;
use carom::reformulate::{self, BigMSource, Side};
use proptest::prelude::*;

const INF: f64 = f64::INFINITY;
const REGRESSIONS: &str = "tests/big_m.proptest-regressions";

/// The text of an error.
fn text<T>(result: Result<T, Error>) -> String {
    match result {
        Ok(_) => panic!("no error"),
        Err(error) => error.to_string(),
    }
}

// -- random indicators ------------------------------------------------------------------------

/// One indicator over a box.
#[derive(Debug, Clone)]
struct Case {
    /// Lower bound, upper bound, coefficient.
    columns: Vec<(i32, i32, i32)>,
    /// Coefficient of the condition in its own row.
    own: i32,
    /// How many columns are created before the condition.
    place: usize,
    on: bool,
    lower: Option<i32>,
    upper: Option<i32>,
}

fn case() -> impl Strategy<Value = Case> {
    let column = (-3..=3, 0..=4, prop_oneof![-4..=-1, 1..=4])
        .prop_map(|(lower, width, coefficient)| (lower, lower + width, coefficient));
    let columns = prop::collection::vec(column, 1..=3);
    let own = prop_oneof![2 => Just(0), 1 => -3..=3];
    (columns, own, 0..=3_usize, any::<bool>(), -8..=8, 0..=6, 0..4).prop_map(
        |(columns, own, place, on, limit, width, sides)| {
            let (lower, upper) = match sides {
                0 => (None, Some(limit)),
                1 => (Some(limit), None),
                2 => (Some(limit), Some(limit + width)),
                _ => (Some(limit), Some(limit)),
            };
            Case { columns, own, place, on, lower, upper }
        },
    )
}

impl Case {
    fn model(&self, adjust: impl Fn(Implication) -> Implication) -> (Model, Vec<Variable>) {
        let mut model = Model::new("m");
        let (mut variables, mut z) = (Vec::new(), None);
        for (j, &(lower, upper, _)) in self.columns.iter().enumerate() {
            if j == self.place {
                z = Some(model.binary("z").unwrap());
            }
            let x = model.continuous(("x", j), f64::from(lower), f64::from(upper)).unwrap();
            variables.push(x);
        }
        let z = z.unwrap_or_else(|| model.binary("z").unwrap());
        let mut sum: Affine =
            self.columns.iter().zip(&variables).map(|(c, x)| f64::from(c.2) * x).sum();
        sum += f64::from(self.own) * z;
        let lower = self.lower.map_or(-INF, f64::from);
        let upper = self.upper.map_or(INF, f64::from);
        let condition = if self.on { z.on() } else { z.off() };
        model.add("i", adjust(condition.implies(sum.within(lower, upper)))).unwrap();
        variables.push(z);
        (model, variables)
    }

    /// All points of the box in steps of a half, corners included.
    fn points(&self) -> Vec<Vec<f64>> {
        let mut points = vec![Vec::new()];
        for &(lower, upper, _) in &self.columns {
            let steps = (2 * lower..=2 * upper).map(|k| 0.5 * f64::from(k));
            points =
                steps.flat_map(|v| points.iter().map(move |p| [&p[..], &[v]].concat())).collect();
        }
        points
    }

    fn activity(&self, x: &[f64], z: f64) -> f64 {
        let sum: f64 = self.columns.iter().zip(x).map(|(c, v)| f64::from(c.2) * v).sum();
        sum + f64::from(self.own) * z
    }

    fn implication_holds(&self, x: &[f64], z: f64) -> bool {
        let activity = self.activity(x, z);
        (z == 1.0) != self.on
            || (self.lower.is_none_or(|l| activity >= f64::from(l))
                && self.upper.is_none_or(|u| activity <= f64::from(u)))
    }

    /// The largest miss of each side over the box where the condition holds, by its points.
    fn needs(&self) -> Vec<(Side, f64)> {
        let z = f64::from(u8::from(self.on));
        let worst = |miss: &dyn Fn(f64) -> f64| {
            let misses = self.points().into_iter().map(|x| miss(self.activity(&x, z)));
            misses.fold(-INF, f64::max)
        };
        let lower = self.lower.map(|l| (Side::Lower, worst(&|a| f64::from(l) - a)));
        let upper = self.upper.map(|u| (Side::Upper, worst(&|a| a - f64::from(u))));
        lower.into_iter().chain(upper).collect()
    }
}

/// Whether a point satisfies all rows of a model, without any tolerance.
fn rows_hold(model: &Model, values: impl Fn(Variable) -> f64) -> bool {
    model.constraints().all(|row| {
        let sum: f64 = row.terms().iter().map(|&(v, a)| a * values(v)).sum();
        row.limits().contains(sum)
    })
}

/// `value` in units of `2^-digits`, exactly.
fn exact(value: f64, digits: i32) -> i128 {
    let scaled = value * 2.0_f64.powi(digits);
    assert!(scaled.fract() == 0.0 && scaled.abs() < 1e38, "{value}");
    scaled as i128
}

/// Compares the lowered rows with the implication on the whole grid.
fn compare(case: &Case, lowered: &Model, variables: &[Variable]) -> Result<(), TestCaseError> {
    let place = |v| variables.iter().position(|&w| w == v).unwrap();
    for z in [0.0, 1.0] {
        for x in case.points() {
            let point = [&x[..], &[z]].concat();
            let rows = rows_hold(lowered, |v| point[place(v)]);
            prop_assert_eq!(rows, case.implication_holds(&x, z), "at {:?}\n{}", point, lowered);
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(config(200, REGRESSIONS))]

    #[test]
    fn rows_say_what_the_implication_says(case in case()) {
        let (model, variables) = case.model(|i| i);
        let lowered = reformulate::lower(&model).unwrap();
        prop_assert_eq!(lowered.model().indicator_count(), 0);
        compare(&case, lowered.model(), &variables)?;
        // Each M is the smallest that will do, and a side that nothing misses has none.
        let entries = lowered.report().entries();
        prop_assert_eq!(entries.len(), case.needs().len());
        let mut rows = 0;
        for (entry, (side, need)) in entries.iter().zip(case.needs()) {
            prop_assert_eq!(entry.side, side);
            prop_assert_eq!(entry.needed, need.max(0.0));
            prop_assert_eq!(entry.value, need.max(0.0));
            let implied = need <= 0.0;
            let source = if implied { BigMSource::Implied } else { BigMSource::Bounds };
            prop_assert_eq!(entry.source, source);
            rows += usize::from(!implied);
        }
        prop_assert_eq!(lowered.model().constraint_count(), rows);
    }

    #[test]
    fn rows_of_a_fixed_condition(case in case(), value in 0..=1) {
        let (mut model, variables) = case.model(|i| i);
        let (value, z) = (f64::from(value), variables[case.columns.len()]);
        model.fix(z, value).unwrap();
        let lowered = reformulate::lower(&model).unwrap();
        let place = |v| variables.iter().position(|&w| w == v).unwrap();
        for x in case.points() {
            let point = [&x[..], &[value]].concat();
            let rows = rows_hold(lowered.model(), |v| point[place(v)]);
            prop_assert_eq!(rows, case.implication_holds(&x, value));
        }
        for entry in lowered.report().entries() {
            prop_assert_eq!(entry.value, 0.0);
        }
    }

    #[test]
    fn a_given_m_is_accepted_exactly_when_it_is_large_enough(case in case(), m in 0..=30) {
        let m = f64::from(m);
        let (model, variables) = case.model(|i| i.big_m(m));
        let needs = case.needs();
        let refused = needs.iter().find(|(_, need)| *need > m);
        match (reformulate::lower(&model), refused) {
            (Ok(lowered), None) => {
                compare(&case, lowered.model(), &variables)?;
                for (entry, (_, need)) in lowered.report().entries().iter().zip(needs) {
                    let implied = need <= 0.0;
                    prop_assert_eq!(entry.value, if implied { 0.0 } else { m });
                    let source = if implied { BigMSource::Implied } else { BigMSource::Given };
                    prop_assert_eq!(entry.source, source);
                }
            }
            (Err(error), Some(&(wanted, need))) => {
                let ErrorKind::UnsafeBigM { side, given, needed, .. } = error.kind() else {
                    return Err(TestCaseError::fail(error.to_string()));
                };
                prop_assert_eq!(*side, if wanted == Side::Lower { "lower" } else { "upper" });
                prop_assert_eq!((*given, *needed), (m, need));
            }
            (result, _) => prop_assert!(false, "M = {}, {:?}: {:?}", m, needs, result.err()),
        }
    }

    #[test]
    fn an_assumed_m_only_ever_cuts_points_off(case in case(), m in 0..=12) {
        let (model, variables) = case.model(|i| i.big_m(f64::from(m)).assume_valid());
        let lowered = reformulate::lower(&model).unwrap();
        let place = |v| variables.iter().position(|&w| w == v).unwrap();
        for z in [0.0, 1.0] {
            for x in case.points() {
                let point = [&x[..], &[z]].concat();
                let rows = rows_hold(lowered.model(), |v| point[place(v)]);
                prop_assert!(!rows || case.implication_holds(&x, z), "{:?}", point);
                let active = (z == 1.0) == case.on;
                prop_assert!(rows || !active || !case.implication_holds(&x, z), "{:?}", point);
            }
        }
    }

    #[test]
    fn ms_follow_the_bounds(case in case(), other in case()) {
        // The same rows over the bounds of another case.
        let mut moved = case.clone();
        for (column, new) in moved.columns.iter_mut().zip(&other.columns) {
            (column.0, column.1) = (new.0, new.1);
        }
        let (mut model, variables) = case.model(|i| i);
        let before = reformulate::lower(&model).unwrap();
        for (&x, &(lower, upper, _)) in variables.iter().zip(&moved.columns) {
            model.set_bounds(x, f64::from(lower), f64::from(upper)).unwrap();
        }
        let lowered = reformulate::lower(&model).unwrap();
        let fresh = reformulate::lower(&moved.model(|i| i).0).unwrap();
        prop_assert_eq!(lowered.model().to_string(), fresh.model().to_string());
        prop_assert_eq!(lowered.report(), fresh.report());
        // And back again; lowering left no trace in the model.
        for (&x, &(lower, upper, _)) in variables.iter().zip(&case.columns) {
            model.set_bounds(x, f64::from(lower), f64::from(upper)).unwrap();
        }
        let again = reformulate::lower(&model).unwrap();
        prop_assert_eq!(again.model().to_string(), before.model().to_string());
    }

    /// Tenths are no floats, so Ms and limits are rounded: the row of a condition that does not
    /// hold still lets every corner of the box pass, by exact arithmetic.
    #[test]
    fn rounding_never_cuts_the_box(case in case(), tenths in prop::collection::vec(1..=99, 3)) {
        let scale = |j: usize| 0.1 * f64::from(tenths[j]);
        let mut model = Model::new("m");
        let z = model.binary("z").unwrap();
        let mut sum = Affine::zero();
        let mut variables = Vec::new();
        for (j, &(lower, upper, a)) in case.columns.iter().enumerate() {
            let (lower, upper) = (0.1 * f64::from(lower), 0.1 * f64::from(upper));
            let x = model.continuous(("x", j), lower, upper).unwrap();
            sum += f64::from(a) * scale(j) * x;
            variables.push(x);
        }
        let limits = (case.lower.map_or(-INF, f64::from), case.upper.map_or(INF, f64::from));
        let condition = if case.on { z.on() } else { z.off() };
        model.add("i", condition.implies(sum.within(0.1 * limits.0, 0.1 * limits.1))).unwrap();
        let lowered = reformulate::lower(&model).unwrap();
        let idle = u8::from(!case.on);
        for row in lowered.model().constraints() {
            for corner in 0..1 << variables.len() {
                let mut activity = 0;
                for &(v, a) in row.terms() {
                    activity += match variables.iter().position(|&x| x == v) {
                        Some(j) => {
                            let bounds = model.variable_ref(v).unwrap().bounds();
                            let high = corner >> j & 1 == 1;
                            exact(a, 56) * exact(if high { bounds.upper } else { bounds.lower }, 56)
                        }
                        None => exact(a, 112) * i128::from(idle),
                    };
                }
                let limits = row.limits();
                let above = limits.lower == -INF || activity >= exact(limits.lower, 112);
                let below = limits.upper == INF || activity <= exact(limits.upper, 112);
                prop_assert!(above && below, "{:?} outside {:?}", activity, limits);
            }
        }
    }
}

// -- text -------------------------------------------------------------------------------------

/// `2 x - y` within limits, implied by `z`; `x` in `[-2, 10]`, `y` in `[0, 3]`.
fn sloped(lower: f64, upper: f64, on: bool) -> Model {
    let mut model = Model::new("m");
    let x = model.continuous("x", -2.0, 10.0).unwrap();
    let y = model.continuous("y", 0.0, 3.0).unwrap();
    let z = model.binary("z").unwrap();
    let condition = if on { z.on() } else { z.off() };
    model.add("hit", condition.implies((2.0 * x - y).within(lower, upper))).unwrap();
    model.minimize(x).unwrap();
    model
}

/// The text of `sloped` around its statements.
fn around(statements: &[&str]) -> String {
    let lines: String = statements.iter().map(|s| format!("  {s}\n")).collect();
    let bounds = "  -2 <= x <= 10\n  0 <= y <= 3\n  z binary\n";
    format!("minimize x\nsubject to\n{lines}where\n{bounds}")
}

#[test]
fn texts_before_and_after() {
    let check = |limits: (f64, f64), on, before: &str, after: &[&str]| {
        let model = sloped(limits.0, limits.1, on);
        assert_eq!(model.to_string(), around(&[before]));
        let lowered = reformulate::lower(&model).unwrap();
        assert_eq!(lowered.model().to_string(), around(after));
    };
    check(
        (-INF, 4.0),
        true,
        "hit: z = 1 implies 2 x - y <= 4",
        &["hit_upper: 2 x - y + 16 z <= 20"],
    );
    check(
        (-INF, 4.0),
        false,
        "hit: z = 0 implies 2 x - y <= 4",
        &["hit_upper: 2 x - y - 16 z <= 4"],
    );
    check((1.0, INF), true, "hit: z = 1 implies 2 x - y >= 1", &["hit_lower: 2 x - y - 8 z >= -7"]);
    check((1.0, INF), false, "hit: z = 0 implies 2 x - y >= 1", &["hit_lower: 2 x - y + 8 z >= 1"]);
    check(
        (1.0, 4.0),
        true,
        "hit: z = 1 implies 1 <= 2 x - y <= 4",
        &["hit_lower: 2 x - y - 8 z >= -7", "hit_upper: 2 x - y + 16 z <= 20"],
    );
    check(
        (1.0, 4.0),
        false,
        "hit: z = 0 implies 1 <= 2 x - y <= 4",
        &["hit_lower: 2 x - y + 8 z >= 1", "hit_upper: 2 x - y - 16 z <= 4"],
    );
    check(
        (5.0, 5.0),
        true,
        "hit: z = 1 implies 2 x - y = 5",
        &["hit_lower: 2 x - y - 12 z >= -7", "hit_upper: 2 x - y + 15 z <= 20"],
    );
    check(
        (5.0, 5.0),
        false,
        "hit: z = 0 implies 2 x - y = 5",
        &["hit_lower: 2 x - y + 12 z >= 5", "hit_upper: 2 x - y - 15 z <= 5"],
    );
}

#[test]
fn an_implied_side_has_no_row() {
    // 2 x - y lies within [-7, 20].
    let lowered = reformulate::lower(&sloped(-7.0, 4.0, true)).unwrap();
    assert_eq!(lowered.model().to_string(), around(&["hit_upper: 2 x - y + 16 z <= 20"]));
    assert_eq!(
        lowered.report().to_string(),
        "hit lower: implied by bounds, no row\n\
         hit upper: M = 16 from bounds (largest share: x)\n"
    );
    let entry = &lowered.report().entries()[0];
    assert_eq!((entry.side, entry.source), (Side::Lower, BigMSource::Implied));
    assert_eq!((entry.value, entry.needed), (0.0, 0.0));

    let lowered = reformulate::lower(&sloped(-9.0, 25.0, false)).unwrap();
    assert_eq!(lowered.model().to_string(), around(&[]));
    assert!(lowered.report().largest().is_none());
}

#[test]
fn a_condition_in_its_own_row() {
    let mut model = Model::new("m");
    let x = model.continuous("x", 0.0, 10.0).unwrap();
    let z = model.binary("z").unwrap();
    model.add("on", z.on().implies((x + 3.0 * z).le(5.0))).unwrap();
    model.add("off", z.off().implies((x + 3.0 * z).le(5.0))).unwrap();
    model.add("never_on", z.on().implies(z.le(0.0))).unwrap();
    model.add("never_off", z.off().implies(z.ge(1.0))).unwrap();
    model.add("idle", z.on().implies(z.ge(1.0))).unwrap();
    let lowered = reformulate::lower(&model).unwrap();
    assert_eq!(
        lowered.model().to_string(),
        "minimize 0\n\
         subject to\n  \
           on_upper: x + 8 z <= 10\n  \
           off_upper: x - 5 z <= 5\n  \
           never_on_upper: z <= 0\n  \
           never_off_lower: z >= 1\n\
         where\n  \
           0 <= x <= 10\n  \
           z binary\n"
    );
    assert_eq!(
        lowered.report().to_string(),
        "on upper: M = 8 from bounds (largest share: x)\n\
         off upper: M = 5 from bounds (largest share: x)\n\
         never_on upper: M = 1 from bounds\n\
         never_off lower: M = 1 from bounds\n\
         idle lower: implied by bounds, no row\n"
    );
    assert!(BranchAndBound::default().solve(&model).unwrap().is_infeasible());
}

#[test]
fn names_of_rows() {
    let mut model = Model::new("m");
    let x = model.continuous("x", 0.0, 10.0).unwrap();
    let z = model.binary_family("z", 2).unwrap();
    model.add("hit_upper", x.le(9.0)).unwrap();
    model.add("hit", z[0].on().implies(x.within(1.0, 2.0))).unwrap();
    model.add(("hit", 1), z[1].on().implies(x.le(3.0))).unwrap();
    let lowered = reformulate::lower(&model).unwrap();
    let names: Vec<String> =
        lowered.model().constraints().map(|row| row.name().to_string()).collect();
    assert_eq!(names, ["hit_upper", "hit_lower", "hit_upper_", "hit_upper[1]"]);
    // The name of the indicator is free again, and handles carry over.
    assert!(lowered.model().indicator_by_name("hit").is_err());
    assert_eq!(lowered.model().variable_ref(z[1]).unwrap().name().to_string(), "z[1]");
}

// -- fixed conditions -------------------------------------------------------------------------

#[test]
fn fixed_conditions_need_no_m() {
    let mut model = Model::new("m");
    let x = model.continuous("x", -INF, INF).unwrap();
    let z = model.binary("z").unwrap();
    model.add("on", z.on().implies((x + 2.0 * z).within(1.0, 4.0))).unwrap();
    model.add("off", z.off().implies(x.equals(7.0))).unwrap();
    let lowered = |model: &Model| {
        let lowered = reformulate::lower(model).unwrap();
        assert!(lowered.report().largest().is_none());
        (lowered.model().to_string(), lowered.report().to_string())
    };

    model.fix(z, 1.0).unwrap();
    let (rows, report) = lowered(&model);
    assert_eq!(
        rows,
        "minimize 0\n\
         subject to\n  \
           on_lower: x >= -1\n  \
           on_upper: x <= 2\n\
         where\n  \
           x free\n  \
           z = 1 binary\n"
    );
    assert_eq!(
        report,
        "on lower: condition fixed, plain row\n\
         on upper: condition fixed, plain row\n\
         off lower: condition fixed, no row\n\
         off upper: condition fixed, no row\n"
    );

    model.fix(z, 0.0).unwrap();
    let (rows, report) = lowered(&model);
    assert_eq!(
        rows,
        "minimize 0\n\
         subject to\n  \
           off_lower: x >= 7\n  \
           off_upper: x <= 7\n\
         where\n  \
           x free\n  \
           z = 0 binary\n"
    );
    assert_eq!(
        report,
        "on lower: condition fixed, no row\n\
         on upper: condition fixed, no row\n\
         off lower: condition fixed, plain row\n\
         off upper: condition fixed, plain row\n"
    );
    let solution = BranchAndBound::default().solve(&model).unwrap();
    assert!((solution.value(x).unwrap() - 7.0).abs() < 1e-6);
}

// -- the report and a user's M ----------------------------------------------------------------

/// `x - 2 y <= 3` implied by `z`, needing M = 11 with `x` and `y` in `[0, 10]` and `[-2, 1]`.
fn with_m(adjust: impl Fn(Implication) -> Implication) -> Model {
    let mut model = Model::new("m");
    let x = model.continuous("x", 0.0, 10.0).unwrap();
    let y = model.continuous("y", -2.0, 1.0).unwrap();
    let z = model.binary("z").unwrap();
    model.add("hit", adjust(z.on().implies((x - 2.0 * y).le(3.0)))).unwrap();
    model
}

#[test]
fn entries_of_the_report() {
    let mut model = with_m(|i| i);
    let [x, y, z] = ["x", "y", "z"].map(|name| model.variable_by_name(name).unwrap());
    model.add("far", z.off().implies((x + 9.0 * y).within(-20.0, 0.0))).unwrap();
    model.add("given", z.on().implies(x.le(5.0)).big_m(7.5)).unwrap();
    model.add("trusted", z.on().implies(y.ge(0.0)).big_m(1.5).assume_valid()).unwrap();
    let lowered = reformulate::lower(&model).unwrap();
    let report = lowered.report();
    assert_eq!(
        report.to_string(),
        "hit upper: M = 11 from bounds (largest share: x)\n\
         far lower: implied by bounds, no row\n\
         far upper: M = 19 from bounds (largest share: y)\n\
         given upper: M = 7.5 given, 5 needed (largest share: x)\n\
         trusted lower: M = 1.5 assumed, not proved (largest share: y)\n"
    );
    let largest = report.largest().unwrap();
    assert_eq!((largest.indicator.as_str(), largest.value), ("far", 19.0));
    assert_eq!(largest.largest.as_deref(), Some("y"));
    let given = &report.entries()[3];
    assert_eq!((given.source, given.value, given.needed), (BigMSource::Given, 7.5, 5.0));
    let assumed: Vec<_> = report.assumed().collect();
    assert_eq!(assumed.len(), 1);
    assert_eq!((assumed[0].indicator.as_str(), assumed[0].side), ("trusted", Side::Lower));
    assert_eq!((assumed[0].value, assumed[0].needed), (1.5, 2.0));
}

#[test]
fn a_users_m() {
    for m in [0.0, 1.0, 10.999] {
        assert_eq!(
            text(reformulate::lower(&with_m(|i| i.big_m(m)))),
            format!(
                "the big-M {m} given for the upper side of indicator `hit` is too small: the \
                 bounds require at least 11; raise it, tighten the bounds of `x`, or mark it \
                 `assume_valid`"
            )
        );
    }
    for m in [11.0, 100.0, 1e6] {
        let lowered = reformulate::lower(&with_m(|i| i.big_m(m))).unwrap();
        let row = format!("hit_upper: x - 2 y + {m} z <= {}\n", 3.0 + m);
        assert!(lowered.model().to_string().contains(&row), "{}", lowered.model());
        let entry = &lowered.report().entries()[0];
        assert_eq!((entry.source, entry.value, entry.needed), (BigMSource::Given, m, 11.0));
        assert!(lowered.report().assumed().next().is_none());
    }
    // Without a value, trust changes nothing.
    let plain = reformulate::lower(&with_m(|i| i.assume_valid())).unwrap();
    assert_eq!(plain.report().entries()[0].source, BigMSource::Bounds);
}

#[test]
fn trust_is_reported_with_the_answer() {
    let mut model = with_m(|i| i.big_m(2.0).assume_valid());
    let [x, z] = ["x", "z"].map(|name| model.variable_by_name(name).unwrap());
    model.maximize(x + 0.5 * z).unwrap();
    let lowered = reformulate::lower(&model).unwrap();
    assert_eq!(lowered.report().assumed().count(), 1);
    let solution = BranchAndBound::default().solve(&model).unwrap();
    assert_eq!(solution.verification().unwrap().assumed(), ["hit"]);
    // The assumed row x - 2 y <= 5 cuts the best plans (x = 10, z = 0, y <= 1) down to x = 7.
    assert!((solution.objective().unwrap() - 7.0).abs() < 1e-5, "{:?}", solution.objective());

    model.minimize(x).unwrap();
    let plain = with_m(|i| i);
    let solution = BranchAndBound::default().solve(&plain).unwrap();
    assert!(solution.verification().unwrap().assumed().is_empty());
}

#[test]
fn a_missing_bound_is_named() {
    let error = |lower: f64, upper: f64, row: fn(Variable, Variable) -> Row| {
        let mut model = Model::new("m");
        let x = model.continuous("x", 0.0, 1.0).unwrap();
        let y = model.continuous("y", lower, upper).unwrap();
        let z = model.binary("z").unwrap();
        model.add("hit", z.on().implies(row(x, y))).unwrap();
        text(reformulate::lower(&model))
    };
    let expected = |side: &str, bound: &str| {
        format!(
            "indicator `hit` needs a big-M for its {side} side, but `y` has no {bound} bound; \
             give `y` a finite one"
        )
    };
    assert_eq!(error(0.0, INF, |x, y| (x + y).le(3.0)), expected("upper", "upper"));
    assert_eq!(error(-INF, 0.0, |x, y| (x - y).le(3.0)), expected("upper", "lower"));
    assert_eq!(error(-INF, 0.0, |x, y| (x + y).ge(3.0)), expected("lower", "lower"));
    assert_eq!(error(0.0, INF, |x, y| (x - y).ge(-3.0)), expected("lower", "upper"));
    assert_eq!(error(-INF, INF, |x, y| (x + y).equals(0.0)), expected("lower", "lower"));
    // A given M proves nothing here either, an assumed one needs no bounds.
    let mut model = Model::new("m");
    let y = model.continuous("y", 0.0, INF).unwrap();
    let z = model.binary("z").unwrap();
    model.add("hit", z.on().implies(y.le(3.0)).big_m(50.0)).unwrap();
    assert_eq!(text(reformulate::lower(&model)), expected("upper", "upper"));
    let mut model = Model::new("m");
    let y = model.continuous("y", 0.0, INF).unwrap();
    let z = model.binary("z").unwrap();
    model.add("hit", z.on().implies(y.le(3.0)).big_m(50.0).assume_valid()).unwrap();
    let lowered = reformulate::lower(&model).unwrap();
    let entry = &lowered.report().entries()[0];
    assert_eq!((entry.value, entry.needed), (50.0, INF));
    assert_eq!(entry.largest.as_deref(), Some("y"));
}

/// An assumed M of 0 once left a term `0 z` in the row; presolve divides by coefficients.
#[test]
fn an_assumed_m_of_zero_leaves_a_plain_row() {
    let lowered = reformulate::lower(&with_m(|i| i.big_m(0.0).assume_valid())).unwrap();
    assert!(lowered.model().to_string().contains("  hit_upper: x - 2 y <= 3\n"));
}

// -- answers under a wrong M ------------------------------------------------------------------

/// Two indicators with assumed Ms over three columns, and a linear objective.
fn trusting() -> impl Strategy<Value = Vec<(Vec<i32>, i32, bool, bool, i32)>> {
    let indicator =
        (prop::collection::vec(-3..=3, 3), -6..=6, any::<bool>(), any::<bool>(), 0..=10);
    prop::collection::vec(indicator, 1..=3)
}

proptest! {
    #![proptest_config(config(60, REGRESSIONS))]

    #[test]
    fn a_wrong_m_lets_no_violation_through(
        indicators in trusting(),
        cost in prop::collection::vec(-3..=3, 5),
    ) {
        let mut model = Model::new("m");
        let x = model.continuous_family("x", 3, -3.0, 4.0).unwrap();
        let z = model.binary_family("z", 2).unwrap();
        let columns: Vec<Variable> = x.iter().chain(z.iter()).collect();
        let mut kept = Vec::new();
        for (k, (row, limit, on, is_upper, m)) in indicators.into_iter().enumerate() {
            if row.iter().all(|&a| a == 0) {
                continue;
            }
            let sum: Affine = x.iter().zip(&row).map(|(x, &a)| f64::from(a) * x).sum();
            let (limit, binary) = (f64::from(limit), z[k % 2]);
            let condition = if on { binary.on() } else { binary.off() };
            let row = if is_upper { sum.le(limit) } else { sum.ge(limit) };
            model.add(("i", k), condition.implies(row).big_m(f64::from(m)).assume_valid()).unwrap();
            kept.push((sum, limit, binary, on, is_upper));
        }
        let objective: Affine = columns.iter().zip(cost).map(|(v, q)| f64::from(q) * v).sum();
        model.minimize(objective).unwrap();
        let solution = BranchAndBound::default().solve(&model).unwrap();
        let Some(point) = solution.point() else { return Ok(()) };
        prop_assert_eq!(solution.verification().unwrap().assumed().len(), kept.len());
        for (sum, limit, binary, on, is_upper) in kept {
            let (activity, value) = (point.value(sum).unwrap(), point.value(binary).unwrap());
            prop_assert!(value == 0.0 || value == 1.0);
            let excess = if is_upper { activity - limit } else { limit - activity };
            prop_assert!((value == 1.0) != on || excess <= 1e-6, "missed by {}", excess);
        }
    }
}
