//! The header, the end, points, and texts that are no logs.

use crate::log::{Header, assert_broken, verdict};

const BOX: Header = Header {
    columns: &["c 0 1 a name of words", "i 0 3 n"],
    rows: &["-inf 1.5 2 0 1 1 1"],
    cones: &["q 0 1 1"],
    linear: "1 0 1",
    squares: "1 1 1 2",
    claim: "bound -0.5",
};
const STEPS: &str = "p 0\n l 0\n t 0\n a 2 0 0.5 1 2\n x 1 1 -1";

#[test]
fn texts_that_are_no_logs() {
    assert_broken(
        &BOX.log(STEPS),
        &[
            ("carom proof 1", "carom proof 2", "unreadable: this is no log of version 1"),
            ("carom proof 1", "proof 1", "unreadable: there is `proof` instead of `carom`"),
            ("sense min", "sense mid", "unreadable: the sense is neither `min` nor `max`"),
            ("columns 2", "columns 3", "unreadable: there is `rows` instead of `c`"),
            ("columns 2", "columns 1", "unreadable: there is `c` instead of `rows`"),
            ("columns 2", "columns 4294967295", "unreadable: there is `rows` instead of `c`"),
            ("columns 2", "columns -2", {
                "unreadable: the number of columns, `-2`, is no whole number"
            }),
            ("c c 0 1", "c x 0 1", "unreadable: a column is neither `i` nor `c`"),
            ("c c 0 1", "c c inf 1", "unreadable: a limit has the wrong infinity"),
            ("c c 0 1", "c c NaN 1", "unreadable: the lower limit, `NaN`, is no number"),
            ("c c 0 1", "c c infinity 1", "unreadable: the lower limit, `infinity`, is no number"),
            ("c c 0 1", "c c 1e999 1", "unreadable: the lower limit, `1e999`, is too large"),
            ("r -inf 1.5 2", "r -inf 1.5 4294967295", {
                "unreadable: the line ends where the column must be"
            }),
            ("r -inf 1.5 2 0 1 1 1", "r -inf 1.5 2 0 1 2 1", {
                "rejected: there is no column 2; their number is 2"
            }),
            ("r -inf 1.5 2 0 1 1 1", "r -inf 1.5 2 0 1 0 1", {
                "unreadable: column 0 is listed twice"
            }),
            ("h 1 1 1 2", "h 1 1 0 2", "unreadable: entry 1 0 is below the diagonal"),
            ("h 1 1 1 2", "h 2 1 1 2 1 1 2", "unreadable: entry 1 1 is listed twice"),
            ("claim bound", "claim bounds", {
                "unreadable: the claim is neither `bound` nor `infeasible`"
            }),
            ("bound -0.5", "bound -inf", "unreadable: the bound is infinite"),
            ("x 1 1 -1", "g", "unreadable: there is no command `g`"),
            ("a 2 0 0.5 1 2", "a 2 0 0.5 2 2", "rejected: there is no column 2; their number is 2"),
            ("end 5", "end 4", "rejected: there are 5 commands, other than `end` says"),
            ("end 5", "end 5\nd 0", "unreadable: the log goes on behind `end`"),
            ("end 5", "", "rejected: the log ends without a line `end`"),
            ("x 1 1 -1\nend 5", "end 4", {
                "rejected: the claim is not proved: context 0 is not closed"
            }),
        ],
    );
    assert_eq!(verdict(""), "unreadable: the log ends where a line `carom` must be");
    assert!(carom_proof::check(&b"carom proof 1\nsense \xff\n"[..]).is_err());
}

#[test]
fn comments_blanks_and_the_sense() {
    let log = BOX.log(STEPS).replace("t 0\n", "# t 1\n\n   t   0 \r\n").replace("end", " end");
    assert_eq!(verdict(&log), "proved: objective >= -0.5 (5 steps)");
    let log = log.replace("sense min", "sense max") + "# the end\n\n";
    assert_eq!(verdict(&log), "proved: objective <= 0.5 (5 steps)");
}

#[test]
fn points_are_judged() {
    let judged = |point: &str| {
        let log = BOX.log(&STEPS.replace("a 2 0 0.5 1 2", point));
        carom_proof::check(log.as_bytes()).expect("it is a proof").points[0].to_string()
    };
    assert_eq!(judged("a 0"), "point: objective 0, largest violation 0");
    assert_eq!(judged("a 2 0 1 1 0.25"), "point: objective 1.0625, largest violation 0.25");
    assert_eq!(judged("a 1 0 -3"), "point: objective -3, largest violation 3");
    assert_eq!(judged("a 2 1 2 0 0.5"), "point: objective 4.5, largest violation 1.5");
    assert_eq!(judged("a 1 1 3"), "point: objective 9, largest violation 3");
}

#[test]
fn a_point_that_is_far_from_the_program_is_rejected() {
    let header = Header { cones: &[], ..BOX };
    let said = |point: &str| verdict(&header.log(&STEPS.replace("a 2 0 0.5 1 2", point)));
    assert_eq!(said("a 2 0 0.5 1 1.0009"), "proved: objective >= -0.5 (5 steps)");
    assert_eq!(said("a 2 0 0.5 1 2"), "rejected: the point misses row 0 () by 1");
    assert_eq!(
        said("a 2 0 0 1 0.5"),
        "rejected: the point misses a whole number of column 1 (n) by 0.5"
    );
    assert_eq!(said("a 1 0 -0.25"), {
        "rejected: the point misses a bound of column 0 (a name of words) by 0.25"
    });
    // Of large terms, the rounding is allowed.
    let large =
        Header { columns: &["c 0 1e13 a", "c 0 1e13 b"], rows: &["0 0 2 0 1 1 -1"], ..header };
    let large = Header { linear: "1 0 1", squares: "", claim: "bound -1", ..large };
    let said = |point: &str| verdict(&large.log(&format!("t 0\n {point}\n x 1 1 -1")));
    assert_eq!(said("a 2 0 1e13 1 10000000000010"), "proved: objective >= -1 (3 steps)");
    assert_eq!(
        said("a 2 0 1e13 1 10000000000030"),
        "rejected: the point misses a bound of column 1 (b) by 30"
    );
    assert_eq!(said("a 2 0 1e13 1 9999999999970"), "rejected: the point misses row 0 () by 30");
    // A term beyond all floats allows no more than a float of the largest size.
    let beyond = Header { columns: &["c 0 inf a"], rows: &["-inf 0 1 0 1e300"], ..large };
    let said = |point: &str| verdict(&beyond.log(&format!("t 0\n {point}\n x 1 1 -1")));
    assert_eq!(said("a 1 0 1e300"), "rejected: the point misses row 0 () by inf");
}

#[test]
fn numbers_without_end_are_refused() {
    // Each combination is 2^1000 times the one before.
    let header = Header { columns: &["c 1 1 x"], rows: &["1 1 1 0 1"], ..BOX };
    let header = Header { cones: &[], linear: "", squares: "", claim: "infeasible", ..header };
    let steps: String = (0..20).map(|fact| format!("k 1 {fact} 1e300\n")).collect();
    assert_eq!(
        verdict(&header.log(&steps)),
        "rejected: the numbers are too large or too fine for this checker"
    );
}

#[test]
fn the_example_of_the_page() {
    let page = include_str!("../../../../docs/proofs.md");
    let example = include_str!("../logs/cap.proof");
    assert!(page.contains(&format!("```text\n{example}```\n")));
    assert!(page.contains(&format!("```text\n{}\n```\n", verdict(example))));
}
