//! Bounds from rows, combinations, contradictions.

use crate::log::{Header, assert_broken, verdict};

/// x + 2n <= 7 and x + y >= 20 with y <= 12 contradict n >= 0.
const SUM: Header = Header {
    columns: &["c 0 100 x", "i 0 9 n", "c -inf 12 y"],
    rows: &["-inf 7 2 0 1 1 2 cap", "20 inf 2 0 1 2 1 both"],
    cones: &[],
    linear: "",
    squares: "",
    claim: "infeasible",
};

#[test]
fn a_bound_follows_from_a_row() {
    let log = SUM.log("b 0 U 7 0\n b 1 U 3 0\n b 2 L 13 1\n d 2");
    assert_broken(
        &log,
        &[
            (
                "b 0 U 7 0",
                "b 0 U 6.5 0",
                "rejected: the fact does not imply the bound 6.5: with the column at it, it holds \
                 with 0.5 to spare",
            ),
            (
                "b 1 U 3 0",
                "b 1 U 2 0",
                "rejected: the fact does not imply the bound 2: with the next whole number, it \
                 holds with 1 to spare",
            ),
            ("b 1 U 3 0", "b 1 U 3.5 0", "rejected: the column is integral, and 3.5 is not whole"),
            (
                "b 2 L 13 1",
                "b 2 L 13.5 1",
                "rejected: the fact does not imply the bound 13.5: with the column at it, it \
                 holds with 0.5 to spare",
            ),
            ("b 2 L 13 1", "b 2 L 12 1", "rejected: column 2 (y) may be from 12 to 12"),
            ("b 1 U 3 0", "b 1 U 3 1", "rejected: the fact does not contain the column"),
            ("b 0 U 7 0", "b 0 L 7 0", "rejected: the fact has no lower side"),
            ("b 0 U 7 0", "b 0 U 7 2", "rejected: there is no fact 2; their number is 2"),
            ("b 0 U 7 0", "b 3 U 7 0", "rejected: there is no column 3; their number is 3"),
            ("b 0 U 7 0", "b 0 X 7 0", "unreadable: a side is neither `L` nor `U`"),
            ("b 0 U 7 0", "b 0 U inf 0", "unreadable: the bound is infinite"),
            ("d 2", "d 1", "rejected: column 1 (n) may be from 0 to 3"),
        ],
    );
    // Another order: x has no bound from `both` before y has.
    let row = SUM.log("b 0 L 8 1\n b 0 U 7 0\n d 0");
    assert_broken(
        &row,
        &[("b 0 L 8 1", "b 2 L -81 1", "rejected: column 0 (x) may be from 0 to 7")],
    );
    let free = Header { columns: &["c 0 inf x", "i 0 9 n", "c -inf 12 y"], ..SUM };
    assert_eq!(verdict(&free.log("b 2 L 13 1")), "rejected: column 0 of the fact has no bound");
}

#[test]
fn a_negative_coefficient_mirrors_the_rule() {
    let mirrored = Header {
        columns: &["c 0 9 x", "i -9 9 n"],
        rows: &["-inf -2.5 1 0 -1 a", "-3 inf 2 0 1 1 -2 b", "-inf -6.5 1 1 -2 c"],
        claim: "infeasible",
        ..Header::default()
    };
    // x >= 2.5; from x - 2n >= -3 and x <= 9, n <= 6; from -2n <= -6.5, n >= 4.
    let steps = "b 0 L 2.5 0\n b 1 U 6 1\n b 1 L 4 2\n";
    assert_eq!(verdict(&mirrored.log(&format!("{steps} d 1"))), {
        "rejected: column 1 (n) may be from 4 to 6"
    });
    for (from, to, spare) in
        [("L 2.5", "L 2.75", "0.25"), ("U 6", "U 5", "0"), ("L 4", "L 5", "1.5")]
    {
        let said = verdict(&mirrored.log(&steps.replace(from, to)));
        assert!(said.ends_with(&format!("holds with {spare} to spare")), "{from} {to}: {said}");
    }
}

#[test]
fn a_bound_that_is_not_tighter_is_ignored() {
    let log = SUM.log("b 0 U 100 1\n b 0 U 7 0\n b 2 L 13 1\n b 2 L -5 1\n d 2");
    assert_eq!(verdict(&log), "proved: no point (5 steps)");
}

#[test]
fn a_combination_that_no_values_reach() {
    // x + 2n <= 7 and x + y >= 20: y - 2n >= 13, but y <= 12 and n >= 0.
    assert_broken(
        &SUM.log("x 2 0 -1 1 1"),
        &[
            ("x 2 0 -1 1 1", "x 1 1 1", {
                "rejected: the combination is no contradiction: it holds with 92 to spare"
            }),
            ("x 2 0 -1 1 1", "x 0", {
                "rejected: the combination is no contradiction: it holds with 0 to spare"
            }),
            ("x 2 0 -1 1 1", "x 2 0 1 1 1", "rejected: fact 0 has no lower side, for multiplier 1"),
            ("x 2 0 -1 1 1", "x 2 0 -1 1 -1", {
                "rejected: fact 1 has no upper side, for multiplier -1"
            }),
            ("x 2 0 -1 1 1", "x 2 0 -1 2 1", "rejected: there is no fact 2; their number is 2"),
            ("x 2 0 -1 1 1", "x 3 0 -1 1 1", {
                "unreadable: the line ends where the fact must be"
            }),
            ("x 2 0 -1 1 1", "x 2 0 -1 1 1 1", {
                "unreadable: the line goes on with `1` where it must end"
            }),
            ("c -inf 12 y", "c -inf inf y", {
                "rejected: column 2 remains, times 1, and has no bound"
            }),
            ("c -inf 12 y", "c -inf 13 y", {
                "rejected: the combination is no contradiction: it holds with 0 to spare"
            }),
        ],
    );
    // Multipliers of 0 use no side.
    assert_eq!(verdict(&SUM.log("x 3 0 -1 1 1 1 0")), "proved: no point (1 step)");
}

#[test]
fn a_combination_is_a_fact() {
    assert_broken(
        &SUM.log("k 2 0 -0.5 1 0.5\n x 1 2 2"),
        &[
            ("x 1 2 2", "x 1 2 -2", "rejected: fact 2 has no upper side, for multiplier -2"),
            ("x 1 2 2", "x 1 3 2", "rejected: there is no fact 3; their number is 3"),
            ("1 0.5", "1 0.75", {
                "rejected: the combination is no contradiction: it holds with 45 to spare"
            }),
        ],
    );
}

#[test]
fn nothing_is_rounded() {
    // As floats, 0.1 + 0.2 is more than 0.3 by 2^-55 or so.
    let tenths = Header {
        columns: &["c 0.1 1 x", "c 0.2 1 y"],
        rows: &["-inf 0.3 2 0 1 1 1 a"],
        claim: "infeasible",
        ..Header::default()
    };
    assert_broken(
        &tenths.log("x 1 0 -1"),
        &[("c 0.2 1 y", "c 0.19999999999999998 1 y", {
            "rejected: the combination is no contradiction: it holds with 0 to spare"
        })],
    );
}
