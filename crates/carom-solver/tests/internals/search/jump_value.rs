//! The value to which a column jumps.

use carom::model::Model;
use carom_solver::internals::program::Program;
use carom_solver::internals::search::heuristics::Kinks;
use proptest::prelude::*;

use crate::common::config;

/// A row `lower <= a x + rest <= upper` with a weight; a limit of 9 is none.
type RandomRow = (i32, i32, i32, i32, u32);

fn limits((_, _, lower, room, _): RandomRow) -> [f64; 2] {
    let infinite = |limit: i32, none: f64| if limit.abs() >= 9 { none } else { f64::from(limit) };
    let upper = if room == 9 { 9 } else { (lower + room).min(8) };
    [infinite(lower, f64::NEG_INFINITY), infinite(upper, f64::INFINITY)]
}

fn violation(rows: &[RandomRow], x: f64) -> f64 {
    let of_row = |&row: &RandomRow| {
        let (a, rest, .., weight) = row;
        let (activity, [lower, upper]) = (f64::from(a) * x + f64::from(rest), limits(row));
        f64::from(weight) * (lower - activity).max(activity - upper).max(0.0)
    };
    rows.iter().map(of_row).sum()
}

proptest! {
    #![proptest_config(config(400, "tests/regressions/jump_value.txt"))]

    /// No other value of a fine grid is violated less, and the grid has all kinks.
    #[test]
    fn no_value_is_violated_less(
        rows in prop::collection::vec(
            (prop_oneof![-4..=-1, 1..=4], -5..=5, -9..=8, 0..=9, 1..=3_u32), 1..6),
        x in -6..=6,
    ) {
        let says = |row: &RandomRow| limits(*row).iter().any(|limit| limit.is_finite());
        let rows: Vec<RandomRow> = rows.into_iter().filter(says).collect();
        let mut model = Model::new("rows");
        let column = model.continuous("x", -6.0, 6.0).unwrap();
        for (k, &row) in rows.iter().enumerate() {
            let rest = model.continuous(("rest", k), -9.0, 9.0).unwrap();
            let [lower, upper] = limits(row);
            let sum = f64::from(row.0) * column + rest;
            model.add(("row", k), sum.within(lower, upper)).unwrap();
        }
        let program = Program::assemble(&model).unwrap();
        let x = f64::from(x);
        let weight_and_activity =
            |i: usize| (f64::from(rows[i].4), f64::from(rows[i].0) * x + f64::from(rows[i].1));
        let least = Kinks::default().least(&program, 0, x, [-6.0, 6.0], weight_and_activity);
        prop_assert!((-6.0..=6.0).contains(&least));
        let found = violation(&rows, least);
        for k in -72..=72 {
            let other = f64::from(k) / 12.0;
            prop_assert!(found <= violation(&rows, other) + 1e-9, "{least} {other}");
        }
    }
}
