//! Programs that were tightened wrongly: an accepted point contradicts them, no bound is claimed,
//! and the search without them is right.

use carom::prelude::*;
use carom::solution::Heuristic;
use carom::solver::{Control, StopToken};
use carom_solver::internals::program::Program;
use carom_solver::internals::relaxation::CascadePool;
use carom_solver::internals::search::{
    Contradiction, SolveTask, Start, StartPoint, search, search_unstrengthened,
};

/// `min x^2 - 3 a - 2.5 b` over `x >= a + b`: -2 with `a` alone.
fn program() -> Program {
    let mut model = Model::new("program");
    let [a, b] = ["a", "b"].map(|name| model.binary(name).unwrap());
    let x = model.continuous("x", 0.0, 4.0).unwrap();
    model.add("covers", (x - a - b).ge(0.0)).unwrap();
    model.minimize(x.square() - 3.0 * a - 2.5 * b).unwrap();
    Program::assemble(&model).unwrap()
}

/// Searches a program in place of the right one, from a point if there is one: what it contradicts,
/// and the answer without it.
fn contradiction(wrong: &Program, start: Option<Vec<f64>>) -> Option<Contradiction> {
    let (exact, options, token) = (&program(), &Options::default(), &StopToken::default());
    let cascades = &CascadePool::new(options);
    let accept = |_: &[f64]| true;
    let task = SolveTask {
        exact: Some(exact),
        ..SolveTask::new(wrong, &accept, cascades, options, token)
    };
    let point =
        start.map(|values| StartPoint { values, found_by: Heuristic::Start, is_reported: false });
    let start = Start::from_point(point);
    let found = search(task, &mut Control::default(), Some(&start));
    let what = found.contradiction?;
    assert_eq!((found.termination, found.bound), (Termination::Stalled, f64::NEG_INFINITY));
    let again = search_unstrengthened(task, found, &mut Control::default());
    assert_eq!(again.termination, Termination::Optimal);
    assert!((again.bound + 2.0).abs() < 1e-5 && again.statistics.contradictions == 1);
    Some(what)
}

#[test]
fn a_dearer_objective_is_dropped() {
    let mut wrong = program();
    wrong.offset += 0.5;
    assert_eq!(contradiction(&wrong, None), Some(Contradiction::Objective));
}

#[test]
fn a_row_that_excludes_a_point_is_dropped() {
    let mut wrong = program();
    wrong.row_lower[0] = 0.5;
    let point = vec![1.0, 0.0, 1.0];
    assert_eq!(contradiction(&wrong, Some(point)), Some(Contradiction::Row(0)));
}

#[test]
fn bounds_that_exclude_a_point_are_dropped() {
    let mut wrong = program();
    wrong.upper[0] = 0.0;
    let point = vec![1.0, 0.0, 1.0];
    assert_eq!(contradiction(&wrong, Some(point)), Some(Contradiction::Column(0)));
}

#[test]
fn the_program_itself_contradicts_nothing() {
    assert_eq!(contradiction(&program(), None), None);
}
