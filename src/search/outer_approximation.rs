//! The outer approximation of cones at the root: rows that the relaxations of all nodes begin with.
//!
//! The root is solved as a conic program. The multipliers of its cones are the first cuts, and rounds of
//! relaxing and cutting off follow until the linear relaxation is as tight as the conic one. Where it does
//! not become so, or where that takes far longer, nodes are relaxed as conic programs.

use super::cone_pool::separate_cones;
use super::root::Root;
use crate::presolve::{FIXED, Reduced};
use crate::program::Program;
use crate::relaxation::{ConeCut, Ladder, Purpose, RelaxationQuestion, RelaxationVerdict};
use crate::solver::{Options, StopToken};
use web_time::Instant;

/// Most rounds.
const MAX_ROOT_ROUNDS: usize = 60;

/// Distance of the linear relaxation from the conic one, relative, at which rounds end, and up to which the
/// linear one is used.
const CLOSE: f64 = 1e-6;
const CLOSE_ENOUGH: f64 = 1e-3;

/// Largest time of all rounds, as a multiple of the time of the conic program, unless it is short (seconds).
const TIME_RATIO: f64 = 20.0;
const SHORT: f64 = 0.5;

/// The program whose relaxations cut off the cones, with the cuts of the root; `None` if its relaxations
/// are better solved with the cones.
pub(crate) fn approximate_cones(
    program: &Program,
    root: &Root,
    options: &Options,
    token: &StopToken,
    ladder: &mut Ladder,
) -> Option<Program> {
    if root.conflict.is_some() || program.integers.is_empty() {
        return None;
    }
    let mut reduced = ladder.reducer().reduce(program, &root.domain)?;
    let question = RelaxationQuestion {
        purpose: Purpose::Node,
        cutoff: f64::INFINITY,
        options,
        constant: program.constant,
        look_for_descent: false,
        token,
        warm: None,
    };
    let rows = reduced.rows.len();
    let began = Instant::now();
    let RelaxationVerdict::Relaxed { bound: conic, x, .. } = ladder.solve(&mut reduced, &question)
    else {
        return None;
    };
    let scale = conic.abs().max(1.0);
    let misses = reduced.objective(&x) - conic;
    if misses.is_nan() || misses > CLOSE_ENOUGH * scale {
        return None;
    }
    let time = began.elapsed().as_secs_f64();
    let mut rounds = Rounds { cuts: ladder.take_cone_cuts(), place: reduced.places(), rows };
    reduced.truncate_rows(rows);
    reduced.is_cut_off = true;
    let began = Instant::now();
    rounds.append(&mut reduced, 0);
    let (mut warm, mut last) = (None, f64::NEG_INFINITY);
    let mut active = Vec::new();
    for round in 0..MAX_ROOT_ROUNDS {
        let question = RelaxationQuestion { warm: warm.as_ref(), ..question };
        let verdict = ladder.solve(&mut reduced, &question);
        let RelaxationVerdict::Relaxed { x, warm: state, y, .. } = verdict else { break };
        last = reduced.objective(&x);
        active = y;
        let late = began.elapsed().as_secs_f64() > (TIME_RATIO * time).max(SHORT);
        if conic - last <= CLOSE * scale || late || token.is_over() || round + 1 == MAX_ROOT_ROUNDS
        {
            break;
        }
        let found = separate_cones(&reduced, &x);
        if found.is_empty() {
            break;
        }
        let known = rounds.cuts.len();
        rounds.cuts.extend(found);
        rounds.append(&mut reduced, known);
        warm = state;
    }
    if conic - last > CLOSE_ENOUGH * scale {
        return None;
    }
    rounds.program(program, &active)
}

/// The cuts of all rounds, which are the rows of the reduced program from `rows` on.
struct Rounds {
    cuts: Vec<ConeCut>,
    /// By column of the program, its column in the reduced one.
    place: Vec<usize>,
    rows: usize,
}

impl Rounds {
    /// Appends the cuts from one on to the reduced program.
    fn append(&self, reduced: &mut Reduced, from: usize) {
        // Names beyond those of the program's rows, so that rounds begin with the last basis.
        let first = reduced.origin.iter().copied().filter(|name| *name != FIXED).max();
        let first = first.map_or(0, |name| name + 1);
        for (k, cut) in self.cuts[from..].iter().enumerate() {
            reduced.append_row(&cut.terms, &self.place, first + k);
        }
    }

    /// The program with the cuts that are active.
    fn program(&self, program: &Program, y: &[f64]) -> Option<Program> {
        let is_active =
            |k: &usize| y.get(self.rows + k).is_none_or(|multiplier| *multiplier != 0.0);
        let cuts = (0..self.cuts.len()).filter(is_active).map(|k| &self.cuts[k]);
        let row = |cut: &ConeCut| (cut.terms.clone(), [f64::NEG_INFINITY, 0.0]);
        let rows: Vec<_> = cuts.map(row).collect();
        let mut approximated = program.clone();
        let cuts = program.row_count()..program.row_count() + rows.len();
        approximated.append(&[], &rows)?;
        approximated.cone_cuts = Some(cuts);
        Some(approximated)
    }
}
