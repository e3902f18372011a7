//! Model files against headers of logs.

use carom_proof::compare::{Format, compare};
use proptest::prelude::*;
use proptest::sample::Index;

const HEADER: &str = "\
carom proof 1
sense max
columns 4
c c 0 4 x
c c -inf inf y
c i 0 1 b
c i -2 7 n
rows 3
r -inf 10 2 0 1 1 2 cap
r 1 5 2 1 -1 3 1 both
r 2 2 3 0 1 2 -3 3 0.5 same
cones 0
objective -1.5
g 2 0 -2 2 1
h 2 0 0 2 0 1 -1
claim infeasible
proof
";

const MPS: &str = "\
* a comment
NAME test
OBJSENSE
    MAX
ROWS
 N cost
 L cap $ a comment
 G both
 E same
 N other
COLUMNS
    x cost 2.0 cap 1
    x same 1
    y cap 2 both -1
    MARK0 'MARKER' 'INTORG'
    b cost -1 same -3
    n both 1 same 0.5
    MARK1 'MARKER' 'INTEND'
RHS
    RHS cap 10 both 1
    RHS same 2 cost -1.5
RANGES
    R both 4
BOUNDS
 UP B x 4
 FR B y
 LO B n -2
 UP B n 7.5
QUADOBJ
    x x -2
    x y 1
ENDATA
";

const LP: &str = "\
\\ a comment
Maximize
 obj: 2 x - b + 1.5 + [ - 2 x ^2 + 2 x * y ] / 2
Subject To
 cap: x + 2 y <= 10
 low: - y + n >= 1
 high: y - n >= -5
 x - 3 b
   + 0.5 n = 2
Bounds
 x <= 4
 y free
 -2 <= n <= 7
General
 n
Binary
 b
End
";

fn said(text: &str, format: Format, header: &str) -> String {
    match compare(text, format, header.as_bytes()) {
        Ok(comparison) => comparison.to_string(),
        Err(unreadable) => unreadable.to_string(),
    }
}

/// The same program as it stands, and the difference that each change of the model makes.
#[track_caller]
fn changed(text: &str, format: Format, header: &str, changes: &[(&str, &str, &str)]) {
    let same = said(text, format, header);
    assert!(same.starts_with("the same program: "), "{same}");
    for (from, to, difference) in changes {
        assert_eq!(text.matches(from).count(), 1, "`{from}` must be there once");
        let found = said(&text.replace(from, to), format, header);
        assert_eq!(found, format!("another program: {difference}"), "`{from}` to `{to}`");
    }
}

#[test]
fn mps_files() {
    assert_eq!(said(MPS, Format::Mps, HEADER), "the same program: 4 columns, 3 rows");
    changed(
        MPS,
        Format::Mps,
        HEADER,
        &[
            ("    MAX\n", "    MIN\n", "the sense of the objective"),
            ("y cap 2 both", "y cap 2.5 both", "row cap is not in the log"),
            ("cap 10", "cap 11", "row cap: from -inf to 11, and from -inf to 10 in the log"),
            ("both 4\n", "both 3\n", "row both: from 1 to 4, and from 1 to 5 in the log"),
            (" G both", " N both", "row both is not in the model"),
            ("UP B x 4", "UP B x 5", {
                "column x: continuous from 0 to 5 in the model, continuous from 0 to 4 in the log"
            }),
            (" FR B y\n", "", {
                "column y: continuous from 0 to inf in the model, continuous from -inf to inf in \
                 the log"
            }),
            ("n 7.5", "n 6.5", {
                "column n: integral from -2 to 6 in the model, integral from -2 to 7 in the log"
            }),
            ("    MARK1", "    z cap 1\n    MARK1", "the model has 5 columns, the log 4"),
            ("cost 2.0", "cost 2.5", "the cost of x"),
            ("cost -1.5", "cost -1", "the constant is 1 in the model, 1.5 in the log"),
            ("    x y 1\n", "    x y 2\n", "the cost of x times y"),
            ("    x x -2\n", "", "the cost of x times x"),
        ],
    );
    let left = MPS.replace("QUADOBJ", "SOS\n S1 set\n    x 1\n    y 2\nQUADOBJ");
    assert_eq!(said(&left, Format::Mps, HEADER), {
        "the same program: 4 columns, 3 rows; not compared: ordered sets"
    });
    let further = HEADER.replace("columns 4", "columns 5").replace("rows 3", "c c 0 1 z\nrows 3");
    assert_eq!(said(MPS, Format::Mps, &further), {
        "another program: the model has 4 columns, the log 5"
    });
    assert!(said(&left, Format::Mps, &further).starts_with("the same program: "));
    // Sets become no rows of a single column, and no other bounds.
    let single = HEADER.replace("rows 3", "rows 4\nr -inf 3 1 0 1 r");
    let other = "column x: continuous from 0 to 4 in the model, continuous from 0 to 3 in the log";
    assert_eq!(said(MPS, Format::Mps, &single), format!("another program: {other}"));
    assert_eq!(said(&left, Format::Mps, &single), format!("another program: {other}"));
    let tighter = HEADER.replace("c c 0 4 x", "c c 0 3 x");
    assert_eq!(said(&left, Format::Mps, &tighter), format!("another program: {other}"));
}

#[test]
fn lp_files() {
    assert_eq!(said(LP, Format::Lp, HEADER), "the same program: 4 columns, 4 rows");
    changed(
        LP,
        Format::Lp,
        HEADER,
        &[
            ("+ 0.5 n", "- 0.5 n", "row c4 is not in the log"),
            (">= -5", ">= -6", "row low: from 1 to 6, and from 1 to 5 in the log"),
            (" n\nBinary", " n x\nBinary", {
                "column x: integral from 0 to 4 in the model, continuous from 0 to 4 in the log"
            }),
            (" x <= 4\n", " x <= 4\n x >= 1e-9\n", {
                "column x: continuous from 1e-9 to 4 in the model, continuous from 0 to 4 in the log"
            }),
            ("2 x - b", "2 x - 2 b", "the cost of b"),
            (" + 1.5", "", "the constant is 0 in the model, 1.5 in the log"),
            ("] / 2", "]", "the cost of x times x"),
            ("Maximize", "Minimize", "the sense of the objective"),
        ],
    );
    let empty = LP.replace("Bounds", " e: = 0\nBounds");
    assert_eq!(said(&empty, Format::Lp, HEADER), "the same program: 4 columns, 5 rows");
    let constant = LP.replace("+ 1.5", "+ 1.5 Constant").replace("Bounds", "Bounds\n Constant = 1");
    assert_eq!(said(&constant, Format::Lp, HEADER), "the same program: 5 columns, 4 rows");
    assert_eq!(said(&LP.replace("<= 10", "<="), Format::Lp, HEADER), {
        "the model cannot be read: a number must be near `2 y <= low : -`"
    });
}

const CONIC: &str = "\
carom proof 1
sense min
columns 4
c c 0 inf t
c c -inf inf u
c c -inf inf v
c i 0 3 n
rows 1
r 2 inf 2 1 1 3 -1 r
cones 1
q 0 2 1 2
objective 1
g 1 0 1
h 0
claim bound 0
proof
";

const CBF: &str = "\
VER
1
OBJSENSE
MIN
VAR
4 2
Q 3
L+ 1
INT
1
3
CON
2 2
L- 1
L+ 1
OBJACOORD
1
0 1
OBJBCOORD
1
ACOORD
3
0 3 1
1 1 1
1 3 -1
BCOORD
2
0 -3
1 -2
";

#[test]
fn cbf_files() {
    assert_eq!(said(CBF, Format::Cbf, CONIC), "the same program: 4 columns, 2 rows");
    changed(
        CBF,
        Format::Cbf,
        CONIC,
        &[
            ("Q 3\nL+ 1\n", "F 3\nL+ 1\n", {
                "column x[0]: continuous from -inf to inf in the model, continuous from 0 to inf \
                 in the log"
            }),
            ("0 -3\n", "0 -4\n", {
                "column x[3]: integral from 0 to 4 in the model, integral from 0 to 3 in the log"
            }),
            ("1 -2\n", "1 2\n", "row c[1]: from -2 to inf, and from 2 to inf in the log"),
        ],
    );
    // Cones without open entries say nothing, or something of their heads.
    let rotated =
        CBF.replace("CON\n2 2\n", "CON\n8 4\n").replace("L+ 1\nOBJ", "L+ 1\nQR 3\nQR 3\nOBJ");
    assert_eq!(said(&rotated, Format::Cbf, CONIC), "the same program: 4 columns, 2 rows");
    let fewer = CONIC.replace("cones 1\nq 0 2 1 2\n", "cones 0\n");
    let missing = "another program: the cone with the head x[0]";
    assert_eq!(said(CBF, Format::Cbf, &fewer), missing);
}

/// Rows with products of columns, as cones of the log.
#[test]
fn quadratic_rows() {
    let model = "Minimize\n obj: x\nSubject To\n r0: [ x^2 + y^2 ] <= 4\n r1: x + y >= -3\nBounds\n \
                 0 <= x <= 3\n -3 <= y <= 3\nEnd\n";
    let log = "carom proof 1\nsense min\ncolumns 3\nc c 0 3 x\nc c -3 3 y\nc c 2 2 -\nrows 1\n\
               r -3 inf 2 0 1 1 1 r1\ncones 1\nq 2 2 0 1\nobjective 0\ng 1 0 1\nh 0\nclaim infeasible\nproof\n";
    assert_eq!(said(model, Format::Lp, log), {
        "the same program: 2 columns, 1 row; compared up to rounding: the squares of row r0"
    });
    for (from, to, difference) in [
        ("rows 1\n", "rows 2\nr 5 inf 2 0 1 1 -1 more\n", "row more is only in the log"),
        ("rows 1\n", "rows 2\nr 5 inf 1 0 1 more\n", {
            "column x: continuous from 0 to 3 in the model, continuous from 5 to 3 in the log"
        }),
        ("rows 1\n", "rows 2\nr 0 0 2 0 1 2 -1 more\n", {
            "the cone with the head 2 is only in the log"
        }),
        ("c c 2 2 -", "c c 1.9 1.9 -", "the cone with the head 2 is only in the log"),
        ("c c 2 2 -", "c c 0 2 -", "the cone with the head 2 is only in the log"),
        ("q 2 2 0 1", "q 2 1 0", "the cone with the head 2 is only in the log"),
        ("cones 1\nq 2 2 0 1", "cones 2\nq 2 2 0 1\nq 2 1 1", {
            "the cone with the head 2 is only in the log"
        }),
        ("cones 1\nq 2 2 0 1\n", "cones 0\n", "not in the log: the squares of row r0"),
        ("c c -3 3 y", "c i -3 3 y", {
            "column y: continuous from -3 to 3 in the model, integral from -3 to 3 in the log"
        }),
        ("c c -3 3 y", "c c 0 3 y", {
            "column y: continuous from -3 to 3 in the model, continuous from 0 to 3 in the log"
        }),
    ] {
        assert_eq!(log.matches(from).count(), 1, "{from}");
        let found = said(model, Format::Lp, &log.replace(from, to));
        assert_eq!(found, format!("another program: {difference}"), "`{from}` to `{to}`");
    }
    // A head that is a column of the model is at least 0.
    let model = "Minimize\n obj: x1\nSubject To\n r: - x1 + [ x1^2 - 2 x0 * x1 + x0^2 ] <= 0\n s: x0 + x1 >= 1\n\
                 Bounds\n x0 <= 3\n -5 <= x1 <= 5\nEnd\n";
    let log = "carom proof 1\nsense min\ncolumns 4\nc c 0 5 x1\nc c 0 3 x0\nc c 1 1 -\nc c -inf inf -\nrows 2\n\
               r 1 inf 2 1 1 0 1 s\nr 0 0 3 0 1 1 -1 3 -1 -\ncones 1\nr 0 2 1 3\nobjective 0\ng 1 0 1\nh 0\n\
               claim infeasible\nproof\n";
    assert!(said(model, Format::Lp, log).starts_with("the same program: "));
    for (from, to) in [
        ("c c 0 5 x1", "c c 0.5 5 x1"),
        ("c c 0 5 x1", "c c 0 4 x1"),
        ("0 0 3 0 1 1 -1 3 -1", "0 0 3 0 1 1 -2 3 -1"),
        ("0 0 3 0 1 1 -1 3 -1", "0 1 3 0 1 1 -1 3 -1"),
        ("c c -inf inf -", "c c 0 inf -"),
        ("c c -inf inf -", "c c -inf 9 -"),
        ("c c -inf inf -", "c i -inf inf -"),
        ("c c 1 1 -", "c c 0.5 0.5 -"),
    ] {
        assert_eq!(log.matches(from).count(), 1, "{from}");
        let found = said(model, Format::Lp, &log.replace(from, to));
        assert!(found.starts_with("another program: "), "`{from}` to `{to}`: {found}");
    }
}

/// The sign of a head decides which half of a double cone is meant.
#[test]
fn signs_of_heads() {
    let model = "Minimize\n obj: y\nSubject To\n q: [ x^2 - y^2 ] <= -4\nBounds\n -3 <= x <= 3\n y <= 9\nEnd\n";
    let log = "carom proof 1\nsense min\ncolumns 3\nc c 0 9 y\nc c -3 3 x\nc c 2 2 -\nrows 0\ncones 1\nq 0 2 1 2\n\
               objective 0\ng 1 0 1\nh 0\nclaim infeasible\nproof\n";
    assert!(said(model, Format::Lp, log).starts_with("the same program: "));
    let other = log
        .replace("columns 3", "columns 4")
        .replace("rows 0", "c c 0 inf -\nrows 1\nr 0 0 2 0 -1 3 -1 -")
        .replace("q 0 2", "q 3 2");
    assert_eq!(said(model, Format::Lp, &other), {
        "another program: the cone with the head 3 is only in the log"
    });
    // x <= -1 times a head of -1 is the same polynomial, and no point has a head of -1.
    let model = "Minimize\n obj: y\nSubject To\n q: [ x^2 ] + y <= 0\nBounds\n -3 <= x <= 3\n -9 <= y <= 9\nEnd\n";
    let log = "carom proof 1\nsense min\ncolumns 4\nc c -9 9 y\nc c -3 3 x\nc c 1 1 -\nc c 0 inf -\nrows 1\n\
               r 0 0 2 0 -1 3 -1 -\ncones 1\nr 3 2 1 1\nobjective 0\ng 1 0 1\nh 0\nclaim infeasible\nproof\n";
    assert!(said(model, Format::Lp, log).starts_with("the same program: "));
    let other = log.replace("c c 1 1 -", "c c -1 -1 -").replace("0 -1 3 -1", "0 1 3 -1");
    assert!(said(model, Format::Lp, &other).starts_with("another program: "));
}

/// Rows that are conditional, semi-continuous columns and ordered sets, as rows with binaries.
#[test]
fn rows_with_binaries() {
    let model = "Minimize\n obj: x\nSubject To\n i: b = 1 -> x + y <= 3\nBounds\n x <= 5\n y <= 4\nBinary\n b\nEnd\n";
    let log = "carom proof 1\nsense min\ncolumns 3\nc c 0 5 x\nc i 0 1 b\nc c 0 4 y\nrows 1\n\
               r -inf 9 3 0 1 1 6 2 1 i_upper\ncones 0\nobjective 0\ng 1 0 1\nh 0\nclaim infeasible\nproof\n";
    assert_eq!(said(model, Format::Lp, log), "the same program: 3 columns, 0 rows");
    for (from, to, difference) in [
        ("-inf 9 3 0 1 1 6 2 1", "-inf 8 3 0 1 1 5 2 1", {
            "the big number of indicator i is too small in the log"
        }),
        ("-inf 9 3 0 1 1 6 2 1", "-inf 9 3 0 1 1 7 2 1", "not in the log: indicator i"),
        ("-inf 9 3 0 1 1 6 2 1", "-inf 1000000000002 3 0 1 1 1000000000000 2 1", {
            "not in the log: indicator i"
        }),
        ("-inf 9 3 0 1 1 6 2 1", "-inf 9 3 0 2 1 6 2 1", "not in the log: indicator i"),
        ("-inf 9 3 0 1 1 6 2 1", "1 9 3 0 1 1 6 2 1", "not in the log: indicator i"),
        ("rows 1\nr -inf 9 3 0 1 1 6 2 1 i_upper\n", "rows 0\n", "not in the log: indicator i"),
        ("rows 1\n", "rows 2\nr -inf 9 3 0 1 1 6 2 1 i\n", "row i_upper is only in the log"),
    ] {
        assert_eq!(log.matches(from).count(), 1, "{from}");
        let found = said(model, Format::Lp, &log.replace(from, to));
        let is_there = found == format!("another program: {difference}");
        assert!(
            is_there || from == "rows 1\n" && found.starts_with("another"),
            "`{from}` to `{to}`: {found}"
        );
    }
    let open = said(
        &model.replace("x <= 5", "x free"),
        Format::Lp,
        &log.replace("c c 0 5 x", "c c -inf inf x"),
    );
    assert_eq!(
        open,
        "the same program: 3 columns, 0 rows; not compared: the big number of indicator i"
    );
    // x is 0 or from 2 to 5; x or y is 0.
    let model = "Minimize\n obj: x\nSubject To\n r: x + y >= 1\nBounds\n 2 <= x <= 5\n y <= 4\n\
                 Semi-continuous\n x\nSOS\n s: S1:: x:1 y:2\nEnd\n";
    let log = "carom proof 1\nsense min\ncolumns 4\nc c 0 5 x\nc c 0 4 y\nc i 0 1 -\nc i 0 1 -\nrows 5\n\
               r 1 inf 2 0 1 1 1 r\nr -inf 0 2 0 1 2 -5 a\nr 0 inf 2 0 1 2 -2 b\nr -inf 0 2 1 1 3 -4 c\n\
               r -inf 1 2 2 1 3 1 s\ncones 0\nobjective 0\ng 1 0 1\nh 0\nclaim infeasible\nproof\n";
    assert_eq!(said(model, Format::Lp, log), {
        "the same program: 2 columns, 1 row; not compared: semi-continuous column x, ordered sets"
    });
    for (from, to) in [
        ("2 0 1 2 -5 a", "2 0 1 2 -4 a"),
        ("0 inf 2 0 1 2 -2 b", "0 inf 2 0 1 2 -3 b"),
        ("0 inf 2 0 1 2 -2 b", "0.5 inf 2 0 1 2 -2 b"),
        ("-inf 1 2 2 1 3 1 s", "-inf 0 2 2 1 3 1 s"),
        ("-inf 1 2 2 1 3 1 s", "1 1 2 2 1 3 1 s"),
        ("-inf 1 2 2 1 3 1 s", "-inf 1 2 2 1 3 2 s"),
        ("2 1 1 3 -4 c", "3 0 1 1 1 3 -4 c"),
        ("2 1 1 3 -4 c", "3 1 1 2 -4 3 -4 c"),
        ("c c 0 5 x", "c c 1 5 x"),
        ("c i 0 1 -\nrows", "c c 0 1 -\nrows"),
        ("c i 0 1 -\nrows", "c i 0 0 -\nrows"),
    ] {
        assert_eq!(log.matches(from).count(), 1, "{from}");
        let found = said(model, Format::Lp, &log.replace(from, to));
        assert!(found.starts_with("another program: "), "`{from}` to `{to}`: {found}");
    }
    // Without the set, no row may keep both from being other than 0.
    let without = model.replace("SOS\n s: S1:: x:1 y:2\n", "");
    assert_eq!(said(&without, Format::Lp, log), "another program: row c is only in the log");
}

/// Ranges are sums of decimals, names may have brackets and commas, entries may be repeated.
#[test]
fn odd_files() {
    let mps = "NAME t\nROWS\n N c\n G r\nCOLUMNS\n x[1,a] c 1 r 1\n y c 1 r 1\n y r 2\nRHS\n R r -1.2\nRANGES\n R r 2.3\nENDATA\n";
    let log = "carom proof 1\nsense min\ncolumns 2\nc c 0 inf x[1,a]\nc c 0 inf y\nrows 1\nr -1.2 1.1 2 0 1 1 3 r\n\
               cones 0\nobjective 0\ng 2 0 1 1 1\nh 0\nclaim infeasible\nproof\n";
    assert_eq!(said(mps, Format::Mps, log), "the same program: 2 columns, 1 row");
    let lp = "Minimize\n obj: x[1,a] + y\nSubject To\n r: x[1,a] + y + 2 y >= -1.2\n s: x[1,a] + 3 y <= 1.1\nEnd\n";
    assert_eq!(said(lp, Format::Lp, log), "the same program: 2 columns, 2 rows");
    let cbf = "VER\n1\nOBJSENSE\nMIN\nVAR\n2 2\nQ 1\nF 1\nCON\n1 1\nL+ 1\nOBJACOORD\n2\n0 1\n1 1\nACOORD\n2\n0 0 1\n0 1 1\n\
               BCOORD\n1\n0 3\n";
    let log = "carom proof 1\nsense min\ncolumns 2\nc c 0 inf x[0]\nc c -inf inf x[1]\nrows 1\nr -3 inf 2 0 1 1 1 c[0]\n\
               cones 0\nobjective 0\ng 2 0 1 1 1\nh 0\nclaim infeasible\nproof\n";
    assert_eq!(said(cbf, Format::Cbf, log), "the same program: 2 columns, 1 row");
}

#[test]
fn parts_of_cones() {
    let parts = CONIC
        .replace("columns 4", "columns 6")
        .replace("rows 1", "c c 0 inf part\nc c 0 inf part\nrows 2\nr -inf 0 3 0 -1 4 1 5 1 sum")
        .replace("cones 1", "cones 3\nr 4 0 1 1\nr 5 0 1 2");
    assert_eq!(said(CBF, Format::Cbf, &parts), "the same program: 4 columns, 2 rows");
    for (from, to) in [
        ("r -inf 0 3", "r -inf -1 3"),
        ("c c 0 inf part\nrows", "c c 0 1 part\nrows"),
        ("r 5 0 1 2", "r 5 0 1 1"),
        ("r 5 0 1 2", "r 5 3 1 2"),
        ("g 1 0 1", "g 2 0 1 5 1"),
        ("4 1 5 1 sum", "4 1 5 2 sum"),
    ] {
        let other = said(CBF, Format::Cbf, &parts.replace(from, to));
        assert_eq!(other, "another program: the model has 4 columns, the log 6", "{from} to {to}");
    }
    let without = parts.replace("cones 3", "cones 2").replace("q 0 2 1 2\n", "");
    assert_eq!(said(CBF, Format::Cbf, &without), {
        "another program: the model has 4 columns, the log 6"
    });
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    #[test]
    fn any_text(text in "\\PC{0,80}", place in any::<Index>(), cut in any::<Index>()) {
        for (format, model) in [(Format::Mps, MPS), (Format::Lp, LP), (Format::Cbf, "VER\n1\nVAR\n2 1\nQ 2\n")] {
            prop_assert!(!said(&text, format, HEADER).is_empty());
            let at = place.index(model.len());
            let mut changed = model.to_string();
            changed.insert_str(at, text.get(..cut.index(text.len() + 1)).unwrap_or(" "));
            prop_assert!(!said(&changed, format, HEADER).is_empty());
            changed.truncate(at);
            prop_assert!(!said(&changed, format, HEADER).is_empty());
        }
    }
}

#[test]
fn a_constant_head_keeps_its_sign() {
    let model = "Minimize\n obj: x\nSubject To\n r0: [ x^2 + y^2 ] <= 4\n r1: x + y >= -3\nBounds\n 0 <= x <= 3\n -3 <= y <= 3\nEnd\n";
    let log = "carom proof 1\nsense min\ncolumns 3\nc c 0 3 x\nc c -3 3 y\nc c -2 -2 -\nrows 1\nr -3 inf 2 0 1 1 1 r1\ncones 1\nq 2 2 0 1\nobjective 0\ng 1 0 1\nh 0\nclaim infeasible\nproof\n";
    let text = said(model, Format::Lp, log);
    assert!(text.starts_with("another"), "{text}");
}

#[test]
fn a_head_is_not_its_tail() {
    // x^2 <= y^2 with y >= 0: the log has the cone of the other head.
    let model = "Minimize\n obj: y\nSubject To\n q: [ x^2 - y^2 ] <= 0\nBounds\n 0 <= x <= 3\n y <= 9\nEnd\n";
    let log = "carom proof 1\nsense min\ncolumns 2\nc c 0 9 y\nc c 0 3 x\nrows 0\ncones 1\nq 0 1 1\nobjective 0\ng 1 0 1\nh 0\nclaim infeasible\nproof\n";
    let text = said(model, Format::Lp, log);
    assert!(text.starts_with("the same"), "{text}");
    let text = said(model, Format::Lp, &log.replace("q 0 1 1", "q 1 1 0"));
    assert!(text.starts_with("another"), "{text}");
}

#[test]
fn binaries_without_a_set_have_no_further_row() {
    let model = "Minimize\n obj: x\nSubject To\n r: x + y >= 1\nBounds\n 2 <= x <= 5\n 1 <= y <= 4\nSemi-continuous\n x y\nEnd\n";
    let log = "carom proof 1\nsense min\ncolumns 4\nc c 0 5 x\nc c 0 4 y\nc i 0 1 -\nc i 0 1 -\nrows 5\n\
               r 1 inf 2 0 1 1 1 r\nr -inf 0 2 0 1 2 -5 a\nr 0 inf 2 0 1 2 -2 b\nr -inf 0 2 1 1 3 -4 c\n\
               r 0 inf 2 1 1 3 -1 d\ncones 0\nobjective 0\ng 1 0 1\nh 0\nclaim infeasible\nproof\n";
    let text = said(model, Format::Lp, log);
    assert!(text.starts_with("the same"), "{text}");
    let text = said(model, Format::Lp, &log.replace("rows 5", "rows 6\nr -inf 1 2 2 1 3 1 s"));
    assert!(text.starts_with("another"), "{text}");
}
