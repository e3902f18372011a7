//! `--proof FOLDER` of examples that search for shortest plans.

use std::path::{Path, PathBuf};

use carom::hybrid::ShortestHorizon;

/// Takes the option out of the arguments. Returns the folder, and the other arguments.
pub(crate) fn arguments() -> Result<(Option<PathBuf>, Vec<String>), String> {
    let (mut folder, mut others) = (None, Vec::new());
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        match word.as_str() {
            "--proof" => folder = Some(words.next().ok_or("--proof needs a folder")?.into()),
            _ => others.push(word),
        }
    }
    Ok((folder, others))
}

/// What was logged of a search, in a line: how many horizons, how much, and which are not.
pub(crate) fn line<P>(found: &ShortestHorizon<P>, folder: &Path) -> String {
    let reports = found.proofs.iter().filter(|proof| proof.is_complete());
    let reports: Vec<_> = reports.filter_map(|proof| proof.report.as_ref()).collect();
    let bytes: u64 = reports.iter().map(|report| report.bytes).sum();
    let missing: Vec<String> = found.unlogged().map(|steps| steps.to_string()).collect();
    let missing = match missing.is_empty() {
        true => String::new(),
        false => format!("; without a complete log: {}", missing.join(", ")),
    };
    let failures = found.proofs.iter().filter_map(|proof| proof.report.as_ref()?.failure.as_ref());
    let failures: String = failures.map(|failure| format!("; {failure}")).collect();
    let logs = if reports.len() == 1 { "1 log".into() } else { format!("{} logs", reports.len()) };
    format!("{logs} in {}, {bytes} bytes{missing}{failures}", folder.display())
}
