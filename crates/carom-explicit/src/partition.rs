//! The partition of the box, built level by level: all cells that wait are decided, and their
//! halves wait for the next level.
//!
//! The cells of a level are shared out among jobs. Which cells a job has, and what it knows before,
//! does not depend on the number of threads or on which one is faster. So the partition is the
//! same for any number of threads.

use std::collections::{HashMap, VecDeque};
use std::ops::Range;
use std::rc::Rc;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc;

use carom_model::internals::solver::StopToken;

use crate::build::{BuildGoal, CellDecision, PartitionCell};
use crate::corner::{Corner, SharedCorner, SharedCorners, Workshop};
use crate::expected_cells::CellCounts;
use crate::form::ParametricForm;
use crate::integer_tree::KnownCuts;
use crate::relaxed::CornerRelaxer;
use crate::simplex_cell::{kuhn, midpoint, orders};

/// The most jobs of a level, and the cells for which there is one more.
const MOST_JOBS: usize = 64;
const JOB_CELLS: usize = 16;

/// The partition as a tree; the first cells are those of the orders of the axes, and halves are in
/// the order in which they come into being, level by level.
#[derive(Debug)]
pub(crate) struct Partition {
    pub(crate) cells: Vec<PartitionCell>,
    pub(crate) orders: usize,
    /// The largest number of cuts on a way to a leaf.
    pub(crate) depth: usize,
}

/// A cell that waits.
#[derive(Debug)]
struct WaitingCell {
    corners: Vec<Arc<SharedCorner>>,
    /// Integers that were good for the whole.
    tried: Arc<Vec<Vec<i64>>>,
    number: usize,
    depth: usize,
}

/// The fate of a cell of a job.
enum LevelDecision {
    Leaf(PartitionCell),
    /// The edge, the corners of the halves, and integers to try there.
    Cut([usize; 2], [Vec<Arc<SharedCorner>>; 2], Arc<Vec<Vec<i64>>>),
}

/// The findings of a job.
struct JobResult {
    decided: Vec<LevelDecision>,
    cuts: KnownCuts,
    relaxations: u64,
}

/// The depth of a cell that was decided, and whether it is cut.
type Decided = (usize, bool);

/// The reports of threads.
enum JobNews {
    Decided(Decided),
    Done(usize, JobResult),
}

/// The data that all jobs of a level share.
struct Level<'a> {
    waiting: &'a [WaitingCell],
    shared: &'a SharedCorners,
    cuts: &'a Arc<KnownCuts>,
    jobs: usize,
    /// How many more cells there may be.
    room: usize,
}

impl Level<'_> {
    /// The cells of a job.
    fn cells(&self, job: usize) -> Range<usize> {
        let share = |job: usize| job * self.waiting.len() / self.jobs;
        share(job)..share(job + 1)
    }
}

/// A build.
pub(crate) struct PartitionBuild<'a> {
    pub(crate) form: &'a ParametricForm,
    pub(crate) goal: BuildGoal,
    pub(crate) token: &'a StopToken,
    pub(crate) threads: usize,
    /// Is told what is known after each decision.
    pub(crate) watch: &'a mut dyn FnMut(&CellCounts),
    /// Relaxations that were needed.
    pub(crate) relaxations: u64,
}

impl PartitionBuild<'_> {
    /// Builds the partition, from one that is continued or from the box.
    pub(crate) fn run(&mut self, begun: Option<Partition>) -> Partition {
        let shared = SharedCorners::default();
        let mut cuts = Arc::default();
        let (mut cells, mut waiting, mut earlier) = match begun {
            Some(partition) => self.reopen(partition, &shared),
            None => begin(self.form, &shared),
        };
        let roots = orders(self.form.axes.len()).len();
        let mut counts = CellCounts::new(self.form.axes.len(), roots, self.goal);
        counts.recount(&cells, roots);
        while !waiting.is_empty() {
            let level = Level {
                waiting: &waiting,
                shared: &shared,
                cuts: &cuts,
                jobs: waiting.len().div_ceil(JOB_CELLS).min(MOST_JOBS),
                room: self.goal.cells.saturating_sub(counts.leaves + waiting.len()),
            };
            let results = self.level(&level, &mut counts);
            let mut known = Arc::unwrap_or_clone(cuts);
            let mut decided = waiting.iter();
            let mut next = Vec::new();
            for result in results {
                self.relaxations += result.relaxations;
                result.cuts.into_iter().for_each(|(key, cut)| _ = known.entry(key).or_insert(cut));
                // The longer one last: `zip` takes one of the first beyond the end of the second.
                for (decision, cell) in result.decided.into_iter().zip(decided.by_ref()) {
                    cells[cell.number] = Some(match decision {
                        // What a limit leaves open now may have had a law before.
                        LevelDecision::Leaf(PartitionCell::Open) => {
                            earlier.remove(&cell.number).unwrap_or(PartitionCell::Open)
                        }
                        LevelDecision::Leaf(leaf) => leaf,
                        LevelDecision::Cut(edge, halves, tried) => {
                            let numbers = [cells.len(), cells.len() + 1];
                            for (corners, number) in halves.into_iter().zip(numbers) {
                                let (tried, depth) = (Arc::clone(&tried), cell.depth + 1);
                                next.push(WaitingCell { corners, tried, number, depth });
                                cells.push(None);
                            }
                            PartitionCell::Cut { edge, next: numbers }
                        }
                    });
                }
            }
            cuts = Arc::new(known);
            waiting = next;
            shared.sweep();
        }
        ordered(cells, roots)
    }

    /// The cells of a partition, of which those wait that are not finished.
    fn reopen(&self, partition: Partition, shared: &SharedCorners) -> Begun {
        let (form, orders) = (self.form, orders(self.form.axes.len()));
        let mut places: Vec<(Vec<Vec<i64>>, usize)> =
            orders.iter().map(|order| (kuhn(order), 0)).collect();
        let (mut cells, mut waiting, mut earlier) = (Vec::new(), Vec::new(), HashMap::new());
        for (number, mut cell) in partition.cells.into_iter().enumerate() {
            let Some((units, depth)) = places.get_mut(number).map(std::mem::take) else { break };
            if let PartitionCell::Cut { edge: [i, j], .. } = cell
                && let Some(middle) = midpoint(&units[i], &units[j])
            {
                for replaced in [j, i] {
                    let mut half = units.clone();
                    half[replaced].clone_from(&middle);
                    places.push((half, depth + 1));
                }
            }
            if cell.is_finished(form, self.goal) {
                cells.push(Some(cell));
                continue;
            }
            let corners = units.into_iter().map(|units| shared.corner(form, units)).collect();
            waiting.push(WaitingCell { corners, tried: Arc::default(), number, depth });
            earlier.insert(number, cell);
            cells.push(None);
        }
        (cells, waiting, earlier)
    }

    /// The results of the jobs of a level, in their order.
    fn level(&mut self, level: &Level<'_>, counts: &mut CellCounts) -> Vec<JobResult> {
        let PartitionBuild { form, goal, token, ref mut watch, .. } = *self;
        let threads = self.threads.min(level.jobs);
        if threads <= 1 {
            let mut tell = |decided: Decided| {
                counts.add(decided);
                watch(counts);
            };
            let run = |job| level.run(job, (form, goal, token.clone()), &mut tell);
            return (0..level.jobs).map(run).collect();
        }
        let mut results: Vec<Option<JobResult>> = (0..level.jobs).map(|_| None).collect();
        let next = AtomicUsize::new(0);
        let (sender, receiver) = mpsc::channel();
        std::thread::scope(|scope| {
            for _ in 0..threads {
                let (sender, next) = (sender.clone(), &next);
                scope.spawn(move || {
                    loop {
                        let job = next.fetch_add(1, Ordering::Relaxed);
                        if job >= level.jobs {
                            return;
                        }
                        // Nobody listens only if the watch has panicked.
                        let mut tell =
                            |decided| sender.send(JobNews::Decided(decided)).unwrap_or(());
                        let result = level.run(job, (form, goal, token.clone()), &mut tell);
                        sender.send(JobNews::Done(job, result)).unwrap_or(());
                    }
                });
            }
            drop(sender);
            for news in receiver {
                match news {
                    JobNews::Decided(decided) => {
                        counts.add(decided);
                        watch(counts);
                    }
                    JobNews::Done(job, result) => results[job] = Some(result),
                }
            }
        });
        results.into_iter().flatten().collect()
    }
}

impl Level<'_> {
    fn run(
        &self,
        job: usize,
        (form, goal, token): (&ParametricForm, BuildGoal, StopToken),
        tell: &mut dyn FnMut(Decided),
    ) -> JobResult {
        let relaxer = CornerRelaxer::new(form, token);
        let mut shop = Workshop::new(form, self.shared, self.cuts, relaxer);
        let mut room = self.room / self.jobs + usize::from(job < self.room % self.jobs);
        let own = &self.waiting[self.cells(job)];
        // All of them, so that no corner of a cell is forgotten before its neighbours are decided.
        let corners = |cell: &WaitingCell, shop: &mut Workshop<'_>| {
            let own = cell.corners.iter().map(|corner| shop.corner(corner.units.clone()));
            own.collect::<Vec<Rc<Corner>>>()
        };
        let all: Vec<Vec<Rc<Corner>>> = own.iter().map(|cell| corners(cell, &mut shop)).collect();
        let mut halves_corners = Vec::new();
        let mut decided = Vec::with_capacity(own.len());
        for (cell, corners) in own.iter().zip(&all) {
            let tried: Vec<usize> = cell.tried.iter().map(|key| shop.tree.of_key(key)).collect();
            let decision = match shop.decide(corners, &tried, (goal, cell.depth), room > 0) {
                CellDecision::Leaf(leaf) => LevelDecision::Leaf(leaf),
                CellDecision::Cut(edge, halves, tried) => {
                    room -= 1;
                    let shared = |half: &Vec<Rc<Corner>>| {
                        half.iter().map(|corner| Arc::clone(&corner.shared)).collect()
                    };
                    let corners = [shared(&halves[0]), shared(&halves[1])];
                    halves_corners.push(halves);
                    let tried = tried.iter().map(|&number| shop.tree.key(number).to_vec());
                    LevelDecision::Cut(edge, corners, Arc::new(tried.collect()))
                }
            };
            tell((cell.depth, matches!(decision, LevelDecision::Cut(..))));
            decided.push(decision);
        }
        JobResult { decided, relaxations: shop.needed, cuts: shop.tree.into_cuts() }
    }
}

/// Cells, of which those that wait are not known, and laws that some of them had before.
type Begun = (Vec<Option<PartitionCell>>, Vec<WaitingCell>, HashMap<usize, PartitionCell>);

/// The simplices of the box.
fn begin(form: &ParametricForm, shared: &SharedCorners) -> Begun {
    let whole = |(number, order): (usize, Vec<usize>)| WaitingCell {
        corners: kuhn(&order).into_iter().map(|units| shared.corner(form, units)).collect(),
        tried: Arc::default(),
        number,
        depth: 0,
    };
    let waiting: Vec<WaitingCell> =
        orders(form.axes.len()).into_iter().enumerate().map(whole).collect();
    (waiting.iter().map(|_| None).collect(), waiting, HashMap::new())
}

/// The cells level by level.
fn ordered(mut cells: Vec<Option<PartitionCell>>, roots: usize) -> Partition {
    let mut sorted = Vec::with_capacity(cells.len());
    let mut queue: VecDeque<(usize, usize)> = (0..roots).map(|number| (number, 0)).collect();
    let (mut next, mut most) = (roots, 0);
    while let Some((number, depth)) = queue.pop_front() {
        most = most.max(depth);
        match cells[number].take().unwrap_or(PartitionCell::Open) {
            PartitionCell::Cut { edge, next: halves } => {
                queue.extend(halves.map(|half| (half, depth + 1)));
                sorted.push(PartitionCell::Cut { edge, next: [next, next + 1] });
                next += 2;
            }
            leaf => sorted.push(leaf),
        }
    }
    Partition { cells: sorted, orders: roots, depth: most }
}
