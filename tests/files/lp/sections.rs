//! What each section means, in its spellings.

use carom::ErrorKind;
use carom::model::{lp, mps};
use carom::prelude::*;

use super::{error, read};
use crate::there_and_back::assert_same;

/// The text form of a model with one objective and the sections given.
fn text(sections: &str) -> String {
    read(&format!("min\n obj: x + y\n{sections}end\n")).to_string()
}

/// The row of the text form that stands between objective and bounds.
fn row(row: &str) -> String {
    let text = text(&format!("st\n {row}\n"));
    let found = text.lines().find(|line| line.starts_with("  ") && line.contains(": "));
    found.unwrap_or("").trim().to_owned()
}

fn bound(entries: &str, name: &str) -> (VariableKind, f64, f64) {
    let model = read(&format!("min x + k + z\nbounds\n{entries}\ngen k\nbin z\nend\n"));
    let variable = model.variable_ref(model.variable_by_name(name).unwrap()).unwrap();
    (variable.kind(), variable.bounds().lower, variable.bounds().upper)
}

#[test]
fn a_plain_file() {
    let model = read(
        "\\ Problem name: small\n\\ a comment\nMinimize\n cost: 2 x - y + 3 k + 7\nSubject To\n \
         most: x + 2 y <= 4 \\ a comment\n least: x - 3 k >= -1.5\n same: y = 2.5\n\
         Bounds\n x <= 40\n -5 <= y <= 5\nGenerals\n k\nEnd\nleft over\n",
    );
    assert_eq!(model.name(), "small");
    assert_eq!(
        model.to_string(),
        "minimize 2 x - y + 3 k + 7\nsubject to\n  most: x + 2 y <= 4\n  least: x - 3 k >= -1.5\n  \
         same: y = 2.5\nwhere\n  0 <= x <= 40\n  -5 <= y <= 5\n  k >= 0 integer\n"
    );
}

#[test]
fn spellings_of_keywords() {
    for word in ["min", "MIN", "Minimize", "minimise", "MINIMUM"] {
        assert_eq!(read(&format!("{word} x st c: x >= 1 end")).sense(), Sense::Minimize);
    }
    for word in ["max", "Max", "MAXIMIZE", "maximise", "Maximum"] {
        assert_eq!(read(&format!("{word}\nx\nst\nc: x <= 1\nEND\n")).sense(), Sense::Maximize);
    }
    for word in ["Subject To", "SUBJECT\nTO", "such that", "st", "ST.", "s.t.", "S.T"] {
        assert_eq!(read(&format!("min x\n{word}\nc: x >= 1\nend")).constraint_count(), 1, "{word}");
    }
    let kind = |section: &str| {
        let model = read(&format!("min x\nbounds x <= 1\n{section}\nend"));
        model.variables().next().unwrap().kind()
    };
    for word in ["General", "GENERALS", "gen", "integer", "Integers", "int"] {
        assert_eq!(kind(&format!("{word} x")), VariableKind::Integer);
    }
    for word in ["Binary", "BINARIES", "bin"] {
        assert_eq!(kind(&format!("{word}\nx\n")), VariableKind::Binary);
    }
}

#[test]
fn objectives() {
    let objective = |text: &str| {
        let model = read(&format!("max {text}\nst\nend")).to_string();
        model.lines().next().unwrap()["maximize ".len()..].to_owned()
    };
    assert_eq!(objective(""), "0");
    assert_eq!(objective("obj:"), "0");
    assert_eq!(objective("obj: 5"), "5");
    assert_eq!(objective("3x+2y-z"), "3 x + 2 y - z");
    assert_eq!(objective("3 x\n +\n 2\n y - - z"), "3 x + 2 y + z");
    assert_eq!(objective("x + 1 - 3 x + 2.5e+1"), "-2 x + 26");
    assert_eq!(objective("-1e-2 x \\ comment"), "-0.01 x");
}

#[test]
fn a_column_for_the_constant_of_the_objective() {
    let text = |objective: &str, rest: &str| {
        format!("max {objective}\nst\nr: x + y + 2 z <= 3\n{rest}\nend")
    };
    let model = |objective: &str, rest: &str| read(&text(objective, rest)).to_string();
    let plain = model("3 x + z + 5", "");
    assert_eq!(model("3 x + z + 5 Constant", "bounds\nConstant = 1"), plain);
    assert_eq!(model("2 Constant + 3 x + z + 1 + 2 Constant", "bounds\nConstant = 1"), plain);
    // The columns after it are still what they were.
    let sets = "sos\n s: S1:: x:1 z:2";
    let squares = "Constant + [ - 2 x ^2 - 2 x * z - 4 z ^2 ] / 2";
    let rest = format!("c: y = 1 -> z <= 1\nbounds\nConstant = 1\nbin\ny\n{sets}");
    let same = format!("c: y = 1 -> z <= 1\nbin\ny\n{sets}");
    assert_eq!(model(squares, &rest), model(&squares.replace("Constant", "1"), &same));
    // Anything else is a variable.
    for (objective, rest) in [
        ("x + 5 Constant", ""),
        ("x + 5 Constant", "bounds\nConstant = 2"),
        ("x + 5 Constant", "bounds\nConstant >= 1"),
        ("x + 5 Constant", "bounds\nConstant = 1\ngeneral\nConstant"),
        ("x + 5 Constant", "s: Constant + x <= 4\nbounds\nConstant = 1"),
        ("x + 5 Constant - [ Constant * Constant ]", "bounds\nConstant = 1"),
        ("x + 5 constant", "bounds\nconstant = 1"),
    ] {
        let text = model(objective, rest);
        assert!(text.to_lowercase().contains("constant"), "{text}");
    }
}

#[test]
fn quadratic_objectives() {
    let objective = |text: &str| {
        let model = read(&format!("min {text}\nst\nend")).to_string();
        model.lines().next().unwrap()["minimize ".len()..].to_owned()
    };
    let expected = "x^2 - x y + 2 y^2 + x";
    assert_eq!(objective("x + [ 2 x ^ 2 - 2 x * y + 4 y ^2 ] / 2"), expected);
    assert_eq!(objective("x + [2x^2-2x*y+4y^2]/2"), expected);
    assert_eq!(objective("x + [ x^2 - x * y + 2 y ^ 2 ]"), expected);
    assert_eq!(objective("[ x * x ] + x + [ -1 x * y + 2 * y * y ]"), expected);
    assert_eq!(objective("x - [ - 2 x^2 + x * y + y * x - 4 y^2 ] / 2.0"), expected);
    assert_eq!(
        objective("x[1] + [ x[1] ^2+x[2]*x[2]] / 2 + 3"),
        "0.5 x[1]^2 + 0.5 x[2]^2 + x[1] + 3"
    );
    assert_eq!(objective("x + [ ] / 2"), "x");
    let not_convex = lp::read("min [ - x^2 ]\nst\nend");
    assert!(matches!(not_convex.unwrap_err().kind(), ErrorKind::NotConvex { .. }));
}

#[test]
fn rows_of_every_kind() {
    assert_eq!(row("r: x + 2 y <= 4"), "r: x + 2 y <= 4");
    for relation in ["<=", "<", "=<"] {
        assert_eq!(row(&format!("r: x {relation} 4")), "r: x <= 4");
        assert_eq!(row(&format!("r: 4 {relation} x")), "r: x >= 4");
    }
    for relation in [">=", ">", "=>"] {
        assert_eq!(row(&format!("r: x {relation}-4")), "r: x >= -4");
        assert_eq!(row(&format!("r: 4 {relation} x")), "r: x <= 4");
    }
    assert_eq!(row("r: x = 4"), "r: x = 4");
    assert_eq!(row("r: 1 <= x + y <= 4"), "r: 1 <= x + y <= 4");
    assert_eq!(row("r: 4 >= x + y > -1e-3"), "r: -0.001 <= x + y <= 4");
    assert_eq!(row("r: -inf <= x + y <= 4"), "r: x + y <= 4");
    assert_eq!(row("x\n+\ny\n<=\n4"), "c1: x + y <= 4");
    assert_eq!(row("r: x + y + x >= 4"), "r: 2 x + y >= 4");
    assert_eq!(row("r: 5 <= x <= 7"), "r: 5 <= x <= 7");
    assert_eq!(row("r: 0 x >= -1"), "r: 0 >= -1");
    assert_eq!(row("r: >= -1"), "r: 0 >= -1");
    assert_eq!(row("r: 0 >= -1"), "r: 0 >= -1");
    // A row without a finite limit says nothing.
    assert_eq!(row("r: x <= 1e30"), "");
    assert_eq!(row("r: -infinity <= x <= +Inf"), "");
}

#[test]
fn names_of_rows() {
    let model = read("min x st\nc2: x >= 1\n x >= 2\n x + y >= 3\n free: y <= 1\n 4 <= y\nend");
    let names: Vec<String> = model.constraints().map(|row| row.name().to_string()).collect();
    assert_eq!(names, ["c2", "c2_", "c3", "free", "c5"]);
}

#[test]
fn two_rows_for_two_limits() {
    let pair = "r%ge: x + y >= -1.2\n r%le: x + y <= 1.1\n";
    assert_eq!(row(pair), "r: -1.2 <= x + y <= 1.1");
    let rows = |text: &str| read(&format!("min x st\n{text}\nend")).constraint_count();
    assert_eq!(rows(pair), 1);
    // Anything else is two rows.
    assert_eq!(rows("r%le: x + y <= 1.1\n r%ge: x + y >= -1.2\n"), 2);
    assert_eq!(rows("r%ge: x + y >= -1.2\n s%le: x + y <= 1.1\n"), 2);
    assert_eq!(rows("r%ge: x + y >= -1.2\n r%le: x + 2 y <= 1.1\n"), 2);
    assert_eq!(rows("r%ge: x + y >= 1.2\n r%le: x + y <= 1.1\n"), 2);
    assert_eq!(rows("r%ge: x + y <= 1.2\n r%le: x + y <= 1.1\n"), 2);
    assert_eq!(rows("r%ge: x + y >= -1.2\n q: x >= 0\n r%le: x + y <= 1.1\n"), 3);
}

#[test]
fn indicators() {
    let model = read(
        "min x + z\nst\n a: z = 1 -> x <= 4\n b: z = 0 -> x + y = 4\n z = 1 -> 1 <= x - y <= 4\n \
         c%ge: z = 0 -> x >= 1\n c%le: z = 0 -> x <= 2\n d%ge: z = 0 -> x >= 1\n \
         d%le: z = 1 -> x <= 2\nbounds\n z <= 1\ngen\n z\nend",
    );
    assert_eq!(
        model.to_string(),
        "minimize x + z\nsubject to\n  a: z = 1 implies x <= 4\n  b: z = 0 implies x + y = 4\n  \
         c3: z = 1 implies 1 <= x - y <= 4\n  c: z = 0 implies 1 <= x <= 2\n  \
         d%ge: z = 0 implies x >= 1\n  d%le: z = 1 implies x <= 2\nwhere\n  x >= 0\n  z binary\n  \
         y >= 0\n"
    );
    assert_same(&model, &read(&lp::write(&model).unwrap()));
}

#[test]
fn bounds_of_every_kind() {
    use VariableKind::{Binary, Continuous, Integer};
    let infinity = f64::INFINITY;
    assert_eq!(bound("", "x"), (Continuous, 0.0, infinity));
    assert_eq!(bound("x <= 4", "x"), (Continuous, 0.0, 4.0));
    assert_eq!(bound("x < 4", "x"), (Continuous, 0.0, 4.0));
    assert_eq!(bound("4 >= x", "x"), (Continuous, 0.0, 4.0));
    assert_eq!(bound("x >= -1", "x"), (Continuous, -1.0, infinity));
    assert_eq!(bound("- 1 <= x", "x"), (Continuous, -1.0, infinity));
    assert_eq!(bound("-1 <= x <= 2", "x"), (Continuous, -1.0, 2.0));
    assert_eq!(bound("2 >= x >= -1", "x"), (Continuous, -1.0, 2.0));
    assert_eq!(bound("x >= -1 x <= 2", "x"), (Continuous, -1.0, 2.0));
    assert_eq!(bound("x = 1.5", "x"), (Continuous, 1.5, 1.5));
    assert_eq!(bound("1.5 = x", "x"), (Continuous, 1.5, 1.5));
    assert_eq!(bound("x free", "x"), (Continuous, -infinity, infinity));
    assert_eq!(bound("x FREE", "x"), (Continuous, -infinity, infinity));
    assert_eq!(bound("-inf <= x", "x"), (Continuous, -infinity, infinity));
    assert_eq!(bound("-Infinity <= x <= +infinity", "x"), (Continuous, -infinity, infinity));
    assert_eq!(bound("-inf <= x <= -3", "x"), (Continuous, -infinity, -3.0));
    assert_eq!(bound("-1e30 <= x <= 1e20", "x"), (Continuous, -infinity, infinity));
    assert_eq!(bound("", "k"), (Integer, 0.0, infinity));
    assert_eq!(bound("k <= 1", "k"), (Integer, 0.0, 1.0));
    assert_eq!(bound("k = 1", "k"), (Integer, 1.0, 1.0));
    assert_eq!(bound("", "z"), (Binary, 0.0, 1.0));
    assert_eq!(bound("0 <= z <= 1", "z"), (Binary, 0.0, 1.0));
    assert_eq!(bound("z = 0", "z"), (Binary, 0.0, 0.0));
    // A name that appears in a section first is a variable like others.
    assert_eq!(bound("other <= 2", "other"), (Continuous, 0.0, 2.0));
    assert_eq!(bound("\nbin new gen new\n", "new"), (Binary, 0.0, 1.0));
}

#[test]
fn sections_in_any_order_and_empty_ones() {
    let model = read(
        "max x\nbin\nz\nbounds x <= 4\nst c: x + z <= 2\ngen bounds z = 1\nsemi\nsos\n\
         semi-continuous\nlazy constraints\nend",
    );
    assert_eq!(
        model.to_string(),
        "maximize x\nsubject to\n  c: x + z <= 2\nwhere\n  0 <= x <= 4\n  z = 1 binary\n"
    );
}

/// As other programs write them.
#[test]
fn dialects() {
    let expected = "minimize x - 2 y + 7\nsubject to\n  rlo: x + 0.1 y >= -1.2\n  empty: 0 >= -1\n\
                    where\n  -1 <= x <= 4\n  y free\n  z binary\n  n = 1 integer\n";
    let short = "\\ File written by a program\nmin\n obj: +1 x -2 y  +7\nst\n rlo: +1 x +0.1 y >= \
                 -1.2\n empty: >= -1\nbounds\n -1 <= x <= 4\n y free\n z <= 1\n n = 1\nbin\n z\n\
                 gen\n n\nsemi\nend\n";
    assert_eq!(read(short).to_string(), expected);
    let long = "\\ STATISTICS\n\\   Problem name     : model\nMinimize\n Obj: +1 x -2 y +7\n\
                Subject to\n rlo: +1 x +0.1 y\n >= -1.2\n empty: 0 x >= -1\nBounds\n 0 <= z <= 1\n \
                1 <= n <= 1\n -1 <= x <= 4\n y free\nBinaries\n z\nGenerals\n n\nEnd\n";
    assert_eq!(read(long).to_string(), expected);
    assert_eq!(read(long).name(), "model");
    let star = "\\* Pulp *\\\nMaximize\nOBJ: x_(1) + x_(2)\nSubject To\n_C1: x_(1) + x_(2) <= 3\n\
                Binaries\nx_(1)\nx_(2)\nEnd\n";
    assert_eq!(read(star).variable_by_name("x_(2)").map(Variable::index), Ok(1));
}

#[test]
fn empty_rows_and_columns_survive() {
    let model = mps::read(
        "ROWS\n N c\n G empty\n L full\nCOLUMNS\n lonely c 0\n x full 1\n unused c 0\nRHS\n \
         B empty -1\nENDATA\n",
    )
    .unwrap()
    .model;
    assert_same(&model, &read(&lp::write(&model).unwrap()));
    let model =
        mps::read("ROWS\n N c\n G empty\nCOLUMNS\nRHS\n B empty -1\nENDATA\n").unwrap().model;
    assert_same(&model, &read(&lp::write(&model).unwrap()));
    assert_same(&Model::new(""), &read(&lp::write(&Model::new("")).unwrap()));
}

#[test]
fn line_ends_marks_and_tabs() {
    let model = read("\u{feff}\r\nMin\r\n\tx\r\nST\r\n\tc:\tx >=\t1\r\nEnd");
    assert_eq!(model.to_string(), "minimize x\nsubject to\n  c: x >= 1\nwhere\n  x >= 0\n");
    assert_eq!(error("").split(':').next(), Some("line 1, column 1"));
}

/// Tokens end where the next one begins, with or without white space in between.
#[test]
fn words_numbers_and_symbols() {
    assert_eq!(row("r: 3x1+2.5e-3y>=1"), "r: 0.0025 y + 3 x1 >= 1");
    assert_eq!(row("r: x<-5"), "r: x <= -5");
    assert_eq!(row("r: z=1->x=>.5\nbin z"), "r: z = 1 implies x >= 0.5");
    assert_eq!(row("r: 3e +2e+ 1.e5 y+1.x>=0"), "r: x + 100000 y + 5 e >= 0");

    let objective =
        |text: &str| lp::read(&format!("min {text} st end")).map(|r| r.model.to_string());
    let (tight, spaced) = ("[x[1]^2+y*z]/2", "[ x[1] ^ 2 + y * z ] / 2");
    assert_eq!(objective(tight), objective(spaced));
    let squares = ["[x[1]^2+y*z+y^2+z^2]/2", "[ x[1] ^ 2 + y * z + y ^ 2 + z ^ 2 ] / 2"];
    let [tight, spaced] = squares.map(|text| objective(text).unwrap());
    assert_eq!(tight, spaced);
    assert!(tight.starts_with("minimize 0.5 x[1]^2 + "), "{tight}");

    let names = |text: &str| {
        let model = read(&format!("min bin {text} end"));
        model.variables().map(|v| v.name().to_string()).collect::<Vec<_>>()
    };
    assert_eq!(names("a \\ b\n\tc\r\n"), ["a", "c"]);
    assert_eq!(names("höhe\u{a0}.x s.t."), ["höhe", ".x"]);
}

/// Names of rows as other programs write them.
#[test]
fn row_names_may_have_signs() {
    let text = "Maximize\n 3 x[A,B] + 2 y[A,B]\nSubject To\n C1_Capacity[A,B]: x[A,B] + y[A,B] <= 12\n \
                C1*_Transfer[A,B]: y[A,B] <= 5\n a-b+c: x[A,B] <= 9\n 3rd:x[A,B] >= 1\n x[A,B]-y[A,B] <= 8\n \
                Generals\n x[A,B] y[A,B]\nEnd\n";
    let model = read(text);
    let names: Vec<String> = model.constraints().map(|row| row.name().to_string()).collect();
    assert_eq!(names, ["C1_Capacity[A,B]", "C1*_Transfer[A,B]", "a-b+c", "3rd", "c5"]);
    // They are written so that all readers take them.
    let written = lp::write(&model).unwrap();
    assert!(written.contains(" C1%2A_Transfer"), "{written}");
    assert_eq!(read(&written).to_string(), model.to_string());
}
