//! Damaged files: every error with its line and column.

use super::{error, read, with};

#[test]
fn errors_name_line_and_column() {
    let cases = [
        ("", "line 1, column 1: the file ends without ENDATA; it may have been cut off"),
        (
            "ROWS\n N c\nCOLUMNS\n x c",
            "line 4, column 4: expected a column name and pairs of row name and value (names \
             cannot contain spaces)",
        ),
        (
            "ROWS\n N c\n",
            "line 2, column 5: the file ends without ENDATA; it may have been cut off",
        ),
        (
            "COLS\nENDATA\n",
            "line 1, column 1: section `COLS` is not known; expected NAME, OBJSENSE, ROWS, \
             COLUMNS, RHS, RANGES, BOUNDS, SOS, QUADOBJ, QMATRIX, QCMATRIX, INDICATORS or ENDATA (data \
             lines begin with a space)",
        ),
        (
            "RHS RHS c 1\n",
            "line 1, column 5: nothing can follow the section name `RHS` (data lines begin with a \
             space)",
        ),
        (" x c 1\n", "line 1, column 2: a data line before any section"),
        ("OBJSENSE\n UP\n", "line 2, column 2: expected MIN or MAX, found `UP`"),
        (
            "OBJSENSE MAX\nOBJSENSE MIN\n",
            "line 2, column 10: the direction of the objective is given twice",
        ),
        (
            "csection k 0 quad\n",
            "line 1, column 1: section `csection` cannot be read: write the cone as a row with QCMATRIX, \
             and its head with the lower bound 0",
        ),
        (
            "LAZYCONS\n",
            "line 1, column 1: section `LAZYCONS` cannot be read: move its rows to ROWS, where \
             they \
             always hold",
        ),
        ("ROWS\n Q r\n", "line 2, column 2: row kind `Q` is not one of N, L, G and E"),
        ("ROWS\n L\n", "line 2, column 2: expected a row kind (N, L, G or E) and a row name"),
        ("ROWS\n L a b\n", "line 2, column 6: expected a row kind (N, L, G or E) and a row name"),
        ("ROWS\n L r\n G  r\n", "line 3, column 5: row `r` was already declared in line 2"),
        (
            "ROWS\n L a\u{7}\n",
            "line 2, column 4: `a\u{7}` cannot be a name: it must be one or several words with single blanks between them",
        ),
    ];
    for (text, expected) in cases {
        assert_eq!(error(text), expected, "{text}");
    }
}

#[test]
fn errors_in_columns() {
    let columns = |lines: &str| error(&format!("ROWS\n N c\n L r\nCOLUMNS\n{lines}ENDATA\n"));
    assert_eq!(columns(" x r 1x\n"), "line 5, column 6: `1x` is not a number");
    assert_eq!(columns(" x r NaN\n"), "line 5, column 6: `NaN` is not a number");
    assert_eq!(
        columns(" x r 1e400\n"),
        "line 5, column 6: `1e400` counts as infinite (1e20 and beyond do); a finite number is \
         needed here"
    );
    assert_eq!(
        columns(" x c 1\n x r 1 \n x c 1\n"),
        "line 7, column 4: column `x` has a second entry in row `c`"
    );
    assert_eq!(
        columns(" x c 1\n y r 1\n x c 1\n"),
        "line 7, column 4: column `x` has a second entry in row `c`"
    );
    assert_eq!(
        columns(" M 'MARKER' 'OTHER'\n"),
        "line 5, column 13: marker 'OTHER' is not known; expected 'INTORG' or 'INTEND'"
    );
    assert_eq!(
        columns(" M 'MARKER' 'SOSORG'\n"),
        "line 5, column 2: expected `S1` or `S2` and a name before 'MARKER'"
    );
    assert_eq!(columns(" M 'MARKER' 'SOSEND'\n"), "line 5, column 13: 'SOSEND' without 'SOSORG'");
    assert_eq!(
        columns(" S1 M 'MARKER' 'SOSORG'\n S1 K 'MARKER' 'SOSORG'\n"),
        "line 6, column 16: the 'SOSORG' before is still open"
    );
    assert_eq!(columns(" M 'MARKER' 'INTEND'\n"), "line 5, column 13: 'INTEND' without 'INTORG'");
    assert_eq!(
        columns(" M 'MARKER' 'INTORG'\n M 'MARKER' 'INTORG'\n"),
        "line 6, column 13: 'INTORG' of line 5 is still open"
    );
}

/// Asserts the errors of sections after COLUMNS.
fn assert_errors(cases: &[(&str, &str)]) {
    for (sections, expected) in cases {
        assert_eq!(error(&with(sections)), *expected, "{sections}");
    }
}

#[test]
fn errors_in_right_hand_sides_and_ranges() {
    assert_errors(&[
        ("RHS\n B most nan\n", "line 15, column 9: `nan` is not a number"),
        (
            "RHS\n B cost 1e30\n",
            "line 15, column 9: `1e30` counts as infinite (1e20 and beyond do); a finite number \
             is needed here",
        ),
        ("RHS\n B\n", "line 15, column 2: expected pairs of row name and value"),
        (
            "RHS\n B most 1\n B most 2\n",
            "line 16, column 4: row `most` already has a right-hand side, given in line 15",
        ),
        ("RHS\n B most -inf\n", "line 15, column 9: no point can satisfy row `most`"),
        ("RHS\n B same 1e30\n", "line 15, column 9: no point can satisfy row `same`"),
        (
            "RHS\n B least -inf\nRANGES\n R least 1\n",
            "line 15, column 10: row `least` has a range, so its right-hand side must be finite",
        ),
    ]);
}

#[test]
fn errors_in_bounds() {
    assert_errors(&[
        (
            "BOUNDS\n XX B x 1\n",
            "line 15, column 2: `XX` is not a bound kind; expected LO, UP, FX, FR, MI, PL, BV, \
             LI, UI, SC or SI",
        ),
        ("BOUNDS\n SC B x -inf\n", "line 15, column 9: an upper bound cannot be -infinity"),
        ("BOUNDS\n UP x\n", "line 15, column 5: bound kind `UP` needs a number"),
        (
            "BOUNDS\n UP\n",
            "line 15, column 2: expected a bound kind, an optional set name, a column name and a value",
        ),
        ("BOUNDS\n UP B x nan\n", "line 15, column 9: `nan` is not a number"),
        ("BOUNDS\n UP B x -1e30\n", "line 15, column 9: an upper bound cannot be -infinity"),
        ("BOUNDS\n LO B x 1e30\n", "line 15, column 9: a lower bound cannot be +infinity"),
        ("BOUNDS\n FX B x Inf\n", "line 15, column 9: a lower bound cannot be +infinity"),
        ("BOUNDS\n LO B x 2\n UP B x 1\n", "line 16, column 7: bounds of `x` are crossed: 2 > 1"),
        ("BOUNDS\n LO B x 0\n UP B x -1\n", "line 16, column 7: bounds of `x` are crossed: 0 > -1"),
    ]);
}

#[test]
fn errors_in_quadratic_sections() {
    assert_errors(&[
        ("QUADOBJ\n x x\n", "line 15, column 4: expected two column names and a value"),
        ("QUADOBJ\n x q 1\n", "line 15, column 4: column `q` is not in COLUMNS"),
        (
            "QUADOBJ\n x y 1e20\n",
            "line 15, column 6: `1e20` counts as infinite (1e20 and beyond do); a finite number \
             is needed here",
        ),
        ("QMATRIX\n x x 1\n x x 1\n", "line 16, column 2: a second entry for `x` and `x`"),
        ("QCMATRIX\n", "line 14, column 1: expected the name of a row behind QCMATRIX"),
        (
            "QCMATRIX most least\n",
            "line 14, column 15: nothing can follow the section name `QCMATRIX` (data lines begin with a \
             space)",
        ),
        ("QCMATRIX no\n", "line 14, column 10: row `no` was not declared in ROWS"),
        (
            "QCMATRIX cost\n x x 2\n",
            "line 14, column 10: row `cost` is the objective; write its products as QMATRIX (with Q of \
             `1/2 x'Qx`)",
        ),
        (
            "QCMATRIX most\n x x 2\nQSECTION most\n y y 2\n",
            "line 16, column 10: row `most` already has products, given from line 14 on; keep one section",
        ),
        ("QCMATRIX most\n x x 2\n x x 2\n", "line 16, column 2: a second entry for `x` and `x`"),
        (
            "QCMATRIX most\n x x 2\n x y 1\n y y 2\n",
            "line 16, column 2: QCMATRIX is not symmetric: the entry for `y` and `x` differs or is missing",
        ),
        (
            "QCMATRIX most\n x y 6e19\n y x 6e19\n",
            "line 15, column 6: twice `6e19` counts as infinite (1e20 and beyond do); a finite number is \
             needed here",
        ),
        ("QCMATRIX most\n x q 2\n", "line 15, column 4: column `q` is not in COLUMNS"),
        (
            "QCMATRIX same\n x x 2\n",
            "line 14, column 10: row `same` has products, so it needs one limit (a row of kind L or G \
             without a range); with two it is not convex",
        ),
        (
            "RHS\n B most 4\nRANGES\n R most 3\nQCMATRIX most\n x x 2\n",
            "line 18, column 10: row `most` has products, so it needs one limit (a row of kind L or G \
             without a range); with two it is not convex",
        ),
        (
            "QMATRIX\n x x 2\n x y 1\n y y 2\n",
            "line 16, column 2: QMATRIX is not symmetric: the entry for `y` and `x` differs or is \
             missing",
        ),
        (
            "QUADOBJ\n x x 2\nQMATRIX\n x x 2\n",
            "line 16, column 1: QUADOBJ and QMATRIX cannot both be given",
        ),
    ]);
}

#[test]
fn errors_in_indicators() {
    assert_errors(&[
        (
            "INDICATORS\n IF most x 1\n",
            "line 15, column 10: `x` is not binary; conditions and logic, as in `most`, take \
             binary variables only",
        ),
        ("INDICATORS\n IF most k 2\n", "line 15, column 12: expected 0 or 1, found `2`"),
        (
            "INDICATORS\n IF cost k 1\n",
            "line 15, column 5: row `cost` is an N row; only L, G and E rows can be switched",
        ),
        ("INDICATORS\n ON most k 1\n", "line 15, column 2: expected IF, found `ON`"),
        (
            "INDICATORS\n IF most k 1\n IF most k 0\n",
            "line 16, column 5: row `most` already has a condition, given in line 15",
        ),
    ]);
}

#[test]
fn columns_count_characters() {
    let text =
        |value: char| format!("ROWS\n N c\n L x\nCOLUMNS\n  höhe\u{a0}x  {value} \nENDATA\n");
    let model = read(&text('2'));
    assert!(model.to_string().contains("  x: 2 höhe <= 0\n"), "{model}");
    assert_eq!(error(&text('y')), "line 5, column 11: `y` is not a number");
}
