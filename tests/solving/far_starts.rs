//! Programs whose middle is far from their points: wide levels of which little steps are taken.

use carom::prelude::*;

/// A store of about a thousand that two settings fill a little, in one of several ways a step: the
/// level after it is a product of the way's binary and an affine function, written as four rows.
fn store(steps: usize) -> Model {
    let ways = [
        [0.999_578_729_729, -4.844_533_01e-5, 0.006_474_839_81],
        [0.999_763_821_216, -3.148_459_2e-5, 0.003_519_707_72],
        [0.999_444_291_364, 1.350_793_77e-5, 0.008_642_741_9],
    ];
    let mut model = Model::new("store");
    let mut level = model.continuous("level0", 900.0, 1101.0).unwrap();
    model.add("start", level.equals(1000.0)).unwrap();
    let mut cost = Quadratic::zero();
    for t in 0..steps {
        let heat = model.continuous(format!("heat{t}"), 278.0, 298.0).unwrap();
        let flow = model.continuous(format!("flow{t}"), 30.0, 95.0).unwrap();
        let swing = (t as f64).sin();
        cost += 5.0 * (heat - 284.0 - 8.0 * swing).square();
        cost += 5.0 * (flow - 62.0 - 20.0 * swing).square();
        let (mut one, mut sum) = (Affine::default(), Affine::default());
        for (k, [a, b, c]) in ways.into_iter().enumerate() {
            let on = model.binary(format!("on{t}_{k}")).unwrap();
            let part = model.continuous(format!("part{t}_{k}"), 0.0, 1200.0).unwrap();
            let next = a * level + b * heat + c * flow;
            let (least, most) = (899.4, 1102.0);
            let rows = [
                (part - least * on).ge(0.0),
                (part - most * on).le(0.0),
                (next.clone() - part + most * on).le(most),
                (next - part + least * on).ge(least),
                // Settings that the way allows.
                (heat - 5.0 * k as f64 - 40.0 * on).ge(278.0 - 40.0),
                (flow + 20.0 * k as f64 + 80.0 * on).le(95.0 + 80.0),
            ];
            for (i, row) in rows.into_iter().enumerate() {
                model.add(format!("row{t}_{k}_{i}"), row).unwrap();
            }
            one += on;
            sum += part;
        }
        model.add(format!("one{t}"), one.equals(1.0)).unwrap();
        level = model.continuous(format!("level{}", t + 1), 900.0, 1101.0).unwrap();
        model.add(format!("level_of{t}"), (sum - level).equals(0.0)).unwrap();
    }
    cost += 80.0 * (level - 1003.0).square();
    model.minimize(cost).unwrap();
    model
}

#[test]
fn the_first_method_solves_most_of_them() {
    let solution = BranchAndBound::new(Options::default()).solve(&store(6)).unwrap();
    let counts = solution.statistics().relaxation_counts;
    assert_eq!(solution.termination(), Termination::Optimal);
    // From the middle of the box, the last method solves more than the first one.
    assert!(2 * counts.clarabel <= counts.interior_point, "{counts:?}");
    let value = solution.objective().unwrap();
    assert!((value - 816.211_409).abs() <= 1e-3, "{value}");
}
