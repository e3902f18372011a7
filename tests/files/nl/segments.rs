//! What each segment means.

use carom::model::nl;
use carom::prelude::*;

use super::{Sizes, optimum, read};

#[test]
fn every_segment_is_where_it_belongs() {
    let text = Sizes { nonlinear: [0, 1, 0], whole: [1, 1, 0, 0, 0], ..Sizes::new(4, 4, 1) }.file(
        "C0; n0; C1; o0; n1; o2; n3; v1; C2; n0; C3; n0; O0 1; o16; o5; v0; n2; d1; 0 7; r; 1 4.5; 0 -1 8; \
         2 -3; 4 2; b; 0 -5 5; 3; 0 0 1; 2 0; k3; 1; 3; 4; J0 2; 0 1; 3 2; J1 1; 2 -1; J2 2; 1 1; 0 0; \
         J3 2; 2 1; 1 1; G0 2; 0 4; 3 1",
    );
    assert_eq!(
        read(&text).to_string(),
        "maximize -x[0]^2 + 4 x[0] + x[3]\n\
         subject to\n  \
         c[0]: x[0] + 2 x[3] <= 4.5\n  \
         c[1]: -2 <= 3 x[1] - x[2] <= 7\n  \
         c[2]: x[1] >= -3\n  \
         c[3]: x[1] + x[2] = 2\n\
         where\n  \
         -5 <= x[0] <= 5\n  \
         x[1] free\n  \
         x[2] binary\n  \
         x[3] >= 0 integer\n"
    );
}

/// In each of three classes of nonlinear columns integers are the last ones, then linear columns,
/// binaries and integers follow.
#[test]
fn integers_are_known_by_their_place() {
    let sizes = Sizes { nonlinear: [5, 7, 2], whole: [1, 2, 1, 2, 1], ..Sizes::new(11, 0, 1) };
    let text = sizes.file(&format!("b{}", "; 0 -4 9".repeat(11)));
    let kinds: Vec<bool> = read(&text).variables().map(|own| own.kind().is_integral()).collect();
    let expected = [0, 1, 0, 1, 1, 0, 1, 0, 1, 1, 1];
    assert_eq!(kinds, expected.map(|whole| whole == 1));
    // Without columns in the objective alone, the second number is that of those in both.
    let sizes = Sizes { nonlinear: [3, 1, 1], whole: [0, 1, 1, 1, 0], ..Sizes::new(5, 0, 1) };
    let text = sizes.file(&format!("b{}", "; 0 -4 9".repeat(5)));
    let kinds: Vec<bool> = read(&text).variables().map(|own| own.kind().is_integral()).collect();
    assert_eq!(kinds, [1, 0, 1, 0, 1].map(|whole| whole == 1));
}

/// Names in comments, a plain objective, a row that limits nothing, infinite limits, and defined
/// variables that end as a linear and a quadratic expression, as Pyomo and AMPL write them.
#[test]
fn what_other_writers_do() {
    let sizes = Sizes { nonlinear: [2, 0, 0], definitions: 2, ..Sizes::new(3, 3, 1) };
    let text = sizes.header("g3 1 1 0\t# problem yard")
        + concat!(
            "S4 2 scaling_factor\n0 0.5\n2 4\n",
            "V3 1 0\t#half\n1 0.5\nn-1\n",
            "V4 0 1\t#ball\no54\t#sumlist\n2\no5\t#^\nv0\t#x\nn2\no5\t#^\nv3\t#half\nn2\n",
            "C0\t#ball\nv4\nC1\t#free\nn0\nC2\t#sum\nn0\n",
            "O0 1\t#cost\nn0\n",
            "x2\t# initial guess\n0 1.5\t#x\n1 2\t#y\n",
            "r\t#3 ranges (rhs's)\n1 4\t#ball\n3\t#free\n0 -1e30 6\t#sum\n",
            "b\t#3 bounds (on variables)\n0 -9 9\t#x\n0 -9 9\t#y\n2 0\t#z\n",
            "k2\t#intermediate Jacobian column lengths\n2\n4\n",
            "J0 2\t#ball\n0 0\n1 0\nJ1 1\t#free\n2 1\nJ2 3\t#sum\n0 1\n1 1\n2 1\n",
            "G0 3\t#cost\n0 1\n1 1\n2 1\n",
        );
    let model = read(&text);
    assert_eq!(model.name(), "yard");
    let names: Vec<String> = model.constraints().map(|row| row.name().to_string()).collect();
    assert_eq!((names, model.conic_constraint_count()), (vec!["c[2]".to_owned()], 1));
    // x² + (y/2 - 1)² <= 4 does not bind where the sum is 6.
    let (best, at) = optimum(&model);
    assert!((best - 6.0).abs() < 1e-5, "{best}");
    assert!(at[0] * at[0] + (0.5 * at[1] - 1.0).powi(2) <= 4.0 + 1e-5, "{at:?}");
    let start = nl::read(&text).unwrap().start;
    let start: Vec<(usize, f64)> = start.iter().map(|(own, value)| (own.index(), *value)).collect();
    assert_eq!(start, [(0, 1.5), (1, 2.0)]);
}

/// An optimum on the rim of a disc: x + y is largest at (1, 1) with x² + y² <= 2.
#[test]
fn a_quadratic_row_is_a_cone() {
    let sizes = Sizes { nonlinear: [2, 0, 0], ..Sizes::new(2, 1, 1) };
    for (row, limits) in
        [("o0; o5; v0; n2; o2; v1; v1", "1 2"), ("o16; o0; o77; v0; o5; v1; n2", "2 -2")]
    {
        let text =
            sizes.file(&format!("C0; {row}; O0 1; n0; r; {limits}; b; 3; 3; G0 2; 0 1; 1 1"));
        let (best, at) = optimum(&read(&text));
        assert!((best - 2.0).abs() < 1e-5 && (at[0] - at[1]).abs() < 1e-2, "{best} {at:?}");
    }
}

#[test]
fn suffixes_are_ordered_sets() {
    let sets = "S0 3 sosno; 0 1; 1 1; 2 1; S4 3 ref; 0 1; 1 2; 2 3; O0 1; n0; b; 0 0 1; 0 0 1; 0 0 1; \
                G0 3; 0 3; 1 2; 2 2";
    let best = |text: &str| optimum(&read(&Sizes::new(3, 0, 1).file(text))).0;
    assert!((best(sets) - 3.0).abs() < 1e-6);
    // Of the second kind, two neighbours may be other than 0; the weights order them.
    let second = sets.replace("; 0 1; 1 1; 2 1;", "; 0 -4; 1 -4; 2 -4;");
    assert!((best(&second) - 5.0).abs() < 1e-6);
    let apart = second.replace("0 1; 1 2; 2 3", "0 1; 1 3; 2 2").replace("1 2; 2 2", "1 2; 2 1.5");
    assert!((best(&apart) - 4.5).abs() < 1e-6);
    assert!((best(&sets.replace("sosno", "priority")) - 7.0).abs() < 1e-6);
}

#[test]
fn the_first_of_several_objectives_counts() {
    let text = Sizes::new(1, 0, 2).file("O0 0; n0; O1 1; n5; b; 0 2 3; G0 1; 0 1; G1 1; 0 2");
    let read = nl::read(text).unwrap();
    assert_eq!(optimum(&read.model).0, 2.0);
    let said: Vec<String> = read.warnings.iter().map(ToString::to_string).collect();
    assert_eq!(said, ["line 1, column 1: there are 2 objectives; the first one counts"]);
    let none = Sizes::new(1, 0, 0).file("b; 0 2 3");
    assert_eq!(optimum(&super::read(&none)).0, 0.0);
}

#[test]
fn rows_without_variables_hold_or_not() {
    let solve = |limit: &str| {
        let text = Sizes::new(1, 1, 1).file(&format!("C0; n2; r; 1 {limit}; b; 0 0 1; G0 1; 0 1"));
        BranchAndBound::default().solve(&read(&text)).unwrap().termination()
    };
    assert_eq!((solve("2"), solve("1")), (Termination::Optimal, Termination::Infeasible));
}
