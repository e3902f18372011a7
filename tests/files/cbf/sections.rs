//! The sections of linear programs: what is read from each.

use carom::prelude::*;

use super::{file, read, warned};

#[test]
fn a_program_with_all_linear_sections() {
    let text = "\
# Two products.
VER
3

OBJSENSE
MAX

VAR
4 3
L+ 2
F 1
L- 1

INT
1
1

CON
4 3
L- 2
F 1
L= 1

OBJACOORD
2
1 2.5
0 1

OBJBCOORD
-3

ACOORD
5
0 1 2
0 0 1
3 3 -1
1 2 1e-1
1 1 1

BCOORD
2
3 0.5
0 -4
";
    let expected = "maximize x[0] + 2.5 x[1] - 3\nsubject to\n  c[0]: x[0] + 2 x[1] <= 4\n  \
                    c[1]: x[1] + 0.1 x[2] <= 0\nwhere\n  x[0] >= 0\n  x[1] >= 0 integer\n  \
                    x[2] free\n  x[3] <= 0\n";
    let text = text.replace("3 3 -1\n", "3 2 -1\n3 3 -1\n").replace("ACOORD\n5", "ACOORD\n6");
    let expected = expected.replace("where", "  c[3]: -x[2] - x[3] = -0.5\nwhere");
    let model = read(&text);
    assert_eq!(model.to_string(), expected);
    // The order of sections does not matter, nor do blanks, comments and ends of lines.
    let mut sections: Vec<&str> = text.split("\n\n").collect();
    sections[1..].reverse();
    let turned = sections.join("\n  \n# \n\t").replace('\n', "\r\n");
    assert_eq!(read(&turned).to_string(), expected);
    assert_eq!(read(&format!("\u{feff}{turned}")).to_string(), expected);
}

#[test]
fn rows_of_one_variable_are_bounds() {
    let bounds = |cones: &str, entries: &str, constants: &str| {
        let text = file(&format!(
            "VAR; 1 1; F 1; CON; {cones}; ACOORD; {}; {entries}; BCOORD; {}; {constants}",
            entries.split(';').count(),
            constants.split(';').count(),
        ));
        read(&text).to_string().split_once("subject to\n").unwrap().1.to_owned()
    };
    assert_eq!(
        bounds("2 2; L+ 1; L- 1", "0 0 2; 1 0 1", "0 -3; 1 -4"),
        "where\n  1.5 <= x[0] <= 4\n"
    );
    assert_eq!(bounds("1 1; L+ 1", "0 0 -2", "0 3"), "where\n  x[0] <= 1.5\n");
    assert_eq!(bounds("1 1; L= 1", "0 0 4", "0 1"), "where\n  x[0] = -0.25\n");
    // The strictest of several counts.
    assert_eq!(bounds("2 1; L+ 2", "0 0 1; 1 0 1", "0 -3; 1 -2"), "where\n  x[0] >= 3\n");
    // A limit that is no number of its own stays a row.
    assert_eq!(bounds("1 1; L+ 1", "0 0 3", "0 -1"), "  c[0]: 3 x[0] >= 1\nwhere\n  x[0] free\n");
    // So does a bound that contradicts another one.
    assert_eq!(
        bounds("2 2; L+ 1; L- 1", "0 0 1; 1 0 1", "0 -3; 1 -2"),
        "  c[1]: x[0] <= 2\nwhere\n  x[0] >= 3\n"
    );
}

#[test]
fn integers_within_0_and_1_are_binaries() {
    let text = "VAR; 3 2; L+ 2; F 1; INT; 3; 2; 0; 1; CON; 2 1; L- 2; ACOORD; 2; 0 0 1; 1 1 1; \
                BCOORD; 2; 0 -1; 1 -7";
    let expected = "minimize 0\nsubject to\nwhere\n  x[0] binary\n  0 <= x[1] <= 7 integer\n  \
                    x[2] free integer\n";
    assert_eq!(read(&file(text)).to_string(), expected);
}

#[test]
fn halves_of_a_row_are_one() {
    let rows = |second: &str, constant: &str| {
        let text = file(&format!(
            "VAR; 2 1; F 2; CON; 2 2; L+ 1; L- 1; ACOORD; 4; 0 0 1; 0 1 2; {second}; BCOORD; 2; 0 1; \
             1 {constant}"
        ));
        read(&text).constraint_count()
    };
    assert_eq!(rows("1 0 1; 1 1 2", "-5"), 1);
    assert_eq!(rows("1 0 1; 1 1 3", "-5"), 2);
    // Crossed limits.
    assert_eq!(rows("1 0 1; 1 1 2", "5"), 2);
}

#[test]
fn what_is_omitted() {
    let (warnings, model) = warned("VER\n2\nVAR\n1 1\nL+ 1\n");
    assert_eq!(warnings, ["line 1, column 1: there is no OBJSENSE, so the objective is minimised"]);
    assert_eq!(model.to_string(), "minimize 0\nsubject to\nwhere\n  x[0] >= 0\n");
    assert_eq!(read("VER\n1\nOBJSENSE\nMAX\n").sense(), Sense::Maximize);
    assert_eq!(read("VER\n1\nOBJSENSE\nMAX").variable_count(), 0);
}

#[test]
fn what_others_may_read_differently() {
    let (warnings, _) = warned("VER\n4\nOBJSENSE\nMIN # a comment\nVAR\n1 1\nF 1\n");
    assert_eq!(
        warnings,
        [
            "line 2, column 1: version 4 is read as far as it is that of version 3",
            "line 4, column 5: taken as a comment from here on",
        ]
    );
}

#[test]
fn empty_lists_and_cones() {
    let text = "VAR; 2 3; F 1; L= 0; L+ 1; INT; 0; CON; 0 0; OBJACOORD; 0; ACOORD; 0; BCOORD; 0; PSDVAR; 0; \
                FCOORD; 0";
    assert_eq!(read(&file(text)).variable_count(), 2);
    // A row without variables is true or false.
    let text = |sign: &str| file(&format!("VAR; 1 1; F 1; CON; 1 1; L+ 1; BCOORD; 1; 0 {sign}1"));
    assert_eq!(super::optimum(&text("")), Some(0.0));
    assert_eq!(super::optimum(&text("-")), None);
}
