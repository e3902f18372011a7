//! Switching that can be trusted: no unsafe M gets through by hand, by later changes of bounds, by
//! a missing bound or by a parameter at the end of its range; Ms from linear programs change no
//! answer; certificates tell a point that means what it says from one that trickled through a
//! switched row.

use crate::common::config;
use crate::common::enumeration::optimum;
use crate::common::generate::{Shape, case};
use crate::common::quadratic_program::Minimum;
use carom::ErrorKind;
use carom::model::{Method, Reformulation};
use carom::prelude::*;
use carom::reformulate::{self, BigMSource, Lowered};
use carom::solution::{Outcome, ViolationKind};
use carom::solver::certify;
use proptest::prelude::*;

const INF: f64 = f64::INFINITY;

// -- smuggling --------------------------------------------------------------------------------

/// Something that could make an M too small.
#[derive(Debug, Clone)]
enum Change {
    Bounds(usize, i32, i32),
    OpenAbove(usize),
    Value(f64),
    Range(i32, i32),
    Limit(i32),
}

fn change() -> impl Strategy<Value = Change> {
    prop_oneof![
        4 => (0..2_usize, -9..=9_i32, 0..=9_i32).prop_map(|(j, l, w)| Change::Bounds(j, l, l + w)),
        1 => (0..2_usize).prop_map(Change::OpenAbove),
        3 => (0..=8_i32).prop_map(|part| Change::Value(f64::from(part) / 8.0)),
        2 => (-9..=9_i32, 0..=9_i32).prop_map(|(l, w)| Change::Range(l, l + w)),
        2 => (-9..=9_i32).prop_map(Change::Limit),
    ]
}

/// `z = 1` implies `a x + b y + c p <= limit`, and a disjunction of the same row and its opposite.
struct Smuggler {
    model: Model,
    x: [Variable; 2],
    p: Variable,
    z: Variable,
    indicator: Indicator,
    a: [f64; 3],
}

impl Smuggler {
    fn new(a: [i32; 3], given: Option<i32>, method: Method) -> Self {
        let mut model = Model::new("smuggler");
        let x = [0, 1].map(|j| model.continuous(("x", j), -2.0, 3.0).unwrap());
        let p = model.parameter("p", 0.0, -1.0, 1.0).unwrap();
        let z = model.binary("z").unwrap();
        let a = a.map(f64::from);
        let sum = a[0] * x[0] + a[1] * x[1] + a[2] * p;
        let mut row = z.on().implies(sum.le(1.0));
        if let Some(given) = given {
            row = row.big_m(f64::from(given));
        }
        let indicator = model.add("row", row).unwrap();
        let ways = either(sum.le(-1.0)).or(sum.ge(1.0)).selected_by([z.on(), z.off()]);
        model.add("ways", ways.by(method)).unwrap();
        Smuggler { model, x, p, z, indicator, a }
    }

    fn apply(&mut self, change: &Change) {
        let range = |m: &Model, p| m.variable_ref(p).unwrap().parameter_range().unwrap();
        match *change {
            Change::Bounds(j, lower, upper) => {
                self.model.set_bounds(self.x[j], f64::from(lower), f64::from(upper)).unwrap();
            }
            Change::OpenAbove(j) => self.model.set_bounds(self.x[j], -1.0, INF).unwrap(),
            Change::Value(part) => {
                let range = range(&self.model, self.p);
                let value = range.lower + part * range.width();
                self.model.set_parameter(self.p, value).unwrap();
            }
            Change::Range(lower, upper) => {
                let (lower, upper) = (f64::from(lower), f64::from(upper));
                // Refused while the present value is outside.
                let inside = (lower..=upper).contains(&self.at(self.p).0);
                let done = self.model.set_parameter_range(self.p, lower, upper);
                assert_eq!(done.is_ok(), inside);
            }
            Change::Limit(limit) => {
                let limit = f64::from(limit);
                self.model.set_indicator_limits(self.indicator, f64::NEG_INFINITY, limit).unwrap();
            }
        }
    }

    fn at(&self, variable: Variable) -> (f64, f64) {
        let variable = self.model.variable_ref(variable).unwrap();
        let range = variable.parameter_range().unwrap_or(variable.bounds());
        if variable.parameter_range().is_some() {
            (variable.bounds().lower, range.upper)
        } else {
            (range.lower, range.upper)
        }
    }

    /// Whether the lowered rows say what is meant at every corner and middle of the box, for every
    /// value of the parameter's range.
    fn check(&self, lowered: &Lowered) -> Result<(), TestCaseError> {
        let ends = |v: Variable| {
            let variable = self.model.variable_ref(v).unwrap();
            let range = variable.parameter_range().unwrap_or(variable.bounds());
            [range.lower, 0.5 * (range.lower + range.upper), range.upper]
        };
        let limit = self.model.indicators().next().unwrap().limits().upper;
        for x in ends(self.x[0]) {
            for y in ends(self.x[1]) {
                for p in ends(self.p) {
                    for z in [0.0, 1.0] {
                        let sum = self.a[0] * x + self.a[1] * y + self.a[2] * p;
                        let meant = if z == 1.0 { sum <= limit && sum <= -1.0 } else { sum >= 1.0 };
                        let mut values = vec![0.0; self.model.variable_count()];
                        values[self.x[0].index()] = x;
                        values[self.x[1].index()] = y;
                        values[self.p.index()] = p;
                        values[self.z.index()] = z;
                        let rows = lowered.model().constraints().all(|row| {
                            let terms = row.terms().iter();
                            let sum: f64 = terms.map(|&(v, a)| a * values[v.index()]).sum();
                            let Interval { lower, upper } = row.limits();
                            sum >= lower - 1e-5 && sum <= upper + 1e-5
                        });
                        prop_assert_eq!(rows, meant, "at {:?}: {}", values, lowered.model());
                    }
                }
            }
        }
        Ok(())
    }
}

use carom::interval::Interval;

proptest! {
    #![proptest_config(config(150, "tests/regressions/trust.txt"))]

    #[test]
    fn no_unsafe_m_gets_through(
        a in prop::array::uniform3(-3..=3_i32),
        given in prop::option::of(0..=40_i32),
        multi in any::<bool>(),
        programs in any::<bool>(),
        changes in prop::collection::vec(change(), 0..=6),
    ) {
        prop_assume!(a[0] != 0 && a[1] != 0);
        // Hulls have copies instead of Ms; they are compared by optima elsewhere.
        let method = if multi { Method::MultiM } else { Method::BigM };
        let mut smuggler = Smuggler::new(a, given, method);
        // Linear programs may use the other rows, so a row alone no longer says all of it.
        smuggler.model.set_reformulation(Reformulation::default().with_linear_programs(programs));
        let mut old: Option<Lowered> = reformulate::lower(&smuggler.model).ok();
        for change in &changes {
            smuggler.apply(change);
            let still = matches!(change, Change::Value(_));
            let bounded = smuggler.x.iter().all(|&v| smuggler.at(v).1 < INF);
            if let Some(old) = &old {
                let mut solver = BranchAndBound::default();
                let solved = old.solve(&smuggler.model, &mut solver);
                let stale = matches!(&solved, Err(e) if matches!(e.kind(), ErrorKind::Stale { .. }));
                let range_refused = matches!(change, Change::Range(..));
                prop_assert!(stale != still || range_refused, "{:?}", solved);
            }
            match reformulate::lower(&smuggler.model) {
                Ok(lowered) => {
                    prop_assert!(bounded);
                    smuggler.check(&lowered)?;
                    old = Some(lowered);
                }
                Err(error) => {
                    match error.kind() {
                        ErrorKind::UnsafeBigM { needed, given: m, .. } => {
                            prop_assert!(given.map(f64::from) == Some(*m) && m < needed);
                        }
                        ErrorKind::UnboundedIndicator { .. }
                        | ErrorKind::UnboundedFunction { .. } => prop_assert!(!bounded),
                        _ => prop_assert!(false, "{error}"),
                    }
                    old = None;
                }
            }
        }
    }

    /// Random programs with indicators: Ms from linear programs give the enumerated optimum, and
    /// none is larger than the one from bounds.
    #[test]
    fn linear_programs_change_no_answer(case in case(Shape::BOUNDED)) {
        let (mut model, _) = case.build();
        model.set_reformulation(Reformulation::default().with_linear_programs(true));
        for entry in reformulate::lower(&model).unwrap().report().entries() {
            prop_assert!(entry.value <= entry.needed, "{entry:?}");
        }
        let solution = BranchAndBound::default().solve(&model).unwrap();
        match optimum(&case) {
            Minimum::Attained { value, .. } => {
                prop_assert!(solution.is_optimal(), "{solution:?}");
                let found = case.sign() * solution.objective().unwrap();
                prop_assert!((found - value).abs() < 1e-5 * value.abs().max(1.0));
            }
            _ => prop_assert!(solution.is_infeasible(), "{solution:?}"),
        }
    }

    /// One lowered form serves every value of the range: the answer is that of a model with the
    /// number in place of the parameter.
    #[test]
    fn one_lowered_form_serves_all_values(
        slopes in prop::array::uniform3(-3..=3_i32),
        values in prop::collection::vec(0..=16_i32, 1..=3),
        method in prop::sample::select(Method::ALL.to_vec()),
    ) {
        let slopes = slopes.map(f64::from);
        let build = |number: Option<f64>| {
            let mut model = Model::new("m");
            let x = model.continuous("x", -4.0, 4.0).unwrap();
            let z = model.binary("z").unwrap();
            let p = match number {
                Some(number) => model.continuous("p", number, number).unwrap(),
                None => model.parameter("p", -2.0, -2.0, 2.0).unwrap(),
            };
            model.add("if", z.on().implies((x - p).le(0.5))).unwrap();
            model.add("way", either((x + p).le(-1.0)).or(x.ge(1.0 - p))).unwrap();
            let far = model.absolute("far", x - slopes[2] * p).unwrap();
            model.minimize(slopes[0] * x + slopes[1] * z + far).unwrap();
            model.set_reformulation(Reformulation::default().with_method(method));
            (model, p)
        };
        let (mut model, p) = build(None);
        let lowered = reformulate::lower(&model).unwrap();
        let mut solver = BranchAndBound::default();
        for value in values {
            let value = -2.0 + 0.25 * f64::from(value);
            model.set_parameter(p, value).unwrap();
            let found = lowered.solve(&model, &mut solver).unwrap();
            let fresh = solver.solve(&build(Some(value)).0).unwrap();
            prop_assert_eq!(found.termination(), fresh.termination());
            let (found, fresh) = (found.objective().unwrap(), fresh.objective().unwrap());
            prop_assert!((found - fresh).abs() < 1e-5, "{found} {fresh}");
        }
    }
}

// -- parameters ---------------------------------------------------------------------------------

#[test]
fn parameters_are_refused_by_name() {
    let mut model = Model::new("m");
    let x = model.continuous("x", 0.0, 1.0).unwrap();
    let goal = model.parameter("goal", 2.0, 0.0, 5.0).unwrap();
    let text = |result: Result<(), Error>| result.unwrap_err().to_string();
    assert_eq!(
        text(model.set_parameter(goal, 6.0)),
        "the value of the parameter `goal` is 6; it must be within its declared range [0, 5]; \
         widen \
         that with `set_parameter_range`"
    );
    assert_eq!(
        text(model.set_bounds(goal, 0.0, 1.0)),
        "`goal` is a parameter; give it a value with `set_parameter` and a range with \
         `set_parameter_range`"
    );
    assert_eq!(
        text(model.set_parameter(x, 1.0)),
        "`x` is not a parameter; make it one with `Model::parameter`"
    );
    assert!(model.set_parameter(goal, f64::NAN).is_err());
    assert!(model.parameter("wide", 0.0, 0.0, INF).is_err());
    assert!(model.set_parameter_range(goal, 3.0, 5.0).is_err());
    assert!(model.to_string().contains("  goal = 2, a parameter in [0, 5]\n"));
    assert_eq!(model.parameters().collect::<Vec<_>>(), [goal]);
}

#[test]
fn a_lowered_form_knows_when_it_is_out_of_date() {
    let mut model = Model::new("plan");
    let x = model.continuous("x", 0.0, 1.0).unwrap();
    let z = model.binary("z").unwrap();
    model.add("slow", z.on().implies(x.le(0.5))).unwrap();
    model.maximize(x + z).unwrap();
    let lowered = reformulate::lower(&model).unwrap();
    let mut solver = BranchAndBound::default();
    assert!(lowered.solve(&model, &mut solver).unwrap().is_optimal());
    model.set_bounds(x, 0.0, 9.0).unwrap();
    assert_eq!(
        lowered.solve(&model, &mut solver).unwrap_err().to_string(),
        "the model `plan` was changed after it was lowered, so the lowered form and its big-Ms \
         are out of date; lower it again"
    );
    // The same bounds as before are another state all the same; a clone is the same state.
    model.set_bounds(x, 0.0, 1.0).unwrap();
    assert!(lowered.solve(&model, &mut solver).is_err());
    let lowered = reformulate::lower(&model).unwrap();
    assert!(lowered.solve(&model.clone(), &mut solver).is_ok());
}

// -- Ms from linear programs --------------------------------------------------------------------

/// A chain of ten short steps, and a row that the bounds alone make ten times too large.
fn chain(programs: bool) -> Lowered {
    let mut model = Model::new("chain");
    let x = model.continuous_family("x", 11, -1000.0, 1000.0).unwrap();
    let stop = model.binary("stop").unwrap();
    model.fix(x[0], 0.0).unwrap();
    for t in 0..10 {
        model.add(("step", t), (x[t + 1] - x[t]).within(-1.0, 1.0)).unwrap();
    }
    model.add("turn", stop.on().implies((x[10] + x[9]).le(0.0))).unwrap();
    model.set_reformulation(Reformulation::default().with_linear_programs(programs));
    reformulate::lower(&model).unwrap()
}

#[test]
fn the_gain_of_linear_programs_is_reported() {
    let (plain, tight) = (chain(false), chain(true));
    assert_eq!(plain.report().entries()[0].value, 2000.0);
    let entry = &tight.report().entries()[0];
    assert_eq!(entry.source, BigMSource::LinearProgram);
    assert!((entry.value - 19.0).abs() < 1e-4 && entry.value >= 19.0, "{}", entry.value);
    assert_eq!(entry.needed, 2000.0);
    assert!(tight.report().to_string().contains("from linear programs, 2000 from bounds"));
}

#[test]
fn the_report_says_from_which_bounds() {
    let plain = chain(false);
    let entry = &plain.report().entries()[0];
    let shares: Vec<_> =
        entry.shares.iter().map(|s| (s.variable.as_str(), s.value, s.part)).collect();
    assert_eq!(shares, [("x[9]", 1000.0, 1000.0), ("x[10]", 1000.0, 1000.0)]);
    let row =
        plain.model().constraints().find(|row| Some(row.name().to_string()) == entry.row).unwrap();
    assert_eq!(row.name().to_string(), "turn_upper");
}

// -- certificates -------------------------------------------------------------------------------

/// A backend that answers one point and calls it optimal.
fn claimed(model: &Model, values: &[f64]) -> Solution {
    let outcome =
        Outcome::new(Termination::Optimal, Some(values.to_vec()), -INF, Statistics::default());
    Solution::new(model, outcome, 1e-6).unwrap()
}

/// A wall at 0 with a gate; costs 50 to open.
fn gate() -> (Model, Variable, Variable) {
    let mut model = Model::new("gate");
    let x = model.continuous("x", -1e5, 10.0).unwrap();
    let open = model.binary("open").unwrap();
    model.add("wall", open.off().implies(x.ge(0.0))).unwrap();
    let far = model.absolute("far", x - 5.0).unwrap();
    model
        .add("way", either(far.le(8.0)).or(far.ge(30.0)).selected_by([open.off(), open.on()]))
        .unwrap();
    model.minimize(x + 50.0 * open).unwrap();
    (model, x, open)
}

#[test]
fn what_trickles_is_not_optimal() {
    let (model, ..) = gate();
    // With M = 1e5 and a tolerance of 1e-6 on the binary, x = -0.1 satisfies the rows.
    let solution = claimed(&model, &[-0.1, 1e-6, 5.1]);
    assert_eq!(solution.termination(), Termination::Stalled);
    assert!(solution.point().is_none());
    let failed = solution.verification().unwrap();
    assert_eq!(failed.violations()[0].kind, ViolationKind::Implication);
    // A whole binary and a point that means what it says: accepted, and what was checked is told.
    let solution = claimed(&model, &[0.0, 1e-7, 5.0]);
    assert!(solution.is_optimal());
    assert_eq!(solution.rounding(), 1e-7);
    let checked = solution.verification().unwrap().checked();
    assert_eq!((checked.implications, checked.disjunctions, checked.functions), (1, 1, 1));
    // Far from whole is not rounded, but refused.
    assert!(claimed(&model, &[0.0, 1e-3, 5.0]).point().is_none());
}

#[test]
fn a_certificate_solves_the_rest_again() {
    let (model, x, open) = gate();
    let mut solver = BranchAndBound::default();
    let certificate = certify(&model, &[-0.1, 1e-6, 5.1], &mut solver).unwrap();
    assert!(certificate.holds() && !certificate.as_given().holds());
    assert!(certificate.solution().value(x).unwrap().abs() < 1e-6);
    assert_eq!(certificate.solution().value(open).unwrap(), 0.0);
    assert!((certificate.moved().unwrap() - 0.1).abs() < 1e-5);
    assert_eq!(certificate.rounding(), 1e-6);
    // The search's own answer is its own certificate.
    let solution = solver.solve(&model).unwrap();
    let values = solution.point().unwrap().as_slice().to_vec();
    let certificate = certify(&model, &values, &mut solver).unwrap();
    assert!(certificate.holds() && certificate.as_given().holds());
    assert_eq!((certificate.rounding(), solution.rounding()), (0.0, 0.0));
    assert!(certificate.moved().unwrap() < 1e-5);

    assert!(matches!(
        certify(&model, &[0.0], &mut solver).unwrap_err().kind(),
        ErrorKind::Length { .. }
    ));
    let error = certify(&model, &[f64::NAN, 0.0, 0.0], &mut solver).unwrap_err();
    assert_eq!(error.to_string(), "the value of `x` is NaN; give a finite number");
}

#[test]
fn integers_that_no_point_has_are_not_certified() {
    let (mut model, _, open) = gate();
    model.add("shut", open.off()).unwrap();
    let certificate = certify(&model, &[-30.0, 1.0, 35.0], &mut BranchAndBound::default()).unwrap();
    assert!(!certificate.holds());
    assert!(certificate.solution().is_infeasible());
}
