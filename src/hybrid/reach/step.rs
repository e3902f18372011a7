//! One step forward or backward through one transition.

use std::sync::Arc;

use super::compiled::{Block, Compiled};
use super::set::{Emptied, Place, ReachSet, cut};
use super::shape::Shape;

/// The predictions of a transition from a set: after the flow and its guards, before the reset.
pub(super) fn predict(
    system: &Compiled,
    transition: usize,
    set: &ReachSet,
) -> Result<Vec<Shape>, Emptied> {
    let blocks = system.blocks.iter().zip(&set.shapes).enumerate();
    let parts = blocks.map(|(b, (block, shape))| {
        let step = &block.steps[transition];
        let mut flown = if step.before.is_empty() {
            shape.map(&step.flow)
        } else {
            let mut start = shape.clone();
            let guard = |k| Place::Guard(transition, k);
            cut(&mut start, &step.before, b, guard)?;
            start.map(&step.flow)
        };
        flown = flown.add_segments(&step.generators);
        flown.widen(&step.slack);
        flown.keep_within(&step.predictions);
        check(&flown, b)?;
        let guard = |k| Place::Prediction(transition, k);
        cut(&mut flown, &step.after, b, guard)?;
        settled(flown, b)
    });
    parts.collect()
}

/// The states at the next sample, from the predictions.
pub(super) fn arrive(
    system: &Arc<Compiled>,
    transition: usize,
    predictions: &[Shape],
) -> Result<ReachSet, Emptied> {
    let blocks = system.blocks.iter().zip(predictions).enumerate();
    let parts = blocks.map(|(b, (block, shape))| {
        let step = &block.steps[transition];
        let mut next = match &step.reset {
            Some(reset) => shape.map(reset),
            None => shape.clone(),
        };
        next.widen(&step.reset_slack);
        next.keep_within(&block.domain);
        check(&next, b)?;
        cut(&mut next, &block.limits, b, Place::Limit)?;
        settled(next, b)
    });
    let shapes = parts.collect::<Result<_, Emptied>>()?;
    Ok(ReachSet { system: Arc::clone(system), shapes })
}

/// The states at the next sample.
pub(super) fn successors(
    system: &Arc<Compiled>,
    transition: usize,
    set: &ReachSet,
) -> Result<ReachSet, Emptied> {
    arrive(system, transition, &predict(system, transition, set)?)
}

/// The states from which a transition can lead into a set.
pub(super) fn predecessors(
    system: &Arc<Compiled>,
    transition: usize,
    set: &ReachSet,
) -> Result<ReachSet, Emptied> {
    let blocks = system.blocks.iter().zip(&set.shapes).enumerate();
    let parts = blocks.map(|(b, (block, shape))| predecessors_in(block, transition, shape, b));
    let shapes = parts.collect::<Result<_, Emptied>>()?;
    Ok(ReachSet { system: Arc::clone(system), shapes })
}

fn predecessors_in(
    block: &Block,
    transition: usize,
    shape: &Shape,
    b: usize,
) -> Result<Shape, Emptied> {
    let step = &block.steps[transition];
    let mut predicted = match &step.reset {
        Some(reset) => {
            let mut wide = shape.clone();
            wide.widen(&step.reset_slack);
            wide.preimage(reset, &step.predictions)
        }
        None => shape.clone(),
    };
    predicted.keep_within(&step.predictions);
    check(&predicted, b)?;
    cut(&mut predicted, &step.after, b, |k| Place::Prediction(transition, k))?;
    // Segments are symmetric, so adding them also inverts the addition.
    let mut free = predicted.add_segments(&step.generators);
    free.widen(&step.slack);
    let mut start = free.preimage(&step.flow, &block.domain);
    start.keep_within(&block.domain);
    check(&start, b)?;
    cut(&mut start, &step.before, b, |k| Place::Guard(transition, k))?;
    cut(&mut start, &block.limits, b, Place::Limit)?;
    settled(start, b)
}

/// The shape with consistent limits.
fn settled(mut shape: Shape, block: usize) -> Result<Shape, Emptied> {
    shape.settle();
    check(&shape, block)?;
    Ok(shape)
}

fn check(shape: &Shape, block: usize) -> Result<(), Emptied> {
    let (place, nearest) = (Place::Shape, f64::NAN);
    if shape.is_empty() { Err(Emptied { block, place, nearest }) } else { Ok(()) }
}
