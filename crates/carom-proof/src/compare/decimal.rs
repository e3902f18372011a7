//! Sums of decimal numbers, rounded once: files give a second side of a row as a distance from the
//! first, of which floats do not have the sum.

use num_bigint::BigInt;

/// Most digits that the numbers of a sum may be apart.
const MOST_DIGITS_APART: i64 = 1000;

/// Whole digits times a power of ten.
struct Decimal {
    digits: BigInt,
    power: i64,
}

fn decimal(word: &str) -> Option<Decimal> {
    let (mantissa, power) = match word.split_once(['e', 'E', 'd', 'D']) {
        Some((mantissa, power)) => (mantissa, power.parse::<i64>().ok()?),
        None => (word, 0),
    };
    let (whole, fraction) = mantissa.split_once('.').unwrap_or((mantissa, ""));
    let digits = format!("{whole}{fraction}");
    let digits = digits.strip_prefix('+').unwrap_or(&digits).parse().ok()?;
    Some(Decimal { digits, power: power.checked_sub(fraction.len() as i64)? })
}

/// `side + sign |distance|`, the float nearest to the sum of the decimals; `None` if they are too
/// far apart.
pub(super) fn moved(side: &str, sign: i32, distance: &str) -> Option<f64> {
    let (a, b) = (decimal(side)?, decimal(distance)?);
    let power = a.power.min(b.power);
    let aligned = |of: Decimal| {
        let apart = of.power.checked_sub(power).filter(|apart| *apart <= MOST_DIGITS_APART)?;
        Some(of.digits * BigInt::from(10).pow(u32::try_from(apart).ok()?))
    };
    let size = BigInt::from(aligned(b)?.into_parts().1) * sign;
    format!("{}e{power}", aligned(a)? + size).parse().ok()
}
