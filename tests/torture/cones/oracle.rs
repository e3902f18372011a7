//! The answer to a random program with cones by enumeration of its integers, and the verdict on a
//! solver's.
//!
//! Optima of cones are no fractions, so they are known up to the digits of Clarabel. Where an
//! answer differs by more than those, the program with every row and cone a little tighter decides:
//! a bound beyond *its* optimum, or a point that is worse, is wrong, and what lies between the two
//! is a matter of digits ([`Verdict::Borderline`]). Programs know a point that is feasible without
//! any tolerance, mostly, and that is asked first.

use carom::prelude::*;

use super::case::ConicCase;
use super::continuous::{Rest, least};
use crate::torture::oracle::{FEASIBILITY, Verdict};

/// By how much rows and cones are tightened, relative to their largest coefficient.
const TIGHTER: f64 = 1e-7;

/// By how much they are loosened for what a solver may take for a point.
const LOOSER: f64 = 2e-6;

/// The answer by enumeration, as a cost to minimise.
#[derive(Debug, Clone, Default)]
pub(crate) struct ConicTruth {
    pub(crate) least: Option<(f64, Vec<f64>)>,
    pub(crate) unbounded: bool,
    /// Whether some integers are not decided.
    pub(crate) unknown: bool,
}

/// Answers a program; with every row and cone tighter by `slack`.
pub(crate) fn truth(case: &ConicCase, slack: f64) -> ConicTruth {
    let mut x = vec![f64::NAN; case.base.columns.len()];
    case.parameters.iter().for_each(|&j| x[j] = case.base.columns[j].lower);
    let is_integral = |&j: &usize| case.base.columns[j].kind != VariableKind::Continuous;
    let integers: Vec<usize> = (0..x.len()).filter(is_integral).collect();
    let mut truth = ConicTruth::default();
    descend(case, &integers, &mut x, slack, &mut truth);
    truth
}

fn descend(
    case: &ConicCase,
    integers: &[usize],
    x: &mut Vec<f64>,
    slack: f64,
    truth: &mut ConicTruth,
) {
    let Some((&j, rest)) = integers.split_first() else {
        match least(case, x, slack) {
            Rest::Infeasible => {}
            Rest::Unbounded => truth.unbounded = true,
            Rest::Unknown => truth.unknown = true,
            Rest::Least(value, point) => {
                if truth.least.as_ref().is_none_or(|(old, _)| value < *old) {
                    truth.least = Some((value, point));
                }
            }
        }
        return;
    };
    let mut value = case.base.columns[j].lower.ceil();
    while value <= case.base.columns[j].upper {
        x[j] = value;
        descend(case, rest, x, slack, truth);
        value += 1.0;
    }
    x[j] = f64::NAN;
}

/// Judges an answer; `variables` are the model's, in the order of the columns.
pub(crate) fn judge(
    case: &ConicCase,
    variables: &[Variable],
    options: &Options,
    solution: &Solution,
    truth: &ConicTruth,
) -> Verdict {
    checked(case, variables, options, solution, truth).unwrap_or_else(|what| {
        let witness = case.witness.as_ref().map(|x| case.cost(x));
        let least = truth.least.as_ref().map(|least| least.0);
        let (unbounded, unknown) = (truth.unbounded, truth.unknown);
        Verdict::Wrong(format!(
            "{what}; the least cost is {least:?}, at a known point {witness:?}, unbounded: \
             {unbounded}, unknown: {unknown}"
        ))
    })
}

/// What costs may differ by where a point with that cost is known.
fn margin(case: &ConicCase, (value, point): (f64, &[f64])) -> f64 {
    1e-7 + 2e-6 * value.abs() + 1e-9 * case.cost_size(point)
}

/// The cost of a solution's point, if it has one and holds.
fn point_cost(
    case: &ConicCase,
    variables: &[Variable],
    solution: &Solution,
) -> Result<Option<f64>, String> {
    let Some(point) = solution.point() else { return Ok(None) };
    let x: Result<Vec<f64>, Error> = variables.iter().map(|&v| point.value(v)).collect();
    let x = x.map_err(|error| error.to_string())?;
    if let Some(violation) = case.violation(&x, FEASIBILITY) {
        return Err(violation);
    }
    let own = case.cost(&x);
    let theirs = solution.objective().map_or(f64::NAN, |objective| case.base.sign() * objective);
    let rounding = 1e-9 * case.cost_size(&x).max(1.0);
    let norms = case.norms.iter().map(|(weight, _)| FEASIBILITY * weight).sum::<f64>();
    let is_lower = case.norms.is_empty() && own < theirs - rounding;
    if theirs.is_nan() || own > theirs + norms + rounding || is_lower {
        return Err(format!("the objective of its point is {own}, not {theirs}"));
    }
    Ok(Some(theirs))
}

fn checked(
    case: &ConicCase,
    variables: &[Variable],
    options: &Options,
    solution: &Solution,
    truth: &ConicTruth,
) -> Result<Verdict, String> {
    let (sign, ended) = (case.base.sign(), solution.termination());
    if solution.statistics().contradictions > 0 {
        return Err("a rewriting of the program was contradicted".to_owned());
    }
    let cost = point_cost(case, variables, solution)?;
    let bound = sign * solution.bound();
    // Filled when it is needed.
    let tight = std::cell::OnceCell::new();
    let tight = || tight.get_or_init(|| self::truth(case, TIGHTER));
    let is_beyond = |claimed: f64, slack: f64| -> Result<bool, String> {
        let exceeds =
            |(value, x): (f64, &[f64])| claimed > value + slack + margin(case, (value, x));
        if let Some(witness) = &case.witness
            && exceeds((case.cost(witness), witness))
        {
            return Err(format!("{ended}, {claimed} is beyond a known point"));
        }
        let Some((value, x)) = &truth.least else { return Ok(false) };
        if !exceeds((*value, x)) {
            return Ok(false);
        }
        match &tight().least {
            Some((value, x)) if exceeds((*value, x)) => {
                Err(format!("{ended}, {claimed} is beyond the optimum"))
            }
            _ => Ok(true),
        }
    };
    let mut borderline = truth.unknown;
    if ended != Termination::Infeasible {
        borderline |= is_beyond(bound, 0.0)?;
    }
    let may_be_bounded = matches!(ended, Termination::Infeasible | Termination::Stalled);
    if truth.unbounded && bound > f64::NEG_INFINITY && !may_be_bounded {
        return Err(format!("{ended} with bound {bound}"));
    }
    match ended {
        Termination::Infeasible => {
            if case.witness.is_some() {
                return Err("infeasible in spite of a known point".to_owned());
            }
            if truth.unbounded || truth.least.is_some() {
                let tight = tight();
                if tight.unbounded || tight.least.is_some() {
                    return Err("infeasible in spite of a point inside".to_owned());
                }
                borderline = true;
            }
        }
        Termination::Unbounded if truth.unbounded => {}
        Termination::Unbounded if truth.unknown => borderline = true,
        Termination::Unbounded => {
            // As points are, it may be missed by the tolerance.
            let loose = self::truth(case, -LOOSER);
            if !loose.unbounded && !loose.unknown {
                return Err("unbounded".to_owned());
            }
            borderline = true;
        }
        Termination::Optimal => {
            let cost = cost.ok_or("optimal without a point")?;
            let gap = options.absolute_gap.max(options.relative_gap * cost.abs());
            if solution.gap() > gap {
                return Err(format!("optimal with gap {}", solution.gap()));
            }
            borderline |= truth.least.is_none() || is_beyond(cost, 1.01 * gap)?;
        }
        Termination::Stalled => {
            if truth.unbounded {
                return Ok(Verdict::Beyond);
            }
            return Ok(Verdict::Stalled(format!(
                "bound {bound}, point {cost:?}, after {} nodes; the least cost is {:?}, unknown: {}",
                solution.statistics().nodes,
                truth.least.as_ref().map(|least| least.0),
                truth.unknown,
            )));
        }
        ended if ended.is_limit() => {}
        ended => return Err(format!("{ended}, point {cost:?}, bound {bound}")),
    }
    Ok(if borderline { Verdict::Borderline } else { Verdict::Right })
}

/// Whether a program has no answer within the digits of doubles: cones that only touch have no
/// multipliers, so that a bound near the optimum has no proof, and what is feasible or best there
/// depends on the last digits of every row.
pub(crate) fn is_ill_posed(case: &ConicCase, truth: &ConicTruth) -> bool {
    let (Some((value, point)), false) = (&truth.least, truth.unknown) else { return true };
    let tight = self::truth(case, TIGHTER);
    let allowed = margin(case, (*value, point)) + 10.0 * TIGHTER * case.cost_size(point);
    tight.least.is_none_or(|(tight, _)| tight - value > allowed)
}
