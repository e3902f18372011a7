//! The best points found, with distinct values of the integers: the incumbent and those after it.

use crate::solution::Heuristic;
use crate::solver::{Options, PoolMode};

/// A verified point.
#[derive(Debug, Clone)]
pub(super) struct Accepted {
    /// Its (minimised) objective.
    pub(super) value: f64,
    /// The integers of the user's model: what tells points apart.
    pub(super) key: Vec<i64>,
    pub(super) point: Vec<f64>,
    pub(super) found_by: Heuristic,
}

/// The best points, best first; the first one is the incumbent.
#[derive(Debug)]
pub(super) struct BestPoints {
    size: usize,
    mode: PoolMode,
    gap: Option<f64>,
    points: Vec<Accepted>,
}

impl BestPoints {
    pub(super) fn new(options: &Options) -> Self {
        let (size, mode, gap) = (options.pool.max(1), options.pool_mode, options.pool_gap);
        BestPoints { size, mode, gap, points: Vec::new() }
    }

    /// Takes a point in if it is among the best. Returns whether it is the new incumbent.
    pub(super) fn offer(&mut self, accepted: Accepted) -> bool {
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

    pub(super) fn into_points(self) -> Vec<Accepted> {
        self.points
    }

    pub(super) fn bytes(&self) -> usize {
        let one = |p: &Accepted| size_of::<Accepted>() + 8 * (p.key.len() + p.point.len());
        self.points.iter().map(one).sum()
    }

    /// The value that new points must be better than to change anything; `None` while every point
    /// does.
    pub(super) fn to_beat(&self) -> Option<f64> {
        match self.mode {
            PoolMode::Found => self.incumbent().map(|best| best.value),
            PoolMode::Best if self.points.len() == self.size => {
                self.points.last().map(|last| last.value)
            }
            PoolMode::Best => None,
        }
    }

    /// The largest value that the gap of the pool allows.
    pub(super) fn limit(&self) -> f64 {
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

#[cfg(test)]
mod tests {
    use super::*;

    fn pool(size: usize, mode: PoolMode, gap: Option<f64>) -> BestPoints {
        BestPoints::new(&Options {
            pool: size,
            pool_mode: mode,
            pool_gap: gap,
            ..Options::default()
        })
    }

    fn point(value: f64, key: i64) -> Accepted {
        Accepted { value, key: vec![key], point: vec![key as f64], found_by: Heuristic::Leaf }
    }

    fn values(pool: &BestPoints) -> Vec<f64> {
        pool.points.iter().map(|p| p.value).collect()
    }

    #[test]
    fn points_are_distinct_and_the_best_ones() {
        let mut pool = pool(3, PoolMode::Best, None);
        assert!(pool.offer(point(5.0, 1)));
        assert!(!pool.offer(point(7.0, 2)));
        assert_eq!(pool.to_beat(), None);
        assert!(!pool.offer(point(6.0, 2)), "the same integers, better");
        assert!(!pool.offer(point(6.5, 2)), "the same integers, worse");
        assert_eq!(values(&pool), [5.0, 6.0]);
        assert!(pool.offer(point(4.0, 3)));
        assert_eq!(pool.to_beat(), Some(6.0));
        pool.offer(point(5.5, 4));
        assert_eq!(values(&pool), [4.0, 5.0, 5.5]);
    }

    #[test]
    fn the_gap_drops_what_is_too_far() {
        let mut pool = pool(3, PoolMode::Found, Some(0.5));
        pool.offer(point(10.0, 1));
        pool.offer(point(16.0, 2));
        pool.offer(point(14.0, 3));
        assert_eq!(values(&pool), [10.0, 14.0]);
        pool.offer(point(8.0, 4));
        assert_eq!(values(&pool), [8.0, 10.0]);
        assert_eq!((pool.to_beat(), pool.limit()), (Some(8.0), 12.0));
    }
}
