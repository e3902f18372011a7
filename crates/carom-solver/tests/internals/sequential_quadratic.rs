//! Programs with few, long norms: the optimum of the search, whose relaxations are sequences of
//! quadratic programs, is that of enumeration with Clarabel.

use carom::model::norm;
use carom::prelude::*;
use carom::solver::RelaxationMethod;
use proptest::prelude::*;

use crate::common::config;

const REGRESSIONS: &str = "tests/regressions/sequential_quadratic.txt";

/// Columns with a binary each.
const COLUMNS: usize = 4;

/// `|tail x + offset| <= head x + length` over the columns, or over their parts.
#[derive(Debug, Clone)]
struct Norm {
    tail: Vec<([f64; COLUMNS], f64)>,
    head: [f64; COLUMNS],
    length: f64,
}

#[derive(Debug, Clone)]
struct Portfolio {
    norms: Vec<Norm>,
    costs: [f64; COLUMNS],
    squares: [f64; COLUMNS],
    /// The sum of the columns, and most binaries that are 1.
    sum: Option<f64>,
    most: usize,
    least: f64,
}

prop_compose! {
    fn long_norm()(
        tail in prop::collection::vec(
            (prop::array::uniform4(-2.0..2.0), prop_oneof![Just(0.0), -0.5..0.5]), 8..12),
        head in prop_oneof![Just([0.0; COLUMNS]), prop::array::uniform4(-1.0..1.0)],
        length in prop_oneof![Just(0.0), 0.1..3.0],
    ) -> Norm {
        Norm { tail, head, length }
    }
}

prop_compose! {
    fn portfolio()(
        norms in prop::collection::vec(long_norm(), 1..4),
        costs in prop::array::uniform4(-3.0..3.0),
        squares in prop_oneof![Just([0.0; COLUMNS]), prop::array::uniform4(0.0..2.0)],
        sum in prop::option::of(0.0..1.5),
        most in 1..=COLUMNS,
        least in prop_oneof![Just(0.0), -1.0..0.0],
    ) -> Portfolio {
        Portfolio { norms, costs, squares, sum, most, least }
    }
}

impl Portfolio {
    /// The program, with all binaries fixed if there is a choice of them by bits.
    fn model(&self, choice: Option<usize>) -> Model {
        let mut model = Model::new("portfolio");
        let x: Vec<Variable> = (0..COLUMNS)
            .map(|k| model.continuous(format!("x{k}"), self.least, 1.0).unwrap())
            .collect();
        let z: Vec<Variable> =
            (0..COLUMNS).map(|k| model.binary(format!("z{k}")).unwrap()).collect();
        let mut count = Affine::zero();
        for (k, (&x, &z)) in x.iter().zip(&z).enumerate() {
            model.add(format!("on{k}"), x.le(1.0 * z)).unwrap();
            model.add(format!("off{k}"), x.ge(self.least * z)).unwrap();
            count += z;
            if let Some(choice) = choice {
                let value = if choice >> k & 1 == 1 { 1.0 } else { 0.0 };
                model.add(format!("fixed{k}"), z.equals(value)).unwrap();
            }
        }
        model.add("most", count.le(self.most as f64)).unwrap();
        let over = |row: &[f64; COLUMNS], offset: f64| {
            let terms = row.iter().zip(&x).map(|(a, x)| *a * *x);
            terms.fold(Affine::from(offset), |sum, term| sum + term)
        };
        if let Some(sum) = self.sum {
            model.add("sum", over(&[1.0; COLUMNS], 0.0).equals(sum)).unwrap();
        }
        for (k, one) in self.norms.iter().enumerate() {
            let tail: Vec<Affine> = one.tail.iter().map(|(row, t)| over(row, *t)).collect();
            model.add(format!("norm{k}"), norm(tail).le(over(&one.head, one.length))).unwrap();
        }
        let mut objective = Quadratic::from(over(&self.costs, 0.0));
        for (&q, &x) in self.squares.iter().zip(&x) {
            objective.add_product(q, x, x);
        }
        model.minimize(objective).unwrap();
        model
    }

    /// The least cost, by enumeration; `None` if there is no point.
    fn optimum(&self) -> Option<f64> {
        let costs = (0..1_usize << COLUMNS).filter_map(|choice| {
            let options = Options::default().with_relaxation(RelaxationMethod::Clarabel);
            let solution = BranchAndBound::new(options).solve(&self.model(Some(choice))).unwrap();
            solution.objective()
        });
        costs.min_by(f64::total_cmp)
    }
}

proptest! {
    #![proptest_config(config(24, REGRESSIONS))]

    #[test]
    fn the_search_ends_at_the_optimum(portfolio in portfolio(), deterministic in any::<bool>()) {
        let options = Options::default().with_deterministic(deterministic);
        let solution = BranchAndBound::new(options).solve(&portfolio.model(None)).unwrap();
        let least = portfolio.optimum();
        match (solution.objective(), least) {
            (Some(found), Some(least)) => {
                let size = least.abs().max(1.0);
                prop_assert!((found - least).abs() <= 3e-6 * size, "{found} and {least}");
                prop_assert!(solution.bound() <= least + 3e-6 * size, "{}", solution.bound());
            }
            (None, None) => {}
            // A cone that is met in one point only, by rounding.
            (found, least) => prop_assert!(false, "{found:?} and {least:?}"),
        }
    }
}
