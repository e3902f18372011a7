//! The model with only some of its statements.

use carom::model::{Model, at_most, sos1};
use carom_model::internals::model::{statements, subset};

#[test]
fn a_subset_keeps_variables_and_what_is_asked_for() {
    let mut model = Model::new("m");
    let x = model.continuous("x", 0.0, 4.0).unwrap();
    let z = model.binary_family("z", 2).unwrap();
    model.add("low", x.ge(1.0)).unwrap();
    model.add("high", x.le(3.0)).unwrap();
    model.add("if", z[0].on().implies(x.le(2.0))).unwrap();
    model.add("one", at_most(1, &z)).unwrap();
    model.add("set", sos1([(x, 1.0), (z[0], 2.0)])).unwrap();
    model.add("other", sos1([(x, 1.0), (z[1], 2.0)])).unwrap();
    model.maximize(x).unwrap();
    let names: Vec<_> = statements(&model).map(|s| s.name().to_string()).collect();
    assert_eq!(names, ["low", "high", "if", "one", "set", "other"]);

    let part = subset(&model, |k| [1, 3, 5].contains(&k));
    let wanted = [
        "minimize 0",
        "subject to",
        "  high: x <= 3",
        "  one: at_most(1, z[0], z[1])",
        "  other: sos1(x: 1, z[1]: 2)",
        "where",
        "  0 <= x <= 4",
        "  z[0] binary",
        "  z[1] binary",
    ];
    assert_eq!(part.to_string().lines().collect::<Vec<_>>(), wanted);
    assert!(part.constraint_by_name("high").is_ok() && part.constraint_by_name("low").is_err());
    assert!(part.variable_ref(x).is_ok());
}
