//! Logic: the rows of a formula, projected on the user's binaries, are its truth table; they are
//! as few as promised; points are verified against the formula itself.

use crate::common::config;
use crate::common::rows::extends;
use carom::ErrorKind;
use carom::prelude::*;
use carom::reformulate;
use carom::solution::{Point, Verification, ViolationKind};
use proptest::prelude::*;

/// A model with binaries `a`, `b`, `c`, ...
fn binaries(count: usize) -> (Model, Vec<Variable>) {
    let mut model = Model::new("m");
    let name = |k: usize| char::from(b'a' + k as u8).to_string();
    let variables = (0..count).map(|k| model.binary(name(k)).unwrap()).collect();
    (model, variables)
}

fn assignments(count: usize) -> impl Iterator<Item = Vec<f64>> {
    (0..1_usize << count)
        .map(move |bits| (0..count).map(|k| f64::from(u8::from(bits >> k & 1 == 1))).collect())
}

/// Asserts that `logic` over `count` binaries is true where `truth` says so: by itself, through
/// its rows, and for the verification.
fn assert_table(
    count: usize,
    make: impl Fn(&[Variable]) -> Logic,
    truth: impl Fn(&[bool]) -> bool,
) -> Model {
    let (mut model, variables) = binaries(count);
    model.add("f", make(&variables)).unwrap();
    let lowered = reformulate::lower(&model).unwrap();
    assert_eq!(lowered.model().logical_constraint_count(), 0);
    for values in assignments(count) {
        let bits: Vec<bool> = values.iter().map(|v| *v == 1.0).collect();
        let logic = model.logical_constraints().next().unwrap().logic();
        let expected = truth(&bits);
        assert_eq!(logic.evaluate(|v| bits[v.index()]), Ok(expected), "{model} at {bits:?}");
        assert_eq!(extends(lowered.model(), &values), expected, "{model}{}", lowered.model());
        let verification = Verification::of(&model, &Point::new(&model, values).unwrap(), 1e-6);
        assert_eq!(verification.holds(), expected);
        assert!(verification.violations().iter().all(|v| v.kind == ViolationKind::Logic));
    }
    lowered.model().clone()
}

/// The rows of a lowered model.
fn rows(model: &Model) -> Vec<String> {
    let text = model.to_string();
    let lines = text.lines().skip(2).take_while(|line| *line != "where");
    lines.map(|line| line.trim().to_owned()).collect()
}

/// Asserts truth table and rows.
fn check(
    count: usize,
    make: impl Fn(&[Variable]) -> Logic,
    truth: impl Fn(&[bool]) -> bool,
    expected: &[&str],
) {
    let lowered = assert_table(count, make, truth);
    assert_eq!(rows(&lowered), expected);
}

#[test]
fn each_connective() {
    check(1, |v| v[0].into(), |b| b[0], &["f: a >= 1"]);
    check(1, |v| (!v[0]).into(), |b| !b[0], &["f: -a >= 0"]);
    check(1, |v| !!Logic::from(v[0]), |b| b[0], &["f: a >= 1"]);
    check(2, |v| v[0] & v[1], |b| b[0] && b[1], &["f: a >= 1", "f_2: b >= 1"]);
    check(2, |v| v[0] | v[1], |b| b[0] || b[1], &["f: a + b >= 1"]);
    check(2, |v| v[0].xor(v[1]), |b| b[0] != b[1], &["f: a + b = 1"]);
    check(2, |v| v[0].iff(v[1]), |b| b[0] == b[1], &["f: a - b = 0"]);
    check(2, |v| v[0].iff(!v[1]), |b| b[0] != b[1], &["f: a + b = 1"]);
    check(2, |v| v[0].implies(v[1]), |b| !b[0] || b[1], &["f: -a + b >= 0"]);
    check(2, |v| v[0].implies(!v[1]), |b| !b[0] || !b[1], &["f: -a - b >= -1"]);
    check(2, |v| !(v[0] & v[1]), |b| !(b[0] && b[1]), &["f: -a - b >= -1"]);
    check(2, |v| !(v[0] | v[1]), |b| !(b[0] || b[1]), &["f: -a >= 0", "f_2: -b >= 0"]);
    check(2, |v| !v[0].xor(v[1]), |b| b[0] == b[1], &["f: a - b = 0"]);
    check(2, |v| !v[0].implies(v[1]), |b| b[0] && !b[1], &["f: a >= 1", "f_2: -b >= 0"]);
    check(2, |v| Logic::all([v[0], v[1]]), |b| b[0] && b[1], &["f: a >= 1", "f_2: b >= 1"]);
    check(2, |v| Logic::any([v[0], v[1]]), |b| b[0] || b[1], &["f: a + b >= 1"]);
}

#[test]
fn each_cardinality() {
    let count = |b: &[bool]| b.iter().filter(|b| **b).count();
    for n in 1..=5 {
        for k in 0..=n + 1 {
            assert_table(n, |v| at_most(k, v), |b| count(b) <= k);
            if k <= n {
                assert_table(n, |v| at_least(k, v), |b| count(b) >= k);
                assert_table(n, |v| exactly(k, v), |b| count(b) == k);
                assert_table(n, |v| !exactly(k, v) | v[0], |b| count(b) != k || b[0]);
            }
            if k < n {
                assert_table(n, |v| !at_most(k, v), |b| count(b) > k);
            }
        }
    }
    check(3, |v| at_most(2, v), |b| count(b) <= 2, &["f: -a - b - c >= -2"]);
    check(4, |v| at_most(2, v), |b| count(b) <= 2, &["f: a + b + c + d <= 2"]);
    check(4, |v| at_least(2, v), |b| count(b) >= 2, &["f: a + b + c + d >= 2"]);
    check(4, |v| exactly(2, v), |b| count(b) == 2, &["f: a + b + c + d = 2"]);
    // Says nothing, so it has no row.
    check(2, |v| at_most(2, v), |_| true, &[]);
    check(2, |v| at_least(0, v), |_| true, &[]);
    // Repetitions count.
    check(1, |v| at_most(1, [v[0], v[0]]), |b| !b[0], &["f: -a >= 0"]);
}

/// Nested, but without any auxiliary variable.
#[test]
fn rows_without_auxiliaries() {
    check(
        3,
        |v| (v[0] & v[1]) | v[2],
        |b| (b[0] && b[1]) || b[2],
        &["f: a + c >= 1", "f_2: b + c >= 1"],
    );
    check(
        4,
        |v| (v[0] & v[1]) | (v[2] & v[3]),
        |b| (b[0] && b[1]) || (b[2] && b[3]),
        &["f: a + c >= 1", "f_2: a + d >= 1", "f_3: b + c >= 1", "f_4: b + d >= 1"],
    );
    // A relaxed count stays one row: with d on, it says nothing.
    check(
        4,
        |v| v[3].on().implies(at_most(1, &v[..3])),
        |b| !b[3] || b[..3].iter().filter(|b| **b).count() <= 1,
        &["f: a + b + c + 2 d <= 3"],
    );
    check(
        3,
        |v| v[0].iff(v[1] & v[2]),
        |b| b[0] == (b[1] && b[2]),
        &["f: -a + b >= 0", "f_2: -a + c >= 0", "f_3: a - b - c >= -1"],
    );
    check(
        3,
        |v| v[0].xor(v[1]).xor(v[2]),
        |b| b[0] ^ b[1] ^ b[2],
        &[
            "f: -a - b + c >= -1",
            "f_2: -a + b - c >= -1",
            "f_3: a - b - c >= -1",
            "f_4: a + b + c >= 1",
        ],
    );
}

#[test]
fn auxiliaries_where_they_are_needed() {
    let twos = |b: &[bool]| b.chunks(3).map(|of| of.iter().all(|b| *b)).collect::<Vec<_>>();
    // Three conjunctions of three: 27 clauses, or two one-sided auxiliary binaries.
    let model =
        assert_table(9, |v| Logic::any(v.chunks(3).map(Logic::all)), |b| twos(b).contains(&true));
    assert_eq!((model.variable_count(), model.constraint_count()), (11, 9));
    // A parity of six: an integer, and one row.
    let model = assert_table(
        6,
        |v| v[1..].iter().fold(Logic::from(v[0]), |xor, b| xor.xor(b)),
        |b| b.iter().fold(false, |xor, b| xor ^ b),
    );
    assert_eq!((model.variable_count(), model.constraint_count()), (7, 1));
    // Counts of counts: both sides of each inner one.
    let model = assert_table(
        6,
        |v| exactly(1, [at_most(1, &v[..3]), at_least(2, &v[3..]), exactly(2, &v[1..4])]),
        |b| {
            let count = |of: &[bool]| of.iter().filter(|b| **b).count();
            let held = [count(&b[..3]) <= 1, count(&b[3..]) >= 2, count(&b[1..4]) == 2];
            count(&held) == 1
        },
    );
    assert!(model.variable_count() <= 6 + 5, "{model}");
}

/// Two statements with the same part share its binary.
#[test]
fn equal_parts_are_shared() {
    let (mut model, v) = binaries(8);
    let part = exactly(2, &v[..4]);
    for t in 0..3 {
        model.add(("f", t), at_least(2, [part.clone(), v[4 + t].into(), v[7].into()])).unwrap();
    }
    model.add("g", at_most(1, [!part, v[4].into(), v[7].into()])).unwrap();
    let lowered = reformulate::lower(&model).unwrap();
    assert_eq!(lowered.model().variable_count(), 9, "{}", lowered.model());
    assert_eq!(lowered.model().variables().last().unwrap().name().to_string(), "f_part1[0]");
}

/// Deep formulas of every shape stay small: rows grow with the formula, not with its expansion.
#[test]
fn deep_formulas_stay_small() {
    let steps = 25;
    let (mut model, v) = {
        let mut model = Model::new("m");
        let family = model.binary_family("v", steps + 3).unwrap();
        (model, family.as_slice().to_vec())
    };
    type Step = fn(Logic, &[Variable]) -> Logic;
    let shapes: [Step; 7] = [
        |f, v| v[0].iff(v[1] & f),
        |f, v| v[0].xor(f | v[1]),
        |f, v| !exactly(2, [f, v[0].into(), v[1].into(), v[2].into()]),
        |f, v| (v[0] & v[1]) | (v[2] & f),
        |f, v| (v[0] | f) & (v[1] | v[2]),
        |f, v| at_most(1, [!f, v[0].into(), v[1].into()]),
        |f, v| (v[0] | v[1]).iff(f),
    ];
    for (k, shape) in shapes.into_iter().enumerate() {
        let mut formula = v[0] | v[1];
        for t in 0..steps {
            formula = shape(formula, &v[t..]);
        }
        model.add(("deep", k), formula.clone()).unwrap();
        model.add(("condition", k), formula.implies(v[0].on())).unwrap();
    }
    let lowered = reformulate::lower(&model).unwrap();
    let count = lowered.model().constraint_count();
    assert!(count < 14 * 12 * steps, "{count} rows");
    // And they are right: the solver's point satisfies the formulas themselves.
    model
        .maximize(v.iter().enumerate().map(|(k, v)| f64::from(k as u32 % 3) * v).sum::<Affine>())
        .unwrap();
    let options = Options::default().with_node_limit(200);
    let solution = BranchAndBound::new(options).solve(&model).unwrap();
    assert!(solution.verification().is_none_or(Verification::holds));
}

#[test]
fn what_is_refused() {
    let (mut model, v) = binaries(2);
    let x = model.integer("x", 0.0, 1.0).unwrap();
    let mut other = Model::new("other");
    let foreign = other.binary_family("z", 5).unwrap()[4];
    let text = |error: Error| error.to_string();
    let mut refused = |logic: Logic| text(model.add("f", logic).unwrap_err());
    assert_eq!(
        refused(v[0] | x),
        "`x` is not binary; conditions and logic, as in `f`, take binary variables only"
    );
    assert_eq!(
        refused(v[0] & foreign),
        "variable number 4 used in `f` belongs to another model or system; use a handle only with \
         the one that created it (or a clone of it), and take handles of a system at a sample with \
         `at`"
    );
    let none: [Variable; 0] = [];
    for empty in [Logic::all(none), Logic::any(none), at_most(1, none), at_least(1, none)] {
        assert_eq!(
            refused(empty),
            "the logic of `f` contains no binary variable; drop the statement, or check the list \
             it was built from"
        );
    }
    let impossible = "statement `f` can never hold, whatever the values of its binaries; check \
                      its counts, and look for binaries combined with their own negation";
    for never in [at_least(3, &v), exactly(3, &v), v[0] & !v[0], v[0].xor(v[0]), v[0].iff(!v[0])] {
        assert_eq!(refused(never), impossible);
    }
    // A part that can never hold is no error.
    model.add("f", at_least(3, &v) | v[1]).unwrap();
    assert_eq!(rows(reformulate::lower(&model).unwrap().model()), ["f: b >= 1"]);
    assert_eq!(
        text(model.add("f", v[0] | v[1]).unwrap_err()),
        "the name `f` is already taken by another statement; choose another one"
    );
    assert_eq!(
        text(model.logical_constraint_by_name("g").unwrap_err()),
        "the model has no logic statement named `g`"
    );
    assert_eq!(
        text(carom::model::mps::write(&model).unwrap_err()),
        "MPS cannot express the logic of `f`; write the lowered model instead \
         (`reformulate::lower(&model)?.model()`)"
    );
}

/// A formula inside so many alternating levels of `&` and `|`.
fn nested(logic: &Logic, levels: u32, v: &[Variable]) -> Logic {
    let wrap = |inside, level| if level % 2 == 0 { inside & v[0] } else { inside | v[1] };
    (0..levels).fold(logic.clone(), wrap)
}

#[test]
fn chains_stay_flat_and_deep_formulas_are_refused() {
    let (mut model, b) = binaries(2);
    let (mut or, mut xor, mut not) = (b[0] | b[1], b[0].xor(b[1]), Logic::from(b[0]));
    for _ in 0..20_000 {
        or = or | b[0];
        not = !not;
    }
    for _ in 0..500 {
        xor = xor.xor(b[1]);
    }
    let limit = 100;
    for (logic, depth) in [(or, 2), (xor, 2), (not, 1)] {
        model.clone().add("deep", nested(&logic, limit - depth, &b)).unwrap();
        let error = model.add("deep", nested(&logic, limit - depth + 1, &b)).unwrap_err();
        assert_eq!(error, Error::from(ErrorKind::TooDeep { name: "deep".into(), limit }));
    }
    // What cannot be added has no value either: a tautology is not false.
    let always = b[0] | !b[0];
    let fine = nested(&always, limit - 2, &b);
    assert_eq!(fine.evaluate(|_| true), Ok(true));
    for levels in [limit - 1, 40_000] {
        let error = nested(&always, levels, &b).evaluate(|_| true).unwrap_err();
        let text = "the logic of `the formula` is nested more than 100 levels deep; define parts of it \
                    with binaries of their own (`part.iff(...)`)";
        assert_eq!(error.to_string(), text);
    }
    let error = model.add("deep", nested(&b[0].into(), 40_000, &b)).unwrap_err();
    assert_eq!(error, Error::from(ErrorKind::TooDeep { name: "deep".into(), limit }));
}

/// The text form shows what was written.
#[test]
fn texts() {
    let (mut model, v) = binaries(3);
    model.add("f0", !(v[0] & !v[1]) | v[2]).unwrap();
    model.add("f1", v[0].implies(at_most(1, [v[1] | v[2], v[0].into()]))).unwrap();
    model.add("f2", !v[0].iff(v[1])).unwrap();
    model.add("f3", v[0].iff(v[1].xor(v[2]))).unwrap();
    model.add("f4", v[0].off()).unwrap();
    assert_eq!(
        rows(&model),
        [
            "f0: !(a & !b) | c",
            "f1: a implies at_most(1, b | c, a)",
            "f2: a xor b",
            "f3: !(a xor b xor c)",
            "f4: !a",
        ]
    );
    assert_eq!((v[0] | v[2]).to_string(), "#0 | #2");
}

/// Logic and a cost: the best assignment is found.
#[test]
fn a_solve() {
    let (mut model, v) = binaries(6);
    model.add("one", exactly(1, &v[..3])).unwrap();
    model.add("then", v[1].implies((v[3] & v[4]) | v[5])).unwrap();
    model.add("odd", v[3].xor(v[4]).xor(v[5]).xor(v[0]).xor(v[2])).unwrap();
    model.add("never", !(v[0] | v[2])).unwrap();
    model.minimize(3.0 * v[5] + v[3] + v[4]).unwrap();
    let solution = BranchAndBound::default().solve(&model).unwrap();
    assert!(solution.is_optimal());
    assert!((solution.objective().unwrap() - 3.0).abs() < 1e-6);
    assert_eq!(solution.point().unwrap().as_slice().len(), 6);
}

// -- random formulas ----------------------------------------------------------------------------

/// A formula as data, with a meaning of its own.
#[derive(Debug, Clone)]
enum Tree {
    Leaf(usize, bool),
    Not(Box<Tree>),
    Pair(u8, Box<Tree>, Box<Tree>),
    Count(u8, usize, Vec<Tree>),
}

const BINARIES: usize = 5;

fn tree() -> impl Strategy<Value = Tree> {
    let leaf = (0..BINARIES, any::<bool>()).prop_map(|(k, on)| Tree::Leaf(k, on));
    leaf.prop_recursive(4, 16, 4, |inner| {
        let pair = (0..5_u8, inner.clone(), inner.clone())
            .prop_map(|(kind, a, b)| Tree::Pair(kind, Box::new(a), Box::new(b)));
        let count = (0..3_u8, 0..4_usize, prop::collection::vec(inner.clone(), 1..5))
            .prop_map(|(kind, k, of)| Tree::Count(kind, k, of));
        prop_oneof![1 => inner.prop_map(|t| Tree::Not(Box::new(t))), 4 => pair, 2 => count]
    })
}

impl Tree {
    fn logic(&self, v: &[Variable]) -> Logic {
        match self {
            Tree::Leaf(k, true) => v[*k].into(),
            Tree::Leaf(k, false) => v[*k].off().into(),
            Tree::Not(of) => !of.logic(v),
            Tree::Pair(kind, a, b) => {
                let (a, b) = (a.logic(v), b.logic(v));
                match kind {
                    0 => a & b,
                    1 => a | b,
                    2 => a.xor(b),
                    3 => a.iff(b),
                    _ => a.implies(b),
                }
            }
            Tree::Count(kind, k, of) => {
                let of = of.iter().map(|member| member.logic(v));
                match kind {
                    0 => at_most(*k, of),
                    1 => at_least(*k, of),
                    _ => exactly(*k, of),
                }
            }
        }
    }

    fn truth(&self, b: &[bool]) -> bool {
        match self {
            Tree::Leaf(k, on) => b[*k] == *on,
            Tree::Not(of) => !of.truth(b),
            Tree::Pair(kind, x, y) => {
                let (x, y) = (x.truth(b), y.truth(b));
                match kind {
                    0 => x && y,
                    1 => x || y,
                    2 => x != y,
                    3 => x == y,
                    _ => !x || y,
                }
            }
            Tree::Count(kind, k, of) => {
                let count = of.iter().filter(|member| member.truth(b)).count();
                match kind {
                    0 => count <= *k,
                    1 => count >= *k,
                    _ => count == *k,
                }
            }
        }
    }
}

proptest! {
    #![proptest_config(config(400, "tests/regressions/logic.txt"))]

    #[test]
    fn rows_are_the_truth_set(tree in tree()) {
        let (mut model, v) = binaries(BINARIES);
        let logic = tree.logic(&v);
        let bits = |values: &[f64]| values.iter().map(|v| *v == 1.0).collect::<Vec<_>>();
        match model.add("f", logic.clone()) {
            Err(error) => {
                let never = matches!(error.kind(), ErrorKind::NeverTrue { .. });
                prop_assert!(never, "{}", error);
                for values in assignments(BINARIES) {
                    prop_assert!(!tree.truth(&bits(&values)));
                }
            }
            Ok(_) => {
                let lowered = reformulate::lower(&model).unwrap();
                prop_assume!(lowered.model().variable_count() <= BINARIES + 8);
                let file = carom::model::mps::write(lowered.model()).unwrap();
                let again = carom::model::mps::read(&file).unwrap().model;
                prop_assert_eq!(again.to_string(), lowered.model().to_string());
                for values in assignments(BINARIES) {
                    let expected = tree.truth(&bits(&values));
                    prop_assert_eq!(logic.evaluate(|v| values[v.index()] == 1.0), Ok(expected));
                    let found = extends(lowered.model(), &values);
                    prop_assert_eq!(found, expected, "{:?}\n{}{}", values, model, lowered.model());
                }
            }
        }
    }

    /// As a condition: the row must hold exactly where the formula is true.
    #[test]
    fn conditions(tree in tree(), negated in any::<bool>()) {
        let (mut model, v) = binaries(BINARIES);
        let x = model.continuous("x", -2.0, 3.0).unwrap();
        let condition = if negated { !tree.logic(&v) } else { tree.logic(&v) };
        model.add("f", condition.implies((2.0 * x + 1.0 * v[0]).within(0.0, 1.0))).unwrap();
        let lowered = reformulate::lower(&model).unwrap();
        prop_assume!(lowered.model().variable_count() <= BINARIES + 7);
        for mut values in assignments(BINARIES) {
            let bits: Vec<bool> = values.iter().map(|v| *v == 1.0).collect();
            values.push(0.0);
            for x in [-2.0, -0.5, 0.0, 0.5, 1.0, 3.0] {
                values[BINARIES] = x;
                let inside = (0.0..=1.0).contains(&(2.0 * x + values[0]));
                let expected = inside || tree.truth(&bits) == negated;
                let found = extends(lowered.model(), &values);
                prop_assert_eq!(found, expected, "{:?}\n{}{}", values, model, lowered.model());
                let point = Point::new(&model, values.clone()).unwrap();
                prop_assert_eq!(Verification::of(&model, &point, 1e-6).holds(), expected);
            }
        }
    }
}

/// In expressions a condition is 1 where it holds.
#[test]
fn conditions_are_numbers() {
    let (mut model, b) = binaries(3);
    let first = 3.0 * b[0].on() + b[1].off() - 2.0 * b[2].off();
    let same = 3.0 * b[0] + (1.0 - b[1]) - 2.0 * (1.0 - b[2]);
    assert_eq!(first, same);
    assert_eq!(b.iter().map(|b| b.off()).sum::<Affine>(), 3.0 - b[0] - b[1] - b[2]);
    assert_eq!(b[0].off().le(b[1].on()), (1.0 - b[0]).le(b[1]));
    assert_eq!(-b[0].off(), b[0] - 1.0);
    let mut total = b[0] * b[1];
    total += b[2].off();
    assert_eq!(total, b[0] * b[1] + 1.0 - b[2]);
    model.add("most", (b[0].on() + b[1].off()).le(1.0)).unwrap();
    model.maximize(b[0].on() + 0.5 * b[1].off()).unwrap();
    let solution = BranchAndBound::default().solve(&model).unwrap();
    assert_eq!(solution.objective(), Some(1.0));
}
