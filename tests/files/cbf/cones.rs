//! Second-order cones: every kind of entry in every place, by optima.

use carom::model::cbf;

use super::{file, optimum, read};

#[track_caller]
fn check(sections: &str, expected: f64) {
    let text = file(sections);
    let found = optimum(&text).unwrap();
    assert!((found - expected).abs() <= 1e-5 * expected.abs().max(1.0), "{found}, not {expected}");
    // What is written says the same.
    let again = optimum(&cbf::write(&read(&text)).unwrap()).unwrap();
    assert!((again - found).abs() <= 1e-5 * found.abs().max(1.0), "{again}, not {found}");
}

#[track_caller]
fn check_infeasible(sections: &str) {
    let text = file(sections);
    assert_eq!(optimum(&text), None);
    assert_eq!(optimum(&cbf::write(&read(&text)).unwrap()), None);
}

#[test]
fn norms_of_variables() {
    check(
        "VAR; 3 1; Q 3; CON; 2 1; L= 2; OBJACOORD; 1; 0 1; ACOORD; 2; 0 1 1; 1 2 1; BCOORD; 2; 0 -3; 1 -4",
        5.0,
    );
    // As in CON, with the entries in another order.
    check(
        "VAR; 3 2; L= 1; F 2; CON; 5 2; L= 2; Q 3; OBJACOORD; 1; 2 1; \
         ACOORD; 5; 0 0 1; 0 1 1; 1 0 1; 2 2 1; 3 1 1; BCOORD; 2; 0 -3; 4 -4",
        5.0,
    );
    // An integer.
    check(
        "VAR; 3 1; Q 3; INT; 1; 0; CON; 2 1; L= 2; OBJACOORD; 1; 0 1; ACOORD; 2; 0 1 1; 1 2 1; BCOORD; \
         2; 0 -1; 1 -1",
        2.0,
    );
}

#[test]
fn norms_of_expressions() {
    // |(x + y - 1, 2 x, 3)| <= 2 z + 1; with x = 0, y = 1: z = 1.
    check(
        "VAR; 3 1; F 3; CON; 4 1; Q 4; OBJACOORD; 1; 2 1; \
         ACOORD; 4; 0 2 2; 1 0 1; 1 1 1; 2 0 2; BCOORD; 3; 0 1; 1 -1; 3 3",
        1.0,
    );
    // The same variable in head and tail: |(x, 4)| <= x + 2: 12 <= 4 x.
    check(
        "VAR; 1 1; F 1; CON; 3 1; Q 3; OBJACOORD; 1; 0 1; ACOORD; 2; 0 0 1; 1 0 1; BCOORD; 2; 0 2; 2 4",
        3.0,
    );
}

#[test]
fn rotated_cones_of_variables() {
    // 2 x y >= z^2, z = 4, y = 2.
    check(
        "VAR; 3 1; QR 3; CON; 2 1; L= 2; OBJACOORD; 1; 0 1; ACOORD; 2; 0 1 1; 1 2 1; BCOORD; 2; 0 -2; 1 -4",
        4.0,
    );
    // Factors, negative in the tail, and an integer in the head: 2 (2 x) (3 y) >= (-2 z)^2.
    check(
        "VAR; 3 2; F 2; L+ 1; INT; 1; 0; CON; 5 2; L= 2; QR 3; OBJACOORD; 1; 0 1; \
         ACOORD; 5; 0 1 1; 1 2 1; 2 0 2; 3 1 3; 4 2 -2; BCOORD; 2; 0 -1; 1 -3",
        3.0,
    );
}

#[test]
fn rotated_cones_of_expressions() {
    // 2 (x - 1) (x + 1) >= 16: x = 3.
    check(
        "VAR; 1 1; F 1; CON; 3 1; QR 3; OBJACOORD; 1; 0 1; ACOORD; 2; 0 0 1; 1 0 1; BCOORD; 3; 0 -1; 1 1; 2 4",
        3.0,
    );
    // The same variable twice in the head: 2 x x >= 8.
    check(
        "VAR; 1 1; F 1; CON; 3 1; QR 3; OBJACOORD; 1; 0 1; ACOORD; 2; 0 0 1; 1 0 1; BCOORD; 1; 2 2.8284271247461903",
        2.0,
    );
    // In head and tail: 2 x y >= x^2 + 4, y = 2.5: x = 1.
    check(
        "VAR; 2 1; F 2; CON; 5 2; QR 4; L= 1; OBJACOORD; 1; 0 1; \
         ACOORD; 4; 0 0 1; 1 1 1; 2 0 1; 4 1 1; BCOORD; 2; 3 2; 4 -2.5",
        1.0,
    );
    // A head that is at most 0 by its factor: 2 (-x) (-y) >= 2, y = -1.
    check(
        "VAR; 2 1; F 2; CON; 4 2; QR 3; L= 1; OBJACOORD; 1; 0 -1; \
         ACOORD; 3; 0 0 -1; 1 1 -1; 3 1 1; BCOORD; 2; 2 1.4142135623730951; 3 1",
        1.0,
    );
    // The same variable twice in the tail: 2 x >= y^2 + y^2, y = 3.
    check(
        "VAR; 2 1; F 2; CON; 5 2; QR 4; L= 1; OBJACOORD; 1; 0 1; \
         ACOORD; 4; 0 0 1; 2 1 1; 3 1 1; 4 1 1; BCOORD; 2; 1 1; 4 -3",
        9.0,
    );
}

#[test]
fn rotated_cones_with_constant_heads() {
    // 2 * 1/2 * x >= y^2, y = 3; and the other way round.
    check(
        "VAR; 2 1; F 2; CON; 4 2; QR 3; L= 1; OBJACOORD; 1; 0 1; ACOORD; 3; 1 0 1; 2 1 1; 3 1 1; \
         BCOORD; 2; 0 0.5; 3 -3",
        9.0,
    );
    check(
        "VAR; 2 1; F 2; CON; 4 2; QR 3; L= 1; OBJACOORD; 1; 0 1; ACOORD; 3; 0 0 1; 2 1 1; 3 1 1; \
         BCOORD; 2; 1 0.5; 3 -3",
        9.0,
    );
    // Both: 2 * 4.5 * 1 >= y^2.
    check(
        "VAR; 1 1; F 1; CON; 3 1; QR 3; OBJACOORD; 1; 0 1; ACOORD; 1; 2 0 1; BCOORD; 2; 0 4.5; 1 1",
        -3.0,
    );
}

#[test]
fn heads_that_leave_no_room() {
    // 0 >= |(x, y - 1)|.
    check(
        "VAR; 2 1; F 2; CON; 3 1; Q 3; OBJACOORD; 2; 0 1; 1 1; ACOORD; 2; 1 0 1; 2 1 1; BCOORD; 1; 2 -1",
        1.0,
    );
    // 2 * 0 * x >= y^2, x >= 0.
    check("VAR; 2 1; F 2; CON; 3 1; QR 3; OBJACOORD; 2; 0 1; 1 1; ACOORD; 2; 1 0 1; 2 1 1", 0.0);
    check_infeasible("VAR; 1 1; F 1; CON; 2 1; Q 2; ACOORD; 1; 1 0 1; BCOORD; 1; 0 -1");
    check_infeasible("VAR; 2 1; F 2; CON; 3 1; QR 3; ACOORD; 2; 1 0 1; 2 1 1; BCOORD; 1; 0 -1");
    // A head whose upper bound is below 0.
    check_infeasible("VAR; 2 1; Q 2; CON; 1 1; L- 1; ACOORD; 1; 0 0 1; BCOORD; 1; 0 1");
    check_infeasible("VAR; 2 1; QR 2; CON; 1 1; L- 1; ACOORD; 1; 0 1 1; BCOORD; 1; 0 1");
}

#[test]
fn cones_without_a_tail() {
    check("VAR; 1 1; Q 1; OBJACOORD; 1; 0 1", 0.0);
    check("VAR; 2 1; QR 2; OBJACOORD; 2; 0 1; 1 1", 0.0);
    check(
        "VAR; 1 1; F 1; CON; 1 1; Q 1; OBJACOORD; 1; 0 1; ACOORD; 1; 0 0 2; BCOORD; 1; 0 -3",
        1.5,
    );
    check(
        "VAR; 2 1; F 2; CON; 2 1; QR 2; OBJACOORD; 2; 0 1; 1 1; ACOORD; 3; 0 0 1; 0 1 1; 1 0 1; BCOORD; 2; 0 1; 1 -7",
        -1.0,
    );
    // A tail of zeros.
    check("VAR; 1 1; F 1; CON; 3 1; Q 3; OBJACOORD; 1; 0 1; ACOORD; 1; 0 0 1", 0.0);
}

#[test]
fn cones_of_constants() {
    let constants = |cone: &str, values: &str| {
        let list: Vec<String> =
            values.split(' ').enumerate().map(|(k, value)| format!("{k} {value}")).collect();
        let (size, list) = (list.len(), list.join("; "));
        format!(
            "VAR; 1 1; L+ 1; CON; {size} 1; {cone} {size}; OBJACOORD; 1; 0 1; BCOORD; {size}; {list}"
        )
    };
    check(&constants("Q", "5 3 4"), 0.0);
    check(&constants("QR", "4.5 1 3"), 0.0);
    check_infeasible(&constants("Q", "4.9 3 4"));
    check_infeasible(&constants("QR", "4.5 1 3.1"));
    check_infeasible(&constants("QR", "-4.5 -1 3"));
}

#[test]
fn maximisation_with_an_offset() {
    let text = "VER\n1\nOBJSENSE\nMAX\nVAR\n3 2\nL+ 2\nF 1\nCON\n3 1\nQ 3\nOBJACOORD\n2\n0 3\n1 4\n\
                OBJBCOORD\n1\nACOORD\n2\n1 0 1\n2 1 1\nBCOORD\n1\n0 2\n";
    assert!((optimum(text).unwrap() - 11.0).abs() < 1e-5);
}
