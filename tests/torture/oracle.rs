//! The exact answer to a random program, and the verdict on a solver's.
//!
//! Every assignment of the integers that no row refutes by itself is tried, and the continuous
//! rest is solved over whole numbers; see [`Whole`].
//!
//! # What a solver may differ in
//!
//! Solvers promise points that miss a row by no more than a tolerance, and with coefficients from
//! 1e-4 to 1e5 such a point can be visibly better than the exact optimum, or exist where no exact
//! one does. So a claimed point is checked by the rows of the program as it was generated, within
//! the promised tolerance, and is then taken for what it is: its objective may be *better* than
//! the exact optimum, and a program may be called feasible because of it ([`Verdict::Borderline`]
//! counts the latter).
//!
//! The crate proves its bounds for points within [`FREE_RADIUS`] where nothing bounds a variable.
//! Where the exact answer lies beyond, a solve may end unfinished with a bound that holds within,
//! or may call a program unbounded whose objective turns only there ([`Verdict::Beyond`]); it may
//! not call such a program solved.
//!
//! Columns are floats, and a bound of one at 1e8 may be off by 1e-8: by as much as that makes of
//! the objective, answers may differ.
//!
//! Nothing else is forgiven: no claim of infeasibility where an exact point exists, no bound beyond
//! the exact optimum, no objective worse than it by more than the gap.

use carom::prelude::*;
use carom::tolerance::FREE_RADIUS;
use num_rational::BigRational;

use super::complementarity::{Answer, Whole, double};
use super::dyadic::Dyadic;
use crate::common::case::{Case, Line};

/// The tolerance that points are promised to keep, in the row's unit.
pub(crate) const FEASIBILITY: f64 = 1e-6;

/// The exact answer, as a cost to minimise.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Truth {
    Infeasible,
    Unbounded,
    Least { value: f64, point: Vec<f64> },
}

/// What a solver's answer is worth.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Verdict {
    Right,
    /// True of the points within [`FREE_RADIUS`], and the exact answer lies beyond it.
    Beyond,
    /// Feasible within the tolerance only.
    Borderline,
    /// The solver says itself that it could not finish.
    Stalled(String),
    Wrong(String),
}

/// Answers a program exactly.
pub(crate) fn truth(case: &Case) -> Truth {
    let mut x: Vec<f64> = vec![f64::NAN; case.columns.len()];
    let integers: Vec<usize> =
        (0..x.len()).filter(|&j| case.columns[j].kind != VariableKind::Continuous).collect();
    let mut best: Option<(BigRational, Vec<f64>)> = None;
    let unbounded = descend(case, &integers, &mut x, &mut best);
    match best {
        _ if unbounded => Truth::Unbounded,
        Some((value, point)) => Truth::Least { value: double(&value), point },
        None => Truth::Infeasible,
    }
}

/// Tries the values of the first integer of the list, and so on; `true` when unbounded.
fn descend(
    case: &Case,
    integers: &[usize],
    x: &mut Vec<f64>,
    best: &mut Option<(BigRational, Vec<f64>)>,
) -> bool {
    let switched = case.switches.iter().filter(|s| x[s.binary] == f64::from(u8::from(s.on)));
    let mut lines = case.lines.iter().chain(switched.map(|s| &s.line));
    if !lines.all(|line| may_hold(case, line, x)) {
        return false;
    }
    let Some((&j, rest)) = integers.split_first() else {
        return match least(case, x) {
            Answer::Infeasible => false,
            Answer::Unbounded => true,
            Answer::Least(value, continuous) => {
                if best.as_ref().is_none_or(|(old, _)| value < *old) {
                    let mut point = x.clone();
                    let open = point.iter_mut().filter(|x| x.is_nan());
                    open.zip(&continuous).for_each(|(x, value)| *x = double(value));
                    *best = Some((value, point));
                }
                false
            }
        };
    };
    let (mut value, upper) = range(case, j, x);
    while value <= upper {
        x[j] = value;
        if descend(case, rest, x, best) {
            return true;
        }
        value += 1.0;
    }
    x[j] = f64::NAN;
    false
}

/// The whole values of a column that no row excludes by itself; a little generous.
fn range(case: &Case, j: usize, x: &[f64]) -> (f64, f64) {
    let column = &case.columns[j];
    let (mut lower, mut upper) = (column.lower.ceil(), column.upper.floor());
    for line in case.lines.iter().filter(|line| line.coefficients[j] != 0.0) {
        let (mut least, mut most, mut size) = (0.0, 0.0, 1.0_f64);
        let others = line.coefficients.iter().enumerate();
        for (k, &a) in others.filter(|(k, a)| *k != j && **a != 0.0) {
            let column = &case.columns[k];
            let known = !x[k].is_nan();
            let (low, high) = if known { (x[k], x[k]) } else { (column.lower, column.upper) };
            let (p, q) = (a * low, a * high);
            (least, most) = (least + p.min(q), most + p.max(q));
            size = size.max(p.abs().max(q.abs()));
        }
        let a = line.coefficients[j];
        let (p, q) = ((line.lower - most) / a, (line.upper - least) / a);
        let slack = 1e-9 * size / a.abs() + 1e-3;
        if slack.is_finite() {
            lower = lower.max((p.min(q) - slack).ceil());
            upper = upper.min((p.max(q) + slack).floor());
        }
    }
    (lower, upper)
}

/// Whether a row can hold within the bounds of the columns without a value; a little generous.
fn may_hold(case: &Case, line: &Line, x: &[f64]) -> bool {
    let (mut least, mut most, mut size) = (0.0, 0.0, 1.0_f64);
    for (j, &a) in line.coefficients.iter().enumerate().filter(|(_, a)| **a != 0.0) {
        let column = &case.columns[j];
        let (low, high) = if x[j].is_nan() { (column.lower, column.upper) } else { (x[j], x[j]) };
        let (p, q) = (a * low, a * high);
        (least, most) = (least + p.min(q), most + p.max(q));
        size = size.max(p.abs().max(q.abs()));
    }
    let slack = 1e-9 * size;
    slack.is_infinite() || (least <= line.upper + slack && most >= line.lower - slack)
}

/// A continuous column as `offset + sum of factors times variables that are not negative`.
struct Substitution {
    offset: Dyadic,
    parts: Vec<(usize, Dyadic)>,
}

/// The continuous part of a case for fixed integers.
struct Continuous<'a> {
    case: &'a Case,
    /// The values of integers; NaN for continuous columns.
    x: &'a [f64],
    columns: Vec<usize>,
    substitutions: Vec<Substitution>,
    /// How many new variables there are.
    count: usize,
}

impl<'a> Continuous<'a> {
    fn new(case: &'a Case, x: &'a [f64]) -> Self {
        let one = Dyadic::of(1.0);
        let columns: Vec<usize> = (0..x.len()).filter(|&j| x[j].is_nan()).collect();
        let (mut substitutions, mut count) = (Vec::new(), 0);
        for &j in &columns {
            let column = &case.columns[j];
            let (offset, parts) = if column.lower.is_finite() {
                (Dyadic::of(column.lower), vec![(count, one)])
            } else if column.upper.is_finite() {
                (Dyadic::of(column.upper), vec![(count, -one)])
            } else {
                (Dyadic::ZERO, vec![(count, one), (count + 1, -one)])
            };
            count += parts.len();
            substitutions.push(Substitution { offset, parts });
        }
        Continuous { case, x, columns, substitutions, count }
    }

    /// `a'x + constant` as a constant and coefficients of the new variables.
    fn expand(&self, a: &[f64], constant: f64) -> (Dyadic, Vec<Dyadic>) {
        let (mut sum, mut terms) = (Dyadic::of(constant), vec![Dyadic::ZERO; self.count]);
        for (&a, &x) in a.iter().zip(self.x).filter(|(_, x)| !x.is_nan()) {
            sum = sum + Dyadic::of(a) * Dyadic::of(x);
        }
        for (&j, substitution) in self.columns.iter().zip(&self.substitutions) {
            let a = Dyadic::of(a[j]);
            sum = sum + a * substitution.offset;
            substitution.parts.iter().for_each(|&(k, factor)| terms[k] = terms[k] + a * factor);
        }
        (sum, terms)
    }

    /// The rows `terms >= -sum`, scaled to whole numbers; `None` if one without terms is violated.
    fn rows(&self) -> Option<Vec<(Vec<i128>, i128)>> {
        let negated = |terms: &[Dyadic]| -> Vec<Dyadic> { terms.iter().map(|&t| -t).collect() };
        let mut sides: Vec<(Dyadic, Vec<Dyadic>)> = Vec::new();
        let holds = |on: bool, binary: usize| self.x[binary] == f64::from(u8::from(on));
        let switched = self.case.switches.iter().filter(|s| holds(s.on, s.binary));
        for line in self.case.lines.iter().chain(switched.map(|s| &s.line)) {
            let (sum, terms) = self.expand(&line.coefficients, 0.0);
            if line.lower.is_finite() {
                sides.push((sum + -Dyadic::of(line.lower), terms.clone()));
            }
            if line.upper.is_finite() {
                sides.push((Dyadic::of(line.upper) + -sum, negated(&terms)));
            }
        }
        for &j in &self.columns {
            let column = &self.case.columns[j];
            if column.lower.is_finite() && column.upper.is_finite() {
                let mut unit = vec![0.0; self.x.len()];
                unit[j] = 1.0;
                let (sum, terms) = self.expand(&unit, 0.0);
                sides.push((Dyadic::of(column.upper) + -sum, negated(&terms)));
            }
        }
        let mut rows = Vec::new();
        for (sum, mut numbers) in sides {
            if numbers.iter().all(|term| term.sign() == 0) {
                if sum.sign() < 0 {
                    return None;
                }
                continue;
            }
            numbers.push(-sum);
            let (mut numbers, _) = Dyadic::whole(&numbers);
            let right = numbers.pop().unwrap_or(0);
            rows.push((numbers, right));
        }
        Some(rows)
    }

    /// The objective times one power of two: curvature, then cost, then the constant; and the
    /// power.
    fn objective(&self) -> (Vec<i128>, i32) {
        let count = self.count;
        let (mut constant, mut cost) = self.expand(&self.case.linear, self.case.constant);
        let mut curvature = vec![Dyadic::ZERO; count * count];
        for square in &self.case.squares {
            let weight = Dyadic::of(square.weight);
            let (b, a) = self.expand(&square.coefficients, square.constant);
            constant = constant + weight * b * b;
            for i in 0..count {
                cost[i] = cost[i] + Dyadic::of(2.0) * weight * a[i] * b;
                for j in 0..count {
                    let entry = &mut curvature[i * count + j];
                    *entry = *entry + Dyadic::of(2.0) * weight * a[i] * a[j];
                }
            }
        }
        let numbers: Vec<Dyadic> = curvature.into_iter().chain(cost).chain([constant]).collect();
        Dyadic::whole(&numbers)
    }

    /// The values of the continuous columns at a point of the new variables.
    fn values(&self, point: &[BigRational]) -> Vec<BigRational> {
        let exact = |number: Dyadic| {
            let (whole, exponent) = Dyadic::whole(&[number]);
            BigRational::new(whole[0].into(), (1_i128 << exponent.max(0)).into())
                * BigRational::from_integer((1_i128 << (-exponent).max(0)).into())
        };
        let value = |substitution: &Substitution| {
            let parts = substitution.parts.iter();
            let parts = parts.map(|&(k, factor)| exact(factor) * &point[k]);
            parts.fold(exact(substitution.offset), |sum, part| sum + part)
        };
        self.substitutions.iter().map(value).collect()
    }
}

/// The exact optimum for the integers of `x`, the values of the continuous columns in order.
fn least(case: &Case, x: &[f64]) -> Answer {
    let continuous = Continuous::new(case, x);
    let count = continuous.count;
    let Some(rows) = continuous.rows() else { return Answer::Infeasible };
    let (numbers, exponent) = continuous.objective();
    let curvature = numbers.chunks(count.max(1)).take(count).map(<[i128]>::to_vec).collect();
    let cost = numbers[count * count..count * count + count].to_vec();
    match (Whole { curvature, cost, rows }).solve() {
        Answer::Least(value, point) => {
            let whole = |value: i128| BigRational::from_integer(value.into());
            let constant = whole(numbers[numbers.len() - 1]);
            let power = if exponent >= 0 {
                whole(1_i128 << exponent)
            } else {
                whole(1) / whole(1_i128 << -exponent)
            };
            Answer::Least((value + constant) / power, continuous.values(&point))
        }
        other => other,
    }
}

/// Judges an answer; `variables` are the model's, in the order of the columns.
pub(crate) fn judge(
    case: &Case,
    variables: &[Variable],
    options: &Options,
    solution: &Solution,
    truth: &Truth,
) -> Verdict {
    if solution.statistics().contradictions > 0 {
        return Verdict::Wrong("a rewriting of the program was contradicted".to_owned());
    }
    let far = match truth {
        Truth::Unbounded => true,
        Truth::Least { point, .. } => point.iter().any(|x| x.abs() > FREE_RADIUS),
        Truth::Infeasible => false,
    };
    let what = match checked(case, variables, options, solution, truth) {
        // The exact answer is where nothing is proved.
        Ok(Verdict::Stalled(_)) if far => return Verdict::Beyond,
        Ok(verdict) => return verdict,
        Err(what) => what,
    };
    if far {
        let mut near = case.clone();
        for column in &mut near.columns {
            column.lower = column.lower.max(-FREE_RADIUS);
            column.upper = column.upper.min(FREE_RADIUS);
        }
        let bound = case.sign() * solution.bound();
        let Truth::Least { value, .. } = self::truth(&near) else {
            return Verdict::Wrong(format!("{what}; the exact answer is {truth:?}"));
        };
        let margin = 1e-9 * value.abs().max(1.0);
        let own = solution.objective().map_or(f64::INFINITY, |own| case.sign() * own);
        let gap = options.absolute_gap.max(options.relative_gap * own.abs());
        let ends = match solution.termination() {
            Termination::Stalled | Termination::Unbounded => true,
            // What a program gains beyond the radius may be less than the gap within it.
            Termination::Optimal => own <= value + 1.01 * gap + margin,
            _ => false,
        };
        if ends && bound <= value + margin {
            return Verdict::Beyond;
        }
    }
    Verdict::Wrong(format!("{what}; the exact answer is {truth:?}"))
}

fn checked(
    case: &Case,
    variables: &[Variable],
    options: &Options,
    solution: &Solution,
    truth: &Truth,
) -> Result<Verdict, String> {
    let (sign, ended) = (case.sign(), solution.termination());
    let mut cost = None;
    if let Some(point) = solution.point() {
        let x: Result<Vec<f64>, Error> = variables.iter().map(|&v| point.value(v)).collect();
        let x = x.map_err(|error| error.to_string())?;
        if let Some(violation) = case.violation(&x, FEASIBILITY) {
            return Err(violation);
        }
        let own = case.cost(&x);
        let theirs = solution.objective().map_or(f64::NAN, |objective| sign * objective);
        let terms = x.iter().zip(&case.linear).map(|(x, c)| (x * c).abs());
        let size = terms.chain([own.abs(), 1.0]).fold(0.0, f64::max);
        if (own - theirs).abs() > 1e-9 * size || theirs.is_nan() {
            return Err(format!("the objective of its point is {own}, not {theirs}"));
        }
        cost = Some(theirs);
    }
    let bound = sign * solution.bound();
    let margin = |value: f64, point: &[f64]| {
        let terms = point.iter().zip(&case.linear).map(|(x, c)| (x * c).abs());
        1e-9 * value.abs().max(1.0) + 4.0 * f64::EPSILON * terms.sum::<f64>()
    };
    match truth {
        Truth::Least { value, point } if bound > value + margin(*value, point) => {
            return Err(format!("{ended} with bound {bound} beyond the optimum"));
        }
        Truth::Unbounded if bound > f64::NEG_INFINITY => {
            return Err(format!("{ended} with bound {bound}"));
        }
        _ => {}
    }
    match (ended, truth) {
        (Termination::Infeasible, Truth::Infeasible) if cost.is_none() => Ok(Verdict::Right),
        (Termination::Unbounded, Truth::Unbounded) => Ok(Verdict::Right),
        (Termination::Optimal, Truth::Infeasible) if cost.is_some() => Ok(Verdict::Borderline),
        (Termination::Optimal, Truth::Least { value, point }) => {
            let cost = cost.ok_or("optimal without a point")?;
            let gap = options.absolute_gap.max(options.relative_gap * cost.abs());
            if solution.gap() > gap {
                return Err(format!("optimal with gap {}", solution.gap()));
            }
            if cost > value + 1.01 * gap + margin(*value, point) {
                return Err(format!("optimal at {cost}"));
            }
            Ok(Verdict::Right)
        }
        (Termination::Stalled, _) => Ok(Verdict::Stalled(format!(
            "bound {bound}, point {cost:?}, after {} nodes; the exact answer is {truth:?}",
            solution.statistics().nodes
        ))),
        (ended, _) if ended.is_limit() => Ok(Verdict::Right),
        (ended, _) => Err(format!("{ended}, point {cost:?}, bound {bound}")),
    }
}
