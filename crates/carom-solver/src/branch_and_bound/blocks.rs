//! Searching the blocks of a program one after the other.
//!
//! Bounds, objectives and gaps add up; each block gets a share of the gap. The whole has a point or
//! a bound only if every block has one. Time and nodes are shared evenly among the remaining
//! blocks, and what a block does not use is left for the others.

use web_time::Duration;

use super::events::PartOfSolve;
use super::search::search_task;
use super::solve::EarlierResults;
use crate::presolve::root::{ProgramBlock, blocks};
use crate::program::{ConeRole, Program};
use crate::search::{PointJudge, SearchResult, SolveTask};
use crate::solution::{Point, Statistics, Termination};
use crate::solver::{Control, Options, Progress, StopToken, TreeExchange, TreePart};
use crate::sum::Sum;
use crate::tolerance;

/// A block, with its bound, its best point and the limits of its search.
struct BlockState {
    block: ProgramBlock,
    bound: f64,
    /// Objective and values of its best point.
    best: Option<(f64, Vec<f64>)>,
    ended: Option<Termination>,
    granted: Grant,
    /// The absolute and the relative gap at which it may stop.
    gap: [f64; 2],
}

/// The limits of a search: time from now on, and nodes.
#[derive(Debug, Clone, Copy, Default)]
struct Grant {
    time: Option<Duration>,
    nodes: Option<u64>,
}

impl Grant {
    /// Whether it allows more than an earlier one.
    fn exceeds(self, earlier: Grant) -> bool {
        self.time > earlier.time || self.nodes > earlier.nodes
    }
}

/// The figures that the other blocks add to those of one, in the model's own sense.
struct Others {
    nodes: u64,
    relaxations: u64,
    iterations: u64,
    /// Their objective; `None` if one of them has no point.
    value: Option<f64>,
    bound: f64,
    /// The constant of the whole objective.
    constant: f64,
}

impl Others {
    fn progress(&self, own: &Progress) -> Progress {
        let bound = own.bound + self.bound;
        {
            let mut progress = *own;
            progress.nodes = own.nodes + self.nodes;
            progress.relaxations = own.relaxations + self.relaxations;
            progress.iterations = own.iterations + self.iterations;
            progress.explored = None;
            progress.incumbent = own.incumbent.zip(self.value).map(|(own, others)| own + others);
            // Opposite infinities: the block is infeasible, and nothing is known of the others.
            progress.bound = if bound.is_nan() { self.bound } else { bound };
            progress.constant = self.constant;
            progress
        }
    }
}

/// The blocks of the program of a task.
struct BlockSearches<'a, 'c> {
    task: SolveTask<'a>,
    states: Vec<BlockState>,
    statistics: Statistics,
    searches: usize,
    /// Whether any points will do, since the objective of a block falls forever.
    any_point: bool,
    /// Whether the value of a point is due to limits that presolve has widened, as in
    /// [`SearchResult`].
    is_widened: bool,
    /// Also over when the user stops the solve.
    token: StopToken,
    /// Other processes that search the same trees, in the first turn.
    exchange: Option<&'c mut dyn TreeExchange>,
}

/// The exchange of one block.
struct BlockExchange<'a> {
    whole: &'a mut dyn TreeExchange,
    is_last: bool,
}

impl TreeExchange for BlockExchange<'_> {
    fn begin(&mut self, program: u64, _: bool) -> bool {
        self.whole.begin(program, self.is_last)
    }

    fn meet(&mut self, part: &mut dyn TreePart, is_idle: bool) -> bool {
        self.whole.meet(part, is_idle)
    }
}

/// The result of searching the program of a task block by block; `None` if it must not be split, if
/// it is a single block, has more than `most`, or if the blocks come to no conclusion.
pub(super) fn search_blocks(
    task: SolveTask<'_>,
    most: usize,
    control: &mut Control<'_>,
) -> Option<SearchResult> {
    let options = task.options;
    if !options.parts().blocks || most < 2 || options.parts().keep_leaves || options.pool > 1 {
        return None;
    }
    let blocks = blocks(task.program);
    let count = blocks.len();
    if count < 2 || count > most {
        return None;
    }
    let gap = [options.absolute_gap / count as f64, options.relative_gap];
    let state = |block| BlockState {
        block,
        bound: f64::NEG_INFINITY,
        best: None,
        ended: None,
        granted: Grant::default(),
        gap,
    };
    let mut blocks = BlockSearches {
        task,
        states: blocks.into_iter().map(state).collect(),
        statistics: {
            let mut statistics = Statistics::default();
            statistics.blocks = count as u64;
            statistics
        },
        searches: 0,
        any_point: false,
        is_widened: false,
        token: task.token.child(None),
        exchange: control.take_exchange(),
    };
    blocks.run(control)
}

impl BlockSearches<'_, '_> {
    fn run(&mut self, control: &mut Control<'_>) -> Option<SearchResult> {
        // A second time where the gaps of the blocks are met and that of the whole is not:
        // objectives may cancel.
        for _ in 0..2 {
            loop {
                let before = self.searches;
                for k in 0..self.states.len() {
                    if !self.token.is_over() && !self.is_done(k) {
                        self.search(k, control);
                    }
                    if self.any_point {
                        // The other processes do not know that any point will do.
                        self.exchange = None;
                    }
                    if self.states[k].ended == Some(Termination::Infeasible) {
                        let statistics = self.statistics;
                        return Some(SearchResult { statistics, ..SearchResult::infeasible() });
                    }
                }
                self.exchange = None;
                if self.searches == before {
                    break;
                }
            }
            if !self.tighten() {
                break;
            }
        }
        self.conclude()
    }

    fn is_done(&self, k: usize) -> bool {
        let BlockState { ended, best, .. } = &self.states[k];
        let ended = ended.is_some_and(|reason| !reason.is_limit());
        ended || (self.any_point && best.is_some())
    }

    /// The share of a block in the time and nodes that are left; `None` if none are left.
    fn grant(&self, k: usize) -> Option<Grant> {
        // All processes search the same blocks in the same order: a block is left when it is done.
        let waiting = match self.exchange {
            Some(_) => 1,
            None => (k..self.states.len()).filter(|&k| !self.is_done(k)).count().max(1),
        };
        let (limits, time) = (self.task.options, self.token.left());
        let nodes = limits.node_limit.map(|limit| limit.saturating_sub(self.statistics.nodes));
        if time.is_some_and(|time| time.is_zero()) || (self.searches > 0 && nodes == Some(0)) {
            return None;
        }
        let share = |nodes: u64| nodes.div_ceil(waiting as u64);
        Some(Grant { time: time.map(|t| t / waiting as u32), nodes: nodes.map(share) })
    }

    /// Searches a block, unless it was searched before with as much time and as many nodes.
    fn search(&mut self, k: usize, control: &mut Control<'_>) {
        let Some(grant) = self.grant(k) else { return };
        let BlockState { block, granted, ended, gap, .. } = &self.states[k];
        if ended.is_some() && !grant.exceeds(*granted) {
            return;
        }
        let mut options = self.task.options.clone();
        [options.absolute_gap, options.relative_gap] = *gap;
        options.node_limit = grant.nodes;
        let mut flat = None;
        if self.any_point {
            let mut program = block.program.clone();
            program.make_feasibility_problem();
            flat = Some(program);
        }
        let program = flat.as_ref().unwrap_or(&block.program);
        let token = self.token.child(grant.time);
        let mut exchange = self.exchange.take();
        let found = self.search_one(k, program, &options, &token, (control, &mut exchange));
        self.exchange = exchange;

        self.searches += 1;
        self.is_widened |= found.is_widened;
        self.statistics.add(&found.statistics);
        self.statistics.threads = self.statistics.threads.max(found.statistics.threads);
        let BlockState { block, bound, best, ended, granted, .. } = &mut self.states[k];
        (*ended, *granted) = (Some(found.termination), grant);
        if flat.is_none() {
            *bound = bound.max(found.bound);
        }
        if let Some(values) = found.points.into_iter().next() {
            let value = block.program.objective(&values);
            if best.as_ref().is_none_or(|(old, _)| value < *old) {
                *best = Some((value, values));
            }
        }
        self.any_point |= found.termination == Termination::Unbounded;
    }

    fn search_one(
        &self,
        k: usize,
        program: &Program,
        options: &Options,
        token: &StopToken,
        (control, exchange): (&mut Control<'_>, &mut Option<&mut dyn TreeExchange>),
    ) -> SearchResult {
        let others = self.others(k);
        let judge = BlockJudge {
            block: &self.states[k].block,
            rest: self.point(Some(k)),
            whole: self.task.judge,
            feasibility: options.feasibility,
        };
        let part = PartOfSolve {
            is_first: others.nodes == 0,
            figures: &|own| others.progress(own),
            objective: &|own| others.value.map(|others| own + others),
            told: None,
            token: &self.token,
        };
        let task = SolveTask { program, judge: &judge, options, token, ..self.task };
        let is_last = k + 1 == self.states.len();
        let mut exchange = exchange.as_deref_mut().map(|whole| BlockExchange { whole, is_last });
        let exchange = exchange.as_mut().map(|own| own as &mut dyn TreeExchange);
        part.run_together(control, exchange, |control| {
            search_task(task, &EarlierResults::default(), control)
        })
    }

    fn others(&self, k: usize) -> Others {
        let others =
            || self.states.iter().enumerate().filter(|(i, _)| *i != k).map(|(_, part)| part);
        let (sign, offset) = (self.task.program.sign, self.task.program.offset);
        let values = others().map(|part| part.best.as_ref().map(|(value, _)| value));
        Others {
            nodes: self.statistics.nodes,
            relaxations: self.statistics.relaxations,
            iterations: self.statistics.iterations,
            value: values.sum::<Option<f64>>().map(|value| sign * (offset + value)),
            bound: sign * (offset + others().map(|part| part.bound).sum::<f64>()),
            constant: sign * self.task.program.constant,
        }
    }

    /// The best points of all blocks, or of all but one, put together; `None` if a block has none.
    fn point(&self, except: Option<usize>) -> Option<Vec<f64>> {
        let mut point = vec![0.0; self.task.program.column_count()];
        for (k, part) in self.states.iter().enumerate() {
            match &part.best {
                _ if Some(k) == except => {}
                Some((_, values)) => part.block.scatter(values, &mut point),
                None => return None,
            }
        }
        Some(point)
    }

    fn bound(&self) -> f64 {
        self.task.program.offset + self.states.iter().map(|part| part.bound).sum::<f64>()
    }

    /// Largest gap between bound and objective of the whole.
    fn allowed(&self, value: f64) -> f64 {
        self.task.options.allowed_gap(value, self.task.program.constant)
    }

    /// If all blocks are solved and the whole is not, reopens those that are further from their
    /// bounds than their share. Returns whether there are any.
    fn tighten(&mut self) -> bool {
        let solved = |part: &BlockState| part.ended == Some(Termination::Optimal);
        let Some(point) = self.point(None).filter(|_| self.states.iter().all(solved)) else {
            return false;
        };
        let value = self.task.program.objective(&point);
        let allowed = self.allowed(value);
        if value - self.bound() <= allowed {
            return false;
        }
        let share = 0.9 * allowed / self.states.len() as f64;
        for part in &mut self.states {
            if part.best.as_ref().is_some_and(|(value, _)| value - part.bound > share) {
                (part.ended, part.gap) = (None, [share, 0.0]);
            }
        }
        true
    }

    /// The result for the whole that follows from all blocks; `None` if nothing follows.
    fn conclude(&self) -> Option<SearchResult> {
        let reason = self.limit();
        let point = self.point(None);
        let verified = point.filter(|point| self.task.judge.accepts(point));
        let found = |termination, bound, points: Vec<Vec<f64>>| {
            let statistics = self.statistics;
            Some(SearchResult {
                termination,
                bound,
                points,
                statistics,
                is_widened: self.is_widened,
                pool_complete: false,
                ..SearchResult::infeasible()
            })
        };
        let ended = |part: &BlockState| part.ended == Some(Termination::Unbounded);
        let falls = self.states.iter().any(ended);
        let Some(point) = verified else {
            let bound = if falls { f64::NEG_INFINITY } else { self.bound() };
            return found(reason?, bound, Vec::new());
        };
        if falls {
            return found(Termination::Unbounded, f64::NEG_INFINITY, vec![point]);
        }
        let value = self.task.program.objective(&point);
        let bound = self.bound().min(value);
        if value - bound <= self.allowed(value) {
            return found(Termination::Optimal, bound, vec![point]);
        }
        found(reason?, bound, vec![point])
    }

    /// The limit that kept blocks from being searched to their ends, if one did.
    fn limit(&self) -> Option<Termination> {
        let ended = self.token.ended();
        if ended == Some(Termination::Interrupted) {
            return ended;
        }
        let reached = self.states.iter().filter_map(|part| part.ended).find(|end| end.is_limit());
        let waits = self.states.iter().any(|part| part.ended.is_none());
        let options = self.task.options;
        let nodes = options.node_limit.is_some_and(|limit| self.statistics.nodes >= limit);
        reached.or(match (waits, ended.is_some(), nodes) {
            (true, true, _) => Some(Termination::TimeLimit),
            (true, false, true) => Some(Termination::NodeLimit),
            _ => None,
        })
    }
}

/// Judges points of one block, beside the best points of the others.
struct BlockJudge<'a> {
    block: &'a ProgramBlock,
    /// The best points of the other blocks; `None` if one of them has none.
    rest: Option<Vec<f64>>,
    whole: &'a dyn PointJudge,
    feasibility: f64,
}

impl PointJudge for BlockJudge<'_> {
    fn accepts(&self, x: &[f64]) -> bool {
        holds(&self.block.program, x, self.feasibility)
    }

    fn point(&self, x: &[f64]) -> Option<Point> {
        let mut point = self.rest.clone()?;
        self.block.scatter(x, &mut point);
        self.whole.point(&point).filter(|_| self.whole.accepts(&point))
    }
}

/// Whether a point satisfies bounds, rows and cones of a program as a model's verification wants
/// it.
fn holds(program: &Program, x: &[f64], feasibility: f64) -> bool {
    let within = |columns: &[usize], values: &[f64], limits: [f64; 2]| {
        let (mut magnitude, mut whole) = (0.0, true);
        let mut sums = limits.map(|limit| Sum::new(-limit));
        for (&j, &a) in columns.iter().zip(values) {
            sums.iter_mut().for_each(|sum| sum.add_product(a, x[j]));
            magnitude += (a * x[j]).abs();
            whole &= program.integral[j] && a == a.round();
        }
        let [below, above] = [-sums[0].value(), sums[1].value()];
        let limit = if below > above { limits[0] } else { limits[1] };
        let limit = tolerance::finite_size(limit);
        let rounded = if whole { 0.0 } else { magnitude + limit };
        below.max(above) <= tolerance::allowed_miss(feasibility, rounded)
    };
    (0..program.column_count()).all(|j| within(&[j], &[1.0], [program.lower[j], program.upper[j]]))
        && (0..program.row_count()).all(|row| {
            let (columns, values) = program.row(row);
            within(columns, values, [program.row_lower[row], program.row_upper[row]])
        })
        // Parts only serve the whole.
        && program.cones.iter().filter(|cone| cone.role != ConeRole::Part).all(|cone| {
            let magnitude = cone.columns.iter().map(|&j| x[j].abs()).sum();
            cone.miss(x) <= tolerance::allowed_miss(feasibility, magnitude)
        })
}
