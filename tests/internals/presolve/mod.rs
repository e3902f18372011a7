//! Presolve before the search: the same optimum, points that are restored, multipliers that are.

mod blocks;
mod cuts;
mod grid;
mod kkt;
mod lineality;
mod logical_programs;
mod programs;
mod rules;

use carom::internals::program::Program;
use carom::internals::relaxation::Ladder;
use carom::internals::search::{Accept, ColumnGuidance, Found, Task, search};
use carom::model::Model;
use carom::solver::{Control, Guidance, Options, RelaxationMethod, StopToken};

/// Searches a program that no model is told about.
fn search_alone(program: &Program, accept: &Accept<'_>) -> Found {
    search_by(program, accept, &Options::default(), &|| Ladder::new(RelaxationMethod::default()))
}

/// The same with options and with methods for the relaxations.
pub(crate) fn search_by(
    program: &Program,
    accept: &Accept<'_>,
    options: &Options,
    ladder: &(dyn Fn() -> Ladder + Sync),
) -> Found {
    let model = Model::new("none");
    let guidance = ColumnGuidance::new(&model, &Guidance::default()).expect("no guidance is none");
    let task = Task {
        cutoff: f64::INFINITY,
        program,
        exact: None,
        root: None,
        accept,
        guidance: &guidance,
        key: &|x| x.iter().map(|v| v.round() as i64).collect(),
        describe: &|_| None,
        ladder,
        options,
        token: &StopToken::default(),
    };
    search(task, &mut Control::default(), None)
}
