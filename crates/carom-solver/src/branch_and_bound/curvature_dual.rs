//! How much squares of binaries are raised for a high bound.
//!
//! For the multiples `u_j` of `z_j^2 - z_j` that a form gets, its relaxation has a least value. The
//! multiples with the highest one are those of a semidefinite relaxation (Billionnet, Elloumi and
//! Plateau, Improving the performance of standard solvers for quadratic 0-1 programs by a tight
//! convex reformulation: the QCR method, Discrete Applied Mathematics 157, 2009). With `2 z - 1`
//! for `z`, that is the relaxation of a largest cut of a graph, in which each column is a unit
//! vector. One vector after the other turns to where it costs least, and the length of its gradient
//! is its multiple (Wang and Kolter, Low-rank semidefinite programming for the MAX2SAT problem,
//! AAAI 2019). Rows get multipliers, which rise while they are violated.
//!
//! The result is a guess. What makes the form convex is proved behind it, as for any other.

use std::collections::{BTreeMap, BTreeSet};

use crate::random::SplitMix;
use crate::semidefinite::{Product, least_multiple};
use crate::sum::exact_sum;

/// How often each vector turns at most, and at least in a form that is not too large.
const MOST_TURNS: usize = 2000;
const FEWEST_TURNS: usize = 100;

/// The fewest bits of a multiple for columns far from 0, and those left for sums of several.
const FEWEST_BITS: f64 = 8.0;
const BITS_OF_SUMS: f64 = 8.0;

/// The change of the value in a round, relative to the value, at which rounds end (no unit).
const SETTLED_VALUE: f64 = 1e-8;

/// Most multiplications of all rounds together.
const MOST_MULTIPLICATIONS: usize = 200_000_000;

/// A row `terms <= limit`, or `terms = limit`, over the columns of a form by their places.
#[derive(Debug, Clone)]
pub(super) struct BinaryRow {
    pub(super) terms: Vec<(usize, f64)>,
    pub(super) limit: f64,
    pub(super) is_equation: bool,
}

impl BinaryRow {
    /// The rows that a row with two limits is, without columns that have one value only.
    ///
    /// # Arguments
    ///
    /// * `terms`: with the numbers of columns.
    /// * `fixed`: the value of a column that has one only.
    pub(super) fn of(
        terms: impl Iterator<Item = (usize, f64)>,
        [mut lower, mut upper]: [f64; 2],
        fixed: impl Fn(usize) -> Option<f64>,
    ) -> Vec<BinaryRow> {
        let mut open = Vec::new();
        for (j, a) in terms {
            match fixed(j) {
                Some(value) => {
                    lower -= a * value;
                    upper -= a * value;
                }
                None => open.push((j, a)),
            }
        }
        if open.is_empty() {
            return Vec::new();
        }
        if lower == upper {
            return vec![BinaryRow { terms: open, limit: upper, is_equation: true }];
        }
        let negated = open.iter().map(|&(j, a)| (j, -a)).collect();
        let below = BinaryRow { terms: negated, limit: -lower, is_equation: false };
        let above = BinaryRow { terms: open, limit: upper, is_equation: false };
        [below, above].into_iter().filter(|row| row.limit.is_finite()).collect()
    }
}

/// Products of columns with two values at most, `l` and `l + 1`, which are called by their numbers.
pub(super) struct BinaryBlock<'a> {
    /// In order, each pair once.
    pub(super) products: &'a [Product],
    pub(super) rows: &'a [BinaryRow],
    /// The bounds of a column.
    pub(super) ends: &'a dyn Fn(usize) -> [f64; 2],
    /// The linear coefficient of a column.
    pub(super) cost: &'a dyn Fn(usize) -> f64,
}

impl BinaryBlock<'_> {
    /// By column that is not fixed, the multiple of `(x - l)(x - l - 1)` that makes the bound high;
    /// it may be negative. `None` if the block is too large.
    pub(super) fn multiples(&self) -> Option<Vec<(usize, f64)>> {
        let members: BTreeSet<usize> = self.products.iter().flat_map(|&(a, b, _)| [a, b]).collect();
        let is_open = |j: &usize| {
            let [lower, upper] = (self.ends)(*j);
            lower < upper
        };
        let open: Vec<usize> = members.into_iter().filter(is_open).collect();
        let place: BTreeMap<usize, usize> = open.iter().copied().zip(0..).collect();
        let least = |j: usize| (self.ends)(j)[0];
        let mut linear: Vec<f64> = open.iter().map(|&j| (self.cost)(j)).collect();
        // x = l + t, and t is 0 or 1.
        let mut inner = Vec::new();
        for &(a, b, q) in self.products {
            let (first, second) = (place.get(&a), place.get(&b));
            first.iter().for_each(|k| linear[**k] += q * least(b));
            second.iter().for_each(|k| linear[**k] += q * least(a));
            inner.extend(first.zip(second).map(|(&i, &k)| (i, k, q)));
        }
        let moved = |row: &BinaryRow| {
            let below: f64 = row.terms.iter().map(|&(j, a)| a * least(j)).sum();
            let terms = row.terms.iter().map(|&(j, a)| (place[&j], a)).collect();
            BinaryRow { terms, limit: row.limit - below, is_equation: row.is_equation }
        };
        let rows = self.rows.iter().map(moved).collect();
        let multiples = BinaryForm { linear, products: inner, rows }.multiples()?;
        Some(open.into_iter().zip(multiples).collect())
    }
}

/// Amounts for the squares of columns with which a form is proved convex: multiples, and as much
/// more for each weight as they lack. `None` if no amount is enough.
///
/// # Arguments
///
/// * `products`: in order.
/// * `weights`: 1 for each column whose square may be raised.
pub(super) fn proved_amounts(
    products: &[Product],
    multiples: &[(usize, f64)],
    weights: &BTreeMap<usize, f64>,
) -> Option<Vec<(usize, f64)>> {
    let mut shifted: BTreeMap<(usize, usize), f64> =
        products.iter().map(|&(a, b, q)| ((a, b), q)).collect();
    for &(j, multiple) in multiples {
        *shifted.entry((j, j)).or_default() += multiple;
    }
    let shifted: Vec<Product> = shifted.into_iter().map(|((a, b), q)| (a, b, q)).collect();
    let more = least_multiple(&shifted, weights).ok()?;
    let amount = |&j: &usize| {
        let before = square_of(products, j);
        let after = square_of(&shifted, j) + more;
        let (amount, error) = exact_sum(after, -before);
        // No digit of the sum is lost.
        (j, if error == 0.0 { amount } else { after - before })
    };
    Some(weights.keys().map(amount).collect())
}

/// An amount for the square of a column, a little larger, so that nothing is rounded when
/// `amount (x - l)(x - u)` is added to an objective: terms that are large where `x` is far from 0
/// cancel.
pub(super) fn with_few_digits(amount: f64, square: f64, [lower, upper]: [f64; 2]) -> f64 {
    let reach = lower.abs().max(upper.abs());
    let size = amount.abs().max(square.abs());
    if reach <= 1.0 {
        return amount;
    }
    let bits = f64::from(f64::MANTISSA_DIGITS) - 2.0 * (reach.log2().floor() + 1.0);
    let unit = (size.log2().floor() + 1.0 - (bits - BITS_OF_SUMS).max(FEWEST_BITS)).exp2();
    if unit.is_normal() { (amount / unit).ceil() * unit } else { amount }
}

/// The coefficient of the square of a column in products that are in order.
pub(super) fn square_of(products: &[Product], j: usize) -> f64 {
    let place = products.binary_search_by_key(&(j, j), |&(a, b, _)| (a, b));
    place.map_or(0.0, |place| products[place].2)
}

/// A quadratic form over columns between 0 and 1, to minimise.
#[derive(Debug)]
struct BinaryForm {
    linear: Vec<f64>,
    /// Products of columns by their places, each pair once.
    products: Vec<Product>,
    rows: Vec<BinaryRow>,
}

impl BinaryForm {
    /// By column, the multiple of `z^2 - z` that makes the bound high; it may be negative. `None`
    /// if the form is too large.
    fn multiples(&self) -> Option<Vec<f64>> {
        let size = self.linear.len();
        // As many dimensions as a best point of the relaxation needs.
        let rank = (2.0 * (size + 1) as f64).sqrt().ceil() as usize + 1;
        let work = rank * (2 * self.products.len() + 4 * size);
        let turns = (MOST_MULTIPLICATIONS / work.max(1)).min(MOST_TURNS);
        (turns >= FEWEST_TURNS).then(|| Vectors::new(self, rank).settle(turns))
    }
}

/// The unit vectors of the columns and, at the end, of the number 1.
struct Vectors<'a> {
    form: &'a BinaryForm,
    rank: usize,
    vectors: Vec<f64>,
    /// By column: the columns of its products, and a quarter of the entries of the matrix.
    neighbours: Vec<Vec<(usize, f64)>>,
    squares: Vec<f64>,
    /// By column, the product with the number 1 without the rows.
    own: Vec<f64>,
    multipliers: Vec<f64>,
    gradient: Vec<f64>,
}

impl<'a> Vectors<'a> {
    fn new(form: &'a BinaryForm, rank: usize) -> Self {
        let size = form.linear.len();
        let mut neighbours = vec![Vec::new(); size];
        let mut squares = vec![0.0; size];
        let mut own: Vec<f64> = form.linear.iter().map(|cost| 0.25 * cost).collect();
        for &(a, b, q) in &form.products {
            if a == b {
                squares[a] += q;
                own[a] += 0.25 * q;
            } else {
                neighbours[a].push((b, 0.125 * q));
                neighbours[b].push((a, 0.125 * q));
                own[a] += 0.125 * q;
                own[b] += 0.125 * q;
            }
        }
        let mut random = SplitMix(size as u64);
        let mut vectors: Vec<f64> = (0..(size + 1) * rank).map(|_| random.part() - 0.5).collect();
        vectors.chunks_mut(rank).for_each(|vector| {
            let length = vector.iter().map(|v| v * v).sum::<f64>().sqrt();
            vector.iter_mut().for_each(|v| *v /= length.max(f64::MIN_POSITIVE));
        });
        let (multipliers, gradient) = (vec![0.0; form.rows.len()], vec![0.0; rank]);
        Vectors { form, rank, vectors, neighbours, squares, own, multipliers, gradient }
    }

    fn vector(&self, j: usize) -> &[f64] {
        &self.vectors[j * self.rank..(j + 1) * self.rank]
    }

    /// Turns all vectors until their value settles, and returns the multiples.
    fn settle(mut self, turns: usize) -> Vec<f64> {
        let size = self.own.len();
        let mean = |sum: f64| sum / size.max(1) as f64;
        let entries = self.neighbours.iter().flatten().map(|(_, q)| 4.0 * q.abs());
        let scale = mean(entries.chain(self.squares.iter().map(|q| q.abs())).sum());
        let mut before = f64::INFINITY;
        for _ in 0..turns {
            let links = self.links();
            let value: f64 = (0..=size).map(|j| self.turn(j, &links)).sum();
            let has_moved = self.raise_multipliers(scale);
            if !has_moved && (before - value).abs() <= SETTLED_VALUE * value.abs() {
                break;
            }
            before = value;
        }
        let links = self.links();
        (0..size).map(|j| 4.0 * self.pull(j, &links) - self.squares[j]).collect()
    }

    /// By column, the product with the number 1.
    fn links(&self) -> Vec<f64> {
        let mut links = self.own.clone();
        for (row, multiplier) in self.form.rows.iter().zip(&self.multipliers) {
            row.terms.iter().for_each(|&(j, a)| links[j] += 0.25 * multiplier * a);
        }
        links
    }

    /// The length of the gradient of a vector, which is computed.
    fn pull(&mut self, j: usize, links: &[f64]) -> f64 {
        let size = links.len();
        let mut gradient = std::mem::take(&mut self.gradient);
        gradient.fill(0.0);
        let mut add = |other: usize, factor: f64| {
            gradient.iter_mut().zip(self.vector(other)).for_each(|(g, v)| *g += factor * v);
        };
        if j == size {
            links.iter().enumerate().for_each(|(other, &link)| add(other, link));
        } else {
            self.neighbours[j].iter().for_each(|&(other, q)| add(other, q));
            add(size, links[j]);
        }
        let length = gradient.iter().map(|g| g * g).sum::<f64>().sqrt();
        self.gradient = gradient;
        length
    }

    /// Turns a vector to where it costs least, and returns its part of the value.
    fn turn(&mut self, j: usize, links: &[f64]) -> f64 {
        let length = self.pull(j, links);
        if length > 0.0 {
            let vector = &mut self.vectors[j * self.rank..(j + 1) * self.rank];
            vector.iter_mut().zip(&self.gradient).for_each(|(v, g)| *v = -g / length);
        }
        -length
    }

    /// Moves the multipliers of rows that are violated, or were, and says whether one has moved by
    /// more than little.
    fn raise_multipliers(&mut self, scale: f64) -> bool {
        let size = self.own.len();
        let one = self.vector(size);
        let part = |j: usize| {
            let along: f64 = self.vector(j).iter().zip(one).map(|(v, o)| v * o).sum();
            0.5 * (1.0 + along)
        };
        let (mut has_moved, mut multipliers) = (false, self.multipliers.clone());
        for (row, multiplier) in self.form.rows.iter().zip(&mut multipliers) {
            let length: f64 = row.terms.iter().map(|(_, a)| a * a).sum();
            let sum: f64 = row.terms.iter().map(|&(j, a)| a * part(j)).sum();
            let mut moved = *multiplier + scale * (sum - row.limit) / length;
            if !row.is_equation {
                moved = moved.max(0.0);
            }
            has_moved |= (moved - *multiplier).abs() * length.sqrt() > 1e-3 * scale;
            *multiplier = moved;
        }
        self.multipliers = multipliers;
        has_moved
    }
}
