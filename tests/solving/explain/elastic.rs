//! What would have to give, and by how much.

use carom::ErrorKind;
use carom::explain::{ElasticOptions, elastic_relaxation};
use carom::model::Term;
use carom::prelude::*;
use carom::reformulate::Side;

fn close(a: f64, b: f64) -> bool {
    (a - b).abs() < 1e-5
}

/// One statement asks for more than four others allow.
fn contest() -> (Model, Vec<Variable>) {
    let mut model = Model::new("contest");
    let x = model.continuous_family("x", 2, 0.0, 10.0).unwrap();
    model.add(("cap", 0), x[0].le(2.0)).unwrap();
    model.add(("cap", 1), x[1].le(3.0)).unwrap();
    model.add("total", (x[0] + x[1]).ge(9.0)).unwrap();
    (model, x.iter().collect())
}

#[test]
fn weights_decide_who_gives() {
    let mut solver = BranchAndBound::default();
    let (model, _) = contest();
    let names = |options: ElasticOptions, solver: &mut BranchAndBound| {
        let relaxed = elastic_relaxation(&model, &options, solver).unwrap();
        assert!(relaxed.is_optimal());
        let stretches = relaxed.stretches().iter();
        let found = stretches.map(|s| (s.name.to_string(), s.side, s.amount)).collect::<Vec<_>>();
        (found, relaxed.cost().unwrap())
    };
    let options = ElasticOptions::default().with_weight("cap", 3.0).with_weight("total", 2.0);
    let (found, cost) = names(options, &mut solver);
    assert!(found.len() == 1 && found[0].0 == "total" && found[0].1 == Some(Side::Lower));
    assert!(close(found[0].2, 4.0) && close(cost, 8.0));

    // The member's own weight after the family's.
    let options = ElasticOptions::default().with_weight("cap", 0.5).with_weight(("cap", 0), 0.25);
    let (found, cost) = names(options, &mut solver);
    assert!(found.len() == 1 && found[0].0 == "cap[0]" && found[0].1 == Some(Side::Upper));
    assert!(close(found[0].2, 4.0) && close(cost, 1.0));

    // With an infinite weight, and in the background, nothing gives.
    let options = ElasticOptions::default().with_weight("total", f64::INFINITY);
    let options = options.with_background([("cap", 0)]).with_weight(("cap", 1), 7.0);
    let (found, cost) = names(options, &mut solver);
    assert!(found.len() == 1 && found[0].0 == "cap[1]");
    assert!(close(found[0].2, 4.0) && close(cost, 28.0));
}

#[test]
fn stretched_by_the_amounts_the_model_has_a_solution() {
    let (mut model, x) = contest();
    let z = model.binary("z").unwrap();
    model.add("on", z.on()).unwrap();
    model.add("both", z.on().implies((x[0] - x[1]).equals(5.0))).unwrap();
    let mut solver = BranchAndBound::default();
    assert!(solver.solve(&model).unwrap().is_infeasible());
    let options = ElasticOptions::default().with_weight("on", 100.0);
    let relaxed = elastic_relaxation(&model, &options, &mut solver).unwrap();
    assert!(relaxed.is_optimal());
    // Five apart and nine together: 7 and 2, five more than the cap of the first.
    assert!(close(relaxed.cost().unwrap(), 5.0), "{relaxed}");

    let stretch = |model: &mut Model, name: &Name, side: Option<Side>, amount: f64| {
        if let Ok(row) = model.constraint_by_name(name.clone()) {
            let limits = model.constraints().find(|r| r.id() == row).unwrap().limits();
            let (low, high) = moved(limits.lower, limits.upper, side, amount);
            model.set_limits(row, low, high).unwrap();
        } else {
            let indicator = model.indicator_by_name(name.clone()).unwrap();
            let limits = model.indicators().find(|i| i.id() == indicator).unwrap().limits();
            let (low, high) = moved(limits.lower, limits.upper, side, amount);
            model.set_indicator_limits(indicator, low, high).unwrap();
        }
    };
    for s in relaxed.stretches() {
        stretch(&mut model, &s.name, s.side, s.amount);
    }
    let solution = solver.solve(&model).unwrap();
    assert!(solution.point().is_some());
    assert!(relaxed.point().unwrap().value(z).unwrap() == 1.0);
}

fn moved(low: f64, high: f64, side: Option<Side>, amount: f64) -> (f64, f64) {
    match side {
        Some(Side::Lower) => (low - amount, high),
        _ => (low, high + amount),
    }
}

#[test]
fn indicators_and_logic_give_as_well() {
    let mut model = Model::new("m");
    let x = model.continuous("x", 0.0, 10.0).unwrap();
    let z = model.binary_family("z", 2).unwrap();
    model.add("low", z[0].on().implies(x.within(1.0, 2.0))).unwrap();
    model.add("high", z[1].on().implies(x.ge(7.0))).unwrap();
    model.add("both", z[0] & z[1]).unwrap();
    let mut solver = BranchAndBound::default();
    // Dropping the logic costs 1, moving the rows 5.
    let relaxed = elastic_relaxation(&model, &ElasticOptions::default(), &mut solver).unwrap();
    assert_eq!(relaxed.to_string(), "drop `both`");
    assert!(close(relaxed.cost().unwrap(), 1.0) && close(relaxed.bound(), 1.0));

    let options = ElasticOptions::default().with_background(["both", "high"]);
    let relaxed = elastic_relaxation(&model, &options, &mut solver).unwrap();
    let [stretch] = relaxed.stretches() else { panic!("{relaxed}") };
    assert!(stretch.name == Name::from("low") && stretch.side == Some(Side::Upper));
    assert!(close(stretch.amount, 5.0));
}

#[test]
fn answers_without_stretches() {
    let mut model = Model::new("m");
    let x = model.continuous("x", 0.0, 10.0).unwrap();
    model.add("row", x.ge(3.0)).unwrap();
    let mut solver = BranchAndBound::default();
    let relaxed = elastic_relaxation(&model, &ElasticOptions::default(), &mut solver).unwrap();
    assert!(relaxed.is_optimal() && relaxed.stretches().is_empty());
    assert_eq!(relaxed.to_string(), "nothing has to give");

    model.add("law", x.ge(11.0)).unwrap();
    model.set_background("law").unwrap();
    let relaxed = elastic_relaxation(&model, &ElasticOptions::default(), &mut solver).unwrap();
    assert_eq!(relaxed.termination(), Termination::Infeasible);
    assert!(relaxed.point().is_none() && relaxed.cost().is_none());
    assert_eq!(relaxed.to_string(), "nothing helps: what may not give contradicts itself");
}

#[test]
fn bad_input_is_refused() {
    let (model, _) = contest();
    let mut solver = BranchAndBound::default();
    for weight in [0.0, -1.0, f64::NAN, f64::NEG_INFINITY] {
        let options = ElasticOptions::default().with_weight("cap", weight);
        let error = elastic_relaxation(&model, &options, &mut solver).unwrap_err();
        assert!(matches!(error.kind(), ErrorKind::OutOfRange { .. }), "{error}");
    }
    let options = ElasticOptions::default().with_weight("caps", 1.0);
    assert!(matches!(
        elastic_relaxation(&model, &options, &mut solver).unwrap_err().kind(),
        ErrorKind::UnknownName { .. }
    ));

    let mut model = Model::new("m");
    let x = model.continuous("x", 0.0, f64::INFINITY).unwrap();
    let z = model.binary("z").unwrap();
    model.add("slow", z.on().implies(x.le(1.0))).unwrap();
    let error = elastic_relaxation(&model, &ElasticOptions::default(), &mut solver).unwrap_err();
    assert!(matches!(error.kind(), ErrorKind::UnboundedIndicator { .. }), "{error}");
}

/// A disjunction is dropped at its weight; its selectors, which stand in logic as well, are free
/// then, those inside its terms too.
#[test]
fn a_disjunction_gives_as_a_whole() {
    let mut model = Model::new("gates");
    let x = model.continuous("x", 0.0, 10.0).unwrap();
    let ways =
        either(x.le(2.0)).or(Term::from(x.ge(7.0)).and_either(either(x.le(8.0)).or(x.ge(9.0))));
    let way = model.add("way", ways).unwrap();
    // Names that the elastic form would like to use.
    model.add("way_selects", way.selectors[1]).unwrap();
    model.add("way_taken", x.within(3.0, 6.5)).unwrap();
    let mut solver = BranchAndBound::default();
    assert!(solver.solve(&model).unwrap().is_infeasible());
    let options = ElasticOptions::default().with_weight("way", 0.25);
    let relaxed = elastic_relaxation(&model, &options, &mut solver).unwrap();
    assert!(close(relaxed.cost().unwrap(), 0.25), "{relaxed}");
    assert_eq!(relaxed.stretches()[0].name.to_string(), "way");
    // It stays where the others are cheaper.
    let options = ElasticOptions::default().with_weight("way", 50.0);
    let relaxed = elastic_relaxation(&model, &options, &mut solver).unwrap();
    let names: Vec<_> = relaxed.stretches().iter().map(|s| s.name.to_string()).collect();
    assert_eq!(names, ["way_taken"]);
}
