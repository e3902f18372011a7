//! The exchanges that a device makes over the cells of some integers.
//!
//! Only signs decide what a device exchanges, and right sides are affine in the state. So the
//! states of a cell that take the same way are a polytope, the convex hull of points, and each sign
//! cuts it. Where the device's rounding leaves a sign open, a state is on both sides. So the most
//! exchanges on a way are a bound for all states of the cell, and what rounding may do up to the
//! end of each way is known.

use std::collections::{HashMap, HashSet};
use std::rc::Rc;

use crate::arrays::LawOutput;
use crate::bounds::{self, Coefficients};
use crate::condensed::CondensedProgram;
use crate::form::ParametricForm;
use crate::tableau::ExchangeTableau;

/// The most exchanges of a program, and the most tableaus that a cell may lead to.
const MOST_EXCHANGES: usize = 24;
const MOST_WAYS: usize = 100;

/// The most rows of a program.
const MOST_DEVICE_ROWS: usize = 40;

/// By how much a row that the device does not know may be missed, in units of its slack.
const UNKNOWN_ROW: f64 = 1e-9;

/// Numbers of a program are 0 or between these, in magnitude.
const LEAST_NUMBER: f64 = 1e-30;
const LARGEST_NUMBER: f64 = 1e30;

/// By how many bounds of the first right sides' errors an entry is negative.
const NEGATIVE_ERRORS: f64 = 8.0;
const LEAST_ERROR: f64 = 1e-12;

/// Entries above so many roundings are positive; and at least above those of this crate.
const POSITIVE_UNITS: f64 = 4096.0;
const LEAST_POSITIVE: f64 = 1e-9;

/// Points that are so near are one, in shares of the sides.
const SAME_POINT: f64 = 1e-13;

/// The most points of a part of a cell.
const MOST_WAY_POINTS: usize = 40;

/// The largest error at the end of a way, in roundings, or in units of slacks and inputs if that is
/// more. Cells with larger ones keep their explicit laws.
const MOST_ERROR_UNITS: f64 = 16384.0;
const MOST_ERROR: f64 = 1e-6;

/// The corners of a simplex, as shares of the sides of the box.
pub(crate) type ShareCorners = Vec<Vec<f64>>;

/// A program as a device has it.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct DeviceProgram {
    pub(crate) rows: usize,
    /// `M`, then right sides, see `LookupProgram`.
    pub(crate) numbers: Vec<f64>,
    pub(crate) negative: f64,
    pub(crate) positive: f64,
    pub(crate) exchanges: usize,
}

/// The most that rounding does at the end of a solve.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct SolveErrors {
    /// By how much a row is missed, in its own unit.
    pub(crate) missed: f64,
    /// By how much the cost may be above that of the optimum with the same integers.
    pub(crate) loss: f64,
    /// By how much an input is off.
    pub(crate) input: f64,
}

/// A program, and the cells whose ways end.
#[derive(Debug)]
pub(crate) struct FollowedProgram {
    pub(crate) program: DeviceProgram,
    /// The functions of the program that are the columns, as numbers of a program are.
    pub(crate) columns: Vec<f64>,
    /// By how much coefficients of the cost are above those of the explicit law, a cell; `None` if
    /// its ways do not end.
    pub(crate) excess: Vec<Option<f64>>,
    pub(crate) errors: SolveErrors,
}

/// A cell whose ways are followed.
#[derive(Debug)]
pub(crate) struct FollowedCell {
    pub(crate) corners: ShareCorners,
    /// The cost of its explicit law.
    pub(crate) cost: Coefficients,
}

/// Why a simplex cannot be followed.
enum Obstacle {
    /// This function is missed: a row that the device does not know.
    Row(usize),
    /// The ways are too long, too many, or signs of entries are not known.
    Lost,
}

/// The tableaus that ways lead to.
struct Follower<'a> {
    form: &'a ParametricForm,
    known: HashMap<Vec<usize>, Option<Rc<ExchangeTableau>>>,
    negative: f64,
    positive: f64,
    /// Tableaus that the cell may still lead to.
    ways: usize,
    /// The largest right side's error at an end, and that of an input.
    error: f64,
    input: f64,
    /// Larger ones are no end.
    most_error: f64,
    /// The largest excess of the cell's cost.
    excess: f64,
}

/// The part of a convex hull in which an affine function is not positive, as the hull of points. Of
/// two points on both sides, that between them is one, also if they are no ends of an edge.
fn clipped(points: &[Vec<f64>], of: impl Fn(&[f64]) -> f64) -> Vec<Vec<f64>> {
    let values: Vec<f64> = points.iter().map(|point| of(point)).collect();
    let mut part: Vec<Vec<f64>> = Vec::new();
    for (point, value) in points.iter().zip(&values) {
        if *value <= 0.0 {
            part.push(point.clone());
            continue;
        }
        for (other, below) in points.iter().zip(&values).filter(|(_, below)| **below < 0.0) {
            let share = value / (value - below);
            let between = point.iter().zip(other).map(|(a, b)| a + share * (b - a));
            let between: Vec<f64> = between.collect();
            let is_near = |known: &Vec<f64>| {
                known.iter().zip(&between).all(|(a, b)| (a - b).abs() < SAME_POINT)
            };
            if !part.iter().any(is_near) {
                part.push(between);
            }
        }
    }
    part
}

impl Follower<'_> {
    fn tableau(&mut self, path: &[usize]) -> Option<Rc<ExchangeTableau>> {
        if let Some(known) = self.known.get(path) {
            return known.clone();
        }
        let (last, before) = path.split_last()?;
        let found = self.tableau(before).and_then(|before| {
            let mut tableau = (*before).clone();
            tableau.exchange(*last)?;
            Some(Rc::new(tableau))
        });
        self.known.insert(path.to_vec(), found.clone());
        found
    }

    /// Notes what rounding does at the end of a way, and the cost.
    fn end(
        &mut self,
        tableau: &ExchangeTableau,
        points: &[Vec<f64>],
        cost: &Coefficients,
    ) -> Result<(), Obstacle> {
        let unknown = tableau.rows + tableau.outputs;
        for row in unknown..unknown + tableau.unknown {
            if points.iter().any(|point| tableau.right_at(row, point) < -UNKNOWN_ROW) {
                return Err(Obstacle::Row(row));
            }
        }
        let errors = tableau.right_error[..tableau.rows].iter().copied();
        let error = errors.fold(0.0, f64::max);
        let inputs = &tableau.right_error[tableau.rows..unknown];
        let input = inputs.iter().copied().fold(0.0, f64::max);
        if error.max(input) > self.most_error {
            return Err(Obstacle::Lost);
        }
        (self.error, self.input) = (self.error.max(error), self.input.max(input));
        // Points end with the weights of the cell's corners.
        let (axes, first) = (self.form.axes.len(), unknown + tableau.unknown);
        let column = |j: usize, point: &[f64]| tableau.right_at(first + j, point);
        let plan = |point: &Vec<f64>| (0..self.form.columns()).map(|j| column(j, point)).collect();
        let plans: Vec<Vec<f64>> = points.iter().map(plan).collect();
        let plans: Vec<&[f64]> = plans.iter().map(Vec::as_slice).collect();
        let own = bounds::cost(self.form, &plans);
        let pairs = (0..points.len()).flat_map(|v| (0..=v).map(move |w| (v, w)));
        for ((v, w), own) in pairs.zip(own) {
            let law = between(cost, &points[v][axes..], &points[w][axes..]);
            self.excess = self.excess.max(own - law);
        }
        Ok(())
    }

    /// The most exchanges from a tableau on, anywhere in the convex hull of points.
    fn follow(
        &mut self,
        path: &mut Vec<usize>,
        points: &[Vec<f64>],
        cost: &Coefficients,
        left: usize,
    ) -> Result<usize, Obstacle> {
        let tableau = self.tableau(path).ok_or(Obstacle::Lost)?;
        self.ways = self.ways.checked_sub(1).ok_or(Obstacle::Lost)?;
        let mut rest = points.to_vec();
        let mut next = Vec::new();
        for row in 0..tableau.rows {
            let error = tableau.right_error[row];
            let right = |point: &[f64]| tableau.right_at(row, point);
            let seen = clipped(&rest, |point| right(point) - self.negative - error);
            if !seen.is_empty() {
                next.push((row, seen));
            }
            rest = clipped(&rest, |point| self.negative - error - right(point));
            if rest.len() > MOST_WAY_POINTS {
                return Err(Obstacle::Lost);
            }
        }
        if !rest.is_empty() {
            self.end(&tableau, &rest, cost)?;
        }
        let mut longest = 0;
        for (k, points) in next {
            if left == 0 {
                return Err(Obstacle::Lost);
            }
            let length = path.len();
            path.extend(self.pairs(&tableau, k)?);
            let own = self.follow(path, &points, cost, left - 1);
            path.truncate(length);
            longest = longest.max(1 + own?);
        }
        Ok(longest)
    }

    /// The pairs that a device exchanges for a negative entry k.
    fn pairs(&self, tableau: &ExchangeTableau, k: usize) -> Result<Vec<usize>, Obstacle> {
        let sign = |j: usize| {
            let entry = tableau.entries[k][j];
            match entry.value > self.positive {
                true if entry.value - entry.error > self.positive => Ok(true),
                false if entry.value + entry.error <= self.positive => Ok(false),
                _ => Err(Obstacle::Lost),
            }
        };
        if sign(k)? {
            return Ok(vec![k]);
        }
        for j in 0..tableau.rows {
            if sign(j)? {
                return Ok(vec![j, k]);
            }
        }
        Err(Obstacle::Lost)
    }
}

/// A quadratic form over the corners of a cell, between two points.
fn between(cost: &Coefficients, first: &[f64], second: &[f64]) -> f64 {
    let pairs = (0..first.len()).flat_map(|v| (0..=v).map(move |w| (v, w)));
    let weight = |(v, w): (usize, usize)| match v == w {
        true => first[v] * second[v],
        false => first[v] * second[w] + first[w] * second[v],
    };
    pairs.zip(cost).map(|(pair, cost)| weight(pair) * cost).sum()
}

/// The corners of a cell, each with its weights behind.
fn weighted(corners: &ShareCorners) -> ShareCorners {
    let with = |(v, corner): (usize, &Vec<f64>)| {
        let weights = (0..corners.len()).map(|w| f64::from(u8::from(v == w)));
        corner.iter().copied().chain(weights).collect()
    };
    corners.iter().enumerate().map(with).collect()
}

/// The range of each state over cells, as shares of the sides.
fn reach(cells: &[FollowedCell]) -> Vec<[f64; 2]> {
    let mut corners = cells.iter().flat_map(|cell| &cell.corners);
    let first = corners.next().map(|corner| corner.iter().map(|&x| [x, x]).collect());
    corners.fold(first.unwrap_or_default(), |mut all: Vec<[f64; 2]>, corner| {
        for ([least, most], &x) in all.iter_mut().zip(corner) {
            (*least, *most) = (least.min(x), most.max(x));
        }
        all
    })
}

/// The rows that are active at some corner, those that are so more often first, and the set that is
/// active most often.
fn usual_rows(full: &ExchangeTableau, cells: &[FollowedCell]) -> Option<(Vec<usize>, Vec<usize>)> {
    let mut seen = HashSet::new();
    let mut sets: HashMap<Vec<usize>, usize> = HashMap::new();
    let mut counts = vec![0; full.rows];
    for corner in cells.iter().flat_map(|cell| &cell.corners) {
        let bits: Vec<u64> = corner.iter().map(|x| x.to_bits()).collect();
        if !seen.insert(bits) {
            continue;
        }
        let active = full.clone().active_rows(corner)?;
        let set: Vec<usize> = (0..full.rows).filter(|row| active[*row]).collect();
        set.iter().for_each(|&row| counts[row] += 1);
        *sets.entry(set).or_default() += 1;
    }
    // The first one in order, of several that are as frequent.
    let usual = sets.into_iter().max_by(|a, b| a.1.cmp(&b.1).then_with(|| b.0.cmp(&a.0)));
    let mut rows: Vec<usize> = (0..full.rows).filter(|row| counts[*row] > 0).collect();
    rows.sort_by_key(|&row| std::cmp::Reverse(counts[row]));
    Some((rows, usual.map(|(set, _)| set).unwrap_or_default()))
}

/// The tableau of some rows in which the usual ones are active.
fn begun(full: &ExchangeTableau, rows: &[usize], usual: &[usize]) -> Option<ExchangeTableau> {
    let mut tableau = full.with_rows(rows);
    let mut waiting: Vec<usize> = (0..rows.len()).filter(|k| usual.contains(&rows[*k])).collect();
    while !waiting.is_empty() {
        let diagonal = |k: usize| tableau.entries[k][k].value;
        let best = (0..waiting.len())
            .max_by(|&a, &b| diagonal(waiting[a]).total_cmp(&diagonal(waiting[b])))?;
        let k = waiting.swap_remove(best);
        if diagonal(k) <= LEAST_POSITIVE {
            return None;
        }
        tableau.exchange(k)?;
    }
    Some(tableau)
}

impl FollowedProgram {
    /// The program of these integers, for these cells, with so large roundings; `None` if there is
    /// none.
    pub(crate) fn new(
        form: &ParametricForm,
        outputs: &[LawOutput],
        integers: &[f64],
        cells: &[FollowedCell],
        unit: f64,
    ) -> Option<Self> {
        let condensed = CondensedProgram::new(form, outputs, integers)?;
        let (full, scales) = ExchangeTableau::new(&condensed)?;
        let (mut rows, usual) = usual_rows(&full, cells)?;
        while rows.len() <= MOST_DEVICE_ROWS {
            let start = begun(&full, &rows, &usual)?.stored(unit, reach(cells));
            let largest = start.right_error[..start.rows].iter().copied().fold(0.0, f64::max);
            // Numbers of all devices.
            let narrow = |value: f64| f64::from(value as f32);
            let negative = narrow(-NEGATIVE_ERRORS * largest.max(LEAST_ERROR));
            let positive = narrow((POSITIVE_UNITS * unit).max(LEAST_POSITIVE));
            let mut follower = Follower {
                form,
                known: HashMap::from([(Vec::new(), Some(Rc::new(start.clone())))]),
                negative,
                positive,
                ways: 0,
                error: 0.0,
                input: 0.0,
                most_error: (MOST_ERROR_UNITS * unit).max(MOST_ERROR),
                excess: 0.0,
            };
            let (mut excess, mut exchanges, mut missing) = (Vec::new(), 0, None);
            for cell in cells {
                follower.excess = 0.0;
                follower.ways = MOST_WAYS;
                let corners = weighted(&cell.corners);
                let found = follower.follow(&mut Vec::new(), &corners, &cell.cost, MOST_EXCHANGES);
                excess.push(found.is_ok().then_some(follower.excess));
                match found {
                    Ok(most) => exchanges = exchanges.max(most),
                    Err(Obstacle::Row(function)) => {
                        missing = Some(function);
                        break;
                    }
                    Err(Obstacle::Lost) => {}
                }
            }
            if let Some(function) = missing {
                let mut others = (0..full.rows).filter(|row| !rows.contains(row));
                rows.push(others.nth(function - rows.len() - outputs.len())?);
                continue;
            }
            let entries = start.entries[..start.rows + outputs.len()].iter().flatten();
            let matrix = entries.map(|entry| entry.value);
            let right = start.right[..start.rows + outputs.len()].iter().flatten().copied();
            // An entry that counts as 0 is off by so much. A multiplier that is negative by that
            // may save as much for each unit of slack.
            let off = follower.error - negative;
            let unit_of = |row: usize| scales[row] * condensed.units[row];
            let known = rows.iter().map(|&row| unit_of(row)).fold(0.0, f64::max);
            let all = (0..full.rows).map(unit_of).fold(0.0, f64::max);
            let missed = (off * known).max(UNKNOWN_ROW * all);
            let slacks: f64 = rows.iter().map(|&row| condensed.most[row] / scales[row]).sum();
            // What is left of differences that cancel is not a number to keep.
            let kept = |value: f64| if value.abs() < LEAST_NUMBER { 0.0 } else { value };
            let numbers: Vec<f64> = matrix.chain(right).map(kept).collect();
            if !numbers.iter().all(|value| value.abs() < LARGEST_NUMBER) {
                return None;
            }
            let program =
                DeviceProgram { rows: start.rows, numbers, negative, positive, exchanges };
            let errors = SolveErrors { missed, loss: off * slacks, input: follower.input };
            let columns = start.rows + start.outputs + start.unknown..start.entries.len();
            let matrix = start.entries[columns.clone()].iter().flatten().map(|entry| entry.value);
            let columns = matrix.chain(start.right[columns].iter().flatten().copied());
            let columns = columns.map(kept).collect();
            return Some(FollowedProgram { program, columns, excess, errors });
        }
        None
    }
}
