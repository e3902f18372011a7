//! The law of a joint transition in one step: one flow, guards, reset and input ranges for what all
//! choices do together.

use faer::Mat;

use super::joint_transitions::JointTransition;
use super::rounding::EPSILON;
use crate::hybrid::step::{self, AffineForm, Dynamics};
use crate::hybrid::system::{Choice, Halfspace, HybridSystem, Reset, Transition, Uncertain};
use crate::interval::Interval;
use crate::tolerance::margin_scale;

/// A half-space of a joint transition.
#[derive(Debug, Clone)]
pub(super) struct Guard {
    pub(super) name: String,
    pub(super) states: Vec<f64>,
    /// Empty or all 0 if the guard does not depend on the inputs.
    pub(super) inputs: Vec<f64>,
    pub(super) limit: f64,
}

impl Guard {
    fn new(halfspace: &Halfspace, states: usize, step: usize) -> Self {
        let (x, u) = halfspace.parts(states);
        Guard {
            name: halfspace.name.clone(),
            states: x.to_vec(),
            inputs: u.to_vec(),
            limit: halfspace.limit_at(step),
        }
    }

    pub(super) fn is_joint(&self) -> bool {
        self.inputs.iter().any(|&m| m != 0.0)
    }
}

/// How a transition's prediction follows from a joint transition.
#[derive(Debug, Clone)]
pub(super) enum Prediction {
    /// The joint transition's prediction, shifted.
    Shifted(Vec<f64>),
    /// By a flow of its own.
    Own(Vec<AffineForm>),
}

/// A joint transition in one step: guards, `y = A x + B u + c`, guards on y, and a reset.
#[derive(Debug, Clone)]
pub(super) struct Law {
    /// One row per state.
    pub(super) flow: Vec<AffineForm>,
    pub(super) before: Vec<Guard>,
    pub(super) after: Vec<Guard>,
    pub(super) reset: Option<(Mat<f64>, Vec<f64>)>,
    /// The most by which each next state may differ in addition: disturbance, relaxed choices,
    /// rounding.
    pub(super) loose: Vec<f64>,
    /// Number of resets whose margin is added to the next state.
    pub(super) resets: usize,
    pub(super) inputs: Vec<Interval>,
    /// Predictions of the transitions, by their numbers.
    pub(super) predictions: Vec<(usize, Prediction)>,
    /// Whether the ranges of the inputs leave any value.
    pub(super) is_possible: bool,
}

/// The data from which the laws of a step are made.
pub(super) struct Context<'a> {
    pub(super) system: &'a HybridSystem,
    pub(super) transitions: Vec<&'a Transition>,
    pub(super) step: usize,
    /// Inputs of the step, if they are given.
    pub(super) given: Option<&'a [Interval]>,
    pub(super) margin: f64,
    pub(super) is_disturbed: bool,
    /// Choices that are not followed, and the numbers of their transitions.
    pub(super) relaxed: &'a [Choice],
    pub(super) relaxed_numbers: &'a [usize],
}

impl Context<'_> {
    pub(super) fn law(&self, taken: &JointTransition) -> Law {
        let system = self.system;
        let members: Vec<&Transition> =
            taken.members.iter().map(|&m| self.transitions[m]).collect();
        let (inputs, is_possible) = self.inputs(&members);
        let n = system.states.len();
        let guards = |list: &[Halfspace]| -> Vec<Guard> {
            list.iter().map(|h| Guard::new(h, n, self.step)).collect()
        };
        let mut before: Vec<Guard> = members.iter().flat_map(|t| guards(&t.guards)).collect();
        let joint = system.limits.iter().filter(|limit| limit.is_joint(n));
        before.extend(joint.map(|h| Guard::new(h, n, self.step)));

        let mut law = match (members.as_slice(), system.choices.len()) {
            ([only], 1) => Law {
                flow: step::flow(&only.flow),
                before,
                after: guards(&only.prediction_guards),
                reset: self.reset(only),
                loose: vec![0.0; n],
                resets: usize::from(only.reset.is_some()),
                inputs,
                predictions: vec![(taken.members[0], Prediction::Shifted(vec![0.0; n]))],
                is_possible,
            },
            _ => self.sum(taken, &members, before, inputs, is_possible),
        };
        for (c, choice) in self.relaxed.iter().enumerate() {
            let effect = self.effect(choice, &law.inputs);
            law.shift(&effect);
            let first = self.relaxed[..c].iter().map(|c| c.transitions.len()).sum::<usize>();
            for (k, transition) in choice.transitions.iter().enumerate() {
                let number = self.relaxed_numbers[first + k];
                law.predictions.push((number, Prediction::Own(step::flow(&transition.flow))));
            }
        }
        if self.is_disturbed && !system.disturbance.is_empty() {
            // Sets of undisturbed runs stay part of the sets.
            let none = Interval::point(0.0);
            let by: Vec<Interval> = system.disturbance.iter().map(|r| r.hull(none)).collect();
            law.shift(&by);
        }
        for own in members.iter().filter(|_| self.is_disturbed) {
            let by = self.uncertain(own, &law.inputs);
            law.shift(&by);
        }
        law
    }

    /// The set of what the uncertain parts of a transition may add to the next state.
    fn uncertain(&self, transition: &Transition, inputs: &[Interval]) -> Vec<Interval> {
        let states = self.system.states.iter().map(|(_, domain)| *domain);
        let start: Vec<Interval> = states.chain(inputs.iter().copied()).collect();
        let flow = step::flow(&transition.flow);
        let n = self.system.states.len();
        let mut all = vec![Interval::point(0.0); n];
        for Uncertain { range, effect: Reset { matrix, offset } } in &transition.uncertain {
            for (i, all) in all.iter_mut().enumerate() {
                let offset = offset.get(self.step).and_then(|offset| offset.get(i)).copied();
                let factors = (0..n).map(|j| matrix[(i, j)]);
                let map = step::combine(factors, &flow, start.len(), offset.unwrap_or(0.0));
                let of = map.over(&start);
                *all = *all + (of * range.lower).hull(of * range.upper);
            }
        }
        all
    }

    /// The ranges of the inputs, and whether there is a value in each. A relaxed choice widens an
    /// input that no other choice limits to what any of its transitions leaves.
    fn inputs(&self, members: &[&Transition]) -> (Vec<Interval>, bool) {
        let mut is_possible = true;
        let ranges = (0..self.system.inputs.len()).map(|j| {
            let given = self.given.map(|given| given[j]);
            let followed = self.system.choices.iter().zip(members);
            let followed = followed.filter_map(|(choice, t)| self.range(choice, t, j));
            let relaxed = self.relaxed.iter().filter_map(|choice| {
                let own = choice.transitions.iter().filter_map(|t| self.range(choice, t, j));
                own.reduce(|a, b| a.hull(b))
            });
            let both = |a: Interval, b: Interval| a.intersection(b);
            let own = followed.reduce(both).or_else(|| relaxed.reduce(both));
            let range = own.into_iter().chain(given).fold(Interval::REALS, both);
            let slack = 2.0 * self.margin * margin_scale(range.magnitude(), 0.0);
            is_possible &= range.lower <= range.upper + slack;
            if range.is_empty() { Interval::point(range.lower) } else { range }
        });
        (ranges.collect(), is_possible)
    }

    /// The range that a transition of a choice leaves to an input, where given ranges take the
    /// place of the system's.
    fn range(&self, choice: &Choice, transition: &Transition, input: usize) -> Option<Interval> {
        let own = self.system.input_range(choice, transition, input, self.step)?;
        let sets = transition.input_range(&self.system.inputs[input].0).is_some();
        let given = self.given.filter(|_| !sets).map(|given| given[input]);
        Some(given.unwrap_or(own))
    }

    fn reset(&self, transition: &Transition) -> Option<(Mat<f64>, Vec<f64>)> {
        let reset = transition.reset.as_ref()?;
        Some((reset.matrix.clone(), reset.offset.get(self.step).cloned().unwrap_or_default()))
    }

    /// The law of several choices, whose effects add to the common flow.
    fn sum(
        &self,
        taken: &JointTransition,
        members: &[&Transition],
        before: Vec<Guard>,
        inputs: Vec<Interval>,
        is_possible: bool,
    ) -> Law {
        let system = self.system;
        let n = system.states.len();
        let common = step::flow(system.flow.as_ref().unwrap_or(&members[0].flow));
        let share = |t: &&Transition| {
            let own = step::flow(&t.flow);
            own.iter().zip(&common).all(|(own, common)| own.factors == common.factors)
        };
        let is_shared = members.iter().all(share);
        let mut law = Law {
            flow: common,
            before,
            after: Vec::new(),
            reset: None,
            loose: vec![0.0; n],
            resets: members.iter().filter(|t| t.reset.is_some()).count(),
            inputs,
            predictions: Vec::new(),
            is_possible,
        };
        if is_shared {
            self.add_resets(&mut law, taken, members);
        } else {
            self.add_flows(&mut law, taken, members);
        }
        law
    }

    /// The choices share A and B, so that each of them resets the common prediction.
    fn add_resets(&self, law: &mut Law, taken: &JointTransition, members: &[&Transition]) {
        let n = law.flow.len();
        let identity = Mat::<f64>::identity(n, n);
        let (mut matrix, mut offset) = (identity.clone(), vec![0.0; n]);
        let mut size = Mat::<f64>::zeros(n, n);
        for (&number, transition) in taken.members.iter().zip(members) {
            let shift = transition.flow.c().iter().zip(&law.flow);
            let shift: Vec<f64> = shift.map(|(c, common)| c - common.constant).collect();
            for halfspace in &transition.prediction_guards {
                let mut guard = Guard::new(halfspace, n, self.step);
                let moved = product(&guard.states, &shift);
                let noise = 8.0 * EPSILON * (moved.1 + guard.limit.abs());
                guard.limit += noise - moved.0;
                law.after.push(guard);
            }
            let (own, r) =
                self.reset(transition).unwrap_or_else(|| (identity.clone(), vec![0.0; n]));
            for i in 0..n {
                let row: Vec<f64> = (0..n).map(|j| own[(i, j)]).collect();
                let (moved, terms) = product(&row, &shift);
                offset[i] += moved + r[i];
                law.loose[i] += 16.0 * EPSILON * (terms + r[i].abs() + offset[i].abs());
                for j in 0..n {
                    matrix[(i, j)] += own[(i, j)] - identity[(i, j)];
                    size[(i, j)] += own[(i, j)].abs() + identity[(i, j)];
                }
            }
            law.predictions.push((number, Prediction::Shifted(shift)));
        }
        if matrix != identity || offset.iter().any(|&r| r != 0.0) {
            // Predictions are at most as large as the flow makes them.
            let reach = self.reach(&law.flow, &law.inputs);
            for i in 0..n {
                let row: f64 = (0..n).map(|j| size[(i, j)] * reach[j]).sum();
                law.loose[i] += 16.0 * EPSILON * row;
            }
            law.reset = Some((matrix, offset));
        }
    }

    /// The choices have flows of their own: the sum of their effects is one flow, and guards on
    /// predictions become guards on states and inputs.
    fn add_flows(&self, law: &mut Law, taken: &JointTransition, members: &[&Transition]) {
        let common = law.flow.clone();
        let width = common[0].factors.len();
        let mut sizes = vec![AffineForm::constant(width, 0.0); common.len()];
        for (&number, transition) in taken.members.iter().zip(members) {
            let own = step::flow(&transition.flow);
            let Dynamics { next, guards, .. } = self.dynamics(transition);
            for guard in guards {
                let number = guard.number.checked_sub(transition.guards.len());
                if let Some(halfspace) = number.and_then(|k| transition.prediction_guards.get(k)) {
                    law.before.push(self.pulled(halfspace, guard.map, &own, &law.inputs));
                }
            }
            for (i, next) in next.iter().enumerate() {
                law.flow[i].add(1.0, next);
                law.flow[i].add(-1.0, &common[i]);
                sizes[i].add(1.0, &next.magnitudes());
                sizes[i].add(1.0, &common[i].magnitudes());
            }
            law.predictions.push((number, Prediction::Own(own)));
        }
        let reach = self.reach(&sizes, &law.inputs);
        for (loose, reach) in law.loose.iter_mut().zip(reach) {
            *loose += 32.0 * EPSILON * width as f64 * reach;
        }
    }

    fn dynamics(&self, transition: &Transition) -> Dynamics {
        step::dynamics(self.system, transition, &[], Vec::new(), self.step)
    }

    /// A guard on a flow's result as a guard on states and inputs, which is `map <= 0` up to
    /// rounding.
    fn pulled(
        &self,
        halfspace: &Halfspace,
        map: AffineForm,
        flow: &[AffineForm],
        inputs: &[Interval],
    ) -> Guard {
        let reach = self.reach(flow, inputs);
        let size: f64 = halfspace.normal.iter().zip(&reach).map(|(f, r)| f.abs() * r).sum();
        let size = size + halfspace.limit_at(self.step).abs();
        let limit = 32.0 * EPSILON * map.factors.len() as f64 * size - map.constant;
        let (mut states, name) = (map.factors, halfspace.name.clone());
        let inputs = states.split_off(flow.len());
        Guard { name, states, inputs, limit }
    }

    /// Bounds of the magnitudes of the terms of a flow over domains and inputs.
    fn reach(&self, flow: &[AffineForm], inputs: &[Interval]) -> Vec<f64> {
        let ranges = self.system.states.iter().map(|(_, domain)| domain).chain(inputs);
        let sizes: Vec<f64> = ranges.map(|range| range.magnitude() + 1.0).collect();
        flow.iter().map(|row| row.magnitudes().at(&sizes)).collect()
    }

    /// A box around what a relaxed choice may change about the next state.
    fn effect(&self, choice: &Choice, inputs: &[Interval]) -> Vec<Interval> {
        let n = self.system.states.len();
        let wide = |range: &Interval| {
            let slack = self.margin * margin_scale(range.magnitude(), 0.0)
                + 16.0 * EPSILON * range.magnitude();
            Interval::new(range.lower - slack, range.upper + slack)
        };
        let domains = self.system.states.iter().map(|(_, domain)| domain);
        let ranges: Vec<Interval> = domains.chain(inputs).map(wide).collect();
        let common = self.system.flow.as_ref().map(step::flow);
        let of = |transition: &Transition| -> Vec<Interval> {
            let mut next = self.dynamics(transition).next;
            for (next, common) in next.iter_mut().zip(common.iter().flatten()) {
                next.add(-1.0, common);
            }
            next.iter().map(|next| wide(&next.over(&ranges))).collect()
        };
        let all = choice.transitions.iter().map(of);
        let hull = |a: Vec<Interval>, b: Vec<Interval>| -> Vec<Interval> {
            a.iter().zip(&b).map(|(a, b)| a.hull(*b)).collect()
        };
        all.reduce(hull).unwrap_or_else(|| vec![Interval::point(0.0); n])
    }
}

impl Law {
    /// Adds a box to the next state.
    fn shift(&mut self, by: &[Interval]) {
        let n = by.len();
        let middles: Vec<f64> = by.iter().map(|r| 0.5 * r.lower + 0.5 * r.upper).collect();
        for (loose, (range, middle)) in self.loose.iter_mut().zip(by.iter().zip(&middles)) {
            let half = (range.upper - middle).max(middle - range.lower);
            *loose += half + 8.0 * EPSILON * range.magnitude();
        }
        if middles.iter().any(|&m| m != 0.0) {
            let identity = || (Mat::<f64>::identity(n, n), vec![0.0; n]);
            let (_, offset) = self.reset.get_or_insert_with(identity);
            for (r, (middle, loose)) in offset.iter_mut().zip(middles.iter().zip(&mut self.loose)) {
                *r += middle;
                *loose += 4.0 * EPSILON * r.abs();
            }
        }
    }
}

/// A scalar product, and the sum of its terms' magnitudes.
fn product(a: &[f64], b: &[f64]) -> (f64, f64) {
    let terms = || a.iter().zip(b).map(|(x, y)| x * y);
    (terms().sum(), terms().map(f64::abs).sum())
}
