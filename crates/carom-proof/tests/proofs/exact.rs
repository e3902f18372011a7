//! Sums of products against plain big integers.

use carom_proof::exact::{Dyadic, Sum};
use num_bigint::BigInt;
use proptest::prelude::*;

/// `value * 2^1074`, which is whole.
fn scaled(value: f64) -> BigInt {
    let (mut value, mut shift) = (value, 0_u32);
    while value.abs() >= 1e18 {
        value /= 2.0;
        shift += 1;
    }
    // Below, multiplications by 2 are exact.
    let mut steps = 1074;
    while steps > 0 && value.fract() != 0.0 {
        value *= 2.0;
        steps -= 1;
    }
    BigInt::from(value as i128) << (shift + steps)
}

fn float() -> impl Strategy<Value = f64> {
    prop_oneof![
        any::<u64>().prop_map(f64::from_bits).prop_filter("finite", |value| value.is_finite()),
        (-1000_i32..1000).prop_map(f64::from),
        (-1e3_f64..1e3),
        Just(0.1),
        Just(5e-324),
        Just(f64::MAX),
    ]
}

proptest! {
    #[test]
    fn a_sum_is_exact(terms in prop::collection::vec((float(), float(), any::<bool>()), 0..40)) {
        let (mut sum, mut expected) = (Sum::default(), BigInt::ZERO);
        for &(a, b, negated) in &terms {
            let product = scaled(a) * scaled(b);
            if negated {
                sum.subtract(a, b);
                expected -= product;
            } else {
                sum.add(a, b);
                expected += product;
            }
        }
        let value = sum.take().expect("products of floats are in range");
        prop_assert_eq!(value.sign(), expected.cmp(&BigInt::ZERO));
        // The same once more, as the difference from what was found, which must be 0.
        for &(a, b, negated) in &terms {
            if negated { sum.subtract(a, b) } else { sum.add(a, b) }
        }
        sum.subtract(&value, 1.0);
        prop_assert_eq!(sum.take_sign(), Ok(std::cmp::Ordering::Equal));
        // A float, if it is one; and the nearest one.
        if let Some(float) = value.as_float() {
            prop_assert_eq!(scaled(float) << 1074, expected);
        } else if value.nearest().is_finite() {
            let error: BigInt = (scaled(value.nearest()) << 1074) - &expected;
            let size = expected.magnitude().bits().max(53 + 1074) - 53;
            prop_assert!(error.magnitude().bits() <= size);
        }
    }

    #[test]
    fn a_product_of_sums_is_exact(numbers in prop::collection::vec(float(), 1..6)) {
        // (a + b + ...)² is the sum of all products.
        let mut sum = Sum::default();
        for &a in &numbers {
            sum.add(a, 1.0);
        }
        let value = sum.take().expect("floats are in range");
        for &a in &numbers {
            for &b in &numbers {
                sum.add(a, b);
            }
        }
        sum.subtract(&value, &value);
        prop_assert_eq!(sum.take_sign(), Ok(std::cmp::Ordering::Equal));
        let half = value.clone().half();
        sum.add(&half, 2.0);
        sum.add(&value.negated(), 1.0);
        prop_assert_eq!(sum.take_sign(), Ok(std::cmp::Ordering::Equal));
    }
}

#[test]
fn infinities_and_floods_fail() {
    let mut sum = Sum::default();
    sum.add(f64::INFINITY, 1.0);
    assert!(sum.take().is_err());
    sum.add(f64::NAN, 1.0);
    assert!(sum.take_sign().is_err());
    let mut value = Dyadic::from_f64(2.0);
    let mut squarings = 0;
    while {
        sum.add(&value, &value);
        let square = sum.take();
        value = square.clone().unwrap_or(value);
        square.is_ok()
    } {
        squarings += 1;
    }
    assert_eq!(squarings, 12);
    // It works again.
    sum.add(1.0, 1.0);
    assert!(sum.take().is_ok_and(|value| value.as_float() == Some(1.0)));
}
