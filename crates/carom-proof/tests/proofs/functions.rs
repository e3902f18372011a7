//! Rows and bounds of functions: accepted where dense samples leave room, rejected where a sample
//! contradicts them.

use crate::log::verdict;

/// What the checker says of steps that are valid, but prove nothing.
const VALID: &str = "rejected: the claim is not proved: context 0 is not closed";
const NOT_BELOW: &str = "rejected: the function is not proved to be on that side of the line";

/// A log of one function of a column x between bounds, whose value is the column y.
fn log(function: &str, [lower, upper]: [f64; 2], values: [f64; 2], steps: &[String]) -> String {
    let [least, most] = values;
    format!(
        "carom proof 1\nsense min\ncolumns 2\nc c {lower} {upper} x\nc c {least} {most} y\nrows 0\n\
         cones 0\nterms 1\nf 1 {function} 0\nobjective 0\ng 0\nh 0\nclaim infeasible\nproof\n{}\n\
         end {}\n",
        steps.join("\n"),
        steps.len()
    )
}

const WIDE: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];

fn said(function: &str, x: [f64; 2], values: [f64; 2], step: &str) -> String {
    verdict(&log(function, x, values, &[step.to_string()]))
}

type Sampled = (&'static str, fn(f64) -> f64, &'static [[f64; 2]]);

/// Ranges with ends of domains, inflections, and of very different widths.
fn functions() -> Vec<Sampled> {
    const ANGLES: &[[f64; 2]] = &[
        [0.0, 0.5],
        [-0.3, 2.0],
        [-7.0, 11.0],
        [3.1, 3.2],
        [100.0, 101.0],
        [1.0, 1.0 + 1e-9],
        [-1.0, 400.0],
        [2.0, 2.0],
    ];
    const STEEP: &[[f64; 2]] = &[[-1.5, 1.5], [0.0, 1.0], [-1.0, 0.0], [1.8, 4.5], [0.1, 0.1001]];
    const UNIT: &[[f64; 2]] = &[[-1.0, 1.0], [0.0, 1.0], [-1.0, -0.5], [0.2, 0.2001], [-2.0, 0.9]];
    const ANY: &[[f64; 2]] =
        &[[-3.0, 4.0], [0.0, 1.0], [-1.0, 0.0], [-30.0, 20.0], [0.5, 0.5001], [-1e-6, 1e-6]];
    const POSITIVE: &[[f64; 2]] = &[[0.5, 2.0], [1e-9, 1e-3], [1.0, 1e6], [3.0, 3.0000001]];
    const FROM_ZERO: &[[f64; 2]] = &[[0.0, 2.0], [0.0, 1e-6], [1.0, 1e6], [-1.0, 4.0]];
    vec![
        ("sin", f64::sin, ANGLES),
        ("cos", f64::cos, ANGLES),
        ("tan", f64::tan, STEEP),
        ("asin", f64::asin, UNIT),
        ("acos", f64::acos, UNIT),
        ("atan", f64::atan, ANY),
        ("sinh", f64::sinh, ANY),
        ("cosh", f64::cosh, ANY),
        ("tanh", f64::tanh, ANY),
        ("exp", f64::exp, ANY),
        ("ln", f64::ln, POSITIVE),
        ("power 2", |x| x * x, ANY),
        ("power 3", |x| x * x * x, ANY),
        ("power 4", |x| x.powi(4), ANY),
        ("power 0.5", f64::sqrt, FROM_ZERO),
        ("power 1.7", |x| x.powf(1.7), FROM_ZERO),
        ("power -1", |x| 1.0 / x, POSITIVE),
        ("power -2.5", |x| x.powf(-2.5), POSITIVE),
        ("power -2", |x| 1.0 / (x * x), &[[-4.0, -0.5], [0.25, 8.0]]),
    ]
}

#[test]
fn lines_that_leave_room_are_accepted_and_lines_that_cut_are_not() {
    for (name, function, ranges) in functions() {
        for &[lower, upper] in ranges {
            let sample = |k: i32| lower + (upper - lower) * f64::from(k) / 4000.0;
            let points: Vec<(f64, f64)> = (0..=4000)
                .map(|k| sample(k).min(upper))
                .map(|x| if name.starts_with("as") || name == "acos" { x.max(-1.0) } else { x })
                .map(|x| (x, function(x)))
                .filter(|(_, y)| y.is_finite())
                .collect();
            let size = points.iter().fold(0.0_f64, |most, (_, y)| most.max(y.abs()));
            let middle = points[points.len() / 2].0;
            let step = 1e-6 * middle.abs().max(1e-3);
            let chord = (points[points.len() - 1].1 - points[0].1) / (upper - lower).max(1e-300);
            let tangent = (function(middle + step) - function(middle - step)) / (2.0 * step);
            for slope in [0.0, chord, tangent, -tangent, 0.3] {
                let slope = if slope.is_finite() { slope } else { 0.0 };
                let off = |&(x, y): &(f64, f64)| y - slope * x;
                let least = points.iter().map(off).fold(f64::INFINITY, f64::min);
                let most = points.iter().map(off).fold(f64::NEG_INFINITY, f64::max);
                let reach = slope.abs() * lower.abs().max(upper.abs());
                let (spare, cut) = (3e-3 * (size + reach), 1e-9 * (size + reach) + 1e-12);
                let [x, all] = [[lower, upper], WIDE];
                let text = |side: char, value: f64| format!("n 0 {side} {value:e} {slope:e}");
                for (step, expected) in [
                    (text('L', least - spare), VALID),
                    (text('U', most + spare), VALID),
                    (text('L', least + cut), NOT_BELOW),
                    (text('U', most - cut), NOT_BELOW),
                ] {
                    assert_eq!(said(name, x, all, &step), expected, "{name} {x:?} {step}");
                }
            }
        }
    }
}

/// Lines that touch: exactly, or but for what a writer loosens.
#[test]
fn lines_that_touch_are_accepted_up_to_rounding() {
    let e = std::f64::consts::E;
    for (name, x, step) in [
        ("exp", [-2.0, 3.0], format!("n 0 L {} {e}", -1e-12)),
        ("exp", [0.0, 1.0], format!("n 0 U {} {}", 1.0 + 1e-12, e - 1.0)),
        ("power 2", [-1.0, 3.0], "n 0 L -1.0000000000001 2".to_string()),
        ("power 2", [-1.0, 3.0], "n 0 U 3.0000000000001 2".to_string()),
        ("power 2", [-1.0, 3.0], "n 0 L 0 0".to_string()),
        ("sin", [0.0, 9.0], "n 0 U 1 0".to_string()),
        ("sin", [0.0, 1.0], format!("n 0 U {} 1", 1e-13)),
        ("sin", [-1.0, 0.0], format!("n 0 L {} 1", -1e-13)),
        ("cosh", [-4.0, 4.0], "n 0 L 1 0".to_string()),
        ("atan", [0.0, f64::INFINITY], "n 0 U 1.5707963267949 0".to_string()),
        ("exp", [f64::NEG_INFINITY, 0.0], "n 0 L 0 0".to_string()),
        ("exp", [0.0, f64::INFINITY], format!("n 0 L {} 0.999", 1.0 - 1e-12)),
        ("ln", [1.0, f64::INFINITY], "n 0 L -1e-14 0".to_string()),
        ("power -1", [0.0, 1.0], "n 0 L 0.999999999999 0".to_string()),
        ("power -1", [-1.0, 0.0], "n 0 U -0.999999999999 0".to_string()),
        ("power -2", [-1.0, 0.0], "n 0 L 0.999999999999 0".to_string()),
        ("ln", [1.0, f64::INFINITY], "n 0 U -1.000999999999 1.001".to_string()),
        ("power 0.5", [0.0, 4.0], "n 0 U 0.250000000001 1".to_string()),
    ] {
        assert_eq!(said(name, x, WIDE, &step), VALID, "{name} {x:?} {step}");
    }
}

#[test]
fn lines_over_ranges_without_an_end_or_with_a_pole_are_rejected() {
    for (name, x, step) in [
        ("exp", WIDE, "n 0 U 1e300 0"),
        ("exp", [0.0, f64::INFINITY], "n 0 L 0.5 1.01"),
        ("ln", [0.0, 1.0], "n 0 L -1e300 0"),
        ("tan", [1.0, 2.0], "n 0 L -1e300 0"),
        ("power -1", [-1.0, 1.0], "n 0 L -1e300 0"),
        ("power -1", [0.0, 1.0], "n 0 U 1e300 0"),
        ("power -1", [-1.0, 0.0], "n 0 L -2 0"),
        ("power -3", [-1.0, -0.0], "n 0 L -1e300 1"),
        ("power 3", WIDE, "n 0 L -1e300 0"),
        ("sin", [0.0, f64::INFINITY], "n 0 L -2 0.1"),
        ("atan", [-1e305, -1e304], "n 0 L -1.5 0"),
        ("atan", [-1e305, -1e304], "n 0 U -1.6 1e-305"),
        ("power 3", [-1e305, -1e304], "n 0 L -1e300 0"),
        ("tanh", [-1e305, 1e305], "n 0 L -0.9 0"),
    ] {
        assert_eq!(said(name, x, WIDE, step), NOT_BELOW, "{name} {x:?} {step}");
    }
}

#[test]
fn bounds_through_functions() {
    let not = |column: &str, value: &str| {
        format!("rejected: the function does not bound column {column} by {value}")
    };
    for (name, x, y, good, bad, column, value) in [
        ("exp", [-9.0, 9.0], [0.0, 1.0], "y 0 1 U 1e-9", "y 0 1 U -1e-9", "0 (x)", "-1e-9"),
        ("exp", [-1.0, 1.0], WIDE, "y 0 0 U 2.71828182846", "y 0 0 U 2.718281828", "1 (y)", {
            "2.718281828"
        }),
        ("power 2", [-9.0, 9.0], [0.0, 4.0], "y 0 1 L -2.000000001", "y 0 1 L -2", "0 (x)", "-2"),
        ("sin", [0.0, 3.0], [0.9, 1.0], "y 0 1 U 2.1", "y 0 1 U 2.0", "0 (x)", "2"),
        ("ln", [-9.0, 9.0], WIDE, "y 0 1 L 0", "y 0 1 L 1e-300", "0 (x)", "1e-300"),
        ("power 0.5", [-9.0, 9.0], [2.0, 5.0], "y 0 1 L 3.99999", "y 0 1 L 4", "0 (x)", "4"),
    ] {
        assert_eq!(said(name, x, y, good), VALID, "{name} {good}");
        assert_eq!(said(name, x, y, bad), not(column, value), "{name} {bad}");
    }
    // A column that takes whole numbers is beyond a bound from the next one on.
    let whole = log("exp", [-9.0, 9.0], [0.0, 7.0], &["y 0 1 U 1".to_string()]);
    assert_eq!(verdict(&whole), not("0 (x)", "1"));
    let whole = whole.replace("c c -9 9 x", "c i -9 9 x");
    assert_eq!(verdict(&whole), VALID);
    assert_eq!(verdict(&whole.replace("0 7 y", "0 7.4 y")), not("0 (x)", "1"));
    // The next value is at the end of the domain, and has a value.
    let end = log("acos", [-1.0, 1.0], [0.0, 9.0], &["y 0 1 U 0".to_string()]);
    assert_eq!(verdict(&end.replace("c c -1 1 x", "c i -1 1 x")), not("0 (x)", "0"));
}

/// A log about z = x y, or z = x / y.
fn binary(of: &str, bounds: [&str; 3], step: &str) -> String {
    let [x, y, z] = bounds;
    verdict(&format!(
        "carom proof 1\nsense min\ncolumns 3\nc c {x} x\nc c {y} y\nc c {z} z\nrows 0\ncones 0\n\
         terms 1\nf 2 {of} 0 1\nobjective 0\ng 0\nh 0\nclaim infeasible\nproof\n{step}\nend 1\n"
    ))
}

#[test]
fn products_and_quotients() {
    const OTHER_SIDE: &str = "rejected: the product is on the other side within the bounds";
    let product = |bounds, step| binary("product", bounds, step);
    let all = "-inf inf";
    let boxed = ["-1 2", "3 5", all];
    // (x + 1)(y - 3) >= 0 and its three relatives, and nothing beyond them.
    for (good, bad) in [
        ("n 0 L 3 3 -1", "n 0 L 3.0000000000000004 3 -1"),
        ("n 0 L -10 5 2", "n 0 L -9.999999999999998 5 2"),
        ("n 0 U -6 3 2", "n 0 U -6.000000000000001 3 2"),
        ("n 0 U 5 5 -1", "n 0 U 4.999999999999999 5 -1"),
        ("n 0 L -5 0 0", "n 0 L -4.999999999999999 0 0"),
        ("n 0 U 10 0 0", "n 0 U 9.999999999999998 0 0"),
    ] {
        assert_eq!(product(boxed, good), VALID, "{good}");
        assert_eq!(product(boxed, bad), OTHER_SIDE, "{bad}");
    }
    // Without ends: x >= 1 and y >= 2.
    let open = ["1 inf", "2 inf", all];
    assert_eq!(product(open, "n 0 L -2 2 1"), VALID);
    for bad in ["n 0 L -1.9 2 1", "n 0 L -2 2.1 1", "n 0 U 1e300 2 1", "n 0 L -2 0 3"] {
        assert_eq!(product(open, bad), OTHER_SIDE, "{bad}");
    }
    assert_eq!(product([all, "0 1", all], "n 0 L -1e300 0 0"), OTHER_SIDE);
    // Factors and products.
    let not = |name: &str, value: &str| {
        format!("rejected: the function does not bound column {name} by {value}")
    };
    let z = ["0 inf", "2 4", "-8 8"];
    assert_eq!(product(z, "y 0 1 U 4"), VALID);
    assert_eq!(product(z, "y 0 1 U 3.9999"), not("0 (x)", "3.9999"));
    assert_eq!(product(["0 inf", "0 4", "-8 0"], "y 0 1 U 0"), not("0 (x)", "0"));
    assert_eq!(product(["0 inf", "-4 4", "-8 0"], "y 0 1 U 0"), not("0 (x)", "0"));
    assert_eq!(product(["0 3", "2 4", all], "y 0 0 U 12"), VALID);
    assert_eq!(product(["0 3", "2 4", all], "y 0 0 L 1"), not("2 (z)", "1"));
    // A divisor is not 0: z = x / y <= 3 / y.
    let quotient = |bounds, step| binary("quotient", bounds, step);
    assert_eq!(quotient(["0 3", "2 4", all], "y 0 0 U 1.5"), VALID);
    assert_eq!(quotient(["0 3", "2 4", all], "y 0 0 U 1.4"), not("2 (z)", "1.4"));
    assert_eq!(quotient(["-3 0", "0 4", all], "y 0 0 U 0"), VALID);
    assert_eq!(quotient(["-3 0", "-1 4", all], "y 0 0 U 0"), not("2 (z)", "0"));
    assert_eq!(quotient([all, "2 4", "1 2"], "y 0 1 U 8"), VALID);
    assert_eq!(quotient(["0 3", "0.1 9", "1 2"], "y 0 2 U 3"), VALID);
    assert_eq!(quotient(["0 3", "0.1 9", "1 2"], "y 0 2 U 2.9"), not("1 (y)", "2.9"));
    // The numerator is the product of the quotient and the divisor.
    assert_eq!(quotient([all, "2 4", "1 2"], "n 0 L -2 2 1"), VALID);
    assert_eq!(quotient([all, "2 4", "1 2"], "n 0 L -1.9 2 1"), OTHER_SIDE);
}

#[test]
fn a_range_is_split_at_a_value() {
    // x² = 2 has no point with x between -1.4 and 1.4; the cases meet at 0.5.
    let steps = ["c 0 0.5", "y 0 0 U 1.9600000001", "d 1", "y 0 0 U 1.9600000001", "d 1"];
    let steps = steps.map(String::from);
    let whole = log("power 2", [-1.4, 1.4], [2.0, 2.0], &steps);
    assert_eq!(verdict(&whole), "proved: no point (5 steps)");
    assert_eq!(verdict(&whole.replace("-1.4 1.4", "-1.5 1.4")), {
        "rejected: the function does not bound column 1 (y) by 1.9600000001"
    });
    let half = log("power 2", [-1.4, 1.4], [2.0, 2.0], &steps[..3]);
    assert_eq!(verdict(&half), { "rejected: the claim is not proved: context 1 is not closed" });
}

#[test]
fn functions_of_ones_own_are_assumed_and_counted() {
    let steps = ["n 0 L 3 1", "y 0 0 U 2", "n 0 L 4 -1", "d 1"].map(String::from);
    let own = log("own", [0.0, 1.0], [3.0, 4.0], &steps).replace("own 0", "own 0 my drag");
    assert_eq!(verdict(&own), "proved under 3 assumed enclosures of my drag: no point (4 steps)");
}

#[test]
fn columns_of_functions_do_not_move() {
    // y would be rounded up if it were free to.
    let log = log("exp", [0.0, 1.0], [0.0, 9.0], &["u 1 U".to_string()]);
    assert!(verdict(&log).starts_with("rejected: "), "{}", verdict(&log));
    assert!(!verdict(&log).contains("claim is not proved"), "{}", verdict(&log));
}

#[test]
fn points_are_judged_by_functions() {
    let judged = |point: &str| {
        let steps = [point.to_string(), "y 0 0 U 1.9600000001".to_string(), "d 1".to_string()];
        verdict(&log("power 2", [-1.4, 1.4], [2.0, 2.0], &steps))
    };
    assert_eq!(judged("a 2 0 1.4142 1 2"), {
        "rejected: the point misses a bound of column 0 (x) by 0.01419999999999999"
    });
    let text = judged("a 2 0 1.4 1 2");
    assert!(
        text.starts_with("rejected: the point misses the function of term 0 by 0.04"),
        "{text}"
    );
}

#[test]
fn terms_that_cannot_be_read() {
    let good = log("sin", [0.0, 1.0], WIDE, &["n 0 U 1 0".to_string()]);
    assert_eq!(verdict(&good), VALID);
    for (from, to, reason) in [
        ("f 1 sin 0", "f 1 sine 0", "unreadable: there is no function `sine`"),
        ("f 1 sin 0", "f 2 sin 0", "rejected: there is no column 2; their number is 2"),
        ("f 1 sin 0", "f 1 power 0", "unreadable: the line ends where the column must be"),
        ("terms 1", "terms 2", "unreadable: there is `objective` instead of `f`"),
        ("n 0 U 1 0", "n 1 U 1 0", "rejected: there is no term 1; their number is 1"),
        ("n 0 U 1 0", "n 0 U 1", "unreadable: the line ends where a slope must be"),
        ("n 0 U 1 0", "y 0 2 U 1", "rejected: there is no place in the term 2; their number is 2"),
    ] {
        assert_eq!(verdict(&good.replace(from, to)), reason, "`{from}` to `{to}`");
    }
}
