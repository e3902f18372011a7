//! Triangular solves whose work follows the entries of the result.
//!
//! The places that a solve can reach from those of the right side are found by a depth-first search
//! before any number is touched (Gilbert and Peierls, Sparse partial pivoting in time proportional
//! to arithmetic operations). It pays where the result has few entries, which is so for most solves
//! of a sparse program (Hall and McKinnon, Hyper-sparsity in the revised simplex method).

use super::super::sparse::{SparseVector, TINY_ENTRY};
use super::lists::Lists;

/// The largest share of entries of a right side, and of results lately, that is searched for.
const MAX_START_DENSITY: f64 = 0.05;
const MAX_RESULT_DENSITY: f64 = 0.05;

/// A place that does not exist any more.
pub(super) const GONE: u32 = u32::MAX;

/// The work space of the search.
#[derive(Debug, Clone, Default)]
pub(super) struct ReachSearch {
    is_seen: Vec<bool>,
    /// Places whose lists are being searched, and how many entries of each are left.
    stack: Vec<(u32, u32)>,
    /// Places that are done: each after all that it reaches.
    done: Vec<u32>,
}

/// Half of a factorisation, by the rows of the pivots.
#[derive(Debug, Clone, Copy)]
pub(super) struct TriangularFactor<'a> {
    /// The multiples that are subtracted from other places once a place is known.
    pub(super) lists: &'a Lists,
    /// By row, the inverse of the pivot; `None` if all pivots are 1.
    pub(super) inverse: Option<&'a [f64]>,
    /// The rows in the order of elimination, or in the opposite one.
    pub(super) order: &'a [u32],
    pub(super) is_backward: bool,
    /// Whether rows that are not in the order have empty lists and may have entries.
    pub(super) is_partial: bool,
}

impl TriangularFactor<'_> {
    /// Solves with the triangle in place. The list of the vector may name a place twice before.
    ///
    /// # Arguments
    ///
    /// * `density`: that of results lately.
    pub(super) fn solve(&self, v: &mut SparseVector, density: f64, reach: &mut ReachSearch) {
        if v.density() > MAX_START_DENSITY || density > MAX_RESULT_DENSITY {
            self.solve_in_order(v);
        } else {
            self.solve_reached(v, reach);
        }
    }

    fn solve_in_order(&self, v: &mut SparseVector) {
        let SparseVector { value, index } = v;
        index.clear();
        if self.is_backward {
            self.order.iter().rev().for_each(|&k| self.eliminate(k, value, index));
        } else {
            self.order.iter().for_each(|&k| self.eliminate(k, value, index));
        }
        if self.is_partial {
            v.list();
        }
    }

    #[inline(always)]
    fn eliminate(&self, place: u32, v: &mut [f64], found: &mut Vec<u32>) {
        if place == GONE {
            return;
        }
        let entry = &mut v[place as usize];
        if *entry == 0.0 {
            return;
        }
        if entry.abs() <= TINY_ENTRY {
            *entry = 0.0;
            return;
        }
        if let Some(inverse) = self.inverse {
            *entry *= inverse[place as usize];
        }
        found.push(place);
        let value = *entry;
        let (index, entries) = self.lists.get(place as usize);
        for (&i, a) in index.iter().zip(entries) {
            v[i as usize] -= a * value;
        }
    }

    fn solve_reached(&self, v: &mut SparseVector, reach: &mut ReachSearch) {
        let ReachSearch { is_seen, stack, done } = reach;
        is_seen.resize(v.value.len(), false);
        done.clear();
        for &from in &v.index {
            if std::mem::replace(&mut is_seen[from as usize], true) {
                continue;
            }
            let (mut place, mut list) = (from, self.lists.indices(from as usize));
            loop {
                let mut deeper = None;
                while let Some((&to, rest)) = list.split_first() {
                    list = rest;
                    if std::mem::replace(&mut is_seen[to as usize], true) {
                        continue;
                    }
                    let below = self.lists.indices(to as usize);
                    if !below.is_empty() {
                        deeper = Some((to, below));
                        break;
                    }
                    // Most places reach no other ones.
                    done.push(to);
                }
                if let Some((to, below)) = deeper {
                    stack.push((place, list.len() as u32));
                    (place, list) = (to, below);
                    continue;
                }
                done.push(place);
                let Some((above, left)) = stack.pop() else { break };
                let all = self.lists.indices(above as usize);
                (place, list) = (above, &all[all.len() - left as usize..]);
            }
        }
        let SparseVector { value, index } = v;
        index.clear();
        for &k in done.iter().rev() {
            is_seen[k as usize] = false;
            self.eliminate(k, value, index);
        }
    }
}
