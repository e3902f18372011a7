//! Tangents of the objective and of cones, and the proof of convexity.

use crate::log::{Header, assert_broken, verdict};

/// x² - 2x + y² with x in [-3, 3], y in [1, 3]: at least 0.
const BOWL: Header = Header {
    columns: &["c -3 3 x", "c 1 3 y"],
    rows: &[],
    cones: &[],
    linear: "1 0 -2",
    squares: "2 0 0 2 1 1 2",
    claim: "bound -0.125",
};
const NOT_PROVED: &str =
    "rejected: the objective has squares, and `p` has not proved that it is convex";

#[test]
fn a_tangent_of_the_objective() {
    let log = BOWL.log("p 0\n l 0\n t 2 0 1 1 1\n x 1 0 -1");
    assert_broken(
        &log,
        &[
            ("t 2 0 1 1 1", "t 2 0 1 1 0.5", {
                "rejected: the combination is no contradiction: it holds with 0.125 to spare"
            }),
            ("t 2 0 1 1 1", "t 2 0 1 0 1", "unreadable: column 0 is listed twice"),
            ("bound -0.125", "bound 0", {
                "rejected: the combination is no contradiction: it holds with 0 to spare"
            }),
            ("bound -0.125", "bound 0.25", {
                "rejected: the combination is no contradiction: it holds with 0.25 to spare"
            }),
            ("claim bound -0.125", "claim infeasible", {
                "rejected: without a bound to prove, nothing is known of the objective"
            }),
            ("c 1 3 y", "c 0 3 y", {
                "rejected: the combination is no contradiction: it holds with 1.875 to spare"
            }),
        ],
    );
    assert_eq!(verdict(&BOWL.log("t 2 0 1 1 1\n x 1 0 -1")), NOT_PROVED);
}

#[test]
fn a_linear_objective_needs_no_proof_of_convexity() {
    let line = Header { squares: "", claim: "bound -6.5", ..BOWL };
    assert_broken(
        &line.log("t 0\n x 1 0 -1"),
        &[("bound -6.5", "bound -6", {
            "rejected: the combination is no contradiction: it holds with 0 to spare"
        })],
    );
}

#[test]
fn deficits_cost_slack() {
    // xy over a box is convex up to 1/2 (x² + y²), at most 1/2 (3² + 3²) from its tangent at 0.
    let saddle = Header {
        columns: &["c -3 3 x", "c -3 3 y"],
        linear: "",
        squares: "1 0 1 1",
        claim: "bound -9.5",
        ..BOWL
    };
    assert_broken(
        &saddle.log("p 2 0 1 1 1\n l 0\n t 0\n x 1 0 -1"),
        &[
            ("bound -9.5", "bound -8.5", {
                "rejected: the combination is no contradiction: it holds with 0.5 to spare"
            }),
            ("p 2 0 1 1 1", "p 2 0 1 1 0.5", {
                "rejected: row 1 is not diagonally dominant, by 0.5"
            }),
            ("p 2 0 1 1 1", "p 2 0 -1 1 1", { "rejected: row 0 is not diagonally dominant, by 2" }),
            ("t 0", "t 1 0 1", {
                "rejected: the combination is no contradiction: it holds with 6 to spare"
            }),
            ("c -3 3 x", "c -3 inf x", "rejected: column 0 has a deficit and is not bounded"),
            ("c -3 3 y", "c -4 3 y", {
                "rejected: the combination is no contradiction: it holds with 3 to spare"
            }),
        ],
    );
}

#[test]
fn a_factor_proves_convexity() {
    // (x + 2y)² is not diagonally dominant.
    let square = Header {
        columns: &["c -3 3 x", "c -3 3 y"],
        linear: "",
        squares: "3 0 0 2 0 1 4 1 1 8",
        claim: "bound -0.5",
        ..BOWL
    };
    assert_broken(
        &square.log("p 0\n l 2 0 1 1 2\n l 2 0 1 1 2\n l 0\n t 0\n x 1 0 -1"),
        &[
            ("p 0\nl 2 0 1 1 2\nl 2 0 1 1 2\nl 0", "p 0\nl 2 0 1 1 2\nl 0", {
                "rejected: row 0 is not diagonally dominant, by 1"
            }),
            ("l 0", "x 0", "rejected: `p` and its columns, up to `l 0`, must not be interrupted"),
            ("l 0\nt 0", "l 0\np 0", {
                "rejected: `p` and its columns, up to `l 0`, must not be interrupted"
            }),
            ("l 0\nt 0", "l 0\nl 0", "rejected: `l` without `p`"),
            ("0 1 4", "0 1 5", "rejected: row 0 is not diagonally dominant, by 1"),
            ("p 0\nl 2 0 1 1 2", "p 0\nl 2 0 1.5 1 2", {
                "rejected: row 0 is not diagonally dominant, by 2.25"
            }),
        ],
    );
    let inside = square.log("m U 5 1 0 1\n p 0");
    assert_eq!(verdict(&inside), "rejected: `p` must stand in context 0");
}

/// (x - y)² is flat along x = y, where x has no bound. With much from y, x is steep and gets
/// bounds; within these, a second proof has small deficits. A further proof takes the place of the
/// one before it, and `w` and `t` go by the last one.
#[test]
fn convexity_may_be_proved_again() {
    let flat = Header {
        columns: &["c -inf inf x", "c 1 4 y"],
        linear: "",
        squares: "3 0 0 2 0 1 -2 1 1 2",
        claim: "bound -0.5",
        ..BOWL
    };
    let steep = "p 2 0 -1 1 4\nl 2 0 1 1 -2\nl 0";
    let bounds = "w 0 0 2 0 L -8 0 U 8";
    let near = "p 2 0 0.0078125 1 0.0078125\nl 2 0 1 1 -1\nl 2 0 1 1 -1\nl 0";
    assert_broken(
        &flat.log(&format!("{steep}\n{bounds}\n{near}\nt 0\nx 1 0 -1")),
        &[
            (
                near,
                "",
                "rejected: the combination is no contradiction: it holds with 31.5 to spare",
            ),
            (bounds, "", "rejected: column 0 has a deficit and is not bounded"),
            (
                bounds,
                "w 0 0 2 0 L -7.5 0 U 8",
                "rejected: the curvature does not bound column 0 (x) by -7.5",
            ),
            (near, "p 0\nl 2 0 1 1 -1\nl 2 0 1.5 1 -1\nl 0", {
                "rejected: row 0 is not diagonally dominant, by 1.75"
            }),
            ("p 2 0 -1 1 4", "p 2 0 -2 1 4", "rejected: row 0 is not diagonally dominant, by 1"),
            ("p 2 0 -1 1 4", "p 2 0 -1 1 1", "rejected: row 1 is not diagonally dominant, by 1"),
            (steep, near, "rejected: column 0 has a deficit and is not bounded"),
            (
                "1 0.0078125\n",
                "1 -0.0078125\n",
                "rejected: row 1 is not diagonally dominant, by 0.0078125",
            ),
        ],
    );
}

#[test]
fn a_tangent_of_a_cone() {
    // h >= |(x, y)| with x >= 3, y >= 4, h <= 4.25.
    let cone = Header {
        columns: &["c 0 4.25 h", "c 3 9 x", "c 4 9 y"],
        cones: &["q 0 2 1 2"],
        claim: "infeasible",
        ..Header::default()
    };
    assert_broken(
        &cone.log("q 0 2 2 1 1.5\n x 1 0 1"),
        &[
            ("q 0 2 2 1 1.5", "q 0 2 2 2 1.5", {
                "rejected: the weights of the tail are too long: their square, by 2.25"
            }),
            ("q 0 2 2 1 1.5", "q 0 1 2 0.6 0.8", {
                "rejected: the weights of the tail are too long: their square, by \
                 4.4408920985006264e-17"
            }),
            ("q 0 2 2 1 1.5", "q 0 -2 2 1 1.5", "rejected: the weight of a head is negative"),
            ("q 0 2 2 1 1.5", "q 0 1 1 1", "rejected: cone 0 has 2 columns in its tail"),
            ("q 0 2 2 1 1.5", "q 1 1 2 0 1", "rejected: there is no cone 1; their number is 1"),
            ("c 0 4.25 h", "c 0 4.75 h", {
                "rejected: the combination is no contradiction: it holds with 0.5 to spare"
            }),
            ("x 1 0 1", "x 1 0 -1", "rejected: fact 0 has no upper side, for multiplier -1"),
        ],
    );
    // A column may be in a cone twice.
    let twice = Header { cones: &["q 0 2 1 1"], ..cone };
    assert_eq!(verdict(&twice.log("q 0 1 2 0.5 0.8\n b 0 L 3.5 0\n x 0")), {
        "rejected: the combination is no contradiction: it holds with 0 to spare"
    });
}

#[test]
fn a_tangent_of_a_rotated_cone() {
    // h s >= x² + y² with x >= 3, y >= 4, h <= 4 and s <= 6.
    let cone = Header {
        columns: &["c 0 4 h", "c 0 6 s", "c 3 9 x", "c 4 9 y"],
        cones: &["r 0 1 2 2 3"],
        claim: "infeasible",
        ..Header::default()
    };
    assert_broken(
        &cone.log("q 0 6 4 2 2.875 3.875\n x 1 0 1"),
        &[
            ("q 0 6 4 2 2.875 3.875", "q 0 6 4 2 3 4", {
                "rejected: the weights of the tail are too long: their square, by 1"
            }),
            ("q 0 6 4 2 2.875 3.875", "q 0 -6 -4 2 2.875 3.875", {
                "rejected: the weight of a head is negative"
            }),
            ("q 0 6 4 2 2.875 3.875", "q 0 6 2 2.875 3.875", {
                "unreadable: the number of entries, `2.875`, is no whole number"
            }),
            ("c 0 6 s", "c 0 6.25 s", {
                "rejected: the combination is no contradiction: it holds with 0.75 to spare"
            }),
        ],
    );
}

#[test]
fn curvature_bounds_columns() {
    // x² - 2x + y is (x - 1)² + y - 1, and y is at least 1. So an objective of at most 4 needs x
    // within [-1, 3] and y at most 5.
    let steep = Header {
        columns: &["c -9 9 x", "c 1 9 y", "c 0 1 z"],
        rows: &["-inf -3.5 1 0 -1 x"],
        linear: "2 0 -2 1 1",
        squares: "1 0 0 2",
        claim: "bound 4",
        ..BOWL
    };
    let log = steep.log("p 1 0 -2\n l 0\n w 2 0 1 1 2 0 3 0 U 3 0 L -1 1 U 5\n b 0 L 3.5 0\n d 0");
    let elsewhere = log.replace("2 0 1 1 2 0 3", "2 0 0 1 2 1 0 1 3");
    assert_eq!(verdict(&elsewhere), "proved: objective >= 4 (5 steps)");
    let no_bound = |what: &str| format!("rejected: the curvature does not bound column {what}");
    assert_broken(
        &log,
        &[
            ("0 U 3 ", "0 U 2.5 ", &no_bound("0 (x) by 2.5")),
            ("0 L -1 ", "0 L -0.5 ", &no_bound("0 (x) by -0.5")),
            ("1 U 5\n", "1 U 4.5\n", &no_bound("1 (y) by 4.5")),
            ("1 U 5\n", "1 L 2\n", &no_bound("1 (y) by 2")),
            ("1 U 5\n", "2 U 0.5\n", &no_bound("2 (z) by 0.5")),
            ("0 L -1 ", "0 L 2 ", &no_bound("0 (x) by 2")),
            ("p 1 0 -2", "p 1 0 -2.5", "rejected: row 0 is not diagonally dominant, by 0.5"),
            ("p 1 0 -2", "p 1 0 -1", &no_bound("0 (x) by 3")),
            ("p 1 0 -2", "p 0", &no_bound("0 (x) by 3")),
            ("p 1 0 -2", "p 1 0 1", &no_bound("0 (x) by 3")),
            (
                "2 0 1 1 2 0 3",
                "2 0 0 1 2 0 3",
                "rejected: column 0 may lower the objective by more",
            ),
            ("2 0 1 1 2 0 3", "2 0 0 1 2 1 0 0.75 3", {
                "rejected: column 0 may lower the objective by more"
            }),
            ("2 0 1 1 2 0 3", "2 0 1 1 2 1 0 1 3", &no_bound("1 (y) by 5")),
            ("2 0 1 1 2 0 3", "2 0 1 1 2 1 0 -1 3", {
                "rejected: column 0 may lower the objective by more"
            }),
            ("c 1 9 y", "c -inf 9 y", "rejected: column 1 has no curvature and no bound"),
            ("bound 4", "bound 4.5", &no_bound("0 (x) by 3")),
            ("claim bound 4", "claim infeasible", {
                "rejected: without a bound to prove, nothing is known of the objective"
            }),
            ("p 1 0 -2\nl 0\nw", "w", "rejected: `w` needs `p` before it"),
        ],
    );
}

#[test]
fn curvature_says_nothing_of_a_slope_that_falls() {
    let said = |header: &Header, steps: &str| verdict(&header.log(steps));
    let no_bound =
        |value: &str| format!("rejected: the curvature does not bound column 0 (x) by {value}");
    let open = "rejected: the claim is not proved: context 0 is not closed";
    // x² - 2x is 3 at -1, but falls from there to the right.
    let steep = Header {
        columns: &["c -9 9 x"],
        linear: "1 0 -2",
        squares: "1 0 0 2",
        claim: "bound 3",
        ..BOWL
    };
    let steps = "p 1 0 -2\n l 0\n w 1 0 -1 1 0 4 1 0 L -1";
    assert_eq!(said(&steep, steps), open);
    assert_eq!(said(&steep, &steps.replace("0 L -1", "0 U -1")), no_bound("-1"));
    assert_eq!(said(&steep, &steps.replace("0 L -1", "0 L -0.5")), no_bound("-0.5"));
    // -x² - 2x is 1 at -1 and falls as well, where the column has a deficit.
    let arch = Header { columns: &["c -1 1 x"], squares: "1 0 0 -2", claim: "bound 0", ..steep };
    assert_eq!(said(&arch, "p 1 0 2\n l 0\n w 0 0 1 0 U -1"), no_bound("-1"));
    // x² - y² is at least x² - 1 for y within [-1, 1].
    let saddle = Header {
        columns: &["c -9 9 x", "c -1 1 y"],
        linear: "",
        squares: "2 0 0 2 1 1 -2",
        claim: "bound 0",
        ..BOWL
    };
    let steps = "p 2 0 -2 1 2\n l 0\n w 0 0 2 0 U 1 0 L -1";
    assert_eq!(said(&saddle, steps), open);
    assert_eq!(said(&saddle, &steps.replace("0 U 1", "0 U 0.5")), no_bound("0.5"));
    let free = Header { columns: &["c -9 9 x", "c -1 inf y"], ..saddle };
    assert_eq!(said(&free, steps), "rejected: column 1 has a deficit and is not bounded");
}
