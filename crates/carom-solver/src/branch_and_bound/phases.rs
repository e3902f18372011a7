//! A solve on one page: its phases, each in the file that is named for it.
//!
//! 1. [`lower`]: statements become rows, and rows a program.
//! 2. [`presolve`]: the program becomes smaller, and may fall into [`blocks`](super::blocks).
//! 3. [`start`](super::start): a MIP start, or the last plan, is completed to a point.
//! 4. [`tighten`](super::tighten): big-Ms become smaller; the root is propagated and probed.
//! 5. [`cut`](super::cut): the relaxation of the root becomes tighter.
//! 6. [`search`](super::search): the tree is searched.
//! 7. [`restore`](super::restore): what was found becomes an answer about the model.
//! 8. [`verify`](super::verify): the model itself checks every point.
//!
//! A [`SolveTask`] passes through the phases from 3 to 6. A solve of a prepared model passes
//! through the same phases, with more [`EarlierResults`] at its start.

use super::blocks::search_blocks;
use super::lower::{LoweredProgram, lower};
use super::presolve::{PresolveOutcome, presolve, rules};
use super::restore::restore;
use super::row_judge::RowJudge;
use super::search::search_task;
use super::solve::{EarlierResults, Solve, SolveResult};
use super::verify::ModelJudge;
use crate::error::Error;
use crate::mutations;
use crate::presolve::root::PresolveRule;
use crate::proof::count_blocks;
use crate::reformulate::is_missing_bound;
use crate::search::{SearchResult, SolveTask};
use crate::solution::Termination;
use crate::solver::{Control, Event, Progress};

impl Solve<'_> {
    /// Solves the model. A solve that a limit ends before the search has no point and no bound.
    pub(super) fn run(
        &self,
        known: &EarlierResults<'_>,
        control: &mut Control<'_>,
    ) -> Result<SolveResult, Error> {
        let own;
        let mut is_stated = true;
        let lowered = match known.lowered {
            Some(lowered) => lowered,
            None => match self.lower()? {
                Some((lowered, has_cutoff)) => {
                    own = lowered;
                    is_stated = !has_cutoff;
                    &own
                }
                None => return Ok(self.stopped()),
            },
        };
        let mut solved = match lowered.loss > 0.0 {
            true => self.run_with_loss(lowered, known, control)?,
            false => self.run_lowered(lowered, known, control)?,
        };
        // Rows that are found while the program is searched belong to the proof of the last round.
        let is_whole = known.lowered.is_none() && self.rows.is_none() && is_stated;
        if let Some(path) = self.options.proof_path().filter(|_| is_whole) {
            solved.proof = self.write_proof(path, lowered, &mut solved, control);
        }
        Ok(solved)
    }

    /// Lowers the model, with a row about a point's cost if bounds are missing that follow from it;
    /// and whether it has that row, which no proof can use.
    fn lower(&self) -> Result<Option<(LoweredProgram, bool)>, Error> {
        let names = self.options.proof_path().is_some();
        match lower(self.model, self.token, names) {
            Err(error) if is_missing_bound(&error) => match self.with_cutoff()? {
                Some(model) => {
                    let lowered = lower(&model, self.token, names).map_err(|_| error)?;
                    Ok(lowered.map(|lowered| (lowered, true)))
                }
                None => Err(error),
            },
            lowered => Ok(lowered?.map(|lowered| (lowered, false))),
        }
    }

    /// Solves the lowered program.
    pub(super) fn run_lowered(
        &self,
        lowered: &LoweredProgram,
        known: &EarlierResults<'_>,
        control: &mut Control<'_>,
    ) -> Result<SolveResult, Error> {
        let rules = rules(self, known);
        let solved = self.run_by_rules(lowered, rules, known, control)?;
        let contradicted = solved.found.contradiction.is_some();
        debug_assert!(
            !contradicted || mutations::has_any(),
            "presolve has changed the objective of {:?}",
            solved.point
        );
        // A search that has found rows is repeated with them.
        let is_over = self.token.is_over() || self.rows.is_some_and(RowJudge::has_new_rows);
        let is_doubtful =
            solved.found.is_widened || solved.found.termination == Termination::Stalled;
        if !contradicted && (rules.is_empty() || !is_doubtful || is_over) {
            return Ok(solved);
        }
        // Callbacks see one search only.
        let mut plain = self.run_by_rules(lowered, &[], known, &mut Control::default())?;
        plain.found.statistics.add(&solved.found.statistics);
        plain.found.statistics.contradictions += u64::from(contradicted);
        let is_undercut = self.undercuts(&plain.found, &solved.found);
        if !contradicted && (is_undercut || !is_conclusion(&plain.found, &solved.found)) {
            let statistics = plain.found.statistics;
            return Ok(SolveResult::without_point(SearchResult { statistics, ..solved.found }));
        }
        Ok(plain)
    }

    /// Solves the lowered program, presolved by some rules.
    fn run_by_rules(
        &self,
        lowered: &LoweredProgram,
        rules: &[PresolveRule],
        known: &EarlierResults<'_>,
        control: &mut Control<'_>,
    ) -> Result<SolveResult, Error> {
        let presolved = match presolve(self, known, lowered, rules)? {
            PresolveOutcome::Presolved(presolved) => presolved,
            PresolveOutcome::Infeasible => {
                return Ok(SolveResult::without_point(SearchResult::infeasible()));
            }
            PresolveOutcome::Stopped => return Ok(self.stopped()),
        };
        let (program, elapsed) = (presolved.program(), self.token.elapsed());
        let progress = Progress::new(0, 0, 0, None, -program.sign * f64::INFINITY, elapsed);
        control.report(&Event::Presolved(program.size(), progress));
        let judge = &ModelJudge::new(self, &presolved);
        let mut task =
            SolveTask::new(presolved.program(), judge, self.cascades, self.options, self.token);
        task.leaf_columns = Some((&lowered.program, &lowered.leaf_columns));
        task.may_settle = rules == PresolveRule::ALL && self.options.proof_path().is_none();
        let start = known.start.map(|start| presolved.carry(start));
        let carried = EarlierResults { start: start.as_ref(), ..*known };
        // A proof follows the blocks of the lowered program.
        let most = match self.options.proof_path() {
            Some(_) => count_blocks(&lowered.program),
            None => usize::MAX,
        };
        let in_blocks = if start.is_none() { search_blocks(task, most, control) } else { None };
        let found = in_blocks.unwrap_or_else(|| search_task(task, &carried, control));
        restore(self, known, &presolved, found)
    }

    /// Whether a search without presolve claims an optimum below the bound that one with it has
    /// proved. Its point then lives on violations within the tolerance, which equations amplify,
    /// and presolve has put these equations into each other.
    fn undercuts(&self, plain: &SearchResult, found: &SearchResult) -> bool {
        let ended = |result: &SearchResult, reason| result.termination == reason;
        let gap = 2.0 * self.options.allowed_gap(found.bound, 0.0);
        ended(found, Termination::Optimal)
            && found.bound.is_finite()
            && (ended(plain, Termination::Unbounded)
                || ended(plain, Termination::Optimal) && plain.bound < found.bound - gap)
    }

    fn stopped(&self) -> SolveResult {
        let reason = self.token.ended().unwrap_or(Termination::Interrupted);
        SolveResult::without_point(SearchResult::stopped(reason))
    }
}

/// Whether a search without presolve says more than one with it, because it has come to an end, or
/// has a point.
fn is_conclusion(plain: &SearchResult, found: &SearchResult) -> bool {
    match plain.termination {
        Termination::Optimal | Termination::Unbounded => true,
        Termination::Infeasible => found.points.is_empty(),
        // Points are checked by the model.
        _ => found.points.is_empty() && !plain.points.is_empty(),
    }
}
