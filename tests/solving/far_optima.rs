//! Optima far from 0 along variables without bounds.

use carom::prelude::*;
use carom::solution::{Note, Termination};
use proptest::prelude::*;

const FREE: f64 = f64::INFINITY;

fn solved(model: &Model, presolve: bool) -> Solution {
    let options = Options::default().with_presolve(presolve);
    BranchAndBound::new(options).solve(model).unwrap()
}

fn close(found: f64, wanted: f64) -> bool {
    (found - wanted).abs() <= 1e-5 * wanted.abs().max(1.0)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]

    /// Curvature ends the fall of an objective, however slight it is, and then proofs need no
    /// radius.
    #[test]
    fn slight_curvature_is_curvature(
        exponents in prop::collection::vec(-13_i32..8, 1..4),
        costs in prop::collection::vec(1_u8..9, 4),
        with_binary in any::<bool>(),
        presolve in any::<bool>(),
    ) {
        let mut model = Model::new("far");
        let x = model.continuous_family("x", exponents.len(), -FREE, FREE).unwrap();
        let mut cost = Quadratic::from(0.0);
        let mut optimum = 0.0;
        for (k, x) in x.iter().enumerate() {
            let (curvature, slope) = (10_f64.powi(exponents[k]), f64::from(costs[k]));
            cost += 0.5 * curvature * x.square() - slope * x;
            optimum -= 0.5 * slope * slope / curvature;
        }
        if with_binary {
            let z = model.binary("z").unwrap();
            model.add("row", (x[0] + z).ge(-0.5)).unwrap();
            cost += Quadratic::from(f64::from(costs[3]) * z);
        }
        model.minimize(cost).unwrap();
        let solution = solved(&model, presolve);
        prop_assert!(solution.is_optimal(), "{}: {:?}", solution.termination(), solution.notes());
        prop_assert!(close(solution.objective().unwrap(), optimum), "{}", solution.objective().unwrap());
    }

    /// Along a valley the curvature is slight beside what it is the sum of.
    #[test]
    fn valleys_are_never_called_unbounded_unless_they_are(
        exponent in -13_i32..1,
        ratio in prop::sample::select(vec![1.0, 3.0, 0.7]),
        steep in prop::sample::select(vec![1.0, 1e3, 1e6]),
        falls in any::<bool>(),
        presolve in any::<bool>(),
    ) {
        let mut model = Model::new("valley");
        let x = model.continuous("x", -FREE, FREE).unwrap();
        let y = model.continuous("y", -FREE, FREE).unwrap();
        let valley = steep * (x - ratio * y).square() - x - y;
        // Less than this beside the other coefficients is lost as soon as it is written down.
        let curvature = 10_f64.powi(exponent).max(1e-12 * steep);
        model.minimize(if falls { valley } else { valley + curvature * y.square() }).unwrap();
        let solution = solved(&model, presolve);
        match solution.termination() {
            Termination::Unbounded => prop_assert!(falls),
            Termination::Optimal => {
                // x = ratio y + 1 / (2 steep), and y minimises what is left.
                let optimum = -0.25 / steep - 0.25 * (1.0 + ratio).powi(2) / curvature;
                prop_assert!(!falls && close(solution.objective().unwrap(), optimum));
            }
            _ => prop_assert!(!falls, "{}", solution.termination()),
        }
    }

    /// Beside an objective of 1e16, a fall of 1e9 is within the gap. What falls for ever has no
    /// optimum all the same.
    #[test]
    fn a_fall_without_end_is_no_optimum_beside_large_values(
        exponent in 3_i32..18,
        bends in any::<bool>(),
        costs in prop::array::uniform4(-3_i8..4),
        entries in prop::array::uniform8(-4_i8..5),
        presolve in any::<bool>(),
    ) {
        let far = 10_f64.powi(exponent);
        let mut model = Model::new("fall");
        let x = model.continuous("x", -FREE, FREE).unwrap();
        let y = model.continuous("y", -far, 10.0 * far).unwrap();
        let z = model.continuous("z", -FREE, FREE).unwrap();
        let t = model.continuous("t", 0.0, FREE).unwrap();
        let e = entries.map(f64::from);
        // As x grows, the first row gets more room, and the second does not change.
        let fall = e[0].abs() + 1.0;
        model.add("first", (fall * x + e[1] * y + e[2] * z + e[3] * t).ge(0.0)).unwrap();
        model.add("second", (e[4] * y + e[5] * z + e[6] * t).le(7.0 + e[7])).unwrap();
        let c = costs.map(f64::from);
        let curvature = if bends { 0.5 } else { 0.0 };
        model
            .minimize((-c[0].abs() - 1.0) * x + c[1] * y + c[2] * z + c[3] * t + curvature * t.square())
            .unwrap();
        let solution = solved(&model, presolve);
        let wrong = [Termination::Optimal, Termination::Infeasible];
        prop_assert!(!wrong.contains(&solution.termination()), "{:?}", solution.objective());
    }
}

/// Rows hold the optimum, but no proof for variables without bounds reaches that far.
#[test]
fn an_optimum_beyond_the_radius_of_proofs_says_so() {
    let mut model = Model::new("far");
    let x = model.continuous("x", -FREE, FREE).unwrap();
    let y = model.continuous("y", -FREE, FREE).unwrap();
    model.add("sum", (x + y).ge(2e10)).unwrap();
    model.add("first", (x - y).ge(0.0)).unwrap();
    model.minimize(x).unwrap();
    let mut log = Log::new(Vec::new());
    let solution = solved(&model, true);
    log.finish(&solution);
    let hint = "the best points have variables without bounds that are farther than 1e9 from 0, where \
                bounds are not proved; give all variables finite bounds, or measure them in larger units \
                [far-from-zero]";
    assert_eq!(solution.termination(), Termination::Stalled);
    assert_eq!(solution.notes(), [Note::FarFromZero]);
    assert_eq!(Note::FarFromZero.to_string(), hint);
    assert!(String::from_utf8(log.into_inner().unwrap()).unwrap().contains(hint));
    for variable in [x, y] {
        model.set_bounds(variable, -1e12, 1e12).unwrap();
    }
    let solution = solved(&model, true);
    assert!(solution.is_optimal() && close(solution.objective().unwrap(), 1e10));
    assert_eq!(solution.notes(), []);
}

/// The same beside an objective of 1e16, where the fall within the radius is within the gap.
#[test]
fn a_fall_that_the_gap_hides_is_no_optimum() {
    let text = "Maximize\n obj: - 3 x0 - 2 x1 + x2 + [ - x3 ^2 ] / 2\nSubject To\n \
                r0: - 4 x0 - 3 x1 + x2 + x3 >= 0\n r1: 3 x1 + 2 x2 - 3 x3 <= 7\nBounds\n x0 free\n \
                -1e16 <= x1 <= 1e17\n x2 free\n x3 >= 0\nEnd\n";
    let model = carom::model::lp::read(text).expect("a program").model;
    for presolve in [true, false] {
        let termination = solved(&model, presolve).termination();
        assert!(!matches!(termination, Termination::Optimal | Termination::Infeasible));
    }
}
