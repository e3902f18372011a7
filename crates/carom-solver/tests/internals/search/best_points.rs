//! The best points and the pool.

use carom::solution::Heuristic;
use carom::solver::{Options, PoolMode};
use carom_solver::internals::search::best_points::{Accepted, BestPoints};

fn pool(size: usize, mode: PoolMode, gap: Option<f64>) -> BestPoints {
    let mut options = Options::default();
    (options.pool, options.pool_mode, options.pool_gap) = (size, mode, gap);
    BestPoints::new(&options)
}

fn point(value: f64, key: i64) -> Accepted {
    Accepted { value, key: vec![key], point: vec![key as f64], found_by: Heuristic::Leaf }
}

fn values(pool: &BestPoints) -> Vec<f64> {
    pool.clone().into_points().iter().map(|p| p.value).collect()
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
