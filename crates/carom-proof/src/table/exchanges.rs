//! The programs that a device solves: how many exchanges that takes.
//!
//! With the integers of a cell, a strictly convex program has slacks `s = M l + b` at multipliers
//! l, where b depends on the state. The device takes the first row with a negative entry of b and
//! exchanges its slack with its multiplier; if the diagonal of M is not positive there, it
//! exchanges the first pair with a positive entry in that row before. The states of a cell that
//! take the same way keep some linear inequalities, so that they are a polytope. All ways
//! are followed from the whole cell on, in exact arithmetic.
//!
//! Entries are `A / D` for whole numbers A and a D in common (E. H. Bareiss, Sylvester's identity
//! and multistep integer-preserving Gaussian elimination, Math. Comp. 22, 1968). Slacks are counted
//! in units of `2^-scale`, so that all numbers are whole in the beginning.

use crate::text::{Refusal, rejected};
use num_bigint::{BigInt, Sign};
use std::collections::HashMap;
use std::rc::Rc;

/// The most tableaus that one cell may lead to.
const MOST_WAYS: usize = 20_000;

/// A point in homogeneous coordinates: a positive number, and the states multiplied by it.
pub(super) type Point = Vec<BigInt>;

/// A corner of a convex hull: weights of the corners of a cell, up to a positive factor, and which
/// of the inequalities so far are tight there, by bits.
#[derive(Debug, Clone)]
pub(super) struct HullCorner {
    pub(super) at: Vec<BigInt>,
    tight: u128,
}

/// A program at some active rows.
#[derive(Debug)]
pub(super) struct Tableau {
    /// Of rows, inputs and columns.
    entries: Vec<Vec<BigInt>>,
    /// By row: a constant, and factors of states.
    pub(super) right: Vec<Vec<BigInt>>,
    pub(super) common: BigInt,
    /// Whether the row has changed places.
    exchanged: Vec<bool>,
}

/// A program, and the tableaus that its ways lead to.
#[derive(Debug)]
pub(super) struct Program {
    rows: usize,
    pub(super) scale: u64,
    negative: BigInt,
    positive: BigInt,
    known: HashMap<Vec<usize>, Rc<Tableau>>,
    ways: usize,
}

/// A float as a multiple of `2^-scale`.
fn whole(value: f64, scale: u64) -> BigInt {
    let biased = ((value.to_bits() >> 52) & 0x7ff) as i64;
    let fraction = value.to_bits() & ((1 << 52) - 1);
    let mantissa = BigInt::from(if biased == 0 { fraction } else { fraction | 1 << 52 });
    let shift = (scale as i64 + biased.max(1) - 1075).max(0) as u64;
    let whole = mantissa << shift;
    if value < 0.0 { -whole } else { whole }
}

/// The scale with which floats are whole.
fn common_scale(values: &[f64]) -> u64 {
    let exponent = |value: &f64| 1075 - (((value.to_bits() >> 52) & 0x7ff) as i64).max(1);
    values.iter().filter(|value| **value != 0.0).map(exponent).max().unwrap_or(0).max(0) as u64
}

pub(super) fn dot(a: &[BigInt], b: &[BigInt]) -> BigInt {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// The same point in the least whole numbers.
fn reduced(point: Point) -> Point {
    let mut divisor = BigInt::ZERO;
    for value in &point {
        let mut rest = value.clone();
        while rest.sign() != Sign::NoSign {
            (divisor, rest) = (rest.clone(), divisor % rest);
        }
    }
    if divisor.sign() == Sign::Minus {
        divisor = -divisor;
    }
    point.into_iter().map(|value| value / &divisor).collect()
}

/// The part of a convex hull at which a function is not positive, as the hull of its corners. The
/// number is that of this inequality.
///
/// An edge joins two corners if no third one is on all inequalities that are tight at both (T. S.
/// Motzkin and others, The double description method, 1953). Without a bit for the inequality, all
/// pairs are joined: what is between them is in the hull, too.
fn clipped(corners: &[HullCorner], of: &[BigInt], number: u32) -> Vec<HullCorner> {
    let values: Vec<BigInt> = corners.iter().map(|corner| dot(of, &corner.at)).collect();
    let bit = 1_u128.checked_shl(number).unwrap_or(0);
    let mut part: Vec<HullCorner> = Vec::new();
    for (k, (corner, value)) in corners.iter().zip(&values).enumerate() {
        if value.sign() != Sign::Plus {
            let tight =
                if value.sign() == Sign::NoSign { corner.tight | bit } else { corner.tight };
            part.push(HullCorner { at: corner.at.clone(), tight });
            continue;
        }
        let below = corners.iter().zip(&values).enumerate();
        for (l, (other, below)) in below.filter(|(_, (_, below))| below.sign() == Sign::Minus) {
            let both = corner.tight & other.tight;
            let is_between =
                |(m, third): (usize, &HullCorner)| m != k && m != l && third.tight & both == both;
            if bit != 0 && corners.iter().enumerate().any(is_between) {
                continue;
            }
            let between = corner.at.iter().zip(&other.at).map(|(a, b)| b * value - a * below);
            part.push(HullCorner { at: reduced(between.collect()), tight: both | bit });
        }
    }
    part
}

impl Tableau {
    fn exchange(&self, p: usize) -> Result<Self, Refusal> {
        let pivot = &self.entries[p][p];
        if pivot.sign() != Sign::Plus {
            return rejected("a program exchanges a pair without a positive diagonal");
        }
        let mixed = |i: usize, entry: &BigInt, own: &BigInt| {
            (entry * pivot - &self.entries[i][p] * own) / &self.common
        };
        let (mut entries, mut right) = (Vec::new(), Vec::new());
        for i in 0..self.entries.len() {
            let each = |of: &[BigInt], own: &[BigInt]| match i == p {
                true => own.iter().map(|own| -own).collect::<Vec<_>>(),
                false => of.iter().zip(own).map(|(of, own)| mixed(i, of, own)).collect(),
            };
            let mut row = each(&self.entries[i], &self.entries[p]);
            row[p] = if i == p { self.common.clone() } else { self.entries[i][p].clone() };
            entries.push(row);
            right.push(each(&self.right[i], &self.right[p]));
        }
        let mut exchanged = self.exchanged.clone();
        exchanged[p] = !exchanged[p];
        Ok(Tableau { entries, right, common: pivot.clone(), exchanged })
    }
}

impl Program {
    /// A program of so many rows and states: `M` with functions behind it, then right sides.
    pub(super) fn new(
        (rows, states): (usize, usize),
        matrix: &[f64],
        right: &[f64],
        [negative, positive]: [f64; 2],
    ) -> Result<Self, Refusal> {
        if negative >= 0.0 || positive <= 0.0 {
            return rejected("the limits of signs are on the wrong sides of 0");
        }
        let scale = common_scale(&[matrix, right, &[negative, positive]].concat());
        if scale > 2000 {
            return rejected("a number of a program is too small");
        }
        let whole_row = |row: &[f64]| row.iter().map(|&value| whole(value, scale)).collect();
        let right: Vec<Vec<BigInt>> = right.chunks(states + 1).map(whole_row).collect();
        let start = Tableau {
            entries: (0..right.len())
                .map(|i| whole_row(&matrix[i * rows..(i + 1) * rows]))
                .collect(),
            common: BigInt::from(1),
            exchanged: vec![false; right.len()],
            right,
        };
        let [negative, positive] = [negative, positive].map(|value| whole(value, scale));
        let known = HashMap::from([(Vec::new(), Rc::new(start))]);
        Ok(Program { rows, scale, negative, positive, known, ways: 0 })
    }

    fn tableau(&mut self, path: &[usize]) -> Result<Rc<Tableau>, Refusal> {
        if let Some(known) = self.known.get(path) {
            return Ok(Rc::clone(known));
        }
        // The first one is known.
        let (last, before) = path.split_last().unwrap_or((&0, &[]));
        let found = Rc::new(self.tableau(before)?.exchange(*last)?);
        self.known.insert(path.to_vec(), Rc::clone(&found));
        Ok(found)
    }

    /// The right side of a row less the limit of negative ones, up to a positive factor.
    fn above_negative(&self, tableau: &Tableau, row: usize) -> Vec<BigInt> {
        let shift = if tableau.exchanged[row] { self.scale } else { 0 };
        let mut of: Vec<BigInt> = tableau.right[row].iter().map(|value| value << shift).collect();
        of[0] -= &self.negative * &tableau.common;
        of
    }

    /// The pairs that are exchanged for a negative row.
    fn pairs(&self, tableau: &Tableau, k: usize) -> Result<Vec<usize>, Refusal> {
        let is_positive = |j: &usize| {
            let moved = u64::from(tableau.exchanged[k]) + u64::from(tableau.exchanged[*j]);
            let entry = &tableau.entries[k][*j] << (moved * self.scale);
            entry > &self.positive * &tableau.common
        };
        if is_positive(&k) {
            return Ok(vec![k]);
        }
        match (0..self.rows).find(is_positive) {
            Some(j) => Ok(vec![j, k]),
            None => rejected("a program has no exchange at some states of a cell"),
        }
    }

    /// The most exchanges at states of a simplex with these corners, of at most so many. The last
    /// function is called at the end of each way.
    pub(super) fn follow(
        &mut self,
        corners: &[Point],
        most: usize,
        end: &mut impl FnMut(&Tableau, &[HullCorner]) -> Result<(), Refusal>,
    ) -> Result<usize, Refusal> {
        self.ways = MOST_WAYS;
        // Each corner of a simplex is on all sides but one.
        let sides = corners.len() as u32;
        let corner = |k: u32| HullCorner {
            at: (0..sides).map(|l| BigInt::from(u8::from(k == l))).collect(),
            tight: ((1_u128 << sides) - 1) ^ (1_u128 << k),
        };
        let whole = (0..sides).map(corner).collect();
        self.walk(&mut Vec::new(), (whole, sides), (corners, most), end)
    }

    fn walk(
        &mut self,
        path: &mut Vec<usize>,
        (mut rest, mut number): (Vec<HullCorner>, u32),
        (corners, left): (&[Point], usize),
        end: &mut impl FnMut(&Tableau, &[HullCorner]) -> Result<(), Refusal>,
    ) -> Result<usize, Refusal> {
        self.ways -= 1;
        if self.ways == 0 {
            return rejected("a program has too many ways in a cell");
        }
        let tableau = self.tableau(path)?;
        let mut next = Vec::new();
        for row in 0..self.rows {
            let above = self.above_negative(&tableau, row);
            let above: Vec<BigInt> = corners.iter().map(|corner| dot(&above, corner)).collect();
            let seen = clipped(&rest, &above, number);
            if !seen.is_empty() {
                next.push((row, (seen, number + 1)));
            }
            let below: Vec<BigInt> = above.into_iter().map(|value| -value).collect();
            rest = clipped(&rest, &below, number);
            number += 1;
        }
        if !rest.is_empty() {
            end(&tableau, &rest)?;
        }
        let mut longest = 0;
        for (k, part) in next {
            if left == 0 {
                return rejected("a program takes more exchanges than is said");
            }
            let length = path.len();
            path.extend(self.pairs(&tableau, k)?);
            longest = longest.max(1 + self.walk(path, part, (corners, left - 1), end)?);
            path.truncate(length);
        }
        Ok(longest)
    }
}
