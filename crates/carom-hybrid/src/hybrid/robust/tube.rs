//! The tube around a plan as rows: by how much runs may differ from it at each sample, and what
//! that takes of the limits.
//!
//! Errors are `x - z = T e`. At each sample e lies in a box whose half widths r are variables,
//! because how an error grows depends on the transitions: `r⁺ >= |T⁻¹ M T| r + w`, where M is the
//! closed loop of the transitions that are taken and w the disturbance, with the spread of
//! uncertain parameters.

use std::collections::BTreeSet;

use super::feedback::{Feedback, disturbance};
use super::words::GROWTH;
use crate::error::Error;
use crate::hybrid::rows::{SystemVariables, expression};
use crate::hybrid::step::{self, AffineForm, ConditionMaps, StepCondition};
use crate::hybrid::system::Transition;
use crate::interval::Interval;
use crate::model::{Affine, ConicRow, Family, Literal, Logic, Model, Row, norm};

/// Factors below this count as 0: they are rounding of factors that cancel.
const ZERO: f64 = 1e-13;

/// The unknown part of a transition's effect on one entry of the next error.
struct Spread {
    /// A function of the start of the step.
    map: AffineForm,
    /// The largest magnitude of the parameter.
    most: f64,
}

/// How the next error's entries follow under one transition, where it differs from the common flow.
struct ErrorChange {
    choice: usize,
    transition: usize,
    /// By entry: the factors of the error, and the spreads.
    entries: Vec<(Vec<f64>, Vec<Spread>)>,
}

/// The half widths of a tube, and what they say about a map.
pub(super) struct ErrorTube<'a> {
    pub(super) own: &'a SystemVariables,
    pub(super) feedback: &'a Feedback,
    /// r, by entry of the error, at the samples.
    pub(super) radius: Vec<Family>,
    /// The first sample at which runs differ.
    pub(super) first: usize,
}

impl<'a> ErrorTube<'a> {
    /// Adds the half widths, how they grow, and the tightened conditions of the system.
    ///
    /// # Arguments
    ///
    /// * `start`: by how much each state may be off at the first sample, if that is not known
    ///   exactly.
    pub(super) fn write(
        model: &mut Model,
        own: &'a SystemVariables,
        feedback: &'a Feedback,
        start: Option<&Vec<f64>>,
    ) -> Result<Self, Error> {
        let (system, steps) = (own.computed(), own.horizon().steps());
        let by = feedback.spread(&disturbance(system));
        let start = start.map(|start| feedback.spread(start));
        let first = usize::from(start.is_none());
        let mut radius = Vec::new();
        for (k, by) in by.iter().enumerate() {
            let start = start.as_ref().map_or(0.0, |start| start[k]);
            // A tube that is wider leaves a domain.
            let widths = system.states.iter().enumerate().map(|(i, (_, domain))| {
                let factor = feedback.shape[(i, k)].abs();
                if factor > ZERO { 0.5 * domain.width() / factor } else { f64::INFINITY }
            });
            let most = widths.fold(f64::INFINITY, f64::min);
            let name = format!("tube_{k}");
            let member = |t: usize| {
                let (least, most) = if t == 0 { (start, start) } else { (by.min(most), most) };
                model.continuous((name.as_str(), t), least, most)
            };
            radius.push((0..=steps).map(member).collect::<Result<Family, Error>>()?);
        }
        let tube = ErrorTube { own, feedback, radius, first };
        for t in 0..steps {
            tube.grow(model, t)?;
            tube.sample(model, t + 1)?;
            if t >= first {
                tube.step(model, t)?;
            }
        }
        if first == 0 {
            tube.sample(model, 0)?;
        }
        tube.describe(model);
        Ok(tube)
    }

    /// Half the width of a map whose factors of the error are given, at a sample.
    pub(super) fn width(&self, factors: &[f64], sample: usize) -> Affine {
        let mut sum = Affine::zero();
        for (factor, family) in factors.iter().zip(&self.radius) {
            let radius = family.get(sample);
            let radius = radius.filter(|_| factor.abs() > ZERO && sample >= self.first);
            if let Some(radius) = radius {
                sum.add_term(factor.abs(), radius);
            }
        }
        sum
    }

    fn width_of(&self, map: &AffineForm, sample: usize) -> Affine {
        self.width(&self.feedback.closed(map), sample)
    }

    /// The rows of the next half widths.
    fn grow(&self, model: &mut Model, step: usize) -> Result<(), Error> {
        let (system, n) = (self.own.computed(), self.radius.len());
        let width = n + system.inputs.len();
        let by = self.feedback.spread(&disturbance(system));
        let by_choice: Vec<_> =
            (0..system.choices.len()).map(|c| self.own.dynamics(c, step)).collect();
        let common = match system.flow.as_ref() {
            Some(flow) => step::flow(flow),
            None => by_choice[0][0].next.clone(),
        };
        let closed = |maps: &[AffineForm]| -> Vec<Vec<f64>> {
            let errors = self.feedback.errors(maps, width);
            errors.iter().map(|map| self.feedback.closed(map)).collect()
        };
        let base = closed(&common);
        let mut changes = Vec::new();
        for (c, own) in by_choice.iter().enumerate() {
            for (j, dynamics) in own.iter().enumerate() {
                let transition = &system.choices[c].transitions[j];
                let factors = closed(&dynamics.next);
                let spreads = self.spreads(transition, step);
                let entries = factors.into_iter().zip(spreads).collect();
                changes.push(ErrorChange { choice: c, transition: j, entries });
            }
        }
        for k in 0..n {
            let Some(next) = self.radius[k].get(step + 1) else { continue };
            let differs = |change: &&ErrorChange| {
                let (factors, spreads) = &change.entries[k];
                let apart = factors.iter().zip(&base[k]).any(|(a, b)| (a - b).abs() > ZERO);
                apart || !spreads.is_empty()
            };
            let differing: Vec<&ErrorChange> = changes.iter().filter(differs).collect();
            let least = Affine::constant(by[k]);
            let name = format!("tube_grows_{k}");
            let literal = |change: &&ErrorChange| -> Option<Literal> {
                self.own.literal(change.choice, change.transition, step)
            };
            let literals: Option<Vec<Literal>> = differing.iter().map(literal).collect();
            let all = system.choices.iter().map(|own| own.transitions.len()).sum::<usize>();
            if let Some(literals) = literals.filter(|literals| literals.len() < all) {
                let row = next.ge(self.width(&base[k], step) + least.clone());
                match literals.is_empty() {
                    true => model.add((name.as_str(), step), row).map(drop)?,
                    false => {
                        let none = !Logic::any(literals);
                        model.add((name.as_str(), step), none.implies(row)).map(drop)?;
                    }
                }
                model.describe(&name, GROWTH.to_owned());
            }
            for change in &differing {
                let (factors, spreads) = &change.entries[k];
                let when = literal(change);
                for signs in 0..1_usize << spreads.len() {
                    let mut right = self.width(factors, step) + least.clone();
                    for (p, Spread { map, most }) in spreads.iter().enumerate() {
                        let sign = if signs >> p & 1 == 0 { 1.0 } else { -1.0 };
                        right += sign * *most * expression(self.own, map, step);
                        right += *most * self.width_of(map, step);
                    }
                    let name = format!("{name}_{}_{}_{signs}", change.choice, change.transition);
                    add(model, &name, step, when, next.ge(right))?;
                    model.describe(&name, GROWTH.to_owned());
                }
            }
            let of: BTreeSet<usize> = differing.iter().map(|change| change.choice).collect();
            if of.len() > 1 {
                // What two changes do together is not the sum of what they do.
                let taken = differing.iter();
                let taken = taken.map(|own| self.own.taken_value(own.choice, own.transition, step));
                let name = format!("tube_one_change_{k}");
                model.add((name.as_str(), step), taken.sum::<Affine>().le(1.0))?;
                let words = "that one choice at a time changes how the tube grows";
                model.describe(&name, words.to_owned());
            }
        }
        Ok(())
    }

    /// The unknown part of a transition's effect, by entry of the next error.
    fn spreads(&self, transition: &Transition, step: usize) -> Vec<Vec<Spread>> {
        let (n, flow) = (self.radius.len(), step::flow(&transition.flow));
        let width = n + self.own.computed().inputs.len();
        let mut by_entry: Vec<Vec<Spread>> = (0..n).map(|_| Vec::new()).collect();
        for own in transition.uncertain.iter().filter(|own| own.range.magnitude() > 0.0) {
            let map = |i: usize| {
                let offset = own.effect.offset.get(step).and_then(|offset| offset.get(i)).copied();
                let factors = (0..n).map(|j| own.effect.matrix[(i, j)]);
                step::combine(factors, &flow, width, offset.unwrap_or(0.0))
            };
            let maps: Vec<AffineForm> = (0..n).map(map).collect();
            let errors = self.feedback.errors(&maps, width);
            for (entry, map) in by_entry.iter_mut().zip(errors) {
                if map.numbers().any(|number| number.abs() > ZERO) {
                    entry.push(Spread { map, most: own.range.magnitude() });
                }
            }
        }
        by_entry
    }

    /// The tightened conditions of a sample.
    fn sample(&self, model: &mut Model, sample: usize) -> Result<(), Error> {
        let system = self.own.computed();
        let width = self.radius.len() + system.inputs.len();
        for (i, (_, domain)) in system.states.iter().enumerate() {
            let mut map = AffineForm::constant(width, 0.0);
            map.factors[i] = 1.0;
            self.within(model, &format!("tube_domain_{i}"), sample, None, &map, *domain)?;
        }
        for (k, limit) in system.limits_of(false).enumerate() {
            self.condition(model, &format!("tube_limit_{k}"), sample, None, limit, &[])?;
        }
        Ok(())
    }

    /// The tightened conditions of a step: joint limits, ranges of inputs and guards.
    fn step(&self, model: &mut Model, step: usize) -> Result<(), Error> {
        let system = self.own.computed();
        let (n, width) = (self.radius.len(), self.radius.len() + system.inputs.len());
        for (k, limit) in system.limits_of(true).enumerate() {
            self.condition(model, &format!("tube_joint_limit_{k}"), step, None, limit, &[])?;
        }
        for (c, choice) in system.choices.iter().enumerate() {
            for (j, transition) in choice.transitions.iter().enumerate() {
                let when = self.own.literal(c, j, step);
                let name = |word: &str, k: usize| format!("tube_{word}_{c}_{j}_{k}");
                for u in 0..system.inputs.len() {
                    let Some(range) = system.input_range(choice, transition, u, step) else {
                        continue;
                    };
                    let mut map = AffineForm::constant(width, 0.0);
                    map.factors[n + u] = 1.0;
                    self.within(model, &name("input", u), step, when, &map, range)?;
                }
                let flow = step::flow(&transition.flow);
                for own in transition.conditions() {
                    self.condition(model, &name("guard", own.number), step, when, own, &flow)?;
                }
            }
        }
        Ok(())
    }

    /// A condition for every error.
    ///
    /// # Arguments
    ///
    /// * `predicted`: the predicted states, for conditions on them.
    fn condition(
        &self,
        model: &mut Model,
        name: &str,
        sample: usize,
        when: Option<Literal>,
        condition: StepCondition<'_>,
        predicted: &[AffineForm],
    ) -> Result<(), Error> {
        let width = self.radius.len() + self.own.computed().inputs.len();
        match condition.maps(predicted, width, sample) {
            None => Ok(()),
            Some(ConditionMaps::HalfSpace(map)) => self.add_row(model, name, sample, when, &map),
            Some(ConditionMaps::Norm { entries, bound }) => {
                self.norm(model, name, sample, when, &entries, &bound)
            }
        }
    }

    /// Adds `map <= 0` for every error.
    fn add_row(
        &self,
        model: &mut Model,
        name: &str,
        sample: usize,
        when: Option<Literal>,
        map: &AffineForm,
    ) -> Result<(), Error> {
        let width = self.width_of(map, sample);
        if width.terms().is_empty() {
            return Ok(());
        }
        add(model, name, sample, when, (expression(self.own, map, sample) + width).le(0.0))
    }

    /// The map within a range for every error.
    fn within(
        &self,
        model: &mut Model,
        name: &str,
        sample: usize,
        when: Option<Literal>,
        map: &AffineForm,
        range: Interval,
    ) -> Result<(), Error> {
        let mut above = map.clone();
        above.constant -= range.upper;
        let mut below = map.scaled(-1.0);
        below.constant += range.lower;
        self.add_row(model, &format!("{name}_most"), sample, when, &above)?;
        self.add_row(model, &format!("{name}_least"), sample, when, &below)
    }

    /// A limit of a length for every error. The sum of the entries' widths is at least the length
    /// of any error.
    fn norm(
        &self,
        model: &mut Model,
        name: &str,
        sample: usize,
        when: Option<Literal>,
        entries: &[AffineForm],
        bound: &AffineForm,
    ) -> Result<(), Error> {
        let maps = entries.iter().chain([bound]);
        let taken: Affine = maps.map(|map| self.width_of(map, sample)).sum();
        if taken.terms().is_empty() {
            return Ok(());
        }
        let entries = norm(entries.iter().map(|map| expression(self.own, map, sample)));
        let row: ConicRow = entries.le(expression(self.own, bound, sample) - taken);
        match when {
            None => model.add((name, sample), row).map(drop),
            Some(literal) => model.add((name, sample), literal.implies(row)).map(drop),
        }
    }
}

/// Adds a row, under a condition if there is one. A row without variables that holds is left out.
fn add(
    model: &mut Model,
    name: &str,
    sample: usize,
    when: Option<Literal>,
    row: Row,
) -> Result<(), Error> {
    let range = model.range(row.expression())?;
    if range.lower >= row.lower() && range.upper <= row.upper() {
        return Ok(());
    }
    match when {
        None => model.add((name, sample), row).map(drop),
        Some(literal) => model.add((name, sample), literal.implies(row)).map(drop),
    }
}
