//! Where transitions are possible: polyhedra of states and inputs in a step, in a unit box.

use crate::hybrid::system::{Choice, Halfspace, HybridSystem, Schedule, Transition};
use crate::interval::Interval;

/// The states and inputs of a step as `lower + width * point` with a point in the unit box. The box
/// covers the ranges of the inputs in all transitions.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Units {
    pub(super) lower: Vec<f64>,
    pub(super) width: Vec<f64>,
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
    pub(super) facets: Vec<Facet>,
    /// Whether one of its conditions can never hold, for another reason than a limit for the
    /// planner; and because of such a limit.
    is_empty: [bool; 2],
}

/// An affine function of states and inputs, in their own units.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct AffineMap {
    pub(super) factors: Vec<f64>,
    pub(super) constant: f64,
}

impl Units {
    pub(super) fn new(system: &HybridSystem, step: usize) -> Self {
        let domains = system.states.iter().map(|(_, domain)| *domain);
        let ranges = (0..system.inputs.len()).map(|k| {
            system.input_ranges(k, step).reduce(|a, b| a.hull(b)).unwrap_or(Interval::REALS)
        });
        let ranges: Vec<Interval> = domains.chain(ranges).collect();
        Units {
            lower: ranges.iter().map(|range| range.lower).collect(),
            width: ranges.iter().map(|range| range.upper - range.lower).collect(),
        }
    }

    /// The states and inputs at a point of the unit box.
    pub(super) fn at(&self, point: &[f64]) -> Vec<f64> {
        let ends = self.lower.iter().zip(&self.width).zip(point);
        ends.map(|((lower, width), p)| lower + width * p.clamp(0.0, 1.0)).collect()
    }

    /// An affine function on the unit box.
    pub(super) fn scaled(&self, map: &AffineMap) -> AffineMap {
        let shift = map.factors.iter().zip(&self.lower).map(|(n, lower)| n * lower).sum::<f64>();
        let factors = map.factors.iter().zip(&self.width).map(|(n, width)| n * width);
        AffineMap { factors: factors.collect(), constant: map.constant + shift }
    }
}

impl AffineMap {
    /// The value at a point.
    pub(super) fn value(&self, point: &[f64]) -> f64 {
        self.factors.iter().zip(point).map(|(n, p)| n * p).sum::<f64>() + self.constant
    }

    /// The range over the unit box.
    pub(super) fn range(&self) -> Interval {
        let low = self.factors.iter().map(|n| n.min(0.0)).sum::<f64>();
        let high = self.factors.iter().map(|n| n.max(0.0)).sum::<f64>();
        Interval::new(self.constant + low, self.constant + high)
    }
}

impl Facet {
    /// By how much a point violates it; negative inside.
    pub(super) fn violation(&self, point: &[f64]) -> f64 {
        self.normal.iter().zip(point).map(|(n, p)| n * p).sum::<f64>() - self.limit
    }
}

impl Piece {
    /// Adds `map <= limit`, unless it holds everywhere in the box.
    pub(super) fn cut(&mut self, units: &Units, map: &AffineMap, limit: f64, is_limit: bool) {
        if limit == f64::INFINITY {
            return;
        }
        let map = units.scaled(map);
        let length = map.factors.iter().map(|n| n * n).sum::<f64>().sqrt();
        let largest =
            map.factors.iter().fold(map.constant.abs().max(limit.abs()), |a, n| a.max(n.abs()));
        if length <= 1e-12 * largest {
            self.is_empty[usize::from(is_limit)] |= map.constant > limit + 1e-9 * largest;
            return;
        }
        if map.range().upper <= limit {
            return;
        }
        let normal = map.factors.iter().map(|n| n / length).collect();
        let facet = Facet { normal, limit: (limit - map.constant) / length, is_limit };
        if !self.facets.contains(&facet) {
            self.facets.push(facet);
        }
    }

    /// Cuts it with another piece, without limits for the planner.
    pub(super) fn add(&mut self, other: &Piece) {
        self.is_empty[0] |= other.is_empty[0];
        other.facets(false).for_each(|facet| self.add_facet(facet.clone()));
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

/// The domain and the limits of the system at a step; the box itself is left out.
pub(super) fn base(system: &HybridSystem, units: &Units, step: usize) -> Piece {
    let mut piece = Piece::default();
    for limit in &system.limits {
        piece.cut(units, &map_of(limit, system), limit.limit_at(step), false);
    }
    piece
}

/// The system's own ranges of the inputs.
pub(super) fn cut_to_ranges(piece: &mut Piece, system: &HybridSystem, units: &Units, step: usize) {
    let ranges = system.inputs.iter().map(|(_, range)| range.get(step).copied());
    cut_inputs(piece, system, units, ranges.map(|range| range.unwrap_or(Interval::REALS)));
}

/// Where a transition is possible in a step: its guards and the ranges of its inputs.
pub(super) fn piece(
    system: &HybridSystem,
    units: &Units,
    choice: &Choice,
    transition: &Transition,
    step: usize,
) -> Piece {
    let mut piece = Piece::default();
    for guard in &transition.guards {
        piece.cut(units, &map_of(guard, system), guard.limit_at(step), guard.is_limit);
    }
    let prediction = prediction(system, transition);
    for guard in &transition.prediction_guards {
        let map = combined(&guard.normal, &prediction, 0.0);
        piece.cut(units, &map, guard.limit_at(step), guard.is_limit);
    }
    cut_inputs(&mut piece, system, units, input_ranges(system, choice, transition, step));
    piece
}

/// The ranges that a transition of a choice sets; all numbers if the choice does not limit an input.
fn input_ranges(
    system: &HybridSystem,
    choice: &Choice,
    transition: &Transition,
    step: usize,
) -> impl Iterator<Item = Interval> {
    (0..system.inputs.len())
        .map(move |k| system.input_range(choice, transition, k, step).unwrap_or(Interval::REALS))
}

fn cut_inputs(
    piece: &mut Piece,
    system: &HybridSystem,
    units: &Units,
    ranges: impl Iterator<Item = Interval>,
) {
    let (n, m) = (system.states.len(), system.inputs.len());
    for (k, range) in ranges.enumerate() {
        for (sign, end) in [(1.0, range.upper), (-1.0, -range.lower)] {
            let factors = (0..n + m).map(|i| if i == n + k { sign } else { 0.0 }).collect();
            piece.cut(units, &AffineMap { factors, constant: 0.0 }, end, false);
        }
    }
}

/// The left side of a half-space.
fn map_of(halfspace: &Halfspace, system: &HybridSystem) -> AffineMap {
    let mut factors = halfspace.normal.clone();
    factors.resize(system.states.len() + system.inputs.len(), 0.0);
    AffineMap { factors, constant: 0.0 }
}

/// The flow of a transition, a function per state.
pub(super) fn prediction(system: &HybridSystem, transition: &Transition) -> Vec<AffineMap> {
    flow_maps(system, &transition.flow)
}

/// The common flow, if there is one.
pub(super) fn common(system: &HybridSystem) -> Option<Vec<AffineMap>> {
    system.flow.as_ref().map(|flow| flow_maps(system, flow))
}

fn flow_maps(system: &HybridSystem, flow: &crate::hybrid::linear::LinearSystem) -> Vec<AffineMap> {
    let (n, m) = (system.states.len(), system.inputs.len());
    let row = |i: usize| {
        let from_states = (0..n).map(|j| flow.a()[(i, j)]);
        let factors = from_states.chain((0..m).map(|j| flow.b()[(i, j)])).collect();
        AffineMap { factors, constant: flow.c()[i] }
    };
    (0..n).map(row).collect()
}

/// The next state of a transition in a step, a function per state.
pub(super) fn next_state(
    system: &HybridSystem,
    transition: &Transition,
    step: usize,
) -> Vec<AffineMap> {
    let prediction = prediction(system, transition);
    let Some(reset) = &transition.reset else { return prediction };
    let offset: Option<&Vec<f64>> = Schedule::get(&reset.offset, step);
    let row = |i: usize| {
        let factors: Vec<f64> = (0..prediction.len()).map(|j| reset.matrix[(i, j)]).collect();
        combined(&factors, &prediction, offset.and_then(|r| r.get(i)).copied().unwrap_or(0.0))
    };
    (0..prediction.len()).map(row).collect()
}

/// `factors . maps + constant`.
pub(super) fn combined(factors: &[f64], maps: &[AffineMap], constant: f64) -> AffineMap {
    let count = maps.first().map_or(0, |map| map.factors.len());
    let mut sum = AffineMap { factors: vec![0.0; count], constant };
    for (factor, map) in factors.iter().zip(maps) {
        sum.factors.iter_mut().zip(&map.factors).for_each(|(s, n)| *s += factor * n);
        sum.constant += factor * map.constant;
    }
    sum
}
