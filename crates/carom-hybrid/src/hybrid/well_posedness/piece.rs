//! Where transitions are possible: polyhedra of states and inputs in a step, in a unit box.

use crate::hybrid::step::{AffineForm, ConditionMaps, Dynamics};
use crate::hybrid::system::HybridSystem;
use crate::interval::Interval;
use crate::tolerance::largest_magnitude;

/// The states and inputs of a step as `lower + width * point` with a point in the unit box. The box
/// covers the ranges of the inputs in all transitions.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Units {
    lower: Vec<f64>,
    width: Vec<f64>,
}

/// A half-space of the unit box, `normal . point <= limit`, with a normal of length 1.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Facet {
    pub(super) normal: Vec<f64>,
    pub(super) limit: f64,
    /// Whether it is a limit for the planner rather than a part of the system.
    pub(super) is_limit: bool,
}

/// Where a transition is possible.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Piece {
    facets: Vec<Facet>,
    /// Whether one of its conditions can never hold, for another reason than a limit for the
    /// planner; and because of such a limit.
    is_empty: [bool; 2],
}

impl Units {
    pub(super) fn new(system: &HybridSystem, step: usize) -> Self {
        let domains = system.states.iter().map(|(_, domain)| *domain);
        let ranges = (0..system.inputs.len()).map(|k| {
            system.input_ranges(k, step).reduce(|a, b| a.hull(b)).unwrap_or(Interval::REALS)
        });
        let (lower, width) = domains.chain(ranges).map(|r| (r.lower, r.upper - r.lower)).unzip();
        Units { lower, width }
    }

    /// The number of states and inputs.
    pub(super) fn size(&self) -> usize {
        self.lower.len()
    }

    /// The states and inputs at a point of the unit box.
    pub(super) fn at(&self, point: &[f64]) -> Vec<f64> {
        let ends = self.lower.iter().zip(&self.width).zip(point);
        ends.map(|((lower, width), p)| lower + width * p.clamp(0.0, 1.0)).collect()
    }
}

impl Facet {
    /// By how much a point violates it; negative inside.
    pub(super) fn violation(&self, point: &[f64]) -> f64 {
        self.normal.iter().zip(point).map(|(n, p)| n * p).sum::<f64>() - self.limit
    }
}

impl Piece {
    /// Adds `map <= 0`, of states and inputs in their units, unless it holds everywhere in the box.
    pub(super) fn cut(&mut self, units: &Units, map: &AffineForm, is_limit: bool) {
        let factors = map.factors.iter().zip(&units.width).map(|(n, width)| n * width);
        let factors: Vec<f64> = factors.collect();
        let shifts = || map.factors.iter().zip(&units.lower).map(|(n, lower)| n * lower);
        let limit = -map.constant - shifts().sum::<f64>();
        let length = factors.iter().map(|n| n * n).sum::<f64>().sqrt();
        let numbers = factors.iter().copied().chain(shifts()).chain([map.constant]);
        let largest = largest_magnitude(numbers);
        if length <= 1e-12 * largest {
            self.is_empty[usize::from(is_limit)] |= limit < -1e-9 * largest;
        } else if factors.iter().map(|n| n.max(0.0)).sum::<f64>() > limit {
            let normal = factors.iter().map(|n| n / length).collect();
            self.add_facet(Facet { normal, limit: limit / length, is_limit });
        }
    }

    /// Adds a range of a state or an input, by its position.
    pub(super) fn cut_to(&mut self, units: &Units, position: usize, range: Interval) {
        for (sign, end) in [(1.0, range.upper), (-1.0, -range.lower)] {
            if end.is_finite() {
                let mut map = AffineForm::constant(units.size(), -end);
                map.factors[position] = sign;
                self.cut(units, &map, false);
            }
        }
    }

    /// Cuts it with another piece.
    pub(super) fn add(&mut self, other: &Piece) {
        (0..2).for_each(|k| self.is_empty[k] |= other.is_empty[k]);
        other.facets.iter().for_each(|facet| self.add_facet(facet.clone()));
    }

    /// Cuts it with a half-space; one without a normal holds everywhere or nowhere.
    pub(super) fn add_facet(&mut self, facet: Facet) {
        if facet.normal.iter().all(|&n| n == 0.0) {
            self.is_empty[usize::from(facet.is_limit)] |= facet.limit < 0.0;
        } else if !self.facets.contains(&facet) {
            self.facets.push(facet);
        }
    }

    /// Whether it is empty for a reason that counts.
    pub(super) fn is_empty(&self, with_limits: bool) -> bool {
        self.is_empty[0] || with_limits && self.is_empty[1]
    }

    /// Its facets, with or without limits for the planner.
    pub(super) fn facets(&self, with_limits: bool) -> impl Iterator<Item = &Facet> {
        self.facets.iter().filter(move |facet| with_limits || !facet.is_limit)
    }
}

/// The limits of the system at a step; the box itself is left out.
pub(super) fn base(system: &HybridSystem, units: &Units, step: usize) -> Piece {
    let mut piece = Piece::default();
    for limit in system.conditions() {
        if let Some(ConditionMaps::HalfSpace(map)) = limit.maps(&[], units.size(), step) {
            piece.cut(units, &map, false);
        }
    }
    piece
}

/// Where a transition is possible in a step: its guards and the ranges of its inputs.
pub(super) fn piece(units: &Units, dynamics: &Dynamics) -> Piece {
    let mut piece = Piece::default();
    dynamics.guards.iter().for_each(|guard| piece.cut(units, &guard.map, guard.is_limit));
    let states = dynamics.next.len();
    for (k, range) in dynamics.inputs.iter().enumerate() {
        piece.cut_to(units, states + k, *range);
    }
    piece
}
