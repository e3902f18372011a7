//! Columns that are whole or 0 without loss of optimality, and columns that are whole because
//! others are.

use crate::log::{Header, assert_broken, verdict};

/// Maximise z <= x, z <= 1 - x over a binary x: nothing is above 0 if z may be rounded up.
const NEITHER: Header = Header {
    columns: &["i 0 1 x", "c 0 1 z", "c 0 2 w"],
    rows: &["-inf 0 2 1 1 0 -1 is", "-inf 1 2 1 1 0 1 not", "0 inf 2 1 0.3 2 -0.1 free"],
    cones: &[],
    linear: "2 1 -1 2 1",
    squares: "1 2 2 2",
    claim: "bound -0.25",
};

/// The objective bounds z from below, and z is at least 1 if it is whole.
const ROUNDED: &str = "p 0\n l 0\n u 1 U\n t 0\n b 1 L 1 3\n x 2 0 -1 1 -1";

const BETWEEN: &str = "rejected: row 0 may hold column 1 between whole numbers";
const HELD: &str = "rejected: column 1 (z) must not be moved, or not here";

#[test]
fn a_column_that_may_be_rounded() {
    let log = NEITHER.log(ROUNDED);
    assert_broken(
        &log,
        &[
            ("u 1 U", "u 1 L", "rejected: column 1 (z) costs more there"),
            ("u 1 U", "u 0 U", "rejected: row 1 may hold column 0 between whole numbers"),
            ("u 1 U", "u 2 U", "rejected: column 2 (w) must not be moved, or not here"),
            ("u 1 U", "u 3 U", "rejected: there is no column 3; their number is 3"),
            ("u 1 U", "u 1 X", "unreadable: a side is neither `L` nor `U`"),
            ("u 1 U", "u 1", "unreadable: the line ends where `L` or `U` must be"),
            ("u 1 U", "d 1", "rejected: column 1 (z) may be from 0 to 1"),
            ("c 0 1 z", "c 0 0.75 z", "rejected: column 1 (z) has a bound that is not whole"),
            ("g 2 1 -1", "g 2 1 1", "rejected: column 1 (z) costs more there"),
            ("i 0 1 x", "c 0 1 x", BETWEEN),
            ("1 1 0 -1 is", "1 1 0 -1.5 is", BETWEEN),
            ("1 1 0 -1 is", "1 2 0 -1 is", BETWEEN),
            ("r -inf 0 2 1 1", "r -inf 0.5 2 1 1", BETWEEN),
            ("r -inf 0 2 1 1", "r -inf 1 2 1 2", BETWEEN),
            // Three times this coefficient is not quite 0.3.
            ("r -inf 0 2 1 1", "r -inf 0.3 2 1 0.1", BETWEEN),
            ("r -inf 0 2 1 1 0 -1", "r -inf 0 2 1 1e-300 0 -1e300", {
                "rejected: the numbers are too large or too fine for this checker"
            }),
            ("0 inf 2 1 0.3", "0 inf 2 1 -0.3", {
                "rejected: row 2 may hold column 1 between whole numbers"
            }),
            ("0 inf 2 1 0.3", "0 5 2 1 0.3", {
                "rejected: row 2 may hold column 1 between whole numbers"
            }),
            ("h 1 2 2 2", "h 2 2 2 2 1 2 0", HELD),
            ("cones 0", "cones 1\nq 2 1 1", HELD),
            ("cones 0", "cones 1\nq 1 1 2", HELD),
            ("cones 0", "cones 1\nr 2 1 1 0", HELD),
        ],
    );
    // Bounds on the other side, and a missing one, do not matter.
    for z in ["c 0.5 1 z", "c -inf 1 z", "c 0 inf z"] {
        assert!(verdict(&log.replace("c 0 1 z", z)).starts_with("proved: "), "{z}");
    }
    for (before, after) in [("s 0 0", ""), ("m U 0 1 0 1", ""), ("i 2", "")] {
        assert_eq!(verdict(&NEITHER.log(&format!("{before}\n u 1 U {after}"))), HELD, "{before}");
    }
    let without = NEITHER.log(&ROUNDED.replace("u 1 U\n", ""));
    assert!(verdict(&without).starts_with("rejected: the fact does not imply the bound 1"));
}

/// Costs do not matter where there is no point. Each declaration counts in the next one.
#[test]
fn declarations_build_on_each_other() {
    const CHAIN: Header = Header {
        columns: &["i 0 1 x", "c 0 1 y", "c 0 1 z"],
        rows: &["-inf 0 2 1 1 0 -1", "-inf 0 2 2 1 1 -1", "-inf 1 2 2 1 0 1", "0.5 inf 1 2 2"],
        cones: &[],
        linear: "3 0 1 1 1 2 1",
        squares: "1 2 2 2",
        claim: "infeasible",
    };
    let end = "b 2 L 1 3\n b 1 L 1 1\n b 0 L 1 0\n x 1 2 -1";
    let log = CHAIN.log(&format!("u 1 U\n u 2 U\n {end}"));
    assert_broken(
        &log,
        &[("claim infeasible", "claim bound 1", "rejected: column 1 (y) costs more there")],
    );
    let wrong = CHAIN.log(&format!("u 2 U\n u 1 U\n {end}"));
    assert_eq!(verdict(&wrong), "rejected: row 1 may hold column 2 between whole numbers");
}

/// 2p - 2q = 1 over whole numbers without bounds.
const APART: Header = Header {
    columns: &["i -inf inf p", "i -inf inf q", "c -inf inf w"],
    rows: &["1 1 2 0 2 1 -2", "-inf 7 1 0 1 most"],
    cones: &[],
    linear: "2 0 3 1 -3",
    squares: "",
    claim: "bound 1",
};

const SHIFTED: &str = "v 1 2 0 1 1 1\n b 0 U 0 0\n b 0 L 1 0\n d 0";

#[test]
fn columns_that_can_be_shifted_together() {
    let log = APART.log(SHIFTED);
    let unfit = "rejected: the steps to where column 1 is 0 are not fit";
    assert_broken(
        &log,
        &[
            ("v 1 2 0 1 1 1", "v 1 2 0 1 1 2", unfit),
            ("v 1 2 0 1 1 1", "v 1 2 0 0.5 1 1", unfit),
            ("v 1 2 0 1 1 1", "v 1 1 0 1", unfit),
            ("v 1 2 0 1 1 1", "v 2 3 0 1 1 1 2 1", {
                "rejected: the steps to where column 2 is 0 are not fit"
            }),
            ("v 1 2 0 1 1 1", "v 2 0", "rejected: the steps to where column 2 is 0 are not fit"),
            ("v 1 2 0 1 1 1", "v 1 2 0 1 3 1", {
                "rejected: there is no column 3; their number is 3"
            }),
            ("v 1 2 0 1 1 1", "v 1 2 0 2 1 1", {
                "rejected: the objective changes along the direction"
            }),
            ("g 2 0 3", "g 2 0 2", "rejected: the objective changes along the direction"),
            // Rows that change are forgotten.
            ("r 1 1 2 0 2", "r 1 1 2 0 3", "rejected: the fact has no upper side"),
            ("r 1 1 2 0 2 1 -2", "r 1 1 3 0 2 1 -2 2 1", {
                "rejected: column 2 of the fact has no bound"
            }),
            ("b 0 U 0 0", "b 0 U 0 1", "rejected: the fact has no upper side"),
            ("b 0 U 0 0", "v 1 2 0 1 1 1", {
                "rejected: a column of the direction must not be moved"
            }),
            ("b 0 U 0 0", "u 1 U", { "rejected: column 1 (q) must not be moved, or not here" }),
            ("b 0 U 0 0", "a 1 0 1", "rejected: a point must stand before `v`"),
            ("i -inf inf q", "c -inf inf q", unfit),
            ("cones 0", "cones 1\nq 2 1 0", {
                "rejected: a column of the direction must not be moved"
            }),
            ("h 0", "h 1 0 0 0", "rejected: a column of the direction must not be moved"),
        ],
    );
    // Bounds of the columns are forgotten as well.
    let bounded = log.replace("i -inf inf p", "i 2 9 p");
    assert!(verdict(&bounded).starts_with("proved: "), "{}", verdict(&bounded));
    let used = bounded.replace("b 0 U 0 0\nb 0 L 1 0\nd 0", "b 0 U 0 0\nd 0\nk 0");
    assert_eq!(verdict(&used), "rejected: column 0 (p) may be from -inf to 0");
    let unsigned = log.replace("claim bound 1", "claim infeasible").replace("g 2 0 3", "g 2 0 2");
    assert_eq!(verdict(&unsigned), "proved: no point (4 steps)");
    // What was derived may be gone with the program's rows.
    for before in ["b 0 U 7 1", "k 1 1 -1", "t 0", "i 0", "s 0 0", "m U 7 1 0 1"] {
        let late = APART.log(&format!("{before}\n {SHIFTED}"));
        let said = "rejected: `v` must stand before all that is derived";
        assert_eq!(verdict(&late), said, "{before}");
    }
}

/// z = x, and 0.5 <= z <= 0.75.
const EQUAL: Header = Header {
    columns: &["i 0 1 x", "c 0 1 z"],
    rows: &["0 0 2 1 1 0 -1", "0.5 0.75 1 1 1"],
    cones: &[],
    linear: "",
    squares: "",
    claim: "infeasible",
};

#[test]
fn a_column_that_is_whole_because_others_are() {
    let log = EQUAL.log("i 1\n s 0 0\n b 1 U 0 0\n d 1\n b 1 L 1 0\n d 1\n b 1 U 0 1\n x 1 1 1");
    assert_broken(
        &log,
        &[
            ("i 1\n", "i 0\n", "rejected: column 1 (z) may be from 0 to 0"),
            ("i 1\n", "i 2\n", "rejected: there is no column 2; their number is 2"),
            ("b 1 L 1 0", "b 1 L 0.5 0", "rejected: column 1 (z) may be from 0.5 to 1"),
            ("s 0 0", "i 1", "rejected: `i` must stand in context 0"),
            ("i 0 1 x", "c 0 1 x", "rejected: column 0 (x) is not integral"),
        ],
    );
    let half = log
        .replace("0 0 2 1 1 0 -1", "0 0 2 1 2 0 -1")
        .replace("b 1 L 1 0", "b 1 L 0.5 0\nb 1 U 0.5 0");
    assert_eq!(verdict(&half), "rejected: column 1 (z) may be from 0.5 to 0.5");
    // Its bounds end with the context, and elsewhere equal bounds are no contradiction.
    let leak = EQUAL.log("i 1\n s 0 0\n b 1 U 0 0\n d 1\n b 1 L 1 0\n d 1\n d 1");
    assert_eq!(verdict(&leak), "rejected: column 1 (z) may be from 0 to 1");
    let other = EQUAL.log("s 0 0\n b 1 U 0 0\n d 1");
    assert_eq!(verdict(&other), "rejected: column 1 (z) may be from 0 to 0");
    let open = EQUAL.log("i 1\n x 1 1 1");
    assert!(verdict(&open).starts_with("rejected: the combination is no contradiction"));
}
