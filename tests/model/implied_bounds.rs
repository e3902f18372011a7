//! Bounds that rows imply, where variables have none: what is found, how it is reported, and what a
//! refusal says.

use carom::model::{Logic, Method, PiecewiseAffine, Reformulation, Term, exactly, sos1, sos2};
use carom::prelude::*;
use carom::reformulate::{self, BigMSource};

const INF: f64 = f64::INFINITY;

/// The optimum of a model that only rows bound.
fn optimum(model: &Model) -> f64 {
    let solution = BranchAndBound::default().solve(model).unwrap();
    assert!(solution.is_optimal(), "{solution:?}");
    solution.objective().unwrap()
}

fn assert_close(a: f64, b: f64) {
    assert!((a - b).abs() <= 1e-5 * b.abs().max(1.0), "{a} instead of {b}");
}

fn message(model: &Model) -> String {
    reformulate::lower(model).unwrap_err().to_string()
}

fn largest(model: &Model) -> f64 {
    reformulate::lower(model).unwrap().report().largest().map_or(0.0, |entry| entry.value)
}

fn free(model: &mut Model, name: &str) -> Variable {
    model.continuous(name, -INF, INF).unwrap()
}

#[test]
fn a_row_fixes_what_an_indicator_needs() {
    let mut model = Model::new("m");
    let u = model.continuous("u", 1e5, 2e5).unwrap();
    let (x, y) = (free(&mut model, "x"), free(&mut model, "y"));
    let d = model.binary("d").unwrap();
    model.add("imp", d.on().implies((u - x).equals(0.0))).unwrap();
    model.add("e1", y.equals(0.0)).unwrap();
    model.add("e2", (x - y).equals(0.0)).unwrap();
    model.maximize(d).unwrap();
    assert_close(optimum(&model), 0.0);
    let lowered = reformulate::lower(&model).unwrap();
    // The variables keep the bounds that they have.
    assert_eq!(lowered.model().variable_ref(x).unwrap().bounds().upper, INF);
    let entry = &lowered.report().entries()[1];
    assert_eq!(entry.source, BigMSource::ImpliedBounds);
    assert_close(entry.value, 2e5);
    let implied: Vec<bool> = entry.shares.iter().map(|share| share.implied).collect();
    assert_eq!(implied, [false, true]);
    let text = lowered.report().to_string();
    assert!(text.contains("from bounds that rows imply (largest share: u)"), "{text}");
}

/// `x[k+1] = gain x[k] + u[k]` from a fixed start, with obstacles left out by a choice of sides.
fn chain(steps: usize, gain: f64, input: f64) -> Model {
    let mut model = Model::new("chain");
    let x = model.continuous_family("x", steps + 1, -INF, INF).unwrap();
    let u = model.continuous_family("u", steps, -input, input).unwrap();
    // The last step first, so that no order of the statements helps.
    for k in (0..steps).rev() {
        model.add(("dynamics", k), (x[k + 1] - gain * x[k] - u[k]).equals(0.0)).unwrap();
    }
    model.add("start", x[0].equals(1.0)).unwrap();
    let low = model.binary_family("low", steps + 1).unwrap();
    for k in 1..=steps {
        model.add(("below", k), low[k].on().implies(x[k].le(-0.5))).unwrap();
        model.add(("above", k), low[k].off().implies(x[k].ge(0.5))).unwrap();
    }
    model.maximize(low[steps] - x[steps]).unwrap();
    model
}

#[test]
fn chains_of_dynamics_bound_their_states() {
    assert_close(largest(&chain(40, 1.0, 0.25)), 11.5);
    assert_close(largest(&chain(9, 2.0, 0.25)), 512.0 + 0.25 * 511.0 + 0.5);
    assert_close(optimum(&chain(6, 1.0, 1.0)), 5.5);
}

/// After ten steps with a gain of ten, a start that is missed by 1e-9 is missed by 10.
#[test]
fn tolerances_grow_with_their_gains() {
    let model = chain(7, 10.0, 0.0);
    let lowered = reformulate::lower(&model).unwrap();
    let needs =
        |name: &str| lowered.report().entries().iter().find(|e| e.indicator == name).unwrap().value;
    assert!(needs("below[7]") > 1e7 + 0.5 + 10.0 - 0.01);
    // Each row by itself may be missed as well.
    assert!(needs("below[1]") > 10.5 + 1e-6 && needs("below[1]") < 10.5 + 2e-5);
}

#[test]
fn cases_that_cover_everything_bound_what_they_share() {
    // Both values of a binary.
    let mut model = Model::new("m");
    let (x, y) = (free(&mut model, "x"), free(&mut model, "y"));
    let z = model.binary("z").unwrap();
    model.add("on", z.on().implies(x.within(1.0, 3.0))).unwrap();
    model.add("off", z.off().implies(x.within(-2.0, -1.0))).unwrap();
    model.add("tie", (y - 2.0 * x).equals(1.0)).unwrap();
    model.add("top", z.on().implies(y.ge(6.0))).unwrap();
    model.minimize(x + z).unwrap();
    assert_close(optimum(&model), -2.0);
    model.maximize(x + y).unwrap();
    assert_close(optimum(&model), 10.0);

    // Modes, one of which is chosen, by a row or by logic; the dynamics themselves are switched.
    for by_row in [true, false] {
        let mut model = Model::new("modes");
        let x = model.continuous_family("x", 5, -INF, INF).unwrap();
        model.add("start", x[0].equals(4.0)).unwrap();
        for k in 0..4 {
            let mode: Vec<Variable> =
                (0..3).map(|m| model.binary(format!("mode_{k}_{m}")).unwrap()).collect();
            match by_row {
                true => {
                    let sum: Affine = mode.iter().map(|&m| Affine::from(m)).sum();
                    model.add(("one", k), sum.equals(1.0)).unwrap();
                }
                false => {
                    model.add(("one", k), exactly(1, &mode)).unwrap();
                }
            }
            for (m, factor) in [0.5, -1.0, 2.0].into_iter().enumerate() {
                let next = (x[k + 1] - factor * x[k]).equals(0.0);
                model.add(format!("move_{k}_{m}"), mode[m].on().implies(next)).unwrap();
            }
            model.add(("cap", k), mode[2].on().implies(x[k + 1].le(20.0))).unwrap();
        }
        model.minimize(x[4]).unwrap();
        assert_close(optimum(&model), -32.0);
    }
}

#[test]
fn rows_under_a_condition_bound_nothing() {
    let mut model = Model::new("m");
    let x = free(&mut model, "x");
    let z = model.binary("z").unwrap();
    model.add("on", z.on().implies(x.within(1.0, 3.0))).unwrap();
    model.add("also", z.on().implies(x.le(2.0))).unwrap();
    assert_eq!(
        message(&model),
        "indicator `on` needs a big-M for its lower side, but `x` has no lower bound; give `x` a \
         finite one"
    );
    // Unless the condition always holds.
    model.add("always", Affine::from(z).ge(1.0)).unwrap();
    model.maximize(x).unwrap();
    assert_close(optimum(&model), 2.0);
}

#[test]
fn only_the_side_that_is_needed() {
    let mut model = Model::new("m");
    let (x, y) = (free(&mut model, "x"), free(&mut model, "y"));
    let z = model.binary("z").unwrap();
    // The difference is bounded, its terms are not.
    model.add("near", (x - y).within(-3.0, 5.0)).unwrap();
    model.add("on", z.on().implies((x - y).le(1.0))).unwrap();
    model.add("goal", y.ge(100.0)).unwrap();
    model.maximize(x - y + 2.0 * z).unwrap();
    let lowered = reformulate::lower(&model).unwrap();
    let entry = &lowered.report().entries()[0];
    assert_eq!(entry.source, BigMSource::LinearProgram);
    assert_close(entry.value, 4.0);
    assert_close(optimum(&model), 5.0);
}

#[test]
fn sums_of_rows_bound_what_no_row_does() {
    let mut model = Model::new("m");
    let d = model.integer("d", 0.0, INF).unwrap();
    let (a, b) = (model.integer("a", 0.0, INF).unwrap(), model.integer("b", 0.0, INF).unwrap());
    model.add("one", (d - a).equals(-17.0)).unwrap();
    model.add("two", (a + b + d).le(55.0)).unwrap();
    model.add("set", sos1([(a, 1.0), (b, 2.0)])).unwrap();
    model.maximize(a + 2.0 * b).unwrap();
    assert_close(optimum(&model), 36.0);
    let mut model = Model::new("m");
    let [p, q, r] = ["p", "q", "r"].map(|name| model.continuous(name, 0.0, INF).unwrap());
    let [x, y, z] = ["x", "y", "z"].map(|name| model.continuous(name, 0.0, INF).unwrap());
    model.add("ra", (p - q - r - x).equals(-17.0)).unwrap();
    model.add("rb", (q - p - r - y).equals(-55.0)).unwrap();
    model.add("rc", (r - p - q - z).equals(-6.0)).unwrap();
    model.add("set", sos1([(x, 1.0), (y, 2.0), (z, 3.0)])).unwrap();
    model.minimize(p + q + r).unwrap();
    assert_close(optimum(&model), 17.0);
}

/// Every kind of statement that needs bounds, over variables that only rows bound.
#[test]
fn all_kinds_of_statements() {
    let mut model = Model::new("m");
    let x = model.continuous_family("x", 4, 0.0, INF).unwrap();
    let capacity: Affine = x.iter().map(Affine::from).sum();
    model.add("capacity", capacity.le(9.0)).unwrap();
    model.add("lone", (2.0 * x[3]).le(5.0)).unwrap();
    let mut with_set = model.clone();
    with_set.add("set", sos1([(x[0], 1.0), (x[1], 2.0), (x[2], 3.0)])).unwrap();
    with_set.maximize(2.0 * x[0] + x[1] + x[3]).unwrap();
    assert_close(optimum(&with_set), 2.0 * 9.0);
    let mut with_set = model.clone();
    with_set.add("set", sos2([(x[0], 1.0), (x[1], 2.0), (x[2], 3.0)])).unwrap();
    with_set.maximize(x[0] + 2.0 * x[2] + x[3]).unwrap();
    assert_close(optimum(&with_set), 18.0);

    let mut functions = model.clone();
    let far = functions.absolute("far", x[0] - x[1]).unwrap();
    let top = functions.maximum("top", [Affine::from(x[2]), 3.0 - x[3]]).unwrap();
    let low = functions.minimum("low", [Affine::from(x[2]), x[3] + 1.0]).unwrap();
    let on = functions.binary("on").unwrap();
    let product = functions.product("product", on, x[0] + x[3]).unwrap();
    let count = functions.integer("count", 0.0, INF).unwrap();
    functions.add("counted", (count - x[1]).le(0.5)).unwrap();
    let both = functions.product("both", count, Affine::from(x[3])).unwrap();
    functions.add("fewer", Affine::from(count).le(2.5)).unwrap();
    functions.maximize(far + top + low + product + both - 4.0 * on).unwrap();
    let mut bounded = functions.clone();
    x.iter().for_each(|x| bounded.set_bounds(x, 0.0, 9.0).unwrap());
    bounded.set_bounds(count, 0.0, 9.0).unwrap();
    assert_close(optimum(&functions), optimum(&bounded));

    // What a function is limited to limits its argument.
    let mut model = Model::new("m");
    let y = free(&mut model, "y");
    let far = model.absolute("far", y - 1.0).unwrap();
    let z = model.binary("z").unwrap();
    model.add("cap", Affine::from(far).le(4.0)).unwrap();
    model.add("on", z.on().implies(y.le(0.0))).unwrap();
    let graph = PiecewiseAffine::new([(-10.0, 0.0), (0.0, 1.0), (10.0, -3.0)]).unwrap();
    let value = model.piecewise("value", y, &graph).unwrap();
    model.maximize(far + 0.1 * value + 4.0 * z).unwrap();
    assert_close(optimum(&model), 8.0 + 0.1 * 0.7);

    // Semi-continuous without a largest value.
    let mut model = Model::new("m");
    let pump = model.semicontinuous("pump", 2.0, INF).unwrap();
    model.add("cap", (2.0 * pump).le(9.0)).unwrap();
    model.add("need", Affine::from(pump).ge(0.5)).unwrap();
    model.minimize(pump).unwrap();
    assert_close(optimum(&model), 2.0);
    model.maximize(pump).unwrap();
    assert_close(optimum(&model), 4.5);
}

#[test]
fn all_methods_for_disjunctions() {
    for method in Method::ALL {
        for programs in [false, true] {
            let mut model = Model::new("m");
            let (x, y) = (free(&mut model, "x"), free(&mut model, "y"));
            model.add("sum", (x + y).within(-4.0, 6.0)).unwrap();
            model.add("difference", (x - y).within(-1.0, 1.0)).unwrap();
            let inner = either((x + y).le(1.0)).or(y.ge(2.0));
            model
                .add(
                    "way",
                    either([x.le(0.0), y.ge(0.0)]).or(Term::from(x.ge(1.5)).and_either(inner)),
                )
                .unwrap();
            model.set_reformulation(
                Reformulation::default().with_method(method).with_linear_programs(programs),
            );
            model.maximize(x - 0.5 * y).unwrap();
            assert_close(optimum(&model), 2.25);
        }
    }
    let mut model = Model::new("m");
    let x = free(&mut model, "x");
    model.add("way", either(x.within(-3.0, -2.0)).or(x.within(1.0, 4.0))).unwrap();
    model.maximize(x).unwrap();
    for method in Method::ALL {
        model.set_reformulation(Reformulation::default().with_method(method));
        assert_close(optimum(&model), 4.0);
    }
    let table = reformulate::compare_methods(&model, &mut BranchAndBound::default()).unwrap();
    assert_eq!(table.entries().len(), 3);
}

#[test]
fn ranges_of_parameters_count() {
    let mut model = Model::new("m");
    let x = free(&mut model, "x");
    let z = model.binary("z").unwrap();
    let p = model.parameter("p", 1.0, -2.0, 8.0).unwrap();
    model.add("row", (x - p).within(0.0, 1.0)).unwrap();
    model.add("on", z.on().implies(x.le(0.0))).unwrap();
    model.maximize(x + 5.0 * z).unwrap();
    let lowered = reformulate::lower(&model).unwrap();
    assert_close(lowered.report().entries()[0].value, 9.0);
    for (value, best) in [(1.0, 2.0), (8.0, 9.0), (-2.0, 4.0)] {
        model.set_parameter(p, value).unwrap();
        let solution = lowered.solve(&model, &mut BranchAndBound::default()).unwrap();
        assert_close(solution.objective().unwrap(), best);
    }
}

#[test]
fn integers_are_rounded() {
    let mut model = Model::new("m");
    let n = model.integer("n", -INF, INF).unwrap();
    let z = model.binary("z").unwrap();
    model.add("row", (2.0 * n).within(-7.0, 9.0)).unwrap();
    model.add("on", z.on().implies(n.equals(0.0))).unwrap();
    let lowered = reformulate::lower(&model).unwrap();
    let values: Vec<f64> = lowered.report().entries().iter().map(|entry| entry.value).collect();
    assert_eq!(values, [3.0, 4.0]);
}

/// Two units from `a` to `c`, by `b` or directly; flow may circulate between `a` and `b`.
#[test]
fn flows_circulate_no_more_than_they_must() {
    let mut model = Model::new("flow");
    let [ab, ba, bc, ac] = ["ab", "ba", "bc", "ac"].map(|n| model.continuous(n, 0.0, INF).unwrap());
    model.add("a", (ba - ab - ac).equals(-2.0)).unwrap();
    model.add("b", (ab - ba - bc).equals(0.0)).unwrap();
    model.add("c", (bc + ac).equals(2.0)).unwrap();
    let [wide, direct] = ["wide", "direct"].map(|name| model.binary(name).unwrap());
    model.add("narrow", wide.off().implies((ab + ba).le(1.0))).unwrap();
    model.add("closed", direct.off().implies(ac.le(0.5))).unwrap();
    model.minimize(3.0 * wide + 2.0 * direct + 0.5 * ac).unwrap();
    assert_close(optimum(&model), 2.5);
    // The direct flow has bounds anyway, those of the circle come from what enters.
    assert_close(largest(&model), 3.0);
    // Where more flow is asked for or pays, nothing bounds the circle.
    let mut asked = model.clone();
    asked.add("busy", wide.on().implies(ab.ge(5.0))).unwrap();
    assert!(message(&asked).contains("`ab` has no upper bound"), "{}", message(&asked));
    model.minimize(3.0 * wide + 2.0 * direct - 0.1 * ab).unwrap();
    assert!(message(&model).contains("`ab` has no upper bound"), "{}", message(&model));
}

#[test]
fn refusals_name_the_chain() {
    let mut model = Model::new("m");
    let x = model.continuous_family("x", 9, -INF, INF).unwrap();
    let z = model.binary("z").unwrap();
    for k in 0..2 {
        model.add(("step", k), (x[k + 1] - x[k]).le(1.0)).unwrap();
    }
    model.add("on", z.on().implies(x[2].le(1.0))).unwrap();
    assert_eq!(
        message(&model),
        "indicator `on` needs a big-M for its upper side, but `x[2]` has no upper bound and rows \
         imply none (row `step[1]` needs an upper bound of `x[1]`, row `step[0]` needs an upper \
         bound of `x[0]`, which no row bounds from above); give `x[2]` or `x[0]` a finite one"
    );
    let mut far = Model::new("m");
    let x = far.continuous_family("x", 9, 0.0, INF).unwrap();
    let z = far.binary("z").unwrap();
    for k in 0..8 {
        far.add(("step", k), (x[k + 1] - x[k]).le(1.0)).unwrap();
    }
    far.add("far", z.on().implies(x[8].le(1.0))).unwrap();
    assert_eq!(
        message(&far),
        "indicator `far` needs a big-M for its upper side, but `x[8]` has no upper bound and rows \
         imply none (row `step[7]` needs an upper bound of `x[7]`, row `step[6]` needs an upper \
         bound of `x[6]`, and so on over 5 rows, row `step[0]` needs an upper bound of `x[0]`, \
         which no row bounds from above); give `x[8]` or `x[0]` a finite one"
    );

    // Equations need each other's variables both ways.
    let mut model = Model::new("m");
    let [a, b] = ["a", "b"].map(|name| free(&mut model, name));
    let z = model.binary("z").unwrap();
    model.add("tie", (a - b).equals(0.0)).unwrap();
    model.add("on", z.on().implies(a.le(1.0))).unwrap();
    assert_eq!(
        message(&model),
        "indicator `on` needs a big-M for its upper side, but `a` has no upper bound and rows imply \
         none (row `tie` needs an upper bound of `b`, which no other row bounds from above); give \
         `a` or `b` a finite one"
    );

    // Two that wait for each other, and one that waits for several.
    let mut model = Model::new("m");
    let [a, b, c] = ["a", "b", "c"].map(|name| model.continuous(name, 0.0, INF).unwrap());
    let z = model.binary("z").unwrap();
    model.add("ab", (a - b).le(1.0)).unwrap();
    model.add("ba", (b - a - c).le(1.0)).unwrap();
    model.add("on", z.on().implies(a.le(1.0))).unwrap();
    assert_eq!(
        message(&model),
        "indicator `on` needs a big-M for its upper side, but `a` has no upper bound and rows imply \
         none (row `ab` needs an upper bound of `b`, row `ba` needs an upper bound of `c` and of \
         another variable, which no row bounds from above); give `a` or `c` a finite one"
    );
}

#[test]
fn bounds_that_explode_are_refused() {
    let model = chain(12, 10.0, 1.0);
    let text = message(&model);
    assert!(
        text.contains("has no upper bound and rows bound it only by 1.")
            && text.contains("which is too large for a big-M (at most 1e9)"),
        "{text}"
    );
}

/// A row that no row's bounds can satisfy makes the model infeasible, not refused.
#[test]
fn contradictory_rows_are_an_answer() {
    let mut model = Model::new("m");
    let x = free(&mut model, "x");
    let z = model.binary("z").unwrap();
    model.add("low", x.le(1.0)).unwrap();
    model.add("high", x.ge(2.0)).unwrap();
    model.add("on", z.on().implies(x.equals(0.0))).unwrap();
    assert!(BranchAndBound::default().solve(&model).unwrap().is_infeasible());
    model.add("any", Logic::any([z]).implies(z)).unwrap();
    assert!(BranchAndBound::default().solve(&model).unwrap().is_infeasible());
}

#[test]
fn prepared_models_are_lowered_alike() {
    let mut model = chain(5, 1.0, 0.5);
    let goal = model.parameter("goal", 2.0, -1.0, 3.0).unwrap();
    let last = model.variable_by_name(("x", 5)).unwrap();
    model.add("at_least", (last - goal).ge(0.0)).unwrap();
    let mut solver = BranchAndBound::default();
    let mut prepared = solver.prepare(&model).unwrap();
    for (value, best) in [(2.0, -2.0), (0.0, -0.5), (3.0, -3.0)] {
        let solution = prepared.solve(&[(goal, value)], &mut Control::default()).unwrap();
        assert_close(solution.objective().unwrap(), best);
    }
}
