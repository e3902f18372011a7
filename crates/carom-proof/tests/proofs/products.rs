//! Products that are 0 at every point, added to the objective.

use crate::log::{Header, assert_broken, verdict};

/// x² - 4x + 3z with x in [0, 4], and x = 0 while z = 0: at least -1, where x = 2 and z = 1.
///
/// With 4x (1 - z) + 4 (z² - z), it is (x - 2z)² - z.
const SWITCHED: Header = Header {
    columns: &["c 0 4 x", "i 0 1 z"],
    rows: &["-inf 0 2 0 1 1 -4 off"],
    cones: &[],
    linear: "2 0 -4 1 3",
    squares: "1 0 0 2",
    claim: "bound -1.5",
};
const STEPS: &str = "
    e 2 0 0 1 0 4 1 0 U 0 0 1 0 1 0 -4 0
    p 0
    l 2 0 1 1 -2
    l 2 0 1 1 -2
    l 0
    t 2 0 2 1 1
    x 1 1 -1";

#[test]
fn products_of_a_switched_square() {
    let other = "rejected: column 0 (x) may be other than 0 while column 1 (z) is 0";
    let no_place = "rejected: `e` must stand in context 0, before `p`";
    assert_broken(
        &SWITCHED.log(STEPS),
        &[
            ("c i 0 1 z", "c c 0 1 z", "rejected: column 1 (z) is no binary"),
            ("c i 0 1 z", "c i 0 2 z", "rejected: column 1 (z) is no binary"),
            ("c i 0 1 z", "c i -1 1 z", "rejected: column 1 (z) is no binary"),
            ("4 1 0 U 0 0 ", "4 0 ", other),
            ("4 1 0 U 0 0 ", "4 1 1 U 0 0 ", other),
            ("c 0 4 x", "c -1 4 x", other),
            ("c 0 4 x", "c 1 4 x", other),
            ("e 2 0 0 1", "e 2 0 1 1", &other.replace("other than 0", "other than 1")),
            ("1 0 1 0 -4", "1 1 1 0 -4", {
                "rejected: column 1 (z) may be other than 1 while column 1 (z) is 0"
            }),
            ("0 1 0 4", "0 1 1 4", {
                "rejected: the fact does not imply the bound 0: with the column at it, it holds \
                 with 4 to spare"
            }),
            ("r -inf 0 2", "r -inf 0.5 2", {
                "rejected: the fact does not imply the bound 0: with the column at it, it holds \
                 with 0.5 to spare"
            }),
            ("0 1 0 4", "0 0 0 4", "rejected: column 0 (x) is no binary"),
            ("0 1 0 4", "0 1 2 4", "rejected: there is no side of a binary 2; their number is 2"),
            ("U 0 0 1", "U 0 1 1", "rejected: there is no fact 1; their number is 1"),
            ("e 2", "e 3", "unreadable: the line ends where the column must be"),
            ("e 2", "e 1", "unreadable: the line goes on with `1 0 1 0 -4 0` where it must end"),
            ("1 0 4 1", "1 0 inf 1", "unreadable: the factor is infinite"),
            ("1 0 4 1", "1 0 3 1", "rejected: row 0 is not diagonally dominant, by 1"),
            ("1 0 4 1", "1 0 -4 1", "rejected: row 0 is not diagonally dominant, by 8"),
            ("0 -4 0\n", "0 -3 0\n", "rejected: row 1 is not diagonally dominant, by 2"),
            (
                "0 -4 0\n",
                "0 -8 0\n",
                "rejected: the combination is no contradiction: it holds with 2.5 to spare",
            ),
            ("bound -1.5", "bound -1", {
                "rejected: the combination is no contradiction: it holds with 0 to spare"
            }),
            (
                "p 0\n",
                "p 0\ne 0\n",
                "rejected: `p` and its columns, up to `l 0`, must not be interrupted",
            ),
            ("l 0\n", "l 0\ne 0\n", no_place),
        ],
    );
    for before in ["s 1 0", "m U 3 1 0 1", "f 0 1 1 1"] {
        assert_eq!(verdict(&SWITCHED.log(&format!("{before}\n{STEPS}"))), no_place, "{before}");
    }
}

#[test]
fn bounds_of_a_switched_column_may_need_others() {
    // While z = 1, y <= 0 by the first row, and then x <= 1 by the second. With 2 (x - 1) z, x + z
    // is x - z + 2xz.
    let chain = Header {
        columns: &["c 1 1.5 x", "c 0 4 y", "i 0 1 z"],
        rows: &["-inf 4 2 1 1 2 4 y", "-inf 1 2 0 1 1 -1 x"],
        linear: "2 0 1 2 1",
        squares: "",
        claim: "bound 0.5",
        ..SWITCHED
    };
    let log = chain.log(
        "e 1 0 1 2 1 2 2 1 U 0 0 0 U 1 1
         p 2 0 2 2 2
         l 0
         s 2 0
         t 1 0 1
         x 1 2 -1
         t 2 0 1 2 1
         x 1 2 -1",
    );
    let other = "rejected: column 0 (x) may be other than 1 while column 2 (z) is 1";
    assert_broken(
        &log,
        &[
            ("2 2 1 U 0 0 0 U 1 1", "2 1 1 U 0 0", other),
            ("2 2 1 U 0 0 0 U 1 1", "2 1 0 U 1 1", {
                "rejected: the fact does not imply the bound 1: with the column at it, it holds \
                 with 4 to spare"
            }),
        ],
    );
    // What holds while the binary is off is forgotten behind the command.
    for (column, bounds) in [("0 (x)", "1 to 1.5"), ("1 (y)", "0 to 4"), ("2 (z)", "0 to 1")] {
        let step = format!("d {}\n", &column[..1]);
        let said = format!("rejected: column {column} may be from {bounds}");
        assert_eq!(verdict(&log.replace("s 2 0\n", &step)), said);
    }
}

#[test]
fn squares_of_binaries_are_linear() {
    // z² - z: what is left is linear, and needs no proof of convexity.
    let square = Header {
        columns: &["i 0 1 z"],
        rows: &[],
        linear: "1 0 -3",
        squares: "1 0 0 4",
        claim: "bound -1.5",
        ..SWITCHED
    };
    let log = square.log("e 1 0 0 0 0 2 0\n t 0\n x 1 0 -1");
    assert_broken(
        &log,
        &[
            ("0 0 0 2 0", "0 0 0 1.5 0", {
                "rejected: the objective has squares, and `p` has not proved that it is convex"
            }),
            ("bound -1.5", "bound -1", {
                "rejected: the combination is no contradiction: it holds with 0 to spare"
            }),
        ],
    );
    // The same, off at 1, in two commands.
    let twice = log.replace("e 1 0 0 0 0 2 0\n", "e 1 0 1 0 1 -1 0\ne 1 0 1 0 1 -1 0\n");
    assert_eq!(verdict(&twice.replace("end 3", "end 4")), "proved: objective >= -1.5 (4 steps)");
}

#[test]
fn points_are_judged_by_the_objective_of_the_header() {
    // Where z is slightly off, the products are not 0.
    let log = SWITCHED.log(&format!("{STEPS}\n a 2 0 2 1 0.9996"));
    let said = carom_proof::check(log.as_bytes()).expect("a proof");
    assert_eq!(said.points[0].objective.nearest(), 3.0 * 0.9996 - 4.0);
}
