//! Equalities over whole numbers: propagation keeps every point, and leaves no bound outside the
//! residue class of its column.

use carom::prelude::*;
use carom_solver::internals::presolve::{Domain, Propagator};
use carom_solver::internals::program::Program;
use proptest::prelude::*;

use crate::common::config;

proptest! {
    #![proptest_config(config(400, "tests/regressions/congruence.txt"))]

    #[test]
    fn residues_keep_every_point(
        columns in prop::collection::vec((1..=40_i32, -30..=30_i32, 0..=12_i32, any::<bool>()), 2..=4),
        right in -200..=200_i32,
        factor in prop::sample::select(vec![1, 1, 2, 3, 6, 10_000_000]),
    ) {
        let mut model = Model::new("m");
        let mut row = Affine::from(0.0);
        let mut ranges = Vec::new();
        for (k, &(a, lower, width, negative)) in columns.iter().enumerate() {
            let a = if negative { -a } else { a };
            let (low, high) = (f64::from(lower), f64::from(lower + width));
            let x = model.integer(format!("x{k}"), low, high).unwrap();
            row += f64::from(a) * f64::from(factor) * x;
            ranges.push((i64::from(a), i64::from(lower), i64::from(lower + width)));
        }
        model.add("r", row.equals(f64::from(right) * f64::from(factor))).unwrap();
        let program = Program::assemble(&model).unwrap();
        let mut domain = Domain::new(&program);
        let result = Propagator::new(&program).propagate_all(&program, &mut domain);
        let mut points = vec![Vec::new()];
        for &(_, lower, upper) in &ranges {
            let longer = |point: &Vec<i64>| -> Vec<Vec<i64>> {
                (lower..=upper).map(|x| [&point[..], &[x]].concat()).collect()
            };
            points = points.iter().flat_map(longer).collect();
        }
        let value = |point: &Vec<i64>| point.iter().zip(&ranges).map(|(x, (a, ..))| a * x).sum::<i64>();
        points.retain(|point| value(point) == i64::from(right));
        prop_assert!(result.is_ok() || points.is_empty(), "{:?} refuted {:?}", result, points);
        for (j, &(a, ..)) in ranges.iter().enumerate().filter(|_| result.is_ok()) {
            let [lower, upper] = domain.bounds(j);
            for point in &points {
                let x = point[j] as f64;
                prop_assert!(x >= lower && x <= upper, "{:?} is outside {} {}", point, lower, upper);
            }
            // Bounds are in the class that the other columns leave.
            let mut divisor = 0;
            let mut rest = i64::from(right);
            for (k, &(b, ..)) in ranges.iter().enumerate().filter(|(k, _)| *k != j) {
                let [low, high] = domain.bounds(k);
                if low == high {
                    rest -= b * low as i64;
                    continue;
                }
                let (mut p, mut q) = (divisor, b.abs());
                while q > 0 {
                    (p, q) = (q, p % q);
                }
                divisor = p;
            }
            for bound in [lower, upper].into_iter().filter(|_| divisor > 1) {
                prop_assert_eq!((a * bound as i64 - rest) % divisor, 0, "column {}", j);
            }
        }
    }
}
