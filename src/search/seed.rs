//! Division of the root along the leaves of an earlier tree.
//!
//! The boxes of a seed only propose where to split. The root is split along their bounds until each
//! part lies in one of them or in none, so the parts always cover the root. If the boxes come from
//! a tree over the same columns, the bound that most of them share is the split of that tree's
//! root, and the parts are its leaves.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::node::Decision;
use super::proofs::Proofs;
use crate::presolve::Domain;
use crate::program::Program;
use crate::solution::Heuristic;

/// The hints that a search begins with, from the user or from earlier searches, in columns of the program.
#[derive(Debug, Clone, Default)]
pub struct Seed {
    /// Values of integral columns to try.
    pub guess: Vec<(usize, f64)>,
    /// Boxes over integral columns.
    pub leaves: Vec<SeedBox>,
    /// A point to beat that was verified before.
    pub(crate) point: Option<Start>,
    /// If the point is what a look at the root found: whether the root is still the same, so that
    /// rounding and roll-outs have had their turn.
    pub(crate) looked: Option<bool>,
    /// Proofs to try before relaxations. If there are any, or none but the wish, those of this search
    /// are kept.
    pub(crate) proofs: Option<Arc<Proofs>>,
}

/// A verified point that a search begins with.
#[derive(Debug, Clone)]
pub struct Start {
    /// A value a column.
    pub values: Vec<f64>,
    /// The heuristic that found it.
    pub found_by: Heuristic,
}

impl Seed {
    /// A seed with only a point to beat.
    pub fn from_point(point: Option<Start>) -> Self {
        Seed { point, ..Seed::default() }
    }
}

/// A box over some integral columns, and how promising it is: the smaller, the more.
#[derive(Debug, Clone, Default)]
pub struct SeedBox {
    /// Columns with their lower and upper bounds.
    pub bounds: Vec<(usize, f64, f64)>,
    /// The bound that it had, for the order only.
    pub order: f64,
}

/// The outcome of the boxes of a seed.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Seeded {
    /// By box: whether a part of the root lies in it.
    pub used: Vec<bool>,
    /// Parts of the root that lie in a box.
    pub inside: usize,
    /// Parts of the root that lie in no box: the boxes left them open.
    pub outside: usize,
}

/// The outcome of a guess, in columns and values of the program.
#[derive(Debug, Clone, PartialEq)]
pub enum GuessEnd {
    /// A verified point, with all guessed values or most of them.
    Point(Vec<f64>),
    /// Already propagation contradicts the value of this column, and no repair was found.
    Contradiction(usize),
    /// No point with these values was found.
    Nothing,
    /// A limit came first.
    Stopped,
}

/// A part of the root.
#[derive(Debug)]
pub struct Part {
    /// The decisions that lead to it.
    pub path: Vec<Decision>,
    pub(super) order: f64,
    /// The box that it lies in.
    pub inside: Option<usize>,
}

/// Most parts a box, and those that are always allowed.
const PARTS: usize = 3;
const ALWAYS: usize = 16;

/// Splits a domain along the bounds of boxes. The parts cover it and do not overlap.
pub fn divide(program: &Program, domain: &Domain, leaves: &[SeedBox]) -> Vec<Part> {
    let boxes: Vec<BTreeMap<usize, [f64; 2]>> =
        leaves.iter().map(|leaf| whole_box(program, leaf)).collect();
    let most = PARTS * boxes.len() + ALWAYS;
    let mut parts = Vec::new();
    let mut waiting = vec![(Vec::new(), (0..boxes.len()).collect::<Vec<usize>>())];
    while let Some((path, near)) = waiting.pop() {
        let region = Region { domain, path: &path };
        let meets = |&k: &usize| {
            let apart = |(&j, &[l, u]): (&usize, &[f64; 2])| {
                let [lower, upper] = region.bounds(j);
                l > upper || u < lower
            };
            !boxes[k].iter().any(apart)
        };
        let near: Vec<usize> = near.into_iter().filter(meets).collect();
        let order = near.iter().map(|&k| leaves[k].order).fold(f64::INFINITY, f64::min);
        let holds = |&&k: &&usize| {
            boxes[k].iter().all(|(&j, &[l, u])| {
                let [lower, upper] = region.bounds(j);
                l <= lower && upper <= u
            })
        };
        let inside = near.iter().find(holds).copied();
        let full = parts.len() + waiting.len() + 2 > most;
        let cut = if inside.is_some() || full { None } else { commonest(&region, &boxes, &near) };
        let Some((column, value)) = cut else {
            parts.push(Part { path, order, inside });
            continue;
        };
        let mut above = path.clone();
        above.push(Decision { column, is_upper: false, value: value + 1.0 });
        waiting.push((above, near.clone()));
        let mut below = path;
        below.push(Decision { column, is_upper: true, value });
        waiting.push((below, near));
    }
    parts
}

/// The part of the root that a path leads to.
struct Region<'a> {
    domain: &'a Domain,
    path: &'a [Decision],
}

impl Region<'_> {
    fn bounds(&self, column: usize) -> [f64; 2] {
        let mut bounds = self.domain.bounds(column);
        for decision in self.path.iter().filter(|d| d.column == column) {
            bounds[usize::from(decision.is_upper)] = decision.value;
        }
        bounds
    }
}

/// The split that most boxes have a bound at: the column, and the largest value below.
fn commonest(
    region: &Region<'_>,
    boxes: &[BTreeMap<usize, [f64; 2]>],
    near: &[usize],
) -> Option<(usize, f64)> {
    // Whole values of usual size order like their bits, once made unsigned.
    let mut counts: BTreeMap<(usize, i64), usize> = BTreeMap::new();
    for &k in near {
        for (&j, &[l, u]) in &boxes[k] {
            let [lower, upper] = region.bounds(j);
            if l > lower && l <= upper {
                *counts.entry((j, l as i64 - 1)).or_default() += 1;
            }
            if u < upper && u >= lower {
                *counts.entry((j, u as i64)).or_default() += 1;
            }
        }
    }
    let best = counts.into_iter().max_by(|a, b| a.1.cmp(&b.1).then(b.0.cmp(&a.0)));
    best.map(|((column, value), _)| (column, value as f64))
}

/// The bounds of a box that mean something: on integral columns, as whole numbers.
fn whole_box(program: &Program, leaf: &SeedBox) -> BTreeMap<usize, [f64; 2]> {
    const LARGEST: f64 = 1e15;
    let mut whole = BTreeMap::new();
    for &(j, lower, upper) in &leaf.bounds {
        if program.integral.get(j) == Some(&true) && !lower.is_nan() && !upper.is_nan() {
            let bounds = whole.entry(j).or_insert([f64::NEG_INFINITY, f64::INFINITY]);
            if lower.abs() <= LARGEST {
                bounds[0] = bounds[0].max(lower.ceil());
            }
            if upper.abs() <= LARGEST {
                bounds[1] = bounds[1].min(upper.floor());
            }
        }
    }
    whole
}
