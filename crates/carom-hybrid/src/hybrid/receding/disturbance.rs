//! Disturbances from a seed.

use crate::interval::Interval;
use crate::random::SplitMix;

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
    random: SplitMix,
}

impl Disturbance {
    /// Disturbances within ranges, one per entry of the state, in its unit.
    pub fn new<R: Into<Interval>>(ranges: impl IntoIterator<Item = R>, seed: u64) -> Self {
        Disturbance { ranges: ranges.into_iter().map(R::into).collect(), random: SplitMix(seed) }
    }

    /// The next disturbance, one value per range.
    pub fn next_value(&mut self) -> Vec<f64> {
        let random = &mut self.random;
        let draw = |range: &Interval| {
            let part = random.part();
            (range.lower + part * (range.upper - range.lower)).clamp(range.lower, range.upper)
        };
        self.ranges.iter().map(draw).collect()
    }
}
