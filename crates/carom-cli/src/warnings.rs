//! Warnings about a file: the first few of each kind, and how many more there are.

use std::collections::BTreeMap;

use carom::model::Warning;

/// Warnings of a kind that are shown.
const SHOWN: usize = 3;

/// The lines about the warnings of a file, each kind where it first comes up.
pub(crate) fn lines(file: &str, warnings: &[Warning]) -> Vec<String> {
    let mut count: BTreeMap<String, usize> = BTreeMap::new();
    warnings.iter().for_each(|warning| *count.entry(kind(&warning.message)).or_default() += 1);
    let mut seen: BTreeMap<String, usize> = BTreeMap::new();
    let mut lines = Vec::new();
    for warning in warnings {
        let kind = kind(&warning.message);
        let all = count[&kind];
        let seen = seen.entry(kind).or_default();
        *seen += 1;
        // One more line would say no less than that there is one more.
        if *seen <= SHOWN || all == SHOWN + 1 {
            lines.push(format!("warning: {file}: {warning}"));
        }
        if *seen == SHOWN && all > SHOWN + 1 {
            lines.push(format!("warning: {file}: {} more of this kind", all - SHOWN));
        }
    }
    lines
}

/// A message without its names and numbers.
fn kind(message: &str) -> String {
    let words = message.split('`').step_by(2).collect::<String>();
    words.chars().filter(|letter| !letter.is_ascii_digit()).collect()
}
