//! Convex forms over columns with two values have the value of the objective at every whole point
//! that satisfies the rows, and are convex.

use crate::common::config;
use carom::model::{Affine, Quadratic};
use carom::prelude::*;
use carom_model::internals::semidefinite::negative_direction;
use carom_solver::internals::branch_and_bound::convex_model;
use carom_solver::internals::program::Program;
use proptest::prelude::*;

const REGRESSIONS: &str = "tests/regressions/convex_forms.txt";

#[derive(Debug, Clone)]
struct Form {
    maximize: bool,
    /// What coefficients are multiples of.
    unit: f64,
    /// The lower value of each column.
    lower: Vec<i32>,
    cost: Vec<i32>,
    products: Vec<(usize, usize, i32)>,
    /// Coefficients, and a point that satisfies the row with equality, by bits.
    rows: Vec<(Vec<i32>, u32, bool)>,
}

prop_compose! {
    fn form()(n in 2_usize..9)(
        maximize in any::<bool>(),
        lower in prop::collection::vec(prop_oneof![3 => Just(0), 1 => -4..5], n),
        cost in prop::collection::vec(-90..90, n),
        products in prop::collection::vec((0..n, 0..n, -90..90), n..n * n),
        rows in prop::collection::vec(
            (prop::collection::vec(-30..31, n), any::<u32>(), any::<bool>()), 0..4),
    ) -> Form {
        let rows = rows.into_iter().filter(|(row, ..)| row.iter().any(|&a| a != 0)).collect();
        Form { maximize, unit: 0.1, lower, cost, products, rows }
    }
}

impl Form {
    fn value(&self, bits: u32, k: usize) -> f64 {
        f64::from(self.lower[k]) + f64::from(bits >> k & 1)
    }

    fn limit(&self, row: &[i32], at: u32) -> f64 {
        row.iter().enumerate().map(|(k, &a)| self.unit * f64::from(a) * self.value(at, k)).sum()
    }

    fn model(&self) -> Result<(Model, Vec<Variable>), Error> {
        let mut model = Model::new("form");
        let x = (0..).zip(&self.lower);
        let x = x.map(|(k, &l)| model.integer(format!("x{k}"), f64::from(l), f64::from(l + 1)));
        let x: Vec<Variable> = x.collect::<Result<_, _>>()?;
        for (i, (row, at, is_equation)) in self.rows.iter().enumerate() {
            let terms = row.iter().zip(&x).map(|(&a, &v)| self.unit * f64::from(a) * v);
            let sum = terms.fold(Affine::zero(), |sum, term| sum + term);
            let limit = self.limit(row, *at);
            let row = if *is_equation { sum.equals(limit) } else { sum.le(limit) };
            model.add(format!("r{i}"), row)?;
        }
        let mut objective = Quadratic::from(1.5);
        self.cost.iter().zip(&x).for_each(|(&c, &v)| objective += self.unit * f64::from(c) * v);
        for &(a, b, q) in &self.products {
            objective.add_product(self.unit * f64::from(q), x[a], x[b]);
        }
        let sense = if self.maximize { Sense::Maximize } else { Sense::Minimize };
        model.set_objective(sense, objective)?;
        Ok((model, x))
    }
}

proptest! {
    #![proptest_config(config(200, REGRESSIONS))]

    #[test]
    fn a_convex_form_keeps_values_at_whole_points(form in form()) {
        let (model, x) = form.model().expect("a model");
        let convex = convex_model(&model).expect("a convex form");
        let products = convex.minimized_products();
        prop_assert!(negative_direction(&products, &|_| 0.0).is_none(), "{convex}");
        let n = x.len();
        let size: f64 = 1.0 + products.iter().map(|(.., q)| q.abs()).sum::<f64>();
        for bits in 0..1_u32 << n {
            let sum = |row: &[i32]| form.limit(row, bits);
            let holds = form.rows.iter().all(|(row, at, is_equation)| {
                let missed = sum(row) - form.limit(row, *at);
                if *is_equation { missed.abs() < 1e-9 } else { missed < 1e-9 }
            });
            // Products that have columns of their own have no value here.
            if !holds || convex.variables().len() > n {
                continue;
            }
            let at = |v: Variable| form.value(bits, v.index());
            let (own, other) = (model.objective().evaluate(at), convex.objective().evaluate(at));
            prop_assert!((own - other).abs() <= 1e-12 * size, "{own} {other}\n{model}\n{convex}");
        }
    }
}

proptest! {
    #![proptest_config(config(100, REGRESSIONS))]

    /// Terms of 1e8 cancel, and no digit is lost.
    #[test]
    fn columns_far_from_0_keep_all_digits(form in form(), far in prop::collection::vec(-2000..2000, 9)) {
        let lower = form.lower.iter().zip(far).map(|(l, by)| l + by).collect();
        let form = Form { unit: 0.25, lower, ..form };
        let (model, x) = form.model().expect("a model");
        let convex = convex_model(&model).expect("a convex form");
        if convex.variables().len() > x.len() {
            return Ok(());
        }
        let assemble = |model: &Model| Program::assemble(model).expect("a program");
        let (before, after) = (assemble(&model), assemble(&convex));
        for bits in 0..1_u32 << x.len() {
            let holds = form.rows.iter().all(|(row, at, is_equation)| {
                let missed = form.limit(row, bits) - form.limit(row, *at);
                if *is_equation { missed == 0.0 } else { missed <= 0.0 }
            });
            let point: Vec<f64> = (0..x.len()).map(|k| form.value(bits, k)).collect();
            let (own, other) = (before.objective(&point), after.objective(&point));
            prop_assert!(!holds || (own - other).abs() <= 1e-9 * own.abs().max(1.0), "{own} {other}");
        }
    }
}

/// The densest part of a graph: with the square of the only row, the relaxation is so close that
/// few nodes are left.
#[test]
fn a_square_of_an_equation_closes_most_of_a_tree() {
    let mut model = Model::new("densest");
    let take = model.binary_family("take", 20).expect("binaries");
    let (mut objective, mut count) = (Quadratic::zero(), Affine::zero());
    for i in 0..20 {
        count += take[i];
        for j in (0..i).filter(|j| (i * j + i + 3 * j) % 5 < 2) {
            objective.add_product(1.0, take[i], take[j]);
        }
    }
    model.add("eight", count.equals(8.0)).expect("a row");
    model.maximize(objective).expect("a convex form");
    let solution = BranchAndBound::default().solve(&model).expect("a solve");
    let pairs = |bits: u32| {
        let linked = |i: u32, j: u32| (i * j + i + 3 * j) % 5 < 2;
        let taken = |i: u32| bits >> i & 1 == 1;
        (0..20).map(|i| (0..i).filter(|&j| taken(i) && taken(j) && linked(i, j)).count()).sum()
    };
    let best: Option<usize> =
        (0..1_u32 << 20).filter(|bits| bits.count_ones() == 8).map(pairs).max();
    assert!((solution.objective().expect("a point") - best.expect("parts") as f64).abs() < 1e-6);
    assert!(solution.statistics().nodes < 1000, "{} nodes", solution.statistics().nodes);
}
