//! Disturbances from a seed.

use crate::interval::Interval;

/// Random disturbances, uniform within ranges, the same for the same seed on every machine.
///
/// ```
/// use carom::hybrid::Disturbance;
///
/// let mut push = Disturbance::new([-0.1..=0.1], 7);
/// let first = push.next_value();
/// assert!(first[0].abs() <= 0.1 && first != push.next_value());
/// let mut again = Disturbance::new([-0.1..=0.1], 7);
/// assert_eq!(again.next_value(), first);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Disturbance {
    ranges: Vec<Interval>,
    state: u64,
}

impl Disturbance {
    /// Disturbances within ranges, one per entry of the state, in its unit.
    pub fn new<R: Into<Interval>>(ranges: impl IntoIterator<Item = R>, seed: u64) -> Self {
        Disturbance { ranges: ranges.into_iter().map(R::into).collect(), state: seed }
    }

    /// The next disturbance, one value per range.
    pub fn next_value(&mut self) -> Vec<f64> {
        let state = &mut self.state;
        let draw = |range: &Interval| {
            let part = (next(state) >> 11) as f64 / (1u64 << 53) as f64;
            (range.lower + part * (range.upper - range.lower)).clamp(range.lower, range.upper)
        };
        self.ranges.iter().map(draw).collect()
    }
}

/// The generator SplitMix64 (Steele, Lea and Flood 2014).
fn next(state: &mut u64) -> u64 {
    *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let mut z = *state;
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}
