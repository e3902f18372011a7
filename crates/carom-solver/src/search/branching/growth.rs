//! The rate at which a tree grows, given the gains of its splits.

/// Halvings of the interval that contains a rate of growth: enough for five digits of rates from 1
/// to 1e9.
const HALVINGS: usize = 22;

/// The rate of growth of a tree in which every split gives its children these gains. The tree has
/// `exp(rate * gap)` nodes, where `sum of exp(-rate * gain) = 1` (Le Bodic and Nemhauser 2017).
pub fn growth_rate(gains: &[f64]) -> f64 {
    let (least, most) =
        gains.iter().fold((f64::INFINITY, 0.0_f64), |(l, m), &g| (l.min(g), m.max(g)));
    let all = (gains.len() as f64).ln();
    let (mut low, mut high) = ((all / most).ln(), (all / least).ln());
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        let rate = middle.exp();
        let sum: f64 = gains.iter().map(|gain| (-rate * gain).exp()).sum();
        if sum > 1.0 { low = middle } else { high = middle }
    }
    (0.5 * (low + high)).exp()
}
