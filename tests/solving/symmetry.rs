//! Ordering interchangeable columns never changes an optimum.
//!
//! Random programs in whole numbers over kinds of equal columns, with rows over all of them and rows
//! that each column has for itself, are enumerated completely; some columns are then told apart by
//! one more row. The optimum must be found with the ordering and without.

use crate::common::config;
use carom::prelude::*;
use proptest::prelude::*;

/// Rows over all columns: a coefficient a kind, an upper limit.
type Common = (Vec<i64>, i64);

#[derive(Debug, Clone)]
struct Kinds {
    /// Number of columns, largest value and cost of each kind.
    kinds: Vec<(usize, i64, i64)>,
    rows: Vec<Common>,
    /// Rows `a x_j + y <= limit` for every column of a kind, with one integer `y` for all.
    own: Vec<(usize, i64, i64)>,
    /// A pair of columns that exclude each other.
    apart: Option<(usize, usize)>,
    quadratic: bool,
}

fn kinds() -> impl Strategy<Value = Kinds> {
    let kind = (1usize..=3, 1..=2i64, -4..=3i64);
    let row = (prop::collection::vec(-3..=4i64, 3), 0..=9i64);
    let own = (0usize..3, 1..=2i64, 1..=4i64);
    (
        prop::collection::vec(kind, 1..=3),
        prop::collection::vec(row, 1..=3),
        prop::collection::vec(own, 0..=2),
        prop::option::of((0usize..9, 0usize..9)),
        any::<bool>(),
    )
        .prop_map(|(kinds, rows, own, apart, quadratic)| Kinds {
            kinds,
            rows,
            own,
            apart,
            quadratic,
        })
}

impl Kinds {
    /// The kind of each column.
    fn columns(&self) -> Vec<usize> {
        let repeat = |(k, &(count, _, _)): (usize, &(usize, i64, i64))| vec![k; count];
        self.kinds.iter().enumerate().flat_map(repeat).collect()
    }

    fn excluded(&self) -> Option<(usize, usize)> {
        let n = self.columns().len();
        self.apart.map(|(a, b)| (a % n, b % n)).filter(|(a, b)| a != b)
    }

    fn model(&self) -> Model {
        let mut model = Model::new("kinds");
        let columns = self.columns();
        let x: Vec<Variable> = columns
            .iter()
            .enumerate()
            .map(|(j, &k)| model.integer(format!("x{j}"), 0.0, self.kinds[k].1 as f64).unwrap())
            .collect();
        let y = model.integer("y", 0.0, 2.0).unwrap();
        for (i, (weights, limit)) in self.rows.iter().enumerate() {
            let terms = x.iter().zip(&columns).map(|(&v, &k)| weights[k] as f64 * v);
            let sum = terms.fold(Affine::zero(), |sum, term| sum + term);
            model.add(format!("row{i}"), (sum + y).le(*limit as f64)).unwrap();
        }
        for (i, &(kind, a, limit)) in self.own.iter().enumerate() {
            for (j, _) in columns.iter().enumerate().filter(|(_, k)| **k == kind) {
                let row = (a as f64 * x[j] + y).le(limit as f64);
                model.add(format!("own{i}_{j}"), row).unwrap();
            }
        }
        if let Some((a, b)) = self.excluded() {
            model.add("apart", (x[a] + 2.0 * x[b]).le(2.0)).unwrap();
        }
        let mut cost = Quadratic::default();
        for (&v, &k) in x.iter().zip(&columns) {
            cost += self.kinds[k].2 as f64 * v;
        }
        cost += -1.0 * y;
        if self.quadratic {
            let all = x.iter().fold(Affine::zero(), |sum, &v| sum + v);
            cost += (all - 2.5).square();
        }
        model.minimize(cost).unwrap();
        model
    }

    fn least(&self) -> Option<f64> {
        let columns = self.columns();
        let mut best: Option<f64> = None;
        let mut x = vec![0i64; columns.len() + 1];
        loop {
            if self.holds(&x, &columns) {
                let (y, own) = (x[columns.len()], &x[..columns.len()]);
                let cost: i64 = own.iter().zip(&columns).map(|(v, &k)| v * self.kinds[k].2).sum();
                let all: i64 = own.iter().sum();
                let square = if self.quadratic { (all as f64 - 2.5).powi(2) } else { 0.0 };
                let cost = (cost - y) as f64 + square;
                best = Some(best.map_or(cost, |old| old.min(cost)));
            }
            let top = |j: usize| columns.get(j).map_or(2, |&k| self.kinds[k].1);
            let Some(wheel) = (0..x.len()).find(|&j| x[j] < top(j)) else { return best };
            x[..wheel].fill(0);
            x[wheel] += 1;
        }
    }

    fn holds(&self, x: &[i64], columns: &[usize]) -> bool {
        let y = x[columns.len()];
        let rows = self.rows.iter().all(|(weights, limit)| {
            let sum: i64 = columns.iter().zip(x).map(|(&k, v)| weights[k] * v).sum();
            sum + y <= *limit
        });
        let own = self.own.iter().all(|&(kind, a, limit)| {
            let mut mine = columns.iter().zip(x).filter(|(k, _)| **k == kind);
            mine.all(|(_, v)| a * v + y <= limit)
        });
        let apart = self.excluded().is_none_or(|(a, b)| x[a] + 2 * x[b] <= 2);
        rows && own && apart
    }
}

proptest! {
    #![proptest_config(config(150, "tests/regressions/symmetry.txt"))]

    #[test]
    fn ordering_keeps_an_optimum(kinds in kinds()) {
        let model = kinds.model();
        for symmetry in [true, false] {
            let options = Options::default().with_symmetry(symmetry);
            let solution = BranchAndBound::new(options).solve(&model).unwrap();
            match kinds.least() {
                None => {
                    prop_assert_eq!(solution.termination(), Termination::Infeasible, "{}", model);
                }
                Some(least) => {
                    prop_assert!(solution.is_optimal(), "{} {}", solution.termination(), model);
                    let found = solution.objective().unwrap();
                    prop_assert!((found - least).abs() <= 1e-6, "{found}, {least}\n{model}");
                }
            }
        }
    }
}

/// Fourteen equal parts, of which the weight allows six.
#[test]
fn equal_parts_cost_few_nodes() {
    let mut model = Model::new("parts");
    let z = model.binary_family("z", 14).unwrap();
    let all = z.iter().fold(Affine::zero(), |sum, v| sum + v);
    model.add("weight", (2.0 * all.clone()).le(13.0)).unwrap();
    model.add("spare", (3.0 * all.clone()).ge(2.0)).unwrap();
    model.maximize(3.0 * all).unwrap();
    let nodes = |symmetry: bool| {
        let options = Options::default().with_symmetry(symmetry);
        let solution = BranchAndBound::new(options).solve(&model).unwrap();
        assert_eq!(solution.objective(), Some(18.0));
        solution.statistics().nodes
    };
    assert!(nodes(true) <= nodes(false));
}
