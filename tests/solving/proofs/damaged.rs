//! Logs that were damaged: a number, a reference, a sign, a missing case, a doubled step, a file
//! that ends early. The count of steps at the end is made right again, so that it does not give the
//! damage away.

use carom_proof::{Claim, check};

use super::solved;
use crate::torture::generator::{self, Random};
use crate::torture::oracle::{Truth, truth};

/// A kind of damage.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Damage {
    Number,
    Reference,
    Sign,
    MissingCase,
    MissingStep,
    DoubledStep,
    Truncation,
}

const KINDS: [Damage; 7] = [
    Damage::Number,
    Damage::Reference,
    Damage::Sign,
    Damage::MissingCase,
    Damage::MissingStep,
    Damage::DoubledStep,
    Damage::Truncation,
];

/// A thousand damaged logs. The truth is found by trying all points in exact arithmetic: what the
/// checker accepts is true, and with a claim beyond the truth it accepts none of them.
#[test]
fn damaged_logs_prove_nothing_false() {
    let mut random = Random::new(7);
    let (mut made, mut accepted) = ([0; KINDS.len()], 0);
    'programs: for seed in 0.. {
        let case = generator::program(seed);
        let Truth::Least { value: least, .. } = truth(&case) else { continue };
        let (model, _) = case.build();
        let (solution, log) = solved(&model, &format!("damaged_{seed}"));
        if !solution.proof().is_some_and(|report| report.is_complete) {
            continue;
        }
        let text = String::from_utf8(log).expect("text");
        let lines: Vec<&str> = text.lines().collect();
        let claim = lines.iter().position(|line| line.starts_with("claim ")).expect("a claim");
        let beyond = format!("claim bound {:e}", least + 1e-6 * least.abs().max(1.0));
        for k in 0..3 * KINDS.len() {
            let kind = k % KINDS.len();
            let Some(mut damaged) = damage(&lines, claim, KINDS[kind], &mut random) else {
                continue;
            };
            made[kind] += 1;
            if let Ok(proved) = check(damaged.join("\n").as_bytes()) {
                accepted += 1;
                assert_ne!(KINDS[kind], Damage::Truncation, "{seed}");
                let Claim::Bound(bound) = proved.claim else { panic!("{seed}: no point") };
                assert!(bound <= least + 1e-9 * least.abs().max(1.0), "{seed}: {bound} of {least}");
            }
            damaged.resize(damaged.len().max(claim + 1), String::new());
            damaged[claim].clone_from(&beyond);
            assert!(check(damaged.join("\n").as_bytes()).is_err(), "{seed}: {beyond}");
            if made.iter().sum::<u32>() == 1000 {
                break 'programs;
            }
        }
    }
    assert!(made.iter().all(|count| *count > 100), "{made:?}");
    // A multiplier that hardly matters, a bound that is not needed: such damage leaves a proof.
    assert!(accepted < 500, "{accepted} of 1000");
}

/// The lines of a log with some damage at or behind its claim; `None` if the damage changes
/// nothing.
fn damage(lines: &[&str], claim: usize, kind: Damage, random: &mut Random) -> Option<Vec<String>> {
    let mut all: Vec<String> = lines.iter().map(|line| (*line).to_owned()).collect();
    let last = all.len() - 1;
    // The line `proof` follows the claim.
    let step = claim + 2 + random.below(last - claim - 2);
    match kind {
        Damage::Truncation => {
            all.truncate(claim + 1 + random.below(last - claim));
            let own = all.pop()?;
            all.push(own.chars().take(random.below(own.len())).collect());
            return Some(all);
        }
        Damage::MissingStep => drop(all.remove(step)),
        Damage::DoubledStep => all.insert(step, all[step].clone()),
        Damage::MissingCase => {
            let is_end = |line: &String| line.starts_with("x ") || line.starts_with("d ");
            let end = (step..last).find(|&at| is_end(&all[at]))?;
            let begin =
                (claim + 2..end).rev().find(|&at| is_end(&all[at]) || all[at].starts_with("s "));
            all.drain(begin.map_or(claim + 2, |at| at + 1)..=end);
        }
        Damage::Number | Damage::Reference | Damage::Sign => {
            let at = if random.chance(0.1) { claim } else { step };
            let mut words: Vec<String> = all[at].split(' ').map(str::to_owned).collect();
            let is_reference = |word: &String| word.parse::<u32>().is_ok();
            let places: Vec<usize> = (1..words.len())
                .filter(|&k| words[k].parse::<f64>().is_ok())
                .filter(|&k| kind != Damage::Reference || is_reference(&words[k]))
                .collect();
            let place = *places.get(random.below(places.len().max(1)))?;
            let value: f64 = words[place].parse().ok()?;
            words[place] = match kind {
                Damage::Sign => -value,
                Damage::Reference => value + if random.chance(0.5) { 1.0 } else { -1.0 },
                _ => value * 1.01 + 0.01,
            }
            .to_string();
            let line = words.join(" ");
            if line == all[at] || value == 0.0 && kind == Damage::Sign {
                return None;
            }
            all[at] = line;
        }
    }
    let commands = all.iter().skip(claim + 2).filter(|line| !line.starts_with('#')).count() - 1;
    *all.last_mut()? = format!("end {commands}");
    Some(all)
}
