//! Random programs with one continuous column: where it may be rounded, its whole values are
//! enough.

use crate::log::verdict;
use proptest::prelude::*;
use std::fmt::Write as _;

/// Sides, and coefficients of two binaries and of the column.
type Row = (Option<i32>, Option<i32>, [i32; 3]);

/// The least objective over both binaries and the column, which is whole if that is asked for.
fn best(rows: &[Row], bounds: [f64; 2], costs: [i32; 3], is_whole: bool) -> f64 {
    let mut best = f64::INFINITY;
    for [x, y] in [[0, 0], [0, 1], [1, 0], [1, 1]] {
        let [mut least, mut most] = bounds;
        for &(lower, upper, [a, b, c]) in rows {
            let rest = a * x + b * y;
            let lower = lower.map_or(f64::NEG_INFINITY, |side| f64::from(side - rest));
            let upper = upper.map_or(f64::INFINITY, |side| f64::from(side - rest));
            let (from, to) = match f64::from(c) {
                c if c > 0.0 => (lower / c, upper / c),
                c if c < 0.0 => (upper / c, lower / c),
                _ if lower > 0.0 || upper < 0.0 => (f64::INFINITY, f64::NEG_INFINITY),
                _ => (f64::NEG_INFINITY, f64::INFINITY),
            };
            (least, most) = (least.max(from), most.min(to));
        }
        if is_whole {
            (least, most) = ((least - 1e-9).ceil(), (most + 1e-9).floor());
        }
        if least <= most {
            let z = if costs[2] >= 0 { least } else { most };
            best = best.min(f64::from(costs[0] * x + costs[1] * y) + f64::from(costs[2]) * z);
        }
    }
    best
}

fn log(rows: &[Row], bounds: [f64; 2], costs: [i32; 3], side: &str) -> String {
    let entries = |[a, b, c]: [i32; 3]| format!("3 0 {a} 1 {b} 2 {c}");
    let mut log = "carom proof 1\nsense min\ncolumns 3\nc i 0 1 x\nc i 0 1 y\n".to_string();
    let _ = writeln!(log, "c c {} {} z\nrows {}", bounds[0], bounds[1], rows.len());
    for (lower, upper, row) in rows {
        let lower = lower.map_or("-inf".to_string(), |side| side.to_string());
        let upper = upper.map_or("inf".to_string(), |side| side.to_string());
        let _ = writeln!(log, "r {lower} {upper} {}", entries(*row));
    }
    let costs = entries(costs);
    log + &format!(
        "cones 0\nobjective 0\ng {costs}\nh 0\nclaim bound 9\nproof\nu 2 {side}\nend 1\n"
    )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(3000))]

    #[test]
    fn a_column_that_may_be_rounded_loses_nothing(
        rows in prop::collection::vec(
            (
                prop::option::of(-3_i32..4),
                prop::option::of(-3_i32..4),
                prop::array::uniform3(-2_i32..3),
            ),
            1..4,
        ),
        bounds in (-2_i32..3, 0_i32..5),
        costs in prop::array::uniform3(-2_i32..3),
    ) {
        let bounds = [f64::from(bounds.0) / 2.0, f64::from(bounds.0 + bounds.1) / 2.0];
        for side in ["L", "U"] {
            let said = verdict(&log(&rows, bounds, costs, side));
            if said == "rejected: the claim is not proved: context 0 is not closed" {
                let [any, whole] = [false, true].map(|is| best(&rows, bounds, costs, is));
                let is_same = any == whole || (any - whole).abs() < 1e-6;
                prop_assert!(is_same, "{any} {whole} {side} {rows:?} {bounds:?} {costs:?}");
            }
        }
    }
}
