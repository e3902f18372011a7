//! The certificate of a robust plan: interval simulation of all disturbed runs at once.
//!
//! It follows the plan's transitions with boxes of errors, computed with outward rounding, and
//! checks every condition of the system over them. It takes the plan's numbers and transitions and
//! none of the program's half widths; transitions as affine functions (`step`) are those of
//! the rows. No sample is drawn. Domains, guards and ranges hold to the tolerances of nominal
//! certificates.

use super::feedback::Feedback;
use crate::error::{Condition, Error, RobustError};
use crate::hybrid::rows::HybridRun;
use crate::hybrid::simulate::{guard_condition, limit_condition};
use crate::hybrid::step::{self, AffineForm, ConditionMaps, StepCondition};
use crate::hybrid::system::{HybridSystem, Transition};
use crate::interval::Interval;
use crate::tolerance::{FEASIBILITY, REPLAY, margin_scale};

/// By how much a run may miss a condition, as in nominal certificates.
pub(super) const MISS: f64 = FEASIBILITY + REPLAY;

/// The findings of interval simulation about all disturbed runs of a plan.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct RobustCertificate {
    /// By how much each state may differ from the plan at the samples 0, ..., τ, in the states'
    /// units and order.
    pub states: Vec<Vec<Interval>>,
    /// The largest violation of a condition by any run, in its unit; 0 if none is violated.
    pub largest_violation: f64,
    /// By how much the tightest condition holds for every run, in its unit and at most 0 at a tie.
    pub least_slack: f64,
    /// The boxes of errors at the samples, along the feedback's directions.
    pub(super) errors: Vec<Vec<Interval>>,
}

type Intervals = Vec<Vec<Interval>>;

fn times(a: Interval, b: Interval) -> Interval {
    (a * b.lower).hull(a * b.upper)
}

fn point(value: f64) -> Interval {
    Interval::point(value)
}

fn dot(a: &[Interval], b: &[Interval]) -> Interval {
    a.iter().zip(b).fold(point(0.0), |sum, (a, b)| sum + times(*a, *b))
}

fn product(a: &[Vec<Interval>], b: &[Vec<Interval>]) -> Intervals {
    let columns = b.first().map_or(0, Vec::len);
    let column = |j: usize| b.iter().map(|row| row[j]).collect::<Vec<_>>();
    let columns: Intervals = (0..columns).map(column).collect();
    a.iter().map(|row| columns.iter().map(|column| dot(row, column)).collect()).collect()
}

fn exact(matrix: &faer::Mat<f64>) -> Intervals {
    let row = |i: usize| (0..matrix.ncols()).map(|j| point(matrix[(i, j)])).collect();
    (0..matrix.nrows()).map(row).collect()
}

/// Intervals that hold the inverse of a matrix, from an approximate one; `None` if that is too far
/// from it.
fn inverse(shape: &faer::Mat<f64>, approximate: &faer::Mat<f64>) -> Option<Intervals> {
    let mut all = exact(approximate);
    let rest = product(&all, &exact(shape));
    let miss = |(i, row): (usize, &Vec<Interval>)| {
        let miss = row
            .iter()
            .enumerate()
            .map(|(j, entry)| (*entry + point(if i == j { -1.0 } else { 0.0 })).magnitude());
        miss.fold(point(0.0), |sum, miss| sum + point(miss)).upper
    };
    let miss = rest.iter().enumerate().map(miss).fold(0.0, f64::max);
    // The Neumann series of the inverse of 1 + E, with |E| = miss in the row-sum norm.
    let far = (1.0 + 1e-9) * miss / (1.0 - miss);
    if !(0.0..0.5).contains(&far) {
        return None;
    }
    for j in 0..all.len() {
        let most = all.iter().map(|row| row[j].magnitude()).fold(0.0, f64::max);
        let by = point(far) * most;
        all.iter_mut().for_each(|row| row[j] = row[j] + (-by).hull(by));
    }
    Some(all)
}

/// Refuses a scale that turns ranges around or is no number.
fn check_scale(scale: f64) -> Result<(), Error> {
    match scale.is_finite() && scale >= 0.0 {
        true => Ok(()),
        false => Err(Error::out_of_range("the scale of the ranges", scale, 0.0..f64::INFINITY)),
    }
}

/// A plan in numbers, and the boxes of its errors.
struct Flight<'a> {
    system: &'a HybridSystem,
    /// T, and the matrix that turns the error e into the error of the state and then of the input.
    both: Intervals,
    inverse: Intervals,
    certificate: RobustCertificate,
    /// The factor of all disturbances.
    scale: f64,
}

/// Simulates all runs of a plan whose disturbances and errors of the start lie within `scale` times
/// their ranges.
pub(super) fn certify(
    system: &HybridSystem,
    run: &HybridRun,
    feedback: &Feedback,
    start: &[Interval],
    scale: f64,
) -> Result<RobustCertificate, Error> {
    check_scale(scale)?;
    let n = system.states.len();
    let shape = exact(&feedback.shape);
    let fed = product(&exact(feedback.gain().faer()), &shape);
    let Some(inverse) = inverse(&feedback.shape, &feedback.inverse) else {
        let help = "give the feedback a gain with smaller entries";
        let statement = "the tube of the feedback".to_owned();
        return Err(RobustError::Statement { statement, kind: "too flat", help }.into());
    };
    let off: Vec<Interval> = start.iter().map(|range| *range * scale).collect();
    let certificate = RobustCertificate {
        states: Vec::new(),
        largest_violation: 0.0,
        least_slack: f64::INFINITY,
        errors: vec![inverse.iter().map(|row| dot(row, &off)).collect()],
    };
    let both = [&shape[..], &fed].concat();
    let mut flight = Flight { system, both, inverse, certificate, scale };
    let series = |values: Vec<&[f64]>, t: usize| -> Vec<f64> {
        values.iter().filter_map(|values| values.get(t)).copied().collect()
    };
    let states = system.states.iter().map(|(name, _)| run.state(name));
    let states = states.collect::<Result<Vec<&[f64]>, Error>>()?;
    let inputs = system.inputs.iter().map(|(name, _)| run.input(name));
    let inputs = inputs.collect::<Result<Vec<&[f64]>, Error>>()?;
    let mut taken = Vec::new();
    for choice in &system.choices {
        let by_name = |name: &String| choice.transitions.iter().find(|own| own.name == *name);
        taken.push(run.transitions(&choice.name)?.iter().filter_map(by_name).collect::<Vec<_>>());
    }
    let steps = taken.first().map_or(0, Vec::len);
    for t in 0..steps {
        let start = [series(states.clone(), t), series(inputs.clone(), t)].concat();
        let next = series(states.clone(), t + 1);
        let members = taken.iter().filter_map(|own| own.get(t)).copied().collect::<Vec<_>>();
        flight.sample(t, &start[..n])?;
        flight.conditions(t, &start, &members)?;
        flight.advance(t, &start, &members, &next);
    }
    flight.sample(steps, &series(states, steps))?;
    Ok(flight.certificate)
}

impl Flight<'_> {
    fn width(&self) -> usize {
        self.both.len()
    }

    /// The factors of the error e in a map.
    fn factors(&self, map: &AffineForm) -> Vec<Interval> {
        let row: Vec<Interval> = map.factors.iter().map(|factor| point(*factor)).collect();
        product(&[row], &self.both).swap_remove(0)
    }

    fn errors(&self) -> &[Interval] {
        self.certificate.errors.last().map_or(&[], Vec::as_slice)
    }

    /// The values of a map over all runs.
    fn over(&self, map: &AffineForm, start: &[f64]) -> Interval {
        let at: Vec<Interval> = start.iter().map(|value| point(*value)).collect();
        map.over(&at) + dot(&self.factors(map), self.errors())
    }

    /// The values of maps of states over all runs, along the directions of the errors: what one
    /// parameter adds to all states is added up before its magnitude is taken.
    fn along_directions(&self, maps: &[AffineForm], start: &[f64]) -> Vec<Interval> {
        let at: Vec<Interval> = start.iter().map(|value| point(*value)).collect();
        let factors: Intervals = maps
            .iter()
            .map(|map| map.factors.iter().map(|factor| point(*factor)).collect())
            .collect();
        let constants: Vec<Interval> = maps.iter().map(|map| point(map.constant)).collect();
        let factors = product(&self.inverse, &factors);
        let of_errors = product(&factors, &self.both);
        let value =
            |((factors, of_errors), inverse): ((&Vec<Interval>, &Vec<Interval>), &Vec<_>)| {
                dot(factors, &at) + dot(of_errors, self.errors()) + dot(inverse, &constants)
            };
        factors.iter().zip(&of_errors).zip(&self.inverse).map(value).collect()
    }

    /// Notes by how much a value of all runs is above 0, and refuses more than a tolerance.
    fn check_nonpositive(
        &mut self,
        step: usize,
        condition: Condition,
        value: f64,
        size: f64,
    ) -> Result<(), Error> {
        self.certificate.least_slack = self.certificate.least_slack.min(-value);
        // NaN fails as well.
        if value <= MISS * margin_scale(size, 0.0) {
            self.certificate.largest_violation = self.certificate.largest_violation.max(value);
            return Ok(());
        }
        Err(RobustError::Condition { step, condition, violation: value }.into())
    }

    fn excess(
        &mut self,
        step: usize,
        condition: Condition,
        map: &AffineForm,
        start: &[f64],
    ) -> Result<(), Error> {
        let terms = map.factors.iter().zip(start).map(|(a, x)| (a * x).abs());
        let size = terms.fold(map.constant.abs(), f64::max);
        let value = self.over(map, start).upper;
        self.check_nonpositive(step, condition, value, size)
    }

    fn norm(
        &mut self,
        step: usize,
        condition: Condition,
        maps: (&[AffineForm], &AffineForm),
        start: &[f64],
    ) -> Result<(), Error> {
        let entries: Vec<Interval> = maps.0.iter().map(|map| self.over(map, start)).collect();
        let bound = self.over(maps.1, start);
        let squares = entries
            .iter()
            .fold(point(0.0), |sum, entry| sum + point(entry.magnitude()) * entry.magnitude());
        let length = squares.upper.sqrt().next_up();
        let value = (point(length) + -point(bound.lower)).upper;
        self.check_nonpositive(step, condition, value, length)
    }

    /// A condition of the system or of a transition.
    fn condition(
        &mut self,
        step: usize,
        condition: Condition,
        own: StepCondition<'_>,
        predicted: &[AffineForm],
        start: &[f64],
    ) -> Result<(), Error> {
        match own.maps(predicted, self.width(), step) {
            None => Ok(()),
            Some(ConditionMaps::HalfSpace(map)) => self.excess(step, condition, &map, start),
            Some(ConditionMaps::Norm { entries, bound }) => {
                self.norm(step, condition, (&entries, &bound), start)
            }
        }
    }

    /// The conditions of a sample, and the box of its states.
    fn sample(&mut self, sample: usize, state: &[f64]) -> Result<(), Error> {
        let (system, width) = (self.system, self.width());
        let n = state.len();
        let shape = &self.both[..n];
        let errors = shape.iter().map(|row| dot(row, self.errors())).collect::<Vec<_>>();
        for ((name, domain), (value, error)) in system.states.iter().zip(state.iter().zip(&errors))
        {
            let value = point(*value) + *error;
            let above = (value + point(-domain.upper)).upper;
            let beyond = above.max((point(domain.lower) + -value).upper);
            let condition = Condition::Domain { state: name.clone() };
            self.check_nonpositive(sample, condition, beyond, domain.magnitude())?;
        }
        self.certificate.states.push(errors);
        let mut start = state.to_vec();
        start.resize(width, 0.0);
        for limit in system.limits_of(false) {
            self.condition(sample, limit_condition(limit), limit, &[], &start)?;
        }
        Ok(())
    }

    /// The conditions of a step: limits, guards and ranges of the transitions that are taken.
    fn conditions(
        &mut self,
        step: usize,
        start: &[f64],
        taken: &[&Transition],
    ) -> Result<(), Error> {
        let (system, width, n) = (self.system, self.width(), self.inverse.len());
        for limit in system.limits_of(true) {
            self.condition(step, limit_condition(limit), limit, &[], start)?;
        }
        for (u, (name, _)) in system.inputs.iter().enumerate() {
            let range = system.input_range_of(taken, u, step);
            let mut map = AffineForm::constant(width, -range.upper);
            map.factors[n + u] = 1.0;
            let condition = Condition::InputRange { input: name.clone() };
            self.excess(step, condition.clone(), &map, start)?;
            let mut map = AffineForm::constant(width, range.lower);
            map.factors[n + u] = -1.0;
            self.excess(step, condition, &map, start)?;
        }
        for transition in taken {
            let flow = step::flow(&transition.flow);
            for own in transition.conditions() {
                self.condition(step, guard_condition(own), own, &flow, start)?;
            }
        }
        Ok(())
    }

    /// The box of errors after a step: the closed loop of the transitions, the disturbance, the
    /// spread of uncertain parameters, and what the plan's next sample is off.
    fn advance(&mut self, step: usize, start: &[f64], taken: &[&Transition], next: &[f64]) {
        let (n, width) = (next.len(), self.width());
        let dynamics: Vec<Vec<AffineForm>> = taken
            .iter()
            .map(|own| step::dynamics(self.system, own, &[], Vec::new(), step).next)
            .collect();
        let common = self.system.flow.as_ref().map(step::flow);
        let parts: Vec<&[AffineForm]> = dynamics.iter().map(Vec::as_slice).collect();
        let maps = step::sum(common.as_deref(), &parts);
        // In the states' own directions: the closed loop, and what does not depend on the error.
        let mut closed: Intervals = maps.iter().map(|map| self.factors(map)).collect();
        let added: Vec<Interval> = (0..n)
            .map(|i| {
                let at: Vec<Interval> = start.iter().map(|value| point(*value)).collect();
                // Sums of maps are rounded.
                let off = maps[i].over(&at) + point(-next[i]);
                let size =
                    maps[i].magnitudes().at(&start.iter().map(|x| x.abs()).collect::<Vec<_>>());
                let by = self.system.disturbance.get(i).copied().unwrap_or(point(0.0));
                off + by * self.scale + Interval::new(-1e-15 * size, 1e-15 * size)
            })
            .collect();
        for row in &mut closed {
            row.iter_mut().for_each(|entry| {
                let by = 1e-15 * entry.magnitude();
                *entry = *entry + Interval::new(-by, by);
            });
        }
        let mut spread = vec![point(0.0); n];
        for own in taken {
            let flow = step::flow(&own.flow);
            for parameter in &own.uncertain {
                let range = parameter.range * self.scale;
                let effect = |i: usize| {
                    let offset = parameter.effect.offset.get(step);
                    let offset = offset.and_then(|offset| offset.get(i)).copied().unwrap_or(0.0);
                    let factors = (0..n).map(|j| parameter.effect.matrix[(i, j)]);
                    step::combine(factors, &flow, width, offset)
                };
                let effect: Vec<AffineForm> = (0..n).map(effect).collect();
                for (spread, value) in spread.iter_mut().zip(self.along_directions(&effect, start))
                {
                    *spread = *spread + times(value, range);
                }
            }
        }
        let closed = product(&self.inverse, &closed);
        let errors = self.errors();
        let all = closed.iter().zip(&self.inverse).zip(&spread);
        let after = all
            .map(|((row, inverse), spread)| dot(row, errors) + dot(inverse, &added) + *spread)
            .collect();
        self.certificate.errors.push(after);
    }
}
