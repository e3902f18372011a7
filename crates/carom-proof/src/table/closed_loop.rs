//! Where the loop that is closed by a table stays among states with a plan.
//!
//! A table may say where each axis is at the next sample: an expression of the plan, and a largest
//! disturbance. The plan of a cell is interpolated, so that the next states of a cell are the
//! simplex of the next states at its corners, and the disturbances around it. The same holds for
//! its pieces: cells are halved further, until their edges are as short as the table asks for. All
//! pieces that meet the next states of a piece must have plans, and lead to such pieces themselves:
//! what does not is taken away until nothing changes. Pieces within a goal take no step to it, and others one
//! more than the pieces that their next states meet.
//!
//! A piece does not meet a set if one of its weights is negative at all of it. Weights are linear
//! in the coordinates, and a cut changes them by sums and doubling. Coordinates are counted in
//! units of `2^-48` of a side, and a set is made larger by some units.

use super::cells::{UNITS, Used, Waiting};
use super::statement::Statement;
use crate::exact::{Dyadic, Sum};
use crate::text::{Lines, Refusal, Words, rejected};
use std::cmp::Ordering;
use std::io::BufRead;
use std::rc::Rc;

/// Units along a side of the box.
const SIDE: i128 = 1 << 48;

/// By how many units a coordinate is moved outward: more than a float's error.
const OUTWARD: f64 = 64.0;

/// The most cells and pieces.
const MOST_PIECES: usize = 10_000_000;

/// The next value of an axis: the largest disturbance, the constant, and the terms.
pub(super) type Next = (f64, f64, Vec<(u32, f64)>);

/// A range of each coordinate; `None` if it is not within the box.
pub(super) type Image = Option<Vec<[i128; 2]>>;

/// A cell, or a piece of one.
#[derive(Debug)]
pub(super) enum LoopCell {
    Cut { edge: [usize; 2], halves: [usize; 2] },
    Plan(LoopPiece),
    NoPlan,
}

/// A part of a cell with a plan.
#[derive(Debug)]
pub(super) struct LoopPiece {
    /// The corners, in units of cells.
    corners: Vec<Vec<i64>>,
    /// The next states at the corners; empty if some are not within the box.
    images: Vec<Vec<[i128; 2]>>,
    /// The share of the box.
    share: f64,
}

impl LoopPiece {
    pub(super) fn new(cell: &Waiting, plans: &[Rc<Used>]) -> Self {
        let images: Option<Vec<_>> = plans.iter().map(|plan| plan.next.clone()).collect();
        LoopPiece {
            corners: cell.corners.iter().map(|corner| corner.units.clone()).collect(),
            images: images.unwrap_or_default(),
            share: cell.share,
        }
    }

    /// Whether all of it is in the goal.
    fn is_in_goal(&self, statement: &Statement) -> Result<bool, Refusal> {
        let mut sum = Sum::default();
        for corner in &self.corners {
            let axes = statement.axes.iter().zip(&statement.goal);
            for ((&j, goal), &units) in axes.zip(corner) {
                let (column, share) = (&statement.columns[j], units as f64 / UNITS as f64);
                for (end, sign) in goal.iter().zip([-1.0, 1.0]) {
                    sum.add(sign * column.lower, 1.0 - share);
                    sum.add(sign * column.upper, share);
                    sum.subtract(sign * end, 1.0);
                    if sum.take_sign()? == Ordering::Greater {
                        return Ok(false);
                    }
                }
            }
        }
        Ok(true)
    }

    /// The longest edge, and its square in squares of units.
    fn longest(&self) -> ([usize; 2], f64) {
        let mut longest = ([0, 1], -1.0);
        for (j, b) in self.corners.iter().enumerate() {
            for (i, a) in self.corners[..j].iter().enumerate() {
                let own = a.iter().zip(b).map(|(a, b)| ((a - b) as f64).powi(2)).sum();
                if own > longest.1 {
                    longest = ([i, j], own);
                }
            }
        }
        longest
    }

    /// The halves; `None` if the middle is finer than the units.
    fn halves(&self, [i, j]: [usize; 2]) -> Option<[Self; 2]> {
        let between = self.corners[i].iter().zip(&self.corners[j]);
        let middle = between.map(|(a, b)| ((a + b) % 2 == 0).then_some((a + b) / 2));
        let middle = middle.collect::<Option<Vec<i64>>>()?;
        let mean = |([a, b], [c, d]): (&[i128; 2], &[i128; 2])| {
            [(a + c).div_euclid(2), (b + d + 1).div_euclid(2)]
        };
        let image = self.images[i].iter().zip(&self.images[j]).map(mean).collect::<Vec<_>>();
        let with = |replaced: usize| {
            let (mut corners, mut images) = (self.corners.clone(), self.images.clone());
            corners[replaced].clone_from(&middle);
            images[replaced].clone_from(&image);
            LoopPiece { corners, images, share: 0.5 * self.share }
        };
        Some([with(j), with(i)])
    }
}

/// The weight of a corner: a constant, and a factor for each coordinate.
type Weight = Vec<i128>;

/// Reads where the axes are next.
pub(super) fn read_next<R: BufRead>(
    lines: &mut Lines<R>,
    statement: &mut Statement,
) -> Result<(), Refusal> {
    let mut words = lines.expect("next")?;
    let count = words.count("the number of axes")?;
    if count > 0 {
        statement.finest = words.number("the longest edge")?;
    }
    words.end()?;
    if count != 0 && count != statement.axes.len() {
        return rejected("the next sample is said of some axes and not of others");
    }
    for _ in 0..count {
        let mut words = lines.expect("n")?;
        let next = next_of_axis(&mut words, statement)?;
        words.end()?;
        statement.next.push(next);
    }
    if count > 0 {
        let mut words = lines.expect("goal")?;
        let axes = words.count("the number of axes")?;
        if axes != 0 && axes != count {
            return rejected("the goal is said of some axes and not of others");
        }
        for _ in 0..axes {
            let lower = words.number("the lower end of the goal")?;
            statement.goal.push([lower, words.number("the upper end of the goal")?]);
        }
        words.end()?;
    }
    Ok(())
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
pub(super) fn image(statement: &Statement, x: &[Dyadic]) -> Result<Image, Refusal> {
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

/// The claims that are proved of a loop.
#[derive(Debug)]
pub(super) struct ProvedLoop {
    /// The share of the box that is taken by pieces with plans whose next states are in such pieces
    /// again.
    pub(super) stays: f64,
    /// The share of those from which the loop reaches the goal, and the most steps that it takes.
    pub(super) reaches: Option<(f64, u64)>,
}

/// Cuts the cells with plans into pieces whose edges are at most so long, as a share of the side.
fn cut(cells: &mut Vec<LoopCell>, finest: f64) -> Result<(), Refusal> {
    let most = (finest * UNITS as f64).powi(2);
    let mut next = 0;
    while next < cells.len() {
        if let LoopCell::Plan(piece) = &cells[next]
            && let (edge, length) = piece.longest()
            && length > most
            && !piece.images.is_empty()
            && let Some(halves) = piece.halves(edge)
        {
            if cells.len() > MOST_PIECES {
                return rejected("there are too many pieces for the loop: ask for longer edges");
            }
            let numbers = [cells.len(), cells.len() + 1];
            cells[next] = LoopCell::Cut { edge, halves: numbers };
            cells.extend(halves.map(LoopCell::Plan));
        }
        next += 1;
    }
    Ok(())
}

/// Proves where the loop stays, and from where it reaches the goal.
pub(super) fn prove(
    mut cells: Vec<LoopCell>,
    statement: &Statement,
) -> Result<ProvedLoop, Refusal> {
    let axes = statement.axes.len();
    cut(&mut cells, statement.finest)?;
    let mut met: Vec<Vec<u32>> = Vec::with_capacity(cells.len());
    let mut is_in = Vec::with_capacity(cells.len());
    for cell in &cells {
        let found = match cell {
            LoopCell::Plan(piece) if !piece.images.is_empty() => {
                meets(&cells, &piece.images, axes)?
            }
            _ => None,
        };
        is_in.push(found.is_some());
        met.push(found.unwrap_or_default());
    }
    loop {
        let leaves = |k: &usize| is_in[*k] && met[*k].iter().any(|other| !is_in[*other as usize]);
        let leaving: Vec<usize> = (0..cells.len()).filter(leaves).collect();
        if leaving.is_empty() {
            break;
        }
        leaving.iter().for_each(|&k| is_in[k] = false);
    }
    let share = |is_asked: &dyn Fn(usize) -> bool| {
        let own = cells.iter().enumerate().map(|(k, cell)| match cell {
            LoopCell::Plan(piece) if is_asked(k) => piece.share,
            _ => 0.0,
        });
        own.sum::<f64>()
    };
    let stays = share(&|k| is_in[k]);
    if statement.goal.is_empty() {
        return Ok(ProvedLoop { stays, reaches: None });
    }
    // After how many steps a piece is in the goal at the latest.
    let mut steps: Vec<Option<u64>> = Vec::with_capacity(cells.len());
    for (cell, is_in) in cells.iter().zip(&is_in) {
        let is_there = match cell {
            LoopCell::Plan(piece) if *is_in => piece.is_in_goal(statement)?,
            _ => false,
        };
        steps.push(is_there.then_some(0));
    }
    let mut last = 0;
    loop {
        let arrives = |k: &usize| {
            let is_known = |other: &u32| steps[*other as usize].is_some();
            is_in[*k] && steps[*k].is_none() && met[*k].iter().all(is_known)
        };
        let arriving: Vec<usize> = (0..cells.len()).filter(arrives).collect();
        if arriving.is_empty() {
            break;
        }
        last += 1;
        arriving.iter().for_each(|&k| steps[k] = Some(last));
    }
    let reaches = Some((share(&|k| steps[k].is_some()), last));
    Ok(ProvedLoop { stays, reaches })
}

/// The pieces that may meet the next states of a piece; `None` if one of them has no plan.
fn meets(
    cells: &[LoopCell],
    images: &[Vec<[i128; 2]>],
    axes: usize,
) -> Result<Option<Vec<u32>>, Refusal> {
    let mut met = Vec::new();
    let mut waiting: Vec<(usize, Vec<Weight>)> = whole(axes).into_iter().enumerate().collect();
    while let Some((number, weights)) = waiting.pop() {
        if is_apart(&weights, images)? {
            continue;
        }
        match &cells[number] {
            LoopCell::NoPlan => return Ok(None),
            LoopCell::Plan(piece) if piece.images.is_empty() => return Ok(None),
            LoopCell::Plan(_) => met.push(number as u32),
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
fn is_apart(weights: &[Weight], images: &[Vec<[i128; 2]>]) -> Result<bool, Refusal> {
    for weight in weights {
        let mut is_negative = true;
        for image in images {
            let mut most = Some(weight[0]);
            for (&factor, [lower, upper]) in weight[1..].iter().zip(image) {
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
