//! How fast a tree grows, given the gains of its splits.

/// Halvings of the interval of a rate of growth: five digits, of rates from 1 to 1e9.
const HALVINGS: usize = 22;

/// At which rate a tree grows whose nodes all split with these gains of their children: it has
/// `exp(rate * gap)` nodes, where `sum of exp(-rate * gain) = 1` (Le Bodic and Nemhauser 2017).
pub(super) fn growth_rate(gains: &[f64]) -> f64 {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rates_of_growth() {
        let close = |gains: &[f64], rate: f64| {
            let found = growth_rate(gains);
            assert!((found - rate).abs() <= 1e-4 * rate, "{gains:?}: {found}");
        };
        close(&[1.0, 1.0], 2.0_f64.ln());
        close(&[0.5, 0.5, 0.5], 2.0 * 3.0_f64.ln());
        // The golden ratio.
        close(&[1.0, 2.0], ((1.0 + 5.0_f64.sqrt()) / 2.0).ln());
        // A child that gains nothing is worse than a third one that gains something.
        assert!(growth_rate(&[1.0, 1e-9]) > growth_rate(&[1.0, 1.0, 1.0]));
    }
}
