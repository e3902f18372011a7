//! Equalities that follow from each other. Where presolve puts one into the others, only rounding
//! is left of their difference, and a small coefficient multiplies it.

use crate::common::config;
use carom::model::lp;
use carom::prelude::*;
use proptest::prelude::*;

fn assert_solved(text: &str, objective: f64) {
    let model = lp::read(text).expect("a model").model;
    for reductions in [true, false] {
        let mut options = Options::default();
        options.parts_mut().reductions = reductions;
        let solution = BranchAndBound::new(options).solve(&model).expect("an answer");
        assert!(solution.is_optimal(), "{}", solution.termination());
        assert!((solution.objective().unwrap() - objective).abs() < 1e-6);
    }
}

/// The third row is the sum of the second one and twice the first one. Presolve leaves two rows in
/// which `w` has a coefficient of 4e-5, and whose limits differ by 1e-11.
#[test]
fn a_row_that_is_a_combination_of_two_others() {
    assert_solved(
        "min\n 0.01171875 y\nst\n a: 32 z - 192 x + 7 w + 0.375 y = -73685.5\n \
         b: - 96 z + 0.0009765625 x = -95.625\n \
         c: - 32 z - 383.9990234375 x + 14 w + 0.75 y = -147466.625\nbounds\n \
         256 <= x <= 768\nbin\n z y\nend\n",
        0.0,
    );
}

fn one_of(values: &'static [f64]) -> impl Strategy<Value = f64> {
    prop::sample::select(values)
}

proptest! {
    #![proptest_config(config(400, "tests/regressions/dependent_rows.txt"))]

    /// A point satisfies all rows exactly, so the program has one; with and without presolve, the
    /// optima agree.
    #[test]
    fn a_program_with_a_point_is_not_infeasible(
        binaries in prop::collection::vec((any::<bool>(), -100_i32..=100, one_of(&[32.0, 0.375, -7.0, 5.0])), 1..4),
        (x, w) in (one_of(&[256.0, 384.0, 512.0, 700.0]), one_of(&[0.0, 0.25, 1.5, 3.0, 40.0])),
        (power, odd) in (6_i32..=12, one_of(&[1.0, 3.0])),
        of_x in one_of(&[-192.0, 192.0, 100.0, -77.0, 500.0]),
        of_w in one_of(&[7.0, 3.0, 1.0, 11.0, -5.0]),
        factor in one_of(&[2.0, -1.0, 3.0, 0.5, 1.0]),
        order in Just([0_usize, 1, 2]).prop_shuffle(),
    ) {
        let mut model = Model::new("dependent rows");
        let z = model.binary_family("z", binaries.len()).unwrap();
        let (vx, vw) = (model.continuous("x", 256.0, 768.0).unwrap(), model.continuous("w", 0.0, f64::INFINITY).unwrap());
        let small = odd * f64::from(-power).exp2();
        // By row: the coefficients of the binaries, of `x` and of `w`.
        let first: Vec<f64> = binaries.iter().map(|b| b.2).chain([of_x, of_w]).collect();
        let second: Vec<f64> = binaries.iter().map(|b| f64::from(b.1)).chain([small, 0.0]).collect();
        let third = first.iter().zip(&second).map(|(a, b)| factor * a + b).collect();
        let point: Vec<f64> =
            binaries.iter().map(|b| f64::from(u8::from(b.0))).chain([x, w]).collect();
        let columns: Vec<Variable> = z.iter().chain([vx, vw]).collect();
        let rows = [first, second, third];
        for k in order {
            let activity = rows[k].iter().zip(&columns).map(|(&a, &v)| a * v).sum::<Affine>();
            let value: f64 = rows[k].iter().zip(&point).map(|(a, x)| a * x).sum();
            model.add(("row", k), activity.equals(value)).unwrap();
        }
        model.minimize(z.iter().map(|z| 1.0 * z).sum::<Affine>()).unwrap();
        let found = [true, false].map(|reductions| {
            let mut options = Options::default();
            options.parts_mut().reductions = reductions;
            BranchAndBound::new(options).solve(&model).unwrap()
        });
        for solution in &found {
            prop_assert!(solution.is_optimal(), "{}", solution.termination());
        }
        let [a, b] = found.map(|solution| solution.objective().unwrap());
        prop_assert!((a - b).abs() < 1e-6, "{a} {b}");
    }
}
