//! Certificates with one thing wrong, at random.

use std::error::Error;

use carom_proof::check_table;

use crate::Random;

/// The number of kinds of damages.
const KINDS: u64 = 12;

/// The certificate with something wrong; `None` if there is nothing of that kind.
fn damaged(text: &str, random: &mut Random) -> Option<String> {
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    let kind = random.below(KINDS);
    let mut one = |begin: &str| {
        let own = lines.iter().enumerate().filter(|(_, line)| line.starts_with(begin));
        let own: Vec<usize> = own.map(|(k, _)| k).collect();
        if own.is_empty() { None } else { Some(own[random.below(own.len() as u64) as usize]) }
    };
    let word = |line: &str, at: usize| line.split(' ').nth(at).unwrap_or("").to_owned();
    let with = |line: &str, at: usize, new: &str| {
        let mut words: Vec<&str> = line.split(' ').collect();
        words[at] = new;
        words.join(" ")
    };
    match kind {
        // A column of a plan, or of a point of evidence, is far out.
        0 | 1 => {
            let k =
                one(if kind == 0 { "x " } else { "b " }).filter(|&k| word(&lines[k], 1) != "0")?;
            // A column 0 may be an axis, which is refused, too.
            lines[k] = with(&lines[k], 3, "1000000.0");
        }
        // A line of a cell is gone.
        2 => {
            let k = one("cut ")?;
            lines.remove(k);
        }
        3 => {
            let k = one("plan ")?;
            lines.remove(k);
        }
        // A half is another cell.
        4 => {
            let k = one("cut ")?;
            let half: u64 = word(&lines[k], 3).parse().ok()?;
            lines[k] = with(&lines[k], 3, &(half + 1).to_string());
        }
        // The loss is half of what it is.
        5 => {
            let k = one("plan ")?;
            let loss: f64 = word(&lines[k], 1).parse().ok().filter(|loss| *loss > 1e-4)?;
            lines[k] = with(&lines[k], 1, &(0.5 * loss).to_string());
        }
        // A state, or an input, is rounded by less.
        6 => {
            let k = one("rounding")?;
            let rounding: f64 = word(&lines[k], 1).parse().ok()?;
            lines[k] = with(&lines[k], 1, &(0.1 * rounding).to_string());
        }
        // The integers are cut elsewhere.
        7 => {
            let k = one("s ")?;
            lines[k] = with(&lines[k], 2, "1.0");
        }
        // An edge is none.
        8 => {
            let k = one("cut ")?;
            let corner = word(&lines[k], 1);
            lines[k] = with(&lines[k], 2, &corner);
        }
        // The constant of an input of a program is another one.
        9 => {
            let k = one("m ")?;
            let at = lines[k].split(' ').count() - program_states(&lines)? - 1;
            let constant: f64 = word(&lines[k], at).parse().ok()?;
            lines[k] = with(&lines[k], at, &format!("{:?}", constant + 0.5));
        }
        // A cell solves its program twice.
        10 => {
            let k = one("solves ")?;
            let count = word(&lines[k], 1).parse::<u64>().ok()?;
            let (first, excess) = (word(&lines[k], 2), word(&lines[k], 3));
            let more = with(&lines[k], 1, &(count + 1).to_string());
            lines[k] = format!("{more} {first} {excess}");
        }
        // The text ends.
        _ => {
            let length = 1 + random.below(lines.len() as u64 - 1);
            lines.truncate(length as usize);
        }
    }
    Some(lines.join("\n"))
}

/// The number of axes.
fn program_states(lines: &[String]) -> Option<usize> {
    let axes = lines.iter().find(|line| line.starts_with("axes "))?;
    axes.split(' ').nth(1)?.parse().ok()
}

/// Damages a certificate so many times; each must be rejected.
pub(crate) fn reject(text: &str, count: usize, random: &mut Random) -> Result<(), Box<dyn Error>> {
    check_table(text.as_bytes())?;
    let mut rejected = 0;
    while rejected < count {
        let Some(wrong) = damaged(text, random) else { continue };
        if check_table(wrong.as_bytes()).is_ok() {
            return Err("a damaged certificate is accepted".into());
        }
        rejected += 1;
    }
    Ok(())
}
