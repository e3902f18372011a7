//! Doubles as what they are: whole numbers times powers of two.

use std::ops::{Add, Mul, Neg};

/// `mantissa * 2^exponent`; sums and products are exact, and overflow panics.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Dyadic {
    mantissa: i128,
    exponent: i32,
}

impl Dyadic {
    pub(crate) const ZERO: Dyadic = Dyadic { mantissa: 0, exponent: 0 };

    /// A finite double.
    pub(crate) fn of(value: f64) -> Self {
        assert!(value.is_finite());
        let bits = value.to_bits();
        let field = (bits >> 52 & 0x7ff) as i32;
        let fraction = (bits & ((1 << 52) - 1)) as i128;
        let mantissa = if field == 0 { fraction } else { fraction | 1 << 52 };
        let signed = if value < 0.0 { -mantissa } else { mantissa };
        Dyadic { mantissa: signed, exponent: field.max(1) - 1075 }.reduced()
    }

    fn reduced(self) -> Self {
        if self.mantissa == 0 {
            return Dyadic::ZERO;
        }
        let zeros = self.mantissa.trailing_zeros();
        Dyadic { mantissa: self.mantissa >> zeros, exponent: self.exponent + zeros as i32 }
    }

    /// The numbers times the power of two that makes all of them whole, and its exponent.
    pub(crate) fn whole(numbers: &[Dyadic]) -> (Vec<i128>, i32) {
        let used = numbers.iter().filter(|number| number.mantissa != 0);
        let least = used.map(|number| number.exponent).min().unwrap_or(0);
        let shifted = numbers.iter().map(|number| number.shifted(least));
        (shifted.collect(), -least)
    }

    fn shifted(self, exponent: i32) -> i128 {
        if self.mantissa == 0 {
            return 0;
        }
        let factor = 1_i128.checked_shl((self.exponent - exponent) as u32).expect("a short range");
        self.mantissa.checked_mul(factor).expect("few digits")
    }

    pub(crate) fn sign(self) -> i128 {
        self.mantissa.signum()
    }
}

impl Add for Dyadic {
    type Output = Dyadic;
    fn add(self, other: Dyadic) -> Dyadic {
        if self.mantissa == 0 {
            return other;
        }
        if other.mantissa == 0 {
            return self;
        }
        let exponent = self.exponent.min(other.exponent);
        let sum = self.shifted(exponent).checked_add(other.shifted(exponent));
        Dyadic { mantissa: sum.expect("few digits"), exponent }.reduced()
    }
}

impl Mul for Dyadic {
    type Output = Dyadic;
    fn mul(self, other: Dyadic) -> Dyadic {
        let mantissa = self.mantissa.checked_mul(other.mantissa).expect("few digits");
        Dyadic { mantissa, exponent: self.exponent + other.exponent }.reduced()
    }
}

impl Neg for Dyadic {
    type Output = Dyadic;
    fn neg(self) -> Dyadic {
        Dyadic { mantissa: -self.mantissa, ..self }
    }
}

#[test]
fn sums_and_products_are_exact() {
    let (tenth, three) = (Dyadic::of(0.1), Dyadic::of(3.0));
    // 0.1 * 3 is no double; the product of the two doubles is a little more than 0.3.
    let excess = tenth * three + -Dyadic::of(0.3);
    assert!(excess.sign() == 1);
    assert_eq!(Dyadic::of(-0.375), Dyadic { mantissa: -3, exponent: -3 });
    assert_eq!(Dyadic::whole(&[Dyadic::of(0.75), Dyadic::of(4.0)]), (vec![3, 16], 2));
}
