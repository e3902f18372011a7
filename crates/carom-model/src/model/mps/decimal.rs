//! Exact sums of decimal numbers, for two-sided rows.
//!
//! MPS gives a two-sided row as one limit and the distance to the other. In binary arithmetic the
//! distance often does not exist: no double `r` makes `1.1 - r` round to -1.2, and none makes
//! `-1.2 + r` round to 1.1. The file holds decimals, so the sum is formed on the decimals and
//! rounded once. Then every pair of limits has an exact distance.

use std::fmt;

/// A decimal number `digits * 10^exponent` with its sign.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Decimal {
    negative: bool,
    /// Values 0 to 9, the most significant first; empty for zero.
    digits: Vec<u8>,
    exponent: i32,
}

/// Numbers whose digits are further apart than this are not added digit by digit.
const MAX_DIGITS_APART: i32 = 1000;

impl Decimal {
    /// Reads a finite number as Rust or Fortran (`D` exponent) write it; `None` for anything else
    /// and for exponents beyond all doubles.
    pub fn parse(text: &str) -> Option<Decimal> {
        let (mantissa, exponent) = match text.split_once(['e', 'E', 'd', 'D']) {
            Some((mantissa, exponent)) => (mantissa, exponent.parse::<i32>().ok()?),
            None => (text, 0),
        };
        let negative = mantissa.starts_with('-');
        let mantissa = mantissa.strip_prefix(['+', '-']).unwrap_or(mantissa);
        let (whole, fraction) = mantissa.split_once('.').unwrap_or((mantissa, ""));
        let digits = whole.bytes().chain(fraction.bytes());
        let digits: Option<Vec<u8>> =
            digits.map(|b| b.is_ascii_digit().then(|| b - b'0')).collect();
        let exponent = exponent.checked_sub(i32::try_from(fraction.len()).ok()?)?;
        Some(Decimal { negative, digits: digits?, exponent }.trimmed())
    }

    /// The shortest decimal that reads back as a finite double.
    pub(super) fn of(value: f64) -> Option<Decimal> {
        Decimal::parse(&format!("{value:e}"))
    }

    /// The number without its sign.
    pub(super) fn magnitude(mut self) -> Decimal {
        self.negative = false;
        self
    }

    /// The number with the other sign.
    pub(super) fn negated(mut self) -> Decimal {
        self.negative = !self.negative;
        self
    }

    /// The exact sum, or `None` if the digits are too far apart.
    pub fn plus(&self, other: &Decimal) -> Option<Decimal> {
        let bottom = self.exponent.min(other.exponent);
        let top = self.top()?.max(other.top()?);
        let width = top.checked_sub(bottom).filter(|&width| width <= MAX_DIGITS_APART)?;
        let (a, b) = (self.aligned(bottom, width)?, other.aligned(bottom, width)?);
        let (negative, digits) = if self.negative == other.negative {
            (self.negative, add(&a, &b))
        } else if a >= b {
            (self.negative, subtract(&a, &b))
        } else {
            (other.negative, subtract(&b, &a))
        };
        Some(Decimal { negative, digits, exponent: bottom }.trimmed())
    }

    /// The nearest double; `+0` for zero.
    pub(super) fn to_f64(&self) -> f64 {
        self.to_string().parse().unwrap_or(f64::NAN)
    }

    pub(super) fn significant(&self) -> usize {
        self.digits.len()
    }

    /// The power of ten above the first digit.
    fn top(&self) -> Option<i32> {
        self.exponent.checked_add(i32::try_from(self.digits.len()).ok()?)
    }

    /// The digits from `10^bottom` upward, padded with zeros to a width.
    fn aligned(&self, bottom: i32, width: i32) -> Option<Vec<u8>> {
        let width = usize::try_from(width).ok()?;
        let behind = usize::try_from(self.exponent - bottom).ok()?;
        let before = width.checked_sub(behind)?.checked_sub(self.digits.len())?;
        let mut aligned = vec![0; before];
        aligned.extend(&self.digits);
        aligned.resize(width, 0);
        Some(aligned)
    }

    fn trimmed(mut self) -> Decimal {
        while self.digits.last() == Some(&0) {
            self.digits.pop();
            self.exponent = self.exponent.saturating_add(1);
        }
        let zeros = self.digits.iter().take_while(|&&d| d == 0).count();
        self.digits.drain(..zeros);
        if self.digits.is_empty() {
            (self.negative, self.exponent) = (false, 0);
        }
        self
    }
}

impl fmt::Display for Decimal {
    /// All digits, with an exponent only if a plain number would need many zeros.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let digits: String = self.digits.iter().map(|&d| char::from(b'0' + d)).collect();
        let sign = if self.negative { "-" } else { "" };
        let point = digits.len() as i64 + i64::from(self.exponent);
        match usize::try_from(point) {
            _ if digits.is_empty() => f.write_str("0"),
            Ok(point @ 0..=20) if point >= digits.len() => write!(f, "{sign}{digits:0<point$}"),
            Ok(0) => write!(f, "{sign}0.{digits}"),
            Ok(point @ 1..=20) => write!(f, "{sign}{}.{}", &digits[..point], &digits[point..]),
            _ => write!(f, "{sign}{digits}e{}", self.exponent),
        }
    }
}

/// Sum of two digit strings of the same length, possibly one digit longer.
fn add(a: &[u8], b: &[u8]) -> Vec<u8> {
    let mut sum = vec![0; a.len() + 1];
    for k in (0..a.len()).rev() {
        let digit = a[k] + b[k] + sum[k + 1];
        sum[k + 1] = digit % 10;
        sum[k] = digit / 10;
    }
    sum
}

/// Difference of two digit strings of the same length, the larger one first.
fn subtract(larger: &[u8], smaller: &[u8]) -> Vec<u8> {
    let mut difference = vec![0; larger.len()];
    let mut borrow = 0;
    for k in (0..larger.len()).rev() {
        let take = smaller[k] + borrow;
        borrow = u8::from(larger[k] < take);
        difference[k] = larger[k] + 10 * borrow - take;
    }
    difference
}
