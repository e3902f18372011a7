//! Numbers in texts for people and in tables.

use std::fmt;

/// Magnitudes below this are shown with an exponent (no unit).
const SMALL: f64 = 1e-6;

/// Rounded numbers of at least this magnitude are shown with an exponent (no unit).
const LARGE: f64 = 1e15;

/// Significant digits of numbers in tables: all that a solve can have right, without the noise
/// behind.
pub const DIGITS: usize = 12;

/// A number in full: its shortest exact text, with an exponent if it is small. A zero has no sign.
#[derive(Debug, Clone, Copy)]
pub struct Exact(pub f64);

impl fmt::Display for Exact {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0 {
            0.0 => f.write_str("0"),
            small if small.abs() < SMALL => write!(f, "{small:e}"),
            value => write!(f, "{value}"),
        }
    }
}

/// A number rounded to significant digits, without trailing zeros, and with an exponent if it is
/// small or large. A zero has no sign; less than all normal numbers is 0.
pub fn rounded(value: f64, digits: usize) -> String {
    if value.abs() < f64::MIN_POSITIVE {
        return "0".into();
    }
    let rounded = format!("{value:.*e}", digits.saturating_sub(1)).parse().unwrap_or(value);
    match rounded.abs() {
        size if size.is_finite() && size >= LARGE => format!("{rounded:e}"),
        _ => Exact(rounded).to_string(),
    }
}

/// A count with what is counted, which is one or several of it.
pub fn counted<T: fmt::Display + PartialEq + From<u8>>(count: T, what: &str) -> String {
    let ending = if count == T::from(1) { "" } else { "s" };
    format!("{count} {what}{ending}")
}

/// The numbers of a column of a table, where what is below the last digit of the largest one is 0,
/// and so is a column of nothing but such numbers: a solve leaves such remainders of 0.
#[derive(Debug, Clone, Copy)]
pub struct TableColumn {
    noise: f64,
}

impl TableColumn {
    /// The column of some numbers.
    pub fn new<'a>(values: impl IntoIterator<Item = &'a f64>) -> Self {
        let finite = values.into_iter().map(|value| value.abs()).filter(|size| size.is_finite());
        let (largest, digit) = (finite.fold(0.0, f64::max), 10.0_f64.powi(-(DIGITS as i32)));
        TableColumn { noise: if largest < digit { digit } else { largest * digit } }
    }

    /// The text of one of them.
    pub fn text(&self, value: f64) -> String {
        if value.abs() < self.noise { "0".into() } else { rounded(value, DIGITS) }
    }
}

/// A share as a percentage with four digits after the point. Infinite and senseless ones are a
/// dash.
pub fn percent(share: f64) -> String {
    match 100.0 * share {
        0.0 => "0.0000".into(),
        tiny if tiny.abs() < 1e-4 => rounded(tiny, 2),
        fine if fine.abs() < 1e5 => format!("{fine:.4}"),
        _ => "-".into(),
    }
}
