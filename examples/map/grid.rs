//! The cells of the map, searched on all cores.

use std::sync::atomic::{AtomicUsize, Ordering};

use carom::collision_tolerant::{PlanningOptions, Scenario};
use carom::hybrid::{Refutation, ShortestOptions, ShortestStatus, Verdict};
use carom::prelude::*;
use indicatif::{ProgressBar, ProgressStyle};

/// The nearest and the farthest destination, in m.
const GOALS: (f64, f64) = (0.05, 1.25);

/// One pair of a destination and a restitution.
#[derive(Clone, Copy)]
pub(crate) struct Cell {
    /// Distance of the destination from the wall, in m.
    pub(crate) goal: f64,
    pub(crate) restitution: f64,
    /// The shortest horizon without collisions, in steps, where it is proved.
    pub(crate) free: Option<usize>,
    /// The shortest horizon with collisions tolerated, in steps, where it is proved.
    pub(crate) tolerant: Option<usize>,
}

impl Cell {
    /// Both horizons, if both are proved.
    fn proved(&self) -> Option<(usize, usize)> {
        self.free.zip(self.tolerant)
    }

    pub(crate) fn is_proved(&self) -> bool {
        self.proved().is_some()
    }

    /// Whether hitting the wall pays.
    pub(crate) fn hits(&self) -> bool {
        self.proved().is_some_and(|(free, tolerant)| tolerant < free)
    }

    /// Time saved by hitting the wall, in percent of the time without collisions.
    pub(crate) fn saving(&self) -> f64 {
        self.proved().map_or(0.0, |(free, tolerant)| 100.0 * (1.0 - tolerant as f64 / free as f64))
    }
}

/// The total cost of the searches.
#[derive(Default)]
pub(crate) struct Effort {
    pub(crate) searches: usize,
    /// Horizons that were refuted one by one, and those of them refuted by reach sets.
    pub(crate) refuted: usize,
    pub(crate) by_sets: usize,
    /// Time of all searches and of the longest one, in s.
    pub(crate) seconds: f64,
    pub(crate) longest: f64,
}

/// The map: cells by rows of equal restitution, and in a row by destination.
pub(crate) struct Map {
    pub(crate) goals: Vec<f64>,
    pub(crate) restitutions: Vec<f64>,
    pub(crate) time_step: f64,
    pub(crate) cells: Vec<Cell>,
    pub(crate) effort: Effort,
    pub(crate) threads: usize,
}

impl Map {
    /// Searches the shortest horizons of `size` destinations times `size` restitutions.
    ///
    /// After an interrupt, the remaining cells have no proof.
    pub(crate) fn solve(size: usize, time_step: f64, interrupt: &Interrupt) -> Result<Map, Error> {
        let goals = evenly(GOALS.0, GOALS.1, size);
        let restitutions = evenly(0.0, 1.0, size);
        let paper = Scenario::paper().with_time_step(time_step);
        paper.check()?;
        let threads = std::thread::available_parallelism().map_or(1, |threads| threads.get());
        let mut effort = Effort::default();
        let options = ShortestOptions::default().with_interrupt(interrupt);

        // Without collisions the restitution does not matter.
        let bar = bar(size * (size + 1));
        let free = in_parallel(threads, size, &bar, |k| {
            let scenario = paper.clone().with_goal_position(goals[k]).collision_free();
            search(&scenario, options.clone())
        })?;
        let tolerant = in_parallel(threads, size * size, &bar, |k| {
            let scenario = paper.clone().with_restitution(restitutions[k / size])?;
            let scenario = scenario.with_goal_position(goals[k % size]);
            search_below(&scenario, options.clone(), free[k % size].steps)
        })?;
        bar.finish_and_clear();

        free.iter().chain(&tolerant).for_each(|found| effort.add(found));
        let cell = |(k, found): (usize, &Found)| Cell {
            goal: goals[k % size],
            restitution: restitutions[k / size],
            free: free[k % size].steps,
            tolerant: found.steps,
        };
        let cells = tolerant.iter().enumerate().map(cell).collect();
        Ok(Map { goals, restitutions, time_step, cells, effort, threads })
    }

    /// The number of cells without a proof.
    pub(crate) fn unproved(&self) -> usize {
        self.cells.iter().filter(|cell| !cell.is_proved()).count()
    }
}

impl Effort {
    fn add(&mut self, found: &Found) {
        self.searches += usize::from(found.seconds > 0.0);
        self.refuted += found.refuted;
        self.by_sets += found.by_sets;
        self.seconds += found.seconds;
        self.longest = self.longest.max(found.seconds);
    }
}

/// The result of a search.
#[derive(Default)]
struct Found {
    /// The shortest horizon, in steps, where it is proved.
    steps: Option<usize>,
    /// Whether all horizons that were allowed are refuted.
    none: bool,
    refuted: usize,
    by_sets: usize,
    seconds: f64,
}

fn search(scenario: &Scenario, search: ShortestOptions) -> Result<Found, Error> {
    if search.interrupt.is_triggered() {
        return Ok(Found::default());
    }
    // Only the horizon matters, so impacts are not minimised.
    let options = PlanningOptions::default().with_fewest_impacts(false).with_search(search);
    let shortest = scenario.shortest_plan(&options, &mut BranchAndBound::default())?;
    let count = |wanted: fn(Refutation) -> bool| {
        let refuted = |verdict| matches!(verdict, Verdict::Refuted(by) if wanted(by));
        shortest.attempts.iter().filter(|attempt| refuted(attempt.verdict)).count()
    };
    Ok(Found {
        steps: shortest.steps.filter(|_| shortest.is_found()),
        refuted: count(|_| true),
        by_sets: count(|by| by == Refutation::Sets),
        seconds: shortest.time.as_secs_f64(),
        none: matches!(shortest.status, ShortestStatus::NoneWithin { .. }),
    })
}

/// The search with collisions, given the shortest horizon without them. A plan that avoids the wall
/// is also a plan with collisions allowed, so only shorter horizons are searched: either one of
/// them is the shortest, or all are refuted and hitting does not pay.
fn search_below(
    scenario: &Scenario,
    options: ShortestOptions,
    free: Option<usize>,
) -> Result<Found, Error> {
    let Some(free) = free else { return search(scenario, options) };
    if free == 1 {
        return Ok(Found { steps: Some(1), ..Found::default() });
    }
    let found = search(scenario, options.with_max_steps(free - 1))?;
    Ok(if found.none { Found { steps: Some(free), ..found } } else { found })
}

/// Calls `work` with the numbers from 0 to `count - 1` and returns the results in that order. The
/// first error ends the work of all threads.
fn in_parallel<T: Send>(
    threads: usize,
    count: usize,
    bar: &ProgressBar,
    work: impl Fn(usize) -> Result<T, Error> + Sync,
) -> Result<Vec<T>, Error> {
    let next = AtomicUsize::new(0);
    let worker = || -> Result<_, Error> {
        let mut done = Vec::new();
        loop {
            let k = next.fetch_add(1, Ordering::Relaxed);
            if k >= count {
                return Ok(done);
            }
            let result = work(k).inspect_err(|_| next.store(count, Ordering::Relaxed))?;
            done.push((k, result));
            bar.inc(1);
        }
    };
    let mut all = std::thread::scope(|scope| {
        let handles: Vec<_> = (0..threads).map(|_| scope.spawn(worker)).collect();
        let mut all = Vec::new();
        for handle in handles {
            all.extend(handle.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))?);
        }
        Ok::<_, Error>(all)
    })?;
    all.sort_by_key(|(k, _)| *k);
    Ok(all.into_iter().map(|(_, result)| result).collect())
}

/// A progress bar, shown only on a terminal.
fn bar(length: usize) -> ProgressBar {
    let bar = ProgressBar::new(length as u64);
    if let Ok(style) = ProgressStyle::with_template("{bar:40} {pos}/{len} {elapsed} (left {eta})") {
        bar.set_style(style);
    }
    bar
}

/// `size` numbers from `low` to `high`, rounded to what is printed.
fn evenly(low: f64, high: f64, size: usize) -> Vec<f64> {
    let at = |k: usize| low + (high - low) * k as f64 / (size - 1) as f64;
    (0..size).map(|k| (at(k) * 1e4).round() / 1e4).collect()
}
