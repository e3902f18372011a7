//! What files repeat or omit, taken as most readers take it, and sets and semi-continuous columns.

use carom::model::lp;

use super::{error, warned};

#[track_caller]
fn check(text: &str, warning: &str, part: &str) {
    let (warnings, model) = warned(text);
    assert_eq!(warnings, [warning], "{model}");
    assert!(model.contains(part), "{model}");
}

#[test]
fn a_missing_end_is_noticed() {
    check(
        "min x\nst\n x >= 1\n",
        "line 3, column 8: the file ends without `End`; it may have been cut off",
        "c1: x >= 1",
    );
    check(
        "min x",
        "line 1, column 6: the file ends without `End`; it may have been cut off",
        "minimize x",
    );
}

#[test]
fn the_last_of_repeated_bounds_counts() {
    let text = |bounds: &str| format!("min x\nst\nbounds\n{bounds}\nend");
    check(
        &text("x <= 4\nx <= 5"),
        "line 5, column 1: the upper bound of `x` was 4 before and is 5 now; the last one counts",
        "0 <= x <= 5",
    );
    check(
        &text("x = 3\nx <= 5"),
        "line 5, column 1: the upper bound of `x` was 3 before and is 5 now; the last one counts",
        "3 <= x <= 5",
    );
    assert_eq!(warned(&text("x <= 4\nx <= 4\n1 <= x")).0, [""; 0]);
    assert_eq!(
        error(&text("x <= 4\nx free")),
        "line 5, column 1: `x` has an upper bound, and solvers disagree what `free` means then; \
         keep one of them"
    );
    check(
        &text("y <= 4"),
        "line 4, column 1: `y` is neither in the objective nor in a row before",
        "0 <= y <= 4",
    );
}

#[test]
fn bounds_of_binaries_are_cut() {
    let text = |bounds: &str| format!("min x\nst\nbounds\n{bounds}\nbinary\nx\nend");
    check(
        &text("-1 <= x <= 4"),
        "line 4, column 7: `x` is binary, so its bounds -1 and 4 are cut to 0 and 1",
        "x binary",
    );
    assert_eq!(warned(&text("x = 0")).0, [""; 0]);
    assert_eq!(error(&text("x >= 2")), "line 4, column 1: bounds of `x` are crossed: 2 > 1");
}

#[test]
fn repeated_rows_are_renamed() {
    check(
        "min x\nst\nr: x >= 1\nr: x <= 3\nr_: x <= 4\nend",
        "line 4, column 1: a second row `r`; it is called `r__` here",
        "r: x >= 1\n  r__: x <= 3\n  r_: x <= 4",
    );
}

#[test]
fn conditions_are_binaries() {
    check(
        "max x + z\nst\nr: z = 1 -> x <= 3\nbounds\nx <= 5\nend",
        "line 3, column 4: `z` is a condition, so it is taken as a binary",
        "z binary",
    );
}

#[test]
fn equality_may_have_two_signs() {
    assert!(warned("min x st x + y == 2 end").1.contains("c1: x + y = 2"));
}

#[test]
fn sets_of_both_kinds() {
    let text = |sets: &str| format!("max x + y + z\nst\nr: x + y <= 9\n{sets}\nend");
    let (warnings, model) =
        warned(&text("SOS\none: S1:: x:1 y:2\n two : S2 :: z:-3 x:1.5\n y : 0\nS1:: y:1"));
    assert_eq!(warnings, [""; 0]);
    assert!(
        model.contains("one: sos1(x: 1, y: 2)\n  two: sos2(z: -3, y: 0, x: 1.5)\n  s3: sos1(y: 1)"),
        "{model}"
    );
    assert!(warned(&text("sos1\na: x:1 y:2\nsos2\nx:1 y:2")).1.contains("a: sos1(x: 1, y: 2)"));
    check(
        &text("SOS\nr: S1:: x:1 y:2"),
        "line 5, column 1: the name `r` is taken; the set is called `r_`",
        "r_: sos1(x: 1, y: 2)",
    );
    check(
        &text("SOS\na: S2:: x:2 y:1 z:2"),
        "line 5, column 1: `a` has a weight twice; members of the same weight keep their order, and \
         the weights are 1, 2, ...",
        "a: sos2(y: 1, x: 2, z: 3)",
    );
    assert_eq!(
        error(&text("SOS\na: x:1 y:2")),
        "line 5, column 4: expected `S1::` or `S2::`, found `x`"
    );
    assert_eq!(
        error(&text("SOS\na: S3:: x:1")),
        "line 5, column 4: expected `S1` or `S2`, found `S3`"
    );
    assert_eq!(
        error(&text("SOS\na: S1:: x y")),
        "line 5, column 9: expected a member and its weight, such as `x:1`, found `x`"
    );
    assert_eq!(
        error(&text("SOS\na: S1:: x:1 x:2")),
        "line 5, column 1: how often `x` is in `a` is 2; it must be 1"
    );
}

#[test]
fn semicontinuous_columns() {
    let text = |end: &str| format!("max x + y\nst\nr: x + y <= 9\nbounds\n2 <= x <= 5\n{end}\nend");
    for word in ["Semi-Continuous", "semis", "SEMI"] {
        let (warnings, model) = warned(&text(&format!("{word}\nx y")));
        assert_eq!(warnings, [""; 0]);
        assert!(model.contains("  x = 0 or 2 <= x <= 5\n  y = 0 or y >= 0\n"), "{model}");
    }
    assert!(warned(&text("semis\nx\ngeneral\nx")).1.contains("x = 0 or 2 <= x <= 5 integer"));
    check(
        &text("-4 <= y <= -2\nsemis\ny"),
        "line 6, column 7: `y` is 0 or between -4 and -2; some solvers refuse negative values of \
         semi-continuous variables",
        "y = 0 or -4 <= y <= -2",
    );
    check(
        &text("semis\ny\nbinary\ny"),
        "line 1, column 9: `y` is both semi-continuous and a binary, so it is 0, or 1 if its bounds \
         allow it",
        "y binary",
    );
    check(
        &text("y <= 0.5\nsemis\ny\nbinary\ny"),
        "line 6, column 1: `y` is both semi-continuous and a binary, so it is 0, or 1 if its bounds \
         allow it",
        "y = 0 binary",
    );
}

/// Four other solvers take 0; where bounds are negative, two of them find no point at all.
#[test]
fn semicontinuous_columns_with_crossed_bounds_are_0() {
    let text = |end: &str| format!("max x + y\nst\nr: x + y <= 9\nbounds\n{end}\nsemis\nx\nend");
    let crossed = "the bounds of the semi-continuous `x` are crossed,";
    let doubt = "; some solvers take the program as infeasible";
    for (bounds, place, what) in [
        ("2 <= x <= 1", "line 5, column 6", "2 > 1, so it is 0"),
        ("x >= 2\nx <= 1", "line 6, column 1", "2 > 1, so it is 0"),
        ("x >= 2\nx <= 0", "line 6, column 1", "2 > 0, so it is 0"),
        ("x <= -1", "line 5, column 1", &format!("0 > -1, so it is 0{doubt}")),
        ("-1 <= x <= -2", "line 5, column 7", &format!("-1 > -2, so it is 0{doubt}")),
        ("1 <= x <= -2", "line 5, column 6", &format!("1 > -2, so it is 0{doubt}")),
    ] {
        check(&text(bounds), &format!("{place}: {crossed} {what}"), "  x = 0\n");
        let kinds = format!("{bounds}\ngeneral\nx");
        check(&text(&kinds), &format!("{place}: {crossed} {what}"), "  x = 0 integer\n");
    }
    assert!(
        warned(&text("x >= 2.2\nx <= 2.8\ngeneral\nx"))
            .1
            .contains("x = 0 or 2.2 <= x <= 2.8 integer")
    );
}

/// Names of rows with the same label: underscores first, then numbers, so that many of them stay
/// short.
#[test]
fn many_rows_may_share_a_label() {
    let text = |rows: usize| {
        let rows: String = (0..rows).map(|i| format!(" c: x >= {}\n", i % 3)).collect();
        format!("Minimize\n obj: x\nSubject To\n c_5: x >= 1\n{rows}End\n")
    };
    let read = lp::read(&text(7)).unwrap();
    let names: Vec<String> = read.model.constraints().map(|row| row.name().to_string()).collect();
    assert_eq!(names, ["c_5", "c", "c_", "c__", "c___", "c_4", "c_6", "c_7"]);
    // Took hours when each name was tried with one more underscore.
    let read = lp::read(&text(50_000)).unwrap();
    assert_eq!(read.model.constraint_count(), 50_001);
    assert_eq!(read.warnings.len(), 49_999);
}

#[test]
fn columns_of_warnings_count_characters() {
    let bounds: String = (0..30_000).map(|i| format!(" ä <= {}", i % 7 + 1)).collect();
    let text = format!("Minimize\n obj: ä\nSubject To\n c: ä >= 1\nBounds\n{bounds}\nEnd\n");
    let read = lp::read(&text).unwrap();
    let columns: Vec<usize> = read.warnings.iter().map(|warning| warning.column).collect();
    assert_eq!(columns.len(), 29_999);
    assert_eq!(columns[..3], [9, 16, 23]);
    assert!(columns.windows(2).all(|pair| pair[1] == pair[0] + 7));
}
