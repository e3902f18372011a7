//! Round tours as programs without the rows against subtours, which are found as they are needed.

use carom::prelude::*;
use carom::solution::Point;

/// A tour through some cities: two roads at each.
pub(crate) struct Tour {
    pub(crate) model: Model,
    /// Both cities of each road, and whether it is used.
    pub(crate) roads: Vec<(usize, usize, Variable)>,
    count: usize,
}

impl Tour {
    /// With the lengths of roads between all cities.
    pub(crate) fn new(lengths: &[Vec<f64>]) -> Tour {
        let count = lengths.len();
        let mut model = Model::new("tour");
        let mut roads = Vec::new();
        let mut total = Affine::zero();
        for (a, row) in lengths.iter().enumerate() {
            for (b, length) in row.iter().enumerate().skip(a + 1) {
                let used = model.binary(format!("road {a} {b}")).unwrap();
                total += *length * used;
                roads.push((a, b, used));
            }
        }
        for city in 0..count {
            let here = roads.iter().filter(|(a, b, _)| *a == city || *b == city);
            let degree: Affine = here.map(|(_, _, used)| 1.0 * *used).sum();
            model.add(("city", city), degree.equals(2.0)).unwrap();
        }
        model.minimize(&total).unwrap();
        Tour { model, roads, count }
    }

    /// Of each city, the first city that the roads of a point connect it with.
    fn components(&self, point: &Point) -> Result<Vec<usize>, Error> {
        let mut component: Vec<usize> = (0..self.count).collect();
        for &(a, b, used) in &self.roads {
            if point.value(used)? > 0.5 {
                let (kept, gone) = (component[a].min(component[b]), component[a].max(component[b]));
                component.iter_mut().filter(|c| **c == gone).for_each(|c| *c = kept);
            }
        }
        Ok(component)
    }

    /// The subtours of a point, as rows that exclude them.
    pub(crate) fn subtours(&self, point: &Point) -> Result<Vec<Row>, Error> {
        let component = self.components(point)?;
        let mut rows = Vec::new();
        for first in 1..self.count {
            let inside = |city: usize| component[city] == component[first];
            if component[first] == first {
                let leaving = self.roads.iter().filter(|(a, b, _)| inside(*a) != inside(*b));
                let leaving: Affine = leaving.map(|(_, _, used)| 1.0 * *used).sum();
                rows.push(leaving.ge(2.0));
            }
        }
        Ok(rows)
    }
}

/// The length of the shortest tour, by dynamic programming over sets of cities.
pub(crate) fn held_karp(lengths: &[Vec<f64>]) -> f64 {
    let n = lengths.len() - 1;
    let mut best = vec![vec![f64::INFINITY; n]; 1 << n];
    for last in 0..n {
        best[1 << last][last] = lengths[n][last];
    }
    for set in 1_usize..1 << n {
        for last in (0..n).filter(|k| set >> k & 1 == 1) {
            for next in (0..n).filter(|k| set >> k & 1 == 0) {
                let longer = best[set][last] + lengths[last][next];
                let entry = &mut best[set | 1 << next][next];
                *entry = entry.min(longer);
            }
        }
    }
    (0..n).map(|last| best[(1 << n) - 1][last] + lengths[last][n]).fold(f64::INFINITY, f64::min)
}

/// Lengths of roads between points in a square, rounded to whole numbers.
pub(crate) fn lengths(places: &[(u16, u16)]) -> Vec<Vec<f64>> {
    let between = |a: &(u16, u16), b: &(u16, u16)| {
        let (x, y) = (f64::from(a.0) - f64::from(b.0), f64::from(a.1) - f64::from(b.1));
        x.hypot(y).round()
    };
    places.iter().map(|a| places.iter().map(|b| between(a, b)).collect()).collect()
}

/// Places that look random, and are always the same.
pub(crate) fn places(count: usize, seed: u64) -> Vec<(u16, u16)> {
    let mut state = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15).wrapping_add(0x1234_5678);
    let mut next = || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 33) as u16 % 1000
    };
    (0..count).map(|_| (next(), next())).collect()
}
