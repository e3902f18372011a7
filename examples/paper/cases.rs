//! The paper's cases, and solving them on two threads with a progress bar.

use std::path::Path;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

use carom::collision_tolerant::{Plan, Scenario};
use carom::hybrid::scene::{DamageLimitOptions, DamageLimitRange, DamageRule};
use carom::hybrid::{
    HorizonRefutation, HorizonVerdict, ShortestHorizon, ShortestOptions, ShortestStatus,
};
use carom::prelude::*;

use super::progress::{Bars, Line};

/// Perfectly plastic, as the paper says, and the restitution that gives the paper's 2.245 s.
pub(crate) const PAPER_RESTITUTIONS: [f64; 2] = [0.0, 0.025];

/// From a soft wall to a perfectly elastic one.
pub(crate) const FURTHER_RESTITUTIONS: [f64; 4] = [0.3, 0.5, 0.8, 1.0];

/// The paper's damage-limited plan takes 2.39 s, which is 478 steps.
pub(crate) const LIMITED_STEPS: usize = 478;

/// The destination study: from the paper's goal away from the wall, past the point where hitting
/// stops to pay (0.67 m in continuous time).
const GOALS: [f64; 7] = [0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9];

/// The time for the log of one horizon.
const LOG_LIMIT: Duration = Duration::from_secs(30);

/// One experiment.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Case {
    CollisionFree,
    CollisionTolerant { restitution: f64 },
    DamageLimited { restitution: f64 },
    Destination { goal: f64 },
}

impl Case {
    /// Its name in a table.
    pub(crate) fn label(self) -> String {
        match self {
            Case::CollisionFree => "no collision".into(),
            Case::CollisionTolerant { restitution } => format!("collision, e = {restitution}"),
            Case::DamageLimited { restitution } => format!("damage limited, e = {restitution}"),
            Case::Destination { goal } => format!("to {goal} m, e = 0"),
        }
    }

    /// The folder of its logs.
    pub(crate) fn folder(self) -> String {
        match self {
            Case::CollisionFree => "collision_free".into(),
            Case::CollisionTolerant { restitution } => format!("collision_tolerant_e{restitution}"),
            Case::DamageLimited { restitution } => format!("damage_limited_e{restitution}"),
            Case::Destination { goal } => format!("destination_{goal}"),
        }
    }
}

/// A solved experiment.
pub(crate) struct SolvedCase {
    pub(crate) case: Case,
    pub(crate) scenario: Scenario,
    pub(crate) shortest: ShortestHorizon<Plan>,
    /// Limited cases: the limits on the impact speed that make 478 steps the shortest horizon.
    pub(crate) interval: Option<DamageLimitRange>,
    /// Destinations: the same goal without collisions.
    pub(crate) without: Option<ShortestHorizon<Plan>>,
}

impl SolvedCase {
    /// Whether all of it is proved.
    pub(crate) fn is_done(&self) -> bool {
        let stopped = |of: &ShortestHorizon<Plan>| matches!(of.status, ShortestStatus::Stopped(_));
        !stopped(&self.shortest) && !self.without.as_ref().is_some_and(stopped)
    }

    /// Whether hitting the wall pays: the tolerant plan is shorter than that without collisions.
    pub(crate) fn hits(&self) -> bool {
        match (&self.without, self.shortest.steps) {
            (Some(without), Some(steps)) => without.steps.is_none_or(|free| steps < free),
            _ => false,
        }
    }

    /// Duration of the shortest plan, in s.
    pub(crate) fn seconds(&self) -> f64 {
        self.shortest.plan.as_ref().map_or(f64::NAN, |plan| plan.trajectory.duration())
    }

    /// Impacts of the shortest plan.
    pub(crate) fn impacts(&self) -> Option<usize> {
        self.shortest.plan.as_ref().map(|plan| plan.trajectory.impacts.len())
    }

    /// The number of horizons that were refuted one by one in a certain way.
    pub(crate) fn refuted_by(&self, way: HorizonRefutation) -> usize {
        let refuted = HorizonVerdict::Refuted(way);
        self.shortest.attempts.iter().filter(|attempt| attempt.verdict == refuted).count()
    }

    /// Nodes over all solves.
    pub(crate) fn nodes(&self) -> u64 {
        let refined = self.shortest.plan.iter().flat_map(|plan| &plan.refinements);
        self.shortest.nodes() + refined.map(|solve| solve.nodes).sum::<u64>()
    }

    /// The number of programs that the search for the shortest horizon solved.
    pub(crate) fn solves(&self) -> usize {
        self.shortest.attempts.iter().filter(|attempt| attempt.is_solve()).count()
    }
}

/// Solves every case; the order of the results is that of the tables. After an interrupt, they lack
/// the cases that were not begun.
///
/// # Arguments
///
/// * `proofs`: the folder for logs.
pub(crate) fn solve_all(
    interrupt: &Interrupt,
    proofs: Option<&Path>,
) -> Result<Vec<SolvedCase>, Error> {
    let tolerant = |restitution| Case::CollisionTolerant { restitution };
    let mut cases = vec![Case::CollisionFree];
    cases.extend(PAPER_RESTITUTIONS.map(tolerant));
    cases.extend(FURTHER_RESTITUTIONS.map(tolerant));
    cases.extend(PAPER_RESTITUTIONS.map(|restitution| Case::DamageLimited { restitution }));
    cases.extend(GOALS.map(|goal| Case::Destination { goal }));

    // The long cases first, so that both threads end together.
    let mut order: Vec<usize> = (0..cases.len()).collect();
    order.sort_by_key(|&k| !matches!(cases[k], Case::DamageLimited { .. }));
    let next = AtomicUsize::new(0);
    let results = Mutex::new((0..cases.len()).map(|_| None).collect::<Vec<_>>());
    let bars = Bars::new(cases.len());
    std::thread::scope(|scope| {
        for _ in 0..2 {
            scope.spawn(|| {
                let line = bars.line();
                while let Some(&k) = order.get(next.fetch_add(1, Ordering::Relaxed)) {
                    if interrupt.is_triggered() {
                        break;
                    }
                    let solved = solve(cases[k], interrupt, proofs, &line);
                    if let Ok(mut results) = results.lock() {
                        results[k] = Some(solved);
                    }
                    bars.done_one();
                }
            });
        }
    });
    bars.clear();
    let results = results.into_inner().unwrap_or_else(|poisoned| poisoned.into_inner());
    results.into_iter().flatten().collect()
}

fn solve(
    case: Case,
    interrupt: &Interrupt,
    proofs: Option<&Path>,
    line: &Line,
) -> Result<SolvedCase, Error> {
    let folder = |what: &str| proofs.map(|folder| folder.join(case.folder()).join(what));
    let mut solver = BranchAndBound::default();
    // For each solve, and once more for its log. Without a log, no solve comes near it.
    solver.options_mut().time_limit = proofs.map(|_| LOG_LIMIT);
    let paper = Scenario::paper();
    let (mut interval, mut without) = (None, None);
    let scenario = match case {
        Case::CollisionFree => paper.collision_free(),
        Case::CollisionTolerant { restitution } => paper.with_restitution(restitution)?,
        Case::DamageLimited { restitution } => {
            line.say(&format!("{}: which limits give {LIMITED_STEPS} steps?", case.label()));
            let open = paper.with_restitution(restitution)?;
            let options = DamageLimitOptions::default().with_interrupt(interrupt);
            let found = open.damage_limit_range(LIMITED_STEPS, &options, &mut solver)?;
            let limit = found.middle().unwrap_or(found.lower.attained);
            interval = Some(found);
            if limit.is_finite() {
                open.with_damage(DamageRule::default().with_per_hit(limit))
            } else {
                open // it was interrupted before it found a limit
            }
        }
        Case::Destination { goal } => {
            let there = paper.with_goal_position(goal);
            let label = format!("to {goal} m, no collision");
            solver.options_mut().proof = folder("no_collision");
            without =
                Some(search(&there.clone().collision_free(), label, interrupt, &mut solver, line)?);
            there
        }
    };
    solver.options_mut().proof = folder("");
    let shortest = search(&scenario, case.label(), interrupt, &mut solver, line)?;
    Ok(SolvedCase { case, scenario, shortest, interval, without })
}

/// The shortest plan; refuted and open horizons are shown on their own line.
fn search(
    scenario: &Scenario,
    label: String,
    interrupt: &Interrupt,
    solver: &mut dyn Solver,
    line: &Line,
) -> Result<ShortestHorizon<Plan>, Error> {
    let mut horizons = line.search(label, scenario.monotonicity().is_monotone());
    let options = ShortestOptions::default()
        .with_interrupt(interrupt)
        .with_progress(move |event| horizons.note(event));
    scenario.shortest_with(&options, solver)
}
