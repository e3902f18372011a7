//! Rows whose coefficients are far apart, and equalities over integers of wide ranges: a value
//! within the integrality tolerance does not hide which whole numbers a row leaves.

use carom::model::lp;
use carom::prelude::*;
use carom::solver::PoolMode;

/// The answer with and without presolve, by pools and by kept leaves.
fn answers(text: &str) -> Vec<Solution> {
    let model = lp::read(text).expect("a model").model;
    let mut without = Options::default();
    without.parts_mut().reductions = false;
    let options = [
        Options::default(),
        without.clone(),
        Options::default().with_pool(2, PoolMode::Best),
        Options::default().with_leaves(true),
    ];
    let solve = |options| BranchAndBound::new(options).solve(&model).expect("an answer");
    options.into_iter().map(solve).collect()
}

fn assert_optimal(text: &str, objective: f64) {
    for (k, solution) in answers(text).into_iter().enumerate() {
        assert!(solution.is_optimal(), "{k}: {}", solution.termination());
        let found = solution.objective().unwrap();
        assert!((found - objective).abs() <= 1e-6 * objective.abs().max(1.0), "{k}: {found}");
        assert!(solution.statistics().nodes < 100, "{k}: {}", solution.statistics().nodes);
    }
}

fn assert_infeasible(text: &str) {
    for (k, solution) in answers(text).into_iter().enumerate() {
        assert!(solution.is_infeasible(), "{k}: {}", solution.termination());
    }
}

#[test]
fn a_binary_near_0_that_has_to_be_1() {
    for (big, right) in [("100000000", "20"), ("100000000", "0.3"), ("12345678.9", "0.3")] {
        assert_optimal(&format!("min\n 33 z\nst\n r: {big} z >= {right}\nbin\n z\nend\n"), 33.0);
        assert_optimal(
            &format!(
                "min\n 7 z + x\nst\n r: {big} z - x >= {right}\nbounds\n x <= 10\nbin\n z\nend\n"
            ),
            7.0,
        );
    }
    // What is left of a large limit.
    assert_optimal(
        "min\n - 7 z + x\nst\n r: 99999999.5 z + x <= 99999999\nbounds\n x <= 10\nbin\n z\nend\n",
        0.0,
    );
    assert_infeasible(
        "min\n x2 + 42 x4 + 30 x5\nst\n r1: 2 x2 - 100000000 x4 <= -8\n \
         r2: - 2 x2 + 10000 x5 >= 11\n r4: x4 + x5 <= 1\nbounds\n x2 <= 29\nbin\n x4 x5\nend\n",
    );
    // A row that is missed by a little, once others have fixed its columns.
    assert_infeasible(
        "min\n z\nst\n r0: - 7 y = -7042\n r1: 100000000 z - y >= -970\n \
         r4: - 9999997 z + y >= -9998990.9\nbounds\n y <= 10007\ngen\n y\nbin\n z\nend\n",
    );
    assert_infeasible(
        "min\n x\nst\n a: x >= 100000000.5\n b: x <= 100000000\nbounds\n x free\nend\n",
    );
}

/// Presolve puts a continuous column in terms of terms of 1e10, whose rounding is not that of its
/// bounds.
#[test]
fn an_equality_over_wide_integers() {
    assert_optimal(
        "max\n 4 x1 + 5 x2 + 1 x3\nst\n r0: - 7 x1 - 8 x2 + 1 x3 + 6 x4 = -752\nbounds\n \
         -1000000000 <= x1 <= 1000000006\n -1000000000 <= x2 <= 1000000002\n 0 <= x3 <= 1\n \
         0 <= x4 <= 10000\ngen\n x1 x2\nend\n",
        375_037_971.0,
    );
}

/// The least `x` with `12345678 x = 9 (mod 87654321)`, and the like.
#[test]
fn divisibility_decides() {
    let least = (0..87_654_321_i64).find(|x| (12_345_678 * x - 9) % 87_654_321 == 0).unwrap();
    assert_optimal(
        "min\n x\nst\n r: 12345678 x - 87654321 y = 9\nbounds\n x <= 1000000000\n \
         y <= 1000000000\ngen\n x y\nend\n",
        least as f64,
    );
    let squares = |x: i64| {
        let rest = 1001 * x - 7;
        (rest % 999 == 0).then(|| x * x + (rest / 999) * (rest / 999))
    };
    let least = (-2000..2000).filter_map(squares).min().unwrap();
    assert_optimal(
        "min\n [ 2 x ^2 + 2 y ^2 ] / 2\nst\n r: 1001 x - 999 y = 7\nbounds\n x free\n y free\n\
         gen\n x y\nend\n",
        least as f64,
    );
    // A binary with a large coefficient beside two wide integers.
    assert_optimal(
        "max\n 3 x - 2 y + b\nst\n r: 100000000 b - x + y = 17\n s: x + y <= 150000000\nbounds\n \
         x <= 1000000000\n y <= 1000000000\ngen\n x y\nbin\n b\nend\n",
        324_999_958.0,
    );
    assert_infeasible(
        "min\n x\nst\n r: 6 x + 10 y - 4 z = 5\nbounds\n x free\n y free\n z free\ngen\n x y z\nend\n",
    );
    // What a row says of `z`, once another one has put it in terms of `w`.
    let text = "min\n x\nst\n r: 6 x + 10 y + 15 z = 7\n s: z - 2 w = 0\nbounds\n x free\n y free\n \
                z free\n w free\ngen\n x y z w\nend\n";
    let model = lp::read(text).expect("a model").model;
    assert!(BranchAndBound::default().solve(&model).expect("an answer").is_infeasible());
}
