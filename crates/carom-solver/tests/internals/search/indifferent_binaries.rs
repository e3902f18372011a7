//! Integral values where the relaxed point leaves a choice.

use carom::model::Model;
use carom_solver::internals::presolve::Domain;
use carom_solver::internals::program::Program;
use carom_solver::internals::search::indifferent_binaries::{
    groups, round_groups, shift_to_integers, ungrouped_binaries,
};

/// Two modes, left of 4 and right of 3; both rows leave the binaries room between.
#[test]
fn what_is_violated_stays_fractional_and_goes_as_far_as_it_can() {
    let mut model = Model::new("modes");
    let x = model.continuous("x", 0.0, 10.0).unwrap();
    let (left, right) = (model.binary("left").unwrap(), model.binary("right").unwrap());
    model.add("l", (x + 8.0 * left).le(10.0)).unwrap();
    model.add("r", (x - 7.0 * right).ge(0.0)).unwrap();
    model.add("one", (left + right).equals(1.0)).unwrap();
    let program = Program::assemble(&model).unwrap();
    let (domain, groups) = (Domain::new(&program), groups(&program));
    let settled = |x: f64| {
        let mut point = vec![x, 0.5, 0.5];
        round_groups(&program, &domain, &groups, 1e-6, &mut point);
        point
    };
    assert_eq!(settled(1.0), [1.0, 1.0, 0.0]);
    assert_eq!(settled(8.0), [8.0, 0.0, 1.0]);
    // Left at most 5/8, right at most 5/7.
    let between = settled(5.0);
    assert!((between[1] - 2.0 / 7.0).abs() < 1e-12 && (between[2] - 5.0 / 7.0).abs() < 1e-12);
}

/// At least one eighth by the row below, at most a half by the row above: nearer to 0.
#[test]
fn binaries_alone_go_to_the_nearer_end() {
    let mut model = Model::new("alone");
    let x = model.continuous("x", 0.0, 10.0).unwrap();
    let on = model.binary("on").unwrap();
    model.add("below", (x - 8.0 * on).le(0.0)).unwrap();
    model.add("above", (x + 8.0 * on).le(5.0)).unwrap();
    let program = Program::assemble(&model).unwrap();
    let (domain, groups) = (Domain::new(&program), groups(&program));
    let alone = ungrouped_binaries(&program, &groups);
    assert_eq!((groups, alone.clone()), (Vec::new(), vec![1]));
    let mut point = vec![1.0, 0.3];
    shift_to_integers(&program, &domain, &alone, 1e-6, &mut point);
    assert_eq!(point, [1.0, 0.125]);
}
