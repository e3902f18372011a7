//! What each section means.

use carom::model::mps;
use carom::prelude::*;

use super::{error, read, with};
use crate::there_and_back::assert_same;

fn limits(model: &Model, name: &str) -> (f64, f64) {
    let row = model.constraints().find(|row| row.name().to_string() == name).unwrap();
    (row.limits().lower, row.limits().upper)
}

fn bounds(model: &Model, name: &str) -> (VariableKind, f64, f64) {
    let variable = model.variable_ref(model.variable_by_name(name).unwrap()).unwrap();
    (variable.kind(), variable.bounds().lower, variable.bounds().upper)
}

#[test]
fn a_plain_file() {
    let model = read(&with("RHS\n RHS most 4 least 1\n RHS same 2.5\n"));
    assert_eq!(model.name(), "small");
    assert_eq!(
        model.to_string(),
        "minimize x - k\nsubject to\n  most: x + 2 y <= 4\n  least: x + 3 k >= 1\n  \
         same: y = 2.5\nwhere\n  x >= 0\n  y >= 0\n  k binary\n"
    );
}

#[test]
fn fixed_columns_comments_and_line_ends() {
    let text = "* a comment\r\nNAME          FIXED MODEL\r\nROWS\r\n N  COST\r\n L  LIM1\r\n\r\n\
                COLUMNS\r\n    X1        COST         1.0D+00   LIM1         .5\r\n\
                *another one\r\n    X2        LIM1         -1.E0\r\nRHS\r\n\
                \x20             LIM1         4\r\nBOUNDS\r\n UP           X1           4\r\n\
                ENDATA\r\nleft over\r\n";
    let model = read(text);
    assert_eq!(model.name(), "FIXED MODEL");
    assert_eq!(
        model.to_string(),
        "minimize X1\nsubject to\n  LIM1: 0.5 X1 - X2 <= 4\nwhere\n  0 <= X1 <= 4\n  X2 >= 0\n"
    );
}

#[test]
fn direction_of_the_objective() {
    let sense =
        |lines: &str| read(&format!("{lines}ROWS\n N c\nCOLUMNS\n x c 1\nENDATA\n")).sense();
    assert_eq!(sense(""), Sense::Minimize);
    assert_eq!(sense("OBJSENSE\n    MAX\n"), Sense::Maximize);
    assert_eq!(sense("OBJSENSE MAX\n"), Sense::Maximize);
    assert_eq!(sense("NAME n\nOBJSENSE\n maximize\n"), Sense::Maximize);
    assert_eq!(sense("OBJSENSE MIN\n"), Sense::Minimize);
}

#[test]
fn letters_of_any_case() {
    let text = "name Small\nobjsense\nmaximize\nRows\n n c\n l r\nColumns\n m 'marker' 'intorg'\n \
                x c 1 r 1\n m 'marker' 'intend'\nrhs\n B r 4\nbounds\n up B x 3\nindicators\n\
                endata\n";
    assert_eq!(
        read(text).to_string(),
        "maximize x\nsubject to\n  r: x <= 4\nwhere\n  0 <= x <= 3 integer\n"
    );
    assert_eq!(read(text).name(), "Small");
}

#[test]
fn the_objective_row_by_name() {
    let text =
        |name: &str| format!("OBJNAME\n {name}\nROWS\n N a\n N b\nCOLUMNS\n x a 1 b 2\nENDATA\n");
    assert_eq!(read(&text("b")).to_string(), "minimize 2 x\nsubject to\nwhere\n  x >= 0\n");
    assert_eq!(
        error(&text("c")),
        "line 2, column 2: OBJNAME says `c`, but ROWS (after it) has no N row of that name"
    );
}

#[test]
fn objective_constant_and_further_free_rows() {
    let text = "ROWS\n N c\n N other\n L r\nCOLUMNS\n x c 2 other 7\n x r 1\nRHS\n B c 3 other 1\n \
                B r 4\nRANGES\n R other 1\nENDATA\n";
    let model = read(text);
    assert_eq!(model.to_string(), "minimize 2 x - 3\nsubject to\n  r: x <= 4\nwhere\n  x >= 0\n");
}

#[test]
fn without_an_objective_row() {
    let model = read("ROWS\n L r\nCOLUMNS\n x r 1\nENDATA\n");
    assert_eq!(model.to_string(), "minimize 0\nsubject to\n  r: x <= 0\nwhere\n  x >= 0\n");
}

#[test]
fn ranges_of_every_kind_and_sign() {
    let ranged =
        |ranges: &str| read(&with(&format!("RHS\n B most 4 least 1\n B same 2\nRANGES\n{ranges}")));
    let model = ranged(" R most 3 least 5\n R same 1.5\n");
    assert_eq!(limits(&model, "most"), (1.0, 4.0));
    assert_eq!(limits(&model, "least"), (1.0, 6.0));
    assert_eq!(limits(&model, "same"), (2.0, 3.5));
    let model = ranged(" most -3 least -5\n same -1.5\n");
    assert_eq!(limits(&model, "most"), (1.0, 4.0));
    assert_eq!(limits(&model, "least"), (1.0, 6.0));
    assert_eq!(limits(&model, "same"), (0.5, 2.0));
    let model = ranged(" R most 1e30 least Infinity\n R same 0\n");
    assert_eq!(limits(&model, "most"), (f64::NEG_INFINITY, 4.0));
    assert_eq!(limits(&model, "least"), (1.0, f64::INFINITY));
    assert_eq!(limits(&model, "same"), (2.0, 2.0));
    // On the decimals: in binary arithmetic 1.1 - 2.3 is -1.1999999999999997.
    let model = read(&with("RHS\n B most 1.1\nRANGES\n R most 2.3\n"));
    assert_eq!(limits(&model, "most"), (-1.2, 1.1));
    assert_ne!(1.1 - 2.3, -1.2);
}

#[test]
fn bounds_of_every_kind() {
    use VariableKind::{Binary, Continuous, Integer};
    let bound = |entries: &str, name: &str| {
        bounds(&read(&with(&format!("BOUNDS\n{}", entries.replace(';', "\n")))), name)
    };
    let infinity = f64::INFINITY;
    assert_eq!(bound("", "x"), (Continuous, 0.0, infinity));
    assert_eq!(bound(" UP B x 4;", "x"), (Continuous, 0.0, 4.0));
    assert_eq!(bound(" UP x 4;", "x"), (Continuous, 0.0, 4.0));
    assert_eq!(bound(" LO B x -1;", "x"), (Continuous, -1.0, infinity));
    assert_eq!(bound(" LO B x -1; UP B x 2;", "x"), (Continuous, -1.0, 2.0));
    assert_eq!(bound(" FX B x 1.5;", "x"), (Continuous, 1.5, 1.5));
    assert_eq!(bound(" FR B x;", "x"), (Continuous, -infinity, infinity));
    assert_eq!(bound(" FR x;", "x"), (Continuous, -infinity, infinity));
    assert_eq!(bound(" FR B x 0;", "x"), (Continuous, -infinity, infinity));
    assert_eq!(bound(" FR x 0;", "x"), (Continuous, -infinity, infinity));
    assert_eq!(bound(" MI B x;", "x"), (Continuous, -infinity, infinity));
    assert_eq!(bound(" MI B x; UP B x 3;", "x"), (Continuous, -infinity, 3.0));
    assert_eq!(bound(" PL B x;", "x"), (Continuous, 0.0, infinity));
    assert_eq!(bound(" LO B x -1e30; UP B x 1e30;", "x"), (Continuous, -infinity, infinity));
    assert_eq!(bound(" LO B x -inf; UP B x +Infinity;", "x"), (Continuous, -infinity, infinity));
    // A negative upper bound frees a lower bound that is not given.
    assert_eq!(bound(" UP B x -2;", "x"), (Continuous, -infinity, -2.0));
    assert_eq!(bound(" UP B x -2; LO B x -5;", "x"), (Continuous, -5.0, -2.0));
    assert_eq!(bound(" UP B x 0;", "x"), (Continuous, 0.0, 0.0));
    // Integer columns, between markers and by bound kind.
    assert_eq!(bound("", "k"), (Binary, 0.0, 1.0));
    assert_eq!(bound(" PL B k;", "k"), (Integer, 0.0, infinity));
    assert_eq!(bound(" LO B k 2;", "k"), (Integer, 2.0, infinity));
    assert_eq!(bound(" LO B k 0;", "k"), (Integer, 0.0, infinity));
    assert_eq!(bound(" UP B k 9;", "k"), (Integer, 0.0, 9.0));
    assert_eq!(bound(" UP B k 1;", "k"), (Binary, 0.0, 1.0));
    assert_eq!(bound(" FX B k 1;", "k"), (Binary, 1.0, 1.0));
    assert_eq!(bound(" UP B k -3;", "k"), (Integer, -infinity, -3.0));
    assert_eq!(bound(" BV B x;", "x"), (Binary, 0.0, 1.0));
    assert_eq!(bound(" BV B x 1;", "x"), (Binary, 0.0, 1.0));
    assert_eq!(bound(" LI B x 2;", "x"), (Integer, 2.0, infinity));
    assert_eq!(bound(" UI B x 7;", "x"), (Integer, 0.0, 7.0));
    assert_eq!(bound(" UI B x 1;", "x"), (Integer, 0.0, 1.0));
    assert_eq!(bound(" LI B k 0; UI B k 1;", "k"), (Integer, 0.0, 1.0));
    assert_eq!(bound(" UI B k 1; BV B k;", "k"), (Binary, 0.0, 1.0));
    assert_eq!(bound(" ui B k 1; lo B k 1;", "k"), (Integer, 1.0, 1.0));
    assert_eq!(bound(" LI B x -2; UI B x 7;", "x"), (Integer, -2.0, 7.0));
    // The same bound twice is no contradiction.
    assert_eq!(bound(" UP B k 1; BV B k;", "k"), (Binary, 0.0, 1.0));
}

#[test]
fn quadratic_objectives() {
    let objective = |sections: &str| {
        let text = read(&with(sections)).to_string();
        text.lines().next().unwrap().to_owned()
    };
    let upper = objective("QUADOBJ\n x x 2\n x y -1\n y y 4\n");
    assert_eq!(upper, "minimize x^2 - x y + 2 y^2 + x - k");
    assert_eq!(objective("QUADOBJ\n y y 4\n y x -1\n x x 2\n"), upper);
    assert_eq!(objective("QMATRIX\n x x 2\n x y -1\n y x -1\n y y 4\n"), upper);
    assert_eq!(objective("QSECTION cost\n x x 2\n x y -1\n y y 4\n"), upper);
    assert_eq!(objective("QSECTION\n x x 2\n y x -1\n y y 4\n"), upper);
    assert_eq!(
        error(&with("QUADOBJ\n x x -2\n")),
        "the objective is not convex: in the minimize direction its quadratic part has curvature \
         -2.000e0 along the direction `x` 1; only convex costs to minimise (concave ones to \
         maximise) have a proof of optimality here; write squares"
    );
}

#[test]
fn indicators() {
    let model = read(&with("RHS\n B most 4\nINDICATORS\n IF most k 1\n IF same k 0\n"));
    // An integer within [0, 1] that switches is a binary.
    let integer =
        read(&with("RHS\n B most 4\nBOUNDS\n UI B k 1\nINDICATORS\n IF most k 1\n if same k 0\n"));
    assert_eq!(integer.to_string(), model.to_string());
    assert_eq!(
        model.to_string(),
        "minimize x - k\nsubject to\n  least: x + 3 k >= 0\n  \
         most: k = 1 implies x + 2 y <= 4\n  same: k = 0 implies y = 0\nwhere\n  x >= 0\n  \
         y >= 0\n  k binary\n"
    );
}

#[test]
fn empty_rows_and_columns_survive() {
    let text = "ROWS\n N c\n G empty\n L full\nCOLUMNS\n x full 1\n unused c 0\nRHS\n B empty -1\n\
                ENDATA\n";
    let model = read(text);
    let expected = "minimize 0\nsubject to\n  empty: 0 >= -1\n  full: x <= 0\nwhere\n  x >= 0\n  \
                    unused >= 0\n";
    assert_eq!(model.to_string(), expected);
    assert_same(&model, &read(&mps::write(&model).unwrap()));
}

#[test]
fn rows_without_a_limit_are_left_out() {
    let model = read(&with("RHS\n B most 1e30 least -Infinity\n"));
    assert_eq!(model.constraint_count(), 1);
}

#[test]
fn unusual_names() {
    let text = "ROWS\n N RHS\n L 'MARKER'\n L $3\nCOLUMNS\n *x 'MARKER' 1 $3 2\n 1e5 RHS 1\n \
                höhe[07] $3 1\n höhe[7] $3 1\nRHS\n 'MARKER' 4 $3 5\nBOUNDS\n UP *x 3\n FR B 1e5\n\
                ENDATA\n";
    let model = read(text);
    assert_eq!(
        model.to_string(),
        "minimize 1e5\nsubject to\n  'MARKER': *x <= 4\n  $3: 2 *x + höhe[07] + höhe[7] <= 5\n\
         where\n  0 <= *x <= 3\n  1e5 free\n  höhe[07] >= 0\n  höhe[7] >= 0\n"
    );
    assert_same(&model, &read(&mps::write(&model).unwrap()));
}

#[test]
fn numbers() {
    let lower = |text: &str| bounds(&read(&with(&format!("BOUNDS\n LO B x {text}\n"))), "x").1;
    assert_eq!(lower("-1.5D+02"), -150.0);
    assert_eq!(lower("1.e1"), 10.0);
    assert_eq!(lower("-1e30"), f64::NEG_INFINITY);
    // Without this, it is 1.
    assert_eq!(bounds(&read(&with("BOUNDS\n UP B k Infinity\n")), "k").2, f64::INFINITY);
    for text in ["nan", "1,5"] {
        let message = error(&with(&format!("BOUNDS\n LO B x {text}\n")));
        assert!(message.ends_with(&format!("`{text}` is not a number")), "{message}");
    }
    let message = error("ROWS\n N c\nCOLUMNS\n x c 1e31\nENDATA\n");
    assert!(message.contains("`1e31` counts as infinite"), "{message}");
}
