//! Presolve before the search: the same optimum, points that are restored, multipliers that are.

mod blocks;
mod cut_sets;
mod cuts;
mod grid;
mod kkt;
mod lineality;
mod logical_programs;
mod programs;
mod rules;

use carom::internals::program::Program;
use carom::internals::relaxation::LadderPool;
use carom::internals::search::{Accept, ColumnGuidance, Found, Task, search};
use carom::model::Model;
use carom::solver::{Control, Guidance, Options, StopToken};

/// Searches a program that no model is told about.
fn search_alone(program: &Program, accept: &Accept<'_>) -> Found {
    let options = Options::default();
    search_by(program, accept, &options, &LadderPool::new(&options))
}

/// The same with options and with methods for the relaxations.
pub(crate) fn search_by(
    program: &Program,
    accept: &Accept<'_>,
    options: &Options,
    ladders: &LadderPool,
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
        ladders,
        options,
        token: &StopToken::default(),
    };
    search(task, &mut Control::default(), None)
}
