//! The outer approximation of cones at the root: rows that the relaxations of all nodes begin with.
//!
//! The root is solved as a conic program. The multipliers of its cones are the first cuts, and
//! rounds of relaxing and cutting off follow until the linear relaxation is as tight as the conic
//! one. Where it does not become so, or where that takes far longer, nodes are relaxed as conic
//! programs.

use super::cone_pool::separate_cones;
use super::root::Root;
use crate::presolve::{FIXED, Reduced};
use crate::program::Program;
use crate::relaxation::{ConeCut, MethodCascade, Purpose, RelaxationQuestion, RelaxationVerdict};
use crate::solver::{Options, StopToken};
use web_time::Instant;

/// Most rounds.
const MAX_ROOT_ROUNDS: usize = 60;

/// Relative distances of the linear relaxation from the conic one: rounds end at the first, and the
/// linear one is used up to the second.
const CLOSE: f64 = 1e-6;
const CLOSE_ENOUGH: f64 = 1e-3;

/// Largest time of all rounds, as a multiple of the time of the conic program, unless it is short
/// (seconds).
const TIME_RATIO: f64 = 20.0;
const SHORT: f64 = 0.5;

/// Most rounds that begin with the cuts of an earlier solve, and most of these.
const MAX_KEPT_ROUNDS: usize = 12;
const MAX_KEPT_CUTS: usize = 2000;

/// The outer approximation of the cones of a program.
#[derive(Debug)]
pub(crate) struct ConeApproximation {
    /// The program whose relaxations cut off the cones, and the cuts of the root; `None` if its
    /// relaxations are better solved with the cones.
    pub(crate) program: Option<(Program, Vec<ConeCut>)>,
    /// The best bound that a relaxation of the root has proved on the way; `-inf` if none has.
    pub(crate) bound: f64,
}

/// Approximates the cones of a program.
///
/// # Arguments
///
/// * `kept`: the cuts of an earlier solve of the program with other values of its parameters.
pub(crate) fn approximate_cones(
    program: &Program,
    root: &Root,
    options: &Options,
    token: &StopToken,
    cascade: &mut MethodCascade,
    kept: &[ConeCut],
) -> ConeApproximation {
    let mut bound = f64::NEG_INFINITY;
    let program = match root.conflict.is_some() || program.integers.is_empty() {
        true => None,
        false => approximate(program, root, options, token, cascade, kept, &mut bound),
    };
    ConeApproximation { program, bound }
}

/// The program with its cuts, as in [`ConeApproximation`]. Raises `proved` to what relaxations
/// prove.
fn approximate(
    program: &Program,
    root: &Root,
    options: &Options,
    token: &StopToken,
    cascade: &mut MethodCascade,
    kept: &[ConeCut],
    proved: &mut f64,
) -> Option<(Program, Vec<ConeCut>)> {
    let question = RelaxationQuestion {
        purpose: Purpose::Node,
        cutoff: f64::INFINITY,
        options,
        constant: program.constant,
        look_for_descent: false,
        token,
        warm: None,
    };
    if let Some(approximated) = approximate_from(kept, program, root, &question, cascade, proved) {
        return Some(approximated);
    }
    let mut reduced = cascade.reducer().reduce(program, &root.domain)?;
    let rows = reduced.rows.len();
    let began = Instant::now();
    let RelaxationVerdict::Relaxed { bound: conic, x, .. } = cascade.solve(&mut reduced, &question)
    else {
        return None;
    };
    *proved = proved.max(conic);
    let scale = conic.abs().max(1.0);
    let misses = reduced.objective(&x) - conic;
    if misses.is_nan() || misses > CLOSE_ENOUGH * scale {
        return None;
    }
    let time = began.elapsed().as_secs_f64();
    let mut rounds = Rounds { cuts: cascade.take_cone_cuts(), place: reduced.places(), rows };
    reduced.truncate_rows(rows);
    reduced.is_cut_off = true;
    let began = Instant::now();
    rounds.append(&mut reduced, 0);
    let (mut warm, mut last) = (None, f64::NEG_INFINITY);
    let mut active = Vec::new();
    for round in 0..MAX_ROOT_ROUNDS {
        let question = RelaxationQuestion { warm: warm.as_ref(), ..question };
        let verdict = cascade.solve(&mut reduced, &question);
        let RelaxationVerdict::Relaxed { bound, x, warm: state, y, .. } = verdict else { break };
        *proved = proved.max(bound);
        last = reduced.objective(&x);
        active = y;
        // A deterministic search must not depend on the clock.
        let late = !options.deterministic
            && began.elapsed().as_secs_f64() > (TIME_RATIO * time).max(SHORT);
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
    rounds.program(program, &active, 0)
}

/// The program with the cuts of an earlier solve, which hold for all values of its parameters, and
/// those of a few further rounds; `None` if these are not enough.
fn approximate_from(
    kept: &[ConeCut],
    program: &Program,
    root: &Root,
    question: &RelaxationQuestion<'_>,
    cascade: &mut MethodCascade,
    proved: &mut f64,
) -> Option<(Program, Vec<ConeCut>)> {
    if kept.is_empty() || kept.len() > MAX_KEPT_CUTS {
        return None;
    }
    let mut reduced = cascade.reducer().reduce(program, &root.domain)?;
    let (place, rows) = (reduced.places(), reduced.rows.len());
    let mut rounds = Rounds { cuts: kept.to_vec(), place, rows };
    reduced.is_cut_off = true;
    rounds.append(&mut reduced, 0);
    let (mut warm, mut last) = (None, f64::NEG_INFINITY);
    for _ in 0..MAX_KEPT_ROUNDS {
        let question = RelaxationQuestion { warm: warm.as_ref(), ..*question };
        let verdict = cascade.solve(&mut reduced, &question);
        let RelaxationVerdict::Relaxed { bound, x, warm: state, y, converged, .. } = verdict else {
            return None;
        };
        *proved = proved.max(bound);
        if !converged {
            return None;
        }
        let (value, found) = (reduced.objective(&x), separate_cones(&reduced, &x));
        if found.is_empty() || value - last <= CLOSE * value.abs().max(1.0) {
            return rounds.program(program, &y, kept.len());
        }
        let known = rounds.cuts.len();
        rounds.cuts.extend(found);
        rounds.append(&mut reduced, known);
        (warm, last) = (state, value);
    }
    None
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

    /// The program with the first cuts, so many, and those of the others that are active; and these
    /// cuts.
    fn program(
        &self,
        program: &Program,
        y: &[f64],
        first: usize,
    ) -> Option<(Program, Vec<ConeCut>)> {
        let is_active = |k: &usize| {
            *k < first || y.get(self.rows + k).is_none_or(|multiplier| *multiplier != 0.0)
        };
        let cuts = (0..self.cuts.len()).filter(is_active).map(|k| self.cuts[k].clone());
        let cuts: Vec<ConeCut> = cuts.collect();
        let row = |cut: &ConeCut| (cut.terms.clone(), [f64::NEG_INFINITY, 0.0]);
        let rows: Vec<_> = cuts.iter().map(row).collect();
        let mut approximated = program.clone();
        let range = program.row_count()..program.row_count() + rows.len();
        approximated.append(&[], &rows)?;
        approximated.cone_cuts = Some(range);
        Some((approximated, cuts))
    }
}
