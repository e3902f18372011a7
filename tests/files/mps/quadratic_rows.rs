//! Quadratic rows and norms: QCMATRIX and QSECTION.

use carom::model::{cbf, mps, norm};
use carom::prelude::*;

use super::{error, read};

/// A file with the columns `x`, `y`, `t` and `z` (a binary), which maximises x + y, and whose rows
/// `r` (of a kind) and `s` (G) have right-hand sides.
fn with(kind: &str, right: &str, sections: &str) -> String {
    format!(
        "NAME q\nOBJSENSE MAX\nROWS\n N cost\n {kind} r\n G s\nCOLUMNS\n x cost 1 s 1\n y cost 1\n t r -1\n\
         \x20M 'MARKER' 'INTORG'\n z s 1\n M 'MARKER' 'INTEND'\nRHS\n B r {right} s -9\nBOUNDS\n FX B t 1\n\
         \x20LO B x -9\n LO B y -9\n UP B x 9\n UP B y 9\n{sections}ENDATA\n"
    )
}

#[track_caller]
fn check(text: &str, expected: f64) {
    let model = read(text);
    let written = mps::write(&model).unwrap();
    let again = read(&written);
    assert_eq!(mps::write(&again).unwrap(), written);
    for model in [model, again] {
        let found = BranchAndBound::default().solve(&model).unwrap().objective().unwrap();
        assert!(
            (found - expected).abs() < 1e-5 * expected.abs(),
            "{found}, not {expected}\n{written}"
        );
    }
}

/// Rows `x'Qx - t <= right` with t = 1.
#[test]
fn squares_and_products() {
    check(&with("L", "7", "QCMATRIX r\n x x 1\n y y 1\n"), 4.0);
    check(
        &with("L", "7", "qcmatrix   r\n    x         x         1\n    y         y         1\n"),
        4.0,
    );
    // (x + y)^2 + (x - y)^2 = 2 x^2 + 2 y^2.
    check(&with("L", "15", "QCMATRIX r\n x x 2\n y y 2\n"), 4.0);
    // x^2 + y^2 + x y, each half of the product once.
    check(&with("L", "11", "QCMATRIX r\n x x 1\n x y 0.5\n y x 0.5\n y y 1\n"), 4.0);
    check(&with("L", "11", "QCMATRIX r\n y x 0.5\n y y 1\n x x 1\n x y 0.5\n"), 4.0);
    // Concave, at least something: t - x^2 - y^2 >= -7.
    let concave = with("G", "-7", "QCMATRIX r\n x x -1\n y y -1\n").replace("t r -1", "t r 1");
    check(&concave, 4.0);
    // 1/2 x'Qx, one triangle.
    check(&with("L", "7", "QSECTION r\n x x 2\n y y 2\n"), 4.0);
    check(&with("L", "11", "QSECTION r\n x x 2\n y x 1\n y y 2\n"), 4.0);
}

#[test]
fn cones() {
    // |(x, y)| <= h with h >= 0, h <= 2 sqrt(2).
    let cone = |bound: &str| {
        with(
            "L",
            "7",
            &format!(
                " {bound} B h 0\n UP B h 2.8284271247461903\nQCMATRIX q\n x x 1\n y y 1\n h h -1\n"
            ),
        )
        .replace(" G s\n", " G s\n L q\n")
        .replace(" M 'MARKER' 'INTORG'", " h r 0\n M 'MARKER' 'INTORG'")
    };
    check(&cone("LO"), 4.0);
    // Without the sign of the head it is no cone.
    let refused = error(&cone("MI").replace(" MI B h 0", " MI B h"));
    assert!(refused.starts_with("line 26, column 10: "), "{refused}");
    // x^2 <= h * t.
    let rotated =
        with("L", "7", " UP B h 4\n UP B y 2\nQCMATRIX q\n x x 1\n h t -0.5\n t h -0.5\n")
            .replace(" UP B y 9\n", "")
            .replace(" G s\n", " G s\n L q\n")
            .replace(" M 'MARKER' 'INTORG'", " h r 0\n M 'MARKER' 'INTORG'");
    check(&rotated, 4.0);
}

#[test]
fn conditions() {
    let text = |value: u8| {
        with("L", "7", &format!("QCMATRIX r\n x x 1\n y y 1\nINDICATORS\n IF r z {value}\n"))
    };
    check(&text(1), 18.0);
    let only = |value: u8| {
        text(value)
            .replace(" M 'MARKER' 'INTEND'", " z cost 15\n M 'MARKER' 'INTEND'")
            .replace(" z s 1\n z cost", " z s 1 cost")
    };
    // 18 without z, 4 + 15 with it.
    check(&only(1), 19.0);
    check(&only(0), 33.0);
    let written = mps::write(&read(&text(1))).unwrap();
    assert!(written.contains("QCMATRIX   r\n"), "{written}");
    assert!(written.contains("INDICATORS\n IF r         z                    1\n"), "{written}");
}

#[test]
fn several_sections() {
    let text = with(
        "L",
        "7",
        "QCMATRIX r\n x x 1\n y y 1\nQCMATRIX s\n x x -1\nQUADOBJ\n x x -2\n y y -2\n",
    );
    let model = read(&text);
    assert_eq!((model.conic_constraint_count(), model.constraint_count()), (2, 0));
    assert_eq!(model.objective().products().len(), 2);
    // Zeros leave a linear row.
    let model = read(&with("E", "7", "QCMATRIX r\n x x 0\n"));
    assert_eq!((model.conic_constraint_count(), model.constraint_count()), (0, 2));
    // A row without a limit says nothing.
    let model = read(&with("L", "inf", "QCMATRIX r\n x x -1\n"));
    assert_eq!((model.conic_constraint_count(), model.constraint_count()), (0, 1));
}

#[test]
fn rows_that_are_no_cones() {
    for (kind, matrix) in [("L", " x x -1\n"), ("G", " x x 1\n"), ("L", " x y 1\n y x 1\n")] {
        let refused = error(&with(kind, "7", &format!("QCMATRIX r\n{matrix}")));
        assert!(refused.starts_with("line 22, column 10: "), "{refused}");
    }
}

#[test]
fn the_text_that_is_written() {
    let mut model = Model::new("rows");
    let v = model.continuous_family("v", 2, -1.0, 1.0).unwrap();
    let h = model.continuous("h", 0.0, 4.0).unwrap();
    model.add("plain", norm([1.0 * v[0], 2.0 * v[1]]).le(h)).unwrap();
    model
        .add("limit[3]", norm([v[0] + 1.0, 0.1 * v[1], Affine::constant(0.5)]).le(h - 1.0))
        .unwrap();
    model.add("square", v[0].square().le(4.0 * h - 1.0)).unwrap();
    model.minimize(h).unwrap();
    let expected = "\
NAME          rows
ROWS
 N  obj
 E  limit_entry0[3]
 E  limit_entry1[3]
 E  limit_bound[3]
 L  plain
 L  limit[3]
 L  square
COLUMNS
    v[0]      limit_entry0[3]             1
    v[1]      limit_entry1[3]           0.1
    h         obj                  1
    h         limit_bound[3]             1
    h         square              -4
    limit_entry0[3]  limit_entry0[3]            -1
    limit_entry1[3]  limit_entry1[3]            -1
    limit_bound[3]  limit_bound[3]            -1
RHS
    RHS       limit_entry0[3]            -1
    RHS       limit_bound[3]             1
    RHS       limit[3]         -0.25
    RHS       square              -1
BOUNDS
 LO BOUND     v[0]                -1
 UP BOUND     v[0]                 1
 LO BOUND     v[1]                -1
 UP BOUND     v[1]                 1
 UP BOUND     h                    4
 FR BOUND     limit_entry0[3]
 FR BOUND     limit_entry1[3]
QCMATRIX   plain
    v[0]      v[0]                 1
    v[1]      v[1]                 4
    h         h                   -1
QCMATRIX   limit[3]
    limit_entry0[3]  limit_entry0[3]             1
    limit_entry1[3]  limit_entry1[3]             1
    limit_bound[3]  limit_bound[3]            -1
QCMATRIX   square
    v[0]      v[0]                 1
ENDATA
";
    let text = mps::write(&model).unwrap();
    assert_eq!(text, expected);
    let again = read(&text);
    let optimum =
        |model: &Model| BranchAndBound::default().solve(model).unwrap().objective().unwrap();
    let (meant, found) = (optimum(&model), optimum(&again));
    assert!((meant - found).abs() < 1e-6, "{meant} {found}");
    // The same as CBF.
    let found = optimum(&cbf::read(&cbf::write(&again).unwrap()).unwrap().model);
    assert!((meant - found).abs() < 1e-6, "{meant} {found}");
}
