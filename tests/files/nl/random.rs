//! Random models there and back, and the text that is written.

use std::collections::BTreeMap;

use carom::interval::Interval;
use carom::model::nl::{self, SolFile};
use carom::model::{sos1, sos2};
use carom::prelude::*;
use proptest::prelude::*;

use super::read;
use crate::common::config;
use crate::models::{number, pair};

/// Bounds, the kind, and whether the variable stands in products of the row and the objective.
type VariablePlan = ((f64, f64), u8, [bool; 2]);

/// Models with all that a file can hold.
fn models() -> impl Strategy<Value = Model> {
    let variables = prop::collection::vec((pair(true), 0..4_u8, any::<[bool; 2]>()), 2..9);
    let numbers = prop::array::uniform3(number());
    let rows = prop::collection::vec((numbers, pair(false), 0..6_usize), 0..6);
    let set = prop::option::of(any::<bool>());
    (variables, rows, set, any::<bool>(), number()).prop_map(
        |(variables, rows, set, maximize, constant)| {
            let mut model = Model::new("random");
            let x = add_variables(&mut model, &variables);
            for (k, ([a, b, c], (lower, upper), pick)) in rows.into_iter().enumerate() {
                let at = |k: usize| x[(pick + k) % x.len()];
                let row = a * at(0) + b * at(1) + c * at(2);
                // A row without variables is one that may not hold, and sums may be too large.
                if !row.terms().is_empty() {
                    drop(model.add(("c", k), row.within(lower, upper)).err());
                }
            }
            let chosen = |part: usize| {
                variables.iter().zip(&x).filter(move |(plan, _)| plan.2[part]).map(|(_, x)| *x)
            };
            let ball: Quadratic = chosen(0).zip(1..).map(|(x, k)| f64::from(k) * x.square()).sum();
            if !ball.products().is_empty() {
                model.add("ball", (ball + 0.1 * x[0]).le(7.3)).unwrap();
            }
            match set {
                Some(true) => _ = model.add("s", sos1([(x[0], 2.0), (x[1], 0.5)])).unwrap(),
                Some(false) => _ = model.add("s", sos2([(x[0], 0.1), (x[1], -1.0)])).unwrap(),
                None => {}
            }
            let sign = if maximize { -1.0 } else { 1.0 };
            let squares: Affine = chosen(1).map(|x| 0.5 * x).sum();
            let sense = if maximize { Sense::Maximize } else { Sense::Minimize };
            let linear: Affine = x.iter().zip([constant, -1.0, 0.1]).map(|(&x, a)| a * x).sum();
            model.set_objective(sense, sign * squares.square() + linear + constant).unwrap();
            model
        },
    )
}

fn add_variables(model: &mut Model, plan: &[VariablePlan]) -> Vec<Variable> {
    let added = plan.iter().enumerate().map(|(k, &((lower, upper), kind, _))| match kind {
        0 => model.binary(("x", k)).unwrap(),
        // An integer within [0, 1] is a binary in the file.
        1 if lower < 0.0 || upper > 1.0 => model.integer(("x", k), lower, upper).unwrap(),
        _ => model.continuous(("x", k), lower, upper).unwrap(),
    });
    added.collect()
}

fn bits(interval: Interval) -> (u64, u64) {
    (interval.lower.to_bits(), interval.upper.to_bits())
}

/// Products by their columns.
fn products(of: &Quadratic, at: &[usize]) -> BTreeMap<(usize, usize), u64> {
    let pair = |a: usize, b: usize| (a.min(b), a.max(b));
    let products = of.products();
    products.iter().map(|(a, b, q)| (pair(at[a.index()], at[b.index()]), q.to_bits())).collect()
}

/// Terms by their columns.
fn terms(of: &[(Variable, f64)], at: &[usize]) -> BTreeMap<usize, u64> {
    of.iter().map(|(x, a)| (at[x.index()], a.to_bits())).collect()
}

proptest! {
    #![proptest_config(config(512, "tests/regressions/nl.txt"))]

    #[test]
    fn round_trips_are_exact(model in models()) {
        let text = nl::write(&model).unwrap();
        let again = read(&text);
        let mut answer = SolFile::to(&text).unwrap();
        answer.values = (0..again.variable_count()).map(|k| k as f64).collect();
        let columns: Vec<usize> =
            answer.values_of(&model).unwrap().iter().map(|(_, at)| *at as usize).collect();
        let same: Vec<usize> = (0..columns.len()).collect();
        let written: Vec<_> = again.variables().collect();
        prop_assert_eq!(written.len(), model.variable_count());
        for (own, &column) in model.variables().zip(&columns) {
            prop_assert_eq!(own.kind(), written[column].kind());
            prop_assert_eq!(bits(own.bounds()), bits(written[column].bounds()));
        }
        prop_assert_eq!(model.constraint_count(), again.constraint_count());
        for (own, row) in model.constraints().zip(again.constraints()) {
            prop_assert_eq!(bits(own.limits()), bits(row.limits()));
            prop_assert_eq!(terms(own.terms(), &columns), terms(row.terms(), &same));
        }
        prop_assert_eq!(model.conic_constraint_count(), again.conic_constraint_count());
        for (own, set) in model.special_ordered_sets().zip(again.special_ordered_sets()) {
            prop_assert_eq!(own.most(), set.most());
            prop_assert_eq!(terms(own.members(), &columns), terms(set.members(), &same));
        }
        prop_assert_eq!(model.sense(), again.sense());
        let (own, read) = (model.objective(), again.objective());
        prop_assert_eq!(products(own, &columns), products(read, &same));
        prop_assert_eq!(terms(&own.affine().terms(), &columns), terms(&read.affine().terms(), &same));
        prop_assert_eq!(own.affine().offset().to_bits(), read.affine().offset().to_bits());
        // The order is that of the file from now on.
        let second = nl::write(&again).unwrap().replace("unknown", "random");
        prop_assert_eq!(second, text);
    }
}

#[test]
fn the_text_that_is_written() {
    let mut model = Model::new("small");
    let z = model.binary("z").unwrap();
    let x = model.continuous_family("x", 2, -1.5, 2.0).unwrap();
    model.add("sum", (x[0] + 2.0 * z).within(-1.0, 4.0)).unwrap();
    model.add("disc", (x[0].square() + 3.0 * x[1].square()).le(x[1] + 1.0)).unwrap();
    model.maximize(-((x[1] - z).square()) + 7.0).unwrap();
    let expected = "\
g3 1 1 0	# problem small
 3 2 1 1 0	# vars, constraints, objectives, ranges, eqns
 1 1	# nonlinear constraints, objectives
 0 0	# network constraints: nonlinear, linear
 2 3 1	# nonlinear vars in constraints, objectives, both
 0 0 0 1	# linear network variables; functions; arith, flags
 0 0 0 0 1	# discrete variables: binary, integer, nonlinear (b,c,o)
 4 2	# nonzeros in Jacobian, gradients
 0 0	# max name lengths: constraints, variables
 0 0 0 0 0	# common exprs: b,c,o,c1,o1
C0
o0
o2
n3
o5
v0
n2
o5
v1
n2
C1
n0
O0 1
o54
4
o2
n-1
o5
v0
n2
o2
n2
o2
v0
v2
o2
n-1
o5
v2
n2
n7
r
1 1
0 -1 4
b
0 -1.5 2
0 -1.5 2
0 0 1
k2
1
3
J0 2
0 -1
1 0
J1 2
1 1
2 2
G0 2
0 0
2 0
";
    assert_eq!(nl::write(&model).unwrap(), expected);
}

#[test]
fn what_a_file_cannot_hold_is_named() {
    let refused = |say: &dyn Fn(&mut Model, [Variable; 3])| {
        let mut model = Model::new("m");
        let x = model.continuous("x", 0.0, 2.0).unwrap();
        let z = [0, 1].map(|k| model.binary(("z", k)).unwrap());
        say(&mut model, [x, z[0], z[1]]);
        nl::write(&model).unwrap_err().to_string()
    };
    let error = refused(&|model, [x, z, _]| _ = model.add("r", z.on().implies(x.le(1.0))).unwrap());
    assert!(error.starts_with("NL cannot express the condition of `r`; write the lowered model"));
    let error = refused(&|model, [_, a, b]| _ = model.add("or", a | b).unwrap());
    assert!(error.starts_with("NL cannot express the logic of `or`"), "{error}");
    let error = refused(&|model, _| _ = model.semicontinuous("flow", 1.0, 2.0).unwrap());
    assert!(error.starts_with("NL cannot express the semi-continuous variable `flow`"), "{error}");
    let error = refused(&|model, [x, a, b]| {
        model.add("first", sos1([(x, 1.0), (a, 2.0)])).unwrap();
        model.add("second", sos1([(x, 1.0), (b, 2.0)])).unwrap();
    });
    let start = "NL cannot express a variable that is in another ordered set and in `second`";
    assert!(error.starts_with(start), "{error}");
}
