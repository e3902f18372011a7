//! Model files against the headers of logs that solves of them write: the same program; and another
//! one once a row is added to the log, or left out, a coefficient or a bound changed, a column
//! marked as integral.

use std::time::Duration;

use carom::model::{Model, cbf, lp, mps};
use carom::prelude::*;
use carom_proof::compare::{Comparison, Format, compare};
use proptest::prelude::*;

use super::{file, texts};
use crate::common::config;
use crate::torture::generator::Random;

/// The header of the log of a model; `None` if there is none.
fn header(model: &Model, name: &str) -> Option<String> {
    let path = file(name);
    let _ = std::fs::remove_file(&path);
    let options = Options::default().with_node_limit(20).with_time_limit(Duration::from_secs(1));
    let _ = BranchAndBound::new(options.with_proof(&path)).solve(model);
    let log = std::fs::read_to_string(&path).ok()?;
    let end = log.find("\nproof\n")?;
    Some(log[..end + 7].to_owned())
}

/// The model that a text is, and its format.
fn read(kind: usize, seed: u64) -> Option<(String, Model, Format)> {
    let (text, format) = match kind {
        0 => (texts::lp(seed, true), Format::Lp),
        1 => (texts::mps(seed), Format::Mps),
        _ => (texts::cbf(seed), Format::Cbf),
    };
    let read = match format {
        Format::Lp => lp::read(&text),
        Format::Mps => mps::read(&text),
        Format::Cbf => cbf::read(&text),
    };
    read.ok().map(|read| (text, read.model, format))
}

/// A log with a change that makes it another program; `None` if there is nothing to change, or if
/// the change might be none: of rows that bound a column, of one of two rows over the same columns.
///
/// # Arguments
///
/// * `has_switches`: whether some rows are switched off by binaries, which may do so by more than
///   they must.
fn changed(header: &str, has_switches: bool, r: &mut Random) -> Option<(&'static str, String)> {
    let mut lines: Vec<String> = header.lines().map(ToOwned::to_owned).collect();
    let places = |letter: &str| -> Vec<usize> {
        let own = |k: &usize| lines[*k].starts_with(letter) && *k > 1;
        (0..lines.len()).filter(own).collect()
    };
    let count = lines.iter().position(|line| line.starts_with("rows "))?;
    let (columns, rows) = (places("c "), places("r "));
    // Rotated cones have the letter of rows.
    let cones = lines.iter().position(|line| line.starts_with("cones "))?;
    let rows: Vec<usize> = rows.into_iter().filter(|&k| k < cones).collect();
    let many = columns.len();
    let entries_of = |k: usize| -> usize {
        lines[k].split_ascii_whitespace().nth(3).and_then(|many| many.parse().ok()).unwrap_or(0)
    };
    let columns_of = |k: usize| -> Vec<&str> {
        lines[k].split_ascii_whitespace().skip(4).step_by(2).take(entries_of(k)).collect()
    };
    let is_alone = |k: usize| {
        let same = rows.iter().filter(|&&other| columns_of(other) == columns_of(k)).count() == 1;
        entries_of(k) > 1 && same
    };
    let alone: Vec<usize> =
        rows.iter().copied().filter(|&k| !has_switches && is_alone(k)).collect();
    let has_single = rows.iter().any(|&k| entries_of(k) < 2);
    let what = match r.below(5) {
        0 => {
            // A row that cuts off points: of two columns, so that it is no bound.
            let (a, b) = (r.below(many), r.below(many));
            if a == b {
                return None;
            }
            lines.insert(
                cones,
                format!("r -inf 0.3125 2 {} 1.125 {} 1.0625 more", a.min(b), a.max(b)),
            );
            lines[count] = format!("rows {}", rows.len() + 1);
            "a row more"
        }
        1 => {
            let &place = alone.get(r.below(alone.len().max(1)))?;
            let words: Vec<&str> = lines[place].split_ascii_whitespace().collect();
            if words[3] == "0" || words[1..3] == ["-inf", "inf"] {
                return None;
            }
            lines.remove(place);
            lines[count] = format!("rows {}", rows.len() - 1);
            "a row less"
        }
        2 => {
            let &place = alone.get(r.below(alone.len().max(1)))?;
            let mut words: Vec<String> =
                lines[place].split_ascii_whitespace().map(ToOwned::to_owned).collect();
            let entries: usize = words[3].parse().ok()?;
            let k = 5 + 2 * r.below(entries.max(1));
            // A multiple of a column as the entry of a cone: of that column alone, another one may
            // say the same.
            let is_multiple = entries == 2 && words[1..3] == ["0", "0"];
            if entries == 0 || is_multiple || words[1..3] == ["-inf", "inf"] {
                return None;
            }
            words[k] = format!("{}", words[k].parse::<f64>().ok()? * 1.25);
            lines[place] = words.join(" ");
            "a coefficient"
        }
        3 => {
            let place = columns[r.below(many)];
            let mut words: Vec<String> =
                lines[place].split_ascii_whitespace().map(ToOwned::to_owned).collect();
            let (lower, upper): (f64, f64) = (words[2].parse().ok()?, words[3].parse().ok()?);
            if upper - lower < 2.5 || has_single {
                return None;
            }
            words[2] = if lower.is_finite() { lower + 1.25 } else { -77.5 }.to_string();
            lines[place] = words.join(" ");
            "a bound"
        }
        _ => {
            let place = columns[r.below(many)];
            let marked = lines[place].strip_prefix("c c ")?;
            lines[place] = format!("c i {marked}");
            "an integrality mark"
        }
    };
    Some((what, lines.join("\n") + "\n"))
}

proptest! {
    #![proptest_config(config(300, "tests/regressions/proofs.txt"))]

    #[test]
    fn logs_are_about_their_files(kind in 0..3_usize, seed in any::<u64>()) {
        let Some((text, model, format)) = read(kind, seed) else { return Ok(()) };
        let Some(log) = header(&model, "compared") else { return Ok(()) };
        let said = compare(&text, format, log.as_bytes());
        let is_same = matches!(said, Ok(Comparison::Same { .. }));
        prop_assert!(is_same, "{:?} of\n{}\n{}", said, text, log);
        let r = &mut Random::new(seed);
        for _ in 0..6 {
            let has_switches = ["->", "\n SC "].iter().any(|word| text.contains(word));
            let Some((what, other)) = changed(&log, has_switches, r) else { continue };
            let said = compare(&text, format, other.as_bytes());
            let is_same = matches!(said, Ok(Comparison::Same { .. }));
            prop_assert!(!is_same, "{}: {:?} of\n{}\n{}", what, said, text, other);
        }
    }
}
