//! Guards on states and inputs together.
//!
//! Three things follow from a guard `n.x + m.u <= l`, and all of them are used:
//!
//! * each input is at most as large as the others and the states leave it
//!   ([`tightened`](super::inputs::tightened));
//! * the states satisfy `n.x <= l - min m.u`;
//! * in a block of one or two states, the set of states and of *one* input is cut exactly
//!   ([`lifted`](super::lifted)), so that an equality such as u = k.x + c replaces the input. The
//!   other inputs of such a guard are taken at their best.

use super::compiled::{Block, Compiled, Push, Step, push};
use super::inputs::{Joint, least};
use super::lifted::{Lift, Pair, Slab};
use super::rounding::EPSILON;
use super::set::{Emptied, Place};
use super::shape::{AffineMap, Shape};
use crate::interval::Interval;

/// The guards of a block, and how it treats them.
struct Local<'a> {
    step: &'a Step,
    guards: Vec<(usize, &'a Joint)>,
    inputs: &'a [Interval],
    /// The input that is kept beside one or two states.
    kept: Option<usize>,
}

impl<'a> Local<'a> {
    fn new(system: &'a Compiled, number: usize, block: usize, inputs: &'a [Interval]) -> Self {
        let step = &system.blocks[block].steps[number];
        let joint = system.joint_transitions[number].joint.iter().enumerate();
        let guards: Vec<(usize, &Joint)> = joint.filter(|(_, g)| g.block == Some(block)).collect();
        let weight = |j: usize| -> f64 {
            let width = (inputs[j].upper - inputs[j].lower).max(0.0);
            guards.iter().map(|(_, guard)| guard.gains[j].abs() * width).sum()
        };
        let inputs_by_weight = (0..inputs.len()).map(|j| (j, weight(j)));
        let heaviest = inputs_by_weight.max_by(|a, b| a.1.total_cmp(&b.1).then(b.0.cmp(&a.0)));
        let kept = heaviest.filter(|(_, weight)| *weight > 0.0).map(|(j, _)| j);
        Local { step, guards, inputs, kept }
    }

    /// Cuts with `n.x <= l - min m.u`.
    fn cut(&self, shape: &mut Shape, number: usize, block: usize) -> Result<(), Emptied> {
        for (k, guard) in &self.guards {
            let best = least(&guard.gains, self.inputs, None);
            let limit = guard.limit - best;
            let limit = limit + 4.0 * EPSILON * (guard.limit.abs() + best.abs());
            if let Some(nearest) = shape.clip(&guard.normal, limit) {
                let place = Place::Joint(number, *k);
                return Err(Emptied { block, place, nearest: nearest + best });
            }
        }
        Ok(())
    }

    /// The guards as limits on the states and the kept input.
    fn slabs(&self, kept: usize) -> Vec<Slab> {
        let slab = |(_, guard): &(usize, &Joint)| {
            let best = least(&guard.gains, self.inputs, Some(kept));
            let limit = guard.limit - best;
            Slab {
                normal: [guard.normal[0], guard.normal.get(1).copied().unwrap_or(0.0)],
                gain: guard.gains[kept],
                limit: limit + 4.0 * EPSILON * (guard.limit.abs() + best.abs()),
            }
        };
        self.guards.iter().map(slab).collect()
    }

    /// The set that the inputs other than the kept one add.
    fn others(&self, kept: usize) -> Push {
        let mut gains = self.step.gains.clone();
        gains.iter_mut().for_each(|row| row[kept] = 0.0);
        push(&gains, &self.step.constant, self.inputs, 0.0)
    }

    /// The state and the kept input of a block of one state.
    fn pair(&self, kept: usize, shape: &Shape) -> Pair {
        let state = Interval::new(shape.lowest(&[1.0]), -shape.lowest(&[-1.0]));
        Pair::new(state, self.inputs[kept], &self.slabs(kept))
    }

    /// How the flow of a block of one state depends on the state and the kept input.
    fn factors(&self, kept: usize) -> [f64; 2] {
        [self.step.flow.matrix()[0][0], self.step.gains[0][kept]]
    }

    fn lift(&self, kept: usize, shift: &[f64]) -> Lift {
        let m = self.step.flow.matrix();
        Lift {
            matrix: [[m[0][0], m[0][1]], [m[1][0], m[1][1]]],
            column: [self.step.gains[0][kept], self.step.gains[1][kept]],
            offset: [shift[0], shift[1]],
            range: self.inputs[kept],
            slabs: self.slabs(kept),
        }
    }
}

fn none(block: usize) -> Emptied {
    Emptied { block, place: Place::Shape, nearest: f64::NAN }
}

/// The flow of a block from a set that is cut by the guards on states alone.
pub(super) fn flown(
    system: &Compiled,
    number: usize,
    block: usize,
    start: &Shape,
    inputs: &[Interval],
) -> Result<Shape, Emptied> {
    let local = Local::new(system, number, block, inputs);
    let mut start = start.clone();
    local.cut(&mut start, number, block)?;
    start.settle();
    if start.is_empty() {
        return Err(none(block));
    }
    let (mut flown, push) = match (&start, local.kept) {
        (Shape::Planar(polygon), Some(kept)) => {
            let push = local.others(kept);
            let image = local.lift(kept, &push.shift).image(polygon);
            (Shape::Planar(image), push)
        }
        (Shape::Template(_), Some(kept)) if local.step.constant.len() == 1 => {
            let push = local.others(kept);
            let image = local.pair(kept, &start).range(local.factors(kept));
            let image = image.ok_or(none(block))? + Interval::point(push.shift[0]);
            (start.boxed(&[image.lower], &[image.upper]), push)
        }
        _ => {
            let push = push(&local.step.gains, &local.step.constant, inputs, 0.0);
            let map: AffineMap = local.step.flow.with_offset(push.shift.clone());
            (start.map(&map), push)
        }
    };
    if flown.is_empty() {
        return Err(none(block));
    }
    flown = flown.add_segments(&push.generators);
    flown.widen(&push.slack);
    Ok(flown)
}

/// The states of a block from which the flow leads into a set of predictions.
pub(super) fn unflown(
    system: &Compiled,
    number: usize,
    block: usize,
    predicted: &Shape,
    inputs: &[Interval],
) -> Result<Shape, Emptied> {
    let local = Local::new(system, number, block, inputs);
    let Block { domain, .. } = &system.blocks[block];
    let start = match (predicted, local.kept) {
        (Shape::Planar(_), Some(kept)) if local.step.flow.inverse().is_some() => {
            let push = local.others(kept);
            let mut free = predicted.add_segments(&push.generators);
            free.widen(&push.slack);
            match (&free, local.step.flow.inverse()) {
                (Shape::Planar(polygon), Some((inverse, error))) => {
                    let lift = local.lift(kept, &push.shift);
                    Shape::Planar(lift.preimage(polygon, inverse, error))
                }
                _ => free,
            }
        }
        (Shape::Template(_), Some(kept)) if local.step.constant.len() == 1 => {
            let push = local.others(kept);
            let mut free = predicted.add_segments(&push.generators);
            free.widen(&push.slack);
            let mut pair = local.pair(kept, domain);
            let [a, b] = local.factors(kept);
            // a x + b u lies in the set without the constant part.
            let shift = Interval::point(-push.shift[0]);
            let range = Interval::new(free.lowest(&[1.0]), -free.lowest(&[-1.0])) + shift;
            pair.clip([a, b], range.upper);
            pair.clip([-a, -b], -range.lower);
            let states = pair.range([1.0, 0.0]).ok_or(none(block))?;
            predicted.boxed(&[states.lower], &[states.upper])
        }
        _ => {
            let push = push(&local.step.gains, &local.step.constant, inputs, 0.0);
            let mut free = predicted.add_segments(&push.generators);
            free.widen(&push.slack);
            free.preimage(&local.step.flow.with_offset(push.shift), domain)
        }
    };
    let mut start = start;
    if start.is_empty() {
        return Err(none(block));
    }
    start.keep_within(domain);
    local.cut(&mut start, number, block)?;
    Ok(start)
}
