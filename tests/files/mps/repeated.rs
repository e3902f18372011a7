//! What files repeat or omit, taken as most readers take it, and sets and semi-continuous columns.

use super::{error, warned, with};

#[track_caller]
fn check(text: &str, warning: &str, part: &str) {
    let (warnings, model) = warned(text);
    assert_eq!(warnings, [warning], "{model}");
    assert!(model.contains(part), "{model}");
}

/// Some programs write a column again for its further entries.
#[test]
fn columns_may_go_on_in_another_place() {
    let text = |more: &str| {
        format!(
            "ROWS\n N c\n L r\n G s\nCOLUMNS\n x c 1 r 2\n y c 3 r 4\n x s 5\n{more}RHS\n B r 9 s 1\nENDATA\n"
        )
    };
    let goes_on = "line 8, column 2: column `x` began in line 6 and goes on here; its entries are taken together";
    let (warnings, model) = warned(&text(""));
    assert_eq!(warnings, [goes_on]);
    assert!(model.contains("r: 2 x + 4 y <= 9") && model.contains("s: 5 x >= 1"), "{model}");
    let (warnings, model) = warned(&text(" y s 6\n x r 7\n"));
    let others = [
        "line 9, column 2: column `y` began in line 7 and goes on here; its entries are taken together",
        "line 10, column 2: column `x` began in line 6 and goes on here; its entries are taken together",
        "line 10, column 4: column `x` has a second entry in row `r`; the first one counts",
    ];
    assert_eq!(warnings[1..], others);
    assert!(model.contains("r: 2 x + 4 y <= 9") && model.contains("s: 5 x + 6 y >= 1"), "{model}");
}

#[test]
fn the_first_of_repeated_bounds_counts() {
    check(
        &with("BOUNDS\n UP B x 4\n UP B x 5\n"),
        "line 16, column 7: the upper bound of `x` was 4 before and is 5 now; the first one counts",
        "0 <= x <= 4",
    );
    check(
        &with("BOUNDS\n UP B x 4\n FX B x 4\n FX B x 4\n LO B x 1\n"),
        "line 18, column 7: the lower bound of `x` was 4 before and is 1 now; the first one counts",
        "x = 4",
    );
    // But a binary is one wherever it is declared.
    check(
        &with("BOUNDS\n UP B k 4\n BV B k\n"),
        "line 16, column 7: the upper bound of `k` was 4 before and is 1 now; the last one counts",
        "k binary",
    );
    check(
        &with("BOUNDS\n BV B k\n UP B k 4\n"),
        "line 16, column 7: the upper bound of `k` was 1 before and is 4 now; the first one counts",
        "k binary",
    );
    check(
        &with("BOUNDS\n UP B x -1\n"),
        "line 15, column 7: `x` has a negative upper bound and no lower one, so that is -inf; some \
         solvers take 0",
        "x <= -1",
    );
}

#[test]
fn second_sets_and_unknown_names_are_ignored() {
    check(
        &with("RHS\n A most 4\n B most 5\n"),
        "line 16, column 2: a second set `B` beside `A` is ignored",
        "most: x + 2 y <= 4",
    );
    check(
        &with("BOUNDS\n UP A x 4\n UP B x 5\n"),
        "line 16, column 5: a second set `B` beside `A` is ignored",
        "0 <= x <= 4",
    );
    check(
        &with("RHS\n A most 4 none 5\n"),
        "line 15, column 11: row `none` was not declared in ROWS; the entry is ignored",
        "most: x + 2 y <= 4",
    );
    check(
        &with("BOUNDS\n UP A none 4\n"),
        "line 15, column 7: column `none` is not in COLUMNS; its bound is ignored",
        "x >= 0",
    );
    check(
        &with("RANGES\n A cost 4\n"),
        "line 15, column 9: the range of the objective row is ignored",
        "x >= 0",
    );
}

#[test]
fn repeated_entries() {
    check(
        &with("RHS\n A most 4 most 4\n"),
        "line 15, column 11: row `most` already has a right-hand side, given in line 15; the first \
         one counts",
        "most: x + 2 y <= 4",
    );
    assert_eq!(
        error(&with("RHS\n A most 4 most 5\n")),
        "line 15, column 11: row `most` already has a right-hand side, given in line 15"
    );
    check(
        &with("RANGES\n A most 4 most 5\n"),
        "line 15, column 11: row `most` already has a range, given in line 15; the first one counts",
        "most: -4 <= x + 2 y <= 0",
    );
    check(
        &with("").replace(" y most 2 same 1\n", " y most 2 same 1 most 7\n"),
        "line 10, column 18: column `y` has a second entry in row `most`; the first one counts",
        "most: x + 2 y <= 0",
    );
    assert_eq!(
        error(&with("").replace(" x least 1\n", " x least 1 cost 7\n")),
        "line 9, column 12: column `x` has a second entry in row `cost`"
    );
    check(
        &with("QUADOBJ\n x y 1\n x x 4\n y y 4\n y x 1\n"),
        "line 18, column 2: a second entry for `y` and `x`; their sum counts",
        "2 x^2 + 2 x y + 2 y^2",
    );
}

#[test]
fn comments_after_data() {
    check(
        &with("RHS\n A most 4 $ right\n"),
        "line 15, column 11: taken as a comment from here on",
        "most: x + 2 y <= 4",
    );
    check(
        &with("BOUNDS\n UP A x 4 *upper bound\n"),
        "line 15, column 11: taken as a comment from here on",
        "0 <= x <= 4",
    );
}

#[test]
fn semicontinuous_columns() {
    let kinds = |bounds: &str| warned(&with(&format!("BOUNDS\n{bounds}")));
    for bounds in [" SC B x 5\n LO B x 2\n", " LO B x 2\n SC B x 5\n", " LO x 2\n sc x 5\n"] {
        let (warnings, model) = kinds(bounds);
        assert_eq!(warnings, [""; 0]);
        assert!(model.contains("  x = 0 or 2 <= x <= 5\n"), "{model}");
    }
    assert!(kinds(" SC B x 1e30\n").1.contains("x = 0 or x >= 0\n"));
    assert!(kinds(" SI B x 5.5\n LO B x 2\n").1.contains("x = 0 or 2 <= x <= 5.5 integer\n"));
    assert!(kinds(" SC B k 1\n").1.contains("k = 0 or 0 <= k <= 1 integer\n"));
    check(
        &with("BOUNDS\n SC B x 0\n LO B x 2\n"),
        "line 16, column 7: the bounds of the semi-continuous `x` are crossed, 2 > 0, so it is 0",
        "  x = 0\n",
    );
    check(
        &with("BOUNDS\n SC B x 3\n LO B x -2\n"),
        "line 8, column 2: `x` is 0 or between -2 and 3; some solvers refuse negative values of \
         semi-continuous variables",
        "  x = 0 or -2 <= x <= 3\n",
    );
    assert_eq!(error(&with("BOUNDS\n SC B x\n")), "line 15, column 7: `x` is not a number");
}

/// Four other solvers take 0; where bounds are negative, two of them find no point at all.
#[test]
fn semicontinuous_columns_with_crossed_bounds_are_0() {
    let crossed = "line 16, column 7: the bounds of the semi-continuous `x` are crossed,";
    let doubt = "; some solvers take the program as infeasible";
    for (bounds, what) in [
        (" LO B x 0.0125\n SC B x 0.00668\n", "0.0125 > 0.00668, so it is 0"),
        (" SC B x 1\n LO B x 2\n", "2 > 1, so it is 0"),
        (" LO B x 1\n SC B x -1\n", &format!("1 > -1, so it is 0{doubt}")),
        (" LO B x -1\n SC B x -2\n", &format!("-1 > -2, so it is 0{doubt}")),
    ] {
        let text = with(&format!("BOUNDS\n{bounds}"));
        check(&text, &format!("{crossed} {what}"), "  x = 0\n");
        check(&text.replace("SC", "SI"), &format!("{crossed} {what}"), "  x = 0 integer\n");
    }
}

#[test]
fn sets_in_every_dialect() {
    let sets = "one: sos1(x: 1, y: 2)\n  two: sos2(y: -1, x: 0.5)";
    for text in [
        "SOS\n S1 one\n x 1\n y 2\n S2 two\n x 0.5\n y -1\n",
        "SETS\n S1 SOS one\n SOS x 1\n SOS y 2\n S2 SOS two 7\n SOS x 0.5\n SOS y -1\n",
        "SOS2\n S1 one 5\n x 1 $ first\n y 2\n s2 two\n x 0.5\n y -1\n",
    ] {
        let (_, model) = warned(&with(text));
        assert!(model.contains(sets), "{model}");
    }
    check(
        &with("SOS\n S2 one\n y\n x 4\n"),
        "line 16, column 2: no weight; the weights are 1, 2, ... in the order of the file",
        "one: sos2(y: 1, x: 4)",
    );
    let marked = with("").replace(" x cost 1", " S2 pair 'MARKER' 'SOSORG'\n x cost 1");
    let marked =
        marked.replace(" M1 'MARKER' 'INTORG'", " pair 'MARKER' 'SOSEND'\n M1 'MARKER' 'INTORG'");
    assert!(warned(&marked).1.contains("pair: sos2(x: 1, y: 2)"), "{marked}");
    assert_eq!(
        warned(&with("SOS\n S1 SOS one\n SOS x 1\n")).0,
        [
            "line 15, column 9: read as the name `one` of a set; some solvers know only `S1 one`, and \
          drop the set"
        ]
    );
    assert_eq!(
        error(&with("SOS\n x 1\n")),
        "line 15, column 2: expected `S1` or `S2` and the name of a set"
    );
    assert_eq!(
        error(&with("SOS\n S1 a\n w 1\n")),
        "line 16, column 2: column `w` is not in COLUMNS"
    );
    assert_eq!(
        error(&with("SOS\n S1 a\n")),
        "line 15, column 5: the number of members of `a` is 0; it must be at least 1"
    );
}
