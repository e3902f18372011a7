//! Roundings of a device.

use super::evidence::product;
use super::statement::Statement;
use crate::exact::{Dyadic, Sum};
use crate::text::{Lines, Refusal, rejected};
use std::cmp::Ordering;
use std::io::BufRead;

/// The numbers of a device: its ends and scales, and what it says of its roundings.
#[derive(Debug)]
pub(super) struct Device {
    bits: usize,
    units: usize,
    lower: Vec<f64>,
    upper: Vec<f64>,
    scale: Vec<f64>,
    /// By how much the state of the law differs from the state, in its unit.
    rounding: Vec<f64>,
    /// By how much an input differs from that of the plan.
    input: f64,
}

impl Device {
    pub(super) fn read<R: BufRead>(
        lines: &mut Lines<R>,
        statement: &Statement,
    ) -> Result<Self, Refusal> {
        let mut words = lines.expect("device")?;
        let bits = words.count("the number of bits")?;
        let units = words.count("the number of units")?;
        words.end()?;
        let mut input = 0.0;
        let mut read = |keyword: &str| {
            let mut words = lines.expect(keyword)?;
            let all = statement.axes.iter().map(|_| words.number("a number"));
            let all = all.collect::<Result<Vec<f64>, Refusal>>()?;
            if keyword == "rounding" {
                input = words.number("a number")?;
            }
            words.end()?;
            Ok::<_, Refusal>(all)
        };
        let (lower, upper) = (read("lower")?, read("upper")?);
        let (scale, rounding) = (read("scale")?, read("rounding")?);
        Ok(Device { bits, units, lower, upper, scale, rounding, input })
    }

    /// Checks that the inputs at a corner are rounded by no more than is said.
    ///
    /// An input is a sum of terms, computed with 53 bits; it is stored, multiplied by a weight, and
    /// added once for each corner, with the device's bits. Weights are shares, so that between
    /// corners the error is at most that of the largest input.
    pub(super) fn check_inputs(&self, statement: &Statement, x: &[Dyadic]) -> Result<(), Refusal> {
        let mut sum = Sum::default();
        let unit = |bits: usize| 1.0 / (1_u64 << bits) as f64;
        let steps = statement.axes.len() as f64 + 4.0;
        for (offset, terms) in &statement.inputs {
            let factor = steps * unit(self.bits) + (terms.len() as f64 + 2.0) * unit(53);
            sum.subtract(self.input, 1.0);
            sum.add(offset.abs(), factor);
            for &(j, a) in terms {
                let x = &x[j as usize];
                let size = if x.sign() == Ordering::Less { x.negated() } else { x.clone() };
                sum.add(&product(&size, &Dyadic::from_f64(a.abs()))?, factor);
            }
            if sum.take_sign()? == Ordering::Greater {
                return rejected("an input is rounded by more than is said");
            }
        }
        Ok(())
    }

    /// Checks that a state is rounded by no more than is said.
    ///
    /// The device computes `floor(fl(fl(fl(x - lower) scale) + 1/2))`, three roundings of at most
    /// `2^-bits`, relative, of numbers up to about all units. Without them, the number of units is
    /// `(x - lower) scale`, and ought to be `(x - L) units / W`: the difference is affine in x, so
    /// the ends of the device's range have the largest one.
    pub(super) fn check(&self, statement: &Statement, bits: usize) -> Result<(), Refusal> {
        let units = self.units as f64;
        if self.bits != bits || self.units > 1 << 30 || self.units > 1 << bits {
            return rejected("the device has other numbers");
        }
        let mut sum = Sum::default();
        for (a, &j) in statement.axes.iter().enumerate() {
            let column = &statement.columns[j];
            sum.add(column.upper, 1.0);
            sum.subtract(column.lower, 1.0);
            let width = sum.take()?;
            let (own, scale) = (self.lower[a], self.scale[a]);
            // (upper - own) scale <= units + 2, so that the roundings are as small as is said.
            sum.add(self.upper[a], scale);
            sum.subtract(own, scale);
            sum.subtract(units + 2.0, 1.0);
            if sum.take_sign()? == Ordering::Greater || scale <= 0.0 {
                return rejected(format!("the scale of axis {a} is too large"));
            }
            // All sides times the width: rounding units >= (1/2 + 4 2^-bits (units + 3)) width +
            // |((x - own) scale) width - (x - L) units|.
            let fixed = 0.5 + 4.0 * (units + 3.0) / (1_u64 << bits) as f64;
            for x in [own, self.upper[a], column.lower, column.upper] {
                sum.add(x, scale);
                sum.subtract(own, scale);
                let taken: Dyadic = sum.take()?;
                for sign in [1.0, -1.0] {
                    let signed = if sign > 0.0 { taken.clone() } else { taken.negated() };
                    sum.add(&signed, &width);
                    sum.subtract(sign * x, units);
                    sum.add(sign * column.lower, units);
                    sum.add(fixed, &width);
                    sum.subtract(self.rounding[a], units);
                    if sum.take_sign()? == Ordering::Greater {
                        return rejected(format!("states are rounded by more along axis {a}"));
                    }
                }
            }
        }
        Ok(())
    }
}
