//! MPS files: what each section means, what damaged files say, and exact round trips.

use carom::model::mps;
use carom::prelude::*;
use proptest::prelude::*;

fn read(text: &str) -> Model {
    mps::read(text).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

fn error(text: &str) -> String {
    match mps::read(text) {
        Ok(model) => panic!("was read:\n{model}"),
        Err(error) => error.to_string(),
    }
}

/// A file with one objective row, rows of all kinds and the columns `x`, `y` (continuous) and `k`
/// (integer), followed by the given sections.
fn with(sections: &str) -> String {
    format!(
        "NAME small\nROWS\n N cost\n L most\n G least\n E same\nCOLUMNS\n x cost 1 most 1\n \
         x least 1\n y most 2 same 1\n M1 'MARKER' 'INTORG'\n k cost -1 least 3\n \
         M2 'MARKER' 'INTEND'\n{sections}ENDATA\n"
    )
}

fn limits(model: &Model, name: &str) -> (f64, f64) {
    let row = model.constraints().find(|row| row.name().to_string() == name).unwrap();
    (row.limits().lower, row.limits().upper)
}

fn bounds(model: &Model, name: &str) -> (VariableKind, f64, f64) {
    let variable = model.variable_ref(model.variable_by_name(name).unwrap()).unwrap();
    (variable.kind(), variable.bounds().lower, variable.bounds().upper)
}

/// Text and every number to the last bit.
fn assert_same(left: &Model, right: &Model) {
    assert_eq!(left.to_string(), right.to_string());
    assert_eq!(left.name(), right.name());
    let bits =
        |interval: carom::interval::Interval| (interval.lower.to_bits(), interval.upper.to_bits());
    for (a, b) in left.variables().zip(right.variables()) {
        assert_eq!(bits(a.bounds()), bits(b.bounds()), "{}", a.name());
    }
    let terms = |terms: &[(Variable, f64)]| -> Vec<(usize, u64)> {
        terms.iter().map(|(v, a)| (v.index(), a.to_bits())).collect()
    };
    for (a, b) in left.constraints().zip(right.constraints()) {
        assert_eq!(bits(a.limits()), bits(b.limits()), "{}", a.name());
        assert_eq!(terms(a.terms()), terms(b.terms()), "{}", a.name());
    }
    for (a, b) in left.indicators().zip(right.indicators()) {
        assert_eq!(bits(a.limits()), bits(b.limits()), "{}", a.name());
        assert_eq!(terms(a.terms()), terms(b.terms()), "{}", a.name());
    }
    let (a, b) = (left.objective(), right.objective());
    assert_eq!(terms(&a.affine().terms()), terms(&b.affine().terms()));
    assert_eq!(a.affine().offset().to_bits(), b.affine().offset().to_bits());
    let products = |model: &Model| -> Vec<(usize, usize, u64)> {
        let products = model.objective().products();
        products.iter().map(|(a, b, q)| (a.index(), b.index(), q.to_bits())).collect()
    };
    assert_eq!(products(left), products(right));
}

// -- sections ---------------------------------------------------------------------------------

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
    assert_eq!(bound(" UI B x 1;", "x"), (Binary, 0.0, 1.0));
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
    assert_eq!(
        error(&with("QUADOBJ\n x x -2\n")),
        "the objective is not convex: in the minimize direction its quadratic part has curvature \
         -2.000e0 along a direction that involves `x`; only convex costs to minimise (concave ones \
         to maximise) have a proof of optimality here; write squares, or linearise products with a \
         binary"
    );
}

#[test]
fn indicators() {
    let model = read(&with("RHS\n B most 4\nINDICATORS\n IF most k 1\n IF same k 0\n"));
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

// -- writing ----------------------------------------------------------------------------------

#[test]
fn the_text_that_is_written() {
    let mut model = Model::new("all kinds");
    let x = model.continuous_family("x", 2, -1.5, 0.1).unwrap();
    let free = model.continuous("free", f64::NEG_INFINITY, f64::INFINITY).unwrap();
    let below = model.continuous("below", f64::NEG_INFINITY, 2.0).unwrap();
    let z = model.binary("z").unwrap();
    let n = model.integer("n", 0.0, f64::INFINITY).unwrap();
    let m = model.integer("m", 3.0, 3.0).unwrap();
    model.add("obj", (x[0] + 0.1 * x[1]).within(-1.2, 1.1)).unwrap();
    model.add("least", (free - below + 1.0).ge(0.0)).unwrap();
    model.add("same", (n + m).equals(4.0)).unwrap();
    model.add("switched", z.off().implies(free.within(0.0, 1e-7))).unwrap();
    model.maximize(2.5 * x[0] - x[0].square() - (x[1] - free).square() + 7.0).unwrap();
    let expected = "\
NAME all kinds
OBJSENSE
 MAX
ROWS
 N obj_
 L obj
 G least
 E same
 L switched
COLUMNS
 x[0] obj_ 2.5
 x[0] obj 1
 x[1] obj 0.1
 free least 1
 free switched 1
 below least -1
 MARKER0 'MARKER' 'INTORG'
 z obj_ 0
 n same 1
 m same 1
 MARKER1 'MARKER' 'INTEND'
RHS
 RHS obj_ -7
 RHS obj 1.1
 RHS least -1
 RHS same 4
 RHS switched 1e-7
RANGES
 RANGE obj 2.3
 RANGE switched 1e-7
BOUNDS
 LO BOUND x[0] -1.5
 UP BOUND x[0] 0.1
 LO BOUND x[1] -1.5
 UP BOUND x[1] 0.1
 FR BOUND free
 MI BOUND below
 UP BOUND below 2
 BV BOUND z
 PL BOUND n
 FX BOUND m 3
QUADOBJ
 x[0] x[0] -2
 x[1] x[1] -2
 x[1] free 2
 free free -2
INDICATORS
 IF switched z 0
ENDATA
";
    let text = mps::write(&model).unwrap();
    assert_eq!(text, expected);
    assert_same(&model, &read(&text));
}

#[test]
fn names_that_cannot_be_written() {
    let text = mps::write(&Model::new("two\nlines"));
    assert_eq!(
        text.unwrap_err().to_string(),
        "`two\nlines` cannot be a name: it is empty or contains white space or control characters"
    );
}

#[test]
fn limits_that_no_binary_range_reaches() {
    let pairs = [
        (-1.2, 1.1),
        (-1.0 - 2.0 * f64::EPSILON, 1.0 + f64::EPSILON),
        (-9e19, 9e19),
        (-9.999999999999999e19, 1e-300),
        (5e-324, 9.999999999999999e19),
        (-5e-324, 5e-324),
        (-0.0, 0.0),
        (0.0, -0.0),
        (-0.0, 3.0),
        (-3.0, -0.0),
        (0.1, 0.30000000000000004),
        (1e-9, 1e16),
        (-1e16, 1e-9),
    ];
    let mut model = Model::new("pairs");
    let x = model.continuous("x", 0.0, 1.0).unwrap();
    for (k, (lower, upper)) in pairs.into_iter().enumerate() {
        model.add(("r", k), x.within(lower, upper)).unwrap();
    }
    let text = mps::write(&model).unwrap();
    assert_same(&model, &read(&text));
    assert!(text.lines().all(|line| line.len() < 80), "{text}");
}

// -- damaged files ----------------------------------------------------------------------------

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
             COLUMNS, RHS, RANGES, BOUNDS, QUADOBJ, QMATRIX, INDICATORS or ENDATA (data lines \
             begin with a space)",
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
        ("ROWS\n Q r\n", "line 2, column 2: row kind `Q` is not one of N, L, G and E"),
        ("ROWS\n L\n", "line 2, column 2: expected a row kind (N, L, G or E) and a row name"),
        ("ROWS\n L a b\n", "line 2, column 6: expected a row kind (N, L, G or E) and a row name"),
        ("ROWS\n L r\n G  r\n", "line 3, column 5: row `r` was already declared in line 2"),
        (
            "ROWS\n L a\u{7}\n",
            "line 2, column 4: `a\u{7}` cannot be a name: it is empty or contains white space or \
             control characters",
        ),
    ];
    for (text, expected) in cases {
        assert_eq!(error(text), expected, "{text}");
    }
}

#[test]
fn errors_in_columns() {
    let columns = |lines: &str| error(&format!("ROWS\n N c\n L r\nCOLUMNS\n{lines}ENDATA\n"));
    assert_eq!(columns(" x q 1\n"), "line 5, column 4: row `q` was not declared in ROWS");
    assert_eq!(columns(" x r 1x\n"), "line 5, column 6: `1x` is not a number");
    assert_eq!(columns(" x r NaN\n"), "line 5, column 6: `NaN` is not a number");
    assert_eq!(
        columns(" x r 1e400\n"),
        "line 5, column 6: `1e400` counts as infinite (1e20 and beyond do); a finite number is \
         needed here"
    );
    assert_eq!(
        columns(" x r 1 r 2\n"),
        "line 5, column 8: column `x` has a second entry in row `r`"
    );
    assert_eq!(
        columns(" x r 1\n x c 1 \n x r 1\n"),
        "line 7, column 4: column `x` has a second entry in row `r`"
    );
    assert_eq!(
        columns(" x r 1\n y r 1\n x c 1\n"),
        "line 7, column 2: column `x` already began in line 5; its entries must stand together"
    );
    assert_eq!(
        columns(" M 'MARKER' 'SOSORG'\n"),
        "line 5, column 13: marker 'SOSORG' is not known; expected 'INTORG' or 'INTEND'"
    );
    assert_eq!(columns(" M 'MARKER' 'INTEND'\n"), "line 5, column 13: 'INTEND' without 'INTORG'");
    assert_eq!(
        columns(" M 'MARKER' 'INTORG'\n M 'MARKER' 'INTORG'\n"),
        "line 6, column 13: 'INTORG' of line 5 is still open"
    );
}

#[test]
fn errors_in_later_sections() {
    let cases = [
        ("RHS\n B nowhere 1\n", "line 15, column 4: row `nowhere` was not declared in ROWS"),
        ("RHS\n B most nan\n", "line 15, column 9: `nan` is not a number"),
        (
            "RHS\n B cost 1e30\n",
            "line 15, column 9: `1e30` counts as infinite (1e20 and beyond do); a finite number is needed here",
        ),
        ("RHS\n B\n", "line 15, column 2: expected pairs of row name and value"),
        (
            "RHS\n B most 1\n B most 2\n",
            "line 16, column 4: row `most` already has a right-hand side, given in line 15",
        ),
        (
            "RHS\n B most 1\n C least 2\n",
            "line 16, column 2: a second set `C` beside `B`; only one set can be read",
        ),
        ("RHS\n B most -inf\n", "line 15, column 9: no point can satisfy row `most`"),
        ("RHS\n B same 1e30\n", "line 15, column 9: no point can satisfy row `same`"),
        (
            "RANGES\n R most 1 most 1\n",
            "line 15, column 11: row `most` already has a range, given in line 15",
        ),
        ("RANGES\n R cost 1\n", "line 15, column 9: the objective row cannot have a range"),
        (
            "RHS\n B least -inf\nRANGES\n R least 1\n",
            "line 15, column 10: row `least` has a range, so its right-hand side must be finite",
        ),
        (
            "BOUNDS\n XX B x 1\n",
            "line 15, column 2: `XX` is not a bound kind; expected LO, UP, FX, FR, MI, PL, BV, LI or UI",
        ),
        (
            "BOUNDS\n SC B x 1\n",
            "line 15, column 2: bound kind `SC` declares a semi-continuous column, which a model cannot hold; write it with a binary and an indicator",
        ),
        ("BOUNDS\n UP B q 1\n", "line 15, column 7: column `q` is not in COLUMNS"),
        ("BOUNDS\n UP B x\n", "line 15, column 5: column `B` is not in COLUMNS"),
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
        (
            "BOUNDS\n UP B x 1\n UP B x 2\n",
            "line 16, column 7: the upper bound of `x` was 1 before and is 2 now; keep one of them",
        ),
        (
            "BOUNDS\n UP B x 1\n UP C y 2\n",
            "line 16, column 5: a second set `C` beside `B`; only one set can be read",
        ),
        ("QUADOBJ\n x x\n", "line 15, column 4: expected two column names and a value"),
        ("QUADOBJ\n x q 1\n", "line 15, column 4: column `q` is not in COLUMNS"),
        (
            "QUADOBJ\n x y 1e20\n",
            "line 15, column 6: `1e20` counts as infinite (1e20 and beyond do); a finite number is needed here",
        ),
        (
            "QUADOBJ\n x y 1\n y x 1\n",
            "line 16, column 2: a second entry for `y` and `x` (QUADOBJ takes one triangle only)",
        ),
        (
            "QMATRIX\n x x 2\n x y 1\n y y 2\n",
            "line 16, column 2: QMATRIX is not symmetric: the entry for `y` and `x` differs or is missing",
        ),
        (
            "QUADOBJ\n x x 2\nQMATRIX\n x x 2\n",
            "line 16, column 1: QUADOBJ and QMATRIX cannot both be given",
        ),
        (
            "INDICATORS\n IF most x 1\n",
            "line 15, column 10: `x` is not binary; only a binary variable can be the condition of `most`",
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
    ];
    for (sections, expected) in cases {
        assert_eq!(error(&with(sections)), expected, "{sections}");
    }
}

// -- random models and random damage ----------------------------------------------------------

/// A number a model can hold: round decimals, any bits, and the awkward ones.
fn number() -> impl Strategy<Value = f64> {
    prop_oneof![
        4 => (-400_i32..400).prop_map(|n| f64::from(n) / 10.0),
        2 => any::<f64>().prop_filter("finite", |v| v.abs() < 1e20),
        2 => -3.0..3.0_f64,
        1 => prop::sample::select(vec![0.0, -0.0, 1.0, -1.0, 5e-324, -9.9e19, 1e-300, 1e16, 0.1]),
    ]
}

/// Two numbers in order, either possibly infinite but not both unless allowed.
fn pair(both_infinite: bool) -> impl Strategy<Value = (f64, f64)> {
    let open = if both_infinite { 1 } else { 0 };
    prop_oneof![
        6 => (number(), number()).prop_map(|(a, b)| if a <= b { (a, b) } else { (b, a) }),
        2 => number().prop_map(|a| (a, a)),
        2 => number().prop_map(|a| (a, f64::INFINITY)),
        2 => number().prop_map(|a| (f64::NEG_INFINITY, a)),
        open => Just((f64::NEG_INFINITY, f64::INFINITY)),
    ]
}

fn name() -> impl Strategy<Value = String> {
    prop_oneof![
        3 => "[a-zA-Z_][a-zA-Z0-9_.]{0,6}",
        2 => "[a-z]\\[[0-9]{1,3}\\]",
        1 => prop::sample::select(vec![
            "RHS", "BOUND", "RANGE", "obj", "obj_", "'MARKER'", "'INTORG'", "*", "$", "1", "-1e5",
            "IF", "MAX", "ENDATA", "NAME", "höhe", "UP", "FR", "MARKER0",
        ]).prop_map(str::to_owned),
    ]
}

#[derive(Debug, Clone)]
struct Plan {
    name: String,
    maximize: bool,
    constant: f64,
    variables: Vec<(String, u8, (f64, f64), f64)>,
    rows: Vec<(String, Vec<(usize, f64)>, (f64, f64), Option<(usize, bool)>)>,
    squares: Vec<(f64, usize, f64, usize)>,
}

fn plan() -> impl Strategy<Value = Plan> {
    let variable = (name(), 0..4_u8, pair(true), number());
    let terms = prop::collection::vec((0..8_usize, number()), 1..5);
    let row = (name(), terms, pair(false), prop::option::of((0..8_usize, any::<bool>())));
    let square = (-9.0..9.0_f64, 0..8_usize, -9.0..9.0_f64, 0..8_usize);
    (
        "[a-z ]{0,8}",
        any::<bool>(),
        number(),
        prop::collection::vec(variable, 1..8),
        prop::collection::vec(row, 0..8),
        prop::collection::vec(square, 0..4),
    )
        .prop_map(|(name, maximize, constant, variables, rows, squares)| Plan {
            name: name.trim().to_owned(),
            maximize,
            constant,
            variables,
            rows,
            squares,
        })
}

/// Builds what a plan says; statements that a model refuses (names taken, empty rows) are left
/// out.
fn build(plan: &Plan) -> Model {
    let mut model = Model::new(plan.name.clone());
    let mut variables = Vec::new();
    for (name, kind, (lower, upper), _) in &plan.variables {
        let added = match kind {
            0 => model.binary(name),
            // Bounds within [0, 1] would make it a binary on reading.
            1 if *lower >= 0.0 && *upper <= 1.0 => {
                model.variable(name.as_str(), VariableKind::Binary, *lower, *upper)
            }
            1 => model.integer(name, *lower, *upper),
            _ => model.continuous(name, *lower, *upper),
        };
        variables.extend(added);
    }
    if variables.is_empty() {
        return model;
    }
    let pick = |k: usize| variables[k % variables.len()];
    for (name, terms, (lower, upper), condition) in &plan.rows {
        let mut expression = Affine::zero();
        terms.iter().for_each(|&(k, a)| expression.add_term(a, pick(k)));
        let row = expression.within(*lower, *upper);
        let refused = match *condition {
            Some((k, true)) => model.add(name, pick(k).on().implies(row)).err(),
            Some((k, false)) => model.add(name, pick(k).off().implies(row)).err(),
            None => model.add(name, row).err(),
        };
        drop(refused);
    }
    let mut objective = Quadratic::from(plan.constant);
    for (variable, (.., cost)) in variables.iter().zip(&plan.variables) {
        objective += *cost * *variable;
    }
    let sign = if plan.maximize { -1.0 } else { 1.0 };
    for &(a, i, b, j) in &plan.squares {
        objective += (a * pick(i) + b * pick(j)).square() * sign;
    }
    let sense = if plan.maximize { Sense::Maximize } else { Sense::Minimize };
    model.set_objective(sense, objective).unwrap();
    model
}

/// Files to damage: one written by hand with every section, one written by the crate.
fn whole_files() -> Vec<String> {
    let mut model = Model::new("whole");
    let x = model.continuous_family("x", 3, -1.0, 4.5).unwrap();
    let z = model.binary("z").unwrap();
    model.add("sum", (x[0] + x[1] + 0.5 * x[2]).within(-1.2, 1.1)).unwrap();
    model.add("hit", z.on().implies(x[1].le(0.0))).unwrap();
    model.minimize((x[0] - x[1]).square() + 3.0 * x[2] + 1.0).unwrap();
    let by_hand = with(
        "RHS\n B most 4 least -1e2\n B cost 2\nRANGES\n R most 3 least Infinity\nBOUNDS\n \
         UP B x 4\n MI B y\n BV B k\nQMATRIX\n x x 2\n x y 1D0\n y x 1\n y y 2\nINDICATORS\n \
         IF most k 1\n",
    );
    vec![by_hand, mps::write(&model).unwrap()]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(512))]

    #[test]
    fn round_trips_are_exact(plan in plan()) {
        let model = build(&plan);
        let text = mps::write(&model).unwrap();
        let again = mps::read(&text).unwrap_or_else(|error| panic!("{error}\n{text}"));
        assert_same(&model, &again);
        prop_assert_eq!(mps::write(&again).unwrap(), text);
    }

    #[test]
    fn two_sided_rows_are_exact((lower, upper) in pair(false)) {
        let mut model = Model::new("");
        let x = model.continuous("x", 0.0, 1.0).unwrap();
        model.add("r", x.within(lower, upper)).unwrap();
        assert_same(&model, &read(&mps::write(&model).unwrap()));
    }

    #[test]
    fn cut_off_files_are_refused(which in 0..2_usize, share in 0.0..1.0_f64) {
        let text = &whole_files()[which];
        let whole = text.len() - "ENDATA\n".len();
        let mut end = (share * whole as f64) as usize;
        while !text.is_char_boundary(end) {
            end -= 1;
        }
        let refused = matches!(mps::read(&text[..end]), Err(Error::Parse { .. }));
        prop_assert!(refused, "{}", &text[..end]);
    }

    #[test]
    fn damage_never_panics(
        which in 0..2_usize,
        edits in prop::collection::vec((any::<prop::sample::Index>(), 0..4_u8, any::<char>()), 1..6),
        words in prop::collection::vec(
            prop::sample::select(vec!["1e400", "-", "1e-999999999", "nan", "'MARKER'", "x", "UP"]),
            6,
        ),
    ) {
        let mut text: Vec<char> = whole_files()[which].chars().collect();
        for ((place, edit, letter), word) in edits.into_iter().zip(words) {
            let place = place.index(text.len());
            match edit {
                0 => { text.remove(place); }
                1 => text[place] = letter,
                2 => text.insert(place, '\n'),
                _ => { text.splice(place..place, word.chars()); }
            }
        }
        let text: String = text.into_iter().collect();
        if let Ok(model) = mps::read(&text) {
            let again = read(&mps::write(&model).unwrap());
            prop_assert_eq!(model.to_string(), again.to_string());
        }
    }
}
