//! The cells of the map, searched on all cores.

use std::path::PathBuf;
use std::sync::{Mutex, OnceLock, PoisonError};

use carom::collision_tolerant::Scenario;
use carom::hybrid::{
    HorizonRefutation, HorizonVerdict, ShortestOptions, ShortestStatus, shortest_horizon,
};
use carom::prelude::*;
use carom::sweep::{Sweep, SweepRecord, SweepResults};
use indicatif::{ProgressBar, ProgressStyle};

/// The nearest and the farthest destination, in m.
const GOALS: (f64, f64) = (0.05, 1.25);

/// One pair of a destination and a restitution.
#[derive(Clone, Copy)]
pub(crate) struct Cell {
    /// Distance of the destination from the wall, in m.
    pub(crate) goal: f64,
    pub(crate) restitution: f64,
    /// Whether it was not searched: by this run or those before it.
    pub(crate) is_missing: bool,
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
    pub(crate) results: SweepResults,
}

impl Map {
    /// Searches the shortest horizons of `size` destinations times `size` restitutions.
    ///
    /// After an interrupt, or of other shards, cells are missing.
    ///
    /// # Arguments
    ///
    /// * `file`: where the results are kept and looked for, a line a cell.
    /// * `shard`: the share of the cells to search, as `i/n`.
    pub(crate) fn solve(
        (size, time_step): (usize, f64),
        (file, shard): (Option<PathBuf>, Option<&str>),
        interrupt: &Interrupt,
    ) -> Result<Map, Error> {
        let goals = evenly(GOALS.0, GOALS.1, size);
        let restitutions = evenly(0.0, 1.0, size);
        let paper = Scenario::paper().with_time_step(time_step);
        paper.check()?;
        let sweep = Sweep::grid(
            &format!("map of steps of {time_step} s"),
            [("restitution", restitutions.clone()), ("goal", goals.clone())],
        )?;
        let mut sweep = sweep.with_interrupt(interrupt);
        if let Some(path) = file {
            sweep = sweep.with_file(path);
        }
        if let Some(shard) = shard {
            sweep = sweep.with_shard(shard)?;
        }
        let options = ShortestOptions::default().with_interrupt(interrupt);
        let effort = Mutex::new(Effort::default());
        let count = |found: &Found| {
            effort.lock().unwrap_or_else(PoisonError::into_inner).add(found);
        };

        // Without collisions the restitution does not matter.
        let free: Vec<OnceLock<Option<usize>>> = vec![OnceLock::new(); size];
        let bar = bar(sweep.len());
        let results = sweep.run(|case| {
            let goal = case.index() % size;
            let steps = match free[goal].get() {
                Some(steps) => *steps,
                None => {
                    let scenario = paper.clone().with_goal_position(goals[goal]).collision_free();
                    let found = search(&scenario, options.clone())?;
                    count(&found);
                    *free[goal].get_or_init(|| found.steps)
                }
            };
            let scenario = paper.clone().with_restitution(case.value("restitution"))?;
            let scenario = scenario.with_goal_position(case.value("goal"));
            let found = search_below(&scenario, options.clone(), steps)?;
            count(&found);
            bar.inc(1);
            let number = |steps: Option<usize>| steps.map(|steps| steps as f64);
            let record = SweepRecord::new()
                .with_number("steps_free", number(steps))
                .with_number("steps_tolerant", number(found.steps));
            // What was interrupted is searched again by the next run.
            let is_whole = !interrupt.is_triggered() || (steps.is_some() && found.steps.is_some());
            Ok(is_whole.then_some(record))
        })?;
        bar.finish_and_clear();

        let cell = |k: usize| {
            let record = results.record(k);
            let steps = |name| record?.number(name).map(|steps| steps as usize);
            Cell {
                goal: goals[k % size],
                restitution: restitutions[k / size],
                is_missing: record.is_none(),
                free: steps("steps_free"),
                tolerant: steps("steps_tolerant"),
            }
        };
        let cells = (0..sweep.len()).map(cell).collect();
        let effort = effort.into_inner().unwrap_or_else(PoisonError::into_inner);
        Ok(Map { goals, restitutions, time_step, cells, effort, results })
    }

    /// The number of cells that were not searched.
    pub(crate) fn missing(&self) -> usize {
        self.cells.iter().filter(|cell| cell.is_missing).count()
    }

    /// The number of cells without a proof, missing or not.
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
    let shortest = shortest_horizon(scenario, &search, &mut BranchAndBound::default())?;
    let count = |wanted: fn(HorizonRefutation) -> bool| {
        let refuted = |verdict| matches!(verdict, HorizonVerdict::Refuted(by) if wanted(by));
        shortest.attempts.iter().filter(|attempt| refuted(attempt.verdict)).count()
    };
    Ok(Found {
        steps: shortest.steps.filter(|_| shortest.is_found()),
        refuted: count(|_| true),
        by_sets: count(|by| by == HorizonRefutation::Sets),
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
