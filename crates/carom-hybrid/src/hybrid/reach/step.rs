//! One step forward or backward through one joint transition.

use std::sync::Arc;

use super::compiled::{Block, Compiled, Step};
use super::inputs::tightened;
use super::joint::{flown, unflown};
use super::law::Prediction;
use super::set::{Emptied, Label, Place, ReachSet, bounding_box, cut};
use super::shape::Shape;
use crate::interval::Interval;

/// The predictions of a joint transition from a set: after its flow and guards, before the reset.
pub(super) fn predict(
    system: &Compiled,
    number: usize,
    set: &ReachSet,
) -> Result<Vec<Shape>, Emptied> {
    let taken = &system.joint_transitions[number];
    if !taken.is_possible {
        return Err(nothing(0));
    }
    if !taken.joint.is_empty() || system.functions.is_some() {
        return predict_jointly(system, number, set);
    }
    let blocks = system.blocks.iter().zip(&set.shapes).enumerate();
    let parts = blocks.map(|(b, (block, shape))| {
        let step = &block.steps[number];
        let mut flown = if step.before.is_empty() {
            shape.map(&step.flow)
        } else {
            let mut start = shape.clone();
            let guard = |k| Place::Guard(number, k);
            cut(&mut start, &step.before, b, guard)?;
            start.map(&step.flow)
        };
        flown = flown.add_segments(&step.push.generators);
        flown.widen(&step.push.slack);
        predicted(flown, step, number, b)
    });
    parts.collect()
}

/// The same with guards on inputs.
fn predict_jointly(
    system: &Compiled,
    number: usize,
    set: &ReachSet,
) -> Result<Vec<Shape>, Emptied> {
    let blocks = || system.blocks.iter().zip(&set.shapes).enumerate();
    let starts = blocks().map(|(b, (block, shape))| {
        let mut start = shape.clone();
        cut(&mut start, &block.steps[number].before, b, |k| Place::Guard(number, k))?;
        settled(start, b)
    });
    let starts: Vec<Shape> = starts.collect::<Result<_, Emptied>>()?;
    let fly = |inputs: &[Interval]| -> Result<Vec<Shape>, Emptied> {
        let parts = system.blocks.iter().zip(&starts).enumerate().map(|(b, (block, start))| {
            let flown = flown(system, number, b, start, inputs)?;
            predicted(flown, &block.steps[number], number, b)
        });
        parts.collect()
    };
    let open = vec![Interval::REALS; system.states.len()];
    let found = fly(&inputs(system, number, &starts, &open)?)?;
    if !system.functions.as_ref().is_some_and(|functions| functions.use_predictions()) {
        return Ok(found);
    }
    // What is found leaves less to functions of predictions.
    let around = bounding_box(system, &found);
    fly(&inputs(system, number, &starts, &around)?)
}

/// The inputs that the guards leave, and what functions are over boxes around the starts and the
/// predictions.
fn inputs(
    system: &Compiled,
    number: usize,
    starts: &[Shape],
    predictions: &[Interval],
) -> Result<Vec<Interval>, Emptied> {
    let taken = &system.joint_transitions[number];
    let mut inputs = taken.inputs.clone();
    if let Some(functions) = &system.functions {
        let around = bounding_box(system, starts);
        inputs = functions.narrowed(&system.coordinates, [&around, predictions], &inputs);
    }
    let starts: Vec<&Shape> = starts.iter().collect();
    tightened(inputs, &taken.joint, &starts).map_err(|(k, nearest)| Emptied {
        block: taken.joint[k].block.unwrap_or(0),
        place: Place::Joint(number, k),
        nearest,
    })
}

fn predicted(mut flown: Shape, step: &Step, number: usize, b: usize) -> Result<Shape, Emptied> {
    flown.keep_within(&step.predictions);
    check(&flown, b)?;
    cut(&mut flown, &step.after, b, |k| Place::Prediction(number, k))?;
    settled(flown, b)
}

/// The states at the next sample, for which `next` is compiled, from the predictions.
pub(super) fn arrive(
    system: &Compiled,
    next: &Arc<Compiled>,
    number: usize,
    predictions: &[Shape],
) -> Result<ReachSet, Emptied> {
    let blocks = system.blocks.iter().zip(&next.blocks).zip(predictions).enumerate();
    let parts = blocks.map(|(b, ((block, target), shape))| {
        let step = &block.steps[number];
        let mut arrived = match &step.reset {
            Some(reset) => shape.map(reset),
            None => shape.clone(),
        };
        arrived.widen(&step.loose);
        arrived.keep_within(&target.domain);
        check(&arrived, b)?;
        cut(&mut arrived, &target.limits, b, Place::Limit)?;
        settled(arrived, b)
    });
    let shapes = parts.collect::<Result<_, Emptied>>()?;
    Ok(ReachSet { system: Arc::clone(next), shapes, label: Label::default() })
}

/// The states at the next sample.
pub(super) fn successors(
    system: &Compiled,
    next: &Arc<Compiled>,
    number: usize,
    set: &ReachSet,
) -> Result<ReachSet, Emptied> {
    arrive(system, next, number, &predict(system, number, set)?)
}

/// The states from which a joint transition can lead into a set.
pub(super) fn predecessors(
    system: &Arc<Compiled>,
    number: usize,
    set: &ReachSet,
) -> Result<ReachSet, Emptied> {
    let taken = &system.joint_transitions[number];
    if !taken.is_possible {
        return Err(nothing(0));
    }
    let blocks = || system.blocks.iter().zip(&set.shapes).enumerate();
    let ends = blocks().map(|(b, (block, shape))| unreset(block, number, shape, b));
    let ends: Vec<Shape> = ends.collect::<Result<_, Emptied>>()?;
    let before = |inputs: Option<&[Interval]>| -> Result<Vec<Shape>, Emptied> {
        let parts = system.blocks.iter().zip(&ends).enumerate().map(|(b, (block, predicted))| {
            let step = &block.steps[number];
            let start = match inputs {
                Some(inputs) => unflown(system, number, b, predicted, inputs)?,
                None => {
                    // Segments are symmetric, so adding them also inverts the addition.
                    let mut free = predicted.add_segments(&step.push.generators);
                    free.widen(&step.push.slack);
                    free.preimage(&step.flow, &block.domain)
                }
            };
            started(start, block, number, b)
        });
        parts.collect()
    };
    let shapes = if taken.joint.is_empty() && system.functions.is_none() {
        before(None)?
    } else {
        let rough = before(Some(&taken.inputs))?;
        // The states that were found may leave less to the inputs.
        let less = inputs(system, number, &rough, &bounding_box(system, &ends))?;
        if less == taken.inputs { rough } else { before(Some(&less))? }
    };
    Ok(ReachSet { system: Arc::clone(system), shapes, label: Label::default() })
}

/// The predictions that the reset leads into a set.
fn unreset(block: &Block, number: usize, shape: &Shape, b: usize) -> Result<Shape, Emptied> {
    let step = &block.steps[number];
    let mut wide = shape.clone();
    if step.loose.iter().any(|&loose| loose != 0.0) {
        wide.widen(&step.loose);
    }
    let mut predicted = match &step.reset {
        Some(reset) => wide.preimage(reset, &step.predictions),
        None => wide,
    };
    predicted.keep_within(&step.predictions);
    check(&predicted, b)?;
    cut(&mut predicted, &step.after, b, |k| Place::Prediction(number, k))?;
    Ok(predicted)
}

fn started(mut start: Shape, block: &Block, number: usize, b: usize) -> Result<Shape, Emptied> {
    start.keep_within(&block.domain);
    check(&start, b)?;
    cut(&mut start, &block.steps[number].before, b, |k| Place::Guard(number, k))?;
    cut(&mut start, &block.limits, b, Place::Limit)?;
    settled(start, b)
}

/// The boxes around the predictions of the transitions of a joint transition.
pub(super) fn prediction_boxes(
    system: &Compiled,
    number: usize,
    set: &ReachSet,
    predicted: &[Shape],
) -> Vec<(usize, Vec<Interval>)> {
    let common = bounding_box(system, predicted);
    let taken = &system.joint_transitions[number];
    let boxes = taken.predictions.iter().map(|(transition, prediction)| {
        let found = match prediction {
            Prediction::Shifted(by) => {
                let shifted = common.iter().zip(by).map(|(range, &by)| match by == 0.0 {
                    true => *range,
                    false => *range + Interval::point(by),
                });
                taken.margins.widened(&shifted.collect::<Vec<_>>())
            }
            Prediction::Own(flow) => {
                let around = [set.own_box(), taken.inputs.clone()].concat();
                let ranges: Vec<_> = flow.iter().map(|row| row.over(&around)).collect();
                system.margins.after(flow).widened(&ranges)
            }
        };
        (*transition, found)
    });
    boxes.collect()
}

/// The shape with consistent limits.
fn settled(mut shape: Shape, block: usize) -> Result<Shape, Emptied> {
    shape.settle();
    check(&shape, block)?;
    Ok(shape)
}

fn nothing(block: usize) -> Emptied {
    Emptied { block, place: Place::Shape, nearest: f64::NAN }
}

fn check(shape: &Shape, block: usize) -> Result<(), Emptied> {
    if shape.is_empty() { Err(nothing(block)) } else { Ok(()) }
}
