//! Quadratic rows and norms: products in brackets.

use carom::model::{lp, mps, norm};
use carom::prelude::*;

use super::{error, read, warned};

/// A file that maximises x + y within a disc that a row says.
fn with(row: &str) -> String {
    format!("max x + y\nst\n {row}\nbounds\n -9 <= x <= 9\n -9 <= y <= 9\nend")
}

#[track_caller]
fn check(text: &str, expected: f64) {
    let model = read(text);
    assert_eq!(model.conic_constraint_count(), 1);
    let written = lp::write(&model).unwrap();
    let again = read(&written);
    assert_eq!(lp::write(&again).unwrap(), written);
    for model in [model, again] {
        let found = BranchAndBound::default().solve(&model).unwrap().objective().unwrap();
        assert!(
            (found - expected).abs() < 1e-5 * expected.abs(),
            "{found}, not {expected}\n{written}"
        );
    }
}

#[test]
fn forms_of_rows() {
    check(&with("c: [ x ^2 + y ^2 ] <= 8"), 4.0);
    check(&with("[x^2+y^2]<8"), 4.0);
    check(&with("c: [ x ^ 2 + y * y ] =< 8"), 4.0);
    check(&with("c: 8 >= [ x ^2 + y ^2 ]"), 4.0);
    check(&with("c: - [ x ^2 + y ^2 ] >= -8"), 4.0);
    check(&with("c: [ - x ^2 - y ^2 ] >= -8"), 4.0);
    check(&with("c: [ x ^2 + x * y + y ^2 ] <= 12"), 4.0);
    check(&with("c: [ x ^2 + 2 x * y\n + y ^2 ] + [ x^2 - 2 y * x + y ^2 ] <= 16"), 4.0);
    check(&with("c: x - 2 y + [ x ^2 + y ^2 ] - x + 2 y <= 8"), 4.0);
    // x^2 + y^2 - 2 x <= 7, a disc around (1, 0).
    check(&with("c: [ x ^2 + y ^2 ] - 2 x <= 7"), 5.0);
    check(&with("c: - 2 x + [ x ^2 + y ^2 ] <= 7"), 5.0);
    // A cone with its head.
    check(
        &with("c: [ x ^2 + y ^2 - h ^2 ] <= 0").replace("end", "0 <= h <= 2.8284271247461903\nend"),
        4.0,
    );
    check(&with("c: [ x ^2 + y ^2 - h * k ] <= 0").replace("end", "h <= 4\nk <= 2\nend"), 4.0);
}

#[test]
fn conditions() {
    // A disc of radius 2 sqrt(2) where z is 1, which is worth 2; without it x + y <= 5.
    let text = |disc: &str, sum: &str| {
        format!(
            "max x + y + 2 z\nst\n c: {disc} [ x ^2 + y ^2 ] <= 8\n d: {sum} x + y <= 5\nbounds\n -9 <= x <= 9\n \
             -9 <= y <= 9\nbin z\nend"
        )
    };
    check(&text("z = 1 ->", ""), 6.0);
    check(&text("z = 0 ->", ""), 7.0);
    check(&text("z = 0 ->", "z = 1 ->"), 7.0);
    let written = lp::write(&read(&text("z = 1 ->", ""))).unwrap();
    assert!(written.contains("\n c: z = 1 -> [ x ^2 + y ^2 ] <= 8\n"), "{written}");
    let refused = error(&text("x = 1 ->", "").replace("bin z", "gen x\nbin z"));
    assert!(refused.starts_with("line 3, column 2: `x` is not binary"), "{refused}");
}

#[test]
fn a_half_behind_brackets_of_rows() {
    let (warnings, _) = warned(&with("c: [ 2 x ^2 + 2 y ^2 ] / 2 <= 8"));
    assert_eq!(
        warnings,
        [
            "line 3, column 27: taken as half of what stands in `[ ]`; some solvers refuse `/ 2` in rows"
        ]
    );
    check(&with("c: [ 2 x ^2 + 2 y ^2 ] / 2 <= 8"), 4.0);
}

#[test]
fn products_that_cancel_leave_a_linear_row() {
    let model = read(&with("c: x + [ x * y - y * x ] = 3"));
    assert_eq!((model.conic_constraint_count(), model.constraint_count()), (0, 1));
}

#[test]
fn rows_that_are_no_cones() {
    for row in ["c: [ x ^2 ] >= 1", "c: [ x * y ] <= 1", "c: x + [ - y ^2 ] <= 2"] {
        let refused = error(&with(row));
        assert!(refused.starts_with("line 3, column 2: "), "{refused}");
    }
}

#[test]
fn the_text_that_is_written() {
    let mut model = Model::new("rows");
    let v = model.continuous_family("v", 2, -1.0, 1.0).unwrap();
    let h = model.continuous("h", 0.0, 4.0).unwrap();
    model.add("plain", norm([1.0 * v[0], 2.0 * v[1]]).le(h)).unwrap();
    model.add("limit", norm([v[0] + 1.0, v[1] + 0.0]).le(h - 1.0)).unwrap();
    model.add("square", (v[0].square() - v[0] * v[1] + v[1].square()).le(4.0 * h - 1.0)).unwrap();
    model.minimize(h).unwrap();
    let expected = "\
\\ Problem name: rows
Minimize
 obj: 0 v{0} + 0 v{1} + h + 0 limit_entry0 + 0 limit_bound
Subject To
 limit_entry0: v{0} - limit_entry0 = -1
 limit_bound: h - limit_bound = 1
 plain: [ v{0} ^2 + 4 v{1} ^2 - h ^2 ] <= 0
 limit: [ v{1} ^2 + limit_entry0 ^2 - limit_bound ^2 ] <= 0
 square: - 4 h + [ v{0} ^2 - v{0} * v{1} + v{1} ^2 ] <= -1
Bounds
 -1 <= v{0} <= 1
 -1 <= v{1} <= 1
 0 <= h <= 4
 limit_entry0 free
End
";
    let text = lp::write(&model).unwrap();
    assert_eq!(text, expected);
    let again = read(&text);
    assert_eq!(mps::write(&again).unwrap(), mps::write(&model).unwrap());
}
