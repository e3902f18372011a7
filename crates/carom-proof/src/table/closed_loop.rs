//! Where the loop that is closed by a table stays among states with a plan.
//!
//! A table may say where each axis is at the next sample: an expression of the plan, and a largest
//! disturbance. The plan of a cell is interpolated, so that the next states of a cell are the simplex
//! of the next states at its corners, and the disturbances around it. All cells that meet it must
//! have plans, and lead to such cells themselves: what does not is taken away until nothing changes.
//!
//! A cell does not meet a set if one of its weights is negative at all of it. Weights are linear in
//! the coordinates, and a cut changes them by sums and doubling. Coordinates are counted in units
//! of `2^-48` of a side, and a set is made larger by some units.

use super::cells::Used;
use super::statement::Statement;
use crate::exact::Sum;
use crate::text::{Lines, Refusal, Words, rejected};
use std::cmp::Ordering;
use std::io::BufRead;
use std::rc::Rc;

/// Units along a side of the box.
const SIDE: i128 = 1 << 48;

/// By how many units a coordinate is moved outward: more than a float's error.
const OUTWARD: f64 = 64.0;

/// The next value of an axis: the largest disturbance, the constant, and the terms.
pub(super) type Next = (f64, f64, Vec<(u32, f64)>);

/// A range of each coordinate; `None` if it is not within the box.
pub(super) type Image = Option<Vec<[i128; 2]>>;

/// A cell, as the loop needs it.
#[derive(Debug)]
pub(super) enum LoopCell {
    Cut {
        edge: [usize; 2],
        halves: [usize; 2],
    },
    /// The plans at the corners, and the share of the box.
    Plan(Vec<Rc<Used>>, f64),
    NoPlan,
}

/// The weight of a corner: a constant, and a factor for each coordinate.
type Weight = Vec<i128>;

/// Reads where the axes are next.
pub(super) fn read_next<R: BufRead>(
    lines: &mut Lines<R>,
    statement: &Statement,
) -> Result<Vec<Next>, Refusal> {
    let mut words = lines.expect("next")?;
    let count = words.count("the number of axes")?;
    words.end()?;
    if count != 0 && count != statement.axes.len() {
        return rejected("the next sample is said of some axes and not of others");
    }
    let mut all = Vec::new();
    for _ in 0..count {
        let mut words = lines.expect("n")?;
        let next = next_of_axis(&mut words, statement)?;
        words.end()?;
        all.push(next);
    }
    Ok(all)
}

fn next_of_axis(words: &mut Words<'_>, statement: &Statement) -> Result<Next, Refusal> {
    let disturbance = words.number("the disturbance")?;
    if disturbance < 0.0 {
        return rejected("the disturbance is negative");
    }
    let offset = words.number("the constant")?;
    let entries = words.entries(statement.columns.len())?;
    Ok((disturbance, offset, entries))
}

/// The next states of a corner.
pub(super) fn image(statement: &Statement, x: &[crate::exact::Dyadic]) -> Result<Image, Refusal> {
    let mut ranges = Vec::new();
    let mut sum = Sum::default();
    for ((disturbance, offset, terms), &j) in statement.next.iter().zip(&statement.axes) {
        let column = &statement.columns[j];
        sum.add(column.upper, 1.0);
        sum.subtract(column.lower, 1.0);
        let width = sum.take()?;
        let mut range = [0; 2];
        for (side, end) in [-1.0, 1.0].into_iter().zip(&mut range) {
            // How far the end is from the lower end of the axis.
            terms.iter().for_each(|&(k, a)| sum.add(a, &x[k as usize]));
            sum.add(*offset, 1.0);
            sum.add(*disturbance, side);
            sum.subtract(column.lower, 1.0);
            let along = sum.take()?;
            sum.add(&along, 1.0);
            let is_below = sum.take_sign()? == Ordering::Less;
            sum.add(&along, 1.0);
            sum.subtract(&width, 1.0);
            if is_below || sum.take_sign()? == Ordering::Greater {
                return Ok(None);
            }
            // A whole number that is a float, checked to be beyond the end.
            let near = along.nearest() / width.nearest() * SIDE as f64;
            let units = (near + side * OUTWARD).round();
            sum.add(&along, SIDE as f64);
            sum.subtract(&width, units);
            let beyond = if side < 0.0 { Ordering::Less } else { Ordering::Greater };
            if sum.take_sign()? == beyond {
                return rejected("the numbers of an axis are too large or too fine");
            }
            *end = (units as i128).clamp(0, SIDE);
        }
        ranges.push(range);
    }
    Ok(Some(ranges))
}

/// The share of the box that is taken by cells with plans whose next states are in such cells again.
pub(super) fn stays(cells: &[LoopCell], axes: usize) -> Result<f64, Refusal> {
    let mut met: Vec<Vec<usize>> = Vec::with_capacity(cells.len());
    let mut is_in = Vec::with_capacity(cells.len());
    for cell in cells {
        let found = match cell {
            LoopCell::Plan(plans, _) => meets(cells, plans, axes)?,
            _ => None,
        };
        is_in.push(found.is_some());
        met.push(found.unwrap_or_default());
    }
    loop {
        let leaves = |k: &usize| is_in[*k] && met[*k].iter().any(|other| !is_in[*other]);
        let leaving: Vec<usize> = (0..cells.len()).filter(leaves).collect();
        if leaving.is_empty() {
            break;
        }
        leaving.iter().for_each(|&k| is_in[k] = false);
    }
    let share = |(cell, is_in): (&LoopCell, &bool)| match cell {
        LoopCell::Plan(_, share) if *is_in => *share,
        _ => 0.0,
    };
    Ok(cells.iter().zip(&is_in).map(share).sum())
}

/// The cells that may meet the next states of a cell; `None` if one of them has no plan, or if the
/// next states are not within the box.
fn meets(
    cells: &[LoopCell],
    plans: &[Rc<Used>],
    axes: usize,
) -> Result<Option<Vec<usize>>, Refusal> {
    let images = plans.iter().map(|plan| plan.next.as_deref());
    let Some(images) = images.collect::<Option<Vec<&[[i128; 2]]>>>() else { return Ok(None) };
    let mut met = Vec::new();
    let mut waiting: Vec<(usize, Vec<Weight>)> = whole(axes).into_iter().enumerate().collect();
    while let Some((number, weights)) = waiting.pop() {
        if is_apart(&weights, &images)? {
            continue;
        }
        match &cells[number] {
            LoopCell::NoPlan => return Ok(None),
            LoopCell::Plan(..) => met.push(number),
            LoopCell::Cut { edge: [i, j], halves } => {
                for ([kept, middle], &half) in [[*i, *j], [*j, *i]].into_iter().zip(halves) {
                    let mut own = weights.clone();
                    for (k, &moved) in weights[middle].iter().enumerate() {
                        let less = own[kept][k].checked_sub(moved);
                        let twice = moved.checked_mul(2);
                        let (Some(less), Some(twice)) = (less, twice) else { return too_deep() };
                        (own[kept][k], own[middle][k]) = (less, twice);
                    }
                    waiting.push((half, own));
                }
            }
        }
    }
    Ok(Some(met))
}

fn too_deep<T>() -> Result<T, Refusal> {
    rejected("cells are too small for the loop")
}

/// Whether a weight is negative at all points of the hull of some boxes.
fn is_apart(weights: &[Weight], images: &[&[[i128; 2]]]) -> Result<bool, Refusal> {
    for weight in weights {
        let mut is_negative = true;
        for image in images {
            let mut most = Some(weight[0]);
            for (&factor, [lower, upper]) in weight[1..].iter().zip(*image) {
                let end = if factor > 0 { upper } else { lower };
                let product = factor.checked_mul(*end);
                most = most.zip(product).and_then(|(most, product)| most.checked_add(product));
            }
            let Some(most) = most else { return too_deep() };
            is_negative &= most < 0;
        }
        if is_negative {
            return Ok(true);
        }
    }
    Ok(false)
}

/// The weights of the corners of Kuhn's simplices, times all units of a side: for each order of
/// the axes in lexicographic order, differences of coordinates.
fn whole(axes: usize) -> Vec<Vec<Weight>> {
    let of = |order: Vec<usize>| {
        let mut weights = vec![vec![0; axes + 1]; axes + 1];
        weights[0][0] = SIDE;
        for (k, axis) in order.into_iter().enumerate() {
            weights[k][1 + axis] = -1;
            weights[k + 1][1 + axis] = 1;
        }
        weights
    };
    super::cells::orders(axes).into_iter().map(of).collect()
}
