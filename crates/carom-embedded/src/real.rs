//! The numbers of a table.

use core::ops::{Add, Div, Mul, Sub};

mod sealed {
    pub trait Sealed {}
    impl Sealed for f32 {}
    impl Sealed for f64 {}
}

/// The numbers of a table: `f32` or `f64`.
///
/// A look-up rounds a state to whole units, of which each side of the box has
/// [`UNITS`](Self::UNITS), and from there on only adds and compares whole numbers.
pub trait LookupNumber:
    sealed::Sealed
    + Copy
    + PartialOrd
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
{
    /// The units along a side of the box: 2^30, or 2^24 for `f32`, which holds no more digits.
    const UNITS: u32;
    /// The number 0.
    const ZERO: Self;
    /// The number 1.
    const ONE: Self;

    /// The nearest whole number between 0 and [`UNITS`](Self::UNITS); 0 for NaN.
    #[must_use]
    fn to_units(self) -> u32;

    /// A count of units as a share of the side of the box, without rounding.
    #[must_use]
    fn share(units: u32) -> Self;
}

impl LookupNumber for f32 {
    const UNITS: u32 = 1 << 24;
    const ZERO: Self = 0.0;
    const ONE: Self = 1.0;

    fn to_units(self) -> u32 {
        // A cast saturates, and cuts off what is behind the point.
        ((self + 0.5) as u32).min(Self::UNITS)
    }

    fn share(units: u32) -> Self {
        const UNIT: f32 = 1.0 / (1_u32 << 24) as f32;
        units as f32 * UNIT
    }
}

impl LookupNumber for f64 {
    const UNITS: u32 = 1 << 30;
    const ZERO: Self = 0.0;
    const ONE: Self = 1.0;

    fn to_units(self) -> u32 {
        ((self + 0.5) as u32).min(Self::UNITS)
    }

    fn share(units: u32) -> Self {
        const UNIT: f64 = 1.0 / (1_u32 << 30) as f64;
        f64::from(units) * UNIT
    }
}
