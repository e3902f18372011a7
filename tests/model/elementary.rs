//! Elementary functions: ranges, inverses, derivatives and lines, at random arguments. Values come
//! from Taylor sums of the test where functions have some, so that the standard library is checked
//! as well.

use carom::interval::Interval;
use carom::model::Elementary;
use proptest::prelude::*;

fn elementary() -> impl Strategy<Value = Elementary> {
    prop_oneof![
        Just(Elementary::Sin),
        Just(Elementary::Cos),
        Just(Elementary::Tan),
        Just(Elementary::Asin),
        Just(Elementary::Acos),
        Just(Elementary::Atan),
        Just(Elementary::Sinh),
        Just(Elementary::Cosh),
        Just(Elementary::Tanh),
        Just(Elementary::Exp),
        Just(Elementary::Ln),
        (-4..=5_i32).prop_map(|p| Elementary::Power(f64::from(p))),
        (-3.0..4.0_f64).prop_map(Elementary::Power),
    ]
}

/// Ranges of all sizes: huge, tiny, around 0, at ends of domains.
fn range() -> impl Strategy<Value = Interval> {
    let size = prop_oneof![Just(1e-9), Just(1e-3), Just(1.0), Just(10.0), Just(300.0)];
    let center = prop_oneof![Just(0.0), -1.0..1.0_f64, -8.0..8.0_f64, -400.0..400.0_f64];
    (center, size, 0.0..1.0_f64)
        .prop_map(|(c, size, part)| Interval::new(c - part * size, c + (1.0 - part) * size))
}

fn samples(x: Interval) -> impl Iterator<Item = f64> {
    let inner = (0..=64).map(move |k| x.lower + f64::from(k) / 64.0 * (x.upper - x.lower));
    inner.chain([x.lower, x.upper]).map(move |v| v.max(x.lower).min(x.upper))
}

/// A value with twice the digits: the sum of a float and a small one.
fn precise(function: &Elementary, x: f64) -> Option<(f64, f64)> {
    // By Newton's method or a series from the value in floats, whose error it gives.
    let value = function.value(x);
    let miss = match function {
        Elementary::Power(2.0) => x.mul_add(x, -value),
        Elementary::Power(0.5) => -value.mul_add(value, -x) / (2.0 * value.max(f64::MIN_POSITIVE)),
        Elementary::Power(-1.0) => -value.mul_add(x, -1.0) / x,
        Elementary::Sin | Elementary::Cos if x.abs() <= 1.0 => {
            let first = if *function == Elementary::Sin { x } else { 1.0 };
            let from = if *function == Elementary::Sin { 1.0 } else { 0.0 };
            series(first, |k| {
                let k = 2.0 * f64::from(k) + from;
                -x * x / ((k + 1.0) * (k + 2.0))
            })
            .minus(value)
        }
        Elementary::Exp if x.abs() <= 1.0 => series(1.0, |k| x / (f64::from(k) + 1.0)).minus(value),
        _ => return None,
    };
    Some((value, miss))
}

/// A sum that is kept in two floats.
struct TwoFloats(f64, f64);

impl TwoFloats {
    fn add(&mut self, term: f64) {
        let sum = self.0 + term;
        let rest = sum - self.0;
        self.1 += (self.0 - (sum - rest)) + (term - rest);
        self.0 = sum;
    }

    fn minus(mut self, value: f64) -> f64 {
        self.add(-value);
        self.0 + self.1
    }
}

fn series(first: f64, ratio: impl Fn(i32) -> f64) -> TwoFloats {
    let (mut sum, mut term) = (TwoFloats(0.0, 0.0), first);
    for k in 0..30 {
        sum.add(term);
        term *= ratio(k);
    }
    sum
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, ..ProptestConfig::default() })]

    #[test]
    fn ranges_contain_values(function in elementary(), x in range()) {
        let values = function.range(x);
        for at in samples(x).filter(|at| function.domain().contains(*at)) {
            let value = function.value(at);
            prop_assert!(value.is_nan() || values.contains(value), "{function} at {at}: {value} is not in {values:?}");
            if let Some((value, miss)) = precise(&function, at) {
                let exact = |limit: f64| (value - limit) + miss;
                prop_assert!(exact(values.lower) >= 0.0 && exact(values.upper) <= 0.0);
            }
        }
    }

    #[test]
    fn inverses_lose_no_argument(function in elementary(), x in range(), a in 0.0..1.0_f64, b in 0.0..1.0_f64) {
        let values = function.range(x);
        if !values.is_bounded() || values.lower > values.upper {
            return Ok(());
        }
        let part = |a: f64| values.lower + a * (values.upper - values.lower);
        let wanted = Interval::new(part(a.min(b)), part(a.max(b)));
        let found = function.inverse(wanted, x);
        for at in samples(x).filter(|at| wanted.contains(function.value(*at))) {
            prop_assert!(found.contains(at), "{function} at {at} is not in {found:?}");
        }
    }

    #[test]
    fn lines_are_on_their_side(function in elementary(), x in range(), at in 0.0..1.0_f64, is_below: bool) {
        let at = x.lower + at * (x.upper - x.lower);
        let Some(line) = function.line(x, at, is_below) else { return Ok(()) };
        for place in samples(x).filter(|at| function.domain().contains(*at)) {
            let value = function.value(place);
            let linear = line.slope * place + line.offset;
            let rounding = 1e-15 * ((line.slope * place).abs() + line.offset.abs() + value.abs());
            let above = if is_below { value - linear } else { linear - value };
            prop_assert!(above.is_nan() || above >= -4.0 * rounding - 1e-300, "{function} at {place}: {value} and {linear}");
        }
    }

    #[test]
    fn lines_are_tight_where_ranges_are_narrow(
        function in elementary(), c in 0.2..0.8_f64, width in 1e-4..1e-2_f64, is_below: bool
    ) {
        // A line is off by at most the curvature times the square of the width.
        let x = Interval::new(c - width, c + width);
        let line = function.line(x, c, is_below).unwrap();
        let curvature = samples(x).map(|at| function.second_derivative(at).abs());
        let most = curvature.fold(0.0, f64::max);
        let off = (line.slope * c + line.offset - function.value(c)).abs();
        prop_assert!(off <= 0.6 * most * width * width + 1e-12, "{function}: {off}");
    }

    #[test]
    fn derivatives_are_limits_of_quotients(function in elementary(), x in 0.1..0.9_f64) {
        let step = 1e-6;
        let quotient = (function.value(x + step) - function.value(x - step)) / (2.0 * step);
        prop_assert!((quotient - function.derivative(x)).abs() <= 1e-3 * quotient.abs().max(1.0));
        let second = (function.derivative(x + step) - function.derivative(x - step)) / (2.0 * step);
        prop_assert!((second - function.second_derivative(x)).abs() <= 1e-3 * second.abs().max(1.0));
    }
}
