//! Percentages as in the paper's tables.

/// How much less time one plan takes than another, relative to either time.
///
/// The paper's "13.59 %" in Table 3 is relative to the faster time, its "6.27 %" in Table 4 to the
/// baseline.
///
/// ```
/// use carom::collision_tolerant::Saving;
///
/// let saving = Saving::new(2.55, 2.245);
/// assert_eq!(format!("{:.2}", saving.of_faster), "13.59");
/// assert_eq!(format!("{:.2}", saving.of_baseline), "11.96");
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Saving {
    /// `(baseline - time) / baseline`, in percent.
    pub of_baseline: f64,
    /// `(baseline - time) / time`, in percent.
    pub of_faster: f64,
}

impl Saving {
    /// Compares a time with a baseline, both in s and positive.
    pub fn new(baseline: f64, time: f64) -> Self {
        let saved = 100.0 * (baseline - time);
        Saving { of_baseline: saved / baseline, of_faster: saved / time }
    }
}
