//! The search without logs: reach sets first; then short looks, so that a plan is at hand early;
//! then galloping and bisection if waiting is free, otherwise an ascent.

use super::HorizonModel;
use super::event::HorizonEvent;
use super::guess::{Guess, restricted};
use super::look::look_token;
use super::options::ShortestOptions;
use super::outcome::{
    HorizonAttempt, HorizonVerdict, ShortestHorizon, ShortestStatus, SolvedHorizon,
};
use crate::error::{Error, ErrorKind, RunError};
use crate::hybrid::horizon::check_steps;
use crate::hybrid::program::as_drift;
use crate::hybrid::reach::{HorizonVariables, ReachSets, Tube};
use crate::model::Model;
use crate::solution::{Solution, Termination};
use crate::solver::{Event, Solver, StopToken};

/// Undecided horizons after which a search gives up, because others would probably stop for the
/// same reason.
const MAX_UNDECIDED: usize = 8;

/// Number of open binaries beyond which a coarser grid is tried. With fewer, a solve is quick.
const MANY_OPEN: usize = 16;

/// A gap that any point closes, where only the first point is wanted.
pub(super) const ANY_GAP: f64 = 1e9;

/// Finds the smallest feasible horizon and refutes the smaller ones.
pub(super) fn find<B: HorizonModel + ?Sized>(
    builder: &B,
    options: &ShortestOptions,
    solver: &mut dyn Solver,
) -> Result<ShortestHorizon<SolvedHorizon<B::Program>>, Error> {
    check_steps("the largest number of steps", options.max_steps)?;
    let monotonicity = options.monotonicity(builder.monotonicity());
    let mut search = Search {
        is_free: monotonicity.is_monotone(),
        builder,
        options,
        solver,
        token: StopToken::new(options.time_limit, &options.interrupt),
        refuted: 0,
        best: None,
        undecided: Vec::new(),
        attempts: Vec::new(),
        drifts: Vec::new(),
        ascended: 0,
        ascent: 0,
        sets: None,
        guess: Guess::NotAsked,
    };
    if options.reach_sets {
        search.sets = builder.reach_sets()?;
    }
    let status = search.run()?;
    let (time, is_time_up) = (search.token.elapsed(), search.token.is_over());
    let starts_in_goal = match builder.ends()? {
        Some((system, start, goal)) => options.start_in_goal(&system, &start, &goal)?,
        None => false,
    };
    let (refuted, attempts, sets) = (search.refuted, search.attempts, search.sets);
    // A longer look may have decided a horizon later.
    let is_open = |steps: usize| {
        let of = attempts.iter().rev().find(|attempt| attempt.steps == steps);
        steps > refuted
            && of.is_some_and(|last| matches!(last.verdict, HorizonVerdict::Undecided(_)))
    };
    let drifts = search.drifts.into_iter().filter(|(steps, _)| is_open(*steps)).collect();
    let mut found = ShortestHorizon {
        status,
        steps: None,
        plan: None,
        refuted_steps: (refuted > 0).then_some(refuted),
        time_step: builder.time_step(),
        discretization: builder.discretization(),
        monotonicity,
        sets,
        tube: None,
        attempts,
        drifts,
        proofs: Vec::new(),
        time,
        starts_in_goal,
        is_time_up,
        hints: Vec::new(),
    };
    if search.best.is_none() {
        found.hints = builder.hints();
    }
    if let Some(best) = search.best {
        found.steps = Some(best.steps);
        found.plan = Some(SolvedHorizon { program: best.program, solution: best.solution });
        found.tube = best.tube;
    }
    Ok(found)
}

pub(super) struct Feasible<P> {
    pub(super) steps: usize,
    program: P,
    solution: Solution,
    tube: Option<Tube>,
}

pub(super) struct Search<'a, B: HorizonModel + ?Sized> {
    builder: &'a B,
    /// Whether a feasible horizon makes every longer one feasible.
    is_free: bool,
    pub(super) options: &'a ShortestOptions,
    solver: &'a mut dyn Solver,
    pub(super) token: StopToken,
    /// Every horizon up to this one is refuted.
    pub(super) refuted: usize,
    /// The smallest horizon found feasible.
    pub(super) best: Option<Feasible<B::Program>>,
    /// Undecided horizons, with the reason.
    pub(super) undecided: Vec<(usize, Termination)>,
    pub(super) attempts: Vec<HorizonAttempt>,
    /// Horizons whose point is no run, and why.
    drifts: Vec<(usize, RunError)>,
    /// How many of the attempts came before the search proper: the first ascent by forward sets,
    /// and looks at longer horizons.
    pub(super) ascended: usize,
    /// Every horizon up to this one was tried, in ascending order.
    ascent: usize,
    sets: Option<ReachSets>,
    guess: Guess,
}

impl<B: HorizonModel + ?Sized> Search<'_, B> {
    fn run(&mut self) -> Result<ShortestStatus, Error> {
        let monotone = self.is_free;
        if let Some(reason) = self.ascend_by_sets()? {
            return Ok(ShortestStatus::Stopped(reason));
        }
        let mut looks = true;
        loop {
            let next = if monotone { self.next_probe() } else { self.next_ascending() };
            let Some(steps) = next else { return Ok(self.status()) };
            if let Some(reason) = self.reason_to_stop() {
                return Ok(ShortestStatus::Stopped(reason));
            }
            looks &= self.best.is_none();
            let before = self.attempts.len();
            if looks && !self.look(steps)? {
                looks = false;
                self.look_above(steps)?;
                continue;
            }
            if !looks {
                self.attempt(steps, None)?;
            }
            if self.attempts.len() > before {
                self.ascent = self.ascent.max(steps);
            }
        }
    }

    /// Refutes horizons in ascending order while the forward sets alone suffice. Returns why the
    /// search must stop, if it must.
    fn ascend_by_sets(&mut self) -> Result<Option<Termination>, Error> {
        let Some(sets) = &mut self.sets else { return Ok(None) };
        let mut steps = 1;
        while steps <= self.options.max_steps && !sets.may_finish(steps)? {
            if let Some(reason) = self.token.ended() {
                return Ok(Some(reason));
            }
            let attempt = HorizonAttempt::by_sets(steps);
            self.refuted = steps;
            self.attempts.push(attempt);
            self.ascended = self.attempts.len();
            self.options.tell(&HorizonEvent::Decided(attempt));
            steps += 1;
        }
        Ok(None)
    }

    /// The status if no horizon is left to try.
    fn status(&self) -> ShortestStatus {
        match &self.best {
            Some(best) if best.steps == self.refuted + 1 => ShortestStatus::Found,
            None if self.refuted == self.options.max_steps => {
                ShortestStatus::NoneWithin { max_steps: self.refuted }
            }
            _ => {
                let reason = self.undecided.last().map_or(Termination::Stalled, |&(_, why)| why);
                ShortestStatus::Stopped(reason)
            }
        }
    }

    /// The next horizon in ascending order, below the smallest that is feasible.
    fn next_ascending(&self) -> Option<usize> {
        let next = self.ascent.max(self.refuted) + 1;
        let last = self.best.as_ref().map_or(self.options.max_steps, |best| best.steps - 1);
        (next <= last).then_some(next)
    }

    /// The next horizon strictly between the refuted and the feasible ones: by galloping until one
    /// is known to be feasible, then by bisection. Skips undecided horizons.
    fn next_probe(&self) -> Option<usize> {
        let max_steps = self.options.max_steps;
        let low = self.refuted + 1;
        // A hint above the refuted horizons is treated as feasible, and is solved only if no
        // horizon below it is feasible.
        let hint = self.options.upper_hint.filter(|&hint| hint <= max_steps && hint >= low);
        let high = match (&self.best, hint) {
            (Some(best), _) => best.steps - 1,
            (None, Some(hint)) => hint,
            (None, None) => max_steps,
        };
        if low > high {
            return None;
        }
        let known_above = self.best.is_some() || hint.is_some();
        let begin = if self.sets.is_some() { low } else { self.builder.lower_hint() };
        let first = begin.clamp(low, high);
        let mut tried = self.attempts[self.ascended..].iter();
        let started = tried.next().map(|attempt| attempt.steps);
        let target = if started.is_none() {
            first
        } else if known_above {
            low + (high - low) / 2
        } else {
            // Galloping: double the distance from the first horizon.
            let start = started.unwrap_or(first);
            let reach = tried.map(|attempt| attempt.steps).fold(start, usize::max);
            (2 * reach - start + 1).clamp(low, high)
        };
        let free = |steps: &usize| !self.undecided.iter().any(|(tried, _)| tried == steps);
        // Prefer the target, then larger horizons, then smaller ones.
        let found = (target..=high).find(free).or_else(|| (low..target).rev().find(free));
        // The hint is undecided, so look above it as well.
        found.or_else(|| {
            let above = self.best.is_none() && hint.is_some();
            if above { (high + 1..=max_steps).find(free) } else { None }
        })
    }

    fn reason_to_stop(&self) -> Option<Termination> {
        let last = self.undecided.last().map(|&(_, why)| why);
        let tired = last.filter(|_| self.undecided.len() >= MAX_UNDECIDED);
        self.token.ended().or(tired)
    }

    /// Decides one horizon, by its tube or by a solve, and records the result.
    ///
    /// # Arguments
    ///
    /// * `nodes`: a limit for a look.
    pub(super) fn attempt(&mut self, steps: usize, nodes: Option<u64>) -> Result<(), Error> {
        let feasible = self.best.as_ref().map(|best| best.steps);
        self.options.tell(&HorizonEvent::Started { steps, refuted: self.refuted, feasible });
        let token = &self.token;
        let tube = match &mut self.sets {
            Some(sets) => {
                let tube = sets.tube_until(steps, token)?;
                // The loop of the search finds out why it was stopped.
                let Some(tube) = tube else { return Ok(()) };
                Some(tube)
            }
            None => None,
        };
        if tube.as_ref().is_some_and(|tube| tube.is_empty()) {
            self.file(HorizonAttempt::by_sets(steps), None);
            return Ok(());
        }
        let mut program = build(self.builder, steps, self.options)?;
        let variables = self.builder.variables(&mut program);
        let mut open = variables.binaries().map(|family| family.len()).sum();
        if let Some(tube) = &tube {
            let report = tube.tighten(program.as_mut(), &variables)?;
            if report.infeasible {
                self.file(HorizonAttempt::by_sets(steps), None);
                return Ok(());
            }
            open = if variables.states.is_empty() { open } else { report.open };
        }
        if open > MANY_OPEN
            && let Some(solution) =
                self.solve_restricted(steps, nodes, program.as_mut(), &variables)?
            && let Ok(solution) = self.settled(&mut program, solution)?
        {
            let attempt =
                HorizonAttempt { restricted: true, ..HorizonAttempt::of(steps, &solution) };
            self.file(attempt, Some(Feasible { steps, program, solution, tube }));
            return Ok(());
        }
        let solution = self.solve(steps, nodes, program.as_ref())?;
        let attempt = HorizonAttempt::of(steps, &solution);
        match self.settled(&mut program, solution)? {
            Ok(solution) => self.file(attempt, Some(Feasible { steps, program, solution, tube })),
            Err(drift) => {
                self.drifts.push((steps, drift));
                let verdict = HorizonVerdict::Undecided(Termination::Stalled);
                self.file(HorizonAttempt { verdict, ..attempt }, None);
            }
        }
        Ok(())
    }

    /// The solution whose states are the run of its inputs, or why there is none.
    fn settled(
        &mut self,
        program: &mut B::Program,
        solution: Solution,
    ) -> Result<Result<Solution, RunError>, Error> {
        settled(self.builder, program, solution, self.solver, &self.token)
    }

    fn solve(
        &mut self,
        steps: usize,
        nodes: Option<u64>,
        model: &Model,
    ) -> Result<Solution, Error> {
        let options = self.options;
        let mut relay = |event: &Event| {
            options.tell(&HorizonEvent::Solving { steps, progress: *event.progress() });
        };
        let gap = self.solver.options().absolute_gap;
        if self.builder.takes_any_point() {
            self.solver.options_mut().absolute_gap = ANY_GAP;
        }
        let solution = match nodes {
            None => self.token.solve(self.solver, model, &mut relay),
            nodes => look_token(&self.token).solve_within(nodes, self.solver, model, &mut relay),
        };
        self.solver.options_mut().absolute_gap = gap;
        solution
    }

    /// Solves with the binaries restricted to the neighbourhood of a coarser plan's. Returns a
    /// solution only if it has a point.
    fn solve_restricted(
        &mut self,
        steps: usize,
        nodes: Option<u64>,
        model: &mut Model,
        variables: &HorizonVariables,
    ) -> Result<Option<Solution>, Error> {
        if !self.options.coarse_guess {
            return Ok(None);
        }
        if self.guess.is_due(steps) {
            self.guess = Guess::ask(self.builder, steps, self.options, self.solver, &self.token)?;
        }
        let Guess::Modes(modes) = &self.guess else { return Ok(None) };
        let Some(freed) = restricted(modes, model, variables)? else { return Ok(None) };
        let solution = self.solve(steps, nodes, model)?;
        for (variable, bounds) in freed {
            model.set_bounds(variable, bounds.lower, bounds.upper)?;
        }
        if solution.point().is_some() {
            return Ok(Some(solution));
        }
        // This shows only that the guess does not fit this horizon.
        self.attempts.push(HorizonAttempt {
            restricted: true,
            verdict: HorizonVerdict::NotAsGuessed,
            ..HorizonAttempt::of(steps, &solution)
        });
        Ok(None)
    }

    /// Records the result for a horizon.
    fn file(&mut self, attempt: HorizonAttempt, solved: Option<Feasible<B::Program>>) {
        let steps = attempt.steps;
        match attempt.verdict {
            HorizonVerdict::Feasible => {
                if self.best.as_ref().is_none_or(|best| steps < best.steps) {
                    self.best = solved;
                }
            }
            HorizonVerdict::Refuted(_) => {
                // If waiting is free, every smaller horizon is refuted as well; otherwise only an
                // unbroken chain from 1 counts.
                if self.is_free || steps == self.refuted + 1 {
                    self.refuted = self.refuted.max(steps);
                }
            }
            HorizonVerdict::Undecided(reason) => self.undecided.push((steps, reason)),
            HorizonVerdict::NotAsGuessed => {}
        }
        self.attempts.push(attempt);
        self.options.tell(&HorizonEvent::Decided(attempt));
    }
}

/// The solution whose states are the run of its inputs, or why there is none.
pub(super) fn settled<B: HorizonModel + ?Sized>(
    builder: &B,
    program: &mut B::Program,
    solution: Solution,
    solver: &mut dyn Solver,
    token: &StopToken,
) -> Result<Result<Solution, RunError>, Error> {
    if solution.point().is_none() {
        return Ok(Ok(solution));
    }
    let limit = solver.options().time_limit;
    solver.options_mut().time_limit = token.left().or(limit);
    let found = builder.settled(program, solution, solver);
    solver.options_mut().time_limit = limit;
    match found {
        Ok(solution) => Ok(Ok(solution)),
        Err(error) => as_drift(&error).cloned().map(Err).ok_or(error),
    }
}

/// The program of a horizon with the statements of the options.
pub(super) fn build<B: HorizonModel + ?Sized>(
    builder: &B,
    steps: usize,
    options: &ShortestOptions,
) -> Result<B::Program, Error> {
    let mut program = builder.build(steps)?;
    if !options.has_statements() {
        options.prepare(program.as_mut());
        return Ok(program);
    }
    let mut done = Ok(false);
    builder.with_hybrid(&mut program, &mut |hybrid| {
        done = options.complete(hybrid).map(|()| true);
    });
    if !done? {
        return Err(ErrorKind::Unsupported {
            solver: "a search over programs without a hybrid system".into(),
            what: "windows and rows".into(),
            help: "add them in `HorizonModel::build`, or implement `HorizonModel::with_hybrid`"
                .into(),
        }
        .into());
    }
    Ok(program)
}
