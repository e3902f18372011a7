//! The logs of a search, for another program to check: one for each refuted horizon and one for the
//! plan.
//!
//! Behind a search, the program of each horizon is solved as the model states it, without what sets
//! say about it, and that solve writes its proof. So the sets, the argument that waiting is free
//! and the tightened programs of the search need not be trusted.

use std::fs::{self, OpenOptions};
use std::io;
use std::path::Path;

use super::HorizonModel;
use super::event::HorizonEvent;
use super::options::ShortestOptions;
use super::outcome::{HorizonProof, SolvedHorizon};
use super::search::{ANY_GAP, build, settled};
use crate::error::{Error, ErrorKind};
use crate::model::Model;
use crate::solution::{ProofReport, Solution};
use crate::solver::{MipStart, Solver, StopToken};

/// Runs a search whose own solves write no logs, and tells it the folder in which the solver was
/// asked for them, which is made if it is missing.
///
/// # Errors
///
/// [`ErrorKind::Io`] for a folder that cannot be made or written, before the search; those of the
/// search.
pub(super) fn without_logs<T>(
    solver: &mut dyn Solver,
    search: impl FnOnce(&mut dyn Solver, Option<&Path>) -> Result<T, Error>,
) -> Result<T, Error> {
    let asked = solver.options_mut().proof.take();
    // WebAssembly has no files.
    let folder = asked.as_deref().filter(|_| cfg!(not(target_family = "wasm")));
    let found = folder.map_or(Ok(()), make).and_then(|()| search(solver, folder));
    solver.options_mut().proof = asked;
    found
}

fn make(folder: &Path) -> Result<(), Error> {
    let made = fs::create_dir_all(folder).and_then(|()| try_to_write(folder));
    made.map_err(|source| {
        let what = format!("the proofs cannot be written to {}", folder.display());
        let help = "choose a folder that can be made and written";
        Error::with_source(ErrorKind::Io { what, help }, source)
    })
}

/// Makes a file in a folder, and removes it.
fn try_to_write(folder: &Path) -> io::Result<()> {
    let path = folder.join("steps_000000.proof");
    OpenOptions::new().write(true).create(true).truncate(false).open(&path)?;
    fs::remove_file(path)
}

/// Writes the logs of a search. What cannot be written is told in its report, and no log is tried
/// behind it: the answer of the search is there already.
pub(super) struct HorizonLogs<'a> {
    folder: &'a Path,
    options: &'a ShortestOptions,
    solver: &'a mut dyn Solver,
    token: StopToken,
    /// Whether the solver has turned out to write no logs, or one could not be written.
    is_in_vain: bool,
    proofs: Vec<HorizonProof>,
}

impl<'a> HorizonLogs<'a> {
    /// The time limit of the search holds for all logs together, once more.
    pub(super) fn new(
        folder: &'a Path,
        options: &'a ShortestOptions,
        solver: &'a mut dyn Solver,
    ) -> Self {
        let token = StopToken::new(options.time_limit, &options.interrupt);
        HorizonLogs { folder, options, solver, token, is_in_vain: false, proofs: Vec::new() }
    }

    /// Writes the log of every horizon up to one. Returns all that was written, in ascending order.
    pub(super) fn refute<B: HorizonModel + ?Sized>(
        mut self,
        builder: &B,
        refuted: usize,
    ) -> Result<Vec<HorizonProof>, Error> {
        for steps in 1..=refuted {
            if self.is_in_vain || self.token.is_over() {
                let proof = self.nothing(steps);
                self.file(proof);
                continue;
            }
            let program = build(builder, steps, self.options)?;
            self.log(steps, program.as_ref(), &MipStart::new(), Solution::is_infeasible)?;
        }
        self.proofs.sort_by_key(|proof| proof.steps);
        Ok(self.proofs)
    }

    /// Solves the program of the plan once more, as the model states it, and writes its log. The
    /// plan is then the point in the log.
    pub(super) fn repeat<B: HorizonModel + ?Sized>(
        &mut self,
        builder: &B,
        steps: usize,
        plan: &mut SolvedHorizon<B::Program>,
    ) -> Result<(), Error> {
        let mut program = build(builder, steps, self.options)?;
        let (own, searched) = (program.as_ref(), plan.program.as_ref());
        let pairs = own.variables().zip(searched.variables());
        let values = pairs
            .filter(|(own, _)| own.kind().is_integral())
            .filter_map(|(own, from)| Some((own.id(), plan.solution.value(from.id()).ok()?)));
        let start = MipStart::new().with_values(values);
        let gap = self.solver.options().absolute_gap;
        if builder.takes_any_point() {
            self.solver.options_mut().absolute_gap = ANY_GAP;
        }
        let solved = self.log(steps, own, &start, Solution::is_optimal);
        self.solver.options_mut().absolute_gap = gap;
        if let Some(solution) = solved?
            && let Ok(solution) =
                settled(builder, &mut program, solution, self.solver, &self.token)?
        {
            *plan = SolvedHorizon { program, solution };
        }
        Ok(())
    }

    /// Solves the program of a horizon and writes its log. Returns the solution if it is the answer
    /// that the log is for.
    ///
    /// # Errors
    ///
    /// Those of the solver, but for a log that it cannot write.
    fn log(
        &mut self,
        steps: usize,
        model: &Model,
        start: &MipStart,
        is_answer: impl Fn(&Solution) -> bool,
    ) -> Result<Option<Solution>, Error> {
        let mut proof = self.nothing(steps);
        self.solver.options_mut().proof = Some(proof.path.clone());
        let solution = self.token.solve_from(start, self.solver, model);
        self.solver.options_mut().proof = None;
        let solution = match solution {
            Err(error) if matches!(error.kind(), ErrorKind::Io { .. }) => {
                self.is_in_vain = true;
                proof.report = Some(ProofReport::failed(text_of(&error)));
                self.file(proof);
                return Ok(None);
            }
            solution => solution?,
        };
        let is_answer = is_answer(&solution);
        proof.report = solution.proof().cloned().filter(|_| is_answer);
        let has_failed = solution.proof().is_some_and(|report| report.failure.is_some());
        self.is_in_vain |= has_failed || (is_answer && solution.proof().is_none());
        if !is_answer {
            // Nobody has asked for what it claims.
            fs::remove_file(&proof.path).ok();
        }
        self.file(proof);
        Ok(Some(solution).filter(|_| is_answer))
    }

    /// A horizon without a log; one that an earlier search has left does not count.
    fn nothing(&self, steps: usize) -> HorizonProof {
        let path = self.folder.join(format!("steps_{steps:06}.proof"));
        fs::remove_file(&path).ok();
        HorizonProof { steps, path, report: None }
    }

    fn file(&mut self, proof: HorizonProof) {
        let event = HorizonEvent::Logged(proof.clone());
        self.options.tell(&event);
        self.proofs.push(proof);
    }
}

/// An error and the reason behind it.
fn text_of(error: &Error) -> String {
    let source = std::error::Error::source(error);
    source.map_or(error.to_string(), |source| format!("{error}: {source}"))
}
