//! Presolve before the search: the same optimum, points that are restored, multipliers that are.

mod conflicts;
mod cuts;
mod grid;
mod kkt;
mod programs;
mod rules;

use carom::internals::program::Program;
use carom::internals::search::{Accept, ColumnGuidance, Found, Task, search};
use carom::model::Model;
use carom::solver::{Control, Guidance, Options, StopToken};

/// Searches a program that no model is told about.
fn search_alone(program: &Program, accept: &Accept<'_>) -> Found {
    let (options, model) = (Options::default(), Model::new("none"));
    let guidance = ColumnGuidance::new(&model, &Guidance::default()).expect("no guidance is none");
    let task = Task {
        cutoff: f64::INFINITY,
        program,
        exact: None,
        accept,
        guidance: &guidance,
        key: &|x| x.iter().map(|v| v.round() as i64).collect(),
        describe: &|_| None,
        options: &options,
        token: &StopToken::default(),
    };
    search(task, &mut Control::default(), None)
}
