//! The best points found, with distinct values of the integers: the incumbent and those after it.

use crate::solution::Heuristic;
use crate::solver::{Options, PoolMode};

/// A verified point.
#[derive(Debug, Clone)]
pub struct Accepted {
    /// Its (minimised) objective.
    pub value: f64,
    /// The integers of the user's model, which tell points apart.
    pub key: Vec<i64>,
    /// The values of all columns.
    pub point: Vec<f64>,
    /// The heuristic that found it.
    pub found_by: Heuristic,
}

/// The best points, best first; the first one is the incumbent.
#[derive(Debug, Clone)]
pub struct BestPoints {
    size: usize,
    mode: PoolMode,
    gap: Option<f64>,
    points: Vec<Accepted>,
}

impl BestPoints {
    /// An empty pool.
    pub fn new(options: &Options) -> Self {
        let (size, mode, gap) = (options.pool.max(1), options.pool_mode, options.pool_gap);
        BestPoints { size, mode, gap, points: Vec::new() }
    }

    /// Takes a point in if it is among the best. Returns whether it is the new incumbent.
    pub fn offer(&mut self, accepted: Accepted) -> bool {
        let better = self.incumbent().is_none_or(|best| accepted.value < best.value);
        if let Some(same) = self.points.iter().position(|p| p.key == accepted.key) {
            if self.points[same].value <= accepted.value {
                return false;
            }
            self.points.remove(same);
        }
        let place = self.points.partition_point(|p| p.value <= accepted.value);
        if place < self.size {
            self.points.insert(place, accepted);
            self.points.truncate(self.size);
            let limit = self.limit();
            self.points.retain(|p| p.value <= limit);
        }
        better
    }

    pub(super) fn incumbent(&self) -> Option<&Accepted> {
        self.points.first()
    }

    /// The value of the point with a key.
    pub(super) fn value_of(&self, key: &[i64]) -> Option<f64> {
        self.points.iter().find(|point| point.key == key).map(|point| point.value)
    }

    /// The points, best first.
    pub fn into_points(self) -> Vec<Accepted> {
        self.points
    }

    pub(super) fn bytes(&self) -> usize {
        let one = |p: &Accepted| size_of::<Accepted>() + 8 * (p.key.len() + p.point.len());
        self.points.iter().map(one).sum()
    }

    /// The value that a new point must improve on to change the pool; `None` while every point
    /// changes it.
    pub fn to_beat(&self) -> Option<f64> {
        match self.mode {
            PoolMode::Found => self.incumbent().map(|best| best.value),
            PoolMode::Best if self.points.len() == self.size => {
                self.points.last().map(|last| last.value)
            }
            PoolMode::Best => None,
        }
    }

    /// The largest value that the gap of the pool allows.
    pub fn limit(&self) -> f64 {
        match (self.gap, self.incumbent()) {
            (Some(gap), Some(best)) => best.value + gap * best.value.abs(),
            _ => f64::INFINITY,
        }
    }

    /// Whether the tree is searched for more than one point.
    pub(super) fn wants_all(&self) -> bool {
        self.size > 1 && self.mode == PoolMode::Best
    }
}
