//! Norm limits as polygons, for what works with half-spaces.
//!
//! With two entries, the polygon around a disc has [`SIDES`] sides and reaches `1/cos(π/SIDES) - 1`
//! beyond it, 2 %. With more entries there is a polygon for each pair of them: from
//! `e_i² + e_j² <= b²` for all pairs follows `|e|² <= d/2 b²`, so that it reaches
//! `sqrt(d/2)/cos(π/SIDES) - 1` beyond the ball. Polygons within are the same ones, smaller by
//! that.

use std::f64::consts::TAU;

use super::halfspace::Halfspace;
use super::norm_limit::NormLimit;
use super::region::Region;
use super::{HybridSystem, Transition};

/// The sides of the polygon of a pair of entries.
const SIDES: usize = 16;

/// The side of the limit on which a polygon is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Approximation {
    /// It holds all that the limit allows.
    Outer,
    /// The limit allows all of it.
    Inner,
}

impl NormLimit {
    /// How far the polygon around it reaches beyond the limit, relative to its bound.
    pub(crate) fn excess(&self) -> f64 {
        match self.entries.len() {
            0 | 1 => 0.0,
            d => (d as f64 / 2.0).sqrt() / (TAU / (2 * SIDES) as f64).cos() - 1.0,
        }
    }

    /// The half-spaces of its polygon, all with its name.
    pub(crate) fn polygon(&self, approximation: Approximation) -> Vec<Halfspace> {
        let share = match approximation {
            Approximation::Outer => 1.0,
            Approximation::Inner => 1.0 / (1.0 + self.excess()),
        };
        let d = self.entries.len();
        if d == 1 {
            return [1.0, -1.0].map(|sign| self.side(&[(0, sign)], share)).into();
        }
        let pairs = (0..d).flat_map(|i| (i + 1..d).map(move |j| (i, j)));
        let sides = pairs.flat_map(|(i, j)| {
            (0..SIDES).map(move |k| {
                // The axes exactly.
                let cosine = |k: usize| match (4 * k) % SIDES {
                    0 => [1.0, 0.0, -1.0, 0.0][(4 * k / SIDES) % 4],
                    _ => (TAU * k as f64 / SIDES as f64).cos(),
                };
                [(i, cosine(k)), (j, cosine(k + 3 * SIDES / 4))]
            })
        });
        sides.map(|side| self.side(&side, share)).collect()
    }

    /// `Σ c_i e_i <= share bound`.
    fn side(&self, direction: &[(usize, f64)], share: f64) -> Halfspace {
        let width = self.bound.factors.len();
        let mut normal: Vec<f64> = self.bound.factors.iter().map(|a| -share * a + 0.0).collect();
        normal.resize(width, 0.0);
        for &(i, c) in direction {
            let factors = self.entries[i].factors.iter();
            normal.iter_mut().zip(factors).for_each(|(n, a)| *n += c * a);
        }
        let limit = |step: usize| {
            let moved = direction.iter().map(|&(i, c)| c * self.entries[i].constant_at(step));
            share * self.bound.constant_at(step) - moved.sum::<f64>()
        };
        let limits: Vec<f64> = (0..=self.settles()).map(limit).collect();
        let plain = Halfspace::new(self.name.clone(), normal, limits);
        Halfspace { is_limit: self.is_limit, ..plain }
    }
}

/// The half-spaces of the polygons of some limits.
fn polygons(norms: &[NormLimit], approximation: Approximation) -> impl Iterator<Item = Halfspace> {
    norms.iter().flat_map(move |limit| limit.polygon(approximation))
}

impl HybridSystem {
    /// The system with polygons for norm limits.
    pub(crate) fn polyhedral(&self, approximation: Approximation) -> HybridSystem {
        let mut system = self.clone();
        let norms = std::mem::take(&mut system.norms);
        system.limits.extend(polygons(&norms, approximation));
        for choice in &mut system.choices {
            for transition in &mut choice.transitions {
                transition.make_polyhedral(approximation);
            }
        }
        system
    }

    /// All norm limits of the system.
    pub(crate) fn all_norms(&self) -> impl Iterator<Item = &NormLimit> {
        let own = self.transitions().flat_map(|t| t.norms.iter().chain(&t.prediction_norms));
        self.norms.iter().chain(own)
    }

    /// Leaves out the norm limits of states, inputs and transitions.
    pub(crate) fn clear_norms(&mut self) {
        self.norms.clear();
        for transition in self.choices.iter_mut().flat_map(|choice| &mut choice.transitions) {
            transition.norms.clear();
            transition.prediction_norms.clear();
        }
    }
}

impl Transition {
    fn make_polyhedral(&mut self, approximation: Approximation) {
        self.guards.extend(polygons(&std::mem::take(&mut self.norms), approximation));
        let predicted = std::mem::take(&mut self.prediction_norms);
        self.prediction_guards.extend(polygons(&predicted, approximation));
    }
}

impl Region {
    /// The region with polygons around its discs.
    pub(crate) fn polyhedral(&self) -> Region {
        let mut region = self.clone();
        let norms = std::mem::take(&mut region.norms);
        region.halfspaces.extend(polygons(&norms, Approximation::Outer));
        region
    }
}
