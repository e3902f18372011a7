//! The options of `solve`, its header, its files and its exit status.

use crate::{LP, file, solve};

const MPS: &str = "NAME m\nROWS\n N obj\n G r\nCOLUMNS\n x obj 1 r 2\nRHS\n RHS r 5\nBOUNDS\n UP BND x 9\nENDATA\n";
const CBF: &str = "VER\n3\nOBJSENSE\nMIN\nVAR\n1 1\nL+ 1\nCON\n1 1\nL+ 1\nOBJACOORD\n1\n0 1.0\nACOORD\n1\n0 0 2.0\nBCOORD\n1\n0 -5.0\n";
const CONTRADICTORY: &str = "minimize\n obj: x\nsubject to\n low: x + y <= 1\n high: x + y >= 3\n\
                             idle: x - y <= 7\nbounds\n x <= 9\n y <= 9\nend\n";

#[test]
fn the_format_of_the_standard_input_is_recognised_or_told() {
    for (text, objective) in [(LP, "13"), (MPS, "2.5"), (CBF, "2.5")] {
        let said = solve(&["-"], text.as_bytes());
        assert_eq!((said.code, said.figure("status")), (Some(0), "optimal"), "{said:?}");
        assert_eq!(said.figure("objective"), objective);
    }
    for (format, text) in [("lp", LP), ("MPS", MPS), ("cbf", CBF)] {
        let said = solve(&["-", "--format", format], text.as_bytes());
        assert_eq!(said.code, Some(0), "{said:?}");
    }
    // Told wrongly, the reader says what is wrong, and where it came from.
    let said = solve(&["-", "--format", "mps"], LP.as_bytes());
    assert_eq!(said.code, Some(1), "{said:?}");
    assert!(said.err.starts_with("solve: standard input: line "), "{said:?}");
    // An extension does not matter then.
    let path = file("an_lp.mps", LP.as_bytes());
    let said = solve(&[path.to_str().unwrap(), "--format", "lp"], b"");
    assert_eq!((said.code, said.figure("objective")), (Some(0), "13"));
}

#[test]
fn results_are_on_the_output_and_all_else_is_not() {
    let said = solve(&["-"], LP.as_bytes());
    let out: Vec<&str> = said.out.lines().collect();
    assert_eq!(out.len(), 2, "{said:?}");
    assert_eq!(out[0], "rows=2 columns=3 integers=3 nonzeros=5");
    assert!(out[1].starts_with("status=optimal objective=13 bound=13 nodes="), "{said:?}");
    let err: Vec<&str> = said.err.lines().collect();
    assert_eq!(err[0], concat!("carom ", env!("CARGO_PKG_VERSION")));
    assert_eq!(err[1], "2 rows, 3 columns (3 integral), 5 nonzeros");
    assert_eq!(
        err[2],
        "magnitudes: matrix 0.5 to 4, objective 1 to 3, bounds 1 to 3, right sides 0.5 to 11"
    );
    assert!(err[3].starts_with("presolve left "), "{said:?}");
    let quiet = solve(&["--quiet", "-"], LP.as_bytes());
    assert_eq!(quiet.err, "");
    assert_eq!(quiet.out.lines().next(), said.out.lines().next());
}

#[test]
fn letters_are_explained_before_they_appear() {
    let knapsack: String = (0..18).fold("maximize\n obj:".to_owned(), |text, k| {
        text + &format!(" + {} x{k}", 37 + (k * 29) % 41)
    });
    let knapsack = (0..18).fold(knapsack + "\nsubject to\n c:", |text, k| {
        text + &format!(" + {} x{k}", 31 + (k * 17) % 43)
    });
    let knapsack = (0..18)
        .fold(knapsack + " <= 411\nbinary\n", |text, k| text + &format!(" x{k}\n"))
        + "end\n";
    let said = solve(&["-"], knapsack.as_bytes());
    assert_eq!(said.figure("status"), "optimal", "{said:?}");
    let lines: Vec<&str> = said.err.lines().collect();
    let place = |text: &str| lines.iter().position(|line| line.contains(text));
    let explained = place("new best points are marked by their source: ").unwrap();
    assert!(place("bound of the root ").unwrap() < explained, "{said:?}");
    let heading = place("incumbent            bound").unwrap();
    assert!(explained < heading, "{said:?}");
    let marks: Vec<char> = lines[heading + 1..]
        .iter()
        .filter(|line| line.len() == lines[heading].len() && !line.starts_with(' '))
        .filter_map(|line| line.chars().next())
        .collect();
    assert!(!marks.is_empty(), "{said:?}");
    for mark in marks {
        assert!(lines[explained].contains(&format!(" {mark} ")), "{mark}: {said:?}");
    }
}

#[test]
fn a_written_solution_is_a_start() {
    let path = file("start.sol", b"");
    let path = path.to_str().unwrap();
    let said = solve(&["-", "--solution", path], LP.as_bytes());
    assert_eq!(said.code, Some(0), "{said:?}");
    assert_eq!(said.out.lines().count(), 2, "the values are in the file");
    let written = std::fs::read_to_string(path).unwrap();
    assert_eq!(written, "# Status: optimal\n# Objective value = 13\nx 2\ny 3\nz 1\n");
    let said = solve(&["-", "--start", path], LP.as_bytes());
    assert!(said.err.lines().any(|line| line == "start: accepted"), "{said:?}");
    // Printed: at the end, before another option, or as `-`.
    for words in
        [&["-", "--solution"][..], &["--solution", "--quiet", "-"], &["-", "--solution", "-"]]
    {
        let said = solve(words, LP.as_bytes());
        let values: Vec<&str> = said.out.lines().skip(1).take(3).collect();
        assert_eq!(values, ["x = 2", "y = 3", "z = 1"], "{said:?}");
        assert_eq!(said.figure("status"), "optimal");
    }
    // Without a point, the file does not keep an old one.
    let said = solve(&["-", "--solution", path], CONTRADICTORY.as_bytes());
    assert_eq!((said.code, said.figure("status")), (Some(0), "infeasible"));
    assert_eq!(std::fs::read_to_string(path).unwrap(), "# Status: infeasible\n");
    // What cannot be written shows before the work.
    let said = solve(&["-", "--solution", "/no/such/folder/a.sol"], LP.as_bytes());
    assert_eq!(said.code, Some(1));
    assert!(said.err.contains("solve: /no/such/folder/a.sol: "), "{said:?}");
    assert!(!said.err.contains("presolve left"), "{said:?}");
}

#[test]
fn contradictions_are_explained_if_asked_for() {
    let said = solve(&["-", "--explain"], CONTRADICTORY.as_bytes());
    assert_eq!((said.code, said.figure("status")), (Some(0), "infeasible"));
    let explanation: Vec<&str> = said.out.lines().skip(1).collect();
    let explanation = explanation[..explanation.len() - 1].join("\n");
    assert!(explanation.contains("low") && explanation.contains("high"), "{said:?}");
    assert!(!explanation.contains("idle"), "{said:?}");
    let said = solve(&["-"], CONTRADICTORY.as_bytes());
    assert_eq!(said.out.lines().count(), 2, "{said:?}");
    let said = solve(&["-", "--explain"], LP.as_bytes());
    assert_eq!(said.out.lines().count(), 2, "nothing to explain: {said:?}");
}

#[test]
fn wrong_words_are_told_from_wrong_files() {
    let said = solve(&["--version"], b"");
    assert_eq!(
        (said.code, &*said.out),
        (Some(0), concat!("carom ", env!("CARGO_PKG_VERSION"), "\n"))
    );
    let help = solve(&["--help"], b"");
    for word in
        ["--explain", "--solution", "--quiet", "--format", "Ctrl-C", "exit status: 0", "130"]
    {
        assert!(help.out.contains(word), "{word}");
    }
    for (words, error) in [
        (&[][..], "solve: usage: solve FILE"),
        (&["--color", "-"], "solve: unexpected `--color`"),
        (&["-", "another"], "solve: unexpected `another`"),
        (&["-", "--threads"], "solve: --threads needs a value"),
        (&["-", "--threads", "two"], "solve: --threads cannot be `two`"),
        (&["-", "--time-limit", "-1"], "solve: --time-limit cannot be `-1`"),
        (
            &["-", "--format", "xls"],
            "solve: no format is called `xls`; there are mps, lp, cbf, qplib, nl and json",
        ),
        (
            &["--solution", "model.mps"],
            "solve: `--solution model.mps` writes to that file, and no file",
        ),
    ] {
        let said = solve(words, b"");
        assert_eq!((said.code, &*said.out), (Some(2), ""), "{words:?}: {said:?}");
        assert!(said.err.starts_with(error), "{words:?}: {said:?}");
    }
    let said = solve(&["/no/such/file.lp"], b"");
    assert_eq!(said.code, Some(1));
    assert!(said.err.starts_with("solve: /no/such/file.lp: "), "{said:?}");
    let said = solve(&["-"], b"\xff\xfe");
    assert_eq!(said.code, Some(1));
    assert!(
        said.err.starts_with("solve: standard input: line 1, column 1: this is no text"),
        "{said:?}"
    );
}

#[test]
fn warnings_are_counted_by_kind() {
    let bounds: String = (0..10).map(|k| format!(" y{k} <= {k}\n")).collect();
    let text = format!("min x\nst\n c: x >= 1\nbounds\n{bounds} x <= 3\n x <= 2\nend\n");
    let said = solve(&["-"], text.as_bytes());
    let warnings: Vec<&str> = said.err.lines().filter(|line| line.starts_with("warning")).collect();
    assert_eq!(
        warnings,
        [
            "warning: standard input: line 5, column 2: `y0` is neither in the objective nor in a row before",
            "warning: standard input: line 6, column 2: `y1` is neither in the objective nor in a row before",
            "warning: standard input: line 7, column 2: `y2` is neither in the objective nor in a row before",
            "warning: standard input: 7 more of this kind",
            "warning: standard input: line 16, column 2: the upper bound of `x` was 3 before and is 2 now; the \
             last one counts",
        ],
        "{said:?}"
    );
    let quiet = solve(&["--quiet", "-"], text.as_bytes());
    assert_eq!(quiet.err, "");
}

#[test]
fn a_gap_says_that_it_leaves_out_a_constant() {
    let text = "min 3 a + 4 b + 5 c + 100000000 one\nst\n r1: a + b >= 1\n r2: b + c >= 1\n r3: a + c >= 1\nbounds\n \
                one = 1\nbinary\n a b c\nend\n";
    let said = solve(&["--gap", "1", "-"], text.as_bytes());
    let summary = said.err.lines().find(|line| line.contains("proved bound")).expect("a summary");
    let is_closed = summary.contains("gap 0 %");
    assert!(
        is_closed || summary.contains(" of the objective without its constant 100000000"),
        "{said:?}"
    );
}

#[test]
fn an_explanation_says_which_domains_are_defaults() {
    let text = "min x\nst\n c: x + y <= -1\nbounds\n y <= 5\nend\n";
    let said = solve(&["--explain", "-"], text.as_bytes());
    let domains: Vec<&str> = said.out.lines().filter(|line| line.starts_with("domain: ")).collect();
    assert_eq!(
        domains,
        [
            "domain: 0 <= x (the default of LP files, where the file gives no bounds)",
            "domain: 0 <= y <= 5 (a lower bound of 0 is the default of LP files)",
        ],
        "{said:?}"
    );
}
