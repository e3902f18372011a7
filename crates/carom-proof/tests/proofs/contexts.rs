//! Splits, lemmas, and what a context leaves behind.

use crate::log::{Header, assert_broken, verdict};

/// 2x + 2y = 3 for whole x and y.
const PARITY: Header = Header {
    columns: &["i 0 1 x", "i 0 1 y", "c 0 1 z"],
    rows: &["3 3 2 0 2 1 2 odd"],
    cones: &[],
    linear: "",
    squares: "",
    claim: "infeasible",
};

#[test]
fn a_split_of_a_column() {
    // x <= 0: 2y >= 3. x >= 1: 2y <= 1, so y <= 0, and 2x + 2y >= 3 fails.
    let log = PARITY.log("s 0 0\n x 1 0 1\n b 1 U 0 0\n x 1 0 1");
    assert_broken(
        &log,
        &[
            ("s 0 0", "s 2 0", "rejected: column 2 (z) is not integral"),
            ("s 0 0", "s 0 0.5", "rejected: 0.5 is not whole, or too large"),
            ("s 0 0", "s 0 9007199254740992", {
                "rejected: 9007199254740992 is not whole, or too large"
            }),
            ("s 0 0", "s 0 1", {
                "rejected: the combination is no contradiction: it holds with 1 to spare"
            }),
            ("b 1 U 0 0", "b 1 L 0 0", {
                "rejected: the combination is no contradiction: it holds with 1 to spare"
            }),
        ],
    );
    // What the first side derives is not known on the second one.
    let leak = PARITY.log("s 0 0\n b 1 L 2 0\n d 1\n d 1");
    assert_eq!(verdict(&leak), "rejected: column 1 (y) may be from 0 to 1");
    let leak = PARITY.log("s 0 0\n k 1 0 1\n x 1 1 1\n x 1 1 1");
    assert_eq!(verdict(&leak), "rejected: there is no fact 1; their number is 1");
    let open = PARITY.log("s 0 0\n x 1 0 1");
    assert_eq!(verdict(&open), "rejected: the claim is not proved: context 1 is not closed");
}

#[test]
fn splits_in_splits_close_together() {
    let log = PARITY.log("s 0 0\n s 1 0\n x 1 0 1\n x 1 0 1\n s 1 0\n x 1 0 1\n x 1 0 -1");
    assert_eq!(verdict(&log), "proved: no point (7 steps)");
    let more = PARITY.log("s 0 0\n x 1 0 1\n s 1 0\n x 1 0 1\n x 1 0 -1\n d 0");
    assert_eq!(verdict(&more), "rejected: the claim is proved, so that only `end` can follow");
}

#[test]
fn a_split_of_a_form() {
    // x + y <= 1 or x + y >= 2, each against 2x + 2y = 3.
    let log = PARITY.log("f 1 2 0 1 1 1\n x 2 0 1 1 -2\n x 2 0 -1 1 2");
    assert_broken(
        &log,
        &[
            ("f 1 2 0 1 1 1", "f 1 2 0 1 2 1", {
                "rejected: the form is not whole: its columns or its coefficients"
            }),
            ("f 1 2 0 1 1 1", "f 1 2 0 1 1 0.5", {
                "rejected: the form is not whole: its columns or its coefficients"
            }),
            ("f 1 2 0 1 1 1", "f 1.5 2 0 1 1 1", "rejected: 1.5 is not whole, or too large"),
            ("f 1 2 0 1 1 1", "f 1 2 0 1 0 1", "unreadable: column 0 is listed twice"),
            ("f 1 2 0 1 1 1", "f 2 2 0 1 1 1", {
                "rejected: the combination is no contradiction: it holds with 1 to spare"
            }),
            (
                "x 2 0 -1 1 2",
                "x 2 0 1 1 -2",
                "rejected: fact 1 has no upper side, for multiplier -2",
            ),
        ],
    );
}

#[test]
fn a_lemma_of_whole_numbers() {
    // x + y <= 1, because otherwise x + y >= 2. Then x + y >= 1.5 fails.
    let log = PARITY.log("m U 1 2 0 1 1 1\n x 2 0 -1 1 2\n x 2 0 1 1 -2");
    assert_broken(
        &log,
        &[
            ("m U 1 2", "m U 0 2", {
                "rejected: the combination is no contradiction: it holds with 1 to spare"
            }),
            ("m U 1 2", "m U 1.25 2", {
                "rejected: the combination is no contradiction: it holds with 0.5 to spare"
            }),
            ("m U 1 2 0 1 1 1", "m U 1 3 0 1 1 1 2 1", {
                "rejected: the combination is no contradiction: it holds with 3 to spare"
            }),
            ("m U 1 2", "m L 1 2", "rejected: fact 1 has no lower side, for multiplier 2"),
        ],
    );
    let lower = PARITY.log("m L 2 2 0 1 1 1\n x 2 0 1 1 -2\n x 2 0 -1 1 2");
    assert_eq!(verdict(&lower), "proved: no point (3 steps)");
}

#[test]
fn a_lemma_of_any_numbers() {
    // 2x + 2y <= 3.5 otherwise 2x + 2y >= 3.5; not less: 3.
    let log =
        PARITY.log("m U 1.75 2 0 1 1 1\n x 2 0 -1 1 2\n s 0 0\n x 1 0 1\n b 1 U 0 1\n x 1 0 1");
    assert_broken(
        &log,
        &[("m U 1.75", "m U 1.5", {
            "rejected: the combination is no contradiction: it holds with 0 to spare"
        })],
    );
    // A lemma ends with its context, and takes the number of its negation.
    let gone = PARITY.log("s 0 0\n m U 2 1 0 1\n x 1 1 1\n x 1 0 1\n x 1 1 1");
    assert_eq!(verdict(&gone), "rejected: there is no fact 1; their number is 1");
}
