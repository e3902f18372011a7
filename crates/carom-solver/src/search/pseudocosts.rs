//! Pseudocosts: the effect of branching on a column so far.
//!
//! A pseudocost is the average growth of the bound per unit of fraction, downwards and upwards, by
//! column.

/// Gains below this count as this much (objective's unit), so that products stay comparable.
pub const LEAST_GAIN: f64 = 1e-9;

/// Average growth of the bound per unit of fraction, downwards and upwards, by column.
#[derive(Debug, Clone)]
pub struct Pseudocosts {
    sum: Vec<[f64; 2]>,
    count: Vec<[u32; 2]>,
    /// Over all columns, by direction.
    total: [(f64, u32); 2],
    /// The lessons that other workers were not told yet; `None` if there are no other workers.
    fresh: Option<Vec<Lesson>>,
}

/// The gain of one child of a split at a column.
#[derive(Debug, Clone, Copy)]
struct Lesson {
    column: usize,
    side: usize,
    gain: f64,
}

impl Pseudocosts {
    /// Empty pseudocosts for so many columns.
    pub fn new(columns: usize) -> Self {
        Pseudocosts {
            sum: vec![[0.0; 2]; columns],
            count: vec![[0; 2]; columns],
            total: [(0.0, 0); 2],
            fresh: None,
        }
    }

    /// Learns from a child: `gain` of the bound after moving a column by `fraction`.
    pub fn learn(&mut self, column: usize, up: bool, gain: f64, fraction: f64) {
        if gain.is_finite() && fraction > 1e-6 {
            let lesson = Lesson { column, side: usize::from(up), gain: gain.max(0.0) / fraction };
            self.take_in(lesson);
            self.fresh.iter_mut().for_each(|fresh| fresh.push(lesson));
        }
    }

    fn take_in(&mut self, Lesson { column, side, gain }: Lesson) {
        self.sum[column][side] += gain;
        self.count[column][side] += 1;
        self.total[side].0 += gain;
        self.total[side].1 += 1;
    }

    /// Records lessons from now on, for other workers.
    pub(super) fn record(&mut self) {
        self.fresh = Some(Vec::new());
    }

    /// Adds the lessons since the last call to shared pseudocosts.
    pub(super) fn tell(&mut self, shared: &mut Pseudocosts) {
        self.fresh.iter_mut().for_each(|fresh| fresh.drain(..).for_each(|l| shared.take_in(l)));
    }

    /// Takes over the pseudocosts of all workers.
    pub(super) fn learn_all(&mut self, shared: &Pseudocosts) {
        self.sum.copy_from_slice(&shared.sum);
        self.count.copy_from_slice(&shared.count);
        self.total = shared.total;
    }

    /// Whether a gain is known for both sides of a column.
    pub fn known(&self, column: usize) -> bool {
        self.count[column].iter().all(|&c| c > 0)
    }

    /// Whether a gain is known for raising a column.
    pub fn known_up(&self, column: usize) -> bool {
        self.count[column][1] > 0
    }

    /// Expected gain of raising a column by `fraction`, if anything is known.
    pub fn gain_up(&self, column: usize, fraction: f64) -> Option<f64> {
        let count = self.count[column][1];
        (count > 0).then(|| self.sum[column][1] / f64::from(count) * fraction)
    }

    /// Expected gains of lowering and of raising a column to the next whole value. A column without
    /// experience has the average gains of all columns.
    pub fn gains(&self, column: usize, value: f64) -> [f64; 2] {
        let expected = |side: usize, fraction: f64| {
            let (sum, count) = match self.count[column][side] {
                0 => self.total[side],
                count => (self.sum[column][side], count),
            };
            (sum / f64::from(count.max(1)) * fraction).max(LEAST_GAIN)
        };
        let fraction = value - value.floor();
        [expected(0, fraction), expected(1, 1.0 - fraction)]
    }

    /// Product of the expected gains of both children.
    pub(super) fn score(&self, column: usize, value: f64) -> f64 {
        let [down, up] = self.gains(column, value);
        down * up
    }
}
