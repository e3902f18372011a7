//! What a point violates.

use carom::ErrorKind;
use carom::explain::violations;
use carom::prelude::*;
use carom::solution::ViolationKind::{Bound, Function, Implication, Integrality, Logic, Row};

#[test]
fn every_kind_is_found_and_the_worst_comes_first() {
    let mut model = Model::new("m");
    let x = model.continuous("x", 0.0, 10.0).unwrap();
    let n = model.integer("n", 0.0, 5.0).unwrap();
    let z = model.binary_family("z", 2).unwrap();
    let size = model.absolute("size", x - 5.0).unwrap();
    model.add(("limit", 3), (2.0 * x).le(16.0)).unwrap();
    model.add("slow", z[0].on().implies(x.ge(11.5))).unwrap();
    model.add("idle", z[0].off().implies(x.le(0.0))).unwrap();
    model.add("both", z[0] & z[1]).unwrap();
    model.add("fine", (x + n).ge(0.0)).unwrap();

    // x, n, z[0], z[1], size
    let found = violations(&model, &[11.0, 2.25, 1.0, 0.0, 6.5], 1e-6).unwrap();
    let found: Vec<_> = found.iter().map(|v| (v.kind, v.name.as_str(), v.amount)).collect();
    assert_eq!(
        found,
        [
            (Logic, "both", 1.0),
            (Row, "limit[3]", 6.0),     // over 22
            (Integrality, "n", 0.25),   // over 1
            (Bound, "x", 1.0),          // over 11
            (Function, "size", 0.5),    // over 11
            (Implication, "slow", 0.5), // over 11.5
        ]
    );
    assert_eq!(violations(&model, &[8.0, 2.0, 0.0, 1.0, 3.0], 1e-6).unwrap().len(), 2);

    // A looser tolerance forgives.
    let forgiven = violations(&model, &[8.0001, 2.0, 1.0, 1.0, 3.0001], 1e-3).unwrap();
    let forgiven: Vec<String> = forgiven.iter().map(|v| v.to_string()).collect();
    assert_eq!(forgiven, ["the implication `slow` by 3.4999"]);
    let _ = (size, n);
}

#[test]
fn a_point_that_is_none_is_refused() {
    let mut model = Model::new("m");
    model.continuous_family("x", 2, 0.0, 1.0).unwrap();
    assert_eq!(
        violations(&model, &[0.5], 1e-6).unwrap_err().to_string(),
        "the length of the point is 1; it must be 2"
    );
    assert_eq!(
        violations(&model, &[0.5, f64::NAN], 1e-6).unwrap_err().to_string(),
        "the value of `x[1]` is NaN; give a finite number"
    );
    assert!(matches!(
        violations(&model, &[0.5, f64::INFINITY], 1e-6).unwrap_err().kind(),
        ErrorKind::NotFinite { .. }
    ));
    for tolerance in [-1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(
            violations(&model, &[0.5, 0.5], tolerance).unwrap_err().kind(),
            ErrorKind::OutOfRange { .. }
        ));
    }
    assert_eq!(violations(&model, &[0.5, 1.0], 0.0), Ok(Vec::new()));
}
