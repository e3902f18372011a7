//! Fixed columns: names with blanks, and files that are valid in both forms.

use carom::model::mps;
use carom::prelude::*;

use super::{error, read};

const BLANKS: &str = "\
NAME          TWO WORDS
ROWS
 N  TOTAL CO
 L  ROW 1
 G  ROW 2
COLUMNS
    COL 1     TOTAL CO            1.   ROW 1               1.
    COL 1     ROW 2               1.
    M 1       'MARKER'                 'INTORG'
    COL 2     TOTAL CO          -2.5   ROW 1      -1.23456E+1
    M 2       'MARKER'                 'INTEND'
RHS
    MY RHS    ROW 1               4.   ROW 2              -1.
RANGES
    MY RANGE  ROW 1               3.
BOUNDS
 UP MY BOUND  COL 1              10.
 BV MY BOUND  COL 2
INDICATORS
 IF ROW 2     COL 2                1
ENDATA
";

#[test]
fn blanks_in_names_become_underscores() {
    let model = read(BLANKS);
    assert_eq!(model.name(), "TWO WORDS");
    assert_eq!(
        model.to_string(),
        "minimize COL_1 - 2.5 COL_2\nsubject to\n  ROW_1: 1 <= COL_1 - 12.3456 COL_2 <= 4\n  \
         ROW_2: COL_2 = 1 implies COL_1 >= -1\nwhere\n  0 <= COL_1 <= 10\n  COL_2 binary\n"
    );
}

#[test]
fn names_of_quadratic_rows_have_blanks() {
    let products = "QCMATRIX   ROW 1\n    COL 1     COL 1               1.\nQSECTION  TOTAL CO\n    COL 1     \
                    COL 1               4.\nINDICATORS";
    let text = BLANKS
        .replace("INDICATORS", products)
        .replace("RANGES\n    MY RANGE  ROW 1               3.\n", "");
    let model = read(&text);
    assert_eq!(model.objective().products().len(), 1);
    assert_eq!(
        mps::write(&model).unwrap().split_once("QCMATRIX").unwrap().1.lines().next(),
        Some("   ROW_1")
    );
}

#[test]
fn errors_keep_their_place() {
    let clash = BLANKS.replace(" G  ROW 2", " G  ROW_1");
    assert_eq!(error(&clash), "line 5, column 5: row `ROW_1` was already declared in line 4");
    let number = BLANKS.replace("-1.23456E+1", "-1.23456X+1");
    assert_eq!(error(&number), "line 10, column 51: `-1.23456X+1` is not a number");
    // Out of their columns, names with blanks cannot be told from several.
    let shifted = BLANKS.replace("    COL 1     ROW 2 ", " COL 1     ROW 2    ");
    assert_eq!(
        error(&shifted),
        "line 3, column 11: expected a row kind (N, L, G or E) and a row name"
    );
}

/// What is written keeps to the columns where names and numbers fit, so that readers of fixed
/// columns take it as well.
#[test]
fn short_names_are_written_in_columns() {
    let mut model = Model::new("columns");
    let x = model.continuous("x", -1.5, 1e19).unwrap();
    let z = model.binary("switch_1").unwrap();
    model.add("row", (x + 0.5 * z).within(-1.2, 1.1)).unwrap();
    model.add("hit", z.on().implies(x.le(-1e-7))).unwrap();
    model.minimize(x.square() + 3.0 * z + 1.0).unwrap();
    let fields = [1..3, 4..12, 14..22, 24..36, 39..47];
    for line in mps::write(&model).unwrap().lines().filter(|line| line.starts_with(' ')) {
        for (column, letter) in line.chars().enumerate() {
            let inside = fields.iter().any(|field| field.contains(&column));
            assert!(inside || letter == ' ', "column {} of {line}", column + 1);
        }
    }
}
