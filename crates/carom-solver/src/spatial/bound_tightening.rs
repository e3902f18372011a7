//! Bounds from relaxations: the range of a column over the relaxation of the root, and bounds from
//! reduced costs at nodes.

use super::program::SpatialProgram;
use super::propagation::{EmptyDomain, propagate};
use super::relaxation::{BoxRelaxer, RelaxedBox};
use crate::presolve::{Domain, Propagator};
use crate::relaxation::{MethodCascade, Purpose, RelaxationQuestion, RelaxationVerdict, WarmState};

/// Most passes over all columns.
const PASSES: usize = 3;

/// The least part of its range that a column has to lose in a pass for another pass.
const LEAST_PASS_GAIN: f64 = 0.1;

/// The pivots that all passes may take, at least, and as a multiple of those of the root.
const LEAST_PIVOTS: u64 = 3000;
const PIVOTS: u64 = 40;

/// The rounding that a bound from reduced costs allows for, relative (no unit).
const ROUNDING: f64 = 1e-9;

/// Minimises and maximises each column that enclosures depend on over the relaxation of a domain
/// (optimality-based bound tightening; Gleixner, Berthold, Müller and Weltge 2017).
///
/// # Arguments
///
/// * `x`: the relaxed point, which tells the columns whose terms are off.
pub(super) fn tighten_by_relaxations(
    relaxer: &BoxRelaxer<'_>,
    cascade: &mut MethodCascade,
    propagator: &mut Propagator,
    domain: &mut Domain,
    (cutoff, x): (f64, Option<&[f64]>),
) -> Result<(), EmptyDomain> {
    let columns = columns_in_question(relaxer.program, x);
    let most = cascade.iterations().saturating_mul(PIVOTS).max(LEAST_PIVOTS);
    let most = cascade.iterations() + most;
    let mut warm = None;
    for _ in 0..PASSES {
        let mut gains = false;
        for (&column, is_upper) in columns.iter().flat_map(|j| [(j, false), (j, true)]) {
            let [lower, upper] = domain.bounds(column);
            let width = upper - lower;
            if relaxer.token.is_over() || cascade.iterations() > most {
                return Ok(());
            }
            if width <= 1e-6 * lower.abs().max(1.0) {
                continue;
            }
            let goal = (column, is_upper, cutoff);
            let bound = match extreme(relaxer, cascade, domain, goal, &mut warm)? {
                Some(bound) if bound.is_finite() && bound.abs() <= 1e15 => bound,
                _ => continue,
            };
            let gain = if is_upper { upper + bound } else { bound - lower };
            let least = 0.02 * width.min(1e20);
            if gain.is_nan() || gain <= least {
                continue;
            }
            gains |= gain > LEAST_PASS_GAIN * width.min(1e20);
            let mark = domain.mark();
            let mut value = if is_upper { -bound } else { bound };
            if relaxer.program.program.integral[column] {
                value = if is_upper { (value + 1e-6).floor() } else { (value - 1e-6).ceil() };
            }
            domain.apply(column, is_upper, value);
            if domain.lower(column) > domain.upper(column) {
                // By rounding only, if by little.
                let own = [lower, upper][usize::from(!is_upper)];
                if (value - own).abs() > 1e-7 * own.abs().max(1.0) {
                    return Err(EmptyDomain);
                }
                domain.apply(column, is_upper, own);
            }
            propagate(relaxer.program, propagator, domain, Some(mark))?;
        }
        if !gains {
            break;
        }
    }
    Ok(())
}

/// The columns whose terms are off, those with the largest misses first.
fn columns_in_question(program: &SpatialProgram, x: Option<&[f64]>) -> Vec<usize> {
    let Some(x) = x else { return program.spatial.clone() };
    let off = program.misses(x);
    let mut columns: Vec<usize> = (0..off.len()).filter(|&j| off[j] > 1e-7).collect();
    columns.sort_by(|&a, &b| off[b].total_cmp(&off[a]).then(a.cmp(&b)));
    columns
}

/// A lower bound on a column over the relaxation of a domain, or on its negative; `None` if nothing
/// is proved.
fn extreme(
    relaxer: &BoxRelaxer<'_>,
    cascade: &mut MethodCascade,
    domain: &Domain,
    (column, is_upper, cutoff): (usize, bool, f64),
    warm: &mut Option<WarmState>,
) -> Result<Option<f64>, EmptyDomain> {
    let program = &relaxer.program.program;
    let (mut reduced, _) = relaxer.enclosed(domain, None);
    if cutoff.is_finite() && program.quadratic.compute_nnz() == 0 {
        let costs = program.linear.iter().copied().enumerate();
        reduced.rows.push(costs.filter(|(_, q)| *q != 0.0));
        reduced.row_lower.push(f64::NEG_INFINITY);
        reduced.row_upper.push((cutoff - program.offset).next_up());
        reduced.origin.push(usize::MAX);
    }
    reduced.linear.fill(0.0);
    reduced.linear[column] = if is_upper { -1.0 } else { 1.0 };
    reduced.offset = 0.0;
    reduced.quadratic.index.clear();
    reduced.quadratic.value.clear();
    reduced.quadratic.start.fill(0);
    let question = RelaxationQuestion {
        // Without a basis, the simplex method solves roots only.
        purpose: if warm.is_some() { Purpose::Node } else { Purpose::Root },
        cutoff: f64::INFINITY,
        options: relaxer.options,
        constant: 0.0,
        look_for_descent: false,
        token: relaxer.token,
        warm: warm.as_ref(),
    };
    match cascade.solve(&mut reduced, &question) {
        RelaxationVerdict::Refuted(_) => Err(EmptyDomain),
        RelaxationVerdict::Relaxed { bound, warm: state, .. } => {
            *warm = state.or(warm.take());
            Ok(Some(bound))
        }
        _ => Ok(None),
    }
}

/// Removes values of columns that would take the objective beyond the cutoff, given the multipliers
/// of a relaxation. Whether something moved.
pub(super) fn tighten_by_reduced_costs(
    program: &SpatialProgram,
    cascade: &mut MethodCascade,
    relaxed: &RelaxedBox,
    domain: &mut Domain,
    cutoff: f64,
) -> bool {
    let reduced = &relaxed.reduced;
    if cutoff == f64::INFINITY || relaxed.y.len() != reduced.rows.len() {
        return false;
    }
    let prover = cascade.prover();
    let (bound, slopes) = prover.reduced_costs(reduced, &relaxed.reduced_x, &relaxed.y);
    let room = (cutoff - bound) + ROUNDING * cutoff.abs().max(1.0);
    if !(room.is_finite() && room >= 0.0) {
        return false;
    }
    let mut moves = false;
    for (column, &slope) in slopes.iter().enumerate().filter(|(_, slope)| **slope != 0.0) {
        let [lower, upper] = domain.bounds(column);
        let reach = (room / slope.abs()) * (1.0 + ROUNDING);
        let is_upper = slope > 0.0;
        let mut value = if is_upper { lower + reach } else { upper - reach };
        if program.program.integral[column] {
            value = if is_upper { (value + 1e-6).floor() } else { (value - 1e-6).ceil() };
        }
        let gain = if is_upper { upper - value } else { value - lower };
        let least = 0.05 * (upper - lower).min(1e20);
        if value.is_finite() && gain > least && gain > 0.0 && value >= lower && value <= upper {
            domain.apply(column, is_upper, value);
            moves = true;
        }
    }
    moves
}
