//! What the verification of a point forgives.

use carom::prelude::*;
use carom::solution::{Point, Verification};
use carom::tolerance::FEASIBILITY;

#[test]
fn only_rounding_grows_with_the_terms() {
    // The terms and the limit of the row add up to `magnitude`.
    let holds = |magnitude: f64, miss: f64| {
        let mut model = Model::new("m");
        let x = model.continuous("x", 0.0, 1e12).unwrap();
        model.add("most", x.le(0.5 * magnitude)).unwrap();
        let point = Point::new(&model, vec![0.5 * magnitude + miss]).unwrap();
        Verification::of(&model, &point, FEASIBILITY).holds()
    };
    assert!(holds(1e6, 0.999 * FEASIBILITY) && !holds(1e6, 1.001 * FEASIBILITY));
    assert!(holds(1e11, 5e-5) && !holds(1e11, 1e-4));
}
