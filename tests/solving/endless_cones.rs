//! Quadratic rows that leave a direction in which the objective falls without end.

use crate::common::config;
use carom::model::{Affine, lp};
use carom::prelude::*;
use carom::solver::RelaxationMethod;
use proptest::prelude::*;

const REGRESSIONS: &str = "tests/regressions/endless_cones.txt";

/// The usual way and those in which the root is another program, or is solved by another method.
fn ways() -> [Options; 4] {
    let clarabel = RelaxationMethod::Clarabel;
    [
        Options::default(),
        Options::default().with_presolve(false),
        Options::default().with_relaxation(clarabel),
        Options::default().with_presolve(false).with_relaxation(clarabel),
    ]
}

/// How a solve of a file ends in each way, within so many nodes.
fn endings(text: &str) -> Vec<Termination> {
    let model = lp::read(text).expect("a readable file").model;
    let ending = |mut options: Options| {
        options.node_limit = Some(2000);
        BranchAndBound::new(options).solve(&model).expect("a solvable model").termination()
    };
    ways().into_iter().map(ending).collect()
}

#[test]
fn a_row_beside_a_free_direction() {
    // `z` falls beside the parabola `2 z + x^2 + y^2 <= 77`.
    let parabola = "Minimize\n obj: z\nSubject To\n q: 2 z + [ x ^2 + y ^2 ] <= 77\n\
                    Bounds\n x free\n 0 <= y\n z free\n";
    // `w` grows with `v`, which the row does not name.
    let strip = "Minimize\n obj: - 6 p + q - 9 w\nSubject To\n a: p = 4.88\n\
                 b: - 2.89 p + 9 q + 4.37 v + 6 u - w = 25.7\n c: - 2 p + 2 q + [ u ^2 ] <= 59.85\n\
                 Bounds\n u free\n p free\n 0 <= q <= 3\n -2.5 <= w\n";
    // The maximum is `x = 31`, and `z` falls along the edge of the row.
    let between = "Maximize\n obj: - 761.9 s + 2 x + 7 t - 89.75 z\nSubject To\n a: t - 35910 s <= -107711\n\
                   q: 2 z - 2 t + [ x ^2 + 2 y ^2 + s ^2 ] <= 77.49\n\
                   Bounds\n 3 <= s <= 5\n x free\n -8 <= t\n z free\n";
    for (text, integers) in [(parabola, "y"), (strip, "v q"), (between, "s t y")] {
        for text in [format!("{text}End\n"), format!("{text}General\n {integers}\nEnd\n")] {
            let endings = endings(&text);
            assert!(endings.iter().all(|&e| e == Termination::Unbounded), "{endings:?}\n{text}");
        }
    }
}

/// Along no line, but along a parabola: what grows with its square costs nothing.
#[test]
fn a_fall_along_a_parabola() {
    let plain = "Maximize\n obj: 3 x\nSubject To\n r: - y + [ x ^2 ] <= 110\n\
                 Bounds\n x free\n y free\n";
    // Two parabolas, a row along which both grow, and a bound on one side.
    let both = "Minimize\n obj: 2 x - z\nSubject To\n r: - y + [ x ^2 ] <= 5\n\
                s: - 2 w + x + [ z ^2 + 2 z * x + x ^2 ] <= 9\n t: y - w <= 4\n\
                Bounds\n x free\n z free\n 1 <= y\n w free\n";
    for (text, integers) in [(plain, "y"), (plain, "x y"), (both, "y w")] {
        for text in [format!("{text}End\n"), format!("{text}General\n {integers}\nEnd\n")] {
            let endings = endings(&text);
            assert!(endings.iter().all(|&e| e == Termination::Unbounded), "{endings:?}\n{text}");
        }
    }
    // With a bound of what grows, or a price, there is an optimum.
    let bounded = plain.replace("y free", "y <= 90");
    let priced = plain.replace("3 x", "3 x - 0.25 y");
    for (text, value) in [(bounded, 3.0 * 200.0_f64.sqrt()), (priced, 9.0 + 27.5)] {
        let model = lp::read(&format!("{text}End\n")).expect("a readable file").model;
        let solution = BranchAndBound::default().solve(&model).expect("a solvable model");
        assert_eq!(solution.termination(), Termination::Optimal);
        assert!((solution.objective().expect("a point") - value).abs() < 1e-4);
    }
}

/// An integer that nothing holds was once set to 1.6e13 by a heuristic, and that was called
/// optimal.
#[test]
fn an_integer_far_out_is_no_optimum() {
    let text = "Minimize\n obj: - 2.2 z + [ 0.5 x ^2 ] / 2\nSubject To\n a: x + 7 u <= 1.75\n\
                b: 6 u + 4.6 z >= -28.8\n q: - 0.3 v + [ 2 w ^2 ] <= 85.6\n\
                Bounds\n z free\n -100 <= v <= -95\nGeneral\n z\nEnd\n";
    let endings = endings(text);
    assert!(endings.iter().all(|&e| e == Termination::Unbounded), "{endings:?}");
}

/// A number and its sign, as LP files want them.
fn term(value: i32, name: &str) -> String {
    let sign = if value < 0 { '-' } else { '+' };
    format!(" {sign} {} {name}", value.abs())
}

fn sum(coefficients: &[i32]) -> String {
    let columns = coefficients.iter().enumerate().filter(|(_, value)| **value != 0);
    columns.map(|(j, &value)| term(value, &format!("x{j}"))).collect()
}

fn dot(a: &[i32], b: &[i32]) -> i32 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// The sum of the squares of affine forms as the terms of a row.
fn squares(forms: &[Vec<i32>]) -> String {
    let n = forms.first().map_or(0, Vec::len);
    let mut terms = String::new();
    for i in 0..n {
        for j in i..n {
            let twice = if i == j { 1 } else { 2 };
            let value: i32 = forms.iter().map(|form| twice * form[i] * form[j]).sum();
            let name = if i == j { format!("x{i} ^2") } else { format!("x{i} * x{j}") };
            if value != 0 {
                terms += &term(value, &name);
            }
        }
    }
    terms
}

/// Along `x`, the cost falls as much as the norm grows, so that it nears its infimum and does not
/// fall for ever. (Case 7771630 of `torture`, family `cones-moved`.)
#[test]
fn a_direction_that_costs_nothing_is_no_fall() {
    for (slope, price) in [(1.0 / 8192.0, 1024.0), (1.0 / 1024.0, 4096.0), (0.25, 8.0), (1.0, 1.0)]
    {
        let mut model = Model::new("level");
        let x = model.continuous("x", f64::NEG_INFINITY, f64::INFINITY).unwrap();
        let length = model.continuous("length", 0.0, f64::INFINITY).unwrap();
        model.add("cone", norm([slope * x + 0.003, Affine::constant(0.001)]).le(length)).unwrap();
        model.minimize(price * length - price * slope * x).unwrap();
        let solution = BranchAndBound::default().solve(&model).unwrap();
        assert_ne!(solution.termination(), Termination::Unbounded, "{slope} {price}");
        // The infimum, which no point has.
        assert!(solution.bound() <= 0.003 * price + 1e-6, "{slope} {price}");
    }
}

proptest! {
    #![proptest_config(config(40, REGRESSIONS))]

    /// A direction is drawn first; squares do not change along it, sums do not grow. The same with
    /// a limit of the objective has an optimum.
    #[test]
    fn falls_are_found(
        direction in prop::collection::vec(-2..=2_i32, 4),
        rows in prop::collection::vec((prop::collection::vec(-3..=3_i32, 12), 1..=60_i32), 1..=2),
        costs in prop::collection::vec(-3..=3_i32, 4),
        integers in prop::collection::vec(any::<bool>(), 4),
        is_limited in any::<bool>(),
    ) {
        let down = |form: &[i32]| -> Vec<i32> {
            let sign = if dot(form, &direction) > 0 { -1 } else { 1 };
            form.iter().map(|value| sign * value).collect()
        };
        let costs = down(&costs);
        prop_assume!(dot(&costs, &direction) < 0);
        let mut text = format!("Minimize\n obj:{}\nSubject To\n", sum(&costs));
        for (k, (numbers, limit)) in rows.iter().enumerate() {
            let across = |form: &[i32]| -> Vec<i32> {
                let (length, along) = (dot(&direction, &direction), dot(form, &direction));
                form.iter().zip(&direction).map(|(a, d)| length * a - along * d).collect()
            };
            let forms = [across(&numbers[..4]), across(&numbers[4..8])];
            let (linear, curved) = (sum(&down(&numbers[8..])), squares(&forms));
            prop_assume!(!linear.is_empty() && !curved.is_empty());
            text += &format!(" q{k}:{linear} + [{curved} ] <= {limit}\n");
        }
        if is_limited {
            text += &format!(" limit:{} >= -50\n", sum(&costs));
        }
        text += "Bounds\n";
        for (j, d) in direction.iter().enumerate() {
            text += &match d.signum() {
                0 => format!(" -9 <= x{j} <= 9\n"),
                1 => format!(" -4 <= x{j}\n"),
                _ => format!(" -inf <= x{j} <= 4\n"),
            };
        }
        let names = (0..4).filter(|&j| integers[j]).map(|j| format!(" x{j}")).collect::<String>();
        if !names.is_empty() {
            text += &format!("General\n{names}\n");
        }
        text += "End\n";
        let endings = endings(&text);
        let is_right = |&ending: &Termination| match ending {
            Termination::Unbounded => !is_limited,
            Termination::Optimal => is_limited,
            _ => is_limited && ending.is_limit(),
        };
        prop_assert!(endings.iter().all(is_right), "{:?}\n{}", endings, text);
    }
}
