//! Special ordered sets and semi-continuous variables: what they mean, against enumeration of all
//! ways to be 0.

use crate::common::config;
use carom::ErrorKind;
use carom::explain::{
    ElasticOptions, ExplainOptions, elastic_relaxation, infeasibility, violations,
};
use carom::model::{Method, Reformulation, sos1, sos2};
use carom::prelude::*;
use carom::reformulate;
use proptest::prelude::*;

/// Kind and limits of a variable.
type Plan = (u8, f64, f64);

/// How many may be other than 0, and the members in their order.
type Set = (bool, Vec<usize>);

#[derive(Debug, Clone)]
struct Program {
    variables: Vec<Plan>,
    sets: Vec<Set>,
    row: Vec<i32>,
    limit: i32,
    cost: Vec<i32>,
}

fn programs() -> impl Strategy<Value = Program> {
    let end = (-8..=8_i32).prop_map(|n| f64::from(n) / 2.0);
    let variable = (0..5_u8, end.clone(), end).prop_map(|(k, a, b)| (k, a.min(b), a.max(b)));
    (2..=4_usize).prop_flat_map(move |n| {
        let order = Just((0..n).collect::<Vec<_>>()).prop_shuffle();
        let set = (any::<bool>(), order, 1..=n).prop_map(|(second, mut order, count)| {
            order.truncate(count);
            (second, order)
        });
        (
            prop::collection::vec(variable.clone(), n),
            prop::collection::vec(set, 0..3),
            prop::collection::vec(-3..=3_i32, n),
            -6..=6_i32,
            prop::collection::vec(-3..=3_i32, n),
        )
            .prop_map(|(variables, sets, row, limit, cost)| Program {
                variables,
                sets,
                row,
                limit,
                cost,
            })
    })
}

fn finish(model: &mut Model, x: &[Variable], program: &Program) -> Result<(), Error> {
    let sum = |factors: &[i32]| -> Affine {
        factors.iter().zip(x).map(|(&a, &x)| f64::from(a) * x).sum()
    };
    if program.row.iter().any(|&a| a != 0) {
        model.add("row", sum(&program.row).ge(f64::from(program.limit)))?;
    }
    model.minimize(sum(&program.cost))
}

fn stated(program: &Program) -> Result<Model, Error> {
    let mut model = Model::new("stated");
    let mut x = Vec::new();
    for (k, &(kind, lower, upper)) in program.variables.iter().enumerate() {
        x.push(match kind {
            0 => model.continuous(("x", k), lower, upper)?,
            1 => model.integer(("x", k), lower, upper)?,
            2 => model.semicontinuous(("x", k), lower, upper)?,
            3 => model.semiinteger(("x", k), lower, upper)?,
            _ => model.binary(("x", k))?,
        });
    }
    for (k, (second, members)) in program.sets.iter().enumerate() {
        let members = members.iter().zip(1..).map(|(&j, weight)| (x[j], f64::from(weight)));
        model.add(("set", k), if *second { sos2(members) } else { sos1(members) })?;
    }
    finish(&mut model, &x, program)?;
    Ok(model)
}

/// The least cost over all ways to be 0, each a model of rows.
fn enumerated(program: &Program) -> Option<f64> {
    let n = program.variables.len();
    let mut best: Option<f64> = None;
    for pattern in 0..1_u32 << n {
        let other = |j: usize| pattern >> j & 1 == 1;
        let fits = program.sets.iter().all(|(second, members)| {
            let places: Vec<usize> = (0..members.len()).filter(|&k| other(members[k])).collect();
            match places[..] {
                [] | [_] => true,
                [a, b] => *second && b == a + 1,
                _ => false,
            }
        });
        if !fits {
            continue;
        }
        let mut model = Model::new("pattern");
        let (mut x, mut possible) = (Vec::new(), true);
        for (k, &(kind, lower, upper)) in program.variables.iter().enumerate() {
            let (lower, upper) = if kind == 4 { (0.0, 1.0) } else { (lower, upper) };
            let zero = matches!(kind, 2 | 3) || lower <= 0.0 && 0.0 <= upper;
            possible &= other(k) || zero;
            let (lower, upper) = if other(k) { (lower, upper) } else { (0.0, 0.0) };
            x.push(match kind {
                0 | 2 => model.continuous(("x", k), lower, upper).unwrap(),
                _ => model.integer(("x", k), lower, upper).unwrap(),
            });
        }
        finish(&mut model, &x, program).unwrap();
        if possible && let Some(cost) = BranchAndBound::default().solve(&model).unwrap().objective()
        {
            best = Some(best.map_or(cost, |best| best.min(cost)));
        }
    }
    best
}

proptest! {
    #![proptest_config(config(96, "tests/regressions/ordered_sets.txt"))]

    #[test]
    fn sets_mean_what_enumeration_finds(program in programs(), programs in any::<bool>()) {
        let mut model = stated(&program).unwrap();
        model.set_reformulation(Reformulation::default().with_linear_programs(programs));
        let solution = BranchAndBound::default().solve(&model).unwrap();
        match enumerated(&program) {
            None => prop_assert!(solution.is_infeasible(), "{solution:?}\n{model}"),
            Some(best) => {
                let found = solution.objective().unwrap_or(f64::INFINITY);
                prop_assert!((found - best).abs() < 1e-5, "{found} {best}\n{model}");
                prop_assert!(solution.verification().unwrap().holds());
            }
        }
    }
}

#[test]
fn a_set_is_part_of_the_text_and_of_the_serial_form() {
    let mut model = Model::new("m");
    let x = model.continuous_family("x", 3, -1.0, 2.0).unwrap();
    let set = model.add("near", sos2(x.iter().zip([3.0, 0.5, -1.0]))).unwrap();
    let pump = model.semicontinuous("pump", 2.0, 5.0).unwrap();
    let count = model.semiinteger("count", 3.0, f64::INFINITY).unwrap();
    model.set_bounds(pump, 0.0, 4.0).unwrap();
    let text = "minimize 0\nsubject to\n  near: sos2(x[2]: -1, x[1]: 0.5, x[0]: 3)\nwhere\n  \
                -1 <= x[0] <= 2\n  -1 <= x[1] <= 2\n  -1 <= x[2] <= 2\n  \
                0 <= pump <= 4, pump = 0 or 2 <= pump <= 5\n  count = 0 or count >= 3 integer\n";
    assert_eq!(model.to_string(), text);
    assert_eq!(model.special_ordered_set_by_name("near"), Ok(set));
    let values = |v| model.variable_ref(v).unwrap().semicontinuous().unwrap();
    assert_eq!((values(count).lower, values(pump).upper), (3.0, 5.0));
    #[cfg(feature = "serde")]
    {
        let text = serde_json::to_string(&model).unwrap();
        let again: Model = serde_json::from_str(&text).unwrap();
        assert_eq!(again.to_string(), model.to_string());
        for bad in [("\"most\":2", "\"most\":3"), ("\"upper\":5.0", "\"upper\":1.0")] {
            assert!(serde_json::from_str::<Model>(&text.replace(bad.0, bad.1)).is_err(), "{bad:?}");
        }
    }
}

#[test]
fn what_a_set_refuses() {
    let mut model = Model::new("m");
    let x = model.continuous_family("x", 3, -1.0, 2.0).unwrap();
    let foreign = Model::new("other").continuous("x", 0.0, 1.0).unwrap();
    let mut refused = |set| model.add("set", set).unwrap_err().to_string();
    assert_eq!(refused(sos1([])), "the number of members of `set` is 0; it must be at least 1");
    assert_eq!(
        refused(sos2([(x[0], 1.0), (x[1], 2.0), (x[0], 3.0)])),
        "how often `x[0]` is in `set` is 2; it must be 1"
    );
    assert_eq!(
        refused(sos2([(x[0], 1.0), (x[2], 2.0), (x[1], 2.0)])),
        "the weight of `x[1]` in `set` is 2; it must be different from that of `x[2]`, because \
         weights order the set"
    );
    assert_eq!(refused(sos1([(x[0], f64::NAN)])), "a weight of `set` is NaN; give a finite number");
    assert!(refused(sos1([(foreign, 1.0)])).contains("belongs to another model"));
    model.add("set", sos1([(x[0], 1.0), (x[1], 1.0)])).unwrap();
    assert!(matches!(
        model.add("set", sos1([(x[0], 1.0)])).unwrap_err().kind(),
        ErrorKind::DuplicateName { .. }
    ));
}

#[test]
fn missing_bounds_are_named() {
    let mut model = Model::new("m");
    let x = model.continuous_family("x", 2, -1.0, 2.0).unwrap();
    let open = model.continuous("open", 0.0, f64::INFINITY).unwrap();
    model.add("one", sos1([(x[0], 1.0), (open, 2.0)])).unwrap();
    let error = BranchAndBound::default().solve(&model).unwrap_err();
    assert_eq!(
        error.to_string(),
        "`one` cannot be written as rows, because `open` has no upper bound; give `open` a finite \
         one"
    );
    let mut model = Model::new("m");
    model.semicontinuous("pump", 1.0, f64::INFINITY).unwrap();
    model.semicontinuous("valve", 0.0, f64::INFINITY).unwrap();
    let error = reformulate::lower(&model).unwrap_err();
    assert_eq!(
        error.to_string(),
        "`pump` cannot be written as rows, because `pump` has no upper bound; give `pump` a finite \
         one"
    );
}

#[test]
fn binaries_are_shared_and_added_only_if_needed() {
    let mut model = Model::new("m");
    let pump = model.semicontinuous("pump", 2.0, 5.0).unwrap();
    let valve = model.continuous("valve", -1.0, 3.0).unwrap();
    let on = model.binary("on").unwrap();
    model.semicontinuous("flow", -1.0, 4.0).unwrap();
    model.semiinteger("count", 1.0, 4.0).unwrap();
    let always = model.semicontinuous("always", 1.0, 4.0).unwrap();
    model.set_bounds(always, 0.5, 3.0).unwrap();
    model.add("one", sos1([(pump, 1.0), (valve, 2.0), (on, 3.0)])).unwrap();
    model.add("other", sos1([(pump, 1.0), (valve, 2.0)])).unwrap();
    model.add("pair", sos2([(valve, 1.0), (always, 2.0)])).unwrap();
    let lowered = reformulate::lower(&model).unwrap();
    let text = lowered.model().to_string();
    let expected = "minimize 0\nsubject to\n  \
                    pump_upper: pump - 5 pump_nonzero1 <= 0\n  \
                    pump_lower: pump - 2 pump_nonzero1 >= 0\n  \
                    valve_lower: valve + valve_nonzero1 >= 0\n  \
                    valve_upper: valve - 3 valve_nonzero1 <= 0\n  \
                    one: on + pump_nonzero1 + valve_nonzero1 <= 1\n  \
                    other: pump_nonzero1 + valve_nonzero1 <= 1\nwhere\n";
    assert!(text.starts_with(expected), "{text}");
    assert!(text.contains("\n  1 <= always <= 3\n"), "{text}");
    assert!(lowered.report().to_string().contains("pump upper: M = 5 from bounds"));
}

#[test]
fn points_are_checked_by_meaning() {
    let mut model = Model::new("m");
    let x = model.continuous_family("x", 4, -1.0, 2.0).unwrap();
    model.semicontinuous("pump", 2.0, 5.0).unwrap();
    model.add("pair", sos2(x.iter().zip([1.0, 2.0, 3.0, 4.0]))).unwrap();
    model.add("one", sos1([(x[0], 1.0), (x[3], 2.0)])).unwrap();
    let found = |values: &[f64]| -> Vec<String> {
        let found = violations(&model, values, 1e-6).unwrap();
        found.iter().map(ToString::to_string).collect()
    };
    assert_eq!(found(&[0.0, -1.0, 2.0, 0.0, 3.0]), [""; 0]);
    assert_eq!(found(&[0.0, 1e-7, 2.0, 1.0, 0.0]), [""; 0]);
    assert_eq!(found(&[0.5, 0.0, 2.0, 0.0, 0.0]), ["the ordered set `pair` by 0.5"]);
    assert_eq!(
        found(&[0.5, 0.0, 0.0, -0.25, 1.5]),
        [
            "the semi-continuity of `pump` by 0.5",
            "the ordered set `pair` by 0.25",
            "the ordered set `one` by 0.25"
        ]
    );
    assert_eq!(
        found(&[0.5, 0.5, 0.5, 0.0, 0.125]),
        ["the ordered set `pair` by 0.5", "the semi-continuity of `pump` by 0.125"]
    );
}

#[test]
fn explanations_know_sets() {
    for second in [false, true] {
        let mut model = Model::new("m");
        let x = model.continuous_family("x", 3, -1.0, 2.0).unwrap();
        let members = x.iter().zip([1.0, 2.0, 3.0]);
        model.add("set", if second { sos2(members) } else { sos1(members) }).unwrap();
        model.add("first", x[0].ge(1.0)).unwrap();
        model.add("last", x[2].ge(1.5)).unwrap();
        model.add("else", x[1].le(1.0)).unwrap();
        let mut solver = BranchAndBound::default();
        let why = infeasibility(&model, &ExplainOptions::default(), &mut solver).unwrap();
        let text = why.to_string();
        for name in ["set", "first", "last"] {
            assert!(text.contains(name), "{text}");
        }
        assert!(!text.contains("else"), "{text}");
        let options =
            ElasticOptions::default().with_weight("first", 10.0).with_weight("last", 10.0);
        let relaxed = elastic_relaxation(&model, &options, &mut solver).unwrap();
        assert_eq!(relaxed.to_string(), "drop `set`");
        let options = ElasticOptions::default().with_weight("set", 10.0);
        let relaxed = elastic_relaxation(&model, &options, &mut solver).unwrap();
        assert_eq!(relaxed.to_string(), "lower `first` by 1");
    }
}

/// A function is not relaxed to one side if a set holds its variable.
#[test]
fn sets_keep_functions_exact() {
    let mut model = Model::new("m");
    let x = model.continuous("x", -2.0, 2.0).unwrap();
    let y = model.continuous("y", 0.0, 2.0).unwrap();
    let size = model.absolute("size", x).unwrap();
    model.add("one", sos1([(size, 1.0), (y, 2.0)])).unwrap();
    model.maximize(y + 0.5 * x).unwrap();
    for method in Method::ALL {
        model.set_reformulation(Reformulation::default().with_method(method));
        let solution = BranchAndBound::default().solve(&model).unwrap();
        assert!((solution.objective().unwrap() - 2.0).abs() < 1e-6);
    }
}
