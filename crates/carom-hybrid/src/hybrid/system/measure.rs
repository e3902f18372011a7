//! How a quantity is measured in computations: from an origin, in a power of two.

use super::HybridSystem;
use crate::error::Error;
use crate::interval::Interval;

/// Widths of ranges that are taken as they are; 2^-6 and 2^18. Absolute tolerances are then between
/// some 1e-4 of a range and a thousand roundings. A range may be wide only for want of a limit, and
/// what happens in it small, so that wide ones are taken as they are for as long as the digits of a
/// float allow.
const ORDINARY: [f64; 2] = [0.015625, 262_144.0];

/// Smaller widths become between this and twice as much.
const FROM_SMALL: f64 = 8.0;

/// Larger widths become between this and twice as much.
const FROM_LARGE: f64 = 8192.0;

/// A range whose middle is more of its widths away from 0 is measured from its middle.
const FAR: f64 = 64.0;

/// The largest share of a range's width by which two neighbouring numbers in it may differ:
/// tolerances are not much wider.
const RESOLUTION: f64 = 1e-7;

/// The unit and the origin of a quantity: `value = origin + scale * own`, with a power of two and
/// an origin that is a multiple of it, so that nothing is rounded by the scale.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Measure {
    pub(crate) origin: f64,
    pub(crate) scale: f64,
}

/// The power of two at or just below a positive number.
pub(crate) fn power_of_two(size: f64) -> f64 {
    2.0_f64.powi(size.log2().floor().clamp(-1000.0, 1000.0) as i32)
}

impl Measure {
    /// The user's own numbers.
    pub(crate) const PLAIN: Measure = Measure { origin: 0.0, scale: 1.0 };

    /// A unit without another origin.
    pub(crate) fn unit(scale: f64) -> Self {
        Measure { origin: 0.0, scale }
    }

    /// The measure of a range: the user's own numbers where the range is of an ordinary size and
    /// not far from 0.
    pub(crate) fn of(range: Interval) -> Self {
        let width = range.width();
        // A single value is measured by its size.
        let size = if width > 0.0 { width } else { range.magnitude() };
        let is_ordinary = size == 0.0 || (ORDINARY[0]..=ORDINARY[1]).contains(&size);
        if !size.is_finite() {
            return Measure::PLAIN;
        }
        let target = if size > ORDINARY[1] { FROM_LARGE } else { FROM_SMALL };
        let scale = if is_ordinary { 1.0 } else { power_of_two(size / target) };
        Measure::around(range, width, scale)
    }

    /// The measure in a unit, from the middle of a range that is more than some of these widths
    /// away from 0.
    pub(crate) fn around(range: Interval, width: f64, scale: f64) -> Self {
        let middle = 0.5 * range.lower + 0.5 * range.upper;
        let origin = match width > 0.0 && middle.abs() > FAR * width {
            true => (middle / scale).round() * scale,
            false => 0.0,
        };
        Measure { origin, scale }
    }

    pub(crate) fn is_plain(self) -> bool {
        self == Measure::PLAIN
    }

    /// The measure in which the numbers of this one are those of the user.
    pub(crate) fn inverse(self) -> Self {
        Measure { origin: 0.0 - self.origin / self.scale, scale: 1.0 / self.scale }
    }

    /// A value in this measure.
    pub(crate) fn inward(self, value: f64) -> f64 {
        if self.is_plain() { value } else { (value - self.origin) / self.scale }
    }

    /// A value of this measure in the user's unit.
    pub(crate) fn outward(self, own: f64) -> f64 {
        if self.is_plain() { own } else { self.origin + self.scale * own }
    }

    /// A range in this measure.
    pub(crate) fn inward_range(self, range: Interval) -> Interval {
        Interval::new(self.inward(range.lower), self.inward(range.upper))
    }

    /// A range of this measure in the user's unit, rounded outward where the origin rounds.
    pub(crate) fn outward_range(self, own: Interval) -> Interval {
        match self {
            Measure { origin: 0.0, scale: 1.0 } => own,
            Measure { origin: 0.0, .. } => {
                Interval::new(self.scale * own.lower, self.scale * own.upper)
            }
            _ => own * self.scale + Interval::point(self.origin),
        }
    }
}

impl HybridSystem {
    /// Refuses domains and ranges so far from 0 that a float cannot tell their points apart.
    pub(super) fn check_digits(&self) -> Result<(), Error> {
        let inputs = self.inputs.iter();
        let inputs = inputs.flat_map(|(name, range)| range.values().map(move |own| (name, *own)));
        let states = self.states.iter().map(|(name, domain)| (name, *domain));
        let mut named = states.chain(inputs);
        named.try_for_each(|(name, range)| check_digits(name, range))
    }
}

/// Refuses a range so far from 0 that a float cannot tell its points apart. The error names the
/// quantity.
pub(crate) fn check_digits(name: &str, range: Interval) -> Result<(), Error> {
    let (far, width) = (range.magnitude(), range.width());
    if width > 0.0 && far.is_finite() && far.next_up() - far > RESOLUTION * width {
        let what = format!("the distance from 0 to the range of `{name}`");
        let most = RESOLUTION * width / f64::EPSILON;
        let range = format!(
            "below {most:.0e}, because beyond it the digits of a float do not tell points of a range of width \
             {width} apart; state `{name}` from another origin"
        );
        return Err(Error::out_of_range_in_words(what, far, ..most, range));
    }
    Ok(())
}
