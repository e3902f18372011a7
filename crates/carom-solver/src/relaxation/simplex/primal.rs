//! The steps of the primal simplex method, which follows where the true costs are not those that
//! the dual method has used.

use super::parameters::{DUAL_TOLERANCE, MIN_ENTRY, PRIMAL_TOLERANCE};
use super::ratio::NonbasicStatus;
use super::tableau::{Iteration, NONBASIC, Tableau};

/// The weight that makes the reference framework too old.
const MAX_REFERENCE_WEIGHT: f64 = 1e7;

/// Prices of columns outside the basis by Devex reference weights (Harris, Pivot selection methods
/// of the Devex LP code).
#[derive(Debug)]
pub(super) struct Primal {
    reference: Vec<f64>,
}

/// The limit at which the way of an entering column ends.
struct BlockingSide {
    slot: usize,
    step: f64,
    to: NonbasicStatus,
}

impl Primal {
    pub(super) fn new(tableau: &Tableau) -> Self {
        Primal { reference: vec![1.0; tableau.slot.len()] }
    }

    /// The column that enters.
    fn entering(&self, tableau: &Tableau) -> Option<usize> {
        let (mut most, mut found) = (0.0, None);
        for k in 0..tableau.slot.len() {
            if tableau.slot[k] != NONBASIC {
                continue;
            }
            let miss = tableau.dual_miss(k);
            if miss > DUAL_TOLERANCE && miss * miss > most * self.reference[k] {
                (most, found) = (miss * miss / self.reference[k], Some(k));
            }
        }
        found
    }

    /// One exchange of the basis, or a jump to the other bound.
    pub(super) fn step(&mut self, tableau: &mut Tableau) -> Iteration {
        if tableau.factors.is_worn() {
            refresh(tableau);
        }
        let Some(q) = self.entering(tableau) else { return Iteration::Optimal };
        let direction = -tableau.cost[q].signum();
        tableau.solve_column(q);
        let width = tableau.program.upper[q] - tableau.program.lower[q];
        let block = blocking(tableau, direction);
        let block = match block {
            Some(block) if block.step < width => block,
            _ if width.is_finite() => {
                tableau.jump(std::iter::once(q));
                return Iteration::Moved;
            }
            _ => return Iteration::Unbounded(ray(tableau, q, direction)),
        };
        tableau.solve_row(block.slot);
        tableau.price();
        if !tableau.is_sound(block.slot, q) {
            if tableau.factors.exchanges() == 0 {
                return Iteration::Stuck;
            }
            refresh(tableau);
            return Iteration::Moved;
        }
        self.update(tableau, block.slot, q);
        if !tableau.exchange(block.slot, q, block.to, false) {
            refresh(tableau);
        }
        Iteration::Moved
    }

    /// Updates the reference weights for an exchange that is about to come.
    fn update(&mut self, tableau: &Tableau, slot: usize, q: usize) {
        let pivot = tableau.pivots.value[q];
        let own = self.reference[q];
        for (k, entry) in tableau.pivots.entries() {
            let ratio = entry / pivot;
            self.reference[k] = self.reference[k].max(ratio * ratio * own);
        }
        let leaving = (own / (pivot * pivot)).max(1.0);
        self.reference[tableau.head[slot]] = leaving;
        if leaving > MAX_REFERENCE_WEIGHT {
            self.reference.fill(1.0);
        }
    }
}

/// The slot whose column reaches a bound first: among those that do so but for a tolerance, the one
/// with the largest entry.
fn blocking(tableau: &Tableau, direction: f64) -> Option<BlockingSide> {
    let sides = || {
        tableau.entering.entries().filter_map(|(slot, entry)| {
            let [lower, upper] = tableau.bounds[slot];
            let falls = direction * entry > 0.0;
            let bound = if falls { lower } else { upper };
            let room = (tableau.value[slot] - bound) * if falls { 1.0 } else { -1.0 };
            let counts = entry.abs() > MIN_ENTRY && bound.is_finite();
            counts.then(|| (slot, entry.abs(), room, bound, falls))
        })
    };
    let reach = |&(_, entry, room, bound, _): &(usize, f64, f64, f64, bool)| {
        (room.max(0.0) + PRIMAL_TOLERANCE * bound.abs().max(1.0)) / entry
    };
    let most = sides().map(|side| reach(&side)).fold(f64::INFINITY, f64::min);
    let near = sides().filter(|side| side.2 / side.1 <= most);
    let best = near.max_by(|a, b| a.1.total_cmp(&b.1))?;
    let to = if best.4 { NonbasicStatus::Lower } else { NonbasicStatus::Upper };
    Some(BlockingSide { slot: best.0, step: (best.2 / best.1).max(0.0), to })
}

/// The ray along which a column moves without end.
fn ray(tableau: &Tableau, q: usize, direction: f64) -> Vec<f64> {
    let n = tableau.program.size().0;
    let mut ray = vec![0.0; n];
    let mut set = |k: usize, by: f64| {
        if k < n {
            ray[k] = by;
        }
    };
    set(q, direction);
    for (slot, entry) in tableau.entering.entries() {
        set(tableau.head[slot], -direction * entry);
    }
    ray
}

fn refresh(tableau: &mut Tableau) {
    tableau.factorise();
    tableau.compute_costs();
    tableau.compute_point();
}
