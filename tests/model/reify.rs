//! Indicators both ways, on conjunctions of rows and under compound conditions: feasible sets on a
//! grid are those of the definition.
//!
//! Data are whole numbers and halves, so sets are compared without any tolerance.

use crate::common::config;
use crate::common::rows::extends;
use carom::ErrorKind;
use carom::prelude::*;
use carom::reformulate;
use proptest::prelude::*;

const INF: f64 = f64::INFINITY;

/// Points of a box in steps of a half.
fn grid(lower: i32, upper: i32) -> impl Iterator<Item = f64> + Clone {
    (2 * lower..=2 * upper).map(|k| 0.5 * f64::from(k))
}

proptest! {
    #![proptest_config(config(200, "tests/regressions/reify.txt"))]

    /// `z` is 1 exactly where the row holds; the open strips beside its limits are excluded.
    #[test]
    fn reified_rows(
        p in -3..=3_i32,
        q in prop_oneof![-2..=-1_i32, 1..=2],
        limit in -5..=5_i32,
        width in 0..=3_i32,
        sides in 0..3,
        margin in 1..=4_i32,
        on in any::<bool>(),
    ) {
        let mut model = Model::new("m");
        let z = model.binary("z").unwrap();
        let x = model.continuous("x", -2.0, 2.0).unwrap();
        let y = model.continuous("y", -1.0, 2.0).unwrap();
        let (lower, upper) = match sides {
            0 => (-INF, f64::from(limit)),
            1 => (f64::from(limit), INF),
            _ => (f64::from(limit), f64::from(limit + width)),
        };
        let margin = 0.5 * f64::from(margin);
        let row = (f64::from(p) * x + f64::from(q) * y).within(lower, upper);
        let condition = if on { z.on() } else { z.off() };
        let reified = model.add("near", condition.reify(row, margin)).unwrap();
        prop_assert_eq!(reified.above.is_some(), sides == 2);
        prop_assert_eq!(reified.otherwise.len(), if sides == 2 { 2 } else { 1 });
        let lowered = reformulate::lower(&model).unwrap();
        for x in grid(-2, 2) {
            for y in grid(-1, 2) {
                let sum = f64::from(p) * x + f64::from(q) * y;
                let within = lower <= sum && sum <= upper;
                let outside = sum >= upper + margin || sum <= lower - margin;
                for z in [0.0, 1.0] {
                    let expected = if (z == 1.0) == on { within } else { outside };
                    // The side of a two-sided row is a free choice.
                    let found = extends(lowered.model(), &[z, x, y]);
                    prop_assert_eq!(found, expected, "{} {} {}\n{}", z, x, y, model);
                }
            }
        }
    }
}

#[test]
fn two_sided_rows_fail_on_either_side() {
    let mut model = Model::new("m");
    let z = model.binary("z").unwrap();
    let ready = model.binary("ready").unwrap();
    let x = model.continuous("x", -10.0, 10.0).unwrap();
    model.add(("at", 3), (z & ready).reify(x.equals(1.0), 0.25)).unwrap();
    assert_eq!(
        model.to_string(),
        "minimize 0\nsubject to\n  \
           at[3]: (z & ready) implies x = 1\n  \
           at_else_above[3]: at_above[3] = 1 implies x >= 1.25\n  \
           at_else_below[3]: (!(z & ready) & !at_above[3]) implies x <= 0.75\n  \
           at_above[3]: at_above[3] implies !(z & ready)\n\
         where\n  z binary\n  ready binary\n  -10 <= x <= 10\n  at_above[3] binary\n"
    );
    let mut best = |sense: Sense, on: bool| {
        model.fix(z, f64::from(u8::from(on))).unwrap();
        model.add(format!("ready{on}{sense:?}"), ready.ge(1.0)).unwrap();
        model.set_objective(sense, (x - 1.0) * 1.0).unwrap();
        let solution = BranchAndBound::default().solve(&model).unwrap();
        assert!(solution.verification().unwrap().holds());
        solution.objective().unwrap()
    };
    assert!(best(Sense::Maximize, true).abs() < 1e-6);
    assert!((best(Sense::Maximize, false) - 9.0).abs() < 1e-6);
    assert!((best(Sense::Minimize, false) + 11.0).abs() < 1e-6);
    model.minimize((x - 1.0).square()).unwrap();
    let solution = BranchAndBound::default().solve(&model).unwrap();
    assert!((solution.objective().unwrap() - 0.0625).abs() < 1e-6);
}

#[test]
fn conjunctions_of_rows() {
    let mut model = Model::new("m");
    let z = model.binary("z").unwrap();
    let armed = model.binary("armed").unwrap();
    let x = model.continuous("x", -2.0, 2.0).unwrap();
    let y = model.continuous("y", -2.0, 2.0).unwrap();
    let rows = [x.within(0.0, 1.0), (x + y).equals(1.0), y.le(0.5)];
    let added = model.add("docked", (z & !armed).implies_all(rows)).unwrap();
    assert_eq!(added.len(), 3);
    let names: Vec<String> = model.indicators().map(|i| i.name().to_string()).collect();
    assert_eq!(names, ["docked", "docked_2", "docked_3"]);
    let lowered = reformulate::lower(&model).unwrap();
    for x in grid(-2, 2) {
        for y in grid(-2, 2) {
            let all = (0.0..=1.0).contains(&x) && x + y == 1.0 && y <= 0.5;
            for (z, armed) in [(0.0, 0.0), (0.0, 1.0), (1.0, 0.0), (1.0, 1.0)] {
                let expected = z == 0.0 || armed == 1.0 || all;
                assert_eq!(extends(lowered.model(), &[z, armed, x, y]), expected);
            }
        }
    }
}

/// A compound condition in the rows and in the report.
#[test]
fn rows_of_compound_conditions() {
    let mut model = Model::new("m");
    let a = model.binary("a").unwrap();
    let b = model.binary("b").unwrap();
    let x = model.continuous("x", 0.0, 10.0).unwrap();
    model.add("both", (a & !b).implies(x.le(4.0))).unwrap();
    model.add("any", (a | b).implies(x.ge(1.0))).unwrap();
    model.add("one", a.xor(b).implies(x.le(8.0))).unwrap();
    let lowered = reformulate::lower(&model).unwrap();
    let text = lowered.model().to_string();
    for row in [
        "both_upper: 6 a - 6 b + x <= 10",
        "any_lower: -a + x >= 0",
        "any_lower_: -b + x >= 0",
        "one_upper: 2 a - 2 b + x <= 10",
        "one_upper_: -2 a + 2 b + x <= 10",
    ] {
        assert!(text.contains(row), "{row}\n{text}");
    }
    assert_eq!(lowered.model().variable_count(), 3);
    assert_eq!(
        lowered.report().to_string(),
        "both upper: M = 6 from bounds (largest share: x)\n\
         any lower: M = 1 from bounds (largest share: x)\n\
         any lower: M = 1 from bounds (largest share: x)\n\
         one upper: M = 2 from bounds (largest share: x)\n\
         one upper: M = 2 from bounds (largest share: x)\n"
    );
    // A condition that always holds is a plain row; one that never holds is none.
    let mut model = Model::new("m");
    let a = model.binary("a").unwrap();
    let x = model.continuous("x", 0.0, 10.0).unwrap();
    model.add("always", (a | !a).implies(x.le(4.0))).unwrap();
    model.add("never", (a & !a).implies(x.le(3.0))).unwrap();
    let lowered = reformulate::lower(&model).unwrap();
    assert!(lowered.model().to_string().contains("subject to\n  always_upper: x <= 4\nwhere"));
}

#[test]
fn what_is_refused() {
    let mut model = Model::new("m");
    let z = model.binary("z").unwrap();
    let x = model.continuous("x", 0.0, 10.0).unwrap();
    let text = |error: Error| error.to_string();
    for margin in [0.0, -1.0, f64::NAN, INF] {
        assert_eq!(
            text(model.add("near", z.on().reify(x.le(4.0), margin)).unwrap_err()),
            format!("the margin of `near` is {margin}; it must be finite and greater than 0")
        );
    }
    assert_eq!(
        text(model.add("near", z.on().reify(x.le(4.0), 1e-18)).unwrap_err()),
        "the margin of `near` is 1e-18; it must be large enough to tell apart from \
         the row's limit in double precision"
    );
    // Errors leave nothing behind: the third name is taken, and a row is bad.
    model.add("near_else_below", x.le(9.0)).unwrap();
    let before = model.to_string();
    assert_eq!(
        text(model.add("near", z.on().reify(x.within(1.0, 2.0), 0.1)).unwrap_err()),
        "the name `near_else_below` is already taken by another statement; choose another one"
    );
    let rows = [x.le(1.0), Affine::zero().ge(3.0)];
    assert!(matches!(
        model.add("near", z.on().implies_all(rows)).unwrap_err().kind(),
        ErrorKind::FalseRow { .. }
    ));
    assert!(matches!(
        model.add("near", z.on().implies_all::<Row>([])).unwrap_err().kind(),
        ErrorKind::EmptyRow { .. }
    ));
    assert_eq!(model.to_string(), before);
    model.add("near", z.on().reify(x.le(4.0), 0.1)).unwrap();
    let no_binary: [Variable; 0] = [];
    assert!(matches!(
        model.add("empty", Logic::all(no_binary).implies(x.le(1.0))).unwrap_err().kind(),
        ErrorKind::EmptyLogic { .. }
    ));
    model.add("both", (z & x).implies(x.le(1.0))).unwrap_err();
    // A missing bound is named, through a compound condition as well.
    let free = model.continuous("free", 0.0, INF).unwrap();
    let other = model.binary("other").unwrap();
    model.add("wide", (z & other).implies(free.le(1.0))).unwrap();
    assert_eq!(
        text(reformulate::lower(&model).unwrap_err()),
        "indicator `wide` needs a big-M for its upper side, but `free` has no upper bound; give \
         `free` a finite one"
    );
}
