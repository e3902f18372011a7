//! Presolve before the search: the same optimum, points that are restored, multipliers that are.

mod blocks;
mod conditional_cones;
mod cones;
mod cut_sets;
mod cuts;
mod facets;
mod grid;
mod kkt;
mod lineality;
mod logical_programs;
mod other_words;
mod polymatroid;
mod programs;
mod rules;
mod switched_cones;

use carom::solver::{Control, Options, StopToken};
use carom_solver::internals::program::Program;
use carom_solver::internals::relaxation::CascadePool;
use carom_solver::internals::search::{PointJudge, SearchResult, SolveTask, search};

/// Searches a program that no model is told about.
fn search_alone(program: &Program, accept: &dyn PointJudge) -> SearchResult {
    let options = Options::default();
    search_by(program, accept, &options, &CascadePool::new(&options))
}

/// The same with options and with methods for the relaxations.
pub(crate) fn search_by(
    program: &Program,
    accept: &dyn PointJudge,
    options: &Options,
    cascades: &CascadePool,
) -> SearchResult {
    let token = &StopToken::default();
    let task = SolveTask::new(program, accept, cascades, options, token);
    search(task, &mut Control::default(), None)
}
