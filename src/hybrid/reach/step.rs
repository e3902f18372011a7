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
            shape.map(&block.geometry, &step.flow)
        } else {
            let mut start = shape.clone();
            let guard = |k| Place::Guard(transition, k);
            cut(&mut start, &block.geometry, &step.before, b, guard)?;
            start.map(&block.geometry, &step.flow)
        };
        flown = flown.add_segments(&block.geometry, &step.generators);
        flown.widen(&block.geometry, &step.slack);
        flown.keep_within(&step.predictions);
        check(&flown, b)?;
        let guard = |k| Place::Prediction(transition, k);
        cut(&mut flown, &block.geometry, &step.after, b, guard)?;
        settled(flown, block, b)
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
            Some(reset) => shape.map(&block.geometry, reset),
            None => shape.clone(),
        };
        next.widen(&block.geometry, &step.reset_slack);
        next.keep_within(&block.domain);
        check(&next, b)?;
        cut(&mut next, &block.geometry, &block.limits, b, Place::Limit)?;
        settled(next, block, b)
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
    let (geometry, step) = (&block.geometry, &block.steps[transition]);
    let mut predicted = match &step.reset {
        Some(reset) => {
            let mut wide = shape.clone();
            wide.widen(geometry, &step.reset_slack);
            wide.preimage(geometry, reset, &step.predictions)
        }
        None => shape.clone(),
    };
    predicted.keep_within(&step.predictions);
    check(&predicted, b)?;
    cut(&mut predicted, geometry, &step.after, b, |k| Place::Prediction(transition, k))?;
    // Segments are symmetric, so adding them also inverts the addition.
    let mut free = predicted.add_segments(geometry, &step.generators);
    free.widen(geometry, &step.slack);
    let mut start = free.preimage(geometry, &step.flow, &block.domain);
    start.keep_within(&block.domain);
    check(&start, b)?;
    cut(&mut start, geometry, &step.before, b, |k| Place::Guard(transition, k))?;
    cut(&mut start, geometry, &block.limits, b, Place::Limit)?;
    settled(start, block, b)
}

/// The shape with consistent limits.
fn settled(mut shape: Shape, block: &Block, number: usize) -> Result<Shape, Emptied> {
    shape.settle(&block.geometry);
    check(&shape, number)?;
    Ok(shape)
}

fn check(shape: &Shape, block: usize) -> Result<(), Emptied> {
    let (place, nearest) = (Place::Shape, f64::NAN);
    if shape.is_empty() { Err(Emptied { block, place, nearest }) } else { Ok(()) }
}
