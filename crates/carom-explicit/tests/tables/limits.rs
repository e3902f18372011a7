//! Refusals of tables, and limits that leave some states open.

use std::time::Duration;

use carom::ErrorKind;
use carom::explicit::{ExplicitProgram, LookupAnswer};
use carom::prelude::*;

/// Move x to 0 by a step of 1, up or down, or rest; and its names.
pub(crate) fn steps() -> (Model, Variable, Variable) {
    let mut model = Model::new("steps");
    let x = model.parameter("x", 0.0, -3.0, 3.0).unwrap();
    let u = model.continuous("u", -1.0, 1.0).unwrap();
    let [up, down] = ["up", "down"].map(|name| model.binary(name).unwrap());
    model.add("step", u.equals(1.0 * up - 1.0 * down)).unwrap();
    let rest = model.continuous("rest", -4.0, 4.0).unwrap();
    model.add("move", rest.equals(x + u)).unwrap();
    model.minimize(rest.square() + 0.1 * (up + down)).unwrap();
    (model, x, u)
}

fn message(error: &Error) -> String {
    format!("{error}")
}

#[test]
fn axes_are_parameters_with_a_range() {
    let (mut model, x, u) = steps();
    let error = ExplicitProgram::new(&model, [u], [u]).unwrap_err();
    assert!(matches!(error.kind(), ErrorKind::NotParameter { .. }), "{error}");
    let error = ExplicitProgram::new(&model, [], [u]).unwrap_err();
    assert!(matches!(error.kind(), ErrorKind::OutOfRange { .. }), "{error}");
    let error = ExplicitProgram::new(&model, [x, x], [u]).unwrap_err();
    assert!(message(&error).contains("`x` twice"), "{error}");
    let error = ExplicitProgram::new(&model, [x], [x]).unwrap_err();
    assert!(message(&error).contains("the axis `x` in an output"), "{error}");
    let none: [Variable; 0] = [];
    let error = ExplicitProgram::new(&model, [x], none).unwrap_err();
    assert!(message(&error).contains("outputs"), "{error}");
    model.set_parameter_range(x, 0.0, 0.0).unwrap();
    let error = ExplicitProgram::new(&model, [x], [u]).unwrap_err();
    assert!(message(&error).contains("one value"), "{error}");
}

#[test]
fn sets_are_bounded() {
    let mut model = Model::new("open");
    let error = model.parameter("x", 0.0, 0.0, f64::INFINITY).unwrap_err();
    assert!(matches!(error.kind(), ErrorKind::NotFinite { .. }), "{error}");
    let mut cart = HybridSystem::new(1.0);
    let x = cart.state("x", -4.0, 4.0).unwrap();
    cart.mode("roll").unwrap().next([(x, 0.5 * x)]).unwrap();
    let mut program = cart.program(1).unwrap();
    let error = program.open_start([(x, 0.0..=f64::INFINITY)]).unwrap_err();
    assert!(matches!(error.kind(), ErrorKind::NotFinite { .. }), "{error}");
    // Nothing is left of it.
    assert_eq!(program.open_start([(x, 0.0..=1.0)]).unwrap().len(), 1);
    assert!(program.open_start([(x, 0.0..=1.0)]).is_err());
}

#[test]
fn parameters_are_no_coefficients() {
    let mut model = Model::new("matrix");
    let gain = model.parameter("gain", 1.0, 0.5, 2.0).unwrap();
    let u = model.continuous("u", -1.0, 1.0).unwrap();
    // As rows this does not compile; a cost needs a binary.
    let error = model.minimize(gain * u).unwrap_err();
    assert!(matches!(error.kind(), ErrorKind::NotConvex { .. }), "{error}");
}

#[test]
fn variables_have_bounds() {
    let mut model = Model::new("free");
    let x = model.parameter("x", 0.0, -1.0, 1.0).unwrap();
    let u = model.continuous("u", f64::NEG_INFINITY, f64::INFINITY).unwrap();
    model.add("above", u.ge(x)).unwrap();
    model.minimize(1.0 * u).unwrap();
    let error = ExplicitProgram::new(&model, [x], [u]).unwrap_err();
    assert!(message(&error).contains("`u`, which has no bound on a side"), "{error}");
    // Bounds that rows imply are enough.
    model.add("below", (u + x).le(3.0)).unwrap();
    let table = ExplicitProgram::new(&model, [x], [u]).unwrap().build();
    let (answer, inputs) = table.evaluate(&[0.25]);
    assert!(answer.has_inputs() && (inputs[0] - 0.25).abs() < 1e-2);
}

#[test]
fn losses_and_edges_are_checked() {
    let (model, x, u) = steps();
    let new = || ExplicitProgram::new(&model, [x], [u]).unwrap();
    for (absolute, relative) in [(0.0, 0.0), (-1.0, 0.1), (0.1, f64::NAN), (f64::INFINITY, 0.0)] {
        let error = new().with_loss(absolute, relative).unwrap_err();
        assert!(matches!(error.kind(), ErrorKind::OutOfRange { .. }), "{error}");
    }
    for share in [0.0, 2.0, f64::NAN] {
        assert!(new().with_finest(share).is_err());
    }
}

#[test]
fn a_limit_leaves_the_rest_open() {
    let (model, x, u) = steps();
    let new = || ExplicitProgram::new(&model, [x], [u]).unwrap();
    let whole = new().build();
    assert!(whole.report().proved > 0.9, "{:?}", whole.report());
    let interrupt = Interrupt::new();
    let watch = |progress: &carom::explicit::TableProgress| {
        if progress.cells >= 3 {
            interrupt.trigger();
        }
    };
    let part = new().with_threads(1).with_interrupt(&interrupt).with_progress(watch).build();
    let report = part.report();
    assert!(report.open > 0.0 && report.cells < whole.report().cells, "{report:?}");
    let late = new().with_time_limit(Duration::ZERO).build();
    assert_eq!(late.evaluate(&[0.0]).0, LookupAnswer::Open);
    assert_eq!(late.report().open, 1.0);
    // With few cells there are laws, whose losses are larger.
    let few = new().with_loss(1e-6, 0.0).unwrap().with_cell_limit(4).build();
    assert!(few.report().cells <= 4 && few.report().unproved > 0.0, "{:?}", few.report());
    let (answer, _) = few.evaluate(&[0.3]);
    assert!(matches!(answer, LookupAnswer::Plan { loss } if loss > 1e-6), "{answer:?}");
    // What is said of cells is what a look-up says.
    for cell in whole.cells() {
        let middle = 0.5 * (cell.corners[0][0] + cell.corners[1][0]);
        assert_eq!(whole.evaluate(&[middle]).0, cell.answer);
    }
}

#[test]
fn maximisation_is_minimisation_of_the_negative() {
    let (mut model, x, u) = steps();
    let table = |model: &Model| ExplicitProgram::new(model, [x], [u]).unwrap().build();
    let least = table(&model);
    let rest = model.variables().find(|v| v.name().to_string() == "rest").unwrap().id();
    let used: Vec<Variable> = ["up", "down"]
        .iter()
        .map(|name| model.variables().find(|v| v.name().to_string() == *name).unwrap().id())
        .collect();
    model.maximize(-1.0 * rest.square() - 0.1 * (used[0] + used[1])).unwrap();
    let most = table(&model);
    assert_eq!(least.report().cells, most.report().cells);
    for state in [-2.3, -0.2, 0.7, 1.9] {
        assert_eq!(least.evaluate(&[state]), most.evaluate(&[state]));
    }
}
