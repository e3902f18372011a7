//! Damaged files: every error with its line and column.

use carom::ErrorKind;
use carom::model::cbf;

use super::{error, file};

/// Asserts the errors of whole files.
fn assert_errors(cases: &[(&str, &str)]) {
    for (text, expected) in cases {
        assert_eq!(error(text), *expected, "{text}");
    }
}

/// Asserts the errors of sections after four lines.
fn assert_in_sections(cases: &[(&str, &str)]) {
    for (sections, expected) in cases {
        assert_eq!(error(&file(sections)), *expected, "{sections}");
    }
}

#[test]
fn frames() {
    assert_errors(&[
        ("", "line 1, column 1: there is no section; a CBF file begins with `VER`"),
        ("# nothing\n\n", "line 2, column 1: there is no section; a CBF file begins with `VER`"),
        (
            "VAR\n1 1\nF 1\n",
            "line 1, column 1: expected `VER`, with which a CBF file begins, found `VAR`",
        ),
        ("ver\n1\n", "line 1, column 1: expected `VER`, with which a CBF file begins, found `ver`"),
        (
            "NAME p\nROWS\n",
            "line 1, column 6: nothing can follow `NAME` in its line; its contents begin in the next one",
        ),
        (
            "VER 1\n",
            "line 1, column 5: nothing can follow `VER` in its line; its contents begin in the next one",
        ),
        (
            "VER",
            "line 1, column 4: the file ends before the number of the version below `VER`; it may have \
             been cut off",
        ),
        ("VER\n0\n", "line 2, column 1: expected a version from 1 to 3, found 0"),
        ("VER\n1.5\n", "line 2, column 1: expected a whole number, found `1.5`"),
        (
            "VER\n1 2\n",
            "line 2, column 3: expected the number of the version below `VER`, alone in the line",
        ),
        (
            "VER\n1\nVER\n1\n",
            "line 3, column 1: a second section `VER`; the first one is in line 1, keep one of them",
        ),
        ("VER\n1\nOBJSENSE\nmin\n", "line 4, column 1: expected MIN or MAX, found `min`"),
        (
            "VER\n1\nOBJSENSE\nMIN\nROWS\n0\n",
            "line 5, column 1: section `ROWS` is not known; expected OBJSENSE, VAR, INT, CON, \
             OBJACOORD, OBJBCOORD, ACOORD or BCOORD",
        ),
    ]);
}

#[test]
fn sections_that_a_model_cannot_hold() {
    let matrices =
        "it is about semidefinite matrices, and a model has linear rows and second-order cones";
    let powers = "it is about power cones, and a model has linear rows and second-order cones";
    for (name, help) in [
        ("PSDVAR", matrices),
        ("PSDCON", matrices),
        ("OBJFCOORD", matrices),
        ("FCOORD", matrices),
        ("HCOORD", matrices),
        ("DCOORD", matrices),
        ("POWCONES", powers),
        ("POW*CONES", powers),
    ] {
        let expected = format!("line 5, column 1: section `{name}` cannot be read: {help}");
        assert_eq!(error(&file(&format!("{name}; 1; 3"))), expected);
    }
    assert_eq!(
        error(&file("CHANGE")),
        "line 5, column 1: section `CHANGE` cannot be read: a model is one program; keep the sections of \
         one"
    );
}

#[test]
fn cones_that_a_model_cannot_hold() {
    for (cone, family) in [
        ("EXP", "an exponential cone"),
        ("EXP*", "an exponential cone"),
        ("@0:POW", "a power cone"),
        ("@2:POW*", "a power cone"),
        ("GMEANABS", "a cone of geometric means"),
        ("GMEANABS*", "a cone of geometric means"),
        ("SVECPSD", "a semidefinite cone"),
    ] {
        for section in ["VAR", "CON"] {
            let expected = format!(
                "line 7, column 1: cone `{cone}` cannot be read: it is {family}, and a model has linear \
                 rows and second-order cones (F, L=, L+, L-, Q and QR); write it with these"
            );
            assert_eq!(error(&file(&format!("{section}; 3 1; {cone} 3"))), expected);
        }
    }
    assert_eq!(
        error(&file("VAR; 3 1; q 3")),
        "line 7, column 1: cone `q` is not known; expected F, L=, L+, L-, Q or QR (in these letters)"
    );
}

#[test]
fn blocks() {
    assert_in_sections(&[
        (
            "VAR; 3",
            "line 6, column 1: expected a number of entries and a number of cones below `VAR`, alone in \
             the line",
        ),
        (
            "VAR; 3 1 2",
            "line 6, column 5: expected a number of entries and a number of cones below `VAR`, alone in \
             the line",
        ),
        ("VAR; -3 1; F 3", "line 6, column 1: expected a whole number, found `-3`"),
        ("VAR; 3 1; F", "line 7, column 1: expected a cone and its size as an entry of VAR"),
        ("VAR; 3 1; F x", "line 7, column 3: expected a whole number, found `x`"),
        ("VAR; 3 1; Q 0", "line 7, column 3: a cone Q has at least 1 entry, found 0"),
        ("CON; 1 1; QR 1", "line 7, column 4: a cone QR has at least 2 entries, found 1"),
        (
            "VAR; 3 2; F 1; L+ 1",
            "line 6, column 1: VAR has 3 entries by its first number and 2 by the sizes of its cones; \
             correct one of them",
        ),
        (
            "VAR; 3 2; F 18446744073709551615; L+ 4",
            "line 6, column 1: VAR has 3 entries by its first number and too many by the sizes of its \
             cones; correct one of them",
        ),
        (
            "VAR; 3 2; F 3",
            "line 7, column 4: the file ends after 1 of the 2 entries of VAR; it may have been cut off",
        ),
        (
            "VAR; 3 2; F 3; INT; 0",
            "line 8, column 1: expected entry 2 of 2 of VAR, found `INT`; correct the number of entries in \
             line 6, or add what is missing",
        ),
        (
            "VAR; 3 1; F 3; L+ 2; INT; 0",
            "line 8, column 1: expected the name of a section after the 1 entries of VAR, found `L+`; \
             correct the number of entries in line 6",
        ),
        (
            "VAR; 1000000000000 1; F 1000000000000",
            "line 6, column 1: 1000000000000 variables are more than a file of this length can be about; \
             correct the number",
        ),
        (
            "VAR; 1 1; F 1; CON; 10000000000 1; Q 10000000000",
            "line 9, column 1: 10000000000 rows are more than a file of this length can be about; correct \
             the number",
        ),
    ]);
}

#[test]
fn entries() {
    assert_in_sections(&[
        ("INT; x", "line 6, column 1: expected a whole number, found `x`"),
        (
            "INT; 1 2",
            "line 6, column 3: expected a number of entries alone in the line below `INT`",
        ),
        (
            "INT; 1; 0",
            "line 7, column 1: there is no variable 0: the file has no section VAR; add it",
        ),
        (
            "VAR; 2 1; F 2; INT; 1; 2",
            "line 10, column 1: there is no variable 2: by VAR in line 6 there are 2, counted from 0; \
             correct the index or the number",
        ),
        (
            "VAR; 2 1; F 2; INT; 2; 1; 1",
            "line 11, column 1: a second entry for variable 1; the first one is in line 10, keep one of them",
        ),
        (
            "VAR; 2 1; F 2; OBJACOORD; 2; 1 2; 1 2",
            "line 11, column 1: a second entry for variable 1; the first one is in line 10, keep one of them",
        ),
        (
            "VAR; 2 1; F 2; OBJACOORD; 1; 5 2",
            "line 10, column 1: there is no variable 5: by VAR in line 6 there are 2, counted from 0; \
             correct the index or the number",
        ),
        (
            "VAR; 2 1; F 2; OBJACOORD; 1; 1",
            "line 10, column 1: expected a variable and a value as an entry of OBJACOORD",
        ),
        ("VAR; 2 1; F 2; OBJACOORD; 1; 1 x", "line 10, column 3: `x` is not a number"),
        (
            "VAR; 2 1; F 2; OBJACOORD; 1; 1 1e20",
            "line 10, column 3: `1e20` counts as infinite (1e20 and beyond do); a finite number is needed \
             here",
        ),
        (
            "OBJBCOORD; inf",
            "line 6, column 1: `inf` counts as infinite (1e20 and beyond do); a finite number is needed here",
        ),
        (
            "OBJBCOORD; 1 2",
            "line 6, column 3: expected the constant of the objective below `OBJBCOORD`, alone in the line",
        ),
        (
            "VAR; 2 1; F 2; ACOORD; 1; 0 0 1",
            "line 10, column 1: there is no row 0: the file has no section CON; add it",
        ),
        (
            "VAR; 2 1; F 2; CON; 1 1; L+ 1; ACOORD; 1; 0 2 1",
            "line 13, column 3: there is no variable 2: by VAR in line 6 there are 2, counted from 0; \
             correct the index or the number",
        ),
        (
            "VAR; 2 1; F 2; CON; 1 1; L+ 1; ACOORD; 1; 1 0 1",
            "line 13, column 1: there is no row 1: by CON in line 9 there are 1, counted from 0; correct \
             the index or the number",
        ),
        (
            "VAR; 2 1; F 2; CON; 1 1; L+ 1; ACOORD; 3; 0 0 1; 0 1 1; 0 0 1",
            "line 15, column 1: a second entry for row 0 and variable 0; the first one is in line 13, keep \
             one of them",
        ),
        (
            "VAR; 2 1; F 2; CON; 1 1; L+ 1; ACOORD; 1; 0 0 NaN",
            "line 13, column 5: `NaN` is not a number",
        ),
        (
            "VAR; 2 1; F 2; CON; 1 1; L+ 1; BCOORD; 2; 0 1; 0 1",
            "line 14, column 1: a second entry for row 0; the first one is in line 13, keep one of them",
        ),
        (
            "VAR; 2 1; F 2; CON; 1 1; L+ 1; BCOORD; 1; 0 1; 0 2",
            "line 14, column 1: expected the name of a section after the 1 entries of BCOORD, found `0`; \
             correct the number of entries in line 12",
        ),
    ]);
}

#[test]
fn what_is_cut_off_is_refused_or_says_less() {
    let whole = "VER\n1\nOBJSENSE\nMIN\nVAR\n3 1\nQ 3\nCON\n1 1\nL= 1\nACOORD\n2\n0 1 1\n0 2 1\n";
    for end in 0..whole.len() {
        if let Err(error) = cbf::read(&whole[..end]) {
            assert!(matches!(error.kind(), ErrorKind::Parse { .. }), "{error}");
        }
    }
    error(&whole[..whole.len() - 8]);
}
