//! Damaged files: every error with its line and column.

use carom::model::lp;

use super::error;

#[test]
fn errors_name_line_and_column() {
    let found = "products and squares stand on the left in brackets, as `[ x ^2 + 2 x * y ]`, in the \
                 objective with `/ 2` behind";
    let cases = [
        ("", "line 1, column 1: the file ends without `End`; it may have been cut off"),
        (
            "\n \\ Problem name: a\u{0}b\nmin x\nend",
            "line 2, column 2: the model's name has a control character",
        ),
        ("x + y", "line 1, column 1: expected `Minimize` or `Maximize`, found `x`"),
        ("min\n x +", "line 2, column 5: the file ends without `End`; it may have been cut off"),
        (
            "min x y\nend",
            "line 1, column 7: expected a section such as `Subject To`, `Bounds` or `End`, found \
             `y`",
        ),
        ("min 2 x +\nst\nend", "line 2, column 1: expected a number or a name, found `st`"),
        (
            "min 1e400 x\nend",
            "line 1, column 5: `1e400` counts as infinite (1e20 and beyond do); a finite number \
             is needed here",
        ),
        ("min inf\nend", "line 1, column 5: the objective must be finite"),
        ("min 1 + inf\nend", "line 1, column 9: infinity cannot be part of a sum"),
        ("min a: x b: y\nend", "line 1, column 10: a second objective; a model has one, keep one"),
        ("min x max y end", "line 1, column 7: a second objective; a model has one, keep one"),
        (
            "min multi-objectives\nend",
            "line 1, column 5: a model has one objective and one set of limits; keep one",
        ),
        ("min x end x", ""),
        (
            "min a\u{7} end",
            "line 1, column 5: `a\u{7}` cannot be a name: it must be one or several words with single blanks between them",
        ),
        (
            "min x ]\nend",
            "line 1, column 7: expected a section such as `Subject To`, `Bounds` or `End`, found \
             `]`",
        ),
        ("min 2 [ x^2 ]\nend", "line 1, column 5: no factor can stand before `[`"),
        ("min [ x ]\nend", "line 1, column 9: expected `^2` or `*` and a name, found `]`"),
        ("min [ x^3 ]\nend", "line 1, column 9: the exponent can only be 2"),
        ("min [ x^2 y^2 ]\nend", "line 1, column 11: expected `+`, `-` or `]`, found `y`"),
        ("min [ x^2 ] / 3\nend", "line 1, column 15: only `/ 2` can stand behind `]`"),
        ("min [ x * 2 ]\nend", "line 1, column 11: expected the name of a variable, found `2`"),
        (
            "min [ 1e300 x^2 ]\nend",
            "line 1, column 7: 1e300 counts as infinite (1e20 and beyond do); a finite number is needed here",
        ),
        (
            "min x * y\nend",
            &format!(
                "line 1, column 7: expected a section such as `Subject To`, `Bounds` or `End`, \
                 found `*`; {found}"
            ),
        ),
        ("min x\nx[1]: y", "line 2, column 1: a second objective; a model has one, keep one"),
        (
            "min x\nst x[1",
            "line 2, column 7: the file ends without `End`; it may have been cut off",
        ),
    ];
    for (text, expected) in cases {
        if expected.is_empty() {
            super::read(text);
        } else {
            assert_eq!(error(text), expected, "{text}");
        }
    }
}

#[test]
fn errors_in_rows() {
    let row = |row: &str| error(&format!("min x + z\nst\n{row}\nbin z\nend\n"));
    assert_eq!(
        row("c: x + y"),
        "line 4, column 1: expected `+`, `-`, `<=`, `>=` or `=`, found `bin`"
    );
    assert_eq!(
        row("c: x <= y"),
        "line 3, column 9: expected a number (bring variables to the left), found `y`"
    );
    assert_eq!(
        row("c: x <= 2 y"),
        "line 3, column 11: expected a new line or a label, as the row before is complete (its \
         right-hand side is a number; variables stand on the left), found `y`"
    );
    assert_eq!(row("c: x <="), "line 4, column 1: expected a number, found `bin`");
    assert_eq!(
        row("c: x - 1 <= 3"),
        "line 3, column 8: a number beside variables is read differently by different solvers; \
         move it to the other side"
    );
    assert_eq!(
        row("c: 1 <= x >= 3"),
        "line 3, column 11: a row with two limits needs the same comparison twice, `<=` or `>=`"
    );
    assert_eq!(
        row("c: 1 = x = 3"),
        "line 3, column 10: a row with two limits needs the same comparison twice, `<=` or `>=`"
    );
    assert_eq!(
        row("c: 3 <= x <= 1"),
        "line 3, column 1: the limits of this row are crossed: 3 > 1"
    );
    assert_eq!(row("c: x <= -inf"), "line 3, column 1: no point can satisfy this row");
    assert_eq!(row("c: x = 1e30"), "line 3, column 1: no point can satisfy this row");
    assert_eq!(row("c: x + inf <= 3"), "line 3, column 8: infinity cannot be part of a sum");
    assert_eq!(row("c: inf <= 3"), "line 3, column 4: infinity cannot be compared to a number");
    assert_eq!(row("c: 3 <="), "line 4, column 1: expected an expression, found `bin`");
    assert_eq!(
        row("c: 9e19 x + 9e19 x <= 2"),
        "line 3, column 1: a coefficient of `c` is 180000000000000000000; give a finite number"
    );
    assert_eq!(
        row("c: x = 1 -> y <= 2\ngen x"),
        "line 3, column 4: `x` is not binary; conditions and logic, as in `c`, take binary \
         variables only"
    );
    let literal = "line 3, column 4: expected `z = 0` or `z = 1` as the condition before `->`";
    for condition in ["z = 2", "z <= 1", "2 z = 1", "z + x = 1", "z + 1 = 1", "1 <= 2"] {
        assert_eq!(row(&format!("c: {condition} -> x <= 2")), literal);
    }
    assert_eq!(
        row("c: z = 1 <-> x <= 2"),
        "line 3, column 10: `<->` cannot be read; write an indicator for each direction (`->`)"
    );
    assert_eq!(
        row("c: z = 1 -> z = 1 -> x <= 2"),
        "line 3, column 19: expected a new line or a label, as the row before is complete (its \
         right-hand side is a number; variables stand on the left), found `->`"
    );
}

#[test]
fn errors_in_later_sections() {
    let with = |sections: &str| error(&format!("min x + z\n{sections}\nend\n"));
    assert_eq!(
        with("bounds\n x 3"),
        "line 3, column 4: expected `<=`, `>=`, `=` or `free`, found `3`"
    );
    assert_eq!(
        with("bounds\n 3 x"),
        "line 3, column 4: expected `+`, `-`, `<=`, `>=` or `=`, found `x`"
    );
    assert_eq!(
        with("bounds\n 3 <= 4"),
        "line 3, column 7: expected the name of a variable, found `4`"
    );
    assert_eq!(with("bounds\n x <= y"), "line 3, column 7: expected a number, found `y`");
    assert_eq!(with("bounds\n x <= -inf"), "line 3, column 8: an upper bound cannot be -infinity");
    assert_eq!(with("bounds\n inf <= x"), "line 3, column 2: a lower bound cannot be +infinity");
    assert_eq!(
        with("bounds\n 1 <= x >= 3"),
        "line 3, column 9: two bounds need the same comparison twice, `<=` or `>=`"
    );
    assert_eq!(
        with("bounds\n 1 = x <= 3"),
        "line 3, column 8: two bounds need the same comparison twice, `<=` or `>=`"
    );
    assert_eq!(
        with("bounds\n x <= -2"),
        "line 3, column 2: bounds of `x` are crossed: 0 > -2 (where none is given, the lower bound \
         is 0; write `-inf <=` for none)"
    );
    assert_eq!(with("bounds\n 3 <= x <= 2"), "line 3, column 7: bounds of `x` are crossed: 3 > 2");
    assert_eq!(with("gen\n 3"), "line 3, column 2: expected the name of a variable, found `3`");
    assert_eq!(
        with("semi-integer\n x"),
        "line 2, column 1: section `semi` cannot be read: list its variables under \
         `Semi-Continuous` and under `General`"
    );
    assert_eq!(
        with("lazy constraints\n c: x <= 2"),
        "line 2, column 1: section `lazy` cannot be read: move its rows to `Subject To`, where \
         they \
         always hold"
    );
    assert_eq!(
        with("PWLObj\n x: (0, 1) (1, 1)"),
        "line 2, column 1: section `PWLObj` cannot be read: write each function under `General \
         Constraints`, as `y = PWL ( x ) : ( 0 , 0 ) ( 1 , 2 )`, and `y` in the objective"
    );
    assert_eq!(
        error("min x[1] + x{1}\nend"),
        "line 1, column 12: the name `x[1]` is already taken by another variable; choose another \
         one"
    );
}

#[test]
fn errors_in_rows_with_products() {
    let row = |row: &str| error(&format!("min x + z\nst\n{row}\nbin z\nend\n"));
    assert_eq!(
        row("c: x + [ x^2 ] = 3"),
        "line 3, column 1: a row with products needs one limit, `<=` or `>=`; with two or as an equation \
         it is not convex"
    );
    assert_eq!(
        row("c: 1 <= [ x^2 ] <= 3"),
        "line 3, column 1: a row with products needs one limit, `<=` or `>=`; with two or as an equation \
         it is not convex"
    );
    assert_eq!(
        row("c: y <= [ x^2 ]"),
        "line 3, column 9: expected a number (bring variables to the left), found `[`; products and \
         squares stand on the left in brackets, as `[ x ^2 + 2 x * y ]`, in the objective with `/ 2` behind"
    );
    assert_eq!(
        row("c: 3 + [ x^2 ] <= 5"),
        "line 3, column 4: a number beside variables is read differently by different solvers; move it to \
         the other side"
    );
    assert_eq!(
        row("c: [ 9e19 x^2 + 9e19 x^2 ] <= 2"),
        "line 3, column 1: a coefficient of `c` is 180000000000000000000; give a finite number"
    );
}

#[test]
fn files_of_lp_solve_are_known_as_such() {
    let help = "this is the LP format of lp_solve, with `max:` and `;`, and not that of CPLEX, which \
                is read here; `lp_solve -S1 -parse FILE -wfmps OUT.mps` writes such a file as MPS";
    for text in [
        "/* a comment */\nmax: 3x + 2y;\nc1: x + y <= 4;\nint x;\n",
        "/* two\nlines */ min: ;\r\nx >= 1;\r\n",
        "// a comment\nmaximise: 3x;\n",
        "max: 3x + 2y;",
        "3 x + 2 y; // no word for the direction\nx + y >= 2;",
        "maximize: x\n + y;\n-R1 >= -8;\n",
    ] {
        assert_eq!(error(text), format!("line 1, column 1: {help}"), "{text}");
    }
    assert!(
        error("\n  max: 3x;\n").starts_with("line 2, column 3: this is the LP format of lp_solve")
    );
    // What others write is judged as before.
    assert!(lp::read("max x; st r: x; <= 2\nend").is_ok());
    assert!(
        error("max x\nst\n r: x <= \\ 4;\nend").starts_with("line 4, column 1: expected a number")
    );
}

/// Numbers as some spreadsheets write them.
#[test]
fn decimal_commas_are_named() {
    let comma = |at: &str| {
        format!(
            "line {at}: `0,66667` has a decimal comma; numbers have a decimal point, as `0.66667`"
        )
    };
    assert_eq!(error("min x\nst\n c: 0,66667 x >= 1\nend"), comma("3, column 5"));
    assert_eq!(error("min x\nst\n c: x >= 0,66667\nend"), comma("3, column 10"));
    assert_eq!(error("min x\nst\n c: x >= 1\nbounds\n x <= 0,66667\nend"), comma("5, column 7"));
    assert_eq!(error("min [ 0,66667 x ^2 ]\nst\n c: x >= 1\nend"), comma("1, column 7"));
    // A comma that begins a name is none.
    assert!(lp::read("min 2 ,x\nst\n c: 3 ,x >= 1\nend").is_ok());
}
