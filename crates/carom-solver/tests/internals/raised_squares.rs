//! Other squares of binaries in an assembled program: the objective is the same where these are
//! whole, and convex.

use crate::common::config;
use carom::model::{Affine, Quadratic};
use carom::prelude::*;
use carom_model::internals::semidefinite::{Product, negative_direction};
use carom_solver::internals::branch_and_bound::with_raised_squares;
use carom_solver::internals::program::Program;
use proptest::prelude::*;

const REGRESSIONS: &str = "tests/regressions/raised_squares.txt";

/// A sum of squares over columns with two values and continuous ones.
#[derive(Debug, Clone)]
struct Squares {
    maximize: bool,
    /// Lower bound by column; the first ones have two values, all are one wide.
    lower: Vec<i32>,
    two: usize,
    /// Coefficients in hundredths.
    squares: Vec<Vec<i32>>,
    /// The square of each column, in tenths.
    own: Vec<u32>,
    cost: Vec<i32>,
    /// Coefficients and the limit of rows over the first columns.
    rows: Vec<(Vec<i32>, i32, bool)>,
}

prop_compose! {
    fn squares()(two in 3_usize..9, others in 0_usize..4)(
        maximize in any::<bool>(),
        two in Just(two),
        lower in prop::collection::vec(
            prop_oneof![4 => Just(0), 2 => -4..5, 1 => -3000..3000], two + others),
        squares in prop::collection::vec(
            prop::collection::vec(-300..301, two + others), 1..two + others + 2),
        own in prop_oneof![
            Just(vec![0; two + others]), prop::collection::vec(0_u32..90, two + others)],
        cost in prop::collection::vec(-90..90, two + others),
        rows in prop::collection::vec(
            (prop::collection::vec(-3..4, two), -4..9, any::<bool>()), 0..3),
    ) -> Squares {
        let rows = rows.into_iter().filter(|(row, ..)| row.iter().any(|&a| a != 0)).collect();
        Squares { maximize, lower, two, squares, own, cost, rows }
    }
}

impl Squares {
    fn model(&self) -> Result<Model, Error> {
        let mut model = Model::new("squares");
        let ends = |l: i32| [f64::from(l), f64::from(l) + 1.0];
        let x = self.lower.iter().enumerate().map(|(k, &l)| match (k < self.two, ends(l)) {
            (true, [l, u]) => model.integer(format!("n{k}"), l, u),
            (false, [l, u]) => model.continuous(format!("x{k}"), l, u),
        });
        let x: Vec<Variable> = x.collect::<Result<_, _>>()?;
        for (i, (row, limit, is_equation)) in self.rows.iter().enumerate() {
            let terms = row.iter().zip(&x).map(|(&a, &v)| f64::from(a) * v);
            let sum = terms.fold(Affine::zero(), |sum, term| sum + term);
            let limit = f64::from(*limit);
            model.add(
                format!("r{i}"),
                if *is_equation { sum.equals(limit) } else { sum.le(limit) },
            )?;
        }
        let mut objective = Quadratic::from(1.5);
        for ((&v, &own), &cost) in x.iter().zip(&self.own).zip(&self.cost) {
            objective.add_product(0.1 * f64::from(own), v, v);
            objective += 0.1 * f64::from(cost) * v;
        }
        for square in &self.squares {
            for (i, &a) in square.iter().enumerate() {
                for (k, &b) in square.iter().enumerate() {
                    objective.add_product(1e-4 * f64::from(a) * f64::from(b), x[i], x[k]);
                }
            }
        }
        match self.maximize {
            true => model.maximize(-objective)?,
            false => model.minimize(objective)?,
        }
        Ok(model)
    }
}

/// The products of the minimised objective, each pair once.
fn products(program: &Program) -> Vec<Product> {
    let mut products = Vec::new();
    for j in 0..program.column_count() {
        let (rows, values) = program.quadratic_column(j);
        for (&i, &p) in rows.iter().zip(values).filter(|(i, _)| **i <= j) {
            products.push((i, j, if i == j { 0.5 * p } else { p }));
        }
    }
    products
}

proptest! {
    #![proptest_config(config(200, REGRESSIONS))]

    #[test]
    fn raised_squares_keep_values_at_whole_points(case in squares(), parts in any::<[u8; 4]>()) {
        let program = Program::assemble(&case.model().expect("a model")).expect("a program");
        let Some(raised) = with_raised_squares(&program) else { return Ok(()) };
        let (before, after) = (products(&program), products(&raised));
        prop_assert!(negative_direction(&after, &|_| 0.0).is_none(), "{after:?}");
        // Only squares of the first columns have changed.
        for &(i, k, q) in &before {
            let now = after.iter().find(|product| (product.0, product.1) == (i, k));
            prop_assert!((i == k && i < case.two) || now.is_some_and(|now| now.2 == q));
        }
        let part = |k: usize| f64::from(parts[k % 4]) / 255.0;
        for bits in 0..1_u32 << case.two {
            let value = |k: usize| match k < case.two {
                true => f64::from(case.lower[k]) + f64::from(bits >> k & 1),
                false => f64::from(case.lower[k]) + part(k),
            };
            let x: Vec<f64> = (0..case.lower.len()).map(value).collect();
            let terms = after.iter().chain(&before).map(|(i, k, q)| (q * x[*i] * x[*k]).abs());
            let size = 1.0 + terms.sum::<f64>();
            let (own, other) = (program.objective(&x), raised.objective(&x));
            prop_assert!((own - other).abs() <= 1e-13 * size, "{own} {other} at {x:?}");
        }
    }
}

/// `2 b^2 - 2 b` is 0 at whole points and -1/2 between them.
#[test]
fn curvature_of_binaries_is_taken_off() {
    let mut model = Model::new("own");
    let b = model.binary_family("b", 5).expect("binaries");
    let sum: Affine = b.iter().map(|v| 1.0 * v).sum();
    let mut objective = 0.01 * sum.square() - 2.0 * &sum;
    b.iter().for_each(|v| objective.add_product(2.0, v, v));
    model.minimize(objective).expect("a convex objective");
    let program = Program::assemble(&model).expect("a program");
    let raised = with_raised_squares(&program).expect("other squares");
    let middle = [0.5; 5];
    assert!(program.objective(&middle) < -2.0 && raised.objective(&middle) > -0.1);
}
