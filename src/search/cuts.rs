//! Rounds of cuts at the root.
//!
//! The relaxation is solved, cuts that its point violates are added, and so on until the bound
//! stops moving. Cuts that press at the end stay in the tree's program, the others go.

use super::Task;
use super::tree::Tree;
use crate::presolve::{Domain, Reduction, reduce, separate_covers};
use crate::program::{Program, Row};
use crate::relaxation::{Claim, ClarabelRelaxation, Effort, Relaxation};

/// Most rounds.
const ROUNDS: usize = 20;

/// Rounds in a row that may move the objective by less than `GAIN`, relative.
const PATIENCE: usize = 3;
const GAIN: f64 = 1e-3;

/// Slack up to which a cut presses, in its own unit.
const PRESSES: f64 = 1e-4;

/// The program with cuts of its root.
pub(super) fn with_cuts(
    program: Program,
    domain: &Domain,
    task: &Task<'_>,
    tree: &Tree<'_>,
) -> Program {
    if task.nested || program.is_feasibility_problem() {
        return program;
    }
    let mut relaxation = ClarabelRelaxation::new();
    let mut cuts: Vec<Row> = Vec::new();
    let (mut extended, mut last, mut idle) = (None, f64::NEG_INFINITY, 0);
    for _ in 0..ROUNDS {
        // A first look at rows alone saves the relaxation where nothing can be cut.
        let now = extended.as_ref().unwrap_or(&program);
        if cuts.is_empty() && !has_knapsacks(&program, domain) {
            return program;
        }
        let Some((point, value)) = solve(now, domain, &mut relaxation, tree) else { break };
        idle = if value - last > GAIN * value.abs().max(1.0) { 0 } else { idle + 1 };
        last = value;
        let slack =
            |row: &Row| row.upper - row.terms.iter().map(|&(j, a)| a * point[j]).sum::<f64>();
        let before = cuts.len();
        cuts.retain(|row| slack(row) <= PRESSES);
        let fresh =
            if idle > PATIENCE { Vec::new() } else { separate_covers(&program, domain, &point) };
        let known = |row: &Row| cuts.contains(row);
        let fresh: Vec<Row> = fresh.into_iter().filter(|row| !known(row)).collect();
        let done = fresh.is_empty();
        cuts.extend(fresh);
        if !done || before != cuts.len() {
            extended = Some(program.with_rows(&cuts));
        }
        if done || tree.limit_reached().is_some() {
            break;
        }
    }
    extended.unwrap_or(program)
}

/// Whether some row has three binaries of different weight.
fn has_knapsacks(program: &Program, domain: &Domain) -> bool {
    (0..program.row_count()).any(|row| {
        let (columns, values) = program.row(row);
        let binary = |j: usize| program.integral[j] && domain.bounds(j) == [0.0, 1.0];
        let weights = columns.iter().zip(values).filter(|(j, _)| binary(**j));
        let mut weights = weights.map(|(_, a)| a.abs());
        let Some(first) = weights.next() else { return false };
        let (mut count, mut differ) = (1, false);
        for weight in weights {
            count += 1;
            differ |= weight != first;
        }
        count >= 3 && differ
    })
}

/// The relaxed point of the root and its objective.
fn solve(
    program: &Program,
    domain: &Domain,
    relaxation: &mut ClarabelRelaxation,
    tree: &Tree<'_>,
) -> Option<(Vec<f64>, f64)> {
    let Reduction::Reduced(reduced) = reduce(program, domain) else { return None };
    if reduced.columns.is_empty() {
        return None;
    }
    let effort = Effort {
        iterations: 60,
        tolerance: 1e-7,
        refinements: 1,
        cutoff: f64::INFINITY,
        time: tree.time_left(),
        interrupt: tree.interrupt().clone(),
    };
    let answer = relaxation.solve(&reduced, &effort);
    tree.count(|s| {
        s.relaxations += 1;
        s.iterations += answer.iterations;
    });
    (answer.claim == Claim::Solved).then(|| (reduced.lift(&answer.x), reduced.objective(&answer.x)))
}
