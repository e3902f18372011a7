//! Exact arithmetic: numbers `mantissa * 2^exponent`, and sums of products of such numbers.
//!
//! A float is such a number, and so are sums and products of them. No rule divides, so nothing is
//! ever rounded. The limit on exponents is there so that no text can ask for gigabytes.

use num_bigint::{BigInt, BigUint, Sign};
use std::cmp::Ordering;
use std::fmt;

/// Numbers are multiples of `2^-LIMIT`, and less than `2^LIMIT` in magnitude.
const LIMIT: i32 = 8192;
/// Digits of a sum have 32 bits, and the first one stands for `2^-OFFSET`.
const OFFSET: i32 = 2 * LIMIT;
/// Room for products of two numbers, and for the carries of 2^64 of them.
const DIGITS: usize = (4 * LIMIT as usize) / 32 + 8;
/// How many products may be added before carries: each adds less than 2^33 to a digit.
const MOST_PENDING: u32 = 1 << 28;

/// The numbers of a step, or of the program, are too large or too fine for this checker.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct OutOfRange;

/// A number `mantissa * 2^exponent`.
#[derive(Debug, Clone)]
pub struct Dyadic {
    mantissa: BigInt,
    exponent: i32,
}

/// A factor of a product.
#[derive(Debug, Clone, Copy)]
pub enum Number<'a> {
    /// A float; an infinite one makes the sum fail.
    Float(f64),
    /// Any number.
    Exact(&'a Dyadic),
}

impl From<f64> for Number<'_> {
    fn from(value: f64) -> Self {
        Number::Float(value)
    }
}

impl<'a> From<&'a Dyadic> for Number<'a> {
    fn from(value: &'a Dyadic) -> Self {
        Number::Exact(value)
    }
}

impl Number<'_> {
    /// Its sign: `Less` for negative numbers.
    #[must_use]
    pub fn sign(self) -> Ordering {
        match self {
            Number::Float(value) => value.partial_cmp(&0.0).unwrap_or(Ordering::Equal),
            Number::Exact(value) => value.sign(),
        }
    }
}

impl Dyadic {
    /// Zero.
    #[must_use]
    pub fn zero() -> Self {
        Dyadic { mantissa: BigInt::ZERO, exponent: 0 }
    }

    /// The number that a float is; zero for infinities and NaN, which the reader of numbers keeps
    /// out.
    #[must_use]
    pub fn from_f64(value: f64) -> Self {
        let Some((negative, mantissa, exponent)) = parts(value) else { return Self::zero() };
        let mantissa = BigInt::from(mantissa);
        Dyadic { mantissa: if negative { -mantissa } else { mantissa }, exponent }
    }

    /// A whole number times `2^-scale`.
    pub(crate) fn scaled(mantissa: BigInt, scale: u64) -> Self {
        Dyadic { mantissa, exponent: -i32::try_from(scale).unwrap_or(i32::MAX) }
    }

    /// Its sign: `Less` for negative numbers.
    #[must_use]
    pub fn sign(&self) -> Ordering {
        match self.mantissa.sign() {
            Sign::Minus => Ordering::Less,
            Sign::NoSign => Ordering::Equal,
            Sign::Plus => Ordering::Greater,
        }
    }

    /// Whether it is 0.
    #[must_use]
    pub fn is_zero(&self) -> bool {
        self.sign() == Ordering::Equal
    }

    /// The same with the other sign.
    #[must_use]
    pub fn negated(&self) -> Self {
        Dyadic { mantissa: -&self.mantissa, exponent: self.exponent }
    }

    /// Half of it.
    #[must_use]
    pub fn half(mut self) -> Self {
        self.exponent -= 1;
        self
    }

    /// The float that it is, if it is one.
    #[must_use]
    pub fn as_float(&self) -> Option<f64> {
        let magnitude = self.mantissa.magnitude();
        let zeros = magnitude.trailing_zeros().unwrap_or(0);
        let exponent = i64::from(self.exponent) + i64::try_from(zeros).ok()?;
        let top = i64::from(self.exponent) + i64::try_from(magnitude.bits()).ok()?;
        (top - exponent <= 53 && exponent >= -1074 && top <= 1024).then(|| self.nearest())
    }

    /// The nearest float, for texts.
    #[must_use]
    pub fn nearest(&self) -> f64 {
        let magnitude = self.mantissa.magnitude();
        let excess = magnitude.bits().saturating_sub(64);
        let mut top = (magnitude >> excess).iter_u64_digits().next().unwrap_or(0);
        // What is cut off only decides a tie.
        if magnitude.trailing_zeros().is_some_and(|zeros| zeros < excess) {
            top |= 1;
        }
        let mut exponent = i64::from(self.exponent) + i64::try_from(excess).unwrap_or(i64::MAX);
        let mut value = if self.sign() == Ordering::Less { -(top as f64) } else { top as f64 };
        // In steps, because 2^exponent alone may be no float.
        while exponent != 0 && value != 0.0 && value.is_finite() {
            let step = exponent.clamp(-1000, 1000);
            value *= f64::from_bits(((1023 + step) as u64) << 52);
            exponent -= step;
        }
        value
    }
}

impl fmt::Display for Dyadic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        Plain(self.nearest()).fmt(f)
    }
}

/// A float in a text: with an exponent where it would be long without.
#[derive(Debug, Clone, Copy)]
pub struct Plain(pub f64);

impl fmt::Display for Plain {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Plain(value) = self;
        if value.is_finite() && *value != 0.0 && !(1e-5..1e16).contains(&value.abs()) {
            write!(f, "{value:e}")
        } else {
            write!(f, "{value}")
        }
    }
}

/// Sign, mantissa and exponent of a finite float.
fn parts(value: f64) -> Option<(bool, u64, i32)> {
    let bits = value.to_bits();
    let (biased, fraction) = ((bits >> 52) & 0x7ff, bits & ((1 << 52) - 1));
    let (mantissa, exponent) = match biased {
        0x7ff => return None,
        0 => (fraction, -1074),
        _ => (fraction | (1 << 52), biased as i32 - 1075),
    };
    Some((bits >> 63 == 1, mantissa, exponent))
}

/// A sum of products, kept as one long number in fixed point: adding a product touches a few
/// digits.
#[derive(Debug)]
pub struct Sum {
    digits: Vec<i64>,
    /// The digits that may be other than 0: the first one, and one behind the last.
    used: (usize, usize),
    pending: u32,
    failed: bool,
}

impl Default for Sum {
    fn default() -> Self {
        Sum { digits: vec![0; DIGITS], used: (DIGITS, 0), pending: 0, failed: false }
    }
}

impl Sum {
    /// Adds `a * b`.
    pub fn add<'a>(&mut self, a: impl Into<Number<'a>>, b: impl Into<Number<'a>>) {
        self.product(a.into(), b.into(), false);
    }

    /// Subtracts `a * b`.
    pub fn subtract<'a>(&mut self, a: impl Into<Number<'a>>, b: impl Into<Number<'a>>) {
        self.product(a.into(), b.into(), true);
    }

    fn product(&mut self, a: Number<'_>, b: Number<'_>, negated: bool) {
        match (a, b) {
            (Number::Float(a), Number::Float(b)) => {
                let (Some(a), Some(b)) = (parts(a), parts(b)) else {
                    self.failed = true;
                    return;
                };
                let negative = a.0 ^ b.0 ^ negated;
                self.add_at(u128::from(a.1) * u128::from(b.1), a.2 + b.2, negative);
            }
            (Number::Float(a), Number::Exact(b)) | (Number::Exact(b), Number::Float(a)) => {
                let Some((negative, digit, exponent)) = parts(a) else {
                    self.failed = true;
                    return;
                };
                let negative = negative ^ (b.sign() == Ordering::Less) ^ negated;
                self.add_multiple(digit, b, exponent, negative);
            }
            (Number::Exact(a), Number::Exact(b)) => {
                let negative =
                    (a.sign() == Ordering::Less) ^ (b.sign() == Ordering::Less) ^ negated;
                let mut exponent = a.exponent;
                for digit in a.mantissa.iter_u64_digits() {
                    self.add_multiple(digit, b, exponent, negative);
                    exponent += 64;
                }
            }
        }
    }

    /// Adds `digit * 2^exponent` times the magnitude of `number`.
    fn add_multiple(&mut self, digit: u64, number: &Dyadic, exponent: i32, negative: bool) {
        let mut exponent = exponent + number.exponent;
        for other in number.mantissa.iter_u64_digits() {
            self.add_at(u128::from(digit) * u128::from(other), exponent, negative);
            exponent += 64;
        }
    }

    /// Adds `magnitude * 2^exponent`, or subtracts it.
    fn add_at(&mut self, magnitude: u128, exponent: i32, negative: bool) {
        if magnitude == 0 {
            return;
        }
        let place = usize::try_from(exponent + OFFSET).unwrap_or(usize::MAX);
        let (first, shift) = (place / 32, place % 32);
        let Some(digits) =
            self.digits.get_mut(first..).and_then(|rest| rest.first_chunk_mut::<5>())
        else {
            self.failed = true;
            return;
        };
        let sign = if negative { -1 } else { 1 };
        let low = u128::from(magnitude as u64) << shift;
        let high = (magnitude >> 64) << shift;
        digits[0] += sign * i64::from(low as u32);
        digits[1] += sign * i64::from((low >> 32) as u32);
        digits[2] += sign * (i64::from((low >> 64) as u32) + i64::from(high as u32));
        digits[3] += sign * i64::from((high >> 32) as u32);
        digits[4] += sign * i64::from((high >> 64) as u32);
        self.used = (self.used.0.min(first), self.used.1.max(first + 5));
        self.pending += 1;
        if self.pending >= MOST_PENDING {
            self.carry();
        }
    }

    /// Brings all digits but the last one between 0 and 2^32; the last one has the sign of the sum,
    /// or is 0 if the sum is not negative.
    fn carry(&mut self) {
        self.pending = 0;
        if self.used.0 >= self.used.1 {
            return;
        }
        let mut carry = 0;
        for digit in self.digits.iter_mut().take(self.used.1).skip(self.used.0) {
            let sum = *digit + carry;
            *digit = sum & 0xffff_ffff;
            carry = sum >> 32;
        }
        match self.digits.get_mut(self.used.1) {
            Some(digit) => {
                *digit = carry;
                self.used.1 += 1;
            }
            None => self.failed = true,
        }
    }

    fn used_digits(&self) -> &[i64] {
        self.digits.get(self.used.0..self.used.1).unwrap_or_default()
    }

    /// The sign of the sum, which is 0 afterwards.
    pub fn take_sign(&mut self) -> Result<Ordering, OutOfRange> {
        self.carry();
        let digits = self.used_digits();
        let sign = match digits.last() {
            Some(&last) if last < 0 => Ordering::Less,
            _ if digits.iter().any(|&digit| digit != 0) => Ordering::Greater,
            _ => Ordering::Equal,
        };
        self.clear().map(|()| sign)
    }

    /// The sum, which is 0 afterwards.
    pub fn take(&mut self) -> Result<Dyadic, OutOfRange> {
        self.carry();
        let negative = self.used_digits().last().is_some_and(|&last| last < 0);
        if negative {
            for digit in self.digits.iter_mut().take(self.used.1).skip(self.used.0) {
                *digit = -*digit;
            }
            self.carry();
        }
        let digits = self.used_digits();
        let zeros = digits.iter().take_while(|&&digit| digit == 0).count();
        let digits: Vec<u32> = digits.iter().skip(zeros).map(|&digit| digit as u32).collect();
        let exponent = 32 * i32::try_from(self.used.0 + zeros).unwrap_or(i32::MAX / 32) - OFFSET;
        self.clear()?;
        let magnitude = BigUint::new(digits);
        if magnitude == BigUint::ZERO {
            return Ok(Dyadic::zero());
        }
        let top = i64::from(exponent) + i64::try_from(magnitude.bits()).unwrap_or(i64::MAX);
        if exponent < -LIMIT || top > i64::from(LIMIT) {
            return Err(OutOfRange);
        }
        let sign = if negative { Sign::Minus } else { Sign::Plus };
        Ok(Dyadic { mantissa: BigInt::from_biguint(sign, magnitude), exponent })
    }

    fn clear(&mut self) -> Result<(), OutOfRange> {
        for digit in self.digits.iter_mut().take(self.used.1).skip(self.used.0) {
            *digit = 0;
        }
        let failed = self.failed;
        (self.used, self.pending, self.failed) = ((DIGITS, 0), 0, false);
        if failed { Err(OutOfRange) } else { Ok(()) }
    }
}
