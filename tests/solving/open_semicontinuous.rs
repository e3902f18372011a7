//! Semi-continuous variables without an upper bound, which the cost of a point bounds: against all
//! cases, each a linear program.

use carom::ErrorKind;
use carom::model::{Affine, lp};
use carom::prelude::*;
use proptest::prelude::*;

use crate::common::config;
use crate::common::quadratic_program::{Minimum, QuadraticProgram};

#[derive(Debug, Clone)]
struct Open {
    /// The least value other than 0, and the cost.
    semi: Vec<(i32, i32)>,
    /// Upper bound and cost of the others.
    plain: Vec<(i32, i32)>,
    /// Coefficients, kind and right-hand side.
    rows: Vec<(Vec<i32>, u8, i32)>,
}

impl Open {
    fn solved(&self) -> Result<Solution, Error> {
        let mut model = Model::new("open");
        let mut all = Vec::new();
        for (k, &(least, _)) in self.semi.iter().enumerate() {
            all.push(model.semicontinuous(format!("s{k}"), f64::from(least), f64::INFINITY)?);
        }
        for (k, &(most, _)) in self.plain.iter().enumerate() {
            all.push(model.continuous(format!("x{k}"), 0.0, f64::from(most))?);
        }
        let mut cost = Affine::constant(7.0);
        for (&(_, c), &v) in self.semi.iter().chain(&self.plain).zip(&all) {
            cost += f64::from(c) * v;
        }
        for (k, (row, kind, right)) in self.rows.iter().enumerate() {
            let mut sum = Affine::zero();
            row.iter().zip(&all).for_each(|(&a, &v)| sum += f64::from(a) * v);
            let right = f64::from(*right);
            let row = match kind {
                0 => sum.le(right),
                1 => sum.ge(right),
                _ => sum.equals(right),
            };
            model.add(format!("r{k}"), row)?;
        }
        model.minimize(cost)?;
        BranchAndBound::default().solve(&model)
    }

    /// The least cost; `None` if there is no point.
    fn least(&self) -> Option<f64> {
        let n = self.semi.len() + self.plain.len();
        let mut best: Option<f64> = None;
        for bits in 0..1_u32 << self.semi.len() {
            let mut case = QuadraticProgram::new(n);
            let unit = |j: usize| (0..n).map(|k| f64::from(u8::from(k == j))).collect::<Vec<f64>>();
            for (j, &(least, cost)) in self.semi.iter().enumerate() {
                case.linear[j] = f64::from(cost);
                match bits >> j & 1 {
                    0 => case.add_range(&unit(j), 0.0, 0.0),
                    _ => case.add_range(&unit(j), f64::from(least), f64::INFINITY),
                }
            }
            for (j, &(most, cost)) in (self.semi.len()..).zip(&self.plain) {
                case.linear[j] = f64::from(cost);
                case.add_range(&unit(j), 0.0, f64::from(most));
            }
            for (row, kind, right) in &self.rows {
                let row: Vec<f64> = row.iter().map(|&a| f64::from(a)).collect();
                let right = f64::from(*right);
                match kind {
                    0 => case.add_range(&row, f64::NEG_INFINITY, right),
                    1 => case.add_range(&row, right, f64::INFINITY),
                    _ => case.add_range(&row, right, right),
                }
            }
            if let Minimum::Attained { value, .. } = case.solve() {
                best = Some(best.map_or(value, |best| best.min(value)));
            }
        }
        best.map(|best| best + 7.0)
    }
}

prop_compose! {
    fn open()(n in 1_usize..4, m in 0_usize..3)(
        semi in prop::collection::vec((1..6, 1..9), n),
        plain in prop::collection::vec((1..9, -5..6), m),
        rows in prop::collection::vec((prop::collection::vec(-4..5, n + m), 0_u8..3, -5..30), 1..4),
    ) -> Open {
        let rows = rows.into_iter().filter(|(row, ..): &(Vec<i32>, u8, i32)| row.iter().any(|&a| a != 0));
        Open { semi, plain, rows: rows.collect() }
    }
}

proptest! {
    #![proptest_config(config(200, "tests/regressions/open_semicontinuous.txt"))]

    #[test]
    fn open_semicontinuous_variables_have_the_optimum_of_all_cases(case in open()) {
        match (case.least(), case.solved()) {
            (Some(least), Ok(solution)) => {
                prop_assert!(solution.is_optimal(), "{:?}, not {least}", solution.termination());
                let found = solution.objective().expect("a point");
                prop_assert!((found - least).abs() <= 1e-4 * least.abs().max(1.0), "{found}, not {least}");
            }
            (None, Ok(solution)) => prop_assert!(solution.is_infeasible()),
            // Without a point, nothing bounds the variables.
            (least, Err(error)) => {
                let is_bound = matches!(error.kind(), ErrorKind::UnboundedFunction { .. });
                prop_assert!(is_bound && least.is_none(), "{error}, not {least:?}");
            }
        }
    }
}

/// Rows give no upper bound, and the cost does.
#[test]
fn the_cost_of_a_point_bounds_semicontinuous_variables() {
    let text = |sense: &str, cost: &str| {
        format!(
            "{sense}\n obj: {cost}\nSubject To\n c1: 3 x1 + 2 x2 >= 60\nBounds\n x1 >= 1\n x2 >= 2\n\
             Semi-Continuous\n x1 x2\nEnd\n"
        )
    };
    let solve = |text: &str| {
        let model = lp::read(text).expect("a model").model;
        BranchAndBound::default().solve(&model)
    };
    let solution = solve(&text("Minimize", "8 x1 + 6 x2")).expect("a solve");
    assert!(solution.is_optimal());
    assert!((solution.objective().expect("a point") - 160.0).abs() < 1e-6);
    let solution = solve(&text("Maximize", "- 8 x1 - 6 x2")).expect("a solve");
    assert!((solution.objective().expect("a point") + 160.0).abs() < 1e-6);
    // Where more costs nothing, nothing bounds it.
    let error = solve(&text("Minimize", "8 x1 - 6 x2")).expect_err("no bound");
    assert!(matches!(error.kind(), ErrorKind::UnboundedFunction { .. }), "{error}");
}
